"""The figure of a trajectory: time lines of positions, indices, speeds and what is used of limits, below each other."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.trajectory.spans import runs
from kinetostat.conventions import Array, Flags
from kinetostat.report.figures.sheet import BLUE, GREY, INK, PURPLE, SKY, VERMILION, Entry, house_style, named, sheet
from kinetostat.report.trajectory import asked_notes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kinetostat.analysis.trajectory.trajectory import Trajectory
    from kinetostat.report.trajectory_rows import FileRows

__all__ = ["timeline_figure"]

_Draw = Callable[[Any, Array, "Trajectory", bool], None]

_WIDE, _TALL, _BETWEEN = 5.6, 1.25, 0.2  # in, of a panel, and between them
_MOST = 10  # joints with a line of their own
_BINS = 1500  # parts of a line: in each, the least and the largest of many samples are drawn
_FLOOR = 1e-6  # of s_r / s_1: below it a logarithm shows rounding
_COLOURS = (BLUE, VERMILION, "#009e73", PURPLE, SKY, "#b8860b", INK, "#7f5539", "#e377c2", GREY)
_NEAR: dict[str, Any] = {"facecolor": "#f3dcc4", "edgecolor": "#f3dcc4", "linewidth": 0.8, "zorder": 0}
_BEYOND: dict[str, Any] = {"facecolor": "#f2b8b0", "edgecolor": "#f2b8b0", "linewidth": 0.8, "zorder": 0.5}
_LOST: dict[str, Any] = {"color": INK, "linestyle": "", "marker": "x", "markersize": 4, "markeredgewidth": 0.9}
_LIMIT: dict[str, Any] = {"linewidth": 0.9, "linestyle": (0, (1, 1.5))}
_LINE: dict[str, Any] = {"linewidth": 1.3}


def timeline_figure(result: Trajectory, rows: FileRows, degrees: bool = False) -> Figure:
    """Return joint positions, singular values, tool speed, used velocity and effort limits against time (or rows).

    Stretches near a singular configuration are shaded, and those beyond a limit in the panel of its kind; a cross marks
    where rows of the file are left out. Of many samples the least and the largest of each small part are drawn, so that
    none that sticks out is lost.

    Args:
        result: what to draw.
        rows: which rows of the file the samples are.
        degrees: show angles in degrees, not in rad.
    """
    turning = result.joints.turning[:_MOST]
    draws: list[_Draw] = ([_angles] if any(turning) else []) + ([] if all(turning) else [_slides])
    draws.append(_indices)
    draws += [] if result.tool_speed is None else [_speeds]
    draws += [] if result.speed_use is None or np.all(np.isnan(result.speed_use)) else [_speed_limits]
    draws += [] if result.effort_use is None or np.all(np.isnan(result.effort_use)) else [_efforts]
    x = rows.numbers.astype(np.float64) if result.time is None else result.time
    with house_style():
        height = len(draws) * _TALL + (len(draws) - 1) * _BETWEEN
        title = f"{named(result.velocity.of)} on a trajectory"
        figure, (whole,) = sheet([(_WIDE, height)], title, _lines(result), _legends(result, rows), beside=0.25)
        panels = _panels(whole, len(draws), height)
        for ax, draw in zip(panels, draws, strict=True):
            _shade(ax, x, _covered(len(x), [(span.first, span.last) for span in result.spans]), _NEAR)
            _shade(ax, x, _beyond(result, draw), _BEYOND)
            draw(ax, x, result, degrees)
            ax.grid(visible=True)
            ax.set_xlim(x[0], x[-1] if x[-1] > x[0] else x[0] + 1)
            ax.tick_params(labelbottom=ax is panels[-1])
        _mark_lost(panels[0], x, rows)
        figure.align_ylabels(panels)
        panels[-1].set_xlabel("row of the file" if result.time is None else "time [s]")
        return figure


def _panels(whole: Any, count: int, height: float) -> list[Any]:
    """Return panels below each other in the place of one."""
    figure, box = whole.figure, whole.get_position()
    whole.remove()
    inch = box.height / height
    tops = [box.y1 - i * (_TALL + _BETWEEN) * inch for i in range(count)]
    return [figure.add_axes((box.x0, top - _TALL * inch, box.width, _TALL * inch)) for top in tops]


def _lines(result: Trajectory) -> list[str]:
    """Return what is to be said above the panels."""
    task, said = result.mechanism.task, f"relative to {named(result.velocity.relative_to)}, {len(result.q)} samples"
    rows = f"rows that count: {' '.join(task.row_names)}"
    if result.length is not None:
        rows += f"; lengths in units of {result.length:.3g} m"
    clipped = float(np.min(result.inverse_condition_number)) < _FLOOR
    floor = [f"smallest / largest is drawn as {_FLOOR:g} where it is less"] if clipped else []
    return [said, rows, *floor, *asked_notes(result)]


def _legends(result: Trajectory, rows: FileRows) -> list[list[Entry]]:
    """Return the joints' lines on the left; on the right what else is drawn."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    drawn = result.columns[:_MOST]
    left: list[Entry] = [(Line2D([], [], color=_colour(i), **_LINE), named(name, 40)) for i, name in enumerate(drawn)]
    if len(result.columns) > _MOST:
        left.append((Line2D([], [], alpha=0), f"and {len(result.columns) - _MOST} more, not drawn"))
    right: list[Entry] = [(Line2D([], [], color=INK, **_LIMIT), "limit, or threshold")]
    if result.spans:
        right.append((Patch(**_NEAR), f"near singular: smallest / largest\nsingular value below {result.near:g}"))
    if result.violations:
        right.append((Patch(**_BEYOND), "beyond a limit"))
    if rows.bad:
        right.append((Line2D([], [], **_LOST), f"rows left out: {len(rows.bad)}"))
    return [left, right]


def _colour(joint: int) -> str:
    return _COLOURS[joint % len(_COLOURS)]


# --- bands and marks -------------------------------------------------------------------------------------------


def _covered(count: int, stretches: Sequence[tuple[int, int]]) -> Flags:
    """Return which of so many samples lie in stretches, first and last included. (m,)."""
    flags = np.zeros(count, dtype=bool)
    for first, last in stretches:
        flags[first : last + 1] = True
    return flags


def _beyond(result: Trajectory, draw: _Draw) -> Flags:
    """Return which samples are beyond a limit of the kind that a panel shows. (m,)."""
    kinds: dict[_Draw, str] = {_angles: "position", _slides: "position", _speed_limits: "velocity", _efforts: "effort"}
    kind = kinds.get(draw)
    turns = dict(zip(result.columns, result.joints.turning, strict=True))
    found = [one for one in result.violations if one.kind == kind]
    if kind == "position":
        found = [one for one in found if turns[one.joint] == (draw is _angles)]
    return _covered(len(result.q), [(one.first, one.last) for one in found])


def _shade(ax: Any, x: Array, flags: Flags, style: dict[str, Any]) -> None:
    """Shade the stretches of samples that are flagged; those that no eye can tell apart as one."""
    apart, merged = float(x[-1] - x[0]) / _BINS, list[tuple[int, int]]()
    for first, last in runs(flags):
        if merged and x[first] - x[merged[-1][1]] < apart:
            merged[-1] = (merged[-1][0], last)
        else:
            merged.append((first, last))
    for first, last in merged:
        ax.axvspan(x[first], x[last], **style)


def _mark_lost(ax: Any, x: Array, rows: FileRows) -> None:
    """Mark above a panel where rows of the file are left out: by the samples that they stood between."""
    if not rows.bad:
        return
    lost = np.interp([one.row for one in rows.bad], rows.numbers, x)
    width = float(x[-1] - x[0]) / _BINS or 1.0
    _, first = np.unique(np.round((lost - x[0]) / width), return_index=True)
    shown = lost[first]
    ax.plot(shown, np.full(len(shown), 1.04), transform=ax.get_xaxis_transform(), clip_on=False, **_LOST)


# --- panels ----------------------------------------------------------------------------------------------------


def _angles(ax: Any, x: Array, result: Trajectory, degrees: bool) -> None:
    """Draw the positions of joints that turn."""
    turning = [i for i, turns in enumerate(result.joints.turning[:_MOST]) if turns]
    _positions(ax, x, result, turning, 180 / math.pi if degrees else 1.0)
    ax.set_ylabel(f"position [{'deg' if degrees else 'rad'}]", labelpad=2)


def _slides(ax: Any, x: Array, result: Trajectory, degrees: bool) -> None:  # noqa: ARG001 (panels are drawn alike)
    """Draw the positions of joints that slide."""
    sliding = [i for i, turns in enumerate(result.joints.turning[:_MOST]) if not turns]
    _positions(ax, x, result, sliding, 1.0)
    ax.set_ylabel("position [m]", labelpad=2)


def _positions(ax: Any, x: Array, result: Trajectory, joints: Sequence[int], factor: float) -> None:
    """Draw joint positions, with those limits that are not far from them."""
    values = result.q[:, joints] * factor
    low, high = float(values.min()), float(values.max())
    margin = 0.12 * (high - low) or 0.1
    for i, column in zip(joints, values.T, strict=True):
        ax.plot(*_thinned(x, column), color=_colour(i), **_LINE)
    for i in joints:
        for end in (float(ends[i]) * factor for ends in result.joints.stated_limits):
            if low - margin <= end <= high + margin:
                ax.axhline(end, color=_colour(i), **_LIMIT)
    ax.set_ylim(low - margin, high + margin)


def _indices(ax: Any, x: Array, result: Trajectory, degrees: bool) -> None:  # noqa: ARG001 (panels are drawn alike)
    """Draw smallest over largest singular value by its logarithm."""
    values = np.maximum(result.inverse_condition_number, _FLOOR)
    ax.semilogy(*_thinned(x, values), color=INK, **_LINE)
    ax.axhline(result.near, color=INK, **_LIMIT)
    low = min(float(values.min()), result.near) / 2
    ax.set_ylim(low, min(1.0, 2 * max(float(values.max()), result.near)))
    ax.yaxis.set_major_formatter("{x:g}")
    ax.yaxis.set_minor_formatter("")
    ax.set_ylabel("smallest / largest", labelpad=2)


def _speeds(ax: Any, x: Array, result: Trajectory, degrees: bool) -> None:
    """Draw the tool's speed, and on the right the speed at which it turns."""
    if result.tool_speed is None or result.turning_speed is None:
        return
    angle, factor = ("deg", 180 / math.pi) if degrees else ("rad", 1.0)
    beside = ax.twinx()
    for axis, values, colour, label in (
        (ax, result.tool_speed, BLUE, "tool speed [m/s]"),
        (beside, result.turning_speed * factor, VERMILION, f"turning [{angle}/s]"),
    ):
        axis.plot(*_thinned(x, values), color=colour, **_LINE)
        axis.set_ylim(0, 1.12 * float(values.max()) or 1.0)
        axis.set_ylabel(label, labelpad=2, color=colour)


def _speed_limits(ax: Any, x: Array, result: Trajectory, degrees: bool) -> None:  # noqa: ARG001 (drawn alike)
    """Draw the share of each joint's velocity limit that each step takes."""
    if result.speed_use is not None:
        _shares(ax, (x[1:] + x[:-1]) / 2, result.speed_use, "velocity limit [%]")


def _efforts(ax: Any, x: Array, result: Trajectory, degrees: bool) -> None:  # noqa: ARG001 (panels are drawn alike)
    """Draw the share of each joint's effort limit that holding still takes."""
    if result.effort_use is not None:
        _shares(ax, x, result.effort_use, "static effort [%]")


def _shares(ax: Any, x: Array, shares: Array, label: str) -> None:
    """Draw shares of limits in percent, with a line where all of it is used. (m,), (m, n)."""
    values = 100 * shares[:, :_MOST]
    for i, column in enumerate(values.T):
        if not np.all(np.isnan(column)):
            ax.plot(*_thinned(x, column), color=_colour(i), **_LINE)
    top = 1.12 * float(np.nanmax(values, initial=0.0)) or 1.0
    if top > 80:
        top = max(top, 112)
        ax.axhline(100, color=INK, **_LIMIT)
    ax.set_ylim(0, top)
    ax.set_ylabel(label, labelpad=2)


def _thinned(x: Array, y: Array) -> tuple[Array, Array]:
    """Return a line's points; of many, the least and the largest of each part, in their order. (m,), (m,)."""
    if len(x) <= 2 * _BINS:
        return x, y
    edges = np.linspace(0, len(x), _BINS + 1).astype(np.int64)
    filled = np.where(np.isnan(y), 0.0, y)
    chosen = np.zeros(len(x), dtype=bool)
    for start, stop in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        part = filled[start:stop]
        chosen[[start + int(np.argmin(part)), start + int(np.argmax(part))]] = True
    chosen[[0, -1]] = True
    return x[chosen], y[chosen]
