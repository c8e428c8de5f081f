"""K102, K103: configurations in which a chain has lost a freedom, and freedoms that limits take from it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kinetostat.analysis.configuration import neutral
from kinetostat.conventions import Array
from kinetostat.errors import KinetostatError, quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import listed
from kinetostat.lint.rule import Example, Needs, Rule
from kinetostat.lint.rules.kinetostatics.limbs import Limb, chain_text, rank, structure
from kinetostat.lint.subject import Subject, first, name_of, number
from kinetostat.urdf.description import Joint, JointType
from kinetostat.urdf.document import Element
from kinetostat.urdf.srdf import GroupState

if TYPE_CHECKING:
    from kinetostat.analysis.singular.mechanism import Mechanism

__all__ = ["LockedFreedom", "SingularState"]

NEAR = 1e-2  # of a mechanism's smallest singular value, pure numbers: a state typed as 1.57 is this near at most
_STEP = 0.1  # rad: how far a joint is moved to see whether it leads away
_AWAY = 3 * NEAR  # what counts as away
_FULL = 6
_FEWEST = 4  # joints of a limb of which a state is looked at: a neck or a waist of three only has to turn
_ONLY_LIMB = 3
_MOST_LIMBS = 24
_LOCKED = 1e-3  # rad or m: a range below it is none
_WORKING = re.compile(r"(?:^|[^a-z])(?:home|homing|ready|work|working)(?:$|[^a-z])", re.IGNORECASE)
_ARM = """
        <link name="base"/>
        <link name="l1"/>
        <link name="l2"/>
        <link name="l3"/>
        <link name="l4"/>
        <link name="l5"/>
        <link name="l6"/>
        <joint name="j1" type="revolute">
          <parent link="base"/><child link="l1"/><axis xyz="0 0 1"/>
          <limit lower="-3" upper="3" effort="100" velocity="1"/>
        </joint>
        <joint name="j2" type="revolute">
          <parent link="l1"/><child link="l2"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
          <limit lower="-3" upper="3" effort="100" velocity="1"/>
        </joint>
        <joint name="j3" type="revolute">{mark}
          <parent link="l2"/><child link="l3"/><origin xyz="0.4 0 0" rpy="0 1 0"/><axis xyz="0 1 0"/>
          <limit lower="{lower}" upper="3" effort="100" velocity="1"/>
        </joint>
        <joint name="j4" type="revolute">
          <parent link="l3"/><child link="l4"/><origin xyz="0.4 0 0.05"/><axis xyz="1 0 0"/>
          <limit lower="-3" upper="3" effort="100" velocity="1"/>
        </joint>
        <joint name="j5" type="revolute">
          <parent link="l4"/><child link="l5"/><origin xyz="0 0 0" rpy="0 0.8 0"/><axis xyz="0 1 0"/>
          <limit lower="-3" upper="3" effort="100" velocity="1"/>
        </joint>
        <joint name="j6" type="revolute">
          <parent link="l5"/><child link="l6"/><axis xyz="1 0 0"/>
          <limit lower="-3" upper="3" effort="100" velocity="1"/>
        </joint>"""
_STATE = """
        <group name="arm"><chain base_link="base" tip_link="l6"/></group>
        <group_state name="home" group="arm">{mark}
          <joint name="j1" value="0"/>
          <joint name="j2" value="-1"/>
          <joint name="j3" value="1.8"/>
          <joint name="j4" value="0"/>
          <joint name="j5" value="{wrist}"/>
          <joint name="j6" value="0"/>
        </group_state>"""


@dataclass(frozen=True)
class _Near:
    """A limb near a singular configuration: of its position only, or of all six rows; and the joint that leads away."""

    limb: Limb
    smallest: float
    length: float
    position_only: bool
    way_out: str

    def __str__(self) -> str:
        where = chain_text(self.limb.base, self.limb.tip) + (", position only" if self.position_only else "")
        return f"{where} (smallest singular value {self.smallest:.2g}, lengths over {self.length:.2g} m)"


class SingularState(Rule):
    """A named state of the SRDF, or zero, is singular or near it.

    At a singular configuration a chain cannot move in some direction, joint rates for a straight line grow without
    bound, and the torque of some force is not felt. Few arms are not singular at zero, and stretched legs are; that is
    worth knowing. A home or ready pose is where Cartesian motions begin: there it is a mistake more often than not. A
    state that is zero on the chain is reported with zero. Of a chain of three joints the position of the tip counts, of
    longer ones the orientation, too; grippers are no part of the chain.
    """

    code = "K102"
    name = "singular-state"
    severity = Severity.INFO
    hint = "move several joints of the chain away from it: none alone leads far from it within a tenth of a radian"
    needs = Needs.MODEL
    bad = Example(
        _ARM.format(mark="", lower="-3"),
        srdf=_STATE.format(mark=" <!-- K102 -->", wrist="-0.8"),
    )
    good = Example(
        _ARM.format(mark="", lower="-3"),
        srdf=_STATE.format(mark="", wrist="0.3"),
    )

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield zero, once for the robot, and each other state of the SRDF, in which a limb is singular."""
        found = structure(subject)
        every = [found.arm(limb) for limb in found.limbs]
        fewest = _ONLY_LIMB if len(every) == 1 else _FEWEST
        limbs = [limb for limb in every if len(limb.independent) >= fewest and not _floats(limb)]
        large = [limb for limb in limbs if len(limb.independent) >= _FULL][:_MOST_LIMBS]
        near = list(_near(subject, large, neutral(found.robot)))
        at_zero = {one.limb.tip for one in near}
        states = list(_states(subject))
        if near:
            share = "" if len(near) == len(large) == 1 else f" ({len(near)} of {len(large)} chains)"
            same = {state.name: None for state, _ in states if any(_is_zero(one.limb, state) for one in near)}
            states_are = f"state {listed(same)} is" if len(same) == 1 else f"states {listed(same)} are"
            more = f"; {states_are} zero on the chain, too" if same else ""
            yield self.finding(subject.root, f"at zero it is singular{share}: {near[0]}{more}", hint=_AT_ZERO)
        for state, element in states:
            told = [limb for limb in limbs if limb.tip in at_zero and _is_zero(limb, state)]
            yield from self._of_state(
                subject, [limb for limb in limbs if _set(limb, state) and limb not in told], state, element
            )

    def _of_state(self, subject: Subject, limbs: list[Limb], state: GroupState, element: Element) -> Iterator[Finding]:
        chosen = sorted(limbs, key=lambda limb: -len(limb.independent))[:_MOST_LIMBS]
        near = list(_near(subject, chosen, _positions(subject, state)))
        if not near or subject.srdf is None:
            return
        full = any(len(one.limb.independent) >= _FULL for one in near)
        severity = Severity.WARNING if full and _WORKING.search(state.name) else None
        more = f", and {len(near) - 1} more of {len(chosen)} chains" if len(near) > 1 else ""
        out = near[0].way_out
        hint = f"move {quote(out, 40)} by a tenth of a radian: of all joints it leads furthest away" if out else None
        message = f"it is singular: {near[0]}{more}"
        yield self.finding(element, message, hint=hint, severity=severity, file=subject.srdf.file)


_AT_ZERO = "start Cartesian motions, and searches for an inverse, elsewhere"


def _floats(limb: Limb) -> bool:
    return any(joint.type is JointType.FLOATING for joint in limb.joints)


def _states(subject: Subject) -> Iterator[tuple[GroupState, Element]]:
    """Yield the states of the SRDF, each with its element."""
    if subject.srdf is None:
        return
    elements = subject.srdf.root.all("group_state")
    for state, element in zip(subject.semantics.states, elements, strict=False):
        if name_of(element) == state.name:
            yield state, element


def _set(limb: Limb, state: GroupState) -> bool:
    """Return whether a state says where all joints of a limb are."""
    return all(joint.name in state.positions for joint in limb.independent)


def _positions(subject: Subject, state: GroupState) -> Array:
    """Return the configuration of a state; what it does not set is zero."""
    assert subject.robot is not None
    q = neutral(subject.robot)
    for joint in subject.robot.independent:
        values = state.positions.get(joint.name, ())
        if len(values) == joint.type.nq:
            q[subject.robot.position_slices[joint.name]] = values
    return q


def _is_zero(limb: Limb, state: GroupState) -> bool:
    """Return whether a state sets all joints of a limb, to zero: a floating joint is in none."""
    return _set(limb, state) and not any(any(state.positions[joint.name]) for joint in limb.independent)


def _near(subject: Subject, limbs: list[Limb], q: Array) -> Iterator[_Near]:
    """Yield the limbs that are near a singular configuration, the nearest first."""
    found = list[_Near]()
    for limb in limbs:
        arm = _mechanism(subject, limb)
        if arm is None:
            continue
        at = q[list(arm.indices)]
        value = float(arm.smallest(at))
        if value < NEAR:
            value = 0.0 if value < arm.tolerance else value
            position_only = len(arm.task.rows) < _FULL
            found.append(_Near(limb, value, arm.length, position_only, _way_out(arm, at)))
    yield from sorted(found, key=lambda one: one.smallest)


def _mechanism(subject: Subject, limb: Limb) -> Mechanism | None:
    """Return the mechanism of a limb, kept with the subject; None if nothing moves it."""
    from kinetostat.analysis.singular.mechanism import mechanism

    kept: dict[str, Mechanism | None] = vars(subject).setdefault("mechanisms", {})
    if limb.tip not in kept:
        try:
            kept[limb.tip] = mechanism(subject.model, limb.tip, relative_to=limb.base)
        except KinetostatError:
            kept[limb.tip] = None
    return kept[limb.tip]


def _way_out(arm: Mechanism, q: Array) -> str:
    """Return the angle that alone leads furthest from a singular configuration, inside limits; empty if none does."""
    moved = np.concatenate([q + step * np.diag(arm.turning) for step in (_STEP, -_STEP)])
    lower, upper = arm.stated_limits
    allowed = np.all((moved >= lower) & (moved <= upper) | (moved == q), axis=-1)
    values = np.where(allowed, arm.smallest(moved), 0.0)
    best = int(np.argmax(values))
    return arm.names[best % len(arm.names)] if values[best] > _AWAY else ""


class LockedFreedom(Rule):
    """Limits that let a joint not move take a freedom from a chain.

    The joints promise more directions than the limits leave: poses that the drawing shows cannot be reached, and an
    inverse that does not look at limits finds answers that the robot cannot take. Nothing is said where other joints
    make up for it, and where the file states no range at all.
    """

    code = "K103"
    name = "freedom-locked"
    severity = Severity.WARNING
    hint = "widen the range, or make the joint fixed if it is not to move"
    needs = Needs.MODEL
    bad = Example(_ARM.format(mark=" <!-- K103 -->", lower="2.9999"))
    good = Example(_ARM.format(mark="", lower="-3"))

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the first locked joint of each limb that is the poorer for it."""
        found, told = structure(subject), set[str]()
        locked = {joint.name for joint in found.robot.independent if _locked(subject, joint)}
        if len(locked) == len(found.robot.independent):  # the file knows no limits: other rules say so
            return
        for limb, matrices in zip(found.limbs, found.jacobians, strict=True):
            chain = found.chain(limb)
            stuck = [joint for joint in chain if joint.name in locked]
            if not stuck or stuck[0].name in told:
                continue
            free = [joint for joint in chain if joint.name not in locked]
            promised, left = (rank(matrices, found.robot.velocity_columns(joints)) for joints in (chain, free))
            if left < promised:
                told.add(stuck[0].name)
                yield self._of(subject, stuck, f"{quote(limb.tip, 40)} moves in {left} directions, not {promised}")

    def _of(self, subject: Subject, stuck: list[Joint], what: str) -> Finding:
        others = f", and those of {listed([joint.name for joint in stuck[1:]])}" if stuck[1:] else ""
        lower, upper = stuck[0].limit.range
        # Where the two are equal, J104 warns of it.
        severity = Severity.INFO if lower == upper else None
        message = f"its limits {lower:g} to {upper:g}{others} lock it: {what}"
        return self.finding(subject.joint_elements[stuck[0].name], message, severity=severity)


def _locked(subject: Subject, joint: Joint) -> bool:
    """Return whether the limits that the file states leave a joint no range."""
    lower, upper = joint.limit.range
    limit = first(subject.joint_elements[joint.name], "limit")
    stated = number(limit, "lower") is not None or number(limit, "upper") is not None
    return stated and joint.type.nq == 1 and bool(np.isfinite(upper - lower)) and upper - lower < _LOCKED
