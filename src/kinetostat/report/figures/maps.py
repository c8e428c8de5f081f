"""The figures of capability maps: slices through the workspace, and how good each place of the base is."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.capability.counting import APPROACH
from kinetostat.conventions import Array, Flags
from kinetostat.report.figures.sheet import (
    BAR_ROOM,
    GAP,
    INK,
    MARGINS,
    SKY,
    VERMILION,
    WIDTH,
    Entry,
    cased,
    colour_bar,
    colouring,
    house_style,
    named,
    sheet,
    to_scale,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kinetostat.analysis.capability.capability_map import CapabilityMap
    from kinetostat.analysis.capability.placing import BasePlacement

__all__ = ["capability_figure", "placement_figure"]

_WIDEST, _HIGHEST = 3.0, 3.6  # in, of a panel beside another
_ALONE = 4.6  # in, of a panel alone
_ENOUGH = 0.9  # of the voxels of the fullest layer: then the one through the observer's origin is drawn instead
_CONTOUR: dict[str, Any] = {"colors": INK, "linewidths": 1.0, "levels": [0.5]}
_ORIGIN: dict[str, Any] = {"marker": "+", "markersize": 9, "markeredgewidth": 1.6, "color": VERMILION, "ls": "none"}
_BEST: dict[str, Any] = {
    "marker": "o",
    "markersize": 6,
    "markerfacecolor": "white",
    "markeredgecolor": INK,
    "ls": "none",
}
_POSE: dict[str, Any] = {"marker": ".", "markersize": 5, "color": VERMILION, "ls": "none"}


@dataclass(frozen=True)
class _Cut:
    """A layer of voxels: which axes it spans, which it is across, and where."""

    across: int
    layer: int
    spans: tuple[int, int]


def capability_figure(result: CapabilityMap) -> Figure:
    """Return slices of a map: upright and level ones, coloured by the best smallest singular value of each voxel.

    A slice goes through the observer's origin, or where few voxels are there, through most of them.
    """
    from matplotlib.lines import Line2D

    cuts = _cuts(result)
    low, high = result.box
    spans = [tuple(float(high[i] - low[i]) for i in cut.spans) for cut in cuts]
    unit = result.singular_value_unit
    unit = {"1": "a pure number", "mixed": "m and rad mixed"}.get(unit, f"in {unit}")
    line = f"{result.count:,} configurations, {result.source.label}; voxels of {result.grid.size:g} m in the axes of "
    lines = [line + named(result.velocity.relative_to)]
    if result.approach is not None:
        way = ", ".join(f"{part:.4g}" for part in result.approach)
        lines.append(f"only where the tool's z axis is within {APPROACH:g} degrees of ({way})")
    lines.append(f"colour: the largest that the smallest singular value is in a voxel, {unit}; white: not reached")
    entries: list[Entry] = [(Line2D([], [], color=INK, linewidth=1.0), "edge of what is reached")]
    entries.append((Line2D([], [], **_ORIGIN), f"origin of {named(result.velocity.relative_to)}"))
    with house_style():
        figure, panels = sheet(_sizes(spans), f"where {named(result.velocity.of)} gets", lines, [entries], BAR_ROOM)
        colours = colouring(result.best_singular_value)
        for ax, cut in zip(panels, cuts, strict=True):
            coloured = _draw_cut(ax, result, cut, colours)
        colour_bar(panels[-1], coloured)
        return figure


def _cuts(result: CapabilityMap) -> list[_Cut]:
    """Return the slices: x-z and x-y, and y-z alone for what moves in that plane; where z or y is flat, one."""
    flat = [count == 1 for count in result.grid.shape]
    planes = {1: (0, 2), 2: (0, 1), 0: (1, 2)}
    wanted = [1, 2] if not any(flat) else [next(axis for axis in (2, 1, 0) if flat[axis])]
    return [_Cut(across, _layer(result, across), planes[across]) for across in wanted]


def _layer(result: CapabilityMap, across: int) -> int:
    others = tuple(axis for axis in range(3) if axis != across)
    filled = np.count_nonzero(result.reached, axis=others)
    origin = int(np.argmin(np.abs(result.grid.axes[across])))
    return origin if filled[origin] >= _ENOUGH * filled.max() else int(np.argmax(filled))


def _sizes(spans: list[tuple[float, ...]]) -> list[tuple[float, float]]:
    """Return the sizes of panels in inches: one scale for all, widths that fit a page."""
    widest, highest = (_ALONE, _ALONE) if len(spans) == 1 else (_WIDEST, _HIGHEST)
    room = min(widest, (WIDTH + 1.6 - MARGINS - BAR_ROOM - GAP * (len(spans) - 1)) / len(spans))
    scale = min(min(room / max(w, 0.2 * h), highest / max(h, 0.2 * w)) for w, h in spans)
    return [(max(w * scale, 1.2), max(h * scale, 1.2)) for w, h in spans]


def _draw_cut(ax: Any, result: CapabilityMap, cut: _Cut, colours: dict[str, Any]) -> Any:
    """Draw a layer of voxels; return what is coloured."""
    grid, (i, j) = result.grid, cut.spans
    values = np.take(result.best_singular_value, cut.layer, axis=cut.across)
    edges = [grid.origin[axis] + grid.size * np.arange(grid.shape[axis] + 1) for axis in (i, j)]
    coloured = ax.pcolormesh(edges[0], edges[1], values.T, rasterized=True, zorder=2, **colours)
    _outline(ax, edges, np.isfinite(values))
    box = np.array([[edge[0], edge[-1]] for edge in edges]).T
    pad = 0.03 * (box[1] - box[0]).max()
    to_scale(ax, box + np.array([[-pad], [pad]]), ["xyz"[i], "xyz"[j]])
    cased(ax.plot(0, 0, **_ORIGIN, zorder=5, clip_on=True)[0])
    at = round(float(grid.axes[cut.across][cut.layer]), 9) + 0.0
    ax.set_title(f"{'xyz'[cut.across]} = {at:.4g} m", fontsize=8.5, loc="left", pad=3)
    return coloured


def _outline(ax: Any, edges: list[Array], reached: Flags) -> None:
    """Draw the edges of voxels between what is reached and what is not."""
    from matplotlib.collections import LineCollection

    padded = np.pad(reached, 1)
    lines = []
    for a, b in zip(*np.nonzero(padded[1:, 1:-1] != padded[:-1, 1:-1]), strict=True):
        lines.append([(edges[0][a], edges[1][b]), (edges[0][a], edges[1][b + 1])])
    for a, b in zip(*np.nonzero(padded[1:-1, 1:] != padded[1:-1, :-1]), strict=True):
        lines.append([(edges[0][a], edges[1][b]), (edges[0][a + 1], edges[1][b])])
    ax.add_collection(LineCollection(lines, colors=INK, linewidths=0.9, zorder=3, capstyle="round"))


def placement_figure(result: BasePlacement) -> Figure:
    """Return how many poses each place of the base promises by the map, with the poses and the best places."""
    from matplotlib.lines import Line2D

    grid, count = result.map, len(result.poses)
    seen = _seen(result)
    step = result.capability.grid.size
    x, y = (np.append(values, values[-1] + step) - step / 2 for values in (grid.x[seen[0]], grid.y[seen[1]]))
    box = np.array([[x[0], y[0]], [x[-1], y[-1]]])
    lines = [
        f"share of {count} poses that the map of {named(result.capability.velocity.of)} promises, by the base's place"
    ]
    if result.proved:
        best = result.proved[0]
        lines.append(f"the best by inverse kinematics: ({best.x:.4g}, {best.y:.4g}) m, {best.count} of {count} poses")
    entries: list[Entry] = [(Line2D([], [], **_POSE), "wanted positions of the tool")]
    entries.append(
        (Line2D([], [], **_BEST), "places by inverse kinematics, the best one black; the line: x of the base")
    )
    with house_style():
        title = f"where to place the base of {named(result.capability.velocity.of)}"
        figure, (ax,) = sheet(_sizes([tuple(box[1] - box[0])]), title, lines, [entries], BAR_ROOM)
        promised = grid.promised[seen[0], seen[1]]
        shares = np.where(promised > 0, promised / count, np.nan)
        coloured = ax.pcolormesh(x, y, shares.T, rasterized=True, cmap="cividis", vmin=0, vmax=1, zorder=2)
        to_scale(ax, box, ["x", "y"])
        for one in reversed(result.proved):
            length = 2.5 * step
            ends = [one.x, one.x + length * math.cos(one.yaw)], [one.y, one.y + length * math.sin(one.yaw)]
            cased(ax.plot(*ends, color=SKY, linewidth=1.6, zorder=5)[0])
            ax.plot(one.x, one.y, **_BEST | ({"markerfacecolor": INK} if one is result.proved[0] else {}), zorder=6)
        ax.plot(*result.poses[:, :2, 3].T, **_POSE, zorder=7)
        _share_bar(ax, coloured)
        return figure


def _seen(result: BasePlacement) -> tuple[slice, slice]:
    """Return the part of the plane in which anything is promised, with the poses."""
    filled = result.map.promised > 0
    found = []
    for axis, values in enumerate((result.map.x, result.map.y)):
        there = np.flatnonzero(np.any(filled, axis=1 - axis))
        places = result.poses[:, axis, 3]
        low, high = np.searchsorted(values, [places.min(), places.max()])
        first, last = (min(there[0], low), max(there[-1], high)) if len(there) else (low, high)
        found.append(slice(max(int(first) - 1, 0), int(last) + 2))
    return found[0], found[1]


def _share_bar(ax: Any, coloured: Any) -> None:
    colour_bar(ax, coloured)
    ax.figure.axes[-1].set_ylabel("share of poses promised")
