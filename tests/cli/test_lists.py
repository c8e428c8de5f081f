"""`--qs`: lists of configurations of `torque` and `ik`: a row out for each row in, a reason where there is none."""

import csv
import io
import json
import os
import subprocess
import sys

import numpy as np
import pytest

import kinetostat as ks
from kinetostat_cli import reading

TORQUE = ("torque", "textbook:planar_2r", "--wrench", "tool:1,2,0,0,0,3")
IK = ("ik", "textbook:planar_2r", "--axes", "x", "y", "--pose", "1,0.5,0")
ROWS = [[0.1, 0.2], [-0.3, 0.4], [0.0, 0.0], [2.5, -1.25]]


@pytest.fixture
def listed(cli, tmp_path):
    """Write a list, ask, and return the rows of the CSV as dictionaries, and the outcome."""

    def call(content, *more, name="list.csv", command=TORQUE, stdin=None, code=0):
        path = tmp_path / name
        if stdin is None:
            path.write_bytes(content if isinstance(content, bytes) else content.encode())
        answer = cli(*command, "--qs", "-" if stdin is not None else path, *more, stdin=stdin or b"")
        assert answer.code == code, answer.err
        assert "Traceback" not in answer.err
        assert "bug in kinetostat" not in answer.err
        return list(csv.DictReader(io.StringIO(answer.out))), answer

    return call


def text(rows, header=None, end="\n"):
    lines = [",".join(map(repr, row)) for row in rows]
    return end.join([*([",".join(header)] if header else []), *lines]) + end


def torques(rows):
    """Return the torques (m, 2) one by one, from the library."""
    model = ks.load("textbook:planar_2r")
    wrench = [ks.load_at(model, "tool", [1, 2, 0, 0, 0, 3])]
    return [ks.torque(model, np.array(q, dtype=float), wrench).total for q in rows]


def numbers(rows):
    return [[float(row["joint1 [Nm]"]), float(row["joint2 [Nm]"])] for row in rows]


def same(rows, expected):
    np.testing.assert_allclose(numbers(rows), expected, rtol=0, atol=1e-12)
    assert all(row["reason"] == "" for row in rows)


# --- forms -----------------------------------------------------------------------------------------------------------

FORMS = {
    "csv": ("list.csv", text(ROWS)),
    "csv with a header": ("list.csv", text(ROWS, ("joint1", "joint2"))),
    "csv with the header the other way round": (
        "list.csv",
        text([row[::-1] for row in ROWS], ("joint2", "joint1")),
    ),
    "crlf": ("list.csv", text(ROWS, ("joint1", "joint2"), end="\r\n")),
    "bom": ("list.csv", "\ufeff" + text(ROWS, ("joint1", "joint2"))),
    "bom without a header": ("list.csv", "\ufeff" + text(ROWS)),
    "blank lines": ("list.csv", "\n\n" + text(ROWS, ("joint1", "joint2"), end="\n\n\n") + "\n"),
    "blanks around": ("list.csv", text(ROWS, (" joint1", "joint2 ")).replace(",", " , ")),
    "quoted": ("list.csv", text(ROWS, ('"joint1"', '"joint2"'))),
    "no end of line": ("list.csv", text(ROWS).rstrip()),
    "any suffix": ("list.txt", text(ROWS)),
    "json lists": ("list.json", json.dumps(ROWS)),
    "json by name": ("list.json", json.dumps([{"joint2": b, "joint1": a} for a, b in ROWS])),
    "json of both": ("list.json", json.dumps([ROWS[0], {"joint1": -0.3, "joint2": 0.4}, {}, ROWS[3]])),
    "json with a bom": ("list.json", "\ufeff" + json.dumps(ROWS)),
    "jsonl": ("list.jsonl", "\n".join(map(json.dumps, ROWS))),
    "jsonl with blank lines": ("list.jsonl", "\n" + "\n\n".join(map(json.dumps, ROWS)) + "\r\n\n"),
    "upper case": ("LIST.JSONL", "\n".join(json.dumps({"joint1": a, "joint2": b}) for a, b in ROWS)),
}


@pytest.mark.parametrize("form", FORMS)
def test_forms_of_a_list(listed, form):
    name, content = FORMS[form]
    rows, answer = listed(content, name=name)
    same(rows, torques(ROWS))
    assert [row["row"] for row in rows] == ["1", "2", "3", "4"]
    assert "4 rows" in answer.err
    assert "agree" in answer.err


def test_names_that_are_left_out_are_zero(listed):
    same(listed("joint2\n0.5\n-1\n")[0], torques([[0, 0.5], [0, -1]]))


def test_standard_input(listed):
    rows, _ = listed("", stdin=text(ROWS, ("joint1", "joint2")).encode())
    same(rows, torques(ROWS))
    assert listed("", stdin=b"\n")[0] == []


def test_standard_input_with_a_byte_order_mark(listed):
    same(listed("", stdin=b"\xef\xbb\xbf" + text(ROWS).encode())[0], torques(ROWS))


def test_degrees(listed):
    rows = [list(np.degrees(row)) for row in ROWS]
    same(listed(text([[float(x) for x in row] for row in rows]), "--deg")[0], torques(ROWS))
    by_name = [{"joint1": float(a), "joint2": float(b)} for a, b in rows]
    same(listed(json.dumps(by_name), "--deg", name="a.json")[0], torques(ROWS))


@pytest.mark.parametrize("quat", ["xyzw", "wxyz"])
def test_quaternions_of_a_floating_base(listed, quat):
    quaternion = np.array([0.1, -0.4, 0.2, 0.7])
    quaternion /= np.linalg.norm(quaternion)
    written = quaternion if quat == "xyzw" else np.roll(quaternion, 1)
    row = [0.1, 0.2, 0.3, *map(float, written), 0.5, -0.6]
    rows, _ = listed(text([row, row]), "--base", "floating", "--quat", quat)
    model = ks.load("textbook:planar_2r", floating_base=True)
    q = np.array([0.1, 0.2, 0.3, *quaternion, 0.5, -0.6])
    expected = ks.torque(model, q, [ks.load_at(model, "tool", [1, 2, 0, 0, 0, 3])]).total
    for found in rows:
        values = [float(x) for name, x in found.items() if "[" in name]
        np.testing.assert_allclose(values, expected, rtol=0, atol=1e-12)
    # Coordinates with names of their own say themselves which is which.
    named = ["root_joint." + c for c in ("x", "y", "z", "qx", "qy", "qz", "qw")]
    again, _ = listed(text([[*map(float, q)]], (*named, "joint1", "joint2")), "--base", "floating", "--quat", quat)
    assert [float(x) for name, x in again[0].items() if "[" in name] == pytest.approx(list(expected), abs=1e-12)


# --- rows without an answer ------------------------------------------------------------------------------------------

BAD = {
    "x,0.3": "'x' is not a number",
    "0.4": "1 numbers are given, 2 are needed",
    "0.5,0.6,0.7": "3 numbers are given, 2 are needed",
    "0.5,": "'' is not a number",
    "nan,1": "not a finite number",
    "inf,1": "not a finite number",
    "1e300,0": "beyond 1e+06 rad",
    "1e400,0": "not a finite number",
    ",": "an empty row",
    "\x1b[31m,0": r"'\x1b[31m' is not a number",
    "=1+1,0": "'=1+1' is not a number",
}


@pytest.mark.parametrize("header", ["", "joint1,joint2\n"])
def test_bad_rows_get_a_reason_and_the_others_an_answer(listed, header):
    content = header + "0.1,0.2\n" + "\n".join(f"{bad}\n-0.3,0.4" for bad in BAD)
    rows, answer = listed(content)
    assert len(rows) == 1 + 2 * len(BAD)
    for row, reason in zip(rows[1::2], BAD.values(), strict=True):
        assert reason in row["reason"]
        assert {x for name, x in row.items() if name not in ("row", "reason")} == {""}
    same(rows[::2], [*torques(ROWS[:1]), *(torques(ROWS[1:2]) * len(BAD))])
    assert [row["row"] for row in rows] == [str(i + 1) for i in range(len(rows))]
    assert f"{len(rows)} rows, {len(BAD)} of them without an answer" in answer.err
    assert "\x1b" not in answer.out + answer.err


BAD_JSON = (
    '{"joint9": 1}',
    "5",
    '"x"',
    "null",
    "[1]",
    "{bad",
    "[[1], [2]]",
    "[NaN, 1]",
    "[1, null]",
    '{"joint1": null}',
)


def test_bad_lines_of_json_get_a_reason(listed):
    lines = [json.dumps(ROWS[0]), *(line for bad in BAD_JSON for line in (bad, json.dumps(ROWS[1])))]
    rows, _ = listed("\n".join(lines), name="list.jsonl")
    same(rows[::2], [*torques(ROWS[:1]), *(torques(ROWS[1:2]) * len(BAD_JSON))])
    assert all(row["reason"] for row in rows[1::2])
    assert "there is no joint 'joint9'" in rows[1]["reason"]


def test_a_word_for_a_number_gets_a_reason(listed):
    rows, _ = listed('[0.1, 0.2]\n{"joint1": "a"}\n', name="list.jsonl")
    assert [bool(row["reason"]) for row in rows] == [False, True]


def test_a_bad_quaternion_is_one_rows_fault(listed):
    good = "0,0,0,0,0,0,1,0.1,0.2"
    rows, _ = listed(f"{good}\n0,0,0,0,0,0,2,0,0\n0,0,0,0,0,0,0,0,0\n{good}\n", "--base", "floating")
    assert [bool(row["reason"]) for row in rows] == [False, True, True, False]
    assert "length 1" in rows[1]["reason"]


# --- lists that are none ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "content", "part"),
    [
        ("a.csv", "joint1,jnt2\n0.1,0.2\n0.1,0.2\n", "there is no joint 'jnt2'"),
        ("a.csv", "joint1,\x1b[31m\n0.1,0.2\n", r"\x1b[31m"),
        ("a.csv", "joint1,joint1\n0.1,0.2\n", ""),
        ("a.csv", b"\xff\xfe\x00", "UTF-8"),
        ("a.json", "{}", "no list in it"),
        ("a.json", "5", "no list in it"),
        ("a.json", "[1,", "not JSON"),
        ("a.json", "", "not JSON"),
        ("a.json", "[" * 99999, "not JSON"),
        ("a.json", b"\xff\xfe", "UTF-8"),
        ("a.jsonl", b"[0.1,0.2]\n\xff\n", "UTF-8"),
    ],
)
def test_what_is_no_list_is_refused_once(listed, name, content, part):
    _, answer = listed(content, name=name, code=2)
    (line,) = answer.err.splitlines()
    assert line.startswith("kinetostat: error: ")
    assert part in line
    assert "\x1b" not in answer.err


def test_a_header_that_names_a_follower_or_a_fixed_joint_is_refused(cli, arm, tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("shoulder,elbow\n0.1,0.2\n")
    answer = cli("torque", arm, "--wrench", "tip:1,0,0,0,0,0", "--qs", path)
    assert answer.code == 2
    assert "shoulder" in answer.err
    assert len(answer.err.splitlines()) == 1


def test_files_that_are_none_are_refused(cli, tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    os.mkfifo(tmp_path / "pipe.json")
    (tmp_path / "folder.csv").mkdir()
    for name in ("none.csv", "none.json", "pipe.csv", "pipe.json", "folder.csv"):
        answer = cli(*TORQUE, "--qs", tmp_path / name)  # a pipe that nobody writes does not hang it
        assert answer.code == 2, name
        assert len(answer.err.splitlines()) == 1
        assert name in answer.err


@pytest.mark.parametrize("name", ["empty.csv", "header.csv", "empty.jsonl", "empty.json"])
def test_an_empty_list_has_no_rows(listed, name):
    content = {"header.csv": "joint1,joint2\n", "empty.json": "[]"}.get(name, "")
    rows, answer = listed(content, name=name)
    assert rows == []
    assert answer.out.startswith("row,joint1 [Nm],joint2 [Nm]")
    assert json.loads(listed(content, "-F", "json", name=name)[1].out)["result"]["rows"] == []


def test_options_that_do_not_go_with_a_list_are_refused(listed):
    for more in (("-q", "1,2"), ("--reactions",)):
        assert "--qs" in listed(text(ROWS), *more, code=2)[1].err
    for more in (("--all",), ("-q", "1,2")):
        assert "--qs" in listed(text(ROWS), *more, command=IK, code=2)[1].err


def test_what_is_refused_writes_nothing_to_standard_output(listed):
    for name, content in (("a.csv", "joint1,jnt2\n0.1,0.2\n"), ("a.json", "{}")):
        assert listed(content, name=name, code=2)[1].out == ""


# --- JSON out --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", [TORQUE, IK], ids=["torque", "ik"])
@pytest.mark.parametrize("content", ["", "0.1,0.2\n", "0.1,0.2\nx,1\n", "x,1\n0.1,0.2\n0.3,0.4\n", "nan,0\nnan,0\n"])
def test_json_is_valid_and_says_the_same(listed, command, content):
    if content.startswith("x"):
        content = "joint1,joint2\n" + content
    rows, _ = listed(content, command=command)
    answer = json.loads(listed(content, "-F", "json", command=command)[1].out, parse_constant=pytest.fail)
    assert answer["schema"] == f"kinetostat/{command[0]}.rows/1"
    assert set(answer) >= {"schema", "robot", "result", "crosscheck", "warnings"}
    assert answer["crosscheck"]["agree"] is True
    result = answer["result"]
    titles = [f"{n} [{u}]" if u else n for n, u in zip(result["columns"], result["units"], strict=True)]
    assert [row["row"] for row in result["rows"]] == [int(row["row"]) for row in rows]
    for one, other in zip(result["rows"], rows, strict=True):
        assert one.get("reason", "") == other["reason"]
        written = ["" if value is None else str(value) for value in one["values"]]
        assert written == [other[title] for title in titles]


def test_hostile_names_reach_neither_terminal_nor_spreadsheet(cli, arm, tmp_path):
    arm.write_text(arm.read_text().replace('"slide"', '"=1+1&#10;\u202e"'))
    path = tmp_path / "a.csv"
    path.write_text("0.1,0.2\nx,1\n")
    command = ("torque", arm, "--wrench", "tip:1,0,0,0,0,0", "--qs", path)
    answer = cli(*command)
    assert answer.code == 0, answer.err
    assert "\u202e" not in answer.err
    header = next(csv.reader(io.StringIO(answer.out)))
    assert any(name.startswith("'=1+1") for name in header)
    assert json.loads(cli(*command, "-F", "json").out)["result"]["columns"][1].startswith("=1+1")


# --- files out, streams ----------------------------------------------------------------------------------------------


def test_a_file_is_there_whole_or_not_at_all(cli, tmp_path, listed):
    out = tmp_path / "out.csv"
    _, answer = listed(text(ROWS), "-o", out)
    assert answer.out == ""
    same(list(csv.DictReader(io.StringIO(out.read_text()))), torques(ROWS))
    kept = out.read_bytes()
    # Half way through the list is found to be none: what was there stays there, and nothing beside it.
    broken = "\n".join(json.dumps(row) for row in ROWS).encode() + b"\n\xff\n"
    listed(broken, "-o", out, name="broken.jsonl", code=2)
    assert out.read_bytes() == kept
    assert sorted(path.name for path in tmp_path.iterdir()) == ["broken.jsonl", "list.csv", "out.csv"]
    listed("joint1,jnt2\n0,0\n", "-o", tmp_path / "none.csv", code=2)
    assert not (tmp_path / "none.csv").exists()


def test_many_rows_come_in_batches_and_are_what_they_are_one_by_one(listed, monkeypatch):
    q = np.random.default_rng(1).uniform(-3, 3, (5000, 2))
    lines = [text([row]).strip() for row in q.tolist()]
    lines[2500] = "x,0"
    rows, answer = listed("\n".join(lines))
    assert len(rows) == 5000
    assert "5000 rows, 1 of them" in answer.err
    assert rows[2500]["reason"] == "'x' is not a number"
    some = [0, 1, 1999, 2000, 2001, 2499, 2501, 3999, 4000, 4999]
    same([rows[i] for i in some], torques(q[some]))
    monkeypatch.setattr(reading, "BATCH", 7)
    assert listed("\n".join(lines[:50]))[0] == rows[:50]
    whole = json.loads(listed("\n".join(lines[:50]), "-F", "json")[1].out)
    assert [row["row"] for row in whole["result"]["rows"]] == list(range(1, 51))


def test_rows_come_before_the_list_has_ended():
    """A stream: what has been read in full batches is answered while its writer still thinks."""
    command = [sys.executable, "-m", "kinetostat_cli", *TORQUE, "--qs", "-"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdin.write(b"0.1,0.2\n" * (reading.BATCH + 5000))
        process.stdin.flush()
        first = [process.stdout.readline() for _ in range(reading.BATCH + 1)]
        assert first[-1].startswith(f"{reading.BATCH},".encode())
        process.stdin.close()
        rest = process.stdout.read()
        process.stderr.read()
    assert process.returncode == 0
    assert len(rest.splitlines()) == 5000


def test_a_reader_that_leaves_is_no_error():
    command = [sys.executable, "-m", "kinetostat_cli", *TORQUE, "--qs", "-"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.close()
        process.stdin.write(b"0.1,0.2\n" * 5000)
        process.stdin.close()
        said = process.stderr.read().decode()
    assert "Traceback" not in said
    assert "bug" not in said


# --- ik --------------------------------------------------------------------------------------------------------------


def test_ik_starts_from_each_row(listed):
    rows, _ = listed("0.1,1\n0.1,-1\n", command=IK)
    elbows = [float(row["joint2 [rad]"]) for row in rows]
    assert elbows[0] > 0 > elbows[1]
    model = ks.load("textbook:planar_2r")
    for row in rows:
        q = np.array([float(row["joint1 [rad]"]), float(row["joint2 [rad]"])])
        np.testing.assert_allclose(ks.fk(model, "tool", q).position[:2], [1, 0.5], rtol=0, atol=1e-8)
        assert float(row["position_residual [m]"]) < 1e-8
        assert int(row["iterations"]) > 0
        assert row["reason"] == ""


def test_ik_that_is_not_reached_says_by_how_much(listed):
    rows, answer = listed("0.1,1\n0.1,-1\n", command=(*IK[:-1], "0,5,0"))
    assert [row["reason"] for row in rows] == ["not reached: misses by 3.2 m"] * 2
    assert "2 rows, 2 of them without an answer" in answer.err


def test_ik_of_bad_rows(listed):
    rows, _ = listed("0.1,1\nx,1\n0.1,-1\n", command=IK)
    assert [bool(row["reason"]) for row in rows] == [False, True, False]


def test_counts_are_numbers_in_json(listed):
    result = json.loads(listed("0.1,1\n", "-F", "json", command=IK)[1].out)["result"]
    (row,) = result["rows"]
    assert isinstance(row["values"][result["columns"].index("iterations")], int)


# --- what a hostile or careless file does not do -----------------------------------------------------------------


def test_a_field_beyond_what_csv_holds_is_one_line(cli, tmp_path):
    (tmp_path / "long.csv").write_text("x" * 200_000 + "\n1\n")
    answer = cli("torque", "textbook:planar_1r", "--gravity", "--qs", str(tmp_path / "long.csv"))
    assert answer.code == 2
    assert "not CSV" in answer.err


def test_an_open_quotation_mark_does_not_swallow_rows(cli, tmp_path):
    (tmp_path / "open.csv").write_text('0.1\n"0.2\n0.3\n')
    answer = cli("torque", "textbook:planar_1r", "--gravity", "--qs", str(tmp_path / "open.csv"))
    assert answer.code == 2
    assert "quotation mark" in answer.err


def test_a_path_that_is_too_long_is_one_line(cli):
    for words in (("--qs", "x" * 5000), ("--package-dir", "x" * 5000)):
        answer = cli("torque", "textbook:planar_1r", "--gravity", *words)
        assert answer.code == 2
        assert answer.err.startswith("kinetostat: error: ")


def test_a_faulty_first_row_is_a_row_and_no_header(cli, tmp_path):
    for name, text in (("a.csv", ",0\n0.1,0.2\n"), ("b.json", "[[0.1, null], [0.1, 0.2]]")):
        (tmp_path / name).write_text(text)
        answer = cli("torque", "textbook:planar_2r", "--gravity", "--qs", str(tmp_path / name))
        assert answer.code == 0, answer.err
        first, second = answer.out.splitlines()[1:]
        assert first.endswith("is not a number")
        assert second.startswith("2,")


def test_own_answers_are_read_again(cli, tmp_path):
    (tmp_path / "poses.csv").write_text("1.2,0.6,0\n9,9,0\n")
    solved = str(tmp_path / "solved.csv")
    question = ("textbook:planar_2r", "--axes", "xyz", "--poses", str(tmp_path / "poses.csv"), "-o", solved)
    assert cli("ik", *question).code == 0
    answer = cli("torque", "textbook:planar_2r", "--gravity", "--qs", solved)
    assert answer.code == 0, answer.err
    first, second = answer.out.splitlines()[1:]
    assert first.startswith("1,")
    assert "an empty row" in second


def test_a_link_that_is_written_to_stays_one(cli, tmp_path):
    real, link = tmp_path / "real.txt", tmp_path / "link.txt"
    real.write_text("old")
    real.chmod(0o600)
    link.symlink_to(real)
    assert cli("fk", "textbook:planar_1r", "-o", str(link)).code == 0
    assert link.is_symlink()
    assert "tool" in real.read_text()
    assert real.stat().st_mode & 0o777 == 0o600


def test_a_robot_without_joints_has_no_largest_force(cli):
    answer = cli("torque", "textbook:rigid_body", "-f", "b", "--max", "z")
    assert answer.code == 0, answer.err
    assert "needs no torque of any joint" in " ".join(answer.out.split())
