"""What a xacro file holds and a URDF must not: tags and expressions that nobody has expanded."""

from __future__ import annotations

import re

from kinetostat.lint.subject import Subject
from kinetostat.urdf.document import Element

__all__ = ["has_expression", "is_old_tag", "top_tags", "unexpanded_tags"]

_EXPRESSION = re.compile(r"\$\{|\$\((?:anon|arg|cwd|dirname|env|eval|find|optenv)\b")
# xacro's tags before ROS Jade, without a prefix, by the attributes that they must have.
_OLD_TAGS = {"include": {"filename"}, "macro": {"name", "params"}, "property": {"name", "value"}}


def has_expression(text: str) -> bool:
    """Return whether a value holds `${...}` or `$(...)`."""
    return "$" in text and _EXPRESSION.search(text) is not None


def top_tags(subject: Subject) -> list[Element]:
    """Return the xacro tags right inside the root: what they stand for, whole robots perhaps, is not in the file."""
    return [child for child in subject.root.children if child.tag.startswith("xacro:") or is_old_tag(child)]


def unexpanded_tags(subject: Subject) -> list[Element]:
    """Return the xacro tags right inside the root; if there are none, those further down; in file order."""
    return top_tags(subject) or [element for element in subject.elements if element.tag.startswith("xacro:")]


def is_old_tag(element: Element) -> bool:
    """Return whether an element right inside the root is one of xacro's tags without a prefix."""
    needed = _OLD_TAGS.get(element.tag)
    return needed is not None and needed <= element.attributes.keys()
