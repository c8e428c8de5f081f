"""T: tree. Do the joints make one tree over the links?"""

from __future__ import annotations

from kinetostat.lint.rule import Rule

__all__ = ["TREE"]

TREE: tuple[Rule, ...] = ()
