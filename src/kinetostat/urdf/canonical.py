"""The text that Pinocchio is handed: the file's own kinematic elements, without what Pinocchio alone would refuse.

The same links, joints, placements, axes, mimics and inertials, with the strings of the file; Pinocchio reads every
number from them by itself. What is left out or mended does not bear on a number:

- comments, processing instructions, visuals, collisions, materials and extension blocks (urdfdom dies on a processing
  instruction, on a material given twice, on elements nested more than 500 deep);
- white space in an attribute: urdfdom splits at single spaces only;
- limits, which urdfdom refuses when they are incomplete or infinite: each is replaced by an empty one;
- a missing robot name, and a version not of the form "1.0";
- Drake's screw joint, which urdfdom does not know: it is written as a revolute joint, its pitch in an element of its own.
"""

from __future__ import annotations

from xml.sax.saxutils import quoteattr

from kinetostat.urdf.document import Document, Element

__all__ = ["SCREW_PITCH", "canonical_text"]

SCREW_PITCH = "screw_thread_pitch"

_NAMES = frozenset({"name", "link", "joint", "type"})
_INERTIAL_PARTS = ("origin", "mass", "inertia")
_JOINT_PARTS = ("origin", "parent", "child", "axis", "mimic")


def canonical_text(document: Document) -> str:
    """Return the URDF text for Pinocchio of a document that the reader has accepted."""
    # quat_xyzw is only read by urdfdom when the file says that it is URDF 1.1 or later.
    version = ' version="1.1"' if document.root.attributes.get("version", "1.0").strip() not in ("1.0", "1") else ""
    name = quoteattr(document.root.attributes.get("name") or "robot")
    parts = [f"<robot name={name}{version}>"]
    for element in document.root.children:
        if element.tag == "link":
            parts += _link(element)
        elif element.tag in ("joint", "drake:joint"):
            parts += _joint(element)
    parts.append("</robot>")
    return "\n".join(parts)


def _link(element: Element) -> list[str]:
    lines = [f"<link name={quoteattr(element.attributes['name'])}>"]
    for inertial in element.all("inertial"):
        lines += ["<inertial>", *(_tag(c) for c in inertial.children if c.tag in _INERTIAL_PARTS), "</inertial>"]
    return [*lines, "</link>"]


def _joint(element: Element) -> list[str]:
    kind = element.attributes["type"]
    lines = [_tag(child) for child in element.children if child.tag in _JOINT_PARTS]
    if kind == "screw":
        kind = "revolute"
        pitch = element.all("drake:screw_thread_pitch")[0].attributes["value"]
        lines.append(f"<{SCREW_PITCH} value={quoteattr(pitch.strip())}/>")
    if kind in ("revolute", "prismatic"):
        lines.append('<limit effort="0" velocity="0"/>')
    return [f"<joint name={quoteattr(element.attributes['name'])} type={quoteattr(kind)}>", *lines, "</joint>"]


def _tag(element: Element) -> str:
    attributes = "".join(
        f" {key}={quoteattr(value if key in _NAMES else ' '.join(value.split()))}"
        for key, value in element.attributes.items()
        if ":" not in key
    )
    return f"<{element.tag}{attributes}/>"
