"""Joint rates from a twist: exact, least squares, weighted, damped, with a secondary task; certified."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinetostat.analysis.configuration import LARGEST_LENGTH, checked, checked_rates
from kinetostat.analysis.crosscheck import Certificate, certified, length_scale
from kinetostat.analysis.jacobian import labelled, velocity_units
from kinetostat.analysis.task import FULL, Task, characteristic_length, turning_columns
from kinetostat.analysis.weights import fixed_weights
from kinetostat.conventions import Array, Flags, Reference, Velocity
from kinetostat.engines.model import Model
from kinetostat.engines.protocol import Engine
from kinetostat.errors import UsageError, quote
from kinetostat.urdf.description import Joint, Robot

__all__ = ["ResolvedRates", "resolved_rates"]

_STRICT = 1e-9  # of the largest singular value: below it a direction is lost
_EXACT = 1e-9  # of the twist: a residual below it is rounding
_NO_LENGTH = 1e-9  # of the robot's reach


@dataclass(frozen=True, repr=False)
class ResolvedRates:
    """Joint rates for a twist of a frame.

    Singular values are those of the rows that count, as pure numbers: lengths in units of `length`, and columns by
    `weights`.

    Attributes:
        velocity: which velocity the twist is.
        reference: the shorthand that it was asked by.
        task: the rows that count, m of them.
        twist: the wanted one, (..., 6), m/s and rad/s; rows that do not count are not looked at.
        columns: names of the joints between the two frames.
        column_units: units of their rates.
        rates: dq/dt, (..., n).
        whole: rates of all of the robot's velocity coordinates, zero where joints do not move the frame. (..., nv).
        residual: the wanted twist less the one that the rates give, (..., 6); zero in rows that do not count.
        exact: whether the rates give it. (...).
        rank: how many directions the joints can give, (...).
        damping: the factor l that singular values were damped with; 0 for none.
        weights: the cost of each column's motion, W, (n,); None for equal ones (slides in units of `length`).
        length: the length L in m that makes metres and radians comparable; (...).
        singular_values: s, (..., k), largest first.
        amplification: how many times as large the rates are as a twist of that size needs in the best direction. (...).
        approach: d s_k / dt along the rates, 1/s: negative on the way into a singular configuration. (...).
        secondary: what is done in the null space: "", mid-limits, manipulability or given.
        null_rates: the part of the rates that moves nothing, (..., n).
        limits: velocity limits of the columns, (n,); NaN where the file states none.
        certificate: what the two engines say of the rates, as shares of what rounding does to them.
        warnings: what is to be said of it.
    """

    velocity: Velocity
    reference: Reference
    task: Task
    twist: Array
    columns: tuple[str, ...]
    column_units: tuple[str, ...]
    rates: Array
    whole: Array
    residual: Array
    exact: Flags
    rank: Array
    damping: float
    weights: Array | None
    length: Array
    singular_values: Array
    amplification: Array
    approach: Array
    secondary: str
    null_rates: Array
    limits: Array
    certificate: Certificate
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<ResolvedRates {quote(self.velocity.of)}: {len(self.columns)} joints, batch {self.exact.shape}>"

    @property
    def utilisation(self) -> Array:
        """Rate over velocity limit, in [0, inf); NaN where there is no limit. (..., n)."""
        return np.asarray(np.abs(self.rates) / self.limits)

    @property
    def binding(self) -> Array:
        """Index of the column with the largest utilisation, -1 where none has a limit. (...)."""
        used = self.utilisation
        return np.where(np.all(np.isnan(used), -1), -1, np.argmax(np.nan_to_num(used, nan=-1.0), -1))


def resolved_rates(
    model: Model,
    frame: str,
    q: Array,
    twist: Sequence[float] | Array,
    *,
    reference: Reference | str = Reference.ALIGNED,
    relative_to: str | None = None,
    expressed_in: str | None = None,
    point: Sequence[float] | None = None,
    axes: str | Sequence[str] | None = None,
    weights: Literal["limits"] | Sequence[float] | None = None,
    damping: float = 0.0,
    secondary: Literal["mid-limits", "manipulability"] | Sequence[float] | Array | None = None,
) -> ResolvedRates:
    """Return joint rates that give a frame a twist, or come as near to it as they can.

        dq/dt = J_W^+ V + (1 - J_W^+ J) z,   J_W^+ = W^-1 J^T (J W^-1 J^T)^-1 at full rank

    of all rates with the least residual those with the least dq^T W dq. By singular values: J W^-1/2 = U diag(s) V^T,
    lost directions (s below 1e-9 of the largest) left out, s / (s^2 + l^2) for 1/s with damping l. Least squares of
    rows that mix metres and radians, and damping, weigh lengths in units of L (`task.characteristic_length`). Sources:
    D. Whitney, 1969; C. Klein and C. Huang, "Review of pseudoinverse control for use with kinematically redundant
    manipulators", IEEE Trans. SMC 13(2), 1983; Y. Nakamura and H. Hanafusa, "Inverse kinematic solutions with
    singularity robustness", J. Dynamic Systems 108(3), 1986.

    The secondary rates z act in the null space alone, so the twist is not disturbed: towards the middle of position
    limits within a second (z_i = mid_i - q_i), along the gradient of ln w, w the manipulability of the rows that count,
    or as given.

    Args:
        model: the robot.
        frame: F, a link.
        q: configurations (..., nq).
        twist: V, (..., 6), linear first, m/s and rad/s.
        reference: aligned, local or world; see `conventions.Reference`.
        relative_to: A, the observer's link; default the root link.
        expressed_in: E, the link in whose axes V is; default as `reference` says.
        point: the point in F's coordinates, in m; default F's origin.
        axes: the rows that count, such as "x y rz"; default all six.
        weights: W, the cost of each column's motion: numbers, or "limits" (1 / velocity limit squared).
        damping: l, a pure number to compare with singular values.
        secondary: "mid-limits", "manipulability", or rates of the columns, (n,), rad/s and m/s.

    Raises:
        UnknownNameError: no such frame.
        UsageError: no joint between the frames; axes, twist, weights, damping or secondary that cannot be.
        ConfigurationError: q has another shape, or a number that is not finite.
    """
    robot, q, reference = model.robot, checked(model.robot, q), Reference(reference)
    velocity = labelled(robot, frame, reference, relative_to, expressed_in, point)
    task = FULL if axes is None else Task.named(axes)
    joints = robot.moving_joints(velocity.relative_to, velocity.of)
    columns = robot.velocity_columns(joints)
    turning = turning_columns(joints)
    wanted = _checked_twist(twist, q.shape[:-1])
    if not 0 <= damping <= LARGEST_LENGTH:
        raise UsageError(f"damping is 0 or more, not {damping:g}", remedy="compare it with the singular values")
    cost = _cost(joints, weights, len(columns))
    first = model.engine.jacobian(q, velocity)[..., columns]
    frozen = _Frozen.at(robot, first, turning, task, cost)
    z = _secondary(model, q, velocity, columns, joints, secondary, frozen)

    def both(engine: Engine) -> Array:
        found, null = frozen.solved(engine.jacobian(q, velocity)[..., columns], wanted, damping, z)
        return np.stack([found, null], -2) / frozen.size(wanted, z)[..., None, None]

    shares, certificate = certified(model, both, length_scale(robot, q, velocity.point))
    rates = shares * frozen.size(wanted, z)[..., None, None]
    found, null = rates[..., 0, :] + rates[..., 1, :], rates[..., 1, :]
    whole = np.zeros((*found.shape[:-1], robot.nv))
    whole[..., columns] = found
    residual = np.zeros((*found.shape[:-1], 6))
    rows = list(task.rows)
    residual[..., rows] = (wanted - (first @ found[..., None])[..., 0])[..., rows]
    return ResolvedRates(
        velocity,
        reference,
        task,
        wanted,
        tuple(name for joint in joints for name in joint.velocity_names),
        tuple(unit for joint in joints for unit in velocity_units(joint)),
        found,
        whole,
        residual,
        frozen.small(residual, wanted),
        frozen.rank,
        float(damping),
        cost,
        frozen.length,
        frozen.values,
        frozen.amplification(found - null, wanted),
        frozen.drift(model, q, velocity, columns, whole),
        secondary if isinstance(secondary, str) else "" if secondary is None else "given",
        null,
        _velocity_limits(joints),
        certificate,
        tuple(_about_secondary(frozen, secondary is not None)),
    )


def _checked_twist(twist: Sequence[float] | Array, shape: tuple[int, ...]) -> Array:
    wanted = np.asarray(twist, dtype=np.float64)
    if wanted.ndim == 0 or wanted.shape[-1] != 6 or not np.all(np.abs(wanted) <= LARGEST_LENGTH):
        raise UsageError("a twist has six finite numbers vx vy vz wx wy wz", remedy=f"each within {LARGEST_LENGTH:g}")
    try:
        return np.broadcast_to(wanted, (*np.broadcast_shapes(shape, wanted.shape[:-1]), 6))
    except ValueError:
        raise UsageError(f"twists {wanted.shape} do not go with configurations of shape {shape}") from None


def _cost(joints: Sequence[Joint], weights: str | Sequence[float] | None, count: int) -> Array | None:
    """Return W of the columns; None for equal ones."""
    if weights is None:
        return None
    if not isinstance(weights, str):
        return fixed_weights(weights, count).factors
    if weights != "limits":
        raise UsageError(f"there are no weights {quote(weights)}", remedy="limits, or a number for each column")
    limits = _velocity_limits(joints)
    if np.any(np.isnan(limits)):
        lost = [joint.name for joint in joints for _ in range(joint.type.nv)][int(np.argmax(np.isnan(limits)))]
        message = f"joint {quote(lost)} has no velocity limit to weigh it by"
        raise UsageError(message, remedy="give numbers: --weights a,b,c, one for each column")
    cost: Array = 1 / limits**2
    return cost


def _velocity_limits(joints: Sequence[Joint]) -> Array:
    """Return the velocity limit of each column; NaN where the file states none, or zero."""
    limits = []
    for joint in joints:
        speed = joint.limit.velocity if joint.type.nv == 1 else None
        usable = speed is not None and 0 < speed < math.inf
        limits += [speed if usable and speed is not None else math.nan] * joint.type.nv
    return np.array(limits)


@dataclass(frozen=True)
class _Frozen:
    """What is decided once, by the first engine, so that both solve the same problem: units, and the rank.

    Attributes:
        task: the rows that count.
        length: L, (...).
        columns: W^-1/2, with slides in units of L where there is no W. (..., n).
        values: singular values of the scaled rows, (..., k).
        rank: how many count, (...).
    """

    task: Task
    length: Array
    columns: Array
    values: Array
    rank: Array

    @classmethod
    def at(cls, robot: Robot, matrix: Array, turning: Sequence[bool], task: Task, cost: Array | None) -> _Frozen:
        """Return what the Jacobian (..., 6, n) decides."""
        length = characteristic_length(matrix, turning, task)
        length = np.where(length > _NO_LENGTH * robot.reach, length, 1.0)
        columns = np.where(turning, 1.0, length[..., None]) if cost is None else 1 / np.sqrt(cost)
        columns = np.broadcast_to(columns, (*matrix.shape[:-2], matrix.shape[-1]))
        draft = cls(task, length, columns, np.zeros(0), np.zeros(0))
        values: Array = np.asarray(np.linalg.svd(draft.scaled(matrix), compute_uv=False), dtype=np.float64)
        return cls(task, length, columns, values, np.sum(values > _STRICT * values[..., :1], axis=-1))

    def scaled(self, matrix: Array) -> Array:
        """Return the rows that count of a Jacobian (..., 6, n) as pure numbers. (..., m, n)."""
        rows: Array = matrix[..., list(self.task.rows), :] * self.columns[..., None, :]
        return rows / self._units[..., None]

    @property
    def _units(self) -> Array:
        """What a unit of each row that counts is: L, or 1 rad; 1 m where no row is an angle. (..., m)."""
        linear = np.array(self.task.rows) < 3
        return np.where(linear & self.task.mixed, self.length[..., None], 1.0)

    def solved(self, matrix: Array, twist: Array, damping: float, z: Array) -> tuple[Array, Array]:
        """Return the rates for the twist, and those of the secondary task in the null space. (..., n), (..., n)."""
        left, values, right = np.linalg.svd(self.scaled(matrix), full_matrices=False)
        counted = np.arange(values.shape[-1]) < self.rank[..., None]
        inverse = np.where(counted, values / np.where(counted, values**2 + damping**2, 1.0), 0.0)
        goal = twist[..., list(self.task.rows)] / self._units
        parts = (np.swapaxes(left, -1, -2) @ goal[..., None])[..., 0] * inverse
        found = (np.swapaxes(right, -1, -2) @ parts[..., None])[..., 0] * self.columns
        free = z / self.columns
        seen = np.where(counted, (right @ free[..., None])[..., 0], 0.0)
        null = (free - (np.swapaxes(right, -1, -2) @ seen[..., None])[..., 0]) * self.columns
        return found, null

    @property
    def smallest(self) -> Array:
        """The smallest singular value that counts, (...)."""
        last = np.maximum(self.rank - 1, 0)[..., None]
        return np.take_along_axis(self.values, last, -1)[..., 0]

    def size(self, twist: Array, z: Array) -> Array:
        """Return the size of what rounding of J does to the rates, in its own units: 1 + |V| / s + ... (...)."""
        goal = np.linalg.norm(twist[..., list(self.task.rows)] / self._units, axis=-1)
        steep = 1 + 1 / np.where(self.rank > 0, self.smallest, 1.0)
        largest = np.max(self.columns, axis=-1) * max(1.0, float(np.max(self.values, initial=0.0)))
        free = np.linalg.norm(z / self.columns, axis=-1)
        grown: Array = np.maximum(1.0, largest * steep * (steep * goal + free))
        return grown

    def small(self, residual: Array, twist: Array) -> Flags:
        """Return whether a residual is what rounding leaves. (..., 6), (..., 6) -> (...)."""
        rows = list(self.task.rows)
        left = np.linalg.norm(residual[..., rows] / self._units, axis=-1)
        asked = np.linalg.norm(twist[..., rows] / self._units, axis=-1)
        return np.asarray(
            left <= _EXACT * np.maximum(asked, 1e-300) * (1 + 1 / np.where(self.rank > 0, self.smallest, 1.0))
        )

    def amplification(self, rates: Array, twist: Array) -> Array:
        """Return |rates| s_1 / |V|, in their units: 1 in the direction that needs least. (...)."""
        size = np.linalg.norm(rates / self.columns, axis=-1)
        asked = np.linalg.norm(twist[..., list(self.task.rows)] / self._units, axis=-1)
        return np.where(asked > 0, size * self.values[..., 0] / np.where(asked > 0, asked, 1.0), 0.0)

    def drift(self, model: Model, q: Array, velocity: Velocity, columns: Sequence[int], whole: Array) -> Array:
        """Return ds_k/dt = u_k^T (dJ/dt) v_k along the rates, the units held. (...)."""
        rate = self.scaled(model.engine.jacobian_rate(q, whole, velocity)[..., columns])
        left, _, right = np.linalg.svd(
            self.scaled(model.engine.jacobian(q, velocity)[..., columns]), full_matrices=False
        )
        drift: Array = np.einsum("...r,...rc,...c->...", left[..., -1], rate, right[..., -1, :])
        return drift


def _secondary(
    model: Model,
    q: Array,
    velocity: Velocity,
    columns: Sequence[int],
    joints: Sequence[Joint],
    wanted: str | Sequence[float] | Array | None,
    frozen: _Frozen,
) -> Array:
    """Return the secondary rates z, (..., n); zero without a secondary task."""
    robot, count = model.robot, len(columns)
    if wanted is None:
        return np.zeros(count)
    if not isinstance(wanted, str):
        given = np.asarray(wanted, dtype=np.float64)
        if given.shape != (count,):
            raise UsageError(f"--secondary takes {count} rates here, one for each column, not {given.size}")
        whole = np.zeros(robot.nv)
        whole[list(columns)] = given
        return checked_rates(robot, whole, q.shape[:-1])[list(columns)]
    if wanted == "mid-limits":
        return np.stack([_towards_middle(robot, joint, q) for joint in joints for _ in range(joint.type.nv)], -1)
    if wanted != "manipulability":
        remedy = "mid-limits, manipulability, or a rate for each column"
        raise UsageError(f"there is no secondary task {quote(wanted)}", remedy=remedy)
    along = model.engine.jacobian_rate(q[..., None, :], np.eye(robot.nv)[list(columns)], velocity)[..., columns]
    scaled = np.stack([frozen.scaled(along[..., k, :, :]) for k in range(count)], -1)  # (..., m, n, n)
    matrix = frozen.scaled(model.engine.jacobian(q, velocity)[..., columns])
    # d ln w = sum of ds_i / s_i = trace(J^+ dJ), over the singular values that count.
    gradient: Array = np.einsum("...cr,...rck->...k", np.linalg.pinv(matrix, rcond=_STRICT), scaled)
    return gradient * frozen.columns**2  # the steepest ascent where the cost of motion is W


def _towards_middle(robot: Robot, joint: Joint, q: Array) -> Array:
    """Return the rate that would bring a joint to the middle of its limits in a second; 0 without limits."""
    lower, upper = joint.limit.range
    if joint.type.nq != 1 or not math.isfinite(upper - lower):
        return np.zeros(q.shape[:-1])
    middle: Array = (lower + upper) / 2 - q[..., robot.position_slices[joint.name].start]
    return middle


def _about_secondary(frozen: _Frozen, asked: bool) -> list[str]:
    if asked and np.all(frozen.rank >= frozen.columns.shape[-1]):
        return ["there is no null space here: the secondary task has no effect"]
    return []
