"""The words of expectations, and what is refused of them before any robot is read.

Refusals are ValueErrors that begin with the key: msgspec adds in which table it is.
"""

from __future__ import annotations

from collections.abc import Sequence

from kinetostat.errors import UsageError, cut, quote

__all__ = [
    "at",
    "bounds",
    "check_at",
    "check_order",
    "check_pose",
    "check_range",
    "check_rows",
    "counted",
    "frame",
    "law",
    "load",
    "name",
    "names",
]

Where = str | Sequence[float | str]

_FEW = 3


def name(text: str) -> str:
    """Return a name as it is shown."""
    return quote(text)


def names(given: Sequence[str]) -> str:
    """Return names as they are shown, the first three."""
    more = f" and {len(given) - _FEW} more" if len(given) > _FEW else ""
    return ", ".join(name(one) for one in given[:_FEW]) + more


def frame(of: str, relative_to: str = "") -> str:
    """Return which frame, relative to which other."""
    shown = name(of) if of else "the tip"
    return f"{shown} from {name(relative_to)}" if relative_to else shown


def at(where: Where) -> str:
    """Return at which configurations."""
    if isinstance(where, str):
        return "all states" if where == "states" else cut(where)
    if all(isinstance(one, str) for one in where):
        return names([str(one) for one in where])
    return cut(",".join(f"{one:g}" if isinstance(one, (int, float)) else one for one in where))


def bounds(at_least: float | None, at_most: float | None, unit: str = "") -> str:
    """Return a range in words."""
    ends = [f"{word} {end:.6g}" for word, end in (("at least", at_least), ("at most", at_most)) if end is not None]
    return " and ".join(ends) + (f" {unit}" if unit else "")


def counted(count: int, what: str) -> str:
    """Return how many."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def law(leader: str, multiplier: float, offset: float) -> str:
    """Return how a joint follows its leader."""
    return f"{multiplier:.6g} times {name(leader)}" + (f" {offset:+.6g}" if offset else "")


def load(payload: float, wrench: Sequence[float] | None) -> str:
    """Return what is held."""
    parts = [f"{payload:g} kg"] if payload else []
    if wrench is not None:
        parts.append(f"wrench {','.join(f'{part:g}' for part in wrench)}")
    return " and ".join(parts) or "the links' weight"


def check_at(where: Where) -> None:
    """Refuse a list of configurations that is empty, or that mixes numbers and words.

    Raises:
        ValueError: it is.
    """
    if not isinstance(where, str) and (not where or len({isinstance(one, str) for one in where}) > 1):
        raise ValueError("at: this is a configuration, a list of numbers, or a list of configurations in words")


def check_rows(rows: str) -> None:
    """Refuse rows that there are not.

    Raises:
        ValueError: there are none of that name.
    """
    from kinetostat.analysis.task import Task

    if rows not in ("all", "translation", "rotation"):
        try:
            Task.named(rows)
        except UsageError as error:
            raise ValueError(f"rows: {error}") from None


def check_pose(wanted: str | Sequence[float]) -> None:
    """Refuse what is no pose.

    Raises:
        ValueError: it is none.
    """
    from kinetostat.analysis.inverse.pose import pose

    try:
        pose(wanted)
    except UsageError as error:
        raise ValueError(f"poses: {error}") from None


def check_order(at_least: float | None, at_most: float | None) -> None:
    """Refuse a range whose ends are the wrong way round.

    Raises:
        ValueError: they are.
    """
    if at_least is not None and at_most is not None and at_least > at_most:
        raise ValueError(f"nothing is at least {at_least:g} and at most {at_most:g}")


def check_range(at_least: float | None, at_most: float | None) -> None:
    """Refuse a range without ends, or with ends the wrong way round.

    Raises:
        ValueError: it is one.
    """
    if at_least is None and at_most is None:
        raise ValueError("expects nothing: give at-least, at-most or both")
    check_order(at_least, at_most)
