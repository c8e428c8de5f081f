"""What people look at: tables that fit the page and say their units; CSV that programs read."""

import csv
import io
import math

import pytest

QUESTIONS = (
    ("robots",),
    ("info", "example:panda"),
    ("info", "example:tiago_dual"),
    ("frames", "example:romeo"),
    ("fk", "example:panda", "-f", "panda_hand", "-q", "mid", "--deg"),
    ("jacobian", "example:panda", "-f", "panda_hand", "-q", "mid"),
    (
        "jacobian",
        "example:talos_full_v2",
        "-f",
        "gripper_left_fingertip_1_link",
        "--base",
        "floating",
        "--joints",
        "all",
    ),
    ("jacobian", "example:panda", "-f", "panda_hand", "-q", "mid", "--rates", "rpy", "--qdot", "panda_joint1=1"),
    ("adjoint", "example:panda", "-f", "panda_hand", "-q", "mid", "--wrench", "--apply", "0,0,5,0,0,0"),
)


@pytest.mark.parametrize("question", QUESTIONS, ids=" ".join)
def test_tables_fit_80_columns(cli, question):
    answer = cli(*question)
    assert answer.code == 0, answer.err
    # A drawn tree is as deep as the robot; what is set in columns fits the page.
    lines = [line for line in answer.out.splitlines() if "`- " not in line and "|- " not in line]
    assert max(map(len, lines)) <= 80


def test_a_jacobian_says_its_label_units_joints_and_certificate(cli):
    text = cli("jacobian", "example:panda", "-f", "panda_hand", "-q", "mid", "--reference", "local").out
    for part in (
        "origin of panda_hand",
        "relative to panda_link0",
        "in the axes of panda_hand",
        "vx m/s",
        "wz rad/s",
        "joint7",
    ):
        assert part in text
    assert "pinocchio and screw agree: largest difference" in text


def test_degrees_are_shown_for_angles_only(cli, arm):
    text = cli("jacobian", arm, "-q", "shoulder=45,slide=0.25", "--deg").out
    row = next(line for line in text.splitlines() if line.startswith("q"))
    assert row.split() == ["q", "deg|m", "45.00000", "0.25000"]
    assert "\nrpy deg" in cli("fk", arm, "--deg").out
    assert "\nrpy rad" in cli("fk", arm).out


def test_rounding_noise_is_shown_as_zero(cli):
    text = cli("jacobian", "example:panda", "-f", "panda_hand").out
    assert "e-1" not in text.partition("\n\npinocchio")[0]
    assert "-0.00000" not in text


def test_csv_of_a_jacobian_has_rows_units_and_full_precision(cli):
    rows = list(
        csv.reader(io.StringIO(cli("jacobian", "example:panda", "-f", "panda_hand", "-q", "mid", "-F", "csv").out))
    )
    exact = cli("jacobian", "example:panda", "-f", "panda_hand", "-q", "mid", "-F", "json").json["result"]
    assert rows[0][2:] == [f"{name} [rad/s]" for name in exact["columns"]]
    assert [row[:2] for row in rows[1:]] == [list(pair) for pair in zip(exact["rows"], exact["row_units"], strict=True)]
    assert [[float(cell) + 0.0 for cell in row[2:]] for row in rows[1:]] == exact["matrix"]


def test_csv_of_a_placement_is_one_row_of_numbers(cli):
    header, row = csv.reader(io.StringIO(cli("fk", "example:panda", "-f", "panda_hand", "-q", "mid", "-F", "csv").out))
    exact = cli("fk", "example:panda", "-f", "panda_hand", "-q", "mid", "-F", "json").json["result"]
    assert header == [
        "frame",
        "relative_to",
        "x [m]",
        "y [m]",
        "z [m]",
        "qx",
        "qy",
        "qz",
        "qw",
        "roll [rad]",
        "pitch [rad]",
        "yaw [rad]",
    ]
    assert [float(cell) for cell in row[2:]] == [*exact["position"], *exact["quaternion_xyzw"], *exact["rpy"]]


def test_csv_holds_what_was_asked_for_besides_the_matrix(cli):
    arm = ("textbook:planar_2r", "-q", "0.3,0.7")
    rows = list(csv.reader(io.StringIO(cli("jacobian", *arm, "--qdot", "1,2", "-F", "csv").out)))
    exact = cli("jacobian", *arm, "--qdot", "1,2", "-F", "json").json["result"]
    assert [row[0] for row in rows[7:]] == [f"d{name}/dt" for name in exact["rows"]]
    assert [[float(cell) + 0.0 for cell in row[2:]] for row in rows[7:]] == exact["time_derivative"]
    rows = list(csv.DictReader(io.StringIO(cli("adjoint", *arm, "--apply", "1,2,3,4,5,6", "-F", "csv").out)))
    applied = cli("adjoint", *arm, "--apply", "1,2,3,4,5,6", "-F", "json").json["result"]["applied"]
    assert [float(row["given"]) for row in rows] == [1, 2, 3, 4, 5, 6]
    assert [float(row["applied"]) + 0.0 for row in rows] == applied


def test_a_table_says_at_which_configuration(cli, arm):
    assert "\nat shoulder 0.3 (m, rad; others zero)\n" in cli("fk", arm, "-q", "shoulder=0.3").out
    assert "\nat zero (angles in rad)\n" in cli("adjoint", arm).out
    floating = cli("jacobian", arm, "--base", "floating", "-q", "root_joint=1 2 3 0 0 0.6 0.8,shoulder=0.2").out
    assert "at root_joint 1 2 3 0 0 0.6 0.8, shoulder 0.2" in floating


def test_degrees_are_shown_for_the_angle_of_a_planar_joint(cli, tmp_path):
    path = tmp_path / "cart.urdf"
    path.write_text(
        '<robot name="cart"><link name="floor"/><link name="cart"/><joint name="roll" type="planar">'
        '<parent link="floor"/><child link="cart"/><axis xyz="0 0 1"/></joint></robot>'
    )
    assert "at roll 1 2 90 (m, deg; others zero)" in cli("fk", path, "-q", "roll=1 2 90", "--deg").out
    assert "at roll 1 2 1.5708 (m, rad; others zero)" in cli("fk", path, "-q", "roll=1 2 1.5708").out


def test_analytic_jacobians_say_their_angles(cli):
    wrist = ("jacobian", "textbook:wrist_zyz", "-q", "0.3,-0.8,-0.2", "--rates", "zyz")
    angles = cli(*wrist, "-F", "json").json["result"]["rates"]
    assert angles["angles"] == ["z1", "y2", "z3"]
    assert angles["values"] == pytest.approx([0.3 - math.pi, 0.8, -0.2 + math.pi], abs=1e-14)
    assert "angles: z1 -2.84159, y2 0.8, z3 2.94159 rad" in cli(*wrist).out


def test_csv_of_frames_and_joints_are_tables(cli):
    frames = list(csv.DictReader(io.StringIO(cli("frames", "example:panda", "-F", "csv").out)))
    assert frames[1]["parent"] == "panda_link0"
    joints = list(csv.DictReader(io.StringIO(cli("info", "example:panda", "-F", "csv").out)))
    assert float(joints[3]["lower"]) == -3.0718


def test_a_frame_without_moving_joints_says_so(cli):
    answer = cli("jacobian", "example:panda", "-f", "panda_link0")
    assert answer.code == 0
    assert "no joint moves this frame" in answer.out


def test_names_from_a_file_cannot_steer_the_terminal_or_a_spreadsheet(cli, arm):
    arm.write_text(arm.read_text().replace('"tip"', '"=1+1&#10;[red]\u202e"'))
    for command in ("info", "frames", "fk", "jacobian"):
        text = cli(command, arm)
        assert text.code == 0, text.err
        assert "\u202e" not in text.out + text.err
    rows = list(csv.reader(io.StringIO(cli("frames", arm, "-F", "csv").out)))
    assert rows[4][0].startswith("'=1+1")
