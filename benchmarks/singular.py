"""The batched search for singular configurations against SciPy's minimisers, from the same random starts.

Each peer minimises what people minimise, sigma_min or det(J J^T), with the exact gradient; success is sigma_min < 1e-9,
computed afterwards with Pinocchio's Jacobian. Milliseconds are per start, in one process.
"""

import time
from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize

import kinetostat as ks
from kinetostat.analysis.configuration import neutral
from kinetostat.analysis.singular.mechanism import Mechanism, mechanism
from kinetostat.analysis.singular.search import converge

ARMS = (
    ("textbook:puma560", "tool"),
    ("example:ur5_robot", "tool0"),
    ("example:kinova", "j2s6s200_end_effector"),
    ("example:panda", "panda_hand"),
)
STARTS, PEER_STARTS = 1000, 60
SUCCESS = 1e-9


def smallest_by_pinocchio(arm: Mechanism, q: np.ndarray) -> np.ndarray:
    """Return sigma_min of Pinocchio's Jacobian, length-scaled, at coordinates (N, n)."""
    robot = arm.model.robot
    whole = arm.configuration(q, neutral(robot))
    columns = robot.velocity_columns(arm.joints)
    matrix = arm.scaled(arm.model.engine.jacobian(whole, arm.velocity)[..., columns])
    return np.linalg.svd(matrix, compute_uv=False)[:, arm.generic_rank - 1]


def sigma_and_gradient(arm: Mechanism, q: np.ndarray) -> tuple[float, np.ndarray]:
    """Return sigma_min and its gradient u^T dJ v."""
    matrix, along = arm.derivatives(q)
    left, values, right = np.linalg.svd(matrix)
    at = arm.generic_rank - 1
    return values[at], np.einsum("r,rij,i->j", left[:, at], along, right[at])


def determinant_and_gradient(arm: Mechanism, q: np.ndarray) -> tuple[float, np.ndarray]:
    """Return det(J J^T) and its gradient by cofactors, from singular values."""
    matrix, along = arm.derivatives(q)
    left, values, right = np.linalg.svd(matrix, full_matrices=False)
    slopes = np.einsum("rk,rij,ki->kj", left, along, right)
    others = np.array([np.prod(np.delete(values, k)) for k in range(len(values))])
    volume = float(np.prod(values))
    return volume**2, 2 * volume * (others @ slopes)


def by_scipy(arm: Mechanism, starts: np.ndarray, function: Callable[..., tuple[float, np.ndarray]]) -> np.ndarray:
    """Return where BFGS ends from each start."""
    return np.array([minimize(lambda q: function(arm, q), q0, jac=True, method="BFGS").x for q0 in starts])


def row(name: str, ends: np.ndarray, arm: Mechanism, seconds: float) -> str:
    """Return a line of the table."""
    share = np.mean(smallest_by_pinocchio(arm, ends) < SUCCESS)
    return f"  {name:<42} {100 * share:>6.1f} % {1e3 * seconds / len(ends):>9.3f} ms"


def main() -> None:
    """Print a block for each arm."""
    print(f"{'search from random starts':<44} {'success':>8} {'per start':>12}")
    for source, frame in ARMS:
        arm = mechanism(ks.load(source), frame)
        starts = arm.draw(np.random.default_rng(0), (STARTS,))
        print(f"{source}, {len(arm.names)} joints")
        begun = time.perf_counter()
        ends, _ = converge(arm, starts)
        print(row(f"reciprocal system, batched ({STARTS} starts)", ends, arm, time.perf_counter() - begun))
        for name, function in (("sigma_min", sigma_and_gradient), ("det(J J^T)", determinant_and_gradient)):
            begun = time.perf_counter()
            ends = by_scipy(arm, starts[:PEER_STARTS], function)
            print(row(f"SciPy BFGS on {name} ({PEER_STARTS} starts)", ends, arm, time.perf_counter() - begun))


if __name__ == "__main__":
    main()
