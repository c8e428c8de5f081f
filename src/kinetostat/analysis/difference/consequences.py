"""What follows from changes of a robot: where its tips are, how far they reach, how well they move, what they bear."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from kinetostat.analysis.crosscheck import Certificate, combined
from kinetostat.analysis.difference.change import Change, Tolerance
from kinetostat.analysis.difference.dexterity import (
    FamilyChange,
    PoseIndices,
    families_of,
    family_changes,
    indices,
    not_an_arm,
    poses,
    refused,
)
from kinetostat.analysis.difference.displacement import Displacement, Reach, displacement, reach
from kinetostat.analysis.difference.effort import WorstEffort, worst_efforts
from kinetostat.analysis.difference.loaded import loaded_joints
from kinetostat.analysis.difference.matching import Matching
from kinetostat.analysis.difference.motion import Tip, motions
from kinetostat.engines.model import Model
from kinetostat.errors import NumberError, UsageError, quote

__all__ = ["Consequences", "Question", "consequences"]

_TIPS = 32  # whose displacement is looked for, unless they are named
_EACH = 3  # of the tips that one thing displaces, whose reach is looked at
_MAIN = 4  # whose manipulability and singular families are looked at
_STARTS = 400  # searches for singular families; one that is missed is tried all the same
_NOISE = 1e-6  # of a reach or an index: what the search for it is good for
_SLIGHT = 1e-4  # of an index or a torque: what nobody acts upon


@dataclass(frozen=True)
class Consequences:
    """What follows.

    Attributes:
        tips: the tips that are elsewhere, the farthest first.
        reach: the tips that reach farther or less far.
        manipulability: the poses of main tips at which an index changed.
        singular_families: the families that came, went or moved.
        worst_gravity: the joints whose worst gravity torque, or its share of the effort limit, changed.
        unchanged: what was looked at and did not change, or was not looked at and why, a line each.
        certificate: what the two engines say of all of it; None where nothing had to be computed.
    """

    tips: tuple[Displacement, ...] = ()
    reach: tuple[Reach, ...] = ()
    manipulability: tuple[PoseIndices, ...] = ()
    singular_families: tuple[FamilyChange, ...] = ()
    worst_gravity: tuple[WorstEffort, ...] = ()
    unchanged: tuple[str, ...] = ()
    certificate: Certificate | None = None


@dataclass(frozen=True)
class Question:
    """What is asked: of which tips (by A's names), to which tolerance, with how many samples.

    Attributes:
        frames: names of links in A; None for all tips.
        tolerance: what does not count.
        samples: random configurations of each search.
        seed: of the random numbers.
        progress: told what is being done, and which share of it is.
    """

    frames: tuple[str, ...] | None
    tolerance: Tolerance
    samples: int
    seed: int
    progress: Callable[[str, float], None] | None = None

    def tell(self, what: str, share: float) -> None:
        """Tell what is being done."""
        if self.progress is not None:
            self.progress(what, share)


def consequences(a: Model, b: Model, matching: Matching, changed: Sequence[Change], question: Question) -> Consequences:
    """Return what follows from what changed.

    Args:
        a: the robot before.
        b: the robot after.
        matching: which joint and link is which.
        changed: what changed.
        question: what is asked.

    Raises:
        EngineError: Pinocchio refuses a robot.
    """
    moved = motions(a.robot, b.robot, matching, question.frames)
    tips = () if moved is None else moved.tips
    answer = _Answer(a, b, matching, question)
    if tips:
        looked = answer.displacements([tip for tip in tips if not tip.alike], len(tips))
        limited = [tip for tip in tips if tip.alike and not tip.ranges_alike]
        leading = answer.leading([*looked, *limited])
        answer.reaches(leading)
        answer.indices(leading[:_MAIN])
        answer.families([tip for tip in leading if not tip.alike and not tip.shape_alike][:_MAIN])
    else:
        answer.lines.append("no tip is in both robots: displacement, reach, manipulability are not compared")
    answer.efforts(changed)
    found, proofs = answer.found, answer.proofs
    return replace(found, unchanged=tuple(answer.lines), certificate=combined(proofs) if proofs else None)


def _grouped(tips: Sequence[Tip]) -> list[list[Tip]]:
    """Return tips by what displaces them, those that fewest joints move first: the tool before the fingers."""
    groups = dict[tuple[str | float, ...], list[Tip]]()
    for tip in tips:
        groups.setdefault(tip.group, []).append(tip)
    return [sorted(group, key=lambda tip: tip.depth) for group in groups.values()]


def _bodies(tips: Sequence[Tip]) -> list[Tip]:
    """Return the first tip of each rigid body."""
    first = dict[str | None, Tip]()
    for tip in tips:
        first.setdefault(tip.body, tip)
    return list(first.values())


@dataclass
class _Answer:
    """The consequences as they are found, the certificates behind them, and what is to be said of the rest."""

    a: Model
    b: Model
    matching: Matching
    question: Question
    found: Consequences = field(default_factory=Consequences)
    proofs: list[Certificate] = field(default_factory=list)
    lines: list[str] = field(default_factory=list)

    def leading(self, tips: Sequence[Tip]) -> list[Tip]:
        """Return the tips whose reach is looked at: all that were asked for, or the first bodies of each group."""
        groups = _grouped(tips)
        if self.question.frames is not None:
            return list(tips)
        first = [tip for group in groups for tip in _bodies(group)[:_EACH]][:_TIPS]
        if len(first) < len(tips):
            shown = ", ".join(quote(tip.name) for tip in first[:4]) + (", ..." if len(first) > 4 else "")
            self.lines.append(
                f"reach, manipulability, singular families: looked at for {shown} of {len(tips)} tips; the others hang "
                "behind the same changes; -f FRAME looks at one"
            )
        return first

    def displacements(self, tips: Sequence[Tip], of: int) -> list[Tip]:
        """Find how far tips are displaced; return those that are beyond the tolerance, or moved by other joints.

        What displaces several tips is searched for once. The first of each group come first, should there be many.
        """
        groups = _grouped(tips)
        order = [*(group[0] for group in groups), *(tip for group in groups for tip in group[1:])]
        shown = order if self.question.frames is not None else order[:_TIPS]
        left = len(tips) - len(shown)
        if left:
            self.lines.append(f"displacement: {left} tips more may be elsewhere; -f FRAME looks at one")
        found, kept = list[Displacement](), list[Tip]()
        first = dict[tuple[str | float, ...], Displacement]()
        samples, seed = self.question.samples, self.question.seed
        for i, tip in enumerate(shown):
            self.question.tell(f"tip {tip.name}", i / len(shown))
            one = displacement(self.a, self.b, tip, self.matching, samples, seed, first.get(tip.group))
            first.setdefault(tip.group, one)
            self.proofs.append(one.certificate)
            away = max(one.translation.value, one.rotation.value) > self.question.tolerance.absolute
            if away:
                found.append(one)
            if away or self._other_joints(tip):
                kept.append(tip)
        found.sort(key=lambda one: -round(max(one.translation.value, one.rotation.value), 12))
        self.found = replace(self.found, tips=tuple(found))
        same = of - len(found) - left
        if same:
            others = f"{same} {'other ' if found else ''}tip{' stays' if same == 1 else 's stay'}"
            self.lines.append(f"displacement: {others} where {'it was' if same == 1 else 'they were'}")
        return kept

    def _other_joints(self, tip: Tip) -> bool:
        """Return whether other joints move the tip now: it may be where it was, and free to go elsewhere."""
        ours = [joint.name for joint in self.a.robot.movable_path(tip.ground[0], tip.name)]
        theirs = [joint.name for joint in self.b.robot.movable_path(tip.ground[1], tip.other)]
        return [self.matching.joints.get(name) for name in ours] != theirs

    def reaches(self, tips: Sequence[Tip]) -> None:
        """Find how far tips reach."""
        found = list[Reach]()
        for i, tip in enumerate(tips):
            self.question.tell(f"reach of {tip.name}", i / len(tips))
            one = reach(self.a, self.b, tip, self.question.samples, self.question.seed)
            self.proofs.append(one.certificate)
            noise = _NOISE * max(one.before.value, one.after.value)
            if abs(one.change) > max(self.question.tolerance.absolute, noise):
                found.append(one)
        self.found = replace(self.found, reach=tuple(found))
        if not found:
            self.lines.append("reach: unchanged")

    def indices(self, tips: Sequence[Tip]) -> None:
        """Find manipulability at named poses."""
        found, slight = list[PoseIndices](), 0
        named = poses(self.a, self.b)
        failed = refused(self.a, self.b, named)
        least = max(self.question.tolerance.relative, _NOISE)
        for i, tip in enumerate(tips):
            self.question.tell(f"manipulability of {tip.name}", i / len(tips))
            looked, why = indices(self.a, self.b, tip, [pose for pose in named if pose not in failed])
            failed |= why
            for one in looked:
                self.proofs += one.certificates
                if one.changed(max(least, _SLIGHT)):
                    found.append(one)
                elif one.changed(least):
                    slight += 1
        self.found = replace(self.found, manipulability=tuple(found))
        compared = [quote(pose) if pose not in ("zero", "mid") else pose for pose in named if pose not in failed]
        if slight:
            self.lines.append(f"manipulability: {slight} indices that changed by less than {_SLIGHT:g} of themselves")
        elif not found and compared:
            self.lines.append(f"manipulability at {', '.join(compared[:4])}: unchanged")
        for reason in dict.fromkeys(failed.values()):
            where = ", ".join([quote(pose) for pose in failed if failed[pose] == reason][:4])
            self.lines.append(f"manipulability at {where}: not compared: {reason}")

    def families(self, tips: Sequence[Tip]) -> None:
        """Find singular families of arms whose axes lie otherwise among each other."""
        reasons = [self._not_an_arm(tip) for tip in tips]
        arms = [tip for tip, reason in zip(tips, reasons, strict=True) if reason is None]
        found, failed = list[FamilyChange](), list[str]()
        for tip in arms:
            try:
                before, after = families_of(
                    self.a, self.b, tip, starts=_STARTS, seed=self.question.seed, progress=self.question.progress
                )
            except UsageError as error:
                failed.append(f"singular families of {tip.name}: not looked for: {error.message}")
                continue
            self.proofs += [before.certificate, after.certificate]
            found += family_changes(before, after, tip.name, self.matching)
        self.found = replace(self.found, singular_families=tuple(found))
        self.lines += failed
        if arms and not found and not failed:
            self.lines.append("singular families: under the same conditions")
        elif not tips:
            self.lines.append("singular families: unchanged")
        self.lines += [
            f"singular families of {quote(tip.name)}: not looked for: {reason}, arms of 6 or 7 alone are searched"
            for tip, reason in zip(tips, reasons, strict=True)
            if reason is not None and not arms
        ]

    def _not_an_arm(self, tip: Tip) -> str | None:
        ours, theirs = not_an_arm(self.a, tip.name, tip.ground[0]), not_an_arm(self.b, tip.other, tip.ground[1])
        return ours or theirs

    def efforts(self, changed: Sequence[Change]) -> None:
        """Find worst gravity torques of the joints whose torque may have changed."""
        joints = loaded_joints(self.a, self.b, self.matching, changed)
        if not joints:
            said = "unchanged" if self._any_joint() else "no joint with one coordinate is in both"
            self.lines.append(f"worst gravity torque: {said}")
            return
        self.question.tell("worst gravity torques", 0.0)
        least = self.question.tolerance.relative
        try:
            found, proof = worst_efforts(
                self.a,
                self.b,
                self.matching,
                joints,
                least,
                samples=self.question.samples,
                seed=self.question.seed,
                progress=self.question.progress,
            )
        except (UsageError, NumberError) as error:
            self.lines.append(f"worst gravity torque: not looked for: {error.message}")
            return
        self.proofs.append(proof)
        told = tuple(one for one in found if one.overloaded or one.differs(max(least, _SLIGHT)))
        self.found = replace(self.found, worst_gravity=told)
        if len(told) < len(found):
            count = f"{len(found) - len(told)} that changed by less than {_SLIGHT:g} of themselves"
            self.lines.append(f"worst gravity torque: {count}")
        elif not found:
            self.lines.append("worst gravity torque: unchanged")

    def _any_joint(self) -> bool:
        joints = (joint for joint in self.a.robot.independent if joint.type.nq == 1)
        return any(joint.name in self.matching.joints for joint in joints)
