"""What is wrong with a file as one flat list: findings, expectations that are not met, a crash."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from kinetostat.errors import printable
from kinetostat.gate.result import FileCheck, Verdict
from kinetostat.lint.finding import Finding, Severity
from kinetostat.policy.outcome import Outcome
from kinetostat.report.check.source import columns, line_of
from kinetostat.report.check.words import finding_text, outcome_text, path_from, renewal_text

__all__ = ["CRASHED", "POLICY", "Problem", "problems"]

POLICY = "POLICY"
CRASHED = "CRASHED"


@dataclass(frozen=True)
class Problem:
    """Something to tell about a file, where it can be pointed at.

    Attributes:
        code: of the rule, or POLICY, or CRASHED.
        name: of the rule, or the kind of expectation.
        severity: error, warning or info.
        message: one printable line.
        hint: what to do; may be empty.
        path: the file, with forward slashes.
        line: from 1; 0 if it is about no line of the file as it stands.
        columns: of the line, from 0, the end exclusive; None if they are not known.
        place: where an expectation is written, `kinetostat.toml:12`; else empty.
        identity: what tells it from others in any version of the file: neither its line nor its numbers.
    """

    code: str
    name: str
    severity: Severity
    message: str
    hint: str
    path: str
    line: int = 0
    columns: tuple[int, int] | None = None
    place: str = ""
    identity: tuple[str, ...] = ()

    @property
    def title(self) -> str:
        """Its code and name."""
        return printable(" ".join(filter(None, (self.code, self.name))))


def problems(file: FileCheck, base: Path | None = None) -> Iterator[Problem]:
    """Yield what is wrong with a file.

    Args:
        file: its result.
        base: the folder that relative paths start from; paths are told relative to the repository that it is in.
    """
    if file.verdict is Verdict.CRASHED:
        yield _crash(file, path_from(file.path, base))
    seen = Counter[tuple[str, ...]]()
    for finding in file.findings:
        path = path_from(finding.file or file.path, base)
        mark = (finding.code, path, finding.element, finding.attribute)
        yield _finding(file, finding, path, (*mark, str(seen[mark])))
        seen[mark] += 1
    for outcome in file.outcomes:
        if not outcome.met:
            mark = (POLICY, path_from(file.path, base), outcome.kind, outcome.title)
            yield _outcome(outcome, mark[1], _place(outcome.place, base), (*mark, str(seen[mark])))
            seen[mark] += 1


def _crash(file: FileCheck, path: str) -> Problem:
    reason = printable(file.reason) or "no reason is known"
    message = f"the check crashed, nothing is known about this robot: {reason}"
    return Problem(CRASHED, "crashed", Severity.ERROR, message, "", path, identity=(CRASHED, path))


def _finding(file: FileCheck, finding: Finding, path: str, identity: tuple[str, ...]) -> Problem:
    moved = file.expanded and not finding.file  # a line of the expanded text, which is in no file
    text = None if moved else line_of(file, finding)
    return Problem(
        finding.code,
        finding.name,
        finding.severity,
        finding_text(finding),
        printable(finding.hint),
        path,
        0 if moved else max(finding.line, 0),
        None if text is None else columns(text, finding),
        identity=identity,
    )


def _place(place: str, base: Path | None) -> str:
    """Return where an expectation is written, relative to the repository."""
    path, colon, line = place.rpartition(":")
    if path and line.isascii() and line.isdigit():
        return f"{path_from(path, base)}{colon}{line}"
    return path_from(place, base)


def _outcome(outcome: Outcome, path: str, place: str, identity: tuple[str, ...]) -> Problem:
    kind = printable(outcome.kind)
    told, hint = outcome_text(outcome), renewal_text(outcome)
    return Problem(POLICY, kind, Severity.ERROR, told, hint, path, place=place, identity=identity)
