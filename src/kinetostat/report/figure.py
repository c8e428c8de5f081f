"""Results to pictures: the one place that draws. Pure functions of results, in one style, for print and for SVG.

Sheets are laid out by hand, in inches, so that nothing overlaps and the same result always gives the same bytes.
Colours are those of Okabe and Ito, and cividis: distinct without colour vision, and in grey. What comes from a robot
file is untrusted text: it is made printable, cut, and never read as mathematics.
"""

from __future__ import annotations

import io
import math
import os
import tempfile
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from kinetostat.analysis.skeleton import Pivot, Skeleton, skeleton
from kinetostat.conventions import Array
from kinetostat.errors import UsageError, quote

if TYPE_CHECKING:
    import numpy.typing as npt
    from matplotlib.figure import Figure

    from kinetostat.analysis.configuration import Configuration
    from kinetostat.analysis.manipulability import Block, Manipulability
    from kinetostat.analysis.singular.slices import Curve, Mark, Slice, Workspace
    from kinetostat.engines.model import Model

__all__ = ["check_suffix", "manipulability_figure", "save", "slice_figure", "workspace_figure"]

_SUFFIXES = (".svg", ".png", ".pdf")
_STYLE: dict[str, Any] = {
    "font.size": 8.5,
    "axes.axisbelow": True,
    "axes.edgecolor": "#555555",
    "axes.formatter.limits": (-3, 4),
    "axes.linewidth": 0.7,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.6,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "pdf.fonttype": 42,
    "savefig.dpi": 200,
    "svg.fonttype": "none",
    "svg.hashsalt": "kinetostat",
    "xtick.color": "#333333",
    "ytick.color": "#333333",
}
_INK, _GREY = "#222222", "#8a8a8a"
_BLUE, _VERMILION, _PURPLE, _SKY = "#0072b2", "#d55e00", "#a0447a", "#56b4e9"
_NEGLIGIBLE = 1e-6  # of the largest: thinner than any line


# --- files -----------------------------------------------------------------------------------------------------


def check_suffix(path: Path) -> None:
    """Refuse a file that `save` could not write, before anything is computed.

    Raises:
        UsageError: the suffix is not .svg, .png or .pdf; or matplotlib is not installed.
    """
    if path.suffix.lower() not in _SUFFIXES:
        raise UsageError(
            f"cannot draw {quote(str(path))}: a picture's format is told by its suffix",
            remedy=f"name it {quote(path.stem or 'picture')[1:-1]}.svg, .png or .pdf",
        )
    if find_spec("matplotlib") is None:
        raise UsageError("pictures need matplotlib, which is not installed", remedy="pip install matplotlib")


def save(figure: Figure, path: Path) -> None:
    """Write a figure, completely or not at all; the same figure gives the same bytes.

    Args:
        figure: one made by this module.
        path: where to; the suffix tells the format: .svg (text stays text), .png (200 dpi) or .pdf.

    Raises:
        UsageError: another suffix; the file cannot be written.
    """
    check_suffix(path)
    content = _rendered(figure, path.suffix.lower()[1:])
    try:
        _write_whole(path, content)
    except OSError as error:
        raise UsageError(
            f"cannot write {quote(str(path))}: {error.strerror or error}", remedy="check its folder"
        ) from None


def _rendered(figure: Figure, form: str) -> bytes:
    undated: dict[str, Any] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {}}[form]
    content = io.BytesIO()
    with _style():
        figure.savefig(content, format=form, metadata=undated)
    return content.getvalue()


def _write_whole(path: Path, content: bytes) -> None:
    if path.exists() and not path.is_file():  # a pipe: nothing to replace
        path.write_bytes(content)
        return
    handle, draft = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name[:40]}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        umask = os.umask(0)
        os.umask(umask)
        Path(draft).chmod(0o666 & ~umask)
        Path(draft).replace(path)
    except BaseException:
        Path(draft).unlink(missing_ok=True)
        raise


# --- sheets ----------------------------------------------------------------------------------------------------

_WIDTH = 6.9  # in, of a sheet: the width of a page's text
_LEFT, _RIGHT, _GAP, _BELOW = 0.8, 0.3, 0.85, 0.62  # in, around panels; below: tick labels and the label of the axis
_LINE, _POINT = 0.16, 1 / 72  # in


@contextmanager
def _style() -> Iterator[None]:
    """Draw in the house style, whatever the user's own; theirs is back afterwards."""
    import matplotlib as mpl

    with mpl.rc_context(), warnings.catch_warnings():
        # A name in a script that the font has no glyphs for: it is still right in SVG, and boxes elsewhere.
        warnings.filterwarnings("ignore", message="Glyph .* missing from font", category=UserWarning)
        mpl.rcdefaults()
        mpl.rcParams.update(cast("Any", _STYLE))
        yield


def _name(name: str, longest: int = 28) -> str:
    """Return a name from a robot file as a figure shows it: printable and cut."""
    return quote(name, longest)[1:-1]


def _plain(text: Any) -> Any:
    """Return the text object, told that a dollar sign is a dollar sign."""
    text.set_parse_math(False)
    return text


def _width(text: str, size: float, *, bold: bool = False) -> float:
    """Return the width of a line of text in inches, at a size in points."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextToPath

    font = FontProperties(size=size, weight="bold" if bold else "normal")
    width, _, _ = TextToPath().get_text_width_height_descent(text, font, ismath=False)
    return float(width) * _POINT


def _fitted(text: str, size: float, room: float) -> str:
    """Return the text, cut where it is wider than the room in inches."""
    if _width(text, size) <= room:
        return text
    while text and _width(f"{text}...", size) > room:
        text = text[:-1]
    return f"{text}..."


def _wrapped(text: str, size: float, room: float, *, bold: bool = False) -> list[str]:
    """Return the text in lines that are no wider than the room in inches."""
    lines = [""]
    for word in text.split(" "):
        longer = f"{lines[-1]} {word}" if lines[-1] else word
        if lines[-1] and _width(longer, size, bold=bold) > room:
            lines.append(word)
        else:
            lines[-1] = longer
    return lines


def _sheet(
    panels: Sequence[tuple[float, float]], title: str, lines: Sequence[str], legend: float, beside: float = 0.0
) -> tuple[Figure, list[Any]]:
    """Return a figure with a title, lines below it, axes side by side, and room for legends at its foot.

    Args:
        panels: width and height of each panel, in inches.
        title: the title.
        lines: lines below it; long ones are wrapped.
        legend: height of the legends, in inches.
        beside: room to the right of the panels, in inches.
    """
    from matplotlib.figure import Figure

    wide = _LEFT + sum(width for width, _ in panels) + _GAP * (len(panels) - 1) + beside + _RIGHT
    width, panel = max(_WIDTH, wide), max(height for _, height in panels)
    titles = _wrapped(title, 11, width - 0.3, bold=True)
    wrapped = [part for line in lines for part in _wrapped(line, 8.5, width - 0.3)]
    top = 0.14 + 0.22 * len(titles) + _LINE * len(wrapped) + 0.22
    height = top + panel + _BELOW + legend + 0.1
    figure = Figure(figsize=(width, height), facecolor="white")
    for i, line in enumerate(titles):
        y = 1 - (0.14 + 0.22 * i) / height
        _plain(figure.text(0.15 / width, y, line, va="top", fontsize=11, fontweight="bold", color=_INK))
    for i, line in enumerate(wrapped):
        y = 1 - (0.16 + 0.22 * len(titles) + _LINE * i) / height
        _plain(figure.text(0.15 / width, y, line, va="top", fontsize=8.5, color="#444444"))
    axes, x = [], _LEFT + (width - wide) / 2
    for w, h in panels:
        axes.append(figure.add_axes((x / width, (height - top - h) / height, w / width, h / height)))
        x += w + _GAP
    return figure, axes


def _legend_height(labels: Sequence[str]) -> float:
    """Return the height in inches of a legend of one column."""
    return sum((9.6 * (1 + label.count("\n")) + 4.4) * _POINT for label in labels) + 0.08


def _legend(figure: Figure, x: float, entries: Sequence[tuple[Any, str]], height: float, right: float) -> None:
    """Add a legend of one column between x and `right`, in inches from the left, its top `height` above the foot."""
    if not entries:
        return
    width, tall = figure.get_size_inches()
    legend = figure.legend(
        [handle for handle, _ in entries],
        ["\n".join(_fitted(line, 8, right - x - 0.45) for line in label.split("\n")) for _, label in entries],
        loc="upper left",
        bbox_to_anchor=(x / width, (height + 0.1) / tall),
        borderaxespad=0,
        borderpad=0,
        labelspacing=0.5,
        handlelength=2.4,
    )
    for text in legend.get_texts():
        _plain(text)


def _legends(figure: Figure, left: Sequence[tuple[Any, str]], right: Sequence[tuple[Any, str]], height: float) -> None:
    """Add two legends side by side."""
    width = float(figure.get_size_inches()[0])
    _legend(figure, 0.25, left, height, 0.55 * width - 0.1)
    _legend(figure, 0.55 * width, right, height, width - 0.1)


# --- manipulability --------------------------------------------------------------------------------------------

_SYMBOL_ROOM = 0.22  # in, around what is drawn: half a joint's symbol and a little
_LARGEST_PANEL, _SMALLEST_PANEL = 3.9, 1.7  # in
_LONGEST_AXIS = 0.42  # of the arm's size: how long an ellipsoid's longest axis may be drawn


@dataclass(frozen=True)
class _Shape:
    """An ellipsoid to draw.

    Attributes:
        name: velocity or force.
        axes: unit directions as columns, in the observer's axes. (3, m).
        lengths: length of each, perhaps infinite. (m,).
        unit: their unit.
        scale: metres in the picture for one of that unit.
    """

    name: str
    axes: Array
    lengths: Array
    unit: str
    scale: float

    @property
    def endless(self) -> npt.NDArray[np.bool_]:
        """Which axes are infinite. (m,)."""
        return np.isinf(self.lengths)

    def shadow(self, view: Array) -> tuple[Array, Array]:
        """Return axes (2, 2) as columns and semi-axes (2,) in m of the finite part's projection, the longest first."""
        finite = ~self.endless
        half = view @ (self.axes[:, finite] * self.lengths[finite]) * self.scale
        turned, size, _ = np.linalg.svd(np.hstack([half, np.zeros((2, 2))]))
        return turned, np.where(size > _NEGLIGIBLE * size[0], size, 0.0)

    def directions(self, view: Array) -> Array:
        """Return unit directions (2, k) in the picture along which the ellipsoid is infinite."""
        turned, size, _ = np.linalg.svd(np.hstack([view @ self.axes[:, self.endless], np.zeros((2, 2))]))
        return np.asarray(turned[:, size > _NEGLIGIBLE])


@dataclass(frozen=True)
class _Scene:
    """What a figure of the manipulability shows, in the observer's axes.

    Attributes:
        arm: the stick figure.
        point: the point whose velocity it is, (3,), m.
        shapes: the ellipsoids there.
    """

    arm: Skeleton
    point: Array
    shapes: tuple[_Shape, ...]

    @cached_property
    def size(self) -> float:
        """The largest extent of arm and point along an axis, in m; 1 where they are one point."""
        return float(np.ptp(np.vstack([self.arm.points, self.point]), axis=0).max()) or 1.0

    def reach_of_arrows(self, view: Array) -> float:
        """Return how far an infinite axis is drawn from the point: beyond whatever is finite there, in m."""
        return max(0.3 * self.size, *(1.25 * float(shape.shadow(view)[1][0]) for shape in self.shapes))

    def extent(self, view: Array) -> Array:
        """Return the lower and the upper corner (2, 2) of what a view shows, in m."""
        corners = [view @ point for point in (*self.arm.points, self.point)]
        middle = view @ self.point
        for shape in self.shapes:
            turned, half = shape.shadow(view)
            around = np.linalg.norm(turned * half, axis=1)
            corners += [middle - around, middle + around]
            for direction in shape.directions(view).T:
                tip = self.reach_of_arrows(view) * direction
                corners += [middle - tip, middle + tip]
        return np.array([np.min(corners, axis=0), np.max(corners, axis=0)])


def manipulability_figure(model: Model, result: Manipulability, at: Configuration) -> Figure:
    """Return the arm as a stick figure with the ellipsoids of velocity and force at its point.

    A planar arm is drawn in its plane; any other from two sides at right angles, the one that shows more of it first.
    z of the observer points up wherever it can be seen. Ellipsoids are those of the block `task` where its rows are all
    linear, else of `translation`; what is seen of each is its shadow on the plane of the drawing.

    Args:
        model: the robot.
        result: its manipulability at one configuration.
        at: that configuration.
    """
    with _style():
        block = _drawn_block(result)
        scene = _scene(model, result, at, block)
        views = _views(scene.arm)
        shapes = _ellipsoid_entries(scene, views)
        symbols = _symbol_entries(scene, views)
        height = max(_legend_height([label for _, label in part]) for part in (shapes, symbols))
        boxes, panels = _panels([scene.extent(view) for view in views])
        title, lines = _manipulability_title(model, result, at, block)
        figure, axes = _sheet(panels, title, lines, height)
        for ax, view, box in zip(axes, views, boxes, strict=True):
            _draw_scene(ax, scene, view, box)
        _legends(figure, shapes, symbols, height)
        return figure


def _drawn_block(result: Manipulability) -> Block:
    task = result.blocks.get("task")
    return task if task is not None and task.task.linear and not task.task.angular else result.blocks["translation"]


def _manipulability_title(
    model: Model, result: Manipulability, at: Configuration, block: Block
) -> tuple[str, tuple[str, ...]]:
    """Return the title (robot, frame, observer), and lines: indices, configuration."""
    velocity = result.velocity
    title = f"{_name(model.robot.name, 40) or 'robot'}: {_name(velocity.of)} relative to {_name(velocity.relative_to)}"
    rows = f"task {' '.join(block.task.row_names)}" if block.task.name == "task" else block.task.name
    unit = "(mixed units)" if block.unit == "mixed" else block.unit.replace("1", "m/m")
    indices = (
        f"{rows}: Yoshikawa {_number(block.yoshikawa)}, smallest s {_number(block.minimum_singular_value)} {unit}, "
        f"smallest / largest s {_number(block.inverse_condition_number)}, isotropy {_number(block.isotropy)}"
    )
    weighted = () if result.weights is None else ("joint rates are weighted",)
    return title, (indices, _positions(model, result, at), *weighted)


def _positions(model: Model, result: Manipulability, at: Configuration) -> str:
    """Return the positions of the joints between observer and frame, in path order."""
    robot, shown, units = model.robot, list[str](), list[str]()
    for joint in robot.movable_path(result.velocity.relative_to, result.velocity.of):
        values = " ".join(f"{round(float(x), 4) + 0.0:.4g}" for x in at.q[robot.position_slices[joint.name]])
        shown.append(f"({values})" if joint.type.nq > 1 else values)
        units.append("" if joint.type.nq > 1 else " rad" if joint.type.is_angle else " m")
    for i, (unit, following) in enumerate(zip(units, [*units[1:], ""], strict=True)):
        shown[i] += "" if unit == following else unit  # once, after the last of several
    return f"at q = {', '.join(shown)}"


def _number(value: Any) -> str:
    number = float(value)
    return "∞" if math.isinf(number) else f"{number:.3g}" if abs(number) > 1e-14 else "0"


def _scene(model: Model, result: Manipulability, at: Configuration, block: Block) -> _Scene:
    velocity = result.velocity
    arm = skeleton(model, velocity.of, at.q, velocity.relative_to)
    point = np.zeros(3)
    if velocity.point is not None:
        placement = model.engine.placement(at.q, velocity.of, velocity.relative_to)
        point = placement[:3, :3] @ np.array(velocity.point) + placement[:3, 3]
    turned = model.engine.placement(at.q, velocity.expressed_in, velocity.relative_to)[:3, :3]
    empty = _Scene(arm, point, ())
    shapes = []
    for name, ellipsoid, unitless in (("velocity", block.velocity, "m/m"), ("force", block.force, "N/N")):
        unit = {"1": unitless, "mixed": "mixed units"}.get(ellipsoid.unit, ellipsoid.unit)
        axes = turned[:, block.task.rows] @ ellipsoid.axes
        shapes.append(_Shape(name, axes, ellipsoid.lengths, unit, _scale(ellipsoid.lengths, empty.size)))
    return _Scene(arm, point, tuple(shapes))


def _scale(lengths: Array, size: float) -> float:
    """Return metres per unit, 1, 2, 3 or 5 times a power of ten, that make the longest finite axis readable."""
    longest = max((float(length) for length in lengths if np.isfinite(length)), default=0.0)
    if longest == 0:
        return 1.0
    return _round(_LONGEST_AXIS * size / longest, (1, 2, 3, 5))


def _round(value: float, steps: Sequence[float], *, up: bool = False) -> float:
    """Return the nearest of the steps times a power of ten that is not above the value (`up`: not below)."""
    power = math.floor(math.log10(value))
    rounds = [float(f"{step}e{power}") for step in steps]
    slack = 1e-12 * value
    return min(r for r in rounds if r >= value - slack) if up else max(r for r in rounds if r <= value + slack)


# --- views: what is drawn of space


def _views(arm: Skeleton) -> list[Array]:
    """Return the drawing planes, each (2, 3): what is to the right and what is up, in the observer's axes."""
    points, axis = arm.points, arm.turning_axis
    if arm.normal is not None:
        plane = _plane(arm.normal)
        if len(points) == 1 or np.ptp(points @ plane.T, axis=0).max() > _NEGLIGIBLE * np.ptp(points, axis=0).max():
            return [plane]
    spread, upright = _spread(points), np.array([0.0, 0.0, 1.0])
    if axis is not None and sum(pivot.kind == "turning" for pivot in arm.pivots) > 1:  # a SCARA: from above
        return [_plane(axis), _plane(_least_spread(spread, axis))]
    aside = _least_spread(spread, upright)
    front = _plane(aside)
    if spread[2, 2] < aside @ spread @ aside * (1 - 1e-9):
        return [_plane(upright), front]
    return [front, _plane(front[0])]


def _least_spread(spread: Array, across: Array) -> Array:
    """Return the direction (3,) at right angles to another along which the arm extends least.

    A direction of the observer's axes reads easier, and wins where it hides hardly more.
    """
    plane = _plane(across)
    values, vectors = np.linalg.eigh(plane @ spread @ plane.T)
    least: Array = vectors[:, 0] @ plane
    for axis in np.eye(3):
        if abs(axis @ across) < _NEGLIGIBLE and axis @ spread @ axis - values[0] <= 0.05 * np.trace(spread):
            least = axis
    return least


def _plane(normal: Array) -> Array:
    """Return right and up (2, 3) of the plane across a normal: z up where it can be seen, else x to the right."""
    x, z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    seen = z - (z @ normal) * normal
    if np.linalg.norm(seen) > 1e-3:
        up = seen / np.linalg.norm(seen)
        right = np.cross(up, normal)
        first = right[np.argmax(np.abs(right) > 1e-9)]
        return np.array([right * np.sign(first), up])
    right = x - (x @ normal) * normal
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(normal * np.sign(normal[2]), right)])


def _spread(points: Array) -> Array:
    """Return the second moments (3, 3) of the lines between points (k, 3) about their centre, per length."""
    start, end = points[:-1], points[1:]
    length = np.linalg.norm(end - start, axis=1)
    if not length.sum() > 0:
        return np.zeros((3, 3))
    weight = length / length.sum()
    centre = weight @ (start + end) / 2
    start, end = start - centre, end - centre
    both = start + end
    spread: Array = sum((part.T * weight) @ part for part in (start, end, both)) / 6  # exact, for a uniform line
    return spread


def _panels(extents: Sequence[Array]) -> tuple[list[Array], list[tuple[float, float]]]:
    """Return limits (2, 2) of each panel's axes in m, and its size in inches: all to one scale, equally high."""
    spans = np.array([upper - lower for lower, upper in extents])
    room = 2 * _SYMBOL_ROOM
    available = _WIDTH - _LEFT - _RIGHT - (_GAP + room) * (len(extents) - 1) - room
    inches = min(
        available / max(spans[:, 0].sum(), 1e-300), (_LARGEST_PANEL - room) / max(float(spans[:, 1].max()), 1e-300)
    )
    tall = max(_SMALLEST_PANEL, float(spans[:, 1].max()) * inches + room)
    boxes, panels = [], []
    for (lower, upper), span in zip(extents, spans, strict=True):
        size = np.array([max(_SMALLEST_PANEL, float(span[0]) * inches + room), tall])
        half, middle = size / inches / 2, (lower + upper) / 2
        boxes.append(np.array([middle - half, middle + half]))
        panels.append((float(size[0]), tall))
    return boxes, panels


# --- drawing


def _draw_scene(ax: Any, scene: _Scene, view: Array, box: Array) -> None:
    """Draw one view of the scene within the limits `box` (2, 2)."""
    arm, middle = scene.arm.points @ view.T, view @ scene.point
    ax.set(xlim=box[:, 0], ylim=box[:, 1])
    ax.grid(visible=True)
    _ticks(ax)
    _plain(ax.set_xlabel(f"{_direction(view[0])} [m]"))
    _plain(ax.set_ylabel(f"{_direction(view[1])} [m]"))
    ax.plot(*arm.T, color=_INK, linewidth=3.2, solid_joinstyle="round", solid_capstyle="round", zorder=3, label="arm")
    if np.linalg.norm(scene.point - scene.arm.points[-1]) > _NEGLIGIBLE * scene.size:
        ax.plot(*np.array([arm[-1], middle]).T, color=_INK, linewidth=1, linestyle=":", zorder=3)
    _symbol_line(ax, arm[0], _GROUND, _GROUND_STYLE, 2.9)
    for pivot in scene.arm.pivots:
        path, style = _symbol(pivot, view)
        _symbol_line(ax, arm[pivot.vertex], path, style, 4)
    for shape in scene.shapes:
        _draw_shape(ax, scene, shape, view)
    _symbol_line(ax, arm[-1], _TOOL, _TOOL_STYLE, 5)


_TICKS = (1, 2, 2.5, 5, 10)


def _ticks(ax: Any) -> None:
    """Set ticks a round number of metres apart, the same on both axes of a picture to scale if there is room."""
    from matplotlib.ticker import MultipleLocator

    width = float((ax.get_position().size * ax.figure.get_size_inches())[0])
    inch = float(np.diff(ax.get_xlim())[0]) / width
    for axis, near in ((ax.xaxis, 0.45), (ax.yaxis, 0.25)):
        low, high = axis.get_view_interval()
        step = _round(0.55 * inch, _TICKS, up=True)
        if high - low < 2.5 * step:
            step = _round(near * inch, _TICKS, up=True)
        axis.set_major_locator(MultipleLocator(step))


def _direction(axis: Array) -> str:
    """Return a direction in words: x, or 0.87 x + 0.5 y."""
    terms = [(float(c), letter) for c, letter in zip(axis, "xyz", strict=True) if abs(c) > 5e-4]
    words = ""
    for value, letter in terms:
        sign = (" - " if value < 0 else " + ") if words else ("-" if value < 0 else "")
        size = f"{abs(value):.3g}"
        words += f"{sign}{letter}" if size == "1" else f"{sign}{size} {letter}"
    return words


def _shape_style(name: str) -> dict[str, Any]:
    """Return how an ellipsoid is outlined: not by its colour alone."""
    if name == "velocity":
        return {"color": _BLUE, "linewidth": 1.6, "linestyle": "-"}
    return {"color": _VERMILION, "linewidth": 1.6, "linestyle": (0, (3.2, 1.6))}


def _fill(name: str) -> tuple[str, float]:
    return (_BLUE, 0.22) if name == "velocity" else (_VERMILION, 0.16)


def _draw_shape(ax: Any, scene: _Scene, shape: _Shape, view: Array) -> None:
    """Draw an ellipsoid's shadow: an ellipse, a line, or nothing; and arrows where it is infinite."""
    from matplotlib.patches import Ellipse, FancyArrowPatch

    middle, style = view @ scene.point, _shape_style(shape.name)
    turned, half = shape.shadow(view)
    if half[1] > 0:
        angle = math.degrees(math.atan2(turned[1, 0], turned[0, 0]))
        size = {"width": 2 * half[0], "height": 2 * half[1], "angle": angle}
        outline = {"edgecolor": style["color"], "linewidth": style["linewidth"], "linestyle": style["linestyle"]}
        ax.add_patch(
            Ellipse(
                (float(middle[0]), float(middle[1])),
                **size,
                facecolor=_fill(shape.name),
                **outline,
                zorder=2,
                label=shape.name,
            )
        )
    elif half[0] > 0:
        ends = np.array([middle - turned[:, 0] * half[0], middle + turned[:, 0] * half[0]])
        style["linewidth"] = 3.6 if shape.name == "velocity" else 1.8
        ax.plot(*ends.T, **style, solid_capstyle="butt", zorder=4.5 if shape.name == "force" else 4.4, label=shape.name)
    for direction in shape.directions(view).T:
        tip = scene.reach_of_arrows(view) * direction
        ax.add_patch(
            FancyArrowPatch(
                middle - tip,
                middle + tip,
                arrowstyle="<|-|>,head_length=5,head_width=2.2",
                shrinkA=0,
                shrinkB=0,
                color=style["color"],
                linewidth=1.1,
                zorder=4.6,
                label=f"{shape.name} without bound",
            )
        )
        away = direction * (1 if direction @ (middle - np.mean(scene.arm.points, axis=0) @ view.T) >= 0 else -1)
        _infinity(ax, middle + scene.reach_of_arrows(view) * away, 8 * away, style["color"])


def _infinity(ax: Any, tip: Array, offset: Array, colour: str) -> None:
    """Write the sign of infinity beside the tip of an arrow, `offset` (2,) points away."""
    ax.annotate(
        "∞", tip, offset, textcoords="offset points", ha="center", va="center", color=colour, fontsize=11, zorder=6
    )


# --- symbols: shapes in points, on the page

_Verts = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class _Symbol:
    """Polylines in points, around the place that they mark."""

    lines: tuple[_Verts, ...]
    closed: bool

    def path(self) -> Any:
        """Return it as a path."""
        from matplotlib.path import Path as Outline

        vertices, codes = [], list[Any]()
        for line in self.lines:
            vertices += [*line, line[0]] if self.closed else list(line)
            codes += [Outline.MOVETO, *[Outline.LINETO] * (len(line) - 1), *[Outline.CLOSEPOLY] * self.closed]
        return Outline(np.array(vertices), np.array(codes, dtype=np.uint8))

    @property
    def size(self) -> float:
        """Its marker size: twice its largest coordinate, as matplotlib scales marker paths."""
        return 2 * max(abs(c) for line in self.lines for point in line for c in point)


_WHITE: dict[str, Any] = {"markerfacecolor": "white", "markeredgecolor": _INK, "markeredgewidth": 1.3}
_GROUND = _Symbol(
    (
        ((0, 0), (-6, -8), (6, -8), (0, 0)),
        ((-10, -8), (10, -8)),
        *(((x, -8.0), (x - 4.0, -12.0)) for x in (-6.0, -2.0, 2.0, 6.0, 10.0)),
    ),
    closed=False,
)
_GROUND_IN_LEGEND = _Symbol(tuple(tuple((x, y + 6) for x, y in line) for line in _GROUND.lines), closed=False)
_GROUND_STYLE = {"markerfacecolor": "none", "markeredgecolor": "#555555", "markeredgewidth": 0.9}
_TOOL = _Symbol((((0, 4.6), (4.6, 0), (0, -4.6), (-4.6, 0)),), closed=True)
_TOOL_STYLE = {"markerfacecolor": _INK, "markeredgecolor": "white", "markeredgewidth": 0.9}
_TURNS = ("turning", "screw")
_ACROSS = 0.35  # an axis that is seen shorter than this is seen end-on


def _symbol_line(ax: Any, where: Array, symbol: _Symbol, style: dict[str, Any], zorder: float) -> None:
    ax.plot(
        [where[0]], [where[1]], linestyle="none", marker=symbol.path(), markersize=symbol.size, **style, zorder=zorder
    )


def _symbol(pivot: Pivot, view: Array) -> tuple[_Symbol, dict[str, Any]]:
    """Return the symbol of a joint as a view shows it, and its style."""
    seen = view @ pivot.axis
    length = float(np.linalg.norm(seen))
    if pivot.kind in ("planar", "floating"):
        return _DIAMOND, _WHITE
    if length < _ACROSS:
        return (_CIRCLE if pivot.kind in _TURNS else _SQUARE), _WHITE
    return _along(_BAR if pivot.kind in _TURNS else _SLIDE, seen / length), _WHITE


def _along(symbol: _Symbol, direction: Array) -> _Symbol:
    """Return a symbol drawn along x turned to a direction (2,)."""
    c, s = (float(part) for part in direction)
    return _Symbol(
        tuple(tuple((c * x - s * y, s * x + c * y) for x, y in line) for line in symbol.lines), symbol.closed
    )


def _box(x: float, y: float) -> _Verts:
    return ((-x, -y), (x, -y), (x, y), (-x, y))


_CIRCLE = _Symbol(
    (tuple((5.2 * math.cos(t * math.pi / 24), 5.2 * math.sin(t * math.pi / 24)) for t in range(48)),), closed=True
)
_BAR = _Symbol((_box(8, 3.4),), closed=True)
_SQUARE = _Symbol((_box(4.6, 4.6),), closed=True)
_SLIDE = _Symbol((((-10, 0), (-4.6, 0)), _box(4.6, 4.6), ((4.6, 0), (10, 0))), closed=True)
_DIAMOND = _Symbol((((0, 6.5), (6.5, 0), (0, -6.5), (-6.5, 0)),), closed=True)


def _handle(symbol: _Symbol, style: dict[str, Any]) -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], linestyle="none", marker=symbol.path(), markersize=symbol.size * 0.8, **style)


def _symbol_entries(scene: _Scene, views: Sequence[Array]) -> list[tuple[Any, str]]:
    """Return legend entries for the symbols that the views show."""
    words = {
        ("turning", False): (_CIRCLE, "joint that turns, its axis end-on"),
        ("turning", True): (_BAR, "joint that turns about the bar"),
        ("sliding", False): (_SQUARE, "joint that slides, its axis end-on"),
        ("sliding", True): (_SLIDE, "joint that slides along the line"),
        ("planar", True): (_DIAMOND, "joint that moves in a plane, or floats"),
    }
    shown = set()
    for pivot in scene.arm.pivots:
        free = pivot.kind in ("planar", "floating")
        for view in views:
            seen = free or bool(np.linalg.norm(view @ pivot.axis) >= _ACROSS)
            shown.add(("planar" if free else "turning" if pivot.kind in _TURNS else "sliding", seen))
    entries = [
        (_handle(_GROUND_IN_LEGEND, _GROUND_STYLE), f"{_name(scene.arm.relative_to)} (observer)"),
        (_handle(_TOOL, _TOOL_STYLE), f"{_name(scene.arm.frame)} (frame)"),
    ]
    return entries + [(_handle(symbol, _WHITE), text) for key, (symbol, text) in words.items() if key in shown]


def _ellipsoid_entries(scene: _Scene, views: Sequence[Array]) -> list[tuple[Any, str]]:
    """Return legend entries for the ellipsoids: scale, lengths of their axes, what is infinite."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries = list[tuple[Any, str]]()
    for shape in scene.shapes:
        style = _shape_style(shape.name)
        outline = {"edgecolor": style["color"], "linewidth": style["linewidth"], "linestyle": style["linestyle"]}
        entries.append((Patch(facecolor=_fill(shape.name), **outline), _shape_label(shape, views)))
        if any(shape.directions(view).size for view in views):
            line = Line2D([], [], color=style["color"], linewidth=1.1, marker=">", markersize=4, markevery=[1])
            entries.append((line, f"{shape.name} without bound: held without any torque"))
    return entries


def _shape_label(shape: _Shape, views: Sequence[Array]) -> str:
    lengths = ", ".join(_number(length) for length in sorted(shape.lengths, reverse=True))
    if len(views) == 1 and shape.directions(views[0]).shape[1] < np.sum(shape.endless):
        lengths = lengths.replace("∞", "∞ (end-on)", 1)
    mixed = shape.unit == "mixed units"
    unit, kind = ("", " (mixed units)") if mixed else (f" {shape.unit}", "")
    finite = np.any(np.isfinite(shape.lengths) & (shape.lengths > 0))
    drawn = f"1{unit} drawn as {shape.scale:g} m" if finite else "without bound" if shape.endless.any() else "a point"
    return f"{shape.name} ellipsoid{kind}: {drawn}\nsemi-axes {lengths}{unit}"


# --- slices ----------------------------------------------------------------------------------------------------

_SLICE_PANEL = 4.7  # in, a square
_BAR_ROOM = 1.15  # in, beside a panel: a colour bar with its ticks and label
_CURVE: dict[str, Any] = {"color": _VERMILION, "linewidth": 2.0}
_OUTSIDE: dict[str, Any] = {"color": _VERMILION, "linewidth": 1.3, "linestyle": (0, (4, 2.2))}


def slice_figure(slice_: Slice, degrees: bool = False) -> Figure:
    """Return the smallest singular value over two joints as a map, with the singular curves on it.

    Args:
        slice_: what to draw.
        degrees: show angles in degrees, not in rad.
    """
    with _style():
        factors = [180 / math.pi if degrees and unit == "rad" else 1.0 for unit in slice_.units]
        x, y = slice_.x * factors[0], slice_.y * factors[1]
        entries = _slice_entries(slice_)
        height = _legend_height([label for _, label in entries])
        title = f"singularities over {_name(slice_.joints[0])} and {_name(slice_.joints[1])}"
        lines = ("smallest singular value of the length-scaled Jacobian; every other joint is held",)
        figure, (ax,) = _sheet([(_SLICE_PANEL, _SLICE_PANEL)], title, lines, height, _BAR_ROOM)
        image = ax.pcolormesh(x, y, slice_.smallest, cmap="cividis", norm=_norm(slice_.smallest), rasterized=True)
        _colour_bar(figure, ax, image, "smallest singular value")
        ax.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
        if _changes_sign(slice_):
            _cased(ax.contour(x, y, slice_.signed, levels=[0.0], colors=_VERMILION, linewidths=2.0, zorder=3))
        _draw_limits(ax, np.array(slice_.limits).T * factors)
        at = (slice_.at[0] * factors[0], slice_.at[1] * factors[1])
        _cased(ax.plot(*at, **_AT, zorder=8)[0])
        _draw_marks(ax, slice_.marks, factors, at)
        for axis, name, unit in zip((ax.xaxis, ax.yaxis), slice_.joints, slice_.units, strict=True):
            _angle_ticks(axis, unit, degrees=degrees)
            shown = "deg" if degrees and unit == "rad" else unit
            _plain(axis.set_label_text(f"{_name(name, 40)} [{shown}]"))
        _legend(figure, _LEFT, entries, height, _LEFT + _SLICE_PANEL)
        return figure


_AT: dict[str, Any] = {
    "marker": "o",
    "markersize": 6,
    "markerfacecolor": "white",
    "markeredgecolor": _INK,
    "linestyle": "none",
}


def _norm(values: Array) -> Any:
    """Return the map from values to colours: linear, or logarithmic where most values would look like zero."""
    from matplotlib.colors import LogNorm, Normalize

    finite = values[np.isfinite(values)]
    largest = float(finite.max(initial=0.0)) or 1.0
    if 0 < np.median(finite) < 0.05 * largest:
        return LogNorm(vmin=max(float(np.percentile(finite, 2)), 1e-6 * largest), vmax=largest, clip=True)
    return Normalize(0.0, largest)


def _changes_sign(slice_: Slice) -> bool:
    """Tell whether there is a curve to follow: not where all is singular, where the sign is rounding's."""
    if slice_.signed is None or not np.nanmax(slice_.smallest) > 1e-9:
        return False
    return bool(np.nanmin(slice_.signed) < 0 < np.nanmax(slice_.signed))


def _cased(artist: Any) -> Any:
    """Return the artist with a white rim, so that it is seen on any colour."""
    from matplotlib.patheffects import Normal, Stroke

    width = np.max(artist.get_linewidth())
    artist.set_path_effects([Stroke(linewidth=width + 1.8, foreground="white"), Normal()])
    return artist


def _colour_bar(figure: Figure, ax: Any, image: Any, label: str) -> None:
    width = float(figure.get_size_inches()[0])
    box = ax.get_position()
    bar = figure.colorbar(image, cax=figure.add_axes((box.x1 + 0.18 / width, box.y0, 0.16 / width, box.height)))
    bar.outline.set_linewidth(0.7)
    bar.set_label(label)


def _draw_limits(ax: Any, limits: Array) -> None:
    """Draw the limits, (2, 2) with the lower ones first, as a frame, and a veil over what is outside."""
    from matplotlib.patches import PathPatch, Rectangle
    from matplotlib.path import Path as Outline

    seen = np.array([ax.get_xlim(), ax.get_ylim()]).T
    inside = np.clip(limits, seen[0], seen[1])
    codes = [Outline.MOVETO, *[Outline.LINETO] * 3, Outline.CLOSEPOLY] * 2
    veil = Outline(np.vstack([_corners(seen), _corners(inside)[::-1]]), codes)
    ax.add_patch(PathPatch(veil, facecolor="white", alpha=0.6, linewidth=0, zorder=4, label="outside limits"))
    (x, y), (width, height) = map(float, inside[0]), map(float, inside[1] - inside[0])
    frame = Rectangle((x, y), width, height, fill=False, edgecolor=_INK, linewidth=1.1, zorder=5, label="limits")
    ax.add_patch(_cased(frame))


def _corners(box: Array) -> Array:
    """Return the corners (5, 2) of a box (2, 2), counter-clockwise, the first one again at the end."""
    (left, low), (right, high) = box
    return np.array([(left, low), (right, low), (right, high), (left, high), (left, low)])


def _angle_ticks(axis: Any, unit: str, *, degrees: bool) -> None:
    """Set ticks at multiples of half of pi, or of 45 or 90 degrees, where the range is more than half a turn."""
    from matplotlib.ticker import FuncFormatter, MultipleLocator

    low, high = axis.get_view_interval()
    half_turn = 180.0 if degrees else math.pi
    if unit != "rad" or high - low <= half_turn * (1 + 1e-9):
        return
    quarters = max(1, math.ceil((high - low) / (4 * half_turn)))
    axis.set_major_locator(MultipleLocator(quarters * half_turn / 2))
    if not degrees:
        axis.set_major_formatter(FuncFormatter(lambda value, _: _in_pi(value)))


def _in_pi(value: float) -> str:
    """Return a multiple of half of pi in words: 0, π/2, -3π/2, 2π."""
    halves = round(2 * value / math.pi)
    if halves == 0:
        return "0"
    sign, count = "-" if halves < 0 else "", abs(halves)
    whole, half = divmod(count, 2)
    if half:
        return f"{sign}{'' if count == 1 else count}π/2"
    return f"{sign}{'' if whole == 1 else whole}π"


def _draw_marks(ax: Any, marks: Sequence[Mark], factors: Sequence[float], at: tuple[float, float]) -> None:
    """Draw families as lines and points, and write their labels where they cover no other."""
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    inches = _SLICE_PANEL / np.array([right - left, high - low])
    origin = np.array([left, low])
    taken = [_around((np.array(at) - origin) * inches, 0.2, 0.2)]
    for mark in marks:
        x, y = (None if value is None else value * f for value, f in zip((mark.x, mark.y), factors, strict=True))
        if (x is not None and not left <= x <= right) or (y is not None and not low <= y <= high):
            continue
        style = _CURVE if mark.inside else _OUTSIDE
        if x is not None and y is not None:
            _cased(ax.plot([x], [y], marker="D", markersize=6, color=style["color"], linestyle="none", zorder=7)[0])
            taken.append(_around((np.array([x, y]) - origin) * inches, 0.15, 0.15))
        elif x is not None:
            _cased(ax.axvline(x, **style, zorder=6))
        elif y is not None:
            _cased(ax.axhline(y, **style, zorder=6))
        _label_mark(ax, _name(mark.label, 40), (x, y), (origin, inches), taken)


_Box = tuple[float, float, float, float]


def _around(middle: Array, wide: float, high: float) -> _Box:
    """Return the box (left, low, right, high) of a size about a point; all in inches in the panel."""
    return middle[0] - wide / 2, middle[1] - high / 2, middle[0] + wide / 2, middle[1] + high / 2


def _apart(one: _Box, other: _Box) -> bool:
    return one[2] < other[0] or other[2] < one[0] or one[3] < other[1] or other[3] < one[1]


def _label_mark(
    ax: Any, label: str, where: tuple[float | None, float | None], scale: tuple[Array, Array], taken: list[_Box]
) -> None:
    """Write a label on its line, or beside its point, at the first place that is free."""
    origin, inches = scale
    upright = where[1] is None
    wide, tall = _width(label, 8) + 0.08, 0.19
    size = (tall, wide) if upright else (wide, tall)
    place, box = None, None
    for middle in _places(where, origin, inches, size):
        place = np.clip(middle, np.array(size) / 2, _SLICE_PANEL - np.array(size) / 2)
        box = _around(place, *size)
        if all(_apart(box, other) for other in taken):
            break
    assert place is not None
    assert box is not None
    taken.append(box)
    frame = {"boxstyle": "round,pad=0.18", "facecolor": "white", "edgecolor": "none", "alpha": 0.88}
    text = {"ha": "center", "va": "center", "fontsize": 8, "color": _INK, "rotation": 90 if upright else 0}
    _plain(ax.text(*(origin + place / inches), label, **text, bbox=frame, zorder=9, clip_on=False))


def _places(
    where: tuple[float | None, float | None], origin: Array, inches: Array, size: tuple[float, float]
) -> Iterator[Array]:
    """Yield places for a label's middle, in inches in the panel, the best first."""
    x, y = where
    along = np.linspace(0.86, 0.08, 14) * _SLICE_PANEL
    if x is not None and y is not None:
        point = (np.array([x, y]) - origin) * inches
        reach = np.array([size[0] / 2 + 0.12, size[1] / 2 + 0.09])
        yield from (point + reach * np.array(side) for side in ((1, 1), (-1, 1), (1, -1), (-1, -1), (0, 2), (0, -2)))
    elif x is not None:
        yield from (np.array([(x - origin[0]) * inches[0], height]) for height in along)
    elif y is not None:
        yield from (np.array([height, (y - origin[1]) * inches[1]]) for height in along)


def _slice_entries(slice_: Slice) -> list[tuple[Any, str]]:
    """Return legend entries for what a slice shows."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries = list[tuple[Any, str]]()
    if _changes_sign(slice_) or any(mark.inside for mark in slice_.marks):
        entries.append((Line2D([], [], **_CURVE), "singular"))
    if any(not mark.inside for mark in slice_.marks):
        entries.append((Line2D([], [], **_OUTSIDE), "singular, with a joint outside its limits"))
    if any(low > x[0] or high < x[-1] for (low, high), x in zip(slice_.limits, (slice_.x, slice_.y), strict=True)):
        entries.append((Patch(facecolor="#d6d6d6", edgecolor="none"), "pale: outside the limits of these two joints"))
    return [*entries, (Line2D([], [], **_AT), "the configuration in which the other joints are held")]


# --- workspaces ------------------------------------------------------------------------------------------------

_BOLD_ORDER = 5
_BOLD = (_VERMILION, _INK, _PURPLE, _SKY)
_DASHES: tuple[Any, ...] = ("-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (5, 1.5, 1.2, 1.5)))
_GREY_DASHES: tuple[Any, ...] = ((0, (5, 2.5)), (0, (1.5, 1.8)), (0, (6, 2, 1.5, 2)))
_MANY = 1500  # points: beyond, they are a picture inside the SVG


def workspace_figure(workspace: Workspace) -> Figure:
    """Return where the tool of a planar arm gets, coloured by the smallest singular value, with its singular curves."""
    with _style():
        curves = _curve_styles(workspace)
        entries = _curve_entries(curves)
        halves = entries[: (len(entries) + 1) // 2], entries[(len(entries) + 1) // 2 :]
        height = max(_legend_height([label for _, label in half]) for half in halves)
        box, panel = _workspace_panel(workspace)
        a, b = (_name(axis) for axis in workspace.axes)
        lines = (f"tool positions at random joint positions inside limits, in the axes of {_name(workspace.observer)}",)
        figure, (ax,) = _sheet([panel], "workspace and singular curves", lines, height, _BAR_ROOM)
        ax.set(xlim=box[:, 0], ylim=box[:, 1])
        ax.grid(visible=True)
        _ticks(ax)
        _plain(ax.set_xlabel(f"{a} [m]"))
        _plain(ax.set_ylabel(f"{b} [m]"))
        if len(workspace.reached):
            points = ax.scatter(
                *workspace.reached.T,
                c=workspace.smallest,
                s=min(14.0, max(2.0, 20000 / len(workspace.reached))),
                linewidths=0,
                cmap="cividis",
                norm=_norm(workspace.smallest),
                rasterized=len(workspace.reached) > _MANY,
                zorder=2,
            )
            _colour_bar(figure, ax, points, "smallest singular value")
        for curve, style in curves:
            line = ax.plot(*curve.points.T, **style)[0]
            if style["zorder"] == _BOLD_ORDER:
                _cased(line)
        _legends(figure, *halves, height)
        return figure


def _workspace_panel(workspace: Workspace) -> tuple[Array, tuple[float, float]]:
    """Return the limits (2, 2) of the axes in m, and the panel's size in inches."""
    everything = [workspace.reached, *(curve.points for curve in (*workspace.curves, *workspace.unlimited))]
    points = np.vstack([np.reshape(part, (-1, 2)) for part in everything])
    points = points[np.all(np.isfinite(points), axis=1)]
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(2), np.ones(2))
    span = np.maximum(high - low, 0.3 * max(float((high - low).max()), 1e-9)) * 1.08
    size = span / max(float(span[0]) / (_WIDTH - _LEFT - _RIGHT - _BAR_ROOM), float(span[1]) / 4.6)
    middle = (low + high) / 2
    return np.array([middle - span / 2, middle + span / 2]), (float(size[0]), float(size[1]))


def _curve_styles(workspace: Workspace) -> list[tuple[Curve, dict[str, Any]]]:
    """Return every curve with its style: one style a label, singular ones bold, limits thin, unlimited ones grey."""
    styles, found = dict[tuple[str, str], dict[str, Any]](), []
    everything = [
        *(("singular", curve) for curve in workspace.curves if curve.kind == "singular"),
        *(("limit", curve) for curve in workspace.curves if curve.kind != "singular"),
        *(("unlimited", curve) for curve in workspace.unlimited),
    ]
    for kind, curve in everything:
        count = sum(known == kind for known, _ in styles)
        style = styles.setdefault((kind, curve.label), _curve_style(kind, count))
        found.append((curve, style))
    return found


def _curve_style(kind: str, index: int) -> dict[str, Any]:
    dashes = _DASHES[index // len(_BOLD) % len(_DASHES)]
    if kind == "singular":
        return {"color": _BOLD[index % len(_BOLD)], "linewidth": 2.2, "linestyle": dashes, "zorder": _BOLD_ORDER}
    if kind == "limit":
        return {"color": _INK, "linewidth": 0.9, "linestyle": _DASHES[index % len(_DASHES)], "zorder": 4}
    return {"color": _GREY, "linewidth": 1.3, "linestyle": _GREY_DASHES[index % len(_GREY_DASHES)], "zorder": 3}


def _curve_entries(curves: Sequence[tuple[Curve, dict[str, Any]]]) -> list[tuple[Any, str]]:
    """Return legend entries, one for each style and label."""
    from matplotlib.lines import Line2D

    entries = dict[str, Any]()
    for curve, style in curves:
        words = "singular, limits left out" if style["zorder"] == 3 else curve.kind
        shown = {key: value for key, value in style.items() if key != "zorder"}
        entries.setdefault(f"{words}: {_name(curve.label, 30)}", Line2D([], [], **shown))
    return [(handle, label) for label, handle in entries.items()]
