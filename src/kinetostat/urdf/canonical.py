"""The text that Pinocchio is handed: the file's own kinematic elements, without what Pinocchio alone would refuse.

The same links, joints, placements, axes, mimics and inertials, with the strings of the file; Pinocchio reads every
number from them by itself. What is left out or mended does not bear on a number:

- comments, processing instructions, visuals, collisions, materials and extension blocks (urdfdom dies on a processing
  instruction, on a material given twice, on elements nested more than 500 deep);
- white space in an attribute: urdfdom splits at single spaces only;
- an inertial that lacks its mass or a moment, which the reader does not count;
- limits, which urdfdom refuses when they are incomplete or infinite: each is replaced by an empty one;
- the axis of a joint that has none (fixed, floating);
- the name `universe` of a fixed joint, for which Pinocchio drops the mass of its child;
- a missing robot name, and a version not of the form "1.0";
- Drake's screw joint, which urdfdom does not know: it is written as a revolute joint with its pitch inside.
"""

from __future__ import annotations

from xml.etree import ElementTree as ET

from kinetostat.urdf.document import Document, Element

__all__ = ["SCREW_PITCH", "canonical_text"]

SCREW_PITCH = "screw_thread_pitch"

_NAMES = frozenset({"name", "link", "joint", "type"})
_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_INERTIAL_PARTS = ("origin", "mass", "inertia")
_PLACED = ("origin", "parent", "child")
_MOVED = (*_PLACED, "axis", "mimic")


def canonical_text(document: Document) -> str:
    """Return the URDF text for Pinocchio of a document that the reader has accepted."""
    robot = ET.Element("robot", name=document.root.attributes.get("name") or "robot")
    # quat_xyzw is only read by urdfdom when the file says that it is URDF 1.1 or later.
    if document.root.attributes.get("version", "1.0").strip() not in ("1.0", "1"):
        robot.set("version", "1.1")
    for element in document.root.children:
        if element.tag == "link":
            _add_link(robot, element)
        elif element.tag in ("joint", "drake:joint"):
            _add_joint(robot, element)
    return ET.tostring(robot, encoding="unicode")


def _add_link(robot: ET.Element, element: Element) -> None:
    link = ET.SubElement(robot, "link", name=element.attributes["name"])
    for inertial in element.all("inertial")[:1]:
        if _complete(inertial):
            _copy(ET.SubElement(link, "inertial"), inertial, _INERTIAL_PARTS)


def _complete(inertial: Element) -> bool:
    mass, inertia = (inertial.all(part)[:1] for part in ("mass", "inertia"))
    return (
        bool(mass and inertia)
        and "value" in mass[0].attributes
        and all(moment in inertia[0].attributes for moment in _MOMENTS)
    )


def _add_joint(robot: ET.Element, element: Element) -> None:
    kind = element.attributes["type"]
    name = element.attributes["name"]
    if kind == "fixed" and name == "universe":
        name = "universe_joint"
    joint = ET.SubElement(robot, "joint", name=name, type="revolute" if kind == "screw" else kind)
    _copy(joint, element, _PLACED if kind in ("fixed", "floating") else _MOVED)
    if kind == "screw":
        pitch = element.all("drake:screw_thread_pitch")[0].attributes["value"]
        ET.SubElement(joint, SCREW_PITCH, value=pitch.strip())
    if kind in ("revolute", "prismatic", "screw"):
        ET.SubElement(joint, "limit", effort="0", velocity="0")


def _copy(target: ET.Element, element: Element, parts: tuple[str, ...]) -> None:
    for child in element.children:
        if child.tag in parts:
            attributes = {
                key: value if key in _NAMES else " ".join(value.split())
                for key, value in child.attributes.items()
                if ":" not in key
            }
            ET.SubElement(target, child.tag, attributes)
