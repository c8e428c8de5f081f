"""The way into a singular configuration: what degrades on it, and what does not; certified.

The Jacobian stays bounded, so joint errors make no larger tool errors there than elsewhere. What grows is the joint
motion that moves the tool in the direction that is being lost, as 1/s: a correction of the tool takes ever more of it,
a tool speed takes ever faster joints, and by duality an error in torque reads as an ever larger error in force.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.configuration import checked
from kinetostat.analysis.crosscheck import Certificate, certified, length_scale
from kinetostat.analysis.joint_errors import UNIT_ERROR, JointErrors, joint_errors
from kinetostat.analysis.singular.at import singular_at
from kinetostat.analysis.singular.mechanism import MODEL, STRICT, Mechanism, mechanism
from kinetostat.analysis.zonotope import farthest
from kinetostat.conventions import Array, Reference, Velocity
from kinetostat.engines.model import Model
from kinetostat.engines.protocol import Engine
from kinetostat.errors import ConfigurationError, UsageError, quote

__all__ = ["SingularApproach", "singular_approach"]

_DECADES = 3  # of the distance that is left, towards the end
_MANTISSAS = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.15)
_HERE = 1e-9  # rad: a way that is shorter is none


@dataclass(frozen=True, repr=False)
class SingularApproach:
    """What happens on the way from a configuration into a singular one, straight in joint space, at k steps.

    The rows that count are of a small motion of the tool, in m, angles (if rows mix both) times the length L; joint
    motions are in rad, slides in units of L. With u and v the singular vectors of the smallest singular value s, u is
    the direction in which the tool moves worst, v / s the joint motion that moves it there by one unit.

    Attributes:
        mechanism: the chain, with the rows that count and its rank r almost everywhere.
        velocity: of which point, relative to which observer, expressed in which axes.
        unit: of the tool's motion: m, or rad where only turns count.
        length: L, in m.
        names: names of the n joints.
        start: the configuration where the way starts. (nq,).
        end: where it ends. (nq,).
        shares: shares of the way that are left: 1, ..., 0. (k,).
        remaining: joint-space distances that are left, rad. (k,).
        smallest: s, the r-th singular value, m/rad (or 1); 0 where it vanishes but for rounding. (k,).
        directions: u, in the rows that count (k, m).
        joint_error: d, as for `tool_error`, in rad and m. (n,).
        worst: the largest position error that joint errors make in the rows that count, m (rotation error in rad, where
            only turns count). (k,).
        sigma: its root mean square, for independent errors with those standard deviations. (k,).
        motion: |v / s|: joint motion per unit of tool motion, rad/m (or 1), which is also the force error in N for a
            torque error of 1 Nm; infinite where s is 0. (k,).
        speed: the tool speed that is asked for, in m/s (or rad/s).
        rates: the joint rates of that speed in the worst direction, rad/s and m/s; infinite at the end. (k, n).
        limits: velocity limits of the joints, also by those of their followers, infinite where none is stated. (n,).
        certificate: what the two engines say of the rows and of their singular values.
        warnings: what is to be said of it.
    """

    mechanism: Mechanism
    velocity: Velocity
    unit: str
    length: float
    names: tuple[str, ...]
    start: Array
    end: Array
    shares: Array
    remaining: Array
    smallest: Array
    directions: Array
    joint_error: Array
    worst: Array
    sigma: Array
    motion: Array
    speed: float
    rates: Array
    limits: Array
    certificate: Certificate
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<SingularApproach {quote(self.velocity.of)}: {len(self.shares)} steps, {self.remaining[0]:.4g} rad>"

    @property
    def singular(self) -> bool:
        """Whether the end is singular, for the rows that count."""
        return bool(self.smallest[-1] == 0)

    @property
    def limited(self) -> bool:
        """Whether a velocity limit of any joint is stated."""
        return bool(np.any(np.isfinite(self.limits)))

    @property
    def utilisation(self) -> Array:
        """The largest share of a velocity limit that the rates take; zeros without limits. (k,)."""
        with np.errstate(invalid="ignore"):
            used = np.abs(self.rates) / self.limits
        most: Array = np.max(np.where(np.isinf(self.limits), 0.0, used), axis=-1)
        return most

    @property
    def limit_at(self) -> tuple[float, str] | None:
        """The remaining distance at which a joint first reaches its velocity limit, and its name.

        Between two steps, by a straight line in the logarithms; None if none does before the last thousandth.
        """
        before = np.isfinite(self.motion)
        used, left, rates = self.utilisation[before], self.remaining[before], self.rates[before]
        reached = np.flatnonzero(used >= 1)
        if not reached.size:
            return None
        at = int(reached[0])
        joint = self.names[int(np.argmax(np.abs(rates[at]) / self.limits))]
        if at == 0 or used[at - 1] == 0:
            return float(left[at]), joint
        share = math.log(used[at - 1]) / math.log(used[at - 1] / used[at])
        return float(left[at - 1] * (left[at] / left[at - 1]) ** share), joint


def singular_approach(
    model: Model,
    frame: str,
    q: Array,
    end: Array | None = None,
    *,
    joint_error: JointErrors | None = None,
    axes: str | Sequence[str] | None = None,
    reference: Reference | str = Reference.ALIGNED,
    relative_to: str | None = None,
    point: Sequence[float] | None = None,
    speed: float = 0.1,
) -> SingularApproach:
    """Return what degrades on the way into a singular configuration.

    The way is straight in joint space. At each of its steps, J = U diag(s) V^T of the rows that count gives the joint
    motion v_r / s_r per unit of tool motion along u_r, and by tau = J^T F the force error 1 / s_r per torque error. Y.
    Nakamura and H. Hanafusa, "Inverse kinematic solutions with singularity robustness for robot manipulator control",
    J. Dynamic Systems, Measurement, and Control 108(3), 1986.

    The rows that count are those of `axes`; without axes translation alone, where its rank falls at the end; else those
    of `singular_at`, where turns count as arcs of radius L, the arm's characteristic length.

    Args:
        model: the robot.
        frame: the tool's frame, a link.
        q: the configuration where the way starts (nq,).
        end: the one where it ends (nq,), of which only joints between the frames count. Default: the nearest singular
            one that a search finds, inside limits if there is one there.
        joint_error: as `joint_errors` reads it; default 0.001 rad for joints that turn (0.001 m, where all slide).
        axes: the rows that count, such as "xyz" or "x y rz".
        reference: aligned, rows in the observer's axes; or local, in the axes of the tool's frame.
        relative_to: the observer's link; default the root link.
        point: the tool point in the frame's coordinates, in m; default its origin.
        speed: the tool speed for which joint rates are given, m/s (rad/s where only turns count).

    Returns:
        The steps (k,), with joint rates (k, n).

    Raises:
        UnknownNameError: no such frame or joint.
        UsageError: no joint between the frames, or a floating one; axes, joint errors or a speed that cannot be; the
            way starts where it ends, or in a singular configuration; no singular configuration is found.
        ConfigurationError: q or end is not one configuration of numbers.
    """
    if not 0 < speed < math.inf:
        raise UsageError(f"a tool speed is positive, not {speed:g}", remedy="for instance 0.1")
    given = checked(model.robot, q)
    if given.ndim != 1:
        raise ConfigurationError("a way starts in one configuration", remedy="ask about each")
    asked: dict[str, object] = {"relative_to": relative_to, "point": point, "reference": reference}
    warnings = list[str]()
    if end is None:
        arm, target = _nearest(model, frame, given, axes, asked, warnings)
    else:
        arm = mechanism(model, frame, axes=axes, **asked)  # type: ignore[arg-type]
        whole = checked(model.robot, end)
        if whole.ndim != 1:
            raise ConfigurationError("a way ends in one configuration")
        target = whole[list(arm.indices)]
    here = given[list(arm.indices)]
    distance = float(np.linalg.norm((here - target) / arm.units))
    if distance < _HERE:
        raise UsageError("the way into the singularity ends where it starts", remedy="start elsewhere: --config")
    left = [share * 10.0**-decade for decade in range(_DECADES) for share in _MANTISSAS]
    shares = np.array([*left, 10.0**-_DECADES, 0.0])
    steps = arm.configuration(shares[:, None] * here + (1 - shares[:, None]) * target, given)
    if axes is None and len(arm.task.rows) == 6:
        arm = _translation(model, frame, asked, steps[-1]) or arm
    errors = joint_errors(model, frame, UNIT_ERROR if joint_error is None else joint_error, relative_to=relative_to)
    return _followed(arm, steps, shares, distance, errors, speed, warnings)


def _nearest(
    model: Model,
    frame: str,
    q: Array,
    axes: str | Sequence[str] | None,
    asked: dict[str, object],
    warnings: list[str],
) -> tuple[Mechanism, Array]:
    """Return the arm, and the coordinates of the nearest singular configuration, inside limits if there is one."""
    at = singular_at(model, frame, q, axes=axes, **asked)  # type: ignore[arg-type]
    if at.singular:
        raise UsageError("the way into a singularity starts in a singular configuration", remedy="choose another -q")
    found = at.distance
    if found.q is None:
        raise UsageError("no singular configuration is found near this one", remedy="name one: --approach j1=0,j2=1.5")
    if found.inside_limits:
        return at.mechanism, found.q
    if found.inside is not None:
        return at.mechanism, found.inside[1]
    warnings.append("the nearest singular configuration is outside joint limits, and none was found inside")
    return at.mechanism, found.q


def _translation(model: Model, frame: str, asked: dict[str, object], end: Array) -> Mechanism | None:
    """Return the arm with the linear rows alone, if their rank falls at the end."""
    try:
        arm = mechanism(model, frame, axes="xyz", **asked)  # type: ignore[arg-type]
    except UsageError:  # its point never moves
        return None
    return arm if float(arm.smallest(end[list(arm.indices)])) < MODEL else None


def _followed(
    arm: Mechanism, steps: Array, shares: Array, distance: float, errors: Array, speed: float, warnings: list[str]
) -> SingularApproach:
    """Return the numbers at the steps (k, nq) of a way, `arm` having the rows that count."""
    robot, task = arm.model.robot, arm.task
    label = Velocity(arm.velocity.of, arm.velocity.relative_to, arm.velocity.expressed_in, arm.point)
    columns = robot.velocity_columns(dict.fromkeys(arm.joints))
    rows = list(task.rows)
    arcs = np.where(np.array(rows) >= 3, arm.length if task.mixed else 1.0, 1.0)[:, None]
    count = min(len(rows), len(columns))

    def both(engine: Engine) -> Array:
        matrix = engine.jacobian(steps, label)[..., columns]
        values = np.zeros((len(steps), 1, len(columns)))
        values[:, 0, :count] = np.linalg.svd(matrix[:, rows] * arcs * arm.units, compute_uv=False)
        return np.concatenate([matrix, values], -2)

    value, certificate = certified(arm.model, both, length_scale(robot, steps, label.point) * max(1.0, arm.length))
    matrix, values = value[:, :6], value[:, 6, :count]
    scaled = matrix[:, rows] * arcs * arm.units
    left, _, right = np.linalg.svd(scaled, full_matrices=False)
    last = arm.generic_rank - 1
    directions = left[:, :, last]
    # The end is singular if `singular at` says so; on the way, only what is zero in exact numbers is.
    size = 1.0 if not task.linear else arm.length
    vanishes = values[:, last] <= np.where(shares > 0, STRICT, MODEL) * size
    smallest = np.where(vanishes, 0.0, values[:, last])
    if vanishes[-1]:
        lost = _lost(scaled[-1], int(np.sum(values[-1] > MODEL * size)), directions[-2])
        directions = np.concatenate([directions[:-1], lost[None]])
    with np.errstate(divide="ignore"):
        motion = 1 / smallest
    rates = np.where(vanishes[:, None], np.inf, speed * right[:, last] * arm.units)
    rates = np.divide(rates, smallest[:, None], out=rates, where=~vanishes[:, None])
    erring = matrix[:, list(task.linear or task.angular)] * np.abs(errors)
    if not vanishes[-1]:
        warnings.append("the end of the way is not singular for the rows that count")
    return SingularApproach(
        arm,
        label,
        "m" if task.linear else "rad",
        arm.length,
        arm.names,
        steps[0],
        steps[-1],
        shares,
        shares * distance,
        smallest,
        _signed(directions),
        errors,
        np.linalg.norm((erring @ farthest(erring)[..., None])[..., 0], axis=-1),
        np.linalg.norm(erring, axis=(-2, -1)),
        motion,
        speed,
        rates,
        _velocity_limits(arm),
        certificate,
        tuple(warnings),
    )


def _lost(matrix: Array, rank: int, before: Array) -> Array:
    """Return the direction that is lost at the end: of those that no joint moves, the one nearest to the step before.

    Others of them may be of the structure, as z is for a planar arm. (m, n), (m,) -> (m,).
    """
    unmoved = np.linalg.svd(matrix)[0][:, rank:]
    toward: Array = unmoved @ (unmoved.T @ before)
    return toward / np.linalg.norm(toward)


def _signed(directions: Array) -> Array:
    """Return directions (k, m) with the sign that makes the largest entry of the last one positive, and no jumps."""
    flips = np.sign(np.sum(directions[1:] * directions[:-1], axis=-1))
    signs = np.concatenate([np.ones(1), np.cumprod(np.where(flips < 0, -1.0, 1.0))])[:, None]
    smooth: Array = directions * signs
    last = smooth[-1]
    return smooth * (-1.0 if last[np.argmax(np.abs(last).round(9))] < 0 else 1.0)


def _velocity_limits(arm: Mechanism) -> Array:
    """Return the velocity limit of each coordinate, infinite where none is stated. (n,)."""
    robot = arm.model.robot
    limits = []
    for joint in arm.joints:
        stated = [(joint.limit.velocity, 1.0)] if joint.type.nq == 1 else []
        for name, law in robot.followers.items():
            if law.joint == joint.name:
                stated.append((robot.joint_by_name[name].limit.velocity, abs(law.multiplier)))
        limits.append(min((v / times for v, times in stated if v is not None and v > 0 < times), default=math.inf))
    return np.array(limits)
