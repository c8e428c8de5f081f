"""frax, in JAX, compiled for a batch: jit(vmap(...)), double precision, the settings that its own page recommends.

frax_batch.py URDF CONFIGURATIONS TOOL     (4 x 4 of the tool in the last joint's frame, row by row, with commas)
"""

import os
import sys
import warnings

os.environ["JAX_ENABLE_X64"], os.environ["JAX_PLATFORMS"] = "1", "cpu"
os.environ["XLA_FLAGS"] = (
    "--xla_cpu_multi_thread_eigen=false --xla_cpu_scheduler_type=CPU_SCHEDULER_TYPE_MEMORY_OPTIMIZED"
)
warnings.simplefilter("ignore")

import frax  # noqa: E402
import jax  # noqa: E402
import jax.numpy as jnp  # noqa: E402
import numpy as np  # noqa: E402
from loop import configurations, serve  # noqa: E402


def main() -> None:
    """Answer questions."""
    offset = np.array([float(x) for x in sys.argv[3].split(",")]).reshape(4, 4)
    robot = frax.Manipulator(sys.argv[1], ee_offset=offset)

    def yoshikawa(q: jax.Array) -> jax.Array:
        jacobian = robot.ee_jacobian(q)
        if robot.nv == 6:
            return jnp.abs(jnp.linalg.det(jacobian))
        return jnp.sqrt(jnp.linalg.det(jacobian @ jacobian.T))

    def values(q: jax.Array) -> jax.Array:
        return jnp.linalg.svd(robot.ee_jacobian(q), compute_uv=False)

    functions = {
        "jacobian/jit(vmap)": robot.ee_jacobian,
        "yoshikawa/jit(vmap) det": yoshikawa,
        "singular_values/jit(vmap) svd": values,
    }
    compiled = {name: jax.jit(jax.vmap(function)) for name, function in functions.items()}
    q = configurations(sys.argv[2], robot.nv, 16384)
    for function in compiled.values():
        function(q).block_until_ready()
    questions = {name: lambda q, f=f: f(q).block_until_ready() for name, f in compiled.items()}
    serve(f"frax {frax.__version__ if hasattr(frax, '__version__') else ''} on JAX {jax.__version__}", questions, q)


if __name__ == "__main__":
    main()
