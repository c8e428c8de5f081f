"""What the kernel executes per configuration, against what the core can do at most."""

import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from machine.building import built
from machine.counting import counted
from peers.chains import measured
from sweeping.cases import CHAINS, LARGE, SMALL, kernel_of, microseconds, one_core

MACHINE = Path(__file__).parents[1] / "machine"
COUNTED = 128  # configurations that are walked through, instruction by instruction
LAYERS = (
    ("placement", ("placement",)),
    ("Jacobian", ("jacobian",)),
    ("Yoshikawa", ("yoshikawa",)),
    ("singular values", ("singular_values",)),
)


def show_roofline(quick: bool) -> None:
    """Print flops and bytes per configuration, and the shares of what a core can do."""
    with one_core():
        try:
            run = subprocess.run([built(MACHINE / "peak.cpp")], check=True, capture_output=True, text=True)
        except (OSError, subprocess.CalledProcessError) as error:
            print(f"no roofline: {error}")
            return
        peak, bandwidth = map(float, run.stdout.split())
        print(f"\nthis core at most: {peak:.0f} Gflop/s, {bandwidth:.0f} GB/s written to memory")
        print("per configuration: flops executed, divisions and roots among them, share in vectors of 8, instr.;")
        print(f"us and share of the flops in batches of {SMALL}; bytes in and out, us, of memory in those of {LARGE}")
        head = ("", "us", "flops", "slow", "vectors", "instr.", "of peak", "bytes", "us", "of mem.")
        print("  {:<17}{:>7}{:>7}{:>6}{:>8}{:>8}{:>8}{:>7}{:>8}{:>8}".format(*head))
        for chain in CHAINS[:1] if quick else CHAINS:
            show_chain(chain, peak, bandwidth)


def sines(joints: int) -> float:
    """Return the microseconds that sines and cosines of a configuration take."""
    from numba import njit

    from kinetostat.screw.compiled.compiling import LANES
    from kinetostat.screw.compiled.lanes import FRAME, sine_and_cosine

    @njit
    def often(frame: np.ndarray, times: int) -> None:
        for _ in range(times):
            sine_and_cosine(frame)

    frame, times = np.ones(FRAME), 100_000
    often(frame, 1)
    start = time.process_time()
    often(frame, times)
    return 1e6 * (time.process_time() - start) / times / LANES * joints


def show_chain(which: tuple[str, str, str], peak: float, bandwidth: float) -> None:
    """Print the lines of a chain."""
    title, source, frame = which
    chain = measured(title, source, frame, LARGE)
    joints = len(chain.coordinates.names)
    print(f"  {title}; of each, {joints} sines and cosines {sines(joints):.3f} us")
    for name, outputs in LAYERS:
        kernel = kernel_of(chain, outputs)
        size = (chain.q.nbytes + sum(array.nbytes for array in kernel(chain.q).values())) / LARGE
        us, far = (statistics.median(microseconds(kernel, chain.q, b) for _ in range(15)) for b in (SMALL, LARGE))
        command = [sys.executable, str(MACHINE / "counted.py"), source, frame, str(COUNTED), ",".join(outputs)]
        try:
            count = counted(command)
        except (OSError, subprocess.CalledProcessError) as error:
            print(f"    {name:<15}{us:>7.3f}  not counted: {error}")
            continue
        flops, slow, instructions = (x / COUNTED for x in (count.flops, count.slow, count.instructions))
        vectors, share = 100 * count.packed / max(count.flops, 1), 100 * flops / us / 1e3 / peak
        print(
            f"    {name:<15}{us:>7.3f}{flops:>7.0f}{slow:>6.0f}{vectors:>6.0f} %{instructions:>8.0f}"
            f"{share:>6.0f} %{size:>7.0f}{far:>8.3f}{100 * size / far / 1e3 / bandwidth:>6.0f} %",
            flush=True,
        )
