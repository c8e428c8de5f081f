"""The extent of links that are drawn with primitives only: boxes, cylinders, spheres, capsules."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinetostat.lint.subject import Subject, first, name_of, number, once, vector
from kinetostat.screw import so3
from kinetostat.urdf.document import Element

__all__ = ["Extent", "extent_of", "extents_of"]

LARGEST = 1e9  # m: beyond it a size is no size


@dataclass(frozen=True)
class Extent:
    """What a link may fill: all its shapes are primitives.

    Attributes:
        low, high: corners of the box along the link's axes that holds every shape, m.
        volume: of the shapes added up, m3; of the collision shapes, if there are any.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    volume: float

    @property
    def sides(self) -> tuple[float, ...]:
        """Of the box, m."""
        return tuple(high - low for low, high in zip(self.low, self.high, strict=True))

    @property
    def half_diagonal(self) -> float:
        """Of the box, m: no mass inside it has a larger radius of gyration (Popoviciu's inequality)."""
        return math.hypot(*self.sides) / 2

    def outside(self, point: tuple[float, ...]) -> float:
        """Return how far a point is outside the box, m; 0 inside."""
        beyond = (max(low - p, p - high, 0.0) for low, p, high in zip(self.low, point, self.high, strict=True))
        return math.hypot(*beyond)


@once
def extents_of(subject: Subject) -> Mapping[str, Extent]:
    """Return the extents of the links that have one, in file order; they are found once for each subject."""
    return {name_of(link): extent for link in subject.links if (extent := extent_of(link)) is not None}


def extent_of(link: Element) -> Extent | None:
    """Return the extent of a link; None if it has no shape, or one that is no primitive or cannot be read."""
    boxes, volumes = [], {"visual": 0.0, "collision": 0.0}
    for kind in volumes:
        for shape in link.all(kind):
            box = _box(shape)
            if box is None:
                return None
            low, high, volume = box
            boxes.append((low, high))
            volumes[kind] += volume
    if not boxes:
        return None
    low = np.min([each for each, _ in boxes], axis=0)
    high = np.max([each for _, each in boxes], axis=0)
    return Extent(tuple(low.tolist()), tuple(high.tolist()), volumes["collision"] or volumes["visual"])


def _box(shape: Element) -> tuple[np.ndarray, np.ndarray, float] | None:
    """Return the corners of the box around a visual or collision in the link's frame, and the shape's volume."""
    geometry, origin = first(shape, "geometry"), first(shape, "origin")
    solid = _solid(geometry.children[0]) if geometry is not None and len(geometry.children) == 1 else None
    if solid is None or (origin is not None and "quat_xyzw" in origin.attributes):
        return None
    placed = [(0.0,) * 3, (0.0,) * 3]
    for i, key in enumerate(("xyz", "rpy")):
        if origin is not None and key in origin.attributes:
            read = vector(origin, key, 3)
            if read is None or max(map(abs, read)) > LARGEST:
                return None
            placed[i] = (read[0], read[1], read[2])
    rotation = so3.from_rpy(np.array(placed[1])) if any(placed[1]) else np.eye(3)
    reach = solid.reach(rotation)
    return np.array(placed[0]) - reach, np.array(placed[0]) + reach, solid.volume


@dataclass(frozen=True)
class _Solid:
    """A box of half sides `core`, rounded by a disc about its z and by a ball; the volume of it all."""

    core: tuple[float, float, float]
    disc: float
    ball: float
    volume: float

    def reach(self, rotation: np.ndarray) -> np.ndarray:
        """Return how far it reaches from its middle along each axis of the frame that it is turned in."""
        across = np.sqrt(np.maximum(1 - rotation[:, 2] ** 2, 0.0))
        return np.asarray(np.abs(rotation) @ np.array(self.core) + self.disc * across + self.ball)


def _solid(shape: Element) -> _Solid | None:
    """Return a primitive; None if it is none, or has no size that can be."""
    if shape.tag == "box":
        size = vector(shape, "size", 3)
        if size is None or not all(0 < side < LARGEST for side in size):
            return None
        x, y, z = size
        return _Solid((x / 2, y / 2, z / 2), 0.0, 0.0, x * y * z)
    radius, length = number(shape, "radius"), number(shape, "length")
    if radius is None or not 0 < radius < LARGEST:
        return None
    ball = 4 / 3 * math.pi * radius**3
    if shape.tag == "sphere":
        return _Solid((0.0, 0.0, 0.0), 0.0, radius, ball)
    if shape.tag not in ("cylinder", "capsule") or length is None or not 0 < length < LARGEST:
        return None
    core, rod = (0.0, 0.0, length / 2), math.pi * radius**2 * length
    return _Solid(core, radius, 0.0, rod) if shape.tag == "cylinder" else _Solid(core, 0.0, radius, rod + ball)
