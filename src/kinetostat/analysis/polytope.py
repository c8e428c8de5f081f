"""Polytopes {x : lower <= A x <= upper}: corners, facets and unbounded lines. Pure mathematics on arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinetostat.conventions import Array

__all__ = ["Polytope", "polytope"]

_NO_ROW = 1e-9  # of the largest singular value: below it a direction is not bounded
_ON_FACE = 1e-7  # of the polytope's size


@dataclass(frozen=True)
class Polytope:
    """The corners of {x : lower <= A x <= upper} across its unbounded lines.

    Attributes:
        vertices: (k, m).
        lines: an orthonormal basis of the null space of A, (r, m).
        facets: indices of the corners of each facet: triangles in space, edges in a plane, single ends on a line.
        facet_rows: the row of A whose bound each facet lies on.
        radius: the largest ball about zero inside, across the lines; 0 if zero is outside.
        holds_zero: whether zero is inside.
    """

    vertices: Array
    lines: Array
    facets: Array
    facet_rows: tuple[int, ...]
    radius: float
    holds_zero: bool


def polytope(matrix: Array, lower: Array, upper: Array) -> Polytope | None:
    """Return the polytope {x : lower <= A x <= upper}, or None if it is empty (or without inner points).

    Bounded across the null space of A; the corners by halfspace intersection about the centre of the largest inner
    ball, found by linear programming (S. Boyd and L. Vandenberghe, "Convex Optimization", 2004, section 8.5.1).

    Args:
        matrix: A, (n, m), m of 1, 2 or 3.
        lower: (n,).
        upper: (n,).
    """
    size = matrix.shape[1]
    if not len(matrix):
        return Polytope(np.zeros((1, size)), np.eye(size), np.zeros((0, size), dtype=int), (), 0.0, holds_zero=True)
    _, values, right = np.linalg.svd(matrix)
    rank = int(np.sum(values > _NO_ROW * values[0])) if values[0] > 0 else 0
    across, lines = right[:rank], right[rank:]
    within = matrix @ across.T
    normals = np.concatenate([within, -within])
    offsets = np.concatenate([upper, -lower])
    lengths = np.linalg.norm(normals, axis=1)
    bounding = lengths > _NO_ROW * lengths.max(initial=0.0)
    if np.any(offsets[~bounding] < 0):
        return None
    rows = np.flatnonzero(bounding)
    normals, offsets = normals[rows] / lengths[rows, None], offsets[rows] / lengths[rows]
    centre, inner = _largest_ball(normals, offsets)
    if centre is None or inner <= 0:
        return None
    corners, facets, on = _corners(normals, offsets, centre)
    radius = float(np.min(offsets))
    return Polytope(
        corners @ across,
        lines,
        facets,
        tuple(int(rows[i]) % len(matrix) for i in on),
        max(radius, 0.0),
        holds_zero=radius >= 0,
    )


def _largest_ball(normals: Array, offsets: Array) -> tuple[Array | None, float]:
    """Return centre and radius of the largest ball inside {x : N x <= b}, N of unit rows; None if it is empty."""
    from scipy.optimize import linprog

    scale = float(np.max(np.abs(offsets))) or 1.0
    cost = np.zeros(normals.shape[1] + 1)
    cost[-1] = -1.0
    bounds = [(None, None)] * normals.shape[1] + [(0, None)]
    found = linprog(cost, np.column_stack([normals, np.ones(len(normals))]), offsets / scale, bounds=bounds)
    return (found.x[:-1] * scale, float(found.x[-1]) * scale) if found.success else (None, 0.0)


def _corners(normals: Array, offsets: Array, centre: Array) -> tuple[Array, Array, list[int]]:
    """Return corners (k, m), facets as indices of corners, and the row of N that each facet lies on."""
    if normals.shape[1] == 1:
        ends = np.array([[np.max(-offsets[normals[:, 0] < 0])], [np.min(offsets[normals[:, 0] > 0])]])
        return ends, np.array([[0], [1]]), [int(np.argmin(np.abs(normals @ end - offsets))) for end in ends]
    from scipy.spatial import ConvexHull, HalfspaceIntersection

    scale = float(np.max(offsets - normals @ centre))
    halfspaces = np.column_stack([normals, (normals @ centre - offsets) / scale])
    points = HalfspaceIntersection(halfspaces, np.zeros(len(centre))).intersections
    hull = ConvexHull(points[_distinct(points)])
    corners = hull.points[hull.vertices]
    place = {int(old): new for new, old in enumerate(hull.vertices)}
    facets = np.array([[place[int(i)] for i in facet] for facet in hull.simplices])
    middles = np.mean(corners[facets], axis=1)
    gaps = np.abs(middles @ normals.T + halfspaces[:, -1])
    return corners * scale + centre, facets, [int(i) for i in np.argmin(gaps, axis=1)]


def _distinct(points: Array) -> list[int]:
    """Return the indices of points (k, m), of size one, that are not the same as an earlier one."""
    kept = list[int]()
    for i, point in enumerate(points):
        if not kept or np.min(np.max(np.abs(points[kept] - point), axis=1)) > _ON_FACE:
            kept.append(i)
    return kept
