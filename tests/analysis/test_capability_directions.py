"""Directions of approach as bits: equal areas, symmetric bins, axes that rounding does not move."""

import itertools

import numpy as np
import pytest

from kinetostat.analysis.capability import directions as sphere


def random_directions(count, seed=0):
    drawn = np.random.default_rng(seed).normal(size=(count, 3))
    return drawn / np.linalg.norm(drawn, axis=-1, keepdims=True)


def test_bins_have_equal_areas():
    count = 200_000
    found = np.bincount(sphere.bins(random_directions(count)), minlength=sphere.DIRECTIONS)
    assert len(found) == sphere.DIRECTIONS
    expected = count / sphere.DIRECTIONS
    assert np.abs(found - expected).max() < 5 * np.sqrt(expected)


def test_the_middle_of_a_bin_is_in_it():
    centres = sphere.centres()
    np.testing.assert_allclose(np.linalg.norm(centres, axis=-1), 1, atol=1e-15)
    assert list(sphere.bins(centres)) == list(range(sphere.DIRECTIONS))


@pytest.mark.parametrize("signs", list(itertools.product((1, -1), repeat=3)))
def test_reflections_take_bins_to_bins(signs):
    drawn = random_directions(20_000, seed=1)
    pairs = set(zip(sphere.bins(drawn).tolist(), sphere.bins(drawn * signs).tolist(), strict=True))
    assert len(pairs) == sphere.DIRECTIONS


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [1, -1])
def test_rounding_does_not_move_an_axis_to_another_bin(axis, sign):
    exact = sign * np.eye(3)[axis]
    noise = 1e-9 * random_directions(500, seed=2)
    assert set(sphere.bins(exact + noise).tolist()) == {int(sphere.bins(exact))}


def test_a_mask_has_the_bit_of_the_bin():
    drawn = random_directions(1000, seed=3)
    masks = sphere.mask(drawn)
    assert masks.dtype == np.uint64
    assert [int(bits).bit_length() - 1 for bits in masks] == sphere.bins(drawn).tolist()
    assert all(int(bits).bit_count() == 1 for bits in masks)


def test_coverage_is_the_share_of_bins():
    every = np.bitwise_or.reduce(sphere.mask(sphere.centres()))
    half = np.bitwise_or.reduce(sphere.mask(sphere.centres()[: sphere.DIRECTIONS // 2]))
    assert list(sphere.coverage(np.array([0, every, half], dtype=np.uint64))) == [0, 1, 0.5]


def test_bins_side_by_side_are_added_and_none_farther():
    drawn = random_directions(50_000, seed=5)
    near = drawn + 1e-3 * random_directions(50_000, seed=6)
    near /= np.linalg.norm(near, axis=-1, keepdims=True)
    assert np.all(sphere.widened(sphere.mask(drawn)) & sphere.mask(near))
    axes = sphere.centres()
    wide = sphere.widened(sphere.mask(axes))
    beside = (wide[:, None] >> np.arange(sphere.DIRECTIONS, dtype=np.uint64)) & np.uint64(1) == 1
    assert np.array_equal(beside, beside.T)
    assert np.min((axes @ axes.T)[beside]) > np.cos(np.radians(45))
    assert 4 <= np.min(beside.sum(axis=1)) <= np.max(beside.sum(axis=1)) <= 12
    assert sphere.widened(np.uint64(0)) == 0
