"""The report as SARIF: valid against the schema of version 2.1.0, and what GitHub's code scanning needs.

The schema is `sarif-2.1.0-rtm.5.json`, the last one before the OASIS standard, as Microsoft's npm package
`@microsoft/jest-sarif` 1.0.0-beta.0 (MIT licence) ships it.
"""

import json
from dataclasses import replace
from pathlib import Path
from urllib.parse import unquote, urlsplit

import jsonschema
import pytest
from hypothesis import given, settings

from kinetostat.gate.result import CheckReport, FileCheck, Verdict
from kinetostat.lint.registry import RULES
from kinetostat.report.check.sarif import render
from report.check_reports import BAD, EMPTY, GOOD, LIMIT, REPORT, XACRO, finding, hostile_report, reports

SCHEMA = json.loads((Path(__file__).parent / "sarif-2.1.0-rtm.5.json").read_text(encoding="utf-8"))
VALIDATOR = jsonschema.Draft4Validator(SCHEMA)


def read(report, **options):
    log = json.loads(render(report, **options).encode())
    VALIDATOR.validate(log)
    return log["runs"][0]


def of_findings(*found, **changes):
    return read(CheckReport((FileCheck("a.urdf", Verdict.FAIL, found, **changes),)))["results"]


def place(result):
    return result["locations"][0]["physicalLocation"]


def marks(results):
    return [result["partialFingerprints"]["kinetostat/v1"] for result in results]


def test_the_schema_tells_right_from_wrong():
    log = json.loads(render(REPORT))
    log["runs"][0]["results"][0]["level"] = "fatal"
    with pytest.raises(jsonschema.ValidationError):
        VALIDATOR.validate(log)


@pytest.mark.parametrize("report", [REPORT, EMPTY, hostile_report()], ids=["usual", "empty", "hostile"])
def test_it_is_valid(report):
    assert read(report)["tool"]["driver"]["name"] == "kinetostat"


def test_every_rule_that_there_is_is_described():
    found = tuple(finding(code=rule.code, name=rule.name, severity=rule.severity) for rule in RULES)
    run = read(CheckReport((FileCheck("a.urdf", Verdict.FAIL, found),)))
    rules = run["tool"]["driver"]["rules"]
    assert [rule["id"] for rule in rules] == [rule.code for rule in RULES]
    for told, rule in zip(rules, RULES, strict=True):
        assert told["shortDescription"]["text"] == rule.aim
        assert rule.hint in told["help"]["text"]


def test_a_result_points_at_its_rule_and_its_place():
    run = read(REPORT)
    for result in run["results"]:
        assert run["tool"]["driver"]["rules"][result["ruleIndex"]]["id"] == result["ruleId"]
    result = next(r for r in run["results"] if r["ruleId"] == "J103" and "region" in place(r))
    assert result["level"] == "error"
    assert place(result)["artifactLocation"] == {"uri": "robots/bad.urdf", "uriBaseId": "%SRCROOT%"}
    region = place(result)["region"]
    assert region["startLine"] == 3
    assert LIMIT[region["startColumn"] - 1 : region["endColumn"] - 1] == 'lower="2"'
    levels = {r["level"] for r in run["results"]}
    assert levels == {"error", "warning", "note"}


def test_there_is_no_line_where_there_is_none():
    assert "region" not in place(of_findings(finding(line=0))[0])
    expanded = read(CheckReport((XACRO,)))["results"]
    assert all("region" not in place(result) for result in expanded)


@pytest.mark.parametrize(
    ("path", "uri"),
    [
        ("robots/a b.urdf", "robots/a%20b.urdf"),
        ("./robots/../a.urdf", "a.urdf"),
        ("/repo/robots/a#1.urdf", "robots/a%231.urdf"),
        ("/elsewhere/a.urdf", "file:///elsewhere/a.urdf"),
        ("example:panda", "example%3Apanda"),
        ("caf\u00e9.urdf", "caf%C3%A9.urdf"),
        ("caf\udce9.urdf", "caf%E9.urdf"),
    ],
)
def test_a_path_becomes_a_uri(path, uri):
    file = FileCheck(path, Verdict.FAIL, (finding(),))
    (result,) = read(CheckReport((file,)), base=Path("/repo"))["results"]
    assert place(result)["artifactLocation"]["uri"] == uri


def test_a_hostile_path_is_a_relative_uri_that_leads_to_it():
    report = hostile_report()
    for result in read(report)["results"]:
        parts = urlsplit(place(result)["artifactLocation"]["uri"])
        assert (parts.scheme, parts.netloc, parts.query, parts.fragment) == ("", "", "", "")
        names = {report.files[0].path, report.files[1].path, report.files[0].findings[1].file}
        assert unquote(parts.path) in {n.encode("utf-8", "backslashreplace").decode().replace("//", "/") for n in names}


def test_a_message_holds_no_placeholder_and_no_link():
    (result,) = of_findings(finding(message="'${arm}' [here](0)", hint=""))
    text = result["message"]["text"]
    assert "](" not in text
    # What a reader makes of it: {{ is {, a lone {0} would be an argument.
    assert "{0" not in text.replace("{{", "").replace("}}", "")
    assert text.replace("{{", "{").replace("}}", "}").endswith("'${arm}' [here] (0)")


def test_fingerprints_outlive_edits_and_tell_findings_apart():
    before = of_findings(finding(), finding(element="<joint name='wrist'>"), finding(line=9))
    after = of_findings(
        finding(line=30, message="lower 3 rad is above upper -2 rad"),
        finding(line=31, element="<joint name='wrist'>"),
        finding(line=40),
    )
    assert marks(before) == marks(after)
    assert len(set(marks(before))) == 3
    elsewhere = read(CheckReport((FileCheck("b.urdf", Verdict.FAIL, (finding(),)),)))["results"]
    assert not set(marks(elsewhere)) & set(marks(before))


def test_unmet_expectations_are_results_at_the_robot_with_the_policy_beside():
    found = [r for r in read(REPORT)["results"] if r["ruleId"] == "POLICY"]
    assert [r["level"] for r in found] == ["error", "error"]
    assert "found 93 %" in found[0]["message"]["text"]
    assert place(found[0])["artifactLocation"]["uri"] == "robots/bad.urdf"
    related = found[0]["relatedLocations"][0]["physicalLocation"]
    assert related["artifactLocation"]["uri"] == "kinetostat.toml"
    assert related["region"] == {"startLine": 12}


def test_a_crash_is_never_a_pass():
    run = read(REPORT)
    invocation = run["invocations"][0]
    assert invocation["executionSuccessful"] is False
    errors = [n for n in invocation["toolExecutionNotifications"] if n["level"] == "error"]
    assert ["no answer after 60 s" in n["message"]["text"] for n in errors] == [True]
    crash = next(r for r in run["results"] if r["ruleId"] == "CRASHED")
    assert crash["level"] == "error"
    assert read(CheckReport((GOOD, BAD)))["invocations"][0]["executionSuccessful"] is True


def test_what_was_not_asked_is_told():
    notes = read(CheckReport((BAD,)))["invocations"][0]["toolExecutionNotifications"]
    assert [n["message"]["text"] for n in notes] == [
        "not asked: K101, K102 (the chain is too long)",
        "not asked: M101 (no package)",
    ]


def test_a_rule_that_is_not_in_the_registry_is_described_by_what_it_found():
    run = read(CheckReport((replace(BAD, findings=(finding(code="Z999", name="from-elsewhere"),)),)))
    rule = run["tool"]["driver"]["rules"][0]
    assert (rule["id"], rule["name"]) == ("Z999", "from-elsewhere")


@settings(max_examples=60, deadline=None)
@given(reports())
def test_any_report_is_valid_and_complete(report):
    run = read(report)
    errors = [result for result in run["results"] if result["level"] == "error"]
    for file in report.files:
        if file.verdict is Verdict.CRASHED or any(not outcome.met for outcome in file.outcomes):
            assert errors
