"""How well the tips of two robots move: manipulability at named poses, and the families of singular configurations."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.configuration import configuration
from kinetostat.analysis.crosscheck import Certificate
from kinetostat.analysis.difference.matching import Matching
from kinetostat.analysis.difference.motion import Tip
from kinetostat.analysis.manipulability import manipulability
from kinetostat.analysis.singular.find import Family, SingularFamilies, singular_find
from kinetostat.analysis.singular.mechanism import MODEL, Mechanism
from kinetostat.analysis.singular.search import converge
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError, quote

__all__ = ["FamilyChange", "PoseIndices", "families_of", "family_changes", "indices", "not_an_arm", "poses", "refused"]

_STATES = 8  # named poses of an SRDF that are looked at
_MEMBERS = 16  # configurations that tell whether a condition makes an arm singular
_NEAR = 0.2  # rad, or of the unit of length: how far a condition that is the same family may have moved
_SAME = 1e-6  # rad or m: how far a family's position is known
_MOST = 0.75  # of those configurations: a search may fail by itself
_SEEN = 5  # searches that found a surface, before one that the other robot has not is believed
_STRAYED = 1e-2  # rad: a search that goes farther has left the condition that it started from


@dataclass(frozen=True)
class PoseIndices:
    """Indices of one block of a tip's Jacobian at one pose, before and after.

    Attributes:
        tip: the tip's name in A.
        pose: "zero", "mid" or the name of an SRDF state.
        block: "full" or "translation".
        unit: of the smallest singular value; "mixed" where rows are of m and of rad, as they are.
        smallest: the smallest singular value in A and B.
        yoshikawa: the product of all of them in A and B.
        certificates: what the two engines say of each robot's Jacobian.
    """

    tip: str
    pose: str
    block: str
    unit: str
    smallest: tuple[float, float]
    yoshikawa: tuple[float, float]
    certificates: tuple[Certificate, Certificate]

    def changed(self, share: float) -> bool:
        """Return whether an index changed by more than a share of itself."""
        pairs = self.smallest, self.yoshikawa
        return any(abs(a - b) > share * max(abs(a), abs(b)) + _ZERO for a, b in pairs)


_ZERO = 1e-9  # a singular value below it is zero


def poses(a: Model, b: Model) -> list[str]:
    """Return the poses that both robots know: zero, mid, and the states of both SRDFs, the first eight."""
    states = [name for name in a.semantics.state_names() if name in b.semantics.state_names()]
    return ["zero", "mid", *(name for name in states if name not in ("zero", "mid"))][: 2 + _STATES]


def refused(a: Model, b: Model, named: Sequence[str]) -> dict[str, str]:
    """Return why one of two robots cannot take poses, by pose; those that both can are left out.

    Args:
        a: one robot.
        b: the other.
        named: the poses, see `poses`.
    """
    reasons = dict[str, str]()
    for pose in named:
        lost = [_lost(model, pose) for model in (a, b)]
        if lost[0] != lost[1]:
            name = next(iter(lost[1] or lost[0]))
            reasons[pose] = f"it sets joint {quote(name)}, which one of the two has not"
        for model in (a, b):
            try:
                configuration(model, pose)
            except UsageError as error:
                reasons.setdefault(pose, error.message)
    return reasons


def _lost(model: Model, pose: str) -> list[str]:
    """Return the joints that a state sets and the robot has not."""
    if pose not in model.semantics.state_names():
        return []
    named = {name: None for state in model.semantics.states if state.name == pose for name in state.positions}
    return [name for name in named if name not in model.robot.joint_by_name]


def indices(a: Model, b: Model, tip: Tip, named: Sequence[str]) -> tuple[list[PoseIndices], dict[str, str]]:
    """Return the indices of a tip at named poses, each robot at its own; and why others were not looked at, by pose.

    Args:
        a: one robot.
        b: the other.
        tip: the tip, a link of both.
        named: the poses, see `poses`.

    Raises:
        EngineError: Pinocchio refuses a robot.
    """
    found, failed = list[PoseIndices](), dict[str, str]()
    for pose in named:
        try:
            both = [
                manipulability(model, frame, configuration(model, pose).q, relative_to=ground)
                for model, frame, ground in ((a, tip.name, tip.ground[0]), (b, tip.other, tip.ground[1]))
            ]
        except UsageError as error:  # nothing moves it, a state names a joint that is none, groups disagree on it
            failed[pose] = error.message
            continue
        for block in ("full", "translation"):
            before, after = (result.blocks[block] for result in both)
            found.append(
                PoseIndices(
                    tip.name,
                    pose,
                    block,
                    before.unit if before.unit == after.unit else "mixed",
                    (float(before.minimum_singular_value), float(after.minimum_singular_value)),
                    (float(before.yoshikawa), float(after.yoshikawa)),
                    (both[0].certificate, both[1].certificate),
                )
            )
    return found, failed


# --- singular families -----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class FamilyChange:
    """A family of singular configurations that came, went, or moved.

    Attributes:
        kind: "added", "removed" or "moved".
        tip: the tip's name in A.
        name: shoulder, elbow, wrist, or None.
        support: the joints that its condition is about, by A's names where A has them.
        before: {joint: position} that its configurations have in A; None where it was not.
        after: the same in B.
        sort: of the family: fold, boundary, traversable or tangential.
        inside_limits: whether some of it is inside joint limits.
    """

    kind: str
    tip: str
    name: str | None
    support: tuple[str, ...]
    before: dict[str, float] | None
    after: dict[str, float] | None
    sort: str
    inside_limits: bool


def not_an_arm(model: Model, frame: str, ground: str) -> str | None:
    """Return why a tip is not that of an arm: of six or seven joints with one coordinate each. None if it is."""
    joints = model.robot.movable_path(ground, frame)
    if any(joint.type.nq != 1 for joint in joints):
        return "joints with several coordinates move it"
    if len(joints) in (6, 7):
        return None
    return f"{len(joints)} joint{' moves' if len(joints) == 1 else 's move'} it"


def families_of(
    a: Model, b: Model, tip: Tip, *, starts: int, seed: int, progress: Callable[[str, float], None] | None = None
) -> tuple[SingularFamilies, SingularFamilies]:
    """Return the singular families of a tip in both robots.

    Raises:
        UsageError: no joint ever moves the tip.
    """
    ends = (a, tip.name, tip.ground[0]), (b, tip.other, tip.ground[1])
    found = [
        singular_find(model, frame, relative_to=ground, starts=starts, seed=seed, progress=progress)
        for model, frame, ground in ends
    ]
    return found[0], found[1]


def family_changes(
    before: SingularFamilies, after: SingularFamilies, tip: str, matching: Matching
) -> tuple[FamilyChange, ...]:
    """Return which families came, went and moved.

    Families are the same if they are conditions on the same joints, the nearest positions first. One that the search
    found in one robot alone is tried on the other: where the other is singular under the same condition, it was missed
    there by chance and is no change. Families outside joint limits are left out.
    """
    theirs = list(after.families)
    left, moved = list[Family](), list[FamilyChange]()
    for family in before.families:
        support = {matching.joints.get(name, name) for name in family.support}
        near = [other for other in theirs if set(other.support) == support and other.implicit == family.implicit]
        near = [other for other in near if _apart(family, other, matching, before.mechanism) <= _NEAR]
        if not near:
            left.append(family)
            continue
        other = min(near, key=lambda found: _apart(family, found, matching, before.mechanism))
        theirs = [one for one in theirs if one is not other]
        inside = family.inside_limits or other.inside_limits
        if inside and _apart(family, other, matching, before.mechanism) > _SAME:
            moved.append(_told("moved", tip, family, family.positions, _named(other.positions, matching)))
    gone = [f for f in left if _believed(f) and not _holds(after.mechanism, _positions(f, matching.joints))]
    come = [f for f in theirs if _believed(f) and not _holds(before.mechanism, _positions(f, matching.joints_back))]
    return (
        *(_told("removed", tip, family, family.positions, None) for family in gone),
        *(_told("added", tip, family, None, _named(family.positions, matching), matching) for family in come),
        *moved,
    )


def _believed(family: Family) -> bool:
    return family.inside_limits and (not family.implicit or family.hits >= _SEEN)


def _told(
    kind: str,
    tip: str,
    family: Family,
    before: dict[str, float] | None,
    after: dict[str, float] | None,
    matching: Matching | None = None,
) -> FamilyChange:
    names = {} if matching is None else matching.joints_back
    support = tuple(names.get(name, name) for name in family.support)
    return FamilyChange(kind, tip, family.name, support, before, after, family.kind, family.inside_limits)


def _named(positions: dict[str, float], matching: Matching) -> dict[str, float]:
    """Return positions by A's names of the joints."""
    return {matching.joints_back.get(name, name): value for name, value in positions.items()}


def _apart(family: Family, other: Family, matching: Matching, arm: Mechanism) -> float:
    """Return how far the positions of two families of the same joints are apart, angles by the shorter way."""
    if family.implicit:
        return 0.0
    theirs, gaps = _named(other.positions, matching), [0.0]
    for name, position in family.positions.items():
        gap = abs(theirs[name] - position) if name in theirs else math.inf
        turning = arm.turning[arm.names.index(name)]
        gaps.append(min(gap % (2 * math.pi), -gap % (2 * math.pi)) if turning and math.isfinite(gap) else gap)
    return max(gaps)


def _positions(family: Family, names: dict[str, str]) -> dict[str, float] | None:
    """Return the positions of a family by the other robot's names; None for a surface, which has none to try."""
    if family.implicit:
        return None
    return {names.get(name, name): value for name, value in family.positions.items()}


def _holds(arm: Mechanism, positions: dict[str, float] | None) -> bool:
    """Return whether an arm is singular wherever these joints are at these positions, or within rounding of them."""
    if positions is None or not set(positions) <= set(arm.names):
        return False
    q = arm.draw(np.random.default_rng(0), (_MEMBERS,))
    held = [arm.names.index(name) for name in positions]
    q[:, held] = list(positions.values())
    near, smallest = converge(arm, q)
    strayed: Array = np.max(np.abs(arm.difference(near, q)[:, held]), axis=-1)
    return bool(np.mean((smallest < MODEL) & (strayed < _STRAYED)) >= _MOST)
