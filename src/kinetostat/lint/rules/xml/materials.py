"""X2xx: materials, which bear on looks alone."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from kinetostat.errors import cut, quote
from kinetostat.lint.expressions import has_expression
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.schema import parts
from kinetostat.lint.subject import Subject, first, name_of, vector
from kinetostat.urdf.document import Element

__all__ = ["MATERIALS"]

_BOX = "<geometry><box size='1 1 1'/></geometry>"
_GOOD = Example(f"""
    <material name="red"><color rgba="1 0 0 1"/></material>
    <link name="base"><visual>{_BOX}<material name="red"/></visual></link>
    <link name="arm"><visual>{_BOX}<material name="red"><color rgba="1.0 0 0 1"/></material></visual></link>""")


class UndefinedMaterial(Rule):
    """A visual refers to a material that is defined nowhere.

    Readers show the shape in a colour of their own; some (older urdfdom) refuse the file.
    """

    code = "X210"
    name = "undefined-material"
    severity = Severity.WARNING
    hint = 'give it a <color rgba="..."/>, or define it right inside <robot>'
    good = _GOOD
    bad = Example(f"""
        <link name="base"><visual>
          {_BOX}
          <material name="red"/> <!-- X210 -->
        </visual></link>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each such material once, where it is first used."""
        materials = _materials(subject)
        defined = {name_of(each) for each in materials if each.children}
        first_use, count = dict[str, Element](), Counter[str]()
        for each in materials:
            name = name_of(each)
            if name and name not in defined and not has_expression(name) and each.parent is not subject.root:
                first_use.setdefault(name, each)
                count[name] += 1
        for name, each in first_use.items():
            times = f", in {count[name]} visuals" if count[name] > 1 else ""
            yield self.finding(each, f"the material is defined nowhere{times}", attribute="name")


class RepeatedMaterial(Rule):
    """A material is defined again: right inside the robot, or with another colour.

    urdfdom, and so every ROS tool and Pinocchio, refuses a file that defines one twice right inside `<robot>`, and so
    does Drake; MuJoCo, PyBullet and yourdfpy take it. Where visuals define the same name in several colours, readers
    that know materials by name give all of them the first.
    """

    code = "X211"
    name = "repeated-material"
    severity = Severity.WARNING
    hint = "keep one definition, or give the other another name"
    good = _GOOD
    bad = Example("""
        <material name="red"><color rgba="1 0 0 1"/></material>
        <material name="red"><color rgba="0.8 0 0 1"/></material> <!-- X211 -->
        <link name="base"/>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each definition that comes again, or contradicts the first (once for each name)."""
        top, colours, told = dict[str, Element](), dict[str, tuple[float, ...]](), set[str]()
        for each in _materials(subject):
            name, colour = name_of(each), vector(first(each, "color"), "rgba", 4)
            if not name:
                continue
            if each.parent is subject.root and name in top:
                told.add(name)
                yield self.finding(each, f"the material is already defined at line {top[name].line}", attribute="name")
            elif colour is not None and colours.get(name, colour) != colour and name not in told:
                told.add(name)
                message = f"rgba {_shown(colour)} here, {_shown(colours[name])} where it is first defined"
                yield self.finding(each, message, severity=Severity.INFO)
            if each.parent is subject.root:
                top.setdefault(name, each)
            if colour is not None:
                colours.setdefault(name, colour)


class ColourRange(Rule):
    """A colour has a part outside of 0 to 1.

    The four parts, opacity last, are fractions. Of `255 0 0 255` some readers make white, some refuse the material.
    """

    code = "X212"
    name = "colour-range"
    severity = Severity.WARNING
    hint = "divide by 255, if these are bytes"
    good = _GOOD
    bad = Example("""
        <material name="red">
          <color rgba="255 0 0 1"/> <!-- X212 -->
        </material>
        <link name="base"/>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each such colour."""
        for element in (first(each, "color") for each in _materials(subject)):
            rgba = vector(element, "rgba", 4)
            if element is not None and rgba is not None and not all(0 <= part <= 1 for part in rgba):
                message = f"rgba={quote(element.attributes['rgba'])} is not within 0 to 1"
                yield self.finding(element, message, attribute="rgba")


def _materials(subject: Subject) -> list[Element]:
    return [element for element, _ in parts(subject) if element.tag == "material"]


def _shown(colour: tuple[float, ...]) -> str:
    return cut(" ".join(f"{part:g}" for part in colour))


MATERIALS: tuple[Rule, ...] = (UndefinedMaterial(), RepeatedMaterial(), ColourRange())
