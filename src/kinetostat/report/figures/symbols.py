"""Symbols of joints, ground and tool, in points on the page, after ISO 3952, and their legend."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from kinetostat.analysis.skeleton import Pivot, Skeleton
from kinetostat.conventions import Array
from kinetostat.report.figures.sheet import INK, Entry, named

__all__ = ["GROUND", "draw_symbols", "marker_of", "symbol_entries"]

_Lines = Sequence[Sequence[tuple[float, float]]]  # closed polylines around the place that they mark


def _box(x: float, y: float) -> list[tuple[float, float]]:
    return [(-x, -y), (x, -y), (x, y), (-x, y)]


def _diamond(x: float) -> list[tuple[float, float]]:
    return [(0, x), (x, 0), (0, -x), (-x, 0)]


_ACROSS = 0.35  # an axis that is seen shorter than this is seen end-on
_TURN = np.linspace(0, 2 * np.pi, 48, endpoint=False)
_JOINTS: dict[str, tuple[_Lines, str]] = {  # axes to the right
    "turns": ([[(5.2 * float(np.cos(t)), 5.2 * float(np.sin(t))) for t in _TURN]], "joint that turns, its axis end-on"),
    "turns about": ([_box(8, 3.4)], "joint that turns about the bar"),
    "slides": ([_box(4.6, 4.6)], "joint that slides, its axis end-on"),
    "slides along": ([[(-10, 0), (-4.6, 0)], _box(4.6, 4.6), [(4.6, 0), (10, 0)]], "joint that slides along the line"),
    "free": ([_diamond(6.5)], "joint that moves in a plane, or floats"),
}
GROUND = "ground"
_GROUND = [
    [(0.0, 0.0), (-6.0, -8.0), (6.0, -8.0)],
    [(-10.0, -8.0), (10.0, -8.0)],
    *([(x, -8.0), (x - 4.0, -12.0)] for x in (-6.0, -2.0, 2.0, 6.0, 10.0)),
]
_TOOL = [_diamond(4.6)]
_ALONE: dict[str, _Lines] = {
    "turns": _JOINTS["turns"][0],
    "endless": [*_JOINTS["turns"][0], [(0.5 * x, 0.5 * y) for x, y in reversed(_JOINTS["turns"][0][0])]],  # a ring
    "screws": [_box(7, 3.4)],
    "slides": _JOINTS["slides"][0],
    "free": _JOINTS["free"][0],
    "folded": [_box(4.4, 4.4), [(-2, 6), (-2, 7.6), (7.6, 7.6), (7.6, -2), (6, -2), (6, 6)]],
    GROUND: _GROUND,
}
_JOINT_STYLE: dict[str, Any] = {"markerfacecolor": "white", "markeredgecolor": INK, "markeredgewidth": 1.3}
_GROUND_STYLE: dict[str, Any] = {"markerfacecolor": "none", "markeredgecolor": "#555555", "markeredgewidth": 0.9}
_TOOL_STYLE: dict[str, Any] = {"markerfacecolor": INK, "markeredgecolor": "white", "markeredgewidth": 0.9}


def marker_of(symbol: str, size: float = 1.0) -> dict[str, Any]:
    """Return the marker of a symbol that stands alone, seen from no side.

    It is one of turns, endless, screws, slides, free, folded, and ground.
    """
    return _marker(_ALONE[symbol], size=size)


def _marker(lines: _Lines, direction: Any = (1, 0), size: float = 1.0) -> dict[str, Any]:
    """Return the marker of polylines, what is to the right in them turned to a direction (2,)."""
    from matplotlib.path import Path

    c, s = direction
    turned = [np.array([*line, line[0]]) @ np.array([(c, s), (-s, c)]) for line in lines]
    path = Path.make_compound_path(*(Path(line, closed=True) for line in turned))
    reach = max(float(np.abs(line).max()) for line in turned)  # what matplotlib scales to half the marker's size
    return {"marker": path, "markersize": 2 * reach * size, "linestyle": "none"}


def _seen(pivot: Pivot, view: Array) -> tuple[str, Any]:
    """Return the joint's symbol as a view shows it, and its direction there."""
    if pivot.kind in ("planar", "floating"):
        return "free", (1, 0)
    axis = view @ pivot.axis
    length = float(np.linalg.norm(axis))
    if length < _ACROSS:
        return "slides" if pivot.kind == "sliding" else "turns", (1, 0)
    return "slides along" if pivot.kind == "sliding" else "turns about", axis / length


def draw_symbols(ax: Any, arm: Skeleton, view: Array, size: float = 1.0) -> None:
    """Draw ground, joints and tool where they are; their size is that of a large panel's."""
    points = arm.points @ view.T
    ax.plot(*points[:1].T, **_marker(_GROUND, size=size), **_GROUND_STYLE, zorder=2.9)
    for pivot in arm.pivots:
        symbol, direction = _seen(pivot, view)
        place = points[[pivot.vertex]].T
        ax.plot(*place, **_marker(_JOINTS[symbol][0], direction, size), **_JOINT_STYLE, zorder=4)
    ax.plot(*points[-1:].T, **_marker(_TOOL, size=size), **_TOOL_STYLE, zorder=5)


def symbol_entries(arm: Skeleton, views: Sequence[Array]) -> list[Entry]:
    """Return legend entries for the symbols that the views show."""
    from matplotlib.lines import Line2D

    ground = [[(x, y + 6) for x, y in line] for line in _GROUND]  # in the middle of its line
    shown = {_seen(pivot, view)[0] for pivot in arm.pivots for view in views}
    symbols = [
        (ground, _GROUND_STYLE, f"{named(arm.relative_to)} (observer)"),
        (_TOOL, _TOOL_STYLE, f"{named(arm.frame)} (frame)"),
        *((lines, _JOINT_STYLE, words) for symbol, (lines, words) in _JOINTS.items() if symbol in shown),
    ]
    return [(Line2D([], [], **_marker(lines, size=0.8), **style), words) for lines, style, words in symbols]
