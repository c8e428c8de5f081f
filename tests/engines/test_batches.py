"""A batch of configurations is computed at once: the same numbers as one by one, and no more calls than for one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from inspect import isfunction
from itertools import count
from typing import Any

import numpy as np
import pytest

import kinetostat as ks
from engines.agreement import labels
from kinetostat.conventions import Velocity, WrenchOrTwist
from kinetostat.engines import screw as engine_module
from kinetostat.engines.protocol import Engine
from kinetostat.screw import adjoint, chain, se3, so3
from trees import random_tree

MANY = 1000


def deepest_tips(robot: ks.Robot) -> list[str]:
    """Return the tips, the one at the end of the longest way from the root first."""
    return sorted(robot.tips, key=lambda link: -len(list(robot.to_root(link))))


def has_everything(robot: ks.Robot) -> bool:
    """Whether every joint type, and a follower, lies between the two deepest tips."""
    tips = deepest_tips(robot)
    joints = [joint for joint, _ in robot.path(tips[0], tips[1])] if len(tips) > 1 else []
    return {joint.type for joint in joints} == set(ks.JointType) and any(joint.mimic for joint in joints)


@pytest.fixture(scope="module")
def model() -> ks.Model:
    trees = (random_tree(seed) for seed in count())
    return next(tree for tree in trees if has_everything(tree.robot))


@pytest.fixture(scope="module")
def velocity(model: ks.Model) -> Velocity:
    """A point of one tip, seen from another, in the axes of a third link."""
    tips = deepest_tips(model.robot)
    return Velocity(tips[0], tips[1], model.robot.links[1].name, (0.1, 0.2, 0.3))


def test_a_thousand_at_once_are_the_same_as_one_by_one(model: ks.Model, velocity: Velocity) -> None:
    engine, robot = model.witness, model.robot
    assert engine is not None
    q = ks.random_configurations(robot, 1, (MANY,))
    qdot = np.random.default_rng(1).uniform(-1, 1, (MANY, robot.nv))
    at_once = engine.placement(q, velocity.of, velocity.relative_to), engine.jacobian(q, velocity)
    rates = engine.jacobian_rate(q, qdot, velocity)
    assert rates.shape == (MANY, 6, robot.nv)
    for i in range(MANY):
        np.testing.assert_allclose(
            at_once[0][i], engine.placement(q[i], velocity.of, velocity.relative_to), rtol=0, atol=1e-14 * robot.reach
        )
        np.testing.assert_allclose(at_once[1][i], engine.jacobian(q[i], velocity), rtol=0, atol=1e-14 * robot.reach)
        if i % 20 == 0:
            one = engine.jacobian_rate(q[i], qdot[i], velocity)
            np.testing.assert_allclose(rates[i], one, rtol=0, atol=1e-13 * robot.reach)


# Every function of kinetostat.screw, by every name that the engine can call it by.
PURE = [
    (module, name)
    for module in (adjoint, chain, se3, so3, engine_module)
    for name, function in vars(module).items()
    if isfunction(function) and function.__module__.startswith("kinetostat.screw.")
]

QUESTIONS: dict[str, Callable[[Engine, np.ndarray, np.ndarray, Velocity], np.ndarray]] = {
    "placement": lambda e, q, _, v: e.placement(q, v.of, v.relative_to),
    "wrench change": lambda e, q, _, v: e.frame_change(q, v.of, v.relative_to, WrenchOrTwist.WRENCH),
    "jacobian": lambda e, q, _, v: e.jacobian(q, v),
    "jacobian rate": lambda e, q, qdot, v: e.jacobian_rate(q, qdot, v),
}


def counted(monkeypatch: pytest.MonkeyPatch, ask: Callable[[], np.ndarray]) -> Counter[str]:
    """Return how often each pure function is called while a question is answered."""
    calls: Counter[str] = Counter()

    def counting(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def wrapped(*arguments: Any, **options: Any) -> Any:
            calls[name] += 1
            return function(*arguments, **options)

        return wrapped

    with monkeypatch.context() as patch:
        for module, name in PURE:
            patch.setattr(module, name, counting(f"{module.__name__}.{name}", getattr(module, name)))
        ask()
    return calls


@pytest.mark.parametrize("question", QUESTIONS)
def test_calls_do_not_grow_with_the_number_of_configurations(
    question: str, model: ks.Model, velocity: Velocity, monkeypatch: pytest.MonkeyPatch
) -> None:
    engine, robot = model.witness, model.robot
    assert engine is not None
    counts = []
    for shape in ((), (2,), (50, 20)):
        q, qdot = ks.random_configurations(robot, 1, shape), np.zeros((*shape, robot.nv))
        counts.append(counted(monkeypatch, lambda q=q, qdot=qdot: QUESTIONS[question](engine, q, qdot, velocity)))
    assert counts[0] == counts[1] == counts[2]
    assert sum(counts[0].values()) >= len(model.robot.path(velocity.relative_to, velocity.of))


@pytest.mark.parametrize("shape", [(1,), (3,), (2, 3), (2, 1, 2)], ids=str)
def test_any_leading_shape_goes_through_both_engines(
    model: ks.Model, velocity: Velocity, shape: tuple[int, ...]
) -> None:
    q = ks.random_configurations(model.robot, 2, shape)
    qdot = np.random.default_rng(2).uniform(-1, 1, (*shape, model.robot.nv))
    assert model.witness is not None
    for engine in (model.engine, model.witness):
        for name, ask in QUESTIONS.items():
            batch = ask(engine, q, qdot, velocity)
            assert batch.shape[: len(shape)] == shape, name
            for index in np.ndindex(shape):
                one = ask(engine, q[index], qdot[index], velocity)
                np.testing.assert_allclose(batch[index], one, rtol=0, atol=1e-13 * model.robot.reach)


def test_one_configuration_goes_with_many_rates_and_many_with_one(model: ks.Model, velocity: Velocity) -> None:
    random = np.random.default_rng(3)
    few = ks.random_configurations(model.robot, 3, (2, 1)), random.uniform(-1, 1, (3, model.robot.nv))
    alone = few[0][0, 0], few[1][0]
    assert model.witness is not None
    for engine in (model.engine, model.witness):
        for q, qdot in (few, (alone[0], few[1]), (few[0], alone[1])):
            shape = np.broadcast_shapes(q.shape[:-1], qdot.shape[:-1])
            found = engine.jacobian_rate(q, qdot, velocity)
            full = np.broadcast_to(q, (*shape, q.shape[-1])), np.broadcast_to(qdot, (*shape, qdot.shape[-1]))
            np.testing.assert_allclose(
                found, engine.jacobian_rate(*full, velocity), rtol=0, atol=1e-13 * model.robot.reach
            )


def test_configurations_and_rates_are_not_written_to(model: ks.Model) -> None:
    q = ks.random_configurations(model.robot, 4, (3,))
    qdot = np.ones((3, model.robot.nv))
    kept = q.copy()
    assert model.witness is not None
    for engine in (model.engine, model.witness):
        for velocity in labels(model.robot, 4, 3):
            engine.jacobian_rate(q, qdot, velocity)
    np.testing.assert_array_equal(q, kept)
    np.testing.assert_array_equal(qdot, 1.0)


def test_answers_do_not_depend_on_what_was_asked_before(model: ks.Model, velocity: Velocity) -> None:
    """Pinocchio keeps its state between calls; none of it may leak into the next answer."""
    first, second = ks.random_configurations(model.robot, 5, (2,))
    assert model.witness is not None
    for engine in (model.engine, model.witness):
        before = engine.jacobian(first, velocity)
        engine.jacobian_rate(second, np.ones(model.robot.nv), velocity)
        engine.placement(second, velocity.of, velocity.relative_to)
        np.testing.assert_array_equal(engine.jacobian(first, velocity), before)
        assert not np.allclose(engine.jacobian(second, velocity), before)
