"""Grippers by their names: a jaw at the end of an arm is no joint of the arm, whatever the tree looks like."""

from __future__ import annotations

import re
from collections.abc import Sequence

from kinetostat.urdf.description import Joint

__all__ = ["is_jaw", "without_gripper"]

_JAW_JOINT = re.compile(r"grip|jaw|finger|claw", re.IGNORECASE)
_JAW_LINK = re.compile(r"jaw|finger|claw", re.IGNORECASE)  # a link called gripper is mostly what holds the jaws
_WRIST = re.compile(r"roll|pitch|yaw|rot", re.IGNORECASE)  # the joint that turns the whole gripper


def without_gripper(joints: Sequence[Joint]) -> tuple[Joint, ...]:
    """Return a chain of joints without those of a gripper at its end; the whole chain if all of it is one finger."""
    last = len(joints)
    while last and is_jaw(joints[last - 1]):
        last -= 1
    return tuple(joints[: last or len(joints)])


def is_jaw(joint: Joint) -> bool:
    """Return whether a joint opens and closes a gripper, by its name or that of the link that it moves."""
    by_joint = _JAW_JOINT.search(joint.name) is not None and _WRIST.search(joint.name) is None
    return by_joint or _JAW_LINK.search(joint.child) is not None
