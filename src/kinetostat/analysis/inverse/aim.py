"""An aim: a chain, the pose that its tool ought to have, and which rows of the error count, as pure numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.inverse.pose import pose_error
from kinetostat.analysis.task import FULL, Task, characteristic_length
from kinetostat.conventions import Array

__all__ = ["REACHED", "Aim"]

REACHED = 1e-9  # rad, and of the unit of length: the error at which a tool is where it ought to be
_SAMPLES, _SEED = 32, 0
_NO_LENGTH = 1e-9  # of the robot's reach


@dataclass(frozen=True)
class Aim:
    """Errors and Jacobians of the rows that count; lengths in units of L, so that they compare with angles.

    Attributes:
        joints: the chain's coordinates.
        task: the rows of the error that count, m of them.
        local: whether the rows are in the tool's axes, not in the observer's.
        length: L, in m: the root mean square distance of the joints' axes from the tool.
    """

    joints: Coordinates
    task: Task
    local: bool
    length: float

    @classmethod
    def of(cls, joints: Coordinates, task: Task, *, local: bool = False) -> Aim:
        """Return the aim, with the length that random configurations of the chain have."""
        q = joints.draw(np.random.default_rng(_SEED), (_SAMPLES,))
        lengths = characteristic_length(joints.chain.jacobian(q), joints.turning, FULL)
        length = float(np.sqrt(np.mean(lengths**2)))
        return cls(joints, task, local, length if length > _NO_LENGTH * joints.model.robot.reach else 1.0)

    @property
    def units(self) -> Array:
        """What one unit of each coordinate is: 1 rad, or L in m. (n,)."""
        return np.where(self.joints.turning, 1.0, self.length)

    def scaled(self, error: Array) -> Array:
        """Return the rows that count of errors (..., 6), lengths in units of L. (..., m)."""
        rows: Array = error[..., list(self.task.rows)] / np.where(np.array(self.task.rows) < 3, self.length, 1.0)
        return rows

    def error(self, q: Array, target: Array) -> Array:
        """Return the scaled error of configurations (..., n) for targets (..., 4, 4). (..., m)."""
        _, placement = self.joints.chain.columns(q)
        return self.scaled(pose_error(placement, target, local=self.local))

    def linear(self, q: Array, target: Array) -> tuple[Array, Array]:
        """Return the scaled error e, (..., m), and J, (..., m, n), with de = -J dq, dq in units of coordinates.

        At the target that is the error's derivative; away from it the rotation vector's differs by what a turn to the
        target does, which is left out, as usual: steps by J still lead downhill (B. Siciliano et al., "Robotics", 2009,
        section 3.7.3).
        """
        columns, placement = self.joints.chain.columns(q)
        matrix = columns @ self.joints.chain.fold
        if self.local:
            back = np.swapaxes(placement[..., :3, :3], -1, -2)
            matrix = np.concatenate([back @ matrix[..., :3, :], back @ matrix[..., 3:, :]], -2)
        rows = np.swapaxes(self.scaled(np.swapaxes(matrix, -1, -2)), -1, -2) * self.units
        return self.scaled(pose_error(placement, target, local=self.local)), rows
