"""A small work for tests of runs: sums that wrap, and how often each chunk counted; chunks may kill or fail."""

from __future__ import annotations

import os
import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Count:
    """How often each chunk counted, and a sum over configurations, modulo 2^64."""

    times: np.ndarray
    total: np.ndarray

    def merged(self, other: Count) -> Count:
        return Count(self.times + other.times, self.total + other.total)

    def state(self) -> dict[str, np.ndarray]:
        return {"times": self.times, "total": self.total}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Count) and all(np.array_equal(a, other.state()[k]) for k, a in self.state().items())

    __hash__ = None


@dataclass(frozen=True)
class Toy:
    """Chunks 0 .. chunks - 1 of ten configurations each, the last one of three.

    Attributes:
        chunks: how many.
        pause: seconds that each takes.
        accident: file that the worker makes that kills itself by SIGKILL, where it is not there yet,
        at: at this chunk.
        deadly: the chunk that kills its worker each time.
        wrong: the chunk that cannot be computed.
        interrupt: the chunk in which Ctrl-C comes.
        ballast: what makes it heavy.
    """

    chunks: int = 50
    pause: float = 0.0
    accident: Path | None = None
    at: int = 20
    deadly: int = -1
    wrong: int = -1
    interrupt: int = -1
    ballast: bytes = b""
    digest: str = "toy"

    @property
    def rows(self) -> int:
        return sum(self.size(chunk) for chunk in range(self.chunks))

    def size(self, chunk: int) -> int:
        return 3 if chunk == self.chunks - 1 else 10

    def compute(self, chunk: int) -> Count:
        if chunk == self.wrong:
            raise ZeroDivisionError("a wrong chunk")
        if chunk == self.interrupt:
            signal.raise_signal(signal.SIGINT)
        if chunk == self.deadly:
            os.kill(os.getpid(), signal.SIGKILL)
        if chunk == self.at and self.accident is not None and not self.accident.exists():
            self.accident.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        time.sleep(self.pause)
        times = np.zeros(self.chunks, dtype=np.int64)
        times[chunk] = 1
        draws = np.random.Generator(np.random.Philox(key=chunk)).integers(0, 2**64, self.size(chunk), dtype=np.uint64)
        return Count(times, draws.sum(keepdims=True))

    def empty(self) -> Count:
        return Count(np.zeros(self.chunks, dtype=np.int64), np.zeros(1, dtype=np.uint64))

    def restore(self, state: dict[str, np.ndarray]) -> Count:
        return Count(state["times"], state["total"])

    def expected(self) -> Count:
        """What all chunks give, added up without anything of the library."""
        found = [self.compute(chunk) for chunk in range(self.chunks)]
        return Count(np.ones(self.chunks, dtype=np.int64), sum(one.total for one in found))


def main() -> None:
    """Run slowly with a checkpoint after each chunk; print how many chunks are done, and the sum."""
    from kinetostat.analysis.sweeping import running

    running._KEPT_EVERY, running._WRITING_SHARE = 0.0, 1e9
    folder, workers, limit = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    if limit:
        import resource

        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))  # what is longer cannot be written
    toy = Toy(chunks=300, pause=0.005)
    print("ready", flush=True)
    outcome = running.run(toy, workers=workers, checkpoint=folder)
    print(int(outcome.complete), len(outcome.done), int(outcome.partial.total[0]), max(outcome.partial.times))
    print(*outcome.warnings, flush=True)


if __name__ == "__main__":
    main()
