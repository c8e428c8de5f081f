"""Where to place a robot's base for a list of wanted poses: promised by a map of its capabilities, settled by IK."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from kinetostat.analysis.capability.capability_map import CapabilityMap
from kinetostat.analysis.capability.promising import PlacementMap, arriving, placement_map, promised_at
from kinetostat.analysis.capability.settling import Settler, based, path
from kinetostat.analysis.configuration import checked
from kinetostat.analysis.crosscheck import Certificate, combined
from kinetostat.analysis.inverse.ik import ik
from kinetostat.analysis.inverse.pose import Pose
from kinetostat.conventions import Array, Flags, Reference
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError
from kinetostat.screw import se3

__all__ = ["BasePlacement", "PlacementMap", "ProvedPlacement", "base_placement"]

_CANDIDATES = 64  # positions that are tried at first
_TRIED = 6  # starts of each pose there
_REFINED = 6  # of them that are made better
_PROVED = 8  # positions of the answer
_MORE = 12  # further starts of each pose from these
_ENDS = 12_288  # starts in all of a position of the answer, for poses that are many
_LOOKED_AT = 48  # poses, until the answer
_TRIES = 30  # starts more of a pose that none of them reached
_MOST_POSES = 10_000


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
        proved: the best positions, with what inverse kinematics says: by poses reached, then by the worst of them. None
            where no position is known that reaches any.
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

    @property
    def looked_at(self) -> int:
        """How many of the poses the search looked at before the answer, which is of all."""
        return min(len(self.poses), _LOOKED_AT)

    @property
    def why_none(self) -> str | None:
        """Why no position reaches any pose; None where one does."""
        if self.proved:
            return None
        (low, high), heights = self.capability.box, self.poses[:, 2, 3]
        said = f"no position of the base is known that reaches any of the {len(self.poses)} poses"
        linear = self.capability.task.linear
        counts = len(linear) == 3 or (2 in linear and not self.capability.kernel.local)
        if counts and (heights.min() > high[2] or heights.max() < low[2]):
            given = f"z = {heights.min():.4g} to {heights.max():.4g} m"
            return f"{said}: they are at {given}, the tool gets to z = {low[2]:.4g} to {high[2]:.4g} m"
        return f"{said}: of {_CANDIDATES} that were tried, none does"


def base_placement(
    model: Model,
    capability: CapabilityMap,
    wanted: Pose,
    q: Array,
    *,
    seed: int = 0,
    progress: Callable[[str, float], None] | None = None,
) -> BasePlacement:
    """Return where the base ought to stand so that the tool reaches wanted poses, and moves well there.

    The observer of the map stands on the world's plane z = 0, at any x and y and with any heading about z. The map
    judges every position of a grid with its voxel size, at headings 15 degrees apart: a pose counts if its voxel is
    reached, and if its z axis is among the voxel's directions of approach (with their neighbours, where the map has few
    configurations a voxel). From the most promising positions inverse kinematics inside joint limits is tried from
    several starts. The best of them go on in steps of x, y and heading, down to a sixty-fourth of a voxel, as long as
    that reaches more poses, or lets the worst of them have a larger smallest singular value by its best branch. Of the
    places that come out, the better is that which reaches more poses, then that whose worst pose is better. It is a
    search, not a proof that there is no better place. Of lists with more than 48 poses it looks at 48, evenly spread,
    until the end.

    Each pose's branch is the one that makes the joints travel least from pose to pose, of those that are no worse than
    the place's worst pose.

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
    tell = progress or _silent
    found = placement_map(capability, poses, oriented=oriented, progress=progress)
    places = _settled(capability, _candidates(found, poses), poses, seed, tell)
    final, proved, certificates = Settler(capability, poses, seed), list[ProvedPlacement](), list[Certificate]()
    for i, place in enumerate(places):
        tell(f"inverse kinematics of position {i + 1} of {len(places)}", i / len(places))
        one, certificate = _proved(model, final, Pose(poses, oriented), place, q, seed)
        proved.append(one)
        certificates.append(certificate)
    ranked = sorted((one for one in proved if one.count), key=lambda one: (-one.count, -one.worst))
    return BasePlacement(capability, poses, oriented, found, tuple(ranked), combined(certificates))


def _silent(what: str, share: float) -> None:
    """Tell nobody."""


def _candidates(found: PlacementMap, poses: Array) -> Array:
    """Return places to be tried, (m, 3): most poses, then most dexterity, then nearest to the middle; none beside."""
    middle = poses[:, :2, 3].mean(axis=0)
    away = np.hypot(found.x[:, None] - middle[0], found.y - middle[1])
    order = np.lexsort((away.ravel(), -found.dexterity.ravel(), -found.promised.ravel()))
    free, places = np.ones(found.promised.shape, dtype=bool), list[tuple[float, float, float]]()
    for i, j in zip(*np.unravel_index(order, found.promised.shape), strict=True):
        if free[i, j]:
            places.append((float(found.x[i]), float(found.y[j]), float(found.yaw[i, j])))
            free[max(i - 1, 0) : i + 2, max(j - 1, 0) : j + 2] = False
        if len(places) == _CANDIDATES:
            break
    return np.array(places)


def _settled(
    capability: CapabilityMap, places: Array, poses: Array, seed: int, tell: Callable[[str, float], None]
) -> Array:
    """Return the places that come out, the best first, (m, 3): refined ones, and the best of the others."""
    some = poses[np.unique(np.linspace(0, len(poses) - 1, _LOOKED_AT).round().astype(int))]
    settler, size = Settler(capability, some, seed), capability.grid.size
    tell(f"inverse kinematics of {len(places)} positions", 0.0)
    tried = settler.from_map(places, _TRIED)
    tried = tried.part(tried.order)
    first = settler.again(tried.part(slice(_REFINED)), _MORE)
    refined = settler.refined(first, size, lambda share: tell("better positions beside the best", share))
    refined = refined.part(refined.order)
    chosen = list[Array]()
    for place in [*refined.places, *tried.places[_REFINED:]]:
        if all(math.hypot(*(place - other)[:2]) >= size for other in chosen):
            chosen.append(place)
    return np.array(chosen[:_PROVED])


def _proved(
    model: Model, settler: Settler, wanted: Pose, place: Array, q: Array, seed: int
) -> tuple[ProvedPlacement, Certificate]:
    """Return what inverse kinematics says of a place of the base."""
    capability, joints = settler.capability, settler.capability.coordinates
    tries = max(2, min(_MORE, _ENDS // len(wanted.matrix)))
    found = settler.again(settler.from_map(place[None], tries), tries)
    starts = joints.configuration(path(joints, found.q[0], found.values[0], settler.aim.units), q)
    goals = replace(wanted, matrix=se3.inverse(based(place)) @ wanted.matrix)
    solved = ik(
        model,
        capability.velocity.of,
        goals,
        starts,
        axes=capability.task.row_names,
        reference=Reference.LOCAL if capability.kernel.local else Reference.ALIGNED,
        relative_to=capability.velocity.relative_to,
        point=capability.velocity.point,
        tries=_TRIES,
        seed=seed,
    )
    reached = np.asarray(solved.converged & solved.inside_limits)
    smallest = np.where(reached, _smallest(capability, solved.q), np.nan)
    x, y, yaw = (float(number) for number in place)
    yaw = math.remainder(yaw, 2 * math.pi)
    arrive = arriving(capability, wanted.oriented)
    count, total = promised_at(capability, wanted.matrix, np.array([x]), np.array([y]), yaw, arrive)
    promised, dexterity = int(count[0, 0]), float(total[0, 0]) / max(int(count[0, 0]), 1)
    return ProvedPlacement(x, y, yaw, promised, dexterity, reached, solved.q, smallest), solved.certificate


def _smallest(capability: CapabilityMap, q: Array) -> Array:
    """Return the smallest singular values at configurations of the whole robot, (p, nq) -> (p,)."""
    chain = q[:, list(capability.coordinates.indices)]
    values: Array = capability.kernel.definition(chain)["singular_values"][:, -1]
    return values
