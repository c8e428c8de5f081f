"""How long a query takes, cross-check included, against a bare script that asks Pinocchio for the same matrix.

Both are whole processes on warm files, run in turn, so that a busy machine slows both. The ratio is what counts.
"""

import statistics
import subprocess
import sys
import time
from pathlib import Path

from kinetostat.urdf.files import example_robots

RUNS = 31
PANDA = example_robots()["panda_description/panda"]
BARE = f"""
import numpy as np
import pinocchio as pin
model = pin.buildModelFromUrdf({str(PANDA)!r})
data = model.createData()
frame = model.getFrameId("panda_hand")
print(pin.computeFrameJacobian(model, data, pin.neutral(model), frame, pin.LOCAL_WORLD_ALIGNED))
"""


def seconds(command: list[str]) -> float:
    """Return the wall time of one run."""
    start = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return time.perf_counter() - start


def main() -> None:
    """Time both in turn and print medians and their ratio."""
    root = Path(__file__).parents[1]
    # As an installed package is: compiled. Otherwise the first runs would measure Python's compiler.
    subprocess.run([sys.executable, "-m", "compileall", "-q", str(root / "src"), str(root / "cli")], check=True)
    ours = [str(Path(sys.executable).with_name("kinetostat")), "jacobian", "example:panda", "-f", "panda_hand"]
    bare = [sys.executable, "-c", BARE]
    seconds(ours), seconds(bare)
    pairs = [(seconds(ours), seconds(bare)) for _ in range(RUNS)]
    ours_median, bare_median = (statistics.median(column) * 1e3 for column in zip(*pairs, strict=True))
    ratio = statistics.median(a / b for a, b in pairs)
    print(f"kinetostat jacobian example:panda -f panda_hand   {ours_median:6.1f} ms (median of {RUNS}, cross-checked)")
    print(f"bare Pinocchio script, same file and matrix       {bare_median:6.1f} ms")
    print(f"ratio                                             {ratio:6.2f}    (wanted: at most 1.5)")


if __name__ == "__main__":
    main()
