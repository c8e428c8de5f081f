"""Figures of a limb at several poses: side by side with its ellipsoids, and one over the other with its ellipses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.configuration import Configuration
from kinetostat.analysis.manipulability import Block, manipulability
from kinetostat.analysis.profile.result import LimbPose, LimbProfile
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.report.figures.ellipsoids import (
    Shape,
    draw_ellipsoid,
    ellipsoid_entry,
    number,
    to_one_scale,
    unbounded_entry,
)
from kinetostat.report.figures.scenes import Scene, block_drawn, draw_scene, scene_of
from kinetostat.report.figures.sheet import (
    GREY,
    INK,
    MARGINS,
    VERMILION,
    WIDTH,
    Entry,
    empty_sheet,
    house_style,
    named,
    rounded,
    sheet,
    to_scale,
)
from kinetostat.report.figures.symbols import draw_symbols, symbol_entries
from kinetostat.report.figures.views import in_words, scaled, view_of_all

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["MOST_POSES", "ellipses_figure", "poses_figure"]

MOST_POSES = 6
_BESIDE = 3  # panels in a row
_BETWEEN, _WORDS, _ROW = 0.2, 0.62, 0.13  # in, between panels; above each, for three lines of words; for one more
_HIGHEST, _LOWEST = 2.6, 1.1  # in, of a panel
_UNUSED = 0.45  # in, below a panel, where others have tick labels
_AROUND, _FOOT = 0.18, 0.14  # in, around what is drawn; more below it, for the bar that tells the scale
_SMALL = 0.62  # of symbols and lines, beside those of a large panel
_ALIKE = 10.0  # how many times smaller one scale may be than another, for all to be drawn to it
_LINE = 7.0  # pt, size of letters above a panel


def poses_figure(model: Model, profile: LimbProfile) -> Figure:
    """Return a limb at its named poses, six at most, each with its ellipsoids of velocity and force at the tool.

    All poses are seen from one side, the one that shows most of them, and to one scale; so are ellipsoids of velocity,
    and those of force unless one is more than ten times as large as another: then each has its own scale. Ellipsoids
    are those that `manipulability_figure` draws.

    Args:
        model: the robot.
        profile: what is known of the limb.
    """
    limb, poses = profile.limb, profile.poses[:MOST_POSES]
    title = f"{named(limb.name)} at its named poses"
    if not poses:
        return empty_sheet(title, ["there is no pose that can be drawn"])
    scenes = _to_scales([scene_of(model, pose.manipulability, pose.at) for pose in poses])
    view = view_of_all([scene.arm for scene in scenes])
    extents = np.array([scene.extent(view) for scene in scenes])
    box = np.array([extents[:, 0].min(axis=0), extents[:, 1].max(axis=0)])
    lines = [f"seen with {in_words(view[0])} to the right and {in_words(view[1])} up, relative to {named(limb.base)}"]
    unit = block_drawn(poses[0].manipulability).unit
    lines.append(f"of what ellipsoids show: w Yoshikawa's index, s smallest and s1 largest singular value{_in(unit)}")
    if len(profile.poses) > MOST_POSES:
        lines.append(f"the first {MOST_POSES} of {len(profile.poses)}")
    with house_style():
        own = len(_scales(scenes, "force")) > 1
        words = _WORDS + _ROW * own
        figure, panels, inch = _panels(len(poses), box, words, title, lines, _entries(scenes, view))
        for i, (ax, pose, scene) in enumerate(zip(panels, poses, scenes, strict=True)):
            _frame(ax, box, inch, inside=pose.inside)
            draw_scene(ax, scene, view, _SMALL)
            _write(ax, pose, [_force_scale(scene)] if own else [])
            if i == 0:
                _scale_bar(ax, inch)
        return figure


def _in(unit: str) -> str:
    return "" if unit == "mixed" else f" in {unit.replace('1', 'm/m')}"


# --- scales


def _to_scales(scenes: Sequence[Scene]) -> list[Scene]:
    """Return the scenes with their ellipsoids to one scale; those of force to scales of their own where they differ."""
    columns = []
    for shapes in zip(*(scene.shapes for scene in scenes), strict=True):
        sizes = [shape.scale for shape in shapes if np.any(shape.lengths[np.isfinite(shape.lengths)] > 0)]
        differ = shapes[0].name == "force" and max(sizes, default=1) > _ALIKE * min(sizes, default=1)
        columns.append(shapes if differ else to_one_scale(shapes))
    return [
        replace(scene, shapes=tuple(shapes)) for scene, shapes in zip(scenes, zip(*columns, strict=True), strict=True)
    ]


def _scales(scenes: Sequence[Scene], name: str) -> set[float]:
    return {shape.scale for scene in scenes for shape in scene.shapes if shape.name == name and _has_size(shape)}


def _has_size(shape: Shape) -> bool:
    return bool(np.any(shape.lengths[np.isfinite(shape.lengths)] > 0))


def _force_scale(scene: Scene) -> str:
    """Return the scale of a pose's ellipsoid of force, in words."""
    force = next(shape for shape in scene.shapes if shape.name == "force")
    return f"force: 1{_unit(force)} as {force.scale:g} m" if _has_size(force) else ""


def _unit(shape: Shape) -> str:
    return "" if shape.unit == "mixed units" else f" {shape.unit}"


def _entries(scenes: Sequence[Scene], view: Array) -> tuple[list[Entry], list[Entry]]:
    """Return the two legends: ellipsoids, symbols."""
    entries = list[Entry]()
    for shape in scenes[0].shapes:
        scales = _scales(scenes, shape.name)
        if len(scales) > 1:
            words = "its own scale at each"
        elif scales:
            words = f"1{_unit(shape)} drawn as {min(scales):g} m"
        else:
            words = "nowhere of a size"
        mixed = " (mixed units)" if shape.unit == "mixed units" else ""
        entries.append(ellipsoid_entry(shape, f"{shape.name} ellipsoid{mixed}: {words}"))
        every = [other for scene in scenes for other in scene.shapes if other.name == shape.name]
        if any(other.directions(view).size for other in every):
            entries.append(unbounded_entry(shape))
    return entries, symbol_entries(scenes[0].arm, [view])


# --- panels


def _panels(
    count: int, box: Array, words: float, title: str, lines: Sequence[str], entries: Sequence[Sequence[Entry]]
) -> tuple[Figure, list[Any], float]:
    """Return a sheet with so many panels, row by row, room above each for words, and how many metres an inch is."""
    columns = min(count, _BESIDE)
    rows = -(-count // columns)
    room = WIDTH - 0.3
    across, up = np.maximum(box[1] - box[0], 1e-300)
    wide = (room - _BETWEEN * (max(columns, 2) - 1)) / max(columns, 2)  # one alone is no larger than two
    inch = max(across / (wide - 2 * _AROUND), up / (_HIGHEST - 2 * _AROUND - _FOOT))
    high = max(_LOWEST, up / inch + 2 * _AROUND + _FOOT)
    tall = rows * (high + words) - _UNUSED
    figure, (whole,) = sheet([(WIDTH - MARGINS, tall)], title, lines, entries)
    top, (width, height) = whole.get_position().y1, figure.get_size_inches()
    whole.remove()
    panels = []
    for place in range(count):
        row, column = divmod(place, columns)
        left = 0.15 + column * (wide + _BETWEEN)
        low = top - ((row + 1) * (high + words) - 0.1) / height
        panels.append(figure.add_axes((left / width, low, wide / width, high / height)))
    return figure, panels, inch


def _frame(ax: Any, box: Array, inch: float, *, inside: bool) -> None:
    """Make a panel one that is to scale, without ticks: a dashed frame where the pose is outside limits."""
    width, height = ax.figure.get_size_inches()
    place = ax.get_position()
    half = np.array([place.width * width, place.height * height]) * inch / 2
    middle = (box[0] + box[1]) / 2 - (0, _FOOT * inch / 2)
    low, high = middle - half, middle + half
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xticks=[], yticks=[])
    for spine in ax.spines.values():
        spine.set(color="#d0d0d0") if inside else spine.set(color=VERMILION, linestyle=(0, (4, 2)), linewidth=1)


def _scale_bar(ax: Any, inch: float) -> None:
    """Draw a bar of a round length at the foot of a panel."""
    length = rounded(0.6 * inch, (1, 2, 5))
    left, low = ax.get_xlim()[0] + 0.08 * inch, ax.get_ylim()[0] + 0.08 * inch
    ax.plot([left, left + length], [low, low], color=INK, linewidth=1.4, solid_capstyle="butt", label="scale")
    words = f"{1000 * length:g} mm" if length < 0.01 else f"{length:g} m"
    ax.text(left + length + 0.05 * inch, low, words, va="center_baseline", fontsize=_LINE, color=INK)


def _write(ax: Any, pose: LimbPose, scale: Sequence[str]) -> None:
    """Write a pose's name, its indices and what else is to be said above its panel."""
    block = block_drawn(pose.manipulability)
    lost = f"rank {int(block.rank)} of {block.usual_rank}" if int(block.rank) < block.usual_rank else ""
    smallest, share = number(block.minimum_singular_value), number(block.inverse_condition_number)
    indices = f"w {number(block.yoshikawa)}, s {smallest}, s/s1 {share}"
    state = ", ".join(filter(None, ("" if pose.inside else "outside limits", f"singular: {lost}" if lost else "")))
    place = {"xycoords": "axes fraction", "textcoords": "offset points", "annotation_clip": False}
    look: dict[str, Any] = {"va": "baseline", "fontsize": _LINE}
    rows: list[tuple[str, dict[str, Any]]] = [
        (named(pose.name, 24), {"weight": "bold", "color": INK, "fontsize": 8.5}),
        (indices, {"color": "#444444"}),
        (state, {"color": VERMILION}),
        *((text, {"color": "#444444"}) for text in scale),
    ]
    said = [row for row in rows if row[0]]
    for down, (text, own) in enumerate(said):
        ax.annotate(text, (0, 1), (0, 4 + 72 * _ROW * (len(rows) - 1 - down)), **place, **(look | own))


# --- ellipses


def ellipses_figure(
    model: Model, frame: str, configurations: Array, *, relative_to: str | None = None, title: str = ""
) -> Figure:
    """Return the ellipses of velocity of a frame at several configurations, with the arm at each, all to one scale.

    Args:
        model: the robot.
        frame: the frame at the end, a link.
        configurations: (m, nq), m at least 1.
        relative_to: the observer, a link; default the root link.
        title: what it shows; default the names of robot and frame.

    Raises:
        UnknownNameError: there is no such frame.
        UsageError: no joint moves it.
        ConfigurationError: configurations of another shape, or numbers that are not finite.
    """
    scenes, blocks = list[Scene](), list[Block]()
    for q in configurations:
        result = manipulability(model, frame, q, relative_to=relative_to)
        scene = scene_of(model, result, Configuration(model.robot, q))
        scenes.append(replace(scene, shapes=scene.shapes[:1]))
        blocks.append(block_drawn(result))
    velocities = to_one_scale([replace(scene.shapes[0], scale=scene.shapes[0].scale / 2) for scene in scenes])
    scenes = [replace(scene, shapes=(shape,)) for scene, shape in zip(scenes, velocities, strict=True)]
    view = view_of_all([scene.arm for scene in scenes])
    extents = np.array([scene.extent(view) for scene in scenes])
    (box,), (panel,) = scaled([np.array([extents[:, 0].min(axis=0), extents[:, 1].max(axis=0)])])
    shares = [float(block.inverse_condition_number) for block in blocks]
    lines = [f"smallest / largest singular value from {number(min(shares))} to {number(max(shares))}"]
    words = f"velocity ellipsoid: 1{_unit(velocities[0])} drawn as {velocities[0].scale:g} m"
    entries = ([ellipsoid_entry(velocities[0], words)], symbol_entries(scenes[0].arm, [view]))
    with house_style():
        title = title or f"{named(model.robot.name, 40) or 'robot'}: velocities of {named(frame)}"
        figure, (ax,) = sheet([panel], title, lines, entries)
        to_scale(ax, box, [in_words(direction) for direction in view])
        for scene in scenes:
            arm, middle = scene.arm.points @ view.T, view @ scene.point
            ax.plot(*arm.T, color=GREY, linewidth=1.2, solid_joinstyle="round", zorder=2.5, label="arm")
            draw_symbols(ax, scene.arm, view, _SMALL)
            draw_ellipsoid(ax, scene.shapes[0], view, middle, scene.reach(view), np.mean(arm, axis=0))
        return figure
