"""What the rules about joints share: which joints have a range or an axis, and findings that many have in common."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from kinetostat.errors import quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Rule
from kinetostat.lint.subject import first, name_of, number
from kinetostat.urdf.document import Element

__all__ = ["Found", "gathered", "has_axis", "has_range", "kind", "moves", "names", "span", "unit"]

_BOUNDED = ("revolute", "prismatic")
_FEW = 3  # joints found one by one; beyond it one finding stands for all


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


def names(joints: Iterable[Element], most: int = _FEW) -> str:
    """Return the names of joints, quoted; the first few of them if there are many."""
    listed = [quote(name_of(joint), 40) for joint in joints]
    return ", ".join(listed[:most]) + (", ..." if len(listed) > most else "")


@dataclass(frozen=True)
class Found:
    """Something found on a joint: where the finding points, and what it says."""

    joint: Element
    at: Element
    message: str
    attribute: str = ""


def gathered(
    rule: Rule, found: list[Found], *, severity: Severity | None = None, hint: str | None = None
) -> Iterator[Finding]:
    """Yield a finding for each of a few joints, or one at the first for all of them: many have it for one reason."""
    if len(found) <= _FEW:
        for each in found:
            yield rule.finding(each.at, each.message, attribute=each.attribute, severity=severity, hint=hint)
        return
    top, others = found[0], [each.joint for each in found[1:]]
    message = f"{top.message}; likewise {len(others)} more joints: {names(others)}"
    yield rule.finding(top.at, message, attribute=top.attribute, severity=severity, hint=hint)
