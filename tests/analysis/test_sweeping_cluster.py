"""A Dask cluster of real processes: the same bits, also when one of them is killed."""

from __future__ import annotations

import signal
import sys
from contextlib import contextmanager

import pytest

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

    with (
        dask.config.set(
            {
                "distributed.comm.timeouts.connect": "2s",  # how long it looks for a worker that is dead
                "distributed.scheduler.allowed-failures": deaths,  # of workers that were at a task
            }
        ),
        LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0", host="127.0.0.1"
        ) as local,
    ):
        yield local


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
