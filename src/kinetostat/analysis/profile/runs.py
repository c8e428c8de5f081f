"""The tree of runs: joints that follow one another without a branch between them, and which of them carry hands."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from kinetostat.analysis.profile.ends import is_tool, moving_branches
from kinetostat.analysis.profile.grippers import is_jaw
from kinetostat.urdf.description import Joint, JointType, Robot

__all__ = ["Run", "carries_hand", "runs"]

_SHORT = 0.5  # of the arm's length: what is shorter beyond its end is a finger


@dataclass
class Run:
    """Joints that follow one another without a branch between them.

    Attributes:
        base: the link from which it leaves: where the way branches, or the seed.
        seed: the root, or the link that a joint carries which floats: where the way to it begins.
        joints: those that move, followers too, outwards; none where the way branches at the seed.
        branches: the runs at its end.
        beside: what branches off on its way without being a branch.
        count: its independent joints.
        most: the independent joints of the longest way from its first joint to a tip.
        carrying: the length from its first joint to where the furthest of its branches begins, stretched out, m.
        length: the length from its first joint to the furthest tip, stretched out, m.
    """

    base: str
    seed: str
    joints: tuple[Joint, ...] = ()
    branches: list[Run] = field(default_factory=list)
    beside: list[Run] = field(default_factory=list)
    count: int = 0
    most: int = 0
    carrying: float = 0.0
    length: float = 0.0

    @property
    def end(self) -> str:
        """The link at its end."""
        return self.joints[-1].child if self.joints else self.base

    def with_all_below(self) -> list[Run]:
        """Return it and the runs beyond it and beside it, outwards."""
        found = [self]
        for run in found:
            found += [*run.branches, *run.beside]
        return found


@dataclass(frozen=True)
class _Ahead:
    """What is on the ways down from each link: the most independent joints, and whether a frame is called a tool."""

    most: dict[str, int]
    tool: dict[str, bool]

    def joints(self, joint: Joint) -> int:
        """Return the independent joints of the longest way that begins with a joint."""
        return self.most[joint.child] + _independent(joint)


def runs(robot: Robot) -> tuple[Run, ...]:
    """Return the trees of runs of a robot: one from the root, and one from beyond each joint that floats.

    A joint that floats belongs to no run, nor does a planar joint with joints beyond it: it is a base that drives.
    A run goes on beside what is no limb: beside links that only follow, as those of a parallelogram do, and, if it
    leads to a tool, beside single joints, such as that of a camera on the forearm.
    """
    moving, ahead = moving_branches(robot), _ahead(robot)
    trees = [Run(robot.root, robot.root)]
    for tree in trees:
        waiting = [tree]
        while waiting:
            run = waiting.pop()
            joints, beside = list(run.joints), list[Joint]()
            while True:
                following = _following(robot, joints[-1].child if joints else run.base, ahead)
                beside += following.beside
                trees += [Run(joint.child, joint.child) for joint in following.carriers]
                if len(following.on) != 1:
                    break
                joints += following.on
            run.joints = tuple(joints)
            run.beside = [Run(_base(robot, joint, moving), run.seed, (joint,)) for joint in beside]
            run.branches = [Run(_base(robot, joint, moving), run.seed, (joint,)) for joint in following.on]
            waiting += [*run.beside, *run.branches]
        for run in reversed(tree.with_all_below()):
            _measure(robot, run)
    return tuple(trees)


def carries_hand(run: Run) -> bool:
    """Return whether what branches at the end of a run are the fingers of a hand or gripper, not further limbs.

    They have one joint at most, or all are short beside the arm that carries them and have no more joints than it, or
    some are called fingers: the arms of a humanoid are no fingers of its trunk, nor pendulums those of their cart.
    """
    if not run.count or not run.branches:
        return False
    if run.count > 1 and all(branch.most <= 1 for branch in run.branches):
        return True
    short = all(branch.length < _SHORT * run.carrying for branch in run.branches)
    called = any(is_jaw(joint) for branch in run.branches for joint in branch.joints)
    fewer = run.count > 1 and all(branch.most <= run.count for branch in run.branches)
    return short and (called or fewer)


def _ahead(robot: Robot) -> _Ahead:
    order = [robot.root]
    for link in order:
        order += [joint.child for joint in robot.child_joints[link]]
    ahead = _Ahead({}, {})
    for link in reversed(order):
        below = robot.child_joints[link]
        ahead.most[link] = max(map(ahead.joints, below), default=0)
        ahead.tool[link] = is_tool(link) or any(ahead.tool[joint.child] for joint in below)
    return ahead


def _independent(joint: Joint) -> bool:
    return joint.type is not JointType.FIXED and joint.mimic is None


@dataclass(frozen=True)
class _Following:
    """The joints that move next beyond a link: those that a run goes on with, those beside it, and driving bases."""

    on: list[Joint]
    beside: list[Joint]
    carriers: list[Joint]


def _following(robot: Robot, link: str, ahead: _Ahead) -> _Following:
    moving = list(_over_fixed(robot, link))
    carriers = [joint for joint in moving if _carries(joint, ahead)]
    rest = [joint for joint in moving if not _carries(joint, ahead)]
    driven = [joint for joint in rest if ahead.joints(joint)]
    to_tool = [joint for joint in driven if ahead.tool[joint.child]]
    several = [joint for joint in driven if ahead.joints(joint) > 1]
    on = next((ways[0] for ways in (driven, to_tool) if len(ways) == 1), None)
    if on is not None and not is_jaw(on) and (several == [on] or (not several and on in to_tool)):
        return _Following([on], [joint for joint in rest if joint is not on], carriers)
    return _Following(rest, [], carriers)


def _carries(joint: Joint, ahead: _Ahead) -> bool:
    """Return whether a joint is the base that carries a robot: one that floats, or a planar one with joints beyond."""
    planar = joint.type is JointType.PLANAR and ahead.most[joint.child] > 0
    return planar or joint.type is JointType.FLOATING


def _over_fixed(robot: Robot, link: str) -> Iterator[Joint]:
    """Yield the joints that move next below a link, in the order of the tree."""
    waiting = list(reversed(robot.child_joints[link]))
    while waiting:
        joint = waiting.pop()
        if joint.type is JointType.FIXED:
            waiting += reversed(robot.child_joints[joint.child])
        else:
            yield joint


def _base(robot: Robot, joint: Joint, moving: dict[str, int]) -> str:
    """Return the link at which the way to a joint branches off."""
    link = joint.parent
    while moving[link] <= 1 and link in robot.parent_joint:
        link = robot.parent_joint[link].parent
    return link


def _measure(robot: Robot, run: Run) -> None:
    """Count and measure a run whose branches are measured."""
    run.count = sum(_independent(joint) for joint in run.joints)
    run.most = run.count + max((branch.most for branch in run.branches), default=0)
    own = sum(joint.slide for joint in run.joints)
    own += sum(_gap(robot, joint, above.child) for above, joint in zip(run.joints, run.joints[1:], strict=False))
    gaps = [_gap(robot, branch.joints[0], run.end) for branch in run.branches]
    run.carrying = own + max(gaps, default=0.0)
    run.length = own + max((gap + b.length for gap, b in zip(gaps, run.branches, strict=True)), default=0.0)


def _gap(robot: Robot, joint: Joint, above: str) -> float:
    """Return the length of the way from a link to a joint below it, over fixed joints."""
    total, link = joint.origin.length, joint.parent
    while link != above:
        total += robot.parent_joint[link].origin.length
        link = robot.parent_joint[link].parent
    return total
