"""Families: which joints' positions make an arm singular, whatever the others do.

A singular set is a union of families. *Freeze test*: the positions of some joints are kept and the others drawn at
random; if the arm stays singular, those joints make the family. One or two joints with positions of their own are a
condition that can be written down ("joint3 = 0"). What is left are surfaces: they are told by their support, the joints
of which each one alone can leave the surface, and by their codimension, from the gradients of the reciprocal system.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np

from kinetostat.analysis.singular.mechanism import MODEL, STRICT, Mechanism
from kinetostat.analysis.singular.search import constraints
from kinetostat.conventions import Array, Flags

__all__ = ["Group", "angle_between", "grouped", "held_sets", "on_group"]

_DRAWS = 16
_MANY_DRAWS = 512  # enough that arms which are nearly singular there do not pass by chance
_CHUNK = 16  # configurations that are tried for sets before what they explain is taken out
_APART = 1e-3  # rad or L: positions of one family differ by less
_EXACT = 10 * STRICT
_SHARED = 1e-5  # rad or m: a window in which positions that many share must lie
_SHARE = 0.02  # how many are many
_ROUNDED = 1e-3  # rad or m: positions so close to one that many share are that one, but for rounding
_SAME = 1e-8  # rad or m: and those that differ by less are one in exact numbers
_FEWEST = 4  # configurations that share one
_INDEPENDENT = 1e-5  # singular value of gradients below which they are dependent


@dataclass(frozen=True)
class Group:
    """Singular configurations that have one condition.

    Attributes:
        held: indices of the joints that have one position in all of them.
        positions: those positions, in rad or m.
        support: indices of the joints that the condition is about: `held`, or more for a surface.
        codimension: how many independent equations it is.
        exact: whether it holds in exact numbers; else only to the model tolerance.
        members: the configurations that were found, (k, n).
    """

    held: tuple[int, ...]
    positions: tuple[float, ...]
    support: tuple[int, ...]
    codimension: int
    exact: bool
    members: Array

    @property
    def implicit(self) -> bool:
        """Whether held positions alone do not make the arm singular: a surface."""
        return self.held != self.support


def angle_between(mechanism: Mechanism, a: Array, b: Array) -> Array:
    """Return a - b in coordinate units, angles by the shorter way round. (..., n), (..., n) -> (..., n)."""
    gap = np.asarray(a) - np.asarray(b)
    turned = np.remainder(gap + math.pi, 2 * math.pi) - math.pi
    return np.where(mechanism.turning, turned, gap / mechanism.units)


def held_sets(mechanism: Mechanism, q: Array, size: int, generator: np.random.Generator) -> list[list[tuple[int, ...]]]:
    """Return for each configuration (N, n) the sets of so many joints that keep it singular by themselves."""
    sets = list(combinations(range(len(mechanism.names)), size))
    found: list[list[tuple[int, ...]]] = [[] for _ in q]
    if not sets or not len(q):
        return found
    masks = np.array([[i in chosen for i in range(q.shape[-1])] for chosen in sets])
    screened = _stay(mechanism, q[:, None, :], masks, 1, generator)
    for which, chosen in zip(*np.nonzero(screened), strict=True):
        if _stays_held(mechanism, q[which], sets[chosen], generator):
            found[which].append(sets[chosen])
    return found


def _stays_held(mechanism: Mechanism, q: Array, held: tuple[int, ...], generator: np.random.Generator) -> bool:
    """Return whether one configuration (n,) stays singular with some joints held, beyond chance."""
    mask = np.isin(np.arange(q.shape[-1]), held)
    return all(bool(_stay(mechanism, q, mask, draws, generator)) for draws in (_DRAWS, _MANY_DRAWS))


def _stay(mechanism: Mechanism, q: Array, masks: Flags, draws: int, generator: np.random.Generator) -> Flags:
    """Return whether configurations stay singular with the masked joints held and the others drawn anew."""
    shape = np.broadcast_shapes(q.shape, masks.shape)
    drawn = mechanism.draw(generator, (draws, *shape[:-1]))
    stay: Flags = np.all(mechanism.smallest(np.where(masks, q, drawn)) < MODEL, axis=0)
    return stay


def on_group(mechanism: Mechanism, group: Group, q: Array) -> Flags:
    """Return which configurations (N, n) have the held positions of a group. (N,)."""
    target = np.zeros(q.shape[-1])
    target[list(group.held)] = group.positions
    gap = np.abs(angle_between(mechanism, q, target))[..., list(group.held)]
    near: Flags = np.all(gap < _APART, axis=-1) & bool(group.held)
    return near


def group_of(mechanism: Mechanism, held: tuple[int, ...], positions: Array, generator: np.random.Generator) -> Group:
    """Return the group of some held positions, at a quarter turn where that is as singular."""
    q = mechanism.draw(generator, (_DRAWS,))

    def worst(candidate: Array) -> float:
        q[:, list(held)] = candidate
        return float(np.max(mechanism.smallest(q)))

    turning = np.array(mechanism.turning)[list(held)]
    wrapped = np.where(turning, math.pi - np.remainder(math.pi - positions, 2 * math.pi), positions)
    quarter = math.pi / 2
    near = turning & (np.abs(wrapped - quarter * np.round(wrapped / quarter)) < _APART)
    snapped = np.where(near, quarter * np.round(wrapped / quarter), wrapped)
    snapped = np.where(turning & (snapped <= -math.pi), math.pi, snapped)
    taken = snapped if worst(snapped) <= max(worst(wrapped), STRICT) else wrapped
    exact = worst(taken) < _EXACT
    return Group(held, tuple(float(p) + 0.0 for p in taken), held, len(held), exact, np.empty((0, q.shape[-1])))


def grouped(mechanism: Mechanism, q: Array, known: list[Group], generator: np.random.Generator) -> list[Group]:
    """Return the groups that singular configurations (N, n) belong to: the known ones, then those that they show.

    Every configuration is a member of each group whose positions it has, and of one surface if it has none.
    """
    groups = [replace(group, members=q[on_group(mechanism, group, q)]) for group in known]
    pending = q[~_on_any(mechanism, groups, q)]
    surfaces = [q[:0]]
    while len(pending):
        chunk, pending = pending[:_CHUNK], pending[_CHUNK:]
        for size in (1, 2):
            for i, sets in enumerate(held_sets(mechanism, chunk, size, generator)):
                for held in sets:
                    if size > 1 and _codimension(mechanism, chunk[i]) < size:
                        continue  # a curve in two joints, not positions of theirs
                    if not any(g.held == held and on_group(mechanism, g, chunk[i : i + 1])[0] for g in groups):
                        draft = group_of(mechanism, held, chunk[i][list(held)], generator)
                        groups.append(replace(draft, members=q[on_group(mechanism, draft, q)]))
            chunk = chunk[~_on_any(mechanism, groups, chunk)]
        surfaces.append(chunk)
        pending = pending[~_on_any(mechanism, groups, pending)]
    return groups + _surfaces(mechanism, np.concatenate(surfaces), generator)


def _on_any(mechanism: Mechanism, groups: list[Group], q: Array) -> Flags:
    found = np.zeros(len(q), dtype=bool)
    for group in groups:
        found |= on_group(mechanism, group, q)
    return found


def _codimension(mechanism: Mechanism, q: Array) -> int:
    """Return the rank of the constraints' gradients at a singular configuration."""
    _, gradients = constraints(mechanism, q)
    return int(np.sum(np.linalg.svd(gradients, compute_uv=False) > _INDEPENDENT)) if gradients.size else 0


def _surfaces(mechanism: Mechanism, q: Array, generator: np.random.Generator) -> list[Group]:
    """Return what is left: surfaces by support, shared positions and codimension; isolated positions of many joints."""
    if not len(q):
        return []
    count = q.shape[-1]
    stays = _stay(mechanism, q[:, None, :], ~np.eye(count, dtype=bool), 4, generator)  # all held but one
    common = _common_positions(mechanism, q)
    isolated, found = list[Group](), dict[tuple[Any, ...], list[tuple[int, int]]]()
    for i, row in enumerate(stays):
        support, codimension = tuple(int(j) for j in np.flatnonzero(~row)), _codimension(mechanism, q[i])
        if codimension == len(support) > 2 and _stays_held(mechanism, q[i], support, generator):
            if not any(g.held == support and on_group(mechanism, g, q[i : i + 1])[0] for g in isolated):
                draft = group_of(mechanism, support, q[i][list(support)], generator)
                isolated.append(replace(draft, members=q[on_group(mechanism, draft, q)]))
            continue
        fixed = tuple((j, float(common[i, j])) for j in support if np.isfinite(common[i, j]))
        found.setdefault((support, fixed), []).append((i, codimension))
    surfaces = [_surface(mechanism, support, fixed, q, members) for (support, fixed), members in found.items()]
    return isolated + _without_slivers(sorted(surfaces, key=lambda group: -len(group.members)))


def _surface(
    mechanism: Mechanism,
    support: tuple[int, ...],
    fixed: tuple[tuple[int, float], ...],
    q: Array,
    members: list[tuple[int, int]],
) -> Group:
    """Return the surface of some configurations, (index, codimension) each; the codimension of most of them."""
    held, positions = tuple(j for j, _ in fixed), tuple(c for _, c in fixed)
    own = q[[i for i, _ in members]]
    group = Group(held, positions, support, Counter(c for _, c in members).most_common(1)[0][0], True, own)
    target = np.zeros(q.shape[-1])
    target[list(held)] = positions
    off = np.abs(angle_between(mechanism, own, target))[:, list(held)]
    return replace(group, exact=bool(np.all(np.median(off, axis=0) < _SAME)))


def _without_slivers(surfaces: list[Group]) -> list[Group]:
    """Return the surfaces with the few members that seem to need fewer joints put back where they belong.

    Close to where two surfaces meet a joint may seem not to matter.
    """
    kept = list[Group]()
    for group in surfaces:  # the largest first
        at = next((i for i, g in enumerate(kept) if _is_sliver(group, g)), None)
        if at is None:
            kept.append(group)
        else:
            kept[at] = replace(kept[at], members=np.concatenate([kept[at].members, group.members]))
    return kept


def _is_sliver(small: Group, large: Group) -> bool:
    same = small.codimension == large.codimension and set(large.held) <= set(small.held)
    return same and set(small.support) < set(large.support) and len(small.members) * 50 <= len(large.members)


def _at_quarter(angle: float) -> float:
    """Return the multiple of a quarter turn in (-pi, pi] that an angle nearly is, else the angle."""
    quarters = round(angle / (math.pi / 2))
    near = abs(angle - quarters * math.pi / 2) < _SHARED
    return (math.pi if abs(quarters) == 2 else quarters * math.pi / 2) if near else angle


def _common_positions(mechanism: Mechanism, q: Array) -> Array:
    """Return the position that many configurations share in a coordinate, NaN where they do not. (N, n) -> (N, n)."""
    common = np.full(q.shape, np.nan)
    fewest = max(_FEWEST, math.ceil(_SHARE * len(q)))
    for j, turns in enumerate(mechanism.turning):
        values = math.pi - np.remainder(math.pi - _ROUNDED - q[:, j], 2 * math.pi) - _ROUNDED if turns else q[:, j]
        ordered = np.sort(values)
        # Windows that hold many; a curve that turns back has some crowding, too, but not that much.
        crowded = ordered[: len(q) - fewest + 1][ordered[fewest - 1 :] - ordered[: len(q) - fewest + 1] < _SHARED]
        for start in crowded:
            near = np.abs(values - start) < _ROUNDED
            if np.all(np.isnan(common[near, j])):
                shared = float(np.median(values[near]))
                common[near, j] = _at_quarter(shared) if turns else shared
    return common
