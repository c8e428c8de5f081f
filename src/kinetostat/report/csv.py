"""Views to CSV: the first table, numbers in full precision, units in the header. RFC 4180."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence

from kinetostat.report.view import Cell, Table

__all__ = ["lines", "render"]


def render(table: Table) -> str:
    """Return a table as CSV with a header row."""
    units = table.units or ("",) * len(table.header)
    header = [f"{name} [{unit}]" if unit else name for name, unit in zip(table.header, units, strict=True)]
    return lines([header, *table.rows])


def lines(rows: Iterable[Sequence[Cell]]) -> str:
    """Return rows as text: numbers in full precision, an empty cell for None.

    Text that a spreadsheet would take for a formula is led by an apostrophe: names come from untrusted files.
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    for row in rows:
        writer.writerow(["" if cell is None else _safe(cell) if isinstance(cell, str) else repr(cell) for cell in row])
    return out.getvalue()


def _safe(text: str) -> str:
    return f"'{text}" if text[:1] in ("=", "+", "@", "\t", "\r") or (text[:1] == "-" and not _is_number(text)) else text


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
