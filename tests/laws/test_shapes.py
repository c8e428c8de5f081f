"""Every function takes any leading shape, and a batch is the stack of its single answers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from kinetostat.screw import chain, se3, so3
from kinetostat.screw.adjoint import adjoint, bracket, carry, coadjoint, cross, twist_matrix

SHAPES = [(), (1,), (5,), (2, 3), (0,), (2, 0, 3)]

SCREWS = np.random.default_rng(5).uniform(-1, 1, (6, 4))
SCREW = chain.screw(np.array([0.36, -0.48, 0.8]), np.array([0.1, 0.2, 0.3]), 0.5)
HOME = se3.exp(np.random.default_rng(6).uniform(-1, 1, 6))


def vectors(*sizes: int) -> Callable[[np.random.Generator, tuple[int, ...]], tuple[np.ndarray, ...]]:
    return lambda random, shape: tuple(random.uniform(-1, 1, (*shape, size)) for size in sizes)


def rotations(random: np.random.Generator, shape: tuple[int, ...]) -> tuple[np.ndarray, ...]:
    return (so3.exp(random.uniform(-2, 2, (*shape, 3))),)


def placements(random: np.random.Generator, shape: tuple[int, ...]) -> tuple[np.ndarray, ...]:
    return (se3.exp(random.uniform(-2, 2, (*shape, 6))),)


def rotations_and_vectors(random: np.random.Generator, shape: tuple[int, ...]) -> tuple[np.ndarray, ...]:
    return rotations(random, shape) + vectors(3)(random, shape)


def placements_and_vectors(random: np.random.Generator, shape: tuple[int, ...]) -> tuple[np.ndarray, ...]:
    return placements(random, shape) + vectors(3)(random, shape)


FUNCTIONS = {
    "so3.hat": (so3.hat, vectors(3), (3, 3)),
    "so3.vee": (lambda w: so3.vee(so3.hat(w)), vectors(3), (3,)),
    "so3.exp": (so3.exp, vectors(3), (3, 3)),
    "so3.log": (so3.log, rotations, (3,)),
    "so3.left_jacobian": (so3.left_jacobian, vectors(3), (3, 3)),
    "so3.inverse_left_jacobian": (so3.inverse_left_jacobian, vectors(3), (3, 3)),
    "so3.to_quaternion": (so3.to_quaternion, rotations, (4,)),
    "so3.from_quaternion": (so3.from_quaternion, vectors(4), (3, 3)),
    "so3.to_rpy": (so3.to_rpy, rotations, (3,)),
    "so3.from_rpy": (so3.from_rpy, vectors(3), (3, 3)),
    "so3.about": (lambda w: so3.about(1, w[..., 0]), vectors(1), (3, 3)),
    "se3.placement": (se3.placement, rotations_and_vectors, (4, 4)),
    "se3.inverse": (se3.inverse, placements, (4, 4)),
    "se3.transform": (se3.transform, placements_and_vectors, (3,)),
    "se3.exp": (se3.exp, vectors(6), (4, 4)),
    "se3.exp_along": (lambda q: se3.exp_along(SCREW, q[..., 0], HOME), vectors(1), (4, 4)),
    "se3.log": (se3.log, placements, (6,)),
    "adjoint": (adjoint, placements, (6, 6)),
    "coadjoint": (coadjoint, placements, (6, 6)),
    "carry": (lambda placement: carry(placement, SCREWS), placements, (6, 4)),
    "cross": (lambda u, v: cross(u[..., None], v[..., None])[..., 0], vectors(3, 3), (3,)),
    "bracket": (bracket, vectors(6, 6), (6,)),
    "twist_matrix": (twist_matrix, vectors(6), (6, 6)),
    "chain.forward": (lambda q: chain.forward(HOME, SCREWS, q), vectors(4), (4, 4)),
    "chain.space_jacobian": (lambda q: chain.space_jacobian(SCREWS, q), vectors(4), (6, 4)),
    "chain.body_jacobian": (lambda q: chain.body_jacobian(HOME, SCREWS, q), vectors(4), (6, 4)),
    "chain.jacobian_derivatives": (
        lambda q: chain.jacobian_derivatives(chain.space_jacobian(SCREWS, q)),
        vectors(4),
        (6, 4, 4),
    ),
}


@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_batch_is_the_stack_of_its_single_answers(name: str, shape: tuple[int, ...]) -> None:
    function, make, tail = FUNCTIONS[name]
    arguments = make(np.random.default_rng(0), shape)
    batch = function(*arguments)
    assert batch.shape == (*shape, *tail)
    assert batch.dtype == np.float64
    for index in np.ndindex(shape):
        # BLAS may sum one product in another order than many: the last bit is free.
        single = function(*(argument[index] for argument in arguments))
        np.testing.assert_allclose(batch[index], single, rtol=0, atol=2e-15)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_arguments_are_not_written_to(name: str) -> None:
    function, make, _ = FUNCTIONS[name]
    arguments = make(np.random.default_rng(0), (2,))
    kept = [argument.copy() for argument in arguments]
    function(*arguments)
    for argument, before in zip(arguments, kept, strict=True):
        np.testing.assert_array_equal(argument, before)


def test_placements_broadcast_one_rotation_over_many_translations() -> None:
    many = se3.placement(np.eye(3), np.arange(12.0).reshape(4, 3))
    assert many.shape == (4, 4, 4)
    np.testing.assert_array_equal(many[2], [[1, 0, 0, 6], [0, 1, 0, 7], [0, 0, 1, 8], [0, 0, 0, 1]])
