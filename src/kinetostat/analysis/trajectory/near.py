"""Where a trajectory comes near a singular configuration: from when to when, how near, why, and what it costs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from kinetostat.analysis.indices import inverse_condition_number
from kinetostat.analysis.singular.at import SingularAt, singular_at
from kinetostat.analysis.singular.mechanism import Mechanism
from kinetostat.analysis.trajectory.spans import first_largest, runs
from kinetostat.conventions import Array, Flags
from kinetostat.screw.kernel import Kernel

__all__ = ["MOST_CAUSES", "NOISE", "NearSpan", "near_spans"]

MOST_CAUSES = 20  # spans whose causes are sought: each takes a fifth of a second
NOISE = 1e-12  # s_r / s_1 that rounding leaves of zero
_ZERO = 1e-14  # a singular value that is rounding


@dataclass(frozen=True)
class NearSpan:
    """A stretch in which s_r / s_1 stays below the threshold.

    Attributes:
        first: its first sample, from 0.
        last: its last sample.
        worst: the first sample where s_r / s_1 is smallest.
        inverse_condition_number: s_r / s_1 there.
        minimum_singular_value: s_r there.
        cause: what is to be said of the nearest singular configuration; None if none was found, or where there are so
            many spans that this one's cause was not sought.
        distance: to it, in rad (slides in units of the arm's length); None as `cause`.
        sought: whether the cause was sought.
        speed: the tool's largest speed in the span, in the unit of `Trajectory.speed_unit`; None without time.
        needed: the joint rates that keep this speed at `worst` in the direction that is hardest there, v_r speed / s_r;
            infinite at a singular configuration. (c,). None without time.
    """

    first: int
    last: int
    worst: int
    inverse_condition_number: float
    minimum_singular_value: float
    cause: SingularAt | None
    distance: float | None
    sought: bool
    speed: float | None
    needed: Array | None


def near_spans(
    arm: Mechanism,
    tool: Kernel,
    q: Array,
    singular_values: Array,
    below: Flags,
    speeds: Array | None,
    whole: Array,
    asked: dict[str, Any],
    progress: Callable[[int], None] | None = None,
) -> tuple[NearSpan, ...]:
    """Return the stretches of flagged samples, in their order, with their causes.

    Args:
        arm: the chain and its task.
        tool: its kernel, which weighs the rows and columns.
        q: the coordinates of the chain, (m, c).
        singular_values: (m, k).
        below: which samples are near. (m,).
        speeds: the tool's speed at every sample, or None. (m,).
        whole: configurations of the whole robot, (m, nq).
        asked: what `singular_at` is to be asked of the task.
        progress: told how many causes are found.
    """
    rank = arm.generic_rank
    smallest = inverse_condition_number(singular_values[:, :rank])
    depth = -np.where(smallest > NOISE, smallest, 0.0)
    found = [(first, last, first + first_largest(depth[first : last + 1])) for first, last in runs(below)]
    deepest = sorted(range(len(found)), key=lambda i: float(smallest[found[i][2]]))[:MOST_CAUSES]
    spans = list[NearSpan]()
    for i, (first, last, worst) in enumerate(found):
        cause, distance = _cause(arm, whole[worst], asked) if i in deepest else (None, None)
        if progress is not None and i in deepest:
            progress(i)
        speed = None if speeds is None else float(np.max(speeds[first : last + 1]))
        spans.append(
            NearSpan(
                first,
                last,
                worst,
                float(smallest[worst]),
                float(singular_values[worst, rank - 1]),
                cause,
                distance,
                i in deepest,
                speed,
                None if speed is None else _needed(tool, q[worst], rank, speed),
            )
        )
    return tuple(spans)


def _cause(arm: Mechanism, q: Array, asked: dict[str, Any]) -> tuple[SingularAt | None, float | None]:
    """Return what is to be said of the singular configuration that is nearest to q, (nq,), and its distance."""
    here = singular_at(arm.model, arm.velocity.of, q, **asked)
    if here.singular:
        return here, 0.0
    if here.distance.q is None:
        return None, None
    there = singular_at(arm.model, arm.velocity.of, arm.configuration(here.distance.q, q), **asked)
    return (there if there.singular else None), here.distance.distance


def _needed(tool: Kernel, q: Array, rank: int, speed: float) -> Array:
    """Return the joint rates that move the tool at a speed in its hardest direction, (c,).

    With M = diag(a) J diag(b) = U diag(s) V^T: qdot = diag(b) v_r |a V| / s_r. Lengths that are divided by L stay so:
    a speed in m/s is one in L/s times L.
    """
    if speed == 0:
        return np.zeros(tool.chain.fold.shape[1])
    length = 1.0 if tool.row_factors is None else 1 / float(tool.row_factors[0])
    matrix = tool.weighed(tool.chain.jacobian(q, local=tool.local))
    _, values, right = np.linalg.svd(matrix)
    along = right[rank - 1]
    if values[rank - 1] <= _ZERO * max(1.0, float(values[0])):
        return np.where(np.abs(along) > _ZERO, np.copysign(np.inf, along), 0.0)
    factors = np.ones(len(along)) if tool.column_factors is None else tool.column_factors
    needed: Array = factors * along * speed / length / values[rank - 1]
    return needed
