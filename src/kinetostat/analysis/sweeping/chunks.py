"""Sets of chunks as intervals: of a hundred thousand chunks done nearly in order, a few pairs of numbers are left."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Chunks"]


@dataclass(frozen=True, repr=False)
class Chunks:
    """A set of chunks.

    Attributes:
        intervals: (start, stop) each, ascending, disjoint and not adjacent; stop is the first that is not in it.
    """

    intervals: tuple[tuple[int, int], ...] = ()

    def __repr__(self) -> str:
        return f"<Chunks: {len(self)} in {len(self.intervals)} intervals>"

    def __len__(self) -> int:
        return sum(stop - start for start, stop in self.intervals)

    def __iter__(self) -> Iterator[int]:
        for start, stop in self.intervals:
            yield from range(start, stop)

    def __contains__(self, chunk: int) -> bool:
        at = bisect_right(self.intervals, chunk, key=lambda interval: interval[0]) - 1
        return at >= 0 and chunk < self.intervals[at][1]

    def and_also(self, *chunks: int) -> Chunks:
        """Return the set with some chunks more.

        Raises:
            ValueError: one is in it already: what it gives would count twice.
        """
        found = self
        for chunk in chunks:
            found = found._and_one(chunk)
        return found

    def _and_one(self, chunk: int) -> Chunks:
        if chunk in self:
            raise ValueError(f"chunk {chunk} is done twice")
        at = bisect_right(self.intervals, chunk, key=lambda interval: interval[0])
        before, after = self.intervals[:at], self.intervals[at:]
        start, stop = chunk, chunk + 1
        if before and before[-1][1] == start:
            start, before = before[-1][0], before[:-1]
        if after and after[0][0] == stop:
            stop, after = after[0][1], after[1:]
        return Chunks((*before, (start, stop), *after))

    def missing(self, count: int) -> Iterator[int]:
        """Yield those of 0 .. count - 1 that are not in it, ascending."""
        at = 0
        for start, stop in self.intervals:
            yield from range(at, start)
            at = stop
        yield from range(at, count)

    def array(self) -> NDArray[np.int64]:
        """Return the intervals as an array (k, 2)."""
        return np.array(self.intervals, dtype=np.int64).reshape(-1, 2)

    @classmethod
    def of(cls, array: NDArray[Any]) -> Chunks:
        """Return the set whose `array()` this is.

        Raises:
            ValueError: it cannot be one.
        """
        ends = array.ravel()
        if array.ndim != 2 or array.shape[1] != 2 or array.dtype != np.int64 or np.any(np.diff(ends) <= 0):
            raise ValueError("not intervals of chunks")
        if ends.size and ends[0] < 0:
            raise ValueError("a chunk before the first")
        return cls(tuple((int(start), int(stop)) for start, stop in array))
