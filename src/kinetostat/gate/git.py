"""Asking git: which files have changed, and what a file was."""

from __future__ import annotations

import subprocess
from pathlib import Path

from kinetostat.errors import SourceError, UsageError, cut, quote

__all__ = ["changed_files", "git"]

_SECONDS = 60


def git(arguments: list[str], folder: Path) -> bytes:
    """Return what a git command writes.

    Raises:
        SourceError: there is no git, no repository, or the command fails.
    """
    # Robot repositories are untrusted: no hook, no pager, no file-system monitor of theirs is run.
    safe = ["-c", "core.fsmonitor=false", "-c", "core.hooksPath=/dev/null", "--no-pager"]
    try:
        run = subprocess.run(["git", "-C", str(folder), *safe, *arguments], capture_output=True, timeout=_SECONDS)  # noqa: S603, S607, PLW1510
    except FileNotFoundError:
        raise SourceError("git is not installed", remedy="install git") from None
    except subprocess.TimeoutExpired:
        raise SourceError(f"git gave no answer within {_SECONDS} s", file=str(folder)) from None
    if run.returncode:
        reason = run.stderr.decode(errors="replace").strip().splitlines()
        raise SourceError(f"git: {cut(reason[-1] if reason else 'failed', 200)}", file=str(folder))
    return run.stdout


def changed_files(revision: str, folder: Path) -> frozenset[Path]:
    """Return the files that differ from a revision, untracked ones included, deleted ones too.

    Raises:
        UsageError: a revision that cannot be one.
        SourceError: no repository, no such revision.
    """
    if not revision or revision.startswith("-"):
        raise UsageError(f"{quote(revision)} is not a revision", remedy="for instance origin/main")
    top = Path(git(["rev-parse", "--show-toplevel"], folder).decode().rstrip("\n"))
    differing = git(["diff", "--name-only", "--no-renames", "--no-ext-diff", "-z", revision, "--"], top)
    untracked = git(["ls-files", "--others", "--exclude-standard", "-z"], top)
    names = [name for name in (differing + untracked).decode(errors="surrogateescape").split("\0") if name]
    return frozenset(top.resolve() / name for name in names)
