"""Whatever the reader accepts, Pinocchio accepts in the canonical text, and reads the same numbers from it."""

from __future__ import annotations

import io
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.urdf.canonical import SCREW_PITCH, canonical_text
from kinetostat.urdf.document import parse

INERTIA = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'


def robot(
    joint: str = "",
    *,
    kind: str = "revolute",
    link: str = "",
    root: str = 'name="r"',
    before: str = "",
    tag: str = "joint",
) -> bytes:
    return (
        f'{before}<robot {root}><link name="a"/><link name="b">{link}</link>'
        f'<{tag} name="j" type="{kind}"><parent link="a"/><child link="b"/>{joint}</{tag}></robot>'
    ).encode()


AXIS, LIMIT = '<axis xyz="0 0 1"/>', '<limit lower="-1" upper="1" effort="1" velocity="1"/>'

# What urdfdom, and so Pinocchio, refuses, chokes on, or reads otherwise than it is written.
ACCEPTED = {
    "a processing instruction": robot(before="<?note?>", joint=f"<?note?>{AXIS}{LIMIT}"),
    "a processing instruction in a geometry": robot(
        link="<visual><geometry><?x y?><box size='1 1 1'/></geometry></visual>"
    ),
    "comments everywhere": robot(before="<!-- a -->", joint="<!-- b --><origin/><!-- c -->", link="<!-- d -->"),
    "tabs between numbers": robot('<origin xyz="1&#9;2&#9;3"/><axis xyz="0&#9;0&#9;1"/>'),
    "line breaks between numbers": robot('<origin xyz="1&#10;2&#13;&#10;3"/>'),
    "blanks around numbers": robot('<origin xyz="  1   2  3 " rpy=" 0 0  1 "/>'),
    "blanks around a mimic's numbers": robot(AXIS + '<mimic joint="x" multiplier=" 1 " offset="&#10;2"/>'),
    "a mass with blanks": robot(link=f'<inertial><mass value="&#9;1 "/>{INERTIA}</inertial>'),
    "plus signs": robot('<origin xyz="+1 +.5 1.e+0"/>'),
    "the same material twice": robot(link="<visual><geometry/><material name='m'/></visual>").replace(
        b"<link", b"<material name='m'/><material name='m'/><link", 1
    ),
    "a material without a name": robot(link="<visual><geometry/><material/></visual>"),
    "a colour in words": robot().replace(b"<link", b"<material name='m'><color rgba='red'/></material><link", 1),
    "a geometry without a shape": robot(link="<visual><geometry/></visual><collision/>"),
    "a mesh without a file": robot(link="<visual><geometry><mesh/></geometry></visual>"),
    "a sphere of NaN": robot(link='<collision><geometry><sphere radius="nan"/></geometry></collision>'),
    "a visual's origin of NaN": robot(link='<visual><origin xyz="nan nan nan"/><geometry/></visual>'),
    "no limit": robot(AXIS),
    "no effort": robot(AXIS + '<limit lower="-1" upper="1"/>'),
    "an empty limit": robot(AXIS + "<limit/>"),
    "infinite limits": robot(AXIS + '<limit lower="-inf" upper="inf" effort="inf" velocity="Infinity"/>'),
    "limits the wrong way round": robot(AXIS + '<limit lower="1" upper="-1" effort="-1" velocity="-1"/>'),
    "a sliding joint without a limit": robot(AXIS, kind="prismatic"),
    "half a safety controller": robot(AXIS + LIMIT + "<safety_controller/>"),
    "an empty calibration": robot(AXIS + LIMIT + '<calibration rising="x"/>'),
    "empty dynamics": robot(AXIS + LIMIT + "<dynamics/>"),
    "no robot name": robot(root=""),
    "an empty robot name": robot(root='name=""'),
    "a robot name with a line break": robot(root='name="a&#10;b&quot;"'),
    "version 1": robot(root='name="r" version="1"'),
    "version 1.1": robot(root='name="r" version="1.1"'),
    "version 1.2": robot(root='name="r" version=" 1.2 "'),
    "version 2.0": robot(root='name="r" version="2.0"'),
    "version 9": robot(root='name="r" version="9"'),
    "elements nested 600 deep": robot(link="<x>" * 600 + "</x>" * 600),
    "prefixes that are not bound": robot('<drake:damping value="1"/>', root='name="r" a:b="c"').replace(
        b"<axis", b"<axis u:v='w'"
    ),
    "an origin with prefixed attributes": robot('<origin xyz="1 2 3" drake:note="x"/>'),
    "an origin with foreign attributes": robot('<origin xyz="1 2 3" note="x"/>'),
    "transmissions and Gazebo blocks": robot().replace(
        b"</robot>", b"<transmission/><gazebo reference='b'/><joint_x/></robot>"
    ),
    "a joint in a transmission": robot().replace(
        b"</robot>", b"<transmission><joint name='j'/><link name='a'/></transmission></robot>"
    ),
    "a joint and a link of one name": robot().replace(b'name="j"', b'name="b"'),
    "a link called universe": robot().replace(b'"b"', b'"universe"'),
    "the root link called universe": robot().replace(b'"a"', b'"universe"'),
    "a joint called root_joint": robot(AXIS).replace(b'"j"', b'"root_joint"'),
    "a link called root_joint": robot(AXIS).replace(b'"b"', b'"root_joint"'),
    "names with blanks": robot(AXIS).replace(b'"j"', b'" j k "').replace(b'"b"', b'" b&#10;c&#9;"'),
    "names with quotes and brackets": robot(AXIS).replace(b'"b"', b"'&quot;&lt;b&gt;&amp;&apos;'"),
    "names beyond ASCII": robot(AXIS).replace(b'"b"', '"Gelenk é 机器 \U0001f916"'.encode()),
    "names of 10,000 letters": robot(AXIS).replace(b'"b"', b'"' + b"b" * 10_000 + b'"'),
    "Latin-1": robot(AXIS, before='<?xml version="1.0" encoding="latin-1"?>').replace(b'"b"', b'"\xe9"'),
    "blank lines first": robot(AXIS, before='\n\n<?xml version="1.0"?>'),
    "an inertial without a mass": robot(link=f"<inertial>{INERTIA}</inertial>"),
    "an inertial without an inertia": robot(link='<inertial><mass value="1"/></inertial>'),
    "an inertial without izz": robot(link=f'<inertial><mass value="1"/>{INERTIA.replace("izz", "jzz")}</inertial>'),
    "an empty inertial": robot(link="<inertial/>"),
    "an empty inertial before a full one": robot(link=f'<inertial/><inertial><mass value="1"/>{INERTIA}</inertial>'),
    "a full inertial before an empty one": robot(link=f'<inertial><mass value="1"/>{INERTIA}</inertial><inertial/>'),
    "two masses": robot(link=f'<inertial><mass value="1"/><mass value="2"/>{INERTIA}</inertial>'),
    "a massless inertial": robot(link=f'<inertial><mass value="0"/>{INERTIA}</inertial>'),
    "a negative mass": robot(link=f'<inertial><mass value="-1"/>{INERTIA}</inertial>'),
    "a nonsensical axis of a fixed joint": robot('<axis xyz="x"/>', kind="fixed"),
    "a nonsensical axis of a floating joint": robot('<axis xyz="x"/>', kind="floating"),
    "an empty axis of a floating joint": robot("<axis/>", kind="floating"),
    "a zero axis of a fixed joint": robot('<axis xyz="0 0 0"/>', kind="fixed"),
    "two axes": robot('<axis xyz="0 1 0"/><axis xyz="0 0 1"/>'),
    "two origins": robot('<origin xyz="1 2 3"/><origin xyz="x"/>'),
    "two mimics": robot(AXIS + "<mimic joint='x'/><mimic joint='y' multiplier='z'/>"),
    "two parents": robot('<parent link="b"/><child link="a"/>'),
    "a mimic on a fixed joint": robot('<mimic joint="j"/>', kind="fixed"),
    "a mimic of no joint that exists": robot(AXIS + '<mimic joint="x" multiplier="3"/>'),
    "a long axis": robot('<axis xyz="0 0 1e6"/>'),
    "a short axis": robot('<axis xyz="1e-8 0 0"/>'),
    "a nearly straight axis": robot('<axis xyz="9e-13 0 1"/>'),
    "a nearly straight sliding axis": robot('<axis xyz="9e-13 0 1"/>', kind="prismatic"),
    "a nearly straight continuous axis": robot('<axis xyz="0 9e-13 -1"/>', kind="continuous"),
    "a planar joint": robot(AXIS, kind="planar"),
    "a planar joint without an axis": robot(kind="planar"),
    "a slanted planar joint": robot('<axis xyz="0 0.6 0.8"/>', kind="planar"),
    "a planar joint upside down": robot('<axis xyz="0 0 -1"/>', kind="planar"),
    "a planar joint nearly upside down": robot('<axis xyz="1e-5 2e-7 -1"/>', kind="planar"),
    "a planar joint all but upside down": robot('<axis xyz="1e-9 1e-9 -1"/>', kind="planar"),
    "a floating joint": robot(kind="floating"),
    "a screw": robot(
        '<axis xyz="0 0.6 0.8"/><drake:screw_thread_pitch value=" 0.01"/>', kind="screw", tag="drake:joint"
    ),
    "a screw that follows nobody": robot(
        AXIS + '<drake:screw_thread_pitch value="1"/><mimic joint="x"/>', kind="screw", tag="drake:joint"
    ),
    "a quaternion": robot('<origin xyz="1 2 3" quat_xyzw="0.5 0.5 0.5 0.5"/>', root='name="r" version="1.1"'),
    "a long quaternion": robot('<origin quat_xyzw="0 0 3 4"/>', root='name="r" version="1.1"'),
    "a quaternion in version 2": robot('<origin quat_xyzw="0 1 0 0"/>', root='name="r" version="2"'),
    "rpy at its singularity": robot('<origin rpy="1 1.5707963267948966 2"/>'),
    "large rpy": robot('<origin rpy="1000 -2000 3000"/>'),
}


@pytest.mark.parametrize("data", ACCEPTED.values(), ids=ACCEPTED)
def test_both_engines_read_the_same_robot(data):
    model = ks.load("-", stdin=io.BytesIO(data))
    assert ks.summary(model).certificate.agree is True
    for wanted in ("zero", "random:3"):
        q = ks.configuration(model.robot, wanted).q
        for reference in ks.Reference:
            result = ks.jacobian(model, model.robot.links[-1].name, q, reference=reference)
            assert result.certificate.agree is True, result.certificate
            assert np.isfinite(result.matrix).all()


@pytest.mark.parametrize("name", [name for name in ACCEPTED if "universe" not in name and "root_joint" not in name])
def test_both_engines_read_the_same_floating_robot(name):
    model = ks.load("-", stdin=io.BytesIO(ACCEPTED[name]), floating_base=True)
    q = ks.configuration(model.robot, "random:3").q
    assert ks.jacobian(model, model.robot.links[-1].name, q).certificate.agree is True


@pytest.mark.parametrize("kind", ["fixed", "revolute", "continuous", "prismatic", "planar", "floating"])
def test_a_joint_called_universe_is_refused_or_read_alike(kind):
    """Pinocchio calls its own first joint and frame so: under a fixed joint of that name it loses the child's mass."""
    data = robot('<origin xyz="1 2 3"/>' + AXIS, kind=kind, link=f'<inertial><mass value="1"/>{INERTIA}</inertial>')
    try:
        model = ks.load("-", stdin=io.BytesIO(data.replace(b'"j"', b'"universe"')))
    except ks.StructureError as error:
        refused = str(error)
    else:
        refused = ""
    if refused:
        assert "universe" in refused
        return
    assert ks.summary(model).certificate.agree is True
    q = ks.configuration(model.robot, "random:1").q
    assert ks.fk(model, "b", q).certificate.agree is True
    assert ks.jacobian(model, "b", q).certificate.agree is True


@pytest.mark.parametrize(
    ("data", "mass"),
    [
        (ACCEPTED["a mass with blanks"], 1.0),
        (ACCEPTED["an inertial without an inertia"], 0.0),
        (ACCEPTED["an empty inertial before a full one"], 0.0),
        (ACCEPTED["a full inertial before an empty one"], 1.0),
        (ACCEPTED["two masses"], 1.0),
        (ACCEPTED["a negative mass"], -1.0),
    ],
)
def test_masses_are_those_that_the_reader_says_count(data, mass):
    found = ks.summary(ks.load("-", stdin=io.BytesIO(data)))
    assert (found.base_mass, found.moving_mass) == (0.0, mass)


def text_of(data: bytes) -> ET.Element:
    return ET.fromstring(canonical_text(parse(data, "f")))


def test_nothing_but_kinematics_is_left():
    data = robot(
        AXIS + LIMIT + "<dynamics/><safety_controller/><calibration/>",
        link=f"<visual/><collision/><inertial><mass value='1'/>{INERTIA}<note/></inertial><x/>",
        before="<!-- --><?x?>",
    ).replace(b"</robot>", b"<gazebo/><transmission/><material name='m'/></robot>")
    assert {element.tag for element in text_of(data).iter()} == {
        *("robot", "link", "inertial", "mass", "inertia", "joint", "parent", "child", "axis", "limit")
    }


@pytest.mark.parametrize(
    ("written", "version"),
    [(None, None), ("1", None), ("1.0", None), (" 1.0 ", None), ("1.1", "1.1"), ("1.2", "1.1"), ("2", "1.1")],
)
def test_the_version_is_one_that_urdfdom_knows(written, version):
    root = "" if written is None else f'version="{written}"'
    assert text_of(robot(root=f'name="r" {root}')).get("version") == version


def test_numbers_are_the_strings_of_the_file():
    """Pinocchio reads every number by itself: nothing of ours has rounded it."""
    origin = text_of(robot('<origin xyz="+0.10000000000000000555 1.e0&#9;-.5E-3" rpy="0 0 0"/>')).find("joint/origin")
    assert origin is not None
    assert origin.get("xyz") == "+0.10000000000000000555 1.e0 -.5E-3"


def test_names_are_those_of_the_file():
    data = robot().replace(b'"b"', b'" b&#10;&#9;&lt;&quot; "')
    assert [link.get("name") for link in text_of(data).iter("link")] == ["a", ' b\n\t<" ']


def test_a_screw_is_a_revolute_joint_with_its_pitch_inside():
    joint = text_of(ACCEPTED["a screw"]).find("joint")
    assert joint is not None
    pitch = joint.find(SCREW_PITCH)
    assert (joint.get("type"), pitch is not None and pitch.get("value")) == ("revolute", "0.01")
