"""Sweeps that sum up: threads, Dask workers, 10^8 configurations, the first run and the next; by the clock."""

import contextlib
import importlib.util
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import kinetostat as ks

COMMAND = str(Path(sys.executable).with_name("kinetostat"))
ROBOT = ("example:panda", "-f", "panda_hand")
MANY, FEW, HUGE = 5_000_000, 1_000_000, 100_000_000
WANTED_MEMORY, WANTED_THREADS, WANTED_WORKERS = 600, 1.8, 1.6


@dataclass(frozen=True)
class Run:
    """A command that has ended: seconds of wall time, its largest memory in MB."""

    seconds: float
    memory: float


def command(count: int, cache: str | None = None) -> Run:
    """Run a sweep that sums up; its cache folder is another one where that is said.

    Raises:
        RuntimeError: it fails.
    """
    asked = [COMMAND, "sweep", *ROBOT, "--samples", str(count), "--summary"]
    env = os.environ if cache is None else {**os.environ, "XDG_CACHE_HOME": cache}
    with tempfile.TemporaryFile("w+") as said:
        start = time.perf_counter()
        process = subprocess.Popen(asked, env=env, stdout=subprocess.DEVNULL, stderr=said)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        if process.returncode != 0:
            raise RuntimeError(f"{' '.join(asked)}: {said.read().strip().splitlines()[-1:]}")
    return Run(seconds, usage.ru_maxrss / 1024)


def line(what: str, value: float, unit: str, note: str = "") -> None:
    """Print a row of the table."""
    print(f"  {what:<50} {value:8.2f} {unit:<2} {note}", flush=True)


def show_scaling(quick: bool) -> None:
    """Print threads, workers and memory."""
    count, times = (FEW if quick else MANY), (3 if quick else 7)
    print(f"\n{' '.join(ROBOT)}: sums over {count:.0e} random configurations, medians of {times}; cross-checked")
    show_threads(count, times)
    if not quick:
        show_workers(count, times)
    few = command(FEW)
    line(f"kinetostat sweep --samples {FEW:.0e}: largest memory", few.memory, "MB")
    if not quick:
        huge = command(HUGE)
        rate = f"{HUGE / huge.seconds / 1e6:.2f} M/s, its start and all, {os.cpu_count()} threads"
        line(f"kinetostat sweep --samples {HUGE:.0e}", huge.seconds, "s", rate)
        line("its largest memory", huge.memory, "MB", f"(wanted: below {WANTED_MEMORY})")


def swept(model: ks.Model, count: int, **how: Any) -> ks.Sweep:
    """Return a sweep of the robot's chain by threads or an executor."""
    return ks.sweep(model, ROBOT[2], ks.configuration(model, "zero").q, samples=count, **how)


def numbers(sweep: ks.Sweep) -> list[Any]:
    """Return what is to be the same, to the bit, however it was computed."""
    each = sweep.measures.values()
    return [(x.mean, x.quantiles, x.minimum and x.minimum.value, x.maximum and x.maximum.value) for x in each]


def show_threads(count: int, times: int) -> None:
    """Print what two threads are worth."""
    model = ks.load(ROBOT[0])
    swept(model, FEW)
    pairs = [(swept(model, count, workers=1), swept(model, count, workers=2)) for _ in range(times)]
    if any(numbers(one) != numbers(two) for one, two in pairs):
        raise RuntimeError("one thread and two do not give the same numbers")
    for i, name in enumerate(("1 thread", "2 threads, the same numbers to the bit")):
        seconds = statistics.median(pair[i].seconds for pair in pairs)
        line(name, seconds, "s", f"{count / seconds / 1e6:.2f} M/s")
    line("ratio", statistics.median(a.seconds / b.seconds for a, b in pairs), "", f"(wanted: {WANTED_THREADS})")
    for workers in (1, 2):  # what else this machine does is not in these: where they are equal, threads cost nothing
        start = time.process_time()
        swept(model, count, workers=workers)
        line(
            f"the processor's time, threads: {workers}",
            1e6 * (time.process_time() - start) / count,
            "us",
            "a configuration",
        )


@contextlib.contextmanager
def cluster(workers: int) -> Iterator[Executor]:
    """Start Dask's scheduler and workers of one thread each on this machine; give the executor of a client."""
    from distributed import LocalCluster

    with (
        LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0") as local,
        ks.cluster(local.scheduler_address) as executor,
    ):
        yield executor


def show_workers(count: int, times: int) -> None:
    """Print what two worker processes are worth."""
    if importlib.util.find_spec("distributed") is None:
        print("  Dask is absent: pip install 'kinetostat[dask]'")
        return
    model, seconds = ks.load(ROBOT[0]), dict[int, float]()
    for workers in (1, 2):
        with cluster(workers) as executor:
            swept(model, count, executor=executor)  # workers have imported and compiled
            seconds[workers] = statistics.median(swept(model, count, executor=executor).seconds for _ in range(times))
        name = f"{workers} Dask worker{'s' if workers > 1 else ''} of one thread"
        line(name, seconds[workers], "s", f"{count / seconds[workers] / 1e6:.2f} M/s")
    line("ratio", seconds[1] / seconds[2], "", f"(wanted: {WANTED_WORKERS})")


def show_start(quick: bool) -> None:
    """Print what the first run, which compiles, and the next take to start; and that of a query that does not sweep."""
    print(f"\n{' '.join(ROBOT)}: the start, whole commands")
    with tempfile.TemporaryDirectory() as cache:
        line("sweep --samples 1, nothing compiled", command(1, cache=cache).seconds, "s")
        again = statistics.median(command(1, cache=cache).seconds for _ in range(3 if quick else 9))
        size = sum(path.stat().st_size for path in Path(cache).rglob("*") if path.is_file())
        line("the same again", again, "s", f"{size / 2**20:.1f} MiB of compiled code are kept")
    query = [COMMAND, "jacobian", *ROBOT]
    times = []
    for _ in range(3 if quick else 9):
        start = time.perf_counter()
        subprocess.run(query, check=True, capture_output=True)
        times.append(time.perf_counter() - start)
    line("kinetostat jacobian", statistics.median(times), "s")
    code = "import sys\nfrom kinetostat_cli.main import main\ntry:\n    main()\nexcept SystemExit:\n    pass\n"
    code += "print('numba' in sys.modules, file=sys.stderr)"
    run = subprocess.run([sys.executable, "-c", code, *query[1:]], check=True, capture_output=True, text=True)
    print(f"  it imports Numba: {run.stderr.strip().splitlines()[-1]} (wanted: False)")
