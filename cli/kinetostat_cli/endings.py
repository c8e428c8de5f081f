"""Endings of output files that say another format than what would be written."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

__all__ = ["refuse_ending"]


def refuse_ending(output: Path | None, remedies: Mapping[str, str]) -> None:
    """Refuse a file whose ending contradicts what goes into it; any other ending is the user's own.

    Args:
        output: the file of -o, or None; `-` and pipes have no ending.
        remedies: endings that would be wrong here, such as ".json", each with what to do instead, such as "-F json".

    Raises:
        UsageError: the ending is one of them.
    """
    if output is None or output.suffix.lower() not in remedies:
        return
    from kinetostat.errors import UsageError, quote

    ending = output.suffix.lower()
    raise UsageError(f"{quote(str(output))}: these options write no {ending} file", remedy=remedies[ending])
