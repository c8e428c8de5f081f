"""Surfaces: singular configurations whose positions depend on each other.

They are told apart by their support, the joints of which each one alone can leave the surface; by positions that all of
them share ("joint5 = pi/2, with a relation of joint4 and joint6"); and by their codimension.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace

import numpy as np

from kinetostat.analysis.singular.families import (
    Group,
    codimension_at,
    group_of,
    on_group,
    stay,
    stays_held,
)
from kinetostat.analysis.singular.mechanism import STRICT, Mechanism
from kinetostat.analysis.singular.search import converge
from kinetostat.conventions import Array, Flags

__all__ = ["surfaces"]

_REDUNDANT = 3  # joints too many: beyond, conditions are too many to tell apart but by support
_SHARED, _SHARED_ROUNDED = 1e-7, 1e-5  # rad or m: a window in which positions that many share must lie
_SHARE = 0.02  # how many are many
_FEWEST = 4  # and how many at least
_ABSORBED, _ABSORBED_ROUNDED = 1e-5, 1e-3  # rad or m: positions so close to one that many share are that one
_SAME = 1e-8  # rad or m: and those that differ by less are one in exact numbers
_BESIDE = 0.05  # rad or L: how far from a shared position a member of a sliver may be
_AT_ONCE = 500  # configurations, so that memory does not grow with their number
_MEASURED = 64  # members of which the codimension is taken
_DRAWS = 12  # positions of one joint that are tried
_FEW = 0.2  # share that is too small to be a surface apart
_TRIED = 6  # members of a small group that are tried
_BACK = 8  # searches from beside each
_NUDGE = 0.1  # rad or L: how far beside
_SLIVER = 50  # how many times larger a surface is than what is taken for a part of it
_PART = 10  # and if the part has the positions that the surface shares


def surfaces(mechanism: Mechanism, q: Array, generator: np.random.Generator) -> tuple[list[Group], Array]:
    """Return the surfaces of singular configurations (N, n), isolated positions of three joints or more, and the rest.

    The rest are configurations close to where families meet, which belong to none that could be told.
    """
    if not len(q):
        return [], q
    by_support: dict[tuple[int, ...], list[int]] = {}
    for i, support in enumerate(_supports(mechanism, q, generator)):
        by_support.setdefault(support, []).append(i)
    isolated, found, rest = list[Group](), list[Group](), [q[:0]]
    redundant = len(mechanism.names) - mechanism.generic_rank > _REDUNDANT
    for support, members in by_support.items():
        if len(support) < 2:
            rest.append(q[members])  # one joint alone has no relation
        elif redundant:
            found.append(_surface(mechanism, support, (), q[members]))
        else:
            alone, others = _isolated(mechanism, support, q[members], generator)
            isolated += alone
            found += _told_apart(mechanism, support, others)
    kept = list[Group]()
    for group in _without_slivers(mechanism, sorted(found, key=lambda group: -len(group.members))):
        if len(group.members) * _SLIVER > len(q) or _persists(mechanism, group, generator):
            kept.append(group)
        else:
            rest.append(group.members)
    return isolated + kept, np.concatenate(rest)


def _supports(mechanism: Mechanism, q: Array, generator: np.random.Generator) -> list[tuple[int, ...]]:
    """Return for each configuration the joints that matter: moved alone, they leave the singular set."""
    others_held = ~np.eye(q.shape[-1], dtype=bool)
    supports = []
    for first in range(0, len(q), _AT_ONCE):
        some = q[first : first + _AT_ONCE, None, :]
        matters = ~stay(mechanism, some, others_held, _DRAWS, generator, mechanism.tolerance)
        supports += [tuple(int(j) for j in np.flatnonzero(row)) for row in matters]
    return supports


def _persists(mechanism: Mechanism, group: Group, generator: np.random.Generator) -> bool:
    """Return whether searches that start beside a small group's members come back to it, and not to its neighbours."""
    members = group.members[:_TRIED]
    beside = np.repeat(members, _BACK, axis=0)
    beside = beside + _NUDGE * mechanism.units * generator.normal(size=beside.shape)
    found, smallest = converge(mechanism, beside)
    found = found[smallest < STRICT]
    if not len(found):
        return False
    again = np.array([support == group.support for support in _supports(mechanism, found, generator)])
    near = np.all(_off(mechanism, group, found) < _BESIDE, axis=-1)
    return 4 * int(np.count_nonzero(again & near)) >= len(found)


def _isolated(
    mechanism: Mechanism, support: tuple[int, ...], q: Array, generator: np.random.Generator
) -> tuple[list[Group], Array]:
    """Return groups of positions that stand alone, as many equations as joints, and the configurations of none."""
    groups, rest = list[Group](), list[Array]()
    for x in q:
        if any(on_group(mechanism, group, x[None])[0] for group in groups):
            continue
        alone = len(support) > 2 and codimension_at(mechanism, x) == len(support)
        if alone and stays_held(mechanism, x, support, generator, mechanism.tolerance):
            draft = group_of(mechanism, support, x[list(support)], generator)
            groups.append(replace(draft, members=q[on_group(mechanism, draft, q)]))
        else:
            rest.append(x)
    return groups, np.array(rest).reshape(-1, q.shape[-1])


def _told_apart(mechanism: Mechanism, support: tuple[int, ...], q: Array) -> list[Group]:
    """Return the surfaces of configurations with one support, by the positions that they share.

    And by whether the second-order form is zero: on one surface it is so everywhere, or almost nowhere.
    """
    if not len(q):
        return []
    common, tangent = _common_positions(mechanism, q), _tangent(mechanism, q)
    apart: dict[tuple[bool, tuple[tuple[int, float], ...]], list[int]] = {}
    for i, row in enumerate(common):
        fixed = tuple((j, float(row[j])) for j in support if np.isfinite(row[j]))
        apart.setdefault((bool(tangent[i]), fixed), []).append(i)
    return [_surface(mechanism, support, fixed, q[members]) for (_, fixed), members in apart.items()]


def _tangent(mechanism: Mechanism, q: Array) -> Flags:
    """Return whether the second-order form u^T dJ(v, v) is zero at singular configurations. (N, n) -> (N,).

    Of all wrenches u that no joint feels: for those that none feels anywhere it is zero in any case.
    """
    matrix, along = mechanism.derivatives(q)
    left, _, right = np.linalg.svd(matrix)
    first = mechanism.generic_rank - 1
    wrenches, motions = left[..., first:], right[..., first:, :]
    forms = np.einsum("Nrk,Nrij,Nai,Nbj->Nkab", wrenches, along, motions, motions, optimize=True)
    symmetric = (forms + np.swapaxes(forms, -1, -2)) / 2
    tangent: Flags = np.max(np.abs(symmetric), axis=(-3, -2, -1)) < mechanism.tolerance
    few = min(np.mean(tangent), np.mean(~tangent)) < _FEW  # near where the form passes through zero
    return np.full(len(q), np.mean(tangent) > 0.5) if few else tangent


def _surface(mechanism: Mechanism, support: tuple[int, ...], fixed: tuple[tuple[int, float], ...], q: Array) -> Group:
    """Return the surface of some configurations; its codimension is that of most of them."""
    held, positions = tuple(j for j, _ in fixed), tuple(c for _, c in fixed)
    measured = Counter(codimension_at(mechanism, x) for x in q[:_MEASURED]).most_common(1)[0][0]
    codimension = max(measured, len(held) + (len(support) > len(held)))  # gradients may vanish all over a surface
    surface = Group(held, positions, support, codimension, True, q)
    return replace(surface, exact=bool(np.all(np.median(_off(mechanism, surface, q), axis=0) < _SAME)))


def _without_slivers(mechanism: Mechanism, found: list[Group]) -> list[Group]:
    """Return the surfaces with the few members that seem to have another condition put back where they belong.

    Close to where two surfaces meet, a joint may seem not to matter, or a shared position not to be shared.
    """
    kept = list[Group]()
    for group in found:  # the largest first
        at = next((i for i, large in enumerate(kept) if _is_sliver(mechanism, group, large)), None)
        if at is None:
            kept.append(group)
        else:
            kept[at] = replace(kept[at], members=np.concatenate([kept[at].members, group.members]))
    return kept


def _is_sliver(mechanism: Mechanism, small: Group, large: Group) -> bool:
    """Return whether a group is a part of a larger one: fewer joints seem to matter, more positions to be shared."""
    if not set(small.support) <= set(large.support):
        return False
    if not large.held:  # nothing else tells that it is a part
        return small.codimension == large.codimension and len(small.members) * _SLIVER <= len(large.members)
    few = len(small.members) * _PART <= len(large.members)
    return few and bool(np.all(_off(mechanism, large, small.members) < _BESIDE))


def _off(mechanism: Mechanism, group: Group, q: Array) -> Array:
    """Return how far configurations (N, n) are from the positions that a group shares. (N, number of them)."""
    target = np.zeros(q.shape[-1])
    target[list(group.held)] = group.positions
    gap: Array = np.abs(mechanism.difference(q, target))[:, list(group.held)]
    return gap


def _at_quarter(angle: float) -> float:
    """Return the multiple of a quarter turn in (-pi, pi] that an angle nearly is, else the angle."""
    quarters = round(angle / (math.pi / 2))
    near = abs(angle - quarters * math.pi / 2) < _SHARED_ROUNDED
    return (math.pi if abs(quarters) == 2 else quarters * math.pi / 2) if near else angle


def _common_positions(mechanism: Mechanism, q: Array) -> Array:
    """Return the position that many configurations share in a coordinate, NaN where they do not. (N, n) -> (N, n)."""
    common = np.full(q.shape, np.nan)
    fewest = max(_FEWEST, math.ceil(_SHARE * len(q)))
    window = _SHARED_ROUNDED if mechanism.rounded else _SHARED
    absorbed = _ABSORBED_ROUNDED if mechanism.rounded else _ABSORBED
    for j, turns in enumerate(mechanism.periodic):
        values = math.pi - np.remainder(math.pi - absorbed - q[:, j], 2 * math.pi) - absorbed if turns else q[:, j]
        ordered = np.sort(values)
        # Windows that hold many; a curve that turns back has some crowding, too, but not that much.
        crowded = ordered[: len(q) - fewest + 1][ordered[fewest - 1 :] - ordered[: len(q) - fewest + 1] < window]
        for start in crowded:
            near = np.abs(values - start) < absorbed
            if np.all(np.isnan(common[near, j])):
                shared = float(np.median(values[near]))
                common[near, j] = _at_quarter(shared) if turns else shared
    return common
