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

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kinetostat.analysis.sweeping.sweep import Distribution, Sweep

__all__ = ["histogram_figure"]

_ALONE = (5.2, 2.8)  # in, of a panel that is the only one
_BESIDE, _HEIGHT = 2, 1.6  # panels side by side; in, of each
_BETWEEN = 0.62  # in, from one row of panels to the next: tick labels and the label of the axis
_BINS = 40
_MOST = 12  # panels of a figure
_BARS: dict[str, Any] = {"facecolor": BLUE, "edgecolor": "none"}
_MEDIAN: dict[str, Any] = {"color": VERMILION, "linewidth": 1.6}
_ENDS: dict[str, Any] = {"color": VERMILION, "linewidth": 1.1, "linestyle": (0, (4, 2))}
_MEAN: dict[str, Any] = {"color": INK, "linewidth": 1.1, "linestyle": (0, (1, 1.5))}


def histogram_figure(result: Sweep) -> Figure:
    """Return the histogram of each measure, the first twelve columns of them, with mean, median, 5 and 95 %."""
    columns = [one for one in result.measures.values() if len(one.histogram(1).counts)]
    shown = columns[:_MOST]
    with house_style():
        figure, panels = _panels(max(1, len(shown)), _title(result), _lines(result, len(columns)))
        for ax, one in zip(panels, shown, strict=False):
            _draw(ax, one)
        if not shown:
            panels[0].set_axis_off()
            panels[0].text(0.5, 0.5, "no measure is a number anywhere", ha="center")
        return figure


def _title(result: Sweep) -> str:
    return f"{named(result.velocity.of)} in {result.count:,} configurations"


def _lines(result: Sweep, columns: int) -> list[str]:
    """Return what is to be said above the panels."""
    lines = [f"{result.source_label}; relative to {named(result.velocity.relative_to)}"]
    if not result.complete:
        lines.append(f"partial: interrupted before all {result.requested:,}")
    if columns > _MOST:
        lines.append(f"the first {_MOST} of {columns} columns")
    return lines


def _panels(count: int, title: str, lines: Sequence[str]) -> tuple[Figure, list[Any]]:
    """Return a sheet with so many panels, row by row."""
    if count == 1:
        return sheet([_ALONE], title, lines, [_entries()])
    rows = -(-count // _BESIDE)
    width, tall = (WIDTH - MARGINS - GAP) / _BESIDE, rows * _HEIGHT + (rows - 1) * _BETWEEN
    figure, stacks = sheet([(width, tall)] * _BESIDE, title, lines, [_entries()])
    panels = []
    for place in range(count):
        row, column = divmod(place, _BESIDE)
        box = stacks[column].get_position()
        share = box.height / tall
        low = box.y1 - ((row + 1) * _HEIGHT + row * _BETWEEN) * share
        panels.append(figure.add_axes((box.x0, low, box.width, _HEIGHT * share)))
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
    unit = "" if one.unit in ("", "1") else f" [{one.unit}]"
    ax.set_xlabel(f"{named(one.column.name, 30)}{unit}", labelpad=2)
    ax.set_ylabel("share [%]", labelpad=2)
    found = one.histogram(_BINS)
    edges = found.edges
    if edges[0] == edges[-1]:
        ax.set(xticks=[], yticks=[])
        ax.text(0.5, 0.5, f"{float(edges[0]):.4g} everywhere", ha="center", va="center", transform=ax.transAxes)
        return
    ax.stairs(100 * found.counts / np.sum(found.counts), edges, fill=True, label="bars", **_BARS)
    marks = [(one.mean, "mean", _MEAN), *((one.quantile(p), f"{p:g}", _ENDS) for p in (0.05, 0.95))]
    for value, label, style in [*marks, (one.quantile(0.5), "0.5", _MEDIAN)]:
        if np.isfinite(value):
            ax.axvline(value, label=label, **style)
    low, high = float(edges[0]), float(edges[-1])
    room = 0.02 * (high - low)
    ax.set_xlim(low - room, high + room)
    ax.set_ylim(bottom=0)
    ax.locator_params(axis="x", nbins=5)
    ax.xaxis.set_major_formatter("{x:g}")
    ax.grid(visible=True, axis="y")
