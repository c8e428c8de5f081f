"""K101: joints that add nothing to what those before them can do, at almost every configuration."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from kinetostat.conventions import Array
from kinetostat.errors import quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Needs, Rule
from kinetostat.lint.rules.kinetostatics.limbs import Structure, rank, structure
from kinetostat.lint.subject import Subject
from kinetostat.screw import se3
from kinetostat.urdf.description import Joint, JointType

__all__ = ["COMPLIANT", "DependentJoints"]

_PARALLEL = 1e-3  # rad: axes that are not the same after this are not meant to be
_SAME_LINE = 1e-4  # of the robot's reach
_TURNING = (JointType.REVOLUTE, JointType.CONTINUOUS)
# A motor and the spring after it turn about one axis, and are two joints all the same.
COMPLIANT = re.compile(r"spring|elastic|flex|compl|passive|suspension|deflect|rotor|motor", re.IGNORECASE)


class DependentJoints(Rule):
    """A joint does only what the joints before it can do already.

    Two joints in a row about one axis, or two slides in a row along one direction, move the links beyond them in one
    way, not in two: the chain has a freedom less than its joints promise, an inverse has no unique answer anywhere, and
    a solver that does not expect it divides by zero. Mostly an axis or an origin was copied and not changed. Arms that
    have more parallel joints than a plane needs are meant so, and nothing is said of them.
    """

    code = "K101"
    name = "dependent-joints"
    severity = Severity.WARNING
    hint = "turn or move the axis of one of the two, or make it a fixed joint; or say in a comment that it is meant"
    needs = Needs.MODEL
    bad = Example("""
        <link name="base"/>
        <link name="shoulder"/>
        <link name="arm"/>
        <joint name="pan" type="revolute">
          <parent link="base"/><child link="shoulder"/>
          <axis xyz="0 0 1"/>
          <limit lower="-3" upper="3" effort="10" velocity="1"/>
        </joint>
        <joint name="lift" type="revolute"> <!-- K101 -->
          <parent link="shoulder"/><child link="arm"/>
          <origin xyz="0 0 0.4"/>
          <axis xyz="0 0 1"/>
          <limit lower="-1" upper="1" effort="10" velocity="1"/>
        </joint>""")
    good = Example("""
        <link name="base"/>
        <link name="shoulder"/>
        <link name="arm"/>
        <joint name="pan" type="revolute">
          <parent link="base"/><child link="shoulder"/>
          <axis xyz="0 0 1"/>
          <limit lower="-3" upper="3" effort="10" velocity="1"/>
        </joint>
        <joint name="lift" type="revolute">
          <parent link="shoulder"/><child link="arm"/>
          <origin xyz="0 0 0.4"/>
          <axis xyz="0 1 0"/>
          <limit lower="-1" upper="1" effort="10" velocity="1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each joint that repeats the one before it, slides in a plane of two others, and chains short of six."""
        found, told = structure(subject), set[str]()
        for name, before in found.before.items():
            joint = found.robot.joint_by_name[name]
            if before is not None and _alone(joint) and _alone(before):
                message = _repeats(found, before, joint)
                if message:
                    told.add(name)
                    severity = Severity.INFO if _meant(found, before, joint) else None
                    yield self.finding(subject.joint_elements[name], message, severity=severity)
        for third in _third_slides(found, told):
            told.add(third.name)
            message = "it slides in the plane in which the two joints before it slide"
            yield self.finding(subject.joint_elements[third.name], message, severity=Severity.INFO)
        yield from self._short(subject, found, told)

    def _short(self, subject: Subject, found: Structure, told: set[str]) -> Iterator[Finding]:
        """Yield the chains of six joints or more whose tip does not move in six directions, if nothing has said why."""
        for limb, matrices in zip(found.limbs, found.jacobians, strict=True):
            chain = found.chain(limb)
            if len(limb.independent) < 6 or any(joint.name in told for joint in chain):
                continue
            dimension = rank(matrices, found.robot.velocity_columns(chain))
            if 3 < dimension < 6:  # 3 is a plane, or turns about a point: meant
                message = (
                    f"{len(chain)} joints move {quote(limb.tip)} in {dimension} directions only, at any configuration"
                )
                hint = "two wrist axes, or four of one direction, make the others idle: is one of them turned wrong?"
                element = subject.joint_elements[limb.joints[-1].name]
                yield self.finding(element, message, hint=hint, severity=Severity.INFO)


def _alone(joint: Joint) -> bool:
    """Return whether a joint moves by itself, in one way."""
    return joint.mimic is None and joint.type.nv == 1


def _between(found: Structure, before: Joint, joint: Joint) -> Array:
    """Return the placement of a joint in the frame that the one before it moves: only fixed joints are between."""
    placed: Array = se3.inverse(found.zero[before.child]) @ found.zero[joint.child]
    return placed


def _repeats(found: Structure, before: Joint, joint: Joint) -> str:
    """Return how a joint repeats the one before it; empty if it does not."""
    turns = [each.type in _TURNING for each in (before, joint)]
    slides = [each.type is JointType.PRISMATIC for each in (before, joint)]
    if not (all(turns) or all(slides)):
        return ""
    place = _between(found, before, joint)
    first, second = np.array(before.axis), place[:3, :3] @ np.array(joint.axis)
    if np.linalg.norm(np.cross(first, second)) > _PARALLEL:
        return ""
    if all(slides):
        return f"it slides along the same direction as {quote(before.name)} just before it"
    distance = float(np.linalg.norm(np.cross(place[:3, 3], first)))
    if distance > _SAME_LINE * max(found.robot.reach, 1e-9):
        return ""
    return f"it turns about the same axis as {quote(before.name)} just before it"


def _meant(found: Structure, before: Joint, joint: Joint) -> bool:
    """Return whether two joints of one axis are known practice: a spring after a motor, a stage, a virtual base."""
    if COMPLIANT.search(before.name) or COMPLIANT.search(joint.name):
        return True
    if sum(above is before for above in found.before.values()) > 1:  # a neck on a trunk that carries arms, too
        return True
    if joint.type is JointType.PRISMATIC:  # stages of a telescope, a coarse and a fine drive
        return True
    link, above = found.robot.link_by_name[before.parent], found.before[before.name]
    # The yaw of a mobile base, after its slides on links without mass, below a waist that turns about the same axis.
    return above is not None and (link.inertial is None or link.inertial.mass == 0)


def _third_slides(found: Structure, told: set[str]) -> Iterator[Joint]:
    """Yield slides that lie in the plane of the two slides just before them."""
    for name, before in found.before.items():
        joint = found.robot.joint_by_name[name]
        first = found.before[before.name] if before is not None else None
        three = (first, before, joint)
        if any(each is None or not _alone(each) or each.type is not JointType.PRISMATIC for each in three):
            continue
        assert first is not None
        assert before is not None
        if name in told or before.name in told:
            continue
        upper, lower = _between(found, first, before)[:3, :3], _between(found, before, joint)[:3, :3]
        axes = [np.array(first.axis), upper @ np.array(before.axis), upper @ lower @ np.array(joint.axis)]
        if abs(np.linalg.det(np.array(axes))) < _PARALLEL:
            yield joint
