"""`make agreement`: do the engines agree on every robot of example-robot-data? A table, a line for each robot.

Every frame, 20 random configurations inside limits, the three references. Exit 1 if any robot disagrees.
"""

import sys
import time

import numpy as np
from rich.progress import track

import kinetostat as ks
from kinetostat.analysis.crosscheck import length_scale
from kinetostat.conventions import tolerance
from kinetostat.urdf.files import example_robots, short_names

SAMPLES = 20


def largest_difference(model: ks.Model, q: np.ndarray) -> float:
    """Return the largest difference of any Jacobian or placement between the engines."""
    root, worst = model.robot.root, 0.0
    for link in model.robot.links:
        pairs = [(model.engine.placement(q, link.name, root), model.witness.placement(q, link.name, root))]
        for reference in ks.Reference:
            velocity = ks.Velocity.by_reference(reference, link.name, root)
            pairs.append((model.engine.jacobian(q, velocity), model.witness.jacobian(q, velocity)))
        worst = max(worst, *(float(np.max(np.abs(a - b), initial=0.0)) for a, b in pairs))
    return worst


def line(name: str) -> tuple[str, bool]:
    """Return the line of one robot, and whether it is fine: agrees, or is refused with a reason."""
    try:
        model = ks.load(f"example:{name}")
        q = ks.random_configurations(model.robot, 0, (SAMPLES,))
        worst, allowed = largest_difference(model, q), tolerance(length_scale(model.robot, q))
    except ks.RobotError as error:
        return f"{name:<44} refused: {error.message}", True
    strict = tolerance(model.robot.reach)
    verdict = "agree" if worst <= min(allowed, strict) else "DISAGREE"
    numbers = f"{len(model.robot.links):>5} {model.robot.nv:>4} {model.robot.reach:>7.3f} {worst:>9.1e} {strict:>9.1e}"
    return f"{name:<44}{numbers}  {verdict}", verdict == "agree"


def main() -> int:
    """Print the table; return the exit code."""
    start = time.perf_counter()
    names = short_names(example_robots())
    results = [line(name) for name in track(names, "comparing the engines", transient=True)]
    print(f"{'robot (example:NAME)':<44}frames  dof reach/m   largest tolerance")
    print("\n".join(text for text, _ in results))
    fine = sum(good for _, good in results)
    print(f"{fine} of {len(results)} robots: the engines agree, or the file is refused with its reason")
    print(f"{SAMPLES} configurations, 3 references, every frame; {time.perf_counter() - start:.0f} s")
    return 0 if fine == len(results) else 1


if __name__ == "__main__":
    sys.exit(main())
