"""Trees of screws that carry masses: the torques that hold them still. The NumPy definition of statics in batches.

Body k is moved by screw k after all screws before it, from the root outwards:

    T_k = T_parent(k) exp(S_k t_k),      t = fold q + offset
    tau_k = -g . (M_k v_k + w_k x h_k)   (the rate at which lifting costs energy)

with (v ; w) the screw where it is now, M_k the mass beyond it and h_k = sum of m c its first moment.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinetostat.conventions import Array
from kinetostat.screw import se3
from kinetostat.screw.adjoint import adjoint

__all__ = ["Tree"]


@dataclass(frozen=True)
class Tree:
    """Unit screws in a tree, each carrying a rigid mass, as constant arrays in the root's coordinates.

    Attributes:
        screws: S_k at t = 0, |w| = 1 or w = 0. (6, s).
        parents: the screw before each one, -1 for none; a parent comes before its children. (s,).
        fold: how far screw k moves for coordinate j. (s, n).
        offset: where the screws are at q = 0. (s,).
        masses: the mass that moves with each screw and with none after it, kg. (s,).
        centres: where its centre is at t = 0, m. (s, 3).
    """

    screws: Array
    parents: tuple[int, ...]
    fold: Array
    offset: Array
    masses: Array
    centres: Array

    def holding_torques(self, q: Array, gravity: Array) -> Array:
        """Return the torques (or forces) that hold the masses still. (..., n), (3,) m/s2 -> (..., n), Nm or N."""
        positions = np.asarray(q, dtype=np.float64) @ self.fold.T + self.offset
        shape = positions.shape[:-1]
        placements: list[Array] = []
        for k, parent in enumerate(self.parents):
            before = np.eye(4) if parent < 0 else placements[parent]
            placements.append(before @ se3.exp_along(self.screws[:, k], positions[..., k]))
        mass = [np.full(shape, m) for m in self.masses]
        moment = [m * se3.transform(at, c) for m, at, c in zip(self.masses, placements, self.centres, strict=True)]
        torques = np.zeros((*shape, len(self.parents)))
        for k in reversed(range(len(self.parents))):
            moved = (adjoint(placements[k]) @ self.screws[:, k, None])[..., 0]
            lift = mass[k][..., None] * moved[..., :3] + np.cross(moved[..., 3:], moment[k])
            torques[..., k] = -lift @ np.asarray(gravity, dtype=np.float64)
            if self.parents[k] >= 0:
                mass[self.parents[k]] = mass[self.parents[k]] + mass[k]
                moment[self.parents[k]] = moment[self.parents[k]] + moment[k]
        folded: Array = torques @ self.fold
        return folded
