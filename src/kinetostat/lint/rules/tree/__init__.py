"""T: tree. Do the joints make one tree over the links?"""

from __future__ import annotations

from kinetostat.lint.rule import Rule
from kinetostat.lint.rules.tree.kinds import KINDS
from kinetostat.lint.rules.tree.shape import SHAPE

__all__ = ["TREE"]

TREE: tuple[Rule, ...] = (*SHAPE, *KINDS)
