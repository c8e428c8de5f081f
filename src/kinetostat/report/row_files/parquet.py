"""Rows to Parquet by pyarrow: a row group a block, the unit of each column in the metadata of its field."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from typing import Any, BinaryIO

from kinetostat.conventions import Array
from kinetostat.errors import UsageError
from kinetostat.report.row_files.fields import Numbers, RowField, distinct_columns

__all__ = ["need_pyarrow", "parquet_rows"]


def need_pyarrow() -> None:
    """Refuse Parquet where it cannot be written, before anything is computed.

    Raises:
        UsageError: pyarrow is not installed.
    """
    if find_spec("pyarrow") is None:
        remedy = "pip install 'kinetostat[parquet]', or write .npz"
        raise UsageError("Parquet needs pyarrow, which is not installed", remedy=remedy)


class _ParquetRows:
    """Writes each block of rows as a row group."""

    def __init__(self, writer: Any, schema: Any) -> None:
        self._writer, self._schema = writer, schema

    def write(self, numbers: Numbers, values: Sequence[Array]) -> bool:
        """Write m rows; somebody always reads a file."""
        import pyarrow as pa

        count = len(numbers)
        columns = [column for part in values for column in part.reshape(count, -1).T]
        table = pa.table([pa.array(column) for column in (numbers, *columns)], schema=self._schema)
        self._writer.write_table(table, row_group_size=max(1, count))
        return True


@contextmanager
def parquet_rows(
    file: BinaryIO, fields: Sequence[RowField], about: Callable[[], Mapping[str, Any]]
) -> Iterator[_ParquetRows]:
    """Yield what writes rows; `about` becomes the JSON text `kinetostat` of the metadata.

    That of the schema is asked for at once, as Arrow wants it; that of the file again at the end.
    """
    import pyarrow as pa
    from pyarrow import parquet

    units = [unit for field in fields for unit in field.units]
    columns = [pa.field("row", pa.int64(), nullable=False)]
    for name, unit in zip(distinct_columns(fields), units, strict=True):
        columns.append(pa.field(name, pa.float64(), nullable=False, metadata={"unit": unit} if unit else None))
    schema = pa.schema(columns, metadata={"kinetostat": json.dumps(about(), ensure_ascii=False)})
    # No dictionaries: hardly two numbers are the same.
    with parquet.ParquetWriter(file, schema, use_dictionary=False) as writer:
        yield _ParquetRows(writer, schema)
        writer.add_key_value_metadata({"kinetostat": json.dumps(about(), ensure_ascii=False)})
