"""Inverse kinematics: joint positions for a pose; every solution checked by forward kinematics on both engines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kinetostat.analysis.configuration import checked
from kinetostat.analysis.coordinates import Coordinates, coordinates
from kinetostat.analysis.crosscheck import Certificate, certified, length_scale
from kinetostat.analysis.inverse.aim import REACHED, Aim
from kinetostat.analysis.inverse.branches import branches
from kinetostat.analysis.inverse.damped import solve, solve_freely
from kinetostat.analysis.inverse.iterate import Step, by_rates, by_steps, newton
from kinetostat.analysis.inverse.method import Method
from kinetostat.analysis.inverse.pose import Pose, pose, pose_error
from kinetostat.analysis.jacobian import checked_point
from kinetostat.analysis.task import FULL, TRANSLATION, Task
from kinetostat.conventions import Array, Flags, Reference
from kinetostat.engines.model import Model
from kinetostat.errors import ConfigurationError, UsageError, quote
from kinetostat.screw import se3

__all__ = ["InverseKinematics", "Solutions", "ik", "ik_all"]

_MOST_TRIES = 10_000


@dataclass(frozen=True, repr=False)
class InverseKinematics:
    """Configurations for poses.

    Attributes:
        frame: the tool's frame.
        relative_to: the observer, in whose coordinates the poses are.
        point: the tool point in the frame's coordinates, m.
        task: the rows of the error that count.
        local: whether those rows are in the tool's axes, not in the observer's.
        target: the wanted poses, (..., 4, 4).
        method: how it was looked for.
        coordinates: names of the joints' coordinates that were changed.
        q: configurations of the whole robot, (..., nq).
        error: what is left of the pose error (position in m, rotation vector in rad), rows that do not count too. (...,
            6); see `inverse.pose.pose_error`.
        converged: whether the rows that count are reached: to 1e-9 rad, and 1e-9 of the arm's size. (...).
        inside_limits: whether the joints are inside their limits. (...).
        iterations: how many were needed, restarts counted. (...).
        trace: the textbook methods' steps; empty for others.
        certificate: what the two engines say of the tool's placement there.
        warnings: what is to be said of it.
    """

    frame: str
    relative_to: str
    point: tuple[float, float, float]
    task: Task
    local: bool
    target: Array
    method: Method
    coordinates: tuple[str, ...]
    q: Array
    error: Array
    converged: Flags
    inside_limits: Flags
    iterations: Any
    trace: tuple[Step, ...]
    certificate: Certificate
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        done = f"{int(np.sum(self.converged))} of {np.size(self.converged)} converged"
        return f"<InverseKinematics {quote(self.frame)}, {self.method}: {done}>"

    @property
    def position_residual(self) -> Array:
        """Distance from the wanted position in m, along the rows that count. (...)."""
        return np.asarray(np.linalg.norm(self.error[..., list(self.task.linear)], axis=-1))

    @property
    def rotation_residual(self) -> Array:
        """Angle from the wanted orientation in rad, about the rows that count. (...)."""
        return np.asarray(np.linalg.norm(self.error[..., list(self.task.angular)], axis=-1))


def ik(
    model: Model,
    frame: str,
    wanted: Pose | str | Sequence[float] | Array,
    q: Array,
    *,
    axes: str | Sequence[str] | None = None,
    reference: Reference | str = Reference.ALIGNED,
    relative_to: str | None = None,
    point: Sequence[float] | None = None,
    method: Method | str = Method.DAMPED,
    step: float | None = None,
    tries: int = 100,
    seed: int = 0,
) -> InverseKinematics:
    """Return configurations at which a tool has wanted poses: e(q) = 0 with e = (p* - p ; log(R* R^T)).

        newton            q <- q + J^-1 e                     (J^+ where J is not square)
        pseudo-inverse    dq/dt = J^+ e (per s), or with step=f   q <- q + f J^+ e
        damped            q <- q + (J^T J + m |e|^2)^-1 J^T e inside limits, from q and from random starts

    Sources: K. Lynch and F. Park, "Modern Robotics", 2017, section 6.2; B. Siciliano et al., "Robotics", 2009, section
    3.7; T. Sugihara, IEEE Trans. Robotics 27(5), 2011. Joints that do not move the tool stay as they are in q.

    Args:
        model: the robot.
        frame: the tool's frame, a link.
        wanted: poses relative to the observer, in any notation of `pose`.
        q: where to start, configurations (..., nq), to go with the poses (..., 4, 4).
        axes: the rows of the error that count, such as "x y rz"; default all that the pose has.
        reference: aligned, rows in the observer's axes; or local, in the tool's (a tool that may turn about its own z:
            axes "xyz rx ry", reference local).
        relative_to: the observer, a link; default the root link.
        point: the tool point in the frame's coordinates, in m; default its origin.
        method: "damped", "newton" or "pseudo-inverse"; the last two take one pose and keep a trace.
        step: f in (0, 1] of pseudo-inverse steps; default rates.
        tries: how many starts at most, the first being q. The damped method's.
        seed: of the random starts.

    Raises:
        UnknownNameError: no such frame.
        UsageError: no pose; axes, method, step or tries that cannot be; no joint, or a floating one, between the
            frames.
        ConfigurationError: q has another shape, or a number that is not finite.
    """
    robot, method = model.robot, Method(method)
    q, aim, goal, observer, at = _question(model, frame, wanted, q, axes, reference, relative_to, point)
    if not 1 <= tries <= _MOST_TRIES:
        raise UsageError(f"between 1 and {_MOST_TRIES} tries, not {tries}")
    if step is not None and (method is not Method.PSEUDO_INVERSE or not 0 < step <= 1):
        raise UsageError("a step is between 0 and 1, and pseudo-inverse's", remedy="for instance 0.1")
    shape = _shape(q, goal)
    whole = np.broadcast_to(q, (*shape, robot.nq)).reshape(-1, robot.nq).copy()
    targets = np.broadcast_to(goal.matrix, (*shape, 4, 4)).reshape(-1, 4, 4)
    starts, trace = whole[:, list(aim.joints.indices)], tuple[Step, ...]()
    if method is Method.DAMPED:
        found, _, iterations = solve(aim, starts, targets, _generator(seed), tries)
    else:
        if len(starts) != 1:
            raise UsageError(f"method {method} takes one pose and one start", remedy="or use method damped")
        trace = tuple(_iterated(aim, method, step, starts[0], targets[0]))
        found, iterations = trace[-1].q[None], np.array([len(trace) - 1])
    whole[:, list(aim.joints.indices)] = found
    placement, certificate = _checked(model, frame, observer, at, whole)
    error = pose_error(placement, targets, local=aim.local)
    converged = np.linalg.norm(aim.scaled(error), axis=-1) < 2 * REACHED
    return InverseKinematics(
        frame,
        observer,
        at,
        aim.task,
        aim.local,
        goal.matrix,
        method,
        aim.joints.names,
        whole.reshape(*shape, robot.nq),
        error.reshape(*shape, 6),
        converged.reshape(shape),
        _inside(aim.joints, found).reshape(shape),
        iterations.reshape(shape),
        trace,
        certificate,
        (*_about_freedom(aim), *_about_reach(aim, method, targets, error, converged, tries)),
    )


def _question(
    model: Model,
    frame: str,
    wanted: Pose | str | Sequence[float] | Array,
    q: Array,
    axes: str | Sequence[str] | None,
    reference: Reference | str,
    relative_to: str | None,
    point: Sequence[float] | None,
) -> tuple[Array, Aim, Pose, str, tuple[float, float, float]]:
    """Return the parts of a question, checked: start, aim, pose, observer and tool point."""
    robot = model.robot
    q, goal = checked(robot, q), wanted if isinstance(wanted, Pose) else pose(wanted)
    reference = Reference(reference)
    if reference is Reference.WORLD:
        raise UsageError("rows that count are those of a tool point", remedy="use reference aligned or local")
    observer, tip = robot.frame(relative_to or robot.root), robot.frame(frame)
    at = (0.0, 0.0, 0.0) if point is None else checked_point(point)
    task = (FULL if goal.oriented else TRANSLATION) if axes is None else Task.named(axes)
    if task.angular and not goal.oriented:
        rows = " ".join(task.row_names[len(task.linear) :])
        raise UsageError(f"the pose has no orientation, but {rows} counts", remedy="add it: 'x,y,z rpy r,p,y'")
    aim = Aim.of(coordinates(model, tip, observer, at), task, local=reference is Reference.LOCAL)
    return q, aim, goal, observer, at


def _shape(q: Array, goal: Pose) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(q.shape[:-1], goal.matrix.shape[:-2])
    except ValueError:
        message = f"starts of shape {q.shape} do not go with poses of shape {goal.matrix.shape}"
        raise ConfigurationError(message) from None


def _generator(seed: int) -> np.random.Generator:
    if not isinstance(seed, int) or seed < 0:
        raise UsageError(f"a seed is a whole number from 0 on, not {seed}")
    return np.random.default_rng(seed)


def _iterated(aim: Aim, method: Method, step: float | None, start: Array, target: Array) -> list[Step]:
    if method is Method.NEWTON:
        return newton(aim, start, target)
    return by_rates(aim, start, target) if step is None else by_steps(aim, start, target, step)


def _checked(model: Model, frame: str, observer: str, point: Sequence[float], q: Array) -> tuple[Array, Certificate]:
    """Return where the tool point's frame is at configurations (N, nq), by both engines."""
    arm = se3.placement(np.eye(3), np.array(point))
    scale = length_scale(model.robot, q, (point[0], point[1], point[2]))
    return certified(model, lambda engine: engine.placement(q, frame, observer) @ arm, scale)


def _inside(joints: Coordinates, q: Array) -> Flags:
    return np.asarray(np.all(joints.between(q), axis=-1))


def _about_freedom(aim: Aim) -> tuple[str, ...]:
    """Return what is to be said of an arm with fewer joints than rows that count."""
    count, rows = len(aim.joints.names), len(aim.task.rows)
    if count >= rows:
        return ()
    joints = "1 joint has" if count == 1 else f"{count} joints have"
    return (f"{joints} to answer for {rows} rows: almost no pose is reachable (--axes chooses the rows that count)",)


def _about_reach(
    aim: Aim, method: Method, targets: Array, error: Array, converged: Flags, tries: int
) -> tuple[str, ...]:
    """Return what is to be said of one pose that was not reached; a list has its reasons row by row."""
    if np.all(converged) or len(targets) != 1:
        return ()
    parts = [
        f"{np.linalg.norm(error[0, list(rows)]):.3g} {unit}"
        for rows, unit in ((aim.task.linear, "m"), (aim.task.angular, "rad"))
        if rows
    ]
    missed = f"the pose is not reached: it is missed by {', '.join(parts)}"
    if method is not Method.DAMPED:
        return (f"{missed} (method damped has safeguards, limits and restarts)",)
    if solve_freely(aim, targets[0]):
        return (f"{missed}; outside joint limits it can be reached",)
    return (f"{missed} by the nearest of {tries} tries; without joint limits it was not reached either",)


@dataclass(frozen=True, repr=False)
class Solutions:
    """The distinct configurations for one pose.

    Attributes:
        frame: the tool's frame.
        relative_to: the observer.
        task: the rows of the error that count.
        target: the wanted pose, (4, 4).
        coordinates: names of the joints' coordinates.
        q: configurations of the whole robot, those inside limits first, then the nearest to the start. (k, nq).
        inside_limits: whether each is inside joint limits, (k,).
        error: what is left of the pose error, (k, 6), m and rad.
        how: by what they were found.
        complete: whether the list is complete, but for whole turns of joints.
        endless: whether there are infinitely many; the list then holds examples.
        why: why it is, or is not.
        certificate: what the two engines say of the tool's placement at all of them.
    """

    frame: str
    relative_to: str
    task: Task
    target: Array
    coordinates: tuple[str, ...]
    q: Array
    inside_limits: Flags
    error: Array
    how: str
    complete: bool
    endless: bool
    why: str
    certificate: Certificate

    def __repr__(self) -> str:
        return f"<Solutions {quote(self.frame)}: {len(self.q)}, {'complete' if self.complete else 'not complete'}>"


def ik_all(
    model: Model,
    frame: str,
    wanted: Pose | str | Sequence[float] | Array,
    q: Array,
    *,
    axes: str | Sequence[str] | None = None,
    reference: Reference | str = Reference.ALIGNED,
    relative_to: str | None = None,
    point: Sequence[float] | None = None,
    seed: int = 0,
) -> Solutions:
    """Return all distinct configurations for one pose, limits left out but told.

    By a closed solution where the arm's class has one (six revolute joints or fewer, axes that meet or are parallel: D.
    Ostermeier, J. Kuelz and M. Althoff, RA-L 10(10), 2025), each polished on the exact chain; and in any case by
    descents from random starts, which prove nothing alone, but tell if the closed solution lacks one.

    Args:
        model: the robot.
        frame: the tool's frame, a link.
        wanted: one pose relative to the observer, in any notation of `pose`.
        q: one configuration, (nq,): for joints that do not move the tool, and to sort by.
        axes: the rows of the error that count; default all that the pose has.
        reference: aligned, rows in the observer's axes; or local, in the tool's.
        relative_to: the observer, a link; default the root link.
        point: the tool point in the frame's coordinates, in m; default its origin.
        seed: of the random starts.

    Raises:
        UnknownNameError: no such frame.
        UsageError: no pose, or several; axes that cannot be; no joint, or a floating one, between the frames.
        ConfigurationError: q has another shape, or a number that is not finite.
    """
    q, aim, goal, observer, at = _question(model, frame, wanted, q, axes, reference, relative_to, point)
    if q.ndim != 1 or goal.matrix.ndim != 2:
        raise UsageError("all solutions are those of one pose", remedy="take them one by one")
    found = branches(aim, goal.matrix, _generator(seed))
    origin = q[list(aim.joints.indices)]
    points = aim.joints.near(found.q, origin)
    inside = _inside(aim.joints, points)
    away = np.linalg.norm((points - origin) / aim.units, axis=-1)
    order = np.lexsort((away, ~inside))
    whole = aim.joints.configuration(points[order], q)
    placement, certificate = _checked(model, frame, observer, at, whole)
    return Solutions(
        frame,
        observer,
        aim.task,
        goal.matrix,
        aim.joints.names,
        whole,
        inside[order],
        pose_error(placement, goal.matrix, local=aim.local),
        found.how,
        found.complete,
        found.endless,
        found.why,
        certificate,
    )
