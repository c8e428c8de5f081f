"""The loop that people write today: pin.computeFrameJacobian of one configuration after the other.

pinocchio_python.py URDF CONFIGURATIONS
"""

import sys

import numpy as np
import pinocchio as pin
from loop import configurations, serve, with_numpy


def main() -> None:
    """Answer questions."""
    model = pin.buildModelFromUrdf(sys.argv[1])
    data, tool = model.createData(), model.getFrameId("tool")

    def jacobians(q: np.ndarray) -> np.ndarray:
        found = np.empty((len(q), 6, model.nv))
        for i, at in enumerate(q):
            found[i] = pin.computeFrameJacobian(model, data, at, tool, pin.LOCAL_WORLD_ALIGNED)
        return found

    q = configurations(sys.argv[2], model.nv, 4096)
    serve(f"Pinocchio {pin.__version__} (Python)", with_numpy(jacobians, "computeFrameJacobian"), q)


if __name__ == "__main__":
    main()
