"""X3xx: are the numbers numbers, as many as there should be, and in the units of URDF?"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

from kinetostat.errors import quote
from kinetostat.lint.expressions import has_expression
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.schema import Number, Part, parts
from kinetostat.lint.subject import Subject, once, vector
from kinetostat.urdf.document import Element
from kinetostat.urdf.reader import MAX_ANGLE, MAX_LENGTH, SMALLEST_AXIS
from kinetostat.urdf.reading import as_number, words

__all__ = ["NUMBERS"]


def _arm(origin: str) -> Example:
    return Example(f"""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          {origin}
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-1.5" upper="1.5" effort="10" velocity="1"/>
        </joint>""")


_GOOD = _arm('<origin xyz="0 0 0.5" rpy="0 0 1.5"/>')


class NotANumber(Rule):
    """A number does not parse, or is NaN.

    Readers differ in what they make of it: a refusal, a zero, or all that stands before the first odd character, so
    that `0,5` is 0. Only plain decimals are read everywhere.
    """

    code = "X301"
    name = "not-a-number"
    severity = Severity.ERROR
    hint = "write a plain decimal number"
    bad = _arm('<origin xyz="0 0 0,5"/> <!-- X301 -->')
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each attribute with a word that is no number."""
        for odd in _odd(subject):
            wrong = [word for word, value in zip(odd.words, odd.values, strict=True) if value is None]
            if wrong:
                others = f", and {len(wrong) - 1} more" if len(wrong) > 1 else ""
                message = f"{quote(wrong[0])} is not a number{others}" if wrong[0] else "it is empty"
                yield self.finding(
                    odd.element,
                    f"{odd.key}: {message}",
                    hint=_remedy(wrong[0]),
                    severity=odd.severity,
                    attribute=odd.key,
                )


_REMEDIES = (
    (r"[+-]?(nan|1\.#(qnan|ind|inf).*)", "a computation has failed before: write the number that was meant"),
    (r".*\u00a0.*", "write common blanks, not no-break spaces"),
    (r"[^,]*,[^,]*", "write a decimal point, not a comma, and blanks between numbers"),
    (r".*[,;].*", "write blanks between numbers, not commas"),
    (r"[+-]?0x[0-9a-f]+", "write it as a decimal number"),
    (r"[0-9.+-]+d[0-9+-]+", "write e for the exponent, not d"),
    (r".*\bpi\b.*", "write the value: URDF does not know pi"),
    (
        r"[0-9.e+-]+ *(\u00b0|deg|degrees?|rad|m|cm|mm|kg|g|nm|n)",
        "write the number alone, in SI units",
    ),
    (r".*[0-9)] *[*/+-] *[0-9(].*", "write the value: URDF does not compute"),
)


def _remedy(word: str) -> str | None:
    """Return what to do about a word that is no number."""
    return next((hint for pattern, hint in _REMEDIES if re.fullmatch(pattern, word[:200].lower())), None)


class VectorLength(Rule):
    """A vector has more or fewer numbers than it should.

    Two numbers for a placement say nothing of the third; readers refuse the file or drop the element around.
    """

    code = "X302"
    name = "vector-length"
    severity = Severity.ERROR
    hint = "write as many numbers as it has, with blanks between them"
    bad = _arm('<origin xyz="0 0.5"/> <!-- X302 -->')
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each attribute that has another count of numbers."""
        for odd in _odd(subject):
            count = len(odd.values)
            if count != odd.kind.size and None not in odd.values:
                text = quote(odd.element.attributes[odd.key].strip())
                message = f"{odd.key}={text} has {count} number{'s' * (count != 1)}, not {odd.kind.size}"
                yield self.finding(odd.element, message, severity=odd.severity, attribute=odd.key)


class NumberTooLarge(Rule):
    """A number is infinite, or so large that nothing can be computed with it.

    Sums of such a number with others lose the others, and products overflow. A limit may be infinite: it is judged with
    the joints.
    """

    code = "X303"
    name = "number-too-large"
    severity = Severity.ERROR
    hint = "check the number and its unit"
    bad = _arm('<origin xyz="0 0 1e300"/> <!-- X303 -->')
    good = _GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each attribute with such a number."""
        for odd in _odd(subject):
            for word, value in zip(odd.words, odd.values, strict=True):
                written = "inf" in word.lower()  # and not 1e400
                if value is None or _fits(value, odd.kind) or (written and odd.kind.infinite):
                    continue
                what = "is infinite" if written else "is too large"
                bound = f"; at most {odd.kind.largest:g} is read" if odd.kind.largest < math.inf else ""
                yield self.finding(odd.element, f"{odd.key}: {quote(word)} {what}{bound}", attribute=odd.key)
                break


class AngleInDegrees(Rule):
    """An angle of a placement is more than a full turn; perhaps it is in degrees.

    rpy="90 0 0" is 14 turns and 2.04 rad. No reader complains, and the part simply stands askew.
    """

    code = "X304"
    name = "angle-in-degrees"
    severity = Severity.WARNING
    hint = "write radians: degrees times pi / 180"
    bad = _arm('<origin xyz="0 0 0.5" rpy="90 0 0"/> <!-- X304 -->')
    good = _GOOD
    turn: ClassVar = 2 * math.pi + 1e-3

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each placement with such an angle, unless it is a multiple of a quarter turn in radians."""
        for element, _ in parts(subject):
            if element.tag != "origin" or (angles := vector(element, "rpy", 3)) is None:
                continue
            largest = max(angles, key=abs)
            if self.turn < abs(largest) <= MAX_ANGLE and not self._is_turns(largest):
                message = f"rpy={quote(element.attributes['rpy'].strip())}: {largest:g} rad is more than a turn"
                yield self.finding(element, f"{message}; {_right(largest)}", attribute="rpy")

    @staticmethod
    def _is_turns(angle: float) -> bool:
        """Return whether an angle has been added up in radians: 12.566 is, 180 is not."""
        return angle != round(angle) and abs(math.remainder(angle, math.pi / 2)) < 2e-3


def _right(angle: float) -> str:
    """Return what an angle is in degrees' stead, or what it comes down to."""
    if angle % 15 == 0:
        return f"{angle:g} degrees are {math.radians(angle):.6g} rad"
    return f"it comes down to {math.remainder(angle, 2 * math.pi):.6g} rad"


class LengthInMillimetres(Rule):
    """A joint or a centre of mass is placed more than 100 m away, perhaps in millimetres.

    Geometry is then a thousand times too large, or the robot falls apart into far separate bodies; torques of gravity
    grow with it.
    """

    code = "X305"
    name = "length-in-millimetres"
    severity = Severity.WARNING
    hint = "write metres"
    bad = _arm('<origin xyz="0 0 333"/> <!-- X305 -->')
    good = _GOOD
    longest: ClassVar = 100.0

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the first such placement of a robot, with the number of them and the largest."""
        far = list[tuple[float, Element]]()
        for element, _ in parts(subject):
            above = element.parent
            if element.tag != "origin" or above is None or above.tag in {"visual", "collision"}:
                continue
            xyz = vector(element, "xyz", 3)
            if xyz is not None and self.longest < max(map(abs, xyz)) <= MAX_LENGTH:
                far.append((max(map(abs, xyz)), element))
        if far:
            largest, count = max(size for size, _ in far), len(far)
            more = f", and {count - 1} more beyond {self.longest:g} m, up to {largest:g} m" if count > 1 else ""
            yield self.finding(far[0][1], f"a placement {far[0][0]:g} m away{more}", attribute="xyz")


class OddQuaternion(Rule):
    """A quaternion is zero, or not of length 1.

    A zero one is no rotation at all. Another length is mended by readers that normalise, and stretches the robot in
    those that do not; most often it tells of w in the wrong place or of a digit lost.
    """

    code = "X306"
    name = "odd-quaternion"
    severity = Severity.WARNING
    hint = "write a unit quaternion, x y z w"
    bad = Example("""
        <robot name="example" version="1.1">
          <link name="base"/>
          <link name="tool"/>
          <joint name="flange" type="fixed">
            <parent link="base"/><child link="tool"/>
            <origin xyz="0 0 0.1" quat_xyzw="0 0 1 1"/> <!-- X306 -->
          </joint>
        </robot>""")
    good = Example("""
        <robot name="example" version="1.1">
          <link name="base"/>
          <link name="tool"/>
          <joint name="flange" type="fixed">
            <parent link="base"/><child link="tool"/>
            <origin xyz="0 0 0.1" quat_xyzw="0 0 0.7071 0.7071"/>
          </joint>
        </robot>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each such quaternion."""
        for element, _ in parts(subject):
            quaternion = vector(element, "quat_xyzw", 4) if element.tag == "origin" else None
            if quaternion is None:
                continue
            length = math.hypot(*quaternion)
            if length < SMALLEST_AXIS:
                message = "the quaternion is zero: it is no rotation"
                yield self.finding(element, message, severity=Severity.ERROR, attribute="quat_xyzw")
            elif abs(length - 1) > 1e-3 and length < MAX_LENGTH:
                yield self.finding(element, f"the quaternion has length {length:.6g}, not 1", attribute="quat_xyzw")


# --- what the rules share ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Odd:
    """An attribute that is not as many finite numbers as it should be: its words, their values (None: no number)."""

    element: Element
    part: Part
    key: str
    kind: Number
    words: Sequence[str]
    values: Sequence[float | None]

    @property
    def severity(self) -> Severity | None:
        """The severity of its findings; None for the rule's."""
        return Severity.WARNING if self.part.cosmetic else None


@once
def _odd(subject: Subject) -> Sequence[_Odd]:
    """Return the odd attributes, without those that are xacro; found once for each subject."""
    return [
        _Odd(element, part, key, kind, found, values)
        for element, part in parts(subject)
        for key, kind in part.numbers.items()
        if (text := element.attributes.get(key)) is not None
        for found in [_words(text, kind)]
        for values in [[as_number(word) for word in found]]
        if len(values) != kind.size or not all(value is not None and _fits(value, kind) for value in values)
        if not has_expression(text)
    ]


def _words(text: str, kind: Number) -> list[str]:
    """Return the words that are to be numbers: of a single number all the text is one."""
    return [text.strip(" \t\r\n")] if kind.size == 1 else words(text)


def _fits(value: float, kind: Number) -> bool:
    return abs(value) <= kind.largest and math.isfinite(value)


NUMBERS: tuple[Rule, ...] = (
    NotANumber(),
    VectorLength(),
    NumberTooLarge(),
    AngleInDegrees(),
    LengthInMillimetres(),
    OddQuaternion(),
)
