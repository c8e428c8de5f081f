"""The main chains of a robot: where its arms, legs and fingers end."""

from __future__ import annotations

import re
from collections.abc import Iterable

from kinetostat.urdf.description import JointType, Robot

__all__ = ["main_frames", "mirrored_name"]

_TOOL = re.compile(r"tool0|tcp|tool|flange|end_?effector|(^|_)ee(_|$)", re.IGNORECASE)
_MOST = 8


def main_frames(robot: Robot) -> tuple[str, ...]:
    """Return one frame for each main chain, those with the most joints first, eight at most.

    The way to a tip is cut where other moving branches leave it; the longest piece is what counts, and its end the
    frame: the wrist or palm of an arm with a hand, the foot of a leg. Chains with several joints go before lone ones.
    """
    ahead = _moving_branches(robot)
    pieces: dict[str, int] = {}
    for tip in robot.tips:
        frame, length = _longest_piece(robot, tip, ahead)
        if length:
            pieces.setdefault(_named_end(robot, frame, ahead), length)
    ordered = sorted(pieces, key=lambda frame: -len(robot.movable_path(robot.root, frame)))
    long = [frame for frame in ordered if pieces[frame] > 1]
    return tuple((long or ordered)[:_MOST])


def _moving_branches(robot: Robot) -> dict[str, int]:
    """Return for each link how many moving joints come next on the ways down from it, over fixed joints."""
    order, stack = list[str](), [robot.root]
    while stack:
        link = stack.pop()
        order.append(link)
        stack += [joint.child for joint in robot.child_joints[link]]
    ahead = dict[str, int]()
    for link in reversed(order):
        below = robot.child_joints[link]
        ahead[link] = sum(ahead[j.child] if j.type is JointType.FIXED else 1 for j in below)
    return ahead


def _longest_piece(robot: Robot, tip: str, ahead: dict[str, int]) -> tuple[str, int]:
    """Return the last link of the longest piece without a moving branch of the way to a tip, and its joints' count."""
    best, length, count = robot.root, 0, 0
    for joint, _ in robot.path(robot.root, tip):
        if ahead[joint.parent] > 1:
            count = 0
        count += joint.type is not JointType.FIXED and joint.mimic is None
        if count > length or (count == length and joint.type is JointType.FIXED and best == joint.parent):
            best, length = joint.child, count
    return best, length


def _named_end(robot: Robot, link: str, ahead: dict[str, int]) -> str:
    """Return the frame on the same body that has the name of a tool, the one with the shortest name; else the link."""
    body, stack = list[str](), [_body(robot, link)]
    while stack:
        one = stack.pop()
        body.append(one)
        stack += [joint.child for joint in robot.child_joints[one] if joint.type is JointType.FIXED]
    tools = [one for one in body if _TOOL.search(one)]
    if tools:
        return min(tools, key=lambda one: (len(one), one))
    return link if ahead[link] else _body(robot, link)


def _body(robot: Robot, link: str) -> str:
    """Return the link that the last moving joint before a link moves."""
    return next((joint.child for joint in robot.to_root(link) if joint.type is not JointType.FIXED), robot.root)


_SIDES = (
    ("left", "right"),
    ("l", "r"),
    ("lf", "rf"),
    ("fl", "fr"),
    ("lh", "rh"),
    ("rl", "rr"),
    ("bl", "br"),
    ("hl", "hr"),
)


def mirrored_name(name: str, known: Iterable[str]) -> str | None:
    """Return the name on the right side for a name of the left: `l_hand` -> `r_hand`; None if there is none."""
    names = set(known)
    for left, right in _SIDES:
        inside = left if len(left) > 2 else rf"(?<![A-Za-z0-9]){left}(?![A-Za-z])"
        found = re.sub(inside, lambda word, right=right: _same_case(word[0], right), name, flags=re.IGNORECASE)
        if found != name and found in names:
            return found
    return None


def _same_case(model: str, word: str) -> str:
    return word.upper() if model.isupper() else word.capitalize() if model[:1].isupper() else word
