"""Joint weights: what they make of joint rates; their limits, their slopes, and what they refuse."""

from math import exp

import numpy as np
import pytest

import kinetostat as ks
from differences import derivative
from kinetostat.analysis.weights import fixed_weights, limit_weights
from textbook_support import assert_same
from trees import load_text

LOWER, UPPER, SPEED = -0.7, 1.9, 2.5
MIDDLE, HALF = (LOWER + UPPER) / 2, (UPPER - LOWER) / 2


def arm(*joints):
    """Return an arm of joints along x that turn about z and y by turns; each is (type, what is in its element)."""
    lines = [f'<link name="l{i}"/>' for i in range(len(joints) + 1)]
    for i, (kind, body) in enumerate(joints):
        ends = f'<parent link="l{i}"/><child link="l{i + 1}"/><origin xyz="{0.5 * (i > 0)} 0.1 0"/>'
        lines.append(f'<joint name="j{i}" type="{kind}">{ends}<axis xyz="0 {i % 2} {1 - i % 2}"/>{body}</joint>')
    return load_text("".join(['<robot name="arm">', *lines, "</robot>"]))


def limit(lower=LOWER, upper=UPPER, speed=SPEED):
    return f'<limit lower="{lower}" upper="{upper}" effort="1" velocity="{speed}"/>'


def weights_of(model, q):
    return limit_weights(model.robot, model.robot.independent, np.asarray(q, dtype=float))


ONE = arm(("revolute", limit()))
THREE = arm(("revolute", limit()), ("continuous", limit(speed=3.0)), ("prismatic", limit(-0.2, 0.6, 0.4)))


# --- weights by limits ------------------------------------------------------------------------------------------------


def test_in_the_middle_the_weight_is_the_velocity_limit_and_there_is_no_penalty():
    weights = weights_of(THREE, [MIDDLE, 12.3, 0.2])
    assert_same(weights.factors, np.array([SPEED, 3.0, 0.4]))
    assert_same(weights.penalty, np.array(1.0))
    assert weights.outside == ()


def test_towards_a_limit_weight_and_penalty_fall_to_nothing_on_both_sides_alike():
    share = np.linspace(0, 1, 101)[:-1]
    above, below = (weights_of(ONE, (MIDDLE + side * share * HALF)[:, None]) for side in (1, -1))
    assert_same(above.factors, below.factors, 1e-9)
    assert_same(above.penalty, below.penalty, 1e-9)
    assert np.all(np.diff(above.factors[:, 0]) < 0)
    assert np.all(np.diff(above.penalty) < 0)
    near = weights_of(ONE, [[UPPER - 1e-9], [LOWER + 1e-9]])
    assert np.all(near.factors < 1e-8)
    assert np.all(near.penalty < 1e-8)


def test_the_weight_is_that_of_the_slope_of_chan_and_dubeys_criterion():
    """H = (u - l)^2 / (4 (u - q)(q - l)) is differenced here, not differentiated."""
    q = np.linspace(LOWER, UPPER, 42)[1:-1]

    def criterion(position):
        return (UPPER - LOWER) ** 2 / (4 * (UPPER - position) * (position - LOWER))

    slope = derivative(lambda t: criterion(q + t[:, None]), 1e-4)
    np.testing.assert_allclose(weights_of(ONE, q[:, None]).factors[:, 0], SPEED / np.sqrt(1 + abs(slope)), rtol=1e-6)


def test_the_penalty_is_tsais_normalised():
    """A quarter of the way, 4 (q - l)(u - q)/(u - l)^2 is 3/4; two such joints make 9/16 of it."""
    two = arm(("revolute", limit()), ("revolute", limit(0, 4)))
    quarter = LOWER + (UPPER - LOWER) / 4
    penalties = weights_of(two, [[quarter, 2.0], [MIDDLE, 3.0], [quarter, 1.0]]).penalty
    assert_same(penalties, np.array([1 - exp(-x) for x in (0.75, 0.75, 0.5625)]) / (1 - exp(-1)))


def test_the_slopes_of_weights_and_penalty_are_central_differences():
    generator = np.random.default_rng(1)
    share = generator.uniform(0.1, 0.9, (50, 3)) * generator.choice([-1, 1], (50, 3))
    q = np.array([MIDDLE, 0.0, 0.2]) + share * [HALF, 3.0, 0.4]
    weights = weights_of(THREE, q)
    for i in range(3):
        step = np.eye(3)[i]
        factors = derivative(lambda t, e=step: weights_of(THREE, q + t[:, None, None] * e).factors, 1e-4)
        penalty = derivative(lambda t, e=step: weights_of(THREE, q + t[:, None, None] * e).penalty, 1e-4)
        np.testing.assert_allclose(weights.derivatives[:, i], factors[:, i], rtol=1e-6, atol=1e-9)
        np.testing.assert_allclose(weights.penalty_gradient[:, i], penalty, rtol=1e-6, atol=1e-9)
        assert_same(np.delete(factors, i, axis=1), np.zeros((50, 2)), 1e-10)  # a weight hangs on its own joint alone


def test_a_continuous_joint_has_its_velocity_limit_everywhere():
    weights = weights_of(THREE, [[MIDDLE, angle, 0.2] for angle in (-100, -np.pi, 0, 1.0, np.pi, 100)])
    assert_same(weights.factors[:, 1], np.full(6, 3.0))
    assert_same(weights.derivatives[:, 1], np.zeros(6))
    assert_same(weights.penalty, np.ones(6))


@pytest.mark.parametrize("position", [UPPER, LOWER, UPPER + 0.5, LOWER - 10, 1e5])
def test_at_and_beyond_a_limit_nothing_counts_and_the_joint_is_named(position):
    weights = weights_of(THREE, [position, 0.0, 0.2])
    assert weights.factors[0] == 0
    assert weights.derivatives[0] == 0
    assert weights.penalty == 0
    assert weights.outside == ("j0",)
    assert np.all(np.isfinite(weights.penalty_gradient))
    result = ks.manipulability(THREE, "l3", np.array([position, 0.3, 0.2]), weights="limits")
    assert any("'j0' is at or beyond a limit: its weight is 0" in line for line in result.warnings)
    for block in result.blocks.values():
        assert block.penalised == 0
        assert np.all(np.isfinite(block.singular_values))
    # What is left is what the other two joints can do.
    frozen = ks.jacobian(THREE, "l3", np.array([position, 0.3, 0.2])).matrix[:, 1:] * [3.0, 0.4]
    expected = np.linalg.svd(frozen[:3], compute_uv=False)
    assert_same(result.blocks["translation"].singular_values, np.r_[expected, 0], 1e-12)


def test_an_infinite_range_is_no_range():
    open_ended = arm(("revolute", limit("-inf", 1.0)), ("prismatic", limit("-inf", "inf", 0.5)))
    weights = weights_of(open_ended, [0.3, -7.0])
    assert_same(weights.factors, np.array([SPEED, 0.5]))
    assert_same(weights.penalty, np.array(1.0))


@pytest.mark.parametrize(
    ("kind", "body"),
    [
        ("continuous", ""),
        ("continuous", '<limit effort="1" velocity="0"/>'),
        ("revolute", limit(speed=-1.0)),
        ("revolute", '<limit lower="0" upper="1" effort="1"/>'),
        ("prismatic", limit(speed="inf")),
    ],
)
def test_without_a_velocity_limit_the_joint_is_named(kind, body):
    model = arm(("revolute", limit()), (kind, body))
    with pytest.raises(ks.UsageError, match=r"joint 'j1' has no velocity limit.*--weights a,b,c"):
        ks.manipulability(model, "l2", np.zeros(2), weights="limits")


def test_joints_of_several_coordinates_have_no_limits_to_weigh_them_by():
    model = arm(("revolute", limit()), ("planar", '<limit effort="1" velocity="1"/>'))
    with pytest.raises(ks.UsageError, match="joint 'j1'"):
        ks.manipulability(model, "l2", np.zeros(4), weights="limits")
    assert ks.manipulability(model, "l2", np.zeros(4), weights=(1, 2, 3, 4)).blocks["full"].rank == 4


def test_a_follower_counts_by_its_leader():
    body = f'{limit()}<mimic joint="j0" multiplier="-2"/>'
    model = arm(("revolute", limit()), ("revolute", body))
    result = ks.manipulability(model, "l2", np.array([MIDDLE]), weights="limits")
    assert_same(result.weights.factors, np.array([SPEED]))
    column = ks.jacobian(model, "l2", np.array([MIDDLE])).matrix[:3, 0]
    assert_same(result.blocks["translation"].singular_values, np.array([SPEED * np.linalg.norm(column)]))


def test_a_batch_of_weights_is_one_by_one():
    q = np.random.default_rng(2).uniform(-0.15, 0.55, (2, 4, 3))
    many = weights_of(THREE, q)
    assert many.factors.shape == (2, 4, 3)
    for where in np.ndindex(2, 4):
        one = weights_of(THREE, q[where])
        for key in ("factors", "derivatives", "penalty", "penalty_gradient"):
            assert_same(getattr(many, key)[where], getattr(one, key))
    result = ks.manipulability(THREE, "l3", q, weights="limits")
    single = ks.manipulability(THREE, "l3", q[1, 2], weights="limits")
    assert_same(result.blocks["full"].penalised[1, 2], single.blocks["full"].penalised)
    assert_same(result.blocks["full"].gradients["penalised"][1, 2], single.blocks["full"].gradients["penalised"], 1e-9)


def test_the_penalised_index_is_the_index_in_the_middle_and_nothing_at_a_limit():
    model = arm(("revolute", limit()), ("revolute", limit()))
    middle, limited = (
        ks.manipulability(model, "l2", np.array(q), weights="limits").blocks["translation"]
        for q in ([MIDDLE, MIDDLE], [MIDDLE, UPPER])
    )
    assert_same(middle.penalised, middle.yoshikawa)
    assert limited.penalised == 0


# --- units -------------------------------------------------------------------------------------------------------


def test_columns_weighted_by_speeds_need_no_length_among_themselves():
    """Shares of each joint's speed are pure numbers, of slides and turns alike: a length divides linear rows alone."""
    stanford = ks.load("textbook:stanford")
    q = np.array([0.2, 0.7, 0.5, 0.1, 0.6, 0.2])
    mixed, scaled = (ks.manipulability(stanford, "tool", q, weights="limits", length=size) for size in ("none", 0.5))
    for name, unit in (("translation", "m/s"), ("rotation", "rad/s")):
        assert mixed.blocks[name].unit == scaled.blocks[name].unit == unit
        assert_same(scaled.blocks[name].singular_values, mixed.blocks[name].singular_values)
    full, same = scaled.blocks["full"], mixed.blocks["full"]
    assert (full.unit, same.unit) == ("1/s", "mixed")
    np.testing.assert_allclose(full.yoshikawa, same.yoshikawa / 0.5**3, rtol=1e-12)  # of three rows


# --- weights as given ---------------------------------------------------------------------------------------------


def test_given_weights_are_the_semi_axes_of_the_rates():
    """Rates within (qdot_1/a_1)^2 + ... <= 1 fill the ellipsoid."""
    q, weights = np.array([0.3, -0.4, 0.1]), np.array([0.5, 3.0, 1.5])
    block = ks.manipulability(THREE, "l3", q, weights=weights).blocks["rotation"]
    rates = np.random.default_rng(3).normal(size=(3, 5000))
    rates *= weights[:, None] / np.linalg.norm(rates, axis=0)
    speeds = np.linalg.norm(ks.jacobian(THREE, "l3", q).matrix[3:] @ rates, axis=0)
    assert np.max(speeds) <= block.singular_values[0] * (1 + 1e-12)
    assert np.max(speeds) > block.singular_values[0] * 0.99
    assert ks.manipulability(THREE, "l3", q, weights=weights).weights.penalty is None
    assert block.penalised is None


def test_equal_weights_scale_what_has_a_size_and_nothing_else():
    panda = ks.load("example:panda")
    q = ks.random_configurations(panda.robot, 4)
    plain, weighted = (ks.manipulability(panda, "panda_hand", q, weights=w) for w in (None, [3.0] * 7))
    for name, block in plain.blocks.items():
        other = weighted.blocks[name]
        np.testing.assert_allclose(other.singular_values, 3 * block.singular_values, rtol=1e-12)
        assert_same(other.isotropy, block.isotropy)
        assert_same(other.inverse_condition_number, block.inverse_condition_number)
        assert_same(other.force.lengths * 3, block.force.lengths, 1e-9)


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ((1, 2), "3 positive numbers"),
        ((1, 2, 3, 4), "3 positive numbers"),
        ((), "3 positive numbers"),
        ((1, 0, 1), "positive numbers between"),
        ((1, -2, 1), "positive numbers between"),
        ((1, np.nan, 1), "positive numbers between"),
        ((1, np.inf, 1), "positive numbers between"),
        ("speeds", "no weights 'speeds'"),
    ],
)
def test_weights_that_cannot_be_are_refused(weights, message):
    with pytest.raises(ks.UsageError, match=message):
        ks.manipulability(THREE, "l3", np.zeros(3), weights=weights)


def test_given_weights_do_not_change_with_the_configuration():
    weights = fixed_weights((1, 2.5), 2)
    assert_same(weights.factors, np.array([1, 2.5]))
    assert_same(weights.derivatives, np.zeros(2))
