"""Rows A9 and A10: wrists, three axes through one point."""

import numpy as np
import pytest

from textbook_support import (
    angles,
    assert_same,
    jacobian_of,
    matrix_of,
    placement_of,
    shifted,
    turn_about,
    turned,
    vector_of,
)


def linear_from(axes, length):
    """Return the linear rows of a tool that is some way along the third axis."""
    return length * np.cross(np.swapaxes(axes, -1, -2), axes[..., None, :, 2]).swapaxes(-1, -2)


# --- A9 ---------------------------------------------------------------------------------------------------------


def zyz_axes(q):
    s1, c1, s2, c2 = np.sin(q[..., 0]), np.cos(q[..., 0]), np.sin(q[..., 1]), np.cos(q[..., 1])
    return matrix_of([[0, -s1, c1 * s2], [0, c1, s1 * s2], [1, 0, c2]])


def test_a9_angular_columns_are_the_axes():
    q = angles(3, seed=91)
    matrix = jacobian_of("wrist_zyz", "tool", q)
    assert_same(matrix[:, 3:], zyz_axes(q))
    assert_same(matrix[:, :3], linear_from(zyz_axes(q), 0.12))


def test_a9_tool():
    for q in angles(3, seed=95):
        expected = turned(("z", q[0]), ("y", q[1]), ("z", q[2])) @ shifted(0, 0, 0.12)
        assert_same(placement_of("wrist_zyz", "tool", q), expected)


def test_a9_the_wrist_point_does_not_move():
    q = angles(3, seed=92)
    assert_same(jacobian_of("wrist_zyz", "link3", q)[:, :3], np.zeros((len(q), 3, 3)))
    assert_same(jacobian_of("wrist_zyz", "tool", q, point=(0, 0, -0.12))[:, :3], np.zeros((len(q), 3, 3)))


def test_a9_determinant_is_minus_the_sine_of_the_second_angle():
    q = angles(3, seed=93)
    assert_same(np.linalg.det(jacobian_of("wrist_zyz", "tool", q)[:, 3:]), -np.sin(q[:, 1]))


@pytest.mark.parametrize("second", [0.0, np.pi, -np.pi])
def test_a9_singular_where_the_first_and_last_axes_are_collinear(second):
    axes = jacobian_of("wrist_zyz", "tool", [0.7, second, -0.4])[3:]
    assert np.linalg.matrix_rank(axes) == 2
    assert_same(axes[:, 2], np.cos(second) * axes[:, 0])
    # What is lost is turning about the common normal of the axes: (cos q1, sin q1, 0).
    assert_same(np.array([np.cos(0.7), np.sin(0.7), 0]) @ axes, np.zeros(3))


def rates_of(q):
    return jacobian_of("wrist_zyz", "link3", q, rates="zyz")


@pytest.mark.parametrize("second", [0.01, 0.5, np.pi / 2, 2.0])
def test_a9_is_the_zyz_rate_matrix(second):
    """The joint angles are the wrist's ZYZ angles, so their rates are the joint rates: the analytic Jacobian is 1."""
    first, third = np.random.default_rng(94).uniform(-np.pi, np.pi, (2, 20))
    analytic = rates_of(vector_of(first, second, third))
    assert_same(analytic[:, 3:], np.broadcast_to(np.eye(3), (20, 3, 3)), atol=1e-12 / np.sin(second) ** 2)


def test_a9_for_a_negative_second_angle_zyz_takes_it_with_the_other_sign():
    analytic = rates_of([0.3, -0.8, 1.9])
    assert_same(analytic[3:], np.diag([1.0, -1.0, 1.0]))


# --- A10 --------------------------------------------------------------------------------------------------------

INCLINED = np.pi / 3


def three_roll_axes(q):
    """Return z, z inclined by 60 degrees about x, and z inclined back after a turn by q2; all turned by q1."""
    s1, c1, s2, c2 = np.sin(q[..., 0]), np.cos(q[..., 0]), np.sin(q[..., 1]), np.cos(q[..., 1])
    sine, cosine = np.sin(INCLINED), np.cos(INCLINED)
    x, y, z = -sine * s2, sine * cosine * (c2 - 1), sine**2 * c2 + cosine**2
    return matrix_of([[0, s1 * sine, c1 * x - s1 * y], [0, -c1 * sine, s1 * x + c1 * y], [1, cosine, z]])


def test_a10_angular_columns_are_the_axes():
    q = angles(3, seed=101)
    matrix = jacobian_of("wrist_three_roll", "tool", q)
    assert_same(matrix[:, 3:], three_roll_axes(q))
    assert_same(matrix[:, :3], linear_from(three_roll_axes(q), 0.1))
    assert_same(jacobian_of("wrist_three_roll", "link3", q)[:, :3], np.zeros((len(q), 3, 3)))


def test_a10_tool():
    for q in angles(3, seed=104):
        turns = turned(("z", q[0]), ("x", INCLINED), ("z", q[1]), ("x", -INCLINED), ("z", q[2]))
        assert_same(placement_of("wrist_three_roll", "tool", q), turns @ shifted(0, 0, 0.1))


def test_a10_neighbours_enclose_sixty_degrees():
    axes = jacobian_of("wrist_three_roll", "tool", angles(3, seed=102))[:, 3:]
    assert_same(np.einsum("ni,ni->n", axes[..., 0], axes[..., 1]), np.full(len(axes), 0.5))
    assert_same(np.einsum("ni,ni->n", axes[..., 1], axes[..., 2]), np.full(len(axes), 0.5))


def test_a10_determinant():
    q = angles(3, seed=103)
    assert_same(np.linalg.det(jacobian_of("wrist_three_roll", "tool", q)[:, 3:]), -0.75 * np.sin(q[:, 1]))


def test_a10_axes_one_and_three_are_collinear_at_zero():
    axes = jacobian_of("wrist_three_roll", "tool", [0.4, 0.0, -1.3])[3:]
    assert np.linalg.matrix_rank(axes) == 2
    assert_same(axes[:, 2], axes[:, 0])


def test_a10_there_the_wrist_moves_inside_itself():
    steps = np.linspace(-np.pi, np.pi, 9)
    q = vector_of(0.4 + steps, 0.0, -1.3 - steps)
    home = turn_about([0, 0, 1.0], 0.4 - 1.3)
    assert_same(placement_of("wrist_three_roll", "tool", q)[:, :3, :3], np.broadcast_to(home, (9, 3, 3)))


FOLD = np.array([0.4, np.pi, -1.3])
INSIDE = np.array([1.0, -1.0, 1.0])  # joint rates that do not turn the tool: a1 + a3 = a2 at the fold


def test_a10_all_three_axes_are_coplanar_at_half_a_turn():
    axes = jacobian_of("wrist_three_roll", "tool", FOLD)[3:]
    assert np.linalg.matrix_rank(axes) == 2
    assert_same(np.linalg.norm(np.cross(axes[:, 0], axes[:, 2])), np.sin(np.pi / 3))  # not collinear: 120 degrees
    assert_same(np.array([np.cos(0.4), np.sin(0.4), 0]) @ axes, np.zeros(3))  # the plane's normal
    assert_same(axes @ INSIDE, np.zeros(3))


def test_a10_there_the_wrist_is_folded():
    """The null motion turns the tool to second order, about the normal: no motion inside, but a barrier."""
    asked = jacobian_of("wrist_three_roll", "tool", FOLD)
    assert_same(asked[3:] @ INSIDE, np.zeros(3))
    home = placement_of("wrist_three_roll", "tool", FOLD)[:3, :3]
    normal = np.array([np.cos(0.4), np.sin(0.4), 0])
    for step in (1e-3, -1e-3, 1e-2):
        moved = placement_of("wrist_three_roll", "tool", FOLD + step * INSIDE)[:3, :3]
        # The axes' cross products add up to an angular acceleration of -sqrt(3)/2 about the normal.
        assert_same(moved @ home.T, turn_about(normal, -np.sqrt(3) / 4 * step**2), atol=2 * abs(step) ** 3)
