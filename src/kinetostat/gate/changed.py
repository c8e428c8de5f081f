"""Which robots a change touches: their own files, and those that name a file that has changed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from kinetostat.errors import SourceError, UsageError, cut, quote
from kinetostat.gate.git import ask_git
from kinetostat.urdf.files import read_file

__all__ = ["changed_files", "touched"]


def touched(names: Sequence[str], revision: str, everything: Sequence[Path] = ()) -> tuple[str, ...]:
    """Return the robots that have changed since a revision, directly or through a file that they name.

    A robot counts as changed if its file, or its SRDF, differs, or if its text names a file (a mesh, a xacro part) that
    differs; a xacro file, if any .xacro or .yaml file does that its package holds. When in doubt, it counts.

    Args:
        names: paths of robots; what ships with us never changes.
        revision: such as origin/main.
        everything: files (settings, stored poses) a change of which touches all robots.

    Raises:
        UsageError, SourceError: no git, no repository, no such revision.
    """
    files = [name for name in names if not name.startswith(("example:", "textbook:"))]
    folder = Path(files[0]).resolve().parent if files else Path.cwd()
    changed = changed_files(revision, folder)
    if any(path.resolve() in changed for path in everything):
        return tuple(names)
    return tuple(name for name in files if _is_touched(Path(name), changed))


def changed_files(revision: str, folder: Path) -> frozenset[Path]:
    """Return the files that differ from a revision, untracked ones included, deleted ones too.

    Raises:
        UsageError: a revision that cannot be one.
        SourceError: no git, no repository, no such revision.
    """
    if not revision or revision.startswith("-") or "\0" in revision:
        raise UsageError(f"{quote(revision)} is not a revision", remedy="for instance origin/main")
    about = cut(revision)
    found = ask_git(["rev-parse", "--show-toplevel"], folder, about=about)
    if found is None:
        raise SourceError("not a git repository", file=str(folder), remedy="run it in the repository of the robots")
    top = Path(found.decode(errors="surrogateescape").rstrip("\n"))
    # From where the branch left the other: what has been done there since is not a change of ours.
    base = ask_git(["merge-base", revision, "HEAD"], top, about=about)
    start = base.decode().strip() if base else revision
    differing = ask_git(["diff", "--name-only", "--no-renames", "--no-ext-diff", "-z", start, "--"], top, about=about)
    untracked = ask_git(["ls-files", "--others", "--exclude-standard", "-z"], top, about=about)
    if differing is None or untracked is None:
        remedy = "in CI, fetch the whole history (fetch-depth: 0)"
        raise SourceError(f"git knows no revision {quote(revision)}", file=str(top), remedy=remedy)
    names = [name for name in (differing + untracked).decode(errors="surrogateescape").split("\0") if name]
    return frozenset(top.resolve() / name for name in names)


def _is_touched(path: Path, changed: frozenset[Path]) -> bool:
    own = path.resolve()
    stem = own.name.removesuffix(".xacro").removesuffix(".urdf")
    if own in changed or any(other.name == f"{stem}.srdf" for other in changed):
        return True
    if own.suffix == ".xacro" and any(other.suffix in (".xacro", ".yaml", ".yml") for other in changed):
        return True
    try:
        text = read_file(path, str(path)).decode(errors="replace")
    except SourceError:
        return True
    return any(other.name in text for other in changed)
