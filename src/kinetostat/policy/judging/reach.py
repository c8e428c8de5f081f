"""The largest distance between two frames."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from kinetostat.analysis.configuration import neutral, random_configurations
from kinetostat.analysis.farthest import bounded_joints, farthest
from kinetostat.engines.model import Model
from kinetostat.policy.judging.found import Found, above, agreed, below, ends, witness
from kinetostat.policy.kinds.poses import Reach

__all__ = ["reach"]


def reach(model: Model, asked: Reach, folder: Path) -> Found:  # noqa: ARG001 (all judges alike)
    """Judge the largest distance that is found: random configurations, then climbs from the farthest of them.

    What a search finds is a lower bound. The distance at the witness is computed by both engines.
    """
    robot = model.robot
    frame, observer = ends(robot, asked)
    joints = bounded_joints(model, frame, observer)
    where = [robot.position_slices[joint.name].start for joint in joints]
    drawn = np.tile(neutral(robot), (asked.samples, 1))
    drawn[:, where] = random_configurations(robot, asked.seed, asked.samples)[:, where]
    found = farthest(model, frame, observer, drawn)
    agreed(found.certificate)
    low = asked.at_least is None or above(found.distance, asked.at_least)
    high = asked.at_most is None or below(found.distance, asked.at_most)
    return Found(low and high, f"{found.distance:.6g} m", witness(robot, found.q, joints))
