"""`kinetostat check`: the gate for robot models."""

from __future__ import annotations

import os
import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinetostat.errors import UsageError, quote
from kinetostat_cli.console import opened, say, xacro_arguments
from kinetostat_cli.fleets import (
    JobsOption,
    NoSettingsOption,
    PathsArgument,
    SettingsOption,
    SrdfOption,
    here,
    progress,
    settings_of,
)
from kinetostat_cli.options import (
    MAX_BYTES,
    DebugOption,
    MaxBytesOption,
    OutputOptions,
    PackageDirOption,
    XacroArgOption,
)
from kinetostat_cli.runs import cores

if TYPE_CHECKING:
    from kinetostat.gate.result import CheckReport

__all__ = ["register"]


class Form(StrEnum):
    """How the report is written."""

    TEXT = "text"
    JSON = "json"
    SARIF = "sarif"
    JUNIT = "junit"
    GITHUB = "github"
    MARKDOWN = "markdown"


class FailOn(StrEnum):
    """The mildest finding that fails a file."""

    ERROR = "error"
    WARNING = "warning"
    INFO = "info"


_Codes = list[str] | None


def check(
    paths: PathsArgument = None,
    form: Annotated[Form, typer.Option("--format", "-F", help="How to write the report.")] = Form.TEXT,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="FILE", help="Write the report to a file.")
    ] = None,
    also: Annotated[
        list[str] | None,
        typer.Option(metavar="FORMAT=FILE", help="Write the same report to a file, too: sarif=check.sarif."),
    ] = None,
    select: Annotated[_Codes, typer.Option(metavar="CODES", help="Ask only these rules: J103, J1, K, ... .")] = None,
    ignore: Annotated[_Codes, typer.Option(metavar="CODES", help="Leave these rules out.")] = None,
    fail_on: Annotated[FailOn | None, typer.Option(help="The mildest finding that fails. Default: error.")] = None,
    samples: Annotated[
        int | None,
        typer.Option(min=0, max=10_000, metavar="N", help="Configurations at which readers are compared. Default: 20."),
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, metavar="N", help="Of the random ones. Default: 0.")] = None,
    settings: SettingsOption = None,
    no_settings: NoSettingsOption = False,
    baseline: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Known findings in this file do not count.")
    ] = None,
    write_baseline: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write all findings to this file: from now on they are known.")
    ] = None,
    changed_since: Annotated[
        str | None, typer.Option(metavar="REV", help="Check only what has changed since this revision of git.")
    ] = None,
    jobs: JobsOption = None,
    timeout: Annotated[
        float | None, typer.Option(min=0.1, metavar="S", help="Seconds for one robot. Default: 120.")
    ] = None,
    srdf: SrdfOption = None,
    package_dir: PackageDirOption = None,
    xacro_arg: XacroArgOption = None,
    max_bytes: MaxBytesOption = MAX_BYTES,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="Also show infos and what is met.")] = False,
    debug: DebugOption = False,  # noqa: ARG001 (main reads it)
) -> None:
    """Check robot files: rules, three readers' agreement, a policy.

    Exit code 0 if every file passes, 1 if one does not: a finding, an unmet expectation, a crash.

    Example: kinetostat check example:panda
    """
    from kinetostat.gate.pool import warm_up

    warm_up()  # the libraries load in the background meanwhile
    import kinetostat
    from kinetostat.gate.check import without_baseline

    chosen, folder = settings_of(settings, paths or [], wanted=not no_settings)
    reports = _further(also)
    if write_baseline is not None:
        chosen, baseline = without_baseline(chosen), None
    with progress() as shown:
        report = kinetostat.check(
            paths or [],
            settings=chosen,
            folder=folder,
            select=_codes(select),
            ignore=_codes(ignore) or [],
            fail_on=fail_on.value if fail_on else None,
            samples=samples,
            seed=seed,
            baseline=baseline,
            changed_since=changed_since,
            jobs=jobs or cores(),
            timeout=timeout,
            srdf=srdf,
            package_dirs=package_dir or [],
            xacro_arguments=xacro_arguments(xacro_arg),
            max_bytes=max_bytes,
            done=lambda file, count: shown.done(file.path, count),
        )
    if write_baseline is not None:
        _write_baseline(report, write_baseline)
        return
    with opened(OutputOptions(output=output)) as write:
        write(_rendered(report, form, verbose=verbose, colour=output is None))
    for further, path in reports:
        _write(report, further, path)
    if not report.passed:
        raise typer.Exit(1)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(check)


def _codes(words: list[str] | None) -> list[str] | None:
    """Return the codes of an option that may be repeated, and each time be a list."""
    return None if words is None else [code.strip() for word in words for code in word.split(",") if code.strip()]


def _write_baseline(report: CheckReport, path: Path) -> None:
    from kinetostat.gate.baseline import baseline_text, read_baseline
    from kinetostat.report.writing import open_whole

    crashed = [file.path for file in report.files if file.verdict == "crashed"]
    if crashed:
        raise UsageError(f"no baseline is written: {quote(crashed[0])} crashed")
    known = read_baseline(path) if path.exists() else {}
    text = baseline_text(report.files, path.parent, known)
    with open_whole(path) as file:
        file.write(text.encode())
    count = sum(len(file.findings) for file in report.files)
    say(
        "baseline",
        f"{count} findings of {len(report.files)} files are known from now on; of other files, what was known",
    )


def _rendered(report: CheckReport, form: Form, *, verbose: bool = False, colour: bool = False) -> str:
    if form is not Form.TEXT:
        from kinetostat.report.check import rendered

        return rendered(report, form.value, base=here())
    from kinetostat.report.check.text import render

    on_terminal = colour and sys.stdout is not None and sys.stdout.isatty() and "NO_COLOR" not in os.environ
    return render(report, verbose=verbose, style=_styled if on_terminal else None)


def _further(given: list[str] | None) -> list[tuple[Form, Path]]:
    """Return the further reports that are asked for, FORMAT=FILE."""
    found = []
    for word in given or []:
        form, separator, path = word.partition("=")
        if not separator or not path or form not in list(Form):
            message = f"--also {quote(word)} is not of the form FORMAT=FILE"
            raise UsageError(message, remedy=f"formats are {', '.join(Form)}; for instance sarif=check.sarif")
        found.append((Form(form), Path(path)))
    return found


def _write(report: CheckReport, form: Form, path: Path) -> None:
    with opened(OutputOptions(output=path)) as write:
        write(_rendered(report, form))


_COLOURS = {
    "error": typer.colors.RED,
    "crashed": typer.colors.RED,
    "fail": typer.colors.RED,
    "warning": typer.colors.YELLOW,
    "info": typer.colors.BLUE,
    "pass": typer.colors.GREEN,
    "caret": typer.colors.CYAN,
}


def _styled(kind: str, text: str) -> str:
    return typer.style(text, fg=_COLOURS[kind], bold=True) if kind in _COLOURS else text
