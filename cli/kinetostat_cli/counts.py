"""Large counts that users give in options: 100000, 1e8, 100k, 10M, 2G."""

from __future__ import annotations

from decimal import Decimal

from kinetostat.errors import UsageError, quote

__all__ = ["LARGEST", "count"]

LARGEST = 10**12  # of what can be finished: at a microsecond each, twelve days
_THOUSANDS = {"k": 3, "M": 6, "G": 9}


def count(text: str, option: str) -> int:
    """Return the whole number from 1 to 10^12 that an option gives, perhaps as 1e8, 100k, 10M or 2G.

    Raises:
        UsageError: it is none.
    """
    digits, power = (text[:-1], _THOUSANDS[text[-1]]) if text[-1:] in _THOUSANDS else (text, 0)
    try:
        value = Decimal(digits).scaleb(power)
    except ArithmeticError:  # no number, or one that is too long
        value = Decimal("NaN")
    if not value.is_finite() or not 1 <= value <= LARGEST or value != value.to_integral_value():
        remedy = "for instance 100000, 1e8, 100k or 10M"
        raise UsageError(f"{option} takes a whole number from 1 to 10^12, not {quote(text)}", remedy=remedy)
    return int(value)
