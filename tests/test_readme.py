"""What the README shows is what a user gets: its commands are run and their output compared, its Python is run."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
CONSOLE = re.findall(r"```console\n\$ (.*?)\n(.*?)```", README, re.DOTALL)
# The last digits differ from processor to processor, and so do a few searches' ends; the rest may not.
# How fast a machine is, nobody can promise.
ROUNDING = re.compile(
    r"largest difference \S+,|(?<=fold) +\d+ +|(?<=tangential) +\d+ +|configurations in .* a second"
    r"|\S+ numbers computed twice, in .* s"
)


def output(line, folder):
    """Return what a command prints in a folder, standard error after standard output, as a terminal shows it."""
    (folder / "docs").symlink_to(Path(__file__).parents[1] / "docs")
    words = shlex.split(line)
    assert words[0] == "kinetostat"
    run = subprocess.run(
        [sys.executable, "-m", "kinetostat_cli", *words[1:]], capture_output=True, text=True, check=False, cwd=folder
    )
    return run.stdout + run.stderr


@pytest.mark.parametrize(("line", "shown"), CONSOLE, ids=[line for line, _ in CONSOLE])
def test_examples_print_what_the_readme_shows(line, shown, tmp_path):
    assert ROUNDING.sub("", output(line, tmp_path)) == ROUNDING.sub("", shown)


def test_there_are_thirteen_examples():
    assert len(CONSOLE) == 13


def test_the_python_of_the_readme_runs():
    blocks = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    assert len(blocks) == 1
    run = subprocess.run([sys.executable, "-c", blocks[0]], capture_output=True, text=True, check=False)
    assert run.stderr == ""
    lines = run.stdout.splitlines()
    assert lines[0].endswith("(6, 7)")
    assert lines[1].startswith("True ")
    assert lines[2:4] == ["(100, 3)", "(100,)"]
    assert lines[4:6] == ["panda_joint2", "True"]
    assert "shoulder" in lines[6]
    quantile, near = map(float, lines[7].split())
    assert 0 < quantile < 1
    assert 0 < near < 0.1
    assert 0.9 < float(lines[8]) < 1.0


def test_every_command_is_in_the_readme():
    from kinetostat_cli.main import COMMANDS

    assert [name for name in COMMANDS if f"kinetostat {name}" not in README] == []


def test_the_policy_of_the_readme_is_one(tmp_path):
    from kinetostat import read_settings

    blocks = re.findall(r"```toml\n(.*?)```", README, re.DOTALL)
    (tmp_path / "kinetostat.toml").write_text("\n".join(blocks))
    (robot,) = read_settings(tmp_path / "kinetostat.toml").robots
    assert [expectation.kind for expectation in robot.expect] == ["holds", "golden"]
    assert [chain.name for chain in robot.chains] == ["left arm"]


def test_the_readme_counts_rules_and_kinds_right():
    from kinetostat.lint.registry import RULES
    from kinetostat.policy.expectations import KINDS

    assert f"asks {len(RULES)} rules" in README
    assert len(KINDS) == 14
    assert "fourteen kinds" in README
