"""What changed in a robot's meaning: its links, joints and named states, each difference with its size and unit."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.difference.matching import Matching
from kinetostat.analysis.difference.placements import (
    Anchor,
    anchors,
    angle_between,
    distance,
    joint_placements,
    origin_matrix,
    turn,
)
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.screw import so3
from kinetostat.urdf.description import Inertial, Joint, JointType, Link, Mimic, Robot
from kinetostat.urdf.srdf import GroupState

__all__ = ["Change", "Tolerance", "changes"]

Value = str | float | tuple[float, ...] | None


@dataclass(frozen=True)
class Tolerance:
    """What does not count: of lengths in m and angles in rad, and the share of masses, inertias, efforts and speeds."""

    absolute: float
    relative: float

    def apart(self, a: float, b: float) -> bool:
        """Return whether two lengths or angles differ; infinite ones are equal."""
        return a != b and not abs(a - b) <= self.absolute

    def differ(self, a: float, b: float) -> bool:
        """Return whether two masses, or what else has a share, differ."""
        return a != b and not abs(a - b) <= self.relative * max(abs(a), abs(b))


@dataclass(frozen=True)
class Change:
    """One difference.

    Attributes:
        kind: "added", "removed", "renamed" or "changed".
        element: "robot", "link", "joint" or "state".
        name: its name in A; in B, where it was added.
        attribute: what changed: "position", "effort", ...; empty where it is the whole element.
        before: what it was: a number, numbers, words, or None for nothing.
        after: what it is.
        size: how far apart they are, in `unit`; None where that is no number.
        unit: of the numbers and of the size.
    """

    kind: str
    element: str
    name: str
    attribute: str = ""
    before: Value = None
    after: Value = None
    size: float | None = None
    unit: str = ""


def changes(a: Model, b: Model, matching: Matching, tolerance: Tolerance) -> tuple[Change, ...]:
    """Return what changed from A to B: roots, what was removed, added, renamed, then changed values in A's order."""
    comparison = _Comparison.of(a.robot, b.robot, matching, tolerance)
    return (
        *comparison.root(),
        *comparison.whole(),
        *(change for joint in a.robot.joints for change in comparison.joint(joint)),
        *(change for link in a.robot.links for change in comparison.link(link)),
        *_states(a, b, matching, tolerance),
    )


@dataclass(frozen=True)
class _Comparison:
    """Two robots, matched, with the placements of their joints in links that both have."""

    a: Robot
    b: Robot
    matching: Matching
    tolerance: Tolerance
    placed: tuple[dict[str, Array], dict[str, Array]]
    anchored: tuple[dict[str, Anchor], dict[str, Anchor]]

    @classmethod
    def of(cls, a: Robot, b: Robot, matching: Matching, tolerance: Tolerance) -> _Comparison:
        placed = joint_placements(a), joint_placements(b)
        anchored = anchors(a, placed[0], matching.links), anchors(b, placed[1], matching.links_back)
        return cls(a, b, matching, tolerance, placed, anchored)

    def root(self) -> Iterator[Change]:
        """Yield the change of root, if another link is the root now."""
        if self.matching.links.get(self.a.root) != self.b.root:
            yield Change("changed", "robot", self.a.name, "root link", self.a.root, self.b.root)

    def whole(self) -> Iterator[Change]:
        """Yield what was removed, added and renamed."""
        same = self.matching
        yield from (
            Change("removed", "joint", j.name, "", _told(j)) for j in self.a.joints if j.name not in same.joints
        )
        yield from (Change("removed", "link", link.name) for link in self.a.links if link.name not in same.links)
        joints, links = same.joints_back, same.links_back
        yield from (Change("added", "joint", j.name, "", None, _told(j)) for j in self.b.joints if j.name not in joints)
        yield from (Change("added", "link", link.name) for link in self.b.links if link.name not in links)
        for element, named in (("joint", same.joints), ("link", same.links)):
            listed = self.a.joint_by_name if element == "joint" else self.a.link_by_name
            for name in listed:
                if named.get(name, name) != name:
                    yield Change("renamed", element, name, "name", name, named[name])

    # --- joints ------------------------------------------------------------------------------------------------------

    def joint(self, ours: Joint) -> Iterator[Change]:
        """Yield what changed of a joint that both robots have."""
        name = self.matching.joints.get(ours.name)
        if name is None:
            return
        theirs = self.b.joint_by_name[name]
        if ours.type is not theirs.type:
            yield Change("changed", "joint", ours.name, "type", ours.type.value, theirs.type.value)
        yield from self._place(ours, theirs)
        if ours.type.nv and theirs.type.nv:
            yield from self._axis(ours, theirs)
            yield from self._limits(ours, theirs)
            yield from self._law(ours, theirs)

    def _place(self, ours: Joint, theirs: Joint) -> Iterator[Change]:
        above, now = self.anchored[0].get(ours.parent), self.anchored[1].get(theirs.parent)
        if above is None or now is None or self.matching.links[above.link] != now.link:
            yield Change("changed", "joint", ours.name, "parent", ours.parent, theirs.parent)
        else:
            before = above.placement @ self.placed[0][ours.name]
            after = now.placement @ self.placed[1][theirs.name]
            yield from self._moved("joint", ours.name, before, after)
        if self.matching.links.get(ours.child) != theirs.child:
            yield Change("changed", "joint", ours.name, "child", ours.child, theirs.child)

    def _moved(self, element: str, name: str, before: Array, after: Array) -> Iterator[Change]:
        apart, turned = distance(before, after), turn(before, after)
        if apart > self.tolerance.absolute:
            ends = _numbers(before[:3, 3]), _numbers(after[:3, 3])
            yield Change("changed", element, name, "position", *ends, apart, "m")
        if turned > self.tolerance.absolute:
            ends = _numbers(so3.to_rpy(before[:3, :3])), _numbers(so3.to_rpy(after[:3, :3]))
            yield Change("changed", element, name, "orientation", *ends, turned, "rad")

    def _axis(self, ours: Joint, theirs: Joint) -> Iterator[Change]:
        if JointType.FLOATING in (ours.type, theirs.type):
            return
        angle = angle_between(ours.axis, theirs.axis)
        if angle > self.tolerance.absolute:
            yield Change("changed", "joint", ours.name, "axis", ours.axis, theirs.axis, angle, "rad")
        if ours.type is theirs.type and self.tolerance.apart(ours.pitch, theirs.pitch):
            size = abs(ours.pitch - theirs.pitch)
            yield Change("changed", "joint", ours.name, "pitch", ours.pitch, theirs.pitch, size, "m")

    def _limits(self, ours: Joint, theirs: Joint) -> Iterator[Change]:
        if ours.type.nq != theirs.type.nq or ours.type.is_angle != theirs.type.is_angle:
            return  # a new type says it all: the units are others
        unit, effort = ("rad", "Nm") if ours.type.is_angle else ("m", "N")
        if ours.type.nq == 1:
            for end, before, after in zip(("lower", "upper"), ours.limit.range, theirs.limit.range, strict=True):
                if self.tolerance.apart(before, after):
                    ends = _finite(before), _finite(after)
                    yield Change("changed", "joint", ours.name, end, *ends, _size(before, after), unit)
        for what, unit_of, before_, after_ in (
            ("effort", effort, ours.limit.effort, theirs.limit.effort),
            ("velocity", f"{unit}/s", ours.limit.velocity, theirs.limit.velocity),
        ):
            before, after = (math.inf if value is None else value for value in (before_, after_))
            if self.tolerance.differ(before, after):
                ends = _finite(before), _finite(after)
                yield Change("changed", "joint", ours.name, what, *ends, _size(before, after), unit_of)

    def _law(self, ours: Joint, theirs: Joint) -> Iterator[Change]:
        """Yield how the law of a follower changed; laws that come to the same through another leader have not."""
        if self._same_law(ours.mimic, theirs.mimic):
            return
        laws = self.a.followers.get(ours.name), self.b.followers.get(theirs.name)
        if self._same_law(*laws):
            return
        ends = _law(ours.mimic), _law(theirs.mimic)
        if ours.mimic is None or theirs.mimic is None or self._leader(ours.mimic) != theirs.mimic.joint:
            yield Change("changed", "joint", ours.name, "mimic", *ends)
            return
        if self.tolerance.differ(ours.mimic.multiplier, theirs.mimic.multiplier):
            numbers = ours.mimic.multiplier, theirs.mimic.multiplier
            yield Change("changed", "joint", ours.name, "mimic multiplier", *numbers, abs(numbers[0] - numbers[1]))
        if self.tolerance.apart(ours.mimic.offset, theirs.mimic.offset):
            numbers, unit = (ours.mimic.offset, theirs.mimic.offset), "rad" if ours.type.is_angle else "m"
            yield Change("changed", "joint", ours.name, "mimic offset", *numbers, abs(numbers[0] - numbers[1]), unit)

    def _same_law(self, ours: Mimic | None, theirs: Mimic | None) -> bool:
        if ours is None or theirs is None:
            return ours is theirs
        return (
            self._leader(ours) == theirs.joint
            and not self.tolerance.differ(ours.multiplier, theirs.multiplier)
            and not self.tolerance.apart(ours.offset, theirs.offset)
        )

    def _leader(self, law: Mimic) -> str | None:
        return self.matching.joints.get(law.joint)

    # --- links -------------------------------------------------------------------------------------------------------

    def link(self, ours: Link) -> Iterator[Change]:
        """Yield what changed of the mass of a link that both robots have; no inertial is no mass."""
        name = self.matching.links.get(ours.name)
        if name is None:
            return
        before, after = ours.inertial, self.b.link_by_name[name].inertial
        if before is after or before == after:
            return
        masses = (0.0 if before is None else before.mass), (0.0 if after is None else after.mass)
        if self.tolerance.differ(*masses):
            yield Change("changed", "link", ours.name, "mass", *masses, abs(masses[0] - masses[1]), "kg")
        if before is not None and after is not None and all(masses):
            apart = math.dist(before.origin.xyz, after.origin.xyz)
            if apart > self.tolerance.absolute:
                centres = before.origin.xyz, after.origin.xyz
                yield Change("changed", "link", ours.name, "centre of mass", *centres, apart, "m")
        tensors = _tensor(before), _tensor(after)
        size = float(np.linalg.norm(tensors[1] - tensors[0], 2))
        if size > self.tolerance.relative * max(float(np.linalg.norm(tensor, 2)) for tensor in tensors):
            ends = _moments(tensors[0]), _moments(tensors[1])
            yield Change("changed", "link", ours.name, "inertia", *ends, size, "kg m2")


def _tensor(inertial: Inertial | None) -> Array:
    """Return the inertia about the centre of mass in the link's axes, (3, 3), kg m2."""
    if inertial is None:
        return np.zeros((3, 3))
    ixx, ixy, ixz, iyy, iyz, izz = inertial.inertia
    rotation = origin_matrix(inertial.origin)[:3, :3]
    tensor: Array = rotation @ np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]) @ rotation.T
    return tensor


def _moments(tensor: Array) -> tuple[float, ...]:
    return _numbers(tensor[np.triu_indices(3)])


def _numbers(values: Array) -> tuple[float, ...]:
    return tuple(float(value) + 0.0 for value in values)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _size(before: float, after: float) -> float | None:
    return _finite(abs(after - before))


def _told(joint: Joint) -> str:
    """Return a joint in words: its type, and the links between which it is."""
    return f"{joint.type.value}, {joint.parent} to {joint.child}"


def _law(law: Mimic | None) -> str | None:
    """Return a follower's law in words."""
    if law is None:
        return None
    return f"{law.multiplier:.12g} x {law.joint}" + (f" {law.offset:+.12g}" if law.offset else "")


# --- states ----------------------------------------------------------------------------------------------------------


def _states(a: Model, b: Model, matching: Matching, tolerance: Tolerance) -> Iterator[Change]:
    """Yield what changed of the named states; none where a robot came from standard input, which has no SRDF."""
    if any(model.loaded.source.path is None and not model.semantics.file for model in (a, b)):
        return
    before, after = _by_name(a), _by_name(b)
    for kind, here, there in (("removed", before, after), ("added", after, before)):
        for name in here:
            if name not in there:
                yield Change(kind, "state", name)
    for name, state in before.items():
        if name in after:
            yield from _state(name, state, after[name], a.robot, matching, tolerance)


def _by_name(model: Model) -> dict[str, GroupState]:
    return {f"{s.group}/{s.name}" if s.group else s.name: s for s in model.semantics.states}


def _state(
    name: str, before: GroupState, after: GroupState, robot: Robot, matching: Matching, tolerance: Tolerance
) -> Iterator[Change]:
    """Yield the joints of a state that are elsewhere now, those that it names in one robot only among them."""
    ours = {matching.joints.get(joint, joint): (joint, values) for joint, values in before.positions.items()}
    for other in dict.fromkeys((*ours, *after.positions)):
        joint, was = ours.get(other, (matching.joints_back.get(other, other), ()))
        now = after.positions.get(other, ())
        sizes = [abs(x - y) for x, y in zip(was, now, strict=False)]
        if len(was) == len(now) and not any(size > tolerance.absolute for size in sizes):
            continue
        known = robot.joint_by_name.get(joint)
        unit = "" if known is None or known.type.nq != 1 else "rad" if known.type.is_angle else "m"
        size = max(sizes) if len(was) == len(now) else None
        yield Change("changed", "state", name, joint, _values(was), _values(now), size, unit)


def _values(positions: tuple[float, ...]) -> Value:
    return positions[0] if len(positions) == 1 else positions or None
