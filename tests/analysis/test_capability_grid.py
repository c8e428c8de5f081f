"""Grids of voxels: every point is in one, the observer's origin in the middle of one; too many are refused."""

import re

import numpy as np
import pytest

from kinetostat.analysis.capability.grid import LARGEST, Grid, fitted, usual_size
from kinetostat.errors import UsageError

LOW, HIGH = np.array([-0.93, -0.4, 0.1]), np.array([0.71, 0.5, 1.37])


def points(count=2000, seed=0):
    return np.random.default_rng(seed).uniform(LOW, HIGH, (count, 3))


def test_numbers_and_middles_go_together():
    grid = fitted(LOW, HIGH, points(), 0.07)
    every = np.arange(grid.count)
    assert np.array_equal(grid.index(grid.centre(every)), every)
    x, y, z = grid.axes
    middles = np.stack(np.meshgrid(x, y, z, indexing="ij"), -1).reshape(-1, 3)
    np.testing.assert_allclose(grid.centre(every), middles, atol=1e-14)


def test_a_point_is_at_most_half_a_voxel_from_its_middle():
    grid, inside = fitted(LOW, HIGH, points(), 0.07), points()
    away = np.abs(grid.centre(grid.index(inside)) - inside)
    assert away.max() <= 0.035 + 1e-12


@pytest.mark.parametrize("size", [0.013, 0.1, 0.45, 3.0, None])
def test_the_box_is_inside_to_its_corners(size):
    grid = fitted(LOW, HIGH, points(), size)
    corners = np.array([[a, b, c] for a in (LOW[0], HIGH[0]) for b in (LOW[1], HIGH[1]) for c in (LOW[2], HIGH[2])])
    assert np.all(grid.index(corners) >= 0)


@pytest.mark.parametrize("far", [[-9.0, 0, 0.5], [0, 9.0, 0.5], [0, 0, -9.0], [1e300, 0, 0.5], [0, -np.inf, 0.5]])
def test_what_is_outside_is_in_no_voxel(far):
    assert fitted(LOW, HIGH, points(), 0.1).index(np.array([far])) == [-1]


def test_the_origin_is_in_the_middle_of_a_voxel():
    grid = fitted(-HIGH, HIGH, points() - 0.5, 0.1)
    middle = grid.index(np.zeros(3))
    np.testing.assert_allclose(grid.centre(middle), 0, atol=1e-12)


def test_an_axis_without_motion_has_one_layer_about_the_tool():
    flat = points()
    flat[:, 2] = 0.123 + 1e-15 * np.random.default_rng(1).normal(size=len(flat))
    grid = fitted(LOW, HIGH, flat, 0.1)
    assert grid.shape[2] == 1
    assert grid.axes[2][0] == pytest.approx(0.123, abs=1e-12)


@pytest.mark.parametrize("span", [1e-3, 0.37, 1.0, 2.2, 50.0, 1e6])
def test_the_usual_size_has_one_digit_and_suits(span):
    size = usual_size(np.zeros(3), np.array([span, span / 3, 0]))
    assert float(f"{size:.0e}") == size
    assert f"{size:e}"[0] in "125"
    assert 25 < span / size < 65


def test_a_tool_that_does_not_move_at_all_has_a_voxel():
    assert fitted(np.ones(3), np.ones(3), np.ones((5, 3)), None).count == 1


@pytest.mark.parametrize("size", [1e-4, 2e-3, 5e-8])
def test_too_many_voxels_are_refused_with_a_size_that_would_do(size):
    with pytest.raises(UsageError) as refusal:
        fitted(LOW, HIGH, points(), size)
    enough = float(re.search(r"--voxel (\S+) would do", str(refusal.value)).group(1))
    grid = fitted(LOW, HIGH, points(), enough)
    assert LARGEST / 2 < grid.count <= LARGEST


@pytest.mark.parametrize("size", [0.0, -1.0, np.nan, np.inf, 1e-300])
def test_a_size_that_cannot_be_is_refused(size):
    with pytest.raises(UsageError, match="voxel"):
        fitted(LOW, HIGH, points(), size)


def test_a_part_has_the_same_voxels():
    grid = fitted(LOW, HIGH, points(), 0.1)
    part = grid.part((2, 1, 3), (5, 4, 3))
    assert part.shape == (4, 4, 1)
    np.testing.assert_allclose(part.centre(0), [axis[i] for axis, i in zip(grid.axes, (2, 1, 3), strict=True)])
    assert repr(Grid(np.zeros(3), 0.5, (1, 2, 3))) == "<Grid 1 x 2 x 3 voxels of 0.5 m>"
