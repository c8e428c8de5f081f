"""`--qs FILE`: a list of configurations in, one row out for each, in batches; a reason where there is no answer."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinetostat_cli.console import exit_if_apart, opened, progress_bar, say
from kinetostat_cli.options import ConfigurationOptions, Format, OutputOptions
from kinetostat_cli.reading import RowKind, batches, configuration_rows

if TYPE_CHECKING:
    from kinetostat import Certificate, Model
    from kinetostat.conventions import Array
    from kinetostat.report.rows import Column

__all__ = ["Answers", "ListOption", "answer_list"]

ListOption = Annotated[
    Path | None,
    typer.Option(
        "--qs",
        metavar="FILE",
        help="Answer for each configuration of a .csv, .json or .jsonl file (-: CSV on standard input): a row out for "
        "each row in, as CSV, or with -F json.",
    ),
]


@dataclass(frozen=True)
class Answers:
    """What a batch of m configurations gives: columns of m cells, the certificate, and a reason where one failed."""

    columns: Sequence[Column]
    certificate: Certificate
    reasons: Sequence[str | None] | None = None


def answer_list(
    command: str,
    model: Model,
    file: Path,
    at: ConfigurationOptions,
    output: OutputOptions,
    evaluate: Callable[[Array], Answers],
    kind: RowKind | None = None,
) -> None:
    """Read configurations (or rows of another kind), evaluate them in batches, and write a row for each as it comes."""
    from kinetostat.analysis.crosscheck import combined
    from kinetostat.report import rows as form
    from kinetostat.report.json import closing, opening
    from kinetostat.report.view import certificate_note

    kind = kind or _configurations(model, at)
    # One row first: it tells the columns, and what is wrong with the question is said before anything else.
    blank = evaluate(kind.blank)
    proofs, count, failed, as_json = [blank.certificate], 0, 0, output.format is Format.JSON
    rows = batches(file, kind)
    first = list(itertools.islice(rows, 1))  # what is wrong with the file is said before anything is written
    with opened(output) as write, progress_bar() as tell:
        head = (
            form.json_head(opening(f"{command}.rows", model), blank.columns)
            if as_json
            else form.csv_head(blank.columns)
        )
        write(head)
        for batch in itertools.chain(first, rows):
            columns, reasons = blank.columns, batch.reasons
            if len(batch.values):
                found = evaluate(batch.values)
                columns, proofs = found.columns, [combined([*proofs, found.certificate])]
                reasons = _merged(reasons, found)
            columns = _answered(columns, batch.reasons, reasons)
            text = (
                form.json_rows(batch.numbers, columns, reasons, first=count == 0)
                if as_json
                else form.csv_rows(batch.numbers, columns, reasons)
            )
            if not write(text):  # nobody reads any more
                return
            count, failed = count + len(batch.numbers), failed + sum(reason is not None for reason in reasons)
            if tell is not None:
                tell(f"{count} rows", 0.0)
        if as_json:
            write(form.json_foot(closing(proofs[0], ())))
    lost = f", {failed} of them without an answer" if failed else ""
    rows_read = "1 row" if count == 1 else f"{count} rows"
    say("warning" if failed else "note", f"{rows_read}{lost}; {certificate_note(proofs[0])}")
    exit_if_apart(proofs[0], model)


def _configurations(model: Model, at: ConfigurationOptions) -> RowKind:
    from kinetostat.errors import UsageError

    if at.config != "zero":
        raise UsageError("--qs lists the configurations", remedy="leave out --config")
    return configuration_rows(model, at)


def _merged(reasons: list[str | None], found: Answers) -> list[str | None]:
    """Return the reasons of all rows: those found in reading, and those of the rows that were evaluated."""
    later = iter(found.reasons or itertools.repeat(None))
    return [reason or next(later) for reason in reasons]


def _answered(columns: Sequence[Column], read: Sequence[str | None], reasons: Sequence[str | None]) -> Sequence[Column]:
    """Return the columns with the cells of those rows alone that have an answer."""
    from kinetostat.report.rows import Column

    kept = [reason is None for before, reason in zip(read, reasons, strict=True) if before is None]
    return [Column(c.name, c.unit, [x for x, keep in zip(c.cells, kept, strict=False) if keep]) for c in columns]
