"""All robots of example-robot-data through the gate: none crashes, readers agree, the census tells what is found."""

import importlib.util
from importlib.metadata import version
from pathlib import Path

import pytest

import kinetostat as ks
from kinetostat.lint.finding import Severity

DOCS = Path(__file__).parents[2] / "docs"
# The only errors: what no simulator loads as it stands.
FAIL = {
    "example:ur3": {"T101", "X201"},  # an empty macro expansion: no link, no name
    "example:romeo_laas_small": {"I202"},  # negative moments, which MuJoCo refuses
}


@pytest.fixture(scope="module")
def report():
    return ks.check(["example:*"], jobs=2)


def test_no_robot_crashes_and_only_what_no_simulator_takes_fails(report):
    failing = {
        file.path: {finding.code for finding in file.findings if finding.severity is Severity.ERROR}
        for file in report.files
        if file.verdict is not ks.Verdict.PASS
    }
    assert failing == FAIL
    assert len(report.files) >= 69


def test_the_readers_agree_on_every_robot_that_can_be_read(report):
    apart = [file.path for file in report.files if file.agreement is not None and not file.agreement.agree]
    assert apart == []
    assert [file.path for file in report.files if file.agreement is None] == ["example:ur3"]
    assert all("yourdfpy" in file.agreement.readers for file in report.files if file.agreement is not None)


def test_every_finding_points_at_a_line_of_a_file_that_has_it(report):
    for file in report.files:
        for finding in file.findings:
            assert finding.message
            assert finding.hint
            assert "\n" not in finding.message + finding.hint
            if finding.line:
                assert (finding.file, finding.line) in file.lines, (file.path, finding)


def test_the_census_is_what_is_found(report):
    page = (DOCS / "census.md").read_text(encoding="utf-8")
    if f"example-robot-data {version('example-robot-data')}" not in page:
        pytest.skip("the census is of another version of example-robot-data")
    spec = importlib.util.spec_from_file_location("census", DOCS / "census.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.page(report) == page, "make census"
