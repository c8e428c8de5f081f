"""The certificate: what counts as agreement, and what never does."""

import dataclasses
import pickle

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.crosscheck import certified, length_scale
from kinetostat.engines.pinocchio import PinocchioEngine


@pytest.fixture
def arm():
    return ks.load("textbook:planar_2r")


def differ(arm, first, second):
    """Certify two arrays, as if one came from each engine."""
    answers = {arm.engine.name: np.asarray(first), arm.witness.name: np.asarray(second)}
    return certified(arm, lambda engine: answers[engine.name], 1.0)


def test_small_differences_agree_and_the_first_engine_is_given(arm):
    value, certificate = differ(arm, [1.0], [1.0 + 1e-13])
    assert value == [1.0]
    assert certificate.agree is True
    assert certificate.engines == ("pinocchio", "screw")
    assert certificate.values == ()


@pytest.mark.parametrize("other", [[1.0 + 1e-11], [np.nan], [np.inf], [1.0, 1.0], [[1.0]]])
def test_anything_else_does_not_and_both_are_kept(arm, other):
    _, certificate = differ(arm, [1.0], other)
    assert certificate.agree is False
    assert len(certificate.values) == 2


def test_not_a_number_on_both_sides_is_no_agreement(arm):
    assert differ(arm, [np.nan], [np.nan])[1].agree is False


def test_without_crosscheck_nothing_is_claimed():
    arm = ks.load("textbook:planar_2r", crosscheck=False)
    certificate = ks.fk(arm, "tool", np.zeros(2)).certificate
    assert certificate.agree is None
    assert certificate.max_difference is None


def test_the_scale_grows_with_what_makes_numbers_larger(arm):
    robot = arm.robot
    assert length_scale(robot, np.zeros(2)) == pytest.approx(robot.reach)
    assert length_scale(robot, np.array([200 * np.pi, 0])) == pytest.approx(100 * robot.reach)
    assert length_scale(robot, np.zeros(2), (0.0, 0.0, 3.0)) == pytest.approx(robot.reach + 3)
    floating = robot.with_floating_base()
    far = ks.configuration(floating, "root_joint=1000 0 0 0 0 0 1").q
    assert length_scale(floating, far) > 1000


def test_engines_that_see_different_joints_are_caught(arm, monkeypatch):
    def misread(self, *_, **__):
        self.position_names = self.velocity_names = ("other",)

    monkeypatch.setattr(PinocchioEngine, "__init__", misread)
    with pytest.raises(ks.DisagreementError, match="different joints"):
        _ = dataclasses.replace(arm).witness


def test_pinocchio_refusing_a_robot_is_our_error_with_its_reason(arm):
    broken = dataclasses.replace(arm, loaded=dataclasses.replace(arm.loaded, text="<robot/>"))
    with pytest.raises(ks.EngineError, match="No name given for the robot") as caught:
        _ = broken.engine
    assert caught.value.exit_code == 3


def test_a_model_travels_to_another_process(arm):
    q = np.array([0.3, 0.7])
    here = ks.jacobian(arm, "tool", q)
    again = pickle.loads(pickle.dumps(arm))
    assert np.array_equal(ks.jacobian(again, "tool", q).matrix, here.matrix)
    assert np.array_equal(pickle.loads(pickle.dumps(here)).matrix, here.matrix)


def test_results_are_frozen_values(arm):
    result = ks.jacobian(arm, "tool", np.zeros(2))
    with pytest.raises(dataclasses.FrozenInstanceError):
        result.matrix = np.zeros((6, 2))
    with pytest.raises(ValueError, match="read-only"):
        result.matrix[0, 0] = 1


FLOATING = ks.load("textbook:planar_2r", floating_base=True)


@pytest.mark.parametrize(
    ("q", "asked", "message"),
    [
        (np.zeros(3), {}, "positions have the shape"),
        (np.zeros((4, 1)), {}, "positions have the shape"),
        (np.float64(0), {}, "positions have the shape"),
        ([0.0, np.nan], {}, "not a finite number"),
        (["a", "b"], {}, "positions are numbers"),
        (np.zeros(2), {"qdot": np.zeros(3)}, "rates have the shape"),
        (np.zeros(2), {"qdot": [np.inf, 0]}, "a rate is not a finite number"),
        (np.zeros(2), {"point": (1.0, 2.0)}, "three finite coordinates"),
        (np.zeros(2), {"point": (1.0, 2.0, np.nan)}, "three finite coordinates"),
    ],
)
def test_arrays_that_cannot_be_are_refused_by_name(arm, q, asked, message):
    with pytest.raises(ks.UsageError, match=message):
        ks.jacobian(arm, "tool", q, **asked)
    if not asked:
        with pytest.raises(ks.UsageError, match=message):
            ks.fk(arm, "tool", q)


def test_a_zero_quaternion_is_refused():
    with pytest.raises(ks.ConfigurationError, match="quaternion of joint 'root_joint' is zero"):
        ks.fk(FLOATING, "tool", np.zeros(9))


def test_a_point_may_be_an_array(arm):
    q = np.array([0.3, 0.7])
    for point in ((0.1, 0.2, 0.3), np.array([0.1, 0.2, 0.3]), [0.1, 0.2, 0.3]):
        assert ks.jacobian(arm, "tool", q, point=point).velocity.point == (0.1, 0.2, 0.3)


@pytest.mark.parametrize("shape", [(0,), (2, 0), (0, 3)])
def test_an_empty_batch_has_a_shape(arm, shape):
    q = np.zeros((*shape, 2))
    assert ks.fk(arm, "tool", q).matrix.shape == (*shape, 4, 4)
    result = ks.jacobian(arm, "tool", q, qdot=np.ones(2))
    assert result.matrix.shape == result.time_derivative.shape == (*shape, 6, 2)
    assert result.certificate.agree
