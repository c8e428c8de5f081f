"""The difference of two versions of a robot: what changed in meaning, and what follows from it, certified."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from kinetostat.analysis.difference.change import Change, Tolerance
from kinetostat.analysis.difference.consequences import Consequences, Question, consequences
from kinetostat.analysis.difference.limits import swapped_limits
from kinetostat.analysis.difference.matching import Matching, match
from kinetostat.analysis.difference.structure import changes
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError, cut, quote, unknown_name

__all__ = ["Difference", "difference"]

_MOST_SAMPLES = 1_000_000
_SWAPPED = 8  # joints that are named
_NEAREST = 1e-9  # m and rad: placements that are nearer are taken for the same one, whatever the tolerance


@dataclass(frozen=True, repr=False)
class Difference:
    """What changed between two robots.

    Attributes:
        before: the name of A's source.
        after: of B's.
        matching: which link and joint is which.
        tolerance: what does not count.
        changes: what changed beyond it.
        consequences: what follows.
        notes: what is to be said, and does not count: the robot's name, the order in the file.
    """

    before: str
    after: str
    matching: Matching
    tolerance: Tolerance
    changes: tuple[Change, ...]
    consequences: Consequences
    notes: tuple[str, ...] = ()

    @property
    def exceeds(self) -> bool:
        """Whether anything changed beyond the tolerance: the robot itself, or where a tip is."""
        return bool(self.changes or self.consequences.tips)

    def __repr__(self) -> str:
        return f"<Difference {cut(self.before)} -> {cut(self.after)}: {len(self.changes)} changes>"


def difference(
    a: Model,
    b: Model,
    *,
    tolerance: float = 1e-9,
    relative: float = 1e-9,
    frames: Sequence[str] | None = None,
    samples: int = 1000,
    seed: int = 0,
    progress: Callable[[str, float], None] | None = None,
) -> Difference:
    """Return what changed from one version of a robot to another in meaning, and what follows.

    Text makes no difference: order, comments, another spelling of a rotation, the length of an axis, visuals. Links and
    joints are matched by name, then by neighbours and kinematics (see `matching`); a placement is compared in the
    nearest link that both robots have, so that a fixed link put in between moves nothing. Then consequences: how far
    each tip is displaced at equal joint positions, at most (sampled, then climbed to: a lower bound), what it reaches,
    manipulability at zero, mid and SRDF states, families of singular configurations, worst gravity torques.

    Args:
        a: the robot before.
        b: the robot after.
        tolerance: lengths in m and angles in rad that do not count.
        relative: the share of masses, inertias, effort and velocity limits, multipliers and torques that does not.
        frames: the links (of A or of B) whose consequences are asked for; default, all tips.
        samples: random configurations that each search starts with.
        seed: of the random numbers.
        progress: told what is being done, and which share of it is.

    Raises:
        UnknownNameError: neither robot has a frame of that name.
        UsageError: a frame that only one robot has; a tolerance or samples that cannot be.
        EngineError: Pinocchio refuses a robot.
    """
    for name, value in (("tolerance", tolerance), ("relative tolerance", relative)):
        if not 0 <= value < math.inf:
            raise UsageError(f"a {name} is zero or positive, not {value:g}", remedy="for instance 1e-6")
    if not 1 <= samples <= _MOST_SAMPLES:
        raise UsageError(f"between 1 and 1,000,000 samples, not {samples}")
    matching, allowed = match(a.robot, b.robot, max(tolerance, _NEAREST)), Tolerance(tolerance, relative)
    named = None if frames is None else tuple(_in_both(a, b, matching, frame) for frame in frames)
    changed = changes(a, b, matching, allowed)
    question = Question(named, allowed, samples, seed, progress)
    return Difference(
        a.loaded.source.name,
        b.loaded.source.name,
        matching,
        allowed,
        changed,
        consequences(a, b, matching, changed, question),
        _notes(a, b, matching),
    )


def _in_both(a: Model, b: Model, matching: Matching, frame: str) -> str:
    """Return A's name of a frame that is named as in A or as in B."""
    if frame in matching.links:
        return frame
    if frame in matching.links_back:
        return matching.links_back[frame]
    for model, other in ((a, b), (b, a)):
        if frame in model.robot.link_by_name:
            lacking = quote(other.loaded.source.name)
            raise UsageError(f"frame {quote(frame)} has no counterpart in {lacking}", remedy="choose another --frame")
    raise unknown_name("frame", frame, a.robot.link_by_name, listing="'kinetostat frames' lists them")


_NOT_COMPARED = (
    "not compared: visuals, collision geometry and meshes; damping and friction; soft limits and calibration; "
    "transmissions; blocks of extensions (gazebo, ros2_control, ...)"
)


def _notes(a: Model, b: Model, matching: Matching) -> tuple[str, ...]:
    notes = list(_about_limits(a, b, matching))
    if a.robot.name != b.robot.name:
        notes.append(f"the robot was called {quote(a.robot.name)}, it is called {quote(b.robot.name)}")
    before = [matching.joints[joint.name] for joint in a.robot.independent if joint.name in matching.joints]
    common = set(before)
    after = [joint.name for joint in b.robot.independent if joint.name in common]
    if before != after and len(before) == len(after):
        notes.append("the joints are in another order in the file, in which plain lists of positions are read")
    return (*notes, _NOT_COMPARED)


def _about_limits(a: Model, b: Model, matching: Matching) -> list[str]:
    """Return what is to be said of limits that are swapped in one of the two, of the first joints."""
    pairs = ((joint, matching.joints.get(joint.name)) for joint in a.robot.joints)
    said = (swapped_limits(joint, b.robot.joint_by_name[other]) for joint, other in pairs if other is not None)
    told = [line for line in said if line is not None]
    left = len(told) - _SWAPPED
    return told if left <= 0 else [*told[:_SWAPPED], f"and lower and upper of {left} joints more"]
