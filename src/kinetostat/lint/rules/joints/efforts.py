"""J106 to J108: how strong is the joint, and how fast?"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.joints.common import kind, moves
from kinetostat.lint.subject import Subject, first, name_of, number
from kinetostat.urdf.document import Element

__all__ = ["EFFORTS"]

_KEYS = ("effort", "velocity")
_GOOD = Example("""
    <link name="base"/>
    <link name="arm"/>
    <joint name="shoulder" type="revolute">
      <parent link="base"/><child link="arm"/>
      <axis xyz="0 0 1"/>
      <limit lower="-1.5" upper="1.5" effort="10" velocity="1"/>
    </joint>""")


class MissingEffort(Rule):
    """A limit has no effort or no velocity.

    urdfdom, and with it ROS, MoveIt and Pinocchio, refuses the whole file then, whatever the type of the joint, even if
    it is fixed. Other readers take what is absent as unlimited, or as 0.
    """

    code = "J106"
    name = "effort-or-velocity-missing"
    severity = Severity.ERROR
    hint = "write both effort (N or Nm) and velocity (m/s or rad/s)"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-1.5" upper="1.5" velocity="1"/> <!-- J106 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the limits without effort or velocity."""
        found = []
        for joint in subject.joints:
            limit = first(joint, "limit")
            absent = [key for key in _KEYS if limit is not None and key not in limit.attributes]
            if limit is not None and absent and joint.tag == "joint":
                found.append(Found(limit, name_of(joint), f"the limit has no {' and no '.join(absent)}"))
        yield from grouped(self, found, what="joint")


class ZeroEffort(Rule):
    """The effort or the velocity limit is 0.

    Exporters write 0 where nobody has filled in a number. Drake takes effort 0 as "without a motor", MoveIt velocity 0
    as "unlimited", and what clamps to the limit holds the joint still. Right for a joint without a motor, so it is a
    warning only where all joints of the robot have it. Followers and joints that cannot move are not asked.
    """

    code = "J107"
    name = "effort-or-velocity-zero"
    severity = Severity.WARNING
    hint = "write what the drive can do; for a joint without a motor this is right"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-1.5" upper="1.5" effort="0" velocity="0"/> <!-- J107 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield one finding for all joints with effort 0, with velocity 0, or with both."""
        asked, found = 0, defaultdict[tuple[str, ...], list[Found]](list)
        for joint in subject.joints:
            limit = first(joint, "limit")
            if limit is None or not moves(joint) or first(joint, "mimic") is not None or _is_locked(joint):
                continue
            asked += 1
            zero = tuple(key for key in _KEYS if number(limit, key) == 0)
            if zero:
                message = f"{' and '.join(zero)} {'is' if len(zero) == 1 else 'are'} 0"
                found[zero].append(Found(limit, name_of(joint), message, zero[0]))
        for alike in found.values():
            if len(alike) == asked:
                where = " for all joints that can move" if asked > 1 else ""
                yield self.finding(alike[0].at, alike[0].message + where, attribute=alike[0].attribute)
            else:
                yield from grouped(self, alike, what="joint", few=1, severity=Severity.INFO)


def _is_locked(joint: Element) -> bool:
    """Return whether the range is empty: another rule has told that nothing is filled in."""
    limit = first(joint, "limit")
    lower, upper = number(limit, "lower"), number(limit, "upper")
    return kind(joint) != "continuous" and lower is not None and lower == upper


class NegativeEffort(Rule):
    """The effort or the velocity limit is negative.

    A limit is a magnitude. Pinocchio refuses the file (since its release 4), and so does Drake if it is the velocity.
    MoveIt drops the sign, Gazebo reads a negative one as "unlimited", controllers that clamp between -limit and limit
    get an empty range and may jump to either end.
    """

    code = "J108"
    name = "effort-or-velocity-negative"
    severity = Severity.ERROR
    hint = "write the magnitude, without the sign"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-1.5" upper="1.5" effort="-10" velocity="1"/> <!-- J108 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the limits with a negative effort or velocity."""
        found = []
        for joint in filter(moves, subject.joints):
            limit = first(joint, "limit")
            negative = {key: value for key in _KEYS if (value := number(limit, key)) is not None and value < 0}
            if limit is not None and negative:
                text = " and ".join(f"{key} {value:g}" for key, value in negative.items())
                message = f"{text} {'is' if len(negative) == 1 else 'are'} negative"
                found.append(Found(limit, name_of(joint), message, next(iter(negative))))
        yield from grouped(self, found, what="joint")


EFFORTS: tuple[Rule, ...] = (MissingEffort(), ZeroEffort(), NegativeEffort())
"""The rules, in the order of their codes."""
