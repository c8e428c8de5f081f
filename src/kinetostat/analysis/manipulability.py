"""Manipulability: how well a frame can move, and be held, at a configuration; with gradients, certified."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from kinetostat.analysis.configuration import checked
from kinetostat.analysis.crosscheck import Certificate, certified, length_scale
from kinetostat.analysis.indices import ROUNDING, STRICT, inverse_condition_number, isotropy, singular_value_unit
from kinetostat.analysis.jacobian import labelled, velocity_units
from kinetostat.analysis.task import (
    FULL,
    ROTATION,
    TRANSLATION,
    Task,
    characteristic_length,
    pointing_up,
    turning_columns,
)
from kinetostat.analysis.usual_rank import sampled_jacobians
from kinetostat.analysis.weights import JointWeights, fixed_weights, limit_weights
from kinetostat.conventions import Array, Reference, Velocity
from kinetostat.engines.model import Model
from kinetostat.engines.protocol import Engine
from kinetostat.errors import UsageError, quote
from kinetostat.urdf.description import Joint, Robot

__all__ = ["Block", "Ellipsoid", "Manipulability", "Transmission", "manipulability"]

_NO_LENGTH = 1e-9  # of the robot's reach: a distance below it is rounding
_SHORTEST, _LONGEST = 1e-9, 1e9  # m


@dataclass(frozen=True)
class Ellipsoid:
    """What unit joint rates (or torques) make: velocities (or the wrenches that they hold).

    Attributes:
        axes: unit directions as columns, in the block's rows, the longest velocity first. (..., m, m).
        lengths: length of each; infinite where no torque is needed. (..., m).
        unit: unit of the lengths, for one unit of joint rate or torque.
    """

    axes: Array
    lengths: Array
    unit: str


@dataclass(frozen=True)
class Block:
    """The indices of some rows of a Jacobian, all from its min(m, n) singular values s_1 >= ... >= s_k.

    Attributes:
        task: the rows; m of them.
        unit: unit of the singular values.
        rank: how many are above 1e-9 of the largest, on the length-scaled matrix. (...).
        usual_rank: the rank at almost every configuration.
        singular_values: s, (..., k).
        yoshikawa: w = s_1 ... s_k, which is sqrt(det J J^T) where m <= n. (...).
        minimum_singular_value: s_k, (...).
        inverse_condition_number: s_k / s_1 in [0, 1], 0 where s_1 is 0. (...).
        isotropy: geometric over arithmetic mean of the s^2, in [0, 1]. (...).
        velocity: the ellipsoid of velocities that unit joint rates give.
        force: the ellipsoid of forces that unit joint torques hold.
        gradients: each index's gradient, (..., n) over the columns; NaN where it has none (see `manipulability`).
        penalised: w times the penalty of position limits, (...); None without `weights="limits"`.
    """

    task: Task
    unit: str
    rank: Array
    usual_rank: int
    singular_values: Array
    yoshikawa: Array
    minimum_singular_value: Array
    inverse_condition_number: Array
    isotropy: Array
    velocity: Ellipsoid
    force: Ellipsoid
    gradients: dict[str, Array]
    penalised: Array | None = None

    @property
    def task_dimension(self) -> int:
        """Number of rows, m."""
        return len(self.task.rows)


@dataclass(frozen=True)
class Transmission:
    """How motion and force pass along a line through the point.

    Attributes:
        direction: the unit vector u along it, in the axes of the velocity. (3,).
        velocity: the speed along u that unit joint rates give without any other translation, 0 where it cannot. (...).
        force: the force along u that unit joint torques hold; infinite where it needs none. (...).
        unit_velocity: unit of the first.
        unit_force: unit of the second.
    """

    direction: Array
    velocity: Array
    force: Array
    unit_velocity: str
    unit_force: str


@dataclass(frozen=True, repr=False)
class Manipulability:
    """Indices, ellipsoids and gradients of the blocks of a Jacobian.

    Attributes:
        velocity: of which frame and point, relative to which observer, expressed in which axes.
        reference: the shorthand that it was asked by.
        columns: names of the columns.
        column_units: units of the joint rates.
        blocks: full, translation, rotation, and `task` if axes were chosen.
        length: the characteristic length L in m that divides linear rows where a block mixes them with angular ones,
            (...); None if metres and radians are mixed as they are.
        length_reference: how L was found.
        weights: the weights of the columns, or None.
        transmission: along the given direction, or None.
        certificate: what the two engines say of the Jacobian, its derivatives and the singular values.
        warnings: what is to be said of it.
    """

    velocity: Velocity
    reference: Reference
    columns: tuple[str, ...]
    column_units: tuple[str, ...]
    blocks: dict[str, Block]
    length: Array | None
    length_reference: str
    weights: JointWeights | None
    transmission: Transmission | None
    certificate: Certificate
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        shape = self.blocks["full"].yoshikawa.shape
        return f"<Manipulability {quote(self.velocity.of)}: blocks {', '.join(self.blocks)}, batch {shape}>"


def manipulability(
    model: Model,
    frame: str,
    q: Array,
    *,
    reference: Reference | str = Reference.ALIGNED,
    relative_to: str | None = None,
    expressed_in: str | None = None,
    point: Sequence[float] | None = None,
    axes: str | Sequence[str] | None = None,
    length: float | Literal["auto", "none"] = "none",
    weights: Literal["limits"] | Sequence[float] | None = None,
    direction: Sequence[float] | None = None,
) -> Manipulability:
    """Return manipulability indices, ellipsoids and gradients of a frame.

    With J = U diag(s) V^T restricted to the rows of a block, k = min(m, n):

        w = s_1 ... s_k            T. Yoshikawa, "Manipulability of robotic mechanisms", IJRR 4(2), 1985
        s_k, s_k / s_1             C. Klein and B. Blaho, "Dexterity measures for the design and control of
                                   kinematically redundant manipulators", IJRR 6(2), 1987
        (prod s^2)^(1/k) / mean s^2    J. Kim and P. Khosla, "Dexterity measures for design and control of
                                   manipulators", IROS 1991
        ds_i/dq_j = u_i^T (dJ/dq_j) v_i, from which all gradients follow by the chain rule
        1/|J^+ u|, 1/|J^T u|       transmission along u: S. Chiu, "Task compatibility of manipulator postures",
                                   IJRR 7(5), 1988

    An index has no gradient (NaN) where it has a kink: where a singular value that it touches is zero, for the smallest
    (or largest) one where it is repeated, and along a joint whose weight has a kink. L is held constant in gradients.
    A direction counts as reachable if it is within 3e-5 rad of one that is.

    Args:
        model: the robot.
        frame: F, a link.
        q: configurations (..., nq).
        reference: aligned, local or world; see `conventions.Reference`.
        relative_to: A, the observer's link; default the root link.
        expressed_in: E, the link in whose axes rows are; default as `reference` says.
        point: the point in F's coordinates, in m; default F's origin.
        axes: rows of a further block `task`, such as "x y rz"; see `Task.named`.
        length: the characteristic length of blocks that mix metres and radians: in m, "auto" (see
            `task.characteristic_length`) or "none". Slides count as angles q / L.
        weights: of the columns: "limits" (see `weights.limit_weights`) or a number for each.
        direction: (3,), in the axes of the velocity: transmission along it is given too.

    Raises:
        UnknownNameError: no such frame.
        UsageError: no joint between the frames; axes, length, weights or direction that cannot be.
        ConfigurationError: q has another shape, or a number that is not finite.
    """
    robot = model.robot
    q, reference = checked(robot, q), Reference(reference)
    velocity = labelled(robot, frame, reference, relative_to, expressed_in, point)
    joints = robot.moving_joints(velocity.relative_to, velocity.of)
    columns = robot.velocity_columns(joints)
    turning = turning_columns(joints)
    tasks = [FULL, TRANSLATION, ROTATION, *([] if axes is None else [Task.named(axes)])]
    weighing = _weights(robot, joints, q, weights, len(columns))

    def both(engine: Engine) -> Array:
        # Row 0 is J, rows 1 ... n its derivative along each column, row n + 1 its blocks' singular values.
        matrix = engine.jacobian(q, velocity)[..., columns]
        along = engine.jacobian_rate(q[..., None, :], np.eye(robot.nv)[columns], velocity)[..., columns]
        values = np.zeros((*matrix.shape[:-2], 1, *matrix.shape[-2:]))
        for i, task in enumerate(tasks[1:]):  # those that are not mixed first: their units are sound
            found = np.linalg.svd(matrix[..., task.rows, :], compute_uv=False)
            values[..., 0, i, : found.shape[-1]] = found
        return np.concatenate([matrix[..., None, :, :], along, values], -3)

    value, certificate = certified(model, both, length_scale(robot, q, velocity.point), robot.largest_multiplier)
    matrix, along = value[..., 0, :, :], np.moveaxis(value[..., 1:-1, :, :], -3, -1)
    size, size_reference = _length(length, matrix, turning, tasks[-1], robot.reach)
    warnings = list[str]()
    if weighing is not None:
        along = along * weighing.factors[..., None, :, None] + _diagonal(matrix, weighing)
        matrix = matrix * weighing.factors[..., None, :]
        warnings += [f"joint {quote(name)} is at or beyond a limit: its weight is 0" for name in weighing.outside]
    usual = _usual_ranks(model, velocity, columns, tasks)
    blocks = {
        task.name: _block(task, matrix, along, turning, size, weighing, rank)
        for task, rank in zip(tasks, usual, strict=True)
    }
    if weighing is None and np.any(blocks["full"].rank < blocks["full"].usual_rank):
        warnings.append(
            f"singular: rank {int(np.min(blocks['full'].rank))}, {blocks['full'].usual_rank} at almost every "
            "configuration ('kinetostat singular at' says why)"
        )
    mixed = [name for name, block in blocks.items() if block.unit == "mixed"]
    if mixed and (axes is None or "task" in mixed):
        warnings.append(
            f"m and rad are mixed in {', '.join(mixed)}: such numbers depend on the unit of length (--length auto, or "
            "a length in m, makes them comparable)"
        )
    line = None if direction is None else _transmission(direction, matrix, turning, size, weighing)
    return Manipulability(
        velocity,
        reference,
        tuple(name for joint in joints for name in joint.velocity_names),
        tuple(unit for joint in joints for unit in velocity_units(joint)),
        blocks,
        size,
        size_reference,
        weighing,
        line,
        certificate,
        tuple(warnings),
    )


def _numbers(values: Sequence[float], message: str, remedy: str) -> Array:
    try:
        return np.array([float(value) for value in values])
    except (TypeError, ValueError):
        raise UsageError(message, remedy=remedy) from None


def _weights(
    robot: Robot, joints: Sequence[Joint], q: Array, wanted: str | Sequence[float] | None, count: int
) -> JointWeights | None:
    if wanted is None:
        return None
    if isinstance(wanted, str):
        if wanted != "limits":
            raise UsageError(f"there are no weights {quote(wanted)}", remedy="limits, or a number for each column")
        return limit_weights(robot, joints, q)
    numbers = _numbers(wanted, "weights are limits, or a number for each column", f"there are {count} columns")
    return fixed_weights(numbers, count)


def _diagonal(matrix: Array, weights: JointWeights) -> Array:
    """Return J_i da_i/dq_i on the diagonal i = j: what changing weights add to the derivatives. (..., 6, n, n)."""
    changes = (matrix * weights.derivatives[..., None, :])[..., None]
    return np.where(np.eye(matrix.shape[-1], dtype=bool), changes, 0.0)  # a NaN stays in its own column


def _length(
    wanted: float | str, matrix: Array, turning: Sequence[bool], task: Task, reach: float
) -> tuple[Array | None, str]:
    """Return the characteristic length (...) and how it was found."""
    if wanted == "none":
        return None, "none: metres and radians as they are"
    if wanted == "auto":
        length = characteristic_length(matrix, turning, task)
        if np.any(length <= _NO_LENGTH * reach):
            raise UsageError(
                "there is no characteristic length: no joint turns, or every axis passes through the point, or no row "
                "that counts is moved by a turn",
                remedy="give --length in m, or --length none",
            )
        rows = " ".join(task.row_names) if task.mixed and task.name == "task" else "all rows"
        return length, f"auto: equal weight of linear and angular parts of turning joints ({rows})"
    try:
        given = float(wanted)
    except (TypeError, ValueError):
        given = float("nan")
    if not _SHORTEST <= given <= _LONGEST:
        raise UsageError(
            f"--length is auto, none, or between {_SHORTEST:g} and {_LONGEST:g} m, not {quote(str(wanted))}",
            remedy="for instance 0.5",
        )
    return np.full(matrix.shape[:-2], given), "given"


def _unit(task: Task, turning: Sequence[bool], length: Array | None, weights: JointWeights | None) -> str:
    speeds = weights is not None and weights.speeds
    return singular_value_unit(task, turning, scaled=length is not None, speeds=speeds)


_FORCE_UNIT = {"m/rad": "N/Nm", "rad/m": "Nm/N", "m/s": "N/W", "rad/s": "Nm/W", "1/s": "s"}


def _usual_ranks(model: Model, velocity: Velocity, columns: Sequence[int], tasks: Sequence[Task]) -> list[int]:
    """Return the largest rank of each task's rows at a few random configurations: what the structure gives it."""
    matrix = sampled_jacobians(model, velocity, columns)
    return [
        int(np.max(_rank(np.linalg.svd(rows, compute_uv=False), rows)))
        for rows in (matrix[..., list(task.rows), :] for task in tasks)
    ]


def _scaled(
    task: Task, matrix: Array, along: Array, turning: Sequence[bool], length: Array | None, *, columns: bool
) -> tuple[Array, Array]:
    """Return the rows of a task of J and of its derivatives, made comparable by the length where they are not.

    `columns`: slides, too, unless weights have made shares of speeds of all columns already.
    """
    rows = list(task.rows)
    matrix, along = matrix[..., rows, :], along[..., rows, :, :]
    if length is None:
        return matrix, along
    size = length[..., None]
    if columns and (task.mixed or len(set(turning)) > 1):  # a slide counts as an angle q / L
        factors = np.where(turning, 1.0, size)
        matrix, along = matrix * factors[..., None, :], along * factors[..., None, :, None]
    if task.mixed:
        lengths = np.where(np.array(rows) < 3, size, 1.0)
        matrix, along = matrix / lengths[..., None], along / lengths[..., None, None]
    return matrix, along


def _block(
    task: Task,
    matrix: Array,
    along: Array,
    turning: Sequence[bool],
    length: Array | None,
    weights: JointWeights | None,
    usual_rank: int,
) -> Block:
    """Return the indices of some rows. Shapes (..., 6, n), (..., 6, n, n)."""
    matrix, along = _scaled(task, matrix, along, turning, length, columns=weights is None or not weights.speeds)
    left, values, right = np.linalg.svd(matrix)
    count = values.shape[-1]
    thin = left[..., :count], right[..., :count, :]
    slopes = np.einsum("...rk,...rij,...ki->...kj", thin[0], along, thin[1], optimize=True)
    unit = _unit(task, turning, length, weights)
    left = pointing_up(left)
    padded = np.concatenate([values, np.zeros((*values.shape[:-1], len(task.rows) - count))], -1)
    largest = values[..., :1]
    zero = padded <= np.maximum(STRICT * largest, ROUNDING)
    with np.errstate(divide="ignore"):
        forces = np.where(zero, np.inf, 1 / padded)
    gradients = _gradients(values, slopes)
    volume = np.prod(values, axis=-1)
    penalised = None
    if weights is not None and weights.penalty is not None and weights.penalty_gradient is not None:
        penalised = volume * weights.penalty
        gradients["penalised"] = (
            gradients["yoshikawa"] * weights.penalty[..., None] + volume[..., None] * weights.penalty_gradient
        )
    return Block(
        task,
        unit,
        _rank(values, matrix),
        usual_rank,
        values,
        volume,
        values[..., -1],
        inverse_condition_number(values),
        isotropy(values),
        Ellipsoid(left, padded, unit),
        Ellipsoid(left, forces, _FORCE_UNIT.get(unit, unit)),
        gradients,
        penalised,
    )


def _rank(values: Any, matrix: Array) -> Array:
    """Return the rank, which no choice of units changes: of the matrix with rows, then columns, of length one."""
    balanced = matrix
    for axis in (-1, -2):
        norms = np.linalg.norm(balanced, axis=axis, keepdims=True)
        balanced = balanced / np.where(norms > STRICT * np.maximum(values[..., :1, None], 1e-300), norms, 1.0)
    found = np.linalg.svd(balanced, compute_uv=False)
    rank: Array = np.sum(found > STRICT * found[..., :1], axis=-1) * (values[..., 0] > ROUNDING)
    return rank


def _gradients(values: Array, slopes: Array) -> dict[str, Array]:
    """Return each index's gradient from the singular values (..., k) and their slopes (..., k, n); NaN at a kink."""
    count = values.shape[-1]
    largest, smallest = values[..., :1], values[..., -1:]
    gap = STRICT * np.maximum(largest, np.finfo(float).tiny)
    singular = smallest <= gap
    second = values[..., -2:-1] if count > 1 else np.full_like(smallest, np.inf)
    repeated = second - smallest <= gap
    first_repeated = largest - values[..., 1:2] <= gap if count > 1 else np.zeros_like(singular)
    others = np.stack([np.prod(np.delete(values, i, axis=-1), axis=-1) for i in range(count)], -1)
    volume = np.einsum("...k,...kj->...j", others, slopes)
    lowest, highest = slopes[..., -1, :], slopes[..., 0, :]
    squares = np.einsum("...k,...kj->...j", values, slopes)
    with np.errstate(divide="ignore", invalid="ignore"):
        condition = (lowest - smallest / largest * highest) / largest
        relative = np.einsum("...k,...kj->...j", 1 / values, slopes)
        total = np.sum(values**2, axis=-1, keepdims=True)
        index = np.prod(values ** (2 / count), axis=-1, keepdims=True) / (total / count)
        isotropy = index * (2 / count * relative - 2 * squares / total)
    kink = singular | repeated
    return {
        "yoshikawa": np.where(singular & (np.abs(second) > gap), np.nan, volume),
        "minimum_singular_value": np.where(kink, np.nan, lowest),
        "inverse_condition_number": np.where(singular, np.nan, np.zeros_like(lowest))
        if count == 1
        else np.where(kink | first_repeated, np.nan, condition),
        "isotropy": np.where(singular, np.nan, isotropy),
    }


def _transmission(
    direction: Sequence[float],
    matrix: Array,
    turning: Sequence[bool],
    length: Array | None,
    weights: JointWeights | None,
) -> Transmission:
    """Return 1/|J^+ u| and 1/|J^T u| of the linear rows."""
    given = _numbers(direction, "--direction takes three finite numbers, not all zero", "for instance 0,0,1")
    largest = float(np.max(np.abs(given), initial=0.0))
    if given.shape != (3,) or not 0 < largest < float("inf"):
        raise UsageError("--direction takes three finite numbers, not all zero", remedy="for instance 0,0,1")
    line = given / largest / np.linalg.norm(given / largest)
    own = weights is None or not weights.speeds
    linear, _ = _scaled(TRANSLATION, matrix, np.zeros((*matrix.shape, 0)), turning, length, columns=own)
    left, values, _ = np.linalg.svd(linear, full_matrices=False)
    along = np.einsum("...rk,r->...k", left, line)
    moving = values > STRICT * np.maximum(values[..., :1], np.finfo(float).tiny)
    reached = np.sum(np.where(moving, along, 0.0) ** 2, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        rates = np.sqrt(np.sum(np.where(moving, along / values, 0.0) ** 2, axis=-1))
        velocity = np.where(1 - reached < STRICT, 1 / rates, 0.0)
        torques = np.linalg.norm(np.einsum("...rj,r->...j", linear, line), axis=-1)
        force = np.where(torques > STRICT * values[..., 0], 1 / torques, np.inf)
    unit = _unit(TRANSLATION, turning, length, weights)
    return Transmission(line, velocity, force, unit, _FORCE_UNIT.get(unit, unit))
