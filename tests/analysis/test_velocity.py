"""Laws of velocities and accelerations: against placements differenced in time, Jacobians, adjoints; then textbook."""

from functools import cache

import numpy as np
import pytest

import differences
import kinetostat as ks
from kinetostat.conventions import Velocity
from textbook_support import assert_same, planar_tip, textbook, vector_of
from trees import random_tree

KINDS = ("revolute", "continuous", "prismatic", "screw", "planar", "floating")
TREES = [(seed, seed % 3 == 0) for seed in range(500, 512)]
REAL = ("panda", "solo12", "tiago", "pr2", "talos_full_v2", "allegro_left_hand", "double_pendulum_continuous")
# Rounding of a six-point difference is about 2e-13 of the size of what is differenced, whatever moves.
WITNESSED = 2e-11


@cache
def tree(seed, floating=False, kinds=None):
    asked = {} if kinds is None else {"kinds": kinds, "most": 4}
    return random_tree(seed, floating_base=floating, **asked)


def drawn(model, seed, shape=()):
    """Return a configuration, rates and accelerations whose sums are at most one."""
    generator, nv = np.random.default_rng(seed), model.robot.nv
    rates, pushed = generator.uniform(-1, 1, (2, *shape, nv)) / max(1, nv)
    return ks.random_configurations(model, seed, shape), rates, pushed


def frames_of(model, seed):
    """Return any frame, observer and axes."""
    names = [link.name for link in model.robot.links]
    return (names[int(i)] for i in np.random.default_rng(seed).integers(len(names), size=3))


def size(model):
    return max(1.0, 2 * model.robot.reach + model.robot.nv) * model.robot.largest_multiplier


def same(model, actual, expected, atol=WITNESSED):
    np.testing.assert_allclose(actual, expected, rtol=0, atol=atol * size(model))


def asked(model, q, qdot, **words):
    """Return motions on which both engines agree."""
    result = ks.velocity(model, q, qdot, **words)
    assert result.certificate.engines == ("pinocchio", "screw")
    assert result.certificate.agree, result.certificate
    return result


def line(screw, k=0):
    """Return axis, point, pitch and rate of a frame's screw."""
    return screw.axis[..., k, :], screw.point[..., k, :], screw.pitch[..., k], screw.rate[..., k]


# --- velocities are derivatives of placements ----------------------------------------------------------------------


def assert_twists_are_derivatives_of_placements(model, seed):
    q, qdot, _ = drawn(model, seed)
    frame, observer, axes = frames_of(model, seed)
    result = asked(model, q, qdot, frames=frame, relative_to=observer, expressed_in=axes)
    for found, where in ((result.twist, axes), (result.body_twist, frame)):
        label = Velocity(frame, observer, where)
        same(model, found[0], differences.twist(model.engine, model.robot, q, qdot, label))
    same(model, result.origin[0], model.engine.placement(q, frame, axes)[:3, 3], 1e-12)


@pytest.mark.parametrize(("seed", "floating"), TREES)
def test_twists_on_random_trees(seed, floating):
    assert_twists_are_derivatives_of_placements(tree(seed, floating), seed)


@pytest.mark.parametrize("kind", KINDS)
def test_joint_by_joint(kind):
    for seed in range(3):
        model = tree(seed, kinds=(kind,))
        assert_twists_are_derivatives_of_placements(model, seed)
        assert_accelerations_are_derivatives_of_twists(model, seed)


# --- accelerations are derivatives of velocities -------------------------------------------------------------------


def assert_accelerations_are_derivatives_of_twists(model, seed):
    """Along a motion whose rates grow by qddot: the observer moves too, and turns."""
    q, qdot, qddot = drawn(model, seed)
    frame, observer, axes = frames_of(model, seed)
    result = asked(model, q, qdot, frames=frame, relative_to=observer, expressed_in=axes, qddot=qddot)

    def along(what):
        def curve(times):
            path = differences.moved(model.robot, q, qdot, times)
            rates = qdot + np.multiply.outer(times, qddot)
            return getattr(ks.velocity(model, path, rates, frames=frame, relative_to=observer), what)[:, 0]

        return differences.derivative(curve)

    same(model, result.spatial_acceleration[0], along("body_twist"))
    seen = along("twist")  # the observer's own axes do not turn for it: this is the second derivative of the origin
    turn = model.engine.placement(q, observer, axes)[:3, :3]
    same(model, result.classical_acceleration[0], np.concatenate([turn @ seen[:3], turn @ seen[3:]]))


@pytest.mark.parametrize(("seed", "floating"), TREES)
def test_accelerations_on_random_trees(seed, floating):
    assert_accelerations_are_derivatives_of_twists(tree(seed, floating), seed)


@pytest.mark.parametrize("name", REAL)
def test_velocities_and_accelerations_are_those_of_the_jacobians(name):
    """V = J qdot and its rate: every link of a real robot from the base, and one from a hand that moves."""
    model = ks.load(f"example:{name}", floating_base=name == "talos_full_v2")
    q, qdot, qddot = drawn(model, 7)
    tip = max(model.robot.tips, key=lambda link: len(list(model.robot.to_root(link))))
    everything = asked(model, q, qdot, qddot=qddot)
    assert everything.frames == tuple(link.name for link in model.robot.links)
    for observer, frames in ((None, everything.frames[::5]), (tip, everything.frames[1::9])):
        result = asked(model, q, qdot, frames=frames, relative_to=observer, qddot=qddot)
        for k, frame in enumerate(frames):
            for reference, velocity, acceleration in (
                ("aligned", result.twist, result.classical_acceleration),
                ("local", result.body_twist, result.spatial_acceleration),
            ):
                of = ks.jacobian(model, frame, q, reference=reference, relative_to=observer, joints="all", qdot=qdot)
                same(model, velocity[k], of.matrix @ qdot, 1e-12)
                same(model, acceleration[k], of.matrix @ qddot + of.time_derivative @ qdot, 1e-12)


# --- observers -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("seed", "floating"), TREES)
def test_the_observer_and_the_observed_change_places(seed, floating):
    """What a sees of f is minus what f sees of a, as one body: V_f|a = -Ad(T_f_a) V_a|f."""
    model = tree(seed, floating)
    q, qdot, _ = drawn(model, seed)
    frame, observer, _ = frames_of(model, seed)
    there = asked(model, q, qdot, frames=frame, relative_to=observer).body_twist[0]
    back = asked(model, q, qdot, frames=observer, relative_to=frame).body_twist[0]
    same(model, there, -ks.adjoint(model, observer, frame, q).matrix @ back, 1e-12)


@pytest.mark.parametrize(("seed", "floating"), TREES)
def test_an_observer_who_sits_on_the_frame_sees_nothing_move(seed, floating):
    model = tree(seed, floating)
    q, qdot, qddot = drawn(model, seed)
    frame, _, axes = frames_of(model, seed)
    result = asked(model, q, qdot, frames=frame, relative_to=frame, expressed_in=axes, qddot=qddot)
    for found in (result.twist, result.spatial_acceleration, result.classical_acceleration):
        same(model, found, np.zeros((1, 6)), 1e-13)
    assert result.screw.motion[0] == "rest"


def test_joints_beyond_a_link_do_not_move_it():
    """A19: link1 and link2 of a planar arm, whatever the joints after them do."""
    model = textbook("planar_3r")
    q, qdot, qddot = drawn(model, 1, (20,))
    still = asked(model, q, qdot * [1, 0, 0], frames=["link1"], qddot=qddot * [1, 0, 0])
    moved = asked(model, q, qdot, frames=["link1"], qddot=qddot)
    assert_same(moved.twist, still.twist)
    assert_same(moved.classical_acceleration, still.classical_acceleration)


# --- screws --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("seed", "floating"), TREES)
def test_the_point_of_the_axis_slides_along_it_by_the_pitch(seed, floating):
    """By the Jacobian of the body's point that is there now: no velocity across the axis, pitch times rate along it."""
    model = tree(seed, floating)
    q, qdot, _ = drawn(model, seed)
    frame, observer, _ = frames_of(model, seed)
    result = asked(model, q, qdot, frames=frame, relative_to=observer)
    axis, point, pitch, rate = line(result.screw)
    kind = result.screw.motion[0]
    if kind in ("rest", "translation"):
        assert np.all(np.isnan(point))
        assert rate == 0
        return
    place = ks.fk(model, frame, q, relative_to=observer).matrix
    inside = place[:3, :3].T @ (point - place[:3, 3])
    there = ks.jacobian(model, frame, q, relative_to=observer, point=inside, joints="all").matrix @ qdot
    far = max(1.0, np.linalg.norm(inside))
    same(model, there, np.concatenate([pitch * rate * axis, rate * axis]), 1e-12 * far)
    assert abs(axis @ (point - place[:3, 3])) < 1e-11 * far  # the nearest point
    assert np.linalg.norm(axis) == pytest.approx(1, abs=1e-14)
    assert result.screw.speed[0] == pytest.approx(pitch * rate, abs=1e-14)


def test_kinds_of_motion_are_all_met():
    kinds = {
        str(kind)
        for seed, floating in TREES
        for kind in asked(tree(seed, floating), *drawn(tree(seed, floating), seed)[:2]).screw.motion
    }
    assert kinds == {"rest", "translation", "rotation", "screw"}


@pytest.mark.parametrize("seed", [3, 4, 5])
def test_links_that_are_joined_rigidly_have_one_screw(seed):
    """A15: the screw of a body does not depend on the frame that tells of it."""
    model = ks.load("example:panda")
    q, qdot, _ = drawn(model, seed)
    rigid = ["panda_link7", "panda_link8", "panda_hand", "panda_hand_tcp"]
    screw = asked(model, q, qdot, frames=rigid, expressed_in="panda_link3").screw
    axis, point, pitch, rate = line(screw)
    for k in range(1, len(rigid)):
        other_axis, other_point, other_pitch, other_rate = line(screw, k)
        assert_same(other_axis, axis)
        assert other_pitch == pytest.approx(pitch, abs=1e-12)
        assert other_rate == pytest.approx(rate, abs=1e-12)
        assert_same(np.cross(other_point - point, axis), np.zeros(3), atol=1e-11)


@pytest.mark.parametrize("name", ["planar_2r", "helical", "rp", "puma560"])
@pytest.mark.parametrize("factor", [1e-9, 1e-3, 1e6, -1.0])
def test_the_size_of_the_rates_changes_no_screw(name, factor):
    """What is zero is judged at the size of the rates; turning back turns the axis round."""
    model = textbook(name)
    q, qdot, _ = drawn(model, 11)
    slow, fast = (asked(model, q, rates).screw for rates in (qdot, factor * qdot))
    assert fast.motion.tolist() == slow.motion.tolist()
    assert_same(fast.axis, np.sign(factor) * slow.axis)
    assert_same(fast.point, slow.point)
    assert_same(fast.pitch, slow.pitch)
    np.testing.assert_allclose(fast.rate, abs(factor) * slow.rate, rtol=1e-12)


def test_an_axis_beyond_all_lengths_is_nowhere():
    """A turn so slow beside a slide that its axis would lie 1e150 m away is none."""
    screw = asked(textbook("rp"), np.zeros(2), [1e-150, 1.0], frames="tool").screw
    assert screw.motion[0] == "translation"
    assert_same(screw.axis[0], [1.0, 0, 0])
    assert screw.pitch[0] == np.inf


def test_a_slide_far_out_hides_no_turn():
    """The turntable of a slide at 1e12 m turns at 1 rad/s, whatever rounding does to metres out there."""
    screw = asked(textbook("rp"), [1.0, 1e12], [1.0, 2.0], frames="link1").screw
    assert (screw.motion[0], screw.rate[0]) == ("rotation", 1.0)


@pytest.mark.parametrize("name", ["puma560", "stanford", "wrist_zyz"])
def test_one_joint_alone_is_a_rotation_or_a_translation(name):
    """Whatever the configuration: a pitch that is rounding is none."""
    model = textbook(name)
    q = ks.random_configurations(model, 1, (50,))
    for joint, unit in zip(model.robot.independent, np.eye(model.robot.nv), strict=True):
        screw = asked(model, q, unit, frames="tool", expressed_in=joint.parent).screw
        assert set(screw.motion[:, 0]) == {"rotation" if joint.type.is_angle else "translation"}
        assert_same(screw.axis[:, 0], np.broadcast_to(screw.axis[0, 0], (50, 3)))
        if joint.type.is_angle:
            assert np.all(screw.pitch == 0)
            assert np.all(screw.speed == 0)


def test_parallel_joints_that_turn_against_each_other_translate():
    """A pure translation out of rotations: their angular velocities cancel to rounding, and are said to."""
    model = textbook("planar_3r")
    q = np.random.default_rng(2).uniform(-3, 3, (40, 3))
    result = asked(model, q, [0.1, 0.2, -0.3], frames="tool")
    assert np.any(result.twist[..., 5] != 0)  # 0.1 + 0.2 is not 0.3
    assert set(result.screw.motion[:, 0]) == {"translation"}
    assert_same(result.screw.axis * result.screw.speed[..., None], result.twist[..., :3])


# --- textbook ------------------------------------------------------------------------------------------------------

FIRST, SECOND = 1.0, 0.8
RATES = [(1.0, 0.5), (-0.3, 2.0), (0.0, 1.0), (1.5, 0.0)]


@pytest.mark.parametrize("rates", RATES)
def test_a3_tip_velocity_in_the_tip_frame(rates):
    model, (one, two) = textbook("planar_2r"), rates
    q = np.random.default_rng(5).uniform(-3, 3, (30, 2))
    result = asked(model, q, rates, frames="tool")
    sine, cosine, zero = np.sin(q[:, 1]), np.cos(q[:, 1]), np.zeros(30)
    expected = vector_of(FIRST * sine * one, FIRST * cosine * one + SECOND * (one + two), zero, zero, zero, one + two)
    assert_same(result.body_twist[:, 0], expected)
    assert_same(asked(model, q, rates, frames="tool", expressed_in="tool").twist[:, 0], expected)


@pytest.mark.parametrize("rates", RATES)
def test_the_centre_of_rotation_divides_the_line_between_the_joints(rates):
    """Three bodies' centres lie on a line (Kennedy's theorem): the elbow's share is that of its rate."""
    model, (one, two) = textbook("planar_2r"), rates
    q = np.random.default_rng(6).uniform(-3, 3, (30, 2))
    screw = asked(model, q, rates, frames="tool").screw
    elbow = planar_tip([FIRST], q[:, :1])[:, :3, 3]
    assert set(screw.motion[:, 0]) == {"rotation"}
    assert_same(screw.point[:, 0], two / (one + two) * elbow, atol=1e-11)
    assert_same(screw.axis[:, 0], np.broadcast_to([0, 0, np.sign(one + two)], (30, 3)))


@pytest.mark.parametrize("angle", [0.0, 0.7, -2.0])
def test_a_rolling_wheel_turns_about_its_point_of_contact(angle):
    """The hub goes along x at 0.3 m/s and the wheel turns clockwise at 0.5 rad/s: its radius is 0.6."""
    result = asked(textbook("pr"), [0.25, angle], [0.3, -0.5], frames=["tool"], qddot=[0, 0])
    _, centre, pitch, rate = line(result.screw)
    hub = asked(textbook("pr"), [0.25, angle], [0.3, 0.0], frames=["link1"])
    assert_same(centre, hub.origin[0] - [0, 0.6, 0])
    assert (pitch, rate) == (0, 0.5)
    # A point of the rim of a wheel that rolls evenly is pulled towards the hub, by w^2 r.
    pull = 0.25 * (hub.origin[0] - result.origin[0])
    assert_same(result.classical_acceleration[0], [*pull, 0, 0, 0])


def test_a13_a_slide_on_a_turntable():
    """From outside the carriage is turned and pushed sideways; who turns with it sees it slide, and nothing else."""
    model = textbook("rp")
    out = model.engine.placement(np.array([0.0, 0.4]), "tool", "base")[0, 3]
    spun = asked(model, [0.0, 0.4], [2.0, 0.5], frames="tool", qddot=[0, 0])
    assert_same(spun.twist[0], [0.5, 2 * out, 0, 0, 0, 2])
    # Centripetal and Coriolis: -w^2 r along the slide, 2 w v across it.
    assert_same(spun.classical_acceleration[0], [-4 * out, 2 * 2 * 0.5, 0, 0, 0, 0])
    seen = asked(model, [0.0, 0.4], [2.0, 0.5], frames="tool", relative_to="link1", qddot=[0, 0])
    assert_same(seen.twist[0], [0.5, 0, 0, 0, 0, 0])
    assert_same(seen.classical_acceleration[0], np.zeros(6))


@pytest.mark.parametrize("frame", ["nut", "tool"])
def test_a14_a_helical_joint_moves_along_its_own_screw(frame):
    """Its axis is (3, 2, 6)/7 through (0.3, -0.1, 0.2), its pitch 0.05 m a turn, whatever the angle and the frame."""
    q = np.linspace(-20, 20, 41)[:, None]
    screw = asked(textbook("helical"), q, [1.7], frames=frame).screw
    axis, point, pitch, rate = line(screw)
    assert set(screw.motion[:, 0]) == {"screw"}
    assert_same(axis, np.tile(np.array([3.0, 2, 6]) / 7, (41, 1)))
    assert_same(np.cross(point - [0.3, -0.1, 0.2], axis), np.zeros((41, 3)))
    assert_same(pitch, np.full(41, 0.05 / (2 * np.pi)))
    assert_same(rate, np.full(41, 1.7))


def test_a_slide_is_a_translation():
    screw = asked(textbook("skew_1p"), [0.2], [-3.0], frames="carriage").screw
    assert screw.motion[0] == "translation"
    assert_same(screw.axis[0], -np.array([3.0, 2, 6]) / 7)
    assert (screw.pitch[0], screw.rate[0]) == (np.inf, 0)
    assert screw.speed[0] == pytest.approx(3)


# --- edges ---------------------------------------------------------------------------------------------------------


def test_nothing_moves_without_rates():
    model = tree(500, True)
    q, _, qddot = drawn(model, 1)
    result = asked(model, q, np.zeros(model.robot.nv), qddot=qddot)
    assert not np.any(result.twist)
    assert set(result.screw.motion) == {"rest"}
    assert np.all(np.isnan(result.screw.axis))
    assert not np.any(result.screw.rate)
    assert not np.any(result.screw.speed)
    assert np.any(result.spatial_acceleration)  # from rest it still starts


def test_a_robot_without_joints():
    result = asked(textbook("rigid_body"), np.zeros(0), np.zeros(0), qddot=np.zeros(0))
    assert result.twist.shape == (len(result.frames), 6)
    assert not np.any(result.twist)
    assert not np.any(result.classical_acceleration)
    assert set(result.screw.motion) == {"rest"}


def test_without_accelerations_none_are_given():
    result = asked(textbook("planar_2r"), np.zeros(2), np.ones(2))
    assert result.qddot is None
    assert result.spatial_acceleration is None
    assert result.classical_acceleration is None


@pytest.mark.parametrize(
    ("at", "rates", "pushed", "whole"),
    [
        ((), (5,), (), (5,)),
        ((5,), (), (), (5,)),
        ((3, 1), (4,), (2, 3, 4), (2, 3, 4)),
        ((0,), (), (), (0,)),
        ((2, 0), (0,), (), (2, 0)),
    ],
)
def test_batches_have_a_leading_shape_and_the_numbers_of_single_questions(at, rates, pushed, whole):
    model = tree(501)
    nv, generator = model.robot.nv, np.random.default_rng(1)
    q = ks.random_configurations(model, 1, at)
    qdot, qddot = (generator.uniform(-1, 1, (*shape, nv)) for shape in (rates, pushed))
    words = {"relative_to": model.robot.links[-1].name, "expressed_in": model.robot.links[0].name}
    many = asked(model, q, qdot, qddot=qddot, **words)
    count = len(many.frames)
    for name in ("twist", "body_twist", "spatial_acceleration", "classical_acceleration"):
        assert getattr(many, name).shape == (*whole, count, 6)
    assert many.origin.shape == many.screw.axis.shape == many.screw.point.shape == (*whole, count, 3)
    assert many.screw.pitch.shape == many.screw.rate.shape == many.screw.motion.shape == (*whole, count)
    full = [np.broadcast_to(part, (*whole, part.shape[-1])) for part in (q, qdot, qddot)]
    for index in np.ndindex(whole):
        one = asked(model, full[0][index], full[1][index], qddot=full[2][index], **words)
        for name in ("twist", "spatial_acceleration", "classical_acceleration", "origin"):
            assert_same(getattr(many, name)[index], getattr(one, name))
        assert many.screw.motion[index].tolist() == one.screw.motion.tolist()


def test_frames_come_in_the_order_in_which_they_are_named():
    model = textbook("planar_2r")
    q, qdot, _ = drawn(model, 3)
    every = asked(model, q, qdot)
    some = asked(model, q, qdot, frames=("tool", "link1"))
    assert some.frames == ("tool", "link1")
    assert_same(some.twist, every.twist[[3, 1]])
    assert asked(model, q, qdot, frames="tool").frames == ("tool",)


def test_the_result_is_a_value_of_its_own():
    qdot = np.ones(2)
    result = asked(textbook("planar_2r"), np.zeros(2), qdot)
    qdot[:] = 7
    assert result.qdot.tolist() == [1, 1]
    with pytest.raises(ValueError, match="read-only"):
        result.twist[0, 0] = 1


@pytest.mark.parametrize(
    ("q", "qdot", "words", "message"),
    [
        (np.zeros(3), np.zeros(2), {}, "positions have the shape"),
        (np.zeros(2), np.zeros(3), {}, "rates have the shape"),
        (np.zeros(2), [np.nan, 0], {}, "not a finite number"),
        (np.zeros(2), np.zeros(2), {"qddot": np.zeros(1)}, "have the shape"),
        (np.zeros(2), np.zeros(2), {"qddot": [np.inf, 0]}, "not a finite number"),
        (np.zeros((3, 2)), np.zeros((4, 2)), {}, "do not go with"),
        (np.zeros((3, 2)), np.zeros(2), {"qddot": np.zeros((4, 2))}, "do not go with"),
        (np.zeros(2), np.zeros(2), {"frames": []}, "no frame is named"),
        (np.zeros(2), np.zeros(2), {"frames": ["tol"]}, "there is no frame 'tol'"),
        (np.zeros(2), np.zeros(2), {"relative_to": "joint1"}, "is a joint, not a frame"),
        (np.zeros(2), np.zeros(2), {"expressed_in": "nowhere"}, "there is no frame"),
    ],
)
def test_what_cannot_be_asked_is_refused_by_name(q, qdot, words, message):
    with pytest.raises(ks.UsageError, match=message):
        ks.velocity(textbook("planar_2r"), q, qdot, **words)


@pytest.mark.parametrize("factor", [1e-6, 1e6])
@pytest.mark.parametrize("seed", [500, 501, 504])
def test_the_certificate_scales_with_the_rates(seed, factor):
    model = tree(seed)
    q, qdot, qddot = drawn(model, seed)
    asked(model, q, factor * qdot, qddot=factor**2 * qddot, relative_to=model.robot.links[-1].name)


def test_a_wrong_engine_is_caught(monkeypatch):
    """Each number is in the certificate: one engine's motions, placements or frame changes alone cannot lie."""
    model = ks.load("textbook:planar_2r")
    words = {"relative_to": "link1", "expressed_in": "tool", "qddot": np.ones(2)}
    for name in ("link_motions", "placement", "frame_change"):
        right = getattr(model.witness, name)
        with monkeypatch.context() as patch:
            patch.setitem(model.witness.__dict__, name, lambda *given, right=right: right(*given) + 1e-9)
            assert ks.velocity(model, [0.3, 0.4], [1.0, 2.0], **words).certificate.agree is False, name
    asked(model, [0.3, 0.4], [1.0, 2.0], **words)
