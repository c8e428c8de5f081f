"""Singular values by one-sided Jacobi rotations of a triangle, over lanes.

The columns of L = R^T are turned against each other, pair by pair, until they are orthogonal; their lengths are then
the singular values, and their directions the right singular vectors of R (and of X = Q R). M. Hestenes, 1958; that the
triangle R^T converges sooner than X: Z. Drmac and K. Veselic, "New fast and accurate Jacobi SVD algorithm I", SIAM J.
Matrix Analysis and Applications 29(4), 2008 (who pivot, for relative accuracy; this does not). Of each pair the longer
comes out first (P. de Rijk, 1989), so the values come out in order, but for rounding.

Accuracy: |s - s_exact| is below 2e-14 of the largest singular value (a test measures it, clusters and repeated values
too), of small ones as well as of large ones, because L is never multiplied by its transpose.

The number k of columns is that of the entries of `size`, a tuple: a constant of the compiled code, which unrolls by it.
Columns are flat: k rows of lanes each, and one more for the length.
"""

from __future__ import annotations

import numpy as np

from kinetostat.screw.compiled.compiling import LANES, compiled
from kinetostat.screw.compiled.lanes import rows

__all__ = ["orthogonalise", "set_transposed"]

_TINY = 1e-145  # keeps 0 / 0 from being: columns as long as each other and orthogonal stay as they are
_SWEEPS = 30  # at most; 4 to 6 are usual
_ORTHOGONAL = 1e-29  # cosine squared. Rounding leaves 1e-32; far above it, values in a narrow cluster are not found yet
_ROUNDING = 1e-34  # square of 1e-17: a column so short, against the longest, is rounding itself


@compiled
def set_transposed(triangle, columns, size):
    """Set the columns of L = R^T, which are the rows of R."""
    k = len(size)
    for c in range(k):
        column, row = rows(columns, c * (k + 1), k), rows(triangle, c * k, k)
        for lane in range(c * LANES):
            column[lane] = 0.0
        for lane in range(c * LANES, k * LANES):
            column[lane] = row[lane]


@compiled
def _set_square(column, size):
    """Set the last row of a column to the square of its length."""
    k = len(size)
    for lane in range(LANES):
        total = 0.0
        for i in range(k):
            total += column[i * LANES + lane] * column[i * LANES + lane]
        column[k * LANES + lane] = total


@compiled
def _rotate(a, b, status, size):
    """Turn columns a and b in their plane so that they are orthogonal and a is the longer.

    With g = a.b and d = |a|^2 - |b|^2 the smaller angle has (cos, sin) along (e, 2 g), e = |d| + sqrt(d^2 + 4 g^2): no
    angle where both are zero. Row 0 of `status` becomes positive where they were not orthogonal before; row 1 is the
    square below which a column is rounding; where row 2 is zero, all pairs are orthogonal already.
    """
    k = len(size)
    for lane in range(LANES):
        g = 0.0
        for i in range(k):
            g += a[i * LANES + lane] * b[i * LANES + lane]
        aa, bb = a[k * LANES + lane], b[k * LANES + lane]
        d = aa - bb
        e = abs(d) + np.sqrt(d * d + 4.0 * g * g) + _TINY
        f = 1.0 / np.sqrt(e * e + 4.0 * g * g)
        near, far = e * f, 2.0 * g * f
        p = near if d >= 0.0 else far
        q = far if d >= 0.0 else near
        p = p if status[2 * LANES + lane] > 0.0 else 1.0
        q = q if status[2 * LANES + lane] > 0.0 else 0.0
        left = min(g * g - _ORTHOGONAL * (aa * bb), min(aa, bb) - status[LANES + lane])
        status[lane] = max(status[lane], left)
        cross = 2.0 * p * q * g
        a[k * LANES + lane] = p * p * aa + q * q * bb + cross
        b[k * LANES + lane] = q * q * aa + p * p * bb - cross
        for i in range(k):
            x, y = a[i * LANES + lane], b[i * LANES + lane]
            a[i * LANES + lane] = p * x + q * y
            b[i * LANES + lane] = p * y - q * x


@compiled
def _sweep(columns, status, size):
    """Rotate every pair once; return whether one of them was not orthogonal before.

    Configurations that were finished before this sweep are left as they are, so that none depends on its neighbours.
    """
    k = len(size)
    step = k + 1
    for lane in range(LANES):
        status[2 * LANES + lane] = status[lane]
        status[lane] = 0.0
        status[LANES + lane] = 0.0
    for c in range(k):
        column = rows(columns, c * step, step)
        _set_square(column, size)
        for lane in range(LANES):
            status[LANES + lane] = max(status[LANES + lane], _ROUNDING * column[k * LANES + lane])
    for a in range(k - 1):
        for b in range(a + 1, k):
            _rotate(rows(columns, a * step, step), rows(columns, b * step, step), status, size)
    left = 0.0
    for lane in range(LANES):
        left = max(left, status[lane])
    return left > 0.0


@compiled
def orthogonalise(columns, status, size):
    """Turn k columns until they are orthogonal, the longest first, their lengths in their last rows."""
    k = len(size)
    for lane in range(LANES):
        status[lane] = 1.0
    for _ in range(_SWEEPS):
        if not _sweep(columns, status, size):
            break
    for c in range(k):
        column = rows(columns, c * (k + 1), k + 1)
        _set_square(column, size)
        for lane in range(LANES):
            column[k * LANES + lane] = np.sqrt(column[k * LANES + lane])
