"""`kinetostat init`: a first policy for robots."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinetostat_cli import completion
from kinetostat_cli.console import load, opened, say
from kinetostat_cli.options import (
    MAX_BYTES,
    DebugOption,
    MaxBytesOption,
    OutputOptions,
    PackageDirOption,
    RobotOptions,
    XacroArgOption,
)

if TYPE_CHECKING:
    from kinetostat.policy.table import RobotSettings

__all__ = ["register"]

_SHIPPED = ("example:", "textbook:")


@dataclass(frozen=True)
class _Robots:
    """Which robots, and how they are read."""

    sources: list[str]
    srdf: Path | None
    package_dirs: list[Path] | None
    xacro_args: list[str] | None
    max_bytes: int

    def each(self) -> list[RobotOptions]:
        """Return the robots one by one, each once."""
        return [
            RobotOptions(
                source,
                srdf=self.srdf,
                package_dir=self.package_dirs,
                xacro_arg=self.xacro_args if len(self.sources) == 1 or source.endswith(".xacro") else None,
                max_bytes=self.max_bytes,
            )
            for source in dict.fromkeys(self.sources)
        ]


def init(
    robots: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="ROBOT...",
            help="One or several: .urdf or .xacro files, textbook:NAME or example:NAME.",
            autocompletion=completion.robots,
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="FILE", help="Write it to a file, kinetostat.toml. Default: standard output."
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite a file that is there.")] = False,
    schema: Annotated[
        bool, typer.Option("--schema", help="Write the JSON schema of kinetostat.toml instead, for editors.")
    ] = False,
    srdf: Annotated[
        Path | None, typer.Option(metavar="FILE", help="SRDF of the one robot. Default: the one beside it.")
    ] = None,
    package_dir: PackageDirOption = None,
    xacro_arg: XacroArgOption = None,
    max_bytes: MaxBytesOption = MAX_BYTES,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="Also say what is odd about the files.")] = False,
    debug: DebugOption = False,  # noqa: ARG001 (main reads it)
) -> None:
    """Write a first policy for robots.

    A commented kinetostat.toml for 'kinetostat check': what is true of each robot now, with some margin.

    Example: kinetostat init example:panda
    """
    to = OutputOptions(output=output, verbose=verbose)
    written = output if output is not None and output != Path("-") else None
    _refuse_overwriting(written, force=force)
    asked = _Robots(robots or [], srdf, package_dir, xacro_arg, max_bytes)
    text = _schema(asked) if schema else _policy(asked, to, Path() if written is None else written.parent)
    with opened(to) as write:
        write(text)
    if written is not None:
        use = f"line 1 of kinetostat.toml: #:schema ./{written.name}" if schema else "'kinetostat check' reads it"
        say("written", f"{written}: {use}")


def _refuse_overwriting(path: Path | None, *, force: bool) -> None:
    from kinetostat.errors import UsageError, quote

    if path is not None and os.path.lexists(path) and not force:
        remedy = (
            "--force overwrites it; to add a robot to it, run this without -o and copy the lines from [[robots]] on "
            "to its end"
        )
        raise UsageError(f"{quote(str(path))} is there already", remedy=remedy)


def _schema(robots: _Robots) -> str:
    """Return the JSON schema of settings files."""
    from kinetostat.errors import UsageError
    from kinetostat.policy.schema import text

    if robots.sources:
        raise UsageError("--schema is of no robot", remedy="leave the robots out")
    return text()


def _policy(robots: _Robots, to: OutputOptions, folder: Path) -> str:
    """Return a settings file for robots; they are all read before anything is written."""
    from kinetostat.errors import UsageError
    from kinetostat.policy.draft.writing import drafted

    several = robots.each()
    if not several:
        raise UsageError("Missing argument 'ROBOT...'", remedy="for instance kinetostat init robots/arm.urdf")
    if any(robot.source == "-" for robot in several):
        raise UsageError("a policy names its robot: standard input has no name", remedy="save it to a file")
    if robots.srdf is not None and len(several) > 1:
        raise UsageError("--srdf is for one robot", remedy="put each SRDF beside its robot, or write srdf = ... later")
    return drafted([(load(robot, to), _settings(robot, folder)) for robot in several])


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
