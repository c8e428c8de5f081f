"""Chains of screws: the product of exponentials, its Jacobians and their derivatives. Linear part first.

    T(q) = exp(S_1 q_1) ... exp(S_n q_n) M

with S_i the space screws at q = 0 and M the placement of the tool there (Lynch and Park, "Modern Robotics", 2017,
chapters 4 and 5; R. Brockett, 1984). Columns are joints: arrays of screws are (6, n), Jacobians (..., 6, n).
"""

from __future__ import annotations

import numpy as np

from kinetostat.conventions import Array
from kinetostat.screw import se3
from kinetostat.screw.adjoint import adjoint, bracket

__all__ = ["body_jacobian", "forward", "jacobian_derivatives", "screw", "space_jacobian"]


def screw(direction: Array, point: Array, pitch: float = 0.0) -> Array:
    """Return the screw of a joint that turns about a line and advances along it.

    S = (p/(2 pi) s + u x s ; s), s the unit direction, u a point of the line [m], p the pitch [m per turn]. Pitch 0 is
    a revolute joint; an infinite pitch is a sliding joint, (s ; 0). Shapes (3,), (3,) -> (6,).
    """
    direction = np.asarray(direction, dtype=np.float64)
    if np.isinf(pitch):
        return np.concatenate([direction, np.zeros(3)])
    return np.concatenate([pitch / (2 * np.pi) * direction + np.cross(point, direction), direction])


def _exponentials(screws: Array, q: Array) -> list[Array]:
    """Return exp(S_1 q_1), ..., each (..., 4, 4)."""
    q = np.asarray(q, dtype=np.float64)
    return [se3.exp(screws[:, i] * q[..., i, None]) for i in range(screws.shape[1])]


def forward(home: Array, screws: Array, q: Array) -> Array:
    """Return T(q) = exp(S_1 q_1) ... exp(S_n q_n) M. Shapes (4, 4), (6, n), (..., n) -> (..., 4, 4)."""
    placement = np.broadcast_to(np.eye(4), (*np.shape(q)[:-1], 4, 4))
    for factor in _exponentials(screws, q):
        placement = placement @ factor
    moved: Array = placement @ home
    return moved


def space_jacobian(screws: Array, q: Array) -> Array:
    """Return the space Jacobian: column i is Ad(exp(S_1 q_1) ... exp(S_{i-1} q_{i-1})) S_i.

    It gives the twist of the tool's body, of the point at the base origin, in base axes. Shapes (6, n), (..., n) ->
    (..., 6, n).
    """
    shape = np.shape(q)[:-1]
    placement = np.broadcast_to(np.eye(4), (*shape, 4, 4))
    columns = np.empty((*shape, 6, screws.shape[1]))
    for i, factor in enumerate(_exponentials(screws, q)):
        columns[..., i] = adjoint(placement) @ screws[:, i]
        placement = placement @ factor
    return columns


def body_jacobian(home: Array, screws: Array, q: Array) -> Array:
    """Return the body Jacobian Ad(T(q)^-1) J_space: the twist of the tool's origin in the tool's axes.

    Shapes (4, 4), (6, n), (..., n) -> (..., 6, n).
    """
    jacobian: Array = adjoint(se3.inverse(forward(home, screws, q))) @ space_jacobian(screws, q)
    return jacobian


def jacobian_derivatives(space: Array) -> Array:
    """Return dJ_i/dq_j of a space Jacobian whose columns are a chain in order: [J_j, J_i] for j before i, else 0.

    A column moves with the joints before it, as a screw carried by their motion. Shapes (..., 6, n) -> (..., 6, n, n),
    the last index being j.
    """
    count = space.shape[-1]
    columns = np.swapaxes(space, -1, -2)
    derivatives = np.moveaxis(bracket(columns[..., None, :, :], columns[..., :, None, :]), -1, -3)
    # derivatives[..., :, i, j] = [J_j, J_i]; only joints before i carry it.
    before = np.tril(np.ones((count, count)), -1)
    result: Array = derivatives * before
    return result
