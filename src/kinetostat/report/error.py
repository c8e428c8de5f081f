"""Tool errors, the joint resolution that an accuracy needs, and ways into singularities: to views and to JSON."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.conventions import Array
from kinetostat.errors import cut
from kinetostat.report.json import nested, number
from kinetostat.report.rows import Column
from kinetostat.report.view import Cell, Table, View, configuration_note, velocity_label

if TYPE_CHECKING:
    from kinetostat.analysis.accuracy import ErrorPart, ToolError
    from kinetostat.analysis.approach import SingularApproach
    from kinetostat.analysis.configuration import Configuration
    from kinetostat.analysis.crosscheck import Certificate
    from kinetostat.analysis.resolution import JointResolution, Requirement

__all__ = ["error_columns", "error_result", "error_view", "joint_errors_in_words"]

_AXES = ("x", "y", "z", "rx", "ry", "rz")
_NOISE = 1e-14  # m or rad
_NO_SHARE = 5e-7
_SHOWN = (1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0)  # shares of a way, in a table


def error_view(
    error: ToolError | None,
    resolution: JointResolution | None,
    approach: SingularApproach | None,
    at: Configuration,
    *,
    given: bool,
    degrees: bool,
) -> View:
    """Return the view: the error of the tool, the joint resolution, the way into a singularity, each if it is there.

    The error of the tool is left out where no joint errors were `given`, but are an example to scale.
    """
    tables, notes, flat = list[Table](), list[str](), None
    if error is not None and given:
        tables += [_rows(error, degrees), _sizes(error, degrees), _ellipsoids(error, degrees), _joints(error, degrees)]
        notes += _error_notes(error)
        flat = _flat_error(error)
    if error is not None and resolution is not None:
        tables += [_together(error, resolution, degrees), _alone(error, resolution, degrees)]
        turning = [unit == "rad" for unit in error.column_units]
        words = joint_errors_in_words(error.joint_error, turning, degrees=degrees)
        notes += _resolution_notes(resolution, words)
        flat = _flat_resolution(error, resolution)
    if approach is not None:
        tables.append(_steps(approach, degrees))
        notes += _approach_notes(approach, degrees)
        flat = _flat_approach(approach)
    velocity = error.velocity if error is not None else approach.velocity if approach is not None else None
    assert velocity is not None
    title = "the way into a singularity,"
    if error is not None:
        title = "tool error" if given else "joint resolution for an accuracy"
    return View(
        f"{title} {velocity_label(velocity)}",
        tuple(tables),
        (*notes, configuration_note(at, degrees)),
        flat=flat,
    )


# --- numbers with their units ----------------------------------------------------------------------------------


def _unit(unit: str, degrees: bool) -> str:
    """Return the unit in which small lengths or angles are shown: mm, mrad or deg."""
    return "mm" if unit == "m" else "deg" if degrees else "mrad"


def _small(value: Any, unit: str, degrees: bool) -> str:
    """Return a small length or angle, given in m or rad, in the unit in which it is shown."""
    if not math.isfinite(value):
        return "any"
    if abs(value) <= _NOISE:
        return "0"
    return f"{float(value) * (180 / math.pi if unit == 'rad' and degrees else 1e3):.4g}"


def joint_errors_in_words(errors: Array, turning: Sequence[bool], *, degrees: bool) -> str:
    """Return joint errors (n,) in words: the one of all joints that have one, if it is the same for all of them."""
    sizes = np.abs(errors)
    moving = {(size, "rad" if turns else "m") for size, turns in zip(sizes, turning, strict=True) if size}
    if len(moving) != 1:
        return "the given joint errors"
    size, unit = moving.pop()
    return f"joint errors of {_small(size, unit, degrees)} {_unit(unit, degrees)}"


def _share(value: Any) -> str:
    return "" if abs(value) < _NO_SHARE else f"{100 * float(value):.1f} %"


def _vector(values: Any) -> str:
    return f"({', '.join(f'{round(float(part), 4) + 0.0:.4g}' for part in values)})"


# --- the error of the tool -------------------------------------------------------------------------------------


def _rows(error: ToolError, degrees: bool) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for i, name in enumerate(_AXES):
        unit = "m" if i < 3 else "rad"
        numbers = (error.displacement, error.moved, error.worst, error.sigma)
        rows.append((name, _unit(unit, degrees), *(_small(each[i], unit, degrees) for each in numbers)))
    return Table(
        ("along", "unit", "J d", "exactly", "worst case", "one sigma"),
        tuple(rows),
        title="along each axis: the move by the joint errors d with their signs, to first order and exactly; the worst "
        "case of all signs; and the standard deviation for independent errors",
        words=True,
    )


def _sizes(error: ToolError, degrees: bool) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for name, part in (("position", error.translation), ("rotation", error.rotation)):
        worst = _small(part.worst, part.unit, degrees)
        numbers = (_small(part.there, part.unit, degrees), _small(part.sigma, part.unit, degrees))
        rows.append((name, _unit(part.unit, degrees), worst if part.exact else f"below {worst}", *numbers))
    header = ("", "unit", "worst case", "exactly there", "root mean square")
    return Table(header, tuple(rows), title="length of the error in any direction", words=True)


def _ellipsoids(error: ToolError, degrees: bool) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for name, part in (("position", error.translation), ("rotation", error.rotation)):
        for i in range(3):
            direction = (f"{round(float(entry), 5) + 0.0:.5f}" for entry in part.axes[:, i])
            label = name if i == 0 else ""
            rows.append((label, _unit(part.unit, degrees), _small(part.lengths[i], part.unit, degrees), *direction))
    header = ("", "unit", "semi-axis", "x", "y", "z")
    return Table(header, tuple(rows), title="one-sigma ellipsoids: semi-axes, and their directions", words=True)


def _joints(error: ToolError, degrees: bool) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for i, name in enumerate(error.columns):
        unit = error.column_units[i]
        cells = [name, _unit(unit, degrees), _small(error.joint_error[i], unit, degrees)]
        for part in (error.translation, error.rotation):
            sign = "+" if part.signs[i] > 0 else "-"
            worst = _share(part.worst_shares[i])
            cells += [f"{sign} {worst}" if worst else "", _share(part.sigma_shares[i])]
        rows.append(tuple(cells))
    return Table(
        ("joint", "unit", "error", "position", "variance", "rotation", "variance"),
        tuple(rows),
        title="joints: the error of each; its sign in the worst case of position and of rotation with its share of it, "
        "and its share of the variance",
        words=True,
    )


def _error_notes(error: ToolError) -> list[str]:
    if error.translation.exact and error.rotation.exact:
        return []
    return ["more than 20 joints have errors: worst cases of position and rotation are upper bounds"]


# --- the joint resolution --------------------------------------------------------------------------------------


def _needed(wanted: Requirement, i: int, unit: str, degrees: bool) -> tuple[str, str, str]:
    """Return the allowed error of a joint, its encoder counts and their bits."""
    counts, bits = float(wanted.counts[i]), float(wanted.bits[i])
    encoder = ("", "") if math.isnan(counts) else (f"{counts:.0f}" if counts < 1e9 else f"{counts:.3g}", f"{bits:.0f}")
    allowed = float(wanted.errors[i])
    return "exact" if allowed == 0 else _small(allowed, unit, degrees), *encoder


def _together(error: ToolError, resolution: JointResolution, degrees: bool) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for i, (name, unit) in enumerate(zip(error.columns, error.column_units, strict=True)):
        worst = _needed(resolution.worst, i, unit, degrees)
        sigma = _needed(resolution.sigma, i, unit, degrees)
        rows.append((name, _unit(unit, degrees), *worst, *sigma))
    return Table(
        ("joint", "unit", "worst", "counts", "bits", "sigma", "counts", "bits"),
        tuple(rows),
        title=f"joint errors that {_wanted(resolution, degrees)} allows, in these proportions: in the worst case and "
        "for one sigma, with the encoder counts per turn that they need",
        words=True,
    )


def _alone(error: ToolError, resolution: JointResolution, degrees: bool) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for i, (name, unit) in enumerate(zip(error.columns, error.column_units, strict=True)):
        rows.append((name, _unit(unit, degrees), *_needed(resolution.alone, i, unit, degrees)))
    header = ("joint", "unit", "alone", "counts", "bits")
    return Table(header, tuple(rows), title="the same of each joint alone, all others being exact", words=True)


def _wanted(resolution: JointResolution, degrees: bool) -> str:
    found = []
    for size, unit in ((resolution.accuracy, "m"), (resolution.accuracy_angle, "rad")):
        if size is not None:
            found.append(f"{_small(size, unit, degrees)} {_unit(unit, degrees)}")
    return f"an accuracy of {' and '.join(found)}"


def _resolution_notes(resolution: JointResolution, errors: str) -> list[str]:
    notes = []
    if math.isfinite(resolution.worst.factor):
        limit = str(resolution.decides)
        both = resolution.accuracy is not None and resolution.accuracy_angle is not None
        factors = f"{float(resolution.worst.factor):.4g} (worst case) and {float(resolution.sigma.factor):.4g}"
        notes.append(
            f"allowed are {errors}, times {factors} (one sigma: root mean square of the tool's error)"
            + (f"; the {limit} decides" if both else "")
        )
    notes.append(
        "counts per turn of the joint: a reading rounded to the nearest count is off by half a count at most (worst), "
        "by count / sqrt 12 (sigma)"
    )
    return notes


# --- the way into a singularity --------------------------------------------------------------------------------


def _steps(approach: SingularApproach, degrees: bool) -> Table:
    """Return the steps, the units of the columns as their first row."""
    angle, turn = ("deg", 180 / math.pi) if degrees else ("rad", 1.0)
    unit, small = approach.unit, _unit(approach.unit, degrees)
    per = 1e-3 if unit == "m" or not degrees else math.pi / 180  # one mm, mrad or deg
    motion_unit = "deg" if degrees else "mrad"
    units = (angle, "m/rad" if unit == "m" else "1", small, small, motion_unit, f"{angle}/s")
    rows: list[tuple[Cell, ...]] = [(*units, "%") if approach.limited else units]
    used = approach.utilisation
    for i in np.flatnonzero(np.any(np.isclose(approach.shares[:, None], _SHOWN, rtol=1e-9, atol=0), axis=1)):
        moved = approach.motion[i] * per * (180 / math.pi if degrees else 1e3)
        speed = approach.motion[i] * approach.speed * turn
        cells: list[Cell] = [
            f"{approach.remaining[i] * turn:.4g}",
            f"{approach.smallest[i]:.4g}",
            _small(approach.worst[i], unit, degrees),
            _small(approach.sigma[i], unit, degrees),
            *(f"{value:.4g}" if math.isfinite(value) else "infinite" for value in (moved, speed)),
        ]
        if approach.limited:
            cells.append(f"{100 * used[i]:.4g}" if math.isfinite(used[i]) else "infinite")
        rows.append(tuple(cells))
    errors = joint_errors_in_words(approach.joint_error, approach.mechanism.turning, degrees=degrees)
    asked = f"{approach.speed:g} {unit}/s" if unit == "m" or not degrees else f"{approach.speed * turn:g} deg/s"
    return Table(
        ("to go", "s", "worst", "sigma", f"per {small}", "speed", *(["of limit"] if approach.limited else [])),
        tuple(rows),
        title=f"on the way into the singularity: distance to go, smallest singular value s, tool error by {errors} "
        f"in the worst case and root mean square; joint motion that 1 {small} in the worst direction takes, and joint "
        f"speed for {asked}",
        words=True,
    )


def _approach_notes(approach: SingularApproach, degrees: bool) -> list[str]:
    arm, task = approach.mechanism, approach.mechanism.task
    notes = [f"rows that count: {' '.join(task.row_names)}"]
    if task.mixed:
        notes[0] += f"; turns count as arcs of radius {approach.length:.4g} m (characteristic length)"
    if not all(arm.turning):
        notes[0] += f"; slides count as angles, q / {approach.length:.4g} m"
    names, end = approach.names, approach.end[list(arm.indices)]
    turned = np.where(arm.turning, 180 / math.pi if degrees else 1.0, 1.0)
    where = ", ".join(f"{cut(name)} {x:.5g}" for name, x in zip(names, end * turned, strict=True))
    notes.append(f"the way is straight in joint space, to {where}")
    last = approach.directions[-1]
    if task.mixed:
        linear, angular = last[: len(task.linear)], last[len(task.linear) :] / approach.length
        words = f"{_vector(linear)} mm with {_vector(angular)} mrad"
    else:
        words = _vector(last)
    rows = " ".join(name.replace("w", "r").removeprefix("v") for name in task.row_names)
    if approach.singular:
        notes.append(f"lost at the end: motion along {words} in {rows} ('kinetostat singular at' says why)")
    per = "1 mm" if approach.unit == "m" else "1 deg" if degrees else "1 mrad"
    force = "N of force" if approach.unit == "m" else "Nm of moment"
    notes.append(
        f"joint errors make no larger tool errors there; what grows is the joint motion for a correction of {per}. "
        f"Likewise 1 Nm of torque error reads as 1/s {force}"
    )
    reached = approach.limit_at
    if reached is not None:
        left, joint = reached
        shown = f"{math.degrees(left):.3g} deg" if degrees else f"{left:.3g} rad"
        start = left == approach.remaining[0]
        where = "from the start" if start else f"{shown} before the end"
        notes.append(f"{cut(joint)} {'is beyond' if start else 'reaches'} its velocity limit {where}")
    return notes


# --- CSV -------------------------------------------------------------------------------------------------------


def _flat_error(error: ToolError) -> Table:
    """Return one row an axis, in m and rad."""
    rows: list[tuple[Cell, ...]] = [
        (
            name,
            *(float(each[i]) for each in (error.displacement, error.moved, error.worst, error.sigma)),
            "m" if i < 3 else "rad",
        )
        for i, name in enumerate(_AXES)
    ]
    return Table(("axis", "displacement", "exact", "worst", "sigma", "unit"), tuple(rows))


def _flat_resolution(error: ToolError, resolution: JointResolution) -> Table:
    """Return one row a joint, in rad and m."""
    rows: list[tuple[Cell, ...]] = []
    for i, (name, unit) in enumerate(zip(error.columns, error.column_units, strict=True)):
        cells = list[Cell]()
        for wanted in (resolution.worst, resolution.sigma, resolution.alone):
            cells += [number(float(wanted.errors[i])), number(float(wanted.counts[i]))]
        rows.append((name, *cells, unit))
    kinds = (f"{kind}{what}" for kind in ("worst", "sigma", "alone") for what in ("", "_counts"))
    return Table(("joint", *kinds, "unit"), tuple(rows))


def _flat_approach(approach: SingularApproach) -> Table:
    """Return one row a step, in rad and m."""
    header = ("remaining", "smallest", "worst", "sigma", "motion", "utilisation")
    columns = (
        approach.remaining,
        approach.smallest,
        approach.worst,
        approach.sigma,
        approach.motion,
        approach.utilisation,
    )
    rows = tuple(tuple(number(float(column[i])) for column in columns) for i in range(len(approach.shares)))
    unit = approach.unit
    return Table(header, rows, ("rad", f"{unit}/rad", unit, unit, f"rad/{unit}", ""))


# --- JSON ------------------------------------------------------------------------------------------------------


def error_columns(result: ToolError, resolution: JointResolution | None) -> tuple[list[Column], Certificate]:
    """Return the columns of a list of tool errors (m, 6), SI: the move, worst case, one sigma; allowed factors."""
    rows = [*((name, "m") for name in "xyz"), *((f"r{name}", "rad") for name in "xyz")]
    columns = [
        Column(f"{what}_{name}" if what else name, unit, values[:, i].tolist())
        for what, values in (("", result.displacement), ("worst", result.worst), ("sigma", result.sigma))
        for i, (name, unit) in enumerate(rows)
    ]
    for name, part in (("position", result.translation), ("rotation", result.rotation)):
        columns.append(Column(f"worst_{name}", part.unit, part.worst.tolist()))
        columns.append(Column(f"rms_{name}", part.unit, part.sigma.tolist()))
    if resolution is not None:
        columns.append(Column("factor_worst", "", resolution.worst.factor.tolist()))
        columns.append(Column("factor_sigma", "", resolution.sigma.factor.tolist()))
    return columns, result.certificate


def error_result(
    error: ToolError | None, resolution: JointResolution | None, approach: SingularApproach | None
) -> dict[str, Any]:
    """Return the result object of `error`: m, rad; per joint in path order."""
    velocity = error.velocity if error is not None else approach.velocity if approach is not None else None
    assert velocity is not None
    payload: dict[str, Any] = {"frame": velocity.of, "relative_to": velocity.relative_to}
    if error is not None:
        payload |= _error(error)
    if resolution is not None:
        payload["resolution"] = _resolution(resolution)
    if approach is not None:
        payload["approach"] = _approach(approach)
    return payload


def _error(error: ToolError) -> dict[str, Any]:
    velocity = error.velocity
    payload: dict[str, Any] = {
        "reference": error.reference.value,
        "expressed_in": velocity.expressed_in,
        "point": None if velocity.point is None else list(velocity.point),
        "columns": list(error.columns),
        "joint_error": nested(error.joint_error),
        "joint_error_units": list(error.column_units),
        "rows": list(_AXES),
        "row_units": ["m"] * 3 + ["rad"] * 3,
        "displacement": nested(error.displacement),
        "exact_displacement": nested(error.moved),
        "worst_case": nested(error.worst),
        "one_sigma": nested(error.sigma),
        "position": _part(error.translation),
        "rotation": _part(error.rotation),
    }
    if velocity.point is None:
        payload["point_reason"] = "reference world: the point of the frame at the observer's origin"
    return payload


def _part(part: ErrorPart) -> dict[str, Any]:
    return {
        "unit": part.unit,
        "worst_case": nested(part.worst),
        "worst_case_is_upper_bound": not part.exact,
        "worst_case_signs": part.signs.astype(int).tolist(),
        "worst_case_by_forward_kinematics": nested(part.there),
        "worst_case_shares": nested(part.worst_shares),
        "root_mean_square": nested(part.sigma),
        "variance_shares": nested(part.sigma_shares),
        "one_sigma_ellipsoid": {
            "axes": nested(np.swapaxes(part.axes, -1, -2)),
            "lengths": nested(part.lengths),
            "unit": part.unit,
        },
    }


def _resolution(resolution: JointResolution) -> dict[str, Any]:
    payload: dict[str, Any] = {"accuracy": resolution.accuracy, "accuracy_angle": resolution.accuracy_angle}
    for key in ("accuracy", "accuracy_angle"):
        if payload[key] is None:
            payload[f"{key}_reason"] = "not asked for"
    payload["decides"] = resolution.decides.tolist()
    for name in ("worst", "sigma", "alone"):
        payload[name] = _requirement(getattr(resolution, name))
    return payload


def _requirement(wanted: Requirement) -> dict[str, Any]:
    payload: dict[str, Any] = {
        "factor": nested(wanted.factor),
        "joint_errors": nested(wanted.errors),
        "counts_per_turn": _whole(wanted.counts),
        "bits": _whole(wanted.bits),
    }
    if not np.all(np.isfinite(wanted.factor)):
        payload["factor_reason"] = "infinite: the joint errors do not move the tool"
    if not np.all(np.isfinite(wanted.errors)):
        payload["joint_errors_reason"] = "null: infinite, the joint does not move the tool"
    if np.any(np.isnan(wanted.counts)):
        payload["counts_per_turn_reason"] = "null where a joint slides, is exact, or does not move the tool"
    return payload


def _whole(values: Array) -> Any:
    """Return nested lists of whole numbers, None where there is none."""
    if values.ndim == 0:
        return None if math.isnan(values) else int(values)
    return [_whole(part) for part in values]


def _approach(approach: SingularApproach) -> dict[str, Any]:
    arm = approach.mechanism
    task, places = arm.task, list(arm.indices)
    reached, limits = approach.limit_at, approach.limits
    payload: dict[str, Any] = {
        "expressed_in": approach.velocity.expressed_in,
        "point": list(approach.mechanism.point),
        "rows": list(task.row_names),
        "unit": approach.unit,
        "length": approach.length if task.mixed or not all(arm.turning) else None,
        "joints": list(approach.names),
        "start": nested(approach.start[places]),
        "end": nested(approach.end[places]),
        "end_is_singular": approach.singular,
        "joint_error": nested(approach.joint_error),
        "speed": approach.speed,
        "velocity_limits": nested(limits),
        "remaining_share": nested(approach.shares),
        "remaining": nested(approach.remaining),
        "smallest_singular_value": nested(approach.smallest),
        "direction": nested(approach.directions),
        "worst_case": nested(approach.worst),
        "root_mean_square": nested(approach.sigma),
        "joint_motion_per_unit": nested(approach.motion),
        "joint_rates": nested(approach.rates),
        "utilisation": nested(approach.utilisation) if approach.limited else None,
        "limit_reached": None if reached is None else {"remaining": reached[0], "joint": reached[1]},
    }
    if payload["length"] is None:
        payload["length_reason"] = "not used: neither rows nor joints mix metres and radians"
    if not np.all(np.isfinite(limits)):
        payload["velocity_limits_reason"] = "null where the file states none"
    if not approach.limited:
        payload["utilisation_reason"] = "the file states no velocity limit"
    if reached is None:
        payload["limit_reached_reason"] = "no joint reaches one before the last thousandth of the way"
    if approach.singular:
        payload["infinite_reason"] = "null in joint_motion_per_unit, joint_rates, utilisation: infinite, s is 0"
    return payload
