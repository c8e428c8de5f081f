"""The configurations of a sample at which each of a robot's torques is worst."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from kinetostat.conventions import Array
from kinetostat.screw.chain import Chain
from kinetostat.screw.kernel import Kernel
from kinetostat.screw.tree import Tree

__all__ = ["Torques", "compiled_torques", "worst_samples"]

_CHUNK = 16384  # configurations whose torques are there at once

Torques = Callable[[Array], Array]  # of coordinates (m, n): (m, n)


def worst_samples(torques: Torques, q: Array, count: int) -> tuple[npt.NDArray[np.intp], Array]:
    """Return the rows of a sample at which each torque is worst, the worst first, and the torques there.

    Args:
        torques: (m, n) of coordinates (m, n).
        q: coordinates (N, n).
        count: how many rows are kept for each torque.

    Returns:
        rows (n, k) and signed torques (n, k), k being `count` or N.
    """
    n = q.shape[1]
    rows, values = np.empty((n, 0), dtype=np.intp), np.empty((n, 0))
    for first in range(0, len(q), _CHUNK):
        found = torques(q[first : first + _CHUNK]).T
        here = np.broadcast_to(np.arange(first, first + found.shape[1]), found.shape)
        rows, values = np.concatenate([rows, here], axis=1), np.concatenate([values, found], axis=1)
        if rows.shape[1] > count:
            kept = np.argpartition(-np.abs(values), count - 1, axis=1)[:, :count]
            rows, values = np.take_along_axis(rows, kept, axis=1), np.take_along_axis(values, kept, axis=1)
    order = np.lexsort((rows, -np.abs(values)), axis=1)
    return np.take_along_axis(rows, order, axis=1), np.take_along_axis(values, order, axis=1)


def compiled_torques(tree: Tree, gravity: Array) -> Torques:
    """Return the torques that hold a tree's masses still, by compiled code."""
    n = tree.fold.shape[1]
    nowhere = Chain(np.zeros((6, 0)), np.eye(4), np.zeros((0, n)), np.zeros(0))
    kernel = Kernel(nowhere, ("gravity_torque",), tree=tree, gravity=gravity)
    return lambda q: kernel(q)["gravity_torque"]
