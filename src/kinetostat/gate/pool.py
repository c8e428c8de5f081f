"""Each robot in a process of its own: what a crash, a hang or a lack of memory costs is that robot, and it is told."""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import sys
import types
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing.context import ForkServerContext, ForkServerProcess
from typing import Any, Generic, TypeVar

from kinetostat.errors import UsageError, cut
from kinetostat.gate.checking import Task, check_robot
from kinetostat.gate.result import FileCheck, Verdict

__all__ = ["check_all", "run_all", "warm_up"]

MEMORY = 8 * 1024**3  # bytes of address space of one process
_OUT_OF_MEMORY = f"out of memory ({MEMORY // 1024**3} GiB)"
_TASKS_A_PROCESS = 50
_TICK = 0.2  # s, between two looks at which tasks are being worked on
_SAFE_PATH = "PYTHONSAFEPATH"
_PRELOADED = "kinetostat.gate.preloaded"

Asked = TypeVar("Asked")
Found = TypeVar("Found")


def warm_up(preload: str = _PRELOADED) -> None:
    """Start, in the background, the process that the others are forked from: it loads the libraries once.

    Args:
        preload: the module that it imports. Where it runs already, it has what it was started with: what is missing
            loads in each process that needs it.

    Raises:
        UsageError: it cannot be started.
    """
    from multiprocessing import forkserver, resource_tracker

    forkserver.set_forkserver_preload([preload])
    # It is started as `python -c`, which would look for modules in the current folder first: that of untrusted robots.
    before = os.environ.get(_SAFE_PATH)
    os.environ[_SAFE_PATH] = "1"
    try:
        resource_tracker.ensure_running()  # it would be started on the way, and unblock Ctrl-C
        with _ctrl_c_blocked():
            forkserver.ensure_running()
    except OSError as error:  # a TMPDIR whose name is too long for a socket
        raise UsageError(f"no process can be started: {error}", remedy="set TMPDIR=/tmp") from None
    finally:
        if before is None:
            del os.environ[_SAFE_PATH]
        else:
            os.environ[_SAFE_PATH] = before


@contextlib.contextmanager
def _ctrl_c_blocked() -> Iterator[None]:
    """Block Ctrl-C for a moment: what is started meanwhile never hears of it. It is ours, who stop the others."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def check_all(
    tasks: Sequence[Task],
    *,
    jobs: int,
    timeout: float,
    done: Callable[[FileCheck], None] | None = None,
    check: Callable[[Task], FileCheck] = check_robot,
) -> tuple[FileCheck, ...]:
    """Check robots in processes of their own, `jobs` at a time; return the results in the order of the tasks.

    Args:
        tasks: the robots.
        jobs: how many processes.
        timeout: seconds after which a robot counts as hanging.
        done: told each result as it comes.
        check: what is asked of each robot.
    """
    return run_all(tasks, check, _crashed, jobs=jobs, timeout=timeout, done=done)


def run_all(
    tasks: Sequence[Asked],
    work: Callable[[Asked], Found],
    crashed: Callable[[Asked, str], Found],
    *,
    jobs: int,
    timeout: float,
    done: Callable[[Found], None] | None = None,
    at_work: Callable[[tuple[Asked, ...]], None] | None = None,
    preload: str = _PRELOADED,
) -> tuple[Found, ...]:
    """Do tasks in processes of their own, `jobs` at a time; return the results in the order of the tasks.

    Args:
        tasks: what is to be done; it travels to the process that does it.
        work: does one, there: a function of a module.
        crashed: makes a result of a task that came to nothing, and the reason: likewise.
        jobs: how many processes.
        timeout: seconds after which a task counts as hanging.
        done: told each result as it comes.
        at_work: told, a few times a second, which tasks are being worked on, in their order.
        preload: see `warm_up`.
    """
    warm_up(preload)
    results: dict[int, Found] = {}

    def keep(number: int, found: Found) -> None:
        results[number] = found
        if done is not None:
            done(found)

    run = _Run(work, crashed, jobs, timeout, keep, at_work)
    while len(results) < len(tasks):
        missing = {number: task for number, task in enumerate(tasks) if number not in results}
        try:
            run.some(missing)
        except BrokenProcessPool:
            # The pool may break over one that dies at a bad moment: the others are asked in a new one.
            if len(results) == len(tasks) - len(missing):
                number, task = next(iter(missing.items()))
                keep(number, crashed(task, "its process died"))
    return tuple(found for _, found in sorted(results.items()))


@dataclass(frozen=True)
class _Run(Generic[Asked, Found]):
    """How tasks are done: see `run_all`; `keep` takes the number of a task and its result."""

    work: Callable[[Asked], Found]
    crashed: Callable[[Asked, str], Found]
    jobs: int
    timeout: float
    keep: Callable[[int, Found], None]
    at_work: Callable[[tuple[Asked, ...]], None] | None

    def some(self, tasks: Mapping[int, Asked]) -> None:
        """Do tasks in one pool and tell each result.

        Raises:
            BrokenProcessPool: it broke; those not told are to be asked again.
        """
        from pebble import ProcessPool

        with ProcessPool(
            max_workers=min(self.jobs, len(tasks)),
            max_tasks=_TASKS_A_PROCESS,
            initializer=_in_bounds,
            context=_Context(),
        ) as pool:
            arguments = (self.work, self.crashed)
            numbers = {
                pool.schedule(_guarded, args=(*arguments, task), timeout=self.timeout): number
                for number, task in tasks.items()
            }
            try:
                self._follow(numbers, tasks)
            except BaseException:
                pool.stop()  # type: ignore[no-untyped-call]
                raise

    def _follow(self, numbers: Mapping[Any, int], tasks: Mapping[int, Asked]) -> None:
        """Tell what is being worked on, and each result as it comes.

        Raises:
            BrokenProcessPool: the pool broke.
        """
        waiting = set(numbers)
        while waiting:
            ready, waiting = wait(waiting, None if self.at_work is None else _TICK, FIRST_COMPLETED)
            for future in sorted(ready, key=numbers.__getitem__):
                self.keep(numbers[future], self._result(tasks[numbers[future]], future))
            if self.at_work is not None:
                running = sorted(numbers[future] for future in waiting if future.running())
                self.at_work(tuple(tasks[number] for number in running))

    def _result(self, task: Asked, future: Any) -> Found:
        """Return what a process has found.

        Raises:
            BrokenProcessPool: the pool broke before.
        """
        from pebble import ProcessExpired

        try:
            found: Found = pickle.loads(future.result())  # noqa: S301 (what a process of ours has written)
        except TimeoutError:
            return self.crashed(task, f"no answer within {self.timeout:g} s (--timeout)")
        except ProcessExpired as death:
            return self.crashed(task, f"its process died ({_cause(death.exitcode)})")
        except BrokenProcessPool:
            raise
        except MemoryError:
            return self.crashed(task, _OUT_OF_MEMORY)
        except Exception as error:  # such as a task that cannot travel
            return self.crashed(task, _bug(error))
        return found


class _Process(ForkServerProcess):
    """A process that does not import the main module again: that may be a script without a guard, or no file."""

    def start(self) -> None:
        """Start it."""
        with _no_main_module():
            super().start()


class _Context(ForkServerContext):
    """Where the pool gets its processes."""

    Process = _Process


@contextlib.contextmanager
def _no_main_module() -> Iterator[None]:
    main = sys.modules["__main__"]
    sys.modules["__main__"] = types.ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


def _in_bounds() -> None:
    """Bound this process's memory; leave Ctrl-C to the parent; end with the process that it was forked from."""
    import resource

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    bound = MEMORY if hard == resource.RLIM_INFINITY else min(MEMORY, hard)
    resource.setrlimit(resource.RLIMIT_AS, (bound, hard))
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(1, int(signal.SIGKILL), 0, 0, 0)  # PR_SET_PDEATHSIG


def _guarded(work: Callable[[Asked], Found], crashed: Callable[[Asked, str], Found], task: Asked) -> bytes:
    """Return what the work says of a task, as it travels; whatever it raises, or cannot travel, is told: no pass."""
    try:
        return pickle.dumps(work(task))
    except MemoryError:
        return pickle.dumps(crashed(task, _OUT_OF_MEMORY))
    except BaseException as error:  # SystemExit, too
        return pickle.dumps(crashed(task, _bug(error)))


def _bug(error: BaseException) -> str:
    return f"a bug in kinetostat: {type(error).__name__}: {cut(str(error), 200)}"


def _cause(exitcode: int | None) -> str:
    if exitcode is not None and exitcode < 0:
        try:
            return signal.Signals(-exitcode).name
        except ValueError:
            pass
    return f"exit code {exitcode}"


def _crashed(task: Task, reason: str) -> FileCheck:
    return FileCheck(task.name, Verdict.CRASHED, reason=reason)
