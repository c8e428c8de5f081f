"""`--qs FILE`: a list of configurations in, one row out for each, in batches; a reason where there is no answer."""

from __future__ import annotations

import csv
import itertools
import json
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kinetostat_cli.console import exit_if_apart, opened, progress_bar, say
from kinetostat_cli.options import ConfigurationOptions, Format, OutputOptions

if TYPE_CHECKING:
    from kinetostat import Certificate, Model
    from kinetostat.conventions import Array
    from kinetostat.report.rows import Column

__all__ = ["Answers", "ListOption", "answer_list"]

BATCH = 2000  # rows that are read, computed and written at once

ListOption = Annotated[
    Path | None,
    typer.Option(
        "--qs",
        metavar="FILE",
        help="Answer for each configuration of a .csv, .json or .jsonl file (-: CSV on standard input): a row out for "
        "each row in, as CSV, or with -F json.",
    ),
]

Row = Sequence[Any] | Mapping[str, Any]


@dataclass(frozen=True)
class Answers:
    """What a batch of m configurations gives: columns of m cells, the certificate, and a reason where one failed."""

    columns: Sequence[Column]
    certificate: Certificate
    reasons: Sequence[str | None] | None = None


@dataclass(frozen=True)
class _Batch:
    """Rows of a list: their numbers, the configurations of those that are sound, and why the others are not."""

    numbers: Sequence[int]
    q: Array
    reasons: list[str | None]


def answer_list(
    command: str,
    model: Model,
    file: Path,
    at: ConfigurationOptions,
    output: OutputOptions,
    evaluate: Callable[[Array], Answers],
) -> None:
    """Read configurations, evaluate them in batches (m, nq), and write a row for each as it comes."""
    import kinetostat
    from kinetostat.analysis.crosscheck import combined
    from kinetostat.report import rows as form
    from kinetostat.report.json import closing, opening
    from kinetostat.report.view import certificate_note

    if at.config != "zero":
        raise kinetostat.UsageError("--qs lists the configurations", remedy="leave out --config")
    # One configuration first: it tells the columns, and what is wrong with the question is said before anything else.
    blank = evaluate(kinetostat.random_configurations(model, 0, 1))
    proofs, count, failed, as_json = [blank.certificate], 0, 0, output.format is Format.JSON
    with opened(output) as write, progress_bar() as tell:
        head = (
            form.json_head(opening(f"{command}.rows", model), blank.columns)
            if as_json
            else form.csv_head(blank.columns)
        )
        write(head)
        for batch in _batches(model, file, at):
            columns, reasons = blank.columns, batch.reasons
            if len(batch.q):
                found = evaluate(batch.q)
                columns, proofs = found.columns, [combined([*proofs, found.certificate])]
                reasons = _merged(reasons, found)
            columns = _answered(columns, batch.reasons, reasons)
            write(
                form.json_rows(batch.numbers, columns, reasons, first=count == 0)
                if as_json
                else form.csv_rows(batch.numbers, columns, reasons)
            )
            count, failed = count + len(batch.numbers), failed + sum(reason is not None for reason in reasons)
            if tell is not None:
                tell(f"{count} rows", 0.0)
        if as_json:
            write(form.json_foot(closing(proofs[0], ())))
    lost = f", {failed} of them without an answer" if failed else ""
    say("warning" if failed else "note", f"{count} rows{lost}; {certificate_note(proofs[0])}")
    exit_if_apart(proofs[0], model)


def _merged(reasons: list[str | None], found: Answers) -> list[str | None]:
    """Return the reasons of all rows: those found in reading, and those of the rows that were evaluated."""
    later = iter(found.reasons or itertools.repeat(None))
    return [reason or next(later) for reason in reasons]


def _answered(columns: Sequence[Column], read: Sequence[str | None], reasons: Sequence[str | None]) -> Sequence[Column]:
    """Return the columns with the cells of those rows alone that have an answer."""
    from kinetostat.report.rows import Column

    kept = [reason is None for before, reason in zip(read, reasons, strict=True) if before is None]
    return [Column(c.name, c.unit, [x for x, keep in zip(c.cells, kept, strict=False) if keep]) for c in columns]


# --- reading -----------------------------------------------------------------------------------------------------


def _batches(model: Model, file: Path, at: ConfigurationOptions) -> Iterator[_Batch]:
    """Yield the rows of a file in batches, as configurations.

    Raises:
        ConfigurationError: the file cannot be read, or is no list; a name in the header is no joint's.
    """
    import numpy as np

    rows, number, names = _rows(file), 0, None
    for first in rows:
        if not isinstance(first, Mapping) and _floats([first]) is None:
            names = [str(cell).strip() for cell in first]
            _configurations(model, at, np.zeros((0, len(names))), names)  # a wrong name is said once, not in every row
        else:
            rows = itertools.chain([first], rows)
        break
    while batch := list(itertools.islice(rows, BATCH)):
        numbers = range(number + 1, number + len(batch) + 1)
        number += len(batch)
        yield _batch(model, at, numbers, batch, names)


def _batch(model: Model, at: ConfigurationOptions, numbers: range, rows: list[Row], names: list[str] | None) -> _Batch:
    """Return rows as configurations: all at once where all are sound, else one by one."""
    import kinetostat
    from kinetostat.errors import quote

    values = None if isinstance(rows[0], Mapping) else _floats(rows)
    if values is not None:
        try:
            return _Batch(numbers, _configurations(model, at, values, names), [None] * len(rows))
        except kinetostat.ConfigurationError:
            pass
    found, reasons = [], list[str | None]()
    for row in rows:
        try:
            one = _floats([row])
            wanted = row if isinstance(row, Mapping) else one
            if wanted is None:
                raise kinetostat.ConfigurationError(f"{quote(_wrong(row))} is not a number")
            if isinstance(wanted, Mapping):
                found.append(
                    kinetostat.configuration(model, wanted, degrees=at.deg, quaternion_first=at.quat[0]).q[None]
                )
            else:
                found.append(_configurations(model, at, wanted, names))
            reasons.append(None)
        except kinetostat.UsageError as error:
            reasons.append(str(error))
    import numpy as np

    return _Batch(numbers, np.concatenate(found) if found else np.zeros((0, model.robot.nq)), reasons)


def _configurations(model: Model, at: ConfigurationOptions, values: Array, names: list[str] | None) -> Array:
    """Return configurations (m, nq) of rows of numbers, in file order or under names; others zero."""
    from kinetostat.analysis.configuration import from_rows

    return from_rows(model, values, names, degrees=at.deg, quaternion_first=at.quat.value[0])


def _floats(rows: Sequence[Row]) -> Array | None:
    """Return rows of numbers as an array; None if one is no number, or one row is shorter than another."""
    import numpy as np

    try:
        return np.array([[float(cell) for cell in row] for row in rows])
    except (TypeError, ValueError):
        return None


def _wrong(row: Row) -> str:
    """Return the first cell of a row that is no number."""
    return next((str(cell) for cell in row if _floats([[cell]]) is None), "")


def _rows(file: Path) -> Iterator[Row]:
    """Yield the rows of a file: cells of CSV, or what a JSON list, or a line of JSON, holds.

    Raises:
        ConfigurationError: the file cannot be read, or is no list.
    """
    from kinetostat.errors import ConfigurationError

    if file == Path("-"):
        yield from _csv_rows(sys.stdin)
        return
    kind = file.suffix.lower()
    if kind == ".json":
        yield from _json_rows(file)
        return
    if not file.is_file():
        raise ConfigurationError("there is no such file", file=str(file), remedy="check the path")
    try:
        with file.open(encoding="utf-8-sig", newline="") as text:
            yield from (_json_line(line) for line in text if line.strip()) if kind == ".jsonl" else _csv_rows(text)
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not UTF-8 text"
        raise ConfigurationError(f"the list cannot be read: {reason}", file=str(file)) from None


def _csv_rows(text: Any) -> Iterator[Row]:
    for row in csv.reader(text):
        if any(cell.strip() for cell in row):
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
