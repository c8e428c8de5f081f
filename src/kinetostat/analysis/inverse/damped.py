"""The robust solver: damped least squares, joint limits, and restarts, for many poses at once.

    dq = (J^T J + m |e|^2)^-1 J^T e        K. Levenberg, 1944; the damping is that of T. Sugihara, "Solvability-
                                           unconcerned inverse kinematics by the Levenberg-Marquardt method", IEEE
                                           Trans. Robotics 27(5), 2011

A step that does not lessen the error is not taken, and the damping grows. Limits make local minima, so a descent is
first without them; if it ends outside, a second one starts at the limits that it crossed and stays inside.
"""

from __future__ import annotations

import numpy as np

from kinetostat.analysis.inverse.aim import REACHED, Aim
from kinetostat.conventions import Array, Flags

__all__ = ["descend", "solve", "solve_freely"]

_ITERATIONS = 30  # beyond them, a descent that is not near has most often stalled: a restart does better
_LONGER = 300  # for those that are near: at a singular configuration the last digits come slowly
_NEAR = 2e-2
_STUCK = 1e-11  # a step this short is the end
_LEAST, _MOST = 1e-6, 1e12  # of the factor of the damping
_FLOOR = 1e-14  # damping at least, as a share of the matrix itself
_PRECISE = 1e-14  # an error below it cannot be lessened
_SEED = 0
_AT_ONCE = 8, 64  # descents at least, at first and later, in a round: restarts of few poses are made side by side


def solve(
    aim: Aim, starts: Array, targets: Array, generator: np.random.Generator, tries: int
) -> tuple[Array, Array, Array]:
    """Return for each target a configuration inside limits that reaches it, or the nearest that was found.

    From the start that is given first, then from random ones inside limits, until it is reached or tried often enough.

    Args:
        aim: the chain and the rows that count.
        starts: where to begin, (N, n).
        targets: (N, 4, 4).
        generator: draws the restarts.
        tries: how many starts at most, for each target.

    Returns:
        coordinates (N, n) inside limits, the norm of the scaled error (N,), and iterations in all (N,).
    """
    q, size, iterations = _attempt(aim, starts, targets)
    tried, at_once = 1, _AT_ONCE[0]
    while tried < tries:
        missing = np.flatnonzero(size >= REACHED)
        if len(missing) == 0:
            break
        each = int(min(max(1, at_once // len(missing)), tries - tried))
        at_once = _AT_ONCE[1]
        drawn = aim.joints.draw(generator, (len(missing) * each,), limited=True)
        found, sizes, more = _attempt(aim, drawn, np.repeat(targets[missing], each, axis=0))
        found, sizes = found.reshape(len(missing), each, -1), sizes.reshape(len(missing), each)
        best = _nearest(aim, found, sizes, q[missing])
        rows = np.arange(len(missing))
        better = sizes[rows, best] < size[missing]
        q[missing[better]] = found[rows, best][better]
        size[missing[better]] = sizes[rows, best][better]
        iterations[missing] += more.reshape(len(missing), each).sum(axis=1)
        tried += each
    missing = np.flatnonzero(size >= REACHED)
    if len(missing):  # by how much it is missed is told to more digits than a try goes for
        q[missing], size[missing], more = descend(aim, q[missing], targets[missing], most=_LONGER)
        iterations[missing] += more
    return q, size, iterations


def solve_freely(aim: Aim, target: Array) -> bool:
    """Return whether some of many descents without limits reach a target (4, 4)."""
    drawn = aim.joints.draw(np.random.default_rng(_SEED), (_AT_ONCE[1],))
    _, size, _ = descend(aim, drawn, np.broadcast_to(target, (len(drawn), 4, 4)), limited=False)
    return bool(np.any(size < REACHED))


def _nearest(aim: Aim, found: Array, sizes: Array, origin: Array) -> Array:
    """Return which of the ends (N, k) to take: of those that reach the target the one nearest to where one was."""
    away = np.linalg.norm((found - origin[:, None]) / aim.units, axis=-1)
    reached = sizes < REACHED
    ranked = np.where(reached, away, np.inf)
    best: Array = np.where(np.any(reached, axis=1), np.argmin(ranked, axis=1), np.argmin(sizes, axis=1))
    return best


def _attempt(aim: Aim, starts: Array, targets: Array) -> tuple[Array, Array, Array]:
    """Descend without limits; where that ends outside them, on from there inside. Ends are inside limits."""
    lower, upper = aim.joints.stated_limits
    q, size, iterations = descend(aim, starts, targets, limited=False)
    q = aim.joints.near(q, starts)
    outside = np.flatnonzero(np.any((q < lower) | (q > upper), axis=-1))
    if len(outside):
        inside = np.clip(q[outside], lower, upper)
        q[outside], size[outside], more = descend(aim, inside, targets[outside], limited=True)
        iterations[outside] += more
    return q, size, iterations


def descend(
    aim: Aim, starts: Array, targets: Array, *, limited: bool = True, most: int = _ITERATIONS
) -> tuple[Array, Array, Array]:
    """Return where the descent from each start ends, its error, and how many iterations it took.

    Args:
        aim: the chain and the rows that count.
        starts: coordinates (N, n); inside limits, if those count.
        targets: (N, 4, 4).
        limited: whether joints stay inside their limits.
        most: how many iterations at most, of those that are not near.

    Returns:
        coordinates (N, n), the norm of the scaled error (N,), iterations (N,).
    """
    q = np.array(starts, dtype=np.float64)
    lower, upper = aim.joints.stated_limits if limited else (np.array(-np.inf), np.array(np.inf))
    factor, iterations = np.full(len(q), 1e-2), np.zeros(len(q), dtype=int)
    error, slope = aim.linear(q, targets)
    size = np.linalg.norm(error, axis=-1)
    alive = size > _PRECISE
    for i in range(_LONGER):
        alive &= (i < most) | (size < _NEAR)
        open_ = np.flatnonzero(alive)
        if len(open_) == 0:
            break
        step = _step(q[open_], error[open_], slope[open_], factor[open_], lower, upper)
        tried = np.clip(q[open_] + step * aim.units, lower, upper)
        tried_error, tried_slope = aim.linear(tried, targets[open_])
        tried_size = np.linalg.norm(tried_error, axis=-1)
        better = tried_size < size[open_]
        taken = open_[better]
        moved = np.max(np.abs(tried - q[open_]) / aim.units, axis=-1)
        iterations[open_] += 1
        gain = tried_size < 0.5 * size[open_]
        q[taken], error[taken], slope[taken] = tried[better], tried_error[better], tried_slope[better]
        size[taken] = tried_size[better]
        factor[open_] = np.clip(factor[open_] * np.where(better, np.where(gain, 0.1, 0.5), 10.0), _LEAST, _MOST)
        # Far from the target a short step is a local minimum; near it, all that rounding lets do.
        done = (moved < _STUCK) | (size[open_] < _PRECISE) | ((size[open_] < REACHED) & ~better)
        alive[open_[done]] = False
    return q, size, iterations


def _step(q: Array, error: Array, slope: Array, factor: Array, lower: Array, upper: Array) -> Array:
    """Return the damped step in units of coordinates, joints held that it would take beyond a limit. (N, n)."""
    held = np.zeros(q.shape, dtype=bool)
    damping = factor * np.minimum(np.sum(error**2, axis=-1), 1.0) + 1e-15
    step = _solved(slope, error, damping, held)
    pushed = ((q <= lower) & (step < 0)) | ((q >= upper) & (step > 0))
    if not np.any(pushed):
        return step
    return _solved(slope, error, damping, pushed)


def _solved(slope: Array, error: Array, damping: Array, held: Flags) -> Array:
    """Return J^T (J J^T + damping)^-1 e over the columns that are not held, which is (J^T J + damping)^-1 J^T e."""
    free = np.where(held[:, None, :], 0.0, slope)
    gram = free @ np.swapaxes(free, -1, -2)
    floor = _FLOOR * np.trace(gram, axis1=-2, axis2=-1)  # rows may be zero, or repeat each other
    gram += (damping + floor)[:, None, None] * np.eye(error.shape[-1])
    solved: Array = (np.swapaxes(free, -1, -2) @ np.linalg.solve(gram, error[..., None]))[..., 0]
    return solved
