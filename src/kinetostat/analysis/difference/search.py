"""The largest value of a smooth function over joint ranges: sampled, corners too, then climbed to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kinetostat.conventions import Array

__all__ = ["Largest", "Objective", "largest"]

Objective = Callable[[Array], tuple[Array, Array]]  # (m, n) -> values (m,) and gradients (m, n)

_CLIMBED = 48  # of the samples, the largest of which climb together
_POLISHED = 3  # of those, the highest of which are polished
_STEPS = 40
_LONGER, _SHORTER = 1.6, 0.35  # how a step grows where it climbs, and shrinks where it does not
_ITERATIONS = 60
_CONSTANT = 1e-9  # of the largest value: a function that varies less is the same everywhere
_ROUNDING = 1e-13


@dataclass(frozen=True)
class Largest:
    """The largest value that was found, where, and whether the function is the same everywhere. A lower bound."""

    value: float
    at: Array
    constant: bool


def largest(
    objective: Objective, lower: Array, upper: Array, samples: int, seed: int, also: Array | None = None
) -> Largest:
    """Return the largest value of a function inside a box.

    Random points, a quarter of them corners of the box, and the one nearest to zero. The best of them climb along the
    gradient, all at once; the highest are polished by a local maximiser inside the box (L-BFGS-B: C. Zhu, R. Byrd, P.
    Lu and J. Nocedal, 1997, by SciPy).

    Args:
        objective: values (m,) and gradients (m, n) at points (m, n).
        lower: lower ends (n,).
        upper: upper ends (n,).
        samples: how many random points.
        seed: the same seed gives the same points.
        also: further points (m, n), put into the box.
    """
    points = _points(lower, upper, samples, seed, also)
    values, _ = objective(points)
    first = int(np.argmax(values))
    best = Largest(float(values[first]), points[first], constant=_is_constant(values))
    if best.constant:
        return Largest(best.value, points[0], constant=True)
    values, points = _climbing(objective, points[np.argsort(-values, kind="stable")[:_CLIMBED]], lower, upper)
    for i in np.argsort(-values, kind="stable")[:_POLISHED]:
        value, at = _polished(objective, points[i], float(values[i]), lower, upper)
        if value > best.value:
            best = Largest(value, at, constant=False)
    return best


def _is_constant(values: Array) -> bool:
    top = float(np.max(values))
    return bool(top - float(np.min(values)) <= _CONSTANT * top + _ROUNDING)


def _points(lower: Array, upper: Array, samples: int, seed: int, also: Array | None) -> Array:
    """Return the points to look at, the one nearest to zero first. (m, n)."""
    generator, size = np.random.default_rng(seed), len(lower)
    drawn = lower + (upper - lower) * generator.random((samples, size))
    corners = np.where(generator.random((samples // 4, size)) < 0.5, lower, upper)
    home = np.clip(np.zeros((1, size)), lower, upper)
    given = [] if also is None else [np.clip(also, lower, upper)]
    return np.concatenate([home, *given, drawn[len(corners) :], corners])


def _climbing(objective: Objective, starts: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Return values and points after some steps along the gradient, each start with a step of its own."""
    points, spans = starts.copy(), upper - lower
    values, gradients = objective(points)
    steps = np.full(len(points), 0.1)
    for _ in range(_STEPS):
        inward = ~(((points <= lower) & (gradients < 0)) | ((points >= upper) & (gradients > 0)))
        along = np.where(inward, gradients * spans**2, 0.0)  # steepest, each range being one unit
        lengths = np.max(np.abs(along) / np.where(spans > 0, spans, 1.0), axis=-1, initial=0.0)
        tried = points + (steps / np.where(lengths > 0, lengths, 1.0))[:, None] * along
        tried = np.clip(tried, lower, upper)
        new, slopes = objective(tried)
        better = new > values
        points[better], values[better], gradients[better] = tried[better], new[better], slopes[better]
        steps *= np.where(better, _LONGER, _SHORTER)
    return values, points


def _polished(objective: Objective, start: Array, size: float, lower: Array, upper: Array) -> tuple[float, Array]:
    from scipy.optimize import minimize

    def descent(x: Array) -> tuple[float, Array]:
        values, gradients = objective(x[None])
        return -float(values[0]) / size, -gradients[0] / size

    options = {"maxiter": _ITERATIONS, "ftol": 1e-14, "gtol": 1e-10}
    bounds = list(zip(lower, upper, strict=True))
    found = minimize(descent, start, jac=True, method="L-BFGS-B", bounds=bounds, options=options)
    return -float(found.fun) * size, np.asarray(found.x, dtype=np.float64)
