"""Laws of sources: any part of the rows is the same whoever asks for it, and they are where they ought to be."""

import pickle

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.coordinates import coordinates
from kinetostat.analysis.sweeping.radical_inverse import RadicalInverse
from kinetostat.analysis.sweeping.samples import (
    BLOCK,
    grid_source,
    halton_source,
    list_source,
    random_source,
)
from kinetostat.errors import ConfigurationError, UnknownNameError, UsageError

UR5 = ks.load("example:ur5_robot")
CHAIN = coordinates(UR5, "tool0", UR5.robot.root)
REST = np.arange(6) / 10
GRID = "elbow_joint=-1:1:61,shoulder_pan_joint=0:3:50,wrist_1_joint=-2:-1:70"
SOURCES = {
    "random": random_source(CHAIN, 10**9, seed=5),
    "halton": halton_source(CHAIN, 10**9, seed=5),
    "grid": grid_source(CHAIN, REST, GRID),
    "list": list_source(CHAIN, np.random.default_rng(0).uniform(-1, 1, (200_000, 6))),
}


@pytest.mark.parametrize("name", SOURCES)
def test_rows_do_not_depend_on_the_blocks_in_which_they_are_asked_for(name):
    source = SOURCES[name]
    whole = source.rows(0, 3 * BLOCK)
    for start, stop in (
        (0, 1),
        (5, 5),
        (0, BLOCK),
        (BLOCK - 1, BLOCK + 1),
        (BLOCK + 3, 2 * BLOCK + 4099),
        (4090, 4103),
    ):
        assert np.array_equal(source.rows(start, stop), whole[start:stop])


@pytest.mark.parametrize("name", SOURCES)
def test_rows_are_transposes_of_c_arrays_and_survive_pickling(name):
    source = SOURCES[name]
    rows = source.rows(7, 1007)
    assert rows.shape == (1000, 6)
    assert rows.T.flags.c_contiguous
    assert np.array_equal(pickle.loads(pickle.dumps(source)).rows(7, 1007), rows)


@pytest.mark.parametrize("name", SOURCES)
def test_no_row_is_outside_the_bounds(name):
    source = SOURCES[name]
    rows = source.rows(0, 150_000)
    assert np.all(rows >= source.bounds[0])
    assert np.all(rows <= source.bounds[1])


@pytest.mark.parametrize("make", [random_source, halton_source])
def test_a_longer_sweep_begins_with_the_shorter_one_and_seeds_differ(make):
    short, long, other = make(CHAIN, 100, 3), make(CHAIN, 10**6, 3), make(CHAIN, 100, 4)
    assert np.array_equal(short.rows(0, 100), long.rows(0, 100))
    assert not np.any(short.rows(0, 100) == other.rows(0, 100))


def test_random_rows_differ_from_block_to_block_and_fill_the_limits():
    source = SOURCES["random"]
    first, second = source.rows(0, BLOCK), source.rows(BLOCK, 2 * BLOCK)
    assert len(np.intersect1d(first[:, 0], second[:, 0])) == 0
    share = (first - source.bounds[0]) / (source.bounds[1] - source.bounds[0])
    assert np.allclose(np.mean(share, axis=0), 0.5, atol=0.01)
    assert np.allclose(np.var(share, axis=0), 1 / 12, atol=0.003)
    assert np.max(np.abs(np.corrcoef(share.T) - np.eye(6))) < 0.02


def test_halton_rows_visit_each_interval_of_their_base_equally_often():
    rows = SOURCES["halton"].rows(0, 2**4 * 3**3 * 5**2)
    lower, upper = SOURCES["halton"].bounds
    share = (rows - lower) / (upper - lower)
    for j, parts in enumerate((2**4, 3**3, 5**2)):
        counts = np.bincount((share[:, j] * parts).astype(int), minlength=parts)
        assert np.all(counts == len(rows) // parts)


def test_halton_rows_are_far_more_even_than_random_ones():
    def error(source):
        share = (source.rows(0, 4096) - source.bounds[0]) / (source.bounds[1] - source.bounds[0])
        return abs(np.mean(np.prod(share, axis=1)) - 0.5**6)

    pairs = [(error(halton_source(CHAIN, 4096, seed)), error(random_source(CHAIN, 4096, seed))) for seed in range(20)]
    even, random = np.sqrt(np.mean(np.square(pairs), axis=0))
    assert even < random / 3


def test_unscrambled_digits_are_scipys_halton():
    from scipy.stats import qmc

    expected = qmc.Halton(6, scramble=False).random(10_000)

    class Identity:
        @staticmethod
        def permutation(base):
            return np.arange(base)

    for j, base in enumerate((2, 3, 5, 7, 11, 13)):
        found = np.empty(9_000)
        RadicalInverse.scrambled(base, Identity()).fill(found, 1000)
        assert np.allclose(found, expected[1000:, j], rtol=0, atol=1e-15)


def test_a_grid_has_all_combinations_once_and_other_joints_at_rest():
    source = grid_source(
        CHAIN, REST, {"elbow_joint": (-1, 1, 3), "wrist_3_joint": (5, 5, 1), "wrist_1_joint": (0, 1, 2)}
    )
    rows = source.rows(0, source.count)
    assert source.count == 6
    assert rows[:, 2].tolist() == [-1, -1, 0, 0, 1, 1]
    assert rows[:, 3].tolist() == [0, 1, 0, 1, 0, 1]
    assert np.array_equal(rows[:, [0, 1, 4]], np.tile(REST[[0, 1, 4]], (6, 1)))
    assert set(rows[:, 5]) == {5.0}
    assert source.label == "grid: 3 of elbow_joint x 2 of wrist_1_joint"


def test_a_grid_in_degrees_and_of_one_value():
    source = grid_source(CHAIN, REST, "elbow_joint=-90:90:3, wrist_1_joint=45:50:1", degrees=True)
    assert np.allclose(source.rows(0, 3)[:, 2], [-np.pi / 2, 0, np.pi / 2])
    assert np.allclose(source.rows(0, 3)[:, 3], np.pi / 4)


def test_slides_of_a_grid_are_metres_even_in_degrees():
    model = ks.load("textbook:rp")
    chain = coordinates(model, model.robot.tips[-1], model.robot.root)
    slide = chain.names[chain.turning.index(False)]
    source = grid_source(chain, np.zeros(2), {slide: (0.25, 0.5, 2)}, degrees=True)
    assert source.rows(0, 2)[:, chain.names.index(slide)].tolist() == [0.25, 0.5]


@pytest.mark.parametrize(
    ("grid", "words"),
    [
        ("", "names one joint"),
        ("elbow_joint", "no axis"),
        ("elbow_joint=1:2", "lowest:highest:count"),
        ("elbow_joint=1:2:3:4", "lowest:highest:count"),
        ("elbow_joint=1:2:0", "from 1 on"),
        ("elbow_joint=1:2:1.5", "whole number"),
        ("elbow_joint=1:nan:2", "no axis"),
        ("elbow_joint=1:x:2", "no axis"),
        ("elbow_joint=1:2:2,elbow_joint=1:2:2", "twice"),
        ("elbow_joint=0:1:1000000000,wrist_1_joint=0:1:1000000000", "1e\\+18 configurations"),
        ("ee_fixed_joint=0:1:2", "fixed"),
    ],
)
def test_grids_that_cannot_be(grid, words):
    with pytest.raises(UsageError, match=words):
        grid_source(CHAIN, REST, grid)


def test_a_grid_beyond_what_an_engine_can_take_is_refused():
    with pytest.raises(ConfigurationError, match="beyond"):
        grid_source(CHAIN, REST, "elbow_joint=0:1e9:2")


def test_a_grids_unknown_joint_has_near_names():
    with pytest.raises(UnknownNameError, match="did you mean 'elbow_joint'"):
        grid_source(CHAIN, REST, "elbow_jiont=0:1:2")


def test_a_grids_joint_outside_the_chain_is_told_so():
    model = ks.load("example:ur5_robot")
    chain = coordinates(model, "upper_arm_link", model.robot.root)
    with pytest.raises(UsageError, match="'wrist_1_joint' does not move the frame"):
        grid_source(chain, REST, "wrist_1_joint=0:1:2")


@pytest.mark.parametrize("count", [0, -1, 10**13])
def test_counts_that_cannot_be(count):
    with pytest.raises(UsageError, match="between 1 and"):
        random_source(CHAIN, count)


@pytest.mark.parametrize("seed", [-1, 2**64])
def test_seeds_that_cannot_be(seed):
    with pytest.raises(UsageError, match="seed"):
        halton_source(CHAIN, 10, seed)


@pytest.mark.parametrize("q", [np.zeros((3, 5)), np.zeros(6), np.full((2, 6), np.nan), np.full((2, 6), 1e9)])
def test_lists_that_cannot_be(q):
    with pytest.raises(ConfigurationError):
        list_source(CHAIN, q)


def test_an_empty_list_is_refused():
    with pytest.raises(UsageError, match="no configuration"):
        list_source(CHAIN, np.zeros((0, 6)))


def test_a_hundred_coordinates_have_a_halton_sequence():
    from kinetostat.analysis.sweeping import samples

    source = samples.HaltonSource(tuple(map(str, range(100))), 10**6, np.tile([[0.0], [1.0]], (1, 100)), 0)
    rows = source.rows(500_000, 510_000)
    assert np.all((rows >= 0) & (rows <= 1))
    assert np.allclose(np.mean(rows, axis=0), 0.5, atol=0.05)
