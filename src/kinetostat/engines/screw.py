"""The in-house engine: screw theory on the description. It never sees Pinocchio.

Joint i sits at the placement A_i in its parent link and moves by exp(s_i q_i), s_i its screw in the joint frame:

    T_child = T_parent A_i exp(s_i q_i)          (a product of exponentials, in local form)
    S_i     = Ad(T_child) s_i                    (its column, a space screw)
    dS_i/dt = [V_child, S_i]                     (a screw carried by its link)
    V_child = Ad(T_child^-1 T_parent) V_parent + s_i qdot_i     (outward, link to link)
    F_link  = its own load + sum of F_child      (inward);   tau_i = S_i . F_child

A batch `(..., nq)` is computed joint by joint over all configurations at once.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np

from kinetostat.conventions import Array, Load, Reference, Velocity, WrenchOrTwist
from kinetostat.screw import se3, so3
from kinetostat.screw.adjoint import adjoint, bracket, carry, coadjoint, cross, twist_matrix
from kinetostat.screw.chain import Chain, screw
from kinetostat.screw.tree import Tree
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
        self.position_names, self.velocity_names = robot.position_names, robot.velocity_names

    # --- the protocol ------------------------------------------------------------------------------------------

    def placement(self, q: Array, frame: str, relative_to: str) -> Array:
        """Return T_a_f = T_a^-1 T_f."""
        placements = self._placements(q, (frame, relative_to))
        placement = se3.inverse(placements[relative_to]) @ placements[frame]
        return np.broadcast_to(placement, (*np.shape(q)[:-1], 4, 4))

    def placements(self, q: Array, frames: Sequence[str]) -> Array:
        """Return T_0_f, from the root outwards."""
        return _stacked(self._all_placements(q), frames, np.shape(q)[:-1])

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

    def jacobians(self, q: Array, frames: Sequence[str], reference: Reference) -> Array:
        """Return for each frame the space screws of the joints above it, carried to its origin and turned."""
        shape, placed = np.shape(q)[:-1], self._all_placements(q)
        columns = np.zeros((*shape, len(frames), 6, self._robot.nv))
        movable = [joint for joint in self._outward if joint.type is not JointType.FIXED]
        space = {joint.name: carry(placed[joint.child], _screws(joint)) for joint in movable}
        for i, frame in enumerate(frames):
            for joint in self._robot.to_root(frame):
                if joint.type is not JointType.FIXED:
                    where, factor = self._columns_of(joint)
                    columns[..., i, :, where] += factor * space[joint.name]
        if reference is Reference.WORLD:
            return columns
        places = _stacked(placed, frames, shape)
        at_origin = _at_point(columns, places[..., :3, 3])
        if reference is Reference.ALIGNED:
            return at_origin
        to_axes = np.swapaxes(places[..., :3, :3], -1, -2)
        return np.concatenate([to_axes @ at_origin[..., :3, :], to_axes @ at_origin[..., 3:, :]], -2)

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

    def link_motions(self, q: Array, qdot: Array, qddot: Array, links: Sequence[str]) -> Array:
        """Return twists and spatial accelerations by outward propagation, each link's from the one before it.

        V_c = Ad(T_c_p) V_p + s qdot,   A_c = Ad(T_c_p) A_p + s qddot + [V_c, s qdot], in the child's axes.
        """
        q, qdot, qddot = (np.asarray(part, dtype=np.float64) for part in (q, qdot, qddot))
        shape = np.broadcast_shapes(q.shape[:-1], qdot.shape[:-1], qddot.shape[:-1])
        motions = {self._robot.root: (np.zeros((*shape, 6)), np.zeros((*shape, 6)))}
        for link in links:
            for joint in reversed([j for j in self._robot.to_root(link) if j.child not in motions]):
                change = adjoint(se3.inverse(self._motion(joint, q)))
                twist, acceleration = (_apply(change, part) for part in motions[joint.parent])
                if joint.type is not JointType.FIXED:
                    where, factor = self._columns_of(joint)
                    own = factor * qdot[..., where] @ _screws(joint).T
                    twist = twist + own
                    pushed = factor * qddot[..., where] @ _screws(joint).T
                    acceleration = acceleration + pushed + bracket(twist, own)
                motions[joint.child] = twist, acceleration
        found = [np.stack(np.broadcast_arrays(*motions[link]), -2) for link in links]
        return np.stack(np.broadcast_arrays(*found), -3) if found else np.zeros((*shape, 0, 2, 6))

    def holding_torques(self, q: Array, gravity: Array, loads: Sequence[Load]) -> Array:
        """Return tau_i = S_i . F_i, F_i what the links beyond joint i are held by."""
        placements = self._placements(q, self._robot.link_by_name)
        held = self._held(placements, gravity, loads)
        torques = np.zeros((*self._load_shape(q, loads), self._robot.nv))
        for joint in self._outward:
            if joint.type is not JointType.FIXED:
                where, factor = self._columns_of(joint)
                space = carry(placements[joint.child], _screws(joint))
                torques[..., where] += factor * _apply(np.swapaxes(space, -1, -2), held[joint.child])
        return torques

    def joint_wrenches(self, q: Array, gravity: Array, loads: Sequence[Load], links: Sequence[str]) -> Array:
        """Return Ad*(T_link^-1) F_link."""
        placements = self._placements(q, self._robot.link_by_name)
        held = self._held(placements, gravity, loads)
        wrenches = np.empty((*self._load_shape(q, loads), len(links), 6))
        for i, link in enumerate(links):
            wrenches[..., i, :] = _apply(coadjoint(se3.inverse(placements[link])), held[link])
        return wrenches

    def gravity_stiffness(self, q: Array, gravity: Array) -> Array:
        """Return the Hessian of the potential energy, U = -sum m g . c.

        With l_j = sum of m dc/dq_j over the links beyond joint j, for i before j: d2U/dq_i dq_j = -g . (w_i x l_j),
        because motion along j displaces masses that joint i turns. Two coordinates of one joint: the one along which
        the robot is moved carries the other's screw.
        """
        placements = self._placements(q, self._robot.link_by_name)
        mass, moment = self._masses_beyond(placements)
        folds, spins, momenta, joints = list[Array](), list[Array](), list[Array](), list[Joint]()
        shape = np.shape(q)[:-1]
        for joint in self._outward:
            if joint.type is not JointType.FIXED:
                where, factor = self._columns_of(joint)
                for k in range(joint.type.nv):
                    space = carry(placements[joint.child], _screws(joint)[:, k : k + 1])[..., 0]
                    spins.append(np.broadcast_to(space[..., 3:], (*shape, 3)))
                    pushed = mass[joint.child] * space[..., :3] + np.cross(space[..., 3:], moment[joint.child])
                    momenta.append(np.broadcast_to(pushed, (*shape, 3)))
                    joints.append(joint)
                    folds.append(factor * np.eye(self._robot.nv)[:, where][:, k])
        if not joints:
            return np.zeros((*shape, 0, 0))
        fold = np.stack(folds)
        # turned[i, j] = -g . (w_i x l_j) = -(g x w_i) . l_j
        turned = -np.cross(np.asarray(gravity), np.stack(spins, -2)) @ np.swapaxes(np.stack(momenta, -2), -1, -2)
        above = {joint.child: {j.name for j in self._robot.to_root(joint.parent)} for joint in joints}
        before = np.array([[i.name in above[j.child] for j in joints] for i in joints])
        after_or_same = np.array([[j.name == i.name or j.name in above[i.child] for j in joints] for i in joints])
        whole = np.where(before, turned, 0.0) + np.where(after_or_same, np.swapaxes(turned, -1, -2), 0.0)
        stiffness: Array = fold.T @ whole @ fold
        return stiffness

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

    def tree(self, names: Sequence[str], rest: Array, masses: Sequence[tuple[str, float, Array]] = ()) -> Tree:
        """Return the tree of screws that the named coordinates move, with the masses of the links that they carry.

        All other joints stay where `rest`, (nq,), has them. Further point masses: link, kg, where in the link (3,), m.
        """
        placed: dict[str, tuple[Array, int]] = {self._robot.root: (np.eye(4), -1)}  # at t = 0, and the screw before
        screws, parents, fold, offset = list[Array](), list[int](), list[Array](), list[float]()
        for joint in self._outward:
            placement, last = placed[joint.parent]
            law = self._robot.followers.get(joint.name, Mimic(joint.name))
            driven = self._robot.joint_by_name[law.joint].position_names
            if joint.type in (JointType.FIXED, JointType.FLOATING) or not set(driven) <= set(names):
                placed[joint.child] = placement @ self._motion(joint, rest), last
                continue
            placement = placement @ _origin(joint.origin)
            for single, name in zip(_screws(joint).T, driven, strict=True):
                screws.append(carry(placement, single[:, None])[:, 0])
                parents.append(last)
                fold.append(law.multiplier * np.array([float(name == other) for other in names]))
                offset.append(law.offset)
                last = len(screws) - 1
            placed[joint.child] = placement, last
        own = [(link.name, link.inertial) for link in self._robot.links if link.inertial is not None]
        every = [(name, body.mass, np.array(body.origin.xyz)) for name, body in own] + list(masses)
        weights, moments = np.zeros(len(screws)), np.zeros((len(screws), 3))
        for link, mass, centre in every:
            placement, last = placed[link]
            if last >= 0:
                weights[last] += mass
                moments[last] += mass * se3.transform(placement, centre)
        centres = np.divide(moments, weights[:, None], out=np.zeros_like(moments), where=weights[:, None] > 0)
        stacked = np.array(screws).reshape(-1, 6).T, tuple(parents), np.array(fold).reshape(-1, len(names))
        return Tree(*stacked, np.array(offset), weights, centres)

    # --- forward kinematics ------------------------------------------------------------------------------------

    def _placements(self, q: Array, frames: Iterable[str]) -> dict[str, Array]:
        """Return T_0_l for the given links and all links above them. The root's own is (4, 4), others (..., 4, 4)."""
        q = np.asarray(q, dtype=np.float64)
        placements: dict[str, Array] = {self._robot.root: np.eye(4)}
        for frame in frames:
            for joint in reversed([j for j in self._robot.to_root(frame) if j.child not in placements]):
                placements[joint.child] = placements[joint.parent] @ self._motion(joint, q)
        return placements

    def _all_placements(self, q: Array) -> dict[str, Array]:
        """Return T_0_l of all links, each once."""
        q = np.asarray(q, dtype=np.float64)
        placements: dict[str, Array] = {self._robot.root: np.eye(4)}
        for joint in self._outward:
            placements[joint.child] = placements[joint.parent] @ self._motion(joint, q)
        return placements

    @cached_property
    def _origins(self) -> dict[str, Array]:
        """A_i of each joint."""
        return {joint.name: _origin(joint.origin) for joint in self._robot.joints}

    def _motion(self, joint: Joint, q: Array) -> Array:
        """Return A_i exp(s_i q_i), the placement of the child link in the parent. (..., nq) -> (..., 4, 4)."""
        origin = self._origins[joint.name]
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

    # --- statics -----------------------------------------------------------------------------------------------

    @cached_property
    def _outward(self) -> list[Joint]:
        """All joints, each after those between it and the root."""
        ordered, stack = list[Joint](), [self._robot.root]
        while stack:
            below = self._robot.child_joints[stack.pop()]
            ordered += below
            stack += [joint.child for joint in below]
        return ordered

    def _load_shape(self, q: Array, loads: Sequence[Load]) -> tuple[int, ...]:
        return np.broadcast_shapes(np.shape(q)[:-1], *(np.shape(load.wrench)[:-1] for load in loads))

    def _held(self, placements: dict[str, Array], gravity: Array, loads: Sequence[Load]) -> dict[str, Array]:
        """Return the wrench by which the link before it (or the ground) holds each link and all beyond it, in space.

        Inward, link to link: F_link = -m g at its centre of mass + what it exerts + sum of F_child.
        """
        held: dict[str, Array] = {}
        for link in self._robot.links:
            held[link.name] = np.zeros(6)
            if link.inertial is not None:
                weight = -link.inertial.mass * np.asarray(gravity, dtype=np.float64)
                centre = se3.transform(placements[link.name], np.array(link.inertial.origin.xyz))
                held[link.name] = _through(centre, weight)
        for load in loads:
            turn = placements[load.at.expressed_in][..., :3, :3]
            force, moment = _apply(turn, load.wrench[..., :3]), _apply(turn, load.wrench[..., 3:])
            exerted = _through(self._point(placements, load.at), force)
            exerted[..., 3:] += moment
            held[load.at.of] = held[load.at.of] + exerted
        for joint in reversed(self._outward):
            held[joint.parent] = held[joint.parent] + held[joint.child]
        return held

    def _masses_beyond(self, placements: dict[str, Array]) -> tuple[dict[str, float], dict[str, Array]]:
        """Return for each link the mass of it and all links beyond it, and the sum of mass times centre, in space."""
        mass, moment = dict[str, float](), dict[str, Array]()
        for link in self._robot.links:
            inertial = link.inertial
            mass[link.name] = 0.0 if inertial is None else inertial.mass
            at = _ORIGIN if inertial is None else np.array(inertial.origin.xyz)
            moment[link.name] = mass[link.name] * se3.transform(placements[link.name], at)
        for joint in reversed(self._outward):
            mass[joint.parent] += mass[joint.child]
            moment[joint.parent] = moment[joint.parent] + moment[joint.child]
        return mass, moment

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


def _stacked(placements: dict[str, Array], frames: Sequence[str], shape: tuple[int, ...]) -> Array:
    """Return the placements of some frames, one beside the other. (*shape, k, 4, 4)."""
    found = np.empty((*shape, len(frames), 4, 4))
    for i, frame in enumerate(frames):
        found[..., i, :, :] = placements[frame]
    return found


def _apply(matrix: Array, vector: Array) -> Array:
    result: Array = (matrix @ vector[..., None])[..., 0]
    return result


def _through(point: Array, force: Array) -> Array:
    """Return the wrench (f ; p x f) about the origin of a force through a point. (..., 3), (..., 3) -> (..., 6)."""
    force = np.broadcast_to(force, np.broadcast_shapes(np.shape(point), np.shape(force)))
    return np.concatenate([force, np.cross(point, force)], -1)


def _at_point(columns: Array, point: Array) -> Array:
    """Return the columns (v + w x p ; w) of (v ; w): the velocity of the point, not of the one at the origin."""
    angular = columns[..., 3:, :]
    return np.concatenate([columns[..., :3, :] + cross(angular, point[..., None]), angular], -2)
