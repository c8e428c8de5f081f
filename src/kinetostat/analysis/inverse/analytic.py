"""Closed solutions of arms whose axes meet or are parallel, by the EAIK library, where it is installed.

D. Ostermeier, J. Kuelz and M. Althoff, "Automatic geometric decomposition for analytical inverse kinematics", IEEE
Robotics and Automation Letters 10(10), 2025, on the subproblems of A. Elias and J. Wen, "IK-Geo", 2025.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.conventions import Array

__all__ = ["ClosedForm", "closed_form"]

_MOST_JOINTS = 6


@dataclass(frozen=True)
class ClosedForm:
    """An arm's closed solution.

    Attributes:
        family: what the library calls the arm's class.
        arm: its own object.
    """

    family: str
    arm: Any

    def candidates(self, target: Array) -> Array:
        """Return the solutions for a pose (4, 4), and what the library takes for the nearest to one. (k, n), rad."""
        found = self.arm.calculate_IK(np.asarray(target, dtype=np.float64))
        return np.array([q for q in found.Q if np.all(np.isfinite(q))], dtype=np.float64)


def closed_form(joints: Coordinates) -> ClosedForm | str:
    """Return the closed solution of an arm, or why there is none.

    Args:
        joints: the chain, of at most six revolute joints that follow no other.
    """
    chain, count = joints.chain, len(joints.names)
    if count > _MOST_JOINTS:
        return f"{count} joints: more than the six of a pose"
    own = chain.fold.shape == (count, count) and np.array_equal(chain.fold, np.eye(count)) and not np.any(chain.offset)
    v, w = chain.screws[:3], chain.screws[3:]
    if not (own and all(joints.turning) and np.all(np.abs(np.sum(v * w, axis=0)) < 1e-12)):
        return "not all joints are revolute joints of their own"
    try:
        from eaik.pybindings import EAIK
    except ImportError:
        return "EAIK is not installed (pip install 'kinetostat[analytic]')"
    points = np.cross(w, v, axis=0).T  # of each axis, the point nearest to the base
    offsets = np.vstack([points[:1], np.diff(points, axis=0), chain.home[None, :3, 3] - points[-1:]])
    arm = EAIK.Robot(np.ascontiguousarray(w), np.ascontiguousarray(offsets.T), chain.home[:3, :3], [], True)
    if not arm.has_known_decomposition():
        return "no known decomposition of its axes"
    return ClosedForm(str(arm.get_kinematic_family()), arm)
