"""Rows to NPZ: an array a field, each streamed to a file of its own beside the archive, then put into it."""

from __future__ import annotations

import json
import shutil
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO, Any, BinaryIO

import numpy as np

from kinetostat.conventions import Array
from kinetostat.errors import UsageError
from kinetostat.report.row_files.fields import Numbers, RowField

__all__ = ["array_member", "npz_rows"]

_BLOCK = 1 << 20  # bytes that are copied at once
_EPOCH = (1980, 1, 1, 0, 0, 0)  # of every member


class _NpzRows:
    """Writes rows to the open parts: their numbers first, then the fields."""

    def __init__(self, parts: Sequence[IO[bytes]]) -> None:
        self._parts = parts
        self.count = 0

    def write(self, numbers: Numbers, values: Sequence[Array]) -> bool:
        """Write m rows; somebody always reads a file."""
        for part, array in zip(self._parts, [numbers, *values], strict=True):
            part.write(np.ascontiguousarray(array).data)
        self.count += len(numbers)
        return True


@contextmanager
def npz_rows(
    file: BinaryIO,
    folder: Path | None,
    fields: Sequence[RowField],
    about: Callable[[], Mapping[str, Any]],
    count: int,
    more: Mapping[str, Array],
) -> Iterator[_NpzRows]:
    """Yield what writes `count` rows; the archive is made of them when the block ends.

    Its arrays are `row`, those of the fields, `more`, and `about`, a JSON text, which is asked for at the end. `folder`
    is on the disk that parts go to.

    Raises:
        UsageError: the disk has no room for them.
    """
    _check_room(folder, 8 * count * (1 + sum(len(field.columns) for field in fields)))
    arrays = [("row", np.dtype(np.int64), ()), *((field.name, np.dtype(np.float64), field.shape) for field in fields)]
    with ExitStack() as stack:
        parts = [stack.enter_context(tempfile.TemporaryFile(dir=folder)) for _ in arrays]
        for part, (_, kind, shape) in zip(parts, arrays, strict=True):
            head = {"descr": np.lib.format.dtype_to_descr(kind), "fortran_order": False, "shape": (count, *shape)}
            np.lib.format.write_array_header_1_0(part, head)
        rows = _NpzRows(parts)
        yield rows
        if rows.count != count:  # the heads say how many
            message = f"{rows.count} rows of {count} were written"
            raise ValueError(message)
        with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
            for part, (name, *_) in zip(parts, arrays, strict=True):
                part.seek(0)
                with array_member(archive, name) as member:
                    shutil.copyfileobj(part, member, _BLOCK)
                part.close()  # its room on the disk is free again
            text = np.array(json.dumps(about(), ensure_ascii=False))
            for name, array in [*more.items(), ("about", text)]:
                with array_member(archive, name) as member:
                    np.lib.format.write_array(member, array, allow_pickle=False)


def array_member(archive: zipfile.ZipFile, name: str) -> IO[bytes]:
    """Open a member of an archive for an array, compressed as the archive is; the same array gives the same bytes."""
    entry = zipfile.ZipInfo(f"{name}.npy", _EPOCH)
    entry.compress_type = archive.compression
    return archive.open(entry, "w", force_zip64=True)


def _check_room(folder: Path | None, size: int) -> None:
    """Refuse what would fill the disk: how large it becomes is known before the first row."""
    free = shutil.disk_usage(folder or tempfile.gettempdir()).free
    if size > free:
        message = f"these rows are {size / 1e9:.3g} GB, and the disk has room for {free / 1e9:.3g} GB"
        raise UsageError(message, remedy="fewer rows or measures, or the summary")
