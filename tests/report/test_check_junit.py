"""The report as JUnit XML, read by junitparser."""

from hypothesis import given, settings
from junitparser import Error, Failure, JUnitXml, Skipped

from kinetostat.gate.result import CheckReport, FileCheck, Verdict
from kinetostat.lint.finding import Severity
from kinetostat.report.check.junit import render
from report.check_reports import APART, BAD, CRASH, EMPTY, GOOD, REPORT, finding, hostile_report, reports


def read(report):
    return JUnitXml.fromstring(render(report).encode())


def outcomes(suite):
    return {case.name: [type(result) for result in case.result] for case in suite}


def suite_of(file, fail_on=Severity.ERROR):
    (suite,) = read(CheckReport((file,), fail_on))
    return suite


def test_each_file_is_a_suite_that_counts_right():
    xml = read(REPORT)
    assert [suite.name for suite in xml] == [file.path for file in REPORT.files]
    for suite in xml:
        found = [kind for kinds in outcomes(suite).values() for kind in kinds]
        assert suite.tests == len(list(suite))
        assert (suite.failures, suite.errors, suite.skipped) == tuple(map(found.count, (Failure, Error, Skipped)))
    assert (xml.failures, xml.errors) == (sum(s.failures for s in xml), sum(s.errors for s in xml))


def test_what_fails_is_a_failure_and_what_cannot_be_told_an_error():
    assert outcomes(suite_of(BAD)) == {
        "J103 swapped-limits at line 3": [Failure],
        "rules not asked: the chain is too long": [Skipped],
        "rules not asked: no package": [Skipped],
        "cross-check": [Failure],
        "kinetostat.toml:4: total mass": [],
        "kinetostat.toml:12: holds 5 kg at tool0": [Failure],
        "kinetostat.toml:19: holds 5 kg at hand": [Error],
    }
    (failure,) = next(case for case in suite_of(BAD) if case.name.startswith("J103")).result
    assert failure.message == "<joint name='elbow'><limit>: lower 2 rad is above upper -2 rad"
    assert failure.type == "error"
    assert "swap lower and upper" in failure.text


def test_what_does_not_fail_is_told_beside():
    assert "7:N201 warning" in suite_of(BAD)._elem.findtext("system-out")
    assert "1 suppressed by comments" in suite_of(GOOD)._elem.findtext("system-out")
    assert "N201 odd-name at line 7" in outcomes(suite_of(BAD, Severity.WARNING))


def test_a_crash_is_an_error():
    assert outcomes(suite_of(CRASH)) == {"check": [Error]}


def test_a_file_without_findings_has_a_passing_test():
    assert outcomes(suite_of(FileCheck("a.urdf", Verdict.PASS))) == {"rules": [], "cross-check": [Skipped]}


def test_why_there_was_no_cross_check_is_told():
    file = FileCheck("a.urdf", Verdict.PASS, skipped={"crosscheck": "Pinocchio refuses it"})
    (case,) = (case for case in suite_of(file) if case.name == "cross-check")
    assert case.result[0].message == "Pinocchio refuses it"


def test_a_disagreement_that_was_taken_back_is_no_failure():
    suite = suite_of(FileCheck("a.urdf", Verdict.PASS, agreement=APART, known=1))
    assert outcomes(suite)["cross-check"] == []
    assert "odd one out" in next(case for case in suite if case.name == "cross-check").system_out


def test_hostile_names_are_text():
    xml = read(hostile_report())
    tags = {element.tag for suite in xml for element in suite._elem.iter()}
    assert tags <= {"testsuite", "testcase", "failure", "error", "skipped", "system-out"}
    messages = [result.message for suite in xml for case in suite for result in case.result]
    assert any("<script>alert(1)</script>" in message for message in messages)


def test_no_file_is_no_suite():
    assert list(read(EMPTY)) == []


def test_of_one_failing_finding_twice_both_are_there():
    suite = suite_of(FileCheck("a.urdf", Verdict.FAIL, (finding(), finding(message="other"))))
    assert suite.failures == 2


@settings(max_examples=150, deadline=None)
@given(reports())
def test_red_and_green_are_those_of_the_verdicts(report):
    for suite, file in zip(read(report), report.files, strict=True):
        assert (suite.failures + suite.errors == 0) == (file.verdict is Verdict.PASS)
        assert suite.tests >= 1
