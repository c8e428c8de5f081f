"""Frame Jacobians, geometric and analytic, and their time derivatives, certified."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinetostat.analysis.configuration import LARGEST_LENGTH, checked, checked_rates
from kinetostat.analysis.crosscheck import Certificate, certified, length_scale
from kinetostat.analysis.euler import EulerSequence
from kinetostat.conventions import TWIST_ROWS, TWIST_UNITS, Array, Reference, Velocity
from kinetostat.engines.model import Model
from kinetostat.engines.protocol import Engine
from kinetostat.errors import RepresentationError, UsageError, quote
from kinetostat.urdf.description import Joint, JointType, Robot

__all__ = ["Jacobian", "checked_point", "jacobian", "labelled", "velocity_units"]

_NO_RATES = 1e-9  # abs(det E) below which Euler angles have no rates
_FAST_RATES = 1e-3  # below which they are said to be near their singularity


@dataclass(frozen=True)
class Jacobian:
    """J with V = J qdot for the labelled velocity V.

    Attributes:
        velocity: of which frame and point, relative to which observer, expressed in which axes.
        reference: the shorthand that it was asked by.
        rows: names of the six rows, linear first: a twist, or velocity and Euler angle rates.
        row_units: their units.
        columns: names of the columns, one per velocity coordinate of the chosen joints.
        column_units: units of the joint rates.
        matrix: J, (..., 6, n).
        time_derivative: dJ/dt along the given joint rates, (..., 6, n), or None.
        rates: the Euler sequence of the analytic Jacobian, or None.
        angles: its angles at q, (..., 3) in rad, the second in [0, pi] (zyz) or [-pi/2, pi/2] (zyx); or None.
        certificate: what the two engines say of it.
        warnings: what is to be said of it.
    """

    velocity: Velocity
    reference: Reference
    rows: tuple[str, ...]
    row_units: tuple[str, ...]
    columns: tuple[str, ...]
    column_units: tuple[str, ...]
    matrix: Array
    time_derivative: Array | None
    rates: EulerSequence | None
    angles: Array | None
    certificate: Certificate
    warnings: tuple[str, ...] = ()


def jacobian(
    model: Model,
    frame: str,
    q: Array,
    *,
    reference: Reference | str = Reference.ALIGNED,
    relative_to: str | None = None,
    expressed_in: str | None = None,
    point: Sequence[float] | None = None,
    joints: Literal["path", "all"] | Sequence[str] = "path",
    rates: EulerSequence | str | None = None,
    qdot: Array | None = None,
) -> Jacobian:
    """Return the Jacobian of a frame: V = J(q) qdot.

    V is the velocity of `point` of the frame, relative to the observer, expressed in some axes, linear rows first. The
    column of a joint with space screw S is X Ad(T_a^-1) S, X the shift to the point and the turn to the axes. With
    `rates`, the angular rows are the rates of Euler angles t of R_a_f: w = E(t) dt/dt, so J_analytic = diag(1, E^-1) J.
    Lynch and Park, "Modern Robotics", 2017, chapter 5; B. Siciliano et al., "Robotics", 2009, section 3.6.

    Args:
        model: the robot.
        frame: F, a link.
        q: configurations (..., nq) of the independent joints in file order.
        reference: aligned, local or world; see `conventions.Reference`.
        relative_to: A, the observer's link; default the root link.
        expressed_in: E, the link in whose axes V is expressed; default as `reference` says.
        point: the point in F's coordinates, in m; default F's origin.
        joints: "path" (those between A and F, in path order), "all" (in file order), or names.
        rates: an Euler sequence (`rpy`, `zyz`, `fixed-xyz`, ...) for an analytic Jacobian.
        qdot: joint rates (..., nv); then the time derivative of the matrix is given too.

    Raises:
        UnknownNameError: no such frame, joint or sequence.
        UsageError: a fixed or follower joint is chosen; a point with reference world; other axes with `rates`.
        RepresentationError: the Euler angles have no rates at q.
        ConfigurationError: q or qdot has another shape, or a number that is not finite.
    """
    robot = model.robot
    q, qdot = checked(robot, q), None if qdot is None else checked_rates(robot, qdot, np.shape(q)[:-1])
    reference = Reference(reference)
    velocity = labelled(robot, frame, reference, relative_to, expressed_in, point)
    observer = velocity.relative_to
    sequence = EulerSequence.named(rates) if isinstance(rates, str) else rates
    if sequence is not None and (reference is not Reference.ALIGNED or velocity.expressed_in != observer):
        raise UsageError(
            "Euler rates are those of the frame in the observer's axes",
            remedy="leave out --reference and --expressed-in",
        )
    chosen = _columns(robot, velocity, joints)
    columns = robot.velocity_columns(chosen)

    def both(engine: Engine) -> Array:
        geometric = engine.jacobian(q, velocity)
        rate = None if qdot is None else engine.jacobian_rate(q, qdot, velocity)
        if sequence is not None:
            rotation = engine.placement(q, velocity.of, observer)[..., :3, :3]
            geometric, rate = _analytic(sequence, rotation, geometric, rate, qdot)
        return geometric if rate is None else np.stack(np.broadcast_arrays(geometric, rate), -3)

    scale, speed, angles, warnings = length_scale(robot, q, velocity.point), 1.0, None, list[str]()
    if qdot is not None:
        rates_sum = float(np.max(np.sum(np.abs(qdot), -1), initial=0.0))
        speed = max(1.0, rates_sum * robot.largest_multiplier)
    if sequence is not None:
        rotation = model.engine.placement(q, velocity.of, observer)[..., :3, :3]
        angles, steepness = sequence.angles(rotation), _steepness(rotation, velocity.of, sequence)
        speed *= steepness ** (1 if qdot is None else 3)
        if steepness * _FAST_RATES > 1:
            warnings.append(
                f"{sequence.reading} is near its own singularity: its rates are {steepness:.3g} times as fast"
            )
    value, certificate = certified(model, lambda engine: both(engine)[..., columns], scale, speed)
    matrix, derivative = (value, None) if qdot is None else (value[..., 0, :, :], value[..., 1, :, :])
    rows: tuple[str, ...] = TWIST_ROWS
    if sequence is not None:
        rows = (*TWIST_ROWS[:3], *(f"{angle}_rate" for angle in sequence.angle_names))
    return Jacobian(
        velocity,
        reference,
        rows,
        TWIST_UNITS,
        tuple(name for joint in chosen for name in joint.velocity_names),
        tuple(unit for joint in chosen for unit in velocity_units(joint)),
        matrix,
        derivative,
        sequence,
        angles,
        certificate,
        tuple(warnings),
    )


def labelled(
    robot: Robot,
    frame: str,
    reference: Reference,
    relative_to: str | None,
    expressed_in: str | None,
    point: Sequence[float] | None,
) -> Velocity:
    """Return the label of the velocity that is asked for, as `jacobian` describes the parts, each checked.

    Raises:
        UnknownNameError: no such frame.
        UsageError: not a point; a point with reference world.
    """
    at = None if point is None else checked_point(point)
    observer = robot.frame(relative_to or robot.root)
    axes = None if expressed_in is None else robot.frame(expressed_in)
    return Velocity.by_reference(reference, robot.frame(frame), observer, point=at, expressed_in=axes)


def checked_point(point: Sequence[float]) -> tuple[float, float, float]:
    """Return a point as three numbers that an engine can take.

    Raises:
        UsageError: not three numbers within 1e12 m.
    """
    numbers = tuple(float(c) for c in point)
    if len(numbers) != 3 or not np.all(np.abs(numbers) <= LARGEST_LENGTH):
        raise UsageError(
            "a point has three finite coordinates x, y, z in m", remedy=f"each within {LARGEST_LENGTH:g} m"
        )
    x, y, z = numbers
    return x, y, z


def velocity_units(joint: Joint) -> tuple[str, ...]:
    """Return the units of a joint's velocity coordinates."""
    if joint.type is JointType.FLOATING:
        return TWIST_UNITS
    if joint.type is JointType.PLANAR:
        return ("m/s", "m/s", "rad/s")
    return ("rad/s",) if joint.type.is_angle else ("m/s",)


def _columns(robot: Robot, velocity: Velocity, joints: str | Sequence[str]) -> list[Joint]:
    """Return the joints whose columns are wanted, in the order in which they are wanted."""
    if joints == "all":
        return list(robot.independent)
    if joints == "path":
        return robot.movable_path(velocity.relative_to, velocity.of)
    names = [joints] if isinstance(joints, str) else list(joints)
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise UsageError(f"joint {quote(twice)} is named twice")
    return [robot.independent_joint(name) for name in names]


def _analytic(
    sequence: EulerSequence, rotation: Array, geometric: Array, rate: Array | None, qdot: Array | None
) -> tuple[Array, Array | None]:
    """Return diag(1, E^-1) J, and its rate: E^-1 (dJ - dE E^-1 J) in the angular rows."""
    to_rates = np.linalg.inv(sequence.rate_map(rotation))
    angular = to_rates @ geometric[..., 3:, :]
    analytic = np.concatenate([geometric[..., :3, :], angular], -2)
    if rate is None or qdot is None:
        return analytic, None
    map_rate = sequence.rate_map_rate(rotation, (angular @ np.asarray(qdot)[..., None])[..., 0])
    angular_rate = to_rates @ (rate[..., 3:, :] - map_rate @ angular)
    return analytic, np.concatenate([rate[..., :3, :], angular_rate], -2)


def _steepness(rotation: Array, frame: str, sequence: EulerSequence) -> float:
    """Return 1/abs(det E), by which the rates outgrow the angular velocity.

    Raises:
        RepresentationError: E is singular.
    """
    determinant = float(np.min(sequence.singularity(rotation), initial=1.0))
    if determinant < _NO_RATES:
        where, others = ("0 or pi", "rpy or zyx") if sequence.proper else ("+pi/2 or -pi/2", "zyz")
        raise RepresentationError(
            f"{sequence.reading} angles of frame {quote(frame)} have no rates here: the second angle is "
            f"{where}, a singularity of the angles and not of the robot",
            remedy=f"choose other angles ({others}), or the geometric Jacobian",
        )
    return 1 / determinant
