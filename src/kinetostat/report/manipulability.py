"""Manipulability to a view and to JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.report.json import nested, number
from kinetostat.report.view import Cell, Table, View, configuration_note, velocity_label

if TYPE_CHECKING:
    from kinetostat.analysis.configuration import Configuration
    from kinetostat.analysis.manipulability import Block, Ellipsoid, Manipulability, Transmission

__all__ = ["manipulability_result", "manipulability_view"]

_INDICES = (
    ("Yoshikawa", "yoshikawa"),
    ("smallest singular value", "minimum_singular_value"),
    ("smallest / largest", "inverse_condition_number"),
    ("isotropy", "isotropy"),
)


def manipulability_view(result: Manipulability, at: Configuration, *, degrees: bool) -> View:
    """Return the view: indices and singular values block by block, then the ellipsoids of uniform blocks."""
    blocks = list(result.blocks.values())
    rows: list[tuple[Cell, ...]] = [
        ("rows", *(" ".join(block.task.row_names) if block.task.name == "task" else "" for block in blocks)),
        ("unit of s", *(block.unit for block in blocks)),
        ("rank / dimension", *(f"{int(block.rank)} / {block.task_dimension}" for block in blocks)),
    ]
    if "task" not in result.blocks:
        rows.pop(0)
    rows += [(label, *(_number(getattr(block, key)) for block in blocks)) for label, key in _INDICES]
    if any(block.penalised is not None for block in blocks):
        rows.append(("Yoshikawa x penalty", *(_number(block.penalised) for block in blocks)))
    count = max(block.singular_values.shape[-1] for block in blocks)
    for i in range(count):
        cells = (block.singular_values[i] if i < block.singular_values.shape[-1] else None for block in blocks)
        rows.append((f"s{i + 1}", *("" if cell is None else _number(cell) for cell in cells)))
    tables = [Table(("", *result.blocks), tuple(rows), words=True)]
    twins = [result.blocks[name].task.rows for name in ("translation", "rotation")]
    shown = [block for block in blocks if block.task.name != "task" or block.task.rows not in twins]
    tables += [_ellipsoid_table(block) for block in shown if not block.task.mixed and int(block.rank) > 0]
    if result.transmission is not None:
        tables.append(_transmission_table(result.transmission))
    notes = [*_rank_notes(result), _length_note(result)]
    if result.weights is not None:
        notes.append(_weights_note(result))
    return View(
        f"manipulability {velocity_label(result.velocity)}",
        tuple(tables),
        (*notes, configuration_note(at, degrees)),
        flat=_flat(result),
    )


def _number(value: Any) -> str:
    return f"{float(value):.6g}" if abs(float(value)) > 1e-14 else "0"


def _ellipsoid_table(block: Block) -> Table:
    """Return the axes of a block's ellipsoids: direction, length of the velocity's, length of the force's."""
    rows: list[tuple[Cell, ...]] = []
    for i in range(block.task_dimension):
        force = float(block.force.lengths[i])
        held = "infinite" if np.isinf(force) else _number(force)
        direction = (f"{round(float(part), 5) + 0.0:.5f}" for part in block.velocity.axes[:, i])
        rows.append((_number(block.velocity.lengths[i]), held, *direction))
    kind = {"translation": "v", "rotation": "w"}.get(block.task.name, "")
    names = [name.removeprefix(kind) for name in block.task.row_names]
    motion, load = ("velocity", "force") if block.task.linear else ("velocity", "moment")
    return Table(
        (f"{motion} [{block.velocity.unit}]", f"{load} [{block.force.unit}]", *names),
        tuple(rows),
        title=f"ellipsoids of {block.task.name}: lengths, and direction of each axis",
        words=True,
    )


def _transmission_table(line: Transmission) -> Table:
    force = float(line.force)
    rows: tuple[tuple[Cell, ...], ...] = (
        ("velocity", _number(line.velocity), line.unit_velocity),
        ("force", "infinite" if np.isinf(force) else _number(force), line.unit_force),
    )
    direction = ", ".join(f"{float(part):.5g}" for part in line.direction)
    return Table(("", "ratio", "unit"), rows, title=f"transmission along ({direction})", words=True)


def _rank_notes(result: Manipulability) -> list[str]:
    """Return what a newcomer should know of indices that are 0 because some row cannot move."""
    names = [name for name in ("translation", "rotation") if 0 < result.blocks[name].usual_rank < 3]
    count = len(result.columns)
    lame = [f"{name} has rank {result.blocks[name].usual_rank} of 3" for name in names if count >= 3]
    return (
        [f"{' and '.join(lame)} at most: --axes chooses the rows that count"]
        if lame and "task" not in result.blocks
        else []
    )


def _length_note(result: Manipulability) -> str:
    if result.length is None:
        return "no characteristic length: metres and radians as they are"
    return f"characteristic length {float(result.length):.6g} m ({result.length_reference})"


def _weights_note(result: Manipulability) -> str:
    assert result.weights is not None
    numbers = ", ".join(
        f"{name} {float(x):.5g}" for name, x in zip(result.columns, result.weights.factors, strict=True)
    )
    penalty = "" if result.weights.penalty is None else f"; penalty of limits {float(result.weights.penalty):.5g}"
    return f"columns weighted ({result.weights.rule}): {numbers}{penalty}"


def _flat(result: Manipulability) -> Table:
    """Return one row a block, for CSV."""
    rows: list[tuple[Cell, ...]] = []
    for block in result.blocks.values():
        values = " ".join(repr(float(value)) for value in block.singular_values)
        numbers = (float(getattr(block, key)) for _, key in _INDICES)
        rows.append((block.task.name, str(block.task_dimension), str(int(block.rank)), *numbers, values, block.unit))
    keys = (key for _, key in _INDICES)
    return Table(("block", "task_dimension", "rank", *keys, "singular_values", "unit"), tuple(rows))


# --- JSON ------------------------------------------------------------------------------------------------------


def manipulability_result(result: Manipulability) -> dict[str, Any]:
    """Return the result object of `manipulability`. Units are those of `unit`; m, rad, N, Nm."""
    velocity = result.velocity
    payload: dict[str, Any] = {
        "frame": velocity.of,
        "relative_to": velocity.relative_to,
        "reference": result.reference.value,
        "expressed_in": velocity.expressed_in,
        "point": None if velocity.point is None else list(velocity.point),
        "columns": list(result.columns),
        "column_units": list(result.column_units),
        "blocks": {name: _block(block) for name, block in result.blocks.items()},
        "characteristic_length": None if result.length is None else number(float(result.length)),
        "characteristic_length_reference": result.length_reference,
    }
    if velocity.point is None:
        payload["point_reason"] = "reference world: the point of the frame at the observer's origin"
    if result.length is None:
        payload["characteristic_length_reason"] = "none was asked for"
    if result.weights is not None:
        payload["weights"] = {
            "factors": nested(result.weights.factors),
            "rule": result.weights.rule,
            "penalty": None if result.weights.penalty is None else float(result.weights.penalty),
        }
    if result.transmission is not None:
        line = result.transmission
        payload["direction"] = {
            "vector": nested(line.direction),
            "velocity_ratio": float(line.velocity) + 0.0,
            "velocity_unit": line.unit_velocity,
            "force_ratio": number(float(line.force)),
            "force_unit": line.unit_force,
        }
        if np.isinf(line.force):
            payload["direction"]["force_ratio_reason"] = "infinite: no joint torque is needed"
    return payload


def _block(block: Block) -> dict[str, Any]:
    payload: dict[str, Any] = {
        "rows": list(block.task.row_names),
        "task_dimension": block.task_dimension,
        "rank": int(block.rank),
        "usual_rank": block.usual_rank,
        "singular_values": nested(block.singular_values),
        "unit": block.unit,
        **{key: float(getattr(block, key)) + 0.0 for _, key in _INDICES},
        "ellipsoid": {"velocity": _ellipsoid(block.velocity), "force": _ellipsoid(block.force)},
        "gradient": {key: nested(gradient) for key, gradient in block.gradients.items()},
    }
    if block.penalised is not None:
        payload["penalised_yoshikawa"] = float(block.penalised) + 0.0
        payload["gradient"]["penalised_yoshikawa"] = payload["gradient"].pop("penalised")
    payload["gradient"]["unit"] = "per rad or m of each column; the characteristic length is held"
    missing = [key for key, gradient in block.gradients.items() if not np.all(np.isfinite(gradient))]
    for key in missing:
        if not np.any(np.isfinite(block.gradients[key])):
            payload["gradient"]["penalised_yoshikawa" if key == "penalised" else key] = None
    if missing:
        payload["gradient"]["reason"] = (
            "null where an index has no gradient: a singular value is zero or repeated, or a weight has its kink, at "
            "the middle of a joint's limits"
        )
    return payload


def _ellipsoid(ellipsoid: Ellipsoid) -> dict[str, Any]:
    payload = {
        "axes": nested(np.swapaxes(ellipsoid.axes, -1, -2)),
        "lengths": nested(ellipsoid.lengths),
        "unit": ellipsoid.unit,
    }
    if np.any(np.isinf(ellipsoid.lengths)):
        payload["lengths_reason"] = "null: infinite, because no joint torque is needed"
    return payload
