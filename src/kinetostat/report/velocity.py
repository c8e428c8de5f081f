"""Velocities of frames to a view and to JSON."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.conventions import TWIST_ROWS, TWIST_UNITS, Array, Order
from kinetostat.errors import cut
from kinetostat.report.json import nested
from kinetostat.report.rows import Column
from kinetostat.report.view import Cell, Table, View, configuration_note

if TYPE_CHECKING:
    from kinetostat.analysis.configuration import Configuration
    from kinetostat.analysis.crosscheck import Certificate
    from kinetostat.analysis.velocity import FrameMotions

__all__ = ["velocity_columns", "velocity_result", "velocity_view"]

_ACCELERATION_ROWS = ("ax", "ay", "az", "alphax", "alphay", "alphaz")
_ACCELERATION_UNITS = ("m/s2", "m/s2", "m/s2", "rad/s2", "rad/s2", "rad/s2")
_LABEL = 26  # what six columns of numbers leave of a page
_FEW = 6  # links at rest that are named
_NOISE = 1e-12  # what is left of a zero, in units of the largest number beside it


def velocity_view(result: FrameMotions, at: Configuration, frame: str | None, *, order: Order, degrees: bool) -> View:
    """Return the view of the motions of links at one configuration; or of the frame alone, with its screw."""
    index = None if frame is None else result.frames.index(frame)
    moving = [i for i in range(len(result.frames)) if not _still(result, i)]
    if index is None:
        what, tables = "the origins of all links", _link_tables(result, moving, order) if moving else ()
        notes = _resting(result, moving)
    else:
        what, tables = f"the origin of {cut(result.frames[index])}", _frame_tables(result, index, order)
        speed, rate = (float(x) for x in result.screw.zero)
        notes = [f"zero: up to {speed:.2g} m/s and {rate:.2g} rad/s (rounding at these rates)"]
    if result.qddot is not None:
        notes.append(
            "spatial: rates of the body twist's components; classical: the second derivative of the origin's position; "
            "their linear parts differ by w x v, because the link's own axes turn with it"
        )
    angle = "deg" if degrees else "rad"
    notes.append(_rates_note(result, result.qdot, "rates", f"m/s, {angle}/s", degrees))
    if result.qddot is not None:
        notes.append(_rates_note(result, result.qddot, "accelerations", f"m/s2, {angle}/s2", degrees))
    return View(
        f"velocity of {what},\nrelative to {cut(result.relative_to)}",
        tables,
        (*notes, configuration_note(at, degrees)),
        flat=_flat(result, order),
    )


def _still(result: FrameMotions, i: int) -> bool:
    """Return whether a frame is at rest and stays so."""
    pushed = result.classical_acceleration
    return bool(
        result.screw.motion[i] == "rest"
        and (pushed is None or float(np.max(np.abs(pushed[i]))) <= result.certificate.tolerance)
    )


def _resting(result: FrameMotions, moving: Sequence[int]) -> list[str]:
    """Return what the tables of all links leave out: links, and parts of names."""
    if not moving:
        return ["every link is at rest"]
    resting = [cut(name) for i, name in enumerate(result.frames) if i not in moving]
    more = f" and {len(resting) - _FEW} more" if len(resting) > _FEW else ""
    notes = [f"at rest, and left out: {', '.join(resting[:_FEW])}{more}"] if resting else []
    if any(len(cut(result.frames[i])) > _LABEL for i in moving):
        notes.append("long names are cut (-F csv has them whole)")
    return notes


# --- all links -------------------------------------------------------------------------------------------------


def _link_tables(result: FrameMotions, moving: Sequence[int], order: Order) -> tuple[Table, ...]:
    """Return one row a link that moves, in its own axes and in those of the observer (or as asked)."""
    names = _short([result.frames[k] for k in moving])
    axes = f"in the axes of {cut(result.expressed_in)}"
    tables = [
        _twists(names, result.body_twist[moving], "twists, each in the link's own axes (body twists)", order),
        _twists(names, result.twist[moving], f"twists, {axes}", order),
    ]
    if result.spatial_acceleration is not None and result.classical_acceleration is not None:
        spatial, classical = result.spatial_acceleration[moving], result.classical_acceleration[moving]
        tables += [
            _accelerations(names, spatial, "spatial accelerations, each in the link's own axes", order),
            _accelerations(names, classical, f"classical accelerations, {axes}", order),
        ]
    return tuple(tables)


def _short(names: Sequence[str]) -> list[str]:
    """Return names cut so that six numbers fit beside them."""
    whole = [cut(name) for name in names]
    return [_cut_apart(name, whole) for name in whole]


def _cut_apart(name: str, names: Sequence[str]) -> str:
    """Return a name cut in its middle, or as near to it as tells the name from all others."""
    if len(name) <= _LABEL:
        return name
    heads = sorted(range(4, _LABEL - 5), key=lambda head: abs(head - _LABEL // 2))
    ends = [(name[:head], name[head + 2 - _LABEL :]) for head in heads]
    alone = ((start, end) for start, end in ends if sum(n.startswith(start) and n.endswith(end) for n in names) == 1)
    return "..".join(next(alone, ends[0]))


def _twists(names: Sequence[str], values: Array, title: str, order: Order) -> Table:
    return _six_columns(names, values, title, order, TWIST_ROWS, TWIST_UNITS)


def _accelerations(names: Sequence[str], values: Array, title: str, order: Order) -> Table:
    return _six_columns(names, values, title, order, _ACCELERATION_ROWS, _ACCELERATION_UNITS)


def _six_columns(
    names: Sequence[str], values: Array, title: str, order: Order, header: Sequence[str], units: Sequence[str]
) -> Table:
    """Return six-vectors (k, 6), one a row."""
    rows: list[tuple[Cell, ...]] = [
        (name, *(float(six[i]) for i in order.rows)) for name, six in zip(names, values, strict=True)
    ]
    return Table(
        ("", *(header[i] for i in order.rows)), tuple(rows), ("", *(units[i] for i in order.rows)), title=title
    )


# --- one frame -------------------------------------------------------------------------------------------------


def _frame_tables(result: FrameMotions, k: int, order: Order) -> tuple[Table, ...]:
    """Return the twist in both axes, the accelerations, and the screw."""
    own, axes = result.frames[k], result.expressed_in
    heads, twists = _short([own, axes]), np.stack([result.body_twist[k], result.twist[k]])
    if own == axes:
        heads, twists = heads[:1], twists[:1]
    tables = [_twists(heads, twists, f"twist, in the axes of {cut(own)} (body twist){_and(own, axes)}", order)]
    if result.spatial_acceleration is not None and result.classical_acceleration is not None:
        both = np.stack([result.spatial_acceleration[k], result.classical_acceleration[k]])
        title = f"acceleration: spatial in the axes of {cut(own)}, classical in the axes of {cut(axes)}"
        tables.append(_accelerations(("spatial", "classical"), both, title, order))
    return (*tables, _screw_table(result, k))


def _and(own: str, axes: str) -> str:
    return "" if own == axes else f" and of {cut(axes)}"


def _screw_table(result: FrameMotions, k: int) -> Table:
    """Return the instantaneous screw in words and numbers."""
    screw, motion = result.screw, str(result.screw.motion[k])
    rows: list[tuple[Cell, ...]] = [("motion", _MOTIONS[motion])]
    if motion == "translation":
        rows += [
            ("direction", _triple(screw.axis[k])),
            ("speed", f"{float(screw.speed[k]):.6g} m/s"),
            ("pitch", "infinite: it has no axis"),
        ]
    elif motion != "rest":
        point = "centre of rotation" if motion == "rotation" else "point of the axis"
        rows += [
            ("axis", _triple(screw.axis[k])),
            (point, f"{_triple(screw.point[k])} m, nearest to the origin of {cut(result.frames[k])}"),
            ("pitch", f"{float(screw.pitch[k]):.6g} m/rad"),
            ("rate", f"{float(screw.rate[k]):.6g} rad/s"),
        ]
        if motion == "screw":
            rows.append(("speed along the axis", f"{float(screw.speed[k]):.6g} m/s"))
    title = f"instantaneous screw, in the coordinates of {cut(result.expressed_in)}"
    return Table(("", ""), tuple(rows), title=title, words=True)


_MOTIONS = {
    "rest": "at rest: there is no screw",
    "translation": "translation: every point moves alike",
    "rotation": "rotation: the axis is at rest",
    "screw": "screw: it turns about the axis and slides along it",
}


def _triple(values: Array) -> str:
    """Return a direction or a point in parentheses, without what is left of zeros."""
    noise = _NOISE * max(1.0, float(np.max(np.abs(values))))
    return f"({', '.join(f'{float(c):.6g}' if abs(c) > noise else '0' for c in values)})"


def _rates_note(result: FrameMotions, values: Array, what: str, units: str, degrees: bool) -> str:
    """Return joint rates, or accelerations, in words: those that are not zero."""
    turns = np.array([unit == "rad/s" for unit in result.column_units], dtype=bool)
    values = np.where(turns & degrees, np.degrees(values), values)
    parts = [f"{cut(name)} {float(x):.6g}" for name, x in zip(result.columns, values, strict=True) if x != 0]
    return f"joint {what} {', '.join(parts)} ({units}; others zero)" if parts else f"joint {what} all zero"


# --- CSV -------------------------------------------------------------------------------------------------------


def _blocks(result: FrameMotions) -> list[tuple[Array, list[str], tuple[str, ...]]]:
    """Return the six-vectors that there are, with the names and units of their rows."""
    blocks = [
        (result.body_twist, [f"body_{name}" for name in TWIST_ROWS], TWIST_UNITS),
        (result.twist, list(TWIST_ROWS), TWIST_UNITS),
        (result.spatial_acceleration, [f"spatial_{name}" for name in _ACCELERATION_ROWS], _ACCELERATION_UNITS),
        (result.classical_acceleration, [f"classical_{name}" for name in _ACCELERATION_ROWS], _ACCELERATION_UNITS),
    ]
    return [(values, names, units) for values, names, units in blocks if values is not None]


def velocity_columns(result: FrameMotions, order: Order) -> tuple[list[Column], Certificate]:
    """Return the columns of a list of motions (m, 1, 6) of one frame: its twists and accelerations."""
    columns = [
        Column(names[i], units[i], values[:, 0, i].tolist())
        for values, names, units in _blocks(result)
        for i in order.rows
    ]
    return columns, result.certificate


def _flat(result: FrameMotions, order: Order) -> Table:
    """Return one row a link."""
    header, units = ["link", "relative_to", "expressed_in"], ["", "", ""]
    rows: list[list[Cell]] = [[name, result.relative_to, result.expressed_in] for name in result.frames]
    for values, names, named_units in _blocks(result):
        header += [names[i] for i in order.rows]
        units += [named_units[i] for i in order.rows]
        for row, six in zip(rows, values, strict=True):
            row.extend(float(six[i]) for i in order.rows)
    screw = result.screw
    header += ["motion", *(f"axis_{c}" for c in "xyz"), *(f"point_{c}" for c in "xyz"), "pitch", "rate", "speed"]
    units += ["", "", "", "", "m", "m", "m", "m/rad", "rad/s", "m/s"]
    for k, row in enumerate(rows):
        numbers = (*screw.axis[k], *screw.point[k], screw.pitch[k], screw.rate[k], screw.speed[k])
        row.extend([str(screw.motion[k]), *_finite(numbers)])
    return Table(tuple(header), tuple(map(tuple, rows)), tuple(units))


def _finite(numbers: Iterable[Any]) -> list[Cell]:
    return [float(x) + 0.0 if np.isfinite(x) else None for x in numbers]


# --- JSON ------------------------------------------------------------------------------------------------------


def velocity_result(result: FrameMotions, order: Order) -> dict[str, Any]:
    """Return the result object of `velocity`: m, rad, s; six-vectors in the given order.

    `twist` and `classical_acceleration` are in the axes of `expressed_in`, `origin` and `screw` in its coordinates,
    `body_twist` and `spatial_acceleration` in the link's own axes.
    """
    payload: dict[str, Any] = {
        "relative_to": result.relative_to,
        "expressed_in": result.expressed_in,
        "order": order.value,
        "rows": [TWIST_ROWS[i] for i in order.rows],
        "row_units": [TWIST_UNITS[i] for i in order.rows],
        "columns": list(result.columns),
        "column_units": list(result.column_units),
        "rates": nested(result.qdot),
        "rounding": {"speed": nested(result.screw.zero[..., 0]), "rate": nested(result.screw.zero[..., 1])},
    }
    if result.qddot is not None:
        payload["accelerations"] = nested(result.qddot)
        payload["acceleration_rows"] = [_ACCELERATION_ROWS[i] for i in order.rows]
        payload["acceleration_row_units"] = [_ACCELERATION_UNITS[i] for i in order.rows]
    payload["links"] = {name: _link(result, k, order) for k, name in enumerate(result.frames)}
    return payload


def _link(result: FrameMotions, k: int, order: Order) -> dict[str, Any]:
    blocks = (
        ("twist", result.twist),
        ("body_twist", result.body_twist),
        ("classical_acceleration", result.classical_acceleration),
        ("spatial_acceleration", result.spatial_acceleration),
    )
    found = {name: nested(values[..., k, :][..., order.rows]) for name, values in blocks if values is not None}
    return {**found, "origin": nested(result.origin[..., k, :]), "screw": _screw(result, k)}


def _screw(result: FrameMotions, k: int) -> dict[str, Any]:
    screw = result.screw
    motion = screw.motion[..., k].tolist()
    payload: dict[str, Any] = {
        "motion": motion,
        "axis": nested(screw.axis[..., k, :]),
        "point": nested(screw.point[..., k, :]),
        "pitch": nested(screw.pitch[..., k]),
        "rate": nested(screw.rate[..., k]),
        "speed": nested(screw.speed[..., k]),
    }
    if isinstance(motion, str):
        for key in ("axis", "point"):
            if None in payload[key]:
                payload[key] = None
    reasons = [reason for word, reason in _NULLS.items() if word in np.ravel(motion)]
    if reasons:
        payload["reason"] = "; ".join(reasons)
    return payload


_NULLS = {
    "translation": "a translation: its pitch is infinite, and it has no line",
    "rest": "at rest: there is no screw",
}
