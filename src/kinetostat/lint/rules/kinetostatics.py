"""K: kinetostatics. Can the robot do what its joints promise, and do the readers agree on it?"""

from __future__ import annotations

from kinetostat.lint.rule import Rule

__all__ = ["KINETOSTATICS"]

KINETOSTATICS: tuple[Rule, ...] = ()
