"""What the laws leave open of se3 and the screws of joints: known placements and known motions."""

from __future__ import annotations

import numpy as np
import pytest

from kinetostat.screw import chain, se3, so3
from kinetostat.screw.adjoint import adjoint, bracket, coadjoint, twist_matrix


def test_a_placement_is_written_rotation_left_translation_right() -> None:
    rotation = so3.exp(np.array([0.1, 0.2, 0.3]))
    matrix = se3.placement(rotation, np.array([1.0, 2.0, 3.0]))
    np.testing.assert_array_equal(matrix[:3, :3], rotation)
    np.testing.assert_array_equal(matrix[:, 3], [1, 2, 3, 1])
    np.testing.assert_array_equal(matrix[3, :3], [0, 0, 0])


def test_transform_takes_the_origin_to_the_translation() -> None:
    matrix = se3.exp(np.array([1.0, 2.0, 3.0, 0.4, 0.5, 0.6]))
    np.testing.assert_array_equal(se3.transform(matrix, np.zeros(3)), matrix[:3, 3])
    np.testing.assert_allclose(se3.transform(matrix, [1, 0, 0]) - matrix[:3, 3], matrix[:3, 0], rtol=0, atol=2e-15)


def test_transform_takes_one_point_by_many_placements_and_many_points_by_one() -> None:
    matrices = se3.exp(np.random.default_rng(0).normal(size=(5, 6)))
    point = np.array([1.0, -2.0, 0.5])
    by_many = se3.transform(matrices, point)
    assert by_many.shape == (5, 3)
    np.testing.assert_allclose(by_many[3], se3.transform(matrices[3], point), rtol=0, atol=2e-15)
    points = np.arange(12.0).reshape(4, 3)
    by_one = se3.transform(matrices[0], points)
    np.testing.assert_allclose(by_one[2], se3.transform(matrices[0], points[2]), rtol=0, atol=1e-14)


def test_half_a_turn_about_a_line_takes_the_origin_to_its_mirror_image() -> None:
    """A motion known in full: half a turn about the vertical line through (1, 2, 0)."""
    turned = se3.exp(chain.screw(np.array([0, 0, 1.0]), np.array([1.0, 2.0, 0.0])) * np.pi)
    wanted = [[-1, 0, 0, 2], [0, -1, 0, 4], [0, 0, 1, 0], [0, 0, 0, 1]]
    np.testing.assert_allclose(turned, wanted, rtol=0, atol=1e-15)


def test_a_quarter_turn_with_pitch_climbs_a_quarter_of_it() -> None:
    turned = se3.exp(chain.screw(np.array([0, 0, 1.0]), np.array([1.0, 0.0, 0.0]), 8.0) * np.pi / 2)
    np.testing.assert_allclose(se3.transform(turned, [2.0, 0.0, 0.0]), [1, 1, 2], rtol=0, atol=1e-15)


def test_the_screw_of_a_line_is_linear_first() -> None:
    """About z through (1, 0, 0) the point at the origin moves along -y."""
    np.testing.assert_array_equal(chain.screw([0, 0, 1.0], [1.0, 0, 0]), [0, -1, 0, 0, 0, 1])
    np.testing.assert_array_equal(chain.screw([0, 0, 1.0], [1.0, 0, 0], np.inf), [0, 0, 1, 0, 0, 0])


def test_log_finds_the_line_and_pitch_of_a_motion() -> None:
    direction, point, pitch = np.array([1.0, 2.0, 2.0]) / 3, np.array([0.5, -1.0, 0.3]), 0.7
    twist = se3.log(se3.exp(chain.screw(direction, point, pitch) * 2.0))
    v, w = twist[:3], twist[3:]
    np.testing.assert_allclose(w, 2 * direction, rtol=0, atol=2e-15)
    assert v @ w / (w @ w) == pytest.approx(pitch / (2 * np.pi), abs=1e-15)
    nearest = np.cross(w, v) / (w @ w)
    np.testing.assert_allclose(nearest, point - (point @ direction) * direction, rtol=0, atol=2e-15)


def test_frame_changes_of_a_pure_translation() -> None:
    """b lies 2 m along x from a: turning about b's z moves a along -y; a force at b along y turns about a."""
    placement = se3.placement(np.eye(3), np.array([2.0, 0.0, 0.0]))
    np.testing.assert_array_equal(adjoint(placement) @ [0, 0, 0, 0, 0, 1], [0, -2, 0, 0, 0, 1])
    np.testing.assert_array_equal(coadjoint(placement) @ [0, 1, 0, 0, 0, 0], [0, 1, 0, 0, 0, 2])
    np.testing.assert_array_equal(adjoint(placement) @ [1, 2, 3, 0, 0, 0], [1, 2, 3, 0, 0, 0])
    np.testing.assert_array_equal(coadjoint(placement) @ [0, 0, 0, 1, 2, 3], [0, 0, 0, 1, 2, 3])


def test_brackets_of_coordinate_twists() -> None:
    """[turn x, turn y] = turn z; [turn x, slide y] = slide z; slides commute."""
    slide_x, slide_y, slide_z, turn_x, turn_y, turn_z = np.eye(6)
    np.testing.assert_array_equal(bracket(turn_x, turn_y), turn_z)
    np.testing.assert_array_equal(bracket(turn_x, slide_y), slide_z)
    np.testing.assert_array_equal(bracket(slide_x, turn_y), slide_z)
    np.testing.assert_array_equal(bracket(slide_x, slide_y), np.zeros(6))
    np.testing.assert_array_equal(twist_matrix(turn_z) @ turn_x, turn_y)
