"""A Dask cluster of real processes: the same bits, also when one of them is killed."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from threading import Thread

import pytest

import sweeping_toys
from kinetostat.analysis.sweeping.cluster import cluster
from kinetostat.analysis.sweeping.running import run
from kinetostat.errors import UsageError
from sweeping_toys import Toy

TOY = Toy()
# What Dask leaves open at its end, and says of processes that are killed, is not ours.
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")


@contextmanager
def local_cluster(workers: int = 2, *, deaths: int = 3):
    import dask
    from distributed import LocalCluster

    settings = {
        "distributed.comm.timeouts.connect": "2s",  # how long it looks for a worker that is dead
        "distributed.scheduler.allowed-failures": deaths,  # of workers that were at a task
    }
    with dask.config.set(settings):
        local = LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0", host="127.0.0.1"
        )
        try:
            yield local
        finally:
            with suppress(AssertionError):  # of distributed: a worker that it was just starting again cannot be ended
                local.close()


@pytest.fixture(scope="module")
def address():
    with local_cluster() as local:
        yield local.scheduler_address


def test_the_same_bits(address):
    taken = list[int]()
    with cluster(address) as executor:
        assert executor.num_workers == 2
        assert run(TOY, executor=executor).partial == TOY.expected()
        assert run(TOY, executor=executor, sink=lambda chunk, _: taken.append(chunk)).partial == TOY.expected()
    assert taken == list(range(TOY.chunks))


def test_a_worker_killed_in_the_middle(address, tmp_path):
    toy = Toy(accident=tmp_path / "killed", pause=0.005)
    with cluster(address) as executor:
        outcome = run(toy, executor=executor)
    assert toy.accident.exists()
    assert outcome.complete
    assert outcome.partial == toy.expected()
    assert outcome.warnings == ()


def test_a_wrong_chunk_leaves_the_cluster_to_others(address):
    with cluster(address) as executor:
        with pytest.raises(ZeroDivisionError, match="wrong chunk"):
            run(Toy(wrong=17), executor=executor)
        assert run(TOY, executor=executor).partial == TOY.expected()


def test_ctrl_c(address):
    def interrupt(_, share):
        if share > 0.3 and not asked:
            asked.append(share)
            signal.raise_signal(signal.SIGINT)

    asked = list[float]()
    with cluster(address) as executor:
        outcome = run(Toy(chunks=100, pause=0.01), executor=executor, progress=interrupt)
        assert not outcome.complete
        assert list(outcome.partial.times.nonzero()[0]) == list(outcome.done)
        assert run(TOY, executor=executor).partial == TOY.expected()


def test_who_kills_each_worker_ends_the_run(tmp_path, monkeypatch):
    monkeypatch.setattr("kinetostat.analysis.sweeping.workers._LOSSES", 1)
    with local_cluster(deaths=0) as local, cluster(local.scheduler_address) as executor:
        toy = Toy(accident=tmp_path / "killed")
        assert run(toy, executor=executor).partial == TOY.expected()  # Dask gives it up at once, it is sent again
        with pytest.raises(UsageError, match=r"of 50 .* 2 times: KilledWorker") as said:
            run(Toy(deadly=20), executor=executor)
    assert "\n" not in str(said.value)


def test_no_scheduler():
    with pytest.raises(UsageError, match="no Dask scheduler at 'nowhere'"), cluster("nowhere"):
        pass


def test_no_scheduler_that_answers(monkeypatch):
    monkeypatch.setattr("kinetostat.analysis.sweeping.cluster._PATIENCE", 0.5)
    with pytest.raises(UsageError, match=r"no Dask scheduler at .*: Timed out") as said, cluster("tcp://127.0.0.1:9"):
        pass
    assert "\n" not in str(said.value)


@contextmanager
def separate_cluster(folder: Path):
    """A scheduler and what starts its workers: processes that have nothing to do with this one, and may be killed."""
    file = folder / "scheduler.json"
    environment = {**os.environ, "PYTHONPATH": str(Path(sweeping_toys.__file__).parent)}

    def start(program: str, *options: str) -> subprocess.Popen:
        command = [sys.executable, "-m", f"distributed.cli.{program}", "--scheduler-file", str(file), "--no-dashboard"]
        process = subprocess.Popen(
            [*command, *options], env=environment, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        stack.callback(process.wait)
        stack.callback(process.kill)
        return process

    with ExitStack() as stack:
        scheduler = start("dask_scheduler", "--host", "127.0.0.1", "--port", "0")
        yield scheduler, lambda: start("dask_worker", "--nthreads", "1", "--no-nanny", "--local-directory", str(folder))


def address_of(folder: Path) -> str:
    """Return the address of a separate cluster's scheduler as soon as it has a worker."""
    from distributed import Client

    for _ in range(300):
        if (folder / "scheduler.json").exists():
            break
        time.sleep(0.1)
    with Client(scheduler_file=str(folder / "scheduler.json"), set_as_default=False) as client:
        client.wait_for_workers(1, timeout=30)
        return client.scheduler.address


def once(act):
    """Return a progress that does something when some of the work is done, once; and what it was told."""
    told = list[str]()

    def tell(words, share):
        if share > 0.1 and not done:
            done.append(share)
            act()
        told.append(words)

    done = list[float]()
    return tell, told


def test_a_scheduler_that_dies(tmp_path, capfd):
    toy = Toy(chunks=3000, pause=0.01)
    with separate_cluster(tmp_path) as (scheduler, start):
        start()
        tell, _ = once(scheduler.kill)
        with cluster(address_of(tmp_path)) as executor:
            began = time.monotonic()
            with pytest.raises(UsageError, match="the Dask scheduler is gone") as said:
                run(toy, executor=executor, progress=tell, checkpoint=tmp_path / "kept")
            assert time.monotonic() - began < 20
    assert "\n" not in str(said.value)
    assert "Traceback" not in capfd.readouterr().err
    rest = run(toy, checkpoint=tmp_path / "kept", progress=once(lambda: signal.raise_signal(signal.SIGINT))[0])
    assert rest.continued >= 0.1 * toy.rows


def test_the_last_worker_dies_and_another_comes(tmp_path, monkeypatch):
    monkeypatch.setattr("kinetostat.analysis.sweeping.workers._LOOK", 0.2)
    toy = Toy(chunks=300, pause=0.01)
    with separate_cluster(tmp_path) as (_, start):
        first = start()
        tell, told = once(first.kill)

        def tell_and_help(words, share):
            tell(words, share)
            if words == "no workers: waiting" and len(started) == 0:
                started.append(start())

        started = list[subprocess.Popen]()
        with cluster(address_of(tmp_path)) as executor:
            outcome = run(toy, executor=executor, progress=tell_and_help)
    assert started
    assert "no workers: waiting" in told
    assert outcome.complete
    assert outcome.partial == toy.expected()
    assert outcome.warnings == ("the Dask cluster had no workers for a while",)


@contextmanager
def listener(answer: bytes):
    """A port where somebody else listens."""

    def serve():
        kept = []
        while True:
            try:
                connection, _ = server.accept()
            except OSError:
                return
            connection.sendall(answer)
            kept.append(connection)

    with socket.create_server(("127.0.0.1", 0)) as server:
        Thread(target=serve, daemon=True).start()
        yield f"tcp://127.0.0.1:{server.getsockname()[1]}"
        server.shutdown(socket.SHUT_RDWR)


@pytest.mark.parametrize("answer", [b"", b"HTTP/1.1 400 Bad Request\r\n\r\n" * 50], ids=["silence", "HTTP"])
def test_a_port_that_is_not_dasks(answer, monkeypatch):
    monkeypatch.setattr("kinetostat.analysis.sweeping.cluster._PATIENCE", 0.5)
    began = time.monotonic()
    with (
        listener(answer) as address,
        pytest.raises(UsageError, match=r"no Dask scheduler at .*: no answer of Dask's") as said,
        cluster(address),
    ):
        pass
    assert "\n" not in str(said.value)
    assert time.monotonic() - began < 5


@pytest.mark.parametrize("address", ["tls://127.0.0.1:1", "ucx://127.0.0.1:1", "inproc://x", ""])
def test_an_address_of_another_kind(address):
    with pytest.raises(UsageError, match="no Dask scheduler at") as said, cluster(address):
        pass
    assert "\n" not in str(said.value)


def test_a_workers_address():
    with (
        local_cluster(workers=1) as local,
        pytest.raises(UsageError, match="a worker is there"),
        cluster(next(iter(local.scheduler_info["workers"]))),
    ):
        pass


def test_no_workers():
    with (
        local_cluster(workers=0) as local,
        pytest.raises(UsageError, match="has no workers"),
        cluster(local.scheduler_address),
    ):
        pass


def test_no_dask(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with (
        pytest.raises(UsageError, match=r"needs Dask \(pip install 'kinetostat\[dask\]'\)"),
        cluster("tcp://127.0.0.1:9"),
    ):
        pass
