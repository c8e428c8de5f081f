"""A Dask cluster as an executor: Dask's own, which sends the tasks of a worker that is lost to others."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from queue import Empty, SimpleQueue
from threading import Thread

from kinetostat.errors import UsageError, quote

__all__ = ["cluster"]

_PATIENCE = 5.0  # s for an answer of the scheduler
_MORE = 1.0  # s, for what does not keep to that


@contextmanager
def cluster(address: str) -> Iterator[Executor]:
    """Connect to a Dask cluster; yield the executor of its client. Workers need kinetostat of the same version.

    Args:
        address: of the scheduler, for instance `tcp://10.0.0.5:8786`.

    Raises:
        UsageError: Dask is not installed; there is no scheduler, or it has no workers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise UsageError("a Dask scheduler needs Dask", remedy="pip install 'kinetostat[dask]'") from None
    try:
        _try(address)  # a client that has not reached its scheduler does not end cleanly
        client = Client(address, timeout=_PATIENCE, set_as_default=False)
    except Exception as error:  # what is said by something else than Dask is misread in many ways
        said = "" if isinstance(error, MemoryError) else next(iter(str(error).splitlines()), "")
        why = said or f"no answer of Dask's ({type(error).__name__})"
        raise UsageError(
            f"no Dask scheduler at {quote(address)}: {why}", remedy="an address is like tcp://HOST:8786"
        ) from None
    with _silent(), client:
        threads = sum(client.nthreads().values())
        if not threads:
            raise UsageError(f"the Dask scheduler at {quote(address)} has no workers", remedy="start some: dask worker")
        executor = client.get_executor(pure=False)
        executor.num_workers = threads  # mpi4py's name for it: how many chunks are to be in flight
        yield executor


@contextmanager
def _silent() -> Iterator[None]:
    """Leave it to `Workers` to say that a scheduler is gone: its client logs that in many lines."""
    log = logging.getLogger("distributed.client")
    before = log.level
    log.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        log.setLevel(before)


def _try(address: str) -> None:
    """Reach a scheduler, in a thread of its own: a notebook has an event loop in this one, and not all ends in time.

    Raises:
        Exception: what reaching it raises; a TimeoutError where that does not end.
    """
    ended = SimpleQueue[Exception | None]()

    def reach() -> None:
        try:
            asyncio.run(asyncio.wait_for(_reach(address), _PATIENCE + _MORE))
        except Exception as error:
            ended.put(error)
        else:
            ended.put(None)

    Thread(target=reach, daemon=True).start()
    try:
        error = ended.get(timeout=_PATIENCE + 2 * _MORE)
    except Empty:
        error = TimeoutError()
    if error is not None:
        raise error


async def _reach(address: str) -> None:
    """Connect to a scheduler and leave it again.

    Raises:
        OSError: it does not answer in Dask's way, in time.
        ValueError: no address, or one of a worker.
    """
    from distributed.comm import connect

    comm = await connect(address, timeout=_PATIENCE)
    try:
        await comm.write({"op": "identity"})
        if (await comm.read())["type"] in ("Worker", "Nanny"):
            raise ValueError("a worker is there")
    finally:
        await comm.close()
