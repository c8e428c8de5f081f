"""The nearest singular configuration: a first-order estimate, then a search that starts at the configuration.

Distances are in joint space: the root of the sum of squares of angles in rad, and of slides in units of L.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.singular.mechanism import STRICT, Mechanism
from kinetostat.analysis.singular.search import constraints, converge
from kinetostat.conventions import Array

__all__ = ["Nearest", "nearest"]

_STARTS = 96
_REFINED = 24  # of the singular configurations found, the nearest of which are drawn closer
_SEED = 3
_DUST = 1e-7  # rad or L


@dataclass(frozen=True)
class Nearest:
    """The nearest singular configuration that was found.

    Attributes:
        first_order: s_r / |grad s_r|, the distance if s_r went on falling as it does here; infinite where it does not.
        distance: joint-space distance to `q`, rad (slides in units of L); None if none was found.
        q: its coordinates (n,), or None.
        inside_limits: whether it is inside joint limits; None if none was found.
        inside: the nearest that was found inside joint limits, if that is another one: its distance and coordinates.
    """

    first_order: float
    distance: float | None
    q: Array | None
    inside_limits: bool | None
    inside: tuple[float, Array] | None = None


def nearest(mechanism: Mechanism, q: Array, known: tuple[tuple[int, float], ...] = ()) -> Nearest:
    """Return the nearest singular configuration that a search from q and from around it finds.

    It is an upper bound: a nearer one is not excluded.

    Args:
        mechanism: the chain and its task.
        q: coordinates (n,).
        known: (index, position) of single-joint families, whose nearest points are exact.
    """
    first_order = _first_order(mechanism, q)
    generator = np.random.default_rng(_SEED)
    radii = np.geomspace(0.05, 2.0, _STARTS)[:, None]
    around = q + radii * mechanism.units * generator.normal(size=(_STARTS, len(q))) / np.sqrt(len(q))
    found, smallest = converge(mechanism, np.concatenate([q[None], around]))
    candidates = [q + mechanism.difference(x, q) * mechanism.units for x in found[smallest < STRICT]]
    candidates.sort(key=lambda x: _away(mechanism, x, q))
    closer = [_drawn_closer(mechanism, x, q) for x in _spread_out(mechanism, candidates)]
    for index, position in known:
        target = q.copy()
        target[index] = position
        closer.append(q + mechanism.difference(target, q) * mechanism.units)
    if not closer:
        return Nearest(first_order, None, None, None)
    best, *others = sorted((_undusted(mechanism, x, q) for x in closer), key=lambda x: _away(mechanism, x, q))
    if mechanism.within(best):
        return Nearest(first_order, _away(mechanism, best, q), best, True)
    reachable = next((x for x in others if mechanism.within(x)), None)
    inside = None if reachable is None else (_away(mechanism, reachable, q), reachable)
    return Nearest(first_order, _away(mechanism, best, q), best, False, inside)


def _undusted(mechanism: Mechanism, x: Array, q: Array) -> Array:
    """Return a singular configuration with what differs from q, or from zero, by rounding alone set to that."""
    clean = np.where(np.abs(x - q) < _DUST * mechanism.units, q, x)
    clean = np.where(np.abs(clean) < _DUST * mechanism.units, 0.0, clean)
    return clean if float(mechanism.smallest(clean)) < STRICT else x


def _spread_out(mechanism: Mechanism, candidates: list[Array]) -> list[Array]:
    """Return the first candidates, and the first that are inside limits."""
    reachable = [x for x in candidates if mechanism.within(x)]
    return candidates[:_REFINED] + reachable[:_REFINED]


def _away(mechanism: Mechanism, a: Array, b: Array) -> float:
    return float(np.linalg.norm((a - b) / mechanism.units))


def _first_order(mechanism: Mechanism, q: Array) -> float:
    """Return s_r / |grad s_r|, with ds_r/dq_j = u^T (dJ/dq_j) v."""
    matrix, along = mechanism.derivatives(q)
    left, values, right = np.linalg.svd(matrix)
    at = mechanism.generic_rank - 1
    gradient = np.einsum("r,rij,i->j", left[:, at], along, right[at])
    size = float(np.linalg.norm(gradient))
    return float(values[at]) / size if size > STRICT else float("inf")


def _drawn_closer(mechanism: Mechanism, start: Array, q: Array) -> Array:
    """Return a singular configuration near `start` that is as near to q as its surroundings allow.

    Gauss-Newton on the constraints, always taking the point of the linearised set that is nearest to q.
    """
    best, x = start, start
    for _ in range(30):
        value, gradients = constraints(mechanism, x)
        away = (q - x) / mechanism.units
        step = away - np.linalg.pinv(gradients, rcond=1e-6) @ (value + gradients @ away)
        size = float(np.linalg.norm(step))
        x = x + step * min(1.0, 0.3 / max(size, 1e-300)) * mechanism.units
        if size < 1e-12:
            break
    settled, smallest = converge(mechanism, x[None])
    closer = _away(mechanism, settled[0], q) < _away(mechanism, best, q)
    return settled[0] if smallest[0] < STRICT and closer else best
