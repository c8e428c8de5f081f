"""The figure of where a limb's tool gets, and how well it moves there: from the side and from above."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.profile.cells import best_in_cells
from kinetostat.analysis.skeleton import Skeleton
from kinetostat.conventions import Array, Flags
from kinetostat.report.figures.sheet import (
    BAR_ROOM,
    GAP,
    INK,
    MARGINS,
    VERMILION,
    WIDTH,
    Entry,
    cased,
    colour_bar,
    colouring,
    house_style,
    named,
    sheet,
    to_scale,
)
from kinetostat.report.figures.silhouettes import OUTLINE, silhouette, thinned
from kinetostat.report.figures.symbols import draw_symbols, symbol_entries
from kinetostat.report.figures.views import in_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kinetostat.analysis.profile.result import LimbProfile
    from kinetostat.analysis.profile.section import Section

__all__ = ["reach_figure", "reach_thumbnail"]

_HIGHEST, _ALONE, _LEAST = 3.7, 4.4, 1.3  # in, of a panel; of one alone; and the least
_FINE, _COARSE = 105, 18  # squares an inch: of colours, of the silhouette
_SHADES = 56  # of the colour map: a smooth picture that packs well; with fewer than 50 the bar has seams
_MARGIN = 0.05  # of what is drawn, around it
_THUMBNAIL = 1.1  # in
_PALE: dict[str, Any] = {"facecolor": "#ebebeb", "edgecolor": "#b4b4b4", "linewidth": 0.7}
_DOTS: dict[str, Any] = {
    "color": "#b4b4b4",
    "marker": "o",
    "markersize": 2.6,
    "markeredgewidth": 0,
    "linestyle": "none",
}
_SIMPLER = 0.25  # points on the page that a line may be off where it needs fewer vertices
_CURVES: dict[str, tuple[str, dict[str, Any]]] = {
    "singular": ("singular", {"color": VERMILION, "linewidth": 1.9, "zorder": 6}),
    "unlimited": (
        "singular, were there no limits",
        {"color": VERMILION, "linewidth": 1.0, "linestyle": (0, (3.5, 2)), "zorder": 3.5},
    ),
    "limit": ("one of the two joints at a limit", {"color": INK, "linewidth": 0.8, "zorder": 4}),
}
_ARM: dict[str, Any] = {"color": INK, "linewidth": 2.0, "solid_joinstyle": "round", "solid_capstyle": "round"}
_JOINT: dict[str, Any] = {"marker": "o", "markersize": 3.4, "linestyle": "none"}
_JOINT |= {"markerfacecolor": "white", "markeredgecolor": INK, "markeredgewidth": 0.8}
_VIEWS = {"side": "from the side", "above": "from above"}
_PLANES = np.eye(3)[[[0, 2], [0, 1], [1, 2]]]  # that a silhouette alone is drawn in: the first in which it is largest
_ASLANT = 0.02  # part of an axis in a direction that is not worth its letter
_MOST_POSITIONS = 12  # coordinates whose positions are told


def reach_figure(profile: LimbProfile) -> Figure:
    """Return where a limb's tool gets, from the side and from above, to one scale, in the axes of the limb's base.

    Pale: all places that random configurations reach. Over them what two joints do while all others are held: each
    place has the colour of the largest that the smallest singular value is there, for there may be several ways to it.
    Lines show where the limb is singular, and where one of the two joints is at a limit. A profile without sections is
    drawn as what random configurations reach, alone.
    """
    views = _views(profile)
    boxes = [_extent(profile, view, section) for view, section in views]
    panels = _panels([box[1] - box[0] for box in boxes], coloured=bool(profile.sections))
    boxes = [_filling(box, panel) for box, panel in zip(boxes, panels, strict=True)]
    seen = [section for _, section in views if section is not None]
    with house_style():
        title = f"where {named(profile.limb.frame)} gets" + (", and how well it moves there" if seen else "")
        legends = _legends(profile, views)
        figure, axes = sheet(panels, title, _lines(profile, seen), legends, BAR_ROOM if seen else 0.0)
        drawn = [_best(section, box, panel) for section, box, panel in zip(seen, boxes, panels, strict=False)]
        colours = _colours(drawn) if drawn else None
        for i, (ax, (view, section), box, panel) in enumerate(zip(axes, views, boxes, panels, strict=True)):
            to_scale(ax, box, [in_words(np.where(np.abs(part) < _ASLANT, 0.0, part)) for part in view])
            if len(views) > 1 and section is not None:
                ax.set_title(_VIEWS[section.view], fontsize=8.5, loc="left", pad=4)
            _draw_silhouette(ax, profile, view, section, box, panel)
            if section is not None:
                _draw_section(ax, section, box, drawn[i], colours)
                _draw_arm(ax, profile, section)
                if ax is axes[-1]:
                    colour_bar(ax, colours)
                    figure.axes[-1].set_ylabel(f"smallest singular value {_unit(profile)}".rstrip())
        return figure


def reach_thumbnail(profile: LimbProfile) -> tuple[Figure, float]:
    """Return a small square picture, without text, of the section from the side, else from above; and its width in m.

    A profile without sections is drawn as what random configurations reach, alone.
    """
    from matplotlib.figure import Figure

    view, section = _views(profile)[0]
    box = _extent(profile, view, section, unlimited=False)
    panel = (_THUMBNAIL, _THUMBNAIL)
    box = _filling(box, panel)
    with house_style():
        figure = Figure(figsize=panel, facecolor="white")
        ax: Any = figure.add_axes((0, 0, 1, 1))
        ax.set(xlim=box[:, 0], ylim=box[:, 1])
        ax.set_axis_off()
        _draw_silhouette(ax, profile, view, section, box, panel)
        if section is not None:
            best = _best(section, box, panel)
            _draw_section(ax, section, box, best, _colours([best]), thin=0.55, unlimited=False)
            cased(ax.plot(*section.arm.T, **_ARM | {"linewidth": 1.1, "zorder": 7})[0])
        return figure, float(box[1, 0] - box[0, 0])


# --- what is shown, and how large


def _views(profile: LimbProfile) -> list[tuple[Array, Section | None]]:
    """Return the directions (2, 3) of each panel, with its section: from the side first."""
    if profile.sections:
        ordered = sorted(profile.sections, key=lambda section: section.view != "side")
        return [(section.directions, section) for section in ordered]
    spans = [float(np.prod(np.sort(np.ptp(profile.positions @ plane.T, axis=0) + 1e-9))) for plane in _PLANES]
    return [(_PLANES[int(np.argmax(np.array(spans) >= max(spans) * (1 - 1e-6)))], None)]


def _extent(profile: LimbProfile, view: Array, section: Section | None, *, unlimited: bool = True) -> Array:
    """Return the lower and the upper corner (2, 2) of what a panel shows, in m."""
    shown = [np.zeros((1, 2)), profile.positions @ view.T]
    if section is not None:
        curves = (*section.curves, *(section.unlimited if unlimited else ()))
        shown += [section.points.reshape(-1, 2), section.arm, *(curve.points for curve in curves)]
    points = np.concatenate(shown)
    low, high = points.min(axis=0), points.max(axis=0)
    pad = _MARGIN * max(float((high - low).max()), 1e-6)
    return np.array([low - pad, high + pad])


def _panels(spans: Sequence[Array], *, coloured: bool) -> list[tuple[float, float]]:
    """Return the sizes of panels in inches: one scale for all, equally high, widths that fit a page."""
    highest = _ALONE if len(spans) == 1 else _HIGHEST
    room = WIDTH + (1.6 if coloured else 0.0) - MARGINS - (BAR_ROOM if coloured else 0.0) - GAP * (len(spans) - 1)
    room = min(room, _ALONE) if len(spans) == 1 else room
    tallest = max(float(span[1]) for span in spans)
    scale = min(room / sum(float(span[0]) for span in spans), highest / tallest)
    return [(max(float(span[0]) * scale, _LEAST), max(tallest * scale, _LEAST)) for span in spans]


def _filling(box: Array, panel: tuple[float, float]) -> Array:
    """Return a box about the same middle that has the shape of its panel."""
    middle, span, size = box.mean(axis=0), box[1] - box[0], np.array(panel)
    half = size * float(np.max(span / size)) / 2
    return np.array([middle - half, middle + half])


# --- words


def _lines(profile: LimbProfile, seen: Sequence[Section]) -> list[str]:
    """Return what the figure says below its title: which joints move, where the others are held, what colours mean."""
    base = named(profile.limb.base)
    if not seen:
        return [f"in the axes of {base}"]
    moves = [" and ".join(named(joint) for joint in section.joints) for section in seen]
    told = [f"{_VIEWS[section.view]} {both}" for section, both in zip(seen, moves, strict=True)]
    told[0] += " move"
    if len(seen) == 1 or moves[0] == moves[-1]:
        told = [f"{moves[0]} move"]
    others = len(seen[0].held) > 2
    line = f"{', '.join(told)}; all others are held at the pose {named(seen[0].held_name)}" if others else told[0]
    line += _positions(profile, seen[0]) if others else ""
    best = "colour: how well it moves at best, by the smallest singular value (0 is singular), in the axes of "
    return [line, best + base]


def _positions(profile: LimbProfile, section: Section) -> str:
    """Return the positions of all joints at the pose in which the others are held: (0, -1.571 rad, 0.2 m)."""
    if profile.sweep is None or len(section.held) > _MOST_POSITIONS:
        return ""
    units = profile.sweep.units
    shown = [f"{round(float(value), 3) + 0.0:.4g}" for value in section.held]
    last = [i + 1 == len(units) or units[i + 1] != unit for i, unit in enumerate(units)]
    parts = [f"{value} {unit}" if ends else value for value, unit, ends in zip(shown, units, last, strict=True)]
    return f" ({', '.join(parts)})"


def _unit(profile: LimbProfile) -> str:
    measured = profile.sweep.measures.get("minimum_singular_value") if profile.sweep is not None else None
    if measured is None:
        return ""
    return {"1": "[a pure number]", "mixed": "[m and rad mixed]"}.get(measured.unit, f"[{measured.unit}]")


def _legends(profile: LimbProfile, views: Sequence[tuple[Array, Section | None]]) -> tuple[list[Entry], ...]:
    """Return legend entries for what is drawn, in two columns."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    seen = [section for _, section in views if section is not None]
    kinds = {curve.kind for section in seen for curve in section.curves}
    kinds |= {"unlimited" for section in seen if section.unlimited}
    curves: list[Entry] = [
        (Line2D([], [], **style), words) for kind, (words, style) in _CURVES.items() if kind in kinds
    ]
    pale: Entry = (Patch(**_PALE), "reached by random configurations")
    if not seen:
        return ([pale],)
    ends = symbol_entries(_ends(profile, seen[0]), [seen[0].directions])
    arm: Entry = (Line2D([], [], **_ARM), f"the limb at the pose {named(seen[0].held_name)}")
    return [*curves, pale], [arm, *ends]


def _ends(profile: LimbProfile, section: Section) -> Skeleton:
    """Return the stick figure of a section as far as it is known: in the plane, without the kinds of its joints."""
    return Skeleton(profile.limb.frame, profile.limb.base, section.arm @ section.directions, ())


# --- drawing


def _cells(panel: tuple[float, float], fine: float) -> tuple[int, int]:
    return max(round(panel[0] * fine), 1), max(round(panel[1] * fine), 1)


def _best(section: Section, box: Array, panel: tuple[float, float]) -> Array:
    return best_in_cells(section.points, section.smallest, box, _cells(panel, _FINE))


def _colours(drawn: Sequence[Array]) -> Any:
    """Return how values become colours, the same in all panels."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable

    colours = colouring(np.concatenate([best.ravel() for best in drawn]))
    return ScalarMappable(colours["norm"], colormaps[colours["cmap"]].resampled(_SHADES))


def _draw_silhouette(
    ax: Any, profile: LimbProfile, view: Array, section: Section | None, box: Array, panel: tuple[float, float]
) -> None:
    """Draw what random configurations reach, and what the section does: random ones seldom get to an edge."""
    points = profile.positions @ view.T
    if section is not None:
        points = np.concatenate([points, section.points.reshape(-1, 2)])
    cells = _cells(panel, _COARSE)
    shape = silhouette(points, box, cells)
    if shape is None:
        ax.plot(*thinned(points, box, cells).T, **_DOTS, zorder=1)
    else:
        pale = ax.contourf(*shape, levels=[OUTLINE, 2.0], colors=[_PALE["facecolor"]], zorder=1)
        pale.set(edgecolor=_PALE["edgecolor"], linewidth=_PALE["linewidth"])


def _draw_section(
    ax: Any,
    section: Section,
    box: Array,
    best: Array,
    colours: Any,
    *,
    thin: float = 1.0,
    unlimited: bool = True,
) -> None:
    """Draw the colours of a section and its curves."""
    # Colours with their opacity: an SVG loses an opacity that is given beside values.
    shown = colours.to_rgba(_spread(best), alpha=_softened(np.isfinite(best)), bytes=True)
    place: dict[str, Any] = {"extent": (*box[:, 0], *box[:, 1]), "origin": "lower", "aspect": "auto", "zorder": 2}
    ax.imshow(shown, interpolation="none", **place)
    every = [(curve.kind, curve) for curve in section.curves]
    every += [("unlimited", curve) for curve in section.unlimited if unlimited]
    for kind, curve in every:
        style = _CURVES[kind][1]
        line = ax.plot(*curve.points.T, **style | {"linewidth": thin * style["linewidth"]})[0]
        path = line.get_path()
        path.should_simplify, path.simplify_threshold = True, _SIMPLER
        if kind == "singular":
            cased(line)


def _spread(best: Array) -> Array:
    """Return values that reach a square beyond their edge, to be seen through it."""
    from scipy.ndimage import maximum_filter

    spread: Array = maximum_filter(np.where(np.isfinite(best), best, -np.inf), 3)
    return np.where(np.isfinite(best), best, np.where(np.isfinite(spread), spread, 0.0))


def _softened(filled: Flags) -> Array:
    """Return how opaque squares are, those at an edge less: stairs become a line."""
    from scipy.ndimage import gaussian_filter

    soft = np.clip(2 * gaussian_filter(filled.astype(np.float64), 0.7) - 0.4, 0, 1)
    stepped: Array = np.round(2 * soft) / 2
    return stepped


def _draw_arm(ax: Any, profile: LimbProfile, section: Section) -> None:
    cased(ax.plot(*section.arm.T, **_ARM, zorder=7)[0])
    ax.plot(*section.arm[1:-1].T, **_JOINT, zorder=8)
    draw_symbols(ax, _ends(profile, section), section.directions)
