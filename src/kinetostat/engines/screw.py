"""The in-house engine: screw theory on the description. It never sees Pinocchio.

Joint i sits at the placement A_i in its parent link and moves by exp(s_i q_i), s_i its screw in the joint frame:

    T_child = T_parent A_i exp(s_i q_i)          (a product of exponentials, in local form)
    S_i     = Ad(T_child) s_i                    (its column, a space screw)
    dS_i/dt = [V_child, S_i]                     (a screw carried by its link)

A batch `(..., nq)` is computed joint by joint over all configurations at once.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from kinetostat.conventions import Array, Velocity, WrenchOrTwist
from kinetostat.screw import se3, so3
from kinetostat.screw.adjoint import adjoint, carry, coadjoint, cross, twist_matrix
from kinetostat.screw.chain import Chain, screw
from kinetostat.urdf.description import Joint, JointType, Mimic, Origin, Robot

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
        placement = se3.inverse(placements[relative_to]) @ placements[frame]
        return np.broadcast_to(placement, (*np.shape(q)[:-1], 4, 4))

    def frame_change(self, q: Array, start: str, end: str, kind: WrenchOrTwist) -> Array:
        """Return Ad(T_end_start) for twists, Ad*(T_end_start) for wrenches."""
        placement = self.placement(q, start, end)
        return adjoint(placement) if kind is WrenchOrTwist.TWIST else coadjoint(placement)

    def jacobian(self, q: Array, velocity: Velocity) -> Array:
        """Return R_e^T (v + w x p ; w) of the columns (v ; w) of J_f - J_a, all in the root's coordinates."""
        placements = self._placements(q, self._frames(velocity))
        columns = self._relative_columns(placements, velocity, np.shape(q)[:-1])
        at_point = _at_point(columns, self._point(placements, velocity))
        return self._in_axes(at_point, placements, velocity)

    def jacobian_rate(self, q: Array, qdot: Array, velocity: Velocity) -> Array:
        """Return the rate of `jacobian` by the product rule: of the columns, of the point, and of the axes."""
        shape = np.broadcast_shapes(np.shape(q)[:-1], np.shape(qdot)[:-1])
        placements = self._placements(q, self._frames(velocity))
        twists = self._twists(placements, qdot, self._frames(velocity))
        columns = self._relative_columns(placements, velocity, shape)
        rates = self._relative_columns(placements, velocity, shape, twists)
        point = self._point(placements, velocity)
        carrier = twists[velocity.relative_to if velocity.point is None else velocity.of]
        point_rate = carrier[..., :3] + np.cross(carrier[..., 3:], point)
        at_point = _at_point(columns, point)
        rate = _at_point(rates, point)
        rate[..., :3, :] += cross(columns[..., 3:, :], point_rate[..., None])
        turning = twists[velocity.expressed_in][..., 3:, None]
        rate[..., :3, :] -= cross(turning, at_point[..., :3, :])
        rate[..., 3:, :] -= cross(turning, at_point[..., 3:, :])
        return self._in_axes(rate, placements, velocity)

    def masses(self) -> tuple[float, float]:
        """Return the mass of the base link and of all other links, in kg."""
        mass = {link.name: link.inertial.mass for link in self._robot.links if link.inertial is not None}
        base = mass.pop(self._robot.root, 0.0)
        return base, sum(mass.values())

    def chain(self, frame: str, relative_to: str, point: Sequence[float] = (0.0, 0.0, 0.0)) -> tuple[Chain, list[str]]:
        """Return the chain of screws from one frame to a point of another, and the names of its coordinates.

        Those are the positions of the independent joints between the two, in path order. A planar joint is two slides
        and a turn; floating joints have no such coordinates and are left where they are: callers ask first.
        """
        names = [name for joint in self._robot.movable_path(relative_to, frame) for name in joint.position_names]
        placement, screws, fold, offset = np.eye(4), list[Array](), list[Array](), list[float]()
        for joint, sign in self._robot.path(relative_to, frame):
            origin = _origin(joint.origin)
            placement = placement @ origin if sign > 0 else placement
            if joint.type is not JointType.FIXED and joint.type is not JointType.FLOATING:
                law = self._robot.followers.get(joint.name, Mimic(joint.name))
                leader = self._robot.joint_by_name[law.joint]
                own = list(zip(_screws(joint).T, leader.position_names, strict=True))
                for single, name in own if sign > 0 else reversed(own):
                    screws.append(sign * carry(placement, single[:, None])[:, 0])
                    fold.append(law.multiplier * np.array([float(name == other) for other in names]))
                    offset.append(law.offset)
            placement = placement if sign > 0 else placement @ se3.inverse(origin)
        home = placement @ se3.placement(np.eye(3), np.array(point))
        stacked = np.array(screws).reshape(-1, 6).T, home, np.array(fold).reshape(-1, len(names)), np.array(offset)
        return Chain(*stacked), names

    # --- forward kinematics ------------------------------------------------------------------------------------

    def _placements(self, q: Array, frames: Iterable[str]) -> dict[str, Array]:
        """Return T_0_l for the given links and all links above them. The root's own is (4, 4), others (..., 4, 4)."""
        q = np.asarray(q, dtype=np.float64)
        placements: dict[str, Array] = {self._robot.root: np.eye(4)}
        for frame in frames:
            for joint in reversed([j for j in self._robot.to_root(frame) if j.child not in placements]):
                placements[joint.child] = placements[joint.parent] @ self._motion(joint, q)
        return placements

    def _motion(self, joint: Joint, q: Array) -> Array:
        """Return A_i exp(s_i q_i), the placement of the child link in the parent. (..., nq) -> (..., 4, 4)."""
        origin = _origin(joint.origin)
        if joint.type is JointType.FIXED:
            return origin
        if joint.type is JointType.FLOATING:
            part = q[..., self._robot.position_slices[joint.name]]
            return origin @ se3.placement(so3.from_quaternion(part[..., 3:]), part[..., :3])
        if joint.type is JointType.PLANAR:
            part = q[..., self._robot.position_slices[joint.name]]
            in_plane = np.concatenate([part[..., :2], np.zeros_like(part[..., :1])], -1)
            turn = so3.carry_z_to(np.array(joint.axis))
            return origin @ se3.placement(turn @ so3.about(2, part[..., 2]) @ turn.T, in_plane @ turn.T)
        return se3.exp_along(_screws(joint)[:, 0], self._position(joint, q), origin)

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
        self,
        placements: dict[str, Array],
        velocity: Velocity,
        shape: tuple[int, ...],
        twists: dict[str, Array] | None = None,
    ) -> Array:
        """Return J_f - J_a as space screws (..., 6, nv); given the links' twists, its rate by carried screws."""
        columns = np.zeros((*shape, 6, self._robot.nv))
        for joint, sign in self._robot.path(velocity.relative_to, velocity.of):
            if joint.type is not JointType.FIXED:
                space = carry(placements[joint.child], _screws(joint))
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
                    space = carry(placements[joint.child], _screws(joint))
                    twists[joint.child] = twists[joint.child] + _apply(space, factor * qdot[..., where])
        return twists

    def _point(self, placements: dict[str, Array], velocity: Velocity) -> Array:
        """Return the point of the labelled velocity in the root's coordinates. (..., 3)."""
        if velocity.point is None:
            return placements[velocity.relative_to][..., :3, 3]
        return se3.transform(placements[velocity.of], np.array(velocity.point))

    def _in_axes(self, columns: Array, placements: dict[str, Array], velocity: Velocity) -> Array:
        """Turn columns (..., 6, nv) from the root's axes to those of the labelled velocity."""
        if velocity.expressed_in == self._robot.root:
            return columns
        to_axes = np.swapaxes(placements[velocity.expressed_in][..., :3, :3], -1, -2)
        return np.concatenate([to_axes @ columns[..., :3, :], to_axes @ columns[..., 3:, :]], -2)


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


def _at_point(columns: Array, point: Array) -> Array:
    """Return the columns (v + w x p ; w) of (v ; w): the velocity of the point, not of the one at the origin."""
    angular = columns[..., 3:, :]
    return np.concatenate([columns[..., :3, :] + cross(angular, point[..., None]), angular], -2)
