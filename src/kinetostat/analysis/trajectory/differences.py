"""Rates and accelerations of samples, by finite differences on the time stamps as they are.

Differences, and no spline through all samples: a spline rings about a jump and would spread it over samples that have
no part in it. A jump stays where it is.
"""

from __future__ import annotations

import numpy as np

from kinetostat.conventions import Array

__all__ = ["accelerations", "mean_rates", "rates"]


def rates(time: Array, q: Array) -> Array:
    """Return dq/dt at each sample: the slope of the parabola through it and its two neighbours.

    With steps h before a sample and k after it, and the mean rates m and p over them, (k m + h p) / (h + k), of second
    order for uneven steps too; at both ends the slope of the first, the last, parabola there: m - h (p - m) / (h + k)
    (B. Fornberg, "Generation of finite difference formulas on arbitrarily spaced grids", 1988). Of two samples: m.

    Args:
        time: increasing, at least two, s. (m,).
        q: (m, n).
    """
    means, steps = mean_rates(time, q), np.diff(time)[:, None]
    if len(time) == 2:
        return np.concatenate([means, means])
    share = steps[:-1] / (steps[:-1] + steps[1:])  # h / (h + k)
    with np.errstate(invalid="ignore"):
        change = np.diff(means, axis=0)
    inner, start, end = means[:-1] + share * change, -share[0] * change[0], (1 - share[-1]) * change[-1]
    return np.concatenate([means[:1] + start, inner, means[-1:] + end])


def accelerations(time: Array, q: Array) -> Array:
    """Return d2q/dt2 at each sample: the curvature of the same parabola; NaN for less than three samples. (m, n)."""
    if len(time) < 3:
        return np.full(q.shape, np.nan)
    means = mean_rates(time, q)
    with np.errstate(over="ignore"):
        inner = np.diff(means, axis=0) / ((time[2:] - time[:-2]) / 2)[:, None]
    return np.concatenate([inner[:1], inner, inner[-1:]])


def mean_rates(time: Array, q: Array) -> Array:
    """Return the mean rate between each sample and the next: at some moment between, the rate is just that.

    (m,), (m, n) -> (m - 1, n).
    """
    with np.errstate(over="ignore"):  # a step too short for numbers: told by what is infinite
        steps: Array = np.diff(q, axis=0) / np.diff(time)[:, None]
    return steps
