"""The rules about joints: laws, severities, real robots, and how long they take."""

import math
import random
import time

import pytest

from kinetostat.lint.finding import Severity
from kinetostat.lint.rules.joints import JOINTS
from kinetostat.lint.rules.joints.laws import laws
from kinetostat.lint.subject import subject_of
from kinetostat.urdf.files import example_robots

LINKS = '<link name="a"/><link name="b"/><link name="c"/><link name="d"/>'
AXIS = '<axis xyz="0 0 1"/>'
LIMIT = '<limit lower="{}" upper="{}" effort="1" velocity="1"/>'


def found(folder, joints, *codes, links=LINKS):
    """Return what the rules of these codes (all if none) find on joints."""
    path = folder / "robot.urdf"
    path.write_text(f'<robot name="r">{links}{joints}</robot>', encoding="utf-8")
    return on(subject_of(str(path)), *codes)


def on(subject, *codes):
    return [f for rule in JOINTS if not codes or rule.code in codes for f in rule.check(subject)]


def joint(name, kind, inside, parent="a", child="b"):
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>'


# --- laws --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("steps", [s for s in range(-36, 37) if s])
def test_a_part_of_pi_is_rounded_if_and_only_if_digits_are_missing(steps, tmp_path):
    exact = steps * math.pi / 12

    def finds(text):
        return bool(found(tmp_path, joint("j", "fixed", f'<origin rpy="{text} 0 0"/>'), "J205"))

    for decimals in (4, 5):
        cut_off = math.trunc(exact * 10**decimals) / 10**decimals
        assert finds(f"{exact:.{decimals}f}")
        assert finds(f"{cut_off:.{decimals}f}")
    for decimals in (7, 9, 11):
        assert not finds(f"{exact:.{decimals}f}")
    assert not finds(repr(exact))


def test_an_angle_that_is_no_part_of_pi_is_not_rounded(tmp_path):
    numbers = random.Random(0)
    angles = [numbers.uniform(-6.3, 6.3) for _ in range(3000)]
    kept = [a for a in angles if abs(a * 12 / math.pi - round(a * 12 / math.pi)) > 0.02]
    joints = "".join(joint(f"j{i}", "fixed", f'<origin rpy="{a:.6f} 0 0"/>') for i, a in enumerate(kept))
    assert len(kept) > 2000
    assert found(tmp_path, joints, "J205") == []


@pytest.mark.parametrize("seed", range(20))
def test_a_follower_with_the_range_that_its_leader_makes_is_quiet_and_with_less_is_not(seed, tmp_path):
    numbers = random.Random(seed)
    lower, width = numbers.uniform(-2, 1), numbers.uniform(0.1, 2)
    multiplier, offset = numbers.choice([-1, 1]) * numbers.uniform(0.1, 3), numbers.uniform(-1, 1)
    # Where the leader goes, the follower is sent: the extremes of a few hundred positions are its range.
    sent = [multiplier * (lower + width * i / 400) + offset for i in range(401)]

    def finds(low, high):
        leader = joint("j1", "revolute", AXIS + LIMIT.format(lower, lower + width))
        mimic = f'<mimic joint="j1" multiplier="{multiplier!r}" offset="{offset!r}"/>'
        follower = joint("j2", "revolute", AXIS + LIMIT.format(low, high) + mimic, "b", "c")
        return bool(found(tmp_path, leader + follower, "J307"))

    slip = 0.05 * (max(sent) - min(sent))
    assert not finds(min(sent), max(sent))
    assert not finds(min(sent) - slip, max(sent) + slip)
    assert finds(min(sent) + slip, max(sent))
    assert finds(min(sent), max(sent) - slip)


def test_the_law_of_a_chain_is_what_its_followers_do_one_after_the_other(tmp_path):
    numbers = random.Random(1)
    factors = [(numbers.uniform(-2, 2), numbers.uniform(-1, 1)) for _ in range(30)]
    links = "".join(f'<link name="l{i}"/>' for i in range(32))
    inside = [AXIS + LIMIT.format(-1, 1)]
    inside += [
        AXIS + LIMIT.format(-1, 1) + f'<mimic joint="j{i}" multiplier="{k!r}" offset="{o!r}"/>'
        for i, (k, o) in enumerate(factors)
    ]
    made = [joint(f"j{i}", "revolute", text, f"l{i}", f"l{i + 1}") for i, text in enumerate(inside)]
    numbers.shuffle(made)
    path = tmp_path / "robot.urdf"
    path.write_text(f'<robot name="r">{links}{"".join(made)}</robot>', encoding="utf-8")
    law_of = laws(subject_of(str(path)))
    position = expected = 0.37
    for i, (k, o) in enumerate(factors, 1):
        expected = k * expected + o
        law = law_of[f"j{i}"]
        assert law.leader == "j0"
        assert law.multiplier * position + law.offset == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("code", ["J103", "J104", "J105", "J110", "J111", "J202", "J206", "J307"])
def test_the_order_of_the_joints_does_not_matter_nor_do_their_names(code, tmp_path):
    rule = next(rule for rule in JOINTS if rule.code == code)
    path = tmp_path / "robot.urdf"
    path.write_text(rule.bad.robot_text, encoding="utf-8")
    before = on(subject_of(str(path)), code)
    head, *joints = rule.bad.robot_text.split("<joint ")
    last, _, tail = joints[-1].rpartition("</joint>")
    joints = [*joints[:-1], last + "</joint>"]
    turned = head + "".join("<joint " + text for text in reversed(joints)) + tail.replace("</joint>", "", 1)
    path.write_text(turned.replace("shoulder", "Gelenk <1>".replace("<", "&lt;")), encoding="utf-8")
    after = on(subject_of(str(path)), code)
    assert len(before) == len(after) == 1
    assert before[0].message == after[0].message


# --- severities --------------------------------------------------------------------------------------------------


def severities(findings):
    return [finding.severity for finding in findings]


def test_a_slide_out_of_proportion_is_a_warning_and_a_crane_an_info(tmp_path):
    links = '<link name="a"><inertial><mass value="9"/></inertial></link><link name="b"/>'
    slide = '<origin xyz="0 0 {}"/>' + AXIS + LIMIT.format(0, 40)
    assert severities(found(tmp_path, joint("j", "prismatic", slide.format(0.1)), "J112", links=links)) == ["warning"]
    assert severities(found(tmp_path, joint("j", "prismatic", slide.format(10)), "J112", links=links)) == ["info"]


def test_a_robot_that_slides_as_a_whole_is_an_info(tmp_path):
    slides = "".join(
        joint(f"j{i}", "prismatic", AXIS + LIMIT.format(-100, 100), *ends) for i, ends in enumerate(("ab", "bc"))
    )
    heavy = '<link name="{}"><inertial><mass value="9"/></inertial></link>'
    base = '<link name="a"/><link name="b"/>' + heavy.format("c")
    assert severities(found(tmp_path, slides, "J112", links=base)) == ["info", "info"]
    arm = heavy.format("a") + heavy.format("b") + heavy.format("c")
    assert severities(found(tmp_path, slides, "J112", links=arm)) == ["warning", "warning"]


def test_effort_zero_is_a_warning_only_if_no_joint_has_another(tmp_path):
    zero = AXIS + '<limit lower="-1" upper="1" effort="0" velocity="1"/>'
    good = AXIS + LIMIT.format(-1, 1)
    alone = joint("j1", "revolute", zero) + joint("j2", "revolute", zero, "b", "c")
    mixed = joint("j1", "revolute", zero) + joint("j2", "revolute", good, "b", "c")
    assert severities(found(tmp_path, alone, "J107")) == ["warning"]
    assert severities(found(tmp_path, mixed, "J107")) == ["info"]


def test_a_range_of_a_continuous_joint_that_leaves_out_part_of_a_turn_is_a_warning(tmp_path):
    for lower, upper, severity in ((-1.5, 1.5, "warning"), (-3.2, 3.2, "info"), (0, 0, "info"), (-6.28, 0, "info")):
        text = joint("j", "continuous", AXIS + LIMIT.format(lower, upper))
        assert severities(found(tmp_path, text, "J113")) == [severity]


def test_a_pinion_on_a_rack_is_an_info(tmp_path):
    rack = joint("j1", "prismatic", AXIS + LIMIT.format(0, 1))
    pinion = joint("j2", "continuous", AXIS + '<mimic joint="j1" multiplier="50"/>', "b", "c")
    assert severities(found(tmp_path, rack + pinion, "J308")) == ["info"]
    crank = rack.replace("prismatic", "revolute")
    assert severities(found(tmp_path, crank + pinion, "J308")) == ["warning"]


def test_a_leader_that_reaches_beyond_both_limits_of_its_follower_is_an_info(tmp_path):
    for multiplier, offset, severity in ((2, 0, "info"), (1, 1, "warning"), (-1, 2, "warning"), (1.5, 0.5, "warning")):
        leader = joint("j1", "revolute", AXIS + LIMIT.format(-1, 1))
        law = f'<mimic joint="j1" multiplier="{multiplier}" offset="{offset}"/>'
        follower = joint("j2", "revolute", AXIS + LIMIT.format(-1, 1) + law, "b", "c")
        assert severities(found(tmp_path, leader + follower, "J307")) == [severity]


def test_a_sign_is_offered_where_another_would_send_the_follower_within_its_limits(tmp_path):
    for multiplier, offset, limits, offered in (
        (-1, 0, (0, 1), True),  # a gripper whose axis is turned over already
        (-2, 0.5, (0.5, 2.5), True),  # mirrored at the offset, not at 0
        (-2, 0.5, (0, 1.5), False),
        (2, 0, (0, 1), False),
        (1, 0.5, (0, 1), False),
    ):
        leader = joint("j1", "revolute", AXIS + LIMIT.format(0, 1))
        law = f'<mimic joint="j1" multiplier="{multiplier}" offset="{offset}"/>'
        follower = joint("j2", "revolute", AXIS + LIMIT.format(*limits) + law, "b", "c")
        (finding,) = found(tmp_path, leader + follower, "J307")
        assert ("sign of the multiplier" in finding.hint) is offered
        mended = follower.replace(f'multiplier="{multiplier}"', f'multiplier="{-multiplier}"')
        assert (found(tmp_path, leader + mended, "J307") == []) is offered


def test_a_missing_leader_is_answered_with_the_nearest_names(tmp_path):
    leader = joint("left_finger", "revolute", AXIS + LIMIT.format(0, 1))
    follower = joint("right_finger", "revolute", AXIS + LIMIT.format(0, 1) + '<mimic joint="left_fingr"/>', "b", "c")
    (finding,) = found(tmp_path, leader + follower, "J301")
    assert "'left_finger'" in finding.hint


def test_hostile_names_are_printable_and_cut_in_messages(tmp_path):
    name = "x\x1b[31m\n".replace("\x1b", "&#x9b;") + "y" * 500
    text = joint("j", "revolute", AXIS + LIMIT.format(0, 1) + f'<mimic joint="{name}"/>')
    (finding,) = found(tmp_path, text, "J301")
    assert finding.message.isprintable()
    assert len(finding.message) < 200


# --- real robots -------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def real():
    return {name: on(subject_of(f"example:{name}")) for name in example_robots()}


def test_no_real_robot_has_an_error_in_a_joint(real):
    assert {name for name, findings in real.items() for f in findings if f.severity is Severity.ERROR} == set()


def codes_of(real, part):
    return {(f.code, f.severity.value) for name, findings in real.items() if part in name for f in findings}


def test_what_is_known_to_be_wrong_with_real_robots_is_found(real):
    pr2 = [f for name, findings in real.items() if "pr2" in name for f in findings if f.code == "J307"]
    assert [f.line for f in pr2] == [1848, 2712]  # the right finger's sign and its range contradict each other
    assert all("sign of the multiplier" in f.hint for f in pr2)
    assert all("[-0.548, 0] rad; its own limits are [0, 0.548]" in f.message for f in pr2)
    assert ("J301", "warning") in codes_of(real, "alex_psyonic")  # 'index_q1' without its prefix
    assert ("J102", "warning") in codes_of(real, "centauro")  # wheels that are revolute, without a range
    assert ("J306", "warning") in codes_of(real, "talos_reduced")
    assert ("J105", "info") in codes_of(real, "panda_description/panda")
    assert ("J205", "info") in codes_of(real, "xarm7")


@pytest.mark.parametrize("part", ["baxter", "tiago", "ur_description", "g1_", "laikago", "panda", "xarm", "z1"])
def test_well_kept_robots_have_no_warning(real, part):
    assert {severity for _, severity in codes_of(real, part)} <= {"info"}


# --- cost --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "mimic", ["", '<mimic joint="j{next}"/>', '<mimic joint="j{around}"/>', '<mimic joint="nobody{i}"/>']
)
def test_many_joints_take_time_in_proportion(mimic, tmp_path):
    def seconds(count):
        links = "".join(f'<link name="l{i}"/>' for i in range(count + 1))
        inside = '<origin rpy="1.5708 0 3.14"/>' + AXIS + LIMIT.format(0, 40)
        joints = "".join(
            joint(
                f"j{i}",
                "prismatic",
                inside + mimic.format(next=i + 1, around=(i + 1) % count, i=i),
                f"l{i}",
                f"l{i + 1}",
            )
            for i in range(count)
        )
        path = tmp_path / "robot.urdf"
        path.write_text(f'<robot name="r">{links}{joints}</robot>', encoding="utf-8")
        subject = subject_of(str(path))
        start = time.perf_counter()
        on(subject)
        return time.perf_counter() - start

    few, many = min(seconds(500) for _ in range(3)), seconds(8000)
    assert many < 16 * few * 5 + 5  # 16 times as many; squared it would be 256 times as long
