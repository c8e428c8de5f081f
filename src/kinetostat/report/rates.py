"""Joint rates from a twist to a view and to JSON."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.conventions import TWIST_ROWS, TWIST_UNITS, Array, Order
from kinetostat.errors import cut
from kinetostat.report.json import nested, number
from kinetostat.report.rows import Column, use_columns
from kinetostat.report.view import Cell, Table, View, configuration_note, velocity_label

if TYPE_CHECKING:
    from kinetostat.analysis.configuration import Configuration
    from kinetostat.analysis.crosscheck import Certificate
    from kinetostat.analysis.rates import ResolvedRates

__all__ = ["rates_columns", "rates_result", "rates_view"]

_NEAR = 0.05  # smallest over largest singular value below which the growth of rates is told
_NOISE = 1e-12  # of the largest number beside it: what is smaller is rounding
_LENGTH = "auto: equal weight of linear and angular parts of turning joints (all rows)"
_NO_LENGTH = "1 m: no joint turns, or every axis passes through the point"


def rates_view(result: ResolvedRates, at: Configuration, *, order: Order, degrees: bool) -> View:
    """Return the view: a row a joint; what the rates give; how they grow near a singular configuration."""
    notes = [_verdict(result), *_use_notes(result), *_growth_notes(result), _values_note(result)]
    if result.secondary:
        notes.append(f"null space: {_SECONDARY[result.secondary]}")
    title = f"joint rates for a velocity {velocity_label(result.velocity)}"
    tables = (_joint_table(result, degrees), _twist_table(result, order))
    return View(title, tables, (*notes, configuration_note(at, degrees)), flat=_flat(result))


_SECONDARY = {
    "mid-limits": "towards the middle of the joint limits, as in a second",
    "manipulability": "along the steepest ascent of manipulability",
    "given": "the given rates, as far as they move nothing",
}


def _joint_table(result: ResolvedRates, degrees: bool) -> Table:
    """Return a row a joint: its rate, the part of it in the null space if there is a secondary task, its limit."""
    used, noise, named = result.utilisation, _NOISE * _largest(result.rates), bool(result.secondary)
    rows: list[tuple[Cell, ...]] = []
    for i, name in enumerate(result.columns):
        factor = 180 / math.pi if degrees and result.column_units[i] == "rad/s" else 1.0
        unit = "deg/s" if factor != 1 else result.column_units[i]
        parts = (result.rates[i], result.null_rates[i]) if named else (result.rates[i],)
        shown = (f"{_cleared(float(part), noise) * factor:.6g}" for part in parts)
        limit = "-" if math.isnan(result.limits[i]) else f"{float(result.limits[i]) * factor:.5g}"
        use = "-" if math.isnan(used[i]) else f"{100 * float(used[i]):.1f} %"
        rows.append((name, *shown, unit, limit, use))
    header = ("joint", "rate", *(("null space",) if named else ()), "unit", "limit", "use")
    return Table(header, tuple(rows), words=True)


def _largest(values: Array) -> float:
    return float(np.max(np.abs(values), initial=0.0))


def _cleared(value: float, noise: float) -> float:
    """Return the value, 0 for what is rounding; never -0."""
    return value + 0.0 if abs(value) > noise else 0.0


def _twist_table(result: ResolvedRates, order: Order) -> Table:
    """Return the wanted twist and what is left of it, in the rows that count."""
    wanted, rows = np.asarray(result.twist), list[tuple[Cell, ...]]()
    for row in order.rows:
        if row in result.task.rows:
            lever = float(result.length) if row < 3 else 1.0  # a joint moves the frame about as fast as that x its rate
            noise = _NOISE * max(_largest(wanted[list(result.task.rows)]), lever * _largest(result.rates))
            left = _cleared(float(result.residual[row]), noise)
            numbers = (float(wanted[row]), float(wanted[row]) - left, left)
            rows.append((TWIST_ROWS[row], TWIST_UNITS[row], *(f"{number + 0.0:.6g}" for number in numbers)))
    title = "the velocity"
    if len(result.task.rows) < 6:
        title += "; rows that do not count are left out"
    return Table(("", "unit", "wanted", "given", "left"), tuple(rows), title=title, words=True)


def _moves_inside(result: ResolvedRates) -> bool:
    """Return whether a part of the rates is in the null space, beyond rounding."""
    return _largest(result.null_rates) > _NOISE * _largest(result.rates)


def _verdict(result: ResolvedRates) -> str:
    """Return in words what kind of answer this is."""
    count, rank, rows = len(result.columns), int(result.rank), len(result.task.rows)
    least = f"the least {'weighted ' if result.weights is not None else ''}norm"
    if result.damping:
        return f"damped least squares, damping {result.damping:g}: what is left of the velocity is its price"
    if not bool(result.exact):
        return f"least squares: the joints give {rank} of the {rows} directions, and this velocity is not among them"
    if rank == count:
        return "exact, and the only rates that give it"
    family = f"a {count - rank}-parameter family of rates"
    if _moves_inside(result):
        return f"exact, one of {family}: those with {least}, plus the null space's"
    return f"exact, with {least} of {family}"


def _use_notes(result: ResolvedRates) -> list[str]:
    index = int(result.binding)
    if index < 0:
        return ["no joint has a velocity limit"]
    use = float(result.utilisation[index])
    note = f"{cut(result.columns[index])} is nearest to its velocity limit: {100 * use:.1f} %"
    slower = use > 1 and not _moves_inside(result)  # rates of the null space do not shrink with the velocity
    return [note + (f"; at {1 / use:.4g} of this velocity it would just do" if slower else "")]


def _growth_notes(result: ResolvedRates) -> list[str]:
    """Return what is to be said near a singular configuration: how large the rates are, and how they grow."""
    rank, usual, damped = int(result.rank), result.usual_rank, bool(result.damping)
    smallest, largest = float(result.smallest), float(result.singular_values[0])
    if rank < usual:
        line = f"singular here: the joints give {rank} of the {usual} directions that they give almost everywhere"
        cause = "" if damped else "; rates of a velocity in a lost one are without bound nearby"
        return [f"{line}{cause} (kinetostat singular at)"]
    if smallest > _NEAR * largest or not usual:
        return []
    line = f"near a singular configuration: smallest singular value {smallest:.4g}, largest {largest:.4g}"
    if damped:
        return [
            f"{line}; damping l keeps rates for a velocity V below |V| / (2 l), in the units of these, however near"
        ]
    share = float(result.amplification)
    size = f"are {share:.4g} times those of the best direction, and " if share else ""
    return [f"{line}; rates {size}grow as 1 / the smallest", *_approach_notes(result)]


def _approach_notes(result: ResolvedRates) -> list[str]:
    """Return when the singular configuration is reached, if it is."""
    drift = float(result.approach)
    if not drift < 0:
        return []
    time = f"kept up, these rates reach the singular configuration in about {float(result.smallest) / -drift:.3g} s"
    return [f"{time}: the smallest singular value falls by {-drift:.4g} per second"]


def _values_note(result: ResolvedRates) -> str:
    """Return the singular values with their unit."""
    noise = _NOISE * max(1.0, float(result.singular_values[0]))
    values = " ".join(f"{_cleared(float(value), noise):.4g}" for value in result.singular_values)
    said = [f"lengths in units of {float(result.length):.4g} m"] if _uses_length(result) else []
    said += ["columns weighted"] if result.weights is not None else []
    unit = "" if result.unit == "1" else f" {result.unit}"
    return f"singular values {values}{unit}" + (f" ({', '.join(said)})" if said else "")


def _uses_length(result: ResolvedRates) -> bool:
    """Return whether the singular values depend on the characteristic length: by rows, or by columns that slide."""
    return result.task.mixed or (result.weights is None and "m/s" in result.column_units)


def _flat(result: ResolvedRates) -> Table:
    used = result.utilisation
    rows: list[tuple[Cell, ...]] = [
        (name, result.column_units[i], float(result.rates[i]), number(float(result.limits[i])), number(float(used[i])))
        for i, name in enumerate(result.columns)
    ]
    return Table(("joint", "unit", "rate", "limit", "utilisation"), tuple(rows))


def rates_result(result: ResolvedRates, order: Order) -> dict[str, Any]:
    """Return the result object of `rates`: m/s, rad/s; rows in the given order."""
    velocity, used, index = result.velocity, result.utilisation, int(result.binding)
    rows = [row for row in order.rows if row in result.task.rows]
    payload: dict[str, Any] = {
        "frame": velocity.of,
        "relative_to": velocity.relative_to,
        "reference": result.reference.value,
        "expressed_in": velocity.expressed_in,
        "point": None if velocity.point is None else list(velocity.point),
        "rows": [TWIST_ROWS[row] for row in rows],
        "twist": nested(np.asarray(result.twist)[rows]),
        "columns": list(result.columns),
        "column_units": list(result.column_units),
        "rates": dict(zip(result.columns, nested(result.rates), strict=True)),
        "null_space_rates": dict(zip(result.columns, nested(result.null_rates), strict=True)),
        "utilisation": {name: number(float(used[i])) for i, name in enumerate(result.columns)},
        "binding_joint": None if index < 0 else result.columns[index],
        "residual": nested(result.residual[rows]),
        "exact": bool(result.exact),
        "rank": int(result.rank),
        "usual_rank": result.usual_rank,
        "singular_values": nested(result.singular_values),
        "singular_values_unit": result.unit,
        "characteristic_length": float(result.length),
        "characteristic_length_reference": _LENGTH if bool(result.has_length) else _NO_LENGTH,
        "amplification": number(float(result.amplification)),
        "smallest_singular_value_rate": number(float(result.approach)),
        "damping": result.damping,
        "weights": None if result.weights is None else nested(result.weights),
        "secondary": result.secondary or None,
    }
    if np.any(np.isnan(used)):
        payload["utilisation_reason"] = "null where the file states no velocity limit"
    if math.isnan(result.approach):
        payload["smallest_singular_value_rate_reason"] = (
            "null at a singular configuration, or where no direction counts"
        )
    if velocity.point is None:
        payload["point_reason"] = "reference world: the point of the frame at the observer's origin"
    return payload


def rates_columns(result: ResolvedRates) -> tuple[list[Column], Certificate]:
    """Return the columns of a list of rates (m, n): rates, what is left of the velocity, use, how singular."""
    columns = [
        Column(name, unit, result.rates[:, i].tolist())
        for i, (name, unit) in enumerate(zip(result.columns, result.column_units, strict=True))
    ]
    columns += [
        Column(f"left_{TWIST_ROWS[row]}", TWIST_UNITS[row], result.residual[:, row].tolist())
        for row in result.task.rows
    ]
    columns += use_columns(result.columns, result.utilisation, result.binding)
    columns.append(Column("smallest_singular_value", "", result.smallest.tolist()))
    return columns, result.certificate
