"""What can be run in chunks: work says what a chunk gives; partial results add up to the same bits in any order."""

from __future__ import annotations

from typing import Any, Protocol, Self, TypeVar, runtime_checkable

from numpy.typing import NDArray

__all__ = ["Divisible", "Partial", "State", "Work"]

State = dict[str, NDArray[Any]]


class Partial(Protocol):
    """What is known of some chunks of a work. It is never changed, only merged into another."""

    def merged(self, other: Self) -> Self:
        """Return what is known of the chunks of both, which have none in common.

        Associative and commutative to the bit: who computes which chunk, and who is ready first, changes nothing.
        """
        ...

    def state(self) -> State:
        """Return all of it as plain arrays by name, without object arrays, as a checkpoint keeps it."""
        ...


P = TypeVar("P", bound=Partial)
P_co = TypeVar("P_co", bound=Partial, covariant=True)


class Work(Protocol[P_co]):
    """A question in chunks 0 .. chunks - 1, each of which can be computed alone, by any process. It is picklable."""

    @property
    def chunks(self) -> int:
        """How many chunks there are."""
        ...

    @property
    def rows(self) -> int:
        """How many configurations there are in all chunks."""
        ...

    @property
    def digest(self) -> str:
        """What identifies the question with all that its numbers depend on, its chunks' limits too."""
        ...

    def size(self, chunk: int) -> int:
        """Return how many configurations a chunk has."""
        ...

    def compute(self, chunk: int) -> P_co:
        """Return what a chunk gives. It depends on the chunk alone; threads may call it at the same time."""
        ...

    def empty(self) -> P_co:
        """Return what is known of no chunk: merged with another, it gives the other."""
        ...

    def restore(self, state: State) -> P_co:
        """Return the partial result whose `state()` this is, to the bit."""
        ...


@runtime_checkable
class Divisible(Protocol):
    """A work that may be heavy: to another process it goes without what its chunks need, which goes with each task."""

    def part(self, chunks: tuple[int, ...]) -> Any:
        """Return what some chunks need; of no chunk, what is light."""
        ...

    def with_part(self, part: Any) -> Self:
        """Return the work with such a part instead of the whole: it computes those chunks alone."""
        ...
