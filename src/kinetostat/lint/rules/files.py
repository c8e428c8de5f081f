"""M: files and geometry. Is what the robot file names there? Existence and headers only: meshes are not analysed."""

from __future__ import annotations

from kinetostat.lint.rule import Rule

__all__ = ["FILES"]

FILES: tuple[Rule, ...] = ()
