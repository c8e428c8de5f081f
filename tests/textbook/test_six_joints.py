"""Theory B: the Stanford arm's squared factor, and SCARA's rank of four."""

import numpy as np
import pytest

from textbook_support import (
    QUARTERS,
    angles,
    assert_same,
    columns_of,
    denavit_hartenberg,
    jacobian_of,
    placement_of,
    singular_values,
    vector_of,
)


def stanford(count, seed):
    q = angles(6, seed=seed, count=count)
    q[:, 2] = np.random.default_rng(seed).uniform(0.3048, 1.27, count)
    return q


def test_stanford_determinant_has_a_squared_factor():
    q = stanford(100, seed=61)
    found = np.linalg.det(jacobian_of("stanford", "tool", q))
    assert_same(np.abs(found), np.abs(q[:, 2] ** 2 * np.sin(q[:, 1]) * np.sin(q[:, 4])))
    assert len(set(np.sign(found / (np.sin(q[:, 1]) * np.sin(q[:, 4]))))) == 1  # up to one sign everywhere


def smallest(q):
    return singular_values(jacobian_of("stanford", "tool", q))[:, -1]


def test_stanford_is_approached_quadratically_in_the_slide():
    """At d3 = 0 the rank falls by one alone, but the determinant's gradient vanishes: sigma_min goes as d3^2."""
    q = stanford(20, seed=62)
    q[:, 2] = 0
    assert np.all(np.linalg.matrix_rank(jacobian_of("stanford", "tool", q), tol=1e-12) == 5)
    near, nearer = q.copy(), q.copy()
    near[:, 2], nearer[:, 2] = 1e-3, 1e-4
    np.testing.assert_allclose(smallest(near) / smallest(nearer), 100, rtol=0.15)


@pytest.mark.parametrize("joint", [1, 4])
def test_stanford_is_approached_linearly_in_its_other_factors(joint):
    q = stanford(20, seed=63 + joint)
    q[:, joint] = 0
    assert np.all(np.linalg.matrix_rank(jacobian_of("stanford", "tool", q), tol=1e-12) == 5)
    near, nearer = q.copy(), q.copy()
    near[:, joint], nearer[:, joint] = 1e-4, 1e-5
    np.testing.assert_allclose(smallest(near) / smallest(nearer), 10, rtol=0.15)


def test_stanford_wrist_centre():
    q = stanford(20, seed=64)
    s1, c1, s2, c2, out = np.sin(q[:, 0]), np.cos(q[:, 0]), np.sin(q[:, 1]), np.cos(q[:, 1]), q[:, 2]
    expected = vector_of(out * c1 * s2 - 0.154 * s1, out * s1 * s2 + 0.154 * c1, out * c2 + 0.412)
    assert_same(placement_of("stanford", "link6", q)[:, :3, 3], expected)


def test_stanford_tool_by_the_denavit_hartenberg_table():
    quarter = np.pi / 2
    for q in stanford(20, seed=70):
        expected = np.eye(4)
        for theta, d, alpha in [
            (q[0], 0.412, -quarter),
            (q[1], 0.154, quarter),
            (-quarter, q[2], 0),
            (q[3], 0, -quarter),
            (q[4], 0, quarter),
            (q[5], 0.263, 0),
        ]:
            expected = expected @ denavit_hartenberg(theta, d, 0, alpha)
        assert_same(placement_of("stanford", "tool", q), expected)


def scara(count, seed):
    generator = np.random.default_rng(seed)
    q = generator.uniform(-np.pi, np.pi, (count, 4))
    q[:, 2] = generator.uniform(0, 0.2, count)
    return q


def test_scara_columns():
    q = scara(40, seed=65)
    first, both = q[:, 0], q[:, 0] + q[:, 1]
    x, y = 0.4 * np.cos(first) + 0.3 * np.cos(both), 0.4 * np.sin(first) + 0.3 * np.sin(both)
    expected = columns_of(
        (-y, x, 0, 0, 0, 1),
        (-0.3 * np.sin(both), 0.3 * np.cos(both), 0, 0, 0, 1),
        (0, 0, -1, 0, 0, 0),
        (0, 0, 0, 0, 0, 1),
    )
    assert_same(jacobian_of("scara", "tool", q), expected)
    assert_same(placement_of("scara", "tool", q)[:, :3, 3], vector_of(x, y, 0.3 - q[:, 2]))


def test_scara_has_rank_four():
    q = scara(40, seed=66)
    assert np.all(np.abs(np.sin(q[:, 1])) > 1e-3)
    assert np.all(np.linalg.matrix_rank(jacobian_of("scara", "tool", q), tol=1e-9) == 4)


@pytest.mark.parametrize("elbow", [0.0, np.pi])
def test_scara_has_rank_three_with_the_elbow_stretched_or_folded(elbow):
    for waist in QUARTERS:
        matrix = jacobian_of("scara", "tool", [waist, elbow, 0.1, 0.7])
        assert np.linalg.matrix_rank(matrix, tol=1e-12) == 3
        assert_same(np.r_[np.cos(waist), np.sin(waist), 0, 0, 0, 0] @ matrix, np.zeros(4))
