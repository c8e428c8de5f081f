"""The figure of all chains of a fleet: how far each reaches, and how well it moves there."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.conventions import Array
from kinetostat.report.check.words import counted
from kinetostat.report.figures.sheet import (
    BLUE,
    GREY,
    INK,
    PURPLE,
    SKY,
    VERMILION,
    Entry,
    empty_sheet,
    house_style,
    named,
    sheet,
    text_width,
)
from kinetostat.report.fleet.document import ChainRow, FleetDocument
from kinetostat.report.fleet.wording import chain_labels, chains_of, comparable, compared, dexterity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["scatter_figure"]

_TITLE = "how far each chain reaches, and how well it moves there"
_PANEL = np.array([11.4, 4.6])  # in, as wide as a page on a screen
_GROUPS: tuple[tuple[int, str, str, str], ...] = (  # joints up to, in words, mark, colour
    (3, "up to 3 joints", "v", SKY),
    (5, "4 or 5 joints", "s", VERMILION),
    (6, "6 joints", "o", BLUE),
    (7, "7 joints", "D", PURPLE),
    (1_000_000, "8 joints or more", "^", INK),
)
_SPAN: dict[str, Any] = {"color": GREY, "linewidth": 0.7}
_CLOUD = 25  # chains from which on lines are paler
_FEW, _MANY = 0.6, 0.3  # how dark the lines are, of few chains and of more
_DEEP = 100.0  # an axis by logarithm goes down to so small a part of the smallest median; lines end there, with a mark
_NAME = 7.0  # pt
_DECADE = 10.0  # reaches that differ more are shown by logarithm
_CROWDED = 4.0  # and dexterities whose largest is so many times their median
_MARK, _LINE = 0.13, 0.13  # in, the width of a mark, the height of a name
_PLACES = (  # of a name's middle from its mark, in inches beyond half of its own size; the best first
    *((0.08, 0.0), (-0.08, 0.0), (0.03, 0.03), (-0.03, 0.03), (0.03, -0.03), (-0.03, -0.03)),
    *((0.16, 0.14), (-0.16, 0.14), (0.16, -0.14), (-0.16, -0.14), (0.2, 0.3), (-0.2, 0.3), (0.2, -0.3), (-0.2, -0.3)),
    *((0.35, 0.45), (-0.35, 0.45), (0.35, -0.45), (-0.35, -0.45)),
)
_NEAR = 0.1  # in: a name that is farther from its mark has a line to it


@dataclass(frozen=True)
class _Dot:
    """A chain in the picture.

    Attributes:
        chain: which.
        label: what it is called.
        at: its reach in m, and the median of smallest over largest singular value. (2,).
        span: the latter's 10 % and 90 %, perhaps NaN. (2,).
    """

    chain: ChainRow
    label: str
    at: Array
    span: Array


def scatter_figure(document: FleetDocument) -> Figure:
    """Return the chains of a fleet by their reach and their dexterity: a mark each, which leads to its place in a page.

    Dexterity is the median over configurations inside limits of the smallest over the largest singular value; a line
    reaches from 10 to 90 %. Chains are named where there is room, those at the edges of the cloud first.
    """
    dots = list(_dots(document))
    if not dots:
        return empty_sheet(_TITLE, [*_left_out(document, dots), "no chain has both"])
    lines = [
        "median of smallest / largest singular value over configurations inside limits; the line is 10 to 90 %",
        *_left_out(document, dots),
    ]
    if any(dot.span[0] < _bottom(dots) for dot in dots):
        lines[0] += "; where it goes on below, it ends in a triangle"
    with house_style():
        figure, (ax,) = sheet([(float(_PANEL[0]), float(_PANEL[1]))], _TITLE, lines, _entries(dots))
        _axes(ax, dots)
        for dot in dots:
            _, _, mark, colour = _group(dot)
            shade = _FEW if len(dots) <= _CLOUD else _MANY
            ax.plot(dot.at[[0, 0]], dot.span, **_SPAN, alpha=shade, zorder=2, label=f"span of {dot.chain.id}")
            if dot.span[0] < ax.get_ylim()[0]:
                ax.plot(dot.at[0], ax.get_ylim()[0], "v", color=GREY, markersize=3.5, zorder=2, label="cut")
            look: dict[str, Any] = {"markersize": 6, "markeredgecolor": "white", "markeredgewidth": 0.6, "zorder": 3}
            look |= {"url": f"#{dot.chain.id}", "linestyle": "none", "label": dot.chain.id, "clip_on": False}
            ax.plot(*dot.at[:, None], marker=mark, color=colour, **look)
        written = _write_names(ax, dots)
        if written < len(dots):
            told = f"{written} of {len(dots)} are named; others have no room, or stand at a limb of their robot"
            ax.set_title(told, loc="right", fontsize=8)
        return figure


def _dots(document: FleetDocument) -> Iterator[_Dot]:
    """Yield what can be shown."""
    called = chain_labels(document)
    for chain in compared(document):
        found = [dexterity(chain, share) for share in ("0.5", "0.1", "0.9")]
        median, low, high = (np.nan if value is None else value for value in found)
        if chain.reach is not None and np.isfinite([chain.reach, median]).all():
            yield _Dot(chain, called[chain.id], np.array([chain.reach, median]), np.array([low, high]))


def _left_out(document: FleetDocument, dots: Sequence[_Dot]) -> list[str]:
    """Return lines that say what is not shown."""
    chains = chains_of(document)
    alone = sum(not comparable(chain) for chain in chains)
    counts = (
        (alone, "chain", "of one joint, or that only turn their tool: they have no dexterity to compare"),
        (len(chains) - len(dots) - alone, "chain", "without reach or dexterity"),
        (sum(robot.status != "done" for robot in document.robots), "robot", "that could not be computed"),
        (sum(robot.status == "done" and not robot.chains for robot in document.robots), "robot", "without a chain"),
    )
    said = [f"{counted(count, what)} {why}" for count, what, why in counts if count]
    return [f"not shown: {', '.join(said)}"] if said else []


def _group(dot: _Dot) -> tuple[int, str, str, str]:
    return next(group for group in _GROUPS if len(dot.chain.joints) <= group[0])


def _entries(dots: Sequence[_Dot]) -> tuple[list[Entry], list[Entry]]:
    """Return the legend in two columns."""
    from matplotlib.lines import Line2D

    entries = list[Entry]()
    for group in _GROUPS:
        if any(_group(dot) is group for dot in dots):
            look: dict[str, Any] = {"markersize": 6, "markeredgecolor": "white", "markeredgewidth": 0.6}
            entries.append((Line2D([], [], marker=group[2], color=group[3], linestyle="none", **look), group[1]))
    half = -(-len(entries) // 2)
    return entries[:half], entries[half:]


# --- axes


def _axes(ax: Any, dots: Sequence[_Dot]) -> None:
    """Make the axes: reach by logarithm where it spans more than a decade, dexterity where most of it is near zero."""
    reach, dexterity = np.array([dot.at for dot in dots]).T
    ax.set(xlabel="reach, from the first joint [m]", ylabel="smallest / largest singular value")
    ax.grid(visible=True)
    smallest, largest = float(reach.min()), float(reach.max())
    if largest > _DECADE * smallest:
        _by_logarithm(ax.xaxis, smallest / 1.35, largest * 1.35)
    else:
        room = 0.12 * (largest - smallest) or 0.25 * largest
        ax.set_xlim(max(-0.04 * largest, smallest - room), largest + room)
    high = max(float(np.nanmax([dot.at[1], *dot.span])) for dot in dots) or 1.0
    if dexterity.min() > 0 and dexterity.max() > _CROWDED * np.median(dexterity):
        _by_logarithm(ax.yaxis, _bottom(dots), 1.2 * high)
    else:
        ax.set_ylim(0, 1.08 * high)


def _bottom(dots: Sequence[_Dot]) -> float:
    """Return where an axis of dexterities by logarithm begins: below all lines that are not endless."""
    smallest = min(float(dot.at[1]) for dot in dots)
    ends = [float(dot.span[0]) for dot in dots if dot.span[0] * _DEEP >= smallest > 0]
    return min([smallest / 3, *(end / 1.3 for end in ends)])


def _by_logarithm(axis: Any, low: float, high: float) -> None:
    """Make an axis logarithmic, with ticks at round numbers, or at powers of ten where they are many."""
    from matplotlib.ticker import FixedLocator, NullLocator

    axis.set_label_text(f"{axis.get_label_text()}, by logarithm")
    if axis is axis.axes.xaxis:
        axis.axes.set(xscale="log", xlim=(low, high))
    else:
        axis.axes.set(yscale="log", ylim=(low, high))
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    steps = (1, 2, 5) if high < _DECADE**3 * low else (1,)
    ticks = [tick for power in decades for step in steps if low <= (tick := float(f"{step}e{power}")) <= high]
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter("{x:g}")


# --- names: places are in inches in the panel


def _write_names(ax: Any, dots: Sequence[_Dot]) -> int:
    """Write names where they cover neither a mark nor another name, those at the edges first; return how many.

    Limbs of a robot that stand at one place are named once.
    """
    scaled = ax.transScale.transform(np.array([dot.at for dot in dots]))
    low, high = ax.transScale.transform(np.array([ax.get_xlim(), ax.get_ylim()]).T)
    places = (scaled - low) / (high - low) * _PANEL
    taken = [_around(place, np.array([_MARK, _MARK])) for place in places]
    middle = np.median(places, axis=0)
    far = np.linalg.norm((places - middle) / _PANEL, axis=1)
    written = list[int]()
    for i in np.argsort(-far, kind="stable"):
        dot, text = dots[i], named(dots[i].label, 30)
        if any(_robot(dots[j]) == _robot(dot) and np.all(np.abs(places[j] - places[i]) < _MARK) for j in written):
            continue
        size = np.array([text_width(text, _NAME) + 0.03, _LINE])
        box = _free(places[i], size, taken)
        if box is None:
            continue
        taken.append(box)
        written.append(int(i))
        at = box.mean(axis=0)
        if np.linalg.norm(np.maximum(np.abs(at - places[i]) - size / 2, 0)) > _NEAR:
            nearest = np.clip(places[i], box[0], box[1])
            ax.plot(*(np.array([places[i], nearest]) / _PANEL).T, color=GREY, linewidth=0.5, transform=ax.transAxes)
        look: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": _NAME, "color": INK, "zorder": 4}
        ax.text(*(at / _PANEL), text, **look, transform=ax.transAxes, url=f"#{dot.chain.id}")
    return len(written)


def _robot(dot: _Dot) -> str:
    return dot.chain.id.rpartition("-")[0]


def _around(middle: Array, size: Array) -> Array:
    """Return the lower and the upper corner (2, 2) of a box."""
    return np.array([middle - size / 2, middle + size / 2])


def _free(mark: Array, size: Array, taken: Sequence[Array]) -> Array | None:
    """Return the first box for a name in the panel that covers nothing; None if there is none."""
    others = np.array(taken)
    for place in _PLACES:
        side = np.sign(place) * (size / 2 + np.abs(place))
        box = _around(mark + side, size)
        inside = np.all(box[0] >= 0) and np.all(box[1] <= _PANEL)
        if inside and not np.any(np.all((box[0] < others[:, 1]) & (others[:, 0] < box[1]), axis=1)):
            return box
    return None
