"""MuJoCo through its Python binding: mj_kinematics, mj_comPos, mj_jac of one configuration after the other.

mujoco_python.py URDF CONFIGURATIONS x y z     (the tool in the last body's axes)
"""

import sys

import mujoco
import numpy as np
from loop import configurations, serve, with_numpy


def main() -> None:
    """Answer questions."""
    model = mujoco.MjModel.from_xml_path(sys.argv[1])
    data, body, offset = mujoco.MjData(model), model.nbody - 1, np.array([float(x) for x in sys.argv[3:6]])

    def jacobians(q: np.ndarray) -> np.ndarray:
        found = np.empty((len(q), 6, model.nv))
        for at, out in zip(q, found, strict=True):
            data.qpos[:] = at
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            point = data.xpos[body] + data.xmat[body].reshape(3, 3) @ offset
            mujoco.mj_jac(model, data, out[:3], out[3:], point, body)
        return found

    q = configurations(sys.argv[2], model.nv, 4096)
    serve(f"MuJoCo {mujoco.__version__} (Python)", with_numpy(jacobians, "mj_jac"), q)


if __name__ == "__main__":
    main()
