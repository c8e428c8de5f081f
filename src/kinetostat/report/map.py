"""Capability maps, and base placement by them, to views and to JSON."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.capability.counting import APPROACH
from kinetostat.analysis.capability.directions import DIRECTIONS
from kinetostat.analysis.configuration import Configuration
from kinetostat.conventions import Array
from kinetostat.errors import cut
from kinetostat.report.asked import asked_tool
from kinetostat.report.json import nested, number
from kinetostat.report.view import Cell, Table, View, configuration_note, velocity_label

if TYPE_CHECKING:
    from kinetostat.analysis.capability.capability_map import CapabilityMap
    from kinetostat.analysis.capability.placing import BasePlacement, ProvedPlacement

__all__ = ["map_about", "map_result", "map_view", "placement_result", "placement_view"]

_PERCENTS = {"min": 0, "5 %": 5, "median": 50, "95 %": 95, "max": 100}
_HOLLOW = 0.1  # share of further configurations that would reach new voxels
_DIGITS = 9  # decimal places of positions in m: voxels' middles are multiples of their size but for rounding


def map_view(result: CapabilityMap, at: Configuration, *, degrees: bool, voxels: bool = False) -> View:
    """Return the view: how large the workspace is, how its voxels are, where the best one is.

    `voxels`: with the table of all of them, which CSV gives.
    """
    tables = (_size_table(result), _statistics_table(result), _best_table(result, at, degrees))
    flat = _voxel_table(result) if voxels else _size_table(result)
    return View(_title(result), tables, tuple(_notes(result, at, degrees)), flat=flat)


def _title(result: CapabilityMap) -> str:
    count = f"map of {result.count:,}"
    if not result.complete:
        count = f"PARTIAL map, interrupted: {result.count:,} of {result.source.count:,}"
    return f"{count} configurations: {result.source.label}\n{velocity_label(result.velocity)}"


def _size_table(result: CapabilityMap) -> Table:
    low, high = result.box
    unit = "m" if result.dimensions < 2 else f"m{result.dimensions}"
    word = {3: "volume", 2: "area"}.get(result.dimensions, "length")
    rows: list[tuple[Cell, ...]] = [
        ("voxel", _short(result.grid.size), "m"),
        ("voxels reached", f"{result.voxels:,}", ""),
        (f"{word} of them", _short(result.volume), unit),
    ]
    rows += [(axis, f"{_short(a)} to {_short(b)}", "m") for axis, a, b in zip("xyz", low, high, strict=True)]
    return Table(("workspace", "", "unit"), tuple(rows), words=True)


def _statistics_table(result: CapabilityMap) -> Table:
    unit = result.singular_value_unit
    quantities = (
        ("configurations", "", result.reach_count),
        ("best smallest singular value", unit, result.best_singular_value),
        ("mean smallest singular value", unit, result.mean_singular_value),
        ("directions reached", "%", 100 * result.orientation_coverage),
    )[: 3 if _one_direction(result) else 4]
    rows: list[tuple[Cell, ...]] = []
    for name, each, values in quantities:
        found = np.percentile(values[result.reached], list(_PERCENTS.values()))
        rows.append((name, each, *(_short(float(value)) for value in found)))
    return Table(("of a voxel", "unit", *_PERCENTS), tuple(rows), title="over the voxels that are reached", words=True)


def _one_direction(result: CapabilityMap) -> bool:
    """Return whether the tool's z axis always points the same way, as that of a planar arm."""
    return int(np.bitwise_count(np.bitwise_or.reduce(result.directions, axis=None))) == 1


def _best_table(result: CapabilityMap, at: Configuration, degrees: bool) -> Table:
    """Return the configuration that is the best of the best voxel."""
    found = Configuration(at.robot, _best_configuration(result, at))
    places = list(result.coordinates.indices)
    units = [("deg" if degrees else "rad") if turns else "m" for turns in result.coordinates.turning]
    values = found.positions(degrees=degrees)[places]
    x, y, z = (_short(float(c)) for c in _middle(result, result.best_voxel))
    best = _short(float(np.nanmax(result.best_singular_value)))
    title = f"best voxel: about ({x}, {y}, {z}) m, smallest singular value {best}, reached by"
    return Table(("", *result.coordinates.names), (("joints", *map(float, values)),), ("", *units), title=title)


def _best_configuration(result: CapabilityMap, at: Configuration) -> Array:
    q: Array = result.configurations(np.array([result.best_voxel]), at.q)[0]
    return q


def _middle(result: CapabilityMap, index: Any) -> Array:
    middle: Array = np.round(result.grid.centre(index), _DIGITS) + 0.0
    return middle


def _notes(result: CapabilityMap, at: Configuration, degrees: bool) -> list[str]:
    low = (
        f"{100 * result.low_share:.3g} % of the voxels have less than a tenth of the best one's smallest singular value"
    )
    unseen = f"about {100 * result.unseen_share:.2g} % of further configurations would reach a new voxel"
    notes = [low, f"{unseen}; {result.counted / result.voxels:.3g} a voxel so far"]
    if result.unseen_share > _HOLLOW:
        notes.append("the map has holes, and its volume is far too small: it wants ten times as many --samples")
    notes += _asked_notes(result)
    if result.approach is None and _one_direction(result):
        notes.append(f"the z axis of {cut(result.velocity.of)} points about one way only")
    if result.outside:
        notes.append(f"{result.outside:,} configurations are outside the grid")
    if len(result.coordinates.names) < at.robot.nq:
        notes.append(f"other joints {configuration_note(at, degrees)}")
    if result.checked:
        notes.append(f"{result.checked:,} configurations, of every chunk and the best, computed again by Pinocchio")
    return notes


def _asked_notes(result: CapabilityMap) -> list[str]:
    """Return what the numbers depend on: the rows that count, the length, the approach."""
    notes = [f"rows that count: {' '.join(result.task.row_names)}"] if result.task.name != "full" else []
    if result.length is not None:
        notes.append(f"characteristic length {result.length:.6g} m ({result.length_reference})")
    elif result.singular_value_unit == "mixed":
        notes.append("no characteristic length: metres and radians as they are")
    if result.approach is not None:
        way = ", ".join(f"{part:.4g}" for part in result.approach)
        notes.append(
            f"only configurations with the z axis of {cut(result.velocity.of)} within {APPROACH:g} degrees of ({way}): "
            f"{result.counted:,} of {result.count:,}"
        )
    return notes


def _voxel_table(result: CapabilityMap) -> Table:
    """Return a row for each voxel that is reached."""
    index = np.flatnonzero(result.reached)
    middles = _middle(result, index).tolist()
    counts = [str(count) for count in result.reach_count.ravel()[index].tolist()]
    values = (result.best_singular_value, result.mean_singular_value, result.orientation_coverage)
    columns = [value.ravel()[index].tolist() for value in values]
    rows = tuple((*middle, *rest) for middle, *rest in zip(middles, counts, *columns, strict=True))
    unit = result.singular_value_unit
    header = ("x", "y", "z", "reach_count", "best_singular_value", "mean_singular_value", "orientation_coverage")
    return Table(header, rows, ("m", "m", "m", "", unit, unit, "1"))


def _short(value: float) -> str:
    return "0" if abs(value) < 1e-12 else f"{round(value, _DIGITS):.4g}"


# --- JSON ----------------------------------------------------------------------------------------------------------


def map_result(result: CapabilityMap, at: Configuration) -> dict[str, Any]:
    """Return the result object of `map`: m, rad and shares; nothing in it depends on how many computed it."""
    best = result.best_voxel
    joints = result.configurations(np.array([best]), at.q)[0]
    return {
        **map_about(result),
        "counted": result.counted,
        "voxels_reached": result.voxels,
        "volume": result.volume,
        "outside": result.outside,
        "low_dexterity_share": result.low_share,
        "unseen_share": result.unseen_share,
        "mean_orientation_coverage": float(np.mean(result.orientation_coverage[result.reached])),
        "best_voxel": {
            "position": nested(_middle(result, best)),
            "reach_count": int(result.reach_count.ravel()[best]),
            "best_singular_value": float(result.best_singular_value.ravel()[best]),
            "mean_singular_value": float(result.mean_singular_value.ravel()[best]),
            "orientation_coverage": float(result.orientation_coverage.ravel()[best]),
            "configuration": Configuration(at.robot, joints).by_joint(),
        },
        "certified": {"count": result.checked},
    }


def map_about(result: CapabilityMap) -> dict[str, Any]:
    """Return what the arrays of a map mean, as a file of them tells it too."""
    low, high = result.box
    return {
        "asked": _asked(result),
        "singular_value_unit": result.singular_value_unit,
        "source": {"kind": result.source.kind, "label": result.source.label},
        "count": result.count,
        "complete": result.complete,
        "voxel_size": result.grid.size,
        "shape": list(result.grid.shape),
        "dimensions": result.dimensions,
        "box": {"low": nested(np.round(low, _DIGITS)), "high": nested(np.round(high, _DIGITS))},
        "directions": DIRECTIONS,
    }


def _asked(result: CapabilityMap) -> dict[str, Any]:
    """Return all that the numbers depend on beside the robot and the configurations."""
    robot, moved = result.coordinates.model.robot, result.coordinates.indices
    approach = result.approach and {"direction": list(result.approach), "within_degrees": APPROACH}
    return {
        **asked_tool(result.velocity, result.task, result.length, result.length_reference),
        "approach": approach,
        "held": {name: float(result.held[i]) for i, name in enumerate(robot.position_names) if i not in moved},
    }


# --- base placement ------------------------------------------------------------------------------------------------


def placement_view(result: BasePlacement, at: Configuration, *, degrees: bool) -> View:
    """Return the view: the best positions of the base, and what each pose is like from the first of them."""
    angle, turn = ("deg", 180 / math.pi) if degrees else ("rad", 1.0)
    unit, count = result.capability.singular_value_unit, len(result.poses)
    rows: list[tuple[Cell, ...]] = [
        (str(i + 1), one.x, one.y, one.yaw * turn, str(one.count), str(one.promised), one.worst, one.dexterity)
        for i, one in enumerate(result.proved)
    ]
    shown = tuple(
        (*(cell if isinstance(cell, str) else _short(float(cell or 0.0)) for cell in row[:-2]), *map(_value, row[-2:]))
        for row in rows
    )
    header = ("rank", "x", "y", "yaw", "reached", "promised", "worst", "map's mean")
    title = (
        f"positions of the base in the plane z = 0 of the poses (x, y in m, yaw in {angle}); how many poses inverse "
        "kinematics reaches, and the map promises; smallest singular values: of the worst pose that is reached, and on "
        "average by the map"
    )
    units = ("", "m", "m", angle, "", "", unit, unit)
    flat_header = ("rank", "x", "y", "yaw", "reached", "promised", "worst_singular_value", "mean_best_singular_value")
    flat_rows = tuple((*row[:3], one.yaw, *row[4:]) for row, one in zip(rows, result.proved, strict=True))
    flat = Table(flat_header, flat_rows, ("", "m", "m", "rad", *units[4:]))
    base, link = cut(result.capability.velocity.relative_to), cut(result.capability.velocity.of)
    what = f"where to place the base ({base}) for {count} pose{'s' if count > 1 else ''} of {link}"
    if not result.proved:
        return View(what, (), (str(result.why_none), *_ways(result, degrees)), flat=flat)
    tables = (Table(header, shown, title=title, words=True), *_poses_table(result, at, degrees))
    return View(what, tables, _ways(result, degrees), flat=flat)


def _value(cell: Cell) -> str:
    return _short(float(cell or 0.0))


def _poses_table(result: BasePlacement, at: Configuration, degrees: bool) -> list[Table]:
    best, names = result.proved[0], result.capability.coordinates.names
    units = [("deg" if degrees else "rad") if turns else "m" for turns in result.capability.coordinates.turning]
    rows: list[tuple[Cell, ...]] = []
    for i, reached in enumerate(best.reached):
        values = Configuration(at.robot, best.q[i]).positions(degrees=degrees)[
            list(result.capability.coordinates.indices)
        ]
        cells = [float(best.smallest[i]), *map(float, values)] if reached else [None] * (1 + len(names))
        rows.append((str(i + 1), "yes" if reached else "no", *cells))
    header = ("pose", "reached", "smallest", *names)
    title = "the poses from the first of them: the smallest singular value, and the joints that reach them"
    units_row = ("", "", result.capability.singular_value_unit, *units)
    return [Table(header, tuple(rows), units_row, title=title)]


def _ways(result: BasePlacement, degrees: bool) -> tuple[str, ...]:
    capability = result.capability
    said = [
        f"{result.map.promised.size:,} positions, {capability.grid.size:g} m apart, judged by a map of "
        f"{capability.count:,} configurations; the most promising tried by inverse kinematics inside limits, and the "
        "best of these bettered step by step: a search, no proof that none is better",
    ]
    if result.looked_at < len(result.poses):
        said.append(f"the search looked at {result.looked_at} of the poses, evenly spread; the numbers are of all")
    if result.oriented:
        said.append(f"roll, pitch and yaw of the poses were read in {'degrees' if degrees else 'radians'}")
    return (*said, *_asked_notes(capability))


def placement_result(result: BasePlacement, at: Configuration, *, degrees: bool = False) -> dict[str, Any]:
    """Return the result object of `map --poses`: the map's, and the positions of the base, the best first.

    `degrees`: that roll, pitch and yaw of the poses were read in degrees.
    """
    return {
        **map_result(result.capability, at),
        "poses": nested(result.poses),
        "oriented": result.oriented,
        "pose_angles_read_in": "deg" if degrees else "rad",
        "positions_judged": int(result.map.promised.size),
        "poses_looked_at": result.looked_at,
        "placements": [_proved(one, at) for one in result.proved],
        "placements_reason": result.why_none,
    }


def _proved(one: ProvedPlacement, at: Configuration) -> dict[str, Any]:
    return {
        "x": one.x,
        "y": one.y,
        "yaw": one.yaw,
        "promised": one.promised,
        "mean_best_singular_value": one.dexterity,
        "reached": one.count,
        "worst_singular_value": one.worst if one.count else None,
        "poses": [
            {
                "reached": bool(reached),
                "minimum_singular_value": number(float(value)),
                "configuration": Configuration(at.robot, q).by_joint(),
            }
            for reached, value, q in zip(one.reached, one.smallest, one.q, strict=True)
        ],
    }
