"""Names of the left and the right half of a robot: which link is the other one's counterpart."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable

__all__ = ["counterpart", "pairs"]

_END = r"(?=[^A-Za-z]|$)"
_START = r"(?<![A-Za-z])"
# Each finds the letters that say "left": left, l_ and _l, the l of fl and lf (legs), lArm and LArm.
_LEFT = (
    re.compile(r"(?<![a-z])left(?![a-z])|LEFT(?![a-z])|Left(?![a-z])"),
    re.compile(rf"{_START}[lL]{_END}"),
    re.compile(rf"{_START}(?:(?<=\b)|(?<=_))[lL](?=[fFhHbBmM]{_END})"),
    re.compile(rf"(?<=[fFhHbBrRmM])(?<!..[A-Za-z])[lL]{_END}"),
    re.compile(r"^[lL](?=[A-Z])"),
)
_OTHER = {"left": "right", "LEFT": "RIGHT", "Left": "Right", "l": "r", "L": "R"}


def counterpart(name: str) -> list[str]:
    """Return what the right counterpart of a name that says "left" once may be called; nothing if none says so."""
    found = []
    for pattern in _LEFT:
        hits = list(pattern.finditer(name))
        if len(hits) == 1:
            hit = hits[0]
            found.append(name[: hit.start()] + _OTHER[hit[0]] + name[hit.end() :])
    return found


def pairs(names: Iterable[str]) -> list[tuple[str, str]]:
    """Return the (left, right) pairs among names; a name whose counterpart is not clear is left out."""
    known = dict.fromkeys(names)
    found = []
    for name in known:
        partners = {other for other in counterpart(name) if other in known}
        if len(partners) == 1:
            found.append((name, partners.pop()))
    claimed = Counter(right for _, right in found)
    return [(left, right) for left, right in found if claimed[right] == 1]
