"""What commands over many robots have in common: which settings, how many processes, how far they are."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinetostat.errors import UsageError, cut
from kinetostat_cli.console import progress_bar

if TYPE_CHECKING:
    from kinetostat.policy.settings import Settings

__all__ = [
    "JobsOption",
    "NoSettingsOption",
    "PathsArgument",
    "SettingsOption",
    "Shown",
    "SrdfOption",
    "here",
    "progress",
    "settings_of",
]

PathsArgument = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="[PATHS]...",
        help="Files, folders, globs, 'example:*'. Default: all below kinetostat.toml (else below here).",
    ),
]
SettingsOption = Annotated[
    Path | None,
    typer.Option("--settings", metavar="FILE", help="Settings and policy. Default: kinetostat.toml here or above."),
]
NoSettingsOption = Annotated[bool, typer.Option("--no-settings", help="Look for no kinetostat.toml.")]
JobsOption = Annotated[
    int | None, typer.Option("--jobs", "-j", min=1, max=256, metavar="N", help="Processes. Default: a core each.")
]
SrdfOption = Annotated[Path | None, typer.Option(metavar="FILE", help="SRDF of the robot. Default: the one beside it.")]

_ENOUGH = 2  # robots that are done before it is said how long the others will take


def settings_of(given: Path | None, paths: Sequence[str], *, wanted: bool) -> tuple[Settings | None, Path]:
    """Return the settings (those from here up, else those from the first path up), and the folder of their paths.

    Args:
        given: their file; None: look for it.
        paths: the robots that are asked for.
        wanted: whether it is looked for.

    Raises:
        UsageError: they cannot be read.
    """
    from kinetostat.policy.settings import find_settings, read_settings

    path = given
    if path is None and wanted:
        starts = [here(), *(Path(name) for name in paths[:1] if os.path.lexists(name))]
        path = next(filter(None, map(find_settings, starts)), None)
    if path is None:
        return None, Path()
    return read_settings(path), Path(os.path.relpath(path.parent))


def here() -> Path:
    """Return the current folder.

    Raises:
        UsageError: it is gone.
    """
    try:
        return Path.cwd()
    except FileNotFoundError:
        raise UsageError("the current folder is gone", remedy="change to one that is there") from None


class Shown:
    """How far it is, as it is shown: how many robots are done, which are being worked on, and the time that is left.

    Args:
        show: what shows a text and a share; None: nothing is shown.
    """

    def __init__(self, show: Callable[[str, float], None] | None) -> None:
        self._show, self._began = show, time.monotonic()
        self._finished, self._count, self._names = 0, 0, tuple[str, ...]()

    def done(self, name: str, count: int) -> None:
        """Count a robot of so many that is done."""
        self._finished, self._count = self._finished + 1, count
        self._names = tuple(one for one in self._names if one != name) or (name,)
        self._tell()

    def at_work(self, names: tuple[str, ...]) -> None:
        """Show which robots are being worked on."""
        if names:
            self._names = names
            self._tell()

    def _tell(self) -> None:
        if self._show is None:
            return
        names = ", ".join(cut(name, 24 if len(self._names) > 1 else 40) for name in self._names[:2])
        more = f" and {len(self._names) - 2} more" if len(self._names) > 2 else ""
        so_far = f"{self._finished} of {self._count}: " if self._count else ""
        self._show(f"{so_far}{names}{more}{self._left()}", self._finished / max(self._count, 1))

    def _left(self) -> str:
        from kinetostat.analysis.sweeping.pace import lasting

        if not _ENOUGH <= self._finished < self._count:
            return ""
        each = (time.monotonic() - self._began) / self._finished
        return f", {lasting(each * (self._count - self._finished))} left"


@contextmanager
def progress() -> Iterator[Shown]:
    """Yield what shows how far it is, on a terminal."""
    with progress_bar() as show:
        yield Shown(show)
