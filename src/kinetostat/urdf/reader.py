"""A document to a description: one tree of uniquely named links and joints, every number finite.

What would make a number wrong is an error; what the reader assumes, ignores or mends is a remark.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import replace

from kinetostat.errors import LimitError, NumberError, RobotError, StructureError, printable, quote
from kinetostat.urdf.description import (
    Inertial,
    Joint,
    JointType,
    Limit,
    Link,
    Mesh,
    Mimic,
    Origin,
    Remark,
    Robot,
    Vector,
)
from kinetostat.urdf.document import Document, Element

__all__ = ["read"]

MAX_LINKS = 20_000
MAX_DEPTH = 400
MAX_DOF = 300
MAX_LENGTH = 1e12  # metres: beyond it double precision leaves less than a millimetre
MAX_MASS = 1e15
MAX_INERTIA = 1e30
MAX_ANGLE = 1e6  # radians: an rpy angle beyond it has lost its meaning
MAX_MULTIPLIER = 1e6
SMALLEST_AXIS = 1e-9

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_INFINITY = re.compile(r"[+-]?inf(?:inity)?", re.IGNORECASE)
_INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def read(document: Document) -> Robot:
    """Return the robot that a document describes.

    Raises:
        StructureError: not one tree of uniquely named links and joints.
        NumberError: a number does not parse, is not finite, or a vector has the wrong length.
        LimitError: more than 20,000 links, 400 links deep, or 300 degrees of freedom.
    """
    return _Reader(document).robot()


class _Reader:
    """The state of one reading: the file's name for errors, and the remarks so far."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.remarks = [Remark(line, "", text) for line, text in document.remarks]
        self.version = (1, 0)

    def robot(self) -> Robot:
        root = self.document.root
        if root.tag != "robot":
            remedy = "convert it to URDF first" if root.tag == "sdf" else None
            raise self._error(root, f"the root element is <{quote(root.tag)[1:-1]}>, not <robot>", remedy)
        self._read_version(root)
        name = root.attributes.get("name", "")
        if not name:
            self._remark(root, "the robot has no name")
        self._refuse_xacro(root)
        links = self._links(root)
        joints = self._joints(root, {link.name: link for link in links})
        top = self._tree(root, links, joints)
        joints = self._without_lost_leaders(joints)
        self._mimics(joints)
        described = Robot(name, tuple(links), tuple(joints), top, tuple(sorted(self.remarks, key=lambda r: r.line)))
        if described.nv > MAX_DOF:
            raise self._error(
                root, f"the robot has {described.nv} degrees of freedom; at most {MAX_DOF} are read", kind=LimitError
            )
        return described

    # --- errors and remarks ------------------------------------------------------------------------------------

    def _error(
        self, element: Element, message: str, remedy: str | None = None, kind: type[RobotError] = StructureError
    ) -> RobotError:
        return kind(message, file=self.document.file, line=element.line, element=element.label(), remedy=remedy)

    def _remark(self, element: Element, text: str) -> None:
        self.remarks.append(Remark(element.line, element.label(), text))

    # --- the robot element -------------------------------------------------------------------------------------

    def _read_version(self, root: Element) -> None:
        version = root.attributes.get("version")
        if version is None:
            return
        match = re.fullmatch(r"\s*([0-9]{1,3})(?:\.([0-9]{1,3}))?\s*", version)
        if match is None:
            raise self._error(root, f"version {quote(version)} is not a version", 'write version="1.0", or nothing')
        self.version = (int(match[1]), int(match[2] or 0))
        if match[2] is None:
            self._remark(root, f"version {quote(version)} is not of the form 1.0: other parsers refuse it")
        elif self.version > (1, 0):
            self._remark(root, f"version {quote(version)}: parsers older than urdfdom 5 refuse it")

    def _refuse_xacro(self, root: Element) -> None:
        for child in root.children:
            if child.tag.startswith("xacro:"):
                raise self._error(child, "xacro that is not expanded", "name the file .xacro, or run xacro on it first")

    # --- links -------------------------------------------------------------------------------------------------

    def _links(self, root: Element) -> list[Link]:
        elements = root.all("link")
        if not elements:
            raise self._error(root, "the robot has no link")
        if len(elements) > MAX_LINKS:
            raise self._error(
                root, f"the robot has {len(elements)} links; at most {MAX_LINKS} are read", kind=LimitError
            )
        seen: dict[str, int] = {}
        return [self._link(element, seen) for element in elements]

    def _link(self, element: Element, seen: dict[str, int]) -> Link:
        name = self._name(element, seen)
        meshes = tuple(
            Mesh(mesh.attributes["filename"], mesh.line)
            for kind in ("visual", "collision")
            for shape in element.all(kind)
            for geometry in shape.all("geometry")
            for mesh in geometry.all("mesh")
            if "filename" in mesh.attributes
        )
        return Link(name, element.line, self._inertial(element), meshes)

    def _name(self, element: Element, seen: dict[str, int]) -> str:
        name = element.attributes.get("name")
        if not name:
            raise self._error(element, f"a {quote(element.tag)[1:-1]} without a name", "give it a name")
        # A line break or a tab may stand in a name; a control character (a terminal escape) may not.
        if any(ord(c) in range(0x7F, 0xA0) or (ord(c) < 32 and c not in "\t\r\n") for c in name):
            raise self._error(element, "the name holds a control character", "rename it")
        if name in seen:
            raise self._error(element, f"the name is already used at line {seen[name]}", "names must be unique")
        seen[name] = element.line
        return name

    def _inertial(self, link: Element) -> Inertial | None:
        element = self._single(link, "inertial")
        if element is None:
            return None
        origin = self._origin(element)
        mass, inertia = self._single(element, "mass"), self._single(element, "inertia")
        missing = [] if mass is not None and "value" in mass.attributes else ["mass value"]
        missing += [key for key in _INERTIA if inertia is None or key not in inertia.attributes]
        values = [
            self._number(inertia, key, largest=MAX_INERTIA) for key in _INERTIA if inertia and key in inertia.attributes
        ]
        if mass is not None and "value" in mass.attributes:
            values.insert(0, self._number(mass, "value", largest=MAX_MASS))
        if missing:
            # urdfdom, and so Pinocchio, drops such an inertial as a whole; so do we, and say it.
            self._remark(link, f"the inertial has no {', '.join(missing)}: the link counts as massless")
            return None
        m, ixx, ixy, ixz, iyy, iyz, izz = values
        return Inertial(m, origin, (ixx, ixy, ixz, iyy, iyz, izz))

    # --- joints ------------------------------------------------------------------------------------------------

    def _joints(self, root: Element, links: dict[str, Link]) -> list[Joint]:
        elements = [child for child in root.children if child.tag in ("joint", "drake:joint")]
        seen: dict[str, int] = {}
        return [self._joint(element, seen, links) for element in elements]

    def _joint(self, element: Element, seen: dict[str, int], links: dict[str, Link]) -> Joint:
        name = self._name(element, seen)
        kind = self._joint_type(element)
        parent, child = (self._end(element, end, links) for end in ("parent", "child"))
        limit = self._limit(element, kind)
        dynamics = self._single(element, "dynamics")
        if dynamics is not None:
            for key in ("damping", "friction"):
                if key in dynamics.attributes:
                    self._number(dynamics, key)
        return Joint(
            name,
            kind,
            parent,
            child,
            element.line,
            origin=self._origin(element),
            axis=self._axis(element, kind),
            limit=limit,
            mimic=self._mimic(element, kind),
            pitch=self._pitch(element) if kind is JointType.SCREW else 0.0,
        )

    def _joint_type(self, element: Element) -> JointType:
        text = element.attributes.get("type")
        if text is None:
            raise self._error(element, "a joint without a type", 'write type="revolute" or another type')
        drake = element.tag == "drake:joint"
        known = ("screw", "planar") if drake else [t.value for t in JointType if t is not JointType.SCREW]
        if text in known:
            return JointType(text)
        if text == "screw":
            raise self._error(element, "type 'screw' belongs to Drake's dialect", 'write <drake:joint type="screw">')
        raise self._error(element, f"joint type {quote(text)} is not one of {', '.join(known)}")

    def _end(self, element: Element, end: str, links: dict[str, Link]) -> str:
        found = self._single(element, end)
        if found is None or "link" not in found.attributes:
            raise self._error(found or element, f"no {end} link", f'write <{end} link="..."/>')
        link = found.attributes["link"]
        if link not in links:
            raise self._error(element, f"{end} link {quote(link)} does not exist", "add the link, or correct the name")
        return link

    def _axis(self, element: Element, kind: JointType) -> Vector:
        if kind in (JointType.FIXED, JointType.FLOATING):
            return (1.0, 0.0, 0.0)
        found = self._single(element, "axis")
        if found is None:
            self._remark(element, "no axis: URDF's default 1 0 0 holds")
            return (1.0, 0.0, 0.0)
        x, y, z = self._vector(found, "xyz", 3)
        norm = math.hypot(x, y, z)
        if norm < SMALLEST_AXIS:
            raise self._error(found, "the axis is zero", "give it a direction", NumberError)
        if abs(norm - 1) > 1e-3:
            self._remark(element, f"the axis has length {norm:.6g}: its direction counts, not its length")
        if kind is JointType.PLANAR and (x, y) != (0.0, 0.0):
            self._remark(
                element, "a planar joint whose normal is not z: Pinocchio alone, like many tools, ignores the axis"
            )
        return (x / norm, y / norm, z / norm)

    def _limit(self, element: Element, kind: JointType) -> Limit:
        bounded = kind in (JointType.REVOLUTE, JointType.PRISMATIC)
        found = self._single(element, "limit")
        if found is None:
            if bounded:
                self._remark(element, "no limit: its range, effort and velocity count as unlimited")
            return Limit()
        values = {
            key: self._number(found, key, infinite=True)
            for key in ("lower", "upper", "effort", "velocity")
            if key in found.attributes
        }
        for key in ("effort", "velocity"):
            if key not in values and bounded:
                self._remark(element, f"the limit has no {key}: it counts as not stated")
            elif values.get(key, 0.0) < 0:
                self._remark(element, f"the {key} limit {values[key]:g} is negative")
        if not bounded:
            return Limit(effort=values.get("effort"), velocity=values.get("velocity"))
        for key in ("lower", "upper"):
            if key not in values:
                self._remark(element, f"the limit has no {key}: URDF's default 0 holds")
        lower, upper = values.get("lower", 0.0), values.get("upper", 0.0)
        self._remark_range(element, kind, lower, upper)
        return Limit(lower, upper, values.get("effort"), values.get("velocity"))

    def _remark_range(self, element: Element, kind: JointType, lower: float, upper: float) -> None:
        if math.isinf(lower) or math.isinf(upper):
            self._remark(element, "an infinite limit: other parsers refuse the file")
        if lower > upper:
            self._remark(element, f"lower {lower:g} is above upper {upper:g}: they are read the other way round")
        elif lower == upper:
            self._remark(element, f"lower and upper are both {lower:g}: the joint cannot move")
        elif kind is JointType.REVOLUTE and 4 * math.pi + 1e-3 < upper - lower < math.inf:
            self._remark(element, f"a range of {upper - lower:.4g} rad, more than two turns: are these degrees?")

    def _mimic(self, element: Element, kind: JointType) -> Mimic | None:
        found = self._single(element, "mimic")
        if found is None:
            return None
        if "joint" not in found.attributes:
            raise self._error(element, "a mimic that names no joint", 'write <mimic joint="..."/>')
        multiplier = (
            self._number(found, "multiplier", largest=MAX_MULTIPLIER) if "multiplier" in found.attributes else 1.0
        )
        offset = self._number(found, "offset", largest=MAX_LENGTH) if "offset" in found.attributes else 0.0
        if kind is JointType.FIXED:
            self._remark(element, "a mimic on a fixed joint has no effect")
            return None
        if kind in (JointType.FLOATING, JointType.PLANAR):
            raise self._error(element, f"a {kind} joint cannot follow another", "remove its <mimic>")
        if multiplier == 0:
            self._remark(element, "mimic multiplier 0: the joint never moves")
        return Mimic(found.attributes["joint"], multiplier, offset)

    def _pitch(self, element: Element) -> float:
        found = self._single(element, "drake:screw_thread_pitch")
        if found is None or "value" not in found.attributes:
            raise self._error(
                element, "a screw joint without a pitch", 'write <drake:screw_thread_pitch value="metres per turn"/>'
            )
        return self._number(found, "value", largest=MAX_LENGTH)

    # --- the tree ----------------------------------------------------------------------------------------------

    def _tree(self, root: Element, links: list[Link], joints: list[Joint]) -> str:
        """Check that the joints make one tree over the links; return its root link."""
        above: dict[str, Joint] = {}
        below: dict[str, list[str]] = {}
        for joint in joints:
            where = Element("joint", {"name": joint.name}, joint.line)
            if joint.parent == joint.child:
                raise self._error(where, f"parent and child are the same link {quote(joint.child)}")
            if joint.child in above:
                other = above[joint.child]
                raise self._error(
                    where,
                    f"link {quote(joint.child)} already has a parent: joint {quote(other.name)}, line {other.line}",
                )
            above[joint.child] = joint
            below.setdefault(joint.parent, []).append(joint.child)
        roots = [link for link in links if link.name not in above]
        if not roots:
            raise self._error(root, "every link has a parent: the joints form a cycle", "one link must be the root")
        if len(roots) > 1:
            named = ", ".join(quote(link.name) for link in roots[:4]) + (", ..." if len(roots) > 4 else "")
            raise self._error(
                root, f"{len(roots)} links have no parent: {named}", "join them, so that one root remains"
            )
        depth = {roots[0].name: 1}
        stack = [roots[0].name]
        while stack:
            link = stack.pop()
            for child in below.get(link, ()):
                depth[child] = depth[link] + 1
                stack.append(child)
        if len(depth) < len(links):
            lost = next(link for link in links if link.name not in depth)
            where = Element("link", {"name": lost.name}, lost.line)
            raise self._error(where, "the link hangs in a cycle of joints, apart from the root", "break the cycle")
        deepest = max(depth.values())
        if deepest > MAX_DEPTH:
            raise self._error(root, f"a chain is {deepest} links deep; at most {MAX_DEPTH} are read", kind=LimitError)
        return roots[0].name

    def _without_lost_leaders(self, joints: list[Joint]) -> list[Joint]:
        """Make followers of joints that do not exist independent, as every simulator does, and say so."""
        names = {joint.name for joint in joints}
        kept = []
        for joint in joints:
            lost = joint.mimic is not None and joint.mimic.joint not in names
            if lost and joint.mimic is not None:
                where = Element("joint", {"name": joint.name}, joint.line)
                missing = quote(joint.mimic.joint)
                self._remark(where, f"it mimics {missing}, which does not exist: it counts as independent")
            kept.append(replace(joint, mimic=None) if lost else joint)
        return kept

    def _mimics(self, joints: list[Joint]) -> None:
        """Check that every follower ends at a joint with one coordinate."""
        by_name = {joint.name: joint for joint in joints}
        settled: set[str] = set()
        for follower in joints:
            trail: dict[str, None] = {}
            joint = follower
            while joint.mimic is not None and joint.name not in settled:
                where = Element("joint", {"name": joint.name}, joint.line)
                leader = by_name[joint.mimic.joint]
                trail[joint.name] = None
                if leader.name in trail:
                    raise self._error(
                        where, f"its mimics lead back to joint {quote(leader.name)}: a circle has no leader"
                    )
                if leader.type.nq != 1:
                    raise self._error(
                        where, f"it mimics the {leader.type} joint {quote(leader.name)}, which has no single position"
                    )
                joint = leader
            settled.update(trail)

    # --- elements and numbers ----------------------------------------------------------------------------------

    def _single(self, element: Element, tag: str) -> Element | None:
        found = element.all(tag)
        if len(found) > 1:
            self._remark(element, f"{len(found)} <{tag}> elements: the first, at line {found[0].line}, counts")
        return found[0] if found else None

    def _origin(self, element: Element) -> Origin:
        found = self._single(element, "origin")
        if found is None:
            return Origin()
        zero = (0.0, 0.0, 0.0)
        xyz = self._vector(found, "xyz", 3, largest=MAX_LENGTH) if "xyz" in found.attributes else zero
        if "quat_xyzw" in found.attributes:
            return Origin(self._triple(xyz), quaternion_xyzw=self._quaternion(found))
        rpy = self._vector(found, "rpy", 3, largest=MAX_ANGLE) if "rpy" in found.attributes else zero
        if max(abs(angle) for angle in rpy) > 2 * math.pi + 1e-3:
            self._remark(element, "an rpy angle beyond a full turn: are these degrees?")
        return Origin(self._triple(xyz), self._triple(rpy))

    def _quaternion(self, element: Element) -> tuple[float, float, float, float]:
        if self.version < (1, 1):
            raise self._error(element, "quat_xyzw is part of URDF 1.1", 'write <robot version="1.1">, or use rpy')
        if "rpy" in element.attributes:
            raise self._error(element, "both rpy and quat_xyzw are given", "keep one of them")
        x, y, z, w = self._vector(element, "quat_xyzw", 4)
        norm = math.hypot(x, y, z, w)
        if norm < SMALLEST_AXIS:
            raise self._error(element, "the quaternion is zero", "a rotation has a unit quaternion", NumberError)
        if abs(norm - 1) > 1e-3:
            self._remark(element, f"the quaternion has length {norm:.6g}: it is normalised")
        return (x / norm, y / norm, z / norm, w / norm)

    @staticmethod
    def _triple(values: Iterable[float]) -> Vector:
        x, y, z = values
        return (x, y, z)

    def _vector(self, element: Element, key: str, size: int, largest: float = math.inf) -> tuple[float, ...]:
        text = element.attributes.get(key)
        if text is None:
            raise self._error(element, f"no {key}", kind=NumberError)
        words = re.split(r"[ \t\r\n]+", text.strip(" \t\r\n")) if text.strip(" \t\r\n") else []
        if len(words) != size:
            raise self._error(element, f"{key}={quote(text)} has {len(words)} numbers, not {size}", kind=NumberError)
        return tuple(self._parse(element, key, word, largest=largest) for word in words)

    def _number(self, element: Element, key: str, *, infinite: bool = False, largest: float = math.inf) -> float:
        return self._parse(element, key, element.attributes[key].strip(" \t\r\n"), infinite=infinite, largest=largest)

    def _parse(
        self, element: Element, key: str, word: str, *, infinite: bool = False, largest: float = math.inf
    ) -> float:
        if infinite and _INFINITY.fullmatch(word):
            return float(word)
        if not _NUMBER.fullmatch(word):
            remedy = (
                "write a decimal point, and spaces between numbers" if "," in word else "write a plain decimal number"
            )
            if "$" in word:
                remedy = "this is xacro that is not expanded"
            raise self._error(element, f"{key}: {quote(word)} is not a finite number", remedy, NumberError)
        value = float(word)
        if math.isinf(value) or abs(value) > largest:
            bound = f"; at most {largest:g} is read" if largest < math.inf else ""
            raise self._error(element, f"{key}: {printable(word)} is too large{bound}", "check the unit", NumberError)
        return value
