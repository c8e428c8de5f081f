"""What two joints make of the tool's place in a plane, all others held."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinetostat.analysis.crosscheck import Certificate
from kinetostat.analysis.singular.slices import Curve
from kinetostat.conventions import Array

__all__ = ["Section"]

_SAME = 0.05  # of the largest: a value that varies by less is the same


@dataclass(frozen=True, repr=False)
class Section:
    """The image of the ranges of two joints in a plane of the observer: where the tool gets by them, and how well.

    Attributes:
        view: "side" (the plane in which the arm mainly moves) or "above".
        directions: unit vectors to the right and up in the picture, in the observer's axes. (2, 3).
        joints: names of the two coordinates.
        held: all coordinates of the chain at the pose in which the others are held. (n,).
        held_name: what that pose is called, such as "mid".
        points: the tool over a grid of both joints inside limits, projected. (b, a, 2), m.
        smallest: the smallest singular value that counts there, as the limb's sweep has it. (b, a).
        curves: where the arm is singular inside limits, and where one of the two joints is at a limit; in the plane, m.
        unlimited: the singular curves beyond, were there no limits.
        arm: the stick figure at the held pose, projected. (k, 2), m.
        certificate: what both engines say of places, Jacobians and singular values all over it, and at the extremes.
    """

    view: Literal["side", "above"]
    directions: Array
    joints: tuple[str, str]
    held: Array
    held_name: str
    points: Array
    smallest: Array
    curves: tuple[Curve, ...]
    unlimited: tuple[Curve, ...]
    arm: Array
    certificate: Certificate

    @property
    def same_everywhere(self) -> bool:
        """Whether the smallest singular value is the same all over it, but for a twentieth: no map of anything."""
        return bool(np.ptp(self.smallest) <= _SAME * np.max(self.smallest))

    def __repr__(self) -> str:
        return f"<Section from the {self.view}: {self.points.shape[:2]} places>"
