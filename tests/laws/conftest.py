"""Edge inputs that every law is tried at, and hypothesis made repeatable."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, deadline=None, database=None)
settings.load_profile("repeatable")

# Nothing, tiny, small, on both sides of the switch between series and closed form, plain, near half a turn.
EDGE_ANGLES = (
    *(0.0, 1e-300, 1e-160, 1e-16, 1e-12, 1e-8, 6e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2),
    *(np.nextafter(0.25, 0), 0.25, np.nextafter(0.25, 1), 0.1, 1.0, 2.5),
    *(np.pi - 1e-4, np.pi - 1e-8, np.pi - 1e-12),
)
# Half a turn within rounding: a matrix of doubles no longer tells the two ends of the axis apart.
HALF_TURNS = (np.pi - 1e-15, np.pi - 1e-16, np.pi)


def _unit_axes() -> np.ndarray:
    """Coordinate axes both ways, nearly coordinate axes, diagonals, and skew ones."""
    skew = np.random.default_rng(7).normal(size=(6, 3))
    odd = [[1, 1e-8, 0], [1e-12, -1, 1e-300], [1, 1, 1], [-1, 1, -1], [1, -1, 0]]
    axes = np.concatenate([np.eye(3), -np.eye(3), odd, skew])
    return axes / np.linalg.norm(axes, axis=-1, keepdims=True)


@pytest.fixture(scope="session")
def axes() -> np.ndarray:
    """Unit vectors (k, 3)."""
    return _unit_axes()


@pytest.fixture(scope="session")
def rotation_vectors(axes: np.ndarray) -> np.ndarray:
    """Rotation vectors (n, 3): every edge angle and half turn about every axis."""
    return (np.array(EDGE_ANGLES + HALF_TURNS)[:, None, None] * axes).reshape(-1, 3)


@pytest.fixture(scope="session")
def twists(rotation_vectors: np.ndarray) -> np.ndarray:
    """Twists (m, 6): every rotation vector with translations of nothing, a micrometre, a metre and a thousand km."""
    directions = np.random.default_rng(8).normal(size=(4, len(rotation_vectors), 3))
    lengths = np.array([0.0, 1e-6, 1.0, 1e6])[:, None, None]
    return np.concatenate([directions * lengths, np.broadcast_to(rotation_vectors, directions.shape)], -1).reshape(
        -1, 6
    )


@pytest.fixture(params=EDGE_ANGLES, ids=[repr(float(a)) for a in EDGE_ANGLES])
def angle(request: pytest.FixtureRequest) -> float:
    """One edge angle, less than half a turn."""
    return float(request.param)


@pytest.fixture(params=HALF_TURNS, ids=["pi-1e-15", "pi-1e-16", "pi"])
def half_turn(request: pytest.FixtureRequest) -> float:
    """Half a turn within rounding."""
    return float(request.param)
