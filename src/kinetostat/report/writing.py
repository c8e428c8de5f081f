"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from kinetostat.errors import UsageError, quote

__all__ = ["open_whole", "write_whole"]


def write_whole(path: Path, content: bytes) -> None:
    """Write a file completely or not at all.

    Raises:
        UsageError: it cannot be written.
    """
    with open_whole(path) as file:
        file.write(content)


@contextmanager
def open_whole(path: Path) -> Iterator[BinaryIO]:
    """Open a file to write in; it is there, complete, when the block ends without an error, and else as it was.

    Raises:
        UsageError: it cannot be written.
    """
    try:
        if path.exists() and not path.is_file():  # a terminal, a pipe: nothing to replace
            with path.open("wb") as file:
                yield file
        else:
            yield from _replaced(_target(path))
    except OSError as error:
        raise UsageError(
            f"cannot write {quote(str(path))}: {getattr(error, 'strerror', None) or error}", remedy="check its folder"
        ) from None


def _target(path: Path) -> Path:
    """Return what a path names: a link stays, the file that it leads to is replaced."""
    try:
        return path.resolve(strict=path.is_symlink())
    except RuntimeError as error:  # links that lead to each other, before Python 3.13
        raise OSError(str(error)) from None


def _replaced(path: Path) -> Iterator[BinaryIO]:
    handle, draft = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name[:40]}.")
    try:
        with os.fdopen(handle, "wb") as file:
            yield file
        Path(draft).chmod(_mode(path))
        Path(draft).replace(path)
    except BaseException:
        Path(draft).unlink(missing_ok=True)
        raise


def _mode(path: Path) -> int:
    """Return the permissions that a file has, or that a new one gets."""
    if path.exists():
        return stat.S_IMODE(path.stat().st_mode)
    umask = os.umask(0)
    os.umask(umask)
    return 0o666 & ~umask
