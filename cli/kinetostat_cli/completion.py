"""Shell completion of robots, frames, joints and configurations of the robot at hand. It never fails aloud."""

from __future__ import annotations

import contextlib
import io
import os
from collections.abc import Callable, Iterable, Iterator, MutableMapping
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from kinetostat.urdf.loading import LoadedRobot

__all__ = ["answer_bash", "configurations", "frames", "joints", "robots", "sequences"]


def answer_bash(run: Callable[[], int]) -> int:
    """Complete for bash, which ends words at colons.

    `example:panda` comes as three words, and only what follows its colon may be offered.
    """
    typed = _rejoin_colons(os.environ)
    offered = io.StringIO()
    try:
        with contextlib.redirect_stdout(offered):
            return run()
    finally:  # Typer ends a completion by SystemExit
        for line in offered.getvalue().splitlines():
            print(line.removeprefix(typed))


def _rejoin_colons(environment: MutableMapping[str, str]) -> str:
    """Join `example : panda` in COMP_WORDS to one word; return what bash holds for typed of the current one."""
    words, current = environment.get("COMP_WORDS", "").split(), int(environment.get("COMP_CWORD", "0"))
    joined: list[str] = []
    position, typed = current, ""
    for i, word in enumerate(words):
        if joined and (word == ":" or words[i - 1] == ":"):
            joined[-1] += word
            position -= i <= current
            if i == current:
                typed = joined[-1][: joined[-1].rindex(":") + 1]
        else:
            joined.append(word)
    environment["COMP_WORDS"], environment["COMP_CWORD"] = " ".join(joined), str(position)
    return typed


def _matching(words: Iterable[str], incomplete: str) -> list[str]:
    return [word for word in words if word.startswith(incomplete)]


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
    return _matching(named + shown, incomplete)


def frames(ctx: typer.Context, incomplete: str) -> list[str]:
    """Complete names of links."""
    return _matching((name for loaded in _loaded(ctx) for name in loaded.robot.link_by_name), incomplete)


def joints(ctx: typer.Context, incomplete: str) -> list[str]:
    """Complete a comma-separated list of independent joints, or path, or all."""
    before, comma, _ = incomplete.rpartition(",")
    words = [] if comma else ["path", "all"]
    for loaded in _loaded(ctx):
        words += [joint.name for joint in loaded.robot.independent]
    return _matching((before + comma + word for word in words), incomplete)


def sequences(incomplete: str) -> list[str]:
    """Complete names of Euler sequences."""
    from kinetostat.analysis.euler import sequence_names

    return _matching(sequence_names(), incomplete)


def configurations(ctx: typer.Context, incomplete: str) -> list[str]:
    """Complete zero, mid, random:, SRDF states, and joint names for joint=value."""
    before, comma, _ = incomplete.rpartition(",")
    words = [] if comma else ["zero", "mid", "random:"]
    for loaded in _loaded(ctx):
        words += [] if comma else loaded.semantics.state_names()
        words += [f"{name}=" for name in loaded.robot.position_names]
    return _matching((before + comma + word for word in words), incomplete)


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
