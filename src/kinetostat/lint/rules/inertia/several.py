"""Telling the same of several links: one by one where they are few, once for the robot where they are many."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from kinetostat.errors import quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Rule
from kinetostat.urdf.document import Element

__all__ = ["also", "named", "several"]

FEW = 3


def several(
    rule: Rule,
    found: Sequence[tuple[Element, str, str]],
    *,
    severity: Severity | None = None,
    attribute: str = "",
    hint: str | None = None,
) -> Iterator[Finding]:
    """Yield a finding for each (element, link, message); a single one, at the first, if there are more than three."""
    for element, link, message in found if len(found) <= FEW else found[:1]:
        others = [name for _, name, _ in found if name != link] if len(found) > FEW else []
        yield rule.finding(element, message + also(others), severity=severity, attribute=attribute, hint=hint)


def also(others: Sequence[str]) -> str:
    """Return the end of a message that says that the same holds for other links; empty without any."""
    if not others:
        return ""
    links = "another link" if len(others) == 1 else f"{len(others)} other links"
    return f"; so it is with {links}: {named(others)}"


def named(names: Sequence[str]) -> str:
    """Return the first three names, quoted."""
    shown = ", ".join(quote(name, 40) for name in names[:FEW])
    return f"{shown}, ..." if len(names) > FEW else shown
