"""I3: masses and moments against the size of links that are drawn with primitives. Silent where there is a mesh."""

from __future__ import annotations

import math
from collections.abc import Iterator

from kinetostat.lint.bodies import LinkInertia, bodies_of
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.inertia.suspicions import is_placeholder, placeholders
from kinetostat.lint.shapes import Extent, extents_of
from kinetostat.lint.subject import Subject, first
from kinetostat.lint.tensors import NO_MASS, Flaw

__all__ = ["EXTENTS"]

BEYOND = 1.5  # times half the diagonal of the box: no mass inside has a larger radius of gyration than 1
INSIDE = 0.1  # times half the diagonal: a ball inside its box has 0.37
DENSEST = 25_000.0  # kg/m3 in the whole box: osmium has 22,600
LIGHTEST = 1.0  # kg/m3 in the shapes: less than air
STAND_IN = 0.02  # m: a smaller shape marks a place; the part itself is not drawn
OUTSIDE = 0.25  # of half the diagonal of the box, for parts that are not drawn
_TOLD = 1e12  # kg/m3: a shape in which the mass is denser has no volume to divide by

_SIZES = "the radius of gyration is"


def _drawn(subject: Subject) -> Iterator[tuple[LinkInertia, Extent]]:
    """Yield the links that have a mass, count in their body, and are drawn with primitives only."""
    bodies, extents = bodies_of(subject), extents_of(subject)
    for each in bodies.inertias.values():
        if each.mass > NO_MASS and not bodies.negligible(each):
            extent = extents.get(each.name)
            if extent is not None and max(extent.sides) > STAND_IN:
                yield each, extent


def _box(extent: Extent) -> str:
    return " x ".join(f"{side:.3g}" for side in extent.sides) + " m"


def _example(
    *, mass: str = "2", xyz: str = "0 0 0.2", across: str = "0.027", along: str = "0.001", **marks: str
) -> Example:
    """Return a robot for an example: an arm of 0.4 m, drawn as a box; a code by the part that it is to point at."""
    place, weight, tensor = (
        f" <!-- {marks[at]} -->" if at in marks else "" for at in ("at_place", "at_mass", "at_tensor")
    )
    return Example(f"""
        <link name="base"/>
        <link name="arm">
          <inertial>
            <origin xyz="{xyz}"/>{place}
            <mass value="{mass}"/>{weight}
            <inertia ixx="{across}" ixy="0" ixz="0" iyy="{across}" iyz="0" izz="{along}"/>{tensor}
          </inertial>
          <collision><origin xyz="0 0 0.2"/><geometry><box size="0.06 0.06 0.4"/></geometry></collision>
        </link>
        <joint name="shoulder" type="continuous"><parent link="base"/><child link="arm"/></joint>""")


class GyrationOutside(Rule):
    """A radius of gyration reaches beyond the shape of its link.

    No mass inside a box has a radius of gyration larger than half the box's diagonal. The moments are too large: in
    another unit, about another point, or made up.
    """

    code = "I301"
    name = "gyration-outside"
    severity = Severity.WARNING
    hint = "the moments are kg m2 about the centre of mass; or is the shape a stand-in?"
    bad = _example(across="0.5", at_tensor="I301")
    good = _example()

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each tensor that is too large for its link's shape."""
        known = placeholders(bodies_of(subject))
        found = []
        for each, extent in _drawn(subject):
            usable = each.flaw in (None, Flaw.ROUNDED) and not is_placeholder(each, known)
            if usable and each.gyration > BEYOND * extent.half_diagonal:
                message = f"{_SIZES} {each.gyration:.3g} m in a shape of {_box(extent)}"
                found.append(Found(each.element, each.name, message))
        yield from grouped(self, found, what="link")


class GyrationInside(Rule):
    """A radius of gyration is far smaller than the shape of its link.

    All the mass would sit close to one point. It may be so, of a heavy motor in a light housing; often the moments are
    in another unit, or made up.
    """

    code = "I302"
    name = "gyration-small"
    severity = Severity.INFO
    hint = "the moments are kg m2 about the centre of mass"
    bad = _example(mass="0.2", across="3e-5", along="3e-5", at_tensor="I302")
    good = _example()

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each tensor that is far too small for its link's shape."""
        known = placeholders(bodies_of(subject))
        found = []
        for each, extent in _drawn(subject):
            usable = each.flaw in (None, Flaw.ROUNDED) and not is_placeholder(each, known)
            if usable and each.gyration < INSIDE * extent.half_diagonal:
                message = f"{_SIZES} {each.gyration:.3g} m in a shape of {_box(extent)}"
                found.append(Found(each.element, each.name, message))
        yield from grouped(self, found, what="link")


class ImplausibleDensity(Rule):
    """A link is denser than any metal, or lighter than air.

    Mass and shape do not belong together: grams for kilograms, millimetres for metres, or a mass that was made up.
    """

    code = "I303"
    name = "density-implausible"
    severity = Severity.WARNING
    hint = "masses are kilograms, lengths metres; or is the shape a stand-in?"
    bad = _example(mass="200", across="2.7", along="0.1", at_mass="I303")
    good = _example()

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each mass that does not fit its link's shape; an info where it is too light."""
        heavy, light = [], []
        for each, extent in _drawn(subject):
            volume = math.prod(extent.sides)
            mass = first(each.link, "inertial", "mass") or each.link
            message = f"mass {each.mass:g} kg in a shape of {_box(extent)}"
            if each.mass > DENSEST * volume:
                density = f"{each.mass / volume:,.0f} kg/m3" if each.mass < volume * _TOLD else "no volume to speak of"
                heavy.append(Found(mass, each.name, f"{message}: {density}", "value"))
            elif each.mass < LIGHTEST * extent.volume:
                light.append(Found(mass, each.name, f"{message}: {each.mass / extent.volume:.2g} kg/m3", "value"))
        yield from grouped(self, heavy, what="link")
        yield from grouped(self, light, what="link", severity=Severity.INFO)


class CentreOutside(Rule):
    """The centre of mass lies outside the shape of its link.

    The centre of mass of a body lies inside any box that holds the body. Mostly a sign is wrong, or the point is given
    in another frame or unit; loads by gravity are wrong with it.
    """

    code = "I304"
    name = "centre-outside"
    severity = Severity.WARNING
    hint = "the <origin> of <inertial> is the centre of mass in the link's frame, in metres"
    bad = _example(xyz="0 0 -0.2", at_place="I304")
    good = _example()

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each centre of mass that is clearly outside the box around its link's shapes."""
        found = []
        for each, extent in _drawn(subject):
            beyond = extent.outside(each.centre)
            if beyond > OUTSIDE * extent.half_diagonal:
                place = " ".join(f"{x:.4g}" for x in each.centre)
                message = f"centre of mass {place} is {beyond:.3g} m outside the shape of {_box(extent)}"
                inertial = first(each.link, "inertial")
                at = first(inertial, "origin") or inertial or each.link
                found.append(Found(at, each.name, message, "xyz"))
        yield from grouped(self, found, what="link")


EXTENTS: tuple[Rule, ...] = (GyrationOutside(), GyrationInside(), ImplausibleDensity(), CentreOutside())
