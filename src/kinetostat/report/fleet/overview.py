"""The table of all robots and chains, a row each: what one sees first of a fleet."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace

from kinetostat.analysis.indices import NEAR
from kinetostat.report.fleet.document import ChainRow, FleetDocument, RobotDocument
from kinetostat.report.fleet.grid import Cell, Column, Grid, count, grid, quantity, share, words
from kinetostat.report.fleet.wording import (
    asides,
    asked_text,
    chains_of,
    checked,
    dexterity,
    distribution,
    engines_agree,
    is_doubted,
    labels,
    near_singular,
    quantile,
    severities,
    title,
    unmet,
)

__all__ = ["Line", "Overview", "overview"]

_COLUMNS = (
    Column("robot", "words"),
    Column("chain", "words"),
    Column("joints", about="Joints that move the chain; of the robot, where it has no chain."),
    Column("mass", about="Of the whole robot."),
    Column("reach", about="Largest distance of the tool from the chain's first joint that was found inside limits."),
    Column(
        "payload at mid",
        about="The largest payload at the middle of limits, by effort limits alone. Doubtful where it is more than ten "
        "times the robot's mass: the limits are placeholders, or the load hangs in line with the joints there.",
    ),
    Column("manipulability, median", about="Yoshikawa's: the product of the singular values."),
    Column("manipulability, 10 %", about="A tenth of all configurations inside limits have less."),
    Column(
        "dexterity, median",
        about="Smallest over largest singular value: 1 is isotropic, 0 singular. Empty for one joint, and for "
        "joints that only turn the tool.",
    ),
    Column("near-singular", about=f"Share of configurations inside limits whose dexterity is below {NEAR:g}."),
    Column("worst gravity use", about="Largest share of an effort limit that the weight takes, found inside limits."),
    Column(
        "errors / warnings / infos",
        about="Findings of the rules of 'kinetostat check', and how many expectations of the settings are not met.",
    ),
    Column("engines", about="Whether Pinocchio and the screw engine agree on every number."),
)
_LOADED = 11  # where the column of the payload that is asked for stands
_BIGGEST = 10_000  # findings of a severity, where they are sorted
_LARGEST = sys.float_info.max  # what a payload without a limit is sorted as


@dataclass(frozen=True)
class Line:
    """A row: a chain of a robot, or a robot that has none (or failed).

    Attributes:
        robot: whose.
        label: what the robot is called, by which it is told from the others.
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
    called, paths = labels(document), asides(document)
    asked = {chain.asked_payload for chain in chains_of(document)} - {None}
    farthest = max((chain.reach or 0.0 for chain in chains_of(document)), default=0.0)
    owners = [(robot, chain) for robot in document.robots for chain in robot.chains or (None,)]
    columns, cells = list(_COLUMNS), [list(_cells(robot, paths[robot.id], chain, farthest)) for robot, chain in owners]
    if asked:
        columns.insert(_LOADED, _loaded(next(iter(asked)) if len(asked) == 1 else None))
        for (_, chain), row in zip(owners, cells, strict=True):
            row.insert(_LOADED, _loaded_use(chain, several=len(asked) > 1))
    table: Grid = grid(columns, cells)
    rows = zip(owners, table.rows, strict=True)
    return Overview(table.columns, tuple(Line(robot, called[robot.id], chain, cells) for (robot, chain), cells in rows))


def _loaded(asked: float | None) -> Column:
    """Return the column of the payload that is asked for; None: of different ones."""
    return Column(
        f"worst use with {asked_text(asked)}",
        about="The same with the payload that is asked for, at the tool's origin: above 100 % it cannot be held "
        "somewhere inside limits.",
    )


def _loaded_use(chain: ChainRow | None, *, several: bool) -> Cell:
    """Return the use with the payload that is asked for, and which that is, where it is not the same in all rows."""
    if chain is None or chain.worst_loaded_use is None:
        return share(None)
    return replace(share(chain.worst_loaded_use), note=f"with {asked_text(chain.asked_payload)}" if several else "")


def _cells(robot: RobotDocument, path: str, chain: ChainRow | None, farthest: float) -> Iterator[Cell]:
    yield words(title(robot), robot.id, note=path)
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
        yield from _measures(chain, robot.mass, farthest)
    yield _findings(robot)
    yield _engines(robot)


def _measures(chain: ChainRow, mass: float | None, farthest: float) -> Iterator[Cell]:
    yoshikawa = distribution(chain, "yoshikawa")
    unit = yoshikawa.unit if yoshikawa else ""
    yield quantity(chain.reach, "m", full=farthest)
    yield _payload(chain, mass)
    yield quantity(quantile(chain, "yoshikawa", "0.5"), unit)
    yield quantity(quantile(chain, "yoshikawa", "0.1"), unit)
    yield quantity(dexterity(chain, "0.5"), full=1)
    yield share(near_singular(chain))
    yield share(chain.worst_gravity_use)


def _payload(chain: ChainRow, mass: float | None) -> Cell:
    payload = chain.payload_at_mid
    if payload is None:
        return quantity(None)
    if payload.mass is not None:
        return replace(quantity(payload.mass, "kg"), note="doubtful" if is_doubted(payload, mass) else "")
    return Cell("no limit", _LARGEST, "kg") if payload.unbounded else Cell("none", 0.0, "kg", sign="bad")


def _findings(robot: RobotDocument) -> Cell:
    """Return how many there are, and how many expectations are not met; sorted by what is worst."""
    if not checked(robot):
        return words("not checked")
    found, missed, rank = severities(robot), unmet(robot), 0
    for number in (found["error"] + missed, found["warning"], found["info"]):
        rank = rank * _BIGGEST + min(number, _BIGGEST - 1)
    told, unmet_told = " / ".join(map(str, found.values())), f"{missed} unmet" if missed else ""
    return Cell(told, rank, sign="bad" if found["error"] or missed else "", note=unmet_told)


def _engines(robot: RobotDocument) -> Cell:
    agree = engines_agree(robot)
    if agree is None:
        return words("")
    return Cell("agree", 1, sign="good") if agree else Cell("DISAGREE", 0, sign="bad")
