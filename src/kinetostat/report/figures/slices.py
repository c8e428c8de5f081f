"""The figure of the smallest singular value over two joints."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.conventions import Array
from kinetostat.report.figures.sheet import (
    BAR_ROOM,
    INK,
    VERMILION,
    Entry,
    cased,
    colour_bar,
    colouring,
    house_style,
    named,
    sheet,
    text_width,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kinetostat.analysis.singular.slices import Mark, Slice

__all__ = ["slice_figure"]

_PANEL = 4.7  # in, a square
_CURVE: dict[str, Any] = {"color": VERMILION, "linewidth": 2.0}
_OUTSIDE: dict[str, Any] = {"color": VERMILION, "linewidth": 1.3, "linestyle": (0, (4, 2.2))}
_HELD: dict[str, Any] = {"marker": "o", "markersize": 6, "linestyle": "none"}
_HELD |= {"markerfacecolor": "white", "markeredgecolor": INK}


def slice_figure(slice_: Slice, degrees: bool = False) -> Figure:
    """Return the smallest singular value over two joints as a map, with the singular curves on it.

    Args:
        slice_: what to draw.
        degrees: show angles in degrees, not in rad.
    """
    units = ["deg" if degrees and unit == "rad" else unit for unit in slice_.units]
    factors = np.array([180 / math.pi if unit == "deg" else 1.0 for unit in units])
    x, y = slice_.x * factors[0], slice_.y * factors[1]
    title = f"singularities over {named(slice_.joints[0])} and {named(slice_.joints[1])}"
    line = "smallest singular value of the length-scaled Jacobian; every other joint is held"
    with house_style():
        figure, (ax,) = sheet([(_PANEL, _PANEL)], title, [line], [_entries(slice_)], BAR_ROOM)
        colour_bar(ax, ax.pcolormesh(x, y, slice_.smallest, **colouring(slice_.smallest), rasterized=True))
        ax.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
        if _changes_sign(slice_):
            cased(ax.contour(x, y, slice_.signed, levels=[0.0], colors=VERMILION, linewidths=2.0, zorder=3))
        _draw_limits(ax, np.array(slice_.limits).T * factors)
        held = np.array(slice_.at) * factors
        cased(ax.plot(*held, **_HELD, zorder=8)[0])
        _draw_marks(ax, slice_.marks, factors, held)
        for axis, joint, unit in zip((ax.xaxis, ax.yaxis), slice_.joints, units, strict=True):
            _angle_ticks(axis, unit)
            axis.set_label_text(f"{named(joint, 40)} [{unit}]")
        return figure


def _changes_sign(slice_: Slice) -> bool:
    """Tell whether there is a curve to follow: not where all is singular, where the sign is rounding's."""
    if slice_.signed is None or not np.nanmax(slice_.smallest) > 1e-9:
        return False
    return bool(np.nanmin(slice_.signed) < 0 < np.nanmax(slice_.signed))


def _entries(slice_: Slice) -> list[Entry]:
    """Return legend entries for what a slice shows."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries = list[Entry]()
    if _changes_sign(slice_) or any(mark.inside for mark in slice_.marks):
        entries.append((Line2D([], [], **_CURVE), "singular"))
    if any(not mark.inside for mark in slice_.marks):
        entries.append((Line2D([], [], **_OUTSIDE), "singular, with a joint outside its limits"))
    if any(low > x[0] or high < x[-1] for (low, high), x in zip(slice_.limits, (slice_.x, slice_.y), strict=True)):
        entries.append((Patch(facecolor="#d6d6d6", edgecolor="none"), "pale: outside the limits of these two joints"))
    return [*entries, (Line2D([], [], **_HELD), "the configuration in which the other joints are held")]


# --- axes


def _draw_limits(ax: Any, limits: Array) -> None:
    """Draw the limits, (2, 2) with the lower ones first, as a frame, and a veil over what is outside."""
    from matplotlib.patches import PathPatch, Rectangle
    from matplotlib.path import Path

    seen = np.array([ax.get_xlim(), ax.get_ylim()]).T
    inside = np.clip(limits, seen[0], seen[1])
    hole = Path(_corners(inside)[::-1], closed=True)  # wound the other way round
    veil = Path.make_compound_path(Path(_corners(seen), closed=True), hole)
    ax.add_patch(PathPatch(veil, facecolor="white", alpha=0.6, linewidth=0, zorder=4, label="outside limits"))
    style: dict[str, Any] = {"fill": False, "edgecolor": INK, "linewidth": 1.1, "zorder": 5, "label": "limits"}
    frame = Rectangle((inside[0, 0], inside[0, 1]), *(inside[1] - inside[0]), **style)
    cased(ax.add_patch(frame))


def _corners(box: Array) -> Array:
    """Return the corners (5, 2) of a box (2, 2), counter-clockwise, the first one again at the end."""
    (left, low), (right, high) = box
    return np.array([(left, low), (right, low), (right, high), (left, high), (left, low)])


def _angle_ticks(axis: Any, unit: str) -> None:
    """Set ticks at multiples of half of pi, or of 45 or 90 degrees, where the range is more than half a turn."""
    from matplotlib.ticker import FuncFormatter, MultipleLocator

    low, high = axis.get_view_interval()
    half_turn = 180.0 if unit == "deg" else math.pi
    if unit == "m" or high - low <= half_turn * (1 + 1e-9):
        return
    quarters = max(1, math.ceil((high - low) / (4 * half_turn)))
    axis.set_major_locator(MultipleLocator(quarters * half_turn / 2))
    if unit == "rad":
        axis.set_major_formatter(FuncFormatter(lambda value, _: _in_pi(value)))


def _in_pi(value: float) -> str:
    """Return a multiple of half of pi in words: 0, π/2, -3π/2, 2π."""
    halves = round(2 * value / math.pi)
    count, over = (halves, "/2") if halves % 2 else (halves // 2, "")
    factor = {1: "", -1: "-"}.get(count, str(count))
    return f"{factor}π{over}" if halves else "0"


# --- families and their labels: places are in inches in the panel


def _draw_marks(ax: Any, marks: Sequence[Mark], factors: Array, held: Array) -> None:
    """Draw families as lines and points, and write their labels where they cover no other."""
    low, high = np.array([ax.get_xlim(), ax.get_ylim()]).T
    inches = _PANEL / (high - low)
    taken = [_around((held - low) * inches, np.array([0.2, 0.2]))]
    for mark in marks:
        at = np.array([mark.x, mark.y], dtype=np.float64) * factors  # nan: anywhere
        if np.any((at < low) | (at > high)):
            continue
        style = _CURVE if mark.inside else _OUTSIDE
        if mark.y is None:
            cased(ax.axvline(at[0], **style, zorder=6))
        elif mark.x is None:
            cased(ax.axhline(at[1], **style, zorder=6))
        else:
            cased(ax.plot(*at, marker="D", markersize=6, color=style["color"], linestyle="none", zorder=7)[0])
            taken.append(_around((at - low) * inches, np.array([0.15, 0.15])))
        _write_label(ax, named(mark.label, 40), (at - low) * inches, taken)


def _around(middle: Array, size: Array) -> Array:
    """Return the lower and the upper corner (2, 2) of a box."""
    return np.array([middle - size / 2, middle + size / 2])


def _write_label(ax: Any, label: str, mark: Array, taken: list[Array]) -> None:
    """Write a label on its line, or beside its point, at the first place that is free, else at the last; take it."""
    upright, wide = bool(np.isnan(mark[1])), text_width(label) + 0.08
    size = np.array([0.19, wide] if upright else [wide, 0.19])
    boxes = [_around(np.clip(place, size / 2, _PANEL - size / 2), size) for place in _places(mark, size)]
    free = (box for box in boxes if all(np.any((box[1] < other[0]) | (other[1] < box[0])) for other in taken))
    taken.append(next(free, boxes[-1]))
    frame = {"boxstyle": "round,pad=0.18", "facecolor": "white", "edgecolor": "none", "alpha": 0.88}
    text = {"ha": "center", "va": "center", "fontsize": 8, "color": INK, "rotation": 90 if upright else 0}
    ax.text(*taken[-1].mean(axis=0) / _PANEL, label, **text, bbox=frame, zorder=9, transform=ax.transAxes)


def _places(mark: Array, size: Array) -> list[Array]:
    """Return places for a label's middle, the best first."""
    if np.isnan(mark).any():
        return [np.where(np.isnan(mark), along, mark) for along in np.linspace(0.86, 0.08, 14) * _PANEL]
    sides = ((1, 1), (-1, 1), (1, -1), (-1, -1), (0, 2), (0, -2))
    return [mark + (size / 2 + (0.12, 0.09)) * side for side in sides]
