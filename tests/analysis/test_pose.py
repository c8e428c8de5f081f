"""Wanted poses: each notation against SciPy's rotations, what is refused, and how far a tool is from a pose."""

from itertools import permutations, product

import numpy as np
import pytest
from scipy.linalg import logm
from scipy.spatial.transform import RigidTransform, Rotation

import kinetostat as ks
from kinetostat.analysis.euler import sequence_names
from kinetostat.analysis.inverse.pose import NOTATIONS, pose_error
from textbook_support import assert_same

AT = (0.4, -1.2, 3.0)
HALF_TURNS = [np.pi * np.array(axis) / np.linalg.norm(axis) for axis in product((0, 1, -1), repeat=3) if any(axis)]
TURNS = [
    np.zeros(3),
    *(1e-9 * np.eye(3)),
    *HALF_TURNS,
    *((1 - 1e-9) * np.array(HALF_TURNS[:3])),
    *np.random.default_rng(0).uniform(-1.8, 1.8, (10, 3)),
]


def written(notation, rotation):
    """Return the numbers that write a rotation in a notation, by SciPy."""
    if notation == "rpy":
        return rotation.as_euler("xyz")
    if notation == "xyzw":
        return rotation.as_quat()
    if notation == "wxyz":
        return rotation.as_quat(scalar_first=True)
    if notation == "rotvec":
        return rotation.as_rotvec()
    if notation == "axis-angle":
        vector = rotation.as_rotvec()
        angle = np.linalg.norm(vector)
        # Of whatever length the axis is; where nothing turns it may be any.
        return np.append(2.5 * vector / angle if angle else [0, 0, 3.0], angle)
    letters = notation.removeprefix("fixed-")
    return rotation.as_euler(letters if notation.startswith("fixed-") else letters.upper())


def text(numbers):
    return ",".join(repr(float(x)) for x in numbers)


def expected(rotation, at=AT):
    return RigidTransform.from_components(at, rotation).as_matrix()


# --- notations ---------------------------------------------------------------------------------------------------


def test_all_24_sequences_are_known():
    moved = {"".join(s) for s in product("xyz", repeat=3) if s[0] != s[1] != s[2]}
    assert set(sequence_names()) - {"rpy"} == moved | {f"fixed-{name}" for name in moved}


ANGLES = [*product((0.0, np.pi / 2, -np.pi, 1e-9), repeat=3), *np.random.default_rng(1).uniform(-7, 7, (20, 3))]


@pytest.mark.parametrize("name", ["rpy", *sorted(sequence_names())])
def test_angles_mean_what_scipy_means(name):
    """Lower-case letters are fixed axes to SciPy, capitals moved ones."""
    sequence = "xyz" if name == "rpy" else name[6:] if name.startswith("fixed-") else name.upper()
    for angles in ANGLES:
        found = ks.pose(f"{text(AT)} {name} {text(angles)}")
        assert found.oriented
        assert_same(found.matrix, expected(Rotation.from_euler(sequence, angles)), atol=3e-15)


@pytest.mark.parametrize("notation", [name for name in NOTATIONS if name != "rpy"])
def test_notations_mean_what_scipy_means(notation):
    for turn in TURNS:
        rotation = Rotation.from_rotvec(turn)
        found = ks.pose(f"{text(AT)} {notation} {text(written(notation, rotation))}")
        assert found.oriented
        assert_same(found.matrix, expected(rotation), atol=5e-8 if np.linalg.norm(turn) > 3.14 else 1e-14)
        assert_same(found.matrix[:3, :3] @ found.matrix[:3, :3].T, np.eye(3), atol=1e-14)


@pytest.mark.parametrize("notation", ["rpy", "rotvec", "zyz", "fixed-yxz"])
def test_degrees_are_those_of_angles(notation):
    rotation = Rotation.from_rotvec([0.3, -1.1, 0.7])
    angles = np.degrees(written(notation, rotation))
    found = ks.pose(f"{text(AT)} {notation} {text(angles)}", degrees=True)
    assert_same(found.matrix, expected(rotation), atol=1e-14)


def test_degrees_of_an_axis_and_an_angle_are_those_of_the_angle_alone():
    found = ks.pose(f"{text(AT)} axis-angle 0,3,4,60", degrees=True)
    assert_same(found.matrix, expected(Rotation.from_rotvec([0, 0.6 * np.pi / 3, 0.8 * np.pi / 3])), atol=1e-14)


def test_degrees_turn_no_quaternion_and_no_matrix():
    rotation = Rotation.from_rotvec([0.3, -1.1, 0.7])
    for numbers in ((*AT, *rotation.as_quat()), expected(rotation)[:3].reshape(-1), expected(rotation)):
        assert_same(ks.pose(numbers, degrees=True).matrix, expected(rotation), atol=1e-14)


@pytest.mark.parametrize("turn", TURNS[:8] + TURNS[-3:], ids=str)
def test_numbers_alone_are_told_by_their_count(turn):
    rotation = Rotation.from_rotvec(turn)
    with_angles = (*AT, *written("zyx", rotation)[::-1])  # yaw, pitch and roll about moved axes
    matrix = expected(rotation)
    spelled = {
        6: with_angles,
        7: (*AT, *rotation.as_quat()),
        12: matrix[:3].reshape(-1),
        16: matrix.reshape(-1),
    }
    for count, numbers in spelled.items():
        assert len(numbers) == count
        for given in (numbers, list(numbers), np.array(numbers), text(numbers), text(numbers).replace(",", " ")):
            found = ks.pose(given)
            assert found.oriented
            assert_same(found.matrix, matrix, atol=1e-13)
    swapped = (*AT, *rotation.as_quat(scalar_first=True))
    assert_same(ks.pose(swapped, quaternion_first="w").matrix, matrix, atol=1e-14)


def test_three_numbers_are_a_position_without_a_rotation():
    for given in (AT, text(AT), " 0.4  -1.2 ,\t3.0 ", np.array(AT)):
        found = ks.pose(given)
        assert not found.oriented
        assert found.matrix[:3, 3].tolist() == list(AT)
        assert np.array_equal(found.matrix[:3, :3], np.eye(3))


def test_a_notation_says_itself_how_a_quaternion_is_ordered():
    rotation = Rotation.from_rotvec([0.3, -1.1, 0.7])
    named = f"{text(AT)} xyzw {text(rotation.as_quat())}"
    assert_same(ks.pose(named, quaternion_first="w").matrix, expected(rotation), atol=1e-14)


def test_a_quaternion_and_its_negative_are_one_rotation():
    quaternion = Rotation.from_rotvec([0.3, -1.1, 0.7]).as_quat()
    assert_same(ks.pose((*AT, *quaternion)).matrix, ks.pose((*AT, *-quaternion)).matrix, atol=1e-15)


def test_what_is_typed_with_few_digits_becomes_a_rotation():
    rotation = Rotation.from_rotvec([0.3, -1.1, 0.7])
    for numbers in ((*AT, *rotation.as_quat().round(4)), expected(rotation).round(4)):
        matrix = ks.pose(numbers).matrix
        assert_same(matrix[:3, :3] @ matrix[:3, :3].T, np.eye(3), atol=1e-14)
        assert_same(matrix[:3, :3], rotation.as_matrix(), atol=2e-4)


def test_the_nearest_rotation_to_a_matrix_is_taken():
    """No rotation about it is nearer to what was typed."""
    typed = Rotation.from_rotvec([0.3, -1.1, 0.7]).as_matrix() + np.random.default_rng(1).uniform(-2e-4, 2e-4, (3, 3))
    given = np.eye(4)
    given[:3, :3] = typed
    found = ks.pose(given).matrix[:3, :3]
    for turn in np.random.default_rng(2).normal(size=(50, 3)) * 1e-4:
        other = Rotation.from_rotvec(turn).as_matrix() @ found
        assert np.linalg.norm(typed - found) < np.linalg.norm(typed - other)


def test_arrays_of_matrices_keep_their_leading_shape():
    rotations = Rotation.from_rotvec(np.random.default_rng(3).uniform(-1, 1, (6, 3)))
    matrices = expected(rotations, np.ones(3)).reshape(2, 3, 4, 4)
    assert_same(ks.pose(matrices).matrix, matrices, atol=1e-14)
    assert ks.pose(np.zeros((0, 4, 4))).matrix.shape == (0, 4, 4)


def test_a_pose_of_the_library_is_a_pose_again():
    matrix = ks.fk(ks.load("example:panda"), "panda_hand", ks.random_configurations(ks.load("example:panda"), 1)).matrix
    assert_same(ks.pose(matrix).matrix, matrix, atol=1e-14)


# --- refusals ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("wanted", "part"),
    [
        ("", "a pose of 0 numbers"),
        (",", "a pose of 0 numbers"),
        ("1,2", "a pose of 2 numbers"),
        ("1,2,3,4", "a pose of 4 numbers"),
        ([1.0] * 8, "a pose of 8 numbers"),
        ([1.0] * 9, "a pose of 9 numbers"),
        ([], "a pose of 0 numbers"),
        (np.zeros((3, 3)), "a pose of 9 numbers"),
        ("nan,0,0", "finite"),
        ("inf,0,0", "finite"),
        ("1e13,0,0", "finite"),
        ((0, 0, float("nan")), "finite"),
        ("0,0,0 rpy nan,0,0", "finite"),
        ("a,b,c", "no pose"),
        ("0,0,0 rpy", "rpy takes 3 numbers, not 0"),
        ("0,0,0 rpy 1,2", "rpy takes 3 numbers, not 2"),
        ("0,0,0 rpy 1,2,3,4", "rpy takes 3 numbers, not 4"),
        ("0,0,0 xyzw 1,0,0", "xyzw takes 4 numbers, not 3"),
        ("0,0,0 axis-angle 1,0,0", "axis-angle takes 4 numbers, not 3"),
        ("0,0 rpy 0,0,0", "is no pose"),
        ("rpy 0,0,0", "is no pose"),
        ("0,0,0 rpy 0,0,0 deg", "is no pose"),
        ("0,0,0 xxz 0,0,0", "no notation 'xxz'"),
        ("0,0,0 RPY 0,0,0", "no notation 'RPY'"),
        ("0,0,0 \x1b[31m 0,0,0", r"no notation '\x1b[31m'"),
        ("0,0,0 xyzw 0,0,0,0", "length 0, not 1"),
        ("0,0,0 xyzw 0,0,0,1.01", "length 1.01, not 1"),
        ((0, 0, 0, 0, 0, 0, 2), "length 2, not 1"),
        ("0,0,0 axis-angle 0,0,0,1", "the axis is zero"),
        (2 * np.eye(4), "no rotation"),
        (np.diag([1.0, 1, -1, 1]), "no rotation"),
        (np.zeros((4, 4)), "no rotation"),
        (np.eye(4).reshape(-1) + np.eye(16)[12], "last row"),
        (["a", "b", "c"], "no pose"),
        ([[1.0, 2], [3.0]], "no pose"),
    ],
    ids=lambda x: repr(x)[:30],
)
def test_what_is_no_pose_is_refused(wanted, part):
    with pytest.raises(ks.UsageError) as caught:
        ks.pose(wanted)
    assert part in str(caught.value)
    assert caught.value.remedy
    assert "\n" not in str(caught.value)
    assert "\x1b" not in str(caught.value)


@pytest.mark.parametrize("given", ["0x1,0,0", "1,0,0,", "1;0;0", "(1,0,0)", "1.0.0,0,0"])
def test_odd_numbers_are_refused_or_read_as_they_stand(given):
    if given == "1,0,0,":
        assert ks.pose(given).matrix[:3, 3].tolist() == [1, 0, 0]
    else:
        with pytest.raises(ks.UsageError):
            ks.pose(given)


# --- errors ------------------------------------------------------------------------------------------------------


def frames(seed, count):
    generator = np.random.default_rng(seed)
    rotations = Rotation.from_rotvec(generator.uniform(-1.8, 1.8, (count, 3)))
    return expected(rotations, generator.uniform(-2, 2, (count, 3)))


def test_the_error_is_nothing_where_there_is_none_and_nowhere_else():
    there = frames(1, 30)
    assert np.abs(pose_error(there, there)).max() < 1e-15
    for i, j in permutations(range(4), 2):
        assert np.linalg.norm(pose_error(there[i], there[j])) > 0.1


@pytest.mark.parametrize("turn", TURNS, ids=str)
def test_the_error_takes_the_tool_to_the_pose(turn):
    here = frames(2, 20)
    target = here.copy()
    target[:, :3, :3] = Rotation.from_rotvec(turn).as_matrix() @ here[:, :3, :3]
    target[:, :3, 3] += AT
    error = pose_error(here, target)
    assert_same(error[:, :3], np.tile(AT, (20, 1)), atol=1e-14)
    moved = Rotation.from_rotvec(error[:, 3:]).as_matrix() @ here[:, :3, :3]
    assert_same(moved, target[:, :3, :3], atol=1e-9 if np.linalg.norm(turn) > 3 else 1e-14)
    assert np.all(np.linalg.norm(error[:, 3:], axis=1) <= np.pi + 1e-12)
    # In the tool's axes it is the same motion, made before the tool's own placement.
    local = pose_error(here, target, local=True)
    moved = here[:, :3, :3] @ Rotation.from_rotvec(local[:, 3:]).as_matrix()
    assert_same(moved, target[:, :3, :3], atol=1e-9 if np.linalg.norm(turn) > 3 else 1e-14)
    assert_same((here @ np.append(local[:, :3], np.ones((20, 1)), axis=1)[..., None])[:, :, 0], target[:, :, 3], 1e-14)


def test_the_rotation_vector_is_the_logarithm():
    here, target = frames(3, 1)[0], frames(4, 1)[0]
    skew = logm(target[:3, :3] @ here[:3, :3].T)
    assert_same(pose_error(here, target)[3:], [skew[2, 1], skew[0, 2], skew[1, 0]], atol=1e-12)


def test_errors_of_batches_go_together():
    here, target = frames(5, 6).reshape(2, 3, 4, 4), frames(6, 1)[0]
    for local in (False, True):
        many = pose_error(here, target, local=local)
        assert many.shape == (2, 3, 6)
        for index in np.ndindex(2, 3):
            assert_same(many[index], pose_error(here[index], target, local=local), atol=1e-15)
