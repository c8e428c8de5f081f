"""Where the configurations of a sweep come from: random, low-discrepancy, a grid, a list; any part of them, any time.

A source gives its rows start .. stop - 1 without those before, and always the same, so that chunks of them can be
computed in any order by any process. Rows are the transpose of a C array (n, m): each coordinate is contiguous.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar, Protocol, Self

import numpy as np

from kinetostat.analysis.configuration import checked
from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.sweeping.radical_inverse import inverses
from kinetostat.conventions import Array
from kinetostat.errors import ConfigurationError, UsageError, quote, unknown_name

__all__ = [
    "BLOCK",
    "MOST_ROWS",
    "GridSource",
    "HaltonSource",
    "InBlocks",
    "ListSource",
    "RandomSource",
    "Source",
    "grid_source",
    "halton_source",
    "list_source",
    "random_source",
]

BLOCK = 2**16  # rows: 7 coordinates of them are 3.7 MB
MOST_ROWS = 10**12
_MOST_SEED = 2**64 - 1


class Source(Protocol):
    """Configurations of a chain by number. It is picklable, and light enough to be sent to another process."""

    @property
    def kind(self) -> str:
        """The way they are chosen: random, low-discrepancy, grid or list."""
        ...

    @property
    def label(self) -> str:
        """The same in a phrase, for reports."""
        ...

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the n coordinates."""
        ...

    @property
    def count(self) -> int:
        """How many rows there are."""
        ...

    @property
    def moved(self) -> tuple[str, ...]:
        """Names of the coordinates that it says; the others of a grid are held."""
        ...

    @property
    def bounds(self) -> Array:
        """Lower and upper ends of each coordinate, which no row is outside. (2, n)."""
        ...

    def part(self, start: int, stop: int) -> Source:
        """Return a source of the same rows that is light, and has rows start .. stop - 1 at least."""
        ...

    def rows(self, start: int, stop: int) -> Array:
        """Return rows start .. stop - 1, m of them: (m, n), the transpose of a C array."""
        ...


class InBlocks:
    """What is computed of a source, a block of 65,536 rows being a chunk: the counts that a work tells.

    Attributes:
        source: the configurations.
    """

    source: Source

    @property
    def rows(self) -> int:
        """How many configurations there are."""
        return self.source.count

    @property
    def chunks(self) -> int:
        """How many chunks there are."""
        return -(-self.rows // BLOCK)

    def size(self, chunk: int) -> int:
        """Return how many configurations a chunk has."""
        return min(BLOCK, self.rows - chunk * BLOCK)


@dataclass(frozen=True, repr=False)
class _Between:
    """Rows between ends, from numbers in [0, 1).

    Attributes:
        names: names of the coordinates.
        count: how many rows there are.
        bounds: lower and upper end of each coordinate. (2, n).
        seed: the same seed gives the same rows, whatever the count.
    """

    names: tuple[str, ...]
    count: int
    bounds: Array = field(compare=False)
    seed: int = 0

    @property
    def moved(self) -> tuple[str, ...]:
        """Names of the coordinates that it says: all."""
        return self.names

    def part(self, _start: int, _stop: int) -> Self:
        """Return itself, which is light."""
        return self

    def _stretched(self, unit: Array) -> Array:
        """Return rows from numbers in [0, 1], which are overwritten. (n, m) -> (m, n)."""
        lower, upper = self.bounds[0][:, None], self.bounds[1][:, None]
        unit *= upper - lower
        unit += lower
        np.minimum(unit, upper, out=unit)  # the last digit of lower + (upper - lower)
        rows: Array = unit.T
        return rows


@dataclass(frozen=True, repr=False)
class RandomSource(_Between):
    """Rows drawn uniformly and independently of each other.

    Each block of 65,536 rows has a stream of its own: the counter of Philox starts at the block's number in its third
    word, which no stream before reaches (J. Salmon, M. Moraes, R. Dror and D. Shaw, "Parallel random numbers: as easy
    as 1, 2, 3", 2011).
    """

    kind: ClassVar[str] = "random"

    @property
    def label(self) -> str:
        """The way they are chosen, in a phrase."""
        return f"random, uniform inside limits, seed {self.seed}"

    def rows(self, start: int, stop: int) -> Array:
        """Return rows start .. stop - 1: (m, n), the transpose of a C array."""
        n, first, last = len(self.names), start // BLOCK, -(-stop // BLOCK)
        if last - first == 1 and stop - start == BLOCK:
            return self._stretched(self._block(first))
        unit = np.empty((n, stop - start))
        for block in range(first, last):
            low, high = max(start, block * BLOCK), min(stop, (block + 1) * BLOCK)
            drawn = self._block(block)
            unit[:, low - start : high - start] = drawn[:, low - block * BLOCK : high - block * BLOCK]
        return self._stretched(unit)

    def _block(self, block: int) -> Array:
        """Return the numbers in [0, 1) of a whole block. (n, BLOCK)."""
        generator = np.random.Generator(np.random.Philox(key=self.seed, counter=[0, 0, block, 0]))
        drawn = np.empty((len(self.names), BLOCK))
        generator.random(out=drawn)
        return drawn


@dataclass(frozen=True, repr=False)
class HaltonSource(_Between):
    """Rows that fill the box evenly: a Halton sequence with randomly permuted digits.

    Coordinate j of row i has the digits of i in the j-th prime base, permuted by the seed and mirrored at the point (J.
    Halton, 1960; A. Owen, "A randomized Halton algorithm in R", 2017). Halton, because any row is known without those
    before, and any count of rows is as good as another: Sobol's points are balanced in powers of two only, and SciPy
    gets to row i of either by making all before (a row of its Halton sequence takes 50 ns a coordinate besides). Beyond
    about ten coordinates, where bases are large, it is not much better than random.
    """

    kind: ClassVar[str] = "low-discrepancy"

    @property
    def label(self) -> str:
        """The way they are chosen, in a phrase."""
        return f"low-discrepancy (scrambled Halton), inside limits, seed {self.seed}"

    def rows(self, start: int, stop: int) -> Array:
        """Return rows start .. stop - 1: (m, n), the transpose of a C array."""
        scrambled = inverses(len(self.names), self.seed)
        unit = np.empty((len(self.names), stop - start))
        for inverse, row in zip(scrambled, unit, strict=True):
            inverse.fill(row, start)
        return self._stretched(unit)


@dataclass(frozen=True, repr=False)
class GridSource:
    """All combinations of evenly spaced values; the last coordinate that has several changes fastest.

    Attributes:
        names: names of the coordinates.
        bounds: first and last value of each coordinate. (2, n).
        sizes: how many values each has.
        moved: names of the coordinates that the grid names; the others are held.
    """

    names: tuple[str, ...]
    bounds: Array = field(compare=False)
    sizes: tuple[int, ...]
    moved: tuple[str, ...]
    kind: ClassVar[str] = "grid"

    @property
    def count(self) -> int:
        """How many combinations there are."""
        return math.prod(self.sizes)

    @property
    def label(self) -> str:
        """The way they are chosen, in a phrase."""
        several = [f"{size} of {name}" for name, size in zip(self.names, self.sizes, strict=True) if size > 1]
        return f"grid: {' x '.join(several) or 'one configuration'}"

    @property
    def axes(self) -> dict[str, Array]:
        """The values of each coordinate that the grid names; the last one changes fastest. (size,)."""
        return {name: self.values(j) for j, name in enumerate(self.names) if name in self.moved}

    def part(self, _start: int, _stop: int) -> GridSource:
        """Return itself, which is light."""
        return self

    def values(self, j: int) -> Array:
        """Return the values of coordinate j. (size,)."""
        values: Array = np.linspace(self.bounds[0, j], self.bounds[1, j], self.sizes[j])
        return values

    def rows(self, start: int, stop: int) -> Array:
        """Return rows start .. stop - 1: (m, n), the transpose of a C array."""
        found, numbers = np.empty((len(self.names), stop - start)), np.arange(start, stop)
        for j in reversed(range(len(self.names))):
            if self.sizes[j] == 1:
                found[j] = self.bounds[0, j]
            else:
                numbers, place = np.divmod(numbers, self.sizes[j])
                found[j] = self.values(j)[place]
        return found.T


@dataclass(frozen=True, repr=False)
class ListSource:
    """Given rows, such as those of a trajectory.

    Attributes:
        names: names of the coordinates.
        values: a row for each coordinate: of all rows, or of those from `first` on that this part has. (n, m).
        count: how many rows there are.
        first: which row is the first in `values`.
    """

    names: tuple[str, ...]
    values: Array = field(compare=False)
    count: int
    first: int = 0
    kind: ClassVar[str] = "list"

    @property
    def moved(self) -> tuple[str, ...]:
        """Names of the coordinates that it says: all."""
        return self.names

    def part(self, start: int, stop: int) -> ListSource:
        """Return a source of the same rows that has rows start .. stop - 1 alone."""
        return replace(self, values=self.rows(start, stop).T, first=start)

    @property
    def bounds(self) -> Array:
        """Smallest and largest value of each coordinate. (2, n)."""
        return np.stack([np.min(self.values, axis=1), np.max(self.values, axis=1)])

    @property
    def label(self) -> str:
        """The way they are chosen, in a phrase."""
        return "the configurations given"

    def rows(self, start: int, stop: int) -> Array:
        """Return rows start .. stop - 1: (m, n), the transpose of a C array."""
        found: Array = np.ascontiguousarray(self.values[:, start - self.first : stop - self.first]).T
        return found


def random_source(coordinates: Coordinates, count: int, seed: int = 0) -> RandomSource:
    """Return `count` configurations drawn uniformly inside limits (`Coordinates.limits`).

    Raises:
        UsageError: a count or a seed that cannot be.
    """
    return RandomSource(coordinates.names, _count(count), np.stack(coordinates.limits), _seed(seed))


def halton_source(coordinates: Coordinates, count: int, seed: int = 0) -> HaltonSource:
    """Return `count` configurations that fill the limits (`Coordinates.limits`) evenly.

    Raises:
        UsageError: a count or a seed that cannot be.
    """
    return HaltonSource(coordinates.names, _count(count), np.stack(coordinates.limits), _seed(seed))


def grid_source(
    coordinates: Coordinates, rest: Array, grid: str | Mapping[str, Sequence[float]], *, degrees: bool = False
) -> GridSource:
    """Return the configurations of a grid.

    Args:
        coordinates: the chain.
        rest: where coordinates that are not named stay, (nq,).
        grid: `j=lo:hi:n,k=...`, or {name: (lo, hi, n)}: n values from lo to hi; one value is lo.
        degrees: ends of angles are in degrees.

    Raises:
        UnknownNameError: no such coordinate in the chain.
        UsageError: it is not of that form, or has more than 1e12 combinations.
    """
    axes = _parsed(grid) if isinstance(grid, str) else {name: _axis(name, tuple(axis)) for name, axis in grid.items()}
    if not axes:
        raise UsageError("a grid names one joint at least", remedy="for instance joint1=-1:1:11")
    held = rest[list(coordinates.indices)]
    bounds, sizes = np.stack([held, held]), [1] * len(held)
    for name, (low, high, size) in axes.items():
        j = _place(coordinates, name)
        factor = math.pi / 180 if degrees and coordinates.turning[j] else 1.0
        bounds[:, j], sizes[j] = (low * factor, high * factor), size
    if math.prod(sizes) > MOST_ROWS:
        raise UsageError(
            f"the grid has {math.prod(sizes):.3g} configurations, more than {MOST_ROWS:.0e}",
            remedy="fewer values, or --samples",
        )
    checked(coordinates.model.robot, coordinates.configuration(bounds, rest))
    moved = tuple(name for name in coordinates.names if name in axes)
    return GridSource(coordinates.names, bounds, tuple(sizes), moved)


def list_source(coordinates: Coordinates, q: Array) -> ListSource:
    """Return given configurations: (m, nq) of the whole robot, or (m, n) of the chain's coordinates.

    Raises:
        ConfigurationError: another shape, or a number that is not finite or too large.
        UsageError: there is none.
    """
    q, robot, n = np.asarray(q, dtype=np.float64), coordinates.model.robot, len(coordinates.names)
    if q.ndim != 2 or q.shape[1] not in (robot.nq, n):
        raise ConfigurationError(f"configurations have the shape (m, {robot.nq}) here, not {q.shape}")
    if not len(q):
        raise UsageError("there is no configuration in the list")
    if q.shape[1] == robot.nq:
        q = checked(robot, q)[:, list(coordinates.indices)]
    else:
        checked(robot, coordinates.configuration(q, np.ones(robot.nq)))  # a one is a position of any other joint
    return ListSource(coordinates.names, np.ascontiguousarray(q.T), len(q))


def _count(count: int) -> int:
    if not 1 <= count <= MOST_ROWS:
        raise UsageError(f"a sweep has between 1 and {MOST_ROWS:.0e} configurations, not {count}")
    return int(count)


def _seed(seed: int) -> int:
    if not 0 <= seed <= _MOST_SEED:
        raise UsageError(f"a seed is a whole number from 0 to {_MOST_SEED}, not {seed}")
    return int(seed)


def _place(coordinates: Coordinates, name: str) -> int:
    """Return which coordinate of the chain a name is."""
    if name in coordinates.names:
        return coordinates.names.index(name)
    robot = coordinates.model.robot
    if name in robot.joint_by_name:
        joint = robot.independent_joint(name)
        several = [one for one, owner in zip(coordinates.names, coordinates.joints, strict=True) if owner is joint]
        if several:
            raise UsageError(
                f"joint {quote(name)} has several coordinates", remedy=f"name one: {', '.join(map(quote, several))}"
            )
        raise UsageError(
            f"joint {quote(name)} does not move the frame",
            remedy=f"those that do: {', '.join(map(quote, coordinates.names[:8]))}",
        )
    raise unknown_name("joint", name, coordinates.names)


def _parsed(text: str) -> dict[str, tuple[float, float, int]]:
    """Return the axes that a text writes."""
    axes: dict[str, tuple[float, float, int]] = {}
    for part in filter(None, (part.strip() for part in text.replace("\n", ",").split(","))):
        name, _, numbers = part.rpartition("=")
        if not name.strip():
            raise UsageError(f"{quote(part)} is no axis of a grid", remedy="write joint=lowest:highest:count")
        if name.strip() in axes:
            raise UsageError(f"joint {quote(name.strip())} is in the grid twice")
        axes[name.strip()] = _axis(name.strip(), tuple(numbers.split(":")))
    return axes


def _axis(name: str, words: tuple[str | float, ...]) -> tuple[float, float, int]:
    """Return an axis as numbers: lowest, highest, count."""
    try:
        low, high, size = float(words[0]), float(words[1]), float(words[2])
    except (IndexError, TypeError, ValueError):
        low = high = size = math.nan
    if size > MOST_ROWS:
        raise UsageError(
            f"{size:g} positions of joint {quote(name)} are too many", remedy=f"at most {MOST_ROWS:g} in all"
        )
    if len(words) != 3 or not (math.isfinite(low) and math.isfinite(high) and size >= 1 and size % 1 == 0):
        shown = ":".join(map(str, words))
        raise UsageError(
            f"{quote(f'{name}={shown}')} is no axis of a grid",
            remedy="write joint=lowest:highest:count, count a whole number from 1 on",
        )
    return low, high, int(size)
