"""N: names and ROS. Can other tools carry the names, and does what refers to the robot refer to what is there?"""

from __future__ import annotations

from kinetostat.lint.rule import Rule

__all__ = ["NAMES"]

NAMES: tuple[Rule, ...] = ()
