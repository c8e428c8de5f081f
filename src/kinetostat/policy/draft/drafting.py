"""What is expected of a robot in a first policy: what is true of it now, with some margin."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import msgspec
import numpy as np

from kinetostat.analysis.configuration import random_configurations
from kinetostat.analysis.profile.wheels import rolls
from kinetostat.engines.model import Model
from kinetostat.errors import KinetostatError, quote
from kinetostat.policy.draft.chains import main_frames, mirrored_name
from kinetostat.policy.expectations import Expectation
from kinetostat.policy.judging import judge
from kinetostat.policy.judging.dexterity import measured
from kinetostat.policy.judging.symmetry import mirrored
from kinetostat.policy.kinds.dexterity import SmallestSingularValue
from kinetostat.policy.kinds.efforts import JointLimits, WorstGravity
from kinetostat.policy.kinds.poses import Reach, Symmetry
from kinetostat.policy.kinds.structure import Follower, Mass, Mobility
from kinetostat.urdf.description import Joint, JointType, Robot

__all__ = ["Proposal", "proposals"]

_MARGIN = 0.8  # of an index that is true now
_NEAR = 0.99  # of a length or a mass
_SINGULAR = 1e-4  # a smallest singular value below it is none to build on
_TRIED = 200  # random configurations, the best of which is taken where those with a name are singular
_MOST_JOINTS = 12  # beyond it the worst torque of weight takes long, and a held root is no arm's any more
_MOST_GROUPS = 12
_MOST_RANGES = 24
_DIGITS = 4  # of the ends of a range
_TINY = 1e-200  # a number below it is rounded to zero
_ENDLESS = 1e6  # an end beyond it is none
_NEARLY = 0.05  # m of the robot's size, and rad: mirror images with a fault, rather than none
_PLANAR = ("x y rz", "x z ry", "y z rx")
_ROWS = ("all", "translation", *_PLANAR, "rotation", "x y", "x z", "y z", "x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True)
class Proposal:
    """An expectation, and what is to be said of it.

    Attributes:
        remark: one line.
        expectation: it; met now. None where there is nothing to expect, and the remark says why.
    """

    remark: str
    expectation: Expectation | None = None


def proposals(model: Model) -> Iterator[Proposal]:
    """Yield what can be expected of a robot. Each is judged: what is not met now is left out, or said."""
    robot = model.robot
    frames = main_frames(robot)
    yield from _mass(model)
    yield from _limits(model)
    yield from _followers(robot)
    yield from _worst(model)
    for frame in frames:
        yield from _chain(model, frame)
    for left in frames:
        right = mirrored_name(left, robot.link_by_name)
        if right is not None:
            yield from _symmetry(model, left, right)


def _met(model: Model, expectation: Expectation) -> bool:
    return judge(model, [expectation])[0].met is True


def _mass(model: Model) -> Iterator[Proposal]:
    total = float(sum(model.engine.masses()))
    if total > 0:
        low, high = _down(_NEAR * total, 4), _up(total / _NEAR, 4)
        within = Mass(at_least=low, at_most=high)
        if _met(model, within):
            yield Proposal(f"Now {total:.6g} kg.", within)


def _limits(model: Model) -> Iterator[Proposal]:
    """Yield that effort and velocity limits do not shrink, and that ranges do not, joints with the same together."""
    joints = [joint for joint in model.robot.independent if joint.type.nq == 1]
    drives = _grouped(joints, lambda joint: (_stated(joint.limit.effort), _stated(joint.limit.velocity)))
    wanted = [
        JointLimits(joints=tuple(names), effort_at_least=effort, velocity_at_least=velocity)
        for (effort, velocity), names in drives.items()
    ]
    yield from _some(wanted, "What the drives give is not to shrink.", "other pairs of limits", _MOST_GROUPS)
    wanted = [
        JointLimits(joints=tuple(names), lower_at_most=lower, upper_at_least=upper)
        for (lower, upper), names in _grouped(joints, _range).items()
    ]
    met = [one for one in wanted if _met(model, one)]
    yield from _some(met, "Ranges are not to shrink: each joint covers this one.", "other ranges", _MOST_RANGES)


def _grouped(
    joints: Iterable[Joint], read: Callable[[Joint], tuple[float | None, float | None]]
) -> dict[tuple[float | None, float | None], list[str]]:
    """Return the names of the joints that something is stated of, those of which the same is stated together."""
    groups: dict[tuple[float | None, float | None], list[str]] = {}
    for joint in joints:
        stated = read(joint)
        if stated != (None, None):
            groups.setdefault(stated, []).append(joint.name)
    return groups


def _range(joint: Joint) -> tuple[float | None, float | None]:
    """Return the range of a joint, rounded inwards; None where an end is not stated, or where it turns for ever."""
    if joint.type is JointType.CONTINUOUS:
        return None, None
    lower, upper = joint.limit.range
    return (
        _up(lower, _DIGITS) if abs(lower) < _ENDLESS else None,
        _down(upper, _DIGITS) if abs(upper) < _ENDLESS else None,
    )


def _some(wanted: Sequence[Expectation], remark: str, others: str, most: int) -> Iterator[Proposal]:
    """Yield the first expectations of a list, and how many are left out."""
    for one in wanted[:most]:
        yield Proposal(remark, one)
        remark = ""
    if len(wanted) > most:
        yield Proposal(f"There are {len(wanted) - most} {others}.")


def _followers(robot: Robot) -> Iterator[Proposal]:
    """Yield that followers go on following."""
    laws = [(joint.name, joint.mimic) for joint in robot.joints if joint.mimic is not None]
    wanted = [
        Follower(joint=name, leader=law.joint, multiplier=law.multiplier, offset=law.offset) for name, law in laws
    ]
    yield from _some(wanted, "Who follows whom.", "other followers", _MOST_GROUPS)


def _stated(limit: float | None) -> float | None:
    return limit if limit is not None and 0 < limit < 1e9 else None


def _worst(model: Model) -> Iterator[Proposal]:
    """Yield the worst use of effort limits by weight, of the joints that have one."""
    robot = model.robot
    joints = [joint for joint in robot.independent if joint.type.nq == 1 and _stated(joint.limit.effort)]
    if not joints or not any(model.engine.masses()):
        return
    if len(robot.independent) > _MOST_JOINTS:
        yield Proposal("The kind worst-gravity-torque is left out: with so many joints it takes long.")
        return
    names = () if len(joints) == len(robot.independent) else tuple(joint.name for joint in joints)
    # A bound that cannot be met shows what is.
    outcome = judge(model, [WorstGravity(at_most_percent=1e-9, joints=names)])[0]
    use = _leading_number(outcome.found)
    if outcome.met is False and use is not None:
        more = " Above 100 %: the drives do not hold the weight everywhere." if use > 100 else ""
        yield Proposal(f"Now {outcome.found}.{more}", WorstGravity(at_most_percent=_up(use / _MARGIN, 2), joints=names))


def _leading_number(text: str) -> float | None:
    try:
        return float(text.partition(" ")[0])
    except ValueError:
        return None


def _chain(model: Model, frame: str) -> Iterator[Proposal]:
    """Yield what is expected of one chain."""
    robot = model.robot
    joints = robot.movable_path(robot.root, frame)
    count = sum(joint.type.nv for joint in joints)
    names = ", ".join(joint.name for joint in joints[:8]) + (", ..." if len(joints) > 8 else "")
    yield Proposal(f"The chain to {quote(frame)}: {names}.", Mobility(frame=frame, equals=count))
    if rolls(model, frame):
        yield Proposal(f"{quote(frame)} is a wheel or a caster: no reach and no singular value is expected of it.")
        return
    yield from _reach(model, frame)
    yield from _dexterity(model, frame, joints)


def _reach(model: Model, frame: str) -> Iterator[Proposal]:
    outcome = judge(model, [Reach(frame=frame, at_least=0.0)])[0]
    now = _leading_number(outcome.found)
    if outcome.met and now:
        yield Proposal(f"Now {outcome.found}.", Reach(frame=frame, at_least=_down(_NEAR * now, 3)))


def _dexterity(model: Model, frame: str, joints: list[Joint]) -> Iterator[Proposal]:
    """Yield the smallest singular value at the SRDF states that move the frame, at mid, or where it is large."""
    asked = _rows(model, frame, len(joints))
    if asked is None:
        yield Proposal(f"Nothing moves {quote(frame)} independently along any rows: no singular value is expected.")
        return
    moved = {joint.name for joint in joints}
    states = list(dict.fromkeys(state.name for state in model.semantics.states if moved & set(state.positions)))
    sound = [word for word in states or ["mid"] if _smallest(model, asked, (word,)) > _SINGULAR]
    singular = [quote(word) for word in states or ["mid"] if word not in sound]
    remark = f"Singular at {', '.join(singular)}. " if singular else ""
    at: str | tuple[str, ...] = tuple(sound) or _dexterous(model, asked, joints)
    now = _smallest(model, asked, at)
    if now <= _SINGULAR:
        yield Proposal(f"{remark}No smallest singular value is expected of {quote(frame)}.")
        return
    where = "states" if states and not singular else at[0] if len(at) == 1 else at
    wanted = msgspec.structs.replace(asked, at=where, at_least=_down(_MARGIN * now, 2))
    if _met(model, wanted):
        yield Proposal(f"{remark}Now {now:.4g}.", wanted)


def _rows(model: Model, frame: str, count: int) -> SmallestSingularValue | None:
    """Return the question with the first rows that the structure moves independently."""
    first = ("translation",) if count <= 3 else ()
    for rows in (*first, *_ROWS):
        asked = SmallestSingularValue(frame=frame, rows=rows, at="random:0", at_least=0.0)
        try:
            if measured(model, asked).lacking is None:
                return asked
        except KinetostatError:
            continue
    return None


def _smallest(model: Model, asked: SmallestSingularValue, at: str | tuple[str, ...]) -> float:
    """Return the smallest singular value at some configurations; 0 where it cannot be told."""
    try:
        return float(np.min(measured(model, msgspec.structs.replace(asked, at=at)).block.minimum_singular_value))
    except KinetostatError:
        return 0.0


def _dexterous(model: Model, asked: SmallestSingularValue, joints: list[Joint]) -> tuple[str, ...]:
    """Return a configuration inside limits at which the smallest singular value is large, in words."""
    places = {j.name: model.robot.position_slices[j.name].start for j in joints if j.type.nq == 1}
    drawn = random_configurations(model.robot, 0, _TRIED)
    words = tuple(",".join(f"{name}={q[place]:.2f}" for name, place in places.items()) for q in drawn)
    try:
        found = measured(model, msgspec.structs.replace(asked, at=words)).block.minimum_singular_value
    except KinetostatError:
        return ("zero",)
    return (words[int(np.argmax(found))],)


def _symmetry(model: Model, left: str, right: str) -> Iterator[Proposal]:
    """Yield that a left and a right chain are mirror images, as exactly as they are now; else by how much they fail."""
    strict = Symmetry(left=left, right=right)
    now = judge(model, [strict])[0]
    if now.met:
        yield Proposal("Both sides are mirror images.", strict)
        return
    for tolerance in (1e-6, 1e-4, 1e-3):
        for masses, limits in ((True, True), (False, True), (True, False), (False, False)):
            one = msgspec.structs.replace(strict, tolerance=tolerance, masses=masses, limits=limits)
            if _met(model, one):
                yield Proposal(f"Both sides are mirror images, but: {now.found}.", one)
                return
    if _nearly(model, strict):
        yield Proposal(f"{quote(left)} and {quote(right)} are nearly mirror images, but not quite: {now.found}.")


def _nearly(model: Model, asked: Symmetry) -> bool:
    """Return whether a chain is so near the mirror image of another that it may be meant to be one."""
    try:
        found = mirrored(model, asked)
    except KinetostatError:
        return False
    if isinstance(found, str):
        return False
    return found.position <= _NEARLY * max(model.robot.reach, 1e-3) and found.angle <= _NEARLY


def _down(value: float, digits: int) -> float:
    """Return the next number below with so many significant digits."""
    return _rounded(value, digits, math.floor)


def _up(value: float, digits: int) -> float:
    """Return the next number above with so many significant digits."""
    return _rounded(value, digits, math.ceil)


def _rounded(value: float, digits: int, towards: Callable[[float], int]) -> float:
    if abs(value) < _TINY:
        return 0.0
    places = digits - 1 - math.floor(math.log10(abs(value)))
    return float(round(towards(value * 10.0**places) / 10.0**places, max(places, 0)))
