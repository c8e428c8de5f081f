"""The worst gravity torque of each joint over all configurations inside limits: sampled, climbed to, certified."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.configuration import checked, random_configurations
from kinetostat.analysis.crosscheck import Certificate
from kinetostat.analysis.loads import EffortLimits, Payload, checked_gravity
from kinetostat.analysis.statics import torque
from kinetostat.analysis.worst_climb import WorstClimb
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError, quoted
from kinetostat.urdf.description import NO_LIMIT, Joint, Robot

__all__ = ["WorstTorques", "worst_torques"]

_STARTS = 32  # of the samples, the worst of which are climbed from, for each joint
_AGREE = 1e-6  # of the worst torque: starts that end so near agree


@dataclass(frozen=True, repr=False)
class WorstTorques:
    """The largest torque that weight puts on each joint inside limits. Lower bounds: a worse one is not excluded.

    Attributes:
        joints: the joints, in file order, each with one coordinate.
        units: Nm or N.
        payload: the payload, or None.
        gravity_vector: the acceleration of gravity, (3,), m/s2.
        torques: the worst torque of each, signed, (n,).
        witnesses: the configuration at which it acts, (n, nq).
        limits: what the joints may give, of all coordinates.
        utilisation: torque over effort limit in its direction, (n,); NaN where there is none.
        samples: how many random configurations were looked at.
        starts: from how many of them the worst was climbed to, for each joint.
        agreed: how many of those ended at the same torque, (n,).
        certificate: what the two engines say of the torques at the witnesses.
        warnings: what is to be said of it.
    """

    joints: tuple[str, ...]
    units: tuple[str, ...]
    payload: Payload | None
    gravity_vector: Array
    torques: Array
    witnesses: Array
    limits: EffortLimits
    utilisation: Array
    samples: int
    starts: int
    agreed: Array
    certificate: Certificate
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<WorstTorques of {len(self.joints)} joints, {self.samples} samples>"


def worst_torques(
    model: Model,
    q: Array,
    *,
    gravity: Sequence[float] | Array | bool = True,
    payload: Payload | None = None,
    limits: Mapping[str, float | tuple[float, float]] | None = None,
    joints: Collection[str] | None = None,
    samples: int = 2000,
    starts: int = _STARTS,
    also: Array | None = None,
    seed: int = 0,
    progress: Callable[[str, float], None] | None = None,
) -> WorstTorques:
    """Return the worst torque of each joint under gravity (and payload) over all configurations inside limits.

    Random configurations; from the worst of them for each joint, all at once, a climb inside the limits along one
    coordinate after another (`torque_ascent`); from the highest end a local maximiser (L-BFGS-B: C. Zhu, R. Byrd, P. Lu
    and J. Nocedal, 1997, by SciPy) with the analytic gradient, which is a row of the Hessian of the potential energy.
    Joints with several coordinates (floating, planar) are held at q. What it finds is a lower bound of the worst.

    Args:
        model: the robot.
        q: one configuration, (nq,): where joints with several coordinates are held.
        gravity: True (9.81 m/s2 down the root's z) or a vector (3,) in the root's axes.
        payload: a mass that is held.
        limits: effort limits of joints instead of the file's: a number, or (lower, upper).
        joints: names of the joints whose torque is asked for, each with one coordinate; default, all of them.
        samples: how many random configurations.
        starts: from how many of the worst of them is climbed, for each joint.
        also: further configurations (k, nq) inside limits that are looked at like samples.
        seed: the same seed gives the same samples.
        progress: told what is being done, and which share of it is.

    Raises:
        UnknownNameError: no such frame or joint.
        UsageError: no joint that may move, or is asked for; samples, starts, gravity, payload, limits that cannot be.
        ConfigurationError: q has another shape, or a number that is not finite.
        NumberError: a link's mass is negative.
    """
    robot, q, down = model.robot, checked(model.robot, q), checked_gravity(gravity)
    moving = [joint for joint in robot.independent if joint.type.nq == 1]
    if not moving:
        raise UsageError("no worst torque: the robot has no joint with one coordinate")
    asked = _asked(robot, moving, joints)
    if q.ndim != 1:
        raise UsageError("a worst torque is looked for from one configuration on")
    if not 1 <= samples <= 1_000_000:
        raise UsageError(f"between 1 and 1,000,000 samples, not {samples}")
    if starts < 1:
        raise UsageError(f"a climb has one start at least, not {starts}")
    drawn = _drawn(robot, q, moving, samples, seed)
    if also is not None:
        drawn = np.concatenate([checked(robot, also).reshape(-1, robot.nq), drawn])
    ends, torques = WorstClimb(model, q, moving, down, payload).ends(asked, drawn, starts, progress)
    sizes, rows = np.abs(torques), np.arange(len(asked))
    best = np.argmax(sizes, axis=1)
    at = ends[rows, best]
    agreed = np.sum(sizes >= (1 - _AGREE) * sizes[rows, best][:, None], axis=1)
    proof = torque(model, at, gravity=down, payload=payload, limits=limits)
    columns = robot.velocity_columns(asked)
    return WorstTorques(
        tuple(joint.name for joint in asked),
        tuple(proof.units[column] for column in columns),
        payload,
        down,
        proof.total[rows, columns],
        at,
        proof.limits,
        proof.utilisation[rows, columns],
        samples,
        min(starts, len(drawn)),
        agreed,
        proof.certificate,
        (*proof.warnings, *_about_ranges(moving)),
    )


def _asked(robot: Robot, moving: list[Joint], names: Collection[str] | None) -> list[Joint]:
    """Return the joints that are asked for, in file order."""
    if names is None:
        return moving
    wanted = {robot.independent_joint(name).name for name in names}
    asked = [joint for joint in moving if joint.name in wanted]
    if len(asked) < len(wanted) or not asked:
        raise UsageError("a worst torque is looked for of joints with one coordinate, one at least")
    return asked


def _drawn(robot: Robot, q: Array, joints: Sequence[Joint], samples: int, seed: int) -> Array:
    """Return random configurations inside limits, joints with several coordinates as in q. (samples, nq)."""
    drawn, held = random_configurations(robot, seed, samples), np.ones(robot.nq, dtype=bool)
    for joint in joints:
        held[robot.position_slices[joint.name]] = False
    drawn[:, held] = q[held]
    return drawn


def _about_ranges(joints: Sequence[Joint]) -> list[str]:
    """Return what is to be said of slides and screws without limits, and of joints that their limits lock."""
    free = [j for j in joints if max(map(abs, j.limit.range)) > NO_LIMIT]
    endless, screws = (
        [j.name for j in free if not j.type.is_angle],
        [j.name for j in free if j.type.is_angle and j.pitch],
    )
    locked = [j.name for j in joints if j.limit.range[0] == j.limit.range[1]]
    lines = []
    if endless:
        lines.append(f"no limits of {quoted(endless)}: taken within 1 m, on which the answer depends")
    if screws:
        lines.append(f"no limits of {quoted(screws)}: taken within half a turn, on which the answer depends")
    if locked:
        lines.append(f"the limits of {quoted(locked)} are one position: locked there")
    return lines
