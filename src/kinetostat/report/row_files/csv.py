"""Rows to CSV: numbers in full precision, units in the header; what is not finite is an empty cell."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import msgspec
import numpy as np

from kinetostat.conventions import Array
from kinetostat.report import csv
from kinetostat.report.row_files.fields import Numbers, RowField, distinct_columns

__all__ = ["CsvRows", "number_rows"]

_AT_ONCE = 4096  # rows that are Python objects at one time


class CsvRows:
    """Writes rows as lines of text: the number of the row, then the columns of all fields."""

    def __init__(self, write: Callable[[str], bool], fields: Sequence[RowField]) -> None:
        """Write the header; `write` takes text and tells whether anybody still reads."""
        self._write = write
        units = [unit for field in fields for unit in field.units]
        named = zip(distinct_columns(fields), units, strict=True)
        write(csv.lines([["row", *(f"{name} [{unit}]" if unit else name for name, unit in named)]]))

    def write(self, numbers: Numbers, values: Sequence[Array]) -> bool:
        """Write m rows; return whether anybody still reads."""
        return all(
            self._write(_lines(numbers[start : start + _AT_ONCE], [part[start : start + _AT_ONCE] for part in values]))
            for start in range(0, len(numbers), _AT_ONCE)
        )


def _lines(numbers: Numbers, values: Sequence[Array]) -> str:
    """Return rows as text, each with its number."""
    count = len(numbers)
    cells: list[list[float | int]] = np.concatenate([part.reshape(count, -1) for part in values], axis=1).tolist()
    for number, row in zip(numbers.tolist(), cells, strict=True):
        row.insert(0, number)
    return "\n".join(number_rows(cells)) + "\n"


def number_rows(cells: list[list[float | int]]) -> list[str]:
    """Return each row of numbers as text. JSON's encoder writes the shortest digits that give the number again.

    What is not finite is empty.
    """
    text = msgspec.json.encode(cells)[2:-2]  # [[1,0.5],[2,null]]
    return text.replace(b"null", b"").decode().split("],[")
