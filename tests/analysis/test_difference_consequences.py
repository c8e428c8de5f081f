"""What follows from a change: displacements that geometry knows, mirrored differences, reach, effort, families."""

import math
import time
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import kinetostat as ks
from difference_support import compared, edited, joint, link, plain, put
from kinetostat.analysis.difference.change import Tolerance
from kinetostat.analysis.difference.difference import difference
from kinetostat.analysis.difference.loaded import loaded_joints
from kinetostat.analysis.difference.matching import match
from kinetostat.analysis.difference.search import largest
from kinetostat.analysis.difference.structure import changes
from trees import load_text

UR5, PANDA, PLANAR = "example:ur5_robot", "example:panda", "textbook:planar_2r"


def tips(result):
    return {tip.tip: tip for tip in result.consequences.tips}


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 0.6, -0.8)])
def test_a_tool_moved_by_two_millimetres_is_two_millimetres_everywhere(axis):
    shift = 0.002 * np.array(axis)

    def change(root):
        x, y, z = np.array([0, 0.0823, 0]) + shift
        put(
            joint(root, "ee_fixed_joint"),
            "origin",
            xyz=f"{x!r} {y!r} {z!r}".replace("np.float64(", "").replace(")", ""),
        )

    result = compared(UR5, change)
    (tip,) = result.consequences.tips
    assert (tip.tip, tip.relative_to) == ("ee_link", "world")
    assert tip.translation.value == pytest.approx(0.002, abs=1e-12)
    assert tip.translation.everywhere
    assert tip.rotation.value == pytest.approx(0, abs=1e-12)
    assert result.consequences.certificate.agree
    assert "singular families: unchanged" in result.consequences.unchanged  # a tool is beyond all axes


def test_a_turned_tool_turns():
    result = compared(UR5, lambda root: put(joint(root, "ee_fixed_joint"), "origin", rpy="0 0.3 1.57079632679"))
    (tip,) = result.consequences.tips
    assert tip.rotation.value == pytest.approx(0.3)
    assert tip.rotation.everywhere
    assert tip.translation.value == pytest.approx(0, abs=1e-12)


def test_a_longer_link_displaces_the_tip_by_what_it_is_longer():
    """Along the first link, wherever the second points."""
    (tip,) = compared(PLANAR, lambda root: put(joint(root, "joint2"), "origin", xyz="1.1 0 0")).consequences.tips
    assert tip.translation.value == pytest.approx(0.1, abs=1e-12)
    assert tip.translation.everywhere


@pytest.mark.parametrize("angle", [0.01, 0.5, -2.0])
def test_a_turned_shoulder_displaces_by_the_chord_of_the_stretched_arm(angle):
    """2 R sin(a/2), R being 1.8 m where the arm is stretched, which no sample is: the search climbs there."""
    result = compared(PLANAR, lambda root: put(joint(root, "joint1"), "origin", rpy=f"0 0 {angle}"))
    (tip,) = result.consequences.tips
    assert tip.translation.value == pytest.approx(2 * 1.8 * abs(math.sin(angle / 2)), rel=1e-9)
    assert tip.rotation.value == pytest.approx(abs(angle))
    assert tip.translation.witness["joint2"] == pytest.approx(0, abs=1e-4)
    assert not tip.translation.everywhere


def test_a_turned_elbow_displaces_by_the_chord_of_the_forearm():
    (tip,) = compared(PLANAR, lambda root: put(joint(root, "joint2"), "origin", rpy="0 0 0.2")).consequences.tips
    assert tip.translation.value == pytest.approx(2 * 0.8 * math.sin(0.1))
    assert tip.translation.everywhere


def test_a_reversed_axis_displaces_by_the_folded_over_arm():
    """The elbow at 90 degrees one way and the other: 2 x 0.8 m apart."""
    (tip,) = compared(PLANAR, lambda root: put(joint(root, "joint2"), "axis", xyz="0 0 -1")).consequences.tips
    assert tip.translation.value == pytest.approx(1.6, rel=1e-9)
    assert abs(math.sin(tip.translation.witness["joint2"])) == pytest.approx(1, abs=1e-6)
    assert tip.rotation.value == pytest.approx(math.pi, abs=1e-5)


def test_a_reversed_axis_within_narrow_limits_ends_at_one_of_them():
    def narrow(root):
        put(joint(root, "joint2"), "limit", lower="-0.3", upper="0.5")

    def both(root):
        narrow(root)
        put(joint(root, "joint2"), "axis", xyz="0 0 -1")

    (tip,) = difference(edited(PLANAR, narrow), edited(PLANAR, both)).consequences.tips
    assert tip.translation.value == pytest.approx(2 * 0.8 * math.sin(0.5))
    assert tip.rotation.value == pytest.approx(1.0)
    assert tip.translation.witness["joint2"] == pytest.approx(0.5)


@pytest.mark.parametrize("multiplier", [0.5, -1.0, 1.25])
def test_a_broken_mimic_displaces_by_multiplier_range_and_lever(multiplier):
    """Slides of the Panda's fingers, 0 to 0.04 m: |1 - k| times what the leader may do inside both laws."""
    result = compared(PANDA, lambda root: put(joint(root, "panda_finger_joint2"), "mimic", multiplier=str(multiplier)))
    moved = tips(result)
    assert set(moved) == {"panda_rightfinger"}
    leader = min(0.04, 0.04 / multiplier) if multiplier > 0 else 0.04
    assert moved["panda_rightfinger"].translation.value == pytest.approx(abs(1 - multiplier) * leader, rel=1e-9)


def test_a_lost_mimic_leaves_the_finger_where_it_is():
    def lost(root):
        finger = joint(root, "panda_finger_joint2")
        finger.remove(finger.find("mimic"))

    result = compared(PANDA, lost)
    moved = tips(result)
    assert moved["panda_rightfinger"].translation.value == pytest.approx(0.04)
    assert moved["panda_rightfinger"].translation.witness["panda_finger_joint1"] == pytest.approx(0.04)
    back = difference(edited(PANDA, lost), plain(PANDA))
    assert tips(back)["panda_rightfinger"].translation.value == pytest.approx(0.04)


def turned_mimic(multiplier):
    return load_text(
        '<robot name="r"><link name="l0"/><link name="l1"/><link name="l2"/><link name="tip"/>'
        '<joint name="lead" type="revolute"><parent link="l0"/><child link="l1"/><axis xyz="0 0 1"/>'
        '<limit lower="-0.2" upper="0.4" effort="1" velocity="1"/></joint>'
        '<joint name="follow" type="revolute"><parent link="l0"/><child link="l2"/><axis xyz="0 0 1"/>'
        f'<limit lower="-2" upper="2" effort="1" velocity="1"/><mimic joint="lead" multiplier="{multiplier}"/></joint>'
        '<joint name="t" type="fixed"><parent link="l2"/><child link="tip"/><origin xyz="0.5 0 0"/></joint></robot>'
    )


def test_a_broken_mimic_of_a_turning_joint():
    """The chord of multiplier difference x range at a lever of 0.5 m."""
    (tip,) = difference(turned_mimic(1), turned_mimic(1.5)).consequences.tips
    assert tip.tip == "tip"
    assert tip.rotation.value == pytest.approx(0.5 * 0.4)
    assert tip.translation.value == pytest.approx(2 * 0.5 * math.sin(0.5 * 0.4 / 2))


def changed_elbow(root):
    put(joint(root, "elbow_joint"), "origin", xyz="0.01 -0.1197 0.43", rpy="0.02 0 0.01")
    put(joint(root, "wrist_1_joint"), "limit", effort="20", lower="-3")
    put(link(root, "forearm_link").find("inertial"), "mass", value="3")


@pytest.mark.parametrize(("source", "change"), [(UR5, changed_elbow)])
def test_the_difference_back_is_mirrored(source, change):
    there, back = compared(source, change), difference(edited(source, change), plain(source))
    assert [(c.name, c.attribute, c.before, c.after) for c in there.changes] == [
        (c.name, c.attribute, c.after, c.before) for c in back.changes
    ]
    for tip, mirrored in zip(there.consequences.tips, back.consequences.tips, strict=True):
        assert tip.tip == mirrored.tip
        assert tip.translation.value == pytest.approx(mirrored.translation.value, rel=1e-6)
        assert tip.rotation.value == pytest.approx(mirrored.rotation.value, rel=1e-6)
    for one, mirrored in zip(there.consequences.worst_gravity, back.consequences.worst_gravity, strict=True):
        assert (one.joint, one.share_before) == (mirrored.joint, pytest.approx(mirrored.share_after, rel=1e-6))


def test_no_configuration_displaces_more_than_the_largest():
    """Twenty thousand fresh configurations, by both robots' own forward kinematics."""
    a, b = plain(UR5), edited(UR5, changed_elbow)
    found = tips(difference(a, b))["tool0"]
    q = ks.random_configurations(b, 99, 20_000)  # b's limits are inside a's
    before, after = (ks.fk(model, "tool0", q).matrix for model in (a, b))
    gaps = np.linalg.norm(after[:, :3, 3] - before[:, :3, 3], axis=-1)
    assert np.max(gaps) <= found.translation.value * (1 + 1e-9)
    assert np.max(gaps) >= 0.95 * found.translation.value


def test_the_witness_has_the_displacement():
    a, b = plain(UR5), edited(UR5, changed_elbow)
    found = tips(difference(a, b))["tool0"]
    before, after = (
        ks.fk(model, "tool0", ks.configuration(model, found.translation.witness).q).matrix for model in (a, b)
    )
    assert np.linalg.norm(after[:3, 3] - before[:3, 3]) == pytest.approx(found.translation.value, abs=1e-12)


def test_a_seed_gives_the_same():
    one, same = (compared(UR5, changed_elbow, seed=3) for _ in range(2))
    assert one == same


def test_only_the_frames_that_are_asked_for():
    result = compared(UR5, changed_elbow, frames=["forearm_link"])
    assert set(tips(result)) == {"forearm_link"}
    assert not compared(UR5, changed_elbow, frames=["shoulder_link"]).consequences.tips


def test_reach_of_a_longer_arm_and_of_one_with_a_narrow_elbow():
    (reach,) = compared(PLANAR, lambda root: put(joint(root, "joint2"), "origin", xyz="1.1 0 0")).consequences.reach
    assert (reach.before.value, reach.after.value) == (pytest.approx(1.8), pytest.approx(1.9))
    (reach,) = compared(
        PLANAR, lambda root: put(joint(root, "joint2"), "limit", lower="1", upper="2")
    ).consequences.reach
    assert reach.after.value == pytest.approx(math.sqrt(1 + 0.64 + 1.6 * math.cos(1)))
    assert reach.after.witness["joint2"] == pytest.approx(1)


def test_manipulability_at_mid():
    """|l1 l2 sin q2| of the planar arm: only the forearm changes, and at q2 = 1.5 rad."""
    result = compared(
        PLANAR,
        lambda root: (
            put(joint(root, "tool_joint"), "origin", xyz="0.4 0 0"),
            put(joint(root, "joint2"), "limit", lower="1", upper="2"),
        ),
    )
    mid = {one.pose: one for one in result.consequences.manipulability if one.block == "translation"}["mid"]
    assert mid.yoshikawa[0] == pytest.approx(0, abs=1e-9)
    assert mid.yoshikawa[1] == pytest.approx(0.4 * math.sin(1.5))


def test_an_effort_limit_lowered_is_a_larger_share():
    result = level(lambda root: put(joint(root, "j2"), "limit", effort="4"))
    (one,) = result.consequences.worst_gravity
    torque = 9.81 * 1.0 * 0.5
    assert (one.joint, one.before, one.after) == ("j2", pytest.approx(torque), pytest.approx(torque))
    assert (one.share_before, one.share_after) == (pytest.approx(torque / 10), pytest.approx(torque / 4))
    assert one.overloaded
    assert result.consequences.tips == ()


def test_a_heavier_link_loads_all_joints_below_it():
    def heavier(root):
        inertial = link(root, "l2").find("inertial")
        put(inertial, "mass", value="2")

    first, second = level(heavier).consequences.worst_gravity
    assert (first.joint, first.after - first.before) == ("j1", pytest.approx(9.81 * 1.5))
    assert (second.joint, second.after) == ("j2", pytest.approx(9.81))


def level(change):
    """Two rods of 1 m and 1 kg that turn about y, from a robot with effort limits of 100 and 10 Nm."""
    root = ET.fromstring(RODS)
    change(root)
    return difference(load_text(RODS), load_text(ET.tostring(root, encoding="unicode")))


ROD = (
    '<link name="l{0}"><inertial><mass value="1"/><origin xyz="0.5 0 0"/>'
    '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>'
    '<joint name="j{0}" type="revolute"><parent link="l{1}"/><child link="l{0}"/><origin xyz="{2} 0 0"/>'
    '<axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="{3}" velocity="1"/></joint>'
)
RODS = f'<robot name="rods"><link name="l0"/>{ROD.format(1, 0, 0, 100)}{ROD.format(2, 1, 1, 10)}</robot>'


def test_families_that_went_and_came():
    """A twisted elbow: three parallel axes are no more, nor what they make singular by one joint alone."""
    result = compared(UR5, lambda root: put(joint(root, "elbow_joint"), "origin", rpy="0.3 0 0"), frames=["tool0"])
    found = {(one.kind, one.name, *sorted(round(p, 6) for p in (one.before or {}).values())) for one in told(result)}
    assert found >= {
        ("removed", "elbow", 0.0),
        ("removed", "elbow", 3.141593),
        ("removed", "wrist", 0.0),
        ("removed", "wrist", 3.141593),
        ("removed", "shoulder"),
    }
    assert [one.kind for one in told(result)].count("added") == 1
    assert result.consequences.certificate.agree


def told(result):
    return result.consequences.singular_families


def test_a_zero_moved_by_a_tenth_moves_the_family_by_as_much():
    """The elbow's zero turned about its own axis: the arm is the same, its elbow is stretched at -0.1 instead of 0."""
    result = compared(UR5, lambda root: put(joint(root, "elbow_joint"), "origin", rpy="0 0.1 0"))
    moved = [one for one in result.consequences.singular_families if one.support == ("elbow_joint",)]
    assert moved
    for one in moved:
        assert one.kind == "moved"
        gap = one.before["elbow_joint"] - one.after["elbow_joint"]
        assert math.remainder(gap - 0.1, 2 * math.pi) == pytest.approx(0, abs=1e-6)


def test_families_are_not_asked_of_a_tool_or_of_a_base_that_moved():
    for name in ("shoulder_pan_joint", "ee_fixed_joint"):
        result = compared(UR5, lambda root, name=name: put(joint(root, name), "origin", xyz="0.1 0.2 0.3"))
        assert result.consequences.tips
        assert "singular families: unchanged" in result.consequences.unchanged


def test_a_free_flying_base_does_not_count():
    """A robot on a floating joint is looked at from the link that the joint carries."""
    text = (
        '<robot name="r"><link name="world"/><joint name="free" type="floating"><parent link="world"/>'
        '<child link="l0"/></joint>' + RODS.removeprefix('<robot name="rods">')
    )
    root = ET.fromstring(text)
    put(joint(root, "j2"), "origin", xyz="1.25 0 0")
    (tip,) = difference(load_text(text), load_text(ET.tostring(root, encoding="unicode"))).consequences.tips
    assert tip.relative_to == "l0"
    assert tip.translation.value == pytest.approx(0.25)


def test_a_new_joint_is_held_at_zero():
    def hinged(root):
        joint(root, "tool_joint").set("type", "revolute")
        put(joint(root, "tool_joint"), "axis", xyz="0 1 0")
        put(joint(root, "tool_joint"), "limit", lower="-1", upper="1", effort="1", velocity="1")

    result = compared(PLANAR, hinged)
    assert [c.attribute for c in result.changes] == ["type"]
    assert result.consequences.tips == ()  # at zero it is where it was
    assert result.exceeds


def test_a_robot_without_joints():
    one, other = (
        load_text(
            '<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="fixed"><parent link="a"/>'
            f'<child link="b"/><origin xyz="{x} 0 0"/></joint></robot>'
        )
        for x in (1, 1.5)
    )
    result = difference(one, other)
    (tip,) = result.consequences.tips
    assert (tip.translation.value, tip.translation.witness) == (pytest.approx(0.5), {})
    assert any("worst gravity torque: no joint" in line for line in result.consequences.unchanged)


def test_the_search_finds_what_no_sample_is():
    """A narrow peak inside, and a ramp that ends in a corner."""

    def peak(x):
        gap = x - np.array([0.3, -0.2])
        value = np.exp(-4 * np.sum(gap**2, axis=-1))
        return value, -8 * gap * value[:, None]

    ends = np.array([-1.0, -1.0]), np.array([1.0, 1.0])
    found = largest(peak, *ends, 20, 0)
    assert found.value == pytest.approx(1, abs=1e-9)
    assert found.at == pytest.approx([0.3, -0.2], abs=1e-5)
    ramp = largest(lambda x: (x @ [1.0, -2.0] + 4, np.tile([1.0, -2.0], (len(x), 1))), *ends, 5, 0)
    assert (ramp.value, ramp.at.tolist()) == (pytest.approx(7), [1, -1])
    flat = largest(lambda x: (np.full(len(x), 2.0), np.zeros_like(x)), *ends, 5, 0)
    assert flat.constant
    assert flat.at.tolist() == [0, 0]


# --- tips that the same thing displaces ------------------------------------------------------------------------------

HAND = "example:tiago_dual"


def test_a_moved_arm_of_a_large_robot_is_told_in_seconds_and_of_all_its_tips():
    def change(root):
        put(joint(root, "arm_right_1_joint"), "origin", xyz="0.03 -0.19 -0.171", rpy="0.01 0 -1.5708")

    begun = time.process_time()
    result = compared(HAND, change)
    assert time.process_time() - begun < 60  # 6 s on a free core; it was minutes
    found = tips(result)
    assert len(found) == 11
    assert all(name.startswith("hand_right") for name in found)
    # Two turns of one rigid hand cannot differ, wherever on it they are looked at.
    turned = [tip.rotation.value for tip in found.values()]
    assert max(turned) - min(turned) < 1e-9
    # And what is searched for alone comes to the same as what was taken over from a neighbour.
    alone = tips(compared(HAND, change, frames=["hand_right_middle_flex_3_link"]))
    (one,) = alone.values()
    assert one.rotation.value == pytest.approx(found[one.tip].rotation.value, abs=1e-9)
    assert one.translation.value == pytest.approx(found[one.tip].translation.value, rel=1e-2)


@pytest.mark.parametrize("name", ["arm_right_1_joint", "torso_lift_joint"])
def test_a_shift_is_the_same_of_all_tips_behind_it(name):
    def change(root):
        x, y, z = (float(word) for word in joint(root, name).find("origin").get("xyz").split())
        put(joint(root, name), "origin", xyz=f"{x + 0.03} {y} {z + 0.04}")

    result = compared(HAND, change)
    assert len(result.consequences.tips) > 10
    for tip in result.consequences.tips:
        assert tip.translation.value == pytest.approx(0.05, abs=1e-9)
        assert tip.translation.everywhere
        assert tip.rotation.value < 1e-9


@pytest.mark.parametrize("source", ["example:panda", "example:so101", HAND])
def test_joints_that_are_said_to_carry_nothing_new_keep_their_torques(source):
    """Torques at random configurations: where one differs, its joint is among those that are looked at."""
    plain_one = plain(source)
    generator, moved = np.random.default_rng(5), 0
    for name in generator.choice([j.name for j in plain_one.robot.independent], 4, replace=False):
        for turn, centre in (("0.3 0.2 0.5", "0.1 0.2 0.3"), ("0 0 0", "0.01 0 0")):

            def change(root, name=name, turn=turn, centre=centre):
                x, y, z = (float(word) for word in joint(root, name).find("origin").get("xyz").split())
                put(joint(root, name), "origin", xyz=f"{x + 0.03} {y - 0.05} {z + 0.04}", rpy=turn)
                child = link(root, joint(root, name).find("child").get("link"))
                if child.find("inertial") is not None:
                    put(child, "inertial/origin", xyz=centre)

            other = edited(source, change)
            matching = match(plain_one.robot, other.robot, 1e-9)
            found = changes(plain_one, other, matching, Tolerance(1e-9, 1e-9))
            carried = set(loaded_joints(plain_one, other, matching, found))
            q = ks.random_configurations(plain_one, 3, (5,))
            down = np.array([0, 0, -9.81])
            apart = np.abs(other.engine.holding_torques(q, down, ()) - plain_one.engine.holding_torques(q, down, ()))
            columns = plain_one.robot.velocity_slices
            changed = {j.name for j in plain_one.robot.independent if np.max(apart[:, columns[j.name]]) > 1e-9}
            assert changed <= carried
            moved += len(changed)
    assert moved


def test_torques_that_a_mass_cannot_change_are_not_looked_for():
    plain_one = plain(PANDA)
    other = edited(PANDA, lambda root: put(link(root, "panda_link4"), "inertial/mass", value="9"))
    matching = match(plain_one.robot, other.robot, 1e-9)
    found = changes(plain_one, other, matching, Tolerance(1e-9, 1e-9))
    assert loaded_joints(plain_one, other, matching, found) == [f"panda_joint{i}" for i in (1, 2, 3, 4)]
