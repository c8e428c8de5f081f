"""From where a limb is looked at, and which two of its joints show most of its workspace there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.kernels import chain_kernel
from kinetostat.analysis.level_axes import level_axis
from kinetostat.analysis.profile.cells import best_in_cells
from kinetostat.conventions import Array, Flags

__all__ = ["View", "views_of_limb"]

_CELLS = 17  # of each joint's range, in whose middles areas are taken
_PLANAR = 1e-6  # share of area across its main direction: an arm with less moves in one plane
_FLAT = 0.9  # part of a surface that its shadow has: more is flat
_WORTH, _MUCH = 0.02, 0.25  # of the largest area: what is worth a picture, and what is not much less
_THIN = 1e-3  # of the largest area: less is a curve
_NOTHING = 1e-8  # of the square of the robot's reach
_ROUND = 0.05  # what is less longer than wide has no long direction
_LEVEL = np.sqrt(0.5)  # sine of the slope up to which a plane is seen from above
_SQUARES, _EQUAL = 64, 0.1  # across all that is swept; and what areas may differ by that are taken for equal
_FARTHER, _MOSTLY = 0.25, 0.5  # what an elbow changes the distance by, at least; and of what another joint does
_PARALLEL = 1e-6  # what the cosine of an angle lacks of 1: files write a quarter turn as 1.5708
_UPRIGHT = 0.9  # an axis that is nearer to the vertical does not tell what is to the right


@dataclass(frozen=True)
class View:
    """A way to look at a limb.

    Attributes:
        view: from the side, or from above.
        directions: unit vectors to the right and up in the picture, in the observer's axes. (2, 3).
        pair: indices of the two coordinates that show most of the workspace there, the first first.
        flat: whether the tool stays in that plane, or nearly, while the second changes how far it is from the first.
    """

    view: Literal["side", "above"]
    directions: Array
    pair: tuple[int, int]
    flat: bool


def views_of_limb(joints: Coordinates, rest: Array, up: Array, ends: tuple[Array, Array]) -> tuple[View, ...]:
    """Return the planes in which a limb is drawn, each with the two joints that show most of its workspace there.

    A pair of joints sweeps a surface, whose element of area is (dp/dq_i x dp/dq_j) dq_i dq_j with p the tool's origin.
    Its shadow on a plane with the unit normal m is the part along m. The second joint is to be an elbow, a knee, or a
    slide: one that changes how far the tool is from the first. Two joints of a shoulder, which swing a rigid arm, are
    taken only where there are no others. Of these pairs the one that covers the largest area of the plane is shown,
    and the one with the earlier joints where areas are nearly equal, so that left and right agree.

    From the side, m is horizontal and such that the shadow is largest, of pairs that keep the tool in that plane if
    there are any: a surface that is seen flat shows the arm better than a sphere that hides itself. From above, m is
    the vertical, and a pair whose first joint turns about it comes before others, with the same elbow if it can be. An
    arm that moves its tool in one plane is seen in its true shape, once.

    Args:
        joints: the coordinates of the limb.
        rest: the configuration of the robot in which all others are held, (nq,).
        up: the vertical in the observer's axes, a unit vector (3,).
        ends: lower and upper end of each coordinate, (n,), (n,).

    Returns:
        At most one from the side and one from above; none where no two joints sweep an area. The one in whose plane
        the arm mainly moves comes first: the side, but for an arm like a SCARA, which is flat from above alone.
    """
    swept = _swept(joints, rest, ends)
    if swept is None or not swept.sizes.max() > _NOTHING * joints.model.robot.reach**2:
        return ()
    normal = _one_normal(swept.areas, up)
    if normal is not None:
        seen: Literal["side", "above"] = "above" if normal @ up > _LEVEL else "side"
        directions = _level(normal) if seen == "above" else _upright(normal, up)
        covered = _covered(swept, [directions] * len(swept.pairs))
        which = _chosen(covered, swept.elbows)
        return (View(seen, directions, swept.pairs[which], bool(swept.elbows[which])),)
    normals = [_level_normal(part, up) for part in swept.areas]
    shadows = np.array([swept.shadow(which, across) for which, across in enumerate(normals)])
    flat = shadows > _FLAT * swept.sizes
    uprights = [_upright(across, up) for across in normals]
    side = _chosen(_covered(swept, uprights), swept.elbows, flat)
    upright = np.array([swept.turns_about(first, up) for first, _ in swept.pairs])
    same = np.array([second == swept.pairs[side][1] for _, second in swept.pairs])
    covered = _covered(swept, [_level(up)] * len(swept.pairs))
    above = _chosen(covered, swept.elbows | same, upright & same & swept.elbows, upright & same, upright, same)
    shadow = swept.shadow(above, up)
    level = bool(shadow > _FLAT * swept.sizes[above] and swept.elbows[above])
    views = (
        (View("side", uprights[side], swept.pairs[side], bool(flat[side] & swept.elbows[side])), shadows[side]),
        (View("above", _level(up), swept.pairs[above], level), shadow),
    )
    shown = [view for view, area in views if area > _THIN * swept.sizes.max()]
    return tuple(sorted(shown, key=lambda view: not view.flat))


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
        elbows: whether the second of each pair changes how far the tool is from the first. (pairs,).
    """

    pairs: list[tuple[int, int]]
    areas: Array
    points: Array
    sizes: Array
    axes: Array
    elbows: Flags

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
    columns, tool = joints.chain.columns(rest[list(joints.indices)])
    held = columns @ joints.chain.fold
    away = [_distances(held[:, pair], tool[:3, 3], each[:, 0]) for pair, each in zip(pairs, points, strict=True)]
    changes, largest = np.ptp(away, axis=1), np.max(away, axis=1)
    most = [changes[[one == first for one, _ in pairs]].max() for first, _ in pairs]
    elbows = (changes > _FARTHER * largest) & (changes > _MOSTLY * np.array(most))
    return _Swept(pairs, areas, points, np.sum(np.linalg.norm(areas, axis=-1), axis=-1), held[3:], elbows)


def _distances(held: Array, tool: Array, points: Array) -> tuple[float, float]:
    """Return the least and the largest distance of the tool from the first of two joints while the second moves.

    It is the distance from the point of the first axis that is nearest to the second, which neither of them moves; of
    axes that are nearly parallel, from the one nearest to the tool. Where one of the two slides, it is how far the tool
    comes.

    Args:
        held: the twists of the tool by the two where all joints are held. (6, 2).
        tool: the tool there. (3,), m.
        points: the tool where the second moves alone. (cells, 3), m.
    """
    sizes = np.linalg.norm(held[3:], axis=0)
    if not np.all(sizes > 0):
        return 0.0, float(np.linalg.norm(np.ptp(points, axis=0)))
    moves, (w, u) = (held[:3] / sizes).T, (held[3:] / sizes).T
    first, second = tool + np.cross((w, u), moves)  # the point of each axis that is nearest to the tool
    aslant, gap = 1 - (w @ u) ** 2, second - first
    along = (w @ gap - (w @ u) * (u @ gap)) / aslant if aslant > 1 - _FLAT**2 else 0.0
    away = np.linalg.norm(points - first - along * w, axis=1)
    return float(away.min()), float(away.max())


def _covered(swept: _Swept, directions: Sequence[Array]) -> Array:
    """Return how much of its plane each pair covers. (pairs,), m2."""
    size = float(np.ptp(swept.points.reshape(-1, 3), axis=0).max()) / _SQUARES
    covered = np.zeros(len(swept.pairs))
    for which in range(len(swept.pairs)):
        points = swept.points[which] @ directions[which].T
        low, high = points.min(axis=(0, 1)), points.max(axis=(0, 1))
        cells = np.ceil((high - low) / size).astype(int) + 1
        box = np.array([low, low + cells * size])
        filled = best_in_cells(points, np.ones(points.shape[:2]), box, (int(cells[0]), int(cells[1])))
        most = swept.shadow(which, np.cross(*directions[which]))  # a curve fills squares, and has no area
        covered[which] = min(np.count_nonzero(np.isfinite(filled)) * size**2, most)
    return covered


def _chosen(covered: Array, wanted: Flags, *preferred: Flags) -> int:
    """Return which area is the largest of the wanted ones, the first of nearly equal ones.

    What is preferred comes before them, first things first, where its area is not much less; all are wanted if none is.
    """
    wanted = wanted & (covered > _WORTH * covered.max())
    if not np.any(wanted):
        wanted = np.ones(len(covered), dtype=bool)
    enough = wanted & (covered > _MUCH * covered[wanted].max())
    wanted = next((flags & enough for flags in preferred if np.any(flags & enough)), wanted)
    among = np.where(wanted, covered, 0.0)
    return int(np.argmax(among >= among.max() * (1 - _EQUAL)))


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
    """Return the horizontal direction (3,) across which a surface of such elements (k, 3) has its largest shadow.

    An axis of the observer within 10 degrees is taken instead.
    """
    plane = _level(up)
    level = areas @ plane.T
    moments = level.T @ (level / np.maximum(np.linalg.norm(level, axis=1), 1e-300)[:, None])
    values, vectors = np.linalg.eigh(moments)
    long = values[1] - values[0] > _ROUND * values[1]
    return _clean(level_axis(vectors[:, 1] @ plane, up)) if long else plane[1]


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
