"""K104: joints that cannot hold the robot's own weight somewhere inside the limits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.configuration import configuration, neutral, position_range, random_configurations
from kinetostat.analysis.loads import effort_limits, effort_units
from kinetostat.analysis.statics import torque
from kinetostat.conventions import GRAVITY, Array
from kinetostat.engines.model import Model
from kinetostat.errors import cut
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import FEW
from kinetostat.lint.rule import Example, Needs, Rule, RuleSkippedError
from kinetostat.lint.rules.kinetostatics.dependence import COMPLIANT
from kinetostat.lint.rules.kinetostatics.weightless import weighed
from kinetostat.lint.subject import Subject, first
from kinetostat.urdf.description import Joint, Robot

__all__ = ["GravityOverEffort"]

_RANDOM, _CORNERS, _SEED = 192, 64, 0
_FOR_ALL = 30_000  # links times configurations: what is spent on a very large robot
_ENOUGH = 1.01  # a hundredth more than the limit is rounding of limits
_GIVEN_UP = 0.1  # of the torque, for a witness that sets fewer joints
_SHOWN = 8  # joints of a witness


@dataclass(frozen=True)
class _Overload:
    """A joint that weight overloads at a configuration."""

    joint: Joint
    torque: float
    limit: float
    unit: str
    q: Array

    @property
    def share(self) -> float:
        """How many times the limit it is."""
        return abs(self.torque) / self.limit


class GravityOverEffort(Rule):
    """The robot's own weight takes more than a joint's effort limit, somewhere inside the limits.

    The torque that holds the links still there, with the root link fixed and upright, is more than the joint may give:
    a simulator that respects the limit lets the arm sink, and a controller saturates. Either masses or the limit are
    wrong, or the range is wider than the robot can use, or a balancing spring carries what the file knows nothing of.
    The message gives a configuration that shows it, not the worst. Springs and suspensions are left out by their names,
    and so is the weight of links on which the file turns gravity off for Gazebo.
    """

    code = "K104"
    name = "gravity-over-effort"
    severity = Severity.WARNING
    hint = "check the masses beyond the joint (in g?), its effort limit (of the motor, before the gear?) and its range"
    needs = Needs.MODEL
    bad = Example("""
        <link name="base"/>
        <link name="arm">
          <inertial>
            <origin xyz="0.5 0 0"/><mass value="10"/>
            <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.9" iyz="0" izz="0.9"/>
          </inertial>
        </link>
        <joint name="lift" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 1 0"/>
          <limit lower="-1.5" upper="1.5" effort="20" velocity="1"/> <!-- K104 -->
        </joint>""")
    good = Example("""
        <link name="base"/>
        <link name="arm">
          <inertial>
            <origin xyz="0.5 0 0"/><mass value="10"/>
            <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.9" iyz="0" izz="0.9"/>
          </inertial>
        </link>
        <joint name="lift" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 1 0"/>
          <limit lower="-1.5" upper="1.5" effort="80" velocity="1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each joint that is overloaded; of more than three, the worst for all."""
        found = _overloads(subject)
        several = len(found) > FEW
        for each in found[:1] if several else found:
            limit = first(subject.joint_elements[each.joint.name], "limit")
            if limit is None:
                continue
            others = f" ({len(found)} joints are overloaded, this one the most)" if several else ""
            message = (
                f"weight takes {abs(each.torque):.4g} {each.unit} of {each.limit:.4g} {each.unit}"
                f" ({100 * each.share:.0f} %) at {_words(subject.model.robot, each.q)}{others}"
            )
            yield self.finding(limit, message, attribute="effort", several=several)


def _overloads(subject: Subject) -> list[_Overload]:
    """Return the overloaded joints, the most overloaded first."""
    model = weighed(subject)
    robot, limits = model.robot, effort_limits(model.robot).upper
    if any(link.inertial is not None and link.inertial.mass < 0 for link in robot.links):
        raise RuleSkippedError("a link's mass is negative")
    if np.all(np.isnan(limits)):
        return []
    q = _configurations(subject)
    torques = model.engine.holding_torques(q, np.array(GRAVITY), ())
    with np.errstate(divide="ignore", invalid="ignore"):
        used = np.nan_to_num(np.abs(torques) / limits, nan=0.0)
    found = list[_Overload]()
    for joint in robot.independent:
        column = robot.velocity_slices[joint.name].start
        worst = int(np.argmax(used[:, column]))
        if joint.type.nv == 1 and used[worst, column] > _ENOUGH and not COMPLIANT.search(joint.name):
            limit, size = float(limits[column]), float(torques[worst, column])
            found.append(_Overload(joint, size, limit, effort_units(joint)[0], q[worst]))
    found.sort(key=lambda each: -each.share)
    told = found[:1] if len(found) > FEW else found
    return [*_certified(model, [_plainer(model, each) for each in told]), *found[len(told) :]]


def _configurations(subject: Subject) -> Array:
    """Return zero, the middle, the states of the SRDF, random configurations inside limits, and corners of them."""
    robot = subject.model.robot
    count = max(8, min(_RANDOM, _FOR_ALL // max(1, len(robot.links))))
    drawn = random_configurations(robot, _SEED, count)
    corners = random_configurations(robot, _SEED + 1, max(4, count * _CORNERS // _RANDOM))
    generator = np.random.default_rng(_SEED)
    for joint in robot.independent:
        if joint.type.nq == 1 and np.isfinite(joint.limit.range).all():
            ends = np.array(position_range(robot, joint))
            corners[:, robot.position_slices[joint.name].start] = ends[generator.integers(2, size=len(corners))]
    special = [configuration(robot, word).q for word in ("zero", "mid")]
    special += [_state(robot, state.positions) for state in subject.semantics.states[:16]]
    inside = [q for q in special if _inside(robot, q)]
    return np.concatenate([np.array(inside).reshape(len(inside), robot.nq), drawn, corners])


def _state(robot: Robot, positions: dict[str, tuple[float, ...]]) -> Array:
    q = neutral(robot)
    for joint in robot.independent:
        values = positions.get(joint.name, ())
        if joint.type.nq == len(values) == 1:
            q[robot.position_slices[joint.name]] = values
    return q


def _inside(robot: Robot, q: Array) -> bool:
    """Return whether a configuration is inside the limits of the joints that are set."""
    for joint in robot.independent:
        if joint.type.nq == 1:
            lower, upper = joint.limit.range
            if not lower <= q[robot.position_slices[joint.name].start] <= upper:
                return False
    return True


def _plainer(model: Model, overload: _Overload) -> _Overload:
    """Return the overload at a configuration that sets as few joints as show it, to three decimals."""
    robot, column = model.robot, model.robot.velocity_slices[overload.joint.name].start

    def size(q: Array) -> float:
        return abs(float(model.engine.holding_torques(q, np.array(GRAVITY), ())[column]))

    q, least = overload.q.copy(), max((1 - _GIVEN_UP) * abs(overload.torque), _ENOUGH * overload.limit)
    for joint in robot.independent:
        if joint.type.nq != 1:
            continue
        where = robot.position_slices[joint.name].start
        lower, upper = joint.limit.range
        for simpler in (min(max(0.0, lower), upper), round(float(q[where]), 3)):
            tried = q.copy()
            tried[where] = simpler
            if lower <= simpler <= upper and size(tried) >= least:
                q = tried
                break
    return _Overload(overload.joint, overload.torque, overload.limit, overload.unit, q)


def _certified(model: Model, overloads: Sequence[_Overload]) -> Iterator[_Overload]:
    """Yield the overloads with the torques that both engines give; none on which they disagree."""
    if not overloads:
        return
    proof = torque(model, np.array([each.q for each in overloads]), gravity=True)
    for i, each in enumerate(overloads):
        size = float(proof.total[i, model.robot.velocity_slices[each.joint.name].start])
        if proof.certificate.agree is not False and abs(size) > each.limit:
            yield _Overload(each.joint, size, each.limit, each.unit, each.q)


def _words(robot: Robot, q: Array) -> str:
    """Return a configuration as one types it."""
    rest = neutral(robot)
    apart = [i for i in range(robot.nq) if q[i] != rest[i]]
    shown = [f"{cut(robot.position_names[i], 40)}={q[i]:.6g}" for i in apart[:_SHOWN]]
    more = f" and {len(apart) - _SHOWN} more" if len(apart) > _SHOWN else ""
    return (",".join(shown) or "zero") + more
