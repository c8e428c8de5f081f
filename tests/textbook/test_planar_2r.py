"""Rows A3 to A6: the planar arm of two links."""

import numpy as np
import pytest

import kinetostat as ks
from textbook_support import (
    angles,
    assert_same,
    jacobian_of,
    matrix_of,
    placement_of,
    planar_tip,
    singular_values,
    textbook,
    vector_of,
)

FIRST, SECOND = 1.0, 0.8
LENGTHS = {"planar_2r": (1.0, 0.8), "planar_2r_6_3": (6.0, 3.0), "planar_2r_isotropic": (np.sqrt(2), 1.0)}
REACH = 9.0
FOLDED_120 = 3 * np.sqrt(3)  # distance of the tip at joint2 = 120 degrees: sqrt(36 + 9 - 18)


def planar_block(name, q, **asked):
    """Return the 2x2 of the rows vx and vy; the rows vz, wx and wy are zero and wz is (1, 1)."""
    matrix = jacobian_of(name, "tool", q, **asked)
    assert_same(matrix[..., 2:, :], np.broadcast_to([[0.0, 0], [0, 0], [0, 0], [1, 1]], (*matrix.shape[:-2], 4, 2)))
    return matrix[..., :2, :]


# --- A3 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", LENGTHS)
def test_a3_jacobian_in_the_base(name):
    first, second = LENGTHS[name]
    q = angles(2, seed=3)
    sum_ = q.sum(-1)
    expected = matrix_of(
        [
            [-first * np.sin(q[:, 0]) - second * np.sin(sum_), -second * np.sin(sum_)],
            [first * np.cos(q[:, 0]) + second * np.cos(sum_), second * np.cos(sum_)],
        ]
    )
    assert_same(planar_block(name, q), expected, atol=1e-12 * (first + second))


@pytest.mark.parametrize("name", LENGTHS)
def test_a3_jacobian_in_the_tip_frame(name):
    first, second = LENGTHS[name]
    q = angles(2, seed=4)
    sine, cosine = np.sin(q[:, 1]), np.cos(q[:, 1])
    expected = matrix_of([[first * sine, 0], [first * cosine + second, second]])
    assert_same(planar_block(name, q, reference="local"), expected, atol=1e-12 * (first + second))
    assert_same(planar_block(name, q, expressed_in="tool"), expected, atol=1e-12 * (first + second))


@pytest.mark.parametrize("name", LENGTHS)
@pytest.mark.parametrize("reference", ["aligned", "local"])
def test_a3_determinant_is_that_of_the_elbow(name, reference):
    first, second = LENGTHS[name]
    q = angles(2, seed=5)
    determinant = np.linalg.det(planar_block(name, q, reference=reference))
    assert_same(determinant, first * second * np.sin(q[:, 1]), atol=1e-12 * (first + second) ** 2)


def test_a3_tip_velocity_in_the_tip_frame():
    q = angles(2, seed=6)
    rates = np.random.default_rng(7).normal(size=(len(q), 2))
    velocity = np.einsum("nij,nj->ni", jacobian_of("planar_2r", "tool", q, reference="local"), rates)
    along = FIRST * np.sin(q[:, 1]) * rates[:, 0]
    across = FIRST * np.cos(q[:, 1]) * rates[:, 0] + SECOND * rates.sum(-1)
    assert_same(velocity, vector_of(along, across, 0, 0, 0, rates.sum(-1)), atol=1e-11)


@pytest.mark.parametrize("name", LENGTHS)
def test_a3_tip(name):
    q = angles(2, seed=7)
    assert_same(placement_of(name, "tool", q), planar_tip(LENGTHS[name], q), atol=1e-12 * sum(LENGTHS[name]))


# --- A4 ---------------------------------------------------------------------------------------------------------


def rates_along_x(q):
    """Return the joint rates that move the tip along x at 1 m/s."""
    return np.linalg.solve(planar_block("planar_2r", q), np.array([1.0, 0.0])[:, None])[..., 0]


def a4(q):
    both = np.cos(q.sum(-1)) / (FIRST * np.sin(q[..., 1]))
    return vector_of(both, -np.cos(q[..., 0]) / (SECOND * np.sin(q[..., 1])) - both)


def test_a4_joint_rates_for_one_metre_per_second_along_x():
    generator = np.random.default_rng(8)
    q = vector_of(
        generator.uniform(-np.pi, np.pi, 40), generator.uniform(0.2, np.pi - 0.2, 40) * generator.choice([-1, 1], 40)
    )
    assert_same(rates_along_x(q), a4(q), atol=1e-11)


def test_a4_rates_grow_without_bound_towards_the_stretched_arm():
    elbow = 10.0 ** -np.arange(1, 8)
    q = vector_of(0.4, elbow)
    rates = rates_along_x(q)
    np.testing.assert_allclose(rates, a4(q), rtol=1e-7)
    # Near q2 = 0 they go as 1/sin q2: a tenth of the angle, ten times the rate.
    np.testing.assert_allclose(rates[-1] / rates[-2], [10, 10], rtol=1e-5)
    assert np.all(np.abs(rates[-1]) > 1e6)


# --- A5 ---------------------------------------------------------------------------------------------------------


def test_a5_determinant_is_eighteen_times_the_sine_of_the_elbow():
    q = angles(2, seed=9)
    assert_same(np.linalg.det(planar_block("planar_2r_6_3", q)), 18 * np.sin(q[:, 1]), atol=1e-10)


@pytest.mark.parametrize(("elbow", "radius"), [(0.0, 9.0), (np.pi, 3.0), (-np.pi, 3.0)])
def test_a5_singular_with_the_tip_on_a_circle(elbow, radius):
    q = vector_of(np.linspace(-np.pi, np.pi, 17), elbow)
    values = singular_values(planar_block("planar_2r_6_3", q))
    assert np.all(values[:, 1] < 1e-14 * values[:, 0])
    tip = placement_of("planar_2r_6_3", "tool", q)[:, :2, 3]
    assert_same(np.hypot(*tip.T), np.full(17, radius))


def test_a5_regular_between_the_circles():
    elbow = np.linspace(0.05, np.pi - 0.05, 25)
    q = np.concatenate([vector_of(0.7, elbow), vector_of(0.7, -elbow)])
    radius = np.hypot(*placement_of("planar_2r_6_3", "tool", q)[:, :2, 3].T)
    assert np.all((radius > 3) & (radius < 9))
    assert np.all(singular_values(planar_block("planar_2r_6_3", q))[:, 1] > 0.05)


def limits(name):
    return [textbook(name).robot.joint_by_name[joint].limit.range for joint in ("joint1", "joint2")]


def test_a5_limits_are_read_as_degrees_135_and_120():
    assert_same(np.degrees(limits("planar_2r_6_3")), [[0, 135], [0, 120]], atol=1e-13)


def test_a5_workspace_inside_limits_is_a_turned_arc():
    """At joint2 = t the tip is at distance sqrt(45 + 36 cos t), atan2(3 sin t, 6 + 3 cos t) ahead of joint1."""
    q = ks.random_configurations(textbook("planar_2r_6_3").robot, 5, (400,))
    tip = placement_of("planar_2r_6_3", "tool", q)[:, :3, 3]
    radius = np.hypot(tip[:, 0], tip[:, 1])
    assert_same(tip[:, 2], np.zeros(400))
    assert np.all((radius >= FOLDED_120) & (radius <= REACH))
    elbow = np.arccos((radius**2 - 45) / 36)
    ahead = np.arctan2(3 * np.sin(elbow), 6 + 3 * np.cos(elbow))
    assert np.all((ahead >= 0) & (ahead <= np.pi / 6))  # 30 degrees at joint2 = 120
    waist = np.arctan2(tip[:, 1], tip[:, 0]) - ahead
    assert np.all((waist >= -1e-7) & (waist <= np.radians(135) + 1e-7))
    assert_same(vector_of(waist, elbow), q, atol=1e-7)


def test_a5_corners_of_the_workspace():
    corners = placement_of("planar_2r_6_3", "tool", np.radians([[0, 0], [135, 0], [0, 120], [135, 120]]))[:, :2, 3]
    half = np.sqrt(0.5)
    inner = FOLDED_120 * np.array([np.cos(np.radians(30)), np.sin(np.radians(30))])
    turned = FOLDED_120 * np.array([np.cos(np.radians(165)), np.sin(np.radians(165))])
    assert_same(corners, np.array([[9, 0], [-9 * half, 9 * half], inner, turned]))


def test_a5_workspace_area_is_the_integral_of_the_determinant():
    """One elbow inside limits, so the area is the integral of abs(det J): 3/8 of the ring between sqrt(27) and 9."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    (_, waist), (_, elbow) = limits("planar_2r_6_3")
    q = np.stack(np.meshgrid((nodes + 1) * waist / 2, (nodes + 1) * elbow / 2, indexing="ij"), -1)
    determinants = np.abs(np.linalg.det(planar_block("planar_2r_6_3", q)))
    area = waist * elbow / 4 * weights @ determinants @ weights
    assert_same(area, 3 / 8 * np.pi * (81 - 27), atol=1e-10)


# --- A6 ---------------------------------------------------------------------------------------------------------


def semi_axes(name, elbow):
    """Return the roots of the eigenvalues of [[a, b], [b, c]] = J^T J by the quadratic formula, the larger first."""
    first, second = LENGTHS[name]
    a = first**2 + second**2 + 2 * first * second * np.cos(elbow)
    b = second**2 + first * second * np.cos(elbow)
    c = second**2
    middle, spread = (a + c) / 2, np.sqrt(((a - c) / 2) ** 2 + b**2)
    return vector_of(np.sqrt(middle + spread), first * second * np.abs(np.sin(elbow)) / np.sqrt(middle + spread))


@pytest.mark.parametrize("name", LENGTHS)
def test_a6_entries_of_the_gram_matrix(name):
    first, second = LENGTHS[name]
    q = angles(2, seed=10)
    block = planar_block(name, q)
    mixed = first * second * np.cos(q[:, 1])
    expected = matrix_of([[first**2 + second**2 + 2 * mixed, second**2 + mixed], [second**2 + mixed, second**2]])
    assert_same(np.swapaxes(block, 1, 2) @ block, expected, atol=1e-12 * (first + second) ** 2)


@pytest.mark.parametrize("name", LENGTHS)
@pytest.mark.parametrize("reference", ["aligned", "local"])
def test_a6_semi_axes_of_the_velocity_ellipse(name, reference):
    q = angles(2, seed=11)
    values = singular_values(planar_block(name, q, reference=reference))
    assert_same(values, semi_axes(name, q[:, 1]), atol=1e-11)


@pytest.mark.parametrize("name", LENGTHS)
def test_a6_ellipse_is_the_same_at_every_waist(name):
    waist = np.linspace(-np.pi, np.pi, 13)
    values = singular_values(planar_block(name, vector_of(waist, 1.1)))
    assert_same(values, np.broadcast_to(semi_axes(name, np.float64(1.1)), (13, 2)), atol=1e-11)


@pytest.mark.parametrize("name", LENGTHS)
def test_a6_manipulability_is_the_product_of_the_semi_axes(name):
    first, second = LENGTHS[name]
    q = angles(2, seed=12)
    product = singular_values(planar_block(name, q)).prod(-1)
    assert_same(product, first * second * np.abs(np.sin(q[:, 1])), atol=1e-12 * (first + second) ** 2)


@pytest.mark.parametrize("elbow", [np.radians(135), -np.radians(135)])
def test_a6_isotropic_at_135_degrees_when_the_first_link_is_root_two_longer(elbow):
    values = singular_values(planar_block("planar_2r_isotropic", vector_of(np.linspace(-3, 3, 7), elbow)))
    assert_same(values, np.ones((7, 2)))  # a circle of radius l2 = 1


@pytest.mark.parametrize("name", ["planar_2r", "planar_2r_6_3"])
def test_a6_no_other_ratio_is_isotropic_anywhere(name):
    values = singular_values(planar_block(name, vector_of(0.2, np.linspace(0, np.pi, 721))))
    assert np.min(values[:, 0] / np.maximum(values[:, 1], 1e-300)) > 1.15


def test_a6_root_two_is_isotropic_nowhere_else():
    elbow = np.radians(np.linspace(0, 180, 721))
    values = singular_values(planar_block("planar_2r_isotropic", vector_of(0.2, elbow)))
    ratio = values[:, 1] / values[:, 0]
    assert np.argmax(ratio) == 540  # 135 degrees
    assert np.sum(ratio > 0.998) == 1
