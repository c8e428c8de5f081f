"""The one length that makes metres and radians comparable in many configurations of an arm, and how it is asked for."""

from __future__ import annotations

import math

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.sweeping.samples import halton_source
from kinetostat.analysis.task import Task, characteristic_length
from kinetostat.errors import UsageError, quote

__all__ = ["asked_length", "typical_length"]

_CONFIGURATIONS = 4096
_SHORTEST, _LONGEST = 1e-9, 1e9  # m
_NONE = 1e-9  # of the robot's reach


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
    if not _mixes(coordinates, task):
        return None
    matrices = coordinates.chain.jacobian(halton_source(coordinates, _CONFIGURATIONS).rows(0, _CONFIGURATIONS))
    columns = np.concatenate(list(np.moveaxis(matrices, -1, 0)), axis=0)  # (n m, 6)
    turning = np.repeat(coordinates.turning, len(matrices))
    length = float(characteristic_length(columns.T, list(turning), task))
    return length if length > _NONE * coordinates.model.robot.reach else None


def _mixes(coordinates: Coordinates, task: Task) -> bool:
    """Return whether rows mix metres and radians, or columns do in rows that slides move."""
    return task.mixed or (bool(task.linear) and len(set(coordinates.turning)) > 1)


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
        length = typical_length(coordinates, task)
        if length is not None:
            shown = " ".join(task.row_names) if task.mixed and task.name == "task" else "all rows"
            return length, f"auto: equal weight of linear and angular parts over configurations inside limits ({shown})"
        if not _mixes(coordinates, task):
            return None, "auto: none is needed, nothing mixes metres and radians"
        return None, "auto: there is none, no turn moves a linear row that counts"
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
