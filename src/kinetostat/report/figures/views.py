"""From which sides an arm is drawn, and how large."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinetostat.analysis.skeleton import Skeleton
from kinetostat.conventions import Array
from kinetostat.report.figures.sheet import GAP, MARGINS, WIDTH

__all__ = ["NEGLIGIBLE", "in_words", "scaled", "view_of_all", "views_of"]

NEGLIGIBLE = 1e-6  # of the largest: thinner than any line
_X, _Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
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


def view_of_all(arms: Sequence[Skeleton]) -> Array:
    """Return the one drawing plane (2, 3), of those that each arm would have first, that shows most of all of them."""
    seen = [views_of(arm)[0] for arm in arms]
    shown = [sum(float(np.trace(view @ _spread(arm.points) @ view.T)) for arm in arms) for view in seen]
    return seen[int(np.argmax(np.array(shown) > max(shown) * (1 - 1e-9)))]


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


def _plane(normal: Array) -> Array:
    """Return right and up (2, 3) of the plane across a normal: z up where it can be seen, else x to the right."""
    up = _Z - (_Z @ normal) * normal
    if np.linalg.norm(up) > 1e-3:
        up /= np.linalg.norm(up)
        right = np.cross(up, normal)
        return np.array([right * np.sign(right[np.argmax(np.abs(right) > 1e-9)]), up])
    right = _X - (_X @ normal) * normal
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(normal * np.sign(normal[2]), right)])


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
