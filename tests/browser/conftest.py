"""A browser for the tests that look at pages: the system's Chromium, headless, through its own path.

Where there is none these tests are skipped, with the reason; KINETOSTAT_BROWSER=required (CI) makes that a failure.
"""

import os
import shutil
from contextlib import ExitStack

import pytest

from browser.visiting import Visit

NAMES = ("chromium", "chromium-browser", "google-chrome")
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


def missing(reason):
    """Skip the test, or fail it where a browser is required."""
    if os.environ.get("KINETOSTAT_BROWSER") == "required":
        pytest.fail(f"{reason}, and KINETOSTAT_BROWSER=required", pytrace=False)
    pytest.skip(reason)


@pytest.fixture(scope="session")
def browser():
    """A browser with a new profile, of which tests make pages and contexts; it is closed when they are over."""
    program = next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        missing(f"no browser: none of {', '.join(NAMES)} is installed (apt-get install chromium)")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        missing("no driver for the browser: pip install playwright")
    with sync_playwright() as playwright, playwright.chromium.launch(executable_path=program, args=FLAGS) as browser:
        yield browser


@pytest.fixture
def visited(browser):
    """What opens a page, given its address, in a tab of its own; all are closed when the test is over."""
    with ExitStack() as visits:

        def opened(uri, **how):
            visit = Visit(browser, uri, **how)
            visits.callback(visit.context.close)
            return visit

        yield opened
