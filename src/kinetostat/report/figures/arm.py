"""The figure of an arm with its ellipsoids of manipulability."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.configuration import Configuration
from kinetostat.analysis.manipulability import Block, Manipulability
from kinetostat.analysis.skeleton import Skeleton, skeleton
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.report.figures.ellipsoids import Shape, draw_ellipsoid, ellipsoid_entries, number, shapes_of
from kinetostat.report.figures.sheet import INK, house_style, named, sheet, to_scale
from kinetostat.report.figures.symbols import draw_symbols, symbol_entries
from kinetostat.report.figures.views import NEGLIGIBLE, in_words, scaled, views_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["manipulability_figure"]


def manipulability_figure(model: Model, result: Manipulability, at: Configuration) -> Figure:
    """Return the arm as a stick figure with the ellipsoids of velocity and force at its point.

    A planar arm is drawn in its plane; any other from two sides at right angles, the one that shows more of it first.
    z of the observer points up wherever it can be seen. Ellipsoids are those of the block `task` where its rows are all
    linear, else of `translation`; what is seen of each is its shadow on the plane of the drawing.

    Args:
        model: the robot.
        result: its manipulability at one configuration.
        at: that configuration.
    """
    task = result.blocks.get("task")
    block = task if task and task.task.linear and not task.task.angular else result.blocks["translation"]
    weighted = () if result.weights is None else ("joint rates are weighted",)
    lines = (_indices(block), _positions(model, result, at), *weighted)
    of, relative_to = named(result.velocity.of), named(result.velocity.relative_to)
    scene = _scene(model, result, at, block)
    views = views_of(scene.arm)
    boxes, panels = scaled([scene.extent(view) for view in views])
    with house_style():
        legends = (ellipsoid_entries(scene.shapes, views), symbol_entries(scene.arm, views))
        title = f"{named(model.robot.name, 40) or 'robot'}: {of} relative to {relative_to}"
        figure, axes = sheet(panels, title, lines, legends)
        for ax, view, box in zip(axes, views, boxes, strict=True):
            to_scale(ax, box, [in_words(direction) for direction in view])
            _draw(ax, scene, view)
        return figure


def _indices(block: Block) -> str:
    """Return the indices of manipulability in a line."""
    rows = f"task {' '.join(block.task.row_names)}" if block.task.name == "task" else block.task.name
    unit = "(mixed units)" if block.unit == "mixed" else block.unit.replace("1", "m/m")
    return (
        f"{rows}: Yoshikawa {number(block.yoshikawa)}, smallest s {number(block.minimum_singular_value)} {unit}, "
        f"smallest / largest s {number(block.inverse_condition_number)}, isotropy {number(block.isotropy)}"
    )


def _positions(model: Model, result: Manipulability, at: Configuration) -> str:
    """Return the positions of the joints between observer and frame, in path order, a unit after the last it is for."""
    robot, shown = model.robot, list[tuple[str, str]]()
    for joint in robot.movable_path(result.velocity.relative_to, result.velocity.of):
        values = " ".join(f"{round(float(x), 4) + 0.0:.4g}" for x in at.q[robot.position_slices[joint.name]])
        unit = " rad" if joint.type.is_angle else " m"
        shown.append((f"({values})", "") if joint.type.nq > 1 else (values, unit))
    parts = [", ".join(values for values, _ in part) + unit for unit, part in groupby(shown, lambda both: both[1])]
    return f"at q = {', '.join(parts)}"


@dataclass(frozen=True)
class _Scene:
    """What the figure shows, in the observer's axes: the arm, the point (3,) whose velocity it is, ellipsoids there.

    Size is the largest extent of arm and point along an axis, in m; 1 where they are one point.
    """

    arm: Skeleton
    point: Array
    size: float
    shapes: tuple[Shape, ...]

    def reach(self, view: Array) -> float:
        """Return how far an infinite axis is drawn from the point: beyond whatever is finite there, in m."""
        return max(0.3 * self.size, *(1.25 * float(np.linalg.norm(shape.shadow(view)[:, 0])) for shape in self.shapes))

    def extent(self, view: Array) -> Array:
        """Return the lower and the upper corner (2, 2) of what a view shows, in m."""
        around = [np.zeros(2)]
        for shape in self.shapes:
            around += [np.linalg.norm(shape.shadow(view), axis=1), *(self.reach(view) * shape.directions(view).T)]
        middle, half = view @ self.point, np.max(np.abs(around), axis=0)
        corners = [*(self.arm.points @ view.T), middle - half, middle + half]
        return np.array([np.min(corners, axis=0), np.max(corners, axis=0)])


def _scene(model: Model, result: Manipulability, at: Configuration, block: Block) -> _Scene:
    velocity = result.velocity
    arm, point = skeleton(model, velocity.of, at.q, velocity.relative_to), np.zeros(3)
    if velocity.point is not None:
        placement = model.engine.placement(at.q, velocity.of, velocity.relative_to)
        point = placement[:3, :3] @ np.array(velocity.point) + placement[:3, 3]
    turned = model.engine.placement(at.q, velocity.expressed_in, velocity.relative_to)[:3, :3]
    size = float(np.ptp(np.vstack([arm.points, point]), axis=0).max()) or 1.0
    return _Scene(arm, point, size, shapes_of(block, turned, size))


def _draw(ax: Any, scene: _Scene, view: Array) -> None:
    """Draw one view of the scene."""
    arm, middle = scene.arm.points @ view.T, view @ scene.point
    ax.plot(*arm.T, color=INK, linewidth=3.2, solid_joinstyle="round", solid_capstyle="round", zorder=3, label="arm")
    if np.linalg.norm(scene.point - scene.arm.points[-1]) > NEGLIGIBLE * scene.size:
        ax.plot(*np.array([arm[-1], middle]).T, color=INK, linewidth=1, linestyle=":", zorder=3)
    draw_symbols(ax, scene.arm, view)
    for shape in scene.shapes:
        draw_ellipsoid(ax, shape, view, middle, scene.reach(view), np.mean(arm, axis=0))
