"""`kinetostat singular at` and `singular find`: JSON keys, tables, CSV, exit codes, hostile names."""

import csv
import io
import json
import math

import pytest

import kinetostat as ks

FIND_KEYS = {"families", "starts", "converged", "unclassified", "coverage", "generic_rank", "frame", "relative_to"}
FAMILY_KEYS = {"condition", "codimension", "kind", "name", "witness", "hits"}
AT_KEYS = {
    "singular",
    "rank",
    "generic_rank",
    "singular_values",
    "lost",
    "self_motions",
    "kind",
    "causes",
    "distance",
    "frame",
    "relative_to",
}
KINDS = {"fold", "boundary", "traversable", "tangential"}
ROBOTS = [
    ("example:ur5_robot", "tool0", None),
    ("example:panda", "panda_hand", None),
    ("example:pr2", "r_gripper_tool_frame", "torso_lift_link"),
    ("example:so100", "gripper", None),
    ("textbook:stanford", "tool", None),
    ("textbook:modern_robotics_hhhh", "tool", None),
    ("textbook:planar_1r", "tool", None),
]

REDUNDANT = {"example:panda", "example:pr2"}


def words(robot, frame, observer):
    return [robot, "-f", frame, *([] if observer is None else ["--relative-to", observer])]


def strictly(text):
    """Parse JSON that has no NaN and no infinity."""

    def refuse(literal):
        raise AssertionError(literal)

    return json.loads(text, parse_constant=refuse)


def numbers(value):
    if isinstance(value, dict):
        for part in value.values():
            yield from numbers(part)
    elif isinstance(value, list):
        for part in value:
            yield from numbers(part)
    elif isinstance(value, float):
        yield value


@pytest.mark.parametrize(("robot", "frame", "observer"), ROBOTS)
def test_find_as_json(cli, robot, frame, observer):
    done = cli("singular", "find", *words(robot, frame, observer), "--starts", "60", "-F", "json")
    assert done.code == 0
    payload = strictly(done.out)
    assert payload["schema"] == "kinetostat/singular find/1"
    assert set(payload) >= {"schema", "robot", "result", "crosscheck", "warnings"}
    assert payload["crosscheck"]["agree"] is True
    result = payload["result"]
    assert set(result) >= FIND_KEYS
    assert result["starts"] == 60
    assert set(result["coverage"]) >= {"families_seen_once", "good_turing_unseen"}
    for family in result["families"]:
        assert set(family) >= FAMILY_KEYS
        assert set(family["kind"].split(" or ")) <= KINDS
        assert set(family["witness"]) == {"configuration", "singular_values"}
        assert set(family["witness"]["configuration"]) == set(result["columns"])
        assert family["witness"]["singular_values"][result["generic_rank"] - 1] < 1e-9
        assert family["condition"]
        assert all(joint in family["condition"] for joint in family["support"])
    assert all(math.isfinite(x) for x in numbers(result))


@pytest.mark.parametrize(("robot", "frame", "observer"), ROBOTS)
def test_at_as_json(cli, robot, frame, observer):
    for q in ("random:3", "zero"):
        done = cli("singular", "at", *words(robot, frame, observer), "-q", q, "-F", "json")
        assert done.code == 0
        payload = strictly(done.out)
        assert payload["schema"] == "kinetostat/singular at/1"
        assert set(payload) >= {"schema", "robot", "configuration", "result", "crosscheck", "warnings"}
        result = payload["result"]
        assert set(result) >= AT_KEYS
        assert result["singular"] == (result["rank"] < result["generic_rank"])
        assert (result["kind"] in KINDS) if result["singular"] else result["kind"] is None
        for wrench in result["lost"]:
            assert set(wrench) >= {"wrench", "axis", "point", "pitch"}
            assert wrench["pitch"] is not None or "reason" in wrench
        for motion in result["self_motions"]:
            assert set(motion) == set(result["columns"])
        for cause in result["causes"]:
            assert cause["text"]
            assert set(cause["joints"]) <= set(result["columns"])
        assert result["distance"]["configuration"] is not None or "reason" in result["distance"]
        assert all(math.isfinite(x) for x in numbers(result))


def test_at_and_find_agree_through_the_command_line(cli):
    found = cli("singular", "find", "textbook:puma560", "--starts", "100", "-F", "json").json["result"]
    for family in found["families"]:
        q = ",".join(f"{joint}={value!r}" for joint, value in family["witness"]["configuration"].items())
        answer = cli("singular", "at", "textbook:puma560", "-q", q, "-F", "json").json["result"]
        assert answer["singular"] is True
        assert answer["tolerance"] == "strict"
        assert answer["kind"] in family["kind"].split(" or ")


def assert_fits(done):
    assert done.code == 0
    assert not [line for line in done.out.splitlines() if len(line) > 80]
    assert not [line for line in done.out.splitlines() if line != line.rstrip()]
    assert not {"nan", "inf", "None"} & set(done.out.split())


@pytest.mark.parametrize(("robot", "frame", "observer"), ROBOTS)
def test_tables_of_families_fit_a_screen(cli, robot, frame, observer):
    assert_fits(cli("singular", "find", *words(robot, frame, observer), "--starts", "60"))


@pytest.mark.parametrize(("robot", "frame", "observer"), [r for r in ROBOTS if r[0] not in REDUNDANT])
def test_tables_of_one_configuration_fit_a_screen(cli, robot, frame, observer):
    for how in (["-q", "random:1"], ["--deg"]):
        assert_fits(cli("singular", "at", *words(robot, frame, observer), *how))


@pytest.mark.parametrize(("robot", "frame", "observer"), ROBOTS)
def test_csv_parses(cli, robot, frame, observer):
    at = cli("singular", "at", *words(robot, frame, observer), "-q", "random:1", "-F", "csv")
    assert at.code == 0
    (row,) = csv.DictReader(io.StringIO(at.out))
    assert row["singular"] in ("true", "false")
    assert int(row["rank"]) <= int(row["generic_rank"])
    find = cli("singular", "find", *words(robot, frame, observer), "--starts", "60", "-F", "csv")
    assert find.code == 0
    for family in csv.DictReader(io.StringIO(find.out)):
        assert None not in family
        assert None not in family.values()
        assert set(family["kind"].split(" or ")) <= KINDS
        assert float(family["smallest"]) < 1e-9
        assert family["inside_limits"] in ("true", "false")
        assert int(family["codimension"]) >= 1


def test_the_same_words_twice(cli):
    ask = ["singular", "find", "textbook:puma560", "--starts", "100", "--seed", "7", "-F", "json"]
    assert cli(*ask).out == cli(*ask).out
    other = cli(*ask[:-3], "8", *ask[-2:])
    assert other.json["result"]["converged"] > 90


def test_degrees(cli):
    text = cli("singular", "find", "textbook:puma560", "--starts", "100", "--deg").out
    assert "joint5 = 180 deg" in text
    assert "joint3 = -87.3" in text
    assert "deg" not in cli("singular", "find", "textbook:puma560", "--starts", "100").out
    at = cli("singular", "at", "textbook:puma560", "-q", "10,20,30,40,0,60", "--deg").out
    assert at.startswith("singular (wrist): tangential")
    assert "joint5 = 0 deg, whatever the other joints do (wrist)" in at
    # JSON stays in radians.
    payload = cli("singular", "at", "textbook:puma560", "-q", "10,20,30,40,0,60", "--deg", "-F", "json").json
    assert payload["configuration"]["joint4"] == pytest.approx(math.radians(40))
    near = cli("singular", "at", "textbook:puma560", "-q", "10,20,30,40,5,60", "--deg")
    assert "5 deg, inside limits" in near.out


def test_axes_point_and_observer(cli):
    ask = ["singular", "at", "textbook:planar_3r", "-q", "0,0,0", "-F", "json"]
    assert cli(*ask, "--axes", "xy").json["result"]["rank"] == 1
    assert cli(*ask, "--axes", "xy").json["result"]["rows"] == ["vx", "vy"]
    assert cli(*ask, "--axes", "x,y,rz").json["result"]["rank"] == 2
    moved = cli(*ask, "--axes", "xy", "--point", "0,0.5,0").json["result"]
    assert moved["point"] == [0, 0.5, 0]
    assert moved["rank"] == 2
    inner = cli(*ask, "--relative-to", "link1").json["result"]
    assert inner["columns"] == ["joint2", "joint3"]


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (["at", "textbook:puma560", "-f", "tol"], 2, "there is no frame 'tol'"),
        (["find", "textbook:puma560", "-f", "base"], 2, "no joint moves 'base'"),
        (["find", "textbook:rigid_body", "-f", "a"], 2, "no joint moves"),
        (["find", "textbook:puma560", "--base", "floating"], 2, "floating joint"),
        (["at", "textbook:puma560", "--axes", "up"], 2, "there is no axis 'up'"),
        (["at", "textbook:planar_2r", "--axes", "z"], 2, "along vz"),
        (["find", "textbook:puma560", "--starts", "0"], 2, "--starts"),
        (["find", "textbook:puma560", "--seed", "-1"], 2, "--seed"),
        (["at", "textbook:puma560", "--point", "1,2"], 2, "--point"),
        (["at", "textbook:puma560", "-q", "joint9=1"], 2, "joint9"),
        (["at", "textbook:puma560", "-q", "nan,0,0,0,0,0"], 2, ""),
        (["at", "nowhere.urdf"], 3, "nowhere.urdf"),
        (["at"], 2, ""),
    ],
)
def test_exit_codes(cli, arguments, code, says):
    done = cli("singular", *arguments)
    assert (done.code, done.out) == (code, "")
    assert says in done.err
    assert "Traceback" not in done.err


def test_help_says_what_it_does(cli):
    for command in ("at", "find"):
        done = cli("singular", command, "--help")
        assert done.code == 0
        assert "Example:" in done.out
        assert "--relative-to" in done.out


def test_a_structural_deficit_is_a_warning_on_the_side(cli):
    done = cli("singular", "at", "textbook:scara", "-q", "random:1")
    assert "no singularity" in done.err
    assert "no singularity" not in done.out
    assert done.out.startswith("not singular")


def test_without_crosscheck(cli):
    payload = cli("singular", "at", "textbook:puma560", "--no-crosscheck", "-F", "json").json
    assert payload["crosscheck"]["agree"] is None
    assert "reason" in payload["crosscheck"]
    assert cli("singular", "find", "textbook:scara", "--starts", "20", "--no-crosscheck").code == 0


def test_a_value_outside_limits_warns(cli):
    done = cli("singular", "at", "textbook:planar_2r_6_3", "-q", "0.1,3.14159265358979")
    assert done.code == 0
    assert "joint2" in done.err
    assert done.out.startswith("singular (elbow): fold")


# --- names are data, whatever they are -------------------------------------------------------------------------------

HOSTILE = [
    "\u202eevil",
    "bell&#9;tab",
    "&lt;script&gt;",
    "[red]name[/red]",
    "a, b and c = 0",
    '"quoted"',
    "line&#10;break",
    "=1+1",
]


@pytest.fixture(params=HOSTILE)
def hostile(request, tmp_path):
    """A planar arm whose elbow has an odd name."""
    name = request.param.replace('"', "&quot;")
    path = tmp_path / "odd.urdf"
    path.write_text(
        f"""<robot name="odd"><link name="a"/><link name="b"/><link name="c"/><link name="tip"/>
<joint name="first" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
<joint name="{name}" type="continuous"><parent link="b"/><child link="c"/><origin xyz="1 0 0"/>
<axis xyz="0 0 1"/></joint>
<joint name="end" type="fixed"><parent link="c"/><child link="tip"/><origin xyz="0.5 0 0"/></joint></robot>""",
        encoding="utf-8",
    )
    return path


def test_hostile_names_are_inert(cli, hostile):
    true_name = ks.load(str(hostile)).robot.independent[1].name
    for command in ("find", "at"):
        for form in ("table", "csv") if command == "find" else ("table",):
            done = cli("singular", command, hostile, "-F", form)
            assert done.code == 0
            assert not set(done.out + done.err) & set("\t\x1b\u202e\x00")
            if form == "csv":
                rows = list(csv.reader(io.StringIO(done.out)))
                assert len({len(row) for row in rows}) == 1
                assert len(rows) == (3 if command == "find" else 2)
        payload = strictly(cli("singular", command, hostile, "-F", "json").out)
        assert true_name in payload["result"]["columns"]
        if command == "find":
            assert [list(f["positions"]) for f in payload["result"]["families"]] == [[true_name], [true_name]]
            text = payload["result"]["families"][0]["condition"]
            assert not set(text) & set("\n\t\u202e\x1b")
        else:
            assert any(true_name in cause["joints"] for cause in payload["result"]["causes"])
            assert not set("".join(c["text"] for c in payload["result"]["causes"])) & set("\n\t\u202e\x1b")


def test_an_answer_goes_to_a_file(cli, tmp_path):
    target = tmp_path / "families.json"
    done = cli("singular", "find", "textbook:planar_2r", "--starts", "20", "-F", "json", "-o", target)
    assert (done.code, done.out) == (0, "")
    assert len(strictly(target.read_text())["result"]["families"]) == 2


def test_pictures_are_written_whole_or_refused_first(cli, tmp_path):
    plane, cut = tmp_path / "plane.svg", tmp_path / "cut.png"
    assert cli("singular", "find", "textbook:planar_2r_6_3", "--starts", "20", "--plot", str(plane)).code == 0
    assert plane.read_text(encoding="utf-8").count("joint2 = 0") >= 1
    done = cli(
        *("singular", "find", "textbook:stanford", "--starts", "20", "--plot", str(cut)),
        *("--joints", "joint3,joint5", "--deg"),
    )
    assert done.code == 0
    assert cut.read_bytes().startswith(b"\x89PNG")
    refused = cli("singular", "find", "textbook:stanford", "--plot", str(tmp_path / "picture.jpg"))
    assert refused.code == 2
    assert "picture's format" in refused.err
    unknown = cli("singular", "find", "textbook:stanford", "--plot", str(cut), "--joints", "joint3,joint55")
    assert unknown.code == 2
    assert "did you mean" in unknown.err


def test_rows_in_the_tools_axes(cli):
    asked = ("example:ur5_robot", "-f", "tool0", "--axes", "xyz", "rx", "ry", "--reference", "local")
    result = cli("singular", "at", *asked, "-q", "0.1,-0.5,0,0.2,1,0.3", "-F", "json").json["result"]
    assert result["expressed_in"] == "tool0"
    assert result["rows"] == ["vx", "vy", "vz", "wx", "wy"]
    assert (result["rank"], result["generic_rank"]) == (4, 5)
    shown = cli("singular", "find", *asked, "--starts", "50").out
    assert "rows that count: vx vy vz wx wy in the axes of tool0" in " ".join(shown.split())
    assert cli("singular", "find", *asked[:-1], "world").code == 2
