"""`kinetostat ik`: poses in and out, every option, refusals in one line, pages of 80 columns, JSON and CSV."""

import csv
import io
import json

import numpy as np
import pytest

import kinetostat as ks

UR5 = ("example:ur5_robot", "-f", "tool0")
THERE = "0.3,-0.5,0.4,0.2,1,0"
PLANAR = ("textbook:planar_3r", "--axes", "x", "y", "rz")
GOAL = "0.5,3,0 rpy 0,0,2.0943951023931953"
NEAR = ("-q", "1,0.5,0.5")


@pytest.fixture
def ask(cli):
    """Return the JSON object that is written, read strictly."""

    def call(*words):
        answer = cli("ik", *words, "-F", "json")
        assert answer.code == 0, answer.err
        return json.loads(answer.out, parse_constant=pytest.fail)

    return call


@pytest.fixture
def refused(cli):
    """Return the one line that refuses a command line."""

    def call(*words):
        answer = cli("ik", *words)
        assert (answer.code, answer.out) == (2, ""), answer.err
        (line,) = answer.err.splitlines()
        assert line.startswith("kinetostat: error: ")
        return line

    return call


def tool(configuration, *, robot="example:ur5_robot", frame="tool0"):
    model = ks.load(robot)
    return ks.fk(model, frame, ks.configuration(model, configuration).q).matrix


# --- JSON ----------------------------------------------------------------------------------------------------------


def test_the_documented_keys(ask):
    answer = ask(*PLANAR, "--pose", GOAL, *NEAR, "--method", "newton", "--trace")
    assert answer["schema"] == "kinetostat/ik/1"
    assert set(answer) == {"schema", "robot", "configuration", "result", "crosscheck", "warnings"}
    assert answer["crosscheck"]["agree"] is True
    assert answer["configuration"] == {"joint1": 1.0, "joint2": 0.5, "joint3": 0.5}  # where it starts
    result = answer["result"]
    assert {"frame", "relative_to", "configuration", "converged", "iterations", "residual", "trace"} <= set(result)
    assert result["converged"] is True
    assert result["inside_limits"] is True
    assert set(result["residual"]) >= {"position", "rotation", "error"}
    assert len(result["trace"]) == result["iterations"] + 1
    assert set(result["trace"][0]) == {"configuration", "error", "change"}
    assert result["trace"][-1]["configuration"] == result["configuration"]
    assert result["trace"][-1]["change"] is None
    rates = ask(*PLANAR, "--pose", GOAL, *NEAR, "--method", "pseudo-inverse")["result"]
    assert [step["time"] for step in rates["trace"][:3]] == pytest.approx([0, 0.05, 0.1])


def test_what_is_not_reached_says_by_how_much(ask, cli):
    words = ("textbook:planar_2r", "--axes", "x", "y", "--pose", "0,5,0")
    result = ask(*words)["result"]
    assert result["converged"] is False
    assert result["residual"]["position"] == pytest.approx(3.2)
    page = cli("ik", *words)
    assert page.code == 0
    assert page.out.startswith("NOT reached: ")
    assert "3.2 m" in page.out
    assert "missed by 3.2 m" in page.err


def test_a_row_that_does_not_count_has_no_residual(ask):
    residual = ask("textbook:planar_2r", "--axes", "x", "y", "--pose", "1,0.5,0")["result"]["residual"]
    assert residual["rotation"] is None
    assert residual["position"] < 1e-8


def test_all_solutions(ask):
    answer = ask(*UR5, "--pose", _numbers(tool(THERE)), "--all")
    assert answer["schema"] == "kinetostat/ik/1"
    result = answer["result"]
    assert result["complete"] is True
    assert "EAIK" in result["how"]
    assert len(result["solutions"]) == 8
    for solution in result["solutions"]:
        np.testing.assert_allclose(tool(solution["configuration"]), tool(THERE), rtol=0, atol=1e-8)
        assert solution["inside_limits"] is True


# --- poses -----------------------------------------------------------------------------------------------------------


def _numbers(matrix):
    return ",".join(repr(float(x)) for x in np.asarray(matrix)[:3].reshape(-1))


def test_every_notation_means_the_same_pose(ask):
    model = ks.load("example:ur5_robot")
    fk = ks.fk(model, "tool0", ks.configuration(model, THERE).q)
    at = ",".join(repr(float(x)) for x in fk.position)
    x, y, z, w = (repr(float(c)) for c in fk.quaternion_xyzw)
    spelled = [
        _numbers(fk.matrix),
        f"{_numbers(fk.matrix)},0,0,0,1",
        f"{at},{x},{y},{z},{w}",
        f"{at} xyzw {x},{y},{z},{w}",
        f"{at} wxyz {w},{x},{y},{z}",
        f"{at.replace(',', ' ')} xyzw {x} {y} {z} {w}",
    ]
    targets = [ask(*UR5, "--pose", text)["result"]["target"] for text in spelled]
    for target in targets:
        np.testing.assert_allclose(target, fk.matrix, rtol=0, atol=1e-12)
    swapped = ask(*UR5, "--quat", "wxyz", "--pose", f"{at},{w},{x},{y},{z}")["result"]["target"]
    np.testing.assert_allclose(swapped, fk.matrix, rtol=0, atol=1e-12)


def test_degrees_are_read_and_shown(ask, cli):
    words = ("textbook:planar_3r", "--axes", "x", "y", "rz", "--pose", "0.5,3,0 rpy 0,0,120", "-q", "60,30,30", "--deg")
    found = list(ask(*words)["result"]["configuration"].values())
    assert sum(found) == pytest.approx(2 * np.pi / 3)
    page = cli("ik", *words).out
    shown = [float(line.split()[1]) for line in page.splitlines() if line.startswith("joint") and "deg" in line]
    assert shown == pytest.approx(np.degrees(found), abs=1e-5)
    assert "-180 to 180" in page


def test_a_result_of_fk_is_a_pose(cli, ask, tmp_path):
    path = tmp_path / "fk.json"
    assert cli("fk", *UR5, "-q", THERE, "-F", "json", "-o", path).code == 0
    target = ask(*UR5, "--pose", f"@{path}", "--deg")["result"]["target"]
    np.testing.assert_allclose(target, tool(THERE), rtol=0, atol=1e-12)


def test_a_result_of_ik_is_a_configuration(cli, tmp_path):
    """What is read back is what was found: fk of it is the pose."""
    path = tmp_path / "ik.json"
    assert cli("ik", *UR5, "--pose", _numbers(tool(THERE)), "-F", "json", "-o", path).code == 0
    found = json.loads(path.read_text())["result"]["configuration"]
    np.testing.assert_allclose(tool(found), tool(THERE), rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    "content", ["", "{", "[]", "{}", '{"result": {}}', '{"result": {"matrix": 3}}', "null", "[" * 9999]
)
def test_a_file_without_a_pose_is_refused(refused, tmp_path, content):
    path = tmp_path / "bad.json"
    path.write_text(content)
    assert str(path) in refused(*UR5, "--pose", f"@{path}") or content == '{"result": {"matrix": 3}}'


def test_files_that_cannot_be_read_are_refused(refused, tmp_path):
    assert "no such file" in refused(*UR5, "--pose", f"@{tmp_path / 'none.json'}")
    assert "folder" in refused(*UR5, "--pose", f"@{tmp_path}")
    (tmp_path / "bytes.json").write_bytes(b"\xff\xfe")
    assert "UTF-8" in refused(*UR5, "--pose", f"@{tmp_path / 'bytes.json'}")


@pytest.mark.parametrize(
    ("pose", "part"),
    [
        ("1,0", "a pose of 2 numbers"),
        ("", "a pose of 0 numbers"),
        ("nan,0,0", "finite"),
        ("1e13,0,0", "finite"),
        ("1,0,0 zzz 0,0,0", "no notation 'zzz'"),
        ("1,0,0 xyzw 0,0,0,2", "length 2, not 1"),
        ("1,0,0 \x1b[31m 0", r"\x1b[31m"),
        ("1,0,0 rpy", "rpy takes 3 numbers"),
    ],
)
def test_wrong_poses_are_refused(refused, pose, part):
    assert part in refused(*UR5, "--pose", pose)


# --- options ---------------------------------------------------------------------------------------------------------


def test_rows_observer_and_point(ask):
    words = ("--relative-to", "base_link", "--point", "0.1,0,0.2", "--axes", "xyz", "rx", "ry")
    result = ask(*UR5, "--pose", "0.2,0.3,0.4 rpy 0.1,0.2,0.3", *words, "--reference", "local")["result"]
    assert result["converged"] is True
    assert (result["relative_to"], result["reference"]) == ("base_link", "local")
    assert result["point"] == [0.1, 0.0, 0.2]
    assert result["rows"] == ["vx", "vy", "vz", "wx", "wy"]
    model = ks.load("example:ur5_robot")
    here = ks.fk(model, "tool0", ks.configuration(model, result["configuration"]).q, relative_to="base_link").matrix
    np.testing.assert_allclose(here[:3, :3] @ [0.1, 0, 0.2] + here[:3, 3], [0.2, 0.3, 0.4], rtol=0, atol=1e-8)
    np.testing.assert_allclose(here[:3, 2], np.array(result["target"])[:3, 2], rtol=0, atol=1e-8)


def test_seed_and_tries(ask):
    pose = _numbers(tool("0,0.3,0,-1,0,1.5,0,0", robot="example:panda", frame="panda_hand"))
    panda = ("example:panda", "-f", "panda_hand", "-q", "3,-2,3,-3,3,3,3,0", "--pose", pose)
    one, same, other = (ask(*panda, "--seed", seed)["result"] for seed in ("1", "1", "2"))
    assert one == same
    assert one["converged"]
    assert other["converged"]
    fewer = ask(*panda, "--tries", "1")["result"]
    assert fewer["iterations"] <= one["iterations"]


@pytest.mark.parametrize("step", ["0.5", "1", "0.02"])
def test_steps(ask, step):
    trace = ask(*PLANAR, "--pose", GOAL, "-q", "0.7,1.43,-0.036", "--method", "pseudo-inverse", "--step", step)[
        "result"
    ]["trace"]
    assert trace[1]["error"] / trace[0]["error"] == pytest.approx(1 - float(step), abs=0.02)
    assert "time" not in trace[0]


def test_without_the_second_engine(ask):
    assert ask(*UR5, "--pose", "0.4,0.2,0.5", "--no-crosscheck")["result"]["converged"] is True


@pytest.mark.parametrize(
    ("words", "part"),
    [
        ((), "no pose is asked for"),
        (("--pose", "1,0,0", "--method", "gauss"), "gauss"),
        (("--pose", "1,0,0", "--step", "0.5"), "step"),
        (("--pose", "1,0,0", "--method", "pseudo-inverse", "--step", "0"), "a step is between 0 and 1"),
        (("--pose", "1,0,0", "--method", "pseudo-inverse", "--step", "2"), "a step is between 0 and 1"),
        (("--pose", "1,0,0", "--method", "pseudo-inverse", "--step", "nan"), "a step is between 0 and 1"),
        (("--pose", "1,0,0", "--tries", "0"), "--tries"),
        (("--pose", "1,0,0", "--tries", "99999"), "tries, not 99999"),
        (("--pose", "1,0,0", "--seed", "-1"), "--seed"),
        (("--pose", "1,0,0", "--reference", "world"), "tool point"),
        (("--pose", "1,0,0", "--axes", "rz"), "no orientation"),
        (("--pose", "1,0,0", "--axes", "w"), "no axis 'w'"),
        (("--pose", "1,0,0", "--point", "1,2"), "--point"),
        (("--pose", "1,0,0", "--point", "1,2,nan"), "--point"),
        (("--pose", "1,0,0", "--relative-to", "nowhere"), "there is no frame 'nowhere'"),
        (("--pose", "1,0,0", "--relative-to", "tool0"), "no joint moves 'tool0'"),
        (("--pose", "1,0,0", "--base", "floating"), "floating joint 'root_joint'"),
        (("--pose", "1,0,0", "-q", "1,2"), "positions"),
        (("--pose", "1,0,0", "-q", "nan,0,0,0,0,0"), "finite"),
        (("--pose", "1,0,0", "--all", "--qs", "list.csv"), "--all"),
    ],
)
def test_wrong_questions_are_refused(refused, words, part):
    assert part in refused(*UR5, *words)


# --- pages -----------------------------------------------------------------------------------------------------------

PAGES = (
    (*UR5, "--pose", "0.4,0.2,0.5"),
    (*UR5, "--pose", "0.4,0.2,0.5 rpy 3,0,0", "--all", "--deg"),
    (*UR5, "--pose", "9,9,9 rpy 3,0,0"),
    (*UR5, "--pose", "9,9,9 rpy 3,0,0", "--all"),
    (*UR5, "--pose", "0.4,0.2,0.5 rpy 3,0,0", "-q", "0.3,-1,1,0.4,1,0", "--method", "pseudo-inverse", "--trace"),
    ("example:panda", "-f", "panda_hand", "--pose", "0.4,0.2,0.5 rpy 3.14,0,0", "-q", "default"),
    ("example:panda", "-f", "panda_hand", "--pose", "0.4,0.2,0.5 rpy 3.14,0,0", "-q", "default", "--all"),
    (*PLANAR, "--pose", GOAL, *NEAR, "--method", "newton", "--trace", "--deg"),
    ("textbook:planar_2r", "--pose", "1e12,-1e12,1e-12"),
    ("example:talos_full_v2", "-f", "gripper_left_base_link", "--pose", "0.4,0.2,0.3"),
)


@pytest.mark.parametrize("words", PAGES, ids=lambda words: " ".join(words)[:60])
def test_pages_fit_80_columns_and_say_what_they_are(cli, words):
    page = cli("ik", *words)
    assert page.code == 0, page.err
    assert max(map(len, page.out.splitlines())) <= 80
    assert "pinocchio and screw agree" in page.out
    assert "rad" in page.out or "deg" in page.out or page.out.startswith("0 ")


def test_csv_is_the_numbers_in_full(cli, ask):
    words = (*UR5, "--pose", "0.4,0.2,0.5 rpy 3,0,0")
    header, row = csv.reader(io.StringIO(cli("ik", *words, "-F", "csv").out))
    exact = ask(*words)["result"]["configuration"]
    assert header[: len(exact)] == [f"{name} [rad]" for name in exact]
    assert [float(x) for x in row[: len(exact)]] == list(exact.values())


def test_csv_of_what_is_not_reached_says_so(cli):
    """A program that reads joints must not take the nearest miss for a solution."""
    answer = cli("ik", "textbook:planar_2r", "--axes", "x", "y", "--pose", "0,5,0", "-F", "csv")
    assert "reach" in answer.out + answer.err or "residual" in answer.out


@pytest.mark.parametrize(
    "more",
    [
        ("--method", "newton"),
        ("--method", "pseudo-inverse", "--step", "0.5"),
        ("--trace",),
    ],
)
def test_options_that_would_count_for_nothing_are_refused(refused, more):
    assert more[0] in refused(*UR5, "--pose", "0.4,0.2,0.5 rpy 3,0,0", "--all", *more)


def test_csv_of_all_solutions_is_one_row_each(cli, ask):
    words = (*UR5, "--pose", _numbers(tool(THERE)), "--all")
    rows = list(csv.DictReader(io.StringIO(cli("ik", *words, "-F", "csv").out)))
    exact = ask(*words)["result"]["solutions"]
    assert len(rows) == len(exact)
    for row, solution in zip(rows, exact, strict=True):
        assert {name: float(row[name]) for name in solution["configuration"]} == solution["configuration"]


def test_names_from_a_file_cannot_steer_the_terminal(cli, arm):
    arm.write_text(arm.read_text().replace('"slide"', '"[red]&#10;\u202e"'))
    page = cli("ik", arm, "--pose", "1.9,0.3,0", "--axes", "x", "y")
    assert page.code == 0, page.err
    assert "\u202e" not in page.out + page.err


def test_a_trace_of_many_steps_is_cut_on_the_page_alone(cli, ask):
    words = (*PLANAR, "--pose", GOAL, *NEAR, "--method", "pseudo-inverse", "--trace")
    page = cli("ik", *words).out
    whole = ask(*words)["result"]["trace"]
    assert len(whole) > 300
    assert len(page.splitlines()) < 60
    assert f"{len(whole)} in all" in " ".join(page.split())


def test_the_example_of_the_help_works(cli):
    text = cli("ik", "--help").out
    assert "Example: kinetostat ik" in " ".join(text.split())
    answer = cli("ik", "example:panda", "-f", "panda_hand", "-q", "default", "--pose", "0.4,0.2,0.5 rpy 3.14,0,0")
    assert answer.out.startswith("reached: ")
