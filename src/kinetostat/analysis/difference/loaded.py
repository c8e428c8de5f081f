"""Which joints' gravity torques can have changed: those that carry what changed, and those that it turns otherwise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from kinetostat.analysis.difference.change import Change
from kinetostat.analysis.difference.matching import Matching
from kinetostat.analysis.difference.placements import outward
from kinetostat.engines.model import Model
from kinetostat.urdf.description import JointType, Robot

__all__ = ["loaded_joints"]

_SHIFTS = frozenset({"position"})  # what is beyond it keeps its direction in gravity
_TURNS = frozenset(
    {"type", "parent", "child", "orientation", "axis", "pitch", "lower", "upper"}
    | {"mimic", "mimic multiplier", "mimic offset"}
)
_MASSES = frozenset({"mass", "centre of mass"})


def loaded_joints(a: Model, b: Model, matching: Matching, changed: Sequence[Change]) -> list[str]:
    """Return the joints (by A's names) whose worst gravity torque, or its share of the effort limit, may have changed.

    A mass loads the joints above it. What turns a joint otherwise (its axis, its limits) also turns what hangs on it
    in gravity: the joints below it, too. Only joints that both robots have, with one coordinate each.

    Args:
        a: the robot before.
        b: the robot after.
        matching: which joint and link is which.
        changed: what changed.
    """
    found = _touched(a.robot, [change for change in changed if change.kind != "added"], {}, {})
    come = [change for change in changed if change.kind != "removed"]
    theirs = _touched(b.robot, come, matching.joints, matching.links)
    found |= {matching.joints_back[name] for name in theirs if name in matching.joints_back}
    free = {joint.name for joint in b.robot.independent if joint.type.nq == 1}
    return [
        joint.name
        for joint in a.robot.independent
        if joint.type.nq == 1 and joint.name in found and matching.joints.get(joint.name) in free
    ]


@dataclass(frozen=True)
class _Marks:
    """Links from which all joints above are loaded, joints with all below them, and joints that are meant alone."""

    above: set[str] = field(default_factory=set)
    below: set[str] = field(default_factory=set)
    alone: set[str] = field(default_factory=set)


def _touched(robot: Robot, changed: Sequence[Change], joints: Mapping[str, str], links: Mapping[str, str]) -> set[str]:
    """Return the independent joints of a robot that changes touch; their names are A's, to be translated to its own."""
    marks = _Marks()
    for change in changed:
        if change.element == "robot":
            return {joint.name for joint in robot.independent}
        named = joints if change.element == "joint" else links
        name = change.name if change.kind == "added" else named.get(change.name, change.name)
        if change.element == "link" and (change.kind in ("added", "removed") or change.attribute in _MASSES):
            marks.above.add(name)
        elif change.element == "joint" and name in robot.joint_by_name:
            _mark(marks, robot, change, name)
    return _spread(robot, marks)


def _mark(marks: _Marks, robot: Robot, change: Change, name: str) -> None:
    if change.attribute == "effort":
        marks.alone.add(name)
    if change.attribute in _SHIFTS:
        marks.above.add(robot.joint_by_name[name].child)
    if change.attribute in _TURNS or change.kind in ("added", "removed"):
        marks.below.add(name)


def _spread(robot: Robot, marks: _Marks) -> set[str]:
    """Return the independent joints that marks reach: a follower moves as its leader does, and loads it."""
    leaders = {robot.followers[name].joint if name in robot.followers else name for name in marks.below}
    turned = leaders | marks.below | {name for name, law in robot.followers.items() if law.joint in leaders}
    above = marks.above | {robot.joint_by_name[name].child for name in turned}
    order, below, found = list(outward(robot)), set[str](), set(marks.alone)
    for joint in order:
        if joint.name in turned or joint.parent in below:
            below.add(joint.child)
            found.add(joint.name)
    for joint in reversed(order):
        if joint.child in above:
            above.add(joint.parent)
            found.add(joint.name)
    found = {robot.followers[name].joint if name in robot.followers else name for name in found}
    return {name for name in found if robot.joint_by_name[name].type is not JointType.FIXED}
