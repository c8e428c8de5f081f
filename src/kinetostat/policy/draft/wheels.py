"""Wheels and casters: chains of which no reach and no dexterity is expected."""

from __future__ import annotations

import numpy as np

from kinetostat.analysis.configuration import random_configurations
from kinetostat.conventions import Velocity
from kinetostat.engines.model import Model
from kinetostat.urdf.description import JointType

__all__ = ["rolls"]

_SAMPLES = 8  # random configurations, the largest rank of which is that of almost every one
_ZERO = 1e-6  # of the robot's size, and of the largest singular value


def rolls(model: Model, frame: str) -> bool:
    """Return whether a chain ends in a wheel, a caster or another thing that spins for ever and goes nowhere by itself.

    Its last joint turns without end and does not move the frame's origin, which the joints above move along a curve at
    most (a caster's swivel), or not at all. An arm whose last joint is endless moves its origin by those above; the
    bob of a pendulum is moved by the last.
    """
    robot = model.robot
    ways = [joint for joint, _ in robot.path(robot.root, frame) if joint.type is not JointType.FIXED]
    if not ways or ways[-1].type is not JointType.CONTINUOUS or ways[-1].mimic is not None:
        return False
    joints = robot.movable_path(robot.root, frame)
    q = random_configurations(robot, 0, _SAMPLES)
    velocity = Velocity(frame, robot.root, robot.root, (0.0, 0.0, 0.0))
    moved = model.engine.jacobian(q, velocity)[..., :3, :]
    own = moved[..., robot.velocity_columns([ways[-1]])]
    size = max(robot.reach, 1e-3)
    if float(np.max(np.abs(own))) > _ZERO * size:
        return False
    values = np.linalg.svd(moved[..., robot.velocity_columns(joints)], compute_uv=False)
    return int(np.max(np.sum(values > _ZERO * size, axis=-1))) < 2
