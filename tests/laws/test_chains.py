"""Products of exponentials: placements, Jacobians and their derivatives of chains of screws, helical ones too."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from differences import derivative
from kinetostat.screw import chain, se3, so3
from kinetostat.screw.adjoint import adjoint, bracket

seeds = st.integers(0, 10_000)


def random_chain(seed: int, most: int = 7) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return home, screws (6, n), q and qdot (n,) of a chain of revolute, sliding and helical joints."""
    random = np.random.default_rng(seed)
    count = int(random.integers(1, most + 1))
    pitches = random.choice([0.0, 0.0, np.inf, 0.3, -2.0], count)
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    screws = [chain.screw(d, random.uniform(-1, 1, 3), p) for d, p in zip(directions, pitches, strict=True)]
    home = se3.exp(random.uniform(-2, 2, 6))
    return home, np.stack(screws, -1), random.uniform(-np.pi, np.pi, count), random.uniform(-1, 1, count)


@given(seeds)
def test_at_zero_the_tool_is_at_home(seed: int) -> None:
    home, screws, q, _ = random_chain(seed)
    np.testing.assert_array_equal(chain.forward(home, screws, np.zeros_like(q)), home)


@given(seeds)
def test_moving_the_last_joint_first_gives_the_same_placement(seed: int) -> None:
    """Placing joint after joint outwards, each screw carried along by those before it, is the same product."""
    home, screws, q, _ = random_chain(seed)
    placement = home
    for i in range(len(q)):
        # The screws before i have already moved it: S_i as it now lies.
        carried = chain.space_jacobian(screws, q)[:, i]
        # What was done so far, then the rest of the tool turned about the carried screw: exp(Ad(A) S) A = A exp(S).
        placement = se3.exp(carried * q[i]) @ placement
    np.testing.assert_allclose(chain.forward(home, screws, q), placement, rtol=0, atol=1e-12)


@given(seeds)
def test_a_chain_in_two_parts_is_the_product_of_the_parts(seed: int) -> None:
    home, screws, q, _ = random_chain(seed)
    cut = len(q) // 2
    first = chain.forward(np.eye(4), screws[:, :cut], q[:cut])
    second = chain.forward(home, screws[:, cut:], q[cut:])
    np.testing.assert_allclose(chain.forward(home, screws, q), first @ second, rtol=0, atol=1e-13)


@given(seeds)
def test_space_jacobian_is_the_velocity_of_the_body_seen_from_the_base(seed: int) -> None:
    """J_space qdot is the twist of dT/dt T^-1, by differences of the placement."""
    home, screws, q, qdot = random_chain(seed)
    placement = chain.forward(home, screws, q)
    spatial = derivative(lambda t: chain.forward(home, screws, q + t[:, None] * qdot)) @ np.linalg.inv(placement)
    twist = chain.space_jacobian(screws, q) @ qdot
    np.testing.assert_allclose(twist[:3], spatial[:3, 3], rtol=0, atol=1e-10)
    np.testing.assert_allclose(twist[3:], so3.vee(spatial[:3, :3]), rtol=0, atol=1e-11)


@given(seeds)
def test_body_jacobian_is_the_velocity_seen_from_the_tool(seed: int) -> None:
    """J_body qdot is the twist of T^-1 dT/dt, by differences of the placement."""
    home, screws, q, qdot = random_chain(seed)
    placement = chain.forward(home, screws, q)
    body = np.linalg.inv(placement) @ derivative(lambda t: chain.forward(home, screws, q + t[:, None] * qdot))
    twist = chain.body_jacobian(home, screws, q) @ qdot
    np.testing.assert_allclose(twist[:3], body[:3, 3], rtol=0, atol=1e-10)
    np.testing.assert_allclose(twist[3:], so3.vee(body[:3, :3]), rtol=0, atol=1e-11)


@given(seeds)
def test_the_adjoint_of_the_tool_carries_the_body_jacobian_to_the_space_jacobian(seed: int) -> None:
    home, screws, q, _ = random_chain(seed)
    carried = adjoint(chain.forward(home, screws, q)) @ chain.body_jacobian(home, screws, q)
    np.testing.assert_allclose(carried, chain.space_jacobian(screws, q), rtol=0, atol=1e-12)


@given(seeds)
def test_jacobian_derivatives_are_differences_of_the_jacobian(seed: int) -> None:
    _, screws, q, _ = random_chain(seed)
    found = chain.jacobian_derivatives(chain.space_jacobian(screws, q))
    for j, unit in enumerate(np.eye(len(q))):
        rate = derivative(lambda t, unit=unit: chain.space_jacobian(screws, q + t[:, None] * unit))
        np.testing.assert_allclose(found[:, :, j], rate, rtol=0, atol=1e-10)


@given(seeds)
def test_mixed_derivatives_differ_by_the_bracket(seed: int) -> None:
    """dJ_i/dq_j - dJ_j/dq_i = [J_j, J_i]: the curvature of the group, whichever of the two joints comes first."""
    _, screws, q, _ = random_chain(seed)
    space = chain.space_jacobian(screws, q)
    found = chain.jacobian_derivatives(space)
    for i in range(len(q)):
        for j in range(i):
            np.testing.assert_array_equal(found[:, i, j] - found[:, j, i], bracket(space[:, j], space[:, i]))


@given(seeds)
def test_columns_do_not_depend_on_joints_beyond_their_own(seed: int) -> None:
    _, screws, q, _ = random_chain(seed)
    space = chain.space_jacobian(screws, q)
    for i in range(len(q)):
        elsewhere = np.where(np.arange(len(q)) < i, q, q + 1.0)
        np.testing.assert_array_equal(chain.space_jacobian(screws, elsewhere)[:, i], space[:, i])


def test_the_placement_of_a_base_carries_every_screw() -> None:
    """Moving a whole robot by A: screws Ad(A) S, home A M, and all its placements A T."""
    home, screws, q, _ = random_chain(11)
    base = se3.exp(np.array([1.0, -2.0, 0.5, 0.4, 1.3, -0.8]))
    moved = chain.forward(base @ home, adjoint(base) @ screws, q)
    np.testing.assert_allclose(moved, base @ chain.forward(home, screws, q), rtol=0, atol=1e-13)


# --- single screws ---------------------------------------------------------------------------------------------------

LINE = (np.array([2.0, -3.0, 6.0]) / 7, np.array([0.3, -0.2, 0.9]))


@pytest.mark.parametrize("pitch", [0.0, 0.02, -1.5, 100.0])
def test_one_turn_of_a_helical_joint_advances_by_its_pitch(pitch: float) -> None:
    direction, point = LINE
    turned = se3.exp(chain.screw(direction, point, pitch) * 2 * np.pi)
    np.testing.assert_allclose(turned[:3, :3], np.eye(3), rtol=0, atol=2e-15)
    np.testing.assert_allclose(turned[:3, 3], pitch * direction, rtol=0, atol=2e-15 * max(1, abs(pitch)))


@pytest.mark.parametrize("pitch", [0.0, 0.02, -1.5, 100.0])
@pytest.mark.parametrize("angle", [1e-9, 0.7, np.pi, -2.0])
def test_points_of_the_line_slide_along_it(angle: float, pitch: float) -> None:
    direction, point = LINE
    placement = se3.exp(chain.screw(direction, point, pitch) * angle)
    for along in (0.0, 2.5):
        start = point + along * direction
        end = start + pitch * angle / (2 * np.pi) * direction
        np.testing.assert_allclose(se3.transform(placement, start), end, rtol=0, atol=1e-14 * max(1, abs(pitch)))


def test_any_point_of_the_line_gives_the_same_screw() -> None:
    direction, point = LINE
    screw = chain.screw(direction, point, 0.3)
    np.testing.assert_allclose(chain.screw(direction, point + 4 * direction, 0.3), screw, rtol=0, atol=2e-15)


def test_pitch_is_the_slide_along_the_axis_for_each_radian() -> None:
    """v . s = p / (2 pi), and what is left of v is the moment of the line."""
    direction, point = LINE
    screw = chain.screw(direction, point, 0.3)
    assert screw[:3] @ direction == pytest.approx(0.3 / (2 * np.pi), abs=1e-16)
    np.testing.assert_allclose(np.cross(direction, screw[:3]), point - (point @ direction) * direction, atol=1e-15)


def test_an_infinite_pitch_is_a_sliding_joint() -> None:
    direction, point = LINE
    placement = se3.exp(chain.screw(direction, point, np.inf) * 0.8)
    np.testing.assert_array_equal(placement[:3, :3], np.eye(3))
    np.testing.assert_allclose(placement[:3, 3], 0.8 * direction, rtol=0, atol=1e-16)


def test_a_huge_pitch_comes_near_to_sliding() -> None:
    """A screw of pitch p turned by 2 pi d/p goes d along its line, turning ever less as p grows."""
    direction, point = LINE
    slide = se3.exp(chain.screw(direction, point, np.inf) * 0.8)
    for pitch in (1e3, 1e6, 1e9):
        helix = se3.exp(chain.screw(direction, point, pitch) * (2 * np.pi * 0.8 / pitch))
        np.testing.assert_allclose(helix, slide, rtol=0, atol=6 / pitch + 1e-15)


def test_a_chain_without_joints_is_its_home() -> None:
    home, none = se3.exp(np.arange(6.0)), np.zeros((6, 0))
    np.testing.assert_array_equal(chain.forward(home, none, np.zeros((3, 0))), np.broadcast_to(home, (3, 4, 4)))
    assert chain.space_jacobian(none, np.zeros((3, 0))).shape == (3, 6, 0)
    assert chain.body_jacobian(home, none, np.zeros(0)).shape == (6, 0)
    assert chain.jacobian_derivatives(np.zeros((3, 6, 0))).shape == (3, 6, 0, 0)
