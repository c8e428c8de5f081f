"""Base placement: where the answer is known it is found, and what is said to be reached is."""

import itertools
import math

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.capability.capability_map import capability_map
from kinetostat.analysis.capability.placing import base_placement
from kinetostat.analysis.capability.promising import placement_map
from kinetostat.analysis.capability.settling import path
from kinetostat.analysis.inverse.pose import Pose, pose
from kinetostat.errors import ConfigurationError, UsageError
from kinetostat.screw import se3, so3
from trees import load_text

NARROW = """<robot name="narrow">
  <link name="base"/><link name="upper"/><link name="lower"/><link name="tool"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <limit lower="-0.3" upper="0.3" effort="1" velocity="1"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="1 0 0"/>
    <axis xyz="0 0 1"/><limit lower="0.4" upper="1.2" effort="1" velocity="1"/></joint>
  <joint name="end" type="fixed"><parent link="lower"/><child link="tool"/><origin xyz="1 0 0"/></joint>
</robot>"""


def mapped(model, frame, **asked):
    return capability_map(model, frame, ks.configuration(model).q, **asked)


def at_points(points):
    poses = np.tile(np.eye(4), (len(points), 1, 1))
    poses[:, :3, 3] = points
    return poses


def circle(radius, middle=(0.0, 0.0), count=12):
    turns = 2 * np.pi * np.arange(count) / count + 0.1
    return np.stack([middle[0] + radius * np.cos(turns), middle[1] + radius * np.sin(turns), 0 * turns], -1)


def base_in_world(place):
    return se3.placement(so3.about(2, np.array(place.yaw)), np.array([place.x, place.y, 0.0]))


@pytest.fixture(scope="module")
def planar():
    model = ks.load("textbook:planar_2r")
    return model, mapped(model, "tool", low_discrepancy=200_000, axes="xy", voxel=0.05)


@pytest.mark.parametrize("middle", [(0.0, 0.0), (2.34, -1.27), (100.0, 3.0)])
def test_a_planar_arm_stands_in_the_middle_of_a_circle(planar, middle):
    model, capability = planar
    # Nearly as far as the arm reaches: from anywhere else some of the circle is out of reach, or nearer to its edge.
    found = base_placement(model, capability, Pose(at_points(circle(1.7, middle)), oriented=False), np.zeros(2))
    best = found.proved[0]
    # The map cannot tell places apart that are less than a voxel from each other.
    assert math.hypot(best.x - middle[0], best.y - middle[1]) < 1.01 * capability.grid.size
    assert (best.count, best.promised) == (12, 12)


def test_no_place_promises_poses_that_are_too_far_apart(planar):
    model, capability = planar
    points = np.array([[0.0, 0, 0], [5.0, 0, 0]])  # more than two reaches of 1.8 m
    found = base_placement(model, capability, Pose(at_points(points), oriented=False), np.zeros(2))
    assert found.map.promised.max() == 1
    assert found.proved
    assert all(place.count == 1 for place in found.proved)


def test_where_nothing_is_reached_it_is_told_why():
    model = ks.load("example:ur5_robot")
    capability = mapped(model, "tool0", samples=20_000, axes="xyz")
    found = base_placement(model, capability, Pose(at_points([[0.0, 0, 3], [1.0, 0, 4]]), oriented=False), np.zeros(6))
    assert found.proved == ()
    assert "z = 3 to 4 m" in found.why_none
    assert "0 reached" in repr(found)
    # One joint answers for one row of two: nothing is reached, but not for its height, which does not count.
    one = ks.load("textbook:planar_1r")
    scattered = Pose(at_points([[0.0, 0.1, 3], [1.0, 0.53, 3], [0.3, 1.7, 3]]), oriented=False)
    found = base_placement(one, mapped(one, "tool", samples=1000, axes="xy"), scattered, np.zeros(1))
    assert found.why_none is None or "z =" not in found.why_none


def seam(count=12):
    """Return poses along a bent seam, the tool pointing down."""
    a = np.linspace(0, 1.2, count)
    points = np.stack([2 + 0.4 * np.cos(4 * a), 0.4 + a, 0.3 + 0.1 * np.sin(5 * a)], -1)
    poses = at_points(points)
    poses[:, :3, :3] = so3.about(0, np.array(math.pi))
    return poses


def test_the_first_place_is_good_and_takes_the_best_branches():
    model = ks.load("example:ur5_robot")
    capability, wanted = mapped(model, "tool0", samples=300_000), seam()
    found = base_placement(model, capability, Pose(wanted, oriented=True), np.zeros(6))
    best = found.proved[0]
    # The best of 60 random places, by all branches of inverse kinematics, had 12 poses and 0.581.
    assert best.count == 12
    assert best.worst > 0.581
    goals = se3.inverse(base_in_world(best)) @ wanted
    branches = [ks.ik_all(model, "tool0", goal, np.zeros(6)).q for goal in goals]
    values = [
        ks.manipulability(model, "tool0", q, length=capability.length).blocks["full"].singular_values[..., -1].max()
        for q in branches
    ]
    assert min(values) == pytest.approx(best.worst, rel=1e-6)


def test_a_redundant_arm_is_placed_as_well_as_many_tries_find():
    model = ks.load("example:panda")
    capability, wanted = mapped(model, "panda_hand", samples=200_000), seam()
    q = ks.configuration(model).q
    best = base_placement(model, capability, Pose(wanted, oriented=True), q, seed=1).proved[0]
    assert best.count == 12
    assert best.worst > 0.46  # 0.482 is the best of 5 seeds; 60 random places with 60 starts each have 11 and 0.219


def branches_at_random(joints, generator, poses, branches):
    q = joints.draw(generator, (poses, branches), limited=True)
    values = np.sort(generator.uniform(0.1, 1, (poses, branches)))[:, ::-1]
    return q, np.where(generator.random(values.shape) < 0.2, -1, values)


@pytest.mark.parametrize("seed", range(6))
def test_the_path_is_the_shortest_of_all(seed):
    generator = np.random.default_rng(seed)
    joints = mapped(ks.load("example:ur5_robot"), "tool0", samples=1000, axes="xyz").coordinates
    q, values = branches_at_random(joints, generator, 5, 4)
    values = -np.sort(-values)
    units = np.ones(6)
    chosen = path(joints, q, values, units)
    least = values[values[:, 0] >= 0, 0].min()
    reached = np.flatnonzero(values[:, 0] >= 0)
    allowed = [np.flatnonzero(values[i] >= least) for i in reached]

    def length(points):
        return sum(np.linalg.norm(joints.wrapped(b - a)) for a, b in itertools.pairwise(points))

    shortest = min(
        length([q[i, k] for i, k in zip(reached, each, strict=True)]) for each in itertools.product(*allowed)
    )
    assert length(chosen[reached]) == pytest.approx(shortest, abs=1e-9)
    assert np.all(joints.between(chosen))
    for i in reached:
        assert np.any(np.all(np.abs(joints.wrapped(chosen[i] - q[i])) < 1e-9, axis=-1) & (values[i] >= least))


def test_joints_go_on_from_pose_to_pose_by_the_nearer_turn():
    joints = mapped(ks.load("example:ur5_robot"), "tool0", samples=1000, axes="xyz").coordinates
    turns = np.linspace(0.5, 6, 12)  # from half a radian on, or as well to it from a turn before
    q = joints.wrapped(np.tile(turns[:, None, None], (1, 1, 6)))
    q[..., 2] = 0.5  # the elbow makes no whole turn
    chosen = path(joints, q, np.full((12, 1), 0.5), np.ones(6))
    np.testing.assert_allclose(chosen[:, 0], turns - 2 * math.pi, atol=1e-12)
    np.testing.assert_allclose(path(joints, q[:6], np.full((6, 1), 0.5), np.ones(6))[:, 0], turns[:6], atol=1e-12)


def test_out_of_the_plane_nothing_is_reached(planar):
    _, capability = planar
    found = placement_map(capability, at_points([[0.0, 0, 0.5]]), oriented=False)
    assert found.promised.max() == 0
    assert found.dexterity.max() == 0


def test_an_arm_that_cannot_turn_is_turned():
    model = load_text(NARROW)
    capability = mapped(model, "tool", low_discrepancy=100_000, axes="xy", voxel=0.05)
    heading = 2.0  # whole steps of 15 degrees do not hit it
    base = se3.placement(so3.about(2, np.array(heading)), np.array([0.7, -0.4, 0.0]))
    q = np.stack(np.meshgrid(np.linspace(-0.12, 0.12, 3), np.linspace(0.5, 1.1, 4)), -1).reshape(-1, 2)
    wanted = base @ ks.fk(model, "tool", q).matrix
    found = base_placement(model, capability, Pose(wanted, oriented=False), np.zeros(2))
    best = found.proved[0]
    assert best.count == len(q)
    assert abs(best.yaw - heading) < math.radians(30)
    assert math.hypot(best.x - 0.7, best.y + 0.4) < 0.4


def test_what_is_said_to_be_reached_is_reached():
    model = ks.load("example:ur5_robot")
    capability = mapped(model, "tool0", samples=300_000, length="auto")
    generator = np.random.default_rng(0)
    rows = [
        [*generator.normal([1, 0.5, 0.3], 0.2), *generator.normal([math.pi, 0, 0], [0.1, 0.1, 1])] for _ in range(8)
    ]
    wanted = np.array([pose(row).matrix for row in rows])
    found = base_placement(model, capability, Pose(wanted, oriented=True), np.zeros(6))
    assert [place.count for place in found.proved] == sorted((place.count for place in found.proved), reverse=True)
    assert found.proved[0].count == 8
    for place in found.proved:
        there = base_in_world(place) @ ks.fk(model, "tool0", place.q[place.reached]).matrix
        np.testing.assert_allclose(there, wanted[place.reached], atol=1e-7)
        values = ks.manipulability(model, "tool0", place.q[place.reached], length=capability.length).blocks["full"]
        np.testing.assert_allclose(values.minimum_singular_value, place.smallest[place.reached], atol=1e-12)
        assert np.all(np.isnan(place.smallest[~place.reached]))
        assert place.worst == pytest.approx(place.smallest[place.reached].min())
    assert found.certificate.agree is True


@pytest.mark.parametrize("oriented", [False, True])
def test_configurations_of_the_map_are_promised_from_where_it_was_made(oriented):
    model = ks.load("textbook:puma560")
    capability = mapped(model, "tool", samples=65536, length="auto", voxel=0.1)
    drawn = capability.source.rows(0, 40)
    wanted = ks.fk(model, "tool", capability.coordinates.configuration(drawn, np.zeros(6))).matrix
    # Positions are tried on a grid about the middle of the poses: this one has it in the origin, at heading zero.
    opposite = wanted.copy()
    opposite[:, :2, 3] *= -1
    opposite[:, 2, 3] += 100.0
    found = placement_map(capability, np.concatenate([wanted, opposite]), oriented=oriented)
    i, j = int(np.argmin(np.abs(found.x))), int(np.argmin(np.abs(found.y)))
    assert abs(found.x[i]) + abs(found.y[j]) < 1e-9
    assert found.promised[i, j] == 40


def test_a_direction_that_never_arrives_is_not_promised(planar):
    model, _ = planar
    capability = mapped(model, "tool", samples=50_000, axes="x y rx", voxel=0.1)  # a turn counts, so directions do
    upright = at_points(circle(1.0))
    lying = upright.copy()
    lying[:, :3, :3] = so3.about(0, np.array(math.pi / 2))
    assert placement_map(capability, upright, oriented=True).promised.max() == 12
    assert placement_map(capability, lying, oriented=True).promised.max() == 0


def test_what_cannot_be_is_refused(planar):
    model, capability = planar
    q = np.zeros(2)
    with pytest.raises(UsageError, match="poses"):
        base_placement(model, capability, Pose(np.zeros((0, 4, 4)), oriented=False), q)
    with pytest.raises(UsageError, match="too far apart"):
        base_placement(model, capability, Pose(at_points([[0, 0, 0], [1e9, 0, 0]]), oriented=False), q)
    with pytest.raises(UsageError, match="too many"):
        base_placement(model, capability, Pose(at_points([[0, 0, 0], [1e3, 1e3, 0]]), oriented=False), q)
    with pytest.raises(ConfigurationError):
        base_placement(model, capability, Pose(at_points([[1, 0, 0]]), oriented=False), np.zeros(5))
    turning = mapped(model, "tool", samples=1000, axes="xyz rx ry rz")
    with pytest.raises(UsageError, match="no orientation"):
        base_placement(model, turning, Pose(at_points([[1, 0, 0]]), oriented=False), q)
