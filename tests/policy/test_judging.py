"""Each kind of expectation, met and unmet, where the answer is known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.policy.expectations import KINDS
from kinetostat.policy.judging import judge, unjudged
from kinetostat.policy.judging.judge import _JUDGES
from kinetostat.policy.settings import read_settings
from policy.policies import judged, written
from textbook_support import textbook
from trees import load_text

L1, L2 = 1.0, 0.8  # planar_2r
G = 9.81


def test_every_kind_has_a_judge():
    assert set(_JUDGES) == set(KINDS)


def stretched(q2):
    """Return the smallest singular value of a planar 2R arm's position, from the sum and the product of the two."""
    squares = L1**2 + 2 * L2**2 + 2 * L1 * L2 * math.cos(q2)
    product = L1 * L2 * abs(math.sin(q2))
    return math.sqrt((squares - math.sqrt(squares**2 - 4 * product**2)) / 2)


class TestDexterity:
    @pytest.mark.parametrize("q2", [0.4, 1.3, 2.9])
    @pytest.mark.parametrize(("factor", "met"), [(0.999, True), (1.001, False)])
    def test_smallest_singular_value(self, tmp_path, q2, factor, met):
        wanted = factor * stretched(q2)
        lines = f'kind = "smallest-singular-value"\nrows = "translation"\nat = [0.2, {q2}]\nat-least = {wanted}'
        outcome = judged(tmp_path, textbook("planar_2r"), lines)
        assert outcome.met is met
        assert f"{stretched(q2):.6g} m/rad" in outcome.found
        assert outcome.witness == {"joint1": 0.2, "joint2": q2}

    @pytest.mark.parametrize(("factor", "met"), [(0.999, True), (1.001, False)])
    def test_manipulability_is_the_area_that_sine_makes(self, tmp_path, factor, met):
        wanted = factor * L1 * L2 * math.sin(0.7)
        lines = f'kind = "manipulability"\nframe = "tool"\nrows = "x y"\nat = "joint2=0.7"\nat-least = {wanted}'
        assert judged(tmp_path, textbook("planar_2r"), lines).met is met

    @pytest.mark.parametrize(("q2", "met"), [(3 * math.pi / 4, True), (2.3, False)])
    def test_the_isotropic_arm_is_isotropic_at_one_angle(self, tmp_path, q2, met):
        lines = f'kind = "inverse-condition-number"\nrows = "x y"\nat = [1, {q2}]\nat-least = 1'
        assert judged(tmp_path, textbook("planar_2r_isotropic"), lines).met is met

    def test_of_several_configurations_the_worst_is_the_witness(self, tmp_path):
        lines = 'kind = "manipulability"\nrows = "x y"\nat = ["joint2=1", "zero", "joint2=2"]\nat-least = 0.5'
        outcome = judged(tmp_path, textbook("planar_2r"), lines)
        assert outcome.met is False
        assert outcome.found == "0 at zero (1 of 3 fall short)"
        assert outcome.witness == {"joint1": 0.0, "joint2": 0.0}

    def test_a_length_makes_metres_and_radians_comparable(self, tmp_path):
        # Of one revolute joint at a distance L the column is (L ; 1): in units of L its length is sqrt 2.
        lines = 'kind = "smallest-singular-value"\nlength = 0.9\nat-least = {}'
        assert judged(tmp_path, textbook("planar_1r"), lines.format(0.999 * math.sqrt(2))).met is True
        assert judged(tmp_path, textbook("planar_1r"), lines.format(1.001 * math.sqrt(2))).met is False
        auto = 'kind = "smallest-singular-value"\nat-least = {}'
        assert judged(tmp_path, textbook("planar_1r"), auto.format(0.999 * math.sqrt(2))).met is True

    def test_rows_that_the_structure_never_moves_are_said(self, tmp_path):
        lines = 'kind = "smallest-singular-value"\nrows = "translation"\nat = [1, 1, 1]\nat-least = 0.1'
        outcome = judged(tmp_path, textbook("planar_3r"), lines)
        assert outcome.met is False
        assert "rank 2" in outcome.found

    @pytest.mark.parametrize(("at_least", "met"), [(0.49, True), (0.51, False)])
    def test_distance_to_the_stretched_arm(self, tmp_path, at_least, met):
        lines = f'kind = "distance-to-singularity"\nat = [0.3, 0.5]\nat-least = {at_least}'
        outcome = judged(tmp_path, textbook("planar_2r"), lines)
        assert outcome.met is met
        assert outcome.found == "0.5 rad"
        assert outcome.witness == pytest.approx({"joint1": 0.3, "joint2": 0.0}, abs=1e-6)

    def test_a_singular_configuration_is_near(self, tmp_path):
        outcome = judged(tmp_path, textbook("planar_2r"), 'kind = "distance-to-singularity"\nat-least = 1e-6')
        assert outcome.met is False
        assert "singular" in outcome.found

    def test_within_limits(self, tmp_path):
        # The elbow is kept between 1 and 2 rad: no singular configuration is inside.
        text = ks.load("textbook:planar_2r").loaded.source.data.decode()
        elbow = '<limit lower="-3.141592653589793" upper="3.141592653589793" effort="30"'
        assert elbow in text
        arm = load_text(text.replace(elbow, '<limit lower="1" upper="2" effort="30"'))
        lines = 'kind = "distance-to-singularity"\nat = [0, 1.2]\nat-least = 1.3\nwithin-limits = {}'
        assert judged(tmp_path, arm, lines.format("false")).found == "1.2 rad"
        assert judged(tmp_path, arm, lines.format("true")).met is True


DOWN = "gravity = [0, -9.81, 0]"  # the planar arms lie in the x-y plane
HOLDS = f'kind = "holds"\n{DOWN}\n'
WEIGHT = G * (4 * 0.5 + 2.4 * 1.4)  # on joint1 of planar_2r, stretched along x; it may give 80 Nm


class TestEfforts:
    @pytest.mark.parametrize("payload", [0.0, 1.5])
    @pytest.mark.parametrize(("slack", "met"), [(0.01, True), (-0.01, False)])
    def test_holds_a_payload_out_stretched(self, tmp_path, payload, slack, met):
        percent = 100 * (WEIGHT + G * payload * (L1 + L2)) / 80
        outcome = judged(
            tmp_path, textbook("planar_2r"), f"{HOLDS}payload = {payload}\nat-most-percent = {percent + slack}"
        )
        assert outcome.met is met
        assert outcome.found.startswith(f"{percent:.4g} % of the effort limit of 'joint1'")

    def test_a_wrench_pushes_as_it_is_given(self, tmp_path):
        lines = 'kind = "holds"\ngravity = false\nwrench = [0, {}, 0, 0, 0, 0]\non = "{}"\nat-most-percent = 45.0001'
        outcome = judged(tmp_path, textbook("planar_2r"), lines.format(20, "environment"))
        assert outcome.found.startswith("53.33 % of the effort limit of 'joint2' (16 Nm)")  # 20 N at 0.8 m, of 30 Nm
        outcome = judged(tmp_path, textbook("planar_2r"), lines.format(20, "robot"))
        assert "(-16 Nm)" in outcome.found

    def test_joints_that_count(self, tmp_path):
        percent = 100 * G * 2.4 * 0.4 / 30  # on joint2
        lines = f'{HOLDS}joints = ["joint2"]\nat-most-percent = {percent + 0.01}'
        assert judged(tmp_path, textbook("planar_2r"), lines).met is True

    def test_gravity_along_the_axes_asks_nothing(self, tmp_path):
        outcome = judged(tmp_path, textbook("planar_2r"), 'kind = "holds"\nat-most-percent = 0.001\nat = "mid"')
        assert outcome.met is True

    def test_a_joint_without_effort_limit_leaves_it_open_unless_another_fails(self, tmp_path):
        text = textbook("planar_2r").loaded.source.data.decode().replace('effort="30"', 'effort="0"')
        arm = load_text(text)
        lines = HOLDS + "at-most-percent = {}"
        open_one = judged(tmp_path, arm, lines.format(90))
        assert open_one.met is None
        assert "joint2" in open_one.found
        assert judged(tmp_path, arm, lines.format(10)).met is False  # joint1 is beyond it in any case
        assert judged(tmp_path, arm, lines.format(90) + "\neffort-limits = { joint2 = 30 }").met is True

    @pytest.mark.parametrize(("slack", "met"), [(0.01, True), (-0.01, False)])
    def test_the_worst_torque_is_that_of_the_stretched_arm(self, tmp_path, slack, met):
        percent = 100 * WEIGHT / 80
        lines = f'kind = "worst-gravity-torque"\n{DOWN}\nsamples = 50\nat-most-percent = {percent + slack}'
        outcome = judged(tmp_path, textbook("planar_2r"), lines)
        assert outcome.met is met
        assert math.sin(outcome.witness["joint1"]) == pytest.approx(0, abs=1e-4)
        assert outcome.witness["joint2"] == pytest.approx(0, abs=1e-4)

    def test_only_the_joints_that_are_named_are_climbed_for(self, tmp_path, monkeypatch):
        from kinetostat.analysis.worst_climb import WorstClimb

        climbed = []
        honest = WorstClimb.ends

        def watched(self, joints, *rest):
            climbed.extend(joint.name for joint in joints)
            return honest(self, joints, *rest)

        monkeypatch.setattr(WorstClimb, "ends", watched)
        percent = 100 * G * 2.4 * 0.4 / 30  # on joint2, stretched
        lines = f'kind = "worst-gravity-torque"\n{DOWN}\nsamples = 50\njoints = ["joint2"]\nat-most-percent = '
        assert judged(tmp_path, textbook("planar_2r"), f"{lines}{percent + 0.01}").met is True
        assert judged(tmp_path, textbook("planar_2r"), f"{lines}{percent - 0.01}").met is False
        assert climbed == ["joint2", "joint2"]

    def test_the_worst_torque_with_a_payload(self, tmp_path):
        percent = 100 * (WEIGHT + G * 2 * (L1 + L2)) / 80
        lines = f'kind = "worst-gravity-torque"\n{DOWN}\nsamples = 50\npayload = 2\nat-most-percent = {percent + 0.01}'
        outcome = judged(tmp_path, textbook("planar_2r"), lines)
        assert outcome.met is True
        assert f"{percent:.4g} %" in outcome.found

    def test_links_without_mass_are_no_pass(self, tmp_path):
        arm = load_text(TWO_ARMS.replace('<mass value="2"/>', '<mass value="0"/>'))
        for kind in ("holds", "worst-gravity-torque"):
            outcome = judged(tmp_path, arm, f'kind = "{kind}"\nat-most-percent = 90')
            assert outcome.met is None
            assert "no mass" in outcome.found

    LIMITS = 'kind = "joint-limits"\njoints = ["joint1", "joint2"]\n'

    @pytest.mark.parametrize(
        ("line", "met"),
        [
            ("effort-at-least = 30", True),
            ("effort-at-least = 30.1", False),
            ("effort-at-most = 80", True),
            ("effort-at-most = 79", False),
            ("velocity-at-least = 3", True),
            ("velocity-at-most = 2.9", False),
            ("lower-at-most = -3.14", True),
            ("lower-at-most = -3.15", False),
            ("upper-at-least = 3.14", True),
            ("upper-at-least = 3.15", False),
        ],
    )
    def test_limits_of_joints(self, tmp_path, line, met):
        assert judged(tmp_path, textbook("planar_2r"), self.LIMITS + line).met is met

    def test_a_lowered_effort_limit_is_named(self, tmp_path):
        text = textbook("planar_2r").loaded.source.data.decode().replace('effort="30"', 'effort="25"')
        outcome = judged(tmp_path, load_text(text), self.LIMITS + "effort-at-least = 30")
        assert outcome.met is False
        assert outcome.found == "effort of 'joint2' is 25"

    @pytest.mark.parametrize(
        ("old", "new", "found"),
        [
            ('name="joint2" type="revolute"', 'name="joint2" type="fixed"', "'joint2' is fixed: it has no limits"),
            (
                '<limit lower="-3.141592653589793" upper="3.141592653589793" effort="30"',
                '<mimic joint="joint1"/><limit lower="-4" upper="4" effort="30"',
                "'joint2' follows 'joint1': it has no limits of its own",
            ),
        ],
    )
    def test_a_joint_that_is_no_longer_free_has_no_limits(self, tmp_path, old, new, found):
        text = textbook("planar_2r").loaded.source.data.decode()
        assert text.count(old) == 1
        arm = load_text(text.replace(old, new))
        for line in ("effort-at-least = 30", "effort-at-most = 100", "lower-at-most = 0"):
            outcome = judged(tmp_path, arm, self.LIMITS + line)
            assert (outcome.met, outcome.found) == (False, found)

    def test_a_joint_that_turns_for_ever_covers_every_range(self, tmp_path):
        text = textbook("planar_2r").loaded.source.data.decode().replace('"revolute"', '"continuous"')
        outcome = judged(tmp_path, load_text(text), self.LIMITS + "lower-at-most = -100\nupper-at-least = 100")
        assert outcome.met is True

    def test_joints_that_decide_nothing_are_no_witness(self, tmp_path):
        arms = load_text(TWO_ARMS)
        q = "right_shoulder=0.5,right_elbow=0.1,left_shoulder=0.2"
        left = {"left_shoulder": 0.2, "left_elbow": 0.0, "left_slide": 0.0}
        lines = f'frame = "left_tip"\nat = "{q}"\n'
        for kind in ('"holds"\nat-most-percent = 0.001', '"manipulability"\nat-least = 100'):
            assert judged(tmp_path, arms, f"kind = {kind}\n{lines}").witness == left

    def test_what_hangs_on_the_worst_joint_is_a_witness(self, tmp_path):
        # The elbow's angle decides what the shoulder bears, though the frame is the upper arm's.
        lines = f'{HOLDS}frame = "link1"\nat = "joint2=0.5"\nat-most-percent = 1'
        assert judged(tmp_path, textbook("planar_2r"), lines).witness == {"joint1": 0.0, "joint2": 0.5}

    def test_the_witness_of_the_worst_torque_is_of_its_joint_alone(self, tmp_path):
        lines = 'kind = "worst-gravity-torque"\nsamples = 20\nat-most-percent = 0.001'
        arms = load_text(TWO_ARMS.replace("<inertial>", '<inertial><origin xyz="0.1 0 0"/>'))
        outcome = judged(tmp_path, arms, lines)
        assert outcome.met is False
        side = "left" if "left_" in outcome.found else "right"
        assert f"{side}_shoulder" in outcome.witness
        assert all(name.startswith(side) for name in outcome.witness)

    def test_a_limit_that_is_not_there_is_not_enough(self, tmp_path):
        text = textbook("planar_2r").loaded.source.data.decode().replace('effort="30" ', "")
        outcome = judged(tmp_path, load_text(text), self.LIMITS + "effort-at-least = 30")
        assert outcome.met is False
        assert "not stated" in outcome.found


class TestReaching:
    @pytest.mark.parametrize(("radius", "met"), [(1.79, True), (1.81, False), (0.21, True), (0.19, False)])
    def test_a_planar_arm_reaches_a_ring(self, tmp_path, radius, met):
        lines = f'kind = "reaches"\nposes = [[0, {radius}, 0]]'
        outcome = judged(tmp_path, textbook("planar_2r"), lines)
        assert outcome.met is met
        if not met:
            assert "pose 1 is missed by 0.01 m" in outcome.found

    def test_tolerances_are_what_may_be_missed(self, tmp_path):
        lines = 'kind = "reaches"\nposes = [[1.81, 0, 0]]\nposition-tolerance = {}'
        assert judged(tmp_path, textbook("planar_2r"), lines.format(0.0101)).met is True
        assert judged(tmp_path, textbook("planar_2r"), lines.format(0.0099)).met is False

    def test_positions_and_poses_in_one_list(self, tmp_path):
        q = [0.4, 0.9]
        there = ks.fk(textbook("planar_2r"), "tool", np.array(q))
        x, y, _ = there.position
        lines = 'kind = "reaches"\nposes = [[1, 1, 0], "{},{},0 rpy 0,0,{}"]'
        assert judged(tmp_path, textbook("planar_2r"), lines.format(x, y, sum(q))).met is True
        outcome = judged(tmp_path, textbook("planar_2r"), lines.format(x, y, sum(q) + 0.3))
        assert outcome.met is False
        assert "pose 2" in outcome.found
        assert judged(tmp_path, textbook("planar_2r"), lines.format(x, y, 3) + '\nrows = "x y"').met is True

    def test_a_list_in_a_file(self, tmp_path):
        (tmp_path / "poses.csv").write_text("x,y,z\n1,0,0\n\n0,1.2,0\n0,2,0\n")
        outcome = judged(tmp_path, textbook("planar_2r"), 'kind = "reaches"\nfile = "poses.csv"')
        assert outcome.met is False
        assert outcome.found == "1 of 3 are not reached; 'poses.csv' line 5 is missed by 0.2 m"

    @pytest.mark.parametrize(
        ("content", "why"),
        [
            (None, "no such file"),
            (b"", "no poses"),
            (b"x,y,z\n", "no poses"),
            (b"1,2\n", "poses.csv:1: a pose of 2 numbers"),
            (b"1,2,3\n1,a,3\n", "poses.csv:2: 'a' is not a number"),
            (b"1,2,nan\n", "finite"),
            (b'"1,2,3\n', "quotation mark"),
            (b"\xff\xfe", "UTF-8"),
        ],
    )
    def test_a_file_that_is_none_is_not_judged(self, tmp_path, content, why):
        if content is not None:
            (tmp_path / "poses.csv").write_bytes(content)
        outcome = judged(tmp_path, textbook("planar_2r"), 'kind = "reaches"\nfile = "poses.csv"')
        assert outcome.met is None
        assert why in outcome.found

    def test_outside_joint_limits_is_not_reached(self, tmp_path):
        # planar_2r_6_3: its shoulder turns from 0 to 135 degrees alone.
        outcome = judged(tmp_path, textbook("planar_2r_6_3"), 'kind = "reaches"\nposes = [[0, -8, 0], [0, 8, 0]]')
        assert outcome.met is False
        assert "pose 1" in outcome.found

    @pytest.mark.parametrize(
        ("robot", "frame", "observer", "far"),
        [
            ("planar_2r", "tool", "", L1 + L2),
            ("planar_3r", "tool", "link1", 4.0),
            ("anthropomorphic", "tool", "", 0.4 + 0.5 + 0.4),
            ("planar_2r_6_3", "tool", "", 9.0),
        ],
    )
    def test_reach(self, tmp_path, robot, frame, observer, far):
        lines = f'kind = "reach"\nframe = "{frame}"\nrelative-to = "{observer}"\nsamples = 100\n'
        assert judged(tmp_path, textbook(robot), f"{lines}at-least = {far - 1e-5}\nat-most = {far}").met is True
        assert judged(tmp_path, textbook(robot), f"{lines}at-least = {far + 1e-5}").met is False
        assert judged(tmp_path, textbook(robot), f"{lines}at-most = {far - 1e-5}").met is False


MIMICKED = """
<robot name="pair"><link name="base"/><link name="a"/><link name="b"/><link name="tip"/>
<joint name="one" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="1" effort="5" velocity="1"/></joint>
<joint name="two" type="revolute"><parent link="a"/><child link="b"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="1" effort="5" velocity="1"/><mimic joint="one"/></joint>
<joint name="end" type="fixed"><parent link="b"/><child link="tip"/><origin xyz="1 0 0"/></joint></robot>
"""


class TestStructure:
    @pytest.mark.parametrize(("robot", "count"), [("planar_3r", 3), ("puma560", 6), ("scara", 4)])
    @pytest.mark.parametrize("of", ["joints", "frame"])
    def test_degrees_of_freedom(self, tmp_path, robot, count, of):
        lines = f'kind = "degrees-of-freedom"\nof = "{of}"\nequals = '
        assert judged(tmp_path, textbook(robot), f"{lines}{count}").met is True
        assert judged(tmp_path, textbook(robot), f"{lines}{count + 1}").met is False

    def test_three_parallel_axes_and_a_wrist_of_one_point_move_less_than_their_joints(self, tmp_path):
        four = load_text(parallel(4))
        assert judged(tmp_path, four, 'kind = "degrees-of-freedom"\nequals = 4').met is True
        outcome = judged(tmp_path, four, 'kind = "degrees-of-freedom"\nof = "frame"\nequals = 4')
        assert (outcome.met, outcome.found) == (False, "3, by 4 joints")

    def test_a_chain_between_two_frames(self, tmp_path):
        lines = 'kind = "degrees-of-freedom"\nframe = "tool"\nrelative-to = "link1"\nequals = 2'
        outcome = judged(tmp_path, textbook("planar_3r"), lines)
        assert (outcome.met, outcome.found) == (True, "2: joint2, joint3")

    def test_a_mimic_joint_that_is_lost_is_a_degree_of_freedom_more(self, tmp_path):
        lines = 'kind = "degrees-of-freedom"\nframe = "tip"\nequals = 1'
        assert judged(tmp_path, load_text(MIMICKED), lines).met is True
        outcome = judged(tmp_path, load_text(MIMICKED.replace('<mimic joint="one"/>', "")), lines)
        assert (outcome.met, outcome.found) == (False, "2: one, two")

    @pytest.mark.parametrize(
        ("mimic", "met", "found"),
        [
            ('joint="one"', True, "1 times 'one'"),
            ('joint="one" multiplier="-1"', False, "-1 times 'one'"),
            ('joint="one" offset="0.1"', False, "1 times 'one' +0.1"),
            ('joint="third"', False, "1 times 'third'"),
            (None, False, "'two' follows no joint"),
        ],
    )
    def test_who_follows_whom(self, tmp_path, mimic, met, found):
        third = '<joint name="third" type="continuous"><parent link="tip"/><child link="c"/></joint></robot>'
        text = MIMICKED.replace("</robot>", '<link name="c"/>' + third)
        text = text.replace('<mimic joint="one"/>', f"<mimic {mimic}/>" if mimic else "")
        outcome = judged(tmp_path, load_text(text), 'kind = "mimic"\njoint = "two"\nleader = "one"')
        assert (outcome.met, outcome.found) == (met, found)

    def test_a_chain_of_followers_is_followed(self, tmp_path):
        third = (
            '<link name="c"/><joint name="third" type="continuous"><parent link="tip"/><child link="c"/>'
            '<mimic joint="two" multiplier="3" offset="1"/></joint></robot>'
        )
        arm = load_text(MIMICKED.replace("</robot>", third).replace('"one"/>', '"one" multiplier="2" offset="0.5"/>'))
        lines = 'kind = "mimic"\njoint = "third"\n'
        assert judged(tmp_path, arm, lines + 'leader = "two"\nmultiplier = 3\noffset = 1').met is True
        assert judged(tmp_path, arm, lines + 'leader = "one"\nmultiplier = 6\noffset = 2.5').met is True
        assert judged(tmp_path, arm, lines + 'leader = "one"\nmultiplier = 3\noffset = 1').met is False

    @pytest.mark.parametrize(
        ("line", "met"),
        [("at-least = 6.4", True), ("at-least = 6.41", False), ("at-most = 6.4", True), ("at-most = 6.39", False)],
    )
    def test_mass(self, tmp_path, line, met):
        outcome = judged(tmp_path, textbook("planar_2r"), f'kind = "mass"\n{line}')
        assert (outcome.met, outcome.found) == (met, "6.4 kg")


def parallel(count):
    """Return a chain of revolute joints about z."""
    text = '<robot name="parallel"><link name="l0"/>'
    for i in range(count):
        text += (
            f'<link name="l{i + 1}"/><joint name="j{i}" type="continuous"><parent link="l{i}"/><child link="l{i + 1}"/>'
            '<origin xyz="0.3 0 0"/><axis xyz="0 0 1"/></joint>'
        )
    return text + "</robot>"


TWO_ARMS = """
<robot name="two"><link name="base"/>
<link name="left_arm"><inertial><mass value="2"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="left_hand"/><link name="left_tip"/>
<link name="right_arm"><inertial><mass value="2"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="right_hand"/><link name="right_tip"/>
<joint name="left_shoulder" type="revolute"><parent link="base"/><child link="left_arm"/>
  <origin xyz="0.1 0.2 1" rpy="0.3 0 0"/><axis xyz="0 1 0"/>
  <limit lower="-1" upper="2" effort="5" velocity="1"/></joint>
<joint name="left_elbow" type="revolute"><parent link="left_arm"/><child link="left_hand"/>
  <origin xyz="0.3 0.1 0" rpy="0 0 0.4"/><axis xyz="1 0 0"/>
  <limit lower="-0.5" upper="1.5" effort="3" velocity="1"/></joint>
<joint name="left_slide" type="prismatic"><parent link="left_hand"/><child link="left_tip"/>
  <origin xyz="0.2 0 0"/><axis xyz="0 1 0"/><limit lower="0" upper="0.1" effort="2" velocity="1"/></joint>
<joint name="right_shoulder" type="revolute"><parent link="base"/><child link="right_arm"/>
  <origin xyz="0.1 -0.2 1" rpy="-0.3 0 0"/><axis xyz="0 1 0"/>
  <limit lower="-1" upper="2" effort="5" velocity="1"/></joint>
<joint name="right_elbow" type="revolute"><parent link="right_arm"/><child link="right_hand"/>
  <origin xyz="0.3 -0.1 0" rpy="0 0 -0.4"/><axis xyz="1 0 0"/>
  <limit lower="-1.5" upper="0.5" effort="3" velocity="1"/></joint>
<joint name="right_slide" type="prismatic"><parent link="right_hand"/><child link="right_tip"/>
  <origin xyz="0.2 0 0"/><axis xyz="0 1 0"/><limit lower="-0.1" upper="0" effort="2" velocity="1"/></joint>
</robot>
"""
SYMMETRY = 'kind = "symmetry"\nleft = "left_tip"\nright = "right_tip"'


class TestSymmetry:
    def test_mirror_images(self, tmp_path):
        assert judged(tmp_path, load_text(TWO_ARMS), SYMMETRY).met is True

    def test_either_side_may_come_first(self, tmp_path):
        assert (
            judged(tmp_path, load_text(TWO_ARMS), 'kind = "symmetry"\nleft = "right_tip"\nright = "left_tip"').met
            is True
        )

    def test_no_mirror_images_about_another_plane(self, tmp_path):
        assert judged(tmp_path, load_text(TWO_ARMS), SYMMETRY + '\nplane = "yz"').met is False

    @pytest.mark.parametrize(
        ("old", "new", "found"),
        [
            ('"0.3 -0.1 0"', '"0.303 -0.1 0"', "'right_tip' is 0.003 m"),
            ('rpy="0 0 -0.4"', 'rpy="0 0 -0.41"', "0.01 rad off"),
            ('"0.1 -0.2 1" rpy="-0.3', '"0.1 -0.2 1" rpy="0.3', "off the mirror image"),
            ('upper="0.5" effort="3"', 'upper="0.6" effort="3"', "upper of 'right_elbow' is 0.6"),
            ('upper="0.5" effort="3"', 'upper="0.5" effort="2.5"', "effort of 'right_elbow' is 2.5"),
            ('name="right_slide" type="prismatic"', 'name="right_slide" type="revolute"', "is prismatic"),
            ('name="right_slide" type="prismatic"', 'name="right_slide" type="fixed"', "3 joints move"),
        ],
    )
    def test_what_breaks_it_is_said(self, tmp_path, old, new, found):
        assert TWO_ARMS.count(old) == 1
        outcome = judged(tmp_path, load_text(TWO_ARMS.replace(old, new)), SYMMETRY)
        assert outcome.met is False
        assert found in outcome.found

    def test_masses(self, tmp_path):
        head, mark, rest = TWO_ARMS.rpartition('<mass value="2"/>')
        assert mark
        arms = load_text(f'{head}<mass value="2.1"/>{rest}')
        outcome = judged(tmp_path, arms, SYMMETRY)
        assert outcome.met is False
        assert outcome.found == "'left_shoulder' moves 2 kg, 'right_shoulder' 2.1 kg"
        assert judged(tmp_path, arms, SYMMETRY + "\nmasses = false").met is True
        assert judged(tmp_path, arms, SYMMETRY + "\nmass-tolerance = 0.05").met is True

    def test_a_joint_may_turn_the_other_way(self, tmp_path):
        # The right elbow turns about -x: it then moves as the left one does, and so do its limits.
        elbow = '"0 0 -0.4"/><axis xyz="1 0 0"/>\n  <limit lower="-1.5" upper="0.5"'
        assert elbow in TWO_ARMS
        turned = TWO_ARMS.replace(elbow, '"0 0 -0.4"/><axis xyz="-1 0 0"/>\n  <limit lower="-0.5" upper="1.5"')
        assert judged(tmp_path, load_text(turned), SYMMETRY).met is True

    def test_frames_may_be_named_otherwise_by_quarter_turns_alone(self, tmp_path):
        tip = (
            '<link name="right_end"/><joint name="end" type="fixed"><parent link="right_tip"/><child link="right_end"/>'
        )
        for turn, met in (("1.5707963267948966 0 3.141592653589793", True), ("0.1 0 0", False)):
            text = TWO_ARMS.replace("</robot>", f'{tip}<origin rpy="{turn}"/></joint></robot>')
            lines = 'kind = "symmetry"\nleft = "left_tip"\nright = "right_end"'
            assert judged(tmp_path, load_text(text), lines).met is met

    def test_shared_joints_stay_where_they_are(self, tmp_path):
        torso = (
            '<link name="world"/><joint name="torso" type="revolute"><parent link="world"/><child link="base"/>'
            '<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
        )
        outcome = judged(tmp_path, load_text(TWO_ARMS.replace("</robot>", torso)), SYMMETRY)
        assert (outcome.met, outcome.found) == (True, "3 pairs of joints mirror each other")


EVERY = {
    "smallest-singular-value": "at-least = 0.1",
    "manipulability": "at-least = 0.1",
    "inverse-condition-number": "at-least = 0.1",
    "distance-to-singularity": "at-least = 0.1",
    "holds": "at-most-percent = 80",
    "worst-gravity-torque": "payload = 1\nsamples = 5",
    "reaches": "poses = [[1, 0, 0]]",
    "reach": "at-least = 1\nsamples = 5",
    "degrees-of-freedom": "equals = 2",
    "mass": "at-least = 1",
    "joint-limits": 'joints = ["joint1"]\neffort-at-least = 1',
    "mimic": 'joint = "joint2"\nleader = "joint1"',
    "golden": 'file = "golden.json"',
    "symmetry": 'left = "tool"\nright = "link2"',
}


FRAMELESS = ("mass", "joint-limits", "mimic", "golden", "symmetry")


class TestNotJudged:
    def test_every_kind_is_tried_here(self):
        assert set(EVERY) == set(KINDS)

    @pytest.mark.parametrize("kind", [kind for kind in EVERY if kind not in FRAMELESS])
    def test_no_such_frame(self, tmp_path, kind):
        outcome = judged(tmp_path, textbook("planar_2r"), f'kind = "{kind}"\nframe = "tol"\n{EVERY[kind]}')
        assert outcome.met is None
        assert "there is no frame 'tol' (did you mean 'tool'?)" in outcome.found
        assert outcome.title
        assert outcome.kind == kind

    @pytest.mark.parametrize(
        ("lines", "why"),
        [
            ('kind = "joint-limits"\njoints = ["joint9"]\neffort-at-least = 1', "no joint 'joint9'"),
            ('kind = "mimic"\njoint = "joint9"\nleader = "joint1"', "no joint 'joint9'"),
            ('kind = "symmetry"\nleft = "tool"\nright = "toool"', "no frame 'toool'"),
            ('kind = "symmetry"\nleft = "tool"\nright = "link2"', "no joint moves"),
            ('kind = "manipulability"\nat-least = 1\nat = "home"', "no configuration 'home'"),
            ('kind = "manipulability"\nat-least = 1\nat = "states"', "no SRDF state"),
            ('kind = "manipulability"\nat-least = 1\nat = [1, 2, 3]', "3 positions are given"),
            ('kind = "manipulability"\nat-least = 1\nat = "joint1=1e9"', "beyond 1e+06 rad"),
            ('kind = "manipulability"\nat-least = 1\nframe = "base"', "no joint moves 'base'"),
            ('kind = "holds"\nat-most-percent = 9\njoints = ["tool_joint"]', "is fixed"),
            ('kind = "holds"\nat-most-percent = 9\neffort-limits = { elbow = 3 }', "no joint 'elbow'"),
        ],
    )
    def test_what_cannot_be_asked(self, tmp_path, lines, why):
        outcome = judged(tmp_path, textbook("planar_2r"), lines)
        assert outcome.met is None
        assert why in outcome.found
        assert "--" not in outcome.found  # options are of the command line

    def test_several_tips_are_listed(self, tmp_path):
        outcome = judged(tmp_path, load_text(TWO_ARMS), 'kind = "reach"\nat-least = 1')
        assert outcome.met is None
        assert "'left_tip', 'right_tip'" in outcome.found

    @pytest.mark.parametrize("kind", [kind for kind in EVERY if kind not in ("joint-limits", "mimic", "golden")])
    def test_engines_that_disagree_are_no_pass(self, tmp_path, kind):
        model = load_text(TWO_ARMS.replace('"base"/>', '"base"/><link name="spare"/>', 1).replace(
            "</robot>", '<joint name="spare" type="fixed"><parent link="base"/><child link="spare"/></joint></robot>'
        ))  # fmt: skip
        model.__dict__["witness"] = Lying(model.witness)
        lines = EVERY[kind] if kind != "symmetry" else 'left = "left_tip"\nright = "right_tip"'
        lines = lines.replace("equals = 2", 'equals = 3\nof = "frame"')
        frame = "" if kind in ("mass", "symmetry") else 'frame = "left_tip"\n'
        outcome = judged(tmp_path, model, f'kind = "{kind}"\n{frame}{lines}')
        assert outcome.met is None
        assert "the engines disagree" in outcome.found

    def test_one_that_cannot_be_judged_hides_no_other(self, tmp_path):
        text = '[[robots]]\npath = "x"\n' + "".join(
            f"[[robots.expect]]\n{lines}\n"
            for lines in (
                'kind = "mass"\nat-least = 1',
                'kind = "reach"\nframe = "x"\nat-least = 1',
                'kind = "mass"\nat-most = 1',
            )
        )
        settings = read_settings(written(tmp_path, text))
        outcomes = judge(textbook("planar_2r"), settings.robots[0].expect)
        assert [outcome.met for outcome in outcomes] == [True, None, False]
        assert [outcome.place for outcome in outcomes] == [
            "kinetostat.toml:3",
            "kinetostat.toml:6",
            "kinetostat.toml:10",
        ]

    def test_a_robot_that_cannot_be_read_is_no_pass(self, tmp_path):
        settings = read_settings(
            written(tmp_path, '[[robots]]\npath = "x"\n[[robots.expect]]\nkind = "mass"\nat-least = 1')
        )
        (outcome,) = unjudged(settings.robots[0].expect, "it is gone")
        assert (outcome.met, outcome.found, outcome.title) == (None, "it is gone", "total mass")


class Lying:
    """An engine whose numbers are a little off."""

    def __init__(self, honest):
        self._honest = honest

    def __getattr__(self, name):
        found = getattr(self._honest, name)
        if not callable(found):
            return found
        return lambda *given, **asked: np.asarray(found(*given, **asked)) * (1 + 1e-6) + 1e-6


STATES = """
<robot name="planar_2r">
  <group name="arm"><chain base_link="base" tip_link="tool"/></group>
  <group name="upper"><joint name="joint1"/></group>
  <group_state name="bent" group="arm"><joint name="joint1" value="1"/><joint name="joint2" value="1.5"/></group_state>
  <group_state name="zero" group="arm"><joint name="joint2" value="0.5"/></group_state>
  <group_state name="twice" group="arm"><joint name="joint1" value="0"/><joint name="joint2" value="1"/></group_state>
  <group_state name="twice" group="upper"><joint name="joint1" value="1"/></group_state>
  <group_state name="turned" group="upper"><joint name="joint1" value="2"/></group_state>
</robot>
"""


class TestStates:
    @pytest.fixture
    def arm(self, tmp_path):
        path = tmp_path / "arm.srdf"
        path.write_text(STATES)
        return ks.load("textbook:planar_2r", srdf=path)

    def test_all_states_are_asked_and_no_word_of_ours_stands_in_for_one(self, tmp_path, arm):
        # sin of the elbow: 0.997; 0.479 ("zero" is a state here); 0.841 and 0, of groups that contradict; 0.
        lines = 'kind = "manipulability"\nrows = "x y"\nat = "states"\nat-least = {}'
        outcome = judged(tmp_path, arm, lines.format(0.5))
        assert outcome.met is False
        assert "(3 of 5 fall short)" in outcome.found
        assert "2 of 5" in judged(tmp_path, arm, lines.format(0.3)).found

    def test_a_group_of_a_state_can_be_named(self, tmp_path, arm):
        lines = 'kind = "manipulability"\nrows = "x y"\nat-least = 0.3\nat = "{}"'
        assert judged(tmp_path, arm, lines.format("arm/twice")).met is True
        assert judged(tmp_path, arm, lines.format("upper/twice")).met is False
        assert judged(tmp_path, arm, lines.format("twice")).met is None
        assert judged(tmp_path, arm, lines.format("bent")).met is True

    def test_states_that_do_not_move_the_frame_do_not_count(self, tmp_path, arm):
        # Relative to link1 the tool moves along y by 0.8 cos(joint2); the state "turned" sets joint1 alone.
        lines = (
            'kind = "smallest-singular-value"\nframe = "tool"\nrelative-to = "link1"\nat = "states"\nrows = "y"\n'
            "at-least = 0.5"
        )
        outcome = judged(tmp_path, arm, lines)
        assert outcome.met is False
        assert outcome.found == f"{0.8 * math.cos(1.5):.6g} m/rad at 'bent' (2 of 3 fall short)"
