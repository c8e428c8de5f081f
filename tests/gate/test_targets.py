"""From what is asked for to robot files."""

import pytest

import kinetostat as ks
from kinetostat.gate.targets import robot_files


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for name in ("b/two.urdf", "a/one.urdf", "a/part.xacro", "a/arm.urdf.xacro", ".git/old.urdf", "a/notes.txt"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("<robot/>")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_folder_stands_for_the_robots_in_it(folder):
    assert robot_files(["."]) == ("a/arm.urdf.xacro", "a/one.urdf", "b/two.urdf")
    assert robot_files(["a", "b"]) == ("a/arm.urdf.xacro", "a/one.urdf", "b/two.urdf")


def test_a_file_that_is_named_is_checked_whatever_its_name(folder):
    assert robot_files(["a/part.xacro", "a/notes.txt"]) == ("a/part.xacro", "a/notes.txt")


def test_globs_and_each_robot_once(folder):
    assert robot_files(["**/*.urdf", "a/one.urdf"]) == ("a/one.urdf", "b/two.urdf")
    assert robot_files(["a/*.urdf"]) == ("a/one.urdf",)


def test_what_is_excluded_is_left_out_unless_it_is_named(folder):
    assert robot_files(["."], ["b/*", "*.xacro"]) == ("a/one.urdf",)
    assert robot_files(["b/two.urdf"], ["b/*"]) == ("b/two.urdf",)


def test_robots_that_ship_with_us():
    assert robot_files(["textbook:planar_*"])[0] == "textbook:planar_1r"
    assert robot_files(["example:panda"]) == ("example:panda",)
    assert len(robot_files(["example:*"])) > 60


def test_links_between_folders_do_not_make_an_endless_walk(folder):
    (folder / "a" / "loop").symlink_to(folder)
    assert robot_files(["."]) == ("a/arm.urdf.xacro", "a/one.urdf", "b/two.urdf")


@pytest.mark.parametrize("missing", ["nothing.urdf", "nothing/*.urdf", "example:zzz*", "-", "empty"])
def test_nothing_to_check_is_an_error_and_no_pass(folder, missing):
    (folder / "empty").mkdir()
    with pytest.raises(ks.SourceError):
        robot_files(["a", missing])


def test_all_excluded_is_an_error(folder):
    with pytest.raises(ks.SourceError, match="no robot to check"):
        robot_files(["."], ["*"])


def test_a_glob_follows_no_links_in_circles(folder):
    (folder / "a" / "loop").symlink_to(".")
    (folder / "a" / "round").symlink_to(".")
    assert robot_files(["a/**/*.urdf"]) == ("a/one.urdf",)


def test_upper_case_counts_and_a_file_named_as_a_scheme_is_a_file(folder):
    (folder / "b" / "THREE.URDF").write_text("<robot/>")
    (folder / "example:x").write_text("<robot/>")
    assert robot_files(["b", "example:x"]) == ("b/THREE.URDF", "b/two.urdf", "./example:x")


def test_excluded_is_relative_to_the_settings_wherever_one_is(folder, monkeypatch):
    monkeypatch.chdir(folder / "b")
    with pytest.raises(ks.SourceError):
        robot_files(["."], ["b/*"], folder)
