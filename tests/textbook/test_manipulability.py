"""Manipulability through the real path: rows A3, A6, A7, A9 to A12 and A20, and the published numbers of theory B."""

import re

import numpy as np
import pytest

import kinetostat as ks
from textbook_support import angles, assert_same, command_line, textbook, vector_of
from trees import load_text

FIRST, SECOND = 1.0, 0.8
STRETCHED_TO_FOLDED = np.linspace(-np.pi, np.pi, 41)


def manipulability_of(name, q, frame="tool", **asked):
    """Return the certified manipulability of a frame of a textbook robot."""
    result = ks.manipulability(textbook(name), frame, np.asarray(q, dtype=float), **asked)
    assert result.certificate.engines == ("pinocchio", "screw")
    assert result.certificate.agree is True, result.certificate
    return result


def task_of(name, q, axes="x y", **asked):
    return manipulability_of(name, q, axes=axes, **asked).blocks["task"]


# --- A3, A6: the planar arm of two links -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "first", "second"),
    [("planar_2r", 1, 0.8), ("planar_2r_6_3", 6, 3), ("planar_2r_isotropic", np.sqrt(2), 1)],
)
def test_a3_yoshikawa_is_the_sine_of_the_elbow(name, first, second):
    q = angles(2, seed=201)
    expected = first * second * np.abs(np.sin(q[:, 1]))
    for asked in ({"axes": "x y"}, {"axes": "xy", "reference": "local"}, {"axes": "xyz"}):
        result = manipulability_of(name, q, **asked)
        assert_same(result.blocks["task"].yoshikawa, expected, 1e-12 * (first + second) ** 2)
        assert result.blocks["task"].unit == "m/rad"
        assert_same(result.blocks["translation"].yoshikawa, expected, 1e-12 * (first + second) ** 2)


def semi_axes(first, second, elbow):
    """Return the square roots of the eigenvalues of J^T J by its trace and determinant."""
    trace = first**2 + 2 * second**2 + 2 * first * second * np.cos(elbow)
    determinant = (first * second * np.sin(elbow)) ** 2
    root = np.sqrt(np.maximum(trace**2 / 4 - determinant, 0))
    return np.sqrt(trace / 2 + root), np.sqrt(np.maximum(determinant / (trace / 2 + root), 0))


@pytest.mark.parametrize(
    ("name", "first", "second"),
    [("planar_2r", 1, 0.8), ("planar_2r_6_3", 6, 3), ("planar_2r_isotropic", np.sqrt(2), 1)],
)
def test_a6_semi_axes_of_the_ellipse(name, first, second):
    elbow = np.linspace(-3.1, 3.1, 34)
    for waist in (0.0, 0.7, -2.5, np.pi):
        block = task_of(name, vector_of(waist, elbow))
        long, short = semi_axes(first, second, elbow)
        assert_same(block.velocity.lengths, vector_of(long, short), 1e-11 * (first + second))
        np.testing.assert_allclose(block.force.lengths, vector_of(1 / long, 1 / short), rtol=1e-9)
        assert (block.velocity.unit, block.force.unit) == ("m/rad", "N/Nm")
        assert_same(block.inverse_condition_number, short / long)


def test_a6_the_first_joint_turns_the_ellipse_and_changes_nothing_else():
    q = angles(2, seed=202)
    q = q[np.abs(np.sin(q[:, 1])) > 1e-3]
    here, there = task_of("planar_2r", q), task_of("planar_2r", q * [0, 1])
    for key in ("singular_values", "yoshikawa", "isotropy", "inverse_condition_number", "minimum_singular_value"):
        assert_same(getattr(here, key), getattr(there, key))
        if key in here.gradients:
            assert_same(here.gradients[key][:, 0], np.zeros(len(q)), 1e-9)
    for i, waist in enumerate(q[:, 0]):
        turn = np.array([[np.cos(waist), -np.sin(waist)], [np.sin(waist), np.cos(waist)]])
        assert_same(np.abs(np.sum(here.velocity.axes[i] * (turn @ there.velocity.axes[i]), axis=0)), np.ones(2))


def test_a6_a_circle_at_135_degrees_and_nowhere_else():
    elbow = np.radians([135, -135])
    for block in (task_of("planar_2r_isotropic", vector_of(waist, elbow)) for waist in (0.0, 1.2)):
        assert_same(block.velocity.lengths, np.ones((2, 2)))  # a circle of radius l2
        assert_same(block.isotropy, np.ones(2))
        assert_same(block.inverse_condition_number, np.ones(2), 1e-9)
    others = STRETCHED_TO_FOLDED[np.min(np.abs(STRETCHED_TO_FOLDED[:, None] - elbow), axis=1) > 0.05]
    assert np.all(task_of("planar_2r_isotropic", vector_of(0.3, others)).inverse_condition_number < 0.95)
    # Other ratios of lengths have no circle at all.
    assert np.all(task_of("planar_2r", vector_of(0.3, STRETCHED_TO_FOLDED)).inverse_condition_number < 0.99)
    assert np.all(task_of("planar_2r_6_3", vector_of(0.3, STRETCHED_TO_FOLDED)).inverse_condition_number < 0.99)


def test_a3_the_gradient_is_that_of_the_sine():
    q = angles(2, seed=203)
    q = q[np.sin(q[:, 1]) > 1e-3]
    expected = vector_of(0, FIRST * SECOND * np.cos(q[:, 1]))
    assert_same(task_of("planar_2r", q).gradients["yoshikawa"], expected, 1e-10)


def test_along_the_second_link_only_the_first_joint_moves_the_tool():
    """In the tip's frame J = [[l1 s2, 0], [l1 c2 + l2, l2]]: along x the second joint undoes what the first does."""
    elbow = np.array([0.4, 1.3, -2.0])
    line = manipulability_of("planar_2r", vector_of(0.9, elbow), reference="local", direction=(1, 0, 0)).transmission
    counter = (FIRST * np.cos(elbow) + SECOND) / SECOND  # rates (1, -counter) keep y
    assert_same(line.velocity, FIRST * np.abs(np.sin(elbow)) / np.hypot(1, counter))
    assert_same(line.force, 1 / (FIRST * np.abs(np.sin(elbow))))


def test_a4_rates_along_x_are_the_transmission_ratio():
    q = vector_of(np.array([0.3, -1.1, 2.0]), np.array([0.8, 1.9, -0.6]))
    both = np.cos(q.sum(-1)) / (FIRST * np.sin(q[:, 1]))
    other = -np.cos(q[:, 0]) / (SECOND * np.sin(q[:, 1])) - both
    line = manipulability_of("planar_2r", q, direction=(5, 0, 0)).transmission
    assert_same(line.velocity, 1 / np.hypot(both, other))


# --- A7 to A12 ---------------------------------------------------------------------------------------------------


def test_a7_three_links():
    stretched = manipulability_of("planar_3r", np.zeros(3), axes="x y rz")
    assert {name: int(block.rank) for name, block in stretched.blocks.items()} == {
        "full": 2,
        "translation": 1,
        "rotation": 1,
        "task": 2,
    }
    assert_same(stretched.blocks["translation"].velocity.lengths, np.array([np.sqrt(16 + 4 + 1), 0, 0]))
    # At (0, pi/2, 0) the linear rows are (-2, -2, -1) and (2, 0, 0).
    bent = manipulability_of("planar_3r", [0, np.pi / 2, 0])
    assert_same(bent.blocks["translation"].yoshikawa, np.array(0.0))  # of three joints and three rows: vz is lost
    assert_same(task_of("planar_3r", [0, np.pi / 2, 0]).yoshikawa, np.sqrt(4**2 + 2**2))
    assert_same(bent.blocks["rotation"].singular_values, np.array([np.sqrt(3), 0, 0]))


def test_a9_the_wrist_moves_as_the_sine_of_its_second_angle():
    q = angles(3, seed=204)
    block = manipulability_of("wrist_zyz", q).blocks["rotation"]
    assert_same(block.yoshikawa, np.abs(np.sin(q[:, 1])))
    # Of axes z, y and one that leans by q2: 1, and 1 +- cos q2.
    expected = np.sort(np.sqrt(vector_of(1, 1 + np.cos(q[:, 1]), 1 - np.cos(q[:, 1]))))[:, ::-1]
    assert_same(block.singular_values, expected, 1e-7)
    assert np.array_equal(block.rank, np.where(np.abs(np.sin(q[:, 1])) < 1e-9, 2, 3))
    assert block.unit == "1"


def test_a10_the_three_roll_wrist():
    q = angles(3, seed=205)
    assert_same(manipulability_of("wrist_three_roll", q).blocks["rotation"].yoshikawa, 0.75 * np.abs(np.sin(q[:, 1])))


@pytest.mark.parametrize(
    ("name", "offset", "upper", "fore"), [("anthropomorphic", 0, 0.5, 0.4), ("torus_3r", 1.0, 0.5, 0.3)]
)
def test_a11_a12_the_position_of_three_joints_in_space(name, offset, upper, fore):
    q = angles(3, seed=206)
    out = offset + upper * np.cos(q[:, 1]) + fore * np.cos(q[:, 1] + q[:, 2])
    block = manipulability_of(name, q).blocks["translation"]
    assert_same(block.yoshikawa, upper * fore * np.abs(np.sin(q[:, 2]) * out))
    regular = block.yoshikawa > 1e-3
    assert np.all(block.rank[regular] == 3)
    assert np.all(block.rank[block.yoshikawa < 1e-14] < 3)


# --- theory B ----------------------------------------------------------------------------------------------------


def test_puma_numbers():
    nominal = [0, np.pi / 4, np.pi, 0, np.pi / 4, 0]
    blocks = manipulability_of("puma560", nominal).blocks
    assert_same(blocks["full"].yoshikawa, 0.0786172, 6e-8)
    assert_same(blocks["translation"].yoshikawa, 0.1111815, 6e-8)
    assert_same(blocks["rotation"].yoshikawa, 2.4494897, 6e-8)
    assert [block.rank for block in blocks.values()] == [6, 3, 3]


def test_puma_full_volume_is_its_determinant_in_any_unit():
    q = angles(6, seed=207, count=50)
    s23, c23 = np.sin(q[:, 1] + q[:, 2]), np.cos(q[:, 1] + q[:, 2])
    elbow = 0.0203 * np.sin(q[:, 2]) + 0.4318 * np.cos(q[:, 2])
    shoulder = 0.4318 * np.cos(q[:, 1]) + 0.0203 * c23 - 0.4318 * s23
    expected = 0.4318 * np.abs(np.sin(q[:, 4]) * elbow * shoulder)
    assert_same(manipulability_of("puma560", q).blocks["full"].yoshikawa, expected)
    scaled = manipulability_of("puma560", q, length=0.2).blocks["full"].yoshikawa
    np.testing.assert_allclose(scaled, expected / 0.2**3, rtol=1e-9)


def stanford(seed):
    q = angles(6, seed=seed, count=40)
    q[:, 2] = np.random.default_rng(seed).uniform(0.3048, 1.27, 40)
    return q


def test_stanford_volume_and_the_slide_as_an_angle():
    """A slide counts as an angle q / L: three linear rows over L, one column times L."""
    q = stanford(208)
    expected = q[:, 2] ** 2 * np.abs(np.sin(q[:, 1]) * np.sin(q[:, 4]))
    assert_same(manipulability_of("stanford", q).blocks["full"].yoshikawa, expected)
    scaled = manipulability_of("stanford", q, length=0.25).blocks["full"]
    np.testing.assert_allclose(scaled.yoshikawa, expected / 0.25**2, rtol=1e-9)
    assert scaled.unit == "1"


def test_stanford_gradient_vanishes_with_the_squared_factor():
    q = stanford(209)
    gradient = manipulability_of("stanford", q).blocks["full"].gradients["yoshikawa"]
    product = np.sin(q[:, 1]) * np.sin(q[:, 4])
    assert_same(gradient[:, 2], 2 * q[:, 2] * np.abs(product), 1e-9)
    assert_same(gradient[:, 1], q[:, 2] ** 2 * np.cos(q[:, 1]) * np.sin(q[:, 4]) * np.sign(product), 1e-9)
    assert_same(gradient[:, [0, 3, 5]], np.zeros((40, 3)), 1e-9)


def test_scara_has_rank_four_and_three():
    for elbow, rank in ((0.0, 3), (0.9, 4), (np.pi, 3)):
        result = manipulability_of("scara", [0.4, elbow, 0.1, 0.7], axes="xyz rz")
        assert result.blocks["full"].rank == result.blocks["task"].rank == rank
        # With the turn about z decoupled and z moved by the slide alone, l1 l2 |s2| is left.
        assert_same(result.blocks["task"].yoshikawa, 0.4 * 0.3 * abs(np.sin(elbow)))


RADIUS = 0.5  # of the circle through the axes of the isotropic arm
ISOTROPIC = np.array([0.0, 2 * np.pi / 3, 5 * np.pi / 6])


@pytest.mark.parametrize("length", [RADIUS / np.sqrt(2), "auto"])
def test_isotropic_3r(length):
    for waist in (0.0, 1.0, -2.2):
        result = manipulability_of("isotropic_3r", np.add(ISOTROPIC, [waist, 0, 0]), axes="x y rz", length=length)
        block = result.blocks["task"]
        assert_same(result.length, RADIUS / np.sqrt(2))
        assert_same(block.singular_values, np.full(3, np.sqrt(3)))
        assert_same(block.isotropy, np.float64(1.0))
        assert_same(block.inverse_condition_number, np.float64(1.0))
        assert block.unit == "1"
        assert block.rank == 3
    # With metres, or another length, it is not.
    for other in ("none", RADIUS):
        block = task_of("isotropic_3r", ISOTROPIC, axes="x y rz", length=other)
        assert block.inverse_condition_number < 0.8


# --- UR5, and A20: the unit trap ---------------------------------------------------------------------------------


def ur5_in(unit):
    """Return the UR5 with its lengths told in another unit: numbers of the file's origins over so many metres."""
    text = ks.load("example:ur5_robot").loaded.text

    def told(found):
        return f'{found[1]}{" ".join(repr(float(word) / unit) for word in found[2].split())}"'

    return load_text(re.sub(r'(<origin\b[^>]*?\bxyz=")([^"]*)"', told, text))


def test_ur5_volume_is_its_three_factors():
    model = ks.load("example:ur5_robot")
    q = angles(6, seed=210, count=60)
    result = ks.manipulability(model, "tool0", q)
    assert result.certificate.agree is True
    both, three = q[:, 1] + q[:, 2], q[:, 1] + q[:, 2] + q[:, 3]
    shoulder = 0.425 * np.cos(q[:, 1]) + 0.39225 * np.cos(both) - 0.09465 * np.sin(three)
    expected = 0.425 * 0.39225 * np.abs(np.sin(q[:, 2]) * np.sin(q[:, 4]) * shoulder)
    assert_same(result.blocks["full"].yoshikawa, expected, 1e-6)  # the file rounds pi


def test_a20_the_unit_trap():
    metres, millimetres = ks.load("example:ur5_robot"), ur5_in(0.001)
    q = np.array([[0.1, -1.0, 1.2, 0.3, 0.5, 0.0], [0.0, -np.pi / 4, np.pi / 2, 0.4, 1.2, 0.0], [0.0] * 6])
    here, there = (ks.manipulability(model, "tool0", q) for model in (metres, millimetres))
    np.testing.assert_allclose(
        there.blocks["translation"].singular_values, 1000 * here.blocks["translation"].singular_values, atol=1e-9
    )
    small, large = (1 / each.blocks["full"].inverse_condition_number[:2] for each in (here, there))
    assert np.all((small > 5) & (small < 30))
    assert np.all(large > 50 * small)  # the same arm at the same pose
    for name, block in here.blocks.items():  # what has no unit
        assert np.array_equal(block.rank, there.blocks[name].rank)
    assert list(here.blocks["full"].rank) == [6, 6, 5]
    for result in (here, there):
        assert any("depend on the unit of length" in warning for warning in result.warnings)
    # A length of the arm's own makes one of both.
    here, there = (ks.manipulability(model, "tool0", q, length="auto") for model in (metres, millimetres))
    np.testing.assert_allclose(there.length, 1000 * here.length, rtol=1e-12)
    for name in ("singular_values", "isotropy", "inverse_condition_number", "yoshikawa"):
        assert_same(getattr(there.blocks["full"], name), getattr(here.blocks["full"], name), 1e-10)
    assert here.warnings == there.warnings
    assert [warning[:16] for warning in here.warnings] == ["singular: rank 5"]


# --- through the command line ------------------------------------------------------------------------------------


def asked(*words):
    return command_line("manipulability", *words)["result"]


def test_a3_as_a_user_asks():
    result = asked("textbook:planar_2r", "-q", "30,60", "--deg", "--axes", "x", "y", "--length", "1")
    task = result["blocks"]["task"]
    assert task["yoshikawa"] == pytest.approx(0.8 * np.sqrt(3) / 2, abs=1e-14)
    assert task["rows"] == ["vx", "vy"]
    assert (task["task_dimension"], task["rank"], task["unit"]) == (2, 2, "m/rad")
    long, short = semi_axes(FIRST, SECOND, np.pi / 3)
    assert task["ellipsoid"]["velocity"]["lengths"] == pytest.approx([long, short], abs=1e-14)
    assert task["ellipsoid"]["force"]["lengths"] == pytest.approx([1 / long, 1 / short], abs=1e-13)
    assert task["gradient"]["yoshikawa"] == pytest.approx([0, 0.4], abs=1e-13)
    assert result["columns"] == ["joint1", "joint2"]


def test_a6_circle_as_a_user_asks():
    result = asked("textbook:planar_2r_isotropic", "-q", "joint2=135", "--deg", "--axes", "xy", "--length", "auto")
    assert result["blocks"]["task"]["singular_values"] == pytest.approx([1, 1], abs=1e-14)
    assert result["blocks"]["task"]["isotropy"] == pytest.approx(1, abs=1e-14)


def test_puma_as_a_user_asks():
    result = asked("textbook:puma560", "-q", "0,45,180,0,45,0", "--deg", "--length", "1")  # a metre: metres as they are
    numbers = {name: block["yoshikawa"] for name, block in result["blocks"].items()}
    assert numbers == pytest.approx({"full": 0.0786172, "translation": 0.1111815, "rotation": 2.4494897}, abs=6e-8)


def test_isotropic_3r_as_a_user_asks():
    arm = ("textbook:isotropic_3r", "-q", "20,120,150", "--deg")
    for length in ("auto", str(RADIUS / np.sqrt(2))):
        result = asked(*arm, "--length", length, "--axes", "x", "y", "rz")
        assert result["characteristic_length"] == pytest.approx(RADIUS / np.sqrt(2), abs=1e-14)
        assert result["blocks"]["task"]["singular_values"] == pytest.approx([np.sqrt(3)] * 3, abs=1e-14)
