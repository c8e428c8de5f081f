"""The main chains of a robot: where its arms, legs and fingers end."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import partial

from kinetostat.analysis.profile.ends import moving_branches, named_end, tool
from kinetostat.urdf.description import JointType, Robot

__all__ = ["main_frames", "mirrored_name"]

_MOST = 8
_HAND = 2  # a chain may be so many joints longer than the arm that it is a gripper's part of


def main_frames(robot: Robot) -> tuple[str, ...]:
    """Return one frame for each main chain, those with the most joints first, eight at most.

    The way to a tip is cut where other moving branches leave it; the longest piece is what counts, and its end the
    frame: the wrist or palm of an arm with a hand, the foot of a leg. Of chains that are parts of one another the
    longest counts, or the one that ends in a tool. Chains with several joints go before lone ones.
    """
    ahead = moving_branches(robot)
    pieces: dict[str, int] = {}
    for tip in robot.tips:
        body, length = _longest_piece(robot, tip, ahead)
        if length:
            pieces.setdefault(body, length)
    long = [body for body in pieces if pieces[body] > 1] or list(pieces)
    frames = {body: named_end(robot, body, ahead) for body in _ends_of_limbs(robot, long)}
    return tuple(frames.values())[:_MOST]


def _longest_piece(robot: Robot, tip: str, ahead: dict[str, int]) -> tuple[str, int]:
    """Return what the longest piece without a moving branch of the way to a tip ends with, and its joints' count."""
    best, length, count = robot.root, 0, 0
    for joint, _ in robot.path(robot.root, tip):
        if ahead[joint.parent] > 1:
            count = 0
        count += joint.type is not JointType.FIXED and joint.mimic is None
        if count > length:
            best, length = joint.child, count
    return best, length


def _ends_of_limbs(robot: Robot, bodies: Iterable[str]) -> list[str]:
    """Return the bodies without those that are on the way to others, those with the most joints first."""
    above = {body: [joint.child for joint in robot.to_root(body)] for body in bodies}
    counts = {body: len(robot.movable_path(robot.root, body)) for body in above}
    dropped = set[str]()
    for body, way in above.items():
        for inner in way[1:]:
            if inner in above:
                short = counts[body] - counts[inner] <= _HAND and tool(robot, inner) and not tool(robot, body)
                dropped.add(body if short else inner)
    return sorted((body for body in above if body not in dropped), key=lambda body: -counts[body])


_SIDES = ("left right", "l r", "lf rf", "fl fr", "lh rh", "rl rr", "bl br", "hl hr")


def mirrored_name(name: str, known: Iterable[str]) -> str | None:
    """Return the name on the right side for a name of the left: `l_hand` -> `r_hand`; None if there is none."""
    names = set(known)
    for left, right in map(str.split, _SIDES):
        inside = left if len(left) > 2 else rf"(?<![A-Za-z0-9]){left}(?![A-Za-z])"
        found = re.sub(inside, partial(_in_case_of, right), name, flags=re.IGNORECASE)
        if found != name and found in names:
            return found
    return None


def _in_case_of(word: str, found: re.Match[str]) -> str:
    return word.upper() if found[0].isupper() else word.capitalize() if found[0][:1].isupper() else word
