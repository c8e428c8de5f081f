"""The axes of joints as lines in space, and the special positions that lines can have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.singular.mechanism import Mechanism
from kinetostat.conventions import Array

__all__ = ["TOUCHING", "Axis", "axes_at", "distance", "in_one_plane", "meeting_point", "parallel"]

TOUCHING = 1e-4  # directions in rad, distances in L: rounded files are to be explained, too


@dataclass(frozen=True)
class Axis:
    """The axis of a joint at a configuration: a turning joint's line, or a slide's direction alone."""

    joint: str
    direction: Array
    point: Array | None  # None for a slide


def axes_at(mechanism: Mechanism, q: Array) -> tuple[Axis, ...] | None:
    """Return the axis of each coordinate; None where one drives several joints, or is a screw with pitch."""
    fold = mechanism.chain.fold
    if np.any(np.count_nonzero(fold, axis=0) != 1) or np.any(np.count_nonzero(fold, axis=1) > 1):
        return None
    columns, placement = mechanism.chain.columns(q)
    tool, found = placement[:3, 3], []
    for i, joint in enumerate(mechanism.names):
        column = columns[:, int(np.flatnonzero(fold[:, i])[0])]
        v, w = column[:3], column[3:]
        if float(np.linalg.norm(w)) < 0.5:
            found.append(Axis(joint, v / np.linalg.norm(v), None))
        elif abs(float(v @ w)) > 1e-9 * mechanism.length:
            return None
        else:
            found.append(Axis(joint, w, tool + np.cross(w, v)))
    return tuple(found)


def parallel(axes: Sequence[Axis]) -> bool:
    """Return whether all directions are one."""
    return all(float(np.linalg.norm(np.cross(axes[0].direction, axis.direction))) < TOUCHING for axis in axes[1:])


def meeting_point(axes: Sequence[Axis], length: float) -> Array | None:
    """Return the point in which lines meet; None if they do not, or if they are parallel."""
    blocks = [np.eye(3) - np.outer(axis.direction, axis.direction) for axis in axes]
    points = [axis.point for axis in axes if axis.point is not None]
    matrix = np.concatenate(blocks)
    values = np.linalg.svd(matrix, compute_uv=False)
    if values[-1] < TOUCHING:
        return None
    right = np.concatenate([block @ point for block, point in zip(blocks, points, strict=True)])
    centre: Array = np.linalg.lstsq(matrix, right, rcond=None)[0]
    return centre if max(distance(axis, centre) for axis in axes) < TOUCHING * length else None


def distance(axis: Axis, point: Array) -> float:
    """Return the distance of a point from a line, in m."""
    assert axis.point is not None
    return float(np.linalg.norm(np.cross(point - axis.point, axis.direction)))


def in_one_plane(axes: Sequence[Axis], length: float, point: Array | None = None) -> bool:
    """Return whether lines, and the point if one is given, lie in one plane; distances in units of a length."""
    points = np.array([axis.point for axis in axes] + ([] if point is None else [point]))
    vectors = np.concatenate([(points[1:] - points[0]) / length, [axis.direction for axis in axes]])
    return bool(len(vectors) < 3 or np.linalg.svd(vectors, compute_uv=False)[2] < TOUCHING)
