"""Rows A16 and A17 through the real path: wrenches between frames of one body, and the static chain, link by link."""

import numpy as np
import pytest

import kinetostat as ks
from textbook_support import (
    angles,
    assert_same,
    command_line,
    frame_change_of,
    jacobian_of,
    placement_of,
    textbook,
    vector_of,
)

FIRST, SECOND = 1.0, 0.8
G = 9.81


def torques_of(name, q, *wrenches, **words):
    """Return certified torques of a textbook robot."""
    result = ks.torque(textbook(name), np.asarray(q, dtype=float), wrenches, **words)
    assert result.certificate.engines == ("pinocchio", "screw")
    assert result.certificate.agree is True, result.certificate
    return result


def reactions_of(name, q, result):
    found = ks.reactions(textbook(name), np.asarray(q, dtype=float), result)
    assert found.certificate.agree is True, found.certificate
    return found


def wrench_at(name, frame, six, **words):
    return ks.load_at(textbook(name), frame, six, **words)


# --- A16: the same wrench in two frames of one body


def test_a16_a_wrench_is_the_same_in_every_frame_of_its_body():
    """A_F = [[R^T, 0], [[p]x R^T, R^T]] B_F, and neither joint nor ground can tell which of the two was given."""
    six = np.array([1.0, -2.0, 0.5, 0.3, -0.7, 1.1])
    for name, near, far in (("puma560", "link6", "tool"), ("stanford", "link6", "tool"), ("helical", "nut", "tool")):
        nq = textbook(name).robot.nq
        for q in angles(nq, seed=310, count=5)[-5:]:
            carried = frame_change_of(name, far, near, q, kind="wrench") @ six
            there = torques_of(name, q, wrench_at(name, far, six, axes="local"))
            here = torques_of(name, q, wrench_at(name, near, carried, axes="local"))
            assert_same(there.total, here.total, 1e-12 * 20)
            bases = [reactions_of(name, q, result).base[0] for result in (there, here)]
            assert_same(*bases, 1e-12 * 20)


def test_a16_a_wrench_about_the_roots_origin_is_carried_to_the_base():
    """`@world` is the wrench that `adjoint --wrench` gives for the root."""
    six, q = np.array([1.0, -2.0, 0.5, 0.3, -0.7, 1.1]), angles(6, seed=311, count=1)[-1]
    carried = frame_change_of("puma560", "tool", "base", q, kind="wrench") @ six
    there = torques_of("puma560", q, wrench_at("puma560", "tool", six, axes="local"))
    here = torques_of("puma560", q, wrench_at("puma560", "tool", carried, point="world"))
    assert_same(there.total, here.total, 1e-12 * 20)


# --- A17: the static chain


def test_a17_forces_of_the_planar_2r():
    """Links along x: joint2 bears l2 fy of the tool's own axes, joint1 l1 s2 fx + (l1 c2 + l2) fy."""
    q = angles(2, seed=312)
    second = q[:, 1]
    for fx, fy in ((1.0, 0.0), (0.0, 1.0), (-3.0, 2.0)):
        result = torques_of("planar_2r", q, wrench_at("planar_2r", "tool", [fx, fy, 0, 0, 0, 0], axes="local"))
        first = FIRST * np.sin(second) * fx + (FIRST * np.cos(second) + SECOND) * fy
        assert_same(result.total, vector_of(first, SECOND * fy * np.ones(len(q))))


@pytest.mark.parametrize(
    "name",
    ["planar_3r", "scara", "stanford", "puma560", "wrist_three_roll", "torus_3r", "rp", "pr", "skew_1p", "helical"],
)
def test_a17_torques_are_the_jacobian_transposed(name):
    six = np.array([1.0, -2.0, 0.5, 0.3, -0.7, 1.1])
    for q in angles(textbook(name).robot.nq, seed=313, count=4)[-4:]:
        jacobian = jacobian_of(name, "tool", q)
        result = torques_of(name, q, wrench_at(name, "tool", six))
        assert_same(result.total, jacobian.T @ six, 1e-12 * 20)


@pytest.mark.parametrize("name", ["planar_3r", "scara", "stanford", "puma560", "anthropomorphic", "wrist_zyz"])
def test_a17_link_by_link(name):
    """f and n of a link are those of the next, turned, n with the moment of f; z takes the torque out of each."""
    six = np.array([1.0, -2.0, 0.5, 0.3, -0.7, 1.1])
    robot = textbook(name).robot
    for q in angles(robot.nq, seed=314, count=3)[-3:]:
        result = torques_of(name, q, wrench_at(name, "tool", six, axes="local"))
        found = reactions_of(name, q, result)
        order = [joint.child for joint, _ in robot.path("base", "tool")]
        expected, beyond = six, "tool"
        for link in reversed(order):
            between = placement_of(name, beyond, q, relative_to=link)
            turn, lever = between[:3, :3], between[:3, 3]
            force = turn @ expected[:3]
            expected = np.r_[force, turn @ expected[3:] + np.cross(lever, force)]
            beyond = link
            i = found.links.index(link)
            assert_same(found.local[i], expected, 1e-11)
            joint = robot.joint_by_name[found.joints[i]]
            if joint.type.nv == 1:
                half = expected[:3] if joint.type is ks.JointType.PRISMATIC else expected[3:]
                torque = result.total[robot.velocity_slices[joint.name]][0]
                assert np.isclose(half @ joint.axis, torque, rtol=0, atol=1e-11)


def test_a17_the_slide_of_the_scara_bears_its_load_alone():
    q = angles(4, seed=315, count=6)[-6:]
    result = torques_of("scara", q, wrench_at("scara", "tool", [0, 0, 7.0, 0, 0, 0]))
    assert_same(np.abs(result.total), np.broadcast_to([0, 0, 7.0, 0], (6, 4)))


def test_a17_gravity_in_the_plane_of_a_2r():
    """Rods of 4 kg and 2.4 kg, their centres halfway: g (m1 c1 / 2 + m2 (c1 + 0.4 c12)), g 0.4 m2 c12."""
    q = angles(2, seed=316)
    result = torques_of("planar_2r", q, gravity=(0, -G, 0))
    c1, c12 = np.cos(q[:, 0]), np.cos(q.sum(axis=1))
    assert_same(result.gravity, G * vector_of(4 * 0.5 * c1 + 2.4 * (c1 + 0.4 * c12), 2.4 * 0.4 * c12), 1e-12 * 60)
    assert not np.any(torques_of("planar_2r", q, gravity=True).gravity)  # its axes are along z


def test_a17_through_the_command_line():
    words = ("torque", "textbook:planar_2r", "-q", "0,90", "--deg", "--wrench", "tool:3,4,0,0,0,5", "--reactions")
    result = command_line(*words)["result"]
    # J^T: -0.8 fx + fy + mz, -0.8 fx + mz
    assert result["torques"]["joint1"] == pytest.approx(-2.4 + 4 + 5, abs=1e-12)
    assert result["torques"]["joint2"] == pytest.approx(-2.4 + 5, abs=1e-12)
    links = result["reactions"]["links"]
    assert links["link2"]["joint"] == "joint2"
    assert links["link2"]["projection"] == pytest.approx(2.6, abs=1e-12)
    assert_same(links["link1"]["base"], [3, 4, 0, 0, 0, 6.6])
    assert_same(links["link2"]["base"], [3, 4, 0, 0, 0, 2.6])
    # Link 2 points along y: its x is along y, its y along -x.
    assert_same(links["link2"]["local"], [4, -3, 0, 0, 0, 2.6])


def test_a16_through_the_command_line():
    at = ("textbook:puma560", "-q", "0.1,0.5,-0.6,0.2,0.9,0.3")
    six = "1,-2,0.5,0.3,-0.7,1.1"
    carried = command_line("adjoint", *at, "-f", "tool", "--wrench", "--apply", six)["result"]["applied"]
    text = ",".join(repr(value) for value in carried)
    there = command_line("torque", *at, "--wrench", f"tool:{six}", "--in", "local")["result"]["total"]
    here = command_line("torque", *at, "--wrench", f"tool@world:{text}")["result"]["total"]
    assert_same(list(there.values()), list(here.values()), 1e-12 * 20)
