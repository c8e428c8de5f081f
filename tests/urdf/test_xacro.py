"""xacro: what is expanded, and what a xacro file must not reach."""

from __future__ import annotations

import builtins
import os
import sys

import pytest

import kinetostat as ks
from corpus.watched import watch
from kinetostat.urdf.packages import Packages
from kinetostat.urdf.xacro import expand, is_xacro

HEAD = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'


@pytest.fixture
def package(tmp_path):
    """Return the folder of a package, with a file of macros and a folder of packages beside it."""
    folder = tmp_path / "ws" / "arm_description"
    (folder / "urdf").mkdir(parents=True)
    (folder / "package.xml").touch()
    (folder / "urdf" / "parts.xacro").write_text(
        f'{HEAD}<xacro:property name="length" value="0.5"/>'
        '<xacro:macro name="arm" params="name parent"><link name="${name}"/>'
        '<joint name="${name}_joint" type="continuous"><parent link="${parent}"/><child link="${name}"/>'
        '<origin xyz="${length * 2} 0 0"/><axis xyz="0 0 1"/></joint></xacro:macro></robot>'
    )
    (folder / "urdf" / "sizes.yaml").write_text("length: 0.25\n")
    other = tmp_path / "elsewhere" / "hand_description"
    other.mkdir(parents=True)
    (other / "hand.xacro").write_text(f'{HEAD}<xacro:macro name="hand"><link name="hand"/></xacro:macro></robot>')
    (tmp_path / "secret.xacro").write_text(f'{HEAD}<link name="secret"/></robot>')
    (tmp_path / "secret.yaml").write_text("secret: 1\n")
    return folder


def loaded(package, text: str, **more: object) -> ks.Robot:
    path = package / "urdf" / "robot.urdf.xacro"
    path.write_text(f"{HEAD}{text}</robot>")
    return ks.load(path, **more).robot


def refusal(package, text: str, **more: object) -> ks.RobotError:
    with pytest.raises(ks.RobotError) as caught:
        loaded(package, text, **more)
    assert caught.value.file is not None
    assert caught.value.file.startswith(str(package))
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 800
    return caught.value


LINK = '<link name="a"/>'


@pytest.mark.parametrize(
    ("name", "yes"), [("r.xacro", True), ("r.urdf.xacro", True), ("R.XACRO", True), ("r.urdf", False), ("xacro", False)]
)
def test_a_xacro_file_is_known_by_its_name(tmp_path, name, yes):
    assert is_xacro(tmp_path / name) is yes


# --- expanded --------------------------------------------------------------------------------------------------

EXPANDED = {
    "nothing to expand": (LINK, ["a"]),
    "a property": ('<xacro:property name="n" value="a"/><link name="${n}_${1 + 2}"/>', ["a_3"]),
    "a macro": ('<xacro:macro name="m" params="n">${n}<link name="${n}"/></xacro:macro><xacro:m n="a"/>', ["a"]),
    "a macro from a file beside it": (
        '<xacro:include filename="parts.xacro"/><link name="a"/><xacro:arm name="b" parent="a"/>',
        ["a", "b"],
    ),
    "a macro from its own package": (
        '<xacro:include filename="$(find arm_description)/urdf/parts.xacro"/><link name="a"/>'
        '<xacro:arm name="b" parent="a"/>',
        ["a", "b"],
    ),
    "a path through a folder above, inside the package": (
        '<xacro:include filename="../urdf/parts.xacro"/><link name="a"/>',
        ["a"],
    ),
    "an include of several files": ('<xacro:include filename="part?.xacro"/><link name="a"/>', ["a"]),
    "an include of none of several files": ('<xacro:include filename="none*.xacro"/><link name="a"/>', ["a"]),
    "an optional include that is missing": (
        '<xacro:include filename="gone.xacro" optional="True"/><link name="a"/>',
        ["a"],
    ),
    "values from YAML": (
        '<xacro:property name="s" value="${xacro.load_yaml(\'sizes.yaml\')}"/><link name="a${s[\'length\']}"/>',
        ["a0.25"],
    ),
    "a default argument": ('<xacro:arg name="n" default="a"/><link name="$(arg n)"/>', ["a"]),
    "a condition": ('<link name="a"/><xacro:if value="${1 > 2}"><link name="b"/></xacro:if>', ["a"]),
    "mathematics": ('<link name="a${round(cos(pi))}"/>', ["a-1"]),
    "a link beyond ASCII": ('<link name="é"/>', ["é"]),
}


@pytest.mark.parametrize(("text", "names"), EXPANDED.values(), ids=EXPANDED)
def test_xacro_is_expanded(package, text, names):
    assert [link.name for link in loaded(package, text).links] == names


def test_numbers_of_a_macro_are_read(package):
    robot = loaded(package, '<xacro:include filename="parts.xacro"/><link name="a"/><xacro:arm name="b" parent="a"/>')
    assert robot.joint_by_name["b_joint"].origin.xyz == (1.0, 0.0, 0.0)


def test_arguments_are_passed(package):
    text = '<xacro:arg name="n" default="a"/><link name="$(arg n)"/>'
    assert loaded(package, text, xacro_arguments={"n": "given"}).root == "given"
    assert loaded(package, text).root == "a"


def test_an_argument_without_a_value_is_named(package):
    assert "side" in refusal(package, '<link name="$(arg side)"/>').message


def test_a_package_is_found_through_package_dir(package, tmp_path):
    text = '<xacro:include filename="$(find hand_description)/hand.xacro"/><xacro:hand/>'
    assert loaded(package, text, package_dirs=[tmp_path / "elsewhere"]).root == "hand"
    assert loaded(package, text, package_dirs=[tmp_path / "elsewhere" / "hand_description"]).root == "hand"


def test_the_digest_is_that_of_the_expanded_text(package):
    path = package / "urdf" / "robot.urdf.xacro"
    path.write_text(f'{HEAD}<xacro:arg name="n" default="a"/><link name="$(arg n)"/></robot>')
    first, second = (ks.load(path, xacro_arguments={"n": n}).loaded.source for n in "ab")
    assert first.sha256 != second.sha256
    assert b"$(arg" not in first.data


@pytest.mark.parametrize(
    "text",
    [
        "",
        '<xacro:include filename="$(find arm_description)/urdf/parts.xacro"/>',
        '<xacro:include filename="parts.xacro"/>',
    ],
)
def test_files_that_are_links_are_expanded(package, tmp_path, text):
    """`colcon build --symlink-install` puts a link for every file into the folder that ROS looks in."""
    (package / "urdf" / "robot.xacro").write_text(f'{HEAD}{text}<link name="a"/></robot>')
    installed = tmp_path / "install" / "share" / "arm_description"
    for name in ("package.xml", "urdf/robot.xacro", "urdf/parts.xacro"):
        (installed / name).parent.mkdir(parents=True, exist_ok=True)
        (installed / name).symlink_to(package / name)
    assert ks.load(installed / "urdf" / "robot.xacro").robot.root == "a"


def test_a_file_named_by_a_relative_path_is_expanded(package, monkeypatch):
    loaded(package, LINK)
    monkeypatch.chdir(package / "urdf")
    assert ks.load("robot.urdf.xacro").robot.root == "a"


def test_what_one_file_defines_does_not_reach_the_next(package):
    loaded(
        package,
        '<xacro:property name="left" value="1" scope="global"/>'
        '<xacro:macro name="m"><link name="a"/></xacro:macro><xacro:m/>',
    )
    assert "left" in refusal(package, '<link name="a${left}"/>').message
    assert "m" in refusal(package, "<link name='a'/><xacro:m/>").message


def test_xacro_is_left_as_it_was(package):
    import xacro.substitution_args

    before = (
        xacro.substitution_args._eval_find,
        xacro.substitution_args._eval_dict["find"],
        xacro.__dict__.get("open"),
    )
    loaded(package, LINK)
    refusal(package, "<xacro:nothing/>")
    assert before == (
        xacro.substitution_args._eval_find,
        xacro.substitution_args._eval_dict["find"],
        xacro.__dict__.get("open"),
    )
    assert builtins.open is open


def test_xacro_prints_nothing(package, capfd):
    loaded(
        package,
        "<link name=\"a${xacro.warning('look')}${xacro.message('here')}\" foo='bar'/>"
        '<xacro:property name="pi" value="3"/>'
        '<xacro:include filename="none*.xacro"/>',
    )
    assert capfd.readouterr() == ("", "")


# --- refused ---------------------------------------------------------------------------------------------------

# What a file must not reach, however it asks: (text, part of the message).
OUTSIDE = {
    "an absolute include": ('<xacro:include filename="/etc/passwd"/>', "outside its package"),
    "an include by steps upwards": ('<xacro:include filename="../../../secret.xacro"/>', "outside its package"),
    "an include by steps upwards from its package": (
        '<xacro:include filename="$(find arm_description)/../../secret.xacro"/>',
        "outside its package",
    ),
    "an include through a link": ('<xacro:include filename="link.xacro"/>', "outside its package"),
    "an include through a linked folder": ('<xacro:include filename="folder/secret.xacro"/>', "outside its package"),
    "an include of several files outside": ('<xacro:include filename="../../../sec*.xacro"/>', "outside its package"),
    "an optional include outside": ('<xacro:include filename="/etc/passwd" optional="True"/>', "outside its package"),
    "an include by a property": (
        '<xacro:property name="f" value="/etc/passwd"/><xacro:include filename="${f}"/>',
        "outside its package",
    ),
    "an include by an environment variable": ('<xacro:include filename="$(env SECRET)"/>', "outside its package"),
    "YAML outside": ("<link name=\"${xacro.load_yaml('../../../secret.yaml')['secret']}\"/>", "outside its package"),
    "YAML by its old name": ("<link name=\"${load_yaml('/etc/hostname')}\"/>", "outside its package"),
    "a folder of the system as a package": ('<xacro:include filename="$(find etc)/passwd"/>', "not found"),
    "YAML in a folder of the system as a package": (
        "<link name=\"${xacro.load_yaml('$(find etc)/hostname')}\"/>",
        "not found",
    ),
    "a package that does not exist": (
        '<xacro:include filename="$(find leg_description)/leg.xacro"/>',
        "'leg_description', which is not found",
    ),
    "a package by a path": ('<xacro:include filename="$(find ../..)/secret.xacro"/>', "not found"),
    "a package in an expression": ("<link name=\"${find('etc')}\"/>", ""),
}


@pytest.mark.parametrize(("text", "why"), OUTSIDE.values(), ids=OUTSIDE)
def test_nothing_outside_of_the_package_is_opened(package, tmp_path, monkeypatch, text, why):
    monkeypatch.setenv("SECRET", str(tmp_path / "secret.xacro"))
    (package / "urdf" / "link.xacro").symlink_to(tmp_path / "secret.xacro")
    (package / "urdf" / "folder").symlink_to(tmp_path)
    loaded(package, LINK)  # so that what xacro imports on its first run has been opened
    with watch() as opened:
        error = refusal(package, text)
    assert why in error.message
    assert {path for path in opened if "secret" in path.name or "etc" in path.parts} == set()


REFUSED = {
    "Python's builtins": "<link name=\"${open('/etc/passwd').read()}\"/>",
    "Python's imports": "<link name=\"${__import__('os').getcwd()}\"/>",
    "the way to all classes": '<link name="${().__class__.__base__.__subclasses__()}"/>',
    "builtins in an eval": "<link name=\"$(eval open('/etc/passwd'))\"/>",
    "an exit": '<link name="${exit()}"/>',
    "division by zero": '<link name="${1 / 0}"/>',
    "an unknown name": '<link name="${nobody}"/>',
    "an unknown macro": "<xacro:nobody/>",
    "a missing parameter": '<xacro:macro name="m" params="n"><link name="${n}"/></xacro:macro><xacro:m/>',
    "a missing include": '<xacro:include filename="gone.xacro"/>',
    "an include of a folder": '<xacro:include filename="../urdf"/>',
    "an expression that does not parse": '<link name="${1 +}"/>',
    "an expression with an escape": "<link name=\"${'&#27;'}\"/>",
    "a macro that calls itself": '<xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/>',
    "two macros that call each other": '<xacro:macro name="m"><xacro:n/></xacro:macro>'
    '<xacro:macro name="n"><xacro:m/></xacro:macro><xacro:m/>',
    "a property that names itself": '<xacro:property name="p" value="${p}"/><link name="${p}"/>',
    "two properties that name each other": '<xacro:property name="p" value="${q}"/>'
    '<xacro:property name="q" value="${p}"/><link name="${p}"/>',
    "a file that includes itself": '<xacro:include filename="robot.urdf.xacro"/>',
    "a deep expression": f'<link name="${{{"(" * 500}1{")" * 500}}}"/>',
    "a long exponent": '<link name="${len(str(10**10000))}"/>',
    "a prefix that is not bound": "<gone:include/>",
    "a fatal message": "<link name=\"${xacro.fatal('stop here')}\"/>",
    "the expanded robot is none": '<link name="a"/><link name="b"/>',
    "the expanded numbers are none": "<link name='a'><inertial><mass value=\"${float('nan')}\"/></inertial></link>",
}


@pytest.mark.parametrize("text", REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_expanded_is_refused_in_one_line(package, text):
    assert refusal(package, text).exit_code == 3


BROKEN = {
    "a DOCTYPE": '<!DOCTYPE robot [<!ENTITY a "b">]><robot/>',
    "no XML": "hello",
    "an element that does not end": "<robot>",
    "an empty file": "",
    "gzip": "\x1f\x8b",
}


@pytest.mark.parametrize("text", BROKEN.values(), ids=BROKEN)
@pytest.mark.parametrize("included", [False, True], ids=["itself", "included"])
def test_a_broken_file_is_refused_and_named(package, text, included):
    path = package / "urdf" / "broken.xacro"
    path.write_text(text)
    if included:
        (package / "urdf" / "robot.xacro").write_text(
            f'{HEAD}<link name="a"/><xacro:include filename="broken.xacro"/></robot>'
        )
    with pytest.raises(ks.RobotError) as caught:
        ks.load(package / "urdf" / ("robot.xacro" if included else "broken.xacro"))
    assert "broken.xacro" in str(caught.value)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize("kind", ["fifo", "device", "folder", "huge"])
def test_what_is_no_ordinary_file_is_not_included(package, kind):
    path = package / "urdf" / "odd.xacro"
    if kind == "fifo":
        os.mkfifo(path)  # opening it would block for ever
    elif kind == "device":
        path.symlink_to("/dev/zero")
    elif kind == "folder":
        path.mkdir()
    else:
        path.write_text(f"<robot>{' ' * 100_000}</robot>")
    refusal(package, '<link name="a"/><xacro:include filename="odd.xacro"/>', max_bytes=10_000)


def test_a_bomb_of_yaml_is_refused_in_time(package):
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"] + [
        f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 12)
    ]
    (package / "urdf" / "bomb.yaml").write_text("\n".join(lines))
    robot = loaded(package, "<link name=\"a${len(xacro.load_yaml('bomb.yaml'))}\"/>")
    assert robot.root == "a12"  # anchors are shared: nothing is multiplied until it is written out


def test_objects_of_python_in_yaml_are_refused(package):
    (package / "urdf" / "bad.yaml").write_text("!!python/object/apply:os.system ['true']")
    assert "python/object" in refusal(package, "<link name=\"a${xacro.load_yaml('bad.yaml')}\"/>").message


def test_a_missing_xacro_package_is_said_with_how_to_install_it(package, monkeypatch):
    monkeypatch.setitem(sys.modules, "xacro", None)
    error = refusal(package, LINK)
    assert isinstance(error, ks.SourceError)
    assert error.remedy == "pip install 'kinetostat[xacro]'"


def test_a_missing_file_is_missing_whether_or_not_xacro_is_installed(package, monkeypatch):
    with pytest.raises(ks.SourceError, match="no such file"):
        ks.load(package / "gone.xacro")


def test_expansion_is_bytes_of_utf_8(package):
    loaded(package, '<link name="é"/>')
    path = package / "urdf" / "robot.urdf.xacro"
    assert 'name="é"'.encode() in expand(path, Packages(path), {}, 10_000)


def test_an_expansion_has_lines_and_keeps_comments_and_texts(package):
    path = package / "urdf" / "robot.urdf.xacro"
    path.write_text(f"{HEAD}<!-- one -->{LINK}<gazebo><material>Gazebo/Blue</material></gazebo></robot>")
    text = expand(path, Packages(path), {}, 10**6).decode()
    lines = [line.strip() for line in text.splitlines()]
    assert lines[-6:] == ["<!-- one -->", LINK, "<gazebo>", "<material>Gazebo/Blue</material>", "</gazebo>", "</robot>"]
