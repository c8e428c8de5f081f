"""X307 to X309: what kinetostat reads and mends for Pinocchio, and what urdfdom (ROS, Pinocchio) takes otherwise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from kinetostat.errors import cut, printable, quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.subject import JOINT_TAGS, Subject, name_of
from kinetostat.urdf.document import Element
from kinetostat.urdf.reading import as_number, words

__all__ = ["MENDED"]

_WHITE = " \t\r\n"
# What urdfdom reads as one number, to the end of the text; and as several, split at blanks only.
_SINGLE: Mapping[str, frozenset[str]] = {
    "limit": frozenset({"lower", "upper", "effort", "velocity"}),
    "dynamics": frozenset({"damping", "friction"}),
    "mimic": frozenset({"multiplier", "offset"}),
    "safety_controller": frozenset({"soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"}),
    "calibration": frozenset({"rising", "falling"}),
    "mass": frozenset({"value"}),
    "inertia": frozenset({"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}),
}
_SEVERAL: Mapping[str, frozenset[str]] = {"origin": frozenset({"xyz", "rpy"}), "axis": frozenset({"xyz"})}


def _joint(limit: str) -> Example:
    return Example(f"""
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          {limit}
        </joint>""")


class StrictNumber(Rule):
    """White space stands behind a number, or a tab or line break parts numbers: not read by urdfdom.

    urdfdom, and with it ROS and Pinocchio, parts numbers at single blanks and reads each to its end. Of a joint it
    refuses the whole file; an inertial it drops or reads as zero, without an error. Other tools read such numbers.
    """

    code = "X307"
    name = "number-white-space"
    severity = Severity.WARNING
    hint = "write blanks between numbers, and nothing behind the last one"
    bad = _joint('<limit lower="-1.5" upper="1.5 " effort="10" velocity="1"/> <!-- X307 -->')
    good = _joint('<limit lower="-1.5" upper="1.5" effort="10" velocity="1"/>')

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the attributes of joints and of inertials that urdfdom does not read."""
        document = subject.document
        written = {(id(e), key): value for e, key, value in document.broken} if document is not None else {}
        found = []
        for owner, element in _read_by_urdfdom(subject):
            single, several = _SINGLE.get(element.tag, ()), _SEVERAL.get(element.tag, ())
            for key, value in element.attributes.items():
                if key not in single and key not in several:
                    continue
                text = written.get((id(element), key), value)
                if _is_lost(text, several=key in several):
                    message = f"{key}={quote(text)} is not read by urdfdom"
                    found.append(Found(element, name_of(owner), message, key))
        yield from grouped(self, found, what="element")


def _read_by_urdfdom(subject: Subject) -> Iterator[tuple[Element, Element]]:
    """Yield the elements of joints and inertials that hold numbers, each with its joint or link."""
    for joint in subject.joints:
        yield from ((joint, part) for part in joint.children)
    for link in subject.links:
        for inertial in link.all("inertial"):
            yield from ((link, part) for part in inertial.children)


def _is_lost(text: str, *, several: bool) -> bool:
    """Return whether urdfdom fails at white space in numbers that others read."""
    if not text.strip(_WHITE) or any(as_number(word) is None for word in words(text)):
        return False  # other rules say that it is no number
    parts = [part for part in text.split(" ") if part] if several else [text]
    # White space before a number is passed over.
    return any(not (rest := part.lstrip(_WHITE)) or any(white in rest for white in _WHITE) for part in parts)


class ProcessingInstruction(Rule):
    """There is a processing instruction, `<?...?>`, inside the robot.

    Pinocchio refuses such a file, wherever in the robot it stands; most other readers pass it over, and so does
    kinetostat.
    """

    code = "X308"
    name = "processing-instruction"
    severity = Severity.INFO
    hint = "remove it, or make it a comment"
    bad = Example("""
        <?editor schema="urdf.xsd" ?> <!-- X308 -->
        <link name="base"/>""")
    good = Example("""
        <link name="base"/>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the first of them."""
        instructions = subject.document.instructions if subject.document is not None else ()
        if not instructions:
            return
        line, target = instructions[0]
        others = f", and {len(instructions) - 1} more" if len(instructions) > 1 else ""
        yield self.finding(line, f"<?{printable(cut(target))} ...?>{others}: Pinocchio refuses the file")


class DrakeJoint(Rule):
    """A joint is written as Drake's extension, `<drake:joint>`: other readers do not see it.

    Drake reads it as a joint of the robot. urdfdom (ROS, Pinocchio) and yourdfpy pass it over, and its child becomes a
    second root of the tree, for which they refuse the file or lose a part.
    """

    code = "X309"
    name = "drake-joint"
    severity = Severity.WARNING
    hint = "keep the file for Drake, or give the others a <joint> of a type that they know"
    bad = Example("""
        <robot name="example" xmlns:drake="https://drake.mit.edu">
          <link name="base"/>
          <link name="nut"/>
          <drake:joint name="spindle" type="screw"> <!-- X309 -->
            <parent link="base"/><child link="nut"/>
            <axis xyz="0 0 1"/>
            <drake:screw_thread_pitch value="0.005"/>
          </drake:joint>
        </robot>""")
    good = _joint('<limit lower="-1.5" upper="1.5" effort="10" velocity="1"/>')

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the joints that only Drake sees."""
        found = [
            Found(joint, name_of(joint), f"<{joint.tag}> is seen by Drake only", "")
            for joint in subject.joints
            if joint.tag != JOINT_TAGS[0]
        ]
        yield from grouped(self, found, what="joint")


MENDED: tuple[Rule, ...] = (StrictNumber(), ProcessingInstruction(), DrakeJoint())
