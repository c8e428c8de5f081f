"""Laws of manipulability: over random trees, real robots and singular poses, by ways other than its own."""

from functools import cache
from itertools import combinations
from math import prod
from xml.sax.saxutils import quoteattr

import numpy as np
import pytest

import kinetostat as ks
from differences import derivative, moved
from kinetostat.urdf.description import JointType
from textbook_support import assert_same
from trees import load_text, random_tree

INDICES = ("yoshikawa", "minimum_singular_value", "inverse_condition_number", "isotropy")
SEEDS = range(20)
REAL = (
    "ur5_robot",
    "panda",
    "kinova",
    "so101",
    "allegro_left_hand",
    "solo12",
    "tiago",
    "talos_left_arm",
    "double_pendulum_continuous",
    "xarm7",
)
TEXTBOOK = ("planar_1r", "planar_2r", "planar_3r", "skew_1p", "rp", "pr", "helical", "scara", "stanford", "puma560")


@cache
def asked_of(source):
    """Return a robot, the tip that most joints move, and its velocity coordinates in path order."""
    model = random_tree(source) if isinstance(source, int) else ks.load(source)
    robot = model.robot
    tip = max(robot.tips, key=lambda link: len(robot.movable_path(robot.root, link)))
    slices = [robot.velocity_slices[joint.name] for joint in robot.movable_path(robot.root, tip)]
    return model, tip, [i for part in slices for i in range(part.start, part.stop)]


def case(source, shape=(), seed=0):
    """Return a robot, a tip, its columns and random configurations."""
    model, tip, columns = asked_of(source)
    return model, tip, columns, ks.random_configurations(model.robot, seed, shape)


TREES = tuple(seed for seed in SEEDS if asked_of(seed)[2])
ALL = (*TREES, *(f"example:{name}" for name in REAL), *(f"textbook:{name}" for name in TEXTBOOK))
FEW_COLUMNS = tuple(source for source in ALL if len(asked_of(source)[2]) <= 9)
MANY_ROWS = tuple(source for source in ALL if len(asked_of(source)[2]) < 3)
MANY_JOINTS = tuple(source for source in ALL if len(asked_of(source)[2]) > 6)


def matrix_at(model, tip, q, rows=range(6), **asked):
    """Return rows of the Jacobian, which has tests of its own."""
    return ks.jacobian(model, tip, q, **asked).matrix[..., list(rows), :]


def told_in(robot, unit):
    """Return the robot's URDF with lengths in another unit of so many metres: a smaller unit, larger numbers."""

    def size(joint):
        return 1 / unit if joint.type is JointType.PRISMATIC else 1.0

    lines = [f"<link name={quoteattr(link.name)}/>" for link in robot.links]
    for joint in robot.joints:
        tag = "drake:joint" if joint.type is JointType.SCREW else "joint"
        origin, quaternion = joint.origin, joint.origin.quaternion_xyzw
        turn = ("quat_xyzw", quaternion) if quaternion else ("rpy", origin.rpy)
        parts = [
            f"<parent link={quoteattr(joint.parent)}/><child link={quoteattr(joint.child)}/>",
            f'<origin xyz="{words(c / unit for c in origin.xyz)}" {turn[0]}="{words(turn[1])}"/>',
            f'<axis xyz="{words(joint.axis)}"/>',
        ]
        if joint.type is JointType.SCREW:
            parts.append(f'<drake:screw_thread_pitch value="{joint.pitch / unit!r}"/>')
        limits = ((end, getattr(joint.limit, end)) for end in ("lower", "upper", "velocity"))
        written = " ".join(f'{name}="{value * size(joint)!r}"' for name, value in limits if value is not None)
        parts.append(f'<limit effort="1" {written}/>')
        if joint.mimic is not None:
            law, leader = joint.mimic, robot.joint_by_name[joint.mimic.joint]
            factor, offset = law.multiplier * size(joint) / size(leader), law.offset * size(joint)
            parts.append(f'<mimic joint={quoteattr(law.joint)} multiplier="{factor!r}" offset="{offset!r}"/>')
        lines.append(f'<{tag} name={quoteattr(joint.name)} type="{joint.type}">{"".join(parts)}</{tag}>')
    return "\n".join(['<robot name="told" version="1.1">', *lines, "</robot>"])


def words(numbers):
    return " ".join(repr(float(number)) for number in numbers)


def positions_in(robot, q, unit):
    """Return a configuration with its lengths in another unit."""
    told = np.array(q)
    for joint in robot.independent:
        lengths = {JointType.PRISMATIC: 1, JointType.PLANAR: 2, JointType.FLOATING: 3}.get(joint.type, 0)
        start = robot.position_slices[joint.name].start
        told[..., start : start + lengths] /= unit
    return told


# --- indices -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("source", ALL, ids=str)
def test_yoshikawa_is_the_root_of_the_sum_of_the_squared_minors(source):
    """Cauchy and Binet: det(J J^T) is the sum of squared minors, and so is det(J^T J) where rows are more."""
    model, tip, columns, q = case(source, (2,))
    result = ks.manipulability(model, tip, q, axes="x z ry")
    assert list(result.blocks) == ["full", "translation", "rotation", "task"]
    for block in result.blocks.values():
        matrix = matrix_at(model, tip, q, block.task.rows)
        m, n = len(block.task.rows), len(columns)
        k = min(m, n)
        if prod(range(n, n - k, -1)) > 10**5:  # a hand of many joints has too many minors
            continue
        chosen = combinations(range(n), k) if m <= n else combinations(range(m), k)
        minors = [np.linalg.det(matrix[..., :, list(c)] if m <= n else matrix[..., list(c), :]) for c in chosen]
        scale = np.maximum(1, np.linalg.norm(matrix, axis=(-2, -1))) ** k
        assert np.all(np.abs(block.yoshikawa - np.linalg.norm(minors, axis=0)) < 1e-9 * scale)


@pytest.mark.parametrize("source", ALL, ids=str)
def test_indices_are_within_their_bounds_and_of_one_another(source):
    model, tip, columns, q = case(source, (3,), seed=1)
    for block in ks.manipulability(model, tip, q, axes="xyz rz").blocks.values():
        values, k = block.singular_values, min(block.task_dimension, len(columns))
        assert values.shape == (3, k)
        assert np.all(np.diff(values, axis=-1) <= 0)
        assert np.all(values >= 0)
        assert np.array_equal(block.minimum_singular_value, values[..., -1])
        for index in (block.isotropy, block.inverse_condition_number):
            assert np.all((index >= 0) & (index <= 1 + 1e-14))
        assert np.all((block.rank >= 0) & (block.rank <= k))
        # The geometric mean is at most the arithmetic one, and both lie between the extremes.
        assert np.all(block.isotropy >= block.inverse_condition_number**2 - 1e-14)
        # The largest is the operator's norm: no unit rate moves faster; Frobenius' norm is all of them.
        matrix = matrix_at(model, tip, q, block.task.rows)
        assert_same((values**2).sum(-1), (matrix**2).sum((-2, -1)), 1e-9 * (1 + np.max(values) ** 2))


def test_of_one_joint_all_is_said_by_the_length_of_its_column():
    model, tip, _, q = case("textbook:planar_1r", (4,))
    result = ks.manipulability(model, tip, q, length=0.3)
    for name, speed in (("translation", 0.9), ("rotation", 1.0), ("full", np.hypot(0.9 / 0.3, 1.0))):
        block = result.blocks[name]
        assert_same(block.singular_values, np.full((4, 1), speed))
        for key, expected in (("yoshikawa", speed), ("inverse_condition_number", 1), ("isotropy", 1), ("rank", 1)):
            assert_same(getattr(block, key), np.full(4, expected))
        for gradient in block.gradients.values():
            assert_same(gradient, np.zeros((4, 1)))


@pytest.mark.parametrize("source", ["example:ur5_robot", "example:panda", "textbook:puma560", "textbook:stanford"])
def test_the_volume_of_all_six_rows_belongs_to_no_point_and_no_frame(source):
    """A 6x6 frame change has determinant one."""
    model, tip, _, q = case(source, (5,))
    alike = (
        {},
        {"reference": "local"},
        {"reference": "world"},
        {"point": (0.3, -2.0, 0.7)},
        {"expressed_in": tip, "point": (-1.0, 0.2, 0.0)},
    )
    volumes = [ks.manipulability(model, tip, q, **asked).blocks["full"].yoshikawa for asked in alike]
    for volume in volumes[1:]:
        np.testing.assert_allclose(volume, volumes[0], rtol=1e-10)
    other = ks.manipulability(model, tip, q, point=(0.3, -2.0, 0.7)).blocks["full"]
    assert np.all(np.abs(other.minimum_singular_value / other.singular_values[..., 0]) > 0)
    assert not np.allclose(other.isotropy, ks.manipulability(model, tip, q).blocks["full"].isotropy, rtol=1e-3)


@pytest.mark.parametrize("source", ALL, ids=str)
def test_the_certificate_agrees(source):
    model, tip, _, q = case(source, (4,), seed=2)
    certificate = ks.manipulability(model, tip, q, length=1.0, axes="x rx").certificate
    assert certificate.engines == ("pinocchio", "screw")
    assert certificate.agree is True
    assert certificate.max_difference < certificate.tolerance


@pytest.mark.parametrize("multiplier", [1e-3, 1.0, -20.0, 1e3, 1e5])
def test_the_certificate_agrees_where_followers_are_geared(multiplier):
    """Derivatives of a geared joint grow with the square of its gear."""
    model = load_text(
        f"""<robot name="geared"><link name="a"/><link name="b"/><link name="c"/><link name="tip"/>
        <joint name="lead" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0.3 0.2 1"/></joint>
        <joint name="fast" type="continuous"><parent link="b"/><child link="c"/><origin xyz="0.7 0.3 0.1"/>
          <axis xyz="0.1 0.2 1"/><mimic joint="lead" multiplier="{multiplier}"/></joint>
        <joint name="last" type="continuous"><parent link="c"/><child link="tip"/><origin xyz="0.6 0.2 0.3"/>
          <axis xyz="0.1 1 0.4"/><mimic joint="lead" multiplier="{multiplier}"/></joint></robot>"""
    )
    q = ks.random_configurations(model.robot, 3, (20,))
    certificate = ks.manipulability(model, "tip", q, point=(0.3, 0.2, 0.5)).certificate
    assert certificate.agree is True, certificate


def test_no_configuration_gives_no_index():
    model, tip, columns, q = case("example:panda", (2, 0))
    result = ks.manipulability(model, tip, q, length="auto", direction=(0, 0, 1))
    assert result.blocks["full"].yoshikawa.shape == (2, 0)
    assert result.blocks["full"].gradients["yoshikawa"].shape == (2, 0, len(columns))


# --- units -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("source", ALL, ids=str)
@pytest.mark.parametrize("unit", [0.001, 0.4])
def test_a_characteristic_length_is_a_unit_of_length(source, unit):
    """What `length` makes of a robot in metres is what the robot is, told in that unit. Slides are told in it too."""
    model, tip, _, q = case(source, (2,), seed=3)
    ours = ks.manipulability(model, tip, q, length=unit, axes="xy rz")
    told = load_text(told_in(model.robot, unit))
    theirs = ks.manipulability(told, tip, positions_in(model.robot, q, unit), axes="xy rz")
    turning = np.array(ours.column_units) == "rad/s"
    for name, block in ours.blocks.items():
        other = theirs.blocks[name]
        if block.task.mixed or len(set(turning)) > 1:
            tiny = 1e-11 * max(1.0, float(np.max(other.singular_values)))
            assert_same(block.singular_values, other.singular_values * (unit if block.unit == "m/rad" else 1), tiny)
        assert np.array_equal(block.rank, other.rank)


@pytest.mark.parametrize("source", ALL, ids=str)
@pytest.mark.parametrize("unit", [1e-5, 0.0254, 1e3])
def test_the_unit_of_length_changes_no_rank_and_no_scaled_number(source, unit):
    model, tip, _, q = case(source, (3,), seed=4)
    told, at = load_text(told_in(model.robot, unit)), positions_in(model.robot, q, unit)
    ours, theirs = ks.manipulability(model, tip, q), ks.manipulability(told, tip, at)
    for name, block in ours.blocks.items():
        assert np.array_equal(block.rank, theirs.blocks[name].rank)
    if "rad/s" not in ours.column_units:
        return
    try:
        ours = ks.manipulability(model, tip, q, length="auto")
    except ks.UsageError:  # every axis through the point
        return
    if np.min(ours.length) < 1e-6:
        return
    theirs = ks.manipulability(told, tip, at, length="auto")
    np.testing.assert_allclose(theirs.length * unit, ours.length, rtol=1e-8)
    for key in ("singular_values", *INDICES[1:3]):
        expected = getattr(ours.blocks["full"], key)
        assert_same(getattr(theirs.blocks["full"], key), expected, 1e-8 * (1 + np.max(expected)))


UNITS = {  # of singular values: rows over columns
    "textbook:planar_2r": ({"full": "mixed", "translation": "m/rad", "rotation": "1"}, "m/s"),
    "textbook:stanford": ({"full": "mixed", "translation": "mixed", "rotation": "1"}, "m/s"),
    "textbook:skew_1p": ({"full": "mixed", "translation": "1", "rotation": "rad/m"}, "m/s"),
}


@pytest.mark.parametrize("source", UNITS)
def test_units_of_singular_values(source):
    model, tip, _, q = case(source)
    expected, weighted = UNITS[source]
    found = ks.manipulability(model, tip, q)
    assert {name: block.unit for name, block in found.blocks.items()} == expected
    assert ks.manipulability(model, tip, q, weights="limits").blocks["translation"].unit == weighted
    scaled = ks.manipulability(model, tip, q, length=0.5)
    assert scaled.blocks["full"].unit == "1"
    assert scaled.blocks["rotation"].unit == expected["rotation"]  # nothing in it is scaled


def test_a_length_that_changes_no_number_changes_no_unit():
    model, tip, _, q = case("textbook:skew_1p")
    block = ks.manipulability(model, tip, q, length=0.5).blocks["translation"]
    # A metre for a metre; or half a metre for a slide of half a metre, if that is called a radian.
    assert (float(block.singular_values[0]), block.unit) in ((1.0, "1"), (0.5, "m/rad"))
    for source in ("textbook:planar_2r", "textbook:stanford"):
        model, tip, _, q = case(source)
        assert ks.manipulability(model, tip, q, length=0.5).blocks["translation"].unit == "m/rad"


def test_the_mixture_of_units_is_warned_of_where_it_is():
    model, tip, _, q = case("textbook:planar_2r")
    (warning,) = ks.manipulability(model, tip, q).warnings
    assert "m and rad are mixed" in warning
    assert "--length auto" in warning
    assert ks.manipulability(model, tip, q, length="auto").warnings == ()
    assert ks.manipulability(model, tip, q, length=2.0).warnings == ()


def test_how_the_length_was_found_is_said():
    model, tip, _, q = case("textbook:planar_2r")
    assert ks.manipulability(model, tip, q).length is None
    assert ks.manipulability(model, tip, q, length=0.5).length_reference == "given"
    assert "all rows" in ks.manipulability(model, tip, q, length="auto", axes="xyz").length_reference
    assert "vx vy wz" in ks.manipulability(model, tip, q, length="auto", axes="x y rz").length_reference


@pytest.mark.parametrize("length", [0, -1.0, float("nan"), float("inf"), "long", None, [1, 2]])
def test_a_length_that_cannot_be_is_refused(length):
    model, tip, _, q = case("textbook:planar_2r")
    with pytest.raises(ks.UsageError, match="--length is auto, none, or between"):
        ks.manipulability(model, tip, q, length=length)


def test_without_a_characteristic_length_auto_is_refused():
    model, tip, _, q = case("textbook:skew_1p")
    with pytest.raises(ks.UsageError, match="no joint turns"):
        ks.manipulability(model, tip, q, length="auto")
    wrist, tip, _, _ = case("textbook:wrist_zyz")
    for q in ([0.0, 0, 0], [0.3, 0.4, 0.5]):  # its centre, on every axis but for rounding
        with pytest.raises(ks.UsageError, match="every axis passes through the point"):
            ks.manipulability(wrist, tip, np.array(q), point=(0, 0, -0.12), length="auto")


def test_a_frame_that_no_joint_moves_has_no_manipulability():
    model, _, _, q = case("example:panda")
    with pytest.raises(ks.UsageError, match="no joint moves 'panda_link0'"):
        ks.manipulability(model, "panda_link0", q)


# --- ellipsoids ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("source", ALL, ids=str)
def test_unit_joint_rates_fill_the_velocity_ellipsoid_and_nothing_else(source):
    model, tip, columns, q = case(source, seed=5)
    rates = np.random.default_rng(6).normal(size=(len(columns), 400))
    rates /= np.linalg.norm(rates, axis=0)
    for block in ks.manipulability(model, tip, q, axes="x y").blocks.values():
        shape, matrix = block.velocity, matrix_at(model, tip, q, block.task.rows)
        m = len(block.task.rows)
        assert (shape.axes.shape, shape.lengths.shape) == ((m, m), (m,))
        assert_same(shape.axes.T @ shape.axes, np.eye(m))
        coordinates, tiny = shape.axes.T @ matrix @ rates, 1e-9 * max(1e-3, shape.lengths[0])
        flat = shape.lengths < tiny
        assert np.all(np.abs(coordinates[flat]) < 2 * tiny)
        inside = np.sum((coordinates[~flat] / shape.lengths[~flat, None]) ** 2, axis=0)
        assert np.all(inside < 1 + 1e-9)
        if np.sum(~flat) == len(columns):  # as many axes as joints: unit rates give its surface
            assert_same(inside, np.ones(400), 1e-6)
        # How far it reaches in a direction is how fast the best unit rate moves there.
        for direction in np.random.default_rng(7).normal(size=(5, m)):
            reach = np.linalg.norm(shape.lengths * (shape.axes.T @ direction))
            assert abs(reach - np.linalg.norm(matrix.T @ direction)) < 1e-10 * (1 + reach)


@pytest.mark.parametrize("source", ALL, ids=str)
def test_the_force_ellipsoid_holds_what_unit_torques_hold_and_is_the_dual(source):
    model, tip, columns, q = case(source, seed=8)
    for block in ks.manipulability(model, tip, q, axes="y z").blocks.values():
        velocity, force, matrix = block.velocity, block.force, matrix_at(model, tip, q, block.task.rows)
        assert_same(force.axes, velocity.axes)
        free = np.isinf(force.lengths)
        largest = max(velocity.lengths[0], 1e-300)
        assert_same(matrix.T @ force.axes[:, free], np.zeros((len(columns), free.sum())), 1e-8 * max(largest, 1))
        ends = matrix.T @ (force.axes[:, ~free] * force.lengths[~free])
        np.testing.assert_allclose(np.linalg.norm(ends, axis=0), 1, rtol=1e-6)  # torques of norm one
        np.testing.assert_allclose(force.lengths[~free] * velocity.lengths[~free], 1, rtol=1e-12)
        # Polar duals: unit torques and unit rates do no more than unit power.
        ball = np.random.default_rng(9).normal(size=(2, len(velocity.lengths), 50))
        ball /= np.linalg.norm(ball, axis=1, keepdims=True)
        moves = velocity.axes @ (velocity.lengths[:, None] * ball[0])
        holds = force.axes @ (np.where(free, 1e3, force.lengths)[:, None] * ball[1])  # infinite: as large as you like
        assert np.max(moves.T @ holds) < 1 + 1e-6 * (1 + largest)


def test_what_unit_rates_cannot_move_needs_no_torque():
    model, tip, _, _ = case("textbook:planar_2r")
    block = ks.manipulability(model, tip, np.array([0.3, 0.9])).blocks["translation"]
    assert_same(np.abs(block.velocity.axes[:, 2]), np.array([0.0, 0, 1]))
    assert (block.velocity.lengths[2], block.force.lengths[2]) == (0, np.inf)
    assert (block.velocity.unit, block.force.unit) == ("m/rad", "N/Nm")


@pytest.mark.parametrize("source", ALL, ids=str)
def test_other_axes_turn_the_ellipsoids_and_change_no_index(source):
    model, tip, _, q = case(source, seed=10)
    plain = ks.manipulability(model, tip, q)
    for name in (tip, model.robot.links[len(model.robot.links) // 2].name):
        turned = ks.manipulability(model, tip, q, expressed_in=name)
        rotation = ks.fk(model, name, q).matrix[:3, :3]
        for key, block in plain.blocks.items():
            other, tiny = turned.blocks[key], 1e-10 * (1 + block.singular_values[0])
            assert block.rank == other.rank
            for index in ("singular_values", "yoshikawa", "minimum_singular_value", "inverse_condition_number"):
                here, there = getattr(block, index), getattr(other, index)
                assert np.all(np.abs(here - there) < tiny * np.maximum(1, block.singular_values[0]) ** 5)
            if key == "full":
                continue
            spread = [
                (e.velocity.axes * e.velocity.lengths**2) @ e.velocity.axes.T  # does not tell equal axes apart
                for e in (block, other)
            ]
            assert_same(rotation @ spread[1] @ rotation.T, spread[0], tiny * (1 + block.singular_values[0]))


def test_the_sign_of_an_axis_does_not_hang_on_rounding():
    model, tip, _, q = case("example:panda", (200,))
    for block in ks.manipulability(model, tip, q).blocks.values():
        largest = np.take_along_axis(
            block.velocity.axes, np.argmax(np.abs(block.velocity.axes), axis=-2)[..., None, :], axis=-2
        )
        assert np.all(largest > 0)


# --- gradients -----------------------------------------------------------------------------------------------------

STEP = 2e-4


def indices_along(model, tip, columns, q, asked):
    """Return central differences of every index of every block: (n, blocks, indices)."""
    units = np.eye(model.robot.nv)[columns]

    def curve(times):
        path = np.stack([moved(model.robot, q, unit, times) for unit in units], 1)  # (k, n, nq)
        blocks = ks.manipulability(model, tip, path, **asked).blocks.values()
        return np.stack([indices(block) for block in blocks], 2)

    def indices(block):
        found = [getattr(block, key) for key in INDICES]
        return np.stack([*found, found[0] if block.penalised is None else block.penalised], -1)

    return derivative(curve, STEP)


def assert_gradients(model, tip, columns, q, **asked):
    """Compare with differences wherever an index is smooth nearby; return how many indices of blocks were compared."""
    result = ks.manipulability(model, tip, q, **asked)
    slopes, compared = indices_along(model, tip, columns, q, asked), 0
    for i, block in enumerate(result.blocks.values()):
        values, k = block.singular_values, block.singular_values.shape[-1]
        smooth, apart = values[-1] > 0.02 * values[0], True
        if k > 1:
            apart = min(values[-2] - values[-1], values[0] - values[1]) > 0.02 * values[0]
        for j, key in enumerate((*INDICES, "penalised")):
            if key not in block.gradients or not smooth or (key in INDICES[1:3] and not apart):
                continue
            gradient = block.gradients[key]
            scale = max(1.0, float(np.max(np.abs(gradient))), float(block.yoshikawa), float(values[0]))
            assert gradient.shape == (len(columns),)
            assert_same(gradient, slopes[:, i, j], 3e-8 * scale)
            compared += 1
    return compared


OPTIONS = (
    {},
    {"length": 0.3},
    {"reference": "local", "axes": "x ry"},
    {"reference": "world", "length": 2.0, "axes": "xyz rz"},
    {"point": (0.2, -0.4, 0.1), "axes": "x y z ry rz", "length": 0.7},
)


@pytest.mark.parametrize("options", OPTIONS, ids=str)
def test_gradients_are_central_differences(options):
    compared = {}
    for source in FEW_COLUMNS[OPTIONS.index(options) % 3 :: 3]:
        model, tip, columns, q = case(source, seed=11)
        compared[source] = assert_gradients(model, tip, columns, q, **options)
    assert sum(count > 0 for count in compared.values()) > 0.6 * len(compared), compared


def test_gradients_with_weights_as_given():
    for source in FEW_COLUMNS[::4]:
        model, tip, columns, q = case(source, seed=12)
        weights = np.random.default_rng(13).uniform(0.2, 3, len(columns))
        assert_gradients(model, tip, columns, q, weights=weights, length=0.4)
        assert_gradients(model, tip, columns, q, weights=weights)


def within_limits(robot, joints, seed):
    """Return a configuration between the middle and the limits, where weights by limits are smooth."""
    generator, q = np.random.default_rng(seed), np.zeros(robot.nq)
    for joint in joints:
        lower, upper = joint.limit.range
        side = generator.choice([-1, 1]) * generator.uniform(0.2, 0.8)
        bounded = np.isfinite(upper - lower)
        q[robot.position_slices[joint.name]] = (lower + upper + side * (upper - lower)) / 2 if bounded else side
    return q


@pytest.mark.parametrize("length", ["none", 0.6])
def test_gradients_with_weights_by_limits(length):
    compared = 0
    sources = [f"example:{name}" for name in ("ur5_joint_limited_robot", "panda", "so101", "solo12")]
    sources += ["textbook:stanford", "textbook:scara", "textbook:puma560", "textbook:rp"]
    for seed, source in enumerate(sources):
        model, tip, columns = asked_of(source)
        q = within_limits(model.robot, model.robot.movable_path(model.robot.root, tip), seed)
        compared += assert_gradients(model, tip, columns, q, weights="limits", length=length)
    for seed in range(40):
        model = random_tree(seed, kinds=("revolute", "prismatic", "revolute", "continuous"), most=8)
        robot = model.robot
        tip = max(robot.tips, key=lambda link: len(robot.movable_path(robot.root, link)))
        joints = robot.movable_path(robot.root, tip)
        if not joints or any(joint.limit.velocity is None for joint in joints):
            continue
        columns = [robot.velocity_slices[joint.name].start for joint in joints]
        q = within_limits(robot, joints, seed)
        compared += assert_gradients(model, tip, columns, q, weights="limits", length=length)
    assert compared > 100


@pytest.mark.parametrize("source", ["example:panda", "textbook:stanford", *TREES[:20]], ids=str)
def test_an_automatic_length_is_constant_in_gradients(source):
    model, tip, _, q = case(source, seed=14)
    try:
        auto = ks.manipulability(model, tip, q, length="auto")
    except ks.UsageError:
        return
    given = ks.manipulability(model, tip, q, length=float(auto.length))
    for name, block in auto.blocks.items():
        for key, gradient in block.gradients.items():
            assert np.array_equal(gradient, given.blocks[name].gradients[key], equal_nan=True)


@pytest.mark.parametrize("source", ["example:panda", "textbook:stanford", *TREES[:20]], ids=str)
def test_gradients_do_not_hang_on_the_axes(source):
    model, tip, _, q = case(source, seed=15)
    plain, local = (ks.manipulability(model, tip, q, length=0.5, reference=r) for r in ("aligned", "local"))
    for name, block in plain.blocks.items():
        if block.inverse_condition_number > 1e-3:
            for key in ("yoshikawa", "isotropy"):
                here, there = block.gradients[key], local.blocks[name].gradients[key]
                assert_same(here, there, 1e-7 * max(1.0, np.max(np.abs(here))))


SPECIAL = (
    ("example:ur5_robot", "zero", {}),
    ("example:ur5_robot", "zero", {"length": "auto"}),
    ("example:panda", "zero", {}),
    ("example:panda", "mid", {"weights": "limits"}),
    ("textbook:planar_1r", "zero", {"axes": "z"}),
    ("textbook:planar_1r", "zero", {"axes": "x"}),
    ("textbook:planar_2r", "zero", {"axes": "x y"}),
    ("textbook:planar_2r", "0,1", {"weights": "limits"}),
    ("textbook:planar_3r", "zero", {"axes": "x"}),
    ("textbook:planar_3r", "zero", {"axes": "x y"}),
    ("textbook:planar_3r", "0,3.141592653589793,0", {"axes": "x y"}),
    ("textbook:stanford", "joint3=0.5", {"length": 0.4}),
    ("textbook:scara", "zero", {"axes": "xyz rz"}),
    ("textbook:isotropic_3r", "0.4,2.0943951023931953,2.6179938779914944", {"axes": "x y rz", "length": "auto"}),
    ("textbook:wrist_zyz", "zero", {}),
    ("textbook:puma560", "zero", {}),
    ("textbook:rp", "joint2=-0.15", {"axes": "x y"}),
)


@pytest.mark.parametrize(("source", "at", "asked"), SPECIAL, ids=str)
def test_a_gradient_is_given_only_where_an_index_has_one(source, at, asked):
    """At singular and isotropic poses: what is a number is the slope on both sides."""
    model, tip, columns = asked_of(source)
    q, step = ks.configuration(model, at).q, 1e-6
    result = ks.manipulability(model, tip, q, **asked)
    if result.length is not None:
        asked = {**asked, "length": float(result.length)}
    for sign in (1, -1):
        path = np.stack([moved(model.robot, q, e, np.array([sign * step]))[0] for e in np.eye(model.robot.nv)[columns]])
        beside = ks.manipulability(model, tip, path, **asked)
        for name, block in result.blocks.items():
            for key in INDICES:
                slope = (getattr(beside.blocks[name], key) - getattr(block, key)) / (sign * step)
                told = block.gradients[key]
                assert_same(told, np.where(np.isnan(told), np.nan, slope), 1e-4 * (1 + block.singular_values[0] ** 2))


def test_there_is_no_gradient_at_kinks():
    model, tip, _ = asked_of("textbook:planar_2r")
    stretched = ks.manipulability(model, tip, np.array([0.3, 0.0]), axes="x y").blocks["task"]
    for key in INDICES:
        assert np.all(np.isnan(stretched.gradients[key])), key
    # The largest and the smallest meet where the ellipse is a circle; the volume does not mind.
    model, tip, _ = asked_of("textbook:planar_2r_isotropic")
    circle = ks.manipulability(model, tip, np.array([0.3, np.pi * 3 / 4]), axes="x y").blocks["task"]
    for key in INDICES[1:3]:
        assert np.all(np.isnan(circle.gradients[key]))
    assert_same(circle.gradients["yoshikawa"], np.array([0, -1.0]), 1e-9)  # of sqrt 2 sin q2
    assert_same(circle.gradients["isotropy"], np.zeros(2), 1e-9)  # its maximum
    # Two largest ones alike, the smallest apart from them: at a right angle the wrist's axes are orthogonal.
    model, tip, _ = asked_of("textbook:wrist_zyz")
    disc = ks.manipulability(model, tip, np.array([0.3, np.pi / 2, 0.1]), weights=(1, 1, 0.5)).blocks["rotation"]
    assert_same(disc.singular_values, np.array([1, 1, 0.5]))
    assert np.all(np.isnan(disc.gradients["inverse_condition_number"]))
    assert_same(disc.gradients["minimum_singular_value"], np.zeros(3), 1e-9)


# --- singular configurations ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("source", "at", "ranks"),
    [
        ("textbook:planar_3r", "zero", {"full": 2, "translation": 1, "rotation": 1, "task": 2}),
        ("textbook:planar_3r", "0,1,0", {"full": 3, "translation": 2, "rotation": 1, "task": 3}),
        ("textbook:planar_1r", "zero", {"full": 1, "translation": 1, "rotation": 1, "task": 1}),
        ("textbook:skew_1p", "zero", {"full": 1, "translation": 1, "rotation": 0, "task": 1}),
        ("textbook:scara", "zero", {"full": 3, "translation": 2, "rotation": 1, "task": 2}),
        ("textbook:scara", "0,1,0,0", {"full": 4, "translation": 3, "rotation": 1, "task": 3}),
        ("textbook:wrist_zyz", "zero", {"full": 2, "translation": 1, "rotation": 2, "task": 2}),
    ],
)
def test_rank_at_known_poses(source, at, ranks):
    model, tip, _ = asked_of(source)
    result = ks.manipulability(model, tip, ks.configuration(model, at).q, axes="x y rz")
    assert {name: int(block.rank) for name, block in result.blocks.items()} == ranks
    for block in result.blocks.values():
        below = block.singular_values[int(block.rank) :]
        assert np.all(below < 1e-12)
        if below.size:
            assert block.inverse_condition_number < 1e-12
            assert block.yoshikawa < 1e-12


@pytest.mark.parametrize("unit", [1e-6, 1e-3, 0.0254, 1e3])
@pytest.mark.parametrize(
    ("source", "at"),
    [("example:ur5_robot", "zero"), ("textbook:puma560", "zero"), ("textbook:scara", "zero"), ("textbook:rp", "zero")],
)
def test_a_singular_pose_is_singular_in_every_unit(source, at, unit):
    model, tip, _ = asked_of(source)
    q = ks.configuration(model, at).q
    ours = ks.manipulability(model, tip, q, axes="x y rz").blocks
    told = load_text(told_in(model.robot, unit))
    theirs = ks.manipulability(told, tip, positions_in(model.robot, q, unit), axes="x y rz").blocks
    assert {k: int(b.rank) for k, b in ours.items()} == {k: int(b.rank) for k, b in theirs.items()}


def test_exactly_no_isotropy_where_a_direction_is_lost():
    """The geometric mean of what is zero but for rounding is zero, not a root of rounding."""
    model, tip, _ = asked_of("textbook:planar_3r")
    result = ks.manipulability(model, tip, np.zeros(3), length=1.0)
    assert [float(block.isotropy) for block in result.blocks.values()] == [0, 0, 0]


# --- along a line --------------------------------------------------------------------------------------------------


def radius(ellipsoid, direction):
    """Return how far an ellipsoid reaches along a line through its centre."""
    coordinates = ellipsoid.axes.T @ direction
    coordinates[np.abs(coordinates) < 1e-9] = 0
    with np.errstate(divide="ignore", invalid="ignore"):
        parts = np.where(coordinates == 0, 0.0, coordinates / ellipsoid.lengths)
        return 1 / np.linalg.norm(parts)


@pytest.mark.parametrize("source", ALL, ids=str)
def test_transmission_is_the_radius_of_the_ellipsoids(source):
    model, tip, _, q = case(source, seed=16)
    block = ks.manipulability(model, tip, q).blocks["translation"]
    if block.rank == 0:
        return
    drawn = np.random.default_rng(17).normal(size=(3, 3))
    for direction in (*drawn, *np.eye(3)[:1], *block.velocity.axes.T):
        unit = direction / np.linalg.norm(direction)
        line = ks.manipulability(model, tip, q, direction=direction * 3).transmission
        assert_same(line.direction, unit)
        assert (line.unit_velocity, line.unit_force) == (block.velocity.unit, block.force.unit)
        np.testing.assert_allclose(line.velocity, radius(block.velocity, unit), rtol=1e-6, atol=1e-12)
        np.testing.assert_allclose(line.force, radius(block.force, unit), rtol=1e-6)


@pytest.mark.parametrize("source", ALL, ids=str)
def test_transmission_is_the_fastest_motion_along_a_line_and_the_force_that_a_unit_torque_holds(source):
    model, tip, _, q = case(source, seed=18)
    matrix = matrix_at(model, tip, q, range(3))
    for rates in np.random.default_rng(19).normal(size=(3, matrix.shape[1])):
        velocity = matrix @ rates  # a direction in which it can move
        if np.linalg.norm(velocity) < 1e-6:
            continue
        line = ks.manipulability(model, tip, q, direction=velocity).transmission
        unit = velocity / np.linalg.norm(velocity)
        least = np.linalg.lstsq(matrix, unit, rcond=1e-10)[0]
        assert_same(matrix @ least, unit, 1e-8)
        np.testing.assert_allclose(line.velocity, 1 / np.linalg.norm(least), rtol=1e-7)
        np.testing.assert_allclose(np.linalg.norm(matrix.T @ (line.force * unit)), 1, rtol=1e-10)
        # Others along the line are slower: the same motion with more of what moves nothing.
        idle = rates - np.linalg.pinv(matrix, rcond=1e-10) @ (matrix @ rates)
        other = least + idle
        assert_same(matrix @ other, unit, 1e-7)
        assert 1 / np.linalg.norm(other) <= line.velocity * (1 + 1e-9)
        # Force and velocity of a line: no force holds more than the fastest motion leaves power for.
        assert line.velocity * line.force <= 1 + 1e-9


def test_transmission_along_what_is_lost():
    model, tip, _ = asked_of("textbook:planar_2r")
    for direction, q in (((0, 0, 1), [0.3, 0.9]), ((1, 0, 0), [0, 0]), ((0, 0, 2e-3), [0, 0])):
        line = ks.manipulability(model, tip, np.array(q, float), direction=direction).transmission
        assert (line.velocity, line.force) == (0, np.inf)
    line = ks.manipulability(model, tip, np.zeros(2), direction=(1, 1, 0)).transmission
    assert line.velocity == 0  # not without moving along y alone
    assert_same(line.force, np.sqrt(2) / np.hypot(1.8, 0.8))  # torques (1.8, 0.8) for a newton along y


@pytest.mark.parametrize("direction", [(0, 0, 0), (1, 2), (np.nan, 0, 0), (np.inf, 0, 0), ()])
def test_a_direction_that_cannot_be_is_refused(direction):
    model, tip, _, q = case("textbook:planar_2r")
    with pytest.raises(ks.UsageError, match="three finite numbers, not all zero"):
        ks.manipulability(model, tip, q, direction=direction)


@pytest.mark.parametrize("size", [1e-100, 1e-30, 1e30, 1e100])
def test_the_length_of_a_direction_says_nothing(size):
    model, tip, _, q = case("example:panda")
    plain = ks.manipulability(model, tip, q, direction=(0.6, 0, -0.8)).transmission
    line = ks.manipulability(model, tip, q, direction=(0.6 * size, 0, -0.8 * size)).transmission
    assert_same(line.direction, plain.direction)
    assert_same(line.velocity, plain.velocity)


# --- batches ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("source", [*TREES[::4], "example:panda", "textbook:stanford", "example:so101"], ids=str)
def test_a_batch_is_its_configurations_one_by_one(source):
    model, tip, _, q = case(source, (2, 3), seed=20)
    asked = {"axes": "x y rz", "length": 0.7, "direction": (1.0, -2.0, 0.5)}
    many = ks.manipulability(model, tip, q, **asked)
    for where in np.ndindex(2, 3):
        one = ks.manipulability(model, tip, q[where], **asked)
        pairs = [(many.length, one.length), (many.transmission.velocity, one.transmission.velocity)]
        pairs.append((many.transmission.force, one.transmission.force))
        for name, block in one.blocks.items():
            other = many.blocks[name]
            pairs += [(getattr(other, key), getattr(block, key)) for key in ("rank", "singular_values", *INDICES)]
            pairs += [(other.gradients[key], block.gradients[key]) for key in block.gradients]
            for mine, theirs in ((other.velocity, block.velocity), (other.force, block.force)):
                pairs += [(mine.axes, theirs.axes), (mine.lengths, theirs.lengths)]
        for whole, part in pairs:
            assert np.shape(whole)[:2] == (2, 3)
            np.testing.assert_allclose(whole[where], part, rtol=1e-7, atol=1e-9)


def test_a_batch_with_automatic_lengths_has_one_each():
    model, tip, _, q = case("example:ur5_robot", (7,))
    many = ks.manipulability(model, tip, q, length="auto")
    singles = [ks.manipulability(model, tip, one, length="auto") for one in q]
    assert_same(many.length, np.array([float(one.length) for one in singles]))
    expected = np.array([one.blocks["full"].singular_values for one in singles])
    assert_same(many.blocks["full"].singular_values, expected)


def test_there_were_robots_of_every_shape():
    assert len(MANY_ROWS) > 5
    assert len(MANY_JOINTS) > 5
    kinds = {joint.type for source in ALL for joint in asked_of(source)[0].robot.joints}
    assert kinds == set(JointType)
    assert sum(bool(asked_of(source)[0].robot.followers) for source in ALL) > 5
