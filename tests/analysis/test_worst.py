"""Laws of the worst gravity torques: no sample exceeds them, they are inside limits, and known where geometry tells."""

from functools import cache

import numpy as np
import pytest

import kinetostat as ks
from trees import load_text, random_tree

G = 9.81
ROBOTS = (
    "example:panda",
    "example:so101",
    "example:ur5_robot",
    "textbook:anthropomorphic",
    "textbook:stanford",
    "textbook:helical",
)


@cache
def model_of(source):
    return ks.load(source)


@cache
def worst_of(source, samples=300):
    model = model_of(source)
    return ks.worst_torques(model, zero(model), samples=samples)


def zero(model):
    return ks.configuration(model, "zero").q


def columns(model, result):
    return [model.robot.velocity_slices[name].start for name in result.joints]


def chain(links, joints=""):
    """Return rods along x that turn about y, so that gravity is in their plane: (length, kg, low, high) each."""
    text = '<link name="l0"/>'
    for i, (length, mass, low, high) in enumerate(links):
        back = links[i - 1][0] if i else 0
        text += (
            f'<link name="l{i + 1}"><inertial><mass value="{mass}"/><origin xyz="{length / 2} 0 0"/>'
            '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>'
            f'<joint name="j{i + 1}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/>'
            f'<origin xyz="{back} 0 0"/><axis xyz="0 1 0"/>'
            f'<limit lower="{low}" upper="{high}" effort="50" velocity="1"/></joint>'
        )
    return load_text(f'<robot name="chain">{text}{joints}</robot>')


@pytest.mark.parametrize("source", ROBOTS)
def test_no_sample_exceeds_the_worst(source):
    model, result = model_of(source), worst_of(source)
    drawn = ks.random_configurations(model, 123, (20_000,))
    torques = model.engine.holding_torques(drawn, np.array([0, 0, -G]), ())
    largest = np.max(np.abs(torques[:, columns(model, result)]), axis=0)
    assert np.all(largest <= np.abs(result.torques) + 1e-9)


@pytest.mark.parametrize("source", ROBOTS)
def test_witnesses_are_inside_limits_and_have_the_torque(source):
    model, result = model_of(source), worst_of(source)
    assert result.certificate.agree
    at = ks.torque(model, result.witnesses, gravity=True)
    rows, taken = np.arange(len(result.joints)), columns(model, result)
    assert np.allclose(at.total[rows, taken], result.torques, rtol=0, atol=1e-12)
    assert np.allclose(at.utilisation[rows, taken], result.utilisation, rtol=0, atol=1e-12, equal_nan=True)
    for name in result.joints:
        joint, where = model.robot.joint_by_name[name], model.robot.position_slices[name].start
        low, high = joint.limit.range
        assert np.all(result.witnesses[:, where] >= low - 1e-12)
        assert np.all(result.witnesses[:, where] <= high + 1e-12)
    assert np.all(result.agreed >= 1)
    assert np.all(result.agreed <= result.starts)


def test_a_planar_2r_is_worst_stretched_and_level():
    model = model_of("textbook:planar_2r")
    result = ks.worst_torques(model, np.zeros(2), gravity=(0, -G, 0), samples=100)
    # Rods of 4 kg (1 m) and 2.4 kg (0.8 m), their centres halfway.
    assert np.allclose(np.abs(result.torques), [G * (4 * 0.5 + 2.4 * 1.4), G * 2.4 * 0.4], rtol=1e-9)
    first, second = result.witnesses
    assert np.allclose([np.sin(first[0]), np.sin(first[1])], 0, atol=1e-5)
    assert np.isclose(np.cos(first[1]), 1, atol=1e-9)
    assert np.isclose(abs(np.cos(second.sum())), 1, atol=1e-9)
    assert result.units == ("Nm", "Nm")
    assert np.allclose(result.utilisation, np.abs(result.torques) / [80, 30])


def test_the_payload_counts():
    result = ks.worst_torques(
        model_of("textbook:planar_2r"),
        np.zeros(2),
        gravity=(0, -G, 0),
        payload=ks.Payload(3, "tool", (0.2, 0, 0)),
        samples=100,
    )
    expected = [G * (4 * 0.5 + 2.4 * 1.4 + 3 * 2.0), G * (2.4 * 0.4 + 3 * 1.0)]
    assert np.allclose(np.abs(result.torques), expected, rtol=1e-9)


def test_limits_keep_the_arm_from_the_worst():
    """One rod, pitched down by 60 to 90 degrees: the lever is longest at 60, half the rod's."""
    model = chain([(1.0, 2.0, np.pi / 3, np.pi / 2)])
    result = ks.worst_torques(model, np.zeros(1), samples=50)
    assert np.isclose(abs(result.torques[0]), 2 * G * 0.5 * np.cos(np.pi / 3), rtol=1e-12)
    assert np.isclose(result.witnesses[0, 0], np.pi / 3, rtol=0, atol=1e-12)


def test_limits_of_effort_may_be_given():
    model = chain([(1.0, 2.0, -1, 1)])
    result = ks.worst_torques(model, np.zeros(1), limits={"j1": (-3, 100)}, samples=50)
    assert np.isclose(result.utilisation[0], abs(result.torques[0]) / (3 if result.torques[0] < 0 else 100))


def test_locked_joints_are_warned_of_and_stay():
    result = ks.worst_torques(chain([(1.0, 2.0, 0.5, 0.5), (1.0, 1.0, -2, 2)]), np.array([0.5, 0.0]), samples=50)
    (warning,) = result.warnings
    assert "'j1'" in warning
    assert "locked" in warning
    assert np.all(result.witnesses[:, 0] == 0.5)
    assert np.isclose(abs(result.torques[0]), G * (2 * 0.5 + 1) * np.cos(0.5) + G * 0.5, rtol=1e-9)  # j2 at -0.5


def test_a_slide_without_limits_is_warned_of():
    slide = (
        '<link name="s"><inertial><mass value="2"/><origin xyz="0 0 0"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link><joint name="slide" '
        'type="prismatic"><parent link="l1"/><child link="s"/><origin xyz="1 0 0"/><axis xyz="1 0 0"/>'
        '<limit effort="9" velocity="1" lower="-1e9" upper="1e9"/></joint>'
    )
    result = ks.worst_torques(chain([(1.0, 2.0, -2, 2)], slide), np.zeros(2), samples=50)
    assert any("'slide'" in warning and "1 m" in warning for warning in result.warnings)
    assert result.units == ("Nm", "N")
    assert np.isclose(abs(result.torques[0]), G * (2 * 0.5 + 2 * 2), rtol=1e-9)


def test_endless_turns_have_no_bounds():
    model = model_of("example:double_pendulum_continuous")
    result = ks.worst_torques(model, zero(model), samples=100)
    assert np.all(np.isfinite(result.torques))
    assert result.certificate.agree


@pytest.mark.parametrize("seed", [601, 603, 607])
def test_joints_with_several_coordinates_stay(seed):
    model = random_tree(seed, floating_base=True)
    q = ks.random_configurations(model, 1)
    if not any(joint.type.nq == 1 for joint in model.robot.independent):
        pytest.fail("choose another tree")
    result = ks.worst_torques(model, q, samples=20)
    for joint in model.robot.independent:
        if joint.type.nq > 1:
            where = model.robot.position_slices[joint.name]
            assert np.array_equal(result.witnesses[:, where], np.tile(q[where], (len(result.joints), 1)))
            assert joint.name not in result.joints


def test_a_seed_gives_the_same_and_more_samples_no_less():
    model = model_of("example:ur5_robot")
    one, same = (ks.worst_torques(model, zero(model), samples=60, seed=4) for _ in range(2))
    assert np.array_equal(one.torques, same.torques)
    assert np.array_equal(one.witnesses, same.witnesses)
    other = ks.worst_torques(model, zero(model), samples=60, seed=5)
    assert not np.array_equal(one.witnesses, other.witnesses)
    assert np.allclose(np.abs(one.torques), np.abs(other.torques), rtol=1e-5, atol=1e-9)


def test_progress_is_told():
    told = []
    model = model_of("textbook:planar_2r")
    ks.worst_torques(model, np.zeros(2), samples=5, progress=lambda what, share: told.append((what, share)))
    assert [share for _, share in told] == [0, 0.5]
    assert "joint1" in told[0][0]


@pytest.mark.parametrize(("words", "part"), [
    ({"samples": 0}, "samples"),
    ({"samples": 2_000_000}, "samples"),
    ({"gravity": (0, 1)}, "gravity"),
    ({"payload": ks.Payload(-1, "tool")}, "payload"),
    ({"limits": {"joint1": 0}}, "joint1"),
    ({"joints": []}, "one at least"),
    ({"joints": ["joint3"]}, "joint3"),
    ({"starts": 0}, "start"),
])  # fmt: skip
def test_what_cannot_be_is_refused(words, part):
    with pytest.raises(ks.UsageError, match=part):
        ks.worst_torques(model_of("textbook:planar_2r"), np.zeros(2), **words)


def test_robots_without_single_joints_and_batches_are_refused():
    with pytest.raises(ks.UsageError, match="worst torque"):
        ks.worst_torques(model_of("textbook:rigid_body"), zero(model_of("textbook:rigid_body")))
    with pytest.raises(ks.UsageError, match="one configuration"):
        ks.worst_torques(model_of("textbook:planar_2r"), np.zeros((2, 2)))


def test_some_joints_are_some_of_all():
    model = model_of("example:panda")
    every = worst_of("example:panda")
    some = ks.worst_torques(model, zero(model), samples=300, joints=["panda_joint4", "panda_joint2"])
    assert some.joints == ("panda_joint2", "panda_joint4")
    rows = [every.joints.index(name) for name in some.joints]
    assert np.allclose(some.torques, every.torques[rows], rtol=1e-9)
    assert np.allclose(some.utilisation, every.utilisation[rows], rtol=1e-9)


def test_what_is_given_to_look_at_is_a_start():
    """One poor sample, and the worst itself: the climb stays there."""
    model, every = model_of("example:panda"), worst_of("example:panda")
    row = every.joints.index("panda_joint2")
    asked = {"samples": 1, "starts": 1, "joints": ["panda_joint2"]}
    found = ks.worst_torques(model, zero(model), also=every.witnesses[row : row + 1], **asked)
    assert abs(found.torques[0]) >= abs(every.torques[row]) * (1 - 1e-12)


FOLLOWER = (
    '<link name="f"><inertial><mass value="4"/><origin xyz="0.5 0 0"/>'
    '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>'
    '<joint name="follows" type="revolute"><parent link="l1"/><child link="f"/><origin xyz="1 0 0"/><axis xyz="0 1 0"/>'
    '<limit lower="-9" upper="9" effort="50" velocity="1"/><mimic joint="j1" multiplier="1.5"/></joint>'
)


@pytest.mark.parametrize("limits", [(-3, 3), (0.4, 2), (1.2, 3)])
def test_a_joint_that_drives_a_screw_beyond_its_own_is_climbed_with_all_the_same(limits):
    """Its torque is a sum of two sinusoids of its position; compared with positions a thousandth apart."""
    model = chain([(1.0, 2.0, *limits)], FOLLOWER)
    result = ks.worst_torques(model, np.zeros(1), samples=50)
    each = model.engine.holding_torques(np.linspace(*limits, 4001)[:, None], np.array([0, 0, -G]), ())
    assert abs(result.torques[0]) >= np.max(np.abs(each)) * (1 - 1e-12)
    assert np.isclose(abs(result.torques[0]), np.max(np.abs(each)), rtol=1e-5)


@pytest.mark.parametrize("source", ["example:panda", "example:so101"])
def test_many_samples_are_looked_at_by_compiled_code_to_the_same_end(source, monkeypatch):
    model = model_of(source)
    asked = {"samples": 300, "payload": ks.Payload(2.0, model.robot.links[-1].name, (0.1, 0, 0.05))}
    by_engine = ks.worst_torques(model, zero(model), **asked)
    monkeypatch.setattr("kinetostat.analysis.worst_climb._COMPILED", 300)
    compiled = ks.worst_torques(model, zero(model), **asked)
    assert np.allclose(compiled.torques, by_engine.torques, rtol=1e-9, atol=1e-9)


def test_a_payload_on_the_ground_loads_no_joint():
    model = model_of("example:ur5_robot")
    asked = {"samples": 50, "joints": ["shoulder_lift_joint"]}
    on_ground = ks.worst_torques(model, zero(model), payload=ks.Payload(5.0, model.robot.root), **asked)
    assert np.allclose(on_ground.torques, ks.worst_torques(model, zero(model), **asked).torques, rtol=1e-9)


@pytest.mark.parametrize("source", ["example:romeo", "example:talos_left_arm"])
def test_the_worst_of_many_joints_is_found_from_other_samples_too(source):
    """Limits make many maxima: from eight starts, one of a joint of romeo was missed by a fifth."""
    model = model_of(source)
    one, other = (ks.worst_torques(model, zero(model), samples=2000, seed=seed) for seed in (0, 1))
    largest = np.max(np.abs(one.torques))
    assert np.allclose(np.abs(one.torques), np.abs(other.torques), rtol=5e-3, atol=1e-6 * largest)


def test_screws_without_end_are_taken_within_half_a_turn():
    """What a screw lifts may grow without end: the answer is of a range, and says so."""
    model = ks.load("textbook:modern_robotics_hhhh")
    found = ks.worst_torques(model, np.zeros(model.robot.nq))
    assert np.all(np.isfinite(found.torques))
    assert found.certificate.agree
    assert any("taken within half a turn" in warning for warning in found.warnings)


def test_a_level_slide_of_which_one_engine_sees_rounding_bears_nothing():
    """Pinocchio weighs what a turned joint carries to the last bit but one, the climb exactly: there is no ratio."""
    inertia = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
    body = f'<inertial><mass value="3"/><origin xyz="{{}}"/>{inertia}</inertial>'
    level = load_text(
        f'<robot name="level"><link name="base"/><link name="car">{body.format("0 0 0")}</link>'
        f'<link name="load">{body.format("-0.4 0.02 -1")}</link>'
        '<joint name="slide" type="prismatic"><parent link="base"/><child link="car"/><axis xyz="0 -1 0"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
        '<joint name="table" type="planar"><parent link="car"/><child link="load"/>'
        '<origin xyz="-0.7 -0.2 -0.6" rpy="-1.5708 6.283185307179586 -1.5707963267948966"/><axis xyz="0 0 -1"/></joint>'
        "</robot>"
    )
    found = ks.worst_torques(level, zero(level))
    assert found.joints == ("slide",)
    assert abs(found.torques[0]) < 1e-13
    assert found.certificate.agree
