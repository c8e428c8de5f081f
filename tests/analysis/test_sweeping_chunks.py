"""Sets of chunks are sets; the pace of a run in words."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinetostat.analysis.sweeping.chunks import Chunks
from kinetostat.analysis.sweeping.pace import Pace, counted, lasting


@given(st.lists(st.integers(0, 40), unique=True))
def test_chunks_are_a_set_in_any_order(order):
    chunks = Chunks()
    for chunk in order:
        chunks = chunks.and_also(chunk)
    assert list(chunks) == sorted(order)
    assert len(chunks) == len(order)
    assert [chunk for chunk in range(-1, 45) if chunk in chunks] == sorted(order)
    assert list(chunks.missing(41)) == sorted(set(range(41)) - set(order))
    assert Chunks.of(chunks.array()) == chunks
    assert all(a[1] < b[0] for a, b in zip(chunks.intervals, chunks.intervals[1:], strict=False))


@given(st.lists(st.integers(0, 40), unique=True, min_size=1), st.data())
def test_no_chunk_twice(order, data):
    chunks = Chunks()
    for chunk in order:
        chunks = chunks.and_also(chunk)
    with pytest.raises(ValueError, match="done twice"):
        chunks.and_also(data.draw(st.sampled_from(order)))


@pytest.mark.parametrize(
    "array",
    [
        [[1, 1]],
        [[2, 1]],
        [[-1, 2]],
        [[0, 2], [2, 3]],
        [[3, 4], [0, 1]],
        [[0, 1, 2]],
        [0, 1],
        [[0.0, 1.0]],
        [[True, False]],
    ],
)
def test_what_are_no_intervals(array):
    with pytest.raises(ValueError):
        Chunks.of(np.array(array))


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (0, "0"),
        (7, "7"),
        (999, "999"),
        (999.4, "999"),
        (999.6, "1 k"),
        (1000, "1 k"),
        (12_400, "12.4 k"),
        (999_499, "999 k"),
        (999_500, "1 M"),
        (12_400_000, "12.4 M"),
        (100_000_000, "100 M"),
        (1e9, "1 G"),
        (1.234e12, "1234 G"),
        (0.25, "0.25"),
    ],
)
def test_numbers_in_three_digits(number, text):
    assert counted(number) == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.2, "0 s"),
        (28, "28 s"),
        (59.6, "1 min 0 s"),
        (200, "3 min 20 s"),
        (3599.7, "1 h 0 min"),
        (7500, "2 h 5 min"),
        (200_000, "2 d 7 h"),
    ],
)
def test_times_in_words(seconds, text):
    assert lasting(seconds) == text


def test_the_pace_counts_what_this_run_has_done():
    pace = Pace(rows=100_000_000, before=2_000_000, began=10.0)
    assert pace.words(2_000_000, 11.0) == "2 M of 100 M configurations"
    assert pace.words(12_000_000, 15.0) == "12 M of 100 M configurations, 2 M/s, 44 s left"
