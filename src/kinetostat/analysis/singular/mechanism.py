"""A mechanism: a chain of screws with a task, as pure numbers, and the rank that its structure gives it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from kinetostat.analysis.configuration import neutral
from kinetostat.analysis.coordinates import Coordinates, coordinates
from kinetostat.analysis.jacobian import checked_point
from kinetostat.analysis.task import FULL, TRANSLATION, Task
from kinetostat.conventions import Array, Reference, Velocity
from kinetostat.engines.model import Model
from kinetostat.engines.screw import ScrewEngine
from kinetostat.errors import UsageError, quote
from kinetostat.screw import se3
from kinetostat.screw.kernel import Kernel
from kinetostat.urdf.description import Robot

__all__ = ["EXACT", "MODEL", "STRICT", "Mechanism", "mechanism"]

STRICT = 1e-9  # a singular value below it is zero in exact numbers
EXACT = 1e-7  # what becomes of a strict zero at a configuration that a search has found to its own accuracy
MODEL = 1e-5  # and below this, zero but for the rounding of a file that writes 1.5708 for pi/2
_MANY = 64  # configurations that compiled code is called for
_SAMPLES = 32  # configurations that decide the generic rank and the unit of length
_SEED = 0
_NO_LENGTH = 1e-9  # of the robot's reach: a distance below it is rounding
_ROUNDED = 1e-3  # rad: what a rounded angle is off


@dataclass(frozen=True, repr=False)
class Mechanism(Coordinates):
    """The joints between an observer and a tool point, and the rows of the tool's twist that count.

    Its Jacobian is a matrix of pure numbers: linear rows are in units of the length L, and so are slides. Coordinates
    q are those of the chain, (..., n), in rad and m. Where all six rows count, ranks and null spaces are the same
    whatever point of the tool they are taken at; the Jacobian is then that of a point amid the axes, so that a tool
    point far out does not drown what the joints can do.

    Attributes:
        velocity: the label of its Jacobian: of which point, relative to the observer, in its axes or in the tool's.
        point: the tool point in the frame's coordinates, m.
        task: the rows that count, m of them.
        length: L, in m: the root mean square distance of the joints' axes from the point of `velocity`.
        generic_rank: r, the rank at almost every configuration.
        compiled: whether singular values of many configurations come from compiled code, whose loading takes a while.
    """

    velocity: Velocity
    point: tuple[float, float, float]
    task: Task
    length: float
    generic_rank: int
    compiled: bool = False

    def __repr__(self) -> str:
        frames = f"{quote(self.velocity.of)} relative to {quote(self.velocity.relative_to)}"
        return f"<Mechanism {frames}: {len(self.names)} joints, rank {self.generic_rank} of {len(self.task.rows)}>"

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
        q = np.asarray(q, dtype=np.float64)
        if self.compiled and q.size >= _MANY * q.shape[-1]:
            values = self._kernel(q.reshape(-1, q.shape[-1]))["singular_values"]
            return np.array(values[:, self.generic_rank - 1]).reshape(q.shape[:-1])
        every = np.linalg.svd(self.jacobian(q), compute_uv=False)
        return np.asarray(every[..., self.generic_rank - 1], dtype=np.float64)

    @cached_property
    def _kernel(self) -> Kernel:
        """What gives the singular values of `jacobian` by compiled code."""
        rows = np.array([1 / self.length] * 3 + [1.0] * 3)
        return Kernel(self.chain, ("singular_values",), self.task.rows, rows, self.units, self.local)

    def difference(self, a: Array, b: Array) -> Array:
        """Return a - b in coordinate units, angles that repeat by the shorter way round. (..., n) -> (..., n)."""
        gap = (np.asarray(a) - np.asarray(b)) / self.units
        return np.where(self.periodic, np.remainder(gap + math.pi, 2 * math.pi) - math.pi, gap)


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
    joints = coordinates(model, of, observer, at)
    chain, turning, engine = joints.chain, joints.turning, ScrewEngine(robot)
    parts = {part.name: getattr(joints, part.name) for part in fields(joints)}
    draft = Mechanism(**parts, velocity=velocity, point=at, task=FULL, length=1.0, generic_rank=1)
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
