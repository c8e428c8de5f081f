"""A joint trajectory, sample by sample, and where it is to be looked at: near singularities and beyond limits."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from kinetostat.analysis.configuration import LARGEST_LENGTH, checked
from kinetostat.analysis.coordinates import Coordinates, coordinates
from kinetostat.analysis.crosscheck import Certificate
from kinetostat.analysis.indices import NEAR, inverse_condition_number
from kinetostat.analysis.kernels import chain_kernel
from kinetostat.analysis.loads import Payload, checked_gravity, effort_limits
from kinetostat.analysis.singular.at import remarks
from kinetostat.analysis.singular.mechanism import Mechanism, mechanism
from kinetostat.analysis.trajectory.differences import accelerations, mean_rates, rates
from kinetostat.analysis.trajectory.joints import moved_joints, speed_limits, unwound
from kinetostat.analysis.trajectory.near import NearSpan, near_spans
from kinetostat.analysis.trajectory.timeline import Timeline, certificate, timeline
from kinetostat.analysis.trajectory.violations import Violation, violations
from kinetostat.analysis.typical_length import asked_length, unit_with_length
from kinetostat.conventions import Array, Flags, Reference, Velocity
from kinetostat.engines.model import Model
from kinetostat.errors import ConfigurationError, UsageError, quote
from kinetostat.screw.kernel import effort_use

__all__ = ["Trajectory", "trajectory"]

_ALL = 2000  # samples that both engines compute, at most
_MIXED = (
    "m and rad are mixed: such numbers depend on the unit of length (--length auto, or a length in m, makes them "
    "comparable)"
)

Progress = Callable[[str, float], None]


@dataclass(frozen=True, repr=False)
class Trajectory:
    """What is to be said of m samples of a trajectory of n joints, those of the chain first.

    Attributes:
        mechanism: the chain, the rows that count, its generic rank r.
        velocity: which velocity the twist is: of which point, relative to which observer, in which axes.
        joints: the chain's joints, then others that move.
        time: increasing, s, (m,); None if there is none, or one sample.
        q: positions, rad and m, continuous joints going on by the shorter way. (m, n).
        unwound: the continuous joints that are written into one turn, and were continued.
        length: the characteristic length L in m: linear rows count in units of it where rows mix m and rad, slides as
            angles q / L beside turns; None where nothing is mixed, or m and rad are mixed as they are.
        length_reference: how it was found, or why there is none.
        near: the threshold of s_r / s_1.
        gravity: (3,), m/s2, in the root's axes.
        payload: the mass that weighs with the links, or None.
        limits: effort limits of joints that were given instead of the file's.
        at: tool pose, singular values, twist, torques, distance to limits, of every sample.
        speed_limits: of the joints, NaN for none. (n,), rad/s and m/s.
        effort_limits: lower and upper, NaN for none. (2, n), Nm and N.
        spans: stretches near a singular configuration.
        violations: stretches beyond limits.
        computed: how many samples both engines have computed.
        certificate: what they, and the kernel that computes all samples, say of those.
        warnings: what is to be said of it.
    """

    mechanism: Mechanism
    velocity: Velocity
    joints: Coordinates
    time: Array | None
    q: Array
    unwound: tuple[str, ...]
    length: float | None
    length_reference: str
    near: float
    gravity: Array
    payload: Payload | None
    limits: Mapping[str, float | tuple[float, float]]
    at: Timeline
    speed_limits: Array
    effort_limits: Array
    spans: tuple[NearSpan, ...]
    violations: tuple[Violation, ...]
    computed: int
    certificate: Certificate
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        found = f"{len(self.spans)} spans near singular, {len(self.violations)} violations"
        return f"<Trajectory of {quote(self.velocity.of)}: {len(self.q)} samples, {found}>"

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the joints."""
        return self.joints.names

    @cached_property
    def rates(self) -> Array | None:
        """Joint rates by finite differences, rad/s and m/s; see `differences.rates`. (m, n), None without time."""
        return None if self.time is None else rates(self.time, self.q)

    @cached_property
    def accelerations(self) -> Array | None:
        """Joint accelerations; see `differences.accelerations`. (m, n), rad/s2 and m/s2; None without time."""
        return None if self.time is None else accelerations(self.time, self.q)

    @cached_property
    def speed_use(self) -> Array | None:
        """Size of the mean rate of each step over the velocity limit, NaN where there is none. (m - 1, n)."""
        if self.time is None:
            return None
        used: Array = np.abs(mean_rates(self.time, self.q)) / self.speed_limits
        return used

    @cached_property
    def effort_use(self) -> Array | None:
        """Holding torque over the effort limit in its direction, NaN where there is none. (m, n)."""
        if self.at.torque is None:
            return None
        return effort_use(self.at.torque, self.effort_limits)

    @cached_property
    def yoshikawa(self) -> Array:
        """The product s_1 ... s_r. (m,)."""
        product: Array = np.prod(self.at.singular_values[:, : self.mechanism.generic_rank], axis=-1)
        return product

    @property
    def minimum_singular_value(self) -> Array:
        """s_r, r the rank at almost every configuration. (m,)."""
        smallest: Array = self.at.singular_values[:, self.mechanism.generic_rank - 1]
        return smallest

    @cached_property
    def inverse_condition_number(self) -> Array:
        """s_r / s_1 in [0, 1], 0 where s_1 is 0. (m,)."""
        return inverse_condition_number(self.at.singular_values[:, : self.mechanism.generic_rank])

    @cached_property
    def tool_speed(self) -> Array | None:
        """Speed of the tool point, m/s. (m,), None without time."""
        return None if self.at.twist is None else np.linalg.norm(self.at.twist[:, :3], axis=-1)

    @cached_property
    def turning_speed(self) -> Array | None:
        """Speed at which the tool turns, rad/s. (m,), None without time."""
        return None if self.at.twist is None else np.linalg.norm(self.at.twist[:, 3:], axis=-1)

    @property
    def unit(self) -> str:
        """Unit of a singular value: of rows over columns."""
        return unit_with_length(self.mechanism.task, self.mechanism.turning, self.length, self.length_reference)

    @property
    def speed_unit(self) -> str:
        """Unit of the speed along the rows that count; turns count as arcs of radius `length` beside translations."""
        task = self.mechanism.task
        if task.mixed and self.length is None:
            return "mixed"
        return "m/s" if task.linear else "rad/s"

    @property
    def near_share(self) -> float:
        """Share of the samples that are near a singular configuration."""
        return float(np.mean(self.inverse_condition_number < self.near))


def trajectory(
    model: Model,
    frame: str,
    q: Array,
    time: Array | None = None,
    *,
    relative_to: str | None = None,
    point: Sequence[float] | None = None,
    reference: Reference | str = Reference.ALIGNED,
    axes: str | Sequence[str] | None = None,
    length: float | Literal["auto", "none"] = "auto",
    gravity: Sequence[float] | Array | bool = True,
    payload: Payload | None = None,
    limits: Mapping[str, float | tuple[float, float]] | None = None,
    near: float = NEAR,
    progress: Progress | None = None,
) -> Trajectory:
    """Return what is to be said of a trajectory: every sample, the stretches near a singularity, those beyond limits.

    Of every sample the tool's pose, the singular values of its Jacobian's rows that count, the torques that hold the
    robot still (static: what accelerations take is not counted), the distance to position limits; with time the rates
    by finite differences (`differences.rates`, of second order on uneven steps) and the tool's twist V = J qdot.

    A sample is near a singular configuration if s_r / s_1 < `near`, r being the rank at almost every configuration.
    Its cause is that of the nearest singular configuration (`singular_at`). With time, qdot = v_r |V| / s_r are the
    rates that keep the tool's speed there in the direction that is hardest.

    Args:
        model: the robot.
        frame: the tool's frame, a link.
        q: configurations of the whole robot, at least one. (m, nq).
        time: increasing, s, (m,); None if it is not known: nothing is then said of velocities.
        relative_to: the observer's link; default the root link.
        point: the tool point in the frame's coordinates, in m; default its origin.
        reference: aligned, rows in the observer's axes; or local, in the axes of the tool's frame.
        axes: the rows that count, such as "x y rz"; default as for `singular_at`: all six, or the linear ones where
            three joints or fewer move the point.
        length: what makes metres and radians comparable, in m, where they meet: "auto", one length for all
            configurations of the arm (`typical_length`), or "none": mix them.
        gravity: True (9.81 m/s2 down the root's z) or a vector (3,); zero leaves torques out.
        payload: a mass that weighs with the links.
        limits: effort limits of joints instead of the file's.
        near: see above.
        progress: told what is done, and how much of it.

    Raises:
        UnknownNameError: no such frame or joint.
        UsageError: no joint between the frames, a floating joint that moves; axes, length, gravity, payload, limits
            that cannot be; a threshold outside (0, 1); time that does not increase.
        ConfigurationError: q has another shape, or none; a number that is not finite.
        NumberError: a link's mass is negative, and gravity counts.
    """
    if not 0 < near < 1:
        raise UsageError(f"the threshold of s_r / s_1 is between 0 and 1, not {near:g}", remedy="for instance 0.01")
    robot, q = model.robot, checked(model.robot, q)
    if q.ndim != 2 or not len(q):
        raise ConfigurationError("a trajectory has one sample or more", remedy=f"an array (m, {robot.nq})")
    time = _checked_time(time, len(q))
    q, turned = unwound(model, q)
    asked = {"relative_to": relative_to, "point": point, "axes": axes, "reference": reference}
    arm = mechanism(model, frame, **asked)  # type: ignore[arg-type]
    observer = arm.velocity.relative_to
    label = Velocity.by_reference(Reference(reference), arm.velocity.of, observer, point=arm.point)
    chain = coordinates(model, arm.velocity.of, observer, arm.point)
    joints, (size, found_by) = moved_joints(chain, q), asked_length(chain, arm.task, length)
    size = size if arm.task.mixes(arm.turning) else None
    down, n = checked_gravity(gravity), len(chain.names)
    outputs = ["placement", "singular_values", "jacobian"]
    tool = chain_kernel(chain, outputs, q[0], task=arm.task, length=size, local=arm.local, gravity=False)
    weighs = ["gravity_torque"] if np.any(down) else []
    loaded = chain_kernel(
        joints, ["limit_distance", *weighs], q[0], gravity=down, payload=payload if weighs else None, limits=limits
    )
    positions = q[:, list(joints.indices)]
    slopes = None if time is None else rates(time, positions)
    if slopes is not None and not np.all(np.abs(slopes) <= LARGEST_LENGTH):
        raise UsageError(f"a joint's rate is beyond {LARGEST_LENGTH:g}", remedy="check the unit of time")
    say: Progress = progress or (lambda _, __: None)
    at = timeline(tool, loaded, positions, slopes, lambda done: say("samples", 0.8 * done / len(q)))
    below = inverse_condition_number(at.singular_values[:, : arm.generic_rank]) < near
    speeds = _speeds(at.twist, arm, size)

    spans = near_spans(
        arm, tool, positions[:, :n], at.singular_values, below, speeds, q, asked, lambda _: say("causes", 0.9)
    )
    given = effort_limits(robot, limits)
    columns = robot.velocity_columns(dict.fromkeys(joints.joints))
    efforts, fastest = np.stack([given.lower[columns], given.upper[columns]]), speed_limits(joints)
    steps = None if time is None else mean_rates(time, positions)
    beyond = violations(joints, positions, steps, fastest, at.torque, efforts)
    shown = _sample(len(q), [span.worst for span in spans])
    proof = certificate(model, tool, loaded, joints, label, q[shown], len(q), payload)
    warnings = [_MIXED] if length == "none" and arm.task.mixes(arm.turning) else []
    return Trajectory(
        arm,
        label,
        joints,
        time,
        positions,
        turned,
        size,
        found_by,
        near,
        down,
        payload,
        dict(limits or {}),
        at,
        fastest,
        efforts,
        spans,
        beyond,
        0 if model.witness is None else int(np.sum(shown)),
        proof,
        (*remarks(arm), *warnings),
    )


def _checked_time(time: Array | None, count: int) -> Array | None:
    if time is None:
        return None
    found = np.asarray(time, dtype=np.float64)
    if found.shape != (count,) or not np.all(np.isfinite(found)) or not np.all(np.diff(found) > 0):
        raise UsageError("time is one finite number for each sample, each after the one before", remedy="in s")
    return found if count > 1 else None


def _speeds(twist: Array | None, arm: Mechanism, length: float | None) -> Array | None:
    """Return the size of the rows that count, turns as arcs of radius L. (m, 6) -> (m,)."""
    if twist is None:
        return None
    factors = np.array([1.0] * 3 + [length or 1.0] * 3)
    counted = (twist * (factors if arm.task.mixed else 1.0))[:, arm.task.rows]
    return np.asarray(np.linalg.norm(counted, axis=-1), dtype=np.float64)


def _sample(count: int, worst: Sequence[int]) -> Flags:
    """Return the samples that both engines compute: all, or some equally far apart and the worst of each span."""
    if count <= _ALL:
        return np.ones(count, dtype=bool)
    chosen = np.zeros(count, dtype=bool)
    chosen[np.linspace(0, count - 1, _ALL).astype(np.int64)] = True
    chosen[list(worst[:_ALL])] = True
    return chosen
