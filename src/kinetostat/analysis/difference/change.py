"""One difference of two robots, with its size and unit, and what does not count as one."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Change", "Tolerance", "Value"]

Value = str | float | tuple[float, ...] | None


@dataclass(frozen=True)
class Tolerance:
    """What does not count: of lengths in m and angles in rad, and the share of masses, inertias, efforts and speeds."""

    absolute: float
    relative: float

    def apart(self, a: float, b: float) -> bool:
        """Return whether two lengths or angles differ; infinite ones are equal."""
        return a != b and not abs(a - b) <= self.absolute

    def differ(self, a: float, b: float) -> bool:
        """Return whether two masses, or what else has a share, differ."""
        return a != b and not abs(a - b) <= self.relative * max(abs(a), abs(b))


@dataclass(frozen=True)
class Change:
    """One difference.

    Attributes:
        kind: "added", "removed", "renamed" or "changed".
        element: "robot", "link", "joint" or "state".
        name: its name in A; in B, where it was added.
        attribute: what changed: "position", "effort", ...; empty where it is the whole element.
        before: what it was: a number, numbers, words, or None for nothing.
        after: what it is.
        size: how far apart they are, in `unit`; None where that is no number.
        unit: of the numbers and of the size.
    """

    kind: str
    element: str
    name: str
    attribute: str = ""
    before: Value = None
    after: Value = None
    size: float | None = None
    unit: str = ""
