"""I204 to I208: tensors that a body could have, but that are probably a slip or stand for nothing."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np

from kinetostat.lint.bodies import Bodies, LinkInertia, bodies_of
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, also, grouped, listed
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.inertia.slips import densest_moment, likely_units, reordered
from kinetostat.lint.rules.inertia.tensors import GOOD, solid, with_moments
from kinetostat.lint.shapes import extents_of
from kinetostat.lint.subject import Subject
from kinetostat.lint.tensors import NO_MASS, Flaw, matrix

__all__ = ["SUSPICIONS", "is_placeholder", "placeholders"]

REPEATED = 3  # links with the same isotropic tensor
TOO_LARGE = 3.0  # a radius of gyration against the size of the whole robot
NO_SIZE = 10.0  # m: of a robot whose size is not known
MATCH = 0.1  # how closely products follow those of a point mass at the centre of mass
COUNTS = 0.02  # of the trace: a smaller product says nothing


def placeholders(bodies: Bodies) -> dict[tuple[float, ...], list[LinkInertia]]:
    """Return the tensors that stand for nothing, with the links that have them.

    These are the identity; all six entries the same; one round isotropic tensor on three links and more.
    """
    groups = defaultdict[tuple[float, ...], list[LinkInertia]](list)
    for each in bodies.inertias.values():
        if each.mass > NO_MASS and (each.flaw is Flaw.ALIKE or (each.isotropic and _is_round(each.entries[0]))):
            groups[each.entries].append(each)
    return {
        entries: links
        for entries, links in groups.items()
        if links[0].flaw is Flaw.ALIKE
        or entries[0] == 1
        or sum(not bodies.negligible(each) for each in links) >= REPEATED
    }


def is_placeholder(inertia: LinkInertia, known: dict[tuple[float, ...], list[LinkInertia]]) -> bool:
    """Return whether a link has one of these tensors."""
    return inertia.entries in known


def _is_round(value: float) -> bool:
    """Return whether a number has one digit only, such as 0.001 or 5e-3."""
    return float(f"{value:.0e}") == value


class PlaceholderTensor(Rule):
    """A tensor stands for nothing: the identity, six equal entries, one round number on many links.

    Copied to get a file to load, such tensors are wrong by orders of magnitude: joint torques, resonances and simulated
    motion are those of another robot. Six equal entries are no tensor at all (two principal moments are zero): MuJoCo
    refuses the file.
    """

    code = "I204"
    name = "tensor-placeholder"
    severity = Severity.WARNING
    hint = "write the moments of the part about its centre of mass; CAD programs give them"
    bad = Example(solid("2", 'ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"', "I204"))
    good = GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield one finding for each tensor; an info where it may be meant, or where it hardly counts."""
        bodies = bodies_of(subject)
        for entries, links in placeholders(bodies).items():
            counted = [each for each in links if not bodies.negligible(each)] or links
            severity, message = self._judged(bodies, entries, links, counted)
            yield self.finding(counted[0].element, message, severity=severity, several=len(links) > 1)

    def _judged(
        self, bodies: Bodies, entries: tuple[float, ...], links: Sequence[LinkInertia], counted: Sequence[LinkInertia]
    ) -> tuple[Severity, str]:
        others = also([each.name for each in links if each is not counted[0]], "link")
        if links[0].flaw is Flaw.ALIKE:
            message = (
                f"all six entries are {entries[0]:g}: no body has such a tensor, two principal moments of which are 0"
            )
            return Severity.WARNING, message + others
        if entries[0] == 1:
            moved = any(bodies.of(each.name).carrier is not None for each in counted)
            severity = Severity.WARNING if moved else Severity.INFO
            return severity, f"the identity, 1 kg m2 about every axis, for {counted[0].mass:g} kg{others}"
        masses = [each.mass for each in counted]
        differ = max(masses) >= 2 * min(masses)
        spread = f"masses from {min(masses):g} to {max(masses):g} kg" if differ else f"about {masses[0]:g} kg each"
        names = listed([each.name for each in counted])
        message = f"{entries[0]:g} kg m2 about every axis for {len(counted)} links, {spread}: {names}"
        return Severity.WARNING if differ else Severity.INFO, message


class ShuffledTensor(Rule):
    """A tensor cannot be as written, but could be with its entries in another order.

    URDF names the entries; programs that write them one after the other differ in their order (Pinocchio, MuJoCo,
    SolidWorks, a 3 x 3 matrix by rows). A moment where a product belongs makes the tensor that of no body.
    """

    code = "I205"
    name = "tensor-order"
    severity = Severity.ERROR
    hint = "compare the six entries with their source; if the order is right, the numbers are not"
    bad = Example(solid("2", 'ixx="0.02" ixy="0.021" ixz="0.004" iyy="0" iyz="0" izz="0"', "I205"))
    good = GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each; a warning where only the triangle inequality is broken."""
        bodies = bodies_of(subject)
        for each in bodies.inertias.values():
            if each.flaw in (Flaw.NEGATIVE, Flaw.SINGULAR, Flaw.TRIANGLE):
                slip = reordered(each.entries)
                certain = each.flaw is Flaw.NEGATIVE and not bodies.negligible(each)
                if slip is not None:
                    message = f"no body has the {with_moments(each)}: perhaps {slip}"
                    severity = None if certain else Severity.WARNING
                    yield self.finding(each.element, message, severity=severity)


class TensorAboutOrigin(Rule):
    """Tensors seem to be given about the origin of the link, not about its centre of mass.

    URDF wants the tensor about the centre of mass; CAD programs offer both. One about the origin holds the mass times
    the square of its distance once too often: the link resists turning too much.
    """

    code = "I206"
    name = "tensor-about-origin"
    severity = Severity.INFO
    hint = "subtract mass (c.c 1 - c c^T), c the centre of mass, or ask the CAD program for the other tensor"
    bad = Example("""
        <link name="base"/>
        <link name="arm">
          <inertial>
            <origin xyz="0.2 0.15 0.1"/>
            <mass value="2"/>
            <!-- of a ball of 5 cm: 0.002 about its centre -->
            <inertia ixx="0.067" ixy="-0.06" ixz="-0.04" iyy="0.102" iyz="-0.03" izz="0.127"/> <!-- I206 -->
          </inertial>
        </link>
        <joint name="shoulder" type="continuous"><parent link="base"/><child link="arm"/></joint>""")
    good = Example("""
        <link name="base"/>
        <link name="arm">
          <inertial>
            <origin xyz="0.2 0.15 0.1"/>
            <mass value="2"/>
            <inertia ixx="0.002" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.002"/>
          </inertial>
        </link>
        <joint name="shoulder" type="continuous"><parent link="base"/><child link="arm"/></joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the links whose tensors follow a point mass at the centre of mass; a warning if most that tell do."""
        told = [(each, self._about_origin(each)) for each in bodies_of(subject).inertias.values() if each.flaw is None]
        suspects = [each for each, about in told if about]
        plain = [each for each, about in told if about is False]
        severity = Severity.WARNING if len(suspects) >= REPEATED and len(suspects) > len(plain) else None
        message = "the products of inertia are those of a point mass at the centre of mass, seen from the link's origin"
        found = [Found(each.element, each.name, message) for each in suspects]
        yield from grouped(self, found, what="link", severity=severity)

    def _about_origin(self, inertia: LinkInertia) -> bool | None:
        """Return whether a tensor follows the parallel-axis term; None if that cannot be told."""
        x, y, z = inertia.centre
        if any(inertia.rpy):
            return None
        term = inertia.mass * np.array([y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y])
        products = [(inertia.entries[i], term[i]) for i in (1, 2, 4)]
        telling = [(is_, of) for is_, of in products if abs(of) > COUNTS * sum(inertia.principal)]
        if len(telling) < 2:
            return None
        # The rest has to be the tensor of a body, too.
        low, middle, high = np.linalg.eigvalsh(matrix(np.array(inertia.entries) - term))
        return low > 0 and low + middle >= high and all(abs(is_ - of) <= MATCH * abs(of) for is_, of in telling)


class TensorUnit(Rule):
    """A radius of gyration is several times the size of the whole robot.

    The mass would have to sit far outside the robot. Mostly the moments are in another unit: CAD programs give
    kg mm2 or g mm2, a million or a thousand million times the number in kg m2.
    """

    code = "I207"
    name = "tensor-unit"
    severity = Severity.WARNING
    hint = "URDF's moments are in kg m2"
    bad = Example(solid("2", 'ixx="20000" ixy="0" ixz="0" iyy="21000" iyz="0" izz="4000"', "I207"))
    good = GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each moment that is too large for the robot."""
        bodies = bodies_of(subject)
        extents = [extent.half_diagonal for extent in extents_of(subject).values()]
        size = max([bodies.reach, *extents], default=0.0) or NO_SIZE
        known = placeholders(bodies)
        found = []
        for each in bodies.inertias.values():
            counts = each.flaw in (None, Flaw.ROUNDED, Flaw.TRIANGLE) and not bodies.negligible(each)
            if counts and each.gyration > TOO_LARGE * size and not is_placeholder(each, known):
                units = " or ".join(likely_units(each.gyration, size))
                perhaps = f": is it {units}?" if units else ""
                message = f"radius of gyration {each.gyration:.3g} m, of a robot of {size:.3g} m{perhaps}"
                found.append(Found(each.element, each.name, message))
        yield from grouped(self, found, what="link")


class TensorTooSmall(Rule):
    """Moments are smaller than those of a ball of the densest metal.

    Of all bodies of a mass the ball has the least moment, and no material is denser than osmium: so small a tensor is a
    slip, mostly one of the unit, or stands for a point. Small moments make simulations stiff.
    """

    code = "I208"
    name = "tensor-too-small"
    severity = Severity.WARNING
    hint = "URDF's moments are in kg m2, its masses in kg"
    bad = Example(solid("2", 'ixx="2e-5" ixy="0" ixz="0" iyy="2.1e-5" iyz="0" izz="4e-6"', "I208"))
    good = GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each; an info where other links fixed to it have their own moments."""
        bodies = bodies_of(subject)
        known = placeholders(bodies)
        groups: dict[Severity, list[LinkInertia]] = {Severity.WARNING: [], Severity.INFO: []}
        for each in bodies.inertias.values():
            counts = each.flaw is None and each.mass > NO_MASS and not bodies.negligible(each)
            if counts and sum(each.principal) / 3 < densest_moment(each.mass) and not is_placeholder(each, known):
                body = bodies.of(each.name)
                main = body.carrier is not None and each.mass > 0.5 * body.mass
                groups[Severity.WARNING if main else Severity.INFO].append(each)
        for severity, links in groups.items():
            found = [Found(each.element, each.name, self._message(each)) for each in links]
            yield from grouped(self, found, what="link", severity=severity)

    def _message(self, inertia: LinkInertia) -> str:
        least = densest_moment(inertia.mass)
        return f"{with_moments(inertia)}; a ball of osmium of {inertia.mass:g} kg has {least:.3g}"


SUSPICIONS: tuple[Rule, ...] = (
    PlaceholderTensor(),
    ShuffledTensor(),
    TensorAboutOrigin(),
    TensorUnit(),
    TensorTooSmall(),
)
