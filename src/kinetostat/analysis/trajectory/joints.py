"""The joints of a trajectory: those between observer and tool, and all others that it moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.task import turning_columns
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError, quote
from kinetostat.urdf.description import Joint, JointType

__all__ = ["moved_joints", "speed_limits", "unwound"]


def moved_joints(chain: Coordinates, q: Array) -> Coordinates:
    """Return the coordinates of a chain, then those of all other joints whose position changes. (m, nq).

    The others move no frame of the chain, but their links weigh on its joints.

    Raises:
        UsageError: a floating joint moves.
    """
    robot, known = chain.model.robot, {joint.name for joint in chain.joints}
    moving = np.ptp(q, axis=0) > 0 if len(q) else np.zeros(q.shape[-1], dtype=bool)
    others = [j for j in robot.independent if np.any(moving[robot.position_slices[j.name]]) and j.name not in known]
    floating = next((joint for joint in others if joint.type is JointType.FLOATING), None)
    if floating is not None:
        raise UsageError(f"floating joint {quote(floating.name)} moves", remedy="hold it, by -q")
    each = [joint for joint in others for _ in range(joint.type.nq)]
    return Coordinates(
        chain.model,
        replace(chain.chain, fold=np.pad(chain.chain.fold, ((0, 0), (0, len(each))))),
        (*chain.names, *(name for joint in others for name in joint.position_names)),
        (*chain.joints, *each),
        (*chain.turning, *turning_columns(others)),
        (*chain.indices, *(i for j in others for i in range(*robot.position_slices[j.name].indices(robot.nq)))),
    )


def unwound(model: Model, q: Array) -> tuple[Array, tuple[str, ...]]:
    """Return configurations with continuous joints going on by the shorter way, and which joints that changes.

    A recorder writes a continuous joint's angle into one turn: the leap from pi to -pi is no motion. (m, nq).
    """
    robot, changed, found = model.robot, list[str](), q
    for joint in robot.independent:
        if joint.type is JointType.CONTINUOUS:
            where = robot.position_slices[joint.name].start
            steady = np.unwrap(q[:, where])
            if np.any(np.abs(steady - q[:, where]) > 1):
                found = q.copy() if found is q else found
                found[:, where] = steady
                changed.append(joint.name)
    return found, tuple(changed)


def speed_limits(joints: Coordinates) -> Array:
    """Return the largest rate of each coordinate, its followers counted; NaN where none is stated. (n,), rad/s, m/s."""
    robot = joints.model.robot
    found = [_stated(joint) for joint in joints.joints]
    for name, law in robot.followers.items():
        for i, joint in enumerate(joints.joints):
            if joint.name == law.joint and law.multiplier:
                found[i] = float(np.fmin(found[i], _stated(robot.joint_by_name[name]) / abs(law.multiplier)))
    return np.array(found, dtype=np.float64)


def _stated(joint: Joint) -> float:
    """Return a velocity limit; zero is written for "not known"."""
    speed = joint.limit.velocity if joint.type.nv == 1 else None
    return speed if speed is not None and speed > 0 else float("nan")
