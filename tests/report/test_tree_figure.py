"""The picture of the joints: each is there once, in its limb's colour, at a place of its own, and nothing is cut."""

from collections import Counter
from functools import cache

import pytest

import kinetostat as ks
from figure_texts import covered_texts, cut_texts, texts
from kinetostat.analysis.profile.anatomy import Limb
from kinetostat.analysis.profile.limbs import limbs
from kinetostat.report.figures.embedding import embedded
from kinetostat.report.figures.sheet import GREY, INK
from kinetostat.report.figures.trees import tree_figure
from kinetostat.urdf.description import JointType
from trees import load_text, random_tree

HUMANOID, HANDS = "example:talos_full_v2", "example:g1_29dof_with_hand_rev_1_0"
REAL = ("example:ur5_robot", "example:panda", HUMANOID, HANDS, "example:allegro_right_hand", "example:pr2")
REAL += ("example:iris", "example:tiago", "textbook:planar_1r", "textbook:scara", "example:icub")


@cache
def model_of(source):
    return ks.load(source)


def drawn(source):
    model = model_of(source)
    return tree_figure(model.robot, limbs(model).limbs)


def limb(robot, frame, base=None, name=""):
    base = base or robot.root
    return Limb(name or frame, base, frame, tuple(joint.name for joint in robot.movable_path(base, frame)), "tip")


def moving(robot):
    return [joint for joint in robot.joints if joint.type is not JointType.FIXED]


def symbols(figure):
    """Return the lines that are marks, and the place of each."""
    (ax,) = figure.axes
    marks = [line for line in ax.lines if line.get_marker() not in ("None", None, "")]
    return [(line, tuple(line.get_xydata()[0])) for line in marks]


def branches(figure):
    (ax,) = figure.axes
    return [line for line in ax.lines if line.get_marker() in ("None", None, "")]


@pytest.mark.parametrize("seed", range(12))
def test_every_joint_of_a_random_tree_is_a_symbol_at_its_own_place(seed):
    robot = random_tree(seed, most=20).robot
    found = symbols(tree_figure(robot, ()))
    assert len(found) == len(moving(robot)) + 1  # the ground
    assert len({place for _, place in found}) == len(found)


@pytest.mark.parametrize("seed", range(12))
def test_a_joint_stands_right_of_what_carries_it_and_a_chain_in_one_row(seed):
    robot = random_tree(seed, most=20).robot
    figure = tree_figure(robot, ())
    places = [place for _, place in symbols(figure)]
    ends = [(tuple(line.get_xydata()[0]), tuple(line.get_xydata()[-1])) for line in branches(figure)]
    assert sorted(end for _, end in ends) == sorted(places[1:])  # one line leads to each but the root
    carried = Counter(start for start, _ in ends)
    for start, end in ends:
        assert start in places
        assert start[0] < end[0]
        assert start[1] == end[1] or carried[start] > 1


def test_followers_are_hollow_and_nothing_else_is():
    model = model_of("example:panda")
    found = symbols(tree_figure(model.robot, [limb(model.robot, "panda_link8")]))
    hollow = [line for line, _ in found[1:] if line.get_markerfacecolor() == "white"]
    assert len(hollow) == len(model.robot.followers) == 1


def test_limbs_differ_in_colour_or_dash_and_what_they_share_is_black():
    model = model_of("example:baxter")
    robot = model.robot
    arms = [limb(robot, frame) for frame in ("left_wrist", "right_wrist")]
    figure = tree_figure(robot, arms)
    colours = Counter(line.get_color() for line in branches(figure))
    own = {colour: count for colour, count in colours.items() if colour not in (GREY, INK)}
    assert sorted(own.values()) == [len(arm.joints) for arm in arms] == [7, 7]
    torso = model_of(HUMANOID).robot
    both = [limb(torso, frame) for frame in ("arm_left_7_link", "arm_right_7_link")]
    shared = set(both[0].joints) & set(both[1].joints)
    assert shared
    assert sum(line.get_color() == INK for line in branches(tree_figure(torso, both))) == len(shared)


def test_more_limbs_than_colours_are_told_apart_by_dashes():
    robot = model_of("example:iris").robot
    rotors = [limb(robot, joint.child) for joint in moving(robot)]
    model = model_of("example:icub")
    many = limbs(model).limbs
    assert len(many) > 4 or len(rotors) >= 4
    lines = {(line.get_color(), str(line.get_linestyle())) for line in branches(tree_figure(model.robot, many))}
    assert len(lines - {(INK, "-"), (GREY, "-")}) >= len(many) - 1


@pytest.mark.parametrize("source", [HUMANOID, HANDS, "example:alex_psyonic_hands", "example:tiago"])
def test_hands_are_folded_and_no_joint_is_lost(source):
    robot = model_of(source).robot
    figure = drawn(source)
    said = [text for text, _ in texts(figure)]
    folded = [int(text.split()[0]) for text in said if " joints" in text and text[0].isdigit() and "that" not in text]
    assert folded
    assert len(symbols(figure)) - 1 - len(folded) + sum(folded) == len(moving(robot))


def test_a_hand_by_itself_is_not_folded():
    assert len(symbols(drawn("example:allegro_right_hand"))) == 16 + 1


def test_many_rows_without_limbs_are_folded():
    text = ['<robot name="wheels"><link name="base"/>']
    for i in range(60):
        text.append(
            f'<link name="w{i}"/><joint name="j{i}" type="continuous"><parent link="base"/><child link="w{i}"/>'
        )
        text.append("</joint>")
    figure = tree_figure(load_text("".join([*text, "</robot>"])).robot, ())
    assert "60 joints, 60 tips" in [text for text, _ in texts(figure)]
    assert figure.get_size_inches()[1] < 3


def test_a_robot_without_joints_says_so():
    said = [text for text, _ in texts(drawn("textbook:rigid_body"))]
    assert any("no joint moves" in text for text in said)


def test_a_snake_of_sixty_joints_has_them_all():
    text = ['<robot name="snake"><link name="l0"/>']
    for i in range(60):
        text.append(f'<link name="l{i + 1}"/><joint name="segment_{i}" type="revolute"><parent link="l{i}"/>')
        text.append(
            f'<child link="l{i + 1}"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
        )
    robot = load_text("".join([*text, "</robot>"])).robot
    figure = tree_figure(robot, [limb(robot, "l60")])
    assert len({place for _, place in symbols(figure)}) == 61
    assert not cut_texts(figure)


@pytest.mark.parametrize("source", REAL)
def test_nothing_is_cut_and_names_lie_on_no_other(source):
    figure = drawn(source)
    assert not cut_texts(figure)
    assert not covered_texts(figure)
    assert figure.get_size_inches()[0] <= 9
    assert len(embedded(figure, "r1-tree")) < 40_000


FORKLIFT = (
    '<robot name="forklift"><link name="chassis"/><link name="mast"/><link name="carriage"/><link name="fork"/>'
    '<joint name="mastJoint" type="prismatic"><parent link="chassis"/><child link="mast"/><axis xyz="0 0 1"/>{}</joint>'
    '<joint name="liftJoint" type="prismatic"><parent link="mast"/><child link="carriage"/><axis xyz="0 0 1"/>{}'
    '<mimic joint="mastJoint"/></joint>'
    '<joint name="sideShiftJoint" type="prismatic"><parent link="carriage"/><child link="fork"/><axis xyz="0 1 0"/>{}'
    "</joint></robot>"
).replace("{}", '<limit lower="-1" upper="1" effort="1" velocity="1"/>')


def test_a_follower_inside_a_limb_has_its_colour_and_is_hollow():
    robot = load_text(FORKLIFT).robot
    figure = tree_figure(robot, [limb(robot, "fork")])
    assert len({line.get_color() for line in branches(figure)}) == 1
    (_, mast), (_, lift), (_, _) = symbols(figure)[1:]
    hollow = [line for line, _ in symbols(figure)[1:] if line.get_markerfacecolor() == "white"]
    assert mast[0] < lift[0]
    assert [line.get_markeredgecolor() for line in hollow] == [branches(figure)[0].get_color()]


def test_an_ending_that_all_joints_share_is_not_written():
    said = [text for text, _ in texts(tree_figure(load_text(FORKLIFT).robot, ()))]
    assert {"mast", "lift", "sideShift"} <= set(said)
    other = FORKLIFT.replace("liftJoint", "raiser")
    assert {"mastJoint", "raiser"} <= {text for text, _ in texts(tree_figure(load_text(other).robot, ()))}


@pytest.mark.parametrize("source", ["example:alex_nub_hands", HUMANOID, HANDS, "example:human"])
def test_names_break_between_words_alone(source):
    robot, said = model_of(source).robot, [text for text, _ in texts(drawn(source))]
    lines = [line for line in said if any(line in joint.name for joint in moving(robot))]
    assert lines
    for line in lines:
        places = [(joint.name, joint.name.index(line)) for joint in moving(robot) if line in joint.name]
        assert any(_between_words(name, at) and _between_words(name, at + len(line)) for name, at in places), line


def _between_words(name, at):
    return at in (0, len(name)) or "_" in name[at - 1 : at + 1] or (name[at - 1].islower() and name[at].isupper())


@pytest.mark.parametrize("source", [HUMANOID, HANDS, "example:alex_nub_hands", "example:human", "example:icub"])
def test_no_name_lies_on_a_line_of_another_row(source):
    figure = drawn(source)
    (ax,) = figure.axes
    upright = [line.get_xydata()[1:3] for line in branches(figure) if len(line.get_xydata()) == 4]
    ends = [ax.transData.transform(each) for each in upright]
    for text, box in texts(figure):
        for (x, low), (_, high) in ends:
            meets = box.x0 + 1 < x < box.x1 - 1 and max(min(low, high), box.y0) < min(max(low, high), box.y1)
            assert not meets, text


def test_that_joints_turn_is_not_said_where_all_do():
    turning = tree_figure(model_of("example:alex_nub_hands").robot, ())
    assert "turns" not in [text for text, _ in texts(turning)]
    assert "slides" in [text for text, _ in texts(drawn("textbook:scara"))]
