"""The report as JUnit XML: a suite for each file, a test for each finding that counts, and for each expectation.

What does not fail a file is told in its suite's output, so that a CI system's red and green are those of the verdicts.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from xml.sax.saxutils import escape, quoteattr

from kinetostat.errors import printable
from kinetostat.gate.result import CheckReport, FileCheck, Verdict
from kinetostat.lint.finding import Finding, Severity
from kinetostat.policy.outcome import Outcome
from kinetostat.report.check.words import (
    agreement_text,
    configuration_text,
    disagreement_text,
    finding_text,
    renewal_text,
    skipped_by_reason,
)

__all__ = ["render"]

_COMMAND = re.compile("^([^!-~\n]*)::", re.MULTILINE)
_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def render(report: CheckReport) -> str:
    """Return the report as JUnit XML; it is XML 1.0 whatever names hold.

    Args:
        report: what was found out.
    """
    suites = [_suite(file, report.fail_on) for file in report.files]
    total = _attributes(
        name="kinetostat check",
        tests=sum(len(suite.cases) for suite in suites),
        failures=sum(suite.failures for suite in suites),
        errors=sum(suite.errors for suite in suites),
        skipped=sum(suite.skipped for suite in suites),
        time=f"{sum(file.seconds for file in report.files):.3f}",
    )
    body = "".join(suite.text for suite in suites)
    return _inert(f'<?xml version="1.0" encoding="UTF-8"?>\n<testsuites{total}>\n{body}</testsuites>\n')


class _Case:
    """A test: its name, and how it came out (`passed`, `failure`, `error`, `skipped`)."""

    def __init__(self, name: str, came_out: str = "passed", message: str = "", text: str = "", kind: str = "") -> None:
        self.name, self.came_out, self.message, self.text, self.kind = name, came_out, message, text, kind

    def xml(self, path: str) -> str:
        head = f"  <testcase{_attributes(classname=path, name=self.name)}"
        if self.came_out == "passed":
            output = f">\n   <system-out>{_text(self.text)}</system-out>\n  </testcase>\n"
            return head + (output if self.text else "/>\n")
        kind = {"type": self.kind} if self.kind else {}
        inside = f"<{self.came_out}{_attributes(message=self.message, **kind)}>{_text(self.text)}</{self.came_out}>"
        return f"{head}>\n   {inside}\n  </testcase>\n"


class _Suite:
    """The tests of a file, and what else there is to tell about it."""

    def __init__(self, file: FileCheck, cases: list[_Case], told: list[str]) -> None:
        self.file, self.cases, self.told = file, cases, told

    def count(self, came_out: str) -> int:
        return sum(case.came_out == came_out for case in self.cases)

    @property
    def failures(self) -> int:
        return self.count("failure")

    @property
    def errors(self) -> int:
        return self.count("error")

    @property
    def skipped(self) -> int:
        return self.count("skipped")

    @property
    def text(self) -> str:
        path = printable(self.file.path)
        counts = {"failures": self.failures, "errors": self.errors, "skipped": self.skipped}
        head = _attributes(name=path, tests=len(self.cases), **counts, time=f"{self.file.seconds:.3f}")
        output = f"  <system-out>{_text(chr(10).join(self.told))}</system-out>\n" if self.told else ""
        return f" <testsuite{head}>\n{''.join(case.xml(path) for case in self.cases)}{output} </testsuite>\n"


def _suite(file: FileCheck, fail_on: Severity) -> _Suite:
    told = [_line(finding) for finding in file.findings if not _fails(finding, fail_on)]
    back = ((file.suppressed, "suppressed by comments"), (file.known, "known from the baseline"))
    told += [f"{count} {what}" for count, what in back if count]
    return _Suite(file, list(_cases(file, fail_on)), told)


def _fails(finding: Finding, fail_on: Severity) -> bool:
    return finding.severity.rank <= fail_on.rank


def _cases(file: FileCheck, fail_on: Severity) -> Iterator[_Case]:
    if file.verdict is Verdict.CRASHED:
        reason = printable(file.reason) or "no reason is known"
        yield _Case("check", "error", f"crashed: {reason}", "nothing is known about this robot", "crashed")
    failing = [finding for finding in file.findings if _fails(finding, fail_on)]
    for finding in failing:
        place = f" at line {finding.line}" if finding.line else ""
        name = f"{finding.code} {finding.name}{place}"
        yield _Case(printable(name), "failure", finding_text(finding), _line(finding), finding.severity.value)
    if not failing and file.verdict is not Verdict.CRASHED:
        yield _Case("rules")
    for reason, codes in skipped_by_reason(file).items():
        if codes != "crosscheck":
            yield _Case(f"rules not asked: {reason}", "skipped", codes)
    if file.verdict is not Verdict.CRASHED:
        yield _crosscheck(file)
    yield from map(_expectation, file.outcomes)


def _crosscheck(file: FileCheck) -> _Case:
    agreement = file.agreement
    if agreement is None:
        reason = file.skipped.get("crosscheck", "the robot cannot be read, or this was left out")
        return _Case("cross-check", "skipped", printable(reason))
    lines = [agreement_text(agreement), *map(disagreement_text, agreement.disagreements)]
    text = "\n".join([*lines, *map(printable, agreement.notes)])
    # Where a file passes all the same, its owner has taken back, or the baseline knows, that they disagree.
    if agreement.agree or file.verdict is Verdict.PASS:
        return _Case("cross-check", text=text)
    return _Case("cross-check", "failure", lines[1], text, "disagreement")


def _expectation(outcome: Outcome) -> _Case:
    name = printable(": ".join(filter(None, (outcome.place, outcome.title or outcome.kind))))
    if outcome.met:
        return _Case(name, text=printable(f"wanted {outcome.wanted}, found {outcome.found}"))
    if outcome.met is None:
        return _Case(name, "error", printable(f"could not be judged: {outcome.found}"), kind="not judged")
    told = printable(f"wanted {outcome.wanted}, found {outcome.found}")
    where = "\n".join(filter(None, (configuration_text(outcome.witness), renewal_text(outcome))))
    return _Case(name, "failure", told, where, "not met")


def _line(finding: Finding) -> str:
    place = f"{printable(finding.file)}:" if finding.file else ""
    place += f"{finding.line}:" if finding.line else ""
    told = f"{place}{finding.code} {finding.severity} {finding_text(finding)}"
    return f"{told} ({printable(finding.hint)})" if finding.hint else told


def _attributes(**values: str | int) -> str:
    return "".join(f" {name}={quoteattr(_xml(str(value)))}" for name, value in values.items())


def _text(text: str) -> str:
    return escape(_xml(text))


def _inert(text: str) -> str:
    """Return the XML such that a runner of GitHub Actions, to which it may be printed, reads no command in it."""
    return _COMMAND.sub(r"\1&#58;:", text).replace("##[", "##&#91;")


def _xml(text: str) -> str:
    """Return the text without characters that XML 1.0 cannot hold."""
    return _NOT_XML.sub("\N{REPLACEMENT CHARACTER}", text)
