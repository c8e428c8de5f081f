"""Families of real robots: every witness is singular on both engines, and stays so where its family takes it."""

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.singular.search import converge
from kinetostat.engines.screw import ScrewEngine
from singular.arms import (
    ARMS,
    FINGERS,
    LEGS,
    REDUNDANT,
    decisive,
    families,
    near_angle,
    pure,
    robot,
    units,
    whole,
)

ALL = (*ARMS, *REDUNDANT, LEGS[0], LEGS[2], *LEGS[5:7], LEGS[9], *FINGERS)
SIMPLE = tuple(arm for arm in ALL if arm not in REDUNDANT)
# TIAGo, Baxter and xArm have surfaces, or rounded positions, that other joints matter to a little.
MOVED = tuple(arm for arm in ALL if arm[0] not in ("tiago", "baxter", "xarm7"))
PARTS = [
    ("talos_reduced", "gripper_left_base_link", "torso_2_link"),
]


def by_screws(arm, q):
    """Return the decisive singular value by the in-house engine: rows and columns picked here."""
    engine = ScrewEngine(arm.model.robot)
    where = [arm.model.robot.velocity_slices[j.name] for j in dict.fromkeys(arm.joints)]
    matrix = engine.jacobian(whole(arm, q), arm.velocity)
    rows = list(arm.task.rows)
    picked = np.concatenate([matrix[..., part] for part in where], -1)[..., rows, :] * units(arm)
    picked = picked / np.where(np.array(rows) < 3, arm.length, 1.0)[:, None]
    return np.linalg.svd(picked, compute_uv=False)[..., arm.generic_rank - 1]


@pytest.mark.parametrize(("name", "frame", "observer"), ALL)
def test_witnesses_are_singular_on_both_engines(name, frame, observer):
    result = families(name, frame, observer)
    assert result.families
    for family in result.families:
        assert decisive(result.mechanism, family.witness) < 1e-9
        assert by_screws(result.mechanism, family.witness) < 1e-9
        assert family.singular_values[result.mechanism.generic_rank - 1] < 1e-9
        values = np.linalg.svd(pure(result.mechanism, family.witness), compute_uv=False)
        np.testing.assert_allclose(family.singular_values, values, atol=1e-12 * max(1, values[0]) + 1e-12)
    assert result.certificate.agree is True


@pytest.mark.parametrize(("name", "frame", "observer"), ALL)
def test_conditions_keep_the_arm_singular_whatever_the_others_do(name, frame, observer):
    """Explicit families: the positions held, all else anywhere."""
    result = families(name, frame, observer)
    arm, random = result.mechanism, np.random.default_rng(1)
    for family in result.families:
        if family.implicit:
            continue
        q = arm.draw(random, (200,))
        for joint, position in family.positions.items():
            q[:, arm.names.index(joint)] = position
        assert np.max(decisive(arm, q)) < (1e-8 if family.tolerance == "strict" else 1e-5)


@pytest.mark.parametrize(("name", "frame", "observer"), MOVED)
def test_a_witness_moved_along_its_family_stays_singular(name, frame, observer):
    """Joints that are not in the support go anywhere; surfaces are followed by projecting back to them."""
    result = families(name, frame, observer)
    arm, random = result.mechanism, np.random.default_rng(2)
    for family in result.families:
        free = [i for i, joint in enumerate(arm.names) if joint not in family.support]
        q = np.repeat(family.witness[None], 20, axis=0)
        q[:, free] = arm.draw(random, (20,))[:, free]
        assert np.max(decisive(arm, q)) < (1e-8 if family.tolerance == "strict" else 1e-5)


@pytest.mark.parametrize(("name", "frame", "observer"), SIMPLE)
def test_every_joint_of_a_support_matters(name, frame, observer):
    """Each alone, moved by a good angle, leaves the singularity at some of its positions."""
    result = families(name, frame, observer)
    arm = result.mechanism
    for family in result.families:
        for joint in family.support:
            q = np.repeat(family.witness[None], 12, axis=0)
            i = arm.names.index(joint)
            q[:, i] += units(arm)[i] * np.linspace(0.2, 1.3, 12)
            assert np.max(decisive(arm, q)) > 1e-4, (family.positions, joint)


@pytest.mark.parametrize(("name", "frame", "observer"), SIMPLE)
def test_nothing_is_missing_that_a_search_finds(name, frame, observer):
    """Other searches, from other starts, end on a family that is in the list: its positions, or its surface."""
    result = families(name, frame, observer)
    arm = result.mechanism
    q, smallest = converge(arm, arm.draw(np.random.default_rng(99), (150,)))
    surfaces = [family for family in result.families if family.implicit]
    for x in q[smallest < 1e-9]:
        on = any(
            all(near_angle(x[arm.names.index(joint)], position) < 2e-3 for joint, position in family.positions.items())
            for family in result.families
            if not family.implicit
        )
        assert on or surfaces


@pytest.mark.parametrize(("name", "frame", "observer"), ALL)
def test_no_family_is_there_twice(name, frame, observer):
    """Explicit families differ by a position, or by their joints."""
    explicit = [family for family in families(name, frame, observer).families if not family.implicit]
    for i, one in enumerate(explicit):
        for other in explicit[:i]:
            same = one.positions.keys() == other.positions.keys() and all(
                near_angle(one.positions[j], other.positions[j]) < 1e-3 for j in one.positions
            )
            assert not same, one.positions


@pytest.mark.parametrize(("name", "frame", "observer"), ALL)
def test_families_inside_limits_have_a_witness_inside_limits(name, frame, observer):
    result = families(name, frame, observer)
    arm = result.mechanism
    lower, upper = (
        np.array([joint.limit.range[k] if joint.type.nq == 1 else (-np.inf, np.inf)[k] for joint in arm.joints])
        for k in (0, 1)
    )
    order = [family.inside_limits for family in result.families]
    assert order == sorted(order, reverse=True)  # those inside first
    for family in result.families:
        inside = bool(np.all((family.witness >= lower - 1e-6) & (family.witness <= upper + 1e-6)))
        assert inside == family.inside_limits, family.positions
        if not family.implicit and not family.inside_limits:
            # Some held position is outside, whatever whole turns are added.
            assert any(
                not any(
                    lower[i] - 1e-6 <= position + 2 * np.pi * turn <= upper[i] + 1e-6
                    for turn in ((0, -1, 1, -2, 2) if arm.turning[i] else (0,))
                )
                for joint, position in family.positions.items()
                for i in [arm.names.index(joint)]
            )


@pytest.mark.parametrize(("name", "frame", "observer"), SIMPLE)
def test_hits_are_all_the_searches(name, frame, observer):
    result = families(name, frame, observer)
    assert result.converged <= result.starts
    assert sum(family.hits for family in result.families) + result.unclassified >= result.converged
    once = sum(family.hits == 1 for family in result.families)
    assert result.coverage.seen_once == once
    assert result.coverage.unseen == pytest.approx(once / result.converged)


@pytest.mark.parametrize(("name", "frame", "observer"), PARTS)
def test_arms_inside_bigger_robots_take_seconds(name, frame, observer):
    from time import process_time

    start = process_time()
    result = ks.singular_find(robot(name), frame, relative_to=observer)
    assert process_time() - start < 10  # five seconds of two cores
    assert result.converged > 700
    assert len(result.families) >= 3


def test_joints_off_the_path_never_matter():
    """An arm of a robot and the same arm cut out of it have the same families."""
    inside = families("tiago", "arm_tool_link", "torso_lift_link")
    assert all(joint.startswith("arm_") for joint in inside.mechanism.names)
    model, arm = robot("tiago"), inside.mechanism
    witness = inside.families[0].witness
    full = ks.random_configurations(model.robot, 3, (5,))
    full[:, list(arm.indices)] = witness
    answers = [ks.singular_at(model, "arm_tool_link", q, relative_to="torso_lift_link") for q in full[:2]]
    assert [a.singular for a in answers] == [True, True]
    np.testing.assert_allclose(answers[0].singular_values, answers[1].singular_values, atol=1e-12)


@pytest.mark.parametrize("name", ["textbook:puma560", "textbook:stanford", "textbook:scara"])
def test_other_seeds_give_the_same_families(name):
    def told(seed):
        result = families(name, "tool", seed=seed)
        return {
            (f.name, f.kind, tuple((j, round(p, 7)) for j, p in f.positions.items()), f.support, f.inside_limits)
            for f in result.families
        }

    assert told(0) == told(2) == told(7)


def test_equal_seeds_give_equal_numbers():
    model = robot("panda")
    one, other = (ks.singular_find(model, "panda_hand", starts=150, seed=5) for _ in range(2))
    assert [f.positions for f in one.families] == [f.positions for f in other.families]
    assert [f.hits for f in one.families] == [f.hits for f in other.families]
    for a, b in zip(one.families, other.families, strict=True):
        np.testing.assert_array_equal(a.witness, b.witness)


def test_mirrored_arms_have_mirrored_families():
    """Left and right legs: as many families, of the same kinds and codimensions."""
    left = families("a1", "FR_foot")
    right = families("a1", "FL_foot")
    key = lambda result: sorted((f.kind, f.codimension, f.implicit, f.inside_limits) for f in result.families)  # noqa: E731
    assert key(left) == key(right)


def test_an_arm_seen_from_its_hand_has_the_same_singular_configurations():
    model = robot("textbook:puma560")
    q = families("textbook:puma560", "tool").families[2].witness
    forwards = ks.singular_at(model, "tool", q)
    backwards = ks.singular_at(model, "base", q, relative_to="tool")
    assert forwards.singular
    assert backwards.singular
    assert forwards.rank == backwards.rank
    assert set(backwards.mechanism.names) == set(forwards.mechanism.names)
    result = ks.singular_find(model, "base", relative_to="tool", starts=100)
    there = {(j, round(p, 7)) for f in result.families for j, p in f.positions.items()}
    here = {(j, round(p, 7)) for f in families("textbook:puma560", "tool").families for j, p in f.positions.items()}
    assert there == here


def test_progress_is_told():
    told = []
    ks.singular_find(
        robot("textbook:planar_2r"), "tool", starts=500, progress=lambda what, share: told.append((what, share))
    )
    assert told[0][1] == 0.0
    assert told[-1][1] == 1.0
    assert all(0 <= share <= 1 for _, share in told)
    assert "searching" in {what for what, _ in told}
