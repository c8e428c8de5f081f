"""How well a frame can move: indices of its Jacobian, and the distance to singularities."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kinetostat.analysis import manipulability as measures
from kinetostat.analysis.manipulability import Block
from kinetostat.analysis.task import ROTATION, TRANSLATION, Task, turning_columns
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.policy.judging.found import Configurations, Found, above, agreed, configurations, ends, witness
from kinetostat.policy.kinds.dexterity import Dexterity, SingularDistance
from kinetostat.urdf.description import Joint

__all__ = [
    "distance_to_singularity",
    "inverse_condition_number",
    "manipulability",
    "measured",
    "smallest_singular_value",
]

_ALL = "xyz rx ry rz"
_BLOCKS = {"all": "full", "translation": "translation", "rotation": "rotation"}


def smallest_singular_value(model: Model, asked: Dexterity, folder: Path) -> Found:  # noqa: ARG001 (all judges alike)
    """Judge the smallest singular value."""
    return _index(model, asked, lambda block: block.minimum_singular_value, with_unit=True)


def manipulability(model: Model, asked: Dexterity, folder: Path) -> Found:  # noqa: ARG001
    """Judge Yoshikawa's manipulability."""
    return _index(model, asked, lambda block: block.yoshikawa)


def inverse_condition_number(model: Model, asked: Dexterity, folder: Path) -> Found:  # noqa: ARG001
    """Judge the inverse condition number."""
    return _index(model, asked, lambda block: block.inverse_condition_number)


@dataclass(frozen=True)
class Measured:
    """The indices of the rows that count, at all configurations at once.

    Attributes:
        block: the indices, (m,).
        at: the configurations.
        joints: those of the chain.
        lacking: the rank that the structure gives the rows at almost every configuration, where that is too low for the
            smallest singular value ever to be other than zero; else None.
    """

    block: Block
    at: Configurations
    joints: tuple[Joint, ...]
    lacking: int | None


def measured(model: Model, asked: Dexterity) -> Measured:
    """Return the indices of a frame's Jacobian; the engines agree on it.

    Raises:
        UsageError: no such frame, configuration or rows; a length that is asked for and that there is not.
        DisagreementError: the engines disagree.
    """
    robot = model.robot
    frame, observer = ends(robot, asked)
    joints = robot.moving_joints(observer, frame)
    at = configurations(model, asked.at, joints)
    task = _task(asked.rows)
    result = measures.manipulability(
        model,
        frame,
        at.q,
        relative_to=observer,
        point=asked.point,
        axes=None if asked.rows in _BLOCKS else asked.rows,
        length=asked.length if task.mixes(turning_columns(joints)) else "none",
    )
    agreed(result.certificate)
    block = result.blocks[_BLOCKS.get(asked.rows, "task")]
    full = min(len(task.rows), len(result.columns))
    return Measured(block, at, tuple(joints), block.usual_rank if block.usual_rank < full else None)


def _index(model: Model, asked: Dexterity, read: Callable[[Block], Array], *, with_unit: bool = False) -> Found:
    """Judge the smallest value of an index."""
    found = measured(model, asked)
    values = read(found.block)
    worst = int(np.argmin(values))
    unit = f" {found.block.unit}" if with_unit and found.block.unit not in ("1", "mixed") else ""
    text = f"{values[worst]:.6g}{unit}"
    if len(values) > 1:
        short = sum(not above(float(value), asked.at_least) for value in values)
        text += f" at {found.at.labels[worst]}" + (f" ({short} of {len(values)} fall short)" if short else "")
    if found.lacking is not None:
        text += f"; the structure has rank {found.lacking} of these rows: choose rows that it moves"
    return Found(
        above(float(values[worst]), asked.at_least), text, witness(model.robot, found.at.q[worst], found.joints)
    )


def _task(rows: str) -> Task:
    named = {"all": Task.named(_ALL), "translation": TRANSLATION, "rotation": ROTATION}
    return named[rows] if rows in named else Task.named(rows)


def distance_to_singularity(model: Model, asked: SingularDistance, folder: Path) -> Found:  # noqa: ARG001
    """Judge the distance to the nearest singular configuration that is found."""
    from kinetostat.analysis.singular.at import singular_at

    robot = model.robot
    frame, observer = ends(robot, asked)
    at = configurations(model, asked.at, robot.moving_joints(observer, frame))
    axes = None if asked.rows == "auto" else _axes(asked.rows)
    best: Found | None = None
    nearest = np.inf
    for label, q in zip(at.labels, at.q, strict=True):
        here = singular_at(model, frame, q, relative_to=observer, point=asked.point, axes=axes)
        agreed(here.certificate)
        found, there, inside = here.distance.distance, here.distance.q, here.distance.inside_limits
        if asked.within_limits and not inside and not here.singular:
            found, there = here.distance.inside or (None, None)
        if found is not None and there is not None and found < nearest:
            nearest = found
            name = f", {here.name}" if here.name else ""
            text = f"singular{name}" if here.singular else f"{found:.6g} rad"
            text += f" from {label}" if len(at.labels) > 1 else ""
            place = dict(zip(here.mechanism.names, map(float, there), strict=True))
            best = Found(above(found, asked.at_least), text, place)
    return best or Found(True, "no singular configuration is found")


def _axes(rows: str) -> str:
    return {"all": _ALL, "translation": "xyz", "rotation": "rx ry rz"}.get(rows, rows)
