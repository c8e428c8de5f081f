"""I1: masses. Does everything that moves weigh something, and something that can be?"""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.errors import quote
from kinetostat.lint.bodies import LARGEST, Bodies, Body, bodies_of, mass_of
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.inertia.several import several
from kinetostat.lint.subject import Subject, first, name_of, number
from kinetostat.lint.tensors import MOMENTS, NO_MASS
from kinetostat.urdf.document import Element

__all__ = ["MASSES"]

HEAVIEST = 1e7  # kg: ten thousand tonnes, more than the largest machines on land
UNREADABLE = 1e15  # kg: the reader refuses more
LIGHTEST = 1e-6  # kg, a milligram
HARD_RATIO = 100.0  # between bodies that a joint connects; the largest of 69 well-used robots is 91
WORST_RATIO = 1000.0  # iterative solvers fail


class MissingInertial(Rule):
    """A body that moves has no inertial, while others of the robot have.

    Without a mass the body cannot be accelerated: MuJoCo refuses the file unless the link has a shape to guess from,
    PyBullet takes one kilogram for it, Gazebo leaves out the link and the joint that carries it. Links that are fixed
    to one with a mass, such as a tool frame, need none.
    """

    code = "I101"
    name = "inertial-missing"
    severity = Severity.WARNING
    hint = "give the link an <inertial>; a frame that is only a reference belongs on a fixed joint"
    bad = Example("""
        <link name="base"/>
        <link name="arm"> <!-- I101 -->
          <visual><geometry><mesh filename="arm.stl"/></geometry></visual>
        </link>
        <link name="hand">
          <inertial>
            <mass value="1"/><inertia ixx="0.002" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.001"/>
          </inertial>
        </link>
        <joint name="shoulder" type="continuous"><parent link="base"/><child link="arm"/></joint>
        <joint name="wrist" type="continuous"><parent link="arm"/><child link="hand"/></joint>""")
    good = Example("""
        <link name="base"/>
        <link name="arm">
          <inertial>
            <mass value="2"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.002"/>
          </inertial>
        </link>
        <link name="tool0"/>
        <joint name="shoulder" type="continuous"><parent link="base"/><child link="arm"/></joint>
        <joint name="flange-tool0" type="fixed"><parent link="arm"/><child link="tool0"/></joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each body that moves without an inertial; one info for the robot if there is none at all."""
        bodies = bodies_of(subject)
        bare = [body for body in _moving(bodies) if not any(_has_inertial(subject, link) for link in body.links)]
        if not bare:
            return
        if not any(link.all("inertial") for link in subject.links):
            message = "no link has an inertial: there is no gravity load and no dynamics of this robot"
            yield self.finding(subject.root, message, severity=Severity.INFO)
            return
        found = [
            (subject.link_elements[body.links[0]], body.links[0], f"moved by {_carrier(body)}, but has no inertial")
            for body in bare
        ]
        yield from several(self, found)


class NegativeMass(Rule):
    """A mass is negative.

    Mass cannot be: every simulator refuses it or goes astray, and loads by gravity come out with the wrong sign.
    """

    code = "I102"
    name = "mass-negative"
    severity = Severity.ERROR
    hint = "write the mass in kilograms"
    bad = Example("""
        <link name="base">
          <inertial>
            <mass value="-1"/> <!-- I102 -->
            <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>
          </inertial>
        </link>""")
    good = Example("""
        <link name="base">
          <inertial>
            <mass value="1"/>
            <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>
          </inertial>
        </link>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each mass below zero."""
        for link in subject.links:
            value, mass = mass_of(link), first(link, "inertial", "mass")
            if mass is not None and value is not None and value < 0:
                yield self.finding(mass, f"mass {value:g} kg", attribute="value")


class ZeroMass(Rule):
    """A body that moves has a mass of zero, or moments of inertia without a mass.

    A body of no mass makes the mass matrix singular: MuJoCo and Drake refuse it, Gazebo drops the link. Moments without
    mass are those of no body at all. A frame fixed to a link that has mass may well state a mass of zero.
    """

    code = "I103"
    name = "mass-zero"
    severity = Severity.WARNING
    hint = "state the mass in kilograms; for a link that is only a frame, remove the <inertial> and fix its joint"
    bad = Example("""
        <link name="base"/>
        <link name="finger">
          <inertial>
            <mass value="0"/> <!-- I103 -->
            <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>
          </inertial>
        </link>
        <joint name="knuckle" type="continuous"><parent link="base"/><child link="finger"/></joint>""")
    good = Example("""
        <link name="base"/>
        <link name="finger">
          <inertial>
            <mass value="0.02"/>
            <inertia ixx="4e-6" ixy="0" ixz="0" iyy="4e-6" iyz="0" izz="1e-6"/>
          </inertial>
        </link>
        <joint name="knuckle" type="continuous"><parent link="base"/><child link="finger"/></joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield moments without a mass, an info where other links give the body one, and moving bodies of no mass."""
        bodies = bodies_of(subject)
        odd = set[str]()
        for inertia in bodies.inertias.values():
            if 0 <= inertia.mass <= NO_MASS and max(map(abs, inertia.entries)) > NO_MASS:
                odd.add(inertia.name)
                moved = bodies.of(inertia.name).carrier is not None and bodies.of(inertia.name).mass <= NO_MASS
                yield self.finding(
                    first(inertia.link, "inertial", "mass") or inertia.link,
                    f"mass {inertia.mass:g} kg, but moments of inertia up to {max(inertia.entries):g} kg m2",
                    severity=Severity.ERROR if moved else Severity.INFO,
                    attribute="value",
                )
        found = []
        for body in _moving(bodies):
            stated = [link for link in body.links if _states_no_mass(subject, link)]
            if (
                body.mass <= NO_MASS
                and stated
                and not odd.intersection(body.links)
                and not self._negative(subject, body)
            ):
                mass = first(subject.link_elements[stated[0]], "inertial", "mass") or subject.root
                found.append((mass, stated[0], f"moved by {_carrier(body)}, but its mass is zero"))
        yield from several(self, found, attribute="value")

    def _negative(self, subject: Subject, body: Body) -> bool:
        return any((mass_of(subject.link_elements[link]) or 0.0) < 0 for link in body.links)


class IncompleteInertial(Rule):
    """An inertial lacks its mass, its tensor, or an entry of it.

    URDF needs all seven numbers: urdfdom, and with it ROS and Gazebo, refuses the whole file, as MuJoCo does; other
    readers take zero for what is missing.
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
            found = [(element, link, message) for element, link, message, worst in heavy if worst is unreadable]
            severity = Severity.ERROR if unreadable else None
            yield from several(self, found, severity=severity, attribute="value")
        for link in subject.links:
            inertia = first(link, "inertial", "inertia")
            moments = {key: value for key in MOMENTS if (value := number(inertia, key)) is not None}
            large = [key for key, moment in moments.items() if abs(moment) > LARGEST]
            if inertia is not None and large:
                message = f"{large[0]} {moments[large[0]]:g} kg m2"
                yield self.finding(inertia, message, severity=Severity.ERROR, attribute=large[0])
        yield from several(self, list(self._light(subject)), severity=Severity.INFO, attribute="value")

    def _heavy(self, subject: Subject) -> Iterator[tuple[Element, str, str, bool]]:
        for link in subject.links:
            mass, value = first(link, "inertial", "mass"), mass_of(link)
            if mass is not None and value is not None and value > HEAVIEST:
                yield mass, name_of(link), f"mass {value:g} kg", value > UNREADABLE

    def _light(self, subject: Subject) -> Iterator[tuple[Element, str, str]]:
        for body in _moving(bodies_of(subject)):
            mass = first(subject.link_elements[body.links[0]], "inertial", "mass")
            if NO_MASS < body.mass < LIGHTEST and mass is not None:
                yield mass, body.links[0], f"moved by {_carrier(body)}, but its mass is {body.mass:g} kg"


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
        for body in _moving(bodies):
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


def _moving(bodies: Bodies) -> list[Body]:
    """Return the bodies that a joint moves."""
    return [body for body in bodies.bodies.values() if body.carrier is not None]


def _carrier(body: Body) -> str:
    assert body.carrier is not None
    return f"joint {quote(name_of(body.carrier), 40)}"


def _has_inertial(subject: Subject, link: str) -> bool:
    return bool(subject.link_elements[link].all("inertial"))


def _states_no_mass(subject: Subject, link: str) -> bool:
    mass = mass_of(subject.link_elements[link])
    return mass is not None and 0 <= mass <= NO_MASS


MASSES: tuple[Rule, ...] = (
    MissingInertial(),
    NegativeMass(),
    ZeroMass(),
    IncompleteInertial(),
    AbsurdInertial(),
    MassRatio(),
)
