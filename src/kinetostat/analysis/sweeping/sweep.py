"""Sweeps: measures of millions of configurations, their distributions and extremes, or row by row; certified."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Literal

from kinetostat.analysis.indices import NEAR
from kinetostat.analysis.loads import Payload
from kinetostat.analysis.sweeping.question import DEFAULT, sweep_work
from kinetostat.analysis.sweeping.result import QUANTILES, Beyond, Distribution, Extreme, Sweep
from kinetostat.analysis.sweeping.running import run
from kinetostat.analysis.sweeping.sweep_work import RowBlock, SweepPartial, SweepWork
from kinetostat.conventions import Array, Reference
from kinetostat.engines.model import Model

__all__ = [
    "DEFAULT",
    "QUANTILES",
    "Beyond",
    "Distribution",
    "Extreme",
    "RowBlock",
    "Sweep",
    "SweepPartial",
    "SweepWork",
    "sweep",
    "sweep_work",
]


def sweep(
    model: Model,
    frame: str,
    q: Array,
    *,
    samples: int | None = None,
    low_discrepancy: int | None = None,
    grid: str | Mapping[str, Sequence[float]] | None = None,
    configurations: Array | None = None,
    seed: int = 0,
    measures: str | Sequence[str] = DEFAULT,
    relative_to: str | None = None,
    point: Sequence[float] | None = None,
    reference: Reference | str = Reference.ALIGNED,
    axes: str | Sequence[str] | None = None,
    length: float | Literal["auto", "none"] = "auto",
    gravity: Sequence[float] | Array | bool = True,
    payload: Payload | None = None,
    limits: Mapping[str, float | tuple[float, float]] | None = None,
    below: Mapping[str, float] | None = None,
    above: Mapping[str, float] | None = None,
    near: float = NEAR,
    degrees: bool = False,
    workers: int = 1,
    executor: Executor | None = None,
    checkpoint: Path | str | None = None,
    progress: Callable[[str, float], None] | None = None,
    sink: Callable[[RowBlock], None] | None = None,
) -> Sweep:
    """Return how measures of a frame are distributed over many configurations, by the compiled kernel.

    Exactly one of `samples`, `low_discrepancy`, `grid` and `configurations` says which configurations. The answer is
    the same to the bit for any number of workers: random numbers belong to chunks, and what chunks give is added up
    exactly. Of each chunk a few rows, and all extremes, are computed again by Pinocchio. The memory needed does not
    grow with the number of configurations.

    Args:
        model: the robot.
        frame: F, a link.
        q: where joints stay that are not swept, (nq,).
        samples: so many random configurations, uniform inside limits. An angle without limits makes a whole turn, a
            slide without limits 1 m to either side.
        low_discrepancy: so many configurations that fill the limits evenly.
        grid: `j=lo:hi:n,k=...` or {name: (lo, hi, n)}; other joints stay at q.
        configurations: these, (m, nq).
        seed: the same seed gives the same configurations.
        measures: any of yoshikawa, minimum_singular_value, inverse_condition_number (smallest over largest), isotropy,
            singular_values, position (of the tool point, m), yoshikawa_gradient, minimum_gradient (along each
            coordinate), gravity_torque (Nm or N), effort_use (gravity torque over effort limit: 1 is all), and
            limit_distance (1 in the middle of the range of the joint nearest to a limit, 0 at its end); with a sink
            also pose and jacobian.
        relative_to: A, the observer's link; default the root link.
        point: the point in F's coordinates, in m; default F's origin.
        reference: aligned (rows in the observer's axes) or local (in F's).
        axes: the rows that count, such as "x y rz", see `Task.named`; default all six, or the linear ones of an arm
            with three joints or fewer (see `singular.mechanism`). Of the singular values those count that are not zero
            almost everywhere.
        length: what makes metres and radians comparable where they meet: a length in m, "auto" (over the configurations
            inside limits, see `typical_length`), or "none": mix them.
        gravity: True (9.81 m/s2 down the root's z) or a vector (3,) in the root's axes.
        payload: a mass that weighs with the links.
        limits: effort limits of joints instead of the file's.
        below: thresholds by the name of a measure or of a column (`position.x`): which share is below. A measure that
            only a threshold names is measured, too.
        above: the same: which share is above. An effort use above 1 is counted always.
        near: a configuration is near-singular with an inverse condition number (of length-scaled rows) below it.
        degrees: ends of a grid's angles are in degrees.
        workers: threads.
        executor: who computes instead; see `running.run`.
        checkpoint: a folder that keeps what is done.
        progress: told what is being done, and which share of it is.
        sink: given the rows, in order, as `RowBlock`s: .start is the number of the first, from 0, .q is (m, n), .values
            (m, c) with the columns of measures in the order asked for, each as long as `RowBlock` says.

    Raises:
        UnknownNameError: no such frame, joint or measure.
        UsageError: not exactly one source; a part of the question that cannot be.
        ConfigurationError: q, or configurations, of another shape, or with a number that is not finite.
        NumberError: a link's mass is negative, and weight counts.
    """
    work = sweep_work(
        model,
        frame,
        q,
        samples=samples,
        low_discrepancy=low_discrepancy,
        grid=grid,
        configurations=configurations,
        seed=seed,
        measures=measures,
        relative_to=relative_to,
        point=point,
        reference=reference,
        axes=axes,
        length=length,
        gravity=gravity,
        payload=payload,
        limits=limits,
        below=below,
        above=above,
        near=near,
        degrees=degrees,
        rows=sink is not None,
    )

    def pass_on(_: int, partial: SweepPartial) -> None:
        if sink is not None and partial.table is not None:
            sink(partial.table)

    outcome = run(
        work,
        workers=workers,
        executor=executor,
        checkpoint=checkpoint,
        progress=progress,
        sink=None if sink is None else pass_on,
    )
    return work.result(outcome)
