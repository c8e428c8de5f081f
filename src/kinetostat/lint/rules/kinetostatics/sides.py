"""K105: a left and a right limb that are neither mirror images nor the same part."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from kinetostat.conventions import Array
from kinetostat.errors import quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Needs, Rule
from kinetostat.lint.rules.kinetostatics.limbs import Structure, structure
from kinetostat.lint.sides import pairs
from kinetostat.lint.subject import Subject
from kinetostat.urdf.description import Joint, JointType

__all__ = ["UnequalSides"]

_SAME_LENGTH = 1e-3  # m, and of the limb's size: less is how drawings are rounded
_SAME_ANGLE = 1e-2  # rad
_SAME_RANGE = 0.02  # rad or m
_SAME_KIND = {JointType.CONTINUOUS: JointType.REVOLUTE}
_LEG = """
        <link name="base"/>
        <link name="left_thigh"/>
        <link name="left_shin"/>
        <link name="right_thigh"/>
        <link name="right_shin"/>
        <joint name="left_hip" type="revolute">
          <parent link="base"/><child link="left_thigh"/><origin xyz="0 0.1 0"/><axis xyz="0 1 0"/>
          <limit lower="-1" upper="2" effort="50" velocity="1"/>
        </joint>
        <joint name="right_hip" type="revolute">
          <parent link="base"/><child link="right_thigh"/><origin xyz="0 -0.1 0"/><axis xyz="0 1 0"/>
          <limit lower="-1" upper="2" effort="50" velocity="1"/>
        </joint>
        <joint name="left_knee" type="revolute">{mark}
          <parent link="left_thigh"/><child link="left_shin"/><origin xyz="0 0 -0.40"/><axis xyz="0 1 0"/>
          <limit lower="-2" upper="0" effort="50" velocity="1"/>
        </joint>
        <joint name="right_knee" type="revolute">
          <parent link="right_thigh"/><child link="right_shin"/><origin xyz="0 0 -{length}"/><axis xyz="0 1 0"/>
          <limit lower="-2" upper="0" effort="50" velocity="1"/>
        </joint>"""


class UnequalSides(Rule):
    """A left and a right limb differ in lengths, axes or ranges: neither mirrored nor the same.

    The two sides of a robot mostly come from one drawing: a length that is only on one side was mistyped, or changed
    on one side and forgotten on the other. What is compared does not depend on how frames lie: the distance and the
    angle between one joint's axis and the next, and how far the limb goes on along an axis. Ranges may be mirrored.
    """

    code = "K105"
    name = "unequal-sides"
    severity = Severity.WARNING
    hint = "correct the side that is wrong; or say in a comment that the robot is built like this"
    needs = Needs.MODEL
    bad = Example(_LEG.format(mark=" <!-- K105 -->", length="0.36"))
    good = Example(_LEG.format(mark="", length="0.40"))

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the first joint of each limb at which the two sides part."""
        found, parted = structure(subject), set[str]()
        partners = dict(pairs(found.before))
        for name, other in partners.items():
            left, right = found.robot.joint_by_name[name], found.robot.joint_by_name[other]
            above = found.before[name]
            if above is not None and above.name in parted:  # told already
                parted.add(name)
                continue
            kinds = [_SAME_KIND.get(joint.type, joint.type) for joint in (left, right)]
            if kinds[0] is not kinds[1] or left.type.nv != 1:
                continue
            difference = _geometry(found, left, right, partners)
            if difference:
                parted.add(name)
                yield self.finding(subject.joint_elements[name], difference)
                continue
            difference = _range(left, right)
            if difference:
                parted.add(name)
                yield self.finding(subject.joint_elements[name], difference, severity=Severity.INFO)


def _geometry(found: Structure, left: Joint, right: Joint, partners: dict[str, str]) -> str:
    """Return in what the axes of two joints stand differently to those before them; empty if in nothing."""
    runs = _runs(found, left, right, partners)
    if len(runs[0]) < 2:
        return ""
    lines = [[_line(found, joint) for joint in run] for run in runs]
    size = max(float(np.linalg.norm(b[0] - a[0])) for a, b in (side[-2:] for side in lines))
    slack = _SAME_LENGTH * max(1.0, size)
    before, after = (quote(run[-2].name, 40) for run in runs)
    angles = [_angle(*side[-2:]) for side in lines]
    if abs(angles[0] - angles[1]) > _SAME_ANGLE:
        return (
            f"its axis is at {np.degrees(angles[0]):.3g} deg to that of {before} before it;"
            f" on the other side that of {quote(right.name, 40)} at {np.degrees(angles[1]):.3g} deg"
        )
    if any(_slides(joint) for run in runs for joint in run[-2:]):
        return ""  # where a slide's axis lies does not matter
    distances = [_distance(*side[-2:]) for side in lines]
    if abs(distances[0] - distances[1]) > slack:
        return (
            f"its axis is {distances[0]:.4g} m from that of {before} before it;"
            f" on the other side that of {quote(right.name, 40)} is {distances[1]:.4g} m from that of {after}"
        )
    if len(lines[0]) < 3 or any(_slides(joint) for run in runs for joint in run):
        return ""
    one, other = (_along(*side) for side in lines)
    if one is not None and other is not None and abs(one - other) > slack:
        return (
            f"it is {one:.4g} m further along the axis of {before};"
            f" on the other side {quote(right.name, 40)} is {other:.4g} m further"
        )
    return ""


def _runs(found: Structure, left: Joint, right: Joint, partners: dict[str, str]) -> tuple[list[Joint], list[Joint]]:
    """Return two joints, each with up to two before it, outwards, as far as those are counterparts, too."""
    runs = [left], [right]
    while len(runs[0]) < 3:
        one, other = (found.before[run[0].name] for run in runs)
        if one is None or other is None or partners.get(one.name) != other.name:
            break
        runs[0].insert(0, one)
        runs[1].insert(0, other)
    return runs


def _slides(joint: Joint) -> bool:
    return joint.type is JointType.PRISMATIC


def _line(found: Structure, joint: Joint) -> tuple[Array, Array]:
    """Return a point of a joint's axis and its direction at zero."""
    placed = found.zero[joint.child]
    return placed[:3, 3], placed[:3, :3] @ np.array(joint.axis)


_Line = tuple[Array, Array]


def _angle(a: _Line, b: _Line) -> float:
    """Return the angle between two lines, 0 to pi/2."""
    return float(np.arctan2(np.linalg.norm(np.cross(a[1], b[1])), abs(a[1] @ b[1])))


def _distance(a: _Line, b: _Line) -> float:
    """Return the distance between two lines."""
    across, arm = np.cross(a[1], b[1]), b[0] - a[0]
    sine = float(np.linalg.norm(across))
    if sine < _SAME_ANGLE:
        return float(np.linalg.norm(np.cross(arm, a[1])))
    return abs(float(arm @ across)) / sine


def _along(a: _Line, b: _Line, c: _Line) -> float | None:
    """Return how far apart on the axis b the feet of its common normals with a and c are; None if one is nowhere."""
    feet = [_foot(b, other) for other in (a, c)]
    return None if feet[0] is None or feet[1] is None else abs(feet[1] - feet[0])


def _foot(line: _Line, other: _Line) -> float | None:
    """Return where on a line the common normal with another stands; None where they are parallel."""
    cosine, arm = float(line[1] @ other[1]), other[0] - line[0]
    square = 1 - cosine * cosine
    if square < _SAME_ANGLE:
        return None
    return float(arm @ line[1] - cosine * (arm @ other[1])) / square


def _range(left: Joint, right: Joint) -> str:
    """Return how two ranges differ, be they mirrored or the same; empty if they do not."""
    (a, b), (c, d) = left.limit.range, right.limit.range
    if not np.all(np.isfinite([a, b, c, d])) or _near((a, b), (c, d)) or _near((a, b), (-d, -c)):
        return ""
    if abs((b - a) - (d - c)) <= _SAME_RANGE * max(1.0, b - a):  # zero lies elsewhere
        return ""
    unit = "rad" if left.type.is_angle else "m"
    return f"it moves from {a:.4g} to {b:.4g} {unit}; on the other side {quote(right.name, 40)} from {c:.4g} to {d:.4g}"


def _near(one: Sequence[float], other: Sequence[float]) -> bool:
    return all(abs(x - y) <= _SAME_RANGE for x, y in zip(one, other, strict=True))
