"""From which sides an arm is drawn, and how large."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinetostat.analysis.level_axes import NEAR_AXIS, level_axis
from kinetostat.analysis.skeleton import Skeleton
from kinetostat.conventions import Array
from kinetostat.report.figures.sheet import GAP, MARGINS, WIDTH

__all__ = ["NEGLIGIBLE", "axis_titles", "in_words", "scaled", "seen_from_above", "view_of_all", "views_of"]

NEGLIGIBLE = 1e-6  # of the largest: thinner than any line
_X, _Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
_ON_AXIS = np.cos(np.radians(1))  # what is drawn along an axis, but for what files round
_UPRIGHT = np.sqrt(0.5)  # cosine of the angle to the vertical of an axis that is rather upright than level
_ROOM = 0.44  # in, around what is drawn: a joint's symbol and a little
_LARGEST_PANEL, _SMALLEST_PANEL = 3.9, 1.7  # in


def views_of(arm: Skeleton) -> list[Array]:
    """Return the drawing planes, each (2, 3): what is to the right and what is up, in the observer's axes."""
    points, axis = arm.points, arm.turning_axis
    if arm.normal is not None:
        plane = _plane(arm.normal)
        if len(points) == 1 or np.ptp(points @ plane.T, axis=0).max() > NEGLIGIBLE * np.ptp(points, axis=0).max():
            return [plane]
    spread = _spread(points)
    if axis is not None and sum(pivot.kind == "turning" for pivot in arm.pivots) > 1:  # a SCARA: from above
        return [_plane(axis), _plane(_least_spread(spread, axis))]
    aside = _least_spread(spread, _Z)
    front = _plane(aside)
    if spread[2, 2] < aside @ spread @ aside * (1 - 1e-9):
        return [_plane(_Z), front]
    return [front, _plane(front[0])]


def view_of_all(arms: Sequence[Skeleton], up: Array) -> Array:
    """Return the one drawing plane (2, 3) of an arm at several poses.

    A planar arm is seen in its plane. Any other is seen along the level axis that most of its joints share, with height
    upwards; from above where most axes are upright. A joint counts by how far the tool moves by it. An axis of the
    observer within 10 degrees is taken instead.

    Args:
        arms: the arm at each pose, one at least.
        up: the vertical in the observer's axes, a unit vector (3,).
    """
    if arms[0].normal is not None and _shows(_plane(arms[0].normal, up), arms):
        return _plane(arms[0].normal, up)
    if seen_from_above(arms, up):
        return _plane(up, up)
    axes, weights = _turns(arms)
    level = axes - np.outer(axes @ up, up)
    tilted = np.linalg.norm(level, axis=1) > _UPRIGHT
    if not np.any(tilted):
        return _plane(_least_spread(sum((_spread(arm.points) for arm in arms), np.zeros((3, 3))), up), up)
    level = level[tilted] / np.linalg.norm(level[tilted], axis=1)[:, None]
    shared = (np.abs(level @ level.T) > NEAR_AXIS) @ weights[tilted]
    return _plane(level_axis(level[int(np.argmax(shared > shared.max() * (1 - 1e-9)))], up), up)


def seen_from_above(arms: Sequence[Skeleton], up: Array) -> bool:
    """Return whether most axes of turning, two at least, are upright: those of a SCARA."""
    axes, weights = _turns(arms)
    upright = np.abs(axes @ up) > _UPRIGHT
    return bool(np.sum(upright) > len(arms) and weights[upright].sum() > weights.sum() / 2)


def _turns(arms: Sequence[Skeleton]) -> tuple[Array, Array]:
    """Return the axes of turning at all poses, and how far the tool moves by each. (k, 3), (k,)."""
    turning = [(arm, pivot) for arm in arms for pivot in arm.pivots if pivot.kind in ("turning", "screw", "planar")]
    axes = np.array([pivot.axis for _, pivot in turning]).reshape(-1, 3)
    arms_of = np.array([arm.points[-1] - arm.points[pivot.vertex] for arm, pivot in turning]).reshape(-1, 3)
    moves = np.linalg.norm(np.cross(axes, arms_of), axis=1)
    return axes, moves if np.any(moves > 0) else np.ones(len(axes))


def _shows(plane: Array, arms: Sequence[Skeleton]) -> bool:
    """Return whether an arm that has a length has one in a plane."""
    points = np.concatenate([arm.points for arm in arms])
    return bool(np.ptp(points @ plane.T, axis=0).max() >= NEGLIGIBLE * np.ptp(points, axis=0).max())


def _least_spread(spread: Array, across: Array) -> Array:
    """Return the direction (3,) at right angles to another along which the arm extends least.

    A direction of the observer's axes reads easier, and wins where it hides hardly more.
    """
    plane = _plane(across)
    values, vectors = np.linalg.eigh(plane @ spread @ plane.T)
    least: Array = vectors[:, 0] @ plane
    for axis in np.eye(3):
        if abs(axis @ across) < NEGLIGIBLE and axis @ spread @ axis - values[0] <= 0.05 * np.trace(spread):
            least = axis
    return least


def _plane(normal: Array, vertical: Array = _Z) -> Array:
    """Return right and up (2, 3) of the plane across a normal: the vertical up where it can be seen, else x right."""
    up = vertical - (vertical @ normal) * normal
    if np.linalg.norm(up) > 1e-3:
        up /= np.linalg.norm(up)
        right = np.cross(up, normal)
        return np.array([right * np.sign(right[np.argmax(np.abs(right) > 1e-9)]), up])
    axis = _X if abs(normal[0]) < 0.9 else np.eye(3)[1]
    right = axis - (axis @ normal) * normal
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(normal * np.sign(normal @ vertical), right)])


def _spread(points: Array) -> Array:
    """Return the second moments (3, 3) of the lines between points (k, 3) about their centre, per length."""
    if len(points) == 1:
        return np.zeros((3, 3))
    start, end = points[:-1], points[1:]
    length = np.linalg.norm(end - start, axis=1)
    places, weights = np.vstack([start, (start + end) / 2, end]), np.r_[length, 4 * length, length]  # Simpson: exact
    return np.cov(places.T, aweights=weights, bias=True)


def scaled(extents: Sequence[Array]) -> tuple[list[Array], list[tuple[float, float]]]:
    """Return limits (2, 2) of each panel's axes in m, and its size in inches: all to one scale, equally high."""
    spans = np.array([upper - lower for lower, upper in extents])
    available = WIDTH - MARGINS - GAP * (len(extents) - 1) - _ROOM * len(extents)
    widest, highest = max(float(spans[:, 0].sum()), 1e-300), max(float(spans[:, 1].max()), 1e-300)
    inches = min(available / widest, (_LARGEST_PANEL - _ROOM) / highest)
    sizes = np.maximum(_SMALLEST_PANEL, np.c_[spans[:, 0], np.full(len(spans), highest)] * inches + _ROOM)
    boxes = []
    for (lower, upper), size in zip(extents, sizes, strict=True):
        half, middle = size / inches / 2, (lower + upper) / 2
        boxes.append(np.array([middle - half, middle + half]))
    return boxes, [(float(width), float(height)) for width, height in sizes]


def in_words(direction: Array) -> str:
    """Return a direction (3,) in words: x, or 0.87 x + 0.5 y."""
    words = ""
    for value, letter in zip(direction, "xyz", strict=True):
        if abs(value) > 5e-4:
            sign = (" - " if value < 0 else " + ") if words else ("-" if value < 0 else "")
            size = f"{abs(value):.3g} "
            words += f"{sign}{'' if size == '1 ' else size}{letter}"
    return words


def axis_titles(view: Array, up: Array | None = None) -> tuple[str, str]:
    """Return what is to the right and up (2, 3) in words: x, or across (25° from x); z, or height if that is up."""
    right, upward = view
    height = up is not None and upward @ up > _ON_AXIS
    return _title(right, "across"), _title(upward, "height" if height else "up")


def _title(direction: Array, words: str) -> str:
    """Return the axis of the observer that a direction is along, else words and the nearest axis."""
    nearest = int(np.argmax(np.abs(direction).round(3)))
    cosine = float(min(abs(direction[nearest]), 1.0))
    axis = f"{'-' if direction[nearest] < 0 else ''}{'xyz'[nearest]}"
    if cosine > _ON_AXIS:
        return axis
    return words if words == "height" else f"{words} ({np.degrees(np.arccos(cosine)):.0f}° from {axis})"
