"""Inverse kinematics to a view and to JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.conventions import Array
from kinetostat.errors import cut
from kinetostat.report.json import nested, number
from kinetostat.report.rows import Column
from kinetostat.report.view import Cell, Table, View
from kinetostat.urdf.description import Robot

if TYPE_CHECKING:
    from kinetostat.analysis.configuration import Configuration
    from kinetostat.analysis.crosscheck import Certificate
    from kinetostat.analysis.inverse.ik import InverseKinematics, Solutions
    from kinetostat.analysis.inverse.iterate import Step

__all__ = ["ik_columns", "ik_result", "ik_view", "solutions_result", "solutions_view"]

_SHOWN = 12  # lines of a trace: the first, and the last


def ik_view(result: InverseKinematics, at: Configuration, *, trace: bool, degrees: bool) -> View:
    """Return the view: the joints that were found, what is left of the error, and perhaps the steps."""
    found = replace(at, q=result.q)
    verdict = "yes" if bool(result.converged) else "no"
    title = f"{'reached' if bool(result.converged) else 'NOT reached'}: {_aim(result)}"
    tables = [_joints_table(found, result.coordinates, degrees)]
    if trace and result.trace:
        tables.append(_trace_table(at.robot, result, degrees))
    iterations = f"{int(result.iterations)} iterations"
    notes = [
        f"method {result.method.value}, {iterations}; what is left: {_left(result)}",
        "joints are inside their limits" if bool(result.inside_limits) else "a joint is outside its limits",
    ]
    if not bool(result.converged) and len(result.task.rows) > len(result.task.linear) > 0:
        notes.append("the nearest: metres weighed with angles by the size of the arm")
    if result.trace and result.trace[0].time is not None and result.trace[0].change is not None:
        names = zip(result.coordinates, result.trace[0].change, strict=True)
        rates = ", ".join(f"{cut(name)} {float(rate):.5g}" for name, rate in names)
        notes.append(f"rates to command at the start, J^+ e per second: {rates} (rad/s, m/s)")
        notes.append("the error fades as exp(-t) along the path that such rates make")
    flat = Table(
        (*result.coordinates, "converged", "position_residual", "rotation_residual"),
        ((*map(float, _picked(found, result.coordinates)), verdict, *_residuals(result)),),
        (*_units(at.robot, result.coordinates, degrees=False), "", "m", "rad"),
    )
    return View(title, tuple(tables), tuple(notes), flat=flat)


def _aim(result: InverseKinematics | Solutions) -> str:
    x, y, z = (float(c) for c in result.target[:3, 3])
    rows = {(0, 1, 2): "position", (0, 1, 2, 3, 4, 5): "full pose"}.get(result.task.rows)
    counted = (
        rows
        or f"{' '.join(name[1:] if name[0] == 'v' else f'r{name[1]}' for name in result.task.row_names)} of the pose"
    )
    return f"{cut(result.frame)} at ({x:.6g}, {y:.6g}, {z:.6g}) m of {cut(result.relative_to)}, {counted}"


def _residuals(result: InverseKinematics) -> tuple[float | None, float | None]:
    """Return the residuals of position and rotation, None where no row of it counts."""
    position = float(result.position_residual) if result.task.linear else None
    return position, float(result.rotation_residual) if result.task.angular else None


def _left(result: InverseKinematics) -> str:
    parts = []
    if result.task.linear:
        parts.append(f"{float(result.position_residual):.3g} m")
    if result.task.angular:
        parts.append(f"{float(result.rotation_residual):.3g} rad")
    return ", ".join(parts)


def _picked(at: Configuration, names: Sequence[str], *, degrees: bool = False) -> Array:
    """Return the positions of some coordinates, angles in rad or degrees."""
    every = at.robot.position_names
    return at.positions(degrees=degrees)[[every.index(name) for name in names]]


def _units(robot: Robot, names: Sequence[str], degrees: bool) -> list[str]:
    """Return the units of coordinates: of the joint's own, or of a planar joint's x, y and theta."""
    units = []
    for name in names:
        joint = robot.joint_by_name.get(name)
        turns = joint.type.is_angle if joint is not None and joint.type.nq == 1 else name.endswith(".theta")
        units.append(("deg" if degrees else "rad") if turns else "m")
    return units


def _joints_table(found: Configuration, names: Sequence[str], degrees: bool) -> Table:
    values = _picked(found, names, degrees=degrees)
    rows: list[tuple[Cell, ...]] = []
    for name, value, unit in zip(names, values, _units(found.robot, names, degrees), strict=True):
        joint = found.robot.joint_by_name.get(name)
        low, high = joint.limit.range if joint is not None and joint.type.nq == 1 else (-np.inf, np.inf)
        factor = 180 / np.pi if unit == "deg" else 1.0
        limits = "-" if not np.isfinite(high - low) else f"{low * factor:.5g} to {high * factor:.5g}"
        rows.append((name, f"{round(float(value), 6) + 0.0:.6f}", unit, limits))
    return Table(("joint", "position", "unit", "limits"), tuple(rows), words=True)


def _trace_table(robot: Robot, result: InverseKinematics, degrees: bool) -> Table:
    """Return the steps: positions at each, and the error; of many, the first and the last."""
    units = _units(robot, result.coordinates, degrees)
    factors = np.array([180 / np.pi if unit == "deg" else 1.0 for unit in units])
    timed = result.trace[0].time is not None
    rows: list[tuple[Cell, ...]] = []
    for i, step in _ends(result.trace):
        label = str(i) if not timed else f"{step.time:.2f}"
        rows.append((label, f"{step.error:.2e}", *map(float, step.q * factors)))
    title = "positions at each step; the error is in rad and units of the arm's size"
    if len(result.trace) > len(rows):
        title += f"; {len(result.trace)} in all, the first and the last are shown (-F json has every one)"
    header = ("time" if timed else "step", "error", *result.coordinates)
    return Table(header, tuple(rows), ("s" if timed else "", "", *units), title=title)


def _ends(trace: Sequence[Step]) -> list[tuple[int, Step]]:
    numbered = list(enumerate(trace))
    return numbered if len(trace) <= 2 * _SHOWN else [*numbered[:_SHOWN], *numbered[-_SHOWN:]]


def ik_result(result: InverseKinematics, at: Configuration) -> dict[str, Any]:
    """Return the result object of `ik`: m and rad."""
    found = replace(at, q=result.q)
    payload: dict[str, Any] = {
        "frame": result.frame,
        "relative_to": result.relative_to,
        "point": list(result.point),
        "rows": list(result.task.row_names),
        "reference": "local" if result.local else "aligned",
        "target": nested(result.target),
        "method": result.method.value,
        "configuration": found.by_joint(),
        "converged": bool(result.converged),
        "inside_limits": bool(result.inside_limits),
        "iterations": int(result.iterations),
        "residual": {
            "position": _residuals(result)[0],
            "rotation": _residuals(result)[1],
            "error": nested(result.error),
        },
        "trace": [
            {
                "configuration": dict(zip(result.coordinates, nested(step.q), strict=True)),
                "error": number(step.error),
                "change": None if step.change is None else nested(step.change),
            }
            | ({} if step.time is None else {"time": step.time})
            for step in result.trace
        ],
    }
    if None in _residuals(result):
        payload["residual"]["reason"] = "null where no row of it counts"
    if not result.trace:
        payload["trace_reason"] = "method damped keeps none"
    return payload


def ik_columns(result: InverseKinematics, robot: Robot) -> tuple[list[Column], Certificate, list[str | None]]:
    """Return the columns of a list of solutions (m, nq), the certificate, and why some have none."""
    every = robot.position_names
    columns = [
        Column(name, unit, result.q[:, every.index(name)].tolist())
        for name, unit in zip(result.coordinates, _units(robot, result.coordinates, degrees=False), strict=True)
    ]
    columns.append(Column("position_residual", "m", result.position_residual.tolist()))
    columns.append(Column("rotation_residual", "rad", result.rotation_residual.tolist()))
    columns.append(Column("iterations", "", result.iterations.tolist()))
    reasons = [
        None if result.converged[i] else f"not reached: misses by {_missed(result, i)}" for i in range(len(result.q))
    ]
    return columns, result.certificate, reasons


def _missed(result: InverseKinematics, row: int) -> str:
    parts = []
    if result.task.linear:
        parts.append(f"{float(result.position_residual[row]):.3g} m")
    if result.task.angular:
        parts.append(f"{float(result.rotation_residual[row]):.3g} rad")
    return ", ".join(parts)


# --- all solutions -----------------------------------------------------------------------------------------------


def solutions_view(result: Solutions, at: Configuration, *, degrees: bool) -> View:
    """Return the view: one row a solution."""
    units = _units(at.robot, result.coordinates, degrees)
    rows: list[tuple[Cell, ...]] = []
    for i, q in enumerate(result.q):
        values = _picked(replace(at, q=q), result.coordinates, degrees=degrees)
        rows.append((str(i + 1), "yes" if result.inside_limits[i] else "no", *map(float, values)))
    inside = int(np.sum(result.inside_limits))
    count = f"{len(result.q)} configurations" if len(result.q) != 1 else "1 configuration"
    title = f"{count}{' of infinitely many' if result.endless else ''}, {inside} inside joint limits: {_aim(result)}"
    header, head_units = ("", "inside", *result.coordinates), ("", "", *units)
    tables = (Table(header, tuple(rows), head_units),) if rows else ()
    verdict = "the list is complete" if result.complete else "the list is not proved to be complete"
    verdict = "infinitely many" if result.endless else f"{verdict} (but for whole turns of joints)"
    notes = [f"by {result.how}", f"{verdict}: {result.why}"]
    if not rows:
        notes.append("no configuration was found: the pose is out of reach, as far as this tells")
    radians = [
        (
            str(i + 1),
            "yes" if result.inside_limits[i] else "no",
            *map(float, _picked(replace(at, q=q), result.coordinates)),
        )
        for i, q in enumerate(result.q)
    ]
    flat = Table(("solution", "inside_limits", *result.coordinates), tuple(radians))
    return View(title, tables, tuple(notes), flat=flat)


def solutions_result(result: Solutions, at: Configuration) -> dict[str, Any]:
    """Return the result object of `ik --all`."""
    return {
        "frame": result.frame,
        "relative_to": result.relative_to,
        "rows": list(result.task.row_names),
        "target": nested(result.target),
        "solutions": [
            {
                "configuration": replace(at, q=q).by_joint(),
                "inside_limits": bool(result.inside_limits[i]),
                "error": nested(result.error[i]),
            }
            for i, q in enumerate(result.q)
        ],
        "how": result.how,
        "complete": result.complete,
        "infinitely_many": result.endless,
        "why": result.why,
    }
