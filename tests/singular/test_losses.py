"""What is lost and what moves inside, by Pinocchio: reciprocity, screws, walks, and which side the tool can get to."""

import math

import numpy as np
import pytest

import kinetostat as ks
from differences import derivative
from singular.arms import (
    ARMS,
    FINGERS,
    LEGS,
    REDUNDANT,
    TEXTBOOK,
    answers,
    columns,
    moved_away,
    pure,
    robot,
    tool,
    units,
)

BOOKS = tuple((f"textbook:{name}", "tool", None) for name in TEXTBOOK)
ALL = (*ARMS, REDUNDANT[0], REDUNDANT[3], LEGS[0], LEGS[2], LEGS[5], LEGS[9], *FINGERS, *BOOKS)


@pytest.mark.parametrize(("name", "frame", "observer"), ALL)
def test_lost_wrenches_are_reciprocal_to_every_column(name, frame, observer):
    for _, answer in answers(name, frame, observer):
        matrix = columns(answer.mechanism, answer.q, at_tool=True)
        assert len(answer.lost) == answer.mechanism.generic_rank - answer.rank
        for lost in answer.lost:
            scale = np.array([1.0] * 3 + [1 / answer.mechanism.length] * 3)
            size = np.linalg.norm(lost.wrench * scale)
            assert np.max(np.abs(matrix.T @ lost.wrench)) < 1e-8 * size * max(1.0, float(np.max(np.abs(matrix))))
            unused = [i for i in range(6) if i not in answer.mechanism.task.rows]
            assert not np.any(lost.wrench[unused])
        if answer.lost:  # independent of each other
            stacked = np.array([lost.wrench / np.linalg.norm(lost.wrench) for lost in answer.lost])
            assert np.linalg.svd(stacked, compute_uv=False)[-1] > 1e-3


@pytest.mark.parametrize(("name", "frame", "observer"), ALL)
def test_axis_point_and_pitch_make_the_wrench(name, frame, observer):
    """w = (s ; (u - p) x s + h s) about the tool point p, u a point of the axis; a couple is (0 ; s)."""
    for _, answer in answers(name, frame, observer):
        origin = tool(answer.mechanism, answer.q, at_tool=True)[:3, 3]
        for lost in answer.lost:
            assert np.linalg.norm(lost.axis) == pytest.approx(1)
            if math.isinf(lost.pitch):
                assert lost.point is None
                expected = np.concatenate([np.zeros(3), lost.axis])
                assert "cannot turn" in lost.words
            else:
                moment = np.cross(lost.point - origin, lost.axis) + lost.pitch * lost.axis
                expected = np.concatenate([lost.axis, moment])
                assert ("cannot move" in lost.words) == (lost.pitch == 0)
                assert ("only as it turns about it" in lost.words) == (lost.pitch != 0)
                # The point is the one of the axis next to the tool point.
                assert abs((lost.point - origin) @ lost.axis) < 1e-9
            np.testing.assert_allclose(lost.wrench, expected, atol=3e-6 * max(1, answer.mechanism.length))
            assert frame in lost.words


@pytest.mark.parametrize(("name", "frame", "observer"), ALL)
def test_the_lost_direction_is_no_structural_deficit(name, frame, observer):
    """Where the structure never has all rows: close by, the lost wrench does work on some column."""
    random = np.random.default_rng(3)
    for _, answer in answers(name, frame, observer):
        arm = answer.mechanism
        near = answer.q + 0.05 * units(arm) * random.normal(size=(20, len(arm.names)))
        matrices = columns(arm, near, at_tool=True) * units(arm)
        for lost in answer.lost:
            size = np.linalg.norm(lost.wrench * np.array([arm.length] * 3 + [1.0] * 3))
            assert np.max(np.abs(lost.wrench @ matrices)) > 1e-4 * size


@pytest.mark.parametrize(("name", "frame", "observer"), ALL)
def test_self_motions_move_nothing(name, frame, observer):
    for _, answer in answers(name, frame, observer):
        arm = answer.mechanism
        matrix = columns(arm, answer.q)[list(arm.task.rows)]
        assert len(answer.self_motions) == len(arm.names) - answer.rank
        for motion in answer.self_motions:
            assert np.max(np.abs(motion.rates)) == pytest.approx(1)
            assert np.max(np.abs(matrix @ motion.rates)) < 1e-7 * max(1, float(np.max(np.abs(matrix))))


# --- walks: the tool kept where it is by Newton's method on Pinocchio's placement ------------------------------------


def walked(arm, start, rates, far=0.15, step=0.01):
    """Return how far along the rates a walk gets with the tool at rest, in rad or L."""
    home, u = tool(arm, start), units(arm)
    along = rates / u / np.linalg.norm(rates / u)
    q, gone, heading = start.copy(), 0.0, along
    while gone < far:
        trial = q + step * heading * u
        for _ in range(25):
            gap = moved_away(arm, home, trial)
            if np.max(np.abs(gap)) < 1e-12:
                break
            matrix = pure(arm, trial)
            trial = trial - u * (np.linalg.pinv(matrix, rcond=1e-8) @ gap)
            if np.linalg.norm((trial - q) / u) > 10 * step:
                return gone
        moved = (trial - q) / u
        if np.max(np.abs(moved_away(arm, home, trial))) > 1e-10 or moved @ heading < step / 3:
            return gone
        gone += float(np.linalg.norm(moved))
        q, heading = trial, moved / np.linalg.norm(moved)
    return gone


@pytest.mark.parametrize(("name", "frame", "observer"), [*ARMS[:3], LEGS[0], LEGS[5], *BOOKS])
def test_finite_self_motions_can_be_walked_and_others_cannot(name, frame, observer):
    """Of arms with one motion inside. To the square of a step the tool leaves where the motion is instantaneous."""
    for _, answer in answers(name, frame, observer):
        if len(answer.self_motions) != 1:
            continue
        motion, arm = answer.self_motions[0], answer.mechanism
        gone = max(walked(arm, answer.q, motion.rates), walked(arm, answer.q, -motion.rates))
        if motion.finite:
            assert gone > 0.1
        else:
            assert gone < 0.02


# --- kinds: which side of the singularity the tool can get to --------------------------------------------------------


def lost_displacement(arm, q, lost, inside, step):
    """Return how far the tool goes along the lost wrench, per step^2, on curves q + step v that go nowhere else.

    Along each of the rates v (columns of `inside`) the rest of the displacement is taken back by the other joints.
    """
    home, u = tool(arm, q), units(arm)
    matrix = pure(arm, q)
    left, values, right = np.linalg.svd(matrix)
    rank = int(np.sum(values > 1e-6))
    back = right[:rank].T / values[:rank] @ left[:, :rank].T
    found = []
    for v in inside.T:
        trial = q + step * v * u
        for _ in range(6):
            trial = trial - u * (back @ moved_away(arm, home, trial))
        found.append(lost @ moved_away(arm, home, trial) / step**2)
    return np.array(found)


def null_spaces(arm, q):
    left, values, right = np.linalg.svd(pure(arm, q))
    rank = int(np.sum(values > 1e-6))
    return left[:, rank:], right[rank:].T, rank


@pytest.mark.parametrize(("name", "frame", "observer"), [*ARMS, LEGS[0], LEGS[2], LEGS[5], *FINGERS[1:], *BOOKS])
def test_a_fold_is_seen_from_one_side_and_a_tangential_one_is_not_left(name, frame, observer):
    """Of arms that lose one direction and have one motion inside, and of which every row is there elsewhere."""
    for _, answer in answers(name, frame, observer):
        arm = answer.mechanism
        lost, inside, rank = null_spaces(arm, answer.q)
        if lost.shape[1] != 1 or inside.shape[1] != 1 or rank != arm.generic_rank - 1:
            continue
        there, back = (lost_displacement(arm, answer.q, lost[:, 0], inside, step)[0] for step in (2e-3, -2e-3))
        assert answer.kind in ("fold", "tangential")
        if answer.kind == "fold":
            assert np.sign(there) == np.sign(back)
            assert abs(there) > 1e-7
            assert there == pytest.approx(back, rel=0.3)
        else:
            assert max(abs(there), abs(back)) < (1e-6 if arm.rounded else 1e-8)


@pytest.mark.parametrize(("name", "frame", "observer"), [*ARMS[:3], LEGS[0], LEGS[2], BOOKS[8], BOOKS[9]])
def test_a_fold_is_where_the_determinant_changes_along_the_motion_inside(name, frame, observer):
    """Of square arms: there two branches of inverse kinematics meet, det of one sign on each."""
    for _, answer in answers(name, frame, observer):
        arm = answer.mechanism
        lost, inside, _ = null_spaces(arm, answer.q)
        if lost.shape[1] != 1 or len(arm.names) != len(arm.task.rows):
            continue
        others = np.prod(np.linalg.svd(pure(arm, answer.q), compute_uv=False)[:-1])
        v = inside[:, 0] * units(arm)
        along = derivative(lambda t, arm=arm, q=answer.q, v=v: np.linalg.det(pure(arm, q + np.outer(t, v))))
        assert (abs(along) / others > (1e-5 if arm.rounded else 1e-6)) == (answer.kind == "fold")


@pytest.mark.parametrize(("name", "frame", "observer"), [REDUNDANT[0], REDUNDANT[3]])
def test_a_boundary_is_seen_from_one_side_whatever_moves_inside(name, frame, observer):
    """Of redundant arms that lose one direction: boundary or traversable, by where random motions inside take it."""
    random, kinds = np.random.default_rng(8), set()
    for _, answer in answers(name, frame, observer):
        arm = answer.mechanism
        lost, inside, _ = null_spaces(arm, answer.q)
        if lost.shape[1] != 1:
            continue
        mixed = inside @ random.normal(size=(inside.shape[1], 60))
        mixed /= np.linalg.norm(mixed, axis=0)
        found = lost_displacement(arm, answer.q, lost[:, 0], mixed, 1e-3)
        size = float(np.max(np.abs(found)))
        kinds.add(answer.kind)
        if answer.kind == "tangential":
            assert size < 1e-2
        elif answer.kind == "boundary":
            one_sided = min(np.max(found), -np.min(found))
            assert max(one_sided, 0.0) < 0.02 * size
        else:
            assert np.max(found) > 1e-8
            assert np.min(found) < -1e-8
    assert kinds >= {"traversable"}


def test_words_say_direction_and_line():
    straight = ks.singular_at(robot("textbook:planar_2r"), "tool", [0.0, 0.0])
    assert straight.lost[0].words == "tool cannot move along x of base; it resists any force along this line"
    wrist = ks.singular_at(robot("textbook:wrist_zyz"), "tool", [0.0, 0.0, 0.4])
    assert "tool cannot" in wrist.lost[0].words


def test_a_lost_turn_is_a_couple():
    """A wrist asked for rotations alone: at s2 = 0 it cannot turn about x, its middle axis being y."""
    answer = ks.singular_at(robot("textbook:wrist_zyz"), "tool", [0.0, 0.0, 0.4], axes="rx ry rz")
    assert answer.singular
    lost = answer.lost[0]
    assert math.isinf(lost.pitch)
    np.testing.assert_allclose(lost.wrench, [0, 0, 0, 1, 0, 0], atol=1e-12)
    assert lost.words == "tool cannot turn about x of base; it resists any moment about it"
