"""N301 to N304: transmissions, Gazebo and ros2_control refer to links and joints of the robot."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from kinetostat.errors import quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.names.uses import Use, robot_uses, told
from kinetostat.lint.subject import Subject, first, name_of, once
from kinetostat.urdf.document import Element

__all__ = ["REFERENCES"]

_ARM = """
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-1" upper="1" effort="10" velocity="1"/>
        </joint>"""
_FINGERS = """
        <link name="hand"/>
        <link name="left"/>
        <link name="right"/>
        <joint name="grip" type="prismatic">
          <parent link="hand"/><child link="left"/>
          <limit lower="0" upper="0.04" effort="10" velocity="1"/>
        </joint>
        <joint name="follow" type="prismatic">
          <parent link="hand"/><child link="right"/>
          <limit lower="0" upper="0.04" effort="10" velocity="1"/>
          <mimic joint="grip"/>
        </joint>"""


def _lost(rule: Rule, subject: Subject) -> Iterator[Finding]:
    """Yield the names that are not there and that a rule tells: that of the worst use, by the order of codes."""
    yield from told(rule, subject, _lost_uses(subject), _known(subject))


@once
def _lost_uses(subject: Subject) -> list[Use]:
    """Return the uses of names that are not there, by the order of codes; three rules ask."""
    known = _known(subject)
    return sorted((use for use in robot_uses(subject) if use.name not in known[use.kind]), key=lambda use: use.code)


@once
def _known(subject: Subject) -> dict[str, Mapping[str, Element]]:
    joints, links = subject.joint_elements, subject.link_elements
    return {"joint": joints, "link or joint": {**links, **joints}}


class LostTransmission(Rule):
    """A transmission drives a joint that is not there, or is fixed.

    gazebo_ros_control and the hardware of ros_control stop at the first such joint: no controller starts, of any joint.
    A name that is not there and that Gazebo or ros2_control blocks use, too, is reported once.
    """

    code = "N301"
    name = "transmission-joint"
    severity = Severity.WARNING
    hint = "correct the name, or remove the transmission"
    bad = Example(f"""{_ARM}
        <transmission name="drive">
          <type>transmission_interface/SimpleTransmission</type>
          <joint name="elbow"/> <!-- N301 -->
        </transmission>""")
    good = Example(f"""{_ARM}
        <transmission name="drive">
          <type>transmission_interface/SimpleTransmission</type>
          <joint name="shoulder"/>
        </transmission>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each joint that a transmission names in vain."""
        yield from _lost(self, subject)
        found = list[Found]()
        for use in robot_uses(subject):
            joint = subject.joint_elements.get(use.name)
            if use.code == self.code and joint is not None and joint.attributes.get("type") == "fixed":
                found.append(Found(use.at, use.name, f"the joint is fixed, line {joint.line}", "name"))
        yield from grouped(self, found, what="joint")


class LostGazebo(Rule):
    """A `<gazebo reference="...">` names neither a link nor a joint.

    Gazebo says nothing and drops the block: the friction, the sensor or the colour in it has no effect.
    """

    code = "N302"
    name = "gazebo-reference"
    severity = Severity.WARNING
    hint = "correct the name, or remove the block"
    bad = Example(f"""{_ARM}
        <gazebo reference="amr"><mu1>0.5</mu1></gazebo> <!-- N302 -->""")
    good = Example(f"""{_ARM}
        <gazebo reference="arm"><mu1>0.5</mu1></gazebo>
        <gazebo><plugin name="p" filename="p.so"/></gazebo>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each reference to what is not there."""
        yield from _lost(self, subject)


class LostControl(Rule):
    """A joint in a `<ros2_control>` block is not in the robot.

    The hardware is loaded all the same; its interface then belongs to no joint that anyone can see, and the joint that
    was meant has none.
    """

    code = "N303"
    name = "ros2-control-joint"
    severity = Severity.WARNING
    hint = "correct the name"
    bad = Example(f"""{_ARM}
        <ros2_control name="arm" type="system">
          <hardware><plugin>mock_components/GenericSystem</plugin></hardware>
          <joint name="sholder"/> <!-- N303 -->
        </ros2_control>""")
    good = Example(f"""{_ARM}
        <ros2_control name="arm" type="system">
          <hardware><plugin>mock_components/GenericSystem</plugin></hardware>
          <joint name="shoulder"/>
        </ros2_control>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each joint that is not there."""
        yield from _lost(self, subject)


class CommandedFollower(Rule):
    """A joint that follows another (`<mimic>`) has a command interface in `<ros2_control>`.

    Since ROS 2 Jazzy the controller manager takes followers from the robot file and refuses to start if one of them
    can be commanded.
    """

    code = "N304"
    name = "follower-commanded"
    severity = Severity.WARNING
    hint = 'remove its command interfaces, or write mimic="false" there'
    bad = Example(f"""{_FINGERS}
        <ros2_control name="hand" type="system">
          <joint name="grip"><command_interface name="position"/></joint>
          <joint name="follow"><command_interface name="position"/></joint> <!-- N304 -->
        </ros2_control>""")
    good = Example(f"""{_FINGERS}
        <ros2_control name="hand" type="system">
          <joint name="grip"><command_interface name="position"/></joint>
          <joint name="follow"><state_interface name="position"/></joint>
        </ros2_control>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each follower that can be commanded."""
        for block in subject.root.all("ros2_control"):
            for element in block.all("joint"):
                mimic = first(subject.joint_elements.get(name_of(element)), "mimic")
                free = element.attributes.get("mimic", "").lower() == "false"
                if mimic is not None and element.all("command_interface") and not free:
                    leader = quote(mimic.attributes.get("joint", ""))
                    yield self.finding(element, f"it follows {leader}, line {mimic.line}, and has a command interface")


REFERENCES: tuple[Rule, ...] = (LostTransmission(), LostGazebo(), LostControl(), CommandedFollower())
