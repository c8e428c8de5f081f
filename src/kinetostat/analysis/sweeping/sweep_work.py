"""A sweep as work: what a chunk of configurations gives, how that adds up, and the answer that it makes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from itertools import groupby

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.crosscheck import Certificate, combined
from kinetostat.analysis.indices import inverse_condition_number
from kinetostat.analysis.loads import Payload
from kinetostat.analysis.sweeping.accumulators import Integers, Peak, State, Tally
from kinetostat.analysis.sweeping.certifying import RowWitness
from kinetostat.analysis.sweeping.digest import digest
from kinetostat.analysis.sweeping.measures import Asked, Column
from kinetostat.analysis.sweeping.result import Beyond, Distribution, Extreme, Sweep
from kinetostat.analysis.sweeping.running import Outcome
from kinetostat.analysis.sweeping.samples import BLOCK, InBlocks, Source
from kinetostat.analysis.task import Task
from kinetostat.conventions import Array, Reference, Velocity
from kinetostat.screw.kernel import Kernel
from kinetostat.urdf.description import Robot

__all__ = ["RowBlock", "SweepPartial", "SweepWork"]

_CHECKED = 4  # rows of each chunk that Pinocchio computes again
_CHECKING_SEED = 0x5EED
_VERSION = 2  # of what a partial result means: a checkpoint of another is refused


@dataclass(frozen=True, repr=False)
class RowBlock:
    """Some rows of a sweep.

    Attributes:
        start: the number of the first, from 0.
        q: the chain's coordinates, in rad and m, as `Sweep.names` has them. (m, n).
        values: the measures' columns, (m, c): those of the first measure, then those of the next, in the order in which
            measures were asked for. One column each but for: singular_values s1 .. sk; position x y z; pose x y z qx qy
            qz qw; jacobian row by row, each with a column a coordinate (6 n); gradients and gravity_torque a column a
            coordinate (n); effort_use the largest, then a column a coordinate (1 + n). `SweepWork.columns` names them.
    """

    start: int
    q: Array
    values: Array


@dataclass(frozen=True, repr=False)
class SweepPartial:
    """What is known of some chunks.

    Attributes:
        rows: how many configurations they have.
        tallies: of each column that has a distribution.
        near_singular: how many have an inverse condition number below the threshold.
        checked: how many Pinocchio computed again.
        differences: of each output that was compared, the largest difference and its row.
        table: the rows, of one chunk alone, if they are asked for.
    """

    rows: int = 0
    tallies: tuple[Tally, ...] = ()
    near_singular: int = 0
    checked: int = 0
    differences: tuple[Peak | None, ...] = ()
    table: RowBlock | None = None

    def merged(self, other: SweepPartial) -> SweepPartial:
        """Return what is known of the chunks of both; tables are left behind."""
        return SweepPartial(
            self.rows + other.rows,
            tuple(a.merged(b) for a, b in zip(self.tallies, other.tallies, strict=True)),
            self.near_singular + other.near_singular,
            self.checked + other.checked,
            tuple(_larger(a, b) for a, b in zip(self.differences, other.differences, strict=True)),
        )

    def state(self) -> State:
        """Return all of it but the table as plain arrays by name."""
        peaks = [peak or Peak(math.nan, -1) for peak in self.differences]
        state: State = {
            "counts": np.array([self.rows, self.near_singular, self.checked]),
            "differences": np.array([peak.value for peak in peaks], dtype=np.float64),
            "difference_rows": np.array([peak.row for peak in peaks], dtype=np.int64),
        }
        for i, tally in enumerate(self.tallies):
            state |= {f"{i}.{name}": part for name, part in tally.state().items()}
        return state


def _larger(a: Peak | None, b: Peak | None) -> Peak | None:
    return b if a is None else a.better(b, 1)


@dataclass(frozen=True, repr=False)
class SweepWork(InBlocks):
    """A sweep as chunks of 65,536 configurations; see `sweeping.work`.

    Attributes:
        source: the configurations.
        asked: the measures.
        witness: the chain, the kernel, and who computes rows again.
        reference: in whose axes rows are: aligned or local.
        task: the rows that count.
        length: the characteristic length in m, or None.
        length_reference: how it was found.
        below: the thresholds of each column that has a distribution, which numbers are to be below of.
        above: the same, above.
        near: a configuration is near-singular with a smaller inverse condition number.
        payload: what weighs with the links.
        limits: effort limits that were given instead of the file's.
        seed: of random configurations.
        with_rows: whether each chunk brings its table.
        warnings: what is to be said of the question.
    """

    source: Source
    asked: tuple[Asked, ...]
    witness: RowWitness
    reference: Reference
    task: Task
    length: float | None
    length_reference: str
    below: tuple[tuple[float, ...], ...]
    above: tuple[tuple[float, ...], ...]
    near: float
    payload: Payload | None
    limits: Mapping[str, float | tuple[float, float]]
    seed: int
    with_rows: bool = False
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<SweepWork: {self.rows} configurations in {self.chunks} chunks>"

    @property
    def coordinates(self) -> Coordinates:
        """The chain."""
        return self.witness.coordinates

    @property
    def kernel(self) -> Kernel:
        """What computes the rows."""
        return self.witness.kernel

    @property
    def robot(self) -> Robot:
        """Whose configurations they are."""
        return self.coordinates.model.robot

    @property
    def velocity(self) -> Velocity:
        """Of which frame and point, relative to which observer, expressed in which axes."""
        return self.witness.velocity

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the chain's coordinates."""
        return self.coordinates.names

    @property
    def units(self) -> tuple[str, ...]:
        """Unit of each, rad or m."""
        return tuple("rad" if turns else "m" for turns in self.coordinates.turning)

    @property
    def rest(self) -> Array:
        """Where all other joints are, (nq,)."""
        return self.witness.rest

    @property
    def gravity(self) -> Array | None:
        """Gravity in m/s2 in the root's axes, (3,); None where no measure depends on it."""
        return self.kernel.gravity if {"gravity_torque", "effort_use"} & set(self.kernel.outputs) else None

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns of all measures in order: those of a table."""
        return tuple(column for one in self.asked for column in one.columns)

    @property
    def summed(self) -> tuple[Column, ...]:
        """Those that have a distribution."""
        return tuple(column for one in self.asked if one.measure.summary for column in one.columns)

    @cached_property
    def digest(self) -> str:
        """What identifies the question."""
        parts = (self.asked, self.kernel, self.witness.rest, self.witness.velocity, self.witness.tolerances)
        text = self.coordinates.model.loaded.text
        return digest(
            _VERSION,
            BLOCK,
            text,
            self.source,
            *parts,
            self.below,
            self.above,
            self.near,
            _CHECKED,
            self.coordinates.model.crosscheck,
        )

    def part(self, chunks: tuple[int, ...]) -> Source:
        """Return the configurations of some chunks, perhaps with others: all of the work that may be heavy."""
        start, stop = (min(chunks), max(chunks) + 1) if chunks else (0, 0)
        return self.source.part(start * BLOCK, min(stop * BLOCK, self.rows))

    def with_part(self, part: Source) -> SweepWork:
        """Return the work with a part of its configurations; it computes the chunks that the part is of."""
        return replace(self, source=part)

    def empty(self) -> SweepPartial:
        """Return what is known of no chunk."""
        return SweepPartial(
            tallies=tuple(
                Tally(below=(0,) * len(below), above=(0,) * len(above))
                for below, above in zip(self.below, self.above, strict=True)
            ),
            differences=(None,) * len(self.witness.tolerances),
        )

    def restore(self, state: State) -> SweepPartial:
        """Return the partial result whose `state()` this is."""
        rows, near, checked_rows = map(int, state["counts"])
        tallies = []
        for i in range(len(self.below)):
            own = {name.partition(".")[2]: part for name, part in state.items() if name.startswith(f"{i}.")}
            tallies.append(Tally.restored(own))
        pairs = zip(state["differences"], state["difference_rows"], strict=True)
        peaks = tuple(Peak(float(value), int(row)) if row >= 0 else None for value, row in pairs)
        return SweepPartial(rows, tuple(tallies), near, checked_rows, peaks)

    def compute(self, chunk: int) -> SweepPartial:
        """Return what a chunk gives."""
        start = chunk * BLOCK
        q = self.source.rows(start, start + self.size(chunk))
        outputs = self.kernel(q)
        values = [one.values(outputs) for one in self.asked]
        summed = [row for one, part in zip(self.asked, values, strict=True) if one.measure.summary for row in part]
        near = 0
        if "singular_values" in outputs:
            near = int(np.count_nonzero(inverse_condition_number(outputs["singular_values"]) < self.near))
        rows = self._sample(chunk)
        table = RowBlock(start, q, np.concatenate(values).T) if self.with_rows else None
        return SweepPartial(
            len(q),
            tuple(
                Tally.of(row, start, below, above)
                for row, below, above in zip(summed, self.below, self.above, strict=True)
            ),
            near,
            len(rows),
            self._differences(q, outputs, rows, start),
            table,
        )

    def summed_values(self) -> Array:
        """Return the columns that have a distribution, of all configurations at once: (c, rows)."""
        chunks = (self.source.rows(i * BLOCK, i * BLOCK + self.size(i)) for i in range(self.chunks))
        return np.concatenate([np.concatenate(self._measured(self.kernel(q))) for q in chunks], axis=1)

    def _measured(self, outputs: dict[str, Array]) -> list[Array]:
        """Return the columns of each measure that has a distribution."""
        return [one.values(outputs) for one in self.asked if one.measure.summary]

    def _sample(self, chunk: int) -> Integers:
        """Return which rows of a chunk are computed again, ascending."""
        if not self.coordinates.model.crosscheck:
            return np.zeros(0, dtype=np.int64)
        stream = np.random.Generator(np.random.Philox(key=_CHECKING_SEED, counter=[0, 0, chunk, 0]))
        return np.unique(stream.integers(self.size(chunk), size=_CHECKED))

    def _differences(self, q: Array, outputs: dict[str, Array], rows: Integers, start: int) -> tuple[Peak | None, ...]:
        """Return the largest difference of each output, and its row, over some rows of a chunk."""
        if not len(rows):
            return (None,) * len(self.witness.tolerances)
        some = {name: outputs[name][rows] for name in self.witness.tolerances}
        found = self.witness.differences(q[rows], some)
        worst = ((float(each[i]), start + int(rows[i])) for each in found.values() for i in [int(np.argmax(each))])
        return tuple(Peak(value, row) for value, row in worst)

    def result(self, outcome: Outcome[SweepPartial]) -> Sweep:
        """Return the answer of a run, complete or not. The extremes are computed again by Pinocchio, too."""
        partial, measures = outcome.partial, {}
        ends = {peak.row for tally in partial.tallies for peak in (tally.minimum, tally.maximum) if peak is not None}
        where = self._configurations(sorted(ends))
        for column, tally in zip(self.summed, partial.tallies, strict=True):
            low, high = (
                None if peak is None else self._extreme(peak, where[peak.row])
                for peak in (tally.minimum, tally.maximum)
            )
            measures[column.name] = Distribution(column, tally, low, high)
        partial = self._with_extremes(partial, where)
        certificates = self._certificates(partial)
        below = [tally.below for tally in partial.tallies]
        above = [tally.above for tally in partial.tallies]
        known = "singular_values" in self.kernel.outputs and partial.rows > 0
        return Sweep(
            self.robot,
            self.velocity,
            self.reference,
            self.task,
            self.source,
            self.seed,
            self.rows,
            partial.rows,
            outcome.complete,
            self.names,
            self.units,
            self.rest,
            self.length,
            self.length_reference,
            measures,
            self.near,
            partial.near_singular / partial.rows if known else None,
            self._beyond(self.below, below, partial.rows),
            self._beyond(self.above, above, partial.rows),
            self.gravity,
            self.payload,
            self.limits,
            combined(list(certificates.values())),
            certificates,
            partial.checked,
            outcome.done,
            outcome.seconds,
            outcome.rate,
            outcome.continued,
            (*self.warnings, *outcome.warnings),
        )

    def _beyond(
        self, thresholds: tuple[tuple[float, ...], ...], counts: list[tuple[int, ...]], rows: int
    ) -> tuple[Beyond, ...]:
        """Return how many of so many rows are beyond the thresholds of each column."""
        return tuple(
            Beyond(column, threshold, count, count / rows if rows else math.nan)
            for column, levels, found in zip(self.summed, thresholds, counts, strict=True)
            for threshold, count in zip(levels, found, strict=True)
        )

    def _configurations(self, rows: Sequence[int]) -> dict[int, Array]:
        """Return the configurations of some rows, ascending, (n,) each; every block of them is drawn once."""
        found = dict[int, Array]()
        for _, own in groupby(rows, lambda row: row // BLOCK):
            some = list(own)
            drawn = self.source.rows(some[0], some[-1] + 1)
            found |= {row: drawn[row - some[0]].copy() for row in some}
        return found

    def _extreme(self, peak: Peak, q: Array) -> Extreme:
        return Extreme(peak.value, peak.row, q, self.coordinates.configuration(q, self.witness.rest))

    def _with_extremes(self, partial: SweepPartial, where: Mapping[int, Array]) -> SweepPartial:
        """Return the partial result with the rows of all extremes computed again, and held against what is reported."""
        if not where or not self.coordinates.model.crosscheck:
            return partial
        rows, q = list(where), np.stack(list(where.values()))
        outputs = self.kernel(q)
        found = self._differences(q, outputs, np.arange(len(rows)), 0)
        own = tuple(None if peak is None else Peak(peak.value, rows[peak.row]) for peak in found)
        told = self._told(partial, outputs, rows)
        each = (reduce(_larger, three) for three in zip(partial.differences, own, told, strict=True))
        new = sum(row % BLOCK not in self._sample(row // BLOCK) for row in rows)
        return replace(partial, checked=partial.checked + new, differences=tuple(each))

    def _told(self, partial: SweepPartial, outputs: dict[str, Array], rows: list[int]) -> tuple[Peak | None, ...]:
        """Return, of each output that is compared, how far extremes that are reported are from what their rows give.

        Nothing, unless a number was damaged on its way: by another version at a worker, in a checkpoint, amid a batch.
        """
        names, tallies = tuple(self.witness.tolerances), iter(partial.tallies)
        found = dict[str, Peak | None].fromkeys(names)
        for one in self.asked:
            if not one.measure.summary:
                continue
            name = next((output for output in one.measure.outputs if output in found), names[0])
            for values, tally in zip(one.values(outputs), tallies, strict=False):
                for peak in (tally.minimum, tally.maximum):
                    if peak is not None and (again := float(values[rows.index(peak.row)])) != peak.value:
                        apart = abs(again - peak.value) / max(1.0, abs(again))
                        found[name] = _larger(found[name], Peak(apart if apart < math.inf else math.inf, peak.row))
        return tuple(found.values())

    def _certificates(self, partial: SweepPartial) -> dict[str, Certificate]:
        """Return what the engines say of each output; both results of the worst row where they disagree."""
        found = {}
        for name, peak in zip(self.witness.tolerances, partial.differences, strict=True):
            numbers = partial.checked * self.witness.row_size(name)
            certificate = self.witness.certificate(name, None if peak is None else peak.value, numbers=numbers)
            if peak is not None and certificate.agree is False:
                q = self.source.rows(peak.row, peak.row + 1)
                values = (self.witness.again(q)[name][0], self.kernel(q)[name][0])
                certificate = self.witness.certificate(name, peak.value, values, numbers)
            found[name] = certificate
        return found
