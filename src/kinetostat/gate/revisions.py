"""Robot files at a revision of a git repository, `REV:path`, by the git program: its objects are read, no hook is run.

Blobs are read as they are stored: no filter, no checkout, no network, nothing written but a temporary folder. It gets
the file and what a reader looks for beside it: SRDFs; for a xacro file, all text files that it may include.
"""

from __future__ import annotations

import contextlib
import posixpath
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from kinetostat.errors import SourceError, cut, quote
from kinetostat.gate.git import ask_git
from kinetostat.urdf.files import MAX_BYTES

__all__ = ["Revision", "revision", "unpacked"]

_MOST_FILES = 5_000
_INCLUDED = (".xacro", ".urdf", ".srdf", ".yaml", ".yml")
_LINKS = 8  # symbolic links that are followed, one to the next


@dataclass(frozen=True)
class Revision:
    """A file at a revision, as it was asked for."""

    rev: str
    path: str

    def __str__(self) -> str:
        return f"{self.rev}:{self.path}"


@dataclass(frozen=True)
class _Blob:
    """A file of a tree: its mode (a link is 120000), the name of its object, its size."""

    mode: str
    object: str
    size: int


def revision(name: str) -> Revision | None:
    """Return the revision that a name asks for; None if it names a file, standard input, or a robot that ships."""
    rev, colon, path = name.partition(":")
    if not colon or name == "-" or rev in ("textbook", "example") or _exists(name):
        return None
    return Revision(rev, path)


def _exists(name: str) -> bool:
    try:
        return Path(name).exists()
    except (OSError, ValueError):  # too long, a NUL character
        return False


@contextlib.contextmanager
def unpacked(wanted: Revision, *, max_bytes: int = MAX_BYTES) -> Iterator[Path]:
    """Put a robot file at a revision, with what it may need, into a temporary folder; yield its path there.

    A path is looked for from the top of the repository, then from the current folder; `./path` from the latter alone.

    Args:
        wanted: the revision and the path.
        max_bytes: refuse more than that, of the file and of all files together.

    Raises:
        SourceError: no git, no repository, no such revision, no such path, no regular file, too big.
    """
    repository = _Repository.here(wanted)
    path = repository.located(wanted)
    files = {name: blob for name, blob in repository.needed(path).items() if not _is_odd(name)}
    if len(files) > _MOST_FILES or sum(blob.size for blob in files.values()) > max_bytes:
        raise SourceError(f"more than {_MOST_FILES} files or {max_bytes} bytes", file=str(wanted))
    with tempfile.TemporaryDirectory(prefix="kinetostat-") as folder:
        # Under the repository's own name, by which package:// and $(find) may ask for it.
        top = Path(folder).resolve() / (repository.top.name or "repository")
        for name, content in repository.contents(files).items():
            target = top / name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
        yield top / path


def _is_odd(name: str) -> bool:
    """Whether a name in a tree would not stay below the folder that it is put in. Git makes none."""
    parts = PurePosixPath(name).parts
    return name.startswith("/") or "\0" in name or any(part in ("..", ".git") for part in parts)


@dataclass(frozen=True)
class _Repository:
    """A repository at one commit, its files listed when first asked."""

    wanted: Revision
    top: Path
    prefix: str
    commit: str

    @classmethod
    def here(cls, wanted: Revision) -> _Repository:
        """Return the repository of the current folder, or of an absolute path's folder, at the revision."""
        if not wanted.rev or wanted.rev.startswith("-") or "\0" in f"{wanted}":
            raise _error(
                wanted, f"{quote(wanted.rev)} is no revision", "name a branch, a tag or a commit before the ':'"
            )
        if not wanted.path:
            raise _error(wanted, "no path after the ':'", "write REV:path/to/robot.urdf")
        start = Path.cwd()
        if wanted.path.startswith("/"):
            start = next((p for p in Path(wanted.path).parents if p.is_dir()), start)
        found = _git(wanted, start, "rev-parse", "--show-toplevel", "--show-prefix")
        if found is None:
            raise _error(wanted, f"{quote(str(start))} is in no git repository", "run it inside the repository")
        top, prefix = [*found.decode(errors="surrogateescape").split("\n"), ""][:2]
        commit = _git(wanted, start, "rev-parse", "--verify", "--quiet", "--end-of-options", f"{wanted.rev}^{{commit}}")
        if commit is None:
            remedy = "'git log' and 'git branch -a' show what there is; CI fetches one commit unless told otherwise"
            raise _error(wanted, f"the repository has no revision {quote(wanted.rev)}", remedy)
        return cls(wanted, Path(top), prefix, commit.decode().strip())

    def located(self, wanted: Revision) -> str:
        """Return where the path is in the tree, symbolic links followed inside it."""
        asked = wanted.path
        if asked.startswith("/"):
            with contextlib.suppress(OSError, RuntimeError):
                asked = str(Path(asked).parent.resolve() / Path(asked).name)
            tried = [posixpath.relpath(asked, self.top.resolve())]
        elif asked.startswith(("./", "../")):
            tried = [posixpath.join(self.prefix, asked)]
        else:
            tried = [asked, posixpath.join(self.prefix, asked)]
        for name in dict.fromkeys(map(posixpath.normpath, tried)):
            found = self._followed(name)
            if found is not None:
                return found
        raise _error(wanted, f"there is no file {quote(asked)} at {quote(wanted.rev)}", "check the path from the top")

    def _followed(self, name: str) -> str | None:
        for _ in range(_LINKS):
            if name.startswith(("/", "..")):
                return None
            entry = self._listed(name, whole=False).get(name)
            if entry is None:
                return None
            if entry.mode != "120000":
                return name
            target = self._blobs([entry.object])[0].decode(errors="surrogateescape")
            name = posixpath.normpath(posixpath.join(posixpath.dirname(name), target))
        return None

    def needed(self, path: str) -> dict[str, _Blob]:
        """Return the file and what a reader looks for beside it, links left out."""
        folder, own = posixpath.dirname(path), self._listed(path, whole=False)
        if PurePosixPath(path).suffix.lower() == ".xacro":
            listed = {n: e for n, e in self._listed("", whole=True).items() if _may_be_included(n)}
        else:
            beside = [folder, posixpath.join(posixpath.dirname(folder), "srdf")]
            listed = {
                name: entry
                for place in beside
                for name, entry in self._listed(f"{place}/" if place else "", whole=False).items()
                if name.endswith(".srdf")
            }
        return {name: entry for name, entry in {**listed, **own}.items() if entry.mode != "120000"}

    def _listed(self, place: str, *, whole: bool) -> dict[str, _Blob]:
        """Return the files of the commit at a path: a file, a folder that ends in /, or everything."""
        words = ["ls-tree", "-z", "--long", "--full-tree", *(["-r"] if whole else []), self.commit]
        out = self._asked([*words, *(["--", place] if place else [])])
        found = {}
        for line in out.split(b"\0"):
            about, tab, name = line.partition(b"\t")
            mode, kind, object_, size = [*about.decode().split(), "", "", "", ""][:4]
            if tab and kind == "blob":
                found[name.decode(errors="surrogateescape")] = _Blob(mode, object_, int(size))
        return found

    def contents(self, files: dict[str, _Blob]) -> dict[str, bytes]:
        """Return the contents of files, as they are stored."""
        return dict(zip(files, self._blobs([blob.object for blob in files.values()]), strict=True))

    def _blobs(self, objects: list[str]) -> list[bytes]:
        """Return blobs: `cat-file --batch` answers each with "object type size", a line break, its bytes, another."""
        out = self._asked(["cat-file", "--batch"], "".join(f"{name}\n" for name in objects).encode())
        blobs, at = [], 0
        for _ in objects:
            end = out.index(b"\n", at)
            about = out[at:end].split()
            if len(about) != 3:  # "missing": a clone that left its blobs on the server
                remedy = "this clone has not all files: 'git fetch --refetch', or clone without --filter"
                raise _error(self.wanted, "the file's contents are not in this repository", remedy)
            size = int(about[2])
            blobs.append(out[end + 1 : end + 1 + size])
            at = end + 2 + size
        return blobs

    def _asked(self, words: list[str], given: bytes = b"") -> bytes:
        out = _git(self.wanted, self.top, *words, given=given)
        if out is None:
            raise _error(self.wanted, f"git {words[0]} failed", "is the repository whole? 'git fsck' tells")
        return out


def _may_be_included(name: str) -> bool:
    return name.endswith(_INCLUDED) or posixpath.basename(name) == "package.xml"


def _git(wanted: Revision, folder: Path, *words: str, given: bytes = b"") -> bytes | None:
    """Return what git writes, None if it fails."""
    return ask_git(list(words), folder, about=cut(str(wanted)), given=given)


def _error(wanted: Revision, message: str, remedy: str) -> SourceError:
    return SourceError(message, file=cut(str(wanted)), remedy=remedy)
