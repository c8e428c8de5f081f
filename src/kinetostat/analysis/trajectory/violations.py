"""Where a trajectory asks more of a joint than its limits allow: of position, velocity or effort."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.trajectory.spans import first_largest, runs
from kinetostat.conventions import Array, Flags

__all__ = ["Violation", "violations"]

_SLACK = 1e-9  # of a limit: what rounding alone may exceed


@dataclass(frozen=True)
class Violation:
    """A stretch in which a joint is beyond a limit.

    Attributes:
        joint: which coordinate.
        kind: position, velocity or effort.
        first: its first sample, from 0; of a velocity, the one before the first step that is too fast.
        last: its last sample; of a velocity, the one after the last such step.
        worst: the first sample that is farthest beyond; of a velocity, the one after the fastest step.
        value: what the joint has there, with its sign.
        limit: what it may have in that direction.
        excess: how far beyond that is, positive.
        unit: of the three.
    """

    joint: str
    kind: str
    first: int
    last: int
    worst: int
    value: float
    limit: float
    excess: float
    unit: str


def violations(
    joints: Coordinates, q: Array, mean_rates: Array | None, speeds: Array, torque: Array | None, efforts: Array
) -> tuple[Violation, ...]:
    """Return all violations, those of positions first, then of velocities and efforts, in the order of time.

    A velocity is compared as the mean over each step between samples, which the joint has at some moment of it: a jump
    cannot hide between samples.

    Args:
        joints: the n joints.
        q: (m, n), rad and m.
        mean_rates: (m - 1, n), or None without time.
        speeds: velocity limits, NaN for none. (n,).
        torque: holding torques (m, n), or None.
        efforts: lower and upper limits, NaN for none. (2, n).
    """
    found = list[Violation]()
    lengths = ["rad" if turns else "m" for turns in joints.turning]
    inside = joints.between(q)
    found += _beyond("position", joints, q, np.stack(joints.stated_limits), ~inside, lengths)
    if mean_rates is not None:
        limits, units = np.stack([-speeds, speeds]), [f"{unit}/s" for unit in lengths]
        fast = np.abs(mean_rates) > speeds * (1 + _SLACK)
        found += _beyond("velocity", joints, mean_rates, limits, fast, units, after=1)
    if torque is not None:
        units = ["Nm" if turns else "N" for turns in joints.turning]
        heavy = (torque < efforts[0] * (1 + _SLACK)) | (torque > efforts[1] * (1 + _SLACK))
        found += _beyond("effort", joints, torque, efforts, heavy, units)
    return tuple(found)


def _beyond(
    kind: str,
    joints: Coordinates,
    values: Array,
    limits: Array,
    flags: Flags,
    units: Sequence[str],
    after: int = 0,
) -> list[Violation]:
    """Return the runs of flags (m, n); `after` is how far behind its own number a value's last sample is."""
    found = list[Violation]()
    for j in np.flatnonzero(np.any(flags, axis=0)).tolist():
        column, (lower, upper) = values[:, j], limits[:, j]
        over = np.fmax(lower - column, column - upper)
        for first, last in runs(flags[:, j]):
            worst = first + first_largest(over[first : last + 1])
            value = float(column[worst])
            limit = float(lower if lower - value > value - upper else upper)
            excess = float(over[worst])
            span = first, last + after, worst + after
            found.append(Violation(joints.names[j], kind, *span, value, limit, excess, units[j]))
    return sorted(found, key=lambda one: (one.first, one.last))
