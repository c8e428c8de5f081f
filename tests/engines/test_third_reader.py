"""yourdfpy, a reader and forward kinematics that share nothing with either engine, puts every link where they do."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.urdf.files import example_robots

# None of them has a planar joint, which yourdfpy takes differently.
ROBOTS = {name: path for name, path in example_robots().items() if name != "ur_description/ur3"}
FOLLOWERS = {"baxter_description/baxter", "panda_description/panda", "pr2_description/pr2", "romeo_description/romeo"}


@pytest.fixture(scope="module")
def yourdfpy() -> Any:
    """The module. It and what it pulls in (trimesh, networkx) warn of things that are not ours."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pytest.importorskip("yourdfpy")


def read(yourdfpy: Any, path: Path) -> Any:
    with warnings.catch_warnings(), path.open("rb") as file:
        warnings.simplefilter("ignore")
        return yourdfpy.URDF.load(
            file,
            load_meshes=False,
            load_collision_meshes=False,
            build_scene_graph=True,
            build_collision_scene_graph=False,
        )


@pytest.mark.parametrize("name", ROBOTS)
def test_every_link_is_where_yourdfpy_puts_it(name: str, yourdfpy: Any) -> None:
    model, foreign = ks.load(f"example:{name}"), read(yourdfpy, ROBOTS[name])
    robot, known = model.robot, set(foreign.actuated_joint_names)
    for seed in range(3):
        q = ks.random_configurations(robot, seed)
        for joint in robot.independent:
            if joint.name not in known:  # it follows a joint that does not exist: yourdfpy holds it at its offset
                assert any(joint.line == remark.line and "does not exist" in remark.text for remark in robot.remarks)
                q[robot.position_slices[joint.name]] = foreign.joint_map[joint.name].mimic.offset
        positions = {
            j.name: float(q[robot.position_slices[j.name].start]) for j in robot.independent if j.name in known
        }
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            foreign.update_cfg(positions)
            wanted = np.stack([foreign.get_transform(link.name, robot.root) for link in robot.links])
        assert model.witness is not None
        for engine in (model.engine, model.witness):
            found = np.stack([engine.placement(q, link.name, robot.root) for link in robot.links])
            np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-13 * max(1.0, robot.reach))


def test_there_are_followers_among_them() -> None:
    for name in FOLLOWERS:
        assert ks.load(f"example:{name}").robot.followers
