"""Trajectories: laws of their rates and twists, what stands beside the engines' own answers, stretches and causes."""

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.trajectory import timeline as module
from kinetostat.analysis.trajectory.differences import accelerations, rates
from kinetostat.analysis.trajectory.extremes import extremes
from kinetostat.analysis.trajectory.spans import first_largest, runs
from kinetostat.analysis.trajectory.trajectory import trajectory
from trees import load_text, random_tree

ROBOTS = (
    ("example:ur5_robot", "tool0"),
    ("example:panda", "panda_hand"),
    ("textbook:stanford", None),
    ("textbook:helical", None),
    ("textbook:planar_1r", None),
)
# A planar joint, a continuous one with a follower, a slide; links that weigh.
MIXED = """<robot name="mixed">
  <link name="base"/>
  <link name="cart"><inertial><origin xyz="0.1 0.2 0"/><mass value="3"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0.3 0 0.1"/><mass value="2"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tip"><inertial><origin xyz="0 0 0.1"/><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="side"><inertial><origin xyz="0 0.4 0"/><mass value="1.5"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="drive" type="planar"><parent link="base"/><child link="cart"/><axis xyz="0 0 1"/></joint>
  <joint name="turn" type="continuous"><parent link="cart"/><child link="arm"/><origin rpy="1.2 0.3 0"/>
    <axis xyz="0 1 0"/><limit effort="20" velocity="2"/></joint>
  <joint name="slide" type="prismatic"><parent link="arm"/><child link="tip"/><origin xyz="0.5 0 0"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.4" effort="30" velocity="1"/></joint>
  <joint name="other" type="revolute"><parent link="arm"/><child link="side"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="5" velocity="1"/></joint>
</robot>"""


def smooth(model, count=60, seed=0, span=0.6):
    """Return configurations along a smooth way within limits, and uneven times."""
    generator = np.random.default_rng(seed)
    ends = ks.random_configurations(model, seed, 2)
    way = np.cumsum(generator.uniform(0.2, 1.0, count))
    share = np.sin(way / way[-1] * np.pi / 2)[:, None]
    return ends[0] + span * share * (ends[1] - ends[0]), 3 * way / way[-1]


@pytest.fixture(scope="module")
def planar():
    return ks.load("textbook:planar_2r")


@pytest.fixture(scope="module")
def ur5():
    return ks.load("example:ur5_robot")


# --- differences -----------------------------------------------------------------------------------------------------


def uneven(count, seed=0):
    return np.cumsum(np.random.default_rng(seed).uniform(0.01, 0.2, count)) - 1


def test_a_parabola_has_exact_differences_at_every_sample():
    time, a = uneven(40), np.array([[0.7, -2.0, 0.0]])
    q = 0.3 + 1.5 * time[:, None] + a * time[:, None] ** 2
    np.testing.assert_allclose(rates(time, q), 1.5 + 2 * a * time[:, None], atol=1e-11)
    np.testing.assert_allclose(accelerations(time, q), np.broadcast_to(2 * a, q.shape), atol=1e-9)


def test_rates_are_of_second_order_on_uneven_steps():
    def error(count):
        steps = 1 + 0.5 * np.sin(np.arange(count))
        time = np.cumsum(steps) / np.sum(steps) * 2
        return float(np.max(np.abs(rates(time, np.sin(3 * time)[:, None])[:, 0] - 3 * np.cos(3 * time))))

    assert error(200) / error(800) > 12  # 16 for a quarter of the step


def test_few_samples_have_the_rates_that_they_can_have(planar):
    time, q = np.array([0.0, 0.5]), np.array([[0.1, 0.2], [0.3, -0.2]])
    np.testing.assert_allclose(rates(time, q), [[0.4, -0.8]] * 2)
    assert np.all(np.isnan(accelerations(time, q)))
    alone = trajectory(planar, "tool", q[:1], time[:1])
    assert alone.rates is None
    assert alone.at.twist is None
    assert alone.speed_use is None


def test_runs_are_the_stretches_of_a_flag():
    generator = np.random.default_rng(2)
    for flags in (*(generator.random((50, 30)) < 0.5), np.zeros(5, bool), np.ones(5, bool), np.zeros(0, bool)):
        found = np.zeros(len(flags), dtype=bool)
        for first, last in runs(flags):
            assert not found[first - 1] or first == 0
            assert last + 1 == len(flags) or not flags[last + 1]
            found[first : last + 1] = True
        np.testing.assert_array_equal(found, flags)


def test_the_worst_of_a_plateau_is_its_start():
    values = 3.0 + 1e-13 * np.random.default_rng(3).normal(size=50)
    values[:7] = 2.9
    assert first_largest(values) == 7
    assert first_largest(-values) == 0
    assert first_largest(np.concatenate([[np.nan], 1e-17 * values, [5.0]])) == 51
    assert first_largest(-np.array([4.0, 1e-17, 2.0, 1e-18])) == 1
    assert first_largest(np.full(3, np.nan)) == 0
    steep = np.array([0.0, 1.0, 1.0 + 1e-6, 1.0])
    assert first_largest(steep) == 2


# --- laws of motion --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "frame"), ROBOTS)
def test_at_rest_nothing_moves(name, frame):
    model = ks.load(name)
    frame = frame or model.robot.default_tip()
    q = np.tile(ks.random_configurations(model, 3, ()), (9, 1))
    result = trajectory(model, frame, q, uneven(9))
    for still in (result.rates, result.accelerations, result.at.twist, result.speed_use):
        assert np.all(still[np.isfinite(still)] == 0)
    assert result.certificate.agree


def test_uniform_rotation_has_the_twist_of_a_wheel():
    model, speed = ks.load("textbook:planar_1r"), 0.8
    time = uneven(50)
    result = trajectory(model, model.robot.default_tip(), speed * time[:, None], time, relative_to=None)
    radius = result.at.position
    np.testing.assert_allclose(result.at.twist[:, 3:], np.tile([0, 0, speed], (50, 1)), atol=1e-13)
    np.testing.assert_allclose(result.at.twist[:, :3], np.cross([0, 0, speed], radius), atol=1e-13)
    np.testing.assert_allclose(result.tool_speed, speed * np.linalg.norm(radius, axis=1), atol=1e-13)
    np.testing.assert_allclose(result.turning_speed, speed, atol=1e-13)


@pytest.mark.parametrize(("name", "frame"), ROBOTS)
def test_backwards_and_slower(name, frame):
    model = ks.load(name)
    frame = frame or model.robot.default_tip()
    q, time = smooth(model)
    there = trajectory(model, frame, q, time)
    back = trajectory(model, frame, q[::-1], -time[::-1])
    slow = trajectory(model, frame, q, 2 * time)
    scale = float(np.max(np.abs(there.at.twist))) + 1
    np.testing.assert_allclose(back.at.twist[::-1], -there.at.twist, atol=1e-12 * scale)
    np.testing.assert_allclose(back.accelerations[::-1], there.accelerations, atol=1e-9 * scale)
    np.testing.assert_allclose(2 * slow.at.twist, there.at.twist, atol=1e-12 * scale)
    np.testing.assert_allclose(4 * slow.accelerations, there.accelerations, atol=1e-9 * scale)


@pytest.mark.parametrize("reference", ["aligned", "local"])
def test_the_twist_is_the_motion_of_the_pose(ur5, reference):
    q, time = smooth(ur5, 4001)
    point = (0.1, -0.2, 0.3)
    result = trajectory(ur5, "tool0", q, time, reference=reference, point=point)
    moved = rates(time, result.at.position)
    if reference == "local":
        turned = ks.fk(ur5, "tool0", q).matrix[:, :3, :3]
        moved = np.einsum("kij,ki->kj", turned, moved)
    np.testing.assert_allclose(result.at.twist[2:-2, :3], moved[2:-2], atol=2e-5)


# --- beside the engines' own answers ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "frame"), ROBOTS)
def test_every_sample_is_what_the_single_questions_answer(name, frame):
    model = ks.load(name)
    frame = frame or model.robot.default_tip()
    q, time = smooth(model, 25)
    payload = ks.Payload(1.5, frame, (0.0, 0.1, 0.2))
    result = trajectory(model, frame, q, time, axes="xyz", payload=payload, length="none")
    block = ks.manipulability(model, frame, q, axes="xyz").blocks["task"]
    rank = result.mechanism.generic_rank
    np.testing.assert_allclose(result.minimum_singular_value, block.singular_values[:, rank - 1], atol=1e-12)
    np.testing.assert_allclose(result.yoshikawa, np.prod(block.singular_values[:, :rank], axis=-1), atol=1e-12)
    placed = ks.fk(model, frame, q)
    np.testing.assert_allclose(result.at.position, placed.position, atol=1e-12)
    np.testing.assert_allclose(result.at.quaternion, placed.quaternion_xyzw, atol=1e-12)
    torques = ks.torque(model, q, gravity=True, payload=payload)
    columns = [torques.columns.index(name) for name in result.columns]
    np.testing.assert_allclose(result.at.torque, torques.total[:, columns], atol=1e-10)
    np.testing.assert_allclose(result.effort_use, torques.utilisation[:, columns], atol=1e-10)
    assert result.certificate.engines[:2] == ("pinocchio", "screw")
    assert result.certificate.agree
    assert result.computed == 25


@pytest.mark.parametrize(
    ("name", "frame", "axes"),
    [
        ("example:ur5_robot", "tool0", None),
        ("example:panda", "panda_hand", "xyz"),
        ("textbook:stanford", "tool", "xyz"),
        ("textbook:stanford", "tool", None),
    ],
)
def test_the_length_is_that_of_a_sweep_and_so_are_the_numbers(name, frame, axes):
    model = ks.load(name)
    q, _ = smooth(model, 12)
    result = trajectory(model, frame, q, axes=axes)
    swept = ks.sweep(model, frame, q[0], configurations=q[:1], axes=axes, length="auto")
    assert swept.length == result.length
    assert (result.length is None) == (name == "example:panda")
    smallest = swept.measures["minimum_singular_value"]
    assert smallest.minimum.value == pytest.approx(result.minimum_singular_value[0], rel=1e-9)
    assert smallest.unit == result.unit


def test_many_samples_are_those_of_few(ur5, monkeypatch):
    monkeypatch.setattr(module, "_CHUNK", 700)
    q, time = smooth(ur5, 9000)
    many = trajectory(ur5, "tool0", q, time)
    few = trajectory(ur5, "tool0", q[:3000], time[:3000])
    assert many.certificate.agree
    assert 2000 <= many.computed < 2200
    for name in ("position", "quaternion", "singular_values", "torque", "limit_distance"):
        np.testing.assert_allclose(getattr(many.at, name)[:3000], getattr(few.at, name), atol=1e-12)
    np.testing.assert_allclose(many.at.twist[:2999], few.at.twist[:2999], atol=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_random_trees_agree(seed):
    kinds = ("revolute", "continuous", "prismatic", "fixed", "planar", "screw")
    trees = (random_tree(100 * seed + more, kinds=kinds) for more in range(100))
    moving = (
        (m, [link.name for link in m.robot.links if m.robot.movable_path(m.robot.root, link.name)]) for m in trees
    )
    model, tips = next((m, tips) for m, tips in moving if tips)
    q, time = smooth(model, 20, seed)
    result = trajectory(model, tips[-1], q, time, gravity=(1, -2, 3))
    assert result.certificate.agree
    torques = ks.torque(model, q, gravity=(1, -2, 3)).total
    single = [i for i, joint in enumerate(result.joints.joints) if joint.type.nq == 1]
    columns = [model.robot.velocity_names.index(result.columns[i]) for i in single]
    np.testing.assert_allclose(result.at.torque[:, single], torques[:, columns], rtol=1e-9, atol=1e-9)


def test_joints_beside_the_chain_weigh_where_they_are():
    model = load_text(MIXED)
    q, time = smooth(model, 30, seed=4)
    result = trajectory(model, "tip", q, time)
    assert result.columns == ("drive.x", "drive.y", "drive.theta", "turn", "slide", "other")
    assert result.certificate.agree
    torques = ks.torque(model, q, gravity=True).total
    np.testing.assert_allclose(result.at.torque[:, 3:], torques[:, 3:], atol=1e-11)
    held = trajectory(model, "tip", np.where(np.arange(6) == 5, q[0], q), time)
    assert held.columns == result.columns[:-1]
    assert not np.allclose(held.at.torque[5:, 3], result.at.torque[5:, 3], atol=1e-3)


def test_planar_joints_have_the_twist_of_their_positions():
    model = load_text(MIXED)
    time = np.linspace(0, 1, 400)
    q = np.zeros((400, 6))
    q[:, 0], q[:, 1], q[:, 2] = 0.3 * time, 0.5 * time, 2 * time
    result = trajectory(model, "cart", q, time)
    np.testing.assert_allclose(result.at.twist, np.tile([0.3, 0.5, 0, 0, 0, 2], (400, 1)), atol=1e-10)


def test_a_base_that_floats_and_does_not_move_is_no_obstacle():
    model = ks.load("textbook:planar_2r", floating_base=True)
    q = np.tile(ks.configuration(model, "zero").q, (5, 1))
    q[:, 7:] = np.linspace(0.2, 0.5, 5)[:, None]
    result = trajectory(model, "tool", q, relative_to="base")
    assert result.columns == ("joint1", "joint2")
    assert result.certificate.agree
    q[:, 0] = np.arange(5)
    with pytest.raises(ks.UsageError, match="root_joint"):
        trajectory(model, "tool", q, relative_to="base")


def test_without_a_cross_check_nothing_is_compared():
    model = ks.load("textbook:planar_2r", crosscheck=False)
    result = trajectory(model, "tool", np.array([[0.1, 0.2], [0.2, 0.3]]))
    assert result.computed == 0
    assert result.certificate.max_difference is None


# --- near singular ---------------------------------------------------------------------------------------------------


def straight_through(count=401):
    time = np.linspace(0, 2, count)
    return np.stack([0.3 * time, 1 - time], axis=1), time


def test_the_stretched_arm_is_found_with_its_cause(planar):
    q, time = straight_through()
    result = trajectory(planar, "tool", q, time)
    (span,) = result.spans
    assert time[span.worst] == pytest.approx(1.0)
    assert time[span.worst] - time[span.first] == pytest.approx(time[span.last] - time[span.worst], abs=1e-9)
    assert span.cause.name == "elbow"
    assert [condition.positions for condition in span.cause.conditions] == [{"joint2": 0.0}]
    assert span.distance == 0.0
    ratio = result.inverse_condition_number
    assert ratio[span.first] < 0.01 <= ratio[span.first - 1]
    assert ratio[span.last] < 0.01 <= ratio[span.last + 1]
    assert not np.all(np.isfinite(span.needed))


def test_a_wider_threshold_holds_the_narrower_stretch(ur5):
    q, time = smooth(ur5, 300, seed=8, span=1.0)
    wide, narrow = (trajectory(ur5, "tool0", q, time, near=near) for near in (0.05, 0.02))
    covered = np.zeros(300, dtype=bool)
    for span in wide.spans:
        covered[span.first : span.last + 1] = True
    for span in narrow.spans:
        assert np.all(covered[span.first : span.last + 1])
    np.testing.assert_array_equal(covered, wide.inverse_condition_number < 0.05)


@pytest.mark.parametrize(
    ("joint", "name"), [("elbow_joint", "elbow"), ("wrist_2_joint", "wrist")], ids=["elbow", "wrist"]
)
def test_causes_of_a_real_arm(ur5, joint, name):
    q = np.tile(ks.configuration(ur5, [0.3, -1.1, 1.2, 0.4, 1.3, 0.2]).q, (81, 1))
    q[:, ur5.robot.position_names.index(joint)] = np.linspace(-0.4, 0.405, 81)
    (span,) = trajectory(ur5, "tool0", q).spans
    assert span.cause.name == name
    assert {joint: pytest.approx(0.0, abs=1e-9)} in [condition.positions for condition in span.cause.conditions]
    assert 0 < span.distance < 0.01


def test_the_rates_that_are_needed_give_the_speed_the_hardest_way(ur5, planar):
    q = np.tile(ks.configuration(ur5, [0.3, -1.1, 0.01, 0.4, 1.3, 0.2]).q, (4, 1))
    q[:, 0] += 0.01 * np.arange(4)
    time = np.arange(4) / 10
    moving = trajectory(ur5, "tool0", q, time, axes="xyz", near=0.2)
    (span,) = moving.spans
    assert span.speed == np.max(moving.tool_speed) > 0
    matrix = ks.jacobian(ur5, "tool0", q[span.worst]).matrix[:3]
    given = matrix @ span.needed
    assert np.linalg.norm(given) == pytest.approx(span.speed, rel=1e-9)
    generator = np.random.default_rng(0)
    for way in generator.normal(size=(50, 3)):  # no other direction costs more
        cost = np.linalg.pinv(matrix) @ (way / np.linalg.norm(way)) * span.speed
        assert np.linalg.norm(cost) <= np.linalg.norm(span.needed) * (1 + 1e-9)
    mixed = trajectory(ur5, "tool0", q, time, length=0.5, near=0.2).spans[0]
    twist = ks.jacobian(ur5, "tool0", q[mixed.worst]).matrix @ mixed.needed
    assert np.linalg.norm(twist * [1, 1, 1, 0.5, 0.5, 0.5]) == pytest.approx(mixed.speed, rel=1e-9)
    for untimed in trajectory(ur5, "tool0", q, axes="xyz", near=0.2).spans:
        assert untimed.speed is None
        assert untimed.needed is None
    still = trajectory(ur5, "tool0", np.tile(q[0], (4, 1)), time, axes="xyz", near=0.2).spans[0]
    assert still.speed == 0
    assert not np.any(still.needed)


def test_only_the_deepest_of_very_many_stretches_have_causes(planar):
    time = np.linspace(0, 30, 3001)
    q = np.stack([np.zeros(3001), 0.4 * np.sin(2 * np.pi * time) * (1 + time / 30)], axis=1)
    result = trajectory(planar, "tool", q, time)
    sought = [span for span in result.spans if span.sought]
    assert len(result.spans) > 50
    assert len(sought) == 20
    assert max(s.inverse_condition_number for s in sought) <= min(
        s.inverse_condition_number for s in result.spans if not s.sought
    )
    assert all(span.cause is None for span in result.spans if not span.sought)


# --- limits ----------------------------------------------------------------------------------------------------------


def test_a_jump_is_too_fast_and_only_with_time(planar):
    time = np.arange(20) * 0.01
    q = np.tile([0.1, 0.5], (20, 1))
    q[10:, 1] += 0.2  # 20 rad/s for one step
    found = trajectory(planar, "tool", q, time).violations
    assert [(v.joint, v.kind, v.first, v.last, v.worst) for v in found] == [("joint2", "velocity", 9, 10, 10)]
    assert found[0].value == pytest.approx(20.0)
    assert found[0].limit == 3.0
    assert found[0].excess == pytest.approx(17.0)
    assert trajectory(planar, "tool", q).violations == ()
    assert trajectory(planar, "tool", q, time * 10).violations == ()


@pytest.mark.parametrize("sign", [1, -1])
def test_beyond_a_position_limit(planar, sign):
    q = np.zeros((50, 2))
    q[:, 0] = sign * (np.pi + 0.1 * np.sin(np.linspace(-1, 4, 50)))
    (found,) = trajectory(planar, "tool", q).violations
    outside = np.flatnonzero(np.abs(q[:, 0]) > np.pi)
    assert (found.joint, found.kind) == ("joint1", "position")
    assert (found.first, found.last) == (outside[0], outside[-1])
    assert found.worst == np.argmax(np.abs(q[:, 0]))
    assert found.limit == pytest.approx(sign * np.pi)
    assert found.excess == pytest.approx(np.max(np.abs(q[:, 0])) - np.pi)


def test_beyond_an_effort_limit_by_a_payload(planar):
    q = np.stack([np.linspace(-1.5, 1.5, 60), np.zeros(60)], axis=1)
    loaded = {"gravity": (0, -9.81, 0), "payload": ks.Payload(5.0, "tool")}
    result = trajectory(planar, "tool", q, **loaded)
    exceeded = result.effort_use > 1
    for joint in range(2):
        spans = [(v.first, v.last) for v in result.violations if v.joint == f"joint{joint + 1}"]
        assert spans == runs(exceeded[:, joint])
    assert exceeded[30, 0]
    assert trajectory(planar, "tool", q, **loaded, limits={"joint1": 500, "joint2": 500}).violations == ()
    unloaded = trajectory(planar, "tool", q, gravity=(0, 0, 0))
    assert unloaded.at.torque is None
    assert unloaded.effort_use is None


def test_continuous_joints_go_on_through_the_leap():
    model = load_text(MIXED)
    time = np.linspace(0, 10, 500)
    q = np.zeros((500, 6))
    q[:, 3] = 1.5 * time
    whole = trajectory(model, "tip", q, time)
    q[:, 3] = np.remainder(q[:, 3] + np.pi, 2 * np.pi) - np.pi
    wrapped = trajectory(model, "tip", q, time)
    assert wrapped.unwound == ("turn",)
    assert whole.unwound == ()
    assert wrapped.violations == ()
    np.testing.assert_allclose(wrapped.at.twist, whole.at.twist, atol=1e-9)


def test_followers_limit_their_leader():
    text = MIXED.replace(
        '<joint name="other" type="revolute">',
        '<joint name="other" type="revolute"><mimic joint="slide" multiplier="4"/>',
    )
    model = load_text(text)
    q = np.zeros((11, 5))
    q[:, 4] = np.linspace(0, 0.3, 11)
    result = trajectory(model, "tip", q, np.linspace(0, 1, 11))
    assert result.speed_limits[result.columns.index("slide")] == pytest.approx(0.25)
    assert ("slide", "velocity") in [(v.joint, v.kind) for v in result.violations]


# --- extremes, refusals ----------------------------------------------------------------------------------------------


def test_extremes_are_where_they_are_said_to_be(ur5):
    q, time = smooth(ur5, 80, seed=5)
    result = trajectory(ur5, "tool0", q, time)
    found = {one.measure: one for one in extremes(result)}
    assert set(found) == {
        "yoshikawa",
        "minimum_singular_value",
        "inverse_condition_number",
        "limit_distance",
        "tool_speed",
        "turning_speed",
        "speed_use",
        "effort_use",
    }
    for measure in ("yoshikawa", "minimum_singular_value", "inverse_condition_number", "tool_speed"):
        values = getattr(result, measure)
        assert values[found[measure].sample] == found[measure].value
        assert found[measure].value == (np.max(values) if found[measure].largest else np.min(values))
    near, (lower, upper) = found["limit_distance"], result.joints.stated_limits
    room = np.minimum(result.q - lower, upper - result.q) / (upper - lower) * 2
    at = np.unravel_index(np.argmin(room), room.shape)
    assert (near.sample, near.joint) == (at[0], result.columns[at[1]])
    assert near.value == pytest.approx(room[at])
    effort = found["effort_use"]
    joint = result.columns.index(effort.joint)
    assert result.effort_use[effort.sample, joint] == effort.value == np.max(result.effort_use)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"near": 0.0}, "threshold"),
        ({"near": 1.0}, "threshold"),
        ({"near": float("nan")}, "threshold"),
        ({"length": -1.0}, "length"),
        ({"length": "long"}, "length"),
        ({"time": np.array([0.0, 1.0, 1.0])}, "time"),
        ({"time": np.array([0.0, 1.0])}, "time"),
        ({"time": np.array([0.0, 1.0, np.nan])}, "time"),
        ({"time": np.array([0.0, 1e-200, 2e-200])}, "unit of time"),
        ({"axes": "q"}, "axis"),
        ({"reference": "world"}, "reference"),
        ({"q": np.zeros((0, 2))}, "sample"),
        ({"q": np.zeros(2)}, "sample"),
        ({"q": np.zeros((3, 3))}, "shape"),
        ({"q": np.full((3, 2), np.inf)}, "finite"),
        ({"frame": "tol"}, "tool"),
        ({"limits": {"elbow": 3}}, "elbow"),
    ],
    ids=str,
)
def test_refusals(planar, changed, said):
    asked = {"frame": "tool", "q": np.array([[0.1, 0.2], [0.3, 0.1], [0.5, 0.0]]), **changed}
    with pytest.raises(ks.UsageError, match=said):
        trajectory(planar, **asked)


def test_a_short_repr(planar):
    q, time = straight_through(50)
    assert repr(trajectory(planar, "tool", q, time)) == (
        "<Trajectory of 'tool': 50 samples, 1 spans near singular, 0 violations>"
    )
