"""Stretches of a trajectory: maximal runs of samples that have something in common; and their worst samples."""

from __future__ import annotations

import numpy as np

from kinetostat.conventions import Array, Flags

__all__ = ["first_largest", "runs"]

_ROUNDING = 1e-9  # of a value: what differs by less is the same
_NOISE = 1e-12  # of the largest of all: what is left of a zero


def runs(flags: Flags) -> list[tuple[int, int]]:
    """Return the first and the last index of each maximal run of True. (m,)."""
    edges = np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1
    return list(zip(starts.tolist(), ends.tolist(), strict=True))


def first_largest(values: Array) -> int:
    """Return the first index whose value is the largest within rounding; of NaN alone, 0. (m,)."""
    known = values[np.isfinite(values)]
    if not len(known):
        return 0
    largest = float(np.max(known))
    slack = _ROUNDING * abs(largest) + _NOISE * float(np.max(np.abs(known)))
    return int(np.argmax(values >= largest - slack))
