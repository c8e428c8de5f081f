"""Lists that people give in files: rows of CSV, of JSON, of JSON lines, as batches of sound numbers or of reasons."""

from __future__ import annotations

import csv
import itertools
import json
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from kinetostat_cli.options import ConfigurationOptions

if TYPE_CHECKING:
    from kinetostat import Model
    from kinetostat.conventions import Array

__all__ = [
    "Batch",
    "RowKind",
    "batches",
    "configuration_rows",
    "is_header",
    "list_file",
    "list_text",
    "pose_rows",
    "split_unit",
]

BATCH = 2000  # rows that are read, computed and written at once

Row = Sequence[Any] | Mapping[str, Any]


@dataclass(frozen=True)
class RowKind:
    """What the rows of a list are, and how numbers become it.

    Attributes:
        columns: names of the columns that count, if a list holds more; None: all of them.
        blank: one sound value, (1, ...): an empty list still has columns.
        many: from rows of numbers (m, k) and the names of their columns, or None, to values (m, ...).
        named: from a mapping of names to numbers to one value (1, ...).
    """

    columns: tuple[str, ...] | None
    blank: Array
    many: Callable[[Array, Sequence[str] | None], Array]
    named: Callable[[Mapping[str, Any]], Array]


@dataclass(frozen=True)
class Batch:
    """Rows of a list: their numbers, the values of those that are sound, and why the others are not."""

    numbers: range
    values: Array
    reasons: list[str | None]


def configuration_rows(model: Model, at: ConfigurationOptions) -> RowKind:
    """Return how rows become configurations: in file order, or under the names of joints, others zero."""
    import kinetostat
    from kinetostat.analysis.configuration import from_rows

    first = at.quat.value[0]

    def many(values: Array, names: Sequence[str] | None) -> Array:
        return from_rows(model, values, names, degrees=at.deg, quaternion_first=first)

    def named(row: Mapping[str, Any]) -> Array:
        return kinetostat.configuration(model, row, degrees=at.deg, quaternion_first=first).q[None]

    # Not zero, where an answer may be special.
    return RowKind(model.robot.position_names, kinetostat.random_configurations(model, 0, 1), many, named)


def pose_rows(at: ConfigurationOptions, *, oriented: bool) -> RowKind:
    """Return how rows become poses (m, 4, 4): of 6, 7, 12 or 16 numbers, as --pose takes them; or of positions too."""
    import numpy as np

    import kinetostat

    def many(values: Array, names: Sequence[str] | None) -> Array:  # noqa: ARG001 (a header is for people)
        poses = [kinetostat.pose(row, degrees=at.deg, quaternion_first=at.quat.value[0]) for row in values]
        if oriented and not all(pose.oriented for pose in poses):
            raise kinetostat.UsageError("a pose without an orientation", remedy="--axes xyz takes positions")
        return np.array([pose.matrix for pose in poses]).reshape(-1, 4, 4)

    def named(row: Mapping[str, Any]) -> Array:
        raise kinetostat.UsageError(f"a pose is a row of numbers, not {len(row)} names")

    return RowKind(None, np.eye(4)[None], many, named)


def batches(file: Path, kind: RowKind) -> Iterator[Batch]:
    """Yield the rows of a file in batches.

    Raises:
        UsageError: the file cannot be read, or is no list; a name in the header is none of the kind's.
    """
    import numpy as np

    rows, number, names = _rows(file), 0, None
    for first in rows:
        if is_header(first):
            names = [split_unit(str(cell))[0] for cell in first]
            if kind.columns is not None and (names[0], names[-1]) == ("row", "reason"):
                names, rows = _own_columns(names, rows, kind.columns)
            kind.many(np.zeros((0, len(names))), names)  # a wrong name is said once, not in every row
        else:
            rows = itertools.chain([first], rows)
        break
    while batch := list(itertools.islice(rows, BATCH)):
        numbers = range(number + 1, number + len(batch) + 1)
        number += len(batch)
        yield _batch(kind, numbers, batch, names)


def is_header(row: Row) -> bool:
    """Return whether a first row names columns: words, none of which is a number."""
    words = [] if isinstance(row, Mapping) else [cell.strip() for cell in row if isinstance(cell, str)]
    return len(words) == len(row) and any(words) and all(_floats([[word]]) is None for word in words)


def split_unit(name: str) -> tuple[str, str]:
    """Return the name of a column and the unit that its header may tell: `elbow [rad]`."""
    found = re.fullmatch(r"(.*) \[([^\]]*)\]", name.strip(), re.DOTALL)
    return (found[1], found[2]) if found else (name.strip(), "")


def _own_columns(names: list[str], rows: Iterator[Row], wanted: Sequence[str]) -> tuple[list[str], Iterator[Row]]:
    """Return the columns that count of a list that this tool has written: `ik --poses` answers `torque --qs`."""
    places = [i for i, name in enumerate(names) if name in wanted]
    return [names[i] for i in places], (_picked(row, places) for row in rows)


def _picked(row: Row, places: Sequence[int]) -> Row:
    return row if isinstance(row, Mapping) else [row[i] for i in places if i < len(row)]


def _batch(kind: RowKind, numbers: range, rows: list[Row], names: list[str] | None) -> Batch:
    """Return rows as values: all at once where all are sound, else one by one."""
    import numpy as np

    import kinetostat

    values = None if isinstance(rows[0], Mapping) else _floats(rows)
    if values is not None:
        try:
            return Batch(numbers, kind.many(values, names), [None] * len(rows))
        except kinetostat.UsageError:
            pass  # one by one, to say which
    found, reasons = [kind.blank[:0]], list[str | None]()
    for row in rows:
        try:
            found.append(kind.named(row) if isinstance(row, Mapping) else kind.many(_numbers(row), names))
            reasons.append(None)
        except kinetostat.UsageError as error:
            reasons.append(str(error))
    return Batch(numbers, np.concatenate(found), reasons)


def _numbers(row: Sequence[Any]) -> Array:
    """Return a row of numbers, (1, k).

    Raises:
        ConfigurationError: a cell is none; it is told.
    """
    from kinetostat.errors import ConfigurationError, quote

    numbers = _floats([row])
    if not any(str(cell).strip() for cell in row):
        raise ConfigurationError("an empty row")
    if numbers is None:
        wrong = next((str(cell) for cell in row if _floats([[cell]]) is None), "")
        raise ConfigurationError(f"{quote(wrong)} is not a number")
    return numbers


def _floats(rows: Sequence[Row]) -> Array | None:
    """Return rows of numbers as an array; None if one is no number, or one row is shorter than another."""
    import numpy as np

    try:
        return np.array([[_float(cell) for cell in row] for row in rows])
    except (TypeError, ValueError, OverflowError):
        return None


def _float(cell: Any) -> float:
    if isinstance(cell, bool):  # JSON's true is no number
        raise TypeError
    return float(cell)


def _rows(file: Path) -> Iterator[Row]:
    """Yield the rows of a file: cells of CSV, or what a JSON list, or a line of JSON, holds.

    Raises:
        ConfigurationError: the file cannot be read, or is no list.
    """
    kind = file.suffix.lower()
    if kind == ".json":
        yield from _json_rows(file)
        return
    with list_text(file) as text:
        by_line = kind == ".jsonl" and file != Path("-")
        yield from (_json_line(line) for line in text if line.strip()) if by_line else _csv_rows(text)


@contextmanager
def list_text(file: Path) -> Iterator[TextIO]:
    """Open a list's text, `-` being standard input; what is wrong with it while it is read is told, too.

    Raises:
        ConfigurationError: the file cannot be read, or holds no text, no CSV.
    """
    from kinetostat.errors import ConfigurationError

    try:
        if file == Path("-"):
            yield sys.stdin
            return
        with list_file(file).open(encoding="utf-8-sig", newline="") as text:
            yield text
    except csv.Error as error:
        raise ConfigurationError(f"not CSV: {error}", file=str(file), remedy="is a quotation mark open?") from None
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not UTF-8 text"
        raise ConfigurationError(f"the list cannot be read: {reason}", file=str(file)) from None


def list_file(file: Path) -> Path:
    """Return the path of a list that can be read without waiting for ever.

    Raises:
        ConfigurationError: there is no such file, or it is not a regular one.
    """
    from kinetostat.errors import ConfigurationError

    if not file.exists():
        raise ConfigurationError("there is no such file", file=str(file), remedy="check the path")
    if not file.is_file() and file.parent != Path("/dev/fd"):  # what <(command) names; others may block for ever
        raise ConfigurationError("this is not a regular file", file=str(file), remedy="pipe it to '-'")
    return file


def _csv_rows(text: Any) -> Iterator[Row]:
    for i, row in enumerate(csv.reader(text, strict=True)):
        if i == 0 and row:
            row[0] = row[0].removeprefix("\ufeff")  # a byte order mark, which standard input keeps
        if row:  # a blank line separates; a row of empty cells is one without an answer
            yield row


def _json_rows(file: Path) -> Iterator[Row]:
    from kinetostat.errors import ConfigurationError
    from kinetostat_cli.values import read_text

    try:
        content = json.loads(read_text(str(file)))
    except (ValueError, RecursionError) as error:
        raise ConfigurationError(f"not JSON: {error}", file=str(file)) from None
    if not isinstance(content, list):
        raise ConfigurationError("no list in it", file=str(file), remedy='write [[0.1, ...], {"joint": 0.1}, ...]')
    yield from (row if isinstance(row, (list, dict)) else [row] for row in content)


def _json_line(line: str) -> Row:
    try:
        row = json.loads(line)
    except (ValueError, RecursionError):
        return [line.strip()[:40]]
    return row if isinstance(row, (list, dict)) else [row]
