"""Sweeps to a view and to JSON, and their rows to fields of a file."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from itertools import groupby, zip_longest
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis import held
from kinetostat.analysis.configuration import Configuration
from kinetostat.analysis.sweeping.samples import GridSource
from kinetostat.analysis.typical_length import PURE
from kinetostat.conventions import GRAVITY, Array
from kinetostat.errors import cut, quote
from kinetostat.report.asked import asked_load, asked_tool
from kinetostat.report.json import closing, nested, number
from kinetostat.report.measured import reading
from kinetostat.report.row_files import Numbers, RowField
from kinetostat.report.view import Cell, Table, View, configuration_note, velocity_label

if TYPE_CHECKING:
    from kinetostat.analysis.sweeping.measures import Column
    from kinetostat.analysis.sweeping.sweep import Beyond, Distribution, Extreme, Sweep, SweepWork

__all__ = [
    "beyond_notes",
    "grid_arrays",
    "held_joints",
    "row_fields",
    "row_values",
    "rows_about",
    "sweep_result",
    "sweep_view",
]

_NOISE = 1e-14  # below it, what rounding leaves of a zero
_PERCENTS = {"5 %": 0.05, "median": 0.5, "95 %": 0.95}
_BINS, _BAR = 10, 14  # of a small histogram: lines, and characters of the longest bar
_BESIDE = 3  # small histograms side by side
_DRAWN = ("random", "low-discrepancy")
_MOST_EXTREMES = 8  # columns whose extremes a page shows
_WIDTH, _BETWEEN, _LEAST = 80, 2, 12  # of a page, between columns of it, and of the column of names, in characters


def sweep_view(result: Sweep, at: Configuration, *, degrees: bool) -> View:
    """Return the view: what each measure is over all configurations, how often, where its extremes are, shares.

    `at` is where joints are held that the sweep does not move, see `held_joints`.
    """
    found = list(result.measures.values())
    single = [one for one in found if _is_single(one)]
    tables = [_summary_table(single)] if single else []
    for _, group in groupby(found, key=lambda one: one.column.measure):
        parts = [one for one in group if not _is_single(one)]
        tables += [_summary_table(parts, parts=True)] if parts else []
    drawn, varied = [one for one in single if _varies(one)], [one for one in found if _varies(one)]
    tables += [_histogram_table(drawn[i : i + _BESIDE]) for i in range(0, len(drawn), _BESIDE)]
    shown = _most_telling(varied)
    if shown:
        tables.append(_extremes_table(result, shown, degrees))
    notes = [*_left_out_notes(found, shown, varied), *_number_notes(result, found), *beyond_notes(result)]
    notes += [*_near_notes(result), *_setting_notes(result), *_load_notes(result)]
    if len(result.source.moved) < at.robot.nq:
        notes.append(f"other joints {configuration_note(at, degrees)}")
    notes.append(_certified_note(result))
    title = f"{_title(result)} configurations: {result.source.label}\n{velocity_label(result.velocity)}"
    return View(title, tuple(tables), tuple(note for note in notes if note), flat=_flat(found))


def _title(result: Sweep) -> str:
    if result.complete:
        return f"sweep of {_whole(result.count)}"
    return f"PARTIAL sweep, interrupted: {_whole(result.count)} of {_whole(result.requested)}"


def _is_single(one: Distribution) -> bool:
    """Return whether a column is all of its measure, or what stands for all of it, and not one part of several."""
    return one.column.name == one.column.measure


def _varies(one: Distribution) -> bool:
    return one.minimum is not None and one.maximum is not None and one.minimum.value < one.maximum.value


def _whole(count: int) -> str:
    return f"{count:,}"


def _short(value: float | None) -> str:
    if value is None or not math.isfinite(value):
        return "-"
    text = f"{value:.3g}" if abs(value) > _NOISE else "0"
    return f"{value:.1e}" if "e" in text else text  # no wider than others


def _with_unit(value: float, unit: str) -> str:
    return f"{value:g} {unit}" if unit not in ("1", "mixed") else f"{value:g}"


def _share(share: float) -> str:
    return f"{100 * share:.3g} %"


def _statistics(one: Distribution) -> dict[str, float]:
    """Return what the table says of a measure, in the unit that is shown; NaN where it has no number at all."""
    if one.minimum is None or one.maximum is None:
        return dict.fromkeys(("mean", "minimum", *_PERCENTS, "maximum"), math.nan)
    between = {name: one.quantiles[p] for name, p in _PERCENTS.items()}
    found = {"mean": one.mean, "minimum": one.minimum.value, **between, "maximum": one.maximum.value}
    return {name: reading(one.column).factor * value for name, value in found.items()}


def _summary_table(found: Sequence[Distribution], *, parts: bool = False) -> Table:
    """Return a row for each column: the parts of one measure under its name, or those that are a measure each.

    Where all have one unit, the title has it. Long names go on in the next line.
    """
    shown = [reading(one.column) for one in found]
    units = {each.unit for each in shown}
    one_unit = parts and len(units) == 1
    header = ("" if parts else "measure", *(() if one_unit else ("unit",)), "mean", "min", *_PERCENTS, "max")
    rows = list[tuple[Cell, ...]]()
    cells = [
        (*(() if one_unit else (each.unit,)), *map(_short, _statistics(one).values()))
        for one, each in zip(found, shown, strict=True)
    ]
    widths = [max(len(text) for text in column) for column in zip(header[1:], *cells, strict=True)]
    room = max(_LEAST, _WIDTH - sum(width + _BETWEEN for width in widths))
    for each, values in zip(shown, cells, strict=True):
        first, *more = textwrap.wrap(each.part if parts else each.name, room)
        rows += [(first, *values), *((line, *("" for _ in values)) for line in more)]
    unit = f", unit {next(iter(units))}" if one_unit else ""
    return Table(header, tuple(rows), title=f"{shown[0].measure}{unit}" if parts else "", words=True)


# --- small histograms ----------------------------------------------------------------------------------------------


def _histogram_table(found: Sequence[Distribution]) -> Table:
    """Return histograms side by side: for each, from where a bin goes, and a bar."""
    columns, heads = list[list[str]](), list[list[str]]()
    for one in found:
        columns += _bars(one)
        heads += [["from"], textwrap.wrap(reading(one.column).title, _BAR + 2)]
    header, *more = zip_longest(*heads, fillvalue="")
    return Table(header, (*more, *zip_longest(*columns, fillvalue="")), title="how often", words=True)


def _bars(one: Distribution) -> tuple[list[str], list[str]]:
    found, factor = one.histogram(_BINS), reading(one.column).factor
    largest = int(found.counts.max())
    bars = ["" if not n else "#" * max(1, round(_BAR * int(n) / largest)) for n in found.counts]
    return [_short(factor * float(edge)) for edge in found.edges[:-1]], bars


# --- where the extremes are ----------------------------------------------------------------------------------------


def _most_telling(varied: Sequence[Distribution]) -> list[Distribution]:
    """Return the columns whose extremes are shown: measures of one number, then of the others what is largest."""
    single = [one for one in varied if _is_single(one)]
    named = {one.column.measure for one in single}  # the largest effort use is that of a joint
    parts = [one for one in varied if one.column.measure not in named]
    by_measure = [
        sorted(group, key=lambda one: -max(abs(end.value) for end in (one.minimum, one.maximum) if end is not None))
        for _, group in groupby(parts, key=lambda one: one.column.measure)
    ]
    in_turn = [one for each in zip_longest(*by_measure) for one in each if one is not None]
    chosen = {one.column.name for one in [*single, *in_turn][:_MOST_EXTREMES]}
    return [one for one in varied if one.column.name in chosen]


def _extremes_table(result: Sweep, found: Sequence[Distribution], degrees: bool) -> Table:
    moved = [j for j, name in enumerate(result.names) if name in result.source.moved]
    units = ["deg" if degrees and result.units[j] == "rad" else result.units[j] for j in moved]
    turns = np.array([180 / math.pi if unit == "deg" else 1.0 for unit in units])
    rows: list[tuple[Cell, ...]] = [
        (reading(one.column).name, end, *map(float, extreme.q[moved] * turns))
        for one in found
        for end, extreme in (("min", one.minimum), ("max", one.maximum))
        if extreme is not None
    ]
    header = ("", "", *(result.names[j] for j in moved))
    return Table(header, tuple(rows), ("", "", *units), title="configurations of the extremes")


# --- notes ---------------------------------------------------------------------------------------------------------


def _left_out_notes(
    found: Sequence[Distribution], shown: Sequence[Distribution], varied: Sequence[Distribution]
) -> list[str]:
    """Return which columns have no histogram and no extremes above, and why."""
    same = [one for one in found if one.minimum is not None and not _varies(one)]
    notes = []
    if same:
        named = [f"{reading(one.column).name} {_short(reading(one.column).factor * one.mean)}" for one in same[:3]]
        more = f" and {len(same) - 3} more" if len(same) > 3 else ""
        notes.append(f"the same everywhere: {', '.join(named)}{more}")
    if len(shown) < len(varied):
        notes.append(f"extremes of {len(shown)} of {len(varied)} columns are shown; -F json has all")
    return notes


def _number_notes(result: Sweep, found: Sequence[Distribution]) -> list[str]:
    lost = [one for one in found if one.invalid]
    named = ", ".join(f"{reading(one.column).name} in {_share(one.invalid / result.count)}" for one in lost[:3])
    more = f" and {len(lost) - 3} more" if len(lost) > 3 else ""
    return [f"no number: {named}{more} of the configurations"] if lost else []


def beyond_notes(result: Sweep) -> list[str]:
    """Return what is to be said of thresholds, and of the joint that is loaded most."""
    own = [one for one in result.above if one.column.measure == "effort_use" and one.threshold == 1]
    given = [*((one, "below") for one in result.below), *((one, "above") for one in result.above if one not in own)]
    return [_beyond_note(one, side) for one, side in given] + _largest_use(result, own)


def _beyond_note(one: Beyond, side: str) -> str:
    shown = reading(one.column)
    level = f"{shown.name} {side} {_with_unit(shown.factor * one.threshold, shown.unit)}"
    return f"{level}: {_share(one.share)} ({_whole(one.count)} configurations)"


def _largest_use(result: Sweep, over: Sequence[Beyond]) -> list[str]:
    """Return which joint's effort use is the largest, and how often limits of effort are exceeded."""
    uses = [(one.maximum.value, name) for name, one in result.measures.items() if _is_use(one) and one.maximum]
    if not uses:
        return []
    largest, name = max(uses)
    shares = {one.column.name: one.share for one in over}
    own, some = shares.get(name, 0.0), shares.get("effort_use", 0.0)
    others = f" (some joint over its own: {_share(some)})" if some != own else ""
    joint = cut(reading(result.measures[name].column).part)
    return [f"largest effort use: {joint}, {_share(largest)}; over its limit in {_share(own)}{others}"]


def _is_use(one: Distribution) -> bool:
    return one.column.measure == "effort_use" and not _is_single(one)


def _near_notes(result: Sweep) -> list[str]:
    if result.near_singular_share is None:
        return []
    near = f"smallest / largest singular value below {result.near:g}"
    return [f"near-singular ({near}): {_share(result.near_singular_share)}"]


def _setting_notes(result: Sweep) -> list[str]:
    """Return what the numbers depend on: the rows that count, and the length."""
    notes = [f"rows that count: {' '.join(result.task.row_names)}"] if result.task.name != "full" else []
    if result.length is not None:
        return [*notes, f"characteristic length {result.length:.6g} m ({result.length_reference})"]
    apart = result.task.mixed and result.length_reference != PURE
    return [*notes, *(["no characteristic length: metres and radians as they are"] if apart else [])]


def _load_notes(result: Sweep) -> list[str]:
    """Return the load that torques are of, but for what is usual."""
    notes = list[str]()
    if result.gravity is not None and tuple(result.gravity) != tuple(GRAVITY):
        notes.append(f"gravity ({', '.join(f'{part:g}' for part in result.gravity)}) m/s2 in the axes of the root link")
    if result.gravity is not None and result.payload is not None:
        at = ", ".join(f"{part:g}" for part in result.payload.point)
        notes.append(f"payload {result.payload.mass:g} kg at ({at}) m of {cut(result.payload.frame)}")
    if result.limits:
        named = [f"{cut(name)} {_limit(limit)}" for name, limit in list(result.limits.items())[:3]]
        more = f" and {len(result.limits) - 3} more" if len(result.limits) > 3 else ""
        notes.append(f"effort limits given, in Nm or N: {', '.join(named)}{more}")
    return notes


def _limit(limit: float | tuple[float, float]) -> str:
    return f"{limit:g}" if isinstance(limit, (int, float)) else f"{limit[0]:g} to {limit[1]:g}"


def _certified_note(result: Sweep) -> str:
    if result.certificate.max_difference is None:
        return ""
    again = "some of every chunk and all extremes, computed again by Pinocchio"
    return f"{_whole(result.certified_rows)} configurations, {again}"


def held_joints(work: SweepWork, warnings: Sequence[str] = ()) -> Configuration:
    """Return where joints are held that a sweep does not move; those that it moves are at zero, and not in JSON.

    `warnings` are those of the configuration that was asked for; what they say of joints of the chain is left out: it
    is said of the configurations that are swept.
    """
    robot = work.coordinates.model.robot
    about_chain = tuple(f"joint {quote(joint.name)} is at " for joint in work.coordinates.joints)
    kept = tuple(warning for warning in warnings if not warning.startswith(about_chain))
    return held.held_joints(Configuration(robot, work.witness.rest, kept), work.source.moved)


def _flat(found: Sequence[Distribution]) -> Table:
    """Return a row for each measure, for CSV."""
    levels = list(found[0].quantiles) if found else []
    rows: list[tuple[Cell, ...]] = []
    for one in found:
        ends = (one.mean, *(None if end is None else end.value for end in (one.minimum, one.maximum)))
        cells = [number(value) for value in (*ends, *one.quantiles.values())]
        rows.append((one.column.name, one.unit, str(one.count), str(one.invalid), *cells))
    header = ("measure", "unit", "count", "invalid", "mean", "minimum", "maximum")
    return Table((*header, *(f"quantile_{level:g}" for level in levels)), tuple(rows))


# --- JSON ----------------------------------------------------------------------------------------------------------


def sweep_result(result: Sweep, numbers: Numbers | None = None) -> dict[str, Any]:
    """Return the result object of `sweep`: SI units; nothing in it depends on how many computed it.

    `numbers` are those that rows have in the list that they come from, (m,); default: from 1 on.
    """
    payload: dict[str, Any] = {
        "asked": _asked(result),
        "count": result.count,
        "complete": result.complete,
        "requested": result.requested,
        "source": _source(result),
        "coordinates": list(result.names),
        "coordinate_units": list(result.units),
        "measures": {name: _distribution(result, one, numbers) for name, one in result.measures.items()},
        "near_singular_share": result.near_singular_share,
        "near_singular_below": result.near,
        "below": [_beyond(one) for one in result.below],
        "above": [_beyond(one) for one in result.above],
        "certified": _certified(result),
    }
    if result.near_singular_share is None:
        payload["near_singular_share_reason"] = "no measure that was asked for needs singular values"
    return payload


def _asked(result: Sweep | SweepWork) -> dict[str, Any]:
    """Return all that the numbers depend on beside the robot and the configurations."""
    robot = result.robot
    held = [i for i, name in enumerate(robot.position_names) if name not in result.source.moved]
    return {
        **asked_tool(result.velocity, result.task, result.length, result.length_reference),
        "near_singular_below": result.near,
        **asked_load(result.gravity, result.payload, result.limits),
        "held": {robot.position_names[i]: number(float(result.rest[i])) for i in held},
    }


def _source(result: Sweep | SweepWork) -> dict[str, Any]:
    """Return which configurations were asked for; of a grid, its axes, of which the last one changes fastest."""
    source = result.source
    found: dict[str, Any] = {"kind": source.kind, "label": source.label, "count": source.count}
    found["seed"] = result.seed if source.kind in _DRAWN else None
    if isinstance(source, GridSource):
        units = dict(zip(result.names, result.units, strict=True))
        ends = {name: (float(values[0]), float(values[-1]), len(values)) for name, values in source.axes.items()}
        found["grid"] = [
            {"coordinate": name, "unit": units[name], "from": low, "to": high, "count": size}
            for name, (low, high, size) in ends.items()
        ]
    return found


def _beyond(one: Beyond) -> dict[str, Any]:
    return {
        "measure": one.column.name,
        "threshold": one.threshold,
        "unit": one.column.unit,
        "count": one.count,
        "share": one.share,
    }


def _certified(result: Sweep) -> dict[str, Any]:
    return {
        "count": result.certified_rows,
        "max_differences": {
            name: {"max_difference": number(each.max_difference), "tolerance": each.tolerance}
            for name, each in result.certificates.items()
        },
    }


def _distribution(result: Sweep, one: Distribution, numbers: Numbers | None) -> dict[str, Any]:
    found: dict[str, Any] = {"unit": one.unit, "count": one.count, "invalid": one.invalid}
    if one.minimum is None or one.maximum is None:
        empty = dict.fromkeys(("mean", "minimum", "maximum", "quantiles", "histogram"))
        return {**found, **empty, "reason": "it is a number in no configuration"}
    histogram = one.histogram()
    return {
        **found,
        "mean": number(one.mean),
        "minimum": _extreme(result, one.minimum, numbers),
        "maximum": _extreme(result, one.maximum, numbers),
        "quantiles": {f"{level:g}": number(value) for level, value in one.quantiles.items()},
        "quantile_relative_error": one.accuracy,
        "histogram": {"edges": nested(histogram.edges), "counts": [int(n) for n in histogram.counts]},
    }


def _extreme(result: Sweep, extreme: Extreme, numbers: Numbers | None) -> dict[str, Any]:
    row = extreme.row + 1 if numbers is None else int(numbers[extreme.row])
    where = dict(zip(result.names, nested(extreme.q), strict=True))
    return {"value": number(extreme.value), "row": row, "configuration": where}


# --- rows ----------------------------------------------------------------------------------------------------------


def row_fields(work: SweepWork) -> list[RowField]:
    """Return the fields of a file of rows: the coordinates as `q`, and each measure under its name."""
    names = work.source.names
    fields = [RowField("q", names, work.units, (len(names),))]
    for measure, group in groupby(work.columns, key=lambda column: column.measure):
        columns = tuple(group)
        labels, of_columns = tuple(c.name for c in columns), tuple(c.unit for c in columns)
        fields.append(RowField(measure, labels, of_columns, _shape(measure, columns, len(names))))
    return fields


def _shape(measure: str, columns: Sequence[Column], joints: int) -> tuple[int, ...]:
    """Return the shape of a measure in one configuration; () is one number."""
    if measure == "jacobian":
        return (6, joints)
    return () if len(columns) == 1 and columns[0].name == measure else (len(columns),)


def row_values(fields: Sequence[RowField], q: Array, values: Array) -> list[Array]:
    """Return the arrays (m, *shape) of the fields from coordinates (m, n) and the columns of all measures (m, c)."""
    found, at = [q], 0
    for field in fields[1:]:
        width = len(field.columns)
        found.append(values[:, at : at + width].reshape(len(q), *field.shape))
        at += width
    return found


def rows_about(work: SweepWork, opening: dict[str, Any], result: Sweep | None = None) -> dict[str, Any]:
    """Return what a file of rows says of all of them, after `opening`; with the result, its certificate, too."""
    known = {**opening, "asked": _asked(work), "source": _source(work)}
    if result is None:
        return known
    return {**known, **closing(result.certificate, result.warnings), "certified": _certified(result)}


def grid_arrays(work: SweepWork) -> dict[str, Array]:
    """Return the positions of each axis of a grid, (size,), as `grid.JOINT`; of other sources nothing."""
    source = work.source
    if not isinstance(source, GridSource):
        return {}
    return {f"grid.{name}": values for name, values in source.axes.items()}
