"""Many findings of one cause are one finding: how they are folded, counted and listed, for all families."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from kinetostat.errors import quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Rule
from kinetostat.urdf.document import Element

__all__ = ["FEW", "Found", "also", "grouped", "listed", "times"]

FEW = 3  # findings of one kind that are told one by one, and names that are listed; beyond it they are counted
_LONGEST = 40  # characters of a name in a list


@dataclass(frozen=True)
class Found:
    """One thing found.

    Attributes:
        at: the element that the finding points at.
        name: of the link, joint or file that it is about, by which it is listed.
        message: what is said of it.
        attribute: the attribute that it is about; may be empty.
    """

    at: Element
    name: str
    message: str
    attribute: str = ""


def grouped(
    rule: Rule,
    found: Sequence[Found],
    *,
    what: str,
    few: int = FEW,
    alike: bool = False,
    severity: Severity | None = None,
    hint: str | None = None,
    file: str = "",
) -> Iterator[Finding]:
    """Yield a finding for each of a few, or one at the first for all of them: many have one reason.

    Args:
        rule: whose findings they are.
        found: what was found, in the order of the file.
        what: what their names are names of, such as "joint".
        few: up to how many are told one by one.
        alike: whether those with the same message are one finding, however few they are.
        severity: if it is not the rule's.
        hint: if it is not the rule's.
        file: the file of the elements, if it is not the robot's own.
    """
    for first, *rest in _groups(found, few, alike=alike):
        yield rule.finding(
            first.at,
            first.message + also([each.name for each in rest], what),
            severity=severity,
            hint=hint,
            attribute=first.attribute,
            file=file,
            several=bool(rest),
        )


def _groups(found: Sequence[Found], few: int, *, alike: bool) -> Sequence[Sequence[Found]]:
    """Return what is told together: each by itself, or those with the same message; all, if these are many."""
    groups: dict[object, list[Found]] = {}
    for i, each in enumerate(found):
        groups.setdefault(each.message if alike else i, []).append(each)
    return list(groups.values()) if len(groups) <= few else [found]


def also(others: Collection[str], what: str) -> str:
    """Return the end of a message that says what else it holds for: `; likewise 2 more joints: 'a', 'b'`."""
    if not others:
        return ""
    plural = "" if len(others) == 1 else "es" if what.endswith("sh") else "s"
    return f"; likewise {len(others)} more {what}{plural}: {listed(others)}"


def listed(names: Collection[str]) -> str:
    """Return the first names, quoted, and how many more there are: `'a', 'b', 'c' and 9 more`."""
    shown = [quote(name, _LONGEST) for name, _ in zip(names, range(FEW), strict=False)]
    more = len(names) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")


def times(count: int) -> str:
    """Return how often, in brackets; nothing if once."""
    return f" ({count} times)" if count > 1 else ""
