"""Laws of the rules of XML and schema: a refusal has a named reason, and odd bytes never stop the rules."""

import json
import random
import re
from pathlib import Path

import pytest

from kinetostat.lint.linting import lint
from kinetostat.lint.registry import RULES, chosen
from kinetostat.lint.subject import subject_of
from kinetostat.urdf.files import example_robots, open_source

CORPUS = Path(__file__).parents[1] / "corpus"
BROKEN = ("xml", "structure", "numbers", "format")
MINE = chosen(["X", "T"])
# Verdict warn, and an error here: every DOCTYPE is refused, for it can name other files and expand without end.
OTHERWISE = {"dtd_external.urdf": "error"}
# What other families say.
OTHERS = ("axis_missing.urdf", "axis_nonunit.urdf", "axis_nonunit_prismatic.urdf", "axis_tiny.urdf")


def manifest():
    return json.loads((CORPUS / "manifest.json").read_text(encoding="utf-8"))


def mine():
    return [entry for entry in manifest() if entry["cat"] in BROKEN and entry["name"] not in OTHERS]


def verdict(findings):
    severities = {finding.severity for finding in findings}
    return "error" if "error" in severities else "warn" if "warning" in severities else "ok"


@pytest.mark.parametrize("entry", mine(), ids=lambda entry: entry["name"])
def test_the_verdict_on_odd_files_is_the_wanted_one(entry):
    found = lint(subject_of(str(CORPUS / "files" / entry["name"])), MINE).findings
    assert verdict(found) == OTHERWISE.get(entry["name"], entry["expected"])


@pytest.mark.parametrize("entry", manifest(), ids=lambda entry: entry["name"])
def test_no_odd_file_is_refused_without_a_rule_that_says_why(entry):
    found = lint(subject_of(str(CORPUS / "files" / entry["name"])), RULES).findings
    assert "X001" not in {finding.code for finding in found}


@pytest.mark.parametrize("name", example_robots())
def test_real_robots_are_xml_and_their_numbers_are_numbers(name):
    found = lint(subject_of(f"example:{name}"), chosen(["X1", "X3"])).findings
    assert [f for f in found if f.code != "X001"] == []


def mutated(text, rng):
    """Return a robot with a slip in an element's name, an attribute or a value."""
    start, end = rng.choice([m.span() for m in re.finditer(r'"[^"<>]*"|<\w+|\w+(?==)', text)])
    word = text[start:end]
    values = ['""', '"nan"', '"1,5"', '"0 0"', '"1e400"', '"x"', '"${a}"', '"inf"', '"\x7f"', f'{word[:-1]}z"']
    new = rng.choice(values) if word[0] == '"' else word + "z"
    return text[:start] + new + text[end:]


@pytest.mark.parametrize("seed", range(8))
def test_what_slips_do_to_a_real_robot_is_named(seed):
    rng = random.Random(seed)
    names = [n for n in example_robots() if len(open_source(f"example:{n}").data) < 60_000]
    text = open_source(f"example:{rng.choice(names)}").data.decode()
    for _ in range(12):
        subject = subject_of_text(mutated(text, rng))
        found = [f for rule in MINE if subject.document or rule.needs == 0 for f in rule.check(subject)]
        assert all(f.message.isprintable() for f in found)
        if subject.refusal is not None and "no xyz" not in subject.refusal.message:  # J203
            line = subject.refusal.line
            assert [f for f in found if f.severity == "error" and line in (None, f.line)], subject.refusal


def subject_of_text(text):
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "robot.urdf"
        path.write_text(text, encoding="utf-8")
        return subject_of(str(path))
