"""The report for people: file by file, each finding with its source line and a caret, in 80 columns."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterator

from kinetostat.errors import printable
from kinetostat.gate.result import CheckReport, FileCheck, Verdict
from kinetostat.lint.finding import Finding, Severity
from kinetostat.policy.outcome import Outcome
from kinetostat.report.check.source import columns, line_of, marked
from kinetostat.report.check.words import (
    agreement_text,
    configuration_text,
    counted,
    disagreement_text,
    finding_text,
    reasons,
    renewal_text,
    skipped_by_reason,
    totals,
    totals_text,
)

__all__ = ["Style", "render"]

WIDTH = 80
Style = Callable[[str, str], str]

_VERDICTS = {Verdict.PASS: "passed", Verdict.FAIL: "FAILED", Verdict.CRASHED: "CRASHED"}
_GUTTER = "      | "
# A runner of GitHub Actions reads a command where a line begins so, blanks aside.
_COMMAND = re.compile("[^!-~]*::")


def render(report: CheckReport, *, verbose: bool = False, style: Style | None = None) -> str:
    """Return the report as text.

    Args:
        report: what was found out.
        verbose: show all: info, expectations that are met, notes of the cross-check, codes of rules not asked.
        style: colours a piece of text (its second argument) by what it is: "path", "pass", "fail", "crashed", "error",
            "warning", "info", "code", "source", "caret", "hint", "totals".
    """
    writer = _Writer(verbose, style or _plain)
    blocks = ["\n".join(writer.file(file)) for file in report.files]
    return "\n\n".join([*blocks, "\n".join(writer.last(report))]) + "\n"


def _plain(_kind: str, text: str) -> str:
    return text


class _Writer:
    """Writes one report; it knows how much to show, and in which colours."""

    def __init__(self, verbose: bool, style: Style) -> None:
        self.verbose, self.style = verbose, style

    def file(self, file: FileCheck) -> Iterator[str]:
        """Yield the lines about a file."""
        yield from self._head(file)
        if file.expanded and any(finding.line and not finding.file for finding in file.findings):
            yield from _wrapped("  lines are those of the expanded xacro", 2)
        shown = [f for f in file.findings if self.verbose or f.severity is not Severity.INFO]
        for other in dict.fromkeys(finding.file for finding in shown):
            if other:
                yield f"  {self.style('path', _path(other))}:"
            for finding in shown:
                if finding.file == other:
                    yield from self._finding(file, finding)
        yield from self._agreement(file)
        yield from self._outcomes(file)
        for reason, codes in skipped_by_reason(file, all_codes=self.verbose).items():
            yield from _wrapped(f"  not asked: {codes} ({reason})", 4)

    def last(self, report: CheckReport) -> Iterator[str]:
        """Yield the line of totals."""
        hidden = not self.verbose and totals(report).infos
        kind = "pass" if report.passed else "fail"
        for line in _wrapped(totals_text(report) + (" (-v shows the info)" if hidden else ""), 2):
            yield self.style(kind, line)

    def _head(self, file: FileCheck) -> Iterator[str]:
        path, verdict = _path(file.path), _VERDICTS[file.verdict]
        rest = _inert(reasons(file))
        plain = f"{path}: {verdict}" + (f": {rest}" if rest else "")
        coloured = f"{self.style('path', path)}: {self.style(file.verdict.value, verdict)}"
        # The path stays in one piece, so that it can be clicked and copied, however long it is.
        if len(plain) <= WIDTH or not rest:
            yield coloured + plain[len(path) + 2 + len(verdict) :]
        else:
            yield f"{coloured}:"
            yield from _wrapped(f"  {rest}", 2)

    def _finding(self, file: FileCheck, finding: Finding) -> Iterator[str]:
        place = f"{finding.line}:" if finding.line else ""
        code, severity = f"{place}{printable(finding.code)}", finding.severity.value
        first, *rest = _wrapped(f"  {code} {severity} {finding_text(finding)}", 4)
        head = f"  {code} {severity}"
        yield f"  {self.style('code', code)} {self.style(severity, severity)}{first[len(head) :]}"
        yield from rest
        text = line_of(file, finding)
        if text is not None and text.strip():
            line = marked(text, columns(text, finding), WIDTH - len(_GUTTER))
            yield f"{_GUTTER}{self.style('source', line.text)}"
            if line.marks:
                yield f"{_GUTTER}{' ' * line.indent}{self.style('caret', '^' * line.marks)}"
        if finding.hint:
            for part in _wrapped(f"    hint: {printable(finding.hint)}", 4):
                yield self.style("hint", part)

    def _agreement(self, file: FileCheck) -> Iterator[str]:
        if file.agreement is None:
            return
        yield from _wrapped(f"  {agreement_text(file.agreement)}", 4)
        for disagreement in file.agreement.disagreements:
            yield from _wrapped(f"    {disagreement_text(disagreement)}", 6)
        for note in file.agreement.notes if self.verbose else ():
            yield from _wrapped(f"    note: {printable(note)}", 6)

    def _outcomes(self, file: FileCheck) -> Iterator[str]:
        met = sum(outcome.met is True for outcome in file.outcomes)
        for outcome in file.outcomes:
            if not outcome.met or self.verbose:
                yield from self._outcome(outcome)
        if met and not self.verbose:
            yield f"  {counted(met, 'expectation')} met"

    def _outcome(self, outcome: Outcome) -> Iterator[str]:
        kind, word = {True: ("pass", "met"), False: ("error", "NOT MET"), None: ("error", "NOT JUDGED")}[outcome.met]
        place = f"{_path(outcome.place)} " if outcome.place else ""
        head = f"  {place}{word}"
        first, *rest = _wrapped(f"{head}: {printable(outcome.title)}", 4)
        yield f"  {place}{self.style(kind, word)}{first[len(head) :]}" if first.startswith(head) else first
        yield from rest
        found = "why" if outcome.met is None else "found"
        said = (("wanted", outcome.wanted), (found, outcome.found), ("where", configuration_text(outcome.witness)))
        for what, text in said:
            if text:
                yield from _wrapped(f"    {what + ':':8}{printable(text)}", 12)
        if outcome.remedy and not outcome.met:
            yield f"    {_inert(renewal_text(outcome))}"  # in one piece, so that it can be pasted


def _wrapped(text: str, indent: int) -> list[str]:
    """Return a line folded to the width; what follows the first is indented, and none begins like a command."""
    lines = _folded(_inert(text), indent)
    if any(map(_COMMAND.match, lines)):
        lines = _folded(_inert(text).replace("::", r":\x3a"), indent)
    return lines or [""]


def _folded(text: str, indent: int) -> list[str]:
    return textwrap.wrap(text, WIDTH, subsequent_indent=" " * indent, break_on_hyphens=False, expand_tabs=False)


def _path(path: str) -> str:
    """Return a path as it begins a line: where it would be read as a command, it starts at the current folder."""
    shown = _inert(printable(path))
    return f"./{shown}" if _COMMAND.match(f"{shown}:") else shown  # a colon may follow


def _inert(text: str) -> str:
    """Return a text in which a runner of GitHub Actions sees no command of the old kind: "##[", anywhere in a line."""
    return text.replace("##[", r"##\x5b")
