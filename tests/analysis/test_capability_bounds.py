"""Bounds of a chain hold for every configuration, and are tight where the geometry is plain."""

import math

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.capability.bounds import bounds
from kinetostat.analysis.coordinates import coordinates
from kinetostat.analysis.kernels import chain_kernel
from trees import ALL_KINDS, load_text, random_urdf

KINDS = tuple(kind for kind in ALL_KINDS if kind != "floating")
OUTPUTS = ("placement", "jacobian", "singular_values")


def bounded(model, frame, *, point=(0.0, 0.0, 0.0), length=None):
    """Return a chain's kernel, its coordinates, and their bounds."""
    chain = coordinates(model, frame, model.robot.root, point)
    kernel = chain_kernel(chain, OUTPUTS, ks.configuration(model).q, length=length)
    return kernel, chain, bounds(kernel, *chain.limits)


def extreme_rows(chain, count, seed=0):
    """Return random coordinates, and ones with each coordinate at one of its ends."""
    generator = np.random.default_rng(seed)
    lower, upper = chain.limits
    inside = chain.draw(generator, (count,), limited=True)
    ends = np.where(generator.random((count, len(lower))) < 0.5, lower, upper)
    return np.vstack([inside, ends])


def assert_held(kernel, chain, found):
    values = kernel.definition(extreme_rows(chain, 300))
    points, scale = values["placement"][..., 3], 1 + np.max(np.abs([found.low, found.high]))
    assert np.all(points >= found.low - 1e-12 * scale)
    assert np.all(points <= found.high + 1e-12 * scale)
    weighed = kernel.weighed(values["jacobian"])
    assert np.linalg.norm(weighed, axis=(-2, -1)).max() <= found.jacobian * (1 + 1e-12)


def test_no_configuration_of_a_random_tree_is_outside():
    checked = 0
    for seed in range(40):
        model = load_text(random_urdf(seed, kinds=KINDS))
        for link in model.robot.links[-4:]:
            if model.robot.movable_path(model.robot.root, link.name):
                assert_held(*bounded(model, link.name, point=(0.1, -0.2, 0.3), length=(None, 0.3)[seed % 2]))
                checked += 1
    assert checked > 60


@pytest.mark.parametrize(
    ("robot", "frame"),
    [
        ("example:ur5_robot", "tool0"),
        ("example:panda", "panda_hand"),
        ("example:pr2", "r_gripper_tool_frame"),
        ("example:tiago", "arm_7_link"),
        ("textbook:stanford", "tool"),
        ("textbook:helical", "tool"),
    ],
)
def test_no_configuration_of_a_real_robot_is_outside(robot, frame):
    model = ks.load(robot)
    frame = frame if frame in model.robot.parent_joint else model.robot.default_tip()
    assert_held(*bounded(model, frame))


def test_a_planar_arm_is_bounded_by_its_links():
    _, _, found = bounded(ks.load("textbook:planar_2r"), "tool")
    np.testing.assert_allclose(found.high[:2], 1.8, atol=1e-12)
    np.testing.assert_allclose(found.low[:2], -1.8, atol=1e-12)
    # Stretched, J has columns (0, 1.8 ; 1) and (0, 0.8 ; 1) but for the rows that are zero.
    assert found.jacobian == pytest.approx(math.sqrt(1.8**2 + 0.8**2 + 2), rel=1e-12)
