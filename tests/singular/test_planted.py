"""Arms with a planted degeneracy, at random everywhere else: found, named, and its cause told of the right joints.

Joints have random names, frames, zeros and places in the file, with fixed joints between them; so nothing can go by
index, by name, or by an angle of zero.
"""

import math

import numpy as np
import pytest

import kinetostat as ks
from singular.arms import Line, decisive, direction, families, near_angle, planned, pure, whole
from trees import load_text

PI = math.pi
SEEDS = [1, 2]


def random_lines(seed, count):
    random = np.random.default_rng(seed)
    return [Line(tuple(direction(random)), tuple(random.uniform(-0.6, 0.6, 3))) for _ in range(count)], random


def found(model, **asked):
    return ks.singular_find(model, "hand", starts=120, **asked)


def single(result, joint, position, slide=False):
    """Return the one family of a joint at a position, which is right to 1e-9."""
    match = [
        family
        for family in result.families
        if list(family.positions) == [joint]
        and not family.implicit
        and (abs(family.positions[joint] - position) if slide else float(near_angle(family.positions[joint], position)))
        < 1e-9
    ]
    assert len(match) == 1, [(f.positions, f.support) for f in result.families]
    return match[0]


def told(family, *joints):
    """Return the text of the cause that is about exactly these joints."""
    texts = [cause.text for cause in family.causes if set(cause.joints) == set(joints)]
    assert texts, family.causes
    return texts[0]


def certain(result):
    """Assert what holds of every answer."""
    assert result.certificate.agree is True
    for family in result.families:
        assert decisive(result.mechanism, family.witness) < 1e-9
        for joint, position in family.positions.items():
            assert near_angle(family.witness[result.mechanism.names.index(joint)], position) < 1e-2


@pytest.mark.parametrize("seed", SEEDS)
def test_three_parallel_axes_come_into_one_plane(seed):
    lines, random = random_lines(seed, 6)
    common, offset = direction(random), random.uniform(-2, 2)
    across = np.cross(common, direction(random))
    base = random.uniform(-0.3, 0.3, 3)
    for i, along in zip((1, 2, 3), (0.0, 0.4, 0.9), strict=True):
        lines[i] = Line(tuple(common), tuple(base + along * across))
    lines[2].at = offset
    model, names = planned(lines, seed)
    result = found(model)
    certain(result)
    for position in (offset, offset + PI):
        family = single(result, names[2], position)
        assert (family.name, family.kind, family.codimension, family.complete) == ("elbow", "fold", 1, True)
        assert "parallel and lie in one plane" in told(family, *names[1:4])
    assert {tuple(f.positions) for f in result.families if f.positions} == {(names[2],)}


@pytest.mark.parametrize("seed", SEEDS)
def test_axes_that_coincide_at_a_planted_angle(seed):
    """Axes 3 and 5 coincide, and nothing else is special: axis 4 is skew to both."""
    lines, random = random_lines(seed, 6)
    offset = random.uniform(-2, 2)
    lines[4] = Line(lines[2].direction, tuple(np.array(lines[2].point) + 0.37 * np.array(lines[2].direction)))
    lines[3].at = offset
    model, names = planned(lines, seed)
    result = found(model)
    certain(result)
    family = single(result, names[3], offset)
    assert (family.kind, family.codimension) == ("tangential", 1)
    assert family.name == "elbow"
    assert "coincide" in told(family, names[2], names[4])
    assert sum(not f.implicit for f in result.families) == 1


@pytest.mark.parametrize("seed", SEEDS)
def test_a_spherical_wrist(seed):
    """Axes 4 and 6 are square to axis 5: they coincide at the planted angle and half a turn on."""
    lines, random = random_lines(seed, 6)
    centre, middle = random.uniform(-0.4, 0.4, 3), direction(random)
    outer, offset = np.cross(middle, direction(random)), random.uniform(-2, 2)
    lines[3], lines[5] = Line(tuple(outer), tuple(centre)), Line(tuple(-outer), tuple(centre))
    lines[4] = Line(tuple(middle), tuple(centre), at=offset)
    model, names = planned(lines, seed)
    result = found(model)
    certain(result)
    for position in (offset, offset + PI):
        family = single(result, names[4], position)
        assert (family.name, family.kind) == ("wrist", "tangential")
        assert "coincide" in told(family, names[3], names[5])
    assert {f.name for f in result.families if f.positions} == {"wrist"}


@pytest.mark.parametrize("seed", SEEDS)
def test_a_wrist_that_folds_into_a_plane(seed):
    """Oblique axes: 50 and 70 degrees apart, in one plane at the planted angle and half a turn on; never collinear."""
    lines, random = random_lines(seed, 6)
    centre, middle = random.uniform(-0.4, 0.4, 3), direction(random)
    other = np.cross(middle, direction(random))
    other /= np.linalg.norm(other)
    offset = random.uniform(-2, 2)
    first = math.cos(0.9) * middle + math.sin(0.9) * other
    last = math.cos(1.2) * middle + math.sin(1.2) * other
    lines[3], lines[5] = Line(tuple(first), tuple(centre)), Line(tuple(last), tuple(centre))
    lines[4] = Line(tuple(middle), tuple(centre), at=offset)
    model, names = planned(lines, seed)
    result = found(model)
    certain(result)
    for position in (offset, offset + PI):
        family = single(result, names[4], position)
        assert (family.name, family.kind) == ("wrist", "fold")
        assert told(family, *names[3:]).endswith("meet in a point and lie in one plane")


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(("offset_along", "falls"), [(0.3, 100), (0.0, 10)])
def test_a_slide_through_the_shoulder_is_a_double_root(seed, offset_along, falls):
    """Two axes meet; a slide square to the second carries a spherical wrist through it: a factor (d - c)^2.

    Offset along the second axis as in the Stanford arm one direction is lost, and sigma falls as the square; through
    the point where both axes meet two are lost, and sigma falls as the distance.
    """
    random = np.random.default_rng(seed)
    shoulder, first = random.uniform(-0.2, 0.2, 3), direction(random)
    second = direction(random)
    along = np.cross(second, direction(random))
    along /= np.linalg.norm(along)
    middle = np.cross(along, direction(random))
    offset = random.uniform(-0.3, 0.3)
    lines = [
        Line(tuple(first), tuple(shoulder + offset_along * second)),
        Line(tuple(second), tuple(shoulder), at=0.7),
        Line(tuple(along), kind="prismatic", at=offset, limits=(-1.0, 1.0)),
        Line(tuple(along), tuple(shoulder)),
        Line(tuple(middle), tuple(shoulder), at=-0.4),
        Line(tuple(along), tuple(shoulder)),
    ]
    model, names = planned(lines, seed)
    result = found(model)
    family = single(result, names[2], offset, slide=True)
    assert (family.kind, family.tolerance, family.complete) == ("tangential", "strict", True)
    assert decisive(result.mechanism, family.witness) < 1e-9
    q = result.mechanism.draw(np.random.default_rng(0), (3,))
    q[:, 2] = offset + np.array([1e-2, 1e-3, 1e-4])
    q[:, [0, 1, 3, 4, 5]] = q[0, [0, 1, 3, 4, 5]]
    values = decisive(result.mechanism, q)
    assert values[0] / values[1] == pytest.approx(falls, rel=0.2)
    assert values[1] / values[2] == pytest.approx(falls, rel=0.2)
    texts = [cause.text for cause in family.causes]
    assert any("meet in a point" in text for text in texts)
    single(result, names[4], -0.4)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_gantry_loses_nothing_but_its_wrist(seed):
    """Three slides carry a spherical wrist: only the wrist is singular."""
    random = np.random.default_rng(seed)
    centre, middle = random.uniform(-0.4, 0.4, 3), direction(random)
    outer, offset = np.cross(middle, direction(random)), random.uniform(-2, 2)
    lines = [Line(tuple(direction(random)), kind="prismatic", limits=(-0.5, 0.7)) for _ in range(3)]
    lines += [Line(tuple(outer), tuple(centre)), Line(tuple(middle), tuple(centre), at=offset)]
    lines += [Line(tuple(outer), tuple(centre))]
    model, names = planned(lines, seed)
    result = found(model)
    certain(result)
    assert len(result.families) == 2
    for position in (offset, offset + PI):
        family = single(result, names[4], position)
        assert (family.name, family.kind) == ("wrist", "tangential")
        assert "coincide" in told(family, names[3], names[5])


@pytest.mark.parametrize("seed", SEEDS)
def test_a_slide_that_a_turn_makes_useless(seed):
    """Slide, turn, slide, all in a plane: where the slides are parallel one of them adds nothing."""
    random = np.random.default_rng(seed)
    turn = rotation_from(random)
    offset = random.uniform(-2, 2)
    lines = [
        Line(tuple(turn[:, 0]), kind="prismatic", limits=(-1, 1)),
        Line(tuple(turn[:, 2]), tuple(random.uniform(-1, 1, 3)), at=offset),
        Line(tuple(turn[:, 0]), kind="prismatic", limits=(-1, 1)),
    ]
    model, names = planned(lines, seed)
    result = ks.singular_find(model, "hand", starts=120)
    certain(result)
    assert result.mechanism.generic_rank == 3
    assert len(result.families) == 2
    for position in (offset, offset + PI):
        family = single(result, names[1], position)
        assert family.kind == "tangential"
        assert "parallel" in told(family, names[0], names[2])


def rotation_from(random):
    matrix = np.linalg.qr(random.normal(size=(3, 3)))[0]
    return matrix * np.sign(np.linalg.det(matrix))


@pytest.mark.parametrize("seed", SEEDS)
def test_a_telescope_of_two_links_that_a_mimic_joint_couples(seed):
    """Equal links, the second turned by minus twice the first: the hand runs along a line, x = 2 l cos t.

    Before it a turn about an axis that is square to the line, through the first joint. Singular where the hand is on
    that axis, t = +-90 degrees, and where it stands still, t = 0 and 180 degrees; t is told in the leader's angle.
    """
    random = np.random.default_rng(seed)
    turn, base, length = rotation_from(random), random.uniform(-0.3, 0.3, 3), 0.45
    x, y, z = turn.T
    offset = 0.35
    lines = [
        Line(tuple(y), tuple(base)),
        Line(tuple(z), tuple(base), at=offset),
        # It turns back by twice the leader's angle; the plan has it stretched where the leader is at `offset`.
        Line(tuple(z), tuple(base + length * x), at=0.2, mimic=(1, -2.0, 0.2 + 2 * offset)),
    ]
    model, names = planned(lines, seed, tip=tuple(base + 2 * length * x))
    result = ks.singular_find(model, "hand", starts=120)
    certain(result)
    assert result.mechanism.names == (names[0], names[1])
    assert result.mechanism.task.row_names == ("vx", "vy", "vz")
    assert len(result.families) == 4
    for position in (offset, offset + PI):
        assert single(result, names[1], position).kind == "fold"
    for position in (offset - PI / 2, offset + PI / 2):
        assert single(result, names[1], position).kind == "tangential"


@pytest.mark.parametrize("seed", SEEDS)
def test_a_palletiser_whose_hand_is_kept_level_by_followers(seed):
    """A turn, two links whose followers keep the hand level, a slide that helps: the elbow and the first axis."""
    random = np.random.default_rng(seed)
    base = random.uniform(-0.3, 0.3, 3)
    z, x, y = np.eye(3)[2], np.eye(3)[0], np.eye(3)[1]
    lines = [
        Line(tuple(z), tuple(base)),
        Line(tuple(y), tuple(base + 0.4 * z), at=0.3),
        Line(tuple(y), tuple(base + 0.4 * z), at=0.2, mimic=(1, -1.0, 0.5)),  # the second link's direction is its own
        Line(tuple(y), tuple(base + 0.4 * z + 0.5 * x), at=-0.6),
        Line(tuple(y), tuple(base + 0.4 * z + 0.5 * x), at=0.1, mimic=(3, -1.0, -0.5)),
    ]
    # The first link of the two is the one after joint 2, the second the one after joint 4.
    lines[2].point = tuple(base + 0.4 * z + 0.5 * x)
    lines[4].point = tuple(base + 0.4 * z + 0.9 * x)
    model, names = planned(lines, seed, tip=tuple(base + 0.4 * z + 1.0 * x))
    result = ks.singular_find(model, "hand", starts=120)
    assert result.mechanism.names == (names[0], names[1], names[3])
    certain(result)
    # Directions a and b of the links, by the leaders from the plan on: det ~ sin(b - a) (0.5 cos a + 0.4 cos b + 0.1).
    for family in result.families:
        a, b = family.witness[1] - 0.3, family.witness[2] + 0.6
        assert abs(math.sin(b - a) * (0.5 * math.cos(a) + 0.4 * math.cos(b) + 0.1)) < 1e-9
    surfaces = {(family.support, family.codimension) for family in result.families}
    assert surfaces == {((names[1], names[3]), 1)}


@pytest.mark.parametrize("seed", SEEDS)
def test_nothing_is_made_up(seed):
    """Six lines at random have a surface of singular configurations and no condition on a joint."""
    lines, _ = random_lines(seed, 6)
    model, _ = planned(lines, seed)
    result = found(model)
    certain(result)
    assert result.converged > 110
    assert all(family.implicit and family.codimension == 1 for family in result.families)
    assert [family.hits for family in result.families] == [result.converged]
    assert result.families[0].support == result.mechanism.names[1:-1]


def parallel_arm(seed, digits):
    """Return an arm with three parallel axes in a file that rounds angles, the middle joint and its position."""
    lines, random = random_lines(seed, 6)
    common, offset = direction(random), random.uniform(-2, 2)
    across = np.cross(common, direction(random))
    for i, along in zip((1, 2, 3), (0.0, 0.4, 0.9), strict=True):
        lines[i] = Line(tuple(common), tuple(along * across))
    lines[2].at = offset
    model, names = planned(lines, seed, digits=digits)
    return model, names[2], offset


@pytest.mark.parametrize("seed", SEEDS)
def test_angles_of_six_digits_are_singular_to_the_model_tolerance_and_exactly_nearby(seed):
    model, elbow, offset = parallel_arm(seed, 6)
    result = found(model)
    middle = result.mechanism.names.index(elbow)
    near = [f for f in result.families if elbow in f.positions and not f.implicit]
    assert len(near) == 2
    for family, expected in zip(near, sorted((offset, offset + PI), key=lambda x: x), strict=True):
        assert family.tolerance == "model"
        assert family.name == "elbow"
        assert min(near_angle(family.positions[elbow], e) for e in (expected, expected + PI)) < 1e-4
        assert decisive(result.mechanism, family.witness) < 1e-9  # exactly singular, close to the condition
        assert near_angle(family.witness[middle], family.positions[elbow]) < 1e-2
        at = family.witness.copy()
        at[middle] = family.positions[elbow]
        if decisive(result.mechanism, at) > 2e-9:
            answer = ks.singular_at(model, "hand", whole(result.mechanism, at))
            assert (answer.singular, answer.tolerance) == (True, "model")
            assert answer.conditions[0].positions.keys() == {elbow}
            assert decisive(result.mechanism, at) < 1e-5


@pytest.mark.parametrize("seed", SEEDS)
def test_angles_of_two_digits_are_another_arm(seed):
    """Far beyond any rounding: no condition on one joint is claimed."""
    model, _, _ = parallel_arm(seed, 2)
    result = found(model)
    certain(result)
    assert all(family.implicit and family.tolerance == "strict" for family in result.families)


def test_a_real_file_with_rounded_angles():
    """xArm 7 writes 1.5708: its conditions hold but for that, its witnesses hold exactly."""
    result = families("xarm7", "link_eef")
    rounded = [family for family in result.families if family.tolerance == "model" and not family.implicit]
    assert len(rounded) >= 4
    for family in rounded:
        assert decisive(result.mechanism, family.witness) < 1e-9
        q = result.mechanism.draw(np.random.default_rng(0), (50,))
        for joint, position in family.positions.items():
            q[:, result.mechanism.names.index(joint)] = position
        worst = float(np.max(decisive(result.mechanism, q)))
        assert 1e-9 < worst < 1e-5


def test_an_angle_that_drives_half_an_angle_repeats_after_two_turns():
    """A planar arm whose third joint follows by a half: roots a whole turn away are others, or none."""
    z = (0.0, 0.0, 1.0)
    lines = [
        Line(z),
        Line(z, (1.0, 0.0, 0.0), kind="revolute", limits=(-6.5, 6.5)),
        Line(z, (1.7, 0.0, 0.0), mimic=(1, 0.5, 0.3)),
    ]
    model, names = planned(lines, 1, tip=(2.1, 0.0, 0.0))
    result = ks.singular_find(model, "hand", axes="xy", starts=200)
    certain(result)
    t = np.linspace(-6.5, 6.5, 20001)
    signs = np.sign(np.linalg.det(pure(result.mechanism, np.stack([0 * t, t], -1))))
    expected = t[:-1][signs[:-1] != signs[1:]]
    found_at = sorted(family.positions[names[1]] for family in result.families)
    np.testing.assert_allclose(found_at, expected, atol=1e-3)


def test_a_nut_is_another_arm_a_turn_on():
    """A helical joint brings the tool to the first axis at one angle alone."""
    text = NUT.format(pitch=1.5)
    model = load_text(text)
    result = ks.singular_find(model, "d", starts=100)
    certain(result)
    assert [family.positions["nut"] for family in result.families] == [pytest.approx(-2 * PI / 1.5)]


NUT = """<robot name="nut"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
<joint name="yaw" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
<drake:joint name="nut" type="screw"><parent link="b"/><child link="c"/><axis xyz="1 0 0"/>
<drake:screw_thread_pitch value="{pitch}"/><limit lower="-9" upper="9" effort="1" velocity="1"/></drake:joint>
<joint name="end" type="fixed"><parent link="c"/><child link="d"/><origin xyz="1 0 0"/></joint></robot>"""
