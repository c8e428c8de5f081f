"""Textbook rows through the command line, as a user would ask them."""

import numpy as np
import pytest

from textbook_support import assert_same, command_line

HALF = np.sqrt(0.5)


def test_a3_jacobian():
    payload = command_line("jacobian", "textbook:planar_2r", "-q", "joint1=45,joint2=90", "--deg")
    result = payload["result"]
    # At 45 and 90 degrees the second link points along (-1, 1)/sqrt(2).
    expected = np.zeros((6, 2))
    expected[0] = -HALF - 0.8 * HALF, -0.8 * HALF
    expected[1] = HALF - 0.8 * HALF, -0.8 * HALF
    expected[5] = 1
    assert_same(result["matrix"], expected)
    assert result["frame"] == "tool"
    assert result["relative_to"] == result["expressed_in"] == "base"
    assert result["reference"] == "aligned"
    assert result["rows"] == ["vx", "vy", "vz", "wx", "wy", "wz"]
    assert result["columns"] == ["joint1", "joint2"]
    assert payload["configuration"] == pytest.approx({"joint1": np.pi / 4, "joint2": np.pi / 2})
    assert payload["robot"]["name"] == "planar_2r"


def test_a3_jacobian_in_the_tip_frame():
    result = command_line("jacobian", "textbook:planar_2r", "-q", "0.3,1.1", "--reference", "local")["result"]
    assert_same(result["matrix"][:2], np.array([[np.sin(1.1), 0], [np.cos(1.1) + 0.8, 0.8]]))
    assert result["expressed_in"] == "tool"


def test_a1_a_point_at_a_third():
    result = command_line("jacobian", "textbook:planar_1r", "-f", "link1", "--point", "0.3,0,0", "-q", "joint1=1.2")[
        "result"
    ]
    assert_same(result["matrix"], np.array([[-0.3 * np.sin(1.2)], [0.3 * np.cos(1.2)], [0], [0], [0], [1]]))
    assert result["point"] == [0.3, 0, 0]


def test_a8_start_of_newton_raphson():
    result = command_line("fk", "textbook:planar_3r", "-q", "60,30,30", "--deg")["result"]
    assert_same(result["position"], np.array([0.5, 1 + 1.5 * np.sqrt(3), 0]))
    assert_same(result["rpy"], np.array([0, 0, 2 * np.pi / 3]))
    assert_same(result["quaternion_xyzw"], np.array([0, 0, np.sin(np.pi / 3), np.cos(np.pi / 3)]))


def test_a14_helical_joint():
    result = command_line("jacobian", "textbook:helical", "-q", "joint1=2.5", "--reference", "world")["result"]
    axis, through = np.array([3.0, 2.0, 6.0]) / 7, np.array([0.3, -0.1, 0.2])
    expected = np.r_[0.05 / (2 * np.pi) * axis + np.cross(through, axis), axis]
    assert_same(result["matrix"], expected[:, None])
    assert result["point"] is None


def test_a16_frame_change_is_the_transpose_of_its_dual():
    velocity = command_line("adjoint", "textbook:rigid_body", "--from", "a", "--to", "b")["result"]
    wrench = "1,-2,0.5,0.1,0,-0.3"
    force = command_line("adjoint", "textbook:rigid_body", "--from", "b", "--to", "a", "--wrench", "--apply", wrench)[
        "result"
    ]
    assert_same(force["matrix"], np.array(velocity["matrix"]).T)
    assert (velocity["kind"], force["kind"]) == ("twist", "wrench")
    # R = Rz Ry Rx of the file's Pythagorean angles; forces only turn.
    a = _axes((4 / 5, 3 / 5), (12 / 13, 5 / 13), (15 / 17, 8 / 17))
    b = _axes((12 / 13, -5 / 13), (15 / 17, -8 / 17), (3 / 5, 4 / 5))
    assert_same(force["applied"][:3], a.T @ b @ [1, -2, 0.5])
    assert_same(np.array(velocity["matrix"])[3:, 3:], b.T @ a)


def _axes(roll, pitch, yaw):
    (cr, sr), (cp, sp), (cy, sy) = roll, pitch, yaw
    return (
        np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
        @ np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
        @ np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    )


def test_puma_jacobian_at_the_nominal_pose():
    result = command_line("jacobian", "textbook:puma560", "-q", "0,45,180,0,45,0", "--deg")["result"]
    printed = [[0.15005, 0.0143543, 0.3196830, 0, 0, 0], [0.5963031, 0, 0, 0, 0, 0], [0, 0.5963031, 0.2909744, 0, 0, 0]]
    assert_same(result["matrix"][:3], np.array(printed), atol=6e-8)


def test_modern_robotics_space_jacobian_angular_first():
    words = ("-q", "0.2,1.1,0.1,1.2", "--reference", "world", "--order", "angular-first")
    result = command_line("jacobian", "textbook:modern_robotics_hhhh", *words)["result"]
    assert result["rows"] == ["wx", "wy", "wz", "vx", "vy", "vz"]
    assert_same(result["matrix"][2], np.array([1, 0, 0.89120736, -0.04528405]), atol=6e-9)
    assert_same(result["matrix"][3], np.array([0, 1.95218638, -2.21635216, -0.51161537]), atol=6e-9)
