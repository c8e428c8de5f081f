"""Which robots a change touches: their own files, and those that name a file that has changed."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote as percent
from xml.sax.saxutils import escape

from kinetostat.errors import SourceError, UsageError, cut, quote
from kinetostat.gate.git import ask_git
from kinetostat.urdf.files import read_file

__all__ = ["touched"]


def touched(
    names: Sequence[str], revision: str, everything: Sequence[Path] = (), srdfs: Mapping[str, Path] | None = None
) -> tuple[str, ...]:
    """Return the robots that have changed since a revision, directly or through a file that they name.

    A robot counts as changed if its file, or an SRDF of its name, differs, or if its text names a file (a mesh, a xacro
    part) that differs; a xacro file, if any .xacro or .yaml file does. When in doubt, it counts: what git does not
    track, what lies in a submodule without that revision, every robot where a package.xml differs.

    Args:
        names: paths of robots; what ships with us never changes.
        revision: such as origin/main; changes are those since the branch left it.
        everything: files (settings, stored poses) a change of which touches all robots.
        srdfs: the SRDF of a robot, where it is another than the one beside it.

    Raises:
        UsageError, SourceError: no git, no repository, no such revision.
    """
    if not revision or revision.startswith("-") or "\0" in revision or ".." in revision:
        raise UsageError(f"{quote(revision)} is not a revision", remedy="for instance origin/main")
    files = [name for name in names if not name.startswith(("example:", "textbook:"))]
    main = _Repository.around(Path(files[0]).absolute().parent if files else Path(), revision)
    if main.changed is None:
        remedy = "in CI, fetch the whole history (fetch-depth: 0)"
        raise SourceError(f"git knows no revision {quote(revision)}", file=str(main.top), remedy=remedy)
    if any(main.differs(path) for path in everything):
        return tuple(names)
    folders = {name: Path(name).absolute().parent for name in files}
    repositories = {folder: _Repository.around(folder, revision) for folder in set(folders.values())}
    return tuple(name for name in files if repositories[folders[name]].touches(Path(name), (srdfs or {}).get(name)))


@dataclass(frozen=True)
class _Repository:
    """A repository: its top folder, the files that git tracks, those that differ (None: it has no such revision)."""

    top: Path
    tracked: frozenset[str]
    changed: frozenset[str] | None

    @classmethod
    def around(cls, folder: Path, revision: str) -> _Repository:
        """Return the repository that a folder is in.

        Raises:
            SourceError: there is none, or no git.
        """
        about = cut(revision)
        found = ask_git(["rev-parse", "--show-toplevel"], folder, about=about) if folder.is_dir() else None
        if found is None:
            raise SourceError("not a git repository", file=str(folder), remedy="run it in the repository of the robots")
        top = Path(os.fsdecode(found.rstrip(b"\n")))
        # From where the branch left the other: what has been done there since is not a change of ours.
        base = ask_git(["merge-base", revision, "HEAD"], top, about=about)
        start = base.decode().strip() if base else revision
        names = ["diff", "--name-only", "--no-renames", "--no-ext-diff", "-z", start, "--"]
        differing = ask_git(names, top, about=about)
        untracked = ask_git(["ls-files", "--others", "--exclude-standard", "-z"], top, about=about)
        tracked = ask_git(["ls-files", "-z"], top, about=about)
        changed = None if differing is None or untracked is None else _paths(top, differing + untracked)
        return cls(top, _paths(top, tracked or b""), changed)

    def differs(self, path: Path) -> bool:
        """Return whether a file differs: as it is named, or where links lead."""
        assert self.changed is not None
        return bool(_names_of(path) & self.changed)

    def touches(self, path: Path, srdf: Path | None) -> bool:
        """Return whether a robot counts as changed."""
        if self.changed is None or self.differs(path) or (srdf is not None and self.differs(srdf)):
            return True
        if not _names_of(path) & self.tracked:
            return True
        names = {Path(other).name for other in self.changed}
        stem = path.name.removesuffix(".xacro").removesuffix(".urdf")
        if {"package.xml", f"{stem}.srdf"} & names:
            return True
        if path.suffix == ".xacro" and any(name.endswith((".xacro", ".yaml", ".yml")) for name in names):
            return True
        try:
            text = read_file(path, str(path)).decode(errors="replace")
        except SourceError:
            return True
        return any(word in text for name in names for word in {name, percent(name), escape(name)})


def _paths(top: Path, listed: bytes) -> frozenset[str]:
    """Return the paths that git lists, absolute."""
    real = os.path.realpath(top)
    return frozenset(f"{real}/{os.fsdecode(name)}" for name in listed.split(b"\0") if name)


def _names_of(path: Path) -> set[str]:
    """Return where a file is: by its own name in the real folder, and where links lead."""
    return {f"{os.path.realpath(path.absolute().parent)}/{path.name}", os.path.realpath(path)}
