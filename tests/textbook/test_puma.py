"""The Puma 560 of theory B: Corke's printed Jacobian, and the determinant's factors wrist, elbow and shoulder."""

import numpy as np
import pytest

from textbook_support import (
    angles,
    assert_same,
    denavit_hartenberg,
    jacobian_of,
    placement_of,
    singular_values,
    vector_of,
)

A2, A3, D3, D4 = 0.4318, 0.0203, 0.15005, 0.4318
NOMINAL = np.array([0, np.pi / 4, np.pi, 0, np.pi / 4, 0])
PRINTED = np.array(
    [
        [0.15005, 0.0143543, 0.3196830, 0, 0, 0],
        [0.5963031, 0, 0, 0, 0, 0],
        [0, 0.5963031, 0.2909744, 0, 0, 0],
        [0, 0, 0, 0.7071068, 0, 1],
        [0, -1, -1, 0, -1, 0],
        [1, 0, 0, -0.7071068, 0, 0],
    ]
)
DIGITS = 6e-8  # seven printed decimals


def arm(q):
    """Return the wrist centre's distance from the first axis in the arm's plane, and its height."""
    s23, c23 = np.sin(q[..., 1] + q[..., 2]), np.cos(q[..., 1] + q[..., 2])
    return A2 * np.cos(q[..., 1]) + A3 * c23 - D4 * s23, A2 * np.sin(q[..., 1]) + A3 * s23 + D4 * c23


def determinant(q):
    """Return a2 s5 (a3 s3 + d4 c3)(a2 c2 + a3 c23 - d4 s23)."""
    return A2 * np.sin(q[..., 4]) * (A3 * np.sin(q[..., 2]) + D4 * np.cos(q[..., 2])) * arm(q)[0]


def test_puma_jacobian_at_the_nominal_pose():
    assert_same(jacobian_of("puma560", "tool", NOMINAL), PRINTED, atol=DIGITS)


def test_puma_what_is_printed_as_zero_and_one_is_so():
    matrix = jacobian_of("puma560", "tool", NOMINAL)
    whole = np.isin(PRINTED, (-1, 0, 1))
    assert_same(matrix[whole], PRINTED[whole])


def test_puma_manipulability_at_the_nominal_pose():
    values = jacobian_of("puma560", "tool", NOMINAL)
    assert_same(singular_values(values).prod(), 0.0786172, atol=DIGITS)
    assert_same(singular_values(values[:3]).prod(), 0.1111815, atol=DIGITS)
    assert_same(singular_values(values[3:]).prod(), np.sqrt(6))  # printed as 2.4494897


def test_puma_wrist_centre():
    q = angles(6, seed=56)
    out, height = arm(q)
    s1, c1 = np.sin(q[:, 0]), np.cos(q[:, 0])
    expected = vector_of(c1 * out + D3 * s1, s1 * out - D3 * c1, height)
    for frame in ("link5", "link6", "tool"):
        assert_same(placement_of("puma560", frame, q)[:, :3, 3], expected)


TABLE = [(0, 0, 90), (0, A2, 0), (D3, A3, -90), (D4, 0, 90), (0, 0, -90), (0, 0, 0)]  # d, a, alpha in degrees


def test_puma_tool_by_the_denavit_hartenberg_table():
    for q in angles(6, seed=58, count=20):
        expected = np.eye(4)
        for theta, (d, a, alpha) in zip(q, TABLE, strict=True):
            expected = expected @ denavit_hartenberg(theta, d, a, np.radians(alpha))
        assert_same(placement_of("puma560", "tool", q), expected)


def test_puma_tool_at_the_nominal_pose():
    placement = placement_of("puma560", "tool", NOMINAL)
    half = np.sqrt(0.5)
    assert_same(placement[:3, :3], np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0.0]]))
    assert_same(placement[:3, 3], np.array([A2 * half - A3 * half + D4 * half, -D3, A2 * half - A3 * half - D4 * half]))


@pytest.mark.parametrize("reference", ["aligned", "local", "world"])
def test_puma_determinant_factors(reference):
    q = np.vstack([NOMINAL, angles(6, seed=57, count=200)])
    found = np.linalg.det(jacobian_of("puma560", "tool", q, reference=reference))
    assert_same(found, determinant(q))  # in these frames its sign is plus everywhere


ELBOW = np.arctan2(-D4, A3)  # a3 s3 + d4 c3 = 0
SINGULAR = {
    "wrist": np.array([0.3, 0.5, 0.7, -0.4, 0.0, 1.1]),
    "elbow": np.array([0.3, 0.5, ELBOW, -0.4, 0.8, 1.1]),
    # a2 c2 + a3 c23 - d4 s23 = 0 at q3 = 0.7
    "shoulder": np.array(
        [
            0.3,
            np.arctan2(A2 + A3 * np.cos(0.7) - D4 * np.sin(0.7), A3 * np.sin(0.7) + D4 * np.cos(0.7)),
            0.7,
            -0.4,
            0.8,
            1.1,
        ]
    ),
}


@pytest.mark.parametrize("cause", SINGULAR)
def test_puma_each_factor_alone_makes_it_singular(cause):
    q = SINGULAR[cause]
    assert_same(determinant(q), np.float64(0), atol=1e-16)
    values = singular_values(jacobian_of("puma560", "tool", q))
    assert values[5] < 1e-15
    assert values[4] > 1e-2


def test_puma_wrist_singularity_turns_inside():
    matrix = jacobian_of("puma560", "tool", SINGULAR["wrist"])
    assert_same(matrix[:, 3], matrix[:, 5])  # axes 4 and 6 are one


def test_puma_shoulder_singularity_has_the_wrist_above_the_first_axis_sidewards():
    position = placement_of("puma560", "tool", SINGULAR["shoulder"])[:3, 3]
    assert_same(position[:2], D3 * np.array([np.sin(0.3), -np.cos(0.3)]))
