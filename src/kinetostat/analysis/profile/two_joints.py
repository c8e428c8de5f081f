"""Two joints of a limb that move, all others held: where the tool is, and how well it moves there."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.conventions import Array, Flags
from kinetostat.screw.kernel import Kernel

__all__ = ["TwoJoints", "ends_of", "grid_of"]

WHOLE = 0.01  # rad: a range that lacks no more of a turn is one; files write 6.28


def ends_of(joints: Coordinates) -> tuple[Array, Array]:
    """Return the ends between which the coordinates are drawn: inside limits, an angle a whole turn at most. (n,).

    Where limits are missing, see `Coordinates.limits`.
    """
    stated = joints.stated_limits
    lower, upper = np.maximum(joints.limits[0], stated[0]), np.minimum(joints.limits[1], stated[1])
    whole = np.array(joints.periodic) & (upper - lower > 2 * math.pi - WHOLE)
    return np.where(whole, -math.pi, lower), np.where(whole, math.pi, upper)


@dataclass(frozen=True, repr=False)
class TwoJoints:
    """Two coordinates of a limb that move, all others held.

    Attributes:
        joints: all coordinates.
        kernel: what gives placement, Jacobian and singular values of the rows that count, so many as the rank is.
        pair: indices of the two.
        held: where the others are. (n,).
        ends: lower and upper end of each coordinate, as `ends_of`. (n,), (n,).
    """

    joints: Coordinates
    kernel: Kernel
    pair: tuple[int, int]
    held: Array
    ends: tuple[Array, Array]

    def __repr__(self) -> str:
        return f"<TwoJoints {self.names}>"

    @property
    def names(self) -> tuple[str, str]:
        """Their names."""
        return self.joints.names[self.pair[0]], self.joints.names[self.pair[1]]

    def whole(self, index: int) -> bool:
        """Return whether a coordinate goes round as far as it likes."""
        return self.joints.periodic[index] and bool(self.ends[1][index] - self.ends[0][index] > 2 * math.pi - WHOLE)

    def coordinates(self, places: Array) -> Array:
        """Return the limb's coordinates (..., n) for those of the two (..., 2)."""
        q = np.broadcast_to(self.held, (*places.shape[:-1], len(self.held))).copy()
        q[..., list(self.pair)] = places
        return q

    def computed(self, places: Array) -> dict[str, Array]:
        """Return the kernel's outputs for coordinates of the two (..., 2), each (..., *shape)."""
        q = self.coordinates(places)
        found = self.kernel(q.reshape(-1, q.shape[-1]))
        return {name: part.reshape(*places.shape[:-1], *part.shape[1:]) for name, part in found.items()}

    def inside(self, places: Array, slack: float) -> Flags:
        """Return whether coordinates of the two (..., 2) are inside limits, in one turn about them. (...)."""
        between: Flags = np.ones(places.shape[:-1], dtype=bool)
        for axis, index in enumerate(self.pair):
            if not self.whole(index):
                lower, upper = self.ends[0][index], self.ends[1][index]
                between &= (places[..., axis] >= lower - slack) & (places[..., axis] <= upper + slack)
        return between


def grid_of(x: Array, y: Array) -> Array:
    """Return all places of two coordinates, the first changing fastest. (a,), (b,) -> (b, a, 2)."""
    return np.stack(np.meshgrid(x, y), axis=-1)
