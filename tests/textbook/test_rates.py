"""Rows A4 and A18: joint rates of the arm of two links, and what pseudo-inverses satisfy."""

import numpy as np
import pytest

import kinetostat as ks
from textbook_support import angles, assert_same, command_line, jacobian_of, textbook

LENGTHS = {"planar_2r": (1.0, 0.8), "planar_2r_6_3": (6.0, 3.0), "planar_2r_isotropic": (np.sqrt(2), 1.0)}
X, Y = np.eye(6)[:2]


def rates_of(name, q, twist, *, frame="tool", **asked):
    """Return the certified result of a textbook robot."""
    found = ks.resolved_rates(textbook(name), frame, np.asarray(q, dtype=float), twist, **asked)
    assert found.certificate.engines == ("pinocchio", "screw")
    assert found.certificate.agree is True, found.certificate
    return found


def along_x(first, second, q1, q2):
    """Return A4: the rates that move the tip of two links along x at 1 m/s."""
    one = np.cos(q1 + q2) / (first * np.sin(q2))
    return np.stack([one, -np.cos(q1) / (second * np.sin(q2)) - one], -1)


# --- A4 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", LENGTHS)
def test_a4_moving_the_tip_along_x(name):
    q = angles(2, seed=41)
    q = q[np.abs(np.sin(q[:, 1])) > 0.05]
    found = rates_of(name, q, X, axes="xy")
    expected = along_x(*LENGTHS[name], q[:, 0], q[:, 1])
    assert_same(found.rates, expected, atol=1e-10)
    assert np.all(found.exact)
    assert np.all(found.rank == 2)
    assert_same(found.residual, np.zeros((len(q), 6)), atol=1e-11)


@pytest.mark.parametrize("axes", ["x y", "xy", "vx,vy", ["x", "y"]])
def test_a4_the_rows_by_any_spelling(axes):
    assert_same(rates_of("planar_2r", [0.3, 0.7], X, axes=axes).rates, along_x(1.0, 0.8, 0.3, 0.7))


@pytest.mark.parametrize("scale", [-1.0, 1e-6, 1e3])
def test_a4_rates_are_as_large_as_the_speed(scale):
    found = rates_of("planar_2r", [0.3, 0.7], scale * X, axes="xy")
    assert_same(found.rates, scale * along_x(1.0, 0.8, 0.3, 0.7), atol=1e-12 * max(1.0, abs(scale)))
    assert found.amplification == pytest.approx(
        rates_of("planar_2r", [0.3, 0.7], X, axes="xy").amplification, rel=1e-12
    )


@pytest.mark.parametrize("turned", [0.0, np.pi], ids=["stretched", "folded"])
@pytest.mark.parametrize("name", LENGTHS)
def test_a4_rates_grow_without_bound_towards_a_singular_configuration(name, turned):
    """As 1 / sin q2: rates times the angle that is left tend to a constant, and none is called exact at the end."""
    first, second = LENGTHS[name]
    steps = np.array([1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7])
    q = np.stack([np.full(7, 0.4), turned + steps], -1)
    found = rates_of(name, q, X, axes="xy")
    sizes = np.linalg.norm(found.rates, axis=-1)
    assert np.all(np.diff(sizes) > 0)
    assert_same(found.rates / along_x(first, second, q[:, 0], q[:, 1]), np.ones((7, 2)), atol=1e-7)
    assert sizes[-1] / sizes[0] > 9e5
    assert np.all(found.exact)
    assert np.all(np.diff(found.amplification) > 0)
    # det J = l1 l2 s2 (A3) is the product of both singular values.
    product = np.prod(found.singular_values, axis=-1)
    assert_same(product / (first * second * np.abs(np.sin(q[:, 1]))), np.ones(7), atol=1e-8)


@pytest.mark.parametrize("turned", [0.0, np.pi], ids=["stretched", "folded"])
def test_a4_at_the_singular_configuration_the_line_of_the_arm_is_lost(turned):
    q = np.array([0.4, turned])
    reach = 1 + 0.8 * np.cos(turned)
    outwards, across = np.array([np.cos(0.4), np.sin(0.4)]), np.array([-np.sin(0.4), np.cos(0.4)])
    lost = rates_of("planar_2r", q, np.r_[outwards, 0, 0, 0, 0], axes="xy")
    assert lost.rank == 1
    assert not lost.exact
    assert_same(lost.rates, np.zeros(2))
    assert_same(lost.residual[:2], outwards)
    # Across the line the tip goes round at reach q1' + l2 c q2': the least such rates are along that row.
    row = np.array([reach, 0.8 * np.cos(turned)])
    kept = rates_of("planar_2r", q, np.r_[across, 0, 0, 0, 0], axes="xy")
    assert kept.exact
    assert_same(kept.rates, row / (row @ row))


@pytest.mark.parametrize("step", [0.3, 0.05, 1e-3])
def test_a4_a_straight_line_outwards_comes_to_the_singular_configuration(step):
    """The smallest singular value falls as the arm stretches, rises as it folds."""
    q = np.array([-step / 2, step])
    assert rates_of("planar_2r", q, X, axes="xy").approach < 0
    assert rates_of("planar_2r", q, -X, axes="xy").approach > 0


@pytest.mark.parametrize("damping", [0.01, 0.1, 1.0])
def test_a4_damping_bounds_the_rates_and_its_price_is_shown(damping):
    """No direction is asked for more than half of 1 / damping; at a stretched arm a lost one costs nothing."""
    steps = np.array([1.0, 0.1, 1e-2, 1e-3, 1e-5, 1e-8, 0.0])
    q = np.stack([np.full(7, 0.4), steps], -1)
    found = rates_of("planar_2r", q, X, axes="xy", damping=damping)
    assert np.all(np.linalg.norm(found.rates, axis=-1) <= 0.5 / damping + 1e-12)
    assert not np.any(found.exact)
    given = np.einsum("...rc,...c->...r", jacobian_of("planar_2r", "tool", q), found.rates)
    assert_same(found.residual[:, :2], X[:2] - given[:, :2])
    # At the stretched arm one singular value s is left, and the row of it: what is left of it is l^2 / (s^2 + l^2).
    across = np.array([-np.sin(0.4), np.cos(0.4)])
    square = 1.8**2 + 0.8**2
    assert_same(found.residual[-1, :2] @ across, (X[:2] @ across) * damping**2 / (square + damping**2))


def test_a4_through_the_command_line():
    result = command_line("rates", "textbook:planar_2r", "-q", "30,60", "--deg", "--axes", "x", "y", "--twist", "1,0")[
        "result"
    ]
    expected = along_x(1.0, 0.8, np.pi / 6, np.pi / 3)  # c12 = 0: only the elbow moves
    assert_same(np.array(list(result["rates"].values())), expected)
    assert list(result["rates"]) == ["joint1", "joint2"]
    assert result["column_units"] == ["rad/s", "rad/s"]
    assert result["exact"] is True
    assert result["rank"] == 2
    assert result["binding_joint"] == "joint2"
    assert result["utilisation"]["joint2"] == pytest.approx(1.25 / 3)  # the file's limit: 3 rad/s


def test_a4_growth_through_the_command_line():
    """A tenth of the angle, ten times the rates."""
    sizes = []
    for angle in ("1e-2", "1e-3", "1e-4"):
        result = command_line("rates", "textbook:planar_2r", "-q", f"0.4,{angle}", "--axes", "xy", "--twist", "1,0")[
            "result"
        ]
        sizes.append(np.linalg.norm(list(result["rates"].values())))
        assert result["amplification"] > 10
    assert sizes[1] / sizes[0] == pytest.approx(10, rel=0.03)
    assert sizes[2] / sizes[1] == pytest.approx(10, rel=3e-3)


# --- A18 --------------------------------------------------------------------------------------------------------


def block_of(name, q, rows, frame="tool"):
    """Return the rows that count of the certified Jacobian. (..., m, n)."""
    return jacobian_of(name, frame, q)[..., rows, :]


def weighted_inverse(block, cost):
    """Return A18: W^-1 J^T (J W^-1 J^T)^-1."""
    lighter = np.swapaxes(block, -1, -2) / cost[:, None]
    return lighter @ np.linalg.inv(block @ lighter)


REDUNDANT = [("planar_3r", "x y", [0, 1]), ("anthropomorphic", "x z", [0, 2]), ("puma560", "xyz", [0, 1, 2])]


@pytest.mark.parametrize("cost", ["equal", "weighted"])
@pytest.mark.parametrize(("name", "axes", "rows"), REDUNDANT)
def test_a18_the_weighted_pseudo_inverse(name, axes, rows, cost):
    q = ks.random_configurations(textbook(name).robot, 18, (10,))
    block = block_of(name, q, rows)
    q = q[np.linalg.cond(block @ np.swapaxes(block, -1, -2)) < 1e3]
    block, count = block_of(name, q, rows), block.shape[-1]
    assert len(q) > 2
    weights = np.ones(count) if cost == "equal" else np.geomspace(0.2, 7, count)
    wanted = np.zeros((len(q), 6))
    wanted[:, rows] = np.random.default_rng(18).normal(size=(len(q), len(rows)))
    found = rates_of(name, q, wanted, axes=axes, weights=None if cost == "equal" else weights)
    expected = np.einsum("...cr,...r->...c", weighted_inverse(block, weights), wanted[:, rows])
    assert_same(found.rates, expected, atol=1e-10)
    assert np.all(found.exact)


def test_a18_a_jacobian_times_its_inverse_is_one():
    """Fed with unit twists, the rates are the columns of J+; with redundancy J J+ = 1."""
    q = np.array([0.3, 0.7, -0.4])
    for weights in (None, [1, 2, 3], "limits"):
        units = rates_of("planar_3r", np.broadcast_to(q, (2, 3)), np.stack([X, Y]), axes="xy", weights=weights)
        assert_same(block_of("planar_3r", q, [0, 1]) @ units.rates.T, np.eye(2))


@pytest.mark.parametrize("weights", [None, [1, 2, 3], "limits"])
def test_a18_the_projector_gives_no_twist_and_changes_nothing_twice(weights):
    q = np.array([0.3, 0.7, -0.4])
    block, seen = block_of("planar_3r", q, [0, 1]), []
    for unit in np.eye(3):
        found = rates_of("planar_3r", q, np.zeros(6), axes="xy", weights=weights, secondary=unit)
        assert_same(block @ found.rates, np.zeros(2))
        seen.append(found.rates)
    projector = np.stack(seen, -1)
    assert_same(projector @ projector, projector)
    assert np.linalg.matrix_rank(projector, tol=1e-9) == 1
    cost = np.ones(3) if weights is None else np.array(weights) if weights != "limits" else np.array([2.0, 3, 3]) ** -2
    inverse = weighted_inverse(block, cost)
    assert_same(projector, np.eye(3) - inverse @ block)


@pytest.mark.parametrize("name", LENGTHS)
def test_a18_more_rows_than_joints_is_least_squares(name):
    """Normal equations of the two rows in m and of the turn in units of the length that the result states."""
    q = np.array([0.3, 1.1])
    wanted = np.array([0.4, -0.2, 0, 0, 0, 0.9])
    found = rates_of(name, q, wanted, axes="x y rz")
    units = np.array([found.length, found.length, 1.0])
    block = block_of(name, q, [0, 1, 5]) / units[:, None]
    expected = np.linalg.solve(block.T @ block, block.T @ (wanted[[0, 1, 5]] / units))
    assert_same(found.rates, expected, atol=1e-11)
    assert not found.exact
    assert found.rank == 2


def test_a18_least_squares_in_metres_alone():
    """Two joints, three linear rows: no length is needed. The one that is out of the plane is left whole."""
    q = np.array([0.3, 1.1])
    found = rates_of("planar_2r", q, [0.1, 0.2, 0.3, 0, 0, 0], axes="xyz")
    assert_same(found.residual, np.array([0, 0, 0.3, 0, 0, 0]))
    assert_same(found.rates, np.linalg.solve(block_of("planar_2r", q, [0, 1]), [0.1, 0.2]))
    assert not found.exact


def test_a18_weights_of_the_files_limits():
    """2, 3 and 3 rad/s: the cost of motion is one over their squares."""
    q = np.array([0.3, 0.7, -0.4])
    found = rates_of("planar_3r", q, X, axes="xy", weights="limits")
    assert_same(found.limits, np.array([2.0, 3, 3]))
    assert_same(found.weights, np.array([1 / 4, 1 / 9, 1 / 9]))
    by_numbers = rates_of("planar_3r", q, X, axes="xy", weights=[9, 4, 4])
    assert_same(found.rates, by_numbers.rates)


def test_a18_through_the_command_line():
    asked = ("rates", "textbook:planar_3r", "-q", "0.3,0.7,-0.4", "--axes", "xy", "--twist", "0.1,-0.2")
    result = command_line(*asked, "--weights", "1,2,3", "--secondary", "1,0,0")["result"]
    block = block_of("planar_3r", [0.3, 0.7, -0.4], [0, 1])
    inverse = weighted_inverse(block, np.array([1.0, 2, 3]))
    free = (np.eye(3) - inverse @ block)[:, 0]
    assert_same(np.array(list(result["rates"].values())), inverse @ [0.1, -0.2] + free)
    assert_same(np.array(list(result["null_space_rates"].values())), free)
    assert result["weights"] == [1, 2, 3]
    assert result["secondary"] == "given"
    assert_same(result["residual"], np.zeros(2))


def test_a18_least_squares_through_the_command_line():
    asked = ("rates", "textbook:planar_2r", "-q", "0.3,1.1", "--axes", "xyz", "--twist", "0.1,0.2,0.3")
    result = command_line(*asked)["result"]
    assert_same(result["residual"], np.array([0, 0, 0.3]))
    assert result["exact"] is False
    assert_same(
        np.array(list(result["rates"].values())),
        np.linalg.solve(block_of("planar_2r", [0.3, 1.1], [0, 1]), [0.1, 0.2]),
    )
