"""The real command line in a process of its own: exit code, both streams, processor time, peak memory.

Time is processor time, because neighbours on a busy machine do not count in it; what sleeps for ever meets the alarm.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ALARM = 60  # seconds on the clock after which the command is killed
ADDRESS_SPACE = 8 * 1024**3  # a runaway must not take the machine with it

# Linux counts the memory of the process that forked towards the peak of the one that it became: pytest has hundreds of
# MB. So a bare interpreter stands in between.
_LAUNCHER = """
import json, os, resource, signal, sys, time
report, alarm, space, *command = sys.argv[1:]
child = os.fork()
if child == 0:
    resource.setrlimit(resource.RLIMIT_AS, (int(space), int(space)))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    os.execv(command[0], command)
signal.signal(signal.SIGALRM, lambda *_: os.kill(child, signal.SIGKILL))
signal.alarm(int(alarm))
start = time.monotonic()
_, status, used = os.wait4(child, 0)
scale = 2**20 if sys.platform == "darwin" else 2**10
measured = {
    "exit_code": os.waitstatus_to_exitcode(status),
    "seconds": used.ru_utime + used.ru_stime,
    "elapsed": time.monotonic() - start,
    "megabytes": used.ru_maxrss / scale,
}
with open(report, "w") as file:
    json.dump(measured, file)
"""


@dataclass(frozen=True)
class Run:
    """What a command did. A negative exit code is the signal that ended it."""

    exit_code: int
    seconds: float
    elapsed: float
    megabytes: float
    out: str
    err: str


def kinetostat(
    *arguments: str | Path,
    stdin: bytes | Path = b"",
    cwd: Path | None = None,
    alarm: int = ALARM,
    environment: dict[str, str] | None = None,
) -> Run:
    """Run the command line and measure it. `stdin` is what it reads, or a file that it reads from."""
    with tempfile.TemporaryDirectory() as folder:
        report, given = Path(folder, "report.json"), Path(folder, "stdin")
        if isinstance(stdin, bytes):
            given.write_bytes(stdin)
        source_of_input = stdin if isinstance(stdin, Path) else given
        with source_of_input.open("rb") as source:
            command = [sys.executable, "-P", "-m", "kinetostat_cli", *map(str, arguments)]
            done = subprocess.run(
                [sys.executable, "-I", "-S", "-c", _LAUNCHER, str(report), str(alarm), str(ADDRESS_SPACE), *command],
                stdin=source,
                capture_output=True,
                cwd=cwd,
                env=os.environ | (environment or {}),
                timeout=alarm + 30,
                check=False,
            )
        assert report.is_file(), done.stderr.decode("utf-8", "replace")
        measured = json.loads(report.read_text())
    return Run(**measured, out=done.stdout.decode(), err=done.stderr.decode())


def assert_clean(run: Run, *, seconds: float = 10.0, megabytes: float = 1024.0) -> None:
    """Check what holds for every file: in time, in memory, printable, no traceback, never a bug of ours."""
    assert "Traceback" not in run.out + run.err
    assert unprintable(run.out) == unprintable(run.err) == set()
    assert run.exit_code in (0, 3), (run.exit_code, run.err[-500:])
    assert run.seconds < seconds
    assert run.megabytes < megabytes


def assert_refused(run: Run, name: str, why: str, *, seconds: float = 5.0, megabytes: float = 500.0) -> None:
    """Check that a file was refused: exit 3, one line that names it and says why, soon and in little memory."""
    assert_clean(run, seconds=seconds, megabytes=megabytes)
    assert run.exit_code == 3
    assert_one_line(run.err, name)
    assert why in run.err
    assert run.out == ""


def assert_one_line(err: str, name: str) -> None:
    """Check that an error is one line of bearable length that names the file."""
    assert err.startswith("kinetostat: error: ")
    assert err.count("\n") == 1
    assert err.endswith("\n")
    assert name in err
    assert len(err) < 1000


def unprintable(text: str) -> set[str]:
    """Return the characters that could move a terminal's cursor, colour it or hide text."""
    return {character for character in text if not character.isprintable() and character != "\n"}
