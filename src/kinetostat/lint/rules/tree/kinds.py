"""T11x: joints that make no motion, or one that few tools know; names that readers keep; limits of size."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from kinetostat.conventions import FLOATING_BASE_JOINT, WORLD_LINK
from kinetostat.errors import quote
from kinetostat.lint.expressions import has_expression
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import listed
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.tree.shape import GOOD, asked
from kinetostat.lint.spelling import meant
from kinetostat.lint.subject import Subject, first, name_of, vector
from kinetostat.urdf.description import JointType
from kinetostat.urdf.document import Element
from kinetostat.urdf.reader import MAX_DOF, MAX_LINKS
from kinetostat.urdf.tree import MAX_DEPTH

__all__ = ["KINDS"]

_URDF_TYPES = tuple(kind.value for kind in JointType if kind is not JointType.SCREW)
_DRAKE_TYPES = (JointType.SCREW.value, JointType.PLANAR.value)
# What other formats, and people, call the same thing.
_ALIASES = {
    "free": "floating",
    "freeflyer": "floating",
    "hinge": "revolute",
    "linear": "prismatic",
    "rigid": "fixed",
    "rotary": "revolute",
    "rotational": "revolute",
    "slide": "prismatic",
    "slider": "prismatic",
    "translational": "prismatic",
    "weld": "fixed",
}


class NoJoint(Rule):
    """There is no joint.

    Several links without joints are several robots, which readers refuse. A single link may well be meant, such as a
    drone or a thing to grasp; an empty one hardly is.
    """

    code = "T108"
    name = "no-joint"
    severity = Severity.WARNING
    hint = "join the links, if this is to be a robot"
    good = GOOD
    bad = Example("""
        <robot name="example"> <!-- T108 -->
          <link name="base"/>
        </robot>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield a robot without joints."""
        graph = asked(subject)
        if subject.joints or not graph.links:
            return
        if len(graph.links) > 1:
            message = f"{len(graph.links)} links and no joint: {listed(graph.links)}"
            yield self.finding(subject.root, message, severity=Severity.ERROR)
        else:
            empty = not any(link.children for link in subject.links)
            message = f"one {'empty ' * empty}link and no joint: nothing can move"
            yield self.finding(subject.root, message, severity=self.severity if empty else Severity.INFO)


class NothingMoves(Rule):
    """All joints are fixed.

    Questions of motion have no answer. It may be meant, if the robot is one rigid body; then one link would do.
    """

    code = "T109"
    name = "nothing-moves"
    severity = Severity.WARNING
    hint = "give the joints that move another type"
    good = GOOD
    bad = Example("""
        <robot name="example"> <!-- T109 -->
          <link name="base"/>
          <link name="arm"/>
          <joint name="shoulder" type="fixed">
            <parent link="base"/><child link="arm"/>
          </joint>
        </robot>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield a robot of fixed joints alone."""
        asked(subject)
        if subject.joints and all(joint.attributes.get("type") == "fixed" for joint in subject.joints):
            what = (
                "the only joint is fixed" if len(subject.joints) == 1 else f"all {len(subject.joints)} joints are fixed"
            )
            yield self.finding(subject.root, f"{what}: nothing can move")


class UnknownJointType(Rule):
    """A joint has a type that URDF does not know.

    Readers refuse the file, or take the joint as fixed. Types are written in small letters.
    """

    code = "T110"
    name = "unknown-joint-type"
    severity = Severity.ERROR
    hint = f"use one of {', '.join(_URDF_TYPES)}"
    good = GOOD
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="hinge"> <!-- T110 -->
          <parent link="base"/><child link="arm"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each joint of an unknown type."""
        asked(subject)
        for joint in subject.joints:
            kind = joint.attributes.get("type")
            known = _DRAKE_TYPES if joint.tag == "drake:joint" else _URDF_TYPES
            if kind is None or kind in known or has_expression(kind):
                continue
            if joint.tag == "joint" and kind == JointType.SCREW:
                message, hint = "type 'screw' belongs to Drake's dialect", 'write <drake:joint type="screw">'
            else:
                near = _ALIASES.get(kind.strip().lower()) or meant(kind.strip(), known)
                message = f"joint type {quote(kind)} is not known"
                hint = f"did you mean {near}?" if near else f"use one of {', '.join(known)}"
            yield self.finding(joint, message, hint=hint, attribute="type")


class RareJointType(Rule):
    """A floating or planar joint, which many tools read in another way or not at all.

    KDL, and with it robot_state_publisher and MoveIt's solvers, makes both of them fixed; most simulators take a
    floating joint at the root at best. Of a planar joint, Pinocchio and others ignore the axis: its normal is z there.
    """

    code = "T111"
    name = "rare-joint-type"
    severity = Severity.WARNING
    hint = "let the tool place the base, or use a chain of prismatic, revolute and continuous joints"
    good = GOOD
    bad = Example("""
        <link name="world"/>
        <link name="base"/>
        <joint name="base_joint" type="floating"> <!-- T111 -->
          <parent link="world"/><child link="base"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each floating joint, and each planar one: a warning unless it is limited and its normal is z."""
        asked(subject)
        for joint in subject.joints:
            kind = joint.attributes.get("type")
            if kind == JointType.FLOATING:
                yield self.finding(joint, "a floating joint: many tools make it fixed, or refuse it", attribute="type")
            elif kind == JointType.PLANAR and joint.tag == "joint":
                odd = _odd_plane(joint)
                message = f"a planar joint{odd}: many tools make it fixed" + (", or ignore its axis" if odd else "")
                severity = self.severity if odd else Severity.INFO
                yield self.finding(joint, message, severity=severity, attribute="type")


def _odd_plane(joint: Element) -> str:
    """Return what is odd about a planar joint, even among those."""
    axis = vector(first(joint, "axis"), "xyz", 3) if first(joint, "axis") is not None else (1.0, 0.0, 0.0)
    odd = []
    if axis is not None and (axis[0], axis[1]) != (0, 0):
        odd.append("with normal " + " ".join(f"{part:g}" for part in axis))
    if first(joint, "limit") is None:
        odd.append("without limit")
    return " " + " and ".join(odd) if odd else ""


class SharedName(Rule):
    """A link and a joint have the same name.

    URDF allows it. Tools that keep links and joints in one list do not: Gazebo refuses or renames one of them, and
    Pinocchio raises an error when asked for a frame by that name.
    """

    code = "T112"
    name = "shared-name"
    severity = Severity.WARNING
    hint = "rename the joints, for instance to NAME_joint"
    good = GOOD
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="arm" type="continuous"> <!-- T112 -->
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the first joint of a robot that has the name of a link, with the names of all."""
        links = asked(subject).links
        shared = {name_of(joint): joint for joint in reversed(subject.joints) if name_of(joint) in links}
        if shared:
            *_, (name, joint) = shared.items()
            message = f"link at line {links[name].line} has the same name"
            if len(shared) > 1:
                message = f"{len(shared)} joints have the names of links: {listed([*reversed(shared)])}"
            yield self.finding(joint, message, attribute="name")


class ReservedName(Rule):
    """A name that tools keep for the world, or for the joint of a floating base.

    `universe` is Pinocchio's name for the world, `root_joint` that for the joint of a floating base. To Gazebo, Drake
    and MuJoCo a root link called `world` is the world itself, and cannot have a mass.
    """

    code = "T113"
    name = "reserved-name"
    severity = Severity.WARNING
    hint = "rename it"
    good = GOOD
    bad = Example("""
        <link name="base"/>
        <link name="universe"/> <!-- T113 -->
        <joint name="shoulder" type="continuous">
          <parent link="base"/><child link="universe"/>
          <axis xyz="0 0 1"/>
        </joint>""")
    world: ClassVar = "world"

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each link and joint of such a name."""
        graph = asked(subject)
        for name, element in graph.links.items():
            if name == WORLD_LINK:
                yield self.finding(element, "'universe' is Pinocchio's name for the world", attribute="name")
            elif name == self.world and name not in graph.above and element.all("inertial"):
                message = "the link that stands for the world in Gazebo, Drake and MuJoCo has a mass"
                yield self.finding(element, message, hint="remove its <inertial>, or rename it", attribute="name")
        for joint in subject.joints:
            if name_of(joint) == FLOATING_BASE_JOINT:
                message = "'root_joint' is Pinocchio's name for the joint of a floating base"
                yield self.finding(joint, message, attribute="name")
            elif name_of(joint) == WORLD_LINK:
                message = "'universe' is Pinocchio's name for the world, which it counts as a joint"
                yield self.finding(joint, message, attribute="name")


class TooBig(Rule):
    """The robot is bigger than what is read here.

    Deep chains crash readers that call themselves for each link (Pinocchio's at some thousand links, at some hundred in
    a thread), and memory grows with the cube of the degrees of freedom.
    """

    code = "T114"
    name = "too-big"
    severity = Severity.ERROR
    hint = "leave out what you do not ask for"
    good = GOOD
    bad = Example(
        '<robot name="example"> <!-- T114 -->\n<link name="l0"/>\n'
        + "\n".join(
            f'<link name="l{i}"/><joint name="j{i}" type="fixed"><parent link="l{i - 1}"/><child link="l{i}"/></joint>'
            for i in range(1, MAX_DEPTH + 1)
        )
        + "\n</robot>"
    )

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield a robot with too many links, too long a chain, or too many degrees of freedom."""
        graph = asked(subject)
        deepest = max(graph.depth.values(), default=0)
        types = [joint.attributes.get("type", "") for joint in subject.joints]
        freedoms = sum(JointType(kind).nv for kind in types if kind in _URDF_TYPES or kind == JointType.SCREW)
        for count, most, what in (
            (len(subject.links), MAX_LINKS, "the robot has {} links"),
            (deepest, MAX_DEPTH, "a chain is {} links deep"),
            (freedoms, MAX_DOF, "the joints have {} degrees of freedom"),
        ):
            if count > most:
                yield self.finding(subject.root, f"{what.format(count)}; at most {most} are read")


KINDS: tuple[Rule, ...] = (
    NoJoint(),
    NothingMoves(),
    UnknownJointType(),
    RareJointType(),
    SharedName(),
    ReservedName(),
    TooBig(),
)
