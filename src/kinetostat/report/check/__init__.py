"""What `check` prints: one report, six formats, each a pure function from the report to text."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

from kinetostat.errors import UsageError, quote
from kinetostat.gate.result import CheckReport

__all__ = ["FORMATS", "rendered"]

FORMATS = ("text", "json", "sarif", "junit", "github", "markdown")


def rendered(report: CheckReport, form: str, *, base: Path | None = None) -> str:
    """Return a report in one of the `FORMATS`, as it goes to a file.

    Args:
        report: what `gate.check` found.
        form: the format.
        base: the folder that relative paths start from; SARIF and GitHub name files relative to its repository.

    Raises:
        UsageError: there is no such format.
    """
    if form not in FORMATS:
        raise UsageError(f"there is no format {quote(form)}", remedy=f"one of {', '.join(FORMATS)}")
    module = import_module(f"{__name__}.{form}")
    text: str = module.render(report, base=base) if form in ("sarif", "github") else module.render(report)
    return text
