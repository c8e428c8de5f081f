"""Figures in a page: the same picture in fewer bytes, with the page's colours, inert whatever names are in it."""

import base64
import io
import re
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from matplotlib.figure import Figure

import kinetostat as ks
from kinetostat.report.figures import manipulability_figure
from kinetostat.report.figures.embedding import THEME, embedded
from kinetostat.report.figures.saving import rendered
from kinetostat.report.figures.sheet import house_style, named
from kinetostat.report.figures.trees import tree_figure
from report.fleet.fleet_documents import HOSTILE

SVG = "{http://www.w3.org/2000/svg}"
HOSTILE_NAMES = [*HOSTILE, "<script>alert(1)</script>$x^2$\"'&", "\\$", "$\\frac{1}{0}$", "a  b"]


@cache
def arm_figure():
    model = ks.load("example:ur5_robot")
    at = ks.configuration(model, (0.3, -1.2, 1.4, -0.6, 0.8, 0.2))
    return manipulability_figure(model, ks.manipulability(model, "tool0", at.q), at)


def axes_figure():
    with house_style():
        figure = Figure(figsize=(3, 2))
        return figure, figure.add_axes((0.2, 0.2, 0.7, 0.7))


class Page(HTMLParser):
    """What a browser would make of it, as far as tags and attributes go."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.attributes, self.others = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs

    def handle_comment(self, data):
        self.others.append(data)

    handle_decl = handle_pi = unknown_decl = handle_comment


def numbers(data):
    return [float(x) for x in re.findall(r"-?(?:\d+\.?\d*|\.\d+)", data)]


def test_the_picture_is_the_same_to_a_hundredth_of_a_point():
    before = ET.fromstring(rendered(arm_figure(), ".svg"))
    after = ET.fromstring(embedded(arm_figure(), "a"))
    for parent in list(before.iter(f"{SVG}defs")):
        parent.clear()
    after.remove(after.find("defs"))
    for tag, keys in (("path", ("d",)), ("text", ("x", "y")), ("use", ("x", "y"))):
        old, new = list(before.iter(f"{SVG}{tag}")), list(after.iter(tag))
        assert len(old) == len(new) > 0
        for one, other in zip(old, new, strict=True):
            for key in keys:
                assert np.allclose(numbers(one.get(key, "")), numbers(other.get(key, "")), atol=0.0051)
    texts = [
        ["".join(one.itertext()) for one in tree.iter(tag)] for tree, tag in ((before, f"{SVG}text"), (after, "text"))
    ]
    assert texts[0] == texts[1]


def test_colours_are_the_pages_and_fall_back_to_those_of_paper():
    before, after = rendered(arm_figure(), ".svg").decode(), embedded(arm_figure(), "a")
    assert set(re.findall(r"var\((--[a-z-]+)", after)) <= set(THEME)
    on_paper = re.sub(r"var\(--[a-z-]+, (#[0-9a-f]{6})\)", r"\1", after)
    assert set(re.findall(r"#[0-9a-f]{6}\b", on_paper)) - {"#000000"} <= set(re.findall(r"#[0-9a-f]{6}\b", before))
    greys = re.findall(r'(?:fill|stroke)="#(..)\1\1"', after)
    assert not greys
    for name in ("ink", "soft", "grid", "paper", "blue", "vermilion"):
        assert f"var(--figure-{name}, " in after


def contrast(one, other):
    """Return the ratio of luminances as WCAG 2 has it."""

    def luminance(colour):
        linear = [
            (x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4)
            for x in (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
        ]
        return float(np.dot([0.2126, 0.7152, 0.0722], linear))

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("night", [False, True])
def test_text_and_lines_have_contrast_with_the_paper_by_day_and_by_night(night):
    colours = {name: pair[night] for name, pair in THEME.items()}
    paper = colours["--figure-paper"]
    assert min(contrast(colours[f"--figure-{name}"], paper) for name in ("ink", "soft")) > 4.5
    assert min(contrast(colours[f"--figure-{name}"], paper) for name in ("grey", "blue", "vermilion", "purple")) > 3


def test_ids_are_those_that_are_used_and_no_two_figures_share_one():
    first, second = (embedded(arm_figure(), prefix) for prefix in ("r1-1/poses", "r1-2/poses"))
    ids = re.findall(r' id="([^"]*)"', first)
    used = set(re.findall(r'href="#([^"]*)"', first)) | set(re.findall(r"url\(#([^)]*)\)", first))
    assert len(ids) == len(set(ids)) > 0
    assert set(ids) == used
    assert all(one.startswith("r1-1-poses-") for one in ids)
    assert not set(ids) & set(re.findall(r' id="([^"]*)"', second))


def test_nothing_stands_in_it_that_a_strict_page_refuses():
    page = Page(embedded(arm_figure(), "a"))
    assert page.tags[0] == "svg"
    assert not set(page.tags) & {"style", "script", "metadata", "foreignobject"}
    assert not page.others  # no prologue, doctype, comment
    names = [name for name, _ in page.attributes]
    assert not [name for name in names if name in ("style", "font-family") or name.startswith(("on", "xmlns"))]
    assert 'class="figure"' in embedded(arm_figure(), "a")


def test_its_size_is_that_on_paper_and_scales():
    svg = ET.fromstring(embedded(arm_figure(), "a"))
    inches = arm_figure().get_size_inches()
    assert np.allclose(numbers(svg.get("viewBox")), [0, 0, *(72 * inches)], atol=0.01)
    assert np.allclose([float(svg.get(side)) for side in ("width", "height")], 96 * inches, atol=0.5)


@pytest.mark.parametrize("name", HOSTILE_NAMES)
def test_a_hostile_name_is_inert_text(name):
    robot = ks.load("textbook:planar_2r").robot
    joints = tuple(replace(joint, name=f"{name}{i}") for i, joint in enumerate(robot.joints))
    svg = embedded(tree_figure(replace(robot, name=name, joints=joints), ()), name)
    page = Page(svg)
    assert not set(page.tags) & {"script", "img", "style", "iframe", "b", "i", "title"}
    assert not [key for key, _ in page.attributes if key.startswith("on")]
    assert not re.search(r"[\x00-\x08\x0b-\x1f\x7f\u2028-\u202e\u2066-\u2069\ud800-\udfff]", svg)
    assert not page.others
    shown = "".join("".join(one.itertext()) for one in ET.fromstring(svg).iter("text"))
    assert named(name, 60).replace(r"\$", "$")[:20] in shown  # that of a joint, in several lines


def test_links_lead_into_the_page_or_nowhere():
    figure, ax = axes_figure()
    for i, url in enumerate(("#r1-1", "javascript:alert(1)", "https://example.org/", "data:text/html,x")):
        ax.plot([i], [i], marker="o", url=url)
    page = Page(embedded(figure, "a"))
    links = {value for key, value in page.attributes if key == "href" and not value.startswith("#a-")}
    assert links == {"#r1-1"}
    assert "target" not in dict(page.attributes)


def test_a_picture_of_pixels_stays_in_it():
    from PIL import Image

    figure, ax = axes_figure()
    with house_style():
        values = np.add.outer(np.linspace(0, 1, 60), np.linspace(0, 1, 80))
        ax.pcolormesh(values, cmap="cividis", rasterized=True)
        before = (
            ET.fromstring(rendered(figure, ".svg")).find(f".//{SVG}image").get("{http://www.w3.org/1999/xlink}href")
        )
    after = ET.fromstring(embedded(figure, "a")).find(".//image").get("href")

    def pixels(uri):
        head, _, data = uri.partition(",")
        assert head == "data:image/png;base64"
        return np.asarray(Image.open(io.BytesIO(base64.b64decode(data))).convert("RGBA")).astype(int)

    assert pixels(before).shape == pixels(after).shape
    assert np.mean(np.abs(pixels(before) - pixels(after))) < 4
    assert len(after) < len(before)


def test_what_is_transparent_in_a_picture_of_pixels_stays_so():
    from PIL import Image

    figure, ax = axes_figure()
    pixels = np.full((20, 20, 4), 255, dtype=np.uint8)
    pixels[:10, :, 3] = 0
    with house_style():
        ax.imshow(pixels, interpolation="none")
    data = ET.fromstring(embedded(figure, "a")).find(".//image").get("href").partition(",")[2]
    alpha = np.asarray(Image.open(io.BytesIO(base64.b64decode(data))).convert("RGBA"))[..., 3]
    assert sorted(np.unique(alpha)) == [0, 255]
    assert np.mean(alpha == 0) == 0.5


def test_the_same_figure_gives_the_same_element():
    assert embedded(arm_figure(), "a") == embedded(arm_figure(), "a")
    assert len(embedded(arm_figure(), "a")) < 0.6 * len(rendered(arm_figure(), ".svg"))


def test_a_mark_that_leads_somewhere_says_where_and_a_text_says_it_once():
    figure, ax = axes_figure()
    for i, url in enumerate(("#r1-1", "#r2-1")):
        ax.plot([i], [i], marker="o", linestyle="none", url=url)
    ax.text(0.5, 0.5, "panda", url="#r1-1")
    svg = ET.fromstring(embedded(figure, "a", {"r1-1": "<b>pan\u202eda</b>"}))
    links = [(link.get("href"), "".join(link.itertext()), link[0].tag == "title") for link in svg.iter("a")]
    assert sorted(links) == [("#r1-1", "<b>pan\\u202eda</b>", True), ("#r1-1", "panda", False), ("#r2-1", "", False)]
