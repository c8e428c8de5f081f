"""Torques, reactions, largest forces and worst torques to views and to JSON."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.crosscheck import combined
from kinetostat.analysis.loads import SEVERAL_COORDINATES
from kinetostat.conventions import WRENCH_ROWS, WRENCH_UNITS, Array, Load, Order, Velocity
from kinetostat.errors import cut
from kinetostat.report.json import nested, number
from kinetostat.report.rows import Column, use_columns
from kinetostat.report.view import Cell, Table, View, configuration_note
from kinetostat.urdf.description import Robot

if TYPE_CHECKING:
    from kinetostat.analysis.capacity import ForcePolytope, Strongest
    from kinetostat.analysis.configuration import Configuration
    from kinetostat.analysis.crosscheck import Certificate
    from kinetostat.analysis.loads import EffortLimits, Payload
    from kinetostat.analysis.statics import Reactions, Torques
    from kinetostat.analysis.worst import WorstTorques

__all__ = [
    "Section",
    "polytope_section",
    "reactions_section",
    "strongest_section",
    "torque_columns",
    "torque_result",
    "torque_view",
    "worst_result",
    "worst_view",
]

_HARDLY_FELT = 1e-5  # Nm per N: what rounded angles leave of a force that no joint feels
_NOISE = 1e-12  # of the largest number in a column: what rounding leaves of a zero
_ON = {
    "environment": "the robot exerts it on its environment: tau = +J^T F",
    "robot": "it acts on the robot: holding torque tau = -J^T F",
}


@dataclass(frozen=True)
class Section:
    """What a further question adds: a key of the JSON with its value, tables, and notes."""

    key: str
    value: dict[str, Any]
    tables: tuple[Table, ...] = ()
    notes: tuple[str, ...] = ()
    flat: Table | None = None  # the table for CSV, where it is not the first


def torque_view(
    result: Torques, at: Configuration, sections: Sequence[Section], *, order: Order, degrees: bool
) -> View:
    """Return the view of torques: a row a joint, further sections, and what loads the robot below."""
    parts = [("wrenches", result.torques), ("gravity", result.gravity), ("payload", result.from_payload)]
    shown = [part for part, used in zip(parts, _used(result), strict=True) if used]
    columns = [*shown, ("total", result.total)] if len(shown) > 1 else [("total", result.total)]
    scale = float(np.max(np.abs([values for _, values in parts]), initial=0.0))
    used = result.utilisation
    rows: list[tuple[Cell, ...]] = []
    for i, name in enumerate(result.columns):
        cells = [_shown(float(values[i]), scale) for _, values in columns]
        rows.append((name, *cells, result.units[i], _limit(result.limits, i), _percent(float(used[i]))))
    header = ("joint", *(name for name, _ in columns), "unit", "limit", "use")
    bearing = ", ".join(name for name, _ in shown) or "no load"
    title = f"joint torques that hold the robot still ({bearing})"
    return View(
        title,
        (Table(header, tuple(rows), words=True), *(table for section in sections for table in section.tables)),
        (
            *_binding_note(result),
            *_free_notes(at.robot),
            *(note for section in sections for note in section.notes),
            *_load_notes(result, order, at.robot),
            configuration_note(at, degrees),
        ),
        flat=(sections[-1].flat or sections[-1].tables[0]) if sections else _flat(result),
    )


def _used(result: Torques) -> tuple[bool, bool, bool]:
    return bool(result.loads), bool(np.any(result.gravity_vector)), result.payload is not None


def _shown(value: float, scale: float = 0.0) -> str:
    """Return a number in five digits; 0 for what rounding leaves of it in numbers as large as `scale`."""
    return f"{value:.5g}" if abs(value) > _NOISE * max(scale, 1.0) else "0"


def _limit(limits: EffortLimits, column: int) -> str:
    low, high = float(limits.lower[column]), float(limits.upper[column])
    return "-" if math.isnan(high) else f"{high:.5g}" if low == -high else f"{low:.4g}:{high:.4g}"


def _percent(share: float) -> str:
    return "-" if math.isnan(share) else f"{100 * share:.1f} %"


def _binding_note(result: Torques) -> list[str]:
    name, notes = result.binding_joint, list[str]()
    missing = {joint: why for joint, why in result.limits.missing.items() if why != SEVERAL_COORDINATES}
    if name is not None and np.any(result.total):
        use = float(result.utilisation[result.columns.index(name)])
        verdict = "" if use <= 1 else ": more than the joint can give"
        notes.append(f"{cut(name)} is nearest to its effort limit: {_percent(use)}{verdict}")
    if missing and name is None:
        notes.append("no joint has a usable effort limit (--effort-limits gives them)")
    elif missing:
        names = ", ".join(f"{cut(joint)} ({reason})" for joint, reason in list(missing.items())[:3])
        more = f" and {len(missing) - 3} more" if len(missing) > 3 else ""
        notes.append(f"no effort limit of {names}{more}")
    return notes


def _free_notes(robot: Robot) -> list[str]:
    """Return what the rows of joints without a drive of their own say."""
    free = [cut(joint.name) for joint in robot.independent if joint.type.nv > 1]
    return [f"rows of {', '.join(free)}: the wrench that has to hold what floats there"] if free else []


def _load_notes(result: Torques, order: Order, robot: Robot) -> list[str]:
    """Return the loads in words, with the sign convention."""
    notes = []
    for i, load in enumerate(result.loads):
        six = np.asarray(load.wrench)[list(order.rows)]
        parts = zip(order.rows, six, strict=True)
        named = ", ".join(f"{WRENCH_ROWS[row]} {part:g} {WRENCH_UNITS[row]}" for row, part in parts if part)
        label = "wrench" if len(result.loads) == 1 else f"wrench {i + 1}"
        notes.append(f"{label}: {named or 'zero'}, {_at(load.at)}; {_ON[result.on.value]}")
    if np.any(result.gravity_vector):
        notes.append(_gravity_note(result.gravity_vector, "gravity", robot))
    if result.payload is not None:
        note = _payload_note(result.payload)
        alone = not np.any(result.gravity_vector) and np.any(result.payload_gravity)
        notes.append(f"{note}; {_gravity_note(result.payload_gravity, 'its weight by', robot)}" if alone else note)
    return notes


def _gravity_note(vector: Array, what: str, robot: Robot) -> str:
    return f"{what} ({_triple(vector)}) m/s2 in the axes of {cut(robot.root)}"


def _payload_note(payload: Payload) -> str:
    return f"payload {payload.mass:g} kg at ({_triple(payload.point)}) m of {cut(payload.frame)}"


def _triple(vector: Sequence[float] | Array) -> str:
    return ", ".join(f"{float(part) + 0.0:.5g}" for part in vector)


def _at(at: Velocity) -> str:
    """Return where a wrench acts, and in which axes it is written, in words."""
    if at.point is None:
        point = f"by {cut(at.of)}, moment about the origin of {cut(at.relative_to)}"
    elif any(at.point):
        point = f"at point ({_triple(at.point)}) m of {cut(at.of)}"
    else:
        point = f"at the origin of {cut(at.of)}"
    return f"{point}, in the axes of {cut(at.expressed_in)}"


def _flat(result: Torques) -> Table:
    used = result.utilisation
    rows: list[tuple[Cell, ...]] = []
    for i, name in enumerate(result.columns):
        parts = [float(values[i]) for values in (result.torques, result.gravity, result.from_payload, result.total)]
        ends = [number(float(side[i])) for side in (result.limits.lower, result.limits.upper)]
        rows.append((name, result.units[i], *parts, *ends, number(float(used[i]))))
    header = ("joint", "unit", "torques", "gravity", "from_payload", "total", "lower", "upper", "utilisation")
    return Table(header, tuple(rows))


def torque_result(result: Torques, sections: Sequence[Section], order: Order) -> dict[str, Any]:
    """Return the result object of `torque`: N and Nm, by coordinate; and its sections."""
    names, used = result.columns, result.utilisation
    payload: dict[str, Any] = {
        "columns": list(names),
        "units": list(result.units),
        "on": result.on.value,
        "order": order.value,
        "wrenches": [_load_json(load, order) for load in result.loads],
        "gravity_vector": nested(result.gravity_vector),
        "payload": None if result.payload is None else _payload_json(result.payload, result.payload_gravity),
        "torques": _named(names, result.torques),
        "gravity": _named(names, result.gravity),
        "from_payload": _named(names, result.from_payload),
        "total": _named(names, result.total),
        "effort_limits": {
            name: None if name in result.limits.missing else {"lower": float(low), "upper": float(high)}
            for name, low, high in zip(names, result.limits.lower, result.limits.upper, strict=True)
        },
        "utilisation": _named(names, used),
        "binding_joint": result.binding_joint,
    }
    if result.limits.missing:
        payload["effort_limits_reasons"] = dict(result.limits.missing)
    return payload | {section.key: section.value for section in sections}


def _labelled(label: str, values: Array) -> tuple[Cell, ...]:
    """Return a row of a table of numbers."""
    return (label, *map(float, values))


def torque_columns(result: Torques, most: Strongest | None) -> tuple[list[Column], Certificate]:
    """Return the columns of a list of torques (m, n): total of each joint, largest use, the joint that has it.

    With the largest force or payload: its value and the joint that stops it.
    """
    columns = [
        Column(name, unit, result.total[:, i].tolist())
        for i, (name, unit) in enumerate(zip(result.columns, result.units, strict=True))
    ]
    columns += use_columns(result.columns, result.utilisation, result.binding)
    if most is None:
        return columns, result.certificate
    columns.append(Column(f"max_{most.quantity}", most.unit, most.value.tolist()))
    columns.append(Column("stopped_by", "", [most.columns[i] if i >= 0 else None for i in most.binding]))
    return columns, combined([result.certificate, most.certificate])


def _named(names: Sequence[str], values: Array) -> dict[str, float | None]:
    return {name: number(float(value) + 0.0) for name, value in zip(names, values, strict=True)}


def _load_json(load: Load, order: Order) -> dict[str, Any]:
    return {
        "frame": load.at.of,
        "point": None if load.at.point is None else list(load.at.point),
        "expressed_in": load.at.expressed_in,
        "wrench": nested(np.asarray(load.wrench)[order.rows]),
    }


def _payload_json(payload: Payload, gravity: Array) -> dict[str, Any]:
    where = {"mass": payload.mass, "frame": payload.frame, "point": list(payload.point)}
    return {**where, "gravity_vector": nested(gravity)}


# --- reactions ---------------------------------------------------------------------------------------------------


def reactions_section(result: Reactions, order: Order) -> Section:
    """Return the wrenches that hold each link, in its own frame and in the base's axes, and the check in words."""
    header = ("link", *(WRENCH_ROWS[row] for row in order.rows))
    units = ("", *(WRENCH_UNITS[row] for row in order.rows))
    tables = []
    for values, title in (
        (result.local, "force and moment by which the link before (or the ground) holds each link, in its own frame"),
        (result.base, "the same wrenches, about the same points, in the axes of the root link"),
    ):
        scale = float(np.max(np.abs(values), initial=0.0))
        cleaned = np.where(np.abs(values) > _NOISE * scale, values, 0.0)
        rows = [_labelled(link, row[order.rows]) for link, row in zip(result.links, cleaned, strict=True)]
        tables.append(Table(header, tuple(rows), units, title=title))
    note = f"the part of each along its joint's axis is the joint's torque: largest difference {result.residual:.1e}"
    links = {}
    for i, link in enumerate(result.links):
        links[link] = {
            "held_by": result.holders[i],
            "joint": result.joints[i],
            "local": nested(result.local[i][order.rows]),
            "base": nested(result.base[i][order.rows]),
            "projection": number(float(result.projections[i])),
        }
    return Section("reactions", {"links": links, "projection_residual": result.residual}, tuple(tables), (note,))


# --- the largest force -------------------------------------------------------------------------------------------


def strongest_section(result: Strongest) -> Section:
    """Return the largest force or payload: in words, and for JSON."""
    value = float(result.value)
    payload: dict[str, Any] = {
        "quantity": result.quantity,
        "direction": nested(result.direction),
        "frame": result.velocity.of,
        "point": list(result.velocity.point or ()),
        "expressed_in": result.velocity.expressed_in,
        "on": result.on.value,
        "value": number(value),
        "unit": result.unit,
        "least": number(float(result.least)),
        "binding_joint": result.binding_joint,
        "torques_per_unit": _named(result.columns, result.torques),
    }
    if math.isinf(value):
        payload["value_reason"] = "infinite: no joint torque is needed"
    if math.isnan(value):
        payload["value_reason"] = "none is possible: an effort limit is exceeded without it"
    names = ("quantity", "frame", "value", "unit", "least", "binding_joint")
    flat = Table(names, (tuple(payload[name] for name in names),))
    return Section("max", payload, notes=(_strongest_note(result),), flat=flat)


def _strongest_note(result: Strongest) -> str:
    value, least, joint = float(result.value), float(result.least), cut(result.binding_joint or "")
    where = _at(result.velocity)
    what = f"force along ({_triple(result.direction)}) {where}"
    if result.quantity == "payload":
        what = f"payload {where.partition(', in the axes of')[0]}"
    if math.isnan(value):
        return f"no {what} is possible: {joint} exceeds its effort limit without it"
    if math.isinf(value):
        return f"the {what} needs no torque of any joint: without bound (infinite mechanical advantage)"
    felt = float(np.max(np.abs(result.torques), initial=0.0))
    if result.quantity == "force" and felt < _HARDLY_FELT:
        return (
            f"the {what} is hardly felt: {felt:.1e} Nm per N at most, which files that round angles make of none; "
            f"by the numbers {value:.3g} {result.unit}, stopped by {joint}"
        )
    relief = f"; at least {least:.5g} {result.unit} is needed, or a joint exceeds its limit" if least > 0 else ""
    return f"largest {what}: {value:.6g} {result.unit}, stopped by {joint}{relief}"


def polytope_section(result: ForcePolytope) -> Section:
    """Return the corners of the force polytope, and what bounds it in words."""
    names = tuple(WRENCH_ROWS[row] for row in result.task.rows)
    units = (result.unit,) * len(names)
    corners = tuple(_labelled(str(i + 1), corner) for i, corner in enumerate(result.vertices))
    section = " (of its section across the directions without bound)" if len(result.lines) else ""
    kind = "forces" if result.unit == "N" else "moments"
    title = f"corners of the polytope of all {kind} {_at(result.velocity)}{section}"
    tables = [Table(("corner", *names), corners, ("", *units), title=title)]
    if len(result.lines):
        lines = tuple(_labelled(str(i + 1), line) for i, line in enumerate(result.lines))
        title = "directions that need no torque of any joint: every force, both ways"
        tables.append(Table(("line", *names), lines, title=title))
    joints = ", ".join(cut(result.columns[i]) for i in sorted(set(result.face_joints)))
    bounded = "bounded " if len(result.lines) else ""
    notes = [f"in every {bounded}direction at least {result.every_way:.6g} {result.unit}"]
    if joints:
        notes.append(f"bounded by {joints}")
    payload = {
        "frame": result.velocity.of,
        "point": list(result.velocity.point or ()),
        "expressed_in": result.velocity.expressed_in,
        "on": result.on.value,
        "rows": [WRENCH_ROWS[row] for row in result.task.rows],
        "unit": result.unit,
        "vertices": nested(result.vertices),
        "facets": result.facets.tolist(),
        "facet_joints": [result.columns[i] for i in result.face_joints],
        "unbounded_directions": nested(result.lines),
        "every_way": result.every_way,
    }
    return Section("max", payload, tuple(tables), tuple(notes))


# --- the worst torques -------------------------------------------------------------------------------------------


def worst_view(result: WorstTorques, at: Configuration, *, degrees: bool) -> View:
    """Return the view of worst torques: a row a joint, and the witness of the one that is used most."""
    scale = float(np.max(np.abs(result.torques), initial=0.0))
    columns = at.robot.velocity_columns([at.robot.joint_by_name[name] for name in result.joints])
    rows: list[tuple[Cell, ...]] = []
    for i, name in enumerate(result.joints):
        limit = _limit(result.limits, columns[i])
        worst = _shown(float(result.torques[i]), scale)
        rows.append((name, worst, result.units[i], limit, _percent(float(result.utilisation[i])), _agreed(result, i)))
    header = ("joint", "worst", "unit", "limit", "use", "starts that agree")
    notes = [
        f"of {result.samples} configurations inside limits, the worst {result.starts} of each joint climbed to a local "
        "maximum: lower bounds, a worse one is not excluded",
        _gravity_note(result.gravity_vector, "gravity", at.robot),
    ]
    if result.payload is not None:
        notes.append(_payload_note(result.payload))
    shares = np.nan_to_num(result.utilisation, nan=-1.0)
    worst_joint = int(np.argmax(shares)) if np.any(shares >= 0) else int(np.argmax(np.abs(result.torques)))
    witness = configuration_note(replace(at, q=result.witnesses[worst_joint]), degrees)
    notes.append(f"worst for {cut(result.joints[worst_joint])}: {witness.removeprefix('at ')}")
    flat = tuple(
        (
            name,
            result.units[i],
            float(result.torques[i]),
            number(float(result.utilisation[i])),
            *(float(x) for x in result.witnesses[i]),
        )
        for i, name in enumerate(result.joints)
    )
    positions = [f"at_{name}" for name in at.robot.position_names]
    title = f"the worst torque of each joint inside limits, under gravity{' and payload' if result.payload else ''}"
    return View(
        title,
        (Table(header, tuple(rows), words=True),),
        tuple(notes),
        flat=Table(("joint", "unit", "worst", "utilisation", *positions), flat),
    )


def _agreed(result: WorstTorques, joint: int) -> str:
    return f"{int(result.agreed[joint])} of {result.starts}"


def worst_result(result: WorstTorques, at: Configuration) -> dict[str, Any]:
    """Return the result object of `torque --worst`."""
    joints = {}
    for i, name in enumerate(result.joints):
        joints[name] = {
            "torque": float(result.torques[i]) + 0.0,
            "unit": result.units[i],
            "utilisation": number(float(result.utilisation[i])),
            "witness": replace(at, q=result.witnesses[i]).by_joint(),
            "starts_that_agree": int(result.agreed[i]),
        }
    return {
        "worst": joints,
        "bound": "lower: a worse configuration is not excluded",
        "samples": result.samples,
        "starts": result.starts,
        "gravity_vector": nested(result.gravity_vector),
        "payload": None if result.payload is None else _payload_json(result.payload, result.gravity_vector),
    }
