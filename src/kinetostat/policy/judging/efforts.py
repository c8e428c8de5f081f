"""What the joints bear, and what they may give."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from kinetostat.analysis.configuration import neutral
from kinetostat.analysis.loads import Payload, load_at
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.errors import quote
from kinetostat.policy import words
from kinetostat.policy.judging.found import Found, above, agreed, below, configurations, ends, mattering, witness
from kinetostat.policy.kinds.efforts import Holds, JointLimits, WorstGravity
from kinetostat.urdf.description import Joint, JointType, Robot

__all__ = ["holds", "joint_limits", "worst_gravity_torque"]

_NO_EFFORT = 1e-9  # Nm or N, and of the largest torque: a joint without a limit that bears less needs none


def holds(model: Model, asked: Holds, folder: Path) -> Found:  # noqa: ARG001 (all judges alike)
    """Judge the use of effort limits, all configurations at once."""
    from kinetostat.analysis.statics import torque

    robot = model.robot
    loaded = bool(asked.payload) or asked.wrench is not None
    frame, observer = ends(robot, asked) if loaded or asked.frame else ("", robot.root)
    path = robot.moving_joints(observer, frame) if frame else list(robot.independent)
    at = configurations(model, asked.at, path)
    point = asked.point or (0.0, 0.0, 0.0)
    wrenches = [] if asked.wrench is None else [load_at(robot, frame, asked.wrench, axes=asked.axes, point=point)]
    result = torque(
        model,
        at.q,
        wrenches,
        on=asked.on,
        gravity=asked.gravity,
        payload=Payload(asked.payload, frame, point) if asked.payload else None,
        limits=asked.effort_limits,
    )
    agreed(result.certificate)
    if not loaded and not any(model.engine.masses()):
        return _WEIGHTLESS
    joints = _chosen(robot, asked.joints) or path
    if not joints:
        return Found(None, "no joint can move")
    columns = robot.velocity_columns(joints)
    use = _Use(result.columns, result.units, result.total, result.utilisation, columns)
    row, column = use.worst
    where = f" at {at.labels[row]}" if len(at.labels) > 1 else ""
    worst = next(joint for joint in joints if column in robot.velocity_columns([joint]))
    return use.found(asked.at_most_percent, where, witness(robot, at.q[row], mattering(robot, worst, at.q[row], frame)))


def worst_gravity_torque(model: Model, asked: WorstGravity, folder: Path) -> Found:  # noqa: ARG001
    """Judge the use of effort limits by the worst torque of each joint."""
    from kinetostat.analysis.worst import worst_torques

    robot, frame = model.robot, ""
    payload = None
    if asked.payload:
        frame = robot.frame(asked.frame or robot.default_tip())
        payload = Payload(asked.payload, frame, asked.point or (0.0, 0.0, 0.0))
    elif not any(model.engine.masses()):
        return _WEIGHTLESS
    result = worst_torques(
        model,
        neutral(robot),
        gravity=True if asked.gravity is None else asked.gravity,
        payload=payload,
        limits=asked.effort_limits,
        joints=asked.joints or None,
        samples=asked.samples,
        seed=asked.seed,
    )
    agreed(result.certificate)
    use = _Use(result.joints, result.units, result.torques[None], result.utilisation[None], range(len(result.joints)))
    column = use.worst[1]
    worst, q = robot.joint_by_name[result.joints[column]], result.witnesses[column]
    return use.found(asked.at_most_percent, "", witness(robot, q, mattering(robot, worst, q, frame)))


_WEIGHTLESS = Found(None, "the file gives the links no mass: nothing is to be held")


class _Use:
    """The use of effort limits by torques (m, n), of the joints that count."""

    def __init__(
        self, names: Sequence[str], units: Sequence[str], torques: Array, use: Array, columns: Sequence[int]
    ) -> None:
        self._names, self._units, self._columns = names, units, list(columns)
        self._torques, self._use = torques[:, self._columns], use[:, self._columns]

    @property
    def worst(self) -> tuple[int, int]:
        """The row and the column with the largest use; where no joint has a limit, with the largest torque."""
        known = np.where(np.isnan(self._use), -1.0, self._use)
        sizes = known if np.any(known >= 0) else np.abs(self._torques)
        row, column = np.unravel_index(int(np.argmax(sizes)), sizes.shape)
        return int(row), self._columns[int(column)]

    def found(self, at_most_percent: float, where: str, at: dict[str, float]) -> Found:
        """Return what is found: a joint that bears something and has no limit leaves it open, unless another fails."""
        row, column = self.worst
        place = self._columns.index(column)
        largest, name = float(self._use[row, place]), quote(self._names[column])
        bears = f"{self._torques[row, place]:.4g} {self._units[column]}"
        text = "" if np.isnan(largest) else f"{100 * largest:.4g} % of the effort limit of {name} ({bears})"
        met = not np.isnan(largest) and below(100 * largest, at_most_percent)
        if text and not met:
            return Found(False, text + where, at)
        lost = self._without_limit()
        if lost:
            text = f"{text + where}; but " if text else ""
            return Found(None, f"{text}no effort limit in the file of {words.names(lost)}: give effort-limits", at)
        return Found(met, text + where, at) if text else Found(None, "no joint has an effort limit, and none bears any")

    def _without_limit(self) -> list[str]:
        floor = _NO_EFFORT * max(1.0, float(np.max(np.abs(self._torques), initial=0.0)))
        lost = np.any(np.isnan(self._use) & (np.abs(self._torques) > floor), axis=0)
        return [self._names[column] for column, one in zip(self._columns, lost, strict=True) if one]


def _chosen(robot: Robot, names: Sequence[str]) -> list[Joint]:
    return [robot.independent_joint(name) for name in names]


def joint_limits(model: Model, asked: JointLimits, folder: Path) -> Found:  # noqa: ARG001
    """Judge the limits of joints, as the file has them."""
    from kinetostat.errors import unknown_name

    robot = model.robot
    unmet, missing, checked = list[str](), list[str](), list[str]()
    for name in asked.joints:
        joint = robot.joint_by_name.get(name)
        if joint is None:
            raise unknown_name("joint", name, robot.joint_by_name)
        bound_to = _not_free(robot, joint)
        if bound_to:
            unmet.append(bound_to)
            continue
        for key, bound in asked.bounds.items():
            what, _, word = key.partition("-at-")
            value = _limit(joint, what)
            shown = f"{what} of {quote(name)} is {_shown(value)}"
            if value is None:
                missing.append(shown)
            else:
                met = above(value, bound) if word == "least" else below(value, bound)
                (checked if met else unmet).append(shown)
    if unmet:
        return Found(False, ", ".join(unmet[:_FEW]) + (f" and {len(unmet) - _FEW} more" if len(unmet) > _FEW else ""))
    if missing:
        return Found(False, missing[0] + (f", and {len(missing) - 1} more" if len(missing) > 1 else ""))
    return Found(True, f"{words.counted(len(checked), 'limit')} as wanted")


_FEW = 3


def _not_free(robot: Robot, joint: Joint) -> str:
    """Return why the limits of a joint are not those of a motion of its own; empty where they are."""
    if joint.type is JointType.FIXED:
        return f"{quote(joint.name)} is fixed: it has no limits"
    if joint.mimic is not None:
        leader = robot.followers[joint.name].joint
        return f"{quote(joint.name)} follows {quote(leader)}: it has no limits of its own"
    return ""


def _shown(value: float | None) -> str:
    return "not stated" if value is None else "without end" if math.isinf(value) else f"{value:.6g}"


def _limit(joint: Joint, what: str) -> float | None:
    """Return a limit as the file has it; None where there is none."""
    if what in ("effort", "velocity"):
        found: float | None = getattr(joint.limit, what)
        return found
    if joint.type.nq != 1:
        return None
    lower, upper = (-math.inf, math.inf) if joint.type is JointType.CONTINUOUS else joint.limit.range
    return lower if what == "lower" else upper
