"""SRDF: named groups and named states of a robot."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field
from pathlib import Path

from kinetostat.errors import AmbiguousNameError, NumberError, StructureError, quote, unknown_name
from kinetostat.urdf.description import Robot
from kinetostat.urdf.document import Document, Element, parse
from kinetostat.urdf.files import read_file

__all__ = ["GroupState", "Semantics", "find_srdf", "load_srdf", "read_srdf"]


@dataclass(frozen=True)
class GroupState:
    """A named configuration of a group: joint positions in rad, m, or the several numbers of a floating joint."""

    name: str
    group: str
    positions: dict[str, tuple[float, ...]]


@dataclass(frozen=True)
class Semantics:
    """What an SRDF says: groups (the joints of each) and states."""

    file: str = ""
    groups: dict[str, tuple[str, ...]] = field(default_factory=dict)
    states: tuple[GroupState, ...] = ()

    def state_names(self) -> list[str]:
        """Return the names of states, each once."""
        return list(dict.fromkeys(state.name for state in self.states))

    def state(self, name: str) -> dict[str, tuple[float, ...]]:
        """Return the joint positions of a state, `NAME` or `GROUP/NAME`. Groups that share a state name are joined.

        Raises:
            UnknownNameError: there is no such state.
            AmbiguousNameError: two groups give the same joint different positions under that name.
        """
        found = [s for s in self.states if name in (s.name, f"{s.group}/{s.name}")]
        if not found:
            raise unknown_name("group state", name, self.state_names())
        joined: dict[str, tuple[float, ...]] = {}
        for state in found:
            for joint, values in state.positions.items():
                if joined.setdefault(joint, values) != values:
                    choices = " or ".join(quote(f"{s.group}/{s.name}") for s in found)
                    raise AmbiguousNameError(
                        f"groups disagree on joint {quote(joint)} in state {quote(name)}", remedy=f"use {choices}"
                    )
        return joined


def find_srdf(path: Path, robot_name: str) -> Path | None:
    """Return the SRDF that belongs to a robot file: of its stem or of the robot's name, beside it or in `../srdf`."""
    stem = path.name.removesuffix(".xacro").removesuffix(".urdf")
    for name in (stem, robot_name):
        if not name or "/" in name or "\0" in name or len(name) > 100:
            continue
        for folder in (path.parent, path.parent.parent / "srdf"):
            candidate = folder / f"{name}.srdf"
            # A link that leads nowhere, or a FIFO, was meant to be one: whoever reads it says what is wrong with it.
            if os.path.lexists(candidate) and not candidate.is_dir():
                return candidate
    return None


def load_srdf(path: Path, robot: Robot) -> Semantics:
    """Read an SRDF file for a robot.

    Raises:
        RobotError: it cannot be read, or is not an SRDF.
    """
    shown = str(path)
    return read_srdf(parse(read_file(path, shown), shown), robot)


def read_srdf(document: Document, robot: Robot) -> Semantics:
    """Return the groups and states of an SRDF document.

    Raises:
        StructureError: the root element is not robot, or a state has no name.
        NumberError: a joint value does not parse.
    """
    root = document.root
    if root.tag != "robot":
        raise StructureError("an SRDF has <robot> as its root element", file=document.file, line=root.line)
    if root.all("link") and not root.all("group") and not root.all("group_state"):
        raise StructureError("this is a robot, not an SRDF", file=document.file, line=root.line)
    states = []
    for element in root.all("group_state"):
        if not element.attributes.get("name"):
            raise StructureError("a group_state without a name", file=document.file, line=element.line)
        positions = {
            joint.attributes["name"]: _values(joint, document.file)
            for joint in element.all("joint")
            if "name" in joint.attributes and "value" in joint.attributes
        }
        states.append(GroupState(element.attributes["name"], element.attributes.get("group", ""), positions))
    return Semantics(document.file, _groups(root, robot), tuple(states))


def _values(joint: Element, file: str) -> tuple[float, ...]:
    text = joint.attributes["value"]
    try:
        values = tuple(float(word) for word in text.split())
    except ValueError:
        values = ()
    if not values or not all(math.isfinite(v) for v in values):
        raise NumberError(
            f"value {quote(text)} is not a finite number", file=file, line=joint.line, element=joint.label()
        )
    return values


def _groups(root: Element, robot: Robot) -> dict[str, tuple[str, ...]]:
    """Return the joints of each group: those named, those of chains, those above named links, those of subgroups."""
    elements = {e.attributes["name"]: e for e in root.all("group") if e.attributes.get("name")}
    groups: dict[str, tuple[str, ...]] = {}
    for name in elements:
        joints: dict[str, None] = {}
        waiting, seen = [name], set[str]()
        while waiting:
            group = waiting.pop()
            if group in seen or group not in elements:
                continue
            seen.add(group)
            for part in elements[group].children:
                joints.update(dict.fromkeys(_joints_of(part, robot)))
                if part.tag == "group":
                    waiting.append(part.attributes.get("name", ""))
        groups[name] = tuple(joints)
    return groups


def _joints_of(part: Element, robot: Robot) -> list[str]:
    name = part.attributes.get("name", "")
    if part.tag == "joint":
        return [name] if name in robot.joint_by_name else []
    if part.tag == "link":
        return [robot.parent_joint[name].name] if name in robot.parent_joint else []
    if part.tag == "chain":
        ends = part.attributes.get("base_link", ""), part.attributes.get("tip_link", "")
        if all(end in robot.link_by_name for end in ends):
            return [joint.name for joint, _ in robot.path(*ends)]
    return []
