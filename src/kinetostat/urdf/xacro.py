"""xacro files to URDF text, through the `xacro` package of its ROS maintainers (an extra; no ROS is needed).

A xacro file is a program. Its files are opened only through the gate that robot files pass (regular, bounded, no
DOCTYPE) and only inside the packages that it names or lies in. Its expressions are evaluated by the xacro package,
which allows no builtins; still, expand only xacro that you would run.
"""

from __future__ import annotations

import contextlib
import errno
import io
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from kinetostat.errors import KinetostatError, SourceError, XmlError, printable
from kinetostat.urdf.document import parse
from kinetostat.urdf.files import read_file
from kinetostat.urdf.packages import Packages

__all__ = ["expand", "is_xacro"]


def is_xacro(path: Path) -> bool:
    """Whether a file is named as xacro."""
    return path.suffix.lower() == ".xacro"


def expand(path: Path, packages: Packages, arguments: Mapping[str, str], max_bytes: int) -> bytes:
    """Return the URDF that a xacro file expands to.

    Raises:
        SourceError: the xacro package is not installed, or a file may not be opened.
        XmlError: the file is not well-formed, or xacro cannot expand it.
    """
    try:
        import xacro
        import xacro.substitution_args
    except ImportError:
        raise SourceError(
            "xacro files need the xacro package", file=str(path), remedy="pip install 'kinetostat[xacro]'"
        ) from None
    try:
        with _gate(xacro, path, packages, max_bytes), contextlib.redirect_stderr(io.StringIO()):
            document = xacro.process_file(str(path), mappings=dict(arguments))
            # xacro leaves no white space: in one long line neither a finding nor a comment would have a place.
            expanded: bytes = document.toprettyxml(indent="  ", encoding="utf-8")
    except KinetostatError:
        raise
    except RecursionError:
        message = "the xacro macros call themselves without end"
        raise XmlError(message, file=str(path), remedy="give the recursion an end") from None
    except Exception as error:
        if isinstance(cause := getattr(error, "exc", None), KinetostatError):
            raise cause from None
        # xacro lets whatever its expressions raise come through, so the net is wide; SystemExit is not in it.
        reason = printable(" ".join(str(error).split())) or type(error).__name__
        message = f"xacro cannot expand the file: {reason[:300]}"
        raise XmlError(message, file=str(path), remedy="does it need --xacro-arg or --package-dir?") from None
    return expanded


@contextlib.contextmanager
def _gate(xacro: Any, path: Path, packages: Packages, max_bytes: int) -> Iterator[None]:
    """Let xacro find packages as we do, and open files only through us, while it runs."""
    # A link into a source tree (colcon --symlink-install) may include what lies beside its target.
    allowed = [packages.home().resolve(), Packages(path.resolve()).home()]

    def find(name: str) -> str:
        folder = packages.find(name)
        if folder is None:
            raise SourceError(
                f"xacro asks for package {printable(name)!r}, which is not found",
                file=str(path),
                remedy="use --package-dir",
            )
        allowed.append(folder.resolve())
        return str(folder)

    def open_gated(name: str, *_: object) -> io.StringIO | io.BytesIO:
        wanted = Path(name)
        if not any(wanted.resolve().is_relative_to(folder) for folder in allowed):
            raise SourceError(
                f"xacro asks for {printable(name)}, outside its package", file=str(path), remedy="use --package-dir"
            )
        if not wanted.is_file():  # xacro itself answers for optional includes
            raise FileNotFoundError(errno.ENOENT, "no such file", name)
        data = read_file(wanted, str(wanted), max_bytes)
        if wanted.suffix.lower() in (".yaml", ".yml"):
            return io.StringIO(data.decode("utf-8", "replace"))
        parse(data, str(wanted))
        return io.BytesIO(data)

    arguments = xacro.substitution_args
    before = arguments._eval_find
    arguments._eval_find = arguments._eval_dict["find"] = find
    xacro.open = open_gated  # a module global comes before the builtin of that name
    try:
        yield
    finally:
        del xacro.open
        arguments._eval_find = arguments._eval_dict["find"] = before
