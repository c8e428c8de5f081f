"""What weight asks of the joints of two robots at worst, and which share of their effort limits that is."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from kinetostat.analysis.configuration import neutral
from kinetostat.analysis.crosscheck import Certificate, combined
from kinetostat.analysis.difference.matching import Matching
from kinetostat.analysis.difference.structure import Change
from kinetostat.analysis.worst import WorstTorques, worst_torques
from kinetostat.engines.model import Model

__all__ = ["WorstEffort", "bears_on_effort", "worst_efforts"]

_NOISE = 1e-5  # of a torque: what the search for the worst is good for
_NOTHING = 1e-9  # of the largest torque: one below it is none

_BEARING = frozenset(
    {"type", "parent", "child", "position", "orientation", "axis", "pitch", "lower", "upper", "effort"}
    | {"mimic", "mimic multiplier", "mimic offset", "mass", "centre of mass", "root link"}
)


@dataclass(frozen=True)
class WorstEffort:
    """The worst gravity torque of a joint, inside the limits of each robot; lower bounds.

    Attributes:
        joint: the joint's name in A.
        unit: Nm or N.
        before: the worst torque in A, without sign.
        after: in B.
        share_before: of its effort limit in A; None where there is none.
        share_after: in B.
        witness: the configuration of B where it acts, by B's names of coordinates.
    """

    joint: str
    unit: str
    before: float
    after: float
    share_before: float | None
    share_after: float | None
    witness: dict[str, float]

    @property
    def overloaded(self) -> bool:
        """Whether weight alone now takes more than the effort limit, and did not before."""
        return (self.share_after or 0.0) > 1 >= (self.share_before or 0.0)


def bears_on_effort(change: Change) -> bool:
    """Return whether a change may bear on the torques that weight asks, or on what joints may give."""
    return change.element != "state" and (change.kind in ("added", "removed") or change.attribute in _BEARING)


def worst_efforts(
    a: Model,
    b: Model,
    matching: Matching,
    share: float,
    *,
    samples: int,
    seed: int,
    progress: Callable[[str, float], None] | None = None,
) -> tuple[tuple[WorstEffort, ...], Certificate]:
    """Return the joints of both robots whose worst gravity torque, or its share of the effort limit, changed.

    Gravity is 9.81 m/s2 down the root's z; joints with several coordinates are held at zero.

    Args:
        a: one robot.
        b: the other.
        matching: which joint is which.
        share: of a torque, below which a change does not count.
        samples: how many random configurations are looked at before the climb.
        seed: the same seed gives the same ones.
        progress: told what is being done, and which share of it is.

    Raises:
        UsageError: a robot has no joint with one coordinate.
        NumberError: a link's mass is negative.
    """
    found = [
        worst_torques(model, neutral(model.robot), samples=samples, seed=seed, progress=progress) for model in (a, b)
    ]
    ours, theirs = (_by_joint(result, model) for result, model in zip(found, (a, b), strict=True))
    same = matching.joints
    pairs = [(name, one, theirs[same[name]]) for name, one in ours.items() if same.get(name) in theirs]
    least = _NOTHING * max((one.torque for one in (*ours.values(), *theirs.values())), default=0.0)
    told = tuple(
        WorstEffort(name, after.unit, before.torque, after.torque, before.share, after.share, after.witness)
        for name, before, after in pairs
        if _differ(before, after, max(share, _NOISE), least)
    )
    return told, combined([result.certificate for result in found])


@dataclass(frozen=True)
class _Worst:
    torque: float
    share: float | None
    unit: str
    witness: dict[str, float]


def _by_joint(found: WorstTorques, model: Model) -> dict[str, _Worst]:
    """Return what was found by joint, torques without sign: which of two equal ones is found is chance."""
    rows = zip(found.joints, found.torques, found.utilisation, found.units, found.witnesses, strict=True)
    return {
        joint: _Worst(
            abs(float(torque)),
            float(share) if math.isfinite(share) else None,
            unit,
            dict(zip(model.robot.position_names, map(float, q), strict=True)),
        )
        for joint, torque, share, unit, q in rows
    }


def _differ(before: _Worst, after: _Worst, share: float, least: float) -> bool:
    if max(before.torque, after.torque) <= least:
        return False
    return _apart(before.torque, after.torque, share) or _apart(before.share or 0.0, after.share or 0.0, share)


def _apart(a: float, b: float, share: float) -> bool:
    return abs(a - b) > share * max(a, b)
