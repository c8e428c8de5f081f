"""When a report is made: the one thing in it that differs between two runs, unless SOURCE_DATE_EPOCH sets it."""

from __future__ import annotations

import os
import time
from datetime import UTC, datetime

from kinetostat.errors import UsageError, quote

__all__ = ["stamp"]

_SET_BY = "SOURCE_DATE_EPOCH"  # https://reproducible-builds.org/specs/source-date-epoch/


def stamp() -> str:
    """Return the time now, UTC to the second: 2026-11-23T08:00:00Z; or what SOURCE_DATE_EPOCH says, in seconds of 1970.

    Raises:
        UsageError: SOURCE_DATE_EPOCH is no such number.
    """
    given = os.environ.get(_SET_BY)
    try:
        seconds = _whole(given) if given else int(time.time())
        made = datetime.fromtimestamp(seconds, UTC)
    except (ValueError, OverflowError, OSError):
        raise UsageError(
            f"{_SET_BY} is {quote(given or '')}, which is no time", remedy="give whole seconds since 1970, or unset it"
        ) from None
    return f"{made:%Y-%m-%dT%H:%M:%S}Z"


def _whole(text: str) -> int:
    """Return a number of digits alone; int() takes more."""
    if not (text.isascii() and text.isdigit()):
        raise ValueError
    return int(text)
