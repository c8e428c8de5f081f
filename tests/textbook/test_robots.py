"""The textbook robots as files: complete, tidy, and known to SOURCES.md."""

import math
from pathlib import Path

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.lint.linting import oddities
from kinetostat.urdf.files import textbook_robots
from textbook_support import certified, textbook

ROBOTS = textbook_robots()
FRAMES = {"tool", "a", "b"}  # links that are frames alone, without a mass
# What is odd about a file on purpose: the rules that say so.
REMARKS = {
    "puma560": ["I203"],  # the published inertia of link 3
    "helical": ["X309"],  # screw joints, which are Drake's
    "modern_robotics_hhhh": ["X309"],
    "rigid_body": ["T109"],  # no joint can move
}


def test_all_rows_have_their_robots():
    assert set(ROBOTS) == {
        "anthropomorphic",
        "helical",
        "isotropic_3r",
        "modern_robotics_hhhh",
        "planar_1r",
        "planar_2r",
        "planar_2r_6_3",
        "planar_2r_isotropic",
        "planar_3r",
        "pr",
        "puma560",
        "rigid_body",
        "rp",
        "scara",
        "skew_1p",
        "stanford",
        "torus_3r",
        "wrist_three_roll",
        "wrist_zyz",
    }


@pytest.mark.parametrize("name", ROBOTS)
def test_robot_is_named_as_its_file_and_nothing_is_odd_about_it(name):
    model = textbook(name)
    assert model.robot.name == name
    assert [finding.code for finding in oddities(model)] == REMARKS.get(name, [])


@pytest.mark.parametrize("name", ROBOTS)
def test_joints_have_limits(name):
    for joint in textbook(name).robot.independent:
        assert joint.limit.effort > 0
        assert joint.limit.velocity > 0
        if joint.type in (ks.JointType.REVOLUTE, ks.JointType.PRISMATIC):
            assert all(math.isfinite(end) for end in joint.limit.range)


@pytest.mark.parametrize("name", ROBOTS)
def test_moving_links_have_masses_and_positive_inertias(name):
    robot = textbook(name).robot
    bodies = [link for link in robot.links if link.name not in FRAMES | {"base"}]
    assert bodies
    for link in bodies:
        assert link.inertial.mass > 0
        ixx, ixy, ixz, iyy, iyz, izz = link.inertial.inertia
        assert np.all(np.linalg.eigvalsh([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]) > 0)


@pytest.mark.parametrize("name", ROBOTS)
def test_tip_is_the_tool(name):
    assert set(textbook(name).robot.tips) == ({"a", "b"} if name == "rigid_body" else {"tool"})


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("wanted", ["zero", "mid", "random:1"])
def test_engines_agree_everywhere(name, wanted):
    model = textbook(name)
    q = ks.configuration(model.robot, wanted).q
    for frame in model.robot.link_by_name:
        placement = certified(ks.fk(model, frame, q))
        assert abs(np.linalg.det(placement[:3, :3]) - 1) < 1e-13
        jacobian = certified(ks.jacobian(model, frame, q, joints="all", qdot=np.linspace(1, 2, model.robot.nv)))
        assert jacobian.shape == (6, model.robot.nv)


def test_sources_tell_of_every_robot():
    text = (Path(ROBOTS["planar_1r"]).parent / "SOURCES.md").read_text(encoding="utf-8")
    for name in ROBOTS:
        assert f"`{name}`" in text
