"""What is known of a robot, limb by limb, for a report."""

from __future__ import annotations

from dataclasses import dataclass

from kinetostat.analysis.capacity import Strongest
from kinetostat.analysis.configuration import Configuration
from kinetostat.analysis.crosscheck import Certificate
from kinetostat.analysis.manipulability import Manipulability
from kinetostat.analysis.profile.anatomy import Left, Limb
from kinetostat.analysis.profile.section import Section
from kinetostat.analysis.singular.find import SingularFamilies
from kinetostat.analysis.summary import Summary
from kinetostat.analysis.sweeping.result import Sweep
from kinetostat.analysis.worst import WorstTorques
from kinetostat.conventions import Array
from kinetostat.engines.model import Model

__all__ = ["LimbPose", "LimbProfile", "RobotProfile"]


@dataclass(frozen=True, repr=False)
class LimbPose:
    """A limb at a named pose.

    Attributes:
        name: zero, mid, or the SRDF state that sets joints of the limb.
        at: the configuration of the whole robot.
        inside: whether the limb's joints are inside their limits.
        manipulability: there, with the rows and the length of the limb's sweep: its block `task`, or `full`, has them.
        values: the sweep's measures there, by the column's name; NaN where there is none.
    """

    name: str
    at: Configuration
    inside: bool
    manipulability: Manipulability
    values: dict[str, float]


@dataclass(frozen=True, repr=False)
class LimbProfile:
    """What is known of a limb. Parts that could not be computed are None, and `left` says why.

    Attributes:
        limb: which.
        sweep: the measures inside limits, at random configurations: yoshikawa, minimum_singular_value,
            inverse_condition_number, and effort_use where there are effort limits.
        positions: the tool at these configurations, in the base's axes. (N, 3), m.
        smallest: the smallest singular value that counts there. (N,).
        reach: the largest distance of the tool from the limb's first joint that is found inside limits, m.
        payload: the largest payload at the middle of limits.
        poses: the named poses.
        families: the singular families.
        sections: at most one from the side and one from above.
        loaded: the worst torques of the limb's joints with the payload that is asked for.
        left: what is not computed, and why.
    """

    limb: Limb
    sweep: Sweep | None
    positions: Array
    smallest: Array
    reach: float | None
    payload: Strongest | None
    poses: tuple[LimbPose, ...]
    families: SingularFamilies | None
    sections: tuple[Section, ...]
    loaded: WorstTorques | None
    left: tuple[Left, ...]

    def __repr__(self) -> str:
        return f"<LimbProfile of {self.limb.name!r}>"


@dataclass(frozen=True, repr=False)
class RobotProfile:
    """What is known of a robot.

    Attributes:
        model: the robot.
        summary: what it is made of.
        limbs: limb by limb.
        worst: the worst gravity torque of each joint; None where there is none, and `left` says why.
        left: what is not computed, or belongs to no limb, and why.
        certificates: of every answer in it, by what was asked ("masses", "manipulability of arm at home").
    """

    model: Model
    summary: Summary
    limbs: tuple[LimbProfile, ...]
    worst: WorstTorques | None
    left: tuple[Left, ...]
    certificates: dict[str, Certificate]

    def __repr__(self) -> str:
        return (
            f"<RobotProfile of {self.model.robot.name!r}: {len(self.limbs)} limb{'' if len(self.limbs) == 1 else 's'}>"
        )
