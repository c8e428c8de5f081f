"""From a robot to a kernel: the chain, the tree of its masses and the limits that batches are computed from."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.loads import Payload, checked_gravity, effort_limits, point_masses
from kinetostat.analysis.statics import refuse_negative_masses
from kinetostat.analysis.task import FULL, Task
from kinetostat.analysis.typical_length import length_factors
from kinetostat.conventions import Array
from kinetostat.engines.screw import ScrewEngine
from kinetostat.screw.kernel import Kernel, named

__all__ = ["chain_kernel"]


def chain_kernel(
    coordinates: Coordinates,
    outputs: Collection[str],
    rest: Array,
    *,
    task: Task = FULL,
    length: float | None = None,
    local: bool = False,
    gravity: Sequence[float] | Array | bool = True,
    payload: Payload | None = None,
    limits: Mapping[str, float | tuple[float, float]] | None = None,
) -> Kernel:
    """Return the kernel of a chain: what `outputs` says, of configurations of its coordinates.

    Args:
        coordinates: the chain; see `analysis.coordinates`.
        outputs: names of `screw.kernel.OUTPUTS`.
        rest: where all other joints are, (nq,).
        task: the rows that count.
        length: the characteristic length in m, see `length_factors`. None mixes m and rad.
        local: rows in the tool's axes.
        gravity: True (9.81 m/s2 down the root's z) or a vector (3,), m/s2.
        payload: a mass that weighs with the links.
        limits: effort limits of joints instead of the file's.

    Raises:
        UnknownNameError: no such frame or joint.
        UsageError: gravity, payload or limits that cannot be.
        NumberError: a link's mass is negative, and weight counts.
    """
    robot, n = coordinates.model.robot, len(coordinates.names)
    wanted, tree = named(tuple(outputs)), None
    efforts: Array = np.full((2, n), np.nan)
    if {"gravity_torque", "effort_use"} & set(wanted):
        refuse_negative_masses(coordinates.model)
        tree = ScrewEngine(robot).tree(coordinates.names, rest, point_masses(robot, payload))
        given, columns = effort_limits(robot, limits), robot.velocity_columns(dict.fromkeys(coordinates.joints))
        efforts = np.stack([given.lower[columns], given.upper[columns]])
    return Kernel(
        coordinates.chain,
        wanted,
        task.rows,
        *length_factors(coordinates, task, length),
        local,
        tree,
        checked_gravity(gravity),
        efforts,
        np.stack(coordinates.stated_limits),
    )
