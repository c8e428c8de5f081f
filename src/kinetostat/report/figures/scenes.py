"""What a view of an arm shows: its stick figure, and the ellipsoids of manipulability at its point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kinetostat.analysis.configuration import Configuration
from kinetostat.analysis.manipulability import Block, Manipulability
from kinetostat.analysis.skeleton import Skeleton, skeleton
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.report.figures.ellipsoids import Shape, draw_ellipsoid, shapes_of
from kinetostat.report.figures.sheet import INK
from kinetostat.report.figures.symbols import draw_symbols
from kinetostat.report.figures.views import NEGLIGIBLE

__all__ = ["Scene", "block_drawn", "draw_scene", "scene_of"]


def block_drawn(result: Manipulability) -> Block:
    """Return the block whose ellipsoids are drawn: `task` where its rows are all linear, else `translation`."""
    task = result.blocks.get("task")
    return task if task and task.task.linear and not task.task.angular else result.blocks["translation"]


@dataclass(frozen=True)
class Scene:
    """What a figure shows, in the observer's axes: the arm, the point (3,) whose velocity it is, ellipsoids there.

    Size is the largest extent of arm and point along an axis, in m; 1 where they are one point.
    """

    arm: Skeleton
    point: Array
    size: float
    shapes: tuple[Shape, ...]

    @property
    def path(self) -> Array:
        """The line that is drawn of the arm, in the observer's axes: to a joint that slides it comes along the rail.

        The rail begins where it is nearest to what carries it. (k, 3), m.
        """
        rails = {pivot.vertex: pivot.axis for pivot in reversed(self.arm.pivots) if pivot.kind == "sliding"}
        path = list[Array]()
        for vertex, point in enumerate(self.arm.points):
            if path and vertex in rails:
                path.append(point - rails[vertex] * float(rails[vertex] @ (point - path[-1])))
            path.append(point)
        return np.array(path)

    def reach(self, view: Array) -> float:
        """Return how far an infinite axis is drawn from the point: beyond whatever is finite there, in m."""
        return max(0.3 * self.size, *(1.25 * float(np.linalg.norm(shape.shadow(view)[:, 0])) for shape in self.shapes))

    def extent(self, view: Array) -> Array:
        """Return the lower and the upper corner (2, 2) of what a view shows, in m."""
        around = [np.zeros(2)]
        for shape in self.shapes:
            around += [np.linalg.norm(shape.shadow(view), axis=1), *(self.reach(view) * shape.directions(view).T)]
        middle, half = view @ self.point, np.max(np.abs(around), axis=0)
        corners = [*(self.path @ view.T), middle - half, middle + half]
        return np.array([np.min(corners, axis=0), np.max(corners, axis=0)])


def scene_of(model: Model, result: Manipulability, at: Configuration) -> Scene:
    """Return the scene of a robot at a configuration."""
    velocity = result.velocity
    arm, point = skeleton(model, velocity.of, at.q, velocity.relative_to), np.zeros(3)
    if velocity.point is not None:
        placement = model.engine.placement(at.q, velocity.of, velocity.relative_to)
        point = placement[:3, :3] @ np.array(velocity.point) + placement[:3, 3]
    turned = model.engine.placement(at.q, velocity.expressed_in, velocity.relative_to)[:3, :3]
    size = float(np.ptp(np.vstack([arm.points, point]), axis=0).max()) or 1.0
    return Scene(arm, point, size, shapes_of(block_drawn(result), turned, size))


def draw_scene(ax: Any, scene: Scene, view: Array, size: float = 1.0) -> None:
    """Draw one view of the scene; the size of lines and symbols is that of a large panel's."""
    arm, middle = scene.path @ view.T, view @ scene.point
    line: dict[str, Any] = {"color": INK, "solid_joinstyle": "round", "solid_capstyle": "round", "zorder": 3}
    ax.plot(*arm.T, linewidth=3.2 * size, **line, label="arm")
    if np.linalg.norm(scene.point - scene.arm.points[-1]) > NEGLIGIBLE * scene.size:
        ax.plot(*np.array([arm[-1], middle]).T, color=INK, linewidth=1, linestyle=":", zorder=3)
    draw_symbols(ax, scene.arm, view, size)
    for shape in scene.shapes:
        draw_ellipsoid(ax, shape, view, middle, scene.reach(view), np.mean(arm, axis=0))
