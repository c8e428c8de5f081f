"""The batched screw Jacobian against a Pinocchio loop on the same configurations, microseconds per configuration."""

import statistics
import time
from collections.abc import Callable

import numpy as np
import pinocchio as pin

import kinetostat as ks
from kinetostat.engines.screw import ScrewEngine

ROBOT, FRAME = "example:panda", "panda_hand"
SIZES = (1, 100, 100_000)


def microseconds(run: Callable[[], object], count: int) -> float:
    """Return the median time of a configuration over enough repetitions."""
    times = []
    for _ in range(3 if count > 10_000 else 30):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return statistics.median(times) / count * 1e6


def pinocchio_loop(model: object, data: object, frame: int, configurations: np.ndarray) -> np.ndarray:
    """What people write today: one Jacobian after the other."""
    result = np.empty((len(configurations), 6, model.nv))
    for i, q in enumerate(configurations):
        result[i] = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
    return result


def main() -> None:
    """Print a row for each batch size."""
    panda = ks.load(ROBOT)
    screw = ScrewEngine(panda.robot)
    velocity = ks.Velocity(FRAME, panda.robot.root, panda.robot.root)
    model = pin.buildModelFromXML(panda.loaded.text)
    data, frame = model.createData(), model.getFrameId(FRAME)
    print(f"Jacobian of {FRAME} of {ROBOT}, microseconds per configuration (one process)")
    print(f"{'configurations':>14} {'screw, batched':>15} {'Pinocchio loop':>15} {'ratio':>7}")
    for size in SIZES:
        q = ks.random_configurations(panda.robot, 0, (size,))
        full = np.hstack([q, q[:, -1:]])  # Pinocchio has the second finger as a joint of its own
        ours = microseconds(lambda q=q: screw.jacobian(q, velocity), size)
        theirs = microseconds(lambda full=full: pinocchio_loop(model, data, frame, full), size)
        print(f"{size:>14,} {ours:>15.2f} {theirs:>15.2f} {ours / theirs:>7.2f}")
    again = pinocchio_loop(model, data, frame, full[:100])[:, :, :8]
    difference = np.abs(screw.jacobian(q[:100], velocity)[..., :7] - again[..., :7]).max()
    print(f"largest difference on 100 of them: {difference:.1e}")


if __name__ == "__main__":
    main()
