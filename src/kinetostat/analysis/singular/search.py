"""From any configuration to a singular one: batched Levenberg-Marquardt on the reciprocal system.

A Jacobian (m, n) of generic rank r is singular where a matrix A, which is J^T or J, has k independent null vectors, one
more than its structure gives it: A(q) Y = 0, Y^T Y = 1. With A = J^T they are wrenches that no joint feels, k = m - r +
1; with A = J, joint rates that move nothing, k = n - r + 1. The smaller k is taken; it is 1 for most arms.

    F(x, Y) = [A(x) Y ; (Y^T Y - 1) / 2] = 0,   damping |F|^2

is solved for coordinates x and Y together, from the last singular vectors on. That does not stall where minimising a
determinant does, because F is smooth where singular values have their kink. On the method: K. Levenberg, 1944; N.
Yamashita and M. Fukushima, "On the rate of convergence of the Levenberg-Marquardt method", 2001, for the damping.
"""

from __future__ import annotations

import numpy as np

from kinetostat.analysis.singular.mechanism import Mechanism
from kinetostat.conventions import Array

__all__ = ["constraints", "converge"]

_ITERATIONS = 200
_SOLVED = 1e-13
_STUCK = 1e-9  # a step this short, far from a solution, is the end at a local minimum
_ANSWERED = 1e-4  # singular value of the derivative by Y below which Y has no answer
_FLOOR = 1e-14  # damping as a share of the matrix itself
_REJECTED = 10.0  # how much a rejected step raises the damping


def converge(mechanism: Mechanism, starts: Array) -> tuple[Array, Array]:
    """Return where a search from each start ends, and the singular value there that ought to be zero.

    Args:
        mechanism: what is searched.
        starts: coordinates (N, n).

    Returns:
        coordinates (N, n), and s_r there, (N,), of the length-scaled Jacobian.
    """
    q = np.array(starts, dtype=np.float64)
    y = _last_vectors(mechanism, q)
    damping, stuck = np.ones(len(q)), np.zeros(len(q), dtype=bool)
    residual, slope = _system(mechanism, q, y)
    for _ in range(_ITERATIONS):
        size = np.linalg.norm(residual, axis=-1)
        open_ = np.flatnonzero((size > _SOLVED) & ~stuck)
        if len(open_) == 0:
            break
        step = _step(residual[open_], slope[open_], damping[open_] * np.minimum(size[open_] ** 2, 1.0))
        stuck[open_] = (np.linalg.norm(step, axis=-1) < _STUCK) & (size[open_] > _STUCK**0.5)
        n = q.shape[-1]
        tried_q = q[open_] + step[:, :n] * mechanism.units
        tried_y = y[open_] + step[:, n:].reshape(-1, y.shape[-1], y.shape[-2]).swapaxes(-1, -2)
        tried_residual, tried_slope = _system(mechanism, tried_q, tried_y)
        better = np.linalg.norm(tried_residual, axis=-1) < size[open_]
        taken = open_[better]
        q[taken], y[taken] = tried_q[better], tried_y[better]
        residual[taken], slope[taken] = tried_residual[better], tried_slope[better]
        damping[taken] = np.maximum(damping[taken] / _REJECTED, 1.0)
        damping[open_[~better]] *= _REJECTED
    return q, mechanism.smallest(q)


def constraints(mechanism: Mechanism, q: Array) -> tuple[Array, Array]:
    """Return equations c(q) = 0 of the singular set next to q, and their gradients by coordinates in their units.

    They are what is left of the system when Y answers as well as it can: its part in the left null space of its
    derivative by Y. The gradients' rank is the set's codimension where the set is smooth. (n,) -> (c,), (c, n).
    """
    y = _last_vectors(mechanism, q[None])
    residual, slope = _system(mechanism, q[None], y)
    n = q.shape[-1]
    by_q, by_y = slope[0, :, :n], slope[0, :, n:]
    left, values, _ = np.linalg.svd(by_y)
    rest = left[:, int(np.sum(values > _ANSWERED)) :].T
    return rest @ residual[0], rest @ by_q


def _by_wrenches(mechanism: Mechanism) -> bool:
    """Return whether A is J^T."""
    return len(mechanism.task.rows) <= len(mechanism.names)


def _last_vectors(mechanism: Mechanism, q: Array) -> Array:
    """Return the singular vectors of the k smallest singular values as columns. (N, n) -> (N, m or n, k)."""
    left, _, right = np.linalg.svd(mechanism.jacobian(q))
    first = mechanism.generic_rank - 1
    vectors: Array = left[..., first:] if _by_wrenches(mechanism) else np.swapaxes(right[..., first:, :], -1, -2)
    return vectors


def _system(mechanism: Mechanism, q: Array, y: Array) -> tuple[Array, Array]:
    """Return F, (N, p), and its derivative by coordinates and by the columns of Y, (N, p, n + rows of Y times k)."""
    matrix, along = mechanism.derivatives(q)
    if _by_wrenches(mechanism):
        matrix, along = np.swapaxes(matrix, -1, -2), np.swapaxes(along, -3, -2)
    count, k = len(q), y.shape[-1]
    rows, cols = matrix.shape[-2:]
    norms = [(a, b) for a in range(k) for b in range(a, k)]
    n = q.shape[-1]
    residual = np.empty((count, rows * k + len(norms)))
    slope = np.zeros((count, rows * k + len(norms), n + cols * k))
    for a in range(k):
        part = slice(rows * a, rows * (a + 1))
        residual[:, part] = (matrix @ y[..., a, None])[..., 0]
        slope[:, part, :n] = np.einsum("Nrcj,Nc->Nrj", along, y[..., a])
        slope[:, part, n + cols * a : n + cols * (a + 1)] = matrix
    for i, (a, b) in enumerate(norms):
        residual[:, rows * k + i] = (np.sum(y[..., a] * y[..., b], axis=-1) - (a == b)) / 2
        slope[:, rows * k + i, n + cols * a : n + cols * (a + 1)] += y[..., b] / 2
        slope[:, rows * k + i, n + cols * b : n + cols * (b + 1)] += y[..., a] / 2
    return residual, slope


def _step(residual: Array, slope: Array, damping: Array) -> Array:
    """Return -S^T (S S^T + damping)^-1 F, the damped least-squares step. (N, p), (N, p, u) -> (N, u)."""
    gram = slope @ np.swapaxes(slope, -1, -2)
    floor = _FLOOR * np.trace(gram, axis1=-2, axis2=-1)  # equations may repeat each other
    gram += (damping + floor)[:, None, None] * np.eye(gram.shape[-1])
    step: Array = -(np.swapaxes(slope, -1, -2) @ np.linalg.solve(gram, residual[..., None]))[..., 0]
    return step
