"""The difference of two robots as a headline and titled tables, in which names from files are told from our words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kinetostat.errors import cut

if TYPE_CHECKING:
    from kinetostat.analysis.difference.change import Change
    from kinetostat.analysis.difference.dexterity import FamilyChange, PoseIndices
    from kinetostat.analysis.difference.difference import Difference
    from kinetostat.analysis.difference.displacement import Displacement, Extreme, Reach
    from kinetostat.analysis.difference.effort import WorstEffort

__all__ = ["Cell", "Name", "Section", "headline_of", "plain", "sections"]

_SHOWN = 200  # characters of what a file says
_WITNESS = 8  # joints of a witness that are shown
_NAMED = 8  # tips of a row that says the same of several
_ROUNDING = 1e-12  # m
_NO_POSITION = 1e-6  # rad or m: what a search leaves of a zero
_NO_TORQUE = 1e-12  # Nm or N
_NOTHING = {"effort": "not stated", "velocity": "not stated", "lower": "no limit", "upper": "no limit"}


class Name(str):
    """A piece of text that comes from a robot file."""

    __slots__ = ()


Cell = tuple[str, ...]  # pieces: our words, and names
Row = tuple[Cell, ...]


def plain(cell: Cell) -> str:
    """Return a cell as text."""
    return "".join(cut(piece, _SHOWN) if isinstance(piece, Name) else piece for piece in cell)


@dataclass(frozen=True)
class Section:
    """A titled table. `shown`: among what is to be seen first."""

    title: str
    header: tuple[str, ...]
    rows: tuple[Row, ...]
    shown: bool = False


def headline_of(result: Difference) -> Cell:
    """Return the difference in a line, in pieces: how many changes, and the largest displacement."""
    if not result.exceeds:
        return (f"no change beyond the tolerance ({result.tolerance.absolute:g} m and rad, ", *_share(result))
    counted, renamed = len(result.changes), sum(change.kind == "renamed" for change in result.changes)
    pieces = [f"{counted} change{'' if counted == 1 else 's'}"]
    if renamed:
        pieces.append(" (a rename)" if counted == 1 else f" ({renamed} rename{'' if renamed == 1 else 's'})")
    what = result.consequences
    far = [
        (value, unit, tip)
        for unit, found in (
            ("m", [(tip.translation.value, tip.tip) for tip in what.tips]),
            ("rad", [(tip.rotation.value, tip.tip) for tip in what.tips]),
        )
        for value, tip in [max(found, key=lambda one: one[0], default=(0.0, ""))]
        if value > result.tolerance.absolute
    ]
    for i, (value, unit, tip) in enumerate(far):
        pieces += [" and " if i else "; tips move by up to ", f"{value:.4g} {unit} (", Name(tip), ")"]
    overloaded = [one.joint for one in what.worst_gravity if one.overloaded]
    if overloaded:
        pieces += ["; weight alone now takes more than the effort limit of ", *_listed(overloaded[:3])]
    return tuple(pieces)


def _share(result: Difference) -> Cell:
    return (f"share {result.tolerance.relative:g})",)


def sections(result: Difference) -> list[Section]:
    """Return the tables of a difference, empty ones left out."""
    what = result.consequences
    renamed = [change for change in result.changes if change.kind == "renamed"]
    others = [change for change in result.changes if change.kind != "renamed"]
    found = [
        Section("renamed", ("name", "element", "new name"), tuple(map(_renamed, renamed)), shown=True),
        Section("changes", ("name", "what", "change"), tuple(map(_change, others)), shown=True),
        Section(
            "displacement of tips, at equal joint positions",
            ("tip", "moves", "turns", "where"),
            tuple(_folded(map(_displacement, what.tips))),
            shown=True,
        ),
        Section("reach", ("tip", "before", "after", "change"), tuple(_folded(map(_reach, what.reach)))),
        Section(
            "manipulability: smallest singular value, product of all (Yoshikawa); rows of m and rad as they are",
            ("tip", "pose", "block", "smallest", "product"),
            tuple(map(_indices, what.manipulability)),
        ),
        Section(
            "singular families inside limits",
            ("tip", "family", "", "condition"),
            tuple(map(_family, what.singular_families)),
        ),
        Section(
            "worst gravity torque, inside limits",
            ("joint", "torque", "of its limit", ""),
            tuple(map(_worst, what.worst_gravity)),
        ),
    ]
    return [section for section in found if section.rows]


def _folded(rows: Iterator[Row]) -> Iterator[Row]:
    """Yield rows, those that say the same of several tips as one, which names them at its end."""
    same = dict[tuple[Cell, ...], list[Row]]()
    for row in rows:
        same.setdefault(row[1:], []).append(row)
    for group in same.values():
        if len(group) == 1:
            yield group[0]
        else:
            names = [piece for row in group for piece in row[0]]
            last = (*group[0][-1], ": ", *_listed(names[:_NAMED]))
            if len(names) > _NAMED:
                last += (f" and {len(names) - _NAMED} more",)
            yield ((f"{len(names)} tips",), *group[0][1:-1], last)


def _listed(names: Sequence[str]) -> Cell:
    pieces = [piece for name in names for piece in (", ", Name(name))]
    return tuple(pieces[1:])


# --- changes ---------------------------------------------------------------------------------------------------------


def _renamed(change: Change) -> Row:
    return (Name(change.name),), (change.element,), (Name(change.after),)


def _change(change: Change) -> Row:
    return (Name(change.name),), _what(change), _said(change)


def _what(change: Change) -> Cell:
    if change.kind != "changed":
        return (f"{change.element} {change.kind}",)
    if change.element == "state":
        return "state ", Name(change.attribute)
    return (f"{change.element} {change.attribute}",)


def _said(change: Change) -> Cell:
    """Return what changed in words."""
    if change.kind != "changed":
        told = change.before or change.after
        return (Name(told),) if told else ()
    size = "" if change.size is None else f" (by {change.size:.4g}{change.unit and ' '}{change.unit})"
    before, after = _shown(change.before, change.after, _NOTHING.get(change.attribute, "none"))
    if change.element == "state":  # whose joints may have any name, and whose positions are no words of the file
        before, after = str(before), str(after)
    return before, " -> ", after, size


def _shown(before: Any, after: Any, nothing: str) -> tuple[str, str]:
    """Return two values with as many digits as they need to be told apart."""
    for digits in (6, 9, 12, 17):
        shown = _value(before, digits, nothing), _value(after, digits, nothing)
        if shown[0] != shown[1]:
            break
    return shown


def _value(value: Any, digits: int, nothing: str) -> str:
    if value is None:
        return nothing
    if isinstance(value, str):
        return Name(value)
    numbers = value if isinstance(value, tuple) else (value,)
    return " ".join(f"{x:.{digits}g}" for x in numbers)


# --- consequences ----------------------------------------------------------------------------------------------------


def _arrow(before: float, after: float, unit: str = "") -> Cell:
    """Return two numbers with as many digits as they need to be told apart."""
    for digits in (4, 6, 9, 12, 17):
        shown = [f"{value:.{digits}g}" for value in (before, after)]
        if shown[0] != shown[1] or before == after:
            break
    return (f"{shown[0]} -> {shown[1]}{unit and ' '}{unit}",)


def _displacement(tip: Displacement) -> Row:
    extreme = tip.translation if tip.translation.value > _ROUNDING else tip.rotation
    return (Name(tip.tip),), (f"{tip.translation.value:.4g} m",), (f"{tip.rotation.value:.4g} rad",), _where(extreme)


def _where(extreme: Extreme) -> Cell:
    """Return a witness in words."""
    if extreme.everywhere:
        return ("at every joint position",)
    return _positions(extreme.witness, ".4g")


def _positions(positions: dict[str, float], form: str) -> Cell:
    pieces = list[str]()
    for joint, position in list(positions.items())[:_WITNESS]:
        pieces += [" ", Name(joint), f"={format(position if abs(position) > _NO_POSITION else 0.0, form)}"]
    left = len(positions) - _WITNESS
    return (*pieces[1:], *([f" and {left} more"] if left > 0 else []))


def _reach(reach: Reach) -> Row:
    for digits in (4, 6, 9, 12):
        ends = [f"{end.value:.{digits}g} m" for end in (reach.before, reach.after)]
        if ends[0] != ends[1]:
            break
    return (Name(reach.tip),), (ends[0],), (ends[1],), (f"{reach.change:+.4g} m",)


def _indices(one: PoseIndices) -> Row:
    return (Name(one.tip),), (Name(one.pose),), (one.block,), _arrow(*one.smallest), _arrow(*one.yoshikawa)


def _family(family: FamilyChange) -> Row:
    before, after = (_positions(positions or {}, ".6g") for positions in (family.before, family.after))
    surface: Cell = ("a surface of ", *_listed(family.support))
    condition = (*before, " -> ", *after) if family.kind == "moved" else before or after or surface
    cells = (family.name or "without a name",), (family.kind,), (*condition, f" ({family.sort})")
    return (Name(family.tip),), *cells


def _worst(one: WorstEffort) -> Row:
    torques = [value if value > _NO_TORQUE else 0.0 for value in (one.before, one.after)]
    told: Cell = ("more than it has",) if one.overloaded else ()
    return (Name(one.joint),), _arrow(torques[0], torques[1], one.unit), _shares(one), told


def _shares(one: WorstEffort) -> Cell:
    shares = [share and (100 * share if share > _NO_TORQUE else 0.0) for share in (one.share_before, one.share_after)]
    for digits in (3, 5, 9, 12):
        shown = ["no limit" if share is None else f"{share:.{digits}g} %" for share in shares]
        if shown[0] != shown[1]:
            break
    return (" -> ".join(shown),)
