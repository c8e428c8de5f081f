"""Pictures: what is drawn is what was computed, nothing hostile acts, nothing is cut, and bytes repeat."""

import re
import subprocess
import sys
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from xml.etree import ElementTree as ET

import matplotlib as mpl
import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.singular.slices import Curve, Mark, Slice, Workspace
from kinetostat.analysis.skeleton import skeleton
from kinetostat.report.figures import check_suffix, manipulability_figure, save, slice_figure, workspace_figure

HOSTILE = "<script>$x_{$\x1b[31m</script>"
MODELS = {}


def model_of(source):
    return MODELS.setdefault(source, ks.load(source))


def drawn(source, q, frame=None, **asked):
    """Return the picture of a robot, and the result that it shows."""
    model = source if isinstance(source, ks.Model) else model_of(source)
    at = ks.configuration(model, q)
    result = ks.manipulability(model, frame or model.robot.default_tip(), at.q, **asked)
    return manipulability_figure(model, result, at), result


def labelled(ax, label):
    """Return what is drawn under a label: patches and lines."""
    return [artist for artist in (*ax.patches, *ax.lines) if artist.get_label() == label]


def legend_text(figure):
    return "\n".join(text.get_text() for legend in figure.legends for text in legend.get_texts())


def stated_scale(figure, name):
    """Return the metres per unit that the legend states."""
    return float(re.search(rf"{name} ellipsoid.*: 1 ?\S* drawn as (\S+) m", legend_text(figure))[1])


def outline(patch):
    """Return points (n, 2) on a patch's outline."""
    from matplotlib.transforms import Affine2D

    large = Affine2D().scale(1e5)  # curves become polygons to a pixel
    path = (patch.get_patch_transform() + large).transform_path(patch.get_path())
    return np.vstack(path.to_polygons(closed_only=False)) / 1e5


def jacobian_2r(q):
    """Return the closed form (2, 2) of textbook planar_2r, links of 1 m and 0.8 m."""
    (s1, c1), (s12, c12) = ((np.sin(a), np.cos(a)) for a in (q[0], q[0] + q[1]))
    return np.array([[-s1 - 0.8 * s12, -0.8 * s12], [c1 + 0.8 * c12, 0.8 * c12]])


def tip_2r(q):
    return np.array([np.cos(q[0]) + 0.8 * np.cos(q[0] + q[1]), np.sin(q[0]) + 0.8 * np.sin(q[0] + q[1])])


# --- manipulability: numbers in the picture


@pytest.mark.parametrize("asked", [{}, {"reference": "local"}, {"expressed_in": "link1"}, {"axes": "x y"}])
@pytest.mark.parametrize("q", [(np.pi / 6, np.pi / 3), (-2.0, 1.1), (0.4, -2.7)])
def test_ellipses_of_a_planar_2r_are_those_of_its_jacobian(q, asked):
    figure, _ = drawn("textbook:planar_2r", q, **asked)
    (ax,) = figure.axes
    left, values, _ = np.linalg.svd(jacobian_2r(q))
    for name, lengths, axes in (("velocity", values, left), ("force", 1 / values[::-1], left[:, ::-1])):
        (ellipse,) = labelled(ax, name)
        scale = stated_scale(figure, name)
        assert np.allclose(ellipse.get_center(), tip_2r(q), atol=1e-12)
        assert np.allclose([ellipse.width / 2, ellipse.height / 2], scale * lengths, rtol=1e-12)
        angle = np.radians(ellipse.angle)
        assert abs(np.cos(angle) * axes[1, 0] - np.sin(angle) * axes[0, 0]) < 1e-12
        assert 0.1 < ellipse.width / 2 < 1.0  # readable next to 1.8 m of arm


def test_the_arm_is_where_its_links_are():
    figure, _ = drawn("textbook:planar_2r", (0.5, 0.7))
    (arm,) = labelled(figure.axes[0], "arm")
    assert np.allclose(arm.get_xydata(), [(0, 0), (np.cos(0.5), np.sin(0.5)), tip_2r((0.5, 0.7))], atol=1e-12)


@pytest.mark.parametrize(("source", "frame", "q"), [
    ("example:ur5_robot", "tool0", (0.3, -1.2, 1.4, -0.6, 0.8, 0.2)),
    ("example:panda", "panda_hand", "default"),
    ("textbook:scara", "tool", (0.5, 0.9, 0.1, 0.0)),
])  # fmt: skip
def test_two_views_show_a_spatial_arm_and_the_shadows_of_its_ellipsoids(source, frame, q):
    model = model_of(source)
    figure, result = drawn(source, q, frame)
    at = ks.configuration(model, q).q
    tip = ks.fk(model, frame, at).position
    views = [np.array([vector(ax.get_xlabel()), vector(ax.get_ylabel())]) for ax in figure.axes]
    for view in views:
        assert np.allclose(view @ view.T, np.eye(2), atol=2e-3)
    assert len(views) == 2
    assert abs(np.cross(*views[0]) @ np.cross(*views[1])) < 2e-3
    block = result.blocks["translation"]
    for ax, view in zip(figure.axes, views, strict=True):
        (arm,) = labelled(ax, "arm")
        assert np.allclose(arm.get_xydata()[-1], view @ tip, atol=2e-3)
        for name, ellipsoid in (("velocity", block.velocity), ("force", block.force)):
            (ellipse,) = labelled(ax, name)
            around = outline(ellipse) - ellipse.get_center()
            for angle in np.linspace(0, np.pi, 7):  # the support of a shadow is the support of the body
                direction = np.array([np.cos(angle), np.sin(angle)])
                support = np.linalg.norm(ellipsoid.lengths * (direction @ view @ ellipsoid.axes))
                assert np.isclose((around @ direction).max(), stated_scale(figure, name) * support, rtol=1e-2)


def vector(label):
    """Return the direction (3,) that an axis' label names."""
    found = np.zeros(3)
    for sign, size, letter in re.findall(r"([-+]?) ?([\d.]*) ?([xyz])\b", label.removesuffix(" [m]")):
        found["xyz".index(letter)] = float(size or 1) * (-1 if sign == "-" else 1)
    return found


def test_the_title_tells_the_positions_with_their_units():
    figure, _ = drawn("textbook:stanford", "joint1=0.25,joint2=-1,joint3=0.5,joint6=0.125")
    shown = [text.get_text() for text in figure.texts]
    assert shown[0] == "stanford: tool relative to base"
    assert "at q = 0.25, -1 rad, 0.5 m, 0, 0, 0.125 rad" in shown


def test_the_point_of_the_world_reference_is_the_observers_origin():
    figure, _ = drawn("textbook:planar_2r", (0.5, 0.7), reference="world")
    (line,) = labelled(figure.axes[0], "velocity")  # joint1 does not move that point: one joint, one line
    assert np.allclose(line.get_xydata().mean(axis=0), 0, atol=1e-12)
    half = np.linalg.norm(np.diff(line.get_xydata(), axis=0)) / 2
    assert np.isclose(half, stated_scale(figure, "velocity") * 1.0)


def test_a_point_off_the_frame_carries_the_ellipsoids():
    figure, _ = drawn("textbook:planar_2r", (0.0, 0.5), point=(0.2, 0, 0))
    (ellipse,) = labelled(figure.axes[0], "velocity")
    expected = [1 + np.cos(0.5), np.sin(0.5)]
    assert np.allclose(ellipse.get_center(), expected, atol=1e-12)


def test_a_task_of_one_row_is_a_line_of_its_length():
    q = (0.4, 0.9)
    figure, _ = drawn("textbook:planar_2r", q, axes="x")
    (line,) = labelled(figure.axes[0], "velocity")
    ends = line.get_xydata()
    assert np.allclose(ends[1] - ends[0], [(ends[1] - ends[0])[0], 0], atol=1e-12)
    half = np.linalg.norm(ends[1] - ends[0]) / 2
    assert np.isclose(half, stated_scale(figure, "velocity") * np.linalg.norm(jacobian_2r(q)[0]))


def test_a_stretched_arm_moves_along_a_line_and_holds_any_force_along_itself():
    figure, result = drawn("textbook:planar_2r", (np.pi / 6, 0.0))
    (ax,) = figure.axes
    (line,) = labelled(ax, "velocity")
    ends = line.get_xydata()
    assert np.allclose(ends.mean(axis=0), tip_2r((np.pi / 6, 0.0)))
    assert abs((ends[1] - ends[0]) @ [np.cos(np.pi / 6), np.sin(np.pi / 6)]) < 1e-12
    largest = float(result.blocks["translation"].singular_values[0])
    assert np.isclose(np.linalg.norm(ends[1] - ends[0]), 2 * stated_scale(figure, "velocity") * largest)
    (arrow,) = labelled(ax, "force without bound")
    start, end = (np.array(side) for side in arrow._posA_posB)
    assert abs(np.cross([*(end - start), 0], [np.cos(np.pi / 6), np.sin(np.pi / 6), 0])[2]) < 1e-12
    assert "force without bound" in legend_text(figure)
    assert "∞ (end-on), ∞, 0.508" in legend_text(figure)


def test_a_regular_planar_arm_has_no_arrow_but_says_what_it_holds_across():
    figure, _ = drawn("textbook:planar_2r", (0.3, 1.0))
    assert labelled(figure.axes[0], "force without bound") == []
    assert "∞ (end-on)" in legend_text(figure)


@pytest.mark.parametrize(("source", "frame", "q"), [
    ("textbook:wrist_zyz", "link3", (0.3, 0.8, 0.0)),
    ("textbook:wrist_zyz", "tool", (0.0, 0.0, 0.0)),
    ("textbook:skew_1p", "tool", "zero"),
    ("textbook:helical", "tool", "zero"),
    ("textbook:planar_1r", None, "zero"),
    ("example:ur5_robot", "tool0", "zero"),
])  # fmt: skip
def test_singular_and_degenerate_pictures_are_finite(source, frame, q, tmp_path):
    figure, _ = drawn(source, q, frame)
    for ax in figure.axes:
        assert np.all(np.isfinite([*ax.get_xlim(), *ax.get_ylim()]))
        assert np.diff(ax.get_xlim())[0] < 1e3
    save(figure, tmp_path / "picture.png")


# --- the plane


def tilted_2r(tmp_path, rpy):
    """Return a planar 2R, links of 1 m and 0.8 m, whose base is turned."""
    text = (Path(__file__).parents[2] / "robots" / "planar_2r.urdf").read_text()
    place = tmp_path / "tilted.urdf"
    place.write_text(text.replace('<origin xyz="0 0 0"/>', f'<origin xyz="0 0 0" rpy="{rpy}"/>', 1))
    return ks.load(place)


@pytest.mark.parametrize(("rpy", "labels"), [
    ("1.5707963267948966 0 0", ("x [m]", "z [m]")),
    ("0 1.5707963267948966 0", ("y [m]", "z [m]")),
    ("0 0 1", ("x [m]", "y [m]")),
    ("3.141592653589793 0 0", ("x [m]", "y [m]")),
    ("0.3 -0.7 1", None),
])  # fmt: skip
def test_a_planar_arm_is_drawn_in_exactly_its_plane(tmp_path, rpy, labels):
    model = tilted_2r(tmp_path, rpy)
    figure, _ = drawn(model, (0.4, 0.9))
    (ax,) = figure.axes
    (arm,) = labelled(ax, "arm")
    assert np.allclose(np.linalg.norm(np.diff(arm.get_xydata(), axis=0), axis=1), [1, 0.8], atol=1e-12)
    if labels is None:
        up, right = vector(ax.get_ylabel()), vector(ax.get_xlabel())
        assert up[2] > 0.5
        assert right[2] == 0
    else:
        assert (ax.get_xlabel(), ax.get_ylabel()) == labels


def test_metres_are_as_long_upwards_as_sideways():
    for figure in (
        drawn("textbook:planar_3r", (0.5, 0.6, -1.1))[0],
        drawn("example:panda", "default", "panda_hand")[0],
    ):
        for ax in figure.axes:
            inches = ax.get_position().size * figure.get_size_inches()
            metres = np.array([np.diff(ax.get_xlim())[0], np.diff(ax.get_ylim())[0]])
            assert np.isclose(*(inches / metres))


# --- skeleton


def test_the_stick_figure_of_the_stanford_arm():
    model = model_of("textbook:stanford")
    arm = skeleton(model, "tool", ks.configuration(model, "joint3=0.5").q)
    assert [pivot.kind for pivot in arm.pivots] == ["turning", "turning", "sliding", *["turning"] * 3]
    assert np.allclose(arm.points, [(0, 0, 0), (0, 0, 0.412), (0, 0.154, 0.912), (0, 0.154, 1.175)])
    assert [pivot.vertex for pivot in arm.pivots] == [0, 1, 2, 2, 2, 2]
    assert np.allclose([pivot.axis for pivot in arm.pivots][:3], [(0, 0, 1), (0, 1, 0), (0, 0, 1)])
    assert arm.normal is None


def test_the_stick_figure_from_the_tool_is_the_same_arm_seen_from_there():
    model = model_of("example:ur5_robot")
    q = ks.configuration(model, "random:3").q
    there, back = skeleton(model, "tool0", q), skeleton(model, "world", q, relative_to="tool0")
    seen = ks.fk(model, "world", q, relative_to="tool0").matrix
    assert np.allclose(back.points[::-1], there.points @ seen[:3, :3].T + seen[:3, 3])
    assert [pivot.name for pivot in back.pivots[::-1]] == [pivot.name for pivot in there.pivots]
    for one, other in zip(back.pivots[::-1], there.pivots, strict=True):
        assert np.allclose(back.points[one.vertex], seen[:3, :3] @ there.points[other.vertex] + seen[:3, 3])
        assert np.allclose(one.axis, seen[:3, :3] @ other.axis)


def test_planar_arms_have_a_normal_and_others_have_none():
    for source, q, normal in (
        ("textbook:planar_3r", "random:1", (0, 0, 1)),
        ("textbook:pr", "zero", (0, 0, 1)),
        ("textbook:scara", "zero", None),
        ("textbook:helical", "zero", None),
        ("textbook:skew_1p", "zero", None),
        ("textbook:torus_3r", "zero", None),
    ):
        model = model_of(source)
        found = skeleton(model, model.robot.default_tip(), ks.configuration(model, q).q).normal
        assert found is None if normal is None else np.allclose(found, normal)


def test_a_stick_figure_is_of_one_configuration():
    with pytest.raises(ks.ConfigurationError):
        skeleton(model_of("textbook:planar_2r"), "tool", np.zeros((3, 2)))


# --- slices


def ramp(unit=("rad", "rad"), signed=True, marks=(), limits=None, top=np.pi):
    """Return a slice with sigma = |sin y| and determinant sin y."""
    x, y = np.linspace(-top, top, 41), np.linspace(-2, 2, 32)
    values = np.tile(np.sin(y)[:, None], (1, 41))
    return Slice(
        ("first", "second"),
        unit,
        x,
        y,
        np.abs(values),
        values if signed else None,
        limits or ((-2.0, 2.5), (-np.inf, np.inf)),
        marks,
        (0.5, 1.0),
    )


def contour_points(ax):
    paths = [path for group in ax.collections for path in group.get_paths() if "Contour" in type(group).__name__]
    return np.vstack([path.vertices for path in paths]) if paths else np.zeros((0, 2))


@pytest.mark.parametrize(("degrees", "factor"), [(False, 1.0), (True, 180 / np.pi)])
def test_a_slice_shows_values_and_the_curve_where_the_determinant_is_zero(degrees, factor):
    slice_ = ramp()
    figure = slice_figure(slice_, degrees=degrees)
    ax = figure.axes[0]
    mesh = ax.collections[0]
    assert np.allclose(mesh.get_array().reshape(32, 41), slice_.smallest)
    points = contour_points(ax)
    assert len(points) > 10
    assert np.abs(points[:, 1]).max() < 1e-3 * factor
    assert np.allclose(ax.get_xlim(), (-np.pi * factor, np.pi * factor))
    (frame,) = labelled(ax, "limits")
    assert np.allclose([frame.get_x(), frame.get_width()], np.array([-2.0, 4.5]) * factor)
    assert np.allclose([frame.get_y(), frame.get_height()], np.array([-2.0, 4.0]) * factor)
    unit = "deg" if degrees else "rad"
    assert (ax.get_xlabel(), ax.get_ylabel()) == (f"first [{unit}]", f"second [{unit}]")
    ticks = [text for text, _ in texts(figure)]
    expected = ["-180", "-90", "0", "90", "180"] if degrees else ["-π", "-π/2", "0", "π/2", "π"]
    assert [tick.replace(chr(0x2212), "-") for tick in ticks if tick[-1] in "0π2"][:5] == expected


def test_what_is_outside_the_limits_is_under_a_veil_and_the_inside_is_not():
    ax = slice_figure(ramp()).axes[0]
    (veil,) = labelled(ax, "outside limits")
    whole, hole = veil.get_path().to_polygons()
    assert np.allclose([hole.min(axis=0), hole.max(axis=0)], [(-2.0, -2.0), (2.5, 2.0)])
    assert np.allclose([whole.min(axis=0), whole.max(axis=0)], [(-np.pi, -2.0), (np.pi, 2.0)])
    assert area(whole) * area(hole) < 0  # wound the other way round: a hole


def area(corners):
    (x, y), (u, v) = corners.T, np.roll(corners, -1, axis=0).T
    return np.sum(x * v - u * y) / 2


def test_marks_are_lines_and_points_with_their_labels_dashed_outside_limits():
    marks = (
        Mark("first = 0", 0.0, None, inside=True),
        Mark("second = 1.5", None, 1.5, inside=False),
        Mark("both", 1.0, -1.0, inside=True),
        Mark("far away", 99.0, None, inside=True),
    )
    ax = slice_figure(ramp(marks=marks)).axes[0]
    assert {text.get_text() for text in ax.texts} == {"first = 0", "second = 1.5", "both"}
    upright = [line for line in ax.lines if np.array_equal(line.get_xdata(), [0.0, 0.0])]
    level = [line for line in ax.lines if np.array_equal(line.get_ydata(), [1.5, 1.5])]
    assert [line.get_linestyle() for line in (*upright, *level)] == ["-", "--"]
    assert any(np.array_equal(line.get_xydata(), [(1.0, -1.0)]) for line in ax.lines)


def test_no_curve_is_drawn_from_the_sign_of_rounding():
    noise = np.random.default_rng(0).normal(0, 1e-17, (32, 41))
    figure = slice_figure(replace(ramp(), smallest=np.abs(noise), signed=noise))
    assert len(contour_points(figure.axes[0])) == 0
    assert len(contour_points(slice_figure(ramp(signed=False)).axes[0])) == 0


def test_values_of_many_magnitudes_are_told_apart_by_a_logarithmic_scale():
    from matplotlib.colors import LogNorm

    x = np.linspace(0, 1, 41)
    steep = replace(ramp(), smallest=np.tile(np.exp(-12 * x), (32, 1)), signed=None)
    assert isinstance(slice_figure(steep).axes[0].collections[0].norm, LogNorm)
    assert not isinstance(slice_figure(ramp()).axes[0].collections[0].norm, LogNorm)


def test_a_slide_is_in_metres_whatever_the_angles_are_in():
    ax = slice_figure(ramp(unit=("m", "rad"), top=0.3), degrees=True).axes[0]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("first [m]", "second [deg]")
    assert np.allclose(ax.get_xlim(), (-0.3, 0.3))


# --- workspaces


def annulus(count, labels=("joint2 = 0", "joint2 = pi")):
    """Return the workspace of a planar 2R with links of 6 m and 3 m: between circles of 3 m and 9 m."""
    drawn_q = np.random.default_rng(1).uniform(-np.pi, np.pi, (count, 2))
    reached = np.c_[
        6 * np.cos(drawn_q[:, 0]) + 3 * np.cos(drawn_q.sum(1)), 6 * np.sin(drawn_q[:, 0]) + 3 * np.sin(drawn_q.sum(1))
    ]
    turn = np.linspace(-np.pi, np.pi, 90)
    circle = np.c_[np.cos(turn), np.sin(turn)]
    outer, inner = (Curve(label, r * circle, "singular") for label, r in zip(labels, (9, 3), strict=True))
    limit = Curve("joint2 = 2", 4.5 * circle, "limit")
    return Workspace(("x", "y"), "base", reached, np.abs(np.sin(drawn_q[:, 1])), (outer, limit), (outer, inner))


@pytest.mark.parametrize(("count", "rasterized"), [(200, False), (5000, True)])
def test_a_workspace_shows_points_and_curves_to_scale(count, rasterized):
    workspace = annulus(count)
    figure = workspace_figure(workspace)
    ax = figure.axes[0]
    assert np.allclose(ax.collections[0].get_offsets(), workspace.reached)
    assert np.allclose(ax.collections[0].get_array(), workspace.smallest)
    assert bool(ax.collections[0].get_rasterized()) is rasterized
    radii = {round(float(np.linalg.norm(line.get_xydata()[0])), 9): line for line in ax.lines}
    assert set(radii) == {9.0, 4.5, 3.0}
    bold, thin, grey = (next(line for line in ax.lines if line.get_zorder() == order) for order in (5, 4, 3))
    assert bold.get_linewidth() > 2 * thin.get_linewidth()
    assert grey.get_linestyle() == "--"
    inches = ax.get_position().size * figure.get_size_inches()
    assert np.isclose(*(inches / [np.diff(ax.get_xlim())[0], np.diff(ax.get_ylim())[0]]))
    for words in ("singular: joint2 = 0", "limit: joint2 = 2", "singular, limits left out: joint2 = pi"):
        assert words in legend_text(figure)


def test_an_empty_workspace_is_a_picture_still(tmp_path):
    nothing = Workspace(("x", "z"), "base", np.zeros((0, 2)), np.zeros(0), (), ())
    save(workspace_figure(nothing), tmp_path / "empty.svg")


# --- text


def texts(figure):
    """Return every text that is shown, with its box in pixels."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.text import Text

    FigureCanvasAgg(figure).draw()
    shown = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text()]
    ticks = [tick for ax in figure.axes for axis in (ax.xaxis, ax.yaxis) for tick in axis.get_major_ticks()]
    hidden = {label for tick in ticks for label in (tick.label1, tick.label2)}
    for ax in figure.axes:
        for axis in (ax.xaxis, ax.yaxis):
            hidden -= {t.label1 if t.label1.get_visible() else t.label2 for t in axis._update_ticks()}
    return [(t.get_text(), t.get_window_extent()) for t in shown if t not in hidden]


def crowded():
    """Yield pictures with as much text as they get."""
    for source, frame, q in (
        ("textbook:planar_2r", None, (0.5, 1.0)),
        ("textbook:planar_2r", None, (0.5, 0.0)),
        ("example:panda", "panda_hand", "default"),
        ("example:ur5_robot", "tool0", "zero"),
        ("example:tiago", "arm_7_link", "zero"),
        ("example:talos_reduced", "arm_left_7_link", "half_sitting"),
        ("textbook:scara", None, (0.5, 0.9, 0.1, 0.0)),
        ("textbook:helical", None, "zero"),
        ("textbook:wrist_zyz", "link3", "zero"),
    ):
        yield drawn(source, q, frame)[0]
    long = "a_name_that_goes_on_and_on_" * 5
    model = model_of("textbook:scara")
    yield drawn(replace(model, robot=replace(model.robot, name=long)), "zero")[0]
    marks = tuple(Mark(f"a condition of family {i} = 0", 0.15 * i, None, inside=True) for i in range(4))
    marks += tuple(Mark(f"another condition {i} = 0", None, 0.1 * i, inside=False) for i in range(3))
    yield slice_figure(replace(ramp(marks=marks), joints=(long, long)))
    yield slice_figure(ramp(marks=(*marks[:1], Mark("a point", 0.1, 0.1, inside=True))), degrees=True)
    yield workspace_figure(annulus(300, (long, long[1:])))


@pytest.mark.parametrize("index", range(13))
def test_no_text_is_cut_and_none_covers_another(index):
    figure = list(crowded())[index] if index > 8 else next(f for i, f in enumerate(crowded()) if i == index)
    page = figure.bbox
    found = texts(figure)
    assert len(found) > 8
    for text, box in found:
        assert page.x0 <= box.x0, text
        assert box.x1 <= page.x1, text
        assert page.y0 <= box.y0, text
        assert box.y1 <= page.y1, text
    for (one, a), (other, b) in combinations(found, 2):
        apart = a.x1 <= b.x0 or b.x1 <= a.x0 or a.y1 <= b.y0 or b.y1 <= a.y0
        assert apart, (one, other)


def hostile_figures(tmp_path):
    """Yield pictures of robots and results whose every name is hostile."""
    text = (Path(__file__).parents[2] / "robots" / "planar_2r.urdf").read_text()
    name = "&lt;script&gt;$x_{$&lt;/script&gt;"
    for known in ("planar_2r", "base", "tool", "joint1", "joint2", "link1"):
        text = text.replace(f'"{known}"', f'"{name}{known}"')
    (tmp_path / "hostile.urdf").write_text(text)
    yield drawn(ks.load(tmp_path / "hostile.urdf"), (0.3, 0.4))[0]
    model = model_of("textbook:planar_2r")
    yield drawn(replace(model, robot=replace(model.robot, name=HOSTILE)), (0.3, 0.4))[0]
    marks = (Mark(HOSTILE, 0.0, None, inside=True), Mark(HOSTILE, 0.4, 0.2, inside=False))
    yield slice_figure(replace(ramp(marks=marks), joints=(HOSTILE, HOSTILE)))
    yield workspace_figure(replace(annulus(50, (HOSTILE, HOSTILE)), observer=HOSTILE))


@pytest.mark.parametrize("index", range(4))
def test_hostile_names_are_inert_text(tmp_path, index):
    figure = list(hostile_figures(tmp_path))[index]
    for suffix in ("svg", "png", "pdf"):
        save(figure, tmp_path / f"picture.{suffix}")
    content = (tmp_path / "picture.svg").read_text()
    assert "\x1b" not in content
    root = ET.fromstring(content)
    tags = {element.tag.rpartition("}")[2] for element in root.iter()}
    assert "script" not in tags
    assert not any(key.lower().startswith("on") for element in root.iter() for key in element.attrib)
    shown = ["".join(element.itertext()) for element in root.iter("{http://www.w3.org/2000/svg}text")]
    assert any("<script>$x_{$" in words for words in shown)  # as text, dollars and all


def test_names_in_any_script_are_drawn_without_a_warning(tmp_path):
    model = model_of("textbook:planar_2r")
    figure, _ = drawn(replace(model, robot=replace(model.robot, name="机器人")), (0.3, 0.4))
    for suffix in ("svg", "png", "pdf"):
        save(figure, tmp_path / f"picture.{suffix}")
    assert "机器人" in (tmp_path / "picture.svg").read_text(encoding="utf-8")


# --- files


@pytest.mark.parametrize("suffix", ["svg", "png", "pdf"])
def test_the_same_input_gives_the_same_bytes(tmp_path, suffix):
    for make in (lambda: drawn("textbook:scara", "zero")[0], lambda: slice_figure(ramp())):
        written = []
        for i in range(2):
            save(make(), tmp_path / f"{i}.{suffix}")
            written.append((tmp_path / f"{i}.{suffix}").read_bytes())
        assert written[0] == written[1]


def test_svg_text_is_text_and_carries_no_date(tmp_path):
    save(drawn("textbook:planar_2r", (0.3, 0.4))[0], tmp_path / "picture.svg")
    content = (tmp_path / "picture.svg").read_text()
    assert "planar_2r: tool relative to base" in content
    assert "dc:date" not in content
    identifiers = re.findall(r'\bid="([^"]+)"', content)
    assert len(identifiers) == len(set(identifiers))


def test_another_process_and_the_users_own_style_give_the_same_bytes(tmp_path):
    script = (
        "import sys, pathlib, matplotlib; matplotlib.rcParams.update({'font.size': 20, 'axes.facecolor': 'black'});"
        "import kinetostat as ks; from kinetostat.report.figures import manipulability_figure as m, save;"
        "r = ks.load('textbook:planar_2r'); q = ks.configuration(r, [0.3, 0.4]);"
        "save(m(r, ks.manipulability(r, 'tool', q.q), q), pathlib.Path(sys.argv[1]));"
        "assert matplotlib.rcParams['font.size'] == 20; assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", script, str(tmp_path / "other.svg")], check=True, timeout=120)
    save(drawn("textbook:planar_2r", (0.3, 0.4))[0], tmp_path / "here.svg")
    assert (tmp_path / "other.svg").read_bytes() == (tmp_path / "here.svg").read_bytes()


def test_the_users_settings_are_left_alone(tmp_path):
    before = dict(mpl.rcParams)
    save(drawn("textbook:planar_2r", (0.3, 0.4))[0], tmp_path / "picture.png")
    assert dict(mpl.rcParams) == before


def test_importing_the_module_does_not_import_matplotlib():
    script = "import sys, kinetostat.report.figures as f; f.check_suffix; assert 'matplotlib' not in sys.modules"
    subprocess.run([sys.executable, "-c", script], check=True, timeout=60)


@pytest.mark.parametrize("name", ["picture.jpg", "picture", "picture.svg.gz", ".svg"])
def test_another_suffix_is_refused_early_and_late(tmp_path, name):
    figure = slice_figure(ramp())
    for refused in (lambda: check_suffix(Path(name)), lambda: save(figure, tmp_path / name)):
        with pytest.raises(ks.UsageError, match="suffix") as caught:
            refused()
        assert ".svg, .png or .pdf" in caught.value.remedy
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["picture.svg", "picture.PNG", "a.b.pdf"])
def test_known_suffixes_pass(name):
    check_suffix(Path(name))


def test_a_failure_leaves_the_old_file_and_no_draft(tmp_path, monkeypatch):
    place = tmp_path / "picture.svg"
    place.write_text("old")
    figure = slice_figure(ramp())
    monkeypatch.setattr(Path, "replace", lambda *_: (_ for _ in ()).throw(OSError(28, "No space left on device")))
    with pytest.raises(ks.UsageError, match="No space left"):
        save(figure, place)
    assert [path.name for path in tmp_path.iterdir()] == ["picture.svg"]
    assert place.read_text() == "old"


def test_places_that_cannot_be_written_are_refused(tmp_path):
    figure = slice_figure(ramp())
    (tmp_path / "folder.svg").mkdir()
    for place in (tmp_path / "missing" / "picture.svg", tmp_path / "folder.svg"):
        with pytest.raises(ks.UsageError, match="cannot write"):
            save(figure, place)
    assert [path.name for path in tmp_path.iterdir()] == ["folder.svg"]
