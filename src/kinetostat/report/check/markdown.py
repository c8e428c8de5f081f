"""The report as GitHub's Markdown, for the summary of a job or a comment on a pull request."""

from __future__ import annotations

import re
from collections.abc import Iterator

from kinetostat.errors import printable
from kinetostat.gate.result import CheckReport, FileCheck, Verdict
from kinetostat.lint.finding import Finding, Severity
from kinetostat.policy.outcome import Outcome
from kinetostat.report.check.words import (
    agreement_text,
    configuration_text,
    counted,
    disagreement_text,
    encodable,
    finding_text,
    reasons,
    skipped_by_reason,
    totals_text,
)
from kinetostat.report.fleet.document import FindingRow

__all__ = ["LONGEST", "code", "escaped", "finding_line", "fitting", "left_out", "render"]

LONGEST = 60_000  # characters; GitHub refuses comments of more than 65,536
_VERDICTS = {Verdict.PASS: "passed", Verdict.FAIL: "**failed**", Verdict.CRASHED: "**crashed**"}
_WORST_FIRST = (Verdict.CRASHED, Verdict.FAIL, Verdict.PASS)
_LONGEST_DETAILS = 10_000  # of one file
# All but words, and punctuation that is no markup where it stands: "a_b", "a: b", "1.5".
_MARKUP = re.compile(r"[^\w .,;:()/%=+'-]|(?<![^\W_])_|_(?![^\W_])|:(?! |$)|(?<=www)\.", re.IGNORECASE)


def render(report: CheckReport, *, longest: int = LONGEST) -> str:
    """Return the report as Markdown: totals, a table of files (the worst first), what was found, folded.

    Args:
        report: what was found out.
        longest: cut it to that many characters; what is left out is counted.
    """
    headline = "passed" if report.passed else "failed"
    head = f"### kinetostat check {headline}\n\n{escaped(totals_text(report))}\n"
    files = sorted(report.files, key=lambda file: _WORST_FIRST.index(file.verdict))
    rows = [_row(file) for file in files]
    blocks = [block for file in files if (block := _details(file))]
    room = longest - len(head) - 500  # for what is said of what is left out
    shown_rows = fitting(rows, room // 2)
    shown_blocks = fitting(blocks, room - sum(map(len, shown_rows)))
    parts = [head]
    if rows:
        parts.append("\n| file | verdict | findings |\n| --- | --- | --- |\n" + "".join(shown_rows))
        parts.append(left_out(len(rows) - len(shown_rows), "file"))
    parts += [*shown_blocks, left_out(len(blocks) - len(shown_blocks), "file", " with findings")]
    return encodable("".join(parts))


def fitting(parts: list[str], room: int) -> list[str]:
    """Return the first parts, as many as there is room for."""
    kept = list[str]()
    for part in parts:
        room -= len(part)
        if room < 0:
            break
        kept.append(part)
    return kept


def left_out(count: int, what: str, more: str = "") -> str:
    """Return how much there is no room for; empty if there is nothing."""
    return f"\n... and {counted(count, what)}{more}, for which there is no room here.\n" if count else ""


def _row(file: FileCheck) -> str:
    return f"| {code(file.path)} | {_VERDICTS[file.verdict]} | {escaped(reasons(file)) or 'none'} |\n"


def _details(file: FileCheck) -> str:
    """Return what was found about a file, folded; empty if there is nothing to tell."""
    items = [f"- {item}\n" for item in _items(file)]
    if not items:
        return ""
    kept = fitting(items, _LONGEST_DETAILS)
    left = left_out(len(items) - len(kept), "line")
    opened = "" if file.verdict is Verdict.PASS else " open"
    summary = f"{code(file.path)}: {escaped(reasons(file))}"
    return f"\n<details{opened}><summary>{summary}</summary>\n\n{''.join(kept)}{left}\n</details>\n"


def _items(file: FileCheck) -> Iterator[str]:
    """Yield what was found, a line each; info is only counted."""
    if file.verdict is Verdict.CRASHED:
        yield f"**crashed**: {escaped(file.reason) or 'no reason is known'}"
    for finding in file.findings:
        if finding.severity is not Severity.INFO:
            yield finding_line(finding)
    if file.agreement is not None and not file.agreement.agree:
        yield f"**cross-check**: {escaped(agreement_text(file.agreement))}"
        for disagreement in file.agreement.disagreements:
            yield escaped(disagreement_text(disagreement))
    for outcome in file.outcomes:
        if not outcome.met:
            yield _expectation(outcome)
    for reason, codes in skipped_by_reason(file, all_codes=False).items():
        yield f"not asked: {escaped(codes)} ({escaped(reason)})"


def finding_line(finding: Finding | FindingRow) -> str:
    """Return a finding in a line."""
    place = f" {code(finding.file)}" if finding.file else ""
    place += f" line {finding.line}" if finding.line else ""
    hint = f" *{escaped(finding.hint)}*" if finding.hint else ""
    return f"**{finding.severity}** {escaped(finding.code)}{place}: {escaped(finding_text(finding))}{hint}"


def _expectation(outcome: Outcome) -> str:
    head = "**not met**" if outcome.met is False else "**not judged**"
    place = f" {code(outcome.place)}" if outcome.place else ""
    told = f"{head}{place}: {escaped(outcome.title)}"
    if outcome.met is None:
        return f"{told}: {escaped(outcome.found)}"
    witness = escaped(configuration_text(outcome.witness))
    renewal = f"; if that is meant: {code(outcome.remedy)}" if outcome.remedy else ""
    return (
        f"{told}: wanted {escaped(outcome.wanted)}, found **{escaped(outcome.found)}**"
        + (witness and f" {witness}")
        + renewal
    )


def code(text: str) -> str:
    """Return an untrusted text in the type of code, where it is no markup and mentions nobody."""
    return f"<code>{escaped(text)}</code>"


def escaped(text: str) -> str:
    """Return an untrusted text such that it is no markup, no link, no mention and no reference to an issue.

    Entities are decoded before GitHub looks for mentions and references; an empty comment keeps them apart.
    """
    shown = _MARKUP.sub(lambda found: "".join(f"&#{ord(c)};" for c in found[0]), printable(text))
    return shown.replace("&#64;", "&#64;<!-- -->").replace("&#35;", "&#35;<!-- -->")
