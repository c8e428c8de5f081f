"""What a file of rows holds: fields of one number or of several, and what writes them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from kinetostat.conventions import Array

__all__ = ["Numbers", "RowField", "RowWriter", "described", "distinct_columns"]

Numbers = npt.NDArray[np.int64]


@dataclass(frozen=True)
class RowField:
    """An array of which each row holds a part: of one number, or of several in columns.

    Attributes:
        name: of the array.
        columns: a name for each number of a row, in C order.
        units: their units, empty where there is none.
        shape: of a row's part; () is one number.
    """

    name: str
    columns: tuple[str, ...]
    units: tuple[str, ...]
    shape: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        """Hold the columns against the shape."""
        if not math.prod(self.shape) == len(self.columns) == len(self.units):
            message = f"{self.name}: {len(self.columns)} columns, {len(self.units)} units, shape {self.shape}"
            raise ValueError(message)


class RowWriter(Protocol):
    """Writes rows in blocks, in their order."""

    def write(self, numbers: Numbers, values: Sequence[Array]) -> bool:
        """Write m rows; return whether anybody still reads.

        Args:
            numbers: of the rows, (m,).
            values: one array (m, *shape) for each field.
        """
        ...


def distinct_columns(fields: Iterable[RowField]) -> list[str]:
    """Return the names of all columns; one that stands there already (joints may be called anything) is numbered."""
    found = ["row"]
    for field in fields:
        for column in field.columns:
            name, count = column, 1
            while name in found:
                count += 1
                name = f"{column}_{count}"
            found.append(name)
    return found[1:]


def described(fields: Sequence[RowField]) -> list[dict[str, object]]:
    """Return the names, columns and units of fields for JSON."""
    return [{"name": field.name, "columns": list(field.columns), "units": list(field.units)} for field in fields]
