"""What of a robot belongs to no limb, and how it is treated."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from kinetostat.analysis.profile.anatomy import Left, Limb
from kinetostat.analysis.profile.found import Found, Hand
from kinetostat.errors import cut
from kinetostat.urdf.description import JointType, Robot

__all__ = ["beside_chosen", "beside_found"]

_NAMES = 4
_HELD = "held at the middle of limits"
_NAME_IT = "name one under [[robots.chains]] to see it"


def beside_chosen(robot: Robot, limbs: Sequence[Limb]) -> tuple[Left, ...]:
    """Return what belongs to none of the limbs that the settings name."""
    known = {joint for limb in limbs for joint in limb.joints}
    held = _others(robot, known)
    left = [_left(held, f"of no chain that the settings name: {_HELD}")] if held else []
    return (*left, *_moved_by_others(robot, known))


def beside_found(robot: Robot, tree: Found, limbs: Sequence[Limb], more: Sequence[Limb]) -> tuple[Left, ...]:
    """Return what belongs to none of the limbs that are shown.

    Args:
        robot: the description.
        tree: what its tree shows.
        limbs: those that are shown.
        more: limbs that are not.
    """
    known = {joint for limb in (*limbs, *more) for joint in limb.joints}
    left = list[Left]()
    if more:
        why = f"{_counted(len(more), 'more limb')}: those with the most joints are shown; {_NAME_IT}"
        left.append(_left([limb.name for limb in more], why))
    for hand in tree.hands:
        left += _hand(hand, known)
    turning = {joint for joints in tree.wheels.values() for joint in joints}
    if tree.wheels:
        why = "wheel, caster or rotor: what turns without end about an axis through its own frame reaches nothing"
        left.append(_left(list(tree.wheels), why))
    lone = [joint for joint in tree.lone if joint not in known]
    if lone:
        left.append(_left(lone, f"one joint alone, beside longer limbs: {_HELD}; {_NAME_IT}"))
    held = _others(robot, known | turning | set(lone) | {joint for hand in tree.hands for joint in hand.joints})
    if held:
        left.append(_left(held, f"of no limb (the trunk, or beside it): {_HELD}"))
    left += _moved_by_others(robot, known)
    if not limbs:
        left.append(Left("limbs", "there are none: nothing moves but what is told here" if left else "no joint moves"))
    return tuple(left)


def _hand(hand: Hand, known: set[str]) -> Iterable[Left]:
    """Yield what is said of a hand or gripper, unless all of it belongs to limbs."""
    joints = [joint for joint in hand.joints if joint not in known]
    if not joints and hand.joints:
        return
    size = f"{_counted(hand.fingers, 'finger')}, " if hand.kind == "hand" else ""
    size += _counted(len(joints), "joint") + (f" ({_names(joints)})" if joints else "")
    about = "fingers and jaws grasp, they carry no tool" if hand.kind else "short beside what carries them"
    what = f"{hand.kind or 'joints'} beyond {cut(hand.at)}"
    yield Left(what, f"{size}: {about}; {_HELD}; {_NAME_IT}")


def _others(robot: Robot, known: set[str]) -> list[str]:
    """Return the independent joints that are not known and do not float."""
    return [j.name for j in robot.independent if j.name not in known and j.type is not JointType.FLOATING]


def _moved_by_others(robot: Robot, known: set[str]) -> Iterable[Left]:
    """Yield what is said of joints that float, if they belong to no limb, and of followers."""
    floating = [j.name for j in robot.independent if j.name not in known and j.type is JointType.FLOATING]
    if floating:
        yield _left(floating, "floats: held at zero; limbs are looked at from what it carries")
    if robot.followers:
        why = f"{_counted(len(robot.followers), 'follower')}: each moves as its leader and its law say"
        yield _left(list(robot.followers), why)


def _left(names: Sequence[str], why: str) -> Left:
    return Left(_names(names), why)


def _names(names: Sequence[str]) -> str:
    more = f" and {len(names) - _NAMES} more" if len(names) > _NAMES else ""
    return ", ".join(map(cut, names[:_NAMES])) + more


def _counted(count: int, what: str) -> str:
    return f"{count} {what}" + ("s" if count != 1 else "")
