"""The sheet that a figure is drawn on: its style and colours, its layout in inches, text that fits, and legends.

Colours are those of Okabe and Ito, and cividis: distinct without colour vision, and in grey.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from kinetostat.conventions import Array
from kinetostat.errors import cut

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Entry = tuple[Any, str]  # of a legend: what is drawn, and its text, perhaps of several lines

INK, GREY = "#222222", "#8a8a8a"
BLUE, VERMILION, PURPLE, SKY = "#0072b2", "#d55e00", "#a0447a", "#56b4e9"
WIDTH, MARGINS, GAP = 6.9, 1.1, 0.85  # in, of a sheet: a page's text; left and right of the panels; between them
BAR_ROOM = 1.15  # in, beside a panel: a colour bar with its ticks and label
_LEFT, _BELOW = 0.8, 0.62  # in, beside and below a panel: tick labels and the label of the axis
_TITLE: dict[str, Any] = {"size": 11, "weight": "bold"}
_TEXT: dict[str, Any] = {"size": 8.5}
_POINT = 1 / 72  # in
_STYLE: dict[str, Any] = {
    "font.size": 8.5,
    "axes.axisbelow": True,
    "axes.edgecolor": "#555555",
    "axes.formatter.limits": (-3, 4),
    "axes.linewidth": 0.7,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.6,
    "legend.borderaxespad": 0,
    "legend.borderpad": 0,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "legend.handlelength": 2.4,
    "legend.loc": "upper left",
    "pdf.fonttype": 42,
    "savefig.dpi": 200,
    "svg.fonttype": "none",
    "svg.hashsalt": "kinetostat",
    "xtick.color": "#333333",
    "ytick.color": "#333333",
}


@contextmanager
def house_style() -> Iterator[None]:
    """Draw in the house style, whatever the user's own; theirs is back afterwards."""
    import matplotlib as mpl

    with mpl.rc_context(), warnings.catch_warnings():
        # A name in a script that the font has no glyphs for: it is still right in SVG, and boxes elsewhere.
        warnings.filterwarnings("ignore", message="Glyph .* missing from font", category=UserWarning)
        mpl.rcdefaults()
        mpl.rcParams.update(cast("Any", _STYLE))
        yield


# --- text


def named(name: str, longest: int = 28) -> str:
    """Return a name from a robot file as a figure shows it: printable, cut, a dollar sign being a dollar sign."""
    return cut(name, longest).replace("$", r"\$")


@lru_cache(maxsize=4096)
def text_width(text: str, size: float = 8, weight: str = "normal") -> float:
    """Return the width of a line of text in inches, its size being in points."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextToPath

    font = FontProperties(size=size, weight=weight)
    return TextToPath().get_text_width_height_descent(text.replace(r"\$", "$"), font, ismath=False)[0] * _POINT


def _fitted(text: str, room: float) -> str:
    """Return a legend's text, cut where it is wider than the room in inches."""
    if text_width(text) <= room:
        return text
    while text and text_width(f"{text}...") > room:
        text = text[:-1].removesuffix("\\")
    return f"{text}..."


def _wrapped(text: str, font: dict[str, Any], room: float) -> list[str]:
    """Return the text in lines that are no wider than the room in inches."""
    lines = list[str]()
    for word in text.split(" "):
        if lines and text_width(f"{lines[-1]} {word}", **font) <= room:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return lines


# --- layout


def sheet(
    panels: Sequence[tuple[float, float]],
    title: str,
    lines: Sequence[str],
    legends: Sequence[Sequence[Entry]],
    beside: float = 0.0,
) -> tuple[Figure, list[Any]]:
    """Return a figure with a title, lines below it, axes side by side, and one or two legends at its foot.

    Panels are of a width and a height in inches; `beside` is room to their right. Long lines are wrapped, legends cut.
    """
    from matplotlib.figure import Figure

    wide = sum(width for width, _ in panels) + GAP * (len(panels) - 1) + beside + MARGINS
    width = max(WIDTH, wide)
    titles = _wrapped(title, _TITLE, width - 0.3)
    below = [part for line in lines for part in _wrapped(line, _TEXT, width - 0.3)]
    top = 0.14 + 0.22 * len(titles) + 0.16 * len(below) + 0.22
    foot = 0.18 + max(sum((9.6 * (1 + label.count("\n")) + 4.4) * _POINT for _, label in part) for part in legends)
    height = top + max(height for _, height in panels) + _BELOW + foot
    figure = Figure(figsize=(width, height), facecolor="white")
    heading = [(part, 0.14 + 0.22 * i, INK, _TITLE) for i, part in enumerate(titles)]
    heading += [(part, 0.16 + 0.22 * len(titles) + 0.16 * i, "#444444", _TEXT) for i, part in enumerate(below)]
    for part, down, colour, font in heading:
        figure.text(0.15 / width, 1 - down / height, part, va="top", color=colour, **font)
    axes, x = [], _LEFT + (width - wide) / 2
    for w, h in panels:
        axes.append(figure.add_axes((x / width, (height - top - h) / height, w / width, h / height)))
        x += w + GAP
    lefts = [_LEFT] if len(legends) == 1 else [0.25, 0.55 * width]
    for left, right, entries in zip(lefts, [*lefts[1:], width], legends, strict=True):
        texts = ["\n".join(_fitted(line, right - left - 0.55) for line in text.split("\n")) for _, text in entries]
        figure.legend([handle for handle, _ in entries], texts, bbox_to_anchor=(left / width, foot / height))
    return figure, axes


def empty_sheet(title: str, lines: Sequence[str]) -> Figure:
    """Return a figure that shows nothing, and says why."""
    with house_style():
        figure, (ax,) = sheet([(WIDTH - MARGINS, 0.2)], title, lines, [[]])
        ax.set_axis_off()
        return figure


def to_scale(ax: Any, box: Array, directions: Sequence[str]) -> None:
    """Make axes of a panel that is to scale: limits `box` (2, 2) in m, ticks equally far apart if there is room."""
    from matplotlib.ticker import MultipleLocator

    ax.set(xlim=box[:, 0], ylim=box[:, 1], xlabel=f"{directions[0]} [m]", ylabel=f"{directions[1]} [m]")
    ax.grid(visible=True)
    span, steps = box[1] - box[0], (1, 2, 2.5, 5, 10)
    inch = span[0] / (ax.get_position().width * ax.figure.get_size_inches()[0])
    for axis, extent, near in ((ax.xaxis, span[0], 0.45), (ax.yaxis, span[1], 0.25)):
        step = rounded(0.55 * inch, steps, up=True)
        if extent < 2.5 * step:
            step = rounded(near * inch, steps, up=True)
        axis.set_major_locator(MultipleLocator(step))


def rounded(value: float, steps: Sequence[float], *, up: bool = False) -> float:
    """Return the nearest of the steps times a power of ten that is not above the value (`up`: not below)."""
    power = math.floor(math.log10(value))
    rounds = np.array([float(f"{step}e{power}") for step in steps])
    slack = 1e-12 * value
    return float(min(rounds[rounds >= value - slack]) if up else max(rounds[rounds <= value + slack]))


# --- colours


def colouring(values: Array) -> dict[str, Any]:
    """Return how values become colours: linearly, or by logarithm where most would look like zero."""
    from matplotlib.colors import LogNorm, Normalize

    finite = values[np.isfinite(values)]
    largest = float(finite.max(initial=0.0)) or 1.0
    norm = Normalize(0.0, largest)
    if 0 < np.median(finite) < 0.05 * largest:
        norm = LogNorm(vmin=max(float(np.percentile(finite, 2)), 1e-6 * largest), vmax=largest, clip=True)
    return {"cmap": "cividis", "norm": norm}


def colour_bar(ax: Any, coloured: Any) -> None:
    """Add the bar of the smallest singular values beside a panel."""
    width, box = float(ax.figure.get_size_inches()[0]), ax.get_position()
    place = ax.figure.add_axes((box.x1 + 0.18 / width, box.y0, 0.16 / width, box.height))
    bar = ax.figure.colorbar(coloured, cax=place, label="smallest singular value")
    bar.outline.set_linewidth(0.7)


def cased(artist: Any) -> None:
    """Give an artist a white rim, so that it is seen on any colour."""
    from matplotlib.patheffects import Normal, Stroke

    width = np.max(artist.get_linewidth())
    artist.set_path_effects([Stroke(linewidth=width + 1.8, foreground="white"), Normal()])
