"""The adjoint carries twists as conjugation does, the coadjoint wrenches so that power stays; brackets are rates."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from differences import derivative
from kinetostat.screw import se3, so3
from kinetostat.screw.adjoint import adjoint, bracket, carry, coadjoint, cross, twist_matrix

six = arrays(np.float64, 6, elements=st.floats(-3, 3))

ROUNDING = 2e-13  # of products of a few 6x6 matrices with entries up to 50


def assert_same(found: np.ndarray, wanted: np.ndarray, scale: float = 1.0) -> None:
    np.testing.assert_allclose(found, wanted, rtol=0, atol=ROUNDING * scale)


def as_matrix(twist: np.ndarray) -> np.ndarray:
    """Return the 4x4 matrix of a twist."""
    matrix = np.zeros((4, 4))
    matrix[:3, :3], matrix[:3, 3] = so3.hat(twist[3:]), twist[:3]
    return matrix


def from_matrix(matrix: np.ndarray) -> np.ndarray:
    """Return the twist of a 4x4 matrix."""
    return np.concatenate([matrix[:3, 3], so3.vee(matrix[:3, :3])])


# --- frame changes ---------------------------------------------------------------------------------------------------


@given(six, six)
def test_adjoint_is_conjugation(x: np.ndarray, y: np.ndarray) -> None:
    """(Ad(T) Y)^ = T Y^ T^-1: nothing but the definition, in 4x4 matrices."""
    placement = se3.exp(x)
    assert_same(adjoint(placement) @ y, from_matrix(placement @ as_matrix(y) @ np.linalg.inv(placement)))


@given(six, six)
def test_adjoint_and_coadjoint_respect_composition(x: np.ndarray, y: np.ndarray) -> None:
    a, b = se3.exp(x), se3.exp(y)
    assert_same(adjoint(a @ b), adjoint(a) @ adjoint(b))
    assert_same(coadjoint(a @ b), coadjoint(a) @ coadjoint(b))


@given(six)
def test_adjoint_of_the_inverse_is_the_inverse(x: np.ndarray) -> None:
    placement = se3.exp(x)
    assert_same(adjoint(se3.inverse(placement)) @ adjoint(placement), np.eye(6))
    assert_same(coadjoint(se3.inverse(placement)), np.linalg.inv(coadjoint(placement)))


@given(six)
def test_coadjoint_is_the_inverse_transpose(x: np.ndarray) -> None:
    placement = se3.exp(x)
    assert_same(coadjoint(placement), np.linalg.inv(adjoint(placement)).T)
    assert_same(coadjoint(placement), adjoint(se3.inverse(placement)).T)


@given(six, six, six)
def test_power_is_the_same_in_all_frames(x: np.ndarray, velocity: np.ndarray, wrench: np.ndarray) -> None:
    placement = se3.exp(x)
    assert_same((coadjoint(placement) @ wrench) @ (adjoint(placement) @ velocity), wrench @ velocity, 10)


def test_edge_placements_too(twists: np.ndarray) -> None:
    lengths = 1 + np.abs(twists[:, 0:1, None]) + np.abs(twists[:, 1:2, None]) + np.abs(twists[:, 2:3, None])
    placements = se3.exp(twists)
    identity = adjoint(placements) @ np.swapaxes(coadjoint(placements), -1, -2)
    assert np.all(np.abs(identity - np.eye(6)) <= 4e-15 * lengths)


@given(six, arrays(np.float64, (6, 4), elements=st.floats(-3, 3)))
def test_carrying_columns_is_multiplying_by_the_adjoint(x: np.ndarray, columns: np.ndarray) -> None:
    placement = se3.exp(x)
    assert_same(carry(placement, columns), adjoint(placement) @ columns)


@given(arrays(np.float64, (3, 4), elements=st.floats(-3, 3)), arrays(np.float64, (3, 4), elements=st.floats(-3, 3)))
def test_cross_is_the_cross_product_of_each_column(a: np.ndarray, b: np.ndarray) -> None:
    """It is orthogonal to both, by the right hand, and as long as the parallelogram is large."""
    assert_same(np.einsum("in,in->n", a, cross(a, b)), np.zeros(4))
    assert_same(np.einsum("in,in->n", b, cross(a, b)), np.zeros(4))
    area = (a * a).sum(0) * (b * b).sum(0) - (a * b).sum(0) ** 2
    assert_same((cross(a, b) ** 2).sum(0), area, 10)
    np.testing.assert_array_equal(cross(np.eye(3), np.eye(3)[:, [1, 2, 0]]), np.eye(3)[:, [2, 0, 1]])


@given(six, arrays(np.float64, 3, elements=st.floats(-3, 3)))
def test_adjoint_gives_the_velocity_of_the_point_at_the_new_origin(twist: np.ndarray, origin: np.ndarray) -> None:
    """With parallel axes the point of the body at p moves with v + w x p."""
    at_p = adjoint(se3.inverse(se3.placement(np.eye(3), origin))) @ twist
    assert_same(at_p, np.concatenate([twist[:3] + np.cross(twist[3:], origin), twist[3:]]))


@given(six, arrays(np.float64, 3, elements=st.floats(-3, 3)))
def test_coadjoint_takes_moments_about_the_new_origin(wrench: np.ndarray, origin: np.ndarray) -> None:
    """With parallel axes the moment about p is m - p x f, and the force stays."""
    at_p = coadjoint(se3.inverse(se3.placement(np.eye(3), origin))) @ wrench
    assert_same(at_p, np.concatenate([wrench[:3], wrench[3:] - np.cross(origin, wrench[:3])]))


# --- brackets --------------------------------------------------------------------------------------------------------


@given(six, six)
def test_bracket_is_the_commutator(x: np.ndarray, y: np.ndarray) -> None:
    a, b = as_matrix(x), as_matrix(y)
    assert_same(bracket(x, y), from_matrix(a @ b - b @ a))


@given(six, six)
def test_bracket_is_antisymmetric(x: np.ndarray, y: np.ndarray) -> None:
    np.testing.assert_array_equal(bracket(x, y), -bracket(y, x))
    np.testing.assert_array_equal(bracket(x, x), np.zeros(6))


@given(six, six, six)
def test_jacobi_identity(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> None:
    around = bracket(x, bracket(y, z)) + bracket(y, bracket(z, x)) + bracket(z, bracket(x, y))
    assert_same(around, np.zeros(6), 10)


@given(six, six)
def test_twist_matrix_is_the_bracket(x: np.ndarray, y: np.ndarray) -> None:
    assert_same(twist_matrix(x) @ y, bracket(x, y))


@given(six, six, six)
def test_adjoint_respects_brackets(t: np.ndarray, x: np.ndarray, y: np.ndarray) -> None:
    carry = adjoint(se3.exp(t))
    assert_same(carry @ bracket(x, y), bracket(carry @ x, carry @ y), 100)


@given(six)
def test_rate_of_the_adjoint_is_the_twist_matrix(x: np.ndarray) -> None:
    """d/dt Ad(exp(t X)) = ad(X) at t = 0, and d/dt Ad*(exp(t X)) = -ad(X)^T."""
    carry = derivative(lambda t: adjoint(se3.exp(t[:, None] * x)))
    np.testing.assert_allclose(carry, twist_matrix(x), rtol=0, atol=1e-11)
    dual = derivative(lambda t: coadjoint(se3.exp(t[:, None] * x)))
    np.testing.assert_allclose(dual, -twist_matrix(x).T, rtol=0, atol=1e-11)


@given(six, six)
def test_a_twist_carried_by_a_motion_changes_by_its_bracket_with_it(x: np.ndarray, y: np.ndarray) -> None:
    rate = derivative(lambda t: adjoint(se3.exp(t[:, None] * x)) @ y)
    np.testing.assert_allclose(rate, bracket(x, y), rtol=0, atol=1e-10)
