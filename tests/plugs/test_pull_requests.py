"""A repository of three robots with a policy, and the pull requests that its gate has to catch, each with a line."""

import contextlib
import shutil
import subprocess

import pytest

from cli.conftest import Outcome
from kinetostat.urdf.files import example_robots
from kinetostat_cli.main import run

ROBOTS = {
    "panda": "panda_description/panda",
    "ur5": "ur_description/ur5_robot",
    "dog": "solo_description/solo",
}

GOLDEN = """
[[robots]]
path = "robots/ur5.urdf"
[[robots.expect]]
kind = "golden"
file = "tool0.json"
"""


def git(folder, *words):
    identity = ["-c", "user.name=a", "-c", "user.email=a@b.c"]
    subprocess.run(["git", "-C", str(folder), *identity, *words], check=True, capture_output=True)


@pytest.fixture(scope="module")
def first_commit(tmp_path_factory):
    """The repository at its first commit: robots, what `init` writes, a golden tool frame, a baseline."""
    folder = tmp_path_factory.mktemp("repository")
    git(folder, "init", "-q", "-b", "main")
    examples = example_robots()
    (folder / "robots").mkdir()
    for name, example in ROBOTS.items():
        shutil.copy(examples[example], folder / "robots" / f"{name}.urdf")
    with contextlib.chdir(folder):
        assert run(["init", *(f"robots/{name}.urdf" for name in ROBOTS), "-o", "kinetostat.toml"]) == 0
        q = "0.3,-1,1,0.2,0.5,0"
        assert run(["fk", "robots/ur5.urdf", "-f", "tool0", "-q", q, "-F", "json", "-o", "tool0.json"]) == 0
        with (folder / "kinetostat.toml").open("a") as policy:
            policy.write(
                '\n[[robots]]\npath = "robots/ur5.urdf"\n[[robots.expect]]\nkind = "golden"\nfile = "tool0.json"\n'
            )
        assert run(["check", "--write-baseline", "known.json"]) == 0
    git(folder, "add", "-A")
    git(folder, "commit", "-qm", "robots")
    return folder


@pytest.fixture
def cli(capsys):
    """The command line, run in this process."""

    def call(*words):
        capsys.readouterr()
        code = run(list(words))
        return Outcome(code, *capsys.readouterr())

    return call


@pytest.fixture
def repository(first_commit, tmp_path, monkeypatch):
    """A clone of it, to work in."""
    folder = tmp_path / "work"
    shutil.copytree(first_commit, folder)
    monkeypatch.chdir(folder)
    return folder


def test_what_is_there_passes(repository, cli):
    found = cli("check", "--baseline", "known.json")
    assert found.code == 0, found.out
    assert "3 files: 3 passed" in found.out
    assert cli("check", "--changed-since", "main").code == 0


CASES = {
    "a mimic joint": (
        "panda",
        ('<mimic joint="panda_finger_joint1"/>', '<mimic joint="panda_finger_joint1" multiplier="-1"/>'),
        "'panda_finger_joint2'",
        "mimic multiplier",
    ),
    "an effort limit": ("ur5", ('effort="28.0"', 'effort="8.0"'), "'wrist_1_joint'", "28 -> 8"),
    "a tool frame by 2 mm": ("ur5", ("0 0.0823 0", "0 0.0843 0"), "'tool0' is 0.002 m", "0.002 m"),
}


@pytest.mark.parametrize("name", CASES)
def test_a_pull_request_that_breaks_a_robot_is_caught(repository, cli, name):
    robot, (old, new), said, difference = CASES[name]
    path = repository / "robots" / f"{robot}.urdf"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))  # of ee_link and of tool0 alike
    found = cli("check", "--changed-since", "main", "--baseline", "known.json")
    assert found.code == 1
    assert "1 file: 1 failed" in found.out
    assert "NOT MET" in found.out
    assert said in " ".join(found.out.split())
    compared = cli("diff", f"main:robots/{robot}.urdf", f"robots/{robot}.urdf")
    assert compared.code == 1
    assert difference in " ".join(compared.out.split())


def test_one_that_changes_no_meaning_passes(repository, cli):
    path = repository / "robots" / "ur5.urdf"
    path.write_text(path.read_text().replace("\n", "\n\n").replace("0.0823", "0.08230"))
    assert cli("check", "--changed-since", "main", "--baseline", "known.json").code == 0
    assert cli("diff", "main:robots/ur5.urdf", "robots/ur5.urdf").code == 0
