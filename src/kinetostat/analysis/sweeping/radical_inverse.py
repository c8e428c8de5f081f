"""Radical inverses: whole numbers whose digits are permuted and mirrored at the point; any range of them at once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinetostat.conventions import Array

__all__ = ["RadicalInverse", "inverses"]

_TABLE = 4096  # entries of a table of the last digits, at most
_BITS = 54


@dataclass(frozen=True)
class RadicalInverse:
    """The digits of whole numbers mirrored at the point: sum of permutation_d(digit_d) / base^(d+1).

    Attributes:
        base: a prime.
        low: the part of the last digits of a number, for each remainder. (base^k,).
        permutations: of all digits. (digits, base).
    """

    base: int
    low: Array
    permutations: Array

    @classmethod
    def scrambled(cls, base: int, generator: np.random.Generator) -> RadicalInverse:
        """Return the one with random permutations."""
        digits = math.ceil(_BITS / math.log2(base))
        permutations = np.array([generator.permutation(base) for _ in range(digits)])
        size = base ** max(1, int(math.log(_TABLE, base)))
        return cls(base, _mirrored(np.arange(size), base, permutations, 0, size), permutations)

    def fill(self, out: Array, start: int) -> None:
        """Write the numbers of start, start + 1, ... into `out`, (m,)."""
        size, stop = len(self.low), start + len(out)
        used = round(math.log(size, self.base))
        heads = np.arange(start // size, -(-stop // size))
        high = _mirrored(heads, self.base, self.permutations, used, None)
        low, high = np.broadcast_arrays(self.low[None, :], high[:, None])
        at = start % size
        if len(heads) > 2:  # whole tables go straight to their place
            first, whole = size - at, len(heads) - 2
            np.add(low[0, at:], high[0, at:], out=out[:first])
            middle = out[first : first + whole * size].reshape(whole, size)
            np.add(low[1:-1], high[1:-1], out=middle)
            rest = len(out) - first - whole * size
            np.add(low[-1, :rest], high[-1, :rest], out=out[first + whole * size :])
        else:
            out[:] = (low + high).reshape(-1)[at : at + len(out)]


def _mirrored(numbers: NDArray[np.int64], base: int, permutations: Array, first: int, limit: int | None) -> Array:
    """Return the parts that the digits of numbers, from place `first` on, have in a radical inverse."""
    found = np.zeros(len(numbers))
    digits = len(permutations) if limit is None else round(math.log(limit, base))
    for place in range(first, digits):
        numbers, digit = np.divmod(numbers, base)
        found += permutations[place][digit] / float(base) ** (place + 1)
    return found


@lru_cache(maxsize=8)
def inverses(count: int, seed: int) -> tuple[RadicalInverse, ...]:
    """Return the radical inverses of the first prime bases, each with permutations of its own stream."""
    streams = [np.random.Generator(np.random.Philox(key=seed, counter=[0, 0, 0, j + 1])) for j in range(count)]
    return tuple(RadicalInverse.scrambled(p, g) for p, g in zip(_primes(count), streams, strict=True))


def _primes(count: int) -> list[int]:
    primes: list[int] = []
    candidate = 2
    while len(primes) < count:
        if all(candidate % p for p in primes if p * p <= candidate):
            primes.append(candidate)
        candidate += 1
    return primes
