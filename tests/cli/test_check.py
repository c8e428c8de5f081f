"""`kinetostat check`: verdicts, exit codes, choices, baselines, settings."""

import json
import subprocess

import pytest

GOOD = """<robot name="good">
  <link name="base"/>
  <link name="arm">
    <inertial>
      <origin xyz="0 0 0.1"/><mass value="1"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.002"/>
    </inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="10" velocity="1"/>
  </joint>
</robot>
"""
SWAPPED = GOOD.replace('lower="-1.5" upper="1.5"', 'lower="1.5" upper="-1.5"')
LINE = 11


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "good.urdf").write_text(GOOD)
    (tmp_path / "bad.urdf").write_text(SWAPPED)
    (tmp_path / "text.urdf").write_text("no XML")
    return tmp_path


def codes(outcome, file=0):
    return [finding["code"] for finding in json.loads(outcome.out)["result"]["files"][file]["findings"]]


def test_a_good_robot_passes(cli, here):
    found = cli("check", "good.urdf")
    assert found.code == 0, found.out
    assert "good.urdf" in found.out
    assert "pinocchio" in found.out


def test_a_bad_robot_fails_with_its_line(cli, here):
    found = cli("check", "bad.urdf")
    assert found.code == 1
    assert "J103" in found.out
    assert "lower 1.5 is above upper -1.5" in found.out
    assert str(LINE) in found.out


def test_json_says_it_all(cli, here):
    found = cli("check", "good.urdf", "bad.urdf", "text.urdf", "-F", "json")
    assert found.code == 1
    report = json.loads(found.out)
    assert report["schema"] == "kinetostat/check/1"
    good, bad, text = report["result"]["files"]
    assert [file["verdict"] for file in (good, bad, text)] == ["pass", "fail", "fail"]
    assert [file["path"] for file in (good, bad, text)] == ["good.urdf", "bad.urdf", "text.urdf"]
    swapped = next(finding for finding in bad["findings"] if finding["code"] == "J103")
    assert swapped["severity"] == "error"
    assert swapped["line"] == LINE
    assert set(swapped) >= {"code", "severity", "message", "line", "element", "hint"}
    assert good["crosscheck"]["agree"] is True
    assert text["crosscheck"] is None
    assert text["skipped"]


def test_select_and_ignore(cli, here):
    assert codes(cli("check", "bad.urdf", "-F", "json", "--select", "J103")) == ["J103"]
    assert codes(cli("check", "bad.urdf", "-F", "json", "--select", "J1,X", "--ignore", "J103")) == []
    assert cli("check", "bad.urdf", "--ignore", "J103").code == 0


def test_a_file_that_cannot_be_read_fails_whatever_is_ignored(cli, here):
    assert cli("check", "text.urdf", "--ignore", "X").code == 1


def test_a_rule_that_does_not_exist(cli, here):
    found = cli("check", "bad.urdf", "--select", "J1O3")
    assert found.code == 2
    assert "did you mean" in found.err


def test_fail_on_warning(cli, here):
    (here / "odd.urdf").write_text(GOOD.replace('xyz="0 1 0"', 'xyz="0 2 0"'))
    assert cli("check", "odd.urdf").code == 0
    assert cli("check", "odd.urdf", "--fail-on", "warning").code == 1


def test_a_baseline_knows_what_there_was(cli, here):
    assert cli("check", "bad.urdf", "good.urdf", "--write-baseline", "known.json").code == 0
    assert cli("check", "bad.urdf", "--baseline", "known.json").code == 0
    (here / "bad.urdf").write_text("\n\n" + SWAPPED)
    assert cli("check", "bad.urdf", "--baseline", "known.json").code == 0
    (here / "bad.urdf").write_text(SWAPPED.replace('velocity="1"', 'velocity="-1"'))
    assert cli("check", "bad.urdf", "--baseline", "known.json").code == 1


def test_settings_beside_it(cli, here):
    (here / "kinetostat.toml").write_text('[check]\nignore = ["J103"]\n')
    assert cli("check", "bad.urdf").code == 0
    assert cli("check", "bad.urdf", "--no-settings").code == 1
    (here / "kinetostat.toml").write_text('[check.per-path-ignores]\n"b*.urdf" = ["J103"]\n')
    assert cli("check", "bad.urdf").code == 0


def test_a_robot_that_settings_name_and_that_is_not_there(cli, here):
    (here / "kinetostat.toml").write_text('[[robots]]\npath = "gone.urdf"\n')
    found = cli("check", "good.urdf")
    assert found.code == 3
    assert "gone.urdf: there is no such file or folder, though the settings name it" in found.err


def test_without_a_path_everything_below_is_checked(cli, here):
    found = cli("check", "-F", "json", "--no-settings")
    assert [file["path"] for file in json.loads(found.out)["result"]["files"]] == ["bad.urdf", "good.urdf", "text.urdf"]
    (here / "sub").mkdir()
    (here / "sub" / "new.urdf").write_text(GOOD)
    (here / "kinetostat.toml").write_text('[[robots]]\npath = "good.urdf"\n[[robots]]\npath = "textbook:planar_2r"\n')
    found = cli("check", "-F", "json")
    paths = [file["path"] for file in json.loads(found.out)["result"]["files"]]
    assert paths == ["bad.urdf", "good.urdf", "text.urdf", "sub/new.urdf", "textbook:planar_2r"]


def test_settings_are_found_from_the_path_that_is_checked(cli, here, monkeypatch, tmp_path_factory):
    (here / "kinetostat.toml").write_text('[check]\nignore = ["J103"]\n')
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    assert cli("check", here / "bad.urdf").code == 0
    assert cli("check", here / "bad.urdf", "--no-settings").code == 1


def test_a_baseline_is_renewed_and_keeps_what_was_not_checked(cli, here):
    (here / "kinetostat.toml").write_text('[check]\nbaseline = "known.json"\n')
    (here / "worse.urdf").write_text(SWAPPED)
    assert cli("check", "bad.urdf", "worse.urdf", "--write-baseline", "known.json").code == 0
    for _ in range(2):
        assert cli("check", "bad.urdf", "--write-baseline", "known.json").code == 0
        assert cli("check", "bad.urdf", "worse.urdf").code == 0
    (here / "other.txt").write_text("not ours")
    assert cli("check", "bad.urdf", "--write-baseline", "other.txt").code == 2
    assert (here / "other.txt").read_text() == "not ours"


def test_an_srdf_is_no_robot(cli, here):
    (here / "good.srdf").write_text('<robot name="good"/>')
    found = cli("check", "good.srdf")
    assert found.code == 3
    assert "SRDF" in found.err


def test_nothing_to_check_is_no_pass(cli, here, monkeypatch, tmp_path_factory):
    monkeypatch.chdir(tmp_path_factory.mktemp("empty"))
    assert cli("check", "--no-settings").code == 3
    monkeypatch.chdir(here)
    assert cli("check", "nothing.urdf").code == 3


def test_only_what_has_changed(cli, here):
    for command in (["init", "-q"], ["add", "-A"], ["-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qm", "a"]):
        subprocess.run(["git", *command], check=True, cwd=here)
    assert cli("check", ".", "--changed-since", "HEAD").code == 0
    (here / "bad.urdf").write_text(SWAPPED + "\n")
    found = cli("check", ".", "--changed-since", "HEAD", "-F", "json")
    assert [file["path"] for file in json.loads(found.out)["result"]["files"]] == ["bad.urdf"]
    assert found.code == 1


def test_an_expectation_that_is_not_met_fails_with_its_witness(cli, here):
    (here / "kinetostat.toml").write_text(
        '[[robots]]\npath = "good.urdf"\n[[robots.expect]]\nkind = "mass"\nat-most = 0.5\n'
    )
    found = cli("check", "good.urdf", "-F", "json")
    assert found.code == 1
    (outcome,) = json.loads(found.out)["result"]["files"][0]["policy"]
    assert outcome["met"] is False
    assert "0.5" in outcome["wanted"]
    assert "1" in outcome["found"]


@pytest.mark.parametrize("form", ["text", "json", "sarif", "junit", "github", "markdown"])
def test_every_format_says_that_it_failed(cli, here, form):
    found = cli("check", "bad.urdf", "good.urdf", "-F", form)
    assert found.code == 1
    assert "J103" in found.out
    (here / "report").unlink(missing_ok=True)
    assert cli("check", "bad.urdf", "-F", form, "-o", "report").code == 1
    assert "J103" in (here / "report").read_text()


def test_several_reports_of_one_run(cli, here):
    found = cli("check", "bad.urdf", "--also", "sarif=a.sarif", "--also", "junit=b.xml", "-F", "github")
    assert found.code == 1
    assert "::error file=bad.urdf,line=11" in found.out
    assert json.loads((here / "a.sarif").read_text())["version"] == "2.1.0"
    assert "<testsuite" in (here / "b.xml").read_text()
    assert cli("check", "bad.urdf", "--also", "pdf=a.pdf").code == 2


def test_a_hanging_robot_is_a_crash(cli, here):
    found = cli("check", "good.urdf", "--timeout", "0.1", "--samples", "10000")
    assert found.code in (0, 1)  # a fast machine may be done
    if found.code:
        assert "no answer within 0.1 s" in found.out


def test_rules_and_explain(cli):
    listed = cli("rules")
    assert listed.code == 0
    assert "J103" in listed.out
    assert cli("rules", "--select", "T").out.count("J1") == 0
    explained = cli("explain", "J103")
    assert "lower" in explained.out
    assert "<limit" in explained.out
    assert cli("explain", "limits-swapped").out == explained.out
    assert cli("explain", "J999").code == 2
    assert all("code" in entry for entry in cli("rules", "-F", "json").json["result"]["rules"])
