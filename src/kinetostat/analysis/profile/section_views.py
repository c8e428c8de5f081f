"""From where a limb is looked at, and which two of its joints show most of its workspace there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.kernels import chain_kernel
from kinetostat.analysis.profile.cells import best_in_cells
from kinetostat.conventions import Array, Flags

__all__ = ["View", "views_of_limb"]

_CELLS = 17  # of each joint's range, in whose middles areas are taken
_PLANAR = 1e-6  # share of area across its main direction: an arm with less moves in one plane
_FLAT, _WORTH = 0.9, 0.02  # a pair stays in a plane, and its area is worth a picture
_THIN = 1e-3  # of the largest area: less is a curve
_NOTHING = 1e-8  # of the square of the robot's reach
_ROUND = 0.05  # what is less longer than wide has no long direction
_LEVEL = np.sqrt(0.5)  # sine of the slope up to which a plane is seen from above
_SQUARES, _EQUAL = 64, 0.02  # across all that is swept; and what areas may differ by that are taken for equal
_PARALLEL = 1e-6  # what the cosine of an angle lacks of 1: files write a quarter turn as 1.5708
_UPRIGHT = 0.9  # an axis that is nearer to the vertical does not tell what is to the right


@dataclass(frozen=True)
class View:
    """A way to look at a limb.

    Attributes:
        view: from the side, or from above.
        directions: unit vectors to the right and up in the picture, in the observer's axes. (2, 3).
        pair: indices of the two coordinates that show most of the workspace there, the first first.
    """

    view: Literal["side", "above"]
    directions: Array
    pair: tuple[int, int]


def views_of_limb(joints: Coordinates, rest: Array, up: Array, ends: tuple[Array, Array]) -> tuple[View, ...]:
    """Return the planes in which a limb is drawn, each with the two joints that cover the largest area of it.

    A pair of joints sweeps a surface, whose element of area is (dp/dq_i x dp/dq_j) dq_i dq_j with p the tool's origin.
    Its shadow on a plane with the unit normal m is the part along m. From the side, m is horizontal and such that the
    shadow is largest, of pairs that keep the tool in that plane if there are any: a surface that is seen flat shows
    the arm better than a sphere that hides itself. From above, m is the vertical, and a pair whose first joint turns
    about it comes first if it covers half of what another does. An arm that moves its tool in one plane is seen in its
    true shape, once.

    Args:
        joints: the coordinates of the limb.
        rest: the configuration of the robot in which all others are held, (nq,).
        up: the vertical in the observer's axes, a unit vector (3,).
        ends: lower and upper end of each coordinate, (n,), (n,).

    Returns:
        At most one from the side and one from above; none where no two joints sweep an area.
    """
    swept = _swept(joints, rest, ends)
    if swept is None or not swept.sizes.max() > _NOTHING * joints.model.robot.reach**2:
        return ()
    normal = _one_normal(swept.areas, up)
    every = np.ones(len(swept.pairs), dtype=bool)
    if normal is not None:
        seen: Literal["side", "above"] = "above" if normal @ up > _LEVEL else "side"
        directions = _level(normal) if seen == "above" else _upright(normal, up)
        which = _first_largest(_covered(swept, [directions] * len(swept.pairs), every))
        return (View(seen, directions, swept.pairs[which]),)
    normals = [_level_normal(part, up) for part in swept.areas]
    shadows = np.array([swept.shadow(which, across) for which, across in enumerate(normals)])
    flat = (shadows > _FLAT * swept.sizes) & (shadows > _WORTH * shadows.max())
    uprights = [_upright(across, up) for across in normals]
    side = _first_largest(_covered(swept, uprights, flat if np.any(flat) else every))
    covered = _covered(swept, [_level(up)] * len(swept.pairs), every)
    upright = np.array([swept.turns_about(first, up) for first, _ in swept.pairs]) & (covered > covered.max() / 2)
    above = _first_largest(np.where(upright, covered, 0.0) if np.any(upright) else covered)
    views = (View("side", uprights[side], swept.pairs[side]), View("above", _level(up), swept.pairs[above]))
    shown = (shadows[side], swept.shadow(above, up))
    return tuple(view for view, area in zip(views, shown, strict=True) if area > _THIN * swept.sizes.max())


# --- areas


@dataclass(frozen=True)
class _Swept:
    """What each pair of joints sweeps.

    Attributes:
        pairs: the indices of each pair's coordinates.
        areas: elements of area over a grid of each pair, all other joints held. (pairs, cells, 3), m2.
        points: the tool there. (pairs, cells of the second, cells of the first, 3), m.
        sizes: the area of each surface. (pairs,), m2.
        axes: what each coordinate turns about where all are held; 0 for one that slides. (3, n).
    """

    pairs: list[tuple[int, int]]
    areas: Array
    points: Array
    sizes: Array
    axes: Array

    def turns_about(self, index: int, direction: Array) -> bool:
        """Return whether a coordinate turns about a direction."""
        return bool(abs(self.axes[:, index] @ direction) > 1 - _PARALLEL)

    def shadow(self, which: int, normal: Array) -> float:
        """Return the area of a pair's shadow across a direction, what is covered twice counting twice, m2."""
        return float(np.sum(np.abs(self.areas[which] @ normal)))


def _swept(joints: Coordinates, rest: Array, ends: tuple[Array, Array]) -> _Swept | None:
    """Return what pairs of joints sweep; None where there are no two joints."""
    lower, upper = ends
    pairs = list(combinations(range(len(joints.names)), 2))
    if not pairs:
        return None
    share = (np.arange(_CELLS) + 0.5) / _CELLS
    grid = np.broadcast_to(rest[list(joints.indices)], (len(pairs), _CELLS, _CELLS, len(joints.names))).copy()
    for which, (i, j) in enumerate(pairs):
        grid[which, ..., i] = (lower[i] + (upper[i] - lower[i]) * share)[None, :]
        grid[which, ..., j] = (lower[j] + (upper[j] - lower[j]) * share)[:, None]
    found = chain_kernel(joints, ("placement", "jacobian"), rest)(grid.reshape(-1, len(joints.names)))
    steps = (upper - lower) / _CELLS
    moves = (found["jacobian"][:, :3] * steps).reshape(len(pairs), -1, 3, len(joints.names))
    areas = np.array([np.cross(part[..., i], part[..., j]) for part, (i, j) in zip(moves, pairs, strict=True)])
    points = found["placement"][:, :3, 3].reshape(len(pairs), _CELLS, _CELLS, 3)
    axes = joints.chain.jacobian(rest[list(joints.indices)])[3:]
    return _Swept(pairs, areas, points, np.sum(np.linalg.norm(areas, axis=-1), axis=-1), axes)


def _covered(swept: _Swept, directions: Sequence[Array], allowed: Flags) -> Array:
    """Return how much of its plane each pair covers that is allowed, 0 for the others. (pairs,), m2."""
    size = float(np.ptp(swept.points.reshape(-1, 3), axis=0).max()) / _SQUARES
    covered = np.zeros(len(swept.pairs))
    for which in np.flatnonzero(allowed).tolist():
        points = swept.points[which] @ directions[which].T
        low, high = points.min(axis=(0, 1)), points.max(axis=(0, 1))
        cells = np.ceil((high - low) / size).astype(int) + 1
        box = np.array([low, low + cells * size])
        filled = best_in_cells(points, np.ones(points.shape[:2]), box, (int(cells[0]), int(cells[1])))
        most = swept.shadow(which, np.cross(*directions[which]))  # a curve fills squares, and has no area
        covered[which] = min(np.count_nonzero(np.isfinite(filled)) * size**2, most)
    return covered


def _first_largest(covered: Array) -> int:
    """Return which is the largest, the first of nearly equal ones."""
    return int(np.argmax(covered >= covered.max() * (1 - _EQUAL)))


def _one_normal(areas: Array, up: Array) -> Array | None:
    """Return the normal of the plane that the tool stays in, upwards if it is not level; None if there is none."""
    each = areas.reshape(-1, 3)
    sizes = np.linalg.norm(each, axis=1)
    moments = each.T @ (each / np.maximum(sizes, 1e-300)[:, None])
    values, vectors = np.linalg.eigh(moments)
    if values[1] > _PLANAR * values[2]:
        return None
    normal = _clean(vectors[:, 2])
    return _signed(normal) if abs(normal @ up) < _ROUND else normal * np.sign(normal @ up)


def _level_normal(areas: Array, up: Array) -> Array:
    """Return the horizontal direction (3,) across which a surface of such elements (k, 3) has its largest shadow."""
    plane = _level(up)
    level = areas @ plane.T
    moments = level.T @ (level / np.maximum(np.linalg.norm(level, axis=1), 1e-300)[:, None])
    values, vectors = np.linalg.eigh(moments)
    long = values[1] - values[0] > _ROUND * values[1]
    return _clean(vectors[:, 1] @ plane) if long else plane[1]


# --- directions in the picture


def _level(normal: Array) -> Array:
    """Return what is to the right and up (2, 3) in a plane that is seen against its normal: x, or y, to the right."""
    axis = np.eye(3)[0 if abs(normal[0]) < _UPRIGHT else 1]
    right = _clean(axis - (axis @ normal) * normal)
    return np.array([right, _clean(np.cross(normal, right))])


def _upright(normal: Array, up: Array) -> Array:
    """Return what is to the right and up (2, 3) in a plane with this normal: the steepest direction up."""
    right = _signed(_clean(np.cross(up, normal)))
    steep = np.cross(normal, right)
    return np.array([right, _clean(steep * np.sign(steep @ up))])


def _signed(direction: Array) -> Array:
    """Return a direction with the sign that makes its largest entry positive, the first of equal ones."""
    signed: Array = direction * np.sign(direction[np.argmax(np.abs(direction).round(9))]) + 0.0
    return signed


def _clean(direction: Array) -> Array:
    """Return a unit vector without the rounding of one that is along axes."""
    direction = np.where(np.abs(direction) < 1e-9 * np.linalg.norm(direction), 0.0, direction)
    unit: Array = direction / np.linalg.norm(direction) + 0.0
    return unit
