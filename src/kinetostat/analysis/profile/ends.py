"""Where a chain ends: the frame of its last body that is called a tool, a foot, or that carries a hand."""

from __future__ import annotations

import re

from kinetostat.urdf.description import JointType, Robot

__all__ = ["fixed_to", "is_tool", "moving_branches", "named_end", "tool"]

_TOOLS = (
    re.compile(r"tool0|tcp|tool|flange|end_?effector|(^|_)ee(_|$)|grasp|gripper_frame", re.IGNORECASE),
    re.compile(r"foot|(?<!tor)sole|palm|(finger|hand)_?tip|(^|_)tip(_|$)", re.IGNORECASE),
)
_FINGER = re.compile(r"thumb|finger|jaw|claw", re.IGNORECASE)


def moving_branches(robot: Robot) -> dict[str, int]:
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


def named_end(robot: Robot, body: str, ahead: dict[str, int]) -> str:
    """Return the frame of a body that is called a tool; else the one where moving branches leave it; else its own.

    What is called a part of a finger, such as a thumb's base, gives way to the link of the body that carries it.

    Args:
        robot: the description.
        body: the link that a moving joint joins to what is above.
        ahead: the `moving_branches` of the robot.
    """
    branching = [link for link in fixed_to(robot, body) if ahead[link] > 1]
    end = branching[-1] if branching else body
    while end != body and _FINGER.search(end):
        end = robot.parent_joint[end].parent
    return tool(robot, body) or end


def tool(robot: Robot, body: str) -> str | None:
    """Return the frame of a body that is called a tool, or else a foot, the one with the shortest name."""
    links = fixed_to(robot, body)
    named = ([link for link in links if words.search(link)] for words in _TOOLS)
    return next((min(found, key=lambda link: (len(link), link)) for found in named if found), None)


def is_tool(link: str) -> bool:
    """Return whether a link is called a tool: a flange, a TCP, an end effector."""
    return _TOOLS[0].search(link) is not None


def fixed_to(robot: Robot, body: str) -> list[str]:
    """Return a link and all that fixed joints join to it, further out, in the order of the tree."""
    links = [body]
    for link in links:
        links += [joint.child for joint in robot.child_joints[link] if joint.type is JointType.FIXED]
    return links
