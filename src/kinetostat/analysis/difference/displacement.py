"""How far a tip of one robot is from that of the other, at most, over the joint range; and how far each reaches.

Both robots are put to the same positions of the joints that they have in common, within the limits of both; joints that
are no common coordinate (new ones, followers that were none) stay at zero. What is found is a lower bound; Pinocchio
and the screw engine certify the placements at the witnesses.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.configuration import neutral, position_range
from kinetostat.analysis.crosscheck import Certificate, combined
from kinetostat.analysis.difference.matching import Matching
from kinetostat.analysis.difference.motion import Tip
from kinetostat.analysis.difference.search import Largest, Objective, largest
from kinetostat.analysis.kinematics import fk
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.engines.screw import ScrewEngine
from kinetostat.screw import se3, so3
from kinetostat.screw.chain import Chain
from kinetostat.urdf.description import Joint, Robot

__all__ = ["Displacement", "Extreme", "Reach", "displacement", "reach"]

_NO_DIRECTION = 1e-300
_NO_TURN = 1e-12  # rad


@dataclass(frozen=True)
class Extreme:
    """A largest value, in m or rad, the positions of the joints where it is, and whether it is so everywhere."""

    value: float
    witness: dict[str, float]
    everywhere: bool = False


@dataclass(frozen=True)
class Displacement:
    """How far a tip of B is from that of A, at most, at equal positions of the joints in common.

    Attributes:
        tip: the tip's name in A.
        other: in B.
        relative_to: the link of A that both are looked at from.
        translation: largest distance between their origins, m.
        rotation: largest angle between their axes, rad.
        certificate: what the two engines say of the placements at the witnesses.
    """

    tip: str
    other: str
    relative_to: str
    translation: Extreme
    rotation: Extreme
    certificate: Certificate


@dataclass(frozen=True)
class Reach:
    """How far a tip gets from the link it is looked at from, at most, inside the limits of each robot, m."""

    tip: str
    relative_to: str
    before: Extreme
    after: Extreme
    certificate: Certificate

    @property
    def change(self) -> float:
        """By how much it grew, m."""
        return self.after.value - self.before.value


@dataclass(frozen=True)
class _Coordinate:
    """A coordinate that both robots have: its names, and the ends between which both may be."""

    ours: str
    theirs: str
    lower: float
    upper: float


def displacement(
    a: Model, b: Model, tip: Tip, matching: Matching, samples: int, seed: int, like: Displacement | None = None
) -> Displacement:
    """Return how far a tip of B is from that of A, at most.

    Tips that the same thing displaces turn alike, and where it does not turn them, they shift alike: what has been
    found of one of them holds for the others, and is certified for each.

    Args:
        a: one robot.
        b: the other.
        tip: the tip, a link of both.
        matching: which joint is which.
        samples: how many random configurations are looked at before the climb.
        seed: the same seed gives the same ones.
        like: the displacement of another tip of its group, see `Tip`; None if it is the first.

    Raises:
        EngineError: Pinocchio refuses a robot.
    """
    pair = _Pair.of(a.robot, b.robot, tip, matching)
    if like is None:
        turned = pair.largest(pair.rotation, samples, seed)
        apart = pair.largest(pair.translation, samples, seed)
    else:
        turned, unturned = pair.placed(like.rotation), like.rotation.value <= _NO_TURN
        apart = pair.placed(like.translation) if unturned else pair.largest(pair.translation, samples, seed)
    witnesses = [pair.configurations(found.at) for found in (apart, turned)]
    proofs, gaps = list[Certificate](), list[Array]()
    for ours, theirs in witnesses:
        before = fk(a, tip.name, ours, relative_to=tip.ground[0])
        after = fk(b, tip.other, theirs, relative_to=tip.ground[1])
        proofs += [before.certificate, after.certificate]
        gaps.append(se3.inverse(before.matrix) @ after.matrix)
    return Displacement(
        tip.name,
        tip.other,
        tip.ground[0],
        pair.extreme(apart, float(np.linalg.norm(gaps[0][:3, 3]))),
        pair.extreme(turned, float(np.linalg.norm(so3.log(gaps[1][:3, :3])))),
        combined(proofs),
    )


@dataclass(frozen=True)
class _Pair:
    """The same tip in two robots, as functions of their common coordinates x, (..., n)."""

    robots: tuple[Robot, Robot]
    chains: tuple[Chain, Chain]
    common: tuple[_Coordinate, ...]
    spread: tuple[Array, Array]  # from x to the coordinates of each chain, (n, k)

    @classmethod
    def of(cls, a: Robot, b: Robot, tip: Tip, matching: Matching) -> _Pair:
        found = _chain(a, tip.name, tip.ground[0]), _chain(b, tip.other, tip.ground[1])
        common = _common(a, b, matching, *(names for _, names in found))
        spread = [np.zeros((len(common), len(names))) for _, names in found]
        for k, (_, names) in enumerate(found):
            places = {name: i for i, name in enumerate(names)}
            for i, coordinate in enumerate(common):
                name = coordinate.theirs if k else coordinate.ours
                if name in places:
                    spread[k][i, places[name]] = 1.0
        return cls((a, b), (found[0][0], found[1][0]), common, (spread[0], spread[1]))

    def largest(self, objective: Objective, samples: int, seed: int) -> Largest:
        """Return the largest value inside the limits of both."""
        lower, upper = (np.array([getattr(c, end) for c in self.common]) for end in ("lower", "upper"))
        return largest(objective, lower, upper, samples, seed)

    def placed(self, extreme: Extreme) -> Largest:
        """Return an extreme of another tip at the coordinates of this one; those that it lacks are as near to zero."""
        at = [extreme.witness.get(c.ours, min(max(0.0, c.lower), c.upper)) for c in self.common]
        return Largest(extreme.value, np.array(at), extreme.everywhere)

    def translation(self, x: Array) -> tuple[Array, Array]:
        """Return the distance of the tips, m, and its gradient."""
        (ours, before), (theirs, after) = self._both(x)
        gap = after[..., :3, 3] - before[..., :3, 3]
        size = np.linalg.norm(gap, axis=-1)
        along = gap / np.maximum(size, _NO_DIRECTION)[..., None]
        return size, (along[..., None, :] @ (theirs - ours)[..., :3, :])[..., 0, :]

    def rotation(self, x: Array) -> tuple[Array, Array]:
        """Return the angle t of exp(n t) = R_b R_a^T, and its gradient n . (w_b - w_a), n being fixed by the turn."""
        (ours, before), (theirs, after) = self._both(x)
        turned = so3.log(after[..., :3, :3] @ np.swapaxes(before[..., :3, :3], -1, -2))
        size = np.linalg.norm(turned, axis=-1)
        along = turned / np.maximum(size, _NO_DIRECTION)[..., None]
        return size, (along[..., None, :] @ (theirs - ours)[..., 3:, :])[..., 0, :]

    def _both(self, x: Array) -> list[tuple[Array, Array]]:
        """Return Jacobian by x and placement of the tip in both."""
        answers = []
        for chain, spread in zip(self.chains, self.spread, strict=True):
            columns, placement = chain.columns(x @ spread)
            answers.append((columns @ (chain.fold @ spread.T), placement))
        return answers

    def configurations(self, x: Array) -> tuple[Array, Array]:
        """Return the configurations of both robots at x; what is not in common is at zero."""
        ours, theirs = (neutral(robot) for robot in self.robots)
        for q, robot, names in (
            (ours, self.robots[0], [c.ours for c in self.common]),
            (theirs, self.robots[1], [c.theirs for c in self.common]),
        ):
            places = {name: i for i, name in enumerate(robot.position_names)}
            q[[places[name] for name in names]] = x
        return ours, theirs

    def extreme(self, found: Largest, value: float) -> Extreme:
        """Return what was found with its certified value."""
        named = zip(self.common, found.at, strict=True)
        return Extreme(value, {c.ours: float(position) for c, position in named}, found.constant)


def _chain(robot: Robot, frame: str, ground: str) -> tuple[Chain, list[str]]:
    """Return the chain to a tip, and the names of its coordinates, those of floating joints left out."""
    engine = ScrewEngine(robot)
    if not robot.movable_path(ground, frame):
        return Chain(
            np.zeros((6, 0)), engine.placement(neutral(robot), frame, ground), np.zeros((0, 0)), np.zeros(0)
        ), []
    chain, names = engine.chain(frame, ground)
    kept = [i for i, name in enumerate(names) if np.any(chain.fold[:, i])]
    return Chain(chain.screws, chain.home, chain.fold[:, kept], chain.offset), [names[i] for i in kept]


def _common(
    a: Robot, b: Robot, matching: Matching, ours: Sequence[str], theirs: Sequence[str]
) -> tuple[_Coordinate, ...]:
    """Return the coordinates of two chains that both robots have, in A's order, then B's."""
    found = dict[str, _Coordinate]()
    wanted = set(ours), set(theirs)
    for name, other in _paired(a, b, matching):
        if name in wanted[0] or other in wanted[1]:
            found[name] = _Coordinate(name, other, *_range(a, b, name, other))
    order = [name for name in ours if name in found]
    order += [name for name in found if name not in wanted[0]]
    return tuple(found[name] for name in order)


def _paired(a: Robot, b: Robot, matching: Matching) -> list[tuple[str, str]]:
    """Return the names of the coordinates that both robots have: of joints independent in both, of one sort."""
    free = {joint.name: joint for joint in b.independent}
    pairs = []
    for joint in a.independent:
        other = free.get(matching.joints.get(joint.name, ""))
        if other is not None and joint.type.nq == other.type.nq and joint.type.is_angle == other.type.is_angle:
            pairs += list(zip(joint.position_names, other.position_names, strict=True))
    return pairs


def _range(a: Robot, b: Robot, name: str, other: str) -> tuple[float, float]:
    """Return the ends between which both may be; all that one of them may, where that is nothing."""
    ends = [ends_of(robot, coordinate) for robot, coordinate in ((a, name), (b, other))]
    lower, upper = max(end[0] for end in ends), min(end[1] for end in ends)
    return (lower, upper) if lower <= upper else (min(end[0] for end in ends), max(end[1] for end in ends))


def ends_of(robot: Robot, coordinate: str) -> tuple[float, float]:
    """Return the ends between which a coordinate is drawn: its limits, or what stands for a missing one."""
    joint: Joint | None = robot.joint_by_name.get(coordinate)
    if joint is not None and joint.type.nq == 1:
        return position_range(robot, joint)
    return (-math.pi, math.pi) if coordinate.endswith(".theta") else (-1.0, 1.0)


# --- reach -----------------------------------------------------------------------------------------------------------


def reach(a: Model, b: Model, tip: Tip, samples: int, seed: int) -> Reach:
    """Return how far a tip gets in each robot, inside its own limits.

    Args:
        a: one robot.
        b: the other.
        tip: the tip, a link of both.
        samples: how many random configurations are looked at before the climb.
        seed: the same seed gives the same ones.

    Raises:
        EngineError: Pinocchio refuses a robot.
    """
    ends, proofs = list[Extreme](), list[Certificate]()
    for model, frame, ground in ((a, tip.name, tip.ground[0]), (b, tip.other, tip.ground[1])):
        robot = model.robot
        chain, names = _chain(robot, frame, ground)
        lower, upper = (np.array([ends_of(robot, name)[k] for name in names]) for k in (0, 1))
        found = largest(_far(chain), lower, upper, samples, seed)
        q, places = neutral(robot), {name: i for i, name in enumerate(robot.position_names)}
        q[[places[name] for name in names]] = found.at
        proof = fk(model, frame, q, relative_to=ground)
        witness = {name: float(position) for name, position in zip(names, found.at, strict=True)}
        ends.append(Extreme(float(np.linalg.norm(proof.position)), witness, found.constant))
        proofs.append(proof.certificate)
    return Reach(tip.name, tip.ground[0], ends[0], ends[1], combined(proofs))


def _far(chain: Chain) -> Objective:
    def distance(x: Array) -> tuple[Array, Array]:
        columns, placement = chain.columns(x)
        point = placement[..., :3, 3]
        size = np.linalg.norm(point, axis=-1)
        along = point / np.maximum(size, _NO_DIRECTION)[..., None]
        return size, (along[..., None, :] @ (columns @ chain.fold)[..., :3, :])[..., 0, :]

    return distance
