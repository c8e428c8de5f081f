"""The work of a map: chunks of configurations, counted in voxels, some of them computed again by Pinocchio."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinetostat.analysis.capability.directions import mask
from kinetostat.analysis.capability.grid import Grid
from kinetostat.analysis.capability.voxels import VoxelSums, counted
from kinetostat.analysis.sweeping.certifying import RowWitness
from kinetostat.analysis.sweeping.digest import digest
from kinetostat.analysis.sweeping.samples import BLOCK, InBlocks, Source
from kinetostat.conventions import Array

__all__ = ["APPROACH", "OUTPUTS", "MapWork"]

OUTPUTS = ("placement", "singular_values")  # what the kernel of a map gives
APPROACH = 15.0  # degrees: a tool whose z axis is so near to a direction arrives from it
_VERSION = "map 2"
_CHECKED = 4  # configurations of a chunk that Pinocchio computes again
_STEP = 2654435761  # D. Knuth's multiplier, a prime: which rows of a chunk they are differs from chunk to chunk


@dataclass(frozen=True, repr=False)
class MapWork(InBlocks):
    """A map as chunks of 65,536 configurations; see `sweeping.work`.

    Attributes:
        source: the configurations.
        witness: the chain, the kernel, and who computes rows again.
        grid: the voxels.
        unit: of fixed point: sums of singular values are whole multiples of it.
        approach: the direction, a unit vector in the observer's axes, within `APPROACH` of which the tool's z axis has
            to be for a configuration to count; None for any.
    """

    source: Source
    witness: RowWitness
    grid: Grid
    unit: float
    approach: tuple[float, float, float] | None = None

    def __repr__(self) -> str:
        return f"<MapWork: {self.rows} configurations in {self.chunks} chunks>"

    @cached_property
    def digest(self) -> str:
        """What identifies the question."""
        witness, model = self.witness, self.witness.coordinates.model
        parts = (
            witness.kernel,
            witness.rest,
            witness.velocity,
            witness.tolerances,
            self.grid,
            self.unit,
            self.approach,
        )
        return digest(_VERSION, BLOCK, model.loaded.text, self.source, *parts, model.crosscheck)

    def compute(self, chunk: int) -> VoxelSums:
        """Return what a chunk gives."""
        first = chunk * BLOCK
        q = self.source.rows(first, first + self.size(chunk))
        found = self.witness.kernel(q)
        placement, smallest = found["placement"], found["singular_values"][:, -1]
        index = self.grid.index(placement[:, :, 3])
        outside = int(np.count_nonzero(index < 0))
        if self.approach is not None:
            arrives = placement[:, :, 2] @ np.array(self.approach) >= np.cos(np.radians(APPROACH))
            index = np.where(arrives, index, -1)
        cells = counted(index, smallest, mask(placement[:, :, 2]), first, self.unit)
        some = np.unique((_STEP * (chunk + 1) + np.arange(_CHECKED) * (len(q) // _CHECKED)) % len(q))
        proof = self._compared(q[some], {name: found[name][some] for name in OUTPUTS})
        return replace(proof, outside=outside, waiting=(cells,))

    def checked(self, row: int, told: float) -> VoxelSums:
        """Return what Pinocchio says of one configuration, which is counted in no voxel.

        And of the smallest singular value that is told of it, which may have been damaged on its way.
        """
        q = self.source.rows(row, row + 1)
        found = self.witness.kernel(q)
        compared = self._compared(q, found)
        apart = abs(told - float(found["singular_values"][0, -1]))
        largest = [
            max(d, apart) if n == "singular_values" else d for n, d in zip(OUTPUTS, compared.differences, strict=True)
        ]
        return replace(compared, differences=tuple(largest))

    def _compared(self, q: Array, found: Mapping[str, Array]) -> VoxelSums:
        """Return how many configurations (k, n) Pinocchio has computed again, and the largest differences."""
        if not self.witness.coordinates.model.crosscheck:
            return self.empty()
        apart = self.witness.differences(q, found)
        largest = tuple(float(np.max(apart[name])) for name in OUTPUTS)
        return VoxelSums(self.grid.count, checked=len(q), differences=largest)

    def empty(self) -> VoxelSums:
        """Return what is known of no chunk."""
        return VoxelSums(self.grid.count, differences=(0.0,) * len(OUTPUTS))

    def restore(self, state: dict[str, NDArray[Any]]) -> VoxelSums:
        """Return the partial result whose `state()` this is."""
        return VoxelSums.restored(state)
