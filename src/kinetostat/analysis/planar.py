"""Planar joints: an engine's columns are along a twist in the moved frame, a chain's coordinates are x, y, theta.

With v = R(theta)^T d(x, y)/dt, columns M by the engine's rates are M W by rates of the coordinates, W = 1 but for
planar joints.
"""

from __future__ import annotations

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.conventions import Array
from kinetostat.urdf.description import JointType

__all__ = ["by_coordinates", "planar_places", "rotated"]


def planar_places(coordinates: Coordinates) -> list[int]:
    """Return where coordinates of planar joints begin: x, then y, then theta."""
    found, j = list[int](), 0
    for joint in dict.fromkeys(coordinates.joints):
        if joint.type is JointType.PLANAR:
            found.append(j)
        j += joint.type.nq
    return found


def by_coordinates(columns: Array, q: Array, coordinates: Coordinates) -> Array:
    """Return columns by the engine's rates as those by rates of the coordinates. (k, ..., n), (k, n) -> (k, ..., n)."""
    found = columns.copy()
    for j in planar_places(coordinates):
        found[..., j : j + 2] = rotated(columns[..., j : j + 2], q[:, j + 2])
    return found


def rotated(pairs: Array, angle: Array) -> Array:
    """Return plane vectors turned. (k, ..., 2), (k,) -> (k, ..., 2)."""
    angle = angle.reshape(-1, *(1,) * (pairs.ndim - 2))
    c, s = np.cos(angle), np.sin(angle)
    x, y = pairs[..., 0], pairs[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], -1)
