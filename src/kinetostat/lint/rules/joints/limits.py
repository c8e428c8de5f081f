"""J101 to J105: is there a range, and does it make sense?"""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.joints.common import has_range, kind, span, unit
from kinetostat.lint.subject import Subject, first, name_of, number

__all__ = ["LIMITS"]

_GOOD = Example("""
    <link name="base"/>
    <link name="arm"/>
    <joint name="shoulder" type="revolute">
      <parent link="base"/><child link="arm"/>
      <axis xyz="0 0 1"/>
      <limit lower="-1.5" upper="1.5" effort="10" velocity="1"/>
    </joint>""")


class MissingLimit(Rule):
    """A revolute or prismatic joint has no limit.

    URDF requires one: urdfdom, and with it ROS, MoveIt and Pinocchio, refuses the whole file. Of the joints that turn
    or slide, only a continuous one needs no limit.
    """

    code = "J101"
    name = "limit-missing"
    severity = Severity.ERROR
    hint = 'write <limit lower="..." upper="..." effort="..." velocity="..."/>, or make the joint continuous'
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute"> <!-- J101 -->
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each joint that must have a limit and has none."""
        for joint in subject.joints:
            if has_range(joint) and first(joint, "limit") is None:
                yield self.finding(joint, f"a {kind(joint)} joint without <limit>")


class MissingBound(Rule):
    """A limit does not say where the range begins or ends.

    What is absent counts as 0, not as unlimited: a limit with neither lower nor upper locks the joint. So urdfdom reads
    it, and with it ROS, MoveIt and Pinocchio; other readers, as that of PyBullet, let the joint turn freely: the same
    file is two robots.
    """

    code = "J102"
    name = "bound-missing"
    severity = Severity.WARNING
    hint = "write both lower and upper; a joint without stops is of type continuous"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-1.5" effort="10" velocity="1"/> <!-- J102 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the limits without lower or upper."""
        found = []
        for joint in subject.joints:
            limit = first(joint, "limit")
            absent = [key for key in ("lower", "upper") if limit is not None and key not in limit.attributes]
            if limit is None or not absent or not has_range(joint):
                continue
            message = f"the limit has no {absent[0]}: URDF's default 0 holds"
            if len(absent) == 2:
                message = "the limit has neither lower nor upper: both count as 0, so the joint cannot move"
            found.append(Found(limit, name_of(joint), message))
        yield from grouped(self, found, what="joint")


class SwappedLimits(Rule):
    """The lower limit is above the upper one.

    MuJoCo and PyBullet take it for a joint without limits, Drake refuses the robot, and to Pinocchio no position is
    within the limits: the same file is a different robot in each of them.
    """

    code = "J103"
    name = "limits-swapped"
    severity = Severity.ERROR
    hint = "exchange the two; a joint that turns without stops is of type continuous"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="1.5" upper="-1.5" effort="10" velocity="1"/> <!-- J103 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each limit that is the wrong way round."""
        for joint in filter(has_range, subject.joints):
            limit = first(joint, "limit")
            lower, upper = number(limit, "lower"), number(limit, "upper")
            if limit is not None and lower is not None and upper is not None and lower > upper:
                yield self.finding(limit, f"lower {lower:g} is above upper {upper:g}", attribute="lower")


class EqualLimits(Rule):
    """The lower limit equals the upper one: the joint cannot move.

    Exporters write 0 and 0 where nobody has filled in a range. Tools that enforce limits lock such a joint, others take
    an empty range for none, and planners have nothing to sample. A joint that is meant not to move is of type fixed.
    """

    code = "J104"
    name = "limits-equal"
    severity = Severity.WARNING
    hint = "write the range; a joint that is not to move is of type fixed, one without stops of type continuous"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="0" upper="0" effort="10" velocity="1"/> <!-- J104 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the limits with an empty range."""
        found = []
        for joint in filter(has_range, subject.joints):
            limit = first(joint, "limit")
            lower, upper = number(limit, "lower"), number(limit, "upper")
            if limit is None or lower is None or lower != upper:
                continue
            message = f"lower and upper are both {lower:g} {unit(joint)}: the joint cannot move"
            if lower == 0 and number(limit, "effort") == 0 and number(limit, "velocity") == 0:
                message = "lower, upper, effort and velocity are all 0: the joint cannot move"
            found.append(Found(limit, name_of(joint), message, "upper"))
        yield from grouped(self, found, what="joint")


class ZeroOutsideLimits(Rule):
    """Position 0 is outside the limits of the joint.

    Many arms and legs are built like that, and nothing is wrong with them; but simulators and visualisers start at 0,
    and planners refuse a start outside the limits. Such a robot needs a home configuration wherever it is loaded.
    """

    code = "J105"
    name = "zero-outside-limits"
    severity = Severity.INFO
    hint = "give tools a start inside the limits, for instance a group_state in the SRDF"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="knee" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-2.6" upper="-0.6" effort="10" velocity="1"/> <!-- J105 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the joints whose range does not hold 0; followers go where their leaders put them."""
        found = []
        for joint in subject.joints:
            limit, limits = first(joint, "limit"), span(joint)
            if limit is None or limits is None or first(joint, "mimic") is not None:
                continue
            lower, upper = limits
            if not lower <= 0 <= upper:
                message = f"position 0 is outside the limits [{lower:.6g}, {upper:.6g}] {unit(joint)}"
                found.append(Found(limit, name_of(joint), message, "lower" if lower > 0 else "upper"))
        yield from grouped(self, found, what="joint")


LIMITS: tuple[Rule, ...] = (MissingLimit(), MissingBound(), SwappedLimits(), EqualLimits(), ZeroOutsideLimits())
"""The rules, in the order of their codes."""
