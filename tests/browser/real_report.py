"""The report of real robots, written by the real command line."""

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from browser import hostile_robot

EXAMPLES = (
    *("ur5_robot", "panda", "z1", "kinova", "xarm7"),
    "baxter",  # two arms
    "talos_reduced",  # a humanoid
    "allegro_right_hand",
    "solo12",  # a quadruped
    "iris",  # a drone: rotors, no chain
    "ur3",  # cannot be read
)
OTHERS = ("textbook:planar_2r_6_3", "hostile.urdf", "terminal.urdf", "notes.urdf")
FAILED = ("example:ur3", "terminal.urdf", "notes.urdf")


@dataclass(frozen=True)
class Report:
    """What a command has written."""

    folder: Path
    code: int
    document: dict

    @property
    def uri(self):
        return (self.folder / "index.html").as_uri()

    @property
    def robots(self):
        return self.document["robots"]

    @property
    def rows(self):
        """Return what the table's rows are about, in their first order: a robot, and a chain or None."""
        return [(robot, chain) for robot in self.robots for chain in robot["chains"] or [None]]

    def robot(self, path):
        return next(robot for robot in self.robots if robot["path"] == path)


def written(folder):
    """Return the report of all robots, written by `kinetostat report`."""
    (folder / "hostile.urdf").write_text(hostile_robot.urdf(), encoding="utf-8")
    (folder / "hostile.srdf").write_text(hostile_robot.srdf(), encoding="utf-8")
    (folder / "terminal.urdf").write_text(hostile_robot.unreadable_urdf(), encoding="utf-8")
    (folder / "notes.urdf").write_text("This is not XML.\n", encoding="utf-8")
    program = "from kinetostat_cli.main import main; main()"
    robots = [f"example:{name}" for name in EXAMPLES] + list(OTHERS)
    command = [sys.executable, "-c", program, "report", *robots, "-o", "out", "--samples", "200", "--payload", "1"]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert run.stdout == "out/index.html\n", run.stderr
    return Report(folder / "out", run.returncode, json.loads((folder / "out" / "report.json").read_bytes()))
