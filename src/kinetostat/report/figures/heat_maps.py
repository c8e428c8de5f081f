"""The figure of a grid of two joints: each measure as a map over them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from kinetostat.analysis.sweeping.samples import GridSource, Source
from kinetostat.conventions import Array
from kinetostat.report.figures.histograms import MOST, heading, panel_sheet, shown_title, worth_drawing
from kinetostat.report.figures.sheet import BAR_ROOM, INK, VERMILION, Entry, cased, house_style, named, sheet
from kinetostat.report.measured import reading

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kinetostat.analysis.sweeping.sweep import Sweep

__all__ = ["MOST_POINTS", "axes_of_map", "heat_map_figure", "is_map"]

MOST_POINTS = 1_000_000  # of a grid that is drawn: more are finer than any page
_ALONE, _SIZE, _BETWEEN = (4.4, 4.0), (2.35, 2.1), 0.85  # in: of a panel alone, of each, from one row to the next
_BAR, _BAR_GAP = 0.12, 0.08  # in: width of a colour bar, and its distance to the panel
_SHIFT = 0.4  # in: of the right panels, for the colour bars of the left ones
_LARGEST: dict[str, Any] = {"marker": "o", "markersize": 6, "markerfacecolor": "white", "markeredgecolor": INK}
_SMALLEST: dict[str, Any] = {"marker": "X", "markersize": 7, "markerfacecolor": VERMILION, "markeredgecolor": "white"}


def is_map(source: Source) -> bool:
    """Return whether configurations are a grid of two joints that is not too fine to be drawn."""
    return axes_of_map(source) is not None and source.count <= MOST_POINTS


def axes_of_map(source: Source) -> tuple[int, int] | None:
    """Return which two coordinates of a grid have several values; None where not two have, or it is no grid."""
    several = [j for j, size in enumerate(source.sizes) if size > 1] if isinstance(source, GridSource) else []
    return (several[0], several[1]) if len(several) == 2 else None


def heat_map_figure(result: Sweep, values: Array, degrees: bool = False) -> Figure:
    """Return each measure as a map over the two joints of a grid: the first twelve columns that vary.

    Args:
        result: a complete sweep of a grid that `is_map`.
        values: the measures' columns that have a distribution, row by row: (c, count), as `result.measures`.
        degrees: show angles of joints in degrees.
    """
    from matplotlib.lines import Line2D

    source, axes = result.source, axes_of_map(result.source)
    assert isinstance(source, GridSource)
    assert axes is not None
    first, second = axes
    columns, names = worth_drawing(result), list(result.measures)
    shown = columns[:MOST]
    entries: list[Entry] = [(Line2D([], [], ls="none", **_LARGEST), "where it is largest (the first of equal ones)")]
    entries.append((Line2D([], [], ls="none", **_SMALLEST), "where it is smallest"))
    with house_style():
        if len(shown) < 2:
            figure, panels = sheet([_ALONE], *heading(result, columns), [entries], BAR_ROOM)
        else:
            figure, panels = panel_sheet(len(shown), _SIZE, _BETWEEN, *heading(result, columns), entries, BAR_ROOM)
            _spread(panels)
        for ax, one in zip(panels, shown, strict=False):
            grid = values[names.index(one.column.name)].reshape(source.sizes[first], source.sizes[second])
            units = [_unit(result.units[j], degrees) for j in (first, second)]
            factors = [180 / math.pi if unit == "deg" else 1.0 for unit in units]
            x, y = (source.values(j) * factor for j, factor in zip((first, second), factors, strict=True))
            coloured = ax.pcolormesh(x, y, reading(one.column).factor * grid.T, cmap="cividis", rasterized=True)
            for extreme, style in ((one.maximum, _LARGEST), (one.minimum, _SMALLEST)):
                if extreme is not None:
                    at = extreme.q[[first, second]] * factors
                    cased(ax.plot(*at, ls="none", clip_on=False, zorder=5, **style)[0])
            ax.set_title(shown_title(one), fontsize=8.5, loc="left", pad=4)
            ax.set_xlabel(f"{named(source.names[first], 24)} [{units[0]}]", labelpad=2)
            ax.set_ylabel(f"{named(source.names[second], 24)} [{units[1]}]", labelpad=2)
            ax.locator_params(nbins=5)
            _bar(ax, coloured)
        if not shown:
            panels[0].set_axis_off()
            panels[0].text(0.5, 0.5, "no measure has several values", ha="center")
        return figure


def _unit(unit: str, degrees: bool) -> str:
    return "deg" if degrees and unit == "rad" else unit


def _spread(panels: list[Any]) -> None:
    """Leave room for the colour bar of the left panels."""
    width = float(panels[0].figure.get_size_inches()[0])
    for ax in panels[1::2]:
        box = ax.get_position()
        ax.set_position((box.x0 + _SHIFT / width, box.y0, box.width, box.height))


def _bar(ax: Any, coloured: Any) -> None:
    width, box = float(ax.figure.get_size_inches()[0]), ax.get_position()
    place = ax.figure.add_axes((box.x1 + _BAR_GAP / width, box.y0, _BAR / width, box.height))
    bar = ax.figure.colorbar(coloured, cax=place)
    bar.outline.set_linewidth(0.7)
    bar.ax.locator_params(nbins=5)
    bar.ax.yaxis.set_major_formatter("{x:g}")
