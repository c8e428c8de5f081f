"""A first policy: read back, met, and about the frames that a person would have named."""

from __future__ import annotations

import re
import shlex
import tomllib

import pytest

import kinetostat as ks
from kinetostat.policy.draft.chains import main_frames, mirrored_name
from kinetostat.policy.draft.toml import value
from kinetostat.policy.draft.writing import drafted
from kinetostat.policy.judging import judge
from kinetostat.policy.settings import read_settings
from kinetostat.policy.table import RobotSettings
from kinetostat_cli.main import run
from policy.policies import written
from policy.test_judging import TWO_ARMS
from policy.test_schema import VALIDATOR
from trailers import SWIVEL, WHEEL, trailer
from trees import load_text

ARM = {"mass", "joint-limits", "worst-gravity-torque", "degrees-of-freedom", "reach", "smallest-singular-value"}
ROBOTS = {
    "example:ur5_robot": (ARM, {"tool0"}),
    "example:panda": (ARM | {"mimic"}, {"panda_hand_tcp"}),
    "example:baxter": (
        (ARM | {"symmetry", "mimic"}) - {"worst-gravity-torque"},
        {"right_gripper_base_link", "left_gripper_base_link"},
    ),
    "example:solo12": (ARM | {"symmetry"}, {"FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT"}),
    "example:allegro_left_hand": (
        ARM - {"worst-gravity-torque"},
        {"link_3.0_tip", "link_7.0_tip", "link_11.0_tip", "link_15.0_tip"},
    ),
    "example:quadrotor_base": ({"mass"}, set()),
    "textbook:wrist_zyz": (ARM, {"tool"}),
    "textbook:rigid_body": ({"mass"}, set()),
}


@pytest.mark.parametrize("name", ROBOTS)
def test_what_is_drafted_is_read_and_met(tmp_path, name):
    kinds, frames = ROBOTS[name]
    model = ks.load(name)
    text = drafted([(model, RobotSettings(path=name))])
    VALIDATOR.validate(tomllib.loads(text))
    (robot,) = read_settings(written(tmp_path, text)).robots
    assert robot.path == name
    outcomes = judge(model, robot.expect, folder=tmp_path)
    assert [outcome for outcome in outcomes if outcome.met is not True] == []
    assert {outcome.kind for outcome in outcomes} == kinds
    assert {one.frame for one in robot.expect if one.kind == "degrees-of-freedom"} == frames
    assert max(map(len, text.splitlines())) < 1000


def test_a_robot_that_is_changed_does_not_meet_it_any_more(tmp_path):
    model = ks.load("textbook:puma560")
    (robot,) = read_settings(written(tmp_path, drafted([(model, RobotSettings(path="x"))]))).robots
    text = model.loaded.source.data.decode()
    changes = {
        "mass": ('<mass value="17.4"', '<mass value="15"'),
        "joint-limits": ('effort="', 'effort="0.5" was="'),
        "degrees-of-freedom": ('name="joint4" type="revolute"', 'name="joint4" type="fixed"'),
        "reach": ('xyz="0.4318 ', 'xyz="0.3 '),
    }
    for kind, (old, new) in changes.items():
        assert old in text, kind
        outcomes = judge(load_text(text.replace(old, new)), robot.expect)
        assert kind in {outcome.kind for outcome in outcomes if outcome.met is False}


def commented(text):
    """Return the expectations that a draft has commented out, active."""
    lines = [
        line for line in text.splitlines() if line.startswith("# [[robots.expect]]") or re.match(r"# [\w-]+ = ", line)
    ]
    tables = "\n".join(line.removeprefix("# ") for line in lines if not line.startswith("# select"))
    return tables[tables.index("[[robots.expect]]") :]


def test_the_examples_in_comments_are_sound(tmp_path):
    text = drafted([(ks.load("textbook:planar_2r"), RobotSettings(path="textbook:planar_2r"))])
    (robot,) = read_settings(written(tmp_path, f'[[robots]]\npath = "x"\n{commented(text)}')).robots
    assert [one.kind for one in robot.expect] == ["golden", "holds", "reaches"]


@pytest.mark.parametrize("name", ["textbook:planar_2r", "example:panda"])
def test_the_commands_in_comments_write_what_the_expectations_read(tmp_path, monkeypatch, name):
    model = ks.load(name)
    text = drafted([(model, RobotSettings(path=name))])
    commands = [line.removeprefix("# ") for line in text.splitlines() if line.startswith("# kinetostat fk ")]
    monkeypatch.chdir(tmp_path)
    for command in commands:
        assert run(shlex.split(command)[1:]) == 0
    (robot,) = read_settings(written(tmp_path, f'[[robots]]\npath = "x"\n{commented(text)}')).robots
    golden = [one for one in robot.expect if one.kind == "golden"]
    assert len(golden) == len(commands) > 0
    assert all(outcome.met for outcome in judge(model, golden, folder=tmp_path))


def test_hostile_names_break_no_line(tmp_path):
    name = "&quot;] #&#10;x = 1 &#x202e;\u007f\\"
    text = (
        f'<robot name="r"><link name="base"/><link name="{name}"/>'
        '<joint name="a=b,c&#10;[check]" type="revolute"><parent link="base"/>'
        f'<child link="{name}"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
    )
    try:
        model = load_text(text)
    except ks.RobotError:
        model = load_text(text.replace("&#10;", " ").replace("\u007f", ""))
    drawn = drafted([(model, RobotSettings(path='a"b\\c'))])
    (robot,) = read_settings(written(tmp_path, drawn)).robots
    assert robot.path == 'a"b\\c'
    assert {one.frame for one in robot.expect if one.kind == "degrees-of-freedom"} == {model.robot.links[1].name}
    assert all(outcome.met for outcome in judge(model, robot.expect))


@pytest.mark.parametrize(
    "given",
    [
        "", 'quotes " and \\', "tab\t and line\n", "\x7f\x00\x1b", "\U0001f600 \xe9", True, 3, 0.1, 1e-6, 1e300,
        ("a", "b"), (1.5, 2), {"a b": "c"},
    ],
)  # fmt: skip
def test_values_are_read_back(given):
    read = tomllib.loads(f"x = {value(given)}")["x"]
    assert read == (list(given) if isinstance(given, tuple) else given)


@pytest.mark.parametrize(
    ("name", "known", "mirrored"),
    [
        ("left_hand", ["right_hand"], "right_hand"),
        ("LeftHand", ["RightHand", "righthand"], "RightHand"),
        ("l_gripper", ["r_gripper"], "r_gripper"),
        ("arm_l", ["arm_r"], "arm_r"),
        ("LF_FOOT", ["RF_FOOT", "LH_FOOT"], "RF_FOOT"),
        ("FL_foot", ["FR_foot"], "FR_foot"),
        ("panel", ["paner"], None),
        ("right_hand", ["left_hand"], None),  # each pair is named once, from the left
        ("tool0", ["tool0"], None),
    ],
)
def test_names_of_the_other_side(name, known, mirrored):
    assert mirrored_name(name, known) == mirrored


def test_twenty_thousand_links_are_no_matter_of_minutes():
    fixed = "".join(
        f'<link name="f{i}"/><joint name="k{i}" type="fixed"><parent link="a"/><child link="f{i}"/></joint>'
        for i in range(15_000)
    )
    text = (
        '<robot name="r"><link name="base"/><link name="a"/><joint name="j" type="continuous"><parent link="base"/>'
        f'<child link="a"/><axis xyz="0 0 1"/></joint>{fixed}</robot>'
    )
    robot = load_text(text).robot
    import time

    start = time.perf_counter()
    assert main_frames(robot) == ("a",)
    assert time.perf_counter() - start < 5


def test_nothing_but_its_degrees_of_freedom_is_expected_of_a_caster(tmp_path):
    text = drafted([(trailer(SWIVEL, WHEEL), RobotSettings(path="x"))])
    assert "wheel or a caster" in text
    (robot,) = read_settings(written(tmp_path, text)).robots
    kinds = {one.kind for one in robot.expect}
    assert "degrees-of-freedom" in kinds
    assert not kinds & {"reach", "smallest-singular-value"}


def test_ranges_are_covered_by_what_is_drafted_and_not_by_less(tmp_path):
    model = ks.load("textbook:planar_2r")
    (robot,) = read_settings(written(tmp_path, drafted([(model, RobotSettings(path="x"))]))).robots
    text = model.loaded.source.data.decode()
    narrower = text.replace('upper="3.141592653589793" effort="30"', 'upper="3.1" effort="30"')
    assert narrower != text
    unmet = [outcome for outcome in judge(load_text(narrower), robot.expect) if not outcome.met]
    assert [(outcome.kind, outcome.found) for outcome in unmet] == [("joint-limits", "upper of 'joint2' is 3.1")]


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("", "", "# Both sides are mirror images."),
        ('upper="0.5" effort="3"', 'upper="0.6" effort="3"', "mirror images, but: upper of 'right_elbow' is 0.6"),
        ('"0.3 -0.1 0"', '"0.303 -0.1 0"', "nearly mirror images, but not quite: 'right_tip' is 0.003 m"),
        ('"0.3 -0.1 0"', '"0.9 -0.5 0"', None),
        ('name="right_slide" type="prismatic"', 'name="right_slide" type="revolute"', None),
    ],
)
def test_by_how_much_two_arms_are_not_mirror_images_is_said(old, new, said):
    assert old in TWO_ARMS
    text = drafted([(load_text(TWO_ARMS.replace(old, new) if old else TWO_ARMS), RobotSettings(path="x"))])
    assert (said in text) if said else ("mirror" not in text)


def test_numbers_that_hardly_are_ones_are_drafted_from(tmp_path):
    text = ks.load("textbook:planar_2r").loaded.source.data.decode()
    tiny = text.replace('upper="3.141592653589793" effort="30"', 'upper="1e-310" effort="1e-320"')
    assert tiny != text
    (robot,) = read_settings(written(tmp_path, drafted([(load_text(tiny), RobotSettings(path="x"))]))).robots
    assert all(outcome.met for outcome in judge(load_text(tiny), robot.expect))
