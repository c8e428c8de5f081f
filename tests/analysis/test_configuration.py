"""Configurations as the library gives them."""

import math

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.configuration import contradicted
from kinetostat.urdf.document import parse
from kinetostat.urdf.files import example_robots
from kinetostat.urdf.reader import read

EVERYTHING = b"""<robot name="all">
  <link name="a"/><link name="b"/><link name="c"/><link name="d"/><link name="e"/><link name="f"/><link name="g"/>
  <joint name="free" type="floating"><parent link="a"/><child link="b"/></joint>
  <joint name="flat" type="planar"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/></joint>
  <joint name="turn" type="continuous"><parent link="c"/><child link="d"/><axis xyz="0 0 1"/></joint>
  <joint name="half" type="prismatic"><parent link="d"/><child link="e"/><axis xyz="0 0 1"/>
    <limit lower="2" upper="inf" effort="1" velocity="1"/></joint>
  <joint name="lead" type="revolute"><parent link="e"/><child link="f"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="follow" type="revolute"><parent link="f"/><child link="g"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="1" effort="1" velocity="1"/><mimic joint="lead" multiplier="-2" offset="0.5"/></joint>
</robot>"""


@pytest.fixture
def robot():
    return read(parse(EVERYTHING, "all.urdf"))


def test_the_order_is_that_of_the_file(robot):
    assert robot.nq == 7 + 3 + 1 + 1 + 1
    assert robot.nv == 6 + 3 + 1 + 1 + 1
    assert [joint.name for joint in robot.independent] == ["free", "flat", "turn", "half", "lead"]


def test_zero_has_unit_quaternions(robot):
    q = ks.configuration(robot, "zero").q
    assert q.tolist() == [0, 0, 0, 0, 0, 0, 1, *[0] * 6]


def test_mid_takes_the_nearest_to_zero_where_a_limit_is_missing(robot):
    by_joint = ks.configuration(robot, "mid").by_joint()
    assert by_joint["half"] == 2
    assert by_joint["turn"] == 0
    assert by_joint["lead"] == 0


def test_mid_is_the_middle_of_what_followers_leave():
    robot = read(parse(EVERYTHING.replace(b'lower="0" upper="1"', b'lower="0" upper="0.5"'), "all.urdf"))
    middle = ks.configuration(robot, "mid")
    assert middle.by_joint()["lead"] == pytest.approx(0.125)  # -2 lead + 0.5 in [0, 0.5]
    assert not middle.warnings
    assert contradicted(robot) == ()


def test_followers_that_leave_their_leader_no_range_are_left_out_of_account():
    robot = read(parse(EVERYTHING.replace(b'lower="0" upper="1"', b'lower="10" upper="11"'), "all.urdf"))
    assert contradicted(robot) == ("lead",)
    assert ks.configuration(robot, "mid").by_joint()["lead"] == 0
    assert np.ptp(ks.random_configurations(robot, 0, (1000,))[:, 12]) > 3.9


def test_random_is_inside_limits_of_leaders_and_followers(robot):
    q = ks.random_configurations(robot, 0, (1000,))
    lead, half = q[:, 12], q[:, 11]
    follow = -2 * lead + 0.5
    assert follow.min() >= -1e-15
    assert follow.max() <= 1 + 1e-15
    assert np.ptp(follow) > 0.9
    assert half.min() >= 2
    assert np.allclose(np.linalg.norm(q[:, 3:7], axis=1), 1, atol=1e-15)
    assert not ks.configuration(robot, q[0]).warnings


def test_random_is_inside_the_limits_of_every_real_robot():
    for name in example_robots():
        if name == "ur_description/ur3":  # an empty robot
            continue
        robot = ks.load(f"example:{name}").robot
        q = ks.random_configurations(robot, 1, (50,))
        assert q.shape == (50, robot.nq)
        for joint in robot.independent:
            lower, upper = joint.limit.range
            part = q[:, robot.position_slices[joint.name]]
            assert (part >= lower).all(), joint.name
            assert (part <= upper).all(), joint.name


def test_planar_and_floating_joints_take_vectors_or_named_coordinates(robot):
    whole = ks.configuration(robot, "free=1 2 3 0 0 0 1,flat=4 5 0.5")
    named = ks.configuration(
        robot, {"free.x": 1, "free.y": 2, "free.z": 3, "flat.x": 4, "flat.y": 5, "flat.theta": 0.5}
    )
    assert whole.q.tolist() == named.q.tolist()
    assert whole.by_joint()["flat"] == [4, 5, 0.5]


def test_degrees_turn_angles_only(robot):
    q = ks.configuration(robot, "flat=1 2 180,turn=90,half=3", degrees=True).by_joint()
    assert q["flat"] == [1, 2, math.pi]
    assert q["turn"] == math.pi / 2
    assert q["half"] == 3


def test_quaternions_are_normalised_when_rounded_and_refused_when_wrong(robot):
    rounded = ks.configuration(robot, "free=0 0 0 0 0 0.7071 0.7071").q
    assert np.linalg.norm(rounded[3:7]) == pytest.approx(1, abs=1e-15)
    for wrong in ("free=0 0 0 0 0 0 0", "free=0 0 0 0 0 0 2"):
        with pytest.raises(ks.ConfigurationError, match="quaternion"):
            ks.configuration(robot, wrong)


@pytest.mark.parametrize(
    ("wanted", "message"),
    [
        ("flat=1 2", "takes 3 positions, not 2"),
        ("turn=1 2", "takes one position, not 2"),
        ("follow=1", "follows 'lead'"),
        ("free.qq=1", "no joint 'free.qq'"),
        ({"turn": float("nan")}, "not a finite number"),
        ([0.0] * 12, "12 positions are given, 13 are needed"),
        (np.zeros((2, 13)), "26 positions are given"),
        ("turn", "no configuration 'turn'"),
        ("turn=", "not of the form"),
        ("", "no configuration ''"),
    ],
)
def test_what_cannot_be_is_refused(robot, wanted, message):
    with pytest.raises(ks.UsageError, match=message):
        ks.configuration(robot, wanted)


def test_rates_have_a_column_each(robot):
    rates = ks.joint_rates(robot, "free=1 2 3 4 5 6,flat.wz=90,turn=180,half=7", degrees=True)
    assert rates.tolist() == [1, 2, 3, 4, 5, 6, 0, 0, math.pi / 2, math.pi, 7, 0]
    with pytest.raises(ks.ConfigurationError, match="no list of rates"):
        ks.joint_rates(robot, "fast")
    with pytest.raises(ks.ConfigurationError, match="13 rates are given, 12 are needed"):
        ks.joint_rates(robot, np.zeros(13))
