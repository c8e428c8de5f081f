"""The Pinocchio engine. It reads the canonical text by itself and shares nothing with the screw engine.

The only module that imports pinocchio, and the seam where its conventions become ours. Hidden here: nq != nv of
continuous joints (cos, sin) and planar joints, Pinocchio's joint order (depth first, by name), mimic joints (loaded
as independent ones and folded by the chain rule, because Pinocchio's own do not take followers before leaders, or
chains), FrameType, and the joints that its URDF parser does not know: screws, and planar joints whose normal is not z.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin

from kinetostat.conventions import (
    FLOATING_BASE_JOINT,
    FLOATING_POSITION,
    PLANAR_POSITION,
    PLANAR_VELOCITY,
    TWIST_ROWS,
    WORLD_LINK,
    Array,
    Load,
    Reference,
    Velocity,
    WrenchOrTwist,
)
from kinetostat.errors import EngineError, printable

__all__ = ["PinocchioEngine"]

_BODY = pin.FrameType.BODY
_AT_FRAME = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
_REFERENCES = {
    Reference.ALIGNED: _AT_FRAME,
    Reference.LOCAL: pin.ReferenceFrame.LOCAL,
    Reference.WORLD: pin.ReferenceFrame.WORLD,
}


@dataclass
class _Joint:
    """A movable joint as the text has it, and where Pinocchio keeps it."""

    name: str
    type: str
    axis: Array
    pitch: float | None = None
    leader: str | None = None
    multiplier: float = 1.0
    offset: float = 0.0
    q: int = 0  # first index in Pinocchio's configuration
    v: int = 0  # first index in Pinocchio's velocity
    columns: slice = field(default_factory=lambda: slice(0, 0))
    positions: slice = field(default_factory=lambda: slice(0, 0))

    @property
    def position_names(self) -> list[str]:
        parts = {"floating": FLOATING_POSITION, "planar": PLANAR_POSITION}.get(self.type)
        return [self.name] if parts is None else [f"{self.name}.{part}" for part in parts]

    @property
    def velocity_names(self) -> list[str]:
        parts = {"floating": TWIST_ROWS, "planar": PLANAR_VELOCITY}.get(self.type)
        return [self.name] if parts is None else [f"{self.name}.{part}" for part in parts]


class PinocchioEngine:
    """Kinematics by Pinocchio; see `engines.protocol.Engine` for what the methods return.

    Raises:
        EngineError: Pinocchio refuses the text; the message holds what it wrote on descriptor 2.
    """

    name = "pinocchio"

    def __init__(self, text: str, *, floating_base: bool = False) -> None:
        self._floating_base = floating_base
        self._model = _build(text, floating_base)
        self._joints = _read_joints(text, floating_base)
        for joint in self._joints:
            self._install(joint)
        self._lead()
        self.position_names = tuple(n for j in self._joints if j.leader is None for n in j.position_names)
        self.velocity_names = tuple(n for j in self._joints if j.leader is None for n in j.velocity_names)

    # --- building ----------------------------------------------------------------------------------------------

    def _install(self, joint: _Joint) -> None:
        """Find a joint in the model, and put right what Pinocchio's URDF parser does not know of it."""
        # Not getJointId: joint 0 is Pinocchio's own `universe`, and a file may call a joint so, too.
        index = next((i for i in range(1, self._model.njoints) if self._model.names[i] == joint.name), None)
        if index is None:
            raise EngineError(f"Pinocchio has no joint {printable(joint.name)!r}")
        model_joint = self._model.joints[index]
        if joint.pitch is not None:
            direction = joint.axis / np.linalg.norm(joint.axis)
            helical = pin.JointModelHelicalUnaligned(direction, joint.pitch / (2 * np.pi))
            helical.setIndexes(model_joint.id, model_joint.idx_q, model_joint.idx_v)
            self._model.joints[index] = pin.JointModel(helical)
        elif joint.type != "floating":
            # A plane is x-y to Pinocchio whatever the axis, and an axis within 1e-12 of x, y or z is that axis.
            taken = 2 if joint.type == "planar" else "XYZ".find(model_joint.shortname()[-1])
            direction = joint.axis / np.linalg.norm(joint.axis)
            if taken >= 0 and not np.array_equal(direction, np.eye(3)[taken]):
                self._turn(index, _smallest_rotation(taken, direction))
        joint.q, joint.v = model_joint.idx_q, model_joint.idx_v

    def _turn(self, index: int, rotation: Array) -> None:
        """Turn the frame of a joint, and turn everything that hangs on the joint back."""
        turn = pin.SE3(rotation, np.zeros(3))
        model = self._model
        model.jointPlacements[index] = model.jointPlacements[index] * turn
        model.inertias[index] = turn.actInv(model.inertias[index])
        for child in range(1, model.njoints):
            if model.parents[child] == index:
                model.jointPlacements[child] = turn.actInv(model.jointPlacements[child])
        for frame in model.frames:
            if frame.parentJoint == index:
                frame.placement = turn.actInv(frame.placement)

    def _lead(self) -> None:
        """Resolve chains of followers, and number positions and columns of the independent joints in file order."""
        by_name = {joint.name: joint for joint in self._joints}
        for joint in self._joints:
            while joint.leader is not None and (above := by_name[joint.leader]).leader is not None:
                joint.offset += joint.multiplier * above.offset
                joint.multiplier *= above.multiplier
                joint.leader = above.leader
        nq = nv = 0
        for joint in self._joints:
            if joint.leader is None:
                joint.positions = slice(nq, nq := nq + len(joint.position_names))
                joint.columns = slice(nv, nv := nv + len(joint.velocity_names))
        for joint in self._joints:
            if joint.leader is not None:
                joint.positions, joint.columns = by_name[joint.leader].positions, by_name[joint.leader].columns
        # V_pinocchio = fold qdot: the chain rule of mimic joints and the change of order in one matrix.
        self._fold = np.zeros((self._model.nv, nv))
        for joint in self._joints:
            count = len(joint.velocity_names)
            self._fold[joint.v : joint.v + count, joint.columns] = joint.multiplier * np.eye(count)

    @cached_property
    def _data(self) -> Any:
        """What Pinocchio computes with; made when first used, because it holds tensors of nv^3 (0.9 GB for 300)."""
        with _translated("Data"):
            return pin.Data(self._model)  # createData returns a copy of one, and so takes twice as much

    # --- the protocol ------------------------------------------------------------------------------------------

    def placement(self, q: Array, frame: str, relative_to: str) -> Array:
        """Return T_a_f."""
        f, a = self._frame(frame), self._frame(relative_to)

        def placement(full: Array) -> Array:
            self._place(full)
            matrix: Array = self._data.oMf[a].actInv(self._data.oMf[f]).homogeneous
            return matrix

        return self._each(placement, q)

    def placements(self, q: Array, frames: Sequence[str]) -> Array:
        """Return Pinocchio's oMf of each frame."""
        indices = [self._frame(frame) for frame in frames]

        def placements(full: Array) -> Array:
            self._place(full)
            found = [self._data.oMf[i].homogeneous for i in indices]
            return np.array(found).reshape(-1, 4, 4)

        return self._each(placements, q)

    def frame_change(self, q: Array, start: str, end: str, kind: WrenchOrTwist) -> Array:
        """Return Pinocchio's action matrix of T_end_start, or its dual for wrenches."""
        s, e = self._frame(start), self._frame(end)

        def change(full: Array) -> Array:
            self._place(full)
            placement = self._data.oMf[e].actInv(self._data.oMf[s])
            matrix: Array = placement.action if kind is WrenchOrTwist.TWIST else placement.dualAction
            return matrix

        return self._each(change, q)

    def jacobian(self, q: Array, velocity: Velocity) -> Array:
        """Return J from Pinocchio's Jacobians of F and A at their origins, in the root's axes."""
        if self._model.nv == 0:  # pin 4.1 dies on a Jacobian without columns
            return np.zeros((*np.shape(q)[:-1], 6, 0))

        def jacobian(full: Array) -> Array:
            pin.computeJointJacobians(self._model, self._data, full)
            pin.updateFramePlacements(self._model, self._data)
            return self._turned(*self._relative(velocity), velocity)

        return self._each(jacobian, q)

    def jacobians(self, q: Array, frames: Sequence[str], reference: Reference) -> Array:
        """Return Pinocchio's frame Jacobians in its LOCAL_WORLD_ALIGNED, LOCAL or WORLD, folded onto the leaders."""
        indices, native = [self._frame(frame) for frame in frames], _REFERENCES[reference]
        count = self._model.nv
        if count == 0 or not indices:
            return np.zeros((*np.shape(q)[:-1], len(indices), 6, self._fold.shape[1]))

        def jacobians(full: Array) -> Array:
            pin.computeJointJacobians(self._model, self._data, full)
            pin.updateFramePlacements(self._model, self._data)
            each = [pin.getFrameJacobian(self._model, self._data, i, native).reshape(6, count) for i in indices]
            folded: Array = np.array(each).reshape(-1, count) @ self._fold
            return folded.reshape(len(indices), 6, -1)

        return self._each(jacobians, q)

    def jacobian_rate(self, q: Array, qdot: Array, velocity: Velocity) -> Array:
        """Return dJ/dt from Pinocchio's time variation of the same two Jacobians."""
        if self._model.nv == 0:
            return np.zeros((*np.shape(q)[:-1], 6, 0))

        def rate(full: Array, rates: Array) -> Array:
            pin.computeJointJacobiansTimeVariation(self._model, self._data, full, self._fold @ rates)
            pin.updateFramePlacements(self._model, self._data)
            return self._rate(velocity, rates)

        return self._each(rate, q, qdot)

    def link_motions(self, q: Array, qdot: Array, qddot: Array, links: Sequence[str]) -> Array:
        """Return Pinocchio's frame velocities and spatial accelerations, LOCAL."""
        frames = [self._frame(link) for link in links]

        def motions(full: Array, rates: Array, accelerations: Array) -> Array:
            pin.forwardKinematics(self._model, self._data, full, self._fold @ rates, self._fold @ accelerations)
            found = np.zeros((len(frames), 2, 6))
            for i, frame in enumerate(frames):
                found[i, 0] = pin.getFrameVelocity(self._model, self._data, frame, pin.LOCAL).vector
                found[i, 1] = pin.getFrameAcceleration(self._model, self._data, frame, pin.LOCAL).vector
            return found

        return self._each(motions, q, qdot, qddot)

    def holding_torques(self, q: Array, gravity: Array, loads: Sequence[Load]) -> Array:
        """Return Pinocchio's RNEA at rest, with what the robot exerts acting back on it, folded onto the leaders."""
        self._model.gravity.linear = np.asarray(gravity, dtype=np.float64)
        still = np.zeros(self._model.nv)

        def torques(full: Array, *wrenches: Array) -> Array:
            if not loads:
                tau = pin.computeGeneralizedGravity(self._model, self._data, full)
            else:
                self._place(full)
                back = pin.StdVec_Force()
                back.extend([pin.Force.Zero()] * self._model.njoints)
                for load, wrench in zip(loads, wrenches, strict=True):
                    joint = self._model.frames[self._frame(load.at.of)].parentJoint
                    back[joint] -= self._data.oMi[joint].actInv(self._exerted(load, wrench))
                tau = pin.rnea(self._model, self._data, full, still, still, back)
            folded: Array = self._fold.T @ tau
            return folded

        return self._each(torques, q, *(load.wrench for load in loads))

    def joint_wrenches(self, q: Array, gravity: Array, loads: Sequence[Load], links: Sequence[str]) -> Array:
        """Return what balances weight and loads of everything beyond each link, from composite bodies.

        Not computeSupportedInertiaByFrame, which takes the wrong subtree for frames of bodies (pin 4.1).
        """
        down, frames = np.asarray(gravity, dtype=np.float64), [self._frame(link) for link in links]
        carriers = [self._carriers(load.at.of) for load in loads]

        def held(full: Array, *wrenches: Array) -> Array:
            self._place(full)
            mass, moment = self._beyond()
            found = np.zeros((len(frames), 6))
            exerted = [self._exerted(load, wrench) for load, wrench in zip(loads, wrenches, strict=True)]
            for i, frame in enumerate(frames):
                balance = pin.Force(-mass[frame] * down, np.cross(-moment[frame], down))
                for carrying, wrench in zip(carriers, exerted, strict=True):
                    if frame in carrying:
                        balance += wrench
                found[i] = self._data.oMf[frame].actInv(balance).vector
            return found

        return self._each(held, q, *(load.wrench for load in loads))

    def gravity_stiffness(self, q: Array, gravity: Array) -> Array:
        """Return Pinocchio's derivative of the generalized gravity, folded from both sides."""
        self._model.gravity.linear = np.asarray(gravity, dtype=np.float64)

        def stiffness(full: Array) -> Array:
            whole = pin.computeGeneralizedGravityDerivatives(self._model, self._data, full)
            return self._folded(self._folded(whole).T).T

        return self._each(stiffness, q)

    def masses(self) -> tuple[float, float]:
        """Return the mass of the base link and of all other links, in kg.

        Pinocchio lumps a link with what is fixed to it; a fixed joint's frame keeps the share that it brought.
        """
        if self._floating_base:  # the base is the massless `universe`
            return 0.0, float(sum(inertia.mass for inertia in self._model.inertias))
        base = next(frame for frame in self._model.frames if frame.type == _BODY).parentJoint
        fixed_on = sum(
            frame.inertia.mass
            for frame in self._model.frames
            if frame.parentJoint == base and frame.type == pin.FrameType.FIXED_JOINT
        )
        lumped = float(self._model.inertias[base].mass)
        total = float(sum(inertia.mass for inertia in self._model.inertias))
        return lumped - float(fixed_on), total - lumped + float(fixed_on)

    # --- one configuration -------------------------------------------------------------------------------------

    def _exerted(self, load: Load, wrench: Array) -> Any:
        """Return a load as a force about the root's origin, in the root's axes."""
        turn = self._data.oMf[self._frame(load.at.expressed_in)].rotation
        return pin.SE3(np.eye(3), self._point(load.at)).act(pin.Force(turn @ wrench[:3], turn @ wrench[3:]))

    @cached_property
    def _shares(self) -> list[tuple[float, Array]]:
        """Return each frame's own mass, and its centre of mass times mass in the frame: zero but for links.

        Pinocchio lumps a link with what is fixed to it. The frame of a fixed joint keeps what that joint brought, which
        is its link's own; a link on a moving joint has what is left; a base link keeps its own.
        """
        frames, shares = self._model.frames, list[tuple[float, Array]]()
        for frame in frames:
            above = frames[frame.parentFrame]
            fixed = above.type == pin.FrameType.FIXED_JOINT and frame.parentFrame > 0  # 0 is Pinocchio's own universe
            inertia = above.inertia if fixed else frame.inertia
            mass, moment = float(inertia.mass), inertia.mass * inertia.lever
            if above.type == pin.FrameType.JOINT:
                whole = self._model.inertias[frame.parentJoint]
                mass, moment = float(whole.mass), whole.mass * whole.lever
                for other in frames:
                    if other.parentJoint == frame.parentJoint and other.type == pin.FrameType.FIXED_JOINT:
                        brought = other.placement.act(other.inertia)
                        mass, moment = mass - brought.mass, moment - brought.mass * brought.lever
                moment = frame.placement.rotation.T @ (moment - mass * frame.placement.translation)
            shares.append((mass, moment) if frame.type == _BODY else (0.0, np.zeros(3)))
        return shares

    def _beyond(self) -> tuple[Array, Array]:
        """Return mass, and centre of mass times mass in the root's axes, of each frame and all frames beyond it."""
        mass, moment = np.zeros(self._model.nframes), np.zeros((self._model.nframes, 3))
        for i in range(self._model.nframes - 1, -1, -1):
            place, (own, lever) = self._data.oMf[i], self._shares[i]
            mass[i] += own
            moment[i] += own * place.translation + place.rotation @ lever
            if i:
                parent = self._model.frames[i].parentFrame
                mass[parent] += mass[i]
                moment[parent] += moment[i]
        return mass, moment

    def _carriers(self, name: str) -> set[int]:
        """Return the frames of a link and of everything between it and the root: what carries a load on it."""
        frame, found = self._frame(name), {self._frame(name), 0}
        while frame:
            frame = int(self._model.frames[frame].parentFrame)
            found.add(frame)
        return found

    @cached_property
    def _bodies(self) -> dict[str, int]:
        """The frames of bodies by name: getFrameId looks through all frames each time."""
        found = {frame.name: i for i, frame in enumerate(self._model.frames) if frame.type == _BODY}
        return {WORLD_LINK: 0} | found

    def _frame(self, name: str) -> int:
        if name not in self._bodies:
            raise EngineError(f"Pinocchio has no link {printable(name)!r}")
        return self._bodies[name]

    def _configurations(self, q: Array) -> Array:
        """Return Pinocchio's configurations: its order, followers set, angles of unbounded joints as (cos, sin)."""
        full = np.zeros((len(q), self._model.nq))
        for joint in self._joints:
            part = q[:, joint.positions]
            if joint.type == "continuous":
                angle = joint.multiplier * part[:, 0] + joint.offset
                full[:, joint.q], full[:, joint.q + 1] = np.cos(angle), np.sin(angle)
            elif joint.type == "planar":
                full[:, joint.q : joint.q + 2] = part[:, :2]
                full[:, joint.q + 2], full[:, joint.q + 3] = np.cos(part[:, 2]), np.sin(part[:, 2])
            elif joint.type == "floating":
                full[:, joint.q : joint.q + 3] = part[:, :3]
                full[:, joint.q + 3 : joint.q + 7] = part[:, 3:] / np.linalg.norm(part[:, 3:], axis=1, keepdims=True)
            else:
                full[:, joint.q] = joint.multiplier * part[:, 0] + joint.offset
        return full

    def _each(self, evaluate: Callable[..., Array], q: Array, *others: Array) -> Array:
        """Evaluate at each configuration in turn, with its own part of the others; stack over the leading shape."""
        parts = [np.asarray(part, dtype=np.float64) for part in (q, *others)]
        shape = np.broadcast_shapes(*(part.shape[:-1] for part in parts))
        count = int(np.prod(shape))
        many = [np.broadcast_to(part, (*shape, part.shape[-1])).reshape(count, part.shape[-1]) for part in parts]
        if not count:  # an empty batch still has a shape
            one = evaluate(pin.neutral(self._model), *(np.zeros(part.shape[-1]) for part in many[1:]))
            return np.zeros((*shape, *one.shape))
        # Results are often views of Pinocchio's data, which the next configuration overwrites.
        rows = zip(self._configurations(many[0]), *many[1:], strict=True)
        results = [np.array(evaluate(full, *rest)) for full, *rest in rows]
        return np.stack(results).reshape(*shape, *results[0].shape)

    def _folded(self, rows: Array) -> Array:
        """Return fold^T rows without the product of matrices, which for a hundred joints wakes BLAS's threads."""
        folded = np.zeros((self._fold.shape[1], rows.shape[1]))
        from_, to = np.nonzero(self._fold)
        np.add.at(folded, to, self._fold[from_, to][:, None] * rows[from_])
        return folded

    def _place(self, full: Array) -> None:
        """Set all placements."""
        pin.forwardKinematics(self._model, self._data, full)
        pin.updateFramePlacements(self._model, self._data)

    def _at_origin(self, frame: int) -> tuple[Array, Array]:
        """Return the linear and angular rows (3, nv) of a frame's origin, in the root's axes."""
        # With one degree of freedom Pinocchio gives (6,), not (6, 1).
        columns = pin.getFrameJacobian(self._model, self._data, frame, _AT_FRAME).reshape(6, -1)
        folded = columns @ self._fold
        return folded[:3], folded[3:]

    def _point(self, velocity: Velocity) -> Array:
        """Return the point of the labelled velocity in the root's coordinates."""
        if velocity.point is None:
            return np.array(self._data.oMf[self._frame(velocity.relative_to)].translation)
        return np.array(self._data.oMf[self._frame(velocity.of)].act(np.array(velocity.point)))

    def _relative(self, velocity: Velocity) -> tuple[Array, Array]:
        """Return v_f(P) - v_a(P) and w_f - w_a as rows (3, nv), in the root's axes."""
        point = self._point(velocity)
        rows = []
        for name in (velocity.of, velocity.relative_to):
            frame = self._frame(name)
            linear, angular = self._at_origin(frame)
            rows.append((linear - pin.skew(point - self._data.oMf[frame].translation) @ angular, angular))
        return rows[0][0] - rows[1][0], rows[0][1] - rows[1][1]

    def _turned(self, linear: Array, angular: Array, velocity: Velocity) -> Array:
        to_axes = self._data.oMf[self._frame(velocity.expressed_in)].rotation.T
        return np.vstack([to_axes @ linear, to_axes @ angular])

    def _rate(self, velocity: Velocity, qdot: Array) -> Array:
        """Differentiate `_relative` and the turn to the axes, everything in the root's axes."""
        point = self._point(velocity)
        carrier = self._frame(velocity.of if velocity.point is not None else velocity.relative_to)
        linear, angular = self._at_origin(carrier)
        arm = point - self._data.oMf[carrier].translation
        point_rate = linear @ qdot + np.cross(angular @ qdot, arm)
        parts = []
        for name in (velocity.of, velocity.relative_to):
            frame = self._frame(name)
            linear, angular = self._at_origin(frame)
            rates = pin.getFrameJacobianTimeVariation(self._model, self._data, frame, _AT_FRAME).reshape(6, -1)
            varied = rates @ self._fold
            arm = point - self._data.oMf[frame].translation
            arm_rate = point_rate - linear @ qdot
            parts.append((varied[:3] - pin.skew(arm) @ varied[3:] - pin.skew(arm_rate) @ angular, varied[3:]))
        _, axes_angular = self._at_origin(self._frame(velocity.expressed_in))
        turning = pin.skew(axes_angular @ qdot)
        linear, angular = self._relative(velocity)
        linear_rate = parts[0][0] - parts[1][0] - turning @ linear
        angular_rate = parts[0][1] - parts[1][1] - turning @ angular
        return self._turned(linear_rate, angular_rate, velocity)


def _read_joints(text: str, floating_base: bool) -> list[_Joint]:
    """Return the movable joints of the text in file order, with what Pinocchio's parser leaves out."""
    joints = []
    if floating_base:
        joints.append(_Joint(FLOATING_BASE_JOINT, "floating", np.array([0.0, 0.0, 1.0])))
    for element in ET.fromstring(text).iter("joint"):  # noqa: S314 (the text is ours, by urdf.canonical)
        kind = element.get("type", "")
        if kind == "fixed":
            continue
        axis = element.find("axis")
        words = "1 0 0" if axis is None else axis.get("xyz", "1 0 0")
        joint = _Joint(element.get("name", ""), kind, np.array([float(word) for word in words.split()]))
        pitch, mimic = element.find("screw_thread_pitch"), element.find("mimic")
        if pitch is not None:
            joint.pitch = float(pitch.get("value", "0"))
        if mimic is not None:
            joint.leader = mimic.get("joint")
            joint.multiplier = float(mimic.get("multiplier", "1"))
            joint.offset = float(mimic.get("offset", "0"))
        joints.append(joint)
    names = {joint.name for joint in joints}
    for joint in joints:
        if joint.leader not in names:  # the reader says so in a remark
            joint.leader, joint.multiplier, joint.offset = None, 1.0, 0.0
    return joints


def _smallest_rotation(along: int, direction: Array) -> Array:
    """Return the smallest rotation of a coordinate axis to a direction; to its opposite, by the axis that comes next.

    Not Quaternion.FromTwoVectors, which loses digits near the opposite, and all of them within 1e-6 of it.
    """
    i, j = (along + 1) % 3, (along + 2) % 3
    sine = float(np.hypot(direction[i], direction[j]))
    if sine == 0:
        return np.eye(3) if direction[along] > 0 else np.diag([1.0 if k == i else -1.0 for k in range(3)])
    half = float(np.arctan2(sine, direction[along])) / 2
    vector = np.zeros(3)
    vector[i], vector[j] = -direction[j] / sine * np.sin(half), direction[i] / sine * np.sin(half)
    rotation: Array = pin.Quaternion(np.cos(half), *vector).toRotationMatrix()
    return rotation


def _build(text: str, floating_base: bool) -> Any:
    """Return Pinocchio's model of the text."""
    with _translated("the URDF parser"):
        if floating_base:
            return pin.buildModelFromXML(text, pin.JointModelFreeFlyer(), FLOATING_BASE_JOINT)
        return pin.buildModelFromXML(text)


@contextlib.contextmanager
def _translated(what: str) -> Iterator[None]:
    """Turn what Pinocchio raises into our error, with what it wrote on descriptor 2, where its reasons go."""
    with tempfile.TemporaryFile() as written:
        kept = os.dup(2)
        os.dup2(written.fileno(), 2)
        try:
            yield
        except Exception as error:
            written.seek(0)
            lines = [line.strip() for line in written.read().decode("utf-8", "replace").splitlines()]
            said = " ".join(line for line in lines if line and not line.startswith("at line"))
            reason = printable(said or " ".join(str(error).split()) or type(error).__name__)[:300]
            raise EngineError(f"Pinocchio ({what}) refuses the robot: {reason}") from error
        finally:
            os.dup2(kept, 2)
            os.close(kept)
