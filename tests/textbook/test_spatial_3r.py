"""Rows A11 and A12: waist, shoulder and elbow, and the arm whose singular poses draw a torus."""

import numpy as np
import pytest

from textbook_support import angles, assert_same, columns_of, jacobian_of, placement_of, singular_values, vector_of

# name: distance of the shoulder from the first axis, its height, upper arm, forearm, all in m
ARMS = {"anthropomorphic": (0.0, 0.4, 0.5, 0.4), "torus_3r": (1.0, 0.0, 0.5, 0.3)}


def reach_and_height(name, q):
    """Return the wrist point's distance from the first axis (signed) and its height above the shoulder."""
    offset, _, upper, fore = ARMS[name]
    both = q[..., 1] + q[..., 2]
    return offset + upper * np.cos(q[..., 1]) + fore * np.cos(both), upper * np.sin(q[..., 1]) + fore * np.sin(both)


def spatial_3r(name, q):
    """Return the columns of row A11; with an offset the shoulder is not on the first axis."""
    offset, _, _, fore = ARMS[name]
    r, z = reach_and_height(name, q)
    s1, c1 = np.sin(q[..., 0]), np.cos(q[..., 0])
    s23, c23 = np.sin(q[..., 1] + q[..., 2]), np.cos(q[..., 1] + q[..., 2])
    return columns_of(
        (-s1 * r, c1 * r, 0, 0, 0, 1),
        (-c1 * z, -s1 * z, r - offset, s1, -c1, 0),
        (-fore * c1 * s23, -fore * s1 * s23, fore * c23, s1, -c1, 0),
    )


@pytest.mark.parametrize("name", ARMS)
def test_a11_columns(name):
    q = angles(3, seed=111)
    assert_same(jacobian_of(name, "tool", q), spatial_3r(name, q))


@pytest.mark.parametrize("name", ARMS)
def test_a11_wrist_point(name):
    q = angles(3, seed=112)
    r, z = reach_and_height(name, q)
    expected = vector_of(r * np.cos(q[:, 0]), r * np.sin(q[:, 0]), z + ARMS[name][1])
    assert_same(placement_of(name, "tool", q)[:, :3, 3], expected)


def test_a11_the_waist_may_be_counted_from_a_quarter_turn():
    """Texts that draw the arm along y count theta1 = q1 - 90 degrees: cosines become sines."""
    theta = angles(3, seed=113)
    r, _ = reach_and_height("anthropomorphic", theta)
    matrix = jacobian_of("anthropomorphic", "tool", theta + np.array([np.pi / 2, 0, 0]))
    assert_same(matrix[:, :, 0], vector_of(-np.cos(theta[:, 0]) * r, -np.sin(theta[:, 0]) * r, 0, 0, 0, 1))
    assert_same(matrix[:, 3:, 1], vector_of(np.cos(theta[:, 0]), np.sin(theta[:, 0]), 0))


@pytest.mark.parametrize("name", ARMS)
def test_a11_determinant_of_the_position_block(name):
    _, _, upper, fore = ARMS[name]
    q = angles(3, seed=114)
    r, _ = reach_and_height(name, q)
    expected = upper * fore * np.abs(np.sin(q[:, 2]) * r)
    assert_same(np.abs(np.linalg.det(jacobian_of(name, "tool", q)[:, :3])), expected)


@pytest.mark.parametrize("elbow", [0.0, np.pi])
def test_a11_elbow_singularity_loses_the_direction_of_the_arm(elbow):
    q = np.array([0.6, 0.9, elbow])
    block = jacobian_of("anthropomorphic", "tool", q)[:3]
    assert np.linalg.matrix_rank(block) == 2
    along = np.array([np.cos(0.6) * np.cos(0.9), np.sin(0.6) * np.cos(0.9), np.sin(0.9)])
    assert_same(along @ block, np.zeros(3))


def test_a11_shoulder_singularity_has_the_wrist_point_on_the_first_axis():
    elbow = 1.0
    # r = 0: tan q2 = (l2 + l3 c3) / (l3 s3)
    q = np.array([0.6, np.arctan2(0.5 + 0.4 * np.cos(elbow), 0.4 * np.sin(elbow)), elbow])
    assert_same(placement_of("anthropomorphic", "tool", q)[:2, 3], np.zeros(2))
    block = jacobian_of("anthropomorphic", "tool", q)[:3]
    assert np.linalg.matrix_rank(block) == 2
    assert_same(block[:, 0], np.zeros(3))  # the waist turns the wrist point about itself
    assert_same(np.array([-np.sin(0.6), np.cos(0.6), 0]) @ block, np.zeros(3))  # lost: across the arm's plane


def test_a11_six_rows_keep_rank_three_where_the_position_is_singular():
    matrix = jacobian_of("anthropomorphic", "tool", [0.6, 0.9, 0.0])
    assert np.linalg.matrix_rank(matrix) == 3
    assert np.linalg.matrix_rank(matrix[:3]) == 2


# --- A12 --------------------------------------------------------------------------------------------------------


def tube(points):
    """Return the distance of points from the circle of radius 1 m about the first axis, at the shoulder's height."""
    return np.hypot(np.hypot(points[..., 0], points[..., 1]) - 1.0, points[..., 2])


@pytest.mark.parametrize(("elbow", "radius"), [(0.0, 0.8), (np.pi, 0.2), (-np.pi, 0.2)])
def test_a12_singular_poses_are_on_a_torus(elbow, radius):
    first, second = angles(2, seed=121).T
    q = vector_of(first, second, elbow)
    values = singular_values(jacobian_of("torus_3r", "tool", q)[:, :3])
    assert np.all(values[:, 2] < 1e-14 * values[:, 0])
    points = placement_of("torus_3r", "tool", q)[:, :3, 3]
    assert_same(tube(points), np.full(len(q), radius))


@pytest.mark.parametrize("elbow", [0.0, np.pi])
def test_a12_what_is_lost_there_is_the_normal_of_the_torus(elbow):
    first, second = angles(2, seed=122).T
    block = jacobian_of("torus_3r", "tool", vector_of(first, second, elbow))[:, :3]
    normal = vector_of(np.cos(first) * np.cos(second), np.sin(first) * np.cos(second), np.sin(second))
    assert_same(np.einsum("ni,nij->nj", normal, block), np.zeros((len(first), 3)))


def test_a12_everywhere_else_the_arm_is_regular_inside_the_tube():
    """Hollow, as l1 > l2 + l3: the wrist point stays 0.2 m off the first axis, so only the elbow can be singular."""
    q = np.random.default_rng(123).uniform(-np.pi, np.pi, (500, 3))
    points = placement_of("torus_3r", "tool", q)[:, :3, 3]
    assert np.all((tube(points) > 0.2) & (tube(points) < 0.8))
    assert np.all(np.hypot(points[:, 0], points[:, 1]) > 0.2)
    determinant = np.abs(np.linalg.det(jacobian_of("torus_3r", "tool", q)[:, :3]))
    assert np.all(determinant >= 0.5 * 0.3 * np.abs(np.sin(q[:, 2])) * 0.2)


def test_a12_the_inner_equator_is_the_hole():
    points = placement_of("torus_3r", "tool", vector_of(np.linspace(-3, 3, 7), np.pi, 0.0))[:, :3, 3]
    assert_same(np.hypot(points[:, 0], points[:, 1]), np.full(7, 1.0 - 0.8))
