"""What is in a robot file: joints, chains, masses, and what is odd about it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.crosscheck import Certificate, certified
from kinetostat.engines.model import Model
from kinetostat.errors import quote
from kinetostat.urdf.description import Inertial, Joint, JointType, Remark, Robot

__all__ = ["Chain", "Summary", "summary"]

_MANY_MESHES = 1000  # different names of meshes that are looked for
_FEW = 3  # meshes named one by one; beyond it they are counted


@dataclass(frozen=True)
class Chain:
    """The way from the root to one tip, and the independent joints that move the tip."""

    tip: str
    joints: tuple[str, ...]


@dataclass(frozen=True)
class Summary:
    """What a robot is made of.

    Attributes:
        robot: the description.
        chains: every tip with its joints.
        base_mass: mass of the root link, kg.
        moving_mass: mass of all other links, kg.
        reach: longest path from the root, stretched out, m.
        states: names of SRDF states; groups: joints of each SRDF group.
        remarks: what is odd about the file.
        certificate: what the two engines say of the masses.
    """

    robot: Robot
    chains: tuple[Chain, ...]
    base_mass: float
    moving_mass: float
    reach: float
    states: tuple[str, ...]
    groups: dict[str, tuple[str, ...]]
    remarks: tuple[Remark, ...]
    certificate: Certificate


def summary(model: Model) -> Summary:
    """Return what is in a robot file. Masses are summed by both engines.

    Args:
        model: the robot.

    Raises:
        EngineError: Pinocchio refuses the robot.
    """
    robot = model.robot
    total = sum(link.inertial.mass for link in robot.links if link.inertial)
    masses, certificate = certified(model, lambda engine: np.array(engine.masses()), abs(total))
    chains = tuple(Chain(tip, tuple(j.name for j in robot.movable_path(robot.root, tip))) for tip in robot.tips)
    remarks = sorted(
        (*robot.remarks, *_odd_names(robot), *_odd_joints(robot), *_odd_inertials(robot), *_lost_meshes(model)),
        key=_place,
    )
    return Summary(
        robot,
        chains,
        float(masses[0]),
        float(masses[1]),
        robot.reach,
        tuple(model.semantics.state_names()),
        model.semantics.groups,
        tuple(remarks),
        certificate,
    )


def _place(remark: Remark) -> int:
    return remark.line


def _odd_names(robot: Robot) -> list[Remark]:
    remarks = []
    lowered: dict[str, str] = {}
    for kind, named in (("link", robot.links), ("joint", robot.joints)):
        for thing in named:
            label = f"<{kind} name={quote(thing.name, 40)}>"
            if not thing.name.isprintable() or thing.name != "".join(thing.name.split()):
                remarks.append(Remark(thing.line, label, "white space or an unprintable character in the name"))
            other = lowered.setdefault(f"{kind} {thing.name.lower()}", thing.name)
            if other != thing.name:
                remarks.append(Remark(thing.line, label, f"differs from {quote(other)} by upper and lower case only"))
            if kind == "joint" and thing.name in robot.link_by_name:
                remarks.append(Remark(thing.line, label, "a link has the same name"))
    return remarks


def _odd_joints(robot: Robot) -> list[Remark]:
    remarks = []
    for joint in robot.joints:
        lower, upper = joint.limit.range
        if joint.mimic is None and joint.type.nq == 1 and not lower <= 0 <= upper:
            remarks.append(
                Remark(joint.line, _label(joint), f"position 0 is outside its limits [{lower:.6g}, {upper:.6g}]")
            )
        if joint.type is JointType.FLOATING and joint.line:
            remarks.append(
                Remark(joint.line, _label(joint), "a floating joint: most tools want it left out of the file")
            )
    if not robot.independent and robot.joints:
        remarks.append(Remark(0, "<robot>", "no joint can move"))
    return remarks


def _odd_inertials(robot: Robot) -> list[Remark]:
    return [
        Remark(link.line, f"<link name={quote(link.name, 40)}>", fault)
        for link in robot.links
        if link.inertial is not None and (fault := _fault(link.inertial))
    ]


def _fault(inertial: Inertial) -> str | None:
    """Return what no rigid body can have: negative mass or moments, or moments that break the triangle inequality."""
    ixx, ixy, ixz, iyy, iyz, izz = inertial.inertia
    if inertial.mass < 0:
        return f"mass {inertial.mass:g} kg is negative"
    if not any(inertial.inertia):
        return None
    if inertial.mass == 0:
        return "inertia without mass"
    moments = np.linalg.eigvalsh(np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]))
    slack = 1e-6 * float(np.max(np.abs(moments)))
    shown = ", ".join(f"{m:.3g}" for m in moments)
    if moments[0] < -slack:
        return f"inertia is not positive: principal moments {shown} kg m2"
    if moments[0] + moments[1] < moments[2] - slack:
        return f"inertia breaks the triangle inequality: principal moments {shown} kg m2"
    return None


def _lost_meshes(model: Model) -> list[Remark]:
    """Return a remark for each mesh that leads nowhere, or one for all of them. Nothing is opened."""
    reasons: dict[str, list[tuple[int, str]]] = {}
    seen: dict[str, str | None] = {}
    for link in model.robot.links:
        for mesh in link.meshes:
            if mesh.uri not in seen and len(seen) == _MANY_MESHES:
                return [
                    *_mesh_remarks(reasons),
                    Remark(mesh.line, "<mesh>", f"only {_MANY_MESHES} names were looked for"),
                ]
            if mesh.uri not in seen:
                found = model.loaded.packages.resolve(mesh.uri)
                seen[mesh.uri] = found if isinstance(found, str) else None
            reason = seen[mesh.uri]
            if reason is not None:
                reasons.setdefault(reason, []).append((mesh.line, mesh.uri))
    return _mesh_remarks(reasons)


def _mesh_remarks(reasons: dict[str, list[tuple[int, str]]]) -> list[Remark]:
    remarks = []
    for reason, meshes in reasons.items():
        if len(meshes) > _FEW:
            remarks.append(
                Remark(meshes[0][0], "<mesh>", f"{len(meshes)} meshes, {quote(meshes[0][1])} the first: {reason}")
            )
        else:
            remarks += [Remark(line, "<mesh>", f"{quote(uri)}: {reason}") for line, uri in meshes]
    return remarks


def _label(joint: Joint) -> str:
    return f"<joint name={quote(joint.name, 40)}>"
