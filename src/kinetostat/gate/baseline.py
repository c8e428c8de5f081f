"""Known findings: a file that lists them, so that only new ones count.

A finding is known by file, code, element and attribute; not by its line, which moves when a file is edited, nor by its
numbers. One that stands for several elements is known by its code alone: which of them comes first is of no importance.
"""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from kinetostat.errors import UsageError
from kinetostat.gate.result import FileCheck
from kinetostat.lint.finding import Finding
from kinetostat.urdf.files import read_file

__all__ = ["Known", "baseline_text", "read_baseline", "without_known"]

SCHEMA = "kinetostat/baseline/1"

Known = dict[str, Counter[str]]


def baseline_text(files: Sequence[FileCheck], folder: Path, known: Known | None = None) -> str:
    """Return the text of a baseline that knows all findings of these files; paths are relative to its folder.

    That a robot cannot be read is never known: it may be another fault tomorrow.

    Args:
        files: what was checked, without a baseline.
        folder: that of the baseline.
        known: what it knew before, which stays for files that were not checked.
    """
    found = {_path(file.path, folder): Counter(map(_mark, file.findings)) for file in files if file.readable}
    merged = {path: dict(sorted(marks.items())) for path, marks in sorted({**(known or {}), **found}.items()) if marks}
    return json.dumps({"schema": SCHEMA, "findings": merged}, indent=1) + "\n"


def read_baseline(path: Path) -> Known:
    """Return the findings that a baseline file knows.

    Raises:
        UsageError: it is no baseline.
        SourceError: it cannot be read.
    """
    try:
        content = json.loads(read_file(path, str(path)))
        assert content["schema"] == SCHEMA
        return {
            file: Counter({mark: int(n) for mark, n in marks.items()}) for file, marks in content["findings"].items()
        }
    except (AssertionError, ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError):
        remedy = "write it anew with --write-baseline"
        raise UsageError("this is not a baseline of kinetostat", file=str(path), remedy=remedy) from None


def without_known(file: FileCheck, known: Known, folder: Path) -> FileCheck:
    """Return a file's result without the findings that a baseline in that folder knows; they are counted."""
    if not file.readable:
        return file
    left = Counter(known.get(_path(file.path, folder), {}))
    new = list[Finding]()
    for finding in file.findings:
        mark = _mark(finding)
        if left[mark] > 0:
            left[mark] -= 1
        else:
            new.append(finding)
    return replace(file, findings=tuple(new), known=len(file.findings) - len(new))


def _mark(finding: Finding) -> str:
    where = ("several",) if finding.several else (finding.element, finding.attribute)
    return " | ".join(part for part in (finding.code, Path(finding.file).name, *where) if part)


def _path(name: str, folder: Path) -> str:
    if name.startswith(("example:", "textbook:")):
        return name
    return Path(os.path.relpath(os.path.realpath(name), os.path.realpath(folder))).as_posix()
