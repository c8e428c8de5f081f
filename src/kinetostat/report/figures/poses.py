"""Figures of a limb at several poses: side by side with its ellipsoids, and one over the other with its ellipses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.configuration import Configuration
from kinetostat.analysis.indices import NEAR
from kinetostat.analysis.manipulability import Block, manipulability
from kinetostat.analysis.profile.anatomy import Limb
from kinetostat.analysis.profile.result import LimbPose, LimbProfile
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.report.alike import alike
from kinetostat.report.figures.ellipsoids import (
    Shape,
    draw_ellipsoid,
    ellipsoid_entry,
    number,
    to_one_scale,
    unbounded_entry,
)
from kinetostat.report.figures.names import told_apart
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
from kinetostat.report.figures.views import axis_titles, scaled, seen_from_above, view_of_all

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["MOST_POSES", "ellipses_figure", "poses_figure"]

MOST_POSES = 6
_BETWEEN, _ROW = 0.15, 0.13  # in, between panels; above each, for a line of words
_HIGHEST, _LOWEST = 2.6, 1.1  # in, of a panel
_NARROWEST, _WIDEST = 1.3, 3.2  # in, of a panel
_COLUMNS = {1: (1,), 2: (2,), 3: (3,), 4: (4, 2), 5: (3,), 6: (3,)}  # of so many panels: no lonely one in a row
_WORTH = 1.5  # how many times larger panels in several rows are than in one
_UNUSED = 0.45  # in, below a panel, where others have tick labels
_AROUND, _FOOT = 0.18, 0.14  # in, around what is drawn; more below it, for the bar that tells the scale
_SMALL = 0.62  # of symbols and lines, beside those of a large panel
_ALIKE = 10.0  # how many times smaller one scale may be than another, for all to be drawn to it
_ENDLESS = 1 / NEAR  # how many times the shortest axis of force a longer one is drawn without end: near-singular
_EQUAL = 1e-6  # rad, m: what files round
_SAME = 0.005  # of the limb's size: poses nearer to each other look the same
_LINE = 7.0  # pt, size of letters above a panel
_LONGEST, _MOST_NAMES = 22, 3  # letters of a pose's name; names of one panel


def poses_figure(model: Model, profile: LimbProfile) -> Figure:
    """Return a limb at its named poses, six at most, each with its numbers, and ellipsoids of velocity and force.

    Numbers are those of the pose: of the rows that count. Ellipsoids are of the tool's linear velocity and force, as in
    `manipulability_figure`; there are none where no joint moves the tool along, or where slides and turns would mix
    metres and radians. A force that is a hundred times another has no end in the picture. All poses are seen from one
    side, that of the map of the reach, and to one scale; so are ellipsoids of velocity, and those of force unless one
    is more than ten times as large as another: then each has its own scale. Poses that look and measure the same are
    one.

    Args:
        model: the robot.
        profile: what is known of the limb.
    """
    limb = profile.limb
    title = f"{named(limb.name)} at its named poses"
    if not profile.poses:
        return empty_sheet(title, ["there is no pose that can be drawn"])
    every = alike(((pose, scene_of(model, pose.manipulability, pose.at)) for pose in profile.poses), _same)
    poses = [group[0][0] for group in every[:MOST_POSES]]
    scenes = _to_scales([_bounded(*group[0]) for group in every[:MOST_POSES]])
    up = model.engine.placement(poses[0].at.q, model.robot.root, limb.base)[:3, 2]
    view, up = _view(profile, scenes, up)
    extents = np.array([scene.extent(view) for scene in scenes])
    lines = _lines(profile, poses[0], scenes[0], f"{' to the right, '.join(axis_titles(view, up))} upwards")
    if len(every) > MOST_POSES:
        lines.append(f"the first {MOST_POSES} of {len(every)}")
    with house_style():
        words = _words(_names(limb, [[pose for pose, _ in group] for group in every[:MOST_POSES]]), poses, scenes)
        span = np.max(extents[:, 1] - extents[:, 0], axis=0)
        above = 0.12 + _ROW * len(words[0])
        figure, panels, inch = _panels(len(poses), span, above, title, lines, _entries(scenes, view))
        for i, (ax, pose, scene) in enumerate(zip(panels, poses, scenes, strict=True)):
            _frame(ax, extents[i], inch, inside=pose.inside)
            draw_scene(ax, scene, view, _SMALL)
            _write(ax, words[i])
            if i == 0:
                _scale_bar(ax, inch)
        return figure


def _same(one: tuple[LimbPose, Scene], other: tuple[LimbPose, Scene]) -> bool:
    """Return whether two poses with their scenes look and measure the same."""
    points, others = one[1].arm.points, other[1].arm.points
    looks = points.shape == others.shape and np.abs(points - others).max() < _SAME * one[1].size
    return bool(looks and one[0].inside == other[0].inside and _numbers(one[0]) == _numbers(other[0]))


def _view(profile: LimbProfile, scenes: Sequence[Scene], up: Array) -> tuple[Array, Array]:
    """Return the plane (2, 3) of the drawing, that of the map of the reach where it has one, and its vertical (3,)."""
    arms = [scene.arm for scene in scenes]
    wanted, planar = "above" if seen_from_above(arms, up) else "side", arms[0].normal is not None
    for section in profile.sections:
        if section.view == wanted or planar:
            right, upward = section.directions
            return section.directions, upward if section.view == "side" else np.cross(right, upward)
    return view_of_all(arms, up), up


# --- words


def _counted(pose: LimbPose) -> Block:
    """Return the block of the rows that count."""
    blocks = pose.manipulability.blocks
    return blocks.get("task", blocks["full"])


def _lines(profile: LimbProfile, pose: LimbPose, scene: Scene, directions: str) -> list[str]:
    """Return what is said below the title: where one looks from, what is drawn, of which rows numbers are."""
    found, block = pose.manipulability, _counted(pose)
    if scene.shapes:
        drawn = "ellipsoids of the tool's linear velocity and force"
    elif block_drawn(found).usual_rank == 0:
        drawn = "no joint moves the tool along, it only turns"
    else:
        drawn = "no ellipsoids: metres and radians would mix"
    length = "" if found.length is None else f", lengths over {number(found.length)} m"
    measure = profile.sweep.measures.get("minimum_singular_value") if profile.sweep is not None else None
    unit = block.unit if measure is None else measure.unit
    unit = {"1": "", "mixed": ", metres and radians mixed"}.get(unit, f", in {unit}")
    rows = "all six rows" if block.task_dimension == 6 else f"rows {' '.join(block.task.row_names)}"
    numbers = f"w manipulability, s smallest singular value, s/s1 dexterity: of {rows}{length}{unit}"
    return [f"{directions}, axes of {named(found.velocity.relative_to)}; {drawn}", numbers]


def _numbers(pose: LimbPose) -> tuple[str, str]:
    """Return a pose's numbers as the figure shows them, in two lines."""
    measures = ("yoshikawa", "minimum_singular_value", "inverse_condition_number")
    values = [pose.values.get(measure, float("nan")) for measure in measures]
    manipulability, smallest, share = (number(value) if np.isfinite(value) else "-" for value in values)
    block = _counted(pose)
    return f"w {manipulability}, s {smallest}", f"s/s1 {share}, rank {int(block.rank)} of {block.task_dimension}"


def _state(pose: LimbPose) -> str:
    block = _counted(pose)
    singular = "singular" if int(block.rank) < block.usual_rank else ""
    return ", ".join(filter(None, (singular, "" if pose.inside else "outside limits")))


def _names(limb: Limb, groups: Sequence[Sequence[LimbPose]]) -> list[list[str]]:
    """Return what each panel is called, line by line: poses with the same joint positions, or which look the same."""
    shown = iter(told_apart([pose.name for group in groups for pose in group], _LONGEST))
    called = [[f"{_joined(limb, group[0], pose)}{next(shown)}" for pose in group] for group in groups]
    more = [len(lines) - _MOST_NAMES for lines in called]
    return [
        [*lines[:_MOST_NAMES], *([f"and {over} more"] if over > 0 else [])]
        for lines, over in zip(called, more, strict=True)
    ]


def _joined(limb: Limb, first: LimbPose, pose: LimbPose) -> str:
    robot = pose.at.robot
    here, there = (
        np.concatenate([one.at.q[robot.position_slices[joint]] for joint in limb.joints]) for one in (pose, first)
    )
    return "" if pose is first else "= " if np.allclose(here, there, rtol=0, atol=_EQUAL) else "and "


def _words(
    names: Sequence[Sequence[str]], poses: Sequence[LimbPose], scenes: Sequence[Scene]
) -> list[list[tuple[str, dict[str, Any]]]]:
    """Return the lines above each panel, with their style; as many for each."""
    own = len(_scales(scenes, "force")) > 1
    grey: dict[str, Any] = {"color": "#444444"}
    strong: dict[str, Any] = {"weight": "bold", "color": INK}
    most = max(map(len, names))
    told = [
        [
            *((name, strong | {"fontsize": 8.5}) for name in [*group, *[""] * most][:most]),
            *((numbers, grey) for numbers in _numbers(pose)),
            (_state(pose), strong),
            (_force_scale(scene) if own else "", grey),
        ]
        for group, pose, scene in zip(names, poses, scenes, strict=True)
    ]
    used = [any(lines[i][0] for lines in told) for i in range(len(told[0]))]
    return [[line for line, some in zip(lines, used, strict=True) if some] for lines in told]


# --- scales


def _bounded(pose: LimbPose, scene: Scene) -> Scene:
    """Return a scene with the ellipsoids that say something; a force that is far larger than another has no end."""
    block = block_drawn(pose.manipulability)
    if block.usual_rank == 0 or block.unit == "mixed":
        return replace(scene, shapes=())
    velocity, force = scene.shapes
    lengths = np.where(force.lengths > _ENDLESS * force.lengths.min(), np.inf, force.lengths)
    return replace(scene, shapes=(velocity, force.rescaled(lengths, scene.size)))


def _to_scales(scenes: Sequence[Scene]) -> list[Scene]:
    """Return the scenes with their ellipsoids to one scale; those of force to scales of their own where they differ."""
    if not scenes[0].shapes:
        return list(scenes)
    columns = []
    for shapes in zip(*(scene.shapes for scene in scenes), strict=True):
        sizes = [shape.scale for shape in shapes if _has_size(shape)]
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
    return f"force: 1 {force.unit} as {force.scale:g} m" if _has_size(force) else ""


def _entries(scenes: Sequence[Scene], view: Array) -> tuple[list[Entry], list[Entry]]:
    """Return the two legends: ellipsoids, symbols."""
    entries = list[Entry]()
    for shape in scenes[0].shapes:
        scales = _scales(scenes, shape.name)
        if scales:
            words = "its own scale at each" if len(scales) > 1 else f"1 {shape.unit} drawn as {min(scales):g} m"
            entries.append(ellipsoid_entry(shape, f"{shape.name} ellipsoid: {words}"))
        every = [other for scene in scenes for other in scene.shapes if other.name == shape.name]
        if any(other.directions(view).size for other in every):
            entries.append(unbounded_entry(shape, f"{shape.name} without bound, or {_ENDLESS:g} times the least"))
    return entries, symbol_entries(scenes[0].arm, [view])


# --- panels


def _panels(
    count: int, span: Array, words: float, title: str, lines: Sequence[str], entries: Sequence[Sequence[Entry]]
) -> tuple[Figure, list[Any], float]:
    """Return a sheet with so many panels, row by row, room above each for words, and how many metres an inch is."""
    choices = [(_scaled(span, columns), columns) for columns in _COLUMNS[count]]
    inch, columns = choices[0] if choices[0][0] < _WORTH * choices[-1][0] else choices[-1]
    rows = -(-count // columns)
    content = span / inch + 2 * _AROUND + (0, _FOOT)
    wide, high = min(max(content[0], _NARROWEST), _room(columns)), max(content[1], _LOWEST)
    tall = rows * (high + words) - _UNUSED
    figure, (whole,) = sheet([(WIDTH - MARGINS, tall)], title, lines, entries)
    top, (width, height) = whole.get_position().y1, figure.get_size_inches()
    whole.remove()
    step = wide + _BETWEEN if wide > 0.8 * _room(columns) else _room(columns) + _BETWEEN  # trimmed, but in line
    panels = []
    for place in range(count):
        row, column = divmod(place, columns)
        low = top - ((row + 1) * (high + words) - 0.1) / height
        panels.append(figure.add_axes(((0.15 + column * step) / width, low, wide / width, high / height)))
    return figure, panels, inch


def _room(columns: int) -> float:
    """Return the width in inches that each of some panels side by side may have."""
    return min(_WIDEST, (WIDTH - 0.3 - _BETWEEN * (columns - 1)) / columns)


def _scaled(span: Array, columns: int) -> float:
    """Return how many metres an inch is for a span (2,) in m to fit a panel, of which so many are side by side."""
    across, up = np.maximum(span, 1e-300)
    return float(max(across / (_room(columns) - 2 * _AROUND), up / (_HIGHEST - 2 * _AROUND - _FOOT)))


def _frame(ax: Any, extent: Array, inch: float, *, inside: bool) -> None:
    """Make a panel one that is to scale, about what it shows; dashed where the pose is outside limits."""
    width, height = ax.figure.get_size_inches()
    place = ax.get_position()
    half = np.array([place.width * width, place.height * height]) * inch / 2
    middle = extent.mean(axis=0) - (0, _FOOT * inch / 2)
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


def _write(ax: Any, lines: Sequence[tuple[str, dict[str, Any]]]) -> None:
    """Write lines above a panel, each with its style."""
    place: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points", "annotation_clip": False}
    look: dict[str, Any] = {"va": "baseline", "fontsize": _LINE}
    for over, (text, own) in enumerate(reversed(lines)):
        if text:
            ax.annotate(text, (0, 1), (0, 4 + 72 * _ROW * over), **place, **(look | own))


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
    up = model.engine.placement(configurations[0], model.robot.root, scenes[0].arm.relative_to)[:3, 2]
    view = view_of_all([scene.arm for scene in scenes], up)
    extents = np.array([scene.extent(view) for scene in scenes])
    (box,), (panel,) = scaled([np.array([extents[:, 0].min(axis=0), extents[:, 1].max(axis=0)])])
    shares = [float(block.inverse_condition_number) for block in blocks]
    lines = [f"smallest / largest singular value from {number(min(shares))} to {number(max(shares))}"]
    words = f"velocity ellipsoid: 1 {velocities[0].unit} drawn as {velocities[0].scale:g} m"
    entries = ([ellipsoid_entry(velocities[0], words)], symbol_entries(scenes[0].arm, [view]))
    with house_style():
        title = title or f"{named(model.robot.name, 40) or 'robot'}: velocities of {named(frame)}"
        figure, (ax,) = sheet([panel], title, lines, entries)
        to_scale(ax, box, axis_titles(view, up))
        for scene in scenes:
            arm, middle = scene.arm.points @ view.T, view @ scene.point
            ax.plot(*arm.T, color=GREY, linewidth=1.2, solid_joinstyle="round", zorder=2.5, label="arm")
            draw_symbols(ax, scene.arm, view, _SMALL)
            draw_ellipsoid(ax, scene.shapes[0], view, middle, scene.reach(view), np.mean(arm, axis=0))
        return figure
