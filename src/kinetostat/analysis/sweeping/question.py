"""From the words of a question to a sweep's work: which configurations, which measures, which kernel; checked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Literal

import numpy as np

from kinetostat.analysis.configuration import checked
from kinetostat.analysis.coordinates import Coordinates, coordinates
from kinetostat.analysis.indices import NEAR
from kinetostat.analysis.jacobian import labelled
from kinetostat.analysis.kernels import chain_kernel
from kinetostat.analysis.loads import Payload, effort_limits
from kinetostat.analysis.singular.mechanism import mechanism
from kinetostat.analysis.sweeping.certifying import UNCHECKED, row_witness
from kinetostat.analysis.sweeping.measures import Asked, Subject, asked, kernel_outputs, subject
from kinetostat.analysis.sweeping.samples import (
    GridSource,
    ListSource,
    Source,
    grid_source,
    halton_source,
    list_source,
    random_source,
)
from kinetostat.analysis.sweeping.sweep_work import SweepWork
from kinetostat.analysis.typical_length import asked_length, unit_with_length
from kinetostat.conventions import Array, Reference
from kinetostat.engines.model import Model
from kinetostat.errors import ConfigurationError, UsageError, cut, quote, quoted, unknown_name

__all__ = ["DEFAULT", "sweep_work"]

DEFAULT = ("yoshikawa", "minimum_singular_value", "inverse_condition_number")
_OVER = {"effort_use": 1.0}  # thresholds that are counted always: more is beyond a limit


def sweep_work(
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
    rows: bool = False,
) -> SweepWork:
    """Return a sweep as work that `running.run` can do, from the arguments of `sweep`, and with its refusals.

    With `rows`, each chunk brings its rows.
    """
    robot, rest, reference = model.robot, checked(model.robot, q), Reference(reference)
    if rest.ndim != 1:
        raise UsageError("a sweep holds the joints that it does not move at one configuration")
    if reference is Reference.WORLD:
        raise UsageError("a sweep's Jacobians are of the tool point", remedy="reference aligned or local")
    velocity = labelled(robot, frame, reference, relative_to, None, point)
    chain = coordinates(model, velocity.of, velocity.relative_to, velocity.point or (0.0, 0.0, 0.0))
    arm = mechanism(model, frame, relative_to=relative_to, point=point, axes=axes, reference=reference)
    task, rank = arm.task, arm.generic_rank
    if not 0 < near <= 1:
        raise UsageError(f"near-singular is below a number between 0 and 1, not {near:g}", remedy=f"such as {NEAR}")
    size, size_reference = asked_length(chain, task, length)
    described = subject(chain, task, rank, unit_with_length(task, chain.turning, size, size_reference))
    wanted = _with_thresholds(asked(measures, described), [*(below or {}), *(above or {})], described)
    if configurations is not None:
        rest = _rest_of(chain, wanted, configurations, rest)
    source = _source(chain, rest, samples, low_discrepancy, grid, configurations, seed, degrees=degrees)
    outputs = kernel_outputs(wanted)
    possible = min(len(task.rows), len(chain.names))
    if rank < possible and {"yoshikawa_gradient", "minimum_gradient"} & set(outputs):
        shown = " ".join(task.row_names)
        raise UsageError(f"no gradient: the rank of {shown} is {rank} everywhere", remedy=f"--axes with {rank} rows")
    if set(outputs) <= set(UNCHECKED):
        outputs = ("placement", *outputs)  # a chain that is the wrong one is found all the same
    kernel = chain_kernel(
        chain,
        outputs,
        rest,
        task=task,
        length=size,
        local=reference is Reference.LOCAL,
        gravity=gravity,
        payload=payload,
        limits=limits,
    )
    warnings = [*_about_limits(chain, source), *_about_outside(chain, source), *_about_efforts(chain, wanted, limits)]
    if described.unit == "mixed" and {"singular_values", "yoshikawa"} & set(outputs):
        remedy = "no turn moves an angular row that counts; --length L" if length == "auto" else "--length auto"
        mixed = "m and rad are mixed: such numbers depend on the unit of length"
        warnings.append(f"{mixed} ({remedy} makes them comparable)")
    if rank < possible and {"singular_values", "yoshikawa"} & set(outputs):
        warnings.append(
            f"the rank of the {len(task.rows)} rows is {rank} at almost every configuration: so many singular values "
            "count (--axes chooses rows)"
        )
    kernel = replace(kernel, rank=rank)
    return SweepWork(
        source,
        wanted,
        row_witness(chain, kernel, rest, velocity, source.bounds, payload),
        reference,
        task,
        size,
        size_reference,
        _thresholds(wanted, below),
        _thresholds(wanted, above, least=_OVER),
        near,
        payload,
        dict(limits or {}),
        seed,
        rows,
        tuple(warnings),
    )


def _source(
    chain: Coordinates,
    rest: Array,
    samples: int | None,
    low_discrepancy: int | None,
    grid: str | Mapping[str, Sequence[float]] | None,
    configurations: Array | None,
    seed: int,
    *,
    degrees: bool,
) -> Source:
    """Return the configurations that exactly one of the arguments says."""
    if sum(one is not None for one in (samples, low_discrepancy, grid, configurations)) != 1:
        raise UsageError(
            "a sweep has one source of configurations",
            remedy="samples, low-discrepancy, grid or configurations: exactly one of them",
        )
    if samples is not None:
        return random_source(chain, samples, seed)
    if low_discrepancy is not None:
        return halton_source(chain, low_discrepancy, seed)
    if grid is not None:
        return grid_source(chain, rest, grid, degrees=degrees)
    return list_source(chain, np.asarray(configurations))


_WEIGHED = {"gravity_torque", "effort_use"}


def _rest_of(chain: Coordinates, wanted: Sequence[Asked], configurations: Array, rest: Array) -> Array:
    """Return where joints outside the chain are in all given configurations of the whole robot.

    Raises:
        UsageError: one of them moves, and weight counts.
    """
    q = np.asarray(configurations, dtype=np.float64)
    if q.ndim != 2 or q.shape[1] != len(rest):
        raise ConfigurationError(f"configurations have the shape (m, {len(rest)}) here, not {q.shape}")
    outside = [i for i in range(len(rest)) if i not in chain.indices]
    if not len(q) or not outside:
        return rest
    moving = [i for i in outside if np.any(q[:, i] != q[0, i])]
    if not moving:
        return checked(chain.model.robot, q[0])
    weighed = [one.name for one in wanted if _WEIGHED & set(one.measure.outputs)]
    if weighed:
        name = chain.model.robot.position_names[moving[0]]
        raise UsageError(
            f"{weighed[0]} depends on {quote(name)}, which the configurations move but which does not move the frame",
            remedy="name a frame that all of them move, or leave the measure out",
        )
    return rest


def _with_thresholds(wanted: tuple[Asked, ...], columns: Sequence[str], described: Subject) -> tuple[Asked, ...]:
    """Return the measures with those that only a threshold names."""
    named = dict.fromkeys(column.partition(".")[0] for column in columns)
    return (*wanted, *(asked([name], described)[0] for name in named if name not in [one.name for one in wanted]))


def _thresholds(
    wanted: Sequence[Asked], given: Mapping[str, float] | None, least: Mapping[str, float] = MappingProxyType({})
) -> tuple[tuple[float, ...], ...]:
    """Return the thresholds of each column that has a distribution: that given, and that of each measure in `least`."""
    columns = [column for one in wanted if one.measure.summary for column in one.columns]
    chosen = dict(given or {})
    for name, threshold in chosen.items():
        if name not in {column.name for column in columns}:
            raise unknown_name("measured column", name, [column.name for column in columns])
        if not math.isfinite(threshold):
            raise UsageError(f"a threshold is a finite number, not {threshold}")
    both = [[one[key] for one, key in ((chosen, c.name), (least, c.measure)) if key in one] for c in columns]
    return tuple(tuple(sorted(set(map(float, each)))) for each in both)


def _about_outside(chain: Coordinates, source: Source) -> list[str]:
    """Return which joints leave their limits in configurations that somebody chose, and in how many."""
    if isinstance(source, GridSource):
        inside = [
            np.count_nonzero(chain.between(_in_column(source.values(j), j, len(chain.names)))[:, j])
            for j in range(len(chain.names))
        ]
        outside = source.count - math.prod(map(int, inside))
        named = [name for name, size, count in zip(chain.names, source.sizes, inside, strict=True) if count < size]
    elif isinstance(source, ListSource):
        between = chain.between(source.values.T)
        outside = int(np.count_nonzero(~np.all(between, axis=1)))
        named = [name for name, always in zip(chain.names, np.all(between, axis=0), strict=True) if not always]
    else:
        return []
    found = f"{outside:,} of {source.count:,} configurations are outside limits: of {quoted(named)}"
    return [found] if named else []


def _in_column(values: Array, column: int, width: int) -> Array:
    """Return rows that have values in one column, zeros in the others. (m,) -> (m, width)."""
    rows = np.zeros((len(values), width))
    rows[:, column] = values
    return rows


def _about_limits(chain: Coordinates, source: Source) -> list[str]:
    """Return what is to be said of limits: joints that cannot move within them, angles and slides that have none."""
    if source.kind not in ("random", "low-discrepancy"):
        return []
    (low, high), (lower, upper) = chain.stated_limits, chain.limits
    named = list(zip(chain.names, chain.turning, low, high, lower, upper, strict=True))
    missing = [
        f"{cut(name)} ({c:.4g} to {d:.4g} {'rad' if turns else 'm'})"
        for name, turns, a, b, c, d in named
        if not (a >= c and b <= d)
    ]
    warnings = []
    if chain.locked:
        warnings.append(f"the limits of {quoted(chain.locked)} are one position: locked there")
    if missing:
        more = f" and {len(missing) - 3} more" if len(missing) > 3 else ""
        warnings.append(f"no limits, so swept: {', '.join(missing[:3])}{more}")
    return warnings


def _about_efforts(
    chain: Coordinates, wanted: Sequence[Asked], limits: Mapping[str, float | tuple[float, float]] | None
) -> list[str]:
    """Return which joints have no effort limit, where that counts.

    Raises:
        UsageError: none has one.
    """
    if not any("effort_use" in one.measure.outputs for one in wanted):
        return []
    known = effort_limits(chain.model.robot, limits)
    lost = [name for joint in dict.fromkeys(chain.joints) for name in joint.velocity_names if name in known.missing]
    if len(lost) == len(chain.names):
        known.refuse(lost, "effort_use")
    if not lost:
        return []
    return [f"no effort limit of {quoted(lost)} (--effort-limits gives them)"]
