"""Peers as processes: which are there, how those in C++ are built, how they are asked.

They are looked for in this Python and in that of the environment variable SWEEP_PEERS, one that has some of them:
pip install pin cmeel-eigen mujoco dynibo frax. Compiled loops are built against the headers and libraries that the
wheels carry (pin: Pinocchio, Boost; cmeel-eigen: Eigen; mujoco), with g++ -O3 -march=native.
"""

import contextlib
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from machine.building import built
from peers.chains import Measured

HERE = Path(__file__).parent
PYTHONS = tuple(dict.fromkeys([os.environ.get("SWEEP_PEERS") or sys.executable, sys.executable]))
PACKAGES = ("pinocchio", "numpy", "mujoco", "dynibo", "frax", "cmeel")
WHERE = """
import importlib.util, json, sys
found = {}
for name in sys.argv[1:]:
    spec = importlib.util.find_spec(name)
    found[name] = spec and list(spec.submodule_search_locations)[0]
print(json.dumps(found))
"""
# What pinocchio's CMake files ask of those who use its headers.
BOOST = ("LIMIT_LIST_SIZE=30", "LIMIT_VECTOR_SIZE=30", "CFG_NO_PREPROCESSED_HEADERS")
ALONE = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONWARNINGS": "ignore"}


@dataclass(frozen=True)
class Start:
    """How a peer is started on a chain: a command, and what follows it ("urdf", "numbers", "q", "lapack" ...)."""

    command: tuple[str, ...]
    arguments: tuple[str, ...]


class Peer:
    """A process that answers questions."""

    def __init__(self, command: list[str]) -> None:
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ALONE
        )
        self.name, *self.questions = self._line().split("\t")

    def _line(self) -> str:
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError(self.process.stderr.read().strip().splitlines()[-1:] or ["no answer"])
        return line.rstrip("\n")

    def ask(self, what: str, question: str) -> str:
        """Return the answer to "time" or "numbers" of a question."""
        self.process.stdin.write(f"{what} {question}\n")
        self.process.stdin.flush()
        return self._line()

    def time(self, question: str) -> float:
        """Return microseconds per configuration."""
        return float(self.ask("time", question))

    def numbers(self, question: str) -> np.ndarray:
        """Return the numbers of the first configurations."""
        return np.array(self.ask("numbers", question).split(), dtype=np.float64)

    def end(self) -> None:
        """End the process."""
        self.process.stdin.close()
        try:
            self.process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


def places() -> dict[str, tuple[str, Path]]:
    """Return where packages are: {package: (python, folder)}."""
    found = dict[str, tuple[str, Path]]()
    for python in PYTHONS:
        run = subprocess.run([python, "-c", WHERE, *PACKAGES], check=True, capture_output=True, text=True)
        for name, folder in json.loads(run.stdout).items():
            if folder and name not in found:
                found[name] = (python, Path(folder))
    return found


def pinocchio_compiled(there: dict[str, tuple[str, Path]]) -> Start:
    """Return how the loop around Pinocchio in C++ starts.

    Raises:
        FileNotFoundError: no headers.
    """
    _, package = there["pinocchio"]
    include = next((p / "include" for p in package.parents if (p / "include/pinocchio/config.hpp").is_file()), None)
    eigen = [Path("/usr/include/eigen3"), *([include / "eigen3"] if include else [])]
    eigen = [p for p in eigen if (p / "Eigen/Core").is_file()]
    if include is None or not eigen:
        raise FileNotFoundError("headers of Pinocchio and Eigen: pip install pin cmeel-eigen")
    flags = [
        *(f"-DBOOST_MPL_{x}" for x in BOOST),
        "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
        f"-I{include}",
        f"-I{eigen[-1]}",
    ]
    return Start((built(HERE / "pinocchio_loop.cpp", tuple(flags)),), ("numbers", "q", "lapack"))


def mujoco_compiled(there: dict[str, tuple[str, Path]]) -> Start:
    """Return how the loop around MuJoCo in C starts."""
    _, package = there["mujoco"]
    library = next(package.glob("libmujoco.so*"))
    flags = [f"-I{package / 'include'}", str(library), f"-Wl,-rpath,{package}"]
    return Start((built(HERE / "mujoco_loop.cpp", tuple(flags)),), ("urdf", "q", "lapack", "offset"))


def in_python(module: str, script: str, *more: str) -> Callable[[dict[str, tuple[str, Path]]], Start]:
    """Return a function that says how a peer in Python starts."""

    def start(there: dict[str, tuple[str, Path]]) -> Start:
        return Start((there[module][0], str(HERE / script)), ("urdf", "q", *more))

    return start


KINDS = (
    ("Pinocchio in C++", "pinocchio", pinocchio_compiled),
    ("Pinocchio in Python", "pinocchio", in_python("pinocchio", "pinocchio_python.py")),
    ("dynibo", "dynibo", in_python("dynibo", "dynibo_python.py", "short")),
    ("MuJoCo in C", "mujoco", mujoco_compiled),
    ("MuJoCo in Python", "mujoco", in_python("mujoco", "mujoco_python.py", "offset")),
    ("frax", "frax", in_python("frax", "frax_batch.py", "placement")),
)


def starts() -> tuple[dict[str, Start], dict[str, str]]:
    """Return the peers that are there, and why others are not."""
    there, found, absent = places(), dict[str, Start](), dict[str, str]()
    for title, package, start in KINDS:
        try:
            found[title] = start(there)
        except KeyError:
            absent[title] = f"pip install {package}, or SWEEP_PEERS=/path/to/python that has it"
        except subprocess.CalledProcessError as error:
            absent[title] = f"does not build: {error.stderr.strip().splitlines()[:1]}"
        except (OSError, StopIteration) as error:
            absent[title] = str(error) or "its library was not found"
    return found, absent


def lapack(there: dict[str, tuple[str, Path]]) -> Path | None:
    """Return the OpenBLAS that NumPy's wheel brings."""
    return next((there["numpy"][1].parent / "numpy.libs").glob("libscipy_openblas64_*"), None)


@contextlib.contextmanager
def running(found: dict[str, Start], chain: Measured, folder: Path) -> Iterator[tuple[dict[str, Peer], dict[str, str]]]:
    """Start the peers on a chain; give those that started, and why others did not."""
    urdf, short, plain, q = folder / "chain.urdf", folder / "short.urdf", folder / "chain.txt", folder / "q.bin"
    chain.write_urdf(urdf)
    chain.write_urdf(short, 1)
    chain.write_numbers(plain)
    chain.q.tofile(q)
    values = {
        "urdf": [str(urdf)],
        "short": [str(short)],
        "numbers": [str(plain)],
        "q": [str(q)],
        "lapack": [str(lapack(places()))],
        "offset": [repr(float(x)) for x in chain.offset.translation],
        "placement": [",".join(repr(float(x)) for x in chain.offset.homogeneous.ravel())],
    }
    alive, failed = dict[str, Peer](), dict[str, str]()
    try:
        for title, start in found.items():
            try:
                alive[title] = Peer([*start.command, *(x for name in start.arguments for x in values[name])])
            except RuntimeError as error:
                failed[title] = str(error)
        yield alive, failed
    finally:
        for peer in alive.values():
            peer.end()
