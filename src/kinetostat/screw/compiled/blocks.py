"""A batch, LANES configurations at a time: from positions to the outputs that are asked for."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kinetostat.conventions import Array
from kinetostat.screw.compiled.compiling import LANES, compiled
from kinetostat.screw.compiled.gradients import gradient, set_minimum_weights, set_volume_weights
from kinetostat.screw.compiled.lanes import FRAME, add_to_store, copy, rows, store
from kinetostat.screw.compiled.motion import local_columns, move_along_chain, weighed
from kinetostat.screw.compiled.singular_values import orthogonalise, set_transposed
from kinetostat.screw.compiled.statics import holding_torques, store_use
from kinetostat.screw.compiled.triangle import to_triangle, volume

__all__ = ["Outputs", "Weights", "evaluate_indices", "evaluate_limit_distance", "evaluate_motion", "evaluate_statics"]


class Outputs(NamedTuple):
    """Where outputs go, a row for each number of a configuration, (rows, m); (0, 0) for what is not asked for."""

    placement: Array
    jacobian: Array
    singular_values: Array
    yoshikawa: Array
    yoshikawa_gradient: Array
    minimum_gradient: Array


class Weights(NamedTuple):
    """What makes M of J: factors of the rows that count, factors of the columns, and where a gradient has its kink."""

    rows: Array
    columns: Array
    local: bool
    kink: float


@compiled
def _store_jacobian(out, columns, chain, start, count):
    """Store J row by row, a coordinate of several screws with the sum of their columns."""
    coordinates = out.shape[0] // 6
    for i in range(len(chain.drivers)):
        for row in range(6):
            values, target = rows(columns, 6 * i + row, 1), row * coordinates + chain.drivers[i]
            add_to_store(out, target, chain.ratios[i], values, chain.first[i], start, count)


@compiled
def _store_gradients(out, columns, orthogonal, x, scratch, chain, task, weights, start, count, size, step):
    """Store the gradients that are asked for. Scratch: k rows for the singular values, then that of `gradient`."""
    k = len(size)
    lengths, rest = rows(scratch, 0, k), scratch[k * LANES :]
    for i in range(k):
        copy(rows(lengths, i, 1), rows(orthogonal, i * (k + 1) + k, 1), 1)
    weighed(x, columns, chain, task, weights.rows, weights.columns, size, step)
    if out.yoshikawa_gradient.shape[0]:
        set_volume_weights(orthogonal, lengths, weights.kink, size)
        gradient(out.yoshikawa_gradient, columns, orthogonal, x, rest, chain, task, weights, start, count, size, step)
    if out.minimum_gradient.shape[0]:
        set_minimum_weights(orthogonal, lengths, weights.kink, size)
        gradient(out.minimum_gradient, columns, orthogonal, x, rest, chain, task, weights, start, count, size, step)


@compiled
def _store_motion(placement, jacobian, frame, columns, chain, start, count):
    for row in range(placement.shape[0]):
        store(placement, row, rows(frame, row, 1), start, count)
    if jacobian.shape[0]:
        _store_jacobian(jacobian, columns, chain, start, count)


@compiled
def evaluate_motion(q, chain, local, placement, jacobian):
    """Fill placements (12, m) and Jacobians (6 n, m), or those of both that have rows."""
    frame, columns = np.empty(FRAME), np.empty(6 * len(chain.turns) * LANES)
    for start in range(0, q.shape[1], LANES):
        count = min(LANES, q.shape[1] - start)
        move_along_chain(frame, columns, q, chain, start, count)
        if local:
            local_columns(frame, columns, len(chain.turns))
        _store_motion(placement, jacobian, frame, columns, chain, start, count)


@compiled
def evaluate_indices(q, chain, weights, task, out, size, step):
    """Fill all outputs of a chain that have rows.

    The lengths of the tuples are constants of the compiled code: `task`, the rows that count; `size`, k singular
    values; `step`, 1 where the task has no more rows than there are coordinates, else k.
    """
    k, screws, coordinates = len(size), len(chain.turns), q.shape[0]
    entries = len(task) * coordinates
    frame, columns, x = np.empty(FRAME), np.empty(6 * screws * LANES), np.empty(entries * LANES)
    dots, v, row = np.empty(k * LANES), np.empty(entries // k * LANES), np.empty(LANES)
    turned, status = np.empty(k * (k + 1) * LANES), np.empty(3 * LANES)
    sloping = out.yoshikawa_gradient.shape[0] + out.minimum_gradient.shape[0] > 0
    scratch = np.empty((k + entries + 6 * screws + 7 + coordinates) * LANES if sloping else 0)
    for start in range(0, q.shape[1], LANES):
        count = min(LANES, q.shape[1] - start)
        move_along_chain(frame, columns, q, chain, start, count)
        if weights.local:
            local_columns(frame, columns, screws)
        _store_motion(out.placement, out.jacobian, frame, columns, chain, start, count)
        weighed(x, columns, chain, task, weights.rows, weights.columns, size, step)
        to_triangle(x, entries // k, dots, v, size)
        if out.yoshikawa.shape[0]:
            volume(x, row, size)
            store(out.yoshikawa, 0, row, start, count)
        if out.singular_values.shape[0] or sloping:
            set_transposed(x, turned, size)
            orthogonalise(turned, status, size)
            for i in range(out.singular_values.shape[0]):
                store(out.singular_values, i, rows(turned, i * (k + 1) + k, 1), start, count)
        if sloping:
            _store_gradients(out, columns, turned, x, scratch, chain, task, weights, start, count, size, step)


@compiled
def evaluate_statics(q, tree, masses, gravity, limits, torque, use):
    """Fill torques (n, m) and uses of effort (n, m), or those of both that have rows."""
    screws, coordinates = len(tree.turns), q.shape[0]
    frame, frames = np.empty(FRAME), np.empty(12 * screws * LANES)
    moments, torques, row = np.empty(3 * screws * LANES), np.empty(coordinates * LANES), np.empty(LANES)
    for start in range(0, q.shape[1], LANES):
        count = min(LANES, q.shape[1] - start)
        holding_torques(torques, frame, frames, moments, q, tree, masses, gravity, start, count)
        for c in range(torque.shape[0]):
            store(torque, c, rows(torques, c, 1), start, count)
        for c in range(use.shape[0]):
            store_use(use, c, rows(torques, c, 1), limits[0, c], limits[1, c], row, start, count)


@compiled
def evaluate_limit_distance(q, middle, half, out):
    """Fill the smallest distance from an end of its range, in halves of it: 1 - |q - middle| / half."""
    nearest = np.empty(LANES)
    for start in range(0, q.shape[1], LANES):
        count = min(LANES, q.shape[1] - start)
        for lane in range(LANES):
            nearest[lane] = 1.0
        for c in range(q.shape[0]):
            centre, scale = middle[c], 1.0 / half[c]
            for lane in range(count):
                nearest[lane] = min(nearest[lane], 1.0 - abs(q[c, start + lane] - centre) * scale)
        store(out, 0, nearest, start, count)
