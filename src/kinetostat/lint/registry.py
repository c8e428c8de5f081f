"""All rules, listed one by one: there is no other place where a rule is known."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from kinetostat.errors import UsageError, quote, unknown_name
from kinetostat.lint.rule import Rule
from kinetostat.lint.rules.files import FILES
from kinetostat.lint.rules.inertia import INERTIA
from kinetostat.lint.rules.joints import JOINTS
from kinetostat.lint.rules.kinetostatics import KINETOSTATICS
from kinetostat.lint.rules.names import NAMES
from kinetostat.lint.rules.tree import TREE
from kinetostat.lint.rules.xml import XML

__all__ = ["FAMILIES", "RULES", "chosen", "rule"]

FAMILIES = {
    "X": "XML and schema",
    "T": "tree",
    "J": "joints",
    "I": "inertia",
    "M": "files and geometry",
    "N": "names and ROS",
    "K": "kinetostatics",
}
RULES: tuple[Rule, ...] = (*XML, *TREE, *JOINTS, *INERTIA, *FILES, *NAMES, *KINETOSTATICS)


def rule(code: str) -> Rule:
    """Return the rule of a code, or of a name.

    Raises:
        UnknownNameError: there is no such rule.
    """
    for known in RULES:
        if code in (known.code, known.name) or code.upper() == known.code:
            return known
    names = [word for known in RULES for word in (known.code, known.name)]
    raise unknown_name("rule", code, names, listing="'kinetostat rules' lists them")


def chosen(select: Sequence[str] = (), ignore: Sequence[str] = ()) -> tuple[Rule, ...]:
    """Return the rules that a selection leaves: those of `select` (all if empty) that are not in `ignore`.

    Args:
        select: codes, names of rules, or beginnings of codes such as "J" or "J1".
        ignore: the same.

    Raises:
        UsageError: a selector that names no rule.
    """
    _check([*select, *ignore])
    return tuple(r for r in RULES if (not select or matches(r, select)) and not matches(r, ignore))


def matches(known: Rule, selectors: Iterable[str]) -> bool:
    """Return whether one of the selectors means this rule."""
    return any(known.name == word or known.code.startswith(word) for word in selectors)


def _check(selectors: Sequence[str]) -> None:
    for word in selectors:
        if not word or not any(matches(known, [word]) for known in RULES):
            error = unknown_name("rule", word, [w for r in RULES for w in (r.code, r.name)])
            remedy = error.remedy or "'kinetostat rules' lists them; J stands for all of the J family"
            raise UsageError(f"there is no rule {quote(word)}", remedy=remedy)
