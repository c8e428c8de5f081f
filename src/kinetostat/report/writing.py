"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from kinetostat.errors import UsageError, quote

__all__ = ["write_whole"]


def write_whole(path: Path, content: bytes) -> None:
    """Write a file completely or not at all.

    Raises:
        UsageError: it cannot be written.
    """
    try:
        if path.exists() and not path.is_file():  # a terminal, a pipe: nothing to replace
            path.write_bytes(content)
        else:
            _replace(path, content)
    except OSError as error:
        raise UsageError(
            f"cannot write {quote(str(path))}: {error.strerror or error}", remedy="check its folder"
        ) from None


def _replace(path: Path, content: bytes) -> None:
    handle, draft = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name[:40]}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        umask = os.umask(0)
        os.umask(umask)
        Path(draft).chmod(0o666 & ~umask)
        Path(draft).replace(path)
    except BaseException:
        Path(draft).unlink(missing_ok=True)
        raise
