"""Settings: where their file is found, how it is read, and what is said of one that is wrong."""

from __future__ import annotations

import math
import os
import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Literal, NoReturn, get_args, get_origin, get_type_hints

import msgspec

from kinetostat.errors import SourceError, UsageError, cut, quote, unknown_name
from kinetostat.policy.expectations import KINDS
from kinetostat.policy.kinds.common import PLACE
from kinetostat.policy.positions import Path as KeyPath
from kinetostat.policy.positions import key_lines, line_of
from kinetostat.policy.table import ChainSettings, CheckSettings, RobotSettings, Settings
from kinetostat.urdf.files import read_file

__all__ = ["ChainSettings", "CheckSettings", "RobotSettings", "Settings", "find_settings", "read_settings"]

NAME = "kinetostat.toml"
_PROJECT = "pyproject.toml"
_TABLE = ("tool", "kinetostat")
_MAX_BYTES = 1024 * 1024
# A key of 32 parts or more: tomllib takes the square of their number.
_DEEP_KEY = re.compile(r"(?<![^\s,=\[\]{}#])(?:[^\s.,=\[\]{}#]++[ \t]*+\.[ \t]*+){32}")


def find_settings(start: Path) -> Path | None:
    """Return the settings file that holds for a file or folder; None if there is none.

    `kinetostat.toml`, or pyproject.toml with a table `[tool.kinetostat]`, in the folder or in one above it, up to the
    root of the repository (a folder with `.git`) or of the file system; the nearest.

    Args:
        start: the file or folder.
    """
    here = _absolute(start)
    folder = here if here.is_dir() else here.parent
    for above in (folder, *folder.parents):
        if (above / NAME).is_file():
            return above / NAME
        if _is_ours(above / _PROJECT):
            return above / _PROJECT
        if (above / ".git").exists():
            return None
    return None


def _is_ours(project: Path) -> bool:
    """Return whether a pyproject.toml is about us. One that is broken is, if it seems to be: reading it says why."""
    try:
        text = _text(project)
    except UsageError:
        return False
    if "kinetostat" not in text:
        return False
    try:
        tools = _parsed(project, text).get("tool")
    except UsageError:
        return re.search(r"^\s*\[+\s*tool\s*\.\s*[\"']?kinetostat", text, re.MULTILINE) is not None
    return isinstance(tools, dict) and "kinetostat" in tools


def read_settings(path: Path) -> Settings:
    """Read a settings file: kinetostat.toml, or pyproject.toml with a table `[tool.kinetostat]`.

    Args:
        path: the file.

    Raises:
        UsageError: it cannot be read, is not TOML, or a key or value in it is none of ours; with the line.
    """
    path = _absolute(path)
    text = _text(path)
    content: Any = _parsed(path, text)
    base: KeyPath = ()
    if path.name == _PROJECT:
        base = _TABLE
        for part in _TABLE:
            content = content.get(part) if isinstance(content, dict) else None
        if content is None:
            raise UsageError("there is no table [tool.kinetostat]", file=str(path), remedy="kinetostat init writes one")
    found = _Checked(path, _lines(text), base)
    table = found.settings(content)
    robots = tuple(found.placed(("robots", i), robot) for i, robot in enumerate(table.robots))
    return msgspec.structs.replace(table, robots=robots)


def _absolute(path: Path) -> Path:
    return Path(os.path.abspath(path))  # noqa: PTH100 (Path.resolve follows links)


def _text(path: Path) -> str:
    try:
        return read_file(path, str(path), _MAX_BYTES).decode("utf-8-sig")
    except SourceError as error:
        remedy = error.remedy if "bytes" not in error.message else "long lists of poses belong into a CSV file"
        raise UsageError(error.message, file=str(path), remedy=remedy) from None
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        message = "this is not UTF-8 text, as TOML has to be"
        raise UsageError(message, file=str(path), line=line, remedy="save it as UTF-8") from None


def _parsed(path: Path, text: str) -> dict[str, Any]:
    deep = _DEEP_KEY.search(text)
    if deep is not None:
        place = text.count("\n", 0, deep.start()) + 1
        raise UsageError(
            "a key of more than 32 parts", file=str(path), line=place, remedy="no key of ours is dotted so"
        )
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise UsageError("this is nested too deeply", file=str(path)) from None
    except ValueError as error:  # not a TOMLDecodeError alone: a number of 5000 digits, a date that is none
        message = str(error)
        line: int | None = None
        where = re.search(r" \(at (?:line (\d+), column \d+|end of document)\)$", message)
        if where is not None:
            message = message[: where.start()]
            line = int(where[1]) if where[1] else text.count("\n") + 1
        raise UsageError(f"not TOML: {cut(message, 200)}", file=str(path), line=line) from None


def _lines(text: str) -> dict[KeyPath, int]:
    try:
        return key_lines(text)
    except RecursionError:
        return {}


class _Checked:
    """Makes settings of what a file holds, and knows on which line what is wrong with it is."""

    def __init__(self, file: Path, lines: dict[KeyPath, int], base: KeyPath) -> None:
        self._file, self._lines, self._base = file, lines, base

    def place(self, path: KeyPath) -> str:
        """Return where a key is: `kinetostat.toml:12`."""
        line = line_of((*self._base, *path), self._lines)
        return self._file.name if line is None else f"{self._file.name}:{line}"

    def placed(self, path: KeyPath, robot: RobotSettings) -> RobotSettings:
        """Return the same, each expectation and each chain knowing where it is written."""
        replace = msgspec.structs.replace
        expect = tuple(replace(one, place=self.place((*path, "expect", i))) for i, one in enumerate(robot.expect))
        chains = tuple(replace(one, place=self.place((*path, "chains", i))) for i, one in enumerate(robot.chains))
        return replace(robot, expect=expect, chains=chains)

    def refuse(self, path: KeyPath, message: str, remedy: str | None = None) -> NoReturn:
        """Say what is wrong with the key at a path."""
        line = line_of((*self._base, *path), self._lines)
        raise UsageError(message, file=str(self._file), line=line, element=_shown(path), remedy=remedy)

    def settings(self, content: Any) -> Settings:
        """Return the settings that a table holds."""
        if not isinstance(content, Mapping):
            self.refuse((), "[tool.kinetostat] is a table of settings")
        self._finite(content)
        self._known((), content, Settings)
        if isinstance(content.get("check"), Mapping):
            self._known(("check",), content["check"], CheckSettings)
        for path, robot in _tables(content, (), "robots"):
            self._known(path, robot, RobotSettings)
            for inner, expectation in _tables(robot, path, "expect"):
                self._known(inner, expectation, self._kind(inner, expectation), "kind")
            for inner, chain in _tables(robot, path, "chains"):
                self._known(inner, chain, ChainSettings)
        try:
            return msgspec.convert(content, Settings)
        except msgspec.ValidationError as error:
            message, path = _split(str(error))
            key, colon, rest = message.partition(": ")
            if colon and (*self._base, *path, key) in self._lines:
                message, path = rest, (*path, key)
            self.refuse(path, message, _choices(content, path) if "no choice" in message else None)

    def _finite(self, content: Any) -> None:
        """Refuse nan and inf, which TOML has words for."""
        waiting: list[tuple[KeyPath, Any]] = [((), content)]
        while waiting:
            path, value = waiting.pop()
            if isinstance(value, dict):
                waiting += (((*path, key), part) for key, part in value.items())
            elif isinstance(value, list):
                waiting += (((*path, i), part) for i, part in enumerate(value))
            elif isinstance(value, float) and not math.isfinite(value):
                self.refuse(path, f"{value} is not a finite number")

    def _known(self, path: KeyPath, table: Mapping[str, Any], kind: type[Any], *more: str) -> None:
        """Refuse a key that a table does not have."""
        known = [key for key in (*more, *kind.__struct_encode_fields__) if key != PLACE]
        for key in table:
            if key not in known:
                remedy = unknown_name("key", key, known).remedy or f"there are {', '.join(known)}"
                self.refuse((*path, key), f"there is no key {quote(key)}", remedy)

    def _kind(self, path: KeyPath, table: Mapping[str, Any]) -> type[Any]:
        kind = table.get("kind")
        listed = f"there are {', '.join(KINDS)}"
        if not isinstance(kind, str):
            self.refuse((*path, "kind"), "an expectation needs its kind, in quotation marks", listed)
        if kind not in KINDS:
            near = unknown_name("kind", kind, KINDS).remedy
            self.refuse((*path, "kind"), f"there is no kind of expectation {quote(kind)}", near or listed)
        return KINDS[kind]


def _tables(table: Mapping[str, Any], path: KeyPath, key: str) -> Iterator[tuple[KeyPath, Mapping[str, Any]]]:
    """Yield the tables in a list of tables, with their paths; what is none of that, msgspec refuses."""
    several = table.get(key)
    if isinstance(several, list):
        yield from (((*path, key, i), one) for i, one in enumerate(several) if isinstance(one, Mapping))


def _split(message: str) -> tuple[str, KeyPath]:
    """Return what msgspec says, in our words, and the path that it says it of."""
    text, _, where = message.rpartition(" - at `$")
    path = tuple(int(index) if index else key for index, key in re.findall(r"\[(\d+)\]|\.?([\w-]+)", where))
    return _in_words(text or message), path


_TYPES = {
    "float": "a number",
    "int": "a whole number",
    "str": "text in quotation marks",
    "bool": "true or false",
    "array": "a list",
    "object": "a table",
    "null": "nothing",
}


def _in_words(text: str) -> str:
    """Return a message of msgspec in the words of TOML."""
    text = re.sub(r" ?\| null\b", "", text)
    missing = re.fullmatch(r"Object missing required field `([\w-]+)`", text)
    if missing:
        return f"the key {quote(missing[1])} is missing"
    text = re.sub(r"`([^`]*)`", lambda found: " or ".join(_TYPES.get(w, w) for w in found[1].split(" | ")), text)
    text = re.sub(r"^Expected ", "expected ", text)
    text = re.sub(r"^Invalid enum value", "there is no choice", text)
    return re.sub(r"(\d)\.0\b", r"\1", text)


def _choices(content: Any, path: KeyPath) -> str | None:
    """Return the words that a key may be."""
    table: Any = content
    for part in path[:-1]:
        table = table[part]
    kind = CheckSettings if path[0] == "check" else KINDS[table["kind"]]
    fields = zip(kind.__struct_encode_fields__, kind.__struct_fields__, strict=True)
    hint = get_type_hints(kind)[dict(fields)[str(path[-1])]]
    words = next((get_args(part) for part in (hint, *get_args(hint)) if get_origin(part) is Literal), ())
    return f"there are {', '.join(map(quote, words))}" if words else None


def _shown(path: KeyPath) -> str | None:
    """Return a path as people write it: robots[0].expect[2].at."""
    if not path:
        return None
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)
    return cut(text.removeprefix("."), 120)
