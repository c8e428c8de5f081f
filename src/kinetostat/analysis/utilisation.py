"""How much of their limits joints use, and which is nearest to its own."""

from __future__ import annotations

import numpy as np

from kinetostat.conventions import Array

__all__ = ["most_used"]


def most_used(shares: Array) -> Array:
    """Return the index of the largest share of a limit, -1 where no joint has one (NaN). (..., n) -> (...)."""
    if not shares.shape[-1]:
        return np.full(shares.shape[:-1], -1)
    return np.where(np.all(np.isnan(shares), -1), -1, np.argmax(np.nan_to_num(shares, nan=-1.0), -1))
