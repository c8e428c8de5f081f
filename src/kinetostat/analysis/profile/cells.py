"""A sheet over two joints laid on a plane: the largest value in each small square of the plane."""

from __future__ import annotations

import math

import numpy as np

from kinetostat.conventions import Array, Flags

__all__ = ["best_in_cells", "covered_around"]

_FINE = 0.7  # of a square: places are nearer to each other, so that none between them is left out
_MOST = 12  # parts that a step between two places is divided into
_AT_ONCE = 400_000  # places
_ACROSS, _RIM = 240, 2  # squares across all of a sheet; and how many there are around a place inside it


def best_in_cells(points: Array, values: Array, box: Array, cells: tuple[int, int]) -> Array:
    """Return the largest value in each square of a box, between the places of a grid linearly; NaN where none is.

    Args:
        points: places over a grid of two joints, (b, a, 2), m.
        values: (b, a).
        box: the lower and the upper corner (2, 2), m.
        cells: how many squares to the right, and up.

    Returns:
        (up, right).
    """
    best = np.full(cells[0] * cells[1], -np.inf)
    size = (box[1] - box[0]) / cells
    parts = [_parts(np.diff(points, axis=axis), size) for axis in (0, 1)]
    all_three = _between(np.concatenate([points, values[..., None]], axis=-1), parts[1], 1)
    rows = max(1, _AT_ONCE // (all_three.shape[1] * parts[0]))
    for first in range(0, len(all_three) - 1, rows):
        strip = _between(all_three[first : first + rows + 1], parts[0], 0).reshape(-1, 3)
        at = np.floor((strip[:, :2] - box[0]) / size).astype(np.int64)
        inside = np.all((at >= 0) & (at < cells), axis=1)
        np.maximum.at(best, at[inside, 1] * cells[0] + at[inside, 0], strip[inside, 2])
    return np.where(np.isfinite(best), best, np.nan).reshape(cells[1], cells[0])


def covered_around(points: Array, places: Array) -> Flags:
    """Return whether a sheet over two joints (b, a, 2) covers all that is near places (k, 2): none is at its edge."""
    from scipy.ndimage import binary_erosion

    low, high = points.min(axis=(0, 1)), points.max(axis=(0, 1))
    size = float((high - low).max()) / _ACROSS
    cells = np.floor((high - low) / size).astype(np.int64) + 1
    best = best_in_cells(points, np.ones(points.shape[:2]), np.array([low, low + cells * size]), (cells[0], cells[1]))
    inner: Flags = binary_erosion(np.isfinite(best), np.ones((3, 3)), iterations=_RIM)
    at = np.clip(np.floor((places - low) / size).astype(np.int64), 0, cells - 1)
    around: Flags = inner[at[:, 1], at[:, 0]]
    return around


def _parts(steps: Array, size: Array) -> int:
    """Return into how many parts steps between neighbours (..., 2) are divided."""
    longest = float(np.max(np.abs(steps) / size, initial=0.0))
    return min(max(math.ceil(longest / _FINE), 1), _MOST)


def _between(values: Array, parts: int, axis: int) -> Array:
    """Return values with so many parts in each step along an axis."""
    share = np.arange(parts) / parts
    values = np.moveaxis(values, axis, 0)
    steps = values[:-1, None] + share.reshape(-1, *[1] * (values.ndim - 1)) * np.diff(values, axis=0)[:, None]
    return np.moveaxis(np.concatenate([steps.reshape(-1, *values.shape[1:]), values[-1:]]), 0, axis)
