"""What is done of a run, kept in a folder: written whole or not at all, so that a killed run loses nothing but seconds.

The folder has one file, `checkpoint.npz` (plain arrays, nothing pickled): which question, which chunks are done, what
they gave, and a SHA-256 of all that. It is written in one piece, so that no chunk is lost or counts twice, whenever the
run is killed. Who can write in the folder is not trusted: links are not followed, what is no file is not opened.
"""

from __future__ import annotations

import errno
import fcntl
import io
import os
import stat
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib.npyio import NpzFile

from kinetostat.analysis.sweeping.chunks import Chunks
from kinetostat.analysis.sweeping.digest import digest
from kinetostat.analysis.sweeping.work import P, State, Work
from kinetostat.errors import UsageError, quote

__all__ = ["Checkpoint", "open_checkpoint"]

_FORMAT = 2
_LARGEST = 2**32  # bytes
_FILE, _DRAFT, _LOCK = "checkpoint.npz", "checkpoint.npz.part", "lock"
_STATE = "state."
_UNREADABLE = (
    *(OSError, ValueError, TypeError, KeyError, IndexError, OverflowError, EOFError, MemoryError, NotImplementedError),
    *(RuntimeError, zipfile.BadZipFile, zlib.error),
)
_BUSY = (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES)

_NO_ODDITIES = os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC  # links, and pipes that nobody writes into

_locks = set[int]()  # descriptors of the folders that this process holds


def _let_go() -> None:
    # A process that is forked while a folder is held would hold it too, and for longer than the run if that is killed.
    for lock in _locks:
        with suppress(OSError):
            os.close(lock)
    _locks.clear()


os.register_at_fork(after_in_child=_let_go)


@dataclass(frozen=True, repr=False)
class Checkpoint:
    """The checkpoint of a folder that this run holds.

    Attributes:
        folder: the folder.
    """

    folder: Path

    def __repr__(self) -> str:
        return f"<Checkpoint in {quote(str(self.folder))}>"

    def read(self, work: Work[P]) -> tuple[P, Chunks] | None:
        """Return what the chunks that are done gave, and which they are; None where nothing is kept yet.

        Raises:
            UsageError: it is of another question, damaged, or no checkpoint.
        """
        try:
            kept = _arrays(self.folder / _FILE)
            version = int(kept["format"])
        except FileNotFoundError:
            return None
        except _UNREADABLE:
            raise self._damaged() from None
        if version != _FORMAT:
            raise self._refused("is of another version of kinetostat")
        try:
            if str(kept.pop("sum")) != _sum(kept):
                raise ValueError("not what was written")
            question, chunks, done = str(kept["digest"]), int(kept["chunks"]), Chunks.of(kept["done"])
        except _UNREADABLE:
            raise self._damaged() from None
        if (question, chunks) != (work.digest, work.chunks):
            raise self._refused("is of another question")
        try:
            if done.intervals and done.intervals[-1][1] > chunks:
                raise ValueError("more chunks than there are")
            state = {name.removeprefix(_STATE): array for name, array in kept.items() if name.startswith(_STATE)}
            return work.restore(state), done
        except _UNREADABLE:
            raise self._damaged() from None

    def write(self, work: Work[Any], state: State, done: Chunks) -> None:
        """Replace what is kept; where that fails, what was kept before stays whole.

        Raises:
            OSError: it cannot be written.
        """
        content = io.BytesIO()  # in memory first: what fails on a disk fails here, not inside a zip file's end
        kept: State = {
            "format": np.array(_FORMAT),
            "digest": np.array(work.digest),
            "chunks": np.array(work.chunks),
            "done": done.array(),
            **{_STATE + name: _plain(name, array) for name, array in state.items()},
        }
        whole: dict[str, Any] = {**kept, "sum": np.array(_sum(kept))}
        np.savez(content, **whole)
        draft = self.folder / _DRAFT
        try:
            draft.unlink(missing_ok=True)  # of a run that was killed; or a link, which is not to be followed
            with os.fdopen(os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666), "wb") as file:
                file.write(content.getbuffer())
                file.flush()
                os.fsync(file.fileno())
            draft.replace(self.folder / _FILE)
        except BaseException:
            with suppress(OSError):
                draft.unlink(missing_ok=True)
            raise
        _settle(self.folder)

    def _refused(self, why: str) -> UsageError:
        return UsageError(
            f"the checkpoint in {quote(str(self.folder))} {why}",
            remedy="give another folder, or remove this one to start anew",
        )

    def _damaged(self) -> UsageError:
        return UsageError(
            f"{quote(str(self.folder / _FILE))} is damaged, or no checkpoint",
            remedy="give another folder, or remove the file to start anew",
        )


@contextmanager
def open_checkpoint(folder: Path) -> Iterator[Checkpoint]:
    """Hold a folder, made if it is missing, for the checkpoint of one run; who is killed lets go of it.

    Raises:
        UsageError: it cannot be made or written in, or another run holds it.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = os.open(folder / _LOCK, os.O_RDWR | os.O_CREAT | _NO_ODDITIES, 0o666)
    except OSError as error:
        why = "its 'lock' is a link" if error.errno == errno.ELOOP else error.strerror
        raise UsageError(
            f"cannot keep a checkpoint in {quote(str(folder))}: {why}", remedy="give another folder"
        ) from None
    try:
        if not stat.S_ISREG(os.fstat(lock).st_mode):
            raise UsageError(
                f"cannot keep a checkpoint in {quote(str(folder))}: its 'lock' is no file", remedy="give another folder"
            )
        _hold(lock, folder)
        _locks.add(lock)
        yield Checkpoint(folder)
    finally:
        _locks.discard(lock)
        os.close(lock)


def _hold(lock: int, folder: Path) -> None:
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno not in _BUSY:
            why, remedy = f"cannot be held for one run alone: {error.strerror}", "give a folder on a local disk"
        else:
            why, remedy = "is in use by another run", "wait for it, or give another folder"
        raise UsageError(f"the checkpoint folder {quote(str(folder))} {why}", remedy=remedy) from None


def _arrays(path: Path) -> State:
    """Return everything in a file of arrays.

    Raises:
        FileNotFoundError: there is none.
        ValueError: it is no such file, too large, or one of Python objects; further ones of `_UNREADABLE` where it is
            damaged.
    """
    with os.fdopen(os.open(path, os.O_RDONLY | _NO_ODDITIES), "rb") as file:
        is_what = os.fstat(file.fileno())
        if not stat.S_ISREG(is_what.st_mode) or is_what.st_size > _LARGEST:
            raise ValueError("no file, or too large")
        content = io.BytesIO(file.read(is_what.st_size))
    loaded = np.load(content, allow_pickle=False)  # NumPy leaves a damaged file open
    if not isinstance(loaded, NpzFile):
        raise ValueError("one array")  # noqa: TRY004
    with loaded:
        if sum(entry.file_size for entry in zipfile.ZipFile(content).infolist()) > _LARGEST:
            raise ValueError("too large")
        return {name: loaded[name] for name in loaded.files}


def _sum(kept: State) -> str:
    """Return the SHA-256 of arrays and their names."""
    return digest(dict(sorted(kept.items())))


def _plain(name: str, array: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    if np.asarray(array).dtype.hasobject:
        raise TypeError(f"state {name!r} is an array of objects")
    return np.asarray(array)


def _settle(folder: Path) -> None:
    """Have the folder's own entry on the disk too, so that the new file is there after a loss of power."""
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(handle)
    except OSError as error:
        if error.errno != errno.EINVAL:  # a file system that cannot do it for folders
            raise
    finally:
        os.close(handle)
