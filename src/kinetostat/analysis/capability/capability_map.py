"""The capability map of a tool: where it gets, how often, how well it moves there, from which directions it comes."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from kinetostat.analysis.capability import directions as sphere
from kinetostat.analysis.capability.bounds import Bounds, bounds
from kinetostat.analysis.capability.counting import APPROACH, OUTPUTS, MapWork
from kinetostat.analysis.capability.grid import Grid, fitted
from kinetostat.analysis.capability.voxels import Cells, VoxelSums
from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.crosscheck import Certificate, combined
from kinetostat.analysis.sweeping.running import Outcome, run
from kinetostat.analysis.sweeping.samples import BLOCK, Source, halton_source
from kinetostat.analysis.sweeping.sweep import SweepWork, sweep_work
from kinetostat.analysis.task import Task
from kinetostat.analysis.typical_length import unit_with_length
from kinetostat.conventions import Array, Flags, Reference, Velocity
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError, quote
from kinetostat.screw.kernel import Kernel

__all__ = ["CapabilityMap", "capability_map"]

_PILOT = 4096  # configurations that tell along which axes the tool moves
_FINE = 28  # bits of fixed point below the bound of singular values
_MOST = 1 << 34  # configurations whose sums fit into 63 bits
_LOW = 0.1  # of the best voxel's smallest singular value: below it dexterity is low


@dataclass(frozen=True, repr=False)
class CapabilityMap:
    """A map of the voxels between the outermost ones that a tool reaches; arrays are (a, b, c) along x, y and z.

    Attributes:
        velocity: of which frame and point, relative to which observer, in whose axes the map is.
        task: the rows of the Jacobian that count.
        length: the characteristic length in m, None where there is none.
        length_reference: how it was found, in words.
        grid: the voxels.
        reach_count: how many configurations reach each voxel.
        best_singular_value: the largest of their smallest singular values; NaN where nothing reaches.
        mean_singular_value: the mean of them; NaN where nothing reaches. Exact to `unit`.
        directions: from which directions the tool's z axis arrives, as bits; see `capability.directions`.
        best_row: the number of the configuration that has the best; -1 where nothing reaches.
        source: the configurations.
        coordinates: the chain.
        kernel: what was computed of them.
        unit: of fixed point: sums of singular values are whole multiples of it.
        dimensions: along how many axes the tool moves: 2 for a planar arm.
        count: how many configurations are in the map.
        outside: how many of them are in none of its voxels; 0 unless a bound is wrong.
        complete: whether these are all that were asked for.
        checked: how many of them Pinocchio computed again.
        certificate: its largest difference.
        seconds: how long it took.
        rate: configurations a second.
        continued: how many an earlier run had done, of which there was a checkpoint.
        approach: the direction of the tool's z axis that alone counts, a unit vector in the observer's axes; None for
            any.
        held: where joints are that do not move the tool, as in a configuration of the whole robot, (nq,).
        warnings: what is to be said of it.
    """

    velocity: Velocity
    task: Task
    length: float | None
    length_reference: str
    grid: Grid
    reach_count: NDArray[np.int64]
    best_singular_value: Array
    mean_singular_value: Array
    directions: NDArray[np.uint64]
    best_row: NDArray[np.int64]
    source: Source
    coordinates: Coordinates
    kernel: Kernel
    unit: float
    dimensions: int
    count: int
    outside: int
    complete: bool
    checked: int
    certificate: Certificate
    seconds: float
    rate: float
    continued: int
    approach: tuple[float, float, float] | None
    held: Array
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<CapabilityMap {quote(self.velocity.of)}: {self.voxels} of {self.grid.count} voxels are reached>"

    @cached_property
    def reached(self) -> Flags:
        """Which voxels are reached, (a, b, c)."""
        return np.asarray(self.reach_count > 0)

    @cached_property
    def counted(self) -> int:
        """How many configurations are in voxels: all, but for those that arrive from elsewhere than `approach`."""
        return int(np.sum(self.reach_count))

    @property
    def voxels(self) -> int:
        """How many voxels are reached."""
        return int(np.count_nonzero(self.reached))

    @property
    def singular_value_unit(self) -> str:
        """Unit of singular values; "mixed" where metres and radians are mixed as they are."""
        return unit_with_length(self.task, self.coordinates.turning, self.length, self.length_reference)

    @property
    def volume(self) -> float:
        """What the reached voxels fill: m3, or m2 where the tool stays in a plane of axes, or m."""
        return self.voxels * self.grid.size**self.dimensions

    @property
    def box(self) -> tuple[Array, Array]:
        """The box of the reached voxels: corners with the least and the greatest coordinates, (3,) each, m."""
        return self.grid.origin, self.grid.origin + self.grid.size * np.array(self.grid.shape)

    @cached_property
    def orientation_coverage(self) -> Array:
        """The share of directions of approach that are reached, of each voxel, (a, b, c)."""
        return sphere.coverage(self.directions)

    @cached_property
    def best_voxel(self) -> int:
        """The number in the grid of the voxel with the largest best smallest singular value."""
        return int(np.nanargmax(self.best_singular_value))

    @property
    def low_share(self) -> float:
        """The share of reached voxels whose best is less than a tenth of the best voxel's."""
        best = self.best_singular_value[self.reached]
        return float(np.mean(best < _LOW * np.max(best)))

    @property
    def unseen_share(self) -> float:
        """How likely a further configuration that counts is to reach a voxel that none has reached, about.

        The share of voxels reached once among configurations: I. Good, "The population frequencies of species and the
        estimation of population parameters", Biometrika 40, 1953 (after A. Turing).
        """
        return int(np.count_nonzero(self.reach_count == 1)) / max(self.counted, 1)

    def configurations(self, index: Any, q: Array) -> Array:
        """Return the configuration of the whole robot that is the best of each voxel; q where nothing reaches it.

        Args:
            index: numbers of voxels in the grid, (m,); -1 is none.
            q: where all other joints are, (nq,).

        Returns:
            (m, nq).
        """
        rows = np.where(np.asarray(index) < 0, -1, self.best_row.ravel()[index])
        found = np.broadcast_to(q, (len(rows), len(q))).copy()
        for block in np.unique(rows[rows >= 0] // BLOCK):
            there = np.flatnonzero(rows // BLOCK == block)
            drawn = self.source.rows(int(block) * BLOCK, min((int(block) + 1) * BLOCK, self.source.count))
            found[there] = self.coordinates.configuration(drawn[rows[there] - block * BLOCK], q)
        return found


def capability_map(
    model: Model,
    frame: str,
    q: Array,
    *,
    samples: int | None = None,
    low_discrepancy: int | None = None,
    voxel: float | None = None,
    seed: int = 0,
    axes: str | Sequence[str] | None = None,
    reference: Reference | str = Reference.ALIGNED,
    length: float | Literal["auto", "none"] = "auto",
    approach: Sequence[float] | None = None,
    relative_to: str | None = None,
    point: Sequence[float] | None = None,
    workers: int = 1,
    executor: Executor | None = None,
    checkpoint: str | Path | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> CapabilityMap:
    """Return a map of the voxels that a tool reaches, from configurations drawn inside joint limits.

    Of each voxel: how many configurations reach it; the largest, and the mean, of their smallest singular values; from
    which of 58 directions of equal area the tool's z axis arrives. F. Zacharias, C. Borst and G. Hirzinger, "Capturing
    robot workspace structure: representing robot capabilities", IROS 2007. The grid holds every place that the chain
    can reach (see `capability.bounds`), with the middle of a voxel at the observer's origin. The numbers are the same
    to the bit for any number of workers.

    Args:
        model: the robot.
        frame: the tool's frame, a link.
        q: one configuration, (nq,): where joints are that do not move the tool.
        samples: how many random configurations.
        low_discrepancy: how many of a Halton sequence instead.
        voxel: edge of a voxel, m; default near a twentieth of the reach.
        seed: of the configurations.
        axes: the rows of the Jacobian whose smallest singular value counts; default as in `sweeping.sweep`.
        reference: aligned (those rows in the observer's axes) or local (in the tool's: a torch that may turn about its
            own z axis has axes "xyz rx ry", reference local).
        length: the characteristic length where metres and radians are mixed: in m, "auto" (see `sweeping.sweep`) or
            "none".
        approach: a direction in the observer's axes, any length, such as (0, 0, -1) for a tool that points down: only
            configurations whose tool's z axis is within 15 degrees of it are counted, and mapped.
        relative_to: the observer, a link; default the root link.
        point: the tool point in the frame's coordinates, m; default its origin.
        workers: threads.
        executor: who computes instead of threads.
        checkpoint: a folder that keeps what is done, and that a run goes on from.
        progress: told what is being done, and which share of it is.

    Raises:
        UnknownNameError: no such frame.
        UsageError: not exactly one of samples and low_discrepancy; voxels too small, or too many; no joint, or a
            floating one, between the frames; axes, length, approach or point that cannot be; no configuration arrives
            from the approach.
        ConfigurationError: q has another shape, or a number that is not finite.
    """
    asked = ("position", "minimum_singular_value")
    question: dict[str, Any] = {"axes": axes, "reference": reference, "length": length}
    question |= {"relative_to": relative_to, "point": point}
    question |= {"samples": samples, "low_discrepancy": low_discrepancy, "seed": seed}
    direction = None if approach is None else _direction(approach)
    sweep = sweep_work(model, frame, q, measures=asked, **question)
    if not sweep.rows <= _MOST:
        raise UsageError(f"a map has at most {_MOST:.2g} configurations, not {sweep.rows:.2g}")
    chain, source = sweep.coordinates, sweep.source
    bound = bounds(sweep.kernel, *source.bounds)
    pilot = halton_source(chain, _PILOT).rows(0, _PILOT)
    grid = fitted(bound.low, bound.high, chain.chain.columns(pilot)[1][:, :3, 3], voxel)
    work = MapWork(source, sweep.witness, grid, _unit(bound), direction)
    if progress is not None:
        progress("compiling, once", 0.0)
    if executor is None:
        sweep.kernel(source.rows(0, 1))  # the first of its kind on a machine is compiled, which is no part of the run
    outcome = run(work, workers=workers, executor=executor, checkpoint=checkpoint, progress=progress)
    return _map(work, sweep, outcome)


def _direction(given: Sequence[float]) -> tuple[float, float, float]:
    """Return the unit vector of a direction."""
    vector = np.asarray(given, dtype=np.float64)
    size = float(np.linalg.norm(vector)) if vector.shape == (3,) else 0.0
    if not (math.isfinite(size) and size > 0):
        raise UsageError(
            "an approach is a direction, three numbers", remedy="for instance 0,0,-1: the tool points down"
        )
    x, y, z = (vector / size).tolist()
    return x, y, z


def _unit(bound: Bounds) -> float:
    """Return the unit of fixed point: a power of two, so that scaling rounds nothing."""
    return math.ldexp(1.0, math.frexp(bound.jacobian or 1.0)[1] - _FINE)


def _map(work: MapWork, sweep: SweepWork, outcome: Outcome[VoxelSums]) -> CapabilityMap:
    sums, cells = outcome.partial, outcome.partial.cells
    if not len(cells.index):
        if not outcome.complete:  # interrupted before anything was counted
            raise KeyboardInterrupt
        raise UsageError(
            f"none of {outcome.rows} configurations has the tool's z axis within {APPROACH:g} degrees of the approach",
            remedy="more --samples, or another --approach",
        )
    low, high = _ends(work.grid, cells)
    grid = work.grid.part(low, high)
    at = grid.index(work.grid.centre(cells.index))
    witness, warnings = work.witness, [*sweep.warnings, *outcome.warnings]
    best = int(np.argmax(cells.best))
    sums = sums.merged(work.checked(int(cells.row[best]), float(cells.best[best])))
    differences = sums.differences if sums.checked else (None,) * len(OUTPUTS)
    certificates = [witness.certificate(name, apart) for name, apart in zip(OUTPUTS, differences, strict=True)]
    if not outcome.complete:
        warnings.append(f"interrupted: {outcome.rows} of {work.rows} configurations are in the map")
    return CapabilityMap(
        witness.velocity,
        sweep.task,
        sweep.length,
        sweep.length_reference,
        grid,
        _spread(grid, at, cells.count, 0),
        _spread(grid, at, cells.best, np.nan),
        _spread(grid, at, cells.total / cells.count * work.unit, np.nan),
        _spread(grid, at, cells.directions, 0),
        _spread(grid, at, cells.row, -1),
        work.source,
        sweep.coordinates,
        sweep.kernel,
        work.unit,
        sum(count > 1 for count in work.grid.shape),
        outcome.rows,
        sums.outside,
        outcome.complete,
        sums.checked,
        combined(certificates),
        outcome.seconds,
        outcome.rate,
        outcome.continued,
        work.approach,
        witness.rest,
        tuple(warnings),
    )


def _ends(grid: Grid, cells: Cells) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the least and the greatest place of voxels along x, y and z."""
    places = np.unravel_index(cells.index, grid.shape)
    return tuple(int(place.min()) for place in places), tuple(int(place.max()) for place in places)


def _spread(grid: Grid, at: Any, values: Any, nothing: float) -> Any:
    """Return values of voxels in an array of the whole grid, (a, b, c)."""
    whole = np.full(grid.count, nothing, dtype=values.dtype)
    whole[at] = values
    whole.flags.writeable = False
    return whole.reshape(grid.shape)
