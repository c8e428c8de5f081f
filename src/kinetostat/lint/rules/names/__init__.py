"""N: names and ROS. Can other tools carry the names, and does what refers to the robot refer to what is there?"""

from __future__ import annotations

from kinetostat.lint.rule import Rule
from kinetostat.lint.rules.names.conventions import CONVENTIONS
from kinetostat.lint.rules.names.members import MEMBERS
from kinetostat.lint.rules.names.references import REFERENCES
from kinetostat.lint.rules.names.srdf import SRDF
from kinetostat.lint.rules.names.states import STATES
from kinetostat.lint.rules.names.words import WORDS

__all__ = ["NAMES"]

NAMES: tuple[Rule, ...] = (*WORDS, *CONVENTIONS, *REFERENCES, *SRDF, *MEMBERS, *STATES)
