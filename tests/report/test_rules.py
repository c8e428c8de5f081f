"""What `rules` and `explain` show."""

import json

import pytest

from kinetostat.errors import printable
from kinetostat.lint.registry import FAMILIES, RULES
from kinetostat.policy.manual import kind_pages
from kinetostat.report import csv, text
from kinetostat.report import json as report_json
from kinetostat.report.rules import explain_result, explain_view, rules_result, rules_view


def test_all_rules_are_listed_by_family():
    shown = text.render(rules_view(RULES))
    assert max(map(len, shown.splitlines())) <= 80
    for rule in RULES:
        assert f"\n{rule.code}  {rule.severity}" in shown
    for letter in {rule.code[0] for rule in RULES}:
        assert f"{letter}: {FAMILIES[letter]}" in shown


def test_csv_has_a_row_for_each_rule():
    rows = csv.render(rules_view(RULES).csv).splitlines()
    assert rows[0] == "code,severity,name,aim"
    assert [row.split(",")[0] for row in rows[1:]] == [rule.code for rule in RULES]


def test_json_has_all_rules():
    found = json.loads(report_json.render(rules_result(RULES)))
    assert [rule["code"] for rule in found["rules"]] == [rule.code for rule in RULES]
    assert found["families"] == FAMILIES


def test_the_list_ends_with_the_kinds_of_expectations():
    shown = text.render(rules_view(RULES, kind_pages()))
    rules, _, kinds = shown.partition("Expectations, ")
    assert all(f"\n{kind.name} " in kinds for kind in kind_pages())
    assert f"{RULES[-1].code}  " in rules
    assert max(map(len, shown.splitlines())) <= 80
    found = json.loads(report_json.render(rules_result(RULES, kind_pages())))
    assert [one["kind"] for one in found["expectations"]] == [kind.name for kind in kind_pages()]


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.code)
def test_a_rule_is_explained(rule):
    shown = text.render(explain_view(rule))
    assert max(map(len, shown.splitlines())) <= 80
    words = " ".join(shown.split())
    assert rule.aim in words
    assert rule.hint in words
    assert " ".join(rule.why.split()) in words
    for line in (*rule.bad.robot.splitlines()[:10], *rule.good.robot.splitlines()[:10]):
        assert " ".join(printable(line)[:70].split()) in words
    told = json.loads(report_json.render(explain_result(rule)))
    assert told["bad"]["robot"] == rule.bad.robot_text
    assert told["why"] == rule.why


def page(code):
    return text.render(explain_view(next(rule for rule in RULES if rule.code == code)))


@pytest.mark.parametrize("code", ["J103", "X105", "T101", "K101"])
def test_how_a_finding_is_taken_back_is_told(code):
    assert f"ignore[{code}] REASON" in page(code)


@pytest.mark.parametrize("code", ["X001", "X002", "X101", "X102", "X103", "X104"])
def test_no_way_is_told_to_take_back_what_no_comment_can(code):
    assert f"ignore[{code}]" not in page(code)
    assert "comment takes it back" in page(code)


def test_a_page_shows_a_long_example_by_its_beginning_and_its_end():
    lines = page("T114").splitlines()
    assert len(lines) < 60
    assert any("more lines ..." in line for line in lines)
    assert any(line.strip() == "</robot>" for line in lines)
