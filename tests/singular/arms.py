"""What the tests of singular configurations share: arms to ask about, arms made to a plan, and independent numbers.

Jacobians and placements are Pinocchio's, asked of its engine alone. Lines are written down in the base at the planned
configuration; `arm_urdf` turns them into a file whose joints have any names, frames, zeros and order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cache
from random import Random

import numpy as np

import kinetostat as ks
from kinetostat.analysis.singular.mechanism import mechanism
from kinetostat.urdf.description import JointType
from textbook_support import turn_about
from trees import load_text

# Robots of example-robot-data: (name, tool frame, observer).
ARMS = (
    ("ur5_robot", "tool0", None),
    ("ur10_joint_limited_robot", "tool0", None),
    ("kinova", "j2s6s200_end_effector", None),
    ("z1", "link06", None),
    ("so100", "gripper", None),
    ("talos_left_arm", "gripper_left_base_link", None),
)
REDUNDANT = (
    ("panda", "panda_hand", None),
    ("xarm7", "link_eef", None),
    ("baxter", "right_hand_link", None),
    ("pr2", "r_gripper_tool_frame", "torso_lift_link"),
    ("tiago", "arm_tool_link", "torso_lift_link"),
    ("centauro", "ball1_tip", None),
)
LEGS = (
    ("talos_reduced", "left_sole_link", None),
    ("romeo", "l_sole", None),
    ("icub_reduced", "l_sole", None),
    ("g1_29dof_rev_1_0", "left_ankle_roll_link", None),
    ("human", "left_foot", None),
    ("solo12", "FL_FOOT", None),
    ("a1", "FR_foot", None),
    ("hyq_no_sensors", "lf_foot", None),
    ("bolt", "FL_FOOT", None),
    ("centauro", "contact_1", None),
)
FINGERS = (("allegro_left_hand", "link_3.0_tip", None), ("finger_edu", "finger_tip_link", None))
TEXTBOOK = (
    "planar_2r",
    "planar_2r_6_3",
    "planar_3r",
    "isotropic_3r",
    "torus_3r",
    "anthropomorphic",
    "wrist_zyz",
    "wrist_three_roll",
    "puma560",
    "stanford",
    "scara",
    "rp",
    "pr",
)


@cache
def robot(name):
    """Return a robot, read once; `textbook:NAME`, or a name of example-robot-data."""
    return ks.load(name if ":" in name else f"example:{name}")


@cache
def families(name, frame, observer=None, **asked):
    """Return what `singular_find` says of an arm, asked once; 200 searches unless told."""
    asked.setdefault("starts", 200)
    return ks.singular_find(robot(name), frame, relative_to=observer, **asked)


@cache
def arm_of(name, frame, observer=None, axes=None):
    """Return the mechanism of an arm."""
    return mechanism(robot(name), frame, relative_to=observer, axes=axes)


@cache
def answers(name, frame, observer=None):
    """Return what is said at the witness of every family of an arm: pairs of a family and an answer."""
    result = families(name, frame, observer)
    arm = result.mechanism
    return [
        (family, ks.singular_at(arm.model, frame, whole(arm, family.witness), relative_to=observer))
        for family in result.families
    ]


# --- numbers of Pinocchio alone --------------------------------------------------------------------------------------


def whole(arm, q):
    """Return configurations of the whole robot with a chain's coordinates put in, all else neutral."""
    rest = ks.configuration(arm.model, "zero").q
    full = np.broadcast_to(rest, (*np.shape(q)[:-1], len(rest))).copy()
    full[..., list(arm.indices)] = q
    return full


def columns(arm, q, *, at_tool=False):
    """Return Pinocchio's Jacobian by a chain's coordinates, (..., 6, n), in m and rad.

    It is of the point that the mechanism is computed at, or of the tool point that was asked about.
    Its columns of a planar joint are for (vx, vy) in the moved frame; the coordinates are those in the parent's.
    """
    full = whole(arm, np.asarray(q, dtype=float))
    velocity = replace(arm.velocity, point=tuple(arm.point)) if at_tool else arm.velocity
    matrix = arm.model.engine.jacobian(full, velocity)
    found = []
    for joint in dict.fromkeys(arm.joints):
        part = matrix[..., arm.model.robot.velocity_slices[joint.name]]
        if joint.type is JointType.PLANAR:
            angle = full[..., arm.model.robot.position_slices[joint.name]][..., 2]
            c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
            x, y, turn = np.moveaxis(part, -1, 0)
            part = np.stack([c * x - s * y, s * x + c * y, turn], -1)
        found.append(part)
    return np.concatenate(found, -1)


def pure(arm, q):
    """Return Pinocchio's Jacobian of the task's rows as pure numbers: lengths and slides in units of the arm's."""
    rows = list(arm.task.rows)
    matrix = columns(arm, q)[..., rows, :] * np.where(arm.turning, 1.0, arm.length)
    return matrix / np.where(np.array(rows) < 3, arm.length, 1.0)[:, None]


def decisive(arm, q):
    """Return the singular value that vanishes where an arm is singular, by Pinocchio."""
    return np.linalg.svd(pure(arm, q), compute_uv=False)[..., arm.generic_rank - 1]


def tool(arm, q, *, at_tool=False):
    """Return Pinocchio's placement of the mechanism's own point, or of the tool point, (..., 4, 4)."""
    placement = arm.model.engine.placement(
        whole(arm, np.asarray(q, dtype=float)), arm.velocity.of, arm.velocity.relative_to
    )
    at = np.eye(4)
    at[:3, 3] = arm.point if at_tool else arm.velocity.point or (0, 0, 0)
    return placement @ at


def turned_by(rotation):
    """Return the rotation vector of small rotations (..., 3, 3), right to third order."""
    skew = (rotation - np.swapaxes(rotation, -1, -2)) / 2
    vector = np.stack([skew[..., 2, 1], skew[..., 0, 2], skew[..., 1, 0]], -1)
    sine = np.linalg.norm(vector, axis=-1, keepdims=True)
    return vector * np.where(sine > 1e-8, np.arcsin(np.minimum(sine, 1)) / np.maximum(sine, 1e-300), 1.0)


def moved_away(arm, home, q):
    """Return how far the tool is from a placement in the task's rows, as pure numbers. (..., m)."""
    placement = tool(arm, q)
    turn = turned_by(placement[..., :3, :3] @ home[:3, :3].T)
    gap = np.concatenate([(placement[..., :3, 3] - home[:3, 3]) / arm.length, turn], -1)
    return gap[..., list(arm.task.rows)]


def units(arm):
    """Return what one unit of each coordinate is."""
    return np.where(arm.turning, 1.0, arm.length)


def near_angle(a, b):
    """Return how far angles are apart, the shorter way round."""
    return np.abs(np.remainder(np.asarray(a) - b + math.pi, 2 * math.pi) - math.pi)


# --- arms made to a plan ---------------------------------------------------------------------------------------------


@dataclass
class Line:
    """A joint at the planned configuration: a direction and a point of the base, and its position there."""

    direction: tuple[float, ...]
    point: tuple[float, ...] = (0.0, 0.0, 0.0)
    kind: str = "continuous"
    at: float = 0.0
    limits: tuple[float, float] | None = None
    mimic: tuple[int, float, float] | None = None  # leader's number, multiplier, offset
    name: str = field(default="")


def rotation(generator):
    """Return a random rotation."""
    matrix = np.linalg.qr(generator.normal(size=(3, 3)))[0]
    return matrix * np.sign(np.linalg.det(matrix))


def direction(generator):
    """Return a random unit vector."""
    vector = generator.normal(size=3)
    return vector / np.linalg.norm(vector)


def arm_urdf(lines, seed, *, tip=(0.3, -0.2, 0.4), digits=None, fixed=True, shuffle=True, twisted=True):
    """Return a URDF text of an arm with these joints, and the names that they were given, root and tool.

    Every joint frame is turned at random and slid along its axis; its zero is where the plan's position says. Between
    links there are fixed joints; elements are in any order.
    """
    generator, random = np.random.default_rng(seed), Random(seed)
    marks = random.sample("abcdefghijklmnopqrstuvwxyz", len(lines))
    names = [line.name or f"{mark}{random.randint(10, 99)}" for mark, line in zip(marks, lines, strict=True)]
    last, parent, elements = np.eye(4), "ground", ['<link name="ground"/>']
    for i, line in enumerate(lines):
        axis = np.array(line.direction, dtype=float) / np.linalg.norm(line.direction)
        here = np.eye(4)
        here[:3, :3] = rotation(generator) if twisted else np.eye(3)
        here[:3, 3] = np.array(line.point) + (generator.uniform(-0.3, 0.3) * axis if twisted else 0)
        own = here[:3, :3].T @ axis
        # The plan's configuration has this joint at `at`: before it, the link is turned or slid back.
        back = np.eye(4)
        if line.kind == "prismatic":
            back[:3, 3] = -line.at * own
        else:
            back[:3, :3] = turn_about(own, -line.at)
        elements += _joint(names, i, line, parent, np.linalg.inv(last) @ here @ back, own, digits)
        parent, last = f"link {names[i]}", here
        if fixed and generator.random() < 0.5:
            between = np.eye(4)
            between[:3, :3], between[:3, 3] = rotation(generator), generator.uniform(-0.2, 0.2, 3)
            elements += _fixed(f"weld {names[i]}", parent, f"plate {names[i]}", between, digits)
            parent, last = f"plate {names[i]}", last @ between
    end = np.eye(4)
    end[:3, 3] = tip
    elements += _fixed("last weld", parent, "hand", np.linalg.inv(last) @ end, digits)
    if shuffle:
        random.shuffle(elements)
    return "\n".join(['<robot name="planned">', *elements, "</robot>"]), names


def planned(lines, seed, **asked):
    """Return an arm made to a plan, loaded, and the names of its joints in the order of the plan."""
    text, names = arm_urdf(lines, seed, **asked)
    return load_text(text), names


def _joint(names, i, line, parent, placement, axis, digits):
    child = f"link {names[i]}"
    limit = (
        ""
        if line.limits is None
        else f'<limit lower="{line.limits[0]!r}" upper="{line.limits[1]!r}" effort="1" velocity="1"/>'
    )
    follow = ""
    if line.mimic is not None:
        leader, multiplier, offset = line.mimic
        follow = f'<mimic joint="{names[leader]}" multiplier="{multiplier!r}" offset="{offset!r}"/>'
    return [
        f'<link name="{child}"/>',
        f'<joint name="{names[i]}" type="{line.kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'{_origin(placement, digits)}<axis xyz="{_numbers(axis)}"/>{limit}{follow}</joint>',
    ]


def _fixed(name, parent, child, placement, digits):
    return [
        f'<link name="{child}"/>',
        f'<joint name="{name}" type="fixed"><parent link="{parent}"/><child link="{child}"/>'
        f"{_origin(placement, digits)}</joint>",
    ]


def _origin(placement, digits):
    r = placement[:3, :3]
    pitch = math.atan2(-r[2, 0], math.hypot(r[0, 0], r[1, 0]))
    roll, yaw = math.atan2(r[2, 1], r[2, 2]), math.atan2(r[1, 0], r[0, 0])
    angles = np.array([roll, pitch, yaw])
    angles = angles if digits is None else angles.round(digits)
    return f'<origin xyz="{_numbers(placement[:3, 3])}" rpy="{_numbers(angles)}"/>'


def _numbers(values):
    return " ".join(repr(float(value)) for value in values)
