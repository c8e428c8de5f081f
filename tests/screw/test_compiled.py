"""Accuracy of the compiled parts, one by one, and where compiled code is kept."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from kinetostat.errors import UsageError
from kinetostat.screw.chain import Chain
from kinetostat.screw.compiled.compiling import LANES
from kinetostat.screw.compiled.lanes import FRAME, sine_and_cosine
from kinetostat.screw.compiled.singular_values import orthogonalise, set_transposed
from kinetostat.screw.compiled.triangle import to_triangle, volume
from kinetostat.screw.kernel import Kernel

SIX = (0,) * 6


def _sine_and_cosine(angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    found = []
    for start in range(0, len(angles), LANES):
        frame = np.zeros(FRAME)
        frame[12 * LANES : 13 * LANES] = np.resize(angles[start : start + LANES], LANES)
        sine_and_cosine(frame)
        found.append(frame.reshape(-1, LANES)[13:15])
    both = np.concatenate(found, axis=1)[:, : len(angles)]
    return both[0], both[1]


def _angles() -> np.ndarray:
    random = np.random.default_rng(0)
    quarters = np.arange(-4000, 4000) * (np.pi / 4)
    return np.concatenate(
        [
            random.uniform(-7, 7, 200_000),
            random.uniform(-1e6, 1e6, 200_000),
            random.choice([-1, 1], 10_000) * np.exp(random.uniform(-200, 13, 10_000)),
            *(np.nextafter(quarters, side) for side in (-np.inf, np.inf)),
            quarters,
            [0.0, 1e6, -1e6],
        ]
    )


def test_sine_and_cosine_are_within_a_unit_of_the_last_place_of_one() -> None:
    """Against the extended precision of the C library, 64 bits of mantissa where the processor has them."""
    angles = _angles()
    wide = angles.astype(np.longdouble)
    sine, cosine = _sine_and_cosine(angles)
    assert float(np.max(np.abs(sine - np.sin(wide)))) < 2.3e-16
    assert float(np.max(np.abs(cosine - np.cos(wide)))) < 2.3e-16


def test_sine_of_small_angles_keeps_all_digits() -> None:
    angles = np.exp(np.random.default_rng(1).uniform(-600, -1, 10_000))
    sine, _ = _sine_and_cosine(angles)
    assert float(np.max(np.abs(sine / np.sin(angles.astype(np.longdouble)) - 1))) < 3e-16


def test_sine_and_cosine_of_no_number_are_none() -> None:
    sine, cosine = _sine_and_cosine(np.array([np.nan, np.inf, -np.inf]))
    assert np.all(np.isnan([sine, cosine]))


def _singular_values(matrices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return singular values and their product of matrices (LANES, p, 6), p >= 6."""
    flat = np.ascontiguousarray(np.moveaxis(matrices, 0, -1)).reshape(-1)
    length, product = matrices.shape[1], np.empty(LANES)
    to_triangle(flat, length, np.empty(6 * LANES), np.empty(length * LANES), SIX)
    volume(flat, product, SIX)
    columns = np.empty(42 * LANES)
    set_transposed(flat, columns, SIX)
    orthogonalise(columns, np.empty(3 * LANES), SIX)
    return columns.reshape(6, 7, LANES)[:, 6].T, product


def _with_values(values: np.ndarray, length: int, seed: int) -> np.ndarray:
    """Return matrices (LANES, length, 6) of given singular values (LANES, 6), in random directions."""
    random = np.random.default_rng(seed)
    left = np.linalg.qr(random.normal(size=(LANES, length, 6)))[0]
    right = np.linalg.qr(random.normal(size=(LANES, 6, 6)))[0]
    return (left * values[:, None, :]) @ right


@pytest.mark.parametrize("length", [6, 7, 30])
@pytest.mark.parametrize("spread", [0, 1, 3, 8, 14, 40])
def test_singular_values_are_within_2e_14_of_the_largest(length: int, spread: float) -> None:
    """Of matrices whose values spread over so many powers of ten, small values as well as large ones."""
    random = np.random.default_rng(length)
    values = -np.sort(-(10.0 ** random.uniform(-spread, 0, (LANES, 6))), axis=1)
    values[:, 0] = 1.0
    for size in (1.0, 1e-30, 1e30):
        found, product = _singular_values(size * _with_values(values, length, 1))
        assert np.max(np.abs(found - size * values)) < 2e-14 * size
        assert np.max(np.diff(found, axis=1)) < 1e-15 * size  # in order, but for rounding
        if spread <= 3:
            np.testing.assert_allclose(product, np.prod(size * values, axis=1), rtol=1e-10)


@pytest.mark.parametrize("width", [1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-12, 1e-15])
@pytest.mark.parametrize("cluster", [2, 3, 6])
def test_clusters_of_singular_values_are_told_apart(width: float, cluster: int) -> None:
    """Values that lie closer together than cosines that look orthogonal: near-isotropic arms, gantries a bit askew."""
    random = np.random.default_rng(cluster)
    values = np.tile([3.0, 2.0, 1.5, 0.5, 0.2, 0.1], (LANES, 1))
    values[:, :cluster] = 1.0 + width * random.uniform(-1, 1, (LANES, cluster))
    for matrices in (_with_values(values, 7, 2), np.eye(6) + width * random.normal(size=(LANES, 6, 6))):
        found, _ = _singular_values(matrices)
        expected = np.linalg.svd(matrices, compute_uv=False)
        assert np.max(np.abs(-np.sort(-found, axis=1) - expected)) < 2e-14 * np.max(expected)
        assert np.max(np.diff(found, axis=1)) < 1e-14


def test_small_singular_values_of_graded_rows_keep_their_digits() -> None:
    """Where rows are as small as the values, J J^T would lose them all: s_6 of 1e-20 has its digits here."""
    random = np.random.default_rng(3)
    grades = np.diag(10.0 ** -np.array([0, 4, 8, 12, 16, 20.0]))
    right = np.linalg.qr(random.normal(size=(LANES, 6, 6)))[0]
    found, _ = _singular_values(np.swapaxes(grades @ right, -1, -2))
    np.testing.assert_allclose(found, np.tile(np.diag(grades), (LANES, 1)), rtol=1e-12)


def test_matrices_without_rank_and_with_equal_columns() -> None:
    matrices = np.zeros((LANES, 8, 6))
    matrices[1, :6] = np.eye(6)
    matrices[2] = 1.0
    matrices[3, :, :3] = np.random.default_rng(0).normal(size=(8, 3))
    matrices[4, 0, 0] = 5.0
    found, _ = _singular_values(matrices)
    np.testing.assert_array_equal(found[0], np.zeros(6))
    np.testing.assert_array_equal(found[1], np.ones(6))
    np.testing.assert_allclose(found[2], [np.sqrt(48), 0, 0, 0, 0, 0], atol=1e-14)
    np.testing.assert_allclose(found[3], np.linalg.svd(matrices[3], compute_uv=False), atol=1e-14)
    np.testing.assert_array_equal(found[4], [5, 0, 0, 0, 0, 0])


def test_a_matrix_of_no_numbers_does_not_spoil_its_neighbours() -> None:
    matrices = np.random.default_rng(0).normal(size=(LANES, 7, 6))
    expected = np.linalg.svd(matrices, compute_uv=False)
    matrices[5, 2, 3] = np.nan
    found, _ = _singular_values(matrices)
    assert np.all(np.isnan(found[5]))
    np.testing.assert_allclose(np.delete(found, 5, 0), np.delete(expected, 5, 0), atol=1e-14)


SCRIPT = """
import numpy as np
from kinetostat.screw.compiled.blocks import evaluate_limit_distance as f
from kinetostat.screw.compiled.keeping import FOLDER
out = np.empty((1, 3))
f(np.array([[0.0, 0.5, 1.0]]), np.zeros(1), np.ones(1), out)
assert out.tolist() == [[1.0, 0.5, 0.0]]
print(FOLDER, sum(f.stats.cache_hits.values()))
"""


def _started(home: Path) -> subprocess.Popen[str]:
    environment = {**os.environ, "XDG_CACHE_HOME": str(home)}
    return subprocess.Popen([sys.executable, "-c", SCRIPT], env=environment, stdout=-1, stderr=-1, text=True)


def _ended(process: subprocess.Popen[str]) -> tuple[str, int]:
    """Return the folder of compiled code, and how much of it was taken from there."""
    out, err = process.communicate(timeout=300)
    assert (process.returncode, err) == (0, "")
    folder, hits = out.split()
    return folder, int(hits)


def test_code_is_compiled_once_for_all_processes(tmp_path: Path) -> None:
    """Three at once on an empty cache, and a fourth that finds the code there."""
    together = [_ended(process) for process in [_started(tmp_path) for _ in range(3)]]
    assert {Path(folder).is_relative_to(tmp_path) for folder, _ in together} == {True}
    assert _ended(_started(tmp_path))[1] == 1
    assert {file.suffix for file in Path(together[0][0]).iterdir()} == {".code"}  # no draft is left


@pytest.mark.parametrize("damage", ["empty", "cut", "flipped", "zeroed", "folder"])
def test_damaged_code_is_compiled_anew(tmp_path: Path, damage: str) -> None:
    folder, _ = _ended(_started(tmp_path))
    for file in Path(folder).iterdir():
        content = file.read_bytes()
        spoilt = {"empty": b"", "cut": content[: len(content) // 2], "zeroed": bytes(len(content))}
        flipped = content[:-100] + bytes([content[-100] ^ 0xFF]) + content[-99:]
        file.unlink()
        if damage == "folder":
            file.mkdir()
        else:
            file.write_bytes(spoilt.get(damage, flipped))
    assert _ended(_started(tmp_path))[1] == 0
    assert _ended(_started(tmp_path))[1] == (0 if damage == "folder" else 1)


def test_without_a_folder_to_write_in_every_process_compiles(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.touch()
    assert _ended(_started(blocked)) == ("None", 0)


def test_a_full_disk_keeps_nothing_and_spoils_nothing(tmp_path: Path) -> None:
    """Files may be empty only: what would be kept cannot be written."""
    limited = f"import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100));{SCRIPT}"
    quiet = f"import signal; signal.signal(signal.SIGXFSZ, signal.SIG_IGN);{limited}"
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    run = subprocess.run([sys.executable, "-c", quiet], env=environment, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")
    assert list(Path(run.stdout.split()[0]).iterdir()) == []


def test_code_in_a_folder_that_others_may_write_is_not_used(tmp_path: Path) -> None:
    folder, _ = _ended(_started(tmp_path))
    Path(folder).chmod(0o777)
    assert _ended(_started(tmp_path)) == ("None", 0)


def test_without_numba_one_line_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "kinetostat.screw.compiled.run", None)
    chain = Chain(np.array([[0, 0, 0, 0, 0, 1.0]]).T, np.eye(4), np.eye(1), np.zeros(1))
    with pytest.raises(UsageError, match="Numba"):
        Kernel(chain, ("placement",))(np.zeros((1, 1)))
