"""Each robot in a process of its own: what a crash, a hang or a lack of memory costs is that robot, and it is told."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import types
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.context import ForkServerContext, ForkServerProcess
from typing import Any

from kinetostat.errors import UsageError, cut
from kinetostat.gate.checking import Task, check_robot
from kinetostat.gate.result import FileCheck, Verdict

__all__ = ["check_all", "warm_up"]

MEMORY = 8 * 1024**3  # bytes of address space of one process
_TASKS_A_PROCESS = 50
_SAFE_PATH = "PYTHONSAFEPATH"

Check = Callable[[Task], FileCheck]


def warm_up() -> None:
    """Start, in the background, the process that the others are forked from: it loads the libraries once.

    Raises:
        UsageError: it cannot be started.
    """
    from multiprocessing import forkserver

    forkserver.set_forkserver_preload(["kinetostat.gate.preloaded"])
    # It is started as `python -c`, which would look for modules in the current folder first: that of untrusted robots.
    before = os.environ.get(_SAFE_PATH)
    os.environ[_SAFE_PATH] = "1"
    try:
        forkserver.ensure_running()
    except OSError as error:  # a TMPDIR whose name is too long for a socket
        raise UsageError(f"no process can be started: {error}", remedy="set TMPDIR=/tmp") from None
    finally:
        if before is None:
            del os.environ[_SAFE_PATH]
        else:
            os.environ[_SAFE_PATH] = before


def check_all(
    tasks: Sequence[Task],
    *,
    jobs: int,
    timeout: float,
    done: Callable[[FileCheck], None] | None = None,
    check: Check = check_robot,
) -> tuple[FileCheck, ...]:
    """Check robots in processes of their own, `jobs` at a time; return the results in the order of the tasks.

    Args:
        tasks: the robots.
        jobs: how many processes.
        timeout: seconds after which a robot counts as hanging.
        done: told each result as it comes.
        check: what is asked of each robot.
    """
    warm_up()
    results: list[FileCheck] = []

    def keep(file: FileCheck) -> None:
        results.append(file)
        if done is not None:
            done(file)

    while len(results) < len(tasks):
        before = len(results)
        try:
            _check_some(tasks[before:], jobs, timeout, keep, check)
        except BrokenProcessPool:
            # The pool may break over one that dies at a bad moment: the others are asked in a new one.
            if len(results) == before:
                keep(_crashed(tasks[before], "its process died"))
    return tuple(results)


def _check_some(
    tasks: Sequence[Task], jobs: int, timeout: float, keep: Callable[[FileCheck], None], check: Check
) -> None:
    """Check robots in one pool and tell each result.

    Raises:
        BrokenProcessPool: it broke; those not told are to be asked again.
    """
    from pebble import ProcessPool

    with ProcessPool(
        max_workers=min(jobs, len(tasks)), max_tasks=_TASKS_A_PROCESS, initializer=_in_bounds, context=_Context()
    ) as pool:
        futures = [pool.schedule(_guarded, args=(check, task), timeout=timeout) for task in tasks]
        try:
            for task, future in zip(tasks, futures, strict=True):
                keep(_result(task, future, timeout))
        except BaseException:
            pool.stop()  # type: ignore[no-untyped-call]
            raise


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


def _guarded(check: Check, task: Task) -> FileCheck:
    """Return what a check says; whatever it raises is told, and is no pass."""
    try:
        return check(task)
    except MemoryError:
        return _crashed(task, f"out of memory ({MEMORY // 1024**3} GiB)")
    except BaseException as error:  # SystemExit, too
        return _crashed(task, f"a bug in kinetostat: {type(error).__name__}: {cut(str(error), 200)}")


def _result(task: Task, future: Any, timeout: float) -> FileCheck:
    """Return what a process has found.

    Raises:
        BrokenProcessPool: the pool broke before.
    """
    from pebble import ProcessExpired

    try:
        found: FileCheck = future.result()
    except TimeoutError:
        return _crashed(task, f"no answer within {timeout:g} s (--timeout)")
    except ProcessExpired as death:
        return _crashed(task, f"its process died ({_cause(death.exitcode)})")
    except BrokenProcessPool:
        raise
    except MemoryError:
        return _crashed(task, f"out of memory ({MEMORY // 1024**3} GiB)")
    except Exception as error:  # such as a result that cannot travel
        return _crashed(task, f"a bug in kinetostat: {type(error).__name__}: {cut(str(error), 200)}")
    return found


def _cause(exitcode: int | None) -> str:
    if exitcode is not None and exitcode < 0:
        try:
            return signal.Signals(-exitcode).name
        except ValueError:
            pass
    return f"exit code {exitcode}"


def _crashed(task: Task, reason: str) -> FileCheck:
    return FileCheck(task.name, Verdict.CRASHED, reason=reason)
