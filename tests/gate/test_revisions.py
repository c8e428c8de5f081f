"""Robots at a revision of a git repository: which names mean one, what is found, what is refused, nothing is run."""

import os
import shutil
import subprocess

import pytest

import kinetostat as ks
from kinetostat.errors import SourceError
from kinetostat.gate.revisions import Revision, revision, unpacked

pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="needs git")

ROBOT = '<robot name="r"><link name="base"/></robot>'
NEW = '<robot name="r"><link name="bottom"/></robot>'


def git(folder, *words):
    identity = {
        "GIT_AUTHOR_NAME": "a",
        "GIT_AUTHOR_EMAIL": "a@b",
        "GIT_COMMITTER_NAME": "a",
        "GIT_COMMITTER_EMAIL": "a@b",
    }
    clean = {key: value for key, value in os.environ.items() if not key.startswith("GIT_")}
    own = {**clean, **identity, "GIT_CONFIG_GLOBAL": "/dev/null"}
    subprocess.run(["git", *words], cwd=folder, check=True, capture_output=True, env=own)


def write(folder, files):
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)


def commit(folder, files, message="x"):
    write(folder, files)
    git(folder, "add", "-A")
    git(folder, "commit", "-q", "-m", message)


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """A repository with a robot in a package, changed since its tag."""
    folder = tmp_path / "arm_description"
    folder.mkdir()
    git(folder, "init", "-q", "-b", "main")
    commit(folder, {"urdf/r.urdf": ROBOT, "srdf/r.srdf": '<robot name="r"><group name="g"/></robot>', "README": "x"})
    git(folder, "tag", "v1")
    commit(folder, {"urdf/r.urdf": NEW})
    monkeypatch.chdir(folder)
    return folder


def contents(name, **asked):
    with unpacked(revision(name), **asked) as path:
        return path.read_text()


@pytest.mark.parametrize("name", ["-", "r.urdf", "textbook:pr", "example:panda", "", "/tmp/x.urdf"])
def test_names_that_mean_no_revision(name):
    assert revision(name) is None


def test_a_file_with_a_colon_is_a_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a:b.urdf").write_text(ROBOT)
    assert revision("a:b.urdf") is None
    assert revision("a:c.urdf") == Revision("a", "c.urdf")


def test_the_robot_of_each_revision(repository):
    assert contents("v1:urdf/r.urdf") == ROBOT
    assert contents("HEAD:urdf/r.urdf") == NEW
    assert contents("HEAD~1:urdf/r.urdf") == ROBOT
    assert contents("main@{0}:urdf/r.urdf") == NEW


def test_paths_from_the_current_folder_and_absolute_ones(repository, monkeypatch, tmp_path):
    monkeypatch.chdir(repository / "urdf")
    for path in ("r.urdf", "./r.urdf", "urdf/r.urdf", "../urdf/r.urdf", repository / "urdf" / "r.urdf"):
        assert contents(f"v1:{path}") == ROBOT
    monkeypatch.chdir(tmp_path)
    assert contents(f"v1:{repository}/urdf/r.urdf") == ROBOT


def test_the_srdf_comes_along_and_the_rest_does_not(repository):
    with unpacked(revision("v1:urdf/r.urdf")) as path:
        top = path.parents[1]
        assert top.name == "arm_description"
        assert {str(p.relative_to(top)) for p in top.rglob("*") if p.is_file()} == {"urdf/r.urdf", "srdf/r.srdf"}
    assert not path.exists()


def test_a_xacro_file_finds_its_includes_in_this_and_other_packages(repository):
    pytest.importorskip("xacro")
    space = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    include = '<xacro:include filename="{}"/>'
    commit(
        repository,
        {
            "package.xml": "<package/>",
            "urdf/parts.xacro": f'<robot {space}><link name="a"/></robot>',
            "other/package.xml": "<package/>",
            "other/more.xacro": f'<robot {space}><link name="b"/></robot>',
            "urdf/arm.xacro": f'<robot name="r" {space}>{include.format("parts.xacro")}'
            f"{include.format('$(find other)/more.xacro')}"
            '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint></robot>',
        },
    )
    shutil.rmtree(repository / "other")
    with unpacked(revision("HEAD:urdf/arm.xacro")) as path:
        assert set(ks.load(path).robot.link_by_name) == {"a", "b"}


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("nowhere:urdf/r.urdf", "no revision 'nowhere'"),
        ("HEAD:urdf/x.urdf", "no file 'urdf/x.urdf'"),
        ("HEAD:urdf", "no file"),
        ("HEAD:../x.urdf", "no file"),
        ("HEAD:/etc/passwd", "no git repository"),
        ("HEAD:", "no path"),
        (":urdf/r.urdf", "no revision"),
        ("--output=x:urdf/r.urdf", "no revision"),
        ("-h:urdf/r.urdf", "no revision"),
        ("v1\n:urdf/r.urdf", "no revision"),
        ("$(touch x):urdf/r.urdf", "no revision"),
        ("HEAD^{tree}:urdf/r.urdf", "no revision"),
        ("HEAD:urdf/*.urdf", "no file"),
        ("HEAD::(glob)urdf/*.urdf", "no file"),
        ("HEAD:--help", "no file"),
        ("HEAD:a\0b", "no revision"),
    ],
)
def test_what_is_not_there_is_one_clear_line(repository, name, part):
    before = set(repository.rglob("*"))
    with pytest.raises(SourceError, match=part) as caught, unpacked(revision(name)):
        pass
    assert caught.value.exit_code == 3
    assert "\n" not in str(caught.value)
    assert caught.value.remedy
    assert set(repository.rglob("*")) == before


def test_outside_any_repository(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    with pytest.raises(SourceError, match="no git repository"), unpacked(Revision("HEAD", "r.urdf")):
        pass


def test_without_git(repository, monkeypatch):
    monkeypatch.setenv("PATH", "")
    with pytest.raises(SourceError, match="git program is not installed"), unpacked(Revision("HEAD", "urdf/r.urdf")):
        pass


def test_too_much_is_refused(repository):
    with pytest.raises(SourceError, match="10 bytes"):
        contents("HEAD:urdf/r.urdf", max_bytes=10)


def test_links_are_followed_inside_the_tree_alone(repository):
    (repository / "link.urdf").symlink_to("urdf/r.urdf")
    (repository / "out.urdf").symlink_to("/etc/hostname")
    (repository / "up.urdf").symlink_to("../../secret.urdf")
    (repository / "round.urdf").symlink_to("round.urdf")
    commit(repository, {})
    assert contents("HEAD:link.urdf") == NEW
    for name in ("out", "up", "round"):
        with pytest.raises(SourceError, match="no file"):
            contents(f"HEAD:{name}.urdf")


def test_neither_filters_nor_hooks_nor_external_programs_run(repository):
    """What a hostile repository may configure to run is not run by reading its objects."""
    trap = repository / ".git" / "trap"
    trap.write_text(f"#!/bin/sh\ntouch {repository}/sprung\ncat\n")
    trap.chmod(0o755)
    for hook in ("post-checkout", "pre-commit", "reference-transaction", "fsmonitor-watchman"):
        shutil.copy(trap, repository / ".git" / "hooks" / hook)
    commit_ = {".gitattributes": "*.urdf filter=evil diff=evil export-subst\n"}
    commit(repository, commit_)
    (repository / "sprung").unlink(missing_ok=True)
    for key in ("filter.evil.smudge", "filter.evil.clean", "diff.evil.textconv", "core.fsmonitor", "core.pager"):
        git(repository, "config", key, str(trap))
    (repository / "sprung").unlink(missing_ok=True)
    assert contents("HEAD:urdf/r.urdf") == NEW
    assert not (repository / "sprung").exists()


def test_odd_names_are_read(repository):
    commit(repository, {"urdf/a b\tc\n\u00e9.urdf": ROBOT})
    assert contents("HEAD:urdf/a b\tc\n\u00e9.urdf") == ROBOT
