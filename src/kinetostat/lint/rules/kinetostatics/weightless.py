"""Links on which a file turns gravity off for Gazebo: their weight is balanced by what the file knows nothing of."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from kinetostat.engines.model import Model
from kinetostat.lint.bodies import bodies_of
from kinetostat.lint.subject import Subject
from kinetostat.urdf.canonical import canonical_text
from kinetostat.urdf.document import Document, Element
from kinetostat.urdf.loading import LoadedRobot

__all__ = ["weighed", "weightless"]

_OFF = {"turnGravityOff": ("true", "1", "yes"), "gravity": ("false", "0", "no")}
_ON = {"turnGravityOff": _OFF["gravity"], "gravity": _OFF["turnGravityOff"]}
_TEXT = re.compile(r"<[^<>]*>([^<]*)<")
_LINE_END = re.compile(r"\r\n|\r|\n")


def weighed(subject: Subject) -> Model:
    """Return the robot as a model in which the links that Gazebo lets float have no mass."""
    light = weightless(subject)
    if not light:
        return subject.model
    assert subject.document is not None
    loaded, root = subject.model.loaded, subject.document.root
    links = tuple(replace(link, inertial=None) if link.name in light else link for link in loaded.robot.links)
    robot = replace(loaded.robot, links=links)
    children = [_massless(child) if child.attributes.get("name") in light else child for child in root.children]
    document = Document(subject.document.file, replace(root, children=children), ())
    return Model(LoadedRobot(robot, canonical_text(document), loaded.source, loaded.packages, loaded.semantics), robot)


def weightless(subject: Subject) -> frozenset[str]:
    """Return the links without gravity: those that say so, and those fixed to one that does unless they say no."""
    said = dict(_said(subject))
    if not any(said.values()):
        return frozenset()
    head = bodies_of(subject).head
    return frozenset(link for link, top in head.items() if said.get(link, said.get(top, False)))


def _massless(element: Element) -> Element:
    if element.tag != "link":
        return element
    return replace(element, children=[child for child in element.children if child.tag != "inertial"])


def _said(subject: Subject) -> Iterator[tuple[str, bool]]:
    """Yield the links of which a Gazebo block says whether gravity is off; the last word counts."""
    lines: list[str] = []
    for block in subject.root.all("gazebo"):
        for element in block.children:
            if element.tag in _OFF:
                lines = lines or _lines(subject)
                word = (element.attributes.get("value") or _text(element, lines)).strip().lower()
                if word in _OFF[element.tag] or word in _ON[element.tag]:
                    yield block.attributes.get("reference", ""), word in _OFF[element.tag]


def _lines(subject: Subject) -> list[str]:
    assert subject.source is not None
    return _LINE_END.split(subject.source.data.decode("utf-8-sig", "replace"))


def _text(element: Element, lines: list[str]) -> str:
    """Return what stands between the tags of an element, which the document does not keep."""
    own = "\n".join(lines[element.line - 1 : element.last_line])
    found = _TEXT.match(own, element.column)
    return found[1] if found is not None else ""
