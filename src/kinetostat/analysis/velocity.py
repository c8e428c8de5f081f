"""Velocities and accelerations of frames from joint rates, and the screw that each moves along at an instant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kinetostat.analysis.configuration import LARGEST_LENGTH, checked, checked_rates
from kinetostat.analysis.crosscheck import Certificate, certified, length_scale
from kinetostat.analysis.jacobian import velocity_units
from kinetostat.conventions import Array, WrenchOrTwist, tolerance
from kinetostat.engines.model import Model
from kinetostat.engines.protocol import Engine
from kinetostat.errors import UsageError
from kinetostat.screw.adjoint import bracket
from kinetostat.urdf.description import Robot

__all__ = ["FrameMotions", "InstantaneousScrew", "velocity"]


@dataclass(frozen=True)
class InstantaneousScrew:
    """The screw that a frame moves along at an instant: it turns about a line and slides along it.

    With the twist (v, w) of a point o: axis w/|w|, through o + w x v/|w|^2, pitch w.v/|w|^2 (R. Ball, "A Treatise on
    the Theory of Screws", 1900; Lynch and Park, "Modern Robotics", 2017, section 3.3.2). Derived from certified twists
    and placements; what is within `zero` is taken for rounding, and so is an axis beyond 1e12 m.

    Attributes:
        axis: unit vector along w; along v for a translation; NaN at rest. (..., 3).
        point: the point of the axis that is nearest to the frame's origin, in m; where the pitch is 0 the centre of
            rotation. NaN for a translation and at rest. (..., 3).
        pitch: in m/rad; 0 for a rotation, infinite for a translation, NaN at rest. (...).
        rate: of turning about the axis, |w| in rad/s; 0 for a translation. (...).
        speed: of sliding along the axis, in m/s; for a translation |v|. (...).
        zero: largest |v| in m/s and largest |w| in rad/s that count as none: the certificate's 1e-12, at these rates.
            (2,), or (..., 2) where there are many.
    """

    axis: Array
    point: Array
    pitch: Array
    rate: Array
    speed: Array
    zero: Array

    @property
    def motion(self) -> Any:
        """What motion it is, in a word: rest, translation, rotation (pitch 0) or screw. (...), of words."""
        kinds = [np.isnan(self.pitch), np.isinf(self.pitch), self.pitch == 0]
        return np.select(kinds, ["rest", "translation", "rotation"], "screw")


@dataclass(frozen=True)
class FrameMotions:
    """Twists, and accelerations if they were asked for, of the origins of k frames, as an observer sees them.

    A body twist and a spatial acceleration are in the frame's own axes, the others in the axes of `expressed_in`.
    Spatial and classical accelerations have the same angular part; their linear parts differ by w x v, because the
    axes that the body twist's components are counted in turn with the frame.

    Attributes:
        frames: names of the k frames.
        relative_to: the observer's frame A.
        expressed_in: the frame E in whose axes, and for positions in whose coordinates, the others are.
        columns: names of the velocity coordinates.
        column_units: units of their rates.
        qdot: the joint rates, (..., nv).
        qddot: the joint accelerations, (..., nv), or None.
        origin: where the frames' origins are, in E's coordinates. (..., k, 3), m.
        body_twist: V of each origin in its own axes. (..., k, 6), m/s and rad/s.
        twist: the same in the axes of E. (..., k, 6), m/s and rad/s.
        spatial_acceleration: rate of the body twist's components, in its own axes. (..., k, 6), m/s2 and rad/s2.
        classical_acceleration: second derivative of the origin's position as the observer sees it, and the angular
            acceleration, in the axes of E. (..., k, 6), m/s2 and rad/s2.
        screw: the instantaneous screw of each frame, in E's coordinates; leading shape (..., k).
        certificate: what the two engines say of origins, twists and accelerations.
    """

    frames: tuple[str, ...]
    relative_to: str
    expressed_in: str
    columns: tuple[str, ...]
    column_units: tuple[str, ...]
    qdot: Array
    qddot: Array | None
    origin: Array
    body_twist: Array
    twist: Array
    spatial_acceleration: Array | None
    classical_acceleration: Array | None
    screw: InstantaneousScrew
    certificate: Certificate


def velocity(
    model: Model,
    q: Array,
    qdot: Array,
    *,
    frames: str | Sequence[str] | None = None,
    relative_to: str | None = None,
    expressed_in: str | None = None,
    qddot: Array | None = None,
) -> FrameMotions:
    """Return twists of frames from joint rates, their instantaneous screws and, with `qddot`, their accelerations.

    The engines give V_f and its rate A_f relative to the root, in f's axes. With X = Ad(T_f_a), an observer who sits in
    a sees V = V_f - X V_a and its rate A = A_f - X A_a + [V, X V_a]; with V = (v, w) and A = (a, dw/dt), the origin's
    acceleration is R (a + w x v), and the angular one R dw/dt. R. Featherstone, "Rigid Body Dynamics Algorithms", 2008,
    sections 2.9 to 2.11; J. Craig, "Introduction to Robotics", chapter 5 (outward propagation).

    Args:
        model: the robot.
        q: configurations (..., nq) of the independent joints in file order.
        qdot: joint rates (..., nv), in rad/s and m/s.
        frames: names of links, or one name; default all links in file order.
        relative_to: A, the observer's link; default the root link.
        expressed_in: E, the link in whose axes twists and classical accelerations are, and in whose coordinates
            origins and screws are; default the observer's.
        qddot: joint accelerations (..., nv), in rad/s2 and m/s2; then accelerations are given too.

    Returns:
        The motions, arrays (..., k, 6) with linear rows first, the k frames in the order in which they are named.

    Raises:
        UnknownNameError: there is no such frame.
        UsageError: no frame is named.
        ConfigurationError: q, qdot or qddot has another shape, or a number that is not finite.
    """
    robot, q = model.robot, checked(model.robot, q)
    names = _named(robot, frames)
    observer = robot.frame(relative_to or robot.root)
    axes = robot.frame(expressed_in or observer)
    qdot = checked_rates(robot, qdot, q.shape[:-1])
    shape = np.broadcast_shapes(q.shape[:-1], qdot.shape[:-1])
    qddot = None if qddot is None else checked_rates(robot, qddot, shape, "acceleration")

    def both(engine: Engine) -> Array:
        return _numbers(engine, q, qdot, qddot, names, observer, axes)

    value, certificate = certified(model, both, length_scale(robot, q), _speed(robot, qdot, qddot))
    parts = [value[..., 6 * i : 6 * i + 6] for i in range(value.shape[-1] // 6)]
    origin, body_twist, twist = value[..., -3:], parts[0], parts[1]
    units = tuple(unit for joint in robot.independent for unit in velocity_units(joint))
    return FrameMotions(
        names,
        observer,
        axes,
        robot.velocity_names,
        units,
        np.array(qdot),
        None if qddot is None else np.array(qddot),
        origin,
        body_twist,
        twist,
        None if qddot is None else parts[2],
        None if qddot is None else parts[3],
        _screw(origin, twist, _zero(robot, q, qdot, units)),
        certificate,
    )


def _named(robot: Robot, frames: str | Sequence[str] | None) -> tuple[str, ...]:
    if frames is None:
        return tuple(robot.link_by_name)
    names = tuple(robot.frame(name) for name in ([frames] if isinstance(frames, str) else frames))
    if not names:
        raise UsageError("no frame is named", remedy="name one at least, or leave out frames for all links")
    return names


def _numbers(
    engine: Engine, q: Array, qdot: Array, qddot: Array | None, frames: Sequence[str], observer: str, axes: str
) -> Array:
    """Return body twists, twists, with `qddot` both accelerations, and origins. (..., k, 15 or 27)."""
    pushed = np.zeros_like(qdot) if qddot is None else qddot
    motions = engine.link_motions(q, qdot, pushed, [*frames, observer])
    change = np.stack([engine.frame_change(q, observer, frame, WrenchOrTwist.TWIST) for frame in frames], -3)
    place = np.stack([engine.placement(q, frame, observer) for frame in frames], -3)
    if axes != observer:
        place = engine.placement(q, observer, axes)[..., None, :, :] @ place
    carrier, carrier_rate = (_times(change, motions[..., -1:, i, :]) for i in range(2))
    twist = motions[..., :-1, 0, :] - carrier
    found = [twist, _turned(place, twist)]
    if qddot is not None:
        rate = motions[..., :-1, 1, :] - carrier_rate + bracket(twist, carrier)
        turning = np.cross(twist[..., 3:], twist[..., :3])
        found += [rate, _turned(place, rate + np.concatenate([turning, np.zeros_like(turning)], -1))]
    shape = twist.shape[:-1]
    return np.concatenate([*found, np.broadcast_to(place[..., :3, 3], (*shape, 3))], -1)


def _times(matrix: Array, vector: Array) -> Array:
    """Return M v. (..., r, c), (..., c) -> (..., r)."""
    product: Array = (matrix @ vector[..., None])[..., 0]
    return product


def _turned(place: Array, six: Array) -> Array:
    """Return a six-vector in the axes that a placement maps to. (..., 4, 4), (..., 6) -> (..., 6)."""
    rotation = place[..., :3, :3]
    return np.concatenate([_times(rotation, six[..., :3]), _times(rotation, six[..., 3:])], -1)


def _speed(robot: Robot, qdot: Array, qddot: Array | None) -> float:
    """Return the size that rounding grows with beside lengths: of the rates; of their squares in accelerations."""
    rates = float(np.max(np.sum(np.abs(qdot), -1), initial=0.0))
    if qddot is None:
        return rates
    pushed = float(np.max(np.sum(np.abs(qddot), -1), initial=0.0))
    return max(rates, robot.largest_multiplier * rates**2 + pushed)


def _zero(robot: Robot, q: Array, qdot: Array, units: Sequence[str]) -> Array:
    """Return the largest |v| and |w| that may be rounding: the certificate's 1e-12, at these rates. (..., 2)."""
    turns = np.array([unit == "rad/s" for unit in units], dtype=bool)
    turning, sliding = (np.sum(np.abs(qdot[..., part]), -1) for part in (turns, ~turns))
    without_lengths = length_scale(robot, q, unit=np.inf)  # angles lose digits, but none to lengths
    rounding = [tolerance(length_scale(robot, q)) * (turning + sliding), tolerance(without_lengths) * turning]
    return np.stack(rounding, -1)


def _screw(origin: Array, twist: Array, zero: Array) -> InstantaneousScrew:
    """Return the screws of twists (..., k, 6) of points (..., k, 3); `zero` is (..., 2)."""
    v, w = twist[..., :3], twist[..., 3:]
    fast, spin = np.linalg.norm(v, axis=-1), np.linalg.norm(w, axis=-1)
    no_speed, no_rate = zero[..., None, 0], zero[..., None, 1]
    turns = spin > np.maximum(no_rate, fast / LARGEST_LENGTH)
    slides = ~turns & (fast > no_speed)
    rate = np.where(turns, spin, 1.0)
    size = np.where(turns, rate, np.where(slides, fast, 1.0))[..., None]
    axis = np.where(turns[..., None], w, np.where(slides[..., None], v, np.nan)) / size
    along = np.sum(axis * v, -1)
    speed = np.where(turns & (np.abs(along) <= no_speed + no_rate * fast / rate), 0.0, along)
    point = origin + np.cross(axis, v) / rate[..., None]
    return InstantaneousScrew(
        axis,
        np.where(turns[..., None], point, np.nan),
        np.where(turns, speed / rate, np.where(slides, np.inf, np.nan)),
        np.where(turns, spin, 0.0),
        np.where(turns | slides, speed, 0.0),
        zero,
    )
