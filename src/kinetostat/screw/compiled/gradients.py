"""Gradients of the product of the singular values, and of the smallest, along the coordinates, over lanes.

With M = U diag(s) V^T both have the form  d/dq_j = sum_rc N_rc dM_rc/dq_j:

    N = w sum_i u_i v_i^T / s_i     for w = s_1 ... s_k
    N = u_k v_k^T                   for s_k

dM/dq_j needs no tensor. With N_i = (a_i ; b_i) for the column (v_i ; w_i) of screw i, and the rules of
`Chain.derivatives`, motion of screw j changes

    sum_i N_i . d(v_i ; w_i)/dt_j = w_j . sum_{i>j} (v_i x a_i + w_i x b_i) + v_j . sum_{i<=j} a_i x w_i

and in the tool's axes, which turn too, the first sum is minus that over i <= j. So one pass along the chain gives all.
"""

from __future__ import annotations

import numpy as np

from kinetostat.screw.compiled.compiling import LANES, compiled
from kinetostat.screw.compiled.lanes import rows, store

__all__ = ["gradient", "set_minimum_weights", "set_volume_weights"]


@compiled
def set_volume_weights(columns, values, kink, size):
    """Set the last row of each orthogonal column y_i = s_i v_i to the weight of (X y_i) y_i^T in N for w: w / s_i^4.

    NaN at a kink, where the smallest of the singular values (rows of `values`) is zero.
    """
    k = len(size)
    for lane in range(LANES):
        product = 1.0
        for i in range(k):
            product *= values[i * LANES + lane]
        product = product if values[(k - 1) * LANES + lane] > kink * values[lane] else np.nan
        for i in range(k):
            square = values[i * LANES + lane] * values[i * LANES + lane]
            columns[(i * (k + 1) + k) * LANES + lane] = product / (square * square)


@compiled
def set_minimum_weights(columns, values, kink, size):
    """Set the last row of each orthogonal column to its weight in N for s_k: 1 / s_k^3 for the last, else 0."""
    k = len(size)
    for lane in range(LANES):
        for i in range(k - 1):
            columns[(i * (k + 1) + k) * LANES + lane] = 0.0
        smallest = values[(k - 1) * LANES + lane]
        weight = 1.0 / (smallest * smallest * smallest)
        columns[(k * k + k - 1) * LANES + lane] = weight if smallest > kink * values[lane] else np.nan


@compiled
def _add_share(out, x, y, size):
    """Add weight (x . y) y to a row of N, y = s_i v_i one of the orthogonal columns, x a row of X = M^T (or M)."""
    k = len(size)
    for lane in range(LANES):
        product = 0.0
        for c in range(k):
            product += x[c * LANES + lane] * y[c * LANES + lane]
        product *= y[k * LANES + lane]
        for c in range(k):
            out[c * LANES + lane] += product * y[c * LANES + lane]


@compiled
def _set_normals(normals, x, columns, count, size):
    """Set N, in the layout of X: count rows of k entries."""
    k = len(size)
    for lane in range(count * k * LANES):
        normals[lane] = 0.0
    for r in range(count):
        for i in range(k):
            _add_share(rows(normals, r * k, k), rows(x, r * k, k), rows(columns, i * (k + 1), k + 1), size)


@compiled
def _set_moments(moments, column, normal, task, factors, ratio, step):
    """Set v x a + w x b in rows 0 to 2 and a x w in rows 3 to 5, for one screw (v ; w) and its (a ; b)."""
    for lane in range(6 * LANES):
        moments[lane] = 0.0
    for r in range(len(task)):
        row, entry = rows(moments, task[r], 1), rows(normal, r * len(step), 1)
        for lane in range(LANES):
            row[lane] = ratio * factors[r] * entry[lane]
    for lane in range(LANES):
        vx, vy, vz = column[lane], column[LANES + lane], column[2 * LANES + lane]
        wx, wy, wz = column[3 * LANES + lane], column[4 * LANES + lane], column[5 * LANES + lane]
        ax, ay, az = moments[lane], moments[LANES + lane], moments[2 * LANES + lane]
        bx, by, bz = moments[3 * LANES + lane], moments[4 * LANES + lane], moments[5 * LANES + lane]
        moments[lane] = (vy * az - vz * ay) + (wy * bz - wz * by)
        moments[LANES + lane] = (vz * ax - vx * az) + (wz * bx - wx * bz)
        moments[2 * LANES + lane] = (vx * ay - vy * ax) + (wx * by - wy * bx)
        moments[3 * LANES + lane] = ay * wz - az * wy
        moments[4 * LANES + lane] = az * wx - ax * wz
        moments[5 * LANES + lane] = ax * wy - ay * wx


@compiled
def _add_rows(total, part, count):
    for lane in range(count * LANES):
        total[lane] += part[lane]


@compiled
def _along(slope, sums, moments, column):
    """Take a screw out of the sum beyond (rows 0 to 2), into that before (3 to 5); set w . the one + v . the other."""
    for lane in range(LANES):
        total = 0.0
        for axis in range(3):
            beyond = sums[axis * LANES + lane] - moments[axis * LANES + lane]
            before = sums[(axis + 3) * LANES + lane] + moments[(axis + 3) * LANES + lane]
            sums[axis * LANES + lane] = beyond
            sums[(axis + 3) * LANES + lane] = before
            total += column[(axis + 3) * LANES + lane] * beyond + column[axis * LANES + lane] * before
        slope[lane] = total


@compiled
def gradient(out, columns, orthogonal, x, scratch, chain, task, weights, start, count, size, step):
    """Store the gradient of what the weights of the orthogonal columns belong to, (n, m); columns are the screws'.

    Scratch: p k rows, 6 rows a screw, 7 rows, and n rows.
    """
    k, screws, coordinates = len(size), len(chain.drivers), out.shape[0]
    entries = len(task) * coordinates
    normals, moments = rows(scratch, 0, entries), rows(scratch, entries, 6 * screws)
    sums, slope = rows(scratch, entries + 6 * screws, 6), rows(scratch, entries + 6 * screws + 6, 1)
    totals = rows(scratch, entries + 6 * screws + 7, coordinates)
    _set_normals(normals, x, orthogonal, entries // k, size)
    for lane in range(6 * LANES):
        sums[lane] = 0.0
    for i in range(screws):
        c = chain.drivers[i]
        where = c * k if len(step) == 1 else c
        own, column = rows(moments, 6 * i, 6), rows(columns, 6 * i, 6)
        _set_moments(
            own, column, normals[where * LANES :], task, weights.rows, weights.columns[c] * chain.ratios[i], step
        )
        if not weights.local:
            _add_rows(sums, own, 3)
    for lane in range(coordinates * LANES):
        totals[lane] = 0.0
    for i in range(screws):
        _along(slope, sums, rows(moments, 6 * i, 6), rows(columns, 6 * i, 6))
        total, ratio = rows(totals, chain.drivers[i], 1), chain.ratios[i]
        for lane in range(LANES):
            total[lane] += ratio * slope[lane]
    for c in range(coordinates):
        store(out, c, rows(totals, c, 1), start, count)
