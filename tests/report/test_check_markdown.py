"""The report as Markdown, as a Markdown parser reads it."""

import re

import pytest
from hypothesis import given, settings

from kinetostat.errors import printable
from kinetostat.gate.result import CheckReport, FileCheck, Verdict
from kinetostat.lint.finding import Severity
from kinetostat.report.check.markdown import escaped, render
from report.check_reports import (
    BAD,
    CRASH,
    EMPTY,
    GOOD,
    HOSTILE,
    REPORT,
    finding,
    hostile_report,
    reports,
)
from report.markdown_page import Page

OURS = {
    "h3",
    "p",
    "table",
    "thead",
    "tbody",
    "tr",
    "th",
    "td",
    "details",
    "summary",
    "ul",
    "li",
    "code",
    "strong",
    "em",
}


def page(report, **options):
    return Page(render(report, **options).encode().decode())


def test_it_opens_with_the_verdict_and_the_totals():
    runs = "".join(page(REPORT).runs)
    assert runs.startswith("kinetostat check failed")
    assert "4 files: 1 passed, 2 failed, 1 crashed" in runs
    assert "".join(page(CheckReport((GOOD,))).runs).startswith("kinetostat check passed")


def test_there_is_a_table_with_the_worst_first():
    shown = page(REPORT)
    assert shown.rows == [3] * 5
    text = "".join(shown.runs)
    order = [text.index(path) for path in ("robots/crash.urdf", "robots/bad.urdf", "robots/good.urdf")]
    assert order == sorted(order)


def test_what_was_found_is_folded_and_open_where_it_fails():
    shown = page(CheckReport((BAD, CRASH, FileCheck("w.urdf", Verdict.PASS, (finding(Severity.WARNING),)), GOOD)))
    assert sorted(shown.folded) == [False, False, True]
    text = " ".join(shown.runs)
    assert "lower 2 rad is above upper -2 rad" in text
    assert "swap lower and upper" in text
    assert "93 %" in text
    assert "at elbow 1.5" in text
    assert "no answer after 60 s" in text
    assert "screw is the odd one out" in text
    assert "N202" not in text


def test_no_file_is_no_table():
    assert "table" not in page(EMPTY).tags


def test_hostile_names_are_text():
    shown = page(hostile_report())
    assert set(shown.tags) <= OURS
    assert set(shown.attributes) <= {"open"}
    assert shown.rows == [3] * 3
    text = "".join(shown.runs)
    assert printable(HOSTILE) in text
    for run in shown.runs:
        assert not re.search(r"@\w|#\d", run), "a mention, or a reference to an issue"
    assert "www." not in render(hostile_report())


@pytest.mark.parametrize(
    "text",
    [
        "# head",
        "- item",
        "1. item",
        "> quote",
        "---",
        "a\n\nb",
        "    code",
        "|a|b|",
        "<!--",
        "&lt;",
        "_i_",
        "__b__ a__b__",
        "a_b_c",
        "x:_y_",
        ":smile:",
        "http://e.example",
        "www.e.example",
    ],
)
def test_an_escaped_text_shows_as_it_is(text):
    assert "".join(Page(f"x {escaped(text)} y").runs) == f"x {printable(text)} y\n"


def test_it_stays_below_what_a_comment_may_hold():
    many = tuple(finding(line=i, message=f"{i} {'long ' * 20}") for i in range(100))
    files = tuple(FileCheck(f"robots/{i:04}.urdf", Verdict.FAIL, many) for i in range(1000))
    report = CheckReport(files)
    text = render(report)
    assert 20_000 < len(text) <= 60_000
    told = [int(n) for n in re.findall(r"\.\.\. and (\d+) file", text)]
    assert 1000 - text.count("| <code>robots/") == told[0]
    assert 1000 - text.count("<details") == told[1]
    assert set(Page(text).tags) <= OURS


@settings(max_examples=100, deadline=None)
@given(reports())
def test_any_report_is_whole(report):
    shown = page(report)
    assert set(shown.tags) <= OURS
    assert shown.rows == ([3] * (len(report.files) + 1) if report.files else [])
