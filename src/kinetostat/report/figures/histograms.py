"""The figure of a sweep: how often each measure has which value."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.report.figures.sheet import (
    BLUE,
    GAP,
    INK,
    MARGINS,
    VERMILION,
    WIDTH,
    Entry,
    house_style,
    named,
    sheet,
)
from kinetostat.report.measured import reading

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kinetostat.analysis.sweeping.sweep import Distribution, Sweep

__all__ = ["MOST", "heading", "histogram_figure", "panel_sheet", "shown_title", "worth_drawing"]

_ALONE = (5.2, 2.8)  # in, of a panel that is the only one
_BESIDE, _HEIGHT = 2, 1.6  # panels side by side; in, of each
_BETWEEN = 0.62  # in, from one row of panels to the next: tick labels and the label of the axis
_BINS = 40
_LONGEST, _SHORTEST = 40, 10  # characters of a title, and of the part of a measure in it
MOST = 12  # panels of a figure
_BARS: dict[str, Any] = {"facecolor": BLUE, "edgecolor": "none"}
_MEDIAN: dict[str, Any] = {"color": VERMILION, "linewidth": 1.6}
_ENDS: dict[str, Any] = {"color": VERMILION, "linewidth": 1.1, "linestyle": (0, (4, 2))}
_MEAN: dict[str, Any] = {"color": INK, "linewidth": 1.1, "linestyle": (0, (1, 1.5))}


def histogram_figure(result: Sweep) -> Figure:
    """Return the histogram of each measure, the first twelve columns that vary, with mean, median, 5 and 95 %."""
    columns = worth_drawing(result)
    shown = columns[:MOST]
    with house_style():
        figure, panels = _panels(max(1, len(shown)), *heading(result, columns))
        for ax, one in zip(panels, shown, strict=False):
            _draw(ax, one)
        if not shown:
            panels[0].set_axis_off()
            panels[0].text(0.5, 0.5, "no measure has several values", ha="center")
        return figure


def worth_drawing(result: Sweep) -> list[Distribution]:
    """Return the columns that have several values."""
    return [one for one in result.measures.values() if len(one.histogram().counts) > 1]


def heading(result: Sweep, columns: Sequence[Distribution]) -> tuple[str, list[str]]:
    """Return the title, and what is to be said above the panels of so many columns."""
    lines = [f"{result.source.label}; relative to {named(result.velocity.relative_to)}"]
    if not result.complete:
        lines.append(f"partial: interrupted before all {result.requested:,}")
    if len(columns) > MOST:
        lines.append(f"the first {MOST} of {len(columns)} columns")
    if left := [one for one in result.measures.values() if one not in columns]:
        more = f" and {len(left) - 3} more" if len(left) > 3 else ""
        lines.append(f"the same everywhere: {', '.join(map(_said, left[:3]))}{more}")
    return f"{named(result.velocity.of)} in {result.count:,} configurations", lines


def shown_title(one: Distribution) -> str:
    """Return a column's name in words with its unit; the part of its measure is cut where it is long."""
    shown = reading(one.column)
    unit = shown.title.removeprefix(shown.name)
    room = max(_SHORTEST, _LONGEST - len(shown.measure) - len(unit))
    return f"{shown.measure}{' ' if shown.part else ''}{named(shown.part, room)}{unit}"


def _said(one: Distribution) -> str:
    shown = reading(one.column)
    value = "no number" if one.minimum is None else f"{shown.factor * one.minimum.value:.4g}"
    return f"{shown.measure}{' ' if shown.part else ''}{named(shown.part)} {value}"


def _panels(count: int, title: str, lines: Sequence[str]) -> tuple[Figure, list[Any]]:
    """Return a sheet with so many panels."""
    if count == 1:
        return sheet([_ALONE], title, lines, [_entries()])
    width = (WIDTH - MARGINS - GAP) / _BESIDE
    return panel_sheet(count, (width, _HEIGHT), _BETWEEN, title, lines, _entries())


def panel_sheet(
    count: int,
    size: tuple[float, float],
    between: float,
    title: str,
    lines: Sequence[str],
    entries: Sequence[Entry],
    beside: float = 0.0,
) -> tuple[Figure, list[Any]]:
    """Return a sheet with so many panels of a size, row by row, two of them side by side; all in inches."""
    rows = -(-count // _BESIDE)
    wide, high = size
    tall = rows * high + (rows - 1) * between
    figure, stacks = sheet([(wide, tall)] * _BESIDE, title, lines, [entries], beside)
    panels = []
    for place in range(count):
        row, column = divmod(place, _BESIDE)
        box = stacks[column].get_position()
        share = box.height / tall
        low = box.y1 - ((row + 1) * high + row * between) * share
        panels.append(figure.add_axes((box.x0, low, box.width, high * share)))
    for stack in stacks:
        stack.remove()
    return figure, panels


def _entries() -> list[Entry]:
    """Return the legend."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    return [
        (Patch(**_BARS), "share of the configurations"),
        (Line2D([], [], **_MEDIAN), "median"),
        (Line2D([], [], **_ENDS), "5 % and 95 %"),
        (Line2D([], [], **_MEAN), "mean"),
    ]


def _draw(ax: Any, one: Distribution) -> None:
    shown = reading(one.column)
    ax.set_xlabel(shown_title(one), labelpad=2)
    ax.set_ylabel("share [%]", labelpad=2)
    found = one.histogram(_BINS)
    edges = shown.factor * found.edges
    ax.stairs(100 * found.counts / np.sum(found.counts), edges, fill=True, label="bars", **_BARS)
    marks = [(one.mean, "mean", _MEAN), *((one.quantile(p), f"{p:g}", _ENDS) for p in (0.05, 0.95))]
    for value, label, style in [*marks, (one.quantile(0.5), "0.5", _MEDIAN)]:
        if np.isfinite(value):
            ax.axvline(shown.factor * value, label=label, **style)
    low, high = float(edges[0]), float(edges[-1])
    room = 0.02 * (high - low)
    ax.set_xlim(low - room, high + room)
    ax.set_ylim(bottom=0)
    ax.locator_params(axis="x", nbins=5)
    ax.xaxis.set_major_formatter("{x:g}")
    ax.grid(visible=True, axis="y")
