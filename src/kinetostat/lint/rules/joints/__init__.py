"""J: joints. Limits, axes, followers, dynamics."""

from __future__ import annotations

from kinetostat.lint.rule import Rule
from kinetostat.lint.rules.joints.angles import ANGLES
from kinetostat.lint.rules.joints.axes import AXES
from kinetostat.lint.rules.joints.dynamics import DYNAMICS
from kinetostat.lint.rules.joints.efforts import EFFORTS
from kinetostat.lint.rules.joints.followers import FOLLOWERS
from kinetostat.lint.rules.joints.leaders import LEADERS
from kinetostat.lint.rules.joints.limits import LIMITS
from kinetostat.lint.rules.joints.ranges import RANGES

__all__ = ["JOINTS"]

JOINTS: tuple[Rule, ...] = (*LIMITS, *EFFORTS, *RANGES, *AXES, *ANGLES, *LEADERS, *FOLLOWERS, *DYNAMICS)
"""The rules, in the order of their codes."""
