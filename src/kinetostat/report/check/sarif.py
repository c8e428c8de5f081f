"""The report as SARIF 2.1.0, for code scanning: rules that occur, results with places, crashes as notifications."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from urllib.parse import quote

from kinetostat.gate.result import CheckReport, FileCheck
from kinetostat.lint.finding import Severity
from kinetostat.lint.registry import FAMILIES, RULES
from kinetostat.lint.rule import Rule
from kinetostat.report.check.problems import CRASHED, POLICY, Problem, problems
from kinetostat.report.check.words import encodable, inert_json, path_from, skipped_by_reason, totals
from kinetostat.report.json import Json
from kinetostat.report.rules import paragraphs, shortened

__all__ = ["render"]

SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
_LEVELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "note"}
_OWN = {
    POLICY: ("expectation-not-met", "The robot does not do what the policy expects of it."),
    CRASHED: ("crashed", "The check of the robot crashed, hung or ran out of memory: nothing is known about it."),
}


def render(report: CheckReport, *, base: Path | None = None) -> str:
    """Return the report as SARIF.

    Args:
        report: what was found out.
        base: the folder that relative paths start from; URIs are relative to the repository that it is in.
    """
    found = [problem for file in report.files for problem in problems(file, base)]
    first = {problem.code: problem for problem in reversed(found)}
    codes = list(dict.fromkeys(problem.code for problem in found))
    rules = [_descriptor(code, first[code]) for code in codes]
    indices = {code: i for i, code in enumerate(codes)}
    run: Json = {
        "tool": {"driver": {"name": "kinetostat", "version": _version(), "rules": rules}},
        "columnKind": "unicodeCodePoints",
        "invocations": [_invocation(report, base)],
        "results": [_result(problem, indices[problem.code]) for problem in found],
        "properties": asdict(totals(report)),
    }
    log = {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}
    return inert_json(encodable(json.dumps(log, indent=1, ensure_ascii=False, allow_nan=False))) + "\n"


def _version() -> str:
    try:
        return version("kinetostat")
    except PackageNotFoundError:  # run from its sources
        from kinetostat import __version__

        return __version__


# --- rules -------------------------------------------------------------------------------------------------------


@cache
def _rules() -> dict[str, Rule]:
    return {rule.code: rule for rule in RULES}


def _descriptor(code: str, example: Problem) -> Json:
    """Return what is said of a rule; of one that is not ours, what a problem of it tells."""
    rule = _rules().get(code)
    if rule is not None:
        return {
            "id": code,
            "name": rule.name,
            "shortDescription": {"text": rule.aim},
            "fullDescription": {"text": "\n\n".join(paragraphs(rule.why)) or rule.aim},
            "help": {"text": _help(rule)},
            "defaultConfiguration": {"level": _LEVELS[rule.severity]},
            "properties": {"tags": [FAMILIES[code[0]]] if code[:1] in FAMILIES else []},
        }
    name, aim = _OWN.get(code, (example.name, example.name or code))
    return {
        "id": code,
        "name": name or code,
        "shortDescription": {"text": aim},
        "fullDescription": {"text": aim},
        "help": {"text": example.hint or aim},
        "defaultConfiguration": {"level": _LEVELS[example.severity]},
    }


def _help(rule: Rule) -> str:
    bad, good = (shortened(example.robot_text) for example in (rule.bad, rule.good))
    return "\n\n".join(
        filter(None, (*paragraphs(rule.why), f"What to do: {rule.hint}.", f"Bad:\n{bad}", f"Good:\n{good}"))
    )


# --- results -----------------------------------------------------------------------------------------------------


def _result(problem: Problem, index: int) -> Json:
    message = f"{problem.message} ({problem.hint})" if problem.hint else problem.message
    result: Json = {
        "ruleId": problem.code,
        "ruleIndex": index,
        "level": _LEVELS[problem.severity],
        "message": {"text": _plain(message)},
        "locations": [_location(problem.path, problem.line, problem.columns)],
        "partialFingerprints": {"kinetostat/v1": _fingerprint(problem.identity)},
    }
    path, _, line = problem.place.rpartition(":")
    if path and line.isascii() and line.isdigit():
        result["relatedLocations"] = [_location(path, int(line), None) | {"message": {"text": "the expectation"}}]
    elif problem.place:
        result["relatedLocations"] = [_location(problem.place, 0, None) | {"message": {"text": "the expectation"}}]
    return result


def _plain(text: str) -> str:
    """Return a message in which braces are no placeholders, and brackets no links (3.11.5 and 3.11.6)."""
    return text.replace("{", "{{").replace("}", "}}").replace("](", "] (")


def _location(path: str, line: int, columns: tuple[int, int] | None) -> Json:
    physical: Json = {"artifactLocation": _artifact(path)}
    if line > 0:
        physical["region"] = {"startLine": line}
        if columns is not None:
            physical["region"] |= {"startColumn": columns[0] + 1, "endColumn": columns[1] + 1}
    return {"physicalLocation": physical}


def _artifact(path: str) -> Json:
    """Return a file's location: relative to the repository, or a file:// URI if it is not in it."""
    try:
        uri = quote(path.encode("utf-8", "surrogateescape"), safe="/")  # the bytes of the name
    except UnicodeEncodeError:
        uri = quote(encodable(path), safe="/")
    if path.startswith("/"):
        return {"uri": f"file://{re.sub('^/+', '/', uri)}"}
    return {"uri": uri, "uriBaseId": "%SRCROOT%"}


def _fingerprint(identity: Sequence[str]) -> str:
    return hashlib.sha256("\0".join(identity).encode("utf-8", "backslashreplace")).hexdigest()[:32]


# --- the run -----------------------------------------------------------------------------------------------------


def _invocation(report: CheckReport, base: Path | None) -> Json:
    """Return how the run went: not well if a robot crashed; and which rules were not asked of which robot."""
    notifications = [note for file in report.files for note in _notifications(file, base)]
    successful = not any(note["level"] == "error" for note in notifications)
    return {"executionSuccessful": successful, "toolExecutionNotifications": notifications}


def _notifications(file: FileCheck, base: Path | None) -> Iterator[Json]:
    path = path_from(file.path, base)
    for problem in problems(file, base):
        if problem.code == CRASHED:
            yield _notification("error", problem.message, path)
    for reason, codes in skipped_by_reason(file).items():
        yield _notification("note", f"not asked: {codes} ({reason})", path)


def _notification(level: str, message: str, path: str) -> Json:
    return {"level": level, "message": {"text": _plain(message)}, "locations": [_location(path, 0, None)]}
