"""Where a robot file and its SRDF use names of links, joints and groups, and whether these are there.

A name that is not there mostly has one cause, such as a joint that was renamed, and many uses. It is reported once
for the file, by the rule of the first one.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

from kinetostat.errors import quote, unknown_name
from kinetostat.lint.finding import Finding
from kinetostat.lint.grouping import FEW, listed
from kinetostat.lint.rule import Rule
from kinetostat.lint.subject import Subject, end_of, name_of
from kinetostat.urdf.document import Element

__all__ = ["Use", "robot_uses", "srdf_uses", "told"]

_LONG = 100  # letters: comparing longer names, or more of them, takes too long
_MANY = 2000
_SLIP = 4  # letters that a misspelt name is longer or shorter


@dataclass(frozen=True)
class Use:
    """A place that uses a name.

    Attributes:
        code: of the rule that looks there.
        kind: what the name is to be the name of: "link", "joint", "link or joint", "group".
        name: the name.
        at: the element.
        attribute: that holds the name.
    """

    code: str
    kind: str
    name: str
    at: Element
    attribute: str = "name"

    @property
    def what(self) -> str:
        """What a message calls it: base_link, not link, in a chain."""
        return self.attribute if self.attribute in ("base_link", "tip_link") else self.kind


# --- where names are used ------------------------------------------------------------------------------------------


def robot_uses(subject: Subject) -> Iterator[Use]:
    """Yield what extension blocks of a robot file refer to, in file order."""
    for block in subject.root.children:
        if block.tag == "gazebo" and block.attributes.get("reference"):
            yield Use("N302", "link or joint", block.attributes["reference"], block, "reference")
        elif block.tag in ("transmission", "ros2_control"):
            code = "N301" if block.tag == "transmission" else "N303"
            yield from (Use(code, "joint", name_of(joint), joint) for joint in block.all("joint") if name_of(joint))


def srdf_uses(root: Element) -> Iterator[Use]:
    """Yield what an SRDF refers to, in file order."""
    for element in root.children:
        if element.tag == "group":
            yield from _in_group(element)
        elif element.tag == "group_state":
            yield from _stated(element, "N321", group="group")
            yield from (Use("N322", "joint", name_of(joint), joint) for joint in element.all("joint"))
        elif element.tag == "end_effector":
            yield from _stated(element, "N315", parent_link="link", group="group", parent_group="group")
        elif element.tag == "passive_joint":
            yield Use("N316", "joint", name_of(element), element)
        elif element.tag == "joint_property":
            yield Use("N316", "joint", element.attributes.get("joint_name", ""), element, "joint_name")
        elif element.tag == "virtual_joint":
            yield Use("N316", "link", element.attributes.get("child_link", ""), element, "child_link")
        elif element.tag in ("disable_collisions", "enable_collisions"):
            yield from _stated(element, "N317", link1="link", link2="link")
        elif element.tag in ("disable_default_collisions", "link_sphere_approximation"):
            yield from _stated(element, "N317", link="link")


def _in_group(group: Element) -> Iterator[Use]:
    for part in group.children:
        if part.tag in ("link", "joint", "group"):
            yield Use("N314", part.tag, name_of(part), part)
        elif part.tag == "chain":
            for key in ("base_link", "tip_link"):
                yield Use("N314", "link", part.attributes.get(key, ""), part, key)


def _stated(element: Element, code: str, **kinds: str) -> Iterator[Use]:
    """Yield the attributes that are there; that one is missing is told otherwise."""
    for key, kind in kinds.items():
        if element.attributes.get(key):
            yield Use(code, kind, element.attributes[key], element, key)


# --- telling what is not there -------------------------------------------------------------------------------------


def told(
    rule: Rule,
    subject: Subject,
    lost: Collection[Use],
    known: Mapping[str, Collection[str]],
    *,
    where: str = "in the robot",
    file: str = "",
) -> Iterator[Finding]:
    """Yield the names that are not there and whose first use is a rule's; if they are many, one finding.

    Args:
        rule: whose findings are asked for.
        subject: the robot file.
        lost: all uses of names that are not there, those first that count first.
        known: the names that there are, by kind.
        where: where the names should be.
        file: the file of the elements, if it is not the robot's own.
    """
    names: dict[tuple[str, str], list[Use]] = {}
    for use in lost:
        names.setdefault((use.name, "" if use.name else use.code + use.what), []).append(use)
    if len(names) > FEW:
        first, *rest = lost
        if first.code == rule.code:
            kinds = " and ".join(dict.fromkeys(f"{word}s" for use in lost for word in use.kind.split(" or ")))
            message = f"{len(names)} names of {kinds} are not {where}: {listed([name for name, _ in names])}"
            yield rule.finding(
                first.at, message + _places("more", first, rest), attribute=first.attribute, file=file, several=True
            )
        return
    for first, *rest in names.values():
        if first.code == rule.code:
            other, hint = _other_kind(subject, first)
            message = (
                f"{first.what} {quote(first.name)} is not {where}{other}" if first.name else f"no {first.what} is named"
            )
            hint = hint or _nearest(first, known[first.kind]) or rule.hint
            yield rule.finding(
                first.at, message + _places("also used", first, rest), hint=hint, attribute=first.attribute, file=file
            )


def _places(what: str, first: Use, rest: Collection[Use]) -> str:
    """Return the other lines for the end of a message, and what is there; empty if there are none."""
    lines = [str(line) for line in dict.fromkeys(use.at.line for use in rest) if line != first.at.line]
    if not lines:
        return ""
    more = f" and {len(lines) - FEW} more" if len(lines) > FEW else ""
    return f"; {what} at line{'s' if len(lines) > 1 else ''} {', '.join(lines[:FEW])}{more}"


def _other_kind(subject: Subject, use: Use) -> tuple[str, str]:
    """Return that a name is that of a joint where a link is wanted, or the reverse, and the name that is wanted."""
    if use.kind == "link" and use.name in subject.joint_elements:
        child = end_of(subject.joint_elements[use.name], "child")
        return ": it is a joint", f"the link that it moves is {quote(child)}"
    if use.kind == "joint" and use.name in subject.link_elements:
        above = [name_of(joint) for joint in subject.joints if end_of(joint, "child") == use.name]
        return ": it is a link", f"the joint that leads to it is {quote(above[0])}" if above else ""
    return "", ""


def _nearest(use: Use, known: Collection[str]) -> str | None:
    """Return a hint at the names that are nearly the same."""
    if not use.name or len(use.name) > _LONG or len(known) > _MANY:
        return None
    lengths = range(len(use.name) - _SLIP, len(use.name) + _SLIP + 1)
    hint = unknown_name(use.what, use.name, [each for each in known if len(each) in lengths]).remedy
    return hint if hint and hint.startswith("did you mean") else None
