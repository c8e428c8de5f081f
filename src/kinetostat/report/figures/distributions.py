"""The figure of a limb's measures inside limits: how often each has which value, and where the named poses are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.profile.result import LimbPose, LimbProfile
from kinetostat.report.figures.histograms import (
    MEDIAN,
    MOST,
    bars_entry,
    draw_histogram,
    line_entry,
    panel_sheet,
    same_everywhere,
    worth_drawing,
)
from kinetostat.report.figures.names import told_apart
from kinetostat.report.figures.sheet import GAP, INK, MARGINS, VERMILION, WIDTH, Entry, empty_sheet, house_style, named
from kinetostat.report.measured import reading

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kinetostat.analysis.sweeping.result import Distribution, Sweep

__all__ = ["distributions_figure", "varies"]

_HEIGHT, _BETWEEN = 1.5, 0.78  # in, of a panel; from one row of panels to the next
_TENTH: dict[str, Any] = {"color": VERMILION, "linewidth": 1.1, "linestyle": (0, (4, 2))}
_LIMIT: dict[str, Any] = {"color": INK, "linewidth": 1.3}
_EFFORT = "effort_use"
_MARK: dict[str, Any] = {"markersize": 5, "linestyle": "none", "markeredgecolor": "none"}
_LETTERS = "abcdefghijklmnopqrstuvwxyz"
_CLOSE = 0.045  # of a panel's width: letters that are closer stand together
_SHARE = 0.9  # of a panel's height: letters stand above
_BEYOND = 0.25  # of a histogram's width: how far a panel goes to show a pose outside


def distributions_figure(profile: LimbProfile) -> Figure:
    """Return histograms of the limb's measures inside limits, with median and 10 %, and the named poses over them.

    A pose is a letter, told above the panels. One whose value is far outside stands at the edge, with an arrow.
    """
    title = f"{named(profile.limb.name)} inside its limits"
    if profile.sweep is None:
        return empty_sheet(title, [f"{named(left.what, 60)}: {named(left.why, 200)}" for left in profile.left[:3]])
    whole, columns = _whole(profile.sweep), _varying(profile.sweep)
    lines = [f"{profile.sweep.count:,} configurations, {profile.sweep.source.label}"]
    poses = profile.poses[: len(_LETTERS)]
    names = told_apart([pose.name for pose in poses], 20)
    told = [f"{_LETTERS[i]} {names[i]}{_outside(pose)}" for i, pose in enumerate(poses)]
    lines += [f"named poses: {', '.join(told)}"] if poses else []
    lines += same_everywhere([one for one in whole if one not in columns])
    if not columns:
        return empty_sheet(title, [*lines, "no measure has several values"])
    with house_style():
        size = ((WIDTH - MARGINS - GAP) / 2, _HEIGHT)
        figure, panels = panel_sheet(len(columns), size, _BETWEEN, title, lines, _entries(profile.sweep, poses))
        for ax, one in zip(panels, columns, strict=True):
            left, low, wide, high = ax.get_position().bounds
            ax.set_position((left, low, wide, _SHARE * high))
            draw_histogram(ax, one, [(one.quantile(0.1), "0.1", _TENTH), (one.quantile(0.5), "0.5", MEDIAN)])
            if _beyond(profile.sweep) and one.column.measure == _EFFORT:
                ax.axvline(reading(one.column).factor, label="limit", **_LIMIT)
            _mark(ax, one, poses)
        return figure


def varies(profile: LimbProfile) -> bool:
    """Return whether a measure of a limb has several values: else there is nothing that a histogram would show."""
    return profile.sweep is not None and bool(_varying(profile.sweep))


def _whole(sweep: Sweep) -> list[Distribution]:
    """Return the measures that are about the limb, not about a part of it."""
    return [one for one in sweep.measures.values() if not reading(one.column).part]


def _varying(sweep: Sweep) -> list[Distribution]:
    whole = _whole(sweep)
    return [one for one in worth_drawing(sweep) if one in whole][:MOST]


def _beyond(sweep: Sweep) -> float:
    """Return the share of configurations in which the weight asks for more than an effort limit."""
    return next((one.share for one in sweep.above if one.column.name == _EFFORT and one.threshold == 1.0), 0.0)


def _outside(pose: LimbPose) -> str:
    return "" if pose.inside else " (outside limits)"


def _entries(sweep: Sweep, poses: Sequence[LimbPose]) -> list[Entry]:
    """Return the legend."""
    from matplotlib.lines import Line2D

    entries = [bars_entry(), line_entry("median", MEDIAN), line_entry("10 % are below it", _TENTH)]
    if _beyond(sweep):
        entries.append(line_entry(f"an effort limit: {100 * _beyond(sweep):.2g} % are beyond it", _LIMIT))
    if poses:
        entries.append((Line2D([], [], color=INK, marker="v", **_MARK), "named pose"))
    return entries


def _mark(ax: Any, one: Distribution, poses: Sequence[LimbPose]) -> None:
    """Mark the poses above the panel: a letter each, in order, lines leading to those that had to make room."""
    factor = reading(one.column).factor
    values = {_LETTERS[i]: factor * pose.values.get(one.column.name, float("nan")) for i, pose in enumerate(poses)}
    found = sorted((value, letter) for letter, value in values.items() if np.isfinite(value))
    if not found:
        return
    low, high = _widened(ax.get_xlim(), found[0][0], found[-1][0])
    ax.set_xlim(low, high)
    shares = [(min(max(value, low), high) - low) / (high - low) for value, _ in found]
    look: dict[str, Any] = {"transform": ax.get_xaxis_transform(), "clip_on": False, "color": INK}
    for (value, letter), share, place in zip(found, shares, _apart(shares), strict=True):
        at, over = low + share * (high - low), low + place * (high - low)
        marker = "v" if low <= value <= high else "<" if value < low else ">"
        ax.plot([at], [1.035], **_MARK, **look, marker=marker, label=f"pose {letter}")
        if abs(place - share) > 0.01:
            ax.plot([at, over], [1.06, 1.1], **look, linewidth=0.5)
        ax.text(over, 1.1, letter, **look, ha="center", va="bottom", fontsize=7)


def _apart(shares: Sequence[float]) -> list[float]:
    """Return places for letters, in the same order and near where they should be, none on another or far outside."""
    places = list[float]()
    for share in shares:
        places.append(max(share, places[-1] + _CLOSE) if places else share)
    over = max(0.0, places[-1] - max(1.0, shares[-1]))
    for i in reversed(range(len(places))):
        over = min(over, over if i == len(places) - 1 else max(0.0, places[i] + _CLOSE - places[i + 1]))
        places[i] -= over
    return places


def _widened(ends: tuple[float, float], first: float, last: float) -> tuple[float, float]:
    """Return the ends of a panel, wider by a share at most, so that two values are in it if they can be."""
    low, high = ends
    room = _BEYOND * (high - low)
    return max(low - room, min(low, first - 0.1 * room)), min(high + room, max(high, last + 0.1 * room))
