"""A limb at several poses: each ellipsoid is that of its Jacobian, all are to one scale, nothing is cut."""

import re
from functools import cache

import numpy as np
import pytest

import kinetostat as ks
from figure_texts import cut_texts, texts
from kinetostat.report.figures.embedding import embedded
from kinetostat.report.figures.poses import MOST_POSES, ellipses_figure, poses_figure
from limb_profiles import limb_of, pose_of, profile_of
from trees import load_text, random_tree


@cache
def model_of(source):
    return ks.load(source)


def labelled(ax, label):
    return [artist for artist in (*ax.patches, *ax.lines) if artist.get_label() == label]


def legend_text(figure):
    return "\n".join(text.get_text() for legend in figure.legends for text in legend.get_texts())


def stated_scale(figure, name):
    """Return the metres per unit that the legend states."""
    return float(re.search(rf"{name} ellipsoid.*: 1 ?\S* drawn as (\S+) m", legend_text(figure))[1])


def inches_per_metre(figure):
    """Return the scale of each panel, across and up."""
    size = figure.get_size_inches()
    spans = [(np.ptp(ax.get_xlim()), np.ptp(ax.get_ylim())) for ax in figure.axes]
    return [ax.get_position().size * size / span for ax, span in zip(figure.axes, spans, strict=True)]


def semi_axes(l1, l2, q2):
    """Return the semi-axes of the 2R arm's ellipse of velocity, of the eigenvalues of J^T J; theory A6."""
    c2 = np.cos(q2)
    trace = (l1**2 + l2**2 + 2 * l1 * l2 * c2) + l2**2
    root = np.sqrt(trace**2 / 4 - (l1 * l2 * np.sin(q2)) ** 2)
    return np.sqrt([trace / 2 + root, max(trace / 2 - root, 0)])


def planar_profile(poses):
    model = model_of("textbook:planar_2r")
    return model, profile_of(model, limb_of(model.robot, "tool"), poses)


# --- poses


def test_each_pose_has_the_ellipses_of_its_jacobian():
    poses = {"a": (0.3, 1.0), "b": (-1.0, 2.0), "c": (0.0, -1.4)}
    figure = poses_figure(*planar_profile(poses))
    for ax, q in zip(figure.axes, poses.values(), strict=True):
        lengths = semi_axes(1.0, 0.8, q[1])
        for name, expected in (("velocity", lengths), ("force", 1 / lengths[::-1])):
            (ellipse,) = labelled(ax, name)
            drawn = np.array([ellipse.width, ellipse.height]) / 2
            assert np.allclose(drawn, stated_scale(figure, name) * expected, rtol=1e-9)
            tip = [np.cos(q[0]) + 0.8 * np.cos(sum(q)), np.sin(q[0]) + 0.8 * np.sin(sum(q))]
            assert np.allclose(ellipse.get_center(), tip, atol=1e-12)


@pytest.mark.parametrize("count", range(1, MOST_POSES + 1))
def test_all_panels_have_one_scale(count):
    figure = poses_figure(*planar_profile({f"p{i}": (0.4 * i, 0.3 + 0.4 * i) for i in range(count)}))
    scales = np.array(inches_per_metre(figure))
    assert len(scales) == count
    assert np.allclose(scales, scales[0, 0])
    (bar,) = labelled(figure.axes[0], "scale")
    words = next(text for text, _ in texts(figure) if re.fullmatch(r"[\d.]+ m", text))
    assert np.isclose(np.ptp(bar.get_xdata()), float(words.removesuffix(" m")))


def test_a_singular_pose_has_a_line_of_velocity_and_a_force_without_bound():
    figure = poses_figure(*planar_profile({"out": (0.5, 0.0), "bent": (0.5, 1.0)}))
    straight, bent = figure.axes
    assert labelled(straight, "force without bound")
    assert not labelled(bent, "force without bound")
    (line,) = labelled(straight, "velocity")
    along = np.diff(line.get_xydata(), axis=0)[0]
    assert abs(along @ [np.cos(0.5), np.sin(0.5)]) < 1e-9 * np.linalg.norm(along)
    assert np.isclose(np.linalg.norm(along) / 2, stated_scale(figure, "velocity") * semi_axes(1, 0.8, 0)[0])
    assert any("singular: rank 1 of 2" in text for text, _ in texts(figure))


def test_forces_that_differ_much_have_scales_of_their_own_which_are_told():
    figure = poses_figure(*planar_profile({"near": (0.0, 0.001), "bent": (0.0, 1.5)}))
    assert "own scale" in legend_text(figure)
    told = [re.search(r"force: 1 N/Nm as (\S+) m", text) for text, _ in texts(figure)]
    scales = [float(found[1]) for found in told if found]
    for ax, scale, q2 in zip(figure.axes, scales, (0.001, 1.5), strict=True):
        (ellipse,) = labelled(ax, "force")
        assert np.isclose(ellipse.width / 2, scale / semi_axes(1, 0.8, q2)[1], rtol=1e-6)
        assert ellipse.width / 2 < 1.8  # beside an arm of that length


def test_a_pose_outside_limits_is_marked_and_only_that():
    model = model_of("textbook:planar_2r")
    limb = limb_of(model.robot, "tool")
    poses = {"in": pose_of(model, limb, "in", (0.1, 0.2)), "out": pose_of(model, limb, "out", (0.1, 0.9), inside=False)}
    figure = poses_figure(model, profile_of(model, limb, poses))
    assert sum("outside limits" in text for text, _ in texts(figure)) == 1
    lines = [ax.spines["top"].get_linestyle() for ax in figure.axes]
    assert lines[0] in ("-", "solid")
    assert lines[1] not in ("-", "solid")


def test_more_poses_than_six_are_said_and_none_is_a_picture_too():
    figure = poses_figure(*planar_profile({f"p{i}": (0.1, 0.2 + 0.1 * i) for i in range(9)}))
    assert len(figure.axes) == MOST_POSES
    assert "the first 6 of 9" in [text for text, _ in texts(figure)]
    assert any("no pose" in text for text, _ in texts(poses_figure(*planar_profile({}))))


@pytest.mark.parametrize("seed", range(12))
def test_any_robot_has_a_picture(seed):
    model = random_tree(seed)
    robot = model.robot
    for frame in [tip for tip in robot.tips if robot.movable_path(robot.root, tip)][:2]:
        limb = limb_of(robot, frame)
        figure = poses_figure(model, profile_of(model, limb, {"zero": "zero", "mid": "mid", "some": "random:1"}))
        assert len(figure.axes) == 3
        assert not cut_texts(figure, slack=4)
        embedded(figure, "x")


@pytest.mark.parametrize(("source", "frame"), [
    ("example:panda", "panda_link8"),
    ("example:talos_full_v2", "left_sole_link"),
    ("textbook:planar_1r", "tool"),
    ("textbook:scara", "tool"),
    ("textbook:skew_1p", "tool"),
])  # fmt: skip
def test_nothing_is_cut_on_real_robots_and_the_page_gets_few_bytes(source, frame):
    model = model_of(source)
    poses = {f"a_pose_with_a_long_name_{i}": f"random:{i}" for i in range(5)} | {"zero": "zero"}
    figure = poses_figure(model, profile_of(model, limb_of(model.robot, frame), poses))
    assert not cut_texts(figure)
    assert len(embedded(figure, "x")) < 40_000


def test_a_robot_of_one_point_has_a_picture():
    text = (
        '<robot name="point"><link name="a"/><link name="b"/><joint name="j" type="continuous">'
        '<parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>'
    )
    model = load_text(text)
    figure = poses_figure(model, profile_of(model, limb_of(model.robot, "b"), {"zero": "zero"}))
    assert "nowhere of a size" in legend_text(figure)
    embedded(figure, "x")


# --- ellipses; theory A6


def drawn_axes(source, configurations):
    """Return the semi-axes (m, 2) in m/rad of the ellipses that are drawn."""
    figure = ellipses_figure(model_of(source), "tool", np.array(configurations))
    (ax,) = figure.axes
    found = [(patch.width / 2, patch.height / 2) for patch in labelled(ax, "velocity")]
    return np.array(found) / stated_scale(figure, "velocity"), figure


def test_ellipses_along_a_radius_are_those_of_theory():
    bends = np.linspace(0.2, 2.9, 7)
    axes, figure = drawn_axes("textbook:planar_2r", [(-bend / 2, bend) for bend in bends])
    assert np.allclose(axes, [semi_axes(1.0, 0.8, bend) for bend in bends], rtol=1e-9)
    assert len(labelled(figure.axes[0], "arm")) == 7
    assert not cut_texts(figure)


def test_an_ellipse_is_the_same_whichever_way_the_arm_points():
    axes, _ = drawn_axes("textbook:planar_2r", [(turn, 1.1) for turn in np.linspace(-3, 3, 9)])
    assert np.allclose(axes, axes[0], rtol=1e-12)


def test_the_isotropic_arm_has_a_circle_at_135_degrees():
    robot = model_of("textbook:planar_2r_isotropic").robot
    first, second = (joint.origin.length for joint in robot.joints if joint.origin.length > 0)
    assert np.isclose(first, np.sqrt(2) * second)
    axes, _ = drawn_axes("textbook:planar_2r_isotropic", [(turn, np.radians(135)) for turn in (0.0, 1.0, -2.0)])
    assert np.allclose(axes, second, rtol=1e-9)
    other, _ = drawn_axes("textbook:planar_2r_isotropic", [(0.0, np.radians(130))])
    assert other[0, 0] > 1.05 * other[0, 1]
