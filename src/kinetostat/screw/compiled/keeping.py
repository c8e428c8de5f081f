"""Where compiled code is kept, so that it is compiled once a machine, not once a process.

In the user's cache folder (`XDG_CACHE_HOME`, by default `~/.cache/kinetostat`), a folder for each state of the sources,
a file for each function, signature and kind of processor. A file is written beside and renamed, so that several
processes may compile at once; it begins with a checksum, so that what a crash or a full disk has left is compiled anew.
Numba's own cache has neither: two processes can take each other's files, and a damaged one is fatal.

A folder that others may write, or that cannot be written, is not used: nobody runs code that somebody else put there.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import _Cache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps
from platformdirs import user_cache_path

__all__ = ["FOLDER", "KeptCode"]

_CHECKSUM = 32  # bytes


def _sources() -> str:
    """Return what tells one state of the sources (and of Numba) from another."""
    texts = [path.read_bytes() for path in sorted(Path(__file__).parent.glob("*.py"))]
    return hashlib.sha256(b"\0".join([numba.__version__.encode(), *texts])).hexdigest()[:16]


def _folder() -> Path | None:
    """Return a folder that we may write, and nobody else; None if there is none."""
    with suppress(OSError, RuntimeError):
        wanted = user_cache_path("kinetostat") / "compiled" / _sources()
        wanted.mkdir(parents=True, exist_ok=True, mode=0o700)
        found = wanted.stat()
        if found.st_uid == os.getuid() and not found.st_mode & 0o022 and os.access(wanted, os.W_OK | os.X_OK):
            return wanted
    return None


FOLDER = _folder()


class KeptCode(_Cache):  # type: ignore[misc]
    """The compiled forms of one function that are kept, as Numba asks for them and hands them over."""

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        self._name, self._kept_in = f"{function.__module__}.{function.__qualname__}", folder

    @property
    def cache_path(self) -> str:
        """The folder."""
        return str(self._kept_in)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the code of a signature; None if it is not there, or damaged."""
        target_context.refresh()
        try:
            content = self._file(sig, target_context.codegen()).read_bytes()
            if hashlib.sha256(content[_CHECKSUM:]).digest() != content[:_CHECKSUM]:
                return None
            return CompileResult._rebuild(target_context, *pickle.loads(content[_CHECKSUM:]))  # noqa: S301
        except Exception:
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the code of a signature; nothing happens where it cannot be written."""
        content = dumps(data._reduce())
        file, draft = self._file(sig, data.codegen), None
        try:
            handle, draft = tempfile.mkstemp(dir=self._kept_in)
            with os.fdopen(handle, "wb") as out:
                out.write(hashlib.sha256(content).digest() + content)
            Path(draft).replace(file)
        except OSError:
            if draft is not None:
                Path(draft).unlink(missing_ok=True)

    def _file(self, sig: Any, codegen: Any) -> Path:
        """Return the file of a signature on this kind of processor."""
        key = repr((self._name, str(sig), codegen.magic_tuple()))
        return self._kept_in / f"{hashlib.sha256(key.encode()).hexdigest()[:32]}.code"

    def enable(self) -> None:
        """It always is."""

    def disable(self) -> None:
        """It always is enabled."""

    def flush(self) -> None:
        """Nothing waits to be written."""
