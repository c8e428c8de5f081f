"""The textbook iterations, each step of which can be looked at: Newton-Raphson, and Jacobian inversion in two forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.inverse.aim import REACHED, Aim
from kinetostat.conventions import Array

__all__ = ["Step", "by_rates", "by_steps", "newton"]

_MOST = 100  # iterations of Newton-Raphson
_MOST_STEPS = 5000
_FAR = 1e6  # rad or L: a step beyond it is the end of an iteration that diverges
_RANK = 1e-9  # of the largest singular value: below it a direction is not inverted
_TICK = 0.05  # s
_GAIN = 1.0  # 1/s: the error fades as exp(-t)


@dataclass(frozen=True)
class Step:
    """One line of a trace.

    Attributes:
        q: coordinates (n,), rad and m.
        error: the norm of the scaled error there.
        change: the step to the next line, (n,), or the rates there, (n,) per s; None on the last line.
        time: s; None where steps have no time.
    """

    q: Array
    error: float
    change: Array | None
    time: float | None = None


def newton(aim: Aim, start: Array, target: Array) -> list[Step]:
    """Return the iterates of q <- q + J(q)^-1 e(q), no limits, no safeguard.

    I. Newton; J. Raphson. The pseudo-inverse stands for the inverse where J is not square.
    """
    return by_steps(aim, start, target, 1.0, most=_MOST)


def by_steps(aim: Aim, start: Array, target: Array, share: float, most: int = _MOST_STEPS) -> list[Step]:
    """Return the iterates of q <- q + f J(q)^+ e(q): steps for joints that are commanded by position.

    The error shrinks by 1 - f at each step, as far as J is the same all along it.

    Args:
        aim: the chain and the rows that count.
        start: coordinates (n,).
        target: (4, 4).
        share: f, in (0, 1].
        most: how many steps at most.
    """
    q, trace = np.array(start, dtype=np.float64), list[Step]()
    for _ in range(most):
        error, change = _inverted(aim, q, target)
        size = float(np.linalg.norm(error))
        if size < REACHED:
            return [*trace, Step(q, size, None)]
        trace.append(Step(q, size, share * change))
        if not np.max(np.abs(change / aim.units)) < _FAR:
            return [*trace, Step(q, size, None)]
        q = q + share * change
    return [*trace, Step(q, float(np.linalg.norm(aim.error(q[None], target)[0])), None)]


def by_rates(aim: Aim, start: Array, target: Array) -> list[Step]:
    """Return the path of dq/dt = k J(q)^+ e(q), k = 1/s: rates for joints that are commanded by velocity.

    Along it the error fades as exp(-k t) (D. Whitney, "Resolved motion rate control of manipulators and human
    prostheses", IEEE Trans. Man-Machine Systems 10(2), 1969). Integrated by the classical Runge-Kutta rule.
    """
    q, trace, time = np.array(start, dtype=np.float64), list[Step](), 0.0
    for _ in range(_MOST_STEPS):
        error, rates = _inverted(aim, q, target)
        size = float(np.linalg.norm(error))
        if size < REACHED or not np.max(np.abs(rates / aim.units)) < _FAR:
            return [*trace, Step(q, size, None, time)]
        trace.append(Step(q, size, _GAIN * rates, time))
        q, time = _advanced(lambda x: _GAIN * _inverted(aim, x, target)[1], q, _TICK), time + _TICK
    return [*trace, Step(q, float(np.linalg.norm(aim.error(q[None], target)[0])), None, time)]


def _inverted(aim: Aim, q: Array, target: Array) -> tuple[Array, Array]:
    """Return the scaled error, (m,), and J^+ e, (n,), in rad and m."""
    error, slope = aim.linear(q[None], target[None])
    change: Array = np.linalg.pinv(slope[0], rcond=_RANK) @ error[0] * aim.units
    return error[0], change


def _advanced(rates: Callable[[Array], Array], q: Array, tick: float) -> Array:
    """Return q after one step of the classical Runge-Kutta rule."""
    first = rates(q)
    second = rates(q + tick / 2 * first)
    third = rates(q + tick / 2 * second)
    fourth = rates(q + tick * third)
    after: Array = q + tick / 6 * (first + 2 * second + 2 * third + fourth)
    return after
