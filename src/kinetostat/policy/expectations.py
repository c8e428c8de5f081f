"""All kinds of expectations: there is no other place where a kind is known."""

from __future__ import annotations

from kinetostat.policy.kinds.common import Kind
from kinetostat.policy.kinds.dexterity import InverseCondition, Manipulability, SingularDistance, SmallestSingularValue
from kinetostat.policy.kinds.efforts import Holds, JointLimits, WorstGravity
from kinetostat.policy.kinds.poses import Golden, Reach, Reaches, Symmetry
from kinetostat.policy.kinds.structure import Follower, Mass, Mobility

__all__ = ["KINDS", "Expectation"]

Expectation = (
    SmallestSingularValue
    | Manipulability
    | InverseCondition
    | SingularDistance
    | Holds
    | WorstGravity
    | Reaches
    | Reach
    | Mobility
    | Mass
    | Follower
    | JointLimits
    | Golden
    | Symmetry
)
KINDS: dict[str, type[Kind]] = {str(kind.__struct_config__.tag): kind for kind in Expectation.__args__}
