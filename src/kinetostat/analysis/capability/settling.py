"""From places of the base that a map promises to good ones: inverse kinematics from many starts, then step by step."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from kinetostat.analysis.capability.capability_map import CapabilityMap
from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.inverse.aim import REACHED, Aim
from kinetostat.analysis.inverse.damped import descend
from kinetostat.conventions import Array
from kinetostat.screw import se3, so3

__all__ = ["Settler", "Stances", "based", "path"]

_AT_ONCE = 16_384  # descents side by side
_SAME = 1e-3  # rad or L: ends so near are one branch
_KEPT = 4  # branches of each pose that a step goes on from
_STIRRED = 0.15  # rad or L, by which a start is away from a solution: where joints are spare there is a better one near
_HALVED = 6  # times that a step is
_ROUNDS = 40  # of steps at most
_TURN = math.radians(15)  # the first step in heading
_GAIN = 1e-4  # of the smallest singular value: a step that gains less is none


@dataclass(frozen=True, repr=False)
class Stances:
    """Some places of the base, with the branches of inverse kinematics that were found for each pose from there.

    Attributes:
        places: x, y in m and heading in rad, (m, 3).
        q: coordinates of the chain, each pose's branches by their smallest singular value, (m, p, k, n).
        values: the smallest singular values, descending along k; -1 of what does not reach the pose, (m, p, k).
    """

    places: Array
    q: Array
    values: Array

    def __repr__(self) -> str:
        return f"<Stances: {len(self.places)} places, {self.values.shape[1]} poses>"

    @property
    def count(self) -> Array:
        """How many poses are reached from each place, (m,)."""
        return np.asarray(np.sum(self.values[..., 0] >= 0, axis=-1))

    @property
    def worst(self) -> Array:
        """The smallest singular value of the worst pose that is reached, each by its best branch, 0 for none. (m,)."""
        best = self.values[..., 0]
        least = np.min(np.where(best >= 0, best, np.inf), axis=-1)
        return np.where(np.isfinite(least), least, 0.0)

    @property
    def order(self) -> Any:
        """The numbers of the places, the best first: by poses reached, then by the worst, then by the mean. (m,)."""
        mean = np.mean(np.maximum(self.values[..., 0], 0.0), axis=-1)
        return np.lexsort((-mean, -self.worst, -self.count))

    def part(self, index: Any) -> Stances:
        """Return some of the places by their numbers."""
        return Stances(self.places[index], self.q[index], self.values[index])

    def first(self, branches: int) -> Stances:
        """Return them with the best branches only."""
        return Stances(self.places, self.q[:, :, :branches], self.values[:, :, :branches])


def based(places: Array) -> Array:
    """Return where the base is in the world, from x, y in m and heading in rad. (..., 3) -> (..., 4, 4)."""
    origin = np.concatenate([places[..., :2], np.zeros_like(places[..., :1])], axis=-1)
    return se3.placement(so3.about(2, places[..., 2]), origin)


class Settler:
    """Finds branches of inverse kinematics for a list of poses from many places of the base, and better places."""

    def __init__(self, capability: CapabilityMap, poses: Array, seed: int) -> None:
        """Take the map and the poses in the world, (p, 4, 4)."""
        self.capability, self.poses = capability, poses
        self.generator = np.random.default_rng(seed)
        self.aim = Aim.of(capability.coordinates, capability.task, local=capability.kernel.local)

    def from_map(self, places: Array, tries: int) -> Stances:
        """Return what the best configuration of each pose's voxel leads to, and random ones, `tries` in all. (m, 3)."""
        goals = self._goals(places)
        index = self.capability.grid.index(goals[..., :3, 3])
        starts = self._drawn((*index.shape, tries))
        known = self.capability.configurations(index.ravel(), self.capability.held)
        known = known[:, list(self.capability.coordinates.indices)].reshape(*index.shape, -1)
        reached = (index >= 0) & self.capability.reached.ravel()[index]
        starts[:, :, 0] = np.where(reached[..., None], known, starts[:, :, 0])
        return self._solved(places, starts)

    def again(self, found: Stances, tries: int) -> Stances:
        """Return the same places with what random starts add, and the best branches stirred."""
        drawn = self._drawn((*found.q.shape[:2], tries))
        return self._solved(
            found.places, np.concatenate([found.q, self._stirred(found.q[:, :, :_KEPT]), drawn], axis=2)
        )

    def refined(self, found: Stances, size: float, progress: Callable[[float], None] | None = None) -> Stances:
        """Return better places, step by step: along x, y or heading, half as far where no step is better.

        Each place goes on from the best branches of the one before, and from these stirred, by which spare joints find
        better ones.

        Args:
            found: where to begin.
            size: the first step, m.
            progress: told which share is done.
        """
        found, scale = found.first(_KEPT), np.ones(len(found.places))
        moves = np.concatenate([np.zeros((1, 3)), np.diag([size, size, _TURN]), -np.diag([size, size, _TURN])])
        for i in range(_ROUNDS):
            open_ = np.flatnonzero(scale > 2.0**-_HALVED)
            if not len(open_):
                break
            if progress is not None:
                progress(i / _ROUNDS)
            now = found.part(open_)
            tried = (now.places[:, None] + scale[open_, None, None] * moves).reshape(-1, 3)
            known = np.where(now.values[..., None] >= 0, now.q, self._drawn(now.values.shape))
            starts = np.concatenate([known, self._stirred(known[:, :, :2])], axis=2)
            near = self._solved(tried, np.repeat(starts, len(moves), axis=0)).first(_KEPT)
            order = near.order
            best = near.part(order[np.unique(order // len(moves), return_index=True)[1]])
            gained = (best.count == now.count) & (best.worst > now.worst * (1 + _GAIN))
            better = (best.count > now.count) | gained
            taken = open_[better]
            found.places[taken], found.q[taken] = best.places[better], best.q[better]
            found.values[taken] = best.values[better]
            stays = np.all(best.places == now.places, axis=-1)  # better where it is: the next place may be so too
            scale[open_[~better | stays]] /= 2
        return found

    def _goals(self, places: Array) -> Array:
        """Return the poses in the base's coordinates, (m, 3) -> (m, p, 4, 4)."""
        return np.asarray(se3.inverse(based(places))[:, None] @ self.poses)

    def _drawn(self, shape: tuple[int, ...]) -> Array:
        return self.aim.joints.draw(self.generator, shape, limited=True)

    def _stirred(self, q: Array) -> Array:
        stirred: Array = q + _STIRRED * self.aim.units * self.generator.standard_normal(q.shape)
        return stirred

    def _solved(self, places: Array, starts: Array) -> Stances:
        """Return what descents from starts (m, p, k, n) lead to."""
        targets = np.broadcast_to(self._goals(places)[:, :, None], (*starts.shape[:3], 4, 4)).reshape(-1, 4, 4)
        flat = starts.reshape(-1, starts.shape[-1])
        parts = [self._ends(flat[i : i + _AT_ONCE], targets[i : i + _AT_ONCE]) for i in range(0, len(flat), _AT_ONCE)]
        q = np.concatenate([part[0] for part in parts]).reshape(starts.shape)
        q, values = _sorted(q, np.concatenate([part[1] for part in parts]).reshape(starts.shape[:-1]))
        for i in range(1, starts.shape[2]):
            apart = self.aim.joints.wrapped(q[:, :, :i] - q[:, :, i : i + 1]) / self.aim.units
            known = np.any((np.max(np.abs(apart), axis=-1) < _SAME) & (values[:, :, :i] >= 0), axis=-1)
            values[:, :, i] = np.where(known, -1.0, values[:, :, i])
        return Stances(places, *_sorted(q, values))

    def _ends(self, starts: Array, targets: Array) -> tuple[Array, Array]:
        """Return where descents end, (N, n), and the smallest singular values there, -1 of those that miss. (N,)."""
        joints = self.aim.joints
        q, size, _ = descend(self.aim, starts, targets, limited=False)
        q = joints.into_limits(q)
        outside = np.flatnonzero((size < REACHED) & ~np.all(joints.between(q), axis=-1))
        if len(outside):
            inside = np.clip(q[outside], *joints.stated_limits)
            q[outside], size[outside], _ = descend(self.aim, inside, targets[outside], limited=True)
        values, reached = np.full(len(q), -1.0), np.flatnonzero(size < REACHED)
        if len(reached):
            values[reached] = self.capability.kernel(q[reached])["singular_values"][:, -1]
        return q, values


def _sorted(q: Array, values: Array) -> tuple[Array, Array]:
    """Return branches (m, p, k, n) and their values, the largest first."""
    order = np.argsort(-values, axis=-1, kind="stable")
    return np.take_along_axis(q, order[..., None], axis=2), np.take_along_axis(values, order, axis=2)


def path(joints: Coordinates, q: Array, values: Array, units: Array) -> Array:
    """Return for each pose the branch that makes the joints travel least, of those no worse than the worst pose's best.

    By dynamic programming over the poses in their order; a pose that is not reached is passed by. Angles are then
    turned by whole turns to the ones nearest to those of the pose before, as limits allow, and each joint as a whole to
    where it stays nearest to zero.

    Args:
        joints: the chain.
        q: coordinates of the branches, (p, k, n).
        values: the smallest singular values, descending along k, -1 of what does not reach the pose, (p, k).
        units: what one unit of each coordinate is, (n,).

    Returns:
        (p, n).
    """
    chosen = q[:, 0].copy()
    reached = np.flatnonzero(values[:, 0] >= 0)
    if not len(reached):
        return chosen
    allowed = values >= np.min(values[reached, 0])
    cost, before = np.where(allowed[reached[0]], 0.0, np.inf), list[Any]()
    for a, b in pairwise(reached):
        travel = np.linalg.norm(joints.wrapped(q[b][:, None] - q[a][None]) / units, axis=-1) + cost
        before.append(np.argmin(travel, axis=1))
        cost = np.where(allowed[b], np.min(travel, axis=1), np.inf)
    branch = int(np.argmin(cost))
    for i in reversed(range(len(reached))):
        chosen[reached[i]] = q[reached[i], branch]
        branch = int(before[i - 1][branch]) if i else branch
    for a, b in pairwise(reached):
        chosen[b] = joints.near(chosen[b], chosen[a])
    for turns in (-2 * math.pi, 2 * math.pi):
        moved = chosen[reached] + np.where(joints.periodic, turns, 0.0)
        nearer = np.max(np.abs(moved), axis=0) < np.max(np.abs(chosen[reached]), axis=0)
        chosen[reached] = np.where(nearer & np.all(joints.between(moved), axis=0), moved, chosen[reached])
    return chosen
