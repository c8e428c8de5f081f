"""Chains of screws: the product of exponentials, its Jacobians and their derivatives. Linear part first.

    T(q) = exp(S_1 q_1) ... exp(S_n q_n) M

with S_i the space screws at q = 0 and M the placement of the tool there (Lynch and Park, "Modern Robotics", 2017,
chapters 4 and 5; R. Brockett, 1984). Columns are joints: arrays of screws are (6, n), Jacobians (..., 6, n).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinetostat.conventions import Array
from kinetostat.screw import se3
from kinetostat.screw.adjoint import adjoint, bracket, cross
from kinetostat.screw.so3 import hat

__all__ = ["Chain", "body_jacobian", "forward", "jacobian_derivatives", "screw", "space_jacobian"]


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


@dataclass(frozen=True)
class Chain:
    """A chain of unit screws between an observer A and a tool point, as constant arrays: what a batch is computed from.

    T(q) = exp(S_1 t_1) ... exp(S_k t_k) M with t = fold q + offset, so that one coordinate may drive several screws
    (mimic joints). Its Jacobians are of the tool's origin in A's axes, linear rows first.

    Attributes:
        screws: S_i in A at t = 0, |w| = 1 or w = 0. (6, k).
        home: M, the placement of the tool at t = 0. (4, 4).
        fold: how far screw i moves for coordinate j. (k, n).
        offset: where the screws are at q = 0. (k,).
    """

    screws: Array
    home: Array
    fold: Array
    offset: Array

    def columns(self, q: Array) -> tuple[Array, Array]:
        """Return every screw's column (v of the tool's origin ; w), (..., 6, k), and T, (..., 4, 4), at q (..., n)."""
        positions = np.asarray(q, dtype=np.float64) @ self.fold.T + self.offset
        shape, count = positions.shape[:-1], self.screws.shape[1]
        before = np.empty((*shape, count + 1, 4, 4))  # what stands before each screw, and the tool after the last
        before[..., 0, :, :] = np.eye(4)
        for i, motion in enumerate(np.moveaxis(self._motions(positions), -3, 0)):
            before[..., i + 1, :, :] = before[..., i, :, :] @ motion
        placement = before[..., count, :, :] @ self.home
        turns, origins = before[..., :count, :3, :3], np.swapaxes(before[..., :count, :3, 3], -1, -2)
        linear, angular = (
            np.swapaxes((turns @ half.T[..., None])[..., 0], -1, -2) for half in (self.screws[:3], self.screws[3:])
        )
        linear = linear + cross(origins - placement[..., :3, 3, None], angular)
        return np.concatenate([linear, angular], -2), placement

    def _motions(self, positions: Array) -> Array:
        """Return exp(S_i t_i) of every screw at once, as `se3.exp_along` does of one. (..., k) -> (..., k, 4, 4)."""
        first, square, rest = self._powers
        t = positions[..., None, None]
        sine = np.sin(t)
        motions: Array = np.eye(4) + sine * first + 2 * np.sin(t / 2) ** 2 * square + (t - sine) * rest
        return motions

    @cached_property
    def _powers(self) -> tuple[Array, Array, Array]:
        """[S], [S]^2 and [S] + [S]^3 of every screw, each (k, 4, 4)."""
        first = np.zeros((self.screws.shape[1], 4, 4))
        first[:, :3, :3], first[:, :3, 3] = hat(self.screws[3:].T), self.screws[:3].T
        square = first @ first
        return first, square, first + square @ first

    def jacobian(self, q: Array, *, local: bool = False) -> Array:
        """Return J with (v ; w) = J dq/dt, in A's axes or in the tool's (local). (..., n) -> (..., 6, n)."""
        columns, placement = self.columns(q)
        folded: Array = columns @ self.fold
        return _turned(placement, folded) if local else folded

    def derivatives(self, q: Array, *, local: bool = False) -> tuple[Array, Array]:
        """Return J, (..., 6, n), and dJ_i/dq_j, (..., 6, n, n), the last index being j; in A's axes or the tool's.

        The screws before a column turn it; those after it move the point: with j before i, dw_i/dt_j = w_j x w_i and
        dv_i/dt_j = w_j x v_i; with j after or at i, dw_i/dt_j = 0 and dv_i/dt_j = w_i x v_j. The tool's axes turn with
        w_j: R^T (dJ_i/dq_j - w_j x J_i).
        """
        columns, placement = self.columns(q)
        v, w = np.swapaxes(columns[..., :3, :], -1, -2), np.swapaxes(columns[..., 3:, :], -1, -2)
        turned_w = np.cross(w[..., None, :, :], w[..., :, None, :])  # [i, j] = w_j x w_i
        turned_v = np.cross(w[..., None, :, :], v[..., :, None, :])  # [i, j] = w_j x v_i
        before = np.tril(np.ones((columns.shape[-1],) * 2), -1)[..., None]
        linear = before * turned_v + (1 - before) * np.swapaxes(turned_v, -3, -2)
        by_screw = np.moveaxis(np.concatenate([linear, before * turned_w], -1), -1, -3)
        along: Array = np.swapaxes(np.swapaxes(by_screw @ self.fold, -1, -2) @ self.fold, -1, -2)
        matrix: Array = columns @ self.fold
        if not local:
            return matrix, along
        halves = np.stack([matrix[..., :3, :], matrix[..., 3:, :]], -3)  # (..., 2, 3, n)
        carried = np.cross(matrix[..., None, 3:, None, :], halves[..., None], axis=-3)  # [i, j] = w_j x half_i
        along = along - carried.reshape(along.shape)
        count = along.shape[-1]
        flat = along.reshape(*along.shape[:-2], count * count)
        return _turned(placement, matrix), _turned(placement, flat).reshape(along.shape)


def _turned(placement: Array, columns: Array) -> Array:
    """Return columns (..., 6, k) in the axes of a placement."""
    to_axes = np.swapaxes(placement[..., :3, :3], -1, -2)
    return np.concatenate([to_axes @ columns[..., :3, :], to_axes @ columns[..., 3:, :]], -2)
