"""Forward kinematics and frame changes, certified."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.configuration import checked
from kinetostat.analysis.crosscheck import Certificate, certified, length_scale
from kinetostat.conventions import Array, WrenchOrTwist
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError
from kinetostat.screw import so3

__all__ = ["FrameChange", "Placement", "adjoint", "fk"]


@dataclass(frozen=True)
class Placement:
    """Where `frame` is relative to `relative_to`: T_a_f, which maps coordinates in f to coordinates in a."""

    frame: str
    relative_to: str
    matrix: Array
    certificate: Certificate

    @property
    def position(self) -> Array:
        """Origin of the frame in the other's coordinates. (..., 3), m."""
        return self.matrix[..., :3, 3]

    @property
    def quaternion_xyzw(self) -> Array:
        """Rotation as a unit quaternion with w >= 0. (..., 4)."""
        return so3.to_quaternion(self.matrix[..., :3, :3])

    @property
    def rpy(self) -> Array:
        """Rotation as URDF's roll, pitch, yaw. (..., 3), rad."""
        return so3.to_rpy(self.matrix[..., :3, :3])


@dataclass(frozen=True)
class FrameChange:
    """The 6x6 that carries twists, or wrenches, from `start` to `end`, linear (force) rows and columns first."""

    start: str
    end: str
    kind: WrenchOrTwist
    matrix: Array
    certificate: Certificate

    def apply(self, six: Array) -> Array:
        """Carry one: (6,) in `start` to (..., 6) in `end`.

        Raises:
            UsageError: not six finite numbers.
        """
        six = np.asarray(six, dtype=np.float64)
        if six.shape != (6,) or not np.all(np.isfinite(six)):
            raise UsageError(
                f"a {self.kind} has six finite numbers, not {six.size}",
                remedy=f"in the order {' '.join(self.kind.rows)}",
            )
        carried: Array = self.matrix @ six
        return carried


def fk(model: Model, frame: str, q: Array, *, relative_to: str | None = None) -> Placement:
    """Return where a frame is: T_a_f = T_a^-1 T_f.

    Args:
        model: the robot.
        frame: F, a link.
        q: configurations (..., nq).
        relative_to: A, a link; default the root link.

    Returns:
        The placement, with matrix (..., 4, 4), in m.

    Raises:
        UnknownNameError: there is no such frame.
        ConfigurationError: q has another shape, or a number that is not finite.
    """
    robot = model.robot
    frame, observer, q = robot.frame(frame), robot.frame(relative_to or robot.root), checked(robot, q)
    matrix, certificate = certified(model, lambda engine: engine.placement(q, frame, observer), length_scale(robot, q))
    return Placement(frame, observer, matrix, certificate)


def adjoint(
    model: Model,
    start: str,
    end: str,
    q: Array,
    *,
    kind: WrenchOrTwist | str = WrenchOrTwist.TWIST,
    inverse: bool = False,
) -> FrameChange:
    """Return the frame change from `start` to `end`: V_end = Ad(T) V_start, F_end = Ad(T)^-T F_start, T = T_end_start.

    A twist is the velocity of the body's point at the frame's origin and its angular velocity, in the frame's axes; a
    wrench is the force and the moment about the origin, in the frame's axes. The frames are taken as rigidly joined at
    q. Equations: Lynch and Park, "Modern Robotics", 2017, sections 3.3.2 and 3.4.

    Args:
        model: the robot.
        start: the frame in which the six-vector is given, a link.
        end: the frame in which it is wanted, a link.
        q: configurations (..., nq).
        kind: twist or wrench.
        inverse: return the change from `end` to `start` instead.

    Returns:
        The frame change, with matrix (..., 6, 6), linear rows and columns first.

    Raises:
        UnknownNameError: there is no such frame.
        ConfigurationError: q has another shape, or a number that is not finite.
    """
    robot, kind = model.robot, WrenchOrTwist(kind)
    a, b = robot.frame(start), robot.frame(end)
    a, b = (b, a) if inverse else (a, b)
    q = checked(robot, q)
    matrix, certificate = certified(model, lambda engine: engine.frame_change(q, a, b, kind), length_scale(robot, q))
    return FrameChange(a, b, kind, matrix, certificate)
