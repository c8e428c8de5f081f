"""The best and worst moments of a trajectory, measure by measure."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kinetostat.analysis.indices import powered
from kinetostat.analysis.trajectory.near import NOISE
from kinetostat.analysis.trajectory.spans import first_largest
from kinetostat.analysis.trajectory.trajectory import Trajectory
from kinetostat.conventions import Array, Flags

__all__ = ["Extreme", "extremes"]


@dataclass(frozen=True)
class Extreme:
    """The smallest, or the largest, value of a measure.

    Attributes:
        measure: its name.
        largest: whether it is the largest.
        value: in `unit`; shares of a limit are 1 where all of it is used.
        unit: 1 for a pure number.
        sample: where first, from 0.
        joint: which joint's it is, where it is a joint's.
    """

    measure: str
    largest: bool
    value: float
    unit: str
    sample: int
    joint: str | None = None


def extremes(result: Trajectory) -> tuple[Extreme, ...]:
    """Return the worst value of each measure that a trajectory has: the smallest index, the largest speed and use."""
    arm, names = result.mechanism, result.columns
    unit, product = result.unit, powered(result.unit, arm.generic_rank)
    regular = result.inverse_condition_number > NOISE
    found = [
        _least("yoshikawa", result.yoshikawa, product, regular),
        _least("minimum_singular_value", result.minimum_singular_value, unit, regular),
        _least("inverse_condition_number", result.inverse_condition_number, "1", regular),
        *_nearest_limit(result),
    ]
    if result.tool_speed is not None and result.turning_speed is not None:
        found.append(_most("tool_speed", result.tool_speed, "m/s"))
        found.append(_most("turning_speed", result.turning_speed, "rad/s"))
    if result.speed_use is not None:
        found += _of_joint("speed_use", result.speed_use, names, after=1)
    if result.effort_use is not None:
        found += _of_joint("effort_use", result.effort_use, names)
    return tuple(found)


def _nearest_limit(result: Trajectory) -> list[Extreme]:
    """Return where a joint is nearest to a position limit, and which; nothing where no joint has two ends."""
    lower, upper = result.joints.stated_limits
    least = _least("limit_distance", result.at.limit_distance, "1")
    q, half = result.q[least.sample], (upper - lower) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        each = np.where(np.isfinite(half), np.minimum(q - lower, upper - q) / half, np.nan)
    return [] if np.all(np.isnan(each)) else [replace(least, joint=result.columns[int(np.nanargmin(each))])]


def _least(measure: str, values: Array, unit: str, regular: Flags | None = None) -> Extreme:
    """Return the smallest value; what is not `regular` is rounding that stands for zero. (m,)."""
    at = first_largest(-values if regular is None else -np.where(regular, values, 0.0))
    return Extreme(measure, False, float(values[at]), unit, at)


def _most(measure: str, values: Array, unit: str) -> Extreme:
    at = first_largest(values)
    return Extreme(measure, True, float(values[at]), unit, at)


def _of_joint(measure: str, shares: Array, names: tuple[str, ...], after: int = 0) -> list[Extreme]:
    """Return the largest share of a limit, (m, n), NaN for none; nothing where no joint has a limit."""
    if not shares.size or np.all(np.isnan(shares)):
        return []
    at, joint = np.unravel_index(first_largest(shares.ravel()), shares.shape)
    return [Extreme(measure, True, float(shares[at, joint]), "1", int(at) + after, names[joint])]
