"""The report as one table: a row for each chain of each robot, and one for a robot without chains. RFC 4180."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from kinetostat.errors import printable
from kinetostat.report import csv
from kinetostat.report.fleet.document import ChainRow, FleetDocument, RobotDocument
from kinetostat.report.fleet.wording import checked, distribution, quantile, severities, unmet
from kinetostat.report.view import Cell, Table

__all__ = ["CHAIN_COLUMNS", "ROBOT_COLUMNS", "TableColumn", "robots_csv"]

_Row = TypeVar("_Row")


@dataclass(frozen=True)
class TableColumn(Generic[_Row]):
    """A column of robots.csv.

    Attributes:
        name: in the header.
        unit: in brackets behind the name; empty where there is none, or another column tells it.
        about: what it says.
        cell: of a robot, or of a chain.
    """

    name: str
    unit: str
    about: str
    cell: Callable[[_Row], Cell | bool]


def robots_csv(document: FleetDocument) -> str:
    """Return robots.csv: numbers in full precision, units in the header, an empty cell where there is no number.

    What is not printable in a name is escaped, and a name that a spreadsheet would take for a formula is led by an
    apostrophe.
    """
    heads = [(one.name, one.unit) for one in ROBOT_COLUMNS] + [(one.name, one.unit) for one in CHAIN_COLUMNS]
    rows = tuple(row for robot in document.robots for row in _rows(robot))
    return csv.render(Table(tuple(name for name, _ in heads), rows, tuple(unit for _, unit in heads)))


def _rows(robot: RobotDocument) -> Iterator[tuple[Cell, ...]]:
    """Yield a row for each chain; one with no chain where there is none."""
    own = [_shown(column.cell(robot)) for column in ROBOT_COLUMNS]
    for chain in robot.chains:
        yield (*own, *(_shown(column.cell(chain)) for column in CHAIN_COLUMNS))
    if not robot.chains:
        yield (*own, *(None for _ in CHAIN_COLUMNS))


def _shown(cell: Cell | bool) -> Cell:
    if isinstance(cell, bool):
        return str(cell).lower()
    return printable(cell) if isinstance(cell, str) else cell


def _of(whole: _Row | None, part: Callable[[_Row], Cell | bool]) -> Cell | bool:
    """Return a part of what may not be there."""
    return None if whole is None else part(whole)


# --- of a robot ----------------------------------------------------------------------------------------------------


def _findings(severity: str) -> Callable[[RobotDocument], Cell]:
    return lambda robot: severities(robot)[severity] if checked(robot) else None


ROBOT_COLUMNS: Sequence[TableColumn[RobotDocument]] = (
    TableColumn("robot_id", "", "As in report.json.", lambda r: r.id),
    TableColumn("path", "", "As it was asked for.", lambda r: r.path),
    TableColumn("robot", "", "Its name, as the file says.", lambda r: r.name),
    TableColumn("status", "", "done, unreadable or crashed.", lambda r: r.status),
    TableColumn("reason", "", "Why it is not done.", lambda r: r.reason),
    TableColumn("verdict", "", "Of check: pass, fail or crashed.", lambda r: r.verdict),
    TableColumn("links", "", "How many.", lambda r: _read(r, r.links)),
    TableColumn("degrees_of_freedom", "", "Of the independent joints.", lambda r: _read(r, r.degrees_of_freedom)),
    TableColumn("mass", "kg", "Of all links.", lambda r: r.mass),
    TableColumn("robot_reach", "m", "Longest path from the root, stretched out.", lambda r: r.reach),
    TableColumn("tips", "", "Links without children.", lambda r: _read(r, r.tips)),
    TableColumn("errors", "", "Findings of check that are errors.", _findings("error")),
    TableColumn("warnings", "", "Findings that are warnings.", _findings("warning")),
    TableColumn("infos", "", "Findings that are worth knowing.", _findings("info")),
    TableColumn("expectations", "", "Of the policy.", lambda r: len(r.expectations)),
    TableColumn("expectations_unmet", "", "Those not met, or not judged.", unmet),
    TableColumn("readers_agree", "", "All readers of the file.", lambda r: _of(r.agreement, lambda a: a.agree)),
    TableColumn("numbers_compared", "", "Computed by both engines.", lambda r: _of(r.certificate, lambda c: c.numbers)),
    TableColumn("engines_agree", "", "On all of these.", lambda r: _of(r.certificate, lambda c: c.agree)),
)


def _read(robot: RobotDocument, count: int) -> Cell:
    """Return a count of a robot that was read; one of a robot that was not is no count."""
    return count if robot.status == "done" else None


# --- of a chain ----------------------------------------------------------------------------------------------------


def _quantile(measure: str, share: str) -> Callable[[ChainRow], Cell]:
    return lambda chain: quantile(chain, measure, share)


CHAIN_COLUMNS: Sequence[TableColumn[ChainRow]] = (
    TableColumn("chain_id", "", "As in report.json.", lambda c: c.id),
    TableColumn("chain", "", "Its name.", lambda c: c.name),
    TableColumn("base", "", "The link that it is looked at from.", lambda c: c.base),
    TableColumn("frame", "", "The link at its end.", lambda c: c.frame),
    TableColumn("found", "", "By the settings, as a group of the SRDF, or as a tip.", lambda c: c.found),
    TableColumn("joints", "", "How many independent joints.", lambda c: len(c.joints)),
    TableColumn("rows", "", "The rows of the twist that count.", lambda c: " ".join(c.rows)),
    TableColumn("rank", "", "At almost every configuration.", lambda c: c.rank),
    TableColumn("length", "m", "What makes m and rad comparable.", lambda c: c.length),
    TableColumn("samples", "", "Random configurations.", lambda c: c.samples),
    TableColumn("reach", "m", "Largest distance from the first joint that is found.", lambda c: c.reach),
    TableColumn(
        "payload_at_mid", "kg", "Largest at the middle of limits.", lambda c: _of(c.payload_at_mid, lambda p: p.mass)
    ),
    TableColumn(
        "payload_joint", "", "The joint that stops it.", lambda c: _of(c.payload_at_mid, lambda p: p.binding_joint)
    ),
    TableColumn("yoshikawa_median", "", "Half of the samples are not above.", _quantile("yoshikawa", "0.5")),
    TableColumn("yoshikawa_10_percent", "", "A tenth of the samples is not above.", _quantile("yoshikawa", "0.1")),
    TableColumn("yoshikawa_unit", "", "Of these two.", lambda c: _of(distribution(c, "yoshikawa"), lambda d: d.unit)),
    TableColumn("smallest_median", "", "Smallest singular value.", _quantile("minimum_singular_value", "0.5")),
    TableColumn("smallest_10_percent", "", "Smallest singular value.", _quantile("minimum_singular_value", "0.1")),
    TableColumn("smallest_unit", "", "Of these two; 1 for a pure number.", lambda c: c.singular_value_unit),
    TableColumn("dexterity_median", "", "Smallest over largest.", _quantile("inverse_condition_number", "0.5")),
    TableColumn("dexterity_10_percent", "", "Smallest over largest.", _quantile("inverse_condition_number", "0.1")),
    TableColumn("near_singular_share", "", "Of the samples, from 0 to 1.", lambda c: c.near_singular_share),
    TableColumn("effort_use_median", "", "Of the limits, under gravity; 1 is all.", _quantile("effort_use", "0.5")),
    TableColumn("worst_gravity_use", "", "Of a limit; a lower bound.", lambda c: c.worst_gravity_use),
    TableColumn("worst_gravity_joint", "", "The joint that uses so much.", lambda c: c.worst_gravity_joint),
    TableColumn("asked_payload", "kg", "What the next two are with.", lambda c: c.asked_payload),
    TableColumn("worst_loaded_use", "", "The same with the payload; a lower bound.", lambda c: c.worst_loaded_use),
    TableColumn("worst_loaded_joint", "", "The joint that uses so much.", lambda c: c.worst_loaded_joint),
    TableColumn("singular_families", "", "Inside limits.", lambda c: sum(f.inside_limits for f in c.families)),
    TableColumn("left_out", "", "How many things are not computed; report.json says why.", lambda c: len(c.left)),
    TableColumn("turns_only", "", "Whether the tool is turned, but never moved along.", lambda c: c.turns_only),
    TableColumn(
        "payload_unbounded",
        "",
        "Whether no joint feels a payload at the middle of limits: it has no limit there.",
        lambda c: _of(c.payload_at_mid, lambda p: p.unbounded),
    ),
)
