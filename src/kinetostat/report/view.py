"""Results to views: titled tables of numbers and words, which a renderer turns into text or CSV."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kinetostat.conventions import Array, Order, Velocity
from kinetostat.errors import cut
from kinetostat.urdf.description import Joint, JointType, Robot
from kinetostat.urdf.files import short_names

if TYPE_CHECKING:
    from kinetostat.analysis.configuration import Configuration
    from kinetostat.analysis.crosscheck import Certificate
    from kinetostat.analysis.jacobian import Jacobian
    from kinetostat.analysis.kinematics import FrameChange, Placement
    from kinetostat.analysis.summary import Summary
    from kinetostat.lint.finding import Finding

__all__ = [
    "Cell",
    "Table",
    "View",
    "adjoint_view",
    "configuration_note",
    "fk_view",
    "frames_view",
    "info_view",
    "jacobian_view",
    "robots_view",
    "velocity_label",
]

Cell = str | float | None

_TOO_TALL = 400  # rows of a drawn tree


@dataclass(frozen=True)
class Table:
    """A header, a unit for each column, and rows. The first column labels the row.

    A table of numbers is set in columns of one width and one format; a table of words (`words`) as lines to read.
    """

    header: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    units: tuple[str, ...] = ()
    title: str = ""
    words: bool = False


@dataclass(frozen=True)
class View:
    """What is shown of a result: a title, a drawing, tables, and lines below them; and the table that CSV gives."""

    title: str
    tables: tuple[Table, ...] = ()
    notes: tuple[str, ...] = ()
    drawing: tuple[str, ...] = ()
    flat: Table | None = None  # the table for CSV, where it is not the first

    @property
    def csv(self) -> Table:
        """The table that CSV gives."""
        return self.flat or self.tables[0]


def certificate_note(certificate: Certificate) -> str:
    """Return the certificate in a line."""
    if certificate.max_difference is None:
        return f"not cross-checked: {certificate.engines[0]} alone"
    both, verdict = " and ".join(certificate.engines), "agree" if certificate.agree else "DISAGREE"
    numbers = f"largest difference {certificate.max_difference:.1e}, tolerance {certificate.tolerance:.1e}"
    return f"{both} {verdict}: {numbers}"


def disagreement_tables(certificate: Certificate) -> tuple[Table, ...]:
    """Return both engines' numbers where they disagree."""
    tables = []
    for engine, value in zip(certificate.engines, certificate.values, strict=False):
        flat = value.reshape(-1, value.shape[-1]) if value.ndim > 1 else value[None]
        rows: list[tuple[Cell, ...]] = [(f"row {i + 1}", *map(float, row)) for i, row in enumerate(flat)]
        header = ("", *(str(i + 1) for i in range(flat.shape[-1])))
        tables.append(Table(header, tuple(rows), title=f"by {engine}"))
    return tuple(tables)


def velocity_label(velocity: Velocity) -> str:
    """Return a velocity's label in words: of, relative to, expressed in."""
    if velocity.point is None:
        point = f"the point of {cut(velocity.of)} at the origin of {cut(velocity.relative_to)}"
    elif any(velocity.point):
        point = f"point ({', '.join(f'{c:g}' for c in velocity.point)}) m of {cut(velocity.of)}"
    else:
        point = f"the origin of {cut(velocity.of)}"
    return f"of {point},\nrelative to {cut(velocity.relative_to)}, in the axes of {cut(velocity.expressed_in)}"


def jacobian_view(result: Jacobian, at: Configuration, *, order: Order, degrees: bool) -> View:
    """Return the view of a Jacobian; its rows in the given order."""
    kind = "Jacobian" if result.rates is None else f"analytic Jacobian ({result.rates.reading})"
    header = ("", "unit", *result.columns)
    units = ("", "", *result.column_units)
    flat = Table(header, _matrix_rows(result, result.matrix, order), units)
    tables = [flat]
    positions = _positions(at, result.columns, degrees)
    if positions is not None:
        tables = [replace(flat, rows=(("q", _angle_and_length(at, result.columns, degrees), *positions), *flat.rows))]
    if result.time_derivative is not None:
        rows = _matrix_rows(result, result.time_derivative, order, per_second=True)
        tables.append(Table(header, rows, units, title="its time derivative along the given joint rates"))
        flat = replace(flat, rows=(*flat.rows, *((f"d{row[0]}/dt", *row[1:]) for row in rows)))
    notes: tuple[str, ...] = () if result.columns else ("no joint moves this frame relative to the observer",)
    if result.rates is not None and result.angles is not None:
        values = np.degrees(result.angles) if degrees else result.angles
        named = ", ".join(f"{name} {value:.6g}" for name, value in zip(result.rates.angle_names, values, strict=True))
        notes += (f"angles: {named} {'deg' if degrees else 'rad'}",)
    if any(joint.type.nq > 1 for joint in at.robot.independent):
        notes += (configuration_note(at, degrees),)
    return View(f"{kind} {velocity_label(result.velocity)}", tuple(tables), notes, flat=flat)


def _matrix_rows(
    result: Jacobian, matrix: Array, order: Order, *, per_second: bool = False
) -> tuple[tuple[Cell, ...], ...]:
    rows: list[tuple[Cell, ...]] = []
    for i in order.rows:
        unit = result.row_units[i].replace("/s", "/s2") if per_second else result.row_units[i]
        rows.append((result.rows[i], unit, *map(float, matrix[i])))
    return tuple(rows)


def _positions(at: Configuration, columns: Sequence[str], degrees: bool) -> list[Cell] | None:
    """Return the position of each column's joint, None where it has several; in degrees only where all are angles."""
    shown, found = at.positions(degrees=degrees), list[Cell]()
    for name in columns:
        joint = at.robot.joint_by_name.get(name)
        if joint is None or joint.type.nq != 1:
            found.append("")
            continue
        value = float(shown[at.robot.position_slices[name].start])
        # Words, not numbers: a large position does not coarsen the format of the matrix below it.
        found.append(f"{value:.5f}" if abs(value) < 1000 else f"{value:.6g}")
    return found if columns else None


def _angle_and_length(at: Configuration, columns: Sequence[str], degrees: bool) -> str:
    """Return the unit of the positions above a Jacobian; two where there are angles and lengths."""
    joints = [at.robot.joint_by_name[name] for name in columns if name in at.robot.joint_by_name]
    angles = any(joint.type.is_angle for joint in joints)
    lengths = any(joint.type is JointType.PRISMATIC for joint in joints)
    return "|".join(unit for unit, used in (("deg" if degrees else "rad", angles), ("m", lengths)) if used)


def configuration_note(at: Configuration, degrees: bool) -> str:
    """Return the configuration in words: the positions that are not zero."""
    from kinetostat.analysis.configuration import neutral

    shown, rest, parts = at.positions(degrees=degrees), neutral(at.robot), []
    for joint in at.robot.independent:
        where = at.robot.position_slices[joint.name]
        if np.any(shown[where] != rest[where]):
            parts.append(f"{cut(joint.name)} {' '.join(f'{float(value):.6g}' for value in shown[where])}")
    unit = "deg" if degrees else "rad"
    return f"at zero (angles in {unit})" if not parts else f"at {', '.join(parts)} (m, {unit}; others zero)"


def fk_view(result: Placement, at: Configuration, *, degrees: bool) -> View:
    """Return the view of a placement."""
    angles = np.degrees(result.rpy) if degrees else result.rpy
    x, y, z = (float(c) for c in result.position)
    position = Table(("", "unit", "x", "y", "z"), (("position", "m", x, y, z),))
    turned = Table(("", "unit", "roll", "pitch", "yaw"), (("rpy", "deg" if degrees else "rad", *map(float, angles)),))
    quaternion = Table(("", "x", "y", "z", "w"), (("quaternion", *map(float, result.quaternion_xyzw)),))
    matrix = Table(
        ("", "x", "y", "z", "origin"),
        tuple((f"row {i + 1}", *map(float, result.matrix[i])) for i in range(4)),
        title="matrix T",
    )
    unit = "deg" if degrees else "rad"
    flat = Table(
        ("frame", "relative_to", "x", "y", "z", "qx", "qy", "qz", "qw", "roll", "pitch", "yaw"),
        ((result.frame, result.relative_to, x, y, z, *map(float, result.quaternion_xyzw), *map(float, angles)),),
        ("", "", "m", "m", "m", "", "", "", "", unit, unit, unit),
    )
    title = f"{cut(result.frame)} relative to {cut(result.relative_to)}"
    return View(title, (position, turned, quaternion, matrix), (configuration_note(at, degrees),), flat=flat)


def adjoint_view(
    result: FrameChange, at: Configuration, given: Array | None, applied: Array | None, *, order: Order, degrees: bool
) -> View:
    """Return the view of a frame change; rows and columns, and the applied six-vector, in the given order."""
    names, units = result.kind.rows, result.kind.units
    rows: list[tuple[Cell, ...]] = [
        (names[i], units[i], *(float(result.matrix[i, j]) for j in order.rows)) for i in order.rows
    ]
    header = ("", "unit", *(names[j] for j in order.rows))
    flat = Table(header, tuple(rows), ("", "", *(units[j] for j in order.rows)))
    tables = [flat]
    if given is not None and applied is not None:
        carried: list[tuple[Cell, ...]] = [(names[i], units[i], float(given[i]), float(applied[i])) for i in order.rows]
        ends = cut(result.start), cut(result.end)
        tables.append(
            Table(
                ("", "unit", *ends), tuple(carried), title=f"the given {result.kind}, and the same in the other frame"
            )
        )
        both = tuple((*row, *more[2:]) for row, more in zip(flat.rows, carried, strict=True))
        flat = Table((*flat.header, "given", "applied"), both, (*flat.units, "", ""))
    title = f"6x6 that carries a {result.kind} in {cut(result.start)} to {cut(result.end)}"
    return View(title, tuple(tables), (configuration_note(at, degrees),), flat=flat)


def frames_view(robot: Robot) -> View:
    """Return the view of the frames: every link, and the joint that carries it."""
    rows: list[tuple[Cell, ...]] = []
    for link in robot.links:
        joint = robot.parent_joint.get(link.name)
        depth = sum(1 for _ in robot.to_root(link.name))
        if joint is None:
            rows.append((link.name, "", "", "", str(depth)))
        else:
            rows.append((link.name, joint.parent, joint.name, joint.type.value, str(depth)))
    return View(
        f"{len(rows)} frames of {cut(robot.name)}, root {cut(robot.root)}",
        (Table(("frame", "parent", "joint", "type", "depth"), tuple(rows), words=True),),
    )


def info_view(result: Summary, odd: Sequence[Finding], *, degrees: bool) -> View:
    """Return the view of what is in a file, and what is odd about it."""
    robot = result.robot
    movable = sum(joint.type is not JointType.FIXED for joint in robot.joints)
    name = cut(robot.name) or "a robot without a name"
    total = result.base_mass + result.moving_mass
    title = (
        f"{name}: {_counted(len(robot.links), 'link')}, {_counted(len(robot.joints), 'joint')} ({movable} movable), "
        f"{robot.nv} degree{'' if robot.nv == 1 else 's'} of freedom\n"
        f"mass {total:.6g} kg, {result.moving_mass:.6g} kg without the base link {cut(robot.root)}\n"
        f"longest chain {result.reach:.4g} m, stretched out"
    )
    tables = [_joint_table(robot, degrees)]
    followers: tuple[tuple[Cell, ...], ...] = tuple((j.name, _law(j)) for j in robot.joints if j.mimic is not None)
    chains = tuple((c.tip, str(len(c.joints)), " ".join(c.joints)) for c in result.chains)
    groups = tuple((name, str(len(joints)), " ".join(joints)) for name, joints in result.groups.items())
    states = tuple((state,) for state in result.states)
    remarks = tuple((str(f.line) if f.line else "", f.code, f.element, f.message) for f in odd)
    tables += [
        Table(header, rows, title=title, words=True)
        for title, header, rows in (
            ("followers", ("joint", "position"), followers),
            ("chains", ("tip", "joints", "in path order"), chains),
            ("SRDF groups", ("group", "joints", "named"), groups),
            ("SRDF states, for --config", ("state",), states),
            ("what is odd about the file", ("line", "rule", "element", "finding"), remarks),
        )
        if rows
    ]
    notes = ("kinetostat check looks closer",) if remarks else ("nothing is odd about the file",)
    return View(title, tuple(tables), notes, tree_lines(robot))


def _counted(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def _joint_table(robot: Robot, degrees: bool) -> Table:
    """Return the movable joints with their limits in rad (or deg), m, Nm or N, per second."""
    rows: list[tuple[Cell, ...]] = []
    for joint in robot.joints:
        if joint.type is not JointType.FIXED:
            factor = 180 / math.pi if degrees and joint.type.is_angle else 1.0
            ends = joint.limit.range if joint.type.nq == 1 else (None, None)
            cells = [*(_scaled(end, factor) for end in ends), joint.limit.effort, _scaled(joint.limit.velocity, factor)]
            rows.append((joint.name, joint.type.value, _axis(joint), *cells))
    header = ("joint", "type", "axis", "lower", "upper", "effort", "velocity")
    title = f"movable joints; angles in {'deg' if degrees else 'rad'}, lengths in m, effort in Nm or N, velocity per s"
    return Table(header, tuple(rows), title=title, words=True)


def _scaled(value: float | None, factor: float) -> float | None:
    return None if value is None or not math.isfinite(value) else value * factor


def _axis(joint: Joint) -> str:
    return "" if joint.type is JointType.FLOATING else " ".join(f"{c:.3g}" for c in joint.axis)


def _law(joint: Joint) -> str:
    """Return a follower's law in words."""
    if joint.mimic is None:
        return ""
    offset = f" {joint.mimic.offset:+g}" if joint.mimic.offset else ""
    return f"{joint.mimic.multiplier:g} x {cut(joint.mimic.joint)}{offset}"


def tree_lines(robot: Robot) -> tuple[str, ...]:
    """Return the kinematic tree drawn with lines, links with the joints that carry them."""
    lines = [cut(robot.root)]
    stack = [
        (joint, "", i == len(robot.child_joints[robot.root]) - 1)
        for i, joint in enumerate(robot.child_joints[robot.root])
    ][::-1]
    while stack:
        if len(lines) >= _TOO_TALL:
            return (*lines, f"... and {len(robot.links) - len(lines)} links more (kinetostat frames lists them)")
        joint, indent, last = stack.pop()
        lines.append(f"{indent}{'`-' if last else '|-'} {cut(joint.child)}  ({cut(joint.name)}, {_kind(joint)})")
        below = robot.child_joints[joint.child]
        inner = indent + ("  " if last else "| ")
        stack += [(child, inner, i == len(below) - 1) for i, child in enumerate(below)][::-1]
    return tuple(lines)


def _kind(joint: Joint) -> str:
    return f"screw, {joint.pitch:g} m a turn" if joint.type is JointType.SCREW else joint.type.value


def robots_view(textbook: dict[str, Path], example: dict[str, Path]) -> View:
    """Return the view of the robots that ship with the project and with example-robot-data."""
    rows: list[tuple[Cell, ...]] = [(f"textbook:{name}", "kinetostat") for name in textbook]
    rows += [(f"example:{name}", "example-robot-data") for name in short_names(example)]
    return View(f"{len(rows)} robots", (Table(("robot", "comes with"), tuple(rows), words=True),))
