"""SO(3) and SE(3) are groups, and their coordinates (quaternions, roll-pitch-yaw) name their elements faithfully."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from kinetostat.screw import se3, so3

twist = arrays(np.float64, 6, elements=st.floats(-10, 10))
point = arrays(np.float64, 3, elements=st.floats(-10, 10))
parts = st.floats(-1, 1)

ROUNDING = 4e-15  # of products of a few matrices whose entries are about 1; times the length of translations


def assert_same(found: np.ndarray, wanted: np.ndarray, length: float = 10.0) -> None:
    np.testing.assert_allclose(found, wanted, rtol=0, atol=ROUNDING * max(1.0, length))


# --- the axioms ------------------------------------------------------------------------------------------------------


@given(twist, twist, twist)
def test_composition_is_associative(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> None:
    a, b, c = se3.exp(x), se3.exp(y), se3.exp(z)
    assert_same((a @ b) @ c, a @ (b @ c), 60)


@given(twist)
def test_inverse_undoes(x: np.ndarray) -> None:
    placement = se3.exp(x)
    assert_same(placement @ se3.inverse(placement), np.eye(4), 30)
    assert_same(se3.inverse(placement) @ placement, np.eye(4), 30)
    np.testing.assert_array_equal(se3.inverse(placement)[3], [0, 0, 0, 1])


@given(twist, twist)
def test_inverse_of_a_product_is_the_product_of_inverses_turned_round(x: np.ndarray, y: np.ndarray) -> None:
    a, b = se3.exp(x), se3.exp(y)
    assert_same(se3.inverse(a @ b), se3.inverse(b) @ se3.inverse(a), 40)


@given(twist, twist, point)
def test_composition_acts_as_one_after_the_other(x: np.ndarray, y: np.ndarray, p: np.ndarray) -> None:
    a, b = se3.exp(x), se3.exp(y)
    assert_same(se3.transform(a @ b, p), se3.transform(a, se3.transform(b, p)), 60)


def test_edge_placements_are_rigid(twists: np.ndarray) -> None:
    rotations = se3.exp(twists)[:, :3, :3]
    assert_same(rotations @ np.swapaxes(rotations, -1, -2), np.broadcast_to(np.eye(3), rotations.shape), 1)
    assert_same(np.linalg.det(rotations), np.ones(len(rotations)), 1)


@given(twist, point, point)
def test_a_placement_keeps_distances_and_handedness(x: np.ndarray, p: np.ndarray, q: np.ndarray) -> None:
    placement = se3.exp(x)
    moved = se3.transform(placement, np.stack([p, q, np.zeros(3)]))
    assert_same(np.linalg.norm(moved[0] - moved[1]), np.linalg.norm(p - q), 40)
    rotation = placement[:3, :3]
    assert_same(np.cross(rotation @ p, rotation @ q), rotation @ np.cross(p, q), 400)


# --- one-parameter subgroups -----------------------------------------------------------------------------------------


def test_exp_of_the_opposite_is_the_inverse(twists: np.ndarray) -> None:
    placements, lengths = se3.exp(twists), 1 + np.linalg.norm(twists[:, :3], axis=-1)
    assert np.all(np.abs(se3.exp(-twists) - se3.inverse(placements)) <= ROUNDING * lengths[:, None, None])


@given(twist, st.floats(-2, 2), st.floats(-2, 2))
def test_motions_along_one_screw_add_up(x: np.ndarray, s: float, t: float) -> None:
    assert_same(se3.exp(s * x) @ se3.exp(t * x), se3.exp((s + t) * x), 200)


@given(twist)
def test_log_of_the_inverse_is_the_opposite(x: np.ndarray) -> None:
    w = x[3:] * (3.0 / max(3.0, float(np.linalg.norm(x[3:]))))  # short of half a turn, where signs are a choice
    placement = se3.exp(np.concatenate([x[:3], w]))
    assert_same(se3.log(se3.inverse(placement)), -se3.log(placement), 30)


@given(twist)
def test_a_screw_motion_leaves_its_own_twist_where_it_is(x: np.ndarray) -> None:
    """exp(X) X exp(-X) = X, in 4x4 form."""
    matrix = np.zeros((4, 4))
    matrix[:3, :3], matrix[:3, 3] = so3.hat(x[3:]), x[:3]
    placement = se3.exp(x)
    assert_same(placement @ matrix @ se3.inverse(placement), matrix, 4000)


# --- quaternions -----------------------------------------------------------------------------------------------------


def test_quaternions_name_every_edge_rotation(rotation_vectors: np.ndarray) -> None:
    rotations = so3.exp(rotation_vectors)
    quaternions = so3.to_quaternion(rotations)
    assert np.all(quaternions[:, 3] >= 0)
    assert_same(np.linalg.norm(quaternions, axis=-1), np.ones(len(quaternions)), 1)
    assert_same(so3.from_quaternion(quaternions), rotations, 1)


@given(arrays(np.float64, 4, elements=parts).filter(lambda q: np.linalg.norm(q) > 1e-3))
def test_quaternions_of_any_length_and_sign_come_back_as_unit_ones(q: np.ndarray) -> None:
    unit = q / np.linalg.norm(q)
    back = so3.to_quaternion(so3.from_quaternion(q))
    assert min(np.max(np.abs(back - unit)), np.max(np.abs(back + unit))) <= ROUNDING
    assert_same(so3.from_quaternion(-q), so3.from_quaternion(q), 1)
    assert_same(so3.from_quaternion(1e6 * q), so3.from_quaternion(q), 1)


def test_the_vector_of_a_quaternion_is_the_axis_times_the_sine_of_half_the_angle(
    angle: float, axes: np.ndarray
) -> None:
    wanted = np.concatenate([np.sin(angle / 2) * axes, np.full((len(axes), 1), np.cos(angle / 2))], -1)
    found = so3.to_quaternion(so3.exp(angle * axes))
    # Relative for the vector: the quaternion of a tiny turn keeps all its digits.
    np.testing.assert_allclose(found[:, 3], wanted[:, 3], rtol=0, atol=1e-15)
    assert np.all(np.abs(found - wanted)[:, :3] <= 1e-15 * max(np.sin(angle / 2), 0.0))


def test_each_of_the_four_components_can_be_the_largest() -> None:
    for i in range(4):
        quaternion = np.full(4, 1e-9)
        quaternion[i] = 1.0
        quaternion /= np.linalg.norm(quaternion)
        np.testing.assert_allclose(so3.to_quaternion(so3.from_quaternion(quaternion)), quaternion, rtol=0, atol=4e-16)


# --- roll, pitch, yaw ------------------------------------------------------------------------------------------------


@given(st.floats(-np.pi, np.pi), st.floats(-1.5, 1.5), st.floats(-np.pi, np.pi))
def test_roll_pitch_yaw_come_back_between_the_poles(roll: float, pitch: float, yaw: float) -> None:
    wanted = np.array([roll, pitch, yaw])
    difference = so3.to_rpy(so3.from_rpy(wanted)) - wanted
    turns = 2 * np.pi * np.round(difference / (2 * np.pi))  # -pi and pi are one angle
    assert_same(difference - turns, np.zeros(3), 1 / np.cos(pitch))


def test_roll_pitch_yaw_name_every_edge_rotation(rotation_vectors: np.ndarray) -> None:
    rotations = so3.exp(rotation_vectors)
    assert_same(so3.from_rpy(so3.to_rpy(rotations)), rotations, 1)


# A rotation that came about by other turns: its entries carry rounding errors that those of from_rpy do not have.
ELSEWHERE = so3.exp(np.array([0.3, -1.1, 0.7]))


@pytest.mark.parametrize("pole", [np.pi / 2, -np.pi / 2])
def test_roll_pitch_yaw_name_a_rotation_near_the_poles(pole: float) -> None:
    angles = np.random.default_rng(1).uniform(-np.pi, np.pi, (450, 3))
    # 3.67e-6 is where a file that writes 1.5708 for a right angle ends up, 5e-12 one that writes 1.57079632679.
    angles[:, 1] = pole - np.sign(pole) * np.repeat([0.0, 1e-15, 1e-13, 5e-12, 1e-10, 1e-8, 3.67e-6, 1e-4, 1e-2], 50)
    rotations = ELSEWHERE.T @ (ELSEWHERE @ so3.from_rpy(angles))
    assert_same(so3.from_rpy(so3.to_rpy(rotations)), rotations, 2)


@pytest.mark.parametrize("pole", [np.pi / 2, -np.pi / 2])
def test_at_the_poles_yaw_is_chosen_zero(pole: float) -> None:
    for roll, yaw in ((0.3, -2.0), (-1.0, 1.0), (3.0, 3.0)):
        found = so3.to_rpy(so3.from_rpy(np.array([roll, pole, yaw])))
        assert found[2] == 0
        np.testing.assert_allclose(found[1], pole, rtol=0, atol=1e-15)
        # Roll and yaw turn about one line there: only their difference (at +pi/2) or sum (at -pi/2) is left.
        left = roll - np.sign(pole) * yaw
        np.testing.assert_allclose(np.exp(1j * found[0]), np.exp(1j * left), rtol=0, atol=ROUNDING)


# --- carrying z to an axis -------------------------------------------------------------------------------------------

NEAR_THE_POLES = [
    np.array([tilt * np.cos(azimuth), tilt * np.sin(azimuth), end * np.sqrt(1 - tilt**2)])
    for tilt in (0.5, 1e-3, 1e-7, 1e-8, 1e-12, 1e-17, 1e-200)
    for azimuth in (0.0, 0.4, 2.0, np.pi, -1.0)
    for end in (1.0, -1.0)
]


@pytest.mark.parametrize("axis", NEAR_THE_POLES, ids=str)
def test_z_is_carried_to_the_axis_by_the_smallest_rotation(axis: np.ndarray) -> None:
    rotation = so3.carry_z_to(axis)
    np.testing.assert_allclose(rotation[:, 2], axis, rtol=0, atol=1e-15)
    w = so3.log(rotation)
    assert w[2] == pytest.approx(0, abs=1e-15)  # no turn about z that is not needed
    assert np.linalg.norm(w) == pytest.approx(np.arctan2(np.hypot(axis[0], axis[1]), axis[2]), abs=2e-15)


def test_z_is_carried_to_every_axis(axes: np.ndarray) -> None:
    for axis in axes:
        rotation = so3.carry_z_to(axis)
        np.testing.assert_allclose(rotation[:, 2], axis, rtol=0, atol=1e-15)
        assert_same(rotation @ rotation.T, np.eye(3), 1)
        assert np.linalg.det(rotation) == pytest.approx(1)


def test_z_stays_and_minus_z_is_half_a_turn_about_x() -> None:
    np.testing.assert_array_equal(so3.carry_z_to(np.array([0.0, 0.0, 1.0])), np.eye(3))
    np.testing.assert_array_equal(so3.carry_z_to(np.array([0.0, -0.0, -1.0])), np.diag([1.0, -1.0, -1.0]))
