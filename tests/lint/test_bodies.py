"""Tensors, bodies, shapes and sides: laws first, then what is known."""

import dataclasses
import itertools
import math
import time

import numpy as np
import pytest

from kinetostat.errors import quote
from kinetostat.lint.bodies import LinkInertia, bodies_of
from kinetostat.lint.finding import Severity
from kinetostat.lint.linting import lint
from kinetostat.lint.mirror import compared, in_words
from kinetostat.lint.registry import chosen
from kinetostat.lint.rule import Example
from kinetostat.lint.rules.inertia import INERTIA
from kinetostat.lint.rules.inertia.slips import DENSEST, densest_moment, likely_units, reordered
from kinetostat.lint.shapes import extent_of
from kinetostat.lint.sides import pairs
from kinetostat.lint.subject import subject_of
from kinetostat.lint.tensors import Flaw, Rounding, deficit, flaw_of, principal_moments, rounding_of
from kinetostat.screw import so3
from kinetostat.urdf.document import Element, parse
from kinetostat.urdf.files import example_robots
from lint.examples import linted

RNG = np.random.default_rng(20240607)
FREE = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


def entries(tensor):
    return tuple(float(tensor[i, j]) for i, j in FREE)


def cloud(count=12):
    """Return points with masses: what any rigid body is."""
    return RNG.uniform(0.1, 1.0, count), RNG.normal(size=(count, 3)) * RNG.uniform(0.01, 0.3, 3)


def moments_of(masses, points):
    """Return centre of mass and tensor about it, summed point by point."""
    centre = masses @ points / masses.sum()
    tensor = np.zeros((3, 3))
    for mass, arm in zip(masses, points - centre, strict=True):
        tensor -= mass * so3.hat(arm) @ so3.hat(arm)
    return centre, tensor


def inertia_of(masses, points):
    centre, tensor = moments_of(masses, points)
    link = Element("link", {"name": "l"}, 1)
    written = entries(tensor)
    return LinkInertia(link, link, masses.sum(), tuple(centre), (0.0,) * 3, written, principal_moments(written), None)


def loaded(tmp_path, robot):
    path = tmp_path / "robot.urdf"
    path.write_text(Example(robot).robot_text, encoding="utf-8")
    return subject_of(str(path))


def solid(mass, tensor, xyz="0 0 0"):
    keys = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    numbers = " ".join(f'{key}="{value!r}"' for key, value in zip(keys, tensor, strict=True))
    return f'<inertial><origin xyz="{xyz}"/><mass value="{mass!r}"/><inertia {numbers}/></inertial>'


# --- tensors ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("_", range(20))
def test_no_body_has_a_flaw(_):
    masses, points = cloud()
    _, tensor = moments_of(masses, points)
    assert flaw_of(masses.sum(), entries(tensor), principal_moments(entries(tensor)), Rounding()) is None
    assert reordered(entries(tensor)) is None or deficit(principal_moments(entries(tensor))) <= 0


@pytest.mark.parametrize("_", range(20))
def test_principal_moments_do_not_depend_on_the_axes(_):
    _, tensor = moments_of(*cloud())
    turn = so3.exp(RNG.normal(size=3))
    assert np.allclose(
        principal_moments(entries(tensor)), principal_moments(entries(turn @ tensor @ turn.T)), rtol=1e-12
    )


def test_a_flat_body_is_on_the_edge_of_the_triangle_inequality_and_one_step_beyond_is_not_a_body():
    masses, points = cloud()
    points[:, 2] = 0
    _, tensor = moments_of(masses, points)
    moments = principal_moments(entries(tensor))
    assert abs(deficit(moments)) < 1e-14
    assert flaw_of(1.0, entries(tensor), moments, Rounding()) is None
    beyond = (moments[0], 0.0, 0.0, moments[1], 0.0, moments[2] * 1.001)
    assert flaw_of(1.0, beyond, principal_moments(beyond), Rounding()) is Flaw.TRIANGLE


@pytest.mark.parametrize(
    ("written", "flaw"),
    [
        ((0, 0, 0, 0, 0, 0), Flaw.ZERO),
        ((1e-19, 0, 0, -1e-20, 0, 1e-19), Flaw.ZERO),
        ((1, 1, 1, 1, 1, 1), Flaw.ALIKE),
        ((-1, 0, 0, 1, 0, 1), Flaw.NEGATIVE),
        ((1, 2, 0, 1, 0, 1), Flaw.NEGATIVE),
        ((1, 0, 0, 1, 0, 0), Flaw.SINGULAR),
        ((1, 0, 0, 1, 0, 3), Flaw.TRIANGLE),
    ],
)
def test_flaws_are_told_apart(written, flaw):
    assert flaw_of(1.0, written, principal_moments(written), Rounding()) is flaw


@pytest.mark.parametrize("_", range(200))
def test_rounding_a_body_to_the_digits_written_is_no_more_than_rounding(_):
    masses, points = cloud(3)
    points[:, 2] *= 1e-3  # nearly flat: close to the edge
    _, tensor = moments_of(masses * 1e-3, points)
    digits = RNG.integers(2, 6)
    words = [f"{value:.{digits}e}" for value in entries(tensor)]
    rounded = tuple(map(float, words))
    flaw = flaw_of(masses.sum() * 1e-3, rounded, principal_moments(rounded), rounding_of(words))
    assert flaw in (None, Flaw.ROUNDED, Flaw.SINGULAR)


def test_a_digit_counts_from_the_last_place():
    assert rounding_of(["0.010", "0", "0", "0", "0", "0"]).deficit == pytest.approx(0.0005)
    assert rounding_of(["1.00e-2", "0", "0", "0", "0", "0"]).deficit == pytest.approx(0.00005)
    assert rounding_of(["0.01", "0", "0", "0", "0", "0"]).deficit == pytest.approx(0.001), "a tenth of it at most"
    assert rounding_of(["1e999999999", "0", "0", "0", "0", "0"]).deficit > 0, "no overflow"
    assert rounding_of([f"1e{'0' * 9999}1", "0", "0", "0", "0", "0"]).deficit > 0, "an exponent of many digits"


def test_of_all_bodies_of_osmium_the_ball_has_the_least_moment():
    for sides in RNG.uniform(0.01, 0.2, (50, 3)):
        mass = DENSEST * sides.prod()
        a, b, c = sides
        box = mass / 12 * np.array([b * b + c * c, a * a + c * c, a * a + b * b])
        assert box.mean() > densest_moment(mass)
    radius = 0.05
    ball = DENSEST * 4 / 3 * math.pi * radius**3
    assert densest_moment(ball) == pytest.approx(2 / 5 * ball * radius**2)


@pytest.mark.parametrize(
    ("order", "says"),
    [
        ((0, 1, 3, 2, 4, 5), "iyy and ixz"),  # the lower triangle, row by row: xx xy yy xz yz zz
        ((0, 3, 5, 1, 2, 4), "moments stand first"),
        ((0, 3, 5, 4, 2, 1), "moments stand first"),
        ((0, 1, 2, 1, 3, 4), "row by row"),
    ],
)
def test_an_order_of_entries_that_is_not_urdfs_is_recognised(order, says):
    recognised = 0
    for _ in range(50):
        low, high = sorted(RNG.uniform(0.4, 1.0, 2))
        products = RNG.uniform(-0.1, 0.1, 3) * low
        tensor = (high, products[0], products[1], low, products[2], RNG.uniform(high - low, high + low))
        if tensor[5] < 0.4 or deficit(principal_moments(tensor)) > 0:
            continue
        slip = reordered([tensor[i] for i in order])
        assert slip is None or says in slip
        recognised += slip is not None
        assert flaw_of(1.0, tensor, principal_moments(tensor), Rounding()) is None
    assert recognised > 10


@pytest.mark.parametrize(("factor", "unit"), [(1e4, "kg cm2"), (1e6, "kg mm2"), (1e9, "g mm2")])
def test_units_of_cad_programs_are_named(factor, unit):
    gyration, size = 0.1, 1.0
    assert likely_units(gyration * math.sqrt(factor), size)[0] == unit


# --- mirror images ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("turn", list(itertools.product((1, -1), repeat=3)))
def test_mirror_images_and_turned_parts_have_the_right_signs(turn):
    masses, points = cloud()
    joint = RNG.normal(size=3)
    found = compared(
        inertia_of(masses, points), inertia_of(masses, points * turn), [(tuple(joint), tuple(joint * turn))]
    )
    assert found.differing == ()
    assert found.wrong == ()


def skew():
    """Return a body whose centre and products of inertia all tell a sign."""
    masses = np.array([1.0, 1.0, 1.0, 1.0])
    points = np.array([[0.2, 0.1, 0.15], [0.4, 0.3, 0.05], [0.1, 0.35, 0.3], [0.3, 0.1, 0.4]])
    return inertia_of(masses, points)


@pytest.mark.parametrize("product", [1, 2, 4])
@pytest.mark.parametrize("turn", [(1, 1, 1), (1, -1, 1), (-1, -1, -1)])
def test_one_wrong_sign_is_found(product, turn):
    left = skew()
    signs = [turn[i] * turn[j] for i, j in FREE]
    signs[product] *= -1
    written = tuple(sign * value for sign, value in zip(signs, left.entries, strict=True))
    centre = tuple(t * c for t, c in zip(turn, left.centre, strict=True))
    right = LinkInertia(left.link, left.element, left.mass, centre, left.rpy, written, left.principal, None)
    found = compared(left, right, [])
    assert found.differing == ()
    assert len(found.wrong) == 1
    assert found.turn == turn


def test_it_is_not_clear_how_a_part_is_mirrored_whose_products_fit_another_mirror_than_its_centre():
    left = skew()
    x, y, z = left.centre
    right = dataclasses.replace(left, centre=(x, -y, z))  # are the products wrong, or the centre?
    found = compared(left, right, [])
    assert found.wrong
    assert found.turn is None


@pytest.mark.parametrize("turn", list(itertools.product((1, -1), repeat=3)))
def test_what_is_said_to_change_sign_is_what_changes_in_a_mirror_image(turn):
    left, right = skew(), skew().in_link_frame() * np.outer(turn, turn)
    said = in_words(turn).partition(",")[2]
    for axis, sign in zip("xyz", turn, strict=True):
        assert (f" {axis}" in said.replace("the centre's ", " ").replace(",", " ")) == (sign < 0)
    for name, (i, j) in {"ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}.items():
        assert (name in said) == (right[i, j] * left.in_link_frame()[i, j] < 0)


@pytest.mark.parametrize(
    ("robot", "link", "says"),
    [
        ("human_description/human", "right_clavicle", "mirrored in z"),
        ("talos_data/talos_reduced", "arm_right_1_link", "mirrored in y"),
        ("tiago_description/tiago_dual", "arm_right_3_link", "mirrored in z"),
        ("tiago_description/tiago_dual", "arm_right_4_link", "mirrored in a point"),
    ],
)
def test_the_hint_says_how_the_frames_of_a_real_robot_are_mirrored(robot, link, says):
    found = [
        f
        for f in lint(subject_of(f"example:{robot}"), chosen(["I402"])).findings
        if quote(link) in f.element and f.hint
    ]
    assert [says in f.hint for f in found] == [True]


def test_what_moves_on_a_part_tells_how_it_is_mirrored():
    left = skew()
    assert compared(left, left, []).wrong == ()
    found = compared(left, left, [((0.0, 0.3, 0.0), (0.0, -0.3, 0.0))])
    assert "y of the centre of mass" in {each.what for each in found.wrong}
    assert found.joints


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("left_arm", "right_arm"),
        ("arm_left_1_link", "arm_right_1_link"),
        ("l_wrist", "r_wrist"),
        ("wrist_l", "wrist_r"),
        ("FL_hip", "FR_hip"),
        ("RL_hip", "RR_hip"),
        ("lf_foot", "rf_foot"),
        ("LH_SHANK", "RH_SHANK"),
        ("LArm", "RArm"),
        ("LARM_LINK1", "RARM_LINK1"),
        ("TorsoLeftIMULink", "TorsoRightIMULink"),
        ("LEFT_HIP_X", "RIGHT_HIP_X"),
    ],
)
def test_left_and_right_are_found_wherever_they_stand(left, right):
    assert pairs([right, "base", left]) == [(left, right)]


@pytest.mark.parametrize(
    "names",
    [
        ["left_arm", "Right_arm"],
        ["l_gripper_l_finger", "r_gripper_l_finger"],
        ["lower_arm", "rower_arm"],
        ["cleft", "cright"],
        ["Link", "Rink"],
        ["base"],
    ],
)
def test_what_is_not_clearly_a_pair_is_none(names):
    assert pairs(names) == []


# --- shapes -------------------------------------------------------------------------------------------------------


def extent(text):
    link = parse(f'<robot name="r"><link name="l">{text}</link></robot>'.encode(), "r").root.children[0]
    return extent_of(link)


def sampled(shape, count=20000):
    """Return points on the surface of a shape, in its own frame."""
    kind, sizes = shape
    if kind == "box":
        return np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * sizes
    directions = RNG.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    radius, length = sizes
    if kind == "cylinder":
        rims = directions[:, :2] / np.linalg.norm(directions[:, :2], axis=1, keepdims=True) * radius
        return np.column_stack([rims, np.sign(directions[:, 2]) * length / 2])
    return directions * radius + np.sign(directions[:, 2:]) * [0, 0, length / 2]


SHAPES = {
    '<box size="0.2 0.3 0.5"/>': ("box", (0.2, 0.3, 0.5)),
    '<cylinder radius="0.1" length="0.5"/>': ("cylinder", (0.1, 0.5)),
    '<sphere radius="0.1"/>': ("sphere", (0.1, 0.0)),
    '<capsule radius="0.1" length="0.5"/>': ("capsule", (0.1, 0.5)),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("rpy", [(0, 0, 0), (0.4, -1.1, 2.0), (0, math.pi / 2, 0), (math.pi, 0, 0)])
def test_the_box_of_a_shape_just_holds_its_surface(shape, rpy):
    text = " ".join(map(str, rpy))
    box = extent(f'<visual><origin xyz="1 2 3" rpy="{text}"/><geometry>{shape}</geometry></visual>')
    points = sampled(SHAPES[shape]) @ so3.from_rpy(np.array(rpy, dtype=float)).T + [1, 2, 3]
    assert np.all(points.min(axis=0) >= np.array(box.low) - 1e-12)
    assert np.all(points.max(axis=0) <= np.array(box.high) + 1e-12)
    assert np.allclose(points.min(axis=0), box.low, atol=5e-3)
    assert np.allclose(points.max(axis=0), box.high, atol=5e-3)


def test_no_mass_in_a_box_has_a_larger_radius_of_gyration_than_half_its_diagonal():
    box = extent('<visual><geometry><box size="0.2 0.3 0.5"/></geometry></visual>')
    corners = np.array(list(itertools.product(*zip(box.low, box.high, strict=True))))
    for _ in range(100):
        masses = RNG.uniform(0, 1, 8) ** 4 + 1e-9
        assert inertia_of(masses, corners).gyration <= box.half_diagonal + 1e-12


def test_a_volume_is_that_of_the_collision_shapes():
    ball = '<geometry><sphere radius="0.5"/></geometry>'
    box = '<geometry><box size="1 1 1"/></geometry>'
    both = extent(f"<visual>{box}</visual><collision>{ball}</collision>")
    assert both.volume == pytest.approx(math.pi / 6)
    assert both.outside((0.5, 0.5, 0.5)) == 0
    assert both.outside((1.5, 0.5, 0.5)) == 1


@pytest.mark.parametrize(
    "text",
    [
        "",
        "<visual/>",
        "<visual><geometry/></visual>",
        '<visual><geometry><mesh filename="a.stl"/></geometry></visual>',
        '<visual><geometry><box size="1 1"/></geometry></visual>',
        '<visual><geometry><box size="1 1 0"/></geometry></visual>',
        '<visual><geometry><sphere radius="nan"/></geometry></visual>',
        '<visual><geometry><cylinder radius="1"/></geometry></visual>',
        '<visual><origin xyz="0 0 1e300"/><geometry><sphere radius="1"/></geometry></visual>',
        '<visual><origin rpy="a b c"/><geometry><sphere radius="1"/></geometry></visual>',
        '<visual><origin quat_xyzw="0 0 0 1"/><geometry><sphere radius="1"/></geometry></visual>',
    ],
)
def test_what_is_no_readable_primitive_has_no_extent(text):
    assert extent(text) is None


# --- bodies -------------------------------------------------------------------------------------------------------


def joint(parent, child, kind="continuous", xyz="0 0 1"):
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{parent}-{child}" type="{kind}"><origin xyz="{xyz}"/>{ends}</joint>'


def test_fixed_joints_make_bodies(tmp_path):
    weight = solid(2.0, (0.02, 0.0, 0.0, 0.02, 0.0, 0.02))
    robot = f"""
        <link name="tip"/><link name="b">{weight}</link><link name="a">{weight}</link><link name="base"/>
        {joint("b", "tip", "fixed")}{joint("base", "a")}{joint("a", "b", "fixed")}"""
    bodies = bodies_of(loaded(tmp_path, robot))
    assert {name: set(body.links) for name, body in bodies.bodies.items()} == {"a": {"a", "b", "tip"}, "base": {"base"}}
    assert bodies.of("tip").mass == 4
    assert bodies.of("tip").parent == "base"
    assert bodies.of("base").carrier is None
    assert bodies.reach == 3


@pytest.mark.parametrize(
    "joints",
    [
        joint("a", "b", "fixed") + joint("b", "a", "fixed"),
        joint("a", "a", "fixed"),
        joint("a", "a"),
        joint("a", "b") + joint("b", "a"),
        joint("nowhere", "a") + joint("a", "b", "fixed"),
        '<joint/><joint type="fixed"><parent/><child link="a"/></joint>',
        joint("a", "b", xyz="1 1") + joint("a", "b", "fixed"),
    ],
)
def test_what_is_no_tree_still_has_bodies(joints, tmp_path):
    subject = loaded(tmp_path, f'<link name="a"/><link name="b"/><link name="b"/><link/>{joints}')
    bodies = bodies_of(subject)
    assert set(bodies.head) == {"a", "b"}
    assert all(name in body.links for name, body in bodies.bodies.items())
    for rule in INERTIA:
        list(rule.check(subject))


@pytest.mark.parametrize("tensor", [(0.02, 0.0, 0.0, 0.02, 0.0, 0.02), (1e-20, 0.0, 0.0, 0.0, 0.0, 0.0)])
def test_twenty_thousand_links_take_no_more_than_their_share(tensor, tmp_path):
    def seconds(count):
        links = "".join(f'<link name="left_{i}">{solid(2.0, tensor)}</link>' for i in range(count))
        joints = '<link name="base"/>' + joint("base", "left_0")
        joints += "".join(joint(f"left_{i}", f"left_{i + 1}", "fixed") for i in range(count - 1))
        subject = loaded(tmp_path, links + joints)
        start = time.perf_counter()
        for rule in INERTIA:
            list(rule.check(subject))
        return time.perf_counter() - start

    assert seconds(16_000) < 60  # it takes about 2; each against each would take many minutes


# --- severities and sums ------------------------------------------------------------------------------------------


def found(tmp_path, robot):
    return {(f.code, f.severity) for f in linted(Example(robot), tmp_path, INERTIA).findings}


def two(mass, tensor):
    return f'<link name="base"/><link name="arm">{solid(mass, tensor)}</link>{joint("base", "arm")}'


GOOD = (0.02, 0.0, 0.0, 0.02, 0.0, 0.02)


@pytest.mark.parametrize(
    ("robot", "expected"),
    [
        (two(2.0, GOOD), set()),
        (two(0.0, GOOD), {("I103", Severity.ERROR)}),
        (two(0.0, (0.0,) * 6), {("I103", Severity.WARNING)}),
        (two(2.0, (-0.02, 0.0, 0.0, 0.02, 0.0, 0.02)), {("I202", Severity.ERROR)}),
        (two(2.0, (0.02, 0.0, 0.0, 0.02, 0.0, 0.0)), {("I202", Severity.WARNING)}),
        (two(2.0, (0.02, 0.0, 0.0, 0.02, 0.0, 0.05)), {("I203", Severity.WARNING)}),
        (two(2.0, (1.0, 0.0, 0.0, 1.0, 0.0, 1.0)), {("I204", Severity.WARNING)}),
        (two(2.0, (2e4, 0.0, 0.0, 2e4, 0.0, 2.1e4)), {("I207", Severity.WARNING)}),
        (two(2.0, (2e-5, 0.0, 0.0, 2e-5, 0.0, 2.1e-5)), {("I208", Severity.WARNING)}),
        (two(1e300, GOOD), {("I105", Severity.ERROR)}),
    ],
)
def test_one_defect_is_one_finding(robot, expected, tmp_path):
    assert found(tmp_path, robot) - {("X001", Severity.ERROR)} == expected


def test_tensors_about_the_origin_are_a_warning_where_most_are(tmp_path):
    links, joints = '<link name="base"/>', ""
    for i in range(4):
        masses, points = cloud()
        centre, tensor = moments_of(masses, points * 0.2 + RNG.choice((-1, 1), 3) * RNG.uniform(0.2, 0.3, 3))
        about = tensor - masses.sum() * so3.hat(centre) @ so3.hat(centre)
        links += f'<link name="a{i}">{solid(masses.sum().item(), entries(about), " ".join(map(str, centre)))}</link>'
        joints += joint("base", f"a{i}")
    assert ("I206", Severity.WARNING) in found(tmp_path, links + joints)


def test_well_used_robots_have_few_errors_of_inertia():
    errors = {
        name
        for name in example_robots()
        if (subject := subject_of(f"example:{name}")).document is not None
        for rule in INERTIA
        for finding in rule.check(subject)
        if finding.severity is Severity.ERROR
    }
    # Three tensors of this one have principal moments below zero; Pinocchio takes it, MuJoCo does not.
    assert errors == {"romeo_description/romeo_laas_small"}
