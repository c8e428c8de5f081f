"""dynibo, written in Rust, through its own Python binding: Robot.jacobian into rows of an array.

    dynibo_python.py URDF CONFIGURATIONS SHORT

SHORT is a chain of one joint: what a call on it costs is mostly the binding, and is printed apart.
"""

import sys

import dynibo
import numpy as np
from loop import configurations, serve, with_numpy


def jacobians_of(path: str) -> tuple[int, object]:
    """Return the number of joints and the function from configurations (m, n) to Jacobians, linear rows first."""
    robot = dynibo.Robot.from_urdf(path)
    tool, n = robot.link_id("tool"), robot.joint_count

    def jacobians(q: np.ndarray) -> np.ndarray:
        found = np.empty((len(q), n, 6))  # column-major 6 x n, angular rows first
        compute = robot.jacobian
        for at, out in zip(q, found.reshape(len(q), 6 * n), strict=True):
            compute(at, tool, out=out)
        return np.roll(np.swapaxes(found, 1, 2), 3, axis=1)

    return n, jacobians


def main() -> None:
    """Answer questions."""
    n, jacobians = jacobians_of(sys.argv[1])
    one, short = jacobians_of(sys.argv[3])
    q = configurations(sys.argv[2], n, 8192)
    questions = with_numpy(jacobians, "Robot.jacobian")
    questions["call/Robot.jacobian of one joint"] = lambda q: short(np.ascontiguousarray(q[:, :one]))
    serve(f"dynibo {dynibo.__version__} (Rust, from Python)", questions, q)


if __name__ == "__main__":
    main()
