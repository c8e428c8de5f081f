"""I201 to I203: tensors that no rigid body can have, whatever its size."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from kinetostat.lint.bodies import Bodies, LinkInertia, bodies_of
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.inertia.several import several
from kinetostat.lint.rules.inertia.slips import reordered
from kinetostat.lint.subject import Subject
from kinetostat.lint.tensors import NO_MASS, Flaw
from kinetostat.urdf.document import Element

__all__ = ["TENSORS", "solid", "with_moments"]


def solid(mass: str, moments: str, mark: str = "") -> str:
    """Return the text of two links for an example: a fixed base, and an arm that has this mass and these moments."""
    return f"""
        <link name="base"/>
        <link name="arm">
          <inertial>
            <mass value="{mass}"/>
            <inertia {moments}/>{f" <!-- {mark} -->" if mark else ""}
          </inertial>
        </link>
        <joint name="shoulder" type="continuous"><parent link="base"/><child link="arm"/></joint>"""


GOOD = Example(solid("2", 'ixx="0.02" ixy="0" ixz="0" iyy="0.021" iyz="0" izz="0.004"'))


def with_moments(inertia: LinkInertia) -> str:
    """Return the principal moments of an inertia for a message."""
    return f"principal moments {', '.join(f'{moment:.4g}' for moment in inertia.principal)} kg m2"


class ZeroTensor(Rule):
    """A tensor is zero although the link has a mass.

    A body that turns about its own centre of mass without any resistance makes the mass matrix singular: MuJoCo refuses
    it where a joint moves it. Fixed to other links it counts as a point mass, which may be what is meant.
    """

    code = "I201"
    name = "tensor-zero"
    severity = Severity.WARNING
    hint = "write the moments about the centre of mass; CAD programs give them"
    bad = Example(solid("2", 'ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"', "I201"))
    good = GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the tensors of zero; an info for those that count as point masses."""
        bodies = bodies_of(subject)
        zero = [each for each in bodies.inertias.values() if each.flaw is Flaw.ZERO]
        alone = [each for each in zero if self._turns_freely(bodies, each)]
        points = [each for each in zero if each not in alone and not bodies.negligible(each)]
        for group, severity in ((alone, Severity.WARNING), (points, Severity.INFO)):
            told = [(each.element, each.name, self._message(each)) for each in group]
            yield from several(self, told, severity=severity)

    def _turns_freely(self, bodies: Bodies, inertia: LinkInertia) -> bool:
        """Return whether the link is moved, and nothing that is fixed to it has a moment of inertia."""
        body = bodies.of(inertia.name)
        others = [bodies.inertias[link] for link in body.links if link in bodies.inertias]
        return body.carrier is not None and all(max(each.entries) <= max(inertia.entries) for each in others)

    def _message(self, inertia: LinkInertia) -> str:
        largest = max(map(abs, inertia.entries))
        zero = "all moments are zero" if largest == 0 else f"the moments are {largest:.2g} kg m2 or less"
        return f"mass {inertia.mass:g} kg, but {zero}"


class TensorNotPositive(Rule):
    """A tensor has a principal moment of zero or below.

    Turning such a body about that axis would take no energy, or give some: the mass matrix is not positive definite,
    and its inverse, on which every simulation rests, is wrong or missing. MuJoCo and Drake refuse the file.
    """

    code = "I202"
    name = "tensor-not-positive"
    severity = Severity.ERROR
    hint = "check the signs and the order of the six entries; the tensor is about the centre of mass"
    bad = Example(solid("2", 'ixx="-0.02" ixy="0" ixz="0" iyy="0.021" iyz="0" izz="0.004"', "I202"))
    good = GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each; a warning where a moment is just zero (a rod without thickness), or where it hardly counts."""
        bodies = bodies_of(subject)
        for each in bodies.inertias.values():
            if each.flaw is Flaw.NEGATIVE and reordered(each.entries) is None:
                severity = Severity.WARNING if bodies.negligible(each) else None
                yield self.finding(each.element, f"not positive definite: {with_moments(each)}", severity=severity)
            if each.flaw is Flaw.SINGULAR and reordered(each.entries) is None:
                below = "below zero, perhaps by rounding" if each.principal[0] < -NO_MASS else "zero"
                message = f"a principal moment is {below}: {with_moments(each)}"
                hint = "a real rod has some moment about its own axis, too: mass x radius^2 / 2"
                yield self.finding(each.element, message, severity=Severity.WARNING, hint=hint)


class TriangleInequality(Rule):
    """Two principal moments together are below the third.

    No distribution of mass has such moments: Ixx + Iyy >= Izz for any axes. MuJoCo refuses the file, and so does Drake.
    Where rounding explains it this is an info: MuJoCo is strict to the last digit.
    """

    code = "I203"
    name = "tensor-triangle"
    severity = Severity.WARNING
    hint = "recompute the moments; is a decimal place lost, or an entry exchanged?"
    bad = Example(solid("2", 'ixx="0.02" ixy="0" ixz="0" iyy="0.0021" iyz="0" izz="0.004"', "I203"))
    good = GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each; an info where no more is missing than the digits written explain."""
        inertias = bodies_of(subject).inertias.values()
        wrong = [each for each in inertias if each.flaw is Flaw.TRIANGLE and reordered(each.entries) is None]
        rounded = [each for each in inertias if each.flaw is Flaw.ROUNDED]
        for each in wrong:
            yield self.finding(each.element, self._message(each))
        told = self._told(rounded)
        yield from several(self, told, severity=Severity.INFO, hint="write more digits: it may be rounding")

    def _told(self, inertias: Sequence[LinkInertia]) -> list[tuple[Element, str, str]]:
        return [(each.element, each.name, self._message(each)) for each in inertias]

    def _message(self, inertia: LinkInertia) -> str:
        low, middle, high = inertia.principal
        return f"{low:.4g} + {middle:.4g} < {high:.4g}: these principal moments (kg m2) break the triangle inequality"


TENSORS: tuple[Rule, ...] = (ZeroTensor(), TensorNotPositive(), TriangleInequality())
