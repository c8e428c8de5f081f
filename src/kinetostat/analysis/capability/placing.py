"""Where to place a robot's base for a list of wanted poses: ranked by a map of its capabilities, proved by IK."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kinetostat.analysis.capability.capability_map import CapabilityMap
from kinetostat.analysis.capability.directions import mask
from kinetostat.analysis.configuration import checked
from kinetostat.analysis.crosscheck import Certificate, combined
from kinetostat.analysis.inverse.ik import ik
from kinetostat.analysis.inverse.pose import Pose
from kinetostat.conventions import Array, Flags
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError
from kinetostat.screw import se3, so3

__all__ = ["BasePlacement", "PlacementMap", "ProvedPlacement", "base_placement", "placement_map"]

HEADINGS = 24  # of the base, 15 degrees apart
_PROVED = 8  # positions whose poses are solved for
_TRIES = 30  # starts of each pose's solution at most: what the map says may be reached seldom needs more than one
_MOST_POSES = 10_000
_DIGITS = 12  # decimal places of positions in m: 0 where rounding would leave 1e-16
_MOST_LOOKUPS = 1e10  # some minutes


@dataclass(frozen=True, repr=False)
class PlacementMap:
    """What a map of capabilities says of every place of the base, at the best of its headings.

    Attributes:
        x: positions of the base, (a,), m.
        y: (b,), m.
        yaw: its heading there, (a, b), rad.
        promised: how many of the poses are in voxels that the tool reaches, from the wanted direction, (a, b).
        dexterity: the mean over them of the voxel's best smallest singular value, (a, b); 0 where there is none.
    """

    x: Array
    y: Array
    yaw: Array
    promised: NDArray[np.int64]
    dexterity: Array

    def __repr__(self) -> str:
        return f"<PlacementMap of {self.yaw.size} positions, at most {int(self.promised.max())} poses>"


@dataclass(frozen=True, repr=False)
class ProvedPlacement:
    """One place of the base, with a configuration for each pose that is reached from there.

    Attributes:
        x: position of the base in the world, m.
        y: m.
        yaw: heading of the base, rad.
        promised: how many of the poses the map says to be reached.
        dexterity: the mean over them of the voxel's best smallest singular value.
        reached: whether a configuration inside limits was found for each pose, (p,).
        q: configurations of the whole robot, (p, nq); the nearest that was found where a pose is not reached.
        smallest: the smallest singular value there, (p,); NaN where the pose is not reached.
    """

    x: float
    y: float
    yaw: float
    promised: int
    dexterity: float
    reached: Flags
    q: Array
    smallest: Array

    def __repr__(self) -> str:
        return f"<ProvedPlacement at ({self.x:.4g}, {self.y:.4g}) m: {self.count} of {len(self.reached)} poses>"

    @property
    def count(self) -> int:
        """How many poses are reached."""
        return int(np.sum(self.reached))

    @property
    def worst(self) -> float:
        """The smallest singular value of the worst pose that is reached, 0 where none is."""
        return float(np.min(self.smallest[self.reached])) if self.count else 0.0


@dataclass(frozen=True, repr=False)
class BasePlacement:
    """Base positions for a list of wanted poses, the best first.

    Attributes:
        capability: the map that ranked them.
        poses: the wanted poses in the world, (p, 4, 4), m.
        oriented: whether directions of approach counted.
        map: what the map says of every position.
        proved: the best positions, with what inverse kinematics says: by poses reached, then by the worst of them.
        certificate: what the two engines say of the tool's placement at all solutions.
    """

    capability: CapabilityMap
    poses: Array
    oriented: bool
    map: PlacementMap
    proved: tuple[ProvedPlacement, ...]
    certificate: Certificate

    def __repr__(self) -> str:
        best = max((one.count for one in self.proved), default=0)
        return f"<BasePlacement for {len(self.poses)} poses: {best} reached from the best of {len(self.proved)}>"


def base_placement(
    model: Model,
    capability: CapabilityMap,
    wanted: Pose,
    q: Array,
    *,
    seed: int = 0,
    progress: Callable[[str, float], None] | None = None,
) -> BasePlacement:
    """Return where the base ought to stand so that the tool reaches wanted poses.

    The observer of the map stands on the world's plane z = 0, at any x and y and with any heading about z. Every
    position of a grid with the map's voxel size, at headings 15 degrees apart, is judged by the map: a pose counts if
    its voxel is reached, and if its z axis is among the voxel's directions of approach. The eight positions with the
    most poses, then with the largest mean of their voxels' best smallest singular values, are proved: each pose is
    solved by inverse kinematics inside joint limits, from the map's own configuration on.

    N. Vahrenkamp, T. Asfour and R. Dillmann, "Robot placement based on reachability inversion", ICRA 2013, invert the
    map once; here positions are few enough (a plane) to ask it of each.

    Args:
        model: the robot of the map.
        capability: the map; its task's rows count for inverse kinematics too.
        wanted: poses (p, 4, 4) in the world.
        q: a configuration of the whole robot, (nq,): where joints are that the map does not move.
        seed: of inverse kinematics' starts.
        progress: told what is being done, and which share of it is.

    Raises:
        UsageError: no pose, or too many; a map too fine for them; a task that turns, and poses without orientation.
        ConfigurationError: q has another shape, or a number that is not finite.
    """
    q, poses = checked(model.robot, q), wanted.matrix.reshape(-1, 4, 4)
    if not 1 <= len(poses) <= _MOST_POSES:
        raise UsageError(f"between 1 and {_MOST_POSES} poses, not {len(poses)}")
    if capability.task.angular and not wanted.oriented:
        raise UsageError("poses have no orientation, but turns count", remedy="--axes xyz takes positions")
    oriented = bool(capability.task.angular)
    found = placement_map(capability, poses, oriented=oriented, progress=progress)
    proved, certificates = list[ProvedPlacement](), list[Certificate]()
    places = _best(found, poses)
    for i, place in enumerate(places):
        if progress is not None:
            progress(f"inverse kinematics of position {i + 1} of {len(places)}", i / len(places))
        one, certificate = _proved(model, capability, Pose(poses, oriented), found, place, q, seed)
        proved.append(one)
        certificates.append(certificate)
    proved.sort(key=lambda one: (-one.count, -one.worst))
    return BasePlacement(capability, poses, oriented, found, tuple(proved), combined(certificates))


def placement_map(
    capability: CapabilityMap,
    poses: Array,
    *,
    oriented: bool,
    progress: Callable[[str, float], None] | None = None,
) -> PlacementMap:
    """Return what the map says of every position of the base; see `base_placement`. (p, 4, 4).

    Raises:
        UsageError: there would be too many to look up.
    """
    x, y = _positions(capability, poses)
    if len(x) * len(y) * HEADINGS * len(poses) > _MOST_LOOKUPS:
        message = f"{len(x)} x {len(y)} base positions at {HEADINGS} headings are too many for {len(poses)} poses"
        raise UsageError(message, remedy="give a larger --voxel, or fewer poses")
    shape = len(x), len(y)
    promised, dexterity, yaw = np.zeros(shape, dtype=np.int64), np.zeros(shape), np.zeros(shape)
    for i, heading in enumerate(_headings()):
        if progress is not None:
            progress(f"base headings, {i + 1} of {HEADINGS}", i / HEADINGS)
        count, total = _promised(capability, poses, x, y, heading, oriented)
        mean = np.divide(total, count, out=np.zeros(shape), where=count > 0)
        better = (count > promised) | ((count == promised) & (mean > dexterity))
        promised, dexterity, yaw = (
            np.where(better, new, old) for new, old in ((count, promised), (mean, dexterity), (heading, yaw))
        )
    return PlacementMap(x, y, yaw, promised, dexterity)


def _headings() -> Array:
    """Return headings from 0 on, near ones first: of those that are as good, the first counts."""
    steps = np.arange(HEADINGS)
    turns: Array = 2 * math.pi / HEADINGS * np.where(steps > HEADINGS // 2, steps - HEADINGS, steps)
    return turns[np.argsort(np.abs(turns), kind="stable")]


def _positions(capability: CapabilityMap, poses: Array) -> tuple[Array, Array]:
    """Return x and y of positions from which something may be reached, one in the middle of the poses."""
    grid = capability.grid
    corners = np.abs(np.stack([grid.origin, grid.origin + grid.size * np.array(grid.shape)]))[:, :2]
    reach = float(np.linalg.norm(corners.max(axis=0)))
    places = poses[:, :2, 3]
    middle, low, high = places.mean(axis=0), places.min(axis=0) - reach, places.max(axis=0) + reach
    if not np.all((high - low) / grid.size < math.sqrt(_MOST_LOOKUPS)):
        raise UsageError("the poses are too far apart for this size of voxel", remedy="check their unit, it is m")
    first, last = np.ceil((low - middle) / grid.size), np.floor((high - middle) / grid.size)
    x, y = (np.round(middle[i] + grid.size * np.arange(first[i], last[i] + 1), _DIGITS) + 0.0 for i in range(2))
    return x, y


def _promised(
    capability: CapabilityMap, poses: Array, x: Array, y: Array, heading: float, oriented: bool
) -> tuple[NDArray[np.int64], Array]:
    """Return how many poses the map has for every position, and the sum of best smallest singular values. (a, b)."""
    count, total = np.zeros((len(x), len(y)), dtype=np.int64), np.zeros((len(x), len(y)))
    best, directions = capability.best_singular_value.ravel(), capability.directions.ravel()
    back = so3.about(2, np.array(-heading))
    # In the base's axes a pose is at back (p - (x, y, 0)): a sum of what x gives and what y gives.
    from_x, from_y = x[:, None, None] * back[:, 0], y[None, :, None] * back[:, 1]
    for pose in poses:
        at = capability.grid.index(back @ pose[:3, 3] - from_x - from_y)
        there = at >= 0
        if oriented:
            there &= (directions[at] & mask(back @ pose[:3, 2])) != 0
        else:
            there &= directions[at] != 0
        count += there
        total += np.where(there, best[at], 0.0)
    return count, total


def _best(found: PlacementMap, poses: Array) -> list[tuple[int, int]]:
    """Return the positions to be proved: most poses, then most dexterity, then nearest to the middle of the poses."""
    middle = poses[:, :2, 3].mean(axis=0)
    away = np.hypot(found.x[:, None] - middle[0], found.y - middle[1])
    order = np.lexsort((away.ravel(), -found.dexterity.ravel(), -found.promised.ravel()))[:_PROVED]
    places = [(int(i), int(j)) for i, j in zip(*np.unravel_index(order, found.promised.shape), strict=True)]
    return [place for place in places if found.promised[place]] or places[:1]


def _proved(
    model: Model,
    capability: CapabilityMap,
    wanted: Pose,
    found: PlacementMap,
    place: tuple[int, int],
    q: Array,
    seed: int,
) -> tuple[ProvedPlacement, Certificate]:
    """Return what inverse kinematics says of a position of the base."""
    x, y, yaw = float(found.x[place[0]]), float(found.y[place[1]]), float(found.yaw[place])
    base = se3.placement(so3.about(2, np.array(yaw)), np.array([x, y, 0.0]))
    goals = se3.inverse(base) @ wanted.matrix
    starts = capability.configurations(capability.grid.index(goals[:, :3, 3]), q)
    solved = ik(
        model,
        capability.velocity.of,
        replace(wanted, matrix=goals),
        starts,
        axes=capability.task.row_names,
        relative_to=capability.velocity.relative_to,
        point=capability.velocity.point,
        tries=_TRIES,
        seed=seed,
    )
    reached = np.asarray(solved.converged & solved.inside_limits)
    smallest = np.where(reached, _smallest(capability, solved.q), np.nan)
    promised, dexterity = int(found.promised[place]), float(found.dexterity[place])
    return ProvedPlacement(x, y, yaw, promised, dexterity, reached, solved.q, smallest), solved.certificate


def _smallest(capability: CapabilityMap, q: Array) -> Array:
    """Return the smallest singular values at configurations of the whole robot, (p, nq) -> (p,)."""
    chain = q[:, list(capability.coordinates.indices)]
    values: Array = capability.kernel.definition(chain)["singular_values"][:, -1]
    return values
