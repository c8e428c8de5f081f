"""What changed in meaning: nothing by spelling, renames as renames, every value with its size."""

import math
import time
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import kinetostat as ks
from difference_support import compared, document, edited, from_xml, joint, link, plain, put, renaming, told
from kinetostat.analysis.difference.difference import difference
from kinetostat.analysis.difference.matching import match
from kinetostat.urdf.files import example_robots
from trees import ALL_KINDS, load_text, random_urdf

KINDS = tuple(kind for kind in ALL_KINDS if kind != "screw")  # Drake's prefix is no XML for other readers
UR5, PANDA, PLANAR = "example:ur5_robot", "example:panda", "textbook:planar_2r"


def readable(name):
    try:
        ks.load(name)
    except ks.RobotError:  # one file of the package holds no robot
        return False
    return True


@pytest.mark.parametrize("name", [f"example:{name}" for name in example_robots()])
def test_a_robot_does_not_differ_from_itself(name):
    if not readable(name):
        assert name == "example:ur_description/ur3"
        return
    a, b = ks.load(name), ks.load(name)
    begun = time.perf_counter()
    result = difference(a, b)
    assert time.perf_counter() - begun < 1
    assert not result.exceeds
    assert (result.changes, result.consequences.tips, result.consequences.worst_gravity) == ((),) * 3
    (note,) = result.notes
    assert note.startswith("not compared: ")


@pytest.mark.parametrize("seed", range(20))
def test_renaming_everything_is_renames_alone(seed):
    """Random trees of every joint type, every name replaced by one that has nothing of the old."""
    text, names = random_urdf(seed, kinds=KINDS, most=10), {}
    root = ET.fromstring(text)
    renaming(root, lambda name: names.setdefault(name, f"n{len(names)}x"))
    a, b = load_text(text), from_xml(root)
    result = difference(a, b)
    assert {(c.kind, c.attribute) for c in result.changes} == {("renamed", "name")}
    assert len(result.changes) == len(a.robot.links) + len(a.robot.joints)
    assert not result.consequences.tips


@pytest.mark.parametrize("source", [UR5, PANDA, "example:solo12", "example:hyq_no_sensors", "example:talos_full_v2"])
def test_a_new_prefix_is_renames_to_those_names(source):
    result = compared(source, lambda root: renaming(root, lambda name: f"left/{name}"))
    assert all(c.kind == "renamed" and c.after == f"left/{c.name}" for c in result.changes)
    assert not result.consequences.tips


def test_a_new_prefix_and_a_moved_tool_are_renames_and_a_position():
    def change(root):
        put(joint(root, "tool_joint"), "origin", xyz="0.8 0 0.002")
        renaming(root, lambda name: f"left_{name}")

    result = compared(PLANAR, change)
    (moved,) = [c for c in result.changes if c.kind != "renamed"]
    assert (moved.kind, moved.name, moved.attribute) == ("changed", "tool_joint", "position")
    assert len(result.changes) == 1 + 4 + 3


def test_a_new_prefix_and_a_moved_first_joint_are_renames_and_a_position():
    def change(root):
        put(joint(root, "joint1"), "origin", xyz="0 0 0.1")
        renaming(root, lambda name: f"r{name}"[::-1])

    result = compared(PLANAR, change)
    assert [t for t in told(result) if t[0] != "renamed"] == [("changed", "joint", "joint1", "position")]


def test_spelling_makes_no_difference():
    """Order, comments, materials, axes of another length, the other three rpy angles of a rotation, inertia axes."""

    def respelled(root):
        root.set("version", "1.0")
        for element in root.iter("origin"):
            r, p, y = (float(word) for word in element.get("rpy", "0 0 0").split())
            element.set("rpy", f"{r + math.pi!r} {math.pi - p!r} {y + math.pi!r}")
        for element in root.iter("axis"):
            element.set("xyz", " ".join(str(3 * float(word)) for word in element.get("xyz").split()))
        for element in root.findall("material"):
            root.remove(element)
        for element in root.iter("link"):
            for shown in element.findall("visual") + element.findall("collision"):
                element.remove(shown)
        root[:] = [ET.Comment(" turned round "), *root[:][::-1]]

    for source in (UR5, PANDA, "example:solo12"):
        result = compared(source, respelled)
        assert result.changes == ()
        assert not result.exceeds
        order, _ = result.notes
        assert order == "the joints are in another order in the file, in which plain lists of positions are read"


def test_an_inertia_in_turned_axes_is_the_same():
    def turned(root):
        inertial = link(root, "link1").find("inertial")
        put(inertial, "origin", rpy="0 0 1.5707963267948966")
        put(inertial, "inertia", ixx="0.334933", iyy="0.0032")

    assert compared(PLANAR, turned).changes == ()


def test_a_fixed_link_put_in_between_moves_nothing():
    def insert(root):
        put(joint(root, "tool_joint"), "parent", link="flange")
        put(joint(root, "tool_joint"), "origin", xyz="0.3 0 0")
        root.append(ET.fromstring('<link name="flange"/>'))
        root.append(
            ET.fromstring(
                '<joint name="flange_joint" type="fixed"><parent link="link2"/><child link="flange"/>'
                '<origin xyz="0.5 0 0"/></joint>'
            )
        )

    result = compared(PLANAR, insert)
    assert told(result) == [("added", "joint", "flange_joint", ""), ("added", "link", "flange", "")]
    assert result.consequences.tips == ()
    back = difference(edited(PLANAR, insert), plain(PLANAR))
    assert told(back) == [("removed", "joint", "flange_joint", ""), ("removed", "link", "flange", "")]


def test_a_renamed_tool_beyond_an_inserted_link_is_a_rename():
    def insert(root):
        tool = joint(root, "tool_joint")
        put(tool, "parent", link="flange")
        put(tool, "child", link="gripper")
        put(tool, "origin", xyz="0.3 0 0")
        tool.set("name", "gripper_mount")
        link(root, "tool").set("name", "gripper")
        root.append(ET.fromstring('<link name="flange"/>'))
        root.append(
            ET.fromstring(
                '<joint name="flange_joint" type="fixed"><parent link="link2"/><child link="flange"/>'
                '<origin xyz="0.5 0 0"/></joint>'
            )
        )

    kinds = {(c.kind, c.name) for c in compared(PLANAR, insert).changes}
    assert kinds == {
        ("added", "flange_joint"),
        ("added", "flange"),
        ("renamed", "tool_joint"),
        ("renamed", "tool"),
    }


def test_a_new_root_below_the_old_one_is_told_and_moves_nothing():
    def mounted(root):
        root.insert(0, ET.fromstring('<link name="world"/>'))
        root.append(
            ET.fromstring(
                '<joint name="mount" type="fixed"><parent link="world"/><child link="base"/>'
                '<origin xyz="1 2 3"/></joint>'
            )
        )

    result = compared(PLANAR, mounted)
    assert told(result) == [
        ("changed", "robot", "planar_2r", "root link"),
        ("added", "joint", "mount", ""),
        ("added", "link", "world", ""),
    ]
    assert result.consequences.tips == ()


CHANGES = {
    "a position": (UR5, "elbow_joint", "position", 0.002, "m", {"origin": {"xyz": "0 -0.1197 0.427"}}),
    "an axis": (UR5, "elbow_joint", "axis", math.pi / 2, "rad", {"axis": {"xyz": "0 0 1"}}),
    "the other axis": (UR5, "elbow_joint", "axis", math.pi, "rad", {"axis": {"xyz": "0 -1 0"}}),
    "a lower limit": (PLANAR, "joint2", "lower", math.pi - 3, "rad", {"limit": {"lower": "-3"}}),
    "an upper limit": (PLANAR, "joint2", "upper", math.pi - 1, "rad", {"limit": {"upper": "1"}}),
    "an effort limit": (PLANAR, "joint2", "effort", 5.0, "Nm", {"limit": {"effort": "25"}}),
    "a speed limit": (PLANAR, "joint2", "velocity", 1.0, "rad/s", {"limit": {"velocity": "2"}}),
}


@pytest.mark.parametrize("case", CHANGES)
def test_one_changed_value_is_one_change_with_its_size(case):
    source, name, attribute, size, unit, values = CHANGES[case]

    def change(root):
        for path, attributes in values.items():
            put(joint(root, name), path, **attributes)

    (found,) = compared(source, change).changes
    assert (found.kind, found.element, found.name, found.attribute) == ("changed", "joint", name, attribute)
    assert found.size == pytest.approx(size, rel=1e-9)
    assert found.unit == unit
    (back,) = difference(edited(source, change), plain(source)).changes
    assert (back.before, back.after, back.size) == (found.after, found.before, pytest.approx(found.size))


def test_an_orientation_is_told_by_its_angle():
    (found,) = compared(
        UR5, lambda root: put(joint(root, "ee_fixed_joint"), "origin", rpy="0 0.3 1.57079632679")
    ).changes
    assert (found.attribute, found.unit) == ("orientation", "rad")
    assert found.size == pytest.approx(0.3)


def test_masses_and_their_places():
    def change(root):
        inertial = link(root, "link1").find("inertial")
        put(inertial, "mass", value="4.4")
        put(inertial, "origin", xyz="0.5 0.03 0.04")
        put(inertial, "inertia", izz="0.4")

    mass, centre, inertia = compared(PLANAR, change).changes
    assert (mass.attribute, mass.before, mass.after, mass.unit) == ("mass", 4.0, 4.4, "kg")
    assert (centre.attribute, centre.size, centre.unit) == ("centre of mass", pytest.approx(0.05), "m")
    assert (inertia.attribute, inertia.unit) == ("inertia", "kg m2")
    assert inertia.size == pytest.approx(0.4 - 0.334933)


def test_no_inertial_is_no_mass():
    def change(root):
        link(root, "tool").append(
            ET.fromstring(
                '<inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>'
            )
        )

    assert compared(PLANAR, change).changes == ()
    removed = compared(PLANAR, lambda root: link(root, "link2").remove(link(root, "link2").find("inertial")))
    assert [c.attribute for c in removed.changes] == ["mass", "inertia"]
    assert removed.changes[0].after == 0


def test_limits_the_other_way_round_and_infinite_ones():
    def swapped(root):
        put(joint(root, "joint1"), "limit", lower="3.141592653589793", upper="-3.141592653589793")

    result = compared(PLANAR, swapped)
    assert [(c.attribute, c.before, c.after) for c in result.changes] == [
        ("lower", -math.pi, math.pi),
        ("upper", math.pi, -math.pi),
    ]
    assert result.notes[0].startswith("joint 'joint1': lower is above upper now")
    back = difference(edited(PLANAR, swapped), plain(PLANAR))
    assert len(back.changes) == 2
    assert "lower was above upper" in back.notes[0]
    both = difference(edited(PLANAR, swapped), edited(PLANAR, swapped))
    assert (both.changes, len(both.notes)) == ((), 1)
    kind, lower, upper = compared(PLANAR, lambda root: joint(root, "joint1").set("type", "continuous")).changes
    assert (kind.attribute, kind.before, kind.after) == ("type", "revolute", "continuous")
    assert (lower.after, upper.after, lower.size, upper.size) == (None, None, None, None)


@pytest.mark.parametrize("attribute", ["effort", "velocity"])
def test_what_is_not_stated_any_more_is_a_change_beyond_any_tolerance(attribute):
    def drop(root):
        del joint(root, "joint1").find("limit").attrib[attribute]

    (gone,) = compared(PLANAR, drop, tolerance=10, relative=10).changes
    assert (gone.attribute, gone.after, gone.size) == (attribute, None, None)
    assert gone.before > 0
    (come,) = difference(edited(PLANAR, drop), plain(PLANAR), tolerance=10, relative=10).changes
    assert (come.before, come.after) == (None, gone.before)


def test_a_lost_limit_is_four_changes():
    def drop(root):
        joint(root, "joint1").remove(joint(root, "joint1").find("limit"))

    found = compared(PLANAR, drop, tolerance=10, relative=10).changes
    assert [(c.attribute, c.after) for c in found] == [
        ("lower", None),
        ("upper", None),
        ("effort", None),
        ("velocity", None),
    ]


def test_types_and_parents():
    result = compared(PLANAR, lambda root: joint(root, "joint2").set("type", "prismatic"))
    assert told(result) == [("changed", "joint", "joint2", "type")]
    result = compared(PLANAR, lambda root: put(joint(root, "tool_joint"), "parent", link="link1"))
    (found,) = result.changes
    assert (found.attribute, found.before, found.after) == ("parent", "link2", "link1")


FINGER = "panda_finger_joint2"


def test_laws_of_followers():
    def law(root):
        return joint(root, FINGER)

    result = compared(PANDA, lambda root: put(law(root), "mimic", multiplier="0.5", offset="0.01"))
    assert told(result) == [
        ("changed", "joint", FINGER, "mimic multiplier"),
        ("changed", "joint", FINGER, "mimic offset"),
    ]
    assert (result.changes[0].before, result.changes[0].after, result.changes[0].size) == (1, 0.5, 0.5)
    assert (result.changes[1].size, result.changes[1].unit) == (0.01, "m")
    (gone,) = compared(PANDA, lambda root: law(root).remove(law(root).find("mimic"))).changes
    assert (gone.attribute, gone.before, gone.after) == ("mimic", "1 x panda_finger_joint1", None)


def test_a_chain_of_mimics_is_the_law_that_it_comes_to():
    chain = '<robot name="r"><link name="l0"/><link name="l1"/><link name="l2"/><link name="l3"/>{}</robot>'
    one = '<joint name="j{0}" type="continuous"><parent link="l{1}"/><child link="l{0}"/><axis xyz="0 0 1"/>{2}</joint>'
    first = one.format(1, 0, "") + one.format(2, 1, '<mimic joint="j1" multiplier="2" offset="0.1"/>')
    through = one.format(3, 2, '<mimic joint="j2" multiplier="3" offset="0.2"/>')
    straight = one.format(3, 2, '<mimic joint="j1" multiplier="6" offset="0.5"/>')
    a, b = (load_text(chain.format(first + last)) for last in (through, straight))
    assert difference(a, b).changes == ()


def test_below_the_tolerance_nothing_changed():
    def change(root):
        put(joint(root, "tool_joint"), "origin", xyz="0.8005 0 0")
        put(joint(root, "joint1"), "limit", effort="80.4", lower="-3.1411")

    assert not compared(PLANAR, change, tolerance=1e-3, relative=0.01).exceeds
    assert len(compared(PLANAR, change, tolerance=1e-3, relative=0.001).changes) == 1
    assert len(compared(PLANAR, change).changes) == 3


def test_small_changes_that_add_up_exceed_the_tolerance():
    """Two offsets of 0.8 mm are each below 1 mm; the tool that both carry is not."""

    def change(root):
        put(joint(root, "joint2"), "origin", xyz="1 0 0.0008")
        put(joint(root, "tool_joint"), "origin", xyz="0.8 0 0.0008")

    result = compared(PLANAR, change, tolerance=1e-3)
    assert result.changes == ()
    assert result.exceeds
    assert result.consequences.tips[0].translation.value == pytest.approx(0.0016)


def srdf(folder, name, robot, states):
    path = folder / name
    path.mkdir()
    (path / "r.urdf").write_text(robot)
    groups = "".join(
        f'<group_state name="{state}" group="arm">'
        + "".join(f'<joint name="{j}" value="{v}"/>' for j, v in values.items())
        + "</group_state>"
        for state, values in states.items()
    )
    (path / "r.srdf").write_text(f'<robot name="r"><group name="arm"/>{groups}</robot>')
    return ks.load(path / "r.urdf")


def test_states(tmp_path):
    text = ET.tostring(document(PLANAR), encoding="unicode")
    a = srdf(tmp_path, "a", text, {"home": {"joint1": 0.1, "joint2": 1}, "old": {"joint1": 1}})
    b = srdf(tmp_path, "b", text, {"home": {"joint1": 0.1, "joint2": 1.5}, "new": {"joint1": 1}})
    result = difference(a, b)
    assert [(c.kind, c.name) for c in result.changes] == [
        ("removed", "arm/old"),
        ("added", "arm/new"),
        ("changed", "arm/home"),
    ]
    assert (result.changes[2].attribute, result.changes[2].size, result.changes[2].unit) == ("joint2", 0.5, "rad")


def test_a_state_that_a_rename_left_behind_is_one_change_and_no_pose(tmp_path):
    root = document(PLANAR)
    home = {"home": {"joint1": 0.1, "joint2": 1}}
    a = srdf(tmp_path, "a", ET.tostring(root, encoding="unicode"), home)
    joint(root, "joint2").set("name", "elbow")
    put(joint(root, "tool_joint"), "origin", xyz="0.9 0 0")
    after = ET.tostring(root, encoding="unicode")
    result = difference(a, srdf(tmp_path, "b", after, home))
    (state,) = [c for c in result.changes if c.element == "state"]
    assert (state.attribute, state.before) == ("joint2", 1)
    assert state.after == "the same, under a name that no joint has any more"
    assert {one.pose for one in result.consequences.manipulability} <= {"zero", "mid"}
    assert any(line.startswith("manipulability at 'home': not compared") for line in result.consequences.unchanged)
    told = difference(a, srdf(tmp_path, "c", after, {"home": {"joint1": 0.1, "elbow": 1}}))
    assert [c.element for c in told.changes if c.element == "state"] == []
    assert "home" in {one.pose for one in told.consequences.manipulability}


def test_two_robots_have_little_in_common():
    result = difference(ks.load(PANDA), ks.load("example:solo12"))
    assert result.exceeds
    assert {c.kind for c in result.changes} >= {"added", "removed"}
    assert result.notes


def test_twenty_thousand_links_are_matched_in_seconds():
    """One link with all others on it at one place, every name new: nothing is compared with everything."""
    many = 19_999

    def star(prefix):
        links = "".join(f'<link name="{prefix}{i}"/>' for i in range(many + 1))
        joints = "".join(
            f'<joint name="{prefix}j{i}" type="fixed"><parent link="{prefix}0"/><child link="{prefix}{i}"/></joint>'
            for i in range(1, many + 1)
        )
        return load_text(f'<robot name="star">{links}{joints}</robot>').robot

    a, b = star("a"), star("b")
    begun = time.perf_counter()
    found = match(a, b, 1e-9)
    assert time.perf_counter() - begun < 20
    assert (len(found.links), len(found.joints)) == (many + 1, many)


@pytest.mark.parametrize("asked", [{"tolerance": -1}, {"tolerance": math.nan}, {"relative": math.inf}, {"samples": 0}])
def test_what_cannot_be_is_refused(asked):
    with pytest.raises(ks.UsageError):
        difference(plain(PLANAR), plain(PLANAR), **asked)


def test_frames_that_are_not_there():
    with pytest.raises(ks.UnknownNameError, match="did you mean 'tool'"):
        difference(plain(PLANAR), plain(PLANAR), frames=["tools"])

    def without(root):
        root.remove(joint(root, "tool_joint"))
        root.remove(link(root, "tool"))

    with pytest.raises(ks.UsageError, match="no counterpart"):
        difference(plain(PLANAR), edited(PLANAR, without), frames=["tool"])


def test_results_are_frozen_and_short():
    result = compared(PLANAR, lambda root: None)
    assert len(repr(result)) < 100
    with pytest.raises(AttributeError):
        result.changes = ()
    assert np.isfinite(result.tolerance.absolute)
