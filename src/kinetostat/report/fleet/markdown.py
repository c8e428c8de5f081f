"""The report as GitHub's Markdown, for the summary of a job: totals, the table, what is worst of each robot, folded."""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.report.check.markdown import LONGEST, code, escaped, finding_line, fitting, left_out
from kinetostat.report.check.words import counted, encodable
from kinetostat.report.fleet.document import ChainRow, ExpectationRow, FleetDocument, RobotDocument
from kinetostat.report.fleet.grid import Cell
from kinetostat.report.fleet.overview import Line, overview
from kinetostat.report.fleet.wording import (
    asked_text,
    certificate_text,
    chain_worst,
    check_text,
    engines_agree,
    findings_text,
    labels,
    readers_text,
    status_text,
    totals_text,
    worst_first,
)

__all__ = ["markdown"]

_LONGEST_DETAILS = 6_000  # characters, of one robot
_LONGEST_LINE = 1_500  # characters, of a finding; each may be of an entity of six
_ROOM = 500  # characters, for what is said of what is left out


def markdown(document: FleetDocument, *, longest: int = LONGEST) -> str:
    """Return the report as Markdown. Names from robot files are no markup, link, mention or reference in it.

    Args:
        document: all numbers.
        longest: cut it to that many characters; what is left out is counted.
    """
    title = f"### kinetostat report: {counted(len(document.robots), 'robot')}"
    made = f"Made {document.made} by kinetostat {document.version}, {document.samples:,} configurations of each chain"
    asked = "" if document.payload is None else f", payload {asked_text(document.payload)}"
    where = "Pictures, and the findings in full, are in `index.html` beside this file."
    head = f"{title}\n\n{escaped(totals_text(document))}. {escaped(made)}, seed {document.seed}{asked}. {where}\n"
    table = overview(document)
    called = labels(document)
    rows = [_row(line) for line in table.lines]
    robots = sorted(document.robots, key=_badness)
    blocks = [_details(robot, called[robot.id]) for robot in robots]
    titles = [f"{column.title} [{column.unit}]" if column.unit else column.title for column in table.columns]
    header = f"\n| {' | '.join(map(escaped, titles))} |\n|{' --- |' * len(titles)}\n"
    room = longest - len(head) - len(header) - _ROOM
    shown_rows = fitting(rows, room // 2)
    shown_blocks = fitting(blocks, room - sum(map(len, shown_rows)))
    parts = [head, *([header, *shown_rows] if rows else []), left_out(len(rows) - len(shown_rows), "row")]
    parts += [*shown_blocks, left_out(len(blocks) - len(shown_blocks), "robot")]
    return encodable("".join(parts))


# --- the table -------------------------------------------------------------------------------------------------


def _row(line: Line) -> str:
    """Return a row; of a robot that failed, the reason stands where its numbers would."""
    _, second, *others = line.cells
    called = code(_cut(line.label))
    if line.robot.status != "done":
        reason = escaped(_cut(line.robot.reason)) or "no reason is known"
        cells = [called, f"**{status_text(line.robot)}**: {reason}", *map(_cell, others)]
    else:
        name = escaped(second.text) if line.chain is None else code(_cut(second.text))
        cells = [called, name, *map(_cell, others)]
    return f"| {' | '.join(cells)} |\n"


def _cell(cell: Cell) -> str:
    over = cell.bar is not None and cell.bar > 1
    text = escaped(f"{cell.text} {cell.unit}".strip() + (f", {cell.note}" if cell.note else ""))
    return f"**{text}**" if text and (over or cell.sign == "bad") else text


def _cut(text: str) -> str:
    """Return a text that a row has room for; a name in a script that is escaped takes up to ten times as much."""
    return text if len(text) <= _LONGEST_LINE // 10 else f"{text[: _LONGEST_LINE // 10]}..."


# --- robot by robot --------------------------------------------------------------------------------------------


def _badness(robot: RobotDocument) -> tuple[bool, bool, bool]:
    """Return what robots are sorted by: those that failed, then where engines disagree, then what `check` fails."""
    return robot.status == "done", engines_agree(robot) is not False, robot.verdict == "pass"


def _details(robot: RobotDocument, label: str) -> str:
    """Return what is worst of a robot, folded."""
    items = [f"- {item}\n" for item in _items(robot)]
    kept = fitting(items, _LONGEST_DETAILS)
    left = left_out(len(items) - len(kept), "line")
    told = escaped(f"findings: {findings_text(robot)}" if robot.status == "done" else status_text(robot))
    failing = f"; <strong>{escaped(check_text(robot))}</strong>" if check_text(robot) else ""
    summary = f"{code(_cut(label))}: {told}{failing}"
    return f"\n<details><summary>{summary}</summary>\n\n{''.join(kept)}{left}\n</details>\n"


def _items(robot: RobotDocument) -> Iterator[str]:
    """Yield what there is to tell, a line each; infos are only counted."""
    if robot.status != "done":
        yield f"**{status_text(robot)}**: {escaped(_cut(robot.reason)) or 'no reason is known'}"
    for finding in worst_first(robot):
        if finding.severity != "info":
            yield finding_line(finding)
    for expectation in robot.expectations:
        if not expectation.met:
            yield _expectation(expectation)
    if robot.status != "done":
        return
    verdict = "**engines**: " if engines_agree(robot) is False else ""
    yield f"{verdict}{escaped(certificate_text(robot.certificate))}"
    if robot.agreement is not None and not robot.agreement.agree:
        yield f"**cross-check**: {escaped(readers_text(robot.agreement))}"
        yield from map(escaped, robot.agreement.disagreements)
    yield from (_chain(chain, robot.mass) for chain in robot.chains)
    for left in robot.left:
        yield f"not computed, or held: {code(_cut(left.what))} ({escaped(_cut(left.why))})"


def _expectation(row: ExpectationRow) -> str:
    head = "**not met**" if row.met is False else "**not judged**"
    place = f" {code(row.place)}" if row.place else ""
    wanted = f"wanted {escaped(row.wanted)}, found" if row.met is False else "found"
    return f"{head}{place}: {escaped(row.title)}: {wanted} {escaped(row.found)}"


def _chain(chain: ChainRow, mass: float | None) -> str:
    facts = "; ".join(f"{escaped(title)} {escaped(text)}" for title, text in chain_worst(chain, mass))
    return f"chain {code(_cut(chain.name))}: {facts or 'nothing is known'}"
