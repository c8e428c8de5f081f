"""Names that stand together in a figure, short and still told apart."""

from __future__ import annotations

from collections.abc import Sequence

from kinetostat.errors import printable
from kinetostat.report.figures.sheet import named

__all__ = ["told_apart"]


def told_apart(names: Sequence[str], longest: int) -> list[str]:
    """Return names as a figure shows them, cut to a length.

    A name that is too long loses its end, as elsewhere; but its middle where another name begins as what would be left
    of it: standing...m_home beside standing_with_arm_up.
    """
    return [_shown(name, longest, [*names[:i], *names[i + 1 :]]) for i, name in enumerate(names)]


def _shown(name: str, longest: int, others: Sequence[str]) -> str:
    text = printable(name)
    begin = (longest - 3) // 2
    if len(text) <= longest or not any(printable(other).startswith(text[: longest - 3]) for other in others):
        return named(text, longest)
    return named(f"{text[:begin]}...{text[-(longest - 3 - begin) :]}", longest)
