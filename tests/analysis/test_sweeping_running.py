"""A run gives the same bits whoever computes its chunks, in any order, and whoever dies or interrupts."""

from __future__ import annotations

import multiprocessing
import random
import signal
import threading
import time
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import pytest

from kinetostat.analysis.sweeping.chunks import Chunks
from kinetostat.analysis.sweeping.running import run
from kinetostat.errors import UsageError
from sweeping_toys import Toy

TOY = Toy()


def processes(workers: int = 2) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))


class Shuffling(Executor):
    """Computes what has been asked of it when `width` chunks have, or nothing more comes, in a random order."""

    def __init__(self, seed: int, width: int = 8) -> None:
        self._max_workers = width
        self.random, self.asked, self.most = random.Random(seed), list[tuple[Future, object, tuple]](), 0
        self.lock = threading.Lock()
        self.ended, self.submitted = False, 0
        self.thread = threading.Thread(target=self._work)
        self.thread.start()

    def submit(self, fn, /, *args):
        future = Future()
        with self.lock:
            self.submitted += 1
            self.asked.append((future, fn, args))
            self.most = max(self.most, len(self.asked))
        return future

    def _work(self) -> None:
        while not self.ended:
            time.sleep(0.001)
            with self.lock:
                some, self.asked = self.asked, []
            self.random.shuffle(some)
            for future, fn, args in some:
                self.finish(future, fn, args)

    def finish(self, future, fn, args) -> None:
        if future.set_running_or_notify_cancel():
            future.set_result(fn(*args))

    def shutdown(self, wait=True, *, cancel_futures=False):
        self.ended = True
        self.thread.join()


class Losing(Shuffling):
    """Loses each chunk as often as it is told, by an error or, where it is None, by a cancelled future."""

    def __init__(self, times: int, error: BaseException | None, seed: int = 0) -> None:
        self.times, self.error, self.losses = times, error, dict[int, int]()
        super().__init__(seed)

    def finish(self, future, fn, args) -> None:
        task = args[0]
        self.losses[task] = self.losses.get(task, 0) + 1
        if self.losses[task] > self.times:
            super().finish(future, fn, args)
        elif self.error is None:
            future.cancel()
        else:
            future.set_exception(self.error)


@pytest.mark.parametrize("workers", [1, 2, 3, 7])
@pytest.mark.parametrize("chunks", [1, 2, 50])
def test_any_number_of_threads(workers, chunks):
    toy = Toy(chunks=chunks)
    outcome = run(toy, workers=workers)
    assert outcome.complete
    assert outcome.partial == toy.expected()
    assert outcome.rows == toy.rows
    assert outcome.done == Chunks(((0, chunks),))
    assert outcome.rate == pytest.approx(outcome.rows / outcome.seconds, rel=0.2)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("sink", [False, True])
def test_any_order(seed, sink):
    taken = list[int]()
    with Shuffling(seed) as executor:
        outcome = run(TOY, executor=executor, sink=(lambda chunk, _: taken.append(chunk)) if sink else None)
    assert outcome.partial == TOY.expected()
    assert taken == (list(range(TOY.chunks)) if sink else [])


def test_executors_of_threads_and_of_processes():
    with ThreadPoolExecutor(3) as threads, processes() as others:
        assert run(TOY, executor=threads).partial == run(TOY, executor=others).partial == TOY.expected()


def test_no_chunk_is_complete_at_once():
    outcome = run(Toy(chunks=0))
    assert outcome.complete
    assert (outcome.rows, outcome.rate) == (0, 0)


def test_few_tasks_are_in_flight_and_short_chunks_share_one():
    with Shuffling(0, width=4) as executor:
        run(Toy(chunks=1000), executor=executor)
    assert executor.most <= 12
    assert executor.submitted < 500


def test_long_chunks_travel_alone():
    with ThreadPoolExecutor(2) as threads, Shuffling(0, width=4) as executor:
        executor.finish = lambda future, fn, args: threads.submit(Shuffling.finish, executor, future, fn, args)
        run(Toy(chunks=8, pause=0.26), executor=executor)
    assert executor.submitted == 8


@pytest.mark.parametrize("heavy", [False, True])
def test_a_heavy_question_is_worth_a_word(heavy):
    with Shuffling(0) as executor:
        outcome = run(Toy(ballast=bytes(11_000_000 if heavy else 0)), executor=executor)
    assert outcome.partial == TOY.expected()
    assert len(outcome.warnings) == heavy


@pytest.mark.parametrize("sink", [False, True])
def test_a_straggler_holds_back_the_rows_but_not_the_summary(sink):
    class Late(Toy):
        def compute(self, chunk):
            begun.append(chunk)
            if chunk == 0:
                go_on.wait(10)
            elif chunk == 30:
                go_on.set()
            return super().compute(chunk)

    begun, go_on, taken = list[int](), threading.Event(), list[int]()
    if sink:  # nothing else lets it go on: as many as the window holds have begun
        threading.Timer(0.3, lambda: (taken.append(max(begun)), go_on.set())).start()
    late = Late(chunks=60)
    assert run(late, workers=2, sink=(lambda *_: None) if sink else None).partial.total == late.expected().total
    assert not sink or taken[0] <= 6


def test_a_wrong_chunk_is_not_tried_again():
    class Noted(Toy):
        def compute(self, chunk):
            begun.append(chunk)
            return super().compute(chunk)

    begun = list[int]()
    with ThreadPoolExecutor(3) as executor, pytest.raises(ZeroDivisionError, match="wrong chunk"):
        run(Noted(wrong=17), executor=executor)
    assert begun.count(17) == 1


@pytest.mark.parametrize("kind", ["threads", "processes"])
def test_a_wrong_chunk_leaves_the_executor_to_others(kind):
    with ThreadPoolExecutor(2) if kind == "threads" else processes() as executor:
        with pytest.raises(ZeroDivisionError):
            run(Toy(wrong=17), executor=executor)
        assert run(TOY, executor=executor).partial == TOY.expected()


@pytest.mark.parametrize("error", [None, CancelledError()])
def test_lost_chunks_are_sent_again(error):
    with Losing(3, error) as executor:
        outcome = run(TOY, executor=executor)
    assert outcome.partial == TOY.expected()
    assert outcome.warnings == ()


@pytest.mark.parametrize("error", [None, CancelledError()])
def test_what_is_lost_again_and_again_ends_the_run(error):
    with (
        Losing(9, error) as executor,
        pytest.raises(UsageError, match=r"chunks? \d+ .*of 50 .* 4 times") as said,
    ):
        run(TOY, executor=executor)
    assert "\n" not in str(said.value)
    assert said.value.remedy


@pytest.mark.parametrize("sink", [False, True])
def test_a_killed_worker_process_breaks_its_executor_and_loses_nothing(tmp_path, sink):
    toy, taken = Toy(accident=tmp_path / "killed"), list[int]()
    with processes() as executor:
        outcome = run(toy, executor=executor, sink=(lambda chunk, _: taken.append(chunk)) if sink else None)
        with pytest.raises(BrokenExecutor):
            executor.submit(int)
        again = run(toy, executor=executor)  # already broken when it begins
    assert toy.accident.exists()
    assert outcome.partial == again.partial == toy.expected()
    assert taken == (list(range(toy.chunks)) if sink else [])
    assert len(outcome.warnings) == len(again.warnings) == 1
    assert "worker process died" in outcome.warnings[0]


@pytest.mark.parametrize("workers", [1, 2, 4])
@pytest.mark.parametrize("sink", [False, True])
def test_ctrl_c_ends_with_what_is_done(workers, sink):
    taken = list[int]()
    toy = Toy(interrupt=10, pause=0.002)
    outcome = run(toy, workers=workers, sink=(lambda chunk, _: taken.append(chunk)) if sink else None)
    assert not outcome.complete
    assert list(outcome.partial.times.nonzero()[0]) == list(outcome.done)
    assert 9 <= len(outcome.done) <= 10 + 3 * workers
    assert taken == (list(outcome.done) if sink else [])
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_second_ctrl_c_goes_through():
    def twice(what, share):
        if share > 0:
            signal.raise_signal(signal.SIGINT)
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        run(TOY, progress=twice)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.parametrize("seed", range(8))
def test_a_program_that_answers_ctrl_c_itself_gets_a_whole_sum_too(seed, request):
    class Interrupted(Toy):
        def compute(self, chunk):
            if chunk == 20:
                time.sleep(0.0005 * seed)
                signal.pthread_kill(main, signal.SIGINT)
            return super().compute(chunk)

    def torn(*_):
        raise KeyboardInterrupt

    main = threading.main_thread().ident
    before = signal.signal(signal.SIGINT, torn)
    request.addfinalizer(lambda: signal.signal(signal.SIGINT, before))
    outcome = run(Interrupted(chunks=4000), workers=2)
    assert not outcome.complete
    assert list(outcome.partial.times.nonzero()[0]) == list(outcome.done)
    assert outcome.partial.times.max(initial=0) <= 1
    assert signal.getsignal(signal.SIGINT) is torn


def test_runs_in_other_threads_leave_signals_alone():
    with ThreadPoolExecutor(1) as thread:
        assert thread.submit(run, TOY, workers=2).result().partial == TOY.expected()


def test_progress_tells_shares_that_grow(monkeypatch):
    monkeypatch.setattr("kinetostat.analysis.sweeping.running._TOLD_EVERY", 0.0)
    told = list[tuple[str, float]]()
    run(TOY, workers=2, progress=lambda *what: told.append(what))
    shares = [share for _, share in told]
    assert shares == sorted(shares)
    assert (shares[0], shares[-1]) == (0, 1)
    assert told[0][0] == "0 of 493 configurations"
    assert told[-1][0].startswith("493 of 493 configurations, ")
    assert told[-1][0].endswith("/s, 0 s left")


def test_a_work_that_does_not_travel_is_refused_before_anything_runs():
    class Local(Toy):
        pass

    with processes(1) as executor, pytest.raises((AttributeError, TypeError), match="Local"):
        run(Local(), executor=executor)


def test_refusals(tmp_path: Path):
    with pytest.raises(UsageError, match="at least one worker"):
        run(TOY, workers=0)
    with pytest.raises(UsageError, match="not rows"):
        run(TOY, checkpoint=tmp_path, sink=lambda *_: None)
