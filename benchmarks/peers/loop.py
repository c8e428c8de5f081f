"""What the peers in Python share: questions and answers over pipes, as in `loop.hpp`; NumPy for what follows J.

A peer computes the Jacobians of all configurations; Yoshikawa's index and singular values are then NumPy's, of all of
them in one call, which is the fastest that a user of that library has.
"""

import sys
import time
from collections.abc import Callable, Mapping

import numpy as np

CHECKED = 256  # how many configurations' numbers are shown
Answer = Callable[[np.ndarray], np.ndarray]  # configurations (m, n) -> (m, ...)


def configurations(path: str, n: int, count: int | None = None) -> np.ndarray:
    """Return the configurations of a file of float64, (m, n)."""
    return np.fromfile(path).reshape(-1, n)[:count].copy()


def yoshikawa_by_det(jacobians: np.ndarray) -> np.ndarray:
    """Return |det J| of square Jacobians, sqrt(det(J J^T)) of others. (m, 6, n) -> (m,)."""
    if jacobians.shape[-1] == jacobians.shape[-2]:
        return np.abs(np.linalg.det(jacobians))
    return np.sqrt(np.linalg.det(jacobians @ np.swapaxes(jacobians, -1, -2)))


def with_numpy(jacobians: Answer, name: str) -> dict[str, Answer]:
    """Return the questions that follow from Jacobians."""
    return {
        f"jacobian/{name}": jacobians,
        "yoshikawa/numpy svd": lambda q: np.prod(np.linalg.svd(jacobians(q), compute_uv=False), axis=-1),
        "yoshikawa/numpy det": lambda q: yoshikawa_by_det(jacobians(q)),
        "singular_values/numpy svd": lambda q: np.linalg.svd(jacobians(q), compute_uv=False),
    }


def serve(name: str, questions: Mapping[str, Answer], q: np.ndarray) -> None:
    """Print the name and the questions, then an answer for each line that is read."""
    print(name, *questions, sep="\t", flush=True)
    for line in sys.stdin:
        what, question = line.rstrip("\n").split(" ", 1)
        answer = questions[question]
        if what == "numbers":
            print(*(float(x) for x in np.asarray(answer(q[:CHECKED])).ravel()), flush=True)
        else:
            start = time.process_time()
            answer(q)
            print(1e6 * (time.process_time() - start) / len(q), flush=True)
