"""What weight asks of the joints of two robots at worst, and which share of their effort limits that is."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypedDict

import numpy as np

from kinetostat.analysis.configuration import neutral
from kinetostat.analysis.crosscheck import Certificate, combined
from kinetostat.analysis.difference.matching import Matching
from kinetostat.analysis.worst import WorstTorques, worst_torques
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError

__all__ = ["WorstEffort", "worst_efforts"]

_NOISE = 1e-5  # of a torque: what the search for the worst is good for
_NOTHING = 1e-9  # of the largest torque: one below it is none

_CLIMBS = 640_000  # times coordinates of both robots: five seconds on a free core
_MOST, _FEWEST = 32, 8  # starts of the climb for each joint


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

    def differs(self, share: float) -> bool:
        """Return whether the torque or its share of the limit changed by more than a share of itself."""
        shares = self.share_before or 0.0, self.share_after or 0.0
        return _apart(self.before, self.after, share) or _apart(*shares, share)


def worst_efforts(
    a: Model,
    b: Model,
    matching: Matching,
    joints: Sequence[str],
    share: float,
    *,
    samples: int,
    seed: int,
    progress: Callable[[str, float], None] | None = None,
) -> tuple[tuple[WorstEffort, ...], Certificate]:
    """Return the joints whose worst gravity torque, or its share of the effort limit, changed.

    Gravity is 9.81 m/s2 down the root's z; joints with several coordinates are held at zero. Each robot is also tried
    where the other's torque is worst, so that a maximum which the search finds in one alone is no change.

    Args:
        a: one robot.
        b: the other.
        matching: which joint is which.
        joints: the joints that are looked at, by A's names, see `loaded_joints`.
        share: of a torque, below which a change does not count.
        samples: how many random configurations are looked at before the climb.
        seed: the same seed gives the same ones.
        progress: told what is being done, and which share of it is.

    Raises:
        UsageError: too much work: many joints of large robots; none.
        NumberError: a link's mass is negative.
    """
    size = a.robot.nv + b.robot.nv
    starts = min(_MOST, _CLIMBS // (size * max(1, len(joints))))
    if starts < _FEWEST:
        raise UsageError(f"{len(joints)} joints of robots with {a.robot.nv} and {b.robot.nv} coordinates are too many")
    asked: _Asked = {"samples": samples, "seed": seed}
    theirs = [matching.joints[name] for name in joints]
    first = worst_torques(a, neutral(a.robot), joints=joints, starts=starts, progress=progress, **asked)
    there = _carried(first.witnesses, a, b, matching.joints)
    second = worst_torques(b, neutral(b.robot), joints=theirs, starts=starts, also=there, progress=progress, **asked)
    ours, after = _by_joint(first, a), _by_joint(second, b)
    grown = [n for n in joints if _apart(ours[n].torque, after[matching.joints[n]].torque, max(share, _NOISE))]
    proofs = [first.certificate, second.certificate]
    if grown:
        here = _carried(second.witnesses, b, a, matching.joints_back)
        asked["samples"] = 1
        again = worst_torques(a, neutral(a.robot), joints=grown, starts=1, also=here, **asked)
        proofs.append(again.certificate)
        better = _by_joint(again, a)
        ours |= {name: one for name, one in better.items() if one.torque > ours[name].torque}
    least = _NOTHING * max((one.torque for one in (*ours.values(), *after.values())), default=0.0)
    pairs = [(name, ours[name], after[matching.joints[name]]) for name in joints]
    found = [WorstEffort(n, y.unit, x.torque, y.torque, x.share, y.share, y.witness) for n, x, y in pairs]
    told = tuple(one for one in found if max(one.before, one.after) > least and one.differs(max(share, _NOISE)))
    return told, combined(proofs)


class _Asked(TypedDict):
    samples: int
    seed: int


def _carried(witnesses: Array, one: Model, other: Model, names: dict[str, str]) -> Array:
    """Return configurations of one robot as those of the other, inside its limits; what it has alone is at zero."""
    carried = np.tile(neutral(other.robot), (len(witnesses), 1))
    for joint in one.robot.independent:
        theirs = other.robot.joint_by_name.get(names.get(joint.name, ""))
        if joint.type.nq == 1 and theirs is not None and theirs.type is joint.type and theirs.mimic is None:
            lower, upper = theirs.limit.range
            positions = np.clip(witnesses[:, one.robot.position_slices[joint.name]], lower, upper)
            carried[:, other.robot.position_slices[theirs.name]] = positions
    return carried


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


def _apart(a: float, b: float, share: float) -> bool:
    return abs(a - b) > share * max(a, b)
