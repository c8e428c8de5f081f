"""Views to CSV: the first table, numbers in full precision, units in the header. RFC 4180."""

from __future__ import annotations

import csv
import io

from kinetostat.report.view import Table

__all__ = ["render"]


def render(table: Table) -> str:
    """Return a table as CSV with a header row.

    Text that a spreadsheet would take for a formula is led by an apostrophe: names come from untrusted files.
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    units = table.units or ("",) * len(table.header)
    writer.writerow(
        [_safe(f"{name} [{unit}]" if unit else name) for name, unit in zip(table.header, units, strict=True)]
    )
    for row in table.rows:
        writer.writerow(
            ["" if cell is None else repr(cell) if isinstance(cell, float) else _safe(cell) for cell in row]
        )
    return out.getvalue()


def _safe(text: str) -> str:
    return f"'{text}" if text[:1] in ("=", "+", "@", "\t", "\r") or (text[:1] == "-" and not _is_number(text)) else text


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
