"""Grids of voxels: cubes of one size, side by side along the observer's axes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from kinetostat.conventions import Array, Flags
from kinetostat.errors import UsageError

__all__ = ["LARGEST", "Grid", "fitted", "usual_size"]

LARGEST = 4_000_000  # voxels of a grid: about 1 GB while maps of so many are merged
_FLAT = 1e-9  # m, and of the largest extent: what is thinner has no thickness
_ACROSS = 20  # voxels from the middle to the edge of the usual grid, about
_SHORTEST = 1e-9  # m
_LONGEST = 1e9  # m
_UNREADABLE = 1e12  # from here on a number is shown by its power of ten


@dataclass(frozen=True, repr=False)
class Grid:
    """Cubes that fill a box.

    Attributes:
        origin: the corner of the first voxel with the least coordinates, (3,), m.
        size: the edge of a voxel, m.
        shape: how many there are along x, y and z.
    """

    origin: Array
    size: float
    shape: tuple[int, int, int]

    def __repr__(self) -> str:
        return f"<Grid {' x '.join(map(str, self.shape))} voxels of {self.size:g} m>"

    @property
    def count(self) -> int:
        """How many voxels there are."""
        return math.prod(self.shape)

    @property
    def axes(self) -> tuple[Array, Array, Array]:
        """The middles of voxels along x, y and z, m."""
        x, y, z = (self.origin[i] + self.size * (np.arange(self.shape[i]) + 0.5) for i in range(3))
        return x, y, z

    def centre(self, index: Any) -> Array:
        """Return the middles of voxels by their number (x slowest), (...) -> (..., 3), m."""
        middle: Array = self.origin + self.size * (np.stack(np.unravel_index(index, self.shape), axis=-1) + 0.5)
        return middle

    def index(self, points: Array) -> Any:
        """Return the number of the voxel that each point is in, -1 outside all. (..., 3) -> (...)."""
        found: Any = 0
        inside: Any = True
        for i, count in enumerate(self.shape):
            cell = np.floor((points[..., i] - self.origin[i]) / self.size)
            inside = inside & (cell >= 0) & (cell < count)
            found = found * count + cell
        return np.where(inside, found, -1).astype(np.int64)

    def part(self, low: tuple[int, ...], high: tuple[int, ...]) -> Grid:
        """Return the voxels from `low` to `high`, inclusive, counted along x, y and z."""
        x, y, z = (b - a + 1 for a, b in zip(low, high, strict=True))
        return Grid(self.origin + self.size * np.array(low), self.size, (x, y, z))


def usual_size(low: Array, high: Array) -> float:
    """Return the size of voxel that suits a box: near a twentieth of half its longest side, with one digit: 1, 2, 5."""
    wanted = float(np.max(high - low)) / 2 / _ACROSS
    if not wanted > _SHORTEST:
        return 0.01
    power = math.floor(math.log10(wanted))
    return min((float(f"{step}e{power}") for step in (1, 2, 5, 10)), key=lambda size: abs(math.log(size / wanted)))


def fitted(low: Array, high: Array, points: Array, size: float | None) -> Grid:
    """Return a grid that holds a box, with the middle of a voxel at the observer's origin.

    Robots are symmetric about it, and often move in a plane through it: no voxel's face is there. Along an axis on
    which the tool does not move there is one layer, with the tool in its middle.

    Args:
        low: the box's corner with the least coordinates, (3,), m.
        high: the one with the greatest.
        points: where the tool is at some configurations, (m, 3): they tell along which axes it moves.
        size: of a voxel, m; None for the usual one.

    Raises:
        UsageError: the size is not between 1e-9 and 1e9 m, or there would be more than `LARGEST` voxels.
    """
    at, span = points.min(axis=0), np.ptp(points, axis=0)
    flat = span <= _FLAT * max(1.0, float(np.max(high - low)))
    low, high = np.where(flat, at, low), np.where(flat, at + span, high)
    size = usual_size(low, high) if size is None else size
    if not _SHORTEST <= size <= _LONGEST:
        raise UsageError(f"a voxel of {size:g} m cannot be", remedy="for instance --voxel 0.05")
    first, shape = _layers(low, high, flat, size)
    count = float(np.prod(shape))
    if count > LARGEST:
        shown = f"{count:,.0f}" if count < _UNREADABLE else f"{count:.2g}"
        message = f"there would be {shown} voxels of {size:g} m, more than {LARGEST:,}"
        raise UsageError(message, remedy=f"--voxel {_enough(low, high, flat, size):g} would do")
    x, y, z = (int(count) for count in shape)
    origin = np.where(flat, at + span / 2 - size / 2, (first - 0.5) * size)
    return Grid(origin, size, (x, y, z))


def _layers(low: Array, high: Array, flat: Flags, size: float) -> tuple[Array, Array]:
    """Return the number of the first layer of voxels along each axis, and how many there are, (3,) each."""
    slack = _FLAT * max(1.0, float(np.max(high - low)))  # rounding at the very edge
    first = np.where(flat, 0.0, np.floor((low - slack) / size + 0.5))
    return first, np.where(flat, 1.0, np.floor((high + slack) / size + 0.5) - first + 1)


def _enough(low: Array, high: Array, flat: Flags, size: float) -> float:
    """Return a size, of two digits, with which there are few enough voxels."""
    while np.prod(_layers(low, high, flat, size)[1]) > LARGEST:
        power = math.floor(math.log10(1.02 * size)) - 1
        size = float(f"{math.ceil(1.02 * size / 10.0**power)}e{power}")
    return size
