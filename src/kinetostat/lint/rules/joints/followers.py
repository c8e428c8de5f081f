"""J305 to J308: can a follower (mimic joint) go where its leader sends it?"""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.errors import quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.joints.common import kind, span, unit
from kinetostat.lint.rules.joints.laws import Law, factors, followers, laws, leader_of
from kinetostat.lint.subject import Subject, first, name_of
from kinetostat.urdf.document import Element

__all__ = ["FOLLOWERS"]

_SLACK = 0.01  # of the follower's range: limits and multipliers are written with few digits
_GOOD = Example("""
    <link name="palm"/>
    <link name="left"/>
    <link name="right"/>
    <joint name="left_finger" type="revolute">
      <parent link="palm"/><child link="left"/>
      <axis xyz="0 0 1"/>
      <limit lower="0" upper="0.8" effort="10" velocity="1"/>
    </joint>
    <joint name="right_finger" type="revolute">
      <parent link="palm"/><child link="right"/>
      <axis xyz="0 0 1"/>
      <limit lower="-0.8" upper="0" effort="10" velocity="1"/>
      <mimic joint="left_finger" multiplier="-1"/>
    </joint>""")


class ZeroMultiplier(Rule):
    """A follower's multiplier is 0: the joint never moves.

    The multiplier is a factor, with 1 as the default, not a switch; a joint that stands still is of type fixed. Its
    column of the Jacobian vanishes, and what divides by the multiplier fails.
    """

    code = "J305"
    name = "multiplier-zero"
    severity = Severity.WARNING
    hint = "write the ratio, or make the joint fixed"
    bad = Example("""
        <link name="palm"/>
        <link name="left"/>
        <link name="right"/>
        <joint name="left_finger" type="revolute">
          <parent link="palm"/><child link="left"/>
          <axis xyz="0 0 1"/>
          <limit lower="0" upper="0.8" effort="10" velocity="1"/>
        </joint>
        <joint name="right_finger" type="revolute">
          <parent link="palm"/><child link="right"/>
          <axis xyz="0 0 1"/>
          <limit lower="-0.8" upper="0" effort="10" velocity="1"/>
          <mimic joint="left_finger" multiplier="0"/> <!-- J305 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the mimics whose multiplier is 0."""
        found = []
        for joint, mimic in followers(subject):
            own = factors(mimic)
            if own is not None and own[0] == 0:
                message = f"mimic multiplier 0: the joint stays at its offset {own[1]:g} {unit(joint)}"
                found.append(Found(mimic, name_of(joint), message, "multiplier"))
        yield from grouped(self, found, what="joint")


class ImmobileFollower(Rule):
    """A joint that has no single position follows another.

    On a fixed joint a `<mimic>` has no effect, and Drake refuses the file for it. Often somebody has fixed the joint
    for a reduced model and left the rest as it was (one finding for the robot). A planar or floating joint cannot
    follow at all.
    """

    code = "J306"
    name = "follower-immobile"
    severity = Severity.WARNING
    hint = "remove the <mimic>, or give the joint its type back"
    bad = Example("""
        <link name="palm"/>
        <link name="left"/>
        <link name="right"/>
        <joint name="left_finger" type="revolute">
          <parent link="palm"/><child link="left"/>
          <axis xyz="0 0 1"/>
          <limit lower="0" upper="0.8" effort="10" velocity="1"/>
        </joint>
        <joint name="right_finger" type="fixed">
          <parent link="palm"/><child link="right"/>
          <mimic joint="left_finger"/> <!-- J306 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the mimics of joints that cannot follow."""
        fixed = []
        for joint in subject.joints:
            mimic = first(joint, "mimic")
            if mimic is not None and kind(joint) in ("planar", "floating"):
                message = f"a {kind(joint)} joint cannot follow another"
                yield self.finding(joint, message, severity=Severity.ERROR, hint="remove its <mimic>")
            elif mimic is not None and kind(joint) == "fixed":
                message = "a mimic on a fixed joint has no effect, and Drake refuses the file for it"
                fixed.append(Found(mimic, name_of(joint), message))
        yield from grouped(self, fixed, what="joint", few=1)


class FollowerRange(Rule):
    """A leader sends its follower beyond the follower's limits.

    The two contradict each other. Where limits are enforced, as in simulation, the follower stops and holds the leader,
    or tears loose from it: a gripper that does not close, or closes with one finger. Often a sign is wrong: with
    multiplier -1 the range of the follower runs the other way. It is reported as info where the leader reaches beyond
    both limits of the follower: then those bound the pair, and the leader's own are merely generous.
    """

    code = "J307"
    name = "follower-range-exceeded"
    severity = Severity.WARNING
    hint = "give the follower the range that its leader's range, multiplier and offset make"
    bad = Example("""
        <link name="palm"/>
        <link name="left"/>
        <link name="right"/>
        <joint name="left_finger" type="revolute">
          <parent link="palm"/><child link="left"/>
          <axis xyz="0 0 1"/>
          <limit lower="0" upper="0.8" effort="10" velocity="1"/>
        </joint>
        <joint name="right_finger" type="revolute">
          <parent link="palm"/><child link="right"/>
          <axis xyz="0 0 1"/>
          <limit lower="0" upper="0.8" effort="10" velocity="1"/>
          <mimic joint="left_finger" multiplier="-1"/> <!-- J307 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the followers whose limits do not hold what their leader's range makes of them."""
        signs, ranges, generous, law_of = list[Found](), list[Found](), list[Found](), laws(subject)
        for joint, mimic in followers(subject):
            law, own = law_of[name_of(joint)], span(joint)
            sent = _sent(subject, law) if law is not None else None
            if law is None or own is None or sent is None or law.multiplier == 0:
                continue
            message = (
                f"the range of its leader {quote(law.leader, 40)} sends it to {_shown(sent)} {unit(joint)}; "
                f"its own limits are {_shown(own)}"
            )
            one = Found(mimic, name_of(joint), message)
            if all(_beyond(sent, own)):
                generous.append(one)
            elif any(_beyond(sent, own)):
                (ranges if any(_beyond(_turned(sent, mimic), own)) else signs).append(one)
        yield from grouped(self, signs, what="joint", hint=f"change the sign of the multiplier, or {self.hint}")
        yield from grouped(self, ranges, what="joint")
        yield from grouped(self, generous, what="joint", severity=Severity.INFO)


def _sent(subject: Subject, law: Law) -> tuple[float, float] | None:
    """Return where a law sends the follower while its leader goes through its range; None if that has none."""
    limits = span(subject.joint_elements[law.leader])
    if limits is None:
        return None
    ends = sorted(law.multiplier * end + law.offset for end in limits)
    return ends[0], ends[1]


def _beyond(sent: tuple[float, float], own: tuple[float, float]) -> tuple[bool, bool]:
    """Return whether a follower is sent below its lower limit, and above its upper one."""
    slack = _SLACK * (own[1] - own[0])
    return sent[0] < own[0] - slack, sent[1] > own[1] + slack


def _turned(sent: tuple[float, float], mimic: Element) -> tuple[float, float]:
    """Return where the follower would be sent with the other sign of its multiplier: mirrored at its offset."""
    _, offset = factors(mimic) or (1.0, 0.0)
    return 2 * offset - sent[1], 2 * offset - sent[0]


def _shown(limits: tuple[float, float]) -> str:
    return f"[{limits[0]:.4g}, {limits[1]:.4g}]"


class ContinuousFollower(Rule):
    """A continuous joint follows another.

    Many tools hold a continuous joint as a cosine and a sine, or wrap its angle, and cannot scale that by a multiplier:
    Pinocchio, asked for mimic joints, refuses one that follows a revolute joint. A follower of a joint with stops has
    stops, too; of a joint without, its angle after a turn of the leader depends on who counts the turns.
    """

    code = "J308"
    name = "follower-continuous"
    severity = Severity.WARNING
    hint = "make it revolute, with the range that its leader's makes"
    bad = Example("""
        <link name="frame"/>
        <link name="pulley"/>
        <link name="wheel"/>
        <joint name="crank" type="revolute">
          <parent link="frame"/><child link="pulley"/>
          <axis xyz="0 0 1"/>
          <limit lower="-1" upper="1" effort="10" velocity="1"/>
        </joint>
        <joint name="hub" type="continuous">
          <parent link="frame"/><child link="wheel"/>
          <axis xyz="0 0 1"/>
          <mimic joint="crank" multiplier="2"/> <!-- J308 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the continuous joints that follow another; an info if they roll with a slide."""
        turning, rolling = list[Found](), list[Found]()
        for joint, mimic in followers(subject):
            leader = leader_of(subject, joint)
            if kind(joint) != "continuous" or leader is None or kind(leader) in ("fixed", "planar", "floating"):
                continue
            found = Found(mimic, name_of(joint), _continuous(joint, leader), "joint")
            (rolling if kind(leader) == "prismatic" else turning).append(found)
        yield from grouped(self, turning, what="joint")
        yield from grouped(self, rolling, what="joint", severity=Severity.INFO)


def _continuous(joint: Element, leader: Element) -> str:
    if leader is joint:
        return "a continuous joint that follows itself"
    return f"a continuous joint follows the {kind(leader)} joint {quote(name_of(leader))}"


FOLLOWERS: tuple[Rule, ...] = (ZeroMultiplier(), ImmobileFollower(), FollowerRange(), ContinuousFollower())
"""The rules, in the order of their codes."""
