"""The pytest plugin, as a repository of robot models uses it: pytest in a process of its own."""

import os
import subprocess
import sys

import pytest

from cli.test_check import GOOD, SWAPPED

TEST = """
import pytest


@pytest.mark.robot("good.urdf")
def test_its_joints(robot):
    assert [joint.name for joint in robot.robot.joints] == ["shoulder"]


@pytest.mark.robot("textbook:planar_2r")
def test_a_textbook_robot(robot):
    assert robot.robot.nv == 2


def test_without_a_mark(robot):
    pass
"""


@pytest.fixture
def repository(tmp_path):
    (tmp_path / "good.urdf").write_text(GOOD)
    (tmp_path / "bad.urdf").write_text(SWAPPED)
    return tmp_path


def run(folder, *arguments):
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-rA", *arguments]
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST")}
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, env=environment)


def test_robot_files_are_tests_when_asked_for(repository):
    found = run(repository, "--kinetostat")
    assert found.returncode == 1
    assert "1 failed, 1 passed" in found.stdout
    assert "lower 1.5 is above upper -1.5" in found.stdout
    assert "Traceback" not in found.stdout


def test_and_are_none_otherwise(repository):
    assert run(repository).returncode == 5  # nothing collected


def test_settings_beside_them_count(repository):
    (repository / "kinetostat.toml").write_text('[check]\nignore = ["J103"]\n')
    assert run(repository, "--kinetostat").returncode == 0


def test_settings_that_cannot_be_read_are_a_line_and_no_traceback(repository):
    (repository / "kinetostat.toml").write_text('[check]\nsamples = "many"\n')
    found = run(repository, "--kinetostat")
    assert found.returncode == 1
    assert "2 failed" in found.stdout
    assert "kinetostat: error: " in found.stdout
    assert "kinetostat.toml:2" in found.stdout
    assert "Traceback" not in found.stdout
    assert "pytest_plugin.py" not in found.stdout
    assert "pytest_plugin.py" not in found.stderr


def test_what_the_settings_exclude_is_no_test_unless_it_is_named(repository):
    (repository / "old").mkdir()
    (repository / "bad.urdf").rename(repository / "old" / "bad.urdf")
    (repository / "kinetostat.toml").write_text('[check]\nexclude = ["old/*"]\n')
    assert run(repository, "--kinetostat").returncode == 0
    assert run(repository / "old", "--kinetostat").returncode == 5  # nothing collected
    named = run(repository, "--kinetostat", "old/bad.urdf")
    assert named.returncode == 1
    assert "1 failed" in named.stdout


def test_a_suffix_is_one_in_any_case(repository):
    (repository / "bad.urdf").rename(repository / "BAD.URDF")
    assert "1 failed, 1 passed" in run(repository, "--kinetostat").stdout


def test_the_fixture_loads_the_robot_that_the_mark_names(repository):
    (repository / "test_own.py").write_text(TEST)
    found = run(repository, "test_own.py", "--strict-markers")
    assert "2 passed, 1 error" in found.stdout
    assert "the fixture robot needs" in found.stdout
