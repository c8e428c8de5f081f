"""M: files and geometry. Is what the robot file names there? Existence and headers only: meshes are not analysed."""

from __future__ import annotations

from kinetostat.lint.rule import Rule
from kinetostat.lint.rules.files.content import CONTENT
from kinetostat.lint.rules.files.lookup import LOOKUP
from kinetostat.lint.rules.files.scales import SCALES
from kinetostat.lint.rules.files.shapes import SHAPES

__all__ = ["FILES"]

FILES: tuple[Rule, ...] = (*LOOKUP, *CONTENT, *SCALES, *SHAPES)
