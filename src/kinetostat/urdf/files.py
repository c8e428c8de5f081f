"""Where robot files are found, and how they are opened: regular files of a bounded size, nothing else."""

from __future__ import annotations

import os
import stat
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from kinetostat.errors import AmbiguousNameError, SourceError, UnknownNameError, quote, unknown_name

__all__ = ["MAX_BYTES", "Source", "example_robots", "open_source", "read_file", "textbook_robots"]

MAX_BYTES = 64 * 1024 * 1024


@dataclass(frozen=True)
class Source:
    """Where a robot came from: the name it was asked by, its path (None for standard input), its bytes."""

    name: str
    path: Path | None
    data: bytes

    @property
    def sha256(self) -> str:
        """Digest of the bytes, in hexadecimal."""
        import hashlib  # loads OpenSSL, which a query that shows no digest should not wait for

        return hashlib.sha256(self.data).hexdigest()


def open_source(name: str, *, max_bytes: int = MAX_BYTES, stdin: BinaryIO | None = None) -> Source:
    """Return the bytes behind a name: a path, `-`, `textbook:NAME` or `example:NAME`.

    Raises:
        SourceError: there is no such file, it is not a regular file, or it is too big.
        UnknownNameError, AmbiguousNameError: no such, or more than one, textbook or example robot.
    """
    if name == "-":
        if stdin is None and sys.stdin is None:
            raise SourceError("standard input is closed", file="-", remedy="pipe the robot file to it")
        data = (stdin or sys.stdin.buffer).read(max_bytes + 1)
        if len(data) > max_bytes:
            raise _too_big("standard input", max_bytes)
        return Source("-", None, data)
    if not name:
        raise SourceError("no robot is named", remedy="name a file, textbook:NAME or example:NAME")
    path = locate(name)
    return Source(name, path, read_file(path, name, max_bytes))


def locate(name: str) -> Path:
    """Return the path behind a name other than `-`; it need not exist."""
    scheme, _, rest = name.partition(":")
    if scheme == "textbook":
        return _choose(rest, textbook_robots(), "textbook")
    if scheme == "example":
        return _choose(rest, example_robots(), "example")
    return Path(name)


def read_file(path: Path, shown: str, max_bytes: int = MAX_BYTES) -> bytes:
    """Return the bytes of a regular file. `shown` is its name in errors.

    Raises:
        SourceError: missing, unreadable, not a regular file (a FIFO or a device can block for ever), or too big.
    """
    try:
        mode = path.stat().st_mode  # follows links: a link to a device is a device
        if stat.S_ISDIR(mode):
            raise SourceError("this is a folder, not a file", file=shown, remedy="name the robot file in it")
        if not stat.S_ISREG(mode):
            raise SourceError("this is not a regular file", file=shown, remedy="save it to a file, or pipe it to '-'")
        # O_NONBLOCK: should the file have become a FIFO since, opening it does not wait for a writer.
        with os.fdopen(os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0)), "rb") as file:
            data = file.read(max_bytes + 1)
    except FileNotFoundError:
        if path.is_symlink():
            target = quote(str(path.readlink()))
            raise SourceError(f"a link to {target}, which is not there", file=shown, remedy="mend the link") from None
        raise SourceError("there is no such file", file=shown, remedy=_nearby(path) or "check the path") from None
    except PermissionError:
        raise SourceError("the file may not be read", file=shown, remedy="check its permissions") from None
    except (OSError, ValueError) as error:  # ValueError: a NUL byte in the name
        reason = getattr(error, "strerror", None) or str(error)
        raise SourceError(f"the file cannot be read: {reason}", file=shown, remedy="check the path") from None
    if len(data) > max_bytes:
        raise _too_big(shown, max_bytes)
    return data


def _too_big(shown: str, max_bytes: int) -> SourceError:
    return SourceError(f"more than {max_bytes} bytes", file=shown, remedy="raise --max-bytes if you trust the file")


def _nearby(path: Path) -> str | None:
    """Return a hint at a robot that ships with us, or at a file of nearly the same name."""
    for scheme, robots in (("textbook", textbook_robots()), ("example", example_robots())):
        if path.name in short_names(robots):
            return f"did you mean {scheme}:{path.name}?"
    try:
        siblings = [entry.name for entry in os.scandir(path.parent)]
    except (OSError, ValueError):
        return None
    hint = unknown_name("file", path.name, [s for s in siblings if s.endswith((".urdf", ".xacro", ".srdf"))]).remedy
    return hint if hint and hint.startswith("did you mean") else None


def textbook_robots() -> dict[str, Path]:
    """Return the project's own robots by name: `robots/` of the repository, or what the wheel holds of it."""
    package = Path(__file__).parents[1]
    for folder in (package / "robots", package.parents[1] / "robots"):
        if (folder / "SOURCES.md").is_file():
            return {path.stem: path for path in sorted(folder.glob("*.urdf"))}
    return {}


def example_robots() -> dict[str, Path]:
    """Return the robots of example-robot-data by `folder/stem`. The package is data: there is nothing to import."""
    for prefix in (
        *(Path(p) / "cmeel.prefix" for p in sys.path if p),
        Path(sys.prefix),
        Path("/usr"),
        Path("/opt/openrobots"),
    ):
        robots = prefix / "share" / "example-robot-data" / "robots"
        if robots.is_dir():
            return {f"{path.parents[1].name}/{path.stem}": path for path in sorted(robots.glob("*/*/*.urdf"))}
    return {}


def short_names(robots: dict[str, Path]) -> list[str]:
    """Return the names to ask for them by: the stem where it is unique, else folder/stem."""
    stems = [name.rpartition("/")[2] for name in robots]
    return [stem if stems.count(stem) == 1 else name for name, stem in zip(robots, stems, strict=True)]


def _choose(wanted: str, robots: dict[str, Path], scheme: str) -> Path:
    if not robots:
        remedy = "pip install example-robot-data" if scheme == "example" else "reinstall kinetostat"
        raise UnknownNameError(f"no {scheme} robots are installed", remedy=remedy)
    found = [name for name in robots if wanted in (name, name.rpartition("/")[2])]
    if len(found) == 1:
        return robots[found[0]]
    if found:
        choices = " or ".join(f"{scheme}:{name}" for name in found)
        raise AmbiguousNameError(f"{scheme} robot {quote(wanted)} is ambiguous", remedy=f"use {choices}")
    raise unknown_name(f"{scheme} robot", wanted, short_names(robots), listing="'kinetostat robots' lists them")
