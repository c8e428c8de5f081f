"""The limbs of a robot: runs of joints that do not branch, and what their structure lets them do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.configuration import neutral, random_configurations
from kinetostat.analysis.profile.grippers import without_gripper
from kinetostat.conventions import Array, Reference
from kinetostat.engines.screw import ScrewEngine
from kinetostat.errors import quote
from kinetostat.lint.subject import Subject, once
from kinetostat.urdf.description import Joint, JointType, Robot

__all__ = ["Limb", "Structure", "chain_text", "rank", "structure"]

DEPENDENT = 1e-5  # of the largest singular value: what files that write 1.5708 leave of a zero
_SAMPLES, _SEED = 8, 0


@dataclass(frozen=True)
class Limb:
    """Joints that follow each other without a branch between them that moves.

    Attributes:
        joints: those that move, followers too, outwards.
        tip: the link furthest out on what the last joint moves: a foot, a flange.
    """

    joints: tuple[Joint, ...]
    tip: str

    @property
    def base(self) -> str:
        """The link that the first joint moves against."""
        return self.joints[0].parent

    @property
    def independent(self) -> tuple[Joint, ...]:
        """The joints that follow no other."""
        return tuple(joint for joint in self.joints if joint.mimic is None)


@dataclass(frozen=True)
class Structure:
    """The limbs of a robot, and the Jacobians of their tips at almost any configuration.

    Attributes:
        robot: the description.
        limbs: outwards.
        before: for each joint that moves, the one before it that does; None at the root.
        zero: where each link is at the zero configuration, (4, 4).
        jacobians: of each limb's tip relative to the root, lengths in units of the reach. (limbs, samples, 6, nv).
    """

    robot: Robot
    limbs: tuple[Limb, ...]
    before: Mapping[str, Joint | None]
    zero: Mapping[str, Array]
    jacobians: Array

    def arm(self, limb: Limb) -> Limb:
        """Return a limb without the gripper at its end."""
        joints = without_gripper(limb.joints)
        if len(joints) == len(limb.joints):
            return limb
        return Limb(joints, _furthest(self.robot, self.zero, joints[-1].child))

    def chain(self, limb: Limb) -> list[Joint]:
        """Return the independent joints between the root and a limb's tip."""
        return self.robot.movable_path(self.robot.root, limb.tip)


@once
def structure(subject: Subject) -> Structure:
    """Return the limbs of a robot; they are found once for each subject."""
    robot = subject.robot
    assert robot is not None
    before, after = _neighbours(robot)
    engine, links, limbs = ScrewEngine(robot), list(robot.link_by_name), list[Limb]()
    zero = dict(zip(links, engine.placements(neutral(robot), links), strict=True))
    for name, joint in ((name, robot.joint_by_name[name]) for name in before):
        above = before[name]
        if above is not None and len(after[above.name]) == 1:
            continue
        run = [joint]
        while len(after[run[-1].name]) == 1:
            run.append(after[run[-1].name][0])
        limbs.append(Limb(tuple(run), _furthest(robot, zero, run[-1].child)))
    matrices = engine.jacobians(_anywhere(robot), [limb.tip for limb in limbs], Reference.WORLD)
    matrices = np.moveaxis(matrices, 1, 0).copy()
    matrices[..., :3, :] /= max(robot.reach, 1e-9)
    return Structure(robot, tuple(limbs), before, zero, matrices)


def _furthest(robot: Robot, zero: Mapping[str, Array], link: str) -> str:
    """Return the link that is furthest from a link's origin among those fixed to it; the link itself without any."""
    furthest, most, stack = link, 1e-9, [link]
    while stack:
        at = stack.pop()
        distance = float(np.linalg.norm(zero[at][:3, 3] - zero[link][:3, 3]))
        if distance > most:
            furthest, most = at, distance
        stack += [joint.child for joint in robot.child_joints[at] if joint.type is JointType.FIXED]
    return furthest


def _neighbours(robot: Robot) -> tuple[dict[str, Joint | None], dict[str, list[Joint]]]:
    """Return for each joint that moves the one before it that does, and those after it; outwards."""
    before, after = dict[str, Joint | None](), dict[str, list[Joint]]()
    stack: list[tuple[str, Joint | None]] = [(robot.root, None)]
    while stack:
        link, last = stack.pop()
        for joint in reversed(robot.child_joints[link]):
            moves = joint.type is not JointType.FIXED
            if moves:
                before[joint.name], after[joint.name] = last, []
                if last is not None:
                    after[last.name].append(joint)
            stack.append((joint.child, joint if moves else last))
    return before, after


def _anywhere(robot: Robot) -> Array:
    """Return configurations that limits do not count at: there are files that lock every joint at zero."""
    samples, generator = random_configurations(robot, _SEED, _SAMPLES), np.random.default_rng(_SEED)
    for joint in robot.independent:
        if joint.type.nq == 1:
            moved = generator.uniform(-np.pi, np.pi, _SAMPLES) if joint.type.is_angle else generator.random(_SAMPLES)
            samples[:, robot.position_slices[joint.name].start] += moved
    return samples


def rank(matrices: Array, columns: Sequence[int]) -> int:
    """Return the largest rank of some columns of Jacobians (n, 6, nv): that at almost every configuration."""
    if not columns:
        return 0
    chosen = matrices[..., list(columns)]
    values = np.linalg.svd(chosen, compute_uv=False)
    largest = float(np.max(values, initial=0.0))
    return int(np.max(np.sum(values > DEPENDENT * largest, -1))) if largest > 0 else 0


def chain_text(base: str, tip: str) -> str:
    """Return how a chain is named in messages."""
    return f"{quote(base, 40)} to {quote(tip, 40)}"
