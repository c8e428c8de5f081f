"""I104 to I106: is an inertial complete, of a size that can be, and in proportion to its neighbours?"""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.errors import quote
from kinetostat.lint.bodies import LARGEST, Body, bodies_of, mass_of
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.inertia.masses import MissingInertial, NegativeMass
from kinetostat.lint.subject import Subject, first, name_of, number
from kinetostat.lint.tensors import MOMENTS, NO_MASS
from kinetostat.urdf.document import Element

__all__ = ["STATEMENTS"]

HEAVIEST = 1e7  # kg: ten thousand tonnes, more than the largest machines on land
UNREADABLE = 1e15  # kg: the reader refuses more
LIGHTEST = 1e-6  # kg, a milligram
HARD_RATIO = 100.0  # between bodies that a joint connects; the largest of 69 well-used robots is 91
WORST_RATIO = 1000.0  # iterative solvers fail


class IncompleteInertial(Rule):
    """An inertial lacks its mass, its tensor, or an entry of it.

    URDF needs all seven numbers: MuJoCo and PyBullet refuse a file that lacks one. urdfdom, and with it ROS and
    Pinocchio, loads the link without mass or without moments, and drops all its shapes, with a line on standard error;
    other readers take zero for what is missing.
    """

    code = "I104"
    name = "inertial-incomplete"
    severity = Severity.ERROR
    hint = 'write <mass value="..."/> and <inertia ixx="..." ixy="..." ixz="..." iyy="..." iyz="..." izz="..."/>'
    bad = Example("""
        <link name="base">
          <inertial> <!-- I104 -->
            <mass value="1"/>
          </inertial>
        </link>""")
    good = NegativeMass.good

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each inertial that lacks something."""
        for link in subject.links:
            for inertial in link.all("inertial")[:1]:
                at, missing = self._missing(inertial)
                if missing:
                    yield self.finding(at, f"no {', '.join(missing)}")

    def _missing(self, inertial: Element) -> tuple[Element, list[str]]:
        mass, inertia = first(inertial, "mass"), first(inertial, "inertia")
        lost = ["<mass>"] if mass is None else []
        lost += ["<inertia>"] if inertia is None else []
        if lost:
            return inertial, lost
        assert mass is not None
        assert inertia is not None
        if "value" not in mass.attributes:
            return mass, ["value"]
        return inertia, [key for key in MOMENTS if key not in inertia.attributes]


class AbsurdInertial(Rule):
    """A mass or a moment is so large or so small that it must be a slip.

    Ten thousand tonnes is a mass in the wrong unit or a typing slip; a body of less than a milligram between bodies of
    kilograms makes simulations stiff and slow.
    """

    code = "I105"
    name = "inertial-absurd"
    severity = Severity.WARNING
    hint = "masses are kilograms, moments kg m2"
    bad = Example("""
        <link name="base">
          <inertial>
            <mass value="2.5e9"/> <!-- I105 -->
            <inertia ixx="1e9" ixy="0" ixz="0" iyy="1e9" iyz="0" izz="1e9"/>
          </inertial>
        </link>""")
    good = NegativeMass.good

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each mass and moment that is too large, and each moving body that is too light."""
        heavy = list(self._heavy(subject))
        for unreadable in (True, False):
            found = [each for each, worst in heavy if worst is unreadable]
            yield from grouped(self, found, what="link", severity=Severity.ERROR if unreadable else None)
        for link in subject.links:
            inertia = first(link, "inertial", "inertia")
            moments = {key: value for key in MOMENTS if (value := number(inertia, key)) is not None}
            large = [key for key, moment in moments.items() if abs(moment) > LARGEST]
            if inertia is not None and large:
                message = f"{large[0]} {moments[large[0]]:g} kg m2"
                yield self.finding(inertia, message, severity=Severity.ERROR, attribute=large[0])
        yield from grouped(self, list(self._light(subject)), what="link", severity=Severity.INFO)

    def _heavy(self, subject: Subject) -> Iterator[tuple[Found, bool]]:
        for link in subject.links:
            mass, value = first(link, "inertial", "mass"), mass_of(link)
            if mass is not None and value is not None and value > HEAVIEST:
                yield Found(mass, name_of(link), f"mass {value:g} kg", "value"), value > UNREADABLE

    def _light(self, subject: Subject) -> Iterator[Found]:
        for body in bodies_of(subject).moving:
            mass = first(subject.link_elements[body.links[0]], "inertial", "mass")
            if NO_MASS < body.mass < LIGHTEST and mass is not None:
                message = f"{body.moved_by}, but its mass is {body.mass:g} kg"
                yield Found(mass, body.links[0], message, "value")


class MassRatio(Rule):
    """A joint connects a body to one that is far heavier and hangs on it.

    A light body between heavy ones makes the equations of motion ill-conditioned: iterative solvers (Bullet, ODE in
    Gazebo, PhysX) let the heavy end sag or shake, and gradients lose their digits.
    """

    code = "I106"
    name = "mass-ratio"
    severity = Severity.INFO
    hint = "correct a mass that stands for nothing, or merge the light link with its neighbour"
    bad = Example("""
        <link name="base"/>
        <link name="spacer">
          <inertial>
            <mass value="0.001"/> <!-- I106 -->
            <inertia ixx="1e-7" ixy="0" ixz="0" iyy="1e-7" iyz="0" izz="1e-7"/>
          </inertial>
        </link>
        <link name="arm">
          <inertial>
            <mass value="5"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.02"/>
          </inertial>
        </link>
        <joint name="pan" type="continuous"><parent link="base"/><child link="spacer"/></joint>
        <joint name="tilt" type="continuous"><parent link="spacer"/><child link="arm"/></joint>""")
    good = MissingInertial.good

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each moving body that carries one a hundred times as heavy; a warning from a thousand on."""
        bodies = bodies_of(subject)
        heaviest = dict[str, Body]()
        for body in bodies.moving:
            other = heaviest.get(body.parent)
            if other is None or body.mass > other.mass:
                heaviest[body.parent] = body
        for head, carried in heaviest.items():
            body = bodies.bodies[head]
            mass = first(subject.link_elements[head], "inertial", "mass")
            if body.carrier is not None and mass is not None and LIGHTEST <= body.mass < carried.mass / HARD_RATIO:
                severity = Severity.WARNING if body.mass < carried.mass / WORST_RATIO else None
                carries = f"{quote(carried.links[0], 40)} on it {carried.mass:g} kg"
                yield self.finding(mass, f"weighs {body.mass:g} kg, {carries}", severity=severity, attribute="value")


STATEMENTS: tuple[Rule, ...] = (IncompleteInertial(), AbsurdInertial(), MassRatio())
