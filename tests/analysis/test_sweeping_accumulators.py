"""Laws of tallies: merging is exact in any order and grouping, and what they tell is what NumPy and fractions tell."""

import math
from fractions import Fraction
from functools import reduce

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from kinetostat.analysis.sweeping.accumulators import ACCURACY, Tally

SHARES = [0.0, 0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99, 1.0]
EDGES = [0.0, -0.0, 1.0, -1.0, 5e-324, -5e-324, 2.2e-308, 1e-310, 1.7e308, -1.7e308, math.inf, -math.inf, math.nan, 0.1]
NUMBERS = st.lists(st.one_of(st.sampled_from(EDGES), st.floats(), st.floats(-1, 1)), max_size=12)
RNG = np.random.default_rng(7)
SAMPLES = {
    "uniform": RNG.uniform(0, 1, 5000),
    "signed": RNG.normal(size=5000),
    "log": 10 ** RNG.uniform(-300, 300, 5000),
    "constant": np.full(100, 0.3),
    "zeros": np.zeros(100),
    "one": np.array([-2.5]),
    "half zeros": np.where(RNG.random(4000) < 0.5, 0, RNG.normal(size=4000)),
    "negative": -RNG.exponential(size=3000),
    "denormal": RNG.integers(1, 1000, 2000) * 5e-324,
    "powers of two": 2.0 ** RNG.integers(-30, 30, 3000),
}


def same(a, b):
    """Return whether two tallies are the same to the bit."""
    mine, other = a.state(), b.state()
    return mine.keys() == other.keys() and all(
        mine[k].dtype == other[k].dtype and mine[k].tobytes() == other[k].tobytes() for k in mine
    )


def tallies(parts, below=(0.5,)):
    starts = np.cumsum([0, *(len(part) for part in parts)])
    above = tuple(threshold + 0.25 for threshold in below)
    return [
        Tally.of(np.array(part, dtype=float), int(at), below, above) for part, at in zip(parts, starts, strict=False)
    ]


@settings(max_examples=40, deadline=None)
@given(st.lists(NUMBERS, min_size=1, max_size=6), st.randoms(use_true_random=False))
def test_any_order_and_grouping_gives_the_same_bits(parts, random):
    found = tallies(parts)
    straight = reduce(Tally.merged, found)
    random.shuffle(found)
    while len(found) > 1:  # any two neighbours at a time
        at = random.randrange(len(found) - 1)
        found[at : at + 2] = [found[at].merged(found[at + 1])]
    assert same(found[0], straight)


@settings(max_examples=50, deadline=None)
@given(NUMBERS)
def test_a_state_restores_the_tally(numbers):
    tally = Tally.of(np.array(numbers, dtype=float), 17, (0.0, 0.5), (0.0,))
    assert same(Tally.restored({k: v.copy() for k, v in tally.state().items()}), tally)
    assert same(tally.merged(Tally(below=(0, 0), above=(0,))), tally)


@settings(max_examples=100, deadline=None)
@given(NUMBERS)
@example([-0.0, 0.0, -0.0])
@example([math.inf, math.nan, math.inf])
@example([math.nan, math.nan])
@example([1.7e308, 1.7e308, -1.0])
def test_counts_and_extremes_are_those_of_the_list(numbers):
    values = np.array(numbers, dtype=float)
    tally, known = Tally.of(values, 1000, (0.0, 0.5), (0.0, -1.0)), [x for x in numbers if not math.isnan(x)]
    assert tally.count == len(known)
    assert tally.invalid == len(numbers) - len(known)
    assert tally.below == (sum(x < 0 for x in known), sum(x < 0.5 for x in known))
    assert tally.above == (sum(x > 0 for x in known), sum(x > -1 for x in known))
    if not known:
        assert tally.minimum is None
        assert tally.maximum is None
        assert math.isnan(tally.mean)
        return
    assert (tally.minimum.value, tally.minimum.row) == (min(known), 1000 + numbers.index(min(known)))
    assert (tally.maximum.value, tally.maximum.row) == (max(known), 1000 + numbers.index(max(known)))


@pytest.mark.parametrize("name", SAMPLES)
def test_the_mean_is_the_exact_mean_of_the_chunks_sums(name):
    chunks = np.array_split(SAMPLES[name], 7)
    merged = reduce(Tally.merged, tallies(chunks))
    exact = sum(Fraction(float(np.sum(chunk))) for chunk in chunks) / len(SAMPLES[name])
    assert merged.mean == float(exact)
    assert merged.mean == pytest.approx(math.fsum(SAMPLES[name]) / len(SAMPLES[name]), rel=1e-12, abs=1e-320)


def test_sums_that_cancel_do_not_lose_the_rest():
    merged = reduce(Tally.merged, tallies([[1e300], [1.0], [-1e300], [1e-300]]))
    assert merged.mean == 0.25


def test_sums_too_large_for_a_float_have_a_mean():
    assert Tally.of(np.array([1.5e308, 1.7e308, 1.6e308])).mean == pytest.approx(1.6e308, rel=1e-15)


@pytest.mark.parametrize("values", [[1.0, math.inf], [-math.inf, 1.0], [math.inf, -math.inf]])
def test_infinite_numbers_count(values):
    tally = Tally.of(np.array(values))
    with np.errstate(invalid="ignore"):
        assert tally.mean == pytest.approx(float(np.mean(values)), nan_ok=True)
    assert tally.quantile(0.0) == min(values)
    assert tally.quantile(1.0) == max(values)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("name", SAMPLES)
def test_quantiles_are_order_statistics_within_the_stated_error(name, share):
    values = SAMPLES[name]
    exact = float(np.quantile(values, share, method="inverted_cdf"))
    found = reduce(Tally.merged, tallies(np.array_split(values, 5))).quantile(share)
    assert abs(found - exact) <= ACCURACY * abs(exact) + 1e-310


def test_quantiles_leave_out_what_is_not_a_number():
    values = np.concatenate([SAMPLES["signed"], np.full(5000, math.nan)])
    assert Tally.of(values).quantile(0.5) == Tally.of(SAMPLES["signed"]).quantile(0.5)
    assert math.isnan(Tally.of(values[5000:]).quantile(0.5))


@pytest.mark.parametrize("name", SAMPLES)
def test_a_histogram_counts_every_number_once_between_the_extremes(name):
    values = SAMPLES[name]
    histogram = Tally.of(values).histogram(12)
    assert np.sum(histogram.counts) == len(values)
    assert histogram.edges[0] == np.min(values)
    assert histogram.edges[-1] == np.max(values)
    assert len(histogram.edges) == len(histogram.counts) + 1
    assert np.all(np.diff(histogram.edges) >= 0)


@pytest.mark.parametrize("name", ["uniform", "signed", "negative", "half zeros"])
def test_a_histogram_is_numpys_but_for_numbers_at_the_edges(name):
    values = SAMPLES[name]
    histogram = Tally.of(values).histogram(10)
    expected, edges = np.histogram(values, 10)
    at_edges = np.sum(np.abs(values[:, None] - edges) <= ACCURACY * np.abs(values[:, None]) + 1e-15)
    assert np.sum(np.abs(histogram.counts - expected)) <= 2 * at_edges
    assert np.allclose(histogram.edges, edges, rtol=0, atol=1e-12)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("width", [1e-4, 0.0045, 0.3])
def test_bins_finer_than_what_can_be_told_apart_have_no_gaps(width, sign):
    values = sign * (1.0 + width * (np.arange(20_000) + 0.5) / 20_000)
    counts = Tally.of(values).histogram(40).counts
    assert np.sum(counts) == len(values)
    assert np.all(np.abs(counts - 500) <= 0.3 * 500)  # evenly spread as the numbers are, no comb


def test_zero_is_a_number_of_its_own_in_a_histogram():
    counts = Tally.of(np.repeat([-1.0, 0.0, 1.0], [10, 20, 30])).histogram(4).counts
    assert counts.tolist() == [10, 0, 20, 30]


def test_of_equal_extremes_the_first_row_is_told_in_any_order():
    early, late = Tally.of(np.array([2.0, 1.0, 1.0]), 10), Tally.of(np.array([1.0, 2.0]), 500)
    for merged in (early.merged(late), late.merged(early)):
        assert merged.minimum.row == 11
        assert merged.maximum.row == 10


def test_memory_does_not_grow_with_the_count():
    rng, total = np.random.default_rng(0), Tally()
    sizes = []
    for chunk in range(40):
        total = total.merged(Tally.of(rng.normal(size=10_000), chunk * 10_000))
        sizes.append(sum(part.nbytes for part in total.state().values()))
    assert total.count == 400_000
    assert sizes[-1] < 1.3 * sizes[4]
