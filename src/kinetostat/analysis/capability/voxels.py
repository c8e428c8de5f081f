"""What is known of voxels after some configurations: exact sums, which add up to the same bits in any order."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinetostat.conventions import Array

__all__ = ["Cells", "VoxelSums", "counted"]

Whole = NDArray[np.int64]
Bits = NDArray[np.uint64]

_NONE = -1  # a row, and a singular value, of a voxel that nothing has reached
_PENDING = 1 << 18  # cells that wait at most, or a quarter of the voxels, before they are added up


@dataclass(frozen=True, repr=False)
class Cells:
    """What is known of k voxels.

    Attributes:
        index: their numbers, ascending, (k,).
        count: how many configurations reach each, (k,).
        total: the sum of the smallest singular values, in whole units of fixed point, (k,).
        best: the largest of the smallest singular values, (k,).
        row: the number of the configuration that has it, the least of several, (k,).
        directions: the directions of approach, as bits, (k,).
    """

    index: Whole
    count: Whole
    total: Whole
    best: Array
    row: Whole
    directions: Bits

    def __repr__(self) -> str:
        return f"<Cells: {len(self.index)} voxels>"


def counted(index: Whole, smallest: Array, directions: Bits, first: int, unit: float) -> Cells:
    """Return what m configurations give, numbered from `first` on.

    Args:
        index: the voxel of each, (m,); those below 0 are left out.
        smallest: the smallest singular values, (m,), not negative.
        directions: the directions of approach, one bit each, (m,).
        first: the number of the first configuration.
        unit: of fixed point, which sums are whole multiples of.
    """
    # One sort of numbers that hold voxel and row is much faster than a sort of voxels that tells the order.
    bits = max(1, (len(index) - 1).bit_length())
    keys = np.sort((index << bits) | np.arange(len(index)))
    keys = keys[np.searchsorted(keys, 0) :]
    voxels, order = keys >> bits, keys & ((1 << bits) - 1)
    if not len(keys):
        return empty_cells()
    starts = np.flatnonzero(np.diff(voxels, prepend=_NONE))
    counts = np.diff(starts, append=len(voxels))
    values = smallest[order]
    best = np.maximum.reduceat(values, starts)
    row = np.where(values == np.repeat(best, counts), order, len(index))
    return Cells(
        voxels[starts],
        counts,
        np.add.reduceat(np.rint(values / unit).astype(np.int64), starts),
        best,
        np.minimum.reduceat(row, starts) + first,
        np.bitwise_or.reduceat(directions[order], starts),
    )


def empty_cells(voxels: int = 0) -> Cells:
    """Return that nothing has reached the first voxels."""
    zero = np.zeros(voxels, dtype=np.int64)
    none = np.full(voxels, _NONE, dtype=np.int64)
    return Cells(np.arange(voxels), zero, zero.copy(), none.astype(np.float64), none, zero.astype(np.uint64))


def _added(to: Cells, more: Cells) -> None:
    """Add voxels to all voxels, in place."""
    at = more.index
    to.count[at] += more.count
    to.total[at] += more.total
    to.directions[at] |= more.directions
    best = to.best[at]
    better = (more.best > best) | ((more.best == best) & (more.row < to.row[at]))
    to.best[at[better]], to.row[at[better]] = more.best[better], more.row[better]


@dataclass(frozen=True, repr=False)
class VoxelSums:
    """What some configurations give: a partial result of `sweeping.work`.

    Voxels of chunks wait until there are many, and are then added to a copy of all voxels; so a chunk costs what it
    holds, not what the grid holds. Counts and sums are whole numbers, the rest are extremes and unions of bits: the
    order does not matter.

    Attributes:
        voxels: how many the grid has.
        outside: how many configurations are in none of them.
        checked: how many configurations Pinocchio has computed again.
        differences: the largest difference that it found, of each output.
        dense: all voxels, or None where none have been added up yet.
        waiting: voxels of some chunks each.
    """

    voxels: int
    outside: int = 0
    checked: int = 0
    differences: tuple[float, ...] = ()
    dense: Cells | None = None
    waiting: tuple[Cells, ...] = ()

    def __repr__(self) -> str:
        return f"<VoxelSums of {self.voxels} voxels, {len(self.waiting)} parts wait>"

    def merged(self, other: VoxelSums) -> VoxelSums:
        """Return what the configurations of both give."""
        second = () if other.dense is None else (_reached(other.dense),)
        both = VoxelSums(
            self.voxels,
            self.outside + other.outside,
            self.checked + other.checked,
            tuple(max(a, b) for a, b in zip(self.differences, other.differences, strict=True)),
            self.dense,
            (*self.waiting, *other.waiting, *second),
        )
        many = sum(len(cells.index) for cells in both.waiting) > max(_PENDING, self.voxels // 4)
        return both._settled() if many else both

    def _settled(self) -> VoxelSums:
        """Return the same with nothing that waits."""
        dense = empty_cells(self.voxels)
        if self.dense is not None:
            dense = Cells(*(getattr(self.dense, name).copy() for name in Cells.__dataclass_fields__))
        for cells in self.waiting:
            _added(dense, cells)
        return replace(self, dense=dense, waiting=())

    @cached_property
    def cells(self) -> Cells:
        """The voxels that are reached."""
        dense = self._settled().dense
        return empty_cells() if dense is None else _reached(dense)

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all of it as plain arrays; see `sweeping.work`."""
        numbers = np.array([self.voxels, self.outside, self.checked], dtype=np.int64)
        arrays = {name: getattr(self.cells, name) for name in Cells.__dataclass_fields__}
        return {"numbers": numbers, "differences": np.array(self.differences, dtype=np.float64), **arrays}

    @classmethod
    def restored(cls, state: dict[str, NDArray[Any]]) -> VoxelSums:
        """Return that of which this is the state.

        Raises:
            KeyError, ValueError: it is none.
        """
        voxels, outside, checked = (int(number) for number in state["numbers"])
        cells = Cells(*(state[name] for name in Cells.__dataclass_fields__))
        index, kinds = cells.index, {field: getattr(cells, field).dtype for field in Cells.__dataclass_fields__}
        right = kinds == {field: getattr(empty_cells(), field).dtype for field in kinds}
        same = len({getattr(cells, field).shape for field in kinds}) == 1 and index.ndim == 1
        if not right or not same or np.any(np.diff(index, prepend=_NONE, append=voxels) <= 0):
            raise ValueError("not the state of voxels")
        return cls(
            voxels, outside, checked, tuple(map(float, state["differences"])), None, (cells,) if len(index) else ()
        )


def _reached(cells: Cells) -> Cells:
    at = np.flatnonzero(cells.count)
    return Cells(*(getattr(cells, name)[at] for name in Cells.__dataclass_fields__))
