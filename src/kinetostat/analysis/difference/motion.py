"""Which links move alike in two robots: moved by the same joints, with the same placements between their axes.

Fixed joints are taken together with what they carry, so that a link put in between, or a frame written in two steps,
makes no difference. What hangs on a floating joint is looked at from the link that this joint carries.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field

import numpy as np

from kinetostat.analysis.difference.matching import Matching
from kinetostat.analysis.difference.placements import angle_between, distance, joint_placements, turn
from kinetostat.conventions import Array
from kinetostat.urdf.description import Joint, JointType, Mimic, Robot

__all__ = ["Motions", "Tip", "motions"]

_DECIMALS = 9  # of placements that are sorted by being equal
_ROUNDING = 1e-12  # rad, and of the length: what remains of a placement that is written another way


@dataclass(frozen=True)
class Tip:
    """A link that both robots have, without links beyond it in one of them at least.

    Attributes:
        name: in A.
        other: in B.
        ground: the links of A and B that it is looked at from.
        alike: whether it moves in both in the same way.
        ranges_alike: whether the joints that move it have the same limits.
        shape_alike: whether the axes that move it lie alike among each other, wherever the ground and the tip are.
        group: what it is displaced by, or what limits it: tips with the same have, beyond the last thing that changed,
            the same rigid body or chain in both robots.
        body: the joint next to it in A: tips with the same are on one rigid body.
        depth: how many joints move it in A, followers among them.
    """

    name: str
    other: str
    ground: tuple[str, str]
    alike: bool
    ranges_alike: bool
    shape_alike: bool
    group: tuple[str | float, ...]
    body: str | None
    depth: int


@dataclass(frozen=True)
class Motions:
    """What moves the links of two robots.

    Attributes:
        base: the links of A and B that all are looked at from: the roots, or else the first link that both have.
        tips: the tips in A's order.
    """

    base: tuple[str, str]
    tips: tuple[Tip, ...]


def motions(a: Robot, b: Robot, matching: Matching, frames: Collection[str] | None = None) -> Motions | None:
    """Return what moves the tips of two robots, or these links of A; None where they have no link in common."""
    base = _base(a, b, matching)
    if base is None:
        return None
    bodies = _Bodies.below(a, base[0]), _Bodies.below(b, base[1])
    alike = _Alike(a, b, matching, base, bodies)
    pairs = [(ours, matching.links[ours]) for ours in bodies[0].of if ours in matching.links]
    ends = a.child_joints, b.child_joints
    wanted = [
        (ours, theirs)
        for ours, theirs in pairs
        if theirs in bodies[1].of
        and (ours in frames if frames is not None else not ends[0][ours] or not ends[1][theirs])
    ]
    return Motions(base, tuple(alike.tip(ours, theirs) for ours, theirs in wanted))


def _base(a: Robot, b: Robot, matching: Matching) -> tuple[str, str] | None:
    if matching.links.get(a.root) == b.root:
        return a.root, b.root
    waiting = [a.root]
    for link in waiting:
        if link in matching.links:
            return link, matching.links[link]
        waiting += [joint.child for joint in a.child_joints[link]]
    return None


@dataclass(frozen=True)
class _Bodies:
    """One robot as rigid bodies, each with the joint that carries it: fixed joints are part of a body.

    Attributes:
        of: for each link below the base, the joint that carries its body (None: the base), and the link's placement
            in the frame of that joint's child.
        above: for each moving joint, the joint that carries the body it sits on, and where it sits on it.
        free: for each link below the base, the floating joint next above it; None without one.
    """

    of: dict[str, tuple[str | None, Array]] = field(default_factory=dict)
    above: dict[str, tuple[str | None, Array]] = field(default_factory=dict)
    free: dict[str, Joint | None] = field(default_factory=dict)
    depth: dict[str | None, int] = field(default_factory=dict)  # of a carrier: the joints from the base to it

    @classmethod
    def below(cls, robot: Robot, base: str) -> _Bodies:
        bodies, placed = cls({base: (None, np.eye(4))}, {}, {base: None}, {None: 0}), joint_placements(robot)
        waiting = [base]
        for link in waiting:
            carrier, placement = bodies.of[link]
            for joint in robot.child_joints[link]:
                here = placement @ placed[joint.name]
                waiting.append(joint.child)
                bodies.free[joint.child] = joint if joint.type is JointType.FLOATING else bodies.free[link]
                if joint.type is JointType.FIXED:
                    bodies.of[joint.child] = carrier, here
                else:
                    bodies.of[joint.child] = joint.name, np.eye(4)
                    bodies.above[joint.name] = carrier, here
                    bodies.depth[joint.name] = bodies.depth[carrier] + 1
        return bodies


@dataclass(frozen=True)
class _Verdict:
    """Of a joint that both robots have: whether it moves its body alike as seen from the base, and in shape; ranges.

    `moved` is the last joint on the way to it that moves otherwise, `limited` the last one with other limits.
    """

    alike: bool
    shape: bool
    ranges: bool
    moved: str | None = None
    limited: str | None = None

    @classmethod
    def apart(cls, joint: str) -> _Verdict:
        return cls(False, False, False, joint, joint)


_ALIKE, _APART = _Verdict(True, True, True), _Verdict(False, False, False)


def _same_range(ours: Joint, theirs: Joint) -> bool:
    pairs = zip(ours.limit.range, theirs.limit.range, strict=True)
    return all(a == b or abs(a - b) <= _ROUNDING for a, b in pairs)


@dataclass(frozen=True)
class _Alike:
    """Answers whether bodies of two robots move alike. Joints of A are asked in any order; each is judged once."""

    a: Robot
    b: Robot
    matching: Matching
    base: tuple[str, str]
    bodies: tuple[_Bodies, _Bodies]
    judged: dict[str, _Verdict] = field(default_factory=dict)

    def tip(self, ours: str, theirs: str) -> Tip:
        """Return how a link moves in both."""
        (carrier, here), (other, there) = self.bodies[0].of[ours], self.bodies[1].of[theirs]
        if carrier is None or other is None:
            verdict = _ALIKE if carrier is other else _APART
        else:
            verdict = self._carried(carrier) if self.matching.joints.get(carrier) == other else _APART
        ground, alike = self._ground(ours, theirs), verdict.alike and _equal(here, there)
        group = self._group(verdict, (carrier or "", here), (other or "", there))
        depth = self.bodies[0].depth[carrier]
        return Tip(ours, theirs, ground, alike, verdict.ranges, verdict.shape, (*ground, *group), carrier, depth)

    @staticmethod
    def _group(verdict: _Verdict, ours: tuple[str, Array], theirs: tuple[str, Array]) -> tuple[str | float, ...]:
        """Return what tells the tips apart that different things displace.

        A tip at P_a C in one robot and at P_b G C in the other, C(q) the same in both, turns by the angle of P_b G and
        P_a, whatever C is.
        """
        if _equal(ours[1], theirs[1]) and verdict is not _APART:
            return ("moved", verdict.moved) if verdict.moved else ("limited", verdict.limited or "")
        between = theirs[1] @ np.linalg.inv(ours[1])
        return ("body", ours[0], theirs[0], *(float(value) + 0.0 for value in between[:3].ravel().round(_DECIMALS)))

    def _carried(self, name: str) -> _Verdict:
        """Return whether a joint of A carries its body as its counterpart does."""
        trail = list[str]()
        joint: str | None = name
        while joint is not None and joint not in self.judged:
            trail.append(joint)
            joint = self.bodies[0].above[joint][0]
        for joint in reversed(trail):
            self.judged[joint] = self._judge(joint)
        return self.judged[name]

    def _judge(self, name: str) -> _Verdict:
        """Judge a joint of A, the one that carries its body being judged already."""
        other = self.matching.joints.get(name)
        if other is None or other not in self.bodies[1].above:
            return _Verdict.apart(name)
        ours, theirs = self.a.joint_by_name[name], self.b.joint_by_name[other]
        if ours.type is theirs.type is JointType.FLOATING:
            return _ALIKE
        (carrier, here), (counterpart, there) = self.bodies[0].above[name], self.bodies[1].above[other]
        same, placed, ranges = self._same_motion(ours, theirs), _equal(here, there), _same_range(ours, theirs)
        if carrier is None or counterpart is None:
            same = same and carrier is counterpart
            moved, limited = None if same and placed else name, None if ranges else name
            return _Verdict(same and placed, same, ranges, moved, limited)
        if self.matching.joints.get(carrier) != counterpart:
            return _Verdict.apart(name)
        before = self.judged[carrier]
        same = same and placed
        return _Verdict(
            before.alike and same,
            before.shape and same,
            before.ranges and ranges,
            before.moved if same else name,
            before.limited if ranges else name,
        )

    def _same_motion(self, ours: Joint, theirs: Joint) -> bool:
        """Return whether two joints move alike what they carry: type, axis, pitch, and law if they follow."""
        kinds = [JointType.REVOLUTE if j.type is JointType.CONTINUOUS else j.type for j in (ours, theirs)]
        if kinds[0] is not kinds[1] or abs(ours.pitch - theirs.pitch) > _ROUNDING:
            return False
        if kinds[0] is not JointType.FLOATING and angle_between(ours.axis, theirs.axis) > _ROUNDING:
            return False
        return self._same_law(self.a.followers.get(ours.name), self.b.followers.get(theirs.name))

    def _same_law(self, ours: Mimic | None, theirs: Mimic | None) -> bool:
        if ours is None or theirs is None:
            return ours is theirs
        return (
            self.matching.joints.get(ours.joint) == theirs.joint
            and abs(ours.multiplier - theirs.multiplier) <= _ROUNDING
            and abs(ours.offset - theirs.offset) <= _ROUNDING
        )

    def _ground(self, ours: str, theirs: str) -> tuple[str, str]:
        """Return the links to look from: those that the nearest floating joint carries, if it is the same in both."""
        one, other = self.bodies[0].free[ours], self.bodies[1].free[theirs]
        if one is not None and other is not None and self.matching.joints.get(one.name) == other.name:
            return one.child, other.child
        return self.base


def _equal(a: Array, b: Array) -> bool:
    return distance(a, b) <= _ROUNDING * (1 + float(np.linalg.norm(a[:3, 3]))) and turn(a, b) <= _ROUNDING
