"""The two engines agree on every frame of every robot of example-robot-data."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

import kinetostat as ks
from engines.agreement import assert_agreement, assert_masses_agree, by_reference, labels
from kinetostat.urdf.files import example_robots

EMPTY = "ur_description/ur3"
ROBOTS = [name for name in example_robots() if name != EMPTY]


@lru_cache(maxsize=2)
def load(name: str, floating: bool = False) -> ks.Model:
    return ks.load(f"example:{name}", floating_base=floating)


def rates(robot: ks.Robot, count: int) -> np.ndarray:
    return np.random.default_rng(9).uniform(-1, 1, (count, robot.nv)) / max(1, robot.nv)


def test_the_robots_are_there() -> None:
    assert len(ROBOTS) >= 60


def test_the_empty_robot_is_refused() -> None:
    with pytest.raises(ks.RobotError, match="no link"):
        load(EMPTY)


@pytest.mark.parametrize("name", ROBOTS)
def test_every_frame_seen_from_the_root(name: str) -> None:
    model = load(name)
    q = ks.random_configurations(model.robot, 1, (20,))
    for link in model.robot.links:
        for i, velocity in enumerate(by_reference(link.name, model.robot.root)):
            assert_agreement(model, q, velocity, placements=i == 0)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_rate_of_every_frame_seen_from_the_root(name: str) -> None:
    model = load(name)
    q, qdot = ks.random_configurations(model.robot, 2, (3,)), rates(model.robot, 3)
    for link in model.robot.links:
        for velocity in by_reference(link.name, model.robot.root):
            assert_agreement(model, q, velocity, qdot, placements=False)


@pytest.mark.parametrize("floating", [False, True], ids=["fixed base", "floating base"])
@pytest.mark.parametrize("name", ROBOTS)
def test_some_frames_seen_from_others(name: str, floating: bool) -> None:
    model = load(name, floating)
    q, qdot = ks.random_configurations(model.robot, 3, (4,)), rates(model.robot, 4)
    for velocity in labels(model.robot, 4, 9):
        assert_agreement(model, q, velocity, qdot)


@pytest.mark.parametrize("name", ROBOTS)
def test_masses(name: str) -> None:
    assert_masses_agree(load(name))


@pytest.mark.parametrize("name", ROBOTS)
def test_certificates_say_that_they_agree(name: str) -> None:
    """What users see: the tip that lies deepest, by the functions that they call."""
    model = load(name)
    robot = model.robot
    tip = max(robot.tips, key=lambda link: len(list(robot.to_root(link))))
    q = ks.random_configurations(robot, 5)
    answers = [ks.fk(model, tip, q), ks.adjoint(model, tip, robot.root, q), ks.jacobian(model, tip, q)]
    answers.append(ks.jacobian(model, tip, q, reference="local", qdot=np.ones(robot.nv)))
    for answer in answers:
        assert answer.certificate.engines == ("pinocchio", "screw")
        assert answer.certificate.agree is True
