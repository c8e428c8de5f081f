"""N314 to N317: what an SRDF says of groups, end effectors, joints and collisions refers to what the robot has."""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.errors import quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.names.srdf import ARM, SrdfRule
from kinetostat.lint.subject import Subject, name_of
from kinetostat.urdf.document import Element

__all__ = ["MEMBERS"]

_PARTS = ("link", "joint", "chain", "group")


def _group_elements(root: Element) -> dict[str, Element]:
    """Return the first group of each name."""
    return {name_of(group): group for group in reversed(root.all("group")) if name_of(group)}


class BrokenGroup(SrdfRule):
    """A group of the SRDF names links, joints or groups that are not there.

    MoveIt leaves the name out, and with a missing subgroup the whole group: planning for it fails, or moves fewer
    joints than was meant. A name that other parts of the SRDF use, too, is reported once, where it is first used.
    """

    code = "N314"
    name = "srdf-group"
    severity = Severity.WARNING
    hint = "correct the name"
    bad = Example(
        ARM,
        srdf="""
        <group name="arm">
          <chain base_link="base" tip_link="tool"/> <!-- N314 -->
        </group>""",
    )
    good = Example(
        ARM,
        srdf="""
        <virtual_joint name="floor" type="fixed" parent_frame="world" child_link="base"/>
        <group name="arm"><chain base_link="base" tip_link="hand"/></group>
        <group name="all"><joint name="floor"/><link name="hand"/><group name="arm"/></group>""",
    )

    def check_srdf(self, subject: Subject, root: Element, file: str) -> Iterator[Finding]:
        """Yield what is not there, empty groups, groups given twice, and groups within themselves."""
        yield from self.lost(subject, file)
        groups, known = root.all("group"), _group_elements(root)
        for group in groups:
            if not any(part.tag in _PARTS for part in group.children):
                yield self.finding(group, "the group is empty", hint="name its joints, or a chain", file=file)
            elif known.get(name_of(group), group) is not group:
                first = known[name_of(group)]
                yield self.finding(group, f"there is such a group at line {first.line}", hint="join the two", file=file)
        yield from self._circular(known, file)

    def _circular(self, known: dict[str, Element], file: str) -> Iterator[Finding]:
        """Yield the groups that are within themselves."""
        inner = {name: {name_of(part) for part in group.all("group")} & known.keys() for name, group in known.items()}
        outer: dict[str, list[str]] = {}
        for name, names in inner.items():
            for each in names:
                outer.setdefault(each, []).append(name)
        settled = [name for name, names in inner.items() if not names]
        while settled:
            done = settled.pop()
            del inner[done]
            for name in outer.get(done, ()):
                inner[name].discard(done)
                if not inner[name]:
                    settled.append(name)
        if inner:
            group = min((known[name] for name in inner), key=lambda group: group.line)
            message = "the group contains itself, or one that does"
            yield self.finding(group, message, hint="take one out of the other", file=file)


class BrokenEndEffector(SrdfRule):
    """An end effector of the SRDF names a link or a group that is not there.

    MoveIt leaves the end effector out: what is grasped is attached to nothing.
    """

    code = "N315"
    name = "srdf-end-effector"
    severity = Severity.WARNING
    hint = "correct the name"
    bad = Example(
        ARM,
        srdf="""
        <group name="tool"><link name="hand"/></group>
        <end_effector name="tool" parent_link="arm" group="tools"/> <!-- N315 -->""",
    )
    good = Example(
        ARM,
        srdf="""
        <group name="arm"><joint name="shoulder"/></group>
        <group name="tool"><link name="hand"/></group>
        <end_effector name="tool" parent_link="arm" group="tool" parent_group="arm"/>""",
    )

    def check_srdf(self, subject: Subject, root: Element, file: str) -> Iterator[Finding]:
        """Yield what is not there, and what does not fit together."""
        yield from self.lost(subject, file)
        held = _Links(subject)
        for effector in root.all("end_effector"):
            missing = [key for key in ("parent_link", "group") if not effector.attributes.get(key)]
            if missing:
                yield self.finding(effector, f"no {' and no '.join(missing)}", hint="name it", file=file)
            else:
                yield from self._parent(subject, effector, held, file)

    def _parent(self, subject: Subject, effector: Element, links: _Links, file: str) -> Iterator[Finding]:
        """Yield it if the group that carries an end effector does not hold the link that carries it."""
        assert subject.robot is not None
        group, link = effector.attributes.get("parent_group", ""), effector.attributes["parent_link"]
        if group and group == effector.attributes["group"]:
            message = f"group {quote(group)} is both the end effector and what carries it"
            yield self.finding(effector, message, attribute="parent_group", file=file)
        elif link in subject.robot.link_by_name and (there := links.of(group)) and link not in there:
            message = f"parent_link {quote(link)} is not in parent_group {quote(group)}"
            yield self.finding(effector, message, attribute="parent_group", file=file)


class _Links:
    """The links that the joints of groups connect, each group's once."""

    def __init__(self, subject: Subject) -> None:
        self._subject = subject
        self._known: dict[str, frozenset[str]] = {}

    def of(self, group: str) -> frozenset[str]:
        """Return the links of a group; none if it is not known."""
        assert self._subject.robot is not None
        if group not in self._known:
            names = self._subject.semantics.groups.get(group, ())
            joints = [self._subject.robot.joint_by_name[name] for name in names]
            self._known[group] = frozenset(end for joint in joints for end in (joint.parent, joint.child))
        return self._known[group]


class BrokenSrdfJoint(SrdfRule):
    """A virtual or passive joint, or a property of a joint, refers to what is not there.

    MoveIt attaches the robot to the world by a virtual joint only at the root link, and passes over the others.
    """

    code = "N316"
    name = "srdf-joint"
    severity = Severity.WARNING
    hint = "correct the name"
    bad = Example(ARM, srdf='<passive_joint name="elbow"/> <!-- N316 -->')
    good = Example(
        ARM,
        srdf="""
        <virtual_joint name="floor" type="floating" parent_frame="world" child_link="base"/>
        <passive_joint name="shoulder"/>
        <passive_joint name="floor"/>""",
    )

    def check_srdf(self, subject: Subject, root: Element, file: str) -> Iterator[Finding]:
        """Yield what is not there, virtual joints elsewhere than at the root, and of unknown types."""
        assert subject.robot is not None
        yield from self.lost(subject, file)
        for element in root.all("virtual_joint"):
            child = element.attributes.get("child_link", "")
            kind = element.attributes.get("type", "").strip().lower()
            if kind not in ("fixed", "floating", "planar"):
                hint = "write fixed, floating or planar"
                yield self.finding(
                    element, f"type {quote(kind)} counts as fixed", hint=hint, attribute="type", file=file
                )
            if child in subject.robot.link_by_name and child != subject.robot.root:
                message = f"child_link {quote(child)} is not the root link, which is {quote(subject.robot.root)}"
                yield self.finding(element, message, attribute="child_link", file=file)


class BrokenCollisions(SrdfRule):
    """Collisions are disabled between links of which one is not there.

    The line has no effect. If a link was renamed, the pair that was meant is checked again, and motions that used to be
    allowed are refused.
    """

    code = "N317"
    name = "srdf-collisions"
    severity = Severity.WARNING
    hint = "correct the name, or remove the line"
    bad = Example(ARM, srdf='<disable_collisions link1="base" link2="forearm" reason="Never"/> <!-- N317 -->')
    good = Example(
        ARM,
        srdf='<disable_collisions link1="base" link2="arm" />\n<disable_default_collisions link="arm"/>',
    )

    def check_srdf(self, subject: Subject, root: Element, file: str) -> Iterator[Finding]:
        """Yield the links that are not there, and pairs that are none."""
        yield from self.lost(subject, file)
        pairs = [e for e in root.children if e.tag in ("disable_collisions", "enable_collisions")]
        for element in pairs:
            one, other = element.attributes.get("link1", ""), element.attributes.get("link2", "")
            if not one or not other:
                yield self.finding(element, f"no {'link2' if one else 'link1'}", hint="name both links", file=file)
            elif one == other:
                yield self.finding(element, f"both links are {quote(one)}", hint="name two links", file=file)


MEMBERS: tuple[Rule, ...] = (BrokenGroup(), BrokenEndEffector(), BrokenSrdfJoint(), BrokenCollisions())
