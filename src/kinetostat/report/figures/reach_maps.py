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
    GREY,
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
    text_width,
    to_scale,
)
from kinetostat.report.figures.silhouettes import OUTLINE, silhouette, thinned
from kinetostat.report.figures.symbols import draw_symbols, symbol_entries
from kinetostat.report.figures.views import axis_titles

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
_NARROWEST = 1 / 3  # of its height, how wide a panel is at least
_BETTER = 0.15  # of the largest value of a panel: where a singular curve has more, another posture is fine
_STRAY = 9  # vertices of a curve, fewer than half of which do not change its look
_SAME: dict[str, Any] = {"facecolor": GREY, "edgecolor": "none"}
_TOLD = 2  # lines of joints that are held
_SIMPLER = 0.25  # points on the page that a line may be off where it needs fewer vertices
_CURVES: dict[str, tuple[str, dict[str, Any]]] = {
    "singular": ("singular", {"color": VERMILION, "linewidth": 1.9, "zorder": 6}),
    "posture": (
        "singular in one of the postures that get there",
        {"color": VERMILION, "linewidth": 1.6, "linestyle": (0, (1.6, 1.0)), "zorder": 6},
    ),
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


def reach_figure(profile: LimbProfile) -> Figure:
    """Return where a limb's tool gets, from the side and from above, to one scale, in the axes of the limb's base.

    Pale: all places that random configurations reach. Over them what two joints do while all others are held: each
    place has the colour of the largest that the smallest singular value is there, for there may be several ways to it.
    Lines show where the limb is singular, dashed where another posture gets there that is not, and where one of the two
    joints is at a limit. A section in which the smallest singular value is the same everywhere has no colours. A
    profile without sections is drawn as what random configurations reach, alone.
    """
    views = sorted(_views(profile), key=lambda one: one[1] is not None and one[1].view != "side")
    boxes = [_extent(profile, view, section) for view, section in views]
    coloured = not all(section is None or section.same_everywhere for _, section in views)
    panels = _panels([box[1] - box[0] for box in boxes], coloured=coloured)
    boxes = [_filling(box, panel) for box, panel in zip(boxes, panels, strict=True)]
    seen = [section for _, section in views if section is not None]
    drawn = [_best(section, box, panel) for section, box, panel in zip(seen, boxes, panels, strict=False)]
    curves = [_curves(section, best, box) for section, best, box in zip(seen, drawn, boxes, strict=False)]
    with house_style():
        legends = _legends(profile, seen, {kind for part in curves for kind, _ in part})
        beside = BAR_ROOM if coloured else 0.0
        figure, axes = sheet(panels, _title(profile, seen), _lines(profile, seen), legends, beside)
        colours = _colours(seen, drawn)
        for i, (ax, (view, section), box, panel) in enumerate(zip(axes, views, boxes, panels, strict=True)):
            to_scale(ax, box, axis_titles(view, view[1] if section is not None and section.view == "side" else None))
            if len(views) > 1 and section is not None:
                ax.set_title(_VIEWS[section.view], fontsize=8.5, loc="left", pad=4)
            _draw_silhouette(ax, profile, view, section, box, panel)
            if section is not None:
                _draw_section(ax, curves[i], box, drawn[i], None if section.same_everywhere else colours)
                _draw_arm(ax, profile, section)
                if ax is axes[-1] and coloured:
                    colour_bar(ax, colours)
                    figure.axes[-1].set_ylabel(f"smallest singular value\n{_unit(profile)}".rstrip())
        return figure


def reach_thumbnail(profile: LimbProfile) -> tuple[Figure, float]:
    """Return a small square picture, without text, of the first section; and its width in m.

    It is the one from the side, but for an arm that mainly moves in a level plane, like a SCARA.

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
            curves = [(kind, points) for kind, points in _curves(section, best, box) if kind != "unlimited"]
            _draw_section(ax, curves, box, best, _colours([section], [best]), thin=0.55)
            cased(ax.plot(*section.arm.T, **_ARM | {"linewidth": 1.1, "zorder": 7})[0])
        return figure, float(box[1, 0] - box[0, 0])


# --- what is shown, and how large


def _views(profile: LimbProfile) -> list[tuple[Array, Section | None]]:
    """Return the directions (2, 3) of each panel, with its section: from the side first."""
    if profile.sections:
        return [(section.directions, section) for section in profile.sections]
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
    room = WIDTH - MARGINS - (BAR_ROOM if coloured else 0.0) - GAP * (len(spans) - 1)
    room = min(room, _ALONE) if len(spans) == 1 else room
    tallest = max(float(span[1]) for span in spans)
    widths = [max(float(span[0]), _NARROWEST * tallest) for span in spans]
    scale = min(room / sum(widths), highest / tallest)
    return [(max(width * scale, _LEAST), max(tallest * scale, _LEAST)) for width in widths]


def _filling(box: Array, panel: tuple[float, float]) -> Array:
    """Return a box about the same middle that has the shape of its panel."""
    middle, span, size = box.mean(axis=0), box[1] - box[0], np.array(panel)
    half = size * float(np.max(span / size)) / 2
    return np.array([middle - half, middle + half])


# --- words


def _title(profile: LimbProfile, seen: Sequence[Section]) -> str:
    frame, pairs = named(profile.limb.frame), {section.joints for section in seen}
    if not pairs:
        return f"where random configurations take {frame}"
    moving = " and ".join(map(named, pairs.pop())) if len(pairs) == 1 else "two joints at a time"
    return f"where {moving} take {frame}"


def _lines(profile: LimbProfile, seen: Sequence[Section]) -> list[str]:
    """Return what the figure says below its title: which joints move, where the others are held, what colours mean."""
    base = named(profile.limb.base)
    if not seen:
        return [f"in the axes of {base}"]
    moves = [" and ".join(named(joint) for joint in section.joints) for section in seen]
    told = [f"{_VIEWS[section.view]} {both}" for section, both in zip(seen, moves, strict=True)]
    told[0] += " move"
    lines = [", ".join(told)] if len(set(moves)) > 1 else []
    lines += _held(profile, seen)
    if all(section.same_everywhere for section in seen):
        return [*lines, f"in the axes of {base}"]
    return [*lines, f"colour: the smallest singular value at best (0 is singular); in the axes of {base}"]


def _held(profile: LimbProfile, seen: Sequence[Section]) -> list[str]:
    """Return where joints are held: at the pose mid, joint4 -1.571 rad, joint6 0.5 rad, the others 0."""
    swept, at = profile.sweep, f"the others are held at the pose {named(seen[0].held_name)}"
    if len(seen[0].held) <= len(seen[0].joints):
        return []
    if swept is None or len(swept.names) != len(seen[0].held):
        return [at]
    still = [joint not in seen[0].joints or any(joint not in one.joints for one in seen) for joint in swept.names]
    rounded = np.round(seen[0].held, 3) + 0.0
    parts = [
        f"{named(joint)} {value:.4g} {unit}"
        for joint, value, unit, shown in zip(swept.names, rounded, swept.units, still, strict=True)
        if shown and value
    ]
    nothing = any(shown and not value for value, shown in zip(rounded, still, strict=True))
    zero = [("the rest 0" if parts else "all 0")] if nothing else []
    for count in range(len(parts), -1, -1):
        more = [f"{len(parts) - count} more"] if count < len(parts) else []
        line = f"{at}: {', '.join([*parts[:count], *more, *zero])}"
        if text_width(line, 8.5) <= _TOLD * (WIDTH - 1):
            return [line]
    return [at]


def _unit(profile: LimbProfile) -> str:
    measured = profile.sweep.measures.get("minimum_singular_value") if profile.sweep is not None else None
    if measured is None:
        return ""
    return {"1": "[a pure number]", "mixed": "[m and rad mixed]"}.get(measured.unit, f"[{measured.unit}]")


def _legends(profile: LimbProfile, seen: Sequence[Section], kinds: set[str]) -> tuple[list[Entry], ...]:
    """Return legend entries for what is drawn, in two columns."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    curves: list[Entry] = [
        (Line2D([], [], **style), words) for kind, (words, style) in _CURVES.items() if kind in kinds
    ]
    pale: Entry = (Patch(**_PALE), "reached by random configurations")
    if not seen:
        return ([pale],)
    same: list[Entry] = [
        (
            Patch(**_SAME),
            f"smallest singular value {np.max(section.smallest):.2g} {_unit(profile)},\nthe same everywhere",
        )
        for section in seen
        if section.same_everywhere
    ]
    ends = symbol_entries(_ends(profile, seen[0]), [seen[0].directions])
    arm: Entry = (Line2D([], [], **_ARM), f"the limb at the pose {named(seen[0].held_name)}")
    return [*curves, *same, pale], [arm, *ends]


def _ends(profile: LimbProfile, section: Section) -> Skeleton:
    """Return the stick figure of a section as far as it is known: in the plane, without the kinds of its joints."""
    return Skeleton(profile.limb.frame, profile.limb.base, section.arm @ section.directions, ())


# --- drawing


def _cells(panel: tuple[float, float], fine: float) -> tuple[int, int]:
    return max(round(panel[0] * fine), 1), max(round(panel[1] * fine), 1)


def _best(section: Section, box: Array, panel: tuple[float, float]) -> Array:
    return best_in_cells(section.points, section.smallest, box, _cells(panel, _FINE))


def _colours(seen: Sequence[Section], drawn: Sequence[Array]) -> Any:
    """Return how values become colours, the same in all panels; None where none has any."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable

    values = [best.ravel() for section, best in zip(seen, drawn, strict=True) if not section.same_everywhere]
    if not values:
        return None
    colours = colouring(np.concatenate(values))
    return ScalarMappable(colours["norm"], colormaps[colours["cmap"]].resampled(_SHADES))


def _curves(section: Section, best: Array, box: Array) -> list[tuple[str, Array]]:
    """Return the curves of a section with their kinds, singular ones in pieces: is another posture fine there?"""
    every = list[tuple[str, Array]]()
    for curve in section.curves:
        if curve.kind != "singular":
            every.append((curve.kind, curve.points))
            continue
        fine = _fine_otherwise(curve.points, best, box)
        starts = [0, *(np.flatnonzero(np.diff(fine)) + 1).tolist()]
        for start, end in zip(starts, [*starts[1:], len(fine)], strict=True):
            every.append(("posture" if fine[start] else "singular", curve.points[start : end + 1]))
    return every + [("unlimited", curve.points) for curve in section.unlimited]


def _fine_otherwise(points: Array, best: Array, box: Array) -> Flags:
    """Return whether at vertices of a singular curve (k, 2) a value far from zero is drawn: another posture's."""
    from scipy.ndimage import median_filter, minimum_filter

    around = minimum_filter(np.where(np.isfinite(best), best, 0.0), 5)  # at the rim there is no other posture
    cells = np.array(best.shape[::-1])
    at = np.clip(np.floor((points - box[0]) / (box[1] - box[0]) * cells).astype(np.int64), 0, cells - 1)
    fine = around[at[:, 1], at[:, 0]] > _BETTER * np.nanmax(best, initial=0.0)
    steady: Flags = median_filter(fine.astype(np.uint8), _STRAY, mode="nearest") > 0
    return steady


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
    ax: Any, curves: Sequence[tuple[str, Array]], box: Array, best: Array, colours: Any, *, thin: float = 1.0
) -> None:
    """Draw the colours of a section, or one for all of it, and its curves."""
    from matplotlib.colors import to_rgb

    opaque = _softened(np.isfinite(best))
    if colours is None:
        plain = np.round(255 * np.array(to_rgb(_SAME["facecolor"])))
        shown = np.dstack([np.broadcast_to(plain, (*best.shape, 3)), np.round(255 * opaque)]).astype(np.uint8)
    else:  # with their opacity: an SVG loses an opacity that is given beside values
        shown = colours.to_rgba(_spread(best), alpha=opaque, bytes=True)
    place: dict[str, Any] = {"extent": (*box[:, 0], *box[:, 1]), "origin": "lower", "aspect": "auto", "zorder": 2}
    ax.imshow(shown, interpolation="none", **place)
    for kind, points in curves:
        style = _CURVES[kind][1]
        line = ax.plot(*points.T, **style | {"linewidth": thin * style["linewidth"]})[0]
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
