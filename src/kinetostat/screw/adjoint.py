"""The adjoint representations: how twists and wrenches change with the frame, and with motion. Linear part first.

With T = T_a_b = (R, p):

    twists     V_a = Ad(T) V_b     Ad(T) = [[R, [p] R], [0, R]]
    wrenches   F_a = Ad*(T) F_b    Ad*(T) = Ad(T)^-T = [[R, 0], [[p] R, R]]

so that power is the same in both: F_a . V_a = F_b . V_b. Equations: Lynch and Park, "Modern Robotics", 2017, sections
3.3.2 and 3.4; Featherstone, "Rigid Body Dynamics Algorithms", 2008, section 2.9 for the brackets.
"""

from __future__ import annotations

import numpy as np

from kinetostat.conventions import Array
from kinetostat.screw.so3 import hat

__all__ = ["adjoint", "bracket", "carry", "coadjoint", "cross", "twist_matrix"]


def adjoint(placement: Array) -> Array:
    """Return Ad(T), which carries twists from b to a for T = T_a_b. Shapes (..., 4, 4) -> (..., 6, 6)."""
    rotation, moment = _parts(placement)
    return _blocks(rotation, moment, np.zeros_like(rotation), rotation)


def carry(placement: Array, twists: Array) -> Array:
    """Return Ad(T) S for constant twists S, the columns of a matrix, without writing Ad(T) out.

    Shapes (..., 4, 4), (6, k) -> (..., 6, k).
    """
    parts = np.zeros((4, 2 * twists.shape[1]))
    parts[:3] = np.hstack([twists[:3], twists[3:]])
    turned = np.dot(placement, parts)[..., :3, :]  # one matrix product for a whole batch
    linear, angular = np.split(turned, 2, axis=-1)
    return np.concatenate([linear + cross(placement[..., :3, 3, None], angular), angular], -2)


def cross(a: Array, b: Array) -> Array:
    """Return a x b along the last axis but one: of columns. Shapes (..., 3, n), (..., 3, n) -> (..., 3, n)."""
    ax, ay, az = a[..., 0, :], a[..., 1, :], a[..., 2, :]
    bx, by, bz = b[..., 0, :], b[..., 1, :], b[..., 2, :]
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], -2)


def coadjoint(placement: Array) -> Array:
    """Return Ad*(T) = Ad(T)^-T, which carries wrenches from b to a for T = T_a_b. Shapes (..., 4, 4) -> (..., 6, 6)."""
    rotation, moment = _parts(placement)
    return _blocks(rotation, np.zeros_like(rotation), moment, rotation)


def bracket(first: Array, second: Array) -> Array:
    """Return the Lie bracket [X, Y] = ad(X) Y = (w x v' - w' x v, w x w') of twists. Shapes (..., 6) -> (..., 6)."""
    v, w = first[..., :3], first[..., 3:]
    other_v, other_w = second[..., :3], second[..., 3:]
    return np.concatenate([np.cross(w, other_v) + np.cross(v, other_w), np.cross(w, other_w)], -1)


def twist_matrix(twist: Array) -> Array:
    """Return ad(V) = [[[w], [v]], [0, [w]]], with ad(V) X = [V, X]. Shapes (..., 6) -> (..., 6, 6)."""
    v, w = hat(twist[..., :3]), hat(twist[..., 3:])
    return _blocks(w, v, np.zeros_like(w), w)


def _parts(placement: Array) -> tuple[Array, Array]:
    rotation = placement[..., :3, :3]
    return rotation, hat(placement[..., :3, 3]) @ rotation


def _blocks(a: Array, b: Array, c: Array, d: Array) -> Array:
    matrix = np.empty((*a.shape[:-2], 6, 6))
    matrix[..., :3, :3], matrix[..., :3, 3:] = a, b
    matrix[..., 3:, :3], matrix[..., 3:, 3:] = c, d
    return matrix
