"""The outline of many places: what they cover, without the gaps between them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinetostat.conventions import Array, Flags

__all__ = ["OUTLINE", "silhouette", "thinned"]

OUTLINE = 0.71  # the height of the outline: a square inside the filled ones, which reach that far beyond their places
_GAPS, _SMOOTH = 3, 1.8  # squares: half of the gaps that are filled, and roundness of edges
_THIN = 0.5  # of squares, that are left where lines are taken out: with fewer the places are a line


def silhouette(points: Array, box: Array, cells: tuple[int, int]) -> tuple[Array, Array, Array] | None:
    """Return how far squares of a box belong to places (k, 2), as heights whose outline is at `OUTLINE`.

    Returns:
        Middles of squares to the right (c,) and up (r,), m, some of them beyond the box; heights (r, c). None where the
        places are on a line, or nowhere.
    """
    from scipy.ndimage import binary_closing, binary_opening, gaussian_filter

    size, around = (box[1] - box[0]) / cells, 2 * _GAPS
    at = _squares(points, box, cells) + around
    filled: Flags = np.zeros((cells[1] + 2 * around, cells[0] + 2 * around), dtype=bool)
    filled[at[:, 1], at[:, 0]] = True
    closed = binary_closing(filled, iterations=_GAPS) | filled
    if np.count_nonzero(binary_opening(closed)) <= _THIN * np.count_nonzero(closed):
        return None
    heights = gaussian_filter(closed.astype(np.float64), _SMOOTH)
    middles = [box[0, i] + size[i] * (np.arange(cells[i] + 2 * around) - around + 0.5) for i in (0, 1)]
    return middles[0], middles[1], heights


def thinned(points: Array, box: Array, cells: tuple[int, int]) -> Array:
    """Return one of the places (k, 2) in each square of a box, the first. (s, 2)."""
    at = _squares(points, box, cells)
    _, first = np.unique(at[:, 1] * cells[0] + at[:, 0], return_index=True)
    some: Array = points[np.sort(first)]
    return some


def _squares(points: Array, box: Array, cells: tuple[int, int]) -> NDArray[np.int64]:
    """Return to the how manieth square to the right and up each place belongs, those at the rim to the last."""
    at = np.floor((points - box[0]) / (box[1] - box[0]) * cells).astype(np.int64)
    inside: NDArray[np.int64] = np.clip(at, 0, np.array(cells) - 1)
    return inside
