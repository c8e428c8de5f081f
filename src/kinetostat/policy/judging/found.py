"""What judges have in common: what they return, which frames and configurations are meant, and who is a witness."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from kinetostat.analysis.configuration import checked, configuration, neutral
from kinetostat.analysis.crosscheck import Certificate
from kinetostat.analysis.named_states import named_states
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.errors import DisagreementError, UsageError, cut, quote
from kinetostat.policy.kinds.common import OfFrame
from kinetostat.urdf.description import Joint, JointType, Robot

__all__ = [
    "SLACK",
    "Configurations",
    "Found",
    "above",
    "agreed",
    "below",
    "configurations",
    "ends",
    "mattering",
    "quiet",
    "witness",
]

SLACK = 1e-9  # of a bound: a number that is its own bound is not beyond it by rounding
_NOISE = 1e-12  # of a robot's size, in m and rad: what is left of a zero
_OF_STATES = "states"


@dataclass(frozen=True)
class Found:
    """What a judge has found.

    Attributes:
        met: whether the expectation is met; None if it cannot be judged.
        text: what is, with its unit; or why it cannot be judged.
        witness: positions of joints at which it is so.
        remedy: a command that makes what is now what is wanted; empty where there is none.
    """

    met: bool | None
    text: str
    witness: Mapping[str, float] = field(default_factory=dict)
    remedy: str = ""


@dataclass(frozen=True)
class Configurations:
    """Configurations (m, nq), each with the word that it was asked for by."""

    labels: tuple[str, ...]
    q: Array


def above(value: float, bound: float) -> bool:
    """Return whether a value is at least a bound."""
    return value >= bound - SLACK * abs(bound)


def below(value: float, bound: float) -> bool:
    """Return whether a value is at most a bound."""
    return value <= bound + SLACK * abs(bound)


def quiet(value: float, robot: Robot) -> float:
    """Return a distance or an angle; zero where it is rounding noise for a robot of that size."""
    return 0.0 if abs(value) <= _NOISE * max(1.0, robot.reach) else value


def agreed(certificate: Certificate) -> None:
    """Go on only if the engines agree.

    Raises:
        DisagreementError: they do not.
    """
    if certificate.agree is False:
        apart = f"{certificate.max_difference:.3g}, more than {certificate.tolerance:.3g}"
        raise DisagreementError(f"the engines disagree by {apart}: neither number is trusted")


def ends(robot: Robot, asked: OfFrame) -> tuple[str, str]:
    """Return the frame and the observer that are meant.

    Raises:
        UnknownNameError: there is no such frame.
        AmbiguousNameError: no frame is named, and the robot has several tips.
    """
    return robot.frame(asked.frame or robot.default_tip()), robot.frame(asked.relative_to or robot.root)


def configurations(
    model: Model, at: str | Sequence[float | str], joints: Iterable[Joint] | None = None
) -> Configurations:
    """Return the configurations that are meant, at least one.

    Args:
        model: the robot.
        at: one in words, a list of numbers, a list of words, or "states".
        joints: those that a state must move one of to count, where all states are meant; default any.

    Raises:
        UsageError: a configuration that there is not; no state.
    """
    if not isinstance(at, str) and not isinstance(at[0], str):
        numbers = np.array([float(number) for number in at])
        return Configurations(("the given configuration",), checked(model.robot, configuration(model, numbers).q)[None])
    words = [at] if isinstance(at, str) else [str(word) for word in at]
    found = [one for word in words for one in _meant(model, word, joints)]
    return Configurations(tuple(label for label, _ in found), np.array([q for _, q in found]))


def _meant(model: Model, word: str, joints: Iterable[Joint] | None) -> list[tuple[str, Array]]:
    if word != _OF_STATES:
        return [(cut(word), checked(model.robot, configuration(model, word).q))]
    moved = None if joints is None else {joint.name for joint in joints}
    states = [state for state in named_states(model) if moved is None or moved & set(state.positions)]
    if not states:
        missing = "no SRDF state moves the frame" if model.semantics.states else "there is no SRDF state"
        raise UsageError(missing, remedy="name configurations in at")
    return [(quote(state.name), checked(model.robot, configuration(model, state.positions).q)) for state in states]


def witness(robot: Robot, q: Array, joints: Iterable[Joint]) -> dict[str, float]:
    """Return the part of a configuration (nq,) that matters, by coordinate: that of some joints."""
    names = robot.position_names
    places = (i for joint in joints for i in range(robot.nq)[robot.position_slices[joint.name]])
    return {names[i]: float(q[i]) + 0.0 for i in places}


def mattering(robot: Robot, joint: Joint, q: Array, frame: str = "") -> list[Joint]:
    """Return the joints that decide what weight asks of a joint.

    Those between the root and the joint; where it bears what a frame holds, those between the root and that; and of
    what hangs on the joint, those that are not at zero.
    """
    path = robot.movable_path(robot.root, frame) if frame else []
    if joint not in path:
        path = robot.movable_path(robot.root, joint.child)
    found = {one.name: one for one in path}
    rest, stack = neutral(robot), [joint.child]
    while stack:
        for below in robot.child_joints[stack.pop()]:
            stack.append(below.child)
            if below.type is not JointType.FIXED:
                leader = robot.joint_by_name[robot.followers[below.name].joint] if below.mimic else below
                where = robot.position_slices[leader.name]
                if np.any(q[where] != rest[where]):
                    found.setdefault(leader.name, leader)
    return list(found.values())
