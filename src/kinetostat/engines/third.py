"""The third, foreign reader: yourdfpy's parser and forward kinematics. It places links, and knows masses; no more.

The only module that imports yourdfpy. It is given the bytes that our reader has accepted (so no DOCTYPE, no archive),
from memory, and never a mesh: geometry is taken out before it builds anything.

What it is known to read differently (0.0.60) is not the model's fault. Links whose placement depends on it are left
out of `frames`, and `notes` says why: slides along an axis that has not length 1, `quat_xyzw`, screw joints, followers
of followers, followers of joints that do not exist, any follower beside a planar or floating joint. Planar and
floating joints do not move in it: they are held where `held` says.
"""

from __future__ import annotations

import contextlib
import io
import logging
import warnings
from collections import defaultdict
from collections.abc import Iterator
from functools import cached_property
from typing import Any

import numpy as np

from kinetostat.conventions import Array
from kinetostat.errors import EngineError, cut, quote
from kinetostat.urdf.description import Joint, JointType, Robot

__all__ = ["ThirdReader", "warm_up"]

MOST_LINKS = 4000  # beyond them it takes seconds: some of its look-ups go through all links
_UNIT = 1e-12
_SEVERAL = (JointType.PLANAR, JointType.FLOATING)
_KNOWN = (JointType.FIXED, JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC, *_SEVERAL)


class ThirdReader:
    """yourdfpy on one file.

    Attributes:
        name: as disagreements name it.
        frames: the links that it can be asked about, in file order.
        notes: what is left out and why.

    Raises:
        EngineError: it cannot read the file, or not as it stands; the message says why.
    """

    name = "yourdfpy"

    def __init__(self, data: bytes, robot: Robot) -> None:
        if len(robot.links) > MOST_LINKS:
            raise EngineError(f"more than {MOST_LINKS} links: it would take too long")
        self._robot = robot
        with _watched("reads") as complaints:
            self._urdf = _loaded(data)
        if any(record.levelno >= logging.ERROR for record in complaints):
            raise EngineError("it reads the file in recovery mode, and may lose part of it")
        read = {link.name for link in self._urdf.robot.links}
        if read != set(robot.link_by_name) or self._urdf.base_link != robot.root:
            raise EngineError("it does not find the same links in the file")
        limits = self._limits()
        below = _below(robot, limits)
        self.frames = tuple(name for name in robot.link_by_name if name not in below)
        self.notes = tuple(_note(reason, joints) for reason, joints in _by_reason(limits).items())

    def _limits(self) -> dict[str, str]:
        """Return the joints that it is known to read differently, and why."""
        limits, joints = dict[str, str](), self._robot.joint_by_name
        several = any(joint.type in _SEVERAL for joint in joints.values())
        foreign = self._urdf.joint_map
        for name, joint in joints.items():
            mimic = getattr(foreign.get(name), "mimic", None)
            if name not in foreign or joint.type not in _KNOWN:
                limits[name] = "it knows no screw joints"
            elif joint.origin.quaternion_xyzw is not None:
                limits[name] = "it ignores quat_xyzw"
            elif joint.type is JointType.PRISMATIC and abs(np.linalg.norm(foreign[name].axis) - 1) > _UNIT:
                limits[name] = "it slides further along an axis that has not length 1"
            elif joint.mimic is None and mimic is not None and joint.type is not JointType.FIXED:
                limits[name] = "it holds followers of joints that do not exist"
            elif joint.mimic is not None and joints[joint.mimic.joint].mimic is not None:
                limits[name] = "it does not follow followers"
            elif joint.mimic is not None and several:
                limits[name] = "it mixes up followers beside planar or floating joints"
        return limits

    @cached_property
    def held(self) -> tuple[Joint, ...]:
        """The joints that do not move in it: they have to be at zero in what it is compared with."""
        return tuple(joint for joint in self._robot.independent if joint.type in _SEVERAL)

    def settled(self, q: Array) -> Array:
        """Return configurations with the held joints at zero. (..., nq) -> (..., nq)."""
        settled = np.array(q, dtype=np.float64)
        for joint in self.held:
            part = settled[..., self._robot.position_slices[joint.name]]
            part[...] = 0.0
            if joint.type is JointType.FLOATING:
                part[..., -1] = 1.0
        return settled

    def placements(self, q: Array) -> Array:
        """Return where it puts its `frames`, from the root: (..., nq) -> (..., k, 4, 4).

        Its own matrix for each joint, multiplied along the joints that it has read. Held joints do not move.

        Raises:
            EngineError: it fails.
        """
        q = np.asarray(q, dtype=np.float64)
        flat = q.reshape(int(np.prod(q.shape[:-1])), q.shape[-1])
        found = np.empty((len(flat), len(self.frames), 4, 4))
        for i, single in enumerate(flat):
            with _watched("places links"):
                placed = self._placed(single)
            found[i] = [placed[frame] for frame in self.frames]
        return found.reshape(*q.shape[:-1], len(self.frames), 4, 4)

    def _placed(self, q: Array) -> dict[str, Array]:
        settable = set(self._urdf.actuated_joint_names)
        self._urdf.update_cfg(
            {
                joint.name: float(q[self._robot.position_slices[joint.name].start])
                for joint in self._robot.independent
                if joint.type.nq == 1 and joint.name in settable
            }
        )
        placed = {self._urdf.base_link: np.eye(4)}
        for parent, child in self._edges:
            placed[child] = placed[parent] @ self._urdf.get_transform(child, parent)
        return placed

    @cached_property
    def _edges(self) -> list[tuple[str, str]]:
        """Parent and child of each joint that it has read and that `frames` need, outwards."""
        below, wanted = defaultdict[str, list[str]](list), set(self.frames)
        for joint in self._urdf.robot.joints:
            if joint.child in wanted:
                below[joint.parent].append(joint.child)
        edges, stack = list[tuple[str, str]](), [self._urdf.base_link]
        while stack:
            parent = stack.pop()
            edges += [(parent, child) for child in below[parent]]
            stack += below[parent]
        return edges

    def weights(self) -> dict[str, tuple[float, Array]]:
        """Return mass in kg and centre of mass in the link's coordinates (3,) of each link as it has read them.

        Links without an inertial are missing, and so are those that our reader does not count.
        """
        counted = {link.name for link in self._robot.links if link.inertial is not None}
        found = dict[str, tuple[float, Array]]()
        for link in self._urdf.robot.links:
            inertial = link.inertial
            if link.name in counted and inertial is not None and inertial.mass is not None:
                origin = np.eye(4) if inertial.origin is None else inertial.origin
                found[link.name] = float(inertial.mass), np.array(origin[:3, 3])
        return found


def warm_up() -> None:
    """Import yourdfpy, which takes half a second, before a robot waits for it."""
    with contextlib.suppress(EngineError), _watched("loads"):
        _loaded(b'<robot name="none"><link name="a"/></robot>')


def _loaded(data: bytes) -> Any:
    """Return yourdfpy's robot, built without any geometry."""
    from yourdfpy import URDF

    # Geometry is parsed, but nothing is made of it: not even boxes, of which a hostile file may have a great many.
    bare = URDF.load(io.BytesIO(data), build_scene_graph=False, load_meshes=False, filename_handler=_nowhere)
    for link in bare.robot.links:
        link.visuals.clear()
        link.collisions.clear()
    return URDF(robot=bare.robot, build_scene_graph=True, load_meshes=False, filename_handler=_nowhere)


def _nowhere(_name: str) -> str:
    return ""


@contextlib.contextmanager
def _watched(doing: str) -> Iterator[list[logging.LogRecord]]:
    """Keep what it logs and warns of from the terminal, and turn whatever it raises into our error.

    Raises:
        EngineError: it fails, in any way.
    """
    complaints = _Kept()
    logger = logging.getLogger("yourdfpy")
    propagate, level = logger.propagate, logger.level
    logger.addHandler(complaints)
    logger.propagate = False
    logger.setLevel(logging.ERROR)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield complaints.records
    except ModuleNotFoundError as error:
        raise EngineError("it is not installed", remedy="pip install yourdfpy") from error
    except Exception as error:
        said = cut(" ".join(str(error).split()), 120)
        raise EngineError(f"it fails as it {doing}: {type(error).__name__}{': ' if said else ''}{said}") from error
    finally:
        logger.removeHandler(complaints)
        logger.propagate = propagate
        logger.setLevel(level)


class _Kept(logging.Handler):
    """Keeps what is logged."""

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self.records = list[logging.LogRecord]()

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a record."""
        self.records.append(record)


def _below(robot: Robot, limits: dict[str, str]) -> set[str]:
    """Return the links whose placement depends on one of the joints, and those that only a floating base has."""
    below, stack = set[str](), [robot.joint_by_name[name].child for name in limits]
    while stack:
        link = stack.pop()
        if link not in below:
            below.add(link)
            stack += [joint.child for joint in robot.child_joints[link]]
    return below


def _by_reason(limits: dict[str, str]) -> dict[str, list[str]]:
    grouped = defaultdict[str, list[str]](list)
    for name, reason in limits.items():
        grouped[reason].append(name)
    return grouped


def _note(reason: str, joints: list[str]) -> str:
    named = ", ".join(quote(name, 40) for name in joints[:3]) + (f" and {len(joints) - 3} more" if joints[3:] else "")
    return f"{reason}: links beyond {named} are left out"
