"""Wanted poses: from the notations that people use to a placement, and how far a tool is from it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.configuration import LARGEST_LENGTH
from kinetostat.analysis.euler import EulerSequence, sequence_names
from kinetostat.conventions import Array
from kinetostat.errors import UsageError, quote
from kinetostat.screw import se3, so3

__all__ = ["NOTATIONS", "Pose", "pose", "pose_error"]

NOTATIONS = ("rpy", "xyzw", "wxyz", "rotvec", "axis-angle")  # and the 24 names of Euler sequences
_ROTATION = 1e-3  # how far a rotation that is typed may be from one
_REMEDY = "for instance 0.5,0,0.4 or '0.5,0,0.4 rpy 0,3.14,0', 7 numbers with a quaternion, 12 or 16 of a matrix"


@dataclass(frozen=True)
class Pose:
    """Where a tool ought to be, relative to an observer.

    Attributes:
        matrix: T_a_t, (..., 4, 4), m; its rotation is the identity where none is wanted.
        oriented: whether its rotation is wanted, or its position alone.
    """

    matrix: Array
    oriented: bool


def pose(wanted: str | Sequence[float] | Array, *, degrees: bool = False, quaternion_first: str = "x") -> Pose:
    """Return a pose from any of the usual notations.

    Args:
        wanted: three numbers (the position x, y, z in m); six (and roll, pitch, yaw); seven (and a quaternion); twelve
            or sixteen (the rows of a matrix); an array (..., 4, 4); or text with those numbers, or `x,y,z NOTATION
            a,b,c`, the notation being rpy, xyzw, wxyz (quaternions), rotvec, axis-angle (x,y,z,angle), or an Euler
            sequence such as zyz or fixed-xyz.
        degrees: angles are in degrees.
        quaternion_first: "x" if the quaternion of seven numbers is xyzw, "w" if it is wxyz.

    Raises:
        UsageError: another count of numbers, one that is not finite, a notation that is not known, no rotation.
    """
    if isinstance(wanted, str):
        words = wanted.replace(",", " ").split()
        named = next((i for i, word in enumerate(words) if not _is_number(word)), None)
        if named is not None:
            numbers = _numbers([*words[:named], *words[named + 1 :]], wanted)
            if named != 3:
                raise UsageError(f"{quote(wanted)} is no pose", remedy=_REMEDY)
            rotation = _named_rotation(words[named], numbers[3:], degrees)
            return Pose(se3.placement(rotation, numbers[:3]), oriented=True)
        return _from_numbers(_numbers(words, wanted), degrees, quaternion_first)
    numbers = _numbers(wanted, "a pose")
    if numbers.ndim >= 2 and numbers.shape[-2:] == (4, 4):
        return Pose(se3.placement(_rotation(numbers[..., :3, :3]), numbers[..., :3, 3]), oriented=True)
    return _from_numbers(numbers.reshape(-1), degrees, quaternion_first)


def _numbers(values: Sequence[str] | Sequence[float] | Array, shown: str) -> Array:
    try:
        numbers = np.array(values, dtype=np.float64)
    except ValueError:
        raise UsageError(f"{quote(shown)} is no pose", remedy=_REMEDY) from None
    if not np.all(np.abs(numbers) <= LARGEST_LENGTH):
        raise UsageError("a pose has finite numbers", remedy=f"each within {LARGEST_LENGTH:g}")
    return numbers


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _from_numbers(numbers: Array, degrees: bool, quaternion_first: str) -> Pose:
    count = len(numbers)
    if count == 3:
        return Pose(se3.placement(np.eye(3), numbers), oriented=False)
    if count in (12, 16):
        if count == 16 and not np.allclose(numbers[12:], [0, 0, 0, 1], atol=1e-9):
            raise UsageError("the last row of the matrix is not 0 0 0 1", remedy="give the matrix row by row")
        rows = numbers[:12].reshape(3, 4)
        return Pose(se3.placement(_rotation(rows[:, :3]), rows[:, 3]), oriented=True)
    if count not in (6, 7):
        raise UsageError(f"a pose of {count} numbers", remedy=_REMEDY)
    notation = "rpy" if count == 6 else "wxyz" if quaternion_first == "w" else "xyzw"
    return Pose(se3.placement(_named_rotation(notation, numbers[3:], degrees), numbers[:3]), oriented=True)


def _named_rotation(notation: str, numbers: Array, degrees: bool) -> Array:
    """Return the rotation that numbers write in a notation."""
    if notation not in NOTATIONS and notation not in sequence_names():
        known = "rpy, xyzw, wxyz, rotvec, axis-angle, zyz, zyx, fixed-xyz, ..."
        raise UsageError(f"there is no notation {quote(notation)}", remedy=f"write {known}")
    count = 4 if notation in ("xyzw", "wxyz", "axis-angle") else 3
    if len(numbers) != count:
        raise UsageError(f"{notation} takes {count} numbers, not {len(numbers)}", remedy=_REMEDY)
    angular = math.pi / 180 if degrees else 1.0
    if notation in ("xyzw", "wxyz"):
        length = float(np.linalg.norm(numbers))
        if abs(length - 1) > _ROTATION:
            raise UsageError(f"the quaternion has length {length:.6g}, not 1", remedy="give it with more digits")
        return so3.from_quaternion(numbers if notation == "xyzw" else np.roll(numbers, -1))
    if notation == "rotvec":
        return so3.exp(numbers * angular)
    if notation == "axis-angle":
        length = float(np.linalg.norm(numbers[:3]))
        if length == 0:
            raise UsageError("the axis is zero: it has no direction", remedy="write x,y,z,angle")
        return so3.exp(numbers[:3] / length * numbers[3] * angular)
    return EulerSequence.named(notation).rotation(numbers * angular)


def _rotation(matrix: Array) -> Array:
    """Return the rotation nearest to matrices (..., 3, 3) that are nearly one."""
    left, values, right = np.linalg.svd(matrix)
    if np.any(np.abs(values - 1) > _ROTATION) or np.any(np.linalg.det(matrix) < 0):
        raise UsageError("the matrix is no rotation", remedy="its columns are unit vectors, right-handed")
    nearest: Array = left @ right
    return nearest


def pose_error(placement: Array, target: Array, *, local: bool = False) -> Array:
    """Return how far a tool is from where it ought to be: (p* - p ; log(R* R^T)).

    The second half is the rotation vector that takes the tool's orientation to the wanted one; both in the observer's
    axes, or (local) in the tool's. It is 0 exactly where the two are the same, and its derivative by time is there
    minus the tool's velocity (v ; w). Shapes (..., 4, 4), (..., 4, 4) -> (..., 6), m and rad.
    """
    rotation = placement[..., :3, :3]
    turn = so3.log(target[..., :3, :3] @ np.swapaxes(rotation, -1, -2))
    error = np.concatenate([target[..., :3, 3] - placement[..., :3, 3], np.broadcast_to(turn, turn.shape)], -1)
    if not local:
        return error
    back = np.swapaxes(rotation, -1, -2)
    return np.concatenate([(back @ error[..., half, None])[..., 0] for half in (slice(3), slice(3, 6))], -1)
