"""What a xacro file holds and a URDF must not: tags and expressions that nobody has expanded."""

from __future__ import annotations

import re

from kinetostat.lint.subject import Subject
from kinetostat.urdf.document import Element

__all__ = ["has_expression", "unexpanded_tags"]

_EXPRESSION = re.compile(r"\$[({]")
# xacro's tags before ROS Jade, without a prefix, by the attributes that they must have.
_OLD_TAGS = {"include": {"filename"}, "macro": {"name", "params"}, "property": {"name", "value"}}


def has_expression(text: str) -> bool:
    """Return whether a value holds `${...}` or `$(...)`."""
    return "$" in text and _EXPRESSION.search(text) is not None


def unexpanded_tags(subject: Subject) -> list[Element]:
    """Return the xacro tags of a file, in file order; first those right inside its root, which hide whole robots."""
    top = [child for child in subject.root.children if _is_xacro(child, top=True)]
    if top:
        return top
    return [element for element in subject.elements if _is_xacro(element, top=False)]


def _is_xacro(element: Element, *, top: bool) -> bool:
    return element.tag.startswith("xacro:") or (
        top and element.tag in _OLD_TAGS and _OLD_TAGS[element.tag] <= element.attributes.keys()
    )
