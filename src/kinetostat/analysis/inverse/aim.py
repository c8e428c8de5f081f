"""An aim: a chain, the pose that its tool ought to have, and which rows of the error count, as pure numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.inverse.pose import pose_error
from kinetostat.analysis.task import FULL, Task, characteristic_length
from kinetostat.conventions import Array
from kinetostat.screw import so3
from kinetostat.screw.adjoint import cross

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
        """Return the scaled error e, (..., m), and -de/dq, (..., m, n), q in units of coordinates.

        With r = log(R* R^T) and the tool's velocity (v ; w): d(p* - p) = -v dt and dr = -B(-r) w dt, B the inverse of
        so(3)'s left Jacobian. In the tool's axes, where e = (p ; r): dp = -(v + w x p) dt and dr = -B(r) w dt. At the
        target both are the Jacobian's rows (J. Sola et al., "A micro Lie theory", 2018, section II.G).
        """
        columns, placement = self.joints.chain.columns(q)
        matrix, error = columns @ self.joints.chain.fold, pose_error(placement, target, local=self.local)
        linear, angular = matrix[..., :3, :], matrix[..., 3:, :]
        if self.local:
            back = np.swapaxes(placement[..., :3, :3], -1, -2)
            linear, angular = back @ linear, back @ angular
            linear = linear + cross(angular, error[..., :3, None])
        if self.task.angular:
            turn = error[..., 3:] if self.local else -error[..., 3:]
            angular = so3.inverse_left_jacobian(turn) @ angular
        slope = np.concatenate([linear, angular], -2)
        rows = np.swapaxes(self.scaled(np.swapaxes(slope, -1, -2)), -1, -2) * self.units
        return self.scaled(error), rows
