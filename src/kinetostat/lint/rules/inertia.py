"""I: inertia. Could these masses and moments be those of real bodies?"""

from __future__ import annotations

from kinetostat.lint.rule import Rule

__all__ = ["INERTIA"]

INERTIA: tuple[Rule, ...] = ()
