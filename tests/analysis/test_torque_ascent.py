"""Laws of the climb to the worst torques: it never falls, stays inside limits, and ends where no coordinate gains."""

from functools import cache

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.configuration import position_range
from kinetostat.analysis.torque_ascent import TorqueAscent
from kinetostat.analysis.worst_samples import compiled_torques, worst_samples
from kinetostat.engines.screw import ScrewEngine
from trees import random_tree

GRAVITY = np.array([1.0, -2.0, -9.0])
TREES = (611, 613, 617, 619, 631, 641)
SOURCES = ("example:panda", "example:ur5_robot", "example:double_pendulum_continuous", "textbook:stanford")


@cache
def ascent_of(what):
    """Return an ascent over the joints of a robot or of a random tree, the limits of turns without end left out."""
    model = ks.load(what) if isinstance(what, str) else random_tree(what)
    robot = model.robot
    joints = [joint for joint in robot.independent if joint.type.nq == 1]
    ends = [
        (-np.inf, np.inf) if j.type.is_angle and np.isinf(j.limit.range[0]) else position_range(robot, j)
        for j in joints
    ]
    tree = ScrewEngine(robot).tree([joint.name for joint in joints], ks.random_configurations(model, 7))
    return TorqueAscent(tree, GRAVITY, *np.array(ends).T)


def starts_of(ascent, count=60, seed=3):
    """Return random coordinates inside limits, some at their ends, the torque of each row, and its sign."""
    generator, n = np.random.default_rng(seed), len(ascent.lower)
    lower, upper = np.maximum(ascent.lower, -4), np.minimum(ascent.upper, 4)
    q = lower + (upper - lower) * np.clip(generator.uniform(-0.2, 1.2, (count, n)), 0, 1)
    columns = generator.integers(0, n, count)
    return q, columns, generator.choice([-1.0, 1.0], count)


def torque_of(ascent, q, columns):
    return ascent.tree.holding_torques(q, GRAVITY)[np.arange(len(q)), columns]


@pytest.mark.parametrize("what", [*TREES, *SOURCES])
def test_it_never_falls_and_tells_the_torque_where_it_ends(what):
    ascent = ascent_of(what)
    q, columns, signs = starts_of(ascent)
    before = q.copy()
    at, torques = ascent.climb(q, columns, signs)
    assert np.array_equal(q, before)
    scale = np.max(np.abs(ascent.tree.holding_torques(q, GRAVITY)))
    assert np.allclose(torques, torque_of(ascent, at, columns), rtol=0, atol=1e-12 * scale)
    assert np.all(signs * torques >= signs * torque_of(ascent, q, columns) - 1e-12 * scale)
    assert np.all((at >= ascent.lower) & (at <= ascent.upper))
    assert np.array_equal(at[:, ~ascent.free], q[:, ~ascent.free])


@pytest.mark.parametrize("what", [*TREES, *SOURCES])
def test_no_single_coordinate_gains_where_it_ends(what):
    ascent = ascent_of(what)
    at, torques = ascent.climb(*(given := starts_of(ascent, 12))[:1], *given[1:])
    _, columns, signs = given
    lower, upper = np.maximum(ascent.lower, -np.pi), np.minimum(ascent.upper, np.pi)
    scale = np.max(np.abs(ascent.tree.holding_torques(at, GRAVITY)))
    for j in np.flatnonzero(ascent.free):
        for position in np.linspace(lower[j], upper[j], 41):
            moved = at.copy()
            moved[:, j] = position
            assert np.all(signs * torque_of(ascent, moved, columns) <= signs * torques + 1e-7 * scale)


def test_coordinates_of_several_screws_and_of_screws_with_a_pitch_are_left():
    panda = ascent_of("example:panda")  # two fingers, one coordinate
    assert list(np.count_nonzero(panda.tree.fold, axis=0) > 1) == list(~panda.free)
    assert np.sum(~panda.free) == 1
    helical = ks.load("textbook:helical")
    tree = ScrewEngine(helical.robot).tree([j.name for j in helical.robot.independent], np.zeros(helical.robot.nq))
    ends = np.full(len(tree.fold.T), 1.0)
    assert not np.any(TorqueAscent(tree, GRAVITY, -ends, ends).free)


def test_rows_do_not_depend_on_each_other():
    ascent = ascent_of("example:ur5_robot")
    q, columns, signs = starts_of(ascent)
    _, together = ascent.climb(q, columns, signs)
    alone = [ascent.climb(q[i : i + 1], columns[i : i + 1], signs[i : i + 1])[1][0] for i in range(0, len(q), 7)]
    assert np.allclose(alone, together[::7], rtol=0, atol=1e-7 * np.max(np.abs(together)))


def test_none_is_no_climb():
    at, torques = ascent_of("example:ur5_robot").climb(np.empty((0, 6)), [], np.empty(0))
    assert at.shape == (0, 6)
    assert torques.shape == (0,)


@pytest.mark.parametrize("count", [1, 5, 400])
def test_the_worst_samples_are_those_of_a_sort(count, monkeypatch):
    monkeypatch.setattr("kinetostat.analysis.worst_samples._CHUNK", 37)
    ascent = ascent_of(TREES[0])
    q = starts_of(ascent, 200)[0]
    torques = ascent.tree.holding_torques(q, GRAVITY)
    rows, values = worst_samples(lambda part: ascent.tree.holding_torques(part, GRAVITY), q, count)
    assert rows.shape == values.shape == (q.shape[1], min(count, 200))
    for j in range(q.shape[1]):
        assert np.array_equal(np.abs(values[j]), np.sort(np.abs(torques[:, j]))[::-1][:count])
        assert np.array_equal(values[j], torques[rows[j], j])


@pytest.mark.parametrize("what", [TREES[1], "example:panda"])
def test_compiled_torques_are_those_of_the_tree(what):
    ascent = ascent_of(what)
    q = starts_of(ascent, 300)[0]
    expected = ascent.tree.holding_torques(q, GRAVITY)
    found = compiled_torques(ascent.tree, GRAVITY)(q)
    assert np.allclose(found, expected, rtol=0, atol=1e-12 * np.max(np.abs(expected)))
