"""A kernel between two stops, for `counting`: robot, frame, number of configurations, outputs.

counted.py example:ur5_robot tool0 512 jacobian,yoshikawa
"""

import os
import signal
import sys

import numpy as np

import kinetostat as ks
from kinetostat.analysis.coordinates import coordinates
from kinetostat.analysis.kernels import chain_kernel


def main() -> None:
    """Run the kernel once to have it compiled, then once between stops."""
    source, frame, count, outputs = sys.argv[1:]
    model = ks.load(source, crosscheck=False)
    chain = coordinates(model, frame, model.robot.root)
    kernel = chain_kernel(chain, outputs.split(","), np.zeros(model.robot.nq))
    q = chain.draw(np.random.default_rng(0), (int(count),), limited=True)
    kernel(q)
    os.kill(os.getpid(), signal.SIGSTOP)
    kernel(q)
    os.kill(os.getpid(), signal.SIGSTOP)


if __name__ == "__main__":
    main()
