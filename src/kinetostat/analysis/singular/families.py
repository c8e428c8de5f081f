"""Families that joint positions make: which joints' positions make an arm singular, whatever the others do.

A singular set is a union of families. *Freeze test*: the positions of some joints are kept and the others drawn at
random; if the arm stays singular, those joints make the family. One or two joints with positions of their own are a
condition that can be written down ("joint3 = 0"); what is left is for `surfaces`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from kinetostat.analysis.singular.mechanism import MODEL, STRICT, Mechanism
from kinetostat.analysis.singular.search import constraints
from kinetostat.conventions import Array, Flags

__all__ = [
    "Group",
    "codimension_at",
    "group_of",
    "grouped",
    "held_sets",
    "on_group",
    "stay",
    "stays_held",
]

_DRAWS = 16
_MANY_DRAWS = 512  # enough that arms which are nearly singular there do not pass by chance
_CHUNK = 16  # configurations that are tried for sets before what they explain is taken out
_TRIED = 40_000  # sets in all configurations together
_APART = 1e-3  # rad or L: positions of one family differ by less
_EXACT = 10 * STRICT
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


def held_sets(
    mechanism: Mechanism, q: Array, size: int, generator: np.random.Generator, tolerance: float
) -> list[list[tuple[int, ...]]]:
    """Return for each configuration (N, n) the sets of so many joints that keep it singular by themselves."""
    sets = list(combinations(range(len(mechanism.names)), size))
    found: list[list[tuple[int, ...]]] = [[] for _ in q]
    if not sets or not len(q):
        return found
    masks = np.array([[i in chosen for i in range(q.shape[-1])] for chosen in sets])
    screened = stay(mechanism, q[:, None, :], masks, 1, generator, tolerance)
    for which, chosen in zip(*np.nonzero(screened), strict=True):
        if stays_held(mechanism, q[which], sets[chosen], generator, tolerance):
            found[which].append(sets[chosen])
    return found


def stays_held(
    mechanism: Mechanism, q: Array, held: tuple[int, ...], generator: np.random.Generator, tolerance: float
) -> bool:
    """Return whether one configuration (n,) stays singular with some joints held, beyond chance."""
    mask = np.isin(np.arange(q.shape[-1]), held)
    return all(bool(stay(mechanism, q, mask, draws, generator, tolerance)) for draws in (_DRAWS, _MANY_DRAWS))


def stay(
    mechanism: Mechanism, q: Array, masks: Flags, draws: int, generator: np.random.Generator, tolerance: float
) -> Flags:
    """Return whether configurations stay singular with the masked joints held and the others drawn anew."""
    shape = np.broadcast_shapes(q.shape, masks.shape)
    drawn = mechanism.draw(generator, (draws, *shape[:-1]))
    stay: Flags = np.all(mechanism.smallest(np.where(masks, q, drawn)) < tolerance, axis=0)
    return stay


def on_group(mechanism: Mechanism, group: Group, q: Array) -> Flags:
    """Return which configurations (N, n) have the held positions of a group. (N,)."""
    target = np.zeros(q.shape[-1])
    target[list(group.held)] = group.positions
    gap = np.abs(mechanism.difference(q, target))[..., list(group.held)]
    near: Flags = np.all(gap < _APART, axis=-1) & bool(group.held)
    return near


def group_of(mechanism: Mechanism, held: tuple[int, ...], positions: Array, generator: np.random.Generator) -> Group:
    """Return the group of some held positions; at zero or a quarter turn where they are that, but for rounding."""
    q = mechanism.draw(generator, (_DRAWS,))

    def worst(candidate: Array) -> float:
        q[:, list(held)] = candidate
        return float(np.max(mechanism.smallest(q)))

    whole = np.zeros(q.shape[-1])
    whole[list(held)] = positions
    found = mechanism.wrapped(whole)[list(held)]
    step = np.where(np.array(mechanism.turning)[list(held)], math.pi / 2, np.inf)
    with np.errstate(invalid="ignore"):
        plain = np.where(np.isinf(step), 0.0, step * np.round(found / step))
    snapped = np.where(np.abs(found - plain) < _APART, plain, found)
    whole[list(held)] = snapped
    snapped = mechanism.wrapped(whole)[list(held)]
    at_found, at_snapped = worst(found), worst(snapped)
    plainer = at_snapped < (_EXACT if at_found < _EXACT else MODEL)
    taken, off = (snapped, at_snapped) if plainer else (found, at_found)
    return Group(held, tuple(float(p) + 0.0 for p in taken), held, len(held), off < _EXACT, np.empty((0, q.shape[-1])))


def grouped(
    mechanism: Mechanism, q: Array, known: list[Group], generator: np.random.Generator
) -> tuple[list[Group], Array]:
    """Return the groups that singular configurations (N, n) belong to, the known ones first, and those of no group.

    Every configuration is a member of each group whose positions it has.
    """
    groups = [replace(group, members=q[on_group(mechanism, group, q)]) for group in known]
    pending = q[~_on_any(mechanism, groups, q)]
    sets = len(mechanism.names) * (len(mechanism.names) + 1) // 2
    untried = pending[_TRIED // sets :]  # of long chains, whose pairs are many and hardly ever a condition
    pending = pending[: _TRIED // sets]
    left = [untried]
    while len(pending):
        chunk, pending = pending[:_CHUNK], pending[_CHUNK:]
        for size in (1, 2):
            for i, holding in enumerate(held_sets(mechanism, chunk, size, generator, mechanism.tolerance)):
                for held in holding:
                    if size > 1 and codimension_at(mechanism, chunk[i]) < size:
                        continue  # a curve in two joints, not positions of theirs
                    if not any(g.held == held and on_group(mechanism, g, chunk[i : i + 1])[0] for g in groups):
                        draft = group_of(mechanism, held, chunk[i][list(held)], generator)
                        groups.append(replace(draft, members=q[on_group(mechanism, draft, q)]))
            chunk = chunk[~_on_any(mechanism, groups, chunk)]
        left.append(chunk)
        pending = pending[~_on_any(mechanism, groups, pending)]
    rest = np.concatenate(left)
    return groups, rest[~_on_any(mechanism, groups, rest)]


def _on_any(mechanism: Mechanism, groups: list[Group], q: Array) -> Flags:
    found = np.zeros(len(q), dtype=bool)
    for group in groups:
        found |= on_group(mechanism, group, q)
    return found


def codimension_at(mechanism: Mechanism, q: Array) -> int:
    """Return the rank of the constraints' gradients at a singular configuration."""
    _, gradients = constraints(mechanism, q)
    return int(np.sum(np.linalg.svd(gradients, compute_uv=False) > _INDEPENDENT)) if gradients.size else 0
