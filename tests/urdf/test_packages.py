"""Where package:// and mesh names lead, and where they must not."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from corpus.watched import watch
from kinetostat.urdf.packages import Packages, Reason, other_case


@pytest.fixture(autouse=True)
def no_ros(monkeypatch):
    """Whatever ROS is installed here has no say."""
    for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        monkeypatch.delenv(variable, raising=False)


@pytest.fixture
def package(tmp_path):
    """Return the folder of a package `arm_description` with a robot file and a mesh, beside another package."""
    folder = tmp_path / "ws" / "src" / "arm_description"
    for path in (
        folder / "urdf" / "arm.urdf",
        folder / "meshes" / "a.stl",
        folder / "meshes" / "a b.stl",
        folder / "package.xml",
    ):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    other = tmp_path / "ws" / "src" / "hand_description"
    (other / "meshes").mkdir(parents=True)
    (other / "meshes" / "h.stl").touch()
    (other / "package.xml").touch()
    (tmp_path / "secret.stl").touch()
    return folder


def robot(package: Path) -> Packages:
    return Packages(package / "urdf" / "arm.urdf")


# --- called by its package.xml ----------------------------------------------------------------------------------


def manifest(folder: Path, name: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "package.xml").write_text(f"<?xml version='1.0'?>\n<package format='3'><name> {name}\n</name></package>")
    return folder


def test_a_package_is_called_what_its_package_xml_says_and_as_its_folder(package, tmp_path):
    manifest(package, "ur_description")
    assert robot(package).find("ur_description") == package
    assert robot(package).find("arm_description") == package
    assert robot(package).resolve("package://ur_description/meshes/a.stl") == package / "meshes" / "a.stl"
    assert robot(package).resolve("package://ur_description/../../secret.stl") is Reason.OUTSIDE


def test_a_package_dir_is_called_what_its_package_xml_says_or_holds_such(package, tmp_path):
    clone = manifest(tmp_path / "clones" / "a-clone", "leg_description")
    for folder in (clone, clone.parent):
        assert Packages(package / "urdf" / "arm.urdf", [folder]).find("leg_description") == clone
    assert robot(package).find("leg_description") is None


BOMB = "<!DOCTYPE package [<!ENTITY n 'leg'>]><package><name>&n;</name></package>"


@pytest.mark.parametrize(
    "text", [BOMB, "<package>", "<robot><name>leg</name></robot>", "<package/>", "", "\0", "x" * 10**6]
)
def test_a_package_xml_that_says_no_name_is_passed_over(package, text):
    (package / "package.xml").write_text(text)
    assert robot(package).find("leg") is None
    assert robot(package).find("arm_description") == package


# --- found -----------------------------------------------------------------------------------------------------


def test_a_package_is_found_by_walking_up_from_the_file(package):
    assert robot(package).find("arm_description") == package
    assert robot(package).find("hand_description") == package.parent / "hand_description"
    assert robot(package).find("leg_description") is None


@pytest.mark.parametrize(("variable", "below"), [("ROS_PACKAGE_PATH", ""), ("AMENT_PREFIX_PATH", "share")])
def test_a_package_is_found_by_the_environment(package, tmp_path, monkeypatch, variable, below):
    elsewhere = tmp_path / "opt" / below / "leg_description"
    elsewhere.mkdir(parents=True)
    monkeypatch.setenv(variable, os.pathsep.join(["", str(tmp_path / "gone"), str(tmp_path / "opt")]))
    assert robot(package).find("leg_description") == elsewhere


def test_the_folder_of_a_package_may_itself_be_on_the_ros_package_path(package, tmp_path, monkeypatch):
    elsewhere = tmp_path / "opt" / "leg_description"
    elsewhere.mkdir(parents=True)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(elsewhere))
    assert robot(package).find("leg_description") == elsewhere


@pytest.mark.parametrize("given", ["leg_description", "."], ids=["the package itself", "a folder of packages"])
def test_a_package_is_found_by_the_folders_that_are_given(package, tmp_path, given):
    elsewhere = tmp_path / "mine" / "leg_description"
    elsewhere.mkdir(parents=True)
    folder = tmp_path / "mine" / given
    assert Packages(package / "urdf" / "arm.urdf", (folder,)).find("leg_description") == elsewhere


def test_folders_that_are_given_come_first(package, tmp_path, monkeypatch):
    first, second = tmp_path / "first" / "hand_description", tmp_path / "second" / "hand_description"
    for folder in (first, second):
        folder.mkdir(parents=True)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(second.parent))
    assert Packages(package / "urdf" / "arm.urdf", (first.parent,)).find("hand_description") == first
    assert Packages(package / "urdf" / "arm.urdf").find("hand_description") == package.parent / "hand_description"
    assert Packages(None).find("hand_description") == second


@pytest.mark.parametrize("name", ["", ".", "..", "a/b", "../ws", "a\\b", "/etc", "\0", "x" * 5000])
def test_what_is_no_name_of_a_package_finds_none(package, name):
    assert robot(package).find(name) is None


FOUND = {
    "package://arm_description/meshes/a.stl": "arm_description/meshes/a.stl",
    "package://hand_description/meshes/h.stl": "hand_description/meshes/h.stl",
    "package://arm_description/meshes/a%20b.stl": "arm_description/meshes/a b.stl",
    "package://arm_description/urdf/../meshes/a.stl": "arm_description/meshes/a.stl",
    "package://arm_description//meshes//a.stl": "arm_description/meshes/a.stl",
    "../meshes/a.stl": "arm_description/meshes/a.stl",
    "../meshes/a b.stl": "arm_description/meshes/a b.stl",
    "arm.urdf": "arm_description/urdf/arm.urdf",
}


@pytest.mark.parametrize(("uri", "path"), FOUND.items())
def test_a_mesh_inside_a_package_is_found(package, uri, path):
    assert robot(package).resolve(uri) == package.parent / path


def test_a_mesh_beside_a_file_outside_of_any_package_is_found(tmp_path):
    (tmp_path / "a.stl").touch()
    assert Packages(tmp_path / "r.urdf").resolve("a.stl") == tmp_path / "a.stl"


def test_a_file_named_by_a_relative_path_finds_its_package(package, monkeypatch):
    monkeypatch.chdir(package / "urdf")
    assert Packages(Path("arm.urdf")).resolve("package://arm_description/meshes/a.stl") == package / "meshes" / "a.stl"
    assert Packages(Path("arm.urdf")).resolve("../meshes/a.stl") == package / "meshes" / "a.stl"


# --- refused ---------------------------------------------------------------------------------------------------

REFUSED = {
    "../../../../secret.stl": "leads out of the package",
    "../../../../gone.stl": "leads out of the package",
    "package://arm_description/../../../secret.stl": "leads out of the package",
    "package://arm_description/%2e%2e/%2E%2E/../secret.stl": "leads out of the package",
    "package://arm_description//etc/passwd": "no such file",
    "package://arm_description/%2fetc/passwd": "",
    "%2fetc%2fpasswd": "",
    "package://../secret.stl": "not found",
    "package://./secret.stl": "not found",
    "package:///etc/passwd": "not found",
    "package://": "not found",
    "package://arm_description": "no such file",
    "package://arm_description/meshes": "no such file",
    "package://leg_description/l.stl": "not found",
    "/etc/passwd": "absolute",
    "//etc/passwd": "absolute",
    "~/secret.stl": "absolute",
    "~root/x.stl": "absolute",
    "C:\\models\\a.stl": "absolute",
    "C:/models/a.stl": "absolute",
    "\\\\server\\share\\a.stl": "absolute",
    "file:///etc/passwd": "only package://",
    "FILE:///etc/passwd": "only package://",
    "http://example.com/a.stl": "only package://",
    "model://arm/a.stl": "only package://",
    "Package://arm_description/meshes/a.stl": "only package://",
    "a\0.stl": "NUL",
    "%00": "",
    "package://arm_description/%00.stl": "",
    "": "no such file",
    ".": "no such file",
    "gone.stl": "no such file",
    "x" * 300: "",
    "x/" * 3000: "",
    "package://" + "x" * 300 + "/a.stl": "",
    "\udc80.stl": "",
    "arm.urdf/arm.urdf": "no such file",
}


@pytest.mark.parametrize(
    ("uri", "why"), REFUSED.items(), ids=[uri[:50].encode("unicode_escape").decode() for uri in REFUSED]
)
def test_a_mesh_that_leads_elsewhere_is_refused_with_a_reason(package, uri, why):
    found = robot(package).resolve(uri)
    assert isinstance(found, str)
    assert why in found


@pytest.mark.parametrize("uri", ["package://etc/passwd", "package://bin/sh", "package://usr/bin/env"])
def test_a_folder_of_the_system_is_no_package(package, uri):
    """Every robot file lies below the root of the file system: what stands there are no packages."""
    assert robot(package).resolve(uri) == "the package is not found"


@pytest.mark.parametrize("target", ["../../../../secret.stl", "/etc/passwd", "/dev/zero"])
def test_a_link_that_leads_out_of_the_package_is_refused(package, target):
    (package / "meshes" / "link.stl").symlink_to(target)
    assert robot(package).resolve("package://arm_description/meshes/link.stl") == "the path leads out of the package"


def test_a_linked_folder_that_leads_out_of_the_package_is_refused(package, tmp_path):
    (package / "textures").symlink_to(tmp_path)
    assert (
        robot(package).resolve("package://arm_description/textures/secret.stl") == "the path leads out of the package"
    )


def test_a_link_inside_the_package_is_followed(package):
    (package / "meshes" / "link.stl").symlink_to("a.stl")
    assert robot(package).resolve("../meshes/link.stl") == package / "meshes" / "a.stl"


def test_links_in_a_loop_are_refused(package):
    (package / "meshes" / "loop.stl").symlink_to("loop.stl")
    assert isinstance(robot(package).resolve("../meshes/loop.stl"), str)


def test_a_package_that_is_a_link_is_a_package(package, tmp_path):
    """`colcon build --symlink-install` makes them."""
    (tmp_path / "install").mkdir()
    (tmp_path / "install" / "leg_description").symlink_to(package)
    found = Packages(None, (tmp_path / "install",)).resolve("package://leg_description/meshes/a.stl")
    assert found == package / "meshes" / "a.stl"


def test_a_fifo_and_a_device_are_no_meshes(package):
    os.mkfifo(package / "meshes" / "fifo.stl")
    assert robot(package).resolve("../meshes/fifo.stl") == "there is no such file"


def test_standard_input_has_packages_but_no_folder(package):
    packages = Packages(None, (package.parent,))
    assert packages.resolve("meshes/a.stl") == "standard input has no folder to look in"
    assert packages.resolve("package://arm_description/meshes/a.stl") == package / "meshes" / "a.stl"


def test_nothing_but_package_xml_is_opened(package):
    (package.parent / "package.xml").symlink_to("/etc/passwd")
    (package / "meshes" / "link.stl").symlink_to("/etc/passwd")
    with watch() as opened:
        for uri in (*FOUND, "../meshes/link.stl", "/etc/passwd", "file:///etc/passwd", "../../../../secret.stl"):
            robot(package).resolve(uri)
    assert opened == {package / "package.xml"}


def test_the_home_of_a_file_is_its_package_or_its_folder(package, tmp_path):
    assert robot(package).home() == package
    assert Packages(tmp_path / "r.urdf").home() == tmp_path


# --- nearly found ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        ("meshes/A.STL", "meshes/a.stl"),
        ("Meshes/a.stl", "meshes/a.stl"),
        ("urdf/../MESHES/A B.stl", "meshes/a b.stl"),
        ("meshes/b.stl", None),
        ("meshes", None),
        ("textures/a.stl", None),
        ("../hand_description/meshes/H.stl", None),
    ],
)
def test_a_file_of_another_case_is_found_in_the_package_only(package, asked, found):
    assert other_case(package, package / asked) == (package / found if found else None)


def test_a_file_of_another_case_is_not_looked_for_beyond_a_link(package, tmp_path):
    (package / "textures").symlink_to(tmp_path)
    assert other_case(package, package / "textures" / "SECRET.stl") is None


def test_a_file_says_whether_it_is_in_a_package(package, tmp_path):
    assert robot(package).has_manifest()
    assert not Packages(tmp_path / "r.urdf").has_manifest()
    assert not Packages(None).has_manifest()


def test_a_reason_is_its_text(package):
    assert robot(package).resolve("/etc/passwd") is Reason.ABSOLUTE
    assert f"{Reason.ABSOLUTE}" == "an absolute path"
    assert robot(package).place("a.stl") == (package, package / "urdf" / "a.stl")
