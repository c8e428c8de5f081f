"""On which line of a TOML file a key is. `tomllib` reads values but does not say; this finds keys, and reads no value.

Only text that `tomllib` has read is given here, so the grammar is taken for granted.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator

__all__ = ["Path", "key_lines", "line_of"]

Path = tuple[str | int, ...]

_TOKEN = re.compile(
    r"""
    (?P<skip>[ \t\r]+|\#[^\n]*)
    | (?P<text>\"{3}(?:\\.|[^\\])*?\"{3,5}|'{3}.*?'{3,5}|"(?:\\.|[^"\\\n])*"|'[^'\n]*')
    | (?P<mark>[\[\]{},=.\n])
    | (?P<bare>[^\s\[\]{},=.\#"']+)
    """,
    re.VERBOSE | re.DOTALL,
)


def key_lines(text: str) -> dict[Path, int]:
    """Return the line of each key and each table, from 1: `("robots", 0, "expect", 2, "at")`."""
    lines = dict[Path, int]()
    for path, line in _Finder(text).pairs():
        lines.setdefault(path, line)
    return lines


def line_of(path: Path, lines: dict[Path, int]) -> int | None:
    """Return the line of a key; if it has none of its own, that of the nearest table or list that it is in."""
    while path and path not in lines:
        path = path[:-1]
    return lines.get(path)


class _Finder:
    """Walks through the tokens of a file once."""

    def __init__(self, text: str) -> None:
        self._tokens = _tokens(text)
        self._counts = dict[Path, int]()  # of tables in each list of tables
        self._mark, self._line = "\n", 1
        self._next()

    def _next(self) -> None:
        self._mark, self._line = next(self._tokens)

    def pairs(self) -> Iterator[tuple[Path, int]]:
        """Yield paths and lines in the order of the file."""
        table: Path = ()
        while self._mark:
            if self._mark == "\n":
                self._next()
            elif self._mark == "[":
                table, line = self._header()
                yield table, line
            else:
                yield from self._pair(table)

    def _header(self) -> tuple[Path, int]:
        """Return the path of the table that a header opens."""
        line, several = self._line, False
        self._next()
        if self._mark == "[":
            several = True
            self._next()
        *above, last = self._key()
        while self._mark == "]":
            self._next()
        path: Path = ()
        for part in above:
            path = self._last((*path, part))
        path = (*path, last)
        if several:
            self._counts[path] = self._counts.get(path, 0) + 1
            return self._last(path), line
        return path, line

    def _last(self, path: Path) -> Path:
        """Return the path of the newest table, if a path is that of a list of tables."""
        count = self._counts.get(path, 0)
        return (*path, count - 1) if count else path

    def _key(self) -> list[str]:
        """Return the parts of a key, which may be dotted, and leave the mark after it."""
        parts = [_unquoted(self._mark)]
        self._next()
        while self._mark == ".":
            self._next()
            parts.append(_unquoted(self._mark))
            self._next()
        return parts

    def _pair(self, table: Path) -> Iterator[tuple[Path, int]]:
        line = self._line
        path = table
        for part in self._key():
            path = (*path, part)
            yield path, line
        self._next()  # the equals sign
        yield from self._value(path)

    def _value(self, path: Path) -> Iterator[tuple[Path, int]]:
        """Walk over a value. Deep nesting is no recursion of ours: `tomllib` has refused it before."""
        if self._mark == "[":
            yield from self._list(path)
        elif self._mark == "{":
            self._next()
            while self._mark != "}":
                if self._mark in ",\n":
                    self._next()
                else:
                    yield from self._pair(path)
            self._next()
        else:  # a date or a number may be several tokens
            while self._mark and self._mark not in ",]}\n":
                self._next()

    def _list(self, path: Path) -> Iterator[tuple[Path, int]]:
        self._next()
        index = 0
        while self._mark != "]":
            if self._mark in ",\n":
                self._next()
                continue
            yield (*path, index), self._line
            yield from self._value((*path, index))
            index += 1
        self._next()


def _tokens(text: str) -> Iterator[tuple[str, int]]:
    """Yield tokens and their lines; for ever an empty one at the end."""
    line = 1
    for found in _TOKEN.finditer(text):
        token = found[0]
        if found.lastgroup != "skip":
            yield token, line
        line += token.count("\n")
    while True:
        yield "", line


def _unquoted(token: str) -> str:
    """Return what a key is called."""
    if token[:1] not in ('"', "'"):
        return token
    return next(iter(tomllib.loads(f"{token} = 0")))
