"""Laws of the largest forces: at the limit and not a hair beyond, by `torque` itself; polytopes against all of them."""

from functools import cache
from itertools import product

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.polytope import polytope
from trees import load_text

LOOSE = 1e-9  # of a limit
EVERYONE = 40.0
ARMS = {  # frame, configuration, limits where the file has none
    "example:panda": ("panda_hand", "default", None),
    "example:ur5_robot": ("tool0", "0.3,-0.5,1.2,0.2,1,0.4", None),
    "example:talos_full_v2": ("gripper_left_base_link", "zero", EVERYONE),
    "textbook:anthropomorphic": ("tool", "0.2,0.7,-1.1", EVERYONE),
    "textbook:stanford": ("tool", "0.2,0.7,0.5,0.3,-0.4,0.1", 80.0),
    "textbook:scara": ("tool", "0.5,0.9,0.1,0", EVERYONE),
    "textbook:puma560": ("tool", "0.1,0.5,-0.6,0.2,0.9,0", 200.0),
    "textbook:helical": ("tool", "0.3", EVERYONE),
}


@cache
def model_of(source):
    return ks.load(source)


def everyone(model, limit):
    return None if limit is None else {joint.name: limit for joint in model.robot.independent if joint.type.nv == 1}


@cache
def arm(source, *, gravity=True, on="environment"):
    """Return model, frame, configuration and what loads the arm besides."""
    model, (frame, text, limit) = model_of(source), ARMS[source]
    q = ks.configuration(model, text).q
    return model, frame, q, ks.torque(model, q, gravity=gravity, limits=everyone(model, limit), on=on)


def with_force(model, frame, q, rest, force, *, point=(0, 0, 0), axes="world"):
    """Return torques under a further force (or wrench), by `torque`; limits and other loads are those of the rest."""
    six = np.zeros(6)
    six[: len(force)] = force
    own = ks.load_at(model, frame, six, axes=axes, point=point)
    limits = {
        name: (float(low), float(high))
        for name, low, high in zip(rest.columns, rest.limits.lower, rest.limits.upper, strict=True)
        if not np.isnan(low) and name in model.robot.joint_by_name
    }
    return ks.torque(
        model,
        q,
        [*rest.loads, own],
        on=rest.on,
        gravity=rest.gravity_vector,
        payload=rest.payload,
        limits=limits,
    )


def used(result):
    return np.nan_to_num(result.utilisation, nan=0.0)


def directions(count, size=3, seed=0):
    drawn = np.random.default_rng(seed).normal(size=(count, size))
    return [*np.eye(size), *-np.eye(size), *(drawn / np.linalg.norm(drawn, axis=1, keepdims=True))]


# --- the largest force


@pytest.mark.parametrize("on", ["environment", "robot"])
@pytest.mark.parametrize("source", ARMS)
def test_at_the_largest_force_one_joint_is_at_its_limit_and_a_hair_more_exceeds_it(source, on):
    model, frame, q, rest = arm(source, on=on)
    found = 0
    for direction in directions(6):
        most = ks.strongest(model, frame, q, direction, rest)
        assert most.certificate.agree
        if not np.isfinite(most.value):
            assert most.binding_joint is None or np.isnan(most.value)
            continue
        found += 1
        at, beyond, before = (
            with_force(model, frame, q, rest, most.value * part * direction) for part in (1, 1.000001, 0.999999)
        )
        assert np.isclose(used(at).max(), 1, rtol=0, atol=LOOSE)
        assert np.sum(used(at) > 1 - LOOSE) == 1
        assert at.binding_joint == most.binding_joint
        assert used(beyond).max() > 1
        assert used(before).max() < 1
    assert found


@pytest.mark.parametrize("where", [{"point": (0.1, -0.2, 0.3)}, {"expressed_in": "panda_link5"}])
def test_points_and_axes_of_the_force(where):
    model, frame, q, rest = arm("example:panda")
    for direction in directions(3):
        most = ks.strongest(model, frame, q, direction, rest, **where)
        acts = {"point": where.get("point", (0, 0, 0)), "axes": where.get("expressed_in", "world")}
        at = with_force(model, frame, q, rest, most.value * direction, **acts)
        assert np.isclose(used(at).max(), 1, rtol=0, atol=LOOSE)


def test_a_direction_is_scaled_and_a_batch_is_one_by_one():
    model, frame, q, rest = arm("example:panda")
    one = ks.strongest(model, frame, q, (0, 3e-200, 4e-200), rest)
    assert np.allclose(one.direction, (0, 0.6, 0.8))
    assert np.isclose(one.value, ks.strongest(model, frame, q, (0, 3e200, 4e200), rest).value, rtol=1e-14)
    many = ks.random_configurations(model, 4, (2, 3))
    rests = ks.torque(model, many, gravity=True)
    whole = ks.strongest(model, frame, many, (0, 0, 1), rests)
    assert whole.value.shape == whole.least.shape == whole.binding.shape == (2, 3)
    for i in np.ndindex(2, 3):
        single = ks.strongest(model, frame, many[i], (0, 0, 1), ks.torque(model, many[i], gravity=True))
        assert np.isclose(whole.value[i], single.value, rtol=1e-10, equal_nan=True)
        assert whole.binding[i] == single.binding


def test_the_planar_2r_by_hand():
    """Elbow at a right angle, without gravity: f along x is -0.8 Nm/N on both joints; along y 1 Nm/N on joint1."""
    model, q = model_of("textbook:planar_2r"), np.array([0, np.pi / 2])
    rest = ks.torque(model, q, limits={"joint1": (-8, 20), "joint2": (-10, 4)})
    for direction, value, joint in (
        ((1, 0, 0), 10.0, "joint1"),  # -0.8 f >= -8
        ((-1, 0, 0), 5.0, "joint2"),  # 0.8 f <= 4
        ((0, 1, 0), 20.0, "joint1"),
        ((0, -1, 0), 8.0, "joint1"),
    ):
        most = ks.strongest(model, "tool", q, direction, rest)
        assert np.isclose(most.value, value, rtol=1e-13)
        assert (most.binding_joint, most.unit, float(most.least)) == (joint, "N", 0.0)


def test_gravity_shifts_what_is_left():
    """Links of 4 kg and 2.4 kg along x, gravity along -y: joint1 holds 2 + 2.4 (1.4) kg m, joint2 0.96 kg m."""
    model, q, g = model_of("textbook:planar_2r"), np.zeros(2), 10.0
    rest = ks.torque(model, q, gravity=(0, -g, 0), limits={"joint1": 60, "joint2": 30})
    up, down = (ks.strongest(model, "tool", q, (0, side, 0), rest) for side in (1, -1))
    assert np.isclose(up.value, min((60 - 53.6) / 1.8, (30 - 9.6) / 0.8))
    assert np.isclose(down.value, min((60 + 53.6) / 1.8, (30 + 9.6) / 0.8))


def test_a_stretched_arm_bears_any_force_along_itself():
    model, q = model_of("textbook:planar_2r"), np.array([0.5, 0])
    most = ks.strongest(model, "tool", q, (np.cos(0.5), np.sin(0.5), 0), ks.torque(model, q))
    assert np.isinf(most.value)
    assert most.value > 0
    assert (most.binding_joint, int(most.binding)) == (None, -1)
    assert np.isinf(ks.strongest(model, "tool", q, (0, 0, 1), ks.torque(model, q)).value)


def test_no_force_is_possible_where_a_joint_that_does_not_feel_it_is_overloaded():
    model, q = model_of("textbook:planar_2r"), np.zeros(2)
    rest = ks.torque(model, q, gravity=(0, -9.81, 0), limits={"joint2": 1, "joint1": 1000})
    most = ks.strongest(model, "tool", q, (1, 0, 0), rest)
    assert np.isnan(most.value)
    assert most.binding_joint == "joint2"


def test_an_overloaded_arm_says_how_much_relief_it_needs():
    model, q = model_of("textbook:planar_2r"), np.zeros(2)
    rest = ks.torque(model, q, gravity=(0, -10, 0), limits={"joint1": 50, "joint2": 30})
    most = ks.strongest(model, "tool", q, (0, -1, 0), rest)  # it leans on something: 53.6 - 1.8 f <= 50
    assert np.isclose(most.least, 2.0)
    assert used(with_force(model, "tool", q, rest, (0, -most.least, 0))).max() == pytest.approx(1, abs=LOOSE)
    assert np.isnan(ks.strongest(model, "tool", q, (0, 1, 0), rest).value)


def test_the_largest_payload_is_held_and_a_gram_more_is_not():
    for source, size in (("example:panda", 1), ("example:ur5_robot", 1), ("textbook:puma560", 1)):
        model, frame, q, rest = arm(source)
        most = ks.strongest(model, frame, q, "payload", rest, point=(0.05, 0, 0.1))
        assert (most.unit, most.quantity) == ("kg", "payload")
        heavy = [
            ks.torque(
                model,
                q,
                gravity=True,
                payload=ks.Payload(float(most.value) + more, frame, (0.05, 0, 0.1)),
                limits=everyone(model, ARMS[source][2]),
            )
            for more in (0.0, 1e-3 * size)
        ]
        assert np.isclose(used(heavy[0]).max(), 1, rtol=0, atol=LOOSE)
        assert used(heavy[1]).max() > 1
        assert heavy[0].binding_joint == most.binding_joint


@pytest.mark.parametrize("end", [1.0, 1e5, 1e9, 1e11])
def test_what_a_hoist_lifts_does_not_hang_on_how_far_it_slides(end):
    hoist = f"""<robot name="hoist"><link name="a"/><link name="b"><inertial><mass value="2"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
    <joint name="up" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
      <limit lower="{-end}" upper="{end}" effort="49.05" velocity="1"/></joint></robot>"""
    model = load_text(hoist)
    found = ks.strongest(model, "b", np.zeros(1), "payload", ks.torque(model, np.zeros(1), gravity=True))
    assert float(found.value) == pytest.approx(3)  # 5 kg g = 49.05 N, 2 kg of them its own
    assert found.binding_joint == "up"


def test_a_payload_hangs_along_the_given_gravity():
    model, frame, q, _ = arm("example:panda")
    pull = (3.0, 0, -2.0)
    most = ks.strongest(model, frame, q, "payload", ks.torque(model, q, gravity=pull))
    loaded = ks.torque(model, q, gravity=pull, payload=ks.Payload(float(most.value), frame))
    assert np.isclose(used(loaded).max(), 1, rtol=0, atol=LOOSE)


# --- the polytope


@pytest.mark.parametrize("on", ["environment", "robot"])
@pytest.mark.parametrize("axes", [None, "rx ry rz", "x z", "y"], ids=str)
@pytest.mark.parametrize("source", ARMS)
def test_corners_are_at_limits_and_mixtures_of_them_inside(source, axes, on):
    model, frame, q, rest = arm(source, on=on)
    forces = ks.force_polytope(model, frame, q, rest, axes=axes)
    assert forces.certificate.agree
    rows = forces.task.rows
    rank = len(rows) - len(forces.lines)
    corners, lines = np.zeros((len(forces.vertices), 6)), np.zeros((len(forces.lines), 6))
    corners[:, rows], lines[:, rows] = forces.vertices, forces.lines
    for corner in corners:
        use = used(with_force(model, frame, q, rest, corner))
        assert use.max() < 1 + 1e-6
        assert np.sum(use > 1 - 1e-6) >= rank
    for inner in np.random.default_rng(1).dirichlet(np.ones(len(corners)), 6) @ corners:
        assert used(with_force(model, frame, q, rest, inner)).max() < 1 + 1e-6
    for line in lines:
        assert np.allclose(with_force(model, frame, q, rest, line).total, rest.total, rtol=0, atol=1e-8)


@pytest.mark.parametrize("source", ARMS)
def test_the_polytope_reaches_as_far_as_the_largest_force_in_any_direction(source):
    model, frame, q, rest = arm(source)
    forces = ks.force_polytope(model, frame, q, rest)
    for direction in directions(12, seed=5):
        most = ks.strongest(model, frame, q, direction, rest)
        if np.isfinite(most.value) and not len(forces.lines):
            assert np.isclose(reach(forces, direction), most.value, rtol=1e-6)
        assert np.isnan(most.value) or most.value >= forces.every_way * (1 - 1e-9)


def reach(forces, direction):
    """Return how far a ray from zero gets, from triangles alone: it leaves through the one that it hits."""
    found = []
    for corners in forces.vertices[forces.facets]:
        try:
            parts = np.linalg.solve(corners.T, direction)
        except np.linalg.LinAlgError:
            continue
        if np.all(parts >= -1e-9) and np.sum(parts) > 0:
            found.append(1 / np.sum(parts))
    return max(found)


def test_the_ball_touches_the_nearest_face():
    model, frame, q, rest = arm("example:ur5_robot")
    forces = ks.force_polytope(model, frame, q, rest)
    heights = []
    for a, b, c in forces.vertices[forces.facets]:
        normal = np.cross(b - a, c - a)
        heights.append(abs(normal @ a) / np.linalg.norm(normal))
    assert np.isclose(forces.every_way, min(heights), rtol=1e-6)


@pytest.mark.parametrize("share", [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8])
def test_a_limit_that_is_far_away_takes_no_corner(share):
    """A rectangle, and a row that hardly feels anything: its bounds lie 100 / share away, and cut nothing."""
    limits = np.array([0.1, 0.13, 100.0])
    found = polytope(np.array([[1, 0], [0, 1], [share, share]]), -limits, limits)
    expected = sorted(product((-0.1, 0.1), (-0.13, 0.13)))
    assert np.allclose(sorted(map(tuple, np.round(found.vertices, 12))), expected, rtol=0, atol=1e-9)
    assert set(found.facet_rows) == {0, 1}


@pytest.mark.parametrize("angle", [1e-3, 1e-5, 1e-7, 1e-8])
@pytest.mark.parametrize(("source", "frame"), [
    ("textbook:wrist_zyz", "tool"),
    ("textbook:stanford", "tool"),
    ("textbook:stanford", "link5"),
    ("example:panda", "panda_link3"),
    ("example:ur5_robot", "wrist_1_link"),
])  # fmt: skip
def test_near_singular_configurations_have_a_polytope(source, frame, angle):
    model = model_of(source)
    q = np.full(model.robot.nq, angle)
    rest = ks.torque(model, q)
    forces = ks.force_polytope(model, frame, q, rest)
    torques = forces.vertices @ ks.jacobian(model, frame, q, joints="all").matrix[:3]
    assert np.all((torques <= rest.limits.upper * (1 + 1e-5)) | np.isnan(rest.limits.upper))
    assert np.all((torques >= rest.limits.lower * (1 + 1e-5)) | np.isnan(rest.limits.lower))
    assert forces.every_way > 0


def test_facets_lie_on_the_limit_of_their_joint():
    model, frame, q, rest = arm("example:panda")
    forces = ks.force_polytope(model, frame, q, rest)
    for facet, joint in zip(forces.facets, forces.face_joints, strict=True):
        middle = forces.vertices[facet].mean(axis=0)
        assert used(with_force(model, frame, q, rest, middle))[joint] == pytest.approx(1, abs=1e-6)


def test_the_polytope_of_a_planar_2r_by_hand():
    """With J = [[-0.8, -0.8], [1, 0]], |y - 0.8 x| <= 8 and |0.8 x| <= 4: x is 5 or -5, y is 0.8 x + 8 or - 8."""
    model, q = model_of("textbook:planar_2r"), np.array([0, np.pi / 2])
    forces = ks.force_polytope(model, "tool", q, ks.torque(model, q, limits={"joint1": 8, "joint2": 4}), axes="x y")
    expected = {(x, 0.8 * x + y) for x, y in product((-5.0, 5.0), (-8.0, 8.0))}
    assert sorted(map(tuple, np.round(forces.vertices, 9) + 0.0)) == sorted(expected)
    assert len(forces.lines) == 0
    assert np.isclose(forces.every_way, min(5, 8 / np.hypot(1, 0.8)))
    whole = ks.force_polytope(model, "tool", q, ks.torque(model, q, limits={"joint1": 8, "joint2": 4}))
    assert np.allclose(np.abs(whole.lines), [[0, 0, 1]])
    assert sorted(map(tuple, np.round(whole.vertices[:, :2], 9) + 0.0)) == sorted(expected)


def test_a_stretched_arm_has_a_line_and_ends():
    model, q = model_of("textbook:planar_2r"), np.array([0.0, 0.0])
    forces = ks.force_polytope(model, "tool", q, ks.torque(model, q, limits={"joint1": 9, "joint2": 8}), axes="x y")
    assert np.allclose(np.abs(forces.lines), [[1, 0]])
    assert np.allclose(sorted(forces.vertices[:, 1]), [-5, 5])
    assert forces.face_joints == (0, 0)


def test_zero_outside_is_said():
    model, q = model_of("textbook:planar_2r"), np.array([0.0, 0.5])
    rest = ks.torque(model, q, gravity=(0, -9.81, 0), limits={"joint1": 20, "joint2": 30})
    forces = ks.force_polytope(model, "tool", q, rest)
    assert forces.every_way == 0
    (warning,) = forces.warnings
    assert "zero" in warning
    for corner in forces.vertices:
        assert used(with_force(model, "tool", q, rest, corner)).max() < 1 + 1e-6


def test_a_frame_that_no_joint_moves_feels_nothing():
    model, _, q, rest = arm("example:panda")
    forces = ks.force_polytope(model, "panda_link0", q, rest)
    assert len(forces.lines) == 3
    assert np.isinf(ks.strongest(model, "panda_link0", q, (1, 2, 3), rest).value)


def test_followers_count_with_their_leader():
    """Two slides along x, the second following the first with multiplier 2: the leader bears three times the force."""
    slide = (
        '<joint name="{0}" type="prismatic"><parent link="{1}"/><child link="{2}"/><axis xyz="1 0 0"/>'
        '<limit lower="-1" upper="1" effort="6" velocity="1"/>{3}</joint>'
    )
    joints = slide.format("a", "one", "two", "") + slide.format(
        "b", "two", "three", '<mimic joint="a" multiplier="2"/>'
    )
    model = load_text(f'<robot name="r"><link name="one"/><link name="two"/><link name="three"/>{joints}</robot>')
    rest = ks.torque(model, [0.1])
    most = ks.strongest(model, "three", [0.1], (1, 0, 0), rest)
    assert (float(most.value), most.binding_joint) == (pytest.approx(2.0), "a")
    assert np.allclose(sorted(ks.force_polytope(model, "three", [0.1], rest, axes="x").vertices[:, 0]), [-2, 2])


# --- refusals


@pytest.mark.parametrize("direction", [(0, 0, 0), (0, 1), (0, 0, np.nan), (0, 0, np.inf), "up"])
def test_what_is_no_direction_is_refused(direction):
    model, q = model_of("textbook:planar_2r"), np.zeros(2)
    with pytest.raises(ks.UsageError, match="direction"):
        ks.strongest(model, "tool", q, direction, ks.torque(model, q))


@pytest.mark.parametrize(("asked", "part"), [
    ({"axes": "x rz"}, "scale"),
    ({"axes": "w"}, "axis 'w'"),
    ({"point": (0, 1)}, "point"),
])  # fmt: skip
def test_polytopes_that_cannot_be_are_refused(asked, part):
    model, q = model_of("textbook:planar_2r"), np.zeros(2)
    with pytest.raises(ks.UsageError, match=part):
        ks.force_polytope(model, "tool", q, ks.torque(model, q), **asked)


def test_a_polytope_is_of_one_configuration():
    model, q = model_of("textbook:planar_2r"), np.zeros((2, 2))
    with pytest.raises(ks.UsageError, match="one"):
        ks.force_polytope(model, "tool", q, ks.torque(model, q))


def test_overloaded_without_relief_is_refused():
    model, q = model_of("textbook:planar_2r"), np.array([0.0, 0.0])
    rest = ks.torque(model, q, gravity=(0, -9.81, 0), limits={"joint1": 1, "joint2": 1})
    with pytest.raises(ks.UsageError, match="exceeded without any force"):
        ks.force_polytope(model, "tool", q, rest)


def test_an_overloaded_joint_that_feels_no_force_is_refused_too():
    """The slide of the Stanford arm feels no moment; where weight alone exceeds its limit, no moment is possible."""
    model, q = model_of("textbook:stanford"), np.array([0.2, 0.7, 0.5, 0.3, -0.4, 0.1])
    rest = ks.torque(model, q, gravity=True, limits=everyone(model, 80.0) | {"joint3": 10.0})
    assert rest.utilisation[2] > 1
    with pytest.raises(ks.UsageError, match="exceeded without any force"):
        ks.force_polytope(model, "tool", q, rest, axes="rx ry rz")


def test_a_joint_without_a_limit_that_feels_it_is_named():
    model = model_of("example:double_pendulum")
    q = np.full(model.robot.nq, 0.3)
    tip = model.robot.default_tip()
    rest = ks.torque(model, q)
    if not rest.limits.missing:
        pytest.fail("this robot has limits now: choose another")
    name = next(iter(rest.limits.missing))
    for call in (
        lambda: ks.strongest(model, tip, q, (0.3, 0.5, 0.7), rest),
        lambda: ks.force_polytope(model, tip, q, rest),
    ):
        with pytest.raises(ks.UsageError, match=name) as caught:
            call()
        assert "--effort-limits" in caught.value.remedy


def test_unknown_frames_are_refused():
    model, q = model_of("textbook:planar_2r"), np.zeros(2)
    rest = ks.torque(model, q)
    for call in (
        lambda: ks.strongest(model, "hand", q, (1, 0, 0), rest),
        lambda: ks.force_polytope(model, "hand", q, rest),
        lambda: ks.force_polytope(model, "tool", q, rest, expressed_in="hand"),
    ):
        with pytest.raises(ks.UnknownNameError, match="hand"):
            call()
