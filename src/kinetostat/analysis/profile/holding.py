"""Where joints are held that a section of the workspace does not move."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain, combinations, product

import numpy as np

from kinetostat.analysis.coordinates import Coordinates, coordinates
from kinetostat.analysis.profile.anatomy import Limb
from kinetostat.analysis.profile.measuring import measured_at
from kinetostat.analysis.profile.result import LimbPose
from kinetostat.analysis.profile.section_views import views_of_limb
from kinetostat.analysis.profile.two_joints import ends_of
from kinetostat.analysis.sweeping.sweep import Sweep
from kinetostat.conventions import Array
from kinetostat.engines.model import Model

__all__ = ["held_pose"]

_BENT = 3  # joints that are bent at most
_TRIED, _ALIKE = 4, 2  # poses that are looked at of those bent alike; digits by which one is better than another
_PARALLEL = 0.9  # cosine of the angle between axes
_MEASURE = "inverse_condition_number"


def held_pose(model: Model, limb: Limb, swept: Sweep, poses: Sequence[LimbPose]) -> tuple[Array, str]:
    """Return a configuration of the robot, (nq,), at which the limb is not nearly singular, and its name.

    With a straight wrist a whole section would be zero. Of poses that will do, the first is taken at which two joints
    show the limb flat from the side, as a shoulder and an elbow do whose axes are parallel; else the first. They are
    the named poses inside limits, states before mid before zero; then those in which up to three joints are
    bent from zero, or from the middle of their limits, by a quarter turn, or half of the way to a limit that is in the
    way. Where three are not enough, it is the best configuration of the sweep.

    Args:
        model: the robot.
        limb: the limb.
        swept: its sweep, which says what is nearly singular.
        poses: its named poses.
    """
    ordered = sorted(poses, key=lambda pose: {"mid": 1, "zero": 2}.get(pose.name, 0))
    named = [(pose.at.q, pose.name) for pose in ordered if pose.inside and pose.values[_MEASURE] >= swept.near]
    arm = coordinates(model, limb.frame, limb.base)
    starts = {"zero, bent": np.clip(0.0, *arm.limits), "mid, bent": swept.rest[list(arm.indices)]}
    bent = (((q, name) for q in _will_do(model, limb, swept, arm, start)) for name, start in starts.items())
    first = None
    for q, name in chain(named, chain.from_iterable(bent)):
        first = first or (q, name)
        if _seen_flat(model, limb, arm, q):
            return q, name
    best = swept.measures["minimum_singular_value"].maximum
    return first or ((swept.rest, "mid") if best is None else (best.configuration, "best of the sweep"))


def _seen_flat(model: Model, limb: Limb, arm: Coordinates, q: Array) -> bool:
    """Return whether two joints show the limb flat from the side, or in its only plane, where all others are held."""
    up = model.engine.placement(q, model.robot.root, limb.base)[:3, 2]
    views = views_of_limb(arm, q, up, ends_of(arm))
    return any(view.flat and (view.view == "side" or len(views) == 1) for view in views)


def _will_do(model: Model, limb: Limb, swept: Sweep, arm: Coordinates, start: Array) -> Iterator[Array]:
    """Yield configurations (nq,) bent from a start (n,) that leave the limb dexterous, those bent the least first.

    Of those bent alike, a few in which axes of joints are parallel and far apart.
    """
    for bent in _bent(arm, start, swept.rest):
        values = _dexterity(model, limb, swept, bent)
        enough = bent[values >= swept.near]
        order = np.lexsort([-np.round(each, _ALIKE) for each in (values[values >= swept.near], _lever(arm, enough))])
        yield from (enough[i] for i in order[:_TRIED])


def _lever(arm: Coordinates, q: Array) -> Array:
    """Return the largest product of the distance of two parallel axes and the tool's from the second, m2. (k,)."""
    columns = arm.chain.jacobian(q[:, list(arm.indices)])
    v, w = np.swapaxes(columns[:, :3], 1, 2), np.swapaxes(columns[:, 3:], 1, 2)
    from_tool = np.cross(w, v)  # to the nearest point of each axis
    parallel = np.abs(w @ np.swapaxes(w, 1, 2)) > _PARALLEL
    apart = np.linalg.norm(from_tool[:, None] - from_tool[:, :, None], axis=-1)
    levers = parallel * apart * np.linalg.norm(from_tool, axis=-1)[:, None]
    longest: Array = np.max(levers * np.triu(np.ones(levers.shape[1:]), 1), axis=(1, 2), initial=0.0)
    return longest


def _bent(arm: Coordinates, start: Array, rest: Array) -> Iterator[Array]:
    """Yield configurations (k, nq): one coordinate bent from a start (n,), then two, then three, to either side."""
    lower, upper = arm.limits
    turned = {side: np.where(arm.turning, start + side * np.pi / 2, side * np.inf) for side in (1.0, -1.0)}
    half = {1.0: (start + upper) / 2, -1.0: (start + lower) / 2}
    bent = {side: np.where((q > lower) & (q < upper), q, half[side]) for side, q in turned.items()}
    for count in range(1, min(_BENT, len(arm.names)) + 1):
        choices = [
            (list(chosen), sides)
            for chosen in combinations(range(len(arm.names)), count)
            for sides in product((1.0, -1.0), repeat=count)
        ]
        q = np.tile(start, (len(choices), 1))
        for row, (chosen, sides) in zip(q, choices, strict=True):
            row[chosen] = [bent[side][index] for index, side in zip(chosen, sides, strict=True)]
        yield arm.configuration(q, rest)


def _dexterity(model: Model, limb: Limb, swept: Sweep, q: Array) -> Array:
    """Return the smallest over the largest singular value at configurations (k, nq), as the sweep has it. (k,)."""
    _, rows = measured_at(model, limb, swept, q, [_MEASURE])
    values: Array = np.nan_to_num(rows[:, 0])
    return values
