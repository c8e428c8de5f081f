"""Level directions that are those of an axis, or nearly."""

from __future__ import annotations

import numpy as np

from kinetostat.conventions import Array

__all__ = ["NEAR_AXIS", "level_axis"]

NEAR_AXIS = float(np.cos(np.radians(10)))  # cosine of the angle up to which a direction is taken for an axis


def level_axis(direction: Array, up: Array) -> Array:
    """Return a level direction, or the observer's axis that is within 10 degrees of it, made level.

    What is drawn across an axis reads easier: x to the right rather than what is 9 degrees from x.

    Args:
        direction: a unit vector at right angles to the vertical. (3,).
        up: the vertical in the observer's axes, a unit vector. (3,).

    Returns:
        A unit vector at right angles to the vertical, (3,).
    """
    for axis in np.eye(3):
        level = axis - (axis @ up) * up
        size = float(np.linalg.norm(level))
        if size > NEAR_AXIS and abs(level @ direction) > NEAR_AXIS * size:
            found: Array = level / size
            return found
    return direction
