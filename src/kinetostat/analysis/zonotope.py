"""Zonotopes {sum_j t_j A_j, |t_j| <= 1}: their farthest vertex. Pure mathematics on arrays."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kinetostat.conventions import Array

__all__ = ["farthest", "tried_whole"]

MOST_EXACT = 20  # columns of which all sign patterns are tried
_AT_ONCE = 2**22  # numbers of one go at them


def _moving_columns(columns: Array) -> list[int]:
    """Return where some configuration has a column that is not zero."""
    return [int(i) for i in np.flatnonzero(np.any(columns != 0, axis=tuple(range(columns.ndim - 1))))]


def tried_whole(columns: Array) -> bool:
    """Return whether `farthest` tries all patterns: for up to 20 columns that are not zero."""
    return len(_moving_columns(columns)) <= MOST_EXACT


def farthest(columns: Array) -> Array:
    """Return the signs s for which sum_j s_j A_j is longest: the farthest vertex of the zonotope of the columns.

    All patterns are tried, of s and -s one alone, in goes of a size that memory allows; of equal ones the first counts.
    Beyond 20 columns a pattern is found by ascent, from the longest axis of the ellipsoid: s = sign(A^T A s).
    (..., m, n) -> (..., n), +1 or -1; the first +1.
    """
    kept = _moving_columns(columns)
    signs = np.ones((*columns.shape[:-2], columns.shape[-1]))
    if len(kept) < 2:
        return signs
    some = columns[..., kept]
    signs[..., kept] = _tried(some) if len(kept) <= MOST_EXACT else _ascended(some)
    return signs


def _tried(columns: Array) -> Array:
    """Return the best of all sign patterns. (..., m, n) -> (..., n)."""
    count = columns.shape[-1]
    best = np.full(columns.shape[:-2], -1.0)
    codes = np.zeros(columns.shape[:-2], dtype=np.int64)
    patterns = 2 ** (count - 1)
    go = max(1, _AT_ONCE // max(count, columns[..., 0].size))
    for start in range(0, patterns, go):
        some = np.arange(start, min(start + go, patterns))
        lengths = np.sum((columns @ _pattern(some, count).T) ** 2, axis=-2)
        longest = np.argmax(lengths, axis=-1)
        found = np.take_along_axis(lengths, longest[..., None], -1)[..., 0]
        codes = np.where(found > best, some[longest], codes)
        best = np.maximum(best, found)
    return _pattern(codes, count)


def _pattern(codes: npt.NDArray[np.int64], count: int) -> Array:
    """Return the sign patterns of numbers 0 ... 2^(count-1) - 1, the first sign being +1. (...) -> (..., count)."""
    bits = (codes[..., None] >> np.arange(count - 1)) & 1
    return np.concatenate([np.ones((*codes.shape, 1)), 1.0 - 2.0 * bits], -1)


def _ascended(columns: Array) -> Array:
    """Return a pattern that no step s = sign(A^T A s) makes longer. (..., m, n) -> (..., n)."""
    toward = np.linalg.svd(columns)[0][..., 0]
    for _ in range(columns.shape[-1]):
        along = np.einsum("...r,...rj->...j", toward, columns)
        signs = np.where(along < 0, -1.0, 1.0)
        toward = (columns @ signs[..., None])[..., 0]
    return signs * signs[..., :1]
