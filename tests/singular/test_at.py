"""`singular_at`: no at random configurations, yes at witnesses and with the same words, and structure told apart."""

import numpy as np
import pytest

import kinetostat as ks
from singular.arms import (
    ARMS,
    FINGERS,
    LEGS,
    REDUNDANT,
    TEXTBOOK,
    answers,
    columns,
    decisive,
    families,
    pure,
    robot,
    whole,
)
from trees import load_text

HALF = np.pi / 2
ALL = (*ARMS[:4], ARMS[5], *REDUNDANT[:3], *LEGS[:3], LEGS[5], LEGS[9], *FINGERS)
SOME = (*ARMS, REDUNDANT[0], REDUNDANT[3], LEGS[0], LEGS[2], LEGS[5], LEGS[9], *FINGERS)
BOOKS = tuple((f"textbook:{name}", "tool", None) for name in TEXTBOOK)


def ask(arm, q, **asked):
    return ks.singular_at(arm.model, arm.velocity.of, whole(arm, q), relative_to=arm.velocity.relative_to, **asked)


@pytest.mark.parametrize(("name", "frame", "observer"), ALL)
def test_random_configurations_are_not_singular(name, frame, observer):
    model = robot(name)
    for q in ks.random_configurations(model.robot, 11, (1,)):
        answer = ks.singular_at(model, frame, q, relative_to=observer)
        assert not answer.singular
        assert (answer.tolerance, answer.kind, answer.name) == (None, None, None)
        assert (answer.lost, answer.causes, answer.conditions) == ((), (), ())
        arm = answer.mechanism
        assert answer.rank == arm.generic_rank
        assert answer.certificate.agree is True
        # What moves inside is what redundancy there is, and moves nothing.
        assert len(answer.self_motions) == len(arm.names) - arm.generic_rank
        for motion in answer.self_motions:
            rates = motion.rates
            assert np.max(np.abs(columns(arm, answer.q, at_tool=True)[list(arm.task.rows)] @ rates)) < 1e-9
            assert motion.finite  # a regular configuration of a redundant arm: it can always be walked
        assert answer.distance.distance is None or answer.distance.distance > 1e-5


@pytest.mark.parametrize(("name", "frame", "observer"), SOME + BOOKS)
def test_witnesses_are_singular_and_told_alike(name, frame, observer):
    for family, answer in answers(name, frame, observer):
        assert answer.singular
        assert answer.tolerance == "strict"
        assert answer.rank == int(np.sum(np.linalg.svd(pure(answer.mechanism, answer.q), compute_uv=False) > 1e-5))
        assert answer.kind in family.kind.split(" or ")
        assert answer.distance.distance == 0
        assert len(answer.lost) == answer.mechanism.generic_rank - answer.rank
        if not family.implicit and family.tolerance == "strict":
            assert answer.name == family.name
            positions = [condition.positions for condition in answer.conditions]
            assert any(condition.keys() <= family.positions.keys() for condition in positions)
        assert {cause.text for cause in answer.causes} == {cause.text for cause in family.causes}


@pytest.mark.parametrize(("name", "frame", "observer"), [*ARMS[:3], LEGS[0], LEGS[5], BOOKS[8]])
def test_two_families_at_once(name, frame, observer):
    """Held positions of two families together: still singular, both named, the rank no higher."""
    result = families(name, frame, observer)
    arm = result.mechanism
    explicit = [f for f in result.families if not f.implicit and len(f.positions) == 1]
    pairs = [(a, b) for a in explicit for b in explicit if a.positions.keys() < b.positions.keys() | a.positions.keys()]
    pairs = [(a, b) for a, b in pairs if set(a.positions).isdisjoint(b.positions)][:2]
    for a, b in pairs:
        q = arm.draw(np.random.default_rng(4), ())
        for joint, position in (*a.positions.items(), *b.positions.items()):
            q[arm.names.index(joint)] = position
        answer = ask(arm, q)
        assert answer.singular
        assert answer.rank <= arm.generic_rank - 1
        assert {tuple(c.positions) for c in answer.conditions} >= {tuple(a.positions), tuple(b.positions)}
        assert set((answer.name or "").split(" and ")) == {a.name, b.name}


# --- structure is no singularity -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "frame", "rank", "count"),
    [("so100", "gripper", 5, 5), ("textbook:scara", "tool", 4, 4), ("textbook:planar_3r", "tool", 3, 3)],
)
def test_structural_deficits_are_told_apart(name, frame, rank, count):
    model = robot(name)
    q = ks.random_configurations(model.robot, 2, ())
    answer = ks.singular_at(model, frame, q)
    assert not answer.singular
    assert (answer.rank, answer.mechanism.generic_rank, len(answer.singular_values)) == (rank, rank, count)
    assert len(answer.warnings) == 1 + answer.mechanism.rounded
    assert f"rank {rank} of 6" in answer.warnings[0]
    assert "no singularity" in answer.warnings[0]


def test_a_planar_arm_asked_for_what_it_has():
    answer = ks.singular_at(robot("textbook:planar_3r"), "tool", [0.2, 0.5, -0.3], axes="x y rz")
    assert answer.warnings == ()
    assert len(answer.singular_values) == 3
    assert not answer.singular


def test_a_straight_planar_arm_loses_one_direction_of_six():
    """Three rows are never there; what the straight elbow takes is the force along the links."""
    answer = ks.singular_at(robot("textbook:planar_3r"), "tool", [0.4, 0.0, 0.7])
    assert (answer.rank, answer.mechanism.generic_rank) == (2, 3)
    assert len(answer.lost) == 1
    lost = answer.lost[0]
    assert abs(lost.wrench[2]) < 1e-9  # not one of those that are always unfelt
    np.testing.assert_allclose(np.abs(lost.axis @ [np.cos(0.4), np.sin(0.4), 0]), 1, atol=1e-9)


# --- what is asked ---------------------------------------------------------------------------------------------------


def test_a_point_on_the_tool():
    """Only positions count for three joints: where the point is decides. Of all six rows it says nothing."""
    model = robot("textbook:puma560")
    q = np.array([0.1, 0.4, np.arctan2(-0.4318, 0.0203), 0.5, 0.7, 0.2])
    for point in ((0, 0, 0), (0.1, 0.2, 0.3)):
        answer = ks.singular_at(model, "tool", q, point=point)
        assert answer.singular
        assert answer.rank == 5
    planar = robot("textbook:planar_2r")
    assert ks.singular_at(planar, "tool", [0.3, 0.0]).singular
    assert not ks.singular_at(planar, "tool", [0.3, 0.0], point=(0, 0.2, 0)).singular
    assert ks.singular_at(planar, "tool", [0.3, np.arctan2(-0.2, 0.8)], point=(0, 0.2, 0)).singular


def test_rows_are_in_the_observers_axes():
    planar = robot("textbook:planar_2r")
    with_x = ks.singular_at(planar, "tool", [0.0, 0.0], axes="x")
    with_y = ks.singular_at(planar, "tool", [0.0, 0.0], axes="y")
    assert with_x.singular
    assert with_x.rank == 0
    assert not with_y.singular
    rotation = ks.singular_at(robot("textbook:puma560"), "tool", [0.3, 0.1, 0.2, 0.5, 0.0, 0.1], axes="rx ry rz")
    assert not rotation.singular  # turned by the arm's joints as well
    assert rotation.mechanism.task.row_names == ("wx", "wy", "wz")


def test_relative_to_a_link_of_the_arm():
    """From the forearm on, only the wrist counts."""
    model = robot("textbook:puma560")
    straight = np.array([0.1, 0.4, np.arctan2(-0.4318, 0.0203), 0.5, 0.7, 0.2])
    assert ks.singular_at(model, "tool", straight).singular
    asked = {"relative_to": "link3", "axes": "rx ry rz", "point": (0, 0, 0.1)}
    assert not ks.singular_at(model, "tool", straight, **asked).singular
    bent = straight + 0.4 * np.eye(6)[2]
    bent[4] = 0
    answer = ks.singular_at(model, "tool", bent, **asked)
    assert answer.singular
    assert answer.mechanism.names == ("joint4", "joint5", "joint6")
    assert answer.name == "wrist"


def test_a_frame_in_the_middle_of_a_chain():
    result = ks.singular_find(robot("ur5_robot"), "wrist_1_link", starts=200)
    assert result.mechanism.names == ("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint")
    assert {round(abs(f.positions["elbow_joint"]), 6) for f in result.families if f.positions} == {0, 3.141593}
    answer = ks.singular_at(robot("ur5_robot"), "wrist_1_link", [0.3, -1, 0, 0.4, 0, 0.1])
    assert answer.singular
    assert answer.name == "elbow"


def test_joints_beyond_the_frame_and_beside_the_path_never_matter():
    model = robot("pr2")
    q = ks.random_configurations(model.robot, 7, (4,))
    where = [
        model.engine.position_names.index(j)
        for j in ("r_shoulder_pan_joint", "r_shoulder_lift_joint", "r_elbow_flex_joint")
    ]
    said = []
    for one in q:
        full = one.copy()
        arm = ks.singular_at(model, "r_gripper_tool_frame", q[0], relative_to="torso_lift_link").mechanism
        full[list(arm.indices)] = q[0][list(arm.indices)]
        full[where[2]] = 0.0
        said.append(ks.singular_at(model, "r_gripper_tool_frame", full, relative_to="torso_lift_link"))
    assert {a.singular for a in said} == {True}
    assert len({a.rank for a in said}) == 1
    assert len({a.name for a in said}) == 1
    np.testing.assert_allclose(said[0].singular_values, said[-1].singular_values, atol=1e-12)


# --- tolerances ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("off", "tolerance"), [(0.0, "strict"), (1e-10, "strict"), (1e-6, "model"), (5e-6, "model"), (1e-3, None)]
)
def test_strict_model_or_not_singular(off, tolerance):
    q = np.array([0.3, -1.0, off, 0.4, 0.9, 0.1])
    answer = ks.singular_at(robot("ur5_robot"), "tool0", q)
    assert answer.tolerance == tolerance
    assert answer.singular == (tolerance is not None)
    expected = decisive(answer.mechanism, q)
    assert answer.singular_values[-1] == pytest.approx(expected, abs=1e-13)
    if tolerance is not None:
        assert answer.kind == "fold"
        assert answer.name == "elbow"


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_the_unit_of_length_does_not_matter(scale):
    """The same arm in millimetres and in kilometres: the same singular values, rank and words."""
    text = PLAIN.replace("@", f"{0.4 * scale}").replace("#", f"{0.3 * scale}")
    model = load_text(text)
    straight = ks.singular_at(model, "hand", [0.2, 0.5, 0.0])
    bent = ks.singular_at(model, "hand", [0.2, 0.5, 0.8])
    plain = ks.singular_at(load_text(PLAIN.replace("@", "0.4").replace("#", "0.3")), "hand", [0.2, 0.5, 0.8])
    assert (straight.singular, straight.kind, straight.name) == (True, "fold", "elbow")
    assert not bent.singular
    np.testing.assert_allclose(bent.singular_values, plain.singular_values, rtol=1e-9)
    assert bent.mechanism.length == pytest.approx(scale * plain.mechanism.length)
    assert bent.distance.distance == pytest.approx(plain.distance.distance, rel=1e-6)


PLAIN = """<robot name="plain"><link name="a"/><link name="b"/><link name="c"/><link name="d"/><link name="hand"/>
<joint name="yaw" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
<joint name="lift" type="continuous"><parent link="b"/><child link="c"/><axis xyz="0 1 0"/></joint>
<joint name="bend" type="continuous"><parent link="c"/><child link="d"/><origin xyz="@ 0 0"/><axis xyz="0 1 0"/></joint>
<joint name="end" type="fixed"><parent link="d"/><child link="hand"/><origin xyz="# 0 0"/></joint></robot>"""


def test_an_arm_of_one_joint_is_never_singular():
    for name in ("planar_1r", "helical", "skew_1p"):
        model = robot(f"textbook:{name}")
        answer = ks.singular_at(model, model.robot.default_tip(), [0.0])
        assert not answer.singular
        assert answer.distance.distance is None


def test_a_long_chain():
    """From one hand of a humanoid to the other: fourteen joints, no trouble."""
    answer = ks.singular_at(robot("baxter"), "right_hand_link", np.zeros(17), relative_to="left_hand_link")
    assert len(answer.mechanism.names) == 14
    assert answer.rank == answer.mechanism.generic_rank == 6


# --- lengths that are nothing but rounding ---------------------------------------------------------------------------


@pytest.mark.parametrize("q5", [0.4, 0.0])
def test_a_tool_point_in_which_all_axes_meet_has_no_length(q5):
    """The Puma's tool is its wrist centre: from the forearm, linear rows are rounding, and only the turns count."""
    answer = ks.singular_at(robot("textbook:puma560"), "tool", [0.1, 0.4, 0.3, 0.5, q5, 0.2], relative_to="link3")
    assert answer.singular == (q5 == 0)
    assert answer.mechanism.generic_rank == 3
    assert answer.mechanism.length == 1.0
    assert answer.certificate.tolerance < 1e-10


@pytest.mark.parametrize(("name", "frame"), [("tiago", "wheel_right_link"), ("iris_description/iris", "iris__rotor_2")])
def test_a_wheel_is_never_singular(name, frame):
    model = robot(name)
    answer = ks.singular_at(model, frame, ks.random_configurations(model.robot, 1, ()))
    assert (answer.singular, answer.rank, answer.mechanism.generic_rank) == (False, 1, 1)
    assert answer.certificate.tolerance < 1e-10


@pytest.mark.parametrize(
    ("name", "frame", "observer"),
    [
        ("panda", "panda_hand", None),
        ("tiago", "arm_tool_link", "torso_lift_link"),
        ("z1", "gripperStator", None),
        ("textbook:puma560", "tool", None),
        ("textbook:anthropomorphic", "tool", None),
    ],
)
def test_a_witness_has_the_name_of_its_family(name, frame, observer):
    model = robot(name)
    found = ks.singular_find(model, frame, relative_to=observer, starts=300)
    rest = ks.configuration(model, "zero").q
    assert any(family.name for family in found.families)
    for family in found.families:
        answer = ks.singular_at(model, frame, found.mechanism.configuration(family.witness, rest), relative_to=observer)
        assert answer.name == family.name, family.positions


def test_a_configuration_typed_with_few_digits_is_told_as_the_exact_one():
    model = robot("ur5_robot")
    exact, typed = (np.array([0.0, -1, 1, 0.5, wrist, 0.2]) for wrist in (np.pi, 3.1416))
    first, second = (ks.singular_at(model, "tool0", q) for q in (exact, typed))
    assert (first.tolerance, second.tolerance) == ("strict", "model")
    assert [condition.positions for condition in second.conditions] == [{"wrist_2_joint": np.pi}]
    assert (first.kind, first.name) == (second.kind, second.name) == ("tangential", "wrist")
    for one, other in zip(first.self_motions, second.self_motions, strict=True):
        assert one.finite
        assert other.finite
        np.testing.assert_allclose(one.rates, other.rates, atol=1e-4)
    assert second.lost[0].pitch == 0
