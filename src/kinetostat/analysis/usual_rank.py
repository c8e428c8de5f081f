"""What a robot's structure allows at almost every configuration: Jacobians at a few random ones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinetostat.analysis.configuration import random_configurations
from kinetostat.conventions import Array, Velocity
from kinetostat.engines.model import Model
from kinetostat.engines.screw import ScrewEngine

__all__ = ["sampled_jacobians"]

_SAMPLES, _SEED = 8, 0


def sampled_jacobians(model: Model, velocity: Velocity, columns: Sequence[int]) -> Array:
    """Return Jacobians at random configurations, the largest rank of which is that of almost every one. (8, 6, n).

    Limits do not count: there are files that lock every joint at zero by leaving them out.
    """
    samples, generator = random_configurations(model.robot, _SEED, _SAMPLES), np.random.default_rng(_SEED)
    for joint in model.robot.independent:
        if joint.type.nq == 1:
            moved = generator.uniform(-np.pi, np.pi, _SAMPLES) if joint.type.is_angle else generator.random(_SAMPLES)
            samples[:, model.robot.position_slices[joint.name].start] += moved
    matrices: Array = ScrewEngine(model.robot).jacobian(samples, velocity)[..., list(columns)]
    return matrices
