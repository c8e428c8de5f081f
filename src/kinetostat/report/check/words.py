"""What all formats say in the same words: counts, places, configurations, how far the readers agree."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from kinetostat.analysis.agreement import Agreement, Disagreement
from kinetostat.errors import cut, printable
from kinetostat.gate.result import CheckReport, FileCheck, Verdict
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.registry import RULES
from kinetostat.policy.outcome import Outcome
from kinetostat.report.fleet.document import Agreed, FindingRow

__all__ = [
    "Totals",
    "agreement_text",
    "configuration_text",
    "counted",
    "disagreement_text",
    "encodable",
    "finding_text",
    "inert_json",
    "listed",
    "outcome_text",
    "path_from",
    "reasons",
    "skipped_by_reason",
    "totals",
    "totals_text",
]

_MOST_JOINTS = 12  # of a configuration in words
_MOST_CODES = 8  # of rules that were not asked


@dataclass(frozen=True)
class Totals:
    """How often there is what, in all files; `unmet` holds what could not be judged, too."""

    files: int
    passed: int
    failed: int
    crashed: int
    errors: int
    warnings: int
    infos: int
    suppressed: int
    known: int
    met: int
    unmet: int
    unjudged: int


def totals(report: CheckReport) -> Totals:
    """Return the counts of a report."""
    files = report.files
    outcomes = [outcome for file in files for outcome in file.outcomes]
    verdicts = [file.verdict for file in files]
    severities = [finding.severity for file in files for finding in file.findings]
    return Totals(
        files=len(files),
        passed=verdicts.count(Verdict.PASS),
        failed=verdicts.count(Verdict.FAIL),
        crashed=verdicts.count(Verdict.CRASHED),
        errors=severities.count(Severity.ERROR),
        warnings=severities.count(Severity.WARNING),
        infos=severities.count(Severity.INFO),
        suppressed=sum(file.suppressed for file in files),
        known=sum(file.known for file in files),
        met=sum(outcome.met is True for outcome in outcomes),
        unmet=sum(outcome.met is not True for outcome in outcomes),
        unjudged=sum(outcome.met is None for outcome in outcomes),
    )


def totals_text(report: CheckReport) -> str:
    """Return the counts of a report in a line."""
    t = totals(report)
    verdicts = ((t.passed, "passed"), (t.failed, "failed"), (t.crashed, "crashed"))
    parts = [
        f"{counted(t.files, 'file')}: " + (listed(f"{n} {what}" for n, what in verdicts if n) or "nothing checked")
    ]
    parts.append(", ".join((counted(t.errors, "error"), counted(t.warnings, "warning"), f"{t.infos} info")))
    back = ((t.suppressed, "suppressed"), (t.known, "known"))
    parts.append(listed(f"{n} {what}" for n, what in back if n))
    if t.met or t.unmet:
        parts.append(f"expectations: {t.met} met, {t.unmet} not met" + _unjudged(t.unjudged))
    return "; ".join(part for part in parts if part)


def _unjudged(count: int) -> str:
    return f" ({count} could not be judged)" if count else ""


def counted(count: int, what: str) -> str:
    """Return a count with its noun."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def listed(words: Iterable[str]) -> str:
    """Return words with commas between."""
    return ", ".join(words)


def reasons(file: FileCheck) -> str:
    """Return in words what there is about a file: its findings by severity, its expectations; empty if nothing."""
    if file.verdict is Verdict.CRASHED:
        return printable(file.reason) or "no reason is known"
    unmet = sum(outcome.met is False for outcome in file.outcomes)
    unjudged = sum(outcome.met is None for outcome in file.outcomes)
    parts = [counted(n, str(s)) if s is not Severity.INFO else f"{n} info" for s in Severity if (n := file.count(s))]
    if file.agreement is not None and not file.agreement.agree:
        parts.append("readers disagree")
    if unmet:
        parts.append(f"{counted(unmet, 'expectation')} not met")
    if unjudged:
        parts.append(f"{counted(unjudged, 'expectation')} not judged")
    parts += [f"{n} {what}" for n, what in ((file.suppressed, "suppressed"), (file.known, "known")) if n]
    return ", ".join(parts)


def finding_text(finding: Finding | FindingRow) -> str:
    """Return a finding in a line: the element, and what is wrong with it."""
    return ": ".join(printable(part) for part in (finding.element, finding.message) if part)


def configuration_text(configuration: Mapping[str, float], digits: int = 6) -> str:
    """Return a configuration in words: positions that are not zero, rad and m; empty if there is none."""
    if not configuration:
        return ""
    moved = [f"{cut(name)} {value:.{digits}g}" for name, value in configuration.items() if value != 0]
    more = f", and {len(moved) - _MOST_JOINTS} more" if len(moved) > _MOST_JOINTS else ""
    return "at " + ", ".join(moved[:_MOST_JOINTS]) + more if moved else "at zero"


def agreement_text(agreement: Agreement | Agreed) -> str:
    """Return in words how far the readers agree."""
    compared = f"{counted(agreement.frames, 'frame')} x {counted(agreement.configurations, 'configuration')}"
    by = " and ".join(filter(None, (", ".join(agreement.readers[:-1]), *agreement.readers[-1:])))
    largest = "not known" if agreement.max_difference is None else f"{agreement.max_difference:.1e}"
    apart = f"largest difference {largest}, tolerance {agreement.tolerance:.1e}"
    return printable(f"{by} {'agree' if agreement.agree else 'DISAGREE'}: {compared}, {apart}")


def disagreement_text(disagreement: Disagreement) -> str:
    """Return in words on what readers differ, and which is the odd one out."""
    d = disagreement
    who = f"{d.odd_one} is the odd one out" if d.odd_one else f"{' and '.join(d.readers)} differ"
    unit = f" {d.unit}" if d.unit else ""
    frame = f" of {cut(d.frame)}" if d.frame else ""
    size = f"{d.quantity}{frame} differs by {d.size:.3g}{unit}, tolerance {d.tolerance:.1e}{unit}"
    return printable(" ".join(filter(None, (f"{who}: {size}", configuration_text(d.configuration)))))


def outcome_text(outcome: Outcome) -> str:
    """Return an expectation that is not met in a line: what was wanted, what is, and the witness."""
    if outcome.met is None:
        return printable(f"{outcome.title}: could not be judged: {outcome.found}")
    told = f"{outcome.title}: wanted {outcome.wanted}, found {outcome.found}"
    return printable(" ".join(filter(None, (told, configuration_text(outcome.witness)))))


def renewal_text(outcome: Outcome) -> str:
    """Return what to do if it is meant to be otherwise now; empty if there is no command for that."""
    return f"if that is meant: {printable(outcome.remedy)}" if outcome.remedy else ""


def skipped_by_reason(file: FileCheck, *, all_codes: bool = True) -> dict[str, str]:
    """Return for each reason, which rules were not asked for it."""
    found: dict[str, list[str]] = {}
    for code, reason in file.skipped.items():
        found.setdefault(printable(reason), []).append(printable(code))
    return {
        reason: _runs(codes) if all_codes or len(codes) <= _MOST_CODES else counted(len(codes), "rule")
        for reason, codes in found.items()
    }


def _runs(codes: list[str]) -> str:
    """Return codes in a line; three or more that follow each other in the registry as the first to the last."""
    order = {rule.code: i for i, rule in enumerate(RULES)}
    runs: list[list[str]] = []
    for code in codes:
        last = runs[-1][-1] if runs else ""
        follows = code in order and order.get(last) == order[code] - 1
        if follows:
            runs[-1].append(code)
        else:
            runs.append([code])
    parts = [[f"{run[0]} to {run[-1]}"] if len(run) > 2 else run for run in runs]
    return ", ".join(part for run in parts for part in run)


def encodable(text: str) -> str:
    """Return the text with lone surrogates (of file names that are not UTF-8) as escapes."""
    return text.encode("utf-8", "backslashreplace").decode()


def inert_json(text: str) -> str:
    """Return JSON text in which what is not printable (within its strings: elsewhere there is none) is escaped.

    So is the bracket of "##[": a runner of GitHub Actions reads a command from there on, wherever in a line it stands.
    """
    import json

    shown = "\n".join(
        line if line.isprintable() else "".join(c if c.isprintable() else json.dumps(c)[1:-1] for c in line)
        for line in text.split("\n")
    )
    return shown.replace("##[", "##\\u005b")


def path_from(path: str, base: Path | None) -> str:
    """Return a path with forward slashes, relative to the repository if it is in it, else absolute.

    Args:
        path: as it was asked for; a name such as example:panda stays.
        base: the folder that relative paths start from, in the repository or its root; None: they stay relative.
    """
    if not path or path.startswith(("example:", "textbook:")):
        return path
    if base is None:
        return os.path.normpath(path).replace(os.sep, "/")
    base = base.absolute()
    root, whole = _repository(base), Path(os.path.normpath(base / path))
    if not whole.is_relative_to(root):
        whole = _resolved(whole.parent) / whole.name  # a link among the folders above may lead there
    return (whole.relative_to(root) if whole.is_relative_to(root) else whole).as_posix()


@lru_cache(maxsize=64)
def _repository(folder: Path) -> Path:
    """Return the root of the repository that a folder is in, links resolved; the folder itself if it is in none."""
    real = Path(os.path.realpath(folder))
    # In a worktree, and in a submodule, .git is a file.
    return next((above for above in (real, *real.parents) if os.path.lexists(above / ".git")), real)


@lru_cache(maxsize=1024)
def _resolved(folder: Path) -> Path:
    return Path(os.path.realpath(folder))
