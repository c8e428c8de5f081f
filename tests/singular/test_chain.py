"""`screw.chain.Chain` against Pinocchio and against central differences, on random trees and between any two frames."""

import numpy as np
import pytest

import kinetostat as ks
from differences import derivative
from kinetostat.analysis.singular.mechanism import mechanism
from kinetostat.errors import UsageError
from singular.arms import columns, robot, tool, whole
from textbook_support import assert_same
from trees import random_tree

KINDS = ("revolute", "continuous", "prismatic", "fixed", "planar", "screw")
SEEDS = range(40)


def chains(seed, count=3):
    """Return some mechanisms of a random tree, observers mostly not ancestors of the tool."""
    model, random = random_tree(seed, kinds=KINDS), np.random.default_rng(seed)
    links, found = [link.name for link in model.robot.links], []
    for _ in range(8 * count):
        frame, observer = random.choice(links, 2)
        point = tuple(float(x) for x in random.uniform(-0.5, 0.5, 3))
        try:
            found.append(mechanism(model, str(frame), relative_to=str(observer), point=point))
        except UsageError:  # no joint between them, or one that never moves anything
            continue
        if len(found) == count:
            break
    return found


ALL = [arm for seed in SEEDS for arm in chains(seed)]


def spots(arm, seed, count=5):
    """Return random coordinates, zero among them."""
    q = np.random.default_rng(seed).uniform(-2, 2, (count, len(arm.names)))
    q[0] = 0
    return q


def size(arm, q):
    """Return what rounding is measured by: far slides and steep pitches make large numbers."""
    return max(1.0, float(np.max(np.abs(columns(arm, q)))))


def test_the_trees_have_everything():
    kinds = {joint.type.value for arm in ALL for joint in arm.joints}
    assert kinds == {"revolute", "continuous", "prismatic", "planar", "screw"}
    assert any(np.any(np.count_nonzero(arm.chain.fold, axis=0) > 1) for arm in ALL)  # leaders with followers
    roots = [arm for arm in ALL if arm.velocity.relative_to != arm.model.robot.root]
    assert len(roots) > 40
    assert len(ALL) > 90


@pytest.mark.parametrize("seed", SEEDS)
def test_the_jacobian_is_pinocchios(seed):
    for arm in chains(seed):
        q = spots(arm, seed)
        assert_same(arm.chain.jacobian(q), columns(arm, q), atol=1e-12 * size(arm, q))
        assert_same(arm.chain.columns(q)[1], tool(arm, q), atol=1e-12 * size(arm, q))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_jacobian_is_the_rate_of_pinocchios_placement(seed):
    for arm in chains(seed, count=2):
        q = spots(arm, seed, count=2)[-1]
        for j, column in enumerate(arm.chain.jacobian(q).T):
            along = np.eye(len(q))[j]
            rate = derivative(lambda times, q=q, along=along, arm=arm: tool(arm, q + np.outer(times, along)))
            spin = rate[:3, :3] @ tool(arm, q)[:3, :3].T
            expected = np.concatenate([rate[:3, 3], [spin[2, 1], spin[0, 2], spin[1, 0]]])
            assert_same(column, expected, atol=1e-9 * size(arm, q))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_derivatives_are_those_of_pinocchios_jacobian(seed):
    for arm in chains(seed, count=2):
        q = spots(arm, seed, count=2)
        matrix, along = arm.chain.derivatives(q)
        assert_same(matrix, arm.chain.jacobian(q), atol=1e-13 * size(arm, q))
        for j, unit in enumerate(np.eye(q.shape[-1])):
            rate = derivative(lambda times, unit=unit, arm=arm, q=q: columns(arm, q[1] + np.outer(times, unit)))
            assert_same(along[1, ..., j], rate, atol=1e-9 * size(arm, q) ** 2)


@pytest.mark.parametrize("seed", range(0, 40, 4))
def test_the_derivatives_in_pure_numbers(seed):
    """Of the task's rows, lengths in units of L: what search and kind are computed from."""
    for arm in chains(seed, count=1):
        q = spots(arm, seed, count=2)[-1]
        _, along = arm.derivatives(q)
        for j, unit in enumerate(np.eye(len(q)) * arm.units):
            rate = derivative(lambda times, unit=unit, arm=arm, q=q: arm.jacobian(q + np.outer(times, unit)), 1e-3)
            assert_same(along[..., j], rate, atol=1e-7 * max(1.0, float(np.max(np.abs(along)))))


def test_a_batch_of_any_shape():
    arm = ALL[3]
    q = np.random.default_rng(0).normal(size=(2, 3, len(arm.names)))
    each = np.array([[arm.chain.jacobian(one) for one in row] for row in q])
    assert_same(arm.chain.jacobian(q), each, atol=1e-13 * size(arm, q))
    assert arm.chain.derivatives(q)[1].shape == (2, 3, 6, len(arm.names), len(arm.names))
    assert arm.chain.jacobian(q[:0]).shape == (0, 3, 6, len(arm.names))


def test_coordinates_are_where_the_configuration_has_them():
    for arm in ALL:
        assert [arm.model.engine.position_names[i] for i in arm.indices] == list(arm.names)


def test_between_two_hands():
    """From one gripper to the other, up one arm and down the other."""
    model = robot("baxter")
    arm = mechanism(model, "right_hand_link", relative_to="left_hand_link")
    assert len(arm.names) == 14
    q = ks.random_configurations(model.robot, 5, (4,))[:, list(arm.indices)]
    assert_same(arm.chain.jacobian(q), columns(arm, q), atol=1e-11)
    assert np.allclose(whole(arm, q)[:, list(arm.indices)], q)
