"""`make gallery`: draw docs/gallery/ and write docs/gallery.md, a picture of each kind with what makes it."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import kinetostat as ks
from kinetostat.analysis.profile.limbs import limbs
from kinetostat.analysis.profile.profiling import profile
from kinetostat.report import figures

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kinetostat.analysis.profile.result import RobotProfile

DOCS = Path(__file__).parent
FOLDER = DOCS / "gallery"
KINETOSTAT = Path(sys.executable).with_name("kinetostat")
ARM = DOCS.parent / "robots" / "planar_2r_6_3.urdf"
L1, L2 = 6.0, 3.0  # m, of its links
RADII = (3.4, 4.4, 5.4, 6.4, 7.4, 8.4)  # m, between L1 - L2 and L1 + L2
HEAD = """# Gallery

Every picture is made from a result by one module, `kinetostat.report.figures`, in one style: SVG whose text is text, to
scale, with units on every axis, in colours that are told apart without colour vision and in grey. `make gallery` draws
this page. In the page that `kinetostat report` writes, pictures follow the reader's light or dark theme.
"""


@dataclass(frozen=True)
class Picture:
    """A picture: its file's stem, its title, what it shows, and what draws it: a command with --plot, or a function."""

    stem: str
    title: str
    text: str
    drawn: str | Callable[[], Figure]


@cache
def profiled(robot: str | Path) -> RobotProfile:
    """Return what a report knows of a robot."""
    model = ks.load(robot)
    return profile(model, limbs(model))


@cache
def endless() -> RobotProfile:
    """Return what a report knows of the 2R arm without its limits."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / ARM.name
        path.write_text(without_limits(ARM.read_text(encoding="utf-8")), encoding="utf-8")
        return profiled(path)


def without_limits(urdf: str) -> str:
    """Return a robot whose turning joints turn without end."""
    return re.sub(r' (lower|upper)="[^"]*"', "", urdf.replace('type="revolute"', 'type="continuous"'))


def along_a_radius() -> np.ndarray:
    """Return configurations (6, 2) of the 2R arm that put its tool on the x axis, elbow up, by the law of cosines."""
    r = np.array(RADII)
    q2 = -np.arccos((r**2 - L1**2 - L2**2) / (2 * L1 * L2))
    q1 = -np.arctan2(L2 * np.sin(q2), L1 + L2 * np.cos(q2))
    return np.stack([q1, q2], axis=-1)


def reach(robot: str) -> Callable[[], Figure]:
    """Return what draws where a robot's first limb gets."""
    return lambda: figures.reach_figure(profiled(robot).limbs[0])


PICTURES = (
    Picture(
        "annulus",
        "Where a 2R arm gets, and how well",
        "Links of 6 m and 3 m, joints without limits. det J = 18 sin q2: singular on the circles of radius 9 and 3.",
        lambda: figures.reach_figure(endless().limbs[0]),
    ),
    Picture(
        "clipped",
        "The same with limits",
        "`kinetostat report textbook:planar_2r_6_3 -o report`: 0 to 135 and 0 to 120 degrees. Of the outer circle an "
        "arc is left; the rest of the edge is where a joint is at a limit.",
        reach("textbook:planar_2r_6_3"),
    ),
    Picture(
        "radius",
        "Velocity ellipses along a radius",
        "They do not depend on the first joint, and become flat towards both circles.",
        lambda: figures.ellipses_figure(endless().model, "tool", along_a_radius()),
    ),
    Picture(
        "ur5",
        "Where a UR5 gets",
        "`kinetostat report example:ur5_robot -o report`: two joints sweep a plane, all others are held.",
        reach("example:ur5_robot"),
    ),
    Picture(
        "panda",
        "Named poses of a Panda",
        "`kinetostat report example:panda -o report`: all to one scale, with the ellipsoids of velocity and force.",
        lambda: figures.poses_figure(profiled("example:panda").model, profiled("example:panda").limbs[0]),
    ),
    Picture(
        "distributions",
        "How indices are distributed inside limits, and where named poses stand",
        "`kinetostat report example:panda -o report`.",
        lambda: figures.distributions_figure(profiled("example:panda").limbs[0]),
    ),
    Picture(
        "tree",
        "The tree of a humanoid",
        "`kinetostat report example:talos_reduced -o report`: limbs in their colours.",
        lambda: figures.tree_figure(
            profiled("example:talos_reduced").model.robot, [one.limb for one in profiled("example:talos_reduced").limbs]
        ),
    ),
    Picture(
        "arm",
        "Ellipsoids of manipulability",
        "Of velocity and of force, from two sides.",
        "manipulability example:ur5_robot -f tool0 -q 0.3,-1.2,1.4,-0.4,0.9,0",
    ),
    Picture(
        "slice",
        "Singular configurations over two joints",
        "The smallest singular value, singular curves, limits.",
        "singular find example:ur5_robot -f tool0 --deg",
    ),
    Picture(
        "polytope",
        "What a tool can push",
        "All forces that effort limits allow, weight counted.",
        "torque example:ur5_robot -f tool0 -q 0.3,-1.2,1.4,-0.4,0.9,0 --gravity --max all",
    ),
    Picture(
        "sweep",
        "How measures are distributed",
        "Over a million configurations.",
        "sweep example:ur5_robot -f tool0 --samples 1M --measures yoshikawa,minimum_singular_value,effort_use",
    ),
    Picture(
        "map",
        "Where a tool gets, by voxels",
        "Ten million configurations, counted.",
        "map example:ur5_robot -f tool0 --samples 10M",
    ),
    Picture(
        "trajectory",
        "A motion, and where it comes near a singularity",
        "The 2R arm of the README, stretching.",
        "trajectory textbook:planar_2r docs/stretching.csv -f tool --axes x y",
    ),
)


def drawn(picture: Picture) -> str:
    """Draw a picture; return what stands in the page."""
    path = FOLDER / f"{picture.stem}.svg"
    lines = [f"## {picture.title}", "", picture.text, ""]
    if isinstance(picture.drawn, str):
        words = [*shlex.split(picture.drawn), "--plot", path.relative_to(DOCS.parent).as_posix()]
        subprocess.run([KINETOSTAT, *words], check=True, cwd=DOCS.parent, stdout=subprocess.DEVNULL)  # noqa: S603
        lines += ["```console", f"$ kinetostat {shlex.join(words)}", "```", ""]
    else:
        figures.save(picture.drawn(), path)
    print(f"{path.name:<20} {path.stat().st_size / 1000:6.0f} kB", flush=True)
    return "\n".join([*lines, f"![{picture.title}](gallery/{path.name})", ""])


def main() -> None:
    """Draw all, and write the page."""
    FOLDER.mkdir(exist_ok=True)
    sections = [drawn(picture) for picture in PICTURES]
    (DOCS / "gallery.md").write_text("\n".join([HEAD, *sections]), encoding="utf-8")


if __name__ == "__main__":
    main()
