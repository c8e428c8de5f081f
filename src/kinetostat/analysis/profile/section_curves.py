"""Where a limb is singular while two of its joints move: curves over both, traced to rounding."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from kinetostat.analysis.profile.two_joints import TwoJoints, grid_of
from kinetostat.analysis.singular.find import SingularFamilies
from kinetostat.analysis.singular.mechanism import MODEL
from kinetostat.analysis.singular.slices import Curve, positions_in_words
from kinetostat.conventions import Array, Flags

__all__ = ["SINGULAR", "runs", "singular_curves", "singular_lines"]

SINGULAR = 1e-6  # of the largest smallest singular value of the section: a vertex that has more is not drawn
_POINTS = 181
_EDGE = 1e-7  # rad or m beyond a limit that a curve is traced: it may lie on the limit
_OFF = 0.1  # of a step: lines of the grid keep off round positions, where zeros are
_ALL = 1e-9  # of the largest singular value: where the smallest is below it everywhere, there are no curves
_SAME = 1e-6  # rad or m: two curves, or two positions, that are one
_POINT = 1e-9  # m: what is no longer is a point of the plane, not a curve
_ROUND = 0.01  # of the square of its extent, the area that a curve goes round at least
_STEPS = 40  # of false position at most

Determinant = Callable[[Array], Array]


def singular_curves(two: TwoJoints, directions: Array, families: SingularFamilies | None) -> tuple[list[Curve], ...]:
    """Return the singular curves inside limits, and those beyond them, were there no limits, in a plane (2, 3).

    Beyond limits, what continues a curve inside them, and what goes round an area; a piece alone tells nothing.
    """
    inside, beyond = list[Curve](), list[Curve]()
    for line in singular_lines(two, families):
        points, label = two.computed(line)["placement"][..., :3, 3] @ directions.T, _label(two, line)
        within = two.inside(line, 2 * _EDGE)
        outside = _touching(~within)  # up to the limit
        told = np.any(within) or _goes_round(points)
        for found, wanted in ((inside, within), (beyond, outside & told)):
            parts = [points[run] for run in runs(wanted)]
            found += [Curve(label, part, "singular") for part in parts if np.ptp(part, axis=0).max() > _POINT]
    return inside, beyond


def singular_lines(two: TwoJoints, families: SingularFamilies | None) -> list[Array]:
    """Return the lines (k, 2) over two coordinates on which a limb is singular, limits of angles left out.

    Where as many rows count as joints move them, the Jacobian is square, and its determinant changes sign across a
    singular curve: contour lines, whose vertices are then moved along the lines of the grid until it is zero.
    Otherwise, and where it touches zero, lines are those of families that hold one of the two joints at a position, and
    no other joint at one where it is not. A vertex stays if its smallest singular value is zero indeed.
    """
    x, y = (_lines(two, index) for index in two.pair)
    grid = grid_of(x, y)
    found = two.computed(grid)
    values = found["singular_values"]
    largest = float(values[two.inside(grid, 2 * _EDGE), -1].max())
    if not largest > _ALL * float(values[..., 0].max()):
        return []
    determinant = _determinant(two, found["jacobian"])
    traced = [] if determinant is None else _contours(two, x, y, determinant, grid)
    traced += _of_families(two, families, x, y, traced)
    zero = [two.computed(line)["singular_values"][..., -1] < SINGULAR * largest for line in traced]
    return [line[run] for line, wanted in zip(traced, zero, strict=True) for run in runs(wanted)]


def _lines(two: TwoJoints, index: int) -> Array:
    """Return lines of the grid for one coordinate: a whole turn if it repeats, and lines a hair beyond its limits."""
    lower, upper = float(two.ends[0][index]), float(two.ends[1][index])
    start, end, step = lower - _EDGE, upper + _EDGE, (upper - lower) / (_POINTS - 1)
    if two.joints.periodic[index]:
        step = 2 * math.pi / (_POINTS - 1)
        start = (lower + upper) / 2 - math.pi - _OFF * step
        end = start + 2 * math.pi
    inner = np.arange(start, end, step) if two.joints.periodic[index] else lower + step * (np.arange(_POINTS) - _OFF)
    lines = np.r_[start, inner, end] if two.whole(index) else np.r_[start, inner, end, lower - _EDGE, upper + _EDGE]
    lines = np.unique(lines[(lines >= start) & (lines <= end)])
    return lines[np.r_[True, np.diff(lines) > 1e-3 * _EDGE]]


# --- the determinant


def _determinant(two: TwoJoints, jacobians: Array) -> Determinant | None:
    """Return det(U^T M) with M the rows that count and U a basis of what they span; None where it is not square.

    A row along which nothing moves, such as that across the plane of a planar arm, does not count so.
    """
    joints, kernel = len(two.joints.names), two.kernel
    if kernel.rank != joints:
        return None
    rows = kernel.weighed(jacobians.reshape(-1, 6, joints))
    values, vectors = np.linalg.eigh(np.einsum("krc,ksc->rs", rows, rows))
    spanned = values > MODEL**2 * values[-1]
    if np.count_nonzero(spanned) != joints:
        return None
    basis = vectors[:, spanned]

    def determinant(places: Array) -> Array:
        matrix = basis.T @ kernel.weighed(two.computed(places)["jacobian"])
        return np.asarray(np.linalg.det(matrix))

    return determinant


def _contours(two: TwoJoints, x: Array, y: Array, determinant: Determinant, grid: Array) -> list[Array]:
    """Return the lines (k, 2) over both coordinates where the determinant is zero.

    Factors that one of the two joints makes alone are found first, and divided out: contours of a product swap branches
    where they cross.
    """
    values = determinant(grid)
    lines = _zeros(x, y, values, determinant)
    factors = _own_factors(lines, x, y, determinant, 1e-9 * float(np.abs(values).max()))
    if not factors:
        return lines

    def divided(places: Array) -> Array:
        left = determinant(places)
        for axis, value in factors:
            gap = places[..., axis] - value
            left = left / (np.sin(gap / 2) if two.joints.periodic[two.pair[axis]] else gap)
        return left

    straight = [_straight(axis, value, x, y) for axis, value in factors]
    return [*straight, *_zeros(x, y, divided(grid), divided)]


def _own_factors(
    lines: Sequence[Array], x: Array, y: Array, determinant: Determinant, zero: float
) -> list[tuple[int, float]]:
    """Return the positions of one joint, (axis, value), at which the determinant is zero wherever the other is."""
    found = list[tuple[int, float]]()
    for axis, others in enumerate((len(y), len(x))):
        values = np.sort(np.concatenate([line[:, axis] for line in lines])) if lines else np.zeros(0)
        for part in np.split(values, np.flatnonzero(np.diff(values) > _SAME) + 1):
            if len(part) > others / 2:
                value = float(np.median(part))
                if np.abs(determinant(_straight(axis, value, x, y))).max() < zero:
                    found.append((axis, value))
    return found


def _straight(axis: int, value: float, x: Array, y: Array) -> Array:
    """Return the line (k, 2) over both coordinates on which one of them has a value."""
    along = (y, x)[axis]
    places = np.full((len(along), 2), value)
    places[:, 1 - axis] = along
    return places


def _zeros(x: Array, y: Array, values: Array, function: Determinant) -> list[Array]:
    """Return the lines (k, 2) where a function, of which values on the grid are given, is zero."""
    from contourpy import LineType, contour_generator

    traced: Any = contour_generator(x, y, values, name="serial", line_type=LineType.Separate).lines(0.0)
    lines: list[Array] = [line for line in traced if len(line) > 1]
    if not lines:
        return []
    moved = _on_zero(np.concatenate(lines), x, y, values, function)
    return np.split(moved, np.cumsum([len(line) for line in lines])[:-1])


def _on_zero(vertices: Array, x: Array, y: Array, values: Array, determinant: Determinant) -> Array:
    """Return vertices (k, 2) of contour lines moved along their lines of the grid to where the determinant is zero."""
    column, row = (_place(lines, vertices[:, axis]) for axis, lines in enumerate((x, y)))
    along_y = np.abs(column - np.round(column)) <= np.abs(row - np.round(row))  # the vertex is on a line x = const
    first = np.array([np.floor(column), np.floor(row)], dtype=int)
    first = np.where([along_y, ~along_y], np.round([column, row]).astype(int), first)
    step = np.array([~along_y, along_y]).astype(int)
    first = np.minimum(first, np.array([[len(x) - 1], [len(y) - 1]]) - step)
    second = first + step
    ends = [np.stack([x[ij[0]], y[ij[1]]], axis=-1) for ij in (first, second)]
    return _false_position(determinant, ends[0], ends[1], values[first[1], first[0]], values[second[1], second[0]])


def _place(lines: Array, values: Array) -> Array:
    """Return where values are among lines, in steps from the first."""
    return np.interp(values, lines, np.arange(len(lines)))


def _false_position(function: Determinant, a: Array, b: Array, at_a: Array, at_b: Array) -> Array:
    """Return zeros of a function between places a and b (k, 2), by the Illinois variant of false position.

    (M. Dowell and P. Jarratt, "A modified regula falsi method", 1971). Where its signs are equal, the nearer end.
    """
    least = 1e-14 * np.max(np.abs([at_a, at_b]), initial=0.0)
    done = at_a * at_b >= 0
    best = np.where((np.abs(at_a) <= np.abs(at_b))[:, None], a, b)
    for _ in range(_STEPS):
        todo = np.flatnonzero(~done)
        if not len(todo):
            break
        share = (at_a[todo] / (at_a[todo] - at_b[todo]))[:, None]
        middle = a[todo] + share * (b[todo] - a[todo])
        value = function(middle)
        best[todo] = middle
        crossed = value * at_b[todo] < 0  # the zero is between the middle and b, which becomes a
        a[todo] = np.where(crossed[:, None], b[todo], a[todo])
        at_a[todo] = np.where(crossed, at_b[todo], at_a[todo] / 2)
        b[todo], at_b[todo] = middle, value
        done[todo] = (np.abs(value) <= least) | (np.max(np.abs(b[todo] - a[todo]), axis=1) < 1e-15)
    return best


# --- families


def _of_families(
    two: TwoJoints, families: SingularFamilies | None, x: Array, y: Array, traced: Sequence[Array]
) -> list[Array]:
    """Return lines (k, 2) on which one of the two joints is where a family wants it, unless they are traced already."""
    found: list[Array] = []
    wanted = [] if families is None else [_fixed(two, family.positions) for family in families.families]
    for axis, position in (one for one in wanted if one is not None):
        across, along = (x, y)[axis], (x, y)[1 - axis]
        turns = 2 * math.pi * np.arange(-2, 3) if two.joints.periodic[two.pair[axis]] else np.zeros(1)
        for value in position + turns:
            near = sum(np.count_nonzero(np.abs(line[:, axis] - value) < _SAME) for line in (*traced, *found))
            if across[0] <= value <= across[-1] and near < len(along) / 2:
                found.append(_straight(axis, value, x, y))
    return found


def _fixed(two: TwoJoints, positions: Mapping[str, float]) -> tuple[int, float] | None:
    """Return which of the two joints a condition fixes, and where; None if not one, or another joint is elsewhere.

    That the positions do make the arm singular is seen where the line is computed.
    """
    names, fixed = two.joints.names, list[tuple[int, float]]()
    for name, value in positions.items():
        index = names.index(name) if name in names else -1
        if index in two.pair:
            fixed.append((two.pair.index(index), value))
        elif index < 0 or abs(_turned(two, index, two.held[index] - value)) > _SAME:
            return None
    return fixed[0] if len(fixed) == 1 else None


def _turned(two: TwoJoints, index: int, gap: float) -> float:
    """Return a difference of positions by the shorter way round."""
    return math.remainder(gap, 2 * math.pi) if two.joints.periodic[index] else gap


# --- parts of lines


def _label(two: TwoJoints, line: Array) -> str:
    """Return what holds on a whole line over both coordinates: joint2 = pi/2; else that it is singular."""
    for axis, index in enumerate(two.pair):
        value = float(line[0, axis])
        if np.ptp(line[:, axis]) < _SAME:
            value = _turned(two, index, value)
            quarter = round(value / (math.pi / 2)) * math.pi / 2
            if two.joints.turning[index] and abs(value - quarter) < _SAME:
                value = math.pi if quarter == -math.pi and two.joints.periodic[index] else quarter
            return positions_in_words(two.joints, {two.names[axis]: value})
    return "singular"


def runs(wanted: Flags) -> list[slice]:
    """Return the stretches of a line, of two vertices or more, that are wanted."""
    changes = np.flatnonzero(np.diff(np.r_[False, wanted, False]))
    return [slice(start, end) for start, end in changes.reshape(-1, 2) if end - start > 1]


def _goes_round(points: Array) -> bool:
    """Return whether a curve in a plane (k, 2) is closed, and has an area inside."""
    x, y = (points - points[0]).T
    area = abs(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])) / 2
    return bool(np.linalg.norm(points[0] - points[-1]) < _SAME and area > _ROUND * np.ptp(points, axis=0).max() ** 2)


def _touching(wanted: Flags) -> Flags:
    """Return the vertices that are wanted, and their neighbours."""
    padded = np.r_[False, wanted, False]
    touching: Flags = padded[:-2] | padded[1:-1] | padded[2:]
    return touching
