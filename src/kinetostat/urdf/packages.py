"""Where `package://` and mesh names lead. A path is resolved, or refused with a reason; only package.xml is opened.

Robot files are untrusted: a mesh may not lie outside the package of the file that names it (`..`, absolute paths,
`file://`, symbolic links that lead out). Meshes are never needed for a number.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from kinetostat.errors import KinetostatError
from kinetostat.urdf.document import parse
from kinetostat.urdf.files import read_file

__all__ = ["Packages", "Reason", "other_case"]

_MANY = 64  # ancestors to walk up, at most
_LARGEST_MANIFEST = 256 * 1024  # bytes of a package.xml; common ones have 2,000
_MANY_FOLDERS = 1000  # folders of a --package-dir that are asked for their package.xml
_SYSTEM_DEPTH = 3  # /home/someone has three parts: so high up, a folder is a package only if it says so


class Reason(StrEnum):
    """Why the name of a mesh leads nowhere; the text is for a reader."""

    NUL = "the name holds a NUL character"
    PACKAGE = "the package is not found"
    SCHEME = "only package:// and relative names are followed"
    ABSOLUTE = "an absolute path"
    NO_FOLDER = "standard input has no folder to look in"
    OUTSIDE = "the path leads out of the package"
    MISSING = "there is no such file"
    UNFOLLOWED = "the path cannot be followed"


@dataclass(frozen=True)
class Packages:
    """Finds packages for one robot file.

    Searched in order: the folders of `--package-dir` (each may be a package or hold packages), the ancestors of the
    file and the folders in them that hold a package.xml, ROS_PACKAGE_PATH, AMENT_PREFIX_PATH. An ancestor without its
    package.xml counts by its name, unless it is as high up as a home folder: `package://etc` is no package.

    A package is called what its package.xml says: a clone is often named otherwise. The name of the folder counts, too.
    """

    file: Path | None
    folders: Sequence[Path] = ()
    _names: dict[Path, str] = field(default_factory=dict, init=False, repr=False, compare=False)

    def find(self, package: str) -> Path | None:
        """Return the folder of a package, or None."""
        if not package or package in (".", "..") or "/" in package or "\\" in package or "\0" in package:
            return None
        return next(self._found(package), None)

    def _found(self, package: str) -> Iterator[Path]:
        """Yield the folders that a package's name stands for, in the order of the search."""
        yield from self._among(self.folders, package)
        for folder in self._ancestors():
            if self._is_called(folder, package):
                yield folder
            if folder.name == package and (_is_package(folder) or len(folder.parts) > _SYSTEM_DEPTH):
                yield folder
            if _is_package(folder / package):
                yield folder / package
        for variable, below in (("ROS_PACKAGE_PATH", ""), ("AMENT_PREFIX_PATH", "share")):
            entries = [Path(entry) / below for entry in os.environ.get(variable, "").split(os.pathsep) if entry]
            yield from self._among(entries, package)

    def _among(self, folders: Sequence[Path], package: str) -> Iterator[Path]:
        """Yield the package from folders that a user has named: each may be it, or hold it."""
        for folder in folders:
            if (folder.name == package and _is_folder(folder)) or self._is_called(folder, package):
                yield folder
            if _is_folder(folder / package):
                yield folder / package
        for folder in folders:  # none is named so: perhaps one of the packages in them calls itself so
            yield from (each for each in _folders_in(folder) if self._is_called(each, package))

    def _is_called(self, folder: Path, package: str) -> bool:
        """Return whether a folder holds a package.xml that gives this name."""
        if folder not in self._names:
            self._names[folder] = _manifest_name(folder / "package.xml") if _is_package(folder) else ""
        return self._names[folder] == package

    def resolve(self, uri: str) -> Path | Reason:
        """Return the path that a mesh name leads to, or the reason why it leads nowhere."""
        place = self.place(uri)
        if isinstance(place, Reason):
            return place
        root, path = place
        try:
            real = path.resolve()
            if not real.is_relative_to(self.real(root)):
                return Reason.OUTSIDE
            return real if real.is_file() else Reason.MISSING
        except (OSError, RuntimeError, ValueError):  # a loop of links, a name too long, a NUL character
            return Reason.UNFOLLOWED

    def real(self, folder: Path) -> Path:
        """Return where a folder really is, links followed."""
        return folder.resolve()

    def place(self, uri: str) -> tuple[Path, Path] | Reason:
        """Return the folder that a mesh name may not leave, and the path it says; or why it says none."""
        if "\0" in uri:
            return Reason.NUL
        if uri.startswith("package://"):
            package, _, rest = uri.removeprefix("package://").partition("/")
            root = self.find(package)
            if root is None:
                return Reason.PACKAGE
        elif "://" in uri:
            return Reason.SCHEME
        elif uri.startswith(("/", "~")) or "\\" in uri[:3] or uri[1:3] in (":\\", ":/"):
            return Reason.ABSOLUTE
        elif self.file is None:
            return Reason.NO_FOLDER
        else:
            root = self.home()
            rest = str(self.file.parent.resolve().relative_to(root) / uri)
        from urllib.parse import unquote

        return root, root / unquote(rest).lstrip("/")

    def home(self) -> Path:
        """Return the package that the file is in (the nearest ancestor with package.xml), or its folder."""
        assert self.file is not None
        folder = self.file.parent.resolve()
        for ancestor in [folder, *folder.parents][:_MANY]:
            if (ancestor / "package.xml").is_file():
                return ancestor
        return folder

    def has_manifest(self) -> bool:
        """Return whether a package.xml says which package the file is in."""
        return self.file is not None and _is_package(self.home())

    def _ancestors(self) -> list[Path]:
        return [] if self.file is None else list(self.file.resolve().parents[:_MANY])


def other_case(root: Path, path: Path) -> Path | None:
    """Return the file below a folder that differs from a missing one by upper and lower case only; None if none does.

    Only folders below `root` are listed, and no link out of it is followed.
    """
    try:
        folder = root.resolve()
        for part in Path(os.path.normpath(path)).relative_to(root).parts:
            names = [part] if (folder / part).exists() else [entry.name for entry in folder.iterdir()]
            folder = (folder / next(name for name in names if name.lower() == part.lower())).resolve()
            if not folder.is_relative_to(root.resolve()):
                return None
    except (OSError, RuntimeError, ValueError, StopIteration):  # no such folder, a loop of links, out of the root
        return None
    return folder if folder.is_file() else None


def _manifest_name(path: Path) -> str:
    """Return the name that a package.xml gives; empty if it gives none, or cannot be read. No link is followed."""
    from xml.etree import ElementTree as ET

    if path.is_symlink():
        return ""
    try:
        data = read_file(path, str(path), _LARGEST_MANIFEST)
        parse(data, str(path))  # so there is no DOCTYPE in it
        root = ET.fromstring(data)  # noqa: S314
    except (KinetostatError, ET.ParseError, ValueError, LookupError):
        return ""
    return (root.findtext("name") or "").strip() if root.tag == "package" else ""


def _folders_in(folder: Path) -> Sequence[Path]:
    """Return the folders in a folder, by name; none of hidden ones, and not without end."""
    try:
        with os.scandir(folder) as entries:
            names = [e.name for e in itertools.islice(entries, _MANY_FOLDERS) if e.is_dir() and e.name[0] != "."]
    except OSError:
        return []
    return [folder / name for name in sorted(names)]


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except OSError:  # a name too long
        return False


def _is_package(path: Path) -> bool:
    try:
        return (path / "package.xml").is_file()
    except OSError:
        return False
