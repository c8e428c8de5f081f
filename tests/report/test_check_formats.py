"""All formats by their names."""

import json
from xml.etree import ElementTree as ET

import pytest

from kinetostat.errors import UsageError
from kinetostat.gate.result import CheckReport, FileCheck, Verdict
from kinetostat.report.check import FORMATS, rendered
from kinetostat.report.check.words import path_from
from report.check_reports import APART, EMPTY, REPORT, finding, hostile_report


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("report", [REPORT, EMPTY, hostile_report()], ids=["usual", "empty", "hostile"])
def test_each_is_text_that_ends_its_last_line_and_says_the_same_twice(form, report):
    text = rendered(report, form)
    assert text.endswith("\n")
    assert text.encode()
    assert rendered(report, form) == text
    assert all(line.isprintable() for line in text.split("\n"))


def test_another_is_refused():
    with pytest.raises(UsageError, match="'xml'"):
        rendered(REPORT, "xml")


@pytest.mark.parametrize("form", FORMATS)
def test_none_has_a_command_of_github_that_a_robot_planted(form):
    planted = "::error::x ##[add-mask]y"
    found = finding(message=planted, element=planted, hint=planted, file=planted)
    files = (
        FileCheck(planted, Verdict.FAIL, (found,), APART, skipped={"K101": planted}),
        FileCheck(f"b{planted}", Verdict.CRASHED, reason=planted),
    )
    text = rendered(CheckReport(files), form)
    own = ("::error file=", "::notice file=") if form == "github" else ("\0",)
    for line in text.split("\n"):
        assert not line.lstrip().startswith("::") or line.startswith(own)
        # A runner looks for the old kind only in what is no command of the new.
        assert "##[" not in line or line.startswith(own)
    if form == "json":
        assert json.loads(text)["result"]["files"][0]["path"] == planted
    if form == "junit":
        assert ET.fromstring(text)[0].get("name") == planted


def test_paths_are_relative_to_the_repository_from_whatever_folder_they_are_asked_for(tmp_path):
    below = tmp_path / "repository" / "robots" / "arm"
    below.mkdir(parents=True)
    (tmp_path / "repository" / ".git").write_text("gitdir: elsewhere\n")  # as in a worktree
    assert path_from("a.urdf", below) == "robots/arm/a.urdf"
    assert path_from("../b.urdf", below) == "robots/b.urdf"
    assert path_from("../../c.urdf", below) == "c.urdf"
    assert path_from(str(below / "a.urdf"), below) == "robots/arm/a.urdf"
    assert path_from("../../../d.urdf", below) == (tmp_path / "d.urdf").as_posix()
    assert path_from("example:panda", below) == "example:panda"
    assert path_from("", below) == ""


def test_a_link_to_the_repository_is_the_repository(tmp_path):
    (tmp_path / "repository" / ".git").mkdir(parents=True)
    (tmp_path / "link").symlink_to("repository")
    there, here = tmp_path / "repository", tmp_path / "link"
    assert path_from("a.urdf", here) == "a.urdf"
    assert path_from(str(here / "a.urdf"), there) == "a.urdf"
    (there / "b.urdf").symlink_to("a.urdf")
    assert path_from(str(here / "b.urdf"), there) == "b.urdf"  # a robot that is a link keeps its name


def test_sarif_and_annotations_name_a_file_of_the_repository(tmp_path):
    (tmp_path / ".git").mkdir()
    (tmp_path / "robots").mkdir()
    file = FileCheck("../b.urdf", Verdict.FAIL, (finding(),))
    log = json.loads(rendered(CheckReport((file,)), "sarif", base=tmp_path / "robots"))
    place = log["runs"][0]["results"][0]["locations"][0]["physicalLocation"]["artifactLocation"]
    assert place == {"uri": "b.urdf", "uriBaseId": "%SRCROOT%"}
    assert "::error file=b.urdf,line=3," in rendered(CheckReport((file,)), "github", base=tmp_path / "robots")


def test_an_expectation_is_where_its_settings_are_in_the_repository(tmp_path):
    (tmp_path / ".git").mkdir()
    report = CheckReport(tuple(file for file in REPORT.files if file.outcomes))
    log = json.loads(rendered(report, "sarif", base=tmp_path / "robots"))
    related = [
        r["relatedLocations"][0]["physicalLocation"] for r in log["runs"][0]["results"] if r["ruleId"] == "POLICY"
    ]
    assert {place["artifactLocation"]["uri"] for place in related} == {"robots/kinetostat.toml"}
