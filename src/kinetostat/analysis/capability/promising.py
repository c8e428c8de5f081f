"""What a map of capabilities promises of places of the base: how many wanted poses are in voxels that are reached."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinetostat.analysis.capability.capability_map import CapabilityMap
from kinetostat.analysis.capability.directions import DIRECTIONS, mask, widened
from kinetostat.conventions import Array
from kinetostat.errors import UsageError
from kinetostat.screw import so3

__all__ = ["PlacementMap", "arriving", "placement_map", "promised_at"]

HEADINGS = 24  # of the base, 15 degrees apart
_ENOUGH = 3 * DIRECTIONS  # configurations of a voxel: with fewer, directions are missing that could be reached
_DIGITS = 12  # decimal places of positions in m: 0 where rounding would leave 1e-16
_MOST_LOOKUPS = 1e10  # some minutes


@dataclass(frozen=True, repr=False)
class PlacementMap:
    """What a map of capabilities says of every place of the base, at the best of its headings.

    Attributes:
        x: positions of the base, (a,), m.
        y: (b,), m.
        yaw: its heading there, (a, b), rad.
        promised: how many of the poses are in voxels that the tool reaches, from about the wanted direction, (a, b).
        dexterity: the mean over them of the voxel's best smallest singular value, (a, b); 0 where there is none.
    """

    x: Array
    y: Array
    yaw: Array
    promised: NDArray[np.int64]
    dexterity: Array

    def __repr__(self) -> str:
        return f"<PlacementMap of {self.yaw.size} positions, at most {int(self.promised.max())} poses>"


def placement_map(
    capability: CapabilityMap,
    poses: Array,
    *,
    oriented: bool,
    progress: Callable[[str, float], None] | None = None,
) -> PlacementMap:
    """Return what the map says of every position of the base; see `base_placement`. (p, 4, 4).

    Raises:
        UsageError: there would be too many to look up.
    """
    x, y = _positions(capability, poses)
    if len(x) * len(y) * HEADINGS * len(poses) > _MOST_LOOKUPS:
        message = f"{len(x)} x {len(y)} base positions at {HEADINGS} headings are too many for {len(poses)} poses"
        raise UsageError(message, remedy="give a larger --voxel, or fewer poses")
    shape, arrive = (len(x), len(y)), arriving(capability, oriented)
    promised, dexterity, yaw = np.zeros(shape, dtype=np.int64), np.zeros(shape), np.zeros(shape)
    for i, heading in enumerate(_headings()):
        if progress is not None:
            progress(f"base headings, {i + 1} of {HEADINGS}", i / HEADINGS)
        count, total = promised_at(capability, poses, x, y, heading, arrive)
        mean = np.divide(total, count, out=np.zeros(shape), where=count > 0)
        better = (count > promised) | ((count == promised) & (mean > dexterity))
        promised, dexterity, yaw = (
            np.where(better, new, old) for new, old in ((count, promised), (mean, dexterity), (heading, yaw))
        )
    return PlacementMap(x, y, yaw, promised, dexterity)


def _headings() -> Array:
    """Return headings from 0 on, near ones first: of those that are as good, the first counts."""
    steps = np.arange(HEADINGS)
    turns: Array = 2 * math.pi / HEADINGS * np.where(steps > HEADINGS // 2, steps - HEADINGS, steps)
    return turns[np.argsort(np.abs(turns), kind="stable")]


def _positions(capability: CapabilityMap, poses: Array) -> tuple[Array, Array]:
    """Return x and y of positions from which something may be reached, one in the middle of the poses."""
    grid = capability.grid
    corners = np.abs(np.stack([grid.origin, grid.origin + grid.size * np.array(grid.shape)]))[:, :2]
    reach = float(np.linalg.norm(corners.max(axis=0)))
    places = poses[:, :2, 3]
    middle, low, high = places.mean(axis=0), places.min(axis=0) - reach, places.max(axis=0) + reach
    if not np.all((high - low) / grid.size < math.sqrt(_MOST_LOOKUPS)):
        raise UsageError("the poses are too far apart for this size of voxel", remedy="check their unit, it is m")
    first, last = np.ceil((low - middle) / grid.size), np.floor((high - middle) / grid.size)
    x, y = (np.round(middle[i] + grid.size * np.arange(first[i], last[i] + 1), _DIGITS) + 0.0 for i in range(2))
    return x, y


def promised_at(
    capability: CapabilityMap, poses: Array, x: Array, y: Array, heading: float, arrive: Any
) -> tuple[NDArray[np.int64], Array]:
    """Return how many poses the map has for every position, and the sum of best smallest singular values. (a, b).

    `arrive`: the directions that count as reached, of each voxel in a row, as bits; None where they do not matter.
    """
    count, total = np.zeros((len(x), len(y)), dtype=np.int64), np.zeros((len(x), len(y)))
    best, reached = capability.best_singular_value.ravel(), capability.reached.ravel()
    back = so3.about(2, np.array(-heading))
    # In the base's axes a pose is at back (p - (x, y, 0)): a sum of what x gives and what y gives.
    from_x, from_y = x[:, None, None] * back[:, 0], y[None, :, None] * back[:, 1]
    for pose in poses:
        at = capability.grid.index(back @ pose[:3, 3] - from_x - from_y)
        there = (at >= 0) & reached[at]
        if arrive is not None:
            there &= (arrive[at] & mask(back @ pose[:3, 2])) != 0
        count += there
        total += np.where(there, best[at], 0.0)
    return count, total


def arriving(capability: CapabilityMap, oriented: bool) -> Any:
    """Return the directions that count as reached, of each voxel in a row; None where they do not matter."""
    if not oriented:
        return None
    directions = capability.directions.ravel()
    return widened(directions) if capability.counted < _ENOUGH * capability.voxels else directions
