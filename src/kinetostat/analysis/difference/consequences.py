"""What follows from changes of a robot: where its tips are, how far they reach, how well they move, what they bear."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from kinetostat.analysis.crosscheck import Certificate, combined
from kinetostat.analysis.difference.dexterity import (
    FamilyChange,
    PoseIndices,
    families_of,
    family_changes,
    indices,
    is_arm,
    poses,
)
from kinetostat.analysis.difference.displacement import Displacement, Reach, displacement, reach
from kinetostat.analysis.difference.effort import WorstEffort, bears_on_effort, worst_efforts
from kinetostat.analysis.difference.matching import Matching
from kinetostat.analysis.difference.motion import Tip, motions
from kinetostat.analysis.difference.change import Change, Tolerance
from kinetostat.engines.model import Model
from kinetostat.errors import NumberError, UsageError

__all__ = ["Consequences", "Question", "consequences"]

_TIPS = 32  # whose displacement is looked for, unless they are named
_MAIN = 4  # whose manipulability and singular families are looked at
_STARTS = 400  # searches for singular families; one that is missed is tried all the same
_NOISE = 1e-6  # of a reach or an index: what the search for it is good for


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
        limited = answer.first([tip for tip in tips if tip.alike and not tip.ranges_alike])
        answer.reaches([*looked, *limited])
        answer.indices(_main([*looked, *limited]))
        answer.families(_main([tip for tip in looked if not tip.shape_alike]))
    else:
        answer.lines.append("no tip is in both robots: displacement, reach, manipulability are not compared")
    answer.efforts(changed)
    found, proofs = answer.found, answer.proofs
    return replace(found, unchanged=tuple(answer.lines), certificate=combined(proofs) if proofs else None)


def _main(tips: Sequence[Tip]) -> list[Tip]:
    """Return the first tips of different bodies."""
    bodies = {tip.body: tip for tip in reversed(tips)}
    return [tip for tip in tips if bodies[tip.body] is tip][:_MAIN]


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

    def first(self, tips: Sequence[Tip]) -> list[Tip]:
        """Return the tips that are looked at: all that were asked for, or the first."""
        return list(tips) if self.question.frames is not None else list(tips[:_TIPS])

    def displacements(self, tips: Sequence[Tip], of: int) -> list[Tip]:
        """Find how far tips are displaced; return those that are beyond the tolerance, or moved by other joints."""
        shown = self.first(tips)
        left = len(tips) - len(shown)
        if left:
            self.lines.append(f"displacement: {left} tips more may be elsewhere; -f FRAME looks at one")
        found, kept = list[Displacement](), list[Tip]()
        for i, tip in enumerate(shown):
            self.question.tell(f"tip {tip.name}", i / len(shown))
            one = displacement(self.a, self.b, tip, self.matching, self.question.samples, self.question.seed)
            self.proofs.append(one.certificate)
            away = max(one.translation.value, one.rotation.value) > self.question.tolerance.absolute
            if away:
                found.append(one)
            if away or self._other_joints(tip):
                kept.append(tip)
        found.sort(key=lambda one: -max(one.translation.value, one.rotation.value))
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
        found = list[PoseIndices]()
        named = poses(self.a, self.b)
        for i, tip in enumerate(tips):
            self.question.tell(f"manipulability of {tip.name}", i / len(tips))
            for one in indices(self.a, self.b, tip, named):
                self.proofs += one.certificates
                if one.changed(max(self.question.tolerance.relative, _NOISE)):
                    found.append(one)
        self.found = replace(self.found, manipulability=tuple(found))
        if not found:
            self.lines.append(f"manipulability at {', '.join(named[:4])}: unchanged")

    def families(self, tips: Sequence[Tip]) -> None:
        """Find singular families of arms whose axes lie otherwise among each other."""
        arms = [tip for tip in tips if all(self._is_arm(tip))]
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
        elif not arms:
            reason = "only arms of 6 or 7 joints are searched" if tips else "unchanged"
            self.lines.append(f"singular families: {reason}")

    def _is_arm(self, tip: Tip) -> Iterator[bool]:
        yield is_arm(self.a, tip.name, tip.ground[0])
        yield is_arm(self.b, tip.other, tip.ground[1])

    def efforts(self, changed: Sequence[Change]) -> None:
        """Find worst gravity torques."""
        if not any(bears_on_effort(change) for change in changed):
            self.lines.append("worst gravity torque: unchanged")
            return
        self.question.tell("worst gravity torques", 0.0)
        try:
            found, proof = worst_efforts(
                self.a,
                self.b,
                self.matching,
                self.question.tolerance.relative,
                samples=self.question.samples,
                seed=self.question.seed,
                progress=self.question.progress,
            )
        except (UsageError, NumberError) as error:
            self.lines.append(f"worst gravity torque: not looked for: {error.message}")
            return
        self.proofs.append(proof)
        self.found = replace(self.found, worst_gravity=found)
        if not found:
            self.lines.append("worst gravity torque: unchanged")
