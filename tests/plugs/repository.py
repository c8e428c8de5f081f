"""A copy of this repository as others would fetch it, and an environment in which its dependencies are at hand."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PARTS = ("pyproject.toml", "README.md", "LICENSE", ".pre-commit-hooks.yaml", "action.yml", "src", "cli", "robots")
GOOD = """<robot name="good">
  <link name="base"/>
  <link name="arm">
    <inertial>
      <origin xyz="0.2 0 0"/>
      <mass value="1.5"/>
      <inertia ixx="0.002" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <visual><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.1 0.1"/></geometry></visual>
    <collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.1 0.1"/></geometry></collision>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="arm"/>
    <origin xyz="0 0 0.3"/>
    <axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="20" velocity="1"/>
  </joint>
</robot>
"""
BAD = GOOD.replace('lower="-2" upper="2"', 'lower="2" upper="-2"')
BAD_LINE = 1 + BAD[: BAD.index("<limit")].count("\n")


def copied(folder: Path) -> Path:
    """Return a copy of the working tree, without what is not part of a release."""
    folder.mkdir()
    for part in PARTS:
        if (ROOT / part).is_dir():
            shutil.copytree(ROOT / part, folder / part, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / part, folder / part)
    return folder


def environment(home: Path) -> dict[str, str]:
    """Return an environment with a home of its own, in which pip finds our dependencies installed.

    Installing kinetostat then takes seconds; what it is built with is fetched.
    """
    home.mkdir()
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("GIT_", "PYTHON", "PRE_COMMIT"))}
    packages = [path for path in sys.path if "site-packages" in path]
    who = {f"GIT_{role}_{what}": "t@t" for role in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    return (
        kept
        | who
        | {
            "HOME": str(home),
            "PRE_COMMIT_HOME": str(home / "pre-commit"),
            "GIT_CONFIG_NOSYSTEM": "1",
            "PYTHONPATH": os.pathsep.join(packages),
            "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]),
        }
    )


def run(*command: str, folder: Path, env: dict[str, str], code: int | None = 0) -> str:
    """Run a program and return all that it says; it must exit with `code`, if that is given."""
    done = subprocess.run(
        command,
        cwd=folder,
        env=env,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        timeout=300,
        check=False,
    )
    if code is not None and done.returncode != code:
        pytest.fail(f"{command} exited with {done.returncode}:\n{done.stdout}")
    return done.stdout


def committed(folder: Path, env: dict[str, str]) -> str:
    """Make a folder a git repository with all its files, if it is none, commit, and return the revision."""
    if not (folder / ".git").exists():
        run("git", "init", "-q", ".", folder=folder, env=env)
    run("git", "add", "--all", folder=folder, env=env)
    run("git", "commit", "-q", "-m", "all", "--no-verify", folder=folder, env=env)
    return run("git", "rev-parse", "HEAD", folder=folder, env=env).strip()
