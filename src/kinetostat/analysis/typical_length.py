"""The one length that makes metres and radians comparable in many configurations of an arm, and how it is asked for."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.indices import singular_value_unit
from kinetostat.analysis.sweeping.samples import halton_source
from kinetostat.analysis.task import Task, characteristic_length
from kinetostat.conventions import Array
from kinetostat.errors import UsageError, quote

__all__ = ["PURE", "asked_length", "length_factors", "typical_length", "unit_with_length"]

_CONFIGURATIONS = 4096
_SHORTEST, _LONGEST = 1e-9, 1e9  # m
_NONE = 1e-9  # of the robot's reach
PURE = "auto: none is needed, no turn moves a linear row that counts"


def typical_length(coordinates: Coordinates, task: Task) -> float | None:
    """Return the characteristic length of an arm in m, one for all its configurations.

    L^2 = (mean square of the linear rows) / (mean square of the angular rows), columns of joints that turn, as
    `task.characteristic_length`, with sums over 4,096 low-discrepancy configurations inside limits: the same, whichever
    configurations are asked about.

    Args:
        coordinates: the joints between the observer and the tool point.
        task: the rows that count; all six count for L where they do not mix metres and radians.

    Returns:
        L; None where neither the rows nor the columns mix metres and radians, or where there is no such length: no
        joint turns, every axis passes through the point, no turn moves a linear row that counts.
    """
    if not task.mixes(coordinates.turning):
        return None
    return _length(coordinates, task, *_columns(coordinates))


def _length(coordinates: Coordinates, task: Task, columns: Array, turning: list[bool]) -> float | None:
    """Return the length of columns (m, 6), some of joints that turn; None where there is none."""
    length = float(characteristic_length(columns.T, turning, task))
    return length if length > _NONE * coordinates.model.robot.reach else None


def _columns(coordinates: Coordinates) -> tuple[Array, list[bool]]:
    """Return the columns of Jacobians inside limits, (m, 6), and which are of joints that turn."""
    matrices = coordinates.chain.jacobian(halton_source(coordinates, _CONFIGURATIONS).rows(0, _CONFIGURATIONS))
    columns = np.concatenate(list(np.moveaxis(matrices, -1, 0)), axis=0)
    return columns, list(np.repeat(coordinates.turning, len(matrices)))


def unit_with_length(task: Task, turning: Sequence[bool], length: float | None, length_reference: str) -> str:
    """Return the unit of singular values with the length that `asked_length` found, or with none.

    Where no turn moves a linear row that counts, slides move these, m/m, and turns the angular ones, rad/rad: numbers
    are pure without a length.
    """
    return "1" if length_reference == PURE else singular_value_unit(task, turning, scaled=length is not None)


def length_factors(coordinates: Coordinates, task: Task, length: float | None) -> tuple[Array | None, Array | None]:
    """Return what rows (6,) and columns (n,) of a Jacobian are multiplied by so that its entries are comparable.

    As in `manipulability`: linear rows are divided by L where the task mixes metres and radians; a slide counts as an
    angle q / L where the rows or the columns mix them. None for factors of one, and where there is no length.
    """
    if length is None or not task.mixes(coordinates.turning):
        return None, None
    rows = np.array([1 / length] * 3 + [1.0] * 3) if task.mixed else None
    return rows, np.where(coordinates.turning, 1.0, length)


def asked_length(coordinates: Coordinates, task: Task, wanted: float | str) -> tuple[float | None, str]:
    """Return the length that is asked for, None for none, and in words how it was found.

    Args:
        coordinates: the joints between the observer and the tool point.
        task: the rows that count.
        wanted: "auto" (`typical_length`), "none", or a length in m.

    Raises:
        UsageError: none of them.
    """
    if wanted == "none":
        return None, "none: metres and radians as they are"
    if wanted == "auto":
        if not task.mixes(coordinates.turning):
            return None, "auto: none is needed, nothing mixes metres and radians"
        columns, turning = _columns(coordinates)
        length = _length(coordinates, task, columns, turning)
        if length is not None:
            shown = " ".join(task.row_names) if task.mixed and task.name == "task" else "all rows"
            return length, f"auto: equal weight of linear and angular parts over configurations inside limits ({shown})"
        if np.all(np.abs(columns[turning][:, task.linear]) <= _NONE * coordinates.model.robot.reach):
            return None, PURE
        return None, "auto: there is none, no turn moves an angular row that counts"
    try:
        given = float(wanted)
    except (TypeError, ValueError):
        given = math.nan
    if not _SHORTEST <= given <= _LONGEST:
        raise UsageError(
            f"the length is auto, none, or between {_SHORTEST:g} and {_LONGEST:g} m, not {quote(str(wanted))}",
            remedy="for instance --length 0.5",
        )
    return given, "given"
