"""Compiled kernels against their definition in NumPy: chains of every kind of screw, every output, edges and sizes."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from differences import STEP, derivative
from kinetostat.screw import se3
from kinetostat.screw.chain import Chain, screw
from kinetostat.screw.compiled.compiling import LANES
from kinetostat.screw.kernel import OUTPUTS, Kernel, limit_distance, named
from kinetostat.screw.tree import Tree

GRAVITY = np.array([1.0, -2.0, -9.81])


def random_kernel(seed: int, screws: int, rows: tuple[int, ...] = (0, 1, 2, 3, 4, 5), *, local: bool = False) -> Kernel:
    """Return a kernel of all outputs: turns, slides and helices, of which some follow others, on a branching tree."""
    random = np.random.default_rng(seed)
    pitches = random.choice([0.0, 0.0, 0.0, np.inf, 0.3, -2.0], screws)
    directions = random.normal(size=(screws, 3))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    lines = zip(directions, random.uniform(-1, 1, (screws, 3)), pitches, strict=True)
    columns = np.stack([screw(*line) for line in lines], -1)
    followers = [i for i in range(1, screws) if random.random() < 0.2]
    free = [i for i in range(screws) if i not in followers]
    fold = np.zeros((screws, len(free)))
    for i in range(screws):
        fold[i, free.index(i) if i in free else random.integers(len(free))] = (
            1.0 if i in free else random.uniform(-2, 2)
        )
    offset = np.where(np.isin(range(screws), followers), random.uniform(-1, 1, screws), 0.0)
    parents = tuple(int(random.integers(max(-1, i - 3), i)) for i in range(screws))
    tree = Tree(columns, parents, fold, offset, random.uniform(0, 3, screws), random.uniform(-1, 1, (screws, 3)))
    efforts = np.stack([-random.uniform(1, 9, len(free)), random.uniform(1, 9, len(free))])
    limits = np.sort(random.uniform(-3, 3, (2, len(free))), axis=0)
    efforts[:, random.random(len(free)) < 0.2], limits[1, random.random(len(free)) < 0.2] = np.nan, np.inf
    return Kernel(
        Chain(columns, se3.exp(random.uniform(-2, 2, 6)), fold, offset),
        OUTPUTS,
        rows,
        random.uniform(0.5, 2, 6),
        random.uniform(0.5, 2, len(free)),
        local,
        tree,
        GRAVITY,
        efforts,
        limits,
    )


def close(found: np.ndarray, expected: np.ndarray, size: float) -> None:
    """Both are the same within 1e-12 of a size, and neither a number where the other is not."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * max(1.0, size), equal_nan=True)


def condition(kernel: Kernel, q: np.ndarray) -> float:
    """What rounding grows by in gradients of these configurations."""
    s = kernel.definition(q)["singular_values"]
    return float(np.max(s[:, 0] / s[:, -1]))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("screws", [6, 7, 12])
@pytest.mark.parametrize("local", [False, True])
def test_every_output_is_as_defined(screws: int, seed: int, local: bool) -> None:
    kernel = random_kernel(seed, screws, local=local)
    n = kernel.chain.fold.shape[1]
    if n < 6:
        pytest.skip("fewer coordinates than rows have a test of their own")
    q = np.random.default_rng(seed).uniform(-4, 4, (LANES + 3, n))
    found, expected = kernel(q), kernel.definition(q)
    assert tuple(found) == OUTPUTS
    for name in OUTPUTS:
        assert found[name].shape == expected[name].shape
        grown = condition(kernel, q) if name.endswith("gradient") else 10.0
        close(found[name], expected[name], grown * np.nanmax(np.abs(expected[name]), initial=1.0))


@pytest.mark.parametrize("rows", [(0, 1, 2), (3, 4, 5), (0, 1, 5), (2,)])
@pytest.mark.parametrize("local", [False, True])
def test_rows_of_a_task(rows: tuple[int, ...], local: bool) -> None:
    kernel = random_kernel(3, 7, rows, local=local)
    q = np.random.default_rng(1).uniform(-3, 3, (50, kernel.chain.fold.shape[1]))
    found, expected = kernel(q), kernel.definition(q)
    for name in OUTPUTS:
        grown = condition(kernel, q) if name.endswith("gradient") else 10.0
        close(found[name], expected[name], grown * np.nanmax(np.abs(expected[name]), initial=1.0))


@pytest.mark.parametrize("screws", [1, 2, 4])
def test_fewer_coordinates_than_rows(screws: int) -> None:
    kernel = random_kernel(11, screws)
    q = np.random.default_rng(2).uniform(-3, 3, (40, kernel.chain.fold.shape[1]))
    found, expected = kernel(q), kernel.definition(q)
    assert found["singular_values"].shape == (40, kernel.chain.fold.shape[1])
    for name in OUTPUTS:
        grown = condition(kernel, q) if name.endswith("gradient") else 10.0
        close(found[name], expected[name], grown * np.nanmax(np.abs(expected[name]), initial=1.0))


@pytest.mark.parametrize("count", [0, 1, LANES - 1, LANES, LANES + 1, 3 * LANES])
def test_the_number_of_configurations_does_not_matter(count: int) -> None:
    """Each configuration has the same bits alone as amid others, whatever else is asked for."""
    kernel = random_kernel(5, 7)
    q = np.random.default_rng(3).uniform(-3, 3, (3 * LANES, kernel.chain.fold.shape[1]))
    whole, part = kernel(q), kernel(q[:count])
    for name in OUTPUTS:
        np.testing.assert_array_equal(part[name], whole[name][:count])
    alone = replace(kernel, outputs=("jacobian",))(q[:count])["jacobian"]
    np.testing.assert_allclose(alone, whole["jacobian"][:count], rtol=0, atol=1e-15 * 100)


def test_layouts_of_positions_give_the_same() -> None:
    kernel = random_kernel(5, 7)
    q = np.random.default_rng(3).uniform(-3, 3, (300, kernel.chain.fold.shape[1]))
    turned = np.ascontiguousarray(q.T).T
    for name, values in kernel(q).items():
        np.testing.assert_array_equal(values, kernel(turned)[name])
        np.testing.assert_array_equal(values[::2], kernel(q[::2])[name])


@pytest.mark.parametrize("angle", [0.0, -0.0, np.pi / 2, np.pi, -np.pi, 2 * np.pi, 1e-300, 1e-8, 1e3, -1e6])
def test_edges_of_angles(angle: float) -> None:
    kernel = replace(random_kernel(8, 7), outputs=("placement", "jacobian", "gravity_torque"))
    q = np.full((1, kernel.chain.fold.shape[1]), angle)
    found, expected = kernel(q), kernel.definition(q)
    for name in kernel.outputs:  # a large angle, which has lost digits itself, slides a helix far
        close(found[name], expected[name], 100 + abs(angle) ** 2)


def test_gradients_are_those_of_the_values() -> None:
    kernel = replace(
        random_kernel(9, 8), outputs=("singular_values", "yoshikawa", "yoshikawa_gradient", "minimum_gradient")
    )
    n = kernel.chain.fold.shape[1]
    q = np.random.default_rng(4).uniform(-3, 3, (30, n))
    found = kernel(q)
    for j in range(n):
        unit = np.eye(n)[j]
        moved = [kernel(q + t * unit) for t in STEP * np.arange(-3, 4) if t]
        slope = derivative(lambda _, moved=moved: np.stack([one["yoshikawa"] for one in moved]))
        np.testing.assert_allclose(found["yoshikawa_gradient"][:, j], slope, rtol=1e-5, atol=1e-6)
        slope = derivative(lambda _, moved=moved: np.stack([one["singular_values"][:, -1] for one in moved]))
        np.testing.assert_allclose(found["minimum_gradient"][:, j], slope, rtol=1e-5, atol=1e-6)


def test_torques_are_the_slope_of_the_energy() -> None:
    """tau = dU/dq with U = -sum m g . c, the centres placed by products of exponentials."""
    kernel = replace(random_kernel(10, 7), outputs=("gravity_torque",))
    tree, n = kernel.tree, kernel.chain.fold.shape[1]
    assert tree is not None
    q = np.random.default_rng(5).uniform(-3, 3, n)

    def energy(at: np.ndarray) -> float:
        t, placements, total = tree.fold @ at + tree.offset, [], 0.0
        for k, parent in enumerate(tree.parents):
            before = np.eye(4) if parent < 0 else placements[parent]
            placements.append(before @ se3.exp(tree.screws[:, k] * t[k]))
            total -= tree.masses[k] * GRAVITY @ se3.transform(placements[k], tree.centres[k])
        return total

    slopes = [derivative(lambda ts, unit=unit: np.array([energy(q + t * unit) for t in ts])) for unit in np.eye(n)]
    np.testing.assert_allclose(kernel(q[None])["gravity_torque"][0], slopes, rtol=1e-6, atol=1e-6)


def test_singular_configurations_have_no_gradient_but_values() -> None:
    """A gantry of three slides along the same two directions: rank 2 everywhere."""
    slides = np.stack([screw(d, np.zeros(3), np.inf) for d in np.eye(3)[[0, 1, 0]]], -1)
    chain = Chain(slides, np.eye(4), np.eye(3), np.zeros(3))
    wanted = ("singular_values", "yoshikawa", "yoshikawa_gradient", "minimum_gradient")
    found = Kernel(chain, wanted, (0, 1, 2))(np.random.default_rng(0).normal(size=(9, 3)))
    np.testing.assert_allclose(found["singular_values"], np.tile([np.sqrt(2), 1, 0], (9, 1)), atol=1e-15)
    np.testing.assert_allclose(found["yoshikawa"], np.zeros(9), atol=1e-15)
    assert np.all(np.isnan(found["yoshikawa_gradient"]))
    assert np.all(np.isnan(found["minimum_gradient"]))


def test_a_gantry_is_isotropic() -> None:
    """Columns that are orthogonal and equally long from the start stay as they are."""
    slides = np.stack([screw(d, np.zeros(3), np.inf) for d in np.eye(3)], -1)
    chain = Chain(slides, np.eye(4), np.eye(3), np.zeros(3))
    found = Kernel(chain, ("singular_values", "yoshikawa", "placement"), (0, 1, 2))(np.array([[1.0, 2.0, -3.0]]))
    np.testing.assert_allclose(found["singular_values"], [[1.0, 1.0, 1.0]], rtol=1e-15)
    np.testing.assert_allclose(found["yoshikawa"], [1.0], rtol=1e-15)
    np.testing.assert_allclose(found["placement"][0, :, 3], [1.0, 2.0, -3.0], rtol=1e-15)


def test_distance_to_limits() -> None:
    limits = np.array([[-1.0, 0.0, -np.inf, 2.0], [1.0, 4.0, np.inf, 2.0]])
    q = np.array([[0.0, 2.0, 99.0, 2.0], [0.5, 2.0, 0.0, 2.0], [1.0, 1.0, 0.0, 2.0], [1.5, 2.0, 0.0, 2.0]])
    np.testing.assert_allclose(limit_distance(q, limits), [1.0, 0.5, 0.0, -0.5])
    assert limit_distance(np.array([[0.0, 2.0, 0.0, 2.1]]), limits)[0] < -1e200  # a joint that cannot be there


def test_kernels_travel() -> None:
    kernel = random_kernel(5, 7)
    q = np.random.default_rng(3).uniform(-3, 3, (20, kernel.chain.fold.shape[1]))
    again = pickle.loads(pickle.dumps(kernel))
    for name, values in kernel(q).items():
        np.testing.assert_array_equal(values, again(q)[name])


def test_outputs_are_named_in_one_order() -> None:
    assert named(["gravity_torque", "placement", "placement"]) == ("placement", "gravity_torque")
