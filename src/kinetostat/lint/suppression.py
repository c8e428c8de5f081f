"""Findings that a comment in a file takes back: `<!-- kinetostat: ignore[J103] why -->`.

A comment on its own, or with something after it in its line, counts for the element that starts next, with everything
in that element. One that ends its line counts for what starts in that line before it, and for the element that ends
last before it. Before `<robot>` it counts for the whole file.
"""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from kinetostat.lint.finding import Finding
from kinetostat.urdf.document import Comment, Document, Element

__all__ = ["Suppression", "suppressions", "taken_back"]

_COMMENT = re.compile(r"\s*kinetostat:\s*ignore\s*\[([^\]]*)\]\s*(.*)", re.DOTALL)
_LINE_END = re.compile(r"\r\n|\r|\n")

_Place = tuple[int, int]  # line, column
_Span = tuple[_Place, _Place]


@dataclass(frozen=True)
class Suppression:
    """A comment that takes findings back.

    Attributes:
        line: where the comment starts.
        codes: codes, names or beginnings of codes.
        reason: what it says besides.
        covered: the spans of lines and columns in which it counts, both ends included.
        file: the file, if it is not the robot's own.
    """

    line: int
    codes: tuple[str, ...]
    reason: str
    covered: tuple[_Span, ...]
    file: str = ""


def suppressions(document: Document, file: str = "") -> tuple[Suppression, ...]:
    """Return the suppressions of a file, in file order.

    Args:
        document: the file.
        file: what findings call it; empty for the robot's own.
    """
    matches = [(comment, match) for comment in document.comments if (match := _COMMENT.fullmatch(comment.text))]
    if not matches:
        return ()
    layout = _Layout(document.root)
    return tuple(
        Suppression(
            comment.line,
            tuple(word.strip() for word in match[1].split(",") if word.strip()),
            " ".join(match[2].split()),
            layout.covered(comment),
            file,
        )
        for comment, match in matches
    )


class _Layout:
    """Where the elements of a document start and end."""

    def __init__(self, root: Element) -> None:
        self.elements = list[Element]()
        stack = [root]
        while stack:
            self.elements.append(stack.pop())
            stack.extend(reversed(self.elements[-1].children))
        self.starts = [(each.line, each.column) for each in self.elements]
        # An element in one tag ends where it starts, or just behind: it is the later of those that end there.
        ended = sorted((each.last_line, each.last_column, -i) for i, each in enumerate(self.elements))
        self.ended = [self.elements[-i] for _, _, i in ended]
        self.ends = [(line, column) for line, column, _ in ended]

    def covered(self, comment: Comment) -> tuple[_Span, ...]:
        """Return the spans in which a comment counts."""
        here = comment.line, comment.column
        last = comment.line + len(_LINE_END.findall(comment.text))
        if here < self.starts[0]:
            return (((0, 0), self.ends[-1]),)
        following, over = bisect_right(self.starts, here), bisect_right(self.ends, here)
        starts_here = bisect_left(self.starts, (comment.line, 0)) < following
        ends_here = bisect_left(self.ends, (comment.line, 0)) < over
        starts_after = following < len(self.starts) and self.starts[following][0] == last
        ends_after = over < len(self.ends) and self.ends[over][0] == last
        if (starts_here or ends_here) and not starts_after:
            before = ((comment.line, 0), here)
            block = (self._block(self.ended[over - 1]),) if ends_here else ()
            # Amid the tags of a line it counts only for the element that it follows, not for the whole line.
            return block or (before,) if ends_after else (before, *block)
        return (self._block(self.elements[following]),) if following < len(self.elements) else ()

    def _block(self, element: Element) -> _Span:
        """Return the span of an element; from the beginning of its line if no other comes first there."""
        start = element.line, element.column
        first_there = self.starts[bisect_left(self.starts, (element.line, 0))] == start
        free = bisect_left(self.ends, (element.line, 0)) == bisect_left(self.ends, start)
        return ((element.line, 0) if first_there and free else start), (element.last_line, element.last_column)


def taken_back(
    comments: Sequence[Suppression], findings: Sequence[Finding]
) -> tuple[frozenset[int], frozenset[Suppression]]:
    """Return which of the findings of one file its comments take back (by index), and the comments that do so.

    Each word is asked apart, and looked up by place: there may be 20,000 comments and as many findings.
    """
    words = {word for comment in comments for word in comment.codes}
    places, spans = defaultdict[str, list[tuple[_Place, int]]](list), defaultdict[str, list[_Span]](list)
    for i, finding in enumerate(findings):
        for word in {finding.name, *(finding.code[:n] for n in range(1, len(finding.code) + 1))} & words:
            places[word].append(((finding.line, finding.column), i))
    for found in places.values():
        found.sort()
    used = set[Suppression]()
    for comment in comments:
        for word in set(comment.codes) & places.keys():
            reached = [span for span in comment.covered if _any_within(places[word], span)]
            spans[word] += reached
            if reached:
                used.add(comment)
    return frozenset(_within(places, spans)), frozenset(used)


def _any_within(found: Sequence[tuple[_Place, int]], span: _Span) -> bool:
    """Return whether one of the places, which are sorted, is in a span."""
    i = bisect_left(found, span[0], key=lambda each: each[0])
    return i < len(found) and found[i][0] <= span[1]


def _within(places: Mapping[str, list[tuple[_Place, int]]], spans: Mapping[str, list[_Span]]) -> set[int]:
    """Return the findings that lie in a span of a word that means them."""
    taken = set[int]()
    for word, covered in spans.items():
        reach, waiting = (-1, 0), sorted(covered, reverse=True)
        for place, i in places[word]:
            while waiting and waiting[-1][0] <= place:
                reach = max(reach, waiting.pop()[1])
            if place <= reach:
                taken.add(i)
    return taken
