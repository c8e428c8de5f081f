"""T10x: do the joints make one tree over the links?"""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.errors import quote
from kinetostat.lint.expressions import top_tags
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import listed
from kinetostat.lint.rule import Example, Rule, RuleSkippedError
from kinetostat.lint.rules.tree.graph import Graph, graph_of, tied
from kinetostat.lint.spelling import Speller
from kinetostat.lint.subject import Subject, name_of
from kinetostat.urdf.document import Element

__all__ = ["SHAPE", "asked"]

GOOD = Example("""
    <link name="base"/>
    <link name="arm"/>
    <joint name="shoulder" type="continuous">
      <parent link="base"/><child link="arm"/>
      <axis xyz="0 0 1"/>
    </joint>""")


def asked(subject: Subject) -> Graph:
    """Return the graph of a robot.

    Raises:
        RuleSkippedError: the file is no robot, or xacro that is not expanded: it has no tree.
    """
    if subject.root.tag != "robot":
        raise RuleSkippedError("the file is not a robot")
    if top_tags(subject):
        raise RuleSkippedError("the file is xacro that is not expanded")
    return graph_of(subject)


class NoLink(Rule):
    """The robot has no link.

    There is nothing to place and nothing to move. urdfdom (ROS, Pinocchio) and PyBullet refuse the file; MuJoCo, Drake
    and yourdfpy make an empty model of it. It may be a part that other files include, or what is left of a xacro file
    that only defines macros.
    """

    code = "T101"
    name = "no-link"
    severity = Severity.ERROR
    hint = "is this the file that you mean?"
    good = GOOD
    bad = Example("""
        <robot name="example"> <!-- T101 -->
        </robot>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield a robot without links."""
        asked(subject)
        if not subject.links:
            yield self.finding(subject.root, "the robot has no link")


class UndefinedLink(Rule):
    """A joint names a parent or child link that does not exist.

    The joint hangs in the air: all readers refuse the file, and none can guess which link was meant.
    """

    code = "T102"
    name = "undefined-link"
    severity = Severity.ERROR
    hint = "add the link, or correct the name"
    good = GOOD
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="continuous"> <!-- T102 -->
          <parent link="base"/><child link="amr"/>
          <axis xyz="0 0 1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each end of a joint that leads nowhere."""
        links, speller = asked(subject).links, Speller()
        known = frozenset(links) if len(links) < 500 else frozenset()  # comparing takes its time
        for joint in subject.joints:
            for end in ("parent", "child"):
                name = tied(joint, end)
                if name is None or name in links:
                    continue
                near = speller.meant(name, known)
                hint = f"did you mean {quote(near)}?" if near else None
                yield self.finding(joint, f"{end} link {quote(name)} does not exist", hint=hint)


class RepeatedName(Rule):
    """Two links, or two joints, have the same name.

    Links and joints are found by their names alone. Readers refuse the file, or one of the two replaces the other.
    """

    code = "T103"
    name = "repeated-name"
    severity = Severity.ERROR
    hint = "names must be unique: rename one of them"
    good = GOOD
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <link name="arm"/> <!-- T103 -->
        <joint name="shoulder" type="continuous">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each link and joint whose name another one had before."""
        asked(subject)
        for elements in (subject.links, subject.joints):
            seen = dict[str, int]()
            for element in elements:
                name = name_of(element)
                if name in seen:
                    message = f"the name is already used at line {seen[name]}"
                    yield self.finding(element, message, attribute="name")
                elif name:
                    seen[name] = element.line


class SelfJoint(Rule):
    """A joint connects a link with itself.

    It says that the link is where it is not; all readers refuse the file, or never come back from it.
    """

    code = "T104"
    name = "self-joint"
    severity = Severity.ERROR
    hint = "a joint connects two links"
    good = GOOD
    bad = Example("""
        <link name="base"/>
        <joint name="shoulder" type="continuous"> <!-- T104 -->
          <parent link="base"/><child link="base"/>
          <axis xyz="0 0 1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each joint with the same link at both ends."""
        links = asked(subject).links
        for joint in subject.joints:
            parent = tied(joint, "parent")
            if parent in links and parent == tied(joint, "child"):
                yield self.finding(joint, f"parent and child are the same link {quote(parent or '')}")


class TwoParents(Rule):
    """A link has two parents.

    URDF describes trees. MuJoCo, Drake and yourdfpy refuse the file, PyBullet crashes on it, and Pinocchio refuses it
    or keeps both joints, as if there were two such links. A closed chain needs a loop joint of the tool's own format,
    or a constraint beside the file.
    """

    code = "T105"
    name = "two-parents"
    severity = Severity.ERROR
    hint = "a link has one parent: remove one of the two joints"
    good = GOOD
    bad = Example("""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="continuous">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
        </joint>
        <joint name="elbow" type="continuous"> <!-- T105 -->
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
        </joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each joint whose child has a parent already."""
        for joint, child, before in asked(subject).again:
            other = f"joint {quote(name_of(before))}, line {before.line}"
            yield self.finding(joint, f"link {quote(child)} already has a parent: {other}")


class SeveralRoots(Rule):
    """Several links have no parent: the file describes several robots, or parts that are not joined.

    urdfdom (ROS, Pinocchio) refuses the file and PyBullet crashes on it. MuJoCo fixes each part to the world, Drake
    lets each float, yourdfpy takes the first part and leaves out the others.
    """

    code = "T106"
    name = "several-roots"
    severity = Severity.ERROR
    hint = "join them, so that one root remains"
    good = GOOD
    bad = Example("""
        <robot name="example"> <!-- T106 -->
          <link name="base"/>
          <link name="arm"/>
          <link name="tool"/>
          <joint name="shoulder" type="continuous">
            <parent link="base"/><child link="arm"/>
            <axis xyz="0 0 1"/>
          </joint>
        </robot>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield a robot with more roots than joints that are broken or doubled (told by others) account for."""
        graph = asked(subject)
        if subject.joints and len(graph.roots) > 1 + graph.broken + len(graph.again):
            yield self.finding(subject.root, f"{len(graph.roots)} links have no parent: {listed(graph.roots)}")


class Cycle(Rule):
    """Joints lead round in a circle.

    Such links hang on each other and not on the root: their place is not defined. Some readers refuse the file, some
    never see these links, and Pinocchio's runs until it crashes.
    """

    code = "T107"
    name = "cycle"
    severity = Severity.ERROR
    hint = "break the cycle: one of its joints must have another child"
    good = GOOD
    bad = Example("""
        <link name="base"/>
        <link name="left"/> <!-- T107 -->
        <link name="right"/>
        <joint name="there" type="fixed"><parent link="left"/><child link="right"/></joint>
        <joint name="back" type="fixed"><parent link="right"/><child link="left"/></joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each circle with its links; at the robot if no root is left, else at the first link of it."""
        graph = asked(subject)
        doubled = {child for _, child, _ in graph.again}
        for loop in graph.loops:
            if doubled.intersection(loop.links):
                continue  # told as a link with two parents
            shown = " -> ".join(quote(link) for link in loop.links[:6])
            end = f"... ({len(loop.links)} links)" if len(loop.links) > 6 else quote(loop.links[0])
            more = f"; {loop.hanging} more hang on it" if loop.hanging else ""
            at: Element = graph.links[loop.first] if graph.roots else subject.root
            none = "" if graph.roots else "every link has a parent: "
            yield self.finding(at, f"{none}the joints form a cycle {shown} -> {end}{more}")


SHAPE: tuple[Rule, ...] = (
    NoLink(),
    UndefinedLink(),
    RepeatedName(),
    SelfJoint(),
    TwoParents(),
    SeveralRoots(),
    Cycle(),
)
