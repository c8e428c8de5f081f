"""What an engine answers. Two implementations compute every number: `screw` and `pinocchio`.

Both take configurations `(..., nq)` of the independent joints in file order (see `urdf.description`) and give columns
in that order: one per velocity coordinate, `nv` in all. Six-vectors have their linear part first; metres and radians.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from kinetostat.conventions import Array, Load, Reference, Velocity, WrenchOrTwist

__all__ = ["Engine"]


class Engine(Protocol):
    """Kinematics and statics of one robot. Frames are names of links that exist; callers check them."""

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

    def placements(self, q: Array, frames: Sequence[str]) -> Array:
        """Return T_root_f of many frames, the tree being walked once. (..., nq) -> (..., k, 4, 4)."""
        ...

    def frame_change(self, q: Array, start: str, end: str, kind: WrenchOrTwist) -> Array:
        """Return the 6x6 that carries twists, or wrenches, from `start` to `end`. (..., nq) -> (..., 6, 6)."""
        ...

    def jacobian(self, q: Array, velocity: Velocity) -> Array:
        """Return J with V = J qdot, V being the labelled velocity. (..., nq) -> (..., 6, nv)."""
        ...

    def jacobians(self, q: Array, frames: Sequence[str], reference: Reference) -> Array:
        """Return the Jacobians of many frames relative to the root, the tree being walked once.

        Of each frame's origin in the root's axes (aligned) or in its own (local), or of the point of it at the root's
        origin (world). (..., nq) -> (..., k, 6, nv).
        """
        ...

    def jacobian_rate(self, q: Array, qdot: Array, velocity: Velocity) -> Array:
        """Return dJ/dt along qdot, of the matrix as `jacobian` gives it. (..., nq), (..., nv) -> (..., 6, nv)."""
        ...

    def masses(self) -> tuple[float, float]:
        """Return the mass of the base link and of all other links, in kg."""
        ...

    def link_motions(self, q: Array, qdot: Array, qddot: Array, links: Sequence[str]) -> Array:
        """Return twist and spatial acceleration of links relative to the root, at their origins in their own axes.

        The spatial acceleration is the rate of the twist's components in the link's axes (R. Featherstone, "Rigid Body
        Dynamics Algorithms", 2008, section 2.10). (..., nq), (..., nv), (..., nv) -> (..., k, 2, 6).
        """
        ...

    def holding_torques(self, q: Array, gravity: Array, loads: Sequence[Load]) -> Array:
        """Return the joint torques that hold the robot still against gravity (3,) in m/s2 while it exerts loads.

        dU/dq + sum J^T F, U being the potential energy; gravity is in the root's axes. (..., nq) -> (..., nv).
        """
        ...

    def joint_wrenches(self, q: Array, gravity: Array, loads: Sequence[Load], links: Sequence[str]) -> Array:
        """Return the wrench by which each link is held by the one before it (the root link by the ground), in statics.

        About the link's origin, in its own axes. (..., nq) -> (..., k, 6), N and Nm.
        """
        ...

    def gravity_stiffness(self, q: Array, gravity: Array) -> Array:
        """Return d(dU/dq)/dq, row i the gradient of the holding torque of coordinate i. (..., nq) -> (..., nv, nv)."""
        ...
