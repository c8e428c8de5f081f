"""Whether a frame reaches poses."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from kinetostat.analysis.inverse.ik import InverseKinematics, ik
from kinetostat.analysis.inverse.pose import Pose, pose
from kinetostat.analysis.task import Task
from kinetostat.conventions import Array, Flags
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError, quote
from kinetostat.policy import words
from kinetostat.policy.judging.files import text_beside
from kinetostat.policy.judging.found import Found, agreed, configurations, ends, quiet, witness
from kinetostat.policy.kinds.poses import Reaches
from kinetostat.urdf.description import Robot

__all__ = ["reaches"]


def reaches(model: Model, asked: Reaches, folder: Path) -> Found:
    """Judge whether each pose is reached inside joint limits: by inverse kinematics from several starts."""
    robot = model.robot
    frame, observer = ends(robot, asked)
    poses = _poses(asked, folder)
    start = configurations(model, asked.at).q[0]
    missed = list[tuple[float, str, Array]]()
    rows = _rows(asked.rows)
    for oriented in (True, False):
        numbers = [i for i, (_, one) in enumerate(poses) if one.oriented is oriented]
        if not numbers:
            continue
        result = ik(
            model,
            frame,
            Pose(np.array([poses[i][1].matrix for i in numbers]), oriented),
            start,
            axes=rows,
            reference=asked.reference,
            relative_to=observer,
            point=asked.point,
            tries=asked.tries,
            seed=asked.seed,
        )
        agreed(result.certificate)
        for row in np.flatnonzero(~_reached(result, asked)):
            missed.append(_missed(robot, result, int(row), poses[numbers[row]][0]))
    if not missed:
        return Found(True, f"all {len(poses)} are reached" if len(poses) > 1 else "it is reached")
    _, text, q = max(missed, key=lambda one: one[0])
    count = f"{len(missed)} of {len(poses)} are not reached; " if len(poses) > 1 else ""
    return Found(False, count + text, witness(robot, q, robot.movable_path(observer, frame)))


def _rows(rows: str) -> str | None:
    return {"": None, "all": "xyz rx ry rz", "translation": "xyz", "rotation": "rx ry rz"}.get(rows, rows)


def _reached(result: InverseKinematics, asked: Reaches) -> Flags:
    near = (result.position_residual <= asked.position_tolerance) & (
        result.rotation_residual <= asked.rotation_tolerance
    )
    return np.asarray((result.converged | near) & result.inside_limits)


def _missed(robot: Robot, result: InverseKinematics, row: int, label: str) -> tuple[float, str, Array]:
    """Return by how much a pose is missed, that in words, and the configuration that comes nearest."""
    residuals = result.position_residual[row], result.rotation_residual[row]
    position, rotation = (quiet(float(part), robot) for part in residuals)
    if result.converged[row]:
        return position + rotation, f"{label} is reached outside joint limits alone", result.q[row]
    parts = [f"{position:.3g} m"] if result.task.linear else []
    parts += [f"{rotation:.3g} rad"] if result.task.angular else []
    return position + rotation, f"{label} is missed by {' and '.join(parts)}", result.q[row]


def _poses(asked: Reaches, folder: Path) -> list[tuple[str, Pose]]:
    """Return the poses, each with what it is called."""
    if not asked.file:
        return [(f"pose {i}", _oriented(pose(one), asked.rows)) for i, one in enumerate(asked.poses, 1)]
    rows = _table(asked.file, text_beside(folder, asked.file))
    found = [(f"{words.name(asked.file)} line {line}", _oriented(one, asked.rows)) for line, one in rows]
    if not found:
        raise UsageError("there are no poses in it", file=asked.file, remedy="write a pose a row: x,y,z,roll,pitch,yaw")
    return found


def _table(name: str, text: str) -> Iterator[tuple[int, Pose]]:
    """Yield the poses of a CSV file and their lines; a header is for people.

    Raises:
        UsageError: a row is no pose, or the file is not CSV.
    """
    reader, first = csv.reader(text.splitlines(), strict=True), True
    try:
        for row in reader:
            if any(cell.strip() for cell in row):
                if not (first and _is_header(row)):
                    yield reader.line_num, _pose(row)
                first = False
    except csv.Error as error:
        message, remedy = f"not CSV: {error}", "is a quotation mark open?"
        raise UsageError(message, file=name, line=reader.line_num, remedy=remedy) from None
    except UsageError as error:
        raise UsageError(error.message, file=name, line=reader.line_num, remedy=error.remedy) from None


def _oriented(one: Pose, rows: str) -> Pose:
    """Return a pose whose rotation counts only if rows about axes do: then it goes with those that have none."""
    counts = not rows or bool(Task.named(_rows(rows) or "").angular)
    if counts or not one.oriented:
        return one
    return Pose(one.matrix, oriented=False)


def _is_header(row: list[str]) -> bool:
    return all(not _is_number(cell) for cell in row)


def _pose(row: list[str]) -> Pose:
    wrong = next((cell for cell in row if not _is_number(cell)), None)
    if wrong is not None:
        raise UsageError(f"{quote(wrong)} is not a number", remedy="a pose is a row of 3, 6, 7, 12 or 16 numbers")
    return pose([float(cell) for cell in row])


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
