"""M204 to M207: primitive shapes, and links that cannot be seen or touched."""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.errors import cut
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import FEW, listed
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.subject import Subject, name_of, number, vector
from kinetostat.urdf.document import Element

__all__ = ["SHAPES"]

_SIZES = {"box": ("size",), "sphere": ("radius",), "cylinder": ("radius", "length"), "capsule": ("radius", "length")}


def _example(shapes: str, mark: str = "") -> Example:
    end = f" <!-- {mark} -->" if mark else ""
    return Example(f"""
        <link name="base">
          <collision>
            <geometry>{shapes}</geometry>{end}
          </collision>
        </link>""")


def _geometries(subject: Subject) -> Iterator[Element]:
    """Yield the geometries of links, in file order."""
    for link in subject.links:
        for shape in link.children:
            if shape.tag in ("visual", "collision"):
                yield from shape.all("geometry")


def _primitives(subject: Subject) -> Iterator[Element]:
    """Yield the first shape of each geometry that is a primitive: others do not count."""
    for geometry in _geometries(subject):
        if geometry.children and geometry.children[0].tag in _SIZES:
            yield geometry.children[0]


class BadSize(Rule):
    """A box, a sphere, a cylinder or a capsule has a size of zero or less.

    A size of zero leaves nothing to see or to touch, and some simulators refuse it; a negative one has no meaning in
    any tool.
    """

    code = "M204"
    name = "size-not-positive"
    severity = Severity.ERROR
    hint = "write its size in metres, or remove the shape"
    bad = _example('<sphere radius="-0.1"/>', "M204")
    good = _example('<sphere radius="0.1"/>')

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each shape with a size that is not positive; one of zero is a warning."""
        for shape in _primitives(subject):
            for key in _SIZES[shape.tag]:
                sizes = vector(shape, key, 3) if key == "size" else [number(shape, key)]
                bad = [size for size in sizes or () if size is not None and size <= 0]
                if bad:
                    shown = cut(shape.attributes[key])
                    message = f"{key} {shown} m is {'negative' if min(bad) < 0 else 'zero'}"
                    severity = None if min(bad) < 0 else Severity.WARNING
                    yield self.finding(shape, message, attribute=key, severity=severity)


class TwoShapes(Rule):
    """A geometry holds more than one shape.

    Readers take the first, or the last, and forget the others without a word. Each shape needs a `<collision>` or
    `<visual>` of its own.
    """

    code = "M205"
    name = "two-shapes"
    severity = Severity.WARNING
    hint = "write a <collision> or <visual> for each shape"
    bad = _example('<box size="1 1 1"/><sphere radius="0.5"/>', "M205")
    good = _example('<box size="1 1 1"/>')

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each geometry with several shapes."""
        for geometry in _geometries(subject):
            tags = [child.tag for child in geometry.children if child.tag in (*_SIZES, "mesh")]
            if len(tags) > 1:
                yield self.finding(geometry, f"{len(tags)} shapes in one geometry: {', '.join(tags[:FEW])}")


def _bare(subject: Subject, there: str, lacking: str) -> tuple[list[Element], str]:
    """Return the links that have one sort of geometry and not the other, and what to say of them."""
    having = [link for link in subject.links if link.all(there)]
    links = [link for link in having if not link.all(lacking)]
    if len(links) == 1:
        return links, f"a {there} and no {lacking} geometry"
    if len(links) == len(having):
        return links, f"none of the {len(having)} links with a {there} has a {lacking} geometry"
    names = listed([name_of(link) for link in links])
    return links, f"{len(links)} links have a {there} and no {lacking} geometry: {names}"


class NoCollision(Rule):
    """A link can be seen, but nothing can touch it.

    Planners and simulators let other things pass through it. That may be meant, of a camera or a sticker; it is worth
    knowing of an arm.
    """

    code = "M206"
    name = "collision-missing"
    severity = Severity.INFO
    hint = "add a <collision>, a primitive shape will often do"
    bad = Example("""
        <link name="base"> <!-- M206 -->
          <visual><geometry><box size="1 1 1"/></geometry></visual>
        </link>""")
    good = Example("""
        <link name="base">
          <visual><geometry><box size="1 1 1"/></geometry></visual>
          <collision><geometry><box size="1 1 1"/></geometry></collision>
        </link>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield one finding for the robot."""
        links, message = _bare(subject, "visual", "collision")
        if links:
            yield self.finding(links[0], message)


class NoVisual(Rule):
    """A link can be touched, but not seen.

    Viewers show a gap where there is a body, and whoever plans beside it does not see what the motion avoids.
    """

    code = "M207"
    name = "visual-missing"
    severity = Severity.INFO
    hint = "add a <visual>, the collision shape will often do"
    bad = Example("""
        <link name="base"> <!-- M207 -->
          <collision><geometry><box size="1 1 1"/></geometry></collision>
        </link>""")
    good = Example("""
        <link name="base">
          <visual><geometry><box size="1 1 1"/></geometry></visual>
          <collision><geometry><box size="1 1 1"/></geometry></collision>
        </link>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield one finding for the robot."""
        links, message = _bare(subject, "collision", "visual")
        if links:
            yield self.finding(links[0], message)


SHAPES: tuple[Rule, ...] = (BadSize(), TwoShapes(), NoCollision(), NoVisual())
