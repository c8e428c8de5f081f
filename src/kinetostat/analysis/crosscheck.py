"""The certificate: every number twice, by engines that share nothing, and how far apart they came."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from kinetostat.conventions import Array, tolerance
from kinetostat.engines.model import Model
from kinetostat.engines.protocol import Engine
from kinetostat.urdf.description import JointType, Mimic, Robot

__all__ = ["Certificate", "certified", "combined", "length_scale"]


@dataclass(frozen=True)
class Certificate:
    """What two engines say of one result.

    Attributes:
        engines: their names; one only where the cross-check was left out.
        max_difference: largest absolute difference of any number of the result; None without cross-check.
        tolerance: the largest that counts as agreement, in the result's own units.
        values: both results where they disagree, else empty.
        numbers: how many numbers both have computed.
    """

    engines: tuple[str, ...]
    max_difference: float | None
    tolerance: float
    values: tuple[Array, ...] = field(default=(), compare=False)
    numbers: int = field(default=0, compare=False)

    @property
    def agree(self) -> bool | None:
        """Whether they agree; None without cross-check."""
        return None if self.max_difference is None else bool(self.max_difference <= self.tolerance)


def certified(
    model: Model, evaluate: Callable[[Engine], Array], scale: float, speed: float = 1.0
) -> tuple[Array, Certificate]:
    """Evaluate on both engines; return the first one's numbers and the certificate.

    Args:
        model: the robot.
        evaluate: the question, asked of one engine at a time.
        scale: length that rounding grows with, in m (see `length_scale`).
        speed: size of the rates that a derivative is contracted with.
    """
    allowed, witness = tolerance(scale, speed), model.witness  # which also checks that both see the same joints
    value = np.array(evaluate(model.engine))
    value.flags.writeable = False  # results are values
    if witness is None:
        return value, Certificate((model.engine.name,), None, allowed)
    again = evaluate(witness)
    names = (model.engine.name, witness.name)
    same_shape = value.shape == again.shape
    difference = float(np.max(np.abs(value - again), initial=0.0)) if same_shape else float("inf")
    # NaN compares false: what is not a number never agrees.
    values = () if difference <= allowed else (value, again)
    return value, Certificate(names, difference, allowed, values, value.size)


def combined(certificates: Sequence[Certificate]) -> Certificate:
    """Return the certificate of several results together: that of the one nearest to (or farthest beyond) tolerance.

    Its numbers are those of all.
    """
    nearest = max(certificates, key=lambda one: (one.agree is False, (one.max_difference or 0.0) / one.tolerance))
    return replace(nearest, numbers=sum(one.numbers for one in certificates))


def length_scale(robot: Robot, q: Array, point: tuple[float, float, float] | None = None, unit: float = 1.0) -> float:
    """Return the length that rounding errors at q grow with, in units of `unit` metres.

    Reach, plus how far joints slide at q and how far the point lies out; times the largest mimic multiplier, and times
    the largest angle in turns, because sine and cosine lose digits of large angles in proportion.
    """
    q = np.asarray(q, dtype=np.float64)
    length = robot.reach + (0.0 if point is None else float(np.linalg.norm(point)))
    turns = max((max(map(abs, joint.origin.rpy)) for joint in robot.joints), default=0.0) / (2 * np.pi)
    for joint in robot.joints:
        if joint.type is JointType.FIXED:
            continue
        law = robot.followers.get(joint.name)
        part = np.abs(q[..., robot.position_slices[law.joint if law else joint.name]])
        size = float(np.max(part, initial=0.0)) if law is None else _followed(law, part)
        if joint.type.is_angle or joint.type is JointType.PLANAR:
            turns = max(turns, size / (2 * np.pi))
        length += abs(joint.pitch) * (1 + size / (2 * np.pi)) if joint.type.is_angle else size
    return max(1.0, length / unit) * robot.largest_multiplier * max(1.0, turns)


def _followed(law: Mimic, leader: Array) -> float:
    """Return the largest size of a follower's position."""
    return abs(law.multiplier) * float(np.max(leader, initial=0.0)) + abs(law.offset)
