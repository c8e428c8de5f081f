"""All branches of inverse kinematics: closed solutions where the arm's class has them, restarts in any case."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.inverse.aim import REACHED, Aim
from kinetostat.analysis.inverse.analytic import ClosedForm, closed_form
from kinetostat.analysis.inverse.damped import descend, solve
from kinetostat.analysis.task import FULL
from kinetostat.conventions import Array

__all__ = ["Branches", "branches"]

_SAME = 1e-4  # rad or L: ends so near are one solution; at a double root descents end that far apart
_STARTS, _ROUNDS = 200, 5
_LISTED = 8  # of infinitely many, and how far they are apart at least
_APART = 0.5  # rad or L
_RANK = 1e-7


@dataclass(frozen=True)
class Branches:
    """The distinct solutions that were found, angles within a turn.

    Attributes:
        q: coordinates (k, n).
        how: by what they were found, in words.
        complete: whether the list is complete.
        endless: whether there are infinitely many, so that the list holds examples.
        why: why it is, or is not, in words.
        starts: how many descents looked for them.
    """

    q: Array
    how: str
    complete: bool
    endless: bool
    why: str
    starts: int


def branches(aim: Aim, target: Array, generator: np.random.Generator) -> Branches:
    """Return the distinct solutions for a target (4, 4), limits left out: they are told apart afterwards.

    Of infinitely many, a few examples that are well apart, inside limits where there are some.
    """
    count, rows = len(aim.joints.names), len(aim.task.rows)
    if count > rows:
        found, starts = _examples(aim, target, generator)
        why = f"{count} joints for {rows} rows; examples at least {_APART:g} rad apart"
        return Branches(found, f"{starts} random starts", complete=False, endless=True, why=why, starts=starts)
    form = closed_form(aim.joints) if rows == len(FULL.rows) else "only some rows count"
    found, hits, starts = _by_restarts(aim, target, generator)
    if _endless(aim, found, target):
        why = f"joints move with the tool at rest; examples at least {_APART:g} rad apart"
        examples = _apart(aim, found)
        return Branches(examples, f"{starts} random starts", complete=False, endless=True, why=why, starts=starts)
    if not isinstance(form, ClosedForm):
        once = int(np.sum(hits == 1))
        why = f"random starts prove nothing ({form}); {once} of {len(found)} were found only once"
        return Branches(found, f"{starts} random starts", complete=False, endless=False, why=why, starts=starts)
    exact = _distinct(aim, _polished(aim, form.candidates(target), target))
    missed = [q for q in found if not any(_same(aim, q, other) for other in exact)]
    why = f"closed solution, and {starts} random starts found no other"
    if missed:
        why = f"{starts} random starts found {len(missed)} that the closed solution does not have"
    whole = np.array([*exact, *missed]).reshape(-1, count)
    how = f"closed solution (EAIK, {form.family})"
    return Branches(whole, how, complete=not missed, endless=False, why=why, starts=starts)


def _by_restarts(aim: Aim, target: Array, generator: np.random.Generator) -> tuple[Array, Array, int]:
    """Return the distinct ends of descents from random starts, how often each was found, and how many starts."""
    kept, hits, starts = list[Array](), list[int](), 0
    for _ in range(_ROUNDS):
        drawn = aim.joints.draw(generator, (_STARTS,))
        ends, size, _ = descend(aim, drawn, np.broadcast_to(target, (_STARTS, 4, 4)), limited=False)
        starts, before = starts + _STARTS, len(kept)
        for q in aim.joints.wrapped(ends[size < REACHED]):
            place = next((i for i, other in enumerate(kept) if _same(aim, q, other)), None)
            if place is None:
                kept.append(q)
                hits.append(1)
            else:
                hits[place] += 1
        if len(kept) == before or len(kept) > _STARTS / 2:  # no news, or one after another
            break
    return np.array(kept).reshape(-1, len(aim.joints.names)), np.array(hits, dtype=int), starts


def _polished(aim: Aim, candidates: Array, target: Array) -> Array:
    """Return the candidates that reach the target, to the last digits; a file that rounds is not quite of its class."""
    if not len(candidates):
        return np.zeros((0, len(aim.joints.names)))
    ends, size, _ = descend(aim, candidates, np.broadcast_to(target, (len(candidates), 4, 4)), limited=False)
    return aim.joints.wrapped(ends[size < REACHED])


def _distinct(aim: Aim, found: Array) -> list[Array]:
    kept = list[Array]()
    for q in found:
        if not any(_same(aim, q, other) for other in kept):
            kept.append(q)
    return kept


def _same(aim: Aim, a: Array, b: Array) -> bool:
    return bool(np.max(np.abs(aim.joints.wrapped(a - b) / aim.units)) < _SAME)


def _endless(aim: Aim, found: Array, target: Array) -> bool:
    """Return whether solutions that are too many to be isolated lie where the arm is singular."""
    if len(found) <= _STARTS / 2:
        return False
    _, slope = aim.linear(found, np.broadcast_to(target, (len(found), 4, 4)))
    return bool(np.median(np.linalg.svd(slope, compute_uv=False)[..., -1]) < _RANK)


def _examples(aim: Aim, target: Array, generator: np.random.Generator) -> tuple[Array, int]:
    """Return solutions of a redundant arm that are well apart, inside limits where any is; and how many starts."""
    targets = np.broadcast_to(target, (_STARTS, 4, 4))
    q, size, _ = solve(aim, aim.joints.draw(generator, (_STARTS,), limited=True), targets, generator, tries=1)
    inside = q[size < REACHED]
    if len(inside):
        return _apart(aim, aim.joints.wrapped(inside)), _STARTS
    ends, size, _ = descend(aim, aim.joints.draw(generator, (_STARTS,)), targets, limited=False)
    return _apart(aim, aim.joints.wrapped(ends[size < REACHED])), 2 * _STARTS


def _apart(aim: Aim, found: Array) -> Array:
    """Return a few of many that are well apart."""
    kept = list[Array]()
    for q in found:
        if len(kept) < _LISTED and all(np.max(np.abs(aim.joints.wrapped(q - o) / aim.units)) > _APART for o in kept):
            kept.append(q)
    return np.array(kept).reshape(-1, len(aim.joints.names))
