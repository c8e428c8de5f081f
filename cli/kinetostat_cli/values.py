"""Numbers that users give in options and files."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from kinetostat.errors import ConfigurationError, SourceError, UsageError, quote

__all__ = ["by_joint", "numbers", "read_text", "read_values"]


def numbers(text: str, option: str, count: int) -> list[float]:
    """Return the finite numbers of an option, separated by commas or blanks.

    Raises:
        UsageError: not so many finite numbers.
    """
    words = text.replace(",", " ").split()
    try:
        values = [float(word) for word in words]
    except ValueError:
        values = []
    if len(values) != count or not all(abs(value) < float("inf") for value in values):
        raise UsageError(
            f"{option} takes {count} finite numbers, not {quote(text)}",
            remedy="for instance " + ",".join("0" * (count - 1) + "1"),
        )
    return values


def by_joint(text: str | None, option: str) -> dict[str, float | tuple[float, float]]:
    """Return what an option says of joints: joint=number, or joint=lower:upper, separated by commas.

    Raises:
        UsageError: a part is not of that form; a joint is given twice.
    """
    found: dict[str, float | tuple[float, float]] = {}
    for part in [] if text is None else text.split(","):
        name, _, value = part.strip().rpartition("=")
        low, both, high = value.partition(":")
        try:
            found_one = (float(low), float(high)) if both else float(low)
        except ValueError:
            name = ""
        if not name or name in found:
            message = f"{option}: {quote(part)} is not of the form joint=number, or a joint is given twice"
            raise UsageError(message, remedy=f"for instance {option} elbow=50,wrist=-20:35")
        found[name] = found_one
    return found


def read_values(name: str) -> tuple[Mapping[str, Any] | list[float], bool]:
    """Return joint values from a .json or .csv file, and whether the file is a result of ours, which is in radians.

    JSON: {joint: value}, a list in file order, or the JSON output of any command. CSV: a header of joint names and a
    row of values, or a row of values in file order.

    Raises:
        ConfigurationError: the file cannot be read, or holds no configuration.
    """
    text = read_text(name)
    return _from_csv(text, name) if name.lower().endswith(".csv") else _from_json(text, name)


def read_text(name: str) -> str:
    """Return the text of a regular file in UTF-8.

    Raises:
        ConfigurationError: it cannot be read.
    """
    from kinetostat.urdf.files import read_file

    try:
        return read_file(Path(name), name).decode("utf-8-sig")
    except SourceError as error:
        raise ConfigurationError(error.message, file=name, remedy=error.remedy) from None
    except UnicodeDecodeError:
        raise ConfigurationError("this is not UTF-8 text", file=name) from None


def _from_json(text: str, name: str) -> tuple[Mapping[str, Any] | list[float], bool]:
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ConfigurationError(f"not JSON: {error}", file=name) from None
    ours = isinstance(content, dict) and str(content.get("schema", "")).startswith("kinetostat/")
    if ours:
        content = content.get("configuration")
    if isinstance(content, dict) and all(_is_value(value) for value in content.values()):
        return content, ours
    if isinstance(content, list) and all(_is_value(value) and not isinstance(value, list) for value in content):
        return content, ours
    raise ConfigurationError("no configuration in it", file=name, remedy='write {"joint": value, ...} or [value, ...]')


def _is_value(value: object) -> bool:
    if isinstance(value, list):
        return all(_is_value(part) and not isinstance(part, list) for part in value)
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _from_csv(text: str, name: str) -> tuple[Mapping[str, Any] | list[float], bool]:
    try:
        read = [[cell.strip() for cell in row] for row in csv.reader(text.splitlines())]
    except csv.Error as error:
        raise ConfigurationError(f"not CSV: {error}", file=name) from None
    rows = [row for row in read if any(row)]
    values = _floats(rows[-1]) if rows else None
    if values is None or len(rows) > 2:
        raise ConfigurationError(
            f"{len(rows)} rows of text", file=name, remedy="write a row of joint names and a row of values"
        )
    if len(rows) == 1:
        return values, False
    header = rows[0]
    if len(header) != len(values) or _floats(header) is not None:
        raise ConfigurationError(
            "the first row does not name a joint for each value", file=name, remedy="one configuration is expected"
        )
    return dict(zip(header, values, strict=True)), False


def _floats(cells: list[str]) -> list[float] | None:
    try:
        return [float(cell) for cell in cells]
    except ValueError:
        return None
