"""Sections of the workspace: the textbook's circles, places that Pinocchio confirms, curves that are singular."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import kinetostat as ks
from kinetostat.analysis.coordinates import coordinates
from kinetostat.analysis.kernels import chain_kernel
from kinetostat.analysis.profile.anatomy import Limb
from kinetostat.analysis.profile.cells import best_in_cells
from kinetostat.analysis.profile.gathering import Gathered
from kinetostat.analysis.profile.holding import held_pose
from kinetostat.analysis.profile.limbs import limbs
from kinetostat.analysis.profile.posing import limb_poses
from kinetostat.analysis.profile.section_curves import SINGULAR, singular_lines
from kinetostat.analysis.profile.section_views import views_of_limb
from kinetostat.analysis.profile.sections import sections
from kinetostat.analysis.profile.two_joints import TwoJoints, ends_of
from kinetostat.analysis.singular.find import singular_find
from kinetostat.analysis.singular.mechanism import mechanism
from kinetostat.analysis.sweeping.sweep import sweep, sweep_work
from kinetostat.errors import UsageError

TWO_LINKS = """<robot name="two_links">
  <link name="base"/><link name="mount"/><link name="upper"/><link name="lower"/><link name="tool"/>
  <joint name="mounted" type="fixed"><parent link="base"/><child link="mount"/><origin rpy="{rpy}"/></joint>
  <joint name="joint1" type="{kind}"><parent link="mount"/><child link="upper"/><axis xyz="0 0 1"/>{first}</joint>
  <joint name="joint2" type="{kind}"><parent link="upper"/><child link="lower"/><origin xyz="6 0 0"/>
    <axis xyz="0 0 1"/>{second}</joint>
  <joint name="tip" type="fixed"><parent link="lower"/><child link="tool"/><origin xyz="3 0 0"/></joint>
</robot>"""
RANGE = '<limit lower="{}" upper="{}" effort="1" velocity="1"/>'


@pytest.fixture
def two_links(tmp_path):
    def loaded(kind="continuous", first="", second="", rpy="0 0 0"):
        path = tmp_path / "two_links.urdf"
        path.write_text(TWO_LINKS.format(kind=kind, first=first, second=second, rpy=rpy))
        return ks.load(path)

    return loaded


def limb_of(model, frame="tool", base=None):
    base = base or model.robot.root
    joints = tuple(joint.name for joint in model.robot.movable_path(base, frame))
    return Limb(frame, base, frame, joints, "tip")


def asked(model, limb, q):
    work = sweep_work(model, limb.frame, q, samples=1, measures="minimum_singular_value", relative_to=limb.base)
    return {"task": work.task, "length": work.length}


def cut(model, frame="tool", base=None, q="mid", families=None):
    limb = limb_of(model, frame, base)
    q = ks.configuration(model, q).q if isinstance(q, (str, dict)) else q
    return sections(model, limb, q, "mid", **asked(model, limb, q), families=families)


def radii(curves, kind="singular", about=(0, 0)):
    return [np.linalg.norm(curve.points - about, axis=1) for curve in curves if curve.kind == kind]


class TestTwoLinks:
    """Theory A5: links of 6 m and 3 m; det J = 18 sin q2."""

    def test_singular_curves_are_circles_of_radius_9_and_3(self, two_links):
        (section,) = cut(two_links())
        assert section.view == "above"
        inner, outer = sorted(radii(section.curves), key=lambda each: each[0])
        assert_allclose(inner, 3, atol=1e-12)
        assert_allclose(outer, 9, atol=1e-12)
        assert not section.unlimited
        assert {curve.kind for curve in section.curves} == {"singular"}
        assert {curve.label for curve in section.curves} == {"joint2 = 0", "joint2 = pi"}
        for curve in section.curves:  # once round, but for one step
            turns = np.unwrap(np.arctan2(*curve.points.T[::-1]))
            assert 2 * np.pi * 179 / 180 <= abs(turns[-1] - turns[0]) <= 2 * np.pi + 1e-9

    def test_the_clipped_form_has_an_arc_at_9_alone_and_limits(self, two_links):
        model = two_links("revolute", RANGE.format(0, 0.75 * np.pi), RANGE.format(0, 2 * np.pi / 3))
        (section,) = cut(model)
        (arc,) = [curve for curve in section.curves if curve.kind == "singular"]
        assert_allclose(np.linalg.norm(arc.points, axis=1), 9, atol=1e-6)
        ends = np.sort(np.arctan2(arc.points[[0, -1], 1], arc.points[[0, -1], 0]))
        assert_allclose(ends, [0, 0.75 * np.pi], atol=1e-6)
        limits = {curve.label: curve.points for curve in section.curves if curve.kind == "limit"}
        assert sorted(limits) == ["joint1 = 0", "joint1 = 2.356", "joint2 = 0", "joint2 = 2.094"]
        assert_allclose(np.linalg.norm(limits["joint1 = 0"] - [6, 0], axis=1), 3, atol=1e-12)
        inner = np.sqrt(36 + 9 + 36 * np.cos(2 * np.pi / 3))  # cosine rule
        assert_allclose(np.linalg.norm(limits["joint2 = 2.094"], axis=1), inner, atol=1e-12)
        beyond = np.concatenate(radii(section.unlimited))
        assert_allclose(np.min(np.abs(beyond[:, None] - [3, 9]), axis=1), 0, atol=1e-6)

    def test_what_is_beyond_limits_completes_the_circle(self, two_links):
        (section,) = cut(two_links("revolute", RANGE.format(-1, 2), RANGE.format(-2, 2)))
        every = [curve for curve in (*section.curves, *section.unlimited) if curve.label == "joint2 = 0"]
        turns = [np.unwrap(np.arctan2(*curve.points.T[::-1])) for curve in every if curve.kind == "singular"]
        assert_allclose(sum(np.ptp(each) for each in turns), 2 * np.pi, atol=0.04)
        (inside,) = [curve for curve in section.curves if curve.kind == "singular"]
        assert_allclose(np.ptp(np.unwrap(np.arctan2(*inside.points.T[::-1]))), 3, atol=1e-6)

    def test_its_cells_fill_the_annulus(self, two_links):
        (section,) = cut(two_links())
        box = np.array([[-9.5, -9.5], [9.5, 9.5]])
        best = best_in_cells(section.points, section.smallest, box, (380, 380))
        assert_allclose(np.count_nonzero(np.isfinite(best)) * 0.05**2, np.pi * (81 - 9), rtol=0.02)
        assert np.isnan(best[190, 190])

    def test_colours_do_not_depend_on_the_first_joint_nor_on_the_elbow_being_up_or_down(self, two_links):
        (section,) = cut(two_links())
        assert_allclose(section.smallest, section.smallest[:, :1] + np.zeros(181), atol=1e-12)
        assert_allclose(section.smallest, section.smallest[::-1], atol=1e-12)
        assert section.smallest.max() > 1

    @pytest.mark.parametrize("roll", [0.3, 0.7, 0.9, 1.2])
    def test_a_plane_that_leans_is_drawn_in_its_true_shape(self, two_links, roll):
        (section,) = cut(two_links(rpy=f"{roll} 0 0.4"))
        assert section.view == ("above" if roll < np.pi / 4 else "side")
        outer = max(radii(section.curves), key=lambda each: each[0])
        assert_allclose(outer, 9, atol=1e-12)
        assert_allclose(section.directions @ section.directions.T, np.eye(2), atol=1e-12)

    def test_an_arm_in_an_upright_plane_is_seen_from_the_side_alone(self, two_links):
        (section,) = cut(two_links(rpy="1.5707963267948966 0 0"))
        assert section.view == "side"
        assert_allclose(section.directions, [[1, 0, 0], [0, 0, 1]], atol=1e-12)

    @pytest.mark.parametrize("kind", ["fixed", "locked"])
    def test_what_moves_the_tool_on_a_line_at_most_has_no_section(self, two_links, kind):
        if kind == "fixed":
            model = ks.load("textbook:planar_1r")
        else:
            model = two_links("revolute", RANGE.format(-1, 1), RANGE.format(0, 0))
        assert cut(model) == ()

    def test_above_is_above_the_root_whatever_the_axes_of_the_base(self, two_links):
        model = two_links(rpy="1.2 0.4 0.1")
        across = model.engine.placement(np.zeros(2), "base", "mount")[:3, 2]
        wide = ks.load("example:ur5_robot")
        (seen,) = cut(model, base="mount")
        assert_allclose(seen.directions[:, 2], 0, atol=1e-9)  # the plane of the arm is the mount's
        assert seen.view == ("above" if abs(across[2]) > np.sqrt(0.5) else "side")
        q = ks.configuration(wide, "mid").q
        up = wide.engine.placement(q, wide.robot.root, "upper_arm_link")[:3, 2]
        for section in cut(wide, "tool0", "upper_arm_link"):
            along = section.directions @ up
            assert_allclose(along, [0, 1] if section.view == "side" else [0, 0], atol=1e-9)


CASES = {
    "textbook:scara": ("tool", {"joint2": 0.7}),
    "textbook:puma560": ("tool", {"joint5": 1.0}),
    "textbook:torus_3r": ("tool", {"joint3": 1.0}),
    "textbook:stanford": ("tool", {"joint5": 1.0, "joint3": 0.5, "joint2": 0.6}),
    "textbook:planar_3r": ("tool", {"joint3": 0.5}),
    "textbook:pr": ("tool", {}),
    "example:ur5_robot": ("tool0", {"elbow_joint": 1.0, "wrist_1_joint": -0.6, "wrist_2_joint": 1.2}),
    "example:panda": ("panda_hand", {"panda_joint4": -1.5, "panda_joint6": 1.6}),
    "example:a1": ("FR_foot", {"FR_thigh_joint": 0.8, "FR_calf_joint": -1.8}),
    "example:so100": ("gripper", {}),
}


@pytest.fixture(scope="module", params=CASES)
def real(request):
    """A robot, its limb, a configuration, the question of its sweep, its families, and its sections."""
    frame, positions = CASES[request.param]
    model = ks.load(request.param)
    limb, q = limb_of(model, frame), ks.configuration(model, positions).q
    question = asked(model, limb, q)
    redundant = request.param in ("example:panda", "example:so100")  # the Jacobian is not square
    families = singular_find(model, frame, starts=40) if redundant else None
    found = sections(model, limb, q, "here", **question, families=families)
    assert found
    return model, limb, q, question, families, found


def grid_places(model, limb, q, section, chosen):
    """Return configurations (k, nq) of places of a section's grid."""
    joints = coordinates(model, limb.frame, limb.base)
    ends = ends_of(joints)
    pair = [joints.names.index(name) for name in section.joints]
    rows, columns = chosen
    lines = [np.linspace(ends[0][index], ends[1][index], 181) for index in pair]
    whole = np.tile(q, (len(rows), 1))
    whole[:, joints.indices[pair[0]]] = lines[0][columns]
    whole[:, joints.indices[pair[1]]] = lines[1][rows]
    return whole, joints


def test_places_and_colours_are_those_of_pinocchio_with_joints_inside_limits(real):
    model, limb, q, question, _, found = real
    chosen = np.random.default_rng(1).integers(0, 181, (2, 12))
    rank = mechanism(model, limb.frame, axes=question["task"].row_names).generic_rank
    for section in found:
        whole, joints = grid_places(model, limb, q, section, chosen)
        pair = [joints.names.index(name) for name in section.joints]
        assert np.all(joints.inside(whole[:, list(joints.indices)])[:, pair])
        for at, row, column in zip(whole, *chosen, strict=True):
            place = model.engine.placement(at, limb.frame, limb.base)[:3, 3]
            assert_allclose(section.points[row, column], section.directions @ place, atol=1e-9)
            there = ks.manipulability(
                model, limb.frame, at, axes=question["task"].row_names, length=question["length"] or "none"
            )
            values = there.blocks["task"].singular_values
            assert_allclose(values[rank - 1], section.smallest[row, column], atol=1e-9)


def test_every_vertex_of_a_singular_curve_is_singular(real):
    model, limb, q, question, families, found = real
    joints = coordinates(model, limb.frame, limb.base)
    kernel = chain_kernel(joints, ("placement", "jacobian", "singular_values"), q, **question)
    kernel = replace(kernel, rank=mechanism(model, limb.frame, axes=question["task"].row_names).generic_rank)
    for section in found:
        pair = tuple(joints.names.index(name) for name in section.joints)
        two = TwoJoints(joints, kernel, pair, q[list(joints.indices)], ends_of(joints))
        for line in singular_lines(two, families):
            some = joints.configuration(two.coordinates(line[:: max(1, len(line) // 6)]), q)
            values = ks.manipulability(
                model, limb.frame, some, axes=question["task"].row_names, length=question["length"] or "none"
            )
            least = values.blocks["task"].singular_values[..., kernel.rank - 1]
            assert np.all(least < SINGULAR * section.smallest.max())


def test_the_same_again_is_the_same_to_the_bit(real):
    model, limb, q, question, families, found = real
    again = sections(model, limb, q, "here", **question, families=families)
    for one, other in zip(found, again, strict=True):
        assert one.joints == other.joints
        assert_array_equal(one.points, other.points)
        assert_array_equal(one.smallest, other.smallest)
        for curve, same in zip((*one.curves, *one.unlimited), (*other.curves, *other.unlimited), strict=True):
            assert curve.label == same.label
            assert_array_equal(curve.points, same.points)


def test_a_scara_is_singular_stretched_and_folded():
    above, side = cut(ks.load("textbook:scara"), q={"joint2": 0.7})
    assert (above.view, side.view) == ("above", "side")  # it mainly moves in a level plane
    assert above.joints == ("joint1", "joint2")
    assert_allclose(np.concatenate(radii(above.curves)), 0.7, atol=1e-9)
    assert_allclose(np.unique(np.concatenate(radii(above.unlimited)).round(9)), [0.1, 0.7])


def test_a_puma_is_singular_on_a_circle_about_its_shoulder_and_above_it():
    side, _ = cut(ks.load("textbook:puma560"), q={"joint5": 1.0})
    assert side.joints == ("joint2", "joint3")
    points = np.concatenate([curve.points for curve in side.curves if curve.kind == "singular"])
    upper, fore, radius = 0.4318, np.hypot(0.0203, 0.4318), np.linalg.norm(points, axis=1)
    stretched, folded = (np.abs(radius - each) < 1e-9 for each in (fore + upper, fore - upper))
    above_the_shoulder = np.abs(points[:, 0]) < 1e-9  # the wrist is in the plane of axis 1 that joint 2 turns across
    assert np.all(stretched | folded | above_the_shoulder)
    assert np.count_nonzero(stretched) > 100
    assert np.count_nonzero(above_the_shoulder) > 100


def test_a_slide_that_turns_is_singular_at_the_ends_of_its_crank():
    (section,) = cut(ks.load("textbook:pr"))
    lines = [curve.points for curve in section.curves if curve.kind == "singular"]
    assert_allclose(np.abs(np.concatenate(lines)[:, 1]), 0.6, atol=1e-9)
    assert {curve.label for curve in section.curves if curve.kind == "singular"} == {"joint2 = pi/2", "joint2 = -pi/2"}


def test_an_arm_that_is_singular_everywhere_there_has_no_curves():
    model = ks.load("textbook:puma560")
    for section in cut(model, q={"joint5": 0.0}):
        assert section.smallest.max() < 1e-12
        assert not [curve for curve in (*section.curves, *section.unlimited) if curve.kind == "singular"]


def test_a_redundant_arm_has_the_curves_of_its_families_and_no_others():
    model = ks.load("example:panda")
    q = {"panda_joint4": -1.5, "panda_joint6": 1.6}
    alone = cut(model, "panda_hand", q=q)
    families = singular_find(model, "panda_hand", starts=40)
    told = cut(model, "panda_hand", q=q, families=families)
    assert not [curve for section in alone for curve in section.curves if curve.kind == "singular"]
    elbow = {curve.label for section in told for curve in section.curves if curve.kind == "singular"}
    assert elbow == {"panda_joint4 = -0.467"}


def test_a_limb_without_joints_is_refused():
    model = ks.load("textbook:planar_2r")
    question = asked(model, limb_of(model), np.zeros(2))
    with pytest.raises(UsageError, match="no joint moves"):
        sections(model, Limb("base", "base", "base", (), "tip"), np.zeros(2), "mid", **question, families=None)


def test_a_joint_that_moves_in_a_plane_is_two_slides_and_a_turn(tmp_path):
    path = tmp_path / "cart.urdf"
    path.write_text(
        """<robot name="cart"><link name="world"/><link name="cart"/><link name="tool"/>
        <joint name="drive" type="planar"><parent link="world"/><child link="cart"/><axis xyz="0 0 1"/></joint>
        <joint name="tip" type="fixed"><parent link="cart"/><child link="tool"/><origin xyz="0.2 0 0.5"/></joint>
        </robot>"""
    )
    (section,) = cut(ks.load(path))
    assert section.view == "above"
    assert_allclose(np.ptp(section.points, axis=(0, 1)), [2, 2])
    assert not section.curves


MEASURES = ("yoshikawa", "minimum_singular_value", "inverse_condition_number")
PAIRS = {  # robot: limbs of it, and the joints that show each from the side: a shoulder and an elbow, a hip and a knee
    "example:pr2": {"left_arm": ("l_shoulder_lift_joint", "l_elbow_flex_joint")},
    "example:simple_humanoid": {"l_ankle": ("LLEG_HIP_P", "LLEG_KNEE"), "l_wrist": ("LARM_SHOULDER_P", "LARM_ELBOW")},
    "example:talos_full_v2": {"l_arm": ("arm_left_2_joint", "arm_left_4_joint")},
    "example:panda": {"arm": ("panda_joint2", "panda_joint4")},
    "example:a1": {"lf_leg": ("FL_thigh_joint", "FL_calf_joint")},
    "example:kinova": {"end_effector": ("j2s6s200_joint_2", "j2s6s200_joint_3")},
}
MIRRORED = [
    ("example:pr2", "left_arm", "right_arm", {"l_": "r_"}),
    ("example:simple_humanoid", "l_ankle", "r_ankle", {"LLEG": "RLEG"}),
    ("example:simple_humanoid", "l_wrist", "r_wrist", {"LARM": "RARM"}),
    ("example:talos_full_v2", "l_arm", "r_arm", {"left": "right"}),
]


@cache
def shown(source, name):
    """Return the views of a limb at the pose in which a report holds it, and the coordinates and that pose."""
    model = ks.load(source)
    limb = next(one for one in limbs(model).limbs if one.name == name)
    middle = ks.configuration(model, "mid").q
    swept = sweep(model, limb.frame, middle, samples=500, measures=MEASURES, relative_to=limb.base)
    q, _ = held_pose(model, limb, swept, limb_poses(model, limb, swept, Gathered({}, name)))
    joints = coordinates(model, limb.frame, limb.base)
    up = model.engine.placement(q, model.robot.root, limb.base)[:3, 2]
    return joints, q, views_of_limb(joints, q, up, ends_of(joints))


def names_of(joints, view):
    return tuple(joints.names[index] for index in view.pair)


@pytest.mark.parametrize(("source", "name"), [(robot, limb) for robot, every in PAIRS.items() for limb in every])
def test_from_the_side_a_shoulder_and_an_elbow_move_in_a_plane(source, name):
    joints, q, (side, *_) = shown(source, name)
    assert side.view == "side"
    assert names_of(joints, side) == PAIRS[source][name]
    axes = joints.chain.jacobian(q[list(joints.indices)])[3:, side.pair].T
    assert abs(axes[0] @ axes[1]) > 0.9


@pytest.mark.parametrize(("source", "left", "right", "words"), MIRRORED)
def test_limbs_that_mirror_each_other_are_shown_by_the_same_joints(source, left, right, words):
    """From the side at least; the limits of simple_humanoid are not mirrored, and from above others may cover more."""
    pairs = []
    for name in (left, right):
        joints, _, (side, *_) = shown(source, name)
        pairs.append(" ".join(names_of(joints, side)))
    for ours, theirs in words.items():
        pairs[0] = pairs[0].replace(ours, theirs)
    assert pairs[0] == pairs[1]


NAMES = {"example:ur5_robot": "tool0", "example:panda": "arm", "example:a1": "rf_leg", "example:pr2": "right_arm"}


@pytest.mark.parametrize(("source", "name"), NAMES.items())
def test_the_second_joint_shown_brings_the_tool_nearer_and_farther(source, name):
    """Two joints of a shoulder swing a rigid arm: the tool's distance from where their axes meet does not change."""
    joints, q, views = shown(source, name)
    for view in views:
        first, second = view.pair
        own = np.tile(q[list(joints.indices)], (40, 1))
        axis = joints.chain.jacobian(own[0])[:, first]
        tool = joints.chain.columns(own)[1][:, :3, 3]
        own[:, second] = np.linspace(*(ends[second] for ends in ends_of(joints)), 40)
        foot = tool[0] + np.cross(axis[3:], axis[:3])
        away = np.linalg.norm(np.cross(joints.chain.columns(own)[1][:, :3, 3] - foot, axis[3:]), axis=1)
        assert np.ptp(away) > 0.2 * away.max()


def test_from_above_a_joint_about_the_vertical_and_the_same_elbow_move():
    joints, _, (side, above) = shown("example:ur5_robot", "tool0")
    assert names_of(joints, side) == ("shoulder_lift_joint", "elbow_joint")
    assert names_of(joints, above) == ("shoulder_pan_joint", "elbow_joint")


def test_from_above_is_left_out_where_the_limb_moves_equally_well_all_over_it():
    every = cut(ks.load("example:romeo"), "HeadRollLink", "torso")
    assert [section.view for section in every] == ["side"]
    assert every[0].same_everywhere


def test_limits_are_drawn_only_where_they_bound_what_is_covered(two_links):
    """The elbow goes both ways: where joint 1 is at a limit, half of the places are reached the other way, too."""
    (section,) = cut(two_links("revolute", RANGE.format(-1, 1), RANGE.format(-2, 2)))
    limits = [curve for curve in section.curves if curve.kind == "limit"]
    assert limits
    for curve in limits:
        for place in curve.points[2:-2]:
            near = place + 0.3 * np.stack([np.cos(np.linspace(0, 6.2, 24)), np.sin(np.linspace(0, 6.2, 24))], -1)
            distances = np.linalg.norm(section.points.reshape(-1, 1, 2) - near, axis=-1).min(axis=0)
            assert distances.max() > 0.1  # something beside it is not covered
    inner = np.sqrt(36 + 9 + 36 * np.cos(2.0))
    assert_allclose(np.linalg.norm(next(c for c in limits if "joint2" in c.label).points, axis=1), inner, atol=1e-9)
    lengths = [np.linalg.norm(np.diff(c.points, axis=0), axis=1).sum() for c in limits if "joint1" in c.label]
    assert sum(lengths) < 0.8 * 2 * 3 * 4  # of both turns of 4 rad about the elbow, 3 m


def test_a_piece_of_a_curve_beyond_limits_that_continues_nothing_is_left_out():
    for section in cut(ks.load("example:a1"), "FR_foot", q={"FR_thigh_joint": 0.8, "FR_calf_joint": -1.8}):
        drawn = [curve.points for curve in section.curves if curve.kind == "singular"]
        for curve in section.unlimited:
            ends = np.concatenate([part[[0, -1]] for part in drawn]) if drawn else np.zeros((0, 2))
            touches = np.any(np.linalg.norm(ends[:, None] - curve.points[[0, -1]], axis=-1) < 1e-2)
            assert touches or np.linalg.norm(curve.points[0] - curve.points[-1]) < 1e-5
            assert np.min(np.ptp(curve.points, axis=0)) > 0.01 or touches


class TestCertificate:
    @pytest.mark.parametrize("name", ["textbook:scara", "textbook:puma560", "example:panda"])
    def test_pinocchio_computes_places_all_over_a_section_again(self, name):
        model = ks.load(name)
        frame = model.robot.links[-1].name
        for section in cut(model, frame):
            assert section.certificate.engines == ("pinocchio", "screw")
            assert section.certificate.agree is True
            assert section.certificate.numbers >= 61 * (12 + 6 * len(section.held))

    @pytest.mark.parametrize("answer", ["placement", "jacobian"])
    def test_it_notices_what_is_off_by_a_micrometre(self, two_links, monkeypatch, answer):
        model = two_links()
        right = getattr(model.engine, answer)
        monkeypatch.setattr(model.engine, answer, lambda *arguments: right(*arguments) + 1e-6)
        (section,) = cut(model)
        assert section.certificate.agree is False
        assert len(section.certificate.values) == 2

    def test_it_says_that_nothing_was_computed_twice(self, two_links):
        (section,) = cut(replace(two_links(), crosscheck=False))
        assert section.certificate.agree is None
        assert section.certificate.numbers == 0
