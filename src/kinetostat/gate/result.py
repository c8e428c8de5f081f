"""What the gate says: of one file, and of all of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

from kinetostat.analysis.agreement import Agreement
from kinetostat.lint.finding import Finding, Severity
from kinetostat.policy.outcome import Outcome

__all__ = ["CheckReport", "FileCheck", "Verdict"]


class Verdict(StrEnum):
    """How a file came through. A crash is not a pass."""

    PASS = "pass"  # noqa: S105
    FAIL = "fail"
    CRASHED = "crashed"


@dataclass(frozen=True)
class FileCheck:
    """What was found out about one robot file.

    Attributes:
        path: its name, as it was asked for.
        verdict: pass, fail or crashed.
        findings: what the rules found, by file and line; new ones only, where there is a baseline.
        agreement: what the readers say; None where the robot cannot be read, or where it was left out.
        outcomes: the expectations of the policy, judged.
        suppressed: how many findings comments in the file took back.
        known: how many findings are in the baseline.
        skipped: rules that could not be asked, with the reason.
        reason: why it crashed; else empty.
        expanded: whether lines are those of an expanded xacro file, not of the file itself.
        lines: the text of the lines that findings point at, by file (empty for the robot's own) and line.
        seconds: how long it took.
        readable: whether the robot could be read.
    """

    path: str
    verdict: Verdict
    findings: tuple[Finding, ...] = ()
    agreement: Agreement | None = None
    outcomes: tuple[Outcome, ...] = ()
    suppressed: int = 0
    known: int = 0
    skipped: dict[str, str] = field(default_factory=dict)
    reason: str = ""
    expanded: bool = False
    lines: dict[tuple[str, int], str] = field(default_factory=dict)
    seconds: float = 0.0
    readable: bool = True

    def count(self, severity: Severity) -> int:
        """Return how many findings are of a severity."""
        return sum(finding.severity is severity for finding in self.findings)


@dataclass(frozen=True)
class CheckReport:
    """What was found out about all files.

    Attributes:
        files: in the order in which they were asked for.
        fail_on: findings of this severity, or worse, fail a file.
    """

    files: tuple[FileCheck, ...]
    fail_on: Severity = Severity.ERROR

    @property
    def passed(self) -> bool:
        """Whether every file passed."""
        return all(file.verdict is Verdict.PASS for file in self.files)
