"""Rows of lanes: positions, sines and cosines of LANES configurations at once.

Scratch of the kernels is flat: row r of an array is [r LANES, (r + 1) LANES), a number of each of LANES configurations.
That LANES is a constant, and rows of one array lie at constant distances, is what lets the compiler see that they do
not overlap, and compute 8 lanes by one instruction; a two-dimensional array would hide it.

A moving frame has 15 rows: 0 to 11 its placement row by row, 12 the position of its joint, 13 and 14 sine and cosine.
"""

from __future__ import annotations

import numpy as np

from kinetostat.screw.compiled.compiling import LANES, compiled

__all__ = ["FRAME", "add_to_store", "copy", "load_position", "rows", "sine_and_cosine", "store"]

FRAME = 15 * LANES
# pi/2 in three parts (W. Cody and W. Waite, "Software Manual for the Elementary Functions", 1980): the first has 33
# bits, so that k times it is exact for |k| < 2^20, angles below 1.6e6 rad. The parts are those of fdlibm (Sun, 1993).
_PI_2_HIGH, _PI_2_MIDDLE, _PI_2_LOW = 1.57079632673412561417e00, 6.07710050630396597660e-11, 2.02226624879595063154e-21
_2_PI = 0.6366197723675814
# Minimax polynomials of sine and cosine on [-pi/4, pi/4], those of fdlibm. With the reduction the absolute error of
# both is below 2.3e-16 (a unit in the last place of 1) for angles up to 1e6 rad: a test measures it.
_S1, _S2, _S3 = -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04
_S4, _S5, _S6 = 2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10
_C1, _C2, _C3 = 4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05
_C4, _C5, _C6 = -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11


@compiled
def load_position(frame, q, driver, ratio, offset, start, count):
    """Set row 12 to ratio q + offset. Lanes beyond the last configuration repeat it."""
    if count == LANES:
        for lane in range(LANES):
            frame[12 * LANES + lane] = ratio * q[driver, start + lane] + offset
    else:
        for lane in range(LANES):
            frame[12 * LANES + lane] = ratio * q[driver, start + min(lane, count - 1)] + offset


@compiled
def sine_and_cosine(frame):
    """Set rows 13 and 14 to sine and cosine of row 12."""
    for lane in range(LANES):
        angle = frame[12 * LANES + lane]
        quarter = np.rint(angle * _2_PI)
        r = ((angle - quarter * _PI_2_HIGH) - quarter * _PI_2_MIDDLE) - quarter * _PI_2_LOW
        z = r * r
        sine = r + r * z * (_S1 + z * (_S2 + z * (_S3 + z * (_S4 + z * (_S5 + z * _S6)))))
        tail = z * z * (_C1 + z * (_C2 + z * (_C3 + z * (_C4 + z * (_C5 + z * _C6)))))
        cosine = 1.0 - 0.5 * z + tail
        turns = np.int64(quarter)
        odd = (turns & 1) != 0
        s, c = (cosine, sine) if odd else (sine, cosine)
        frame[13 * LANES + lane] = -s if (turns & 2) != 0 else s
        frame[14 * LANES + lane] = -c if ((turns + 1) & 2) != 0 else c


@compiled
def rows(array, first, count):
    """Return rows of a flat array, as a view."""
    return array[first * LANES : (first + count) * LANES]


@compiled
def copy(out, values, count):
    """Copy rows."""
    for lane in range(count * LANES):
        out[lane] = values[lane]


@compiled
def store(out, row, values, start, count):
    """Copy the first lanes of a row to where a block of configurations is in an output (rows, m)."""
    if count == LANES:
        for lane in range(LANES):
            out[row, start + lane] = values[lane]
    else:
        for lane in range(count):
            out[row, start + lane] = values[lane]


@compiled
def add_to_store(out, row, factor, values, first, start, count):
    """Set (first) or add factor times the first lanes of a row to where a block of configurations is in an output."""
    if first and count == LANES:
        for lane in range(LANES):
            out[row, start + lane] = factor * values[lane]
    elif first:
        for lane in range(count):
            out[row, start + lane] = factor * values[lane]
    else:
        for lane in range(count):
            out[row, start + lane] += factor * values[lane]
