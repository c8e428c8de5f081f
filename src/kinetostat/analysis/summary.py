"""What is in a robot file: joints, chains, masses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.crosscheck import Certificate, certified
from kinetostat.engines.model import Model
from kinetostat.urdf.description import Remark, Robot

__all__ = ["Chain", "Summary", "summary"]


@dataclass(frozen=True)
class Chain:
    """The way from the root to one tip, and the independent joints that move the tip."""

    tip: str
    joints: tuple[str, ...]


@dataclass(frozen=True)
class Summary:
    """What a robot is made of.

    Attributes:
        robot: the description.
        chains: every tip with its joints.
        base_mass: mass of the root link, kg.
        moving_mass: mass of all other links, kg.
        reach: longest path from the root, stretched out, m.
        states: names of SRDF states; groups: joints of each SRDF group.
        remarks: what the reader assumes or mends. What else is odd about a file, the rules of `lint` say.
        certificate: what the two engines say of the masses.
    """

    robot: Robot
    chains: tuple[Chain, ...]
    base_mass: float
    moving_mass: float
    reach: float
    states: tuple[str, ...]
    groups: dict[str, tuple[str, ...]]
    remarks: tuple[Remark, ...]
    certificate: Certificate


def summary(model: Model) -> Summary:
    """Return what is in a robot file. Masses are summed by both engines.

    Args:
        model: the robot.

    Raises:
        EngineError: Pinocchio refuses the robot.
    """
    robot = model.robot
    total = sum(link.inertial.mass for link in robot.links if link.inertial)
    masses, certificate = certified(model, lambda engine: np.array(engine.masses()), abs(total))
    chains = tuple(Chain(tip, tuple(j.name for j in robot.movable_path(robot.root, tip))) for tip in robot.tips)
    return Summary(
        robot,
        chains,
        float(masses[0]),
        float(masses[1]),
        robot.reach,
        tuple(model.semantics.state_names()),
        model.semantics.groups,
        robot.remarks,
        certificate,
    )
