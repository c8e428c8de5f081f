"""The keys of the JSON output, which other tools read (design: keep them)."""

import json
import math

import numpy as np
import pytest

PANDA = "example:panda"
RESULTS = {
    "fk": {"frame", "relative_to", "position", "quaternion_xyzw", "rpy", "matrix"},
    "jacobian": {"frame", "relative_to", "reference", "expressed_in", "point", "rows", "columns", "matrix"},
    "adjoint": {"from", "to", "kind", "matrix", "applied"},
}


@pytest.mark.parametrize("command", RESULTS)
def test_envelope_and_result_have_the_documented_keys(cli, command):
    answer = cli(command, PANDA, "-f", "panda_hand", "-q", "mid", "-F", "json").json
    assert list(answer) == ["schema", "robot", "configuration", "result", "crosscheck", "warnings"]
    assert answer["schema"] == f"kinetostat/{command}/1"
    assert set(answer["robot"]) == {"name", "source", "sha256"}
    assert answer["robot"]["name"] == "panda"
    assert answer["robot"]["source"] == PANDA
    assert len(answer["robot"]["sha256"]) == 64
    assert RESULTS[command] <= set(answer["result"])
    assert answer["crosscheck"]["engines"] == ["pinocchio", "screw"]
    assert answer["crosscheck"]["agree"] is True
    assert 0 <= answer["crosscheck"]["max_difference"] <= answer["crosscheck"]["tolerance"]
    assert set(answer["configuration"]) >= {"panda_joint1", "panda_finger_joint1"}
    assert "panda_finger_joint2" not in answer["configuration"]  # a follower


def test_numbers_are_in_full_precision(cli):
    answer = cli("fk", PANDA, "-f", "panda_hand", "-q", "mid", "-F", "json").json["result"]
    matrix = np.array(answer["matrix"])
    assert np.abs(matrix[:3, :3] @ matrix[:3, :3].T - np.eye(3)).max() < 4e-16 * 4
    assert answer["position"] == [row[3] for row in answer["matrix"][:3]]


def test_jacobian_result_says_what_it_is(cli):
    arguments = (
        "--reference",
        "local",
        "--point",
        "0.1,0,0.2",
        "--relative-to",
        "panda_link2",
        "--expressed-in",
        "panda_link1",
    )
    result = cli("jacobian", PANDA, "-f", "panda_hand", "-F", "json", *arguments).json["result"]
    assert result["frame"] == "panda_hand"
    assert result["relative_to"] == "panda_link2"
    assert result["expressed_in"] == "panda_link1"
    assert result["reference"] == "local"
    assert result["point"] == [0.1, 0.0, 0.2]
    assert result["rows"] == ["vx", "vy", "vz", "wx", "wy", "wz"]
    assert result["columns"] == [f"panda_joint{i}" for i in range(3, 8)]
    assert np.shape(result["matrix"]) == (6, 5)


def test_the_point_of_reference_world_is_null_with_a_reason(cli):
    result = cli("jacobian", PANDA, "-f", "panda_hand", "--reference", "world", "-F", "json").json["result"]
    assert result["point"] is None
    assert "observer" in result["point_reason"]


def test_angular_first_swaps_the_rows_and_their_names(cli):
    first = cli("jacobian", PANDA, "-f", "panda_hand", "-q", "mid", "-F", "json").json["result"]
    second = cli("jacobian", PANDA, "-f", "panda_hand", "-q", "mid", "-F", "json", "--order", "angular-first").json[
        "result"
    ]
    assert second["rows"] == ["wx", "wy", "wz", "vx", "vy", "vz"]
    assert second["matrix"] == first["matrix"][3:] + first["matrix"][:3]


def test_adjoint_applies_a_six_vector_in_the_given_order(cli):
    arguments = ("adjoint", PANDA, "--from", "panda_hand", "--to", "panda_link3", "-q", "mid", "-F", "json", "--wrench")
    plain = cli(*arguments, "--apply", "1,2,3,4,5,6").json["result"]
    swapped = cli(*arguments, "--apply", "4,5,6,1,2,3", "--order", "angular-first").json["result"]
    assert plain["kind"] == "wrench"
    assert (plain["from"], plain["to"]) == ("panda_hand", "panda_link3")
    assert np.allclose(np.array(plain["matrix"]) @ [1, 2, 3, 4, 5, 6], plain["applied"], atol=1e-14)
    assert plain["applied"] == swapped["applied"][3:] + swapped["applied"][:3]
    assert plain["applied"] != plain["given"]


def test_inverse_goes_the_other_way(cli):
    arguments = ("adjoint", PANDA, "--from", "panda_hand", "--to", "panda_link3", "-q", "mid", "-F", "json")
    there, back = (cli(*arguments, *more).json["result"] for more in ((), ("--inverse",)))
    assert (back["from"], back["to"]) == ("panda_link3", "panda_hand")
    assert np.allclose(np.array(there["matrix"]) @ back["matrix"], np.eye(6), atol=1e-14)


def test_time_derivative_belongs_to_the_matrix(cli):
    arguments = ("jacobian", PANDA, "-f", "panda_hand", "-F", "json", "--joints", "panda_joint4,panda_joint1")
    here, ahead, behind = (
        cli(
            *arguments,
            "-q",
            f"panda_joint1=0.3,panda_joint2=-0.4,panda_joint4={-1.2 + h!r}",
            "--qdot",
            "panda_joint4=1",
        ).json["result"]
        for h in (0.0, 1e-6, -1e-6)
    )
    slope = (np.array(ahead["matrix"]) - behind["matrix"]) / 2e-6
    assert here["columns"] == ["panda_joint4", "panda_joint1"]
    assert np.abs(slope).max() > 0.1
    assert np.allclose(slope, here["time_derivative"], atol=1e-9)


def test_without_crosscheck_the_certificate_is_null_with_a_reason(cli):
    crosscheck = cli("fk", PANDA, "-f", "panda_hand", "-F", "json", "--no-crosscheck").json["crosscheck"]
    assert crosscheck["engines"] == ["pinocchio"]
    assert crosscheck["max_difference"] is None
    assert crosscheck["agree"] is None
    assert crosscheck["reason"]


def test_info_tells_tree_joints_chains_masses_and_remarks(cli):
    result = cli("info", PANDA, "-F", "json").json["result"]
    assert result["root"] == "panda_link0"
    assert result["degrees_of_freedom"] == 8
    joints = {joint["name"]: joint for joint in result["joints"]}
    assert joints["panda_joint4"]["limits"] == {
        "lower": -3.0718,
        "upper": -0.0698,
        "unit": "rad",
        "effort": 87.0,
        "velocity": 2.175,
    }
    assert joints["panda_finger_joint2"]["mimic"]["joint"] == "panda_finger_joint1"
    assert {chain["tip"] for chain in result["chains"]} == {"panda_hand_tcp", "panda_leftfinger", "panda_rightfinger"}
    mass = result["mass"]
    assert mass["total"] == pytest.approx(mass["base_link"] + mass["without_base_link"], rel=1e-15)
    assert mass["base_link"] == pytest.approx(sum(link["mass"] or 0 for link in result["links"][:1]), rel=1e-14)
    assert result["remarks"] == []


def test_info_tells_what_is_odd_with_its_rule_and_line(cli, tmp_path):
    (tmp_path / "odd.urdf").write_text('<robot name="r">\n<link name="a b"/>\n</robot>')
    (blank, *_) = [
        r for r in cli("info", tmp_path / "odd.urdf", "-F", "json").json["result"]["remarks"] if r["line"] == 2
    ]
    assert blank["code"] == "N101"
    assert blank["severity"] == "warning"
    assert blank["hint"]


def test_infinite_limits_are_null_not_nan(cli, arm):
    arm.write_text(arm.read_text().replace('lower="-2" upper="1"', 'lower="-inf" upper="inf"'))
    answer = cli("info", arm, "-F", "json")
    assert answer.json["result"]["joints"][0]["limits"]["lower"] is None
    json.loads(answer.out, parse_constant=pytest.fail)


def test_frames_lists_every_link_with_its_joint(cli, arm):
    frames = cli("frames", arm, "-F", "json").json["result"]["frames"]
    assert [frame["frame"] for frame in frames] == ["base", "upper", "lower", "tip"]
    assert frames[0]["parent"] is None
    assert (frames[3]["parent"], frames[3]["joint"], frames[3]["type"]) == ("lower", "slide", "prismatic")


def test_robots_lists_names_that_can_be_asked_for(cli):
    result = cli("robots", "-F", "json").json["result"]
    assert "textbook:planar_2r" in result["textbook"]
    assert "example:panda" in result["example"]
    assert len(result["example"]) == 69
    for name in ("example:anymal_b_simple_description/anymal", result["textbook"][0]):
        assert cli("frames", name).code == 0


def test_degrees_change_what_is_typed_but_not_the_json(cli, arm):
    degrees = cli("fk", arm, "-q", "shoulder=-30,slide=0.1", "--deg", "-F", "json").json
    radians = cli("fk", arm, "-q", f"shoulder={-math.pi / 6!r},slide=0.1", "-F", "json").json
    assert degrees["configuration"]["shoulder"] == pytest.approx(-math.pi / 6, abs=1e-15)
    assert np.allclose(degrees["result"]["matrix"], radians["result"]["matrix"], atol=1e-15)
    assert degrees["result"]["rpy"] == pytest.approx(radians["result"]["rpy"], abs=1e-15)


def test_a_floating_base_has_seven_positions_and_six_columns(cli, arm):
    q = "root_joint=1 2 3 0 0 0.6 0.8,shoulder=0.2"
    answer = cli("jacobian", arm, "--base", "floating", "-q", q, "-F", "json").json
    assert answer["configuration"]["root_joint"] == [1, 2, 3, 0, 0, 0.6, 0.8]
    assert answer["result"]["relative_to"] == "universe"
    assert answer["result"]["columns"][:6] == [f"root_joint.{row}" for row in ("vx", "vy", "vz", "wx", "wy", "wz")]
    other = cli(
        "jacobian",
        arm,
        "--base",
        "floating",
        "--quat",
        "wxyz",
        "-q",
        "root_joint=1 2 3 0.8 0 0 0.6,shoulder=0.2",
        "-F",
        "json",
    ).json
    assert other["result"]["matrix"] == answer["result"]["matrix"]
