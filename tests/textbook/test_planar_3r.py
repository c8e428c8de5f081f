"""Rows A7, A8 and A19, and the isotropic arm: planar arms of three links."""

import numpy as np
import pytest

from textbook_support import (
    angles,
    assert_same,
    jacobian_of,
    matrix_of,
    placement_of,
    planar_tip,
    singular_values,
    vector_of,
)

LENGTHS = np.array([2.0, 1.0, 1.0])
CIRCUMRADIUS = 0.5
SIDES = CIRCUMRADIUS * np.array([np.sqrt(3), np.sqrt(3), 1.0])  # the isotropic arm
TASK = [0, 1, 5]  # vx, vy, wz: what a planar arm can do
GOAL = np.array([0.5, 3.0, 2 * np.pi / 3])


def task_jacobian(q, name="planar_3r"):
    """Return the rows vx, vy, wz; the others are zero."""
    matrix = jacobian_of(name, "tool", q)
    assert np.all(matrix[..., [2, 3, 4], :] == 0)
    return matrix[..., TASK, :]


def pose(q):
    """Return x, y and the angle of the tool."""
    placement = placement_of("planar_3r", "tool", q)
    return vector_of(placement[..., 0, 3], placement[..., 1, 3], np.arctan2(placement[..., 1, 0], placement[..., 0, 0]))


# --- A7 ---------------------------------------------------------------------------------------------------------


def a7(q):
    """Return the rows vx, vy, wz: joint i moves the tip across its distance from joint i."""
    heading = np.cumsum(q, -1)
    x = np.cumsum((LENGTHS * np.cos(heading))[..., ::-1], -1)[..., ::-1]
    y = np.cumsum((LENGTHS * np.sin(heading))[..., ::-1], -1)[..., ::-1]
    return np.stack([-y, x, np.ones_like(x)], -2)


def test_a7_jacobian():
    q = angles(3, seed=71)
    assert_same(task_jacobian(q), a7(q), atol=4e-12)


def test_a7_stretched_out_the_linear_rank_is_one():
    matrix = task_jacobian([0, 0, 0])
    assert_same(matrix, np.array([[0, 0, 0], [4, 2, 1], [1, 1, 1.0]]))
    assert np.linalg.matrix_rank(matrix[:2]) == 1


def test_a7_with_the_elbow_at_a_right_angle():
    matrix = task_jacobian([0, np.pi / 2, 0])
    assert_same(matrix, np.array([[-2, -2, -1], [2, 0, 0], [1, 1, 1.0]]))
    assert np.linalg.matrix_rank(matrix[:2]) == 2


@pytest.mark.parametrize(("elbow", "moved"), [(0.0, (0.0, 0.2)), (np.pi / 2, (-0.2, 0.0))])
def test_a7_tool_error_from_an_error_at_the_elbow(elbow, moved):
    q, error = np.array([0, elbow, 0]), np.array([0, 0.1, 0])
    assert_same(task_jacobian(q) @ error, np.array([*moved, 0.1]))
    # The arm behind the elbow is 2 m long: to second order it also draws the tip in, by half of 2 x 0.1 x 0.1.
    exact = pose(q + error)[:2] - pose(q)[:2]
    assert 0.0099 < np.linalg.norm(exact - moved) < 0.01


@pytest.mark.parametrize(("name", "lengths"), [("planar_3r", LENGTHS), ("isotropic_3r", SIDES)])
def test_a7_tip(name, lengths):
    q = angles(3, seed=72)
    assert_same(placement_of(name, "tool", q), planar_tip(lengths, q), atol=4e-12)


# --- A8 ---------------------------------------------------------------------------------------------------------


def newton_raphson(q, count):
    """Return the steps h = J^-1 (pose - goal) and the iterates q - h."""
    steps, iterates = [], []
    for _ in range(count):
        steps.append(np.linalg.solve(task_jacobian(q), pose(q) - GOAL))
        q = q - steps[-1]
        iterates.append(q)
    return np.array(steps), np.array(iterates)


def closed_form_limit():
    """Return the solution with the elbow to the right: two links to the wrist at (1, 3 - sqrt(3)/2), then the tool."""
    x, y = 1.0, 3 - np.sqrt(3) / 2
    elbow = np.arccos((x**2 + y**2 - 5) / 4)
    waist = np.arctan2(y, x) - np.arctan2(np.sin(elbow), 2 + np.cos(elbow))
    return np.array([waist, elbow, 2 * np.pi / 3 - waist - elbow])


START = np.array([np.pi / 3, np.pi / 6, np.pi / 6])


def test_a8_the_start_is_straight_above_the_goal():
    assert_same(pose(START), np.array([0.5, 1 + 1.5 * np.sqrt(3), 2 * np.pi / 3]))


def test_a8_first_step():
    """By hand: three linear equations with the Jacobian of A7 give h = (1.5 sqrt(3) - 2)(1, -1 - sqrt(3), sqrt(3))."""
    root = np.sqrt(3)
    steps, _ = newton_raphson(START, 1)
    assert_same(steps[0], (1.5 * root - 2) * np.array([1, -1 - root, root]))
    assert_same(steps[0], np.array([0.598076, -1.633975, 1.035898]), atol=6e-7)  # as printed


def test_a8_iterates():
    _, iterates = newton_raphson(START, 3)
    printed = [[0.449121, 2.157573, -0.512300], [0.650171, 1.498961, -0.054737], [0.698674, 1.434467, -0.038746]]
    assert_same(iterates, np.array(printed), atol=6e-7)


SLIPPED = np.array([0.6097, 1.6083, -0.1236])  # the second iterate of a printed table, whose hand arithmetic slipped


@pytest.mark.parametrize("start", [START, SLIPPED])
def test_a8_limit(start):
    _, iterates = newton_raphson(start, 8)
    assert_same(iterates[-1], closed_form_limit())
    assert_same(pose(iterates[-1]), GOAL)
    assert_same(iterates[-1], np.array([0.6988632, 1.4318882, -0.0363562]), atol=1e-7)  # as printed


def test_a8_the_slipped_table_is_not_what_newton_raphson_gives():
    _, iterates = newton_raphson(START, 2)
    assert np.max(np.abs(iterates[1] - SLIPPED)) > 0.04


def test_a8_converges_quadratically():
    _, iterates = newton_raphson(START, 6)
    error = np.linalg.norm(iterates - closed_form_limit(), axis=-1)
    assert error[3] < 4e-6
    assert error[4] < 4e-12
    # Each error is at most 3 times the square of the one before it.
    assert np.all(error[2:5] < 3 * error[1:4] ** 2)


# --- A19 --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("frame", "moved"), [("base", 0), ("link1", 1), ("link2", 2), ("link3", 3)])
@pytest.mark.parametrize("point", [(0, 0, 0), (0.3, -0.2, 0.7)])
def test_a19_joints_beyond_a_link_do_not_move_its_points(frame, moved, point):
    q = angles(3, seed=19, count=10)
    whole = jacobian_of("planar_3r", frame, q, point=point, joints="all")
    assert whole.shape == (len(q), 6, 3)
    assert np.all(whole[..., moved:] == 0)
    assert np.all(whole[..., 5, :moved] == 1)
    assert_same(jacobian_of("planar_3r", frame, q, point=point), whole[..., :moved], atol=0)


def test_a19_the_end_of_the_first_two_links_moves_as_a_two_link_arm():
    q = angles(3, seed=20)
    first, both = q[:, 0], q[:, 0] + q[:, 1]
    expected = matrix_of(
        [
            [-2 * np.sin(first) - np.sin(both), -np.sin(both), 0],
            [2 * np.cos(first) + np.cos(both), np.cos(both), 0],
            [1, 1, 0],
        ]
    )
    assert_same(jacobian_of("planar_3r", "link2", q, point=(1, 0, 0), joints="all")[:, TASK], expected, atol=4e-12)


def test_a19_puma_links_move_with_the_joints_before_them():
    q = angles(6, seed=21, count=8)
    for link in range(1, 7):
        whole = jacobian_of("puma560", f"link{link}", q, point=(0.1, 0.2, 0.3), joints="all")
        assert np.all(whole[..., link:] == 0)
        assert_same(np.linalg.norm(whole[..., 3:, :link], axis=-2), np.ones((8, link)))


# --- the isotropic arm ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("waist", [0.0, 1.0, -2.5])
@pytest.mark.parametrize("side", [1, -1])
def test_isotropic_3r_has_three_equal_singular_values(waist, side):
    matrix = task_jacobian([waist, side * 2 * np.pi / 3, side * 5 * np.pi / 6], "isotropic_3r")
    matrix[:2] /= CIRCUMRADIUS / np.sqrt(2)  # the length unit
    assert_same(singular_values(matrix), np.full(3, np.sqrt(3)))


def test_isotropic_3r_joints_are_on_an_equilateral_triangle_about_the_tool():
    q = [0.3, 2 * np.pi / 3, 5 * np.pi / 6]
    tool = placement_of("isotropic_3r", "tool", q)[:2, 3]
    joints = np.array([placement_of("isotropic_3r", f"link{i}", q)[:2, 3] for i in (1, 2, 3)])
    assert_same(joints.mean(0), tool)
    assert_same(np.linalg.norm(joints - tool, axis=1), np.full(3, CIRCUMRADIUS))
    assert_same(np.linalg.norm(joints - np.roll(joints, 1, 0), axis=1), np.full(3, np.sqrt(3) * CIRCUMRADIUS))


def test_isotropic_3r_in_another_length_unit_is_not_isotropic():
    matrix = task_jacobian([0.3, 2 * np.pi / 3, 5 * np.pi / 6], "isotropic_3r")
    expected = [np.sqrt(3), CIRCUMRADIUS * np.sqrt(1.5), CIRCUMRADIUS * np.sqrt(1.5)]
    assert_same(singular_values(matrix), np.array(expected))
