"""Tables of numbers as a report shows them; a unit that all cells of a column share stands in the header."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from kinetostat.report.fleet.wording import number_text, unit_text

__all__ = ["Cell", "Column", "Grid", "count", "grid", "quantity", "share", "words"]


@dataclass(frozen=True)
class Column:
    """A column.

    Attributes:
        title: its header.
        kind: how its cells are aligned and sorted.
        unit: of all its cells; empty for words and pure numbers, and where cells have their own.
        about: what it is, in a sentence; empty where the title says it.
    """

    title: str
    kind: Literal["number", "words"] = "number"
    unit: str = ""
    about: str = ""


@dataclass(frozen=True)
class Cell:
    """A cell.

    Attributes:
        text: what it shows; empty: nothing is known.
        value: what it is sorted by; None: nothing is known, or the text.
        unit: of the number, while the column has none.
        bar: the length of its bar, 1 being full; None for no bar.
        sign: "bad" or "good" where the text is a verdict.
        link: the id of the part of the page that it leads to; empty for none.
        note: what stands below the text, smaller; empty for nothing.
    """

    text: str
    value: float | None = None
    unit: str = ""
    bar: float | None = None
    sign: Literal["", "good", "bad"] = ""
    link: str = ""
    note: str = ""


@dataclass(frozen=True)
class Grid:
    """A table: each row has a cell for each column."""

    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]


def grid(columns: Sequence[Column], rows: Iterable[Sequence[Cell]]) -> Grid:
    """Return a table. A unit that all known cells of a column share moves to its header."""
    cells, headers, down = [tuple(row) for row in rows], list[Column](), list[list[Cell]]()
    for i, column in enumerate(columns):
        units = {row[i].unit for row in cells if row[i].text}
        shared = units.pop() if len(units) == 1 else ""
        headers.append(replace(column, unit=shared))
        down.append([replace(row[i], unit="") if shared else row[i] for row in cells])
    return Grid(tuple(headers), tuple(zip(*down, strict=True)))


def quantity(value: float | None, unit: str = "", *, full: float | None = None) -> Cell:
    """Return a number with a unit; with a bar if it is told what a full one is."""
    text = number_text(value)
    bar = None if value is None or not text or not full else value / full
    return Cell(text, value if text else None, unit_text(unit) if text else "", bar)


def count(value: int | None) -> Cell:
    """Return how many there are."""
    return Cell("" if value is None else f"{value:,}", value)


def share(value: float | None, *, bar: bool = True) -> Cell:
    """Return a share in percent, with a bar."""
    cell = quantity(None if value is None else 100 * value, "%")
    return replace(cell, bar=value) if bar and cell.text else cell


def words(text: str, link: str = "", *, note: str = "") -> Cell:
    """Return a text."""
    return Cell(text, link=link, note=note)
