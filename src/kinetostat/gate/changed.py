"""Which robots a change touches: their own files, and those that name a file that has changed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from kinetostat.errors import SourceError
from kinetostat.gate.git import changed_files
from kinetostat.urdf.files import read_file

__all__ = ["touched"]


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
