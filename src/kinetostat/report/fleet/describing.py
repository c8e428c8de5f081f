"""From what is known of a robot to its part of the report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Literal

import msgspec

from kinetostat.analysis.agreement import Agreement
from kinetostat.analysis.crosscheck import Certificate, combined
from kinetostat.analysis.profile.result import RobotProfile
from kinetostat.analysis.summary import Summary
from kinetostat.gate.result import FileCheck
from kinetostat.lint.finding import Finding
from kinetostat.policy.outcome import Outcome
from kinetostat.report.check.words import counted, disagreement_text, encodable, skipped_by_reason
from kinetostat.report.fleet.chain_rows import chain_row
from kinetostat.report.fleet.document import (
    Agreed,
    CertificateRow,
    ExpectationRow,
    FindingRow,
    LeftRow,
    RobotDocument,
)
from kinetostat.report.fleet.joint_rows import joint_rows, unstated_efforts
from kinetostat.report.fleet.numbers import finite

__all__ = ["robot_document"]


def robot_document(
    id: str,  # noqa: A002
    check: FileCheck,
    profile: RobotProfile | None,
    *,
    status: Literal["done", "unreadable", "crashed"],
    reason: str,
    payload: float | None,
) -> RobotDocument:
    """Return what the report says of a robot: SI units and radians, null for what is no finite number.

    Texts are such that UTF-8 can hold them: names of files that are not UTF-8 have escapes.

    Args:
        id: its place in the page; chains get `id-1`, `id-2`, ...
        check: what `check` says of the file.
        profile: what is known of the robot; None where it could not be read, or its computation failed.
        status: how far it came.
        reason: why not further; else empty.
        payload: what every chain is to carry that the settings say nothing of, kg.
    """
    found = RobotDocument(
        id=id,
        path=check.path,
        **(_NOTHING if profile is None else _of_profile(id, profile, payload)),
        status=status,
        reason=reason,
        verdict=check.verdict.value,
        findings=tuple(_finding(found, check.path) for found in check.findings),
        expectations=tuple(map(_expectation, check.outcomes)),
        agreement=None if check.agreement is None else _agreed(check.agreement),
        left=(*_left_of_robot(profile), *_left_of_check(check)),
    )
    return msgspec.convert(_encodable(msgspec.to_builtins(found)), RobotDocument)


_NOTHING: Mapping[str, Any] = {
    "name": "",
    "sha256": "",
    "links": 0,
    "degrees_of_freedom": 0,
    "mass": None,
    "reach": None,
    "tips": 0,
    "chains": (),
    "joints": (),
    "certificate": None,
}


def _of_profile(id: str, profile: RobotProfile, payload: float | None) -> dict[str, Any]:  # noqa: A002
    """Return what only a robot that was read has."""
    robot = profile.model.robot
    chains = enumerate(profile.limbs, start=1)
    return {
        "name": robot.name,
        "sha256": profile.model.loaded.source.sha256,
        "links": len(robot.links),
        "degrees_of_freedom": robot.nv,
        "mass": _mass(profile.summary),
        "reach": finite(profile.summary.reach),
        "tips": len(robot.tips),
        "chains": tuple(chain_row(f"{id}-{i}", limb, profile, payload) for i, limb in chains),
        "joints": joint_rows(profile),
        "certificate": _certificate(profile.certificates),
    }


def _mass(summary: Summary) -> float | None:
    """Return the mass of all links; None where the file states none at all."""
    if all(link.inertial is None for link in summary.robot.links):
        return None
    return finite(summary.base_mass + summary.moving_mass)


# --- what the readers say ----------------------------------------------------------------------------------------


def _certificate(certificates: Mapping[str, Certificate]) -> CertificateRow | None:
    """Return the certificate of all answers: how many numbers, and the answer nearest to its tolerance."""
    if not certificates:
        return None
    together = combined(tuple(certificates.values()))
    agree = [one.agree for one in certificates.values()]
    return CertificateRow(
        engines=together.engines,
        numbers=together.numbers,
        answers=len(certificates),
        max_difference=finite(together.max_difference),
        tolerance=finite(together.tolerance),
        answer=next(answer for answer, one in certificates.items() if one == together),
        agree=None if all(one is None for one in agree) else False not in agree,
    )


def _agreed(found: Agreement) -> Agreed:
    return Agreed(
        readers=found.readers,
        frames=found.frames,
        configurations=found.configurations,
        max_difference=finite(found.max_difference),
        tolerance=found.tolerance,
        agree=found.agree,
        engines_agree=found.engines_agree,
        disagreements=tuple(map(disagreement_text, found.disagreements)),
        notes=found.notes,
    )


# --- what `check` says -------------------------------------------------------------------------------------------


def _finding(found: Finding, robot: str) -> FindingRow:
    """Return a finding of a robot; where a library keeps its files, is nobody's business, and differs."""
    return FindingRow(
        code=found.code,
        name=found.name,
        severity=found.severity.value,
        message=found.message,
        file=Path(found.file).name if Path(found.file).is_absolute() and not Path(robot).is_absolute() else found.file,
        line=found.line,
        element=found.element,
        hint=found.hint,
    )


def _expectation(found: Outcome) -> ExpectationRow:
    return ExpectationRow(title=found.title, met=found.met, wanted=found.wanted, found=found.found, place=found.place)


# --- what is not there, and why ----------------------------------------------------------------------------------


def _left_of_robot(profile: RobotProfile | None) -> Iterator[LeftRow]:
    """Yield what the profile leaves out, and the reasons of nulls."""
    if profile is None:
        return
    yield from (LeftRow(what=left.what, why=left.why, place=left.place) for left in profile.left)
    if _mass(profile.summary) is None:
        yield LeftRow(what="mass", why="no link of the file states one")
    yield from unstated_efforts(profile.model.robot)
    if profile.worst is not None:
        yield from (
            LeftRow(what="motion in the worst gravity torques", why=warning) for warning in profile.worst.warnings
        )


def _left_of_check(check: FileCheck) -> Iterator[LeftRow]:
    """Yield the rules that were not asked, findings that are taken back, readers that were not compared."""
    for reason, rules in skipped_by_reason(check).items():
        yield LeftRow(what=f"rules {rules}", why=reason)
    if check.suppressed:
        yield LeftRow(what=counted(check.suppressed, "finding"), why="comments in the file take them back")
    if check.known:
        yield LeftRow(what=counted(check.known, "finding"), why="known: they are in the baseline")
    if check.expanded and any(finding.line for finding in check.findings):
        yield LeftRow(what="lines of the xacro file", why="findings are counted in its expansion")
    if check.agreement is None and check.readable:
        yield LeftRow(what="agreement of the readers", why="they were not compared")


def _encodable(value: Any) -> Any:
    """Return a value of lists and dictionaries with all texts such that UTF-8 can hold them."""
    if isinstance(value, str):
        return encodable(value)
    if isinstance(value, dict):
        return {encodable(key): _encodable(part) for key, part in value.items()}
    return [_encodable(part) for part in value] if isinstance(value, (list, tuple)) else value
