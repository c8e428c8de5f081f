"""URDF as data: for each element what may, and what must, stand in it. Versions 1.0 to 1.2.

Sources: the parser that defines the format (ros/urdfdom, `urdf_parser/src`), its schema proposal (`urdf.xsd`), and the
documents of the tools whose extensions are known here: Gazebo, ros_control and ros2_control, Drake, MuJoCo, PyBullet,
Isaac, Tesseract. Extensions are known by name and not looked into.

What an inertial, a limit, a calibration or a safety controller must have is judged with the bodies and the joints; here
is only what they may have.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any

from kinetostat.lint.subject import Subject, once
from kinetostat.urdf.document import Element
from kinetostat.urdf.reader import MAX_ANGLE, MAX_LENGTH, MAX_MULTIPLIER

__all__ = ["ROBOT", "Number", "Part", "elsewhere", "parts"]


@dataclass(frozen=True)
class Number:
    """An attribute that is a number, or several.

    Attributes:
        size: how many.
        largest: what the reader takes at most, in the attribute's unit.
        infinite: whether an infinite one means "none" (limits; how they are judged is another family's).
    """

    size: int = 1
    largest: float = math.inf
    infinite: bool = False


def _tags(text: str) -> frozenset[str]:
    return frozenset(text.split())


_NONE: Mapping[str, Any] = MappingProxyType({})


@dataclass(frozen=True)
class Part:
    """What may stand in an element.

    Attributes:
        children: what URDF knows in it.
        several: those of them that may stand there more than once.
        required: those that must be there.
        choice: one of these must be there.
        attributes: what may be given, beside the numbers and what is needed.
        needed: the attributes that must be there.
        either: one of these attributes must be there.
        numbers: the attributes that are numbers.
        extensions: children that other tools read.
        extras: attributes that other tools read.
        cosmetic: whether it bears on looks alone.
    """

    children: Mapping[str, Part] = field(default_factory=lambda: _NONE)
    several: tuple[str, ...] = ()
    required: tuple[str, ...] = ()
    choice: tuple[str, ...] = ()
    attributes: tuple[str, ...] = ()
    needed: tuple[str, ...] = ()
    either: tuple[str, ...] = ()
    numbers: Mapping[str, Number] = field(default_factory=lambda: _NONE)
    extensions: frozenset[str] = frozenset()
    extras: frozenset[str] = frozenset()
    cosmetic: bool = False

    @cached_property
    def known_attributes(self) -> frozenset[str]:
        """All attributes that may be given."""
        return self.extras.union(self.attributes, self.needed, self.numbers)

    @cached_property
    def known_children(self) -> frozenset[str]:
        """All elements that may stand in it."""
        return self.extensions.union(self.children)


_LENGTH = Number(largest=MAX_LENGTH)
_LENGTHS = Number(3, MAX_LENGTH)
_LIMIT = Number(infinite=True)

_ORIGIN = Part(numbers={"xyz": _LENGTHS, "rpy": Number(3, MAX_ANGLE), "quat_xyzw": Number(4, MAX_LENGTH)})

# --- links ---

_INERTIAL = Part(
    {
        "origin": _ORIGIN,
        "mass": Part(numbers={"value": Number()}),
        "inertia": Part(numbers=dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), Number())),
    }
)
_ROUND = Part(needed=("radius", "length"), numbers={"radius": _LENGTH, "length": _LENGTH})
_SHAPES = {
    "box": Part(needed=("size",), numbers={"size": _LENGTHS}),
    "cylinder": _ROUND,
    "capsule": _ROUND,
    "sphere": Part(needed=("radius",), numbers={"radius": _LENGTH}),
    "mesh": Part(needed=("filename",), numbers={"scale": _LENGTHS}, extras=frozenset({"convex"})),
}
# Bullet's, Tesseract's and Drake's shapes beside them; two shapes in one geometry are judged elsewhere.
_MORE_SHAPES = _tags("cdf cone convex_mesh ellipsoid heightmap img octomap octree plane sdf_mesh")
_GEOMETRY = Part(_SHAPES, tuple(_SHAPES), choice=tuple(_SHAPES), extensions=_MORE_SHAPES)
_COLOR = Part(needed=("rgba",), numbers={"rgba": Number(4)}, cosmetic=True)
_TEXTURE = Part(attributes=("filename",), cosmetic=True)  # exporters write an empty one beside a colour
_MATERIAL = Part(
    {"color": _COLOR, "texture": _TEXTURE},
    needed=("name",),
    extensions=frozenset({"ambient", "diffuse", "emissive", "specular"}),
    extras=frozenset({"shininess", "specular"}),
    cosmetic=True,
)
_GLOBAL_MATERIAL = Part(
    _MATERIAL.children,
    needed=("name",),
    choice=("color", "texture"),
    extensions=_MATERIAL.extensions,
    extras=_MATERIAL.extras,
    cosmetic=True,
)
_VISUAL = Part(
    {"origin": _ORIGIN, "geometry": _GEOMETRY, "material": _MATERIAL},
    required=("geometry",),
    attributes=("name",),
    extras=frozenset({"group"}),
)
_COLLISION = Part(
    {"origin": _ORIGIN, "geometry": _GEOMETRY},
    required=("geometry",),
    attributes=("name",),
    # Exporters copy <material> from visuals; every reader passes over it.
    extensions=frozenset({"contact_coefficients", "material", "verbose"}),
    extras=frozenset({"concave", "group"}),
)
_LINK = Part(
    {"inertial": _INERTIAL, "visual": _VISUAL, "collision": _COLLISION},
    ("visual", "collision"),
    attributes=("name",),
    needed=("name",),
    extensions=_tags(
        "audio_source collision_checking contact inertia_scaling self_collision_checking self_filter sensor"
    ),
    extras=frozenset({"concave", "type"}),
)

# --- joints ---

_END = Part(needed=("link",))
_JOINT = Part(
    {
        "origin": _ORIGIN,
        "parent": _END,
        "child": _END,
        "axis": Part(needed=("xyz",), numbers={"xyz": _LENGTHS}),
        "limit": Part(
            numbers={
                **dict.fromkeys(("lower", "upper", "effort", "velocity"), _LIMIT),
                **dict.fromkeys(("acceleration", "deceleration", "jerk"), _LIMIT),
            }
        ),
        "mimic": Part(
            needed=("joint",),
            numbers={"multiplier": Number(largest=MAX_MULTIPLIER), "offset": _LENGTH},
        ),
        "dynamics": Part(
            either=("damping", "friction"),
            numbers=dict.fromkeys(("damping", "friction"), Number()),
            extras=frozenset({"armature", "spring_reference", "spring_stiffness"}),
        ),
        "calibration": Part(numbers=dict.fromkeys(("rising", "falling", "reference_position"), Number())),
        "safety_controller": Part(
            numbers=dict.fromkeys(("soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"), _LIMIT)
        ),
    },
    required=("parent", "child"),
    attributes=("name", "type"),
    needed=("name", "type"),
    extensions=frozenset({"hardwareInterface", "isaac_drive_api", "sensor"}),
    extras=frozenset({"dont_collapse", "index"}),
)

# --- the robot ---

ROBOT = Part(
    {"link": _LINK, "joint": _JOINT, "drake:joint": _JOINT, "material": _GLOBAL_MATERIAL},
    ("link", "joint", "drake:joint", "material"),
    attributes=("name", "version"),
    extensions=_tags(
        "actuator chain_loop fixed_frame gazebo isaac loop loop_joint mujoco ros2_control sdf self_filter sensor "
        "transmission verbose"
    ),
)

# Elements of other formats, and where they belong.
_FOREIGN = {
    "it belongs to the SRDF, a file of its own": _tags(
        "chain disable_collisions disable_default_collisions enable_collisions end_effector group group_state "
        "link_sphere_approximation passive_joint virtual_joint"
    ),
    "it is SDF's: Gazebo reads it inside <gazebo>": _tags(
        "enable_wind gravity kinematic model must_be_base_link plugin pose self_collide static surface uri "
        "velocity_decay world"
    ),
    "it is MJCF's: MuJoCo reads it inside <mujoco>": _tags(
        "asset body compiler contact default equality geom keyframe option site tendon worldbody"
    ),
}


def _homes() -> dict[str, str]:
    """Return for each element of URDF the elements that it stands in."""
    homes = dict[str, list[str]]()
    stack, seen = [("robot", ROBOT)], set[int]()
    while stack:
        tag, part = stack.pop()
        if id(part) in seen:
            continue
        seen.add(id(part))
        for child, kind in part.children.items():
            if tag != "robot" or child != "drake:joint":
                homes.setdefault(child, []).append(tag)
                stack.append((child, kind))
    return {tag: " or ".join(f"<{home}>" for home in sorted(set(found))) for tag, found in homes.items()}


_HOMES = _homes()


def elsewhere(tag: str) -> str:
    """Return where an element belongs that URDF does not read where it stands; empty if it is known nowhere."""
    if tag in _HOMES:
        return f"it belongs into {_HOMES[tag]}"
    return next((where for where, tags in _FOREIGN.items() if tag in tags), "")


@once
def parts(subject: Subject) -> Sequence[tuple[Element, Part]]:
    """Return the elements that are URDF's own, in file order, each with what may stand in it; none of another format.

    They are found once for each subject.
    """
    root = subject.root
    found, stack = list[tuple[Element, Part]](), [(root, ROBOT)] if root.tag == "robot" else []
    while stack:
        element, part = stack.pop()
        found.append((element, part))
        known = part.children
        if known and element.children:
            stack.extend((child, known[child.tag]) for child in reversed(element.children) if child.tag in known)
    return found
