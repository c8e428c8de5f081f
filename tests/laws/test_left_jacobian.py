"""The left Jacobian is the derivative of exp: exp(w + dw) = exp(V(w) dw) exp(w) to first order."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from differences import derivative
from kinetostat.screw import se3, so3

vector = arrays(np.float64, 3, elements=st.floats(-3, 3))


@given(vector, vector)
def test_it_is_the_derivative_of_exp(w: np.ndarray, dw: np.ndarray) -> None:
    spin = derivative(lambda t: so3.exp(w + t[:, None] * dw)) @ so3.exp(w).T
    np.testing.assert_allclose(so3.left_jacobian(w) @ dw, so3.vee(spin), rtol=0, atol=1e-11)


def test_it_is_the_derivative_of_exp_at_edges(rotation_vectors: np.ndarray) -> None:
    directions = np.random.default_rng(4).normal(size=rotation_vectors.shape)
    rates = derivative(lambda t: so3.exp(rotation_vectors + t[:, None, None] * directions))
    spins = rates @ np.swapaxes(so3.exp(rotation_vectors), -1, -2)
    found = (so3.left_jacobian(rotation_vectors) @ directions[..., None])[..., 0]
    np.testing.assert_allclose(found, so3.vee(spins), rtol=0, atol=1e-11)


@given(vector)
def test_it_is_the_mean_of_the_rotations_on_the_way(w: np.ndarray) -> None:
    """V(w) is the integral of exp(s w) over s from 0 to 1 (Gauss-Legendre, 20 points)."""
    nodes, weights = np.polynomial.legendre.leggauss(20)
    mean = np.tensordot(weights / 2, so3.exp((nodes[:, None] + 1) / 2 * w), axes=1)
    np.testing.assert_allclose(so3.left_jacobian(w), mean, rtol=0, atol=2e-14)


def test_its_inverse_is_its_inverse(rotation_vectors: np.ndarray) -> None:
    product = so3.inverse_left_jacobian(rotation_vectors) @ so3.left_jacobian(rotation_vectors)
    np.testing.assert_allclose(product, np.broadcast_to(np.eye(3), product.shape), rtol=0, atol=4e-15)


@given(vector.filter(lambda w: np.linalg.norm(w) < 5.2))
def test_its_inverse_is_its_inverse_beyond_half_a_turn_too(w: np.ndarray) -> None:
    product = so3.left_jacobian(w) @ so3.inverse_left_jacobian(w)
    np.testing.assert_allclose(product, np.eye(3), rtol=0, atol=4e-14)


@given(vector, vector)
def test_the_right_one_is_the_left_one_turned(w: np.ndarray, dw: np.ndarray) -> None:
    """V(-w) = exp(w)^T V(w): the derivative of exp seen from the other side."""
    np.testing.assert_allclose(so3.left_jacobian(-w), so3.exp(w).T @ so3.left_jacobian(w), rtol=0, atol=4e-15)


@given(vector, vector)
def test_it_gives_the_translation_of_a_screw_motion(v: np.ndarray, w: np.ndarray) -> None:
    """The origin of a body moving with a constant twist (v, w) has at every time s the velocity exp(s w) v."""
    twist = np.concatenate([v, w])
    rate = derivative(lambda t: se3.exp((1 + t)[:, None] * twist)[:, :3, 3])
    # p(s) = s V(s w) v; its rate at s = 1 is exp(w) v.
    np.testing.assert_allclose(rate, so3.exp(w) @ v, rtol=0, atol=1e-11)
