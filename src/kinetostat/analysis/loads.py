"""What a robot bears: wrenches on its links, a payload, gravity; and the efforts that its joints may give."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.configuration import LARGEST_LENGTH
from kinetostat.analysis.crosscheck import length_scale
from kinetostat.analysis.jacobian import checked_point
from kinetostat.analysis.joint_values import described
from kinetostat.conventions import GRAVITY, Array, Load, Velocity
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError, quote
from kinetostat.urdf.description import Joint, JointType, Robot

__all__ = [
    "SEVERAL_COORDINATES",
    "EffortLimits",
    "Payload",
    "carried",
    "checked_gravity",
    "effort_limits",
    "effort_units",
    "force_scale",
    "load_at",
    "load_scale",
    "point_masses",
]

SEVERAL_COORDINATES = "a joint with several coordinates has no effort limit"
_MOST_FORCE = 1e9  # N, Nm, kg


@dataclass(frozen=True)
class Payload:
    """A point mass in kg at a point of a link, in the link's coordinates, in m."""

    mass: float
    frame: str
    point: tuple[float, float, float] = (0.0, 0.0, 0.0)


def load_at(
    model: Model | Robot,
    frame: str,
    wrench: Sequence[float] | Array,
    *,
    axes: str = "world",
    point: Sequence[float] | str = (0.0, 0.0, 0.0),
) -> Load:
    """Return a wrench (f, m) at a link, checked: where it acts and how it is written.

    Args:
        model: whose: a model, or the description of a robot.
        frame: the link that exerts it (or that it is exerted on), a frame.
        wrench: force in N and moment about the point in Nm, force first, (6,) or (..., 6).
        axes: whose axes it is written in: "world" (the root link's), "local" (the frame's own), or a frame's name.
        point: the point that the moment is about: x, y, z in the frame's coordinates, in m, or "world": the root's
            origin, as for a wrench that comes out of `adjoint`.

    Raises:
        UnknownNameError: no such frame.
        UsageError: not six numbers within 1e9; no point.
    """
    robot = described(model)
    link = robot.frame(frame)
    expressed_in = robot.root if axes == "world" else link if axes == "local" else robot.frame(axes)
    if isinstance(point, str) and point != "world":
        raise UsageError(
            f"there is no point {quote(point)}", remedy="a point is x,y,z in m, or world: the root's origin"
        )
    at = None if isinstance(point, str) else checked_point(point)
    six = np.asarray(wrench, dtype=np.float64)
    if six.ndim == 0 or six.shape[-1] != 6 or not np.all(np.abs(six) <= _MOST_FORCE):
        raise UsageError("a wrench has six finite numbers fx fy fz mx my mz", remedy=f"each within {_MOST_FORCE:g}")
    return Load(Velocity(link, robot.root, expressed_in, at), six)


def checked_gravity(gravity: Sequence[float] | Array | bool | None) -> Array:
    """Return the acceleration of gravity (3,) in m/s2: 9.81 down the root's z axis for True, zero for None.

    Raises:
        UsageError: not three numbers within 1e9.
    """
    if gravity is None or isinstance(gravity, bool):
        return np.array(GRAVITY) if gravity else np.zeros(3)
    vector = np.asarray(gravity, dtype=np.float64)
    if vector.shape != (3,) or not np.all(np.abs(vector) <= _MOST_FORCE):
        raise UsageError("gravity has three finite numbers x, y, z in m/s2", remedy="for instance 0,0,-9.81")
    return vector


def carried(robot: Robot, payload: Payload | None, gravity: Array) -> list[Load]:
    """Return the force by which the robot holds a payload up against gravity, -m g; none for no payload.

    Raises:
        UnknownNameError: no such frame.
        UsageError: a mass that is negative or not finite; not a point.
    """
    if payload is None:
        return []
    if not 0 <= payload.mass <= _MOST_FORCE:
        raise UsageError(f"a payload is between 0 and {_MOST_FORCE:g} kg, not {payload.mass:g}")
    weight = np.concatenate([-payload.mass * gravity, np.zeros(3)])
    return [Load(Velocity(robot.frame(payload.frame), robot.root, robot.root, checked_point(payload.point)), weight)]


def point_masses(robot: Robot, payload: Payload | None) -> list[tuple[str, float, Array]]:
    """Return a payload as masses that weigh with the links: link, kg, where in the link (3,), m; none for no payload.

    Raises:
        UnknownNameError: no such frame.
        UsageError: not a point.
    """
    if payload is None:
        return []
    return [(robot.frame(payload.frame), payload.mass, np.array(checked_point(payload.point)))]


def load_scale(robot: Robot, q: Array, loads: Sequence[Load]) -> float:
    """Return the length that rounding of torques at q grows with: `length_scale`, the loads' points counted."""
    return max([length_scale(robot, q), *(length_scale(robot, q, load.at.point) for load in loads)])


def force_scale(model: Model, gravity: Array, loads: Sequence[Load]) -> float:
    """Return the sum of all forces on the robot in N (and of moments in Nm), which rounding of torques grows with."""
    weight = sum(map(abs, model.engine.masses())) * float(np.linalg.norm(gravity))
    return max(1.0, weight + sum(float(np.max(np.sum(np.abs(load.wrench), -1), initial=0.0)) for load in loads))


def effort_units(joint: Joint) -> tuple[str, ...]:
    """Return the units of what a joint gives along its velocity coordinates."""
    if joint.type is JointType.FLOATING:
        return ("N", "N", "N", "Nm", "Nm", "Nm")
    if joint.type is JointType.PLANAR:
        return ("N", "N", "Nm")
    return ("Nm",) if joint.type.is_angle else ("N",)


@dataclass(frozen=True)
class EffortLimits:
    """What the joints may give: lower and upper effort of each velocity coordinate, (nv,), N or Nm.

    NaN where the file states none (`missing` says why): a limit of zero is written for "not known" far more often than
    for a joint without a drive, so it counts as missing.
    """

    lower: Array
    upper: Array
    missing: Mapping[str, str]

    def of_joints(self, robot: Robot, joints: Collection[Joint]) -> EffortLimits:
        """Return the limits of some joints; all others may give whatever it takes."""
        free = np.ones(robot.nv, dtype=bool)
        free[robot.velocity_columns(joints)] = False
        own = {name for joint in joints for name in joint.velocity_names}
        lower, upper = np.where(free, -np.inf, self.lower), np.where(free, np.inf, self.upper)
        return EffortLimits(lower, upper, {name: why for name, why in self.missing.items() if name in own})

    def refuse(self, names: Sequence[str], question: str) -> None:
        """Refuse a question that needs the limits of some joints.

        Raises:
            UsageError: one of them has none; the joint is named.
        """
        lost = [name for name in names if name in self.missing]
        if lost:
            more = f" (and {len(lost) - 1} more)" if len(lost) > 1 else ""
            reason, remedy = self.missing[lost[0]], f"give it: --effort-limits {lost[0]}=50, or =-20:35"
            if reason == SEVERAL_COORDINATES:
                remedy = "nothing drives it: hold the base, or the joint"
            raise UsageError(
                f"{question} needs the effort limit of joint {quote(lost[0])}{more}: {reason}",
                remedy=remedy,
            )


def effort_limits(robot: Robot, given: Mapping[str, float | tuple[float, float]] | None = None) -> EffortLimits:
    """Return the effort limits of the independent joints: those given (a number is for both directions), or the file's.

    Raises:
        UnknownNameError: no such joint.
        ConfigurationError: it is fixed, or follows another.
        UsageError: a given limit is not of the form lower <= 0 <= upper, lower < upper; a joint with several
            coordinates.
    """
    lower, upper, missing = np.full(robot.nv, np.nan), np.full(robot.nv, np.nan), dict[str, str]()
    chosen = {robot.independent_joint(name).name: limit for name, limit in (given or {}).items()}
    for joint in robot.independent:
        where = robot.velocity_slices[joint.name]
        effort = joint.limit.effort
        if joint.name in chosen:
            limit = chosen[joint.name]
            low, high = (-limit, limit) if isinstance(limit, (int, float)) else limit
            if not (low <= 0 <= high and low < high < math.inf and low > -math.inf) or joint.type.nv != 1:
                message = f"{low:g} to {high:g} is no range of efforts for joint {quote(joint.name)}"
                raise UsageError(message, remedy="write joint=50 or joint=-20:35, for joints with one coordinate")
            lower[where], upper[where] = low, high
        elif joint.type.nv != 1:
            missing |= dict.fromkeys(joint.velocity_names, SEVERAL_COORDINATES)
        elif effort is None:
            missing[joint.name] = "the file states none"
        elif not 0 < effort < LARGEST_LENGTH:
            missing[joint.name] = f"the file says {effort:g}"
        else:
            lower[where], upper[where] = -effort, effort
    return EffortLimits(lower, upper, missing)
