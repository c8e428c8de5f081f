"""A limb at several poses: each ellipsoid is that of its Jacobian, all are to one scale, nothing is cut."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import kinetostat as ks
from figure_texts import cut_texts, texts
from kinetostat.analysis.crosscheck import Certificate
from kinetostat.analysis.level_axes import level_axis
from kinetostat.analysis.profile.section import Section
from kinetostat.analysis.skeleton import skeleton
from kinetostat.report.figures.embedding import embedded
from kinetostat.report.figures.names import told_apart
from kinetostat.report.figures.poses import MOST_POSES, ellipses_figure, poses_figure
from kinetostat.report.figures.views import axis_titles, view_of_all
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
    limb = limb_of(model.robot, "tool")
    return model, profile_of(model, limb, {name: pose_of(model, limb, name, q, "x y") for name, q in poses.items()})


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
    said = [text for text, _ in texts(figure)]
    assert said.count("singular") == 1
    assert "s/s1 0, rank 1 of 2" in said


def test_forces_that_differ_much_have_scales_of_their_own_which_are_told():
    figure = poses_figure(*planar_profile({"near": (0.0, 0.05), "bent": (0.0, 1.5)}))
    assert "own scale" in legend_text(figure)
    told = [re.search(r"force: 1 N/Nm as (\S+) m", text) for text, _ in texts(figure)]
    scales = [float(found[1]) for found in told if found]
    for ax, scale, q2 in zip(figure.axes, scales, (0.05, 1.5), strict=True):
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
        assert 1 <= len(figure.axes) <= 3
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
    assert "ellipsoid" not in legend_text(figure)
    embedded(figure, "x")


# --- numbers above a panel


@pytest.mark.parametrize(("axes", "rank", "state"), [("x y", "rank 1 of 2", True), ("x y rz", "rank 2 of 3", False)])
def test_numbers_are_the_poses_own_of_the_rows_that_count(axes, rank, state):
    model = model_of("textbook:planar_2r")
    limb = limb_of(model.robot, "tool")
    pose = pose_of(model, limb, "straight", (0.4, 0.0), axes)
    values = {"yoshikawa": 0.123, "minimum_singular_value": 4.5e-13, "inverse_condition_number": 0.0678}
    said = [text for text, _ in texts(poses_figure(model, profile_of(model, limb, {"": replace(pose, values=values)})))]
    assert "w 0.123, s 0" in said  # what is below 1e-12 is rounding
    assert f"s/s1 0.0678, {rank}" in said
    assert ("singular" in said) is state
    assert any(f"rows {' '.join(pose.manipulability.blocks['task'].task.row_names)}" in text for text in said)


def test_the_unit_is_that_of_the_limbs_sweep():
    model = model_of("textbook:planar_2r")
    limb = limb_of(model.robot, "tool")
    profile = profile_of(model, limb, {"": pose_of(model, limb, "bent", (0.4, 0.5), "x y")}, samples=50, axes="x y")
    for unit, words in (("m/rad", ", in m/rad"), ("1", "rows vx vy"), ("mixed", "metres and radians mixed")):
        one = profile.sweep.measures["minimum_singular_value"]
        column = replace(one.column, unit=unit)
        sweep = replace(profile.sweep, measures={"minimum_singular_value": replace(one, column=column)})
        said = [text for text, _ in texts(poses_figure(model, replace(profile, sweep=sweep)))]
        assert any(text.startswith("w ") and text.endswith(words) for text in said)


def test_a_limb_that_only_turns_its_tool_is_a_stick_without_ellipsoids():
    model = model_of("example:talos_reduced")
    limb = limb_of(model.robot, "head_2_link", "torso_2_link")
    figure = poses_figure(model, profile_of(model, limb, {"zero": "zero", "bent": "random:1"}))
    for ax in figure.axes:
        assert labelled(ax, "arm")
        assert not ax.patches
        assert not any("without bound" in str(artist.get_label()) for artist in (*ax.patches, *ax.lines))
    assert any("it only turns" in text for text, _ in texts(figure))


def test_ellipsoids_that_would_mix_metres_and_radians_are_not_drawn():
    model = model_of("textbook:rp")
    figure = poses_figure(model, profile_of(model, limb_of(model.robot, "tool"), {"some": "random:1"}))
    assert not figure.axes[0].patches
    assert any("metres and radians would mix" in text for text, _ in texts(figure))


def test_a_force_a_hundred_times_another_has_no_end_in_the_picture():
    near, far = poses_figure(*planar_profile({"near": (0.0, 0.005), "far": (0.0, 0.05)})).axes
    assert labelled(near, "force without bound")
    assert not labelled(far, "force without bound")


# --- panels


def test_poses_that_look_and_measure_the_same_are_one_panel_with_all_names():
    poses = {"zero": (0.0, 0.7), "home": (0.0, 0.7), "other": (0.0, 0.9)}
    figure = poses_figure(*planar_profile(poses))
    said = [text for text, _ in texts(figure)]
    assert len(figure.axes) == 2
    assert {"zero", "= home", "other"} < set(said)


def test_poses_that_only_look_the_same_are_not_called_equal():
    model = model_of("textbook:planar_2r")
    limb = limb_of(model.robot, "tool")
    names = {f"p{i}": pose_of(model, limb, f"p{i}", (0.0, 0.7 + 1e-5 * i), "x y") for i in range(5)}
    said = [text for text, _ in texts(poses_figure(model, profile_of(model, limb, names)))]
    assert {"p0", "and p1", "and 2 more"} < set(said)
    assert "and p4" not in said


def test_four_poses_leave_no_lonely_panel_and_each_fits_what_it_shows():
    figure = poses_figure(*planar_profile({f"p{i}": (1.5 * i, 1.0) for i in range(4)}))
    lows = sorted(round(ax.get_position().y0, 6) for ax in figure.axes)
    assert [lows.count(low) for low in set(lows)] in ([4], [2, 2])
    for ax in figure.axes:  # the arm and its ellipses are in the middle of the panel
        patches = [patch.get_window_extent() for patch in ax.patches]
        ends = [ax.transData.transform(line.get_xydata()) for line in labelled(ax, "arm")]
        low = min([box.x0 for box in patches] + [points[:, 0].min() for points in ends])
        high = max([box.x1 for box in patches] + [points[:, 0].max() for points in ends])
        middle = (low + high) / 2
        assert abs(middle - ax.bbox.x0 - ax.bbox.width / 2) < 0.06 * ax.bbox.width


def test_a_joint_that_slides_is_drawn_along_its_rail():
    text = (
        '<robot name="gantry"><link name="a"/><link name="b"/><link name="c"/>'
        '<joint name="x" type="prismatic"><origin xyz="0 0 2"/><parent link="a"/><child link="b"/><axis xyz="1 0 0"/>'
        '<limit lower="0" upper="3" effort="1" velocity="1"/></joint>'
        '<joint name="z" type="prismatic"><origin xyz="0 0 -0.5"/><parent link="b"/><child link="c"/>'
        '<axis xyz="0 0 -1"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint></robot>'
    )
    model = load_text(text)
    figure = poses_figure(model, profile_of(model, limb_of(model.robot, "c"), {"out": (1.5, 0.25)}))
    (arm,) = labelled(figure.axes[0], "arm")
    steps = np.diff(arm.get_xydata(), axis=0)
    assert np.allclose(np.abs(steps).min(axis=1), 0)  # upright or level, none aslant
    assert np.allclose(np.abs(steps).sum(axis=0), [1.5, 2 + 0.75])


# --- from which side


def view_of(model, profile):
    """Return the words that say what is to the right and what is up."""
    said = " ".join(text for text, _ in texts(poses_figure(model, profile)))
    return re.search(r"named poses (.*?) to the right, (.*?) upwards", said).groups()


@pytest.mark.parametrize(("source", "frame", "base", "expected"), [
    ("example:ur5_robot", "tool0", None, ("x", "z")),
    ("example:go1", "FL_foot", "trunk", ("x", "z")),
    ("example:talos_full_v2", "left_sole_link", "base_link", ("x", "z")),
    ("example:panda", "panda_link8", None, ("x", "z")),
    ("example:baxter", "left_gripper_base_link", "torso", ("across (45° from x)", "z")),
    ("textbook:scara", "tool", None, ("x", "y")),
    ("textbook:planar_2r", "tool", None, ("x", "y")),
])  # fmt: skip
def test_an_arm_is_seen_along_the_axis_that_most_of_its_joints_share(source, frame, base, expected):
    model = model_of(source)
    assert view_of(model, profile_of(model, limb_of(model.robot, frame, base), {"zero": "zero"})) == expected


def test_the_plane_is_that_of_the_map_of_the_reach():
    model = model_of("textbook:anthropomorphic")
    profile = profile_of(model, limb_of(model.robot, "tool"), {"zero": "zero"})
    turn = np.radians(30)
    across = np.array([[np.cos(turn), np.sin(turn), 0], [0, 0, 1]])
    empty = np.zeros((1, 1))
    proof, arm = Certificate(("pinocchio", "screw"), 0.0, 1e-12), np.zeros((1, 2))
    section = Section("side", across, ("a", "b"), empty[0], "mid", np.zeros((1, 1, 2)), empty, (), (), arm, proof)
    assert view_of(model, replace(profile, sections=(section,))) == ("across (30° from x)", "z")


@pytest.mark.parametrize("seed", range(8))
def test_any_view_is_level_or_from_above_with_height_upwards(seed):
    model = random_tree(seed)
    robot = model.robot
    up = np.random.default_rng(seed).normal(size=3)
    up /= np.linalg.norm(up)
    frame = robot.tips[-1]
    arms = [skeleton(model, frame, ks.configuration(model, f"random:{i}").q) for i in range(3)]
    view = view_of_all(arms, up)
    assert np.allclose(view @ view.T, np.eye(2), atol=1e-9)
    assert view[1] @ up > -1e-9
    if arms[0].normal is None:
        assert min(abs(np.cross(*view) @ up), abs(1 - np.cross(*view) @ up)) < 1e-9


@pytest.mark.parametrize(("direction", "upright", "expected"), [
    ((1, 0, 0), (0, 0, 1), ("x", "z")),
    ((0, -1, 0), (0, 0, 1), ("-y", "z")),
    ((np.cos(0.4), -np.sin(0.4), 0), (0, 0, 1), ("across (23° from x)", "z")),
    ((1, 0, 0), (0, np.sin(0.3), np.cos(0.3)), ("x", "height")),
])  # fmt: skip
def test_directions_in_words(direction, upright, expected):
    assert axis_titles(np.array([direction, upright]), np.array(upright)) == expected


@pytest.mark.parametrize(("degrees", "tilt", "taken"), [(8, 0, True), (-8, 0.02, True), (12, 0, False), (45, 0, False)])
def test_a_level_direction_near_an_axis_becomes_that_axis_made_level(degrees, tilt, taken):
    up = np.array([np.sin(tilt), 0, np.cos(tilt)])
    x, y = np.array([np.cos(tilt), 0, -np.sin(tilt)]), np.array([0.0, 1, 0])
    direction = np.cos(np.radians(degrees)) * x + np.sin(np.radians(degrees)) * y
    assert np.allclose(level_axis(direction, up), x if taken else direction, atol=1e-12)


def test_an_axis_within_ten_degrees_is_taken():
    text = (
        '<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>'
        '<joint name="pan" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>'
        '<joint name="j" type="continuous"><origin xyz="0 0 1" rpy="0 0 {yaw}"/>'
        '<parent link="b"/><child link="c"/><axis xyz="0 1 0"/></joint>'
        '<joint name="k" type="continuous"><origin xyz="1 0 0"/>'
        '<parent link="c"/><child link="d"/><axis xyz="0 1 0"/></joint></robot>'
    )
    found = []
    for yaw in (0.15, 0.3):
        model = load_text(text.format(yaw=yaw))
        found.append(view_of(model, profile_of(model, limb_of(model.robot, "d"), {"zero": "zero"})))
    assert found == [("x", "z"), ("across (17° from x)", "z")]


# --- names


def test_names_that_begin_alike_keep_their_ends():
    names = ["standing_with_arm_up_left", "standing_with_arm_up_right", "a_name_of_its_own_that_is_long", "short"]
    shown = told_apart(names, 16)
    assert len(set(shown)) == 4
    assert all(len(name) <= 16 for name in shown)
    assert shown[0].endswith("left")
    assert shown[1].endswith("right")
    assert shown[2].startswith("a_name_of_its")
    assert shown[3] == "short"
    assert told_apart(["standing_with_arm_up", "standing_with_arm_home"], 20)[1].endswith("home")


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
