"""Slices and workspaces: what the pictures of singularities are made of."""

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.singular.slices import is_planar, slice_over, workspace


@pytest.fixture(scope="module")
def two_links():
    """A5: links of 6 and 3, joint1 in 0 to 135 degrees, joint2 in 0 to 120."""
    return ks.singular_find(ks.load("textbook:planar_2r_6_3"), "tool", starts=50)


@pytest.fixture(scope="module")
def ur5():
    return ks.singular_find(ks.load("example:ur5_robot"), "tool0", starts=100)


def test_the_singular_curves_of_two_links_are_circles_of_their_sum_and_difference(two_links):
    curves = {curve.label: curve for curve in workspace(two_links).unlimited}
    radii = {label: np.linalg.norm(curve.points, axis=1) for label, curve in curves.items()}
    np.testing.assert_allclose(radii["joint2 = 0"], 9, atol=1e-12)
    np.testing.assert_allclose(radii["joint2 = pi"], 3, atol=1e-12)
    for curve in curves.values():  # whole circles
        np.testing.assert_allclose(curve.points[0], curve.points[-1], atol=1e-12)


def test_limits_leave_an_arc_and_draw_their_own_curves(two_links):
    found = workspace(two_links)
    (arc,) = [curve for curve in found.curves if curve.kind == "singular"]
    headings = np.arctan2(arc.points[:, 1], arc.points[:, 0])
    assert arc.label == "joint2 = 0"
    np.testing.assert_allclose([headings.min(), headings.max()], [0, np.radians(135)], atol=1e-9)
    limits = {curve.label: curve.points for curve in found.curves if curve.kind == "limit"}
    assert set(limits) == {"joint1 = 0", "joint1 = 2.356", "joint2 = 0", "joint2 = 2.094"}
    np.testing.assert_allclose(np.linalg.norm(limits["joint1 = 0"] - [6, 0], axis=1), 3, atol=1e-12)
    # Law of cosines: 36 + 9 + 36 cos 120.
    np.testing.assert_allclose(np.sum(limits["joint2 = 2.094"] ** 2, axis=1), 45 - 18, atol=1e-9)


def test_the_reached_points_lie_between_the_curves(two_links):
    found = workspace(two_links)
    radius = np.linalg.norm(found.reached, axis=1)
    assert np.all((radius <= 9 + 1e-12) & (radius >= np.sqrt(27) - 1e-12))
    assert found.axes == ("x", "y")
    # Near the outer circle the arm is nearly singular.
    assert found.smallest[radius > 8.99].max() < 0.1


@pytest.mark.parametrize(
    ("robot", "axes", "planar"),
    [
        ("planar_3r", "x y", True),
        ("scara", None, False),
        ("rp", None, True),
        ("anthropomorphic", None, False),
        ("planar_1r", None, False),
        ("wrist_zyz", None, False),
    ],
)
def test_which_arms_are_planar(robot, axes, planar):
    found = ks.singular_find(ks.load(f"textbook:{robot}"), "tool", axes=axes, starts=20)
    assert is_planar(found.mechanism) is planar


def test_what_is_not_planar_has_no_workspace_picture(ur5):
    with pytest.raises(ks.UsageError, match="not move in one plane"):
        workspace(ur5)


def test_a_slice_shows_the_smallest_singular_value(ur5):
    held = np.array([0.3, -1.0, 0.4, 0.5, 0.6, 0.7])
    found = slice_over(ur5, ["elbow_joint", "wrist_2_joint"], held, points=21)
    assert found.joints == ("elbow_joint", "wrist_2_joint")
    assert found.at == (0.4, 0.6)
    arm = ur5.mechanism
    for i, j in ((3, 4), (10, 17), (20, 0)):
        q = held.copy()
        q[2], q[4] = found.x[i], found.y[j]
        answer = ks.singular_at(arm.model, "tool0", q)
        assert found.smallest[j, i] == pytest.approx(answer.singular_values[-1], abs=1e-12)
        assert abs(found.signed[j, i]) == pytest.approx(np.prod(answer.singular_values), abs=1e-9)
    marks = {(mark.x, mark.y) for mark in found.marks}
    assert marks == {(0.0, None), (np.pi, None), (None, 0.0), (None, np.pi)}
    assert found.smallest[:, 10].max() == 0  # elbow_joint = 0, whatever wrist_2_joint does


def test_a_slice_is_over_the_joints_that_conditions_are_about(ur5):
    assert slice_over(ur5, points=5).joints == ("elbow_joint", "wrist_2_joint")


def test_labels_are_in_degrees_where_wanted(ur5, two_links):
    labels = {mark.label for mark in slice_over(ur5, degrees=True, points=5).marks}
    assert "elbow_joint = 180 deg" in labels
    assert {curve.label for curve in workspace(two_links, degrees=True).unlimited} == {
        "joint2 = 0 deg",
        "joint2 = 180 deg",
    }


@pytest.mark.parametrize(
    ("joints", "message"),
    [(["elbow"], "joint"), (["elbow_joint"], "two joints"), (["elbow_joint"] * 2, "two joints")],
)
def test_joints_that_cannot_be(ur5, joints, message):
    with pytest.raises(ks.UsageError, match=message):
        slice_over(ur5, joints)
