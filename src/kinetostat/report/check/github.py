"""The report as workflow commands of GitHub Actions: an annotation at each line, `::error file=...,line=...::...`."""

from __future__ import annotations

from pathlib import Path

from kinetostat.errors import printable
from kinetostat.gate.result import CheckReport
from kinetostat.lint.finding import Severity
from kinetostat.report.check.problems import Problem, problems
from kinetostat.report.check.words import encodable, totals_text

__all__ = ["render"]

_COMMANDS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "notice"}


def render(report: CheckReport, *, base: Path | None = None) -> str:
    """Return the report as workflow commands, and a last line of totals.

    Args:
        report: what was found out.
        base: the folder that relative paths start from; files are named relative to the repository that it is in.
    """
    lines = [_annotation(problem) for file in report.files for problem in problems(file, base)]
    return encodable("\n".join([*lines, totals_text(report)]) + "\n")


def _annotation(problem: Problem) -> str:
    properties = {"file": printable(problem.path)}
    if problem.line:
        properties["line"] = str(problem.line)
        if problem.columns is not None:
            first, end = problem.columns
            properties |= {"col": str(first + 1), "endColumn": str(end)}
    properties["title"] = problem.title
    told = ",".join(f"{key}={_property(value)}" for key, value in properties.items())
    notes = [printable(note) for note in (problem.hint, problem.place) if note]
    message = f"{problem.message} ({'; '.join(notes)})" if notes else problem.message
    return f"::{_COMMANDS[problem.severity]} {told}::{_data(message)}"


def _data(text: str) -> str:
    """Escape what would end a command."""
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    """Escape what would end a property."""
    return _data(text).replace(":", "%3A").replace(",", "%2C")
