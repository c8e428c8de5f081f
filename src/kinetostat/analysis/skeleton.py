"""The arm as a stick figure: where its links begin, and how its joints move there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinetostat.analysis.configuration import checked
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.errors import ConfigurationError
from kinetostat.urdf.description import Joint, JointType

__all__ = ["Pivot", "Skeleton", "skeleton"]

Kind = Literal["turning", "sliding", "screw", "planar", "floating"]

_SAME_POINT = 1e-9  # of the arm's size
_PARALLEL = 1e-4  # sine of an angle: files write a quarter turn as 1.5708, and several in a row


@dataclass(frozen=True)
class Pivot:
    """A joint of the stick figure that moves.

    Attributes:
        name: the joint's name.
        kind: turning, sliding, screw (both), planar (slides in a plane and turns about its normal), or floating.
        vertex: index of the vertex that it is at.
        axis: unit vector that it turns about or slides along, or the normal of its plane; in the observer's axes, (3,).
            Zero where it is floating.
    """

    name: str
    kind: Kind
    vertex: int
    axis: Array


@dataclass(frozen=True)
class Skeleton:
    """The origins of the links between an observer and a frame, joined by straight lines.

    Attributes:
        frame: the frame at the last vertex.
        relative_to: the observer, at the first vertex.
        points: the vertices in path order, in the observer's axes, no two neighbours coincident. (k, 3), m; k >= 1.
        pivots: the joints that move, in path order, each where its child link begins. Several may share a vertex.
    """

    frame: str
    relative_to: str
    points: Array
    pivots: tuple[Pivot, ...]

    @property
    def turning_axis(self) -> Array | None:
        """The direction of all axes of turning, a unit vector (3,); None where they differ, or nothing turns."""
        turning = [pivot.axis for pivot in self.pivots if pivot.kind in ("turning", "screw", "planar")]
        if not turning or any(pivot.kind == "floating" for pivot in self.pivots):
            return None
        parallel = all(np.linalg.norm(np.cross(turning[0], axis)) < _PARALLEL for axis in turning)
        return turning[0] if parallel else None

    @property
    def normal(self) -> Array | None:
        """The normal of the plane that a planar arm moves in, a unit vector (3,); None for any other arm.

        An arm is planar if all its axes of turning are parallel and all its slides are across them; one without
        turning joints, if its slides span a plane.
        """
        kinds = {pivot.kind for pivot in self.pivots}
        slides = [pivot.axis for pivot in self.pivots if pivot.kind == "sliding"]
        normal = _across(slides) if kinds == {"sliding"} else self.turning_axis
        if "screw" in kinds or normal is None:
            return None
        return normal if all(abs(normal @ axis) < _PARALLEL for axis in slides) else None


def skeleton(model: Model, frame: str, q: Array, relative_to: str | None = None) -> Skeleton:
    """Return the stick figure from an observer to a frame.

    Args:
        model: the robot.
        frame: the frame at its end, a link.
        q: one configuration, (nq,).
        relative_to: the observer, a link; default the root link.

    Raises:
        UnknownNameError: there is no such frame.
        ConfigurationError: q has another shape, or a number that is not finite.
    """
    robot = model.robot
    frame, observer, q = robot.frame(frame), robot.frame(relative_to or robot.root), checked(robot, q)
    if q.ndim != 1:
        raise ConfigurationError("a stick figure is of one configuration", remedy="take them one by one")
    path = robot.path(observer, frame)
    links = [observer, *(joint.child if way > 0 else joint.parent for joint, way in path)]
    placements = np.array([model.engine.placement(q, link, observer) for link in links])
    vertices, points = _merged(placements[:, :3, 3])
    pivots = list[Pivot]()
    for i, (joint, way) in enumerate(path):
        kind = _kind(joint)
        if kind is not None:
            child = i + 1 if way > 0 else i  # walked up, a joint's child comes before it
            pivots.append(Pivot(joint.name, kind, vertices[child], _axis(joint, placements[child])))
    return Skeleton(frame, observer, points, tuple(pivots))


def _merged(origins: Array) -> tuple[list[int], Array]:
    """Return for each origin (n, 3) the index of its vertex, and the vertices (k, 3)."""
    near = _SAME_POINT * float(np.ptp(origins, axis=0).max())
    vertices, points = [0], [origins[0]]
    for origin in origins[1:]:
        if np.linalg.norm(origin - points[-1]) > near:
            points.append(origin)
        vertices.append(len(points) - 1)
    return vertices, np.array(points)


def _kind(joint: Joint) -> Kind | None:
    if joint.type is JointType.SCREW and joint.pitch == 0:
        return "turning"
    return _KINDS.get(joint.type)


_KINDS: dict[JointType, Kind] = {
    JointType.REVOLUTE: "turning",
    JointType.CONTINUOUS: "turning",
    JointType.PRISMATIC: "sliding",
    JointType.SCREW: "screw",
    JointType.PLANAR: "planar",
    JointType.FLOATING: "floating",
}


def _axis(joint: Joint, child: Array) -> Array:
    """Return the axis in the observer's axes: a joint leaves its axis where it is, so its child (4, 4) knows it too."""
    if joint.type is JointType.FLOATING:
        return np.zeros(3)
    axis: Array = child[:3, :3] @ np.array(joint.axis)
    return axis


def _across(slides: list[Array]) -> Array | None:
    """Return the normal of the plane of the first two slides that are not parallel."""
    for axis in slides[1:]:
        normal = np.cross(slides[0], axis)
        size = float(np.linalg.norm(normal))
        if size > _PARALLEL:
            return np.asarray(normal / size)
    return None
