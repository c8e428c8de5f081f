"""What a sweep has found: how each measure is distributed, where it is smallest and largest, with a certificate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from kinetostat.analysis.crosscheck import Certificate
from kinetostat.analysis.loads import Payload
from kinetostat.analysis.sweeping.accumulators import ACCURACY, Histogram, Tally
from kinetostat.analysis.sweeping.chunks import Chunks
from kinetostat.analysis.sweeping.measures import Column
from kinetostat.analysis.sweeping.samples import Source
from kinetostat.analysis.task import Task
from kinetostat.conventions import Array, Reference, Velocity
from kinetostat.errors import quote
from kinetostat.urdf.description import Robot

__all__ = ["QUANTILES", "Beyond", "Distribution", "Extreme", "Sweep"]

QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)


@dataclass(frozen=True)
class Extreme:
    """Where a measure is smallest or largest.

    Attributes:
        value: the measure there.
        row: which of the configurations it is, from 0.
        q: the chain's coordinates there. (n,).
        configuration: the whole robot's. (nq,).
    """

    value: float
    row: int
    q: Array = field(compare=False)
    configuration: Array = field(compare=False)


@dataclass(frozen=True, repr=False)
class Distribution:
    """How a measure is distributed over the configurations.

    Attributes:
        column: which measure, and its unit.
        tally: all that is known of its numbers.
        minimum: where it is smallest, None where there is no number.
        maximum: where it is largest.
    """

    column: Column
    tally: Tally
    minimum: Extreme | None
    maximum: Extreme | None
    accuracy: float = ACCURACY

    def __repr__(self) -> str:
        return f"<Distribution of {self.column.name}: {self.count} numbers>"

    @property
    def unit(self) -> str:
        """Unit of the measure."""
        return self.column.unit

    @property
    def count(self) -> int:
        """How many configurations have a number."""
        return self.tally.count

    @property
    def invalid(self) -> int:
        """How many have none (NaN): a gradient at a kink, the effort use of a joint without a limit."""
        return self.tally.invalid

    @property
    def mean(self) -> float:
        """The mean; NaN where there is no number."""
        return self.tally.mean

    @cached_property
    def quantiles(self) -> dict[float, float]:
        """The order statistics at `QUANTILES`, with a relative error of `accuracy` at most."""
        return dict(zip(QUANTILES, self.tally.quantiles(list(QUANTILES)), strict=True))

    def quantile(self, share: float) -> float:
        """Return the number that a share of all are not above, with a relative error of `accuracy` at most."""
        return self.tally.quantile(share)

    def histogram(self, bins: int = 20) -> Histogram:
        """Return counts over bins of equal width between the extremes."""
        return self.tally.histogram(bins)


@dataclass(frozen=True)
class Beyond:
    """How many configurations have a measure below (or above) a threshold, and which share of those that are done."""

    column: Column
    threshold: float
    count: int
    share: float


@dataclass(frozen=True, repr=False)
class Sweep:
    """Measures of many configurations of a frame.

    Attributes:
        robot: whose configurations they are.
        velocity: of which frame and point, relative to which observer, expressed in which axes.
        reference: the shorthand that it was asked by.
        task: the rows that count.
        source: where the configurations come from.
        seed: of random configurations.
        requested: how many configurations were asked for.
        count: how many were done.
        complete: whether they are all.
        names: names of the chain's coordinates.
        units: rad or m of each.
        rest: where all other joints are, (nq,).
        length: the characteristic length L in m, or None if metres and radians are mixed as they are.
        length_reference: how L was found.
        measures: each column's distribution, by the column's name.
        near: a configuration is near-singular with a smaller inverse condition number.
        near_singular_share: share of such configurations; None where no measure needs singular values.
        below: shares below the thresholds that were given.
        above: shares above those that were given; and of effort use above 1, which is beyond a limit.
        gravity: in m/s2 in the root's axes, (3,); None where no measure depends on it.
        payload: what weighs with the links.
        limits: effort limits that were given instead of the file's.
        certificate: what the two engines say of the rows that both computed: of the output nearest to its tolerance.
        certificates: the same for each of the kernel's outputs.
        certified_rows: how many rows that were.
        done: which chunks are done.
        seconds: how long it took.
        rate: configurations a second.
        continued: how many an earlier run had done, of which there was a checkpoint.
        warnings: what is to be said of it.
    """

    robot: Robot
    velocity: Velocity
    reference: Reference
    task: Task
    source: Source
    seed: int
    requested: int
    count: int
    complete: bool
    names: tuple[str, ...]
    units: tuple[str, ...]
    rest: Array
    length: float | None
    length_reference: str
    measures: dict[str, Distribution]
    near: float
    near_singular_share: float | None
    below: tuple[Beyond, ...]
    above: tuple[Beyond, ...]
    gravity: Array | None
    payload: Payload | None
    limits: Mapping[str, float | tuple[float, float]]
    certificate: Certificate
    certificates: dict[str, Certificate]
    certified_rows: int
    done: Chunks
    seconds: float
    rate: float
    continued: int
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        state = "" if self.complete else f" of {self.requested}"
        return f"<Sweep of {quote(self.velocity.of)}: {self.count}{state} configurations>"
