"""Run a kernel: its outputs laid out, the compiled blocks called."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kinetostat.conventions import Array
from kinetostat.screw.compiled.blocks import (
    Outputs,
    Weights,
    evaluate_indices,
    evaluate_limit_distance,
    evaluate_motion,
    evaluate_statics,
)
from kinetostat.screw.kernel import KINK, middle_and_half

if TYPE_CHECKING:
    from kinetostat.screw.kernel import Kernel

__all__ = ["run"]


def run(kernel: Kernel, q: Array) -> dict[str, Array]:
    """Return what a kernel is asked for; see `Kernel`. (m, n) -> {output: (m, ...)}."""
    lanes = np.ascontiguousarray(np.asarray(q, dtype=np.float64).T)
    wanted, coordinates = kernel.outputs, lanes.shape[0]
    values = min(len(kernel.rows), coordinates)
    partly = kernel.values < values  # some singular values are zero everywhere, and do not count
    out = _laid_out((*wanted, "singular_values") if partly else wanted, coordinates, values, lanes.shape[1])
    _run_chain(kernel, lanes, values, out)
    if kernel.tree is not None and kernel.gravity is not None and {"gravity_torque", "effort_use"} & set(wanted):
        tree, masses = kernel.packed_tree
        limits = np.full((2, coordinates), np.nan) if kernel.effort_limits is None else kernel.effort_limits
        limits = np.where(np.isfinite(limits), limits, np.nan)
        gravity = np.asarray(kernel.gravity, dtype=np.float64)
        evaluate_statics(lanes, tree, masses, gravity, limits, out["gravity_torque"], out["effort_use"])
    if "limit_distance" in wanted and kernel.position_limits is not None:
        evaluate_limit_distance(lanes, *middle_and_half(kernel.position_limits), out["limit_distance"])
    if partly:
        out["singular_values"] = out["singular_values"][: kernel.values]
        out["yoshikawa"] = np.prod(out["singular_values"], axis=0, keepdims=True)
    shapes = {"placement": (3, 4), "jacobian": (6, coordinates), "yoshikawa": (), "limit_distance": ()}
    found = {name: out[name].reshape(*shapes.get(name, out[name].shape[:1]), lanes.shape[1]) for name in wanted}
    return {name: np.moveaxis(rows, -1, 0) for name, rows in found.items()}


def _laid_out(wanted: tuple[str, ...], coordinates: int, values: int, count: int) -> dict[str, Array]:
    """Return arrays for the outputs: a row for each number, a column for each configuration; (0, 0) if not wanted."""
    rows = {
        "placement": 12,
        "jacobian": 6 * coordinates,
        "singular_values": values,
        "yoshikawa": 1,
        "limit_distance": 1,
    }
    names = (*Outputs._fields, "gravity_torque", "effort_use", "limit_distance")
    return {name: np.empty((rows.get(name, coordinates), count) if name in wanted else (0, 0)) for name in names}


def _run_chain(kernel: Kernel, lanes: Array, values: int, out: dict[str, Array]) -> None:
    """Fill the outputs that are of the chain."""
    outputs = Outputs(*(out[name] for name in Outputs._fields))
    if any(array.size for array in outputs[2:]):
        # Turns first: they are the larger rows of most arms, and the largest first converge sooner.
        task = kernel.rows[::-1]
        rows = list(task)
        row_factors = np.ones(6) if kernel.row_factors is None else kernel.row_factors
        column_factors = np.ones(len(lanes)) if kernel.column_factors is None else kernel.column_factors
        weights = Weights(row_factors[rows], np.asarray(column_factors, dtype=np.float64), kernel.local, KINK)
        step = 1 if len(rows) <= len(lanes) else values
        # The lengths of these tuples are constants of the compiled code.
        evaluate_indices(lanes, kernel.packed_chain, weights, task, outputs, (0,) * values, (0,) * step)
    elif outputs.placement.size or outputs.jacobian.size:
        evaluate_motion(lanes, kernel.packed_chain, kernel.local, outputs.placement, outputs.jacobian)
