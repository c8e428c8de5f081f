"""From the name of a robot to its description, and the text for the other engine: the whole reading in one place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO

from kinetostat.urdf.canonical import canonical_text
from kinetostat.urdf.description import Robot
from kinetostat.urdf.document import parse
from kinetostat.urdf.files import MAX_BYTES, Source, open_source
from kinetostat.urdf.packages import Packages
from kinetostat.urdf.reader import read
from kinetostat.urdf.srdf import Semantics, find_srdf, load_srdf
from kinetostat.urdf.xacro import expand, is_xacro

__all__ = ["LoadedRobot", "load_robot"]


@dataclass(frozen=True)
class LoadedRobot:
    """A robot as read: its description, the text for Pinocchio, where it came from, and its SRDF."""

    robot: Robot
    text: str
    source: Source
    packages: Packages
    semantics: Semantics


def load_robot(
    name: str,
    *,
    srdf: Path | None = None,
    package_dirs: Sequence[Path] = (),
    xacro_arguments: Mapping[str, str] | None = None,
    max_bytes: int = MAX_BYTES,
    stdin: BinaryIO | None = None,
) -> LoadedRobot:
    """Read a robot: a path to `.urdf` or `.xacro`, `-`, `textbook:NAME` or `example:NAME`.

    Raises:
        RobotError: the robot cannot be read, or is not a robot.
        UsageError: there is no such textbook or example robot.
    """
    source = open_source(name, max_bytes=max_bytes, stdin=stdin)
    packages = Packages(source.path, tuple(package_dirs))
    if source.path is not None and is_xacro(source.path):
        expanded = expand(source.path, packages, xacro_arguments or {}, max_bytes)
        source = replace(source, data=expanded)
    document = parse(source.data, name)
    robot = read(document)
    beside = srdf or (find_srdf(source.path, robot.name) if source.path else None)
    semantics = load_srdf(beside, robot) if beside else Semantics()
    return LoadedRobot(robot, canonical_text(document), source, packages, semantics)
