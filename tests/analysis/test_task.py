"""Tasks: their spellings, and the length that makes metres and radians comparable, by geometry."""

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.task import FULL, ROTATION, TRANSLATION, Task, characteristic_length, length_scaled
from textbook_support import assert_same, jacobian_of, textbook
from trees import load_text


@pytest.mark.parametrize(
    ("spelled", "rows"),
    [
        ("xyz", (0, 1, 2)),
        ("x y rz", (0, 1, 5)),
        ("x,y,rz", (0, 1, 5)),
        ("x, y,  rz", (0, 1, 5)),
        (" xy rz ", (0, 1, 5)),
        (("x", "y", "rz"), (0, 1, 5)),
        (["rz", "y", "x"], (0, 1, 5)),
        ("rz yx", (0, 1, 5)),
        ("rxyz", (3, 4, 5)),
        ("rx,ry,rz", (3, 4, 5)),
        ("xyz rxyz", (0, 1, 2, 3, 4, 5)),
        ("zz z", (2,)),
        ("rz", (5,)),
    ],
)
def test_spellings_of_a_task(spelled, rows):
    assert Task.named(spelled) == Task("task", rows)


@pytest.mark.parametrize("wrong", ["w", "xyw", "X", "r", "x y rw", "vr", "1", "x;y", "rrz", "-x", "x\ny q"])
def test_what_is_no_axis_is_told(wrong):
    with pytest.raises(ks.UsageError, match=r"no axis.*rx, ry, rz turn"):
        Task.named(wrong)


@pytest.mark.parametrize("empty", ["", "  ", ",", [], ()])
def test_a_task_needs_axes(empty):
    with pytest.raises(ks.UsageError, match="needs axes"):
        Task.named(empty)


def test_a_task_knows_its_rows():
    task = Task.named("ry z x")
    assert task.row_names == ("vx", "vz", "wy")
    assert task.row_units == ("m/s", "m/s", "rad/s")
    assert (task.linear, task.angular, task.mixed) == ((0, 2), (4,), True)
    assert [block.mixed for block in (FULL, TRANSLATION, ROTATION)] == [True, False, False]


# --- the characteristic length ------------------------------------------------------------------------------------


def distances_of_axes(model, tip, q, point=(0, 0, 0)):
    """Return how far each turning joint's axis passes the point, from placements alone; NaN for slides."""
    here = ks.fk(model, tip, q).matrix
    place = here[:3, :3] @ point + here[:3, 3]
    found = []
    for joint in model.robot.movable_path(model.robot.root, tip):
        frame = ks.fk(model, joint.child, q).matrix
        arm, axis = place - frame[:3, 3], frame[:3, :3] @ joint.axis
        found.append(np.linalg.norm(arm - axis * (axis @ arm)) if joint.type.is_angle else np.nan)
    return np.array(found)


@pytest.mark.parametrize(
    ("source", "tip"),
    [
        ("example:ur5_robot", "tool0"),
        ("example:panda", "panda_hand"),
        ("example:so101", "moving_jaw_so101_v1_link"),
        ("textbook:puma560", "tool"),
        ("textbook:planar_3r", "tool"),
        ("textbook:stanford", "tool"),
        ("textbook:scara", "tool"),
        ("textbook:rp", "tool"),
    ],
)
def test_it_is_the_root_mean_square_distance_of_the_turning_axes(source, tip):
    model = ks.load(source)
    tip = tip if tip in model.robot.link_by_name else model.robot.tips[0]
    for i, q in enumerate(ks.random_configurations(model.robot, 1, (5,))):
        point = np.random.default_rng(i).normal(size=3)
        result = ks.manipulability(model, tip, q, length="auto", point=point)
        expected = np.sqrt(np.nanmean(distances_of_axes(model, tip, q, point) ** 2))
        assert_same(result.length, expected)


def test_a_task_weighs_its_own_rows():
    """In its plane the isotropic arm's axes are all r away: over x, y, rz the length is r / sqrt 2, over all rows r."""
    model, q = textbook("isotropic_3r"), np.array([0.7, 2 * np.pi / 3, 5 * np.pi / 6])
    for axes, expected in (("x y rz", 0.5 / np.sqrt(2)), (None, 0.5), ("xyz rxyz", 0.5), ("xyz", 0.5), ("rz", 0.5)):
        assert_same(ks.manipulability(model, "tool", q, length="auto", axes=axes).length, np.array(expected))


def test_turned_axes_leave_the_length_of_all_rows():
    model = textbook("puma560")
    q = ks.random_configurations(model.robot, 2, (6,))
    plain, turned = (ks.manipulability(model, "tool", q, length="auto", reference=r) for r in ("aligned", "local"))
    assert_same(plain.length, turned.length)


def test_with_that_length_linear_and_angular_rows_weigh_the_same():
    matrix = jacobian_of("puma560", "tool", ks.random_configurations(textbook("puma560").robot, 3, (8,)))
    turning = [True] * 6
    for task in (FULL, Task.named("x z ry"), Task.named("y rx rz")):
        scaled = length_scaled(matrix, turning, characteristic_length(matrix, turning, task))
        linear, angular = (np.mean(scaled[:, list(rows)] ** 2, axis=(1, 2)) for rows in (task.linear, task.angular))
        assert_same(linear, angular)


def test_there_is_none_where_nothing_turns_or_every_axis_meets_the_point():
    nothing_turns = np.zeros((6, 2))
    nothing_turns[:2] = np.eye(2)
    assert characteristic_length(nothing_turns, [False, False], FULL) == 0
    wrist = np.vstack([np.zeros((3, 3)), np.eye(3)])
    assert characteristic_length(wrist, [True] * 3, FULL) == 0


def test_scaled_by_a_length_is_told_in_that_unit():
    """Of a slide and a turn: metres per metre, metres per radian, radians per metre, radians per radian."""
    half = 0.5
    matrix = np.arange(1.0, 13).reshape(6, 2)
    scaled = length_scaled(matrix, [False, True], half)
    assert_same(scaled[:3, 0], matrix[:3, 0])
    assert_same(scaled[:3, 1], matrix[:3, 1] * 2)
    assert_same(scaled[3:, 0], matrix[3:, 0] / 2)
    assert_same(scaled[3:, 1], matrix[3:, 1])
    assert np.array_equal(matrix, np.arange(1.0, 13).reshape(6, 2))  # what was given is as it was
    batch = length_scaled(np.stack([matrix, matrix]), [False, True], np.array([half, 1.0]))
    assert_same(batch, np.stack([scaled, matrix]))


@pytest.mark.parametrize("axes", ["x rx", "z rz", "z rx"])
def test_a_task_whose_rows_of_one_kind_are_zero_has_no_length(axes):
    model = textbook("planar_2r")
    with pytest.raises(ks.UsageError, match="no characteristic length"):
        ks.manipulability(model, "tool", np.array([0.3, 0.4]), length="auto", axes=axes)


def test_planar_and_floating_joints_count_with_their_turns():
    """A cart turns about its own centre: a point 2 m from it is that far from the one axis that turns."""
    model = load_text(
        '<robot name="cart"><link name="floor"/><link name="cart"/><joint name="roll" type="planar">'
        '<parent link="floor"/><child link="cart"/><axis xyz="0 0 1"/></joint></robot>'
    )
    q = np.array([1.0, -3, 0.7])
    assert_same(ks.manipulability(model, "cart", q, length="auto", point=(2, 0, 5)).length, np.array(2.0))
    floating = load_text('<robot name="ball"><link name="ball"/></robot>', floating_base=True)
    q = np.array([1.0, 2, 3, 0, 0, 0.6, 0.8])
    result = ks.manipulability(floating, "ball", q, length="auto", point=(1.0, 2.0, 2.0))
    assert_same(result.length, np.sqrt((8 + 5 + 5) / 3))  # from its x, y and z axis: (2, 2), (1, 2), (1, 2)
    assert result.blocks["full"].rank == 6
