"""Configurations: from the words that people use to the positions (nq,) of the independent joints, checked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from kinetostat.analysis.joint_values import Value, described, filled, parsed, scale_angles
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.errors import ConfigurationError, UnknownNameError, quote
from kinetostat.screw import se3, so3
from kinetostat.urdf.description import NO_LIMIT, Joint, JointType, Robot
from kinetostat.urdf.srdf import Semantics

__all__ = ["Configuration", "configuration", "random_configurations"]

LARGEST_ANGLE = 1e6  # rad: beyond it an angle has lost its last digits, and a certificate its meaning
LARGEST_LENGTH = 1e12  # m
_SHORTEST_QUATERNION = 1e-9
_QUATERNION_SLACK = 1e-3  # how far from 1 the length of one that is typed may be
_LIMIT_SLACK = 1e-9  # a limit typed with ten digits is not exceeded by its own rounding


@dataclass(frozen=True)
class Configuration:
    """Positions of the independent joints in file order, in m and rad, and what is to be said of them."""

    robot: Robot
    q: Array
    warnings: tuple[str, ...] = ()

    def positions(self, *, degrees: bool) -> Array:
        """Return the positions (nq,) as they are shown: angles of joints in rad or in degrees."""
        shown = self.q.copy()
        if degrees:
            scale_angles(self.robot, shown, self.robot.position_slices, 180 / math.pi)
        return shown

    def by_joint(self) -> dict[str, float | list[float]]:
        """Return {joint: position}; a list of positions for planar and floating joints."""
        found: dict[str, float | list[float]] = {}
        for joint in self.robot.independent:
            part = [float(x) for x in self.q[self.robot.position_slices[joint.name]]]
            found[joint.name] = part[0] if joint.type.nq == 1 else part
        return found


def configuration(
    model: Model | Robot,
    wanted: str | Mapping[str, Value] | Sequence[float] | Array = "zero",
    *,
    semantics: Semantics | None = None,
    degrees: bool = False,
    quaternion_first: str = "x",
) -> Configuration:
    """Return a configuration.

    Args:
        model: whose: a model, which knows its SRDF states, or the description of a robot.
        wanted: `zero`, `mid` (middle of limits), `random:SEED` (inside limits), the name of an SRDF group state,
            `j1=0.3,j2=-1.2` (others zero), an ordered list in file order, or the mapping or sequence that these mean.
        semantics: another SRDF for group states than the model's own.
        degrees: numbers given for angles of joints are in degrees (those of an SRDF never are).
        quaternion_first: "x" if quaternions are given as xyzw, "w" if as wxyz.

    Raises:
        ConfigurationError: wrong length, not finite, a value for a fixed or a follower joint.
        UnknownNameError: no such joint or state.
    """
    robot, warnings = described(model), list[str]()
    if semantics is None:
        semantics = model.semantics if isinstance(model, Model) else Semantics()
    if not isinstance(wanted, str):
        q = _from_values(robot, wanted, degrees, quaternion_first)
    elif wanted == "zero":
        q = neutral(robot)
    elif wanted == "mid":
        q = _middle(robot)
    elif wanted.partition(":")[0] == "random":
        q = random_configurations(robot, _seed(wanted), ())
    else:
        values = parsed(wanted)
        if values is None:
            q = _from_state(robot, semantics, wanted, warnings)
        else:
            q = _from_values(robot, values, degrees, quaternion_first)
    return Configuration(robot, q, (*warnings, *_outside_limits(robot, q, degrees)))


def checked(robot: Robot, q: Array) -> Array:
    """Return configurations (..., nq) as an array of numbers that an engine can take.

    Raises:
        ConfigurationError: another count of positions, one that is not finite or beyond 1e6 rad or 1e12 m, a
            quaternion of length zero.
    """
    q = _numbers(q, robot.nq, "position")
    for joint in robot.independent:
        largest = LARGEST_ANGLE if joint.type.is_angle else LARGEST_LENGTH
        if np.any(np.abs(q[..., robot.position_slices[joint.name]]) > largest):
            unit = "rad" if joint.type.is_angle else "m"
            raise ConfigurationError(f"joint {quote(joint.name)} is beyond {largest:g} {unit}", remedy="check the unit")
        if joint.type is JointType.FLOATING:
            rotation = q[..., robot.position_slices[joint.name]][..., 3:]
            if np.any(np.linalg.norm(rotation, axis=-1) < _SHORTEST_QUATERNION):
                raise ConfigurationError(f"a quaternion of joint {quote(joint.name)} is zero")
    return q


def checked_rates(robot: Robot, qdot: Array, shape: tuple[int, ...], quantity: str = "rate") -> Array:
    """Return joint rates (..., nv), or accelerations (`quantity`), as an array of numbers that an engine can take.

    Raises:
        ConfigurationError: another count of rates, one that is not finite or beyond 1e12, or a leading shape that does
            not go with that of the configurations.
    """
    rates = _numbers(qdot, robot.nv, quantity)
    if np.any(np.abs(rates) > LARGEST_LENGTH):
        raise ConfigurationError(f"a joint's {quantity} is beyond {LARGEST_LENGTH:g}", remedy="check the unit")
    try:
        np.broadcast_shapes(rates.shape[:-1], shape)
    except ValueError:
        message = f"{quantity}s of shape {rates.shape} do not go with configurations of leading shape {shape}"
        raise ConfigurationError(message) from None
    return rates


def _numbers(values: Array, count: int, what: str) -> Array:
    try:
        numbers = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise ConfigurationError(f"{what}s are numbers in an array (..., {count})") from None
    if numbers.ndim == 0 or numbers.shape[-1] != count:
        raise ConfigurationError(f"{what}s have the shape (..., {count}) here, not {numbers.shape}")
    if not np.all(np.isfinite(numbers)):
        raise ConfigurationError(f"a {what} is not a finite number")
    return numbers


def displaced(robot: Robot, q: Array, steps: Array) -> Array:
    """Return the configurations that finite joint motions lead to: q + d, joint by joint.

    A floating or planar joint moves along its constant twist, T exp(d). (..., nq), (..., nv) -> (..., nq).
    """
    leading = np.broadcast_shapes(q.shape[:-1], steps.shape[:-1])
    end = np.broadcast_to(q, (*leading, q.shape[-1])).copy()
    for joint in robot.independent:
        part, step = end[..., robot.position_slices[joint.name]], steps[..., robot.velocity_slices[joint.name]]
        if joint.type is JointType.FLOATING:
            placed = se3.placement(so3.from_quaternion(part[..., 3:]), part[..., :3]) @ se3.exp(step)
            part[..., :3], part[..., 3:] = placed[..., :3, 3], so3.to_quaternion(placed[..., :3, :3])
        elif joint.type is JointType.PLANAR:
            twist = np.zeros((*leading, 6))
            twist[..., [0, 1, 5]] = step
            shift = so3.about(2, part[..., 2]) @ se3.exp(twist)[..., :3, 3, None]
            part += np.concatenate([shift[..., :2, 0], step[..., 2:]], -1)
        else:
            part += step
    return end


def neutral(robot: Robot) -> Array:
    """Return the zero configuration: every position 0, floating joints with the identity rotation. (nq,)."""
    q = np.zeros(robot.nq)
    for joint in robot.independent:
        if joint.type is JointType.FLOATING:
            q[robot.position_slices[joint.name].stop - 1] = 1.0
    return q


def random_configurations(model: Model | Robot, seed: int, shape: int | tuple[int, ...] = ()) -> Array:
    """Return configurations drawn uniformly inside limits, those of followers too. (*shape, nq).

    Angles without limits are drawn from a whole turn, lengths without limits within 1 m of zero or of their one limit,
    rotations of floating joints uniformly (K. Shoemake, "Uniform random rotations", 1992).

    Args:
        model: whose: a model, or the description of a robot.
        seed: the same seed gives the same configurations.
        shape: the leading shape of the batch.
    """
    robot, shape = described(model), (shape,) if isinstance(shape, int) else shape
    generator = np.random.default_rng(seed)
    q = np.empty((*shape, robot.nq))
    for joint in robot.independent:
        where = robot.position_slices[joint.name]
        if joint.type is JointType.FLOATING:
            q[..., where.start : where.start + 3] = generator.uniform(-1, 1, (*shape, 3))
            quaternion = generator.normal(size=(*shape, 4))
            q[..., where.start + 3 : where.stop] = quaternion / np.linalg.norm(quaternion, axis=-1, keepdims=True)
        elif joint.type is JointType.PLANAR:
            q[..., where] = generator.uniform(-1, 1, (*shape, 3)) * np.array([1, 1, math.pi])
        else:
            lower, upper = position_range(robot, joint)
            q[..., where.start] = lower + (upper - lower) * generator.random(shape)
    return q


def _middle(robot: Robot) -> Array:
    """Return the middle of the limits, of what followers leave of them; without one, the position nearest to zero."""
    q = neutral(robot)
    for joint in robot.independent:
        if joint.type.nq == 1:
            lower, upper = _within_followers(robot, joint, _stated(joint))
            middle = (lower + upper) / 2 if math.isfinite(upper - lower) else min(max(0.0, lower), upper)
            q[robot.position_slices[joint.name].start] = middle
    return q


def position_range(robot: Robot, joint: Joint) -> tuple[float, float]:
    """Return ends to draw a joint's position between: `stated_range`, a missing limit half a turn or 1 m away."""
    return _within_followers(robot, joint, _bounded(joint))


def stated_range(robot: Robot, joint: Joint) -> tuple[float, float]:
    """Return the part of a joint's range in which its followers are inside theirs; all of it if that is no range."""
    return _within_followers(robot, joint, joint.limit.range)


def contradicted(robot: Robot) -> tuple[str, ...]:
    """Return the joints whose followers' limits leave them no range: those limits are left out of account."""
    found = []
    for joint in robot.independent:
        if joint.type.nq == 1:
            lower, upper = left = _left_by_followers(robot, joint, joint.limit.range)
            if lower >= upper and left != joint.limit.range:
                found.append(joint.name)
    return tuple(found)


def _within_followers(robot: Robot, joint: Joint, whole: tuple[float, float]) -> tuple[float, float]:
    lower, upper = _left_by_followers(robot, joint, whole)
    return (lower, upper) if lower < upper else whole


def _left_by_followers(robot: Robot, joint: Joint, whole: tuple[float, float]) -> tuple[float, float]:
    """Return the part of a range in which a joint's followers are inside theirs; upper below lower for none."""
    lower, upper = whole
    for name, law in robot.followers.items():
        if law.joint == joint.name and law.multiplier != 0:
            ends = sorted((end - law.offset) / law.multiplier for end in _stated(robot.joint_by_name[name]))
            least, most = _without_huge(ends[0], ends[1])
            lower, upper = max(lower, least), min(upper, most)
    return lower, upper


def _bounded(joint: Joint) -> tuple[float, float]:
    """Return ends to draw between; a missing limit (or 1e308, which means the same) is half a turn or 1 m away."""
    lower, upper = _stated(joint)
    half = math.pi if joint.type.is_angle else 1.0
    below, above = math.isfinite(lower), math.isfinite(upper)
    if below and above:
        return lower, upper
    if below:
        return lower, lower + half
    return (upper - half, upper) if above else (-half, half)


def _stated(joint: Joint) -> tuple[float, float]:
    """Return the range of a joint, infinite where it is so large that it was written for "none"."""
    return _without_huge(*joint.limit.range)


def _without_huge(lower: float, upper: float) -> tuple[float, float]:
    return (lower if abs(lower) < NO_LIMIT else -math.inf), (upper if abs(upper) < NO_LIMIT else math.inf)


def _seed(wanted: str) -> int:
    text = wanted.partition(":")[2]
    if not (text.isascii() and text.isdigit()):
        raise ConfigurationError(f"{quote(wanted)} has no seed", remedy="write random:0, or another number from 0 on")
    return int(text)


def _from_values(
    robot: Robot, values: Mapping[str, Value] | Sequence[float] | Array, degrees: bool, quaternion_first: str
) -> Array:
    q = filled(robot, neutral(robot), robot.position_names, robot.position_slices, values, "position")
    if degrees:
        scale_angles(robot, q, robot.position_slices, math.pi / 180)
    named = set(values) if isinstance(values, Mapping) else None
    for joint in robot.independent:
        where = robot.position_slices[joint.name]
        if joint.type is JointType.FLOATING:
            rotation = q[where.start + 3 : where.stop]
            # Coordinates given by name (joint.qx=...) say themselves which is which.
            if quaternion_first == "w" and (named is None or joint.name in named):
                rotation = np.roll(rotation, -1)
            norm = float(np.linalg.norm(rotation))
            if norm < _SHORTEST_QUATERNION:
                raise ConfigurationError(f"the quaternion of joint {quote(joint.name)} is zero")
            if abs(norm - 1) > _QUATERNION_SLACK:
                raise ConfigurationError(f"the quaternion of joint {quote(joint.name)} has length {norm:.6g}, not 1")
            q[where.start + 3 : where.stop] = rotation / norm
    return q


def from_rows(
    model: Model | Robot,
    values: Array,
    names: Sequence[str] | None = None,
    *,
    degrees: bool = False,
    quaternion_first: str = "x",
) -> Array:
    """Return configurations (m, nq) of rows of numbers (m, k), checked.

    Args:
        model: whose: a model, or the description of a robot.
        values: one configuration a row.
        names: of the columns: joints, or joint.x, joint.y, ... where a joint has several; others are zero. Default: all
            coordinates in file order.
        degrees: angles of joints are in degrees.
        quaternion_first: "x" if quaternions are given as xyzw, "w" if as wxyz (without names).

    Raises:
        UnknownNameError: no such joint.
        ConfigurationError: another count, a number that is not finite or too large, a fixed or a follower joint, a
            quaternion that has not length 1.
    """
    robot = described(model)
    coordinates = robot.position_names
    if names is None:
        names = coordinates
    places = [coordinates.index(n) if n in coordinates else _no_place(robot, n, coordinates) for n in names]
    twice = next((name for name in names if list(names).count(name) > 1), None)
    if twice is not None:
        raise ConfigurationError(f"joint {quote(twice)} is given twice")
    if values.shape[-1] != len(places):
        raise ConfigurationError(f"{values.shape[-1]} numbers are given, {len(places)} are needed")
    q = np.tile(neutral(robot), (len(values), 1))
    q[:, places] = values
    if degrees:
        scale_angles(robot, q, robot.position_slices, math.pi / 180)
    for joint in robot.independent:
        if joint.type is JointType.FLOATING:
            part = q[:, robot.position_slices[joint.name]][:, 3:]
            if quaternion_first == "w" and names is coordinates:
                part = np.roll(part, -1, axis=1)
            lengths = np.linalg.norm(part, axis=1, keepdims=True)
            if not np.all(np.abs(lengths - 1) <= _QUATERNION_SLACK):
                raise ConfigurationError(f"a quaternion of joint {quote(joint.name)} has not length 1")
            q[:, robot.position_slices[joint.name].start + 3 : robot.position_slices[joint.name].stop] = part / lengths
    return checked(robot, q)


def _no_place(robot: Robot, name: str, coordinates: Sequence[str]) -> NoReturn:
    """Say why a name is none of a coordinate."""
    joint = robot.independent_joint(name, coordinates)
    raise ConfigurationError(f"joint {quote(joint.name)} has several coordinates", remedy="name them: joint.x, ...")


def _from_state(robot: Robot, semantics: Semantics, name: str, warnings: list[str]) -> Array:
    """Return the configuration of an SRDF state. It may name followers and a floating base; those go their own way."""
    try:
        positions = semantics.state(name)
    except UnknownNameError as error:
        known = ["zero", "mid", "random:SEED", *semantics.state_names()]
        hint = error.remedy if semantics.states else f"write {', '.join(known)}, joint=value,... or a list"
        raise UnknownNameError(f"there is no configuration {quote(name)}", remedy=hint) from None
    # Several values are those of a floating base, which a state may hold for when there is one.
    lost = [joint for joint, found in positions.items() if joint not in robot.joint_by_name and len(found) == 1]
    warnings += [f"state {quote(name)} sets joint {quote(joint)}, which the robot does not have" for joint in lost]
    settable = {joint.name for joint in robot.independent}
    values: dict[str, Value] = {
        joint: found[0] if len(found) == 1 else found for joint, found in positions.items() if joint in settable
    }
    return _from_values(robot, values, degrees=False, quaternion_first="x")


def _outside_limits(robot: Robot, q: Array, degrees: bool) -> list[str]:
    """Return a line for each joint, follower or not, that is outside its limits."""
    lines = []
    for joint in robot.joints:
        if joint.type.nq != 1:
            continue
        law = robot.followers.get(joint.name)
        position = float(q[robot.position_slices[law.joint if law else joint.name].start])
        if law is not None:
            position = law.multiplier * position + law.offset
        lower, upper = joint.limit.range
        if position < lower - _LIMIT_SLACK or position > upper + _LIMIT_SLACK:
            factor = 180 / math.pi if degrees and joint.type.is_angle else 1.0
            unit = ("deg" if degrees else "rad") if joint.type.is_angle else "m"
            follows = f", by following {quote(law.joint)}" if law else ""
            shown, low, high = (f"{value * factor:.6g}" for value in (position, lower, upper))
            lines.append(f"joint {quote(joint.name)} is at {shown} {unit}{follows}, outside [{low}, {high}]")
    return lines
