"""`make agreement`: do the readers agree on every robot of example-robot-data? A table, a line for each robot.

Every frame, 20 configurations: both engines on placements, Jacobians in the three references, masses and torques;
yourdfpy on placements; differences of placements and energies as witnesses. Exit 1 if any robot disagrees.
"""

import statistics
import sys
import time

from rich.progress import track

import kinetostat as ks
from kinetostat.analysis.agreement import Agreement, agreement
from kinetostat.conventions import tolerance
from kinetostat.engines.third import ThirdReader
from kinetostat.urdf.files import example_robots, short_names

SAMPLES = 20


def line(name: str) -> tuple[str, bool, float]:
    """Return the line of one robot, whether it is fine (agrees, or is refused with a reason), and the seconds."""
    try:
        model = ks.load(f"example:{name}")
        _ = model.engine, model.witness
        start = time.perf_counter()
        found = agreement(model, samples=SAMPLES)
        seconds = time.perf_counter() - start
    except ks.RobotError as error:
        return f"{name:<44} refused: {error.message}", True, 0.0
    strict = tolerance(model.robot.reach)
    fine = found.agree and found.max_difference <= strict
    sizes = (
        f"{found.frames:>5} {model.robot.nv:>4} {model.robot.reach:>7.3f} {found.max_difference:>9.1e} {strict:>9.1e}"
    )
    readers = f"{len(found.readers)} readers {1e3 * seconds:>4.0f} ms"
    return f"{name:<44}{sizes}  {readers}  {_verdict(found, fine)}", fine, seconds


def _verdict(found: Agreement, fine: bool) -> str:
    worst = "; ".join(f"{one.quantity}: {one.odd_one or '?'} by {one.size:.1e}" for one in found.disagreements)
    return "agree" if fine else f"DISAGREE {worst}"


def main() -> int:
    """Print the table; return the exit code."""
    panda = ks.load("example:panda")
    ThirdReader(panda.loaded.source.data, panda.robot)  # its import takes half a second
    start = time.perf_counter()
    names = short_names(example_robots())
    results = [line(name) for name in track(names, "comparing the readers", transient=True)]
    print(f"{'robot (example:NAME)':<44}frames  dof reach/m   largest tolerance")
    print("\n".join(text for text, _, _ in results))
    fine = sum(good for _, good, _ in results)
    median = statistics.median(seconds for _, _, seconds in results if seconds)
    print(f"{fine} of {len(results)} robots: the readers agree, or the file is refused with its reason")
    print(
        f"{SAMPLES} configurations, 3 references, every frame; median robot {1e3 * median:.0f} ms,"
        f" all {time.perf_counter() - start:.0f} s"
    )
    return 0 if fine == len(results) else 1


if __name__ == "__main__":
    sys.exit(main())
