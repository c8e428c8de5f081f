"""J301 to J304: whom does a follower (mimic joint) follow?"""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.errors import quote, unknown_name
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.joints.common import kind, moves
from kinetostat.lint.rules.joints.laws import followers, laws, leader_of
from kinetostat.lint.subject import Subject, name_of
from kinetostat.urdf.document import Element

__all__ = ["LEADERS"]

_GOOD = Example("""
    <link name="palm"/>
    <link name="left"/>
    <link name="right"/>
    <joint name="left_finger" type="prismatic">
      <parent link="palm"/><child link="left"/>
      <axis xyz="0 1 0"/>
      <limit lower="0" upper="0.04" effort="10" velocity="1"/>
    </joint>
    <joint name="right_finger" type="prismatic">
      <parent link="palm"/><child link="right"/>
      <axis xyz="0 -1 0"/>
      <limit lower="0" upper="0.04" effort="10" velocity="1"/>
      <mimic joint="left_finger"/>
    </joint>""")


class MissingLeader(Rule):
    """A follower follows a joint that does not exist.

    Drake refuses such a file, and Pinocchio, asked for mimic joints, does, too. Most other tools load it, and the joint
    hangs loose: kinetostat takes it as independent, a gripper closes with one finger. Often a prefix was added to the
    names of the joints and not to the mimic.
    """

    code = "J301"
    name = "leader-missing"
    severity = Severity.WARNING
    hint = "name an existing joint, or remove the <mimic>"
    bad = Example("""
        <link name="palm"/>
        <link name="left"/>
        <joint name="left_finger" type="prismatic">
          <parent link="palm"/><child link="left"/>
          <axis xyz="0 1 0"/>
          <limit lower="0" upper="0.04" effort="10" velocity="1"/>
          <mimic joint="finger"/> <!-- J301 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the followers without a leader; a mimic that names none is another family's."""
        unknown = []
        for joint, mimic in followers(subject):
            leader = mimic.attributes.get("joint")
            if leader is not None and leader not in subject.joint_elements:
                message = f"it mimics {quote(leader)}, which does not exist: it counts as independent"
                unknown.append(Found(mimic, name_of(joint), message, "joint"))
        yield from grouped(self, unknown, what="joint", hint=_nearest(subject, unknown[0]) if unknown else None)


def _nearest(subject: Subject, found: Found) -> str | None:
    """Return the hint with the names nearest to a leader that does not exist."""
    others = [name for name in subject.joint_elements if name != found.name]
    return unknown_name("joint", found.at.attributes["joint"], others).remedy


class MimicCircle(Rule):
    """Followers follow each other in a circle, or a joint follows itself.

    Nobody leads, so no position is determined. Some tools hang, some overflow their stack, some leave the joints at 0.
    """

    code = "J302"
    name = "mimic-circle"
    severity = Severity.ERROR
    hint = "a circle has no leader: remove one <mimic>"
    bad = Example("""
        <link name="palm"/>
        <link name="left"/>
        <joint name="left_finger" type="prismatic"> <!-- J302 -->
          <parent link="palm"/><child link="left"/>
          <axis xyz="0 1 0"/>
          <limit lower="0" upper="0.04" effort="10" velocity="1"/>
          <mimic joint="left_finger"/>
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each circle at the joint that closes it."""
        settled = set[str]()
        for start, _ in followers(subject):
            trail, joint = dict[str, None](), start
            while name_of(joint) not in settled and moves(joint):
                trail[name_of(joint)] = None
                leader = leader_of(subject, joint)
                if leader is None:
                    break
                if name_of(leader) in trail:
                    yield self.finding(joint, _circle(trail, leader))
                    break
                joint = leader
            settled.update(trail)


def _circle(trail: dict[str, None], leader: Element) -> str:
    if name_of(leader) == next(reversed(trail)):
        return "it mimics itself"
    return f"its mimics lead back to joint {quote(name_of(leader))}"


class ImmobileLeader(Rule):
    """A follower follows a joint that has no single position.

    A fixed joint has no position, a planar or floating one has several: nothing determines the follower. Pinocchio,
    asked for mimic joints, refuses such a robot.
    """

    code = "J303"
    name = "leader-immobile"
    severity = Severity.ERROR
    hint = "follow a revolute, prismatic or continuous joint"
    bad = Example("""
        <link name="palm"/>
        <link name="left"/>
        <link name="right"/>
        <joint name="left_finger" type="fixed">
          <parent link="palm"/><child link="left"/>
        </joint>
        <joint name="right_finger" type="prismatic"> <!-- J303 -->
          <parent link="palm"/><child link="right"/>
          <axis xyz="0 1 0"/>
          <limit lower="0" upper="0.04" effort="10" velocity="1"/>
          <mimic joint="left_finger"/>
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the followers of fixed, planar and floating joints."""
        found = []
        for joint, _ in followers(subject):
            leader = leader_of(subject, joint)
            if leader is not None and kind(leader) in ("fixed", "planar", "floating"):
                message = f"it mimics the {kind(leader)} joint {quote(name_of(leader))}, which has no single position"
                found.append(Found(joint, name_of(joint), message))
        yield from grouped(self, found, what="joint")


class MimicChain(Rule):
    """A follower follows a follower.

    URDF does not forbid it, and kinetostat folds the chain; but Pinocchio, asked for mimic joints, refuses it, and what
    looks up the leader once only leaves the second follower where it is.
    """

    code = "J304"
    name = "mimic-chain"
    severity = Severity.INFO
    hint = "follow the first leader, with the product of the multipliers"
    bad = Example("""
        <link name="palm"/>
        <link name="lower"/>
        <link name="middle"/>
        <link name="tip"/>
        <joint name="knuckle" type="revolute">
          <parent link="palm"/><child link="lower"/>
          <axis xyz="0 1 0"/>
          <limit lower="0" upper="1" effort="10" velocity="1"/>
        </joint>
        <joint name="middle_joint" type="revolute">
          <parent link="lower"/><child link="middle"/>
          <axis xyz="0 1 0"/>
          <limit lower="0" upper="1" effort="10" velocity="1"/>
          <mimic joint="knuckle"/>
        </joint>
        <joint name="tip_joint" type="revolute">
          <parent link="middle"/><child link="tip"/>
          <axis xyz="0 1 0"/>
          <limit lower="0" upper="1" effort="10" velocity="1"/>
          <mimic joint="middle_joint"/> <!-- J304 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the followers of followers; those of joints in a circle are another rule's."""
        found, law_of = list[Found](), laws(subject)
        for joint, mimic in followers(subject):
            leader, law = leader_of(subject, joint), law_of[name_of(joint)]
            if leader is not None and law is not None and law.leader != name_of(leader):
                message = f"it mimics {quote(name_of(leader))}, which itself follows another joint"
                found.append(Found(mimic, name_of(joint), message, "joint"))
        yield from grouped(self, found, what="joint")


LEADERS: tuple[Rule, ...] = (MissingLeader(), MimicCircle(), ImmobileLeader(), MimicChain())
"""The rules, in the order of their codes."""
