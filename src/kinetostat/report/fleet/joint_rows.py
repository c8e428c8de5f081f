"""The joints of a robot as rows of the report: limits, laws of followers, and the worst that weight does to each."""

from __future__ import annotations

from collections.abc import Sequence

from kinetostat.analysis.loads import effort_limits
from kinetostat.analysis.profile.result import LimbProfile, RobotProfile
from kinetostat.analysis.worst import WorstTorques
from kinetostat.conventions import Array
from kinetostat.errors import quoted
from kinetostat.report.fleet.document import JointRow, LeftRow, UseRow
from kinetostat.report.fleet.numbers import finite
from kinetostat.urdf.description import NO_LIMIT, Joint, JointType, Robot

__all__ = ["joint_rows", "unstated_efforts", "worst_use"]

_MOST_EFFORT = 1e12  # N, Nm: beyond it a limit is written for "none"


def joint_rows(profile: RobotProfile) -> tuple[JointRow, ...]:
    """Return the joints that move, followers too, in file order."""
    robot = profile.model.robot
    limbs = _limbs_of_joints(robot, profile.limbs)
    loads = [limb.loaded for limb in profile.limbs if limb.loaded is not None]
    return tuple(
        _row(robot, joint, limbs.get(joint.name, ""), profile.worst, loads)
        for joint in robot.joints
        if joint.type is not JointType.FIXED
    )


def worst_use(worst: WorstTorques | None, joints: Sequence[str]) -> tuple[float | None, str]:
    """Return the largest use of an effort limit among some joints, and whose it is; None where none has a limit.

    Where weight does nothing to any of them it is 0, and nobody's.
    """
    if worst is None:
        return None, ""
    uses = [(use, joint) for i, joint in enumerate(worst.joints) if joint in joints and (use := _weight(worst, i)[1])]
    if uses:
        return max(uses, key=lambda one: one[0])
    limited = any(joint in joints and _weight(worst, i)[1] is not None for i, joint in enumerate(worst.joints))
    return (0.0, "") if limited else (None, "")


def unstated_efforts(robot: Robot) -> tuple[LeftRow, ...]:
    """Return which effort limits the file states, but count as not stated: zero is written for "not known"."""
    limits, found = effort_limits(robot), dict[str, list[str]]()
    for joint in robot.independent:
        if joint.type.nv == 1 and joint.limit.effort is not None and joint.name in limits.missing:
            found.setdefault(limits.missing[joint.name], []).append(joint.name)
    return tuple(
        LeftRow(what=f"effort limit of {quoted(names)}", why=f"{reason}, which counts as not stated")
        for reason, names in found.items()
    )


def _row(robot: Robot, joint: Joint, limb: str, worst: WorstTorques | None, loads: Sequence[WorstTorques]) -> JointRow:
    single = joint.type.nq == 1
    lower, upper = (_end(end) for end in joint.limit.range) if single else (None, None)
    loaded = [use for load in loads if (use := _use(robot, joint, load)) is not None]
    return JointRow(
        name=joint.name,
        type=joint.type.value,
        parent=joint.parent,
        child=joint.child,
        unit="mixed" if not single else "rad" if joint.type.is_angle else "m",
        effort_unit="mixed" if not single else "Nm" if joint.type.is_angle else "N",
        lower=lower,
        upper=upper,
        velocity=finite(joint.limit.velocity),
        effort=_effort(joint) if single else None,
        follows=_law(joint),
        limb=limb,
        gravity=_use(robot, joint, worst),
        loaded=max(loaded, key=lambda use: abs(use.torque), default=None),
    )


def _limbs_of_joints(robot: Robot, limbs: Sequence[LimbProfile]) -> dict[str, str]:
    """Return {joint: limb}: those between its base and its frame, and their leaders; the first limb that has one."""
    found: dict[str, str] = {}
    for profile in limbs:
        limb = profile.limb
        between = [joint.name for joint, _ in robot.path(limb.base, limb.frame)]
        for name in (*limb.joints, *between):
            found.setdefault(name, limb.name)
    return found


def _end(end: float) -> float | None:
    """Return an end of a range; None where there is none, or one that is written for "none"."""
    return finite(end) if abs(end) < NO_LIMIT else None


def _effort(joint: Joint) -> float | None:
    effort = joint.limit.effort
    return effort if effort is not None and 0 < effort < _MOST_EFFORT else None


def _law(joint: Joint) -> str:
    """Return a follower's law as the file has it: 'leader * 1 + 0'."""
    law = joint.mimic
    if law is None:
        return ""
    return f"{law.joint} * {law.multiplier:.12g} {'-' if law.offset < 0 else '+'} {abs(law.offset):.12g}"


def _use(robot: Robot, joint: Joint, worst: WorstTorques | None) -> UseRow | None:
    if worst is None or joint.name not in worst.joints:
        return None
    i = worst.joints.index(joint.name)
    torque, use = _weight(worst, i)
    at = _felt(robot, joint, worst.witnesses[i]) if torque else {}
    return UseRow(torque=torque, use=use, configuration=at)


def _weight(worst: WorstTorques, i: int) -> tuple[float, float | None]:
    """Return a joint's worst torque and its use of the limit; 0 where rounding alone is left, as on an upright axis."""
    torque, use = float(worst.torques[i]), finite(worst.utilisation[i])
    rounding = abs(torque) <= worst.certificate.tolerance
    return (0.0, None if use is None else 0.0) if rounding else (torque, use)


def _felt(robot: Robot, joint: Joint, q: Array) -> dict[str, float]:
    """Return the positions that the weight on a joint depends on: of joints that carry it, and that it carries."""
    driven = [joint, *(robot.joint_by_name[name] for name, law in robot.followers.items() if law.joint == joint.name)]
    around = {one.name for each in driven for one in (*robot.to_root(each.child), *_below(robot, each.child))}
    leaders = {robot.followers[name].joint if name in robot.followers else name for name in around}
    return {
        name: float(value) + 0.0
        for one in robot.independent
        if one.name in leaders
        for name, value in zip(one.position_names, q[robot.position_slices[one.name]], strict=True)
    }


def _below(robot: Robot, link: str) -> list[Joint]:
    """Return the joints below a link."""
    found = list(robot.child_joints[link])
    for joint in found:  # which grows as it is walked
        found.extend(robot.child_joints[joint.child])
    return found
