"""Files of rows: which can be written, and opening one by its ending."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Any, BinaryIO

from kinetostat.conventions import Array
from kinetostat.errors import UsageError, quote
from kinetostat.report.row_files.csv import CsvRows
from kinetostat.report.row_files.fields import RowField, RowWriter, described
from kinetostat.report.row_files.npz import npz_rows
from kinetostat.report.row_files.parquet import need_pyarrow, parquet_rows
from kinetostat.report.writing import open_whole

__all__ = ["ENDINGS", "check_row_file", "open_rows"]

ENDINGS = (".csv", ".npz", ".parquet")
_NONE: Mapping[str, Array] = MappingProxyType({})


def check_row_file(path: Path) -> None:
    """Refuse a file that `open_rows` could not write, before anything is computed.

    Raises:
        UsageError: another ending than .csv, .npz or .parquet; pyarrow is needed and missing.
    """
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        message = f"cannot write rows to {quote(str(path))}: a file's format is told by its ending"
        raise UsageError(message, remedy=f"name it {', '.join(ENDINGS[:-1])} or {ENDINGS[-1]}")
    if ending == ".parquet":
        need_pyarrow()


@contextmanager
def open_rows(
    path: Path, fields: Sequence[RowField], about: Mapping[str, Any], count: int, arrays: Mapping[str, Array] = _NONE
) -> Iterator[RowWriter]:
    """Open a file of rows by its ending; it is there, complete, when the block ends without an error, else as it was.

    Args:
        path: where to; .csv, .npz or .parquet.
        fields: what a row holds.
        about: what is to be known of all rows; JSON, kept in .npz and .parquet beside names and units. It is looked at
            when the block ends, so what rows have told may be put into it.
        count: how many rows will be written.
        arrays: what an .npz keeps besides, by name.

    Raises:
        UsageError: it cannot be written.
    """
    check_row_file(path)
    ending = path.suffix.lower()

    def known() -> dict[str, Any]:
        return {**about, "fields": described(fields)}

    with open_whole(path) as file:
        if ending == ".csv":
            yield CsvRows(lambda text: _written(file, text), fields)
        elif ending == ".npz":
            # Parts go where the file goes, which has room for it; beside a pipe there is none.
            beside = path.resolve().parent if path.is_file() or not path.exists() else None
            with npz_rows(file, beside, fields, known, count, arrays) as rows:
                yield rows
        else:
            with parquet_rows(file, fields, known) as groups:
                yield groups


def _written(file: BinaryIO, text: str) -> bool:
    file.write(text.encode())
    return True
