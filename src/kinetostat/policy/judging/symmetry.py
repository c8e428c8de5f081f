"""Whether two chains are mirror images of each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kinetostat.analysis.configuration import neutral, random_configurations
from kinetostat.analysis.inverse.pose import pose_error
from kinetostat.analysis.jacobian import jacobian
from kinetostat.analysis.kinematics import fk
from kinetostat.conventions import Array, Reference
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError, quote
from kinetostat.policy.judging.found import Found, agreed, quiet, witness
from kinetostat.policy.kinds.poses import Symmetry
from kinetostat.screw import se3
from kinetostat.urdf.description import Joint, JointType, Robot

__all__ = ["Mirrored", "mirrored", "symmetry"]


def symmetry(model: Model, asked: Symmetry, folder: Path) -> Found:  # noqa: ARG001 (all judges alike)
    """Judge whether the right chain does what the left one does in a mirror.

    A mirror M turns a spatial twist (v ; w) into (M v ; -M w). That of a joint at zero is that of its partner, or minus
    that: so the partner has to turn the same way or the other. Placements T become M T M; a constant quarter turn may
    follow, because frames are named as people like.
    """
    robot = model.robot
    found = mirrored(model, asked)
    if isinstance(found, str):
        return Found(False, found)
    faults, at = list[str](), dict[str, float]()
    if max(found.position, found.angle) > asked.tolerance:
        where = " at zero" if found.at_zero else ""
        off = f"{found.position:.4g} m and {found.angle:.4g} rad off the mirror image"
        faults.append(f"{quote(asked.right)} is {off}{where}")
        at = witness(robot, found.q, [joint for pair in found.pairs for joint in pair])
    if asked.masses:
        faults += _masses(robot, asked.relative_to or robot.root, asked.left, asked.right, asked.mass_tolerance)
    if asked.limits:
        faults += _limits(found.pairs, found.signs, asked.tolerance)
    if faults:
        return Found(False, "; ".join(faults[:3]) + (f"; and {len(faults) - 3} more" if len(faults) > 3 else ""), at)
    return Found(True, f"{len(found.pairs)} pairs of joints mirror each other")


def _pairs(robot: Robot, observer: str, left: str, right: str) -> list[tuple[Joint, Joint]] | str:
    """Return the joints of the two chains in pairs, those that both share left out; or why they make none."""
    paths = [robot.moving_joints(observer, tip) for tip in (left, right)]
    shared = {joint.name for joint in paths[0]} & {joint.name for joint in paths[1]}
    ours, theirs = ([joint for joint in path if joint.name not in shared] for path in paths)
    if len(ours) != len(theirs):
        return f"{len(ours)} joints move {quote(left)} alone, {len(theirs)} move {quote(right)}"
    if not ours:
        raise UsageError(f"no joint moves {quote(left)} or {quote(right)} alone")
    for a, b in zip(ours, theirs, strict=True):
        if a.type.nq != 1 or b.type.nq != 1:
            raise UsageError("a joint with several coordinates is on the way")
        if a.type.is_angle != b.type.is_angle:
            return f"joint {quote(a.name)} is {a.type.value}, {quote(b.name)} is {b.type.value}"
    return list(zip(ours, theirs, strict=True))


@dataclass(frozen=True)
class Mirrored:
    """How far a right chain is from the mirror image of a left one.

    Attributes:
        position: the largest distance, m.
        angle: the largest angle, rad.
        q: the configuration (nq,) at which the larger of the two is found.
        at_zero: whether that is zero.
        pairs: the joints, in pairs.
        signs: whether the right one of each has to move as the left one does, 1, or the other way, -1.
    """

    position: float
    angle: float
    q: Array
    at_zero: bool
    pairs: Sequence[tuple[Joint, Joint]]
    signs: Array


def mirrored(model: Model, asked: Symmetry) -> Mirrored | str:
    """Return how far two chains are from mirror images of each other; or why their joints make no pairs.

    Raises:
        UsageError: no such frame, no joint that moves one alone, a joint with several coordinates.
        DisagreementError: the engines disagree.
    """
    robot = model.robot
    left, right = robot.frame(asked.left), robot.frame(asked.right)
    observer = robot.frame(asked.relative_to or robot.root)
    pairs = _pairs(robot, observer, left, right)
    if isinstance(pairs, str):
        return pairs
    mirror = np.array([1.0 if axis in asked.plane else -1.0 for axis in "xyz"])
    chains = _Chains(model, observer, left, right, pairs, mirror)
    return chains.compared(chains.signs(), asked)


@dataclass(frozen=True)
class _Chains:
    """Two chains, and a mirror."""

    model: Model
    observer: str
    left: str
    right: str
    pairs: Sequence[tuple[Joint, Joint]]
    mirror: Array

    def signs(self) -> Array:
        """Return for each pair whether the right joint has to move as the left one does, 1, or the other way, -1."""
        ours, theirs = (self._twists(tip, side) for side, tip in enumerate((self.left, self.right)))
        mirrored = ours * np.concatenate([self.mirror, -self.mirror])[:, None]
        return np.where(np.sum(mirrored * theirs, axis=0) < 0, -1.0, 1.0)

    def _twists(self, tip: str, side: int) -> Array:
        """Return the spatial twists of the joints at zero, (6, n)."""
        zero, joints = neutral(self.model.robot), [pair[side].name for pair in self.pairs]
        found = jacobian(self.model, tip, zero, reference=Reference.WORLD, relative_to=self.observer, joints=joints)
        agreed(found.certificate)
        return found.matrix

    def compared(self, signs: Array, asked: Symmetry) -> Mirrored:
        """Return how far the right frame is from the mirrored left one at most, and where."""
        robot = self.model.robot
        drawn = random_configurations(robot, asked.seed, asked.samples)
        q = np.tile(neutral(robot), (asked.samples + 1, 1))
        for (a, b), sign in zip(self.pairs, signs, strict=True):
            ours, theirs = (robot.position_slices[joint.name].start for joint in (a, b))
            q[1:, ours] = drawn[:, ours]
            q[:, theirs] = sign * q[:, ours]
        error = np.abs(self._errors(q))
        position, angle = (np.linalg.norm(error[:, half], axis=-1) for half in (slice(3), slice(3, 6)))
        worst = int(np.argmax(np.maximum(position, angle)))
        off, turned = (quiet(float(part[worst]), robot) for part in (position, angle))
        return Mirrored(off, turned, q[worst], worst == 0, self.pairs, signs)

    def _errors(self, q: Array) -> Array:
        """Return pose errors (m, 6) between the right frame and the mirrored left one; row 0 is at zero."""
        ours, theirs = (fk(self.model, tip, q, relative_to=self.observer) for tip in (self.left, self.right))
        agreed(ours.certificate)
        agreed(theirs.certificate)
        flip = np.append(self.mirror, 1.0)
        image = ours.matrix * flip[:, None] * flip
        named = _quarter_turns(image[0, :3, :3].T @ theirs.matrix[0, :3, :3])
        return pose_error(theirs.matrix, image @ se3.placement(named, np.zeros(3)))


def _quarter_turns(rotation: Array) -> Array:
    """Return the rotation by quarter turns that a rotation nearly is; the identity if it is none."""
    rounded = np.round(rotation)
    proper = np.array_equal(rounded @ rounded.T, np.eye(3)) and np.linalg.det(rounded) > 0
    return rounded if proper else np.eye(3)


def _masses(robot: Robot, observer: str, left: str, right: str, tolerance: float) -> list[str]:
    """Return where the masses that the chains' joints move differ."""
    borne = _borne(robot)
    paths = [[joint for joint, way in robot.path(observer, tip) if way > 0] for tip in (left, right)]
    shared = {joint.name for joint in paths[0]} & {joint.name for joint in paths[1]}
    moving = [[j for j in path if j.name not in shared and j.type is not JointType.FIXED] for path in paths]
    faults = []
    for a, b in zip(*moving, strict=False):
        ours, theirs = borne[a.child], borne[b.child]
        if abs(ours - theirs) > tolerance * max(abs(ours), abs(theirs)):
            faults.append(f"{quote(a.name)} moves {ours:.6g} kg, {quote(b.name)} {theirs:.6g} kg")
    return faults


def _borne(robot: Robot) -> dict[str, float]:
    """Return the mass of each link with all that hangs on it."""
    order, stack = list[str](), [robot.root]
    while stack:
        link = stack.pop()
        order.append(link)
        stack += [joint.child for joint in robot.child_joints[link]]
    borne = dict[str, float]()
    for link in reversed(order):
        inertial = robot.link_by_name[link].inertial
        own = inertial.mass if inertial else 0.0
        borne[link] = own + sum(borne[joint.child] for joint in robot.child_joints[link])
    return borne


def _limits(pairs: Sequence[tuple[Joint, Joint]], signs: Array, tolerance: float) -> list[str]:
    """Return which limits differ."""
    faults = []
    for (a, b), sign in zip(pairs, signs, strict=True):
        lower, upper = a.limit.range
        wanted = (lower, upper) if sign > 0 else (-upper, -lower)
        compared = (
            ("lower", wanted[0], b.limit.range[0]),
            ("upper", wanted[1], b.limit.range[1]),
            ("effort", a.limit.effort, b.limit.effort),
            ("velocity", a.limit.velocity, b.limit.velocity),
        )
        for what, ours, theirs in compared:
            if not _alike(ours, theirs, tolerance):
                image = f"{quote(a.name)} mirrored {_shown(ours)}"
                faults.append(f"{what} of {quote(b.name)} is {_shown(theirs)}, of {image}")
    return faults


def _alike(a: float | None, b: float | None, tolerance: float) -> bool:
    if a is None or b is None:
        return a is b
    return a == b or abs(a - b) <= tolerance * max(1.0, abs(a), abs(b))


def _shown(value: float | None) -> str:
    return "not stated" if value is None else f"{value:.6g}"
