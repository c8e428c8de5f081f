"""The report as annotations of GitHub Actions: what its runner would read."""

import re
from pathlib import Path
from urllib.parse import unquote

from hypothesis import given, settings

from kinetostat.gate.result import CheckReport, FileCheck, Verdict
from kinetostat.lint.finding import Severity
from kinetostat.report.check.github import render
from report.check_reports import REPORT, hostile_report, reports

COMMAND = re.compile(r"::(error|warning|notice) ([^:]*)::(.*)")


def annotations(report, **options):
    """Return kind, properties and message of each annotation, as a runner reads them."""
    *lines, totals = render(report, **options).encode().decode().removesuffix("\n").split("\n")
    assert not totals.startswith("::")
    found = []
    for line in lines:
        kind, properties, message = COMMAND.fullmatch(line).groups()
        pairs = dict(pair.split("=", 1) for pair in properties.split(","))
        found.append((kind, {key: unquote(value) for key, value in pairs.items()}, unquote(message)))
    return found


def test_each_thing_is_an_annotation_at_its_line():
    found = annotations(REPORT)
    kind, where, message = next(a for a in found if a[1]["title"] == "J103 swapped-limits" and "line" in a[1])
    assert kind == "error"
    assert where["file"] == "robots/bad.urdf"
    assert where["line"] == "3"
    assert '    <limit lower="2" upper'[int(where["col"]) - 1 : int(where["endColumn"])] == 'lower="2"'
    assert message == "<joint name='elbow'><limit>: lower 2 rad is above upper -2 rad (swap lower and upper)"
    assert ("warning", "robots/bad.srdf", "4") in {(k, w["file"], w.get("line")) for k, w, _ in found}


def test_expectations_and_crashes_are_errors_of_the_file():
    found = annotations(REPORT)
    policy = [a for a in found if a[1]["title"].startswith("POLICY")]
    assert [(kind, where["file"]) for kind, where, _ in policy] == [("error", "robots/bad.urdf")] * 2
    assert "wanted at most 80 % of effort, found 93 % at elbow 1.5" in policy[0][2]
    crash = next(a for a in found if a[1]["file"] == "robots/crash.urdf")
    assert crash[0] == "error"
    assert "no answer after 60 s" in crash[2]


def test_lines_of_an_expanded_xacro_are_of_no_file():
    where = next(where for _, where, _ in annotations(REPORT) if where["file"].endswith(".xacro"))
    assert "line" not in where


def test_paths_are_relative_to_the_repository():
    file = FileCheck("/work/repo/robots/a.urdf", Verdict.CRASHED, reason="x")
    elsewhere = FileCheck("/tmp/b.urdf", Verdict.CRASHED, reason="x")
    found = annotations(CheckReport((file, elsewhere)), base=Path("/work/repo"))
    assert [where["file"] for _, where, _ in found] == ["robots/a.urdf", "/tmp/b.urdf"]


def test_a_hostile_name_plants_no_command():
    found = annotations(hostile_report())
    assert {kind for kind, _, _ in found} == {"error"}
    assert all(set(where) <= {"file", "line", "col", "endColumn", "title"} for _, where, _ in found)


@settings(max_examples=100, deadline=None)
@given(reports())
def test_there_is_an_annotation_for_each_thing_and_an_error_where_a_crash_or_unmet_is(report):
    found = annotations(report)
    unmet = [outcome for file in report.files for outcome in file.outcomes if not outcome.met]
    crashed = [file for file in report.files if file.verdict is Verdict.CRASHED]
    told = [finding for file in report.files for finding in file.findings]
    assert len(found) == len(told) + len(unmet) + len(crashed)
    errors = sum(f.severity is Severity.ERROR for f in told) + len(unmet) + len(crashed)
    assert sum(kind == "error" for kind, _, _ in found) == errors
