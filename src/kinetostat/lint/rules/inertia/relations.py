"""I4: how the inertia of one link stands to the robot and to its counterpart on the other side."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from kinetostat.errors import quote
from kinetostat.lint.bodies import Bodies, LinkInertia, bodies_of
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import listed
from kinetostat.lint.mirror import Comparison, compared, in_words
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.sides import pairs
from kinetostat.lint.subject import Subject, end_of, first, name_of, vector
from kinetostat.lint.tensors import NO_MASS

__all__ = ["RELATIONS"]

Pair = tuple[LinkInertia, LinkInertia, Comparison]
DUMMY = 1e-3  # of the mass of the robot: a root that weighs less stands for nothing, or nearly


class BaseInertia(Rule):
    """The root link has an inertial.

    KDL, and with it robot_state_publisher and MoveIt's kinematics, takes no inertia of the root: it warns at every
    start and leaves it out. A massless root with the real base fixed to it avoids that. For a mobile robot in
    simulation the inertia of the root does count. Nothing is said where it hardly weighs anything.
    """

    code = "I401"
    name = "base-inertia"
    severity = Severity.INFO
    hint = "where KDL is used, add a root link without inertial and fix this one to it"
    bad = Example("""
        <link name="base">
          <inertial> <!-- I401 -->
            <mass value="5"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>
          </inertial>
        </link>
        <link name="arm"/>
        <joint name="shoulder" type="continuous"><parent link="base"/><child link="arm"/></joint>""")
    good = Example("""
        <link name="base"/>
        <link name="pedestal">
          <inertial>
            <mass value="5"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>
          </inertial>
        </link>
        <joint name="base-pedestal" type="fixed"><parent link="base"/><child link="pedestal"/></joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the root link that has a mass worth speaking of, unless it is the only link."""
        bodies = bodies_of(subject)
        children = {end_of(joint, "child") for joint in subject.joints}
        least = max(NO_MASS, DUMMY * bodies.mass)
        for inertia in bodies.inertias.values():
            if inertia.name not in children and inertia.mass > least and children:
                message = f"the root link weighs {inertia.mass:g} kg, which KDL leaves out"
                yield self.finding(first(inertia.link, "inertial") or inertia.link, message)


class UnevenSides(Rule):
    """A left link and its right counterpart are not mirror images in mass, centre or tensor.

    Parts of the two sides mostly come from one drawing. Where all sizes are equal but the signs fit neither a mirror
    image nor the same part turned over, a sign was forgotten on one of them; where a single pair differs in mass, one
    of the two was changed and the other forgotten. The robot then leans, and a controller that mirrors its gains does
    not. Across which axis two frames are mirrored depends on how they were laid; the hint says what fits the file best.
    """

    code = "I402"
    name = "sides-uneven"
    severity = Severity.WARNING
    hint = "compare the two with their drawings"
    bad = Example("""
        <link name="base"/>
        <link name="left_arm">
          <inertial>
            <origin xyz="0.1 0.05 0.02"/><mass value="1"/>
            <inertia ixx="0.01" ixy="0.002" ixz="0" iyy="0.02" iyz="0" izz="0.02"/>
          </inertial>
        </link>
        <link name="right_arm">
          <inertial>
            <origin xyz="0.1 -0.05 0.02"/><mass value="1"/>
            <inertia ixx="0.01" ixy="0.002" ixz="0" iyy="0.02" iyz="0" izz="0.02"/> <!-- I402 -->
          </inertial>
        </link>
        <joint name="left" type="continuous"><parent link="base"/><child link="left_arm"/></joint>
        <joint name="right" type="continuous"><parent link="base"/><child link="right_arm"/></joint>""")
    good = Example("""
        <link name="base"/>
        <link name="left_arm">
          <inertial>
            <origin xyz="0.1 0.05 0.02"/><mass value="1"/>
            <inertia ixx="0.01" ixy="0.002" ixz="0" iyy="0.02" iyz="0" izz="0.02"/>
          </inertial>
        </link>
        <link name="right_arm">
          <inertial>
            <origin xyz="0.1 -0.05 0.02"/><mass value="1"/>
            <inertia ixx="0.01" ixy="-0.002" ixz="0" iyy="0.02" iyz="0" izz="0.02"/>
          </inertial>
        </link>
        <joint name="left" type="continuous"><parent link="base"/><child link="left_arm"/></joint>
        <joint name="right" type="continuous"><parent link="base"/><child link="right_arm"/></joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the pairs with a wrong sign or an odd mass; one info for those that differ otherwise."""
        found = self._compared(subject)
        weighed = [pair for pair in found if not pair[2].mass]
        odd_masses = weighed if 2 * len(weighed) < len(found) else []
        for left, right, comparison in found:
            if comparison.wrong:
                wrong = "; ".join(f"{w.what} {w.right:.4g}, there {w.left:.4g}" for w in comparison.wrong)
                message = f"signs fit neither a mirror image of {_name(left)} nor the same part turned over: {wrong}"
                joints = "; the joints on the two are mirrored" if comparison.joints else ""
                yield self.finding(right.element, message + joints, hint=_remedy(comparison))
        for left, right, _ in odd_masses:
            mass = first(right.link, "inertial", "mass") or right.link
            yield self.finding(
                mass,
                f"mass {right.mass:g} kg, but {_name(left)} {left.mass:g} kg",
                hint="which of the two is right?",
                attribute="value",
            )
        rest = [pair for pair in found if pair[2].differing and pair not in odd_masses]
        if rest:
            yield self._summed(rest, len(found))

    def _summed(self, rest: list[Pair], count: int) -> Finding:
        left, right, _ = rest[0]
        names = listed([other.name for _, other, _ in rest])
        what = [each for each in ("mass", "centre of mass", "moments") if any(each in c.differing for *_, c in rest)]
        message = f"{len(rest)} of {count} left-right pairs differ in {', '.join(what)}: {names}"
        return self.finding(
            right.element, message, severity=Severity.INFO, hint=f"compare with {_name(left)}", several=len(rest) > 1
        )

    def _compared(self, subject: Subject) -> list[Pair]:
        bodies = bodies_of(subject)
        places = _places(subject)
        others = dict(pairs(bodies.head))
        found = []
        for left, right in others.items():
            if self._comparable(bodies, left) and self._comparable(bodies, right):
                a, b = bodies.inertias[left], bodies.inertias[right]
                below = places.get(left, {}), places.get(right, {})
                points = [(at, below[1][others[link]]) for link, at in below[0].items() if others.get(link) in below[1]]
                found.append((a, b, compared(a, b, points)))
        return found

    def _comparable(self, bodies: Bodies, link: str) -> bool:
        inertia = bodies.inertias.get(link)
        return inertia is not None and inertia.mass > NO_MASS and not bodies.negligible(inertia)


def _remedy(comparison: Comparison) -> str:
    """Return which signs should differ, if that is clear; which of the two links is wrong never is."""
    if comparison.turn is None:
        change = "mirrored in one axis, the centre changes sign along it, and so do the two products with that axis"
    else:
        change = in_words(comparison.turn)
    return f"correct one of the two: {change}"


def _places(subject: Subject) -> Mapping[str, dict[str, tuple[float, ...]]]:
    """Return by link where the joints that move others on it are, by the link that each carries.

    Fixed joints do not count: sensors and tools are often mounted alike on both sides.
    """
    places: dict[str, dict[str, tuple[float, ...]]] = {}
    for joint in subject.joints:
        xyz = vector(first(joint, "origin"), "xyz", 3)
        if xyz is not None and joint.attributes.get("type") != "fixed":
            places.setdefault(end_of(joint, "parent"), {})[end_of(joint, "child")] = xyz
    return places


def _name(inertia: LinkInertia) -> str:
    return quote(name_of(inertia.link), 40)


RELATIONS: tuple[Rule, ...] = (BaseInertia(), UnevenSides())
