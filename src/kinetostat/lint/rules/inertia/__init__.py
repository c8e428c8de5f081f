"""I: inertia. Could these masses and moments be those of real bodies?"""

from __future__ import annotations

from kinetostat.lint.rule import Rule
from kinetostat.lint.rules.inertia.extents import EXTENTS
from kinetostat.lint.rules.inertia.masses import MASSES
from kinetostat.lint.rules.inertia.relations import RELATIONS
from kinetostat.lint.rules.inertia.statements import STATEMENTS
from kinetostat.lint.rules.inertia.suspicions import SUSPICIONS
from kinetostat.lint.rules.inertia.tensors import TENSORS

__all__ = ["INERTIA"]

INERTIA: tuple[Rule, ...] = (*MASSES, *STATEMENTS, *TENSORS, *SUSPICIONS, *EXTENTS, *RELATIONS)
