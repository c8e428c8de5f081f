"""The profile of one limb."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from kinetostat.analysis.capacity import Strongest, strongest
from kinetostat.analysis.configuration import configuration, random_configurations
from kinetostat.analysis.coordinates import coordinates
from kinetostat.analysis.crosscheck import Certificate
from kinetostat.analysis.farthest import bounded_joints, farthest
from kinetostat.analysis.kinematics import fk
from kinetostat.analysis.loads import Payload, effort_limits
from kinetostat.analysis.profile.anatomy import Limb
from kinetostat.analysis.profile.gathering import Gathered
from kinetostat.analysis.profile.holding import held_pose
from kinetostat.analysis.profile.measuring import Measured, measured
from kinetostat.analysis.profile.posing import limb_poses
from kinetostat.analysis.profile.result import LimbPose, LimbProfile
from kinetostat.analysis.profile.section import Section
from kinetostat.analysis.profile.sections import sections
from kinetostat.analysis.singular.find import SingularFamilies, singular_find
from kinetostat.analysis.statics import torque
from kinetostat.analysis.sweeping.sweep import Sweep
from kinetostat.analysis.worst import WorstTorques, worst_torques
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError, quoted
from kinetostat.screw import se3
from kinetostat.urdf.description import JointType

__all__ = ["Asked", "limb_profile"]

_FARTHEST = 64  # of the sweep's configurations, from which the climb for the reach chooses
_SECTIONS = "map of the reach"
_SEARCHED = 20  # joints: time and memory of what is looked for in pairs of joints grow with their square
_DRAWN = 2000  # configurations for that where there is no sweep


@dataclass(frozen=True)
class Asked:
    """What is asked of each limb: see `profiling.profile`; `weightless` is why nothing can be said of weight."""

    samples: int
    seed: int
    payload: float | None
    starts: int
    weightless: str | None


def limb_profile(
    model: Model,
    limb: Limb,
    asked: Asked,
    certificates: dict[str, Certificate],
    tell: Callable[[str, float], None],
) -> LimbProfile:
    """Return the profile of a limb. What is refused is None, with its reason.

    Args:
        model: the robot.
        limb: which limb.
        asked: how much is asked of it.
        certificates: takes those of all answers, by what was asked.
        tell: told what is being done, and which share of the limb that is.
    """
    gathered = Gathered(certificates, limb.name)
    middle = configuration(model, "mid").q
    tell("manipulability", 0.0)
    effort = _effort_is_known(model, limb, asked, gathered)
    rows = measured(model, limb, middle, gathered, effort=effort, samples=asked.samples, seed=asked.seed)
    swept = None if rows is None else rows.sweep
    tell("reach", 0.2)
    reach = gathered.attempt("reach", lambda: _reach(model, limb, middle, rows, asked.seed, gathered))
    tell("torques", 0.3)
    payload = _payload(model, limb, middle, asked, gathered)
    loaded = _loaded(model, limb, middle, asked, gathered)
    tell("poses", 0.5)
    poses = () if swept is None else gathered.attempt("poses", lambda: limb_poses(model, limb, swept, gathered)) or ()
    tell("singular configurations", 0.6)
    families = gathered.attempt("singular families", lambda: _families(model, limb, asked, gathered))
    tell("sections", 0.9)
    shown = None
    if swept is not None:
        shown = gathered.attempt(_SECTIONS, lambda: _sections(model, limb, swept, poses, families))
        if shown == ():
            gathered.leave(_SECTIONS, "no two joints move the tool over an area")
        elif shown is not None:
            gathered.certify(_SECTIONS, *(section.certificate for section in shown))
    return LimbProfile(
        limb,
        swept,
        np.zeros((0, 3)) if rows is None else rows.positions,
        np.zeros(0) if rows is None else rows.smallest,
        reach,
        payload,
        poses,
        families,
        shown or (),
        loaded,
        tuple(gathered.left),
    )


def _effort_is_known(model: Model, limb: Limb, asked: Asked, gathered: Gathered) -> bool:
    """Return whether a gravity torque of the limb can be compared with an effort limit; say where it cannot."""
    if asked.weightless is not None:
        gathered.leave("effort use", asked.weightless)
        return False
    missing = effort_limits(model.robot).missing
    names = [name for joint in limb.joints for name in model.robot.joint_by_name[joint].velocity_names]
    for why in dict.fromkeys(missing[name] for name in names if name in missing):
        gathered.leave(f"effort use of {quoted([name for name in names if missing.get(name) == why])}", why)
    return not set(names) <= set(missing)


def _reach(model: Model, limb: Limb, middle: Array, rows: Measured | None, seed: int, gathered: Gathered) -> float:
    """Return the largest distance of the tool from where the limb begins, m."""
    bounded_joints(model, limb.frame, limb.base)
    arm = coordinates(model, limb.frame, limb.base)
    point = _beginning(model, limb, middle, gathered)
    if rows is None:
        drawn = random_configurations(model, seed, _DRAWN)[:, list(arm.indices)]
    else:
        away = np.linalg.norm(rows.positions - np.array(point), axis=-1)
        drawn = rows.coordinates[np.argsort(-away, kind="stable")[:_FARTHEST]]
    found = farthest(model, limb.frame, limb.base, arm.configuration(drawn, middle), point=point)
    gathered.certify("reach", found.certificate)
    return found.distance


def _beginning(model: Model, limb: Limb, at: Array, gathered: Gathered) -> tuple[float, float, float]:
    """Return the origin of the limb's first joint in the base's coordinates, where it is at rest, m."""
    path = model.robot.path(limb.base, limb.frame)
    first, sign = next((joint, sign) for joint, sign in path if joint.type is not JointType.FIXED)
    # Up a joint it is the far link that the base carries: the joint's frame is that link's own.
    placed = fk(model, first.parent if sign > 0 else first.child, at, relative_to=limb.base)
    gathered.certify("reach", placed.certificate)
    x, y, z = se3.transform(placed.matrix, np.array(first.origin.xyz if sign > 0 else (0.0, 0.0, 0.0)))
    return float(x), float(y), float(z)


def _payload(model: Model, limb: Limb, middle: Array, asked: Asked, gathered: Gathered) -> Strongest | None:
    """Return the largest payload at the middle of limits, as far as the limb's own joints decide."""
    joints = [model.robot.joint_by_name[name] for name in limb.joints]

    def most() -> Strongest:
        weighed = torque(model, middle, gravity=True)
        own = weighed.limits.of_joints(model.robot, joints)
        found = strongest(model, limb.frame, middle, "payload", replace(weighed, limits=own))
        gathered.certify("payload", weighed.certificate, found.certificate)
        return found

    if asked.weightless is not None:
        gathered.leave("payload", asked.weightless)
        return None
    missing = effort_limits(model.robot).of_joints(model.robot, joints).missing
    if len(missing) == sum(len(joint.velocity_names) for joint in joints):  # without limits no load is the largest
        gathered.leave("payload", f"no effort limits: {', '.join(dict.fromkeys(missing.values()))}")
        return None
    return gathered.attempt("payload", most)


def _loaded(model: Model, limb: Limb, middle: Array, asked: Asked, gathered: Gathered) -> WorstTorques | None:
    """Return the worst torques of the limb's joints with the payload that it is to carry, if there is one."""
    mass = asked.payload if limb.payload is None else limb.payload
    if mass is None:
        return None
    joints = [name for name in limb.joints if model.robot.joint_by_name[name].type.nq == 1]
    what = f"worst torques with {mass:g} kg"
    if asked.weightless is not None:
        gathered.leave(what, asked.weightless)
        return None

    def worst() -> WorstTorques:
        return worst_torques(model, middle, payload=Payload(mass, limb.frame), joints=joints, seed=asked.seed)

    found = gathered.attempt(what, worst)
    if found is not None:
        gathered.certify(what, found.certificate)
    return found


def _refuse_many(limb: Limb) -> None:
    """Refuse what takes minutes and gigabytes of a chain of many joints.

    Raises:
        UsageError: it has too many.
    """
    if len(limb.joints) > _SEARCHED:
        raise UsageError(f"looked for in chains of up to {_SEARCHED} joints, and this has {len(limb.joints)}")


def _families(model: Model, limb: Limb, asked: Asked, gathered: Gathered) -> SingularFamilies:
    _refuse_many(limb)
    # Without rows of its own the search takes those that the sweep takes: both ask the mechanism.
    found = singular_find(model, limb.frame, relative_to=limb.base, starts=asked.starts, seed=asked.seed)
    gathered.certify("singular families", found.certificate)
    return found


def _sections(
    model: Model, limb: Limb, swept: Sweep, poses: tuple[LimbPose, ...], families: SingularFamilies | None
) -> tuple[Section, ...]:
    _refuse_many(limb)
    q, name = held_pose(model, limb, swept, poses)
    return sections(model, limb, q, name, task=swept.task, length=swept.length, families=families)
