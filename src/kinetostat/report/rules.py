"""Views and JSON of `rules` (all of them) and of `explain` (one: its aim, why it matters, a bad and a good example)."""

from __future__ import annotations

import inspect
from collections.abc import Iterator, Sequence

from kinetostat.errors import cut
from kinetostat.lint.registry import FAMILIES
from kinetostat.lint.rule import Example, Needs, Rule
from kinetostat.lint.rules.xml import UnusedSuppression
from kinetostat.policy.manual import Page
from kinetostat.report.expectations import expectations_table, listed_expectations
from kinetostat.report.json import Json
from kinetostat.report.view import Cell, Table, View

__all__ = ["explain_result", "explain_view", "paragraphs", "rules_result", "rules_view", "shortened"]

_LONGEST_LINE = 160  # of an example
_MOST_LINES = 32  # a longer one is shown by its beginning and its end
_HEAD, _TAIL = 10, 2


def rules_view(rules: Sequence[Rule], expectations: Sequence[Page] = ()) -> View:
    """Return the view of all rules, a table a family, then the kinds of expectations; for CSV the rules alone."""
    header = ("code", "severity", "name", "aim")
    tables = []
    for letter, family in FAMILIES.items():
        rows = tuple(_row(rule) for rule in rules if rule.code.startswith(letter))
        if rows:
            tables.append(Table(header, rows, title=f"{letter}: {family}", words=True))
    flat = Table(header, tuple(_row(rule) for rule in rules), words=True)
    count = f"{len(rules)} rule{'' if len(rules) == 1 else 's'}"
    note = "'kinetostat explain CODE' tells why a rule matters, with a bad and a good example"
    if expectations:
        tables.append(expectations_table(expectations))
        count += f", {len(expectations)} kinds of expectations"
        note += "; 'kinetostat explain KIND' what an expectation means, with its keys"
    return View(count, tuple(tables), (note,), flat=flat)


def _row(rule: Rule) -> tuple[Cell, ...]:
    return rule.code, rule.severity.value, rule.name, rule.aim


def explain_view(rule: Rule) -> View:
    """Return the view of one rule."""
    tables = [
        Table(("",), tuple((part,) for part in paragraphs(rule.why)), title="Why it matters", words=True),
        Table(("",), ((rule.hint,),), title="What to do", words=True),
    ]
    tables += _example(rule.bad, f"Bad: {rule.code} is found where it is marked")
    tables += _example(rule.good, "Good")
    flat = Table(("code", "name", "severity", "aim", "why", "hint"), (_flat(rule),), words=True)
    return View(
        f"{rule.code} {rule.name} ({rule.severity})\n{rule.aim}", tuple(tables), (_taken_back(rule),), flat=flat
    )


def _taken_back(rule: Rule) -> str:
    """Return how a comment takes a finding of a rule back, or that none does."""
    if isinstance(rule, UnusedSuppression):
        return "no other comment takes it back: correct or remove the one that it is about"
    if rule.needs is Needs.BYTES:
        return "no comment takes it back where the file cannot be read"
    return f"to take it back: <!-- kinetostat: ignore[{rule.code}] REASON --> before the element"


def _flat(rule: Rule) -> tuple[Cell, ...]:
    return rule.code, rule.name, rule.severity.value, rule.aim, " ".join(rule.why.split()), rule.hint


def _example(example: Example, title: str) -> Iterator[Table]:
    yield _listing(example.robot, title)
    if example.srdf:
        yield _listing(example.srdf, "with the SRDF")
    for path, text in example.files.items():
        yield _listing(text or "(empty)", f"with the file {path}")


def _listing(text: str, title: str) -> Table:
    rows = tuple((f"  {line}" if line else "",) for line in shortened(inspect.cleandoc(text)).splitlines())
    return Table(("",), rows, title=title, words=True)


def paragraphs(text: str) -> tuple[str, ...]:
    """Return the paragraphs of a docstring, each in a line."""
    return tuple(" ".join(part.split()) for part in text.split("\n\n") if part.strip())


def shortened(text: str) -> str:
    """Return the text of an example as it is shown: long lines are cut, many lines left out in the middle."""
    lines = [cut(line, _LONGEST_LINE) for line in text.splitlines()]
    if len(lines) > _MOST_LINES:
        lines = [*lines[:_HEAD], f"... {len(lines) - _HEAD - _TAIL} more lines ...", *lines[-_TAIL:]]
    return "\n".join(lines)


def rules_result(rules: Sequence[Rule], expectations: Sequence[Page] = ()) -> Json:
    """Return the result object of `rules`."""
    listed = listed_expectations(expectations)
    return {"families": dict(FAMILIES), "rules": [_said(rule) for rule in rules], "expectations": listed}


def explain_result(rule: Rule) -> Json:
    """Return the result object of `explain`."""
    return _said(rule) | {"why": rule.why, "bad": _texts(rule.bad), "good": _texts(rule.good)}


def _said(rule: Rule) -> Json:
    return {
        "code": rule.code,
        "name": rule.name,
        "family": FAMILIES.get(rule.code[0]),
        "severity": rule.severity.value,
        "aim": rule.aim,
        "hint": rule.hint,
    }


def _texts(example: Example) -> Json:
    return {"robot": example.robot_text, "srdf": example.srdf_text or None, "files": dict(example.files)}
