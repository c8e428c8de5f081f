"""Laws of inverse kinematics: fk(ik(T)) = T on real arms and random trees; limits, reach, singular targets, steps."""

from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import kinetostat as ks
from kinetostat.analysis.coordinates import coordinates
from kinetostat.analysis.inverse.aim import Aim
from kinetostat.analysis.task import Task
from kinetostat.urdf.description import JointType
from kinetostat.urdf.files import example_robots
from textbook_support import assert_same, textbook, turn_about
from trees import load_text, random_tree

KINDS = ("revolute", "continuous", "prismatic", "screw", "planar", "fixed")
UR5 = ("ur5_robot", "tool0")
SIX = ("damped", {}), ("newton", {"method": "newton"}), ("rates", {"method": "pseudo-inverse"})


@cache
def example(name):
    return ks.load(f"example:{name}")


@cache
def tree(seed, kinds=KINDS):
    return random_tree(seed, kinds=kinds, most=9)


@cache
def single_arms():
    """Return (robot, tip) of the robots at hand: one for each path of 3 to 7 joints with one coordinate each."""
    found = {}
    for name in sorted({str(path): name for name, path in example_robots().items()}.values()):
        try:
            robot = example(name).robot
        except ks.RobotError:
            continue
        inner = {joint.parent for joint in robot.joints}
        for link in reversed(robot.links):
            try:
                path = () if link.name in inner else robot.moving_joints(robot.root, link.name)
            except ks.UsageError:
                continue
            if 3 <= len(path) <= 7 and all(joint.type.nq == 1 for joint in path):
                # Legs and arms of a kind are one robot's; two of each will do.
                found.setdefault((name, len(path)), link.name)
    return [(name, tip) for (name, _), tip in found.items()]


def shifted_by(placement, point):
    """Return the placement of a point of a frame."""
    moved = np.array(placement)
    moved[..., :3, 3] += moved[..., :3, :3] @ np.asarray(point, dtype=float)
    return moved


def gap(model, found, *, rows=range(6), local=False):
    """Return how far the tool is from its pose by each engine alone, in rows that count, written out with SciPy."""
    gaps = []
    for engine in (model.engine, model.witness):
        here = shifted_by(engine.placement(found.q, found.frame, found.relative_to), found.point)
        target = np.broadcast_to(found.target, here.shape)
        turn = target[..., :3, :3] @ np.swapaxes(here[..., :3, :3], -1, -2)
        vector = Rotation.from_matrix(turn.reshape(-1, 3, 3)).as_rotvec().reshape(*here.shape[:-2], 3)
        parts = [target[..., :3, 3] - here[..., :3, 3], vector]
        if local:
            parts = [(np.swapaxes(here[..., :3, :3], -1, -2) @ part[..., None])[..., 0] for part in parts]
        gaps.append(np.concatenate(parts, -1)[..., list(rows)])
    return np.abs(np.array(gaps))


def assert_found(model, found, atol=1e-8, **rows):
    assert found.certificate.engines == ("pinocchio", "screw")
    assert found.certificate.agree is True
    assert np.all(found.converged), found
    assert gap(model, found, **rows).max() < atol * max(1.0, model.robot.reach)


def assert_inside(model, found, path=None):
    """The file's limits hold, but for the rounding of a limit that was typed; other joints stay where they were."""
    assert np.all(found.inside_limits)
    robot = model.robot
    for joint in robot.independent if path is None else path:
        if joint.name in robot.followers or joint.type.nq != 1:
            continue
        position = found.q[..., robot.position_slices[joint.name]]
        assert np.all(position >= joint.limit.range[0] - 2e-5), joint.name
        assert np.all(position <= joint.limit.range[1] + 2e-5), joint.name


# --- fk(ik(T)) = T -----------------------------------------------------------------------------------------------


def test_there_are_many_arms():
    assert len(single_arms()) > 40


def test_every_arm_of_real_robots_comes_back_to_its_poses():
    for name, tip in single_arms():
        model = example(name)
        target = ks.fk(model, tip, ks.random_configurations(model, 1, 5)).matrix
        start = ks.random_configurations(model, 2, 5)
        found = ks.ik(model, tip, target, start)
        assert_found(model, found)
        assert_inside(model, found, model.robot.moving_joints(model.robot.root, tip))
        others = [i for i, same in enumerate(np.all(found.q == start, axis=0)) if same]
        moving = {joint.name for joint in model.robot.moving_joints(model.robot.root, tip)}
        still = [joint for joint in model.robot.independent if joint.name not in moving]
        for joint in still:
            where = model.robot.position_slices[joint.name]
            assert set(range(*where.indices(model.robot.nq))) <= set(others), (name, joint.name)


def question(seed, kinds=KINDS):
    """Return what is asked of a random tree: model, frame, observer, point, poses that are reachable, and starts."""
    model, generator = tree(seed, kinds), np.random.default_rng(seed)
    names = [link.name for link in model.robot.links]
    frame, observer = (names[i] for i in generator.integers(len(names), size=2))
    point = generator.uniform(-0.3, 0.3, 3)
    q, start = (ks.random_configurations(model, seed + i, 4) for i in (0, 1000))
    target = shifted_by(ks.fk(model, frame, q, relative_to=observer).matrix, point)
    return model, frame, observer, point, target, start


@cache
def askable(count):
    """Return seeds of random trees with a frame that something moves, and every kind of joint on the path."""
    found, kinds, mimics = [], set(), 0
    for seed in range(300):
        model, frame, observer, *_ = question(seed)
        try:
            path = model.robot.moving_joints(observer, frame)
        except ks.UsageError:
            continue
        found.append(seed)
        kinds |= {joint.type for joint in path}
        mimics += any(law.joint in {joint.name for joint in path} for law in model.robot.followers.values())
        if len(found) == count:
            break
    assert kinds >= {JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC, JointType.SCREW, JointType.PLANAR}
    assert mimics > 5
    return found


@pytest.mark.parametrize("reference", ["aligned", "local"])
def test_random_trees_come_back_to_their_poses(reference):
    for seed in askable(60):
        model, frame, observer, point, target, start = question(seed)
        found = ks.ik(model, frame, target, start, relative_to=observer, point=point, reference=reference)
        assert found.local is (reference == "local")
        assert_found(model, found)
        assert np.all(found.inside_limits)


@pytest.mark.parametrize("axes", ["x", "rz", "y rx", "xyz", "rx ry", "x y rz", "xyz rx ry"])
@pytest.mark.parametrize("reference", ["aligned", "local"])
def test_rows_that_do_not_count_are_free(axes, reference):
    rows = Task.named(axes).rows
    for seed in askable(12):
        model, frame, observer, point, target, start = question(seed)
        asked = {"relative_to": observer, "point": point, "axes": axes, "reference": reference}
        # A planar joint tilted by 1e-3 rad hardly turns the tool about x: that takes many tries.
        found = ks.ik(model, frame, target, start, tries=2000, **asked)
        assert found.task.rows == rows
        assert_found(model, found, rows=rows, local=reference == "local")


def test_local_rows_are_those_of_the_tool():
    """A drill may turn about its own axis: five rows bring its point and its axis there, whatever the start."""
    model = example("ur5_robot")
    target = ks.fk(model, "tool0", ks.random_configurations(model, 3, 20)).matrix
    found = ks.ik(model, "tool0", target, ks.random_configurations(model, 4, 20), axes="xyz rx ry", reference="local")
    assert np.all(found.converged)
    here = ks.fk(model, "tool0", found.q).matrix
    assert_same(here[:, :3, 3], target[:, :3, 3], atol=1e-8)
    assert_same(here[:, :3, 2], target[:, :3, 2], atol=1e-8)
    assert np.max(np.linalg.norm(here[:, :3, 0] - target[:, :3, 0], axis=-1)) > 0.5


def test_a_position_alone_needs_no_rotation():
    model = example("panda")
    target = ks.fk(model, "panda_hand", ks.random_configurations(model, 3)).matrix
    found = ks.ik(model, "panda_hand", target[:3, 3], ks.configuration(model, "mid").q)
    assert found.task.row_names == ("vx", "vy", "vz")
    assert_same(ks.fk(model, "panda_hand", found.q).matrix[:3, 3], target[:3, 3], atol=1e-9)


def test_the_residuals_are_the_rows_that_count():
    model, q = textbook("planar_3r"), np.array([0.3, 0.5, -0.2])
    target = ks.fk(model, "tool", q).matrix
    for axes, linear, angular in (("x", 1, 0), ("rz", 0, 1), ("y rz", 1, 1)):
        found = ks.ik(model, "tool", target, np.zeros(3), axes=axes, tries=1)
        assert (len(found.task.linear), len(found.task.angular)) == (linear, angular)
        both = gap(model, found)[0]
        assert found.position_residual == pytest.approx(np.linalg.norm(both[list(found.task.linear)]), abs=1e-15)
        assert found.rotation_residual == pytest.approx(np.linalg.norm(both[list(found.task.angular)]), abs=1e-15)


# --- the aim -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("reference", ["aligned", "local"])
def test_the_slope_is_the_derivative_of_the_error_at_the_target(reference):
    step, weights = 2e-3, np.array([-1, 9, -45, 45, -9, 1]) / 60  # six-point central differences
    for seed in askable(25):
        model, frame, observer, point, *_ = question(seed)
        joints = coordinates(model, frame, observer, point)
        aim = Aim.of(joints, Task.named("xyz rxyz"), local=reference == "local")
        q = joints.draw(np.random.default_rng(seed), ())
        _, target = joints.chain.columns(q[None])
        _, slope = aim.linear(q[None], target)
        for column, unit in enumerate(np.eye(len(q)) * aim.units):
            path = q + np.outer([-3, -2, -1, 1, 2, 3], unit) * step
            change = weights @ aim.error(path, target[0]) / step
            assert_same(slope[0, :, column], -change, atol=2e-9 * model.robot.largest_multiplier**7)


def test_the_chain_is_the_engines():
    """The placement that descents see is Pinocchio's, tool point, observer, followers and offsets included."""
    for seed in askable(25):
        model, frame, observer, point, *_ = question(seed)
        joints = coordinates(model, frame, observer, point)
        q = joints.draw(np.random.default_rng(seed), (5,))
        whole = joints.configuration(q, ks.configuration(model, "zero").q)
        _, placement = joints.chain.columns(q)
        expected = shifted_by(model.engine.placement(whole, frame, observer), point)
        assert_same(placement, expected, atol=1e-11 * max(1, model.robot.reach))


# --- limits ------------------------------------------------------------------------------------------------------


def chain(*joints, ends=""):
    """Return a planar chain of links of 1 m; each joint is (type, lower, upper) or (type,), and more of its text."""
    text = ['<link name="l0"/>']
    for i, (kind, *limits) in enumerate(joints):
        more = limits.pop() if limits and isinstance(limits[-1], str) else ""
        bound = f'<limit lower="{limits[0]!r}" upper="{limits[1]!r}" effort="1" velocity="1"/>' if limits else ""
        axis = "1 0 0" if kind == "prismatic" else "0 0 1"
        text.append(
            f'<link name="l{i + 1}"/><joint name="j{i}" type="{kind}"><parent link="l{i}"/><child link="l{i + 1}"/>'
            f'<origin xyz="{int(i > 0)} 0 0"/><axis xyz="{axis}"/>{bound}{more}</joint>'
        )
    last = len(joints)
    text.append(
        f'<link name="tip"/><joint name="end" type="fixed"><parent link="l{last}"/><child link="tip"/>'
        '<origin xyz="1 0 0"/></joint>'
    )
    return load_text(f'<robot name="chain">{"".join(text)}{ends}</robot>')


HALF = ("revolute", -3.0, 3.0)


def test_of_two_elbows_the_one_inside_limits_is_found():
    """From wherever it starts, also outside; the other elbow is nearer."""
    model = chain(HALF, ("revolute", 0.2, 2.5))
    target = ks.fk(model, "tip", np.array([0.4, 1.0])).matrix[:3, 3]
    for start in ([0.0, 0.0], [1.3, -1.0], [1.4, -1.0], [0.0, 9.0], [-3.0, 2.5]):
        found = ks.ik(model, "tip", target, np.array(start))
        assert_found(model, found, rows=(0, 1, 2))
        assert_same(found.q, np.array([0.4, 1.0]), atol=1e-8)


def test_a_pose_that_limits_alone_forbid_is_told_from_one_that_is_reached():
    model = chain(HALF, ("revolute", 0.2, 2.5))
    inside, outside = (ks.fk(model, "tip", np.array(q)).matrix for q in ([0.4, 1.0], [1.4, -1.0]))
    found = ks.ik(model, "tip", np.array([inside, outside]), np.zeros(2))
    assert found.converged.tolist() == [True, False]
    assert_inside(model, found)
    # Newton-Raphson knows no limits, and says so.
    found = ks.ik(model, "tip", outside, np.array([1.3, -0.9]), method="newton", axes="x y rz")
    assert found.converged
    assert not found.inside_limits


def test_limits_that_exclude_zero_and_turns_of_joints_that_may_turn_more():
    model = chain(("revolute", 1.0, 2.0), ("revolute", 4.0, 5.0))
    target = ks.fk(model, "tip", np.array([1.5, 4.5])).matrix
    for start in ([0.0, 0.0], [1.5, 4.5 - 2 * np.pi], [1.2, 4.9]):
        found = ks.ik(model, "tip", target, np.array(start))
        assert_found(model, found)
        assert_same(found.q, np.array([1.5, 4.5]), atol=1e-8)


@pytest.mark.parametrize("turns", [-6.0, -3.5, 0.0, 3.5, 6.0])
def test_a_joint_of_two_turns_stays_near_the_start(turns):
    model = example("ur5_robot")
    start = np.array([turns, -1.0, 1.2, 0.3, 0.5, turns])
    goal = start + 0.05 * np.array([-1, 1, -1, 1, -1, -1]) * np.sign(turns or 1.0)
    found = ks.ik(model, "tool0", ks.fk(model, "tool0", goal).matrix, start)
    assert_found(model, found)
    assert_same(found.q, goal, atol=1e-7)


def test_a_joint_that_the_file_locks_stays():
    model = chain(HALF, ("revolute", 0.5, 0.5), HALF)
    found = ks.ik(model, "tip", ks.fk(model, "tip", np.array([0.3, 0.5, -1.0])).matrix, np.zeros(3))
    assert_found(model, found)
    assert_same(found.q, np.array([0.3, 0.5, -1.0]), atol=1e-8)
    model = chain(HALF, ("prismatic", 0.5, 0.5), HALF)
    found = ks.ik(model, "tip", ks.fk(model, "tip", np.array([0.3, 0.5, -1.0])).matrix, np.zeros(3))
    assert_found(model, found)
    assert_same(found.q, np.array([0.3, 0.5, -1.0]), atol=1e-8)


def test_a_follower_moves_with_its_leader():
    model = chain(HALF, ("revolute", -9.0, 9.0, '<mimic joint="j0" multiplier="-2" offset="0.3"/>'), HALF)
    q = ks.random_configurations(model, 1, 20)
    found = ks.ik(model, "tip", ks.fk(model, "tip", q).matrix, np.zeros((20, 2)))
    assert found.coordinates == ("j0", "j2")
    assert_found(model, found)


def test_limits_of_a_slide_hold():
    model = chain(HALF, ("prismatic", 0.2, 0.6))
    tips = np.array([[2.1, 0, 0], [2.2, 0, 0], [2.6, 0, 0], [2.7, 0, 0], [0, 2.4, 0]])  # 2 m of links, and the slide
    for tip, reached, miss in zip(tips, (False, True, True, False, True), (0.1, 0, 0, 0.1, 0), strict=True):
        found = ks.ik(model, "tip", tip, np.zeros(2), axes="xy")
        assert bool(found.converged) is reached
        assert found.position_residual == pytest.approx(miss, abs=1e-8)
        assert_inside(model, found)


def test_a_planar_joint_on_the_path():
    text = (
        '<robot name="cart"><link name="floor"/><link name="cart"/><joint name="roll" type="planar">'
        '<parent link="floor"/><child link="cart"/><axis xyz="0 0 1"/></joint></robot>'
    )
    model = load_text(text)
    found = ks.ik(model, "cart", "3,-20,0 rpy 0,0,2.5", np.zeros(3))
    assert found.coordinates == ("roll.x", "roll.y", "roll.theta")
    assert_found(model, found)
    assert_same(found.q, np.array([3, -20, 2.5]), atol=1e-8)


# --- out of reach ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("at", [(5.0, 0.0), (0.0, -3.0), (2.0, 2.0), (1.8 + 1e-6, 0.0), (0.1, 0.0), (0.0, -0.05)])
def test_out_of_reach_of_two_links_misses_by_the_distance_to_the_ring(at):
    """The tool of links of 1 m and 0.8 m reaches from 0.2 m to 1.8 m."""
    radius = np.hypot(*at)
    found = ks.ik(textbook("planar_2r"), "tool", (*at, 0.0), np.array([0.3, 0.4]), axes="xy")
    assert not found.converged
    assert found.position_residual == pytest.approx(max(radius - 1.8, 0.2 - radius), abs=1e-8)
    assert found.certificate.agree


def test_out_of_the_plane_misses_by_the_height():
    found = ks.ik(textbook("planar_2r"), "tool", (1.0, 0.3, 0.25), np.array([0.3, 0.4]))
    assert not found.converged
    assert found.position_residual == pytest.approx(0.25, abs=1e-9)
    assert "2 joints have to answer for 3 rows" in found.warnings[0]
    assert "missed by 0.25 m" in found.warnings[-1]


@pytest.mark.parametrize("beyond", [1e-3, 0.3, 2.0])
def test_above_a_stretched_arm_misses_by_how_far_above(beyond):
    """The UR5 stands straight up: nothing lifts the wrist's own link higher."""
    model = example("ur5_robot")
    upright = np.array([0.4, -np.pi / 2, 0.0, 0.0, 0.0, 0.0])
    top = ks.fk(model, "wrist_1_link", upright).matrix[:3, 3]
    many = ks.fk(model, "wrist_1_link", ks.random_configurations(model, 1, 2000)).matrix[:, 2, 3]
    assert top[2] > np.max(many)
    found = ks.ik(model, "wrist_1_link", top + np.array([0, 0, beyond]), np.zeros(6))
    assert not found.converged
    assert found.position_residual == pytest.approx(beyond, abs=5e-7)


def test_what_is_missed_comes_from_restarts_not_from_a_local_minimum():
    """From behind, with limits in between, one descent ends at a limit; the nearest of all is at the other one."""
    model = chain(("revolute", -2.0, 2.0))
    wanted = 2.9  # nearer to 2 than to -2, but 2 rad from zero over the other side
    found = ks.ik(model, "tip", (np.cos(wanted), np.sin(wanted), 0), np.array([-1.9]))
    assert not found.converged
    assert_same(found.q, np.array([2.0]), atol=1e-6)
    one = ks.ik(model, "tip", (np.cos(wanted), np.sin(wanted), 0), np.array([-1.9]), tries=1)
    assert one.position_residual >= found.position_residual


# --- singular targets and other edges ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "tip", "q"),
    [
        ("textbook:planar_2r", "tool", [0.4, 0.0]),
        ("textbook:planar_2r", "tool", [0.4, np.pi]),
        ("textbook:planar_3r", "tool", [0.4, 0.0, 0.0]),
        ("textbook:puma560", "tool", [0.1, 0.2, 0.3, 0.4, 0.0, 0.6]),
        ("example:ur5_robot", "tool0", [0.3, -0.5, 0.0, 0.2, 1.0, 0.0]),
        ("example:ur5_robot", "tool0", [0.3, -0.5, 0.7, 0.2, 0.0, 0.0]),
        ("example:ur5_robot", "tool0", [0.0] * 6),
        ("example:kinova", "j2s6s200_end_effector", [1.0, np.pi, np.pi, 0.0, np.pi, 0.0]),
        ("example:panda", "panda_hand", [0.0, 0.3, 0.0, -0.07, 0.0, 1.5, 0.0, 0.0]),
    ],
)
def test_singular_targets_are_reached(name, tip, q):
    model = ks.load(name)
    target = ks.fk(model, tip, np.array(q)).matrix
    for seed in range(3):
        found = ks.ik(model, tip, target, ks.random_configurations(model, seed))
        assert_found(model, found, atol=1e-8)
        assert_inside(model, found)


@pytest.mark.parametrize("axis", [*np.eye(3), np.ones(3) / np.sqrt(3)])
@pytest.mark.parametrize("angle", [np.pi, np.pi - 1e-7, -np.pi + 1e-7])
def test_half_turns_from_the_start(axis, angle):
    model, q = example("ur5_robot"), np.array([0.1, -1.0, 1.2, 0.3, 0.5, 0.2])
    target = np.array(ks.fk(model, "tool0", q).matrix)
    target[:3, :3] = turn_about(axis, angle) @ target[:3, :3]
    for _, words in SIX[:2]:
        assert_found(model, ks.ik(model, "tool0", target, q, **words))


@pytest.mark.parametrize(("label", "words"), SIX)
@pytest.mark.parametrize("name", ["planar_3r", "puma560", "scara", "stanford", "helical", "planar_1r", "skew_1p"])
def test_who_is_there_already_stays_to_the_bit(name, label, words):
    model = textbook(name)
    tip = model.robot.default_tip()
    q = ks.random_configurations(model, 5)
    found = ks.ik(model, tip, ks.fk(model, tip, q).matrix, q, **words)
    assert found.converged
    assert found.iterations == 0
    assert np.array_equal(found.q, q)


def test_who_is_there_a_turn_away_stays_to_the_bit():
    model = example("ur5_robot")
    q = np.array([4.0, -5.0, 1.2, 6.0, -4.5, 3.5])
    found = ks.ik(model, "tool0", ks.fk(model, "tool0", q).matrix, q)
    assert found.iterations == 0
    assert np.array_equal(found.q, q)


def test_the_start_is_not_changed():
    q, target = np.zeros((3, 6)), np.eye(4)
    target[:3, 3] = 0.4, 0.1, 0.4
    ks.ik(example("ur5_robot"), "tool0", target, q)
    assert not np.any(q)
    assert target[:3, 3].tolist() == [0.4, 0.1, 0.4]


def test_far_coordinates_that_slides_reach():
    model = chain(("prismatic", -1e6, 1e6), ("continuous",))
    found = ks.ik(model, "tip", (1e5, 0.5, 0), np.zeros(2), axes="xy")
    assert_found(model, found, rows=(0, 1))


@pytest.mark.parametrize("far", [1e3, 1e6, 1e9, 1e12])
@pytest.mark.parametrize(("label", "words"), SIX)
def test_far_poses_are_missed_and_no_more(far, label, words):
    model = example("ur5_robot")
    found = ks.ik(model, "tool0", (far, 0, 0, 0, 0, 0), np.zeros(6), **(words or {"tries": 3}))
    assert not found.converged
    assert found.position_residual == pytest.approx(far, abs=1.5, rel=1e-9)
    assert np.all(np.isfinite(found.q))


# --- batches, seeds, shapes --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "tip"), [("panda", "panda_hand"), UR5, ("kinova", "j2s6s200_end_effector")])
def test_batches_succeed_where_single_questions_do(name, tip):
    model = example(name)
    target = ks.fk(model, tip, ks.random_configurations(model, 1, 12)).matrix
    start = ks.random_configurations(model, 2, 12)
    many = ks.ik(model, tip, target, start)
    assert np.all(many.converged)
    for i in range(12):
        one = ks.ik(model, tip, target[i], start[i])
        assert one.converged
        assert one.inside_limits
        if many.iterations[i] == one.iterations:  # no restart in either: the same path
            assert_same(one.q, many.q[i], atol=1e-6)


def test_leading_shapes_go_together():
    model = example("ur5_robot")
    target = ks.fk(model, "tool0", ks.random_configurations(model, 1, (3, 1))).matrix
    found = ks.ik(model, "tool0", target, ks.random_configurations(model, 2, (2,)))
    assert found.q.shape == (3, 2, 6)
    assert found.error.shape == (3, 2, 6)
    assert found.converged.shape == found.iterations.shape == found.inside_limits.shape == (3, 2)
    assert found.position_residual.shape == found.rotation_residual.shape == (3, 2)
    assert_found(model, found)
    assert ks.ik(model, "tool0", np.zeros((0, 4, 4)), np.zeros(6)).q.shape == (0, 6)
    assert ks.ik(model, "tool0", np.eye(4), np.zeros((0, 6))).q.shape == (0, 6)
    assert ks.ik(model, "tool0", target[:1, 0], np.zeros((1, 6)), method="newton").q.shape == (1, 6)


def test_a_seed_makes_it_repeatable():
    model = example("panda")
    target = ks.fk(model, "panda_hand", ks.random_configurations(model, 1, 30)).matrix
    start = np.zeros((30, model.robot.nq))  # outside limits, singular: restarts are needed
    first, again = (ks.ik(model, "panda_hand", target, start, seed=3) for _ in range(2))
    assert np.array_equal(first.q, again.q)
    assert np.array_equal(first.iterations, again.iterations)
    other = ks.ik(model, "panda_hand", target, start, seed=4)
    assert np.all(other.converged)
    assert not np.array_equal(first.q, other.q)


def test_fewer_tries_reach_fewer_poses():
    model = example("panda")
    target = ks.fk(model, "panda_hand", ks.random_configurations(model, 1, 60)).matrix
    start = ks.random_configurations(model, 2, 60)
    one, many = (ks.ik(model, "panda_hand", target, start, tries=tries) for tries in (1, 50))
    assert np.all(many.converged)
    assert 10 < np.sum(one.converged) < 60
    assert np.all(one.inside_limits)
    # A start that led there is not left for another (but for those that were only drawn in at the end).
    assert np.sum(np.all(many.q == one.q, axis=-1)) > 10


def test_without_the_second_engine_the_numbers_are_the_same():
    alone = ks.load("example:ur5_robot", crosscheck=False)
    target = ks.fk(alone, "tool0", ks.random_configurations(alone, 1, 5)).matrix
    found = ks.ik(alone, "tool0", target, np.zeros(6))
    assert found.certificate.agree is None
    assert_same(found.q, ks.ik(example("ur5_robot"), "tool0", target, np.zeros(6)).q, atol=1e-12)


# --- textbook methods and their traces ---------------------------------------------------------------------------


@pytest.mark.parametrize(("words", "least"), [({"method": "newton"}, 3), ({"method": "pseudo-inverse", "step": 1}, 3)])
def test_a_trace_tells_each_step(words, least):
    model, q = example("ur5_robot"), np.array([0.1, -1.0, 1.2, 0.3, 0.5, 0.2])
    found = ks.ik(model, "tool0", ks.fk(model, "tool0", q + 0.1).matrix, q, **words)
    assert found.converged
    assert len(found.trace) == found.iterations + 1 > least
    assert_same(found.trace[0].q, q, atol=0)
    assert_same(found.trace[-1].q, found.q, atol=0)
    assert found.trace[-1].change is None
    for step, after in zip(found.trace, found.trace[1:], strict=False):
        assert_same(step.q + step.change, after.q, atol=1e-15)
        assert step.time is None
    # Newton-Raphson squares the error, near the end.
    errors = [step.error for step in found.trace if step.error > 1e-7]
    assert errors[-1] < 10 * errors[-2] ** 2


def test_the_first_step_of_newton_solves_the_linear_equation():
    """By Pinocchio's Jacobian: J h = e, and of all steps that do so the shortest, angles and lengths compared by L."""
    model = example("ur5_robot")
    q = np.array([0.1, -1.0, 1.2, 0.3, 0.5, 0.2])
    found = ks.ik(model, "tool0", ks.fk(model, "tool0", q + 0.1).matrix, q, method="newton")
    error = gap_vector(model, "tool0", q, found.target)
    matrix = ks.jacobian(model, "tool0", q).matrix
    assert_same(matrix @ found.trace[0].change, error, atol=1e-10)


def gap_vector(model, frame, q, target):
    here = model.engine.placement(q, frame, model.robot.root)
    turn = Rotation.from_matrix(target[:3, :3] @ here[:3, :3].T).as_rotvec()
    return np.concatenate([target[:3, 3] - here[:3, 3], turn])


def test_a_redundant_arm_takes_the_shortest_step():
    model = example("panda")
    q = ks.configuration(model, "default").q
    found = ks.ik(model, "panda_hand", ks.fk(model, "panda_hand", q + 0.05).matrix, q, method="newton")
    assert found.converged
    change = found.trace[0].change
    matrix = ks.jacobian(model, "panda_hand", q).matrix
    null = np.linalg.svd(matrix)[2][-1]
    assert abs(null @ change) < 1e-10
    assert_same(matrix @ change, gap_vector(model, "panda_hand", q, found.target), atol=1e-10)


def test_more_rows_than_joints_are_reached_where_they_can_be():
    model = textbook("planar_3r")
    q = np.array([0.4, 0.7, -0.3])
    target = ks.fk(model, "tool", q).matrix
    for _, words in SIX:
        found = ks.ik(model, "tool", target, q + 0.1, **words)
        assert_found(model, found)
        assert "3 joints have to answer for 6 rows" in found.warnings[0]


@pytest.mark.parametrize("share", [0.02, 0.5, 0.9, 1.0, 1])
def test_steps_shrink_a_small_error_by_what_is_left(share):
    model, q = example("ur5_robot"), np.array([0.1, -1.0, 1.2, 0.3, 0.5, 0.2])
    found = ks.ik(model, "tool0", ks.fk(model, "tool0", q + 1e-4).matrix, q, method="pseudo-inverse", step=share)
    first, second = found.trace[0].error, found.trace[1].error
    assert second / first == pytest.approx(1 - share, abs=1e-3)
    assert_same(found.trace[0].change + q, found.trace[1].q, atol=1e-15)


def test_a_step_too_small_does_not_reach_and_says_so():
    model, q = textbook("planar_3r"), np.array([0.4, 0.7, -0.3])
    target = ks.fk(model, "tool", q + 0.1).matrix
    found = ks.ik(model, "tool", target, q, axes="x y rz", method="pseudo-inverse", step=1e-300)
    assert not found.converged
    assert_same(found.q, q, atol=0)


def test_rates_fade_as_an_exponential():
    """Time, rates and errors of the trace; and rates are those of the path, by differences."""
    model, q = example("ur5_robot"), np.array([0.1, -1.0, 1.2, 0.3, 0.5, 0.2])
    goal = np.eye(4)
    goal[:3, :3] = ks.fk(model, "tool0", q).matrix[:3, :3]  # along a line, with the orientation kept
    goal[:3, 3] = ks.fk(model, "tool0", q).matrix[:3, 3] + [0.05, -0.1, 0.08]
    found = ks.ik(model, "tool0", goal, q, method="pseudo-inverse")
    times = np.array([step.time for step in found.trace])
    errors = np.array([step.error for step in found.trace])
    assert times[0] == 0
    assert np.ptp(np.diff(times)) < 1e-12
    np.testing.assert_allclose(errors, errors[0] * np.exp(-times), rtol=1e-5, atol=1e-12)
    for i in (5, 40, 100):
        before, after = found.trace[i - 1], found.trace[i + 1]
        slope = (after.q - before.q) / (after.time - before.time)
        assert_same(slope, found.trace[i].change, atol=2e-3 * np.max(np.abs(found.trace[i].change)) + 1e-12)


def test_newton_that_diverges_says_so():
    model = textbook("planar_2r")
    found = ks.ik(model, "tool", (5.0, 0, 0), np.array([0.3, 0.4]), method="newton", axes="xy")
    assert not found.converged
    assert np.all(np.isfinite(found.q))
    assert found.certificate.agree


# --- found wanting -----------------------------------------------------------------------------------------------


def test_limits_of_a_follower_hold_too():
    """The leader may go where its follower may; a configuration beyond is warned of everywhere else."""
    model = chain(HALF, ("revolute", -0.1, 0.1, '<mimic joint="j0"/>'))
    beyond = ks.fk(model, "tip", np.array([2.0])).matrix
    found = ks.ik(model, "tip", beyond, np.zeros(1))
    assert not (found.inside_limits and ks.configuration(model, found.q).warnings)


def test_shapes_that_do_not_go_together_are_refused():
    with pytest.raises(ks.UsageError):
        ks.ik(example("ur5_robot"), "tool0", np.tile(np.eye(4), (3, 1, 1)), np.zeros((2, 6)))


@pytest.mark.parametrize("asked", [ks.ik, ks.ik_all])
def test_a_seed_that_is_none_is_refused(asked):
    with pytest.raises(ks.UsageError):
        asked(textbook("planar_2r"), "tool", (1.0, 0.5, 0), np.zeros(2), seed=-1)


@pytest.mark.parametrize("far", [1e3, 1e6, 1e9, 1e12])
def test_slides_without_limits_go_far_or_say_that_they_do_not(far):
    model = chain(("revolute", -1e308, 1e308), ("prismatic", -1e308, 1e308))
    found = ks.ik(model, "tip", (far, far / 10, 0), np.zeros(2), tries=3)
    assert found.certificate.agree
    assert np.all(np.isfinite(found.q))


# --- refusals ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("frame", "words", "message"),
    [
        ("tol", {}, "there is no frame 'tol'"),
        ("tool", {"relative_to": "nowhere"}, "there is no frame 'nowhere'"),
        ("tool", {"method": "gauss"}, "there is no method 'gauss'"),
        ("tool", {"step": 0.5}, "a step is between 0 and 1"),
        ("tool", {"method": "newton", "step": 0.5}, "a step is between 0 and 1"),
        ("tool", {"method": "pseudo-inverse", "step": 0.0}, "a step is between 0 and 1"),
        ("tool", {"method": "pseudo-inverse", "step": 1.5}, "a step is between 0 and 1"),
        ("tool", {"method": "pseudo-inverse", "step": float("nan")}, "a step is between 0 and 1"),
        ("tool", {"tries": 0}, "tries, not 0"),
        ("tool", {"tries": 10**9}, "tries, not 1000000000"),
        ("tool", {"axes": "w"}, "no axis 'w'"),
        ("tool", {"axes": "rz"}, "the pose has no orientation"),
        ("tool", {"reference": "world"}, "rows that count are those of a tool point"),
        ("tool", {"point": (0, 0, float("nan"))}, "finite"),
        ("base", {}, "no joint moves 'base'"),
        ("tool", {"relative_to": "tool"}, "no joint moves 'tool'"),
    ],
)
def test_what_cannot_be_asked_is_refused(frame, words, message):
    with pytest.raises(ks.UsageError, match=message):
        ks.ik(textbook("planar_2r"), frame, (1.0, 0, 0), np.zeros(2), **words)


@pytest.mark.parametrize("q", [np.zeros(3), np.array([np.nan, 0]), np.array([np.inf, 0]), np.array([1e9, 0])])
def test_a_start_that_is_none_is_refused(q):
    with pytest.raises(ks.ConfigurationError):
        ks.ik(textbook("planar_2r"), "tool", (1.0, 0, 0), q)


def test_several_poses_are_the_damped_methods():
    for method in ("newton", "pseudo-inverse"):
        with pytest.raises(ks.UsageError, match="takes one pose and one start"):
            ks.ik(textbook("planar_2r"), "tool", (1.0, 0, 0), np.zeros((2, 2)), method=method)


def test_a_floating_joint_is_refused_by_name_with_a_way_out():
    model = textbook("planar_2r", floating_base=True)
    q = ks.configuration(model, "zero").q
    with pytest.raises(ks.UsageError, match="floating joint 'root_joint'") as caught:
        ks.ik(model, "tool", (1.0, 0, 0), q)
    assert "--relative-to base" in str(caught.value)
    found = ks.ik(model, "tool", (1.0, 0.3, 0), q, relative_to="base")
    assert found.converged
    assert_same(found.q[:7], q[:7], atol=0)


def test_a_wrong_engine_is_caught(monkeypatch):
    model = ks.load("textbook:planar_2r")
    right = model.witness.placement
    monkeypatch.setitem(model.witness.__dict__, "placement", lambda *given: right(*given) + 1e-9)
    assert ks.ik(model, "tool", (1.0, 0.3, 0), np.zeros(2)).certificate.agree is False
    assert ks.ik_all(model, "tool", (1.0, 0.3, 0), np.zeros(2)).certificate.agree is False
