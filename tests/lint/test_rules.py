"""Every rule: its cases (data, `cases/CODE.yml`), its examples, its documents."""

from pathlib import Path

import pytest
import yaml

from kinetostat.lint.registry import FAMILIES, RULES
from kinetostat.lint.rule import Example
from lint.examples import linted, marked

CASES = Path(__file__).parent / "cases"
# What only the gate can ask has its cases in tests/lint/test_readers.py: no file can make readers disagree.
OF_FILES = [rule for rule in RULES if not rule.by_gate]
KEYS = {"name", "robot", "srdf", "files", "lines", "says"}


def cases(kind):
    return [
        pytest.param(path.stem, case, id=f"{path.stem}-{case['name']}")
        for path in sorted(CASES.glob("*.yml"))
        for case in yaml.safe_load(path.read_text(encoding="utf-8"))[kind]
    ]


def findings(code, case, folder):
    assert set(case) <= KEYS, "a misspelt key"
    example = Example(case["robot"], case.get("srdf", ""), case.get("files", {}))
    result = linted(example, folder)
    assert code not in result.skipped, result.skipped[code]
    return [finding for finding in result.findings if finding.code == code]


@pytest.mark.parametrize(("code", "case"), cases("fail"))
def test_a_rule_finds_what_it_is_meant_to(code, case, tmp_path):
    found = findings(code, case, tmp_path)
    assert [finding.line for finding in found] == case["lines"]
    for finding, words in zip(found, case.get("says", []), strict=False):
        assert words in finding.message


@pytest.mark.parametrize(("code", "case"), cases("pass"))
def test_a_rule_lets_pass_what_it_is_meant_to(code, case, tmp_path):
    assert findings(code, case, tmp_path) == []


@pytest.mark.parametrize("rule", OF_FILES, ids=lambda rule: rule.code)
def test_a_rule_has_cases_of_both_kinds(rule):
    content = yaml.safe_load((CASES / f"{rule.code}.yml").read_text(encoding="utf-8"))
    assert set(content) == {"fail", "pass"}
    assert content["fail"]
    assert content["pass"]


def test_every_file_of_cases_is_of_a_rule():
    assert {path.stem for path in CASES.iterdir()} == {rule.code for rule in OF_FILES}


@pytest.mark.parametrize("rule", OF_FILES, ids=lambda rule: rule.code)
def test_a_rule_fires_on_its_bad_example_where_it_is_marked_and_not_on_its_good_one(rule, tmp_path):
    (tmp_path / "bad").mkdir()
    (tmp_path / "good").mkdir()
    bad, good = linted(rule.bad, tmp_path / "bad"), linted(rule.good, tmp_path / "good")
    here = [f.line for f in bad.findings if f.code == rule.code and not f.file]
    there = [f.line for f in bad.findings if f.code == rule.code and f.file]
    assert here == marked(rule.bad.robot_text, rule.code)
    assert there == marked(rule.bad.srdf_text, rule.code)
    assert here or there
    assert [f for f in good.findings if f.code == rule.code] == []
    assert rule.code not in good.skipped


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.code)
def test_a_rule_is_documented(rule):
    assert rule.code[0] in FAMILIES
    assert len(rule.code) == 4
    assert rule.code[1:].isdigit()
    assert rule.name == rule.name.lower().replace(" ", "-")
    assert rule.aim.endswith(".")
    assert len(rule.aim) <= 100
    assert len(rule.why) > 60, "why it matters"
    assert rule.hint
    assert "\n" not in rule.hint


def test_codes_and_names_are_unique_and_in_order():
    codes, names = [rule.code for rule in RULES], [rule.name for rule in RULES]
    assert len(set(codes)) == len(codes)
    assert len(set(names)) == len(names)
    for family in FAMILIES:
        mine = [code for code in codes if code.startswith(family)]
        assert mine == sorted(mine)
