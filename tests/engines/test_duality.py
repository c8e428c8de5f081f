"""Wrenches are dual to twists: power is the same in every frame, and so are the joint torques of a wrench."""

from __future__ import annotations

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.conventions import Velocity, WrenchOrTwist
from kinetostat.engines.protocol import Engine
from trees import random_tree

TWIST, WRENCH = WrenchOrTwist.TWIST, WrenchOrTwist.WRENCH
SEEDS = range(400, 420)


@pytest.fixture(params=["pinocchio", "screw"])
def which(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def engine_of(model: ks.Model, which: str) -> Engine:
    engine = {"pinocchio": model.engine, "screw": model.witness}[which]
    assert engine is not None
    assert engine.name == which
    return engine


def drawn(model: ks.Model, seed: int) -> tuple[np.random.Generator, np.ndarray, list[str]]:
    random = np.random.default_rng(seed)
    names = [model.robot.links[int(i)].name for i in random.integers(len(model.robot.links), size=4)]
    return random, ks.random_configurations(model.robot, seed), names


def allowed(model: ks.Model) -> float:
    return 1e-12 * max(1.0, model.robot.reach + model.robot.nv) ** 2


@pytest.mark.parametrize("seed", SEEDS)
def test_frame_changes_compose_over_three_frames(seed: int, which: str) -> None:
    model = random_tree(seed, floating_base=True)
    engine = engine_of(model, which)
    _, q, (a, b, c, _) = drawn(model, seed)
    for kind in (TWIST, WRENCH):
        over_b = engine.frame_change(q, b, c, kind) @ engine.frame_change(q, a, b, kind)
        np.testing.assert_allclose(engine.frame_change(q, a, c, kind), over_b, rtol=0, atol=allowed(model))
        there_and_back = engine.frame_change(q, b, a, kind) @ engine.frame_change(q, a, b, kind)
        np.testing.assert_allclose(there_and_back, np.eye(6), rtol=0, atol=allowed(model))


@pytest.mark.parametrize("seed", SEEDS)
def test_power_is_the_same_in_both_frames(seed: int, which: str) -> None:
    model = random_tree(seed, floating_base=True)
    engine = engine_of(model, which)
    random, q, (a, b, _, _) = drawn(model, seed)
    velocity, wrench = random.uniform(-1, 1, 6), random.uniform(-1, 1, 6)
    there = (engine.frame_change(q, a, b, WRENCH) @ wrench) @ (engine.frame_change(q, a, b, TWIST) @ velocity)
    assert there == pytest.approx(wrench @ velocity, abs=allowed(model))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_wrench_change_one_way_is_the_transposed_twist_change_the_other_way(seed: int, which: str) -> None:
    model = random_tree(seed)
    engine = engine_of(model, which)
    _, q, (a, b, _, _) = drawn(model, seed)
    np.testing.assert_allclose(
        engine.frame_change(q, a, b, WRENCH), engine.frame_change(q, b, a, TWIST).T, rtol=0, atol=allowed(model)
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_a_frame_change_carries_the_body_jacobian_to_any_frame(seed: int, which: str) -> None:
    """The twist of F in F's coordinates, carried to G, is that of F's point at G's origin, in G's axes."""
    model = random_tree(seed, floating_base=True)
    engine = engine_of(model, which)
    _, q, (f, g, observer, _) = drawn(model, seed)
    local = engine.jacobian(q, Velocity(f, observer, f))
    at_g = tuple(engine.placement(q, g, f)[:3, 3].tolist())
    there = engine.jacobian(q, Velocity(f, observer, g, at_g))
    np.testing.assert_allclose(engine.frame_change(q, f, g, TWIST) @ local, there, rtol=0, atol=allowed(model))


@pytest.mark.parametrize("seed", SEEDS)
def test_joint_torques_of_a_wrench_are_the_same_in_every_frame(seed: int, which: str) -> None:
    """tau . qdot = F . V with F given in one frame and carried to others, and the Jacobian of the body there."""
    model = random_tree(seed, floating_base=True)
    engine = engine_of(model, which)
    random, q, (f, g, observer, h) = drawn(model, seed)
    wrench, qdot = random.uniform(-1, 1, 6), random.uniform(-1, 1, model.robot.nv)
    local = engine.jacobian(q, Velocity(f, observer, f))
    torques = local.T @ wrench
    assert torques @ qdot == pytest.approx(wrench @ (local @ qdot), abs=allowed(model))
    for frame in (g, h, observer):
        point = None if frame == observer else tuple(engine.placement(q, frame, f)[:3, 3].tolist())
        there = engine.jacobian(q, Velocity(f, observer, frame, point))
        carried = engine.frame_change(q, f, frame, WRENCH) @ wrench
        np.testing.assert_allclose(there.T @ carried, torques, rtol=0, atol=allowed(model))
        assert torques @ qdot == pytest.approx(carried @ (there @ qdot), abs=allowed(model) * 10)


def test_rigidly_joined_frames_feel_the_same_torques(which: str) -> None:
    """Two frames of one body of a real robot, each with its own body Jacobian."""
    model = ks.load("example:ur_description/ur5_robot")
    engine, robot = engine_of(model, which), model.robot
    q, wrench = ks.random_configurations(robot, 1), np.array([1.0, -2.0, 3.0, -0.4, 0.5, 0.6])
    assert not robot.movable_path("tool0", "ee_link")
    torques = engine.jacobian(q, Velocity("tool0", robot.root, "tool0")).T @ wrench
    carried = engine.frame_change(q, "tool0", "ee_link", WRENCH) @ wrench
    again = engine.jacobian(q, Velocity("ee_link", robot.root, "ee_link")).T @ carried
    assert not np.allclose(carried, wrench)
    np.testing.assert_allclose(again, torques, rtol=0, atol=1e-13)


@pytest.mark.parametrize("seed", SEEDS)
def test_observer_and_observed_change_places_with_a_minus_sign(seed: int, which: str) -> None:
    """V of f relative to a is minus V of a relative to f, of the same point and in the same axes."""
    model = random_tree(seed, floating_base=True)
    engine = engine_of(model, which)
    _, q, (f, a, axes, _) = drawn(model, seed)
    seen = engine.jacobian(q, Velocity(f, a, axes, None))
    at_a = engine.jacobian(q, Velocity(a, f, axes, (0.0, 0.0, 0.0)))
    np.testing.assert_allclose(seen, -at_a, rtol=0, atol=allowed(model))


@pytest.mark.parametrize("seed", SEEDS)
def test_velocities_add_up_over_a_frame_between(seed: int, which: str) -> None:
    """V of f relative to a is V of f relative to b plus V of b relative to a, of one point in one set of axes."""
    model = random_tree(seed, floating_base=True)
    engine = engine_of(model, which)
    _, q, (f, b, a, axes) = drawn(model, seed)

    def at_a(of: str, observer: str) -> np.ndarray:
        """Of the point at a's origin."""
        point = tuple(engine.placement(q, a, of)[:3, 3].tolist())
        return engine.jacobian(q, Velocity(of, observer, axes, point))

    np.testing.assert_allclose(at_a(f, a), at_a(f, b) + at_a(b, a), rtol=0, atol=allowed(model))


@pytest.mark.parametrize("seed", SEEDS)
def test_a_frame_does_not_move_relative_to_itself(seed: int, which: str) -> None:
    model = random_tree(seed)
    engine = engine_of(model, which)
    _, q, (f, axes, _, _) = drawn(model, seed)
    velocity = Velocity(f, f, axes, (0.3, 0.2, -0.1))
    np.testing.assert_allclose(engine.jacobian(q, velocity), np.zeros((6, model.robot.nv)), rtol=0, atol=allowed(model))
