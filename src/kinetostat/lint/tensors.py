"""Tensors of inertia as written: principal moments, what no body can have, what rounding explains."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

__all__ = ["MOMENTS", "NO_MASS", "Flaw", "Rounding", "deficit", "flaw_of", "matrix", "principal_moments", "rounding_of"]

MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
NO_MASS = 1e-15  # kg, kg m2: MuJoCo's mjMINVAL; below it a body counts as massless
POINT_RADIUS = 1e-6  # m: a radius of gyration below it is a zero with rounding noise
NOISE = 1e-9  # relative: below it a moment or a deficit is rounding of the arithmetic
MOST_ROUNDING = 0.1  # a number is not taken for rounded by more than that part of itself
_DIGITS = re.compile(r"[+-]?[0-9]*\.?([0-9]*)(?:[eE]([+-]?[0-9]+))?")


class Flaw(StrEnum):
    """What no rigid body of some size can have as its tensor; the first that applies."""

    ZERO = "zero"  # a point mass, or rounding noise
    ALIKE = "alike"  # all six entries are the same number
    NEGATIVE = "negative"  # a principal moment below zero
    SINGULAR = "singular"  # a principal moment of zero
    TRIANGLE = "triangle"  # two principal moments together below the third
    ROUNDED = "rounded"  # the same, but no more than the digits written explain


@dataclass(frozen=True)
class Rounding:
    """How much of a moment below zero, and of a deficit, rounding explains, kg m2."""

    moment: float = 0.0
    deficit: float = 0.0


def matrix(entries: Sequence[float] | Sequence[Sequence[float]] | np.ndarray) -> np.ndarray:
    """Return the symmetric matrix of ixx, ixy, ixz, iyy, iyz, izz. Shapes (..., 6) -> (..., 3, 3)."""
    return np.asarray(entries, dtype=float)[..., [[0, 1, 2], [1, 3, 4], [2, 4, 5]]]


def principal_moments(entries: Sequence[float]) -> tuple[float, float, float]:
    """Return the principal moments of ixx, ixy, ixz, iyy, iyz, izz, ascending."""
    low, middle, high = np.linalg.eigvalsh(matrix(entries))
    return float(low), float(middle), float(high)


def deficit(principal: Sequence[float]) -> float:
    """Return by how much the two smaller principal moments together are below the third; negative if they are not."""
    low, middle, high = principal
    return float(high - low - middle)


def flaw_of(mass: float, entries: Sequence[float], principal: Sequence[float], rounding: Rounding) -> Flaw | None:
    """Return what is wrong with a tensor, whose entries may have been rounded."""
    size = max(map(abs, principal))
    if mass <= NO_MASS:
        return None
    if size <= max(POINT_RADIUS**2 * mass, NO_MASS):
        return Flaw.ZERO
    if len(set(entries)) == 1:
        return Flaw.ALIKE
    if principal[0] < -max(NOISE * size, rounding.moment):
        return Flaw.NEGATIVE
    if principal[0] <= NOISE * size:
        return Flaw.SINGULAR
    short = deficit(principal)
    if short <= NOISE * size:
        return None
    return Flaw.ROUNDED if short <= rounding.deficit else Flaw.TRIANGLE


def rounding_of(words: Sequence[str]) -> Rounding:
    """Return how much the rounding of six written entries explains at most.

    The largest principal moment is a convex function of the tensor, with the derivative v v^T for its axis v, and the
    least a concave one: so no change of the entries moves the moment by more than that of the diagonal and those of the
    products, nor the deficit by more than those of the diagonal and twice those of the products, added up.
    """
    xx, xy, xz, yy, yz, zz = (_half_a_digit(word) for word in words)
    return Rounding(max(xx, yy, zz) + xy + xz + yz, xx + yy + zz + 2 * (xy + xz + yz))


def _half_a_digit(word: str) -> float:
    """Return half a unit in the last digit of a number as written; less if it has one digit only."""
    found = _DIGITS.fullmatch(word.strip())
    if found is None:
        return 0.0
    power = float(found[2] or 0) - len(found[1])  # as float: the digits of an exponent may be thousands
    return float(min(0.5 * 10.0 ** max(min(power, 100.0), -300.0), MOST_ROUNDING * abs(float(word))))
