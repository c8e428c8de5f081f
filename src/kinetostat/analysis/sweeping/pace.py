"""How fast a run goes and how long it still takes, in words."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Pace", "counted", "lasting"]

_MINUTE, _HOUR, _DAY = 60, 3600, 86400


@dataclass(frozen=True)
class Pace:
    """The pace of a run.

    Attributes:
        rows: configurations in all.
        before: those that were done when it began.
        began: when it began, in seconds of a clock.
    """

    rows: int
    before: int
    began: float

    def rate(self, rows: int, now: float) -> float:
        """Return configurations a second, when `rows` of them are done; 0 where none was done in this run."""
        return (rows - self.before) / max(now - self.began, 1e-9)

    def words(self, rows: int, now: float) -> str:
        """Return for instance '12.4 M of 100 M configurations, 3.1 M/s, 28 s left'."""
        done = f"{counted(rows)} of {counted(self.rows)} configurations"
        rate = self.rate(rows, now)
        if rate <= 0:
            return done
        return f"{done}, {counted(rate)}/s, {lasting((self.rows - rows) / rate)} left"


def counted(number: float) -> str:
    """Return a number in three digits with its power of a thousand: 12.4 M."""
    for size, unit in ((1e9, " G"), (1e6, " M"), (1e3, " k")):
        if number >= 0.9995 * size:
            return f"{_three_digits(number / size)}{unit}"
    return _three_digits(number)


def _three_digits(number: float) -> str:
    return f"{number:.0f}" if number >= 999.5 else f"{number:.3g}"


def lasting(seconds: float) -> str:
    """Return a time in words, by its two largest units: 28 s, 3 min 20 s, 2 h 5 min."""
    seconds = round(seconds)
    if seconds < _MINUTE:
        return f"{seconds:.0f} s"
    if seconds < _HOUR:
        return f"{seconds // _MINUTE:.0f} min {seconds % _MINUTE:.0f} s"
    if seconds < _DAY:
        return f"{seconds // _HOUR:.0f} h {seconds % _HOUR // _MINUTE:.0f} min"
    return f"{seconds // _DAY:.0f} d {seconds % _DAY // _HOUR:.0f} h"
