"""Where in a line a finding points: the columns of its attribute, or of its element's start; the line with a caret."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

from kinetostat.errors import printable
from kinetostat.gate.result import FileCheck
from kinetostat.lint.finding import Finding

__all__ = ["Marked", "columns", "line_of", "marked"]

_LONGEST_SEARCH = 20_000
_ELLIPSIS = "..."
_TAG = re.compile(r"""<(!--|[^\s/<>!?"'=]+)""")
# Possessive, and only where a word starts: a line of 20,000 letters takes no longer than one of 20,000 attributes.
_ATTRIBUTE = re.compile(r"""(?<![^\s/<>"'=])([^\s/<>"'=]++)\s*+=\s*+(?:"[^"]*+"?|'[^']*+'?)""")
_END_OF_TAG = re.compile(r"""(?:[^<>"']++|"[^"]*+(?:"|$)|'[^']*+(?:'|$))*+""")
_LAST_TAG = re.compile(r"<([^\s<>]+)[^<>]*>$")


@dataclass(frozen=True)
class Marked:
    """A line as it is shown, cut to a width; how far in, and how many, the marks below it are."""

    text: str
    indent: int
    marks: int


def line_of(file: FileCheck, finding: Finding) -> str | None:
    """Return the text of the line that a finding points at; None where it is not known."""
    return file.lines.get((finding.file, finding.line))


def columns(text: str, finding: Finding) -> tuple[int, int] | None:
    """Return where in its line a finding points, from 0, the end exclusive; None where nothing is found.

    It is the attribute with its value; without one, or where that is in another line, the start of the element.
    """
    text = text[:_LONGEST_SEARCH]
    start = _start(text, finding)
    if start is None:
        return _lone_attribute(text, finding.attribute)
    tag = _TAG.match(text, start)
    end_of_name = tag.end() if tag else start + 1
    whole = _END_OF_TAG.match(text, end_of_name)
    inside = text[end_of_name : whole.end() if whole else None]
    for found in _ATTRIBUTE.finditer(inside) if finding.attribute else ():
        if found[1] == finding.attribute:
            return end_of_name + found.start(), end_of_name + found.end()
    return start, end_of_name


def _start(text: str, finding: Finding) -> int | None:
    """Return where the element starts in its line: the column that the finding knows, else the first of its tag."""
    if finding.column and text.startswith("<", finding.column):
        return finding.column
    named = _LAST_TAG.search(finding.element)
    if named is not None:
        for found in _TAG.finditer(text):
            if found[1] == named[1]:
                return found.start()
    bare = len(text) - len(text.lstrip())
    return bare if text.startswith("<", bare) and named is None else None


def _lone_attribute(text: str, attribute: str) -> tuple[int, int] | None:
    """Return where an attribute is in a line that does not hold the start of its element."""
    for found in _ATTRIBUTE.finditer(text) if attribute else ():
        if found[1] == attribute:
            return found.span()
    return None


def marked(text: str, span: tuple[int, int] | None, width: int) -> Marked:
    """Return a line, cut around what is to be marked, printable, no wider than `width` columns, and the marks.

    Args:
        text: the line.
        span: what is to be marked, see `columns`.
        width: columns of the terminal that there are.
    """
    skipped = len(text) - len(text.lstrip())
    start, end = (max(part, skipped) for part in span) if span else (skipped, skipped)
    first = _first_shown(text, skipped, start, end, width)
    pieces, left = list[str](), width - (len(_ELLIPSIS) if first > skipped else 0)
    before = marks = 0
    last = first
    while last < len(text):
        piece = _piece(text, last)
        wide = _wide(piece)
        rest = 0 if last == len(text) - 1 else len(_ELLIPSIS)
        if wide > left - rest:
            break
        pieces.append(piece)
        left -= wide
        before += wide if last < start else 0
        marks += wide if start <= last < end else 0
        last += 1
    head = _ELLIPSIS if first > skipped else ""
    tail = _ELLIPSIS if text[last:].strip() else ""
    shown = head + "".join(pieces).rstrip() + tail
    return Marked(shown, len(head) + before, marks)


def _first_shown(text: str, skipped: int, start: int, end: int, width: int) -> int:
    """Return the first character to show, such that what is marked is seen with something before it."""
    upto = min(end, start + width)
    if sum(_wide(_piece(text, i)) for i in range(skipped, upto)) <= width - len(_ELLIPSIS):
        return skipped
    first, room = start, width // 3
    while first > skipped and room > 0:
        first -= 1
        room -= _wide(_piece(text, first))
    return first


def _piece(text: str, at: int) -> str:
    """Return a character of a line as it is shown; the bracket of "##[" would begin a command of GitHub Actions."""
    if text[at] == "[" and text.startswith("##", at - 2):
        return r"\x5b"
    return " " if text[at] == "\t" else printable(text[at])


def _wide(text: str) -> int:
    """Return how many columns of a terminal a printable text takes."""
    if text.isascii():
        return len(text)
    return sum(0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)
