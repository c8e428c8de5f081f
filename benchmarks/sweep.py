"""The sweep kernel against peers and against the machine: microseconds per configuration, medians of one run.

    sweep.py [--quick] [peers] [roofline] [scaling] [start]      all sections, where none is named

Peers, where they are there (peers/starting.py says how): Pinocchio in C++ and in Python, dynibo, MuJoCo in C and in
Python, frax; each a process of its own on the same core, asked in turn with us, round after round, after their numbers
were compared with ours. They get the chain alone; compiled loops keep one Jacobian, in the cache. Ours are of the real
path, `Kernel.__call__` on batches, which copies its input and writes what it is asked for to memory. Times on one core
are the processor's, so that what else the machine does is not counted; those of whole commands are on the clock.
"""

import argparse
import os
import platform
from importlib.metadata import version
from pathlib import Path

import numpy as np

from sweeping.against import show_peers
from sweeping.roofline import show_roofline
from sweeping.scaling import show_scaling, show_start

SECTIONS = {"peers": show_peers, "roofline": show_roofline, "scaling": show_scaling, "start": show_start}
KEYS = ("model name", "cpu family", "model")


def processor() -> str:
    """Return what the processor is."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.is_file() else []
    fields = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines)}
    return ", ".join(
        f"{fields[key]}" if key == "model name" else f"{key} {fields[key]}" for key in KEYS if key in fields
    )


def main() -> None:
    """Print the sections that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sections", nargs="*", metavar="section", help=", ".join(SECTIONS))
    parser.add_argument(
        "--quick", action="store_true", help="one robot, fewer repetitions, no Dask, nothing compiled anew"
    )
    given = parser.parse_args()
    unknown = set(given.sections) - set(SECTIONS)
    if unknown:
        parser.error(f"no section {', '.join(sorted(unknown))}: {', '.join(SECTIONS)}")
    print(f"{processor() or platform.machine()}, {os.cpu_count()} cores; Python {platform.python_version()}")
    print(f"NumPy {np.__version__}, Numba {version('numba')}, Pinocchio {version('pin')}")
    asked = given.sections or [name for name in SECTIONS if not (given.quick and name == "start")]
    for name in asked:
        SECTIONS[name](given.quick)


if __name__ == "__main__":
    main()
