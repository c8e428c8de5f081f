"""X2xx: are these the elements and attributes of URDF, each where it belongs, and once?"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from kinetostat.errors import cut
from kinetostat.lint.expressions import is_old_tag
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.schema import elsewhere, parts
from kinetostat.lint.spelling import Speller
from kinetostat.lint.subject import Subject
from kinetostat.urdf.document import Element

__all__ = ["ELEMENTS"]


class UnknownElement(Rule):
    """An element is not one of URDF's, or stands where no reader looks for it.

    Readers pass over what they do not know without a word, so a misspelt `<colision>` or a `<limit>` in a link simply
    is not there. What no format known here has is reported as info: it may be an extension of your own.
    """

    code = "X203"
    name = "unknown-element"
    severity = Severity.WARNING
    hint = "remove it, or put it where it is read"
    bad = Example("""
        <link name="base">
          <colision> <!-- X203 -->
            <geometry><box size="1 1 1"/></geometry>
          </colision>
        </link>""")
    good = Example("""
        <link name="base">
          <collision>
            <geometry><box size="1 1 1"/></geometry>
          </collision>
        </link>
        <gazebo reference="base"><mu1>0.2</mu1></gazebo>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each misspelt element, and what is out of place or unknown once for each kind of place."""
        seen, speller = Counter[tuple[str, str]](), Speller()
        rest = dict[tuple[str, str], tuple[Element, str, Severity]]()
        for element, part in parts(subject):
            for child in element.children:
                if child.tag in part.known_children or ":" in child.tag or is_old_tag(child):
                    continue
                place = (element.tag, child.tag)
                home = elsewhere(child.tag)
                near = "" if home.startswith("it belongs into") else speller.meant(child.tag, part.known_children)
                if near and near in part.required and not element.all(near):
                    continue  # a misspelt one that must be there is told as missing
                if near:
                    message = f"<{cut(child.tag)}> is not known in <{cut(element.tag)}>"
                    yield self.finding(child, message, hint=f"did you mean <{near}>?")
                    continue
                seen[place] += 1
                severity = Severity.WARNING if home or part.choice else Severity.INFO
                rest.setdefault(place, (child, home, severity))
        for (tag, unknown), (child, home, severity) in rest.items():
            times = f", {seen[tag, unknown]} times" if seen[tag, unknown] > 1 else ""
            why = home or "readers of URDF pass over it"
            yield self.finding(child, f"<{cut(unknown)}> is not known in <{cut(tag)}>{times}: {why}", severity=severity)


class UnknownAttribute(Rule):
    """An attribute is not one of URDF's.

    Readers pass over what they do not know without a word: with `efort="30"` a joint has no effort limit. What is not
    known, but no misspelling either, is reported as info: your own tools may read it.
    """

    code = "X204"
    name = "unknown-attribute"
    severity = Severity.WARNING
    hint = "remove it, or correct its name"
    bad = Example("""
        <link name="base">
          <visual>
            <origin xyz="0 0 0" ryp="0 0 1.57"/> <!-- X204 -->
            <geometry><box size="1 1 1"/></geometry>
          </visual>
        </link>""")
    good = Example("""
        <link name="base">
          <visual>
            <origin xyz="0 0 0" rpy="0 0 1.57"/>
            <geometry><box size="1 1 1"/></geometry>
          </visual>
        </link>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each misspelt attribute, and unknown ones once for each kind of element."""
        seen, speller = Counter[str](), Speller()
        unknown = dict[str, tuple[Element, dict[str, None]]]()
        for element, part in parts(subject):
            if element.attributes.keys() <= part.known_attributes:
                continue
            for key in element.attributes:
                if key in part.known_attributes or ":" in key or key == "xmlns":
                    continue
                near = speller.meant(key, part.known_attributes)
                if near and near not in element.attributes:
                    if near not in part.needed:  # else it is told as missing
                        message = f"{cut(key)}= is not known in <{cut(element.tag)}>"
                        yield self.finding(element, message, hint=f"did you mean {near}=?", attribute=key)
                    continue
                unknown.setdefault(element.tag, (element, {}))[1].setdefault(key)
                seen[element.tag] += 1
        for tag, (element, keys) in unknown.items():
            named = ", ".join(f"{cut(key)}=" for key in list(keys)[:6]) + (", ..." if len(keys) > 6 else "")
            times = f", {seen[tag]} in all" if seen[tag] > len(keys) else ""
            message = f"not known in <{tag}>: {named}{times}; readers of URDF pass over them"
            yield self.finding(element, message, severity=Severity.INFO, attribute=next(iter(keys)))


class RepeatedElement(Rule):
    """An element is given twice where one is read.

    Most readers take the first and say nothing; some take the last. Which of two masses or placements holds then
    depends on the tool.
    """

    code = "X205"
    name = "repeated-element"
    severity = Severity.WARNING
    hint = "keep one of them"
    bad = Example("""
        <link name="base">
          <inertial>
            <mass value="1"/>
            <mass value="2"/> <!-- X205 -->
            <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/>
          </inertial>
        </link>""")
    good = Example("""
        <link name="base">
          <visual><geometry><box size="1 1 1"/></geometry></visual>
          <visual><geometry><sphere radius="1"/></geometry></visual>
        </link>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each element that comes again."""
        for element, part in parts(subject):
            first = dict[str, Element]()
            for child in element.children:
                if child.tag not in part.children or child.tag in part.several:
                    continue
                if child.tag in first:
                    yield self.finding(child, f"<{child.tag}> is already given at line {first[child.tag].line}")
                first.setdefault(child.tag, child)


ELEMENTS: tuple[Rule, ...] = (UnknownElement(), UnknownAttribute(), RepeatedElement())
