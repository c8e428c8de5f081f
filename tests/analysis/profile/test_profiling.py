"""Profiles: laws that hold for every limb, textbook limbs in closed form, and real robots: nothing is silent."""

import math

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.profile import holding, limb_profiling, profiling
from kinetostat.analysis.profile.anatomy import Anatomy, Left, Limb
from kinetostat.analysis.profile.holding import held_pose
from kinetostat.analysis.profile.limbs import limbs
from kinetostat.analysis.profile.profiling import profile
from kinetostat.analysis.sweeping.sweep import DEFAULT
from kinetostat.errors import UsageError
from textbook_support import textbook
from trees import load_text, random_urdf

FEW = {"samples": 400, "starts": 12}
SWEPT = "manipulability over configurations"
WITHOUT_SWEEP = "manipulability, poses and map of the reach"


def limb(model, frame=None, base=None, **known):
    """Return the limb between two frames."""
    robot = model.robot
    frame, base = frame or robot.default_tip(), base or robot.root
    joints = tuple(joint.name for joint in robot.movable_path(base, frame))
    return Limb(known.pop("name", frame), base, frame, joints, "tip", **known)


def of(model, *chosen, **asked):
    """Return the profile of some limbs, few configurations each."""
    return profile(model, Anatomy(chosen or (limb(model),), ()), **{**FEW, **asked})


def told(one):
    """Return what is left out, and why."""
    return {left.what: left.why for left in one.left}


ARM = """
<joint name="{s}1" type="revolute"><parent link="torso"/><child link="{s}a"/><origin xyz="0.1 {y} 0.3" rpy="0.2 0 0"/>
  <axis xyz="0 1 0"/><limit lower="-1.5" upper="2" effort="{effort}" velocity="1"/></joint>
<joint name="{s}2" type="revolute"><parent link="{s}a"/><child link="{s}b"/><origin xyz="0.3 0 0"/>
  <axis xyz="0 0 1"/><limit lower="-2" upper="1" effort="{effort}" velocity="1"/></joint>
<joint name="{s}3" type="prismatic"><parent link="{s}b"/><child link="{s}c"/><origin xyz="0.2 0 0.1" rpy="0 0.5 0"/>
  <axis xyz="1 0 0"/><limit lower="0" upper="0.3" effort="{effort}" velocity="1"/></joint>
<joint name="{s}4" type="revolute"><parent link="{s}c"/><child link="{s}tool"/><origin xyz="0 0.1 0"/>
  <axis xyz="1 0 1"/><limit lower="-1" upper="1" effort="{effort}" velocity="1"/></joint>
<link name="{s}a">{body}</link><link name="{s}b">{body}</link><link name="{s}c">{body}</link>
<link name="{s}tool">{body}</link>
"""
BODY = (
    '<inertial><origin xyz="0.05 0.02 -0.1"/><mass value="{}"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
)


def two_armed(mass=0.8, effort=20.0, srdf=None, folder=None):
    """Return a torso with two arms that are the same but for where they sit."""
    body = BODY.format(mass) if mass is not None else ""
    arms = [ARM.format(s=side, y=y, body=body, effort=effort) for side, y in (("left", 0.5), ("right", -0.2))]
    text = f'<robot name="two"><link name="torso"/>{"".join(arms)}</robot>'
    if srdf is None:
        return load_text(text)
    (folder / "two.urdf").write_text(text)
    (folder / "two.srdf").write_text(f'<robot name="two">{srdf}</robot>')
    return ks.load(folder / "two.urdf")


def one_number(one):
    """Return all numbers of a limb's profile that do not depend on where it sits."""
    sweep = one.sweep
    found = {name: [part.mean, *part.quantiles.values()] for name, part in sweep.measures.items() if "." not in name}
    return found | {
        "near": sweep.near_singular_share,
        "reach": one.reach,
        "payload": float(one.payload.value),
        "poses": [[pose.values[name] for name in (*DEFAULT, "effort_use")] for pose in one.poses],
        "families": [
            (f.kind, f.codimension, f.inside_limits, tuple(f.positions.values())) for f in one.families.families
        ],
        "loaded": list(np.abs(one.loaded.torques)),
    }


# --- laws ------------------------------------------------------------------------------------------------------------


def test_equal_limbs_have_equal_numbers():
    model = two_armed()
    found = of(model, limb(model, "lefttool"), limb(model, "righttool"), payload=0.5)
    left, right = map(one_number, found.limbs)
    assert left.keys() == right.keys()
    for name, numbers in left.items():
        if name == "families":
            assert [one[:3] for one in numbers] == [one[:3] for one in right[name]]
            for one, other in zip(numbers, right[name], strict=True):
                assert one[3] == pytest.approx(other[3], abs=1e-6)
        else:
            assert np.allclose(numbers, right[name], rtol=1e-6, atol=1e-9), name


ROBOTS = ("textbook:planar_2r", "textbook:scara", "textbook:puma560", "textbook:stanford", "example:panda")


@pytest.mark.parametrize("name", ROBOTS)
def test_what_is_measured_lies_between_its_extremes_and_is_measured_where_the_tool_is(name):
    model = ks.load(name)
    frame = "panda_hand_tcp" if "panda" in name else None
    (one,) = of(model, limb(model, frame)).limbs
    for part in one.sweep.measures.values():
        if part.count:
            ordered = [part.minimum.value, *part.quantiles.values(), part.maximum.value]
            assert ordered == sorted(ordered), part
            assert part.minimum.value <= part.mean <= part.maximum.value
    least = one.sweep.measures["minimum_singular_value"].minimum
    assert one.smallest[least.row] == least.value == np.min(one.smallest)
    placed = ks.fk(model, one.limb.frame, least.configuration, relative_to=one.limb.base)
    assert np.allclose(one.positions[least.row], placed.position, atol=1e-12)
    assert len(one.positions) == len(one.smallest) == one.sweep.count == FEW["samples"]
    for pose in one.poses:  # smallest <= (product)^(1/k) <= largest, and the ratio is of these two
        count, values = one.sweep.measures, pose.values
        smallest, ratio = values["minimum_singular_value"], values["inverse_condition_number"]
        rank = one.families.mechanism.generic_rank
        assert smallest - 1e-12 <= values["yoshikawa"] ** (1 / rank)
        assert 0 <= ratio <= 1
        if ratio > 0:
            assert values["yoshikawa"] ** (1 / rank) <= smallest / ratio + 1e-12
        assert set(values) == {column for column in count if "." not in column}


@pytest.mark.parametrize("name", ROBOTS)
def test_a_pose_has_the_numbers_of_manipulability_and_of_a_sweep_over_that_pose_alone(name):
    model = ks.load(name)
    frame = "panda_hand_tcp" if "panda" in name else None
    (one,) = of(model, limb(model, frame)).limbs
    assert [pose.name for pose in one.poses][:1] == ["zero"]
    for pose in one.poses:
        blocks = pose.manipulability.blocks
        block = blocks.get("task", blocks["full"])
        assert block.task.rows == one.sweep.task.rows
        count = one.families.mechanism.generic_rank
        own = block.singular_values[:count]
        assert pose.values["minimum_singular_value"] == pytest.approx(float(own[-1]), abs=1e-12)
        assert pose.values["yoshikawa"] == pytest.approx(float(np.prod(own)), rel=1e-9, abs=1e-12)
        again = ks.sweep(model, one.limb.frame, pose.at.q, configurations=pose.at.q[None], measures="effort_use")
        use = again.measures["effort_use"].maximum.value
        assert pose.values["effort_use"] == pytest.approx(use, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("name", ["textbook:anthropomorphic", "textbook:puma560", "example:so101", "example:panda"])
def test_with_the_payload_one_joint_is_at_its_limit_and_none_beyond(name):
    model = ks.load(name)
    frame = {"example:so101": "gripper_frame_link", "example:panda": "panda_hand_tcp"}.get(name)
    (one,) = of(model, limb(model, frame)).limbs
    carried = ks.Payload(float(one.payload.value), one.limb.frame)
    use = ks.torque(model, ks.configuration(model, "mid").q, gravity=True, payload=carried).utilisation
    columns = list(model.robot.velocity_names)
    assert np.nanmax(use) == pytest.approx(1, rel=1e-9)
    assert use[columns.index(one.payload.binding_joint)] == pytest.approx(1, rel=1e-9)


def test_the_payload_asked_for_loads_the_limb_and_a_limb_s_own_goes_first():
    model = two_armed()
    left, right = limb(model, "lefttool"), limb(model, "righttool", payload=2.0)
    found = of(model, left, right, payload=0.5)
    assert [one.loaded.payload for one in found.limbs] == [ks.Payload(0.5, "lefttool"), ks.Payload(2.0, "righttool")]
    assert found.limbs[0].loaded.joints == ("left1", "left2", "left3", "left4")
    without = np.abs(found.worst.torques)
    assert found.worst.joints == (*left.joints, *right.joints)
    grown = [np.abs(one.loaded.torques).sum() for one in found.limbs]
    assert without[:4].sum() < grown[0] < grown[1]  # the arms are equal, their payloads are not
    assert [one.loaded for one in of(model, left).limbs] == [None]


def test_the_same_question_has_the_same_answer_and_another_seed_other_configurations():
    model = textbook("puma560")
    first, again, other = of(model), of(model), of(model, seed=1)
    assert np.array_equal(first.limbs[0].positions, again.limbs[0].positions)
    assert first.certificates == again.certificates
    assert one_part(first) == one_part(again)
    assert not np.array_equal(first.limbs[0].positions, other.limbs[0].positions)


def one_part(found):
    one = found.limbs[0]
    families = [(f.positions, f.support, f.hits, tuple(f.witness)) for f in one.families.families]
    return (
        one.reach,
        float(one.payload.value),
        [pose.values for pose in one.poses],
        families,
        found.worst.torques.tolist(),
    )


def test_every_answer_has_a_certificate_that_agrees_and_says_how_many_numbers_it_is_of():
    model = two_armed()
    found = of(model, limb(model, "lefttool"), limb(model, "righttool"))
    names = set(found.certificates)
    assert {"masses", "worst gravity torques", f"{SWEPT} of 'lefttool'", "reach of 'righttool'"} <= names
    assert {
        "payload of 'lefttool'",
        "singular families of 'righttool'",
        "manipulability at poses of 'lefttool'",
    } <= names
    assert all(one.agree for one in found.certificates.values())
    empty = {name for name, one in found.certificates.items() if not one.numbers}
    assert empty <= {f"singular families of '{one.limb.name}'" for one in found.limbs if not one.families.families}
    alone = profile(ks.load("textbook:puma560", crosscheck=False), Anatomy((limb(textbook("puma560")),), ()), **FEW)
    assert all(one.agree is None and one.numbers == 0 for one in alone.certificates.values())


def test_progress_goes_up_from_nothing_to_all():
    model, shares, words = two_armed(), [], []

    def tell(what, share):
        words.append(what)
        shares.append(share)

    of(model, limb(model, "lefttool"), limb(model, "righttool"), progress=tell)
    assert shares == sorted(shares)
    assert (shares[0], shares[-1]) == (0.0, 1.0)
    assert "righttool: reach" in words


# --- textbook --------------------------------------------------------------------------------------------------------


def test_reach_is_from_where_the_limb_begins():
    (one,) = of(textbook("planar_2r_6_3")).limbs
    assert one.reach == pytest.approx(9, abs=1e-6)
    clipped = load_text(
        '<robot name="clipped"><link name="base"/><link name="post"/><link name="a"/><link name="b"/><link name="tip"/>'
        '<joint name="up" type="fixed"><parent link="base"/><child link="post"/>'
        '<origin xyz="5 2 7" rpy="1 2 3"/></joint>'
        '<joint name="one" type="revolute"><parent link="post"/><child link="a"/><origin xyz="1 1 1" rpy="0.3 0 1"/>'
        '<axis xyz="0 0 1"/><limit lower="0" upper="2" effort="1" velocity="1"/></joint>'
        '<joint name="two" type="revolute"><parent link="a"/><child link="b"/><origin xyz="6 0 0"/><axis xyz="0 0 1"/>'
        f'<limit lower="{math.radians(60)}" upper="{math.radians(120)}" effort="1" velocity="1"/></joint>'
        '<joint name="end" type="fixed"><parent link="b"/><child link="tip"/><origin xyz="3 0 0"/></joint></robot>'
    )
    outward, inward = of(clipped, limb(clipped), limb(clipped, "post", "tip")).limbs
    cosines = math.sqrt(6**2 + 3**2 + 2 * 6 * 3 * math.cos(math.radians(60)))
    assert outward.reach == pytest.approx(cosines, abs=1e-6)
    # Looked at from its tip the arm begins at joint two, and how far the post is from there is up to joint one.
    x, y, _ = [1, 1, 1] @ turned(0.3, 1.0)  # from the post to joint one, in the axes of joint one
    q = float(np.clip(math.atan2(y, x), 0, 2))
    assert inward.reach == pytest.approx(math.sqrt(3 + 36 + 12 * (x * math.cos(q) + y * math.sin(q))), abs=1e-6)
    assert told(outward) == {"effort use": "no link that moves has a mass", "payload": "no link that moves has a mass"}


def turned(roll, yaw):
    """Return the rotation of a joint's frame, rpy (roll, 0, yaw)."""
    c, s, cr, sr = math.cos(yaw), math.sin(yaw), math.cos(roll), math.sin(roll)
    return np.array([[c, -s * cr, s * sr], [s, c * cr, -c * sr], [0, sr, cr]])


def test_a_payload_of_the_horizontal_arm_is_what_its_shoulder_holds():
    (one,) = of(textbook("planar_2r_6_3")).limbs
    assert math.isinf(one.payload.value)  # its joints are upright: no weight loads them
    assert one.poses[0].values["effort_use"] == 0
    assert np.all(one.sweep.measures["effort_use"].maximum.value == 0)


def test_a_robot_without_joints_has_no_limbs_and_no_torques():
    found = profile(textbook("rigid_body"), Anatomy((), (Left("limbs", "nothing moves"),)))
    assert found.limbs == ()
    assert found.worst is None
    assert told(found)["limbs"] == "nothing moves"
    assert "no joint with one coordinate" in told(found)["worst gravity torques"]


# --- poses -----------------------------------------------------------------------------------------------------------


def state(name, group="g", **joints):
    inside = "".join(f'<joint name="{joint}" value="{value}"/>' for joint, value in joints.items())
    return f'<group_state name="{name}" group="{group}">{inside}</group_state>'


def test_states_that_set_a_joint_of_the_limb_are_its_poses(tmp_path):
    srdf = "".join(
        [
            state("home", left1=0.5, right1=1.0),
            state("right only", right2=0.5),
            state("outside", left2=2.5),
            state("mid", left1=0.1),
            state("gone", nobody=1),
            *(state(f"more{i}", left1=i / 10) for i in range(5)),
        ]
    )
    model = two_armed(srdf=srdf, folder=tmp_path)
    left, right = of(model, limb(model, "lefttool"), limb(model, "righttool")).limbs
    assert [pose.name for pose in left.poses] == [
        *("zero", "mid", "home", "outside", "state mid", "more0", "more1", "more2")
    ]
    assert [pose.inside for pose in left.poses] == [True, True, True, False, *[True] * 4]
    assert told(left)["states 'more3', 'more4'"] == "the first 6 states of the SRDF are shown"
    assert [pose.name for pose in right.poses] == ["zero", "mid", "home", "right only"]
    assert left.poses[2].at.by_joint()["right1"] == 1.0


def test_zero_and_mid_are_one_where_they_are_the_same_for_the_limb():
    (one,) = of(textbook("planar_2r")).limbs
    assert [pose.name for pose in one.poses] == ["zero"]


def test_sections_hold_the_other_joints_where_the_arm_is_not_singular(monkeypatch):
    held = []
    model = ks.load("example:panda")
    monkeypatch.setattr(limb_profiling, "sections", lambda _m, _l, q, name, **_: held.append((name, q)) or ())
    (one,) = of(model, limb(model, "panda_hand_tcp")).limbs
    assert held[0][0] == "default"  # the state, though mid would do
    assert told(one)["map of the reach"] == "no two joints move the tool over an area"


def test_a_straight_wrist_alone_is_bent_and_nothing_else():
    puma = textbook("puma560")
    (one,) = of(puma).limbs
    held, name = held_pose(puma, one.limb, one.sweep, one.poses)
    (bent,) = np.flatnonzero(held)  # the others are zero
    assert name == "zero, bent"
    assert puma.robot.position_names[bent] == "joint5"
    found = ks.manipulability(puma, one.limb.frame, held, relative_to=one.limb.base, length=one.sweep.length)
    assert found.blocks["full"].inverse_condition_number > one.sweep.near


def test_where_bending_is_not_enough_the_best_of_the_sweep_holds(monkeypatch):
    monkeypatch.setattr(holding, "_BENT", 0)
    puma = textbook("puma560")
    (one,) = of(puma).limbs
    held, name = held_pose(puma, one.limb, one.sweep, one.poses)
    assert name == "best of the sweep"
    assert np.array_equal(held, one.sweep.measures["minimum_singular_value"].maximum.configuration)


def test_limits_that_are_not_taken_as_they_stand_are_told():
    text = """<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
    <joint name="turn" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0.1 0"/><axis xyz="0 0 1"/>
      <limit lower="2" upper="-2" effort="1" velocity="1"/></joint>
    <joint name="slide" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="1 0 0"/>
      <limit lower="0.3" upper="0.3" effort="1" velocity="1"/></joint>
    <joint name="follow" type="revolute"><parent link="a"/><child link="d"/><axis xyz="0 0 1"/>
      <limit lower="10" upper="11" effort="1" velocity="1"/><mimic joint="turn"/></joint></robot>"""
    model = load_text(text)
    found = of(model, limb(model, "c"))
    (one,) = found.limbs
    assert told(found)["limits of 'turn'"] == "lower is above upper: read the other way round"
    assert told(found)["limits of followers of 'turn'"] == "they leave it no range: left out of account"
    assert told(one)["motion of 'slide'"] == "limits are one position: locked there"
    assert np.allclose(np.linalg.norm(one.positions - [0, 0.1, 0], axis=1), 0.3, atol=1e-12)
    assert one.reach == pytest.approx(0.3)


def test_what_takes_minutes_of_many_joints_is_left_out_and_the_rest_is_there(monkeypatch):
    monkeypatch.setattr(limb_profiling, "_SEARCHED", 3)
    monkeypatch.setattr(profiling, "_CLIMBED", 5)
    model = textbook("puma560")
    found = of(model)
    (one,) = found.limbs
    assert (one.families, one.sections, found.worst) == (None, (), None)
    assert told(one)["singular families"].endswith("this has 6")
    assert told(one)["map of the reach"].endswith("this has 6")
    assert told(found)["worst gravity torques"].endswith("this has 6")
    assert one.sweep is not None
    assert one.reach > 0


def test_links_of_hardly_any_length_overflow_nothing():
    axes = ("0 1 0", "1 0 0", "0 0 1", "0 1 0")  # warnings of NumPy are errors here
    text = "".join(
        f'<link name="l{i + 1}"/><joint name="j{i}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/>'
        f'<origin xyz="1e-300 0 0"/><axis xyz="{axis}"/><limit lower="-2" upper="2" effort="5" velocity="2"/></joint>'
        for i, axis in enumerate(axes)
    )
    model = load_text(f'<robot name="tiny"><link name="l0"/>{text}</robot>')
    (one,) = of(model, limb(model)).limbs
    assert one.families is not None


def test_payload_is_bounded_by_the_limbs_own_joints():
    body = BODY.format(0.8)
    arms = [
        ARM.format(s=s, y=y, body=body, effort=effort) for s, y, effort in (("left", 0.5, 20), ("right", -0.2, 0.01))
    ]
    weak = load_text(
        f'<robot name="weak"><link name="torso"/>{"".join(arms)}</robot>'
    )  # the right arm cannot hold itself
    left, right = of(weak, limb(weak, "lefttool"), limb(weak, "righttool")).limbs
    model = two_armed()
    (twin,) = of(model, limb(model, "lefttool")).limbs
    assert float(left.payload.value) == float(twin.payload.value) > 0
    assert np.isnan(float(right.payload.value))


# --- what cannot be --------------------------------------------------------------------------------------------------


def test_no_masses_no_efforts_no_limits_are_told_and_the_rest_goes_on():
    weightless = two_armed(mass=None)
    found = of(weightless, limb(weightless, "lefttool"), payload=1.0)
    (one,), reason = found.limbs, "no link that moves has a mass"
    assert told(found) == {"worst gravity torques": reason}
    assert told(one) == {"effort use": reason, "payload": reason, "worst torques with 1 kg": reason}
    assert "effort_use" not in one.sweep.measures
    assert set(one.poses[0].values) == set(DEFAULT)
    idle = two_armed(effort=0)
    (one,) = of(idle, limb(idle, "lefttool")).limbs
    assert told(one)["effort use of 'left1', 'left2', 'left3' and 1 more"] == "the file says 0"
    assert told(one)["payload"] == "no effort limits: the file says 0"
    assert one.payload is None
    upright = load_text(textbook("scara").loaded.source.data.decode().replace("effort=", "strength="))
    found = profile(upright, **FEW)
    assert told(found.limbs[0])["payload"].startswith("no effort limits: ")  # though no weight loads it
    assert [one.limb for one in found.limbs] == list(limbs(upright).limbs)
    assert repr(found) == "<RobotProfile of 'scara': 1 limb>"
    assert one.reach > 0
    negative = two_armed(mass=-1)
    found = of(negative, limb(negative, "lefttool"))
    assert "is -1 kg: below zero" in told(found)["worst gravity torques"]
    endless = load_text(
        '<robot name="s"><link name="base"/><link name="tip"/>'
        '<joint name="slide" type="prismatic"><parent link="base"/><child link="tip"/><axis xyz="1 0 0"/>'
        '<limit effort="1" velocity="1" lower="-1e308" upper="1e308"/></joint></robot>'
    )
    (one,) = of(endless).limbs
    assert one.reach is None
    assert "slides without a limit" in told(one)["reach"]


def test_a_floating_joint_on_the_way_is_refused_part_by_part():
    model = ks.load("textbook:planar_2r", floating_base=True)
    through, beyond = of(model, limb(model, "tool", "universe"), limb(model, "tool", "base")).limbs
    assert through.sweep is None
    assert (through.positions.shape, through.smallest.shape, through.poses) == ((0, 3), (0,), ())
    assert {WITHOUT_SWEEP, "singular families", "reach", "payload"} <= set(told(through))
    assert beyond.sweep is not None
    assert beyond.reach == pytest.approx(1.8)


def test_refusals_are_told_but_bugs_go_through(monkeypatch):
    def fail(error):
        def failing(*_, **__):
            raise error

        return failing

    monkeypatch.setattr(limb_profiling, "singular_find", fail(UsageError("not today", remedy="tomorrow")))
    (one,) = of(textbook("planar_2r")).limbs
    assert one.families is None
    assert told(one)["singular families"] == "not today"
    monkeypatch.setattr(limb_profiling, "singular_find", fail(ZeroDivisionError("a bug")))
    with pytest.raises(ZeroDivisionError):
        of(textbook("planar_2r"))


def nothing_is_silent(found):
    """Check that each part that is missing is told, and that no engines disagree."""
    assert all(one.agree is True for one in found.certificates.values())
    assert found.worst is not None or "worst gravity torques" in told(found)
    for one in found.limbs:
        missing = {
            WITHOUT_SWEEP: one.sweep,
            "reach": one.reach,
            "payload": one.payload,
            "singular families": one.families,
        }
        assert {name for name, part in missing.items() if part is None} <= set(told(one))
        assert one.sections or one.sweep is None or "map of the reach" in told(one)
        assert (
            one.sweep is None or "effort_use" in one.sweep.measures or any("effort use" in what for what in told(one))
        )


@pytest.mark.parametrize("seed", range(12))
def test_no_random_tree_is_too_odd(seed):
    model, draw = load_text(random_urdf(seed)), np.random.default_rng(seed)
    names = [link.name for link in model.robot.links]
    pairs = [draw.choice(names, 2) for _ in range(2)]
    chosen = [limb(model, str(a), str(b)) for a, b in pairs if model.robot.movable_path(str(b), str(a))]
    nothing_is_silent(profile(model, Anatomy(tuple(chosen), ()), samples=100, starts=10, payload=1.0))


REAL = ("ur5_robot", "talos_left_arm", "so100", "finger_edu", "double_pendulum", "iris", "hextilt_flying_arm_5", "solo")


@pytest.mark.parametrize("name", REAL)
def test_real_robots_have_a_profile(name):
    model = ks.load(f"example:{name}")
    found = profile(model, limbs(model), samples=2000, starts=50)
    nothing_is_silent(found)
    assert found.limbs or found.left


@pytest.mark.parametrize("name", ["tiago", "allegro_left_hand", "a1"])
def test_of_larger_robots_one_limb_is_like_the_others(name):
    model = ks.load(f"example:{name}")
    anatomy = limbs(model)
    nothing_is_silent(profile(model, Anatomy(anatomy.limbs[-2:], anatomy.left), samples=2000, starts=20))
