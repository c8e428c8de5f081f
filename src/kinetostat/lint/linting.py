"""Asking all rules of one robot file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kinetostat.analysis.agreement import Agreement
from kinetostat.engines.model import Model
from kinetostat.errors import KinetostatError, RobotError
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.registry import RULES, matches
from kinetostat.lint.rule import Needs, Rule, RuleSkippedError
from kinetostat.lint.rules.kinetostatics.readers import ReadersRule
from kinetostat.lint.rules.xml import UnreadableRobot, UnusedSuppression
from kinetostat.lint.subject import Subject, subject_of_loaded
from kinetostat.lint.suppression import Suppression, suppressions

__all__ = ["Linted", "lint", "oddities", "there_is_a_model"]


@dataclass(frozen=True)
class Linted:
    """What the rules say of one file.

    Attributes:
        findings: what counts, by file and line.
        suppressed: what comments in the file take back.
        skipped: the rules that could not be asked, with the reason: these have not passed.
    """

    findings: tuple[Finding, ...]
    suppressed: tuple[Finding, ...]
    skipped: dict[str, str]


def lint(subject: Subject, rules: Sequence[Rule], agreement: Agreement | None = None) -> Linted:
    """Ask rules of a robot file.

    A file that cannot be read has an error in any case, whatever rules are asked.

    Args:
        subject: the file, as far as it can be read.
        rules: what is asked.
        agreement: what the readers say of it, which some rules turn into findings; None if they were not asked.
    """
    there, why = _reach(subject)
    found, skipped = list[Finding](), dict[str, str]()
    for each in rules:
        if each.needs > there:
            skipped[each.code] = why
            continue
        try:
            found += each.check(subject)
        except RuleSkippedError as reason:
            skipped[each.code] = str(reason)
        except KinetostatError as error:  # an analysis that cannot be asked of this robot
            skipped[each.code] = error.message
        if isinstance(each, ReadersRule):
            if agreement is None:
                skipped[each.code] = "the readers were not compared"
            else:
                found += [each.of(one, subject) for one in agreement.disagreements if each.takes(one)]
    found += _refusal(subject, found)
    kept, taken = _sifted(subject, sorted(set(found), key=lambda finding: finding.place), rules)
    return Linted(tuple(kept), tuple(taken), skipped)


def oddities(model: Model) -> tuple[Finding, ...]:
    """Return what is wrong or odd about the file of a robot that has been read: errors and warnings of static rules."""
    rules = [each for each in RULES if each.needs < Needs.MODEL]
    found = lint(subject_of_loaded(model.loaded), rules).findings
    return tuple(finding for finding in found if finding.severity is not Severity.INFO)


def there_is_a_model(subject: Subject) -> bool:
    """Return whether the robot can be read by our reader and by Pinocchio: whether the analyses can be asked."""
    return _reach(subject)[0] is Needs.MODEL


def _reach(subject: Subject) -> tuple[Needs, str]:
    """Return what can be asked of a file, and why no more."""
    if subject.document is None:
        return Needs.BYTES, "the file is not XML that can be read"
    if subject.robot is None:
        return Needs.DOCUMENT, "the robot cannot be read"
    try:
        _ = subject.model.engine
    except RobotError as error:
        return Needs.ROBOT, error.message
    return Needs.MODEL, ""


def _refusal(subject: Subject, found: Sequence[Finding]) -> list[Finding]:
    """Return why the file cannot be read, unless a rule has said it."""
    refusal = subject.refusal
    if refusal is None:
        return []
    told = any(f.severity is Severity.ERROR and f.line == (refusal.line or f.line) and not f.file for f in found)
    return [] if told else [UnreadableRobot().of(refusal)]


def _sifted(subject: Subject, found: list[Finding], rules: Sequence[Rule]) -> tuple[list[Finding], list[Finding]]:
    """Return the findings that count, and those that comments take back."""
    if subject.document is None or not subject.document.comments:
        return found, []
    comments = suppressions(subject.document, subject.elements)
    kept, taken, used = list[Finding](), list[Finding](), set[Suppression]()
    for finding in found:
        covering = [c for c in comments if not finding.file and c.covers(finding) and _may(subject, finding)]
        used.update(covering)
        (taken if covering else kept).append(finding)
    for watch in (each for each in rules if isinstance(each, UnusedSuppression)):
        for comment in comments:
            # Where only some rules are asked, a comment for others may well be needed.
            asked = all(each in rules for each in RULES if matches(each, comment.codes))
            if (comment not in used and asked) or not comment.reason:
                kept.append(watch.of(comment, used=comment in used))
    return sorted(kept, key=lambda finding: finding.place), taken


def _may(subject: Subject, finding: Finding) -> bool:
    """Return whether a comment may take a finding back: not that the robot cannot be read."""
    return subject.refusal is None or finding.severity is not Severity.ERROR
