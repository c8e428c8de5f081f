"""Joint rates from a twist: exact, least squares, weighted, damped, with a secondary task; certified."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from kinetostat.analysis.configuration import LARGEST_LENGTH, checked, checked_rates
from kinetostat.analysis.crosscheck import Certificate, certified, length_scale
from kinetostat.analysis.jacobian import labelled, velocity_units
from kinetostat.analysis.task import FULL, Task, turning_columns
from kinetostat.analysis.usual_rank import sampled_jacobians
from kinetostat.analysis.utilisation import most_used
from kinetostat.analysis.weighted_inverse import WeightedInverse
from kinetostat.analysis.weights import fixed_weights
from kinetostat.conventions import Array, Flags, Reference, Velocity
from kinetostat.engines.model import Model
from kinetostat.engines.protocol import Engine
from kinetostat.errors import UsageError, quote
from kinetostat.urdf.description import NO_LIMIT, Joint, Robot

__all__ = ["ResolvedRates", "resolved_rates"]


@dataclass(frozen=True, repr=False)
class ResolvedRates:
    """Joint rates for a twist of a frame.

    Singular values are those of the rows that count: lengths beside angles in units of `length`, and columns by
    `weights`. The two engines are compared in `rates` and `null_rates`; `singular_values`, `residual`, `amplification`
    and `approach` are derived from them and from one engine's Jacobian.

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
        exact: whether the rates give it, but for rounding. (...).
        rank: how many directions the joints can give, (...).
        usual_rank: the rank at almost every configuration; where `rank` is less, the configuration is singular.
        damping: the factor l that singular values were damped with; 0 for none.
        weights: the cost of each column's motion, W, (n,); None for equal ones (slides in units of `length`).
        length: the length L in m that makes metres and radians comparable, of all six rows; 1 where there is none.
            (...).
        has_length: whether there is one: not where no joint turns, or every axis passes through the point. (...).
        singular_values: s, (..., k), largest first.
        unit: unit of the singular values, and of the damping.
        amplification: how many times as large the rates for the twist are as a twist of that size needs in the best
            direction, both as pure numbers. (...).
        approach: rate of the smallest singular value that usually counts, along the rates, in their unit per second:
            negative on the way into a singular configuration; NaN at one. (...).
        secondary: what is done in the null space: "", mid-limits, manipulability or given.
        null_rates: the part of the rates that moves nothing, (..., n).
        limits: velocity limits of the columns, (n,); NaN where the file states none.
        certificate: what the two engines say of the rates and of their part in the null space, as shares of what a
            difference of 1 between Jacobians would do to them, by configuration.
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
    usual_rank: int
    damping: float
    weights: Array | None
    length: Array
    has_length: Flags
    singular_values: Array
    unit: str
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
    def smallest(self) -> Array:
        """The smallest singular value that usually counts, near zero near a singular configuration. (...)."""
        return np.asarray(self.singular_values[..., max(self.usual_rank, 1) - 1])

    @property
    def utilisation(self) -> Array:
        """Rate over velocity limit, in [0, inf); NaN where there is no limit. (..., n)."""
        return np.asarray(np.abs(self.rates) / self.limits)

    @property
    def binding(self) -> Array:
        """Index of the column with the largest utilisation, -1 where none has a limit. (...)."""
        return most_used(self.utilisation)


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
    s / (s^2 + l^2) for 1/s with damping l; lost directions are left out, those in which without weights s is below 1e-9
    of the largest, or below 1e-12 of what entries of J can be. Least squares of rows that mix metres and radians, and
    damping, weigh lengths in units of L (`task.characteristic_length`, of all six rows). Sources: D. Whitney, 1969;
    C. Klein and C. Huang, "Review of pseudoinverse control for use with kinematically redundant manipulators", IEEE
    Trans. SMC 13(2), 1983; Y. Nakamura and H. Hanafusa, "Inverse kinematic solutions with singularity robustness",
    J. Dynamic Systems 108(3), 1986.

    The secondary rates z act in the null space alone, so the twist is not disturbed: towards the middle of position
    limits within a second (z_i = mid_i - q_i, 0 without limits), along the gradient of ln w, w the manipulability of
    the rows that count, or as given. A. Liegeois, IEEE Trans. SMC 7(12), 1977.

    Args:
        model: the robot.
        frame: F, a link.
        q: configurations (..., nq).
        twist: V, (..., 6), linear first, m/s and rad/s; its leading shape and that of q are spread over each other.
        reference: aligned, local or world; see `conventions.Reference`.
        relative_to: A, the observer's link; default the root link.
        expressed_in: E, the link in whose axes V is; default as `reference` says.
        point: the point in F's coordinates, in m; default F's origin.
        axes: the rows that count, such as "x y rz"; default all six.
        weights: W, the cost of each column's motion: numbers, or "limits" (1 / velocity limit squared).
        damping: l, to compare with the singular values, whose unit it has.
        secondary: "mid-limits", "manipulability", or rates of the columns, (n,), rad/s and m/s.

    Raises:
        UnknownNameError: no such frame.
        UsageError: no joint between the frames; axes, twist, weights, damping or secondary that cannot be.
        ConfigurationError: q has another shape, or a number that is not finite; so have secondary rates.
    """
    robot, q, reference = model.robot, checked(model.robot, q), Reference(reference)
    velocity = labelled(robot, frame, reference, relative_to, expressed_in, point)
    task = FULL if axes is None else Task.named(axes)
    joints = robot.moving_joints(velocity.relative_to, velocity.of)
    columns = robot.velocity_columns(joints)
    turning = turning_columns(joints)
    wanted, damping = _checked_twist(twist, q.shape[:-1]), _checked_damping(damping)
    cost = _cost(joints, weights, len(columns))
    reach = robot.reach + float(np.linalg.norm(velocity.point or 0.0))

    def jacobian(engine: Engine) -> Array:
        matrix = engine.jacobian(q, velocity)[..., columns]
        return np.broadcast_to(matrix, (*wanted.shape[:-1], *matrix.shape[-2:]))

    first = jacobian(model.engine)
    inverse = WeightedInverse.at(first, turning, task, cost, reach)
    secondary_rates = _secondary(robot, q, velocity, joints, secondary, inverse)

    z = secondary_rates(model.engine, first)
    found, null = inverse.solved(first, wanted, damping, z)
    ascending = isinstance(secondary, str) and secondary == "manipulability"
    size = inverse.sensitivity(first, wanted, damping, found, z, ascending=ascending)[..., None, None]

    def both(engine: Engine) -> Array:
        if engine is model.engine:  # whose numbers are given
            return np.stack((found, null), -2) / size
        matrix = jacobian(engine)
        return np.stack(inverse.solved(matrix, wanted, damping, secondary_rates(engine, matrix)), -2) / size

    _, certificate = certified(model, both, length_scale(robot, q, velocity.point))
    rates = found + null
    whole = np.zeros((*rates.shape[:-1], robot.nv))
    whole[..., columns] = rates
    residual, rows = np.zeros(wanted.shape), list(task.rows)
    residual[..., rows] = (wanted - (first @ rates[..., None])[..., 0])[..., rows]
    usual = _usual_rank(sampled_jacobians(model, velocity, columns), turning, task, reach)
    return ResolvedRates(
        velocity,
        reference,
        task,
        wanted,
        tuple(name for joint in joints for name in joint.velocity_names),
        tuple(unit for joint in joints for unit in velocity_units(joint)),
        rates,
        whole,
        residual,
        inverse.exact(residual, wanted, rates),
        inverse.rank,
        usual,
        damping,
        cost,
        inverse.length,
        inverse.has_length,
        inverse.values,
        _unit(task, turning, by_limits=isinstance(weights, str)),
        inverse.amplification(found, wanted),
        _approach(inverse, first, model.engine.jacobian_rate(q, whole, velocity)[..., columns], usual),
        secondary if isinstance(secondary, str) else "" if secondary is None else "given",
        null,
        _velocity_limits(joints),
        certificate,
        tuple(_about_secondary(inverse.rank, len(columns), secondary is not None)),
    )


def _checked_twist(twist: Any, shape: tuple[int, ...]) -> Array:
    """Return the twists (..., 6), spread over the leading shape of the configurations."""
    try:
        wanted = np.asarray(twist, dtype=np.float64)
    except (TypeError, ValueError):
        wanted = np.array(math.nan)
    if wanted.ndim == 0 or wanted.shape[-1] != 6 or not np.all(np.abs(wanted) <= LARGEST_LENGTH):
        raise UsageError("a twist has six finite numbers vx vy vz wx wy wz", remedy=f"each within {LARGEST_LENGTH:g}")
    try:
        return np.broadcast_to(wanted, (*np.broadcast_shapes(shape, wanted.shape[:-1]), 6))
    except ValueError:
        raise UsageError(f"twists {wanted.shape} do not go with configurations of shape {shape}") from None


def _checked_damping(damping: Any) -> float:
    try:
        factor = float(damping)
    except (TypeError, ValueError):
        factor = math.nan
    if not 0 <= factor <= LARGEST_LENGTH:
        message = f"damping is 0 or more, not {quote(str(damping))}"
        raise UsageError(message, remedy="compare it with the singular values")
    return factor


def _cost(joints: Sequence[Joint], weights: Any, count: int) -> Array | None:
    """Return W of the columns; None for equal ones."""
    if weights is None:
        return None
    if isinstance(weights, str):
        if weights != "limits":
            raise UsageError(f"there are no weights {quote(weights)}", remedy="limits, or a number for each column")
        return _limit_cost(joints)
    try:
        numbers = [float(number) for number in weights]
    except (TypeError, ValueError):
        remedy = f"there are {count} columns"
        raise UsageError("weights are limits, or a number for each column", remedy=remedy) from None
    return fixed_weights(numbers, count).factors


def _limit_cost(joints: Sequence[Joint]) -> Array:
    """Return 1 / velocity limit squared of each column."""
    limits, remedy = _velocity_limits(joints), "give numbers: --weights a,b,c, one for each column"
    names = [joint.name for joint in joints for _ in range(joint.type.nv)]
    if np.any(np.isnan(limits)):
        lost = names[int(np.argmax(np.isnan(limits)))]
        raise UsageError(f"joint {quote(lost)} has no velocity limit to weigh it by", remedy=remedy)
    try:
        return fixed_weights([float(limit) ** -2 for limit in limits], len(limits)).factors
    except (UsageError, OverflowError):
        odd = int(np.argmax(np.abs(np.log(limits))))
        message = f"joint {quote(names[odd])} has a velocity limit of {limits[odd]:g}, too odd to weigh it by"
        raise UsageError(message, remedy=remedy) from None


def _velocity_limits(joints: Sequence[Joint]) -> Array:
    """Return the velocity limit of each column; NaN where the file states none, or zero."""
    limits = []
    for joint in joints:
        speed = joint.limit.velocity if joint.type.nv == 1 else None
        usable = speed is not None and 0 < speed < math.inf
        limits += [speed if usable and speed is not None else math.nan] * joint.type.nv
    return np.array(limits)


def _usual_rank(matrices: Array, turning: Sequence[bool], task: Task, reach: float) -> int:
    """Return the rank at almost every configuration, counted as at the one that is asked for."""
    return int(np.max(WeightedInverse.at(matrices, turning, task, None, reach).rank))


def _approach(inverse: WeightedInverse, matrix: Array, rate: Array, usual: int) -> Array:
    """Return the rate of the smallest singular value that usually counts; NaN where it is zero. (...)."""
    if usual == 0:
        return np.full(inverse.rank.shape, math.nan)
    return np.where(inverse.rank >= usual, inverse.drift(matrix, rate, usual - 1), math.nan)


def _unit(task: Task, turning: Sequence[bool], *, by_limits: bool) -> str:
    """Return the unit of the singular values: of rows that count, for one unit of rate (or one share of its limit)."""
    rows = "1" if task.mixed else "m" if task.linear else "rad"
    if by_limits:
        return f"{rows}/s"
    return "m/rad" if rows == "m" and any(turning) else "1"


def _secondary(
    robot: Robot, q: Array, velocity: Velocity, joints: Sequence[Joint], wanted: Any, inverse: WeightedInverse
) -> Callable[[Engine, Array], Array]:
    """Return what gives the secondary rates z (..., n) by an engine and its Jacobian; zero without a secondary task."""
    columns = robot.velocity_columns(joints)
    if isinstance(wanted, str) and wanted == "manipulability":
        units = np.eye(robot.nv)[columns]

        def ascent(engine: Engine, matrix: Array) -> Array:
            along = engine.jacobian_rate(q[..., None, :], units, velocity)[..., columns]
            return inverse.ascent(matrix, along)

        return ascent
    fixed = np.broadcast_to(_fixed_rates(robot, q, joints, wanted), inverse.columns.shape)

    def given(_engine: Engine, _matrix: Array) -> Array:
        return fixed

    return given


def _fixed_rates(robot: Robot, q: Array, joints: Sequence[Joint], wanted: Any) -> Array:
    """Return secondary rates that no engine is needed for, (n,) or (..., n)."""
    columns = robot.velocity_columns(joints)
    if wanted is None:
        return np.zeros(len(columns))
    if isinstance(wanted, str):
        if wanted == "mid-limits":
            return np.stack([_towards_middle(robot, joint, q) for joint in joints for _ in range(joint.type.nv)], -1)
        remedy = "mid-limits, manipulability, or a rate for each column"
        raise UsageError(f"there is no secondary task {quote(wanted)}", remedy=remedy)
    try:
        given = np.asarray(wanted, dtype=np.float64)
    except (TypeError, ValueError):
        given = np.array(math.nan)
    if given.shape != (len(columns),):
        count = f"{len(columns)} rates here, one for each column"
        raise UsageError(f"--secondary takes {count}", remedy="or mid-limits, or manipulability")
    whole = np.zeros(robot.nv)
    whole[columns] = given
    return checked_rates(robot, whole, q.shape[:-1])[columns]


def _towards_middle(robot: Robot, joint: Joint, q: Array) -> Array:
    """Return the rate that would bring a joint to the middle of its limits in a second; 0 without limits. (...)."""
    if joint.type.nq != 1 or not max(map(abs, joint.limit.range)) < NO_LIMIT:
        return np.zeros(q.shape[:-1])
    middle: Array = sum(joint.limit.range) / 2 - q[..., robot.position_slices[joint.name].start]
    return middle


def _about_secondary(rank: Array, count: int, asked: bool) -> list[str]:
    """Return the warning that a secondary task has no effect, if it has none anywhere."""
    if asked and rank.size and np.all(rank >= count):
        return ["there is no null space here: the secondary task has no effect"]
    return []
