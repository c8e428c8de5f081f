"""What the page and the Markdown of a report say in the same words: numbers, units, counts, what the engines say."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from pathlib import PurePath

from kinetostat.report.check.words import agreement_text, counted
from kinetostat.report.fleet.document import (
    Agreed,
    CertificateRow,
    ChainRow,
    DistributionRow,
    FindingRow,
    FleetDocument,
    PayloadRow,
    RobotDocument,
)

__all__ = [
    "SEVERITIES",
    "asides",
    "asked_text",
    "certificate_text",
    "chain_facts",
    "chain_labels",
    "chain_worst",
    "chains_of",
    "check_text",
    "checked",
    "comparable",
    "compared",
    "dexterity",
    "distribution",
    "engines_agree",
    "fails_check",
    "findings_text",
    "labels",
    "measured",
    "near_singular",
    "number_text",
    "payload_text",
    "percent",
    "quantile",
    "readers_text",
    "severities",
    "status_text",
    "title",
    "totals_text",
    "unit_text",
    "unmet",
    "worst_first",
]

SEVERITIES = ("error", "warning", "info")
_STATUS = {"done": "done", "unreadable": "could not be read", "crashed": "crashed"}
_NO_REACH = 1e-9  # m
_ROWS = {"vx vy vz wx wy wz": "where the tool is and how it is turned", "vx vy vz": "where the tool is"}
_TRUSTED = 10  # a payload of so many times the robot's own mass is not believed
_NOISE = 1e-12  # what rounding leaves of a zero, in SI units
_RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


# --- numbers ---------------------------------------------------------------------------------------------------


def number_text(value: float | None) -> str:
    """Return a number with three significant digits: `0.0123`, `12.3`, `1230`, `1.23e-5`; empty if it is not known."""
    if value is None or math.isnan(value):
        return ""
    if math.isinf(value):
        return "infinite" if value > 0 else "-infinite"
    if abs(value) < _NOISE:
        return "0"
    digits, power = f"{value:.2e}".split("e")
    if not -4 < int(power) < 6:
        return f"{digits}e{int(power)}"
    return f"{value:.{max(0, 2 - int(power))}f}"


def unit_text(unit: str) -> str:
    """Return a unit as it is printed: powers are raised, a pure number has none."""
    if unit == "1":
        return ""
    base, hat, power = unit.rpartition("^")
    return f"{base}{power.translate(_RAISED)}" if hat and power.lstrip("-").isdecimal() else unit


def measured(value: float | None, unit: str) -> str:
    """Return a number with its unit; empty if it is not known."""
    return f"{number_text(value)} {unit_text(unit)}".strip() if number_text(value) else ""


# --- chains ----------------------------------------------------------------------------------------------------


def chains_of(document: FleetDocument) -> list[ChainRow]:
    """Return the chains of all robots."""
    return [chain for robot in document.robots for chain in robot.chains]


def compared(document: FleetDocument) -> list[ChainRow]:
    """Return the chains that reach somewhere and whose dexterity says something: a head is not compared with arms."""
    return [
        chain
        for chain in chains_of(document)
        if chain.reach is not None and chain.reach > _NO_REACH and dexterity(chain, "0.5") is not None
    ]


def distribution(chain: ChainRow, measure: str) -> DistributionRow | None:
    """Return how a measure is distributed; None if it was not computed."""
    return next((row for row in chain.distributions if row.measure == measure), None)


def quantile(chain: ChainRow, measure: str, share: str) -> float | None:
    """Return the value that a share of all configurations is below; None if it is not known."""
    found = distribution(chain, measure)
    return found.quantiles.get(share) if found else None


def dexterity(chain: ChainRow, share: str) -> float | None:
    """Return a quantile of the dexterity; None if it is not known, or says nothing (`comparable`)."""
    return quantile(chain, "inverse_condition_number", share) if comparable(chain) else None


def near_singular(chain: ChainRow) -> float | None:
    """Return the share of configurations whose dexterity is low; None where that says nothing."""
    return chain.near_singular_share if comparable(chain) else None


def comparable(chain: ChainRow) -> bool:
    """Return whether its dexterity says something: one joint has one singular value, which is smallest and largest.

    Of joints that only turn the tool it compares turns alone, which is not what that of an arm is.
    """
    return len(chain.joints) > 1 and not chain.turns_only


def payload_text(payload: PayloadRow | None, mass: float | None = None) -> str:
    """Return the payload at the middle of limits, and what sets it; empty if it is not known.

    Args:
        payload: what is told.
        mass: the robot's own; a payload that is many times as much is doubted.
    """
    if payload is None:
        return ""
    if payload.unbounded:
        return "no limit: no joint feels it"
    by = f", set by {payload.binding_joint}" if payload.binding_joint else ""
    if payload.mass is None:
        return f"none{by}: joints are overloaded"
    doubt = " (placeholder limits, or a load in line with the joints?)" if is_doubted(payload, mass) else ""
    return f"{measured(payload.mass, 'kg')}{by}{doubt}"


def is_doubted(payload: PayloadRow, mass: float | None) -> bool:
    """Return whether a payload is many times as much as the robot of that mass."""
    return payload.mass is not None and mass is not None and payload.mass > _TRUSTED * mass


def chain_facts(chain: ChainRow, mass: float | None = None) -> list[tuple[str, str]]:
    """Return what is known of a chain of a robot of that mass, as a whole: titles, and a text each."""
    rows = " ".join(chain.rows)
    facts = [
        ("reach, from its first joint", measured(chain.reach, "m")),
        *chain_worst(chain, mass),
        ("dexterity, median", number_text(dexterity(chain, "0.5"))),
        ("what counts", _ROWS.get(rows, rows)),
        ("independent motions", "" if chain.rank is None else f"{chain.rank} of {len(chain.rows)}"),
        ("characteristic length", measured(chain.length, "m")),
        ("random configurations", f"{chain.samples:,}" if chain.samples else ""),
    ]
    return [(title, text) for title, text in facts if text]


def chain_worst(chain: ChainRow, mass: float | None = None) -> list[tuple[str, str]]:
    """Return what limits a chain of a robot of that mass: titles, and a text each."""
    facts = [
        ("payload at mid", payload_text(chain.payload_at_mid, mass)),
        ("worst gravity use", _use_text(chain.worst_gravity_use, chain.worst_gravity_joint)),
        (
            f"worst use with {asked_text(chain.asked_payload)}",
            _use_text(chain.worst_loaded_use, chain.worst_loaded_joint),
        ),
        (f"near-singular (dexterity below {chain.near:.3g})", percent(near_singular(chain))),
    ]
    return [(title, text) for title, text in facts if text]


def asked_text(payload: float | None) -> str:
    """Return the payload that was asked for."""
    return "the payload" if payload is None else f"{payload:.6g} kg"


def percent(value: float | None) -> str:
    """Return a share in percent; empty if it is not known."""
    return measured(None if value is None else 100 * value, "%")


def _use_text(use: float | None, joint: str) -> str:
    by = f" ({joint})" if joint else ""
    return f"{percent(use)}{by}" if use is not None else ""


# --- robots ----------------------------------------------------------------------------------------------------


def labels(document: FleetDocument) -> dict[str, str]:
    """Return what each robot is called, by its id: its name, or its path where it has none or shares it."""
    names = Counter(robot.name for robot in document.robots)
    return {r.id: r.name if r.name and names[r.name] == 1 else r.path or r.id for r in document.robots}


def title(robot: RobotDocument) -> str:
    """Return what a robot is called where its path stands beside: its name, or its path where it has none."""
    return robot.name or robot.path or robot.id


def asides(document: FleetDocument) -> dict[str, str]:
    """Return each robot's path, by its id, for beside its name: empty where the name, its own alone, says the same.

    As `robots/two_arms.urdf` of two-arms.
    """
    titles = Counter(map(title, document.robots))
    return {r.id: "" if titles[title(r)] == 1 and _says_its_path(r) else r.path for r in document.robots}


def _says_its_path(robot: RobotDocument) -> bool:
    files = (robot.path, robot.path.removeprefix("example:"), PurePath(robot.path).stem)
    return _plain(title(robot)) in map(_plain, files)


def _plain(text: str) -> str:
    return text.casefold().replace("_", "-")


def chain_labels(document: FleetDocument) -> dict[str, str]:
    """Return what each chain is called among all, by its id: as its robot, and by name where that has several."""
    called = labels(document)
    return {
        chain.id: called[robot.id] if len(robot.chains) == 1 else f"{called[robot.id]}: {chain.name}"
        for robot in document.robots
        for chain in robot.chains
    }


def status_text(robot: RobotDocument) -> str:
    """Return how it went."""
    return _STATUS[robot.status]


def engines_agree(robot: RobotDocument) -> bool | None:
    """Return whether both engines agree on everything that was compared; None if nothing was."""
    certificate = robot.certificate.agree if robot.certificate else None
    answers = [a for a in (certificate, robot.agreement and robot.agreement.engines_agree) if a is not None]
    return all(answers) if answers else None


def severities(robot: RobotDocument) -> Mapping[str, int]:
    """Return how many findings there are of each severity."""
    found = Counter[str](finding.severity for finding in robot.findings)
    return {severity: found[severity] for severity in SEVERITIES}


def checked(robot: RobotDocument) -> bool:
    """Return whether the rules were asked: not of a robot whose process died, or did not answer."""
    return robot.verdict != "crashed"


def unmet(robot: RobotDocument) -> int:
    """Return how many expectations are not met; one that could not be judged is not."""
    return sum(one.met is not True for one in robot.expectations)


def fails_check(robot: RobotDocument) -> bool:
    """Return whether a robot that was computed fails `check`: by a finding, an expectation, or the engines."""
    return robot.status == "done" and robot.verdict != "pass"


def check_text(robot: RobotDocument) -> str:
    """Return whether a robot fails `check`, and how many expectations it does not meet; empty if it passes."""
    missed = unmet(robot)
    of = f": {missed} of {counted(len(robot.expectations), 'expectation')} not met" if missed else ""
    return f"fails check{of}" if fails_check(robot) else ""


def findings_text(robot: RobotDocument) -> str:
    """Return how many findings there are: `1 error, 2 warnings, 3 infos`."""
    if not checked(robot):
        return "not checked"
    return ", ".join(counted(n, severity) for severity, n in severities(robot).items() if n) or "none"


def worst_first(robot: RobotDocument) -> list[FindingRow]:
    """Return the findings, errors first, else as they were found."""
    return sorted(robot.findings, key=lambda finding: SEVERITIES.index(finding.severity))


# --- both engines ----------------------------------------------------------------------------------------------


def certificate_text(row: CertificateRow | None) -> str:
    """Return what the engines say of all numbers of a robot together, in a sentence."""
    if row is None or row.agree is None:
        return "No number was computed twice."
    told = f"{row.numbers:,} {'number' if row.numbers == 1 else 'numbers'} in {counted(row.answers, 'answer')}"
    apart = f"largest difference {_size(row.max_difference)}, tolerance {_size(row.tolerance)}"
    where = f" ({row.answer})" if row.answer else ""
    verdict = "" if row.agree else " The engines DISAGREE."
    return f"{told} computed twice, by {' and '.join(row.engines)}; {apart}{where}.{verdict}"


def _size(value: float | None) -> str:
    return "not known" if value is None else f"{value:.1e}"


def readers_text(agreed: Agreed | None) -> str:
    """Return how far the readers of the file agree, in a sentence."""
    return f"{agreement_text(agreed)}." if agreed else "The readers of the file were not compared."


def totals_text(document: FleetDocument) -> str:
    """Return what is in the report, in a line."""
    robots = document.robots
    failed = Counter[str](robot.status for robot in robots if robot.status != "done")
    numbers = sum(robot.certificate.numbers for robot in robots if robot.certificate)
    failing = sum(map(fails_check, robots))
    parts = [
        f"{counted(len(robots), 'robot')}, {counted(len(chains_of(document)), 'chain')}",
        *(f"{failed[status]} {_STATUS[status]}" for status in _STATUS if failed[status]),
        *([f"{failing} {'fails' if failing == 1 else 'fail'} check"] if failing else []),
        f"{numbers:,} numbers computed twice",
    ]
    return "; ".join(parts)
