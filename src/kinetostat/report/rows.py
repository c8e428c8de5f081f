"""Lists of results as streams: one row out per row in, to CSV or to JSON, without holding them all."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kinetostat.conventions import Array
from kinetostat.report import csv
from kinetostat.report.json import render
from kinetostat.report.view import Cell

__all__ = ["Column", "csv_head", "csv_rows", "json_foot", "json_head", "json_rows", "use_columns"]


@dataclass(frozen=True)
class Column:
    """A column of a list: its name, its unit (or nothing), and one cell for each row that has an answer."""

    name: str
    unit: str
    cells: Sequence[Cell]


def use_columns(names: Sequence[str], shares: Array, binding: Array) -> list[Column]:
    """Return the columns of the largest share of a limit that is used, (m, n), and of the joint that uses it, (m,)."""
    use = np.take_along_axis(shares, np.maximum(binding, 0)[:, None], -1)[:, 0]
    joints = [names[i] if i >= 0 else None for i in binding]
    return [Column("utilisation", "", use.tolist()), Column("binding_joint", "", joints)]


def csv_head(columns: Sequence[Column]) -> str:
    """Return the header: the row's number in the list, the columns with their units, and why there is no answer."""
    return csv.lines([["row", *(f"{c.name} [{c.unit}]" if c.unit else c.name for c in columns), "reason"]])


def csv_rows(numbers: Sequence[int], columns: Sequence[Column], reasons: Sequence[str | None]) -> str:
    """Return rows, numbers in full precision; what has no number is empty."""
    rows = zip(numbers, _cells(columns, reasons), reasons, strict=True)
    return csv.lines([str(number), *cells, reason or ""] for number, cells, reason in rows)


def json_head(payload: dict[str, Any], columns: Sequence[Column]) -> str:
    """Return the beginning of the object: the payload, and the columns, up to the list of rows."""
    result = {"columns": [column.name for column in columns], "units": [column.unit for column in columns]}
    whole = render({**payload, "result": result})
    return whole.rstrip("} \n") + ',\n    "rows": ['


def json_rows(numbers: Sequence[int], columns: Sequence[Column], reasons: Sequence[str | None], *, first: bool) -> str:
    """Return rows as objects: the row's number, its values, and the reason where there is none."""
    texts = []
    for number, cells, reason in zip(numbers, _cells(columns, reasons), reasons, strict=True):
        row: dict[str, Any] = {"row": number, "values": cells} | ({"reason": reason} if reason else {})
        texts.append(f"\n      {json.dumps(row, ensure_ascii=False, allow_nan=False)}")
    return ("" if first or not texts else ",") + ",".join(texts)


def json_foot(payload: dict[str, Any]) -> str:
    """Return the end of the object: after the rows, the payload."""
    return "\n    ]\n  },\n" + render(payload).removeprefix("{\n")


def _cells(columns: Sequence[Column], reasons: Sequence[str | None]) -> list[list[Cell]]:
    """Return the cells of each row; None in a row that has no answer, and for what is not finite."""
    answered = zip(*(column.cells for column in columns), strict=True) if columns else iter(() for _ in reasons)
    return [[None] * len(columns) if reason else [_finite(cell) for cell in next(answered)] for reason in reasons]


def _finite(cell: Cell) -> Cell:
    return None if isinstance(cell, float) and not math.isfinite(cell) else cell
