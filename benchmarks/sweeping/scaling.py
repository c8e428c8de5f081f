"""`kinetostat sweep --summary` as a command: threads, Dask workers, 10^8 configurations, the first run and the next."""

import contextlib
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

COMMAND = os.environ.get("KS_TEST") or str(Path(sys.executable).with_name("kinetostat"))
ROBOT = ("example:panda", "-f", "panda_hand")
MANY, FEW, HUGE = 5_000_000, 1_000_000, 100_000_000
WANTED_MEMORY, WANTED_THREADS, WANTED_WORKERS = 600, 1.8, 1.6


@dataclass(frozen=True)
class Run:
    """A command that has ended: seconds of wall time, its largest memory in MB, the summary that it wrote."""

    seconds: float
    memory: float
    result: dict


def command(count: int, *options: str, cache: str | None = None) -> Run:
    """Run a sweep that sums up; its cache folder is another one where that is said.

    Raises:
        RuntimeError: it fails.
    """
    line = [COMMAND, "sweep", *ROBOT, "--samples", str(count), "--summary", "-F", "json", *options]
    env = os.environ if cache is None else {**os.environ, "XDG_CACHE_HOME": cache}
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as said:
        start = time.perf_counter()
        process = subprocess.Popen(line, env=env, stdout=out, stderr=said)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        said.seek(0)
        if process.returncode != 0:
            raise RuntimeError(f"{' '.join(line)}: {said.read().strip().splitlines()[-1:]}")
        return Run(seconds, usage.ru_maxrss / 1024, json.load(out)["result"])


def line(what: str, value: float, unit: str, note: str = "") -> None:
    """Print a row of the table."""
    print(f"  {what:<50} {value:8.2f} {unit:<2} {note}", flush=True)


def show_scaling(quick: bool) -> None:
    """Print threads, workers and memory."""
    count, times = (FEW if quick else MANY), (1 if quick else 3)
    print(f"\n{' '.join(ROBOT)}: sweep --samples {count:.0e} --summary, whole commands, medians of {times}")
    show_threads(count, times)
    if not quick:
        show_workers(count, times)
    few = command(FEW, "-j", "2")
    line(f"largest memory, {FEW:.0e} configurations", few.memory, "MB")
    if not quick:
        huge = command(HUGE, "-j", str(os.cpu_count()))
        line(
            f"{HUGE:.0e} configurations, {os.cpu_count()} threads",
            huge.seconds,
            "s",
            f"{HUGE / huge.seconds / 1e6:.2f} M/s",
        )
        line(f"largest memory, {HUGE:.0e} configurations", huge.memory, "MB", f"(wanted: below {WANTED_MEMORY})")


def show_threads(count: int, times: int) -> None:
    """Print what two threads are worth, the start of the command left out."""
    start = statistics.median(command(1, "-j", "1").seconds for _ in range(times))
    one, two = [], []
    for _ in range(times):
        one.append(command(count, "-j", "1"))
        two.append(command(count, "-j", "2"))
    if any(run.result != one[0].result for run in (*one, *two)):
        raise RuntimeError("not the same summary")
    single, double = (statistics.median(run.seconds for run in runs) for runs in (one, two))
    line("one configuration: the start", start, "s")
    line("1 thread", single, "s", f"{count / (single - start) / 1e6:.2f} M/s, its start left out")
    line("2 threads, the same summary to the bit", double, "s", f"{count / (double - start) / 1e6:.2f} M/s")
    note = f"times one; starts left out {(single - start) / (double - start):.2f} (wanted: {WANTED_THREADS})"
    line("ratio", single / double, "", note)


@contextlib.contextmanager
def cluster(workers: int) -> Iterator[str]:
    """Start Dask's scheduler and workers of one thread each on this machine; give its address."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None) as local:
        yield local.scheduler_address


def show_workers(count: int, times: int) -> None:
    """Print what two worker processes are worth."""
    try:
        import distributed  # noqa: F401
    except ImportError:
        print("  Dask is absent: pip install 'kinetostat[dask]'")
        return
    seconds = dict[int, float]()
    starts = dict[int, float]()
    for workers in (1, 2):
        with cluster(workers) as address:
            command(FEW, "--scheduler", address)  # workers have imported and compiled
            starts[workers] = statistics.median(command(1, "--scheduler", address).seconds for _ in range(times))
            runs = [command(count, "--scheduler", address).seconds for _ in range(times)]
            seconds[workers] = statistics.median(runs)
        line(f"{workers} Dask worker{'s' if workers > 1 else ''} of one thread", seconds[workers], "s")
    without = (seconds[1] - starts[1]) / (seconds[2] - starts[2])
    line("ratio", seconds[1] / seconds[2], "", f"times one; starts left out {without:.2f} (wanted: {WANTED_WORKERS})")


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
