"""The report for programs: the envelope of all commands, `result` with `files` and `summary`."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from kinetostat.analysis.agreement import Agreement
from kinetostat.gate.result import CheckReport, FileCheck
from kinetostat.lint.finding import Finding
from kinetostat.policy.outcome import Outcome
from kinetostat.report import json as report_json
from kinetostat.report.check.words import encodable, inert_json, totals
from kinetostat.report.json import Json, number

__all__ = ["check_result", "render"]


def render(report: CheckReport, *, warnings: tuple[str, ...] = ()) -> str:
    """Return the report as JSON; names stand in it as they are in the files.

    Args:
        report: what was found out.
        warnings: of the command, as in every JSON object.
    """
    text = report_json.render(report_json.envelope("check", check_result(report), warnings=warnings))
    return inert_json(text)


def check_result(report: CheckReport) -> Json:
    """Return the result object of `check`."""
    result: Json = {
        "passed": report.passed,
        "fail_on": report.fail_on.value,
        "summary": asdict(totals(report)),
        "files": [_file(file) for file in report.files],
    }
    encoded: Json = _encodable(result)
    return encoded


def _file(file: FileCheck) -> Json:
    return {
        "path": file.path,
        "verdict": file.verdict.value,
        "reason": file.reason or None,
        "findings": [_finding(finding) for finding in file.findings],
        "crosscheck": None if file.agreement is None else _crosscheck(file.agreement),
        "policy": [_outcome(outcome) for outcome in file.outcomes],
        "suppressed": file.suppressed,
        "known": file.known,
        "skipped": dict(file.skipped),
        "expanded": file.expanded,
        "seconds": number(file.seconds),
    }


def _finding(finding: Finding) -> Json:
    return {
        "code": finding.code,
        "name": finding.name,
        "severity": finding.severity.value,
        "message": finding.message,
        "file": finding.file or None,
        "line": finding.line or None,
        "element": finding.element or None,
        "attribute": finding.attribute or None,
        "hint": finding.hint or None,
    }


def _crosscheck(agreement: Agreement) -> Json:
    return {
        "readers": list(agreement.readers),
        "frames": agreement.frames,
        "configurations": agreement.configurations,
        "max_difference": number(agreement.max_difference),
        "tolerance": number(agreement.tolerance),
        "agree": agreement.agree,
        "disagreements": [
            {
                "quantity": apart.quantity,
                "odd_one": apart.odd_one or None,
                "readers": list(apart.readers),
                "frame": apart.frame or None,
                "configuration": _configuration(apart.configuration),
                "size": number(apart.size),
                "tolerance": number(apart.tolerance),
                "unit": apart.unit,
            }
            for apart in agreement.disagreements
        ],
        "notes": list(agreement.notes),
    }


def _outcome(outcome: Outcome) -> Json:
    return {
        "kind": outcome.kind,
        "title": outcome.title,
        "remedy": outcome.remedy or None,
        "met": outcome.met,
        "wanted": outcome.wanted,
        "found": outcome.found,
        "witness": _configuration(outcome.witness),
        "place": outcome.place or None,
    }


def _configuration(configuration: dict[str, float]) -> Json:
    return {joint: number(value) for joint, value in configuration.items()}


def _encodable(value: Any) -> Any:
    """Return the value with all its texts fit for UTF-8."""
    if isinstance(value, dict):
        return {encodable(key): _encodable(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_encodable(part) for part in value]
    return encodable(value) if isinstance(value, str) else value
