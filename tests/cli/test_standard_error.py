"""Standard error that is closed or full: what a command finds out, and its exit code, stay as they are."""

import io
import subprocess
import sys
from pathlib import Path

import pytest

from kinetostat_cli.console import progress_bar, say

ROBOT = "textbook:planar_2r"


def run(redirection, *words):
    command = ["sh", "-c", f'exec "$@" 2>{redirection}', "sh", sys.executable, "-m", "kinetostat_cli", *words]
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, timeout=120, check=False)


FULL = pytest.param(
    "/dev/full", marks=pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
)


@pytest.mark.parametrize("redirection", ["&-", FULL])
def test_a_robot_that_passes_passes_and_its_report_is_whole(redirection):
    usual, here = run("/dev/null", "check", ROBOT), run(redirection, "check", ROBOT)
    assert (usual.returncode, here.returncode) == (0, 0)
    assert here.stdout == usual.stdout
    assert "1 file: 1 passed" in here.stdout


@pytest.mark.parametrize("redirection", ["&-", FULL])
def test_an_error_keeps_its_exit_code(redirection):
    there_is_none = run(redirection, "check", "nowhere.urdf")
    assert (there_is_none.returncode, there_is_none.stdout) == (3, "")


def test_nothing_is_said_and_no_bar_is_drawn_where_there_is_none(monkeypatch, capsys):
    monkeypatch.setattr(sys, "stderr", None)
    say("warning", "nobody hears this")
    with progress_bar() as bar:
        assert bar is None
    assert capsys.readouterr().out == ""


def test_a_stream_that_is_closed_is_no_error(monkeypatch):
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    say("warning", "heard")
    assert stream.getvalue() == "kinetostat: warning: heard\n"
    monkeypatch.setattr(stream, "isatty", lambda: False)
    stream.close()
    say("warning", "nobody hears this")


def test_what_a_message_quotes_is_no_command_of_github(capsys):
    say("error", "there is no frame '##[add-mask]x'")
    assert capsys.readouterr().err == "kinetostat: error: there is no frame '##\\x5badd-mask]x'\n"
