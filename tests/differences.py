"""Central differences, the witness of Jacobians and their rates: only placements are asked of an engine.

A configuration is moved along given joint rates: single coordinates by q + qdot t, planar and floating joints along
their body twist. Only the tangent of that curve at t = 0 counts. The rotations here are written out anew, so that
nothing of `kinetostat.screw` bears witness for itself.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kinetostat.conventions import Velocity
from kinetostat.engines.protocol import Engine
from kinetostat.urdf.description import JointType, Robot

__all__ = ["derivative", "jacobian", "jacobian_rate", "moved", "rates_of_angles", "twist"]

# Six points: the error of the formula is h^6/140 times the seventh derivative, that of rounding about 2e-16/h.
STEP = 2e-3
_TIMES = np.array([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])
_WEIGHTS = np.array([-1.0, 9.0, -45.0, 45.0, -9.0, 1.0]) / 60


def derivative(curve: Callable[[np.ndarray], np.ndarray], step: float = STEP) -> np.ndarray:
    """Return the derivative at 0 of a curve, which maps times (k,) to values (k, ...)."""
    return np.tensordot(_WEIGHTS, curve(_TIMES * step), axes=1) / step


def moved(robot: Robot, q: np.ndarray, qdot: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Return the configurations (k, nq) that q comes to at the given times (k,)."""
    path = np.repeat(np.array(q, dtype=float)[None], len(times), axis=0)
    for joint in robot.independent:
        where, rate = robot.position_slices[joint.name], qdot[robot.velocity_slices[joint.name]]
        part = path[:, where]
        if joint.type is JointType.FLOATING:
            part[:, :3] += np.outer(times, _matrix(part[0, 3:]) @ rate[:3])
            part[:, 3:] = [_product(part[0, 3:], _turn(rate[3:] * t)) for t in times]
        elif joint.type is JointType.PLANAR:
            cosine, sine = np.cos(part[0, 2]), np.sin(part[0, 2])
            part += np.outer(times, [cosine * rate[0] - sine * rate[1], sine * rate[0] + cosine * rate[1], rate[2]])
        else:
            part += np.outer(times, rate)
    return path


def twist(engine: Engine, robot: Robot, q: np.ndarray, qdot: np.ndarray, velocity: Velocity) -> np.ndarray:
    """Return the labelled velocity (6,) at q along qdot, from placements alone."""
    placement = engine.placement(q, velocity.of, velocity.relative_to)
    rotation, origin = placement[:3, :3], placement[:3, 3]
    # The point in F's coordinates: given, or the one that now lies at the observer's origin.
    point = -rotation.T @ origin if velocity.point is None else np.array(velocity.point)
    rate = derivative(lambda t: engine.placement(moved(robot, q, qdot, t), velocity.of, velocity.relative_to))
    spin = rate[:3, :3] @ rotation.T
    linear, angular = rate[:3, :3] @ point + rate[:3, 3], np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
    axes = engine.placement(q, velocity.expressed_in, velocity.relative_to)[:3, :3].T
    return np.concatenate([axes @ linear, axes @ angular])


def jacobian(engine: Engine, robot: Robot, q: np.ndarray, velocity: Velocity) -> np.ndarray:
    """Return the Jacobian (6, nv) of the labelled velocity, a column for each unit rate."""
    columns = [twist(engine, robot, q, unit, velocity) for unit in np.eye(robot.nv)]
    return np.stack(columns, -1) if columns else np.zeros((6, 0))


def jacobian_rate(engine: Engine, robot: Robot, q: np.ndarray, qdot: np.ndarray, velocity: Velocity) -> np.ndarray:
    """Return the rate (6, nv) of the engine's own Jacobian along qdot."""
    return derivative(lambda t: engine.jacobian(moved(robot, q, qdot, t), velocity))


def rates_of_angles(
    engine: Engine, robot: Robot, q: np.ndarray, velocity: Velocity, angles: Callable[[np.ndarray], np.ndarray]
) -> np.ndarray:
    """Return the rates (3, nv) of angles of R_a_f, a column for each unit joint rate. Whole turns are undone."""

    def rates(unit: np.ndarray) -> np.ndarray:
        def curve(times: np.ndarray) -> np.ndarray:
            rotations = engine.placement(moved(robot, q, unit, times), velocity.of, velocity.relative_to)[:, :3, :3]
            return np.unwrap(angles(rotations), axis=0)

        return derivative(curve)

    return np.stack([rates(unit) for unit in np.eye(robot.nv)], -1)


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the product of quaternions xyzw."""
    vector = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    return np.append(vector, a[3] * b[3] - a[:3] @ b[:3])


def _turn(w: np.ndarray) -> np.ndarray:
    """Return the quaternion xyzw of the rotation by |w| about w."""
    angle = np.linalg.norm(w)
    return np.append(w / (angle or 1.0) * np.sin(angle / 2), np.cos(angle / 2))


def _matrix(q: np.ndarray) -> np.ndarray:
    """Return the rotation matrix of a unit quaternion xyzw, column by column."""
    conjugate = np.append(-q[:3], q[3])
    return np.stack([_product(_product(q, np.append(e, 0.0)), conjugate)[:3] for e in np.eye(3)], -1)
