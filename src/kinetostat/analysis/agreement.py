"""Do all readers agree on a robot: both engines and yourdfpy, on all frames at many configurations?"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

from kinetostat.analysis import comparing
from kinetostat.analysis.arbiter import Arbiter
from kinetostat.analysis.comparing import Gap
from kinetostat.analysis.panel import Panel, panel, positions
from kinetostat.engines.model import Model
from kinetostat.engines.third import ThirdReader
from kinetostat.errors import DisagreementError, EngineError, UsageError

__all__ = ["DIFFERENCES", "Agreement", "Disagreement", "agreement"]

DIFFERENCES = "central differences"  # what an engine is checked against by itself
_MOST_SAMPLES = 10_000


@dataclass(frozen=True)
class Disagreement:
    """The worst of one kind of number on which readers differ.

    Attributes:
        quantity: "placement", "Jacobian", "gravity torque" ...
        odd_one: the reader that two others outvote; empty where it is one against one.
        readers: the two that are furthest apart.
        frame: the link; empty where it is about none.
        configuration: positions of joints at which it is so, rad and m.
        size: the difference, in `unit`.
        tolerance: what counts as agreement.
        unit: of the two.
    """

    quantity: str
    odd_one: str
    readers: tuple[str, ...]
    frame: str
    configuration: dict[str, float]
    size: float
    tolerance: float
    unit: str


@dataclass(frozen=True)
class Agreement:
    """How far apart the readers of one file come.

    Attributes:
        readers: their names: "pinocchio", "screw", "yourdfpy".
        frames, configurations: how many of each were compared.
        max_difference: the largest between the two engines, placements and Jacobians, m and 1.
        tolerance: what counts as agreement between the two engines.
        disagreements: the worst of each kind; empty if all agree.
        notes: what was left out and why, such as a known limit of the third reader.
    """

    readers: tuple[str, ...]
    frames: int
    configurations: int
    max_difference: float
    tolerance: float
    disagreements: tuple[Disagreement, ...] = ()
    notes: tuple[str, ...] = field(default=())

    @property
    def agree(self) -> bool:
        """Whether nothing disagrees."""
        return not self.disagreements

    @property
    def engines_agree(self) -> bool:
        """Whether the engines do, whatever the third reader says alone."""
        return all(one.odd_one == ThirdReader.name for one in self.disagreements)


def agreement(model: Model, *, samples: int = 20, seed: int = 0, third: bool = True) -> Agreement:
    """Return how far the readers of a robot come apart.

    Both engines on all frames: placements, Jacobians in the three references, masses, the torques of weight and of
    wrenches. yourdfpy on the placements, at a few of the configurations. Witnesses, at the same few: an engine's
    Jacobian is the rate of its placements (by central differences), its gravity torque the gradient of the potential
    energy, and a wrench's torque has the wrench's power, tau . qdot = F . V.

    Where two differ, a third outvotes one: the third reader on placements, and on what follows from them the witness
    built on placements that may be trusted. What the third reader is known to read differently is left out (`notes`).

    Args:
        model: the robot.
        samples: configurations: zero, the middle of limits, and random ones.
        seed: of these.
        third: ask yourdfpy too (its import takes half a second).

    Raises:
        UsageError: not 1 to 10,000 samples.
        RobotError: Pinocchio refuses the robot.
    """
    if not 1 <= samples <= _MOST_SAMPLES:
        raise UsageError(f"between 1 and {_MOST_SAMPLES:,} samples, not {samples}")
    model = model if model.crosscheck else replace(model, crosscheck=True)
    try:
        readers = panel(model, samples, seed, third)
    except DisagreementError:
        return _other_coordinates(model)
    gaps, lines = _Compared(readers), list(readers.notes)
    found, names = list(gaps.between_engines()), [engine.name for engine in readers.engines]
    if gaps.negative:
        lines.append("torques of weight are left out: a link's mass is negative")
    if readers.third is not None:
        try:
            found += gaps.of_third(readers.third)
            if len(readers.third.frames) > 1 or len(readers.frames) == 1:  # else it has said nothing
                names.append(readers.third.name)
        except EngineError as error:
            lines.append(f"{ThirdReader.name} is left out: {error.message}")
    return Agreement(
        tuple(names),
        len(readers.frames),
        len(readers.q),
        max(gaps.placement.size, gaps.jacobian.size),
        readers.tolerance,
        tuple(found),
        tuple(lines),
    )


def _other_coordinates(model: Model) -> Agreement:
    """Return the agreement of engines that do not even read the same joints."""
    infinite = float("inf")
    odd = Disagreement("joints", "", ("pinocchio", "screw"), "", {}, infinite, 0.0, "1")
    return Agreement(("pinocchio", "screw"), len(model.robot.links), 0, infinite, 0.0, (odd,))


class _Compared:
    """The gaps of one panel, and what they mean."""

    def __init__(self, readers: Panel) -> None:
        self.panel = readers
        self.placement = comparing.placements(readers)
        self.jacobian = comparing.jacobians(readers)
        self.mass = comparing.masses(readers)
        self.negative = any(link.inertial is not None and link.inertial.mass < 0 for link in readers.robot.links)
        self.weighs = readers.robot.nv > 0 and not self.negative
        self.slips = (
            {engine.name: comparing.slips(readers, engine, weight=self.weighs) for engine in readers.engines}
            if readers.robot.nv
            else {}
        )

    def between_engines(self) -> Iterator[Disagreement]:
        """Yield what the engines disagree on; and where they agree, but not with the differences of placements."""
        judge, blamed = self._arbiter(), dict[str, str]()
        cases: list[tuple[Gap, Callable[[Gap], str]]] = [
            (self.placement, lambda gap: judge.of_placement(gap.frame, gap.q)),
            (self.jacobian, lambda gap: judge.of_jacobian(gap.frame, gap.q, gap.reference)),
            (self.mass, lambda gap: judge.of_masses(gap.allowed)),
        ]
        if self.weighs:
            force = comparing.gravity_force(self.panel)
            cases.append((comparing.gravity(self.panel), lambda gap: judge.of_gravity(gap.q, force)))
        if self.panel.loads:
            wrench = comparing.load_force(self.panel)
            cases.append((comparing.loads(self.panel), lambda gap: judge.of_loads(gap.q, wrench)))
        pair = tuple(engine.name for engine in self.panel.engines)
        for gap, judged in cases:
            if not gap.closed:
                # What follows from a wrong placement or mass may be too small for the witness.
                cause = blamed.get("placement") or blamed.get("mass") or ""
                blamed[gap.quantity] = _named(judged, gap) or cause
                yield self._disagreement(gap, blamed[gap.quantity], pair)
        for name, slips in self.slips.items():
            for slip in slips:
                if not slip.closed and not blamed.keys() & {slip.quantity, "placement", "mass"}:
                    yield self._disagreement(slip, "", (name, DIFFERENCES))

    def of_third(self, reader: ThirdReader) -> Iterator[Disagreement]:
        """Yield where the third reader is outvoted by the engines.

        Raises:
            EngineError: it fails.
        """
        gap = comparing.third(self.panel, reader)
        if not gap.closed:
            yield self._disagreement(gap, reader.name, (reader.name, self.panel.first.name))

    def _arbiter(self) -> Arbiter:
        inconsistent = tuple(name for name, slips in self.slips.items() if not slips[0].closed)
        return Arbiter(self.panel, self.placement.closed, self.mass.closed, inconsistent)

    def _disagreement(self, gap: Gap, odd_one: str, readers: tuple[str, ...]) -> Disagreement:
        where = positions(self.panel.robot, gap.q)
        return Disagreement(gap.quantity, odd_one, readers, gap.frame, where, gap.size, gap.allowed, gap.unit)


def _named(judged: Callable[[Gap], str], gap: Gap) -> str:
    """Return the odd one out; empty where the third reader fails over it."""
    try:
        return judged(gap)
    except EngineError:
        return ""
