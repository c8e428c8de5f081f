"""Accuracy: which error joint errors make at the tool, and which joint resolution a wanted accuracy needs; certified.

Errors are small joint motions d, so to first order the tool is off by J d. What that leaves out is told beside it, by
forward kinematics.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from kinetostat.analysis.configuration import LARGEST_LENGTH, checked
from kinetostat.analysis.crosscheck import Certificate, certified, length_scale
from kinetostat.analysis.jacobian import labelled
from kinetostat.analysis.joint_values import Value, joint_rates, parsed
from kinetostat.analysis.task import turning_columns
from kinetostat.conventions import Array, Reference, Velocity
from kinetostat.engines.model import Model
from kinetostat.engines.protocol import Engine
from kinetostat.errors import UsageError, cut, quote
from kinetostat.screw import se3, so3
from kinetostat.urdf.description import JointType, Robot

__all__ = [
    "ErrorPart",
    "JointResolution",
    "Requirement",
    "ToolError",
    "displaced",
    "farthest",
    "joint_errors",
    "joint_resolution",
    "tool_error",
]

UNIT_ERROR = 1e-3  # rad or m: what is taken of every joint where no error is given
MOST_EXACT = 20  # columns of which all sign patterns are tried
_AT_ONCE = 2**22  # numbers of one go at them
_FIRST_ORDER = 0.05  # of the worst case: a larger remainder is warned of
_LARGE = 0.1  # rad: where errors of joints stop being small

JointErrors = float | str | Sequence[float] | Mapping[str, Value] | Array


@dataclass(frozen=True)
class ErrorPart:
    """The position error of the tool point, or the rotation error of the tool, by errors d of the n joints.

    With A = J diag|d| restricted to the three rows and s a pattern of signs:

    Attributes:
        unit: m or rad.
        worst: max |A s| over all sign patterns, the farthest vertex of a zonotope; where `exact` is False, an upper
            bound of it: min(|sum_j |A_j||, sum_j |A_j|), the first by rows. (...).
        exact: whether all patterns were tried, which they are for up to 20 joints with an error.
        signs: the pattern s that makes it (or the farthest that was found), +1 or -1. (..., n).
        there: |A s| for that pattern by forward kinematics, not to first order. (...).
        worst_shares: the share of each joint in |A s|: s_j A_j . A s / |A s|^2, their sum is 1; 0 where nothing moves.
            (..., n).
        sigma: root mean square length of the error where the d are standard deviations of independent errors,
            sqrt(trace A A^T). (...).
        axes: unit directions of the one-sigma ellipsoid as columns, the longest first. (..., 3, 3).
        lengths: its semi-axes, the square roots of the eigenvalues of A A^T. (..., 3).
        sigma_shares: the share of each joint in the variance, |A_j|^2 / sum |A_k|^2. (..., n).
    """

    unit: str
    worst: Array
    exact: bool
    signs: Array
    there: Array
    worst_shares: Array
    sigma: Array
    axes: Array
    lengths: Array
    sigma_shares: Array


@dataclass(frozen=True, repr=False)
class ToolError:
    """What joint errors do to the tool at configurations.

    Rows are those of a small motion of the tool: displacement of its point (m), then rotation (rad).

    Attributes:
        velocity: of which frame and point, relative to which observer, expressed in which axes.
        reference: the shorthand that it was asked by.
        columns: names of the n columns, the joints of the path.
        column_units: units of their errors: rad or m.
        joint_error: d, (n,).
        matrix: J, (..., 6, n).
        displacement: J d, the move by the errors with their signs. (..., 6).
        moved: the same by forward kinematics: displacement of the point, and rotation vector. (..., 6).
        worst: sum_j |J_ij| |d_j|, the largest error along each row by itself. (..., 6).
        sigma: sqrt(sum_j (J_ij d_j)^2), the standard deviation along each row. (..., 6).
        translation: the position error.
        rotation: the rotation error.
        certificate: what the two engines say of J, of all moves, and of the semi-axes.
        warnings: what is to be said of it.
    """

    velocity: Velocity
    reference: Reference
    columns: tuple[str, ...]
    column_units: tuple[str, ...]
    joint_error: Array
    matrix: Array
    displacement: Array
    moved: Array
    worst: Array
    sigma: Array
    translation: ErrorPart
    rotation: ErrorPart
    certificate: Certificate
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<ToolError {quote(self.velocity.of)}: {len(self.columns)} joints, batch {self.matrix.shape[:-2]}>"


def tool_error(
    model: Model,
    frame: str,
    q: Array,
    joint_error: JointErrors | None = None,
    *,
    reference: Reference | str = Reference.ALIGNED,
    relative_to: str | None = None,
    expressed_in: str | None = None,
    point: Sequence[float] | None = None,
) -> ToolError:
    """Return the tool error that joint errors make.

    To first order the tool is off by J d. Errors that are bounds, |e_j| <= |d_j|, fill a zonotope: along a row the
    worst is sum_j |J_ij| |d_j|, and the largest length is that of a vertex, max |J diag|d| s| over patterns of signs.
    Errors that are independent with standard deviations |d_j| have the covariance C = J diag(d)^2 J^T, whose ellipsoid
    comes from the singular values of J diag(d). B. Mooring, Z. Roth and M. Driels, "Fundamentals of Manipulator
    Calibration", 1991; R. Smith and P. Cheeseman, "On the representation and estimation of spatial uncertainty", IJRR
    5(4), 1986; zonotopes: G. Ziegler, "Lectures on Polytopes", 1995, section 7.3.

    Args:
        model: the robot.
        frame: F, a link.
        q: configurations (..., nq).
        joint_error: d, in rad and m: as `joint_errors` reads them. Default: 0.001 of each joint, if all turn or all
            slide.
        reference: aligned, local or world; see `conventions.Reference`.
        relative_to: A, the observer's link; default the root link.
        expressed_in: E, the link in whose axes (at q) errors are given; default as `reference` says.
        point: the point in F's coordinates, in m; default F's origin.

    Returns:
        The tool error, with moves (..., 6) in m and rad.

    Raises:
        UnknownNameError: no such frame or joint.
        UsageError: no joint between the frames; joint errors that cannot be, or none where some joints turn and others
            slide; a point with reference world.
        ConfigurationError: q has another shape, or a number that is not finite; an error of a fixed or follower joint.
    """
    robot = model.robot
    q, reference = checked(robot, q), Reference(reference)
    velocity = labelled(robot, frame, reference, relative_to, expressed_in, point)
    joints = robot.moving_joints(velocity.relative_to, velocity.of)
    columns, turning = robot.velocity_columns(joints), turning_columns(joints)
    if joint_error is None:
        _refuse_mixed(turning)
        joint_error = UNIT_ERROR
    errors = joint_errors(model, velocity.of, joint_error, relative_to=velocity.relative_to)
    sizes = np.abs(errors)
    scaled = model.engine.jacobian(q, velocity)[..., columns] * sizes
    signs = [farthest(scaled[..., rows, :]) for rows in (slice(0, 3), slice(3, 6))]
    # Three moves: the errors as they are, and the worst ones of the position and of the rotation.
    moves = np.stack([np.broadcast_to(errors, signs[0].shape), *(sign * sizes for sign in signs)], -2)
    steps = np.zeros((*moves.shape[:-1], robot.nv))
    steps[..., columns] = moves
    ends = checked(robot, displaced(robot, q[..., None, :], steps))

    def both(engine: Engine) -> Array:
        matrix = engine.jacobian(q, velocity)[..., columns]
        first = matrix @ np.swapaxes(moves, -1, -2)
        values = np.zeros((*matrix.shape[:-1], 1))
        for start in (0, 3):
            found = np.linalg.svd(matrix[..., start : start + 3, :] * errors, compute_uv=False)
            values[..., start : start + found.shape[-1], 0] = found
        exact = _moves(engine, q, ends, velocity)[..., :3, :].reshape(*matrix.shape[:-2], 6, 6)
        return np.concatenate([matrix, first, values, exact], -1)

    scale = length_scale(robot, np.concatenate([q[..., None, :], ends], -2), velocity.point)
    speed = float(np.sum(sizes)) * robot.largest_multiplier
    value, certificate = certified(model, both, scale, speed)
    matrix, first, values, exact = np.split(value, np.cumsum([len(columns), 3, 1]), axis=-1)
    placed = exact.reshape(*exact.shape[:-2], 3, 3, 4)
    moved = np.concatenate([placed[..., 3], so3.log(placed[..., :3])], -1)
    smallest = certificate.tolerance * float(np.max(sizes))
    parts = [
        _part(
            "rad" if i else "m",
            matrix[..., rows, :] * sizes,
            signs[i],
            np.linalg.norm(moved[..., i + 1, rows], axis=-1),
            values[..., rows, 0],
            smallest,
        )
        for i, rows in enumerate((slice(0, 3), slice(3, 6)))
    ]
    return ToolError(
        velocity,
        reference,
        tuple(name for joint in joints for name in joint.velocity_names),
        tuple("rad" if turns else "m" for turns in turning),
        errors,
        matrix,
        first[..., 0],
        moved[..., 0, :],
        np.sum(np.abs(matrix) * sizes, axis=-1),
        np.linalg.norm(matrix * sizes, axis=-1),
        parts[0],
        parts[1],
        certificate,
        (*_slides_left_out(errors, turning), *_too_large(first, moved, parts, smallest)),
    )


def _refuse_mixed(turning: Sequence[bool]) -> None:
    if len(set(turning)) > 1:
        raise UsageError(
            "some joints turn and others slide: there is no error that is equal for all of them",
            remedy="say how they compare, for instance --joint-error arm=0.001,slide=0.0001 in rad and m",
        )


def _slides_left_out(errors: Array, turning: Sequence[bool]) -> list[str]:
    """Return a warning where one error was given for the joints that turn, and none for those that slide."""
    turns = np.array(turning)
    if np.any(turns) and np.any(errors[turns]) and not np.all(turns) and not np.any(errors[~turns]):
        return ["joints that slide are taken as exact: --joint-error slide=0.0001 gives the error of one, in m"]
    return []


def _too_large(first: Array, moved: Array, parts: Sequence[ErrorPart], smallest: float) -> list[str]:
    """Return a warning where the first order leaves out more than a twentieth of the worst case."""
    warnings = []
    for what, rows, part in zip(("position", "rotation"), (slice(0, 3), slice(3, 6)), parts, strict=True):
        gaps = np.swapaxes(first, -1, -2)[..., rows] - moved[..., rows]
        rest = np.max(np.linalg.norm(gaps, axis=-1), axis=-1)
        share = float(np.max(rest / np.maximum(part.worst, smallest), initial=0.0)) if smallest > 0 else 0.0
        if share > _FIRST_ORDER and float(np.max(rest)) > smallest:
            warnings.append(
                f"joint errors are too large for first order: it leaves out {100 * share:.0f} % of the worst {what} "
                "error (the exact moves are by forward kinematics)"
            )
    return warnings


def _moves(engine: Engine, start: Array, ends: Array, velocity: Velocity) -> Array:
    """Return how the tool moves from one configuration to others: [[R, displacement of the point], [0, 1]].

    R is its rotation. Both are in the axes that the velocity is expressed in, as they are at the start.
    (..., nq), (..., k, nq) -> (..., k, 4, 4).
    """
    before = engine.placement(start, velocity.of, velocity.relative_to)[..., None, :, :]
    after = engine.placement(ends, velocity.of, velocity.relative_to)
    axes = engine.placement(start, velocity.expressed_in, velocity.relative_to)[..., None, :3, :3]
    # The point in F's coordinates: given, or the one that lies at the observer's origin.
    point = se3.inverse(before)[..., :3, 3] if velocity.point is None else np.array(velocity.point)
    shift = se3.transform(after, point) - se3.transform(before, point)
    turn = after[..., :3, :3] @ np.swapaxes(before[..., :3, :3], -1, -2)
    back = np.swapaxes(axes, -1, -2)
    return se3.placement(back @ turn @ axes, (back @ shift[..., None])[..., 0])


def _part(unit: str, scaled: Array, signs: Array, there: Array, lengths: Array, smallest: float) -> ErrorPart:
    """Return what is to be said of three rows of J diag|d|, given the worst signs. (..., 3, n)."""
    vertex = (scaled @ signs[..., None])[..., 0]
    farthest_found = np.linalg.norm(vertex, axis=-1)
    exact = _is_exact(scaled)
    columns = np.linalg.norm(scaled, axis=-2)
    bound = np.minimum(np.linalg.norm(np.sum(np.abs(scaled), -1), axis=-1), np.sum(columns, -1))
    squares = columns**2
    along = np.einsum("...r,...rj,...j->...j", vertex, scaled, signs)
    moving = (farthest_found > smallest)[..., None]
    axes = np.linalg.svd(scaled)[0]
    return ErrorPart(
        unit,
        farthest_found if exact else bound,
        exact,
        signs,
        there,
        np.divide(along, farthest_found[..., None] ** 2, out=np.zeros_like(along), where=moving),
        np.sqrt(np.sum(squares, axis=-1)),
        _pointing_up(axes),
        lengths,
        np.divide(squares, np.sum(squares, -1, keepdims=True), out=np.zeros_like(squares), where=moving),
    )


def _pointing_up(axes: Array) -> Array:
    """Return the directions with the sign that makes the largest entry of each positive."""
    largest = np.take_along_axis(axes, np.argmax(np.abs(axes).round(9), axis=-2)[..., None, :], -2)
    return axes * np.where(largest < 0, -1.0, 1.0)


# --- the farthest vertex -----------------------------------------------------------------------------------------


def _moving_columns(columns: Array) -> list[int]:
    """Return where some configuration has a column that is not zero."""
    return [int(i) for i in np.flatnonzero(np.any(columns != 0, axis=tuple(range(columns.ndim - 1))))]


def _is_exact(columns: Array) -> bool:
    return len(_moving_columns(columns)) <= MOST_EXACT


def farthest(columns: Array) -> Array:
    """Return the signs s for which sum_j s_j A_j is longest: the farthest vertex of the zonotope of the columns.

    All patterns are tried, of s and -s one alone, in goes of a size that memory allows; of equal ones the first counts.
    Beyond 20 columns a pattern is found by ascent, from the longest axis of the ellipsoid: s = sign(A^T A s).
    (..., m, n) -> (..., n), +1 or -1; the first +1.
    """
    kept = _moving_columns(columns)
    signs = np.ones((*columns.shape[:-2], columns.shape[-1]))
    if len(kept) < 2:
        return signs
    some = columns[..., kept]
    signs[..., kept] = _tried(some) if len(kept) <= MOST_EXACT else _ascended(some)
    return signs


def _tried(columns: Array) -> Array:
    """Return the best of all sign patterns. (..., m, n) -> (..., n)."""
    count = columns.shape[-1]
    best = np.full(columns.shape[:-2], -1.0)
    codes = np.zeros(columns.shape[:-2], dtype=np.int64)
    patterns = 2 ** (count - 1)
    go = max(1, _AT_ONCE // max(count, columns[..., 0].size))
    for start in range(0, patterns, go):
        some = np.arange(start, min(start + go, patterns))
        lengths = np.sum((columns @ _pattern(some, count).T) ** 2, axis=-2)
        longest = np.argmax(lengths, axis=-1)
        found = np.take_along_axis(lengths, longest[..., None], -1)[..., 0]
        codes = np.where(found > best, some[longest], codes)
        best = np.maximum(best, found)
    return _pattern(codes, count)


def _pattern(codes: npt.NDArray[np.int64], count: int) -> Array:
    """Return the sign patterns of numbers 0 ... 2^(count-1) - 1, the first sign being +1. (...) -> (..., count)."""
    bits = (codes[..., None] >> np.arange(count - 1)) & 1
    return np.concatenate([np.ones((*codes.shape, 1)), 1.0 - 2.0 * bits], -1)


def _ascended(columns: Array) -> Array:
    """Return a pattern that no step s = sign(A^T A s) makes longer. (..., m, n) -> (..., n)."""
    toward = np.linalg.svd(columns)[0][..., 0]
    for _ in range(columns.shape[-1]):
        along = np.einsum("...r,...rj->...j", toward, columns)
        signs = np.where(along < 0, -1.0, 1.0)
        toward = (columns @ signs[..., None])[..., 0]
    return signs * signs[..., :1]


# --- joint errors as they are given ------------------------------------------------------------------------------


def joint_errors(
    model: Model, frame: str, wanted: JointErrors, *, relative_to: str | None = None, degrees: bool = False
) -> Array:
    """Return errors of the joints between two frames, one for each column of the Jacobian between them.

    Args:
        model: the robot.
        frame: F, a link.
        wanted: one number, for every joint that turns (for every joint, where all slide); `j1=0.001,j2=-0.002`, others
            being 0; a list in path order; or the number, mapping or sequence that these mean. Signs count in the move
            that the errors make, and in nothing else.
        relative_to: A, the observer's link; default the root link.
        degrees: numbers given for angles are in degrees.

    Returns:
        d, (n,), in rad and m.

    Raises:
        UnknownNameError: no such frame or joint.
        UsageError: no joint between the frames; not so many numbers as there are columns; a joint that is not between
            the frames; a number that is not finite, or that is half a turn or more.
        ConfigurationError: an error of a fixed or follower joint.
    """
    robot = model.robot
    observer, of = robot.frame(relative_to or robot.root), robot.frame(frame)
    joints = robot.moving_joints(observer, of)
    names = [name for joint in joints for name in joint.velocity_names]
    turning = np.array(turning_columns(joints))
    values = parsed(wanted) if isinstance(wanted, str) else wanted
    if isinstance(values, Mapping):
        every = joint_rates(robot, values, quantity="joint error")
        columns = robot.velocity_columns(joints)
        elsewhere = np.flatnonzero(np.delete(every, columns))
        if elsewhere.size:
            others = np.delete([name for joint in robot.independent for name in joint.velocity_names], columns)
            raise UsageError(
                f"joint {quote(str(others[elsewhere[0]]))} does not move {quote(of)} relative to {quote(observer)}",
                remedy=f"these do: {_listed(names)}",
            )
        errors = every[columns]
    else:
        errors = _numbers(values, wanted, names)
        if len(errors) == 1 < len(names):
            errors = np.where(turning | ~np.any(turning), errors, 0.0)
    if len(errors) != len(names):
        raise UsageError(
            f"{len(errors)} joint errors are given, {len(names)} are needed",
            remedy=f"one for all joints that turn, or in the order {_listed(names)}",
        )
    errors = np.where(turning & degrees, np.radians(errors), errors)
    for name, value, turns in zip(names, errors, turning, strict=True):
        most = math.pi if turns else LARGEST_LENGTH
        if not abs(value) < most:  # nor is what is no number
            what = "half a turn" if turns else f"{LARGEST_LENGTH:g} m"
            raise UsageError(
                f"the joint error of {quote(name)} is {value:g} {'rad' if turns else 'm'}, not a number below {what}",
                remedy="check the unit",
            )
    return errors


def _listed(names: Sequence[str]) -> str:
    return ", ".join([cut(name) for name in names[:12]] + (["..."] if len(names) > 12 else []))


def _numbers(values: object, given: object, names: Sequence[str]) -> Array:
    try:
        numbers = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError):
        numbers = np.zeros(0)
    if values is None or numbers.ndim != 1 or not numbers.size:
        raise UsageError(
            f"{quote(str(given))} is no joint error, nor a list of them",
            remedy=f"for instance 0.001, or {cut(names[0])}=0.001",
        )
    return numbers


def displaced(robot: Robot, q: Array, steps: Array) -> Array:
    """Return the configurations that finite joint motions lead to: q + d, joint by joint.

    A floating or planar joint moves along its constant twist, T exp(d). (..., nq), (..., nv) -> (..., nq).
    """
    leading = np.broadcast_shapes(q.shape[:-1], steps.shape[:-1])
    end = np.broadcast_to(q, (*leading, q.shape[-1])).copy()
    for joint in robot.independent:
        part, step = end[..., robot.position_slices[joint.name]], steps[..., robot.velocity_slices[joint.name]]
        if joint.type is JointType.FLOATING:
            placed = se3.placement(so3.from_quaternion(part[..., 3:]), part[..., :3]) @ se3.exp(step)
            part[..., :3], part[..., 3:] = placed[..., :3, 3], so3.to_quaternion(placed[..., :3, :3])
        elif joint.type is JointType.PLANAR:
            twist = np.zeros((*leading, 6))
            twist[..., [0, 1, 5]] = step
            shift = so3.about(2, part[..., 2]) @ se3.exp(twist)[..., :3, 3, None]
            part += np.concatenate([shift[..., :2, 0], step[..., 2:]], -1)
        else:
            part += step
    return end


# --- the other way round: which joint resolution an accuracy needs -----------------------------------------------


@dataclass(frozen=True)
class Requirement:
    """Joint errors that a wanted accuracy allows.

    Attributes:
        factor: by which the given joint errors may be multiplied; infinite where they do not move the tool. (...).
        errors: the allowed errors, rad and m, infinite where a joint does not matter. (..., n).
        counts: encoder counts per turn of the joint that do not exceed them; NaN where a joint slides, or needs no
            encoder because it is taken as exact or does not matter. (..., n).
    """

    factor: Array
    errors: Array
    counts: Array

    @property
    def bits(self) -> Array:
        """The counts as bits of an absolute encoder, rounded up; NaN where there are none. (..., n)."""
        return np.ceil(np.log2(np.maximum(self.counts, 2.0)))


@dataclass(frozen=True)
class JointResolution:
    """The joint resolution that a wanted accuracy of the tool needs.

    Attributes:
        accuracy: the wanted position accuracy in m, or None.
        accuracy_angle: the wanted rotation accuracy in rad, or None.
        worst: what is allowed if the accuracy is to hold in the worst case.
        sigma: what is allowed if it is to hold for the root mean square of the error, independent errors assumed.
        alone: what each joint is allowed in the worst case if all others are exact; its `factor` is 1.
        decides: "position" or "rotation": which of the two allows less, in the worst case. (...).
        warnings: what is to be said of it.
    """

    accuracy: float | None
    accuracy_angle: float | None
    worst: Requirement
    sigma: Requirement
    alone: Requirement
    decides: Array
    warnings: tuple[str, ...] = ()


def joint_resolution(
    error: ToolError, *, accuracy: float | None = None, accuracy_angle: float | None = None
) -> JointResolution:
    """Return the joint errors that a wanted accuracy allows, and the encoders that they need.

    Tool errors are proportional to joint errors, so those given, d, may be multiplied by

        f = min(accuracy / |position error|, accuracy_angle / |rotation error|)

    in the worst case, and likewise for root mean squares. An encoder of N counts per turn whose reading is rounded to
    the nearest count is off by half a count at most, pi / N, so N = ceil(pi / (f |d_j|)) is needed; its error is spread
    evenly over a count, with a standard deviation of 2 pi / (N sqrt 12) (B. Widrow, "Statistical analysis of
    amplitude-quantized sampled-data systems", 1961), so N = ceil(pi / (sqrt 3 f |d_j|)) for one sigma.

    Args:
        error: the tool error of joint errors, of which the proportions count. See `tool_error`; shapes are (..., n).
        accuracy: the largest position error, in m.
        accuracy_angle: the largest rotation error, in rad.

    Raises:
        UsageError: neither is given, or one that is not positive and finite.
    """
    wanted = [(accuracy, error.translation, slice(0, 3)), (accuracy_angle, error.rotation, slice(3, 6))]
    for size, name in ((accuracy, "--accuracy"), (accuracy_angle, "--accuracy-angle")):
        if size is not None and not 0 < size < math.inf:
            raise UsageError(f"{name} is positive, not {size:g}", remedy="for instance 0.001")
    if accuracy is None and accuracy_angle is None:
        raise UsageError("no accuracy is wanted", remedy="give --accuracy in m, or --accuracy-angle")
    sizes, turning = np.abs(error.joint_error), np.array([unit == "rad" for unit in error.column_units])
    floor = error.certificate.tolerance
    worst, sigma, alone = [], [], []
    for size, part, rows in wanted:
        target = math.inf if size is None else size
        worst.append(_allowed(target, part.worst, floor * float(np.max(sizes))))
        sigma.append(_allowed(target, part.sigma, floor * float(np.max(sizes))))
        alone.append(_allowed(target, np.linalg.norm(error.matrix[..., rows, :], axis=-2), floor))
    factor, factor_sigma, single = (np.minimum(*pair) for pair in (worst, sigma, alone))
    errors, errors_sigma = (_times(each, sizes) for each in (factor, factor_sigma))
    half_count, deviation = np.pi, np.pi / math.sqrt(3)
    largest = np.where(np.isfinite(errors_sigma) & turning, errors_sigma, 0.0)
    warnings = []
    if np.any(largest > _LARGE):
        warnings.append(f"allowed joint errors are beyond {_LARGE:g} rad, where first order tells little")
    return JointResolution(
        accuracy,
        accuracy_angle,
        Requirement(factor, errors, _counts(half_count, errors, turning)),
        Requirement(factor_sigma, errors_sigma, _counts(deviation, errors_sigma, turning)),
        Requirement(np.ones_like(factor), single, _counts(half_count, single, turning)),
        np.where(worst[0] <= worst[1], "position", "rotation"),
        tuple(warnings),
    )


def _allowed(target: float, size: Array, floor: float) -> Array:
    """Return target / size; infinite where nothing is wanted, or where nothing but rounding moves."""
    return np.divide(target, size, out=np.full_like(size, np.inf), where=size > floor)


def _times(factor: Array, sizes: Array) -> Array:
    """Return factor x size of each joint, where one that is exact stays so. (...), (n,) -> (..., n)."""
    exact = np.broadcast_to(sizes == 0, (*factor.shape, len(sizes)))
    return np.multiply(factor[..., None], sizes, out=np.zeros(exact.shape), where=~exact)


def _counts(share: float, errors: Array, turning: Array) -> Array:
    """Return ceil(share / error) for joints that turn; what is a whole number but for rounding is that number."""
    needed = turning & np.isfinite(errors) & (errors > 0)
    counts = np.divide(share, errors, out=np.full_like(errors, np.nan), where=needed)
    return np.ceil(counts * (1 - 1e-12))
