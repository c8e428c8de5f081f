"""Families in which one joint's position alone makes the arm singular, found completely.

With random constant matrices P (r, m) and Q (n, r), d(q) = det(P J(q) Q) is a random combination of all r x r minors
of J (Cauchy-Binet), so that J is singular where d vanishes for several independent P, Q. Along one coordinate t, the
others held, d is a trigonometric polynomial if the joint turns (degree 2 at most for six rows: a minor is a product of
one of the screws before the joint and one of those after it, which turn together) or a polynomial if it slides.
t = c is a family where d vanishes for all other positions: where all those polynomials have c as a common root. They
span a space of few dimensions, which random positions of the others span with probability one; so a few dozen lines,
each sampled at a few points, decide. The degree is not assumed but checked, by more points than it needs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from kinetostat.analysis.singular.mechanism import MODEL, Mechanism
from kinetostat.conventions import Array

__all__ = ["SingleJoint", "single_joint_families"]

_LINES = 24  # positions of the other joints
_COMBINATIONS = 3  # of minors
_HARMONICS = 6  # sampled for each turn of a screw; the degree must turn out lower
_MOST_HARMONICS = 120
_NODES = 13
_DRAWS = 512  # at which a root is tried
_NEAR = 1e-3  # value below which a stationary point may be a root
_NEGLIGIBLE = 1e-9  # of the largest coefficient


@dataclass(frozen=True)
class SingleJoint:
    """The positions of one coordinate that make the arm singular whatever the others do.

    Attributes:
        index: which coordinate.
        positions: the roots, in rad in (-pi, pi] or in m.
        degree: degree of the polynomial; None where there is none, so that nothing is claimed to be complete.
    """

    index: int
    positions: tuple[float, ...]
    degree: int | None


def single_joint_families(mechanism: Mechanism, seed: int) -> tuple[SingleJoint, ...]:
    """Return the single-joint families of every coordinate, in path order.

    A slide's are those inside its range, lengthened by the range itself on both sides.
    """
    generator = np.random.default_rng(seed)
    return tuple(_along(mechanism, i, generator) for i in range(len(mechanism.names)))


def _along(mechanism: Mechanism, index: int, generator: np.random.Generator) -> SingleJoint:
    turns = mechanism.periodic[index]
    lower, upper = mechanism.spans[0][index], mechanism.spans[1][index]
    if turns:
        # A minor is a product of two parts of at most two harmonics for each screw that the coordinate drives.
        harmonics = _HARMONICS * int(np.round(np.sum(np.abs(mechanism.chain.fold[:, index]))))
        if harmonics > _MOST_HARMONICS:
            return SingleJoint(index, (), None)
        nodes = 2 * np.pi * np.arange(2 * harmonics + 1) / (2 * harmonics + 1)
    else:
        middle, half = (lower + upper) / 2, 1.5 * (upper - lower)
        nodes = middle + half * np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)
    q = np.repeat(mechanism.draw(generator, (_LINES, 1)), len(nodes), axis=1)
    q[..., index] = nodes
    values = _minors(mechanism, q, generator)  # (lines * combinations, nodes)
    if turns:
        coefficients = np.fft.fft(values, axis=-1) / len(nodes)
        order = np.fft.fftfreq(len(nodes), 1 / len(nodes)).round().astype(int)
        roots, degree = _trigonometric_roots(coefficients, order)
    else:
        series = np.polynomial.chebyshev.chebfit((nodes - middle) / half, values.T, _NODES - 1).T
        found, degree = _polynomial_roots(series)
        roots = [middle + half * root for root in found]
    checked = [root for root in roots if _holds(mechanism, index, root, generator)]
    return SingleJoint(index, tuple(checked), degree)


def _minors(mechanism: Mechanism, q: Array, generator: np.random.Generator) -> Array:
    """Return det(P J Q) for random P, Q: (lines, nodes, n) -> (lines * combinations, nodes)."""
    matrix, rank = mechanism.jacobian(q), mechanism.generic_rank
    rows, columns = matrix.shape[-2:]
    found = []
    for _ in range(_COMBINATIONS):
        left = np.eye(rank) if rows == rank else np.linalg.qr(generator.normal(size=(rows, rank)))[0].T
        right = np.eye(rank) if columns == rank else np.linalg.qr(generator.normal(size=(columns, rank)))[0]
        found.append(np.linalg.det(left @ matrix @ right))
    return np.concatenate(found)


def _degree(coefficients: Any, order: Any) -> int | None:
    """Return the highest order that is not negligible; None if that is the highest sampled: no polynomial."""
    sizes = np.max(np.abs(coefficients), axis=0)
    used = order[sizes > _NEGLIGIBLE * np.max(sizes)] if np.max(sizes) > 0 else np.zeros(1, dtype=int)
    degree = int(np.max(np.abs(used), initial=0))
    return degree if degree < np.max(np.abs(order)) else None


def _trigonometric_roots(coefficients: Any, order: Any) -> tuple[list[float], int | None]:
    """Return the common roots in (-pi, pi] of functions sum_k c_k exp(i k t), and their degree."""
    degree = _degree(coefficients, order)
    if not degree:
        return [], degree
    powers = np.arange(-degree, degree + 1)
    taken = np.stack([coefficients[:, order == k][:, 0] for k in powers], -1)
    basis = _spanning(taken)

    def derivative(t: float, times: int) -> Any:
        return (basis * (1j * powers) ** times) @ np.exp(1j * powers * t)

    # The sum of squares is a trigonometric polynomial, too; its stationary points are the roots of its derivative.
    squares = sum(np.convolve(row, np.conj(row[::-1])) for row in basis)
    slopes = squares * 1j * np.arange(-2 * degree, 2 * degree + 1)
    stationary = [float(np.angle(root)) for root in np.roots(slopes[::-1]) if abs(abs(root) - 1) < 1e-2]
    found = [_polished(derivative, t, 2 * degree) for t in stationary]
    wrapped = [float(np.pi - (np.pi - t) % (2 * np.pi)) for t in found if t is not None]
    return _distinct([t if t > -np.pi + 1e-9 else np.pi for t in wrapped]), degree


def _polynomial_roots(series: Array) -> tuple[list[float], int | None]:
    """Return the common roots in [-1, 1] of Chebyshev series, and their degree."""
    degree = _degree(series, np.arange(series.shape[-1]))
    if not degree:
        return [], degree
    chebyshev = np.polynomial.chebyshev
    basis = _spanning(series[:, : degree + 1]).real

    def derivative(t: float, times: int) -> Any:
        return chebyshev.chebval(t, chebyshev.chebder(basis.T, times)) if times <= degree else np.zeros(1)

    squares = sum(chebyshev.chebmul(row, row) for row in basis)
    stationary = chebyshev.chebroots(chebyshev.chebder(squares))
    found = [_polished(derivative, float(t.real), degree) for t in stationary if abs(t.imag) < 1e-2]
    return _distinct([t for t in found if t is not None and abs(t) <= 1]), degree


def _spanning(coefficients: Any) -> Any:
    """Return an orthonormal basis of the space that the rows span, each weighed by how much of it there is."""
    _, sizes, rows = np.linalg.svd(coefficients, full_matrices=False)
    keep = sizes > _NEGLIGIBLE * sizes[0]
    return rows[keep] * (sizes[keep] / sizes[0])[:, None]


def _polished(evaluate: Callable[[float, int], Any], start: float, degree: int) -> float | None:
    """Return the common root near a stationary point, to full accuracy even where it is multiple; None if none is.

    `evaluate` gives the functions' derivative of some order at a position.
    """
    multiplicity = 0
    while multiplicity <= degree and float(np.linalg.norm(evaluate(start, multiplicity))) < _NEAR:
        multiplicity += 1
    if multiplicity == 0:
        return None
    t = start
    for _ in range(8):  # Gauss-Newton on the derivative that has a simple root there
        value, slope = evaluate(t, multiplicity - 1), evaluate(t, multiplicity)
        t -= float(np.real(np.vdot(slope, value)) / np.real(np.vdot(slope, slope)))
    return t if float(np.linalg.norm(evaluate(t, 0))) < MODEL else None


def _distinct(values: list[float]) -> list[float]:
    kept = list[float]()
    for value in sorted(values):
        if not kept or value - kept[-1] > 1e-4:
            kept.append(value)
    return kept


def _holds(mechanism: Mechanism, index: int, position: float, generator: np.random.Generator) -> bool:
    """Return whether the arm is singular there at random positions of the others."""
    q = mechanism.draw(generator, (_DRAWS,))
    q[:, index] = position
    return bool(np.max(mechanism.smallest(q)) < MODEL)
