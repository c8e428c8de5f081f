"""I101 to I103: does everything that moves weigh something?"""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.lint.bodies import Body, bodies_of, mass_of
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.subject import Subject, first
from kinetostat.lint.tensors import NO_MASS

__all__ = ["MASSES"]


class MissingInertial(Rule):
    """A body that moves has no inertial, while others of the robot have.

    Without a mass the body cannot be accelerated: MuJoCo refuses the file unless the link has a shape to guess from,
    Drake stops at the first step of a simulation, PyBullet takes one kilogram for it, Gazebo leaves out the link and
    the joint that carries it. Links that are fixed to one with a mass, such as a tool frame, need none.
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
        bare = [body for body in bodies.moving if not any(_has_inertial(subject, link) for link in body.links)]
        if not bare:
            return
        if not any(link.all("inertial") for link in subject.links):
            message = "no link has an inertial: there is no gravity load and no dynamics of this robot"
            yield self.finding(subject.root, message, severity=Severity.INFO)
            return
        found = [
            Found(subject.link_elements[body.links[0]], body.links[0], f"{body.moved_by}, but has no inertial")
            for body in bare
        ]
        yield from grouped(self, found, what="link")


class NegativeMass(Rule):
    """A mass is negative.

    No body has one. MuJoCo refuses it where a joint moves the link, Drake warns and computes with 1 kg; elsewhere the
    loads by gravity come out with the wrong sign.
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

    A body of no mass makes the mass matrix singular: MuJoCo refuses the file, Drake stops at the first step of a
    simulation, Gazebo drops the link. Moments without mass are those of no body at all. A frame fixed to a link that
    has mass may well state a mass of zero.
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
        for body in bodies.moving:
            stated = [link for link in body.links if _states_no_mass(subject, link)]
            if (
                body.mass <= NO_MASS
                and stated
                and not odd.intersection(body.links)
                and not self._negative(subject, body)
            ):
                mass = first(subject.link_elements[stated[0]], "inertial", "mass") or subject.root
                found.append(Found(mass, stated[0], f"{body.moved_by}, but its mass is zero", "value"))
        yield from grouped(self, found, what="link")

    def _negative(self, subject: Subject, body: Body) -> bool:
        return any((mass_of(subject.link_elements[link]) or 0.0) < 0 for link in body.links)


def _has_inertial(subject: Subject, link: str) -> bool:
    return bool(subject.link_elements[link].all("inertial"))


def _states_no_mass(subject: Subject, link: str) -> bool:
    mass = mass_of(subject.link_elements[link])
    return mass is not None and 0 <= mass <= NO_MASS


MASSES: tuple[Rule, ...] = (MissingInertial(), NegativeMass(), ZeroMass())
