"""Gravity torques over lists of configurations against a plain Pinocchio loop, microseconds per configuration.

The command is the whole of it: start, read, two engines, write; its ratio is to a whole process that reads the same
list, loops, and writes the torques by Python's own csv. All rows of a table are measured in one run.
"""

import csv
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pinocchio as pin

import kinetostat as ks

ROBOT = "example:panda"
SIZES = (1, 100, 100_000)
SCRIPT = """
import csv, sys
import numpy as np
import pinocchio as pin
model = pin.buildModelFromUrdf(sys.argv[1])
data = model.createData()
with open(sys.argv[2], newline="") as file, open(sys.argv[3], "w", newline="") as out:
    rows, write = csv.reader(file), csv.writer(out)
    write.writerow(next(rows)[:-1])
    for row in rows:
        q = np.array([float(x) for x in row])
        write.writerow(pin.computeGeneralizedGravity(model, data, np.append(q, q[-1])).tolist())
"""


def microseconds(run: Callable[[], object], count: int) -> float:
    """Return the median time of a configuration over enough repetitions."""
    times = []
    for _ in range(3 if count > 10_000 else 9):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return statistics.median(times) / count * 1e6


def pinocchio_loop(model: object, data: object, configurations: np.ndarray) -> np.ndarray:
    """What people write today: one configuration after the other."""
    result = np.empty((len(configurations), model.nv))
    for i, q in enumerate(configurations):
        result[i] = pin.computeGeneralizedGravity(model, data, q)
    return result


def write_list(path: Path, panda: ks.Model, q: np.ndarray) -> None:
    """Write configurations as CSV, joints named."""
    with path.open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(joint.name for joint in panda.robot.independent)
        table.writerows(q.tolist())


def main() -> None:
    """Print a row for each length of list."""
    panda, alone = ks.load(ROBOT), ks.load(ROBOT, crosscheck=False)
    model = pin.buildModelFromUrdf(str(panda.loaded.source.path))
    data = model.createData()
    print(f"gravity torques of {ROBOT}, microseconds per configuration (ratio to the loop, or to the script)")
    print(f"{'':>14} {'Pinocchio':>11} {'torque,':>20} {'torque,':>20} {'script,':>12} {'torque --qs,':>20}")
    titles = ("configurations", "loop", "cross-checked", "alone", "process", "process")
    print("{:>14} {:>11} {:>20} {:>20} {:>12} {:>20}".format(*titles))
    with tempfile.TemporaryDirectory() as folder:
        path, out = Path(folder) / "list.csv", Path(folder) / "out.csv"
        command = [str(Path(sys.executable).with_name("kinetostat")), "torque", ROBOT, "--gravity", "--qs", str(path)]
        script = [sys.executable, "-c", SCRIPT, str(panda.loaded.source.path), str(path), str(out)]
        for size in SIZES:
            q = ks.random_configurations(panda, 0, (size,))
            full = np.hstack([q, q[:, -1:]])  # Pinocchio has the second finger as a joint of its own
            write_list(path, panda, q)
            loop = microseconds(lambda full=full: pinocchio_loop(model, data, full), size)
            checked = microseconds(lambda q=q: ks.torque(panda, q, gravity=True), size)
            single = microseconds(lambda q=q: ks.torque(alone, q, gravity=True), size)
            bare = microseconds(lambda: subprocess.run(script, check=True, capture_output=True), size)
            whole = microseconds(
                lambda: subprocess.run([*command, "-o", str(out)], check=True, capture_output=True), size
            )
            cells = [f"{mine:.2f} ({mine / base:.2f})" for mine, base in ((checked, loop), (single, loop))]
            last = f"{whole:.2f} ({whole / bare:.2f})"
            print(f"{size:>14,} {loop:>11.2f} {cells[0]:>20} {cells[1]:>20} {bare:>12.2f} {last:>20}", flush=True)
    ours = ks.torque(panda, q[:100], gravity=True).gravity
    theirs = pinocchio_loop(model, data, full[:100])
    theirs = np.hstack([theirs[:, :-2], theirs[:, -2:].sum(axis=1, keepdims=True)])
    print(f"largest difference on 100 of them: {np.abs(ours - theirs).max():.1e} Nm or N")


if __name__ == "__main__":
    main()
