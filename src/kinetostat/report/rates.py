"""Joint rates from a twist to a view and to JSON."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.conventions import TWIST_ROWS, TWIST_UNITS, Order
from kinetostat.errors import cut
from kinetostat.report.json import nested, number
from kinetostat.report.rows import Column
from kinetostat.report.view import Cell, Table, View, configuration_note, velocity_label

if TYPE_CHECKING:
    from kinetostat.analysis.configuration import Configuration
    from kinetostat.analysis.crosscheck import Certificate
    from kinetostat.analysis.rates import ResolvedRates

__all__ = ["rates_columns", "rates_result", "rates_view"]

_NEAR = 0.05  # smallest over largest singular value below which the growth of rates is told
_NOISE = 1e-12  # of the largest rate


def rates_view(result: ResolvedRates, at: Configuration, *, order: Order, degrees: bool) -> View:
    """Return the view: a row a joint; what the rates give; how they grow near a singular configuration."""
    used, scale = result.utilisation, float(np.max(np.abs(result.rates), initial=0.0))
    named = bool(result.secondary)
    rows: list[tuple[Cell, ...]] = []
    for i, name in enumerate(result.columns):
        factor = 180 / math.pi if degrees and result.column_units[i] == "rad/s" else 1.0
        unit = "deg/s" if factor != 1 else result.column_units[i]
        shown = _shown(float(result.rates[i]), scale, factor)
        null = (_shown(float(result.null_rates[i]), scale, factor),) if named else ()
        limit = "-" if math.isnan(result.limits[i]) else f"{float(result.limits[i]) * factor:.5g}"
        use = "-" if math.isnan(used[i]) else f"{100 * float(used[i]):.1f} %"
        rows.append((name, shown, *null, unit, limit, use))
    header = ("joint", "rate", *(("null space",) if named else ()), "unit", "limit", "use")
    tables = [Table(header, tuple(rows), words=True), _twist_table(result, order)]
    notes = [_verdict(result), *_use_notes(result), *_growth_notes(result), _units_note(result)]
    if result.secondary:
        notes.append(f"null space: {_SECONDARY[result.secondary]}")
    title = f"joint rates for a velocity {velocity_label(result.velocity)}"
    return View(title, tuple(tables), (*notes, configuration_note(at, degrees)), flat=_flat(result))


_SECONDARY = {
    "mid-limits": "towards the middle of the joint limits, as in a second",
    "manipulability": "along the steepest ascent of manipulability",
    "given": "the given rates, as far as they move nothing",
}


def _shown(value: float, scale: float, factor: float) -> str:
    return f"{value * factor:.6g}" if abs(value) > _NOISE * scale else "0"


def _twist_table(result: ResolvedRates, order: Order) -> Table:
    """Return the wanted twist and what is left of it, in the rows that count."""
    wanted = np.asarray(result.twist)
    scale = float(np.max(np.abs(wanted), initial=0.0))
    rows: list[tuple[Cell, ...]] = []
    for row in order.rows:
        if row in result.task.rows:
            left = float(result.residual[row])
            given = float(wanted[row]) - left
            cells = (_shown(value, scale, 1.0) for value in (float(wanted[row]), given, left))
            rows.append((TWIST_ROWS[row], TWIST_UNITS[row], *cells))
    title = "the velocity"
    if len(result.task.rows) < 6:
        title += "; rows that do not count are left out"
    return Table(("", "unit", "wanted", "given", "left"), tuple(rows), title=title, words=True)


def _verdict(result: ResolvedRates) -> str:
    """Return in words what kind of answer this is."""
    count, rank, rows = len(result.columns), int(result.rank), len(result.task.rows)
    weighed = "weighted " if result.weights is not None else ""
    if result.damping:
        return f"damped least squares, damping {result.damping:g}: what is left of the velocity is its price"
    if not bool(result.exact):
        return f"least squares: the joints give {rank} of the {rows} directions, and this velocity is not among them"
    if rank == count:
        return "exact, and the only rates that give it"
    return f"exact, with the least {weighed}norm of a {count - rank}-parameter family of rates"


def _use_notes(result: ResolvedRates) -> list[str]:
    index = int(result.binding)
    if index < 0:
        return ["no joint has a velocity limit"]
    use = float(result.utilisation[index])
    note = f"{cut(result.columns[index])} is nearest to its velocity limit: {100 * use:.1f} %"
    return [note + (f"; at {1 / use:.4g} of this velocity it would just do" if use > 1 else "")]


def _growth_notes(result: ResolvedRates) -> list[str]:
    """Return what is to be said near a singular configuration: how large the rates are, and how they grow."""
    values = result.singular_values
    rank, smallest, largest = int(result.rank), float(values[..., -1]), float(values[..., 0])
    if rank < len(values):
        return ["singular here: rates of a velocity in a lost direction are without bound (kinetostat singular at)"]
    if smallest > _NEAR * largest:
        return []
    lines = [
        f"near a singular configuration: smallest singular value {smallest:.4g}, largest {largest:.4g}; rates are "
        f"{float(result.amplification):.4g} times those of the best direction, and grow as 1 / the smallest"
    ]
    drift = float(result.approach)
    if drift < 0:
        lines.append(
            f"going on like this it falls by {-drift:.4g} a second: to zero in about {-smallest / drift:.3g} s"
        )
    return lines


def _units_note(result: ResolvedRates) -> str:
    if not result.task.mixed:
        return "singular values " + " ".join(f"{float(s):.4g}" for s in result.singular_values)
    values = " ".join(f"{float(s):.4g}" for s in result.singular_values)
    return f"singular values {values} (lengths in units of {float(result.length):.4g} m)"


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
        "singular_values": nested(result.singular_values),
        "characteristic_length": float(result.length),
        "amplification": number(float(result.amplification)),
        "smallest_singular_value_rate": number(float(result.approach)),
        "damping": result.damping,
        "weights": None if result.weights is None else nested(result.weights),
        "secondary": result.secondary or None,
    }
    if np.any(np.isnan(used)):
        payload["utilisation_reason"] = "null where the file states no velocity limit"
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
    binding = result.binding
    use = np.take_along_axis(result.utilisation, np.maximum(binding, 0)[:, None], -1)[:, 0]
    columns.append(Column("utilisation", "", use.tolist()))
    columns.append(Column("binding_joint", "", [result.columns[i] if i >= 0 else None for i in binding]))
    columns.append(Column("smallest_singular_value", "", result.singular_values[:, -1].tolist()))
    return columns, result.certificate
