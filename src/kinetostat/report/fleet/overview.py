"""The table of all robots and chains, a row each: what one sees first of a fleet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from kinetostat.analysis.indices import NEAR
from kinetostat.report.fleet.document import ChainRow, FleetDocument, RobotDocument
from kinetostat.report.fleet.grid import Cell, Column, Grid, count, grid, quantity, share, words
from kinetostat.report.fleet.wording import (
    chains_of,
    distribution,
    engines_agree,
    labels,
    quantile,
    severities,
)

__all__ = ["Line", "Overview", "overview"]

_COLUMNS = (
    Column("robot", "words"),
    Column("chain", "words"),
    Column("joints", about="Joints that move the chain; of the robot, where it has no chain."),
    Column("mass", about="Of the whole robot."),
    Column("reach", about="Largest distance of the tool from the chain's first joint that was found inside limits."),
    Column("payload", about="The largest payload at the middle of limits, by effort limits alone."),
    Column("manipulability, median", about="Yoshikawa's: the product of the singular values."),
    Column("manipulability, 10 %", about="A tenth of all configurations inside limits have less."),
    Column("dexterity, median", about="Smallest over largest singular value: 1 is isotropic, 0 singular."),
    Column("near-singular", about=f"Share of configurations inside limits whose dexterity is below {NEAR:g}."),
    Column("worst gravity use", about="Largest share of an effort limit that the weight takes, found inside limits."),
    Column("errors / warnings / infos", about="Findings of the rules of 'kinetostat check'."),
    Column("engines", about="Whether Pinocchio and the screw engine agree on every number."),
)
_BIGGEST = 10_000  # findings of a severity, where they are sorted


@dataclass(frozen=True)
class Line:
    """A row: a chain of a robot, or a robot that has none (or failed).

    Attributes:
        robot: whose.
        label: what the robot is called.
        chain: which; None where there is none.
        cells: one for each column.
    """

    robot: RobotDocument
    label: str
    chain: ChainRow | None
    cells: tuple[Cell, ...]


@dataclass(frozen=True)
class Overview:
    """The table."""

    columns: tuple[Column, ...]
    lines: tuple[Line, ...]


def overview(document: FleetDocument) -> Overview:
    """Return the table of all robots and chains, in the document's order."""
    called = labels(document)
    farthest = max((chain.reach or 0.0 for chain in chains_of(document)), default=0.0)
    owners = [(robot, chain) for robot in document.robots for chain in robot.chains or (None,)]
    table: Grid = grid(_COLUMNS, [list(_cells(robot, chain, called[robot.id], farthest)) for robot, chain in owners])
    rows = zip(owners, table.rows, strict=True)
    return Overview(table.columns, tuple(Line(robot, called[robot.id], chain, cells) for (robot, chain), cells in rows))


def _cells(robot: RobotDocument, chain: ChainRow | None, label: str, farthest: float) -> Iterator[Cell]:
    yield words(label, robot.id)
    done = robot.status == "done"
    if chain is None:
        yield words("no chain" if done else robot.reason)
        yield count(robot.degrees_of_freedom if done else None)
        yield quantity(robot.mass if done else None, "kg")
        yield from [words("")] * 7
    else:
        yield words(chain.name, chain.id)
        yield count(len(chain.joints))
        yield quantity(robot.mass, "kg")
        yield from _measures(chain, farthest)
    yield _findings(robot)
    yield _engines(robot)


def _measures(chain: ChainRow, farthest: float) -> Iterator[Cell]:
    yoshikawa = distribution(chain, "yoshikawa")
    unit = yoshikawa.unit if yoshikawa else ""
    yield quantity(chain.reach, "m", full=farthest)
    yield quantity(chain.payload_at_mid.mass if chain.payload_at_mid else None, "kg")
    yield quantity(quantile(chain, "yoshikawa", "0.5"), unit)
    yield quantity(quantile(chain, "yoshikawa", "0.1"), unit)
    yield quantity(quantile(chain, "inverse_condition_number", "0.5"), full=1)
    yield share(chain.near_singular_share)
    yield share(chain.worst_gravity_use)


def _findings(robot: RobotDocument) -> Cell:
    rank = 0
    found = severities(robot)
    for number in found.values():
        rank = rank * _BIGGEST + min(number, _BIGGEST - 1)
    return Cell(" / ".join(map(str, found.values())), rank, sign="bad" if found["error"] else "")


def _engines(robot: RobotDocument) -> Cell:
    agree = engines_agree(robot)
    if agree is None:
        return words("")
    return Cell("agree", 1, sign="good") if agree else Cell("DISAGREE", 0, sign="bad")
