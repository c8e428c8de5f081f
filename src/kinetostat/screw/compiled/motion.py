"""Frames from joint to joint, the tool, and the columns of its Jacobian: `Chain.columns` over lanes.

Columns are flat: six rows of lanes a screw.
"""

from __future__ import annotations

from kinetostat.screw.compiled.compiling import LANES, compiled
from kinetostat.screw.compiled.lanes import load_position, rows, sine_and_cosine

__all__ = ["joint_motion", "local_columns", "move_along_chain", "set_identity", "to_next_frame", "weighed"]


@compiled
def set_identity(frame):
    """Set a frame to the observer's."""
    for row in range(12):
        value = 1.0 if row in (0, 5, 10) else 0.0
        for lane in range(LANES):
            frame[row * LANES + lane] = value


@compiled
def _set_still(frame):
    """Set sine and cosine of a frame's joint to those of no turn."""
    for lane in range(LANES):
        frame[13 * LANES + lane] = 0.0
        frame[14 * LANES + lane] = 1.0


@compiled
def joint_motion(frame, q, screws, i, start, count):
    """Set position, sine and cosine of the joint of screw i; a slide turns by nothing."""
    load_position(frame, q, screws.drivers[i], screws.ratios[i], screws.offsets[i], start, count)
    if screws.turns[i] == 0.0:
        _set_still(frame)
    else:
        sine_and_cosine(frame)


@compiled
def to_next_frame(frame, step, slide):
    """Replace T by T A Rot_z(t) Trans_z(slide t): the placement of the next frame. A is `step`, (12,)."""
    a00, a01, a02, a03 = step[0], step[1], step[2], step[3]
    a10, a11, a12, a13 = step[4], step[5], step[6], step[7]
    a20, a21, a22, a23 = step[8], step[9], step[10], step[11]
    for lane in range(LANES):
        advance, s, c = slide * frame[12 * LANES + lane], frame[13 * LANES + lane], frame[14 * LANES + lane]
        for row in range(0, 12, 4):
            at = row * LANES + lane
            x, y, z, p = frame[at], frame[at + LANES], frame[at + 2 * LANES], frame[at + 3 * LANES]
            u, v, w = x * a00 + y * a10 + z * a20, x * a01 + y * a11 + z * a21, x * a02 + y * a12 + z * a22
            frame[at] = u * c + v * s
            frame[at + LANES] = v * c - u * s
            frame[at + 2 * LANES] = w
            frame[at + 3 * LANES] = p + x * a03 + y * a13 + z * a23 + w * advance


@compiled
def _keep_axis(frame, column):
    """Keep a frame's origin in rows 0 to 2 and its axis in rows 3 to 5 until the tool is known."""
    for lane in range(LANES):
        for row in range(3):
            column[row * LANES + lane] = frame[(4 * row + 3) * LANES + lane]
            column[(row + 3) * LANES + lane] = frame[(4 * row + 2) * LANES + lane]


@compiled
def _column_from_axis(tool, column, turn, slide):
    """Replace origin p and axis s by the velocity (v ; w) of the tool: turn (s x (p_tool - p) ; s) + slide (s ; 0)."""
    for lane in range(LANES):
        x = tool[3 * LANES + lane] - column[lane]
        y = tool[7 * LANES + lane] - column[LANES + lane]
        z = tool[11 * LANES + lane] - column[2 * LANES + lane]
        sx, sy, sz = column[3 * LANES + lane], column[4 * LANES + lane], column[5 * LANES + lane]
        column[lane] = turn * (sy * z - sz * y) + slide * sx
        column[LANES + lane] = turn * (sz * x - sx * z) + slide * sy
        column[2 * LANES + lane] = turn * (sx * y - sy * x) + slide * sz
        column[3 * LANES + lane] = turn * sx
        column[4 * LANES + lane] = turn * sy
        column[5 * LANES + lane] = turn * sz


@compiled
def _local_column(tool, column):
    for lane in range(LANES):
        for half in (0, 3):
            at = half * LANES + lane
            x, y, z = column[at], column[at + LANES], column[at + 2 * LANES]
            for row in range(3):
                a, b, c = tool[row * LANES + lane], tool[(row + 4) * LANES + lane], tool[(row + 8) * LANES + lane]
                column[at + row * LANES] = a * x + b * y + c * z


@compiled
def local_columns(tool, columns, screws):
    """Turn every column to the tool's axes."""
    for i in range(screws):
        _local_column(tool, rows(columns, 6 * i, 6))


@compiled
def move_along_chain(frame, columns, q, chain, start, count):
    """Set `frame` to the tool's placement, and `columns` to the velocity that each screw gives the tool."""
    screws = len(chain.turns)
    set_identity(frame)
    for i in range(screws):
        joint_motion(frame, q, chain, i, start, count)
        to_next_frame(frame, chain.steps[i], chain.slides[i])
        _keep_axis(frame, rows(columns, 6 * i, 6))
    _set_still(frame)
    to_next_frame(frame, chain.steps[screws], 0.0)
    for i in range(screws):
        _column_from_axis(frame, rows(columns, 6 * i, 6), chain.turns[i], chain.slides[i])


@compiled
def _set_entries(out, column, task, factors, ratio, step):
    """Set entries of a matrix, one for each row that counts; they lie len(step) rows apart."""
    for lane in range(LANES):
        for r in range(len(task)):
            out[r * len(step) * LANES + lane] = ratio * factors[r] * column[task[r] * LANES + lane]


@compiled
def _add_entries(out, column, task, factors, ratio, step):
    for lane in range(LANES):
        for r in range(len(task)):
            out[r * len(step) * LANES + lane] += ratio * factors[r] * column[task[r] * LANES + lane]


@compiled
def weighed(matrix, columns, chain, task, row_factors, column_factors, size, step):
    """Set `matrix` to M^T, or to M where M is tall: p rows of k entries, row by row, each entry a row of lanes.

    k, the smaller of the numbers of rows and coordinates, is len(size); len(step) is 1 where M is turned, k where not.
    A coordinate of several screws (a joint with followers) has the sum of theirs.
    """
    for i in range(len(chain.drivers)):
        c = chain.drivers[i]
        where = c * len(size) if len(step) == 1 else c
        out, column = matrix[where * LANES :], rows(columns, 6 * i, 6)
        ratio = column_factors[c] * chain.ratios[i]
        if chain.first[i]:
            _set_entries(out, column, task, row_factors, ratio, step)
        else:
            _add_entries(out, column, task, row_factors, ratio, step)
