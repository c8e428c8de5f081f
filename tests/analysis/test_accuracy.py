"""Tool errors by joint errors, the joint resolution that an accuracy needs, and ways into singular configurations.

Witnesses are placements: what the tool does when the joints are off is asked of forward kinematics.
"""

import math
from itertools import pairwise, product

import numpy as np
import pytest

import differences
import kinetostat as ks
from kinetostat.analysis.configuration import displaced
from kinetostat.analysis.zonotope import farthest
from textbook_support import assert_same, command_line
from trees import load_text, random_tree

MODELS, FOLLOWED = {}, {}
UR5 = ("example:ur5_robot", "tool0", "0.3,-1.2,1.4,-0.6,0.8,0.2")
PANDA = ("example:panda", "panda_hand", "default")
ARMS = (UR5, PANDA, ("textbook:scara", "tool", "0.5,0.9,0.1,-0.3"), ("textbook:stanford", "tool", "random:3"))


def model_of(source, **how):
    return MODELS.setdefault((source, *how.items()), ks.load(source, **how))


def at(source, q, **how):
    return ks.configuration(model_of(source, **how), q).q


def error_of(source, q, errors=None, frame=None, **asked):
    model = model_of(source)
    result = ks.tool_error(model, frame or model.robot.default_tip(), np.asarray(q, dtype=float), errors, **asked)
    assert result.certificate.agree is True
    return result


# --- theory A7: the planar arm of three links, 2, 1 and 1 m -------------------------------------------------------


@pytest.mark.parametrize(
    ("q", "x", "y"), [((0, 0, 0), 0.0, 0.2), ((0, math.pi / 2, 0), -0.2, 0.0)], ids=["stretched", "elbow at 90 deg"]
)
def test_a7_the_move_by_an_error_of_the_second_joint(q, x, y):
    result = error_of("textbook:planar_3r", q, (0, 0.1, 0))
    assert_same(result.displacement, np.array([x, y, 0, 0, 0, 0.1]))
    # One joint errs alone, so it makes the worst case and all of the variance.
    for part, size in ((result.translation, 0.2), (result.rotation, 0.1)):
        assert_same(part.worst, np.array(size))
        assert_same(part.sigma, np.array(size))
        assert_same(part.lengths, np.array([size, 0, 0]))
        assert_same(part.worst_shares, np.array([0, 1.0, 0]))
        assert_same(part.sigma_shares, np.array([0, 1.0, 0]))
    # Exactly, the tip moves on a circle of 2 m about the second joint: along a chord.
    assert_same(np.linalg.norm(result.moved[:3]), np.array(4 * math.sin(0.05)))
    assert_same(result.translation.there, np.array(4 * math.sin(0.05)))
    assert result.warnings == ()


def test_a7_through_the_command_line():
    words = ("-q", "0,90,0", "--deg", "--joint-error", f"joint2={math.degrees(0.1)!r}")
    result = command_line("error", "textbook:planar_3r", *words)["result"]
    assert_same(result["displacement"], np.array([-0.2, 0, 0, 0, 0, 0.1]))


def test_all_signs_equal_is_the_worst_of_a_stretched_planar_arm():
    result = error_of("textbook:planar_3r", (0, 0, 0), 0.001)
    assert_same(result.translation.worst, np.array(0.007))  # 4 + 2 + 1 m
    assert_same(result.translation.signs, np.ones(3))
    assert_same(result.translation.worst_shares, np.array([4, 2, 1]) / 7)
    assert_same(result.translation.sigma_shares, np.array([16, 4, 1]) / 21)
    assert_same(result.rotation.worst, np.array(0.003))


# --- laws: the first order and the exact move ---------------------------------------------------------------------


def labelled(model, frame, **asked):
    return ks.jacobian(model, frame, ks.configuration(model, "zero").q, **asked).velocity


@pytest.mark.parametrize("asked", [
    {}, {"reference": "local"}, {"reference": "world"}, {"point": (0.1, -0.2, 0.3)},
    {"reference": "local", "point": (0.1, -0.2, 0.3)}, {"relative_to": "@"}, {"expressed_in": "@"},
    {"relative_to": "@", "reference": "world"},
], ids=str)  # fmt: skip
@pytest.mark.parametrize("arm", ARMS, ids=lambda arm: arm[0])
def test_moves_are_those_of_placements(arm, asked):
    source, frame, q = arm
    model, q = model_of(source), at(source, q)
    middle = [joint.child for joint in model.robot.movable_path(model.robot.root, frame)][1]
    asked = {key: middle if value == "@" else value for key, value in asked.items()}
    result = ks.tool_error(model, frame, q, None if source in (UR5[0], PANDA[0]) else 0.001, **asked)
    rates = np.zeros(model.robot.nv)
    rates[[list(model.engine.velocity_names).index(name) for name in result.columns]] = result.joint_error
    expected = differences.twist(model.engine, model.robot, q, rates / 1e-3, result.velocity) * 1e-3
    assert_same(result.displacement, expected, atol=1e-12)
    assert np.linalg.norm(result.moved - result.displacement) < 20 * np.sum(np.abs(result.joint_error)) ** 2


@pytest.mark.parametrize("seed", range(25))
def test_moves_of_random_trees_with_every_kind_of_joint(seed):
    """Floating, planar, sliding and screw joints, followers; and configurations in which joints stand at zero."""
    model = random_tree(seed, floating_base=seed % 3 == 0)
    robot = model.robot
    frame = max(robot.tips, key=lambda tip: len(robot.movable_path(robot.root, tip)))
    if not robot.movable_path(robot.root, frame):
        with pytest.raises(ks.UsageError, match="no joint moves"):
            ks.tool_error(model, frame, ks.configuration(model, "zero").q)
        return
    generator = np.random.default_rng(seed)
    q = ks.configuration(model, "zero" if seed % 4 == 0 else f"random:{seed}").q
    n = len(ks.jacobian(model, frame, q).columns)
    errors = generator.normal(size=n) * np.where(generator.random(n) < 0.3, 0.0, 1e-3)
    if not np.any(errors):
        errors[0] = 1e-3
    result = ks.tool_error(model, frame, q, errors)
    assert result.certificate.agree is True
    rates = np.zeros(robot.nv)
    rates[[list(model.engine.velocity_names).index(name) for name in result.columns]] = errors / 1e-3
    expected = differences.twist(model.engine, robot, q, rates, result.velocity) * 1e-3
    assert_same(result.displacement, expected, atol=1e-9 * max(1.0, robot.reach))
    # What the first order leaves out is of second order: half the error, a quarter of it.
    gaps = [
        np.linalg.norm(part.moved - part.displacement)
        for part in (result, ks.tool_error(model, frame, q, errors / 2), ks.tool_error(model, frame, q, errors / 4))
    ]
    assert all(b <= 0.27 * a + 1e-12 * max(1.0, robot.reach) for a, b in pairwise(gaps))


def test_exact_moves_of_a_planar_arm_are_those_of_its_tip():
    q, errors = np.array([0.7, -1.1]), np.array([0.4, -0.3])

    def tip(q):
        return np.array([np.cos(q[0]) + 0.8 * np.cos(q.sum()), np.sin(q[0]) + 0.8 * np.sin(q.sum()), 0])

    result = error_of("textbook:planar_2r", q, errors)
    assert_same(result.moved, np.array([*(tip(q + errors) - tip(q)), 0, 0, 0.1]))
    # The same in the axes of the tool, as they are before it moves.
    c, s = np.cos(q.sum()), np.sin(q.sum())
    local = error_of("textbook:planar_2r", q, errors, reference="local")
    assert_same(local.moved[:2], np.array([[c, s], [-s, c]]) @ result.moved[:2])


def test_finite_motions_of_floating_and_planar_joints_add_up():
    """Twice half a step is the step: motions along one twist make a group."""
    floating = ks.load("textbook:planar_2r", floating_base=True)
    planar = next(m for m in map(random_tree, range(50)) if any(j.type == "planar" for j in m.robot.independent))
    for model in (floating, planar):
        generator = np.random.default_rng(0)
        q, step = ks.random_configurations(model, 1, 4), generator.normal(size=(4, model.robot.nv))
        once = displaced(model.robot, q, step)
        twice = displaced(model.robot, displaced(model.robot, q, step / 2), step / 2)
        tip = next(joint.child for joint in model.robot.independent if joint.type.nv > 1)
        assert_same(ks.fk(model, tip, once).matrix, ks.fk(model, tip, twice).matrix, atol=1e-9)
        assert np.max(np.abs(once - q)) > 0.1


@pytest.mark.parametrize("size", [0.3, 1.0])
def test_errors_too_large_for_first_order_are_warned_of(size):
    result = error_of(UR5[0], at(UR5[0], UR5[2]), size, frame="tool0")
    assert any("too large for first order" in line for line in result.warnings)
    assert error_of(UR5[0], at(UR5[0], UR5[2]), 0.001, frame="tool0").warnings == ()


def test_errors_that_add_up_to_half_a_turn_are_no_disagreement():
    result = error_of("textbook:planar_3r", (0.1, 0.2, 0.3), math.pi / 3)
    assert_same(np.abs(result.moved[5]), np.array(math.pi))


# --- laws: worst cases and variances, against forward kinematics ---------------------------------------------------


@pytest.mark.parametrize("arm", ARMS, ids=lambda arm: arm[0])
def test_the_worst_of_all_patterns_is_the_worst_of_forward_kinematics(arm):
    source, frame, q = arm
    model, q = model_of(source), at(source, q)
    turning = [unit == "rad/s" for unit in ks.jacobian(model, frame, q).column_units]
    sizes = np.where(turning, 1e-6, 3e-7) * np.linspace(1, 2, len(turning))
    result = ks.tool_error(model, frame, q, sizes)
    joints = list(model.engine.velocity_names)
    steps = np.zeros((2 ** len(sizes), model.robot.nv))
    steps[:, [joints.index(name) for name in result.columns]] = list(product((-1, 1), repeat=len(sizes))) * sizes
    # A difference of two sides, so that what is of second order drops out.
    ahead, behind = (ks.fk(model, frame, displaced(model.robot, q, sign * steps)) for sign in (1, -1))
    moves = (ahead.position - behind.position) / 2
    assert np.allclose(np.max(np.abs(moves), axis=0), result.worst[:3], rtol=1e-6, atol=1e-14)
    lengths = np.linalg.norm(moves, axis=1)
    assert np.isclose(np.max(lengths), result.translation.worst, rtol=1e-6)
    assert np.isclose(result.translation.there, result.translation.worst, rtol=1e-4)
    # Independent errors: over all patterns of signs the mean of products is the covariance.
    covariance = moves.T @ moves / len(moves)
    axes, values = result.translation.axes, result.translation.lengths
    assert np.allclose(axes @ np.diag(values**2) @ axes.T, covariance, rtol=1e-6, atol=1e-9 * np.max(covariance))
    assert np.allclose(np.sqrt(np.diag(covariance)), result.sigma[:3], rtol=1e-6, atol=1e-14)
    assert np.isclose(np.sqrt(np.mean(lengths**2)), result.translation.sigma, rtol=1e-6)
    turns = ahead.matrix[:, :3, :3] @ np.swapaxes(behind.matrix[:, :3, :3], -1, -2) / 2
    angles = np.linalg.norm([turns[:, 2, 1] - turns[:, 1, 2], turns[:, 0, 2] - turns[:, 2, 0],
                             turns[:, 1, 0] - turns[:, 0, 1]], axis=0) / 2  # fmt: skip
    assert np.isclose(np.max(angles), result.rotation.worst, rtol=1e-5)
    assert np.isclose(np.sqrt(np.mean(angles**2)), result.rotation.sigma, rtol=1e-5)


@pytest.mark.parametrize("count", [1, 2, 3, 5, 8])
@pytest.mark.parametrize("rank", [1, 2, 3])
def test_the_farthest_vertex_is_the_farthest_of_all(count, rank):
    generator = np.random.default_rng(count + 10 * rank)
    columns = generator.normal(size=(6, 3, rank)) @ generator.normal(size=(6, rank, count))
    columns[1, :, 0] = 0
    columns[2, :, -1] = columns[2, :, 0]
    columns[3] = 0
    columns[4] *= 10.0 ** generator.uniform(-9, 3, count)
    signs = farthest(columns)
    assert signs.shape == (6, count)
    assert set(np.unique(signs)) <= {-1.0, 1.0}
    patterns = np.array(list(product((-1, 1), repeat=count)))
    every = np.linalg.norm(columns @ patterns.T, axis=1)
    assert np.allclose(np.linalg.norm((columns @ signs[..., None])[..., 0], axis=-1), every.max(-1), rtol=1e-12)


def test_many_goes_at_the_patterns_find_what_one_finds(monkeypatch):
    columns = 0.01 * np.random.default_rng(5).normal(size=(40, 3, 9))
    whole = farthest(columns)
    monkeypatch.setattr("kinetostat.analysis.zonotope._AT_ONCE", 2000)
    assert_same(farthest(columns), whole)


def comb(count):
    """Return a planar arm of so many joints, each with its own length."""
    links = "".join(f'<link name="l{i}"/>' for i in range(count + 1))
    joints = "".join(
        f'<joint name="j{i}" type="continuous"><parent link="l{i}"/><child link="l{i + 1}"/>'
        f'<origin xyz="{0.1 + 0.01 * i} 0 0.02" rpy="{0.3 * i} 0.2 0"/><axis xyz="0 0 1"/></joint>'
        for i in range(count)
    )
    return load_text(f'<robot name="comb">{links}{joints}</robot>')


def test_beyond_twenty_joints_the_worst_case_is_an_upper_bound():
    model = comb(24)
    q = ks.random_configurations(model, 0)
    result = ks.tool_error(model, "l24", q, 1e-4)
    scaled = result.matrix * 1e-4
    patterns = np.random.default_rng(0).choice([-1.0, 1.0], size=(5000, 24))
    for part, rows in ((result.translation, slice(0, 3)), (result.rotation, slice(3, 6))):
        assert part.exact is False
        found = np.linalg.norm(scaled[rows] @ part.signs)
        sampled = np.max(np.linalg.norm(scaled[rows] @ patterns.T, axis=0))
        assert 0.95 * sampled <= found <= part.worst <= 1.75 * found
        assert np.isclose(np.sum(part.worst_shares), 1)
    assert result.translation.worst > np.linalg.norm(scaled[:3] @ result.translation.signs)
    # With an error in twenty of them all patterns are tried.
    errors = np.where(np.arange(24) < 20, 1e-4, 0.0)
    assert ks.tool_error(model, "l24", q, errors).translation.exact is True


@pytest.mark.parametrize("arm", ARMS, ids=lambda arm: arm[0])
def test_shares_are_shares(arm):
    source, frame, _ = arm
    model = model_of(source)
    result = ks.tool_error(model, frame, ks.random_configurations(model, 2, (3, 2)), 0.001)
    slides = np.array(result.column_units) == "m"
    for part in (result.translation, result.rotation):
        for shares in (part.worst_shares, part.sigma_shares):
            assert shares.shape == (3, 2, len(result.columns))
            assert np.allclose(shares.sum(-1), 1)
            assert np.all(shares > -1e-12)
            assert np.all(shares[..., slides] == 0)  # whose errors are 0 here
        assert np.all(part.sigma <= part.worst * (1 + 1e-12))
        assert np.all(part.lengths[..., 0] <= part.sigma * (1 + 1e-12))


def test_errors_of_slides_turn_nothing():
    model = random_tree(1, kinds=("prismatic",), most=4)
    tip = max(model.robot.tips, key=lambda tip: len(model.robot.movable_path(model.robot.root, tip)))
    result = ks.tool_error(model, tip, ks.configuration(model, "zero").q)  # equal errors, in m
    assert set(result.column_units) == {"m"}
    assert result.rotation.worst == result.rotation.sigma == 0
    assert np.all(result.rotation.worst_shares == 0)
    assert result.translation.worst > 0
    sizes = ks.joint_resolution(result, accuracy=1e-3)
    assert np.all(np.isnan(sizes.worst.counts))
    assert np.all(np.isinf(ks.joint_resolution(result, accuracy_angle=1e-3).worst.errors))


def test_no_error_is_no_error():
    result = error_of("textbook:planar_3r", (0.1, 0.2, 0.3), (0, 0, 0))
    for moves in (result.displacement, result.moved, result.worst, result.sigma):
        assert not np.any(moves)
    assert result.translation.worst == result.translation.sigma == 0
    assert np.all(np.isinf(ks.joint_resolution(result, accuracy=1).worst.factor))
    assert np.all(ks.joint_resolution(result, accuracy=1).worst.errors == 0)


def test_signs_count_in_the_move_alone():
    q, errors = at(UR5[0], UR5[2]), np.array([1, -2, 3, -1, 2, 1]) * 1e-4
    signed, plain = (error_of(UR5[0], q, each, frame="tool0") for each in (errors, np.abs(errors)))
    for key in ("worst", "sigma"):
        assert_same(getattr(signed, key), getattr(plain, key))
        assert_same(getattr(signed.translation, key), getattr(plain.translation, key))
    assert_same(error_of(UR5[0], q, -errors, frame="tool0").displacement, -signed.displacement)
    assert np.linalg.norm(signed.displacement - plain.displacement) > 1e-5


@pytest.mark.parametrize("arm", ARMS, ids=lambda arm: arm[0])
def test_a_batch_is_each_of_its_configurations(arm):
    model = model_of(arm[0])
    batch = ks.random_configurations(model, 7, (2, 3))
    whole = ks.tool_error(model, arm[1], batch, 0.001)
    sizes = ks.joint_resolution(whole, accuracy=1e-4, accuracy_angle=1e-3)
    assert whole.certificate.agree is True
    for place in product(range(2), range(3)):
        one = ks.tool_error(model, arm[1], batch[place], 0.001)
        assert_same(whole.moved[place], one.moved, atol=1e-15)
        for part, single in ((whole.translation, one.translation), (whole.rotation, one.rotation)):
            assert_same(part.worst[place], single.worst, atol=1e-15)
            assert_same(part.there[place], single.there, atol=1e-15)
            assert_same(part.lengths[place], single.lengths, atol=1e-15)
        alone = ks.joint_resolution(one, accuracy=1e-4, accuracy_angle=1e-3)
        assert np.allclose(sizes.worst.errors[place], alone.worst.errors)
        assert sizes.decides[place] == alone.decides


def test_followers_err_with_their_leader(tmp_path):
    text = """<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
      <joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
      <joint name="f" type="continuous"><origin xyz="1 0 0"/><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
        <mimic joint="j" multiplier="-2"/></joint>
      <joint name="t" type="fixed"><origin xyz="1 0 0"/><parent link="c"/><child link="d"/></joint></robot>"""
    path = tmp_path / "r.urdf"
    path.write_text(text)
    result = ks.tool_error(ks.load(path), "d", np.zeros(1), 1e-3)
    assert result.columns == ("j",)
    assert_same(result.displacement, np.array([0, 0, 0, 0, 0, -1e-3]))  # 2 m forward, 2 x 1 m back


# --- the other way round -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("wanted", [
    {"accuracy": 1e-4}, {"accuracy_angle": 2e-3}, {"accuracy": 1e-4, "accuracy_angle": 1e-6},
    {"accuracy": 1e-3, "accuracy_angle": 0.5},
], ids=str)  # fmt: skip
@pytest.mark.parametrize("errors", [0.001, (1e-3, 2e-3, 0, 5e-4, 1e-3, 3e-3)], ids=str)
def test_allowed_joint_errors_make_just_the_wanted_accuracy(wanted, errors):
    q = at(UR5[0], UR5[2])
    sizes = ks.joint_resolution(error_of(UR5[0], q, errors, frame="tool0"), **wanted)

    def worst_of(kind, errors):
        result = error_of(UR5[0], q, errors, frame="tool0")
        shares = [getattr(result.translation, kind) / wanted.get("accuracy", math.inf),
                  getattr(result.rotation, kind) / wanted.get("accuracy_angle", math.inf)]  # fmt: skip
        return max(shares), ("position", "rotation")[int(np.argmax(shares))]

    share, decides = worst_of("worst", sizes.worst.errors)
    assert np.isclose(share, 1, rtol=1e-12)
    assert sizes.decides == decides
    assert np.isclose(worst_of("sigma", sizes.sigma.errors)[0], 1, rtol=1e-12)
    for i, single in enumerate(sizes.alone.errors):
        share = worst_of("worst", np.where(np.arange(6) == i, min(single, 1.0), 0))[0]
        assert np.isclose(share, 1, rtol=1e-12) if math.isfinite(single) else share < 1e-12


def test_encoders_have_the_counts_that_are_needed_and_no_more():
    q = at(UR5[0], UR5[2])
    sizes = ks.joint_resolution(error_of(UR5[0], q, 0.001, frame="tool0"), accuracy=1e-4)
    count = 2 * math.pi / sizes.worst.counts  # rad
    assert np.all(count / 2 <= sizes.worst.errors)
    assert np.all(2 * math.pi / (sizes.worst.counts - 1) / 2 > sizes.worst.errors)
    # A reading spread evenly over a count: its variance from a fine ruler.
    ruler = (np.arange(10_000) + 0.5) / 10_000 - 0.5
    spread = np.sqrt(np.mean(ruler**2))
    assert np.all(spread * 2 * math.pi / sizes.sigma.counts <= sizes.sigma.errors * (1 + 1e-7))
    assert np.all(spread * 2 * math.pi / (sizes.sigma.counts - 1) > sizes.sigma.errors)
    assert np.all(2.0**sizes.worst.bits >= sizes.worst.counts)
    assert np.all(2.0 ** (sizes.worst.bits - 1) < sizes.worst.counts)
    assert math.isnan(sizes.alone.counts[5])  # the last joint does not move the point
    assert math.isnan(sizes.alone.bits[5])


def test_a_whole_number_of_counts_is_not_rounded_up():
    result = error_of("textbook:planar_1r", (0.3,))
    radius = float(result.translation.worst) / 1e-3
    for counts in (*range(3, 1000, 7), 4096):
        sizes = ks.joint_resolution(result, accuracy=radius * math.pi / counts)
        assert sizes.worst.counts == counts
    assert sizes.worst.bits == 12


@pytest.mark.parametrize("size", [0, -1, math.nan, math.inf])
def test_an_accuracy_that_cannot_be_is_refused(size):
    result = error_of("textbook:planar_1r", (0.3,))
    with pytest.raises(ks.UsageError, match="--accuracy is between"):
        ks.joint_resolution(result, accuracy=size)
    with pytest.raises(ks.UsageError, match="--accuracy-angle is between"):
        ks.joint_resolution(result, accuracy_angle=size)
    with pytest.raises(ks.UsageError, match="no accuracy is wanted"):
        ks.joint_resolution(result)


# --- joint errors as they are given --------------------------------------------------------------------------------

SCARA = ("joint1", "joint2", "joint3", "joint4")  # the third slides


@pytest.mark.parametrize(("given", "degrees", "expected"), [
    (0.001, False, (1e-3, 1e-3, 0, 1e-3)),
    ("0.001", False, (1e-3, 1e-3, 0, 1e-3)),
    ("-0.5", True, np.array([-1, -1, 0, -1]) * math.pi / 360),
    ("1,2,3,4", True, (*np.radians([1, 2]), 3, math.radians(4))),
    ((0.1, 0.2, 0.3, 0.4), False, (0.1, 0.2, 0.3, 0.4)),
    (np.array([0.1, 0.2, 0.3, 0.4]), False, (0.1, 0.2, 0.3, 0.4)),
    ("joint3=1e-4, joint1=-2e-4", False, (-2e-4, 0, 1e-4, 0)),
    ({"joint3": 1e-4, "joint1": [-2e-4]}, False, (-2e-4, 0, 1e-4, 0)),
], ids=str)  # fmt: skip
def test_forms_of_joint_errors(given, degrees, expected):
    errors = ks.joint_errors(model_of("textbook:scara"), "tool", given, degrees=degrees)
    assert_same(errors, np.array(expected), atol=1e-15)


@pytest.mark.parametrize(("given", "error", "says"), [
    ("1,2", ks.UsageError, "2 joint errors are given, 4 are needed"),
    ("", ks.UsageError, "no joint error"),
    ("big", ks.UsageError, "'big' is no joint error"),
    ([[1, 2, 3, 4]], ks.UsageError, "no joint error"),
    ([], ks.UsageError, "no joint error"),
    (None, ks.UsageError, "no joint error"),
    ("nan", ks.UsageError, "joint error of 'joint1' is nan"),
    ("inf", ks.UsageError, "joint error of 'joint1' is inf"),
    ("4", ks.UsageError, "not a number below half a turn"),
    ("joint3=1e13", ks.UsageError, "not a number below 1e"),
    ("joint9=1", ks.UnknownNameError, "there is no joint 'joint9'"),
    ("joint1=a", ks.ConfigurationError, "'a' is not a number"),
    ("joint1=1 2", ks.ConfigurationError, "joint 'joint1' takes one joint error, not 2"),
    ("0.1,joint1=1", ks.ConfigurationError, "not of the form"),
    ("joint1=1,joint1=2", ks.ConfigurationError, "given twice"),
], ids=str)  # fmt: skip
def test_joint_errors_that_cannot_be_are_refused_in_a_line(given, error, says):
    with pytest.raises(error, match=says) as refused:
        ks.joint_errors(model_of("textbook:scara"), "tool", given)
    assert "\n" not in str(refused.value)


def test_a_joint_that_is_not_on_the_path_is_refused():
    with pytest.raises(ks.UsageError, match="joint 'panda_finger_joint1' does not move 'panda_hand'"):
        ks.joint_errors(model_of(PANDA[0]), "panda_hand", "panda_finger_joint1=0.001")
    with pytest.raises(ks.ConfigurationError, match="joint 'panda_finger_joint2' follows"):
        ks.joint_errors(model_of(PANDA[0]), "panda_leftfinger", "panda_finger_joint2=0.001")


def test_equal_errors_of_turns_and_slides_are_refused_and_one_number_leaves_slides_exact():
    model, q = model_of("textbook:scara"), np.zeros(4)
    with pytest.raises(ks.UsageError, match="some joints turn and others slide"):
        ks.tool_error(model, "tool", q)
    assert any("slide" in line for line in ks.tool_error(model, "tool", q, 0.001).warnings)
    assert ks.tool_error(model, "tool", q, (1e-3, 1e-3, 1e-4, 1e-3)).warnings == ()


def test_a_floating_base_errs_along_its_twist():
    model = model_of("textbook:planar_2r", floating_base=True)
    q = at("textbook:planar_2r", "random:4", floating_base=True)
    errors = ks.joint_errors(model, "tool", "root_joint.vx=0.01,root_joint.wz=0.002,joint2=0.001")
    result = ks.tool_error(model, "tool", q, errors)
    assert len(result.columns) == 8
    turned = ks.fk(model, "base", q).matrix[:3, :3]
    alone = ks.tool_error(model, "tool", q, ks.joint_errors(model, "tool", "root_joint=0.01 0 0 0 0 0"))
    assert_same(alone.displacement[:3], 0.01 * turned[:, 0])
    assert_same(alone.moved, alone.displacement)  # a shift is exact
    assert result.certificate.agree


# --- the way into a singular configuration --------------------------------------------------------------------------

WAYS = (
    ("textbook:planar_2r", "tool", "0.3,0.7", None, {}),
    ("textbook:planar_3r", "tool", "0.3,0.7,-0.4", None, {}),
    ("textbook:planar_3r", "tool", "0.3,0.7,-0.4", None, {"axes": "x y"}),
    ("textbook:anthropomorphic", "tool", "0.1,0.5,0.9", None, {}),
    ("textbook:stanford", "tool", "0.1,0.8,0.4,0.3,0.9,-0.2", None, {"reference": "local"}),
    ("textbook:scara", "tool", "0.1,0.8,0.1,0.3", None, {}),
    ("textbook:wrist_zyz", "tool", "0.1,0.8,0.4", None, {"axes": "rx ry rz"}),
    (*UR5, None, {}),
    (*UR5, "0.3,-1.2,0,-0.6,0.8,0.2", {"point": (0.1, 0, 0.2)}),
    (*PANDA, None, {}),
)


def way_of(source, frame, q, end, asked):
    key = repr((source, frame, q, end, asked))
    if key not in FOLLOWED:
        target = None if end is None else at(source, end)
        FOLLOWED[key] = ks.singular_approach(model_of(source), frame, at(source, q), target, **asked)
        assert FOLLOWED[key].certificate.agree is True
    return FOLLOWED[key]


def configurations(way):
    return way.shares[:, None] * way.start + (1 - way.shares[:, None]) * way.end


@pytest.mark.parametrize("asked", WAYS, ids=lambda asked: f"{asked[0]} {asked[4]}")
def test_the_rates_move_the_tool_in_the_worst_direction_at_the_wanted_speed(asked):
    """What placements say of the rates; and no rates of that size could move it less."""
    way = way_of(*asked)
    model, arm = way.mechanism.model, way.mechanism
    rows = list(arm.task.rows)
    arcs = np.where(np.array(rows) >= 3, way.length if arm.task.mixed else 1.0, 1.0)
    columns = model.robot.velocity_columns(dict.fromkeys(arm.joints))
    steps = configurations(way)
    assert (way.shares[0], way.shares[-1]) == (1, 0)
    assert np.all(np.diff(way.shares) < 0)
    for i in (0, 7, 15, 30):
        rates = np.zeros(model.robot.nv)
        rates[columns] = way.rates[i] / np.max(np.abs(way.rates[i]))
        twist = differences.twist(model.engine, model.robot, steps[i], rates, way.velocity)[rows] * arcs
        expected = way.directions[i] * way.speed / np.max(np.abs(way.rates[i]))
        sign = np.sign(twist @ expected)
        assert_same(sign * twist, expected, atol=2e-9)
        size = np.linalg.norm(way.rates[i] / arm.units)
        assert np.isclose(size, way.speed * way.motion[i], rtol=1e-6)


@pytest.mark.parametrize("asked", WAYS, ids=lambda asked: f"{asked[0]} {asked[4]}")
def test_what_grows_on_the_way_and_what_does_not(asked):
    way = way_of(*asked)
    assert way.singular
    assert way.motion[-1] == math.inf
    assert np.all(np.isinf(way.rates[-1]))
    # Near the end the singular value falls in proportion to what is left.
    slopes = way.smallest[20:31] / way.remaining[20:31]
    assert np.allclose(slopes, slopes[-1], rtol=0.05)
    assert np.max(way.worst) < 3 * np.min(way.worst)
    assert np.all(way.sigma <= way.worst * (1 + 1e-12))
    error = ks.tool_error(way.mechanism.model, way.velocity.of, way.end, way.joint_error,
                          point=way.mechanism.point, reference=asked[4].get("reference", "aligned"))  # fmt: skip
    part = error.translation if way.mechanism.task.linear else error.rotation
    if len(way.mechanism.task.linear) != 2:
        assert np.isclose(way.worst[-1], part.worst, rtol=1e-9)
        assert np.isclose(way.sigma[-1], part.sigma, rtol=1e-9)
    # The direction at the end is one that no joint moves, and the limit of those before it.
    arcs = [way.length if row >= 3 and way.mechanism.task.mixed else 1.0 for row in way.mechanism.task.rows]
    lost = way.directions[-1] * arcs
    assert np.max(np.abs(lost @ error.matrix[list(way.mechanism.task.rows)])) < 1e-7
    assert np.linalg.norm(way.directions[-1] - way.directions[-2]) < 0.02


def test_the_smallest_singular_value_of_a_planar_arm():
    way = way_of(*WAYS[0])
    q = configurations(way)
    s1, c1, s12, c12 = (f(a) for a in (q[:, 0], q[:, 0] + q[:, 1]) for f in (np.sin, np.cos))
    matrix = np.array([[-s1 - 0.8 * s12, -0.8 * s12], [c1 + 0.8 * c12, 0.8 * c12]]).transpose(2, 0, 1)
    assert_same(way.smallest, np.linalg.norm(matrix, 2, axis=(-2, -1)) ** -1 * 0.8 * np.abs(np.sin(q[:, 1])))
    assert_same(way.directions[-1], np.array([math.cos(0.3), math.sin(0.3), 0]))
    assert_same(way.remaining[0], np.array(0.7))


def test_the_way_leads_to_the_nearest_singular_configuration():
    for source, frame, q, _, asked in (WAYS[4], WAYS[7], WAYS[9]):
        found = ks.singular_at(model_of(source), frame, at(source, q), **asked).distance
        nearest = found.distance if found.inside is None else found.inside[0]
        way = way_of(source, frame, q, None, asked)
        assert np.isclose(way.remaining[0], nearest, rtol=1e-9)
        assert ks.singular_at(model_of(source), frame, way.end, **asked).singular


def test_rows_that_count_are_those_that_are_lost():
    assert way_of(*WAYS[0]).mechanism.task.row_names == ("vx", "vy", "vz")
    assert way_of(*WAYS[3]).mechanism.task.row_names == ("vx", "vy", "vz")
    assert len(way_of(*WAYS[7]).mechanism.task.rows) == 6  # a wrist moves the point all the same
    # The elbow of a Puma takes its wrist centre's translation along the arm.
    puma = model_of("textbook:puma560")
    q = ks.configuration(puma, "0.1,0.2,0.4,0.3,0.5,0.2").q
    tip = puma.robot.default_tip()
    bent = ks.singular_at(puma, tip, q, axes="xyz").distance.q
    end = q.copy()
    end[:] = bent
    way = ks.singular_approach(puma, tip, q, end)
    assert way.mechanism.task.row_names == ("vx", "vy", "vz")
    assert way.unit == "m"


@pytest.mark.parametrize("asked", [WAYS[0], WAYS[7], WAYS[9]], ids=lambda asked: asked[0])
def test_the_velocity_limit_is_reached_where_it_says(asked):
    way = way_of(*asked)
    left, joint = way.limit_at
    share = left / way.remaining[0]
    there = ks.singular_approach(
        way.mechanism.model, asked[1], share * way.start + (1 - share) * way.end, way.end, **asked[4]
    )
    assert np.isclose(there.utilisation[0], 1, rtol=0.02)
    used = np.abs(there.rates[0]) / there.limits
    assert way.names[int(np.argmax(used))] == joint
    slow = ks.singular_approach(way.mechanism.model, asked[1], way.start, way.end, speed=1e-9, **asked[4])
    assert slow.limit_at is None
    fast = ks.singular_approach(way.mechanism.model, asked[1], way.start, way.end, speed=1e3, **asked[4])
    assert fast.limit_at[0] == fast.remaining[0]


def test_a_followers_velocity_limit_binds_its_leader(tmp_path):
    text = """<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/><link name="e"/>
      <joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
        <limit effort="1" velocity="9"/></joint>
      <joint name="k" type="continuous"><origin xyz="1 0 0"/><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
        </joint>
      <joint name="t" type="fixed"><origin xyz="1 0 0"/><parent link="c"/><child link="d"/></joint>
      <joint name="f" type="continuous"><parent link="a"/><child link="e"/><axis xyz="0 0 1"/>
        <limit effort="1" velocity="3"/><mimic joint="j" multiplier="-2"/></joint></robot>"""
    path = tmp_path / "r.urdf"
    path.write_text(text)
    way = ks.singular_approach(ks.load(path), "d", np.array([0.1, 0.6]))
    assert_same(way.limits, np.array([1.5, math.inf]))


def test_joint_errors_and_speed_are_scales():
    source, frame, q, _, asked = WAYS[7]
    plain = way_of(source, frame, q, None, asked)
    twice = way_of(source, frame, q, None, {"joint_error": 0.002, "speed": 0.3})
    assert np.allclose(twice.worst, 2 * plain.worst, rtol=1e-12)
    assert np.allclose(twice.rates[:-1], 3 * plain.rates[:-1], rtol=1e-12)
    assert_same(twice.smallest, plain.smallest)


def test_a_way_that_ends_in_no_singular_configuration_says_so():
    way = way_of("textbook:planar_2r", "tool", "0.3,0.7", "0.3,0.5", {})
    assert not way.singular
    assert np.all(np.isfinite(way.motion))
    assert any("not singular" in line for line in way.warnings)


def test_a_singular_configuration_outside_limits_is_followed_with_a_warning(tmp_path):
    text = """<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
      <joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
      <joint name="k" type="revolute"><origin xyz="1 0 0"/><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
        <limit lower="0.5" upper="2" effort="1" velocity="1"/></joint>
      <joint name="t" type="fixed"><origin xyz="1 0 0"/><parent link="c"/><child link="d"/></joint></robot>"""
    path = tmp_path / "r.urdf"
    path.write_text(text)
    way = ks.singular_approach(ks.load(path), "d", np.array([0.1, 0.6]))
    assert any("outside joint limits" in line for line in way.warnings)
    assert not way.singular or way.end[1] == 0


@pytest.mark.parametrize(("q", "end", "asked", "says"), [
    ((0.3, 0.0), None, {}, "starts in a singular configuration"),
    ((0.3, 0.7), (0.3, 0.7), {}, "ends where it starts"),
    ((0.3, 0.7), None, {"speed": 0}, "tool speed is positive"),
    ((0.3, 0.7), None, {"speed": math.nan}, "tool speed is positive"),
    ((0.3, 0.7), None, {"axes": "foo"}, "no axis 'foo'"),
    ((0.3, 0.7), None, {"axes": "z"}, "no joint ever moves"),
    ((0.3, 0.7), None, {"reference": "world"}, "reference aligned or local"),
    ((0.3, 0.7), None, {"joint_error": (1, 2, 3)}, "3 joint errors are given"),
    ((0.3, 0.7), None, {"axes": "rz"}, "no singular configuration is found"),
    (((0.3, 0.7), (0.2, 0.1)), None, {}, "starts in one configuration"),
    ((0.3, 0.7), ((0.3, 0.7), (0.2, 0.1)), {}, "ends in one configuration"),
], ids=str)  # fmt: skip
def test_ways_that_cannot_be_are_refused(q, end, asked, says):
    with pytest.raises(ks.UsageError, match=says):
        ks.singular_approach(model_of("textbook:planar_2r"), "tool", np.array(q),
                             None if end is None else np.array(end), **asked)  # fmt: skip


def test_a_floating_base_has_no_way_into_a_singularity():
    model = model_of("textbook:planar_2r", floating_base=True)
    with pytest.raises(ks.UsageError, match="floating joint 'root_joint'"):
        ks.singular_approach(model, "tool", at("textbook:planar_2r", "zero", floating_base=True))
