"""Analytic Jacobians: the rates of all 12 Euler sequences, read both ways, are the derivatives of their angles."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

import differences
import kinetostat as ks
from kinetostat.analysis.euler import sequence_names
from kinetostat.conventions import Velocity
from kinetostat.screw import so3
from trees import load_text, random_tree

SEQUENCES = sequence_names()
FREE = '<robot name="free"><link name="body"/></robot>'


@lru_cache(maxsize=1)
def free_body() -> ks.Model:
    """A body that flies freely, so that every rotation can be had."""
    return load_text(FREE, floating_base=True)


def turned(rotation: np.ndarray) -> np.ndarray:
    """Return the configurations of the free body with given rotations."""
    quaternion = so3.to_quaternion(rotation)
    return np.concatenate([np.full((*quaternion.shape[:-1], 3), 0.3), quaternion], -1)


def composed(name: str, angles: np.ndarray) -> np.ndarray:
    """Return the rotation that the name of a sequence and its listed angles stand for, letter by letter."""
    letters = "xyz" if name == "rpy" else name.removeprefix("fixed-")
    rotation = np.eye(3)
    for i, letter in enumerate(letters):
        axis = np.eye(3)["xyz".index(letter)]
        turn = so3.exp(axis * angles[..., i, None])
        # About fixed axes a later turn is done from outside; about moved ones, from inside.
        rotation = turn @ rotation if name == "rpy" or name.startswith("fixed-") else rotation @ turn
    return rotation


def singular_angle(name: str) -> float:
    """Return a second angle at which the sequence has no rates."""
    return 0.0 if ks.EulerSequence.named(name).proper else np.pi / 2


def regular_configuration(model: ks.Model, frame: str, observer: str, sequence: ks.EulerSequence) -> np.ndarray:
    """Return a configuration in which the angles are far from their singularity."""
    q = ks.random_configurations(model.robot, 0, (200,))
    steepness = sequence.singularity(model.engine.placement(q, frame, observer)[:, :3, :3])
    assert steepness.max() > 0.5
    return q[int(np.argmax(steepness > 0.5))]


@pytest.fixture(params=["puma-like arm", "tree with mimics and a moving observer"])
def arm(request: pytest.FixtureRequest) -> tuple[ks.Model, str, str]:
    """A robot, a frame and an observer between which every rotation is possible."""
    if request.param == "puma-like arm":
        model = ks.load("example:ur_description/ur5_robot")
        return model, "tool0", model.robot.root
    model = random_tree(5, floating_base=True)
    return model, model.robot.tips[0], model.robot.tips[-1]


def test_there_are_twelve_sequences_read_two_ways_and_rpy() -> None:
    assert len(SEQUENCES) == len(set(SEQUENCES)) == 25


@pytest.mark.parametrize("name", SEQUENCES)
def test_angles_compose_to_the_rotation(name: str) -> None:
    rotations = so3.exp(np.random.default_rng(2).normal(size=(200, 3)) * 2)
    angles = ks.EulerSequence.named(name).angles(rotations)
    np.testing.assert_allclose(composed(name, angles), rotations, rtol=0, atol=1e-13)
    assert np.max(np.abs(angles)) <= np.pi


@pytest.mark.parametrize("name", SEQUENCES)
def test_angles_compose_to_the_rotation_near_their_singularity_too(name: str) -> None:
    """Also of rotations that came about by other turns, whose entries carry rounding errors of their own."""
    elsewhere = so3.exp(np.array([0.3, -1.1, 0.7]))
    angles = np.random.default_rng(3).uniform(-3, 3, (70, 3))
    angles[:, 1] = singular_angle(name) + np.repeat([0.0, 1e-15, -1e-13, 1e-10, 1e-8, 1e-6, -1e-3], 10)
    rotations = elsewhere.T @ (elsewhere @ composed(name, angles))
    found = ks.EulerSequence.named(name).angles(rotations)
    np.testing.assert_allclose(composed(name, found), rotations, rtol=0, atol=8e-15)


def test_an_intrinsic_sequence_is_the_fixed_one_read_backwards() -> None:
    rotations = so3.exp(np.random.default_rng(4).normal(size=(20, 3)))
    for name in SEQUENCES:
        if name != "rpy" and not name.startswith("fixed-"):
            fixed = ks.EulerSequence.named(f"fixed-{name[::-1]}").angles(rotations)
            np.testing.assert_array_equal(ks.EulerSequence.named(name).angles(rotations), fixed[:, ::-1])


def test_rpy_is_what_urdf_means() -> None:
    rpy = np.array([0.3, -1.2, 2.5])
    np.testing.assert_allclose(ks.EulerSequence.named("rpy").angles(so3.from_rpy(rpy)), rpy, rtol=0, atol=1e-15)


@pytest.mark.parametrize("name", SEQUENCES)
def test_analytic_jacobian_is_the_derivative_of_the_angles(name: str, arm: tuple[ks.Model, str, str]) -> None:
    model, frame, observer = arm
    sequence = ks.EulerSequence.named(name)
    q = regular_configuration(model, frame, observer, sequence)
    found = ks.jacobian(model, frame, q, relative_to=observer, rates=name, joints="all")
    assert found.certificate.agree is True
    velocity = Velocity(frame, observer, observer)
    rates = differences.rates_of_angles(model.engine, model.robot, q, velocity, sequence.angles)
    np.testing.assert_allclose(found.matrix[3:], rates, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(found.matrix[:3], model.engine.jacobian(q, velocity)[:3])


@pytest.mark.parametrize("name", SEQUENCES)
def test_rate_of_the_analytic_jacobian_is_its_derivative(name: str, arm: tuple[ks.Model, str, str]) -> None:
    model, frame, observer = arm
    robot = model.robot
    q = regular_configuration(model, frame, observer, ks.EulerSequence.named(name))
    qdot = np.random.default_rng(6).uniform(-1, 1, robot.nv) / robot.nv

    def analytic(configuration: np.ndarray, qdot: np.ndarray | None = None) -> ks.Jacobian:
        return ks.jacobian(model, frame, configuration, relative_to=observer, rates=name, joints="all", qdot=qdot)

    found = analytic(q, qdot)
    assert found.certificate.agree is True
    wanted = differences.derivative(lambda t: analytic(differences.moved(robot, q, qdot, t)).matrix)
    np.testing.assert_allclose(found.time_derivative, wanted, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", SEQUENCES)
def test_angles_have_no_rates_at_their_singularity(name: str) -> None:
    model, ends = free_body(), (singular_angle(name), singular_angle(name) - np.pi)
    for second in (end + away for end in ends for away in (0.0, 1e-13, 1e-10)):
        q = turned(composed(name, np.array([0.4, second, -1.3])))
        with pytest.raises(ks.RepresentationError, match="no rates"):
            ks.jacobian(model, "body", q, rates=name)


@pytest.mark.parametrize("name", SEQUENCES)
def test_one_singular_configuration_of_many_is_enough(name: str) -> None:
    angles = np.array([[0.4, 0.8, -1.3], [0.4, singular_angle(name), -1.3], [0.1, 0.7, 0.2]])
    q = turned(composed(name, angles))
    with pytest.raises(ks.RepresentationError):
        ks.jacobian(free_body(), "body", q, rates=name)
    assert ks.jacobian(free_body(), "body", q[[0, 2]], rates=name).certificate.agree is True


@pytest.mark.parametrize("away", [1e-7, 1e-4, 1e-2])
@pytest.mark.parametrize("name", SEQUENCES)
def test_near_their_singularity_rates_are_steep_but_certified(name: str, away: float) -> None:
    q = turned(composed(name, np.array([0.4, singular_angle(name) + away, -1.3])))
    found = ks.jacobian(free_body(), "body", q, rates=name, qdot=np.linspace(-1, 1, 6))
    assert found.certificate.agree is True
    assert np.max(np.abs(found.matrix)) == pytest.approx(1 / away, rel=0.5)
    assert bool(found.warnings) == (away < 1e-3)
