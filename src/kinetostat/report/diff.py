"""The difference of two robots, for people and for machines: view, JSON result, Markdown for a pull request."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kinetostat.errors import cut
from kinetostat.report.json import number
from kinetostat.report.view import Table, View

if TYPE_CHECKING:
    from kinetostat.analysis.difference.dexterity import FamilyChange
    from kinetostat.analysis.difference.difference import Difference
    from kinetostat.analysis.difference.displacement import Displacement, Extreme, Reach
    from kinetostat.analysis.difference.structure import Change

__all__ = ["diff_markdown", "diff_result", "diff_view", "headline"]

_ROWS = 60  # of a table in Markdown: a comment on GitHub has at most 65,536 characters
_MOVED = "displacement of tips, at equal joint positions"
_OPEN = ("changes", _MOVED)  # tables that are shown unfolded
_FEW = 20  # rows of them, at most
_SHOWN = 200  # characters of a cell
_LONGEST = 600  # characters of a line
_WITNESS = 8  # joints of a witness that are shown
_ROUNDING = 1e-12  # m
_NO_POSITION = 1e-6  # rad or m: what a search leaves of a zero


@dataclass(frozen=True)
class _Section:
    """A titled table of words, the first column of which holds names."""

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def headline(result: Difference) -> str:
    """Return the difference in a line: how many changes, and the largest displacement."""
    tolerance = f"{result.tolerance.absolute:g} m and rad, share {result.tolerance.relative:g}"
    if not result.exceeds:
        return f"no change beyond the tolerance ({tolerance})"
    counted = len(result.changes)
    text = f"{counted} change{'' if counted == 1 else 's'}"
    tips, least = result.consequences.tips, result.tolerance.absolute
    moved, turned = (max(tips, key=lambda tip: part(tip).value, default=None) for part in (_translation, _rotation))
    far = [
        f"{part(tip).value:.4g} {unit} ({cut(tip.tip)})"
        for tip, part, unit in ((moved, _translation, "m"), (turned, _rotation, "rad"))
        if tip is not None and part(tip).value > least
    ]
    if far:
        text += f"; tips move by up to {' and '.join(far)}"
    overloaded = [one.joint for one in result.consequences.worst_gravity if one.overloaded]
    if overloaded:
        text += f"; weight alone now takes more than the effort limit of {', '.join(map(cut, overloaded[:3]))}"
    return text


def _translation(tip: Displacement) -> Extreme:
    return tip.translation


def _rotation(tip: Displacement) -> Extreme:
    return tip.rotation


def diff_view(result: Difference) -> View:
    """Return the view of a difference."""
    title = f"{cut(result.before)} -> {cut(result.after)}\n{headline(result)}"
    tables = tuple(Table(s.header, s.rows, title=s.title, words=True) for s in _sections(result))
    return View(title, tables, (*result.consequences.unchanged, *result.notes))


# --- rows ------------------------------------------------------------------------------------------------------------


def _sections(result: Difference) -> list[_Section]:
    """Return the tables of a difference, empty ones left out."""
    what = result.consequences
    renamed = [change for change in result.changes if change.kind == "renamed"]
    others = [change for change in result.changes if change.kind != "renamed"]
    sections = [
        _Section("changes", ("name", "element", "what", "change"), tuple(map(_change, others))),
        _Section("renamed", ("name", "element", "new name"), tuple(map(_renamed, renamed))),
        _Section(
            _MOVED,
            ("tip", "largest", "rotation", "where"),
            tuple(map(_displacement, what.tips)),
        ),
        _Section("reach", ("tip", "before", "after", "change"), tuple(map(_reach, what.reach))),
        _Section(
            "manipulability (rows of m and rad as they are in full)",
            ("tip", "pose", "block", "smallest singular value", "Yoshikawa"),
            tuple(
                (cut(i.tip), cut(i.pose), i.block, _arrow(*i.smallest), _arrow(*i.yoshikawa))
                for i in what.manipulability
            ),
        ),
        _Section(
            "singular families inside limits",
            ("tip", "family", "", "condition"),
            tuple(map(_family, what.singular_families)),
        ),
        _Section(
            "worst gravity torque, inside limits",
            ("joint", "torque", "of the effort limit", ""),
            tuple(
                (
                    cut(w.joint),
                    f"{_arrow(w.before, w.after)} {w.unit}",
                    f"{_percent(w.share_before)} -> {_percent(w.share_after)}",
                    "more than it has" if w.overloaded else "",
                )
                for w in what.worst_gravity
            ),
        ),
    ]
    return [section for section in sections if section.rows]


def _change(change: Change) -> tuple[str, ...]:
    return cut(change.name), change.element, _what(change), cut(_said(change), _SHOWN)


def _what(change: Change) -> str:
    return cut(change.attribute) if change.kind == "changed" else change.kind


def _said(change: Change) -> str:
    """Return what changed in words."""
    if change.kind != "changed":
        return str(change.before or change.after or "")
    before, after = _shown(change.before, change.after)
    size = "" if change.size is None else f" (by {change.size:.4g}{change.unit and ' '}{change.unit})"
    return f"{before} -> {after}{size}"


def _shown(before: Any, after: Any) -> tuple[str, str]:
    """Return two values with as many digits as they need to be told apart."""
    for digits in (6, 9, 12, 17):
        shown = _value(before, digits), _value(after, digits)
        if shown[0] != shown[1]:
            break
    return shown


def _value(value: Any, digits: int) -> str:
    if value is None:
        return "none"
    if isinstance(value, str):
        return value
    numbers = value if isinstance(value, tuple) else (value,)
    return " ".join(f"{x:.{digits}g}" for x in numbers)


def _arrow(before: float, after: float) -> str:
    return " -> ".join(f"{value:.4g}" for value in (before, after))


def _percent(share: float | None) -> str:
    return "no limit" if share is None else f"{100 * share:.3g} %"


def _renamed(change: Change) -> tuple[str, ...]:
    return cut(change.name), change.element, cut(str(change.after))


def _displacement(tip: Displacement) -> tuple[str, ...]:
    extreme = tip.translation if tip.translation.value > _ROUNDING else tip.rotation
    return cut(tip.tip), f"{tip.translation.value:.4g} m", f"{tip.rotation.value:.4g} rad", _where(extreme)


def _where(extreme: Extreme) -> str:
    """Return a witness in words."""
    if extreme.everywhere:
        return "at every joint position"
    named = [
        f"{cut(joint)}={position if abs(position) > _NO_POSITION else 0:.4g}"
        for joint, position in extreme.witness.items()
    ]
    return " ".join(named[:_WITNESS]) + (f" and {len(named) - _WITNESS} more" if len(named) > _WITNESS else "")


def _reach(reach: Reach) -> tuple[str, ...]:
    ends = (f"{end.value:.6g} m" for end in (reach.before, reach.after))
    return cut(reach.tip), *ends, f"{reach.change:+.4g} m"


def _family(family: FamilyChange) -> tuple[str, ...]:
    before, after = (_condition(positions) for positions in (family.before, family.after))
    about = f"a surface of {' '.join(map(cut, family.support))}"
    condition = f"{before} -> {after}" if family.kind == "moved" else before or after or about
    return cut(family.tip), family.name or "without a name", family.kind, f"{condition} ({family.sort})"


def _condition(positions: dict[str, float] | None) -> str:
    return " ".join(f"{cut(joint)}={value:.6g}" for joint, value in (positions or {}).items())


# --- JSON ------------------------------------------------------------------------------------------------------------


def diff_result(result: Difference) -> dict[str, Any]:
    """Return the result object of `diff`: lengths in m, angles in rad."""
    what = result.consequences
    return {
        "exceeds": result.exceeds,
        "tolerance": {"absolute": result.tolerance.absolute, "relative": result.tolerance.relative},
        "changes": [_change_result(change) for change in result.changes],
        "consequences": {
            "tips": {tip.tip: _tip_result(tip) for tip in what.tips},
            "reach": {
                reach.tip: {
                    "relative_to": reach.relative_to,
                    "before": reach.before.value,
                    "after": reach.after.value,
                    "change": reach.change,
                    "unit": "m",
                    "witness_before": reach.before.witness,
                    "witness_after": reach.after.witness,
                }
                for reach in what.reach
            },
            "manipulability": [
                {
                    "tip": one.tip,
                    "pose": one.pose,
                    "block": one.block,
                    "unit": one.unit,
                    "minimum_singular_value": {"before": one.smallest[0], "after": one.smallest[1]},
                    "yoshikawa": {"before": one.yoshikawa[0], "after": one.yoshikawa[1]},
                }
                for one in what.manipulability
            ],
            "singular_families": [
                {
                    "kind": one.kind,
                    "tip": one.tip,
                    "name": one.name,
                    "support": list(one.support),
                    "before": one.before,
                    "after": one.after,
                    "sort": one.sort,
                }
                for one in what.singular_families
            ],
            "worst_gravity": {
                one.joint: {
                    "unit": one.unit,
                    "before": one.before,
                    "after": one.after,
                    "utilisation_before": one.share_before,
                    "utilisation_after": one.share_after,
                    "witness": one.witness,
                }
                for one in what.worst_gravity
            },
            "unchanged": list(what.unchanged),
        },
        "notes": list(result.notes),
    }


def _change_result(change: Change) -> dict[str, Any]:
    before, after = (list(value) if isinstance(value, tuple) else value for value in (change.before, change.after))
    return {
        "kind": change.kind,
        "element": change.element,
        "name": change.name,
        "attribute": change.attribute or None,
        "before": before,
        "after": after,
        "size": number(change.size),
        "unit": change.unit or None,
    }


def _tip_result(tip: Displacement) -> dict[str, Any]:
    return {
        "name_after": tip.other,
        "relative_to": tip.relative_to,
        "translation": {"value": tip.translation.value, "unit": "m", **_extreme_result(tip.translation)},
        "rotation": {"value": tip.rotation.value, "unit": "rad", **_extreme_result(tip.rotation)},
    }


def _extreme_result(extreme: Extreme) -> dict[str, Any]:
    return {"witness": extreme.witness, "everywhere": extreme.everywhere}


# --- Markdown --------------------------------------------------------------------------------------------------------


def diff_markdown(result: Difference, lines: Sequence[str] = ()) -> str:
    """Return the difference as a comment for a pull request: a headline, the changes, the rest folded.

    Whatever comes from a robot file is set as code, or spelled out, so that it is no markup, link or mention.

    Args:
        result: the difference.
        lines: what else is to be said, such as the certificate.
    """
    mark = "changed" if result.exceeds else "unchanged"
    ends = f"{_code(result.before)} → {_code(result.after)}"
    blocks = [f"### kinetostat diff: {mark}", f"{ends}: {_words(headline(result))}"]
    for section in _sections(result):
        open_ = section.title in _OPEN and len(section.rows) <= _FEW
        blocks.append(f"**{section.title}**\n\n{_table(section)}" if open_ else _folded(section))
    said = [*result.consequences.unchanged, *result.notes, *lines]
    if said:
        listed = "\n".join(f"- {_words(line)}" for line in said)
        blocks.append(f"<details><summary>the rest</summary>\n\n{listed}\n\n</details>")
    return "\n\n".join(blocks) + "\n"


def _folded(section: _Section) -> str:
    summary = f"{section.title}: {len(section.rows)}"
    return f"<details><summary>{summary}</summary>\n\n{_table(section)}\n\n</details>"


def _table(section: _Section) -> str:
    lines = [_row(section.header), _row("---" for _ in section.header)]
    lines += [_row((_code(row[0]), *map(_words, row[1:]))) for row in section.rows[:_ROWS]]
    text = "\n".join(lines)
    left = len(section.rows) - _ROWS
    return f"{text}\n\n… and {left} more" if left > 0 else text


def _row(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


_HARMLESS = re.compile(r"[(]?(?:[A-Za-z]+(?:/[a-z0-9]+)?|[-+]?[0-9][-+0-9.e]*|->|%)[),.:;]*")


def _words(text: str) -> str:
    """Return text with plain words and numbers as they are, all else as code."""
    return " ".join(
        word.replace("->", "→") if _HARMLESS.fullmatch(word) else _code(word) for word in cut(text, _LONGEST).split()
    )


def _code(text: str) -> str:
    """Return text as code: nothing in it is markup. What would end the code, or the cell, is spelled as an entity."""
    shown = cut(text, _SHOWN)
    if not shown:
        return ""
    if any(sign in shown for sign in "`|\\"):
        return f"<code>{''.join(c if c.isalnum() or c == ' ' else f'&#{ord(c)};' for c in shown)}</code>"
    return f"`{shown}`"
