"""A first `kinetostat.toml`, with comments."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator, Sequence

import msgspec

from kinetostat.engines.model import Model
from kinetostat.policy.draft.chains import main_frames
from kinetostat.policy.draft.drafting import proposals
from kinetostat.policy.draft.toml import comment, table, value
from kinetostat.policy.expectations import Expectation
from kinetostat.policy.kinds.efforts import Holds
from kinetostat.policy.kinds.poses import Golden, Reaches
from kinetostat.policy.table import RobotSettings

__all__ = ["drafted"]

_HEAD = """\
# What `kinetostat check` checks, and what robots are expected to do.
# Every expectation was true when this file was written, with some margin:
# `kinetostat check` says which one is not any more. Change the numbers to
# what the users of the robots rely on. `kinetostat explain holds` tells what an
# expectation means, and its keys; `kinetostat rules` lists all kinds.
# Editors that read TOML schemas (Taplo, Even Better TOML): write the schema by
# `kinetostat init --schema -o kinetostat.schema.json`, and as line 1 of this file
# "#:schema ./kinetostat.schema.json".

[check]
fail-on = "error"  # or "warning", "info": a finding so bad fails a file
# select = ["J", "I"]  # rules that are asked, by code or family; else all
# ignore = ["N101"]  # rules that are not ('kinetostat rules' lists them)
# exclude = ["old/*.urdf"]  # files that are not checked
# baseline = "baseline.json"  # findings that are known
"""


def drafted(robots: Sequence[tuple[Model, RobotSettings]]) -> str:
    """Return the text of a settings file for robots: what is true of them now, as expectations with some margin.

    Args:
        robots: each as read, and how it is read, as the settings file is to say it.
    """
    lines = _HEAD.splitlines()
    for model, robot in robots:
        lines += ["", *_robot(robot)]
        for proposal in proposals(model):
            lines += ["", comment(proposal.remark)] if proposal.remark else [""]
            if proposal.expectation is not None:
                lines += table(proposal.expectation)
        lines += [*_golden(model, robot), *_examples(model)]
    return "\n".join(lines) + "\n"


def _robot(robot: RobotSettings) -> Iterator[str]:
    yield "[[robots]]"
    for part in msgspec.structs.fields(robot):
        given = getattr(robot, part.name)
        if given and part.encode_name not in ("expect", "chains"):
            yield f"{part.encode_name} = {value(given)}"


def _golden(model: Model, robot: RobotSettings) -> Iterator[str]:
    """Yield golden placements of the main frames, commented out: each needs a file that a command writes."""
    frames = main_frames(model.robot)
    if not frames:
        return
    yield ""
    yield comment("A golden placement notices every change of where a frame is, to 1e-9 m and rad, at a random")
    yield comment("configuration. Run a command in the folder of this file, and take the # off its expectation:")
    for frame in frames:
        file = f"{_stem(model.robot.name)}-{_stem(frame)}.json"
        yield from _commented(_placing(robot, frame, file), Golden(file=file))


def _placing(robot: RobotSettings, frame: str, file: str) -> str:
    """Return the command that stores the placement of a frame."""
    words = ["kinetostat", "fk", robot.path, "-f", frame, "-q", "random:0"]
    for folder in robot.package_dirs:
        words += ["--package-dir", folder]
    for name, given in robot.xacro_args.items():
        words += ["--xacro-arg", f"{name}:={given}"]
    return shlex.join([*words, "-F", "json", "-o", file])


def _stem(name: str) -> str:
    """Return a name as part of the name of a file."""
    return re.sub(r"[^A-Za-z0-9_.]+", "_", name)[:40].strip("._") or "robot"


def _examples(model: Model) -> Iterator[str]:
    """Yield what only the robot's users know, commented out."""
    frame = (*main_frames(model.robot), model.robot.root)[0]
    yield from ("", "# Expectations that only you can write, for instance:")
    yield from _commented("", Holds(frame=frame, payload=1.0, at="mid", at_most_percent=80.0))
    yield from _commented("", Reaches(frame=frame, poses=((0.5, 0.0, 0.5),)))


def _commented(remark: str, expectation: Expectation) -> Iterator[str]:
    yield "#"
    yield from ([comment(remark)] if remark else [])
    yield from (comment(line) for line in table(expectation))
