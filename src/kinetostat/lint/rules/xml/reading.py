"""X0xx: what is left when all other rules have spoken."""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.errors import KinetostatError, cut, quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Needs, Rule
from kinetostat.lint.subject import Subject
from kinetostat.lint.suppression import Suppression

__all__ = ["READING", "UnreadableRobot", "UnusedSuppression"]


class UnreadableRobot(Rule):
    """The robot cannot be read.

    Whatever the reason, no tool can answer for such a file, and no other rule that needs the robot was asked. This rule
    speaks where no other has named the reason; it cannot be left out or taken back.
    """

    code = "X001"
    name = "unreadable"
    severity = Severity.ERROR
    hint = "correct the file there"
    needs = Needs.BYTES
    bad = Example("""
        <robot name="example" xmlns:drake="https://drake.mit.edu">
          <link name="base"/>
          <link name="nut"/>
          <drake:joint name="spindle" type="screw"> <!-- X001 -->
            <parent link="base"/><child link="nut"/>
            <axis xyz="0 0 1"/>
          </drake:joint>
        </robot>""")
    good = Example("""
        <robot name="example" xmlns:drake="https://drake.mit.edu">
          <link name="base"/>
          <link name="nut"/>
          <drake:joint name="spindle" type="screw">
            <parent link="base"/><child link="nut"/>
            <axis xyz="0 0 1"/>
            <drake:screw_thread_pitch value="0.005"/>
          </drake:joint>
        </robot>""")

    def check(self, subject: Subject) -> Iterator[Finding]:  # noqa: ARG002
        """Yield nothing: `lint` asks `of` where no other rule has spoken."""
        yield from ()

    def of(self, refusal: KinetostatError, file: str = "") -> Finding:
        """Return the finding for a refusal, in the file if that is not the robot's own (an include of xacro)."""
        element = refusal.element or ""
        return self.finding(refusal.line or 0, refusal.message, hint=refusal.remedy, element=element, file=file)


class UnusedSuppression(Rule):
    """A comment takes findings back that are not there, or gives no reason.

    A forgotten `kinetostat: ignore[...]` hides the next real defect; one without a reason cannot be judged by whoever
    reads the file next.
    """

    code = "X002"
    name = "unused-suppression"
    severity = Severity.WARNING
    hint = "remove the comment, or write its codes and a reason: <!-- kinetostat: ignore[J103] as built -->"
    bad = Example("""
        <!-- kinetostat: ignore[J] nothing is wrong here --> <!-- X002 -->
        <link name="base"/>""")
    good = Example("""
        <link name="base"/>""")

    def check(self, subject: Subject) -> Iterator[Finding]:  # noqa: ARG002
        """Yield nothing: `lint` asks `of` once it knows what the comments took back."""
        yield from ()

    def of(self, comment: Suppression, *, used: bool) -> Finding:
        """Return the finding for a comment that takes nothing back (not `used`), or has no reason."""
        codes = cut(",".join(comment.codes))
        message = f"ignore[{codes}] gives no reason" if used else f"ignore[{codes}] takes nothing back"
        return self.finding(comment.line, message, element=quote("kinetostat: ignore"), file=comment.file)


READING: tuple[Rule, ...] = (UnreadableRobot(), UnusedSuppression())
