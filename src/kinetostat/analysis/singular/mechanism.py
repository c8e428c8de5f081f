"""A mechanism: a chain of screws with a task, as pure numbers, and the rank that its structure gives it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from kinetostat.analysis.configuration import neutral, position_range
from kinetostat.analysis.jacobian import checked_point
from kinetostat.analysis.task import FULL, TRANSLATION, Task, turning_columns
from kinetostat.conventions import Array, Flags, Reference, Velocity
from kinetostat.engines.model import Model
from kinetostat.engines.screw import ScrewEngine
from kinetostat.errors import UsageError, quote
from kinetostat.screw import se3
from kinetostat.screw.chain import Chain
from kinetostat.urdf.description import Joint, JointType, Robot

__all__ = ["EXACT", "MODEL", "STRICT", "Mechanism", "mechanism"]

STRICT = 1e-9  # a singular value below it is zero in exact numbers
EXACT = 1e-7  # what becomes of a strict zero at a configuration that a search has found to its own accuracy
MODEL = 1e-5  # and below this, zero but for the rounding of a file that writes 1.5708 for pi/2
_SAMPLES = 32  # configurations that decide the generic rank and the unit of length
_SEED = 0
_NO_LENGTH = 1e-9  # of the robot's reach: a distance below it is rounding
_ROUNDED = 1e-3  # rad: what a rounded angle is off
_SLACK = 1e-5  # a limit typed with six digits is not exceeded by its own rounding


@dataclass(frozen=True, repr=False)
class Mechanism:
    """The joints between an observer and a tool point, and the rows of the tool's twist that count.

    Its Jacobian is a matrix of pure numbers: linear rows are in units of the length L, and so are slides. Coordinates
    q are those of the chain, (..., n), in rad and m. Where all six rows count, ranks and null spaces are the same
    whatever point of the tool they are taken at; the Jacobian is then that of a point amid the axes, so that a tool
    point far out does not drown what the joints can do.

    Attributes:
        model: the robot.
        velocity: the label of its Jacobian: of which point, relative to the observer, in its axes or in the tool's.
        point: the tool point in the frame's coordinates, m.
        task: the rows that count, m of them.
        chain: the screws, to the point of `velocity`.
        names: names of the n coordinates, in path order.
        joints: the joint of each coordinate.
        turning: whether each coordinate is an angle.
        indices: where each coordinate is in the robot's configuration.
        length: L, in m: the root mean square distance of the joints' axes from the point of `velocity`.
        generic_rank: r, the rank at almost every configuration.
    """

    model: Model
    velocity: Velocity
    point: tuple[float, float, float]
    task: Task
    chain: Chain
    names: tuple[str, ...]
    joints: tuple[Joint, ...]
    turning: tuple[bool, ...]
    indices: tuple[int, ...]
    length: float
    generic_rank: int

    def __repr__(self) -> str:
        frames = f"{quote(self.velocity.of)} relative to {quote(self.velocity.relative_to)}"
        return f"<Mechanism {frames}: {len(self.names)} joints, rank {self.generic_rank} of {len(self.task.rows)}>"

    @cached_property
    def periodic(self) -> tuple[bool, ...]:
        """Whether the arm is the same a whole turn on: angles that drive no pitch, and followers by whole numbers."""
        v, w = self.chain.screws[:3], self.chain.screws[3:]
        no_pitch = np.abs(np.sum(v * w, axis=0)) < 1e-12 * (1 + np.linalg.norm(v, axis=0))
        whole = np.abs(self.chain.fold - np.round(self.chain.fold)) < 1e-12
        each = np.all((whole & no_pitch[:, None]) | (self.chain.fold == 0), axis=0)
        return tuple(bool(same and turns) for same, turns in zip(each, self.turning, strict=True))

    @cached_property
    def rounded(self) -> bool:
        """Whether the file rounds an angle of the arm: writes nearly, but not quite, a multiple of an eighth turn."""
        robot = self.model.robot
        path = robot.path(self.velocity.relative_to, self.velocity.of)
        eighths = np.array([joint.origin.rpy for joint, _ in path]) * 4 / math.pi
        off = np.abs(eighths - np.round(eighths)) * math.pi / 4
        return bool(np.any((off > STRICT) & (off < _ROUNDED)))

    @property
    def tolerance(self) -> float:
        """What singular values of the arm count as zero: rounding in the file makes more of them."""
        return MODEL if self.rounded else EXACT

    def tool(self, q: Array) -> Array:
        """Return the tool point in the observer's coordinates. (..., n) -> (..., 3), m."""
        _, placement = self.chain.columns(q)
        arm = np.subtract(self.point, self.velocity.point or self.point)
        return se3.transform(placement, arm)

    @cached_property
    def units(self) -> Array:
        """What one unit of each coordinate is: 1 rad, or L in m. (n,)."""
        return np.where(self.turning, 1.0, self.length)

    @cached_property
    def _rows(self) -> Array:
        return np.where(np.array(self.task.rows) < 3, 1 / self.length, 1.0)[:, None]

    @property
    def local(self) -> bool:
        """Whether the rows are in the axes of the tool's frame, not in those of the observer's."""
        return self.velocity.expressed_in == self.velocity.of

    def scaled(self, matrix: Array) -> Array:
        """Return the task's rows of a Jacobian (..., 6, n) as pure numbers. (..., m, n)."""
        rows: Array = matrix[..., list(self.task.rows), :] * self._rows * self.units
        return rows

    def jacobian(self, q: Array) -> Array:
        """Return the Jacobian as pure numbers. (..., n) -> (..., m, n)."""
        return self.scaled(self.chain.jacobian(q, local=self.local))

    def derivatives(self, q: Array) -> tuple[Array, Array]:
        """Return the Jacobian and its derivatives by coordinates in their units. (..., m, n), (..., m, n, n)."""
        matrix, along = self.chain.derivatives(q, local=self.local)
        rows = along[..., list(self.task.rows), :, :] * self._rows[..., None]
        return self.scaled(matrix), rows * self.units[:, None] * self.units

    def smallest(self, q: Array) -> Array:
        """Return the singular value that decides: s_r. (..., n) -> (...)."""
        values = np.linalg.svd(self.jacobian(q), compute_uv=False)
        return np.asarray(values[..., self.generic_rank - 1], dtype=np.float64)

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
        lower, upper = np.array([ends[0] for ends in ranges]), np.array([ends[1] for ends in ranges])
        locked = (upper - lower < _SLACK) & ~np.array(self.turning)  # a slide that cannot move has columns all the same
        return np.where(locked, lower - 0.5, lower), np.where(locked, upper + 0.5, upper)

    @cached_property
    def stated_limits(self) -> tuple[Array, Array]:
        """Lower and upper limits as the file states them, infinite where it states none. (n,), (n,)."""
        single = [joint.limit.range if joint.type.nq == 1 else (-math.inf, math.inf) for joint in self.joints]
        return np.array([ends[0] for ends in single]), np.array([ends[1] for ends in single])

    @cached_property
    def spans(self) -> tuple[Array, Array]:
        """Ends to draw between when limits of angles do not count: a whole turn; limits, where turns do not repeat."""
        lower, upper = self.limits
        periodic = np.array(self.periodic)
        return np.where(periodic, -math.pi, lower), np.where(periodic, math.pi, upper)

    def into_limits(self, q: Array) -> Array:
        """Return coordinates with angles turned by whole turns into their limits, or else into (-pi, pi]. (..., n)."""
        lower, _ = self.stated_limits
        wrapped = self.wrapped(q)
        start = np.where(np.isfinite(lower) & np.array(self.periodic), lower, wrapped)
        turns = 2 * math.pi * np.ceil((start - _SLACK - wrapped) / (2 * math.pi))
        least = wrapped + np.where(self.periodic, turns, 0.0)
        return np.where(self._between(wrapped), wrapped, np.where(self._between(least), least, wrapped))

    def wrapped(self, q: Array) -> Array:
        """Return coordinates with angles that repeat in (-pi, pi]. (..., n)."""
        return np.where(self.periodic, math.pi - np.remainder(math.pi - q, 2 * math.pi), q)

    def difference(self, a: Array, b: Array) -> Array:
        """Return a - b in coordinate units, angles that repeat by the shorter way round. (..., n) -> (..., n)."""
        gap = (np.asarray(a) - np.asarray(b)) / self.units
        return np.where(self.periodic, np.remainder(gap + math.pi, 2 * math.pi) - math.pi, gap)

    def inside(self, q: Array) -> Flags:
        """Return for each coordinate whether it is inside its limits, angles by whole turns. (..., n) -> (..., n)."""
        return self._between(self.into_limits(q))

    def within(self, q: Array) -> bool:
        """Return whether coordinates as they stand are inside their limits. (n,)."""
        return bool(np.all(self._between(q)))

    def _between(self, q: Array) -> Flags:
        lower, upper = self.stated_limits
        between: Flags = (q >= lower - _SLACK) & (q <= upper + _SLACK)
        return between

    def configuration(self, q: Array, rest: Array) -> Array:
        """Return configurations of the whole robot: q put into `rest`. (..., n), (nq,) -> (..., nq)."""
        whole = np.broadcast_to(rest, (*np.shape(q)[:-1], rest.shape[-1])).copy()
        whole[..., list(self.indices)] = q
        return whole


def mechanism(
    model: Model,
    frame: str,
    *,
    relative_to: str | None = None,
    point: Sequence[float] | None = None,
    axes: str | Sequence[str] | None = None,
    reference: Reference | str = Reference.ALIGNED,
) -> Mechanism:
    """Return the mechanism between two frames.

    Without `axes` all six rows count; where three joints or fewer all move the point independently, the linear ones:
    such an arm carries a point about, and has no say in the orientation that comes with it.

    The generic rank is the largest rank at 32 random configurations, with the model tolerance: a file that rounds its
    angles is not given a rank that the real arm does not have.

    Args:
        model: the robot.
        frame: the tool's frame, a link.
        relative_to: the observer's link; default the root link.
        point: the tool point in the frame's coordinates, in m; default its origin.
        axes: the rows that count, such as "x y rz"; default see above.
        reference: aligned, rows in the observer's axes; or local, in the axes of the tool's frame.

    Raises:
        UnknownNameError: no such frame.
        UsageError: no joint between the frames, or a floating one; axes that cannot be.
    """
    robot = model.robot
    observer, of = robot.frame(relative_to or robot.root), robot.frame(frame)
    at = (0.0, 0.0, 0.0) if point is None else checked_point(point)
    reference = Reference(reference)
    if reference is Reference.WORLD:
        raise UsageError("rows that count are those of a tool point", remedy="use reference aligned or local")
    velocity = Velocity.by_reference(reference, of, observer, point=at)
    joints = robot.moving_joints(observer, of)
    floating = next((joint for joint in joints if joint.type is JointType.FLOATING), None)
    if floating is not None:
        raise UsageError(
            f"floating joint {quote(floating.name)} moves {quote(of)} any way: nothing there is ever singular",
            remedy=f"--relative-to {floating.child}, the link that it carries",
        )
    engine = ScrewEngine(robot)
    chain, names = engine.chain(of, observer, at)
    each = [joint for joint in joints for _ in range(joint.type.nq)]
    indices = [i for joint in joints for i in range(*robot.position_slices[joint.name].indices(robot.nq))]
    turning = turning_columns(joints)
    draft = Mechanism(model, velocity, at, FULL, chain, tuple(names), tuple(each), turning, tuple(indices), 1.0, 1)
    q = draft.draw(np.random.default_rng(_SEED), (_SAMPLES,))
    task = _natural_task(chain.jacobian(q), robot.reach) if axes is None else Task.named(axes)
    if len(task.rows) == 6:
        amid = _amid_axes(robot, engine, of, observer)
        label = Velocity.by_reference(reference, of, observer, point=amid)
        draft = replace(draft, velocity=label, chain=engine.chain(of, observer, amid)[0])
    samples = draft.chain.jacobian(q, local=draft.local)
    sized = replace(draft, length=_axes_distance(samples, turning, robot.reach), task=task)
    values = np.linalg.svd(sized.scaled(samples), compute_uv=False)
    rank = int(np.max(np.sum(values > MODEL, axis=-1)))
    if rank == 0:
        rows = " ".join(task.row_names)
        raise UsageError(f"no joint ever moves {quote(of)} along {rows}", remedy="choose other --axes")
    return replace(sized, generic_rank=rank)


def _amid_axes(robot: Robot, engine: ScrewEngine, of: str, observer: str) -> tuple[float, float, float]:
    """Return the origin of the last joint that turns, in the tool frame's coordinates at the zero configuration, m."""
    last = next((joint for joint, _ in reversed(robot.path(observer, of)) if joint.type.is_angle), None)
    if last is None:
        return 0.0, 0.0, 0.0
    x, y, z = engine.placement(neutral(robot), last.child, of)[:3, 3]
    return float(x), float(y), float(z)


def _axes_distance(samples: Array, turning: Sequence[bool], reach: float) -> float:
    """Return the root mean square of linear rows of columns that turn; 1 m where all axes pass through the point."""
    turns = samples[..., np.array(turning)]
    angular = float(np.sum(turns[..., 3:, :] ** 2))
    linear = float(np.sum(turns[..., :3, :] ** 2))
    distance = math.sqrt(linear / angular) if angular > 0 else 0.0
    return distance if distance > _NO_LENGTH * reach else 1.0


def _natural_task(samples: Array, reach: float) -> Task:
    """Return the task of an arm that was given none. (N, 6, n)."""
    count = samples.shape[-1]
    linear = np.linalg.svd(samples[:, :3], compute_uv=False)
    positions = count <= 3 and float(np.max(linear[:, count - 1])) > MODEL * _arm(samples, reach)
    return TRANSLATION if positions else FULL


def _arm(samples: Array, reach: float) -> float:
    """Return the largest linear entry, or what is left of it where it is rounding, in m."""
    largest = float(np.max(np.abs(samples[:, :3])))
    return largest if largest > _NO_LENGTH * reach else math.inf
