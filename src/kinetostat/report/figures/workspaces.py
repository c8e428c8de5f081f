"""The figure of where the tool of a planar arm gets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.conventions import Array
from kinetostat.report.figures.sheet import (
    BAR_ROOM,
    GREY,
    INK,
    MARGINS,
    PURPLE,
    SKY,
    VERMILION,
    WIDTH,
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

    from kinetostat.analysis.singular.slices import Curve, Workspace

__all__ = ["workspace_figure"]

_HIGHEST_PANEL = 4.6  # in
_MANY = 1500  # points: beyond, they are a picture inside the SVG
_DASHES: tuple[Any, ...] = ("-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (5, 1.5, 1.2, 1.5)))
_GREY_DASHES: tuple[Any, ...] = ((0, (5, 2.5)), (0, (1.5, 1.8)), (0, (6, 2, 1.5, 2)))
_SINGULAR, _UNLIMITED = "singular", "singular, limits left out"
_KINDS: dict[str, tuple[tuple[str, ...], float, tuple[Any, ...], int]] = {  # colours, width, dashes, zorder
    _SINGULAR: ((VERMILION, INK, PURPLE, SKY), 2.2, _DASHES, 5),
    "limit": ((INK,), 0.9, _DASHES, 4),
    _UNLIMITED: ((GREY,), 1.3, _GREY_DASHES, 3),
}


def workspace_figure(workspace: Workspace) -> Figure:
    """Return where the tool of a planar arm gets, coloured by the smallest singular value, with its singular curves."""
    from matplotlib.lines import Line2D

    box, panel = _panel(workspace)
    curves = _styled(workspace)
    count = len(workspace.reached)
    line = f"tool positions at random joint positions inside limits, in the axes of {named(workspace.observer)}"
    with house_style():
        styles = {words: style for _, words, style in curves}
        entries = [(Line2D([], [], **style), words) for words, style in styles.items()]
        half = (len(entries) + 1) // 2
        legends = (entries[:half], entries[half:])
        figure, (ax,) = sheet([panel], "workspace and singular curves", [line], legends, BAR_ROOM)
        to_scale(ax, box, [named(axis) for axis in workspace.axes])
        if count:
            size: dict[str, Any] = {"s": min(14.0, max(2.0, 20000 / count)), "linewidths": 0, "zorder": 2}
            colours = {"c": workspace.smallest, **colouring(workspace.smallest)}
            colour_bar(ax, ax.scatter(*workspace.reached.T, **size, **colours, rasterized=count > _MANY))
        for curve, words, style in curves:
            drawn = ax.plot(*curve.points.T, **style)[0]
            if words.startswith(f"{_SINGULAR}: "):
                cased(drawn)
        return figure


def _panel(workspace: Workspace) -> tuple[Array, tuple[float, float]]:
    """Return the limits (2, 2) of the axes in m, and the panel's size in inches."""
    points = np.vstack([workspace.reached, *(curve.points for curve in (*workspace.curves, *workspace.unlimited))])
    points = points[np.all(np.isfinite(points), axis=1)]
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(2), np.ones(2))
    span = np.maximum(high - low, 0.3 * max(float((high - low).max()), 1e-9)) * 1.08
    width, height = span / max(span[0] / (WIDTH - MARGINS - BAR_ROOM), span[1] / _HIGHEST_PANEL)
    middle = (low + high) / 2
    return np.array([middle - span / 2, middle + span / 2]), (float(width), float(height))


def _styled(workspace: Workspace) -> list[tuple[Curve, str, dict[str, Any]]]:
    """Return every curve with its words and its style: one style a label."""
    found = []
    for kind, (colours, width, dashes, zorder) in _KINDS.items():
        curves = workspace.unlimited if kind == _UNLIMITED else [c for c in workspace.curves if c.kind == kind]
        labels = list(dict.fromkeys(curve.label for curve in curves))
        for curve in curves:
            turn, index = divmod(labels.index(curve.label), len(colours))
            style = {"color": colours[index], "linestyle": dashes[turn % len(dashes)]}
            style |= {"linewidth": width, "zorder": zorder}
            found.append((curve, f"{kind}: {named(curve.label, 30)}", style))
    return found
