"""Golden placements and Jacobians: written by the command line, compared with the robot of today."""

from __future__ import annotations

import json
import shlex

import pytest

import kinetostat as ks
from kinetostat_cli.main import run
from policy.policies import judged
from trees import load_text

LINES = 'kind = "golden"\nfile = "golden.json"'
ARM = ks.load("textbook:planar_3r").loaded.source.data.decode()

QUESTIONS = {
    "placement": ("fk", ""),
    "between two frames": ("fk", "--relative-to link1"),
    "Jacobian": ("jacobian", ""),
    "local": ("jacobian", "--reference local --point 0.1,0.2,0.3"),
    "world": ("jacobian", "--reference world"),
    "angular first, in other axes": ("jacobian", "--order angular-first --expressed-in link2 --relative-to link1"),
    "analytic": ("jacobian", "--rates zyx"),
}


def store(folder, question="placement"):
    command, options = QUESTIONS[question]
    line = f"{command} textbook:planar_3r -f tool -q 0.3,-0.7,1.1 -F json {options} -o"
    assert run([*shlex.split(line), str(folder / "golden.json")]) == 0


def arm(old="", new=""):
    assert old in ARM
    return load_text(ARM.replace(old, new) if old else ARM)


@pytest.mark.parametrize("question", QUESTIONS)
def test_the_same_robot_is_as_it_was(tmp_path, question):
    store(tmp_path, question)
    outcome = judged(tmp_path, arm(), LINES)
    assert outcome.met is True, outcome
    assert outcome.witness.items() <= {"joint1": 0.3, "joint2": -0.7, "joint3": 1.1}.items()


def moved(by):
    """Return the arm with its tool frame moved along x."""
    head, mark, rest = ARM.rpartition('<origin xyz="1 0 0"/>')
    assert mark
    return load_text(f'{head}<origin xyz="{1 + by} 0 0"/>{rest}')


def test_a_tool_frame_that_is_moved_by_two_millimetres(tmp_path):
    store(tmp_path)
    outcome = judged(tmp_path, moved(0.002), LINES)
    assert outcome.met is False
    assert outcome.found == "'tool' is 0.002 m and 0 rad off"
    assert outcome.wanted == "within 1e-09 m and rad"
    assert judged(tmp_path, moved(0.002), LINES + "\ntolerance = 0.0021").met is True
    assert judged(tmp_path, moved(0.002), LINES + "\ntolerance = 0.0019").met is False


@pytest.mark.parametrize("question", QUESTIONS)
def test_a_longer_link_is_noticed_and_the_command_that_is_told_renews_the_file(tmp_path, monkeypatch, question):
    store(tmp_path, question)
    before = json.loads((tmp_path / "golden.json").read_text())
    longer = load_text(ARM.replace('<origin xyz="1 0 0"/>', '<origin xyz="1.01 0 0"/>'))  # of joint3 and of the tool
    (tmp_path / "arm.urdf").write_bytes(longer.loaded.source.data)
    monkeypatch.chdir(tmp_path)
    longer = ks.load("arm.urdf")
    outcome = judged(tmp_path, longer, LINES)
    assert outcome.met is False
    assert "kinetostat" not in outcome.found
    command = outcome.remedy.split(" ", 1)
    assert command[0] == "kinetostat"
    assert run(shlex.split(command[1])) == 0
    assert judged(tmp_path, longer, LINES).met is True
    after = json.loads((tmp_path / "golden.json").read_text())
    assert after["configuration"] == before["configuration"]
    asked = set(after["result"]) - {"matrix", "position", "rates"}
    assert {key: after["result"][key] for key in asked} == {key: before["result"][key] for key in asked}


def test_a_column_more_is_a_difference(tmp_path):
    store(tmp_path, "Jacobian")
    text = ARM.replace('name="joint2" type="revolute"', 'name="joint2" type="fixed"')
    stored = json.loads((tmp_path / "golden.json").read_text())
    del stored["configuration"]["joint2"]
    (tmp_path / "golden.json").write_text(json.dumps(stored))
    outcome = judged(tmp_path, load_text(text), LINES)
    assert outcome.met is False
    assert "its columns are now joint1, joint3, in the file joint1, joint2, joint3" in outcome.found


def test_the_command_that_renews_can_be_pasted_where_the_gate_is_run(tmp_path, monkeypatch):
    store(tmp_path)
    (tmp_path / "my arm.urdf").write_text(ARM.replace('<origin xyz="1 0 0"/>', '<origin xyz="1.01 0 0"/>'))
    (tmp_path / "ci").mkdir()
    monkeypatch.chdir(tmp_path / "ci")
    outcome = judged(tmp_path, ks.load("../my arm.urdf"), LINES)
    assert shlex.split(outcome.remedy)[2] == "../my arm.urdf"
    assert run(shlex.split(outcome.remedy)[1:]) == 0
    again = judged(tmp_path, ks.load("../my arm.urdf"), LINES)
    assert (again.met, again.remedy) == (True, "")


def test_rounding_is_no_difference(tmp_path):
    store(tmp_path)
    stored = json.loads((tmp_path / "golden.json").read_text())
    stored["result"]["matrix"][0][3] += 1e-15
    (tmp_path / "golden.json").write_text(json.dumps(stored))
    outcome = judged(tmp_path, arm(), LINES + "\ntolerance = 0")
    assert (outcome.met, outcome.found) == (True, "'tool' is 0 m and 0 rad off")


BROKEN = {
    "no JSON": "{",
    "deep JSON": "[" * 100_000,
    "a list": "[1, 2]",
    "another command's": '{"schema": "kinetostat/info/1", "configuration": {}, "result": {}}',
    "no schema": '{"configuration": {}, "result": {}}',
    "no configuration": '{"schema": "kinetostat/fk/1", "result": {"frame": "tool", "relative_to": "base"}}',
    "no result": '{"schema": "kinetostat/fk/1", "configuration": {}}',
    "a joint that is gone": '{"schema": "kinetostat/fk/1", "configuration": {"elbow": 1}, "result": {}}',
    "a position that is a table": '{"schema": "kinetostat/fk/1", "configuration": {"joint1": {}}, "result": {}}',
    "a huge position": '{"schema": "kinetostat/fk/1", "configuration": {"joint1": 1e400}, "result": {}}',
    "a huge whole position": '{"schema": "kinetostat/fk/1", "configuration": {"joint1": 1%s}, "result": {}}'
    % ("0" * 400),
}


@pytest.mark.parametrize("case", BROKEN)
def test_what_is_no_golden_file_is_not_judged(tmp_path, case):
    (tmp_path / "golden.json").write_text(BROKEN[case])
    outcome = judged(tmp_path, arm(), LINES)
    assert outcome.met is None
    assert outcome.found.isprintable()


@pytest.mark.parametrize(
    ("question", "key", "value"),
    [
        ("placement", "matrix", [[1, 2], [3]]),
        ("placement", "matrix", [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]]),
        ("placement", "matrix", [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]),
        ("placement", "matrix", [[10**400] * 4] * 4),
        ("placement", "matrix", None),
        ("placement", "frame", "gone"),
        ("placement", "frame", 3),
        ("placement", "relative_to", None),
        ("Jacobian", "matrix", [[1]]),
        ("Jacobian", "reference", "sideways"),
        ("Jacobian", "point", {"x": 1}),
        ("Jacobian", "point", [1]),
        ("Jacobian", "rates", 3),
        ("Jacobian", "rates", {"sequence": "intrinsic xxx"}),
        ("Jacobian", "order", "any"),
        ("Jacobian", "order", [1]),
        ("Jacobian", "expressed_in", 3),
    ],
)
def test_a_result_that_is_tampered_with_is_not_judged(tmp_path, question, key, value):
    store(tmp_path, question)
    stored = json.loads((tmp_path / "golden.json").read_text())
    stored["result"][key] = value
    (tmp_path / "golden.json").write_text(json.dumps(stored))
    outcome = judged(tmp_path, arm(), LINES)
    assert outcome.met is None, outcome
    assert outcome.found


def test_a_file_that_is_not_there(tmp_path):
    outcome = judged(tmp_path, arm(), LINES)
    assert outcome.met is None
    assert "golden.json: there is no such file" in outcome.found


def test_terminal_escapes_of_a_golden_file_stay_inert(tmp_path):
    store(tmp_path)
    stored = json.loads((tmp_path / "golden.json").read_text())
    stored["result"]["frame"] = "\x1b[31mtool"
    (tmp_path / "golden.json").write_text(json.dumps(stored))
    assert judged(tmp_path, arm(), LINES).found.isprintable()
