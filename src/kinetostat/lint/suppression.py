"""Findings that a comment in the robot file takes back: `<!-- kinetostat: ignore[J103] why -->`.

A comment counts for what is found in its own line and in the element that starts next, with everything in that element;
before `<robot>` it counts for the whole file.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

from kinetostat.lint.finding import Finding
from kinetostat.urdf.document import Document, Element

__all__ = ["Suppression", "suppressions"]

_COMMENT = re.compile(r"\s*kinetostat:\s*ignore\s*\[([^\]]*)\]\s*(.*)", re.DOTALL)


@dataclass(frozen=True)
class Suppression:
    """A comment that takes findings back: its line, codes or beginnings of codes, its reason, the lines it covers."""

    line: int
    codes: tuple[str, ...]
    reason: str
    covered: tuple[tuple[int, int], ...]

    def covers(self, finding: Finding) -> bool:
        """Return whether it takes a finding back."""
        named = any(code in (finding.code, finding.name) or _begins(finding.code, code) for code in self.codes)
        return named and any(start <= finding.line <= end for start, end in self.covered)


def _begins(code: str, word: str) -> bool:
    return bool(word) and code.startswith(word)


def suppressions(document: Document, elements: Sequence[Element]) -> tuple[Suppression, ...]:
    """Return the suppressions of a file, in file order.

    Args:
        document: the file.
        elements: its elements in file order.
    """
    starts = [element.line for element in elements]
    found = []
    for line, text in document.comments:
        match = _COMMENT.fullmatch(text)
        if match is None:
            continue
        codes = tuple(word.strip() for word in match[1].split(",") if word.strip())
        last = line + text.count("\n")
        after = bisect_right(starts, last)  # the first element that starts in a later line
        alone = last not in starts
        block = ((elements[after].line, elements[after].last_line),) if alone and after < len(elements) else ()
        everything = after == 0 and alone
        covered = ((0, elements[0].last_line),) if everything else ((line, last), *block)
        found.append(Suppression(line, codes, " ".join(match[2].split()), covered))
    return tuple(found)
