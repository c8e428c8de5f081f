"""Joint rates from a twist: laws of pseudo-inverses, at random, real and odd robots, near and at singular ones."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.linalg import null_space

import differences
import kinetostat as ks
from kinetostat.analysis.task import Task
from kinetostat.analysis.weighted_inverse import WeightedInverse
from kinetostat.engines.pinocchio import PinocchioEngine
from kinetostat.engines.screw import ScrewEngine
from trees import load_text, random_tree

ARMS = {
    "example:ur5_robot": "tool0",
    "example:panda": "panda_hand",
    "textbook:puma560": "tool",
    "textbook:stanford": "tool",
    "textbook:scara": "tool",
    "textbook:planar_2r": "tool",
    "textbook:planar_3r": "tool",
    "textbook:helical": "tool",
    "textbook:rp": "tool",
    "textbook:wrist_zyz": "tool",
}
REDUNDANT = [
    ("example:panda", None),
    ("example:panda", "xyz"),
    ("example:ur5_robot", "xyz"),
    ("textbook:stanford", "xy rz"),
]
SOME_TWIST = np.array([0.1, 0.2, 0.3, 0.1, -0.2, 0.3])
UR5, PANDA, TWO = "example:ur5_robot", "example:panda", "textbook:planar_2r"


@cache
def load(name: str) -> ks.Model:
    return ks.load(name)


def tip(model: ks.Model, name: str = "") -> str:
    return ARMS.get(name) if ARMS.get(name) in model.robot.link_by_name else model.robot.default_tip()


def rates(name: str, q: Any, twist: Any, **asked: Any) -> ks.ResolvedRates:
    model = load(name)
    return ks.resolved_rates(model, tip(model, name), np.asarray(q, dtype=float), twist, **asked)


def jacobian(name: str, q: Any, **asked: Any) -> np.ndarray:
    model = load(name)
    return ks.jacobian(model, tip(model, name), np.asarray(q, dtype=float), **asked).matrix


def some(name: str, seed: int, shape: tuple[int, ...] = ()) -> np.ndarray:
    """Return configurations inside limits, away from zero."""
    return ks.random_configurations(load(name).robot, seed, shape)


def units(found: ks.ResolvedRates) -> tuple[np.ndarray, np.ndarray]:
    """Return what a unit of each row that counts is, and of each column, in m or rad: by what the result says of it."""
    rows = np.where(np.array(found.task.rows) < 3, found.length if found.task.mixed else 1.0, 1.0)
    slides = np.array([unit == "m/s" for unit in found.column_units])
    columns = np.where(slides, found.length, 1.0) if found.weights is None else 1 / np.sqrt(found.weights)
    return rows, columns


def pure(found: ks.ResolvedRates, matrix: np.ndarray) -> np.ndarray:
    """Return the rows that count of a Jacobian (..., 6, n) in those units."""
    rows, columns = units(found)
    return matrix[..., list(found.task.rows), :] * columns / rows[:, None]


def assert_certified(found: ks.ResolvedRates) -> None:
    assert found.certificate.engines == ("pinocchio", "screw")
    assert found.certificate.agree is True, found.certificate


# --- exact -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("floating", [False, True], ids=["fixed base", "floating base"])
@pytest.mark.parametrize("seed", range(30))
def test_a_twist_that_joints_can_give_is_given(seed: int, floating: bool) -> None:
    """Of any frame seen from any other, over joints of every type; what it gives is asked of the engine."""
    model, random = random_tree(seed, floating_base=floating), np.random.default_rng(seed)
    robot = model.robot
    names = [link.name for link in robot.links]
    pairs = [(a, b) for a in names for b in names if robot.movable_path(b, a)]
    if not pairs:
        return  # a robot that does not move: its refusal is tested elsewhere
    frame, observer = pairs[int(random.integers(len(pairs)))]
    q = ks.random_configurations(robot, seed, (4,))
    label = {"relative_to": observer, "reference": ["aligned", "local", "world"][seed % 3]}
    matrix = ks.jacobian(model, frame, q, **label).matrix
    wanted = np.einsum("...rc,...c->...r", matrix, random.uniform(-1, 1, (4, matrix.shape[-1])))
    found = ks.resolved_rates(model, frame, q, wanted, **label)
    assert_certified(found)
    given = np.einsum("...rc,...c->...r", matrix, found.rates)
    size = 1 + np.abs(found.rates).max()
    np.testing.assert_allclose(given, wanted, atol=1e-9 * size * max(1, robot.reach))
    assert np.all(found.exact)
    np.testing.assert_allclose(wanted - given, found.residual, atol=1e-12 * size * max(1, robot.reach))
    # Of all of the robot's coordinates: through the engine's Jacobian of everything, the same twist.
    everything = ks.jacobian(model, frame, q, joints="all", **label).matrix
    np.testing.assert_allclose(np.einsum("...rc,...c->...r", everything, found.whole), given, atol=1e-12 * size)
    assert np.count_nonzero(found.whole) <= np.count_nonzero(found.rates)


@pytest.mark.parametrize("name", ARMS)
def test_no_twist_takes_no_rates(name: str) -> None:
    found = rates(name, some(name, 1), np.zeros(6))
    assert not np.any(found.rates)
    assert not np.any(found.residual)
    assert found.exact
    assert found.amplification == 0


@pytest.mark.parametrize("name", ["textbook:planar_1r", "textbook:skew_1p"])
def test_a_robot_with_one_joint(name: str) -> None:
    matrix = jacobian(name, [0.4])
    found = rates(name, [0.4], 3 * matrix[:, 0])
    np.testing.assert_allclose(found.rates, [3], atol=1e-14)
    assert found.exact
    assert found.rank == 1
    assert_certified(found)
    across = null_space(matrix.T)[:, 0]
    assert not rates(name, [0.4], matrix[:, 0] + across).exact


def test_a_follower_turns_with_its_leader() -> None:
    """The fingers of a hand have one joint between them; seen from each other they part at twice its speed."""
    found = ks.resolved_rates(
        load(PANDA), "panda_leftfinger", np.full(8, 0.01), [0, 0.1, 0, 0, 0, 0], relative_to="panda_rightfinger"
    )
    assert found.columns == ("panda_finger_joint1",)
    assert found.rates == pytest.approx(0.05)
    assert found.exact


# --- Moore and Penrose -----------------------------------------------------------------------------------------------


def inverse_of(name: str, q: np.ndarray, **asked: Any) -> tuple[np.ndarray, ks.ResolvedRates]:
    """Return the matrix (n, m) that takes a twist's rows that count to rates: rates of unit twists, and one of them."""
    rows = rates(name, q, np.zeros(6), **asked).task.rows
    found = rates(name, np.broadcast_to(q, (len(rows), len(q))), np.eye(6)[list(rows)], **asked)
    assert_certified(found)
    return found.rates.T, rates(name, q, np.zeros(6), **asked)


SINGULAR = [
    (UR5, [0.1, -1, 1.2, 0.3, 0, 0]),
    (UR5, [0.1, -1, 0, 0.3, 0.5, 0]),
    (UR5, [0.0] * 6),
    (TWO, [0.4, 0]),
    ("textbook:wrist_zyz", [0.4, 0, 0.3]),
    (PANDA, [0.0] * 8),
]


@pytest.mark.parametrize("weights", [False, True], ids=["equal", "weighted"])
@pytest.mark.parametrize("axes", [None, "xyz", "rx ry rz", "x rz"])
@pytest.mark.parametrize(("name", "q"), [*((name, None) for name in ARMS), *SINGULAR])
def test_the_four_conditions_of_moore_and_penrose(name: str, q: Any, axes: str | None, weights: bool) -> None:
    """At regular configurations and at singular ones, of wide, tall and square Jacobians."""
    at = some(name, 4) if q is None else np.array(q)
    count = jacobian(name, at).shape[-1]
    asked = {"axes": axes, "weights": np.geomspace(0.5, 3, count) if weights else None}
    inverse, found = inverse_of(name, at, **asked)
    rows, columns = units(found)
    a, b = pure(found, jacobian(name, at)), inverse / columns[:, None] * rows
    slack = 1e-11 * (1 + np.abs(b).max()) ** 2
    np.testing.assert_allclose(a @ b @ a, a, atol=slack)
    np.testing.assert_allclose(b @ a @ b, b, atol=slack)
    np.testing.assert_allclose(a @ b, (a @ b).T, atol=slack)
    np.testing.assert_allclose(b @ a, (b @ a).T, atol=slack)
    assert np.linalg.matrix_rank(b @ a, tol=1e-6) == found.rank


@pytest.mark.parametrize("name", ["example:ur5_robot", "example:panda", "textbook:planar_3r", "textbook:wrist_zyz"])
@pytest.mark.parametrize("axes", ["xyz", "rx ry rz", "xy"])
def test_numpys_least_squares_gives_the_same_where_units_are_sound(name: str, axes: str) -> None:
    q = some(name, 2, (3,))
    for one, matrix in zip(q, jacobian(name, q), strict=True):
        found = rates(name, one, SOME_TWIST, axes=axes)
        expected = np.linalg.lstsq(matrix[list(found.task.rows)], SOME_TWIST[list(found.task.rows)], rcond=1e-9)[0]
        np.testing.assert_allclose(found.rates, expected, atol=1e-9 * (1 + np.abs(expected).max()))


# --- the least motion ------------------------------------------------------------------------------------------------


def free_motions(name: str, q: np.ndarray, found: ks.ResolvedRates) -> np.ndarray:
    """Return rates that move nothing that counts, one in each column. (n, k)."""
    return null_space(jacobian(name, q)[list(found.task.rows)], rcond=1e-9)


@pytest.mark.parametrize("weights", [None, "numbers", "limits"])
@pytest.mark.parametrize(("name", "axes"), REDUNDANT)
def test_no_other_rates_give_it_with_less_motion(name: str, axes: str | None, weights: str | None) -> None:
    q = some(name, 3)
    count = jacobian(name, q).shape[-1]
    asked = np.geomspace(0.2, 5, count) if weights == "numbers" else weights
    found = rates(name, q, SOME_TWIST, axes=axes, weights=asked)
    assert found.exact
    free, cost = free_motions(name, q, found), 1 / units(found)[1] ** 2
    assert free.shape[1] > 0
    np.testing.assert_allclose(free.T @ (cost * found.rates), 0, atol=1e-9 * cost.max() * np.abs(found.rates).max())
    random = np.random.default_rng(1)
    for _ in range(20):
        other = found.rates + free @ random.normal(size=free.shape[1])
        assert other @ (cost * other) > found.rates @ (cost * found.rates)


def test_weights_by_limits_share_the_burden() -> None:
    """They make the sum of squares of the shares of the velocity limits least."""
    q = some(PANDA, 5)
    found, equal = (rates(PANDA, q, SOME_TWIST, weights=weights) for weights in ("limits", None))
    assert np.sum(found.utilisation**2) < np.sum(equal.utilisation**2)
    for step in (-0.1, -1e-3, 1e-3, 0.1):
        other = found.rates + step * free_motions(PANDA, q, found)[:, 0]
        assert np.sum((other / found.limits) ** 2) > np.sum(found.utilisation**2)


@pytest.mark.parametrize("factor", [1e-3, 7.0, 1e3])
def test_only_ratios_of_weights_count(factor: float) -> None:
    q, cost = some(PANDA, 6), np.geomspace(0.1, 10, 7)
    one, other = (rates(PANDA, q, SOME_TWIST, weights=w) for w in (cost, factor * cost))
    np.testing.assert_allclose(one.rates, other.rates, atol=1e-11)
    assert (one.rank, one.exact) == (other.rank, other.exact)
    np.testing.assert_allclose(one.amplification, other.amplification, rtol=1e-9)


def test_a_dear_joint_rests() -> None:
    cost = np.ones(7)
    cost[2] = 1e8
    found = rates(PANDA, some(PANDA, 7), SOME_TWIST, weights=cost)
    assert found.exact
    assert abs(found.rates[2]) < 1e-6 * np.abs(found.rates).max()


def test_weights_do_not_make_an_arm_singular() -> None:
    """The rank is the arm's; a cost of motion, however far from others, cannot lose a direction."""
    found = rates(TWO, [0.3, 0.7], [1, 0, 0, 0, 0, 0], axes="xy", weights=[1.1e-9, 0.9e9])
    assert found.rank == 2
    assert found.exact
    np.testing.assert_allclose(found.residual, 0, atol=1e-6)


def test_shares_of_limits_and_the_joint_that_binds() -> None:
    found = rates(PANDA, some(PANDA, 5, (3,)), SOME_TWIST)
    np.testing.assert_allclose(found.utilisation * found.limits, np.abs(found.rates), atol=1e-15)
    for i, index in enumerate(found.binding):
        assert found.utilisation[i, index] == found.utilisation[i].max()


# --- least squares ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "q"),
    [("textbook:planar_3r", None), ("textbook:scara", None), ("textbook:rp", None), (TWO, None), *SINGULAR],
)
def test_what_is_left_of_a_twist_is_orthogonal_to_what_joints_give(name: str, q: Any) -> None:
    """In the units that the result states."""
    at = some(name, 2) if q is None else np.array(q)
    found = rates(name, at, SOME_TWIST)
    assert_certified(found)
    assert not found.exact
    left, a = found.residual[list(found.task.rows)] / units(found)[0], pure(found, jacobian(name, at))
    assert np.linalg.norm(left) > 1e-3
    np.testing.assert_allclose(a.T @ left, 0, atol=1e-12)
    random = np.random.default_rng(2)
    for _ in range(20):  # no other rates leave less
        other = found.rates + 0.1 * random.normal(size=len(found.rates))
        gone = (SOME_TWIST - jacobian(name, at) @ other)[list(found.task.rows)] / units(found)[0]
        assert np.linalg.norm(gone) >= np.linalg.norm(left) - 1e-12


def test_rows_that_do_not_count_are_not_looked_at() -> None:
    q = some(PANDA, 1)
    one = rates(PANDA, q, [0.1, 0, 0, 9, 9, 9], axes="xyz")
    two = rates(PANDA, q, [0.1, 0, 0, 0, 0, 0], axes="xyz")
    np.testing.assert_array_equal(one.rates, two.rates)
    assert not np.any(one.residual[3:])
    assert one.exact


# --- damping ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("damping", [1e-3, 0.1, 1.0, 100.0])
@pytest.mark.parametrize(("name", "q"), [(UR5, None), (PANDA, None), ("textbook:stanford", None), *SINGULAR])
def test_damped_rates_satisfy_the_normal_equations(name: str, q: Any, damping: float) -> None:
    at = some(name, 2) if q is None else np.array(q)
    found = rates(name, at, SOME_TWIST, damping=damping)
    assert_certified(found)
    a, (rows, columns) = pure(found, jacobian(name, at)), units(found)
    x, b = found.rates / columns, SOME_TWIST[list(found.task.rows)] / rows
    np.testing.assert_allclose(a.T @ (a @ x) + damping**2 * x, a.T @ b, atol=1e-11)


@pytest.mark.parametrize("weights", [None, "limits"])
def test_more_damping_means_less_motion_and_more_left(weights: Any) -> None:
    q = np.array([0.1, -1, 1.2, 0.3, 0.01, 0])
    found = [rates(UR5, q, SOME_TWIST, damping=d, weights=weights) for d in (0, 1e-4, 1e-2, 0.1, 1, 10)]
    motions = [np.linalg.norm(one.rates / units(one)[1]) for one in found]
    lefts = [np.linalg.norm(one.residual / units(one)[0]) for one in found]
    assert motions == sorted(motions, reverse=True)
    assert lefts == sorted(lefts)
    assert found[0].exact
    assert not any(one.exact for one in found[2:])


def test_no_damping_is_the_limit_of_little() -> None:
    q = some(PANDA, 1)
    np.testing.assert_allclose(
        rates(PANDA, q, SOME_TWIST, damping=1e-7).rates, rates(PANDA, q, SOME_TWIST).rates, atol=1e-11
    )


# --- secondary tasks -------------------------------------------------------------------------------------------------

SECONDARY: list[Any] = ["mid-limits", "manipulability", "given"]


@pytest.mark.parametrize("damping", [0.0, 0.1])
@pytest.mark.parametrize("weights", [None, "numbers"])
@pytest.mark.parametrize("secondary", SECONDARY)
@pytest.mark.parametrize(("name", "axes"), REDUNDANT)
def test_a_secondary_task_moves_nothing_that_counts(
    name: str, axes: str | None, secondary: str, weights: str | None, damping: float
) -> None:
    q = some(name, 3, (3,))
    matrix = jacobian(name, q)
    count = matrix.shape[-1]
    asked: dict[str, Any] = {"axes": axes, "damping": damping}
    if weights:
        asked["weights"] = np.geomspace(0.2, 5, count)
    wanted = np.linspace(-1, 2, count) if secondary == "given" else secondary
    found, plain = rates(name, q, SOME_TWIST, secondary=wanted, **asked), rates(name, q, SOME_TWIST, **asked)
    assert_certified(found)
    assert found.secondary == secondary
    assert np.all(np.linalg.norm(found.null_rates, axis=-1) > 1e-3)
    moved = np.einsum("brc,bc->br", matrix[:, list(found.task.rows)], found.null_rates)
    np.testing.assert_allclose(moved, 0, atol=1e-12 * (1 + np.abs(found.null_rates).max()))
    np.testing.assert_allclose(found.rates - found.null_rates, plain.rates, atol=1e-11)
    np.testing.assert_allclose(found.residual, plain.residual, atol=1e-11)
    np.testing.assert_allclose(found.amplification, plain.amplification, rtol=1e-6)


@pytest.mark.parametrize("axes", [None, "xyz"])
@pytest.mark.parametrize("seed", range(5))
def test_towards_the_middle_of_limits(seed: int, axes: str | None) -> None:
    q, robot = some(PANDA, seed), load(PANDA).robot
    found = rates(PANDA, q, np.zeros(6), secondary="mid-limits", axes=axes)
    middle = np.array([np.mean(joint.limit.range) for joint in robot.independent[:7]])
    before, after = (np.linalg.norm(middle - (q[:7] + step * found.rates)) for step in (0.0, 0.01))
    assert after < before
    free = free_motions(PANDA, q, found)
    np.testing.assert_allclose(free.T @ (found.rates - (middle - q[:7])), 0, atol=1e-12)


@pytest.mark.parametrize("weights", [False, True], ids=["equal", "weighted"])
@pytest.mark.parametrize(("name", "axes"), REDUNDANT)
def test_along_the_gradient_of_manipulability(name: str, axes: str | None, weights: bool) -> None:
    """Gradients by central differences of the public index; metres in units of the result's length, held."""
    model, q = load(name), some(name, 3)
    count = jacobian(name, q).shape[-1]
    cost = np.geomspace(0.2, 5, count) if weights else None
    found = rates(name, q, np.zeros(6), secondary="manipulability", axes=axes, weights=cost)

    def logarithm(path: np.ndarray) -> np.ndarray:
        matrix = pure(found, ks.jacobian(model, tip(model, name), path).matrix)
        return np.log(np.prod(np.linalg.svd(matrix, compute_uv=False), axis=-1))

    whole = np.zeros((count, model.robot.nv))
    whole[:, model.robot.velocity_columns(model.robot.moving_joints(found.velocity.relative_to, found.velocity.of))] = (
        np.eye(count)
    )
    gradient = np.array(
        [
            differences.derivative(lambda t, unit=unit: logarithm(differences.moved(model.robot, q, unit, t)))
            for unit in whole
        ]
    )
    free, metric = free_motions(name, q, found), 1 / units(found)[1] ** 2
    np.testing.assert_allclose(free.T @ (metric * found.rates - gradient), 0, atol=1e-8 * (1 + np.abs(gradient).max()))
    assert gradient @ found.rates > 0


def test_manipulability_of_the_command_grows() -> None:
    """The index that `manipulability` gives, at a small step along the rates."""
    model, q = load(PANDA), some(PANDA, 8)
    found = rates(PANDA, q, np.zeros(6), secondary="manipulability", axes="xyz")
    path = q + np.outer([-1e-4, 0, 1e-4], found.whole)
    index = ks.manipulability(model, "panda_hand", path).blocks["translation"].yoshikawa
    assert index[0] < index[1] < index[2]


@pytest.mark.parametrize("weights", [False, True], ids=["equal", "weighted"])
def test_given_rates_are_projected(weights: bool) -> None:
    q, wanted = some(PANDA, 9), np.linspace(-2, 1, 7)
    cost = np.geomspace(0.1, 10, 7) if weights else np.ones(7)
    found = rates(PANDA, q, SOME_TWIST, secondary=wanted, axes="xyz", weights=cost)
    free = free_motions(PANDA, q, found)
    np.testing.assert_allclose(free.T @ (cost * (found.null_rates - wanted)), 0, atol=1e-11)
    again = rates(PANDA, q, SOME_TWIST, secondary=found.null_rates, axes="xyz", weights=cost)
    np.testing.assert_allclose(again.null_rates, found.null_rates, atol=1e-12)


@pytest.mark.parametrize("secondary", ["mid-limits", "manipulability"])
def test_a_motion_inside_alone_is_exact(secondary: Any) -> None:
    """No twist is wanted, none is given but what rounding leaves of the free motion's."""
    for seed in range(5):
        for axes in (None, "xyz"):
            found = rates(PANDA, some(PANDA, seed), np.zeros(6), axes=axes, secondary=secondary)
            assert np.linalg.norm(found.rates) > 1e-3
            assert found.exact, found.residual


def test_where_nothing_is_free_it_is_said() -> None:
    found = rates(UR5, some(UR5, 1), SOME_TWIST, secondary="manipulability")
    assert "no null space" in " ".join(found.warnings)
    np.testing.assert_allclose(found.null_rates, 0, atol=1e-9)
    assert rates(PANDA, some(PANDA, 1), SOME_TWIST, secondary="mid-limits").warnings == ()


# --- batches ---------------------------------------------------------------------------------------------------------

FIELDS = ["rates", "whole", "residual", "exact", "rank", "length", "singular_values", "amplification", "approach"]


@pytest.mark.parametrize("asked", [{}, {"damping": 0.1, "secondary": "mid-limits"}, {"secondary": "manipulability"}])
@pytest.mark.parametrize("name", ["example:panda", "textbook:stanford", "textbook:planar_3r"])
def test_a_batch_is_its_configurations_one_by_one(name: str, asked: dict[str, Any]) -> None:
    q, twists = some(name, 1, (2, 3)), np.random.default_rng(1).normal(size=(2, 3, 6))
    many = rates(name, q, twists, **asked)
    for index in np.ndindex(2, 3):
        one = rates(name, q[index], twists[index], **asked)
        for field in [*FIELDS, "null_rates", "utilisation", "binding"]:
            np.testing.assert_allclose(
                np.asarray(getattr(many, field))[index], getattr(one, field), atol=1e-9, err_msg=field
            )


@pytest.mark.parametrize("secondary", [None, "mid-limits", "manipulability"])
def test_many_twists_at_one_configuration(secondary: Any) -> None:
    q, twists = some(PANDA, 1), np.random.default_rng(1).normal(size=(4, 6))
    many = rates(PANDA, q, twists, secondary=secondary)
    for i in range(4):
        one = rates(PANDA, q, twists[i], secondary=secondary)
        for field in FIELDS:
            np.testing.assert_allclose(np.asarray(getattr(many, field))[i], getattr(one, field), atol=1e-9)


def test_twists_and_configurations_are_spread_over_each_other() -> None:
    found = rates(PANDA, some(PANDA, 1, (3, 1)), np.random.default_rng(1).normal(size=(4, 6)))
    assert found.rates.shape == (3, 4, 7)
    assert found.rank.shape == found.length.shape == found.exact.shape == found.approach.shape == (3, 4)


@pytest.mark.parametrize("secondary", [None, "mid-limits", "manipulability"])
def test_an_empty_batch(secondary: Any) -> None:
    found = rates(PANDA, np.zeros((0, 8)), SOME_TWIST, secondary=secondary)
    assert found.rates.shape == (0, 7)
    assert found.exact.shape == found.binding.shape == (0,)
    assert found.certificate.agree is True
    assert found.warnings == ()


# --- growth ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "axes"), [(UR5, None), (UR5, "xyz"), (TWO, "xy"), ("textbook:stanford", None)])
def test_amplification_between_the_best_and_the_worst_direction(name: str, axes: str | None) -> None:
    q = some(name, 4)
    first = rates(name, q, np.zeros(6), axes=axes)
    rows, _ = units(first)
    left, values, _ = np.linalg.svd(pure(first, jacobian(name, q)))
    for direction, value in zip(left.T, values, strict=False):
        twist = np.zeros(6)
        twist[list(first.task.rows)] = direction * rows
        found = rates(name, q, twist, axes=axes)
        assert found.amplification == pytest.approx(values[0] / value, rel=1e-9)
    np.testing.assert_allclose(first.singular_values, values, atol=1e-12)


@pytest.mark.parametrize("secondary", [None, "given"])
@pytest.mark.parametrize(
    ("name", "axes"),
    [
        (UR5, None),
        (UR5, "xyz"),
        (TWO, "xy"),
        ("textbook:stanford", None),
        (PANDA, None),
        ("textbook:planar_3r", "xy rz"),
    ],
)
def test_approach_is_the_rate_of_the_smallest_singular_value(
    name: str, axes: str | None, secondary: str | None
) -> None:
    model, q = load(name), some(name, 5)
    given = None if secondary is None else np.linspace(-1, 1, jacobian(name, q).shape[-1])
    found = rates(name, q, SOME_TWIST, axes=axes, secondary=given)

    def smallest(times: np.ndarray) -> np.ndarray:
        path = differences.moved(model.robot, q, found.whole, times)
        return np.linalg.svd(pure(found, ks.jacobian(model, tip(model, name), path).matrix), compute_uv=False)[..., -1]

    assert found.approach == pytest.approx(differences.derivative(smallest, 2e-4), abs=1e-6 * (1 + abs(found.approach)))
    assert abs(found.approach) > 1e-4


def test_a_singular_configuration_is_not_approached_from_itself() -> None:
    """Where the smallest is zero, it can only rise: its rate has no sign that two SVDs would agree on."""
    for q in ([0.4, 0.0], [0.4, np.pi]):
        for sign in (-1, 1):
            found = rates(TWO, q, sign * np.array([0.1, 0.2, 0, 0, 0, 0]), axes="xy")
            assert found.rank == 1
            assert np.isnan(found.approach)


def test_what_no_configuration_gives_is_not_lost() -> None:
    """Three parallel axes never leave their plane: the smallest singular value that tells anything is the second."""
    q = np.array([[0.3, 0.7, -0.4], [0.3, 0.0, 0.0]])
    flat, all_three = (rates("textbook:planar_3r", q, [0.1, 0.2, 0, 0, 0, 0], axes=axes) for axes in ("xy", "xyz"))
    for found in (flat, all_three):
        assert found.usual_rank == 2
        np.testing.assert_array_equal(found.rank, [2, 1])
    np.testing.assert_allclose(all_three.smallest, flat.smallest, atol=1e-12)
    np.testing.assert_allclose(all_three.approach, flat.approach, atol=1e-12)
    np.testing.assert_array_equal(np.isnan(flat.approach), [False, True])


# --- lengths ---------------------------------------------------------------------------------------------------------


def slides() -> ks.Model:
    axes = ("1 0 0", "0 1 0", "0.3 0.2 1")
    links = "".join(f'<link name="l{i}"/>' for i in range(4))
    joints = "".join(
        f'<joint name="j{i}" type="prismatic"><parent link="l{i}"/><child link="l{i + 1}"/><axis xyz="{axis}"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="2"/></joint>'
        for i, axis in enumerate(axes)
    )
    return load_text(f'<robot name="slides">{links}{joints}</robot>')


@pytest.mark.parametrize("axes", [None, "xyz", "x rz"])
def test_slides_alone_have_no_length_of_their_own(axes: str | None) -> None:
    model = slides()
    found = ks.resolved_rates(model, "l3", np.array([0.1, 0.2, 0.3]), [0.4, -0.5, 0.6, 0, 0, 0], axes=axes)
    assert_certified(found)
    assert found.exact
    matrix = ks.jacobian(model, "l3", np.array([0.1, 0.2, 0.3])).matrix
    np.testing.assert_allclose((matrix @ found.rates - found.twist)[list(found.task.rows)], 0, atol=1e-14)
    assert (found.length, found.has_length) == (1, False)
    asked = ks.resolved_rates(model, "l3", np.array([0.1, 0.2, 0.3]), [0.4, -0.5, 0.6, 1, 0, 1], axes=axes)
    assert asked.exact == (axes == "xyz")
    assert_certified(asked)


def test_a_wrist_whose_axes_meet_in_the_point_has_no_length() -> None:
    model, q = load("textbook:wrist_zyz"), np.array([0.3, 0.8, -0.4])
    found = ks.resolved_rates(model, "link3", q, [0, 0, 0, 1, 2, 3])
    assert_certified(found)
    assert found.exact
    np.testing.assert_allclose(ks.jacobian(model, "link3", q).matrix[3:] @ found.rates, [1, 2, 3], atol=1e-13)
    moved = ks.resolved_rates(model, "link3", q, [0.1, 0, 0, 1, 2, 3])  # a point that rests cannot move
    assert not moved.exact
    np.testing.assert_allclose(moved.rates, found.rates, atol=1e-13)
    np.testing.assert_allclose(moved.residual, [0.1, 0, 0, 0, 0, 0], atol=1e-13)


def test_a_row_that_hardly_moves_does_not_stretch_the_length() -> None:
    """This arm moves in the x-z plane but for seven millionths: turning about z is no measure of its size."""
    model = load("example:borinot_description/borinot_flying_arm_2")
    q = ks.random_configurations(model.robot, 1, (5,))
    found = ks.resolved_rates(model, model.robot.default_tip(), q, [1, 0, 0, 0, 0, 1], axes="x rz")
    assert_certified(found)
    assert np.all(found.length <= 2 * model.robot.reach)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_an_arm_of_another_size_is_no_other_arm(scale: float) -> None:
    """Lengths and linear velocities scaled alike: the same rates, rank, amplification, and approach."""

    def arm(size: float) -> ks.Model:
        axes = ("0 0 1", "0 1 0", "1 0.2 0", "0 1 0")
        links = "".join(f'<link name="l{i}"/>' for i in range(6))
        joints = "".join(
            f'<joint name="j{i}" type="continuous"><parent link="l{i}"/><child link="l{i + 1}"/><axis xyz="{axis}"/>'
            f'<origin xyz="{0.3 * size!r} {0.1 * size!r} {0.2 * size!r}"/></joint>'
            for i, axis in enumerate(axes)
        )
        fixed = (
            f'<joint name="t" type="fixed"><parent link="l4"/><child link="l5"/><origin xyz="{size!r} 0 0"/></joint>'
        )
        return load_text(f'<robot name="arm">{links}{joints}{fixed}</robot>')

    q, wanted = np.array([0.3, -0.7, 1.1, 0.5]), np.array([0.2, 0.3, -0.1, 0.5, 0.1, 0.2])
    scaled = wanted * np.array([scale, scale, scale, 1, 1, 1])
    for axes in (None, "xyz", "x y rz"):
        small = ks.resolved_rates(arm(1.0), "l5", q, wanted, axes=axes)
        large = ks.resolved_rates(arm(scale), "l5", q, scaled, axes=axes)
        np.testing.assert_allclose(large.rates, small.rates, atol=1e-9)
        assert (large.rank, large.exact) == (small.rank, small.exact)
        assert large.amplification == pytest.approx(small.amplification, rel=1e-9)


# --- near singular configurations ------------------------------------------------------------------------------------

NEAR = [0.1, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 3e-9, 1e-9, 3e-10, 1e-10, 1e-11, 1e-12, 1e-15, 0.0]


def near(name: str, step: float) -> np.ndarray:
    return {
        "elbow of two links": np.array([0.3, step]),
        "wrist": np.array([0.1, -1, 1.2, 0.3, step, 0]),
        "elbow": np.array([0.1, -1, step, 0.3, 0.5, 0]),
        "both": np.array([0.1, -1, step, 0.3, step, 0]),
    }[name]


PLACES = {"elbow of two links": (TWO, "xy"), "wrist": (UR5, None), "elbow": (UR5, None), "both": (UR5, None)}


@pytest.mark.parametrize("step", NEAR)
@pytest.mark.parametrize("place", PLACES)
def test_near_singular_configurations_the_engines_do_not_part(place: str, step: float) -> None:
    name, axes = PLACES[place]
    random = np.random.default_rng(3)
    for asked in ({}, {"damping": 0.05}, {"weights": "limits"}, {"secondary": "mid-limits"}):
        found = rates(name, near(place, step), random.normal(size=6), axes=axes, **asked)
        assert_certified(found)
        assert np.all(np.isfinite(found.rates))


@pytest.mark.parametrize("step", NEAR)
@pytest.mark.parametrize("place", PLACES)
def test_rates_are_exact_where_nothing_is_left(place: str, step: float) -> None:
    """What is called exact leaves less than a millionth; what leaves more than that is not called so."""
    name, axes = PLACES[place]
    for damping in (0.0, 1e-6, 0.05):
        found = rates(name, near(place, step), SOME_TWIST, axes=axes, damping=damping)
        rows, _ = units(found)
        counted = list(found.task.rows)
        share = np.linalg.norm(found.residual[counted] / rows) / np.linalg.norm(SOME_TWIST[counted] / rows)
        assert not (found.exact and share > 1e-6), share
        assert found.exact or share > 1e-10


@pytest.mark.parametrize("step", [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 0.0])
def test_rows_out_of_reach_are_not_exact_near_a_singular_configuration(step: float) -> None:
    found = rates("textbook:scara", [0.3, step, 0.1, 0.2], [0, 0, 0, 0, 1e-3, 1])
    assert not found.exact


def planted(error: float) -> Callable[..., np.ndarray]:
    original = ScrewEngine.jacobian
    return lambda self, q, velocity: original(self, q, velocity) * (1 + error)


TANGENT = np.array([-np.sin(0.3), np.cos(0.3), 0, 0, 0, 0])  # across an arm of two stretched links: it can do that


@pytest.mark.parametrize("step", [0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-12, 0.0])
@pytest.mark.parametrize(
    ("name", "place", "twist", "asked"),
    [
        pytest.param(TWO, "elbow of two links", TANGENT, {"axes": "xy"}, id="a direction that is not lost"),
        pytest.param(TWO, "elbow of two links", TANGENT, {"axes": "xy", "damping": 0.1}, id="that, damped"),
        pytest.param(UR5, "wrist", SOME_TWIST, {"damping": 0.05}, id="a wrist, damped"),
        pytest.param(UR5, "elbow", SOME_TWIST, {"damping": 0.05}, id="an elbow, damped"),
    ],
)
def test_the_certificate_means_something_near_singular_configurations(
    name: str, place: str, twist: np.ndarray, asked: dict[str, Any], step: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """These rates are of the size of the twist: an error of a hundredth of one engine's Jacobian is to be seen."""
    monkeypatch.setattr(ScrewEngine, "jacobian", planted(1e-2))
    found = rates(name, near(place, step), twist, **asked)
    assert np.linalg.norm(found.rates) < 20
    assert found.certificate.agree is False


@pytest.mark.parametrize("size", [1.0, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15])
def test_the_certificate_means_something_for_small_twists(size: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ScrewEngine, "jacobian", planted(1e-2))
    assert rates(UR5, some(UR5, 1), size * SOME_TWIST).certificate.agree is False


@pytest.mark.parametrize("factor", [1e-6, 1e-3, 1.0, 1e3, 1e6])
def test_the_certificate_does_not_depend_on_the_unit_of_weights(factor: float, monkeypatch: pytest.MonkeyPatch) -> None:
    assert_certified(rates(UR5, some(UR5, 1), SOME_TWIST, weights=[factor] * 6))
    monkeypatch.setattr(ScrewEngine, "jacobian", planted(1e-6))
    assert rates(UR5, some(UR5, 1), SOME_TWIST, weights=[factor] * 6).certificate.agree is False


def test_one_configuration_of_a_batch_does_not_hide_another(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ScrewEngine, "jacobian", planted(1e-6))
    q = np.stack([near("wrist", step) for step in (1.0, 1e-8, 0.0)])
    assert rates(UR5, q, SOME_TWIST).certificate.agree is False


@pytest.mark.parametrize("damping", [0.0, 0.02])
@pytest.mark.parametrize(("name", "place"), [(UR5, "wrist"), (UR5, "elbow"), (TWO, "elbow of two links")])
def test_the_sensitivity_bounds_what_an_error_does_and_is_not_vacuous(name: str, place: str, damping: float) -> None:
    """Entries of a Jacobian that are off by a little, at random: rates go less than told, and not much less."""
    random, step = np.random.default_rng(5), 1e-9
    for distance in (0.5, 1e-2, 1e-3):
        q = near(place, distance)
        matrix, task = jacobian(name, q), Task.named("xy" if name == TWO else "xyz rxyz")
        inverse = WeightedInverse.at(matrix, [True] * len(q), task, None, load(name).robot.reach)
        z = np.zeros(len(q))
        found, _ = inverse.solved(matrix, SOME_TWIST, damping, z)
        told = inverse.sensitivity(matrix, SOME_TWIST, damping, found, z, ascending=False)
        errors = step * random.uniform(-1, 1, (300, *matrix.shape))
        moved = [inverse.solved(matrix + error, SOME_TWIST, damping, z)[0] - found for error in errors]
        share = np.linalg.norm(moved, axis=-1).max() / step / told
        assert 1e-2 < share < np.sqrt(matrix.size)  # a matrix of ones has a norm of sqrt(m n)


def test_a_gradient_that_vanishes_is_certified() -> None:
    """What is left of a gradient of zero is rounding, and no two engines round alike."""
    for q in ([0.3, np.pi / 2, 0.0], [0.0, np.pi / 2, np.pi / 2]):
        for axes in ("rz", "xy"):
            for twist in (np.zeros(6), SOME_TWIST):
                assert_certified(rates("textbook:planar_3r", q, twist, axes=axes, secondary="manipulability"))


@pytest.mark.parametrize("engine", [ScrewEngine, PinocchioEngine])
def test_the_gradient_of_manipulability_is_certified(engine: type, monkeypatch: pytest.MonkeyPatch) -> None:
    original = engine.jacobian_rate
    monkeypatch.setattr(engine, "jacobian_rate", lambda *given: 1.01 * original(*given))
    found = rates(PANDA, some(PANDA, 1), SOME_TWIST, secondary="manipulability")
    assert found.certificate.agree is False


def test_a_motion_that_is_rounding_is_no_motion() -> None:
    """The finger slides along y; its Jacobian's entry along x is 2.5e-17. That is no way to move along x."""
    for row in (0, 2):
        found = ks.resolved_rates(
            load(PANDA), "panda_leftfinger", np.full(8, 0.01), np.eye(6)[row], axes="xyz"[row], relative_to="panda_hand"
        )
        assert found.rank == 0
        assert not found.exact
        assert np.abs(found.rates).max() < 1


# --- hostile files ---------------------------------------------------------------------------------------------------


def limited(lower: str = "-1", upper: str = "1", velocity: str = "1") -> ks.Model:
    """Return three links in a plane; the limits of the first joint are odd."""
    links = "".join(f'<link name="l{i}"/>' for i in range(5))
    joints = "".join(
        f'<joint name="j{i}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/><axis xyz="0 0 1"/>'
        f'<origin xyz="{min(i, 1)} 0 0"/><limit effort="1" {limit}/></joint>'
        for i, limit in enumerate(
            (
                f'lower="{lower}" upper="{upper}" velocity="{velocity}"',
                'lower="-1" upper="1" velocity="1"',
                'lower="-1" upper="1" velocity="1"',
            )
        )
    )
    fixed = '<joint name="t" type="fixed"><parent link="l3"/><child link="l4"/><origin xyz="1 0 0"/></joint>'
    return load_text(f'<robot name="limited">{links}{joints}{fixed}</robot>')


@pytest.mark.parametrize(
    ("limits", "asked"),
    [
        *(
            ({"lower": "0", "upper": upper}, {"secondary": "mid-limits"})
            for upper in ("1e10", "1e17", "1e200", "1.7e308")
        ),
        *(
            ({"velocity": velocity}, {"weights": "limits"})
            for velocity in ("1e-200", "1e-30", "1e-9", "1e-5", "1e5", "1e9", "1e10", "1e30", "1e200")
        ),
    ],
)
def test_limits_that_no_joint_has(limits: dict[str, str], asked: dict[str, Any]) -> None:
    """Either it is refused in a line, or the answer is one: finite, certified, and what it says that it is."""
    model, wanted = limited(**limits), np.array([1.0, 0, 0, 0, 0, 0])
    q = np.array([0.3, 0.7, -0.4])
    try:
        found = ks.resolved_rates(model, "l4", q, wanted, axes="xy", **asked)
    except ks.UsageError:
        return
    assert np.all(np.isfinite(found.rates))
    assert_certified(found)
    given = ks.jacobian(model, "l4", q).matrix @ found.rates
    np.testing.assert_allclose(given[:2], wanted[:2], atol=1e-6 + 1e-12 * np.abs(found.rates).max())
    assert found.exact
    assert found.rank == 2


# --- refusals --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "twist", [[1, 2, 3], [], 1.0, "abc", None, [[1], [1, 2]], ["a"] * 6, [np.nan] * 6, [np.inf] * 6]
)
def test_twists_that_cannot_be(twist: Any) -> None:
    with pytest.raises(ks.UsageError, match="twist"):
        rates(TWO, [0.3, 0.7], twist)


def test_twists_that_do_not_go_with_the_configurations() -> None:
    with pytest.raises(ks.UsageError, match="do not go with"):
        rates(TWO, np.zeros((3, 2)), np.zeros((2, 6)))


@pytest.mark.parametrize("damping", [-1.0, -1e-300, float("nan"), float("inf"), 1e13, "a", None])
def test_dampings_that_cannot_be(damping: Any) -> None:
    with pytest.raises(ks.UsageError, match="damping"):
        rates(TWO, [0.3, 0.7], SOME_TWIST, damping=damping)


@pytest.mark.parametrize(
    "weights",
    ["none", "", [1], [1, 2, 3], [1, 0], [1, -1], [1, np.nan], [1, np.inf], [1e-10, 1], ["a", "b"], 3, [[1, 2]]],
)
def test_weights_that_cannot_be(weights: Any) -> None:
    with pytest.raises(ks.UsageError, match="weights"):
        rates(TWO, [0.3, 0.7], SOME_TWIST, weights=weights)


@pytest.mark.parametrize(
    "secondary", ["middle", "", [1], [1, 2, 3], ["a", "b"], [[1, 2]], 3, [np.nan, 1], [np.inf, 1], [1e300, 1]]
)
def test_secondary_tasks_that_cannot_be(secondary: Any) -> None:
    with pytest.raises((ks.UsageError, ks.ConfigurationError), match=r"secondary|rate"):
        rates(TWO, [0.3, 0.7], SOME_TWIST, secondary=secondary)


def test_weights_by_limits_need_limits() -> None:
    with pytest.raises(ks.UsageError, match="no velocity limit"):
        ks.resolved_rates(limited(velocity="0"), "l4", np.zeros(3), SOME_TWIST, weights="limits")
    base = ks.load(UR5, floating_base=True)
    q = ks.random_configurations(base.robot, 1)
    with pytest.raises(ks.UsageError, match="root_joint"):
        ks.resolved_rates(base, "tool0", q, SOME_TWIST, weights="limits")


def test_what_else_is_refused() -> None:
    with pytest.raises(ks.UnknownNameError, match="tol0"):
        ks.resolved_rates(load(UR5), "tol0", np.zeros(6), SOME_TWIST)
    with pytest.raises(ks.UsageError):
        ks.resolved_rates(load(UR5), "world", np.zeros(6), SOME_TWIST)
    with pytest.raises(ks.UsageError, match="axis"):
        rates(UR5, np.zeros(6), SOME_TWIST, axes="q")
    with pytest.raises(ks.ConfigurationError):
        rates(UR5, np.zeros(5), SOME_TWIST)
    with pytest.raises(ks.UsageError):
        rates(UR5, np.zeros(6), SOME_TWIST, reference="world", point=[0, 0, 1])
