"""What pictures of singularities show: the smallest singular value over two joints, and curves in the workspace."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.singular.find import Family, SingularFamilies
from kinetostat.analysis.singular.mechanism import Mechanism
from kinetostat.conventions import Array, quarter_turns
from kinetostat.errors import UsageError, printable, unknown_name

__all__ = ["Curve", "Mark", "Slice", "Workspace", "is_planar", "positions_in_words", "slice_over", "workspace"]

_CLOUD = 4000  # configurations whose tool positions show where the arm gets
_NOTHING = 1e-12  # singular value that is rounding
_FLAT = 1e-6  # relative: what is smaller does not leave a plane


@dataclass(frozen=True)
class Mark:
    """Where a family meets a slice: a line x = value, a line y = value, or a point.

    Attributes:
        label: the family's condition, such as "joint3 = 0".
        x: the value on the first axis, or None for a horizontal line.
        y: the value on the second axis, or None for a vertical line.
        inside: whether it is inside the joint limits.
    """

    label: str
    x: float | None
    y: float | None
    inside: bool


@dataclass(frozen=True)
class Slice:
    """The smallest singular value over the positions of two joints, all others held.

    Attributes:
        joints: names of the two joints, first axis first.
        units: "rad" or "m" for each.
        x: positions of the first, (a,).
        y: positions of the second, (b,).
        smallest: smallest singular value of the length-scaled Jacobian, (b, a).
        signed: its determinant where it is square, (b, a), zero on singular curves; None where it is not.
        limits: lower and upper limit of each, infinite where there is none.
        marks: the families with one or two fixed joints.
        at: positions of the two joints in the configuration in which the others are held.
    """

    joints: tuple[str, str]
    units: tuple[str, str]
    x: Array
    y: Array
    smallest: Array
    signed: Array | None
    limits: tuple[tuple[float, float], tuple[float, float]]
    marks: tuple[Mark, ...]
    at: tuple[float, float]


@dataclass(frozen=True)
class Curve:
    """A curve of the tool in the plane of a planar arm.

    Attributes:
        label: what it is, such as "joint2 = 0".
        points: (k, 2), m.
        kind: "singular" or "limit" (a joint at one of its limits).
    """

    label: str
    points: Array
    kind: str


@dataclass(frozen=True)
class Workspace:
    """Where the tool of a planar arm gets, and its singular curves.

    Attributes:
        axes: names of the two directions of the plane, such as ("x", "y"), in the axes of `observer`.
        observer: the observer's frame.
        reached: tool positions at random configurations inside limits, (N, 2), m.
        smallest: smallest singular value there, (N,).
        curves: where the arm is singular with the joints inside limits, and where a joint is at a limit.
        unlimited: the singular curves when limits are left out of account.
    """

    axes: tuple[str, str]
    observer: str
    reached: Array
    smallest: Array
    curves: tuple[Curve, ...]
    unlimited: tuple[Curve, ...]


def slice_over(
    result: SingularFamilies,
    joints: Sequence[str] | None = None,
    q: Array | None = None,
    *,
    degrees: bool = False,
    points: int = 181,
) -> Slice:
    """Return the smallest singular value over two joints of an arm.

    Args:
        result: the arm and its families.
        joints: names of two of its coordinates; default the two that conditions inside limits are most often about.
        q: coordinates (n,) in which the others are held; default the middle of their limits.
        degrees: whether labels tell angles in degrees.
        points: how many positions of each joint.

    Raises:
        UsageError: fewer than two joints, or two that are one.
        UnknownNameError: a joint is not one of the arm's.
    """
    arm = result.mechanism
    first, second = _indices(arm, joints) if joints else _telling(result)
    lower, upper = arm.spans
    rest = (arm.limits[0] + arm.limits[1]) / 2 if q is None else np.asarray(q, dtype=np.float64)
    x, y = np.linspace(lower[first], upper[first], points), np.linspace(lower[second], upper[second], points)
    grid = np.broadcast_to(rest, (points, points, len(rest))).copy()
    grid[..., first], grid[..., second] = x[None, :], y[:, None]
    matrix = arm.jacobian(grid)
    found = arm.smallest(grid)
    values = np.where(found < _NOTHING, 0.0, found)
    square = matrix.shape[-1] == matrix.shape[-2] == arm.generic_rank
    stated = [(float(ends[0]), float(ends[1])) for ends in np.stack(arm.stated_limits, -1)]
    return Slice(
        (arm.names[first], arm.names[second]),
        ("rad" if arm.turning[first] else "m", "rad" if arm.turning[second] else "m"),
        x,
        y,
        values,
        np.linalg.det(matrix) if square else None,
        (stated[first], stated[second]),
        tuple(mark for family in result.families for mark in _marks(arm, family, first, second, degrees)),
        (float(rest[first]), float(rest[second])),
    )


def _indices(arm: Mechanism, joints: Sequence[str]) -> tuple[int, int]:
    unknown = next((name for name in joints if name not in arm.names), None)
    if unknown is not None:
        raise unknown_name("joint of the arm", unknown, arm.names)
    if len(joints) != 2 or joints[0] == joints[1]:
        raise UsageError("a slice is over two joints", remedy="--joints J1,J2")
    return arm.names.index(joints[0]), arm.names.index(joints[1])


def _telling(result: SingularFamilies) -> tuple[int, int]:
    """Return the two coordinates that most conditions are about, those inside limits counting first."""
    arm = result.mechanism
    if len(arm.names) < 2:
        raise UsageError("there are not two joints to draw over", remedy="leave out --plot")
    weight = dict.fromkeys(range(len(arm.names)), 0)
    for family in result.families:
        for name in family.support:
            weight[arm.names.index(name)] += 100 if family.inside_limits else 1
    # Of joints that no condition is about, the first is the last to show: it turns the arm as a whole.
    first, second = sorted(weight, key=lambda i: (-weight[i], i == 0, i))[:2]
    return min(first, second), max(first, second)


def _marks(arm: Mechanism, family: Family, first: int, second: int, degrees: bool) -> list[Mark]:
    """Return where a family with a position of its own for one or both joints meets the slice."""
    if family.implicit or not set(family.positions) <= {arm.names[first], arm.names[second]}:
        return []
    x, y = (family.positions.get(arm.names[i]) for i in (first, second))
    return [Mark(positions_in_words(arm, family.positions, degrees), x, y, family.inside_limits)]


def positions_in_words(arm: Coordinates, positions: Mapping[str, float], degrees: bool = False) -> str:
    """Return positions of coordinates, in rad and m, in words: joint2 = pi/2."""
    words = []
    for name, value in positions.items():
        if not arm.turning[arm.names.index(name)]:
            shown = f"{value:.4g} m"
        elif degrees:
            shown = f"{math.degrees(value):.4g} deg"
        else:
            shown = quarter_turns(value) or f"{value:.4g}"
        words.append(f"{printable(name)} = {shown}")
    return ", ".join(words)


def is_planar(arm: Mechanism) -> bool:
    """Return whether an arm moves its tool in a plane whatever its joints do, with two joints or more."""
    return len(arm.names) > 1 and _plane(arm) is not None


def _plane(arm: Mechanism) -> tuple[Array, tuple[str, str]] | None:
    """Return unit vectors along the plane of an arm, (3, 2), and their names; None if it has no plane."""
    samples = arm.chain.jacobian(arm.draw(np.random.default_rng(0), (6,)))
    moves = np.concatenate([np.swapaxes(samples[:, :3], -1, -2).reshape(-1, 3) / arm.length])
    turns = np.swapaxes(samples[:, 3:], -1, -2).reshape(-1, 3)
    _, sizes, across = np.linalg.svd(moves)
    if sizes[1] < _FLAT or sizes[2] > _FLAT or float(np.max(np.abs(turns @ across[:2].T))) > _FLAT:
        return None
    normal = across[2]
    along = int(np.argmax(np.abs(normal)))
    if abs(normal[along]) > 1 - _FLAT:
        first, second = [(1, 2), (0, 2), (0, 1)][along]
        return np.eye(3)[:, [first, second]], ("xyz"[first], "xyz"[second])
    return across[:2].T, ("u", "v")


def workspace(result: SingularFamilies, *, degrees: bool = False, points: int = 361) -> Workspace:
    """Return where the tool of a planar arm gets, and the curves that bound and divide it.

    Curves are drawn where conditions leave one joint free: a 2R arm's singular circles, and with limits its arcs.

    Raises:
        UsageError: the arm does not move in a plane.
    """
    arm = result.mechanism
    found = _plane(arm) if len(arm.names) > 1 else None
    if found is None:
        raise UsageError("the arm does not move in one plane", remedy="--joints J1,J2 draws a slice instead")
    plane, names = found
    q = arm.draw(np.random.default_rng(0), (_CLOUD,), limited=True)
    inside, unlimited = list[Curve](), list[Curve]()
    for family in result.families:
        if family.implicit or len(family.positions) != len(arm.names) - 1:
            continue
        held = {arm.names.index(name): value for name, value in family.positions.items()}
        label = positions_in_words(arm, family.positions, degrees)
        whole = _swept(arm, held, arm.spans, plane, points)
        within = _swept(arm, held, arm.limits, plane, points) if family.inside_limits else None
        if within is not None:
            inside.append(Curve(label, within, "singular"))
        if within is None or not np.allclose(np.ptp(within, axis=0), np.ptp(whole, axis=0)):
            unlimited.append(Curve(label, whole, "singular"))
    return Workspace(
        names,
        arm.velocity.relative_to,
        arm.tool(q) @ plane,
        arm.smallest(q),
        (*inside, *_limit_curves(arm, plane, points, degrees)),
        tuple(unlimited),
    )


def _limit_curves(arm: Mechanism, plane: Array, points: int, degrees: bool) -> list[Curve]:
    """Return where the tool of an arm of two joints gets with one of them at a limit."""
    if len(arm.names) != 2:
        return []
    curves = []
    for i, name in enumerate(arm.names):
        for end in (ends[i] for ends in arm.stated_limits):
            if np.isfinite(end):
                swept = _swept(arm, {i: float(end)}, arm.limits, plane, points)
                curves.append(Curve(positions_in_words(arm, {name: float(end)}, degrees), swept, "limit"))
    return curves


def _swept(arm: Mechanism, held: dict[int, float], ends: tuple[Array, Array], plane: Array, points: int) -> Array:
    """Return the tool's curve in the plane, (points, 2), when the joint that is not held goes through its range."""
    free = next(i for i in range(len(arm.names)) if i not in held)
    q = np.zeros((points, len(arm.names)))
    for i, value in held.items():
        q[:, i] = value
    q[:, free] = np.linspace(ends[0][free], ends[1][free], points)
    curve: Array = arm.tool(q) @ plane
    return curve
