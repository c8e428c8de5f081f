"""Which files Python opens meanwhile, seen by an audit hook: whatever way they are opened."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path

_watchers: list[set[Path]] = []


def _hook(event: str, arguments: tuple[object, ...]) -> None:
    if _watchers and event == "open" and isinstance(arguments[0], str | bytes | os.PathLike):
        path = Path(os.fsdecode(arguments[0]))
        for opened in _watchers:
            opened.add(path)


sys.addaudithook(_hook)  # for good: hooks cannot be taken away


@contextlib.contextmanager
def watch() -> Iterator[set[Path]]:
    """Collect the paths of the files that are opened inside the `with` block."""
    opened: set[Path] = set()
    _watchers.append(opened)
    try:
        yield opened
    finally:
        _watchers.remove(opened)
