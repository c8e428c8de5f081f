"""A document to a description: one tree of uniquely named links and joints, every number finite.

What would make a number wrong is an error; what the reader assumes, ignores or mends is a remark.
"""

from __future__ import annotations

import math
import re

from kinetostat.errors import LimitError, NumberError, StructureError, cut, quote
from kinetostat.urdf.description import (
    MASSLESS,
    Inertial,
    Joint,
    JointType,
    Limit,
    Link,
    Mesh,
    Mimic,
    Origin,
    Robot,
    Vector,
)
from kinetostat.urdf.document import Document, Element
from kinetostat.urdf.reading import Reading
from kinetostat.urdf.tree import root_of, with_leaders

__all__ = ["read"]

MAX_LINKS = 20_000
MAX_DOF = 300
MAX_NAME = 20_000
MAX_LENGTH = 1e12  # metres: beyond it double precision leaves less than a millimetre
MAX_MASS = 1e15
MAX_INERTIA = 1e30
MAX_ANGLE = 1e6  # radians: an rpy angle beyond it has lost its meaning
MAX_MULTIPLIER = 1e6
SMALLEST_AXIS = 1e-9

_INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_SMALLER = "leave out what you do not ask for"


def read(document: Document) -> Robot:
    """Return the robot that a document describes.

    Raises:
        StructureError: not one tree of uniquely named links and joints.
        NumberError: a number does not parse, is not finite, or a vector has the wrong length.
        LimitError: more than 20,000 links, 400 links deep, or 300 degrees of freedom.
    """
    reading, root = Reading(document), document.root
    if root.tag != "robot":
        remedy = "convert it to URDF first" if root.tag == "sdf" else "a URDF has <robot> as its root element"
        raise reading.error(root, f"the root element is <{cut(root.tag)}>, not <robot>", remedy)
    version = _version(reading, root)
    name = root.attributes.get("name", "")
    if not name:
        reading.remark(root, "the robot has no name")
    for child in root.children:
        if child.tag.startswith("xacro:"):
            raise reading.error(child, "xacro that is not expanded", "name the file .xacro, or run xacro on it first")
    links = _links(reading, root, version)
    joints = _joints(reading, root, version, {link.name for link in links})
    top = root_of(reading, links, joints)
    joints = with_leaders(reading, joints)
    remarks = tuple(sorted(reading.remarks, key=lambda remark: remark.line))
    robot = Robot(name, tuple(links), tuple(joints), top, remarks)
    movable = sum(joint.type.nv for joint in robot.joints)  # followers too: Pinocchio has them as joints of their own
    if movable > MAX_DOF:
        message = f"the joints have {movable} degrees of freedom; at most {MAX_DOF} are read"
        raise reading.error(root, message, _SMALLER, LimitError)
    return robot


def _version(reading: Reading, root: Element) -> tuple[int, int]:
    text = root.attributes.get("version")
    if text is None:
        return 1, 0
    match = re.fullmatch(r"\s*([0-9]{1,3})(?:\.([0-9]{1,3}))?\s*", text)
    if match is None:
        raise reading.error(root, f"version {quote(text)} is not a version", 'write version="1.0", or nothing')
    version = int(match[1]), int(match[2] or 0)
    if match[2] is None:
        reading.remark(root, f"version {quote(text)} is not of the form 1.0: other parsers refuse it")
    elif version > (1, 0):
        reading.remark(root, f"version {quote(text)}: parsers older than urdfdom 5 refuse it")
    return version


def _name(reading: Reading, element: Element, seen: dict[str, int]) -> str:
    name = element.attributes.get("name")
    if not name:
        raise reading.error(element, f"a {cut(element.tag)} without a name", "give it a name")
    if len(name) > MAX_NAME:
        message = f"a name of {len(name)} characters; at most {MAX_NAME} are read"
        raise reading.error(element, message, "shorten it", LimitError)
    # A line break or a tab may stand in a name; a control character (a terminal escape) may not.
    if any(ord(c) in range(0x7F, 0xA0) or (ord(c) < 32 and c not in "\t\r\n") for c in name):
        raise reading.error(element, "the name holds a control character", "rename it")
    if name in seen:
        raise reading.error(element, f"the name is already used at line {seen[name]}", "names must be unique")
    seen[name] = element.line
    return name


# --- links -------------------------------------------------------------------------------------------------------


def _links(reading: Reading, root: Element, version: tuple[int, int]) -> list[Link]:
    elements = root.all("link")
    if not elements:
        raise reading.error(root, "the robot has no link", "is this the file that you mean?")
    if len(elements) > MAX_LINKS:
        message = f"the robot has {len(elements)} links; at most {MAX_LINKS} are read"
        raise reading.error(root, message, _SMALLER, LimitError)
    seen: dict[str, int] = {}
    return [
        Link(_name(reading, element, seen), element.line, _inertial(reading, element, version), _meshes(element))
        for element in elements
    ]


def _meshes(link: Element) -> tuple[Mesh, ...]:
    return tuple(
        Mesh(mesh.attributes["filename"], mesh.line)
        for kind in ("visual", "collision")
        for shape in link.all(kind)
        for geometry in shape.all("geometry")
        for mesh in geometry.all("mesh")
        if "filename" in mesh.attributes
    )


def _inertial(reading: Reading, link: Element, version: tuple[int, int]) -> Inertial | None:
    element = reading.single(link, "inertial")
    if element is None:
        return None
    origin = _origin(reading, element, version)
    mass, inertia = reading.single(element, "mass"), reading.single(element, "inertia")
    found: list[float] = []
    missing: list[str] = []
    for part, keys, largest in ((mass, ("value",), MAX_MASS), (inertia, _INERTIA, MAX_INERTIA)):
        for key in keys:
            if part is not None and key in part.attributes:
                found.append(reading.number(part, key, largest))
            else:
                missing.append("mass value" if key == "value" else key)
    if missing:
        reading.remark(link, f"the inertial has no {', '.join(missing)}: {MASSLESS}")
        return None
    kilograms, ixx, ixy, ixz, iyy, iyz, izz = found
    return Inertial(kilograms, origin, (ixx, ixy, ixz, iyy, iyz, izz))


# --- joints ------------------------------------------------------------------------------------------------------


def _joints(reading: Reading, root: Element, version: tuple[int, int], links: set[str]) -> list[Joint]:
    seen: dict[str, int] = {}
    return [
        _joint(reading, child, version, seen, links) for child in root.children if child.tag in ("joint", "drake:joint")
    ]


def _joint(
    reading: Reading, element: Element, version: tuple[int, int], seen: dict[str, int], links: set[str]
) -> Joint:
    name = _name(reading, element, seen)
    kind = _type(reading, element)
    parent, child = (_end(reading, element, end, links) for end in ("parent", "child"))
    _check_dynamics(reading, element)
    return Joint(
        name,
        kind,
        parent,
        child,
        element.line,
        origin=_origin(reading, element, version),
        axis=_axis(reading, element, kind),
        limit=_limit(reading, element, kind),
        mimic=_mimic(reading, element, kind),
        pitch=_pitch(reading, element) if kind is JointType.SCREW else 0.0,
    )


def _type(reading: Reading, element: Element) -> JointType:
    text = element.attributes.get("type")
    if text is None:
        raise reading.error(element, "a joint without a type", 'write type="revolute" or another type')
    drake = element.tag == "drake:joint"
    known = ("screw", "planar") if drake else tuple(t.value for t in JointType if t is not JointType.SCREW)
    if text in known:
        return JointType(text)
    if text == "screw":
        raise reading.error(element, "type 'screw' belongs to Drake's dialect", 'write <drake:joint type="screw">')
    raise reading.error(element, f"joint type {quote(text)} is not known", f"use one of {', '.join(known)}")


def _end(reading: Reading, element: Element, end: str, links: set[str]) -> str:
    found = reading.single(element, end)
    if found is None or "link" not in found.attributes:
        raise reading.error(found or element, f"no {end} link", f'write <{end} link="..."/>')
    link = found.attributes["link"]
    if link not in links:
        message = f"{end} link {quote(link)} does not exist"
        raise reading.error(element, message, "add the link, or correct the name")
    return link


def _check_dynamics(reading: Reading, element: Element) -> None:
    dynamics = reading.single(element, "dynamics")
    if dynamics is not None:
        for key in ("damping", "friction"):
            if key in dynamics.attributes:
                reading.number(dynamics, key)


def _axis(reading: Reading, element: Element, kind: JointType) -> Vector:
    if kind in (JointType.FIXED, JointType.FLOATING):
        return (1.0, 0.0, 0.0)
    found = reading.single(element, "axis")
    if found is None:
        reading.remark(element, "no axis: URDF's default 1 0 0 holds")
        return (1.0, 0.0, 0.0)
    x, y, z = reading.vector(found, "xyz", 3, MAX_LENGTH)
    norm = math.hypot(x, y, z)
    if norm < SMALLEST_AXIS:
        raise reading.error(found, "the axis is zero: it has no direction", "write 0 0 1, or another", NumberError)
    if abs(norm - 1) > 1e-3:
        reading.remark(element, f"the axis has length {norm:.6g}: its direction counts, not its length")
    if kind is JointType.PLANAR and (x, y) != (0.0, 0.0):
        text = "a planar joint whose normal is not z: Pinocchio alone, like many tools, ignores the axis"
        reading.remark(element, text)
    return (x / norm, y / norm, z / norm)


def _limit(reading: Reading, element: Element, kind: JointType) -> Limit:
    bounded = kind in (JointType.REVOLUTE, JointType.PRISMATIC)
    found = reading.single(element, "limit")
    if found is None:
        if bounded:
            reading.remark(element, "no limit: its range, effort and velocity count as unlimited")
        return Limit()
    values = {
        key: reading.number(found, key, infinite=True)
        for key in ("lower", "upper", "effort", "velocity")
        if key in found.attributes
    }
    for key in ("effort", "velocity"):
        if key not in values and bounded:
            reading.remark(element, f"the limit has no {key}: it counts as not stated")
        elif values.get(key, 0.0) < 0:
            reading.remark(element, f"the {key} limit {values[key]:g} is negative")
    # A screw may be limited or not; continuous, planar and floating joints have no range.
    if not bounded and not (kind is JointType.SCREW and {"lower", "upper"} & set(values)):
        return Limit(effort=values.get("effort"), velocity=values.get("velocity"))
    for key in ("lower", "upper"):
        if key not in values:
            reading.remark(element, f"the limit has no {key}: URDF's default 0 holds")
    lower, upper = values.get("lower", 0.0), values.get("upper", 0.0)
    _remark_range(reading, element, kind, lower, upper)
    return Limit(lower, upper, values.get("effort"), values.get("velocity"))


def _remark_range(reading: Reading, element: Element, kind: JointType, lower: float, upper: float) -> None:
    if math.isinf(lower) and lower == upper:
        raise reading.error(element, f"lower and upper are both {lower:g}", "write finite limits", NumberError)
    if math.isinf(lower) or math.isinf(upper):
        reading.remark(element, "an infinite limit: other parsers refuse the file")
    if lower > upper:
        reading.remark(element, f"lower {lower:g} is above upper {upper:g}: they are read the other way round")
    elif lower == upper:
        reading.remark(element, f"lower and upper are both {lower:g}: the joint cannot move")
    elif kind is JointType.REVOLUTE and 4 * math.pi + 1e-3 < upper - lower < math.inf:
        reading.remark(element, f"a range of {upper - lower:.4g} rad, more than two turns: are these degrees?")


def _mimic(reading: Reading, element: Element, kind: JointType) -> Mimic | None:
    found = reading.single(element, "mimic")
    if found is None:
        return None
    if "joint" not in found.attributes:
        raise reading.error(element, "a mimic that names no joint", 'write <mimic joint="..."/>')
    multiplier = reading.number(found, "multiplier", MAX_MULTIPLIER) if "multiplier" in found.attributes else 1.0
    offset = reading.number(found, "offset", MAX_LENGTH) if "offset" in found.attributes else 0.0
    if kind is JointType.FIXED:
        reading.remark(element, "a mimic on a fixed joint has no effect")
        return None
    if kind in (JointType.FLOATING, JointType.PLANAR):
        raise reading.error(element, f"a {kind} joint cannot follow another", "remove its <mimic>")
    if multiplier == 0:
        reading.remark(element, "mimic multiplier 0: the joint never moves")
    return Mimic(found.attributes["joint"], multiplier, offset)


def _pitch(reading: Reading, element: Element) -> float:
    found = reading.single(element, "drake:screw_thread_pitch")
    if found is None or "value" not in found.attributes:
        remedy = 'write <drake:screw_thread_pitch value="0.01"/>, in metres per turn'
        raise reading.error(element, "a screw joint without a pitch", remedy)
    return reading.number(found, "value", MAX_LENGTH)


# --- placements --------------------------------------------------------------------------------------------------


def _origin(reading: Reading, element: Element, version: tuple[int, int]) -> Origin:
    found = reading.single(element, "origin")
    if found is None:
        return Origin()
    x, y, z = reading.vector(found, "xyz", 3, MAX_LENGTH) if "xyz" in found.attributes else (0.0, 0.0, 0.0)
    if "quat_xyzw" in found.attributes:
        return Origin((x, y, z), quaternion_xyzw=_quaternion(reading, found, version))
    roll, pitch, yaw = reading.vector(found, "rpy", 3, MAX_ANGLE) if "rpy" in found.attributes else (0.0, 0.0, 0.0)
    if max(abs(roll), abs(pitch), abs(yaw)) > 2 * math.pi + 1e-3:
        reading.remark(element, "an rpy angle beyond a full turn: are these degrees?")
    return Origin((x, y, z), (roll, pitch, yaw))


def _quaternion(reading: Reading, element: Element, version: tuple[int, int]) -> tuple[float, float, float, float]:
    if version < (1, 1):
        remedy = 'write <robot version="1.1">, or use rpy'
        raise reading.error(element, "quat_xyzw is part of URDF 1.1", remedy)
    if "rpy" in element.attributes:
        raise reading.error(element, "both rpy and quat_xyzw are given", "keep one of them", StructureError)
    x, y, z, w = reading.vector(element, "quat_xyzw", 4, MAX_LENGTH)
    norm = math.hypot(x, y, z, w)
    if norm < SMALLEST_AXIS:
        raise reading.error(element, "the quaternion is zero", "write 0 0 0 1, or another", NumberError)
    if abs(norm - 1) > 1e-3:
        reading.remark(element, f"the quaternion has length {norm:.6g}: it is normalised")
    return (x / norm, y / norm, z / norm, w / norm)
