"""Indices of singular values, and their units: what manipulability and sweeps share."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinetostat.analysis.task import Task
from kinetostat.conventions import Array

__all__ = ["NEAR", "ROUNDING", "STRICT", "inverse_condition_number", "isotropy", "powered", "singular_value_unit"]

ROUNDING = 1e-13  # m or rad: a matrix without a larger entry is zero
NEAR = 0.01  # smallest over largest singular value: below it a configuration counts as near-singular
STRICT = 1e-9  # of the largest singular value: below it a singular value is zero


def inverse_condition_number(values: Array) -> Array:
    """Return s_k / s_1 in [0, 1], 0 where s_1 is 0, of descending singular values. (..., k) -> (...)."""
    largest = values[..., 0]
    found: Array = np.divide(values[..., -1], largest, out=np.zeros(largest.shape), where=largest > ROUNDING)
    return np.minimum(found, 1.0)  # equal ones may be out of order in their last digit


def isotropy(values: Array) -> Array:
    """Return the geometric over the arithmetic mean of the s^2, 0 where one of them is zero. (..., k) -> (...)."""
    count = values.shape[-1]
    regular = values[..., -1] > np.maximum(STRICT * values[..., 0], ROUNDING)  # a root of noise
    volume, squares = np.prod(values, axis=-1), np.mean(values**2, axis=-1)
    found: Array = np.divide(volume ** (2 / count), squares, out=np.zeros(volume.shape), where=regular)
    return found


def singular_value_unit(task: Task, turning: Sequence[bool], *, scaled: bool, speeds: bool = False) -> str:
    """Return the unit of singular values: of rows over columns.

    Args:
        task: the rows.
        turning: which columns are of joints that turn.
        scaled: a characteristic length makes metres and radians comparable.
        speeds: columns are shares of the joints' speed limits.
    """
    rows = "mixed" if task.mixed else "m" if task.linear else "rad"
    if speeds:
        return "mixed" if task.mixed and not scaled else "1/s" if task.mixed else f"{rows}/s"
    columns = "rad" if all(turning) else "m" if not any(turning) else "rad" if scaled else "mixed"
    if task.mixed:
        return "1" if scaled else "mixed"
    if rows == "rad" and any(turning):  # slides turn nothing
        return "1"
    return "mixed" if columns == "mixed" else "1" if rows == columns else f"{rows}/{columns}"


def powered(unit: str, power: int) -> str:
    """Return the unit of a product of several: (m/rad)^2."""
    if unit in ("1", "mixed") or power == 1:
        return unit
    return f"({unit})^{power}" if "/" in unit else f"{unit}^{power}"
