"""A browser that is not there skips these tests, with the reason; where one is required, they fail."""

import os
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.parametrize(("required", "code", "outcome"), [("", 0, "2 skipped"), ("required", 1, "2 errors")])
def test_a_browser_that_is_not_there(tmp_path, required, code, outcome):
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        Path(__file__).with_name("test_browser.py"),
    ]
    environment = {**os.environ, "PATH": str(tmp_path), "KINETOSTAT_BROWSER": required}
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == code, run.stdout
    assert outcome in run.stdout
    assert "no browser: none of chromium, chromium-browser, google-chrome is installed" in run.stdout
