"""J201 to J204: along what does the joint turn or slide?"""

from __future__ import annotations

import math
from collections.abc import Iterator

from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.joints.common import has_axis, kind
from kinetostat.lint.subject import Subject, first, name_of, vector
from kinetostat.urdf.document import Element
from kinetostat.urdf.reader import SMALLEST_AXIS

__all__ = ["AXES"]

_UNIT = 1e-3  # how far from 1 a length written with few digits may be
_GOOD = Example("""
    <link name="base"/>
    <link name="arm"/>
    <joint name="shoulder" type="continuous">
      <parent link="base"/><child link="arm"/>
      <axis xyz="0 0 1"/>
    </joint>""")


def _axes(subject: Subject) -> Iterator[tuple[Element, Element, tuple[float, ...], float]]:
    """Yield each joint whose axis has a meaning and can be read: joint, element, axis, its length."""
    for joint in filter(has_axis, subject.joints):
        element = first(joint, "axis")
        axis = vector(element, "xyz", 3)
        if element is not None and axis is not None:
            yield joint, element, axis, math.hypot(*axis)


class ZeroAxis(Rule):
    """The axis of a joint is zero.

    Such an axis has no direction. MuJoCo and Drake refuse the file; Pinocchio loads it in silence and gives a joint
    that does not move anything, or numbers that are not finite; yourdfpy divides by zero.
    """

    code = "J201"
    name = "axis-zero"
    severity = Severity.ERROR
    hint = "write 0 0 1, or another direction"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="continuous">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 0"/> <!-- J201 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each axis without a direction."""
        for joint, element, _, length in _axes(subject):
            if length < SMALLEST_AXIS:
                size = f" (its length is {length:.2g})" if length else ""
                yield self.finding(element, f"the axis of a {kind(joint)} joint is zero{size}", attribute="xyz")


class AxisNotUnit(Rule):
    """The axis of a joint is not a unit vector.

    Some tools take its direction only; others, as yourdfpy for a prismatic joint, take its length, too: the joint then
    moves by more or less than its position says.
    """

    code = "J202"
    name = "axis-not-unit"
    severity = Severity.WARNING
    hint = "divide the axis by its length"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="continuous">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 2"/> <!-- J202 -->
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each axis whose length is not 1."""
        for _, element, _, length in _axes(subject):
            if length >= SMALLEST_AXIS and abs(length - 1) > _UNIT:
                yield self.finding(element, f"the axis has length {length:.6g}, not 1", attribute="xyz")


class MissingAxis(Rule):
    """A joint that needs an axis has none.

    URDF's default is 1 0 0, in the frame of the joint; whoever leaves the axis out often expects z.
    """

    code = "J203"
    name = "axis-missing"
    severity = Severity.WARNING
    hint = 'write <axis xyz="1 0 0"/> if that is meant'
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="continuous"> <!-- J203 -->
          <parent link="base"/><child link="arm"/>
        </joint>""")
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each joint without an axis."""
        for joint in filter(has_axis, subject.joints):
            if first(joint, "axis") is None:
                yield self.finding(joint, f"a {kind(joint)} joint without <axis>: URDF's default 1 0 0 holds")


class AxisWithoutEffect(Rule):
    """A fixed or floating joint has an axis.

    It has no effect, and exporters write it as a matter of course; but it may also be what is left of a joint that was
    meant to move. One finding for the robot. An axis of zeros is not counted, nor a fixed joint that other rules name:
    a follower (J306), or one that a transmission drives (N301).
    """

    code = "J204"
    name = "axis-without-effect"
    severity = Severity.INFO
    hint = "leave it out, or give the joint the type that was meant"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="mount" type="fixed">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/> <!-- J204 -->
        </joint>""")
    good = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="mount" type="fixed">
          <parent link="base"/><child link="arm"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield one finding for all axes that have no effect."""
        found, driven = [], _driven(subject)
        for joint in subject.joints:
            axis = first(joint, "axis")
            if kind(joint) not in ("fixed", "floating") or axis is None or not any(vector(axis, "xyz", 3) or ()):
                continue
            named = first(joint, "mimic") is not None or (kind(joint) == "fixed" and name_of(joint) in driven)
            if not named:
                message = f"the axis of a {kind(joint)} joint has no effect"
                found.append(Found(axis, name_of(joint), message, "xyz"))
        yield from grouped(self, found, what="joint", few=1)


def _driven(subject: Subject) -> set[str]:
    """Return the names of the joints that transmissions drive."""
    return {name_of(each) for block in subject.root.all("transmission") for each in block.all("joint")}


AXES: tuple[Rule, ...] = (ZeroAxis(), AxisNotUnit(), MissingAxis(), AxisWithoutEffect())
"""The rules, in the order of their codes."""
