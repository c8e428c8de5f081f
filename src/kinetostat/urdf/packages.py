"""Where `package://` and mesh names lead. Nothing is opened: a path is resolved, or refused with a reason.

Robot files are untrusted: a mesh may not lie outside the package of the file that names it (`..`, absolute paths,
`file://`, symbolic links that lead out). Meshes are never needed for a number.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Packages"]

_MANY = 64  # ancestors to walk up, at most
_SYSTEM_DEPTH = 3  # /home/someone has three parts: so high up, a folder is a package only if it says so


@dataclass(frozen=True)
class Packages:
    """Finds packages for one robot file.

    Searched in order: the folders of `--package-dir` (each may be a package or hold packages), the ancestors of the
    file and the folders in them that hold a package.xml, ROS_PACKAGE_PATH, AMENT_PREFIX_PATH. An ancestor without its
    package.xml counts by its name, unless it is as high up as a home folder: `package://etc` is no package.
    """

    file: Path | None
    folders: Sequence[Path] = ()

    def find(self, package: str) -> Path | None:
        """Return the folder of a package, or None."""
        if not package or package in (".", "..") or "/" in package or "\\" in package or "\0" in package:
            return None
        return next(self._found(package), None)

    def _found(self, package: str) -> Iterator[Path]:
        """Yield the folders that a package's name stands for, in the order of the search."""
        yield from self._among(self.folders, package)
        for folder in self._ancestors():
            if folder.name == package and (_is_package(folder) or len(folder.parts) > _SYSTEM_DEPTH):
                yield folder
            if _is_package(folder / package):
                yield folder / package
        for variable, below in (("ROS_PACKAGE_PATH", ""), ("AMENT_PREFIX_PATH", "share")):
            entries = [Path(entry) / below for entry in os.environ.get(variable, "").split(os.pathsep) if entry]
            yield from self._among(entries, package)

    @staticmethod
    def _among(folders: Sequence[Path], package: str) -> Iterator[Path]:
        """Yield the package from folders that a user has named: each may be it, or hold it."""
        for folder in folders:
            if folder.name == package and _is_folder(folder):
                yield folder
            if _is_folder(folder / package):
                yield folder / package

    def resolve(self, uri: str) -> Path | str:
        """Return the path that a mesh name leads to, or the reason why it leads nowhere."""
        if "\0" in uri:
            return "the name holds a NUL character"
        if uri.startswith("package://"):
            package, _, rest = uri.removeprefix("package://").partition("/")
            root = self.find(package)
            if root is None:
                return "the package is not found"
        elif "://" in uri:
            return "only package:// and relative names are followed"
        elif uri.startswith(("/", "~")) or "\\" in uri[:3] or uri[1:3] in (":\\", ":/"):
            return "an absolute path"
        elif self.file is None:
            return "standard input has no folder to look in"
        else:
            root, rest = self.home(), str(self.file.parent.resolve().relative_to(self.home()) / uri)
        from urllib.parse import unquote

        try:
            path = root / unquote(rest).lstrip("/")
            real, inside = path.resolve(), root.resolve()
            if not real.is_relative_to(inside):
                return "the path leads out of the package"
            return real if real.is_file() else "there is no such file"
        except (OSError, RuntimeError, ValueError):  # a loop of links, a name too long, a NUL character
            return "the path cannot be followed"

    def home(self) -> Path:
        """Return the package that the file is in (the nearest ancestor with package.xml), or its folder."""
        assert self.file is not None
        folder = self.file.parent.resolve()
        for ancestor in [folder, *folder.parents][:_MANY]:
            if (ancestor / "package.xml").is_file():
                return ancestor
        return folder

    def _ancestors(self) -> list[Path]:
        return [] if self.file is None else list(self.file.resolve().parents[:_MANY])


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
