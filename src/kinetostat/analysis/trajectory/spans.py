"""Stretches of a trajectory: maximal runs of samples that have something in common."""

from __future__ import annotations

import numpy as np

from kinetostat.conventions import Flags

__all__ = ["runs"]


def runs(flags: Flags) -> list[tuple[int, int]]:
    """Return the first and the last index of each maximal run of True. (m,)."""
    edges = np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1
    return list(zip(starts.tolist(), ends.tolist(), strict=True))
