"""What the rules about joints share: which joints have a range or an axis."""

from __future__ import annotations

from kinetostat.lint.subject import first, number
from kinetostat.urdf.document import Element

__all__ = ["has_axis", "has_range", "kind", "moves", "span", "unit"]

_BOUNDED = ("revolute", "prismatic")


def kind(joint: Element) -> str:
    """Return the type of a joint; empty without one."""
    return joint.attributes.get("type", "")


def unit(joint: Element) -> str:
    """Return the unit of a joint's position."""
    return "m" if kind(joint) == "prismatic" else "rad"


def has_range(joint: Element) -> bool:
    """Return whether a joint of this type must have a range."""
    return kind(joint) in _BOUNDED


def moves(joint: Element) -> bool:
    """Return whether a joint of this type has one position: only such a joint can follow or lead."""
    return kind(joint) in (*_BOUNDED, "continuous", "screw")


def has_axis(joint: Element) -> bool:
    """Return whether the axis of a joint of this type has a meaning."""
    return moves(joint) or kind(joint) == "planar"


def span(joint: Element) -> tuple[float, float] | None:
    """Return the range of a revolute or prismatic joint; None if it is not given, infinite, empty or reversed."""
    limit = first(joint, "limit")
    lower, upper = number(limit, "lower"), number(limit, "upper")
    if not has_range(joint) or lower is None or upper is None or lower >= upper:
        return None
    return lower, upper
