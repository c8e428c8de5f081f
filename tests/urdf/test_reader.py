"""A document to a description: every error with its place and remedy, every remark, every default."""

from __future__ import annotations

import math

import pytest

from kinetostat.errors import LimitError, NumberError, RobotError, StructureError
from kinetostat.urdf.description import Inertial, Joint, JointType, Limit, Mimic, Origin, Robot
from kinetostat.urdf.document import parse
from kinetostat.urdf.reader import read

INERTIA = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
LIMIT = '<limit lower="-1" upper="1" effort="10" velocity="2"/>'


def robot_of(text: str) -> Robot:
    return read(parse(text.encode(), "f.urdf"))


def with_joint(inside: str = "", kind: str = "revolute", *, tag: str = "joint", root: str = "", more: str = "") -> str:
    """Return links a, b and joint j between them; the joint is in line 4."""
    return (
        f'<robot name="r"{root}>\n<link name="a"/>\n<link name="b"/>\n'
        f'<{tag} name="j" type="{kind}"><parent link="a"/><child link="b"/>{inside}</{tag}>\n{more}</robot>'
    )


def joint_of(inside: str = "", kind: str = "revolute", **more: str) -> Joint:
    return robot_of(with_joint(inside, kind, **more)).joint_by_name["j"]


def remarks_of(text: str) -> list[tuple[int, str, str]]:
    return [(remark.line, remark.element, remark.text) for remark in robot_of(text).remarks]


def links(*names: str) -> str:
    return "".join(f'<link name="{name}"/>' for name in names)


def joint(name: str, parent: str, child: str, kind: str = "fixed", inside: str = "") -> str:
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>\n'


# --- errors ----------------------------------------------------------------------------------------------------

J, AXIS = "<joint name='j'>", '<axis xyz="0 0 1"/>'

# What is wrong inside the joint of line 4: (XML, class, element in the joint, message, remedy).
IN_THE_JOINT = {
    "an axis without xyz": ("<axis/>", NumberError, "<axis>", "no xyz", 'xyz="0 0 0"'),
    "an empty axis": ('<axis xyz=""/>', NumberError, "<axis>", "has 0 numbers, not 3", "xyz="),
    "an axis of two numbers": ('<axis xyz="0 1"/>', NumberError, "<axis>", "has 2 numbers, not 3", "xyz="),
    "an axis of four numbers": ('<axis xyz="0 0 1 0"/>', NumberError, "<axis>", "has 4 numbers, not 3", "xyz="),
    "a zero axis": ('<axis xyz="0 0 0"/>', NumberError, "<axis>", "zero", "0 0 1"),
    "a tiny axis": ('<axis xyz="0 0 1e-200"/>', NumberError, "<axis>", "zero", "0 0 1"),
    "an infinite axis": ('<axis xyz="0 0 inf"/>', NumberError, "<axis>", "'inf' is not a finite number", "decimal"),
    # Pinocchio takes the square of its length, which overflows: the engines would disagree.
    "an axis whose square overflows": ('<axis xyz="0 0 1e155"/>', NumberError, "<axis>", "too large", ""),
    "the largest axis": ('<axis xyz="1e308 1e308 1e308"/>', NumberError, "<axis>", "too large", ""),
    "xyz of two numbers": ('<origin xyz="1 2"/>', NumberError, "<origin>", "has 2 numbers, not 3", "xyz="),
    "an empty rpy": ('<origin rpy=" "/>', NumberError, "<origin>", "has 0 numbers, not 3", "rpy="),
    "xyz that is far": ('<origin xyz="0 0 1e13"/>', NumberError, "<origin>", "too large; at most 1e+12", "unit"),
    "xyz that overflows": ('<origin xyz="0 0 1e400"/>', NumberError, "<origin>", "too large", "unit"),
    "rpy beyond a million": ('<origin rpy="0 0 1000001"/>', NumberError, "<origin>", "at most 1e+06", "unit"),
    "xacro in a number": ('<origin xyz="${x} 0 0"/>', NumberError, "<origin>", "not a finite number", "xacro"),
    "a quaternion in URDF 1.0": (
        '<origin quat_xyzw="0 0 0 1"/>',
        StructureError,
        "<origin>",
        "part of URDF 1.1",
        'version="1.1"',
    ),
    "a limit that is no number": ('<limit lower="x" upper="1"/>', NumberError, "<limit>", "lower: 'x'", "decimal"),
    "a limit of NaN": ('<limit lower="-1" upper="nan"/>', NumberError, "<limit>", "upper: 'nan'", "decimal"),
    "an empty effort": ('<limit effort=""/>', NumberError, "<limit>", "effort: ''", "decimal"),
    "damping in words": (AXIS + '<dynamics damping="low"/>', NumberError, "<dynamics>", "damping: 'low'", "decimal"),
    "friction of NaN": (AXIS + '<dynamics friction="nan"/>', NumberError, "<dynamics>", "friction: 'nan'", "decimal"),
    "a mimic that names no joint": (AXIS + "<mimic/>", StructureError, "", "names no joint", "<mimic joint="),
    "a multiplier in words": (
        AXIS + '<mimic joint="k" multiplier="x"/>',
        NumberError,
        "<mimic>",
        "multiplier: 'x'",
        "",
    ),
    "a huge multiplier": (AXIS + '<mimic joint="k" multiplier="1e7"/>', NumberError, "<mimic>", "at most 1e+06", ""),
    "a huge offset": (AXIS + '<mimic joint="k" offset="1e13"/>', NumberError, "<mimic>", "at most 1e+12", ""),
    "a joint that follows itself": (
        AXIS + '<mimic joint="j"/>',
        StructureError,
        "",
        "lead back to joint 'j'",
        "circle",
    ),
}

# What is wrong: (text, class, line, element, message, remedy).
ELSEWHERE = {
    "another root element": (
        "<model/>",
        StructureError,
        1,
        "<model>",
        "the root element is <model>, not <robot>",
        "<robot>",
    ),
    "SDF": ("<sdf/>", StructureError, 1, "<sdf>", "the root element is <sdf>", "convert it to URDF"),
    "another case": ("<Robot/>", StructureError, 1, "<Robot>", "is <Robot>, not <robot>", "<robot>"),
    "an escape as root element name": ("<x\u009b31m/>", RobotError, 1, None, "", ""),
    "an empty version": (
        '<robot version=""/>',
        StructureError,
        1,
        "<robot>",
        "version '' is not a version",
        'version="1.0"',
    ),
    "a version in words": ('<robot version="one"/>', StructureError, 1, "<robot>", "version 'one'", 'version="1.0"'),
    "a version of three parts": (
        '<robot version="1.0.0"/>',
        StructureError,
        1,
        "<robot>",
        "version '1.0.0'",
        'version="1.0"',
    ),
    "a negative version": ('<robot version="-1.0"/>', StructureError, 1, "<robot>", "version '-1.0'", 'version="1.0"'),
    "xacro": (
        '<robot>\n<xacro:macro name="m"/></robot>',
        StructureError,
        2,
        "<xacro:macro name='m'>",
        "not expanded",
        ".xacro",
    ),
    "no link": ("<robot/>", StructureError, 1, "<robot>", "no link", "the file that you mean"),
    "a link without a name": (
        "<robot>\n<link/></robot>",
        StructureError,
        2,
        "<link>",
        "a link without a name",
        "give it a name",
    ),
    "a link with an empty name": (
        '<robot>\n<link name=""/></robot>',
        StructureError,
        2,
        "<link name=''>",
        "without a name",
        "a name",
    ),
    "a joint without a name": (
        with_joint().replace(' name="j"', ""),
        StructureError,
        4,
        "<joint>",
        "a joint without a name",
        "a name",
    ),
    "two links of one name": (
        '<robot>\n<link name="a"/>\n<link name="a"/></robot>',
        StructureError,
        3,
        "<link name='a'>",
        "already used at line 2",
        "unique",
    ),
    "two joints of one name": (
        with_joint(AXIS + LIMIT, more=links("c") + joint("j", "b", "c")),
        StructureError,
        5,
        J,
        "already used at line 4",
        "unique",
    ),
    "a delete character in a name": (
        '<robot><link name="&#127;"/></robot>',
        StructureError,
        1,
        r"<link name='\x7f'>",
        "control character",
        "",
    ),
    "a C1 control character in a name": (
        '<robot><link name="&#x9b;31m"/></robot>',
        StructureError,
        1,
        r"<link name='\x9b31m'>",
        "control character",
        "rename",
    ),
    "no type": (with_joint().replace(' type="revolute"', ""), StructureError, 4, J, "a joint without a type", "type="),
    "an unknown type": (
        with_joint(kind="wobbly"),
        StructureError,
        4,
        J,
        "joint type 'wobbly'",
        "revolute, continuous, prismatic",
    ),
    "an empty type": (with_joint(kind=""), StructureError, 4, J, "joint type ''", "revolute"),
    "a type in upper case": (with_joint(kind="Revolute"), StructureError, 4, J, "joint type 'Revolute'", "revolute"),
    "a screw that is not Drake's": (with_joint(kind="screw"), StructureError, 4, J, "belongs to Drake", "<drake:joint"),
    "a revolute joint of Drake's": (
        with_joint(tag="drake:joint"),
        StructureError,
        4,
        "<drake:joint name='j'>",
        "'revolute'",
        "screw, planar",
    ),
    "no parent": (
        with_joint().replace('<parent link="a"/>', ""),
        StructureError,
        4,
        J,
        "no parent link",
        "<parent link=",
    ),
    "a parent without link": (
        with_joint().replace('parent link="a"', "parent"),
        StructureError,
        4,
        f"{J}<parent>",
        "no parent link",
        "<parent link=",
    ),
    "no child": (with_joint().replace('<child link="b"/>', ""), StructureError, 4, J, "no child link", "<child link="),
    "a parent that does not exist": (
        with_joint().replace('link="a"', 'link="x"'),
        StructureError,
        4,
        J,
        "parent link 'x' does not exist",
        "add",
    ),
    "a child that does not exist": (
        with_joint().replace('link="b"', 'link="x"'),
        StructureError,
        4,
        J,
        "child link 'x' does not exist",
        "add",
    ),
    "a child in another case": (
        with_joint().replace('child link="b"', 'child link="B"'),
        StructureError,
        4,
        J,
        "child link 'B'",
        "correct",
    ),
    "a quaternion and rpy": (
        with_joint('<origin rpy="0 0 0" quat_xyzw="0 0 0 1"/>', root=' version="1.1"'),
        StructureError,
        4,
        f"{J}<origin>",
        "both rpy and quat_xyzw",
        "keep one",
    ),
    "a zero quaternion": (
        with_joint('<origin quat_xyzw="0 0 0 0"/>', root=' version="1.1"'),
        NumberError,
        4,
        f"{J}<origin>",
        "zero",
        "0 0 0 1",
    ),
    "a quaternion of three numbers": (
        with_joint('<origin quat_xyzw="0 0 1"/>', root=' version="1.1"'),
        NumberError,
        4,
        f"{J}<origin>",
        "has 3 numbers, not 4",
        "quat_xyzw=",
    ),
    "a quaternion whose square overflows": (
        with_joint('<origin quat_xyzw="0 0 0 1e155"/>', root=' version="1.1"'),
        NumberError,
        4,
        f"{J}<origin>",
        "too large",
        "",
    ),
    # A range without a number in it: there is no configuration inside.
    "both limits plus infinity": (with_joint(AXIS + '<limit lower="inf" upper="inf"/>'), RobotError, 4, None, "", ""),
    "both limits minus infinity": (
        with_joint(AXIS + '<limit lower="-inf" upper="-inf"/>'),
        RobotError,
        4,
        None,
        "",
        "",
    ),
    "a planar follower": (
        with_joint('<mimic joint="k"/>', "planar"),
        StructureError,
        4,
        J,
        "a planar joint cannot follow",
        "remove",
    ),
    "a floating follower": (
        with_joint('<mimic joint="k"/>', "floating"),
        StructureError,
        4,
        J,
        "a floating joint cannot follow",
        "remove",
    ),
    "two joints that follow each other": (
        with_joint(
            AXIS + '<mimic joint="k"/>',
            more=links("c") + joint("k", "b", "c", "continuous", AXIS + '<mimic joint="j"/>'),
        ),
        StructureError,
        5,
        "<joint name='k'>",
        "lead back to joint 'j'",
        "circle",
    ),
    "a circle of followers that others follow": (
        with_joint(
            AXIS + '<mimic joint="k"/>',
            more=links("c", "d")
            + joint("k", "b", "c", "continuous", AXIS + '<mimic joint="l"/>')
            + joint("l", "c", "d", "continuous", AXIS + '<mimic joint="k"/>'),
        ),
        StructureError,
        6,
        "<joint name='l'>",
        "lead back to joint 'k'",
        "circle",
    ),
    "a follower of a fixed joint": (
        with_joint(AXIS + '<mimic joint="k"/>', more=links("c") + joint("k", "b", "c")),
        StructureError,
        4,
        J,
        "mimics the fixed joint 'k'",
        "follow a joint",
    ),
    "a follower of a planar joint": (
        with_joint(AXIS + '<mimic joint="k"/>', more=links("c") + joint("k", "b", "c", "planar", AXIS)),
        StructureError,
        4,
        J,
        "mimics the planar joint 'k'",
        "follow a joint",
    ),
    "a screw without a pitch": (
        with_joint(AXIS, "screw", tag="drake:joint"),
        StructureError,
        4,
        "<drake:joint name='j'>",
        "without a pitch",
        "drake:screw",
    ),
    "a pitch without a value": (
        with_joint(AXIS + "<drake:screw_thread_pitch/>", "screw", tag="drake:joint"),
        StructureError,
        4,
        "<drake:joint name='j'>",
        "without a pitch",
        "metres per turn",
    ),
    "a pitch in words": (
        with_joint(AXIS + '<drake:screw_thread_pitch value="M8"/>', "screw", tag="drake:joint"),
        NumberError,
        4,
        "<drake:joint name='j'><drake:screw_thread_pitch>",
        "value: 'M8'",
        "decimal",
    ),
    "a mass of NaN": (
        f'<robot>\n<link name="a"><inertial><mass value="nan"/>{INERTIA}</inertial></link></robot>',
        NumberError,
        2,
        "<link name='a'><inertial><mass>",
        "value: 'nan'",
        "decimal",
    ),
    "a mass with a decimal comma": (
        f'<robot><link name="a">\n<inertial>\n<mass value="1,5"/>{INERTIA}</inertial></link></robot>',
        NumberError,
        3,
        "<link name='a'><inertial><mass>",
        "'1,5'",
        "decimal point",
    ),
    "a huge mass": (
        f'<robot><link name="a"><inertial><mass value="1e16"/>{INERTIA}</inertial></link></robot>',
        NumberError,
        1,
        "<link name='a'><inertial><mass>",
        "at most 1e+15",
        "unit",
    ),
    "an inertia in words": (
        f'<robot><link name="a"><inertial><mass value="1"/>{INERTIA.replace("0", "x")}</inertial></link></robot>',
        NumberError,
        1,
        "<link name='a'><inertial><inertia>",
        "ixy: 'x'",
        "decimal",
    ),
    "a mass that is wrong is an error though the inertia is missing": (
        '<robot><link name="a"><inertial><mass value="x"/></inertial></link></robot>',
        NumberError,
        1,
        "<link name='a'><inertial><mass>",
        "value: 'x'",
        "decimal",
    ),
    "a centre of mass of NaN": (
        f'<robot><link name="a"><inertial><origin xyz="0 0 nan"/><mass value="1"/>{INERTIA}</inertial></link></robot>',
        NumberError,
        1,
        "<link name='a'><inertial><origin>",
        "xyz: 'nan'",
        "decimal",
    ),
    "several roots": (
        f"<robot>{links('a', 'b', 'c', 'd', 'e')}</robot>",
        StructureError,
        1,
        "<robot>",
        "5 links have no parent: 'a', 'b', 'c', 'd', ...",
        "join",
    ),
    "no root": (
        f"<robot>{links('a', 'b')}{joint('j', 'a', 'b')}{joint('k', 'b', 'a')}</robot>",
        StructureError,
        1,
        "<robot>",
        "every link has a parent",
        "root",
    ),
    "a joint from a link to itself": (
        f"<robot>{links('a', 'b')}\n{joint('j', 'a', 'a')}</robot>",
        StructureError,
        2,
        J,
        "the same link 'a'",
        "connects two",
    ),
    "two parents": (
        f"<robot>{links('a', 'b', 'c')}\n{joint('j', 'a', 'c')}{joint('k', 'b', 'c')}</robot>",
        StructureError,
        3,
        "<joint name='k'>",
        "'c' already has a parent: joint 'j', line 2",
        "remove one",
    ),
    "a cycle apart from the root": (
        f"<robot>\n{links('a')}\n{links('b', 'c')}{joint('j', 'b', 'c')}{joint('k', 'c', 'b')}</robot>",
        StructureError,
        3,
        "<link name='b'>",
        "in a cycle of joints",
        "break",
    ),
}

ERRORS = ELSEWHERE | {
    name: (with_joint(inside), kind, 4, J + element, message, remedy)
    for name, (inside, kind, element, message, remedy) in IN_THE_JOINT.items()
}


@pytest.mark.parametrize(("text", "kind", "line", "element", "message", "remedy"), ERRORS.values(), ids=ERRORS)
def test_an_error_says_where_what_and_what_to_do(text, kind, line, element, message, remedy):
    with pytest.raises(kind) as caught:
        robot_of(text)
    error = caught.value
    assert (error.file, error.line, error.exit_code) == ("f.urdf", line, 3)
    assert element in (None, error.element)
    assert message in error.message
    assert error.remedy
    assert remedy in error.remedy
    assert str(error).isprintable()


NOT_NUMBERS = (
    *(
        "nan",
        "NaN",
        "-nan",
        "inf",
        "-Infinity",
        "1,5",
        "0x10",
        "1_0",
        "1.0f",
        "1d3",
        "٣",
        "\uff11",
        "a",
        "0abc",
        "${x}",
        "1+1",
        "1e",
        "e5",
    ),
    *(
        "--1",
        "+-1",
        "1..2",
        ".",
        "-",
        "+",
        "1e1.5",
        "1e+",
        "0b1",
        "1j",
        "(1)",
        "1\xa0",
        "½",
        "1\u200b",
        "\u22121",
        "True",
        "1/2",
        "1 m",
    ),
)


@pytest.mark.parametrize("word", NOT_NUMBERS)
def test_what_is_no_plain_decimal_number_is_refused(word):
    for inside in (
        f'<origin xyz="{word} 0 0"/>',
        f'<origin rpy="0 0 {word}"/>',
        AXIS + f'<mimic joint="k" offset="{word}"/>',
    ):
        with pytest.raises(NumberError) as caught:
            robot_of(with_joint(inside))
        assert str(caught.value).isprintable()


NUMBERS = {
    "1": 1.0,
    "+1": 1.0,
    "-0": 0.0,
    "1.": 1.0,
    ".5": 0.5,
    "1e3": 1000.0,
    "1E-3": 0.001,
    "+.5e+1": 5.0,
    "007": 7.0,
    "0.1000000000000000055511151231257827": 0.1,
    "4.9e-324": 5e-324,
    "1e-400": 0.0,
    "1" * 12: 111111111111.0,
}


@pytest.mark.parametrize(("word", "value"), NUMBERS.items())
def test_a_plain_decimal_number_is_read_as_it_is(word, value):
    assert joint_of(f'<origin xyz="{word} 0 0"/>').origin.xyz == (value, 0.0, 0.0)


@pytest.mark.parametrize("text", ["1 2 3", " 1 2 3 ", "1\t2\t3", "1\n2\n3", "1\r\n2  3", "&#9;1&#10;2&#13;3"])
def test_numbers_are_separated_by_any_white_space_of_xml(text):
    assert joint_of(f'<origin xyz="{text}"/>').origin.xyz == (1.0, 2.0, 3.0)


def test_numbers_separated_by_other_white_space_are_refused():
    for blank in "\xa0\u2003\u2028\x85,;":
        with pytest.raises(NumberError):
            robot_of(with_joint(f'<origin xyz="1{blank}2{blank}3"/>'))


def test_a_number_too_large_is_cut_in_the_message():
    with pytest.raises(NumberError, match="too large") as caught:
        robot_of(with_joint(f'<origin xyz="{"9" * 100_000} 0 0"/>'))
    assert len(str(caught.value)) < 500


# --- limits of size --------------------------------------------------------------------------------------------


def test_the_largest_depth_is_read_and_one_more_is_not():
    def chain(count: int) -> str:
        names = [f"l{i}" for i in range(count)]
        return f"<robot>{links(*names)}{''.join(joint(f'j{i}', f'l{i - 1}', f'l{i}') for i in range(1, count))}</robot>"

    assert len(robot_of(chain(400)).links) == 400
    with pytest.raises(LimitError, match="401 links deep; at most 400 are read"):
        robot_of(chain(401))


@pytest.mark.parametrize(("kind", "most"), [("continuous", 300), ("prismatic", 300), ("planar", 100), ("floating", 50)])
def test_the_most_degrees_of_freedom_are_read_and_one_joint_more_is_not(kind, most):
    def star(count: int) -> str:
        names = [f"l{i}" for i in range(count + 1)]
        joints = "".join(joint(f"j{i}", "l0", f"l{i}", kind, AXIS) for i in range(1, count + 1))
        return f"<robot>{links(*names)}{joints}</robot>"

    assert robot_of(star(most)).nv == 300
    with pytest.raises(LimitError, match="degrees of freedom; at most 300 are read"):
        robot_of(star(most + 1))


def test_followers_count_among_the_degrees_of_freedom_that_are_read():
    """Pinocchio loads followers as joints of their own: 1,000 of them take it gigabytes."""
    names = [f"l{i}" for i in range(1001)]
    follow = "".join(joint(f"j{i}", "l0", f"l{i}", "continuous", AXIS + '<mimic joint="j1"/>') for i in range(2, 1001))
    with pytest.raises(LimitError, match="at most"):
        robot_of(f"<robot>{links(*names)}{joint('j1', 'l0', 'l1', 'continuous', AXIS)}{follow}</robot>")


# --- remarks ---------------------------------------------------------------------------------------------------

REMARKS = {
    "no robot name": ('<robot><link name="a"/></robot>', [(1, "<robot>", "the robot has no name")]),
    "version 1": (
        '<robot name="r" version="1"><link name="a"/></robot>',
        [(1, "<robot name='r'>", "not of the form 1.0")],
    ),
    "version 1.1": (
        '<robot name="r" version="1.1"><link name="a"/></robot>',
        [(1, "<robot name='r'>", "parsers older than urdfdom 5")],
    ),
    "version 1.0": ('<robot name="r" version="1.0"><link name="a"/></robot>', []),
    "no axis": (with_joint(LIMIT), [(4, J, "no axis: URDF's default 1 0 0 holds")]),
    "a long axis": (with_joint('<axis xyz="0 0 2"/>' + LIMIT), [(4, J, "length 2: its direction counts")]),
    "a slightly long axis": (with_joint('<axis xyz="0 0.70711 0.70711"/>' + LIMIT), []),
    "a slanted planar joint": (with_joint('<axis xyz="0 1 0"/>', "planar"), [(4, J, "normal is not z")]),
    "a planar joint upside down": (with_joint('<axis xyz="0 0 -1"/>', "planar"), []),
    "no limit": (with_joint(AXIS), [(4, J, "no limit")]),
    "no limit for a continuous joint": (with_joint(AXIS, "continuous"), []),
    "no effort": (with_joint(AXIS + '<limit lower="-1" upper="1" velocity="1"/>'), [(4, J, "no effort")]),
    "no velocity": (with_joint(AXIS + '<limit lower="-1" upper="1" effort="1"/>'), [(4, J, "no velocity")]),
    "no lower": (
        with_joint(AXIS + '<limit upper="1" effort="1" velocity="1"/>'),
        [(4, J, "no lower: URDF's default 0")],
    ),
    "no upper": (
        with_joint(AXIS + '<limit lower="-1" effort="1" velocity="1"/>'),
        [(4, J, "no upper: URDF's default 0")],
    ),
    "a negative effort": (with_joint(AXIS + LIMIT.replace("10", "-10")), [(4, J, "the effort limit -10 is negative")]),
    "limits swapped": (with_joint(AXIS + LIMIT.replace('"-1"', '"3"')), [(4, J, "lower 3 is above upper 1")]),
    "limits alike": (with_joint(AXIS + LIMIT.replace('"-1"', '"1"')), [(4, J, "both 1: the joint cannot move")]),
    "an infinite limit": (with_joint(AXIS + LIMIT.replace('"-1"', '"-inf"')), [(4, J, "an infinite limit")]),
    "limits in degrees": (with_joint(AXIS + LIMIT.replace('"-1"', '"-180"')), [(4, J, "are these degrees?")]),
    "two turns": (with_joint(AXIS + LIMIT.replace('"-1"', f'"{1 - 4 * math.pi}"')), []),
    "a long slide": (with_joint(AXIS + LIMIT.replace('"-1"', '"-180"'), "prismatic"), []),
    "rpy in degrees": (
        with_joint(AXIS + LIMIT + '<origin rpy="0 0 90"/>'),
        [(4, J, "beyond a full turn: are these degrees?")],
    ),
    "a full turn in rpy": (with_joint(AXIS + LIMIT + '<origin rpy="0 0 6.2832"/>'), []),
    "two origins": (
        with_joint(AXIS + LIMIT + "<origin/>\n<origin/>"),
        [(4, J, "2 <origin> elements: the first, at line 4, counts")],
    ),
    "two parents in one joint": (with_joint(AXIS + LIMIT + '<parent link="b"/>'), [(4, J, "2 <parent> elements")]),
    "a leader that does not exist": (
        with_joint(AXIS + LIMIT + '<mimic joint="x"/>'),
        [(4, J, "mimics 'x', which does not exist")],
    ),
    "a fixed follower": (with_joint('<mimic joint="x"/>', "fixed"), [(4, J, "a mimic on a fixed joint has no effect")]),
    "multiplier 0": (
        with_joint(
            AXIS + LIMIT + '<mimic joint="k" multiplier="0"/>',
            more=links("c") + joint("k", "b", "c", "continuous", AXIS),
        ),
        [(4, J, "multiplier 0: the joint never moves")],
    ),
    "a long quaternion": (
        with_joint(AXIS + LIMIT + '<origin quat_xyzw="0 0 0 2"/>', root=' version="1.1"'),
        [(1, "<robot name='r'>", "1.1"), (4, f"{J}<origin>", "the quaternion has length 2: it is normalised")],
    ),
    "no mass": (
        f'<robot name="r"><link name="a"><inertial>{INERTIA}</inertial></link></robot>',
        [(1, "<link name='a'>", "no mass value: the link counts as massless")],
    ),
    "no inertia": (
        '<robot name="r"><link name="a"><inertial><mass value="1"/></inertial></link></robot>',
        [(1, "<link name='a'>", "no ixx, ixy, ixz, iyy, iyz, izz: the link counts as massless")],
    ),
    "half an inertia": (
        '<robot name="r"><link name="a"><inertial><mass value="1"/>'
        f"{INERTIA.replace('izz', 'jzz')}</inertial></link></robot>",
        [(1, "<link name='a'>", "no izz: the link counts as massless")],
    ),
    "two inertials": (
        f'<robot name="r"><link name="a">\n<inertial><mass value="1"/>{INERTIA}</inertial><inertial/></link></robot>',
        [(1, "<link name='a'>", "2 <inertial> elements: the first, at line 2, counts")],
    ),
    "blank lines and Latin-1": (
        '\n<?xml version="1.0" encoding="latin-1"?><robot name="r"><link name="a"/></robot>',
        [(1, "", "latin-1"), (1, "", "blank lines")],
    ),
    "Gazebo, transmissions and extensions": (
        '<robot name="r"><link name="a"/><gazebo/><transmission name="t"/><a:b/>'
        '<material name="m"/><material name="m"/></robot>',
        [],
    ),
}


@pytest.mark.parametrize(("text", "remarks"), REMARKS.values(), ids=REMARKS)
def test_what_is_odd_is_remarked_and_nothing_else(text, remarks):
    found = remarks_of(text)
    assert [(line, element) for line, element, _ in found] == [(line, element) for line, element, _ in remarks]
    assert all(part in said for (_, _, said), (_, _, part) in zip(found, remarks, strict=True)), found


def test_remarks_are_in_the_order_of_lines():
    text = with_joint("", more='<link name="c"/>\n' + joint("k", "b", "c", "revolute"), root=' version="1"')
    lines = [line for line, _, _ in remarks_of(text)]
    assert lines == sorted(lines)
    assert len(lines) == 5


# --- what is read ----------------------------------------------------------------------------------------------

JOINTS = {
    "defaults of a revolute joint": (joint_of, Joint("j", JointType.REVOLUTE, "a", "b", 4)),
    "a whole revolute joint": (
        lambda: joint_of('<origin xyz="1 2 3" rpy="0.1 0.2 0.3"/><axis xyz="0 0 -2"/>' + LIMIT),
        Joint(
            "j",
            JointType.REVOLUTE,
            "a",
            "b",
            4,
            Origin((1.0, 2.0, 3.0), (0.1, 0.2, 0.3)),
            (0.0, 0.0, -1.0),
            Limit(-1.0, 1.0, 10.0, 2.0),
        ),
    ),
    "an origin without attributes": (lambda: joint_of("<origin/>").origin, Origin()),
    "an origin without rpy": (lambda: joint_of('<origin xyz="1 2 3"/>').origin, Origin((1.0, 2.0, 3.0))),
    "an origin without xyz": (lambda: joint_of('<origin rpy="1 2 3"/>').origin, Origin(rpy=(1.0, 2.0, 3.0))),
    "a quaternion": (
        lambda: joint_of('<origin quat_xyzw="0 0 0 -2"/>', root=' version="1.1"').origin,
        Origin(quaternion_xyzw=(0.0, 0.0, 0.0, -1.0)),
    ),
    "a quaternion in version 2": (
        lambda: joint_of('<origin xyz="1 0 0" quat_xyzw="1 0 0 0"/>', root=' version="2.0"').origin,
        Origin((1.0, 0.0, 0.0), quaternion_xyzw=(1.0, 0.0, 0.0, 0.0)),
    ),
    "an empty limit": (lambda: joint_of("<limit/>").limit, Limit(0.0, 0.0)),
    "a limit of a continuous joint": (
        lambda: joint_of('<limit lower="-1" upper="1" effort="5"/>', "continuous").limit,
        Limit(effort=5.0),
    ),
    "infinite limits": (lambda: joint_of('<limit lower="-inf" upper="+Infinity"/>').limit, Limit(-math.inf, math.inf)),
    "limits swapped": (lambda: joint_of('<limit lower="1" upper="-1"/>').limit.range, (-1.0, 1.0)),
    "the axis of a fixed joint, whatever it says": (
        lambda: joint_of('<axis xyz="nonsense"/>', "fixed").axis,
        (1.0, 0.0, 0.0),
    ),
    "the axis of a floating joint, whatever it says": (
        lambda: joint_of('<axis xyz=""/>', "floating").axis,
        (1.0, 0.0, 0.0),
    ),
    "the first of two axes": (lambda: joint_of('<axis xyz="0 1 0"/><axis xyz="nonsense"/>').axis, (0.0, 1.0, 0.0)),
    "an axis that is not along an axis": (lambda: joint_of('<axis xyz="3 0 4"/>').axis, (0.6, 0.0, 0.8)),
    "a tiny axis that still has a direction": (lambda: joint_of('<axis xyz="0 1e-8 0"/>').axis, (0.0, 1.0, 0.0)),
    "defaults of a mimic": (
        lambda: joint_of(AXIS + '<mimic joint="k"/>', more=links("c") + joint("k", "b", "c", "continuous", AXIS)).mimic,
        Mimic("k", 1.0, 0.0),
    ),
    "a mimic": (
        lambda: (
            joint_of(
                AXIS + '<mimic joint="k" multiplier="-2" offset="0.5"/>',
                more=links("c") + joint("k", "b", "c", "prismatic", AXIS),
            ).mimic
        ),
        Mimic("k", -2.0, 0.5),
    ),
    "a mimic of nobody": (lambda: joint_of('<mimic joint="nobody"/>').mimic, None),
    "Drake's screw": (
        lambda: joint_of(AXIS + '<drake:screw_thread_pitch value=" 0.01 "/>', "screw", tag="drake:joint"),
        Joint("j", JointType.SCREW, "a", "b", 4, axis=(0.0, 0.0, 1.0), pitch=0.01),
    ),
    "Drake's planar joint": (lambda: joint_of(AXIS, "planar", tag="drake:joint").type, JointType.PLANAR),
}


@pytest.mark.parametrize(("found", "expected"), JOINTS.values(), ids=JOINTS)
def test_a_joint_is_read_as_it_is_written(found, expected):
    assert found() == expected


@pytest.mark.parametrize("kind", [t.value for t in JointType if t is not JointType.SCREW])
def test_every_type_of_joint_is_read(kind):
    found = joint_of(AXIS, kind)
    assert found.type == kind
    assert len(found.velocity_names) == found.type.nv
    assert len(found.position_names) == found.type.nq


def test_an_inertial_is_read():
    inertia = '<inertia ixx="1" ixy="2" ixz="3" iyy="4" iyz="5" izz="6"/>'
    inertial = f'<inertial><origin xyz="1 2 3"/><mass value="4"/>{inertia}</inertial>'
    text = f'<robot><link name="a">{inertial}</link></robot>'
    assert robot_of(text).links[0].inertial == Inertial(4.0, Origin((1.0, 2.0, 3.0)), (1.0, 2.0, 3.0, 4.0, 5.0, 6.0))


def test_an_incomplete_inertial_counts_as_none():
    for missing in ('<mass value="1"/>', INERTIA, "", "<mass/>" + INERTIA):
        assert (
            robot_of(f'<robot><link name="a"><inertial>{missing}</inertial></link></robot>').links[0].inertial is None
        )


def test_meshes_of_visuals_and_collisions_are_noted():
    inside = "".join(
        f'<{kind}><geometry>\n<mesh filename="{kind}.stl"/></geometry></{kind}>' for kind in ("visual", "collision")
    )
    found = (
        robot_of(f'<robot><link name="a">{inside}<visual><geometry><mesh/></geometry></visual></link></robot>')
        .links[0]
        .meshes
    )
    assert [(mesh.uri, mesh.line) for mesh in found] == [("visual.stl", 2), ("collision.stl", 3)]


def test_links_and_joints_may_come_in_any_order():
    robot = robot_of(f"<robot>{joint('k', 'b', 'a')}{links('a')}{joint('j', 'c', 'b')}{links('b', 'c')}</robot>")
    assert (robot.root, robot.tips) == ("c", ("a",))
    assert [j.name for j in robot.joints] == ["k", "j"]


def test_a_link_and_a_joint_may_share_a_name():
    robot = robot_of(f"<robot>{links('a', 'b')}{joint('a', 'a', 'b')}</robot>")
    assert robot.frame("a") == "a"
    assert robot.joint_by_name["a"].child == "b"


@pytest.mark.parametrize(
    "name",
    ["a b", " a", "a/b", "a.b", "é", "机器人", "'", "a&#10;b", "a&#9;b", "x" * 10_000, "-f", "[red]", "\u202eab"],
)
def test_any_other_name_is_read(name):
    robot = robot_of(f'<robot name="r"><link name="{name}"/></robot>')
    assert robot.root == name.replace("&#10;", "\n").replace("&#9;", "\t")


# --- followers -------------------------------------------------------------------------------------------------


def followers(*laws: tuple[str, str, float, float]) -> Robot:
    """Return a star of continuous joints j0 (the leader), and one joint per (name, leader, multiplier, offset)."""
    names = ["j0", *(law[0] for law in laws)]
    joints = [joint("j0", "base", "j0", "continuous", AXIS)]
    for name, leader, multiplier, offset in laws:
        mimic = f'<mimic joint="{leader}" multiplier="{multiplier}" offset="{offset}"/>'
        joints.append(joint(name, "base", name, "continuous", AXIS + mimic))
    return robot_of(f"<robot>{links('base', *names)}{''.join(joints)}</robot>")


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
def test_chains_of_followers_end_at_the_joint_that_leads_them(order):
    laws = [("j1", "j0", 2.0, 0.5), ("j2", "j1", -3.0, 1.0), ("j3", "j2", 0.5, 0.0)]
    robot = followers(*(laws[i] for i in order))
    assert robot.followers == {
        "j1": Mimic("j0", 2.0, 0.5),
        "j2": Mimic("j0", -6.0, -0.5),
        "j3": Mimic("j0", -3.0, -0.25),
    }
    assert [j.name for j in robot.independent] == ["j0"]


def test_a_long_chain_of_followers_costs_no_recursion():
    robot = followers(*((f"j{i}", f"j{i - 1}", 1.0, 1.0) for i in range(1, 250)))
    assert robot.followers["j249"] == Mimic("j0", 1.0, 249.0)
