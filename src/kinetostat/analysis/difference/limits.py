"""How what is stated of a joint's limits changed: what was stated and is not any more has, whatever the tolerance."""

from __future__ import annotations

import math
from collections.abc import Iterator

from kinetostat.analysis.difference.change import Change, Tolerance
from kinetostat.errors import quote
from kinetostat.urdf.description import Joint

__all__ = ["limit_changes", "swapped_limits"]


def limit_changes(ours: Joint, theirs: Joint, tolerance: Tolerance) -> Iterator[Change]:
    """Yield what changed of the limits of a joint that both robots have.

    Lower and upper are compared as they are stated: swapped, they are read as the same range, by us and not by all.

    Args:
        ours: the joint in A.
        theirs: in B.
        tolerance: what does not count.
    """
    if ours.type.nq != theirs.type.nq or ours.type.is_angle != theirs.type.is_angle:
        return  # a new type says it all: the units are others
    unit, effort = ("rad", "Nm") if ours.type.is_angle else ("m", "N")
    stated = [("effort", effort, tolerance.differ), ("velocity", f"{unit}/s", tolerance.differ)]
    if ours.type.nq == 1:
        stated = [("lower", unit, tolerance.apart), ("upper", unit, tolerance.apart), *stated]
    for what, unit_of, differ in stated:
        before, after = (_stated(getattr(joint.limit, what)) for joint in (ours, theirs))
        if before is None or after is None:
            if before is not after:
                yield Change("changed", "joint", ours.name, what, before, after, None, unit_of)
        elif differ(before, after):
            yield Change("changed", "joint", ours.name, what, before, after, abs(after - before), unit_of)


def swapped_limits(ours: Joint, theirs: Joint) -> str | None:
    """Return what is to be said where lower and upper are the wrong way round in one of two robots; None if not."""
    was, now = ours.limit.swapped, theirs.limit.swapped
    if was is now:
        return None
    named = f"joint {quote(ours.name)}"
    if now:
        return f"{named}: lower is above upper now: read the other way round here, refused or locked by other tools"
    return f"{named}: lower was above upper, and is not any more"


def _stated(value: float | None) -> float | None:
    """Return a limit; None where there is none, infinite ones being none."""
    return None if value is None or not math.isfinite(value) else value
