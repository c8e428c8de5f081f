"""What many numbers add up to, the same to the bit in any order: sum, extremes, quantiles, histogram, shares.

Chunks of numbers become `Tally`s, which merge: integers are added, extremes compared, nothing is rounded. A tally of
10^9 numbers is as large as one of a thousand.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinetostat.conventions import Array

__all__ = ["ACCURACY", "Counts", "Histogram", "Integers", "Peak", "State", "Tally"]

_MANTISSA = 10  # bits of the mantissa that tell bins apart
_SHIFT = 52 - _MANTISSA
ACCURACY = 2.0 ** -(_MANTISSA + 1)  # relative error of a quantile; of denormals, below 1e-310
_UNIT = 1074  # every finite float64 is a whole multiple of 2^-1074

Integers = NDArray[np.int64]
State = dict[str, NDArray[Any]]


@dataclass(frozen=True)
class Peak:
    """The largest (or smallest) of some numbers, and the row where it is: of equal ones, the first row."""

    value: float
    row: int

    def better(self, other: Peak | None, sign: int) -> Peak:
        """Return the larger of two (sign 1), or the smaller (sign -1)."""
        if other is None or (sign * self.value, -self.row) > (sign * other.value, -other.row):
            return self
        return other


@dataclass(frozen=True)
class Counts:
    """How many positive numbers lie in each bin: bins of equal exponent and leading bits of the mantissa.

    Attributes:
        first: the number of the first bin: the leading bits of the floats in it, as an integer.
        counts: of this bin and those after it. (b,).
    """

    first: int
    counts: Integers

    @classmethod
    def of(cls, values: Array, smallest: float, largest: float) -> Counts:
        """Return the counts of positive finite numbers, whose ends are known. (m,)."""
        bins, first, width = _bins(values, smallest, largest)
        return cls(first, np.bincount(bins, minlength=width))

    @classmethod
    def of_signs(cls, values: Array, sizes: Array) -> tuple[Counts, Counts]:
        """Return counts of the sizes of negative numbers, and of positive ones; none is zero. (m,), (m,)."""
        bins, first, width = _bins(sizes, float(np.min(sizes)), float(np.max(sizes)))
        bins += (values.view(np.int64) >> 63) & width  # both in one pass: negative numbers beyond positive ones
        counts = np.bincount(bins, minlength=2 * width)
        return cls(first, counts[width:])._trimmed(), cls(first, counts[:width])._trimmed()

    def _trimmed(self) -> Counts:
        """Return the same without empty bins at the ends."""
        used = self.counts > 0
        first, after = int(np.argmax(used)), len(used) - int(np.argmax(used[::-1]))
        return Counts(self.first + first, self.counts[first:after]) if used[first] else _NONE

    def merged(self, other: Counts) -> Counts:
        """Return the counts of both."""
        if not len(other.counts):
            return self
        if not len(self.counts):
            return other
        first = min(self.first, other.first)
        last = max(self.first + len(self.counts), other.first + len(other.counts))
        counts = np.zeros(last - first, dtype=np.int64)
        for one in (self, other):
            counts[one.first - first : one.first - first + len(one.counts)] += one.counts
        return Counts(first, counts)

    @property
    def edges(self) -> Array:
        """The ends of the bins, in order. (b + 1,)."""
        edges = (np.arange(self.first, self.first + len(self.counts) + 1) << _SHIFT).view(np.float64)
        finite: Array = np.minimum(edges, np.finfo(np.float64).max)
        return finite

    @property
    def middles(self) -> Array:
        """The middle of each bin. (b,)."""
        edges = self.edges
        middles: Array = edges[:-1] + (edges[1:] - edges[:-1]) / 2
        return middles

    def up_to(self, values: Array, ends: tuple[float, float]) -> Array:
        """Return how many are below values (k,) between the ends, those of a bin being spread evenly over it. (k,)."""
        if not len(self.counts):
            return np.zeros(len(values))
        edges, before = np.clip(self.edges, *ends), np.concatenate([[0], np.cumsum(self.counts)])
        bins = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(self.counts) - 1)
        width = np.diff(edges)[bins]
        share = np.clip((values - edges[bins]) / np.where(width > 0, width, 1.0), 0.0, 1.0)
        found: Array = before[bins] + self.counts[bins] * np.where(values < edges[-1], share, 1.0)
        return found


def _bins(values: Array, smallest: float, largest: float) -> tuple[Integers, int, int]:
    """Return in which bin positive numbers are, the first being 0; the first one's number, and how many there are."""
    first, last = (int(np.float64(end).view(np.int64)) >> _SHIFT for end in (smallest, largest))
    bins = values.view(np.int64) >> _SHIFT
    bins -= first
    return bins, first, last - first + 1


_NONE = Counts(0, np.zeros(0, dtype=np.int64))


@dataclass(frozen=True)
class Histogram:
    """Counts of numbers between edges: (b + 1,), (b,). A number within `ACCURACY` of an edge may be beside it."""

    edges: Array
    counts: Integers


@dataclass(frozen=True, repr=False)
class Tally:
    """What is known of some numbers. Merging is associative and commutative to the bit.

    Attributes:
        invalid: how many are not a number (NaN).
        infinite: how many are minus and plus infinity.
        zeros: how many are zero.
        negative: counts of the sizes of negative numbers.
        positive: counts of positive numbers.
        total: the sum of the chunks' sums of finite numbers, in units of 2^-1074: whole numbers are added exactly.
        minimum: the smallest, None where there is no number.
        maximum: the largest.
        below: how many are below each of the thresholds that the question has.
        above: how many are above each of its other thresholds.
    """

    invalid: int = 0
    infinite: tuple[int, int] = (0, 0)
    zeros: int = 0
    negative: Counts = _NONE
    positive: Counts = _NONE
    total: int = 0
    minimum: Peak | None = None
    maximum: Peak | None = None
    below: tuple[int, ...] = ()
    above: tuple[int, ...] = ()

    def __repr__(self) -> str:
        return f"<Tally of {self.count} numbers>"

    @classmethod
    def of(cls, values: Array, start: int = 0, below: tuple[float, ...] = (), above: tuple[float, ...] = ()) -> Tally:
        """Return what is to be known of the numbers of one chunk.

        Args:
            values: the numbers. (m,).
            start: the row of the first of them.
            below: thresholds that numbers are to be below of.
            above: thresholds that they are to be above of.
        """
        less = tuple(int(np.count_nonzero(values < threshold)) for threshold in below)
        more = tuple(int(np.count_nonzero(values > threshold)) for threshold in above)
        if not len(values):
            return cls(below=less, above=more)
        values = np.ascontiguousarray(values)
        low, high = int(np.argmin(values)), int(np.argmax(values))
        ends = Peak(float(values[low]), start + low), Peak(float(values[high]), start + high)
        if ends[0].value > 0 and ends[1].value < math.inf:  # no NaN either, which argmin would have found
            positive = Counts.of(values, ends[0].value, ends[1].value)
            return cls(
                positive=positive, total=_exact(values), minimum=ends[0], maximum=ends[1], below=less, above=more
            )
        sizes = np.abs(values)
        if float(np.min(sizes)) > 0 and float(np.max(sizes)) < math.inf:
            parts = Counts.of_signs(values, sizes)
            return cls(0, (0, 0), 0, *parts, _exact(values), *ends, less, more)
        return cls._of_any(values, start, less, more)

    @classmethod
    def _of_any(cls, values: Array, start: int, below: tuple[int, ...], above: tuple[int, ...]) -> Tally:
        """Return the same of numbers among which there are zeros, infinite ones, or some that are none."""
        invalid = int(np.count_nonzero(np.isnan(values)))
        if invalid == len(values):
            return cls(invalid=invalid, below=below, above=above)
        ends = float(np.fmin.reduce(values)), float(np.fmax.reduce(values))
        low, high = (int(np.argmax(values == end)) for end in ends)
        finite = values[np.isfinite(values)]
        some = finite[finite != 0]
        parts = Counts.of_signs(some, np.abs(some)) if len(some) else (_NONE, _NONE)
        return cls(
            invalid,
            (int(np.count_nonzero(values == -math.inf)), int(np.count_nonzero(values == math.inf))),
            len(finite) - len(some),
            *parts,
            total=_exact(finite),
            minimum=Peak(ends[0] + 0.0, start + low),  # -0 is 0
            maximum=Peak(ends[1] + 0.0, start + high),
            below=below,
            above=above,
        )

    def merged(self, other: Tally) -> Tally:
        """Return what is known of the numbers of both."""
        return Tally(
            self.invalid + other.invalid,
            (self.infinite[0] + other.infinite[0], self.infinite[1] + other.infinite[1]),
            self.zeros + other.zeros,
            self.negative.merged(other.negative),
            self.positive.merged(other.positive),
            self.total + other.total,
            other.minimum if self.minimum is None else self.minimum.better(other.minimum, -1),
            other.maximum if self.maximum is None else self.maximum.better(other.maximum, 1),
            _added(self.below, other.below),
            _added(self.above, other.above),
        )

    @property
    def count(self) -> int:
        """How many numbers there are, infinite ones too, NaN not."""
        return self.finite + sum(self.infinite)

    @property
    def finite(self) -> int:
        """How many finite numbers there are."""
        return self.zeros + int(np.sum(self.negative.counts)) + int(np.sum(self.positive.counts))

    @property
    def mean(self) -> float:
        """The mean: the sum of the chunks' sums, divided and rounded once. NaN where there is no number."""
        low, high = self.infinite
        if low or high:
            return math.nan if low and high else math.inf if high else -math.inf
        return self.total / (self.finite << _UNIT) if self.finite else math.nan

    def quantile(self, share: float) -> float:
        """Return the smallest number that at least a share of all are not above: an order statistic, not interpolated.

        Of the bin that it is in, the middle: relative error `ACCURACY`, 0.05 %. NaN where there is no number.
        """
        return self.quantiles([share])[0]

    def quantiles(self, shares: list[float]) -> list[float]:
        """Return several quantiles."""
        if self.minimum is None or self.maximum is None:
            return [math.nan for _ in shares]
        middles, counts = self._all_bins()
        reached, all_of_them = np.cumsum(counts), self.count
        # A share is meant as the decimal number that it prints as: 0.1 of 10 is the first, whatever 0.1 is in binary.
        ranks = [min(max(math.ceil(Fraction(repr(float(share))) * all_of_them), 1), all_of_them) for share in shares]
        low, high = self.minimum.value, self.maximum.value
        ends = {1: low, all_of_them: high}  # known exactly
        found = np.clip(middles[np.searchsorted(reached, ranks)], low, high)
        return [ends.get(rank, float(x)) for rank, x in zip(ranks, found, strict=True)]

    def histogram(self, bins: int = 20) -> Histogram:
        """Return how the finite numbers are distributed over bins of equal width between the extremes.

        Numbers are known to `ACCURACY`: those that cannot be told apart are spread evenly over where they may be.
        """
        middles, counts = self._all_bins()
        used = np.isfinite(middles) & (counts > 0)
        middles, counts = middles[used], counts[used]
        if not len(counts):
            return Histogram(np.zeros(0), np.zeros(0, dtype=np.int64))
        finite = [peak.value for peak in (self.minimum, self.maximum) if peak is not None and math.isfinite(peak.value)]
        low, high = min([*finite, middles[0]]), max([*finite, middles[-1]])
        if len(finite) == 2:
            low, high = finite
        edges = (
            np.unique(low + (high / bins - low / bins) * np.arange(bins + 1)) if low < high else np.array([low, high])
        )
        edges[-1] = high
        reached = np.rint(self._below(edges[1:-1], low, high)).astype(np.int64)
        return Histogram(edges, np.diff(reached, prepend=0, append=self.finite))

    def _below(self, values: Array, low: float, high: float) -> Array:
        """Return how many finite numbers, all between two, are below values (k,), spread as in `histogram`. (k,)."""
        negative = float(np.sum(self.negative.counts)) - self.negative.up_to(-values, (max(-high, 0.0), max(-low, 0.0)))
        return negative + self.zeros * (values > 0) + self.positive.up_to(values, (max(low, 0.0), max(high, 0.0)))

    def _all_bins(self) -> tuple[Array, Integers]:
        """Return all bins in order of their values: a number of each, and how many there are."""
        low, high = self.infinite
        values = (np.array([-math.inf]), -self.negative.middles[::-1], np.zeros(1), self.positive.middles)
        counts = (np.array([low]), self.negative.counts[::-1], np.array([self.zeros]), self.positive.counts)
        return np.concatenate([*values, np.array([math.inf])]), np.concatenate([*counts, np.array([high])])

    def state(self) -> State:
        """Return all of it as plain arrays by name."""
        size = (self.total.bit_length() + 8) // 8
        peaks = [peak or Peak(math.nan, -1) for peak in (self.minimum, self.maximum)]
        return {
            "numbers": np.array([self.invalid, *self.infinite, self.zeros, self.negative.first, self.positive.first]),
            "negative": self.negative.counts,
            "positive": self.positive.counts,
            "total": np.frombuffer(self.total.to_bytes(size, "little", signed=True), dtype=np.uint8),
            "values": np.array([peak.value for peak in peaks]),
            "rows": np.array([peak.row for peak in peaks]),
            "below": np.array(self.below, dtype=np.int64),
            "above": np.array(self.above, dtype=np.int64),
        }

    @classmethod
    def restored(cls, state: State) -> Tally:
        """Return the tally whose `state()` this is."""
        invalid, low, high, zeros, *firsts = map(int, state["numbers"])
        minimum, maximum = (
            Peak(float(value), int(row)) if row >= 0 else None
            for value, row in zip(state["values"], state["rows"], strict=True)
        )
        return cls(
            invalid,
            (low, high),
            zeros,
            Counts(firsts[0], state["negative"]),
            Counts(firsts[1], state["positive"]),
            int.from_bytes(state["total"].tobytes(), "little", signed=True),
            minimum,
            maximum,
            tuple(map(int, state["below"])),
            tuple(map(int, state["above"])),
        )


def _added(mine: tuple[int, ...], others: tuple[int, ...]) -> tuple[int, ...]:
    """Return counts added, an empty tuple being all zeros."""
    if not mine or not others:
        return mine or others
    return tuple(a + b for a, b in zip(mine, others, strict=True))


def _exact(values: Array) -> int:
    """Return the sum of a chunk's finite numbers, rounded as NumPy does, in units of 2^-1074."""
    with np.errstate(over="ignore"):
        total = float(np.sum(values))
    return _whole(total) if math.isfinite(total) else sum(map(_whole, map(float, values)))


def _whole(value: float) -> int:
    """Return a float in units of 2^-1074."""
    numerator, denominator = value.as_integer_ratio()
    whole: int = numerator * (2**_UNIT // denominator)
    return whole
