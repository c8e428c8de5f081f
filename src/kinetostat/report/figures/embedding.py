"""Figures that stand in a page: an <svg> element in the page's colours, its ids unique, without what it does not need.

A page with a Content-Security-Policy takes no style attribute and no <style> element; so what Matplotlib writes as
style becomes presentation attributes. Neutral colours and those of the house become custom properties of CSS, which a
page may set for its dark mode; where it does not, they are what they are on paper.
"""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import numpy as np

from kinetostat.errors import printable
from kinetostat.report.figures.saving import rendered
from kinetostat.report.figures.sheet import BLUE, PURPLE, SKY, VERMILION

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["THEME", "embedded"]

THEME: dict[str, tuple[str, str]] = {  # custom property: its colour on white paper, and one that reads on a dark page
    "--figure-ink": ("#222222", "#ececec"),
    "--figure-soft": ("#555555", "#b8b8b8"),
    "--figure-grey": ("#8a8a8a", "#8f8f8f"),
    "--figure-grid": ("#e4e4e4", "#3c3c3c"),
    "--figure-paper": ("#ffffff", "#1b1b1b"),
    "--figure-blue": (BLUE, "#4fa8e0"),
    "--figure-vermilion": (VERMILION, "#ff8a3d"),
    "--figure-purple": (PURPLE, "#d98cb8"),
    "--figure-sky": (SKY, "#8fd0f5"),
}
_HUES = {light: name for name, (light, _) in THEME.items() if light in (BLUE, VERMILION, PURPLE, SKY)}
_NEUTRALS = ((0x40, "ink"), (0x70, "soft"), (0xB8, "grey"), (0xF8, "grid"), (0x100, "paper"))  # darker than
_SVG, _XLINK = "{http://www.w3.org/2000/svg}", "{http://www.w3.org/1999/xlink}"
_PIXELS = 96 / 72  # of CSS, a point
_PRECISE = ("transform", "gradientTransform", "patternTransform")  # a factor of them is multiplied by a whole picture
_NUMBERS = (
    *("d", "x", "y", "x1", "y1", "x2", "y2", "r", "cx", "cy", "width", "height", "points", "viewBox"),
    *("stroke-width", "stroke-dasharray", "stroke-dashoffset", "font-size"),
)
_NUMBER = re.compile(r"-?(?:\d+\.\d*|\.\d+|\d+)(?:e[-+]?\d+)?")
_UNTURNED = re.compile(r"rotate\(-?0(?: [^)]*)?\)\s*")
_REFERENCE = re.compile(r"url\(#([^)]*)\)")
_OURS = {"font-family", "image-rendering", "stroke-linejoin"}  # properties that the page, or the whole picture, has
_PLAIN = dict.fromkeys(("fill-opacity", "stroke-opacity", "opacity"), "1")  # what holds where nothing is said
_PLAIN |= {"stroke-dashoffset": "0", "stroke-linecap": "butt"}


def embedded(figure: Figure, prefix: str, names: Mapping[str, str] | None = None) -> str:
    """Return a figure as an <svg class="figure"> element that can stand in an HTML page; the same every time.

    Text stays text, in the font of the page. Its size is that of paper in CSS's pixels, and scales with its viewBox.
    What it shows is for the page to say (role, aria-label).

    Args:
        figure: one made by this package.
        prefix: what makes its ids unique in the page.
        names: what places in the page are called, by their id: a link to one that is a mark without text says so, to
            the pointer and to who does not see it.
    """
    # What is read here was written by Matplotlib a moment ago: no entity, and names from robot files are escaped text.
    drawn = ET.fromstring(rendered(figure, ".svg"))  # noqa: S314
    for parent in list(drawn.iter()):
        for child in [one for one in parent if _name(one) in ("metadata", "style")]:
            parent.remove(child)
    for element in drawn.iter():
        _plain(element)
    svg = ET.Element("svg", {"class": "figure", "viewBox": drawn.get("viewBox", "")})
    svg.attrib |= {"stroke-linejoin": "round", "fill": _themed("#000000")}  # what is said of nothing is so of all
    for side, size in zip(("width", "height"), svg.get("viewBox", "").split()[2:], strict=False):
        svg.set(side, str(round(float(size) * _PIXELS)))
    shared = ET.SubElement(svg, "defs")
    for child in drawn:
        _take(child, svg, shared)
    _rename(svg, re.sub(r"[^A-Za-z0-9_-]", "-", prefix))
    _name_links(svg, names or {})
    if not len(shared):
        svg.remove(shared)
    return ET.tostring(svg, encoding="unicode")


def _name(element: ET.Element) -> str:
    return element.tag.removeprefix(_SVG)


def _plain(element: ET.Element) -> None:
    """Make an element's style presentation attributes, its numbers short, and its colours those of the page."""
    element.tag = _name(element)
    element.text = element.text if element.tag in ("text", "tspan") else None
    element.tail = element.tail if element.tag == "tspan" else None
    found = {name.replace(_XLINK, ""): value for name, value in element.attrib.items()}
    for part in found.pop("style", "").split(";"):
        name, _, value = part.partition(":")
        if value:
            found[name.strip()] = value.strip()
    element.attrib.clear()
    for name, value in found.items():
        if name not in _OURS and _PLAIN.get(name) != value and (shown := _attribute(element.tag, name, value)):
            element.set(name, shown)


def _attribute(tag: str, name: str, value: str) -> str:
    """Return an attribute's value as the page has it; empty where the page does without."""
    if name in ("fill", "stroke", "stop-color"):
        return _themed(value)
    if name == "font-size":
        value = value.removesuffix("px")
    if name in _NUMBERS:
        shorter = _NUMBER.sub(lambda found: _short(float(found[0]), 2), value)
        return _path(shorter) if name == "d" else shorter
    if name in _PRECISE:
        return _NUMBER.sub(lambda found: _short(float(found[0]), 6), _UNTURNED.sub("", value)).strip()
    if tag == "a":
        return value if name == "href" and value.startswith("#") else ""
    if tag == "image" and name == "href":
        return _optimised(value)
    return value


def _path(commands: str) -> str:
    """Return path data without spaces that separate nothing, and without the name of a command that is understood."""
    shorter = re.sub(r"\s*([MLCQz])\s*", r"\1", commands.strip())
    return shorter if {"C", "Q"} & set(shorter) else shorter.replace("L", " ")


def _short(number: float, digits: int) -> str:
    """Return a number with so many decimals at most, and no zero that says nothing."""
    shown = f"{number:.{digits}f}".rstrip("0").rstrip(".")
    shown = shown.replace("-0.", "-.") if shown.startswith("-0.") else shown.removeprefix("0") or "0"
    return "0" if shown in ("-0", "-", "") else shown


def _themed(colour: str) -> str:
    """Return a colour as a custom property of the page, with itself where the page does not set it."""
    if re.fullmatch(r"#[0-9a-f]{6}", colour) is None:
        return colour
    if colour in _HUES:
        return f"var({_HUES[colour]}, {colour})"
    red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    if not red == green == blue:
        return colour
    return f"var(--figure-{next(name for end, name in _NEUTRALS if red < end)}, {colour})"


def _optimised(uri: str) -> str:
    """Return the same picture of pixels as a data URI in fewer bytes: with a palette, where 256 colours are enough."""
    from PIL import Image

    head, _, data = uri.partition(",")
    image, content = Image.open(io.BytesIO(base64.b64decode(data))).convert("RGBA"), io.BytesIO()
    pixels = np.array(image).view("<u4")[..., 0]
    pixels[pixels >> 24 == 0] = 0  # what is not seen has no colour
    colours, index = np.unique(pixels, return_inverse=True)
    if len(colours) > 256:
        return uri.replace("\n", "")
    palette = colours.view(np.uint8).reshape(-1, 4)
    packed = Image.fromarray(index.reshape(pixels.shape).astype(np.uint8))
    packed.putpalette(palette[:, :3].tobytes())
    packed.save(content, format="PNG", optimize=True, transparency=palette[:, 3].tobytes())
    return f"{head},{base64.b64encode(content.getvalue()).decode('ascii')}"


def _take(element: ET.Element, parent: ET.Element, shared: ET.Element) -> None:
    """Put an element below a parent; definitions into those that all share, groups that say nothing not at all."""
    if element.tag == "defs":
        shared.extend(element)
        return
    if element.tag == "g" and not set(element.attrib) - {"id"}:
        for child in element:
            _take(child, parent, shared)
        return
    children = list(element)
    for child in children:
        element.remove(child)
    if element.tag in ("g", "a") and not children:
        return
    parent.append(element)
    for child in children:
        _take(child, element, shared)


def _name_links(svg: ET.Element, names: Mapping[str, str]) -> None:
    """Name the links that have no text, where it is known what they lead to."""
    for link in svg.iter("a"):
        name = names.get(link.get("href", "")[1:])
        if name and not "".join(link.itertext()):
            title = ET.Element("title")
            title.text = printable(name)
            link.insert(0, title)


def _rename(svg: ET.Element, prefix: str) -> None:
    """Number the ids that something refers to, in order, behind a prefix; drop the others."""
    used = dict[str, str]()
    for element in svg.iter():
        for name, value in element.attrib.items():
            found = [value[1:]] if name == "href" and element.tag == "use" else _REFERENCE.findall(value)
            for reference in found:
                used.setdefault(reference, f"{prefix}-{len(used) + 1}")
    for element in svg.iter():
        for name, value in list(element.attrib.items()):
            if name == "id" and value not in used:
                del element.attrib[name]
            elif name == "id":
                element.set(name, used[value])
            elif name == "href" and element.tag == "use":
                element.set(name, f"#{used[value[1:]]}")
            else:
                element.set(name, _REFERENCE.sub(lambda found: f"url(#{used[found[1]]})", value))
