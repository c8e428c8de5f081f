"""Numbers of results as the report holds them: plain floats, null where there is none."""

from __future__ import annotations

from typing import Any

from kinetostat.report.json import number

__all__ = ["finite"]


def finite(value: Any) -> float | None:
    """Return a number, of NumPy or of Python, as a float, -0.0 as 0.0; None for NaN, an infinity, or None."""
    return None if value is None else number(float(value) + 0.0)
