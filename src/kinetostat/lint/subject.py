"""What rules look at: a robot file as far as it can be read. Nothing here raises for a bad file."""

from __future__ import annotations

import functools
import math
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TypeVar

from kinetostat.engines.model import Model
from kinetostat.errors import KinetostatError
from kinetostat.urdf.canonical import canonical_text
from kinetostat.urdf.description import Robot
from kinetostat.urdf.document import Document, Element, parse
from kinetostat.urdf.files import MAX_BYTES, Source, open_source, read_file
from kinetostat.urdf.loading import LoadedRobot
from kinetostat.urdf.packages import Packages
from kinetostat.urdf.reader import read
from kinetostat.urdf.reading import as_number, words
from kinetostat.urdf.srdf import Semantics, find_srdf, read_srdf
from kinetostat.urdf.xacro import expand, is_xacro

__all__ = ["Subject", "end_of", "first", "name_of", "number", "once", "subject_of", "subject_of_loaded", "vector"]

_T = TypeVar("_T")
JOINT_TAGS = ("joint", "drake:joint")


@dataclass(frozen=True)
class Subject:
    """A robot file, as far as it can be read.

    Attributes:
        source: its name, path and bytes (of a xacro file: what it expands to); None if it cannot be opened.
        packages: where package:// and meshes lead.
        document: its XML; None if that does not parse.
        robot: its description; None if the reader refuses it.
        refusal: why the document or the robot is None; None if all is well.
        srdf: the XML of its SRDF; None without one, or if that does not parse.
        srdf_refusal: why the SRDF cannot be read; None if all is well.
        semantics: groups and states of the SRDF; empty without one.
        expanded: whether lines are those of an expanded xacro file.
    """

    name: str
    source: Source | None
    packages: Packages
    document: Document | None = None
    robot: Robot | None = None
    refusal: KinetostatError | None = None
    srdf: Document | None = None
    srdf_refusal: KinetostatError | None = None
    semantics: Semantics = field(default_factory=Semantics)
    expanded: bool = False

    # --- raw XML -----------------------------------------------------------------------------------------------

    @property
    def root(self) -> Element:
        """The root element."""
        assert self.document is not None
        return self.document.root

    def file_of(self, refusal: KinetostatError) -> str:
        """Return the file that a refusal is about, if it is another than the robot's: what a xacro file includes."""
        if self.source is None or self.source.path is None or not refusal.file or refusal.file == self.name:
            return ""
        return "" if refusal.file == str(self.source.path) else refusal.file

    @cached_property
    def elements(self) -> tuple[Element, ...]:
        """All elements, in file order."""
        found, stack = list[Element](), [self.root]
        while stack:
            element = stack.pop()
            found.append(element)
            stack.extend(reversed(element.children))
        return tuple(found)

    @cached_property
    def links(self) -> tuple[Element, ...]:
        """The `<link>` elements, in file order."""
        return tuple(self.root.all("link"))

    @cached_property
    def joints(self) -> tuple[Element, ...]:
        """The `<joint>` (and Drake's `<drake:joint>`) elements, in file order."""
        return tuple(child for child in self.root.children if child.tag in JOINT_TAGS)

    @cached_property
    def link_elements(self) -> Mapping[str, Element]:
        """The first `<link>` of each name."""
        return {e.attributes["name"]: e for e in reversed(self.links) if e.attributes.get("name")}

    @cached_property
    def joint_elements(self) -> Mapping[str, Element]:
        """The first `<joint>` of each name."""
        return {e.attributes["name"]: e for e in reversed(self.joints) if e.attributes.get("name")}

    @cached_property
    def joints_below(self) -> Mapping[str, Sequence[Element]]:
        """The joints that name a link as their parent."""
        below = defaultdict[str, list[Element]](list)
        for joint in self.joints:
            below[end_of(joint, "parent")].append(joint)
        return below

    # --- the robot as analyses know it -------------------------------------------------------------------------

    @cached_property
    def model(self) -> Model:
        """The robot with its engines, for rules that need the robot."""
        assert self.robot is not None
        assert self.document is not None
        assert self.source is not None
        loaded = LoadedRobot(self.robot, canonical_text(self.document), self.source, self.packages, self.semantics)
        return Model(loaded, self.robot)


def subject_of(
    name: str,
    *,
    srdf: Path | None = None,
    package_dirs: Sequence[Path] = (),
    xacro_arguments: Mapping[str, str] | None = None,
    max_bytes: int = MAX_BYTES,
) -> Subject:
    """Return a robot file as far as it can be read: what goes wrong is its `refusal`.

    Args:
        name: a path, `textbook:NAME` or `example:NAME`.
        srdf: the SRDF file; default, the one beside it.
        package_dirs: folders to look for packages in first.
        xacro_arguments: the arguments of a xacro file.
        max_bytes: refuse larger files.
    """
    folders = tuple(package_dirs)
    try:
        source = open_source(name, max_bytes=max_bytes)
    except KinetostatError as error:
        return Subject(name, None, Packages(None, folders), refusal=error)
    packages = Packages(source.path, folders)
    subject = Subject(name, source, packages)
    try:
        if source.path is not None and is_xacro(source.path):
            source = replace(source, data=expand(source.path, packages, xacro_arguments or {}, max_bytes))
            subject = replace(subject, source=source, expanded=True)
        subject = replace(subject, document=parse(source.data, name))
        assert subject.document is not None
        subject = replace(subject, robot=read(subject.document))
    except KinetostatError as error:
        return replace(subject, refusal=error)
    return _with_semantics(subject, srdf)


def subject_of_loaded(loaded: LoadedRobot) -> Subject:
    """Return what rules look at of a robot that has been read."""
    name, document = loaded.source.name, parse(loaded.source.data, loaded.source.name)
    subject = Subject(name, loaded.source, loaded.packages, document, loaded.robot, semantics=loaded.semantics)
    file = loaded.semantics.file
    if not file:
        return subject
    return replace(subject, srdf=parse(read_file(Path(file), file), file))


def _with_semantics(subject: Subject, srdf: Path | None) -> Subject:
    """Return the subject with its SRDF, if it has one."""
    assert subject.robot is not None
    assert subject.source is not None
    path = srdf or (find_srdf(subject.source.path, subject.robot.name) if subject.source.path else None)
    if path is None:
        return subject
    try:
        document = parse(read_file(path, str(path)), str(path))
    except KinetostatError as error:
        return replace(subject, srdf_refusal=error)
    robot, subject = subject.robot, replace(subject, srdf=document)
    try:
        return replace(subject, semantics=read_srdf(document, robot))
    except KinetostatError as error:
        return replace(subject, srdf_refusal=error)


def once(make: Callable[[Subject], _T]) -> Callable[[Subject], _T]:
    """Let what a function says of a subject be found once: it is kept with the subject, as its own properties are."""
    key = f"{make.__module__}.{make.__qualname__}"

    @functools.wraps(make)
    def kept(subject: Subject) -> _T:
        values = vars(subject)
        if key not in values:
            values[key] = make(subject)
        found: _T = values[key]
        return found

    return kept


# --- reading elements as far as they can be read ------------------------------------------------------------------


def first(element: Element | None, *tags: str) -> Element | None:
    """Return the first element down a path of tags, such as link, "inertial", "mass"; None if there is none."""
    for tag in tags:
        found = element.all(tag) if element is not None else []
        element = found[0] if found else None
    return element


def number(element: Element | None, key: str) -> float | None:
    """Return the finite number of an attribute; None if there is none (another rule tells what is wrong with it)."""
    if element is None or key not in element.attributes:
        return None
    value = as_number(element.attributes[key])
    return value if value is not None and math.isfinite(value) else None


def vector(element: Element | None, key: str, size: int) -> tuple[float, ...] | None:
    """Return the finite numbers of an attribute; None if there are not so many."""
    if element is None or key not in element.attributes:
        return None
    found = [as_number(word) for word in words(element.attributes[key])]
    finite = [value for value in found if value is not None and math.isfinite(value)]
    return tuple(finite) if len(finite) == len(found) == size else None


def name_of(element: Element) -> str:
    """Return the name of an element; empty without one."""
    return element.attributes.get("name", "")


def end_of(joint: Element, end: str) -> str:
    """Return the link that a joint names as its "parent" or "child"; empty without one."""
    found = first(joint, end)
    return found.attributes.get("link", "") if found is not None else ""
