"""What a robot is made of: degrees of freedom, mass."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from kinetostat.analysis.crosscheck import certified
from kinetostat.analysis.joint_values import listed
from kinetostat.engines.model import Model
from kinetostat.errors import quote, unknown_name
from kinetostat.policy import words
from kinetostat.policy.judging.found import Found, above, agreed, below, ends
from kinetostat.policy.kinds.structure import Follower, Mass, Mobility

__all__ = ["degrees_of_freedom", "mass", "mimic"]

_SAMPLES, _SEED = 32, 0  # random configurations, the largest rank of which is that of almost every one
_ZERO = 1e-5  # of the largest singular value: what a file that writes 1.5708 for pi/2 makes of a zero


def degrees_of_freedom(model: Model, asked: Mobility, folder: Path) -> Found:  # noqa: ARG001 (all judges alike)
    """Judge the number of joints' coordinates on a chain, or of independent motions of a frame."""
    robot = model.robot
    if asked.of == "frame":
        return _motions(model, asked)
    if asked.frame or asked.relative_to:
        frame, observer = ends(robot, asked)
        joints = robot.movable_path(observer, frame)
    else:
        joints = list(robot.independent)
    count = sum(joint.type.nv for joint in joints)
    return Found(count == asked.equals, f"{count}: {listed([joint.name for joint in joints])}" if joints else "0")


def _motions(model: Model, asked: Mobility) -> Found:
    """Judge the rank of a frame's Jacobian at almost every configuration, by both engines."""
    from kinetostat.analysis.configuration import random_configurations
    from kinetostat.analysis.manipulability import manipulability

    robot = model.robot
    frame, observer = ends(robot, asked)
    joints = robot.movable_path(observer, frame)
    if not joints:
        return Found(asked.equals == 0, "0: no joint moves it")
    q = random_configurations(robot, _SEED, _SAMPLES)
    result = manipulability(model, frame, q, relative_to=observer, length=max(robot.reach, 1e-3))
    agreed(result.certificate)
    values = result.blocks["full"].singular_values
    rank = int(np.max(np.sum(values > _ZERO * values[..., :1], axis=-1)))
    return Found(rank == asked.equals, f"{rank}, by {words.counted(len(result.columns), 'joint')}")


def mass(model: Model, asked: Mass, folder: Path) -> Found:  # noqa: ARG001
    """Judge the mass of all links, summed by both engines."""
    total = sum(abs(link.inertial.mass) for link in model.robot.links if link.inertial)
    masses, certificate = certified(model, lambda engine: np.array(engine.masses()), total)
    agreed(certificate)
    found = float(np.sum(masses))
    low = asked.at_least is None or above(found, asked.at_least)
    high = asked.at_most is None or below(found, asked.at_most)
    return Found(low and high, f"{found:.6g} kg")


def mimic(model: Model, asked: Follower, folder: Path) -> Found:  # noqa: ARG001
    """Judge whom a joint follows, and how: as the file says, or through the joints in between."""
    robot = model.robot
    for name in (asked.joint, asked.leader):
        if name not in robot.joint_by_name:
            raise unknown_name("joint", name, robot.joint_by_name)
    law = robot.joint_by_name[asked.joint].mimic
    if law is None:
        return Found(False, f"{quote(asked.joint)} follows no joint")
    if law.joint != asked.leader:
        law = robot.followers[asked.joint]
    near = max(abs(law.multiplier - asked.multiplier), abs(law.offset - asked.offset)) <= asked.tolerance
    return Found(law.joint == asked.leader and near, words.law(law.joint, law.multiplier, law.offset))
