"""Rows A14 to A16: a helical joint, a body that is moved, and two frames on one body."""

import numpy as np
import pytest

from kinetostat import WrenchOrTwist
from textbook_support import (
    assert_same,
    cross_matrix,
    frame_change_of,
    jacobian_of,
    placement_of,
    turn_about,
)

TWIST, WRENCH = WrenchOrTwist.TWIST, WrenchOrTwist.WRENCH
AXIS = np.array([3.0, 2.0, 6.0]) / 7
THROUGH = np.array([0.3, -0.1, 0.2])
PITCH = 0.05
SCREW = np.r_[PITCH / (2 * np.pi) * AXIS + np.cross(THROUGH, AXIS), AXIS]
TURNS = np.array([0.0, 1e-9, 0.5, -1.7, np.pi, 2 * np.pi, -9.0, 40.0])
HOME = THROUGH + np.array([-0.2, 0.1, -0.15])  # the tool's offset (0.1, 0.2, -0.15), turned by a quarter about z


# --- A14 --------------------------------------------------------------------------------------------------------


def test_a14_column_of_a_helical_joint():
    expected = np.broadcast_to(SCREW[:, None], (len(TURNS), 6, 1))
    assert_same(jacobian_of("helical", "tool", TURNS[:, None], reference="world"), expected)
    assert_same(jacobian_of("helical", "nut", TURNS[:, None], reference="world"), expected)


def tool_at(turn):
    """Return where the tool is: turned about the line, and advanced along it by a pitch per turn."""
    return THROUGH + turn_about(AXIS, turn) @ (HOME - THROUGH) + PITCH * turn / (2 * np.pi) * AXIS


def test_a14_tool_runs_on_a_helix():
    home = np.array([[0.0, -1, 0], [0, 0, 1], [-1, 0, 0]])  # a quarter about z, then one about y
    placements = placement_of("helical", "tool", TURNS[:, None])
    assert_same(placements[:, :3, 3], np.array([tool_at(turn) for turn in TURNS]))
    assert_same(placements[:, :3, :3], np.array([turn_about(AXIS, turn) @ home for turn in TURNS]))


@pytest.mark.parametrize("point", [(0, 0, 0), (0.1, -0.2, 0.3)])
def test_a14_tool_velocity_is_along_the_helix(point):
    home = np.array([[0.0, -1, 0], [0, 0, 1], [-1, 0, 0]])
    columns = []
    for turn in TURNS:
        arm = tool_at(turn) + turn_about(AXIS, turn) @ home @ point - THROUGH
        columns.append(np.r_[PITCH / (2 * np.pi) * AXIS + np.cross(AXIS, arm), AXIS])
    matrix = jacobian_of("helical", "tool", TURNS[:, None], point=point)
    assert_same(matrix, np.array(columns)[..., None])


def test_a14_one_turn_advances_by_the_pitch():
    q = np.array([[0.3], [0.3 + 2 * np.pi], [0.3 - 6 * np.pi]])
    before, after, back = placement_of("helical", "tool", q)
    assert_same(after[:3, 3] - before[:3, 3], PITCH * AXIS)
    assert_same(back[:3, 3] - before[:3, 3], -3 * PITCH * AXIS)
    assert_same(after[:3, :3], before[:3, :3])


def test_a14_a_point_on_the_line_moves_along_it():
    placement = placement_of("helical", "nut", [1.2])
    assert_same(placement[:3, 3], THROUGH + PITCH * 1.2 / (2 * np.pi) * AXIS)
    assert_same(jacobian_of("helical", "nut", [1.2])[:3, 0], PITCH / (2 * np.pi) * AXIS)


# --- A15 --------------------------------------------------------------------------------------------------------


def motions(seed, count=12):
    """Return placements of a floating base: R, t, and the base's coordinates (t, quaternion xyzw)."""
    generator = np.random.default_rng(seed)
    for i in range(count):
        axis = generator.normal(size=3)
        axis /= np.linalg.norm(axis)
        angle = (0.0, 1e-8, np.pi)[i] if i < 3 else generator.uniform(-np.pi, np.pi)
        shift = np.zeros(3) if i == 3 else generator.uniform(-2, 2, 3)
        yield turn_about(axis, angle), shift, np.r_[shift, np.sin(angle / 2) * axis, np.cos(angle / 2)]


def moved_screw(rotation, shift, screw):
    """Return (R(u x v + h v) + t x R v ; R v)."""
    axis = rotation @ screw[3:]
    return np.r_[rotation @ screw[:3] + np.cross(shift, axis), axis]


SCREWS = {"helical": SCREW, "planar_1r": np.r_[0, 0, 0, 0, 0, 1.0], "skew_1p": np.r_[AXIS, 0, 0, 0]}


@pytest.mark.parametrize("name", SCREWS)
def test_a15_the_screw_of_a_joint_moves_with_the_robot(name):
    for rotation, shift, base in motions(seed=151):
        matrix = jacobian_of(name, "tool", np.r_[base, 0.4], floating_base=True, reference="world", joints=["joint1"])
        moved = SCREWS[name]
        if name == "skew_1p":  # a couple has no place: only its direction turns
            assert_same(moved_screw(rotation, shift, moved), np.r_[rotation @ AXIS, 0, 0, 0])
        assert_same(matrix[:, 0], moved_screw(rotation, shift, moved), atol=4e-12)


def test_a15_the_adjoint_carries_a_screw_with_its_body():
    for rotation, shift, base in motions(seed=152):
        change = frame_change_of("rigid_body", "body", "universe", base, floating_base=True)
        assert_same(change @ SCREW, moved_screw(rotation, shift, SCREW), atol=4e-12)


def test_a15_a_line_moves_as_its_points_do():
    """A line through u becomes the line through R u + t: pitch and distance between lines do not change."""
    for rotation, shift, base in motions(seed=153):
        change = frame_change_of("rigid_body", "body", "universe", base, floating_base=True)
        line = np.r_[np.cross(THROUGH, AXIS), AXIS]
        there = rotation @ THROUGH + shift
        assert_same(change @ line, np.r_[np.cross(there, rotation @ AXIS), rotation @ AXIS], atol=4e-12)
        carried = change @ SCREW
        assert_same(carried[:3] @ carried[3:], PITCH / (2 * np.pi), atol=4e-12)


# --- A16 --------------------------------------------------------------------------------------------------------


def from_triples(roll, pitch, yaw):
    """Return Rz(yaw) Ry(pitch) Rx(roll) of angles given by Pythagorean triples (sine, cosine, hypotenuse)."""
    (sr, cr), (sp, cp), (sy, cy) = ((s / h, c / h) for s, c, h in (roll, pitch, yaw))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


A_AXES, A_ORIGIN = from_triples((3, 4, 5), (5, 12, 13), (8, 15, 17)), np.array([0.3, -0.2, 0.5])
B_AXES, B_ORIGIN = from_triples((-5, 12, 13), (-8, 15, 17), (4, 3, 5)), np.array([-0.4, 0.1, 0.25])
R = B_AXES.T @ A_AXES  # B_R_A
P = A_AXES.T @ (B_ORIGIN - A_ORIGIN)  # B's origin in A
VELOCITY_A_TO_B = np.block([[R, -R @ cross_matrix(P)], [np.zeros((3, 3)), R]])
FORCE_B_TO_A = np.block([[R.T, np.zeros((3, 3))], [cross_matrix(P) @ R.T, R.T]])


def test_a16_frames_are_where_the_file_says():
    assert_same(placement_of("rigid_body", "a", ())[:3], np.c_[A_AXES, A_ORIGIN])
    assert_same(placement_of("rigid_body", "b", ())[:3], np.c_[B_AXES, B_ORIGIN])
    assert_same(placement_of("rigid_body", "b", (), relative_to="a")[:3, 3], P)


@pytest.mark.parametrize("base", [None, *(base for _, _, base in motions(seed=161, count=4))])
def test_a16_velocities_and_forces_between_rigidly_joined_frames(base):
    """However the body is placed, too."""
    asked = {} if base is None else {"q": base, "floating_base": True}
    assert_same(frame_change_of("rigid_body", "a", "b", kind=TWIST, **asked), VELOCITY_A_TO_B, atol=4e-12)
    assert_same(frame_change_of("rigid_body", "b", "a", kind=WRENCH, **asked), FORCE_B_TO_A, atol=4e-12)


def test_a16_the_force_matrix_is_the_transpose_of_the_velocity_matrix_the_other_way():
    velocity = frame_change_of("rigid_body", "a", "b", kind=TWIST)
    force = frame_change_of("rigid_body", "b", "a", kind=WRENCH)
    assert_same(force, velocity.T)
    assert_same(FORCE_B_TO_A, VELOCITY_A_TO_B.T, atol=1e-15)
    # The velocity matrix the same way is another one: transposing without turning round is the classical mistake.
    assert np.max(np.abs(force - frame_change_of("rigid_body", "b", "a", kind=TWIST))) > 0.1


def test_a16_power_is_the_same_in_both_frames():
    generator = np.random.default_rng(162)
    twist, wrench = generator.normal(size=(2, 6))
    twist_b = frame_change_of("rigid_body", "a", "b", kind=TWIST) @ twist
    wrench_b = frame_change_of("rigid_body", "b", "a", kind=WRENCH, inverse=True) @ wrench
    # The point of B's origin moves with v + w x p; the moment about it is m - p x f.
    assert_same(twist_b, np.r_[R @ (twist[:3] + np.cross(twist[3:], P)), R @ twist[3:]])
    assert_same(wrench_b, np.r_[R @ wrench[:3], R @ (wrench[3:] - np.cross(P, wrench[:3]))])
    assert_same(wrench_b @ twist_b, wrench @ twist)


def test_a16_a_body_at_rest_has_no_jacobian_columns():
    assert jacobian_of("rigid_body", "a", ()).shape == (6, 0)


def test_a16_frames_on_a_floating_body_share_its_angular_velocity():
    """Velocity of a's origin for the body's own twist: the adjoint from body to a, turned to the observer's axes."""
    for rotation, _, base in motions(seed=163, count=6):
        matrix = jacobian_of("rigid_body", "a", base, floating_base=True)
        expected = np.block([[rotation, -rotation @ cross_matrix(A_ORIGIN)], [np.zeros((3, 3)), rotation]])
        assert_same(matrix, expected, atol=4e-12)


@pytest.mark.parametrize("reference", ["aligned", "local", "world"])
def test_a14_the_pitch_is_the_same_in_every_frame(reference):
    columns = jacobian_of("helical", "tool", TURNS[:, None], reference=reference)[..., 0]
    assert_same(np.einsum("ni,ni->n", columns[:, :3], columns[:, 3:]), np.full(len(TURNS), PITCH / (2 * np.pi)))
