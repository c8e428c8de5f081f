"""Rotations: SO(3) and its algebra, for arrays of any leading shape.

Equations follow J. Solà, J. Deray, D. Atchuthan, "A micro Lie theory for state estimation in robotics", 2018, and
K. Lynch, F. Park, "Modern Robotics", 2017, chapter 3. Angles in radians.
"""

from __future__ import annotations

import numpy as np

from kinetostat.conventions import Array

__all__ = [
    "carry_z_to",
    "exp",
    "from_quaternion",
    "from_rpy",
    "hat",
    "left_jacobian",
    "log",
    "to_quaternion",
    "to_rpy",
    "vee",
]

# Below this angle the closed forms lose digits to cancellation and their power series have converged.
_SERIES_BELOW = 0.25


def hat(w: Array) -> Array:
    """Return the matrix [w] with [w] u = w x u. Shapes (..., 3) -> (..., 3, 3)."""
    w = np.asarray(w, dtype=np.float64)
    matrix = np.zeros((*w.shape, 3))
    matrix[..., 2, 1], matrix[..., 1, 2] = w[..., 0], -w[..., 0]
    matrix[..., 0, 2], matrix[..., 2, 0] = w[..., 1], -w[..., 1]
    matrix[..., 1, 0], matrix[..., 0, 1] = w[..., 2], -w[..., 2]
    return matrix


def vee(matrix: Array) -> Array:
    """Return w of a skew matrix [w]; of any other, of its skew part. Shapes (..., 3, 3) -> (..., 3)."""
    m = matrix
    return 0.5 * np.stack([m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]], -1)


def _sinc(angle: Array) -> Array:
    """sin(t)/t."""
    return np.sinc(angle / np.pi)


def _versine_ratio(angle: Array) -> Array:
    """(1 - cos t)/t^2, by the half angle, which does not cancel."""
    return 0.5 * _sinc(angle / 2) ** 2


def _sine_deficit_ratio(angle: Array) -> Array:
    """(t - sin t)/t^3."""
    t2 = angle**2
    series = 1 / 6 - t2 / 120 * (1 - t2 / 42 * (1 - t2 / 72 * (1 - t2 / 110 * (1 - t2 / 156))))
    safe = np.where(angle < _SERIES_BELOW, 1.0, angle)
    return np.where(angle < _SERIES_BELOW, series, (safe - np.sin(safe)) / safe**3)


def exp(w: Array) -> Array:
    """Return the rotation by |w| about w: exp[w] = 1 + sin t/t [w] + (1 - cos t)/t^2 [w]^2 with t = |w| (Rodrigues).

    Shapes (..., 3) -> (..., 3, 3). w in rad.
    """
    w = np.asarray(w, dtype=np.float64)
    angle = np.linalg.norm(w, axis=-1)[..., None, None]
    skew = hat(w)
    rotation: Array = np.eye(3) + _sinc(angle) * skew + _versine_ratio(angle) * (skew @ skew)
    return rotation


def log(rotation: Array) -> Array:
    """Return w with exp[w] = R and |w| <= pi, accurate to the last bits at 0 and at pi.

    By way of the unit quaternion (v, c), c >= 0: w = 2 atan2(|v|, c) v/|v|. At pi exactly, either sign of the axis is
    right; the one that `to_quaternion` gives is returned. Shapes (..., 3, 3) -> (..., 3), rad.
    """
    quaternion = to_quaternion(rotation)
    vector, cosine = quaternion[..., :3], quaternion[..., 3]
    sine = np.linalg.norm(vector, axis=-1)
    safe = np.where(sine > 0, sine, 1.0)
    ratio = np.where(sine > 0, 2 * np.arctan2(sine, cosine) / safe, 2.0)
    w: Array = ratio[..., None] * vector
    return w


def left_jacobian(w: Array) -> Array:
    """Return the left Jacobian of exp: V = 1 + (1 - cos t)/t^2 [w] + (t - sin t)/t^3 [w]^2.

    It is the V of SE(3): exp(v, w) has the translation V v. Shapes (..., 3) -> (..., 3, 3).
    """
    w = np.asarray(w, dtype=np.float64)
    angle = np.linalg.norm(w, axis=-1)[..., None, None]
    skew = hat(w)
    jacobian: Array = np.eye(3) + _versine_ratio(angle) * skew + _sine_deficit_ratio(angle) * (skew @ skew)
    return jacobian


def inverse_left_jacobian(w: Array) -> Array:
    """Return the inverse of the left Jacobian for |w| < 2 pi: 1 - [w]/2 + (1 - (t/2) cot(t/2))/t^2 [w]^2.

    Shapes (..., 3) -> (..., 3, 3).
    """
    w = np.asarray(w, dtype=np.float64)
    angle = np.linalg.norm(w, axis=-1)[..., None, None]
    t2 = angle**2
    series = 1 / 12 + t2 / 720 * (1 + t2 / 42 * (1 + t2 / 40 * (1 + t2 * 10 / 396)))
    safe = np.where(angle < _SERIES_BELOW, 1.0, angle)
    closed = (1 - (safe / 2) * np.cos(safe / 2) / np.sin(safe / 2)) / safe**2
    skew = hat(w)
    inverse: Array = np.eye(3) - 0.5 * skew + np.where(angle < _SERIES_BELOW, series, closed) * (skew @ skew)
    return inverse


def to_quaternion(rotation: Array) -> Array:
    """Return the unit quaternion xyzw with w >= 0 of a rotation. Shapes (..., 3, 3) -> (..., 4).

    Divides by the largest of the four components, so that none loses digits (S. W. Shepperd, "Quaternion from rotation
    matrix", J. Guidance and Control 1(3), 1978).
    """
    r = np.asarray(rotation, dtype=np.float64)
    r00, r11, r22 = r[..., 0, 0], r[..., 1, 1], r[..., 2, 2]
    a, b, c = r[..., 2, 1] - r[..., 1, 2], r[..., 0, 2] - r[..., 2, 0], r[..., 1, 0] - r[..., 0, 1]
    d, e, f = r[..., 0, 1] + r[..., 1, 0], r[..., 0, 2] + r[..., 2, 0], r[..., 1, 2] + r[..., 2, 1]
    # Row k is 4 q_k q for k = x, y, z, w: the row of the largest component is the accurate one.
    rows = np.stack(
        [
            np.stack([1 + r00 - r11 - r22, d, e, a], -1),
            np.stack([d, 1 - r00 + r11 - r22, f, b], -1),
            np.stack([e, f, 1 - r00 - r11 + r22, c], -1),
            np.stack([a, b, c, 1 + r00 + r11 + r22], -1),
        ],
        -2,
    )
    largest = np.argmax(np.diagonal(rows, axis1=-2, axis2=-1), axis=-1)
    row = np.take_along_axis(rows, largest[..., None, None], axis=-2)[..., 0, :]
    row = row / np.linalg.norm(row, axis=-1, keepdims=True)
    quaternion: Array = np.where(row[..., 3:] < 0, -row, row)
    return quaternion


def from_quaternion(xyzw: Array) -> Array:
    """Return the rotation of a quaternion xyzw of any length but zero. Shapes (..., 4) -> (..., 3, 3)."""
    q = np.asarray(xyzw, dtype=np.float64)
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    skew = hat(q[..., :3])
    rotation: Array = np.eye(3) + 2 * q[..., 3, None, None] * skew + 2 * (skew @ skew)
    return rotation


def about(axis: int, angle: Array) -> Array:
    """Return the rotation by `angle` about coordinate axis 0, 1 or 2. Shapes (...) -> (..., 3, 3)."""
    angle = np.asarray(angle, dtype=np.float64)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    rotation = np.zeros((*angle.shape, 3, 3))
    rotation[..., axis, axis] = 1
    rotation[..., i, i] = rotation[..., j, j] = np.cos(angle)
    rotation[..., j, i] = np.sin(angle)
    rotation[..., i, j] = -rotation[..., j, i]
    return rotation


def from_rpy(rpy: Array) -> Array:
    """Return the rotation of URDF's roll, pitch, yaw (fixed axes XYZ): R = Rz(yaw) Ry(pitch) Rx(roll).

    Shapes (..., 3) -> (..., 3, 3), rad.
    """
    rpy = np.asarray(rpy, dtype=np.float64)
    return about(2, rpy[..., 2]) @ about(1, rpy[..., 1]) @ about(0, rpy[..., 0])


def to_rpy(rotation: Array) -> Array:
    """Return roll, pitch, yaw of a rotation, pitch in [-pi/2, pi/2]; at its ends yaw is chosen 0.

    Roll is taken after the yaw is turned back, so that the three name the rotation to the last bits near the ends too.
    Shapes (..., 3, 3) -> (..., 3), rad.
    """
    r = np.asarray(rotation, dtype=np.float64)
    level = np.hypot(r[..., 0, 0], r[..., 1, 0])
    yaw = np.where(level < 1e-15, 0.0, np.arctan2(r[..., 1, 0], r[..., 0, 0]))
    sine, cosine = np.sin(yaw), np.cos(yaw)
    roll = np.arctan2(sine * r[..., 0, 2] - cosine * r[..., 1, 2], cosine * r[..., 1, 1] - sine * r[..., 0, 1])
    return np.stack([roll, np.arctan2(-r[..., 2, 0], level), yaw], -1)


def carry_z_to(axis: Array) -> Array:
    """Return the smallest rotation that carries z to a unit axis; for -z, the half turn about x. Shape (3,) -> (3, 3).

    It fixes the directions x and y of a planar joint whose normal is not z, which URDF leaves open.
    """
    x, y, z = (float(c) for c in axis)
    if x == 0 and y == 0:
        return np.diag([1.0, 1.0, 1.0]) if z > 0 else np.diag([1.0, -1.0, -1.0])
    w = np.array([-y, x, 0.0])
    sine = float(np.hypot(x, y))
    return exp(w / sine * np.arctan2(sine, z))
