"""N321 to N326: the states of an SRDF are configurations that the robot can have."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from kinetostat.errors import quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped, listed
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.names.srdf import ARM, FREE_FLYER, SrdfRule, is_free_flyer, joint_names
from kinetostat.lint.subject import Subject, name_of
from kinetostat.urdf.description import Joint, JointType
from kinetostat.urdf.document import Element
from kinetostat.urdf.reading import as_number, words

__all__ = ["STATES"]

TOLERANCE = 1e-6  # rad or m beyond a limit: what rounding in the last digit makes
_LAW = 1e-3  # rad or m between a follower and what its leader makes of it
_GROUP = '<group name="arm"><joint name="shoulder"/></group>'


@dataclass(frozen=True)
class _Value:
    """A `<joint name value>` of a state: the element, the state, the joint's name and the numbers."""

    element: Element
    state: Element
    name: str
    numbers: tuple[float, ...]


def _values(root: Element) -> Iterator[_Value]:
    """Yield the values of all states, in file order. One that cannot be read is another rule's."""
    for state in root.all("group_state"):
        for element in state.all("joint"):
            found = [as_number(word) for word in words(element.attributes.get("value", ""))]
            numbers = tuple(value for value in found if value is not None and math.isfinite(value))
            if numbers and len(numbers) == len(found):
                yield _Value(element, state, name_of(element), numbers)


def _example(state: str, group: str = _GROUP) -> Example:
    return Example(ARM, srdf=f"{group}\n{state}")


def _state(joints: str, group: str = ' group="arm"') -> str:
    return f'<group_state name="home"{group}>\n  {joints}\n</group_state>'


class StateOfNoGroup(SrdfRule):
    """A state of the SRDF names no group, or one that is not defined.

    MoveIt leaves such a state out, so that nobody can move to it. Pinocchio reads it.
    """

    code = "N321"
    name = "srdf-state-group"
    severity = Severity.WARNING
    hint = 'write group="..." with a group that the SRDF defines'
    bad = _example('<group_state name="home" group="arms"> <!-- N321 -->\n</group_state>')
    good = _example(_state('<joint name="shoulder" value="0"/>'))

    def check_srdf(self, subject: Subject, root: Element, file: str) -> Iterator[Finding]:
        """Yield each group that is not defined, and the states without one."""
        yield from self.lost(subject, file)
        states = root.all("group_state")
        bare = [state for state in states if not state.attributes.get("group")]
        if bare:
            which = f"; {len(bare)} states are so" if len(bare) > 1 else ""
            yield self.finding(bare[0], f"the state names no group{which}: MoveIt leaves it out", file=file)


class StateOfOtherJoints(SrdfRule):
    """A state of the SRDF gives a value to a joint that is not there, or not in its group.

    The value is passed over, and the state is another one than was meant.
    """

    code = "N322"
    name = "srdf-state-joint"
    severity = Severity.WARNING
    hint = "correct the name, or add the joint to the group"
    bad = _example(_state('<joint name="elbow" value="0"/> <!-- N322 -->'))
    good = _example(_state('<joint name="shoulder" value="0"/>'))

    def check_srdf(self, subject: Subject, root: Element, file: str) -> Iterator[Finding]:
        """Yield the joints that are not there, and those that are in another group."""
        yield from self.lost(subject, file)
        values = list(_values(root))
        flying = [value for value in values if is_free_flyer(value.element)]
        if flying and FREE_FLYER not in joint_names(subject, root):
            message = f"joint {quote(FREE_FLYER)} is Pinocchio's floating base; MoveIt knows it as a virtual_joint only"
            hint = f'add <virtual_joint name="{FREE_FLYER}" type="floating" .../>'
            yield self.finding(flying[0].element, message, hint=hint, file=file, severity=Severity.INFO)
        yield from self._strangers(subject, [value for value in values if value not in flying], file)

    def _strangers(self, subject: Subject, values: list[_Value], file: str) -> Iterator[Finding]:
        """Yield the joints of each state that are not in its group. Fixed joints are another rule's."""
        assert subject.robot is not None
        moving = {joint.name for joint in subject.robot.joints if joint.type is not JointType.FIXED}
        groups = {name: frozenset(joints) for name, joints in subject.semantics.groups.items()}
        strangers: dict[int, list[_Value]] = {}
        for value in values:
            group = groups.get(value.state.attributes.get("group", ""))
            if group and value.name in moving and value.name not in group:
                strangers.setdefault(id(value.state), []).append(value)
        found = list[Found]()
        for each in strangers.values():
            state, names = each[0].state, [value.name for value in each]
            what = f"joint {quote(names[0])} is" if len(names) == 1 else f"{len(names)} joints are"
            rest = f": {listed(names)}" if len(names) > 1 else ""
            message = f"{what} not in group {quote(state.attributes['group'])}{rest}"
            found.append(Found(each[0].element, name_of(state), message, "name"))
        yield from grouped(self, found, what="state", alike=True, file=file)


class WrongCount(SrdfRule):
    """A state of the SRDF gives a joint another count of numbers than the joint has.

    A revolute joint has one number, a planar one three, a floating one seven (position and quaternion), a fixed one
    none. MoveIt passes over what does not fit; that a fixed joint has a value at all does no harm.
    """

    code = "N323"
    name = "srdf-state-count"
    severity = Severity.WARNING
    hint = "write as many numbers as the joint has"
    bad = _example(_state('<joint name="shoulder" value="0 0"/> <!-- N323 -->'))
    good = _example(_state('<joint name="shoulder" value="0"/>'))

    def check_srdf(self, subject: Subject, root: Element, file: str) -> Iterator[Finding]:
        """Yield each value with too many or too few numbers, and the fixed joints that have any."""
        assert subject.robot is not None
        fixed: dict[str, _Value] = {}
        for value in _values(root):
            joint = subject.robot.joint_by_name.get(value.name)
            if joint is None:
                continue
            if joint.type is JointType.FIXED:
                fixed.setdefault(value.name, value)
            elif len(value.numbers) not in _counts(joint):
                message = f"{len(value.numbers)} numbers for a {joint.type} joint, which has {joint.type.nq}"
                yield self.finding(value.element, message, attribute="value", file=file)
        if fixed:
            first = next(iter(fixed.values()))
            what = "the joint is fixed" if len(fixed) == 1 else f"{len(fixed)} joints are fixed, {listed(list(fixed))}"
            yield self.finding(
                first.element,
                f"{what}: no value counts",
                hint="remove the line",
                severity=Severity.INFO,
                attribute="value",
                file=file,
            )


def _counts(joint: Joint) -> tuple[int, ...]:
    """Return how many numbers a joint may have: a continuous one in Pinocchio also cosine and sine."""
    return (1, 2) if joint.type is JointType.CONTINUOUS else (joint.type.nq,)


class StateOutsideLimits(SrdfRule):
    """A state of the SRDF is outside the limits of a joint.

    MoveIt refuses to plan from or to such a state; a simulator starts with the joint pushed against its stop.
    """

    code = "N324"
    name = "srdf-state-limits"
    severity = Severity.WARNING
    hint = "correct the state, or the limits"
    bad = _example(_state('<joint name="shoulder" value="1.5"/> <!-- N324 -->'))
    good = _example(_state('<joint name="shoulder" value="1.0000005"/>'))

    def check_srdf(self, subject: Subject, root: Element, file: str) -> Iterator[Finding]:
        """Yield each value outside; those of one state together if they are many."""
        assert subject.robot is not None
        outside: dict[int, list[tuple[_Value, str]]] = {}
        for value in _values(root):
            joint = subject.robot.joint_by_name.get(value.name)
            if joint is not None and joint.type.nq == 1 and len(value.numbers) == 1:
                message = _beyond(joint, value.numbers[0])
                if message:
                    outside.setdefault(id(value.state), []).append((value, message))
        for values in outside.values():
            found = [Found(value.element, value.name, message, "value") for value, message in values]
            yield from grouped(self, found, what="joint", file=file)


def _beyond(joint: Joint, value: float) -> str:
    """Return how far a value is outside the limits; empty if it is not."""
    unit = "rad" if joint.type.is_angle else "m"
    lower, upper = joint.limit.range
    for limit, by, side in ((lower, lower - value, "below the lower"), (upper, value - upper, "above the upper")):
        if by > TOLERANCE:
            return f"{value:.6g} {unit} is {side} limit {limit:.6g} by {by:.3g}"
    return ""


class StateAgainstMimic(SrdfRule):
    """A state of the SRDF gives a follower (`<mimic>`) another value than its leader makes of it.

    Of the two, tools take the leader's: the value has no effect, and is not what whoever reads it expects.
    """

    code = "N325"
    name = "srdf-state-mimic"
    severity = Severity.WARNING
    hint = "remove the follower's value"
    bad = Example(
        """
        <link name="hand"/><link name="left"/><link name="right"/>
        <joint name="grip" type="prismatic">
          <parent link="hand"/><child link="left"/><limit lower="0" upper="0.04" effort="10" velocity="1"/>
        </joint>
        <joint name="follow" type="prismatic">
          <parent link="hand"/><child link="right"/><limit lower="0" upper="0.04" effort="10" velocity="1"/>
          <mimic joint="grip"/>
        </joint>""",
        srdf="""
        <group name="fingers"><joint name="grip"/><joint name="follow"/></group>
        <group_state name="open" group="fingers">
          <joint name="grip" value="0.04"/>
          <joint name="follow" value="0"/> <!-- N325 -->
        </group_state>""",
    )
    good = _example(_state('<joint name="shoulder" value="0"/>'))

    def check_srdf(self, subject: Subject, root: Element, file: str) -> Iterator[Finding]:
        """Yield each value that its leader's contradicts."""
        assert subject.robot is not None
        values = [value for value in _values(root) if len(value.numbers) == 1]
        given = {(id(value.state), value.name): value.numbers[0] for value in values}
        for value in values:
            law = subject.robot.followers.get(value.name)
            leader = given.get((id(value.state), law.joint)) if law is not None else None
            if law is None or leader is None:
                continue
            wanted = law.multiplier * leader + law.offset
            if abs(wanted - value.numbers[0]) > _LAW:
                message = f"{value.numbers[0]:.6g}, but following {quote(law.joint)} at {leader:.6g} gives {wanted:.6g}"
                yield self.finding(value.element, message, attribute="value", file=file)


class PartialState(SrdfRule):
    """A state of the SRDF leaves joints of its group open.

    They stay where they are, or go to zero: that depends on the tool.
    """

    code = "N326"
    name = "srdf-state-partial"
    severity = Severity.INFO
    hint = "give every joint of the group a value"
    bad = _example('<group_state name="home" group="arm"> <!-- N326 -->\n</group_state>')
    good = _example(_state('<joint name="shoulder" value="0"/>'))

    def check_srdf(self, subject: Subject, root: Element, file: str) -> Iterator[Finding]:
        """Yield each state with the joints that it leaves open; followers and passive joints may be open."""
        assert subject.robot is not None
        passive = {name_of(element) for element in root.all("passive_joint")}
        free = {joint.name for joint in subject.robot.independent} - passive
        groups = {name: [j for j in joints if j in free] for name, joints in subject.semantics.groups.items()}
        for state in root.all("group_state"):
            given = {name_of(joint) for joint in state.all("joint")}
            missing = [name for name in groups.get(state.attributes.get("group", ""), ()) if name not in given]
            if missing:
                what = "joint has" if len(missing) == 1 else "joints have"
                message = f"{len(missing)} {what} no value: {listed(missing)}"
                yield self.finding(state, message, file=file)


STATES: tuple[Rule, ...] = (
    StateOfNoGroup(),
    StateOfOtherJoints(),
    WrongCount(),
    StateOutsideLimits(),
    StateAgainstMimic(),
    PartialState(),
)
