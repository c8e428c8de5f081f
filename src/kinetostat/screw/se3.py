"""Placements: SE(3) as homogeneous matrices (..., 4, 4), and its algebra of twists (v, w), linear part first.

`T_a_b` maps coordinates in b to coordinates in a. Metres and radians. Equations: Lynch and Park, "Modern Robotics",
2017, section 3.3.
"""

from __future__ import annotations

import numpy as np

from kinetostat.conventions import Array
from kinetostat.screw import so3

__all__ = ["exp", "exp_along", "inverse", "log", "placement", "transform"]


def placement(rotation: Array, translation: Array) -> Array:
    """Return the matrix [[R, p], [0, 1]]. Shapes (..., 3, 3), (..., 3) -> (..., 4, 4)."""
    rotation, translation = np.asarray(rotation, dtype=np.float64), np.asarray(translation, dtype=np.float64)
    matrix = np.zeros((*np.broadcast_shapes(rotation.shape[:-2], translation.shape[:-1]), 4, 4))
    matrix[..., :3, :3] = rotation
    matrix[..., :3, 3] = translation
    matrix[..., 3, 3] = 1
    return matrix


def inverse(matrix: Array) -> Array:
    """Return T^-1 = [[R^T, -R^T p], [0, 1]]. Shapes (..., 4, 4) -> (..., 4, 4)."""
    transposed = np.swapaxes(matrix[..., :3, :3], -1, -2)
    return placement(transposed, -(transposed @ matrix[..., :3, 3, None])[..., 0])


def transform(matrix: Array, point: Array) -> Array:
    """Return R x + p: a point given in b, in coordinates of a. Shapes (..., 4, 4), (..., 3) -> (..., 3), m."""
    moved: Array = (matrix[..., :3, :3] @ np.asarray(point, dtype=np.float64)[..., None])[..., 0] + matrix[..., :3, 3]
    return moved


def exp(twist: Array) -> Array:
    """Return the placement that a constant twist (v, w) reaches in unit time: [[exp[w], V(w) v], [0, 1]].

    Shapes (..., 6) -> (..., 4, 4). v in m, w in rad.
    """
    twist = np.asarray(twist, dtype=np.float64)
    v, w = twist[..., :3], twist[..., 3:]
    return placement(so3.exp(w), (so3.left_jacobian(w) @ v[..., None])[..., 0])


def exp_along(screw: Array, q: Array, start: Array | None = None) -> Array:
    """Return start exp(S q) for one unit screw S = (v, w), |w| = 1 or w = 0, and many q.

    With the 4x4 matrix [S], exp(S q) = 1 + sin q [S] + (1 - cos q) [S]^2 + (q - sin q) ([S] + [S]^3): four constant
    matrices, so a batch costs three products of numbers. (For |w| = 1, [S]^4 = -[S]^2; the last term is the advance of
    a screw with pitch, and the whole of a slide.) Shapes (6,), (...), (4, 4) -> (..., 4, 4). q in rad or m.
    """
    matrix = np.zeros((4, 4))
    matrix[:3, :3], matrix[:3, 3] = so3.hat(screw[3:]), screw[:3]
    home = np.eye(4) if start is None else start
    square = matrix @ matrix
    angle = np.asarray(q, dtype=np.float64)[..., None, None]
    sine, versine = np.sin(angle), 2 * np.sin(angle / 2) ** 2
    turned = sine * (home @ matrix) + versine * (home @ square)
    moved: Array = home + turned + (angle - sine) * (home @ (matrix + square @ matrix))
    return moved


def log(matrix: Array) -> Array:
    """Return the twist (v, w) with exp(v, w) = T and |w| <= pi. Shapes (..., 4, 4) -> (..., 6)."""
    w = so3.log(matrix[..., :3, :3])
    v = (so3.inverse_left_jacobian(w) @ matrix[..., :3, 3, None])[..., 0]
    return np.concatenate([v, w], -1)
