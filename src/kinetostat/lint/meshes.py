"""The meshes and textures that a robot file names: each name is looked up once, and its first bytes are read.

Robot files are untrusted: only regular files inside the package are opened, and no more than their beginning is read.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from kinetostat.lint.headers import HEAD, Fault, fault_of
from kinetostat.lint.subject import Subject, once
from kinetostat.urdf.document import Element
from kinetostat.urdf.packages import Packages, Reason, other_case

__all__ = ["MANY", "NamedFile", "last_name", "named_files", "scaled_meshes"]

MANY = 1000  # different names that are looked for
_SEARCHES = 100  # missing names of which folders are searched for another case


@dataclass(frozen=True)
class NamedFile:
    """A file that the robot file names.

    Attributes:
        name: as it is written there.
        uses: the elements that name it, in file order; at least one.
        found: where it is, or why it leads nowhere; None if it was not looked for (there are too many names).
        twin: a file whose name differs by upper and lower case only, if it is missing.
        in_package: whether a package.xml says which package the robot file is in.
        expanded: whether xacro wrote the name.
        fault: what its first bytes say is wrong with it; None if nothing, or if it is not there.
    """

    name: str
    uses: tuple[Element, ...]
    found: Path | Reason | None
    twin: Path | None = None
    in_package: bool = False
    expanded: bool = False
    fault: Fault | None = None

    @property
    def first(self) -> Element:
        """The first element that names it."""
        return self.uses[0]

    @property
    def extension(self) -> str:
        """The end of its name, in lower case and without the dot; empty without one."""
        last = last_name(self.name)
        return last.rpartition(".")[2].lower() if "." in last else ""

    @property
    def is_texture(self) -> bool:
        """Whether it is named as a picture, not as a mesh."""
        return self.first.tag == "texture"


def last_name(name: str) -> str:
    """Return the name of a file without its folders."""
    return name.replace("\\", "/").rpartition("/")[2]


@once
def named_files(subject: Subject) -> Mapping[str, NamedFile]:
    """Return the files that a robot file names, by name, in file order. They are looked up once for each subject."""
    uses: dict[str, list[Element]] = {}
    for element in _naming(subject):
        uses.setdefault(element.attributes["filename"], []).append(element)
    packages = _Remembering(subject.packages.file, subject.packages.folders)
    files = dict[str, NamedFile]()
    searches = 0
    for i, (name, elements) in enumerate(uses.items()):
        found = packages.resolve(name) if i < MANY else None
        fault = _fault(found, elements[0]) if isinstance(found, Path) else None
        twin = None
        if found is Reason.MISSING and searches < _SEARCHES:
            searches += 1
            place = packages.place(name)
            twin = None if isinstance(place, Reason) else other_case(*place)
        files[name] = NamedFile(name, tuple(elements), found, twin, packages.has_manifest(), subject.expanded, fault)
    return files


class _Remembering(Packages):
    """Packages that look for each folder once: a robot names the same few in every mesh."""

    @cached_property
    def _known(self) -> dict[str, Path | None]:
        return {}

    @cached_property
    def _real(self) -> dict[Path, Path]:
        return {}

    @cached_property
    def _home(self) -> Path:
        return super().home()

    @cached_property
    def _manifest(self) -> bool:
        return super().has_manifest()

    def find(self, package: str) -> Path | None:
        """Return the folder of a package, or None."""
        if package not in self._known:
            self._known[package] = super().find(package)
        return self._known[package]

    def real(self, folder: Path) -> Path:
        """Return where a folder really is, links followed."""
        if folder not in self._real:
            self._real[folder] = super().real(folder)
        return self._real[folder]

    def home(self) -> Path:
        """Return the package that the file is in, or its folder."""
        return self._home

    def has_manifest(self) -> bool:
        """Return whether a package.xml says which package the file is in."""
        return self._manifest


def _naming(subject: Subject) -> Iterator[Element]:
    """Yield the elements that name a file, in file order. An empty name says that there is none."""
    for top in subject.root.children:
        if top.tag == "link":
            for shape in top.children:
                if shape.tag in ("visual", "collision"):
                    yield from (part for inner in shape.children for part in _parts(inner))
        else:
            yield from _parts(top)


def _parts(element: Element) -> Iterator[Element]:
    """Yield what names a file in a geometry or a material."""
    wanted = {"geometry": "mesh", "material": "texture"}.get(element.tag, "")
    yield from (part for part in element.children if part.tag == wanted and part.attributes.get("filename"))


def scaled_meshes(subject: Subject) -> Iterator[tuple[Element, Element, str]]:
    """Yield the meshes with what holds them: the link, the mesh, and "visual" or "collision"."""
    for link in subject.links:
        for shape in link.children:
            if shape.tag in ("visual", "collision"):
                for geometry in shape.all("geometry"):
                    for mesh in geometry.all("mesh"):
                        yield link, mesh, shape.tag


def _fault(path: Path, element: Element) -> Fault | None:
    """Return what is wrong with a file by its size and its beginning."""
    try:
        # O_NONBLOCK: should the file have become a FIFO since it was looked up, opening it does not wait for a writer.
        with os.fdopen(os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0)), "rb") as file:
            status = os.fstat(file.fileno())
            if not stat.S_ISREG(status.st_mode):
                return Fault.unreadable("it is not a regular file")
            head = file.read(HEAD)
    except OSError as error:
        return Fault.unreadable(f"it cannot be read: {error.strerror or 'an error of the system'}")
    return fault_of(head, status.st_size, path.suffix.lower().removeprefix("."), texture=element.tag == "texture")
