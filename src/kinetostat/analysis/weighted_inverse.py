"""The weighted, damped pseudo-inverse of some rows of a Jacobian: its units, its rank, and how errors grow in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.task import FULL, Task, characteristic_length
from kinetostat.conventions import AGREEMENT, Array, Flags

__all__ = ["WeightedInverse"]

_STRICT = 1e-9  # of the largest singular value: below it a direction is lost
_ROUNDING = AGREEMENT  # of the size that entries of a Jacobian can have: below it a singular value is rounding
_NO_LENGTH = 1e-9  # of the robot's reach: a distance below it is rounding
_EXACT = 1e-9  # of the twist: a residual below it is rounding


@dataclass(frozen=True)
class WeightedInverse:
    """The weighted, damped pseudo-inverse J_W^+ of the rows that count.

        A = D^-1 J W^-1/2 = U diag(s) V^T,   J_W^+ = W^-1/2 V diag(s / (s^2 + l^2)) U^T D^-1

    D holds the units of the rows: L for lengths beside angles, else 1. Directions beyond the rank are left out. Units
    and rank are decided once, by one Jacobian, so that several engines solve the same problem. Whatever is called pure
    is in these units. Source: Y. Nakamura, "Advanced Robotics: Redundancy and Optimization", 1991, chapters 4 and 9.

    Attributes:
        task: the rows that count, m of them.
        length: L in m, of all six rows (`task.characteristic_length`); 1 where there is none. (...).
        has_length: whether there is one: not where no joint turns, or every axis passes through the point. (...).
        columns: the diagonal of W^-1/2; without weights, 1 for angles and L for slides. (..., n).
        values: s, largest first, (..., k).
        rank: how many of them count, (...). It is the arm's: weights do not change it.
    """

    task: Task
    length: Array
    has_length: Flags
    columns: Array
    values: Array
    rank: Array

    @classmethod
    def at(
        cls, matrix: Array, turning: Sequence[bool], task: Task, cost: Array | None, reach: float
    ) -> WeightedInverse:
        """Return the inverse whose units and rank a Jacobian decides.

        Args:
            matrix: the Jacobian (..., 6, n).
            turning: which columns are of joints that turn, (n,).
            task: the rows that count.
            cost: the diagonal of W, (n,); None for equal costs.
            reach: the farthest that the point can be from an axis, in m: rounding goes with it.
        """
        length = characteristic_length(matrix, turning, FULL)
        has_length = length > _NO_LENGTH * reach
        length = np.where(has_length, length, 1.0)
        shape = (*matrix.shape[:-2], matrix.shape[-1])
        equal = np.broadcast_to(np.where(turning, 1.0, length[..., None]), shape)
        columns = equal if cost is None else np.broadcast_to(1 / np.sqrt(cost), shape)
        values, alone = (_singular_values(_pure(matrix, task, length, each)) for each in (columns, equal))
        # Entries are lengths up to the reach where a turn moves a point, else numbers up to 1.
        lengths = np.logical_and.outer(np.array(task.rows) < 3, np.asarray(turning, dtype=bool))
        entries = np.where(lengths, reach, 1.0) * equal[..., None, :] / _units(task, length)[..., None]
        floor = np.maximum(_STRICT * alone[..., :1], _ROUNDING * np.max(entries, (-2, -1))[..., None])
        return cls(task, length, has_length, columns, values, np.sum(alone > floor, axis=-1))

    def scaled(self, matrix: Array) -> Array:
        """Return A of a Jacobian (..., 6, n): the rows that count as pure numbers. (..., m, n)."""
        return _pure(matrix, self.task, self.length, self.columns)

    def goal(self, twist: Array) -> Array:
        """Return the rows that count of a twist (..., 6) as pure numbers. (..., m)."""
        rows: Array = twist[..., list(self.task.rows)] / _units(self.task, self.length)
        return rows

    @property
    def _counted(self) -> Flags:
        """Which singular values count, (..., k)."""
        return np.asarray(np.arange(self.values.shape[-1]) < self.rank[..., None])

    def _damped(self, values: Array, damping: float) -> Array:
        """Return s / (s^2 + l^2), and 0 beyond the rank. (..., k)."""
        counted = self._counted
        return np.where(counted, values / np.where(counted, values**2 + damping**2, 1.0), 0.0)

    def solved(self, matrix: Array, twist: Array, damping: float, z: Array) -> tuple[Array, Array]:
        """Return J_W^+ V, and the part (1 - J_W^+ J) z of rates z that moves nothing, which is not damped.

        (..., 6, n), (..., 6), (..., n) -> (..., n), (..., n).
        """
        left, values, right = np.linalg.svd(self.scaled(matrix), full_matrices=False)
        parts = np.einsum("...mk,...m->...k", left, self.goal(twist)) * self._damped(values, damping)
        found: Array = np.einsum("...kn,...k->...n", right, parts) * self.columns
        free = z / self.columns
        seen = np.where(self._counted, np.einsum("...kn,...n->...k", right, free), 0.0)
        null: Array = (free - np.einsum("...kn,...k->...n", right, seen)) * self.columns
        return found, null

    def ascent(self, matrix: Array, along: Array) -> Array:
        """Return W^-1 d(ln w)/dq, the steepest ascent of w, the product of the s that count. (..., n).

        d(ln w)/dq_j = sum of ds_i/dq_j / s_i = trace(A^+ dA/dq_j), the units held; `along` is dJ/dq_j, (..., n, 6, n).
        """
        left, values, right = np.linalg.svd(self.scaled(matrix), full_matrices=False)
        inverse = np.einsum("...kn,...k,...mk->...nm", right, self._damped(values, 0.0), left)
        along = np.broadcast_to(along, (*self.columns.shape, *along.shape[-2:]))
        slopes = self.scaled(np.moveaxis(along, -3, 0))  # (n, ..., m, n): units go with the leading shape
        gradient: Array = np.einsum("...nm,j...mn->...j", inverse, slopes)
        return gradient * self.columns**2

    def drift(self, matrix: Array, rate: Array, index: int) -> Array:
        """Return ds_i/dt = u_i^T (dA/dt) v_i of the singular value of an index, the units held. (...)."""
        left, _, right = np.linalg.svd(self.scaled(matrix), full_matrices=False)
        found: Array = np.einsum("...m,...mn,...n->...", left[..., index], self.scaled(rate), right[..., index, :])
        return found

    def sensitivity(
        self, matrix: Array, twist: Array, damping: float, rates: Array, z: Array, *, ascending: bool
    ) -> Array:
        """Return how far rates go for each unit (m or rad) that entries of J go, to first order; 1 where all rest.

            |dx| <= (max s / (s^2 + l^2) |x| + max 1 / (s^2 + l^2) |r| + max 1 / s |y|) |dA| + |x| + |y|

        x being the pure rates for the twist, r what they leave of it, y the pure secondary rates. Source: G. Golub and
        C. Van Loan, "Matrix Computations", section 5.3, of least squares.

        Args:
            matrix: the Jacobian (..., 6, n).
            twist: V, (..., 6).
            damping: l.
            rates: J_W^+ V, (..., n).
            z: the secondary rates, (..., n).
            ascending: whether z is `ascent`, which has an error of its own, even where it is zero.
        """
        counted, largest = self._counted, np.max(self.columns, axis=-1)
        squares = np.where(counted, self.values**2 + damping**2, np.inf)
        once, twice = np.max(self.values / squares, axis=-1), np.max(1 / squares, axis=-1)
        steep = np.max(1 / np.where(counted, self.values, np.inf), axis=-1)
        pure = rates / self.columns
        left = np.linalg.norm(self.goal(twist) - np.einsum("...mn,...n->...m", self.scaled(matrix), pure), axis=-1)
        moved, free = np.linalg.norm(pure, axis=-1), np.linalg.norm(z / self.columns, axis=-1)
        if ascending:
            free = free + self.rank * largest * (1 + steep * self.values[..., 0])
        entry = largest / np.min(_units(self.task, self.length), axis=-1)
        grown = largest * (moved + free + entry * (once * moved + twice * left + steep * free))
        return np.where(grown > 0, grown, 1.0)

    def exact(self, residual: Array, twist: Array, rates: Array) -> Flags:
        """Return whether a residual (..., 6) is what rounding leaves of a twist at all of the rates (..., n). (...)."""
        left, asked = (np.linalg.norm(self.goal(each), axis=-1) for each in (residual, twist))
        moved = np.linalg.norm(rates / self.columns, axis=-1)
        return np.asarray(left <= _EXACT * asked + _ROUNDING * self.values[..., 0] * moved)

    def amplification(self, rates: Array, twist: Array) -> Array:
        """Return |x| s_1 / |V| of the rates for a twist: 1 in the direction that needs least; 0 at rest. (...)."""
        moved, asked = np.linalg.norm(rates / self.columns, axis=-1), np.linalg.norm(self.goal(twist), axis=-1)
        return np.where(asked > 0, moved * self.values[..., 0] / np.where(asked > 0, asked, 1.0), 0.0)


def _units(task: Task, length: Array) -> Array:
    """Return what a unit of each row that counts is: L in m beside angles, else 1 m or 1 rad. (..., m)."""
    return np.where((np.array(task.rows) < 3) & task.mixed, length[..., None], 1.0)


def _pure(matrix: Array, task: Task, length: Array, columns: Array) -> Array:
    """Return the rows that count as pure numbers. (..., 6, n) -> (..., m, n)."""
    rows: Array = matrix[..., list(task.rows), :] * columns[..., None, :]
    return rows / _units(task, length)[..., None]


def _singular_values(matrix: Array) -> Array:
    return np.asarray(np.linalg.svd(matrix, compute_uv=False), dtype=np.float64)
