"""Accuracy: which error joint errors make at the tool, and which joint resolution a wanted accuracy needs; certified.

Errors are small joint motions d, so to first order the tool is off by J d. What that leaves out is told beside it, by
forward kinematics.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.configuration import checked, displaced
from kinetostat.analysis.crosscheck import Certificate, certified, length_scale
from kinetostat.analysis.jacobian import labelled
from kinetostat.analysis.joint_errors import UNIT_ERROR, JointErrors, joint_errors
from kinetostat.analysis.task import pointing_up, turning_columns
from kinetostat.analysis.zonotope import farthest, tried_whole
from kinetostat.conventions import Array, Reference, Velocity
from kinetostat.engines.model import Model
from kinetostat.engines.protocol import Engine
from kinetostat.errors import UsageError, quote
from kinetostat.screw import se3, so3

__all__ = ["ErrorPart", "ToolError", "tool_error"]

_FIRST_ORDER = 0.05  # of the worst case: a larger remainder is warned of


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
    exact = tried_whole(scaled)
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
        pointing_up(axes),
        lengths,
        np.divide(squares, np.sum(squares, -1, keepdims=True), out=np.zeros_like(squares), where=moving),
    )
