"""Where `package://` and mesh names lead. Nothing is opened: a path is resolved, or refused with a reason.

Robot files are untrusted: a mesh may not lie outside the package of the file that names it (`..`, absolute paths,
`file://`, symbolic links that lead out). Meshes are never needed for a number.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Packages"]

_MANY = 64  # ancestors to walk up, at most


@dataclass(frozen=True)
class Packages:
    """Finds packages for one robot file.

    Searched in order: the folders of `--package-dir` (each may be a package or hold packages), the ancestors of the
    file and the folders in them, ROS_PACKAGE_PATH, AMENT_PREFIX_PATH.
    """

    file: Path | None
    folders: Sequence[Path] = ()

    def find(self, package: str) -> Path | None:
        """Return the folder of a package, or None."""
        if not package or package in (".", "..") or "/" in package or "\\" in package or "\0" in package:
            return None
        for folder in self._places():
            if folder.name == package and folder.is_dir():
                return folder
            if (folder / package).is_dir():
                return folder / package
        return None

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

        path = root / unquote(rest)
        try:
            real, inside = path.resolve(), root.resolve()
        except (OSError, RuntimeError):  # a loop of links
            return "the path leads in a circle"
        if not real.is_relative_to(inside):
            return "the path leads out of the package"
        return real if real.is_file() else "there is no such file"

    def home(self) -> Path:
        """Return the package that the file is in (the nearest ancestor with package.xml), or its folder."""
        assert self.file is not None
        folder = self.file.parent.resolve()
        for ancestor in [folder, *folder.parents][:_MANY]:
            if (ancestor / "package.xml").is_file():
                return ancestor
        return folder

    def _places(self) -> list[Path]:
        places = list(self.folders)
        if self.file is not None:
            places += self.file.resolve().parents[:_MANY]
        for variable, below in (("ROS_PACKAGE_PATH", ""), ("AMENT_PREFIX_PATH", "share")):
            places += [Path(entry) / below for entry in os.environ.get(variable, "").split(os.pathsep) if entry]
        return places
