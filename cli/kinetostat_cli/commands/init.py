"""`kinetostat init`: a first policy for a robot."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinetostat_cli.console import load, opened, say
from kinetostat_cli.options import Base, OutputOptions, RobotOptions, grouped

if TYPE_CHECKING:
    from kinetostat.policy.table import RobotSettings

__all__ = ["register"]

_SHIPPED = ("example:", "textbook:")


@grouped
def init(
    robot: RobotOptions,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="FILE", help="Write it to a file, kinetostat.toml. Default: standard output."
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite a file that is there.")] = False,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="Also say what is odd about the file.")] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show a traceback when something goes wrong.")] = False,  # noqa: ARG001 (main reads it)
) -> None:
    """Write a first policy for a robot.

    A commented kinetostat.toml for 'kinetostat check': what is true of the robot now, as expectations with some margin.

    Example: kinetostat init example:panda
    """
    from kinetostat.errors import UsageError, quote
    from kinetostat.policy.draft.writing import drafted

    to = OutputOptions(output=output, verbose=verbose)
    written = output is not None and output != Path("-")
    if robot.source == "-":
        raise UsageError("a policy names its robot: standard input has no name", remedy="save it to a file")
    if robot.base is Base.FLOATING:
        raise UsageError("--base floating is not for a policy", remedy="leave it out")
    if written and output is not None and os.path.lexists(output) and not force:
        raise UsageError(f"{quote(str(output))} is there already", remedy="--force overwrites it")
    model = load(robot, to)
    folder = output.parent if written and output is not None else Path()
    text = drafted(model, _settings(robot, folder))
    with opened(to) as write:
        write(text)
    if written:
        say("written", f"{output}: 'kinetostat check' reads it")


def _settings(robot: RobotOptions, folder: Path) -> RobotSettings:
    """Return how the robot is read, paths relative to the folder of the settings file."""
    from kinetostat.policy.table import RobotSettings

    pairs = (argument.partition(":=") for argument in robot.xacro_arg or [])
    return RobotSettings(
        path=robot.source if robot.source.startswith(_SHIPPED) else _relative(robot.source, folder),
        srdf=_relative(robot.srdf, folder) if robot.srdf else "",
        package_dirs=tuple(_relative(one, folder) for one in robot.package_dir or []),
        xacro_args={name: value for name, _, value in pairs},
    )


def _relative(path: str | Path, folder: Path) -> str:
    return Path(os.path.relpath(path, folder)).as_posix()


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(init)
