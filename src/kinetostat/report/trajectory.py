"""Trajectories to a view and to JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.trajectory.extremes import Extreme, extremes
from kinetostat.analysis.trajectory.near import MOST_CAUSES, NOISE
from kinetostat.conventions import GRAVITY, Array, Reference
from kinetostat.errors import cut
from kinetostat.report.asked import asked_load, asked_tool
from kinetostat.report.json import number
from kinetostat.report.singular import condition_words
from kinetostat.report.trajectory_rows import FileRows, sample_arrays
from kinetostat.report.view import Cell, Table, View, configuration_note, velocity_label

if TYPE_CHECKING:
    from kinetostat.analysis.configuration import Configuration
    from kinetostat.analysis.singular.at import SingularAt
    from kinetostat.analysis.trajectory.near import NearSpan
    from kinetostat.analysis.trajectory.trajectory import Trajectory
    from kinetostat.analysis.trajectory.violations import Violation

__all__ = ["asked_json", "asked_notes", "trajectory_result", "trajectory_view"]

_MOST = 20  # violations that a table lists
_DEEPEST = 10  # stretches near a singularity that a table lists
_NOISE = 1e-12  # what is left of a zero, in SI units
_FEW = 6  # joints that a line names
_LABELS = {
    "yoshikawa": "Yoshikawa",
    "minimum_singular_value": "smallest singular value",
    "inverse_condition_number": "smallest / largest",
    "limit_distance": "distance to a limit",
    "tool_speed": "tool speed",
    "turning_speed": "tool turning",
    "speed_use": "velocity limit used",
    "effort_use": "effort limit used",
}
_SHARES = ("speed_use", "effort_use", "limit_distance")
_OF_RATIO = ("yoshikawa", "minimum_singular_value", "inverse_condition_number")  # 0 where s_r is rounding


def trajectory_view(result: Trajectory, rows: FileRows, held: Configuration, *, degrees: bool) -> View:
    """Return the view: how long, the worst moments, stretches near singularities with causes, and beyond limits.

    `held` says where those joints are that the file does not name.
    """
    return View(
        f"trajectory {velocity_label(result.velocity)}",
        (
            _facts(result, rows),
            _extremes_table(result, rows, degrees),
            *_near_tables(result, rows, degrees),
            *_violations_table(result, rows, degrees),
        ),
        tuple(_notes(result, held, degrees)),
    )


# --- in words --------------------------------------------------------------------------------------------------


def _when(result: Trajectory, rows: FileRows, sample: int) -> str:
    """Return when a sample is, with its unit; or its row where there is no time."""
    moment = _moment(result, rows, sample)
    return f"row {moment}" if result.time is None else f"{moment} s"


def _moment(result: Trajectory, rows: FileRows, sample: int) -> str:
    """Return the time of a sample in as many digits as tell it from the next; or its row where there is no time."""
    if result.time is None:
        return str(int(rows.numbers[sample]))
    digits = math.ceil(-math.log10(float(np.min(np.diff(result.time)))) - 0.01)
    return f"{float(result.time[sample]):.{min(max(digits, 0), 9)}f}"


def _number(value: float, unit: str, degrees: bool) -> tuple[str, str]:
    """Return a number and its unit; angles in degrees if they are asked for; rounding noise is 0."""
    if degrees and unit.startswith("rad"):
        value, unit = math.degrees(value), unit.replace("rad", "deg", 1)
    return (f"{value:.4g}" if abs(value) > _NOISE else "0"), unit


def _shown(value: float, unit: str, degrees: bool) -> str:
    """Return a number with its unit; that of a pure number is not written."""
    text, unit = _number(value, unit, degrees)
    return text if unit == "1" else f"{text} {unit}"


# --- tables ----------------------------------------------------------------------------------------------------


def _facts(result: Trajectory, rows: FileRows) -> Table:
    left = f" of {rows.count} rows, {len(rows.bad)} left out" if rows.bad else ""
    found: list[tuple[Cell, ...]] = [("samples", f"{len(result.q)}{left}")]
    if result.time is not None:
        steps = np.diff(result.time)
        span = f"{_when(result, rows, 0)} to {_when(result, rows, -1)}"
        found.append(("time", f"{span}, steps of {float(steps.min()):.4g} to {float(steps.max()):.4g} s"))
    path = float(np.sum(np.linalg.norm(np.diff(result.at.position, axis=0), axis=-1)))
    found.append(("path of the tool point", f"{path:.5g} m"))
    arm = result.mechanism
    counting = "all six" if len(arm.task.rows) == 6 else " ".join(arm.task.row_names)
    if result.length is not None:
        counting += f"; lengths in units of {result.length:.4g} m"
    elif "mixed" in result.unit:
        counting += "; metres and radians are mixed"
    found.append(("rows that count", counting))
    share = f" ({100 * result.near_share:.3g} % of the samples)" if result.spans else ""
    near = f"in {len(result.spans)} stretch{'es' if len(result.spans) > 1 else ''}{share}"
    found.append(("near singular", near if result.spans else f"never: smallest / largest is {result.near:g} or more"))
    kinds = [f"{sum(v.kind == k for v in result.violations)} of {k}" for k in ("position", "velocity", "effort")]
    told = [kind for kind in kinds if not kind.startswith("0")]
    found.append(("beyond limits", f"stretches: {', '.join(told)}" if told else "never"))
    return Table(("", ""), tuple(found), words=True)


def _extremes_table(result: Trajectory, rows: FileRows, degrees: bool) -> Table:
    found = [_extreme_row(result, rows, one, degrees) for one in extremes(result)]
    return Table(("", "", "value", "unit", "at", "joint"), tuple(found), title="worst moments", words=True)


def _extreme_row(result: Trajectory, rows: FileRows, one: Extreme, degrees: bool) -> tuple[Cell, ...]:
    value, unit = _number(one.value, one.unit, degrees)
    if one.measure in _SHARES:
        value, unit = f"{100 * one.value:.4g}", "%"
    elif one.measure in _OF_RATIO and result.inverse_condition_number[one.sample] <= NOISE:
        value = "0"
    side = "max" if one.largest else "min"
    return (_LABELS[one.measure], side, value, unit, _when(result, rows, one.sample), cut(one.joint or ""))


def _near_tables(result: Trajectory, rows: FileRows, degrees: bool) -> list[Table]:
    """Return the stretches near a singularity, the deepest first, and their causes."""
    spans = sorted(result.spans, key=lambda span: span.inverse_condition_number)[:_DEEPEST]
    if not spans:
        return []
    found: list[tuple[Cell, ...]] = [
        (
            str(i),
            *(_moment(result, rows, sample) for sample in (span.first, span.last, span.worst)),
            f"{span.inverse_condition_number:.2g}" if span.inverse_condition_number > NOISE else "0",
            "-" if span.cause is None else span.cause.name or "no name",
            *([] if result.time is None else [_cost(result, span, degrees)]),
        )
        for i, span in enumerate(spans, start=1)
    ]
    many = f"; the {_DEEPEST} deepest of {len(result.spans)}" if len(result.spans) > _DEEPEST else ""
    title = f"near singular: smallest / largest singular value below {result.near:g}{many}"
    unit = "row" if result.time is None else "[s]"
    header: tuple[str, ...] = ("", f"from {unit}", f"to {unit}", f"worst {unit}", "smallest / largest", "name")
    if result.time is not None:
        header += ("to keep the tool's speed there in the hardest direction, a joint would need",)
    return [Table(header, tuple(found), title=title, words=True), _why_table(result, spans, degrees)]


def _why_table(result: Trajectory, spans: Sequence[NearSpan], degrees: bool) -> Table:
    """Return the causes, each with the numbers of the stretches that it is about, and how far they stay from it."""
    numbers: dict[str, list[int]] = {}
    for i, span in enumerate(spans, start=1):
        numbers.setdefault(_why(result, span, degrees), []).append(i)
    found: list[tuple[Cell, ...]] = []
    for why, about in numbers.items():
        known = [span.distance for i in about if (span := spans[i - 1]).distance is not None]
        away = "" if not known else f"; {_shown(min(known), 'rad', degrees)} away at least" if min(known) > 0 else ""
        found.append((f"{', '.join(map(str, about))}: {why}{away}",))
    slides = "" if all(result.mechanism.turning) else " (slides in units of the arm's length)"
    return Table(("",), tuple(found), title=f"why{slides}", words=True)


def _why(result: Trajectory, span: NearSpan, degrees: bool) -> str:
    """Return the name of a stretch's cause, where custom has one, and the cause in words."""
    if span.cause is None:
        return "no singular configuration was found nearby"
    here = dict(zip(result.columns, map(float, result.q[span.worst]), strict=False))
    parts = [_condition(span.cause, here, degrees), *(cause.text for cause in span.cause.causes[:2])]
    why = ", ".join(part for part in parts if part) or "motions are dependent"
    return why if span.cause.name is None else f"{span.cause.name}: {why}"


def _condition(cause: SingularAt, here: Mapping[str, float], degrees: bool) -> str:
    """Return the positions of joints that make it singular by themselves, by whole turns as near to these as can be."""
    arm, words = cause.mechanism, list[str]()
    turning = {name for name, turns in zip(arm.names, arm.periodic, strict=True) if turns}
    for one in cause.conditions:
        near = {
            name: value + 2 * math.pi * round((here.get(name, value) - value) / (2 * math.pi)) * (name in turning)
            for name, value in one.positions.items()
        }
        words.append(condition_words(arm, near, tuple(near), len(near), degrees=degrees))
    return " or ".join(words)


def _cost(result: Trajectory, span: NearSpan, degrees: bool) -> str:
    """Return which joint's rate would be the largest share of its limit, if the tool went the hardest way."""
    if span.needed is None or not np.any(span.needed):
        return "nothing: the tool stands still"
    if not np.all(np.isfinite(span.needed)):
        return "more than any rate"
    joint, limit = _most_needed(result, span.needed)
    turns = "rad/s" if result.mechanism.turning[joint] else "m/s"
    rate = _shown(abs(float(span.needed[joint])), turns, degrees)
    stated = f", limit {_number(limit, turns, degrees)[0]}" if math.isfinite(limit) else ""
    return f"{rate} ({cut(result.columns[joint])}{stated})"


def _most_needed(result: Trajectory, needed: Array) -> tuple[int, float]:
    """Return the joint that needs most of its limit (or the fastest, where none has one), and its limit. (c,)."""
    limits = result.speed_limits[: len(needed)]
    sizes = np.abs(needed)
    shares = sizes / limits
    joint = int(np.argmax(sizes) if np.all(np.isnan(shares)) else np.nanargmax(shares))
    return joint, float(limits[joint])


def _violations_table(result: Trajectory, rows: FileRows, degrees: bool) -> list[Table]:
    if not result.violations:
        return []
    found: list[tuple[Cell, ...]] = [
        (
            one.kind,
            _when(result, rows, one.first),
            _when(result, rows, one.last),
            _when(result, rows, one.worst),
            _shown(one.value, one.unit, degrees),
            _shown(one.limit, one.unit, degrees),
            cut(one.joint),
        )
        for one in result.violations[:_MOST]
    ]
    many = f"; the first {_MOST} of {len(result.violations)}" if len(result.violations) > _MOST else ""
    header = ("limit of", "from", "to", "worst at", "value", "limit", "joint")
    return [Table(header, tuple(found), title=f"beyond limits{many}", words=True)]


def _notes(result: Trajectory, held: Configuration, degrees: bool) -> list[str]:
    notes = []
    if result.time is None:
        why = "one sample" if len(result.q) == 1 else "without time"
        notes.append(f"{why}: nothing is said of velocities")
    else:
        notes.append(
            "rates are differences of samples (three points, on the times as they are); a velocity beyond its limit is "
            "the mean of a step"
        )
    if result.at.torque is not None:
        notes.append("efforts are static: weights alone, and nothing that accelerations take")
    if result.unwound:
        some = ", ".join(cut(name) for name in result.unwound[:_FEW])
        more = f" and {len(result.unwound) - _FEW} more" if len(result.unwound) > _FEW else ""
        notes.append(f"written into one turn, and continued by the shorter way: {some}{more}")
    if result.mechanism.generic_rank < result.at.singular_values.shape[-1]:
        notes.append(f"indices are of the {result.mechanism.generic_rank} singular values that are not always zero")
    if 0 < result.computed < len(result.q):
        notes.append(f"computed by both engines: {result.computed} of {len(result.q)} samples; all by the kernel")
    notes += asked_notes(result)
    if held.by_joint():
        notes.append(f"joints that the file does not name: {configuration_note(held, degrees)}")
    return notes


# --- what was asked --------------------------------------------------------------------------------------------


def asked_notes(result: Trajectory) -> list[str]:
    """Return what the answer was computed for, where it is not what everybody takes: weights, and effort limits."""
    notes = []
    if not np.any(result.gravity):
        notes.append("without gravity: nothing is said of efforts")
    elif not np.array_equal(result.gravity, GRAVITY):
        root = result.mechanism.model.robot.root
        notes.append(f"gravity ({_triple(result.gravity)}) m/s2 in the axes of {cut(root)}")
    if result.payload is not None:
        held = result.payload
        notes.append(f"payload {held.mass:g} kg at ({_triple(held.point)}) m of {cut(held.frame)}")
    if result.limits:
        given = [f"{cut(name)} {_ends(limit)}" for name, limit in list(result.limits.items())[:_FEW]]
        more = f" and {len(result.limits) - _FEW} more" if len(result.limits) > _FEW else ""
        notes.append(f"effort limits as given: {', '.join(given)}{more} (Nm or N; others the file's)")
    return notes


def asked_json(result: Trajectory, held: Configuration) -> dict[str, Any]:
    """Return all that an answer was computed for, in SI units; `held`: the joints that the file does not name."""
    return {
        **asked_tool(result.velocity, result.mechanism.task, result.length, result.length_reference),
        "near_singular_below": result.near,
        **asked_load(result.gravity, result.payload, result.limits),
        "held": held.by_joint(),
    }


def _ends(limit: float | tuple[float, float]) -> str:
    return f"{limit:g}" if isinstance(limit, (int, float)) else f"{limit[0]:g}:{limit[1]:g}"


def _triple(vector: Sequence[float] | Array) -> str:
    return ", ".join(f"{float(part) + 0.0:.5g}" for part in vector)


# --- JSON ------------------------------------------------------------------------------------------------------


def trajectory_result(result: Trajectory, rows: FileRows, held: Configuration) -> dict[str, Any]:
    """Return the result object of `trajectory`: SI units and radians; samples are told by the rows of the file.

    `held` says where those joints are that the file does not name.
    """
    arm, velocity, time = result.mechanism, result.velocity, result.time
    payload: dict[str, Any] = {
        "asked": asked_json(result, held),
        "frame": velocity.of,
        "relative_to": velocity.relative_to,
        "reference": (Reference.LOCAL if arm.local else Reference.ALIGNED).value,
        "expressed_in": velocity.expressed_in,
        "point": list(arm.point),
        "rows": list(arm.task.row_names),
        "columns": list(result.columns),
        "column_units": ["rad" if turns else "m" for turns in result.joints.turning],
        "generic_rank": arm.generic_rank,
        "characteristic_length": result.length,
        "singular_value_unit": result.unit,
        "samples": len(result.q),
        "rows_read": rows.count,
        "bad_rows": [{"row": one.row, "line": one.line, "reason": one.reason} for one in rows.bad],
        "time": None if time is None else {"start": float(time[0]), "end": float(time[-1])},
        "computed_by_both_engines": result.computed,
        "unwound": list(result.unwound),
        "extremes": {one.measure: _extreme_json(result, rows, one) for one in extremes(result)},
        "near_singular": {
            "threshold": result.near,
            "share": result.near_share,
            "spans": [_span_json(result, rows, span) for span in result.spans],
        },
        "violations": [_violation_json(result, rows, one) for one in result.violations],
        "timeline": sample_arrays(result, rows),
    }
    if time is None:
        payload["time_reason"] = "one sample" if len(result.q) == 1 else "the file has no column of time"
    if result.length is None:
        payload["characteristic_length_reason"] = result.length_reference
    return payload


def _place(result: Trajectory, rows: FileRows, sample: int) -> dict[str, Any]:
    """Return where a sample is: its row, and its time if there is one."""
    place: dict[str, Any] = {"row": int(rows.numbers[sample])}
    return place if result.time is None else place | {"time": float(result.time[sample])}


def _extreme_json(result: Trajectory, rows: FileRows, one: Extreme) -> dict[str, Any]:
    found = {"kind": "maximum" if one.largest else "minimum", "value": one.value, "unit": one.unit}
    return found | _place(result, rows, one.sample) | ({"joint": one.joint} if one.joint else {})


def _span_json(result: Trajectory, rows: FileRows, span: NearSpan) -> dict[str, Any]:
    payload: dict[str, Any] = {
        "first": _place(result, rows, span.first),
        "last": _place(result, rows, span.last),
        "worst": _place(result, rows, span.worst),
        "inverse_condition_number": span.inverse_condition_number,
        "minimum_singular_value": span.minimum_singular_value,
        "distance": span.distance,
        "cause": None,
        "needed": _needed_json(result, span),
    }
    if span.cause is None:
        payload["cause_reason"] = "none was found nearby" if span.sought else f"the {MOST_CAUSES} deepest have causes"
    else:
        payload["cause"] = {
            "name": span.cause.name,
            "kind": span.cause.kind,
            "conditions": [{"positions": c.positions, "name": c.name} for c in span.cause.conditions],
            "causes": [{"text": c.text, "joints": list(c.joints)} for c in span.cause.causes],
        }
    return payload


def _needed_json(result: Trajectory, span: NearSpan) -> dict[str, Any] | None:
    """Return the joint rates that keep the tool's speed in the direction that is hardest, or None without time."""
    if span.speed is None or span.needed is None:
        return None
    rates = {name: number(float(rate)) for name, rate in zip(result.columns, span.needed, strict=False)}
    found: dict[str, Any] = {"speed": span.speed, "unit": result.speed_unit, "rates": rates}
    if not np.all(np.isfinite(span.needed)):
        found["reason"] = "null: infinite, the configuration is singular"
    return found


def _violation_json(result: Trajectory, rows: FileRows, one: Violation) -> dict[str, Any]:
    return {
        "joint": one.joint,
        "kind": one.kind,
        "first": _place(result, rows, one.first),
        "last": _place(result, rows, one.last),
        "worst": _place(result, rows, one.worst),
        "value": one.value,
        "limit": one.limit,
        "excess": one.excess,
        "unit": one.unit,
    }
