"""Sweeps to a view and to JSON, and their rows to fields of a file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.configuration import neutral
from kinetostat.conventions import Array
from kinetostat.errors import cut
from kinetostat.report.json import nested, number
from kinetostat.report.row_files import Numbers, RowField
from kinetostat.report.view import Cell, Table, View, configuration_note, velocity_label

if TYPE_CHECKING:
    from kinetostat.analysis.configuration import Configuration
    from kinetostat.analysis.sweeping.measures import Column
    from kinetostat.analysis.sweeping.sweep import Distribution, Extreme, Sweep, SweepWork

__all__ = ["row_fields", "row_values", "rows_about", "sweep_result", "sweep_view"]

_NOISE = 1e-14  # below it, what rounding leaves of a zero
_PERCENTS = {"5 %": 0.05, "median": 0.5, "95 %": 0.95}
_BINS, _BAR = 10, 14  # of a small histogram: lines, and characters of the longest bar
_BESIDE = 3  # small histograms side by side
_DRAWN = ("random", "low-discrepancy")
_MOST_SHOWN = 6  # measures whose histograms and extremes a page shows


def sweep_view(result: Sweep, at: Configuration, *, degrees: bool) -> View:
    """Return the view: what each measure is over all configurations, how often, where its extremes are, shares."""
    found = list(result.measures.values())
    single = [one for one in found if _is_single(one)]
    varied = [one for one in sorted(found, key=_is_single, reverse=True) if _varies(one)][:_MOST_SHOWN]
    drawn = [one for one in varied if _is_single(one)]
    tables = [_summary_table(single)] if single else []
    for measure, group in groupby(found, key=lambda one: one.column.measure):
        parts = [one for one in group if not _is_single(one)]
        tables += [_summary_table(parts, measure)] if parts else []
    tables += [_histogram_table(drawn[i : i + _BESIDE]) for i in range(0, len(drawn), _BESIDE)]
    if varied:
        tables.append(_extremes_table(result, varied, degrees))
    notes = [*_number_notes(result, found), *_share_notes(result), *_setting_notes(result)]
    if len(result.names) < at.robot.nq:
        notes.append(f"other joints {configuration_note(_others(result, at), degrees)}")
    notes.append(_certified_note(result))
    title = f"{_title(result)} configurations: {result.source_label}\n{velocity_label(result.velocity)}"
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


def _unit(unit: str) -> str:
    """Return a unit as tables show it: none of a pure number."""
    return "" if unit == "1" else unit


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
    """Return what the table says of a measure, NaN where it has no number at all."""
    if one.minimum is None or one.maximum is None:
        return dict.fromkeys(("mean", "minimum", *_PERCENTS, "maximum"), math.nan)
    between = {name: one.quantiles[p] for name, p in _PERCENTS.items()}
    return {"mean": one.mean, "minimum": one.minimum.value, **between, "maximum": one.maximum.value}


def _summary_table(found: Sequence[Distribution], measure: str = "") -> Table:
    """Return a row for each column, those of one measure under its name, or those that are a measure each."""
    rows = [
        (one.column.name.removeprefix(f"{measure}."), _unit(one.unit) or "-", *map(_short, _statistics(one).values()))
        for one in found
    ]
    header = ("" if measure else "measure", "unit", "mean", "min", *_PERCENTS, "max")
    return Table(header, tuple(rows), title=measure, words=True)


# --- small histograms ----------------------------------------------------------------------------------------------


def _histogram_table(found: Sequence[Distribution]) -> Table:
    """Return histograms side by side: for each, from where a bin goes, and a bar."""
    columns = [column for one in found for column in _bars(one)]
    height = max(len(column) for column in columns)
    filled = [column + [""] * (height - len(column)) for column in columns]
    header = [cell for one in found for cell in ("from", _fitting(one.column.name))]
    return Table(tuple(header), tuple(zip(*filled, strict=True)), title="how often", words=True)


def _fitting(name: str) -> str:
    """Return a measure's name as it stands above its bars."""
    words = {"minimum_singular_value": "min. sing. value", "inverse_condition_number": "inv. condition"}
    return words.get(name, cut(name, _BAR + 2))


def _bars(one: Distribution) -> tuple[list[str], list[str]]:
    found = one.histogram(_BINS)
    largest = int(found.counts.max())
    bars = ["" if not n else "#" * max(1, round(_BAR * int(n) / largest)) for n in found.counts]
    return [_short(float(edge)) for edge in found.edges[:-1]], bars


# --- where the extremes are ----------------------------------------------------------------------------------------


def _extremes_table(result: Sweep, found: Sequence[Distribution], degrees: bool) -> Table:
    turns = np.array([180 / math.pi if degrees and unit == "rad" else 1.0 for unit in result.units])
    units = ["deg" if degrees and unit == "rad" else unit for unit in result.units]
    rows: list[tuple[Cell, ...]] = [
        (one.column.name, end, *map(float, extreme.q * turns))
        for one in found
        for end, extreme in (("min", one.minimum), ("max", one.maximum))
        if extreme is not None
    ]
    header = ("", "", *result.names)
    return Table(header, tuple(rows), ("", "", *units), title="configurations of the extremes")


# --- notes ---------------------------------------------------------------------------------------------------------


def _number_notes(result: Sweep, found: Sequence[Distribution]) -> list[str]:
    lost = [one for one in found if one.invalid]
    named = ", ".join(f"{one.column.name} in {_share(one.invalid / result.count)}" for one in lost[:3])
    more = f" and {len(lost) - 3} more" if len(lost) > 3 else ""
    return [f"no number: {named}{more} of the configurations"] if lost else []


def _share_notes(result: Sweep) -> list[str]:
    notes = [
        f"{one.column.name} below {_with_unit(one.threshold, one.column.unit)}: {_share(one.share)} "
        f"({_whole(one.count)} configurations)"
        for one in result.below
    ]
    if result.near_singular_share is not None:
        near = f"smallest / largest singular value below {result.near_singular_below:g}"
        notes.append(f"near-singular ({near}): {_share(result.near_singular_share)}")
    return notes


def _setting_notes(result: Sweep) -> list[str]:
    """Return what the numbers depend on: the rows that count, and the length."""
    notes = [f"rows that count: {' '.join(result.task.row_names)}"] if result.task.name != "full" else []
    if result.length is None:
        return [*notes, *(["no characteristic length: metres and radians as they are"] if result.task.mixed else [])]
    return [*notes, f"characteristic length {result.length:.6g} m ({result.length_reference})"]


def _certified_note(result: Sweep) -> str:
    if result.certificate.max_difference is None:
        return ""
    again = "some of every chunk and all extremes, computed again by Pinocchio"
    return f"{_whole(result.certified_rows)} configurations, {again}"


def _others(result: Sweep, at: Configuration) -> Configuration:
    """Return the configuration with joints that are swept at zero: where they are is not one position."""
    swept = [i for i, name in enumerate(at.robot.position_names) if name in result.names]
    q = result.rest.copy()
    q[swept] = neutral(at.robot)[swept]
    return replace(at, q=q)


def _flat(found: Sequence[Distribution]) -> Table:
    """Return a row for each measure, for CSV."""
    levels = list(found[0].quantiles) if found else []
    rows: list[tuple[Cell, ...]] = []
    for one in found:
        ends = (one.mean, *(None if end is None else end.value for end in (one.minimum, one.maximum)))
        cells = [number(value) for value in (*ends, *one.quantiles.values())]
        rows.append((one.column.name, _unit(one.unit), str(one.count), str(one.invalid), *cells))
    header = ("measure", "unit", "count", "invalid", "mean", "minimum", "maximum")
    return Table((*header, *(f"quantile_{level:g}" for level in levels)), tuple(rows))


# --- JSON ----------------------------------------------------------------------------------------------------------


def sweep_result(result: Sweep, numbers: Numbers | None = None) -> dict[str, Any]:
    """Return the result object of `sweep`: SI units; nothing in it depends on how many computed it.

    `numbers` are those that rows have in the list that they come from, (m,); default: from 1 on.
    """
    payload: dict[str, Any] = {
        **_question(result),
        "count": result.count,
        "complete": result.complete,
        "requested": result.requested,
        "source": {
            "kind": result.source_kind,
            "label": result.source_label,
            "seed": result.seed if result.source_kind in _DRAWN else None,
        },
        "coordinates": list(result.names),
        "coordinate_units": list(result.units),
        "measures": {name: _distribution(result, one, numbers) for name, one in result.measures.items()},
        "near_singular_share": result.near_singular_share,
        "near_singular_below": result.near_singular_below,
        "below": [
            {
                "measure": one.column.name,
                "threshold": one.threshold,
                "unit": one.column.unit,
                "count": one.count,
                "share": one.share,
            }
            for one in result.below
        ],
        "certified": {
            "count": result.certified_rows,
            "max_differences": {
                name: {"max_difference": number(each.max_difference), "tolerance": each.tolerance}
                for name, each in result.certificates.items()
            },
        },
    }
    if result.near_singular_share is None:
        payload["near_singular_share_reason"] = "no measure that was asked for needs singular values"
    return payload


def _question(result: Sweep) -> dict[str, Any]:
    velocity = result.velocity
    return {
        "frame": velocity.of,
        "relative_to": velocity.relative_to,
        "reference": str(result.reference),
        "expressed_in": velocity.expressed_in,
        "point": None if velocity.point is None else list(velocity.point),
        "rows": list(result.task.row_names),
        "characteristic_length": result.length,
        "characteristic_length_reference": result.length_reference,
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
    units = tuple("rad" if turns else "m" for turns in work.coordinates.turning)
    fields = [RowField("q", names, units, (len(names),))]
    for measure, group in groupby(work.columns, key=lambda column: column.measure):
        columns = tuple(group)
        labels, of_columns = tuple(c.name for c in columns), tuple(_unit(c.unit) for c in columns)
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


def rows_about(work: SweepWork, opening: dict[str, Any]) -> dict[str, Any]:
    """Return what a file of rows says of all of them, after `opening`."""
    source = {"kind": work.source.kind, "label": work.source.label, "count": work.source.count}
    return {**opening, "source": source}
