"""Files that expectations name, relative to the settings file."""

from __future__ import annotations

from pathlib import Path

from kinetostat.errors import SourceError, UsageError
from kinetostat.urdf.files import read_file

__all__ = ["text_beside"]

_MAX_BYTES = 16 * 1024 * 1024


def text_beside(folder: Path, name: str) -> str:
    """Return the text of a regular file in UTF-8.

    Args:
        folder: that of the settings file.
        name: the file, as the settings name it.

    Raises:
        UsageError: it cannot be read.
    """
    try:
        return read_file(folder / name, name, _MAX_BYTES).decode("utf-8-sig")
    except SourceError as error:
        remedy = None if "bytes" in error.message else error.remedy
        raise UsageError(error.message, file=name, remedy=remedy) from None
    except UnicodeDecodeError:
        raise UsageError("this is not UTF-8 text", file=name) from None
