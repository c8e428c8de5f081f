"""Views to plain text that fits 80 columns."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence

from kinetostat.errors import printable
from kinetostat.report.view import Cell, Table, View

__all__ = ["render"]

WIDTH = 80
_NUMBER_WIDTH = 8
_GAP = 1
_NARROWEST = 6
_LAST = 30  # what the last column has at least, if it needs so much
_LONGEST_NAME = 64
_NOISE = 1e-12  # what is left of a zero, in m and rad
_TALLEST = 200  # rows of a table of words
_NUMBER = re.compile(r"[-+(\[]?\d[\d.,:]*(e[-+]?\d+)?[\]);,%]*")
_LONGEST_WORD = 10  # of a header above numbers, that is not broken
_LONGEST_NUMBER = 24  # characters, its unit included


def render(view: View) -> str:
    """Return the view as text. Whatever comes from a robot file is made printable."""
    blocks = ["\n".join(line for part in view.title.splitlines() for line in textwrap.wrap(part, WIDTH))]
    if view.drawing:
        blocks.append("\n".join(printable(line) for line in view.drawing))
    for table in view.tables:
        body = _words(table) if table.words else _numbers(table)
        blocks.append("\n".join([*textwrap.wrap(printable(table.title), WIDTH), body]))
    if view.notes:
        notes = [part for line in view.notes for part in textwrap.wrap(printable(line), WIDTH)]
        blocks.append("\n".join(notes))
    return "\n\n".join(blocks) + "\n"


# --- numbers: columns of equal width, split into blocks where the page ends ------------------------------------


def _numbers(table: Table) -> str:
    """Return a table of numbers. Its leading word columns are repeated before each block of number columns."""
    labels = min((i for row in table.rows for i, cell in enumerate(row) if isinstance(cell, float)), default=1)
    form = _form([cell for row in table.rows for cell in row if isinstance(cell, float)])
    rows = [[_shown(cell, form) for cell in row] + [""] * (len(table.header) - len(row)) for row in table.rows]
    names = [_cut(printable(name), _LONGEST_NAME) for name in table.header]
    units = list(table.units) or [""] * len(names)
    label_widths = [max(len(row[i]) for row in [names, units, *rows]) for i in range(labels)]
    width = max([_NUMBER_WIDTH, *(len(row[i]) for row in [units, *rows] for i in range(labels, len(names)))])
    left = sum(w + _GAP for w in label_widths)
    per_block = max(1, (WIDTH - left + _GAP) // (width + _GAP))
    blocks = []
    for start in range(labels, max(len(names), labels + 1), per_block):
        block = range(start, min(start + per_block, len(names)))
        heads = [_broken(names[i], width) for i in block]
        tall = max(len(head) for head in heads)
        lines = [
            _line(
                names[:labels] if k == tall - 1 else [""] * labels,
                label_widths,
                [_from_below(h, tall)[k] for h in heads],
                width,
            )
            for k in range(tall)
        ]
        if any(units):
            lines.append(_line(units[:labels], label_widths, [units[i] for i in block], width))
        lines += [_line(row[:labels], label_widths, [row[i] for i in block], width) for row in rows]
        blocks.append("\n".join(line.rstrip() for line in lines))
    return "\n\n".join(blocks)


def _from_below(pieces: list[str], tall: int) -> list[str]:
    return [""] * (tall - len(pieces)) + pieces


def _line(labels: Sequence[str], label_widths: Sequence[int], cells: Sequence[str], width: int) -> str:
    left = "".join(label.ljust(w + _GAP) for label, w in zip(labels, label_widths, strict=True))
    return left + "".join(" " * _GAP + cell.rjust(width) for cell in cells)[_GAP:]


def _form(values: Sequence[float]) -> str:
    """Return the format that shows all of them: fixed point, or exponents where that would hide digits."""
    largest = max((abs(v) for v in values), default=0.0)
    return ".4e" if largest >= 1e4 or 0 < largest < 1e-3 else ".4f" if largest >= 100 else ".5f"


def _shown(cell: Cell, form: str) -> str:
    """Return a cell as text. Rounding noise is 0; what is small but no noise keeps its zeros: 0.00000."""
    if isinstance(cell, float):
        text = "0" if abs(cell) < _NOISE else format(cell, form)
        return text if any(digit in text for digit in "123456789") else text.lstrip("-")
    return "-" if cell is None else printable(cell)


def _broken(name: str, width: int) -> list[str]:
    """Return a name in pieces no wider than the column, broken after underscores where possible."""
    pieces, rest = [], name
    while len(rest) > width:
        cut = max(rest.rfind("_", 0, width), rest.rfind("/", 0, width), rest.rfind(".", 0, width)) + 1
        cut = cut if cut > 1 else width
        pieces.append(rest[:cut])
        rest = rest[cut:]
    return [*pieces, rest]


# --- words: the last column is folded, others are cut if they must be, but no number is ------------------------


def _words(table: Table) -> str:
    rows = [[_shown(cell, ".5g") for cell in row] for row in table.rows[:_TALLEST]]
    header, last = list(table.header), len(table.header) - 1
    widths = [max(len(row[i]) for row in [header, *rows]) for i in range(len(header))]
    floors = [_floor(name, [row[i] for row in rows]) for i, name in enumerate(header[:last])]
    last_room = min(widths[last], _LAST)
    while sum(w + 2 for w in widths[:last]) + last_room > WIDTH:
        loose = [i for i in range(last) if widths[i] > floors[i]]
        if not loose:
            break
        widths[max(loose, key=lambda i: widths[i])] -= 1
    widths[last] = max(WIDTH - sum(w + 2 for w in widths[:last]), 10)
    lines = []
    if any(header):
        heads = [textwrap.wrap(name, width) or [""] for name, width in zip(header, widths, strict=True)]
        tall = max(map(len, heads))
        lines += [_word_line([_from_below(head, tall)[k] for head in heads], widths) for k in range(tall)]
    for row in rows:
        folded = textwrap.wrap(row[last], widths[last]) or [""]
        lines.append(_word_line([*row[:last], folded[0]], widths))
        lines += [_word_line([*[""] * last, more], widths) for more in folded[1:]]
    if len(table.rows) > _TALLEST:
        lines.append(f"... and {len(table.rows) - _TALLEST} more (-F json has all of them)")
    return "\n".join(lines)


def _word_line(cells: Sequence[str], widths: Sequence[int]) -> str:
    return "  ".join(_cut(cell, width).ljust(width) for cell, width in zip(cells, widths, strict=True)).rstrip()


def _floor(name: str, cells: Sequence[str]) -> int:
    """Return how narrow a column may become: its numbers stay whole, and the words of the header above them."""
    numbers = [len(cell) for cell in cells if _has_number(cell)]
    words = [len(word) for word in name.split() if len(word) <= _LONGEST_WORD]
    return max([_NARROWEST, *numbers, *(words if numbers else [])])


def _has_number(text: str) -> bool:
    """Return whether a cell is a number: `12.5 s`, `row 49`, `3 %`; a name with digits, a sentence, is none."""
    return len(text) <= _LONGEST_NUMBER and any(_NUMBER.fullmatch(word) for word in text.split())


def _cut(text: str, width: int) -> str:
    """Return the text cut in its middle: both ends of a name tell it from its neighbours."""
    if len(text) <= width:
        return text
    tail = (width - 2) // 2
    return f"{text[: width - 2 - tail]}..{text[len(text) - tail :]}"
