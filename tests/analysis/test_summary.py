"""What `info` knows of a robot."""

import pytest

import kinetostat as ks
from kinetostat.lint.linting import oddities
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

# By line and rule; that position 0 is outside limits is an info, which `info` leaves to `check`.
EXPECTED = {
    (4, "N101"),
    (4, "I102"),
    (5, "M106"),
    (7, "I203"),
    (8, "N105"),
    (9, "T112"),
    (11, "T111"),
}


@pytest.fixture
def odd(tmp_path):
    path = tmp_path / "odd.urdf"
    path.write_text(ODD)
    return ks.summary(ks.load(path))


def test_what_is_odd_is_told_with_its_line(tmp_path):
    (tmp_path / "odd.urdf").write_text(ODD)
    assert {(finding.line, finding.code) for finding in oddities(ks.load(tmp_path / "odd.urdf"))} == EXPECTED


def test_masses_with_and_without_the_base(odd):
    assert (odd.base_mass, odd.moving_mass) == (2, 2)
    assert odd.certificate.agree


def test_chains_name_every_tip_with_its_joints(odd):
    assert [(chain.tip, chain.joints) for chain in odd.chains] == [("Tool", ("tool", "free"))]


def test_what_the_reader_assumes_is_remarked(odd):
    assert ks.summary(ks.load("textbook:planar_2r")).remarks == ()
    assert odd.remarks == odd.robot.remarks


@pytest.mark.parametrize("name", [name for name in short_names(example_robots()) if name != "ur3"])  # an empty file
def test_real_robots_have_a_certified_mass_and_all_their_tips(name):
    result = ks.summary(ks.load(f"example:{name}"))
    assert result.certificate.agree
    assert result.base_mass + result.moving_mass > 0 or not any(link.inertial for link in result.robot.links)
    parents = {joint.parent for joint in result.robot.joints}
    assert {chain.tip for chain in result.chains} == {link.name for link in result.robot.links} - parents
