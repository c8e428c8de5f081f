"""Ellipsoids as a view shows them: shadows, arrows where they are infinite, and their legend."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from kinetostat.analysis.manipulability import Block
from kinetostat.conventions import Array
from kinetostat.report.figures.sheet import BLUE, INK, VERMILION, Entry, rounded
from kinetostat.report.figures.views import NEGLIGIBLE

__all__ = [
    "Shape",
    "draw_ellipsoid",
    "ellipsoid_entries",
    "ellipsoid_entry",
    "number",
    "shapes_of",
    "to_one_scale",
    "unbounded_entry",
]

_LONGEST_AXIS = 0.42  # of the arm's size: how long an ellipsoid's longest axis may be drawn
_ROUNDING = 1e-12  # what is less is shown as 0
_OUTLINES: dict[str, dict[str, Any]] = {  # not told apart by colour alone
    "velocity": {"edgecolor": BLUE, "facecolor": (BLUE, 0.22), "linewidth": 1.6, "linestyle": "-"},
    "force": {"edgecolor": VERMILION, "facecolor": (VERMILION, 0.16), "linewidth": 1.6, "linestyle": (0, (3.2, 1.6))},
}
_FLAT = {"velocity": {"linewidth": 3.6, "zorder": 4.4}, "force": {"linewidth": 1.8, "zorder": 4.5}}
_ARROW: dict[str, Any] = {"arrowstyle": "<|-|>,head_length=5,head_width=2.2", "shrinkA": 0, "shrinkB": 0}


@dataclass(frozen=True)
class Shape:
    """An ellipsoid to draw.

    Attributes:
        name: velocity or force.
        axes: unit directions as columns, in the observer's axes. (3, m).
        lengths: length of each, perhaps infinite. (m,).
        unit: their unit.
        scale: metres in the picture for one of that unit: 1, 2, 3 or 5 times a power of ten.
    """

    name: str
    axes: Array
    lengths: Array
    unit: str
    scale: float

    def rescaled(self, lengths: Array, size: float) -> Shape:
        """Return it with other lengths (m,), readable beside an arm of a size in m."""
        return replace(self, lengths=lengths, scale=_readable(lengths, size))

    def shadow(self, view: Array) -> Array:
        """Return the semi-axes of the finite part's projection as columns, in m, the longest first. (2, 2)."""
        finite = np.isfinite(self.lengths)
        turned, size = _principal(view @ (self.axes[:, finite] * self.lengths[finite]) * self.scale)
        return turned * np.where(size > NEGLIGIBLE * size[0], size, 0.0)

    def directions(self, view: Array) -> Array:
        """Return unit directions (2, k) in the picture along which the ellipsoid is infinite."""
        turned, size = _principal(view @ self.axes[:, np.isinf(self.lengths)])
        return turned[:, size > NEGLIGIBLE]


def _principal(axes: Array) -> tuple[Array, Array]:
    """Return directions (2, 2) as columns and semi-axes (2,) of the ellipse that axes (2, m) span."""
    turned, size, _ = np.linalg.svd(np.hstack([axes, np.zeros((2, 2))]))
    return turned, size


def to_one_scale(shapes: Sequence[Shape]) -> list[Shape]:
    """Return the shapes, all to the scale of the largest."""
    scale = min((shape.scale for shape in shapes if _finite_length(shape.lengths) > 0), default=1.0)
    return [replace(shape, scale=scale) for shape in shapes]


def _finite_length(lengths: Array) -> float:
    """Return the longest that has an end; 0 if there is none."""
    return float(lengths[np.isfinite(lengths)].max(initial=0.0))


def shapes_of(block: Block, turned: Array, size: float) -> tuple[Shape, ...]:
    """Return the ellipsoids of velocity and force, their rows turned (3, 3), readable beside an arm of a size in m."""
    shapes = []
    for name, ellipsoid, unitless in (("velocity", block.velocity, "m/m"), ("force", block.force, "N/N")):
        unit = {"1": unitless, "mixed": "mixed units"}.get(ellipsoid.unit, ellipsoid.unit)
        scale = _readable(ellipsoid.lengths, size)
        shapes.append(Shape(name, turned[:, block.task.rows] @ ellipsoid.axes, ellipsoid.lengths, unit, scale))
    return tuple(shapes)


def _readable(lengths: Array, size: float) -> float:
    """Return the scale at which axes of some lengths (m,) are readable beside an arm of a size in m."""
    longest = _finite_length(lengths)
    return rounded(_LONGEST_AXIS * size / longest, (1, 2, 3, 5)) if longest > 0 else 1.0


def draw_ellipsoid(ax: Any, shape: Shape, view: Array, middle: Array, reach: float, arm: Array) -> None:
    """Draw an ellipsoid's shadow about its middle: an ellipse, a line, or nothing; arrows of a reach where infinite.

    Middle and arm, (2,), and reach are in m in the picture. Infinity is written on the arrow's end away from the arm.
    """
    from matplotlib.patches import Ellipse, FancyArrowPatch

    outline = _OUTLINES[shape.name]
    first, second = shape.shadow(view).T
    size = (2 * float(np.linalg.norm(first)), 2 * float(np.linalg.norm(second)))
    if size[1] > 0:
        angle = math.degrees(math.atan2(first[1], first[0]))
        ax.add_patch(Ellipse((middle[0], middle[1]), *size, angle=angle, **outline, zorder=2, label=shape.name))
    elif size[0] > 0:
        line = {"color": outline["edgecolor"], "linestyle": outline["linestyle"], **_FLAT[shape.name]}
        ax.plot(*np.array([middle - first, middle + first]).T, **line, solid_capstyle="butt", label=shape.name)
    for direction in shape.directions(view).T:
        tip = reach * direction
        arrow = {**_ARROW, "color": outline["edgecolor"], "linewidth": 1.1, "zorder": 4.6}
        ax.add_patch(FancyArrowPatch(middle - tip, middle + tip, **arrow, label=f"{shape.name} without bound"))
        away = direction if direction @ (middle - arm) >= 0 else -direction
        text = {"ha": "center", "va": "center", "color": INK, "fontsize": 11, "zorder": 6}
        ax.annotate("∞", middle + reach * away, 8 * away, textcoords="offset points", **text)


def ellipsoid_entries(shapes: Sequence[Shape], views: Sequence[Array]) -> list[Entry]:
    """Return legend entries for the ellipsoids: scale, lengths of their axes, what is infinite."""
    entries = list[Entry]()
    for shape in shapes:
        entries.append(ellipsoid_entry(shape, _words(shape, views)))
        if any(shape.directions(view).size for view in views):
            entries.append(unbounded_entry(shape))
    return entries


def ellipsoid_entry(shape: Shape, words: str) -> Entry:
    """Return the legend entry of an ellipsoid."""
    from matplotlib.patches import Patch

    return Patch(**_OUTLINES[shape.name]), words


def unbounded_entry(shape: Shape, words: str = "") -> Entry:
    """Return the legend entry of the arrows along which an ellipsoid has no end."""
    from matplotlib.lines import Line2D

    line: dict[str, Any] = {"linewidth": 1.1, "marker": ">", "markersize": 4, "markevery": [1]}
    arrow = Line2D([], [], color=_OUTLINES[shape.name]["edgecolor"], **line)
    return arrow, words or f"{shape.name} without bound: held without any torque"


def _words(shape: Shape, views: Sequence[Array]) -> str:
    endless, lengths = np.isinf(shape.lengths), ", ".join(map(number, sorted(shape.lengths, reverse=True)))
    if len(views) == 1 and shape.directions(views[0]).shape[1] < np.sum(endless):
        lengths = lengths.replace("∞", "∞ (end-on)", 1)
    unit, kind = ("", " (mixed units)") if shape.unit == "mixed units" else (f" {shape.unit}", "")
    drawn = "without bound" if endless.any() else "a point"
    if np.any(shape.lengths[~endless] > 0):
        drawn = f"1{unit} drawn as {shape.scale:g} m"
    return f"{shape.name} ellipsoid{kind}: {drawn}\nsemi-axes {lengths}{unit}"


def number(value: Any) -> str:
    """Return a number as figures show it: three digits, ∞, and 0 for what is rounding."""
    number = float(value)
    return "∞" if math.isinf(number) else f"{number:.3g}" if abs(number) > _ROUNDING else "0"
