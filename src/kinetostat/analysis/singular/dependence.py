"""Sets of joints whose motions are dependent at a configuration, and what that means for their axes, in words."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from kinetostat.analysis.singular.lines import TOUCHING, Axis, in_one_plane, meeting_point, parallel
from kinetostat.analysis.singular.mechanism import Mechanism
from kinetostat.analysis.task import length_scaled
from kinetostat.conventions import Array
from kinetostat.errors import cut

__all__ = ["compared_columns", "dependence_words", "dependent_sets", "flats", "listed", "of_axes"]

_LARGEST = 4  # joints in a set that is looked for; larger ones are told by the line that meets them all
_MOST_JOINTS = 16  # of a chain whose sets are tried


def dependent_sets(mechanism: Mechanism, q: Array) -> list[tuple[int, ...]]:
    """Return the smallest sets of up to four joints whose screws (or velocities of the point) are dependent at q."""
    matrix = compared_columns(mechanism, q)
    norms = np.linalg.norm(matrix, axis=0)
    count = matrix.shape[1]
    found: list[tuple[int, ...]] = [(i,) for i in range(count) if norms[i] < TOUCHING]
    if count > _MOST_JOINTS:
        return found
    unit = matrix / np.where(norms < TOUCHING, 1.0, norms)
    largest = min(_LARGEST, mechanism.generic_rank)
    for size in range(2, largest + 1):
        sets = [chosen for chosen in combinations(range(count), size) if not any(set(s) <= set(chosen) for s in found)]
        if sets:
            stacked = np.stack([unit[:, list(chosen)] for chosen in sets])
            smallest = np.linalg.svd(stacked, compute_uv=False)[:, size - 1]
            found += [chosen for chosen, value in zip(sets, smallest, strict=True) if value < TOUCHING]
    return found


def compared_columns(mechanism: Mechanism, q: Array) -> Array:
    """Return the columns that dependence is looked for in, as pure numbers.

    Those of the task's rows where only translations or only turns count; else whole screws, which have a geometry.
    """
    if not mechanism.task.mixed:
        return mechanism.jacobian(q)
    return length_scaled(mechanism.chain.jacobian(q), mechanism.turning, mechanism.length)


def flats(matrix: Array, sets: Sequence[tuple[int, ...]]) -> list[tuple[int, ...]]:
    """Return each set with all other columns that depend on it, once."""
    found = list[tuple[int, ...]]()
    for chosen in sets:
        left, values, _ = np.linalg.svd(matrix[:, list(chosen)], full_matrices=False)
        span = left[:, values > TOUCHING * max(1.0, float(values[0]))]
        rest = matrix - span @ (span.T @ matrix)
        flat = tuple(int(i) for i in np.flatnonzero(np.linalg.norm(rest, axis=0) < 10 * TOUCHING))
        if flat not in found:
            found.append(flat)
    return found


def dependence_words(mechanism: Mechanism, axes: Sequence[Axis], columns: Array) -> str:
    """Return in words why these joints, columns (m, k), are dependent in what the task is about."""
    task, length = mechanism.task, mechanism.length
    if not task.angular:
        return _point_words(axes, length)
    return _screw_words(axes, columns, length) if task.linear else _turn_words(axes, columns)


def _screw_words(axes: Sequence[Axis], columns: Array, length: float) -> str:
    """Return in words why the screws of these joints, columns (6, k), are dependent."""
    names = listed([axis.joint for axis in axes])
    turns = [axis for axis in axes if axis.point is not None]
    slides = [axis for axis in axes if axis.point is None]
    rank = int(np.sum(np.linalg.svd(columns, compute_uv=False) > 10 * TOUCHING))
    aligned = bool(turns) and parallel(turns)
    if not slides:
        if rank == 1:
            return f"the axes of {names} coincide"
        meet = meeting_point(turns, length) is not None
        relation = "are parallel" if aligned else "meet in a point" if meet else ""
        if rank == 2 and relation:
            return f"the axes of {names} {relation} and lie in one plane"
        if relation or in_one_plane(turns, length):
            return f"the axes of {names} {relation or 'lie in one plane'}"
    elif not turns:
        return f"the slides {names} are parallel" + (" to one plane" if rank > 1 else "")
    elif len(turns) == 2 and len(slides) == 1 and aligned:
        pair = listed([axis.joint for axis in turns])
        return f"slide {listed([slides[0].joint])} is perpendicular to the plane of the parallel axes of {pair}"
    elif len(turns) > 1 and aligned:
        return (
            f"the axes of {listed([axis.joint for axis in turns])} are parallel, and {_slides(slides)} to their motion"
        )
    return f"the motions of {names} are dependent"


def _slides(slides: Sequence[Axis]) -> str:
    names = listed([axis.joint for axis in slides])
    return f"slide {names} adds nothing" if len(slides) == 1 else f"slides {names} add nothing"


def _point_words(axes: Sequence[Axis], length: float) -> str:
    """Return in words why these joints' velocities of the tool point are dependent."""
    names = listed([axis.joint for axis in axes])
    if len(axes) == 1:
        return f"the tool point lies on the axis of {names}"
    if any(axis.point is None for axis in axes):
        return f"{names} move the tool point along {'one line' if len(axes) == 2 else 'one plane'}"
    planes = "lies in the plane of" if in_one_plane(axes, length) else "lies in one plane with each of"
    return f"the tool point {planes} the axes of {names}"


def _turn_words(axes: Sequence[Axis], columns: Array) -> str:
    """Return in words why the turns of these joints, columns (m, k), are dependent."""
    names = listed([axis.joint for axis in axes])
    rank = int(np.sum(np.linalg.svd(columns, compute_uv=False) > 10 * TOUCHING))
    return f"the axes of {names} are parallel{' to one plane' if rank > 1 else ''}"


def of_axes(axes: Sequence[Axis]) -> str:
    """Return: axis of a; axes of a and b."""
    names = [axis.joint for axis in axes]
    return f"{_plural('axis', names)} of {listed(names)}"


def _plural(word: str, names: Sequence[str]) -> str:
    return word if len(names) == 1 else word.replace("axis", "axes")


def listed(names: Sequence[str]) -> str:
    """Return names in a sentence: a, b and c."""
    shown = [cut(name) for name in names]
    return shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} and {shown[-1]}"
