"""All solutions: how many there are, that each is one and no two are the same, and what is said of the list."""

import sys
from functools import cache

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.coordinates import coordinates
from kinetostat.analysis.inverse import branches as by
from kinetostat.analysis.inverse.aim import Aim
from kinetostat.analysis.task import FULL
from textbook_support import assert_same, textbook

ARMS = (
    ("example:ur5_robot", "tool0"),
    ("example:ur10_joint_limited_robot", "tool0"),
    ("example:kinova", "j2s6s200_end_effector"),
    ("textbook:puma560", "tool"),
)


@cache
def robot(name):
    return ks.load(name)


@pytest.fixture
def without_eaik(monkeypatch):
    monkeypatch.setitem(sys.modules, "eaik", None)
    monkeypatch.setitem(sys.modules, "eaik.pybindings", None)


def around(angles):
    """Return points that are the same where angles are, a whole turn on too."""
    return np.concatenate([np.cos(angles), np.sin(angles)], -1)


def assert_all_are_solutions(model, tip, found, target, rows=range(6)):
    """Each engine alone puts the tool there, no two are the same, limits are told rightly, those inside come first."""
    assert found.certificate.engines == ("pinocchio", "screw")
    assert found.certificate.agree is True
    for engine in (model.engine, model.witness):
        here = engine.placement(found.q, tip, found.relative_to)
        expected = np.broadcast_to(target, here.shape)
        if set(rows) >= {3, 4, 5}:
            assert_same(here, expected, atol=1e-8)
        else:
            assert_same(here[:, list(rows), 3], expected[:, list(rows), 3], atol=1e-8)
    assert np.abs(found.error[:, list(rows)]).max(initial=0) < 1e-8
    path = around(found.q)
    for i in range(len(found.q)):
        for j in range(i):
            assert np.linalg.norm(path[i] - path[j]) > 1e-5, (i, j)
    for q, inside in zip(found.q, found.inside_limits, strict=True):
        limits = [joint.limit.range for joint in model.robot.independent]
        within = all(low - 2e-5 <= x <= high + 2e-5 for x, (low, high) in zip(q, limits, strict=True))
        assert within is bool(inside)
    assert found.inside_limits.tolist() == sorted(found.inside_limits.tolist(), reverse=True)


def has(found, q):
    return np.min(np.linalg.norm(around(found.q) - around(q), axis=-1), initial=np.inf) < 1e-5


# --- counts ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("at", "count"), [((1.0, 0.5), 2), ((-1.2, 0.3), 2), ((0.25, 0.0), 2), ((1.8, 0), 1), ((2, 0), 0)]
)
def test_two_links_have_two_elbows_one_where_stretched_none_beyond(at, count):
    model = textbook("planar_2r")
    found = ks.ik_all(model, "tool", (*at, 0.0), np.zeros(2), axes="xy")
    assert len(found.q) == count
    assert_all_are_solutions(model, "tool", found, _at(at), rows=(0, 1))
    if count == 2:
        one, other = found.q
        assert one[1] == pytest.approx(-other[1], abs=1e-8)  # the elbow up, the elbow down
        bisected = np.arctan2(at[1], at[0])
        middle = np.sum(np.exp(1j * (np.array([one.sum(), other.sum()]) - bisected)))
        assert abs(middle.imag) < 1e-8  # mirror images in the line to the tool
    assert not found.complete
    assert "only some rows count" in found.why or count == 0


def _at(position):
    target = np.eye(4)
    target[: len(position), 3] = position
    return target


@pytest.mark.parametrize(("name", "tip"), ARMS)
def test_six_joints_have_up_to_eight(name, tip):
    model = robot(name)
    for seed in range(6):
        q = ks.random_configurations(model, seed)
        target = ks.fk(model, tip, q).matrix
        found = ks.ik_all(model, tip, target, q)
        assert_all_are_solutions(model, tip, found, target)
        assert len(found.q) in (2, 4, 6, 8)
        assert found.complete
        assert "EAIK" in found.how
        assert has(found, q)
        assert found.inside_limits[0]
        assert_same(around(found.q[0]), around(q), atol=1e-6)  # the nearest to the start


def test_the_textbook_arms_without_a_wrist():
    for name, most in (("anthropomorphic", 4), ("torus_3r", 4)):
        model = textbook(name)
        for seed in range(5):
            q = ks.random_configurations(model, seed)
            target = ks.fk(model, "tool", q).matrix
            found = ks.ik_all(model, "tool", target[:3, 3], q)
            assert_all_are_solutions(model, "tool", found, target, rows=(0, 1, 2))
            assert 1 <= len(found.q) <= most
            assert has(found, q)


@pytest.mark.parametrize("name", ["stanford", "scara", "pr", "rp", "skew_1p", "helical"])
def test_slides_and_screws_are_found_by_restarts(name):
    model = textbook(name)
    tip = model.robot.default_tip()
    q = ks.random_configurations(model, 3)
    target = ks.fk(model, tip, q).matrix
    found = ks.ik_all(model, tip, target, np.zeros(model.robot.nq))
    assert_same(model.engine.placement(found.q, tip, found.relative_to), np.tile(target, (len(found.q), 1, 1)), 1e-8)
    assert np.min(np.linalg.norm(found.q - q, axis=1)) < 1e-6
    assert not found.complete
    assert "random starts prove nothing" in found.why


def test_one_joint():
    model = textbook("planar_1r")
    target = ks.fk(model, "tool", np.array([1.0])).matrix
    found = ks.ik_all(model, "tool", target, np.zeros(1))
    assert_same(found.q, np.array([[1.0]]), atol=1e-9)


# --- the two ways ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "tip"), ARMS)
def test_every_solution_of_restarts_is_in_the_closed_list(name, tip, monkeypatch):
    model = robot(name)
    for seed in range(20, 26):
        target = ks.fk(model, tip, ks.random_configurations(model, seed)).matrix
        closed = ks.ik_all(model, tip, target, np.zeros(model.robot.nq))
        assert closed.complete
        with monkeypatch.context() as patch:
            patch.setattr(by, "closed_form", lambda _: "not asked")
            restarts = ks.ik_all(model, tip, target, np.zeros(model.robot.nq))
        assert not restarts.complete
        assert "not asked" in restarts.why
        assert all(has(closed, q) for q in restarts.q)
        assert all(has(restarts, q) for q in closed.q)


def test_what_the_closed_solution_lacks_is_listed_all_the_same(monkeypatch):
    """A library that forgets solutions is found out by the restarts."""
    model = robot("example:ur5_robot")
    target = ks.fk(model, "tool0", ks.random_configurations(model, 1)).matrix
    whole = ks.ik_all(model, "tool0", target, np.zeros(6))
    right = by.ClosedForm.candidates
    monkeypatch.setattr(by.ClosedForm, "candidates", lambda self, pose: right(self, pose)[:3])
    found = ks.ik_all(model, "tool0", target, np.zeros(6))
    assert not found.complete
    assert "that the closed solution does not have" in found.why
    assert len(found.q) == len(whole.q)


def test_what_is_no_solution_is_dropped(monkeypatch):
    model = robot("example:ur5_robot")
    target = ks.fk(model, "tool0", ks.random_configurations(model, 1)).matrix
    whole = ks.ik_all(model, "tool0", target, np.zeros(6))
    right = by.ClosedForm.candidates
    wrong = np.array([[9.0, 0.1, 0.2, 0.3, 0.4, 0.5]])
    monkeypatch.setattr(by.ClosedForm, "candidates", lambda self, pose: np.vstack([wrong, right(self, pose)]))
    found = ks.ik_all(model, "tool0", target, np.zeros(6))
    assert_all_are_solutions(model, "tool0", found, target)
    assert len(found.q) == len(whole.q)


def test_without_eaik_restarts_find_them_and_say_so(without_eaik):
    model = robot("example:ur5_robot")
    q = ks.random_configurations(model, 1)
    target = ks.fk(model, "tool0", q).matrix
    found = ks.ik_all(model, "tool0", target, q)
    assert_all_are_solutions(model, "tool0", found, target)
    assert len(found.q) == 8
    assert has(found, q)
    assert not found.complete
    assert "EAIK is not installed" in found.why
    assert "kinetostat[analytic]" in found.why
    assert "random starts" in found.how


def test_the_chain_decides_whether_a_closed_solution_is_asked_for():
    """Fewer joints than all of the arm, another observer, a point: the closed solution is of that chain."""
    model = robot("example:ur5_robot")
    q = ks.random_configurations(model, 5)
    point = (0.1, -0.2, 0.3)
    asked = {"relative_to": "shoulder_link", "point": point}
    target = np.array(ks.fk(model, "tool0", q, relative_to="shoulder_link").matrix)
    target[:3, 3] += target[:3, :3] @ point
    found = ks.ik_all(model, "tool0", target, q, **asked)
    assert found.coordinates == tuple(joint.name for joint in model.robot.independent[1:])
    for engine in (model.engine, model.witness):
        here = engine.placement(found.q, "tool0", "shoulder_link")
        assert_same(here[:, :3, :3], np.tile(target[:3, :3], (len(here), 1, 1)), atol=1e-8)
        assert_same(here[:, :3, :3] @ point + here[:, :3, 3], np.tile(target[:3, 3], (len(here), 1)), atol=1e-8)
    assert has(found, q)
    assert_same(found.q[:, 0], np.full(len(found.q), q[0]), atol=0)  # it does not move the tool


# --- infinitely many ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "tip"), [("example:panda", "panda_hand"), ("example:xarm7", "link_eef")])
def test_a_redundant_arm_has_infinitely_many(name, tip):
    model = robot(name)
    target = ks.fk(model, tip, ks.random_configurations(model, 1)).matrix
    found = ks.ik_all(model, tip, target, np.zeros(model.robot.nq))
    assert not found.complete
    assert found.endless
    assert 2 <= len(found.q) <= 8
    assert_same(model.engine.placement(found.q, tip, found.relative_to), np.tile(target, (len(found.q), 1, 1)), 1e-8)


def test_a_position_of_six_joints_has_infinitely_many():
    model = robot("example:ur5_robot")
    target = ks.fk(model, "tool0", ks.random_configurations(model, 1)).matrix
    found = ks.ik_all(model, "tool0", target[:3, 3], np.zeros(6))
    assert found.endless


def test_a_wrist_whose_axes_fall_together_has_infinitely_many():
    """Puma with joint 5 at zero: joints 4 and 6 turn against each other, the tool stays."""
    model = textbook("puma560")
    target = ks.fk(model, "tool", np.array([0.1, 0.2, 0.3, 0.4, 0.0, 0.6])).matrix
    found = ks.ik_all(model, "tool", target, np.zeros(6))
    assert not found.complete


def test_of_infinitely_many_a_few_are_listed():
    """Of a closed solution, too: the UR5 stretched out straight ahead."""
    model = robot("example:ur5_robot")
    found = ks.ik_all(model, "tool0", ks.fk(model, "tool0", np.zeros(6)).matrix, np.zeros(6))
    assert found.endless
    assert len(found.q) <= 8


def test_out_of_reach_there_is_none():
    model = robot("example:ur5_robot")
    found = ks.ik_all(model, "tool0", (3.0, 0, 0, 0, 0, 0), np.zeros(6))
    assert found.q.shape == (0, 6)
    assert found.error.shape == (0, 6)
    assert found.inside_limits.shape == (0,)
    assert found.certificate.agree is True


# --- the rest ----------------------------------------------------------------------------------------------------


def test_a_seed_makes_it_repeatable():
    model = robot("example:panda")
    target = ks.fk(model, "panda_hand", ks.random_configurations(model, 1)).matrix
    first, again, other = (ks.ik_all(model, "panda_hand", target, np.zeros(8), seed=seed) for seed in (1, 1, 2))
    assert_same(first.q, again.q, atol=0)
    assert first.q.shape != other.q.shape or not np.allclose(first.q, other.q)


def test_each_solution_is_turned_to_the_one_nearest_to_the_start():
    model = robot("example:ur5_robot")  # joints of two turns
    q = np.array([4.0, -5.0, 1.2, 6.0, -4.5, 3.5])
    found = ks.ik_all(model, "tool0", ks.fk(model, "tool0", q).matrix, q)
    assert_same(found.q[0], q, atol=1e-7)
    low, high = (np.array([joint.limit.range[i] for joint in model.robot.independent]) for i in (0, 1))
    for solution in found.q:
        for i, turn in enumerate(2 * np.pi * np.eye(6)):
            for other in (solution + turn, solution - turn):
                if low[i] <= other[i] <= high[i]:
                    assert abs(solution[i] - q[i]) <= abs(other[i] - q[i]) + 1e-9


def test_several_poses_are_refused():
    model = robot("example:ur5_robot")
    for target, q in ((np.tile(np.eye(4), (2, 1, 1)), np.zeros(6)), (np.eye(4), np.zeros((2, 6)))):
        with pytest.raises(ks.UsageError, match="one pose"):
            ks.ik_all(model, "tool0", target, q)


def test_closed_forms_are_told_by_the_chain():
    def form(name, tip):
        model = robot(name)
        return by.closed_form(coordinates(model, tip, model.robot.root))

    assert "more than the six" in form("example:panda", "panda_hand")
    assert "not all joints are revolute" in form("textbook:stanford", "tool")
    assert form("example:ur5_robot", "tool0").family.startswith("6R")


def test_descents_are_the_same_from_the_same_draw():
    model = robot("example:ur5_robot")
    aim = Aim.of(coordinates(model, "tool0", model.robot.root), FULL)
    target = ks.fk(model, "tool0", ks.random_configurations(model, 1)).matrix
    one, two = (by.branches(aim, target, np.random.default_rng(7)) for _ in range(2))
    assert_same(one.q, two.q, atol=0)
    assert one.starts == two.starts
