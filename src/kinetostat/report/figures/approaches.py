"""The figure of the way into a singular configuration: what grows on it, and what does not."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.report.error import joint_errors_in_words
from kinetostat.report.figures.sheet import BLUE, GREY, INK, VERMILION, Entry, house_style, named, sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kinetostat.analysis.approach import SingularApproach

__all__ = ["approach_figure"]

_PANEL = (2.5, 2.6)  # in
_SPEED: dict[str, Any] = {"color": VERMILION, "linewidth": 1.8}
_WORST: dict[str, Any] = {"color": BLUE, "linewidth": 1.8}
_SIGMA: dict[str, Any] = {"color": BLUE, "linewidth": 1.4, "linestyle": (0, (4, 2))}
_LIMIT: dict[str, Any] = {"color": INK, "linewidth": 1.0, "linestyle": (0, (1, 1.5))}
_BEYOND: dict[str, Any] = {"facecolor": "#ececec", "edgecolor": "none", "zorder": 0}


def approach_figure(approach: SingularApproach, degrees: bool = False) -> Figure:
    """Return joint motion and joint speed (left) and tool error (right) against the distance that is left.

    Args:
        approach: what to draw.
        degrees: show angles in degrees, not in rad.
    """
    angle, turn = ("deg", 180 / math.pi) if degrees else ("rad", 1.0)
    before = np.isfinite(approach.motion) & (approach.remaining > 0)
    x, motion = approach.remaining[before] * turn, approach.motion[before]
    with house_style():
        figure, (left, right) = sheet(
            [_PANEL, _PANEL], _title(approach), _lines(approach, degrees), [_entries(approach, degrees)]
        )
        left.loglog(x, motion * approach.speed * turn, **_SPEED, label="speed")
        left.set_ylabel(f"joint speed for {_tool_speed(approach, degrees)} [{angle}/s]", labelpad=2)
        _mark_limit(left, approach, turn)
        _draw_errors(right, approach, before, x, degrees)
        for ax in (left, right):
            ax.set_xscale("log")
            ax.set_xlim(x[0], x[-1])  # the singularity is on the right
            ax.set_xlabel(f"joint motion left [{angle}]")
            ax.xaxis.set_major_formatter("{x:g}")
            ax.grid(visible=True)
        left.yaxis.set_major_formatter("{x:g}")
        return figure


def _title(approach: SingularApproach) -> str:
    end = "a singular configuration" if approach.singular else "another configuration"
    return f"{named(approach.velocity.of)} on the way into {end}"


def _tool_speed(approach: SingularApproach, degrees: bool) -> str:
    if approach.unit == "m":
        return f"{approach.speed:g} m/s"
    return f"{math.degrees(approach.speed):g} deg/s" if degrees else f"{approach.speed:g} rad/s"


def _lines(approach: SingularApproach, degrees: bool) -> list[str]:
    """Return what is to be said above the panels."""
    arm = approach.mechanism
    turned = np.where(arm.turning, 180 / math.pi if degrees else 1.0, 1.0)
    places = list(arm.indices)
    ends = zip(approach.names, approach.start[places], approach.end[places], turned, strict=True)
    moved = [f"{named(name, 24)} {a * t:.4g} to {b * t:.4g}" for name, a, b, t in ends if a != b]
    shown = ", ".join(moved[:4]) + (", ..." if len(moved) > 4 else "")
    rows = f"rows that count: {' '.join(arm.task.row_names)}"
    if arm.task.mixed:
        rows += f", turns as arcs of radius {approach.length:.3g} m"
    if not all(arm.turning):
        rows += f", slides as angles q / {approach.length:.3g} m"
    return [f"relative to {named(approach.velocity.relative_to)}: {shown} ({'deg' if degrees else 'rad'})", rows]


def _entries(approach: SingularApproach, degrees: bool) -> list[Entry]:
    """Return the legend."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    errors = joint_errors_in_words(approach.joint_error, approach.mechanism.turning, degrees=degrees)
    found: list[Entry] = [
        (Line2D([], [], **_SPEED), "joint speed in the worst direction: grows as 1 / smallest singular value"),
        (Line2D([], [], **_WORST), f"tool error by {errors}, worst case"),
        (Line2D([], [], **_SIGMA), f"tool error by {errors}, root mean square"),
    ]
    if approach.limit_at is not None:
        joint = named(approach.limit_at[1])
        found.append((Patch(**_BEYOND), f"{joint} would have to be faster than its velocity limit"))
    return found


def _mark_limit(ax: Any, approach: SingularApproach, turn: float) -> None:
    """Shade where a velocity limit is exceeded, and say from where on."""
    if approach.limit_at is None:
        return
    at = approach.limit_at[0] * turn
    ax.axvspan(at, approach.remaining[-2] * turn, **_BEYOND, label="beyond")
    ax.axvline(at, **_LIMIT, label="limit")
    inside = approach.limit_at[0] > 0.01 * approach.remaining[0]  # there is room to the right
    place: dict[str, Any] = {"xytext": (3 if inside else -3, -2), "ha": "left" if inside else "right", "va": "top"}
    place |= {"xycoords": ("data", "axes fraction"), "textcoords": "offset points", "fontsize": 8, "color": INK}
    ax.annotate(f"{at:.2g} {'rad' if turn == 1.0 else 'deg'}", (at, 1.0), **place)


def _draw_errors(ax: Any, approach: SingularApproach, before: Any, x: Any, degrees: bool) -> None:
    """Draw the tool error from zero on: it stays what it is."""
    small, factor = ("mm", 1e3) if approach.unit == "m" else ("deg", 180 / math.pi) if degrees else ("mrad", 1e3)
    worst, sigma = approach.worst[before] * factor, approach.sigma[before] * factor
    ax.plot(x, worst, **_WORST, label="worst")
    ax.plot(x, sigma, **_SIGMA, label="sigma")
    ax.set_ylim(0, 1.15 * float(np.max(worst, initial=0.0)) or 1.0)
    ax.set_ylabel(f"tool error [{small}]", labelpad=2)
    ax.axhline(0, color=GREY, linewidth=0.7)
