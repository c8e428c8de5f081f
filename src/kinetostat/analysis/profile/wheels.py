"""Wheels, casters and rotors: chains of which no reach and no dexterity is expected."""

from __future__ import annotations

import numpy as np

from kinetostat.analysis.configuration import random_configurations
from kinetostat.conventions import Velocity
from kinetostat.engines.model import Model
from kinetostat.urdf.description import Joint, JointType

__all__ = ["rolls", "spins"]

_SAMPLES = 8  # random configurations, the largest rank of which is that of almost every one
_ZERO = 1e-6  # of the robot's size
_TURNS = 4.1 * np.pi  # rad: a range beyond two turns is none (that of many wrists is two)
_BALANCED = 0.5  # of a body's radius of gyration: a centre of mass nearer to the axis than that is a wheel's


def rolls(model: Model, frame: str) -> bool:
    """Return whether a chain ends in a wheel or a caster: in what spins for ever and goes nowhere by itself.

    Its last joint turns without end, about an axis on which the frame's origin lies and near which the body's mass is
    centred (a pendulum's is not); and the joints above move that origin along a curve at most, as a caster's swivel
    does. An arm, or a leg with a wheel, whose last joint is endless moves its origin in more directions.
    """
    last = _last(model, frame)
    return last is not None and last.type is JointType.CONTINUOUS and _goes_nowhere(model, frame, last)


def spins(model: Model, frame: str) -> bool:
    """Return whether a chain ends in a wheel, a caster or a rotor: as `rolls`, but many turns count as endless.

    Simulators' drones have rotors that are revolute joints with limits of 1e16 rad.
    """
    last = _last(model, frame)
    if last is None or last.type not in (JointType.CONTINUOUS, JointType.REVOLUTE):
        return False
    lower, upper = last.limit.range
    endless = last.type is JointType.CONTINUOUS or upper - lower > _TURNS
    return endless and _goes_nowhere(model, frame, last)


def _last(model: Model, frame: str) -> Joint | None:
    """Return the joint that carries a frame, if it moves by itself."""
    joint = next((j for j in model.robot.to_root(frame) if j.type is not JointType.FIXED), None)
    return None if joint is None or joint.mimic is not None else joint


def _goes_nowhere(model: Model, frame: str, last: Joint) -> bool:
    return _balanced(model, last) and _moved_along_a_curve(model, frame, last)


def _balanced(model: Model, joint: Joint) -> bool:
    """Return whether the mass of the link that a joint turns is centred near its axis; where there is none, it is."""
    inertial = model.robot.link_by_name[joint.child].inertial
    if inertial is None or inertial.mass <= 0:
        return True
    centre, axis = np.array(inertial.origin.xyz), np.array(joint.axis)
    offset = float(np.linalg.norm(centre - (centre @ axis) * axis))
    ixx, _, _, iyy, _, izz = inertial.inertia
    gyration = float(np.sqrt(max(ixx + iyy + izz, 0.0) / (2 * inertial.mass)))
    return offset <= max(_BALANCED * gyration, _ZERO * model.robot.reach)


def _moved_along_a_curve(model: Model, frame: str, last: Joint) -> bool:
    """Return whether a frame's origin is moved in one direction at most, and by the last joint not at all."""
    robot = model.robot
    q = random_configurations(robot, 0, _SAMPLES)
    moved = model.engine.jacobian(q, Velocity(frame, robot.root, robot.root, (0.0, 0.0, 0.0)))[..., :3, :]
    zero = _ZERO * max(robot.reach, 1e-3)
    if float(np.max(np.abs(moved[..., robot.velocity_columns([last])]))) > zero:
        return False
    columns = robot.velocity_columns(robot.movable_path(robot.root, frame))
    values = np.linalg.svd(moved[..., columns], compute_uv=False)
    return int(np.max(np.sum(values > zero, axis=-1))) < 2
