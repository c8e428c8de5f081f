"""What commands have in common: load the robot, find the configuration, write the result, say the rest on stderr."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TextIO

import typer

from kinetostat_cli.options import Base, ConfigurationOptions, Format, OutputOptions, RobotOptions

if TYPE_CHECKING:
    from kinetostat import Certificate, Configuration, Model
    from kinetostat.report.view import View

__all__ = [
    "INTERRUPTED",
    "Answer",
    "asked_configuration",
    "configuration",
    "exit_if_apart",
    "held_configuration",
    "load",
    "opened",
    "progress_bar",
    "refuse",
    "say",
    "triple",
    "warn",
    "write_answer",
    "xacro_arguments",
]

DISAGREE = 4
INTERRUPTED = 130


def say(kind: str, message: str) -> None:
    """Write one line to standard error: `kinetostat: warning: ...`; the kind is coloured on a terminal.

    Nothing happens where standard error is closed or full: what is said there is no part of the result.
    """
    from kinetostat.errors import printable

    if sys.stderr is None:
        return
    colour = {"error": typer.colors.RED, "warning": typer.colors.YELLOW}.get(kind)
    plain = not sys.stderr.isatty() or "NO_COLOR" in os.environ
    shown = kind if plain or colour is None else typer.style(kind, fg=colour, bold=True)
    said = printable(message).replace("##[", r"##\x5b")  # GitHub's runner would read a command
    try:
        print(f"kinetostat: {shown}: {said}", file=sys.stderr, flush=True)
    except (OSError, ValueError):  # ValueError: closed by the program that we run in
        _forget(sys.stderr)


def warn(messages: Iterable[str]) -> None:
    """Write warnings to standard error."""
    for message in messages:
        say("warning", message)


def xacro_arguments(given: list[str] | None) -> dict[str, str]:
    """Return the arguments NAME:=VALUE of xacro files by name.

    Raises:
        UsageError: one is not of that form.
    """
    arguments = {}
    for argument in given or []:
        name, separator, value = argument.partition(":=")
        if not separator or not name:
            from kinetostat.errors import UsageError

            message = f"--xacro-arg {argument!r} is not of the form NAME:=VALUE"
            raise UsageError(message, remedy="for instance side:=left")
        arguments[name] = value
    return arguments


def load(robot: RobotOptions, output: OutputOptions) -> Model:
    """Read the robot as the options say."""
    import kinetostat
    from kinetostat.errors import quote

    for folder in robot.package_dir or []:
        if not os.path.isdir(folder):  # noqa: PTH112 (Path.is_dir raises where the name is too long)
            message = f"--package-dir {quote(str(folder))} is not a folder"
            raise kinetostat.UsageError(message, remedy="name a folder with packages")
    model = kinetostat.load(
        robot.source,
        floating_base=robot.base is Base.FLOATING,
        crosscheck=output.crosscheck,
        srdf=robot.srdf,
        package_dirs=robot.package_dir or [],
        xacro_arguments=xacro_arguments(robot.xacro_arg),
        max_bytes=robot.max_bytes,
    )
    if output.verbose:
        source = model.loaded.source
        say("read", f"{source.path or 'standard input'}, sha256 {source.sha256}")
        if model.semantics.file:
            say("read", model.semantics.file)
        for remark in model.robot.remarks:
            say("remark", str(remark))
    return model


def configuration(model: Model, at: ConfigurationOptions) -> Configuration:
    """Return the configuration that the options ask for; warn of joints outside their limits."""
    found = asked_configuration(model, at)
    warn(found.warnings)
    return found


def asked_configuration(model: Model, at: ConfigurationOptions) -> Configuration:
    """Return the configuration that the options ask for, with its warnings, which are not said yet."""
    import kinetostat

    wanted: Any = at.config
    degrees = at.deg
    if at.config.startswith("@"):
        from kinetostat_cli.values import read_values

        wanted, in_radians = read_values(at.config[1:])
        degrees = degrees and not in_radians
    return kinetostat.configuration(model, wanted, degrees=degrees, quaternion_first=at.quat.value[0])


def held_configuration(model: Model, at: ConfigurationOptions) -> Configuration:
    """Return where joints are held that something else does not move, with its warnings, which are not said yet.

    Zero is what nobody asked for: nothing is said of joints that are outside their limits there.
    """
    found = asked_configuration(model, at)
    return replace(found, warnings=()) if at.config == "zero" else found


def triple(text: str | None, option: str) -> tuple[float, float, float] | None:
    """Return the three numbers of an option such as --point x,y,z."""
    if text is None:
        return None
    from kinetostat_cli.values import numbers

    x, y, z = numbers(text, option, 3)
    return x, y, z


def refuse(wrong: bool, options: Mapping[str, object], why: str, remedy: str) -> None:
    """Refuse the first option that is given where it means nothing, if this is wrong here.

    Raises:
        UsageError: one is given.
    """
    given = next((name for name, value in options.items() if value is not None), None)
    if wrong and given is not None:
        from kinetostat.errors import UsageError

        raise UsageError(f"{given} {why}", remedy=remedy)


@contextlib.contextmanager
def progress_bar() -> Iterator[Callable[[str, float], None] | None]:
    """Show on a terminal what is being done and how far it is; yield what tells it, None without a terminal."""
    if sys.stderr is None or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=1.0)
        yield lambda what, share: bar.update(task, description=what, completed=share)


@dataclass(frozen=True)
class Answer:
    """What a command has found: how to view it and how to put it into JSON (both made only when asked)."""

    command: str
    view: Callable[[], View]
    result: Callable[[], Any]
    model: Model | None = None
    at: Configuration | None = None
    certificate: Certificate | None = None
    warnings: tuple[str, ...] = ()


def write_answer(answer: Answer, output: OutputOptions) -> None:
    """Render an answer once, write it once, and exit with 4 if the engines disagree."""
    warn(answer.warnings)
    text = _rendered(answer, output.format)
    with opened(output) as write:
        write(text)
    exit_if_apart(answer.certificate, answer.model)


@contextlib.contextmanager
def opened(output: OutputOptions) -> Iterator[Callable[[str], bool]]:
    """Yield what writes text to where the result goes: a file that is there whole or not at all, or standard output.

    It tells whether anybody still reads.
    """
    if output.output is None or output.output == Path("-"):
        yield _write_out
        return
    from kinetostat.report.writing import open_whole

    with open_whole(output.output) as file:
        yield lambda text: _write_to(file, text)


def _write_to(file: BinaryIO, text: str) -> bool:
    file.write(text.encode())
    return True


def exit_if_apart(certificate: Certificate | None, model: Model | None) -> None:
    """Say so and exit with 4 if the engines disagree."""
    if certificate is not None and certificate.agree is False:
        apart = f"{certificate.max_difference:.3g}, more than {certificate.tolerance:.3g}"
        file = f"{model.loaded.source.name}: " if model else ""
        say("error", f"{file}the engines disagree by {apart}: trust neither number")
        raise typer.Exit(DISAGREE)


def _rendered(answer: Answer, form: Format) -> str:
    if form is Format.JSON:
        from kinetostat.report import json as report

        warnings = (*(answer.at.warnings if answer.at else ()), *answer.warnings)
        payload = report.envelope(
            answer.command,
            answer.result(),
            model=answer.model,
            at=answer.at,
            certificate=answer.certificate,
            warnings=warnings,
        )
        return report.render(payload)
    view = answer.view()
    if form is Format.CSV:
        from kinetostat.report import csv

        return csv.render(view.csv)
    from kinetostat.report import text
    from kinetostat.report.view import certificate_note, disagreement_tables

    if answer.certificate is not None:
        tables = (*view.tables, *disagreement_tables(answer.certificate))
        view = replace(view, tables=tables, notes=(*view.notes, certificate_note(answer.certificate)))
    return text.render(view)


def _write_out(text: str) -> bool:
    """Write to standard output. A reader that has gone (head, less) is no error: it has what it wanted."""
    if sys.stdout is None:
        from kinetostat.errors import UsageError

        raise UsageError("cannot write to standard output: it is closed", remedy="use -o FILE")
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        _forget(sys.stdout)
        return False
    except OSError as error:
        from kinetostat.errors import UsageError

        _forget(sys.stdout)
        raise UsageError(f"cannot write to standard output: {error.strerror}", remedy="is the disk full?") from None
    return True


def _forget(stream: TextIO) -> None:
    """Send what is left of a standard stream nowhere, so that Python's last flush does not fail again."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
