"""SRDF: groups, states, and where the file is looked for."""

from __future__ import annotations

import pytest

from kinetostat.errors import AmbiguousNameError, NumberError, RobotError, StructureError, UnknownNameError, XmlError
from kinetostat.urdf.document import parse
from kinetostat.urdf.reader import read
from kinetostat.urdf.srdf import Semantics, find_srdf, load_srdf, read_srdf


def joint(name: str, parent: str, child: str, kind: str = "continuous") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}<axis xyz="0 0 1"/></joint>'


# base -j1-> arm1 -j2-> arm2 -grip-> palm -(f1, f2)-> finger1, finger2
ROBOT = read(
    parse(
        (
            '<robot name="r">'
            + "".join(f'<link name="{n}"/>' for n in ("base", "arm1", "arm2", "palm", "finger1", "finger2"))
            + joint("j1", "base", "arm1")
            + joint("j2", "arm1", "arm2")
            + joint("grip", "arm2", "palm", "fixed")
            + joint("f1", "palm", "finger1")
            + joint("f2", "palm", "finger2")
            + "</robot>"
        ).encode(),
        "r.urdf",
    )
)


def semantics(inside: str) -> Semantics:
    return read_srdf(parse(f'<robot name="r">\n{inside}</robot>'.encode(), "r.srdf"), ROBOT)


GROUPS = {
    "joints": ('<group name="g"><joint name="j2"/><joint name="j1"/></group>', ("j2", "j1")),
    "links stand for the joints above them": (
        '<group name="g"><link name="arm2"/><link name="finger1"/></group>',
        ("j2", "f1"),
    ),
    "the root link has none": ('<group name="g"><link name="base"/></group>', ()),
    "a chain": ('<group name="g"><chain base_link="base" tip_link="palm"/></group>', ("j1", "j2", "grip")),
    "a chain upwards": ('<group name="g"><chain base_link="arm2" tip_link="base"/></group>', ("j2", "j1")),
    "a chain from finger to finger": (
        '<group name="g"><chain base_link="finger1" tip_link="finger2"/></group>',
        ("f1", "f2"),
    ),
    "a chain of nothing": ('<group name="g"><chain base_link="palm" tip_link="palm"/></group>', ()),
    "a chain between links that do not exist": ('<group name="g"><chain base_link="base" tip_link="x"/></group>', ()),
    "a chain without ends": ('<group name="g"><chain/></group>', ()),
    "the same joint twice": ('<group name="g"><joint name="j1"/><link name="arm1"/></group>', ("j1",)),
    "what does not exist is left out": (
        '<group name="g"><joint name="x"/><link name="y"/><joint name="j1"/></group>',
        ("j1",),
    ),
    "a subgroup": ('<group name="g"><group name="h"/></group><group name="h"><joint name="f1"/></group>', ("f1",)),
    "a subgroup of a subgroup": (
        '<group name="g"><joint name="j1"/><group name="h"/></group><group name="h"><group name="i"/></group>'
        '<group name="i"><joint name="f2"/></group>',
        ("j1", "f2"),
    ),
    "a subgroup that does not exist": ('<group name="g"><group name="x"/><joint name="j1"/></group>', ("j1",)),
    "a subgroup without a name": ('<group name="g"><group/><joint name="j1"/></group>', ("j1",)),
    "a group in itself": ('<group name="g"><joint name="j1"/><group name="g"/></group>', ("j1",)),
    "two groups in each other": (
        '<group name="g"><joint name="j1"/><group name="h"/></group>'
        '<group name="h"><joint name="j2"/><group name="g"/></group>',
        ("j1", "j2"),
    ),
    "an empty group": ('<group name="g"/>', ()),
}


@pytest.mark.parametrize(("text", "joints"), GROUPS.values(), ids=GROUPS)
def test_a_group_is_its_joints(text, joints):
    assert semantics(text).groups["g"] == joints


def test_groups_of_groups_a_thousand_deep_cost_no_recursion_and_no_time():
    text = "".join(f'<group name="g{i}"><group name="g{i + 1}"/></group>' for i in range(1000))
    found = semantics(text + '<group name="g1000"><joint name="j1"/></group>').groups
    assert found["g0"] == ("j1",)


def test_groups_without_a_name_are_left_out():
    assert semantics('<group><joint name="j1"/></group><group name=""/>').groups == {}


STATES = """
<group_state name="home" group="arm"><joint name="j1" value="0.5"/><joint name="j2" value=" -1e-1 "/></group_state>
<group_state name="home" group="hand"><joint name="f1" value="1"/></group_state>
<group_state name="rest" group="arm"><joint name="j1" value="0"/></group_state>
<group_state name="rest" group="all"><joint name="j1" value="0"/><joint name="f1" value="2"/></group_state>
<group_state name="open" group="arm"><joint name="j1" value="1"/></group_state>
<group_state name="open" group="hand"><joint name="j1" value="2"/></group_state>
<group_state name="float" group="all"><joint name="v" value="1 2 3 0 0 0 1"/></group_state>
<group_state name="none"/>
<group_state name="twice" group="arm"><joint name="j1" value="1"/><joint name="j1" value="2"/><joint/>
<joint name="j2"/></group_state>
"""


@pytest.mark.parametrize(
    ("name", "positions"),
    [
        ("arm/home", {"j1": (0.5,), "j2": (-0.1,)}),
        ("home", {"j1": (0.5,), "j2": (-0.1,), "f1": (1.0,)}),
        ("rest", {"j1": (0.0,), "f1": (2.0,)}),
        ("hand/open", {"j1": (2.0,)}),
        ("float", {"v": (1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0)}),
        ("none", {}),
        ("twice", {"j1": (2.0,)}),
    ],
)
def test_a_state_is_found_by_name_or_by_group_and_name(name, positions):
    assert semantics(STATES).state(name) == positions


def test_states_are_listed_once():
    assert semantics(STATES).state_names() == ["home", "rest", "open", "float", "none", "twice"]


def test_groups_that_disagree_on_a_joint_make_a_state_ambiguous():
    with pytest.raises(AmbiguousNameError) as caught:
        semantics(STATES).state("open")
    assert "joint 'j1'" in caught.value.message
    assert caught.value.remedy == "use 'arm/open' or 'hand/open'"


def test_an_unknown_state_is_answered_with_the_nearest():
    with pytest.raises(UnknownNameError) as caught:
        semantics(STATES).state("hoem")
    assert caught.value.remedy == "did you mean 'home'?"


ERRORS = {
    "another root element": ("<srdf/>", StructureError, 1),
    "a state without a name": ("<robot>\n<group_state group='arm'/></robot>", StructureError, 2),
    "a value in words": (
        '<robot>\n\n<group_state name="s"><joint name="j1" value="up"/></group_state></robot>',
        NumberError,
        3,
    ),
    "a value of NaN": (
        '<robot><group_state name="s"><joint name="j1" value="nan"/></group_state></robot>',
        NumberError,
        1,
    ),
    "an infinite value": (
        '<robot><group_state name="s"><joint name="j1" value="1 -inf"/></group_state></robot>',
        NumberError,
        1,
    ),
    "an empty value": (
        '<robot><group_state name="s"><joint name="j1" value=" "/></group_state></robot>',
        NumberError,
        1,
    ),
    "a DOCTYPE": ("<!DOCTYPE robot><robot/>", XmlError, 1),
    "no XML": ("home = 1", XmlError, 1),
}


@pytest.mark.parametrize(("text", "kind", "line"), ERRORS.values(), ids=ERRORS)
def test_an_error_names_its_file_and_line(tmp_path, text, kind, line):
    path = tmp_path / "r.srdf"
    path.write_text(text)
    with pytest.raises(kind) as caught:
        load_srdf(path, ROBOT)
    assert (caught.value.file, caught.value.line, caught.value.exit_code) == (str(path), line, 3)
    assert str(caught.value).isprintable()


def test_a_missing_srdf_that_is_asked_for_is_an_error(tmp_path):
    with pytest.raises(RobotError, match="no such file"):
        load_srdf(tmp_path / "gone.srdf", ROBOT)


# --- where it is -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("robot", "name", "srdf"),
    [
        ("urdf/arm.urdf", "r", "urdf/arm.srdf"),
        ("urdf/arm.urdf", "r", "srdf/arm.srdf"),
        ("urdf/arm.urdf", "r", "urdf/r.srdf"),
        ("urdf/arm.urdf", "r", "srdf/r.srdf"),
        ("urdf/arm.urdf.xacro", "r", "srdf/arm.srdf"),
        ("urdf/arm.xacro", "", "urdf/arm.srdf"),
        ("urdf/arm.urdf", "r", None),
        ("urdf/arm.urdf", "../other/r", "other/r.srdf"),
        ("urdf/arm.urdf", "x" * 300, None),
        ("urdf/arm.urdf", "a\0b", None),
    ],
)
def test_an_srdf_is_looked_for_beside_the_robot_and_in_the_folder_srdf(tmp_path, robot, name, srdf):
    for folder in ("urdf", "srdf", "other"):
        (tmp_path / folder).mkdir()
    if srdf is not None:
        (tmp_path / srdf).touch()
    found = find_srdf(tmp_path / robot, name)
    # A robot's name comes out of the file: one that leads out of the folder is not followed.
    assert found == (None if srdf is None or "other" in srdf else tmp_path / srdf)


def test_the_stem_of_the_file_comes_before_the_name_of_the_robot(tmp_path):
    for name in ("arm.srdf", "r.srdf"):
        (tmp_path / name).touch()
    assert find_srdf(tmp_path / "arm.urdf", "r") == tmp_path / "arm.srdf"
