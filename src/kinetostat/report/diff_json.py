"""The difference of two robots as a JSON result."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kinetostat.report.json import number

if TYPE_CHECKING:
    from kinetostat.analysis.difference.change import Change
    from kinetostat.analysis.difference.difference import Difference
    from kinetostat.analysis.difference.displacement import Displacement, Extreme

__all__ = ["diff_result"]


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
