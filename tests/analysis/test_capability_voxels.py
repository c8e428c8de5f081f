"""What is known of voxels: what one configuration after the other gives, to the bit, in any order and any parts."""

import pickle
from functools import reduce

import numpy as np
import pytest

from kinetostat.analysis.capability import voxels
from kinetostat.analysis.capability.voxels import VoxelSums, counted

VOXELS, UNIT = 50, 2.0**-20


def drawn(seed, count, spread=VOXELS):
    """Return voxels, some of them none, with ties of values, and bits."""
    generator = np.random.default_rng(seed)
    index = generator.integers(-3, spread, count)
    values = generator.integers(0, 40, count) / 32
    return (
        np.maximum(index, -1),
        values,
        np.left_shift(np.uint64(1), generator.integers(0, 58, count).astype(np.uint64)),
    )


def part(seed, count=400, first=0, spread=VOXELS):
    index, values, bits = drawn(seed, count, spread)
    cells = counted(index, values, bits, first, UNIT)
    return VoxelSums(VOXELS, int(np.sum(index < 0)), seed, (seed / 7, 1 / (1 + seed)), None, (cells,))


def assert_same(a, b):
    """Compare to the bit."""
    first, second = a.state(), b.state()
    assert first.keys() == second.keys()
    for name, array in first.items():
        assert array.dtype == second[name].dtype
        assert array.tobytes() == second[name].tobytes(), name


@pytest.mark.parametrize(("seed", "count", "spread"), [(0, 400, 50), (1, 1, 50), (2, 4097, 3), (3, 300, -1), (4, 2, 1)])
def test_a_chunk_gives_what_counting_one_by_one_gives(seed, count, spread):
    index, values, bits = drawn(seed, count, max(spread, 0))
    expected = {}
    for row, (voxel, value, bit) in enumerate(zip(index.tolist(), values.tolist(), bits.tolist(), strict=True)):
        if voxel >= 0:
            expected.setdefault(voxel, []).append((value, 1000 + row, bit))
    cells = counted(index, values, bits, 1000, UNIT)
    assert cells.index.tolist() == sorted(expected)
    for i, voxel in enumerate(cells.index.tolist()):
        best = max(value for value, _, _ in expected[voxel])
        assert cells.count[i] == len(expected[voxel])
        assert cells.total[i] * UNIT == sum(value for value, _, _ in expected[voxel])
        assert cells.best[i] == best
        assert cells.row[i] == min(row for value, row, _ in expected[voxel] if value == best)
        assert int(cells.directions[i]) == reduce(int.__or__, (bit for _, _, bit in expected[voxel]))


@pytest.mark.parametrize("waiting", [0, 60, 1 << 18])
def test_parts_add_up_to_the_same_bits_in_any_order_and_grouping(waiting, monkeypatch):
    monkeypatch.setattr(voxels, "_PENDING", waiting)
    parts = [part(seed, first=400 * seed) for seed in range(12)]
    index, values, bits = (np.concatenate(each) for each in zip(*(drawn(seed, 400) for seed in range(12)), strict=True))
    whole = counted(index, values, bits, 0, UNIT)
    expected = reduce(VoxelSums.merged, parts, VoxelSums(VOXELS, differences=(0.0, 0.0)))
    assert expected.state()["count"].tolist() == whole.count.tolist()
    assert expected.state()["row"].tolist() == whole.row.tolist()
    assert expected.state()["total"].tolist() == whole.total.tolist()
    assert (expected.outside, expected.checked) == (np.sum(index < 0), sum(range(12)))
    assert expected.differences == (11 / 7, 1.0)
    generator = np.random.default_rng(waiting)
    for _ in range(30):
        left = [parts[i] for i in generator.permutation(len(parts))]
        while len(left) > 1:
            at = int(generator.integers(len(left) - 1))
            left[at : at + 2] = [left[at].merged(left[at + 1])]
        assert_same(left[0], expected)


def test_merging_changes_neither(monkeypatch):
    monkeypatch.setattr(voxels, "_PENDING", 0)
    both = part(1).merged(part(2))
    before = pickle.dumps(both.state())
    again = both.merged(part(3))
    again.merged(part(4))
    assert pickle.dumps(both.state()) == before
    assert_same(both.merged(part(3)), again)


def test_nothing_changes_nothing():
    nothing = VoxelSums(VOXELS, differences=(0.0, 0.0))
    assert_same(part(5).merged(nothing), part(5))
    assert_same(nothing.merged(part(5)), part(5))


@pytest.mark.parametrize("made", [lambda: part(1).merged(part(2)), lambda: VoxelSums(VOXELS, differences=(0.0, 0.0))])
def test_a_state_restores_to_the_bit(made):
    state = made().state()
    assert not any(array.dtype.hasobject for array in state.values())
    assert_same(VoxelSums.restored(state), made())
    assert_same(VoxelSums.restored(state).merged(part(3)), made().merged(part(3)))


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("index", lambda array: array[::-1]),
        ("index", lambda array: array + VOXELS),
        ("index", lambda array: array - VOXELS),
        ("count", lambda array: array[:-1]),
        ("count", lambda array: array.astype(float)),
        ("best", lambda array: array[:, None]),
    ],
)
def test_what_is_no_state_is_refused(name, change):
    state = part(1).state()
    with pytest.raises(ValueError, match="not the state"):
        VoxelSums.restored({**state, name: change(state[name])})
