"""What the laws leave open of so3: signs, axes and choices, by cases that are known in full."""

from __future__ import annotations

import numpy as np
import pytest

from kinetostat.screw import so3

QUARTER_ABOUT_Z = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def test_hat_is_the_cross_product() -> None:
    w, u = np.array([1.0, -2.0, 3.0]), np.array([0.5, 4.0, -1.0])
    np.testing.assert_array_equal(so3.hat(w) @ u, np.cross(w, u))
    np.testing.assert_array_equal(so3.hat(w), [[0, -3, -2], [3, 0, -1], [2, 1, 0]])


def test_vee_undoes_hat_and_ignores_what_is_symmetric() -> None:
    w = np.array([1.0, -2.0, 3.0])
    np.testing.assert_array_equal(so3.vee(so3.hat(w)), w)
    symmetric = np.array([[1.0, 2.0, 3.0], [2.0, 4.0, 5.0], [3.0, 5.0, 6.0]])
    np.testing.assert_array_equal(so3.vee(so3.hat(w) + symmetric), w)


def test_rotations_are_right_handed() -> None:
    """About z, x goes to y; about x, y to z; about y, z to x."""
    for axis in range(3):
        source, target = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
        for rotation in (so3.about(axis, np.array(np.pi / 2)), so3.exp(np.eye(3)[axis] * np.pi / 2)):
            np.testing.assert_allclose(rotation @ source, target, rtol=0, atol=2e-16)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_about_is_exp_of_a_coordinate_axis(axis: int) -> None:
    angles = np.array([0.0, 1e-300, 1e-9, 0.3, -2.0, np.pi, 3 * np.pi, -50.0])
    wanted = so3.exp(angles[:, None] * np.eye(3)[axis])
    np.testing.assert_allclose(so3.about(axis, angles), wanted, rtol=0, atol=2e-14)
    assert np.all(so3.about(axis, angles)[:, axis] == np.eye(3)[axis])


def test_a_quaternion_has_its_scalar_last() -> None:
    half = np.sqrt(0.5)
    np.testing.assert_allclose(so3.to_quaternion(QUARTER_ABOUT_Z), [0, 0, half, half], rtol=0, atol=2e-16)
    np.testing.assert_allclose(so3.from_quaternion(np.array([0, 0, half, half])), QUARTER_ABOUT_Z, rtol=0, atol=4e-16)
    np.testing.assert_array_equal(so3.to_quaternion(np.eye(3)), [0, 0, 0, 1])
    np.testing.assert_array_equal(so3.from_quaternion(np.array([0, 0, 0, 1.0])), np.eye(3))


def test_roll_is_turned_first_and_yaw_last_about_fixed_axes() -> None:
    """Roll a quarter takes y to z; then pitch a quarter takes z to x; then yaw a quarter takes x to y."""
    quarter = np.pi / 2
    y = np.array([0.0, 1.0, 0.0])
    for rpy, wanted in (
        ((quarter, 0, 0), (0, 0, 1)),
        ((quarter, quarter, 0), (1, 0, 0)),
        ((quarter, quarter, quarter), (0, 1, 0)),
        ((0, quarter, quarter), (-1, 0, 0)),
    ):
        np.testing.assert_allclose(so3.from_rpy(np.array(rpy, dtype=float)) @ y, wanted, rtol=0, atol=4e-16)


def test_pitch_stays_within_a_quarter_turn() -> None:
    rotations = so3.exp(np.random.default_rng(0).normal(size=(500, 3)) * 2)
    assert np.max(np.abs(so3.to_rpy(rotations)[:, 1])) <= np.pi / 2


def test_integers_are_taken_as_numbers() -> None:
    np.testing.assert_array_equal(so3.hat([0, 0, 1]), [[0, -1, 0], [1, 0, 0], [0, 0, 0]])
    np.testing.assert_allclose(so3.from_rpy([0, 0, 1]), so3.exp([0, 0, 1]), rtol=0, atol=2e-16)
    np.testing.assert_array_equal(so3.to_quaternion([[-1, 0, 0], [0, -1, 0], [0, 0, 1]]), [0, 0, 1, 0])


def test_a_matrix_that_is_a_little_off_still_has_a_unit_quaternion() -> None:
    """A rotation that was multiplied many times drifts; what comes out is a rotation all the same."""
    drifted = so3.exp(np.array([0.3, 0.2, -0.9])) + 1e-6 * np.random.default_rng(1).normal(size=(3, 3))
    quaternion = so3.to_quaternion(drifted)
    assert np.linalg.norm(quaternion) == pytest.approx(1, abs=1e-15)
    np.testing.assert_allclose(so3.from_quaternion(quaternion), drifted, rtol=0, atol=1e-5)
