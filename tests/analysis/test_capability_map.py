"""Capability maps: where the workspace is known, they are it; numbers of a voxel are those of its configurations."""

import math
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.capability.capability_map import capability_map
from kinetostat.analysis.capability.directions import centres
from kinetostat.analysis.sweeping.running import run
from kinetostat.errors import ConfigurationError, UnknownNameError, UsageError
from kinetostat.screw.kernel import Kernel
from trees import load_text

GANTRY = """<robot name="gantry">
  <link name="base"/><link name="a"/><link name="b"/><link name="tool"/>
  <joint name="x" type="prismatic"><parent link="base"/><child link="a"/><axis xyz="1 0 0"/>
    <limit lower="-0.35" upper="1.15" effort="1" velocity="1"/></joint>
  <joint name="y" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/>
    <limit lower="0.05" upper="0.65" effort="1" velocity="1"/></joint>
  <joint name="z" type="prismatic"><parent link="b"/><child link="tool"/><origin xyz="0 0 1"/><axis xyz="0 0 -1"/>
    <limit lower="0.05" upper="0.35" effort="1" velocity="1"/></joint>
</robot>"""
FIRST, SECOND = 1.0, 0.8  # m, links of planar_2r


def mapped(source, frame, **asked):
    model = source if isinstance(source, ks.Model) else ks.load(source)
    return capability_map(model, frame, ks.configuration(model).q, **asked)


@pytest.fixture(scope="module")
def planar():
    return mapped("textbook:planar_2r", "tool", low_discrepancy=400_000, axes="xy", voxel=0.1)


def distances(result):
    """Return the least and the greatest distance from the origin in each voxel of a plane, (a, b)."""
    x, y = (np.abs(axis) for axis in result.grid.axes[:2])
    half = result.grid.size / 2
    near = np.hypot(np.maximum(x - half, 0)[:, None], np.maximum(y - half, 0))
    return near, np.hypot((x + half)[:, None], y + half)


def smallest_singular_value(radius):
    """Return that of a planar arm whose tool is at a distance from its base, by the law of cosines."""
    folded = np.clip((radius**2 - FIRST**2 - SECOND**2) / (2 * FIRST * SECOND), -1, 1)
    total, product = radius**2 + SECOND**2, FIRST * SECOND * np.sqrt(1 - folded**2)
    return (np.sqrt(total + 2 * product) - np.sqrt(np.maximum(total - 2 * product, 0))) / 2


def test_a_planar_arm_reaches_its_annulus(planar):
    near, far = distances(planar)
    inside = (near >= FIRST - SECOND) & (far <= FIRST + SECOND)
    outside = (far < FIRST - SECOND) | (near > FIRST + SECOND)
    reached = planar.reached[..., 0]
    assert np.all(reached[inside])
    assert not np.any(reached[outside])
    # The voxels on the edge are as long as its circles are, and no more than two wide.
    area = np.pi * ((FIRST + SECOND) ** 2 - (FIRST - SECOND) ** 2)
    assert planar.dimensions == 2
    assert abs(planar.volume - area) < 2 * np.pi * 2 * FIRST * planar.grid.size


def test_every_configuration_is_counted(planar):
    assert planar.reach_count.sum() == planar.count == 400_000
    assert (planar.outside, planar.complete) == (0, True)


def test_singular_values_of_a_voxel_are_those_of_its_distances(planar):
    near, far = distances(planar)
    radii = np.clip(near[..., None] + (far - near)[..., None] * np.linspace(0, 1, 201), FIRST - SECOND, FIRST + SECOND)
    values = smallest_singular_value(radii)
    low, high = values.min(axis=-1) - 1e-4, values.max(axis=-1) + 1e-4
    best, mean, reached = (
        each[..., 0] for each in (planar.best_singular_value, planar.mean_singular_value, planar.reached)
    )
    assert np.all((best >= low)[reached])
    assert np.all((best <= high)[reached])
    assert np.all((mean <= best + planar.unit)[reached])
    assert np.all((mean >= low)[reached])
    assert np.all(np.isnan(best[~reached]))
    often = reached & (planar.reach_count[..., 0] > 100)
    assert np.all((high - best)[often] < 0.05)


def test_a_planar_map_is_its_own_mirror_image(planar):
    reached = planar.reached[..., 0]
    near, far = distances(planar)
    edge = ((near < FIRST - SECOND) & (far > FIRST - SECOND)) | ((near < FIRST + SECOND) & (far > FIRST + SECOND))
    assert np.array_equal(reached[::-1][~edge], reached[~edge])
    assert np.array_equal(reached.T[~edge], reached[~edge])


def test_a_planar_tool_points_one_way(planar):
    up = int(np.argmax(centres()[:, 2]))
    assert set(planar.directions[planar.reached].tolist()) == {1 << up}


def test_a_gantry_reaches_its_box():
    result = mapped(load_text(GANTRY), "tool", samples=50_000, axes="xyz", voxel=0.1)
    # From -0.35 to 1.15 m are voxels with middles from -0.3 to 1.1, and so on: 15 x 6 x 3.
    assert result.reach_count.shape == (15, 6, 3)
    assert np.all(result.reached)
    low, high = result.box
    np.testing.assert_allclose(low, [-0.35, 0.05, 0.65], atol=1e-9)
    np.testing.assert_allclose(high, [1.15, 0.65, 0.95], atol=1e-9)
    assert result.volume == pytest.approx(1.5 * 0.6 * 0.3)
    np.testing.assert_allclose(result.best_singular_value, 1, atol=1e-12)
    np.testing.assert_allclose(result.mean_singular_value, 1, atol=1e-6)
    counts = result.reach_count / 50_000 * 270
    assert abs(counts - 1).max() < 6 * np.sqrt(270 / 50_000)


@pytest.mark.parametrize(("robot", "frame"), [("example:ur5_robot", "tool0"), ("example:panda", "panda_hand")])
def test_a_voxel_keeps_its_best_configuration(robot, frame):
    model = ks.load(robot)
    q = ks.configuration(model, "random:3").q
    result = capability_map(model, frame, q, samples=80_000, length=0.3, point=(0.01, 0.02, 0.03))
    index = np.flatnonzero(result.reached)[::500]
    best = result.configurations(index, q)
    placed = ks.fk(model, frame, best)
    points = placed.matrix[..., :3, 3] + placed.matrix[..., :3, :3] @ (0.01, 0.02, 0.03)
    assert np.array_equal(result.grid.index(points), index)
    values = ks.manipulability(model, frame, best, length=0.3, point=(0.01, 0.02, 0.03)).blocks["full"]
    np.testing.assert_allclose(values.minimum_singular_value, result.best_singular_value.ravel()[index], atol=1e-12)
    bins = np.argmax(placed.matrix[..., :3, 2] @ centres().T, axis=-1)  # the nearest middle: not always its bin
    found = [int(result.directions.ravel()[i]) >> int(b) & 1 for i, b in zip(index, bins, strict=True)]
    assert np.mean(found) > 0.7
    held = [i for i in range(model.robot.nq) if i not in result.coordinates.indices]
    assert np.array_equal(best[:, held], np.broadcast_to(q[held], (len(best), len(held))))


def test_no_voxel_is_no_configuration():
    model = ks.load("textbook:planar_2r")
    result = mapped(model, "tool", samples=1000, axes="xy")
    q = np.array([0.25, -0.5])
    unreached = int(np.flatnonzero(~result.reached)[0])
    assert np.array_equal(result.configurations(np.array([-1, unreached]), q), [q, q])


ARRAYS = ("reach_count", "best_singular_value", "mean_singular_value", "directions", "best_row")


def test_any_number_of_workers_gives_the_same_bits():
    asked = {"samples": 200_000, "seed": 5, "length": "auto"}
    alone = mapped("example:ur5_robot", "tool0", **asked)
    with ThreadPoolExecutor(3) as executor:
        others = [
            mapped("example:ur5_robot", "tool0", workers=2, **asked),
            mapped("example:ur5_robot", "tool0", executor=executor, **asked),
        ]
    for other in others:
        assert other.grid.shape == alone.grid.shape
        for name in ARRAYS:
            assert getattr(other, name).tobytes() == getattr(alone, name).tobytes()


@pytest.mark.parametrize("approach", [(0, 0, -1), (3.0, 0, 0.5)])
def test_an_approach_keeps_what_arrives_from_there(approach):
    asked = {"samples": 100_000, "voxel": 0.2, "seed": 3}
    every, some = (
        mapped("example:ur5_robot", "tool0", **asked),
        mapped("example:ur5_robot", "tool0", approach=approach, **asked),
    )
    model, drawn = every.coordinates.model, every.source.rows(0, 100_000)
    placed = ks.fk(model, "tool0", every.coordinates.configuration(drawn, np.zeros(6))).matrix
    arrives = placed[:, :3, 2] @ approach / np.linalg.norm(approach) >= np.cos(np.radians(15))
    assert some.counted == some.reach_count.sum() == np.sum(arrives)
    assert (some.count, some.outside, every.counted) == (100_000, 0, 100_000)
    cells = some.grid.index(placed[arrives, :3, 3])
    np.testing.assert_array_equal(np.bincount(cells, minlength=some.grid.count), some.reach_count.ravel())
    assert np.all(
        some.directions.ravel()[cells] & ~every.directions.ravel()[every.grid.index(placed[arrives, :3, 3])] == 0
    )


def test_an_approach_that_none_has_is_told():
    with pytest.raises(UsageError, match="none of 2000 configurations"):
        mapped("textbook:planar_2r", "tool", samples=2000, axes="xy", approach=(1, 0, 0))
    for wrong in ((0, 0, 0), (1, 0), (math.nan, 0, 1), (math.inf, 0, 1)):
        with pytest.raises(UsageError, match="an approach is a direction"):
            mapped("textbook:planar_2r", "tool", samples=2000, axes="xy", approach=wrong)


def test_rows_in_the_axes_of_the_tool_count():
    asked = {"samples": 40_000, "axes": "xyz rx ry", "voxel": 0.2, "length": 0.3}
    local = mapped("example:ur5_robot", "tool0", reference="local", **asked)
    index = np.flatnonzero(local.reached)[::40]
    q = local.configurations(index, np.zeros(6))
    rows = ks.jacobian(local.coordinates.model, "tool0", q, reference="local").matrix[..., :5, :]
    values = np.linalg.svd(rows / np.array([0.3] * 3 + [1] * 2)[:, None], compute_uv=False)[..., -1]
    np.testing.assert_allclose(values, local.best_singular_value.ravel()[index], atol=1e-12)
    aligned = mapped("example:ur5_robot", "tool0", **asked)
    assert abs(np.nanmax(aligned.best_singular_value) - np.nanmax(local.best_singular_value)) > 1e-3


def test_more_configurations_add_to_the_map():
    fewer, more = (mapped("textbook:puma560", "tool", samples=n, length="auto", voxel=0.1) for n in (65536, 3 * 65536))
    at = more.grid.index(fewer.grid.centre(np.flatnonzero(fewer.reached)))
    there = np.flatnonzero(fewer.reached)
    assert np.all(at >= 0)
    assert np.all(more.reach_count.ravel()[at] >= fewer.reach_count.ravel()[there])
    assert np.all(more.best_singular_value.ravel()[at] >= fewer.best_singular_value.ravel()[there])
    assert np.all((fewer.directions.ravel()[there] & ~more.directions.ravel()[at]) == 0)
    assert more.unseen_share < fewer.unseen_share


def test_the_share_of_new_voxels_is_about_what_is_told():
    first, both = (mapped("example:ur5_robot", "tool0", samples=n, axes="xyz", voxel=0.1) for n in (65536, 2 * 65536))
    new = both.voxels - first.voxels
    assert first.unseen_share * 65536 * 0.4 < new < first.unseen_share * 65536  # it falls on the way


def test_pinocchio_finds_a_wrong_kernel(monkeypatch):
    right = Kernel.__call__

    def wrong(kernel, q):
        found = right(kernel, q)
        return {**found, "placement": found["placement"] + 1e-9}

    model = ks.load("textbook:planar_2r")
    assert mapped(model, "tool", samples=5000, axes="xy").certificate.agree is True
    monkeypatch.setattr(Kernel, "__call__", wrong)
    result = mapped(model, "tool", samples=5000, axes="xy")
    assert result.certificate.agree is False
    assert result.certificate.max_difference == pytest.approx(1e-9, rel=1e-3)


def test_without_crosscheck_nothing_is_checked():
    model = ks.load("textbook:planar_2r", crosscheck=False)
    result = mapped(model, "tool", samples=5000, axes="xy")
    assert (result.checked, result.certificate.agree) == (0, None)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({}, "one source"),
        ({"samples": 10, "low_discrepancy": 10}, "one source"),
        ({"samples": 0}, "between 1"),
        ({"samples": 10**11}, "at most"),
        ({"samples": 10, "voxel": 1e-5}, "would do"),
        ({"samples": 10, "voxel": float("nan")}, "voxel"),
        ({"samples": 10, "length": -1.0}, "length"),
        ({"samples": 10, "axes": "xq"}, "axis"),
        ({"samples": 10, "relative_to": "tool"}, "no joint"),
        ({"samples": 10, "workers": 0}, "worker"),
        ({"samples": 10, "seed": -1}, "seed"),
    ],
)
def test_what_cannot_be_is_refused(asked, message):
    with pytest.raises(UsageError, match=message):
        mapped("textbook:planar_2r", "tool", **asked)


def test_names_and_shapes_are_checked():
    model = ks.load("textbook:planar_2r")
    with pytest.raises(UnknownNameError, match="did you mean 'tool'"):
        capability_map(model, "tol", np.zeros(2), samples=10)
    with pytest.raises(ConfigurationError):
        capability_map(model, "tool", np.zeros(3), samples=10)


def test_one_configuration_is_a_map_too():
    result = mapped("textbook:planar_2r", "tool", samples=1, axes="xy")
    assert (result.voxels, result.grid.count, result.unseen_share) == (1, 1, 1.0)


def test_the_work_travels_and_goes_on(tmp_path, monkeypatch):
    works = []

    def kept(work, **running):
        works.append(work)
        return run(work, **running)

    monkeypatch.setattr("kinetostat.analysis.capability.capability_map.run", kept)
    mapped("example:ur5_robot", "tool0", samples=150_000, axes="xyz")
    mapped("example:ur5_robot", "tool0", samples=150_000, axes="xyz", seed=1)
    mapped("example:ur5_robot", "tool0", samples=150_000, axes="xyz", voxel=0.07)
    work = works[0]
    there = pickle.loads(pickle.dumps(work))
    assert len({there.digest, *(each.digest for each in works)}) == 3
    assert work.digest == there.digest
    for name, array in work.compute(1).state().items():
        assert array.tobytes() == there.compute(1).state()[name].tobytes()
    whole = run(work, checkpoint=tmp_path).partial.state()
    again = run(there, checkpoint=tmp_path)
    assert again.continued == 150_000
    for name, array in whole.items():
        assert array.tobytes() == again.partial.state()[name].tobytes()
