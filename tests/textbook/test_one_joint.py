"""Rows A1 and A2: one joint, turning or sliding."""

import numpy as np
import pytest

from textbook_support import QUARTERS, angles, assert_same, columns_of, jacobian_of, placement_of

LENGTH = 0.9
SLIDE = np.array([3.0, 2.0, 6.0]) / 7


def test_a1_tip_moves_across_the_link():
    q = angles(1, seed=1)
    sine, cosine = np.sin(q[:, 0]), np.cos(q[:, 0])
    expected = columns_of((-LENGTH * sine, LENGTH * cosine, 0, 0, 0, 1))
    assert_same(jacobian_of("planar_1r", "tool", q), expected)


def test_a1_a_third_of_the_way_out_the_linear_part_is_a_third():
    q = angles(1, seed=2)
    sine, cosine = np.sin(q[:, 0]), np.cos(q[:, 0])
    third = jacobian_of("planar_1r", "link1", q, point=(LENGTH / 3, 0, 0))
    assert_same(third, columns_of((-0.3 * sine, 0.3 * cosine, 0, 0, 0, 1)))
    whole = jacobian_of("planar_1r", "tool", q)
    assert_same(3 * third[:, :3], whole[:, :3])
    assert_same(third[:, 3:], whole[:, 3:], atol=0)


@pytest.mark.parametrize("asked", [{"reference": "local"}, {"expressed_in": "tool"}, {"expressed_in": "link1"}])
def test_a1_in_the_tip_frame_the_column_is_constant(asked):
    q = angles(1, seed=3)
    expected = np.broadcast_to(np.array([0, LENGTH, 0, 0, 0, 1.0])[:, None], (len(q), 6, 1))
    assert_same(jacobian_of("planar_1r", "tool", q, **asked), expected)


def test_a1_about_the_base_the_joint_is_a_line_through_the_origin():
    q = angles(1, seed=4)
    expected = np.broadcast_to(np.array([0, 0, 0, 0, 0, 1.0])[:, None], (len(q), 6, 1))
    assert_same(jacobian_of("planar_1r", "tool", q, reference="world"), expected)


@pytest.mark.parametrize("frame", ["carriage", "tool"])
@pytest.mark.parametrize("point", [(0, 0, 0), (1, 0, 0), (-2, 3, 0.5), (0, 0, -40)])
def test_a2_every_point_of_a_slide_moves_along_the_axis(frame, point):
    q = np.array([-0.5, 0.0, 1e-9, 0.37, 0.5])
    expected = np.broadcast_to(np.r_[SLIDE, 0, 0, 0][:, None], (5, 6, 1))
    assert_same(jacobian_of("skew_1p", frame, q[:, None], point=point), expected)


def test_a2_the_point_at_the_observers_origin_does_too():
    assert_same(jacobian_of("skew_1p", "tool", [0.3], reference="world"), np.r_[SLIDE, 0, 0, 0][:, None])


def test_a2_in_the_tool_frame_the_axis_is_turned_twice():
    # (2, -3, 6)/7 in the joint's frame, turned back by the tool's quarter about x: (x, z, -y).
    assert_same(jacobian_of("skew_1p", "tool", [-0.2], reference="local"), np.r_[2, 6, 3, 0, 0, 0][:, None] / 7)


def test_a2_the_tool_advances_along_the_axis_without_turning():
    q = np.array([-0.5, -0.1, 0.0, 0.25, 0.5])
    placements = placement_of("skew_1p", "tool", q[:, None])
    # The tool's offset (0.15, -0.25, 0.4) in the joint's frame, turned by the quarter about z: (-y, x, z).
    home = np.array([0.1, -0.2, 0.3]) + np.array([0.25, 0.15, 0.4])
    assert_same(placements[:, :3, 3], home + q[:, None] * SLIDE)
    assert_same(placements[:, :3, :3], np.broadcast_to([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]], (5, 3, 3)))


def test_a1_tip_runs_on_a_circle():
    q = np.array(QUARTERS)[:, None]
    assert_same(
        placement_of("planar_1r", "tool", q)[:, :3, 3],
        LENGTH * np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0.0]]),
    )
