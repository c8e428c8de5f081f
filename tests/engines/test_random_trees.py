"""The two engines agree on random trees: every joint type, chains of mimics, odd axes and names, any file order."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import kinetostat as ks
from engines.agreement import assert_agreement, assert_masses_agree, by_reference, labels
from trees import ALL_KINDS, load_text, random_tree, random_urdf, urdf_texts


def rates(robot: ks.Robot, seed: int, shape: tuple[int, ...] = ()) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-1, 1, (*shape, robot.nv)) / max(1, robot.nv)


@pytest.mark.parametrize("seed", range(40))
def test_engines_agree_on_every_frame(seed: int) -> None:
    model = random_tree(seed)
    q, qdot = ks.random_configurations(model.robot, seed, (20,)), rates(model.robot, seed, (20,))
    for link in model.robot.links:
        for velocity in by_reference(link.name, model.robot.root):
            assert_agreement(model, q, velocity, qdot)


@pytest.mark.parametrize("floating", [False, True], ids=["fixed base", "floating base"])
@pytest.mark.parametrize("seed", range(100, 140))
def test_engines_agree_on_any_observer_point_and_axes(seed: int, floating: bool) -> None:
    model = random_tree(seed, floating_base=floating)
    q, qdot = ks.random_configurations(model.robot, seed, (5,)), rates(model.robot, seed, (5,))
    for velocity in labels(model.robot, seed, 12):
        assert_agreement(model, q, velocity, qdot)


@settings(max_examples=120)
@given(urdf_texts(), st.booleans(), st.integers(0, 2**16))
def test_engines_agree_on_any_tree(text: str, floating: bool, seed: int) -> None:
    model = load_text(text, floating_base=floating)
    q, qdot = ks.random_configurations(model.robot, seed), rates(model.robot, seed)
    for velocity in labels(model.robot, seed, 6):
        assert_agreement(model, q, velocity, qdot)


@settings(max_examples=60)
@given(urdf_texts(most=4), st.integers(0, 2**16))
def test_engines_agree_on_any_small_tree(text: str, seed: int) -> None:
    """Small trees meet the edges: no joint, one joint, one column."""
    model = load_text(text)
    q, qdot = ks.random_configurations(model.robot, seed), rates(model.robot, seed)
    for velocity in labels(model.robot, seed, 3):
        assert_agreement(model, q, velocity, qdot)


@pytest.mark.parametrize("kind", ALL_KINDS)
@pytest.mark.parametrize("seed", range(3))
def test_engines_agree_on_trees_of_one_joint_type(kind: str, seed: int) -> None:
    model = random_tree(seed, kinds=(kind,), most=5)
    q, qdot = ks.random_configurations(model.robot, seed, (3,)), rates(model.robot, seed, (3,))
    for velocity in labels(model.robot, seed, 9):
        assert_agreement(model, q, velocity, qdot)


@pytest.mark.parametrize("kind", ALL_KINDS)
def test_engines_agree_on_a_single_joint(kind: str) -> None:
    model = random_tree(1, kinds=(kind,), most=1)
    q = ks.random_configurations(model.robot, 2, (3,))
    for velocity in labels(model.robot, 3, 6):
        assert_agreement(model, q, velocity, rates(model.robot, 4, (3,)))


@pytest.mark.parametrize("seed", range(60))
def test_engines_agree_on_masses(seed: int) -> None:
    assert_masses_agree(random_tree(seed))


@pytest.mark.parametrize("seed", range(10))
def test_engines_agree_on_masses_of_a_floating_base(seed: int) -> None:
    assert_masses_agree(random_tree(seed, floating_base=True))


@pytest.mark.parametrize("seed", range(10))
def test_engines_name_the_same_coordinates(seed: int) -> None:
    model = random_tree(seed, floating_base=True)
    assert model.witness is not None
    assert tuple(model.engine.position_names) == tuple(model.witness.position_names)
    assert tuple(model.engine.velocity_names) == tuple(model.witness.velocity_names)
    assert len(model.engine.position_names) == model.robot.nq
    assert len(model.engine.velocity_names) == model.robot.nv


def test_the_trees_are_what_they_are_meant_to_be() -> None:
    """A generator that quietly stopped making followers or floating joints would make every test above weaker."""
    seen: Counter[str] = Counter()
    for seed in range(40):
        robot = random_tree(seed).robot
        order = {joint.name: i for i, joint in enumerate(robot.joints)}
        for joint in robot.joints:
            seen[joint.type.value] += 1
            seen["odd name"] += not joint.name.isalnum()
            seen["name of a link"] += joint.name in robot.link_by_name
            seen["child before parent"] += any(
                order[above.name] > order[joint.name] for above in robot.to_root(joint.parent)
            )
            if joint.mimic is not None:
                leader = robot.joint_by_name[joint.mimic.joint]
                seen["follower"] += 1
                seen["follower before leader"] += order[joint.name] < order[leader.name]
                seen["chain of mimics"] += leader.mimic is not None
                seen["follower of another type"] += leader.type is not joint.type
                seen["multiplier 0"] += joint.mimic.multiplier == 0
                seen["multiplier below 0"] += joint.mimic.multiplier < 0
                seen["offset"] += joint.mimic.offset != 0
    wanted = {*ALL_KINDS, "odd name", "name of a link", "child before parent", "follower", "follower before leader"}
    wanted |= {"chain of mimics", "follower of another type", "multiplier 0", "multiplier below 0", "offset"}
    assert {what for what in wanted if seen[what] < 5} == set()


def test_a_seed_always_writes_the_same_tree() -> None:
    assert random_urdf(5) == random_urdf(5)
    assert random_urdf(5) != random_urdf(6)
