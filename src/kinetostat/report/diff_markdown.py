"""The difference of two robots as a comment for a pull request."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from kinetostat.errors import cut
from kinetostat.report.diff_sections import Cell, Name, Row, Section, headline_of, sections

if TYPE_CHECKING:
    from kinetostat.analysis.difference.difference import Difference

__all__ = ["diff_markdown"]

_ROWS = 60  # of a table: a comment on GitHub has at most 65,536 characters
_FEW = 20  # rows that are shown unfolded
_SHOWN = 200  # characters of a name
_LONGEST = 600  # characters of a line


def diff_markdown(result: Difference, lines: Sequence[str] = ()) -> str:
    """Return the difference as a comment for a pull request: a headline, renames, changes, the rest folded.

    Whatever comes from a robot file is set as code, or spelled out, so that it is no markup, link or mention.

    Args:
        result: the difference.
        lines: what else is to be said, such as the certificate.
    """
    mark = "changed" if result.exceeds else "unchanged"
    ends = f"{_code(result.before)} → {_code(result.after)}"
    blocks = [f"### kinetostat diff: {mark}", f"{ends}: {_cell(headline_of(result))}"]
    for section in sections(result):
        blocks += _shown(section) if section.shown else [_folded(section.title, section, section.rows)]
    said = [*result.consequences.unchanged, *result.notes, *lines]
    if said:
        listed = "\n".join(f"- {_words(line)}" for line in said)
        blocks.append(f"<details><summary>the rest</summary>\n\n{listed}\n\n</details>")
    return "\n\n".join(blocks) + "\n"


def _shown(section: Section) -> list[str]:
    """Return a table as it is, but for what is beyond its first rows, which is folded."""
    blocks = [f"**{section.title}**\n\n{_table(section, section.rows[:_FEW])}"]
    left = section.rows[_FEW:]
    return [*blocks, _folded(f"{section.title}, the rest", section, left)] if left else blocks


def _folded(title: str, section: Section, rows: tuple[Row, ...]) -> str:
    summary = f"{title.replace(';', ',')}: {len(rows)}"
    return f"<details><summary>{summary}</summary>\n\n{_table(section, rows)}\n\n</details>"


def _table(section: Section, rows: tuple[Row, ...]) -> str:
    lines = [_row(section.header), _row("---" for _ in section.header)]
    lines += [_row(map(_cell, row)) for row in rows[:_ROWS]]
    text, left = "\n".join(lines), len(rows) - _ROWS
    return f"{text}\n\n… and {left} more" if left > 0 else text


def _row(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _cell(cell: Cell) -> str:
    """Return pieces, names as code. Our own words hold no markup."""
    return "".join(_code(piece) if isinstance(piece, Name) else piece.replace("->", "→") for piece in cell)


_HARMLESS = re.compile(r"[A-Za-z]+(?:[-/][a-z]+)*|[a-z]+/s|k?m2|[-+]?[0-9][-+0-9.e]*|->|%")
_AROUND = re.compile(r"([(]*)(.*?)([).,:;]*)", re.DOTALL)


def _words(text: str) -> str:
    """Return a line with plain words and numbers as they are, all else as code; punctuation around stays outside."""
    return " ".join(map(_word, cut(text, _LONGEST).split()))


def _word(word: str) -> str:
    found = _AROUND.fullmatch(word)
    before, core, after = found.groups() if found else ("", word, "")
    if not core or _HARMLESS.fullmatch(core):
        return word.replace("->", "→")
    return f"{before}{_code(core)}{after}"


def _code(text: str) -> str:
    """Return text as code: nothing in it is markup. What would end the code, or the cell, is spelled as an entity."""
    shown = cut(text, _SHOWN)
    if not shown:
        return ""
    if any(sign in shown for sign in "`|\\"):
        return f"<code>{''.join(c if c.isalnum() or c == ' ' else f'&#{ord(c)};' for c in shown)}</code>"
    return f"`{shown}`"
