"""What `info` knows of a robot."""

import pytest

import kinetostat as ks
from kinetostat.urdf.files import example_robots, short_names

ODD = """<robot name="odd">
  <link name="base"><inertial>
    <mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="arm 1"><inertial><mass value="-1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <visual><geometry><mesh filename="package://nowhere/a.stl"/></geometry></visual></link>
  <link name="tool"><inertial>
    <mass value="3"/><inertia ixx="9" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="Tool"/>
  <joint name="tool" type="revolute"><parent link="base"/><child link="arm 1"/><axis xyz="0 0 1"/>
    <limit lower="1" upper="2" effort="1" velocity="1"/></joint>
  <joint name="free" type="floating"><parent link="arm 1"/><child link="tool"/></joint>
  <joint name="fix" type="fixed"><parent link="tool"/><child link="Tool"/></joint>
</robot>"""

EXPECTED = {
    (4, "white space"),
    (4, "mass -1 kg is negative"),
    (5, "'package://nowhere/a.stl': the package is not found"),
    (6, "triangle inequality: principal moments 1, 1, 9 kg m2"),
    (8, "differs from 'tool' by upper and lower case"),
    (9, "a link has the same name"),
    (9, "position 0 is outside its limits [1, 2]"),
    (11, "a floating joint"),
}


@pytest.fixture
def odd(tmp_path):
    path = tmp_path / "odd.urdf"
    path.write_text(ODD)
    return ks.summary(ks.load(path))


def test_what_is_odd_is_told_with_its_line(odd):
    found = {(remark.line, remark.text) for remark in odd.remarks}
    for line, part in EXPECTED:
        assert any(where == line and part in text for where, text in found), (line, part)
    assert len(found) == len(EXPECTED)


def test_masses_with_and_without_the_base(odd):
    assert (odd.base_mass, odd.moving_mass) == (2, 2)
    assert odd.certificate.agree


def test_chains_name_every_tip_with_its_joints(odd):
    assert [(chain.tip, chain.joints) for chain in odd.chains] == [("Tool", ("tool", "free"))]


def test_a_clean_file_has_nothing_odd():
    assert ks.summary(ks.load("textbook:planar_2r")).remarks == ()


@pytest.mark.parametrize("name", [name for name in short_names(example_robots()) if name != "ur3"])  # an empty file
def test_real_robots_have_a_certified_mass_and_all_their_tips(name):
    result = ks.summary(ks.load(f"example:{name}"))
    assert result.certificate.agree
    assert result.base_mass + result.moving_mass > 0 or not any(link.inertial for link in result.robot.links)
    parents = {joint.parent for joint in result.robot.joints}
    assert {chain.tip for chain in result.chains} == {link.name for link in result.robot.links} - parents
