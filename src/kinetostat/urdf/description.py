"""The description of a robot: frozen links and joints, and the tree that they make. No file, no mathematics.

Positions and velocities of a robot are listed joint by joint in file order, over its *independent* joints: those that
are neither fixed nor followers (mimic). A joint has `nq` position and `nv` velocity coordinates:

    revolute, continuous [rad], prismatic [m], screw [rad]   1, 1
    planar    x, y [m], theta [rad]                          3, 3   velocity: twist (vx, vy, wz) in the moved frame
    floating  x, y, z [m], qx, qy, qz, qw                    7, 6   velocity: twist (v, w) in the child frame
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cached_property

from kinetostat.conventions import (
    FLOATING_BASE_JOINT,
    FLOATING_POSITION,
    PLANAR_POSITION,
    PLANAR_VELOCITY,
    TWIST_ROWS,
    WORLD_LINK,
)
from kinetostat.errors import (
    AmbiguousNameError,
    ConfigurationError,
    UnknownNameError,
    UsageError,
    quote,
    unknown_name,
)

__all__ = [
    "MASSLESS",
    "NO_LIMIT",
    "Inertial",
    "Joint",
    "JointType",
    "Limit",
    "Link",
    "Mimic",
    "Origin",
    "Remark",
    "Robot",
]

Vector = tuple[float, float, float]

NO_LIMIT = 1e6  # rad or m: a larger one is written for "none"
MASSLESS = "the link counts as massless"  # how a remark ends that says so


class JointType(StrEnum):
    """The joint types of URDF, and the screw joint of Drake's dialect."""

    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    FIXED = "fixed"
    FLOATING = "floating"
    PLANAR = "planar"
    SCREW = "screw"

    @property
    def nq(self) -> int:
        """Number of position coordinates."""
        return {JointType.FIXED: 0, JointType.FLOATING: 7, JointType.PLANAR: 3}.get(self, 1)

    @property
    def nv(self) -> int:
        """Number of velocity coordinates."""
        return {JointType.FIXED: 0, JointType.FLOATING: 6, JointType.PLANAR: 3}.get(self, 1)

    @property
    def is_angle(self) -> bool:
        """Whether its single coordinate is an angle."""
        return self in (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.SCREW)


@dataclass(frozen=True)
class Remark:
    """Something odd about a file that does not stop a reader: line, element, and what it is."""

    line: int
    element: str
    text: str

    def __str__(self) -> str:
        return f"line {self.line}: {self.element}: {self.text}" if self.element else f"line {self.line}: {self.text}"


@dataclass(frozen=True)
class Origin:
    """A placement as URDF writes it: xyz in metres, and fixed-axis XYZ angles in radians or a quaternion xyzw."""

    xyz: Vector = (0.0, 0.0, 0.0)
    rpy: Vector = (0.0, 0.0, 0.0)
    quaternion_xyzw: tuple[float, float, float, float] | None = None

    @property
    def length(self) -> float:
        """Distance between the two frames, in metres."""
        x, y, z = self.xyz
        return float((x * x + y * y + z * z) ** 0.5)


@dataclass(frozen=True)
class Limit:
    """Limits of a joint: position in m or rad, effort in N or Nm, velocity in m/s or rad/s; None where not stated."""

    lower: float | None = None
    upper: float | None = None
    effort: float | None = None
    velocity: float | None = None

    @property
    def range(self) -> tuple[float, float]:
        """The position range, in order; infinite where there is none."""
        lower = -float("inf") if self.lower is None else self.lower
        upper = float("inf") if self.upper is None else self.upper
        return (lower, upper) if lower <= upper else (upper, lower)

    @property
    def swapped(self) -> bool:
        """Whether the file states a lower end above the upper one."""
        return self.lower is not None and self.upper is not None and self.lower > self.upper


@dataclass(frozen=True)
class Mimic:
    """A follower's law: position = multiplier x (position of `joint`) + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Inertial:
    """Mass in kg, placement of the centre of mass, and inertia there in kg m2 (ixx, ixy, ixz, iyy, iyz, izz)."""

    mass: float
    origin: Origin
    inertia: tuple[float, float, float, float, float, float]


@dataclass(frozen=True)
class Mesh:
    """The name of a mesh file as the robot file gives it."""

    uri: str
    line: int


@dataclass(frozen=True)
class Link:
    """A rigid body; its frame is what Jacobians and placements are asked of."""

    name: str
    line: int
    inertial: Inertial | None = None
    meshes: tuple[Mesh, ...] = ()


@dataclass(frozen=True)
class Joint:
    """A joint between two links. `axis` is a unit vector in the joint frame; `pitch` in m per turn is for screws."""

    name: str
    type: JointType
    parent: str
    child: str
    line: int
    origin: Origin = Origin()
    axis: Vector = (1.0, 0.0, 0.0)
    limit: Limit = Limit()
    mimic: Mimic | None = None
    pitch: float = 0.0

    @property
    def position_names(self) -> tuple[str, ...]:
        """Names of the position coordinates: the joint's own, or joint.x, joint.y, ... where there are several."""
        return self._names(FLOATING_POSITION, PLANAR_POSITION)

    @property
    def velocity_names(self) -> tuple[str, ...]:
        """Names of the velocity coordinates."""
        return self._names(TWIST_ROWS, PLANAR_VELOCITY)

    @property
    def slide(self) -> float:
        """How far it slides at most, m: the larger end of its range, ends without limit left out; 0 if it does not."""
        if self.type is not JointType.PRISMATIC:
            return 0.0
        return max((abs(end) for end in self.limit.range if abs(end) < NO_LIMIT), default=0.0)

    def _names(self, floating: tuple[str, ...], planar: tuple[str, ...]) -> tuple[str, ...]:
        if self.type is JointType.FIXED:
            return ()
        if self.type is JointType.FLOATING:
            return tuple(f"{self.name}.{part}" for part in floating)
        if self.type is JointType.PLANAR:
            return tuple(f"{self.name}.{part}" for part in planar)
        return (self.name,)


@dataclass(frozen=True)
class Robot:
    """A tree of links and joints, in file order. `root` is the name of the one link without a parent."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    root: str
    remarks: tuple[Remark, ...] = field(default=(), compare=False)

    # --- names -------------------------------------------------------------------------------------------------

    @cached_property
    def link_by_name(self) -> dict[str, Link]:
        """Links by name, in file order."""
        return {link.name: link for link in self.links}

    @cached_property
    def joint_by_name(self) -> dict[str, Joint]:
        """Joints by name, in file order."""
        return {joint.name: joint for joint in self.joints}

    def frame(self, name: str) -> str:
        """Return the name if it is a frame (a link).

        Raises:
            UnknownNameError: it is not; the nearest names are told, or the child link if it is a joint.
        """
        if name in self.link_by_name:
            return name
        joint = self.joint_by_name.get(name)
        if joint is not None:
            raise UnknownNameError(
                f"{quote(name)} is a joint, not a frame",
                remedy=f"its frame is that of its child link {quote(joint.child)}",
            )
        raise unknown_name("frame", name, self.link_by_name, listing="'kinetostat frames' lists them")

    def independent_joint(self, name: str, known: Iterable[str] = ()) -> Joint:
        """Return the joint of that name, which a user may set. `known`: names that would do, if not those of joints.

        Raises:
            UnknownNameError: there is no such joint.
            ConfigurationError: it is fixed, or follows another joint.
        """
        joint = self.joint_by_name.get(name)
        if joint is None:
            names = list(known) or [j.name for j in self.independent]
            raise unknown_name("joint", name, names, listing="'kinetostat info' lists them")
        if joint.type is JointType.FIXED:
            raise ConfigurationError(f"joint {quote(name)} is fixed: it has no position")
        if joint.mimic is not None:
            leader = self.followers[name].joint
            message = f"joint {quote(name)} follows {quote(leader)}"
            raise ConfigurationError(message, remedy=f"use {quote(leader)}, its leader")
        return joint

    # --- tree --------------------------------------------------------------------------------------------------

    @cached_property
    def parent_joint(self) -> dict[str, Joint]:
        """The joint above each link; the root link has none."""
        return {joint.child: joint for joint in self.joints}

    @cached_property
    def child_joints(self) -> dict[str, list[Joint]]:
        """The joints below each link, in file order."""
        below: dict[str, list[Joint]] = {link.name: [] for link in self.links}
        for joint in self.joints:
            below[joint.parent].append(joint)
        return below

    @cached_property
    def tips(self) -> tuple[str, ...]:
        """The links without children, in file order."""
        return tuple(link.name for link in self.links if not self.child_joints[link.name])

    def to_root(self, link: str) -> Iterator[Joint]:
        """Yield the joints from a link up to the root."""
        while link in self.parent_joint:
            joint = self.parent_joint[link]
            yield joint
            link = joint.parent

    def path(self, start: str, end: str) -> list[tuple[Joint, int]]:
        """Return the joints between two links in path order, each with +1 (walked down) or -1 (walked up)."""
        up = list(self.to_root(start))
        down = list(self.to_root(end))
        while up and down and up[-1].name == down[-1].name:
            up.pop()
            down.pop()
        return [(joint, -1) for joint in up] + [(joint, +1) for joint in reversed(down)]

    def moving_path(self, start: str, end: str) -> list[Joint]:
        """Return the joints between two links that are not fixed, in path order, followers as they are."""
        return [joint for joint, _ in self.path(start, end) if joint.type is not JointType.FIXED]

    def movable_path(self, start: str, end: str) -> list[Joint]:
        """Return the independent joints that move one link against another, in path order, leaders for followers."""
        found: dict[str, Joint] = {}
        for joint in self.moving_path(start, end):
            leader = self.joint_by_name[self.followers[joint.name].joint] if joint.mimic else joint
            found.setdefault(leader.name, leader)
        return list(found.values())

    def moving_joints(self, start: str, end: str) -> list[Joint]:
        """Return the joints of `movable_path`, one at least.

        Raises:
            UsageError: there is none.
        """
        joints = self.movable_path(start, end)
        if not joints:
            raise UsageError(f"no joint moves {quote(end)} relative to {quote(start)}", remedy="choose another --frame")
        return joints

    def default_tip(self) -> str:
        """Return the one tip of the robot.

        Raises:
            AmbiguousNameError: there are several; they are listed.
        """
        if len(self.tips) == 1:
            return self.tips[0]
        shown = ", ".join(quote(tip) for tip in self.tips[:12]) + (", ..." if len(self.tips) > 12 else "")
        raise AmbiguousNameError(f"the robot has {len(self.tips)} tips: {shown}", remedy="choose one with --frame")

    # --- coordinates -------------------------------------------------------------------------------------------

    @cached_property
    def independent(self) -> tuple[Joint, ...]:
        """The joints that a user may set: not fixed, not followers; in file order."""
        return tuple(j for j in self.joints if j.type is not JointType.FIXED and j.mimic is None)

    @cached_property
    def followers(self) -> dict[str, Mimic]:
        """Each follower's law with chains resolved, so that its leader is an independent joint."""
        resolved: dict[str, Mimic] = {}
        for joint in self.joints:
            if joint.mimic is None or joint.name in resolved:
                continue
            chain = [joint]  # follower first, then what it follows, ...
            while (law := chain[-1].mimic) is not None and chain[-1].name not in resolved:
                chain.append(self.joint_by_name[law.joint])
            for follower, leader in zip(reversed(chain[:-1]), reversed(chain[1:]), strict=True):
                law = follower.mimic
                assert law is not None
                above = resolved.get(leader.name, Mimic(leader.name))
                resolved[follower.name] = Mimic(
                    above.joint, law.multiplier * above.multiplier, law.multiplier * above.offset + law.offset
                )
        return resolved

    @cached_property
    def position_names(self) -> tuple[str, ...]:
        """Names of the nq position coordinates, in file order."""
        return tuple(name for joint in self.independent for name in joint.position_names)

    @cached_property
    def velocity_names(self) -> tuple[str, ...]:
        """Names of the nv velocity coordinates, in file order."""
        return tuple(name for joint in self.independent for name in joint.velocity_names)

    @cached_property
    def position_slices(self) -> dict[str, slice]:
        """Where each independent joint's positions are in a configuration."""
        return self._slices([joint.type.nq for joint in self.independent])

    @cached_property
    def velocity_slices(self) -> dict[str, slice]:
        """Where each independent joint's velocities, and Jacobian columns, are."""
        return self._slices([joint.type.nv for joint in self.independent])

    def velocity_columns(self, joints: Iterable[Joint]) -> list[int]:
        """Return where the columns of some independent joints are, in their order."""
        return [i for joint in joints for i in range(self.nv)[self.velocity_slices[joint.name]]]

    def _slices(self, sizes: list[int]) -> dict[str, slice]:
        slices, start = {}, 0
        for joint, size in zip(self.independent, sizes, strict=True):
            slices[joint.name] = slice(start, start + size)
            start += size
        return slices

    @cached_property
    def nq(self) -> int:
        """Number of position coordinates."""
        return sum(joint.type.nq for joint in self.independent)

    @cached_property
    def nv(self) -> int:
        """Number of velocity coordinates: columns of a Jacobian over all joints."""
        return sum(joint.type.nv for joint in self.independent)

    @cached_property
    def largest_multiplier(self) -> float:
        """How much faster than its leader the fastest follower moves; 1 where none does."""
        return max((1.0, *(abs(law.multiplier) for law in self.followers.values())))

    # --- sizes -------------------------------------------------------------------------------------------------

    @cached_property
    def reach(self) -> float:
        """The longest path from the root to a link, stretched out, in metres: the length that tolerances scale with.

        Sum of the placements' lengths and, for sliding joints, of the larger end of a finite range.
        """
        longest = {self.root: 0.0}
        stack = [self.root]
        while stack:
            for joint in self.child_joints[stack.pop()]:
                longest[joint.child] = longest[joint.parent] + joint.origin.length + joint.slide
                stack.append(joint.child)
        return max(longest.values())

    def with_floating_base(self) -> Robot:
        """Return this robot with a free-flying joint between a new root link `universe` and its own root.

        Raises:
            UsageError: the file already uses one of the two names.
        """
        for name, known in ((WORLD_LINK, self.link_by_name), (FLOATING_BASE_JOINT, self.joint_by_name)):
            if name in known:
                raise UsageError(
                    f"a floating base needs the name {quote(name)}, which the file uses at line {known[name].line}",
                    remedy="rename it in the file",
                )
        base = Joint(FLOATING_BASE_JOINT, JointType.FLOATING, WORLD_LINK, self.root, line=0)
        return replace(self, links=(Link(WORLD_LINK, 0), *self.links), joints=(base, *self.joints), root=WORLD_LINK)
