"""Checking one robot: rules, readers' agreement, policy."""

from __future__ import annotations

import re
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from kinetostat.analysis.agreement import Agreement
from kinetostat.analysis.profile.anatomy import ChosenChain
from kinetostat.errors import KinetostatError
from kinetostat.gate.result import FileCheck, Verdict
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.subject import Subject, subject_of
from kinetostat.policy.outcome import Outcome
from kinetostat.urdf.document import decoded

__all__ = ["Task", "check_robot", "check_subject", "judged", "subject_asked"]

_LONGEST_LINE = 20_000  # characters of a line that are kept to be shown


@dataclass(frozen=True)
class Task:
    """What is to be checked of one robot, as it travels to the process that does it.

    Attributes:
        name: the robot, as it was asked for.
        select, ignore: rules, see `lint.registry.chosen`.
        samples: configurations at which the readers are compared; 0: not at all.
        seed: of these.
        expectations: what the policy expects of it.
        folder: of the policy: paths in it are relative to this.
        chains: the limbs that the settings ask for by name: nothing of `check`, but of the report.
        srdf, package_dirs, xacro_arguments, max_bytes: see `engines.model.load`.
    """

    name: str
    select: tuple[str, ...] = ()
    ignore: tuple[str, ...] = ()
    samples: int = 20
    seed: int = 0
    expectations: tuple[Any, ...] = ()
    folder: Path = Path()
    srdf: Path | None = None
    package_dirs: tuple[Path, ...] = ()
    xacro_arguments: Mapping[str, str] = field(default_factory=dict)
    max_bytes: int = 64 * 1024 * 1024
    chains: tuple[ChosenChain, ...] = ()


def check_robot(task: Task) -> FileCheck:
    """Return what is found out about one robot; its verdict is given by `judged`."""
    start = time.perf_counter()
    found = check_subject(subject_asked(task), task)
    return replace(found, seconds=time.perf_counter() - start)


def subject_asked(task: Task) -> Subject:
    """Return the robot of a task, as far as it can be read."""
    return subject_of(
        task.name,
        srdf=task.srdf,
        package_dirs=task.package_dirs,
        xacro_arguments=task.xacro_arguments,
        max_bytes=task.max_bytes,
    )


def check_subject(subject: Subject, task: Task) -> FileCheck:
    """Return what is found out about a robot that has been read for a task, as `check_robot`; it is not timed."""
    from kinetostat.lint.linting import lint, there_is_a_model
    from kinetostat.lint.registry import chosen

    rules = chosen(task.select, task.ignore)
    agreement, skipped = None, dict[str, str]()
    if task.samples and there_is_a_model(subject):
        agreement, skipped = _agreement(subject, task)
    linted = lint(subject, rules, agreement)
    findings = (*linted.findings, *map(_not_compared, skipped.values()))
    return FileCheck(
        task.name,
        Verdict.PASS,
        findings,
        agreement,
        _outcomes(subject, task),
        len(linted.suppressed),
        0,
        {**linted.skipped, **skipped},
        "",
        subject.expanded,
        _shown_lines(subject, findings),
        readable=subject.robot is not None,
    )


def judged(file: FileCheck, fail_on: Severity) -> FileCheck:
    """Return the result with its verdict.

    A finding as bad as `fail_on`, or an unmet expectation, fails it; so do engines that disagree, whatever rules are
    asked: nothing that is said of such a robot can be relied on.
    """
    if file.verdict is Verdict.CRASHED:
        return file
    bad = any(finding.severity.rank <= fail_on.rank for finding in file.findings)
    unmet = any(not outcome.met for outcome in file.outcomes)  # not judged is not met
    apart = file.agreement is not None and not file.agreement.engines_agree
    return replace(file, verdict=Verdict.FAIL if bad or unmet or apart else Verdict.PASS)


def _agreement(subject: Subject, task: Task) -> tuple[Agreement | None, dict[str, str]]:
    """Return how far the readers agree; or why that cannot be told."""
    from kinetostat.analysis.agreement import agreement

    try:
        return agreement(subject.model, samples=task.samples, seed=task.seed), {}
    except KinetostatError as error:
        return None, {"crosscheck": error.message}


def _not_compared(reason: str) -> Finding:
    """Return the finding for readers that could not be compared: they have not agreed, whatever rules are asked."""
    from kinetostat.lint.rules.kinetostatics import EnginesDisagree

    return EnginesDisagree().finding(0, f"the readers could not be compared: {reason}")


def _outcomes(subject: Subject, task: Task) -> tuple[Outcome, ...]:
    from kinetostat.lint.linting import there_is_a_model
    from kinetostat.policy.judging import judge, unjudged

    if not task.expectations:
        return ()
    if not there_is_a_model(subject):
        return unjudged(task.expectations, "the robot cannot be read")
    return judge(subject.model, task.expectations, folder=task.folder)


def _shown_lines(subject: Subject, findings: Sequence[Finding]) -> dict[tuple[str, int], str]:
    """Return the text of the lines that findings point at."""
    wanted = {(finding.file, finding.line) for finding in findings if finding.line > 0}
    texts = dict[str, list[str]]()
    for file in {file for file, _ in wanted}:
        # Not str.splitlines, which also splits at form feeds and the like: lines are those of the parser.
        texts[file] = re.split(r"\r\n|\r|\n", decoded(_bytes_of(subject, file), file))
    return {
        (file, line): texts[file][line - 1]
        for file, line in sorted(wanted)
        if line <= len(texts[file]) and len(texts[file][line - 1]) <= _LONGEST_LINE
    }


def _bytes_of(subject: Subject, file: str) -> bytes:
    from kinetostat.urdf.files import read_file

    if not file:
        return subject.source.data if subject.source is not None else b""
    try:
        return read_file(Path(file), file)
    except KinetostatError:
        return b""
