"""Row A8 and the two forms of Jacobian inversion, through the library and through the command line."""

import numpy as np
import pytest

import kinetostat as ks
from textbook_support import assert_same, command_line, planar_tip, textbook

START = np.array([np.pi / 3, np.pi / 6, np.pi / 6])
GOAL = "0.5,3,0 rpy 0,0,2.0943951023931953"
FIRST_STEP = (0.598076, -1.633975, 1.035898)  # of q - h, as it is printed
ITERATES = (
    (0.449121, 2.157573, -0.512300),
    (0.650171, 1.498961, -0.054737),
    (0.698674, 1.434467, -0.038746),
)
LIMIT = (0.6988632, 1.4318882, -0.0363562)
TASK = ("--axes", "x", "y", "rz")


def asked(**words):
    return ks.ik(textbook("planar_3r"), "tool", GOAL, START, axes="x y rz", **words)


def tip(q):
    """Return x, y and the angle of the tool, by the closed form."""
    placement = planar_tip(np.array([2.0, 1.0, 1.0]), np.asarray(q, dtype=float))
    return np.array([placement[0, 3], placement[1, 3], np.sum(q)])


WANTED = np.array([0.5, 3.0, 2 * np.pi / 3])


def test_a8_iterates_of_newton_raphson():
    found = asked(method="newton")
    assert found.certificate.engines == ("pinocchio", "screw")
    assert found.certificate.agree is True
    assert found.converged
    assert_same(found.trace[0].q, START, atol=0)
    assert_same(-found.trace[0].change, np.array(FIRST_STEP), atol=6e-7)
    for step, printed in zip(found.trace[1:4], ITERATES, strict=True):
        assert_same(step.q, np.array(printed), atol=6e-7)
    assert_same(found.q, np.array(LIMIT), atol=6e-8)
    assert_same(tip(found.q), WANTED, atol=1e-8)
    assert found.iterations == 5


def test_a8_on_the_command_line():
    words = ["ik", "textbook:planar_3r", "--pose", GOAL, *TASK, "-q", ",".join(map(repr, START.tolist()))]
    result = command_line(*words, "--method", "newton", "--trace")["result"]
    assert set(result) >= {"configuration", "converged", "iterations", "residual", "trace"}
    assert result["converged"] is True
    assert result["method"] == "newton"
    assert result["rows"] == ["vx", "vy", "wz"]
    steps = [list(step["configuration"].values()) for step in result["trace"]]
    assert [list(step["configuration"]) for step in result["trace"]] == [["joint1", "joint2", "joint3"]] * len(steps)
    np.testing.assert_allclose(steps[1:4], ITERATES, rtol=0, atol=6e-7)
    np.testing.assert_allclose(result["trace"][0]["change"], np.negative(FIRST_STEP), rtol=0, atol=6e-7)
    np.testing.assert_allclose(list(result["configuration"].values()), LIMIT, rtol=0, atol=6e-8)


def test_a8_in_degrees_is_the_same():
    words = ["ik", "textbook:planar_3r", "--pose", "0.5,3,0 rpy 0,0,120", *TASK, "-q", "60,30,30", "--deg"]
    result = command_line(*words, "--method", "newton")["result"]
    np.testing.assert_allclose(list(result["configuration"].values()), LIMIT, rtol=0, atol=6e-8)  # JSON: radians


@pytest.mark.parametrize("words", [{}, {"method": "pseudo-inverse"}, {"method": "pseudo-inverse", "step": 0.3}])
def test_every_method_comes_to_the_limit(words):
    """From this start; the other branch has its elbow on the other side."""
    found = asked(**words)
    assert found.converged
    assert_same(tip(found.q), WANTED, atol=1e-8)
    assert_same(found.q, np.array(LIMIT), atol=1e-7)


def test_the_two_branches():
    """The wrist lies on the circle about the goal; two elbows reach it."""
    found = ks.ik_all(textbook("planar_3r"), "tool", GOAL, START, axes="x y rz")
    assert len(found.q) == 2
    for q in found.q:
        assert_same(np.exp(1j * tip(q)[2]), np.exp(1j * WANTED[2]), atol=1e-8)
        assert_same(tip(q)[:2], WANTED[:2], atol=1e-8)
    elbows = found.q[:, 1]
    assert elbows[0] == pytest.approx(-elbows[1], abs=1e-8)
    assert_same(found.q[0], np.array(LIMIT), atol=1e-7)  # the nearest to the start first


def test_rates_bring_the_error_down_exponentially():
    """Along the whole way: for these rows the error is what the joints move, so that it is exact."""
    trace = asked(method="pseudo-inverse").trace
    first = WANTED - tip(trace[0].q)
    for step in trace[:: len(trace) // 20]:
        assert_same(WANTED - tip(step.q), np.exp(-step.time) * first, atol=2e-5)
    assert trace[-1].time == pytest.approx(np.log(trace[0].error / 1e-9), abs=0.1)


@pytest.mark.parametrize("share", [0.05, 0.2, 0.5])
def test_steps_bring_a_small_error_down_by_their_share(share):
    model, q = textbook("planar_3r"), np.array(LIMIT)
    near = ks.fk(model, "tool", q + np.array([1e-4, -2e-4, 1e-4])).matrix
    trace = ks.ik(model, "tool", near, q, axes="x y rz", method="pseudo-inverse", step=share).trace
    errors = np.array([step.error for step in trace if step.error > 1e-8])
    np.testing.assert_allclose(errors[1:] / errors[:-1], 1 - share, atol=1e-3)


def test_the_whole_step_is_newtons():
    newton, whole = asked(method="newton"), asked(method="pseudo-inverse", step=1.0)
    for one, other in zip(newton.trace, whole.trace, strict=True):
        assert_same(one.q, other.q, atol=0)


def test_a7_at_the_right_angle_the_step_is_solved_by_hand():
    """J = [[-2, -2, -1], [2, 0, 0], [1, 1, 1]] there: a turn of the tool by 0.1 in place takes (0, -0.1, 0.2)."""
    model, q = textbook("planar_3r"), np.array([0.0, np.pi / 2, 0.0])
    found = ks.ik(model, "tool", f"2,2,0 rpy 0,0,{np.pi / 2 + 0.1!r}", q, axes="x y rz", method="newton")
    assert_same(found.trace[0].change, np.array([0.0, -0.1, 0.2]), atol=1e-12)
    assert found.converged
