"""Row A13: arms with one turning and one sliding joint."""

import numpy as np

from textbook_support import assert_same, columns_of, jacobian_of, placement_of, vector_of

POINTS = [(0, 0, 0), (0.2, -0.1, 0.3), (-1, 2, 5)]


def polar(seed):
    """Return angles and positions of a slide."""
    generator = np.random.default_rng(seed)
    turn = np.r_[0, np.pi / 2, np.pi, -np.pi / 2, generator.uniform(-np.pi, np.pi, 20)]
    return turn, np.r_[0.0, 1.0, 0.5, 0.25, generator.uniform(0, 1, 20)]


def test_a13_rp_columns():
    turn, slide = polar(131)
    sine, cosine, out = np.sin(turn), np.cos(turn), 0.15 + slide
    expected = columns_of((-out * sine, out * cosine, 0, 0, 0, 1), (cosine, sine, 0, 0, 0, 0))
    assert_same(jacobian_of("rp", "tool", vector_of(turn, slide)), expected)


def test_a13_rp_in_the_tool_frame():
    turn, slide = polar(132)
    expected = columns_of((0, 0.15 + slide, 0, 0, 0, 1), (1, 0, 0, 0, 0, 0))
    assert_same(jacobian_of("rp", "tool", vector_of(turn, slide), reference="local"), expected)


def test_a13_rp_is_singular_with_the_tool_on_the_axis():
    turn, slide = polar(133)
    determinant = np.linalg.det(jacobian_of("rp", "tool", vector_of(turn, slide))[:, :2])
    assert_same(determinant, -(0.15 + slide))
    on_axis = jacobian_of("rp", "tool", [0.8, -0.15])[:2]
    assert np.linalg.matrix_rank(on_axis, tol=1e-12) == 1


def test_a13_rp_slide_moves_every_point_alike_and_the_turn_does_not():
    turn, slide = polar(134)
    q = vector_of(turn, slide)
    columns = [jacobian_of("rp", "tool", q, point=point) for point in POINTS]
    for column in columns:
        assert_same(column[..., 1], vector_of(np.cos(turn), np.sin(turn), 0, 0, 0, 0))
    for point, column in zip(POINTS, columns, strict=True):
        x, y = 0.15 + slide + point[0], point[1]
        across = vector_of(-np.sin(turn) * x - np.cos(turn) * y, np.cos(turn) * x - np.sin(turn) * y)
        assert_same(column[:, :2, 0], across, atol=4e-12)


def test_a13_pr_columns():
    turn, slide = polar(135)
    expected = columns_of((1, 0, 0, 0, 0, 0), (-0.6 * np.sin(turn), 0.6 * np.cos(turn), 0, 0, 0, 1))
    assert_same(jacobian_of("pr", "tool", vector_of(slide, turn)), expected)


def test_a13_pr_revolute_screw_depends_on_the_slide():
    """Of the point at the base's origin: the axis is at x = slide, so w x r = (0, -slide, 0)."""
    turn, slide = polar(136)
    expected = columns_of((1, 0, 0, 0, 0, 0), (0, -slide, 0, 0, 0, 1))
    assert_same(jacobian_of("pr", "tool", vector_of(slide, turn), reference="world"), expected)


def test_a13_rp_prismatic_screw_depends_on_the_turn_only():
    turn, slide = polar(137)
    expected = columns_of((0, 0, 0, 0, 0, 1), (np.cos(turn), np.sin(turn), 0, 0, 0, 0))
    assert_same(jacobian_of("rp", "tool", vector_of(turn, slide), reference="world"), expected)


def test_a13_tool_positions():
    turn, slide = polar(138)
    out = 0.15 + slide
    assert_same(
        placement_of("rp", "tool", vector_of(turn, slide))[:, :3, 3],
        vector_of(out * np.cos(turn), out * np.sin(turn), 0),
    )
    assert_same(
        placement_of("pr", "tool", vector_of(slide, turn))[:, :3, 3],
        vector_of(slide + 0.6 * np.cos(turn), 0.6 * np.sin(turn), 0),
    )
