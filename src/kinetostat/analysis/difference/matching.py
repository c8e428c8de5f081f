"""Which link and joint of one robot is which of the other: by name, else by neighbours, else by kinematics.

What keeps its name is the same. What has lost it is looked for where it was: a joint keeps its child link, a link its
parent joint; else, under the same parent, a joint of the same type at the same placement with the same axis, directly
or with fixed links put in between. Last, what has been renamed *and* moved: by the rule that other names have changed
by (another prefix), or by a subtree with joints of the same types. The rest was added or removed.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from kinetostat.analysis.difference.placements import angle_between, distance, joint_placements, outward, turn
from kinetostat.conventions import Array
from kinetostat.urdf.description import Joint, JointType, Robot

__all__ = ["Matching", "match"]

_LOOKED_AT = 8  # of the joints at one placement: hundreds of equal ones are told apart by their order
_NAME = 200  # characters of a name that are compared
_RULES = 3  # ways of renaming that are tried
_ROUNDING = 1e-12


@dataclass(frozen=True, repr=False)
class Matching:
    """What is the same in two robots, from names in A to names in B."""

    links: dict[str, str]
    joints: dict[str, str]

    @cached_property
    def links_back(self) -> dict[str, str]:
        """From names of links in B to those in A."""
        return {theirs: ours for ours, theirs in self.links.items()}

    @cached_property
    def joints_back(self) -> dict[str, str]:
        """From names of joints in B to those in A."""
        return {theirs: ours for ours, theirs in self.joints.items()}

    def __repr__(self) -> str:
        return f"<Matching of {len(self.links)} links, {len(self.joints)} joints>"


def match(a: Robot, b: Robot, tolerance: float) -> Matching:
    """Return which link and joint of `a` is which of `b`.

    Args:
        a: one robot.
        b: the other.
        tolerance: m and rad within which two placements, and two axes, are the same.
    """
    return _Matcher(_Side.of(a), _Side.of(b), tolerance).matching()


@dataclass(frozen=True)
class _Side:
    """One robot, and what is asked of it often."""

    robot: Robot
    placements: dict[str, Array]
    shapes: dict[str, int]

    @classmethod
    def of(cls, robot: Robot) -> _Side:
        return cls(robot, joint_placements(robot), _shapes(robot))


@dataclass(frozen=True)
class _Candidate:
    """A joint that has no counterpart yet, and where it sits in a link that has one."""

    joint: Joint
    placement: Array


@dataclass
class _Matcher:
    """The matching as it grows."""

    a: _Side
    b: _Side
    tolerance: float
    links: dict[str, str] = field(default_factory=dict)
    joints: dict[str, str] = field(default_factory=dict)
    taken_links: set[str] = field(default_factory=set)
    taken_joints: set[str] = field(default_factory=set)
    rules: Counter[tuple[str, str]] = field(default_factory=Counter)

    def matching(self) -> Matching:
        """Return what is the same."""
        self._by_name()
        self._by_neighbour()
        self._by_kinematics()
        return Matching(self.links, self.joints)

    def _join_links(self, ours: str, theirs: str) -> None:
        self.links[ours] = theirs
        self.taken_links.add(theirs)
        self._learn(ours, theirs)

    def _join_joints(self, ours: str, theirs: str) -> None:
        self.joints[ours] = theirs
        self.taken_joints.add(theirs)
        self._learn(ours, theirs)

    def _learn(self, ours: str, theirs: str) -> None:
        """Remember by which change of prefix a name has become another."""
        if ours != theirs:
            same = _begun_alike(ours[::-1], theirs[::-1])
            if same:
                self.rules[ours[: len(ours) - same], theirs[: len(theirs) - same]] += 1

    def _by_name(self) -> None:
        a, b = self.a.robot, self.b.robot
        for link in a.links:
            if link.name in b.link_by_name:
                self._join_links(link.name, link.name)
        for joint in a.joints:
            if joint.name in b.joint_by_name:
                self._join_joints(joint.name, joint.name)

    def _by_neighbour(self) -> None:
        """Join the roots, the children of joints that are joined, and the joints above links that are joined."""
        a, b = self.a.robot, self.b.robot
        if a.root not in self.links and b.root not in self.taken_links:
            self._join_links(a.root, b.root)
        for joint in a.joints:
            theirs = self.joints.get(joint.name)
            if theirs is not None:
                child = b.joint_by_name[theirs].child
                if joint.child not in self.links and child not in self.taken_links:
                    self._join_links(joint.child, child)
            elif joint.child in self.links:
                above = b.parent_joint.get(self.links[joint.child])
                if above is not None and above.name not in self.taken_joints:
                    self._join_joints(joint.name, above.name)

    # --- by kinematics -----------------------------------------------------------------------------------------------

    def _by_kinematics(self) -> None:
        """Join what hangs on links that are joined, from the roots outward."""
        waiting = [self.a.robot.root, *(joint.child for joint in outward(self.a.robot))]
        waiting = [link for link in waiting if link in self.links]
        for link in waiting:
            found = self._below(link)
            waiting += found

    def _below(self, link: str) -> list[str]:
        """Join what hangs on a link; return the links of A that it was found of."""
        theirs = self.links[link]
        found: list[str] = []
        for through in (False, True):
            ours_left = list(self._free(self.a, link, self.joints, self.links, through))
            theirs_left = list(self._free(self.b, theirs, self.taken_joints, self.taken_links, through))
            if not ours_left or not theirs_left:
                continue
            pairs = self._same_place(ours_left, theirs_left)
            pairs += self._same_rule(ours_left, theirs_left)
            if through:
                pairs += self._same_shape(ours_left, theirs_left)
            for one, other in pairs:
                self._join_joints(one.joint.name, other.joint.name)
                self._join_links(one.joint.child, other.joint.child)
                found.append(one.joint.child)
        return found

    @staticmethod
    def _free(
        side: _Side, link: str, joints: dict[str, str] | set[str], links: dict[str, str] | set[str], through: bool
    ) -> Iterator[_Candidate]:
        """Yield the joints below a link that have no counterpart, nor has their child; beyond fixed such ones too."""
        waiting = [(link, np.eye(4))]
        for above, placement in waiting:
            for joint in side.robot.child_joints[above]:
                if joint.name not in joints and joint.child not in links:
                    here = placement @ side.placements[joint.name]
                    yield _Candidate(joint, here)
                    if through and joint.type is JointType.FIXED:
                        waiting.append((joint.child, here))

    def _same_place(self, ours: list[_Candidate], theirs: list[_Candidate]) -> list[tuple[_Candidate, _Candidate]]:
        """Take pairs of the same type, placement and axis out of both lists, and return them.

        Both are sorted along a line through the space of placements, so that only neighbours on it are compared.
        """
        pairs, left = list[tuple[_Candidate, _Candidate]](), list[_Candidate]()
        keyed = sorted(((_key(one), i) for i, one in enumerate(theirs)), key=lambda entry: entry)
        slack = 3 * self.tolerance + _ROUNDING * max((abs(key) for key, _ in keyed), default=1.0)
        for one in ours:
            key = _key(one)
            first = bisect_left(keyed, (key - slack, -1))
            near = [entry for entry in keyed[first : first + _LOOKED_AT] if entry[0] <= key + slack]
            same = [entry for entry in near if self._same(one, theirs[entry[1]])]
            if not same:
                left.append(one)
                continue
            best = max(same, key=lambda entry: (self._likeness(one, theirs[entry[1]]), -entry[1]))
            pairs.append((one, theirs[best[1]]))
            del keyed[bisect_left(keyed, best)]
        ours[:], theirs[:] = left, [theirs[i] for _, i in sorted(keyed, key=lambda entry: entry[1])]
        return pairs

    def _same(self, one: _Candidate, other: _Candidate) -> bool:
        if _kind(one.joint) is not _kind(other.joint):
            return False
        slack = max(self.tolerance, _ROUNDING * (1 + abs(one.joint.origin.length)))
        moving = one.joint.type not in (JointType.FIXED, JointType.FLOATING)
        return (
            distance(one.placement, other.placement) <= slack
            and turn(one.placement, other.placement) <= slack
            and not (moving and angle_between(one.joint.axis, other.joint.axis) > slack)
        )

    def _likeness(self, one: _Candidate, other: _Candidate) -> tuple[bool, int]:
        """Return by what equal candidates are told apart: what hangs on them, and how much of their names is equal."""
        a, b = one.joint, other.joint
        return self.a.shapes[a.child] == self.b.shapes[b.child], _alike(a.name, b.name) + _alike(a.child, b.child)

    def _same_rule(self, ours: list[_Candidate], theirs: list[_Candidate]) -> list[tuple[_Candidate, _Candidate]]:
        """Take pairs of one type out of both lists whose names have changed as others did, and return them."""
        pairs, left = list[tuple[_Candidate, _Candidate]](), list[_Candidate]()
        named = {name: other for other in theirs for name in (other.joint.name, other.joint.child)}
        used = set[int]()
        rules = [rule for rule, _ in self.rules.most_common(_RULES)]
        for one in ours:
            turned = (
                after + name.removeprefix(before)
                for before, after in rules
                for name in (one.joint.name, one.joint.child)
                if name.startswith(before)
            )
            other = next((named[name] for name in turned if name in named), None)
            if other is None or id(other) in used or _kind(other.joint) is not _kind(one.joint):
                left.append(one)
                continue
            pairs.append((one, other))
            used.add(id(other))
        ours[:], theirs[:] = left, [other for other in theirs if id(other) not in used]
        return pairs

    def _same_shape(self, ours: list[_Candidate], theirs: list[_Candidate]) -> list[tuple[_Candidate, _Candidate]]:
        """Return pairs, each the only two below the link that move, and carry, joints of the same types."""
        pairs = []
        singles = [_singles(self.a, ours), _singles(self.b, theirs)]
        for shape, one in singles[0].items():
            other = singles[1].get(shape)
            if other is not None:
                pairs.append((one, other))
        return pairs


def _singles(side: _Side, candidates: list[_Candidate]) -> dict[int, _Candidate]:
    """Return the joints that move something by the shape of what they move, those that share it left out."""
    found: dict[int, list[_Candidate]] = {}
    for candidate in candidates:
        joint = candidate.joint
        if joint.type is not JointType.FIXED:
            shape = hash((_kind(joint), side.shapes[joint.child]))
            found.setdefault(shape, []).append(candidate)
    return {shape: those[0] for shape, those in found.items() if len(those) == 1}


def _key(candidate: _Candidate) -> float:
    """Return where a placement lies along a line: equal placements lie at the same point."""
    joint = candidate.joint
    axis = (0.0, 0.0, 0.0) if joint.type in (JointType.FIXED, JointType.FLOATING) else joint.axis
    return float(_LINE @ np.concatenate([candidate.placement[:3].ravel(), axis]))


_LINE = np.sqrt(np.array([2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47])) % 1  # no direction of any file
_LINE /= np.linalg.norm(_LINE)


def _kind(joint: Joint) -> JointType:
    """Return the type of a joint but for its limits."""
    return JointType.REVOLUTE if joint.type is JointType.CONTINUOUS else joint.type


def _alike(a: str, b: str) -> int:
    """Return how many characters two names begin and end with together."""
    return _begun_alike(a, b) + _begun_alike(a[::-1], b[::-1])


def _begun_alike(a: str, b: str) -> int:
    """Return how many characters two names begin with together, of the first 200."""
    a, b = a[:_NAME], b[:_NAME]
    return next((i for i, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b)))


def _shapes(robot: Robot) -> dict[str, int]:
    """Return a number for what hangs on each link: equal for the same tree of moving joints, fixed ones left out."""
    below: dict[str, list[int]] = {link.name: [] for link in robot.links}
    shapes: dict[str, int] = {}
    order = [robot.root, *(joint.child for joint in outward(robot))]
    for link in reversed(order):
        shapes[link] = hash(tuple(sorted(below[link])))
        joint = robot.parent_joint.get(link)
        if joint is not None and joint.type is not JointType.FIXED:
            below[joint.parent].append(hash((_kind(joint).value, shapes[link])))
        elif joint is not None:
            below[joint.parent] += below[link]
    return shapes
