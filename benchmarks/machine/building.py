"""Programs in C++, built once for each state of their source and kept in the user's cache folder."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

from platformdirs import user_cache_path

FLAGS = ("-std=c++17", "-O3", "-march=native", "-DNDEBUG", "-w")


def built(source: Path, more: tuple[str, ...] = ()) -> str:
    """Return the program of a source, built where it is not yet.

    Raises:
        OSError: no compiler.
        subprocess.CalledProcessError: it does not compile.
    """
    state = [source.read_bytes(), *(header.read_bytes() for header in sorted(source.parent.glob("*.hpp")))]
    key = hashlib.sha256(b"".join([*state, repr((FLAGS, more)).encode()])).hexdigest()[:16]
    folder = user_cache_path("kinetostat") / "benchmarks"
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    program = folder / f"{source.stem}-{key}"
    if not program.exists():
        print(f"building {source.name} (once, up to a minute) ...", file=sys.stderr)
        part = program.with_suffix(f".{os.getpid()}")
        subprocess.run(
            ["g++", *FLAGS, str(source), "-o", str(part), *more, "-ldl"], check=True, capture_output=True, text=True
        )
        part.rename(program)
    return str(program)
