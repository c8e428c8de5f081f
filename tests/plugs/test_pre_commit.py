"""The hooks, by pre-commit itself, in a scratch repository of robots."""

import re
import shutil
import sys
from pathlib import Path

import pytest
import yaml

from plugs.repository import BAD, BAD_LINE, GOOD, ROOT, committed, copied, environment, run

HOOKS = {hook["id"]: hook for hook in yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))}
PRE_COMMIT = str(Path(sys.executable).parent / "pre-commit")


@pytest.fixture(scope="module")
def env(tmp_path_factory):
    return environment(tmp_path_factory.mktemp("hooks") / "home")


@pytest.fixture(scope="module")
def hooks(tmp_path_factory, env):
    """A repository with kinetostat's hooks, and its revision."""
    folder = copied(tmp_path_factory.mktemp("source") / "kinetostat")
    return folder, committed(folder, env)


@pytest.fixture
def robots(tmp_path, hooks, env):
    """A repository of robots that uses the hooks."""
    source, revision = hooks
    folder = tmp_path / "robots"
    (folder / "urdf").mkdir(parents=True)
    (folder / "urdf" / "my arm.urdf").write_text(GOOD, encoding="utf-8")
    used = {"repo": str(source), "rev": revision, "hooks": [{"id": "kinetostat-check"}, {"id": "kinetostat-check-all"}]}
    config = folder / ".pre-commit-config.yaml"
    config.write_text(yaml.safe_dump({"repos": [used]}), encoding="utf-8")
    committed(folder, env)
    return folder


def outcomes(text):
    return re.findall(r"^(kinetostat check[^.]*)\.+.*?(Passed|Failed|Skipped)$", text, re.MULTILINE)


BOTH = ["kinetostat check", "kinetostat check (all robots)"]


def test_they_pass_a_good_robot_and_fail_a_bad_one_with_a_line_that_says_so(robots, env):
    passed = run(PRE_COMMIT, "run", "--all-files", folder=robots, env=env)
    assert outcomes(passed) == [(name, "Passed") for name in BOTH], passed

    (robots / "urdf" / "bad.urdf").write_text(BAD, encoding="utf-8")
    run("git", "add", "--all", folder=robots, env=env)
    failed = run(PRE_COMMIT, "run", folder=robots, env=env, code=1)
    assert outcomes(failed) == [(name, "Failed") for name in BOTH], failed
    assert f"  {BAD_LINE}:J103 error" in failed
    assert "urdf/bad.urdf: FAILED" in failed
    # The first looks at what changes alone.
    first, second = failed.split("kinetostat check (all robots)")
    assert "my arm.urdf" not in first
    assert "my arm.urdf" in second


def test_where_no_robot_changes_the_one_is_skipped_and_the_other_looks_all_the_same(robots, env):
    (robots / "README.md").write_text("robots\n", encoding="utf-8")
    run("git", "add", "--all", folder=robots, env=env)
    one, everything = BOTH
    assert outcomes(run(PRE_COMMIT, "run", folder=robots, env=env)) == [(one, "Skipped"), (everything, "Passed")]


@pytest.mark.parametrize(
    ("path", "looked_at"),
    [
        ("a.urdf", True),
        ("robots/a.urdf", True),
        ("robots/a.urdf.xacro", True),
        ("robots/A.URDF", True),
        ("robots/A.Urdf.Xacro", True),
        ("robots/parts/arm.xacro", False),
        ("config/a.srdf", False),
        ("a.urdf.bak", False),
        ("--write-baseline=a.urdf", False),
    ],
)
def test_what_the_first_looks_at(path, looked_at):
    assert bool(re.search(HOOKS["kinetostat-check"]["files"], path)) == looked_at


def test_the_second_looks_whatever_changes_since_deleted_files_are_not_told():
    assert HOOKS["kinetostat-check-all"]["always_run"]
    assert not HOOKS["kinetostat-check-all"]["pass_filenames"]


def test_the_manifest_is_valid(env, tmp_path):
    shutil.copy(ROOT / ".pre-commit-hooks.yaml", tmp_path)
    run(PRE_COMMIT, "validate-manifest", ".pre-commit-hooks.yaml", folder=tmp_path, env=env)
