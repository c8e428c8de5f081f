"""A sweep's way: it runs, its rows go to a file as they come, or its summary is written; Ctrl-C is answered."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from kinetostat_cli.console import INTERRUPTED, Answer, exit_if_apart, opened, say, warn, write_answer
from kinetostat_cli.options import OutputOptions
from kinetostat_cli.runs import say_rate

if TYPE_CHECKING:
    from kinetostat import Configuration, Model
    from kinetostat.analysis.sweeping.running import Outcome
    from kinetostat.analysis.sweeping.sweep import Sweep, SweepPartial, SweepWork
    from kinetostat.report.row_files import RowWriter
    from kinetostat_cli.rows import SoundRows

__all__ = ["Question"]

_STDOUT = Path("-")


@dataclass(frozen=True)
class Question:
    """What is asked, and where the answer goes.

    Attributes:
        work: what is computed.
        model: of which robot.
        at: where joints are held that do not move.
        listed: the list that configurations come from, or None.
        output: how to write, and where.
        degrees: show angles in degrees.
    """

    work: SweepWork
    model: Model
    at: Configuration
    listed: SoundRows | None
    output: OutputOptions
    degrees: bool

    def compiled(self, tell: Callable[[str, float], None] | None) -> None:
        """Have the kernel ready: the first of its kind on a machine is compiled, which is no part of the sweep."""
        if tell is not None:
            tell("compiling, once", 0.0)
        self.work.kernel(self.work.source.rows(0, 1))

    def summed_up(self, **running: Any) -> Sweep:
        """Run to the end, or to Ctrl-C."""
        from kinetostat.analysis.sweeping.running import run

        outcome = run(self.work, **running)
        if not outcome.rows:
            raise KeyboardInterrupt
        return self.work.result(outcome)

    def written(self, **running: Any) -> Sweep | None:
        """Run, and write rows as they come; None if nobody reads them to the end."""
        from kinetostat.analysis.sweeping.running import run

        try:
            about = self._about()
            with self._row_writer(about) as writer:
                result = self.work.result(_whole(run(self.work, sink=self._sink(writer), **running)))
                about |= self._about(result)
                return result
        except _NobodyReadsError:
            return None
        except KeyboardInterrupt:
            left = "" if self.output.output == _STDOUT else ", and no file is left"
            say("warning", f"interrupted: the rows are not complete{left}")
            raise

    def _sink(self, writer: RowWriter) -> Callable[[int, SweepPartial], None]:
        from kinetostat.report.sweep import row_fields, row_values

        fields = row_fields(self.work)

        def write(_chunk: int, partial: SweepPartial) -> None:
            block = partial.table
            assert block is not None
            numbers = self._numbers(block.start, len(block.q))
            if not writer.write(numbers, row_values(fields, block.q, block.values)):
                raise _NobodyReadsError

        return write

    @contextmanager
    def _row_writer(self, about: Mapping[str, Any]) -> Iterator[RowWriter]:
        from kinetostat.report.row_files import CsvRows, open_rows
        from kinetostat.report.sweep import grid_arrays, row_fields

        fields, path = row_fields(self.work), self.output.output or _STDOUT
        if path == _STDOUT:
            with opened(self.output) as write:
                yield CsvRows(write, fields)
            return
        with open_rows(path, fields, about, self.work.rows, grid_arrays(self.work)) as writer:
            yield writer

    def _about(self, result: Sweep | None = None) -> dict[str, Any]:
        """Return what a file says of its rows: what was asked for; with the result, also the certificate."""
        from kinetostat.report.json import opening
        from kinetostat.report.sweep import rows_about

        return rows_about(self.work, opening("sweep.rows", self.model), result)

    def _numbers(self, start: int, count: int) -> Any:
        """Return the numbers of rows, from 1; those of the list that they come from, which may have others between."""
        import numpy as np

        if self.listed is not None:
            return self.listed.numbers[start : start + count]
        return np.arange(start + 1, start + count + 1)

    def say_of_rows(self, result: Sweep) -> None:
        """Say what was written."""
        from kinetostat.report.sweep import beyond_notes
        from kinetostat.report.view import certificate_note

        warn(result.warnings)
        rows = "1 row" if result.count == 1 else f"{result.count} rows"
        again = f", {result.certified_rows} of them computed again" if result.certified_rows else ""
        say("note", f"{rows}{again}; {certificate_note(result.certificate)}")
        for note in beyond_notes(result):
            say("note", note)
        say_rate(result)
        exit_if_apart(result.certificate, self.model)

    def write_summary(self, result: Sweep) -> None:
        """Write the summary; exit with 130 if Ctrl-C has left it partial."""
        from kinetostat.report import sweep as report

        numbers, warnings = None if self.listed is None else self.listed.numbers, list(result.warnings)
        if not result.complete:
            warnings.append(f"interrupted: {result.count} of {result.requested} configurations are in the summary")
        say_rate(result)
        write_answer(
            Answer(
                "sweep",
                lambda: report.sweep_view(result, self.at, degrees=self.degrees),
                lambda: report.sweep_result(result, numbers),
                self.model,
                self.at,
                result.certificate,
                tuple(warnings),
            ),
            self.output,
        )
        if not result.complete:
            raise typer.Exit(INTERRUPTED)


class _NobodyReadsError(Exception):
    """Standard output was closed by whom it went to."""


def _whole(outcome: Outcome[SweepPartial]) -> Outcome[SweepPartial]:
    """Return an outcome that is complete: a file of some of the rows is none."""
    if not outcome.complete:
        raise KeyboardInterrupt
    return outcome
