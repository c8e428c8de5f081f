"""Tasks in the axes of the tool's frame, such as a weld's, which may turn about the tool's own z."""

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.singular.mechanism import mechanism

WELD = {"axes": "xyz rx ry", "reference": "local"}


@pytest.mark.parametrize(
    ("robot", "frame", "axes"),
    [
        ("example:ur5_robot", "tool0", "xyz rx ry"),
        ("textbook:stanford", "tool", "x rz"),
        ("textbook:helical", None, "xyz"),
        ("example:panda", "panda_hand_tcp", None),
    ],
)
def test_rows_in_the_tools_axes_and_their_derivatives(robot, frame, axes):
    model = ks.load(robot)
    arm = mechanism(model, frame or model.robot.default_tip(), axes=axes, reference="local", point=(0.1, -0.2, 0.05))
    q = arm.draw(np.random.default_rng(0), (5,))
    matrix, along = arm.derivatives(q)
    rest = ks.configuration(model, "zero").q
    theirs = ks.jacobian(
        model, arm.velocity.of, arm.configuration(q, rest), reference="local", point=arm.velocity.point
    ).matrix
    np.testing.assert_allclose(matrix, arm.scaled(theirs), atol=1e-12)
    step = 1e-6
    differences = [
        (arm.jacobian(q + step * unit) - arm.jacobian(q - step * unit)) / (2 * step)
        for unit in np.diag(np.where(arm.turning, 1.0, arm.length))
    ]
    np.testing.assert_allclose(along, np.stack(differences, -1), atol=1e-7)


def test_a_weld_by_a_ur5_is_singular_where_its_first_five_joints_are():
    """wrist_3 turns about the tool's z, which does not count; the five others face five rows."""
    model = ks.load("example:ur5_robot")
    found = ks.singular_find(model, "tool0", **WELD, starts=200)
    assert [(family.name, family.positions) for family in found.families if not family.implicit] == [
        ("elbow", {"elbow_joint": 0.0}),
        ("elbow", {"elbow_joint": np.pi}),
        ("wrist", {"wrist_2_joint": 0.0}),
        ("wrist", {"wrist_2_joint": np.pi}),
    ]
    for family in found.families:
        assert "wrist_3_joint" not in family.support
        five = ks.jacobian(model, "tool0", family.witness, reference="local").matrix[:5, :5]
        assert abs(np.linalg.det(five)) < 1e-9
        answer = ks.singular_at(model, "tool0", family.witness, **WELD)
        assert answer.singular
        for lost in answer.lost:  # told in the observer's axes; no moment about the tool's z
            columns = ks.jacobian(model, "tool0", family.witness).matrix
            np.testing.assert_allclose(lost.wrench @ columns, 0, atol=1e-9)
            z = ks.fk(model, "tool0", family.witness).matrix[:3, 2]
            assert abs(lost.wrench[3:] @ z) < 1e-9


def test_a_weld_is_regular_elsewhere():
    model = ks.load("example:ur5_robot")
    answer = ks.singular_at(model, "tool0", np.array([0.1, -0.5, 0.8, 0.2, 1.0, 0.3]), **WELD)
    assert not answer.singular
    (motion,) = answer.self_motions
    np.testing.assert_allclose(motion.rates, [0, 0, 0, 0, 0, 1], atol=1e-9)
    assert motion.finite


def test_there_is_no_task_at_the_observers_origin():
    with pytest.raises(ks.UsageError, match="tool point"):
        ks.singular_find(ks.load("example:ur5_robot"), "tool0", reference="world")


@pytest.mark.parametrize("robot", ["textbook:puma560", "textbook:stanford"])
def test_the_wrist_of_a_weld_turns_inside(robot):
    """joint5 = 0: joints 4 and 6 turn the tool about its own z, each alone."""
    q = np.array([0.3, 0.4, 0.5, 1.0, 0.0, 0.5])
    answer = ks.singular_at(ks.load(robot), "tool", q, **WELD)
    assert (answer.singular, answer.kind, answer.name) == (True, "tangential", "wrist")
    rates = np.array([motion.rates for motion in answer.self_motions])
    assert all(motion.finite for motion in answer.self_motions)
    np.testing.assert_allclose(np.linalg.svd(rates[:, [3, 5]], compute_uv=False), [1, 1], atol=1e-9)
    np.testing.assert_allclose(rates[:, [0, 1, 2, 4]], 0, atol=1e-9)
