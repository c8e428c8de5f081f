"""exp and log of SO(3) and SE(3), to the last bits, against the exponential series in 50 digits and each other."""

from __future__ import annotations

from decimal import Decimal, localcontext

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from kinetostat.screw import se3, so3

ROTATION = 2e-15  # entries of a rotation: at most 1, rounded a few times (largest seen 1.1e-15)
RELATIVE = 1.5e-15  # of a translation to its length, of an angle to itself (largest seen 4e-16)
BLIND = np.pi - 1e-14  # from here on the axis may come back pointing the other way

rotation_vector = arrays(np.float64, 3, elements=st.floats(-1.8, 1.8))  # shorter than pi
translation = arrays(np.float64, 3, elements=st.floats(-1e3, 1e3))


def exact_exp(twist: np.ndarray) -> np.ndarray:
    """Return the sum of X^k/k! for the 4x4 matrix X of a twist, in 50 digits, rounded to doubles once."""
    with localcontext() as context:
        context.prec = 50
        (vx, vy, vz, wx, wy, wz), zero = (Decimal(float(c)) for c in twist), Decimal(0)
        matrix = ((zero, -wz, wy, vx), (wz, zero, -wx, vy), (-wy, wx, zero, vz))
        term = [[Decimal(int(i == j)) for j in range(4)] for i in range(4)]
        total, k = [row[:] for row in term], 0
        while k < 4 or max(abs(x) for row in term for x in row) > Decimal("1e-40"):
            k += 1
            # The last row of X is zero, so the last column of the term enters no product.
            term = [[sum(row[m] * matrix[m][j] for m in range(3)) / k for j in range(4)] for row in term]
            total = [[t + x for t, x in zip(tr, xr, strict=True)] for tr, xr in zip(total, term, strict=True)]
        return np.array([[float(x) for x in row] for row in total])


def twists_of(angle: float, axes: np.ndarray) -> np.ndarray:
    """Return twists (n, 6) of one angle: every axis, translations from nothing to a thousand kilometres."""
    directions = np.random.default_rng(3).normal(size=(4, len(axes), 3))
    lengths = np.array([0.0, 1e-6, 1.0, 1e6])[:, None, None]
    return np.concatenate([directions * lengths, np.broadcast_to(angle * axes, directions.shape)], -1).reshape(-1, 6)


def size(vectors: np.ndarray) -> np.ndarray:
    """Return the largest component, which does not underflow as a norm does."""
    return np.max(np.abs(vectors), axis=-1)


def assert_same_placement(found: np.ndarray, wanted: np.ndarray) -> None:
    """Compare rotations absolutely and translations relative to their length."""
    np.testing.assert_allclose(found[..., :3, :3], wanted[..., :3, :3], rtol=0, atol=ROTATION)
    assert np.all(size((found - wanted)[..., :3, 3]) <= RELATIVE * size(wanted[..., :3, 3]))
    np.testing.assert_array_equal(found[..., 3, :], np.broadcast_to([0, 0, 0, 1], found[..., 3, :].shape))


def assert_same_twist(found: np.ndarray, wanted: np.ndarray) -> None:
    """Compare the angular and the linear part, each relative to its length: a tiny one keeps all its digits."""
    for part in (slice(0, 3), slice(3, 6)):
        assert np.all(size((found - wanted)[..., part]) <= RELATIVE * size(wanted[..., part]))


def test_the_reference_turns_x_into_y() -> None:
    quarter = exact_exp(np.array([0, 0, 0, 0, 0, np.pi / 2]))
    np.testing.assert_allclose(quarter[:3, :3], [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-16)


def assert_exp_is_the_series(twists: np.ndarray) -> None:
    wanted = np.stack([exact_exp(twist) for twist in twists])
    assert_same_placement(se3.exp(twists), wanted)
    np.testing.assert_allclose(so3.exp(twists[:, 3:]), wanted[:, :3, :3], rtol=0, atol=ROTATION)


def test_exp_is_the_exponential_series(angle: float, axes: np.ndarray) -> None:
    assert_exp_is_the_series(twists_of(angle, axes))


def test_exp_of_half_turns_is_the_exponential_series(half_turn: float, axes: np.ndarray) -> None:
    assert_exp_is_the_series(twists_of(half_turn, axes))


def test_log_finds_the_twist_of_the_exact_placement(angle: float, axes: np.ndarray) -> None:
    twists = twists_of(angle, axes)
    assert_same_twist(se3.log(np.stack([exact_exp(twist) for twist in twists])), twists)


def test_exact_exp_of_log_gives_the_placement_back(angle: float, axes: np.ndarray) -> None:
    placements = se3.exp(twists_of(angle, axes))
    assert_same_placement(np.stack([exact_exp(twist) for twist in se3.log(placements)]), placements)


def test_log_undoes_exp(twists: np.ndarray) -> None:
    told_apart = twists[np.linalg.norm(twists[:, 3:], axis=-1) < BLIND]
    assert len(told_apart) > 0.7 * len(twists)
    assert_same_twist(se3.log(se3.exp(told_apart)), told_apart)


def test_exp_undoes_log(twists: np.ndarray) -> None:
    placements = se3.exp(twists)
    assert_same_placement(se3.exp(se3.log(placements)), placements)


@given(rotation_vector, translation)
def test_log_and_exp_undo_each_other_anywhere(w: np.ndarray, v: np.ndarray) -> None:
    twist = np.concatenate([v, w])
    placement = se3.exp(twist)
    np.testing.assert_allclose(se3.log(placement)[3:], w, rtol=0, atol=RELATIVE * 3)
    np.testing.assert_allclose(se3.log(placement)[:3], v, rtol=0, atol=RELATIVE * size(v))
    assert_same_placement(se3.exp(se3.log(placement)), placement)


def test_half_turns_come_back_up_to_the_sign_of_the_axis(half_turn: float, axes: np.ndarray) -> None:
    w = so3.log(so3.exp(half_turn * axes))
    direction = np.sign(np.sum(w * axes, axis=-1, keepdims=True))
    np.testing.assert_allclose(direction * w, half_turn * axes, rtol=0, atol=4e-15)


def test_exact_exp_of_log_gives_half_turns_back(half_turn: float, axes: np.ndarray) -> None:
    placements = se3.exp(twists_of(half_turn, axes))
    assert_same_placement(np.stack([exact_exp(twist) for twist in se3.log(placements)]), placements)


def test_half_turns_about_coordinate_axes_are_exact() -> None:
    for i, unit in enumerate(np.eye(3)):
        half_turn = np.diag(np.where(np.arange(3) == i, 1.0, -1.0))
        np.testing.assert_array_equal(so3.log(half_turn), np.pi * unit)


def test_log_is_never_longer_than_half_a_turn(rotation_vectors: np.ndarray) -> None:
    beyond = np.concatenate([rotation_vectors * factor for factor in (1.0, 1.5, 2.0, 7.0)])
    assert np.max(np.linalg.norm(so3.log(so3.exp(beyond)), axis=-1)) <= np.pi * (1 + 1e-15)


def test_exp_of_nothing_is_the_identity_and_log_of_it_nothing() -> None:
    np.testing.assert_array_equal(se3.exp(np.zeros(6)), np.eye(4))
    np.testing.assert_array_equal(se3.log(np.eye(4)), np.zeros(6))


def test_a_turn_past_half_comes_back_the_short_way() -> None:
    axis = np.array([2, -3, 6]) / 7
    np.testing.assert_allclose(so3.log(so3.exp(4.0 * axis)), (4.0 - 2 * np.pi) * axis, rtol=0, atol=4e-15)


def test_exp_of_a_pure_translation_is_that_translation() -> None:
    v = np.array([1e-300, -1e6, 3.25])
    np.testing.assert_array_equal(se3.exp(np.concatenate([v, np.zeros(3)]))[:3, 3], v)


def test_many_turns_cost_only_the_digits_of_the_angle() -> None:
    axis = np.array([0.36, -0.48, 0.8])
    for turns in (1, 10, 1000, 100_000):
        angle = 2 * np.pi * turns + 0.5
        exact = np.arctan2(*(getattr(np, f)(np.longdouble(angle)) for f in ("sin", "cos")))
        np.testing.assert_allclose(so3.exp(angle * axis), so3.exp(float(exact) * axis), rtol=0, atol=1e-15 * angle)


# --- one screw, many positions ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("length", [0.0, 1e-6, 1.0, 1e6])
def test_exp_along_a_turning_screw_is_the_exponential_series(angle: float, length: float, axes: np.ndarray) -> None:
    """From pure rotations to screws of long pitch, forwards and backwards."""
    for axis, direction in zip(axes, np.random.default_rng(9).normal(size=axes.shape), strict=True):
        screw = np.concatenate([length * direction, axis])
        for q in (angle, -angle):
            found, wanted = se3.exp_along(screw, q), exact_exp(screw * q)
            np.testing.assert_allclose(found[:3, :3], wanted[:3, :3], rtol=0, atol=ROTATION)
            np.testing.assert_allclose(found[:3, 3], wanted[:3, 3], rtol=0, atol=4 * RELATIVE * length * abs(q))


def test_exp_along_a_slide_goes_straight(angle: float) -> None:
    v = np.array([2.0, -3.0, 6.0]) / 7
    found = se3.exp_along(np.concatenate([v, np.zeros(3)]), angle)
    np.testing.assert_array_equal(found[:3, :3], np.eye(3))
    np.testing.assert_allclose(found[:3, 3], v * angle, rtol=4e-16, atol=0)


def test_exp_along_starts_where_it_is_told() -> None:
    screw, start = np.array([0.3, -0.2, 0.5, 0.6, 0.0, 0.8]), se3.exp(np.array([1.0, 2.0, 3.0, 0.4, 0.5, -0.6]))
    q = np.linspace(-7, 7, 12).reshape(3, 4)
    wanted = start @ np.stack([exact_exp(screw * one) for one in q.ravel()]).reshape(3, 4, 4, 4)
    np.testing.assert_allclose(se3.exp_along(screw, q, start), wanted, rtol=0, atol=2e-14)


def test_many_turns_along_a_screw_cost_only_the_digits_of_the_angle() -> None:
    """About z through the origin everything is known: cosine, sine and advance of the whole angle."""
    for angle in (1.0, 1e3, -1e6):
        found = se3.exp_along(np.array([0, 0, 0.3, 0, 0, 1.0]), angle)
        cosine, sine = np.cos(angle), np.sin(angle)
        wanted = [[cosine, -sine, 0, 0], [sine, cosine, 0, 0], [0, 0, 1, 0.3 * angle], [0, 0, 0, 1]]
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-15 * abs(angle))
