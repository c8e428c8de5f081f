"""Torques that hold a tree of masses still: `Tree.holding_torques` over lanes, from joint to joint.

Outward, the frames; inward, the masses beyond: with M their mass, h = sum of m c, s the axis and p a point of it,

    tau = -turn s . ((h - M p) x g) - slide M g . s
"""

from __future__ import annotations

from kinetostat.screw.compiled.compiling import LANES, compiled
from kinetostat.screw.compiled.lanes import copy, rows, store
from kinetostat.screw.compiled.motion import joint_motion, set_identity, to_next_frame

__all__ = ["holding_torques", "store_use"]


@compiled
def _set_moment(moment, frame, own):
    """Set m c of a body in the root's axes: R (m c) + m p."""
    mx, my, mz, mass = own[0], own[1], own[2], own[3]
    for lane in range(LANES):
        for axis in range(3):
            at = 4 * axis * LANES + lane
            turned = mx * frame[at] + my * frame[at + LANES] + mz * frame[at + 2 * LANES]
            moment[axis * LANES + lane] = turned + mass * frame[at + 3 * LANES]


@compiled
def _add_torque(total, moment, frame, mass, gravity, turn, slide, ratio):
    """Add the torque of one screw to that of its coordinate."""
    gx, gy, gz = gravity[0], gravity[1], gravity[2]
    for lane in range(LANES):
        sx, sy, sz = frame[2 * LANES + lane], frame[6 * LANES + lane], frame[10 * LANES + lane]
        x = moment[lane] - mass * frame[3 * LANES + lane]
        y = moment[LANES + lane] - mass * frame[7 * LANES + lane]
        z = moment[2 * LANES + lane] - mass * frame[11 * LANES + lane]
        turning = sx * (y * gz - z * gy) + sy * (z * gx - x * gz) + sz * (x * gy - y * gx)
        sliding = mass * (gx * sx + gy * sy + gz * sz)
        total[lane] -= ratio * (turn * turning + slide * sliding)


@compiled
def _add_moment(total, part):
    for lane in range(3 * LANES):
        total[lane] += part[lane]


@compiled
def holding_torques(torques, frame, frames, moments, q, tree, masses, gravity, start, count):
    """Set `torques` (n rows) to what holds the tree still. Scratch: a frame, 12 rows and 3 rows a screw."""
    screws = len(tree.turns)
    for i in range(screws):
        parent = tree.parents[i]
        if parent < 0:
            set_identity(frame)
        elif parent != i - 1:
            copy(frame, rows(frames, 12 * parent, 12), 12)
        joint_motion(frame, q, tree, i, start, count)
        to_next_frame(frame, tree.steps[i], tree.slides[i])
        copy(rows(frames, 12 * i, 12), frame, 12)
        _set_moment(rows(moments, 3 * i, 3), frame, masses.own[i])
    for lane in range(len(torques)):
        torques[lane] = 0.0
    for i in range(screws - 1, -1, -1):
        moment, parent = rows(moments, 3 * i, 3), tree.parents[i]
        total, placed, mass = rows(torques, tree.drivers[i], 1), rows(frames, 12 * i, 12), masses.beyond[i]
        _add_torque(total, moment, placed, mass, gravity, tree.turns[i], tree.slides[i], tree.ratios[i])
        if parent >= 0:
            _add_moment(rows(moments, 3 * parent, 3), moment)


@compiled
def store_use(out, row, torque, lower, upper, scratch, start, count):
    """Store |torque| over the limit in its direction, NaN where there is none."""
    for lane in range(LANES):
        limit = lower if torque[lane] < 0.0 else upper
        scratch[lane] = torque[lane] / limit
    store(out, row, scratch, start, count)
