"""`kinetostat torque`: options and their spellings, keys, refusals, pages, pictures; answers agree with the library."""

import csv
import io
import json
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import kinetostat as ks

PANDA = ("example:panda", "-f", "panda_hand", "-q", "default")
UR5 = ("example:ur5_robot", "-f", "tool0", "-q", "0.3,-0.5,1.2,0.2,1,0")
PLANAR = ("textbook:planar_2r", "-q", "0,90", "--deg")
KEYS = {"torques", "gravity", "total", "effort_limits", "utilisation", "binding_joint"}


@pytest.fixture
def ask(cli):
    """Return the JSON object that is written, read strictly: no NaN, no Infinity."""

    def call(*words):
        answer = cli("torque", *words, "-F", "json")
        assert answer.code == 0, answer.err
        return json.loads(answer.out, parse_constant=pytest.fail)

    return call


@pytest.fixture
def refused(cli):
    """Return the one line that refuses a command line."""

    def call(*words, code=2):
        answer = cli("torque", *words)
        assert (answer.code, answer.out) == (code, "")
        (line,) = answer.err.splitlines()
        assert line.startswith("kinetostat: error: ")
        assert "Traceback" not in line
        return line

    return call


def flattened(text):
    return " ".join(text.split())


# --- JSON ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "question",
    [
        (*PANDA, "--gravity"),
        (*PANDA, "--gravity", "--payload", "2", "--reactions", "--max", "z"),
        (*UR5, "--wrench", "tool0:1,2,3,4,5,6", "--max", "all"),
        (*PLANAR, "--max", "x"),
        ("textbook:rigid_body", "--gravity", "--reactions"),
        ("example:solo12", "--gravity", "--base", "floating"),
    ],
    ids=" ".join,
)
def test_the_documented_keys(ask, question):
    answer = ask(*question)
    assert answer["schema"] == "kinetostat/torque/1"
    assert set(answer) == {"schema", "robot", "configuration", "result", "crosscheck", "warnings"}
    assert answer["crosscheck"]["agree"] is True
    result = answer["result"]
    assert set(result) >= KEYS
    for key in KEYS - {"binding_joint"}:
        assert list(result[key]) == result["columns"]
    assert len(result["units"]) == len(result["columns"])
    for name in result["columns"]:
        known = result["effort_limits"][name]
        assert (known is None) == (result["utilisation"][name] is None)
        assert (known is None) == (name in result.get("effort_limits_reasons", {}))


def test_numbers_are_those_of_the_library(ask):
    model = ks.load("example:panda")
    q = ks.configuration(model, "default").q
    load = ks.load_at(model, "panda_hand", [1, 2, 3, 4, 5, 6], axes="local", point=(0.1, 0, 0.2))
    payload = ks.Payload(2.0, "panda_hand", (0, 0, 0.1))
    expected = ks.torque(
        model, q, [load], gravity=(0, 1, -9), payload=payload, on="robot", limits={"panda_joint2": (-5, 9)}
    )
    result = ask(
        *PANDA,
        *("--wrench", "panda_hand@0.1,0,0.2:1,2,3,4,5,6", "--in", "local", "--on", "robot"),
        *("--gravity-vector", "0,1,-9", "--payload", "2@0,0,0.1", "--effort-limits", "panda_joint2=-5:9"),
    )["result"]
    for key in ("torques", "gravity", "from_payload", "total", "utilisation"):
        assert list(result[key].values()) == getattr(expected, key).tolist()
    assert result["binding_joint"] == expected.binding_joint
    assert result["effort_limits"]["panda_joint2"] == {"lower": -5, "upper": 9}
    held = {"mass": 2, "frame": "panda_hand", "point": [0, 0, 0.1], "gravity_vector": [0, 1, -9]}
    assert result["payload"] == held
    assert result["gravity_vector"] == [0, 1, -9]
    assert result["on"] == "robot"


def test_a_missing_limit_is_null_with_its_reason(ask):
    result = ask("example:solo12", "--gravity", "--base", "floating")["result"]
    assert result["effort_limits"]["root_joint.vx"] is None
    assert result["utilisation"]["root_joint.vx"] is None
    assert "coordinates" in result["effort_limits_reasons"]["root_joint.vx"]
    assert result["units"][:6] == ["N"] * 3 + ["Nm"] * 3


def test_reactions_by_link(ask):
    result = ask(*PANDA, "--gravity", "--reactions")["result"]
    links = result["reactions"]["links"]
    assert links["panda_link0"]["held_by"] is None
    assert links["panda_link4"]["held_by"] == "panda_link3"
    assert links["panda_link4"]["joint"] == "panda_joint4"
    assert links["panda_link4"]["projection"] == pytest.approx(result["total"]["panda_joint4"], abs=1e-12)
    assert links["panda_link0"]["projection"] is None
    assert result["reactions"]["projection_residual"] < 1e-12


def test_the_largest_force_and_payload(ask):
    model = ks.load("example:panda")
    q = ks.configuration(model, "default").q
    rest = ks.torque(model, q, gravity=True)
    for text, direction in (
        ("z", (0, 0, 1)),
        ("+x", (1, 0, 0)),
        ("-y", (0, -1, 0)),
        ("1,2,-2", (1, 2, -2)),
        ("payload", "payload"),
    ):
        expected = ks.strongest(model, "panda_hand", q, direction, rest)
        found = ask(*PANDA, "--max", text)["result"]["max"]
        assert found["value"] == pytest.approx(float(expected.value), rel=1e-12)
        assert found["binding_joint"] == expected.binding_joint


def test_an_infinite_force_is_null_with_a_reason(ask):
    found = ask("textbook:planar_2r", "--max", "x")["result"]["max"]
    assert found["value"] is None
    assert any("reason" in key for key in found)


def test_all_forces(ask):
    result = ask(*UR5, "--max", "all", "--axes", "x", "z", "--expressed-in", "tool0", "--point", "0,0,0.1")["result"][
        "max"
    ]
    assert result["rows"] == ["fx", "fz"]
    assert result["expressed_in"] == "tool0"
    assert result["point"] == [0, 0, 0.1]
    assert {len(corner) for corner in result["vertices"]} == {2}
    assert len(result["facets"]) == len(result["facet_joints"]) == len(result["vertices"])
    moments = ask(*UR5, "--max", "all", "--axes", "rxyz")["result"]["max"]
    assert (moments["unit"], moments["rows"]) == ("Nm", ["mx", "my", "mz"])


def test_the_worst(ask):
    words = ("textbook:planar_2r", "--worst", "--gravity-vector", "0,-9.81,0", "--samples", "50")
    result = ask(*words)["result"]
    assert result["worst"]["joint2"]["unit"] == "Nm"
    assert abs(result["worst"]["joint2"]["torque"]) == pytest.approx(9.81 * 2.4 * 0.4, rel=1e-9)
    assert set(result["worst"]["joint1"]["witness"]) == {"joint1", "joint2"}
    assert "lower" in result["bound"]
    assert ask(*words)["result"] == result


# --- wrenches --------------------------------------------------------------------------------------------------------


def total(answer):
    return np.array(list(answer["result"]["total"].values()))


def test_points_and_axes_of_a_wrench(ask):
    """Tool and link2 are one body: a wrench at the tool is one at the point (0.8, 0, 0) of link2."""
    there = total(ask(*PLANAR, "--wrench", "tool:1,2,0,0,0,3"))
    assert np.allclose(there, total(ask(*PLANAR, "--wrench", "link2@0.8,0,0:1,2,0,0,0,3")), rtol=0, atol=1e-12)
    # link2 points along y there: x of the base is -y of the link.
    assert np.allclose(there, total(ask(*PLANAR, "--wrench", "tool:2,-1,0,0,0,3", "--in", "local")), rtol=0, atol=1e-12)
    assert np.allclose(there, total(ask(*PLANAR, "--wrench", "tool:2,-1,0,0,0,3", "--in", "link2")), rtol=0, atol=1e-12)
    # The tool is at (1, 0.8): its moment about the origin is 3 + 1 * 2 - 0.8 * 1.
    assert np.allclose(there, total(ask(*PLANAR, "--wrench", "tool@world:1,2,0,0,0,4.2")), rtol=0, atol=1e-12)


def test_several_wrenches_each_in_its_own_axes(ask):
    one = ("--wrench", "tool:1,0,0,0,0,0")
    two = ("--wrench", "link2:0,1,0,0,0,2")
    both = total(ask(*PLANAR, *one, *two, "--in", "world", "--in", "local"))
    apart = total(ask(*PLANAR, *one)) + total(ask(*PLANAR, *two, "--in", "local"))
    assert np.allclose(both, apart, rtol=0, atol=1e-12)
    local = total(ask(*PLANAR, *one, "--in", "local")) + total(ask(*PLANAR, *two, "--in", "local"))
    assert np.allclose(total(ask(*PLANAR, *one, *two, "--in", "local")), local, rtol=0, atol=1e-12)


def test_moments_first_is_the_same_wrench(ask):
    first = ask(*PANDA, "--wrench", "panda_hand:1,2,3,4,5,6", "--reactions")["result"]
    other = ask(*PANDA, "--wrench", "panda_hand:4,5,6,1,2,3", "--reactions", "--order", "angular-first")["result"]
    assert first["total"] == other["total"]
    assert other["wrenches"][0]["wrench"] == [4, 5, 6, 1, 2, 3]
    for link, found in first["reactions"]["links"].items():
        assert found["local"][3:] + found["local"][:3] == other["reactions"]["links"][link]["local"]


def test_the_environment_and_the_robot(ask, cli):
    words = (*PANDA, "--wrench", "panda_hand:1,2,3,4,5,6")
    assert np.allclose(total(ask(*words)), -total(ask(*words, "--on", "robot")), rtol=0, atol=1e-15)
    assert "the robot exerts it on its environment: tau = +J^T F" in flattened(cli("torque", *words).out)
    told = flattened(cli("torque", *words, "--on", "robot").out)
    assert "it acts on the robot: holding torque tau = -J^T F" in told


ODD = """<robot name="odd"><link name="base"/><link name="a@b:c"/><link name="a"/><link name="x@world"/>
<joint name="j=1" type="revolute"><parent link="base"/><child link="a@b:c"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="10" velocity="1"/></joint>
<joint name="f" type="fixed"><parent link="a@b:c"/><child link="a"/></joint>
<joint name="g" type="fixed"><parent link="a"/><child link="x@world"/><origin xyz="2 0 0"/></joint></robot>"""


@pytest.mark.parametrize(
    ("wrench", "expected"),
    [
        ("a@b:c:0,0,1,0,0,0", 0),
        ("a@b:c@0.5,0,0:0,0,1,0,0,0", -0.5),
        ("a@0.5,0,0:0,0,1,0,0,0", -0.5),
        ("x@world:0,0,1,0,0,0", -2),
        ("x@world@world:0,0,1,0,0,0", 0),
        ("x@world@1 0 0:0 0 1 0 0 0", -3),
    ],
)
def test_names_with_signs_in_them(ask, tmp_path, wrench, expected):
    (tmp_path / "odd.urdf").write_text(ODD)
    result = ask(tmp_path / "odd.urdf", "--wrench", wrench, "--effort-limits", "j=1=4")["result"]
    assert result["total"]["j=1"] == pytest.approx(expected, abs=1e-12)
    assert result["effort_limits"]["j=1"]["upper"] == 4


# --- pages ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "question",
    [
        (*PANDA, "--gravity", "--payload", "2@0.1,0.2,0.3", "--reactions", "--max", "all"),
        (*PANDA, "--gravity", "--wrench", "panda_hand@0.123,0.456,-0.789:1.5,2.5,3.5,4.5,5.5,6.5", "--max", "-z"),
        (*UR5, "--max", "all", "--axes", "rxyz", "--reactions"),
        (*UR5, "--worst", "--samples", "20", "--payload", "3"),
        ("example:talos_full_v2", "--gravity", "--reactions", "--base", "floating"),
        ("textbook:planar_2r", "--max", "all"),
        ("tests/corpus/files/nm_10k.urdf", "--gravity"),
    ],
    ids=" ".join,
)
def test_pages_fit_and_say_units(cli, question, request):
    if question[0].startswith("tests/"):
        question = (request.config.rootpath / question[0], *question[1:])
    answer = cli("torque", *question)
    assert answer.code == 0, answer.err
    assert max(map(len, answer.out.splitlines())) <= 80
    assert "unit" in answer.out
    assert "agree: largest difference" in flattened(answer.out)


def test_the_page_in_words(cli):
    page = flattened(cli("torque", *PANDA, "--gravity", "--payload", "2", "--max", "payload").out)
    assert "joint torques that hold the robot still (gravity, payload)" in page
    assert "panda_joint4 is nearest to its effort limit: 36.0 %" in page
    assert "largest payload at the origin of panda_hand" in page
    assert "stopped by panda_joint6" in page
    assert "gravity (0, 0, -9.81) m/s2" in page
    heavy = flattened(cli("torque", *PANDA, "--gravity", "--payload", "40").out)
    assert "more than the joint can give" in heavy


def test_an_overload_says_what_is_needed(cli):
    words = ("textbook:planar_2r", "--gravity-vector", "0,-9.81,0", "--effort-limits", "joint1=50")
    assert "no force along (0, 1, 0)" in flattened(cli("torque", *words, "--max", "y").out)
    relieved = flattened(cli("torque", *words, "--max", "-y").out)
    assert "is needed, or a joint exceeds its limit" in relieved


def test_csv_is_a_row_for_each_joint(cli, ask):
    question = (*PANDA, "--gravity", "--payload", "2")
    rows = list(csv.DictReader(io.StringIO(cli("torque", *question, "-F", "csv").out)))
    result = ask(*question)["result"]
    assert [row["joint"] for row in rows] == result["columns"]
    for row in rows:
        name = row["joint"]
        assert float(row["total"]) == result["total"][name]
        assert float(row["from_payload"]) == result["from_payload"][name]
        assert float(row["upper"]) == result["effort_limits"][name]["upper"]
        assert float(row["utilisation"]) == result["utilisation"][name]
        assert row["unit"] == result["units"][result["columns"].index(name)]


def test_warnings_of_masses_go_to_the_error_stream(cli, arm):
    answer = cli("torque", arm, "--gravity")
    assert answer.code == 0
    assert "no link that moves has a mass" in answer.err
    assert "warning" not in answer.out
    assert "no link that moves has a mass" in " ".join(cli("torque", arm, "--gravity", "-F", "json").json["warnings"])


def test_one_engine_alone_says_so(cli):
    assert "not cross-checked" in cli("torque", *PANDA, "--gravity", "--no-crosscheck").out


# --- pictures ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("robot", [PANDA, PLANAR, (*UR5, "--axes", "rxyz"), ("textbook:planar_2r",)], ids=" ".join)
def test_a_plot_is_written_beside_the_answer(cli, tmp_path, robot):
    pytest.importorskip("matplotlib")
    path = tmp_path / "forces.svg"
    answer = cli("torque", *robot, "--max", "all", "--plot", path)
    assert answer.code == 0, answer.err
    assert "corners of the polytope" in answer.out
    assert ET.parse(path).getroot().tag.endswith("svg")
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("name", "words", "part"),
    [
        ("f.bmp", ("--max", "all"), ".svg"),
        ("f", ("--max", "all"), ".svg"),
        ("nowhere/f.svg", ("--max", "all"), "cannot write"),
        ("f.svg", ("--max", "z"), "--max all"),
        ("f.svg", ("--gravity",), "--max all"),
    ],
)
def test_a_plot_that_cannot_be_is_refused(refused, tmp_path, name, words, part):
    assert part in refused(*PLANAR, *words, "--plot", tmp_path / name)
    assert list(tmp_path.iterdir()) == []


# --- refusals ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "part"),
    [
        ((), "nothing loads the robot"),
        (("--wrench", "tool"), "names no frame"),
        (("--wrench", "hand:0,0,0,0,0,0"), "no frame 'hand'"),
        (("--wrench", ":0,0,0,0,0,0"), "no frame ''"),
        (("--wrench", "tool:0,0,0,0,0"), "6 finite numbers"),
        (("--wrench", "tool:0,0,0,0,0,nan"), "6 finite numbers"),
        (("--wrench", "tool:0,0,0,0,0,x"), "6 finite numbers"),
        (("--wrench", "tool:0,0,0,0,0,1e300"), "within 1e+09"),
        (("--wrench", "tool@0,0:0,0,0,0,0,0"), "3 finite numbers"),
        (("--wrench", "tool@tip:0,0,0,0,0,0"), "3 finite numbers"),
        (("--wrench", "tool:0,0,0,0,0,0", "--in", "hand"), "no frame 'hand'"),
        (("--wrench", "tool:0,0,0,0,0,0", "--in", "world", "--in", "local"), "2 times --in"),
        (("--wrench", "tool:0,0,0,0,0,0", "--on", "earth"), "--on"),
        (("--gravity-vector", "0,0"), "3 finite numbers"),
        (("--gravity-vector", "0,0,inf"), "finite"),
        (("--payload", "-1"), "payload"),
        (("--payload", "nan"), "not nan"),
        (("--payload", "two"), "KG@X,Y,Z"),
        (("--payload", "1@0,0"), "KG@X,Y,Z"),
        (("--payload", "1", "-f", "hand"), "no frame 'hand'"),
        (("--max", "up"), "x, -z, three numbers"),
        (("--max", "0,0,0"), "direction"),
        (("--max", "z", "-f", "hand"), "no frame 'hand'"),
        (("--max", "z", "--point", "0,0"), "--point"),
        (("--max", "z", "--expressed-in", "hand"), "no frame 'hand'"),
        (("--max", "all", "--axes", "x", "rz"), "no common scale"),
        (("--worst", "--samples", "0"), "--samples"),
        (("--worst", "--samples", "2000000"), "samples"),
        (("--gravity", "--effort-limits", "joint1"), "joint=number"),
        (("--gravity", "--effort-limits", "joint1=1,joint1=2"), "twice"),
        (("--gravity", "--effort-limits", "joint1=two"), "joint=number"),
        (("--gravity", "--effort-limits", "joint1=0"), "joint1"),
        (("--gravity", "--effort-limits", "joint1=1:2"), "joint1"),
        (("--gravity", "--effort-limits", "joint1=nan"), "joint1"),
        (("--gravity", "--effort-limits", "elbow=1"), "no joint 'elbow'"),
        (("--gravity", "--effort-limits", "tool_joint=1"), "tool_joint"),
        (("--gravity", "-q", "1,2,3"), "3 positions"),
        (("--wrench", "\x1b[31m:0,0,0,0,0,0"), r"\x1b"),
        (("--max", "\x1b[31m"), r"\x1b"),
        (("--gravity", "--effort-limits", "\x1b[31m"), r"\x1b"),
    ],
    ids=lambda words: " ".join(words) if isinstance(words, tuple) else "",
)
def test_what_cannot_be_is_refused(refused, words, part):
    line = refused("textbook:planar_2r", *words)
    assert part in line
    assert "\x1b" not in line


def test_a_robot_that_cannot_be_read_is_another_code(refused, tmp_path):
    (tmp_path / "no.urdf").write_text("no robot")
    refused(tmp_path / "no.urdf", "--gravity", code=3)


def test_a_missing_limit_names_the_joint_and_the_option(refused, arm):
    arm.write_text(arm.read_text().replace('effort="1" ', 'effort="0" '))
    line = refused(arm, "--max", "x")
    assert "effort limit of joint" in line
    assert "--effort-limits" in line
    assert "the file says 0" in line


@pytest.mark.parametrize("name", ["fixed_only", "floating", "mass_zero", "lim_no_effort", "name_root_joint"])
def test_odd_robots_are_answered(cli, request, name):
    path = request.config.rootpath / "tests" / "corpus" / "files" / f"{name}.urdf"
    answer = cli(
        "torque", path, "--gravity", "--reactions", "--wrench", f"{ks.load(path).robot.links[-1].name}:1,2,3,4,5,6"
    )
    assert answer.code == 0, answer.err


@pytest.mark.parametrize("command", [("--gravity",), ("--reactions", "--gravity"), ("--max", "all"), ("--worst",)])
def test_the_help_has_an_example_that_works(cli, command):
    assert "kinetostat torque example:panda" in flattened(cli("torque", "--help").out)
    example = ("torque", "example:panda", "-f", "panda_hand", "-q", "default", "--payload", "2")
    assert cli(*example, *command).code == 0


def test_a_payload_weighs_without_gravity_of_the_links(ask):
    alone = ask(*PANDA, "--payload", "3")["result"]
    both = ask(*PANDA, "--payload", "3", "--gravity")["result"]
    assert max(map(abs, alone["from_payload"].values())) > 1
    assert alone["from_payload"] == both["from_payload"]
    assert alone["total"] == alone["from_payload"]
    assert set(alone["gravity"].values()) == {0}
    assert alone["payload"]["gravity_vector"] == [0, 0, -9.81]
    assert set(ask(*PANDA, "--payload", "3", "--gravity-vector", "0,0,0")["result"]["total"].values()) == {0}


def test_the_largest_payload_over_a_list_is_that_of_each_row(cli, ask, tmp_path):
    rows = ["0,-0.5,0,-2,0,1.6,0.8,0.01", "0.3,0.4,0.1,-1.5,0.2,1.8,0.1,0"]
    (tmp_path / "q.csv").write_text("\n".join(rows))
    question = ("example:panda", "-f", "panda_hand", "--max", "payload")
    listed = list(csv.DictReader(io.StringIO(cli("torque", *question, "--qs", str(tmp_path / "q.csv")).out)))
    for row, q in zip(listed, rows, strict=True):
        most = ask(*question, "-q", q)["result"]["max"]
        assert float(row["max_payload [kg]"]) == pytest.approx(most["value"], rel=1e-12)
        assert row["stopped_by"] == most["binding_joint"]
