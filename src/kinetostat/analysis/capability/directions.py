"""Directions of approach as bits: a sphere in 58 bins of equal area, and a mask of those that are reached.

Reachability spheres count orientations by bins of the sphere: F. Zacharias, C. Borst and G. Hirzinger, "Capturing robot
workspace structure: representing robot capabilities", IROS 2007. Theirs are the nearest of spiral points; these are
rings of equal bins between parallels, after P. Leopardi, "A partition of the unit sphere into regions of equal area and
small diameter", ETNA 25, 2006: found without a search, and the same under reflection in x, y and z.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kinetostat.conventions import Array

__all__ = ["DIRECTIONS", "bins", "centres", "coverage", "mask", "widened"]

# Bins of each ring from +z to -z. A pole, the equator and every axis are in the middle of a bin, not on an edge: tools
# point along axes, and rounding must not choose.
_RINGS = np.array([1, 8, 12, 16, 12, 8, 1])
DIRECTIONS = int(np.sum(_RINGS))
_FIRST = np.cumsum(_RINGS) - _RINGS
_NEXT = 40.0  # degrees between middles of bins that are side by side, at most
_EDGES = 1 - 2 * np.cumsum(_RINGS)[:-1] / DIRECTIONS  # heights: by Archimedes, area between parallels is as height


def bins(directions: Array) -> Any:
    """Return the bin of each unit vector, from 0 at +z. (..., 3) -> (...), whole numbers below `DIRECTIONS`."""
    ring = np.zeros(directions.shape[:-1], dtype=np.int64)
    for edge in _EDGES:
        ring += directions[..., 2] < edge
    count = _RINGS[ring]
    turn = np.arctan2(directions[..., 1], directions[..., 0]) / (2 * np.pi)
    return _FIRST[ring] + np.floor(turn * count + 0.5).astype(np.int64) % count


def mask(directions: Array) -> Any:
    """Return the bin of each unit vector as the one bit of a 64-bit mask. (..., 3) -> (...)."""
    return np.left_shift(np.uint64(1), bins(directions).astype(np.uint64))


def centres() -> Array:
    """Return the unit vectors in the middle of the bins, (DIRECTIONS, 3)."""
    edges = np.concatenate([[1.0], _EDGES, [-1.0]])
    heights = np.repeat((edges[:-1] + edges[1:]) / 2, _RINGS)
    heights[[0, -1]] = 1.0, -1.0
    turns = np.concatenate([2 * np.pi * np.arange(count) / count for count in _RINGS])
    across = np.sqrt(1 - heights**2)
    return np.stack([across * np.cos(turns), across * np.sin(turns), heights], axis=-1)


def coverage(masks: Any) -> Array:
    """Return the share of directions that are in masks, (...) -> (...)."""
    share: Array = np.bitwise_count(masks) / DIRECTIONS
    return share


def widened(masks: Any) -> Any:
    """Return masks with all bins added that are side by side with one in them, (...) -> (...)."""
    middles = centres()
    near = middles @ middles.T > np.cos(np.radians(_NEXT))
    wide = np.zeros_like(masks)
    for i in range(DIRECTIONS):
        beside = np.bitwise_or.reduce(np.left_shift(np.uint64(1), np.flatnonzero(near[i]).astype(np.uint64)))
        wide |= np.where((masks & beside) != 0, np.uint64(1) << np.uint64(i), np.uint64(0))
    return wide
