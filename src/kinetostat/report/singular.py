"""Singular configurations to views and to JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.singular.dependence import listed
from kinetostat.conventions import WRENCH_ROWS, quarter_turns
from kinetostat.errors import cut
from kinetostat.report.json import nested, number
from kinetostat.report.view import Cell, Table, View, configuration_note

if TYPE_CHECKING:
    from kinetostat.analysis.configuration import Configuration
    from kinetostat.analysis.singular.at import SingularAt
    from kinetostat.analysis.singular.find import Coverage, Family, SingularFamilies
    from kinetostat.analysis.singular.mechanism import Mechanism
    from kinetostat.analysis.singular.nearest import Nearest

__all__ = ["condition_words", "singular_at_result", "singular_at_view", "singular_find_result", "singular_find_view"]


# --- in words --------------------------------------------------------------------------------------------------


def condition_words(
    arm: Mechanism, positions: Mapping[str, float], support: Sequence[str], codimension: int, *, degrees: bool
) -> str:
    """Return a condition in the file's own angles: `joint3 = 0`, and what else a surface is about."""
    held = [f"{cut(joint)} = {_position(arm, joint, value, degrees)}" for joint, value in positions.items()]
    others = [joint for joint in support if joint not in positions]
    words = " and ".join(held)
    if not others:
        return words
    count = codimension - len(held)
    relation = f"a relation of {listed(others)}" if count < 2 else f"{count} relations of {listed(others)}"
    return f"{words}, with {relation}" if held else relation


def _position(arm: Mechanism, joint: str, value: float, degrees: bool) -> str:
    """Return a position; multiples of a quarter turn as such."""
    if not arm.turning[arm.names.index(joint)]:
        return f"{value:.6g} m"
    if degrees:
        return f"{math.degrees(value):.6g} deg"
    return quarter_turns(value) or f"{value:.6g}"


def _rows(arm: Mechanism) -> str:
    rows = " ".join(arm.task.row_names)
    return "all six rows count" if len(arm.task.rows) == 6 else f"rows that count: {rows}"


def _place(arm: Mechanism) -> str:
    velocity = arm.velocity
    axes = f" in the axes of {cut(velocity.of)}" if arm.local and len(arm.task.rows) < 6 else ""
    return f"{cut(velocity.of)} relative to {cut(velocity.relative_to)}; {_rows(arm)}{axes}"


def _values(values: Any) -> str:
    return " ".join(f"{float(value):.4g}" if value > 1e-14 else "0" for value in values)


# --- at a configuration ----------------------------------------------------------------------------------------


def singular_at_view(result: SingularAt, at: Configuration, *, degrees: bool) -> View:
    """Return the view: the verdict, then why, what is lost, what moves inside, and how far the next one is."""
    arm = result.mechanism
    return View(
        f"{_verdict(result)}\n{_place(arm)}",
        (
            _facts(result),
            *_why(result, degrees),
            *_lost(result),
            *_inside(result),
            *_nearest(arm, result.distance, result.q, degrees),
        ),
        (configuration_note(at, degrees),),
        flat=_flat_at(result),
    )


def _verdict(result: SingularAt) -> str:
    if not result.singular:
        away = result.distance.distance
        near = away is not None and away < _NEAR
        return f"not singular, but {_angle(away, False)} from it" if near and away is not None else "not singular"
    name = f" ({result.name})" if result.name else ""
    return f"singular{name}: {result.kind}"


def _facts(result: SingularAt) -> Table:
    arm = result.mechanism
    rows: list[tuple[Cell, ...]] = [
        ("rank", f"{result.rank} here, {arm.generic_rank} at almost every configuration"),
        (
            "singular values",
            f"{_values(result.singular_values)} (lengths in units of {arm.length:.4g} m{_taken_at(arm)})",
        ),
    ]
    if result.tolerance is not None:
        met = "zero in exact numbers (below 1e-9)" if result.tolerance == "strict" else _ROUNDED
        rows.append(("tolerance", met))
    if result.kind is not None:
        rows.append(("kind", f"{result.kind}: {_KINDS[result.kind]}"))
    return Table(("", ""), tuple(rows), words=True)


_ABREAST = 4  # motions in a table
_NEAR = 0.01  # rad
_FAR = 1.0  # rad: beyond, a first-order estimate tells nothing
_ROUNDED = "zero but for rounding (below 1e-5): a model or an angle with few digits"
_KINDS = {
    "fold": "seen from one side; two branches of inverse kinematics meet",
    "boundary": "seen from one side, whatever the arm does inside",
    "traversable": "the arm can pass, or leave it by moving inside",
    "tangential": "the arm moves inside without leaving it, to second order",
}


def _taken_at(arm: Mechanism) -> str:
    """Return at which point, if it is not the tool point: ranks are the same at any, where all rows count."""
    point = np.round(arm.velocity.point or arm.point, 9) + 0.0
    if np.allclose(point, arm.point, atol=1e-9):
        return ""
    return f", at the point ({', '.join(f'{c:.4g}' for c in point)}) of {cut(arm.velocity.of)}, amid the axes"


def _why(result: SingularAt, degrees: bool) -> list[Table]:
    arm, rows = result.mechanism, list[tuple[Cell, ...]]()
    for condition in result.conditions:
        count = len(condition.positions)
        words = condition_words(arm, condition.positions, tuple(condition.positions), count, degrees=degrees)
        name = f" ({condition.name})" if condition.name else ""
        rows.append((f"{words}, whatever the other joints do{name}",))
    rows += [(cause.text,) for cause in result.causes]
    return [Table(("why",), tuple(rows), words=True)] if rows else []


def _lost(result: SingularAt) -> list[Table]:
    if not result.lost:
        return []
    words: tuple[tuple[Cell, ...], ...] = tuple((wrench.words,) for wrench in result.lost)
    numbers: list[tuple[Cell, ...]] = [(f"wrench {i + 1}", *map(float, w.wrench)) for i, w in enumerate(result.lost)]
    return [
        Table(("what is lost",), words, words=True),
        Table(("no joint feels", *WRENCH_ROWS), tuple(numbers), ("", *"NNN", *["Nm"] * 3)),
    ]


def _inside(result: SingularAt) -> list[Table]:
    if not result.self_motions:
        return []
    arm = result.mechanism
    everywhere = len(arm.names) - arm.generic_rank
    rest = "with the tool at rest" if len(arm.task.rows) == 6 else f"that leave {' '.join(arm.task.row_names)} at 0"
    shown = f"what moves inside: joint rates {rest}"
    if everywhere:
        shown += f" ({everywhere} of them at every configuration)"
    motions = list(enumerate(result.self_motions, start=1))
    tables = []
    for first in range(0, len(motions), _ABREAST):
        some = motions[first : first + _ABREAST]
        rows: list[tuple[Cell, ...]] = []
        for i, name in enumerate(arm.names):
            unit = "rad/s" if arm.turning[i] else "m/s"
            rows.append((name, unit, *(f"{round(float(m.rates[i]), 5) + 0.0:.5f}" for _, m in some)))
        rows.append(("", "", *("finite" if m.finite else "instant" for _, m in some)))
        header = ("joint", "unit", *(f"motion {number}" for number, _ in some))
        tables.append(Table(header, tuple(rows), title="" if first else shown, words=True))
    return tables


def _nearest(arm: Mechanism, found: Nearest, start: Any, degrees: bool) -> list[Table]:
    if found.distance == 0.0:
        return []
    estimate = _angle(found.first_order, degrees) if found.first_order < _FAR else "none (too far for one)"
    rows: list[tuple[Cell, ...]] = [("first-order estimate", estimate)]
    if found.distance is None or found.q is None:
        rows.append(("nearest found", "none"))
    else:
        where = "inside limits" if found.inside_limits else "outside limits"
        rows.append(
            ("nearest found", f"{_angle(found.distance, degrees)}, {where}: {_moves(arm, found.q, start, degrees)}")
        )
    if found.inside is not None:
        away, q = found.inside
        rows.append(("nearest inside limits", f"{_angle(away, degrees)}: {_moves(arm, q, start, degrees)}"))
    slides = "" if all(arm.turning) else f", slides in units of {arm.length:.4g} m"
    return [Table(("distance", f"in joint space{slides}"), tuple(rows), words=True)]


def _angle(value: float, degrees: bool) -> str:
    return f"{math.degrees(value):.5g} deg" if degrees else f"{value:.5g} rad"


def _moves(arm: Mechanism, q: Any, start: Any, degrees: bool) -> str:
    """Return the joints that move, from where to where."""
    moved = []
    for joint, value, before in zip(arm.names, q, start, strict=True):
        if value != before:
            old, new = (_position(arm, joint, float(x), degrees) for x in (before, value))
            moved.append(f"{cut(joint)} {old} -> {new}")
    return ", ".join(moved)


def _flat_at(result: SingularAt) -> Table:
    """Return one row, for CSV."""
    arm, distance = result.mechanism, result.distance
    header = (
        "frame",
        "relative_to",
        "singular",
        "tolerance",
        "rank",
        "generic_rank",
        "smallest",
        "name",
        "kind",
        "distance",
    )
    row: tuple[Cell, ...] = (
        arm.velocity.of,
        arm.velocity.relative_to,
        str(result.singular).lower(),
        result.tolerance or "",
        str(result.rank),
        str(arm.generic_rank),
        float(result.singular_values[arm.generic_rank - 1]),
        result.name or "",
        result.kind or "",
        distance.distance,
    )
    return Table(header, (row,), ("",) * 9 + ("rad",))


# --- all of them -----------------------------------------------------------------------------------------------


def singular_find_view(result: SingularFamilies, *, degrees: bool) -> View:
    """Return the view: the families inside limits, those outside, and how complete the list is."""
    arm = result.mechanism
    numbered = list(enumerate(result.families, start=1))
    tables = [
        Table(
            ("", "name", "codim", "kind", "hits", "condition"),
            tuple((str(i), *_family_row(arm, f, degrees)) for i, f in numbered if f.inside_limits is inside),
            title=title,
            words=True,
        )
        for title, inside in (("inside joint limits", True), ("outside joint limits", False))
        if any(f.inside_limits is inside for _, f in numbered)
    ]
    tables += [_why_families(result.families)] if any(family.causes for family in result.families) else []
    where = f"of {_place(arm)}"
    count = len(result.families)
    families = "no singular configurations" if not count else "one family" if count == 1 else f"{count} families"
    title = f"{families} {where}" if not count else f"{families} of singular configurations {where}"
    return View(title, tuple(tables), _coverage(result), flat=_flat_find(result, degrees))


def _family_row(arm: Mechanism, family: Family, degrees: bool) -> tuple[Cell, ...]:
    words = condition_words(arm, family.positions, family.support, family.codimension, degrees=degrees)
    rounded = " (rounded)" if family.tolerance == "model" else ""
    kind = "mixed" if " or " in family.kind else family.kind
    return family.name or "-", str(family.codimension), kind, str(family.hits), words + rounded


def _why_families(families: Sequence[Family]) -> Table:
    """Return the causes at the witnesses, each with the numbers of the families that have it."""
    numbers: dict[str, list[str]] = {}
    for i, family in enumerate(families, start=1):
        for cause in family.causes[:3]:
            numbers.setdefault(cause.text, []).append(str(i))
    rows = tuple((f"{', '.join(which)}: {text}",) for text, which in numbers.items())
    return Table(("why, at their witnesses",), rows, words=True)


def _coverage(result: SingularFamilies) -> tuple[str, ...]:
    coverage, arm = result.coverage, result.mechanism
    lost = f"; {result.unclassified} of them close to where families meet, in none" if result.unclassified else ""
    notes = [
        f"{result.converged} of {result.starts} searches ended in a singular configuration{lost} (hits: how many ended "
        "on a family; codim: how many equations its condition is)"
    ]
    missing = ", ".join(cut(name) for name in coverage.incomplete)
    but = f", but not of {missing}" if missing else ""
    slides = "" if all(arm.periodic) else "; of slides and screws, inside their range and one range beyond"
    found = (
        "conditions on one joint alone are complete"
        if any(f.complete for f in result.families)
        else ("no joint alone makes it singular: that is complete")
    )
    if coverage.complete:
        notes.append(f"{found} (common roots of polynomials{slides}){but}")
    if coverage.unseen is not None:
        notes.append(f"all others are statistical: {_chance(coverage, result)}")
    return tuple(notes)


def _chance(coverage: Coverage, result: SingularFamilies) -> str:
    """Return what the hits say of families that no search has ended on."""
    if coverage.seen_once:
        return f"a further search would end on an unseen family with a chance of {coverage.unseen:.2g} (Good-Turing)"
    share = (3 + result.unclassified) / result.converged
    return f"no family was seen only once, so unseen ones have a share below {min(share, 1.0):.1g} (95 %)"


def _flat_find(result: SingularFamilies, degrees: bool) -> Table:
    """Return one row a family, for CSV."""
    arm = result.mechanism
    rows: list[tuple[Cell, ...]] = [
        (
            condition_words(arm, family.positions, family.support, family.codimension, degrees=degrees),
            family.name or "",
            family.kind,
            str(family.codimension),
            family.tolerance,
            str(family.inside_limits).lower(),
            str(family.hits),
            float(family.singular_values[arm.generic_rank - 1]),
        )
        for family in result.families
    ]
    header = ("condition", "name", "kind", "codimension", "tolerance", "inside_limits", "hits", "smallest")
    return Table(header, tuple(rows))


# --- JSON ------------------------------------------------------------------------------------------------------


def singular_at_result(result: SingularAt) -> dict[str, Any]:
    """Return the result object of `singular at`: m, rad, N, Nm; singular values are pure numbers."""
    payload: dict[str, Any] = {
        **_mechanism(result.mechanism),
        "singular": result.singular,
        "tolerance": result.tolerance,
        "rank": result.rank,
        "generic_rank": result.mechanism.generic_rank,
        "singular_values": nested(result.singular_values),
        "lost": [_wrench(wrench) for wrench in result.lost],
        "self_motions": [_by_joint(result.mechanism, motion.rates) for motion in result.self_motions],
        "self_motions_finite": [motion.finite for motion in result.self_motions],
        "kind": result.kind,
        "name": result.name,
        "causes": [{"text": cause.text, "joints": list(cause.joints)} for cause in result.causes],
        "conditions": [{"positions": c.positions, "name": c.name} for c in result.conditions],
        "distance": _distance(result),
    }
    if not result.singular:
        payload["kind_reason"] = "the configuration is not singular"
    return payload


def _mechanism(arm: Mechanism) -> dict[str, Any]:
    return {
        "frame": arm.velocity.of,
        "relative_to": arm.velocity.relative_to,
        "point": list(arm.point),
        "reference_point": list(arm.velocity.point or arm.point),
        "expressed_in": arm.velocity.expressed_in,
        "rows": list(arm.task.row_names),
        "columns": list(arm.names),
        "characteristic_length": arm.length,
    }


def _by_joint(arm: Mechanism, values: Any) -> dict[str, float]:
    return {name: float(value) + 0.0 for name, value in zip(arm.names, values, strict=True)}


def _wrench(wrench: Any) -> dict[str, Any]:
    payload = {
        "wrench": nested(wrench.wrench),
        "axis": nested(wrench.axis),
        "point": None if wrench.point is None else nested(wrench.point),
        "pitch": number(wrench.pitch),
        "words": wrench.words,
    }
    if wrench.point is None:
        payload["reason"] = "a couple: its pitch is infinite, and it has no line"
    return payload


def _distance(result: SingularAt) -> dict[str, Any]:
    found, arm = result.distance, result.mechanism
    payload: dict[str, Any] = {
        "radians": found.distance,
        "configuration": None if found.q is None else _by_joint(arm, found.q),
        "inside_limits": found.inside_limits,
        "first_order": number(found.first_order),
    }
    if found.distance is None:
        payload["reason"] = "no singular configuration was found"
    if found.inside is not None:
        away, q = found.inside
        payload["nearest_inside_limits"] = {"radians": away, "configuration": _by_joint(arm, q)}
    return payload


def singular_find_result(result: SingularFamilies) -> dict[str, Any]:
    """Return the result object of `singular find`: m, rad; singular values are pure numbers."""
    arm, coverage = result.mechanism, result.coverage
    return {
        **_mechanism(arm),
        "generic_rank": arm.generic_rank,
        "families": [_family(arm, family) for family in result.families],
        "starts": result.starts,
        "converged": result.converged,
        "unclassified": result.unclassified,
        "coverage": {
            "complete_for_single_joints": list(coverage.complete),
            "incomplete_for_single_joints": list(coverage.incomplete),
            "families_seen_once": coverage.seen_once,
            "good_turing_unseen": coverage.unseen,
        },
    }


def _family(arm: Mechanism, family: Family) -> dict[str, Any]:
    return {
        "condition": condition_words(arm, family.positions, family.support, family.codimension, degrees=False),
        "positions": family.positions,
        "support": list(family.support),
        "implicit": family.implicit,
        "codimension": family.codimension,
        "kind": family.kind,
        "name": family.name,
        "causes": [{"text": cause.text, "joints": list(cause.joints)} for cause in family.causes],
        "tolerance": family.tolerance,
        "inside_limits": family.inside_limits,
        "complete": family.complete,
        "witness": {
            "configuration": _by_joint(arm, family.witness),
            "singular_values": nested(family.singular_values),
        },
        "hits": family.hits,
    }
