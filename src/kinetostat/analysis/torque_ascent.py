"""From many configurations at once to local maxima of gravity torques: along one coordinate after another, exactly.

Along one screw by an angle d, with everything else held, a gravity torque is a sinusoid (along a slide, a line). With s
the screw's axis where it is, M and h the mass and the first moment beyond it, r = h - M p its lever about a point p of
the axis, and g gravity,

    tau(d) = u . rot(r, d) - g . rot(x, d) + constant,        rot(., d): turned about s by d

x is the sum of lifts s_j x r_j (M s_j of a slide) of the screws beyond that belong to the torque, and u the sum of
-g x s_j of those before and of itself: the screw turns the levers of those, and gravity as these see it. So the best d
inside limits is known, and a sweep from the tips inward, in which moments and lifts turn with what was just turned,
moves every coordinate for the price of one evaluation. No step makes a torque smaller. (Coordinate ascent: D.
Bertsekas, "Nonlinear Programming", 1999, section 2.7.)
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetostat.conventions import Array, Flags
from kinetostat.screw.so3 import hat
from kinetostat.screw.tree import Tree

__all__ = ["TorqueAscent"]

_SWEEPS = 60
_SETTLED = 1e-10  # of a torque: a sweep that gains less is the last
_ROUNDING = 1e-14  # of what a coordinate can change: a gain that is none
_ROWS = 512  # that climb together: what is kept of them for a screw stays in the caches


class _Screws(NamedTuple):
    """Where screws are: for each the axis, a point of it, u, and the first moment of its own mass, (3, m) each."""

    axes: dict[int, Array]
    points: dict[int, Array]
    turners: dict[int, Array]
    moments: dict[int, Array]


@dataclass(frozen=True)
class TorqueAscent:
    """Ascent to local maxima of gravity torques inside limits.

    Coordinates that move several screws, or a screw with a pitch, follow no sinusoid: they stay where they are.

    Attributes:
        tree: the masses, and the n coordinates that move them.
        gravity: its acceleration in the root's axes, (3,), m/s2.
        lower: lower ends of the coordinates; minus infinity, with plus infinity above, for turns without end. (n,).
        upper: upper ends. (n,).
    """

    tree: Tree
    gravity: Array
    lower: Array
    upper: Array

    def climb(self, q: Array, columns: Sequence[int] | Array, signs: Array) -> tuple[Array, Array]:
        """Return where torques that grow from each row end, and how large they are there.

        Args:
            q: coordinates inside limits, (m, n).
            columns: the coordinate whose torque grows, for each row. (m,).
            signs: 1 where it becomes as large as it can, -1 where as small. (m,).

        Returns:
            coordinates (m, n), and the torques there (m,), Nm or N.
        """
        at, wanted = (
            np.clip(np.asarray(q, dtype=np.float64), self.lower, self.upper),
            np.asarray(columns, dtype=np.intp),
        )
        torques, signs = np.empty(len(at)), np.asarray(signs, dtype=np.float64)
        branch = np.argsort(np.argmax(self.tree.fold != 0, axis=0)[wanted], kind="stable")  # few screws for each part
        for first in range(0, len(at), _ROWS):
            rows = branch[first : first + _ROWS]
            at[rows], torques[rows] = self._climbed(at[rows], wanted[rows], signs[rows])
        return at, torques

    @cached_property
    def free(self) -> Flags:
        """Which coordinates it moves: those of one screw, without a pitch. (n,)."""
        alone = np.count_nonzero(self.tree.fold, axis=0) == 1
        free: Flags = alone & ~np.any(self.tree.fold[self._pitches != 0] != 0, axis=0)
        return free

    def _climbed(self, q: Array, wanted: npt.NDArray[np.intp], signs: Array) -> tuple[Array, Array]:
        screws = self._bearing(wanted)
        reached, rising = np.full(len(q), -math.inf), np.arange(len(q))
        for _ in range(_SWEEPS):
            q[rising], torques = self._sweep(screws, q[rising], wanted[rising], signs[rising])
            before, reached[rising] = reached[rising], signs[rising] * torques
            rising = rising[reached[rising] - before > _SETTLED * np.abs(reached[rising])]
            if len(rising) == 0:
                break
        return q, signs * reached

    def _bearing(self, wanted: npt.NDArray[np.intp]) -> list[int]:
        """Return the screws on which torques depend, from the root outwards: their own, those before, those beyond."""
        parents, own = self.tree.parents, np.any(self.tree.fold[:, np.unique(wanted)] != 0, axis=1)
        beyond, before = own.copy(), own.copy()
        for k, parent in enumerate(parents):
            beyond[k] |= parent >= 0 and beyond[parent]
        for k in reversed(range(len(parents))):
            if before[k] and parents[k] >= 0:
                before[parents[k]] = True
        return [int(k) for k in np.flatnonzero(beyond | before)]

    def _sweep(self, screws: list[int], q: Array, wanted: npt.NDArray[np.intp], signs: Array) -> tuple[Array, Array]:
        """Return coordinates after each has moved once, from the tips inward, and the torques there."""
        weights = self.tree.fold[:, wanted]
        now = self._outward(screws, (q @ self.tree.fold.T + self.tree.offset).T, weights)
        moments, lifts = now.moments, {k: np.zeros((3, len(q))) for k in screws}
        total = np.zeros((3, len(q)))
        for k in reversed(screws):
            axis, shift, column = now.axes[k], self._beyond[k] * now.points[k], self._moves[k]
            lever, lift = moments[k] - shift, lifts[k]
            if self._turning[k]:
                if column is not None:
                    sinusoid = self._sinusoid(axis, now.turners[k], lever, lift, signs)
                    angle = _along_circle(*sinusoid, self._ends(k, column, q))
                    q[:, column] += angle / self.tree.fold[k, column]
                    lever, lift = _turned(lever, axis, angle), _turned(lift, axis, angle)
                lift = lift + weights[k] * (_cross(axis, lever) + self._pitches[k] * self._beyond[k] * axis)
            else:
                if column is not None:
                    slope = signs * self._beyond[k] * _dot(now.turners[k], axis)
                    length = _along_line(slope, self._ends(k, column, q))
                    q[:, column] += length / self.tree.fold[k, column]
                    lever = lever + self._beyond[k] * length * axis
                lift = lift + weights[k] * self._beyond[k] * axis
            if self.tree.parents[k] < 0:
                total += lift
            else:
                moments[self.tree.parents[k]] += lever + shift
                lifts[self.tree.parents[k]] += lift
        return np.clip(q, self.lower, self.upper), -(self.gravity @ total)

    def _ends(self, k: int, column: int, q: Array) -> Array:
        """Return how far screw k may move back and forth. (2, m)."""
        room = self.tree.fold[k, column] * (np.stack([self.lower, self.upper])[:, column, None] - q[:, column])
        return np.sort(room, axis=0)

    def _sinusoid(self, axis: Array, turner: Array, lever: Array, lift: Array, signs: Array) -> tuple[Array, Array]:
        """Return b and c of signs tau(d) = b cos d + c sin d + constant. (m,), (m,)."""
        across, beyond = _cross(axis, lever), _cross(axis, lift)
        cosine = self.gravity @ _cross(axis, beyond) - _dot(turner, _cross(axis, across))
        sine = _dot(turner, across) - self.gravity @ beyond
        return signs * cosine, signs * sine

    # --- where screws are ----------------------------------------------------------------------------------------

    def _outward(self, screws: list[int], positions: Array, weights: Array) -> _Screws:
        """Return where screws are at their positions, and u for torques with these weights. (s, m), (s, m)."""
        count, gravity = positions.shape[1], self.gravity[:, None]
        rest = np.broadcast_to(np.eye(3)[:, :, None], (3, 3, count)), np.zeros((3, count)), np.zeros((3, count))
        placed: dict[int, tuple[Array, Array, Array]] = {-1: rest}  # R by columns, (3, 3, m), the origin, u
        now = _Screws({}, {}, {}, {})
        for k in screws:
            turn, origin, turner = placed[self.tree.parents[k]]
            moved = _combined(self._constants[k], turn)
            axis, point = moved[0], moved[1] + origin
            if self._turning[k]:
                turn = turn + np.sin(positions[k]) * moved[2:5] + (1 - np.cos(positions[k])) * moved[5:8]
                origin = point - _combined(self._feet[k], turn) + self._pitches[k] * positions[k] * axis
                turner = turner - weights[k] * _cross(gravity, axis)
            else:
                origin = origin + positions[k] * axis
            placed[k] = turn, origin, turner
            now.axes[k], now.points[k], now.turners[k] = axis, point, turner
            now.moments[k] = self.tree.masses[k] * (_combined(self.tree.centres[k], turn) + origin)
        return now

    @cached_property
    def _turning(self) -> Flags:
        turning: Flags = np.any(self.tree.screws[3:] != 0, axis=0)
        return turning

    @cached_property
    def _pitches(self) -> Array:
        """How far each screw that turns advances, m per rad; zero where that is rounding. (s,)."""
        v, w = self.tree.screws[:3], self.tree.screws[3:]
        pitches = np.sum(v * w, axis=0)
        rounding: Array = 1e-14 * (1 + np.linalg.norm(v, axis=0))
        return np.where(np.abs(pitches) > rounding, pitches, 0.0)

    @cached_property
    def _feet(self) -> Array:
        """A point of each screw's axis at t = 0; zero for slides. (s, 3)."""
        return np.cross(self.tree.screws[3:], self.tree.screws[:3], axis=0).T

    @cached_property
    def _constants(self) -> list[Array]:
        """What the columns of R are combined with for R w, R foot, R [w] and R [w]^2. (8, 3) each."""
        found = []
        for screw, turning, foot in zip(self.tree.screws.T, self._turning, self._feet, strict=True):
            cross = hat(screw[3:])
            found.append(np.vstack([screw[3:] if turning else screw[:3], foot, cross.T, (cross @ cross).T]))
        return found

    @cached_property
    def _moves(self) -> list[int | None]:
        """The coordinate that each screw is moved by; None for a screw that stays where it is."""
        drivers = [int(np.argmax(np.abs(row))) for row in self.tree.fold]
        return [j if self.free[j] and row[j] != 0 else None for j, row in zip(drivers, self.tree.fold, strict=True)]

    @cached_property
    def _beyond(self) -> Array:
        """The mass that moves with each screw. (s,), kg."""
        beyond = self.tree.masses.astype(np.float64)
        for k in reversed(range(len(beyond))):
            if self.tree.parents[k] >= 0:
                beyond[self.tree.parents[k]] += beyond[k]
        return beyond


def _along_circle(cosine: Array, sine: Array, ends: Array) -> Array:
    """Return the d between ends (2, m) where b cos d + c sin d is largest; zero where it gains nothing. (m,)."""
    (low, high), size = ends, np.hypot(cosine, sine)
    peak = np.arctan2(sine, cosine)
    with np.errstate(invalid="ignore"):  # turns without ends
        within = np.isinf(low) | ((peak >= low) & (peak <= high))
        further = peak + 2 * math.pi * np.ceil((low - peak) / (2 * math.pi))
        nearer = np.where(_at(cosine, sine, low) >= _at(cosine, sine, high), low, high)
        best = np.where(within, peak, np.where(further <= high, further, nearer))
    gains = _at(cosine, sine, best) - cosine
    return np.where(gains > _ROUNDING * size, best, 0.0)


def _at(cosine: Array, sine: Array, angle: Array) -> Array:
    value: Array = cosine * np.cos(angle) + sine * np.sin(angle)
    return value


def _along_line(slope: Array, ends: Array) -> Array:
    """Return the end of a range (2, m) to which a line rises; zero where it is level. (m,)."""
    return np.where(slope > 0, ends[1], np.where(slope < 0, ends[0], 0.0))


def _combined(rows: Array, columns: Array) -> Array:
    """Return combinations of three columns of vectors. (..., 3), (3, 3, m) -> (..., 3, m)."""
    found: Array = (rows @ columns.reshape(3, -1)).reshape(*rows.shape[:-1], 3, -1)
    return found


def _turned(vector: Array, axis: Array, angle: Array) -> Array:
    """Return vectors turned about unit vectors: v + sin(d) s x v + (1 - cos(d)) s x (s x v). (3, m)."""
    across = _cross(axis, vector)
    return vector + np.sin(angle) * across + (1 - np.cos(angle)) * _cross(axis, across)


def _cross(a: Array, b: Array) -> Array:
    (ax, ay, az), (bx, by, bz) = a, b
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def _dot(a: Array, b: Array) -> Array:
    found: Array = np.einsum("im,im->m", a, b)
    return found
