"""Asking all rules of one robot file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kinetostat.analysis.agreement import Agreement
from kinetostat.engines.model import Model
from kinetostat.errors import KinetostatError, RobotError, StructureError, XmlError
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.registry import RULES, matches
from kinetostat.lint.rule import Needs, Rule, RuleSkippedError
from kinetostat.lint.rules.kinetostatics.readers import ReadersRule
from kinetostat.lint.rules.xml import UnreadableRobot, UnusedSuppression
from kinetostat.lint.subject import Subject, subject_of_loaded
from kinetostat.lint.suppression import Suppression, suppressions, taken_back

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
    there, refused = _reach(subject)
    why = refused.message if refused is not None else ""
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
    if there is Needs.ROBOT and refused is not None:
        found.append(UnreadableRobot().of(refused))
    kept, taken = _sifted(subject, sorted(dict.fromkeys(found), key=lambda finding: finding.place), rules)
    return Linted(tuple(kept), tuple(taken), skipped)


def oddities(model: Model) -> tuple[Finding, ...]:
    """Return what is wrong or odd about the file of a robot that has been read: errors and warnings of static rules."""
    rules = [each for each in RULES if each.needs < Needs.MODEL]
    found = lint(subject_of_loaded(model.loaded), rules).findings
    return tuple(finding for finding in found if finding.severity is not Severity.INFO)


def there_is_a_model(subject: Subject) -> bool:
    """Return whether the robot can be read by our reader and by Pinocchio: whether the analyses can be asked."""
    return _reach(subject)[0] is Needs.MODEL


def _reach(subject: Subject) -> tuple[Needs, KinetostatError | None]:
    """Return what can be asked of a file, and why no more."""
    if subject.document is None:
        return Needs.BYTES, XmlError("the file is not XML that can be read")
    if subject.robot is None:
        return Needs.DOCUMENT, StructureError("the robot cannot be read")
    try:
        _ = subject.model.engine
    except RobotError as error:
        return Needs.ROBOT, error
    return Needs.MODEL, None


def _refusal(subject: Subject, found: Sequence[Finding]) -> list[Finding]:
    """Return why the file cannot be read, unless a rule has said it."""
    refusal = subject.refusal
    if refusal is None:
        return []
    file = subject.file_of(refusal)
    told = any(f.severity is Severity.ERROR and f.line == (refusal.line or f.line) and f.file == file for f in found)
    return [] if told else [UnreadableRobot().of(refusal, file)]


def _sifted(subject: Subject, found: list[Finding], rules: Sequence[Rule]) -> tuple[list[Finding], list[Finding]]:
    """Return the findings that count, and those that comments take back: each file's comments its own findings."""
    comments, taken, used = list[Suppression](), set[int](), set[Suppression]()
    for document, file in ((subject.document, ""), (subject.srdf, subject.srdf.file if subject.srdf else "")):
        mine = suppressions(document, file) if document is not None else ()
        if mine:
            asked = [i for i, each in enumerate(found) if each.file == file and _may(subject, each)]
            back, needed = taken_back(mine, [found[i] for i in asked])
            comments += mine
            taken.update(asked[i] for i in back)
            used |= needed
    kept = [finding for i, finding in enumerate(found) if i not in taken]
    kept += _unused(comments, used, rules)
    kept.sort(key=lambda finding: finding.place)
    return kept, [found[i] for i in sorted(taken)]


def _unused(comments: Sequence[Suppression], used: set[Suppression], rules: Sequence[Rule]) -> list[Finding]:
    """Return what is to be said of comments that take nothing back, or give no reason."""
    chosen = set(rules)
    # Where only some rules are asked, a comment for others may well be needed.
    unasked = [each for each in RULES if each not in chosen]
    return [
        watch.of(comment, used=comment in used)
        for watch in rules
        if isinstance(watch, UnusedSuppression)
        for comment in comments
        if not comment.reason or (comment not in used and not any(matches(each, comment.codes) for each in unasked))
    ]


def _may(subject: Subject, finding: Finding) -> bool:
    """Return whether a comment may take a finding back: not that the robot, or the SRDF, cannot be read."""
    refused = subject.srdf_refusal if finding.file else subject.refusal
    if finding.severity is Severity.ERROR and refused is not None:
        return False
    return finding.code != UnreadableRobot.code
