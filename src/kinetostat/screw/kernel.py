"""What is computed of every configuration of a batch: `Kernel`, run compiled, defined here in NumPy.

`Kernel.definition` is the readable formulation, by `Chain` and `Tree`; calling a kernel gives the same numbers by
`screw.compiled`, some hundred times as fast. Tests hold one against the other, and both against the engines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from kinetostat.conventions import Array
from kinetostat.errors import UsageError
from kinetostat.screw.chain import Chain
from kinetostat.screw.tree import Tree

if TYPE_CHECKING:
    from kinetostat.screw.compiled.packing import PackedMasses, PackedScrews

__all__ = ["OUTPUTS", "Kernel"]

# What can be asked for, with the shape of what is given for m configurations of n coordinates; k = min(rows, n), or the
# rank that the structure gives the rows at almost every configuration, where that is given.
OUTPUTS = (
    "placement",  # (m, 3, 4): the upper rows of T, the tool in the observer's coordinates
    "jacobian",  # (m, 6, n): of the tool's origin, linear rows first, in the axes that `local` says, in m and rad
    "singular_values",  # (m, k): of the weighed rows, descending but for rounding
    "yoshikawa",  # (m,): their product
    "yoshikawa_gradient",  # (m, n): along the coordinates; NaN where a singular value is zero
    "minimum_gradient",  # (m, n): of the smallest singular value; NaN where it is zero
    "gravity_torque",  # (m, n): what holds the tree still, Nm or N
    "effort_use",  # (m, n): |gravity torque| over the effort limit in its direction; NaN where there is none
    "limit_distance",  # (m,): of the coordinate nearest to a limit, 1 in the middle of its range, 0 at its end
)
_LOCKED = 1e-300  # half the length of a range of one position
KINK = 1e-9  # of the largest singular value: below it the smallest one is zero, and has no gradient


@dataclass(frozen=True)
class Kernel:
    """What is to be computed for configurations (..., n) of a chain: plain arrays, which travel to other processes.

    The matrix whose singular values count is M = diag(a) J diag(b) with some rows of it: linear rows divided by a
    characteristic length, for instance, columns weighed.

    Attributes:
        chain: the screws between the observer and the tool point.
        outputs: names of `OUTPUTS`.
        rows: the rows of J that count.
        row_factors: a, (6,).
        column_factors: b, (n,).
        local: J in the tool's axes instead of the observer's.
        tree: the masses that the same coordinates move, for torques; in coordinates in which `gravity` is given.
        gravity: the acceleration of gravity, (3,), m/s2.
        effort_limits: the least (negative) and greatest torque of each coordinate, infinite or NaN for none. (2, n).
        position_limits: lower and upper end of each coordinate, infinite for none. (2, n).
        rank: how many singular values count: the rank at almost every configuration, where it is less than k. An arm
            whose structure leaves some zero everywhere is singular where the smallest of the others is. Gradients are
            of all k, and have no value then.
    """

    chain: Chain
    outputs: tuple[str, ...]
    rows: tuple[int, ...] = (0, 1, 2, 3, 4, 5)
    row_factors: Array | None = None
    column_factors: Array | None = None
    local: bool = False
    tree: Tree | None = None
    gravity: Array | None = None
    effort_limits: Array | None = None
    position_limits: Array | None = None
    rank: int | None = None

    @property
    def values(self) -> int:
        """How many singular values count, k."""
        count: int = min(len(self.rows), self.chain.fold.shape[1])
        return count if self.rank is None else min(self.rank, count)

    def __call__(self, q: Array) -> dict[str, Array]:
        """Return what is asked for by name, compiled. (m, n) -> {output: (m, ...)}.

        Arrays are views of arrays whose last axis is the configurations', as compiled code fills them; a batch (m, n)
        that is such a view itself is not copied.

        Raises:
            UsageError: Numba cannot be imported.
        """
        try:
            from kinetostat.screw.compiled.run import run
        except ImportError as error:
            message = f"batches are computed by Numba, which cannot be imported: {error}"
            raise UsageError(message, remedy="pip install --force-reinstall numba") from None
        return run(self, q)

    @cached_property
    def packed_chain(self) -> PackedScrews:
        """The chain as compiled code takes it."""
        from kinetostat.screw.compiled.packing import pack_chain

        return pack_chain(self.chain)

    @cached_property
    def packed_tree(self) -> tuple[PackedScrews, PackedMasses]:
        """The tree and its masses as compiled code takes them."""
        from kinetostat.screw.compiled.packing import pack_tree

        if self.tree is None:
            raise ValueError("a kernel without a tree has no torques")
        return pack_tree(self.tree)

    def definition(self, q: Array) -> dict[str, Array]:
        """Return the same by NumPy, the readable way. (m, n) -> {output: (m, ...)}."""
        q = np.asarray(q, dtype=np.float64)
        jacobian, derivatives = self.chain.derivatives(q, local=self.local)
        found = {"jacobian": jacobian, "placement": self.chain.columns(q)[1][..., :3, :]}
        weighed, along = self.weighed(jacobian), self.weighed(derivatives, columns_at=-2)
        u, s, vt = np.linalg.svd(weighed, full_matrices=False)
        found["singular_values"] = s[..., : self.values]
        found["yoshikawa"] = np.prod(found["singular_values"], axis=-1)
        if "yoshikawa_gradient" in self.outputs or "minimum_gradient" in self.outputs:
            # ds_i/dq_j = u_i^T (dM/dq_j) v_i;  dw/dq_j = w sum_i ds_i/dq_j / s_i
            slopes = np.einsum("...ri,...rcj,...ic->...ij", u, along, vt)
            smooth = (s[..., -1] > KINK * s[..., 0])[..., None]
            found["minimum_gradient"] = np.where(smooth, slopes[..., -1, :], np.nan)
            with np.errstate(divide="ignore", invalid="ignore"):
                summed = np.sum(slopes / s[..., None], axis=-2)
            found["yoshikawa_gradient"] = np.where(smooth, np.prod(s, axis=-1)[..., None] * summed, np.nan)
        if self.tree is not None and self.gravity is not None:
            found["gravity_torque"] = self.tree.holding_torques(q, self.gravity)
            if self.effort_limits is not None:
                found["effort_use"] = effort_use(found["gravity_torque"], self.effort_limits)
        if self.position_limits is not None:
            found["limit_distance"] = limit_distance(q, self.position_limits)
        return {name: found[name] for name in self.outputs}

    def weighed(self, matrix: Array, columns_at: int = -1) -> Array:
        """Return the rows that count of diag(a) J diag(b): J's columns are an axis of `matrix`, rows before it."""
        after = (None,) * (-1 - columns_at)
        if self.column_factors is not None:
            matrix = matrix * self.column_factors[(..., *after)]
        if self.row_factors is not None:
            matrix = matrix * self.row_factors[(..., None, *after)]
        return np.take(matrix, self.rows, axis=columns_at - 1)


def effort_use(torques: Array, limits: Array) -> Array:
    """Return |torque| over the limit in its direction, NaN where there is none. (..., n), (2, n) -> (..., n)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        use: Array = torques / np.where(torques < 0, limits[0], limits[1])
    return np.where(np.isfinite(np.where(torques < 0, limits[0], limits[1])), use, np.nan)


def limit_distance(q: Array, limits: Array) -> Array:
    """Return the smallest distance of a coordinate from an end of its range, in halves of it; 1 where none has ends.

    1 - |q - middle| / half: 1 in the middle, 0 at an end, negative outside. (..., n), (2, n) -> (...).
    """
    middle, half = middle_and_half(limits)
    nearest: Array = np.min(1 - np.abs(q - middle) / half, axis=-1, initial=1.0)
    return nearest


def middle_and_half(limits: Array) -> tuple[Array, Array]:
    """Return the middle of each range and half its length: infinite without ends, hardly anything for one position."""
    lower, upper = limits
    ended = np.isfinite(lower) & np.isfinite(upper)
    with np.errstate(invalid="ignore"):
        middle, half = np.where(ended, (lower + upper) / 2, 0.0), np.where(ended, (upper - lower) / 2, np.inf)
    return middle, np.maximum(half, _LOCKED)


def named(outputs: Sequence[str]) -> tuple[str, ...]:
    """Return the outputs in the order of `OUTPUTS`, each once."""
    return tuple(name for name in OUTPUTS if name in outputs)
