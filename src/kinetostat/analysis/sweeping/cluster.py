"""A Dask cluster as an executor: Dask's own, which sends the tasks of a worker that is lost to others."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager

from kinetostat.errors import UsageError, quote

__all__ = ["cluster"]

_PATIENCE = 5.0  # s for an answer of the scheduler


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
        # A client that has not reached its scheduler does not end cleanly, so that is tried before.
        with ThreadPoolExecutor(1) as thread:  # a thread of its own: a notebook has an event loop in this one
            thread.submit(asyncio.run, _reach(address)).result()
        client = Client(address, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError, ImportError, RuntimeError) as error:
        why = next(iter(str(error).splitlines()), "") or type(error).__name__
        raise UsageError(
            f"no Dask scheduler at {quote(address)}: {why}", remedy="an address is like tcp://HOST:8786"
        ) from None
    with client:
        threads = sum(client.nthreads().values())
        if not threads:
            raise UsageError(f"the Dask scheduler at {quote(address)} has no workers", remedy="start some: dask worker")
        executor = client.get_executor(pure=False)
        executor.num_workers = threads  # mpi4py's name for it: how many chunks are to be in flight
        yield executor


async def _reach(address: str) -> None:
    """Connect to a scheduler and leave it again.

    Raises:
        OSError: it does not answer in Dask's way, in time.
        ValueError: no address.
    """
    from distributed.comm import connect

    await (await connect(address, timeout=_PATIENCE)).close()
