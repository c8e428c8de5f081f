"""J: joints. Limits, axes, followers, dynamics."""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.subject import Subject, first, number

__all__ = ["JOINTS"]


class SwappedLimits(Rule):
    """The lower limit is above the upper one.

    Some readers swap the two, some refuse the file, some let the joint not move at all: the same file is a different
    robot in each of them.
    """

    code = "J103"
    name = "limits-swapped"
    severity = Severity.ERROR
    hint = "exchange the two"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="1.5" upper="-1.5" effort="10" velocity="1"/> <!-- J103 -->
        </joint>""")
    good = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-1.5" upper="1.5" effort="10" velocity="1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each limit that is the wrong way round."""
        for joint in subject.joints:
            limit = first(joint, "limit")
            lower, upper = number(limit, "lower"), number(limit, "upper")
            if limit is not None and lower is not None and upper is not None and lower > upper:
                yield self.finding(limit, f"lower {lower:g} is above upper {upper:g}", attribute="lower")


JOINTS: tuple[Rule, ...] = (SwappedLimits(),)
