"""`check` against simcheck (PyPI, static checks only) on the same files: all of example-robot-data, and the median one.

simcheck reads meshes and compares inertias with them; `check` reads their headers only, and does what simcheck does
not: three readers on all frames, kinetostatic rules. So the ratio is of two gates, not of the same work. Then one robot
against the bare import of Pinocchio and yourdfpy, which is what a script that compares readers has to wait for.

simcheck is looked for beside this Python, else in the environment variable SIMCHECK.
"""

import os
import shutil
import statistics
import subprocess
import sys
import time
from pathlib import Path

from kinetostat.urdf.files import example_robots

OURS = str(Path(sys.executable).with_name("kinetostat"))
SIMCHECK = os.environ.get("SIMCHECK") or shutil.which("simcheck", path=str(Path(sys.executable).parent))
MISSING = "not installed: pip install simcheck, or SIMCHECK=/path/to/simcheck"
RUNS = 9
IMPORTS = [sys.executable, "-c", "import pinocchio, yourdfpy"]


def seconds(command: list[str]) -> float:
    """Return the wall time of a command, whatever its verdict."""
    start = time.perf_counter()
    subprocess.run(command, check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return time.perf_counter() - start


def theirs(paths: list[Path]) -> list[str]:
    """Return simcheck's command line."""
    return [str(SIMCHECK), "check", "--static-only", "--no-cache", "--no-config", "-j", "2", *map(str, paths)]


def ours(paths: list[Path]) -> list[str]:
    """Return our command line."""
    return [OURS, "check", "--no-settings", "-j", "2", *map(str, paths)]


def line(what: str, value: float, unit: str, note: str = "") -> None:
    """Print a row of the table."""
    print(f"{what:<52} {value:8.2f} {unit:<2} {note}")


def main() -> None:
    """Print the table."""
    root = Path(__file__).parents[1]
    subprocess.run([sys.executable, "-m", "compileall", "-q", str(root / "src"), str(root / "cli")], check=True)
    robots = list(example_robots().values())
    seconds(ours(robots[:1]))
    everything = min(seconds(ours(robots)) for _ in range(2))
    line(f"kinetostat check -j 2, {len(robots)} robots", everything, "s")
    # The median robot: the one whose check takes the median time.
    alone = sorted((seconds(ours([path])), path) for path in robots)
    median = alone[len(alone) // 2][1]
    pairs = [(seconds(ours([median])), seconds(IMPORTS)) for _ in range(RUNS)]
    one = statistics.median(a for a, _ in pairs)
    line(f"kinetostat check {median.stem} (the median robot)", one, "s")
    line("python -c 'import pinocchio, yourdfpy'", statistics.median(b for _, b in pairs), "s")
    line("ratio", statistics.median(a / b for a, b in pairs), "", "(wanted: below 2.5)")
    if SIMCHECK is None:
        print(f"simcheck: {MISSING}")
        return
    peer_one = statistics.median(seconds(theirs([median])) for _ in range(RUNS))
    line(f"simcheck --static-only {median.stem}", peer_one, "s", f"{peer_one / one:.1f} times ours (wanted: 10)")
    peer_all = seconds(theirs(robots))
    note = f"{peer_all / everything:.1f} times ours (wanted: 10)"
    line(f"simcheck --static-only -j 2, {len(robots)} robots", peer_all, "s", note)


if __name__ == "__main__":
    main()
