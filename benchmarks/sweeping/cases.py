"""The robots whose chains are measured, and how our kernel is timed on them."""

import contextlib
import os
import time
from collections.abc import Iterator

import numpy as np

from kinetostat.analysis.kernels import chain_kernel
from kinetostat.screw.kernel import Kernel
from peers.chains import Measured

CHAINS = (
    ("UR5, tool0", "example:ur5_robot", "tool0"),
    ("Panda, panda_hand", "example:panda", "panda_hand"),
    ("TALOS, torso and left arm", "example:talos_reduced", "gripper_left_base_link"),
)
SMALL, LARGE = 2**12, 2**15  # what a batch gives stays in the caches of most processors, and does not


@contextlib.contextmanager
def one_core() -> Iterator[None]:
    """Keep this process, and those that it starts, on one core."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    all_of_them = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(all_of_them)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, all_of_them)


def kernel_of(chain: Measured, outputs: tuple[str, ...]) -> Kernel:
    """Return the kernel of a chain, other joints at zero."""
    return chain_kernel(chain.coordinates, outputs, np.zeros(chain.coordinates.model.robot.nq))


def microseconds(kernel: Kernel, q: np.ndarray, batch: int) -> float:
    """Return the processor's time for a configuration, in batches."""
    start = time.process_time()
    for first in range(0, len(q), batch):
        kernel(q[first : first + batch])
    return 1e6 * (time.process_time() - start) / len(q)
