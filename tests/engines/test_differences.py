"""Jacobians are derivatives of placements, and their rates derivatives of Jacobians, as central differences show."""

from __future__ import annotations

import numpy as np
import pytest

import differences
import kinetostat as ks
from engines.agreement import by_reference, labels
from kinetostat.conventions import Velocity
from kinetostat.engines.protocol import Engine
from trees import random_tree

# Rounding of a six-point difference is about 2e-13 of the size of what is differenced, whatever moves.
WITNESSED = 2e-11


def engines(model: ks.Model) -> tuple[Engine, Engine]:
    assert model.witness is not None
    return model.engine, model.witness


def scale(model: ks.Model) -> float:
    """Return the reach, stretched by the positions that unlimited sliding joints are drawn at."""
    return max(1.0, 2 * model.robot.reach + model.robot.nv)


def assert_jacobian_is_the_derivative_of_the_placement(model: ks.Model, q: np.ndarray, velocity: Velocity) -> None:
    wanted = differences.jacobian(model.engine, model.robot, q, velocity)
    for engine in engines(model):
        np.testing.assert_allclose(engine.jacobian(q, velocity), wanted, rtol=0, atol=WITNESSED * scale(model))


def assert_rate_is_the_derivative_of_the_jacobian(model: ks.Model, q: np.ndarray, velocity: Velocity) -> None:
    qdot = np.random.default_rng(1).uniform(-1, 1, model.robot.nv)
    qdot /= max(1.0, np.abs(qdot).sum())
    for engine in engines(model):
        wanted = differences.jacobian_rate(engine, model.robot, q, qdot, velocity)
        np.testing.assert_allclose(
            engine.jacobian_rate(q, qdot, velocity), wanted, rtol=0, atol=WITNESSED * scale(model)
        )


@pytest.mark.parametrize("floating", [False, True], ids=["fixed base", "floating base"])
@pytest.mark.parametrize("seed", range(200, 225))
def test_jacobian_on_random_trees(seed: int, floating: bool) -> None:
    """Moving observers, moving axes, any point; mimics, planar and floating joints."""
    model = random_tree(seed, floating_base=floating)
    q = ks.random_configurations(model.robot, seed)
    for velocity in labels(model.robot, seed, 3):
        assert_jacobian_is_the_derivative_of_the_placement(model, q, velocity)


@pytest.mark.parametrize("floating", [False, True], ids=["fixed base", "floating base"])
@pytest.mark.parametrize("seed", range(300, 325))
def test_jacobian_rate_on_random_trees(seed: int, floating: bool) -> None:
    model = random_tree(seed, floating_base=floating)
    q = ks.random_configurations(model.robot, seed)
    for velocity in labels(model.robot, seed, 3):
        assert_rate_is_the_derivative_of_the_jacobian(model, q, velocity)


@pytest.mark.parametrize("kind", ["revolute", "continuous", "prismatic", "screw", "planar", "floating"])
def test_joint_by_joint(kind: str) -> None:
    """Trees of one joint type alone, so that a failure names the type."""
    for seed in range(3):
        model = random_tree(seed, kinds=(kind,), most=4)
        q = ks.random_configurations(model.robot, seed)
        for velocity in labels(model.robot, seed, 3):
            assert_jacobian_is_the_derivative_of_the_placement(model, q, velocity)
            assert_rate_is_the_derivative_of_the_jacobian(model, q, velocity)


@pytest.mark.parametrize("name", ["panda_description/panda", "tiago_description/tiago_no_hand", "pr2_description/pr2"])
def test_references_of_real_robots(name: str) -> None:
    model = ks.load(f"example:{name}")
    robot = model.robot
    tip = max(robot.tips, key=lambda link: len(list(robot.to_root(link))))
    q = ks.random_configurations(robot, 1)
    for velocity in by_reference(tip, robot.root):
        assert_jacobian_is_the_derivative_of_the_placement(model, q, velocity)
        assert_rate_is_the_derivative_of_the_jacobian(model, q, velocity)


def test_the_three_references_mean_what_they_say() -> None:
    """By the motion of points: aligned and local are of the frame's origin, world of the point at the observer."""
    model = ks.load("example:panda_description/panda")
    robot, frame = model.robot, "panda_hand"
    q, qdot = ks.random_configurations(robot, 3), np.random.default_rng(3).uniform(-1, 1, robot.nv)
    placement = ks.fk(model, frame, q).matrix
    moving = differences.derivative(lambda t: ks.fk(model, frame, differences.moved(robot, q, qdot, t)).matrix)
    spin = moving[:3, :3] @ placement[:3, :3].T
    origin, turning = moving[:3, 3], np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
    at_observer = origin - spin @ placement[:3, 3]
    back = placement[:3, :3].T
    wanted = {
        "aligned": np.concatenate([origin, turning]),
        "local": np.concatenate([back @ origin, back @ turning]),
        "world": np.concatenate([at_observer, turning]),
    }
    for reference, twist in wanted.items():
        found = ks.jacobian(model, frame, q, reference=reference, joints="all").matrix @ qdot
        np.testing.assert_allclose(found, twist, rtol=0, atol=1e-11)
