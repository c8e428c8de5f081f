"""A real sweep: the same bits by threads, by processes, by a cluster that loses a worker, and after interruptions."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest

import kinetostat
from kinetostat.analysis.sweeping.cluster import cluster
from kinetostat.analysis.sweeping.running import Outcome, run
from kinetostat.analysis.sweeping.sweep import SweepWork, sweep_work

CHUNKS = 16  # more than are in flight when the second half begins


@pytest.fixture(autouse=True)
def _told_of_each_chunk(monkeypatch):
    monkeypatch.setattr("kinetostat.analysis.sweeping.running._TOLD_EVERY", 0.0)


@pytest.fixture(scope="module")
def work() -> SweepWork:
    model = kinetostat.load("example:ur5_robot")
    measures = ("minimum_singular_value", "inverse_condition_number", "limit_distance")
    rest = np.zeros(model.robot.nq)
    return sweep_work(model, "tool0", rest, samples=CHUNKS * 2**16 - 1000, measures=measures, below={})


@pytest.fixture(scope="module")
def alone(work) -> dict[str, bytes]:
    return bits(run(work))


def bits(outcome: Outcome) -> dict[str, bytes]:
    assert outcome.complete
    assert outcome.warnings == ()
    return {name: array.tobytes() for name, array in outcome.partial.state().items()}


@pytest.mark.parametrize("workers", [2, 5])
def test_threads(work, alone, workers):
    assert bits(run(work, workers=workers)) == alone


def test_an_executor_of_threads(work, alone):
    with ThreadPoolExecutor(3) as executor:
        assert bits(run(work, executor=executor)) == alone


def test_processes(work, alone):
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as executor:
        assert bits(run(work, executor=executor)) == alone


def test_a_list_travels_in_parts():
    """Each task carries its rows alone; where each carried all of them, there was a warning, and time was lost."""
    model = kinetostat.load("example:ur5_robot")
    q = kinetostat.random_configurations(model, 0, 5 * 2**16 + 100)
    work = sweep_work(model, "tool0", q[0], configurations=q, measures="minimum_singular_value,position")
    tasks, alone = [], bits(run(work))
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as executor:
        submit = executor.submit

        def weighed(compute, task, part, losses):
            tasks.append((len(task), len(pickle.dumps(part)), len(pickle.dumps(compute))))
            return submit(compute, task, part, losses)

        executor.submit = weighed
        assert bits(run(work, executor=executor)) == alone
    assert sum(count for count, *_ in tasks) == 6
    for count, part, compute in tasks:
        assert part <= count * 2**16 * 6 * 8 + 2000
        assert compute < 1e6


def test_a_killed_process(work, alone):
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as executor:
        outcome = run(work, executor=executor, progress=killer(lambda: next(iter(executor._processes))))
    state = {name: array.tobytes() for name, array in outcome.partial.state().items()}
    assert outcome.complete
    assert state == alone
    assert len(outcome.warnings) == 1


@pytest.mark.parametrize("workers", [1, 2])
def test_interrupted_and_continued(work, alone, workers, tmp_path):
    for step in (0.2, 0.4):
        assert not run(work, workers=workers, checkpoint=tmp_path, progress=interrupting(step)).complete
    outcome = run(work, workers=3 - workers, checkpoint=tmp_path)
    assert outcome.continued >= 0.4 * work.rows
    assert bits(outcome) == alone
    assert bits(run(work, checkpoint=tmp_path)) == alone


@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_cluster_that_loses_a_worker(work, alone):
    import dask
    from distributed import LocalCluster

    with (
        dask.config.set({"distributed.comm.timeouts.connect": "2s"}),  # how long it looks for a worker that is dead
        LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0", host="127.0.0.1"
        ) as local,
        cluster(local.scheduler_address) as executor,
    ):
        assert bits(run(work, executor=executor)) == alone
        asked = list[int]()
        outcome = run(work, executor=executor, progress=killer(lambda: local.workers[0].process.pid, asked))
    assert asked
    assert bits(outcome) == alone


def interrupting(step: float):
    """Return a progress that interrupts once, when a share is done."""
    asked = list[float]()

    def tell(_, share):
        if share >= step and not asked:
            asked.append(share)
            signal.raise_signal(signal.SIGINT)

    return tell


def killer(pid, asked: list[int] | None = None):
    """Return a progress that kills a process, once, when some of the work is done."""
    asked = [] if asked is None else asked

    def tell(_, share):
        if share > 0 and not asked:
            asked.append(pid())
            os.kill(asked[0], signal.SIGKILL)

    return tell
