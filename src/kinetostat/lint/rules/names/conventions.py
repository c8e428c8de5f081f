"""N201 to N205: names that ROS users expect, of the base, the flange, the tool and the world, and prefixes."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from kinetostat.analysis.profile.grippers import without_gripper
from kinetostat.errors import quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import also
from kinetostat.lint.rule import Example, Needs, Rule
from kinetostat.lint.subject import Subject, end_of, name_of
from kinetostat.urdf.description import JointType
from kinetostat.urdf.document import Element

__all__ = ["CONVENTIONS"]

_ARM = (5, 7)  # joints of a serial arm of industry: axes of its one chain
_SHARE = 0.8  # of names that a prefix has to be on, to be the robot's
_FAMILY = 5  # names, at least
_PREFIX = re.compile(r"(.*?[^_/.\-])[_/.\-]+")  # up to the first separator


def _is_called(name: str, word: str) -> bool:
    """Return whether a name is a word, or that word after a prefix."""
    return name == word or name.endswith((f"_{word}", f"/{word}", f"-{word}", f".{word}"))


class NoBaseLink(Rule):
    """No link is called base_link.

    REP 105, 120 and 199 give that name to the frame of the robot's body, and much of ROS looks for it unless told
    otherwise.
    """

    code = "N201"
    name = "no-base-link"
    severity = Severity.INFO
    hint = "add a link 'base_link' where the root is"
    needs = Needs.ROBOT
    bad = Example('<link name="pelvis"/> <!-- N201 -->')
    good = Example('<link name="left_base_link"/>')

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield it at the root link."""
        assert subject.robot is not None
        if not any(_is_called(link.name, "base_link") for link in subject.robot.links):
            root = subject.link_elements[subject.robot.root]
            hint = "call the first link after it 'base_link'" if subject.robot.root == "world" else None
            yield self.finding(root, "no link is called 'base_link': this one is the root", hint=hint)


class NoToolFrame(Rule):
    """An arm has neither a flange nor a tool0 frame.

    REP 199 asks for both at the end of a serial arm: grippers are attached to the one, and the other is what the
    controller shows. Without them every application puts its own frame there. A gripper that is part of the robot
    comes after them.
    """

    code = "N202"
    name = "no-tool-frame"
    severity = Severity.INFO
    hint = "add links 'flange' and 'tool0' on fixed joints"
    needs = Needs.ROBOT
    bad = Example(
        "<link name='base_link'/>"
        + "".join(
            f"""
        <link name='link_{i}'/>{" <!-- N202 -->" if i == 5 else ""}
        <joint name='joint_{i}' type='continuous'>
          <parent link='{f"link_{i - 1}" if i > 1 else "base_link"}'/><child link='link_{i}'/><axis xyz='0 0 1'/>
        </joint>"""
            for i in range(1, 6)
        )
    )
    good = Example("""
        <link name="base_link"/><link name="finger"/>
        <joint name="grip" type="continuous">
          <parent link="base_link"/><child link="finger"/><axis xyz="0 0 1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield it at the last moving link of a robot that is one arm, and nothing but an arm."""
        assert subject.robot is not None
        robot = subject.robot
        moving = [joint for joint in robot.joints if joint.type is not JointType.FIXED]
        last = max(moving, key=lambda joint: sum(1 for _ in robot.to_root(joint.child)), default=None)
        if last is None or any(joint.mimic for joint in moving):
            return
        chain = [joint for joint in robot.to_root(last.child) if joint.type is not JointType.FIXED]
        if len(chain) < len(moving):
            return  # legs, a hand
        arm = without_gripper(chain[::-1])
        turning = all(joint.type in (JointType.REVOLUTE, JointType.CONTINUOUS) for joint in arm)
        if not turning or not _ARM[0] <= len(arm) <= _ARM[1]:
            return
        if not any(_is_called(link.name, word) for link in robot.links for word in ("flange", "tool0")):
            end = "that moves" if arm[-1] == last else "before the jaws"
            message = f"no link is called 'flange' or 'tool0': this is the last one {end}"
            yield self.finding(subject.link_elements[arm[-1].child], message)


class OddStandardFrame(Rule):
    """A flange or tool0 frame moves, or has a shape.

    REP 199: both are fixed to the last link of the arm and are frames alone; whoever attaches a gripper, or takes
    poses from the controller, relies on that.
    """

    code = "N203"
    name = "standard-frame"
    severity = Severity.INFO
    hint = "attach it by a fixed joint, and give the shape a link of its own"
    bad = Example("""
        <link name="base_link"/>
        <link name="tool0"> <!-- N203 -->
          <visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual>
        </link>
        <joint name="tool" type="fixed"><parent link="base_link"/><child link="tool0"/></joint>""")
    good = Example("""
        <link name="base_link"/>
        <link name="tool0"/>
        <joint name="tool" type="fixed"><parent link="base_link"/><child link="tool0"/></joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each such frame."""
        above = {end_of(joint, "child"): joint for joint in subject.joints}
        for name, link in subject.link_elements.items():
            if not (_is_called(name, "flange") or _is_called(name, "tool0")):
                continue
            kind = above[name].attributes.get("type", "") if name in above else "fixed"
            if kind != "fixed":
                yield self.finding(link, f"REP 199 wants this frame on a fixed joint, not on a {quote(kind)} one")
            elif link.all("visual") or link.all("collision"):
                yield self.finding(link, "REP 199 wants this frame without a shape")


class MissingPrefix(Rule):
    """A link lacks the prefix that all others around it have.

    Where one robot description is used twice, a prefix keeps the copies apart; a name that was forgotten appears in
    both. Only links between two that have the prefix are reported: hands, cameras and mounts have names of their own.
    """

    code = "N204"
    name = "prefix-missing"
    severity = Severity.INFO
    hint = "add the prefix"
    bad = Example(
        '<link name="left_base"/>'
        + "".join(
            f"""
        <link name="{name}"/>{" <!-- N204 -->" if name == "elbow" else ""}
        <joint name="left_joint_{i}" type="fixed"><parent link="{parent}"/><child link="{name}"/></joint>"""
            for i, (parent, name) in enumerate(
                [("left_base", "left_arm"), ("left_arm", "elbow"), ("elbow", "left_wrist"), ("left_wrist", "left_hand")]
            )
        )
    )
    good = Example("""
        <link name="base_link"/>
        <link name="arm"/>
        <joint name="shoulder" type="fixed"><parent link="base_link"/><child link="arm"/></joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each link without the prefix that stands between links with it."""
        names = list(subject.link_elements)
        prefix = _common_prefix(names)
        if not prefix:
            return
        with_it = {name for name in names if name.startswith(prefix)}
        parents = {end_of(joint, "child"): end_of(joint, "parent") for joint in subject.joints}
        lacking = [name for name in names if name not in with_it and _is_between(name, with_it, parents, subject)]
        if lacking:
            message = f"the prefix {quote(prefix)} is missing, which {len(with_it)} of {len(names)} links have"
            message += also(lacking[1:], "link")
            yield self.finding(subject.link_elements[lacking[0]], message, attribute="name")


def _common_prefix(names: Sequence[str]) -> str:
    """Return the first part of names that most of them share; empty if there is none."""
    found = [match[0] for name in names if (match := _PREFIX.match(name))]
    if len(found) < _FAMILY - 1 or len(names) < _FAMILY:
        return ""
    prefix, count = Counter(found).most_common(1)[0]
    return prefix if count >= _SHARE * len(names) else ""


def _is_between(name: str, with_it: set[str], parents: Mapping[str, str], subject: Subject) -> bool:
    below: Sequence[Element] = subject.joints_below.get(name, ())
    return parents.get(name) in with_it and any(end_of(joint, "child") in with_it for joint in below)


class WorldInside(Rule):
    """A link called world is not the root.

    Gazebo, Drake and MuJoCo take the name for the world that does not move: as the root it fixes the robot to the
    ground, elsewhere they refuse it or weld that link to the ground.
    """

    code = "N205"
    name = "world-inside"
    severity = Severity.WARNING
    hint = "rename the link, or make it the root"
    bad = Example("""
        <link name="base_link"/>
        <link name="world"/> <!-- N205 -->
        <joint name="mount" type="fixed"><parent link="base_link"/><child link="world"/></joint>""")
    good = Example("""
        <link name="world"/>
        <link name="base_link"/>
        <joint name="mount" type="fixed"><parent link="world"/><child link="base_link"/></joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the link if a joint leads to it."""
        above = [name_of(joint) for joint in subject.joints if end_of(joint, "child") == "world"]
        if above and "world" in subject.link_elements:
            yield self.finding(
                subject.link_elements["world"], f"joint {quote(above[0])} leads to it: it is not the root"
            )


CONVENTIONS: tuple[Rule, ...] = (NoBaseLink(), NoToolFrame(), OddStandardFrame(), MissingPrefix(), WorldInside())
