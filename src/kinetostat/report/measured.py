"""Measures as people read them: names in words, shares in percent."""

from __future__ import annotations

from dataclasses import dataclass

from kinetostat.analysis.sweeping.measures import Column

__all__ = ["Reading", "reading"]

_WORDS = {
    "minimum_singular_value": "smallest singular value",
    "inverse_condition_number": "smallest / largest",
    "minimum_gradient": "gradient of the smallest",
}
_SHARES = ("effort_use", "limit_distance")


@dataclass(frozen=True)
class Reading:
    """How a column is shown.

    Attributes:
        measure: the measure in words.
        part: which part of it the column is; empty where it is all of it.
        unit: as shown.
        factor: what makes numbers in this unit of those in the column's.
    """

    measure: str
    part: str
    unit: str
    factor: float

    @property
    def name(self) -> str:
        """The column in words."""
        return f"{self.measure} {self.part}" if self.part else self.measure

    @property
    def title(self) -> str:
        """The column in words with its unit; none of a pure number."""
        return self.name if self.unit == "1" else f"{self.name} [{self.unit}]"


def reading(column: Column) -> Reading:
    """Return how a column is shown to people."""
    part = column.name.removeprefix(column.measure).removeprefix(".")
    unit, factor = ("%", 100.0) if column.measure in _SHARES else (column.unit, 1.0)
    return Reading(_WORDS.get(column.measure, column.measure.replace("_", " ")), part, unit, factor)
