"""The coordinates of a chain between two frames: their joints, limits and turns, as arrays over columns."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinetostat.analysis.configuration import position_range, stated_range
from kinetostat.analysis.task import turning_columns
from kinetostat.conventions import Array, Flags
from kinetostat.engines.model import Model
from kinetostat.engines.screw import ScrewEngine
from kinetostat.errors import UsageError, quote
from kinetostat.screw.chain import Chain
from kinetostat.urdf.description import Joint, JointType

__all__ = ["Coordinates", "coordinates"]

_SLACK = 1e-5  # a limit typed with six digits is not exceeded by its own rounding


@dataclass(frozen=True, repr=False)
class Coordinates:
    """The joints between an observer and a tool point, one coordinate each (three for a planar one), (..., n).

    Attributes:
        model: the robot.
        chain: the screws to the tool point.
        names: names of the n coordinates, in path order.
        joints: the joint of each coordinate.
        turning: whether each coordinate is an angle.
        indices: where each coordinate is in the robot's configuration.
    """

    model: Model
    chain: Chain
    names: tuple[str, ...]
    joints: tuple[Joint, ...]
    turning: tuple[bool, ...]
    indices: tuple[int, ...]

    @cached_property
    def periodic(self) -> tuple[bool, ...]:
        """Whether the arm is the same a whole turn on: angles that drive no pitch, and followers by whole numbers."""
        v, w = self.chain.screws[:3], self.chain.screws[3:]
        no_pitch = np.abs(np.sum(v * w, axis=0)) < 1e-12 * (1 + np.linalg.norm(v, axis=0))
        whole = np.abs(self.chain.fold - np.round(self.chain.fold)) < 1e-12
        each = np.all((whole & no_pitch[:, None]) | (self.chain.fold == 0), axis=0)
        return tuple(bool(same and turns) for same, turns in zip(each, self.turning, strict=True))

    def draw(self, generator: np.random.Generator, shape: tuple[int, ...], *, limited: bool = False) -> Array:
        """Return random coordinates (*shape, n): angles of a whole turn, others inside limits; or all inside limits."""
        lower, upper = self.limits if limited else self.spans
        drawn: Array = lower + (upper - lower) * generator.random((*shape, len(self.names)))
        return drawn

    @cached_property
    def limits(self) -> tuple[Array, Array]:
        """Lower and upper ends of each coordinate: its limits, or what stands for a missing one. (n,), (n,)."""
        robot = self.model.robot
        ranges = [
            position_range(robot, joint) if joint.type.nq == 1 else ((-math.pi, math.pi) if turns else (-1.0, 1.0))
            for joint, turns in zip(self.joints, self.turning, strict=True)
        ]
        return np.array([ends[0] for ends in ranges]), np.array([ends[1] for ends in ranges])

    @cached_property
    def stated_limits(self) -> tuple[Array, Array]:
        """Lower and upper limits as the file states them, followers' too; infinite where there are none. (n,), (n,)."""
        robot = self.model.robot
        single = [stated_range(robot, j) if j.type.nq == 1 else (-math.inf, math.inf) for j in self.joints]
        return np.array([ends[0] for ends in single]), np.array([ends[1] for ends in single])

    @property
    def locked(self) -> tuple[str, ...]:
        """Coordinates whose limits are one position."""
        return tuple(name for name, low, high in zip(self.names, *self.limits, strict=True) if low == high)

    @cached_property
    def spans(self) -> tuple[Array, Array]:
        """Ends to draw between when limits of angles do not count: a whole turn; limits, where turns do not repeat.

        Half a metre to either side of a slide that cannot move within its limits: it has columns all the same.
        """
        lower, upper = self.limits
        locked = (upper - lower < _SLACK) & ~np.array(self.turning)
        lower, upper = np.where(locked, lower - 0.5, lower), np.where(locked, upper + 0.5, upper)
        periodic = np.array(self.periodic)
        return np.where(periodic, -math.pi, lower), np.where(periodic, math.pi, upper)

    def into_limits(self, q: Array) -> Array:
        """Return coordinates with angles turned by whole turns into their limits, or else into (-pi, pi]. (..., n)."""
        lower, _ = self.stated_limits
        wrapped = self.wrapped(q)
        start = np.where(np.isfinite(lower) & np.array(self.periodic), lower, wrapped)
        turns = 2 * math.pi * np.ceil((start - _SLACK - wrapped) / (2 * math.pi))
        least = wrapped + np.where(self.periodic, turns, 0.0)
        return np.where(self.between(wrapped), wrapped, np.where(self.between(least), least, wrapped))

    def near(self, q: Array, origin: Array) -> Array:
        """Return coordinates with angles turned by whole turns to the one nearest to `origin` that limits allow.

        As `into_limits` where they allow none. (..., n), (..., n) -> (..., n).
        """
        near = np.where(self.periodic, origin + self.wrapped(q - origin), q)
        chosen = self.into_limits(q)
        for turns in (1, -1, 0):
            there = near + np.where(self.periodic, 2 * math.pi * turns, 0.0)
            chosen = np.where(self.between(there), there, chosen)
        return chosen

    def wrapped(self, q: Array) -> Array:
        """Return coordinates with angles that repeat in (-pi, pi]. (..., n)."""
        return np.where(self.periodic, math.pi - np.remainder(math.pi - q, 2 * math.pi), q)

    def inside(self, q: Array) -> Flags:
        """Return for each coordinate whether it is inside its limits, angles by whole turns. (..., n) -> (..., n)."""
        return self.between(self.into_limits(q))

    def within(self, q: Array) -> bool:
        """Return whether coordinates as they stand are inside their limits. (n,)."""
        return bool(np.all(self.between(q)))

    def between(self, q: Array) -> Flags:
        """Return for each coordinate whether it is inside its limits as it stands. (..., n) -> (..., n)."""
        lower, upper = self.stated_limits
        between: Flags = (q >= lower - _SLACK) & (q <= upper + _SLACK)
        return between

    def configuration(self, q: Array, rest: Array) -> Array:
        """Return configurations of the whole robot: q put into `rest`. (..., n), (nq,) -> (..., nq)."""
        whole = np.broadcast_to(rest, (*np.shape(q)[:-1], rest.shape[-1])).copy()
        whole[..., list(self.indices)] = q
        return whole


def coordinates(model: Model, frame: str, observer: str, point: Sequence[float] = (0.0, 0.0, 0.0)) -> Coordinates:
    """Return the coordinates between two frames that exist, the chain being to a point of the first.

    Raises:
        UsageError: no joint between the frames, or a floating one.
    """
    robot = model.robot
    joints = robot.moving_joints(observer, frame)
    floating = next((joint for joint in joints if joint.type is JointType.FLOATING), None)
    if floating is not None:
        raise UsageError(
            f"floating joint {quote(floating.name)} moves {quote(frame)} any way",
            remedy=f"--relative-to {floating.child}, the link that it carries",
        )
    chain, names = ScrewEngine(robot).chain(frame, observer, point)
    each = [joint for joint in joints for _ in range(joint.type.nq)]
    indices = [i for joint in joints for i in range(*robot.position_slices[joint.name].indices(robot.nq))]
    return Coordinates(model, chain, tuple(names), tuple(each), turning_columns(joints), tuple(indices))
