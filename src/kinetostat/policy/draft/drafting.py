"""What is expected of a robot in a first policy: what is true of it now, with some margin."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import msgspec
import numpy as np

from kinetostat.analysis.configuration import random_configurations
from kinetostat.engines.model import Model
from kinetostat.errors import KinetostatError, quote
from kinetostat.policy.draft.chains import main_frames, mirrored_name
from kinetostat.policy.expectations import Expectation
from kinetostat.policy.judging import judge
from kinetostat.policy.judging.dexterity import measured
from kinetostat.policy.kinds.dexterity import SmallestSingularValue
from kinetostat.policy.kinds.efforts import JointLimits, WorstGravity
from kinetostat.policy.kinds.poses import Reach, Symmetry
from kinetostat.policy.kinds.structure import Follower, Mass, Mobility
from kinetostat.urdf.description import Joint, Robot

__all__ = ["Proposal", "proposals"]

_MARGIN = 0.8  # of an index that is true now
_NEAR = 0.99  # of a length or a mass
_SINGULAR = 1e-4  # a smallest singular value below it is none to build on
_TRIED = 200  # random configurations, the best of which is taken where those with a name are singular
_MOST_JOINTS = 12  # beyond it the worst torque of weight takes long, and a held root is no arm's any more
_MOST_GROUPS = 12
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
    yield from _limits(robot)
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


def _limits(robot: Robot) -> Iterator[Proposal]:
    """Yield that effort and velocity limits do not shrink, joints with the same limits together."""
    groups: dict[tuple[float | None, float | None], list[str]] = {}
    for joint in robot.independent:
        if joint.type.nq == 1:
            key = _stated(joint.limit.effort), _stated(joint.limit.velocity)
            if any(key):
                groups.setdefault(key, []).append(joint.name)
    remark = "What the drives give is not to shrink."
    for (effort, velocity), joints in list(groups.items())[:_MOST_GROUPS]:
        yield Proposal(remark, JointLimits(joints=tuple(joints), effort_at_least=effort, velocity_at_least=velocity))
        remark = ""
    if len(groups) > _MOST_GROUPS:
        yield Proposal(f"Joints have {len(groups) - _MOST_GROUPS} other pairs of limits.")


def _followers(robot: Robot) -> Iterator[Proposal]:
    """Yield that followers go on following."""
    remark = "Who follows whom."
    laws = [(joint.name, joint.mimic) for joint in robot.joints if joint.mimic is not None]
    for name, law in laws[:_MOST_GROUPS]:
        follower = Follower(joint=name, leader=law.joint, multiplier=law.multiplier, offset=law.offset)
        yield Proposal(remark, follower)
        remark = ""
    if len(laws) > _MOST_GROUPS:
        yield Proposal(f"{len(laws) - _MOST_GROUPS} other joints follow.")


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
    """Yield that a left and a right chain are mirror images, as exactly as they are now."""
    for tolerance in (1e-6, 1e-4, 1e-3):
        for masses, limits in ((True, True), (False, True), (True, False), (False, False)):
            one = Symmetry(left=left, right=right, tolerance=tolerance, masses=masses, limits=limits)
            if _met(model, one):
                yield Proposal("Both sides are mirror images.", one)
                return


def _down(value: float, digits: int) -> float:
    """Return the next number below with so many significant digits."""
    return _rounded(value, digits, math.floor)


def _up(value: float, digits: int) -> float:
    """Return the next number above with so many significant digits."""
    return _rounded(value, digits, math.ceil)


def _rounded(value: float, digits: int, towards: Callable[[float], int]) -> float:
    if value == 0:
        return 0.0
    places = digits - 1 - math.floor(math.log10(abs(value)))
    return float(round(towards(value * 10.0**places) / 10.0**places, max(places, 0)))
