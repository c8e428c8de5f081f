"""Each robot in a process of its own: what a crash, a hang or a lack of memory costs is that robot, and it is told."""

from __future__ import annotations

import signal
from collections.abc import Callable, Sequence
from typing import Any

from kinetostat.errors import cut
from kinetostat.gate.checking import Task, check_robot
from kinetostat.gate.result import FileCheck, Verdict

__all__ = ["check_all", "warm_up"]

MEMORY = 8 * 1024**3  # bytes of address space of one process
_TASKS_A_PROCESS = 50

Check = Callable[[Task], FileCheck]


def warm_up() -> None:
    """Start, in the background, the process that the others are forked from: it loads the libraries once."""
    from multiprocessing import forkserver

    forkserver.set_forkserver_preload(["kinetostat.gate.preloaded"])
    forkserver.ensure_running()


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
    from multiprocessing import get_context

    from pebble import ProcessPool

    warm_up()
    results: list[FileCheck] = []
    with ProcessPool(
        max_workers=min(jobs, len(tasks)),
        max_tasks=_TASKS_A_PROCESS,
        initializer=_in_bounds,
        context=get_context("forkserver"),
    ) as pool:
        futures = [pool.schedule(check, args=(task,), timeout=timeout) for task in tasks]
        try:
            for task, future in zip(tasks, futures, strict=True):
                results.append(_result(task, future, timeout))
                if done is not None:
                    done(results[-1])
        except BaseException:
            pool.stop()  # type: ignore[no-untyped-call]
            raise
    return tuple(results)


def _in_bounds() -> None:
    """Bound this process's memory; leave Ctrl-C to the parent."""
    import resource

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    bound = MEMORY if hard == resource.RLIM_INFINITY else min(MEMORY, hard)
    resource.setrlimit(resource.RLIMIT_AS, (bound, hard))


def _result(task: Task, future: Any, timeout: float) -> FileCheck:
    from pebble import ProcessExpired

    try:
        found: FileCheck = future.result()
    except TimeoutError:
        return _crashed(task, f"no answer within {timeout:g} s (--timeout)")
    except ProcessExpired as death:
        return _crashed(task, f"its process died ({_cause(death.exitcode)})")
    except MemoryError:
        return _crashed(task, f"out of memory ({MEMORY // 1024**3} GiB)")
    except Exception as error:
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
