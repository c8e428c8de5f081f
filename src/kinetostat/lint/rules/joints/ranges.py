"""J109 to J113: is the range one that a joint can have, in the right unit?"""

from __future__ import annotations

import math
from collections.abc import Iterator

from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.joints.common import has_range, kind, span
from kinetostat.lint.subject import Subject, end_of, first, name_of, number, vector
from kinetostat.urdf.document import Element
from kinetostat.urdf.reading import as_number

__all__ = ["RANGES"]

_TURN = 2 * math.pi
_SLACK = 1.002  # of a turn: limits are written with three digits
_DEGREES = (15.0, 720.0)  # a bound in rad between them is hardly one: two turns and a half, more than a hundred
_LONG = 10.0  # m: a longer slide is rare
_LONGER = 10.0  # times all distances between the joints of the robot: the slide is hardly in metres


class InfiniteLimit(Rule):
    """A limit is infinite.

    urdfdom, and with it ROS, Gazebo, MoveIt and Pinocchio, does not read "inf" and refuses the file, and so does Drake;
    yourdfpy, PyBullet and MuJoCo take it. A joint without stops is of type continuous; an effort without bound is a
    large number.
    """

    code = "J109"
    name = "limit-infinite"
    severity = Severity.WARNING
    hint = "write finite limits; a joint without stops is of type continuous and needs no lower and upper"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-inf" upper="inf" effort="10" velocity="1"/> <!-- J109 -->
        </joint>""")
    good = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="continuous">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit effort="10" velocity="1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the limits with an infinite number."""
        found = []
        for joint in subject.joints:
            limit = first(joint, "limit")
            infinite = _infinite(limit)
            if limit is None or not infinite:
                continue
            if has_range(joint) and infinite.get("lower", 0.0) == infinite.get("upper", 1.0):
                message = f"lower and upper are both {infinite['lower']:g}: no position is allowed"
                yield self.finding(joint, message, severity=Severity.ERROR)
            else:
                written = ", ".join(f"{key} {value:g}" for key, value in infinite.items())
                message = f"{written}: ROS, Pinocchio and Drake refuse the file"
                found.append(Found(limit, name_of(joint), message, next(iter(infinite))))
        yield from grouped(self, found, what="joint")


def _infinite(limit: Element | None) -> dict[str, float]:
    """Return the limits that are written as infinite; not those that are only too large for a number."""
    found = {}
    for key in ("lower", "upper", "effort", "velocity"):
        text = limit.attributes.get(key, "") if limit is not None else ""
        value = as_number(text)
        if value is not None and math.isinf(value) and not any(c.isdigit() for c in text):
            found[key] = value
    return found


class LimitsInDegrees(Rule):
    """The limits of a revolute joint look like degrees.

    URDF knows radians only. A joint with limits -180 and 180 may make 57 turns. Everything loads, but planners, inverse
    kinematics and workspaces mean nothing.
    """

    code = "J110"
    name = "limits-in-degrees"
    severity = Severity.WARNING
    hint = "write radians: 3.14159265358979 for 180 degrees; a joint without stops is of type continuous"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-180" upper="180" effort="10" velocity="1"/> <!-- J110 -->
        </joint>""")
    good = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-3.14159265358979" upper="3.14159265358979" effort="10" velocity="1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the limits that look like degrees."""
        found = [
            Found(limit, name_of(joint), f"{_turns(lower, upper)}: are these degrees?", _larger(lower, upper))
            for joint, limit, lower, upper in _revolute(subject)
            if _are_degrees(lower, upper)
        ]
        yield from grouped(self, found, what="joint")


class ManyTurns(Rule):
    """A revolute joint may make more than two turns.

    Some drives do, and some files say so where there is no stop at all. Inverse kinematics and planners then have many
    answers for one pose, and 0 and a full turn are different positions.
    """

    code = "J111"
    name = "many-turns"
    severity = Severity.INFO
    hint = "right for a drive that counts its turns; a joint without stops is of type continuous"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-10" upper="10" effort="10" velocity="1"/> <!-- J111 -->
        </joint>""")
    good = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-6.2832" upper="6.2832" effort="10" velocity="1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the ranges of more than two turns that do not look like degrees."""
        found = [
            Found(limit, name_of(joint), _turns(lower, upper), _larger(lower, upper))
            for joint, limit, lower, upper in _revolute(subject)
            if upper - lower > 2 * _TURN * _SLACK and not _are_degrees(lower, upper)
        ]
        yield from grouped(self, found, what="joint")


def _revolute(subject: Subject) -> Iterator[tuple[Element, Element, float, float]]:
    """Yield each revolute joint that has a range, with its limit, lower and upper."""
    for joint in subject.joints:
        limit, limits = first(joint, "limit"), span(joint)
        if kind(joint) == "revolute" and limit is not None and limits is not None:
            yield joint, limit, *limits


def _are_degrees(lower: float, upper: float) -> bool:
    """Return whether a range in rad is hardly one: whole quarter turns are radians, whatever their number."""
    largest = max(abs(lower), abs(upper))
    quarters = largest / (_TURN / 4)
    in_quarters = abs(quarters - round(quarters)) < 1e-3
    return _DEGREES[0] <= largest <= _DEGREES[1] and upper - lower > 2 * _TURN * _SLACK and not in_quarters


def _turns(lower: float, upper: float) -> str:
    return f"a range of {upper - lower:.4g} rad, from {lower:g} to {upper:g}: {(upper - lower) / _TURN:.2g} turns"


def _larger(lower: float, upper: float) -> str:
    return "lower" if abs(lower) > abs(upper) else "upper"


class LongSlide(Rule):
    """A prismatic joint slides very far.

    URDF knows metres only. A gripper that opens by 40 (mm) opens by 40 m. It is a warning where the slide is out of all
    proportion to the robot; where the whole robot slides, as on a planar base made of slides, it is reported as info.
    """

    code = "J112"
    name = "long-slide"
    severity = Severity.WARNING
    hint = "write metres: 0.04 for 40 mm"
    bad = Example("""
        <link name="base"><inertial><mass value="1"/></inertial></link>
        <link name="finger"/>
        <joint name="gripper" type="prismatic">
          <parent link="base"/><child link="finger"/>
          <origin xyz="0 0 0.1"/>
          <axis xyz="0 1 0"/>
          <limit lower="0" upper="40" effort="10" velocity="1"/> <!-- J112 -->
        </joint>""")
    good = Example("""
        <link name="base"><inertial><mass value="1"/></inertial></link>
        <link name="finger"/>
        <joint name="gripper" type="prismatic">
          <parent link="base"/><child link="finger"/>
          <origin xyz="0 0 0.1"/>
          <axis xyz="0 1 0"/>
          <limit lower="0" upper="0.04" effort="10" velocity="1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the slides of more than ten metres."""
        long = []
        for joint in subject.joints:
            limit, limits = first(joint, "limit"), span(joint)
            if kind(joint) == "prismatic" and limit is not None and limits and limits[1] - limits[0] > _LONG:
                length = limits[1] - limits[0]
                message = f"a slide of {length:g} m, from {limits[0]:g} to {limits[1]:g}"
                long.append((joint, Found(limit, name_of(joint), message, _larger(*limits)), length))
        if not long:
            return
        size, base = _size(subject), _carried_by_nothing(subject)
        doubtful, large = list[Found](), list[Found]()
        for joint, found, length in long:
            out_of_proportion = length > _LONGER * size and end_of(joint, "parent") not in base
            (doubtful if out_of_proportion else large).append(found)
        yield from grouped(self, doubtful, what="joint")
        yield from grouped(self, large, what="joint", severity=Severity.INFO, hint="right if the robot is that large")


def _size(subject: Subject) -> float:
    """Return the sum of the distances between joints, in m: nothing of the robot is farther apart."""
    return sum(math.hypot(*(vector(first(joint, "origin"), "xyz", 3) or (0.0,))) for joint in subject.joints)


def _carried_by_nothing(subject: Subject) -> set[str]:
    """Return the links without mass above which there is no mass either: a joint on them moves the whole robot."""
    children = {end_of(joint, "child") for joint in subject.joints}
    stack = [name_of(link) for link in subject.links if name_of(link) not in children]
    found = set[str]()
    while stack:
        name = stack.pop()
        link = subject.link_elements.get(name)
        if name not in found and link is not None and not number(first(link, "inertial", "mass"), "value"):
            found.add(name)
            stack += [end_of(joint, "child") for joint in subject.joints_below.get(name, ())]
    return found


class ContinuousRange(Rule):
    """A continuous joint has a range, which readers ignore.

    A continuous joint turns for ever; lower and upper do not bind it. It is a warning if they leave out part of a turn:
    whoever wrote them meant a revolute joint.
    """

    code = "J113"
    name = "continuous-with-range"
    severity = Severity.WARNING
    hint = "make the joint revolute if it has stops; else leave lower and upper out"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="continuous">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-1.5" upper="1.5" effort="10" velocity="1"/> <!-- J113 -->
        </joint>""")
    good = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="continuous">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit effort="10" velocity="1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the ranges of continuous joints."""
        narrow, harmless = list[Found](), list[Found]()
        for joint in subject.joints:
            limit = first(joint, "limit")
            given = [key for key in ("lower", "upper") if limit is not None and key in limit.attributes]
            if kind(joint) != "continuous" or limit is None or not given:
                continue
            lower, upper = number(limit, "lower"), number(limit, "upper")
            if lower is not None and upper is not None and 0 < upper - lower < _TURN / _SLACK:
                message = f"a continuous joint: its range from {lower:g} to {upper:g} rad is ignored"
                narrow.append(Found(limit, name_of(joint), message, "lower"))
            else:
                message = f"a continuous joint: its {' and '.join(given)} {'are' if len(given) > 1 else 'is'} ignored"
                harmless.append(Found(limit, name_of(joint), message, given[0]))
        yield from grouped(self, narrow, what="joint")
        yield from grouped(self, harmless, what="joint", severity=Severity.INFO)


RANGES: tuple[Rule, ...] = (InfiniteLimit(), LimitsInDegrees(), ManyTurns(), LongSlide(), ContinuousRange())
"""The rules, in the order of their codes."""
