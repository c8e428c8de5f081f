"""Which limbs a robot has: each joint in one of them or told, whatever the tree, as who knows the robot would say."""

from __future__ import annotations

from dataclasses import replace

import pytest

import kinetostat as ks
from grown import grown
from kinetostat import UnknownNameError, UsageError
from kinetostat.analysis.profile.anatomy import Anatomy, ChosenChain
from kinetostat.analysis.profile.chosen import possible
from kinetostat.analysis.profile.limbs import limbs
from kinetostat.urdf.description import JointType
from kinetostat.urdf.document import parse
from kinetostat.urdf.srdf import read_srdf
from trees import load_text, random_tree

POPPY = """
base: l_hip_x l_hip_z l_hip_y@0.05 l_knee@0.18 l_ankle@0.18
base: r_hip_x r_hip_z r_hip_y@0.05 r_knee@0.18 r_ankle@0.18
base: abs_y@0.02 abs_x@0.05 abs_z@0.05 bust_y@0.08 bust_x@0.03
bust_x: head_z@0.1 head_y@0.02
bust_x: l_shoulder_y@0.08 l_shoulder_x@0.05 l_arm_z@0.04 l_elbow@0.15
bust_x: r_shoulder_y@0.08 r_shoulder_x@0.05 r_arm_z@0.04 r_elbow@0.15
"""
HAND = """
palm: thumb1 thumb2@0.03
palm: index1*thumb1 index2*thumb1@0.03
palm: middle1 middle2*middle1@0.03
"""
ARM = "base: a1 a2@0.1 a3@0.4 a4@0.3 a5@0.05 a6@0.05 palm=\n"


def with_groups(model: ks.Model, text: str) -> ks.Model:
    """Return a robot with the groups of an SRDF."""
    semantics = read_srdf(parse(f'<robot name="r">{text}</robot>'.encode(), "r.srdf"), model.robot)
    return replace(model, loaded=replace(model.loaded, semantics=semantics))


def group(name: str, joints: str) -> str:
    return f'<group name="{name}">{"".join(f"<joint name={chr(34)}{j}{chr(34)}/>" for j in joints.split())}</group>'


def told(anatomy: Anatomy) -> str:
    """Return what is told of what belongs to no limb, in one text."""
    return "\n".join(f"{left.what}: {left.why}" for left in anatomy.left)


def chains(anatomy: Anatomy) -> dict[str, tuple[str, str, int]]:
    """Return base, frame and number of joints of each limb."""
    return {limb.name: (limb.base, limb.frame, len(limb.joints)) for limb in anatomy.limbs}


class TestEveryRobot:
    @pytest.mark.parametrize("seed", range(80))
    def test_a_limb_is_a_chain_that_moves_and_names_differ(self, seed):
        model = random_tree(seed, floating_base=seed % 7 == 0, most=4 + seed % 30)
        anatomy = limbs(model)
        robot = model.robot
        assert len(anatomy.limbs) <= 8
        assert len({limb.name for limb in anatomy.limbs}) == len(anatomy.limbs)
        assert all(left.what and left.why for left in anatomy.left)
        for limb in anatomy.limbs:
            assert limb.joints == tuple(joint.name for joint in robot.moving_joints(limb.base, limb.frame))
            assert all(robot.joint_by_name[name].type is not JointType.FLOATING for name in limb.joints)
        assert anatomy == limbs(model)

    @pytest.mark.parametrize("seed", range(80))
    def test_what_moves_is_in_a_limb_or_something_is_told(self, seed):
        model = random_tree(seed, most=8)
        anatomy = limbs(model)
        within = {name for limb in anatomy.limbs for name in limb.joints}
        for joint in model.robot.joints:
            if joint.type is not JointType.FIXED and joint.name not in within:
                assert anatomy.left, joint.name
        assert anatomy.limbs or "limbs" in {left.what for left in anatomy.left}

    @pytest.mark.parametrize("seed", range(60))
    def test_chosen_chains_are_the_limbs_whatever_the_tree_shows(self, seed):
        model = random_tree(seed, most=15)
        robot = model.robot
        frames = [tip for tip in robot.tips if robot.movable_path(robot.root, tip)]
        anatomy = limbs(model, [ChosenChain(frame, name=f"chain {i}") for i, frame in enumerate(frames)])
        if frames:
            assert [limb.frame for limb in anatomy.limbs] == frames
            assert {limb.found for limb in anatomy.limbs} == {"settings"}

    def test_names_from_files_are_told_as_text(self):
        hostile = "\u202e&lt;i&gt;"
        joint = '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/></joint>'
        links = "".join(f'<link name="{name}"/>' for name in ("base", "a", "b", hostile))
        ways = joint.format("j1", "base", "a") + joint.format("j2", "a", "b") + joint.format(hostile, "base", hostile)
        lines = told(limbs(load_text(f'<robot name="r">{links}{ways}</robot>')))
        assert "\\u202e<i>" in lines
        assert lines.replace("\n", "").isprintable()

    def test_the_largest_robots_that_are_read(self):
        star = limbs(grown("\n".join(f"base: s{i}" for i in range(300))))
        assert len(star.limbs) == 8
        assert "292 more limbs" in told(star)
        (chain,) = limbs(grown("base: " + " ".join(f"c{i}" for i in range(300)))).limbs
        assert len(chain.joints) == 300


TREES = {
    "an arm": ("base: a1 a2 a3 tool0=", {"tool0": ("base", "tool0", 3)}),
    "a single joint": ("base: a1", {"a1": ("base", "a1", 1)}),
    "a slide": ("base: a1|", {"a1": ("base", "a1", 1)}),
    "a single joint without end": ("base: a1~", {"a1": ("base", "a1", 1)}),
    "a planar joint": ("base: a1# plate=", {"a1": ("base", "a1", 1)}),
    "an arm on a base that drives": ("base: drive# a1 a2 tool0=", {"tool0": ("drive", "tool0", 2)}),
    "an arm on a base that floats": ("base: free^ a1 a2 tool0=", {"tool0": ("free", "tool0", 2)}),
    "an arm and what it lets go": ("base: a1 a2\na2: thing^", {"a2": ("base", "a2", 2)}),
    "a pendulum on a cart, without masses": ("base: cart| pole~", {"pole": ("base", "pole", 2)}),
    "nothing that moves": ("base: a= b=", {}),
    "wheels": ("base: w1~\nbase: w2~", {}),
    "rotors and an arm": (
        "\n".join(f"base: r{i}~" for i in range(4)) + "\nbase: a1 a2 ee=",
        {"ee": ("base", "ee", 2)},
    ),
    "an arm with a hand": (ARM + HAND, {"palm": ("base", "palm", 6)}),
    "a hand": (HAND.replace("palm", "base"), {"thumb2": ("base", "thumb2", 2)}),
    "a hand on a wrist": (
        "base: w1@0.2 w2@0.03 palm=\n" + "\n".join(f"palm: f{i}a f{i}b@0.05 f{i}c@0.03" for i in range(3)),
        {f"f{i}c": ("palm", f"f{i}c", 3) for i in range(3)},
    ),
    "a short arm with a hand of more joints": (
        "base: s1 s2@0.1 s3@0.5 palm=@0.4\npalm: thumb1 thumb2@0.03 thumb3@0.02 thumb4@0.02\n"
        "palm: finger1 finger2@0.03 finger3@0.02 finger4@0.02",
        {"palm": ("base", "palm", 3)},
    ),
    "an arm whose hand begins at a thumb": (
        "base: a1 a2@0.3 a3@0.3 mount= hand= thumb_base=\nthumb_base: i1 i2@0.03\nthumb_base: t1 t2@0.03",
        {"hand": ("base", "hand", 3)},
    ),
    "an arm with a jaw": ("base: a1 a2 a3 palm= jaw", {"palm": ("base", "palm", 3)}),
    "an arm with a tool before its last joint": ("base: a1 a2 a3\na3: tool0=\na3: x1", {"tool0": ("base", "tool0", 3)}),
    "a gripper whose second jaw follows": ("base: a1 a2 a3\na3: g1|\na3: g2|*g1", {"a3": ("base", "a3", 3)}),
    "a gripper alone": ("base: g1 h1*g1\nbase: g2*g1 h2*g1", {"h1": ("base", "h1", 1)}),
    "a hand of fingers that a motor each bends": (
        "base: thumb1 thumb2@0.03 thumb3*thumb2@0.03\n"
        + "\n".join(f"base: f{i}a f{i}b*f{i}a@0.04 f{i}c*f{i}a@0.03" for i in range(4)),
        {"thumb3": ("base", "thumb3", 2)} | {f"f{i}c": ("base", f"f{i}c", 1) for i in range(4)},
    ),
    "a parallelogram": (
        "base: j1 j2@0.3 j3@0.6\nj1: p1*j2@0.2\np1: p2*j3@0.6\nj3: j4@0.8 flange=",
        {"flange": ("base", "flange", 4)},
    ),
    "joints that motors drive": ("base: m1~\nbase: m2~\nbase: a1*m1 a2*m2@0.3 tool0=", {"tool0": ("base", "tool0", 2)}),
    "a camera on the forearm": (
        "base: a1 a2 a3@0.4\na3: cam\na3: a4@0.4 a5@0.05 a6@0.05 tool0=",
        {"tool0": ("base", "tool0", 6)},
    ),
    "pendulums on a cart": ("base: cart|\ncart: p1\ncart: p2", {"p1": ("base", "p1", 2), "p2": ("base", "p2", 2)}),
    "a humanoid whose trunk has more joints than its arms": (
        POPPY,
        {
            "l_ankle": ("base", "l_ankle", 5), "r_ankle": ("base", "r_ankle", 5), "head_y": ("bust_x", "head_y", 2),
            "l_elbow": ("bust_x", "l_elbow", 4), "r_elbow": ("bust_x", "r_elbow", 4),
        },
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", TREES)
def test_limbs_are_those_that_a_person_would_name(case):
    text, wanted = TREES[case]
    found = chains(limbs(grown(text)))
    assert {name: found.get(name) for name in wanted} == wanted
    assert case == "a hand" or len(found) == len(wanted)


TOLD = {
    "wheels": (TREES["wheels"][0], ["w1, w2: wheel, caster or rotor", "limbs: there are none"]),
    "nothing that moves": ("base: a=", ["limbs: no joint moves"]),
    "a hand": (ARM + HAND, ["hand beyond palm: 3 fingers, 3 joints (thumb1, thumb2, middle1)", "index1, index2"]),
    "a gripper": (ARM + "palm: g1|\npalm: g2|*g1", ["gripper beyond palm: 1 joint (g1)", "g2: 1 follower"]),
    "a head with eyes": ("base: n1 n2\nn2: eye_l\nn2: eye_r", ["joints beyond n2: 2 joints (eye_l, eye_r): short"]),
    "a trunk": (POPPY, ["abs_y, abs_x, abs_z, bust_y and 1 more: of no limb", "held at the middle of limits"]),
    "a lone joint": ("base: a1 a2\nbase: b1 b2\nbase: pan", ["pan: one joint alone, beside longer limbs"]),
    "nothing but what floats": ("base: free^", ["free: floats", "limbs: there are none: nothing moves but"]),
    "what floats": ("base: free^ a1 a2", ["free: floats: held at zero"]),
    "many limbs": ("\n".join(f"base: a{i} b{i}" for i in range(10)), ["b8, b9: 2 more limbs", "[[robots.chains]]"]),
}


@pytest.mark.parametrize("case", TOLD)
def test_what_belongs_to_no_limb_is_told_with_its_reason(case):
    text, wanted = TOLD[case]
    lines = told(limbs(grown(text)))
    assert [part for part in wanted if part not in lines] == []


class TestGroups:
    def test_a_group_names_the_limb_that_it_is(self):
        model = with_groups(grown(POPPY), group("left leg", "l_hip_x l_hip_z l_hip_y l_knee l_ankle"))
        (leg,) = (limb for limb in limbs(model).limbs if limb.found == "group")
        assert (leg.name, leg.base, leg.frame, len(leg.joints)) == ("left leg", "base", "l_ankle", 5)

    def test_a_group_gives_begin_and_end(self):
        model = with_groups(grown("base: a1 a2 a3 a4 tool0="), group("upper", "a2 a3"))
        assert chains(limbs(model)) == {"upper": ("a1", "a3", 2)}
        chain = '<group name="arm"><chain base_link="mount" tip_link="a3"/></group>'
        model = with_groups(grown("base: mount= a1 a2 a3 tool0="), chain)
        assert chains(limbs(model)) == {"arm": ("mount", "tool0", 3)}

    def test_the_group_that_is_most_alike_counts(self):
        groups = group("all", "a1 a2 a3 a4 g1") + group("arm", "a1 a2 a3 a4") + group("half", "a1 a2")
        model = with_groups(grown("base: a1 a2 a3 a4\na4: g1|\na4: g2|"), groups)
        assert chains(limbs(model)) == {"arm": ("base", "a4", 4)}

    def test_a_group_with_a_trunk_makes_the_limb_longer(self):
        text = "base: t1\nt1: a1 a2 a3\nt1: b1 b2 b3"
        model = with_groups(grown(text), group("left", "t1 a1 a2 a3"))
        assert chains(limbs(model)) == {"left": ("base", "a3", 4), "b3": ("t1", "b3", 3)}
        assert "t1" not in told(limbs(model))

    def test_groups_of_two_limbs_name_neither(self):
        text = "base: a1 a2 a3\nbase: b1 b2 b3"
        model = with_groups(grown(text), group("both", "a1 a2 a3 b1 b2 b3"))
        assert [limb.name for limb in limbs(model).limbs] == ["a3", "b3"]

    def test_a_group_with_a_slip_in_it_gives_the_name_alone(self):
        text = "base: a1 a2 a3\nbase: b1 b2 b3"
        model = with_groups(grown(text), group("left", "a1 a2 a3 b1"))
        assert chains(limbs(model))["left"] == ("base", "a3", 3)

    def test_a_group_without_a_limb_is_one_if_its_joints_follow_one_another(self):
        groups = group("waist", "abs_y abs_x abs_z bust_y bust_x") + group("hips", "l_hip_x r_hip_x")
        names = chains(limbs(with_groups(grown(POPPY), groups)))
        assert names["waist"] == ("base", "bust_x", 5)
        assert "hips" not in names
        assert "abs_y" not in told(limbs(with_groups(grown(POPPY), groups)))

    def test_fingers_of_a_hand_are_no_limbs_though_they_have_a_group(self):
        model = with_groups(grown(ARM + HAND), group("thumb", "thumb1 thumb2") + group("arm", "a1 a2 a3 a4 a5 a6"))
        assert chains(limbs(model)) == {"arm": ("base", "palm", 6)}

    def test_wheels_are_no_limbs_though_they_have_a_group(self):
        text = "base: arm1 arm2\nbase: rocker1| wheel1~\nbase: rocker2| wheel2~"
        model = with_groups(grown(text), group("drive", "rocker1 wheel1"))
        assert chains(limbs(model)) == {"arm2": ("base", "arm2", 2)}

    def test_names_differ_though_a_group_is_called_as_a_frame(self):
        model = with_groups(grown("base: a1 a2\nbase: b1 b2"), group("a2", "b1 b2"))
        assert sorted(chains(limbs(model)).values()) == [("base", "a2", 2), ("base", "b2", 2)]
        assert len(chains(limbs(model))) == 2
        model = with_groups(grown("base: a1 a2\nbase: b1 b2"), group("b2", "a1 a2"))
        assert chains(limbs(model)) == {"b2": ("base", "a2", 2), "b2 (2)": ("base", "b2", 2)}


class TestChosen:
    def test_exactly_these_in_this_order(self):
        chosen = [ChosenChain("l_elbow", "base", "left", 1.5), ChosenChain("l_elbow", "r_elbow")]
        left, across = limbs(grown(POPPY), chosen).limbs
        assert (left.name, left.base, left.frame, len(left.joints), left.payload) == ("left", "base", "l_elbow", 9, 1.5)
        assert (across.name, across.base, across.payload) == ("l_elbow", "r_elbow", None)
        assert across.joints[:1] == ("r_elbow",)
        assert len(across.joints) == 8

    def test_the_other_joints_are_told(self):
        anatomy = limbs(grown("base: a1 a2\nbase: b1\nbase: c1*a1"), [ChosenChain("a2")])
        assert "b1: of no chain that the settings name" in told(anatomy)
        assert "c1: 1 follower" in told(anatomy)

    def test_a_finger_can_be_chosen(self):
        (finger,) = limbs(grown(ARM + HAND), [ChosenChain("thumb2", "palm")]).limbs
        assert finger.joints == ("thumb1", "thumb2")

    @pytest.mark.parametrize(
        ("chosen", "error", "words"),
        [
            ([ChosenChain("tool1")], UnknownNameError, "did you mean 'tool0'"),
            ([ChosenChain("tool0", "bsae")], UnknownNameError, "did you mean 'base'"),
            ([ChosenChain("tool0", "a3")], UsageError, "no joint moves 'tool0' relative to 'a3'"),
            ([ChosenChain("tool0"), ChosenChain("tool0", "a1")], UsageError, "two chains are called 'tool0'"),
            ([ChosenChain("a1", name="x"), ChosenChain("a2", name="x")], UsageError, "two chains are called 'x'"),
        ],
    )
    def test_what_cannot_be_chosen_is_refused_with_a_remedy(self, chosen, error, words):
        with pytest.raises(error) as caught:
            limbs(grown("base: a1 a2 a3 tool0="), chosen)
        assert words in str(caught.value)
        assert caught.value.remedy

    def test_what_cannot_be_chosen_leaves_the_others_as_they_are(self):
        robot = grown("base: a1 a2 a3 tool0=").robot
        good, other = ChosenChain("tool0"), ChosenChain("a2", "a1", "wrist", 2.0)
        slips = [ChosenChain("tool1", place="k.toml:4"), ChosenChain("a1", name="wrist"), ChosenChain("base")]
        assert possible(robot, [good, other]) == ((good, other), ())
        kept, refused = possible(robot, [slips[0], good, other, *slips[1:]])
        assert kept == (good, other)
        assert [left.what for left in refused] == ["chain 'tool1' (k.toml:4)", "chain 'wrist'", "chain 'base'"]
        assert [left.place for left in refused] == ["k.toml:4", "", ""]
        assert "did you mean 'tool0'" in refused[0].why
        assert possible(robot, slips[:1])[1][-1].why.endswith("limbs are found instead")


REAL = {
    "example:ur5_robot": {"tool0": ("world", "tool0", 6)},
    "example:panda": {"arm": ("panda_link0", "panda_hand_tcp", 7)},
    "example:baxter": {
        "right_gripper_base_link": ("torso", "right_gripper_base_link", 7),
        "left_gripper_base_link": ("torso", "left_gripper_base_link", 7),
    },
    "example:anymal_b_simple_description/anymal": {
        f"{leg}_leg": ("base", f"{leg.upper()}_FOOT", 3) for leg in ("lf", "rf", "lh", "rh")
    },
    "example:talos_full_v2": {
        "l_arm": ("torso_2_link", "wrist_left_ft_tool_link", 7),
        "r_arm": ("torso_2_link", "wrist_right_ft_tool_link", 7),
        "l_leg": ("base_link", "left_sole_link", 6), "r_leg": ("base_link", "right_sole_link", 6),
        "head": ("torso_2_link", "head_2_link", 2), "torso": ("base_link", "torso_2_link", 2),
    },
    "example:tiago_dual": {
        "arm_left_tool_link": ("torso_lift_link", "arm_left_tool_link", 7),
        "arm_right_tool_link": ("torso_lift_link", "arm_right_tool_link", 7),
        "head_2_link": ("torso_lift_link", "head_2_link", 2),
    },
    "example:g1_29dof_with_hand_rev_1_0": {
        "left_hand_palm_link": ("torso_link", "left_hand_palm_link", 7),
        "right_hand_palm_link": ("torso_link", "right_hand_palm_link", 7),
        "left_ankle_roll_link": ("pelvis", "left_ankle_roll_link", 6),
        "right_ankle_roll_link": ("pelvis", "right_ankle_roll_link", 6),
    },
    "example:allegro_right_hand": {f"link_{i}.0_tip": ("palm_link", f"link_{i}.0_tip", 4) for i in (3, 7, 11, 15)},
    "example:z1": {"end_effector": ("link00", "link06", 6)},
    "example:so101": {"gripper_frame_link": ("base_link", "gripper_frame_link", 5)},
    "example:iris": {},
    "textbook:planar_2r": {"tool": ("base", "tool", 2)},
    "textbook:skew_1p": {"tool": ("base", "tool", 1)},
    "textbook:rigid_body": {},
}  # fmt: skip


@pytest.mark.parametrize("name", REAL)
def test_real_robots_have_the_limbs_that_their_makers_name(name):
    assert chains(limbs(ks.load(name))) == REAL[name]


def test_hands_of_real_robots_are_told_in_a_line_each():
    lines = told(limbs(ks.load("example:tiago_dual")))
    assert "hand beyond arm_left_tool_link: 5 fingers, 36 joints" in lines
    assert "wheel_right_link, wheel_left_link, caster_front_right_2_link" in lines
    assert len(lines) < 1500
