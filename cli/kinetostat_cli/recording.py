"""Configurations in a file, CSV or Parquet: columns of joints, perhaps of time; sound rows, and why others are not.

What records a robot writes such files, and so does this tool: `trajectory` and `sweep --trajectory` read them alike.
"""

from __future__ import annotations

import csv
import itertools
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kinetostat.analysis.configuration import LARGEST_ANGLE, LARGEST_LENGTH, from_rows
from kinetostat.conventions import Array
from kinetostat.errors import ConfigurationError, cut, quote
from kinetostat.report.trajectory_rows import BadRow, FileRows
from kinetostat.urdf.description import JointType, Robot
from kinetostat_cli.reading import is_header, list_file, list_text, split_unit

if TYPE_CHECKING:
    from kinetostat import Model

__all__ = ["Recording", "read_recording"]

_BLOCK = 1 << 16  # lines that are read at once
_TIME = ("time", "t", "time_from_start")
_LIKE_TIME = re.compile(r".*time.*|.*stamp|secs?|seconds?", re.IGNORECASE)
_UNITS = {"rad": 1.0, "deg": math.pi / 180, "m": 1.0, "s": 1.0}


@dataclass(frozen=True)
class Recording:
    """The rows of a file that can be used, and the others.

    Attributes:
        q: configurations of the whole robot, (m, nq), rad and m.
        time: s, increasing, (m,); None if there is no such column, or it was not asked for.
        rows: which row of the file each is, how many there are, and those that were left out.
        names: the coordinates that the file names; all others stay where `rest` has them.
        ignored: columns that were left out, of files that this tool has written.
    """

    q: Array
    time: Array | None
    rows: FileRows
    names: tuple[str, ...]
    ignored: tuple[str, ...]


@dataclass(frozen=True)
class _Columns:
    """Which columns of a file count, what they are called, and what makes SI units of their numbers; `t` is of time."""

    places: tuple[int, ...]
    names: tuple[str, ...]
    factors: tuple[float, ...]
    t: int | None
    width: int
    ignored: tuple[str, ...]


@dataclass(frozen=True)
class _Block:
    """Some rows: the numbers that count, (m, k), NaN in rows that have a reason; and the lines, if there are lines."""

    values: Array
    lines: Sequence[int] | None
    reasons: dict[int, str]


def read_recording(file: Path, model: Model, rest: Array, *, degrees: bool, timed: bool = True) -> Recording:
    """Return the configurations in a file; joints that have no column stay where `rest`, (nq,), has them.

    The header names joints in any order, and time as `time`, `t` or `time_from_start`, perhaps with units:
    `elbow [deg]`; it may stand after a `#`. Without a header there is a column for each coordinate, in file order. What
    this tool writes can be read back; its columns that are no joints are left out. Rows with another number of cells,
    without a finite number, or with a time that is not after the one before, are left out and told.

    Args:
        file: .parquet, or CSV of any other name; `-` is standard input.
        model: the robot.
        rest: where joints stay that have no column, (nq,).
        degrees: angles of columns that say no unit are in degrees.
        timed: whether time counts; if not, its column is left out, whatever is in it.

    Raises:
        ConfigurationError: the file cannot be read; a unit that is none; no row that can be used.
        UnknownNameError: a column names no joint.
    """
    robot = model.robot
    if file.suffix.lower() in (".json", ".jsonl", ".npz"):
        raise ConfigurationError("neither CSV nor Parquet", file=str(file), remedy="give .csv or .parquet")
    if file.suffix.lower() == ".parquet":
        columns, blocks = _parquet(file, robot, degrees, timed)
        parts = list(blocks)
    else:
        with list_text(file) as text:
            lines = ((i, line) for i, line in enumerate(text, 1) if line.strip())
            columns, blocks = _csv(lines, robot, degrees, timed)
            parts = list(blocks)
    width = len(columns.places)
    values = np.concatenate([part.values for part in parts] or [np.zeros((0, width))]) * columns.factors
    at = None if any(part.lines is None for part in parts) else [n for part in parts for n in part.lines or ()]
    reasons, start = dict[int, str](), 0
    for part in parts:
        reasons |= {start + i: reason for i, reason in part.reasons.items()}
        start += len(part.values)
    _find_unsound(values, columns, robot, reasons)
    if columns.t is not None:
        _find_disordered(values[:, columns.t], reasons)
    sound = np.ones(len(values), dtype=bool)
    sound[list(reasons)] = False
    bad = tuple(BadRow(i + 1, at[i] if at else None, reasons[i]) for i in sorted(reasons))
    if not np.any(sound):
        why = f"; {bad[0]}" if bad else ""
        raise ConfigurationError(f"no row can be used{why}", file=str(file), remedy="a row is a sample")
    joints = [i for i in range(width) if i != columns.t]
    names = tuple(columns.names[i] for i in joints)
    others = [i for i, name in enumerate(robot.position_names) if name not in names]
    q = from_rows(model, values[sound][:, joints], names)
    q[:, others] = rest[others]
    time = None if columns.t is None else values[sound, columns.t]
    return Recording(q, time, FileRows(np.flatnonzero(sound) + 1, len(values), bad), names, columns.ignored)


# --- columns ---------------------------------------------------------------------------------------------------


def _columns(
    header: Sequence[tuple[str, str]] | None, width: int, robot: Robot, *, degrees: bool, timed: bool
) -> _Columns:
    """Return the columns that count of a header of names and units."""
    known = robot.position_names
    if header is None:
        if width != len(known):
            raise ConfigurationError(
                f"{width} columns without a header, {len(known)} coordinates", remedy="name the columns' joints"
            )
        header = [(name, "") for name in known]
    prefixed = any(name.startswith("q.") and name[2:] in known for name, _ in header)
    own = header[0][0] == "row" and "row" not in known
    stamp = next((i for i, (name, _) in enumerate(header) if name.lower() in _TIME and name not in known), None)
    t, unread = (stamp, None) if timed else (None, stamp)
    places, names, factors, ignored = list[int](), list[str](), list[float](), list[str]()
    for i, (written, unit) in enumerate(header):
        name = written.removeprefix("q.") if prefixed else written
        other = (prefixed and not written.startswith("q.")) or name not in known
        if i == t:
            factors.append(_factor(written, unit or "s", ("s",)))
        elif (other and (own or prefixed)) or i == unread:
            ignored += [] if written in ("row", "reason") or i == unread else [written]
            continue
        else:
            factors.append(_joint_factor(robot, name, unit, degrees))
        places.append(i)
        names.append(name)
    if len(places) == (t is not None):
        raise ConfigurationError("no column names a joint", remedy="the header has the names of joints")
    if t is not None:
        t = places.index(t)
        names[t] = ""
    # Wrong names, doubled ones and followers are told once, before any row is read.
    from_rows(robot, np.zeros((0, len(names) - (t is not None))), [n for i, n in enumerate(names) if i != t])
    return _Columns(tuple(places), tuple(names), tuple(factors), t, width, tuple(ignored))


def _joint_factor(robot: Robot, name: str, unit: str, degrees: bool) -> float:
    """Return what makes rad or m of a column's numbers: the unit that the header tells counts more than --deg."""
    joint = next((joint for joint in robot.independent if name in joint.position_names), None)
    if joint is None and _LIKE_TIME.fullmatch(name):
        raise ConfigurationError(f"column {quote(name)} is no joint", remedy="the column of time is named time, in s")
    if joint is None:
        return 1.0  # from_rows says why
    if joint.type is JointType.FLOATING:
        message = f"column {quote(name)} is of a floating joint"
        raise ConfigurationError(message, remedy="leave it out: -q says where the base is held")
    turns = joint.type.is_angle or (joint.type is JointType.PLANAR and name.endswith(".theta"))
    usual = ("deg" if degrees else "rad") if turns else "m"
    return _factor(name, unit or usual, ("rad", "deg") if turns else ("m",))


def _factor(name: str, unit: str, allowed: Sequence[str]) -> float:
    if unit not in allowed:
        message = f"column {quote(name)} is in {quote(unit)}"
        raise ConfigurationError(message, remedy=f"write {' or '.join(allowed)}")
    return _UNITS[unit]


# --- CSV -------------------------------------------------------------------------------------------------------


def _csv(
    lines: Iterator[tuple[int, str]], robot: Robot, degrees: bool, timed: bool
) -> tuple[_Columns, Iterator[_Block]]:
    """Return the columns that count, and the blocks of rows, of numbered lines that are not blank."""
    first = next(lines, None)
    if first is None:
        raise ConfigurationError("an empty list", remedy="write a header of joints and a row for each sample")
    number, line = first[0], first[1].removeprefix("\ufeff")
    cells = next(csv.reader([line], strict=True))
    if cells[0].lstrip().startswith("#") and split_unit(cells[0])[0] not in robot.position_names:
        cells[0] = cells[0].lstrip().removeprefix("#")  # numpy.savetxt writes headers as comments
    _refuse_separators(cells, robot)
    named = is_header(cells)
    header = [split_unit(cell) for cell in cells] if named else None
    columns = _columns(header, len(cells), robot, degrees=degrees, timed=timed)
    rows = lines if named else itertools.chain([(number, line)], lines)
    return columns, _csv_blocks(rows, columns)


def _refuse_separators(cells: Sequence[str], robot: Robot) -> None:
    """Refuse cells that something else than commas separates.

    Raises:
        ConfigurationError: so it is.
    """
    if len(cells) > 1 or split_unit(cells[0])[0] in robot.position_names:
        return
    known = {*robot.position_names, *_TIME}
    for separator, called in ((";", "semicolons"), ("\t", "tabs"), (None, "blanks")):
        words = [word.strip() for word in cells[0].split(separator)]
        if len(words) > 1 and any(split_unit(word)[0] in known or _is_number(word) for word in words):
            message = f"cells are separated by {called}"
            raise ConfigurationError(message, remedy="separate them by commas, and write decimal points")


def _is_number(word: str) -> bool:
    try:
        float(word.replace(",", "."))
    except ValueError:
        return False
    return True


def _csv_blocks(rows: Iterable[tuple[int, str]], columns: _Columns) -> Iterator[_Block]:
    rows = iter(rows)
    while block := list(itertools.islice(rows, _BLOCK)):
        lines, texts = [line for line, _ in block], [text for _, text in block]
        values = _all_at_once(texts, columns)
        yield _one_by_one(lines, texts, columns) if values is None else _Block(values, lines, {})


def _all_at_once(texts: list[str], columns: _Columns) -> Array | None:
    """Return the numbers of rows by NumPy's own reader; None where one row is not as it should be."""
    commas = columns.width - 1
    if any(text.count(",") != commas for text in texts):
        return None
    try:
        values = np.loadtxt(texts, delimiter=",", usecols=columns.places, comments=None, ndmin=2)
    except ValueError:
        return None
    return values if len(values) == len(texts) else None


def _one_by_one(lines: list[int], texts: list[str], columns: _Columns) -> _Block:
    """Return the numbers of rows, and what is wrong with those that have none."""
    values, reasons = np.full((len(texts), len(columns.places)), np.nan), dict[int, str]()
    for i, text in enumerate(texts):
        try:
            cells = next(csv.reader([text], strict=True))
        except csv.Error as error:
            reasons[i] = f"not CSV: {error}"
            continue
        if not any(cell.strip() for cell in cells):
            reasons[i] = "an empty row"
        elif len(cells) != columns.width:
            reasons[i] = f"{len(cells)} cells, {columns.width} are needed"
        else:
            values[i], reason = _numbers([cells[place] for place in columns.places], columns)
            if reason:
                reasons[i] = reason
    return _Block(values, lines, reasons)


def _numbers(cells: Sequence[str], columns: _Columns) -> tuple[list[float], str]:
    """Return the numbers of cells, NaN for none, and why the first one has none."""
    found, reason = list[float](), ""
    for i, cell in enumerate(cells):
        try:
            found.append(float(cell))
        except ValueError:
            found.append(math.nan)
            what = f"{quote(cell.strip())} is not a number" if cell.strip() else "no number"
            reason = reason or f"{_title(columns, i)}: {what}"
    return found, reason


def _title(columns: _Columns, i: int) -> str:
    return "time" if i == columns.t else cut(columns.names[i])


# --- Parquet ---------------------------------------------------------------------------------------------------


def _parquet(file: Path, robot: Robot, degrees: bool, timed: bool) -> tuple[_Columns, Iterator[_Block]]:
    """Return the columns that count, and the rows; units are in the names or in the metadata of the fields.

    Raises:
        ConfigurationError: it cannot be read; pyarrow is not installed; a column is not of numbers.
    """
    try:
        from pyarrow import ArrowException, parquet
    except ImportError:
        remedy = "pip install 'kinetostat[parquet]', or write CSV"
        raise ConfigurationError("Parquet needs pyarrow, which is not installed", remedy=remedy) from None
    try:
        with parquet.ParquetFile(list_file(file)) as source:
            header = []
            for part in source.schema_arrow:
                name, unit = split_unit(part.name)
                header.append((name, unit or (part.metadata or {}).get(b"unit", b"").decode()))
            if not header:
                raise ConfigurationError("no column in it", file=str(file))
            columns = _columns(header, len(header), robot, degrees=degrees, timed=timed)
            table = source.read(columns=[source.schema_arrow.names[i] for i in columns.places])
            parts = [part.cast("float64").to_numpy() for part in table.columns]
    except (ArrowException, OSError, UnicodeDecodeError) as error:
        raise ConfigurationError(f"not Parquet of numbers: {cut(str(error))}", file=str(file)) from None
    values = np.stack(parts, axis=-1).astype(np.float64)
    empty = np.isnan(values)
    reasons = {int(i): f"{_title(columns, int(np.argmax(empty[i])))}: no number" for i in np.flatnonzero(empty.any(1))}
    return columns, iter([_Block(values, None, reasons)])


# --- rows that cannot be used ----------------------------------------------------------------------------------


def _find_unsound(values: Array, columns: _Columns, robot: Robot, reasons: dict[int, str]) -> None:
    """Add the rows with a number that is not finite, or too large to be a position."""
    turning = {name: joint.type.is_angle for joint in robot.independent for name in joint.position_names}
    for i, name in enumerate(columns.names):
        largest = LARGEST_ANGLE if turning.get(name) else LARGEST_LENGTH
        for row in np.flatnonzero(~(np.abs(values[:, i]) <= largest)).tolist():
            number = values[row, i]
            what = f"{number:g} is not a finite number" if not math.isfinite(number) else f"beyond {largest:g}"
            reasons.setdefault(row, f"{_title(columns, i)}: {what}")


def _find_disordered(time: Array, reasons: dict[int, str]) -> None:
    """Add the rows whose time is not after the one before; or is after the next two that follow: a stray large one."""
    sound = [i for i in range(len(time)) if i not in reasons] if reasons else list(range(len(time)))
    if np.all(np.diff(time[sound]) > 0):
        return
    stamps, last = time[sound].tolist(), -math.inf
    for k, (i, now) in enumerate(zip(sound, stamps, strict=True)):
        following = stamps[k + 1 : k + 3]
        if now <= last:
            reasons[i] = f"time {now:.9g} s is not after {last:.9g} s"
        elif len(following) == 2 and last < min(following) and max(following) < now:
            reasons[i] = f"time {now:.9g} s is after that of the rows that follow"
        else:
            last = now
