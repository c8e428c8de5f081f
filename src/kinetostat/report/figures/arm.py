"""The figure of an arm with its ellipsoids of manipulability."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

from kinetostat.analysis.configuration import Configuration
from kinetostat.analysis.manipulability import Block, Manipulability
from kinetostat.engines.model import Model
from kinetostat.report.figures.ellipsoids import ellipsoid_entries, number
from kinetostat.report.figures.scenes import block_drawn, draw_scene, scene_of
from kinetostat.report.figures.sheet import house_style, named, sheet, to_scale
from kinetostat.report.figures.symbols import symbol_entries
from kinetostat.report.figures.views import in_words, scaled, views_of

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
    block = block_drawn(result)
    weighted = () if result.weights is None else ("joint rates are weighted",)
    lines = (_indices(block), _positions(model, result, at), *weighted)
    of, relative_to = named(result.velocity.of), named(result.velocity.relative_to)
    scene = scene_of(model, result, at)
    views = views_of(scene.arm)
    boxes, panels = scaled([scene.extent(view) for view in views])
    with house_style():
        legends = (ellipsoid_entries(scene.shapes, views), symbol_entries(scene.arm, views))
        title = f"{named(model.robot.name, 40) or 'robot'}: {of} relative to {relative_to}"
        figure, axes = sheet(panels, title, lines, legends)
        for ax, view, box in zip(axes, views, boxes, strict=True):
            to_scale(ax, box, [in_words(direction) for direction in view])
            draw_scene(ax, scene, view)
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
