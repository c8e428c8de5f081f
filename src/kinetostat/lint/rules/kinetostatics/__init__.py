"""K: kinetostatics. Can the robot do what its joints promise, and do the readers agree on it?"""

from __future__ import annotations

from kinetostat.lint.rule import Rule
from kinetostat.lint.rules.kinetostatics.dependence import DependentJoints
from kinetostat.lint.rules.kinetostatics.efforts import GravityOverEffort
from kinetostat.lint.rules.kinetostatics.readers import EnginesDisagree, ThirdReaderDisagrees
from kinetostat.lint.rules.kinetostatics.sides import UnequalSides
from kinetostat.lint.rules.kinetostatics.states import LockedFreedom, SingularState

__all__ = ["KINETOSTATICS", "EnginesDisagree", "ThirdReaderDisagrees"]

KINETOSTATICS: tuple[Rule, ...] = (
    DependentJoints(),
    SingularState(),
    LockedFreedom(),
    GravityOverEffort(),
    UnequalSides(),
    EnginesDisagree(),
    ThirdReaderDisagrees(),
)
