"""Triangles: X = Q R by Householder's reflections, over lanes. R has the singular values of X.

Backward stable (A. Householder, 1958; N. Higham, "Accuracy and Stability of Numerical Algorithms", 2002, chapter 19):
what is found belongs to a matrix within a few units in the last place of X, which J J^T does not give.
X is flat, p rows of k entries, p >= k. Numbers that the compiler is to unroll by are the lengths of tuples: k is
len(size), the column that is reflected len(pivot).
"""

from __future__ import annotations

import numpy as np

from kinetostat.screw.compiled.compiling import LANES, compiled
from kinetostat.screw.compiled.lanes import rows

__all__ = ["to_triangle", "volume"]

_TINY = 1e-300  # keeps 0 / 0 from being: a column of zeros is reflected by nothing


@compiled
def _add_products(dots, v, x, pivot, size):
    """Keep x_j of a row of X in v, and add x_j times the entries from j on to the dots."""
    j, k = len(pivot), len(size)
    for lane in range(LANES):
        own = x[j * LANES + lane]
        v[lane] = own
        for c in range(j, k):
            dots[c * LANES + lane] += own * x[c * LANES + lane]


@compiled
def _subtract_products(dots, v, x, pivot, size):
    """Subtract v times the dots from the entries after j of a row of X."""
    j, k = len(pivot), len(size)
    for lane in range(LANES):
        own = v[lane]
        for c in range(j + 1, k):
            x[c * LANES + lane] -= own * dots[c * LANES + lane]


@compiled
def _reflector(dots, v, x, pivot, size):
    """From the products of x_j with all columns: the diagonal entry of R, and 2 v.x / |v|^2 with v = x_j - R_jj e_j.

    Row j of X becomes that of R here: rows after it are left to `_subtract_products`.
    """
    j, k = len(pivot), len(size)
    for lane in range(LANES):
        length, top = np.sqrt(dots[j * LANES + lane]), v[lane]
        diagonal = -np.copysign(length, top)
        reached = top - diagonal
        scale = 1.0 / max(length * abs(reached), _TINY)
        v[lane] = reached
        x[j * LANES + lane] = diagonal
        for c in range(j + 1, k):
            entry = x[c * LANES + lane]
            factor = scale * (dots[c * LANES + lane] - diagonal * entry)
            dots[c * LANES + lane] = factor
            x[c * LANES + lane] = entry - reached * factor


@compiled
def _reflect(x, count, dots, v, pivot, size):
    """Reflect the columns from j on, so that entries of column j below row j vanish (they are not written)."""
    j, k = len(pivot), len(size)
    for lane in range(j * LANES, k * LANES):
        dots[lane] = 0.0
    for i in range(j, count):
        _add_products(dots, rows(v, i, 1), rows(x, i * k, k), pivot, size)
    _reflector(dots, rows(v, j, 1), rows(x, j * k, k), pivot, size)
    for i in range(j + 1, count):
        _subtract_products(dots, rows(v, i, 1), rows(x, i * k, k), pivot, size)


@compiled
def to_triangle(x, count, dots, v, size):
    """Replace the upper triangle of X, (p, k), by R. Scratch: k rows and p rows."""
    _reflect(x, count, dots, v, (), size)
    if len(size) > 1:
        _reflect(x, count, dots, v, (0,), size)
    if len(size) > 2:
        _reflect(x, count, dots, v, (0, 0), size)
    if len(size) > 3:
        _reflect(x, count, dots, v, (0, 0, 0), size)
    if len(size) > 4:
        _reflect(x, count, dots, v, (0, 0, 0, 0), size)
    if len(size) > 5:
        _reflect(x, count, dots, v, (0, 0, 0, 0, 0), size)


@compiled
def volume(triangle, row, size):
    """Set a row to |R_11 ... R_kk|, the product of the singular values: Yoshikawa's measure."""
    k = len(size)
    for lane in range(LANES):
        product = 1.0
        for j in range(k):
            product *= abs(triangle[j * (k + 1) * LANES + lane])
        row[lane] = product
