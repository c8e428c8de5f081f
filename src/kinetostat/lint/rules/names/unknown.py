"""What the rules about references share: names of what is not there, told one by one or, if many, together."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator

from kinetostat.errors import quote, unknown_name
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import FEW, listed, times
from kinetostat.lint.rule import Rule
from kinetostat.urdf.document import Element

__all__ = ["unknown"]

_LONG = 100  # letters: comparing longer names, or more of them, takes too long
_MANY = 2000
_SLIP = 4  # letters that a misspelt name is longer or shorter


def unknown(
    rule: Rule,
    kind: str,
    uses: Iterable[tuple[Element, str]],
    known: Collection[str],
    *,
    attribute: str = "",
    file: str = "",
    severity: Severity | None = None,
    where: str = "in the robot",
) -> Iterator[Finding]:
    """Yield the names that are used and not known, each at its first use.

    Args:
        rule: whose findings they are.
        kind: what the names should be names of, such as "link".
        uses: elements with the names that they use.
        known: the names that there are.
        attribute: that holds the name.
        file: the file of the elements, if it is not the robot's own.
        severity: if it is not the rule's.
        where: where the names should be.
    """
    lost: dict[str, list[Element]] = {}
    for element, name in uses:
        if name not in known:
            lost.setdefault(name, []).append(element)
    if len(lost) > FEW:
        first = next(iter(lost.values()))[0]
        many = " or ".join(f"{word}s" for word in kind.split(" or "))
        message = f"{len(lost)} names of {many} are not {where}: {listed(list(lost))}"
        yield rule.finding(first, message, attribute=attribute, file=file, severity=severity)
        return
    for name, elements in lost.items():
        message = f"{kind} {quote(name)} is not {where}" if name else f"no {kind} is named"
        message += times(len(elements))
        hint = _nearest(kind, name, known) or rule.hint
        yield rule.finding(elements[0], message, hint=hint, attribute=attribute, file=file, severity=severity)


def _nearest(kind: str, name: str, known: Collection[str]) -> str | None:
    """Return a hint at the names that are nearly the same."""
    if not name or len(name) > _LONG or len(known) > _MANY:
        return None
    lengths = range(len(name) - _SLIP, len(name) + _SLIP + 1)
    hint = unknown_name(kind, name, [each for each in known if len(each) in lengths]).remedy
    return hint if hint and hint.startswith("did you mean") else None
