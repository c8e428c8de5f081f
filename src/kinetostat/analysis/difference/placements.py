"""Where joints sit: their placements as matrices, and how far two placements or two axes are apart."""

from __future__ import annotations

import math
from collections.abc import Container, Iterator
from dataclasses import dataclass

import numpy as np

from kinetostat.conventions import Array
from kinetostat.screw import se3, so3
from kinetostat.urdf.description import Joint, JointType, Origin, Robot, Vector

__all__ = ["Anchor", "anchors", "angle_between", "distance", "joint_placements", "origin_matrix", "outward", "turn"]


def joint_placements(robot: Robot) -> dict[str, Array]:
    """Return where each joint sits in its parent link, by the joint's name. (4, 4), m."""
    if not robot.joints:
        return {}
    rotations = so3.from_rpy(np.array([joint.origin.rpy for joint in robot.joints]))
    matrices = se3.placement(rotations, np.array([joint.origin.xyz for joint in robot.joints]))
    placed = {joint.name: matrix for joint, matrix in zip(robot.joints, matrices, strict=True)}
    for joint in robot.joints:
        if joint.origin.quaternion_xyzw is not None:
            placed[joint.name] = origin_matrix(joint.origin)
    return placed


def origin_matrix(origin: Origin) -> Array:
    """Return the placement that URDF's xyz and rpy (or quaternion) write. (4, 4)."""
    if origin.quaternion_xyzw is not None:
        return se3.placement(so3.from_quaternion(np.array(origin.quaternion_xyzw)), np.array(origin.xyz))
    return se3.placement(so3.from_rpy(np.array(origin.rpy)), np.array(origin.xyz))


def outward(robot: Robot) -> Iterator[Joint]:
    """Yield all joints, each after those between it and the root."""
    waiting = [robot.root]
    for link in waiting:
        for joint in robot.child_joints[link]:
            yield joint
            waiting.append(joint.child)


def distance(a: Array, b: Array) -> float:
    """Return how far the origins of two placements are apart, m."""
    return float(math.dist(a[:3, 3], b[:3, 3]))


def turn(a: Array, b: Array) -> float:
    """Return the angle t between two placements, rad, accurate for small ones: |R_a - R_b| = 2 sqrt(2) sin(t/2)."""
    apart = float(np.linalg.norm(a[:3, :3] - b[:3, :3]))
    return 2 * math.asin(min(1.0, apart / math.sqrt(8)))


def angle_between(a: Vector, b: Vector) -> float:
    """Return the angle between two directions, rad, accurate for small ones."""
    (x, y, z), (u, v, w) = a, b
    return math.atan2(math.hypot(y * w - z * v, z * u - x * w, x * v - y * u), x * u + y * v + z * w)


@dataclass(frozen=True)
class Anchor:
    """The nearest link at or above a link that both robots have, if only fixed joints are between, and where it is."""

    link: str
    placement: Array


def anchors(robot: Robot, placements: dict[str, Array], known: Container[str]) -> dict[str, Anchor]:
    """Return the anchor of each link that has one: of a link between two known ones, the one above."""
    found: dict[str, Anchor] = {}
    if robot.root in known:
        found[robot.root] = Anchor(robot.root, np.eye(4))
    for joint in outward(robot):
        if joint.child in known:
            found[joint.child] = Anchor(joint.child, np.eye(4))
        elif joint.type is JointType.FIXED and joint.parent in found:
            above = found[joint.parent]
            found[joint.child] = Anchor(above.link, above.placement @ placements[joint.name])
    return found
