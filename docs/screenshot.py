"""`make screenshot`: write the report of some arms and robots, and save the top of its page as docs/report.png."""

from __future__ import annotations

import io
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

PICTURE = Path(__file__).with_name("report.png")
KINETOSTAT = Path(sys.executable).with_name("kinetostat")
ROBOTS = (
    *("ur10_robot", "kinova", "ur5_robot", "panda", "xarm7", "z1", "ur3_robot", "so100"),
    *("baxter", "tiago", "talos_left_arm", "iris"),
)
WIDTH = 1200  # px
HEAD = ("header.head", "#fleet", "section.thumbnails")  # what the picture shows, from the page's top
COLOURS = 256  # of its palette
MOST = 300_000  # bytes


def report(folder: Path) -> Path:
    """Write the report; return its page."""
    robots = [f"example:{name}" for name in ROBOTS]
    subprocess.run([KINETOSTAT, "report", *robots, "-o", folder], check=True, stdout=subprocess.DEVNULL)  # noqa: S603
    return folder / "index.html"


def photographed(page: Path) -> bytes:
    """Return the top of a page as a PNG."""
    program = shutil.which("chromium") or shutil.which("google-chrome")
    if program is None:
        raise SystemExit("no browser: apt-get install chromium")
    with sync_playwright() as playwright, playwright.chromium.launch(executable_path=program) as browser:
        tab = browser.new_page(viewport={"width": WIDTH, "height": 1200}, color_scheme="light")
        tab.goto(page.as_uri())
        boxes = [tab.locator(part).bounding_box() for part in HEAD]
        bottom = max(box["y"] + box["height"] for box in boxes if box)
        return tab.screenshot(full_page=True, clip={"x": 0, "y": 0, "width": WIDTH, "height": bottom + 12})


def main() -> None:
    """Make the picture."""
    with tempfile.TemporaryDirectory() as folder:
        shot = Image.open(io.BytesIO(photographed(report(Path(folder))))).convert("RGB")
    shot.quantize(COLOURS, dither=Image.Dither.NONE).save(PICTURE, optimize=True)
    size = PICTURE.stat().st_size
    print(f"{PICTURE.name}: {shot.width} x {shot.height} px, {size / 1000:.0f} kB")
    if size > MOST:
        raise SystemExit(f"more than {MOST / 1000:.0f} kB")


if __name__ == "__main__":
    main()
