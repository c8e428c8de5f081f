"""The report for programs."""

import json

from hypothesis import given, settings

from kinetostat.report.check.json import render
from report.check_reports import BAD, REPORT, hostile_report, reports


def refuse(constant):
    raise AssertionError(constant)


def read(report, **options):
    return json.loads(render(report, **options).encode(), parse_constant=refuse)


def test_the_envelope_is_that_of_all_commands():
    payload = read(REPORT, warnings=("w",))
    assert list(payload) == ["schema", "result", "warnings"]
    assert payload["schema"] == "kinetostat/check/1"
    assert payload["warnings"] == ["w"]
    assert payload["result"]["passed"] is False
    assert payload["result"]["fail_on"] == "error"


def test_a_file_has_the_keys_that_other_tools_read():
    file = read(REPORT)["result"]["files"][1]
    assert file["path"] == "robots/bad.urdf"
    assert file["verdict"] == "fail"
    assert {"findings", "crosscheck", "policy", "skipped", "suppressed", "known", "reason"} <= set(file)
    first, *_, last = file["findings"]
    assert first == {
        "code": "J103",
        "name": "swapped-limits",
        "severity": "error",
        "message": "lower 2 rad is above upper -2 rad",
        "file": None,
        "line": 3,
        "element": "<joint name='elbow'><limit>",
        "attribute": "lower",
        "hint": "swap lower and upper",
    }
    assert last["file"] == "robots/bad.srdf"
    assert file["crosscheck"]["agree"] is False
    assert file["crosscheck"]["disagreements"][0]["configuration"] == {"elbow": 0.25, "wrist": 0.0}
    assert [outcome["met"] for outcome in file["policy"]] == [True, False, None]
    assert file["policy"][1]["witness"] == {"elbow": 1.5}
    assert file["skipped"] == BAD.skipped


def test_the_summary_counts():
    assert read(REPORT)["result"]["summary"] == {
        "files": 4,
        "passed": 1,
        "failed": 2,
        "crashed": 1,
        "errors": 2,
        "warnings": 2,
        "infos": 2,
        "suppressed": 1,
        "known": 2,
        "met": 2,
        "unmet": 2,
        "unjudged": 1,
    }


def test_names_are_as_they_are_and_what_is_not_finite_is_null():
    file, crash = read(hostile_report())["result"]["files"]
    nasty = hostile_report().files[0].findings[0].element
    # Only lone surrogates, which UTF-8 cannot hold, are written as text.
    assert file["findings"][0]["element"] == nasty.replace("\ud800", "\\ud800").replace("\udcff", "\\udcff")
    assert file["crosscheck"]["max_difference"] is None
    assert file["crosscheck"]["disagreements"][0]["size"] is None
    assert crash["verdict"] == "crashed"
    assert crash["reason"]


@settings(max_examples=100, deadline=None)
@given(reports())
def test_nothing_is_lost(report):
    result = read(report)["result"]
    assert result["passed"] == report.passed
    assert [file["path"] for file in result["files"]] == [file.path for file in report.files]
    for told, file in zip(result["files"], report.files, strict=True):
        assert [f["message"] for f in told["findings"]] == [f.message for f in file.findings]
        assert [o["met"] for o in told["policy"]] == [o.met for o in file.outcomes]
