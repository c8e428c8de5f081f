"""X2xx: is all there that must be?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from kinetostat.errors import cut
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.schema import parts
from kinetostat.lint.spelling import Speller
from kinetostat.lint.subject import Subject

__all__ = ["MISSING"]

_ARM = """
    <link name="base"/>
    <link name="arm"/>
    <joint name="shoulder" type="revolute">
      <parent link="base"/><child link="arm"/>
      <axis xyz="0 0 1"/>
      <limit lower="-1.5" upper="1.5" effort="10" velocity="1"/>
    </joint>"""


class MissingAttribute(Rule):
    """An attribute is missing that must be there.

    Readers refuse the file, or drop the element around: a shape without its size, a mesh without its file. The dynamics
    of a joint need damping or friction, or urdfdom refuses the file.
    """

    code = "X206"
    name = "missing-attribute"
    severity = Severity.ERROR
    hint = "write it, with your value"
    bad = Example("""
        <link name="base">
          <collision>
            <geometry><cylinder radius="0.1" lenght="0.5"/></geometry> <!-- X206 -->
          </collision>
        </link>""")
    good = Example("""
        <link name="base">
          <collision>
            <geometry><cylinder radius="0.1" length="0.5"/></geometry>
          </collision>
        </link>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each element that lacks attributes, with their names."""
        speller = Speller()
        for element, part in parts(subject):
            given = element.attributes
            missing = [key for key in part.needed if key not in given or (key == "name" and not given[key])]
            if element.tag == "material" and "name" in given:
                missing = []  # an empty name is what exporters give a colour of a single visual
            if part.either and not any(key in given for key in part.either):
                missing.append(" and no ".join(part.either))
            if missing:
                severity = Severity.WARNING if part.cosmetic else None
                unknown = (key for key in given if key not in part.known_attributes)
                near = next((key for key in unknown if speller.meant(key, frozenset(missing))), None)
                hint = f"did you mean it by {cut(near)}=?" if near else None
                message, at = f"no {', '.join(missing)}", element
                if element.tag == "mimic" and element.parent is not None:  # the reader speaks of the joint
                    message, at = f"a mimic with {message}", element.parent
                yield self.finding(at, message, hint=hint, severity=severity)


class MissingElement(Rule):
    """An element is missing that must be there.

    A joint without both ends is no joint, and every reader refuses the file; a visual, collision or geometry without
    its shape is dropped by some readers and stops others.
    """

    code = "X207"
    name = "missing-element"
    severity = Severity.ERROR
    hint = "write it, or remove the element around"
    bad = Example("""
        <link name="base">
          <collision> <!-- X207 -->
            <origin xyz="0 0 1"/>
          </collision>
        </link>""")
    good = Example(_ARM)

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each element that lacks what must be in it."""
        speller = Speller()
        for element, part in parts(subject):
            inside = {child.tag for child in element.children}
            missing = [f"<{tag}>" for tag in part.required if tag not in inside]
            if part.choice and not element.children:
                missing.append(_one_of(part.choice))
            if not missing:
                continue
            unknown = (child.tag for child in element.children if child.tag not in part.known_children)
            near = next((tag for tag in unknown if speller.meant(tag, frozenset(part.required))), None)
            hint = f"did you mean it by <{cut(near)}>?" if near else None
            severity = Severity.WARNING if part.cosmetic else None
            yield self.finding(element, f"no {', no '.join(missing)}", hint=hint, severity=severity)


def _one_of(tags: Sequence[str]) -> str:
    named = " or ".join(f"<{tag}>" for tag in tags[:2])
    return f"{named}, or another shape" if len(tags) > 2 else named


MISSING: tuple[Rule, ...] = (MissingAttribute(), MissingElement())
