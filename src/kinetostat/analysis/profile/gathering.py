"""Answers as they are gathered: their certificates, and what could not be answered and why."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from kinetostat.analysis.crosscheck import Certificate, combined
from kinetostat.analysis.profile.anatomy import Left
from kinetostat.errors import KinetostatError, quote

__all__ = ["Gathered"]

_Answer = TypeVar("_Answer")


class Gathered:
    """What is left out so far, and the certificates so far.

    Args:
        certificates: of every answer, by what was asked; more come in.
        limb: the name of the limb whose answers these are; None for the robot's.
    """

    def __init__(self, certificates: dict[str, Certificate], limb: str | None = None) -> None:
        self.left: list[Left] = []
        self._certificates, self._limb = certificates, limb

    def attempt(self, what: str, answer: Callable[[], _Answer]) -> _Answer | None:
        """Return an answer; None where it is refused, which is kept with the reason. Other exceptions are bugs."""
        try:
            return answer()
        except KinetostatError as error:
            self.leave(what, error.message)
            return None

    def leave(self, what: str, why: str) -> None:
        """Keep that something is left out, each thing once."""
        if (one := Left(what, why)) not in self.left:
            self.left.append(one)

    def certify(self, what: str, *certificates: Certificate) -> None:
        """Keep what the engines say of an answer; under one name they come together."""
        name = what if self._limb is None else f"{what} of {quote(self._limb)}"
        before = (self._certificates[name],) if name in self._certificates else ()
        self._certificates[name] = combined([*before, *certificates])
