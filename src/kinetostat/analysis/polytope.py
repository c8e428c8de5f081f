"""Polytopes {x : lower <= A x <= upper}: corners, facets and unbounded lines. Pure mathematics on arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from kinetostat.conventions import Array

__all__ = ["Polytope", "polytope"]

_NO_ROW = 1e-9  # of the largest singular value: below it a direction is not bounded
_SAME = 1e-7  # of the polytope's extent: corners so near are one
_ROUNDS = 4  # of finding the extent, each in the units of the one before


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

    Bounded across the null space of A. With A = U diag(s) V^T it is {y : lower <= U y <= upper} in y = diag(s) V^T x,
    which is as well shaped near a null space as far from it; there the corners come by halfspace intersection about the
    centre of the largest inner ball, found by linear programming (S. Boyd and L. Vandenberghe, "Convex Optimization",
    2004, section 8.5.1; Qhull: C. Barber, D. Dobkin and H. Huhdanpaa, 1996; HiGHS: Q. Huangfu and J. Hall, 2018).

    Args:
        matrix: A, (n, m), m of 1, 2 or 3.
        lower: (n,).
        upper: (n,).
    """
    size = matrix.shape[1]
    if not len(matrix):
        return Polytope(np.zeros((1, size)), np.eye(size), np.zeros((0, size), dtype=int), (), 0.0, holds_zero=True)
    left, values, right = np.linalg.svd(matrix, full_matrices=True)
    rank = int(np.sum(values > _NO_ROW * values[0])) if values[0] > 0 else 0
    if rank == 0:
        inside = bool(np.all(lower <= 0) and np.all(upper >= 0))
        nothing = np.zeros((0, size), dtype=int)
        return Polytope(np.zeros((1, size)), np.eye(size), nothing, (), 0.0, holds_zero=True) if inside else None
    within = left[:, :rank]
    normals, offsets = np.concatenate([within, -within]), np.concatenate([upper, -lower])
    if np.any(offsets[np.all(normals == 0, axis=1)] < 0):
        return None
    body = _Halfspaces(normals, offsets, np.arange(2 * len(matrix))).scaled()
    if body is None:
        return None
    corners, facets, on = body.corners()
    rows = matrix @ right[:rank].T  # of x across the lines
    lengths = np.linalg.norm(np.concatenate([rows, -rows]), axis=1)
    felt = lengths > 0
    radius = float(np.min(offsets[felt] / lengths[felt]))
    return Polytope(
        corners / values[:rank] @ right[:rank],
        right[rank:],
        facets,
        tuple(int(i) % len(matrix) for i in on),
        max(radius, 0.0),
        holds_zero=radius >= 0,
    )


@dataclass(frozen=True)
class _Halfspaces:
    """{z : N z <= b}, z = (y - middle) / extent, and which row of a matrix each halfspace is from."""

    normals: Array
    offsets: Array
    rows: npt.NDArray[np.int64]
    middle: Array | float = 0.0
    extent: Array | float = 1.0

    def scaled(self) -> _Halfspaces | None:
        """Return the body in units of its own extent along each axis, without what cannot touch it; None if empty."""
        body = self
        for _ in range(_ROUNDS):
            box = body._box()
            if box is None:
                return None
            body = body._in_box(*box)
        return body

    def _box(self) -> tuple[Array, Array] | None:
        """Return the least and the largest coordinates; None if it is empty, or flat."""
        from scipy.optimize import linprog

        size = self.normals.shape[1]
        ends = np.empty((2, size))
        for k in range(size):
            for i, sign in enumerate((1.0, -1.0)):
                cost = np.zeros(size)
                cost[k] = sign
                found = linprog(cost, self.normals, self.offsets, bounds=[(None, None)] * size)
                if not found.success:
                    return None
                ends[i, k] = found.x[k]
        return (ends[0], ends[1]) if np.all(ends[1] > ends[0]) else None

    def _in_box(self, low: Array, high: Array) -> _Halfspaces:
        """Return the body in units of a box about it, in which it is within -1 and 1."""
        middle, half = (low + high) / 2, (high - low) / 2
        offsets, normals = self.offsets - self.normals @ middle, self.normals * half
        lengths = np.linalg.norm(normals, axis=1)
        lengths = np.where(lengths > 0, lengths, 1.0)
        offsets, normals = offsets / lengths, normals / lengths[:, None]
        # A halfspace that holds the box, and some more, does not touch the body.
        near = offsets < 1.01 * np.sum(np.abs(normals), axis=1)
        place = self.middle + self.extent * middle
        return _Halfspaces(normals[near], offsets[near], self.rows[near], place, self.extent * half)

    def corners(self) -> tuple[Array, Array, Array]:
        """Return corners y (k, r), facets as indices of corners, and the row that each facet lies on."""
        if self.normals.shape[1] == 1:
            ends = np.array(
                [[np.max(-self.offsets[self.normals[:, 0] < 0])], [np.min(self.offsets[self.normals[:, 0] > 0])]]
            )
            return self._placed(ends), np.array([[0], [1]]), self._rows_at(ends)
        from scipy.spatial import ConvexHull, HalfspaceIntersection

        halfspaces = np.column_stack([self.normals, -self.offsets])
        points = HalfspaceIntersection(halfspaces, self._inner_point()).intersections
        hull = ConvexHull(points[_distinct(points)])
        corners = hull.points[hull.vertices]
        place = {int(old): new for new, old in enumerate(hull.vertices)}
        facets = np.array([[place[int(i)] for i in facet] for facet in hull.simplices])
        return self._placed(corners), facets, self._rows_at(np.mean(corners[facets], axis=1))

    def _inner_point(self) -> Array:
        """Return the centre of the largest ball inside."""
        from scipy.optimize import linprog

        size = self.normals.shape[1]
        cost = np.append(np.zeros(size), -1.0)
        bounds = [(None, None)] * size + [(0, None)]
        found = linprog(cost, np.column_stack([self.normals, np.ones(len(self.normals))]), self.offsets, bounds=bounds)
        return np.asarray(found.x[:-1])

    def _rows_at(self, points: Array) -> Array:
        """Return the row whose bound is nearest to each point."""
        return np.asarray(self.rows[np.argmin(np.abs(points @ self.normals.T - self.offsets), axis=1)])

    def _placed(self, points: Array) -> Array:
        return np.asarray(self.middle + points * self.extent)


def _distinct(points: Array) -> list[int]:
    """Return the indices of points (k, m), of size one, that are not the same as an earlier one."""
    kept = list[int]()
    for i, point in enumerate(points):
        if not kept or np.min(np.max(np.abs(points[kept] - point), axis=1)) > _SAME:
            kept.append(i)
    return kept
