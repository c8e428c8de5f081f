"""Chunks computed by threads or by any executor: a few in flight, lost ones sent again.

In flight are never more tasks than keep all workers busy, so memory does not grow with the number of chunks. A task is
a chunk; where it has to travel to a worker, it is as many chunks as take a quarter of a second, added up there. What
makes a work heavy, such as a list of configurations, travels with the tasks that need it, each its own part.
"""

from __future__ import annotations

import hashlib
import math
import pickle
import sys
import time
from collections import deque
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import lru_cache, partial
from itertools import islice
from queue import Empty, SimpleQueue
from types import ModuleType
from typing import Any, Generic

from kinetostat.analysis.sweeping.chunks import Chunks
from kinetostat.analysis.sweeping.interrupting import Stop
from kinetostat.analysis.sweeping.work import Divisible, P, Work
from kinetostat.errors import UsageError

__all__ = ["Workers"]

_LOOK = 2.0  # s without news, after which is looked whether a cluster is still there
_AHEAD = 3  # tasks in flight for each worker: the next ones are there when it is ready
_UNKNOWN_WIDTH = 16  # workers of an executor that does not say how many it has
_LOSSES = 3  # times that a task may be lost with its worker and is sent again
_TASK_SECONDS, _TASK_CHUNKS = 0.25, 64  # of a task that travels, about and at most
_HEAVY = 10_000_000  # bytes: of a question, worth a word that each task brings them along; of a part, enough for a task

_ENDED = ("closing", "closed")  # of a Dask client

Task = tuple[int, ...]  # chunks
_Found = tuple[P, float]  # what they gave together, and the seconds that they took


class Workers(Generic[P]):
    """Those who compute the chunks of a work: this thread, threads, or an executor that is given."""

    def __init__(
        self,
        work: Work[P],
        *,
        workers: int = 1,
        executor: Executor | None = None,
        tell: Callable[[str], None] = lambda _: None,
    ) -> None:
        """Take a work and who computes it.

        Args:
            work: what to compute.
            workers: how many threads, where no executor is given; 1 is this thread.
            executor: who computes instead; it is not shut down.
            tell: told what is waited for, where nothing can be done.
        """
        self.work, self._tell = work, tell
        self.warnings = list[str]()
        self._own = executor is None
        self._width = workers if executor is None else max(workers, _width(executor))
        self._executor = executor if executor is not None else _threads(workers)
        self._travels = not isinstance(self._executor, (_Here, ThreadPoolExecutor))
        self._most = self._most_chunks() if self._travels else 1
        self._compute = self._way_to(work)
        self._seconds = math.inf  # that a chunk takes
        self._ready: SimpleQueue[Future[_Found[P]] | None] = SimpleQueue()
        self._flying = dict[Future[_Found[P]], Task]()
        self._losses = dict[Task, int]()

    def wake(self) -> None:
        """Have `results` look whether it is to stop; a signal handler may call it."""
        self._ready.put(None)

    def results(self, done: Chunks, stop: Stop, *, ordered: bool = False) -> Generator[tuple[Task, P]]:
        """Yield chunks, and what they gave together, as they come, or one after the other in their order.

        At the stop what has not begun is cancelled; what this process is at is finished and yielded.

        Args:
            done: chunks that are done already.
            stop: asks for the end.
            ordered: whether to yield each chunk alone, in order.

        Raises:
            UsageError: a task was lost with its worker too often; the Dask scheduler is gone.
            Exception: what a chunk raises.
        """
        todo, left = done.missing(self.work.chunks), self.work.chunks - len(done)
        line = _Line[P](ordered=ordered)
        try:
            while True:
                while left and not stop.wanted and len(line) < self._ahead:
                    task = tuple(islice(todo, 1 if ordered else self._chunks_of_a_task(left)))
                    left -= len(task)
                    line.append(task)
                    self._send(task)
                if not self._flying or (stop.wanted and not self._finishing()):
                    return
                future = self._next()
                if future is None or future not in self._flying:
                    continue  # woken; or cancelled
                task = self._flying.pop(future)
                if (found := self._outcome(future, task, stop)) is not None:
                    yield from line.served(task, found)
        finally:
            self._end()

    def _next(self) -> Future[_Found[P]] | None:
        """Wait for a task that is ready, or to be woken, and see meanwhile that a cluster is there.

        Raises:
            UsageError: the Dask scheduler is gone.
        """
        while (client := _client(self._executor)) is not None:
            try:
                return self._ready.get(timeout=_LOOK)
            except Empty:
                if client.status in _ENDED:
                    raise _gone() from None
                if _is_empty(client):
                    self._tell("no workers: waiting")
                    said = "the Dask cluster had no workers for a while"
                    self.warnings += [] if said in self.warnings else [said]
        return self._ready.get()

    def _cancel(self, future: Future[_Found[P]]) -> bool:
        """Cancel a task that has not begun; of a client that has ended, nothing can be."""
        client = _client(self._executor)
        return (client is None or client.status not in _ENDED) and future.cancel()

    @property
    def _ahead(self) -> int:
        return 1 if isinstance(self._executor, _Here) else _AHEAD * self._width

    def _chunks_of_a_task(self, left: int) -> int:
        if not self._travels:
            return 1
        # Fewer towards the end, so that all workers end at about the same time.
        most = min(self._most, left // self._ahead)
        return max(1, min(most, int(_TASK_SECONDS / max(self._seconds, 1e-9))))

    def _send(self, task: Task) -> None:
        try:
            future = self._submitted(task)
        except BrokenExecutor:
            self._fall_back()
            future = self._submitted(task)
        except Exception as error:
            if not _is_gone(error):
                raise
            raise _gone() from error
        self._flying[future] = task
        future.add_done_callback(self._ready.put)

    def _submitted(self, task: Task) -> Future[_Found[P]]:
        # Of executors that know equal tasks by their arguments (Dask), the number of losses makes a new one.
        part = self.work.part(task) if self._travels and isinstance(self.work, Divisible) else None
        return self._executor.submit(self._compute, task, part, self._losses.get(task, 0))

    def _outcome(self, future: Future[_Found[P]], task: Task, stop: Stop) -> P | None:
        """Return what a task gave; None where it is lost, and sent again unless all ends."""
        error = CancelledError() if future.cancelled() else future.exception()
        if error is None:
            found, seconds = future.result()
            self._seconds = seconds / len(task)
            return found
        if isinstance(error, KeyboardInterrupt):  # Ctrl-C in a terminal reaches worker processes too
            stop.wanted = True
        elif not _is_loss(error):
            raise error
        elif not stop.wanted:
            self._lost(task, error)
            self._send(task)
        return None

    def _lost(self, task: Task, error: BaseException) -> None:
        if isinstance(error, BrokenExecutor):
            self._fall_back()
            return
        self._losses[task] = losses = self._losses.get(task, 0) + 1
        if losses > _LOSSES:
            which = f"chunk {task[0]}" if len(task) == 1 else f"chunks {task[0]} to {task[-1]}"
            rows = sum(self.work.size(chunk) for chunk in task)
            raise UsageError(
                f"{which} of {self.work.chunks} ({rows} configurations) went down with the worker "
                f"{losses} times: {type(error).__name__}",
                remedy="see the workers' logs; often their memory is too small for as many as run on a machine",
            ) from error

    def _fall_back(self) -> None:
        """Compute the rest by threads of this process: an executor that broke cannot be used again."""
        if self._own:
            return  # others that were in flight in the same executor
        self.warnings.append(
            f"a worker process died, and its executor with it: from then on, {self._width} threads of this process "
            "computed what was left"
        )
        self._own, self._executor, self._travels = True, _threads(self._width), False
        self._compute = self._way_to(self.work)

    def _finishing(self) -> bool:
        """Cancel what has not begun; return whether something is left that is waited for."""
        for future in list(self._flying):
            if self._cancel(future) or not self._own:
                self._flying.pop(future)
        return bool(self._flying)

    def _end(self) -> None:
        """Leave nothing in flight."""
        for future in self._flying:
            self._cancel(future)
        self._flying.clear()
        if self._own:
            self._executor.shutdown(wait=True, cancel_futures=True)

    def _most_chunks(self) -> int:
        """Return how many chunks a task has that travels, at most: fewer where what they need is heavy."""
        if not isinstance(self.work, Divisible):
            return _TASK_CHUNKS
        size = len(pickle.dumps(self.work.part((0,)), protocol=pickle.HIGHEST_PROTOCOL))
        return max(1, min(_TASK_CHUNKS, _HEAVY // size))

    def _way_to(self, work: Work[P]) -> Callable[[Task, Any, int], _Found[P]]:
        if not self._travels:
            return partial(_compute_here, work)
        light = work.with_part(work.part(())) if isinstance(work, Divisible) else work
        content = pickle.dumps(light, protocol=pickle.HIGHEST_PROTOCOL)
        if len(content) > _HEAVY:
            self.warnings.append(
                f"the question is of {len(content) / 1e6:.0f} MB, which every task brings to its worker: threads of "
                "this process may be faster"
            )
        return partial(_compute_there, _Packed(hashlib.sha256(content).hexdigest(), content))


@dataclass
class _Line(Generic[P]):
    """Tasks that are on their way, and what waits for others before it."""

    ordered: bool
    _tasks: deque[Task] = field(default_factory=deque)
    _waiting: dict[Task, P] = field(default_factory=dict)
    _flying: int = 0

    def __len__(self) -> int:
        return len(self._tasks) if self.ordered else self._flying

    def append(self, task: Task) -> None:
        self._flying += 1
        if self.ordered:
            self._tasks.append(task)

    def served(self, task: Task, found: P) -> Iterator[tuple[Task, P]]:
        """Yield what may go now that a task is done."""
        self._flying -= 1
        if not self.ordered:
            yield task, found
            return
        self._waiting[task] = found
        while self._tasks and self._tasks[0] in self._waiting:
            first = self._tasks.popleft()
            yield first, self._waiting.pop(first)


class _Here(Executor):
    """Computes in the thread that asks."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:  # it is raised again where it is looked at
            future.set_exception(error)
        return future


@dataclass(frozen=True)
class _Packed:
    """A work on its way to another process, known by the digest of its bytes."""

    digest: str
    content: bytes = field(compare=False, repr=False)


@lru_cache(maxsize=4)
def _unpacked(packed: _Packed) -> Work[Any]:
    # Once in a worker, not once a chunk.
    work: Work[Any] = pickle.loads(packed.content)  # noqa: S301  our own bytes
    return work


def _compute_there(packed: _Packed, task: Task, part: Any, losses: int) -> _Found[Any]:
    work = _unpacked(packed)
    return _compute_here(work.with_part(part) if isinstance(work, Divisible) else work, task, None, losses)


def _compute_here(work: Work[P], task: Task, _part: None, _losses: int) -> _Found[P]:
    """Return what the chunks of a task give together, and the seconds that they took."""
    began = time.perf_counter()
    found = work.compute(task[0])
    for chunk in task[1:]:
        found = found.merged(work.compute(chunk))
    return found, time.perf_counter() - began


def _threads(workers: int) -> Executor:
    return _Here() if workers == 1 else ThreadPoolExecutor(workers, thread_name_prefix="kinetostat")


def _width(executor: Executor) -> int:
    """Return how many workers an executor has: the standard library's name for it, and mpi4py's."""
    for name in ("_max_workers", "num_workers"):
        width = getattr(executor, name, None)
        if isinstance(width, int) and width > 0:
            return width
    return _UNKNOWN_WIDTH


def _is_loss(error: BaseException) -> bool:
    """Whether a worker was lost, as against a chunk that cannot be computed."""
    if isinstance(error, (BrokenExecutor, CancelledError)):
        return True
    dask = _dask()
    return dask is not None and isinstance(error, (dask.scheduler.KilledWorker, dask.comm.CommClosedError))


def _is_gone(error: BaseException) -> bool:
    """Whether there is nobody any more to send chunks to."""
    dask = _dask()
    return dask is not None and isinstance(error, (dask.client.ClosedClientError, dask.comm.CommClosedError))


def _gone() -> UsageError:
    return UsageError(
        "the Dask scheduler is gone", remedy="start it again; with a checkpoint, a run goes on where it was"
    )


def _client(executor: Executor) -> Any:
    """Return the Dask client that an executor is of, or None."""
    dask = _dask()
    return executor._client if dask is not None and isinstance(executor, dask.cfexecutor.ClientExecutor) else None


def _is_empty(client: Any) -> bool:
    """Whether a Dask cluster is known to have no workers."""
    try:
        return client.status == "running" and not client.nthreads(callback_timeout=_LOOK)
    except Exception:  # it is not, or no longer, reached: that is seen by the client's status
        return False


def _dask() -> ModuleType | None:
    return sys.modules.get("distributed")  # where it is not loaded, nothing is computed by it
