"""I201 to I203: tensors that no rigid body can have, whatever its size."""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.lint.bodies import Bodies, LinkInertia, bodies_of
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.inertia.slips import reordered
from kinetostat.lint.subject import Subject
from kinetostat.lint.tensors import NO_MASS, Flaw

__all__ = ["TENSORS", "solid", "with_moments"]

MUJOCO_LEAST = 1e-14  # kg m2: a principal moment below it is refused (measured), unless all six entries are 0


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
    the file where a joint moves it, Drake at the first step of a simulation. Fixed to other links it counts as a point
    mass, which may be what is meant: then all six entries are exactly 0. What arithmetic leaves in place of a zero,
    such as 1e-20, MuJoCo refuses on any link.
    """

    code = "I201"
    name = "tensor-zero"
    severity = Severity.WARNING
    hint = "write the moments about the centre of mass; CAD programs give them"
    bad = Example(solid("2", 'ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"', "I201"))
    good = GOOD

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the tensors of zero; an info for those that count as point masses in every tool."""
        bodies = bodies_of(subject)
        largest = self._largest(bodies)
        free, noise, points = list[LinkInertia](), list[LinkInertia](), list[LinkInertia]()
        for each in bodies.inertias.values():
            if each.flaw is not Flaw.ZERO:
                continue
            # Moved by a joint, and nothing that is fixed to it has a larger moment of inertia.
            if bodies.of(each.name).carrier is not None and max(each.entries) >= largest[bodies.head[each.name]]:
                free.append(each)
            elif any(each.entries) and each.principal[0] < MUJOCO_LEAST:
                noise.append(each)
            elif not bodies.negligible(each):
                points.append(each)
        yield from grouped(self, [self._of(each) for each in free], what="link")
        hint = "write 0 for all six entries, which stands for a point mass, or write the moments"
        refused = ": MuJoCo refuses what is nearly, but not quite, zero"
        yield from grouped(self, [self._of(each, refused) for each in noise], what="link", hint=hint)
        yield from grouped(self, [self._of(each) for each in points], what="link", severity=Severity.INFO)

    def _largest(self, bodies: Bodies) -> dict[str, float]:
        """Return the largest entry of a tensor in each body, by its first link."""
        largest = dict[str, float]()
        for each in bodies.inertias.values():
            head = bodies.head[each.name]
            largest[head] = max(largest.get(head, each.entries[0]), *each.entries)
        return largest

    def _of(self, inertia: LinkInertia, so: str = "") -> Found:
        largest = max(map(abs, inertia.entries))
        zero = "all moments are zero" if largest == 0 else f"the moments are {largest:.2g} kg m2 or less"
        return Found(inertia.element, inertia.name, f"mass {inertia.mass:g} kg, but {zero}{so}")


class TensorNotPositive(Rule):
    """A tensor has a principal moment of zero or below.

    Turning such a body about that axis would take no energy, or give some: the mass matrix is not positive definite,
    and its inverse, on which every simulation rests, is wrong or missing. MuJoCo refuses the file; Drake warns of a
    negative moment and goes on with other moments than the file's, those of a ball of water of that mass.
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
        told = [each for each in bodies.inertias.values() if reordered(each.entries) is None]
        negative = [each for each in told if each.flaw is Flaw.NEGATIVE]
        slight = [each for each in negative if bodies.negligible(each)]
        singular = [each for each in told if each.flaw is Flaw.SINGULAR]
        hint = "a real rod has some moment about its own axis, too: mass x radius^2 / 2"
        for group, severity, remedy in (
            ([each for each in negative if not bodies.negligible(each)], None, None),
            (slight, Severity.WARNING, None),
            (singular, Severity.WARNING, hint),
        ):
            found = [self._of(each) for each in group]
            yield from grouped(self, found, what="link", alike=True, severity=severity, hint=remedy)

    def _of(self, inertia: LinkInertia) -> Found:
        below = inertia.principal[0] < -NO_MASS
        wrong = f"a principal moment is {'below zero, perhaps by rounding' if below else 'zero'}"
        wrong = "not positive definite" if inertia.flaw is Flaw.NEGATIVE else wrong
        return Found(inertia.element, inertia.name, f"{wrong}: {with_moments(inertia)}")


class TriangleInequality(Rule):
    """Two principal moments together are below the third.

    No distribution of mass has such moments: Ixx + Iyy >= Izz for any axes. MuJoCo refuses the file; Drake warns and
    goes on with other moments than the file's, those of a ball of water of that mass. Where rounding explains it this
    is an info: MuJoCo is strict to the last digit.
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
        yield from grouped(self, [self._of(each) for each in wrong], what="link", alike=True)
        hint = "write more digits: it may be rounding"
        found = [self._of(each) for each in rounded]
        yield from grouped(self, found, what="link", alike=True, severity=Severity.INFO, hint=hint)

    def _of(self, inertia: LinkInertia) -> Found:
        low, middle, high = inertia.principal
        broken = f"{low:.4g} + {middle:.4g} < {high:.4g}"
        message = f"{broken}: these principal moments (kg m2) break the triangle inequality"
        return Found(inertia.element, inertia.name, message)


TENSORS: tuple[Rule, ...] = (ZeroTensor(), TensorNotPositive(), TriangleInequality())
