"""N311 to N313: can the SRDF be read, and is it this robot's? What rules about an SRDF share."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import ClassVar

from kinetostat.errors import cut, quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Needs, Rule
from kinetostat.lint.rules.names.uses import Use, srdf_uses, told
from kinetostat.lint.subject import Subject, name_of, once
from kinetostat.urdf.description import JointType
from kinetostat.urdf.document import Element
from kinetostat.urdf.reading import words

__all__ = ["ARM", "FREE_FLYER", "SRDF", "SrdfRule", "is_free_flyer", "joint_names"]

FREE_FLYER = "root_joint"  # of Pinocchio: position and quaternion of a floating base

ARM = """
        <link name="base"/>
        <link name="arm"/>
        <link name="hand"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-1" upper="1" effort="10" velocity="1"/>
        </joint>
        <joint name="wrist" type="fixed"><parent link="arm"/><child link="hand"/></joint>"""
_ELEMENTS = (
    "group",
    "group_state",
    "end_effector",
    "virtual_joint",
    "passive_joint",
    "joint_property",
    "disable_collisions",
    "enable_collisions",
    "disable_default_collisions",
    "link_sphere_approximation",
)
_ENOUGH = 10  # names in an SRDF, to say that it is another robot's


class SrdfRule(Rule):
    """A rule about the SRDF: it is silent without one, and its findings are in that file."""

    needs = Needs.ROBOT
    always: ClassVar[bool] = False  # asked also of the SRDF of another robot

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield what is found in the SRDF, unless that is another robot's: one finding says so."""
        if subject.srdf is None or subject.srdf.root.tag != "robot":
            return
        if self.always or not _strange(_names_of(subject)):
            yield from self.check_srdf(subject, subject.srdf.root, subject.srdf.file)

    def check_srdf(self, subject: Subject, root: Element, file: str) -> Iterator[Finding]:
        """Yield what is found in an SRDF: `root` is its root element, `file` its path."""
        raise NotImplementedError

    def lost(self, subject: Subject, file: str) -> Iterator[Finding]:
        """Yield the names that are not there and that the SRDF uses first where this rule looks."""
        names = _names_of(subject)
        groups = [use for use in names.lost if use.kind == "group"]
        others = [use for use in names.lost if use.kind != "group"]
        yield from told(self, subject, others, names.known, file=file)
        yield from told(self, subject, groups, names.known, where="defined", file=file)

    def finding(
        self,
        at: Element | int,
        message: str,
        *,
        hint: str | None = None,
        severity: Severity | None = None,
        attribute: str = "",
        file: str = "",
        element: str = "",
        several: bool = False,
    ) -> Finding:
        """Return a finding at an element, which is called by the group or state that it is in, too."""
        if isinstance(at, Element) and not element:
            element = _label(at)
        return super().finding(
            at,
            message,
            hint=hint,
            severity=severity,
            attribute=attribute,
            file=file,
            element=element,
            several=several,
        )


def _label(element: Element) -> str:
    above = element.parent
    inside = above is not None and above.tag in ("group", "group_state")
    return f"{above.label()}{element.label()}" if above is not None and inside else element.label()


@dataclass(frozen=True)
class _Names:
    """The names that an SRDF uses: all uses, those of names that are not there, and the names that there are."""

    uses: tuple[Use, ...]
    lost: tuple[Use, ...]
    known: Mapping[str, Collection[str]]


@once
def _names_of(subject: Subject) -> _Names:
    """Return the names that an SRDF uses; they are found once for each subject."""
    assert subject.srdf is not None
    assert subject.robot is not None
    root = subject.srdf.root
    known: dict[str, Collection[str]] = {
        "link": subject.robot.link_by_name,
        "joint": joint_names(subject, root),
        "group": {name_of(group) for group in root.all("group")},
    }
    uses = tuple(use for use in srdf_uses(root) if use.name in known[use.kind] or not is_free_flyer(use.at))
    lost = tuple(use for use in uses if not use.name or use.name not in known[use.kind])
    return _Names(uses, lost, known)


def _strange(names: _Names) -> tuple[int, ...]:
    """Return how many names in the SRDF are not the robot's, and of how many; nothing unless they are most of many."""
    used = {(use.kind, use.name) for use in names.uses if use.kind != "group"}
    lost = {(use.kind, use.name) for use in names.lost if use.kind != "group"}
    return (len(lost), len(used)) if len(used) >= _ENOUGH and len(lost) > len(used) / 2 else ()


def joint_names(subject: Subject, root: Element) -> dict[str, None]:
    """Return the names of the robot's joints, and of the joints that the SRDF adds to them."""
    assert subject.robot is not None
    return dict.fromkeys([*subject.robot.joint_by_name, *(name_of(joint) for joint in root.all("virtual_joint"))])


def is_free_flyer(element: Element) -> bool:
    """Return whether the value of a state is that of Pinocchio's floating base: position and quaternion."""
    return name_of(element) == FREE_FLYER and len(words(element.attributes.get("value", ""))) == JointType.FLOATING.nq


class UnreadableSrdf(Rule):
    """The SRDF cannot be read.

    MoveIt and Pinocchio take no group and no state from it; MoveIt does not start.
    """

    code = "N311"
    name = "srdf-unreadable"
    severity = Severity.ERROR
    hint = "correct the file there"
    needs = Needs.ROBOT
    bad = Example(
        ARM, srdf='<group_state name="home"><joint name="shoulder" value="zero"/></group_state> <!-- N311 -->'
    )
    good = Example(ARM, srdf='<group_state name="home" group="arm"><joint name="shoulder" value="0"/></group_state>')

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield why it cannot be read."""
        why = subject.srdf_refusal
        if why is not None:
            line, element = why.line or 0, why.element or ""
            yield self.finding(line, why.message, hint=why.remedy, file=why.file or "the SRDF", element=element)


class OtherRobot(SrdfRule):
    """The SRDF is of another robot, or calls it by another name.

    Of a name alone MoveIt says so at every start and goes on, which is harmless if the two files belong together. If
    most links and joints in the SRDF are not the robot's, they do not: groups, states and collisions mean nothing.
    """

    code = "N312"
    name = "srdf-name"
    severity = Severity.INFO
    hint = "give both the same name"
    always = True
    bad = Example(ARM, srdf='<robot name="other"> <!-- N312 -->\n</robot>')
    good = Example(ARM, srdf='<robot name="example">\n</robot>')

    def check_srdf(self, subject: Subject, root: Element, file: str) -> Iterator[Finding]:
        """Yield how many links and joints are another robot's, or else the two names."""
        assert subject.robot is not None
        strange = _strange(_names_of(subject))
        if strange:
            message = f"{strange[0]} of the {strange[1]} links and joints that the SRDF names are not in the robot"
            hint = "write an SRDF for this robot, or name the right one"
            yield self.finding(root, message, hint=hint, severity=Severity.WARNING, file=file)
        elif name_of(root) != subject.robot.name:
            message = f"the SRDF is of {quote(name_of(root))}, the robot is called {quote(subject.robot.name)}"
            yield self.finding(root, message, attribute="name", file=file)


class UnknownSrdfElement(SrdfRule):
    """An element of the SRDF is nearly, but not quite, one that is known.

    Readers pass over what they do not know, without a word: the line has no effect.
    """

    code = "N313"
    name = "srdf-element"
    severity = Severity.WARNING
    hint = "correct its name"
    bad = Example(ARM, srdf='<disable_collision link1="base" link2="arm"/> <!-- N313 -->')
    good = Example(ARM, srdf='<disable_collisions link1="base" link2="arm"/>\n<gripper name="g"/>')

    def check_srdf(self, subject: Subject, root: Element, file: str) -> Iterator[Finding]:
        """Yield each tag that is misspelt, at its first use."""
        del subject  # it is about the SRDF alone
        first: dict[str, Element] = {}
        for child in root.children:
            first.setdefault(child.tag, child)
        for tag, element in first.items():
            near = [] if tag in _ELEMENTS else get_close_matches(tag[:60].lower(), _ELEMENTS, n=1, cutoff=0.85)
            if near:
                hint = f"did you mean <{near[0]}>?"
                yield self.finding(element, f"<{cut(tag)}> is not known, and passed over", hint=hint, file=file)


SRDF: tuple[Rule, ...] = (UnreadableSrdf(), OtherRobot(), UnknownSrdfElement())
