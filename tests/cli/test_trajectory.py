"""`kinetostat trajectory`: files of every form, rows that cannot be used, tables, rows, JSON, pictures."""

import csv
import io
import json
import re
import sys

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.report import trajectory_rows
from kinetostat.report.row_files.fields import RowField
from kinetostat.report.row_files.opening import open_rows
from kinetostat_cli import recording

ROBOT = "textbook:planar_2r"
TIME = np.linspace(0, 2, 81)
Q = np.stack([0.3 * TIME, 1 - TIME], axis=1)


def text(rows, header="time [s],joint1,joint2"):
    return "\n".join([header, *(",".join(repr(float(x)) for x in row) for row in rows)]) + "\n"


def timed(count=81):
    return np.column_stack([TIME, Q])[:count]


@pytest.fixture
def asked(cli, tmp_path):
    """Write a trajectory, ask, and return the outcome."""

    def call(content, *more, name="way.csv", robot=ROBOT, code=0):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        answer = cli("trajectory", robot, path, *more)
        assert answer.code == code, answer.err
        assert "bug in kinetostat" not in answer.err
        return answer

    return call


def table(answer):
    return list(csv.DictReader(io.StringIO(answer.out)))


def parquet(path, columns, metadata=None):
    """Write columns by name to a Parquet file."""
    pa = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    fields = [pa.field(n, pa.array(v).type, metadata=(metadata or {}).get(n)) for n, v in columns.items()]
    parquet.write_table(pa.table([pa.array(v) for v in columns.values()], schema=pa.schema(fields)), path)
    return path.read_bytes()


# --- what is told ----------------------------------------------------------------------------------------------------


def test_the_table_tells_the_stretch_and_its_cause(asked):
    out = asked(text(timed())).out
    assert "samples                 81" in out
    assert "elbow" in out
    assert "joint2 = 0" in out
    assert "33.33" in out  # percent of joint2's velocity limit
    assert "pinocchio and screw and kernel agree" in out
    assert max(map(len, out.splitlines())) <= 80


def test_json(asked):
    result = asked(text(timed()), "-F", "json").json
    assert result["schema"] == "kinetostat/trajectory/1"
    assert result["crosscheck"]["agree"] is True
    body = result["result"]
    (span,) = body["near_singular"]["spans"]
    assert span["worst"] == {"row": 41, "time": 1.0}
    assert span["cause"]["name"] == "elbow"
    assert span["cause"]["conditions"] == [{"positions": {"joint2": 0.0}, "name": "elbow"}]
    assert span["needed"]["rates"] == {"joint1": None, "joint2": None}
    assert "reason" in span["needed"]
    lines = body["timeline"]
    assert lines["row"] == list(range(1, 82))
    np.testing.assert_allclose(lines["q"]["values"], Q, atol=1e-15)
    np.testing.assert_allclose(lines["qdot"]["values"], np.tile([0.3, -1.0], (81, 1)), atol=1e-12)
    assert lines["time"]["units"] == ["s"]
    assert lines["twist"]["columns"] == ["vx", "vy", "vz", "wx", "wy", "wz"]
    assert {len(lines[name]["values"]) for name in lines if name != "row"} == {81}


def test_a_row_out_for_each_row_in(asked):
    rows = timed()
    found = table(asked(text(rows), "-F", "csv"))
    assert len(found) == 81
    np.testing.assert_allclose([float(row["q.joint2 [rad]"]) for row in found], Q[:, 1], atol=1e-15)
    model = ks.load(ROBOT)
    np.testing.assert_allclose(
        [float(row["x [m]"]) for row in found], ks.fk(model, "tool", Q).position[:, 0], atol=1e-12
    )
    near = [row["near_singular"] for row in found]
    ratio = np.array([float(row["inverse_condition_number [1]"]) for row in found])
    assert near == ["yes" if small else "no" for small in ratio < 0.01]
    assert {row["reason"] for row in found} == {""}


def test_violations_stand_in_their_rows(asked):
    rows = timed()
    rows[50:, 2] += 1.0
    answer = asked(text(rows), "-F", "csv")
    found = table(answer)
    assert [row["row"] for row in found if row["violations"]] == ["50", "51"]
    assert found[49]["violations"] == "joint2 velocity"
    assert "beyond limits" in asked(text(rows)).out


def test_without_time_nothing_is_said_of_speed(asked):
    answer = asked(text(Q, "joint1,joint2"))
    assert "without time" in answer.out
    assert "tool speed" not in answer.out
    assert "row 41" in answer.out
    assert not any("qdot" in name for name in table(asked(text(Q, "joint1,joint2"), "-F", "csv"))[0])
    result = asked(text(Q, "joint1,joint2"), "-F", "json").json["result"]
    assert result["time"] is None
    assert "time_reason" in result


def test_one_sample_with_a_time_is_not_called_without_time(asked):
    answer = asked(text(timed(1)))
    assert "one sample: nothing is said of velocities" in answer.out
    assert "without time" not in answer.out
    assert asked(text(timed(1)), "-F", "json").json["result"]["time_reason"] == "one sample"


def test_times_are_whole_however_long_it_takes(asked):
    time = np.arange(4000) * 0.25
    rows = np.column_stack([time, np.zeros(4000), 0.9 * np.sin(0.2 * time)])
    answer = asked(text(rows))
    page = answer.out.partition("near singular: ")[2]
    assert max(map(len, answer.out.splitlines())) <= 80
    assert ".." not in page
    assert "the 10 deepest of" in page
    table_rows = [line.split() for line in page.partition("\nwhy\n")[0].splitlines() if re.match(r"\d+ +\d", line)]
    assert [int(row[0]) for row in table_rows] == list(range(1, 11))
    ratios = [float(row[4]) for row in table_rows]
    assert ratios == sorted(ratios)
    assert all(re.fullmatch(r"\d+\.\d+", cell) for row in table_rows for cell in row[1:4])
    assert "1, 2, 3, 4, 5, 6, 7, 8, 9, 10: elbow: joint2 = 0" in page


def test_what_a_singularity_costs_is_told_in_words_and_only_with_time(asked):
    rows = timed()
    rows[:, 2] += 0.003
    page = " ".join(asked(text(rows)).out.split())
    assert "speed there" in page
    assert "would" in page
    assert re.search(r"\d rad/s \(joint[12], limit 3\)", page)
    assert "more than any rate" in asked(text(timed())).out
    without = asked(text(rows[:, 1:], "joint1,joint2"))
    assert "would need" not in without.out
    found = asked(text(rows[:, 1:], "joint1,joint2"), "-F", "json").json["result"]["near_singular"]["spans"]
    assert found[0]["needed"] is None


def test_rounding_noise_is_zero_and_a_plateau_begins_where_it_begins(asked):
    time = np.arange(100) * 0.1
    rows = np.column_stack([time, np.where(time < 3, 0.0, 4.7 * (time - 3)), np.full(100, 1e-15)])
    out = asked(text(rows)).out
    (least,) = (line.split() for line in out.splitlines() if line.startswith("smallest / largest"))
    assert least[4:7] == ["0", "1", "0.0"]
    assert "e-1" not in out.partition("\n\nrates are")[0]
    (fast,) = (line for line in out.splitlines() if line.startswith("velocity limit used"))
    assert "3.1 s" in fast
    result = asked(text(rows), "-F", "json").json["result"]
    (violation,) = (one for one in result["violations"] if one["kind"] == "velocity")
    assert violation["worst"]["row"] == 32
    assert {one["unit"] for one in result["extremes"].values()} <= {"1", "m/rad", "m/s", "rad/s", "(m/rad)^2"}


def test_one_sample(asked):
    out = asked(text(timed(1))).out
    assert "samples                 1" in out
    assert "0 m" in out


def test_degrees_are_shown(asked):
    out = asked(text(np.column_stack([TIME, np.degrees(Q)])), "--deg").out
    assert "joint2 = 0 deg" in out
    assert re.search(r"40\.11 +deg/s", out)  # 0.7 rad/s
    assert "rad/s" not in out


# --- what it was computed for ----------------------------------------------------------------------------------------

LOADED = (
    *("--payload", "5@0.1,0,0", "--gravity-vector", "0,-1.62,0", "--effort-limits", "joint1=500,joint2=-20:30"),
    *("--point", "0,0.1,0", "--axes", "x", "y", "rz", "--reference", "local", "--near", "0.02"),
)


def test_the_answer_says_what_it_was_computed_for(asked):
    page = " ".join(asked(text(timed()[:, [0, 2]], "time,joint2"), *LOADED, "-q", "joint1=0.5").out.split())
    for said in (
        "gravity (0, -1.62, 0) m/s2 in the axes of base",
        "payload 5 kg at (0.1, 0, 0) m of tool",
        "effort limits as given: joint1 500, joint2 -20:30",
        "point (0, 0.1, 0) m of tool",
        "in the axes of tool",
        "lengths in units of",
        "joints that the file does not name: at joint1 0.5",
    ):
        assert said in page
    plain = asked(text(timed())).out
    assert not any(word in plain for word in ("payload", "gravity", "as given", "does not name"))


def test_json_says_all_that_was_asked(asked):
    answer = asked(text(timed()[:, [0, 2]], "time,joint2"), *LOADED, "-q", "joint1=0.5", "-F", "json").json
    known = answer["result"]["asked"]
    assert known["characteristic_length"] == answer["result"]["characteristic_length"] > 0
    assert known["characteristic_length_reference"].startswith("auto")
    assert known["payload"] == {"mass": 5.0, "frame": "tool", "point": [0.1, 0.0, 0.0]}
    assert known["gravity"] == [0.0, -1.62, 0.0]
    assert known["effort_limits"] == {"joint1": 500, "joint2": [-20, 30]}
    assert known["held"] == answer["configuration"] == {"joint1": 0.5}
    assert (known["frame"], known["relative_to"], known["point"]) == ("tool", "base", [0.0, 0.1, 0.0])
    assert (known["reference"], known["expressed_in"], known["near_singular_below"]) == ("local", "tool", 0.02)
    assert known["rows"] == ["vx", "vy", "wz"]
    assert asked(text(timed()), "-F", "json").json["configuration"] == {}


def test_only_joints_that_are_held_are_warned_of(asked):
    model = ks.load("example:panda")
    names = model.robot.position_names
    way = np.linspace(*ks.random_configurations(model, 5, 2), 9)
    place = names.index("panda_joint4")
    panda = {"robot": "example:panda"}
    assert "panda_joint4" not in asked(text(way, ",".join(names)), "-f", "panda_hand", **panda).err
    others = ",".join(names[:place] + names[place + 1 :])
    assert (
        "'panda_joint4' is at 0 rad" in asked(text(np.delete(way, place, 1), others), "-f", "panda_hand", **panda).err
    )
    (near, *_) = asked(text(way, ",".join(names)), "-f", "panda_hand", "-q", "panda_joint1=9", **panda).err.split("\n")
    assert "panda_joint1" not in near


def test_what_follows_a_named_joint_is_not_warned_of(asked, arm):
    names = [j.name for j in ks.load(str(arm)).robot.independent]
    answer = asked(text(np.zeros((3, len(names))), ",".join(names)), "-q", f"{names[0]}=100", robot=arm)
    assert "outside" not in answer.err


def test_metres_and_radians_are_mixed_with_a_warning(asked):
    panda = text(np.full((3, 1), 0.3), "panda_joint2")
    more = ("-f", "panda_hand", "-q", "panda_joint4=-1.5")
    mixed = asked(panda, *more, "--length", "none", robot="example:panda")
    assert "m and rad are mixed" in mixed.err
    assert "metres and radians are mixed" in mixed.out
    assert "mixed" not in asked(panda, *more, robot="example:panda").err


# --- forms of files --------------------------------------------------------------------------------------------------


def positions(answer):
    return np.array([[float(row[f"q.joint{i} [rad]"]) for i in (1, 2)] for row in table(answer)])


FORMS = {
    "the other way round": text(np.column_stack([Q[:, ::-1], TIME]), "joint2,joint1,t"),
    "units": text(np.column_stack([TIME, np.degrees(Q[:, 0]), Q[:, 1]]), "t [s],joint1 [deg],joint2 [rad]"),
    "prefixed": text(np.column_stack([TIME, Q, Q]), "time,q.joint1,q.joint2,speed,mood"),
    "crlf": text(timed()).replace("\n", "\r\n"),
    "byte order mark": "\ufeff" + text(timed()),
    "blank lines": "\n\n" + text(timed()).replace("\n", "\n\n"),
    "blanks": text(timed()).replace(",", " , "),
    "quoted": text(timed()).replace("joint1", '"joint1"').replace("\n0.", '\n"0"0.').replace('"0"', ""),
    "without an end": text(timed()).rstrip(),
    "of numpy.savetxt": "# " + text(timed(), "time,joint1,joint2"),
    "Time": text(timed(), "Time [s],joint1,joint2"),
    "of ROS": text(timed(), "time_from_start,joint1,joint2"),
}


@pytest.mark.parametrize("form", FORMS)
def test_forms_of_a_file(asked, form):
    found = asked(FORMS[form], "-F", "csv")
    np.testing.assert_allclose(positions(found), Q, atol=1e-12)
    np.testing.assert_allclose([float(row["time [s]"]) for row in table(found)], TIME, atol=1e-12)


def test_no_header(asked):
    plain = "\n".join(f"{a!r},{b!r}" for a, b in Q.tolist())
    np.testing.assert_allclose(positions(asked(plain, "-F", "csv")), Q, atol=1e-15)
    assert "2 coordinates" in asked("0,1,2\n1,1,2\n", code=2).err


def test_standard_input(cli):
    answer = cli("trajectory", ROBOT, "-", "-F", "csv", stdin=text(timed()).encode())
    np.testing.assert_allclose(positions(answer), Q, atol=1e-15)


def test_joints_without_a_column_are_held(asked):
    answer = asked(text(np.column_stack([TIME, Q[:, 1]]), "time,joint2"), "-q", "joint1=0.7", "-F", "json")
    x = np.array(answer.json["result"]["timeline"]["pose"]["values"])[:, 0]
    held = np.column_stack([np.full(81, 0.7), Q[:, 1]])
    np.testing.assert_allclose(x, ks.fk(ks.load(ROBOT), "tool", held).position[:, 0], atol=1e-12)


def test_parquet_is_read_as_csv_is(asked, tmp_path):
    content = parquet(tmp_path / "a.parquet", {"joint2": Q[:, 1], "time": TIME, "joint1": Q[:, 0]})
    assert asked(content, "-F", "csv", name="b.parquet").out == asked(text(timed()), "-F", "csv").out


def test_parquet_with_units_in_its_metadata(asked, tmp_path):
    columns = {"row": np.arange(81), "joint1": np.degrees(Q[:, 0]), "joint2": Q[:, 1].astype(np.float32), "x": Q[:, 0]}
    units = {"joint1": {"unit": "deg"}, "joint2": {"unit": "rad"}}
    found = asked(parquet(tmp_path / "a.parquet", columns, units), "-F", "csv", name="b.parquet")
    np.testing.assert_allclose(positions(found), Q, atol=1e-7)


def test_parquet_rows_that_cannot_be_used(asked, tmp_path):
    joint = [0.1, None, float("nan"), 0.2, float("inf"), 0.3]
    content = parquet(tmp_path / "a.parquet", {"joint1": joint})
    answer = asked(content, "-F", "csv", name="b.parquet")
    assert [bool(row["reason"]) for row in table(answer)] == [False, True, True, False, True, False]
    assert "row 2: joint1: no number" in answer.err


def test_parquet_that_is_none(asked, tmp_path):
    assert "not Parquet" in asked(b"PAR1 nonsense", name="b.parquet", code=2).err
    words = parquet(tmp_path / "a.parquet", {"joint1": ["a", "b"]})
    assert "not Parquet of numbers" in asked(words, name="c.parquet", code=2).err


def test_pyarrow_that_is_missing_is_told(asked, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    answer = asked(b"", name="b.parquet", code=2)
    assert "kinetostat[parquet]" in answer.err
    assert len(answer.err.splitlines()) == 1


# --- what this tool has written --------------------------------------------------------------------------------------


def test_its_own_rows_are_read_back(asked):
    first = asked(text(timed()), "-F", "csv")
    again = asked(first.out, "-F", "csv", name="again.csv")
    assert again.out == first.out
    assert "left out: x, y, z" in again.err


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_files_of_rows_are_read(asked, tmp_path, ending):
    fields = [
        RowField("q", ("joint1", "joint2"), ("rad", "rad"), (2,)),
        RowField("gravity_torque", ("joint1", "joint2"), ("Nm", "Nm"), (2,)),
        RowField("yoshikawa", ("yoshikawa",), ("",)),
    ]
    path = tmp_path / f"rows.{ending}"
    with open_rows(path, fields, {}, 81) as rows:
        rows.write(np.arange(81), [Q, 9 * Q, Q[:, 0]])
    answer = asked(path.read_bytes(), "-F", "csv", "--deg", name=f"again.{ending}")
    np.testing.assert_allclose(positions(answer), Q, atol=1e-15)
    assert "left out: joint1_2, joint2_2, yoshikawa" in answer.err


def test_solutions_of_inverse_kinematics_are_read(cli, asked, tmp_path):
    poses = tmp_path / "poses.csv"
    poses.write_text("\n".join(f"{x},0.4,0" for x in (0.5, 0.7, 9.0, 0.9, 1.1)))
    solved = cli("ik", ROBOT, "--poses", poses, "--axes", "xy", "-q", "0.1,0.5")
    found = table(asked(solved.out, "-F", "csv", "--deg"))
    assert [row["row"] for row in found if row["reason"]] == ["3"]
    x = [float(row["x [m]"]) for row in found if not row["reason"]]
    np.testing.assert_allclose(x, [0.5, 0.7, 0.9, 1.1], atol=1e-6)


# --- rows that cannot be used ----------------------------------------------------------------------------------------

BAD = {
    "0.02,x,1": "joint1: 'x' is not a number",
    "0.02,,1": "joint1: no number",
    "0.02,1": "2 cells, 3 are needed",
    "0.02,1,2,3": "4 cells, 3 are needed",
    "0.02,nan,1": "joint1: nan is not a finite number",
    "0.02,1,-inf": "joint2: -inf is not a finite number",
    "0.02,1,1e7": "joint2: beyond 1e+06",
    "soon,1,2": "time: 'soon' is not a number",
    ",,": "an empty row",
    '0.02,"1,2': "not CSV",
    "0,1,2": "time 0 s is not after 0.01 s",
    "0.01,1,2": "time 0.01 s is not after 0.01 s",
    "1e9,1,2": "time 1e+09 s is after that of the rows that follow",
}


@pytest.mark.parametrize("row", BAD)
def test_a_bad_row_is_named_and_the_rest_is_done(asked, row):
    lines = ["time,joint1,joint2", "0,0.1,1", "0.01,0.2,1", row, "0.03,0.3,1", "", "0.04,0.35,1"]
    content = "\n".join(lines) + "\n"
    answer = asked(content, "-F", "csv")
    found = table(answer)
    assert [one["row"] for one in found] == ["1", "2", "3", "4", "5"]
    assert [bool(one["reason"]) for one in found] == [False, False, True, False, False]
    assert found[2]["reason"].startswith(BAD[row])
    assert f"row 3 (line 4): {BAD[row]}" in answer.err
    good = asked(content.replace(f"{row}\n", ""), "-F", "csv")
    for one, other in zip([*found[:2], *found[3:]], table(good), strict=True):
        assert one | {"row": ""} == other | {"row": ""}  # as though the bad row were not there
    (told,) = asked(content, "-F", "json").json["result"]["bad_rows"]
    assert (told["row"], told["line"]) == (3, 4)
    assert "5 rows, 1 left out" in asked(content).out


def test_bad_rows_far_into_a_long_file(asked, monkeypatch):
    monkeypatch.setattr(recording, "_BLOCK", 16)
    monkeypatch.setattr(trajectory_rows, "_AT_ONCE", 7)
    lines = text(timed()).splitlines()
    lines[3], lines[40], lines[80] = "x", "1,2", "0.5,1,1"
    found = table(asked("\n".join(lines), "-F", "csv"))
    assert [int(row["row"]) for row in found] == list(range(1, 82))
    assert [int(row["row"]) for row in found if row["reason"]] == [3, 40, 80]
    monkeypatch.undo()
    assert table(asked("\n".join(lines), "-F", "csv")) == found


def test_a_first_and_a_last_bad_row(asked):
    found = table(asked("joint1,joint2\nx,1\n0,0\n0.1,0\n1\n", "-F", "csv"))
    assert [bool(row["reason"]) for row in found] == [True, False, False, True]


def test_many_bad_rows_are_counted(asked):
    answer = asked("joint1\n" + "x\n" * 30 + "0.5\n")
    assert answer.err.count("(line ") == 10
    assert "30 of 31 rows are left out" in answer.err


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "empty"),
        ("\n\n", "empty"),
        ("joint1,joint2\n", "no row can be used"),
        ("joint1\nx\ny\n", "no row can be used; row 1 (line 2)"),
        ("time\n1\n2\n", "no column names a joint"),
        ("joint1,jiont2\n1,2\n", "did you mean 'joint2'"),
        ("joint1,joint1\n1,2\n", "twice"),
        ("joint1 [grad],joint2\n1,2\n", "grad"),
        ("time [min],joint2\n1,2\n", "min"),
        (b"joint1\n\xff\xfe\n", "UTF-8"),
        ("time;joint1;joint2\n0;1;2\n", "semicolons (separate them by commas"),
        ("time;joint1\n0,0;1,5\n", "semicolons (separate them by commas"),
        ("# time joint1 joint2\n0 1 2\n", "blanks (separate them by commas"),
        ("joint1\tjoint2\n1\t2\n", "tabs (separate them by commas"),
        ("0.1 0.2\n0.3 0.4\n", "blanks (separate them by commas"),
        ("timestamp,joint1\n1,2\n", "the column of time is named time"),
        ("stamp [s],joint1\n1,2\n", "the column of time is named time"),
    ],
    ids=repr,
)
def test_files_that_cannot_be_used(asked, content, said):
    answer = asked(content, code=2)
    assert said in answer.err
    assert len(answer.err.splitlines()) == 1


def test_columns_of_followers_and_floating_bases(asked, arm):
    assert "shoulder" in asked("elbow\n1\n2\n", robot=arm, code=2).err
    assert "floating" in asked("root_joint.x\n1\n2\n", "--base", "floating", code=2).err


@pytest.mark.parametrize("ending", ["json", "jsonl", "npz"])
def test_other_files_are_refused_in_a_line(asked, ending):
    answer = asked("{}", name=f"way.{ending}", code=2)
    assert "give .csv or .parquet" in answer.err
    assert len(answer.err.splitlines()) == 1


def test_no_such_file(cli, tmp_path):
    for name in ("none.csv", "none.parquet"):
        answer = cli("trajectory", ROBOT, tmp_path / name)
        assert answer.code == 2
        assert "there is no such file" in answer.err
    assert cli("trajectory", ROBOT, tmp_path).code == 2


# --- options ---------------------------------------------------------------------------------------------------------


def test_efforts_by_gravity_payload_and_limits(asked):
    way = text(np.column_stack([TIME, 0.4 * TIME, 0 * TIME]))
    more = ("--gravity-vector", "0,-9.81,0", "--payload", "5@0.1,0,0")
    assert "effort" in asked(way, *more).out
    (first, *_) = asked(way, *more, "-F", "json").json["result"]["violations"]
    assert (first["joint"], first["kind"], first["limit"]) == ("joint1", "effort", 80.0)
    more = (*more, "--effort-limits", "joint1=500,joint2=500")
    assert asked(way, *more, "-F", "json").json["result"]["violations"] == []
    assert "effort limit" not in asked(way, "--gravity-vector", "0,0,0").out


def test_the_threshold(asked):
    assert "never: smallest / largest is 0.001 or more" in asked(text(timed(30)), "--near", "0.001").out
    assert "between 0 and 1" in asked(text(timed()), "--near", "2", code=2).err


def test_a_real_arm_with_axes_and_a_length(asked):
    model = ks.load("example:ur5_robot")
    names = ",".join(model.robot.position_names)
    way = np.linspace(*ks.random_configurations(model, 5, 2), 40)
    for more in (("--axes", "x", "y", "rz", "--length", "none"), ("--reference", "local")):
        answer = asked(text(way, names), "-f", "tool0", *more, robot="example:ur5_robot")
        assert "agree" in answer.out
        assert max(map(len, answer.out.splitlines())) <= 80
    result = asked(text(way, names), "-f", "tool0", "--length", "0.4", "-F", "json", robot="example:ur5_robot").json
    assert result["result"]["characteristic_length"] == 0.4


def test_without_a_cross_check(asked):
    assert "not cross-checked" in asked(text(timed()), "--no-crosscheck").out


@pytest.mark.parametrize("suffix", [".svg", ".png"])
def test_a_picture(asked, tmp_path, suffix):
    picture = tmp_path / f"lines{suffix}"
    asked(text(timed()), "--plot", picture, "--deg")
    assert picture.stat().st_size > 5000
    assert "cannot draw" in asked(text(timed()), "--plot", tmp_path / "a.bmp", code=2).err


def test_the_result_goes_to_a_file_whole(asked, tmp_path):
    out = tmp_path / "rows.csv"
    answer = asked(text(timed()), "-F", "csv", "-o", out)
    assert answer.out == ""
    assert len(out.read_text().splitlines()) == 82
    again = tmp_path / "way.json"
    asked(text(timed()), "-F", "json", "-o", again)
    assert json.loads(again.read_text())["schema"] == "kinetostat/trajectory/1"


def test_the_ending_of_a_file_tells_what_goes_into_it(asked, tmp_path):
    rows, page = text(timed()), tmp_path / "page.txt"
    asked(rows, "-o", tmp_path / "rows.csv")
    assert (tmp_path / "rows.csv").read_text() == asked(rows, "-F", "csv").out
    asked(rows, "-o", page)
    assert page.read_text() == asked(rows).out


@pytest.mark.parametrize(
    ("name", "more", "remedy"),
    [
        ("x.json", (), "-F json"),
        ("x.npz", (), ".csv or .parquet"),
        ("x.npz", ("-F", "csv"), ".csv or .parquet"),
        ("x.parquet", ("-F", "csv"), "leave out -F csv"),
        ("x.csv", ("-F", "json"), "leave out -F json"),
        ("x.JSON", ("-F", "csv"), "-F json"),
    ],
)
def test_an_ending_that_contradicts_is_refused(asked, tmp_path, name, more, remedy):
    answer = asked(text(timed()), *more, "-o", tmp_path / name, code=2)
    assert remedy in answer.err
    assert len(answer.err.splitlines()) == 1
    assert not (tmp_path / name).exists()


def test_rows_go_to_parquet_and_are_read_back(asked, tmp_path):
    parquet_file = pytest.importorskip("pyarrow.parquet")
    rows = timed()
    rows[50:, 2] += 1.0
    lines = text(rows).splitlines()
    lines[7] = "x,1,2"
    out = tmp_path / "rows.parquet"
    answer = asked("\n".join(lines), *LOADED, "-o", out)
    found = parquet_file.read_table(out)
    expected = table(asked("\n".join(lines), *LOADED, "-F", "csv"))
    assert found.num_rows == len(expected) == 81
    columns = {name.partition(" [")[0]: name for name in expected[0]}
    assert found.column_names == list(columns)
    for name, header in columns.items():
        for mine, text_cell in zip(found[name].to_pylist(), (row[header] for row in expected), strict=True):
            if mine is None:
                assert text_cell == ""
            elif isinstance(mine, bool):
                assert text_cell == ("yes" if mine else "no")
            else:
                assert text_cell == mine if isinstance(mine, str) else float(text_cell) == mine
    assert found.schema.field("q.joint1").metadata == {b"unit": b"rad"}
    known = json.loads(found.schema.metadata[b"kinetostat"])
    assert known["schema"] == "kinetostat/trajectory.rows/1"
    assert known["asked"]["payload"]["mass"] == 5.0
    assert known["crosscheck"]["agree"] is True
    assert "81 rows" in answer.err
    again = asked(out.read_bytes(), *LOADED, "-F", "csv", name="again.parquet")
    assert [row["row"] for row in table(again) if row["reason"]] == ["7"]


def test_parquet_needs_pyarrow_before_anything_is_computed(asked, tmp_path, monkeypatch):
    monkeypatch.setattr("kinetostat.report.row_files.parquet.find_spec", lambda _: None)
    assert "kinetostat[parquet]" in asked(text(timed()), "-o", tmp_path / "x.parquet", code=2).err


# --- the reader, which `sweep --trajectory` uses too -----------------------------------------------------------------


def test_time_that_does_not_count_is_not_looked_at(tmp_path):
    path, model = tmp_path / "way.csv", ks.load(ROBOT)
    path.write_text("time,joint2\n5,0.1\nsoon,0.2\n1,0.3\n1,x\n")
    found = recording.read_recording(path, model, np.array([0.7, 9.0]), degrees=False, timed=False)
    np.testing.assert_array_equal(found.q, [[0.7, 0.1], [0.7, 0.2], [0.7, 0.3]])
    assert found.time is None
    assert found.names == ("joint2",)
    assert [str(one) for one in found.rows.bad] == ["row 4 (line 5): joint2: 'x' is not a number"]
