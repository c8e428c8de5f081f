"""Known findings: a file that lists them, so that only new ones count.

A finding is known by file, code, element and message, not by its line: lines move when a file is edited.
"""

from __future__ import annotations

import json
import os
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from kinetostat.errors import UsageError
from kinetostat.gate.result import FileCheck
from kinetostat.lint.finding import Finding
from kinetostat.urdf.files import read_file

__all__ = ["baseline_text", "read_baseline", "without_known"]

SCHEMA = "kinetostat/baseline/1"

Known = dict[str, Counter[str]]


def baseline_text(files: Sequence[FileCheck], folder: Path) -> str:
    """Return the text of a baseline that knows all findings of these files; paths are relative to its folder."""
    known = {
        _path(file.path, folder): dict(sorted(Counter(map(_mark, file.findings)).items()))
        for file in sorted(files, key=lambda file: file.path)
        if file.findings
    }
    return json.dumps({"schema": SCHEMA, "findings": known}, indent=1, ensure_ascii=False) + "\n"


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
    except (AssertionError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        remedy = "write it anew with --write-baseline"
        raise UsageError("this is not a baseline of kinetostat", file=str(path), remedy=remedy) from None


def without_known(file: FileCheck, known: Known, folder: Path) -> FileCheck:
    """Return a file's result without the findings that a baseline in that folder knows; they are counted."""
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
    message = re.sub(r"\bline \d+", "line", finding.message)
    return " | ".join(part for part in (finding.code, Path(finding.file).name, finding.element, message) if part)


def _path(name: str, folder: Path) -> str:
    if name.startswith(("example:", "textbook:")):
        return name
    return Path(os.path.relpath(Path(name).resolve(), folder.resolve())).as_posix()
