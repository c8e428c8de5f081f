"""What the tree of a robot shows: limbs, the hands that they carry, wheels, and lone joints."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from kinetostat.analysis.profile.anatomy import Limb
from kinetostat.analysis.profile.ends import moving_branches, named_end, tool
from kinetostat.analysis.profile.grippers import without_gripper
from kinetostat.analysis.profile.runs import Run, carries_hand, runs
from kinetostat.analysis.profile.wheels import spins
from kinetostat.engines.model import Model
from kinetostat.urdf.description import Joint, Robot

__all__ = ["Found", "Hand", "found"]

_GRASPS = re.compile(r"hand|palm|thumb|finger|grip|grasp|jaw|claw", re.IGNORECASE)
_JAWS = 2  # more of them make a hand
_GRIPPER = 2  # so many joints beyond a tool's frame are a gripper's


@dataclass(frozen=True)
class Hand:
    """The fingers or jaws that a limb carries.

    Attributes:
        kind: what it is by its names: a hand, a gripper, or neither: the eyes of a head.
        at: the frame of the limb.
        fingers: how many there are.
        joints: the independent ones among their joints.
    """

    kind: Literal["hand", "gripper", ""]
    at: str
    fingers: int
    joints: tuple[str, ...]


@dataclass(frozen=True)
class Found:
    """What a tree shows.

    Attributes:
        limbs: in the order of the file.
        hands: what they carry.
        wheels: frames of wheels, casters and rotors, and the joints that move them.
        lone: joints that are a limb of one joint beside longer ones.
    """

    limbs: tuple[Limb, ...]
    hands: tuple[Hand, ...]
    wheels: dict[str, tuple[str, ...]]
    lone: tuple[str, ...]


def found(model: Model) -> Found:
    """Return what the tree of a robot shows."""
    robot = model.robot
    ahead = moving_branches(robot)
    carriers = list(_carriers(runs(robot)))
    short = all(run.most <= 1 for run in carriers)
    limbs, hands = dict[str, Limb](), list[Hand]()
    for run in sorted(carriers, key=lambda run: run.count == 0):  # who leads before who follows
        arm = _without_tool_beyond(robot, without_gripper(run.joints))
        frame = named_end(robot, arm[-1].child, ahead)
        limbs[frame] = _limb(robot, run.seed if short else run.base, frame)
        hands += _hands(run, len(arm), frame)
    limbs = _driven(limbs)
    wheels = {frame for frame in limbs if len(limbs) > 1 and spins(model, frame)}  # one alone is what there is
    rest = [limb for frame, limb in limbs.items() if frame not in wheels]
    # A finger that one motor bends is no lone joint: its followers move, too.
    long = [limb for limb in rest if len(robot.moving_path(limb.base, limb.frame)) > 1] or rest
    kept = {limb.frame for limb in long}
    return Found(
        tuple(long),
        tuple(hand for hand in hands if hand.at in kept),
        {frame: limbs[frame].joints for frame in limbs if frame in wheels},
        tuple(limb.joints[0] for limb in rest if limb.frame not in kept),
    )


def _carriers(trees: Iterable[Run]) -> Iterable[Run]:
    """Yield the runs that are limbs: at the end of which there is nothing more, or a hand."""
    for tree in trees:
        waiting = [tree]
        while waiting:
            run = waiting.pop()
            waiting += reversed(run.beside)
            if run.joints and (not run.branches or carries_hand(run)):
                yield run
            else:
                waiting += reversed(run.branches)


def _without_tool_beyond(robot: Robot, joints: Sequence[Joint]) -> Sequence[Joint]:
    """Return a chain without the last two joints or less, where a frame that is called a tool is before them."""
    if tool(robot, joints[-1].child) is None:
        for count in range(len(joints) - 1, max(0, len(joints) - 1 - _GRIPPER), -1):
            end = tool(robot, joints[count - 1].child)
            if end is not None and not robot.child_joints[end]:
                return joints[:count]
    return joints


def _limb(robot: Robot, base: str, frame: str) -> Limb:
    joints = tuple(joint.name for joint in robot.movable_path(base, frame))
    return Limb(frame, base, frame, joints, "tip")


def _hands(run: Run, count: int, frame: str) -> Iterable[Hand]:
    """Yield what is beyond the arm of a run, its first joints."""
    jaws = run.joints[count:]  # by their names
    ways = [[joint for below in branch.with_all_below() for joint in below.joints] for branch in run.branches]
    beyond = [*jaws, *(joint for way in ways for joint in way)]
    if beyond:
        joints = tuple(joint.name for joint in beyond if joint.mimic is None)
        called = any(_GRASPS.search(name) for joint in beyond for name in (frame, joint.name, joint.child))
        fingers = len([way for way in ways if len(way) > 1]) or len(ways)
        many = fingers > _JAWS and len(joints) > 1
        yield Hand(("hand" if many else "gripper") if called else "", frame, fingers, joints)


def _driven(limbs: dict[str, Limb]) -> dict[str, Limb]:
    """Return the limbs without those whose joints all drive another one too: jaws that only follow."""
    kept, driven = dict[str, Limb](), dict[str, set[str]]()
    for frame in sorted(limbs, key=lambda frame: -len(limbs[frame].joints)):
        joints = limbs[frame].joints
        if not set.intersection(*(driven.setdefault(joint, set()) for joint in joints)):
            kept[frame] = limbs[frame]
            for joint in joints:
                driven[joint].add(frame)
    return kept
