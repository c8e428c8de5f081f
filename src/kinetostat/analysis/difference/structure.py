"""What changed in a robot's meaning: its links, joints and named states, each difference with its size and unit."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.difference.change import Change, Tolerance
from kinetostat.analysis.difference.limits import limit_changes
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
from kinetostat.analysis.difference.states import state_changes
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.screw import so3
from kinetostat.urdf.description import Inertial, Joint, JointType, Link, Mimic, Robot

__all__ = ["changes"]


def changes(a: Model, b: Model, matching: Matching, tolerance: Tolerance) -> tuple[Change, ...]:
    """Return what changed from A to B: roots, what was removed, added, renamed, then changed values in A's order."""
    comparison = _Comparison.of(a.robot, b.robot, matching, tolerance)
    return (
        *comparison.root(),
        *comparison.whole(),
        *(change for joint in a.robot.joints for change in comparison.joint(joint)),
        *(change for link in a.robot.links for change in comparison.link(link)),
        *state_changes(a, b, matching, tolerance),
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
            yield from limit_changes(ours, theirs, self.tolerance)
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


def _told(joint: Joint) -> str:
    """Return a joint in words: its type, and the links between which it is."""
    return f"{joint.type.value}, {joint.parent} to {joint.child}"


def _law(law: Mimic | None) -> str | None:
    """Return a follower's law in words."""
    if law is None:
        return None
    return f"{law.multiplier:.12g} x {law.joint}" + (f" {law.offset:+.12g}" if law.offset else "")
