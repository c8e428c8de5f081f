"""What an engine answers. Two implementations compute every number: `screw` and `pinocchio`.

Both take configurations `(..., nq)` of the independent joints in file order (see `urdf.description`) and give columns
in that order: one per velocity coordinate, `nv` in all. Six-vectors have their linear part first; metres and radians.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from kinetostat.conventions import Array, Velocity, WrenchOrTwist

__all__ = ["Engine"]


class Engine(Protocol):
    """Kinematics of one robot. Frames are names of links that exist; callers check them."""

    @property
    def name(self) -> str:
        """The engine's name, as certificates show it."""
        ...

    @property
    def position_names(self) -> Sequence[str]:
        """Names of the nq position coordinates."""
        ...

    @property
    def velocity_names(self) -> Sequence[str]:
        """Names of the nv velocity coordinates, which are the columns of a Jacobian."""
        ...

    def placement(self, q: Array, frame: str, relative_to: str) -> Array:
        """Return T_a_f, which maps coordinates in `frame` to coordinates in `relative_to`. (..., nq) -> (..., 4, 4)."""
        ...

    def frame_change(self, q: Array, start: str, end: str, kind: WrenchOrTwist) -> Array:
        """Return the 6x6 that carries twists, or wrenches, from `start` to `end`. (..., nq) -> (..., 6, 6)."""
        ...

    def jacobian(self, q: Array, velocity: Velocity) -> Array:
        """Return J with V = J qdot, V being the labelled velocity. (..., nq) -> (..., 6, nv)."""
        ...

    def jacobian_rate(self, q: Array, qdot: Array, velocity: Velocity) -> Array:
        """Return dJ/dt along qdot, of the matrix as `jacobian` gives it. (..., nq), (..., nv) -> (..., 6, nv)."""
        ...

    def masses(self) -> tuple[float, float]:
        """Return the mass of the base link and of all other links, in kg."""
        ...
