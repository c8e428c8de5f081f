"""The figure of a sweep: how often each measure has which value."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.sweeping.accumulators import ACCURACY
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

__all__ = [
    "MEDIAN",
    "MOST",
    "bars_entry",
    "draw_histogram",
    "heading",
    "histogram_figure",
    "line_entry",
    "panel_sheet",
    "same_everywhere",
    "shown_title",
    "worth_drawing",
]

_ALONE = (5.2, 2.8)  # in, of a panel that is the only one
_BESIDE, _HEIGHT = 2, 1.6  # panels side by side; in, of each
_BETWEEN = 0.62  # in, from one row of panels to the next: tick labels and the label of the axis
_BINS = 40
_TOLD_APART = 4 * ACCURACY  # of the largest value: what differs by less has one value, as far as bins tell
_LONGEST, _SHORTEST = 40, 10  # characters of a title, and of the part of a measure in it
MOST = 12  # panels of a figure
_BARS: dict[str, Any] = {"facecolor": BLUE, "edgecolor": "none"}
MEDIAN: dict[str, Any] = {"color": VERMILION, "linewidth": 1.6}
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
    """Return the columns that have several values, beyond what rounding makes."""
    return [one for one in result.measures.values() if _varies(one)]


def _varies(one: Distribution) -> bool:
    if one.minimum is None or one.maximum is None:
        return False
    low, high = one.minimum.value, one.maximum.value
    return high - low > _TOLD_APART * max(abs(low), abs(high)) and len(one.histogram().counts) > 1


def heading(result: Sweep, columns: Sequence[Distribution]) -> tuple[str, list[str]]:
    """Return the title, and what is to be said above the panels of so many columns."""
    lines = [f"{result.source.label}; relative to {named(result.velocity.relative_to)}"]
    if not result.complete:
        lines.append(f"partial: interrupted before all {result.requested:,}")
    if len(columns) > MOST:
        lines.append(f"the first {MOST} of {len(columns)} columns")
    lines += same_everywhere([one for one in result.measures.values() if one not in columns])
    return f"{named(result.velocity.of)} in {result.count:,} configurations", lines


def same_everywhere(columns: Sequence[Distribution]) -> list[str]:
    """Return a line that tells of columns with one value, if there are any."""
    more = f" and {len(columns) - 3} more" if len(columns) > 3 else ""
    return [f"the same everywhere: {', '.join(map(_said, columns[:3]))}{more}"] if columns else []


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
    return [
        bars_entry(),
        line_entry("median", MEDIAN),
        line_entry("5 % and 95 %", _ENDS),
        line_entry("mean", _MEAN),
    ]


def bars_entry() -> Entry:
    """Return the legend entry of the bars."""
    from matplotlib.patches import Patch

    return Patch(**_BARS), "share of the configurations"


def line_entry(words: str, style: dict[str, Any]) -> Entry:
    """Return the legend entry of a line across the bars."""
    from matplotlib.lines import Line2D

    return Line2D([], [], **style), words


def _draw(ax: Any, one: Distribution) -> None:
    marks = [(one.mean, "mean", _MEAN), *((one.quantile(p), f"{p:g}", _ENDS) for p in (0.05, 0.95))]
    draw_histogram(ax, one, [*marks, (one.quantile(0.5), "0.5", MEDIAN)])


def draw_histogram(ax: Any, one: Distribution, marks: Sequence[tuple[float, str, dict[str, Any]]]) -> None:
    """Draw a column's histogram with lines across it: value, label, style; those that are no number are left out."""
    shown = reading(one.column)
    ax.set_xlabel(shown_title(one), labelpad=2)
    ax.set_ylabel("share [%]", labelpad=2)
    found = one.histogram(_BINS)
    edges = shown.factor * found.edges
    ax.stairs(100 * found.counts / np.sum(found.counts), edges, fill=True, label="bars", **_BARS)
    for value, label, style in marks:
        if np.isfinite(value):
            ax.axvline(shown.factor * value, label=label, **style)
    low, high = float(edges[0]), float(edges[-1])
    room = 0.02 * (high - low)
    ax.set_xlim(low - room, high + room)
    ax.set_ylim(bottom=0)
    ax.locator_params(axis="x", nbins=5)
    ax.xaxis.set_major_formatter("{x:g}")
    ax.grid(visible=True, axis="y")
