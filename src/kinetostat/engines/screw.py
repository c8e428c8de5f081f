"""The in-house engine: screw theory on the description. It never sees Pinocchio.

Joint i sits at the placement A_i in its parent link and moves by exp(s_i q_i), s_i its screw in the joint frame:

    T_child = T_parent A_i exp(s_i q_i)          (a product of exponentials, in local form)
    S_i     = Ad(T_child) s_i                    (its column, a space screw)
    dS_i/dt = [V_child, S_i]                     (a screw carried by its link)

A batch `(..., nq)` is computed joint by joint over all configurations at once.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from kinetostat.conventions import Array, Velocity, WrenchOrTwist
from kinetostat.screw import se3, so3
from kinetostat.screw.adjoint import adjoint, coadjoint, twist_matrix
from kinetostat.screw.chain import screw
from kinetostat.urdf.description import Joint, JointType, Origin, Robot

__all__ = ["ScrewEngine"]

_ORIGIN = np.zeros(3)
_FREE = np.eye(6)
_IN_PLANE = np.eye(6)[:, [0, 1, 5]]


class ScrewEngine:
    """Kinematics by screws; see `engines.protocol.Engine` for what the methods return."""

    name = "screw"

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self.position_names = tuple(name for joint in robot.independent for name in joint.position_names)
        self.velocity_names = tuple(name for joint in robot.independent for name in joint.velocity_names)

    # --- the protocol ------------------------------------------------------------------------------------------

    def placement(self, q: Array, frame: str, relative_to: str) -> Array:
        """Return T_a_f = T_a^-1 T_f."""
        placements = self._placements(q, (frame, relative_to))
        return se3.inverse(placements[relative_to]) @ placements[frame]

    def frame_change(self, q: Array, start: str, end: str, kind: WrenchOrTwist) -> Array:
        """Return Ad(T_end_start) for twists, Ad*(T_end_start) for wrenches."""
        placement = self.placement(q, start, end)
        return adjoint(placement) if kind is WrenchOrTwist.TWIST else coadjoint(placement)

    def jacobian(self, q: Array, velocity: Velocity) -> Array:
        """Return X Ad(T_a^-1) (J_f - J_a), X the shift to the point and the turn to the axes."""
        placements = self._placements(q, self._frames(velocity))
        columns = self._relative_columns(placements, velocity, np.shape(q)[:-1])
        to_observer = adjoint(se3.inverse(placements[velocity.relative_to]))
        point, axes = self._point_and_axes(placements, velocity)
        jacobian: Array = _to_axes(axes) @ _to_point(point) @ to_observer @ columns
        return jacobian

    def jacobian_rate(self, q: Array, qdot: Array, velocity: Velocity) -> Array:
        """Return d/dt [X Ad(T_a^-1) (J_f - J_a)] by the product rule, all of it in the observer's coordinates."""
        observer = velocity.relative_to
        shape = np.broadcast_shapes(np.shape(q)[:-1], np.shape(qdot)[:-1])
        placements = self._placements(q, self._frames(velocity))
        twists = self._twists(placements, qdot, self._frames(velocity))
        to_observer = adjoint(se3.inverse(placements[observer]))
        columns = self._relative_columns(placements, velocity, shape)
        rates = self._relative_columns(placements, velocity, shape, twists)
        # In the observer's coordinates: d(Ad(T_a^-1) S)/dt = Ad(T_a^-1) (dS/dt - [V_a, S]).
        rates = to_observer @ (rates - twist_matrix(twists[observer]) @ columns)
        columns = to_observer @ columns
        relative = {f: _apply(to_observer, twists[f] - twists[observer]) for f in (velocity.of, velocity.expressed_in)}
        point, axes = self._point_and_axes(placements, velocity)
        point_rate = np.zeros((*shape, 3))
        if velocity.point is not None:
            twist = relative[velocity.of]
            point_rate = twist[..., :3] + np.cross(twist[..., 3:], point)
        shift = _to_point(point)
        shifted_rate = shift @ rates + _shift_rate(point_rate) @ columns
        turning = so3.hat(relative[velocity.expressed_in][..., 3:])
        shifted = shift @ columns
        turned = np.concatenate([turning @ shifted[..., :3, :], turning @ shifted[..., 3:, :]], -2)
        result: Array = _to_axes(axes) @ (shifted_rate - turned)
        return result

    def masses(self) -> tuple[float, float]:
        """Return the mass of the base link and of all other links, in kg."""
        mass = {link.name: link.inertial.mass for link in self._robot.links if link.inertial is not None}
        base = mass.pop(self._robot.root, 0.0)
        return base, sum(mass.values())

    # --- forward kinematics ------------------------------------------------------------------------------------

    def _placements(self, q: Array, frames: Iterable[str]) -> dict[str, Array]:
        """Return T_0_l for the given links and all links above them."""
        q = np.asarray(q, dtype=np.float64)
        placements: dict[str, Array] = {self._robot.root: np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))}
        for frame in frames:
            for joint in reversed([j for j in self._robot.to_root(frame) if j.child not in placements]):
                moved = placements[joint.parent] @ _origin(joint.origin)
                placements[joint.child] = moved if joint.type is JointType.FIXED else moved @ self._motion(joint, q)
        return placements

    def _motion(self, joint: Joint, q: Array) -> Array:
        """Return the placement of the child link in the joint frame. (..., nq) -> (..., 4, 4)."""
        if joint.type is JointType.FLOATING:
            part = q[..., self._robot.position_slices[joint.name]]
            return se3.placement(so3.from_quaternion(part[..., 3:]), part[..., :3])
        if joint.type is JointType.PLANAR:
            part = q[..., self._robot.position_slices[joint.name]]
            in_plane = np.concatenate([part[..., :2], np.zeros_like(part[..., :1])], -1)
            turn = so3.carry_z_to(np.array(joint.axis))
            return se3.placement(turn @ so3.about(2, part[..., 2]) @ turn.T, in_plane @ turn.T)
        return se3.exp(_screws(joint)[:, 0] * self._position(joint, q)[..., None])

    def _position(self, joint: Joint, q: Array) -> Array:
        """Return the position of a joint with one coordinate, its leader's law applied if it follows one."""
        law = self._robot.followers.get(joint.name)
        if law is None:
            alone: Array = q[..., self._robot.position_slices[joint.name].start]
            return alone
        followed: Array = law.multiplier * q[..., self._robot.position_slices[law.joint].start] + law.offset
        return followed

    # --- columns -----------------------------------------------------------------------------------------------

    def _frames(self, velocity: Velocity) -> tuple[str, str, str]:
        return velocity.of, velocity.relative_to, velocity.expressed_in

    def _columns_of(self, joint: Joint) -> tuple[slice, float]:
        """Return where the columns of a joint go, and the factor that they go with (a follower's multiplier)."""
        law = self._robot.followers.get(joint.name)
        if law is None:
            return self._robot.velocity_slices[joint.name], 1.0
        return self._robot.velocity_slices[law.joint], law.multiplier

    def _relative_columns(
        self, placements: dict[str, Array], velocity: Velocity, shape: tuple[int, ...], twists: dict[str, Array] | None = None
    ) -> Array:
        """Return J_f - J_a as space screws (..., 6, nv); given the links' twists, its rate by carried screws."""
        columns = np.zeros((*shape, 6, self._robot.nv))
        for joint, sign in self._robot.path(velocity.relative_to, velocity.of):
            if joint.type is not JointType.FIXED:
                space = adjoint(placements[joint.child]) @ _screws(joint)
                if twists is not None:
                    space = twist_matrix(twists[joint.child]) @ space
                where, factor = self._columns_of(joint)
                columns[..., where] += sign * factor * space
        return columns

    def _twists(self, placements: dict[str, Array], qdot: Array, frames: Iterable[str]) -> dict[str, Array]:
        """Return the space twist of the given links and all links above them: V_child = V_parent + S_i qdot_i."""
        qdot = np.asarray(qdot, dtype=np.float64)
        twists: dict[str, Array] = {self._robot.root: np.zeros((*qdot.shape[:-1], 6))}
        for frame in frames:
            for joint in reversed([j for j in self._robot.to_root(frame) if j.child not in twists]):
                twists[joint.child] = twists[joint.parent]
                if joint.type is not JointType.FIXED:
                    where, factor = self._columns_of(joint)
                    space = adjoint(placements[joint.child]) @ _screws(joint)
                    twists[joint.child] = twists[joint.child] + _apply(space, factor * qdot[..., where])
        return twists

    def _point_and_axes(self, placements: dict[str, Array], velocity: Velocity) -> tuple[Array, Array]:
        """Return the point and the rotation R_a_e, both in the observer's coordinates."""
        to_observer = se3.inverse(placements[velocity.relative_to])
        axes = (to_observer @ placements[velocity.expressed_in])[..., :3, :3]
        if velocity.point is None:
            return np.zeros((*axes.shape[:-2], 3)), axes
        return se3.transform(to_observer @ placements[velocity.of], np.array(velocity.point)), axes


def _origin(origin: Origin) -> Array:
    """Return the placement that URDF's xyz and rpy (or quaternion) write. (4, 4)."""
    if origin.quaternion_xyzw is not None:
        return se3.placement(so3.from_quaternion(np.array(origin.quaternion_xyzw)), np.array(origin.xyz))
    return se3.placement(so3.from_rpy(np.array(origin.rpy)), np.array(origin.xyz))


def _screws(joint: Joint) -> Array:
    """Return the screws of a joint in its child frame, one per velocity coordinate. (6, k)."""
    if joint.type is JointType.FLOATING:
        return _FREE
    axis = np.array(joint.axis)
    if joint.type is JointType.PLANAR:
        turn = se3.placement(so3.carry_z_to(axis), _ORIGIN)
        turned: Array = adjoint(turn) @ _IN_PLANE
        return turned
    if joint.type is JointType.PRISMATIC:
        return screw(axis, _ORIGIN, np.inf)[:, None]
    return screw(axis, _ORIGIN, joint.pitch)[:, None]


def _apply(matrix: Array, vector: Array) -> Array:
    result: Array = (matrix @ vector[..., None])[..., 0]
    return result


def _to_point(point: Array) -> Array:
    """Return [[1, -[p]], [0, 1]]: from the twist at the origin to the twist at p, same axes."""
    return adjoint(se3.placement(np.eye(3), -point))


def _shift_rate(rate: Array) -> Array:
    """Return the rate of `_to_point` while the point moves: [[0, -[dp/dt]], [0, 0]]."""
    matrix = np.zeros((*rate.shape[:-1], 6, 6))
    matrix[..., :3, 3:] = -so3.hat(rate)
    return matrix


def _to_axes(rotation: Array) -> Array:
    """Return blockdiag(R^T, R^T): from the observer's axes to the axes of R."""
    return adjoint(se3.placement(np.swapaxes(rotation, -1, -2), _ORIGIN))
