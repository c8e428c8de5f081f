"""The options that commands share, each declared once, and the decorator that puts them into a command's signature.

A command takes a group of options as one parameter (`robot: RobotOptions`); `grouped` spreads its fields for Typer and
collects them again. Adding an option to a group adds it to every command that takes the group.
"""

from __future__ import annotations

import functools
import inspect
import re
from collections.abc import Callable
from dataclasses import MISSING, dataclass, fields
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import typer

from kinetostat.conventions import Order, Reference
from kinetostat_cli import completion

__all__ = [
    "MAX_BYTES",
    "AxesOption",
    "Base",
    "ConfigurationOptions",
    "DebugOption",
    "ExpressedInOption",
    "Format",
    "FrameOption",
    "HeldOptions",
    "MaxBytesOption",
    "OrderOption",
    "OutputOptions",
    "PackageDirOption",
    "PointOption",
    "Quaternion",
    "ReferenceOption",
    "RelativeToOption",
    "RobotOptions",
    "RunOptions",
    "TaskAxes",
    "TaskReferenceOption",
    "XacroArgOption",
    "grouped",
    "joined_axes",
]


class Format(StrEnum):
    """How results are written."""

    TABLE = "table"
    JSON = "json"
    CSV = "csv"


class TaskAxes(StrEnum):
    """In whose axes the rows of a task are: those of a tool point have no other."""

    ALIGNED = "aligned"
    LOCAL = "local"


class Base(StrEnum):
    """How the root link is held."""

    FIXED = "fixed"
    FLOATING = "floating"


class Quaternion(StrEnum):
    """The order in which quaternions are read."""

    XYZW = "xyzw"
    WXYZ = "wxyz"


FrameOption = Annotated[
    str | None,
    typer.Option(
        "--frame",
        "-f",
        metavar="FRAME",
        help="The frame: a link. Default: the only tip.",
        autocompletion=completion.frames,
    ),
]
RelativeToOption = Annotated[
    str | None,
    typer.Option(
        "--relative-to",
        metavar="FRAME",
        help="The observer's frame. Default: the root link.",
        autocompletion=completion.frames,
    ),
]
ExpressedInOption = Annotated[
    str | None,
    typer.Option(metavar="FRAME", help="Turn the rows to the axes of this frame.", autocompletion=completion.frames),
]
PointOption = Annotated[
    str | None, typer.Option(metavar="X,Y,Z", help="Take this point of the frame, in m, not its origin.")
]
ReferenceOption = Annotated[
    Reference,
    typer.Option(
        help="aligned: the frame's origin, observer's axes. local: its origin, its own axes. "
        "world: the point at the observer's origin, observer's axes."
    ),
]
TaskReferenceOption = Annotated[
    TaskAxes,
    typer.Option(
        "--reference", help="aligned: --axes are the observer's. local: the tool frame's own, such as a weld's."
    ),
]
AxesOption = Annotated[
    str | None,
    typer.Option(
        "--axes",
        metavar="AXES",
        help="Rows that count: xyz translate, rx ry rz turn; for instance x y rz for a planar arm.",
    ),
]
OrderOption = Annotated[Order, typer.Option("--order", help="Order of the rows of twists and wrenches.")]


PackageDirOption = Annotated[
    list[Path] | None, typer.Option(metavar="DIR", help="Look for packages here first. May be repeated.")
]
XacroArgOption = Annotated[
    list[str] | None, typer.Option(metavar="NAME:=VALUE", help="An argument of a xacro file. May be repeated.")
]
MaxBytesOption = Annotated[int, typer.Option(min=1, max=2**40, metavar="N", help="Refuse larger files.")]
DebugOption = Annotated[bool, typer.Option("--debug", help="Show a traceback when something goes wrong.")]
MAX_BYTES = 64 * 1024 * 1024


@dataclass(frozen=True)
class RobotOptions:
    """Which robot, and how it is read."""

    source: Annotated[
        str,
        typer.Argument(
            metavar="ROBOT",
            help="A .urdf or .xacro file, '-', textbook:NAME or example:NAME ('kinetostat robots' lists them).",
            autocompletion=completion.robots,
        ),
    ]
    base: Annotated[
        Base, typer.Option(help="Hold the root link, or let it float: joint root_joint, link universe.")
    ] = Base.FIXED
    srdf: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="SRDF with groups and states. Default: the one beside the robot."),
    ] = None
    package_dir: PackageDirOption = None
    xacro_arg: XacroArgOption = None
    max_bytes: MaxBytesOption = MAX_BYTES


@dataclass(frozen=True)
class ConfigurationOptions:
    """At which configuration."""

    config: Annotated[
        str,
        typer.Option(
            "--config",
            "-q",
            metavar="Q",
            help="zero, mid, random:SEED, an SRDF state, j1=0.3,j2=-1.2, a list in file order, @FILE.json, @FILE.csv.",
            autocompletion=completion.configurations,
        ),
    ] = "zero"
    deg: Annotated[
        bool,
        typer.Option(
            "--deg",
            help="Read and show joint angles and rates in degrees. JSON, and a result read back, are in radians.",
        ),
    ] = False
    quat: Annotated[Quaternion, typer.Option(help="Order in which quaternions of floating joints are read.")] = (
        Quaternion.XYZW
    )


@dataclass(frozen=True)
class HeldOptions(ConfigurationOptions):
    """At which configuration joints are held that a picture does not show: where none is asked for, mid."""

    config: Annotated[
        str,
        typer.Option(
            "--config",
            "-q",
            metavar="Q",
            help="Where --plot holds the other joints: mid, zero, random:SEED, an SRDF state, j1=0.3, a list, a file.",
            autocompletion=completion.configurations,
        ),
    ] = "mid"


@dataclass(frozen=True)
class OutputOptions:
    """Where the result goes, and how."""

    format: Annotated[Format, typer.Option("--format", "-F", help="How to write the result.")] = Format.TABLE
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="Write the result to a file; - is standard output."),
    ] = None
    crosscheck: Annotated[
        bool, typer.Option("--crosscheck/--no-crosscheck", help="Compute every number by both engines.")
    ] = True
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Also say what is odd about the file, and where it was found.")
    ] = False
    debug: DebugOption = False


@dataclass(frozen=True)
class RunOptions:
    """Who computes many configurations, and where what is done is kept."""

    jobs: Annotated[
        int | None, typer.Option("--jobs", "-j", min=0, max=1024, metavar="N", help="Threads. Default: 0, a core each.")
    ] = None
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Compute on the Dask cluster of this scheduler: tcp://HOST:8786."),
    ] = None
    checkpoint: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Keep what is done in this folder, and go on from it: for long runs."),
    ] = None


_GROUPS = (RunOptions, ConfigurationOptions, HeldOptions, RobotOptions, OutputOptions)


def _parameters(group: type[Any]) -> list[inspect.Parameter]:
    """Return an option group's fields as parameters."""
    types = get_type_hints(group, include_extras=True)
    return [
        inspect.Parameter(
            part.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=inspect.Parameter.empty if part.default is MISSING else part.default,
            annotation=types[part.name],
        )
        for part in fields(group)
    ]


def grouped(command: Callable[..., None]) -> Callable[..., None]:
    """Spread the option groups in a command's signature, so that Typer sees each option."""
    hints = get_type_hints(command, include_extras=True)
    own = [
        parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY, annotation=hints[name])
        for name, parameter in inspect.signature(command).parameters.items()
        if hints[name] not in _GROUPS
    ]
    shared = [parameter for group in _GROUPS if group in hints.values() for parameter in _parameters(group)]
    # ROBOT is the first argument; of the options, help shows what is special about a command first.
    spread = sorted(own + shared, key=lambda parameter: parameter.name != "source")

    @functools.wraps(command)
    def collect(**given: Any) -> None:
        arguments = {}
        for name, kind in hints.items():
            if kind in _GROUPS:
                arguments[name] = kind(**{part.name: given.pop(part.name) for part in fields(kind)})
            elif name != "return":
                arguments[name] = given.pop(name)
        command(**arguments)

    collect.__signature__ = inspect.Signature(spread)  # type: ignore[attr-defined]
    collect.__annotations__ = {parameter.name: parameter.annotation for parameter in spread}
    return collect


def joined_axes(arguments: list[str]) -> list[str]:
    """Return the command line with the words after --axes joined to one: `--axes x y rz` needs no quotation marks."""
    joined, taking = list[str](), False
    for word in arguments:
        if taking and joined[-1] != "--axes" and re.fullmatch(r"([rvw]?[xyz]+)+", word):
            joined[-1] += f",{word}"
        else:
            taking = word == "--axes" or (taking and joined[-1] == "--axes")
            joined.append(word)
    return joined
