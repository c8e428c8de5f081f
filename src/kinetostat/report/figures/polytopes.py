"""The figure of an arm with its force polytope: every force that the effort limits allow."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.capacity import ForcePolytope
from kinetostat.analysis.configuration import Configuration
from kinetostat.analysis.skeleton import Skeleton, skeleton
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.report.figures.ellipsoids import Shape, draw_ellipsoid, number
from kinetostat.report.figures.sheet import (
    BLUE,
    GREY,
    INK,
    PURPLE,
    SKY,
    VERMILION,
    Entry,
    house_style,
    named,
    rounded,
    sheet,
    to_scale,
)
from kinetostat.report.figures.symbols import draw_symbols, symbol_entries
from kinetostat.report.figures.views import NEGLIGIBLE, in_words, scaled, views_of
from kinetostat.report.view import configuration_note

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["polytope_figure"]

_FARTHEST = 0.5  # of the arm's size: how far from the point its farthest corner is drawn
_COLOURS = (BLUE, "#e69f00", "#009e73", PURPLE, SKY, "#b8a800", VERMILION)  # of the joints whose limits are seen
_NUMBERED = 0.1  # of the shadow's extent: an edge, or the root of a face's area, that a number has room at
_NUMBER: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "center", "fontsize": 6.5, "zorder": 6}
_BALL: dict[str, Any] = {"edgecolor": INK, "facecolor": "none", "linewidth": 1.0, "linestyle": (0, (3.2, 1.6))}
_ZERO: dict[str, Any] = {"marker": "+", "markersize": 13, "color": INK, "markeredgewidth": 1.1, "linestyle": "none"}
_BODY: dict[str, Any] = {"edgecolor": INK, "facecolor": (GREY, 0.12), "linewidth": 1.1}


def polytope_figure(model: Model, forces: ForcePolytope, at: Configuration) -> Figure:
    """Return the arm as a stick figure with the polytope of the forces (or moments) that its joints allow at its point.

    A planar arm is drawn in its plane, and from aside too if forces point out of it; any other from two sides at right
    angles, the one that shows more of it first. What is seen is the near side of the polytope; each face has the number
    and the colour of the joint whose limit it is. Zero force is at the point where the forces act. Directions that need
    no torque are arrows; the polytope is then its section across them.

    Args:
        model: the robot.
        forces: its force polytope at one configuration.
        at: that configuration.
    """
    scene = _scene(model, forces, at)
    views = _views(scene)
    boxes, panels = scaled([scene.extent(view) for view in views])
    joints = sorted({joint for view in views for joint, _ in scene.body.pieces(view)})
    numbers = {joint: i for i, joint in enumerate(joints)}
    with house_style():
        names = [named(forces.columns[joint]) for joint in joints]
        legends = (_entries(forces, scene, views, names), symbol_entries(scene.arm, views))
        title = f"{named(model.robot.name, 40) or 'robot'}: {_kind(forces)}s of {named(forces.velocity.of)}"
        figure, axes = sheet(panels, title, _lines(forces, at), legends)
        for ax, view, box in zip(axes, views, boxes, strict=True):
            to_scale(ax, box, [in_words(direction) for direction in view])
            _draw(ax, scene, view, numbers)
        return figure


def _kind(forces: ForcePolytope) -> str:
    return "force" if forces.unit == "N" else "moment"


def _lines(forces: ForcePolytope, at: Configuration) -> list[str]:
    """Return what is said above the panels: what is drawn, what limits leave in every direction, where."""
    kind, of = _kind(forces), named(forces.velocity.of)
    whom = f"that {of} exerts" if forces.on.value == "environment" else f"that act on {of}"
    rows = "" if len(forces.task.rows) == 3 else f" along {' and '.join('xyz'[row % 3] for row in forces.task.rows)}"
    axes = f", in the axes of {named(forces.velocity.expressed_in)}" if rows else ""
    where = configuration_note(at, degrees=False).replace("$", r"\$")
    return [f"all {kind}s{rows} {whom} within the effort limits{axes}", where, *forces.warnings]


# --- what is drawn


@dataclass(frozen=True)
class _Body:
    """A polytope in the observer's axes, in m in the picture, about zero.

    Attributes:
        corners: (k, 3); across the lines.
        facets: indices of the corners of each: triangles, edges, or ends. (facets, 3, 2 or 1).
        joints: the column whose limit each is.
        lines: unit directions that are not bounded, as columns. (3, r).
        across: unit directions that are bounded, as columns. (3, m).
        ball: the radius that is possible in each of the latter.
        scale: m for 1 N, or Nm.
    """

    corners: Array
    facets: Array
    joints: tuple[int, ...]
    lines: Array
    across: Array
    ball: float
    scale: float

    def pieces(self, view: Array) -> list[tuple[int, Array]]:
        """Return what a view shows of each limit: its column, and corners (n, 2) of a near face, an edge, or an end.

        The near side of a solid: of the two faces of a joint one at most is turned to the onlooker.
        """
        seen = self.corners @ view.T
        if self.facets.shape[1] != 3:
            return [(joint, seen[facet]) for joint, facet in zip(self.joints, self.facets, strict=True)]
        near: dict[int, list[int]] = {}
        for joint, facet, turned in zip(self.joints, self.facets, self._turned_to(view), strict=True):
            if turned:
                near.setdefault(joint, []).extend(facet)
        return [(joint, _hull(seen[sorted(set(face))])) for joint, face in sorted(near.items())]

    def _turned_to(self, view: Array) -> Array:
        """Return of each triangle whether it is turned to the onlooker, more than rounding. (facets,)."""
        first, second, third = np.moveaxis(self.corners[self.facets], 1, 0)
        normals = np.cross(second - first, third - first)
        outward = np.sign(np.sum(normals * (first - np.mean(self.corners, axis=0)), axis=1))
        shadows = outward * (normals @ np.cross(*view))
        return np.asarray(shadows > NEGLIGIBLE * np.max(np.abs(shadows), initial=0.0))

    def shadow(self, view: Array) -> Array:
        """Return the outline (n, 2) of its projection, in order; two ends of a line, or a point."""
        return _hull(self.corners @ view.T)

    @property
    def arrows(self) -> Shape:
        """What is not bounded, as an ellipsoid without anything else."""
        return Shape("force", self.lines, np.full(self.lines.shape[1], np.inf), "", self.scale)

    @property
    def middle(self) -> Array:
        """Where its lines are drawn: at zero, or amid the corners where zero is not possible. (3,)."""
        return np.zeros(3) if self.ball > 0 else np.asarray(np.mean(self.corners, axis=0))


def _hull(points: Array) -> Array:
    """Return the convex hull (n, 2) of points (k, 2), counter-clockwise; two ends of a line, or a point."""
    from scipy.spatial import ConvexHull

    centred = points - points[0]
    _, sizes, directions = np.linalg.svd(centred)
    if sizes[0] == 0:
        return points[:1]
    if len(sizes) < 2 or sizes[1] <= NEGLIGIBLE * sizes[0]:
        along = centred @ directions[0]
        return points[[int(np.argmin(along)), int(np.argmax(along))]]
    return np.asarray(points[ConvexHull(points).vertices])


@dataclass(frozen=True)
class _Scene:
    """What the figure shows, in the observer's axes: the arm, the point (3,) where forces act, the polytope there.

    Size is the largest extent of arm and point along an axis, in m; 1 where they are one point.
    """

    arm: Skeleton
    point: Array
    size: float
    body: _Body

    def reach(self, view: Array) -> float:
        """Return how far an arrow without end is drawn, in m: beyond whatever is finite there."""
        return max(0.3 * self.size, 1.25 * float(np.max(np.linalg.norm(self.body.shadow(view), axis=1))))

    def extent(self, view: Array) -> Array:
        """Return the lower and the upper corner (2, 2) of what a view shows, in m."""
        middle, arrows = view @ self.point, self.reach(view) * self.body.arrows.directions(view).T
        start = middle + view @ self.body.middle
        around = [middle + self.body.shadow(view), start + arrows, start - arrows]
        corners = np.vstack([self.arm.points @ view.T, middle, *around])
        return np.array([np.min(corners, axis=0), np.max(corners, axis=0)])


def _scene(model: Model, forces: ForcePolytope, at: Configuration) -> _Scene:
    velocity = forces.velocity
    arm = skeleton(model, velocity.of, at.q, velocity.relative_to)
    placement = model.engine.placement(at.q, velocity.of, velocity.relative_to)
    point = placement[:3, :3] @ np.array(velocity.point) + placement[:3, 3]
    size = float(np.ptp(np.vstack([arm.points, point]), axis=0).max()) or 1.0
    turned = model.engine.placement(at.q, velocity.expressed_in, velocity.relative_to)[:3, :3]
    rows = turned[:, [row % 3 for row in forces.task.rows]]
    farthest = float(np.max(np.linalg.norm(forces.vertices, axis=1), initial=0.0))
    scale = 1 / rounded(farthest / (_FARTHEST * size), (1, 2, 3, 5, 10), up=True) if farthest > 0 else 1.0
    _, _, basis = np.linalg.svd(np.vstack([forces.lines, np.zeros((1, rows.shape[1]))]))
    across = rows @ basis[len(forces.lines) :].T
    corners, lines = scale * forces.vertices @ rows.T, rows @ forces.lines.T
    body = _Body(corners, forces.facets, forces.face_joints, lines, across, scale * forces.every_way, scale)
    return _Scene(arm, point, size, body)


def _views(scene: _Scene) -> list[Array]:
    """Return the drawing planes: those of the arm, and one from aside where forces leave the plane of a planar arm."""
    views = views_of(scene.arm)
    normal = np.cross(*views[0])
    out = float(np.max(np.abs(scene.body.corners @ normal)))
    if len(views) > 1 or out <= NEGLIGIBLE * scene.size:
        return views
    right, up = views[0]
    return [views[0], np.array([right, normal] if abs(normal[2]) > abs(up[2]) else [normal, up])]


def _draw(ax: Any, scene: _Scene, view: Array, numbers: Mapping[int, int]) -> None:
    """Draw one view of the scene."""
    arm, middle = scene.arm.points @ view.T, view @ scene.point
    ax.plot(*arm.T, color=INK, linewidth=3.2, solid_joinstyle="round", solid_capstyle="round", zorder=3, label="arm")
    if np.linalg.norm(scene.point - scene.arm.points[-1]) > NEGLIGIBLE * scene.size:
        ax.plot(*np.array([arm[-1], middle]).T, color=INK, linewidth=1, linestyle=":", zorder=3)
    draw_symbols(ax, scene.arm, view)
    ax.plot(*middle, **_ZERO, zorder=5.5, label="zero")
    _draw_body(ax, scene.body, view, middle, numbers)
    start = middle + view @ scene.body.middle
    draw_ellipsoid(ax, scene.body.arrows, view, start, scene.reach(view), np.mean(arm, axis=0))
    _draw_ball(ax, scene.body, view, middle)


def _draw_body(ax: Any, body: _Body, view: Array, point: Array, numbers: Mapping[int, int]) -> None:
    """Draw the shadow of the polytope, and on it the limits that are seen, each in colour and number of its joint."""
    from matplotlib.patches import Polygon

    shadow = body.shadow(view)
    if len(shadow) > 2:
        ax.add_patch(Polygon(point + shadow, **_BODY, zorder=2, label="polytope"))
    else:
        ax.plot(*(point + shadow).T, color=INK, linewidth=1.4, solid_capstyle="butt", zorder=4.3, label="polytope")
    for joint, piece in body.pieces(view):
        colour, label = _colour(numbers[joint]), f"limit {numbers[joint] + 1}"
        if len(piece) > 2:
            face: dict[str, Any] = {"facecolor": (colour, 0.3), "edgecolor": (colour, 0.9), "linewidth": 0.7}
            ax.add_patch(Polygon(point + piece, **face, zorder=2.1, label=label))
        else:
            style = {"marker": "o" if len(piece) == 1 else "", "markersize": 5, "linewidth": 2.4}
            ax.plot(*(point + piece).T, color=colour, **style, zorder=4.4, label=label)
        middle = np.mean(piece, axis=0)
        away = middle - np.mean(shadow, axis=0)
        distance = float(np.linalg.norm(away))
        if _has_room(piece, shadow, distance):
            offset = np.zeros(2) if len(piece) > 2 else 9 * away / distance
            box = {"boxstyle": "circle,pad=0.15", "facecolor": "white", "edgecolor": colour, "linewidth": 0.8}
            ax.annotate(str(numbers[joint] + 1), point + middle, offset, bbox=box, **_NUMBER)


def _has_room(piece: Array, shadow: Array, away: float) -> bool:
    """Return whether a number can be read at a piece of a polytope: it is large, and not seen from its edge."""
    extent = float(np.max(np.ptp(shadow, axis=0)))
    if len(piece) < 3:
        return away > _NUMBERED * extent / 2
    following = np.roll(piece, -1, axis=0)
    area = abs(float(np.sum(piece[:, 0] * following[:, 1] - piece[:, 1] * following[:, 0]))) / 2
    return math.sqrt(area) > _NUMBERED * extent


def _draw_ball(ax: Any, body: _Body, view: Array, point: Array) -> None:
    """Draw the force that is possible in every direction that is bounded."""
    from matplotlib.patches import Ellipse

    first, second = Shape("force", body.across, np.full(body.across.shape[1], body.ball), "", 1.0).shadow(view).T
    size = [2 * float(np.linalg.norm(axis)) for axis in (first, second)]
    if size[1] > 0:
        angle = math.degrees(math.atan2(first[1], first[0]))
        ax.add_patch(Ellipse((point[0], point[1]), size[0], size[1], angle=angle, **_BALL, zorder=4.2, label="ball"))


def _colour(index: int) -> str:
    """Return the colour of the limits of a joint, in the order of the legend; grey where colours run out."""
    return _COLOURS[index] if index < len(_COLOURS) else GREY


# --- words


def _entries(forces: ForcePolytope, scene: _Scene, views: Sequence[Array], names: Sequence[str]) -> list[Entry]:
    """Return legend entries for the polytope: its scale, whose limits are seen, the ball in it, what is not bounded."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    kind, unit, body = _kind(forces), forces.unit, scene.body
    largest = float(np.max(np.linalg.norm(forces.vertices, axis=1), initial=0.0))
    section = "\nsection across what is without bound" if len(forces.lines) else ""
    entries = list[Entry]()
    if largest > 0:
        words = f"1 m drawn is {1 / body.scale:g} {unit}, farthest corner {number(largest)} {unit}{section}"
        entries.append((Patch(**_BODY), words))
    for i, name in enumerate(names[: len(_COLOURS)]):
        entries.append((Patch(facecolor=(_colour(i), 0.3), edgecolor=_colour(i)), f"{i + 1}: limit of {name}"))
    if len(names) > len(_COLOURS):
        first, more = len(_COLOURS) + 1, len(names) - len(_COLOURS)
        entries.append((Patch(facecolor=(GREY, 0.3), edgecolor=GREY), f"{first} to {len(names)}: {more} more joints"))
    if body.ball > 0:
        bounded = "bounded " if len(forces.lines) else ""
        entries.append((Patch(**_BALL), f"{number(forces.every_way)} {unit} in every {bounded}direction"))
    if len(forces.lines):
        line: dict[str, Any] = {"color": VERMILION, "linewidth": 1.1, "marker": ">", "markersize": 4, "markevery": [1]}
        seen = any(body.arrows.directions(view).size for view in views)
        where = ": needs no torque" if seen else " across the drawing"
        handle = Line2D([], [], **line) if seen else Line2D([], [], linestyle="none")
        entries.append((handle, f"{kind} without bound{where}"))
    entries.append((Line2D([], [], **{**_ZERO, "markersize": 8}), f"zero {kind}"))
    return entries
