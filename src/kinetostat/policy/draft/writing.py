"""A first `kinetostat.toml`, with comments."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from kinetostat.engines.model import Model
from kinetostat.errors import printable
from kinetostat.policy.draft.chains import main_frames
from kinetostat.policy.draft.drafting import proposals
from kinetostat.policy.draft.toml import comment, table, value
from kinetostat.policy.kinds.efforts import Holds
from kinetostat.policy.kinds.poses import Golden, Reaches
from kinetostat.policy.table import RobotSettings

__all__ = ["drafted"]

_HEAD = """\
# What `kinetostat check` checks, and what this robot is expected to do.
# Every expectation was true when this file was written, with some margin:
# `kinetostat check` says which one is not any more. Change the numbers to
# what the users of the robot rely on.

[check]
fail-on = "error"  # or "warning", "info": a finding so bad fails a file
# select = ["J", "I"]  # rules that are asked, by code or family; else all
# ignore = ["N101"]  # rules that are not ('kinetostat rules' lists them)
# exclude = ["old/*.urdf"]  # files that are not checked
# baseline = "baseline.json"  # findings that are known
"""


def drafted(model: Model, robot: RobotSettings) -> str:
    """Return the text of a settings file for a robot: what is true of it now, as expectations with some margin.

    Args:
        model: the robot as read.
        robot: how it is read, as the settings file is to say it.
    """
    lines = [*_HEAD.splitlines(), "", *_robot(robot)]
    for proposal in proposals(model):
        lines += ["", comment(proposal.remark)] if proposal.remark else [""]
        if proposal.expectation is not None:
            lines += table(proposal.expectation)
    return "\n".join([*lines, *_examples(model, robot.path)]) + "\n"


def _robot(robot: RobotSettings) -> Iterator[str]:
    yield "[[robots]]"
    for part in msgspec.structs.fields(robot):
        given = getattr(robot, part.name)
        if given and part.encode_name != "expect":
            yield f"{part.encode_name} = {value(given)}"


def _examples(model: Model, source: str) -> Iterator[str]:
    """Yield what only the robot's users know, commented out."""
    frame = (*main_frames(model.robot), model.robot.root)[0]
    yield from ("", "# Expectations that only you can write, for instance:")
    written = f"kinetostat fk {printable(source)} -f {printable(frame)} -q mid -F json -o golden.json"
    yield from _commented("", table(Holds(frame=frame, payload=1.0, at="mid", at_most_percent=80.0)))
    yield from _commented("", table(Reaches(frame=frame, poses=((0.5, 0.0, 0.5),))))
    yield from _commented(f"golden.json is written by: {written}", table(Golden(file="golden.json", tolerance=1e-6)))


def _commented(remark: str, lines: list[str]) -> Iterator[str]:
    yield "#"
    yield from ([comment(remark)] if remark else [])
    yield from (comment(line) for line in lines)
