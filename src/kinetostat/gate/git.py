"""Asking git. It runs no hook, asks nobody, fetches nothing, takes no lock: a repository of robots is untrusted."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from kinetostat.errors import SourceError, printable

__all__ = ["ask_git"]

_SECONDS = 60
_SAFE = ("-c", "core.hooksPath=/dev/null", "-c", "core.fsmonitor=false", "-c", "protocol.allow=never")
_QUIET = {"GIT_TERMINAL_PROMPT": "0", "GIT_OPTIONAL_LOCKS": "0", "GIT_NO_LAZY_FETCH": "1", "LC_ALL": "C"}


def ask_git(words: list[str], folder: Path, *, about: str, given: bytes = b"") -> bytes | None:
    """Return what a git command writes; None if it fails.

    Args:
        words: the command and its arguments; what users give stands behind --end-of-options or --.
        folder: where it is run.
        about: what the question is about, for errors.
        given: its standard input.

    Raises:
        SourceError: there is no git, it does not answer, or it refuses the repository.
    """
    command = ["git", "--no-pager", "--literal-pathspecs", *_SAFE, *words]
    environment = {**os.environ, **_QUIET}
    try:
        done = subprocess.run(  # noqa: S603 (a list of words, no shell)
            command, cwd=folder, env=environment, input=given, capture_output=True, timeout=_SECONDS, check=False
        )
    except FileNotFoundError:
        raise SourceError("the git program is not installed", file=about, remedy="install git, or give files") from None
    except (OSError, subprocess.TimeoutExpired) as error:
        message = f"git does not answer: {printable(str(error))[:100]}"
        raise SourceError(message, file=about, remedy="give files") from None
    if b"dubious ownership" in done.stderr:
        remedy = "git config --global --add safe.directory FOLDER, if you trust it"
        raise SourceError("git refuses the repository: it belongs to someone else", file=about, remedy=remedy)
    return done.stdout if done.returncode == 0 else None
