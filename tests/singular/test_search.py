"""The search: where it ends the arm is singular by Pinocchio's Jacobian, and its equations have the right gradients."""

import math

import numpy as np
import pytest

from differences import derivative
from kinetostat.analysis.singular.mechanism import mechanism
from kinetostat.analysis.singular.search import constraints, converge
from singular.arms import ARMS, FINGERS, LEGS, REDUNDANT, arm_of, decisive, pure, units
from textbook_support import denavit_hartenberg
from trees import load_text


def general_6r(seed):
    """Return a 6R arm of random Denavit-Hartenberg parameters."""
    random, text, parent = np.random.default_rng(seed), [], "base"
    before = np.eye(4)
    for i in range(6):
        text.append(f'<link name="l{i}"/>' if i else '<link name="base"/><link name="l0"/>')
        text.append(
            f'<joint name="j{i}" type="continuous"><parent link="{parent}"/><child link="l{i}"/>'
            f'{origin(before)}<axis xyz="0 0 1"/></joint>'
        )
        parent = f"l{i}"
        before = denavit_hartenberg(0, *random.uniform(-0.5, 0.5, 2), random.uniform(-math.pi, math.pi))
    text.append(
        f'<link name="tip"/><joint name="end" type="fixed"><parent link="{parent}"/><child link="tip"/>'
        f"{origin(before)}</joint>"
    )
    return mechanism(load_text(f'<robot name="general">{"".join(text)}</robot>'), "tip")


def origin(placement):
    roll = math.atan2(placement[2, 1], placement[2, 2])  # these turn about x alone
    return f'<origin xyz="{" ".join(map(repr, map(float, placement[:3, 3])))}" rpy="{roll!r} 0 0"/>'


NAMED = {
    "ur5": (lambda: arm_of("ur5_robot", "tool0"), 1.0),
    "puma": (lambda: arm_of("textbook:puma560", "tool"), 1.0),
    "panda": (lambda: arm_of("panda", "panda_hand"), 0.95),
    **{f"general {seed}": (lambda seed=seed: general_6r(seed), 0.97) for seed in range(4)},
}


def starts(arm, seed, count):
    return arm.draw(np.random.default_rng(seed), (count,))


@pytest.mark.parametrize("name", NAMED)
def test_success_rates(name):
    make, expected = NAMED[name]
    arm = make()
    q, smallest = converge(arm, starts(arm, 1, 300))
    reached = decisive(arm, q) < 1e-9  # by Pinocchio
    assert np.mean(reached) >= expected
    assert np.array_equal(reached, smallest < 1e-9)


@pytest.mark.parametrize(("name", "frame", "observer"), ARMS + REDUNDANT + LEGS + FINGERS)
def test_every_end_that_counts_is_singular_by_pinocchio(name, frame, observer):
    arm = arm_of(name, frame, observer)
    q, smallest = converge(arm, starts(arm, 2, 60))
    counted = smallest < 1e-9
    assert np.mean(counted) > 0.7
    assert np.all(decisive(arm, q[counted]) < 1e-9)
    assert np.all(np.isfinite(q))


def test_a_search_changes_nothing_where_it_starts_singular():
    arm = arm_of("ur5_robot", "tool0")
    q = starts(arm, 3, 20)
    q[:, 2] = 0
    ended, smallest = converge(arm, q)
    assert np.all(smallest < 1e-12)
    np.testing.assert_allclose(ended, q, atol=1e-9)


def test_the_starts_are_left_as_they_are():
    arm = arm_of("ur5_robot", "tool0")
    q = starts(arm, 4, 8)
    before = q.copy()
    converge(arm, q)
    assert np.array_equal(q, before)


SQUARE = [
    ("ur5_robot", "tool0"),
    ("textbook:puma560", "tool"),
    ("kinova", "j2s6s200_end_effector"),
    ("talos_reduced", "left_sole_link"),
]


@pytest.mark.parametrize(("name", "frame"), SQUARE)
def test_the_gradient_of_a_square_arms_equation_is_that_of_its_determinant(name, frame):
    """det J = +- s_r times the other singular values, which hardly change: so s_r has a sign and a gradient."""
    arm = arm_of(name, frame)
    q, smallest = converge(arm, starts(arm, 5, 24))
    for x in q[smallest < 1e-12]:
        others = np.prod(np.linalg.svd(pure(arm, x), compute_uv=False)[:-1])
        if others < 1e-4:  # two families at once
            continue
        expected = [
            derivative(lambda t, u=u, x=x: np.linalg.det(pure(arm, x + np.outer(t, u)))) / others
            for u in np.diag(units(arm))
        ]
        value, gradients = constraints(arm, x)
        assert gradients.shape == (1, len(x))
        assert np.abs(value) < 1e-9
        sign = np.sign(gradients[0] @ expected)
        np.testing.assert_allclose(sign * gradients[0], expected, atol=1e-7)


@pytest.mark.parametrize(("name", "frame", "observer"), REDUNDANT[:4])
def test_the_gradients_of_a_redundant_arms_equations(name, frame, observer):
    """Singular to first order where u^T J(q) N vanishes, u and N spanning the null spaces: n - 5 equations."""
    arm = arm_of(name, frame, observer)
    q, smallest = converge(arm, starts(arm, 6, 12))
    tried = 0
    for x in q[smallest < 1e-12]:
        left, values, right = np.linalg.svd(pure(arm, x))
        if values[-2] < 1e-3:
            continue
        tried += 1
        u, inside = left[:, -1], right[5:].T
        expected = np.stack(
            [
                derivative(lambda t, e=e, x=x, u=u, inside=inside: u @ pure(arm, x + np.outer(t, e)) @ inside)
                for e in np.diag(units(arm))
            ],
            -1,
        )
        _, gradients = constraints(arm, x)
        assert gradients.shape == expected.shape
        # Both are bases of the same equations: rows of one are those of the other, turned.
        np.testing.assert_allclose(gradients.T @ gradients, expected.T @ expected, atol=1e-7)
    assert tried > 5


def test_beside_the_set_the_equation_is_what_the_singular_value_is():
    arm = arm_of("ur5_robot", "tool0")
    q, smallest = converge(arm, starts(arm, 7, 30))
    beside = q[smallest < 1e-12] + 1e-5 * np.random.default_rng(7).normal(size=q[smallest < 1e-12].shape)
    for x in beside:
        value, _ = constraints(arm, x)
        assert np.linalg.norm(value) == pytest.approx(decisive(arm, x), rel=1e-2, abs=1e-9)
