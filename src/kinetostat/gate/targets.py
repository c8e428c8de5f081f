"""From what is asked for on the command line to robot files: files, folders, globs, `example:*`, `textbook:*`."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from pathlib import Path

from kinetostat.errors import SourceError, quote
from kinetostat.urdf.files import example_robots, short_names, textbook_robots

__all__ = ["from_folder", "is_robot_file", "robot_files"]

_SUFFIXES = (".urdf", ".urdf.xacro")  # of robots in a folder; other .xacro files may be parts: name them to check them


def robot_files(paths: Sequence[str], exclude: Sequence[str] = (), folder: Path = Path()) -> tuple[str, ...]:
    """Return the robots that are meant, each once, in the order in which they were asked for.

    Args:
        paths: files, folders (searched for .urdf and .urdf.xacro), globs, `example:NAME`, `textbook:NAME` with globs.
        exclude: globs of what folders and globs leave out; a file that is named is checked.
        folder: what these globs are relative to.

    Raises:
        SourceError: something named is not there, or nothing is left: checking nothing is no pass.
    """
    found: dict[str, None] = {}
    for path in paths:
        named = list(_meant(path))
        kept = (
            named
            if named == [path]
            else [p for p in named if not any(fnmatchcase(from_folder(p, folder), g) for g in exclude)]
        )
        if not named:
            raise SourceError(f"no robot is meant by {quote(path)}", remedy="name files, folders or globs with robots")
        found.update(dict.fromkeys(kept))
    if not found:
        raise SourceError("no robot to check", remedy="everything named is excluded: see exclude in the settings")
    return tuple(found)


def _meant(path: str) -> Iterator[str]:
    scheme, separator, rest = path.partition(":")
    if separator and scheme in ("example", "textbook") and not os.path.lexists(path):
        yield from _shipped(scheme, rest) if _is_glob(rest) else (path,)
        return
    if path == "-":
        raise SourceError("standard input is not checked", remedy="save the robot to a file")
    if path.endswith(".srdf"):
        raise SourceError("this is an SRDF, not a robot", file=path, remedy="name its robot, with which it is checked")
    if separator and scheme in ("example", "textbook"):
        yield from _meant(f"./{path}")  # a file of that name
    elif os.path.isdir(path):  # noqa: PTH112 (Path.is_dir raises where the name is too long)
        yield from _in_folder(path)
    elif _is_glob(path) and not os.path.lexists(path):
        for name in _matching(path):
            yield from _in_folder(name) if os.path.isdir(name) else (name,)  # noqa: PTH112
    elif os.path.lexists(path):
        yield path
    else:
        raise SourceError("there is no such file or folder", file=path, remedy="check the path")


def _matching(pattern: str) -> list[str]:
    """Return what a glob matches; unlike glob.glob, `**` follows no links, which may lead in circles.

    Raises:
        SourceError: it is no glob.
    """
    start, rest = (Path("/"), pattern.lstrip("/")) if pattern.startswith("/") else (Path(), pattern)
    try:
        found = sorted(str(path) for path in start.glob(rest))
    except (ValueError, NotImplementedError, OSError) as error:
        raise SourceError(f"{quote(pattern)} is no glob: {error}", remedy="for instance robots/**/*.urdf") from None
    hidden = {part for part in Path(rest).parts if part.startswith(".")}
    return [name for name in found if not any(part[0] == "." and part not in hidden for part in Path(name).parts)]


def from_folder(name: str, folder: Path) -> str:
    """Return a path relative to a folder, with slashes: what globs of the settings are compared with."""
    if name.startswith(("example:", "textbook:")):
        return name
    return Path(os.path.relpath(name, folder)).as_posix()


def _is_glob(text: str) -> bool:
    return any(mark in text for mark in "*?[")


def _shipped(scheme: str, pattern: str) -> Iterator[str]:
    names = short_names(example_robots() if scheme == "example" else textbook_robots())
    yield from (f"{scheme}:{name}" for name in names if fnmatchcase(name, pattern))


def _in_folder(folder: str) -> Iterator[str]:
    """Yield the robots in a folder and those below it, hidden ones left out; links to folders are not followed."""
    for here, folders, files in os.walk(folder, onerror=_refused):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for name in sorted(files):
            if is_robot_file(name) and not name.startswith("."):
                yield str(Path(here) / name)


def is_robot_file(name: str) -> bool:
    """Return whether a file in a folder is a robot by its name, in upper or lower case."""
    return name.lower().endswith(_SUFFIXES)


def _refused(error: OSError) -> None:
    raise SourceError(f"the folder cannot be searched: {error.strerror}", file=error.filename) from None
