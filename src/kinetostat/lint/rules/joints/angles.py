"""J205 and J206: is a right angle a right angle?"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.joints.common import has_axis
from kinetostat.lint.subject import Subject, first, name_of, vector
from kinetostat.urdf.document import Element
from kinetostat.urdf.reader import MAX_ANGLE
from kinetostat.urdf.reading import words

__all__ = ["ANGLES"]

_EXACT = 1e-9  # rad: an axis that is closer to a coordinate axis is it
_HARMLESS = 1e-7  # rad: what is closer to a round angle displaces nothing, by 0.1 um at 1 m
_NEARLY = 1e-3  # rad: an axis that is farther from a coordinate axis is meant so
_PARTS = 12  # of pi: angles in steps of 15 degrees are round
_DECIMAL = re.compile(r"[+-]?[0-9]*\.([0-9]+)")
_FIGURES = {True: 2, False: 3}  # decimals that an angle must have to be told from a measured one: right angle, other


@dataclass(frozen=True)
class _Rounded:
    """An angle as it is written, the part of pi that is meant, and how far off it is, in rad."""

    origin: Element
    text: str
    meant: Fraction
    off: float

    @property
    def exact(self) -> str:
        """The angle that is meant: pi/2, -3 pi/4."""
        count = abs(self.meant.numerator)
        over = f"/{self.meant.denominator}" if self.meant.denominator > 1 else ""
        return f"{'-' if self.meant < 0 else ''}{f'{count} ' if count > 1 else ''}pi{over}"


class RoundedAngles(Rule):
    """Joints are placed by angles that are rounded: 1.5708 for pi/2, 3.14 for pi.

    A robot whose axes are parallel, perpendicular or meet in a point is then not quite such a robot. Its closed inverse
    kinematics misses the pose by the rounding, exact singularities become nearly singular, and symmetric limbs differ.
    kinetostat judges such a file with a coarser tolerance. An angle with seven digits after the point is good enough.
    """

    code = "J205"
    name = "rounded-angles"
    severity = Severity.INFO
    hint = "write all digits: 1.5707963267948966 for pi/2, 3.141592653589793 for pi"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="continuous">
          <parent link="base"/><child link="arm"/>
          <origin xyz="0 0 0.3" rpy="1.5708 0 0"/> <!-- J205 -->
          <axis xyz="0 0 1"/>
        </joint>""")
    good = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="continuous">
          <parent link="base"/><child link="arm"/>
          <origin xyz="0 0 0.3" rpy="1.57079632679 0 0"/>
          <axis xyz="0 0 1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield one finding for all rounded angles of the robot."""
        found = [each for joint in subject.joints for each in _rounded_angles(joint)]
        if not found:
            return
        message = f"{found[0].text} is {found[0].off:.2g} rad off {found[0].exact}"
        worst = max(found, key=lambda each: each.off)
        if len(found) > 1:
            message += f"; the joints have {len(found)} rounded angles"
        if worst.off > 1.1 * found[0].off:
            message += f", the worst {worst.text} (line {worst.origin.line}), {worst.off:.2g} rad off {worst.exact}"
        yield self.finding(found[0].origin, message, attribute="rpy")


def _rounded_angles(joint: Element) -> Iterator[_Rounded]:
    """Yield the angles of a joint's placement that are round but for the digits that are not written."""
    origin = first(joint, "origin")
    angles = vector(origin, "rpy", 3)
    if origin is None or angles is None:
        return
    for text, angle in zip(words(origin.attributes["rpy"]), angles, strict=True):
        if abs(angle) > MAX_ANGLE:
            continue  # another rule says so
        steps = round(angle * _PARTS / math.pi)
        off = abs(angle - steps * math.pi / _PARTS)
        if steps and off > _HARMLESS and _is_written_for(text, steps):
            yield _Rounded(origin, text, Fraction(steps, _PARTS), off)


def _is_written_for(text: str, steps: int) -> bool:
    """Return whether a number is a part of pi, rounded or cut off after the decimals that it has."""
    match = _DECIMAL.fullmatch(text)
    decimals = len(match[1]) if match else 0
    if decimals < _FIGURES[steps % (_PARTS // 2) == 0] or decimals > 15:
        return False
    scale = 10.0**decimals
    exact, written = abs(steps) * math.pi / _PARTS * scale, round(abs(float(text)) * scale)
    # From four decimals on, a last digit that is wrong by one is a slip, not another angle.
    slip = 1 if decimals > 3 else 0
    return math.floor(exact) - slip <= written <= round(exact) + slip


class NearlyAlignedAxis(Rule):
    """The axis of a joint is nearly, but not exactly, a coordinate axis.

    What is left over from a computation, or from a rounded rotation in the exporter, makes parallel axes not parallel.
    Pinocchio takes another kind of joint for it, which is slower. An axis from a calibration is rightly so.
    """

    code = "J206"
    name = "axis-nearly-aligned"
    severity = Severity.INFO
    hint = "write 0 0 1 (or another coordinate axis), unless the axis was measured"
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="continuous">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 -4.371e-08 1"/> <!-- J206 -->
        </joint>""")
    good = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="continuous">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 6.1e-17 1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield one finding for all axes that are nearly aligned."""
        found = []
        for joint in filter(has_axis, subject.joints):
            element = first(joint, "axis")
            letter, tilt = _tilt(vector(element, "xyz", 3) or (0.0, 0.0, 0.0))
            if element is not None and _EXACT < tilt < _NEARLY:
                found.append(Found(element, name_of(joint), f"the axis is {tilt:.2g} rad off {letter}", "xyz"))
        yield from grouped(self, found, what="joint", few=1)


def _tilt(axis: tuple[float, ...]) -> tuple[str, float]:
    """Return the coordinate axis that an axis is closest to, and the angle between them; x and 0 if it is zero."""
    nearest = max(range(3), key=lambda i: abs(axis[i]))
    rest = math.hypot(*(value for i, value in enumerate(axis) if i != nearest))
    return "xyz"[nearest], math.atan2(rest, abs(axis[nearest]))


ANGLES: tuple[Rule, ...] = (RoundedAngles(), NearlyAlignedAxis())
"""The rules, in the order of their codes."""
