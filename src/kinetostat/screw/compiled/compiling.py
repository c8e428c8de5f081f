"""How functions of this package are compiled, and where the compiled code is kept.

Code is kept in the user's cache folder (`XDG_CACHE_HOME`, by default `~/.cache/kinetostat`), a folder for each state of
the sources: Numba looks at the file of one function only to see whether its code is old, and a kernel is made of many
files. Several processes may compile at once: Numba writes beside and renames. Where that folder cannot be written,
every process compiles for itself, in a folder of its own: nobody runs code that somebody else could have put there.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import tempfile
from pathlib import Path
from typing import Any

import numba
from platformdirs import user_cache_path

__all__ = ["LANES", "compiled"]

LANES = 128  # configurations that are computed side by side: 16 vectors of 8 numbers; their scratch stays in the caches


def _sources() -> str:
    """Return what tells one state of the sources (and of Numba) from another."""
    texts = [path.read_bytes() for path in sorted(Path(__file__).parent.glob("*.py"))]
    return hashlib.sha256(b"\0".join([numba.__version__.encode(), *texts])).hexdigest()[:16]


def _folder() -> Path:
    """Return a folder that we may write, and nobody else."""
    wanted = user_cache_path("kinetostat") / "compiled" / _sources()
    try:
        wanted.mkdir(parents=True, exist_ok=True, mode=0o700)
        ours = wanted.stat().st_uid == os.getuid() and not wanted.stat().st_mode & 0o022
        with tempfile.TemporaryFile(dir=wanted):
            pass
    except OSError:
        ours = False
    if ours:
        return wanted
    own = Path(tempfile.mkdtemp(prefix="kinetostat-"))
    atexit.register(shutil.rmtree, own, ignore_errors=True)
    return own


numba.config.CACHE_DIR = str(_folder())

# contract: a product and a sum may be one instruction, rounded once. No other liberty: sums keep their order, so that
# the same processor gives the same bits whatever is computed beside. numpy: a division by zero is infinite.
compiled: Any = numba.njit(cache=True, nogil=True, fastmath={"contract"}, error_model="numpy")
