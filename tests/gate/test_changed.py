"""Which robots a change touches, in a scratch repository of git."""

import subprocess

import pytest

import kinetostat as ks
from kinetostat.gate.changed import touched

ROBOT = '<robot name="r"><link name="a"><visual><geometry><mesh filename="{mesh}"/></geometry></visual></link></robot>'


@pytest.fixture
def repository(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    git(tmp_path, "init", "-q")
    for stem in ("arm", "leg"):
        (tmp_path / f"{stem}.urdf").write_text(ROBOT.format(mesh=f"meshes/{stem}.stl"))
        (tmp_path / f"{stem}.srdf").write_text('<robot name="r"/>')
    (tmp_path / "hand.urdf.xacro").write_text('<robot name="hand"/>')
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "arm.stl").write_text("solid")
    (tmp_path / "kinetostat.toml").write_text("")
    git(tmp_path, "add", "-A")
    git(tmp_path, "commit", "-qm", "first")
    return tmp_path


def git(folder, *arguments):
    identity = ["-c", "user.name=a", "-c", "user.email=a@b.c"]
    subprocess.run(["git", "-C", str(folder), *identity, *arguments], check=True, capture_output=True)


ALL = ("arm.urdf", "leg.urdf", "hand.urdf.xacro")


def test_nothing_changed_touches_nothing(repository):
    assert touched(ALL, "HEAD") == ()


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ("arm.urdf", ("arm.urdf",)),
        ("leg.srdf", ("leg.urdf",)),
        ("meshes/arm.stl", ("arm.urdf",)),
        ("macros.xacro", ("hand.urdf.xacro",)),
        ("README.md", ()),
    ],
)
def test_a_robot_is_touched_by_its_own_files(repository, changed, expected):
    with (repository / changed).open("a") as file:
        file.write(" ")
    assert touched(ALL, "HEAD") == expected
    git(repository, "add", "-A")
    git(repository, "commit", "-qm", "second")
    assert touched(ALL, "HEAD~1") == expected
    assert touched(ALL, "HEAD") == ()


def test_a_mesh_that_is_gone_touches_the_robot_that_names_it(repository):
    (repository / "meshes" / "arm.stl").unlink()
    assert touched(ALL, "HEAD") == ("arm.urdf",)


def test_new_settings_touch_every_robot(repository):
    (repository / "kinetostat.toml").write_text("[check]\n")
    assert touched(ALL, "HEAD", [repository / "kinetostat.toml"]) == ALL


def test_from_another_folder(repository, monkeypatch, tmp_path_factory):
    (repository / "arm.urdf").write_text("<robot/>")
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    names = [str(repository / name) for name in ALL]
    assert touched(names, "HEAD") == (str(repository / "arm.urdf"),)


def test_what_git_does_not_track_counts(repository):
    (repository / ".gitignore").write_text("made.urdf\n")
    (repository / "made.urdf").write_text("<robot/>")
    assert touched(("made.urdf", "arm.urdf"), "HEAD") == ("made.urdf",)


def test_a_link_that_leads_elsewhere_now_counts(repository):
    (repository / "link.urdf").symlink_to("arm.urdf")
    git(repository, "add", "-A")
    git(repository, "commit", "-qm", "link")
    assert touched(("link.urdf",), "HEAD") == ()
    (repository / "link.urdf").unlink()
    (repository / "link.urdf").symlink_to("leg.urdf")
    assert touched(("link.urdf", "arm.urdf"), "HEAD") == ("link.urdf",)


def test_the_srdf_that_settings_name_counts(repository):
    (repository / "other.srdf").write_text("<robot/>")
    assert touched(ALL, "HEAD", srdfs={"arm.urdf": repository / "other.srdf"}) == ("arm.urdf",)


def test_robots_of_two_repositories(repository, tmp_path_factory):
    other = tmp_path_factory.mktemp("other")
    git(other, "init", "-q")
    (other / "arm.urdf").write_text("<robot/>")
    git(other, "add", "-A")
    git(other, "commit", "-qm", "first")
    (other / "arm.urdf").write_text("<robot />")
    assert touched(("arm.urdf", str(other / "arm.urdf")), "HEAD") == (str(other / "arm.urdf"),)


@pytest.mark.parametrize("revision", ["", "--output=x", "no-such-revision", "HEAD..HEAD"])
def test_a_revision_that_is_none(repository, revision):
    with pytest.raises((ks.UsageError, ks.SourceError)):
        touched(ALL, revision)


def test_without_a_repository(tmp_path, monkeypatch):
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    (tmp_path / "arm.urdf").write_text("<robot/>")
    with pytest.raises(ks.SourceError, match="not a git repository"):
        touched([str(tmp_path / "arm.urdf")], "HEAD")
