"""What the groups of an SRDF say of limbs: their names, where they begin and end, and which more there are."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, count

from kinetostat.analysis.profile.anatomy import Limb
from kinetostat.analysis.profile.ends import fixed_to, tool
from kinetostat.analysis.profile.grippers import is_jaw, without_gripper
from kinetostat.engines.model import Model
from kinetostat.urdf.description import Joint, JointType, Robot

__all__ = ["named_by_groups"]

_ALIKE = 0.5  # joints that a group and a limb share, of all that either has


@dataclass(frozen=True)
class _Group:
    """A group of an SRDF.

    Attributes:
        name: its name.
        joints: the independent joints that move its links.
        way: its moving joints from the root outwards, without a gripper's at the end, and base and end; None where
            they do not follow one another: a group of two arms.
    """

    name: str
    joints: frozenset[str]
    way: _Way | None


@dataclass(frozen=True)
class _Way:
    base: str
    end: str
    joints: tuple[Joint, ...]


def named_by_groups(model: Model, limbs: Sequence[Limb], others: Collection[str]) -> tuple[Limb, ...]:
    """Return limbs with the names and extents that an SRDF gives them, and the limbs that only it knows.

    A group names the limb that it shares most joints with: at least half of all that either has. A group whose joints
    follow one another gives it base and end, too; one that does not (a slip, a gripper in it) the name alone, and more
    than half are to be shared then: half is what a group of two arms shares with each. What shares no joint with any
    limb, follows one another and has two joints or more is a limb: a waist, a neck.

    Args:
        model: the robot.
        limbs: those that its tree shows.
        others: joints of hands and wheels: a group with one of them is no further limb.
    """
    depths = _depths(model.robot) if model.semantics.groups else {}
    read = (_group(model.robot, depths, name, joints) for name, joints in model.semantics.groups.items())
    groups = [group for group in read if group is not None]
    taken, named = set[str](), list[Limb]()
    for limb in limbs:
        best = _best(limb, [group for group in groups if group.name not in taken])
        if best is not None:
            taken.add(best.name)
        named.append(limb if best is None else _as_group(model.robot, limb, best))
    known = {joint for limb in named for joint in limb.joints} | set(others)
    for group in groups:
        way = group.way
        if way is not None and len(group.joints) > 1 and known.isdisjoint(group.joints) and not _finger(way):
            limb = Limb(group.name, way.base, _end(model.robot, way.end), (), "group")
            joints = tuple(joint.name for joint in model.robot.movable_path(limb.base, limb.frame))
            named.append(replace(limb, joints=joints))
            known |= set(joints)
    return _apart(named)


def _best(limb: Limb, groups: Sequence[_Group]) -> _Group | None:
    """Return the group that is most like a limb; the first of those that are equally so."""
    own = set(limb.joints)
    alike = {group.name: len(own & group.joints) / len(own | group.joints) for group in groups}
    fit = [group for group in groups if alike[group.name] > _ALIKE or (group.way and alike[group.name] == _ALIKE)]
    return max(fit, key=lambda group: (alike[group.name], group.way is not None), default=None)


def _as_group(robot: Robot, limb: Limb, group: _Group) -> Limb:
    """Return a limb with the name of a group, and its extent where the group has one."""
    if group.way is None:
        return replace(limb, name=group.name, found="group")
    base, end = group.way.base, group.way.end
    frame = limb.frame if limb.frame in fixed_to(robot, end) else _end(robot, end)
    joints = tuple(joint.name for joint in robot.movable_path(base, frame))
    return replace(limb, name=group.name, base=base, frame=frame, joints=joints, found="group")


def _end(robot: Robot, link: str) -> str:
    return tool(robot, link) or link


def _finger(way: _Way) -> bool:
    return all(is_jaw(joint) for joint in way.joints)


def _group(robot: Robot, depths: Mapping[str, int], name: str, names: Sequence[str]) -> _Group | None:
    """Return a group as it is to be compared with limbs; None where nothing of it moves."""
    joints = [robot.joint_by_name[joint] for joint in names]
    moving = [joint for joint in joints if joint.type is not JointType.FIXED]
    if not moving:
        return None
    leaders = frozenset(robot.followers[j.name].joint if j.mimic else j.name for j in moving)
    return _Group(name, leaders, _way(robot, depths, set(names), moving))


def _way(robot: Robot, depths: Mapping[str, int], names: set[str], moving: Sequence[Joint]) -> _Way | None:
    """Return moving joints as a way outwards; None where they do not follow one another."""
    driven = {joint.name for joint in moving if joint.mimic is None}
    if not driven:
        return None
    deepest = max((robot.joint_by_name[name].child for name in driven), key=depths.__getitem__)
    up = [joint for joint in robot.to_root(deepest) if joint.type is not JointType.FIXED]
    independent = [joint for joint in up if joint.mimic is None]
    run = [joint for joint in independent[: len(driven)] if joint.type is not JointType.FLOATING]
    if {joint.name for joint in run} != driven:
        return None
    arm = without_gripper(run[::-1])
    base, end = arm[0].parent, arm[-1].child
    while base in robot.parent_joint and _fixed_in(robot.parent_joint[base], names):
        base = robot.parent_joint[base].parent
    while len(arm) == len(run) and len(on := [j for j in robot.child_joints[end] if _fixed_in(j, names)]) == 1:
        end = on[0].child
    return _Way(base, end, arm)


def _depths(robot: Robot) -> dict[str, int]:
    """Return how many joints are above each link."""
    depths = {robot.root: 0}
    for link in (waiting := [robot.root]):
        for joint in robot.child_joints[link]:
            depths[joint.child] = depths[link] + 1
            waiting.append(joint.child)
    return depths


def _fixed_in(joint: Joint, names: set[str]) -> bool:
    return joint.type is JointType.FIXED and joint.name in names


def _apart(limbs: Sequence[Limb]) -> tuple[Limb, ...]:
    """Return limbs with names that differ: one that is taken gives way to the frame."""
    used, apart = set[str](), list[Limb]()
    for limb in limbs:
        names = chain((limb.name, limb.frame), (f"{limb.frame} ({i})" for i in count(2)))
        name = next(name for name in names if name not in used)
        used.add(name)
        apart.append(replace(limb, name=name))
    return tuple(apart)
