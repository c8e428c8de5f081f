"""From samples to local maxima of gravity torques: all joints and starts at once, then the best ends polished."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np

from kinetostat.analysis.configuration import position_range
from kinetostat.analysis.loads import Payload, carried, point_masses
from kinetostat.analysis.torque_ascent import TorqueAscent
from kinetostat.analysis.worst_samples import compiled_torques, worst_samples
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.engines.screw import ScrewEngine
from kinetostat.screw.tree import Tree
from kinetostat.urdf.description import NO_LIMIT, Joint

__all__ = ["WorstClimb"]

_ROUNDING = 1e-12  # of the largest torque
_COMPILED = 100_000  # samples from which on compiled code saves more than its loading takes: half a second
_OPTIONS = {"maxiter": 200, "ftol": 1e-13, "gtol": 1e-9}


class WorstClimb:
    """Climbs of the torques that weight puts on joints with one coordinate, all others being held.

    Args:
        model: the robot.
        q: where the other joints are held, (nq,).
        joints: the joints that move.
        gravity: the acceleration of gravity, (3,), m/s2.
        payload: a mass that is held.
    """

    def __init__(
        self, model: Model, q: Array, joints: Sequence[Joint], gravity: Array, payload: Payload | None
    ) -> None:
        self._robot, self._engine, self._gravity = model.robot, model.engine, gravity
        self._rest, self._joints, self._payload = q, list(joints), payload
        self._loads = carried(model.robot, payload, gravity)
        self._where = [model.robot.position_slices[joint.name].start for joint in joints]
        self._columns = model.robot.velocity_columns(joints)

    def ends(
        self,
        joints: Sequence[Joint],
        drawn: Array,
        starts: int,
        progress: Callable[[str, float], None] | None = None,
    ) -> tuple[Array, Array]:
        """Return where climbs from the worst samples for each joint end, and its torques there.

        Args:
            joints: whose torques climb.
            drawn: configurations (N, nq) that are looked at.
            starts: from how many of the worst for each joint is climbed.
            progress: told what is being done, and which share of it is.

        Returns:
            configurations (j, k, nq), k being `starts` or N, and signed torques (j, k), Nm or N.
        """
        wanted = [self._joints.index(joint) for joint in joints]
        rows, values = worst_samples(self._torques(len(drawn)), drawn[:, self._where], starts)
        at, torques = drawn[rows[wanted]], values[wanted]
        largest = float(np.max(np.abs(values)))
        turned = [i for i in range(len(joints)) if abs(torques[i, 0]) > _ROUNDING * largest]  # by weight
        self._ascend(turned, wanted, at, torques)
        for i, joint in enumerate(joints):
            if progress is not None:
                progress(f"joint {joint.name}", i / len(joints))
            if i in turned:
                self._polish(wanted[i], at[i], torques[i])
        held = np.array(self._where)[~self._ascent.free]
        if len(held):  # what only the polish has moved is where the best has it: do the others end there, or higher?
            for i in turned:
                at[i][:, held] = at[i, np.argmax(np.abs(torques[i]))][held]
            self._ascend(turned, wanted, at, torques)
            for i in turned:
                self._polish(wanted[i], at[i], torques[i])
        return at, torques

    # --- samples -----------------------------------------------------------------------------------------------------

    def _torques(self, count: int) -> Callable[[Array], Array]:
        """Return what gives the torques of the joints for their coordinates: (m, n) -> (m, n)."""
        if count >= _COMPILED:
            return compiled_torques(self._tree, self._gravity)

        def torques(coordinates: Array) -> Array:
            q = np.tile(self._rest, (len(coordinates), 1))
            q[:, self._where] = coordinates
            return self._engine.holding_torques(q, self._gravity, self._loads)[:, self._columns]

        return torques

    @cached_property
    def _tree(self) -> Tree:
        held = point_masses(self._robot, self._payload)
        return ScrewEngine(self._robot).tree([joint.name for joint in self._joints], self._rest, held)

    # --- climbs ------------------------------------------------------------------------------------------------------

    @cached_property
    def _bounds(self) -> list[tuple[float, float]]:
        """The ends that each joint is kept between: none where a turn, that does not advance, is without limits."""
        return [
            (-math.inf, math.inf)
            if joint.type.is_angle and not joint.pitch and max(map(abs, joint.limit.range)) > NO_LIMIT
            else position_range(self._robot, joint)
            for joint in self._joints
        ]

    @cached_property
    def _ascent(self) -> TorqueAscent:
        return TorqueAscent(self._tree, self._gravity, *np.array(self._bounds).T)

    def _ascend(self, chosen: Sequence[int], wanted: Sequence[int], at: Array, torques: Array) -> None:
        """Climb along coordinates from all rows (j, k, nq) of the chosen joints."""
        if not chosen:
            return
        shape = len(chosen), at.shape[1]
        columns = np.repeat(np.array(wanted)[chosen], shape[1])
        signs = np.where(torques[chosen] < 0, -1.0, 1.0).reshape(-1)
        q = at[chosen].reshape(-1, at.shape[-1])
        q[:, self._where], found = self._ascent.climb(q[:, self._where], columns, signs)
        at[chosen], torques[chosen] = q.reshape(*shape, -1), found.reshape(shape)

    def _polish(self, index: int, at: Array, torques: Array) -> None:
        """Climb from the best of some rows (k, nq) along all coordinates together, by the other engine."""
        from scipy.optimize import minimize

        best, column = int(np.argmax(np.abs(torques))), self._columns[index]
        q, size = at[best].copy(), float(torques[best])  # with its sign: torque over size is to grow from 1 on
        if size == 0:
            return  # weight does nothing: what made it look as if it did was rounding

        def descent(x: Array) -> tuple[float, Array]:
            q[self._where] = x
            value = self._engine.holding_torques(q, self._gravity, self._loads)[column]
            return -float(value) / size, -self._gradient(q, column)[self._columns] / size

        start = q[self._where]
        found = minimize(descent, start, jac=True, method="L-BFGS-B", bounds=self._bounds, options=_OPTIONS)
        at[best, self._where], torques[best] = found.x, -float(found.fun) * size

    def _gradient(self, q: Array, column: int) -> Array:
        """Return the gradient of a torque: of the links' weight, and of the payload's, a constant force."""
        gradient: Array = self._engine.gravity_stiffness(q, self._gravity)[column].copy()
        for load in self._loads:
            along = self._robot.velocity_columns(self._robot.movable_path(self._robot.root, load.at.of))
            rates = self._engine.jacobian_rate(q, np.eye(self._robot.nv)[along], load.at)  # of J along each of them
            gradient[along] += rates[:, :, column] @ load.wrench
        return gradient
