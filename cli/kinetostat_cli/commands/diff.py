"""`kinetostat diff`: what changed between two versions of a robot, and what follows from it."""

from __future__ import annotations

import contextlib
import os
import sys
import time
from collections.abc import Callable, Iterator
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinetostat_cli import completion
from kinetostat_cli.console import exit_if_apart, load, opened, progress_bar, say
from kinetostat_cli.options import (
    MAX_BYTES,
    DebugOption,
    Format,
    MaxBytesOption,
    OutputOptions,
    PackageDirOption,
    RobotOptions,
    XacroArgOption,
)

if TYPE_CHECKING:
    from kinetostat import Model
    from kinetostat.analysis.difference.difference import Difference
    from kinetostat.gate.revisions import Revision

__all__ = ["register"]

CHANGED = 1
_SOON = 2.0  # s, after which a bar shows that something is being done


class DiffFormat(StrEnum):
    """How a difference is written."""

    TABLE = "table"
    JSON = "json"
    MARKDOWN = "markdown"


def diff(
    before: Annotated[
        str,
        typer.Argument(
            metavar="A",
            help="The robot before: a file, REV:path of a git repository, '-', textbook:NAME or example:NAME.",
            autocompletion=completion.robots,
        ),
    ],
    after: Annotated[
        str, typer.Argument(metavar="B", help="The robot after: likewise.", autocompletion=completion.robots)
    ],
    tolerance: Annotated[
        float, typer.Option(metavar="X", help="What does not count of lengths in m and of angles in rad.")
    ] = 1e-9,
    relative: Annotated[
        float,
        typer.Option(metavar="SHARE", help="What does not count of masses, inertias, efforts, speeds, multipliers."),
    ] = 1e-9,
    frame: Annotated[
        list[str] | None,
        typer.Option(
            "--frame",
            "-f",
            metavar="FRAME",
            help="Follow this frame, not all tips, of A or B. May be repeated.",
            autocompletion=completion.frames,
        ),
    ] = None,
    samples: Annotated[int, typer.Option(min=1, metavar="N", help="Random configurations of each search.")] = 1000,
    form: Annotated[
        DiffFormat, typer.Option("--format", "-F", help="How to write the result; markdown is for a pull request.")
    ] = DiffFormat.TABLE,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="Write the result to a file; - is standard output."),
    ] = None,
    package_dir: PackageDirOption = None,
    xacro_arg: XacroArgOption = None,
    max_bytes: MaxBytesOption = MAX_BYTES,
    crosscheck: Annotated[
        bool, typer.Option("--crosscheck/--no-crosscheck", help="Compute every number by both engines.")
    ] = True,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Also say what is odd about the files, and where they were found.")
    ] = False,
    debug: DebugOption = False,
) -> None:
    """Show what changed between two versions of a robot.

    In meaning, not in text: joints and links, placements, axes, limits, masses; and what follows: how far tips move,
    reach, manipulability, singular families, gravity torques. Exit code 1 if anything exceeds the tolerance.

    Example: kinetostat diff example:panda example:panda_collision
    """
    from kinetostat.analysis.difference.difference import difference
    from kinetostat.errors import UsageError

    if before == after == "-":
        raise UsageError("only one robot can come from standard input", remedy="name a file for the other")
    out = OutputOptions(Format.TABLE, output, crosscheck, verbose, debug)
    a, b = (
        _loaded(RobotOptions(name, package_dir=package_dir, xacro_arg=xacro_arg, max_bytes=max_bytes), out)
        for name in (before, after)
    )
    with _late_bar() as tell:
        result = difference(a, b, tolerance=tolerance, relative=relative, frames=frame, samples=samples, progress=tell)
    text = _rendered(result, a, b, form)
    with opened(out) as write:
        write(text)
    exit_if_apart(result.consequences.certificate, a)
    if result.exceeds:
        raise typer.Exit(CHANGED)


@contextlib.contextmanager
def _late_bar() -> Iterator[Callable[[str, float], None] | None]:
    """Show on a terminal what is being done, once it has taken a while."""
    if not sys.stderr.isatty():
        yield None
        return
    begun, bars = time.monotonic(), list[Callable[[str, float], None]]()
    with contextlib.ExitStack() as stack:

        def tell(what: str, share: float) -> None:
            if not bars and time.monotonic() - begun >= _SOON:
                bar = stack.enter_context(progress_bar())
                bars.append(bar or _silent)
            for one in bars:
                one(what, share)

        yield tell


def _silent(what: str, share: float) -> None:
    """Show nothing."""


def _loaded(robot: RobotOptions, output: OutputOptions) -> Model:
    """Read a robot: a file, or one at a revision, which then goes by the name that it was asked for."""
    from dataclasses import replace

    from kinetostat.errors import RobotError
    from kinetostat.gate.revisions import revision, unpacked

    wanted = revision(robot.source)
    if wanted is None:
        return load(robot, output)
    with unpacked(wanted, max_bytes=robot.max_bytes) as path:
        try:
            model = load(replace(robot, source=str(path)), replace(output, verbose=False))
        except RobotError as error:
            error.file = _as_asked(error.file, path, wanted)
            error.message = error.message.replace(str(path), str(wanted))
            raise
        if output.verbose:
            _tell(model, path, wanted)
    source = replace(model.loaded.source, name=str(wanted))
    return replace(model, loaded=replace(model.loaded, source=source))


def _tell(model: Model, path: Path, wanted: Revision) -> None:
    """Say what was read at a revision, and what is odd about it, as `load` does of a file."""
    say("read", f"{wanted}, sha256 {model.loaded.source.sha256}")
    if model.semantics.file:
        say("read", _as_asked(str(model.semantics.file), path, wanted))
    for remark in model.robot.remarks:
        say("remark", str(remark))


def _as_asked(file: str | None, path: Path, wanted: Revision) -> str:
    """Return the name of a file in an error: of the one that was asked for, or of another at that revision."""
    if file is None or file == str(path):
        return str(wanted)
    beside = os.path.normpath(Path(wanted.path).parent / os.path.relpath(file, path.parent))
    return f"{wanted.rev}:{beside}"


def _rendered(result: Difference, a: Model, b: Model, form: DiffFormat) -> str:
    from kinetostat.report import diff as report
    from kinetostat.report.view import certificate_note

    certificate = result.consequences.certificate
    proof = () if certificate is None else (certificate_note(certificate),)
    if form is DiffFormat.MARKDOWN:
        return report.diff_markdown(result, proof)
    if form is DiffFormat.JSON:
        from kinetostat.report import json

        payload = json.opening("diff", a)
        payload["other"] = json.opening("diff", b)["robot"]
        return json.render(payload | {"result": report.diff_result(result)} | json.closing(certificate, ()))
    from dataclasses import replace

    from kinetostat.report import text

    view = report.diff_view(result)
    return text.render(replace(view, notes=(*view.notes, *proof)))


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(diff)
