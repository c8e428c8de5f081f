"""Pictures of the reach: cells hold the best of what falls into them, curves are where they are, names are text."""

import base64
import io
import re
from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from matplotlib.colors import to_hex
from numpy.testing import assert_allclose
from PIL import Image

import kinetostat as ks
from kinetostat.analysis.crosscheck import Certificate
from kinetostat.analysis.profile.anatomy import Limb
from kinetostat.analysis.profile.cells import best_in_cells
from kinetostat.analysis.profile.result import LimbProfile
from kinetostat.analysis.profile.section import Section
from kinetostat.analysis.profile.sections import sections
from kinetostat.analysis.singular.slices import Curve
from kinetostat.analysis.sweeping.sweep import sweep
from kinetostat.report.figures.embedding import embedded
from kinetostat.report.figures.reach_maps import _curves, _held, reach_figure, reach_thumbnail
from kinetostat.report.figures.saving import save
from kinetostat.report.figures.sheet import VERMILION, WIDTH, text_width
from kinetostat.report.figures.silhouettes import OUTLINE, silhouette

HOSTILE = "<script>$x_{$\x1b[31m</script>"


def profiled(robot, frame, positions="mid"):
    """Return what is drawn of a limb: its places at random configurations, and its sections."""
    model = ks.load(robot)
    base, q, blocks = model.robot.root, ks.configuration(model, positions).q, []
    limb = Limb(frame, base, frame, tuple(joint.name for joint in model.robot.movable_path(base, frame)), "tip")
    measures = ("position", "minimum_singular_value")
    swept = sweep(model, frame, q, samples=4000, measures=measures, sink=blocks.append)
    rows = np.concatenate([block.values for block in blocks])
    found = sections(model, limb, q, "here", task=swept.task, length=swept.length, families=None)
    return LimbProfile(limb, swept, rows[:, :3], rows[:, 3], None, None, (), None, found, None, ())


CASES = {
    "clipped": ("textbook:planar_2r_6_3", "tool", "mid"),
    "puma": ("textbook:puma560", "tool", {"joint5": 1.0}),
    "line": ("textbook:planar_1r", "tool", "mid"),
    "leg": ("example:a1", "FR_foot", {"FR_thigh_joint": 0.8, "FR_calf_joint": -1.8}),
    "wrist": ("textbook:wrist_zyz", "tool", "mid"),
}


@pytest.fixture(scope="module", params=CASES)
def any_profile(request):
    return profiled(*CASES[request.param])


@pytest.fixture(scope="module")
def puma():
    return profiled(*CASES["puma"])


@pytest.fixture(scope="module")
def clipped():
    return profiled(*CASES["clipped"])


def test_a_square_has_the_largest_value_of_the_sheets_over_it():
    across = np.linspace(-1, 1, 9)
    x, y = np.meshgrid(across, np.linspace(0, 1, 5))
    folded = np.stack([np.abs(x), y], axis=-1)  # both halves lie on one another
    best = best_in_cells(folded, x, np.array([[0.0, 0.0], [1.0, 1.0]]), (10, 10))
    middles = (np.arange(10) + 0.5) / 10
    assert_allclose(best, np.tile(middles, (10, 1)), atol=0.051)
    assert np.all(best > 0)


def test_a_square_that_nothing_falls_into_has_no_value():
    points = np.array([[[0.0, 0.0], [0.5, 0.0]], [[0.0, 0.5], [0.5, 0.5]]])
    best = best_in_cells(points, np.ones((2, 2)), np.array([[0.0, 0.0], [1.0, 1.0]]), (8, 8))
    assert np.all(np.isfinite(best[:4, :4]))
    assert np.all(np.isnan(best[5:])) and np.all(np.isnan(best[:, 5:]))  # noqa: PT018


def test_the_silhouette_of_a_disc_is_a_disc():
    generator = np.random.default_rng(0)
    points = generator.uniform(-1, 1, (20_000, 2))
    x, y, heights = silhouette(points[np.linalg.norm(points, axis=1) < 1], np.array([[-1.2] * 2, [1.2] * 2]), (60, 60))
    radius = np.hypot(*np.meshgrid(x, y))
    assert np.all(heights[radius < 0.93] > OUTLINE)
    assert np.all(heights[radius > 1.07] < OUTLINE)


def test_places_on_a_line_have_no_silhouette():
    turns = np.linspace(0, 6, 5000)
    assert silhouette(np.stack([np.cos(turns), np.sin(turns)], -1), np.array([[-1.2] * 2, [1.2] * 2]), (60, 60)) is None


def test_curves_are_drawn_where_they_are(clipped):
    ax = reach_figure(clipped).axes[0]
    drawn = [line.get_xydata() for line in ax.lines if to_hex(line.get_color()) == VERMILION]
    (section,) = clipped.sections
    curves = [curve for curve in (*section.curves, *section.unlimited) if curve.kind == "singular"]
    assert len(drawn) == len(curves)
    for each, curve in zip(drawn, curves, strict=True):
        assert_allclose(each, curve.points)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x [m]", "y [m]")


def test_the_brightest_colour_is_the_largest_value_of_both_panels(puma):
    figure = reach_figure(puma)
    images = [np.array(image.get_array()) for ax in figure.axes[:2] for image in ax.images]
    largest = [section.smallest.max() for section in sorted(puma.sections, key=lambda each: each.view != "side")]
    brightest = [image[image[..., 3] == 255][:, :3].sum(axis=1).max() for image in images]
    assert len(images) == 2
    assert np.argmax(brightest) == np.argmax(largest)
    bar = figure.axes[-1]
    assert_allclose(bar.get_ylim()[1], max(largest), rtol=0.01)
    assert bar.get_ylabel() == "smallest singular value\n[a pure number]"


def test_what_is_not_reached_is_transparent_in_a_page(clipped):
    for figure in (reach_figure(clipped), reach_thumbnail(clipped)[0]):
        found = re.search(r'href="data:image/png;base64,([^"]+)"', embedded(figure, "r1-1"))
        image = np.array(Image.open(io.BytesIO(base64.b64decode(found[1]))).convert("RGBA"))
        corner, filled = image[0, 0], image[image[..., 3] == 255]
        assert corner[3] == 0
        assert 0.05 < len(filled) / image[..., 0].size < 0.6
        assert len(np.unique(filled, axis=0)) > 30  # cividis, not a handful of colours


def test_panels_are_to_one_scale(puma):
    figure = reach_figure(puma)
    width, height = figure.get_size_inches()
    scales = []
    for ax in figure.axes[:2]:
        box = ax.get_position()
        scales += [box.width * width / np.ptp(ax.get_xlim()), box.height * height / np.ptp(ax.get_ylim())]
    assert_allclose(scales, scales[0], rtol=1e-6)


def test_it_says_which_joints_move_and_where_the_others_are(puma):
    text = " ".join(each.get_text() for each in reach_figure(puma).texts)
    assert "from the side joint2 and joint3 move, from above" in text
    assert "the others are held at the pose here: joint5 1 rad, the rest 0" in text
    assert "where two joints at a time take tool" in text


def test_nothing_is_outside_the_page(any_profile):
    figure = reach_figure(any_profile)
    figure.canvas.draw()
    width, height = figure.get_size_inches() * figure.dpi
    for part in (*figure.axes, *figure.texts, *figure.legends):
        box = part.get_window_extent() if part not in figure.axes else part.get_tightbbox()
        assert box.x0 >= 0
        assert box.y0 >= 0
        assert box.x1 <= width
        assert box.y1 <= height


def test_it_is_a_small_part_of_a_page_and_the_same_every_time(any_profile):
    first = embedded(reach_figure(any_profile), "r1-1")
    assert first == embedded(reach_figure(any_profile), "r1-1")
    assert len(first) < 64_000
    small, _ = reach_thumbnail(any_profile)
    assert len(embedded(small, "r1-1")) < 15_000


def test_a_thumbnail_has_no_text_and_tells_its_width(any_profile):
    figure, metres = reach_thumbnail(any_profile)
    (ax,) = figure.axes
    assert_allclose(metres, np.ptp(ax.get_xlim()))
    assert_allclose(np.ptp(ax.get_xlim()), np.ptp(ax.get_ylim()))
    assert "<text" not in embedded(figure, "r1-1")


def test_a_profile_without_sections_is_drawn_as_what_is_reached(puma):
    figure = reach_figure(replace(puma, sections=()))
    assert len(figure.axes) == 1
    assert not figure.axes[0].images
    assert figure.axes[0].collections


def test_one_place_alone_is_drawn(puma):
    nowhere = replace(puma, sections=(), positions=np.zeros((5, 3)))
    assert reach_figure(nowhere).axes[0].lines
    assert reach_thumbnail(nowhere)[1] > 0


def test_its_title_says_which_joints_bring_it_there(clipped):
    text = " ".join(each.get_text() for each in reach_figure(clipped).texts)
    assert "where joint1 and joint2 take tool" in text
    assert "held" not in text


def test_joints_that_are_held_take_two_lines_at_most(puma):
    many = replace(puma.sweep, names=tuple(f"a_joint_with_a_long_name_{i}" for i in range(6)))
    held = tuple(replace(section, held=np.arange(1.0, 7.0)) for section in puma.sections)
    (line,) = [each for each in _held(replace(puma, sweep=many), held) if "held" in each]
    assert "more" in line
    assert text_width(line, 8.5) < 2 * 6.9


def flat_of(profile):
    """Return the profile with the same value all over its sections."""
    return replace(profile, sections=tuple(replace(s, smallest=s.smallest * 0 + 0.5) for s in profile.sections))


def test_what_is_the_same_everywhere_has_one_tint_and_no_scale(clipped):
    figure = reach_figure(flat_of(clipped))
    assert len(figure.axes) == 1
    image = np.array(figure.axes[0].images[0].get_array())
    assert len(np.unique(image[image[..., 3] == 255], axis=0)) == 1
    words = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert any("0.5" in text and "the same everywhere" in text for text in words)


def test_a_singular_curve_is_dashed_where_another_posture_is_fine():
    across = np.linspace(-1, 1, 181)
    x, y = np.meshgrid(across, across)
    alone = np.abs(x)  # one sheet, singular on a line
    folded = np.where(y < 0, np.abs(x), 1.0)  # the other half lies on it, and is fine
    lines = {}
    for name, places, values in (("alone", (x, y), alone), ("folded", (x, np.abs(y)), folded)):
        curve = Curve("singular", np.stack([0 * across[:90], np.linspace(0.1, 0.9, 90)], -1), "singular")
        points, view = np.stack(places, -1), np.eye(3)[:2]
        proof, arm = Certificate(("pinocchio", "screw"), 0.0, 1e-12), points[0]
        section = Section("side", view, ("a", "b"), np.zeros(2), "mid", points, values, (curve,), (), arm, proof)
        box = np.array([[-1.1, -1.1], [1.1, 1.1]])
        lines[name] = [kind for kind, _ in _curves(section, best_in_cells(points, values, box, (200, 200)), box)]
    assert lines == {"alone": ["singular"], "folded": ["posture"]}


def test_a_tower_has_room_beside_it(puma):
    thin = replace(puma, sections=(), positions=puma.positions * [0.01, 0.01, 3])
    ax = reach_figure(thin).axes[0].get_position()
    width, height = reach_figure(thin).get_size_inches()
    assert ax.width * width >= ax.height * height / 3 - 1e-9


def test_a_figure_is_as_wide_as_the_others(any_profile):
    assert reach_figure(any_profile).get_size_inches()[0] <= WIDTH + 1e-9


def test_the_silhouette_of_a_rectangle_stays_within_a_hair_of_it():
    points = np.random.default_rng(0).uniform(-1, 1, (40_000, 2))
    for shift in (0.0, 0.3, 0.7):  # of squares
        box = np.array([[-1.2, -1.2], [1.2, 1.2]]) + 0.04 * shift
        x, y, heights = silhouette(points, box, (60, 60))
        outside = np.max(np.abs(np.stack(np.meshgrid(x, y))), axis=0) > 1 + 0.02
        assert np.all(heights[outside] < OUTLINE)


@pytest.mark.parametrize("suffix", [".svg", ".png", ".pdf"])
def test_it_is_written_in_every_format(clipped, tmp_path, suffix):
    path = tmp_path / f"reach{suffix}"
    save(reach_figure(clipped), path)
    assert path.stat().st_size > 1000


def test_names_are_text(puma, tmp_path):
    limb = replace(puma.limb, name=HOSTILE, base=HOSTILE, frame=HOSTILE)
    named = tuple(replace(section, joints=(HOSTILE, HOSTILE), held_name=HOSTILE) for section in puma.sections)
    save(reach_figure(replace(puma, limb=limb, sections=named)), tmp_path / "reach.svg")
    root = ET.parse(tmp_path / "reach.svg").getroot()
    assert not [each for each in root.iter() if each.tag.endswith("script")]
    assert any("<script>" in (each.text or "") for each in root.iter())
