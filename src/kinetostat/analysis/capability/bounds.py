"""Bounds of a chain that hold for every configuration inside limits: where its tool is, how large its Jacobian."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinetostat.conventions import Array
from kinetostat.screw.chain import Chain
from kinetostat.screw.kernel import Kernel

__all__ = ["Bounds", "bounds"]

_STRAIGHT = 1e-12  # |w| of a screw that slides


@dataclass(frozen=True)
class Bounds:
    """What no configuration exceeds.

    Attributes:
        low: least coordinates of the tool in the observer's axes, (3,), m.
        high: greatest ones, (3,), m.
        jacobian: a bound of the weighed Jacobian's Frobenius norm, and so of each singular value.
    """

    low: Array
    high: Array
    jacobian: float


def bounds(kernel: Kernel, lower: Array, upper: Array) -> Bounds:
    """Return bounds for coordinates between two ends, (n,) each.

    The tool is in a ball about a point of the first axis: each joint that turns keeps the distance from any point of
    its axis, so the radius is the length of a path from the tool to the foot of its perpendicular on the last axis,
    from there to the axis before, and so on, with what slides and pitches add. Slides before every turn make the
    ball's box longer instead. A column of the Jacobian is no longer than such a path.
    """
    chain = kernel.chain
    travel = _travel(chain, lower, upper)
    linear, angular = chain.screws[:3].T, chain.screws[3:].T
    turns = np.linalg.norm(angular, axis=-1) > _STRAIGHT
    first_turn = int(np.argmax(turns)) if np.any(turns) else len(turns)
    point, radius = chain.home[:3, 3], 0.0
    low, high, longest = np.zeros(3), np.zeros(3), np.zeros(len(turns))
    for i in reversed(range(len(turns))):
        v, w, far = linear[i], angular[i], float(np.max(np.abs(travel[:, i])))
        if turns[i]:
            pitch, on_axis = float(v @ w), np.cross(w, v)
            foot = on_axis + w * float(w @ (point - on_axis))
            radius += float(np.linalg.norm(point - foot))
            longest[i] = radius + abs(pitch)
            radius, point = radius + abs(pitch) * far, foot
        else:
            longest[i] = float(np.linalg.norm(v))
            if i < first_turn:
                shifts = travel[:, i, None] * v
                low, high = low + np.min(shifts, axis=0), high + np.max(shifts, axis=0)
            else:
                radius += longest[i] * far
    return Bounds(point + low - radius, point + high + radius, _jacobian_bound(kernel, longest, turns))


def _travel(chain: Chain, lower: Array, upper: Array) -> Array:
    """Return the least and the greatest position of each screw, (2, k)."""
    up, down = np.maximum(chain.fold, 0.0), np.minimum(chain.fold, 0.0)
    return np.stack([up @ lower + down @ upper, up @ upper + down @ lower]) + chain.offset


def _jacobian_bound(kernel: Kernel, longest: Array, turns: Array) -> float:
    """Return a bound of the Frobenius norm, from a bound of each screw's linear part, (k,)."""
    rows = np.ones(6) if kernel.row_factors is None else np.abs(kernel.row_factors)
    columns = 1.0 if kernel.column_factors is None else np.abs(kernel.column_factors)
    screws = np.hypot(longest * np.max(rows[:3]), turns * np.max(rows[3:]))
    return float(np.linalg.norm(screws @ np.abs(kernel.chain.fold) * columns))
