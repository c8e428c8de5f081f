"""The Modern Robotics block of theory B: four helical joints, angular rows first."""

import numpy as np

import kinetostat as ks
from textbook_support import assert_same, jacobian_of, placement_of, turn_about

NAME = "modern_robotics_hhhh"
ANGULAR_FIRST = ks.Order.ANGULAR_FIRST.rows
SCREWS = np.array([[0, 0, 1, 0, 0.2, 0.2], [1, 0, 0, 2, 0, 3], [0, 1, 0, 0, 2, 1], [1, 0, 0, 0.2, 0.3, 0.4]]).T
ANGLES = np.array([0.2, 1.1, 0.1, 1.2])
SPACE = np.array(
    [
        [0, 0.98006658, -0.09011564, 0.95749426],
        [0, 0.19866933, 0.4445544, 0.28487557],
        [1, 0, 0.89120736, -0.04528405],
        [0, 1.95218638, -2.21635216, -0.51161537],
        [0.2, 0.43654132, -2.43712573, 2.77535713],
        [0.2, 2.96026613, 3.23573065, 2.22512443],
    ]
)
# JacobianBody of the same screws, from the docstring beside it.
BODY = np.array(
    [
        [-0.04528405, 0.99500417, 0, 1],
        [0.74359313, 0.09304865, 0.36235775, 0],
        [-0.66709716, 0.03617541, -0.93203909, 0],
        [2.32586047, 1.66809, 0.56410831, 0.2],
        [-1.44321167, 2.94561275, 1.43306521, 0.3],
        [-2.06639565, 1.82881722, -1.58868628, 0.4],
    ]
)
DIGITS = 6e-9  # eight printed decimals


def angular_first(q, **asked):
    return jacobian_of(NAME, "tool", q, **asked)[..., ANGULAR_FIRST, :]


def test_modern_robotics_screws_are_the_columns_at_zero():
    assert_same(angular_first(np.zeros(4), reference="world"), SCREWS)


def test_modern_robotics_tool_is_at_the_base_at_zero_so_that_body_screws_are_the_same():
    assert_same(placement_of(NAME, "tool", np.zeros(4)), np.eye(4))
    assert_same(angular_first(np.zeros(4), reference="local"), SCREWS)


def test_modern_robotics_space_jacobian():
    assert_same(angular_first(ANGLES, reference="world"), SPACE, atol=DIGITS)


def test_modern_robotics_body_jacobian():
    assert_same(angular_first(ANGLES, reference="local"), BODY, atol=DIGITS)


def test_modern_robotics_first_column_does_not_move():
    q = np.random.default_rng(4).uniform(-2, 2, (10, 4))
    assert_same(angular_first(q, reference="world")[..., 0], np.broadcast_to(SCREWS[:, 0], (10, 6)), atol=1e-11)
    assert_same(angular_first(q, reference="local")[..., 3], np.broadcast_to(SCREWS[:, 3], (10, 6)), atol=1e-10)


def test_modern_robotics_pitches_are_those_of_the_screws():
    """The pitch v . w of a screw is the same in every frame; none of the four is zero."""
    q = np.random.default_rng(5).uniform(-2, 2, (10, 4))
    for reference in ("world", "aligned", "local"):
        columns = angular_first(q, reference=reference)
        pitches = np.einsum("nij,nij->nj", columns[:, :3], columns[:, 3:])
        assert_same(pitches, np.broadcast_to([0.2, 2, 2, 0.2], (10, 4)), atol=1e-10)


def test_modern_robotics_second_screw_is_carried_by_the_first_joint():
    """By hand: joint 1 turns by q1 about z through (-0.2, 0, 0) and lifts by 0.2 q1."""
    q1 = 0.9
    rotation = turn_about([0, 0, 1.0], q1)
    pivot = np.array([-0.2, 0, 0])
    axis = rotation @ [1, 0, 0]
    through = pivot + rotation @ (np.array([0, -3, 0]) - pivot) + [0, 0, 0.2 * q1]
    column = angular_first([q1, 0.4, -0.3, 0.8], reference="world")[:, 1]
    assert_same(column, np.r_[axis, 2 * axis + np.cross(through, axis)], atol=1e-11)
