"""The four files of a report: index.html, report.json, robots.csv, report.md; each whole or not at all."""

from __future__ import annotations

import stat
import tempfile
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path

import msgspec

from kinetostat.errors import UsageError, quote
from kinetostat.report.check.words import encodable, inert_json
from kinetostat.report.fleet.document import FleetDocument
from kinetostat.report.fleet.drawing import Drawing
from kinetostat.report.fleet.table import robots_csv
from kinetostat.report.writing import open_whole

__all__ = ["NAMES", "json_text", "prepared", "write_fleet"]

NAMES = ("report.json", "robots.csv", "report.md", "index.html")  # the page last: what it stands for is there then
_ELSEWHERE = "choose another folder"


def write_fleet(folder: Path, document: FleetDocument, drawings: Mapping[str, Drawing]) -> tuple[Path, ...]:
    """Write the report into a folder, which is made if it is not there; return the files.

    All texts are made, and written beside, before the first takes its place; index.html is the last that does.

    Args:
        folder: where; files of these four names in it are replaced.
        document: all numbers.
        drawings: pictures by key, such as "r1/tree".

    Raises:
        UsageError: the folder, or a file in it, cannot be written.
    """
    from kinetostat.report.fleet.markdown import markdown
    from kinetostat.report.fleet.page import page

    prepared(folder)
    texts = json_text(document), robots_csv(document), markdown(document), page(document, drawings)
    written = tuple(folder / name for name in NAMES)
    with ExitStack() as taking_place:  # those that come first do so last
        for path, text in zip(reversed(written), reversed(texts), strict=True):
            file = taking_place.enter_context(open_whole(path))
            file.write(encodable(text).encode("utf-8"))
            file.flush()  # a full disk is told here
    return written


def prepared(folder: Path) -> None:
    """Make a folder, its parents too, and see that a report can be written into it: before much is computed.

    Raises:
        UsageError: it is a file, or cannot be made or written; or one of the four names in it is a folder or a link.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
        strange = [folder / name for name in NAMES if not _replaceable(folder / name)]
    except FileExistsError:
        raise UsageError(f"{quote(str(folder))} is not a folder", remedy=_ELSEWHERE) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise UsageError(f"cannot write into {quote(str(folder))}: {reason}", remedy=_ELSEWHERE) from None
    if strange:
        raise UsageError(
            f"{quote(str(strange[0]))} is a folder, a link or a device", remedy=f"remove it, or {_ELSEWHERE}"
        )


def _replaceable(path: Path) -> bool:
    """Return whether a path is free, or that of a file: one behind a link is somebody else's."""
    try:
        return stat.S_ISREG(path.lstat().st_mode)
    except FileNotFoundError:
        return True


def json_text(document: FleetDocument) -> str:
    """Return report.json: keys in the order of the types, floats as short as reads back the same, no NaN.

    What is not printable in a name is escaped: a terminal, or a log, shows it as text.
    """
    text = msgspec.json.format(msgspec.json.encode(document), indent=1).decode("utf-8")
    return inert_json(text) + "\n"
