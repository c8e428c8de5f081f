"""Shell completion of robots, frames, joints and configurations of the robot at hand. It never fails aloud."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from kinetostat.urdf.loading import LoadedRobot

__all__ = ["configurations", "frames", "joints", "robots"]


def robots(incomplete: str) -> list[str]:
    """Complete `textbook:` and `example:` names, or files."""
    from pathlib import Path

    from kinetostat.urdf.files import example_robots, short_names, textbook_robots

    named = [f"textbook:{name}" for name in textbook_robots()] + [
        f"example:{name}" for name in short_names(example_robots())
    ]
    folder, _, _ = incomplete.rpartition("/")
    try:
        files = [path for path in Path(folder or ".").iterdir() if path.is_dir() or path.suffix in (".urdf", ".xacro")]
    except OSError:
        files = []
    shown = [f"{path}/" if path.is_dir() else str(path) for path in files]
    return [name for name in named + shown if name.startswith(incomplete)]


def frames(ctx: typer.Context, incomplete: str) -> list[str]:
    """Complete names of links."""
    return [name for loaded in _loaded(ctx) for name in loaded.robot.link_by_name if name.startswith(incomplete)]


def joints(ctx: typer.Context, incomplete: str) -> list[str]:
    """Complete a comma-separated list of independent joints, or path, or all."""
    before, comma, last = incomplete.rpartition(",")
    words = [] if comma else ["path", "all"]
    for loaded in _loaded(ctx):
        words += [joint.name for joint in loaded.robot.independent]
    return [before + comma + word for word in words if word.startswith(last)]


def configurations(ctx: typer.Context, incomplete: str) -> list[str]:
    """Complete zero, mid, random:, SRDF states, and joint names for joint=value."""
    before, comma, last = incomplete.rpartition(",")
    words = [] if comma else ["zero", "mid", "random:"]
    for loaded in _loaded(ctx):
        words += [] if comma else loaded.semantics.state_names()
        words += [f"{name}=" for joint in loaded.robot.independent for name in joint.position_names]
    return [before + comma + word for word in words if word.startswith(last)]


def _loaded(ctx: typer.Context) -> Iterator[LoadedRobot]:
    """Yield the robot named on the command line, if there is one and it can be read."""
    from kinetostat.errors import KinetostatError
    from kinetostat.urdf.loading import load_robot

    # While an option still waits for its value, Typer has not told arguments from options yet: they are in ctx.args.
    for word in [ctx.params.get("source"), *ctx.args]:
        if word and not word.startswith("-"):
            try:
                yield load_robot(word)
            except KinetostatError:
                continue
            return
