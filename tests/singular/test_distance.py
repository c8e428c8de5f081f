"""How far the next singularity is: exact where one joint makes it, an upper bound elsewhere, a real place always."""

import math

import numpy as np
import pytest

import kinetostat as ks
from differences import derivative
from singular.arms import ARMS, FINGERS, LEGS, REDUNDANT, arm_of, decisive, near_angle, pure, robot, units, whole


def ask(arm, q):
    return ks.singular_at(arm.model, arm.velocity.of, whole(arm, q), relative_to=arm.velocity.relative_to)


ALL = (*ARMS[:3:2], ARMS[4], REDUNDANT[0], LEGS[0], LEGS[6], *FINGERS)


@pytest.mark.parametrize(("name", "frame", "observer"), ALL)
def test_the_nearest_configuration_is_singular_and_as_far_as_is_said(name, frame, observer):
    arm, random = arm_of(name, frame, observer), np.random.default_rng(21)
    lower, upper = (
        np.array([joint.limit.range[k] if joint.type.nq == 1 else (-np.inf, np.inf)[k] for joint in arm.joints])
        for k in (0, 1)
    )
    for q in arm.draw(random, (1,), limited=True):
        found = ask(arm, q).distance
        assert found.distance is not None
        assert decisive(arm, found.q) < 1e-8
        assert found.distance == pytest.approx(np.linalg.norm((found.q - q) / units(arm)), rel=1e-9)
        inside = bool(np.all((found.q >= lower - 1e-6) & (found.q <= upper + 1e-6)))
        assert found.inside_limits == inside
        if found.inside is not None:
            away, there = found.inside
            assert not found.inside_limits
            assert decisive(arm, there) < 1e-8
            assert np.all((there >= lower - 1e-6) & (there <= upper + 1e-6))
            assert away == pytest.approx(np.linalg.norm((there - q) / units(arm)), rel=1e-9)
            assert away >= found.distance - 1e-12


@pytest.mark.parametrize(("name", "frame", "observer"), ALL)
def test_the_first_order_estimate(name, frame, observer):
    """s_r over its gradient, by differences of Pinocchio's singular value."""
    arm = arm_of(name, frame, observer)
    for q in arm.draw(np.random.default_rng(22), (1,), limited=True):
        values = np.linalg.svd(pure(arm, q), compute_uv=False)
        at = arm.generic_rank - 1
        if at and values[at - 1] - values[at] < 0.02:
            continue  # two singular values that cross have no gradient
        gradient = [
            derivative(lambda t, e=e, q=q: decisive(arm, q + np.outer(t, e)), 2e-4) for e in np.diag(units(arm))
        ]
        expected = values[at] / np.linalg.norm(gradient)
        assert ask(arm, q).distance.first_order == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("off", [1e-3, 0.02, 0.1, -0.1])
@pytest.mark.parametrize(
    ("name", "frame", "joint", "root"),
    [
        ("ur5_robot", "tool0", "elbow_joint", 0.0),
        ("ur5_robot", "tool0", "elbow_joint", math.pi),
        ("ur5_robot", "tool0", "wrist_2_joint", 0.0),
        ("textbook:puma560", "tool", "joint5", 0.0),
        ("textbook:puma560", "tool", "joint3", math.atan2(-0.4318, 0.0203)),
        ("textbook:planar_2r", "tool", "joint2", 0.0),
    ],
)
def test_near_a_condition_on_one_joint_the_distance_is_that_joints(name, frame, joint, root, off):
    """Exact; and the first order is close to it the nearer it is, where nothing else is near."""
    arm = arm_of(name, frame)
    i = arm.names.index(joint)
    for q in arm.draw(np.random.default_rng(23), (12,)):
        q[i] = root
        if abs(np.linalg.svd(pure(arm, q), compute_uv=False)[-2]) < 0.15:
            continue
        q[i] = root + off
        found = ask(arm, q).distance
        assert found.distance <= abs(off) + 1e-9
        if abs(off) <= 0.02:
            assert found.distance == pytest.approx(abs(off), rel=1e-6)
            assert near_angle(found.q[i], root) < 1e-9
            assert found.first_order == pytest.approx(abs(off), rel=0.3)
        return
    pytest.fail("no configuration was good")


@pytest.mark.parametrize(("name", "frame", "observer"), [ARMS[0], ARMS[2], LEGS[0]])
def test_nothing_nearer_is_found_by_many_searches(name, frame, observer):
    """No start of a hundred others around ends nearer: the bound is a good one."""
    from kinetostat.analysis.singular.search import converge

    arm = arm_of(name, frame, observer)
    random = np.random.default_rng(24)
    q = arm.draw(random, (), limited=True)
    found = ask(arm, q).distance
    starts = q + found.distance * random.normal(size=(150, len(q))) / math.sqrt(len(q))
    ended, smallest = converge(arm, starts)
    away = np.linalg.norm((ended - q) / units(arm), axis=-1)[smallest < 1e-9]
    assert found.distance <= np.min(away) + 1e-9


def test_at_a_singular_configuration_the_distance_is_zero():
    answer = ks.singular_at(robot("ur5_robot"), "tool0", [0.3, -1, 0.0, 0.4, 0.9, 0.1])
    assert answer.distance.distance == 0.0
    np.testing.assert_array_equal(answer.distance.q, answer.q)
    assert answer.distance.inside_limits is True
    outside = ks.singular_at(robot("textbook:planar_2r_6_3"), "tool", [0.3, math.pi])
    assert outside.distance.inside_limits is False


def test_slides_count_in_units_of_length():
    """A slide at 0.05 m whose root is at -0.15 m, outside its range, is 0.2 / L from it."""
    arm = arm_of("textbook:rp", "tool")
    found = ask(arm, np.array([0.3, 0.05])).distance
    assert found.distance == pytest.approx((0.05 + 0.15) / arm.length)
    assert found.q[1] == pytest.approx(-0.15)
    assert found.inside_limits is False


def test_whole_turns_do_not_count():
    """A joint at two turns is as near to its root at zero turns as at none."""
    model = robot("textbook:planar_2r")
    near = ks.singular_at(model, "tool", [0.1, 0.2]).distance
    far = ks.singular_at(model, "tool", [0.1, 0.2 + 4 * math.pi]).distance
    assert near.distance == pytest.approx(0.2)
    assert far.distance == pytest.approx(0.2)
    assert far.q[1] == pytest.approx(4 * math.pi)
