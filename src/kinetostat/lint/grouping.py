"""One thing that occurs many times is one finding: how it is counted and shown."""

from __future__ import annotations

from collections.abc import Collection

from kinetostat.errors import quote

__all__ = ["FEW", "listed", "times"]

FEW = 3  # findings of one kind that are told one by one; beyond it they are counted


def listed(names: Collection[str], few: int = FEW) -> str:
    """Return the first names, quoted, and how many more there are: `'a', 'b', 'c' and 9 more`."""
    shown = [quote(name) for name, _ in zip(names, range(few), strict=False)]
    more = len(names) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")


def times(count: int) -> str:
    """Return how often, in brackets; nothing if once."""
    return f" ({count} times)" if count > 1 else ""
