"""X2xx: names, versions, and what depends on the version."""

from __future__ import annotations

import re
from collections.abc import Iterator

from kinetostat.errors import quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.schema import parts
from kinetostat.lint.subject import Subject
from kinetostat.urdf.reader import MAX_NAME

__all__ = ["HEADS"]

_BASE = """
    <robot name="example">
      <link name="base"/>
    </robot>"""


class RobotName(Rule):
    """The robot has no name.

    `<robot>` must have one: urdfdom, and with it every ROS tool, Gazebo and Pinocchio, refuses a file without it, and
    so do Drake, PyBullet and yourdfpy. An empty one is read, though not by Drake, but an SRDF cannot refer to it.
    """

    code = "X201"
    name = "robot-name"
    severity = Severity.ERROR
    hint = 'write <robot name="...">'
    bad = Example("""
        <robot> <!-- X201 -->
          <link name="base"/>
        </robot>""")
    good = Example(_BASE)

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield a robot without a name, or with an empty one."""
        root = subject.root
        if root.tag != "robot":
            return
        if "name" not in root.attributes:
            yield self.finding(root, "the robot has no name")
        elif not root.attributes["name"].strip():
            yield self.finding(root, "the robot's name is empty", severity=Severity.WARNING, attribute="name")


class Version(Rule):
    """The version of the format is not one that all readers know.

    urdfdom, and with it ROS and Pinocchio, takes 1.0; since its release 5 also 1.1 and 1.2, which add quaternions,
    capsules and limits of acceleration. It refuses any other, even "1", while MuJoCo, Drake, PyBullet and yourdfpy do
    not look at it. Without the attribute a file counts as 1.0.
    """

    code = "X202"
    name = "version"
    severity = Severity.WARNING
    hint = 'write version="1.0", or nothing'
    bad = Example("""
        <robot name="example" version="1"> <!-- X202 -->
          <link name="base"/>
        </robot>""")
    good = Example(_BASE.replace(">", ' version="1.0">', 1))

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield a version that is none, or that some readers refuse."""
        root = subject.root
        text = root.attributes.get("version")
        if root.tag != "robot" or text is None:
            return
        shown = f"version {quote(text)}"
        match = re.fullmatch(r"\s*([0-9]{1,3})(?:\.([0-9]{1,3}))?\s*", text)
        severity, hint = self.severity, None
        if match is None:
            severity, message = Severity.ERROR, f"{shown} is not a version"
        elif (number := (int(match[1]), int(match[2] or 0))) > (1, 2) or number < (1, 0):
            severity, message = Severity.ERROR, f"{shown} of URDF does not exist: there are 1.0, 1.1 and 1.2"
        elif match[2] is None:
            message = f"{shown} is not of the form 1.0: urdfdom refuses it"
        elif number > (1, 0):
            message = f"{shown}: urdfdom before its release 5 refuses it"
            hint = 'write version="1.0" unless the file needs more'
        else:
            return
        yield self.finding(root, message, severity=severity, hint=hint, attribute="version")


class UnreadableName(Rule):
    """A name holds control characters, or is longer than any tool takes.

    Control characters (escapes of a terminal among them) are seen by no reader of the file, but reach every log and
    screen that shows the name.
    """

    code = "X208"
    name = "unreadable-name"
    severity = Severity.ERROR
    hint = "rename it"
    bad = Example("""
        <link name="base&#x9b;"/> <!-- X208 -->""")
    good = Example("""
        <link name="bäse_1"/>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each link and joint with such a name."""
        for element in (*subject.links, *subject.joints):
            name = element.attributes.get("name", "")
            if len(name) > MAX_NAME:
                message = f"a name of {len(name)} characters; at most {MAX_NAME} are read"
                yield self.finding(element, message, attribute="name")
            elif not name.isprintable() and any(ord(c) in range(0x7F, 0xA0) for c in name):
                yield self.finding(element, "the name holds a control character", attribute="name")


class QuaternionNotRead(Rule):
    """A quaternion stands where no reader takes it: without version 1.1, or beside rpy.

    `quat_xyzw` came with URDF 1.1. A reader that does not know it reads the placement without its rotation, and says
    nothing; with both, each reader chooses one.
    """

    code = "X209"
    name = "quaternion-not-read"
    severity = Severity.ERROR
    hint = "write rpy, which every reader takes"
    bad = Example("""
        <link name="base"/>
        <link name="tool"/>
        <joint name="flange" type="fixed">
          <parent link="base"/><child link="tool"/>
          <origin xyz="0 0 0.1" quat_xyzw="0 0 1 0"/> <!-- X209 -->
        </joint>""")
    good = Example("""
        <robot name="example" version="1.1">
          <link name="base"/>
          <link name="tool"/>
          <joint name="flange" type="fixed">
            <parent link="base"/><child link="tool"/>
            <origin xyz="0 0 0.1" quat_xyzw="0 0 1 0"/>
          </joint>
        </robot>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each origin with a quaternion that is not read, or not by all."""
        newer = re.fullmatch(r"\s*(1\.0*[1-9][0-9]*|[2-9].*)\s*", subject.root.attributes.get("version", "1.0"))
        for element, _ in parts(subject):
            if element.tag != "origin" or "quat_xyzw" not in element.attributes:
                continue
            if "rpy" in element.attributes:
                yield self.finding(element, "both rpy and quat_xyzw are given", hint="keep one of them")
            elif newer is None:
                message = "quat_xyzw is part of URDF 1.1, and the file is 1.0"
                hint = 'write <robot version="1.1">, or rpy'
                yield self.finding(element, message, hint=hint, attribute="quat_xyzw")


HEADS: tuple[Rule, ...] = (RobotName(), Version(), UnreadableName(), QuaternionNotRead())
