"""Running a work: its chunks are computed anywhere, added up as they come, kept in a checkpoint, and may end early."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Generic

from kinetostat.analysis.sweeping.checkpoint import Checkpoint, open_checkpoint
from kinetostat.analysis.sweeping.chunks import Chunks
from kinetostat.analysis.sweeping.interrupting import Stop, stop_on_interrupt
from kinetostat.analysis.sweeping.pace import Pace
from kinetostat.analysis.sweeping.work import P, Work
from kinetostat.analysis.sweeping.workers import Workers
from kinetostat.errors import UsageError, quote

__all__ = ["Outcome", "run"]

_KEPT_EVERY = 5.0  # s between two checkpoints,
_WRITING_SHARE = 0.05  # and at most this share of the time goes into them
_TOLD_EVERY = 0.1  # s


@dataclass(frozen=True, repr=False)
class Outcome(Generic[P]):
    """What a run has found.

    Attributes:
        partial: what the chunks that are done gave, added up.
        done: those chunks.
        complete: they are all.
        rows: configurations in them.
        continued: those among them that an earlier run had done, of which there was a checkpoint.
        seconds: how long this run took.
        rate: configurations a second in this run.
        warnings: what is to be said of it.
    """

    partial: P
    done: Chunks
    complete: bool
    rows: int
    continued: int
    seconds: float
    rate: float
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<Outcome: {self.rows} configurations, {'complete' if self.complete else 'partial'}>"


def run(
    work: Work[P],
    *,
    workers: int = 1,
    executor: Executor | None = None,
    checkpoint: Path | str | None = None,
    progress: Callable[[str, float], None] | None = None,
    sink: Callable[[int, P], None] | None = None,
) -> Outcome[P]:
    """Compute all chunks of a work and add up what they give: the same bits whoever computes them, in any order.

    A worker that is lost does no harm: its chunks are sent again. The first Ctrl-C ends the run early, and the outcome
    says that it is not complete; a second one interrupts.

    Args:
        work: what to compute.
        workers: how many threads compute; 1 is this thread. With an executor that does not say how many workers it has:
            how many are to be kept busy.
        executor: who computes instead of threads: any `concurrent.futures.Executor` (processes, a Dask client's). The
            work travels to it pickled.
        checkpoint: a folder that keeps what is done, every few seconds and at the end, and from which a run of the same
            question goes on.
        progress: told what is being done, and which share of it is.
        sink: given each chunk and what it gave, in the order of chunks, for what is too large to be added up.

    Raises:
        UsageError: no worker; a checkpoint of another question, damaged, in use, without a name, or along with a sink;
            a chunk that was lost with its worker again and again; a Dask scheduler that is gone.
        Exception: what a chunk raises; the checkpoint has what was done until then.
    """
    if workers < 1:
        raise UsageError(f"at least one worker, not {workers}")
    if checkpoint is not None and sink is not None:
        raise UsageError(
            "a checkpoint keeps what is added up, not rows", remedy="ask for the summary, or do without a checkpoint"
        )
    if checkpoint == "":
        raise UsageError("the checkpoint's folder has no name", remedy="for this folder give .")
    if checkpoint is None:
        return _Run(work, None, progress, sink).outcome(workers, executor)
    with open_checkpoint(Path(checkpoint)) as folder:
        return _Run(work, folder, progress, sink).outcome(workers, executor)


@dataclass(frozen=True)
class _Sum(Generic[P]):
    """What is done, in one value: it is replaced in one step, or not, whatever interrupts."""

    partial: P
    done: Chunks
    rows: int


class _Run(Generic[P]):
    def __init__(
        self,
        work: Work[P],
        folder: Checkpoint | None,
        progress: Callable[[str, float], None] | None,
        sink: Callable[[int, P], None] | None,
    ) -> None:
        self.work, self.folder, self.progress, self.sink = work, folder, progress, sink
        self.began = self.told = self.kept = time.monotonic()
        self.wait = _KEPT_EVERY
        self.failure: str | None = None
        self.warnings = list[str]()
        self.sum = self.saved = self._start()
        self.pace = Pace(work.rows, self.sum.rows, self.began)

    def _start(self) -> _Sum[P]:
        found = self.folder.read(self.work) if self.folder is not None else None
        if found is None:
            return _Sum(self.work.empty(), Chunks(), 0)
        partial, done = found
        return _Sum(partial, done, sum(self.work.size(chunk) for chunk in done))

    def outcome(self, workers: int, executor: Executor | None) -> Outcome[P]:
        before, stop = self.sum.rows, Stop()
        if len(self.sum.done) < self.work.chunks:
            crew = Workers(self.work, workers=workers, executor=executor, tell=self._tell_of)
            with stop_on_interrupt(stop, crew.wake), self._kept_at_the_end():
                self._add_up(crew, stop)
            self.warnings += crew.warnings
        seconds = time.monotonic() - self.began
        return Outcome(
            partial=self.sum.partial,
            done=self.sum.done,
            complete=len(self.sum.done) == self.work.chunks,
            rows=self.sum.rows,
            continued=before,
            seconds=seconds,
            rate=self.pace.rate(self.sum.rows, self.began + seconds),
            warnings=(*self.warnings, *self._unkept()),
        )

    def _add_up(self, crew: Workers[P], stop: Stop) -> None:
        self._tell()
        try:
            with closing(crew.results(self.sum.done, stop, ordered=self.sink is not None)) as results:
                for chunks, found in results:
                    if self.sink is not None:
                        self.sink(chunks[0], found)  # alone, since all are in order
                    self._add(chunks, found)
                    now = time.monotonic()
                    if now - self.told >= _TOLD_EVERY:
                        self._tell()
                    if now - self.kept >= self.wait:
                        self._keep()
        except KeyboardInterrupt:  # where Ctrl-C is answered otherwise than by Python
            if stop.wanted:
                raise  # the second one
        self._tell()

    def _add(self, chunks: tuple[int, ...], found: P) -> None:
        was, rows = self.sum, sum(self.work.size(chunk) for chunk in chunks)
        self.sum = _Sum(was.partial.merged(found), was.done.and_also(*chunks), was.rows + rows)

    def _tell(self) -> None:
        if self.progress is not None:
            self.told = time.monotonic()
            self.progress(self.pace.words(self.sum.rows, self.told), self.sum.rows / max(self.work.rows, 1))

    def _tell_of(self, waiting: str) -> None:
        if self.progress is not None:
            self.progress(waiting, self.sum.rows / max(self.work.rows, 1))

    @contextmanager
    def _kept_at_the_end(self) -> Iterator[None]:
        """Write the checkpoint when the block ends, however it does."""
        try:
            yield
        finally:
            self._keep()

    def _keep(self) -> None:
        """Write the checkpoint; where that fails the run goes on, and says so once."""
        so_far = self.sum
        if self.folder is None or so_far is self.saved:
            return
        began = time.monotonic()
        try:
            self.folder.write(self.work, so_far.partial.state(), so_far.done)
            self.saved = so_far
        except OSError as error:
            self.failure = self.failure or error.strerror or str(error)
        self.kept = time.monotonic()
        self.wait = max(_KEPT_EVERY, (self.kept - began) / _WRITING_SHARE)

    def _unkept(self) -> list[str]:
        """Return what is to be said of checkpoints that could not be written."""
        if self.folder is None or self.failure is None:
            return []
        place = f"the checkpoint in {quote(str(self.folder.folder))}"
        if self.saved is self.sum:
            return [f"{place} could not be written for a while: {self.failure}"]
        return [f"{place} has {self.saved.rows} of these {self.sum.rows} configurations: {self.failure}"]
