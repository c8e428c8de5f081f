"""Compiled kernels against both engines: all real robots, random and singular configurations, to stated accuracies."""

from __future__ import annotations

import functools

import numpy as np
import pytest

import kinetostat
from kinetostat.analysis.configuration import neutral
from kinetostat.analysis.coordinates import Coordinates, coordinates
from kinetostat.analysis.kernels import chain_kernel
from kinetostat.analysis.task import FULL, Task
from kinetostat.conventions import GRAVITY, Reference
from kinetostat.engines.model import Model
from kinetostat.urdf.description import JointType
from kinetostat.urdf.files import example_robots

ROBOTS = [name for name in example_robots() if name != "ur_description/ur3"]  # which is empty
WANTED = ("placement", "jacobian", "singular_values", "yoshikawa", "gravity_torque")


@functools.cache
def loaded(name: str) -> Model:
    return kinetostat.load(name)


def farthest(model: Model) -> str:
    """Return the tip with the most joints before it."""
    return max(model.robot.tips, key=lambda tip: len(model.robot.movable_path(model.robot.root, tip)))


def check(model: Model, frame: str, chain: Coordinates, q: np.ndarray, names: tuple[str, ...] = WANTED) -> None:
    """Hold everything that the kernel gives against both engines."""
    robot, rest = model.robot, neutral(model.robot)
    found = chain_kernel(chain, names, rest)(q)
    whole = chain.configuration(q, rest)
    columns = robot.velocity_columns(dict.fromkeys(chain.joints))
    slack = 1e-13 * max(1.0, robot.reach) * robot.largest_multiplier
    witness = model.witness
    assert witness is not None
    for engine in (model.engine, witness):
        placement = engine.placement(whole, frame, robot.root)
        np.testing.assert_allclose(found["placement"], placement[:, :3], rtol=0, atol=10 * slack)
        jacobian = engine.jacobians(whole, [frame], Reference.ALIGNED)[:, 0][..., columns]
        np.testing.assert_allclose(found["jacobian"], jacobian, rtol=0, atol=10 * slack)
        values = np.linalg.svd(jacobian, compute_uv=False)
        np.testing.assert_allclose(found["singular_values"], values, rtol=0, atol=10 * slack)
        size = np.prod(np.maximum(values, 1.0), axis=1)
        np.testing.assert_array_less(np.abs(found["yoshikawa"] - np.prod(values, axis=1)), 100 * slack * size + 1e-300)
        if "gravity_torque" in names:
            torques = engine.holding_torques(whole, np.array(GRAVITY), [])[:, columns]
            weight = max(1.0, 9.81 * sum(map(abs, engine.masses())))
            np.testing.assert_allclose(found["gravity_torque"], torques, rtol=0, atol=10 * slack * weight)


@pytest.mark.parametrize("name", ROBOTS)
def test_kernels_of_real_robots(name: str) -> None:
    model = loaded(f"example:{name}")
    frame = farthest(model)
    joints = model.robot.movable_path(model.robot.root, frame)
    if not joints or any(joint.type in (JointType.PLANAR, JointType.FLOATING) for joint in joints):
        pytest.skip("nothing moves, or it floats: no chain of coordinates")
    chain = coordinates(model, frame, model.robot.root)
    heavy = any(link.inertial is not None and link.inertial.mass < 0 for link in model.robot.links)
    random, zero = np.random.default_rng(0), np.zeros((1, len(chain.names)))
    q = np.concatenate([chain.draw(random, (40,)), chain.draw(random, (40,), limited=True), zero])
    check(model, frame, chain, q, tuple(name for name in WANTED if not (heavy and name == "gravity_torque")))


@pytest.mark.parametrize(
    ("name", "frame", "q"),
    [
        ("example:ur5_robot", "tool0", [0.3, -0.5, 0.0, 0.2, 1.0, 0.0]),
        ("example:ur5_robot", "tool0", [0.3, -0.5, 1.0, 0.2, 0.0, 0.0]),
        ("example:panda", "panda_hand", [0.0] * 7),
        ("textbook:planar_2r", "tool", [0.7, 0.0]),
        ("textbook:planar_2r", "tool", [0.7, np.pi]),
    ],
)
def test_singular_configurations(name: str, frame: str, q: list[float]) -> None:
    """The smallest singular value is zero to the last digits of the largest, not to their root."""
    model = loaded(name)
    chain = coordinates(model, frame, model.robot.root)
    whole = chain.configuration(np.array(q), neutral(model.robot))
    planar = len(q) == 2
    kernel = chain_kernel(chain, ("singular_values",), neutral(model.robot), task=Task.named("xy") if planar else FULL)
    found = kernel(np.array([q]))["singular_values"][0]
    assert found[-1] < 1e-15 * max(1.0, found[0])
    blocks = kinetostat.manipulability(model, frame, whole, axes="xy" if planar else "xyzrxryrz").blocks
    np.testing.assert_allclose(found, blocks["task"].singular_values, atol=1e-14)


@pytest.mark.parametrize("distance", [1e-3, 1e-6, 1e-9, 1e-12])
def test_small_singular_values_on_the_way_into_a_singularity(distance: float) -> None:
    """sigma_min of the 2R arm at q2 = d is l1 l2 |sin d| / sigma_max: all its digits, where J J^T has lost them."""
    model = loaded("textbook:planar_2r")
    chain = coordinates(model, "tool", model.robot.root)
    kernel = chain_kernel(chain, ("singular_values", "yoshikawa"), neutral(model.robot), task=Task.named("xy"))
    found = kernel(np.array([[0.4, distance]]))
    first, second = found["singular_values"][0]
    assert first * second == pytest.approx(1.0 * 0.8 * np.sin(distance), rel=1e-3 if distance < 1e-11 else 1e-6)
    assert found["yoshikawa"][0] == pytest.approx(first * second, rel=1e-3 if distance < 1e-11 else 1e-6)
