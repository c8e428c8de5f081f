"""X: XML and schema. Is the file readable at all, and is everything in it what it is meant to be?"""

from __future__ import annotations

from kinetostat.lint.rule import Rule
from kinetostat.lint.rules.xml.documents import DOCUMENTS
from kinetostat.lint.rules.xml.elements import ELEMENTS
from kinetostat.lint.rules.xml.heads import HEADS
from kinetostat.lint.rules.xml.materials import MATERIALS
from kinetostat.lint.rules.xml.mended import MENDED
from kinetostat.lint.rules.xml.missing import MISSING
from kinetostat.lint.rules.xml.numbers import NUMBERS
from kinetostat.lint.rules.xml.reading import READING, UnreadableRobot, UnusedSuppression
from kinetostat.lint.rules.xml.refusals import REFUSALS

__all__ = ["XML", "UnreadableRobot", "UnusedSuppression"]

_FOUND = (*READING, *REFUSALS, *DOCUMENTS, *HEADS, *ELEMENTS, *MISSING, *MATERIALS, *NUMBERS, *MENDED)
XML: tuple[Rule, ...] = tuple(sorted(_FOUND, key=lambda rule: rule.code))
