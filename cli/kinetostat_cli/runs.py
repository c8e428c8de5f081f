"""How a run over many configurations is made: by how many threads, on which cluster, kept in which folder."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kinetostat.errors import UsageError
from kinetostat_cli.console import progress_bar, refuse, say
from kinetostat_cli.options import RunOptions

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from kinetostat import CapabilityMap, Sweep

__all__ = ["check", "cores", "running", "say_rate"]


def check(run: RunOptions) -> None:
    """Refuse options that do not go together.

    Raises:
        UsageError: threads are asked for on a cluster; the checkpoint has no folder of its own.
    """
    if run.checkpoint == Path():
        raise UsageError("--checkpoint takes a folder of its own", remedy="name one, such as ./checkpoint")
    alone = "is of threads here, not of a cluster"
    refuse(run.scheduler is not None, {"--jobs": run.jobs}, alone, "leave one of the two out")


@contextmanager
def running(run: RunOptions) -> Iterator[dict[str, Any]]:
    """Yield who computes, and who is told of it, as the library takes them."""
    with _executor(run.scheduler) as executor, progress_bar() as tell:
        yield {"workers": run.jobs or cores(), "executor": executor, "progress": tell}


@contextmanager
def _executor(scheduler: str | None) -> Iterator[Executor | None]:
    if scheduler is None:
        yield None
        return
    from kinetostat.analysis.sweeping.cluster import cluster

    with cluster(scheduler) as executor:
        yield executor


def cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def say_rate(result: Sweep | CapabilityMap) -> None:
    """Say how fast it went, and what an earlier run had done."""
    from kinetostat.analysis.sweeping.pace import counted, lasting

    took = lasting(result.seconds) if result.seconds >= 1 else f"{result.seconds:.2g} s"
    own = result.count - result.continued
    before = f" ({counted(result.continued)} were done before)" if result.continued else ""
    if own:
        say("note", f"{counted(own)} configurations in {took}, {counted(result.rate)} a second{before}")
    else:
        say("note", f"all {counted(result.count)} configurations were done before: the checkpoint has them")
