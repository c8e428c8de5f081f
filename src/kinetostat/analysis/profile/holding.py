"""Where joints are held that a section of the workspace does not move."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, product

import numpy as np

from kinetostat.analysis.coordinates import Coordinates, coordinates
from kinetostat.analysis.profile.anatomy import Limb
from kinetostat.analysis.profile.result import LimbPose
from kinetostat.analysis.sweeping.sweep import RowBlock, Sweep, sweep
from kinetostat.conventions import Array
from kinetostat.engines.model import Model

__all__ = ["held_pose"]

_BENT = 3  # joints that are bent at most
_MEASURE = "inverse_condition_number"


def held_pose(model: Model, limb: Limb, swept: Sweep, poses: Sequence[LimbPose]) -> tuple[Array, str]:
    """Return a configuration of the robot, (nq,), at which the limb is not nearly singular, and its name.

    With a straight wrist a whole section would be zero. The first named pose inside limits is taken that will do,
    states before mid before zero. Else a few joints are bent from the middle of their limits, by a quarter turn or half
    of the way to a limit: as few as will do, and of those the ones that leave the limb the most dexterous. Where three
    are not enough, it is the best configuration of the sweep.

    Args:
        model: the robot.
        limb: the limb.
        swept: its sweep, which says what is nearly singular.
        poses: its named poses.
    """
    for pose in sorted(poses, key=lambda pose: {"mid": 1, "zero": 2}.get(pose.name, 0)):
        if pose.inside and pose.values[_MEASURE] >= swept.near:
            return pose.at.q, pose.name
    arm = coordinates(model, limb.frame, limb.base)
    for bent in _bent(arm, swept.rest):
        values = _dexterity(model, limb, swept, bent)
        if np.max(values) >= swept.near:
            return bent[int(np.argmax(values))], "mid, bent"
    best = swept.measures["minimum_singular_value"].maximum
    return (swept.rest, "mid") if best is None else (best.configuration, "best of the sweep")


def _bent(arm: Coordinates, middle: Array) -> Iterator[Array]:
    """Yield configurations (k, nq): one coordinate of the arm bent, then two, then three, to either side."""
    lower, upper = arm.limits
    steps = np.minimum((upper - lower) / 4, np.pi / 2)
    for count in range(1, min(_BENT, len(arm.names)) + 1):
        choices = [
            (list(chosen), sides)
            for chosen in combinations(range(len(arm.names)), count)
            for sides in product((1.0, -1.0), repeat=count)
        ]
        q = np.tile(middle[list(arm.indices)], (len(choices), 1))
        for row, (chosen, sides) in zip(q, choices, strict=True):
            row[chosen] += np.array(sides) * steps[chosen]
        yield arm.configuration(q, middle)


def _dexterity(model: Model, limb: Limb, swept: Sweep, q: Array) -> Array:
    """Return the smallest over the largest singular value at configurations (k, nq), as the sweep has it. (k,)."""
    blocks = list[RowBlock]()
    sweep(
        model,
        limb.frame,
        q[0],
        configurations=q,
        measures=_MEASURE,
        relative_to=limb.base,
        length="none" if swept.length is None else swept.length,
        sink=blocks.append,
    )
    values: Array = np.nan_to_num(np.concatenate([block.values for block in blocks])[:, 0])
    return values
