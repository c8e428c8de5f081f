"""`kinetostat trajectory`: files of every form, rows that cannot be used, tables, rows, JSON, pictures."""

import csv
import io
import json
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
    assert "33.33 %" in out  # of joint2's velocity limit
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
    ratio = np.array([float(row["inverse_condition_number"]) for row in found])
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


def test_one_sample(asked):
    out = asked(text(timed(1))).out
    assert "samples                 1" in out
    assert "0 m" in out


def test_degrees_are_shown(asked):
    out = asked(text(np.column_stack([TIME, np.degrees(Q)])), "--deg").out
    assert "joint2 = 0 deg" in out
    assert "40.11 deg/s" in out  # 0.7 rad/s
    assert "rad/s" not in out


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
    assert f"line 4: {BAD[row]}" in answer.err
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
    assert answer.err.count("line ") == 10
    assert "30 of 31 rows are left out" in answer.err


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "empty"),
        ("\n\n", "empty"),
        ("joint1,joint2\n", "no row can be used"),
        ("joint1\nx\ny\n", "no row can be used; line 2"),
        ("time\n1\n2\n", "no column names a joint"),
        ("joint1,jiont2\n1,2\n", "did you mean 'joint2'"),
        ("joint1,joint1\n1,2\n", "twice"),
        ("joint1 [grad],joint2\n1,2\n", "grad"),
        ("time [min],joint2\n1,2\n", "min"),
        (b"joint1\n\xff\xfe\n", "UTF-8"),
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
    assert "effort" not in asked(way, "--gravity-vector", "0,0,0").out.split("beyond limits")[1]


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
