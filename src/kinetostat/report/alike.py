"""What is alike, shown once."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

__all__ = ["alike"]

_One = TypeVar("_One")


def alike(every: Iterable[_One], same: Callable[[_One, _One], bool]) -> list[list[_One]]:
    """Return groups of what is the same as the first of its group, in the order in which they come."""
    groups = list[list[_One]]()
    for one in every:
        group = next((group for group in groups if same(group[0], one)), None)
        if group is None:
            groups.append([one])
        else:
            group.append(one)
    return groups
