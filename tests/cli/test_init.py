"""`kinetostat init`."""

import tomllib

import pytest

from kinetostat.policy import schema
from kinetostat.policy.settings import read_settings

ARM = "textbook:planar_2r"


def test_it_is_written_to_standard_output(cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    answer = cli("init", ARM)
    assert answer.code == 0
    assert tomllib.loads(answer.out)["robots"][0]["path"] == ARM
    assert list(tmp_path.iterdir()) == []


def test_it_is_written_to_a_file_once(cli, tmp_path):
    path = tmp_path / "kinetostat.toml"
    answer = cli("init", ARM, "-o", path)
    assert (answer.code, answer.out) == (0, "")
    assert "kinetostat check" in answer.err
    assert read_settings(path).robots[0].expect
    path.write_text("# mine\n")
    answer = cli("init", ARM, "-o", path)
    assert answer.code == 2
    assert "is there already" in answer.err
    assert "--force" in answer.err
    assert "copy the lines from [[robots]] on" in " ".join(answer.err.split())
    assert path.read_text() == "# mine\n"
    assert cli("init", ARM, "-o", path, "--force").code == 0
    assert read_settings(path).robots[0].expect


def test_several_robots_have_a_table_each_in_one_file(cli, tmp_path):
    path = tmp_path / "kinetostat.toml"
    assert cli("init", ARM, "textbook:scara", ARM, "-o", path).code == 0
    robots = read_settings(path).robots
    assert [robot.path for robot in robots] == [ARM, "textbook:scara"]
    alone = cli("init", "textbook:scara", "-o", tmp_path / "one.toml")
    assert alone.code == 0
    (scara,) = read_settings(tmp_path / "one.toml").robots
    assert [(e.kind, e.title, e.wanted) for e in scara.expect] == [
        (e.kind, e.title, e.wanted) for e in robots[1].expect
    ]


def test_what_is_written_is_what_check_reads_and_passes(cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli("init", ARM, "textbook:scara", "-o", "kinetostat.toml").code == 0
    answer = cli("check", "--samples", "0", "--select", "X1")
    assert answer.code == 0, answer.out
    assert "2 passed" in answer.out


def test_what_follows_the_error_adds_a_robot(cli, tmp_path):
    path = tmp_path / "kinetostat.toml"
    assert cli("init", ARM, "-o", path).code == 0
    more = cli("init", "textbook:scara").out
    path.write_text(path.read_text() + more[more.index("[[robots]]") :])
    assert [robot.path for robot in read_settings(path).robots] == [ARM, "textbook:scara"]


def test_the_schema_is_written_for_editors(cli, tmp_path):
    path = tmp_path / "kinetostat.schema.json"
    answer = cli("init", "--schema", "-o", path)
    assert answer.code == 0
    assert "#:schema ./kinetostat.schema.json" in answer.err
    assert path.read_text() == schema.text()


def test_a_link_that_leads_nowhere_is_there_already(cli, tmp_path):
    path = tmp_path / "kinetostat.toml"
    path.symlink_to(tmp_path / "elsewhere")
    assert cli("init", ARM, "-o", path).code == 2


def test_paths_are_relative_to_the_file(cli, arm, tmp_path, monkeypatch):
    (tmp_path / "policies").mkdir()
    (tmp_path / "my arm.srdf").write_text('<robot name="arm"><group name="all"><joint name="slide"/></group></robot>')
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "policies" / "kinetostat.toml"
    line = ["init", arm.name, "-o", "policies/kinetostat.toml", "--srdf", "my arm.srdf", "--package-dir", "."]
    assert cli(*line).code == 0
    (robot,) = read_settings(path).robots
    assert (robot.path, robot.srdf, robot.package_dirs) == ("../my arm.urdf", "../my arm.srdf", ("..",))


def test_arguments_of_xacro_are_kept(cli, tmp_path):
    pytest.importorskip("xacro")
    text = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="side" default="a"/>'
    (tmp_path / "r.urdf.xacro").write_text(text + '<link name="$(arg side)"/></robot>')
    answer = cli("init", tmp_path / "r.urdf.xacro", "--xacro-arg", "side:=left")
    assert answer.code == 0, answer.err
    assert tomllib.loads(answer.out)["robots"][0]["xacro-args"] == {"side": "left"}


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["-"], 2, "standard input has no name"),
        ([ARM, "-"], 2, "standard input has no name"),
        ([ARM, "textbook:scara", "--srdf", "x.srdf"], 2, "--srdf is for one robot"),
        ([ARM, "nowhere.urdf"], 3, "no such file"),
        ([ARM, "--schema"], 2, "--schema is of no robot"),
        (["nowhere.urdf"], 3, "no such file"),
        ([ARM, "-o", "/nowhere/kinetostat.toml"], 2, "cannot write"),
        ([], 2, "Missing argument"),
    ],
)
def test_what_cannot_be(cli, arguments, code, message):
    answer = cli("init", *arguments)
    assert answer.code == code
    assert message in answer.err
    assert answer.out == ""
