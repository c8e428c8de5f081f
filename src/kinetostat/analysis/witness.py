"""What a number is checked against when two engines alone could both be wrong: differences of placements and energies.

The twist of a link is the rate of its placement; the torque of weight is the gradient of the potential energy; a load's
torque is what its power says. All three are had from placements alone, by central differences, whoever gives those.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from kinetostat.analysis.configuration import displaced
from kinetostat.conventions import Array, Reference
from kinetostat.screw import so3
from kinetostat.urdf.description import Robot

__all__ = ["ACCURACY", "Places", "Weights", "along", "energy_rate", "energy_torques", "jacobian", "weights"]

STEP = 1e-4  # rad, m: truncation (some 1e-9) and rounding (some 1e-12) are both far below ACCURACY
ACCURACY = 1e-7  # of a difference quotient, for a robot of a metre that moves at unit speed

Places = Callable[[Array, Sequence[str]], Array]  # (..., nq), k names -> (..., k, 4, 4)
Weights = Mapping[str, tuple[float, Array]]  # mass in kg, centre of mass in the link's coordinates (3,)


def weights(robot: Robot) -> Weights:
    """Return the masses and centres of mass of a description."""
    return {
        link.name: (link.inertial.mass, np.array(link.inertial.origin.xyz))
        for link in robot.links
        if link.inertial is not None
    }


def _ends(robot: Robot, q: Array, rates: Array) -> tuple[Array, Array, float]:
    """Return the configurations half a step behind and ahead along rates, and the time between them."""
    step = STEP / robot.largest_multiplier
    return displaced(robot, q, -step * rates), displaced(robot, q, step * rates), 2 * step


def along(robot: Robot, places: Places, q: Array, rates: Array, frames: Sequence[str]) -> Array:
    """Return twists of frames' origins in the root's axes along joint rates. (..., nq), (..., nv) -> (..., k, 6)."""
    before, after, time = _ends(robot, q, rates)
    start, end = places(before, frames), places(after, frames)
    turned = so3.log(end[..., :3, :3] @ np.swapaxes(start[..., :3, :3], -1, -2))
    return np.concatenate([end[..., :3, 3] - start[..., :3, 3], turned], -1) / time


def jacobian(robot: Robot, places: Places, q: Array, frame: str, reference: Reference) -> Array:
    """Return the Jacobian of a frame relative to the root, column by column. (nq,) -> (6, nv)."""
    twists = along(robot, places, q, np.eye(robot.nv), [frame])[:, 0].T
    linear, angular = twists[:3], twists[3:]
    placement = places(q, [frame])[0]
    if reference is Reference.WORLD:  # the point at the root's origin: v - w x p
        linear = linear + np.cross(placement[:3, 3], angular, axisb=0, axisc=0)
    if reference is Reference.LOCAL:
        linear, angular = placement[:3, :3].T @ linear, placement[:3, :3].T @ angular
    return np.concatenate([linear, angular])


def energy_rate(robot: Robot, places: Places, heavy: Weights, gravity: Array, q: Array, rates: Array) -> Array:
    """Return the rate of the potential energy along joint rates, W. (..., nq), (..., nv) -> (...)."""
    before, after, time = _ends(robot, q, rates)
    rise = _energy(places, heavy, gravity, after) - _energy(places, heavy, gravity, before)
    return np.asarray(rise / time)


def energy_torques(robot: Robot, places: Places, heavy: Weights, gravity: Array, q: Array) -> Array:
    """Return the gradient of the potential energy: what holds the links against their weight. (nq,) -> (nv,)."""
    return energy_rate(robot, places, heavy, gravity, q, np.eye(robot.nv))


def _energy(places: Places, heavy: Weights, gravity: Array, q: Array) -> Array:
    """Return U = -sum m g . c. (..., nq) -> (...), J."""
    masses = np.array([mass for mass, _ in heavy.values()])
    centres = np.array([centre for _, centre in heavy.values()]).reshape(-1, 3)
    placed = places(q, list(heavy))
    at = (placed[..., :3, :3] @ centres[..., None])[..., 0] + placed[..., :3, 3]
    return np.asarray(-np.sum(masses * (at @ gravity), -1))
