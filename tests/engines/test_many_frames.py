"""Placements and Jacobians of many frames at once are those of each frame alone, in both engines."""

from __future__ import annotations

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.conventions import Reference, Velocity
from trees import load_text, random_urdf


@pytest.mark.parametrize("which", ["engine", "witness"])
@pytest.mark.parametrize("seed", range(8))
def test_many_frames_are_each_frame_alone(seed, which):
    model = load_text(random_urdf(seed))
    engine, robot = getattr(model, which), model.robot
    frames = [link.name for link in robot.links]
    q = ks.random_configurations(robot, seed, (2, 2))
    scale = 1e-12 * max(1.0, robot.reach) * robot.largest_multiplier
    found = engine.placements(q, frames)
    assert found.shape == (2, 2, len(frames), 4, 4)
    for i, frame in enumerate(frames):
        np.testing.assert_allclose(found[:, :, i], engine.placement(q, frame, robot.root), rtol=0, atol=scale)
    for reference in Reference:
        matrices = engine.jacobians(q, frames, reference)
        assert matrices.shape == (2, 2, len(frames), 6, robot.nv)
        for i, frame in enumerate(frames):
            alone = engine.jacobian(q, Velocity.by_reference(reference, frame, robot.root))
            np.testing.assert_allclose(matrices[:, :, i], alone, rtol=0, atol=scale)


@pytest.mark.parametrize("which", ["engine", "witness"])
def test_shapes_at_the_edges(which):
    still = getattr(ks.load("textbook:rigid_body"), which)
    assert still.placements(np.zeros((3, 0)), []).shape == (3, 0, 4, 4)
    panda = ks.load("example:panda")
    engine, q = getattr(panda, which), np.zeros(panda.robot.nq)
    assert engine.placements(q, ["panda_hand"]).shape == (1, 4, 4)
    assert engine.jacobians(q, [], Reference.LOCAL).shape == (0, 6, panda.robot.nv)
    assert engine.jacobians(np.zeros((0, panda.robot.nq)), ["panda_hand"], Reference.WORLD).shape == (
        0,
        1,
        6,
        panda.robot.nv,
    )


@pytest.mark.parametrize("which", ["engine", "witness"])
def test_the_link_of_a_floating_base_is_a_frame(which):
    model = ks.load("example:panda", floating_base=True)
    engine, q = getattr(model, which), ks.random_configurations(model.robot, 0)
    assert np.array_equal(engine.placements(q, ["universe"])[0], np.eye(4))
    assert not np.any(engine.jacobians(q, ["universe"], Reference.ALIGNED))
