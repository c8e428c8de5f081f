"""The samples of a trajectory as columns: a row out for each row of the file, CSV or Parquet; and arrays for JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from kinetostat.analysis.indices import powered
from kinetostat.conventions import TWIST_ROWS, TWIST_UNITS, Array
from kinetostat.report import csv
from kinetostat.report.json import nested
from kinetostat.report.row_files.csv import number_rows
from kinetostat.report.writing import open_whole

if TYPE_CHECKING:
    from kinetostat.analysis.trajectory.trajectory import Trajectory

__all__ = ["BadRow", "FileRows", "sample_arrays", "sample_lines", "write_parquet"]

_AT_ONCE = 4096  # rows that are Python objects at one time
_POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")


@dataclass(frozen=True)
class BadRow:
    """A row of a file that cannot be used: its number, its line (None: the file has no lines), and why."""

    row: int
    line: int | None
    reason: str

    def __str__(self) -> str:
        line = "" if self.line is None else f" (line {self.line})"
        return f"row {self.row}{line}: {self.reason}"


@dataclass(frozen=True)
class FileRows:
    """The rows of a file that samples come from.

    Attributes:
        numbers: of each sample, from 1, increasing. (m,).
        count: how many rows the file has.
        bad: those that were left out.
    """

    numbers: npt.NDArray[np.int64]
    count: int
    bad: tuple[BadRow, ...] = ()


@dataclass(frozen=True)
class _Group:
    """An array of all samples: its name, the names of its columns and their units."""

    name: str
    columns: tuple[str, ...]
    units: tuple[str, ...]
    values: Array


def _groups(result: Trajectory) -> list[_Group]:
    """Return the arrays of all samples, (m, k) each."""
    names, turning = result.columns, result.joints.turning
    lengths = tuple("rad" if turns else "m" for turns in turning)
    index = np.stack([result.yoshikawa, result.minimum_singular_value, result.inverse_condition_number], axis=-1)
    indices = ("yoshikawa", "minimum_singular_value", "inverse_condition_number")
    index_units = (powered(result.unit, result.mechanism.generic_rank), result.unit, "1")

    def of_joints(name: str, units: Sequence[str], values: Array | None) -> list[_Group]:
        return [] if values is None else [_Group(name, tuple(f"{name}.{j}" for j in names), tuple(units), values)]

    found = [] if result.time is None else [_Group("time", ("time",), ("s",), result.time[:, None])]
    found += of_joints("q", lengths, result.q)
    pose = np.concatenate([result.at.position, result.at.quaternion], axis=-1)
    found.append(_Group("pose", _POSE, ("m", "m", "m", "1", "1", "1", "1"), pose))
    found.append(_Group("indices", indices, index_units, index))
    found += of_joints("qdot", [f"{unit}/s" for unit in lengths], result.rates)
    found += of_joints("qddot", [f"{unit}/s2" for unit in lengths], result.accelerations)
    if result.at.twist is not None:
        found.append(_Group("twist", TWIST_ROWS, TWIST_UNITS, result.at.twist))
    found += of_joints("torque", ["Nm" if turns else "N" for turns in turning], result.at.torque)
    found += of_joints("effort_use", ["1"] * len(names), result.effort_use)
    found.append(_Group("limit_distance", ("limit_distance",), ("1",), result.at.limit_distance[:, None]))
    return found


def sample_arrays(result: Trajectory, rows: FileRows) -> dict[str, Any]:
    """Return the samples for JSON: {array: {columns, units, values}}, and the number of each one's row."""
    found: dict[str, Any] = {"row": rows.numbers.tolist()}
    for group in _groups(result):
        values = group.values + 0.0  # no -0.0
        listed = values.tolist() if np.all(np.isfinite(values)) else nested(values)
        flat = [row[0] for row in listed] if len(group.columns) == 1 else listed
        found[group.name] = {"columns": list(group.columns), "units": list(group.units), "values": flat}
    return found


def sample_lines(result: Trajectory, rows: FileRows) -> Iterator[str]:
    """Yield the lines of a CSV file, in blocks: a header, then a row for each row of the file.

    The number of the row, columns of numbers in SI units (what is not finite is empty), whether the sample is near a
    singular configuration, which limits are exceeded (`joint position`), and why a row has no answer.
    """
    groups = _groups(result)
    named = [(c, u) for group in groups for c, u in zip(group.columns, group.units, strict=True)]
    names = [f"{column} [{unit}]" for column, unit in named]
    yield csv.lines([["row", *names, "near_singular", "violations", "reason"]])
    near, texts_beyond = result.inverse_condition_number < result.near, _beyond(result)
    cells_beyond = {text: csv.lines([[text]]).rstrip("\n") for text in set(texts_beyond.values())}
    beyond = {sample: cells_beyond[text] for sample, text in texts_beyond.items()}
    bad = {one.row: "," * len(named) + csv.lines([["", "", one.reason]]) for one in rows.bad}
    failed = np.array(sorted(bad), dtype=np.int64)
    for start in range(0, len(rows.numbers), _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        numbers = rows.numbers[part]
        cells = np.concatenate([group.values[part] for group in groups], axis=1) + 0.0
        texts = number_rows(cells.tolist())
        answers = {
            int(number): f"{text},{'yes' if close else 'no'},{beyond.get(start + i, '')},\n"
            for i, (number, text, close) in enumerate(zip(numbers, texts, near[part].tolist(), strict=True))
        }
        low = 0 if start == 0 else int(rows.numbers[start - 1])
        high = rows.count if start + _AT_ONCE >= len(rows.numbers) else int(numbers[-1])
        between = failed[np.searchsorted(failed, low, "right") : np.searchsorted(failed, high, "right")]
        answers |= {int(number): bad[int(number)] for number in between}
        yield "".join(f"{number},{answers[number]}" for number in sorted(answers))


def _beyond(result: Trajectory) -> dict[int, str]:
    """Return {sample: the limits that it exceeds}, in words."""
    found: dict[int, list[str]] = {}
    for one in result.violations:
        for sample in range(one.first, one.last + 1):
            found.setdefault(sample, []).append(f"{one.joint} {one.kind}")
    return {sample: "; ".join(texts) for sample, texts in found.items()}


# --- Parquet ---------------------------------------------------------------------------------------------------


def write_parquet(path: Path, result: Trajectory, rows: FileRows, about: Mapping[str, Any]) -> None:
    """Write the columns of `sample_lines` to a Parquet file, whole or not at all.

    Units are in the metadata of the columns, `about` in that of the file, as JSON under `kinetostat`. What is not
    finite, and what a row without an answer has, is null.

    Raises:
        UsageError: it cannot be written.
    """
    import pyarrow as pa
    from pyarrow import parquet

    numbers = np.sort(np.concatenate([rows.numbers, np.array([one.row for one in rows.bad], dtype=np.int64)]))
    places = np.searchsorted(numbers, rows.numbers)
    samples: list[int | None] = [None] * len(numbers)
    for sample, place in enumerate(places.tolist()):
        samples[place] = sample
    fields, columns = [pa.field("row", pa.int64(), nullable=False)], [pa.array(numbers)]
    for group in _groups(result):
        for name, unit, values in zip(group.columns, group.units, group.values.T, strict=True):
            column = np.full(len(numbers), np.nan)
            column[places] = np.where(np.isfinite(values), values + 0.0, np.nan)
            fields.append(pa.field(name, pa.float64(), metadata={"unit": unit}))
            columns.append(pa.array(column, from_pandas=True))
    near, beyond = (result.inverse_condition_number < result.near).tolist(), _beyond(result)
    reasons = {one.row: one.reason for one in rows.bad}
    fields += [pa.field("near_singular", pa.bool_()), pa.field("violations", pa.string())]
    columns.append(pa.array([None if i is None else near[i] for i in samples], pa.bool_()))
    columns.append(pa.array([None if i is None else beyond.get(i) for i in samples], pa.string()))
    fields.append(pa.field("reason", pa.string()))
    columns.append(pa.array([reasons.get(number) for number in numbers.tolist()], pa.string()))
    schema = pa.schema(fields, metadata={"kinetostat": json.dumps(about, ensure_ascii=False)})
    with open_whole(path) as file, parquet.ParquetWriter(file, schema) as writer:
        writer.write_table(pa.table(columns, schema=schema))
